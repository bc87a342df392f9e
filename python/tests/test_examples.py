"""The examples for Python run as they stand."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

import tauscope

ROOT = Path(__file__).parents[2]


def ran(script: str, *words: str) -> str:
    command = [sys.executable, str(ROOT / "examples" / script), *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_position_controller_has_the_phase_margin_that_it_is_designed_for() -> None:
    pytest.importorskip("control")
    said = ran("control/position_controller.py", str(ROOT / "data" / "hidden_effect.csv"), "boom")
    assert "gravity_load" in said
    margin = float(said.split("phase margin ")[1].split()[0])
    assert margin == pytest.approx(60, abs=2), said


def test_delays_of_a_frame_of_logs_on_a_running_cluster_are_those_of_each_log(
    tmp_path: Path,
) -> None:
    pytest.importorskip("distributed")
    for seed in (1, 2):
        tauscope.simulate(effect="dead_band", seed=seed, output=tmp_path / f"{seed}.csv")
    address = tmp_path / "scheduler.json"
    words = ["--scheduler-file", str(address), "--no-dashboard"]
    cluster = [
        subprocess.Popen(
            [sys.executable, "-m", "distributed.cli.dask_scheduler", *words, "--port", "0"]
        ),
        subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_worker", *words]),
    ]
    try:
        while not address.exists():
            assert all(process.poll() is None for process in cluster)
            time.sleep(0.1)
        scheduler = pd.read_json(address, typ="series")["address"]
        delays = tmp_path / "delays.parquet"
        ran(
            "dask/estimate_frame.py",
            str(tmp_path / "*.csv"),
            "--scheduler",
            scheduler,
            "--delays",
            str(delays),
        )
    finally:
        for process in cluster:
            process.terminate()
    found = pd.read_parquet(delays)
    for seed in (1, 2):
        own = found[found["log"].str.endswith(f"{seed}.csv")].drop(columns="log")
        expected = tauscope.estimate(tmp_path / f"{seed}.csv").delays
        pd.testing.assert_frame_equal(own.reset_index(drop=True), expected, check_dtype=False)
