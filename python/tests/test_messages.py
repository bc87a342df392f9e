"""Errors, warnings and notes name keyword arguments, not options of the command line."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import tauscope
from tauscope._messages import translated

LOG = Path(__file__).parents[2] / "data" / "hidden_effect.csv"


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ("invalid value 'x' for '--alpha <N|Xs>': a", "invalid value 'x' for `alpha=`: a"),
        ("'--paper' cannot go with:\n  --beta <N>", "`paper=True` cannot go with:\n  `beta=`"),
        ("`--fill SECONDS` fills; `--trial none`", '`fill=SECONDS` fills; `trial="none"`'),
        ("`--joint NAME=IN:OUT` says which", '`joint="NAME=IN:OUT"` says which'),
        ("`--time 't [ms]'` or `--resample 0.01`", '`time="t [ms]"` or `resample=0.01`'),
        ("--joint boom: named twice", '`joint="boom"`: named twice'),
        ("--beta: give --model or a log", "`beta=`: give `model=` or a log"),
        ("--output-limits LO,HI (--alpha 2).", "`output_limits=(LO, HI)` (`alpha=2`)."),
        ("with --output-limits -4.5,40, --paper", "with `output_limits=(-4.5, 40)`, `paper=True`"),
        ("--min-delay 0.5s or --confidence none", '`min_delay="0.5s"` or `confidence="none"`'),
        ("leave out --output, -o; use `-o x.rrd`", 'leave out `output=`, -o; use `output="x.rrd"`'),
        ("`tauscope compare --fit` fits", "`tauscope.compare(fit=True)` fits"),
        ("`tauscope estimate` gives it", "`tauscope.estimate()` gives it"),
    ],
)
def test_options_are_keyword_arguments(said: str, expected: str) -> None:
    assert translated("estimate", said) == expected


@pytest.mark.parametrize(
    "said",
    [
        "`--connect` and --write model.toml are for terminals",
        "build it with `--features parquet`",
        "`tauscope add dead_band LOG.csv --fill 1`",
        "ask: tauscope explain LOG.csv --effects dead_band,stiction",
        "joint `estimate` -- a dash, and a--fill",
    ],
)
def test_what_is_no_keyword_argument_stays(said: str) -> None:
    assert translated("estimate", said) == said


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: tauscope.estimate(LOG, max_delay=0), "for `max_delay=`: expected"),
        (lambda: tauscope.estimate(LOG, paper=True, first_last="keep"), "with `first_last=`"),
        (lambda: tauscope.compare(LOG, horizon="long"), "for `horizon=`: expected"),
        (lambda: tauscope.read(LOG, fill="long"), "for `fill=`: expected"),
        (lambda: tauscope.design(separate="dead_band"), "`separate=`: expected two"),
        (lambda: tauscope.design(output_range=(-1, 1)), "give `model=` or a log"),
        (lambda: tauscope.simulate(strength="weak"), "`strength=`: is for"),
    ],
)
def test_errors_name_the_keyword_argument(call, named: str) -> None:
    with pytest.raises(tauscope.TauscopeError, match=re.escape(named)) as refused:
        call()
    assert "--" not in str(refused.value)
    assert refused.value.row is None


def test_warnings_and_notes_name_it_too() -> None:
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-2, 2, 40), 50)
    y = -np.roll(np.cumsum(u), -9) * 0.01 + rng.normal(0, 0.01, len(u))
    found = tauscope.estimate((u, y), sample_period=0.01)
    said = " ".join(found.notes)
    assert "`accept_anyway=True`" in said, said
    assert "--" not in said
