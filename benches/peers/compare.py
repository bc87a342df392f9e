"""tauscope beside Python packages that find breaks, on the same records.

Joints with known delays are simulated by `tauscope simulate`. Each step is estimated by every
method of tauscope, and by each package from the segment of that step which Algorithm 1 looks
at. Errors are mean magnitudes in samples over the steps that are answered; `covered` is the
part of 95 % intervals that hold the true delay. `time` is the processor's, so that other
programs do not count: that of a package's fits alone over that of the whole command `tauscope
estimate --method hinge`, reading the log, estimating and printing included; one thread each.

Usage: compare.py [--records N] [--duration SECONDS] [--plant NAME]... TAUSCOPE
"""

import argparse
import csv
import json
import logging
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from dataclasses import dataclass, field
from pathlib import Path

# One thread each, as tauscope is given: before numpy is loaded.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402
import piecewise_regression  # noqa: E402
import pwlf  # noqa: E402
import ruptures  # noqa: E402

LONG = "[0.9, 2.0]"
SHORT = "[0.2, 0.5]"

# What is different from a joint that integrates, with noise of 0.05 degrees.
PLANTS = {
    "ideal": (LONG, 0.4, "noise = 0.05"),
    "lag of 6": (LONG, 0.4, "noise = 0.05\nlag_s = 0.06"),
    "ringing": (LONG, 0.4, "noise = 0.05\nringing = { period_s = 0.4, damping = 0.25 }"),
    "noise x 16": (LONG, 0.4, "noise = 0.8"),
    "short holds": (SHORT, 0.3, "noise = 0.05"),
}

PLANT = """\
schema = "tauscope/plant/1"
seed = {seed}
sample_period_s = 0.01
duration_s = {duration_s}
[[joint]]
name = "joint"
gain = 10.0
input = {{ levels = [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0], hold_s = {hold_s} }}
delay = {{ law = "uniform", min = 0.05, max = {longest} }}
{different}
"""

# Fewest samples of a segment that two lines and a break are fitted to.
FEWEST = 8

METHODS = ("two-line", "hinge", "lag-aware")


@dataclass
class Answer:
    """A delay in samples, and its 95 % interval where there is one."""

    delay: float
    low: float = math.nan
    high: float = math.nan


@dataclass
class Segment:
    """The output of one step: its samples, counted from 1, and the step's own."""

    first: int
    step: int
    values: np.ndarray

    def samples(self):
        return np.arange(self.first, self.first + len(self.values), dtype=float)


@dataclass
class Tally:
    """What became of the steps of a plant."""

    errors: list = field(default_factory=list)
    covered: int = 0
    intervals: int = 0
    steps: int = 0
    seconds: float = 0.0

    def add(self, truth, answer):
        self.steps += 1
        if answer is None:
            return
        self.errors.append(answer.delay - truth)
        if not math.isnan(answer.low):
            self.intervals += 1
            self.covered += answer.low <= truth <= answer.high


def by_ruptures(segment):
    """Two unconnected lines, by dynamic programming."""
    k = segment.samples()
    signal = np.column_stack([segment.values, k - k[0], np.ones_like(k)])
    found = ruptures.Dynp(model="linear", min_size=3, jump=1).fit(signal).predict(n_bkps=1)
    return Answer(segment.first + found[0] - segment.step)


def by_pwlf(segment):
    """A continuous broken line, by differential evolution."""
    model = pwlf.PiecewiseLinFit(segment.samples(), segment.values, seed=1)
    return Answer(model.fit(2)[1] - segment.step)


def by_piecewise_regression(segment):
    """A continuous broken line, by Muggeo's iteration, with its interval."""
    k = segment.samples()
    found = piecewise_regression.Fit(k, segment.values, n_breakpoints=1).get_results()
    if not found["converged"]:
        return None
    place = found["estimates"]["breakpoint1"]
    low, high = (end - segment.step for end in place["confidence_interval"])
    return Answer(place["estimate"] - segment.step, low, high)


PEERS = {
    "ruptures Dynp, linear": by_ruptures,
    "pwlf": by_pwlf,
    "piecewise-regression": by_piecewise_regression,
}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def of_commands():
    """The processor's seconds of all commands so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def estimate(tauscope, log, method, *options):
    """The decisions of a method, and the processor's seconds of the whole command."""
    begun = of_commands()
    text = run(
        *(tauscope, "estimate", str(log), "--method", method, "--keep-first-last"),
        *("--threads", "1", "--format", "json", "--quiet", *options),
    )
    seconds = of_commands() - begun
    return json.loads(text)["joints"][0]["decisions"], seconds


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def answer_of(decision):
    if decision["verdict"] != "accepted":
        return None
    low, high = (decision.get(key) for key in ("delta_low", "delta_high"))
    ends = (math.nan, math.nan) if low is None else (low, high)
    return Answer(decision["delta"], *ends)


def inner(truth):
    """The steps that change anything, but for the last, whose reaction may be cut off."""
    return [i for i, row in enumerate(truth[:-1]) if abs(float(row["slope_change"])) > 1e-9]


def measure(tauscope, plant, folder, tallies):
    """Adds one record of a plant, as TOML, to what became of all methods."""
    spec, log, true = (Path(folder) / name for name in ("plant.toml", "log.csv", "truth.csv"))
    spec.write_text(plant)
    run(tauscope, "simulate", str(spec), "-o", str(log), "--truth", str(true), "--quiet")
    truth = read(true)
    judged = inner(truth)
    delays = [float(row["delay_samples"]) for row in truth]
    segments = None
    for method in METHODS:
        options = ("--beta", "2") if method == "two-line" else ()
        decisions, seconds = estimate(tauscope, log, method, *options)
        tallies[method].seconds += seconds
        for i in judged:
            tallies[method].add(delays[i], answer_of(decisions[i]))
        segments = segments or decisions
    rows = read(log)
    output = np.array([float(row[next(c for c in row if ".output" in c)]) for row in rows])
    for name, peer in PEERS.items():
        for i in judged:
            d = segments[i]
            segment = Segment(d["r"], d["p"], output[d["r"] - 1 : d["end"]])
            begun = time.process_time()
            answer = peer(segment) if len(segment.values) >= FEWEST else None
            tallies[name].seconds += time.process_time() - begun
            tallies[name].add(delays[i], answer)


def plant_of(name, seed, duration_s):
    """A plant as TOML."""
    hold_s, longest, different = PLANTS[name]
    return PLANT.format(
        seed=seed, duration_s=duration_s, hold_s=hold_s, longest=longest, different=different
    )


def row_of(plant, name, tally, unit):
    errors = np.abs(tally.errors)
    covered = "-" if tally.intervals == 0 else f"{100 * tally.covered / tally.intervals:.0f}"
    ratio = tally.seconds / unit
    cells = [
        plant,
        f"`{name}`" if name in METHODS else name,
        f"{100 * len(errors) / tally.steps:.1f}",
        f"{errors.mean():.3f} ± {errors.std() / math.sqrt(len(errors)):.3f}",
        covered,
        f"{ratio:.1f}" if ratio < 10 else f"{ratio:.0f}",
    ]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("tauscope", help="the program, built with --release")
    parser.add_argument("--records", type=int, default=2, help="records of each plant")
    parser.add_argument("--duration", type=float, default=120.0, help="their seconds")
    parser.add_argument("--plant", action="append", choices=PLANTS, help="only this one")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    logging.disable(logging.WARNING)
    print("| plant | method | answered % | error | covered % | time |")
    print("|---|---|---|---|---|---|")
    for plant in arguments.plant or PLANTS:
        tallies = {name: Tally() for name in (*METHODS, *PEERS)}
        for seed in range(arguments.records):
            with tempfile.TemporaryDirectory() as folder:
                spec = plant_of(plant, 3000 + seed, arguments.duration)
                measure(arguments.tauscope, spec, folder, tallies)
        unit = tallies["hinge"].seconds
        for name, tally in tallies.items():
            print(row_of(plant, name, tally, unit), flush=True)
            plant = ""


if __name__ == "__main__":
    sys.exit(main())
