"""One function for each command of the program."""

from __future__ import annotations

import inspect
import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import pandas as pd

from . import _results, _tauscope
from ._inputs import gathered
from ._messages import in_python, translated
from ._model import Model
from ._progress import Progress
from ._run import Done, run, warn
from ._settings import arguments, defaults

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import (
        AddOptions,
        CompareOptions,
        DesignOptions,
        EstimateOptions,
        ExplainOptions,
        ImproveOptions,
        ReportOptions,
        SimulateOptions,
        SweepOptions,
    )

R = TypeVar("R", bound=_results.Result)

#: Commands whose work takes longer than its recording, which they make at once.
FITTING = frozenset({"explain", "add", "improve"})


def _run(
    kind: Callable[..., R],
    words: list[str],
    data: Any,
    settings: Mapping[str, Any],
    *,
    progress: Progress = None,
    model: Model | str | os.PathLike[str] | None = None,
    revises: bool = False,
    keeps: bool = False,
) -> R:
    """Runs the command ``words`` on ``data``; the result is of class ``kind``."""
    command = words[0]
    rest: dict[str, Any] = {**settings}
    is_needed = data is not None or kind is not _results.Design
    files, logs = gathered(data, rest) if is_needed else ([], None)
    given = Model.load(model) if model is not None and not isinstance(model, Model) else model

    def done_with(output: str | None) -> Done:
        return run(
            words,
            files,
            logs,
            {**rest, "output": output},
            progress=progress,
            model=given,
            revises=revises,
            keeps=keeps,
        )

    is_recorded = kind not in (_results.Report, _results.Design) and _tauscope.HAS_RECORDINGS
    output, folder = rest.get("output"), None
    if is_recorded and output is None and command in FITTING:
        folder = tempfile.TemporaryDirectory(prefix="tauscope_")
        output = Path(folder.name) / f"{command}.rrd"
    done = done_with(output and os.fspath(output))
    warn(done.messages, stacklevel=3)
    name, functions = (given.name, given.functions) if given is not None else ("model.toml", ())

    def record(path: str) -> None:
        done_with(path)

    return kind(
        command,
        done.printed,
        done.messages,
        complete=done.complete,
        stopped=done.stopped,
        record=record if is_recorded else None,
        recording=Path(output) if is_recorded and output and Path(output).exists() else None,
        folder=folder,
        model=None if done.revised is None else Model(done.revised, name, functions),
    )


def estimate(
    data: Any, *, progress: Progress = None, **settings: Unpack[EstimateOptions]
) -> _results.Estimate:
    """The delay of every step of the input of every joint.

    ``data`` is a path or several; a DataFrame of pandas or polars whose columns are named as in
    a log (``time_s``, ``boom.input [V]``, ``boom.output [deg]``); or a pair of arrays
    ``(input, output)`` of n samples each, or a mapping from joints to such pairs, with
    ``sample_period`` in seconds. ``settings`` are the options of ``tauscope estimate``:
    ``alpha`` and ``beta`` in samples, ``passband`` in Hz or ``"none"``, ``method``…

    Raises :class:`TauscopeError` if the log cannot be used; its ``row`` and ``column`` say
    where. Raises ``TypeError`` for an unknown setting, and names the known ones.

    The default method fits a response common to all steps of a joint; ``method="two-line"`` is
    Albrecht and Taylor's Algorithm 1.

    >>> import numpy as np
    >>> u = np.tile(np.repeat([0.0, 1.0, -1.0], 60), 4)
    >>> y = np.concatenate([np.zeros(13), np.cumsum(0.1 * u)[:-13]])
    >>> found = estimate((u, y), sample_period=0.01)
    >>> round(float(found.delays["delta_s"].median()), 3)
    0.12
    """
    return _run(_results.Estimate, ["estimate"], data, settings, progress=progress)


def sweep(
    data: Any, *, progress: Progress = None, **settings: Unpack[SweepOptions]
) -> _results.Sweep:
    """Which delays depend on α, β, passband and method, and by how much.

    ``data`` and errors as for :func:`estimate`; ``alpha`` and ``beta`` (samples) and
    ``passband`` (Hz) are lists.
    """
    return _run(_results.Sweep, ["sweep"], data, settings, progress=progress)


def compare(
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Unpack[CompareOptions],
) -> _results.Comparison:
    """Compares a model with the measurement: its errors, and where it fails.

    Without a model each joint is compared with a plain integrator, which is fitted; with
    ``fit=True`` the model is fitted from its values. Errors are in output units, and
    ``fit_percent`` is 100 (1 − ‖y − ŷ‖ / ‖y − mean y‖) (Ljung, System Identification, 1999).
    ``data`` and errors as for :func:`estimate`.
    """
    return _run(_results.Comparison, ["compare"], data, settings, progress=progress, model=model)


def explain(
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Unpack[ExplainOptions],
) -> _results.Explanation:
    """Which physical effect a model lacks: the ranking, and its evidence.

    ``ranking`` is a DataFrame with a row for each effect that was tried and its validation
    error in output units. ``verdicts`` says for each joint whether anything is missing.
    ``data`` and errors as for :func:`estimate`.
    """
    return _run(_results.Explanation, ["explain"], data, settings, progress=progress, model=model)


def add(
    effect: str,
    data: Any,
    model: Model | str | os.PathLike[str] | None = None,
    *,
    progress: Progress = None,
    **settings: Unpack[AddOptions],
) -> _results.Comparison:
    """Adds an effect to a model and fits it: ``.model`` is the new revision.

    Raises :class:`TauscopeError` if there is no such effect, and names the nearest one.
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
    **settings: Unpack[ImproveOptions],
) -> _results.Improvement:
    """Adds to a model the effects that it lacks: ``.model`` is the last revision.

    Ctrl-C stops it after the current revision: the result has what was found until then, and
    its ``stopped`` is true. Ctrl-C again raises ``KeyboardInterrupt`` at once.
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
    **settings: Unpack[ReportOptions],
) -> _results.Report:
    """A page with figures and numbers (``.html`` or ``.md``), a recording beside it."""
    if not _tauscope.HAS_RECORDINGS:
        settings.setdefault("no_recording", True)
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
    **settings: Unpack[DesignOptions],
) -> _results.Design:
    """The next experiment: an input in steps, or one that distinguishes two effects.

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
    **settings: Unpack[SimulateOptions],
) -> _results.Simulated:
    """A log of a joint with chosen effects, noise and seed, and the truth about it.

    >>> made = simulate(effect="dead_band", seed=1)
    >>> list(made.log.columns)[0]
    'time_s'
    """
    with tempfile.TemporaryDirectory() as folder:
        log = Path(output or Path(folder) / "log.csv")
        delays, whole = Path(folder) / "truth.csv", Path(folder) / "truth.toml"
        kept = Path(truth) if truth else whole
        rest = {**settings, "output": log, "truth": [delays, kept]}
        files = [] if plant is None else [os.fspath(plant)]
        typed = arguments("simulate", rest)
        with in_python("simulate"):
            _, _, messages, _ = _tauscope.run(["simulate", *files, *typed], None, None, False)
        said = [(kind, translated("simulate", text)) for kind, text in messages]
        warn(said, stacklevel=2)
        return _results.Simulated(
            pd.read_csv(log, comment="#"),
            kept.read_text("utf-8"),
            pd.read_csv(delays, comment="#"),
            [text for kind, text in said if kind == "note"],
        )


def _list_settings(function: Any) -> None:
    """Names the settings in the signature: notebooks and ``help`` know what they see when run."""
    found = inspect.signature(function)
    own = [each for each in found.parameters.values() if each.kind is not each.VAR_KEYWORD]
    settings = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default)
        for name, default in defaults(function.__name__).items()
        if name not in found.parameters
    ]
    function.__signature__ = found.replace(parameters=[*own, *settings])


for _function in (estimate, sweep, compare, explain, add, improve, report, design, simulate):
    _list_settings(_function)
