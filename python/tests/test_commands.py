"""The functions give what the program prints, whatever the data come as."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tauscope
from tauscope._messages import translated
from tauscope._settings import arguments

ROOT = Path(__file__).parents[2]
DATA = ROOT / "data"
LOG = DATA / "hidden_effect.csv"
OTHERS = sorted((ROOT.parent / "shared" / "data").rglob("*.csv"))
LOGS = sorted(path for path in DATA.glob("*.csv") if not path.name.endswith(".truth.csv"))


def program() -> str:
    """The program; ``TAUSCOPE`` names it, so that it is that of the same sources."""
    found = os.environ.get("TAUSCOPE")
    if found is None:
        pytest.skip("TAUSCOPE does not name the program to compare with")
    return found


def printed(*arguments: str) -> str:
    done = subprocess.run(
        [program(), *arguments, "--format=json", "--quiet"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in (0, 1), done.stderr
    return done.stdout.strip()


def without_sources(text: str) -> dict:
    found = json.loads(text)
    found.pop("sources")
    return found


@pytest.mark.parametrize("log", LOGS, ids=lambda path: path.stem)
def test_estimate_is_that_of_the_program(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    path = str(log.relative_to(ROOT))
    settings = {"first_last": "keep", "alpha": 8}
    expected = printed("estimate", path, "--first-last=keep", "--alpha=8")
    assert tauscope.estimate(path, **settings).to_json() == expected
    table = pd.read_csv(log, comment="#")
    found = tauscope.estimate(table, **settings)
    assert without_sources(found.to_json()) == without_sources(expected)


@pytest.mark.parametrize("log", OTHERS or [None], ids=lambda path: path and path.stem)
@pytest.mark.filterwarnings("ignore::tauscope.TauscopeWarning")
def test_logs_of_other_machines_give_what_the_program_prints(log: Path | None) -> None:
    if log is None:
        pytest.skip("the logs of other machines, ../shared/data, are not here")
    done = subprocess.run(
        [program(), "estimate", log, "--format=json", "--quiet"],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 2:
        with pytest.raises(tauscope.TauscopeError) as refused:
            tauscope.estimate(log)
        said = done.stderr.removeprefix("error: ")
        assert str(refused.value) in translated("estimate", said)
        return
    assert tauscope.estimate(log).to_json() == done.stdout.strip()
    found, expected = tauscope.read(pd.read_csv(log, comment="#")), tauscope.read(log)
    assert list(found) == list(expected)
    for joint, same in zip(found.values(), expected.values(), strict=True):
        for trial, other in zip(joint.trials, same.trials, strict=True):
            assert (trial.trial, trial.sample_period) == (other.trial, other.sample_period)
            # pandas rounds the last digit of a decimal number otherwise than the program.
            np.testing.assert_allclose(trial.input, other.input, rtol=1e-15)
            np.testing.assert_allclose(trial.output, other.output, rtol=1e-15)


@pytest.mark.parametrize(
    ("command", "settings"),
    [
        ("compare", {}),
        ("compare", {"horizon": "free", "split": 0.5}),
        ("sweep", {"alpha": [5, 10], "beta": [5], "passband": "none"}),
        ("explain", {"effects": "dead_band,gravity_load"}),
    ],
)
def test_other_commands_give_what_the_program_prints(
    command: str, settings: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    path = str(LOG.relative_to(ROOT))
    found = getattr(tauscope, command)(path, **settings)
    assert found.to_json() == printed(command, path, *arguments(command, settings))


def test_arrays_give_the_same_as_the_file() -> None:
    joints = tauscope.read(LOG)
    arrays = {name: (of.trials[0].input, of.trials[0].output) for name, of in joints.items()}
    found = tauscope.estimate(arrays, sample_period=0.01, input_unit="V", output_unit="deg").data[
        "joints"
    ]
    expected = tauscope.estimate(LOG).data["joints"]
    assert [joint["decisions"] for joint in found] == [joint["decisions"] for joint in expected]


def test_a_long_result_is_whole_wherever_it_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond 4 MB it goes to a file; where none can be made, or the disk is full, to memory."""
    resource = pytest.importorskip("resource")
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-2, 2, 15_000), 20)
    y = np.concatenate([np.zeros(5), np.cumsum(0.1 * u)[:-5]]) + rng.normal(0, 0.01, len(u))
    found = tauscope.estimate((u, y), sample_period=0.01)
    text = found.to_json()
    assert len(text) > 9 << 20
    assert len(found.decisions) == len(json.loads(text)["joints"][0]["decisions"])
    assert found.to_json() == text
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8500 << 10, limits[1]))
    try:
        full = tauscope.estimate((u, y), sample_period=0.01)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert full.to_json() == text
    monkeypatch.setenv("TMPDIR", "/nowhere")
    assert tauscope.estimate((u, y), sample_period=0.01).to_json() == text


def test_polars_gives_the_same_as_pandas() -> None:
    polars = pytest.importorskip("polars")
    table = pd.read_csv(LOG)
    found = tauscope.estimate(polars.read_csv(LOG, infer_schema_length=None))
    assert without_sources(found.to_json()) == without_sources(tauscope.estimate(table).to_json())


def test_a_column_of_trials_and_an_index_of_times_are_read() -> None:
    table = pd.read_csv(LOG)
    table["trial"] = np.where(np.arange(len(table)) < 4000, "one", "two")
    joints = tauscope.read(table)
    assert [trial.trial for trial in joints["boom"].trials] == ["one", "two"]
    timed = pd.read_csv(LOG).set_index("time_s")
    timed.index = pd.to_timedelta(timed.index, unit="s")
    assert tauscope.read(timed)["boom"].trials[0].sample_period == pytest.approx(0.01)


def test_results_are_tables() -> None:
    found = tauscope.estimate(LOG)
    assert set(found.decisions["joint"]) == {"boom", "arm"}
    assert found.decisions["doubt"].between(0, 1).all()
    assert all(isinstance(flags, list) for flags in found.decisions["flags"])
    assert (found.delays["delta_s"] > 0).all()
    assert "delay_median_s" in found.delay_table
    html = found._repr_html_()
    assert "<svg" in html and "boom" in html
    assert repr(found) == "<tauscope estimate: boom, arm>"
    with pytest.raises(KeyError, match="boom"):
        found["bom"]


def test_explain_and_improve_are_those_of_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    path = str(LOG.relative_to(ROOT))
    steps: list[tuple[str, int, int]] = []
    found = tauscope.explain(path, joint="boom", progress=lambda *step: steps.append(step))
    model = str(tmp_path / "model.toml")
    expected = printed("explain", path, "--joint=boom")
    assert found.to_json() == expected
    ranking = json.loads(expected)["joints"][0]["ranking"]
    assert [row["effect"] for row in ranking] == list(found.ranking["effect"])
    verdicts = found.verdicts.set_index("joint")
    assert verdicts["verdict"].to_dict() == {"boom": "missing_effect"}
    assert verdicts["headline"]["boom"] == found.headline()
    first = found.ranking.iloc[0]
    assert set(first["parameters"]) == set(ranking[0]["parameters"])
    assert first["indistinguishable_from"] == ", ".join(ranking[0]["indistinguishable_from"])
    assert steps and steps[-1][0] == "explaining"
    better = tauscope.improve(path, joint="boom", max_effects=1)
    ladder = json.loads(printed("improve", path, "--joint=boom", "--max-effects=1", "-w", model))
    assert better.data["joints"][0]["revisions"] == ladder["joints"][0]["revisions"]
    assert better.model is not None
    assert better.model["boom"] == tauscope.Model.load(model)["boom"]
    assert (
        better.revisions["validation_rmse"].iloc[-1] < better.revisions["validation_rmse"].iloc[0]
    )
    assert "<svg" in better._repr_html_() and "<svg" in found._repr_html_()
    assert better.headline("boom")


def test_a_wrong_setting_is_answered_with_the_right_ones() -> None:
    with pytest.raises(TypeError, match=r"did you mean `alpha`.*passband"):
        tauscope.estimate(LOG, alhpa=3)
    with pytest.raises(TypeError, match="sample_period"):
        tauscope.estimate((np.zeros(9), np.zeros(9)))
    with pytest.raises(TypeError, match="is no log"):
        tauscope.estimate(3.0)
    with pytest.raises(TypeError, match="is no log"):
        tauscope.estimate(None)
    with pytest.raises(TypeError, match="`input_unit` is for arrays"):
        tauscope.estimate(LOG, input_unit="V")
    with pytest.raises(tauscope.TauscopeError, match="alpha") as refused:
        tauscope.estimate(LOG, alpha="many")
    assert "--" not in str(refused.value)


def test_an_error_has_row_and_column() -> None:
    table = pd.read_csv(LOG)
    table.loc[76, "boom.output [deg]"] = np.inf
    with pytest.raises(tauscope.TauscopeError) as refused:
        tauscope.estimate(table, joint="boom")
    assert (refused.value.row, refused.value.column) == (77, "boom.output")
    bad = np.zeros(50)
    bad[30] = np.nan
    with pytest.raises(tauscope.TauscopeError) as refused:
        tauscope.estimate((np.zeros(50), bad), sample_period=0.01)
    assert refused.value.row == 31
    with pytest.raises(tauscope.TauscopeError, match="No such file"):
        tauscope.estimate("no_such_log.csv")


def test_a_joint_that_is_left_out_is_a_warning() -> None:
    with pytest.warns(tauscope.TauscopeWarning, match="wrist"):
        found = tauscope.estimate(LOG, joint=["boom", "wrist"])
    assert not found.complete and len(found.joints) == 1


def test_other_threads_go_on_meanwhile() -> None:
    counted = 0
    ended = threading.Event()

    def count() -> None:
        nonlocal counted
        while not ended.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-2, 2, 4000), 50)
    y = np.cumsum(np.concatenate([np.zeros(12), u[:-12]])) * 0.01
    start = time.perf_counter()
    tauscope.estimate((u, y), sample_period=0.01)
    took = time.perf_counter() - start
    ended.set()
    thread.join()
    assert counted > 50 * min(took, 1.0)


def test_an_interrupt_ends_a_long_call() -> None:
    script = (
        "import os, signal, threading, numpy as np, tauscope\n"
        "u = np.repeat(np.random.default_rng(1).uniform(-2, 2, 4000), 50)\n"
        "y = np.cumsum(np.abs(u) ** 1.5 * np.sign(u)) * 0.01\n"
        "threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        "try:\n"
        "    tauscope.explain((u, y), sample_period=0.01)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
    )
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "interrupted", done.stderr
    assert time.perf_counter() - start < 60


def test_an_interrupt_leaves_what_improve_has_reached() -> None:
    interrupts = iter([KeyboardInterrupt()])

    def interrupt(what: str, done: int, of: int) -> None:
        for each in interrupts:
            raise each

    found = tauscope.improve(LOG, progress=interrupt)
    assert found.stopped and len(found.revisions) > 0
    assert not tauscope.improve(LOG, max_effects=1).stopped


def test_simulate_design_sweep_and_report(tmp_path: Path) -> None:
    made = tauscope.simulate(effect="dead_band", seed=3)
    assert len(made.log) > 1000 and "dead_band" in made.truth
    assert (made.delays["delay_s"] > 0).all() and set(made.delays["joint"]) == {"joint", "other"}
    swept = tauscope.sweep(made.log, alpha=[5, 10], beta=[5], passband="none", method="two-line")
    assert swept.data["schema"] == "tauscope/sweep/1"
    assert len(swept.combinations) == 2 * len(swept.joints) and {"alpha", "accepted"} <= set(
        swept.combinations
    )
    assert len(swept.decisions) > 10
    compared = tauscope.compare(made.log)
    assert set(compared.parameters["parameter"]) == {"gain", "delay"}
    page = tauscope.report(made.log, tmp_path / "page.html", no_recording=True)
    assert page.path.read_text().startswith("<!DOCTYPE html>")
    planned = tauscope.design(largest=2, hold=(0.5, 2), duration=20, seed=1)
    assert len(planned.input) > 100
