"""Writes ``tauscope/_options.py``: the keyword arguments of each command, for editors and mypy.

Names and help are those of the compiled module, and so are types and defaults, by the words in
which its help speaks of values. ``python stubs.py`` writes the file anew.
"""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

from tauscope import _tauscope
from tauscope._messages import COMMANDS, translated
from tauscope._settings import ARRAYS, options

PATH = Path(__file__).parent / "tauscope" / "_options.py"

HEAD = '''\
"""The keyword arguments of each command, as types; ``python stubs.py`` writes this file.

``None`` is as good as leaving a setting out.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Literal, TypedDict

File = str | os.PathLike[str]
'''

#: What follows an option in the help, as a type. What names a file, and words in lower case,
#: which are taken as they are, are not here.
TYPES = {
    **dict.fromkeys(["X", "SHARE", "HZ", "PHI", "SAMPLES", "SECONDS"], "float"),
    **dict.fromkeys(["COLUMN", "TEXT", "NAME", "NAME[=IN:OUT]", "EFFECT,EFFECT"], "str"),
    "NAME[:KEY=NUMBER,...]": "str",
    "NAMES": "str | Sequence[str]",
    "N": "int",
    "Xs": "float | str",
    "SIZE": "int | str",
    "LO,HI": "tuple[float, float] | str",
    "MIN,MAX": "tuple[float, float] | str",
    "LIST": "float | str | Sequence[float | str]",
}

#: Arguments of the functions that are options of the program.
OWN = {"report": {"output"}, "simulate": {"output", "truth"}}

#: Name, type and help of a setting.
Setting = tuple[str, str, str]


def blocks(command: str) -> dict[str, str]:
    """What the help says of each option after its name."""
    run = _tauscope.read if command == "read" else _tauscope.run
    try:
        run([command, "--help"])
    except _tauscope.TauscopeError as error:
        parts = re.split(r"(?m)^ +(?:-\w, )?--(?=[a-z])", str(error))[1:]
        return {re.split(r"[\s\[]", part)[0]: part for part in parts}
    raise AssertionError(f"{command} has no help")


def words(block: str) -> list[str]:
    """The values that the help lists."""
    inline = re.search(r"\[possible values: ([^\]]+)\]", block)
    if inline:
        return inline[1].split(", ")
    listed = block.partition("Possible values:")[2]
    return re.findall(r"(?m)^ +- ([\w-]+)(?::|$)", listed)


def literal(values: list[str]) -> str:
    quoted = ", ".join(f'"{value}"' for value in values)
    return f"Literal[{quoted}]"


def kind(block: str, many: bool) -> str:
    """The type of an option with a value."""
    found = re.match(r"[a-z-]+ <([^>]+)>", block)
    assert found is not None, block
    listed, value = words(block), found[1]
    if listed:
        one = literal(listed)
    elif re.search(r"FILE|FOLDER|\.(csv|toml|rrd)", value):
        one = "File"
    elif many and value == "LIST":
        one = "str"
    else:
        parts = value.split("|")
        lower = [part for part in parts if part.islower()]
        types = " | ".join(TYPES[part] for part in parts if part not in lower).split(" | ")
        kept = [each for each in dict.fromkeys(types) if not (each == "int" and "float" in types)]
        one = " | ".join([*kept, *([literal(lower)] if lower else [])])
    return f"{one} | Sequence[{one}] | None" if many else f"{one} | None"


def settings(command: str) -> list[Setting]:
    """The settings of a command's function."""
    said = blocks(command)
    found: list[Setting] = []
    for option, (about, takes, many) in options(command).items():
        if option in OWN.get(command, ()):
            continue
        block = said[option]
        default = re.search(r"\[default: [^\]]+\]", block)
        if default and "[default:" not in about:
            about = f"{about} {' '.join(default[0].split())}"
        text = translated(command, about.replace("May be repeated", "May be a list")) + "."
        found.append((option.replace("-", "_"), kind(block, many) if takes else "bool", text))
    return found


def written(name: str, base: str, about: str, found: list[Setting]) -> str:
    lines = [f"\n\nclass {name}({base}, total=False):", f'    """{about}"""', ""]
    for setting, type_, text in found:
        lines.append(field(setting, type_))
        wrapped = textwrap.wrap(f'"""{text}"""', 96, break_on_hyphens=False)
        lines.extend(f"    {line}" for line in wrapped)
    return "\n".join(lines) + "\n"


def field(setting: str, type_: str) -> str:
    """The line of a setting; as ruff breaks it, if it is too long."""
    line = f"    {setting}: {type_}"
    if len(line) <= 100:
        return line
    parts = "\n        | ".join(re.split(r" \| (?![^\[]*\])", type_))
    return f"    {setting}: (\n        {parts}\n    )"


def module() -> str:
    """The text of ``tauscope/_options.py``."""
    reading = settings("read")
    units = [(name, "str | None", "Of arrays: the unit, as in a log.") for name in ARRAYS]
    text = HEAD + written("ReadOptions", "TypedDict", "How logs are read.", [*reading, *units])
    for command in COMMANDS:
        found = settings(command)
        is_reading = all(setting in found for setting in reading)
        rest = [setting for setting in found if not is_reading or setting not in reading]
        base = "ReadOptions" if is_reading else "TypedDict"
        about = f"The settings of :func:`tauscope.{command}`."
        text += written(f"{command.capitalize()}Options", base, about, rest)
    return text


if __name__ == "__main__":
    PATH.write_text(module(), encoding="utf-8")
