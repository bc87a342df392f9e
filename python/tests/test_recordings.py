"""Recordings made from Python hold what those of the program do."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import tauscope

if not tauscope.HAS_RECORDINGS:
    pytest.skip("the package was built without recordings", allow_module_level=True)
rr = pytest.importorskip("rerun")
RrdReader = pytest.importorskip("rerun.experimental").RrdReader

ROOT = Path(__file__).parents[2]
LOG = ROOT / "data" / "hidden_effect.csv"


def contents(path: Path) -> dict[tuple[str, str], list[Any]]:
    """The values of each column of each entity; ids of rows are random."""
    found: dict[tuple[str, str], list[Any]] = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if not name.startswith("rerun.controls"):
                values = found.setdefault((str(chunk.entity_path), name), [])
                values.extend(batch.column(name).to_pylist())
    return found


def assert_same(found: Path, expected: Path) -> None:
    one, other = contents(found), contents(expected)
    assert sorted(one) == sorted(other)
    for key, values in other.items():
        if "start_time" not in key[1]:
            assert one[key] == values, key


def recorded(folder: Path, *arguments: str) -> Path:
    """The recording of the program."""
    program = os.environ.get("TAUSCOPE")
    if program is None:
        pytest.skip("TAUSCOPE does not name the program to compare with")
    path = folder / "program.rrd"
    done = subprocess.run(
        [program, *arguments, "--quiet", "--output", path],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return path


def test_a_recording_holds_the_log_and_every_decision(tmp_path: Path) -> None:
    found = tauscope.estimate(pd.read_csv(LOG))
    values = contents(found.save(tmp_path / "delays.rrd"))
    output = values["/boom/output/raw", "Scalars:scalars"]
    expected = tauscope.read(LOG)["boom"].trials[0].output
    assert [value for row in output for value in row] == expected.tolist()
    assert any("decision" in entity for entity, _ in values)


def test_it_is_that_of_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    expected = recorded(tmp_path, "estimate", "data/hidden_effect.csv", "--alpha=8")
    given = tmp_path / "given.rrd"
    found = tauscope.estimate("data/hidden_effect.csv", alpha=8, output=given)
    assert_same(given, expected)
    assert_same(found.save(tmp_path / "copied.rrd"), expected)
    again = tauscope.estimate("data/hidden_effect.csv", alpha=8)
    assert_same(again.save(tmp_path / "saved.rrd"), expected)


def test_what_takes_long_is_not_done_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    path = "data/hidden_effect.csv"
    better = tauscope.improve(path, joint="boom", max_effects=1)
    assert not any("tauscope_" in note for note in better.notes)
    begun = time.perf_counter()
    saved = better.save(tmp_path / "better.rrd")
    assert time.perf_counter() - begun < 0.5
    words = ("--joint=boom", "--max-effects=1", "--write", str(tmp_path / "model.toml"))
    expected = recorded(tmp_path, "improve", path, *words)
    assert sorted(contents(saved)) == sorted(contents(expected))


def test_a_stream_of_a_users_own_gets_it(tmp_path: Path) -> None:
    stream = rr.RecordingStream("mine", make_default=False)
    stream.save(tmp_path / "mine.rrd")
    stream.log("own", rr.Scalars([1.0]))
    found = tauscope.estimate(LOG, joint="boom")
    found.log(stream)
    stream.flush()
    stream.disconnect()
    entities = set()
    reader = RrdReader(str(tmp_path / "mine.rrd"))
    for store in reader.recordings():
        entities |= {str(chunk.entity_path) for chunk in reader.stream(store=store)}
    assert {"/own", "/boom/output/raw"} <= entities


def test_a_report_has_a_recording_beside_it(tmp_path: Path) -> None:
    tauscope.report(LOG, tmp_path / "page.html", joint="boom")
    assert (tmp_path / "page.rrd").stat().st_size > 10_000
