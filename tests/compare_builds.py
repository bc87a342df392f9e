#!/usr/bin/env python3
"""Compares what two builds of tauscope say about the same logs. Needs nothing but Python.

    tests/compare_builds.py OLD NEW [--quick] [--only WORD] [--real FOLDER] [--out FOLDER] [--words]

OLD and NEW are programs. Both read data/, 20 joints that OLD simulates (4 with --quick), and
the measured logs in FOLDER (../shared/data; left out, and said so, where it is not there).
For each command it compares exit status, JSON, tables and model files byte by byte, and says
of those that differ what differs: a key, a word, or a number and by how much. Texts and pages,
which may be reworded on purpose, are counted apart; --words shows their lines.
Ends with 1 where anything but texts and pages differs.
"""
import argparse
import difflib
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
ARM = ["--joint", "arm=u_duty_pct:angle_deg"]
RC = [f"--joint={joint}=u_{joint}_duty:y_{joint}" for joint in ("boom", "stick", "bucket")]
RC += ["--trial", "run", "--resample", "0.02", "--fill", "2"]
EMPS = ["--joint", "axis=force_N:q_m"]
ROTARY = ["--trial", "stroke", "--joint", "rotary=p_drive_cnt:angle_cnt", "--sample-period",
          "0.004", "--min-step", "4000", "--beta", "1", "--passband", "none"]

# Log, how it is read, further settings of `estimate`, and whether models are fitted to it.
REAL = [
    ("excavator_full_arm_single.csv", ARM, ["--keep-first-last", "--max-delay", "100"], True),
    ("excavator_full_bucket_single.csv", ["--joint", "bucket=u_duty_pct:angle_deg"],
     ["--keep-first-last", "--max-delay", "100"], False),
    ("excavator_rc_steps.csv", RC, ["--keep-first-last", "--max-delay", "30"], True),
    ("excavator_rc_manual.csv", RC, [], False),
    ("rotary_hydraulic_strokes.csv", ROTARY[:6], ROTARY[6:], False),
    ("emps_train.csv", EMPS, [], False),
    ("emps_test_pulses.csv", EMPS, [], False),
    ("mataveid_hydmotor.csv", [], [], True),
    ("mataveid_hangload.csv", [], [], False),
    ("mataveid_cylinders.csv", [], [], False),
    ("faster_rig.csv", [], [], False),
    ("dart_steering.csv", [], [], True),
    ("davinci_tool.csv", [], [], False),
    ("gas_furnace_seriesJ.csv", ["--joint", "gas=gas_rate:co2_pct"], [], True),
    ("cascaded_tanks.csv", ["--joint", "tank=u_est_V:y_est_V"], [], True),
    ("bj_sales_seriesM.csv", ["--joint", "sales=lead:sales"], [], True),
]
# Tables that are no logs of a joint: what can be said of their columns, or why they are refused.
TABLES = ("segmented_stagnant.csv", "rotary_hydraulic_labels.csv", "excavator_rc_valve_map.csv")
EFFECTS = [[], ["dead_band"], ["gravity_load", "dead_band"], ["actuator_lag"], ["input_saturation"],
           ["resonance"], ["coulomb_friction"], ["end_stop"], ["backlash"], ["variable_delay"]]


# Sentences for people inside JSON: they may be reworded, too.
SENTENCES = {"headline", "in_words"}
THREADED = ("estimate", "compare", "explain", "improve", "add", "sweep", "report")


def estimates(log, how, more):
    """Every method, with the tables that can be had."""
    for method in ("two-line", "hinge", "lag-aware"):
        yield f"estimate {method}", ["estimate", log, *how, *more, "--method", method, "--format",
                                     "json", "--decisions", "d.csv", "--delays", "t.csv"]


def models(log, how):
    yield "compare", ["compare", log, *how, "--format", "json"]
    yield "explain", ["explain", log, *how, "--format", "json"]
    yield "add", ["add", "dead_band", log, *how, "--format", "json", "-w", "m.toml"]


def runs(args, folder):
    """What is run, by name: the arguments, files in the working folder being the outputs."""
    for log in ("manipulator", "worked_example", "hidden_effect"):
        path = str(ROOT / "data" / f"{log}.csv")
        yield from ((f"{log}: {n}", a) for n, a in estimates(path, [], []))
        yield f"{log}: settings", ["estimate", path, "--alpha", "20", "--passband", "none",
                                   "--output-limits", "-20,60", "--interpolate", "linear",
                                   "--format", "json", "--decisions", "d.csv"]
        yield f"{log}: sweep", ["sweep", path, "--alpha", "5,10", "--beta", "2,5", "--format", "json"]
        yield f"{log}: text", ["estimate", path]
        yield f"{log}: sweep text", ["sweep", path, "--alpha", "5,10", "--beta", "2,5"]
        yield from ((f"{log}: {n}", a) for n, a in models(path, []))
        yield f"{log}: explain text", ["explain", path]
        yield f"{log}: compare text", ["compare", path]
        yield f"{log}: page", ["report", path, "-o", "page.html"]
        if args.quick and log == "manipulator":
            continue
        yield f"{log}: improve", ["improve", path, "--format", "json", "-w", "m.toml"]
        yield f"{log}: improve text", ["improve", path, "-w", "m.toml"]
        yield f"{log}: design", ["design", path, "--duration", "60", "--format", "json", "-o", "in.csv"]
    for command in ("estimate", "compare", "explain", "improve", "add", "sweep", "report",
                    "design", "simulate", "effects", "doctor", "merge", "export", "columns"):
        yield f"{command} --help", [command, "--help"]
    yield "effects", ["effects"]
    yield "effects json", ["effects", "--format", "json"]
    yield from of_results(args, folder)
    yield "no such file", ["estimate", "none.csv"]
    yield "no such effect", ["add", "deadband", str(ROOT / "data" / "hidden_effect.csv")]
    count = 4 if args.quick else 20
    for seed in range(count):
        effects = EFFECTS[seed % len(EFFECTS)]
        more = [x for effect in effects for x in ("--effect", effect)]
        made = ["--seed", str(700 + seed), "--noise", ("0.05", "0.1")[seed // 10 % 2]]
        log = folder / f"simulated_{seed}.csv"
        subprocess.run([args.old, "simulate", "-o", log, *made, *more, "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
        yield f"simulate {seed}", ["simulate", "-o", "s.csv", "--truth", "s.toml", *made, *more]
        name = f"simulated {seed} ({', '.join(effects) or 'nothing'})"
        yield from ((f"{name}: {n}", a) for n, a in estimates(str(log), [], []))
        if seed % 3 == 0:
            yield from ((f"{name}: {n}", a) for n, a in models(str(log), []))
    if not args.real.is_dir():
        print(f"skipped: measured logs are not at {args.real}")
        return
    for table in (*TABLES, *(log for log, *_ in REAL)):
        if (args.real / table).exists():
            yield f"{table}: columns", ["columns", str(args.real / table)]
    for log, how, more, fitted in REAL:
        path = args.real / log
        if not path.exists():
            print(f"skipped: {path} is not here")
            continue
        yield from ((f"{log}: {n}", a) for n, a in estimates(str(path), how, more))
        yield f"{log}: text", ["estimate", str(path), *how, *more]
        if not args.quick or not fitted:
            yield f"{log}: compare", ["compare", str(path), *how, "--format", "json"]
        if not args.quick and fitted:
            yield f"{log}: explain", ["explain", str(path), *how, "--format", "json"]
            yield f"{log}: page", ["report", str(path), *how, "-o", "page.html"]
            yield f"{log}: improve", ["improve", str(path), *how, "--format", "json",
                                      "--max-effects", "2", "-w", "m.toml"]


def of_results(args, folder):
    """Commands that read what others have written: here OLD, for both."""
    log = str(ROOT / "data" / "hidden_effect.csv")
    model, earlier, parts = folder / "model.toml", folder / "earlier.json", folder / "parts"
    def old(*arguments):
        return subprocess.run([args.old, *arguments, "--quiet"], check=True, capture_output=True).stdout
    old("add", "dead_band", log, "-w", str(model))
    old("estimate", str(ROOT / "data"), "--results", str(parts))
    earlier.write_bytes(old("estimate", log, "--format", "json"))
    for language in ("c", "m", "py", "fmu"):
        yield f"export .{language}", ["export", str(model), "--joint", "boom", f"exported.{language}"]
    for language in ("c", "m", "py", "json"):
        yield f"lookup .{language}", ["estimate", log, "--export", f"lookup.{language}"]
    yield "merge", ["merge", str(parts), "--decisions", "d.csv", "--summary", "s.csv"]
    yield "merge json", ["merge", str(parts), "--format", "json"]
    hinge = ["estimate", log, "--method", "hinge", "--against", str(earlier)]
    yield "estimate --against", hinge
    yield "estimate --against json", [*hinge, "--format", "json"]
    against = ["compare", log, "-m", str(model), "--against", str(model)]
    yield "compare --against", against
    yield "compare --against json", [*against, "--format", "json"]


def outputs(program, arguments):
    """Exit status, streams and files of one run."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, *arguments, "--threads", "2"]
                              if arguments[0] in THREADED and arguments[-1] != "--help" else [program, *arguments],
                              cwd=folder, capture_output=True, timeout=3600)
        found = {"status": str(done.returncode).encode(),
                 ("json" if "json" in arguments else "text"): done.stdout,
                 "messages": done.stderr}
        for path in sorted(pathlib.Path(folder).iterdir()):
            found[path.name] = path.read_bytes()
        return found


def may_be_reworded(name, old, new):
    """Whether the outputs differ in nothing but sentences for people."""
    if name == "json":
        try:
            found = differences(json.loads(old), json.loads(new))
        except ValueError:
            return False
        return all(path.split(":")[0].rpartition(".")[2] in SENTENCES for path, _ in found)
    return name in ("text", "messages") or name.endswith(".html")


def differences(old, new, path="$"):
    """Where two JSON values differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(key for key in new if key not in old)]:
            if key not in old or key not in new:
                yield f"{path}.{key} is only in the {'old' if key in old else 'new'}", None
            else:
                yield from differences(old[key], new[key], f"{path}.{key}")
        if list(old) != list(new) and set(old) == set(new):
            yield f"{path}: order of keys", None
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            yield f"{path}: {len(old)} → {len(new)} elements", None
        for index, pair in enumerate(zip(old, new)):
            yield from differences(*pair, f"{path}[{index}]")
    elif old != new:
        numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in (old, new))
        size = abs(new - old) / max(abs(old), abs(new)) if numbers else None
        yield f"{path}: {str(old)[:60]} → {str(new)[:60]}", size


def said(name, old, new, shown=3):
    """What differs between two outputs, as lines."""
    if name == "json":
        try:
            found = list(differences(json.loads(old), json.loads(new)))
        except ValueError:
            found = []
        sizes = [size for _, size in found if size is not None]
        if found:
            other = len(found) - len(sizes)
            yield f"{len(found)} values; numbers by at most {max(sizes, default=0):.1e}, {other} others"
            ranked = sorted(found, key=lambda f: -1 if f[1] is None else -f[1] + 1)
            yield from (text for text, _ in ranked[:shown])
            return
    lines = [text.decode(errors="replace").splitlines() for text in (old, new)]
    delta = [l for l in difflib.unified_diff(*lines, lineterm="", n=0) if l[:3] not in ("---", "+++")]
    yield f"{sum(l[0] in '+-' for l in delta)} lines"
    yield from (l[:200] for l in delta[:2 * shown])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("new", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="", help="runs whose name has this word")
    parser.add_argument("--real", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--out", type=pathlib.Path, help="keep what differs here")
    parser.add_argument("--words", action="store_true", help="show reworded lines")
    parser.add_argument("--cache", type=pathlib.Path, help="remember what OLD says, by its arguments")
    args = parser.parse_args()
    args.real = args.real.resolve()
    same, reworded, wrong = 0, 0, 0
    with tempfile.TemporaryDirectory() as made:
        folder = args.cache or pathlib.Path(made)
        folder.mkdir(parents=True, exist_ok=True)
        for name, arguments in runs(args, folder):
            if args.only not in name:
                continue
            old, new = kept(args, folder, arguments), outputs(args.new, arguments)
            for output in sorted(old.keys() | new.keys()):
                a, b = old.get(output, b""), new.get(output, b"")
                # A program's own name is not part of what it says.
                a, b = (text.replace(pathlib.Path(p).name.encode(), b"tauscope")
                        for text, p in ((a, args.old), (b, args.new)))
                if a == b:
                    same += 1
                    continue
                words = may_be_reworded(output, a, b)
                reworded, wrong = reworded + words, wrong + (not words)
                if not words or args.words:
                    print(f"{name}: {output} differs", *said(output, a, b, 40 if words else 3),
                          sep="\n    ", flush=True)
                if args.out:
                    args.out.mkdir(parents=True, exist_ok=True)
                    stem = f"{name}.{output}".replace("/", "_").replace(" ", "_")
                    (args.out / f"{stem}.old").write_bytes(a)
                    (args.out / f"{stem}.new").write_bytes(b)
    print(f"{same} outputs are the same, {reworded} texts or pages are reworded, {wrong} others differ")
    return 1 if wrong else 0


def kept(args, folder, arguments):
    """What OLD says, remembered where there is a folder for it."""
    if not args.cache:
        return outputs(args.old, arguments)
    import hashlib
    import pickle
    key = hashlib.sha256(repr([a.replace(str(ROOT), "") for a in arguments]).encode()).hexdigest()
    path = folder / f"{key}.pickle"
    if not path.exists():
        path.write_bytes(pickle.dumps(outputs(args.old, arguments)))
    return pickle.loads(path.read_bytes())


if __name__ == "__main__":
    sys.exit(main())
