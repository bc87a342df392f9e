#!/usr/bin/env python3
"""The dead time of a log by an ARX model, beside what tauscope finds; needs numpy and pandas.

    dead_time_check.py LOG.csv TIME INPUT OUTPUT [TRIAL [PERIOD_S]]

For each whole delay n the change of the output is regressed on ten of its own past values, and on
a curve of the input (five columns) n and n + 1 samples before; Schwarz's criterion picks n
(L. Ljung, System Identification, 1999, sections 4.2 and 16.4). Where the input is held, n = 1 is a dead time
between none and one sample. A lag adds to n what a first-order model cannot tell from a delay.
"""
import sys
import numpy as np
import pandas as pd

path, time, source, target = sys.argv[1:5]
log = pd.read_csv(path, comment="#")
parts = [g for _, g in log.groupby(sys.argv[5], sort=False)] if len(sys.argv) > 5 and sys.argv[5] else [log]
period = float(sys.argv[6]) if len(sys.argv) > 6 else float(np.median(np.diff(parts[0][time])))
trials = []
for part in parts:
    t, u, y = (part[name].to_numpy(float) for name in (time, source, target))
    gaps = np.flatnonzero(np.diff(t) > 6 * period) + 1
    for t, u, y in zip(*(np.split(x, gaps) for x in (t, u, y))):
        grid = np.arange(t[0], t[-1], period)
        if len(grid) > 100:
            trials.append((u[np.searchsorted(t, grid + 1e-9, side="right") - 1], np.interp(grid, t, y)))
moving = np.concatenate([u[1:][np.diff(u) != 0] for u, _ in trials])
knots = np.quantile(moving, [0.2, 0.4, 0.6, 0.8])
longest = int(np.clip(round(1.0 / period), 10, 60))


def rows(delay):
    left, right = [], []
    for u, y in trials:
        change = np.diff(y, prepend=y[0])
        curve = [u] + [np.maximum(u - knot, 0) for knot in knots]
        k = np.arange(longest + 12, len(u))
        past = [change[k - i] for i in range(1, 11)]
        inputs = [c[k - delay - i] for c in curve for i in (0, 1)]
        left.append(np.column_stack([np.ones(len(k)), *past, *inputs]))
        right.append(change[k])
    return np.concatenate(left), np.concatenate(right)


cost = []
for delay in range(longest + 1):
    x, y = rows(delay)
    residual = y - x @ np.linalg.lstsq(x, y, rcond=None)[0]
    cost.append(len(y) * np.log(residual @ residual))
best = int(np.argmin(cost))
print(f"{len(trials)} trials, {len(y)} rows, period {period:.5f} s")
print(f"ARX: input {best} samples before, a dead time of {max(best - 1, 0) * period:.3f} to {best * period:.3f} s")
near = [n for n in range(longest + 1) if cost[n] - cost[best] < 20]
print("as good but for 20 of the likelihood:", ", ".join(f"{n * period:.3f} s" for n in near))
