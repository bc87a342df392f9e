"""Tables of pandas, polars and pyarrow are read as files with the same columns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tauscope

pa = pytest.importorskip("pyarrow")
pl = pytest.importorskip("polars")

N = 400


def plain() -> pd.DataFrame:
    """Columns of every kind, each with values that all kinds can hold."""
    k = np.arange(N)
    return pd.DataFrame(
        {
            "time_s": 0.01 * k,
            "boom.input [V]": np.where(k // 50 % 2 == 1, 1.0, 0.0),
            "boom.output [deg]": (k % 100).astype(float),
            "boom.pressure [bar]": 100.0 + k % 7,
            "trial": np.where(k < 200, "first", "second"),
        }
    )


def assert_same(table: Any, file: Path) -> None:
    """What is read of the table is what is read of the file."""
    found, expected = tauscope.read(table), tauscope.read(file)
    assert list(found) == list(expected)
    for joint, other in zip(found.values(), expected.values(), strict=True):
        assert (joint.input_unit, joint.output_unit) == (other.input_unit, other.output_unit)
        assert [trial.trial for trial in joint.trials] == [trial.trial for trial in other.trials]
        for trial, same in zip(joint.trials, other.trials, strict=True):
            assert (trial.start_s, trial.sample_period) == (same.start_s, same.sample_period)
            np.testing.assert_array_equal(trial.input, same.input)
            np.testing.assert_array_equal(trial.output, same.output)
            assert list(trial.others) == list(same.others)
            for name, values in trial.others.items():
                np.testing.assert_array_equal(values, same.others[name])


def written(table: pd.DataFrame, folder: Path) -> Path:
    table.to_csv(folder / "log.csv", index=False)
    return folder / "log.csv"


KINDS = ["int8", "uint16", "int32", "int64", "uint64", "float32", "float64", "Int64", "Float32"]


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_of_every_kind_are_those_of_the_file(kind: str, tmp_path: Path) -> None:
    table = plain()
    file = written(table, tmp_path)
    for column in ("boom.input [V]", "boom.output [deg]", "boom.pressure [bar]"):
        table[column] = table[column].astype(kind)
    assert_same(table, file)
    assert_same(pl.from_pandas(table), file)
    assert_same(pa.Table.from_pandas(table), file)


def test_a_switch_is_zero_or_one(tmp_path: Path) -> None:
    table = plain()
    file = written(table, tmp_path)
    for kind in ("bool", "boolean"):
        table["boom.input [V]"] = table["boom.input [V]"].astype(kind)
        assert_same(table, file)
        assert_same(pl.from_pandas(table), file)


def test_what_is_missing_is_missing_in_the_file(tmp_path: Path) -> None:
    table = plain()
    table.loc[[20, 21, 90], "boom.output [deg]"] = np.nan
    table.loc[[33], "boom.input [V]"] = np.nan
    table.loc[120:140, "boom.pressure [bar]"] = np.nan
    file = written(table, tmp_path)
    assert_same(table, file)
    assert_same(pl.from_pandas(table), file)
    assert pl.from_pandas(table)["boom.output [deg]"].null_count() == 3
    nullable = table.convert_dtypes()
    assert str(nullable["boom.output [deg]"].dtype) == "Int64"
    assert_same(nullable, file)


def test_labels_are_texts_categories_or_numbers(tmp_path: Path) -> None:
    table = plain()
    file = written(table, tmp_path)
    for kind in ("object", "string", "category"):
        table["trial"] = table["trial"].astype(kind)
        assert_same(table, file)
    assert_same(pl.from_pandas(table), file)
    assert_same(pl.from_pandas(table).with_columns(pl.col("trial").cast(pl.Categorical)), file)
    table["trial"] = np.where(np.arange(N) < 200, 7, 8)
    assert_same(table, written(table, tmp_path))


def test_times_are_seconds_from_the_first(tmp_path: Path) -> None:
    table = plain()
    file = written(table, tmp_path)
    for unit in ("s", "ms", "us", "ns"):
        dated = table.drop(columns="time_s")
        seconds = pd.to_timedelta(np.arange(N) * (100 if unit == "s" else 1), unit="s") / 100
        dated.index = (pd.Timestamp("2026-01-02 03:04:05") + seconds).as_unit(
            "ns" if unit == "s" else unit
        )
        for index in (dated.index, dated.index.tz_localize("Europe/Berlin")):
            dated.index = index
            scale = 100 if unit == "s" else 1
            period = tauscope.read(dated)["boom"].trials[0].sample_period
            assert period == pytest.approx(0.01 * scale)
    dated = table.assign(time_s=pd.to_timedelta(table["time_s"], unit="s"))
    assert_same(dated, file)
    assert_same(pl.from_pandas(dated), file)


def test_an_index_with_a_name_is_a_column(tmp_path: Path) -> None:
    table = plain()
    file = written(table, tmp_path)
    assert_same(table.set_index("time_s"), file)
    assert_same(table[table["time_s"] >= 0.0].copy(), file)
    shuffled = table.set_axis(np.arange(N) * 3 + 5)
    assert_same(shuffled, file)


def test_a_table_in_chunks_is_one(tmp_path: Path) -> None:
    table = plain()
    file = written(table, tmp_path)
    parts = [pa.Table.from_pandas(table[start : start + 64]) for start in range(0, N, 64)]
    assert_same(pa.concat_tables(parts), file)
    frames = [pl.from_pandas(table[start : start + 64]) for start in range(0, N, 64)]
    assert_same(pl.concat(frames, rechunk=False), file)


def test_numbers_may_lie_at_any_address(tmp_path: Path) -> None:
    """As those of a frame that Dask sent over a network."""
    table = plain().drop(columns="trial")
    bytes_of = b"." + np.asfortranarray(table.to_numpy()).tobytes(order="F")
    odd = np.frombuffer(bytes_of, dtype=float, offset=1).reshape(table.shape, order="F")
    assert not odd.flags.aligned
    sent = pd.DataFrame(odd, columns=table.columns, copy=False)
    assert_same(sent, written(table, tmp_path))
    assert_same(pa.Table.from_pandas(sent), written(table, tmp_path))


def test_pandas_without_arrow_is_read_column_by_column(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(data: pd.DataFrame) -> object:
        raise ImportError("no pyarrow")

    table = plain().assign(note=["text", 3] * (N // 2))
    file = written(table, tmp_path)
    assert_same(table, file)  # A column of several types is none of Arrow's.
    monkeypatch.setattr("tauscope._inputs._arrow_table", missing)
    assert_same(plain(), written(plain(), tmp_path))
    assert_same(plain().convert_dtypes(), written(plain(), tmp_path))


def test_columns_by_themselves_are_arrays() -> None:
    table = plain()
    u, y = table["boom.input [V]"], table["boom.output [deg]"]
    expected = tauscope.estimate((u.to_numpy(), y.to_numpy()), sample_period=0.01).to_json()
    polars = pl.from_pandas(table)
    for pair in ((u, y), (polars["boom.input [V]"], polars["boom.output [deg]"])):
        assert tauscope.estimate(pair, sample_period=0.01).to_json() == expected


def test_what_is_wrong_in_a_table_has_row_and_column() -> None:
    table = plain()
    table.loc[76, "boom.output [deg]"] = np.inf
    for wrong in (table, pl.from_pandas(table), pa.Table.from_pandas(table)):
        with pytest.raises(tauscope.TauscopeError) as refused:
            tauscope.estimate(wrong)
        assert (refused.value.row, refused.value.column) == (77, "boom.output")
    texts = plain().astype({"boom.output [deg]": "string"})
    with pytest.raises(tauscope.TauscopeError) as refused:
        tauscope.estimate(texts)
    assert refused.value.column == "boom.output"
