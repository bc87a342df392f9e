"""Makes large.csv and large.mcap of 1 GB each, to measure how fast and with what memory they
are read.

    pip install -r ../tests/golden/formats/requirements.txt
    python large_logs.py FOLDER

Seven joints at 1 kHz follow steps of 0.5 s after 0.1 s. In the MCAP the states come in
messages of 360 bytes, the commands ten times a second.
"""
import pathlib
import struct
import sys

import numpy as np
from mcap.writer import CompressionType, Writer
from mcap_ros2.writer import Writer as RosWriter

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tests/golden"))
from formats import COMMANDS, STATES  # noqa: E402

SIZE = 10**9
JOINTS = ["azimuth", "shoulder", "elbow", "forearm", "wrist", "rotate", "jaw"]
BLOCK = 50_000
rng = np.random.default_rng(1)


def blocks():
    """Inputs and outputs of all joints, a block of samples at a time."""
    levels = np.zeros((100, len(JOINTS)))
    angles = np.zeros(len(JOINTS))
    while True:
        steps = rng.choice([-2.0, -1.0, 1.0, 2.0], (BLOCK // 500, len(JOINTS)))
        volts = np.repeat(steps, 500, axis=0)
        late = np.vstack([levels, volts])[:BLOCK]
        levels = volts[-100:]
        moved = angles + np.cumsum(late, axis=0) * 0.01
        angles = moved[-1]
        yield volts, np.round(moved + rng.normal(0, 0.02, moved.shape), 4)


def csv(path):
    with path.open("w") as file:
        file.write("time_s," + ",".join(f"{j}.input,{j}.output" for j in JOINTS) + "\n")
        for number, (volts, angles) in enumerate(blocks()):
            times = np.arange(number * BLOCK, (number + 1) * BLOCK) / 1000
            cells = np.empty((BLOCK, 15))
            cells[:, 0], cells[:, 1::2], cells[:, 2::2] = times, volts, angles
            np.savetxt(file, cells, fmt=["%.3f"] + ["%g", "%.4f"] * 7, delimiter=",")
            if file.tell() > SIZE:
                return


class Raw:
    """Takes the bytes of one message, which all others are made from."""

    def __enter__(self):
        self.buffer = pathlib.Path("/dev/null").open("wb")
        self.writer = RosWriter(self.buffer)
        return self

    def __exit__(self, *_):
        self.buffer.close()

    def bytes(self, name, definition, content):
        kept = []
        self.writer._writer.add_message = lambda **message: kept.append(message["data"])
        self.writer.write_message("/x", self.writer.register_msgdef(name, definition), content)
        return bytearray(kept[0])


def mcap(path):
    zeros = [0.0] * 7
    stamp = {"sec": 0, "nanosec": 0}
    with Raw() as raw:
        state = raw.bytes("sensor_msgs/msg/JointState", STATES, {
            "header": {"stamp": stamp, "frame_id": "base"}, "name": JOINTS, "position": [1.5] * 7,
            "velocity": zeros, "effort": zeros})
        command = raw.bytes("std_msgs/msg/Float64MultiArray", COMMANDS, {
            "layout": {"dim": [], "data_offset": 0}, "data": [1.5] * 7})
    seven = struct.Struct("<7d")
    at_state, at_command = (data.index(seven.pack(*[1.5] * 7)) for data in (state, command))
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.LZ4)
        writer.start(profile="ros2")
        channels = [
            writer.register_channel(topic, "cdr", writer.register_schema(name, "ros2msg", text.encode()))
            for topic, name, text in [
                ("/joint_states", "sensor_msgs/msg/JointState", STATES),
                ("/valve", "std_msgs/msg/Float64MultiArray", COMMANDS)]]
        time = 1_700_000_000_000_000_000
        for volts, angles in blocks():
            for k in range(BLOCK):
                if k % 100 == 0:
                    seven.pack_into(command, at_command, *volts[k])
                    writer.add_message(channels[1], time, bytes(command), time)
                seven.pack_into(state, at_state, *angles[k])
                writer.add_message(channels[0], time, bytes(state), time)
                time += 1_000_000
            if file.tell() > SIZE:
                break
        writer.finish()


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    csv(folder / "large.csv")
    mcap(folder / "large.mcap")
