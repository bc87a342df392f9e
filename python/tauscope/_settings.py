"""Keyword arguments as the options of the program."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

from . import _tauscope

#: What the package does itself, or what only a terminal needs.
HIDDEN = frozenset(
    "format quiet connect serve spawn follow idle results shard summary model write".split()  # noqa: SIM905
)

#: What the package asks of arrays besides; a log has it in the names of its columns.
ARRAYS = ("input_unit", "output_unit")


def options(command: str) -> dict[str, tuple[str, bool, bool]]:
    """The options of a command: help, whether a value follows, whether it may be repeated."""
    found = _tauscope.options(command) or []
    shown = (option for option in found if option[0] not in HIDDEN)
    return {name: (about, takes, many) for name, about, takes, many in shown}


def defaults(command: str) -> dict[str, bool | None]:
    """The settings of a command as keyword arguments, with what leaves the program its own."""
    found = options(command)
    of_arrays = ARRAYS if "sample-period" in found else ()
    switches = {name.replace("-", "_"): None if of[1] else False for name, of in found.items()}
    return {**switches, **dict.fromkeys(of_arrays)}


def keywords(command: str) -> list[str]:
    """The names of a command's settings, as keyword arguments."""
    return sorted(defaults(command))


def arguments(command: str, settings: Mapping[str, Any]) -> list[str]:
    """Settings as arguments of the command line.

    >>> arguments("estimate", {"alpha": 5, "keep_first_last": True, "max_sse": None})
    ['--alpha=5', '--keep-first-last']
    """
    known = options(command)
    typed: list[str] = []
    for name, value in settings.items():
        option = name.replace("_", "-")
        if name in ARRAYS and option not in known:
            if value is None:
                continue
            raise TypeError(f"`{name}` is for arrays; a log says it in the names of its columns")
        if option not in known:
            raise TypeError(_unknown(command, name))
        _, takes, many = known[option]
        if value is None or value is False:
            continue
        if not takes:
            typed.append(f"--{option}")
        elif many and not isinstance(value, str) and isinstance(value, Iterable):
            typed.extend(f"--{option}={_word(each)}" for each in value)
        else:
            typed.append(f"--{option}={_word(value)}")
    return typed


def _word(value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Iterable):
        return ",".join(_word(each) for each in value)
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return str(value)


def _unknown(command: str, name: str) -> str:
    known = keywords(command)
    near = difflib.get_close_matches(name, known, n=1)
    hint = f"; did you mean `{near[0]}`?" if near else ""
    return f"{command}() has no setting `{name}`{hint} Its settings are: {', '.join(known)}"
