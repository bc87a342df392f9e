"""Effects that are functions of Python, and what is written of their parameters."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Mapping
from typing import Any

from . import _tauscope

#: A value, or a dictionary of what a model file says of a parameter.
Parameter = float | Mapping[str, Any]


def own_function(
    name: str,
    stage: str,
    function: Callable[..., Any],
    states: Mapping[str, str | float],
    parameters: Mapping[str, Parameter],
) -> tuple[_tauscope.Function, dict[str, Parameter]]:
    """The effect, and its parameters: those that are given, and the function's own defaults."""
    given: dict[str, Parameter] = dict(parameters)
    arguments = inspect.signature(function).parameters.values()
    for argument in arguments:
        if argument.kind not in (argument.POSITIONAL_ONLY, argument.POSITIONAL_OR_KEYWORD):
            raise TypeError(f"effect `{name}`: `{argument}` is no plain argument of its function")
        if argument.default is not argument.empty:
            given.setdefault(argument.name, argument.default)
    names = [argument.name for argument in arguments]
    unknown = [parameter for parameter in given if parameter not in names]
    if unknown:
        raise TypeError(f"effect `{name}`: its function has no argument `{unknown[0]}`")
    tables = {parameter: _table(value) for parameter, value in given.items()}
    native = [
        (parameter, table["value"], table.get("min"), table.get("max"), table.get("neutral", 0.0))
        for parameter, table in tables.items()
    ]
    kept = {"value", "min", "max", "fixed"}
    values = {
        parameter: {key: value for key, value in table.items() if key in kept}
        for parameter, table in tables.items()
    }
    starts = [(state, _start(name, state, start)) for state, start in states.items()]
    return _tauscope.Function(name, stage, function, names, native, starts), {**values}


def _start(name: str, state: str, start: str | float) -> float | None:
    if start == "signal":
        return None
    if isinstance(start, str):
        raise TypeError(f'effect `{name}`: state `{state}` starts at a number, or as "signal"')
    return float(start)


def _table(value: Parameter) -> dict[str, Any]:
    table = dict(value) if isinstance(value, Mapping) else {"value": float(value)}
    return {**table, "value": float(table.get("value", table.get("neutral", 0.0)))}


def written(parameters: Mapping[str, Parameter]) -> str:
    """Parameters as in a model file.

    >>> written({"a": 1, "b": {"value": 2, "min": 0, "fixed": True}})
    'a = 1.0, b = { value = 2.0, min = 0.0, fixed = true }'
    """
    return ", ".join(f"{name} = {_written(value)}" for name, value in parameters.items())


def _written(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + written(value) + " }"
    if isinstance(value, (bool, str)):
        return str(value).lower() if isinstance(value, bool) else json.dumps(value)
    return repr(float(value))
