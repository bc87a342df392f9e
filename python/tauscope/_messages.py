"""What the program says, in the words of Python: ``--max-delay 5`` is ``max_delay=5``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager

from . import _tauscope
from ._settings import options

#: The commands that are functions of the package.
COMMANDS = (
    "estimate",
    "sweep",
    "compare",
    "explain",
    "add",
    "improve",
    "report",
    "design",
    "simulate",
)

_NAME = r"[a-z][a-z-]*[a-z]"
_NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?s?"
_PLACEHOLDER = r"[A-Z]+"
_PLAIN = rf"(?:{_NUMBER}|{_PLACEHOLDER})(?![\w.]\w)"

#: What is looked for, the first that fits: a command with nothing but options in backticks; an
#: option in backticks, with its value; anything else in backticks, and a command line, which
#: stay; an option in quotes, with its placeholder; one at the start, with its value; one among
#: words, whose value is told from words by its looks.
_SPOKEN = re.compile(
    rf"`(?:tauscope )?(?P<command>{'|'.join(COMMANDS)})(?P<options>(?: --[^`]*)?)`"
    rf"|`--(?P<marked>{_NAME})(?:[ =](?P<marked_value>[^`]+))?`"
    rf"|`[^`]*`|\btauscope (?:{'|'.join(COMMANDS)})\b[^;\n]*"
    rf"|'--(?P<quoted>{_NAME})[^']*'"
    rf"|\A--(?P<first>{_NAME}) (?P<first_value>\S+)(?=: )"
    rf"|(?<![\w-])--(?P<bare>{_NAME})"
    rf"(?: \[?<[^>\n]*>\]?(?:\.\.\.)?| (?P<bare_value>{_PLAIN}(?:,{_PLAIN})*|none|auto)\b)?"
)


def translated(command: str, said: str) -> str:
    """What a command says, with the keyword arguments of its function instead of its options.

    Options that the function has not, and command lines, are left as they are.

    >>> translated("estimate", "invalid value '0' for '--max-delay <N|Xs>': expected seconds")
    "invalid value '0' for `max_delay=`: expected seconds"
    >>> translated("estimate", "`--joint NAME=INPUT:OUTPUT` says which, `--fill SECONDS` fills")
    '`joint="NAME=INPUT:OUTPUT"` says which, `fill=SECONDS` fills'
    """

    def spoken(match: re.Match[str]) -> str:
        of = match.groupdict()
        if of["command"] is not None:
            typed = of["options"].split(" --")[1:]
            if not typed and not match[0].startswith("`tauscope "):
                return match[0]
            given = [_keyword(of["command"], *each.partition(" ")[::2]) for each in typed]
            if None in given:
                return match[0]
            return f"`tauscope.{of['command']}({', '.join(filter(None, given))})`"
        name = of["marked"] or of["quoted"] or of["first"] or of["bare"]
        value = of["marked_value"] or of["first_value"] or of["bare_value"] or ""
        keyword = _keyword(command, name, value) if name else None
        return match[0] if keyword is None else f"`{keyword}`"

    return _SPOKEN.sub(spoken, said.replace("`-o ", "`--output "))


def _keyword(command: str, option: str, value: str) -> str | None:
    """An option as the keyword argument of the command's function, if it has one."""
    name = option.replace("-", "_")
    if option == "model" and command != "simulate":
        return f"{name}={_value(value)}"
    found = options(command).get(option)
    if found is None:
        return None
    return f"{name}={_value(value)}" if found[1] else f"{name}=True"


def _value(typed: str) -> str:
    """A value of the command line as one of Python; numbers and placeholders stay."""
    parts = typed.split(",")
    if typed and not all(re.fullmatch(rf"{_NUMBER}|{_PLACEHOLDER}", part) for part in parts):
        return json.dumps(typed.strip("'\""), ensure_ascii=False)
    if len(parts) > 1:
        return f"({', '.join(parts)})"
    return json.dumps(typed) if typed.endswith("s") else typed


@contextmanager
def in_python(command: str) -> Iterator[None]:
    """Within it an error of the program is raised in the words of Python."""
    try:
        yield
    except _tauscope.TauscopeError as error:
        error.args = tuple(translated(command, str(each)) for each in error.args)
        raise
