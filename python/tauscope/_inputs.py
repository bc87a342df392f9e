"""Logs as users have them: files, tables, arrays.

Numbers are handed on as arrays of float64. None is copied here where it is one already; the
native part copies each once, and then lets go of the interpreter.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

#: What messages call tables.
TABLE = "DataFrame"


def gathered(data: Any, settings: dict[str, Any]) -> tuple[list[str], Any]:
    """The DATA arguments of a command, and the logs in memory; takes what arrays need.

    ``data`` is a path or several; a table (pandas, polars, pyarrow) or several; or a pair of
    arrays, input and output, a list of such pairs (trials), or a mapping from joints to those.
    """
    if isinstance(data, (str, os.PathLike)):
        return [os.fspath(data)], None
    if _is_table(data):
        return [TABLE], [_table(TABLE, data)]
    if isinstance(data, Mapping):
        if data and all(_is_table(each) for each in data.values()):
            return list(map(str, data)), [_table(str(name), each) for name, each in data.items()]
        return ["arrays"], _joints(data, settings)
    if isinstance(data, Sequence) and len(data) > 0:
        if all(isinstance(each, (str, os.PathLike)) for each in data):
            return [os.fspath(each) for each in data], None
        if all(_is_table(each) for each in data):
            names = [f"{TABLE}_{number}" for number in range(1, len(data) + 1)]
            return names, [_table(name, each) for name, each in zip(names, data, strict=True)]
        return ["arrays"], _joints({"joint": data}, settings)
    raise TypeError(
        f"{type(data).__name__} is no log: give a path, a DataFrame, or a pair of arrays "
        "(input, output) with sample_period"
    )


def _is_table(data: Any) -> bool:
    return hasattr(data, "columns") or hasattr(data, "__arrow_c_stream__")


def _table(name: str, data: Any) -> tuple[str, list[tuple[str, Any]]]:
    if not hasattr(data, "to_numpy") or not hasattr(data, "__getitem__"):
        data = _of_arrow(data)
    if hasattr(data, "column_names"):
        data = data.to_pandas()
    columns: list[tuple[str, Any]] = []
    index = getattr(data, "index", None)
    if index is not None and getattr(index, "dtype", None) is not None:
        kind = np.dtype(index.dtype).kind if isinstance(index.dtype, np.dtype) else "O"
        if kind in "mM":
            columns.append(("time_s", _seconds(np.asarray(index))))
    columns.extend((str(column), _values(data[column])) for column in data.columns)
    return name, columns


def _of_arrow(data: Any) -> Any:
    import pyarrow

    return pyarrow.table(data).to_pandas()


def _values(column: Any) -> Any:
    """Numbers as float64, missing ones NaN; times as seconds from the first; else texts."""
    dtype = str(column.dtype)
    if dtype in ("Int64", "Int32", "Float64", "Float32", "boolean"):
        is_pandas = hasattr(column, "iloc")
        values = column.to_numpy(dtype=float, na_value=np.nan) if is_pandas else column.to_numpy()
    else:
        values = column.to_numpy()
    values = np.asarray(values)
    if values.dtype.kind in "mM":
        return _seconds(values)
    if values.dtype.kind in "fiub":
        return np.ascontiguousarray(values, dtype=np.float64)
    return ["" if value is None else str(value) for value in values]


def _seconds(values: npt.NDArray[Any]) -> Array:
    since = values - values[0] if len(values) else values
    return np.ascontiguousarray(since / np.timedelta64(1, "s"), dtype=np.float64)


def _joints(
    data: Mapping[Any, Any], settings: dict[str, Any]
) -> tuple[list[tuple[str, Any, Any, list[tuple[str, Array, Array]]]], float]:
    period = settings.pop("sample_period", None)
    if period is None:
        raise TypeError("arrays have no time: give sample_period, the seconds between samples")
    units = (settings.pop("input_unit", None), settings.pop("output_unit", None))
    joints = [(str(name), *units, _trials(str(name), each)) for name, each in data.items()]
    return joints, float(period)


def _trials(joint: str, data: Any) -> list[tuple[str, Array, Array]]:
    if len(data) == 2 and np.ndim(data[0]) == 1 and np.ndim(data[1]) == 1:
        return [("1", _numbers(joint, data[0]), _numbers(joint, data[1]))]
    if all(len(trial) == 2 for trial in data):
        return [
            (str(number), _numbers(joint, trial[0]), _numbers(joint, trial[1]))
            for number, trial in enumerate(data, start=1)
        ]
    raise TypeError(f"joint `{joint}`: expected a pair of arrays, (input, output), or several")


def _numbers(joint: str, values: Any) -> Array:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise TypeError(
            f"joint `{joint}`: an array of shape {array.shape}, expected one number a sample"
        )
    return array
