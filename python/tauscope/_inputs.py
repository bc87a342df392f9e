"""Logs as users have them: files, tables, arrays.

Tables are handed on through the Arrow C interface, numbers as arrays of float64. None is copied
here where it is one already; the native part copies each once, and then lets go of the
interpreter.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _tauscope

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
    """Whether it has columns; a column of Arrow by itself has a type instead."""
    is_column = hasattr(data, "dtype") or hasattr(data, "type")
    return hasattr(data, "columns") or (hasattr(data, "__arrow_c_stream__") and not is_column)


def _arrow_table(data: Any) -> Any:
    """A table of pandas or pyarrow whose values lie where the native part takes them.

    What came over a network, as a frame of Dask, may lie at any address: it is copied.
    """
    import pyarrow as pa

    table = pa.Table.from_pandas(data) if isinstance(data, pd.DataFrame) else data
    chunks = [chunk for column in table.columns for chunk in column.chunks]
    buffers = [buffer for chunk in chunks for buffer in chunk.buffers() if buffer is not None]
    if all(buffer.address % 8 == 0 for buffer in buffers):
        return table
    copy = pa.BufferOutputStream()
    with pa.ipc.new_stream(copy, table.schema) as stream:
        stream.write_table(table)
    return pa.ipc.open_stream(copy.getvalue()).read_all()


def _table(name: str, data: Any) -> tuple[str, Any]:
    """A table as it lies in memory; column by column where it does not speak Arrow."""
    is_pandas = isinstance(data, pd.DataFrame)
    if hasattr(data, "__arrow_c_stream__"):
        try:
            if is_pandas:
                return name, _tauscope.Frame(_arrow_table(data), _index_names(data.index))
            is_of_pyarrow = hasattr(data, "to_batches") and hasattr(data, "column_names")
            return name, _tauscope.Frame(_arrow_table(data) if is_of_pyarrow else data, {})
        except (ImportError, TypeError, ValueError):
            # pandas speaks Arrow by pyarrow alone, and not where a column is of several types.
            if not is_pandas:
                raise
    columns: list[tuple[str, Any]] = []
    if is_pandas and _is_time(data.index):
        columns.append(("time_s", _seconds(np.asarray(data.index))))
    columns.extend((str(column), _values(data[column])) for column in data.columns)
    return name, columns


def _index_names(index: Any) -> dict[str, str | None]:
    """What the columns that pandas makes of an index are called; one without a name is left out."""
    names: dict[str, str | None] = {}
    for level, name in enumerate(index.names):
        column = f"__index_level_{level}__" if name is None else str(name)
        is_time = _is_time(index.get_level_values(level))
        names[column] = "time_s" if is_time else name if name is None else str(name)
    return names


def _is_time(index: Any) -> bool:
    types = pd.api.types
    return bool(types.is_datetime64_any_dtype(index) or types.is_timedelta64_dtype(index))


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
