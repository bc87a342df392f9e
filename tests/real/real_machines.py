#!/usr/bin/env python3
"""How a build of tauscope does on logs of real machines, without a flag but the columns.

    real_machines.py TAUSCOPE FOLDER > docs/real_machines.md

FOLDER holds the logs named in LOGS, each with a page that says where it is from. Needs numpy and
scipy; `scipy_ladder.py` is what an engineer would fit with these.

The independent estimate of a start from rest knows nothing of tauscope: the first sample at which
the output has left the mean of its last 20 samples before the step by 0.2 deg, in the direction in
which it is driven.
"""
import csv
import importlib.util
import json
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np

from scipy_ladder import LADDER, ladder

RC = ["boom=u_boom_duty:y_boom", "stick=u_stick_duty:y_stick", "bucket=u_bucket_duty:y_bucket"]
LOGS = {
    "excavator_full_arm_single": ["arm=u_duty_pct:angle_deg"],
    "excavator_full_bucket_single": ["bucket=u_duty_pct:angle_deg"],
    "excavator_rc_steps": RC,
    "excavator_rc_manual": RC,
    "emps_train": ["axis=force_N:q_m"],
    "mataveid_hydmotor": [],
    "mataveid_hangload": ["lift"],
    "mataveid_cylinders": [],
    "faster_rig": ["actuator"],
    "dart_steering": ["steer"],
    "davinci_tool": ["jaw"],
    "emps_test_pulses": ["axis=force_N:q_m"],
    "cascaded_tanks": ["tank=u_est_V:y_est_V"],
    "gas_furnace_seriesJ": ["co2=gas_rate:co2_pct"],
    "bj_sales_seriesM": ["sales=lead:sales"],
    "rotary_hydraulic_strokes": ["rotary=p_drive_cnt:angle_cnt"],
}
# Neither a time nor a name for trials: what the sidecar says.
FURTHER = {"rotary_hydraulic_strokes": ["--trial", "stroke", "--sample-period", "0.004"]}
STROKES = ["excavator_full_arm_single", "excavator_full_bucket_single"]
METHODS = ["auto", "two-line", "hinge", "lag-aware"]
DEPARTED_DEG = 0.2


def run(tauscope, *arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run([tauscope, *arguments], capture_output=True, text=True, check=False)
    return done, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def arguments(folder, name):
    joints = [part for joint in LOGS[name] for part in ("--joint", joint)]
    return [os.path.join(folder, name + ".csv"), *joints, *FURTHER.get(name, [])]


def trials(path):
    """Time, input and output of each trial."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    found = {}
    for row in rows:
        numbers = [float(row[column]) for column in ("t_s", "u_duty_pct", "angle_deg")]
        found.setdefault(row["test"], []).append(numbers)
    return {label: np.array(numbers).T for label, numbers in found.items()}


def onset(t, u, y):
    """Seconds from the first step to the departure; nan where there is none."""
    p = np.flatnonzero(np.diff(u))[0] + 1
    rest = y[max(0, p - 20):p].mean()
    away = np.flatnonzero((y[p:] - rest) * np.sign(u[p]) > DEPARTED_DEG)
    return t[p + away[0]] - t[p] if len(away) else np.nan


def at_rest(t, u, y):
    """Numbers of the later steps before which the output stood still."""
    steps = np.flatnonzero(np.diff(u)) + 1
    speed = np.ptp(y[steps[0]:]) / (t[-1] - t[steps[0]])
    found = set()
    for number, p in enumerate(steps[1:], 2):
        before = y[(t > t[p] - 0.5) & (t <= t[p])]
        if abs(before[-1] - before[0]) / 0.5 < 0.05 * speed:
            found.add(number)
    return found


def strokes(tauscope, folder, name):
    measured = trials(os.path.join(folder, name + ".csv"))
    truth = {label: onset(*columns) for label, columns in measured.items()}
    resting = {(label, i) for label, columns in measured.items() for i in at_rest(*columns)}
    for method in METHODS:
        with tempfile.TemporaryDirectory() as temporary:
            table = os.path.join(temporary, "decisions.csv")
            run(tauscope, "estimate", *arguments(folder, name), "--method", method, "--decisions", table)
            with open(table, newline="") as file:
                accepted = [row for row in csv.DictReader(file) if row["verdict"] == "accepted"]
        starts = [row for row in accepted if row["i"] == "1"]
        errors = np.abs([float(row["delta_s"]) - truth[row["trial"]] for row in starts])
        wrong = sum((row["trial"], int(row["i"])) in resting for row in accepted)
        print(f"| `{name}` | `{method}` | {len(starts)} of {len(truth)} | {np.nanmedian(errors):.3f} s | {np.nanquantile(errors, 0.9):.3f} s | {wrong} of {len(resting)} |")


def as_it_comes(tauscope, folder, name):
    done, seconds = run(tauscope, "estimate", *arguments(folder, name), "--format", "json", "--quiet")
    if not done.stdout:
        print(f"| `{name}` | - | refused: {done.stderr.strip().splitlines()[0]} | | | |")
        return
    for joint in json.loads(done.stdout)["joints"]:
        dead = joint.get("dead_time")
        if dead:
            value, low, high = (dead.get(key) for key in ("value_s", "low_s", "high_s"))
            known = "none" if value is None else f"{value:.3f} s ({low:.3f} to {high:.3f})"
            print(f"| `{name}` | {joint['joint']} | the input moves all the time | | {known} | {seconds:.1f} s |")
            continue
        delay = joint["delay_s"]
        known = "none" if not delay else f"{delay['median']:.3f} s ({delay['min']:.3f} to {delay['max']:.3f})"
        print(f"| `{name}` | {joint['joint']} | {joint['steps']} steps | {joint['accepted']} | {known} | {seconds:.1f} s |")


def start_delay(parameters, before, after):
    """What a model with these parameters says of the delay of a step from rest."""
    value = lambda name: parameters.get(name, {}).get("value", 0.0)
    scale = value("variable_delay.size_scale")
    grown = value("variable_delay.size") * scale * -np.expm1(-abs(after - before) / scale) if scale else 0.0
    return value("delay") + grown + (value("variable_delay.falling") if after < before else 0.0)


def steady_speed(t, y):
    """Speed over the middle half of the way; nan where it is not covered."""
    way = y[-1] - y[0]
    reached = lambda part: np.flatnonzero((y - y[0]) * np.sign(way) >= part * abs(way))
    first, last = reached(0.25), reached(0.75)
    if not len(first) or not len(last) or t[last[0]] <= t[first[0]]:
        return np.nan
    return (y[last[0]] - y[first[0]]) / (t[last[0]] - t[first[0]])


def words(label):
    """The words of a trial's label that are no numbers."""
    return " ".join(word for word in label.split("-") if not word.isdigit())


def by_duty(tauscope, folder, name):
    """Delays and speeds of the model that improve finds, exported and simulated stroke by stroke."""
    with tempfile.TemporaryDirectory() as temporary:
        written = os.path.join(temporary, "model.toml")
        done, _ = run(tauscope, "improve", *arguments(folder, name), "--write", written, "--format", "json", "--quiet")
        logged = trials(os.path.join(folder, name + ".csv"))
        models = {}
        # Effects may differ by the load, which is in the label.
        for load in {words(label) for label in logged}:
            module = os.path.join(temporary, f"model_{len(models)}.py")
            run(tauscope, "export", written, module, "--quiet", "--trial", load)
            spec = importlib.util.spec_from_file_location("model", module)
            model = importlib.util.module_from_spec(spec)
            sys.modules["model"] = model
            spec.loader.exec_module(model)
            models[load] = model
    parameters = json.loads(done.stdout)["joints"][0]["parameters"]
    found = {}
    for label, (t, u, y) in logged.items():
        p = np.flatnonzero(np.diff(u))[0] + 1
        # Up to where the input ends: after it the joint stands.
        end = p + np.flatnonzero(np.diff(u[p:]))[0] if np.any(np.diff(u[p:])) else len(u)
        simulated = models[words(label)].simulate(u[:end], t[1] - t[0], y[0])
        # The same way for both.
        here, there = steady_speed(t[:end], y[:end]), steady_speed(t[:end], simulated)
        found.setdefault((abs(u[p]), u[p] > 0), []).append(
            (onset(t, u, y), start_delay(parameters, u[p - 1], u[p]), here, there))
    for (duty, forward), rows in sorted(found.items()):
        known = [[value for value in column if np.isfinite(value)] for column in zip(*rows)]
        measured, law, here, there = (np.mean(values) if values else None for values in known)
        there = "the end of the stroke is not reached" if there is None else f"{there:.1f}"
        sign = "+" if forward else "-"
        print(f"| `{name}` | {sign}{duty:.0f} % | {measured:.2f} s | {law:.2f} s | {here:.1f} | {there} |")
    off = np.array([row[3] - row[2] for rows in found.values() for row in rows])
    print(f"| `{name}` | all, root mean square | | | | error {np.sqrt(np.nanmean(off ** 2)):.2f} |")


def columns(name, joint):
    """Names of the input and the output of a joint."""
    for given in LOGS[name]:
        label, _, pair = given.partition("=")
        if label == joint and pair:
            return pair.split(":")
    return f"{joint}.input", f"{joint}.output"


def digits(value):
    return f"{value:.3g}"


def models(tauscope, folder, name):
    """What improve finds with no option, beside SciPy."""
    with tempfile.TemporaryDirectory() as temporary:
        written = os.path.join(temporary, "model.toml")
        done, seconds = run(tauscope, "improve", *arguments(folder, name), "--write", written, "--format", "json", "--quiet")
    if not done.stdout:
        print(f"| `{name}` | - | refused: {done.stderr.strip().splitlines()[0]} | | | | |")
        return
    joints = json.loads(done.stdout)["joints"]
    for joint in joints:
        found = joint["conclusion"]["found"]
        shares = []
        for effect in found:
            instead = effect["alternatives"]
            instead = f" (or {', '.join(instead)})" if instead else ""
            shares.append(f"{effect['effect']} {effect['error_share_percent']:.0f} %{instead}")
        given = joint["revisions"][0]["effects"]
        base = "first order" if any("leakage" in str(one) for one in given) else "integrator"
        errors = [one["error"]["validation"] or one["error"]["train"] for one in joint["revisions"]]
        steps = " → ".join(digits(error["rmse"]) for error in errors)
        delay = joint["parameters"]["delay"]
        held = f"{delay['value']:.3f} s ({delay['status'].replace('_', ' ')})"
        if joint["parameters"].get("variable_delay.size", {}).get("status") == "fixed":
            held = "by the step (fixed)"
        path = os.path.join(folder, name + ".csv")
        rungs, fitted, spent = ladder(path, *columns(name, joint["joint"]))
        best = " → ".join(digits(error) for _, error in rungs)
        print(f"| `{name}` | {joint['joint']} | {base}; {', '.join(shares) or 'nothing more'} | {held} | {steps} | {seconds / len(joints):.0f} s | {best}; {max(fitted['delay'], 0.0):.3f} s | {spent:.0f} s |")


def main():
    tauscope, folder = sys.argv[1:3]
    print("# On real machines\n")
    print("Logs of machines of other groups; the only option is which columns belong to which joint.")
    print("`tests/real/real_machines.py` makes this page; the logs are not part of the project.\n")
    print("## Strokes\n")
    print("Delays of starts from rest of a full-size excavator's joints, 28 strokes each, compared with an")
    print("independent estimate: the time at which the angle has left its rest by 0.2 deg. The last column counts")
    print("steps that were wrongly accepted although the joint stood still.\n")
    print("| log | method | starts accepted | median difference | 90 % below | accepted at rest |\n|---|---|---|---|---|---|")
    for name in STROKES:
        strokes(tauscope, folder, name)
    print("\n### The delay and the speed of the model\n")
    print("For each duty: the mean delay by the same independent estimate and the delay of the model that")
    print("`improve` finds; the mean speed over the middle half of each stroke, measured and of the model")
    print("exported to Python, in deg/s. For comparison, least squares on these speeds alone leave on the arm an")
    print("error of 7.95 deg/s with a gain, 2.33 with dead band, saturation and gain by direction, and 1.30 with")
    print("a factor for the load as well. The two poses of a duty, heavy (H) and light (L), differ by up to")
    print("60 deg/s at one end of the stroke; the model takes the pose from the labels. Outward, the arm's speed")
    print("rises by 10 deg/s from 50 to 60 % and by 15 deg/s from 60 to 70 %, where it reaches its limit. The")
    print("model has a straight line from overlap to limit, which is most of its error; a saturation for each")
    print("direction is not significant there.\n")
    print("| log | duty | delay | of the model | speed | of the model |\n|---|---|---|---|---|---|")
    for name in STROKES:
        by_duty(tauscope, folder, name)
    print("\n## Every log as it comes\n")
    print("Median delay with the smallest and the largest accepted one; where the input moves all the time, one")
    print("dead time with its 95 % interval. The log of the rotary actuator has no command, so the pressure that")
    print("moves it is the input, and no sample period, which is set to 4 ms. For the furnace and the sales (Box")
    print("and Jenkins' series J and M) the textbook gives three samples, including the one sample that any")
    print("sampled system takes: two to three sample periods of 9 s and of 1 s.\n")
    print("| log | joint | input | accepted | delay | processor time |\n|---|---|---|---|---|---|")
    for name in LOGS:
        as_it_comes(tauscope, folder, name)
    print("\n## What is missing in the model\n")
    print("`improve` without options: the first model; the effects of practical consequence, each with its share")
    print("and its alternatives; the delay of the model; and the validation error of each revision. For")
    print("comparison, SciPy fits five models that an engineer would try")
    print(f"({', '.join(LADDER).replace('_', ' ')}; `tests/real/scipy_ladder.py`):")
    print("their errors, and the delay of the last. Both restart where the input changes and at least every 2 s")
    print("(200 samples of a slow log); `improve` does not where the output follows the input itself. Times are")
    print("processor time on one core of two; `improve` searches all effects, SciPy fits only these models.\n")
    print("| log | joint | effects | delay | error | time | SciPy | time |\n|---|---|---|---|---|---|---|---|")
    for name in LOGS:
        models(tauscope, folder, name)


if __name__ == "__main__":
    main()
