"""One function for each command of the program."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pandas as pd

from . import _results, _tauscope
from ._inputs import gathered
from ._model import Model
from ._progress import Progress, reporting
from ._settings import arguments

R = TypeVar("R", bound=_results.Result)


#: Whether all was done, what was printed, what was said, whether it was stopped, and the model.
_Done = tuple[bool, _tauscope.Printed, list[tuple[str, str]], bool, Model | None]

#: Commands whose work takes longer than its recording, which they make at once.
FITTING = frozenset({"explain", "add", "improve"})


class TauscopeWarning(UserWarning):
    """A joint or a file that was left out, and why."""


def _run(
    kind: Callable[..., R],
    words: list[str],
    data: Any,
    settings: dict[str, Any],
    *,
    progress: Progress = None,
    model: Model | str | os.PathLike[str] | None = None,
    revises: bool = False,
    keeps: bool = False,
) -> R:
    """Runs the command ``words`` on ``data``; the result is of class ``kind``."""
    command = words[0]
    settings = dict(settings)
    is_needed = data is not None or kind is not _results.Design
    files, logs = gathered(data, settings) if is_needed else ([], None)

    given = Model.load(model) if model is not None and not isinstance(model, Model) else model
    name = given.name if given is not None else "model.toml"
    functions = given.functions if given is not None else ()

    def run(output: str | None) -> _Done:
        with tempfile.TemporaryDirectory() as folder:
            typed = arguments(command, {**settings, "output": output})
            if given is not None:
                given.save(Path(folder) / name)
                typed.append(f"--model={Path(folder) / name}")
            revised = Path(folder) / f"revised_{name}"
            if revises:
                typed.append(f"--write={revised}")
            all_words = [*words, *files, *typed, "--format=json"]
            with reporting(progress, command) as report:
                done = _tauscope.run(all_words, logs, report, keeps, functions)
            is_revised = revises and revised.exists()
            left = Model(revised.read_text("utf-8"), name, functions) if is_revised else None
            return (*done, left)

    is_recorded = kind not in (_results.Report, _results.Design) and _tauscope.HAS_RECORDINGS
    output, folder = settings.get("output"), None
    if is_recorded and output is None and command in FITTING:
        folder = tempfile.TemporaryDirectory(prefix="tauscope_")
        output = Path(folder.name) / f"{command}.rrd"
    complete, printed, messages, stopped, left = run(output and os.fspath(output))
    for what, said in messages:
        if what == "warning":
            warnings.warn(said, TauscopeWarning, stacklevel=3)

    def record(path: str) -> None:
        run(path)

    return kind(
        command,
        printed,
        messages,
        complete=complete,
        stopped=stopped,
        record=record if is_recorded else None,
        recording=Path(output) if is_recorded and output and Path(output).exists() else None,
        folder=folder,
        model=left,
    )


def estimate(data: Any, *, progress: Progress = None, **settings: Any) -> _results.Estimate:
    """The delay of every step of the input of every joint.

    ``data`` is a path or several; a DataFrame of pandas or polars whose columns are named as in
    a log (``time_s``, ``boom.input [V]``, ``boom.output [deg]``); or a pair of arrays
    ``(input, output)`` of n samples each, or a mapping from joints to such pairs, with
    ``sample_period`` in seconds. ``settings`` are the options of ``tauscope estimate``:
    ``alpha`` and ``beta`` in samples, ``passband`` in Hz or ``"none"``, ``method``…

    Raises :class:`TauscopeError` where the log cannot be used; its ``row`` and ``column`` say
    where. Raises ``TypeError`` for a setting that there is not, and names those that there are.

    Albrecht and Taylor, Algorithm 1.

    >>> import numpy as np
    >>> u = np.tile(np.repeat([0.0, 1.0, -1.0], 60), 4)
    >>> y = np.concatenate([np.zeros(13), np.cumsum(0.1 * u)[:-13]])
    >>> found = estimate((u, y), sample_period=0.01)
    >>> round(float(found.delays["delta_s"].median()), 3)
    0.12
    """
    return _run(_results.Estimate, ["estimate"], data, settings, progress=progress)


def sweep(data: Any, *, progress: Progress = None, **settings: Any) -> _results.Sweep:
    """How every delay moves with α, β, passband and method.

    ``data`` as for :func:`estimate`, which raises the same; ``alpha`` and ``beta`` in samples
    and ``passband`` in Hz are lists.
    """
    return _run(_results.Sweep, ["sweep"], data, settings, progress=progress)


def compare(
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Any,
) -> _results.Comparison:
    """A model beside the measurement: error figures, and where it fails.

    Without a model each joint is compared with a plain integrator, which is fitted; with
    ``fit=True`` the model is fitted from its values. Errors are in output units, and
    ``fit_percent`` is 100 (1 − ‖y − ŷ‖ / ‖y − mean y‖) (Ljung, System Identification, 1999).
    ``data`` as for :func:`estimate`, which raises the same.
    """
    return _run(_results.Comparison, ["compare"], data, settings, progress=progress, model=model)


def explain(
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Any,
) -> _results.Explanation:
    """Which physical effect a model lacks: the ranking, and its evidence.

    ``ranking`` is a DataFrame: a row for each effect that was tried, with the error in output
    units that it leaves on data that were not fitted. ``verdicts`` says of each joint whether
    anything is missing. ``data`` as for :func:`estimate`, which raises the same.
    """
    return _run(_results.Explanation, ["explain"], data, settings, progress=progress, model=model)


def add(
    effect: str,
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Any,
) -> _results.Comparison:
    """That effect in the model, refitted: ``.model`` is the new revision.

    Raises :class:`TauscopeError` where there is no such effect, and names the nearest.
    """
    return _run(
        _results.Comparison,
        ["add", effect],
        data,
        settings,
        progress=progress,
        model=model,
        revises=True,
    )


def improve(
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Any,
) -> _results.Improvement:
    """Adds to a model what it lacks, effect by effect: ``.model`` is what came of it.

    Ctrl-C stops it after the revision at hand: the result holds what was reached, and its
    ``stopped`` is true. Ctrl-C again raises ``KeyboardInterrupt`` at once.
    """
    return _run(
        _results.Improvement,
        ["improve"],
        data,
        settings,
        progress=progress,
        model=model,
        revises=True,
        keeps=True,
    )


def report(
    data: Any,
    output: str | os.PathLike[str],
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Any,
) -> _results.Report:
    """A page with figures and numbers (``.html`` or ``.md``), a recording beside it."""
    if not _tauscope.HAS_RECORDINGS:
        settings = {"no_recording": True, **settings}
    found = _run(
        _results.Report,
        ["report"],
        data,
        {**settings, "output": output},
        progress=progress,
        model=model,
    )
    found.path = Path(output)
    return found


def design(
    data: Any = None,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Any,
) -> _results.Design:
    """The next experiment: an input in steps, or one that tells two effects apart.

    ``input`` of the result is a DataFrame.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(settings.pop("output", None) or Path(folder) / "input.csv")
        found = _run(
            _results.Design,
            ["design"],
            data,
            {**settings, "output": path},
            progress=progress,
            model=model,
        )
        found.input = pd.read_csv(path, comment="#")
    return found


def simulate(
    plant: str | os.PathLike[str] | None = None,
    *,
    output: str | os.PathLike[str] | None = None,
    truth: str | os.PathLike[str] | None = None,
    **settings: Any,
) -> _results.Simulated:
    """A log of a joint with chosen effects, noise and seed, and the truth about it.

    >>> made = simulate(effect="dead_band", seed=1)
    >>> list(made.log.columns)[0]
    'time_s'
    """
    with tempfile.TemporaryDirectory() as folder:
        log = Path(output or Path(folder) / "log.csv")
        kept = Path(truth or Path(folder) / "truth.toml")
        typed = arguments("simulate", {**settings, "output": log, "truth": kept})
        files = [] if plant is None else [os.fspath(plant)]
        _tauscope.run(["simulate", *files, *typed], None, None, False)
        return _results.Simulated(pd.read_csv(log, comment="#"), kept.read_text())


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
    """Joints by their names; ``notes`` says what a person should know of the logs."""

    notes: list[str]


def read(data: Any, **settings: Any) -> Logs:
    """Reads logs as every command does: joints by name, each with its trials as arrays."""
    settings = dict(settings)
    files, logs = gathered(data, settings)
    joints, notes = _tauscope.read(["read", *files, *arguments("read", settings)], logs)
    found = Logs((joint["joint"], Joint(joint)) for joint in joints)
    found.notes = notes
    return found
