"""The figures of docs/python.md: speed, memory, and what functions as effects cost.

    TAUSCOPE=target/release/tauscope python python/benchmarks/figures.py

Build the package as the program is built: `maturin develop --release`.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import tauscope
from tauscope import Model

MB = 1e6


def record(samples: int, hold: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """An input in steps that are held for so many samples, and what an integrator makes of it."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-2, 2, samples // hold), hold)
    y = np.zeros(len(u))
    np.cumsum(u[:-15], out=y[15:])
    y *= 0.1
    for start in range(0, len(y), 100_000):
        part = y[start : start + 100_000]
        part += rng.normal(0, 0.02, len(part))
    return u, y


def best(work: Callable[[], Any], times: int = 5, who: int = resource.RUSAGE_SELF) -> float:
    """The least processor time of several runs, seconds."""
    took = []
    for _ in range(times):
        before = resource.getrusage(who)
        work()
        after = resource.getrusage(who)
        took.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(took)


def status(key: str) -> float:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(key):
            return float(line.split()[1]) * 1024
    return 0.0


def memory(samples: int, hold: int) -> None:
    """The peak of the process during `estimate`, above what it is with the arrays made."""
    small = record(2000, 100)
    tauscope.estimate(small, sample_period=0.01)
    u, y = record(samples, hold)
    arrays = u.nbytes + y.nbytes
    Path("/proc/self/clear_refs").write_text("5")  # The peak counts from here.
    before = status("VmRSS")
    begun = time.perf_counter()
    found = tauscope.estimate((u, y), sample_period=0.01)
    took, above = time.perf_counter() - begun, status("VmHWM") - before
    print(
        f"  {samples:.0e} samples, a step each {hold}: {above / MB:.0f} MB above the arrays of "
        f"{arrays / MB:.0f} MB, {above / arrays:.2f} times them; {took:.1f} s; "
        f"{len(found.to_json()) / MB:.0f} MB of JSON"
    )


def speed(program: str) -> None:
    """Processor time of `estimate` of 14 joints with 100,000 samples each."""
    arrays = {f"joint_{j}": record(100_000, 100, j) for j in range(14)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        columns = {"time_s": np.round(0.01 * np.arange(100_000), 2)}
        for name, (u, y) in arrays.items():
            columns |= {f"{name}.input": u, f"{name}.output": y}
        table = pd.DataFrame(columns)
        table.to_csv(path, index=False)
        words = [program, "estimate", str(path), "--format=json", "--quiet"]
        output = Path(folder) / "found.json"

        def run() -> None:
            with output.open("wb") as file:
                subprocess.run(words, stdout=file, check=True)

        whole = best(run, who=resource.RUSAGE_CHILDREN)
        reading = best(lambda: tauscope.read(path))
        from_arrays = best(lambda: tauscope.estimate(arrays, sample_period=0.01))
        from_frame = best(lambda: tauscope.estimate(table))
        from_file = best(lambda: tauscope.estimate(path))
    print(f"  the program, reading a CSV: {whole:.3f} s; reading alone takes {reading:.3f} s")
    print(f"  from arrays {from_arrays:.3f} s, a DataFrame {from_frame:.3f} s")
    print(f"  from the file {from_file:.3f} s")
    print(f"  from arrays / the program without reading: {from_arrays / (whole - reading):.3f}")
    print(f"  from the file / the program: {from_file / whole:.3f}")


def functions() -> None:
    """Simulations of 100,000 samples with an effect of the catalogue, an expression, a function."""
    u, _ = record(100_000, 100)
    plain = Model.integrator(10.0, 0.05)
    own = {"stage": "load", "c": 0.01}
    models = {
        "none": plain,
        "leakage (of the catalogue)": plain.with_effect("leakage", rate=0.01),
        "expression": plain.with_effect("own", expression="signal - c * position", **own),
        "function": plain.with_effect(
            "own", function=lambda signal, position, c: signal - c * position, **own
        ),
        "function of the signal alone": plain.with_effect(
            "own", function=lambda signal, a: signal * (1 + a * abs(signal)), a=0.1
        ),
    }
    for name, model in models.items():
        took = best(lambda model=model: model.simulate(u, 0.01))
        print(f"  {name}: {1e3 * took:.2f} ms, {1e9 * took / len(u):.0f} ns a sample")


def main() -> None:
    if sys.argv[1:2] == ["memory"]:
        memory(int(float(sys.argv[2])), int(sys.argv[3]))
        return
    print("functions as effects")
    functions()
    program = os.environ.get("TAUSCOPE")
    if program:
        print("speed")
        speed(program)
    print("memory")
    for hold in (100, 1000):
        subprocess.run([sys.executable, __file__, "memory", "1e7", str(hold)], check=True)


if __name__ == "__main__":
    main()
