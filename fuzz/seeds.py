"""Makes seeds/: a few small files of each format, from which the fuzzer begins.

    pip install -r ../tests/golden/formats/requirements.txt h5py openpyxl
    python seeds.py

Texts are written by hand here; files that are no text are made by the programs that users have.
"""
import pathlib
import re
import zipfile

import h5py
import numpy as np
import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer
from scipy.io import savemat

HERE = pathlib.Path(__file__).parent / "seeds"
ROWS = 40
TIME = np.arange(ROWS) * 0.02
INPUT = (np.arange(ROWS) // 10 % 3 - 1).astype(float)
OUTPUT = np.round(np.cumsum(np.concatenate([np.zeros(4), INPUT[:-4]])) * 0.16, 2)


def write(target, name, content):
    path = HERE / target / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, str):
        content = content.encode()
    if content is not None:
        path.write_bytes(content)
    return path


def rows(separator, columns):
    text = lambda value: value if isinstance(value, str) else repr(float(value))
    return "".join(separator.join(map(text, row)) + "\n" for row in zip(*columns))


def texts():
    """The same log in the ways that text has."""
    columns = [TIME, INPUT, OUTPUT]
    plain = "time_s,a.input [V],a.output [deg]\n" + rows(",", columns)
    trial = ["first"] * (ROWS // 2) + ['"the, second"'] * (ROWS // 2)
    clock = [f"2024-05-01T12:00:{value:05.2f}Z" for value in TIME]
    semicolons = "\ufeff# a log\nt;u;y\n" + rows(";", columns).replace(".", ",")
    cells = [[f"{value:9.4f}" for value in column] for column in columns]
    files = {
        "plain": plain,
        "blanks": "by hand\n\n  t [s]  a.input [V] \t a.output [deg]\n" + rows("  ", cells),
        "newest_first": "time_s,a.input,a.output\n" + rows(",", [c[::-1] for c in columns]),
        "trials": "time_s,trial,a.input,a.output\n" + rows(",", [TIME, trial, INPUT, OUTPUT]),
        "clock": "timestamp,cmd,angle\n" + rows(",", [clock, INPUT, OUTPUT]),
        "semicolons": semicolons,
        "tabs": "t_ms\tu\ty\n" + rows("\t", [1000 * TIME, INPUT, OUTPUT]),
        "gaps": re.sub(r"0\.(1|5.?),.*\n", "", plain).replace(",0.16\n", ",\n"),
    }
    for name, text in files.items():
        write("csv", name, text)
    write("csv", "sixteen_bits", plain.encode("utf-16"))


def matlab():
    boom = {"input": INPUT[:, None].astype("int8"), "output": OUTPUT[:, None]}
    variables = {"time_s": TIME[:, None], "boom": boom, "y": np.column_stack([OUTPUT, INPUT])}
    trials = {"trial": np.array([["one"]] * 20 + [["two"]] * 20, dtype=object)}
    savemat(write("mat5", "v6", None), variables, appendmat=False)
    savemat(write("mat5", "v7", None), variables | trials, do_compression=True, appendmat=False)
    for name, options in {"plain": {}, "packed": {"compression": "gzip", "shuffle": True}}.items():
        path = write("mat73", name, None)
        with h5py.File(path, "w", userblock_size=512) as file:
            for key, values in {"time_s": TIME, "boom/input": INPUT, "boom/output": OUTPUT}.items():
                data = file.create_dataset(key, data=values[None, :], **options)
                data.attrs["MATLAB_class"] = np.bytes_("double")
            file["boom"].attrs["MATLAB_class"] = np.bytes_("struct")
        header = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
        with path.open("r+b") as file:
            file.write(header)


def ros():
    states = "string[] name\nfloat64[] position\n"
    command = "Level[2] levels\n" + "=" * 80 + "\nMSG: demo/Level\nfloat64 value\n"
    for compression in CompressionType:
        with write("mcap", compression.name.lower(), None).open("wb") as file:
            writer = Writer(file, compression=compression, chunk_size=1500)
            state = writer.register_msgdef("demo/msg/States", states)
            valve = writer.register_msgdef("demo/msg/Valve", command)
            for k in range(ROWS // 2):
                time = 1_700_000_000_000_000_000 + k * 20_000_000
                levels = [{"value": INPUT[k]}, {"value": -INPUT[k]}]
                angles = {"name": ["a", "b"], "position": [OUTPUT[k], 1.0]}
                writer.write_message("/valve", valve, {"levels": levels}, time, time, k)
                writer.write_message("/states", state, angles, time, time, k)
            writer.finish()


def parquet():
    columns = {"time_s": TIME, "a.input": INPUT, "a.output": OUTPUT}
    for packing in ("zstd", "snappy", "gzip", "lz4", "none"):
        pq.write_table(pa.table(columns), write("parquet", packing, None), compression=packing,
                       row_group_size=25)
    typed = pa.table({
        "time": pa.array((TIME * 1e9).astype("int64"), pa.timestamp("ns")),
        "trial": pa.array(["one"] * 20 + ["two"] * 20).dictionary_encode(),
        "a": pa.StructArray.from_arrays([pa.array(INPUT.astype("int8")), pa.array(OUTPUT)],
                                        ["input", "output"])})
    pq.write_table(typed, write("parquet", "typed", None), compression="none")


def sheets():
    book = openpyxl.Workbook()
    book.active.append(["a note"])
    sheet = book.create_sheet("log")
    for row in [["time_s", "a.input", "a.output"], *zip(TIME, INPUT, OUTPUT)]:
        sheet.append(list(row))
    path = write("xlsx", "two_sheets", None)
    book.save(path)
    # Without what is only looks: it would be most of the file.
    looks = ("docProps/", "xl/theme/", "xl/styles.xml")
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            if not name.startswith(looks):
                archive.writestr(name, content)


MODEL = """schema = "tauscope/model/1"
[[candidate]]
kind = "expression"
id = "knee"
stage = "input"
expression = "if(abs(signal) > from, signal - from * sign(signal), 0)"
parameters.from = { value = 0.2, min = 0.0, max = 2.0, dimension = "input" }
[joint.boom]
structure = "integrator"
parameters = { gain = 11.9, delay = { value = 0.15, min = 0.0, max = 1.0 } }
[[joint.boom.effect]]
kind = "dead_band"
parameters = { lower = -0.6, upper = { value = 0.6, fixed = true } }
[[joint.boom.effect]]
kind = "knee"
parameters = { from = 0.3 }
[[joint.boom.history]]
revision = 1
added = "dead_band"
validation_rmse = 0.06
"""
LATER = """schema = "tauscope/model/1"
[joint.boom]
structure = "integrator"
parameters = { gain = -3, delay = 0.02 }
[[joint.boom.effect]]
kind = "expression"
id = "small_steps"
stage = "transport"
expression = "later * exp(-abs(after - before) / size)"
parameters.later = { value = 0.1, min = 0.0, max = 2.0, dimension = "seconds" }
parameters.size = { value = 0.5, min = 0.05, max = 10.0, neutral = 1.0 }
"""
PLAIN = """schema = "tauscope/model/1"
[joint.boom]
structure = "integrator"
parameters = { gain = 8.0, delay = 0.12 }
"""
PLANT = """schema = "tauscope/plant/1"
seed = 20
sample_period_s = 0.02
duration_s = 2.0
substeps = 4
[[joint]]
name = "boom"
gain = 8.0
start = 15.0
range = [-120.0, 120.0]
input = { levels = [-2.0, -1.0, 1.0, 2.0], hold_s = [0.1, 0.4] }
delay = { law = "uniform", min = 0.01, max = 0.1 }
dead_band = [-0.3, 0.3]
saturation = 1.75
noise = 0.05
[[joint]]
name = "arm"
input = { steps = [[10, 1.0], [50, -1.0]] }
delay = { law = "direction", rising = 0.12, falling = 0.04 }
lag_s = 0.06
ringing = { period_s = 0.4, damping = 0.25 }
resolution = 0.01
spikes = { share = 0.01, size = 3.0 }
"""
JOINT = """schema = "tauscope/plant/1"
seed = 1
duration_s = 1.0
[[joint]]
name = "a"
input = { levels = [-1.0, 1.0], hold_s = [0.1, 0.3] }
"""

# What a plant can hide, and the numbers of it.
HIDDEN = """variable_delay small_s=0.1 scale=0.5 falling_s=0.05 rested_s=0.1 rest_s=0.5 cold_s=0.1 warming_s=1
input_offset offset=0.1
stiction start=0.3 stop=0.1
dead_band lower=-0.2 upper=0.2
flow_curve exponent=1.3
direction_gain negative_factor=0.8
input_saturation limit=0.8 sharpness=4
asymmetric_saturation limit=0.8 negative_ratio=0.7 sharpness=4
rate_limit seconds_per_input=0.1
actuator_lag time_constant=0.1
resonance period=0.3 damping=0.2
oil_column period=0.3 damping=0.2 valve_damping=0.1 slope=0.01 reference=0
coulomb_friction positive=0.1 negative=0.1 time_constant=0.1
asymmetric_friction positive=0.1 negative=0.2 time_constant=0.1 negative_viscous=1.2
position_gain ratio=0.3 mount=10 leverage=0.5 reference=0
thermal_drift change=0.2 time_constant=1
supply_droop droop=0.2
gravity_load kappa=0.35 y0=10 creep=0.8
leakage rate=0.1 y0=1
end_stop low=-1 high=3
backlash width=1.5
input_notch from=0.1 to=0.2 share=0.5
creep_memory share=0.2
sticky_spot from=0 to=1 share=0.5
disturbance from_s=0.2 to_s=0.4 speed=1
sensor_nonlinearity amplitude=0.1 period=1 zero=0"""
OUTSIDE = ("input_notch", "creep_memory", "sticky_spot", "disturbance", "sensor_nonlinearity")


def effects():
    """Every effect: four to a plant, and alone in a model, where it needs no numbers."""
    hidden = [line.split() for line in HIDDEN.splitlines()]
    law = 'delay = { law = "constant", seconds = 0.1 }\n'
    for first in range(0, len(hidden), 4):
        tables = [
            f"[joint.{'outside' if name in OUTSIDE else 'effect'}.{name}]\n"
            + "".join(number.replace("=", " = ") + ".0\n" if "." not in number
                      else number.replace("=", " = ") + "\n" for number in numbers)
            for name, *numbers in hidden[first : first + 4]]
        write("plant", f"effects_{first // 4}", JOINT + law + "".join(tables))
    kinds = [name for name, *_ in hidden if name not in OUTSIDE]
    for first in range(0, len(kinds), 4):
        tables = [f'[[joint.boom.effect]]\nkind = "{kind}"\n' for kind in kinds[first : first + 4]]
        write("model", f"catalogue_{first // 4}", PLAIN + "".join(tables))


def words():
    write("model", "candidate", MODEL)
    write("model", "transport", LATER)
    write("plant", "two_joints", PLANT)
    laws = {
        "step_size": 'delay = { law = "step_size", min = 0.05, max = 0.2, scale = 1.0 }\n',
        "warming": 'delay = { law = "warming", first = 0.1, last = 0.05 }\n',
        "listed": 'delay = { law = "listed", seconds = [0.1, 0.2] }\n',
        "cylinder": 'delay = { law = "constant", seconds = 0.05 }\ncylinder = {}\n',
    }
    for name, law in laws.items():
        write("plant", name, JOINT + law)
    write("columns", "one", 'time = "time_s"\ntrial = "none"\n[joint.boom]\n'
          'input = "a.input"\noutput = "a.output"\ninput_unit = "V"\noutput_unit = "deg"\n'
          'covariates = { pressure = "a.input" }\n')
    write("columns", "without_time", "sample_period = 0.01\n[joint.b]\n"
          'input = "a.input"\noutput = "a.output"\n')
    expressions = {
        "input": "if(signal > a, signal - b * (signal - a), signal)",
        "load": "signal / (1 + a * abs(signal))",
        "transport": "a * exp(-abs(after - before) / max(b, 0.1))",
        "output": "signal + a * sin(2 * pi * signal) ^ 2",
        "dynamics": "min(signal, 1, 1 + a) * !(signal < 0 && velocity >= b || 0)",
    }
    for stage, expression in expressions.items():
        write("expression", stage, f"{stage}\n{expression}")
    header = "joint,trial,i,verdict,delay_s,note,reviewer"
    write("review", "plain", f"{header}\na,1,1,accepted,0.15,clear,me\na,1,2,rejected,,,me\n")
    write("review", "sheet", f"{header},p,program_verdict,program_delay_s\n"
          "a,1,2,,,,,121,accepted,0.15\na,1,3,accepted,,,me,181,accepted,0.15\n")


if __name__ == "__main__":
    texts()
    matlab()
    ros()
    parquet()
    sheets()
    words()
    effects()
