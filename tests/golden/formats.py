"""Makes formats/: one log in the formats that other programs write, and as CSV.

    pip install -r formats/requirements.txt
    python formats.py
    python formats.py FILE.parquet FILE.csv     # are these tables of tauscope the same?

Two joints follow steps of their inputs after 0.12 s and 0.2 s. The files must agree to the
last bit: the CSV holds the shortest text of each number.
"""
import pathlib
import sys

import hdf5storage
import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from mcap_ros2.writer import Writer
from scipy.io import savemat

HERE = pathlib.Path(__file__).parent / "formats"
PERIOD = 0.02
rng = np.random.default_rng(3)


def steps(samples):
    """Levels that are held for random times."""
    levels = []
    while len(levels) < samples:
        levels += [rng.choice([-2.0, -1.0, 1.0, 2.0])] * int(rng.integers(20, 60))
    return np.array(levels[:samples])


def angle(volts, delay):
    """An integrator that is late."""
    late = np.concatenate([np.zeros(delay), volts])[: len(volts)]
    return np.round(np.cumsum(late) * PERIOD * 8 + rng.normal(0, 0.02, len(volts)), 3)


def write_csv(path, columns):
    text = lambda value: value if isinstance(value, str) else repr(float(value))
    rows = [",".join(columns), *(",".join(map(text, row)) for row in zip(*columns.values()))]
    path.write_text("\n".join(rows) + "\n")


def native(samples):
    columns = {"trial": [], "time_s": [], "boom.input [V]": [], "boom.output [deg]": [],
               "boom.pressure [bar]": [], "arm.input [V]": [], "arm.output [deg]": []}
    for trial in ("a", "b"):
        boom, arm = steps(samples), steps(samples)
        columns["trial"] += [trial] * samples
        columns["time_s"] += [k / 50 for k in range(samples)]
        for name, values in zip(list(columns)[2:], (
                boom, angle(boom, 6), np.round(rng.normal(90, 1, samples), 1), arm, angle(arm, 10))):
            columns[name] += list(map(float, values))
    return columns


def parquet(columns):
    table = pa.table(columns)
    for compression in ("zstd", "snappy", "gzip", "lz4", "none"):
        pq.write_table(table, HERE / f"{compression}.parquet", compression=compression,
                       row_group_size=300)
    # A few rows by a compression that is not read.
    pq.write_table(table.slice(0, 40), HERE / "brotli.parquet", compression="brotli")
    # As data frames are written: times of the type timestamp, text as a dictionary, 32 bits,
    # a structure per joint, and a column of text.
    bits32 = lambda name: pa.array(columns[name], pa.float32())
    nanoseconds = np.round(np.array(columns["time_s"]) * 1e9).astype("int64")
    typed = pa.table({
        "time": pa.array(nanoseconds, pa.timestamp("ns")),
        "trial": pa.array(columns["trial"]).dictionary_encode(),
        "boom": pa.StructArray.from_arrays(
            [pa.array(np.array(columns["boom.input [V]"]).astype("int8")), bits32("boom.output [deg]")],
            ["input", "output"]),
        "note": columns["trial"],
    })
    pq.write_table(typed, HERE / "typed.parquet")
    write_csv(HERE / "typed.csv", {
        "time": columns["time_s"], "trial": columns["trial"], "boom.input": columns["boom.input [V]"],
        "boom.output": np.array(columns["boom.output [deg]"], "float32")})


def dated(columns):
    """Times of the type date, which have no time of day."""
    rows = len(columns["time_s"])
    pq.write_table(pa.table({
        "time": pa.array(range(20000, 20000 + rows), pa.date32()),
        "boom.input [V]": columns["boom.input [V]"],
        "boom.output [deg]": columns["boom.output [deg]"],
    }), HERE / "dated.parquet")


def narrow(columns):
    """As databases and data frames write small numbers: durations, decimals, half precision."""
    import decimal
    import pandas as pd

    samples = len(columns["time_s"]) // 2
    volts = columns["boom.input [V]"][:samples]
    degrees = np.round(columns["boom.output [deg]"][:samples], 3)
    pressures = np.array(columns["boom.pressure [bar]"][:samples], "float16")
    exact = [decimal.Decimal(f"{value:.3f}") for value in degrees]
    table = pa.table({
        "t": pa.array(np.round(np.array(columns["time_s"][:samples]) * 1e9).astype("int64"), pa.duration("ns")),
        "boom.input": pa.array([decimal.Decimal(f"{value:.1f}") for value in volts], pa.decimal128(5, 1)),
        "boom.output": pa.array(exact, pa.decimal128(30, 3)),
        "boom.pressure": pa.array(pressures),
    })
    said = pa.Table.from_pandas(pd.DataFrame({"t": pd.to_timedelta([0], unit="ns").as_unit("ns")}),
                                preserve_index=False).schema.metadata
    table = table.replace_schema_metadata({b"pandas": said[b"pandas"]})
    pq.write_table(table, HERE / "narrow.parquet", store_decimal_as_integer=True)
    of_arrow = pa.table({
        "t": pa.array(np.round(np.array(columns["time_s"][:samples]) * 1e3).astype("int64"), pa.duration("ms")),
        "boom": pa.StructArray.from_arrays(
            [pa.array(volts), pa.array(degrees), pa.array(pressures.astype("float32"))],
            ["input", "output", "pressure"]),
    })
    pq.write_table(of_arrow, HERE / "durations.parquet")
    write_csv(HERE / "narrow.csv", {
        "t": columns["time_s"][:samples], "boom.input": volts, "boom.output": degrees,
        "boom.pressure": pressures})


def mat(columns):
    """The first trial: vectors and structures, a matrix, and things that are no columns."""
    first = {name: np.array(values[: len(values) // 2]) for name, values in columns.items()}
    variables = {
        "time_s": first["time_s"][:, None],
        "boom": {"input": first["boom.input [V]"][:, None].astype("int8"),
                 "output": first["boom.output [deg]"][:, None]},
        "u": first["arm.input [V]"][None, :],
        "y": np.column_stack([first["boom.output [deg]"], first["arm.output [deg]"]]),
        "note": "a text",
        "gain": 8.0,
    }
    trials = {"trial": np.array([["first"]] * 200 + [["second"]] * 200, dtype=object)}
    savemat(HERE / "v6.mat", variables | trials)
    savemat(HERE / "v7.mat", variables | trials, do_compression=True)
    # A workspace as a simulation leaves it: signals by name, and gains of their own lengths.
    savemat(HERE / "workspace.mat", {
        "gains": np.array([[1.0, 2.0, 3.0]]), "time_s": first["time_s"][:, None],
        "valve_cmd": first["boom.input [V]"][:, None],
        "angle": first["boom.output [deg]"][:, None]})
    savemat(HERE / "v4.mat", {"time_s": first["time_s"]}, format="4")
    (HERE / "v73.mat").unlink(missing_ok=True)
    hdf5storage.savemat(str(HERE / "v73.mat"), variables, format="7.3", store_python_metadata=False)
    write_csv(HERE / "mat.csv", {
        "time_s": first["time_s"], "boom.input": first["boom.input [V]"],
        "boom.output": first["boom.output [deg]"], "u": first["arm.input [V]"],
        "y(1)": first["boom.output [deg]"], "y(2)": first["arm.output [deg]"],
        "trial": ["first"] * 200 + ["second"] * 200})


STATES = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
COMMANDS = """std_msgs/MultiArrayLayout layout
float64[] data
================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
"""
START = 1_700_000_000_000_000_000
TICK = 20_000_000


def mcap(path, messages, summary=True, **options):
    """Messages as (topic, time, content), in the order given."""
    with path.open("wb") as file:
        writer = Writer(file, **options)
        if not summary:
            file.seek(0)
            file.truncate()
            writer._writer = McapWriter(file, use_statistics=False, use_summary_offsets=False,
                                        repeat_channels=False, repeat_schemas=False,
                                        use_chunking=False)
            writer._writer.start(profile="ros2")
        kinds = {"/joint_states": writer.register_msgdef("sensor_msgs/msg/JointState", STATES),
                 "/valve": writer.register_msgdef("std_msgs/msg/Float64MultiArray", COMMANDS)}
        kinds["/gripper_states"] = kinds["/joint_states"]
        kinds["/arm_valve"] = kinds["/valve"]
        for number, (topic, time, content) in enumerate(messages):
            writer.write_message(topic, kinds[topic], content, log_time=time,
                                 publish_time=time - 1000, sequence=number)
        writer.finish()


def state(time, names, angles):
    stamp = {"sec": (time - 5000) // 10**9, "nanosec": (time - 5000) % 10**9}
    return {"header": {"stamp": stamp, "frame_id": ""}, "name": names, "position": angles,
            "velocity": [], "effort": []}


def ros():
    """Commands whenever they change, 3 ms before a sample of the states; one of them first."""
    samples = 400
    volts = np.column_stack([steps(samples), steps(samples)])
    angles = np.column_stack([angle(volts[:, 0], 6), angle(volts[:, 1], 10)])
    layout = {"dim": [], "data_offset": 0}
    messages = []
    for k in range(samples):
        time = START + k * TICK
        # Two states come before the first command, at the time of a state: it counts there.
        if k == 2 or (k > 2 and (volts[k] != volts[k - 1]).any()):
            sent = time if k == 2 else time - 3_000_000
            messages.append(("/valve", sent, {"layout": layout, "data": list(volts[k])}))
        messages.append(("/joint_states", time, state(time, ["boom", "arm"], list(angles[k]))))
        # A gripper of its own that tells of itself in between.
        messages.append(("/gripper_states", time + 7_000_000,
                         state(time + 7_000_000, ["grip"], [k / 4])))
    for compression in CompressionType:
        mcap(HERE / f"{compression.name.lower()}.mcap", messages, compression=compression,
             chunk_size=16 * 1024)
    mcap(HERE / "no_summary.mcap", messages, summary=False)
    backwards = sorted(messages, key=lambda message: -message[1])
    mcap(HERE / "backwards.mcap", backwards)
    # One topic for two nodes that tell of their own joint in turns.
    turns = []
    for topic, time, content in messages:
        if topic == "/joint_states":
            own = slice((time - START) // TICK % 2, None, 2)
            content = state(time, content["name"][own], content["position"][own])
        turns.append((topic, time, content))
    mcap(HERE / "turns.mcap", turns)
    # A clock that is set back by three seconds in the middle, before a command and its state.
    middle = next(time for topic, time, _ in messages if topic == "/valve" and time > START + 200 * TICK)
    mcap(HERE / "set_back.mcap", [(topic, time - (time >= middle) * 150 * TICK, content)
                                  for topic, time, content in messages])
    # A valve that sends at each state, but for a third of a second.
    sends = []
    for topic, time, content in messages:
        if topic == "/joint_states":
            k = (time - START) // TICK
            if not 100 <= k < 117:
                sends.append(("/valve", time, {"layout": layout, "data": list(volts[k])}))
            sends.append((topic, time, content))
    mcap(HERE / "pauses.mcap", sends)
    # The arm has a topic of commands of its own, which begins in the middle, and after it the states
    # tell of a bucket.
    late = []
    for topic, time, content in messages:
        k = (time - START) // TICK
        if topic == "/joint_states" and k > samples // 2:
            content = state(time, [*content["name"], "bucket"], [*content["position"], 0.0])
        late.append((topic, time, content))
        if topic == "/valve" and time > START + samples // 2 * TICK:
            late.append(("/arm_valve", time, content))
    mcap(HERE / "late_command.mcap", late)
    # States at a third of the rate: the commands come up to 43 ms before the next of them.
    slow = [(topic, time, content) for topic, time, content in messages
            if topic != "/joint_states" or (time - START) // TICK % 3 == 0]
    mcap(HERE / "slow_states.mcap", slow)
    write_csv(HERE / "ros.csv", {
        "time_s": [k * TICK / 1e9 for k in range(2, samples)],
        "boom.input": volts[2:, 0], "boom.output": angles[2:, 0],
        "arm.input": volts[2:, 1], "arm.output": angles[2:, 1]})
    gripped = volts[2:, 0].copy()
    # 7 ms after a state the next command is not out yet: commands come 3 ms before theirs.
    write_csv(HERE / "grip.csv", {
        "time_s": [(k * TICK + 7_000_000) / 1e9 for k in range(2, samples)],
        "grip.input": gripped, "grip.output": [k / 4 for k in range(2, samples)]})


def check(parquet_file, csv_file):
    """Fails unless both hold the same table, with the types that belong to it."""
    found = pq.read_table(parquet_file)
    types = pa.csv.ConvertOptions(column_types=found.schema, strings_can_be_null=False)
    expected = pa.csv.read_csv(csv_file, convert_options=types)
    # Column by column: a table also compares which columns may hold nulls, which CSV can't say.
    assert found.column_names == expected.column_names, "the columns differ"
    for name in found.column_names:
        assert found[name].equals(expected[name]), f"{name} differs"
    assert found.num_rows > 0
    print(f"{parquet_file}: {found.num_rows} rows as in {csv_file}")


if __name__ == "__main__":
    if len(sys.argv) == 3:
        sys.exit(check(*sys.argv[1:]))
    HERE.mkdir(exist_ok=True)
    columns = native(400)
    write_csv(HERE / "log.csv", columns)
    parquet(columns)
    narrow(columns)
    dated(columns)
    mat(columns)
    ros()
