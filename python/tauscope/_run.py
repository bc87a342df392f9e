"""A command of the program, run inside the interpreter."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from . import _tauscope
from ._messages import in_python, translated
from ._progress import Progress, reporting
from ._settings import arguments


class TauscopeWarning(UserWarning):
    """A joint or a file that was left out, and why."""


class ModelText(Protocol):
    """A model as its file holds it, with the functions of Python that it names."""

    text: str
    name: str
    functions: tuple[_tauscope.Function, ...]


class Done(NamedTuple):
    """What a command did."""

    #: Whether all was done.
    complete: bool
    printed: _tauscope.Printed
    #: What kind of message, and what it says.
    messages: list[tuple[str, str]]
    #: Whether it was interrupted.
    stopped: bool
    #: The text of the model that it wrote, if it wrote one.
    revised: str | None


def run(
    words: list[str],
    files: list[str],
    logs: Any,
    settings: Mapping[str, Any],
    *,
    progress: Progress = None,
    model: ModelText | None = None,
    revises: bool = False,
    keeps: bool = False,
) -> Done:
    """Runs the command ``words`` on files, or on logs in memory that ``files`` names."""
    command = words[0]
    with tempfile.TemporaryDirectory() as folder:
        typed = arguments(command, settings)
        name = model.name if model is not None else "model.toml"
        if model is not None:
            (Path(folder) / name).write_text(model.text, encoding="utf-8")
            typed.append(f"--model={Path(folder) / name}")
        written = Path(folder) / f"revised_{name}"
        if revises:
            typed.append(f"--write={written}")
        functions = model.functions if model is not None else ()
        all_words = [*words, *files, *typed, "--format=json"]
        with reporting(progress, command) as report, in_python(command):
            complete, printed, messages, stopped = _tauscope.run(
                all_words, logs, report, keeps, functions
            )
        revised = written.read_text("utf-8") if written.exists() else None
    said = [(kind, translated(command, text)) for kind, text in messages]
    return Done(complete, printed, said, stopped, revised)


def warn(messages: list[tuple[str, str]], stacklevel: int) -> None:
    """Has Python warn of what was left out, as if by the caller ``stacklevel`` calls above."""
    for kind, said in messages:
        if kind == "warning":
            warnings.warn(said, TauscopeWarning, stacklevel=stacklevel + 1)
