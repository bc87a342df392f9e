"""What the commands give: JSON, tables and figures of it."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Mapping
from functools import cached_property
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import pandas as pd

from . import _svg

if TYPE_CHECKING:
    from . import _tauscope
    from ._model import Model


class Result:
    """What a command gave.

    ``data`` is its JSON as a dictionary, ``notes`` what a person should know, and ``complete``
    whether every joint and file was done; ``stopped`` says that it was interrupted, and that
    this is what was reached.
    """

    def __init__(
        self,
        command: str,
        printed: _tauscope.Printed,
        messages: list[tuple[str, str]],
        *,
        complete: bool = True,
        stopped: bool = False,
        record: Callable[[str], None] | None = None,
        recording: Path | None = None,
        folder: TemporaryDirectory[str] | None = None,
        model: Model | None = None,
    ) -> None:
        self.command = command
        self._printed = printed
        self.notes = [said for kind, said in messages if kind == "note"]
        self.complete = complete
        self.stopped = stopped
        self._record = record
        self._recording = recording
        #: Where the recording is until this result is forgotten, if nobody asked for it.
        self._folder = folder
        #: The model as the command left it, where it is one that changes models.
        self.model = model

    @cached_property
    def data(self) -> dict[str, Any]:
        """The JSON as a dictionary."""
        text = self.to_json()
        data: dict[str, Any] = json.loads(text) if text else {}
        return data

    def to_json(self) -> str:
        """The JSON, as the program prints it with ``--format json``."""
        return self._printed.text()

    @property
    def joints(self) -> list[dict[str, Any]]:
        """The joints of the JSON."""
        joints: list[dict[str, Any]] = self.data.get("joints", [])
        return joints

    def __getitem__(self, joint: str) -> dict[str, Any]:
        for each in self.joints:
            if each["joint"] == joint:
                return each
        raise KeyError(f"{joint}: the joints are {', '.join(j['joint'] for j in self.joints)}")

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the recording for the Rerun viewer (``.rrd``).

        That of a command that fits models, or that was run with ``output=``, is there already.
        Another command is run once more for it.
        """
        if self._recording is not None:
            if Path(path).resolve() != self._recording.resolve():
                shutil.copyfile(self._recording, path)
            return Path(path)
        if self._record is None:
            raise ValueError(f"{self.command} makes no recording")
        self._record(os.fspath(path))
        return Path(path)

    def log(self, stream: Any, path: str | os.PathLike[str] | None = None) -> None:
        """Has a ``rerun.RecordingStream`` load the recording, written to ``path`` if there is one.

        The stream loads it in the background: it needs this result until it is flushed.
        """
        if path is not None:
            stream.log_file_from_path(self.save(path))
            return
        if self._recording is None:
            folder = TemporaryDirectory(prefix="tauscope_")
            self._recording = self.save(Path(folder.name) / f"{self.command}.rrd")
            self._folder = folder
        stream.log_file_from_path(self._recording)

    def _rows(self, key: str) -> pd.DataFrame:
        rows = [
            {"joint": joint["joint"], **_flat(row)}
            for joint in self.joints
            for row in joint.get(key) or []
        ]
        return pd.DataFrame(rows)

    @cached_property
    def parameters(self) -> pd.DataFrame:
        """Values, standard errors and units of the parameters; a row each."""
        rows = [
            {"joint": joint["joint"], "parameter": name, **value}
            for joint in self.joints
            for name, value in (joint.get("parameters") or {}).items()
        ]
        return pd.DataFrame(rows)

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row a joint: what is a number or a text in the JSON."""
        return pd.DataFrame([_flat(joint) for joint in self.joints])

    def _figure(self) -> str:
        return ""

    def _repr_html_(self) -> str:
        table = self.table
        shown = table.to_html(index=False, max_cols=12) if len(table) else ""
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.notes)
        return f"<div><b>tauscope {self.command}</b>{shown}{self._figure()}<ul>{notes}</ul></div>"

    def __repr__(self) -> str:
        names = ", ".join(joint["joint"] for joint in self.joints)
        return f"<tauscope {self.command}: {names}>"


def _flat(row: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers and texts, and those of dictionaries one level below, as ``a.b``.

    Texts of a list are joined; of parameters there are their values.
    """
    flat: dict[str, Any] = {}
    for name, value in row.items():
        if name == "parameters":
            flat[name] = {parameter: of["value"] for parameter, of in (value or {}).items()}
        elif isinstance(value, list) and all(isinstance(each, str) for each in value):
            flat[name] = ", ".join(value)
        elif isinstance(value, Mapping):
            inner = {k: v for k, v in value.items() if not isinstance(v, (Mapping, list))}
            flat.update({f"{name}.{k}": v for k, v in inner.items()})
        elif not isinstance(value, list):
            flat[name] = value
    return flat


class Estimate(Result):
    """The delays of the steps of each joint."""

    @cached_property
    def decisions(self) -> pd.DataFrame:
        """Every step: a row each, with the columns of ``--decisions`` and further ones.

        ``doubt`` is from 0 to 1; ``flags`` is a list of what is odd: ``edge``, ``jump``, ``stop``.
        """
        rows = [row for joint in self.joints for row in joint.get("decisions") or []]
        return pd.DataFrame(rows)

    @cached_property
    def delays(self) -> pd.DataFrame:
        """The steps that were accepted: joint, trial, i, p and the delay in samples and s."""
        found = self.decisions
        if len(found) == 0:
            return found
        columns = ["joint", "trial", "i", "p", "delta", "delta_s"]
        accepted: pd.DataFrame = found.loc[found["verdict"] == "accepted", columns]
        return accepted.reset_index(drop=True)

    @cached_property
    def delay_table(self) -> pd.DataFrame:
        """The delay of each kind of step, with the interval of its median at 95 %."""
        rows = [row for joint in self.joints for row in joint.get("delay_table") or []]
        return pd.DataFrame(rows)

    def _figure(self) -> str:
        if len(self.delays) == 0:
            return ""
        parts = []
        for name, steps in self.delays.groupby("joint", sort=False):
            figure = _svg.scatter(
                list(steps["p"].astype(float)), list(steps["delta_s"]), "sample", "delay, s"
            )
            parts.append(f"<p>{escape(str(name))}</p>{figure}")
        return "".join(parts)


class Comparison(Result):
    """A model compared with the measurement."""

    @cached_property
    def fails_where(self) -> pd.DataFrame:
        """The conditions under which it fails, with their shares of the squared error."""
        return self._rows("fails_where")


class Explanation(Comparison):
    """Which physical effect a model lacks."""

    @cached_property
    def ranking(self) -> pd.DataFrame:
        """The effects that were tried, the one with the least validation error first."""
        return self._rows("ranking")

    @cached_property
    def verdicts(self) -> pd.DataFrame:
        """Whether anything is missing, a row for each joint, and the conclusion in a sentence.

        ``verdict`` is ``adequate``, ``missing_effect`` or ``unexplained``.
        """
        rows = [
            {name: joint.get(name) for name in ("joint", "verdict", "headline")}
            for joint in self.joints
            if "verdict" in joint
        ]
        return pd.DataFrame(rows, columns=["joint", "verdict", "headline"])

    def headline(self, joint: str | None = None) -> str:
        """The conclusion in a sentence, of one joint or of all."""
        joints = self.joints if joint is None else [self[joint]]
        lines = [(each.get("conclusion") or {}).get("headline", "") for each in joints]
        return "\n".join(line for line in lines if line)

    def _figure(self) -> str:
        if len(self.ranking) == 0:
            return f"<pre>{escape(self.headline())}</pre>"
        parts = [f"<pre>{escape(self.headline())}</pre>"]
        for name, effects in self.ranking.groupby("joint", sort=False):
            best = effects.head(8)
            figure = _svg.bars(
                list(best["effect"]), list(best["error_reduction_percent"].fillna(0.0)), "%"
            )
            parts.append(f"<p>{escape(str(name))}: error taken away</p>{figure}")
        return "".join(parts)


class Improvement(Explanation):
    """A model to which missing effects were added one by one."""

    @cached_property
    def revisions(self) -> pd.DataFrame:
        """The ladder of errors: a row for each revision of each joint."""
        rows = []
        for joint in self.joints:
            for revision in joint.get("revisions") or []:
                error = revision.get("error") or {}
                row = {"joint": joint["joint"], **_flat(revision)}
                for part in ("train", "validation"):
                    for name, value in (error.get(part) or {}).items():
                        row[f"{part}_{name}"] = value
                rows.append(row)
        return pd.DataFrame(rows)

    def _figure(self) -> str:
        parts = [f"<pre>{escape(self.headline())}</pre>"]
        if "validation_rmse" not in self.revisions:
            return parts[0]
        for name, ladder in self.revisions.groupby("joint", sort=False):
            added = [each if isinstance(each, str) else "start" for each in ladder["added"]]
            figure = _svg.bars(added, list(ladder["validation_rmse"].fillna(0.0)), "rmse")
            parts.append(f"<p>{escape(str(name))}: error that is left</p>{figure}")
        return "".join(parts)


class Sweep(Result):
    """How the delays depend on the settings."""

    @cached_property
    def decisions(self) -> pd.DataFrame:
        """Every step: how many settings accept it, and the range of its delays."""
        return self._rows("decisions")

    @cached_property
    def combinations(self) -> pd.DataFrame:
        """Every combination of settings of each joint: accepted steps and median delay."""
        rows = [
            {"joint": joint["joint"], **settings, **found}
            for joint in self.joints
            for settings, found in zip(self.data["settings"], joint["settings"], strict=True)
        ]
        return pd.DataFrame(rows)


class Report(Result):
    """A page with figures; ``path`` is where it is."""

    path: Path


class Design(Result):
    """The next experiment; ``input`` is the input to apply, a DataFrame."""

    input: pd.DataFrame


class Simulated:
    """A log of a joint that was simulated, and the truth about it."""

    def __init__(
        self, log: pd.DataFrame, truth: str, delays: pd.DataFrame, notes: list[str]
    ) -> None:
        #: The log: time, input and output of each joint.
        self.log = log
        #: The delays or effects that are in it, as the program writes them.
        self.truth = truth
        #: The true delay of every step of every joint; a row each.
        self.delays = delays
        #: What a person should know.
        self.notes = notes

    def __repr__(self) -> str:
        return f"<tauscope simulate: {len(self.log)} samples>"
