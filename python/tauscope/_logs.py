"""Logs as the program reads them: joints, and trials of arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from . import _tauscope
from ._inputs import gathered
from ._messages import in_python, translated
from ._settings import arguments

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import ReadOptions


class Trial:
    """An uninterrupted run of one joint."""

    def __init__(self, found: dict[str, Any]) -> None:
        self.trial: str = found["trial"]
        self.start_s: float = found["start_s"]
        #: Seconds between samples.
        self.sample_period: float = found["sample_period"]
        #: What drove the joint, n samples.
        self.input: np.ndarray[Any, np.dtype[np.float64]] = found["input"]
        #: What the joint did, n samples.
        self.output: np.ndarray[Any, np.dtype[np.float64]] = found["output"]
        own = {"trial", "start_s", "sample_period", "input", "output"}
        #: Further signals, n samples each.
        self.others = {name: values for name, values in found.items() if name not in own}

    @property
    def time_s(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The time of each sample in seconds."""
        samples = np.arange(len(self.input), dtype=np.float64)
        return np.asarray(self.start_s + self.sample_period * samples, dtype=np.float64)

    def to_frame(self) -> pd.DataFrame:
        """Time, input and output as a DataFrame."""
        columns = {"time_s": self.time_s, "input": self.input, "output": self.output}
        return pd.DataFrame({**columns, **self.others})


class Joint:
    """A joint: its units and its trials."""

    def __init__(self, found: dict[str, Any]) -> None:
        self.joint: str = found["joint"]
        self.input_unit: str | None = found["input_unit"]
        self.output_unit: str | None = found["output_unit"]
        self.trials = [Trial(trial) for trial in found["trials"]]

    def __repr__(self) -> str:
        samples = sum(len(trial.input) for trial in self.trials)
        return f"<Joint {self.joint}: {len(self.trials)} trials, {samples} samples>"


class Logs(dict[str, Joint]):
    """Joints by name; ``notes`` has the notes on how the logs were read."""

    notes: list[str]


def read(data: Any, **settings: Unpack[ReadOptions]) -> Logs:
    """Reads logs as every command does: joints by name, each with its trials as arrays."""
    rest: dict[str, Any] = {**settings}
    files, logs = gathered(data, rest)
    typed = arguments("read", rest)
    with in_python("read"):
        joints, notes = _tauscope.read(["read", *files, *typed], logs)
    found = Logs((joint["joint"], Joint(joint)) for joint in joints)
    found.notes = [translated("read", note) for note in notes]
    return found
