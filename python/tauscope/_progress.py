"""Progress of long calls: a bar of tqdm, where that is there."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

#: ``None``: a bar in notebooks and on terminals; or whether there is one; or who is told.
Progress = bool | Callable[[str, int, int], None] | None


@contextmanager
def reporting(progress: Progress, command: str) -> Iterator[Callable[[str, int, int], None] | None]:
    """What is called with what is done, how many pieces of it, and of how many."""
    if callable(progress):
        yield progress
        return
    bar = _bar(command) if _is_wanted(progress) else None
    if bar is None:
        yield None
        return

    def report(what: str, done: int, of: int) -> None:
        bar.total, bar.n = of, done
        bar.set_description(what or command, refresh=True)

    try:
        yield report
    finally:
        bar.close()


def _is_wanted(progress: bool | Callable[[str, int, int], None] | None) -> bool:
    if progress is None:
        return "ipykernel" in sys.modules or sys.stderr.isatty()
    return bool(progress)


def _bar(command: str) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm(desc=command, leave=False)
