"""Models: their text, their effects, their simulation, and where they go."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import tauscope
from tauscope import Model

LOG = Path(__file__).parents[2] / "data" / "hidden_effect.csv"


def steps(n: int = 600) -> np.ndarray:
    return np.repeat(np.random.default_rng(2).uniform(-2, 2, n // 60), 60)


def test_a_model_is_saved_and_loaded(tmp_path: Path) -> None:
    model = Model.integrator(11.9, 0.15, "boom").with_effect("dead_band", upper=0.6, lower=-0.6)
    kept = Model.load(model.save(tmp_path / "boom.toml"))
    assert kept["boom"] == model["boom"]
    assert kept.effects[0].parameters == {"lower": -0.6, "upper": 0.6}
    assert repr(kept) == "<Model boom: integrator + dead_band>"


def test_the_integrator_is_what_numpy_says() -> None:
    u = steps()
    found = Model.integrator(10.0, 0.05).simulate(u, 0.01, output=3.0)
    late = np.concatenate([np.full(5, u[0]), u[:-5]])
    expected = 3.0 + 0.1 * np.concatenate([[0.0], np.cumsum(late)[:-1]])
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_an_effect_of_a_users_own_is_an_expression() -> None:
    u = steps()
    plain = Model.integrator(10.0, 0.05)
    own = plain.with_effect("weak", stage="input", expression="signal * (1 - a)", a=0.25)
    np.testing.assert_allclose(own.predict(u, 0.01), 0.75 * plain.predict(u, 0.01), atol=1e-9)


def test_values_are_changed_by_name() -> None:
    model = Model.integrator(10.0, 0.05).with_effect("backlash", width=0.5)
    changed = model.with_values(gain=12.0, backlash__width=0.7)
    assert changed["joint"].gain == 12.0
    assert changed.effects[0].parameters == {"width": 0.7}
    with pytest.raises(tauscope.TauscopeError, match=r"backlash\.width"):
        model.with_values(backlash__with=1.0)


def test_what_is_wrong_with_a_model_is_said() -> None:
    with pytest.raises(tauscope.TauscopeError, match="dead_band"):
        Model.integrator(1.0, 0.1).with_effect("deadband")
    text = Model.integrator(1.0, 0.1, "a").text
    both = Model(text + Model.integrator(1.0, 0.1, "b").text.split("\n", 1)[1])
    with pytest.raises(TypeError, match="a, b"):
        both.with_effect("dead_band")


def test_a_fit_finds_what_made_the_record() -> None:
    truth = Model.integrator(10.0, 0.13).with_effect("dead_band", lower=-0.4, upper=0.5)
    u = steps(6000)
    y = truth.predict(u, 0.01) + np.random.default_rng(1).normal(0, 0.01, len(u))
    start = Model.integrator(8.0, 0.1).with_effect("dead_band", lower=-0.2, upper=0.2)
    fitted = start.fit((u, y), sample_period=0.01, split=1)
    assert fitted["joint"].gain == pytest.approx(10.0, rel=1e-3)
    assert fitted.effects[0].parameters["upper"] == pytest.approx(0.5, abs=0.01)
    score = fitted.score((u, y), sample_period=0.01)
    assert 0.9999 < score <= 1.0
    assert start.score((u, y), sample_period=0.01) < score


def test_an_exported_module_moves_as_the_model(tmp_path: Path) -> None:
    model = Model.integrator(10.0, 0.13).with_effect("stiction", start=0.5, stop=0.3)
    assert model.export(tmp_path / "joint.py") == []
    spec = importlib.util.spec_from_file_location("exported", tmp_path / "joint.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    u = steps()
    np.testing.assert_allclose(module.simulate(u, 0.01, 2.0), model.predict(u, 0.01, output=2.0))


def test_the_linear_part_is_a_transfer_function() -> None:
    control = pytest.importorskip("control")
    model = Model.integrator(10.0, 0.13).with_effect("actuator_lag", time_constant=0.2)
    linear, dead_time = model.to_control()
    assert dead_time == 0.13
    assert np.real(control.evalfr(linear, 1.0)) == pytest.approx(10.0 / 1.2)
    whole, rest = model.to_control(pade=3)
    assert rest == 0.0
    assert abs(control.evalfr(whole, 2j)) == pytest.approx(abs(control.evalfr(linear, 2j)))


def test_the_fitted_model_of_a_log_follows_it() -> None:
    model = Model(tauscope.improve(LOG, joint="boom", max_effects=1).model.text)
    assert model.score(LOG, joint="boom") > 0.5
