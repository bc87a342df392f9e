"""What an engineer fits to a log with NumPy and SciPy in ten minutes: an integrator with dead time,
and on it one usual effect after the other.

    y' = K f(u(t - delay)),   f: dead band, then saturation, then another gain for negative inputs
    low <= y <= high          where the output stays in between

Windows as tauscope's default: simulated from the measured output, restarted where a held input
changes and at least every 2 s (200 samples below 10 Hz); what a window is off on average is taken off. Every third
trial is left out for validation where there are six or more, else the last 30 % of each.
"""
import csv
import time

import numpy as np
from scipy.optimize import least_squares

TRIALS = ("test", "run", "trial", "stroke")
TIMES = ("t_s", "time_s", "t")
# Of logs that tell none, seconds.
PERIOD = 0.004
LONGEST_S, FEWEST, OF_SLOW = 2.0, 20, 200
SHORTEST = 10
LADDER = ["integrator", "dead_band", "input_saturation", "direction_gain", "end_stop"]


def windows(path, u_name, y_name):
    """(train, validation): lists of (input with what came before it, output, period)."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    label = next((name for name in TRIALS if name in rows[0]), None)
    at = next((name for name in TIMES if name in rows[0]), None)
    trials = {}
    for number, row in enumerate(rows):
        time_s = float(row[at]) if at else PERIOD * number
        trials.setdefault(row.get(label), []).append([time_s, float(row[u_name] or "nan"), float(row[y_name] or "nan")])
    parts = ([], [])
    for number, rows in enumerate(trials.values()):
        t, u, y = np.array(rows).T
        known = np.isfinite(u) & np.isfinite(y)
        t, u, y = t[known], u[known], y[known]
        if len(t) < 2 * SHORTEST:
            continue
        period = np.median(np.diff(t))
        changes = np.flatnonzero(np.diff(u)) + 1
        whole = len(trials) >= 6
        border = (0 if number % 3 == 2 else len(t)) if whole else int(0.7 * len(t))
        ends = {0, border, len(t)} | (set(changes) if 20 * len(changes) < len(t) else set())
        cut = sorted(ends)
        longest = round(LONGEST_S / period)
        longest = longest if longest >= FEWEST else OF_SLOW
        finer = [k for a, b in zip(cut, cut[1:]) for k in np.linspace(a, b, -(-(b - a) // longest), endpoint=False).astype(int)]
        edges = finer + [len(t)]
        for a, b in zip(edges, edges[1:]):
            if b - a >= SHORTEST:
                parts[int(a >= border)].append((u, a, b, y[a:b], period))
    return parts


class Windows:
    """Windows side by side: a row a sample, a column a window."""

    def __init__(self, parts):
        self.parts = parts
        length = max(len(part[3]) for part in parts)
        self.y = np.full((length, len(parts)), np.nan)
        for column, part in enumerate(parts):
            self.y[: len(part[3]), column] = part[3]
        self.period = np.array([part[4] for part in parts])
        self.known = np.isfinite(self.y)

    def delayed(self, delay):
        """Mean input over each sample period, `delay` seconds late."""
        out = np.zeros_like(self.y)
        for column, (u, a, b, _, period) in enumerate(self.parts):
            whole, part = divmod(delay / period, 1.0)
            k = np.arange(a, b) - int(whole)
            out[: b - a, column] = (1 - part) * u[np.maximum(k, 0)] + part * u[np.maximum(k - 1, 0)]
        return out

    def residuals(self, p, effects):
        v = self.delayed(max(p["delay"], 0.0))
        if "dead_band" in effects:
            v = np.maximum(v - p["upper"], 0.0) + np.minimum(v - p["lower"], 0.0)
        if "input_saturation" in effects:
            v = np.clip(v, -p["limit"], p["limit"])
        if "direction_gain" in effects:
            v = np.where(v < 0, p["factor"] * v, v)
        way = p["gain"] * v * self.period
        if "end_stop" in effects:
            y = np.empty_like(self.y)
            now = self.y[0].copy()
            for row, step in enumerate(way):
                y[row] = now
                now = np.clip(now + step, p["low"], p["high"])
        else:
            y = np.cumsum(way, axis=0) - way
        r = np.where(self.known, self.y - y, 0.0)
        r -= r.sum(axis=0) / self.known.sum(axis=0)
        return r[self.known]


def names_of(effects):
    own = {"dead_band": ["lower", "upper"], "input_saturation": ["limit"], "direction_gain": ["factor"], "end_stop": ["low", "high"]}
    return ["gain", "delay"] + [name for effect in effects for name in own.get(effect, [])]


def ladder(path, u_name, y_name):
    """(effects, error on the part that was not fitted) for each rung, and the processor time."""
    begun = time.process_time()
    train, unseen = (Windows(part) for part in windows(path, u_name, y_name))
    u = np.abs(np.concatenate([part[0][part[1]:part[2]] for part in train.parts]))
    largest = np.max(u)
    y = train.y[train.known]
    start = {"gain": None, "delay": 0.1, "lower": -0.1 * largest, "upper": 0.1 * largest,
             "limit": 0.7 * largest, "factor": 1.0, "low": y.min(), "high": y.max()}
    scale = {"delay": 0.05, "lower": largest, "upper": largest, "limit": largest, "factor": 1.0, "low": np.ptp(y), "high": np.ptp(y)}
    way = train.delayed(start["delay"]) * train.period
    x = np.where(train.known, np.cumsum(way, axis=0) - way, 0.0)
    x = np.where(train.known, x - x.sum(axis=0) / train.known.sum(axis=0), 0.0)
    start["gain"] = float((x[train.known] * y).sum() / max((x ** 2).sum(), 1e-300)) or 1.0
    scale["gain"] = abs(start["gain"])
    rungs = []
    for count in range(1, len(LADDER) + 1):
        effects = LADDER[1:count]
        names = names_of(effects)
        best = None
        for delay in ({start["delay"], 0.05, 0.3} if count == 1 else {start["delay"]}):
            first = [delay if name == "delay" else start[name] for name in names]
            def cost(p):
                return train.residuals({**start, **dict(zip(names, p))}, effects)
            found = least_squares(cost, first, x_scale=[scale[name] for name in names], diff_step=1e-4, max_nfev=100)
            best = found if best is None or found.cost < best.cost else best
        start.update(zip(names, best.x))
        rungs.append((LADDER[count - 1], float(np.sqrt(np.mean(unseen.residuals(start, effects) ** 2)))))
    return rungs, dict(start), time.process_time() - begun


if __name__ == "__main__":
    import sys
    rungs, found, seconds = ladder(*sys.argv[1:4])
    print(" -> ".join(f"{name} {error:.3g}" for name, error in rungs), found, f"{seconds:.1f} s")
