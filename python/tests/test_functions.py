"""Effects that are functions of Python do what the same expressions do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tauscope
from tauscope import Model

U = np.repeat(np.random.default_rng(2).uniform(-2, 2, 40), 25)
PLAIN = Model.integrator(10.0, 0.05)

#: Stage, expression, function, and its parameters.
PAIRS = [
    ("input", "signal * (1 - a)", lambda signal, a: signal * (1 - a), {"a": 0.25}),
    (
        "load",
        "signal - c * position",
        lambda position, signal, c: signal - c * position,
        {"c": 0.2},
    ),
    ("output", "signal * (1 + b)", lambda signal, b: signal * (1 + b), {"b": 0.5}),
    (
        "dynamics",
        "signal * exp(-k * time)",
        lambda k, signal, time: signal * np.exp(-k * time),
        {"k": 0.1},
    ),
    (
        "transport",
        "k * abs(after - before)",
        lambda before, after, k: k * abs(after - before),
        {"k": 0.05},
    ),
]


@pytest.mark.parametrize(("stage", "expression", "function", "parameters"), PAIRS)
def test_a_function_is_what_the_expression_is(stage, expression, function, parameters) -> None:
    expected = PLAIN.with_effect("own", stage=stage, expression=expression, **parameters)
    found = PLAIN.with_effect("own", stage=stage, function=function, **parameters)
    y = found.simulate(U, 0.01, output=5.0)
    np.testing.assert_allclose(y, expected.simulate(U, 0.01, output=5.0), rtol=1e-12, atol=1e-12)
    assert not np.allclose(y, PLAIN.simulate(U, 0.01, output=5.0))
    effect = found.effects[0]
    assert (effect.kind, effect.stage, effect.parameters) == ("own", stage, parameters)


def test_a_function_of_the_signal_alone_is_called_for_each_level() -> None:
    calls = 0

    def knee(signal: float, a: float = 0.3) -> float:
        nonlocal calls
        calls += 1
        return signal * (1 + a * abs(signal))

    model = PLAIN.with_effect("knee", function=knee)
    calls = 0
    model.simulate(U, 0.01)
    assert calls < 2 * 40 + 10
    assert model.effects[0].parameters == {"a": 0.3}


def test_a_function_is_fitted_and_explained(tmp_path: Path) -> None:
    def soft(signal: float, a: float) -> float:
        return signal / (1 + a * abs(signal))

    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-2, 2, 120), 50)
    truth = PLAIN.with_effect("soft", function=soft, a=0.4)
    y = truth.simulate(u, 0.01) + rng.normal(0, 0.02, len(u))
    start = Model.integrator(8.0, 0.1).with_effect(
        "soft", function=soft, a={"value": 0.1, "min": 0.0, "max": 5.0}
    )
    fitted = start.fit((u, y), sample_period=0.01)
    assert fitted.effects[0].parameters["a"] == pytest.approx(0.4, abs=0.01)
    assert fitted["joint"].gain == pytest.approx(10.0, rel=0.01)
    kept = Model.load(fitted.save(tmp_path / "soft.toml"), functions=fitted.functions)
    assert kept["joint"] == fitted["joint"]
    with pytest.raises(tauscope.TauscopeError, match="soft"):
        Model.load(tmp_path / "soft.toml")
    added = tauscope.add("dead_band", (u, y), fitted, sample_period=0.01)
    assert added.model is not None and added.model.functions == fitted.functions


def test_what_a_function_raises_is_raised() -> None:
    def wrong(signal: float) -> float:
        if signal > 1.9:
            raise LookupError("no such signal")
        return signal

    with pytest.raises(LookupError, match="no such signal"):
        PLAIN.with_effect("wrong", function=wrong)

    def later(signal: float, position: float, a: float) -> float:
        if position > 500:
            raise LookupError(f"at {position}")
        return signal

    model = PLAIN.with_effect("later", function=later, stage="output", a=1.0)
    with pytest.raises(LookupError, match="at"):
        model.simulate(np.full(1000, 1.0), 0.1)
    np.testing.assert_allclose(model.simulate(np.zeros(10), 0.1), 0.0)
    y = PLAIN.simulate(U, 0.1, output=490.0)
    with pytest.raises(LookupError):
        tauscope.compare((U, y), model, sample_period=0.1, fit=True)
    with pytest.raises(tauscope.TauscopeError, match="later"):
        model.export("later.py")


def test_a_function_with_other_arguments_is_refused() -> None:
    for function, parameters, message in (
        (lambda signal, b: signal, {}, "`b` is neither"),
        (lambda signal: signal, {"b": 1.0}, "no argument `b`"),
        (lambda *signal: 0.0, {}, "plain argument"),
        (lambda before: before, {}, "neither"),
    ):
        with pytest.raises((TypeError, tauscope.TauscopeError), match=message):
            PLAIN.with_effect("own", function=function, **parameters)
    with pytest.raises(tauscope.TauscopeError, match="catalogue"):
        PLAIN.with_effect("dead_band", function=lambda signal: signal)
    with pytest.raises(tauscope.TauscopeError, match="stage"):
        PLAIN.with_effect("own", function=lambda signal: signal, stage="sensor")


def test_a_function_with_states_is_what_the_expression_is() -> None:
    expected = PLAIN.with_effect(
        "slow",
        stage="dynamics",
        expression="x / (1 + 0.1 * used)",
        states={
            "x": "x + (signal - x) * min(dt / lag, 1)",
            "used": {"start": "0", "next": "used + abs(signal) * dt"},
        },
        lag=0.2,
    )

    def slow(
        signal: float, dt: float, x: float, used: float, lag: float
    ) -> tuple[float, float, float]:
        x, used = x + (signal - x) * min(dt / max(lag, 1e-9), 1.0), used + abs(signal) * dt
        return x / (1 + 0.1 * used), x, used

    found = PLAIN.with_effect(
        "slow", stage="dynamics", function=slow, states={"x": "signal", "used": 0.0}, lag=0.2
    )
    y = found.simulate(U, 0.01)
    np.testing.assert_allclose(y, expected.simulate(U, 0.01), rtol=1e-12, atol=1e-12)
    assert not np.allclose(y, PLAIN.simulate(U, 0.01))


def test_states_that_do_not_fit_are_refused() -> None:
    def one(signal: float, x: float) -> float:
        return signal + x

    with pytest.raises(TypeError):
        PLAIN.with_effect("one", function=one, states={"x": 0.0})
    with pytest.raises(TypeError, match="starts at a number"):
        PLAIN.with_effect("one", function=one, states={"x": "zero"})
    with pytest.raises(tauscope.TauscopeError, match="there are no states"):
        PLAIN.with_effect("one", stage="transport", function=one, states={"x": 0.0})
    with pytest.raises(TypeError, match="is to return the signal and 1 states"):
        PLAIN.with_effect("one", function=lambda signal, x: (signal, x, x), states={"x": 0.0})


def test_a_function_is_not_called_beyond_the_bounds_of_its_parameters() -> None:
    seen: list[float] = []

    def root(signal: float, a: float) -> float:
        seen.append(a)
        return float(signal * np.sqrt(a - 1.0))

    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-2, 2, 60), 50)
    y = Model.integrator(10.0, 0.05).simulate(u, 0.01) + rng.normal(0, 0.02, len(u))
    start = Model.integrator(5.0, 0.1).with_effect(
        "root", stage="load", function=root, a={"value": 1.5, "min": 1.0, "max": 3.0}
    )
    start.fit((u, y), sample_period=0.01)
    assert seen and min(seen) >= 1.0 and max(seen) <= 3.0
