"""Takes the pictures of this folder anew, each of what the program draws of a log in `data`.

    python docs/pictures/make.py PROGRAM RERUN [PICTURE ...]

PROGRAM is `tauscope`, RERUN the viewer 0.36.3. Of reports they are taken in Chromium, by Playwright
(`pip install playwright`; CHROMIUM names the browser where it is not `chromium`). No display and no
graphics card are needed; where there is none, a Vulkan driver that draws in software (Mesa's lavapipe).
"""

import base64
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
DATA = HERE.parent.parent / "data"

# Of recordings: the arguments of the program, one command after the other, and what is done in the viewer:
# a place on a timeline, or a click (points from the left and the top of a window of 1600 x 900).
MANIPULATOR = f"{DATA}/manipulator.csv"
HIDDEN = f"{DATA}/hidden_effect.csv"
RECORDINGS = {
    "decision-accepted": (
        [f"estimate {MANIPULATOR} -o x.rrd"],
        [("decision", 52)],
    ),
    "decision-rejected": (
        [f"estimate {MANIPULATOR} --joint shoulder_pitch --min-slope-change 0.02 -o x.rrd"],
        [("segment", 49)],
    ),
    "delay": (
        [f"estimate {MANIPULATOR} --joint elbow_pitch -o x.rrd"],
        [(198, 65), ("decision", 600)],
    ),
    "difference": (
        [
            f"estimate {MANIPULATOR} --method two-line --format json",
            f"estimate {MANIPULATOR} --against printed.json -o x.rrd",
        ],
        [("difference", 2)],
    ),
    "model": ([f"compare {HIDDEN} --horizon steps -o x.rrd"], []),
    "revision": ([f"improve {HIDDEN} -o x.rrd"], [("revision", 0)]),
    "sweep": (
        [f"sweep {MANIPULATOR} --joint azimuth_yaw --joint wrist_pitch -o x.rrd"],
        [("setting", 5)],
    ),
}

# Of reports: the ground, and the heading from which on the page is shown.
REPORTS = {"report_light": ("light", None), "report_dark": ("dark", "Errors")}


class Viewer:
    """A viewer without a window, driven by the program that it brings along for that."""

    def __init__(self, rerun: str, recording: Path) -> None:
        environment = os.environ | {"RERUN_ANALYTICS": "0", "WGPU_BACKEND": "vulkan"}
        pipes = {"env": environment, "stderr": subprocess.DEVNULL}
        port = random.randrange(20_000, 60_000)
        options = f"--headless --hide-welcome-screen --bind 127.0.0.1 --port {port} --window-size 1600x900"
        self.window = subprocess.Popen(
            [rerun, *options.split(), str(recording)], stdout=subprocess.DEVNULL, **pipes
        )
        self.driver = subprocess.Popen(
            [rerun, "viewer-mcp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, **pipes
        )
        self.calls = 0
        client = {"name": "pictures", "version": "1"}
        self.call(
            "initialize",
            {"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": client},
        )
        self.send({"jsonrpc": "2.0", "method": "notifications/initialized"})
        endpoint = {"endpoint": f"http://127.0.0.1:{port}"}
        self.until("connect", endpoint, lambda answer: not answer.get("isError"))
        self.until("viewer_state", {}, has_timelines)

    def send(self, message: dict) -> None:
        print(json.dumps(message), file=self.driver.stdin, flush=True)

    def call(self, method: str, parameters: dict) -> dict:
        self.calls += 1
        self.send({"jsonrpc": "2.0", "id": self.calls, "method": method, "params": parameters})
        for line in self.driver.stdout:
            answer = json.loads(line)
            if answer.get("id") == self.calls:
                return answer["result"]
        raise SystemExit("the viewer has ended")

    def tool(self, name: str, **arguments: object) -> dict:
        return self.call("tools/call", {"name": name, "arguments": arguments})

    def until(self, tool: str, arguments: dict, is_so) -> None:
        """Asks for half a minute, until the answer is what is waited for."""
        for _ in range(120):
            time.sleep(0.25)
            if is_so(self.tool(tool, **arguments)):
                return
        raise SystemExit(f"the viewer does not answer: {tool}")

    def go(self, step: tuple) -> None:
        where, there = step
        if isinstance(where, str):
            self.tool("set_time", timeline=where, time=there)
        else:
            self.tool("click", pos={"x": where, "y": there})
        self.tool("wait_for", min_steps=3, timeout_secs=20)

    def picture(self) -> bytes:
        self.tool("wait_for", min_steps=30, timeout_secs=20)
        content = self.tool("screenshot")["content"]
        return base64.b64decode(next(part["data"] for part in content if part["type"] == "image"))

    def close(self) -> None:
        for program in (self.driver, self.window):
            program.kill()
            program.wait()


def has_timelines(answer: dict) -> bool:
    text = json.dumps(answer).replace(" ", "").replace("\\", "")
    return '_id"' in text and '"timelines":[' in text and '"timelines":[]' not in text


def of_recording(program: str, rerun: str, name: str, folder: Path) -> None:
    commands, steps = RECORDINGS[name]
    for command in commands:
        printed = run(program, command, folder)
        (folder / "printed.json").write_text(printed)
    viewer = Viewer(rerun, folder / "x.rrd")
    try:
        for step in steps:
            viewer.go(step)
        (HERE / f"{name}.png").write_bytes(viewer.picture())
    finally:
        viewer.close()


def of_report(program: str, name: str, folder: Path) -> None:
    from playwright.sync_api import sync_playwright

    run(program, f"report {HIDDEN} --improve -o x.html", folder)
    ground, heading = REPORTS[name]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=os.environ.get("CHROMIUM", "/usr/bin/chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(
            viewport={"width": 1100, "height": 1500}, color_scheme=ground
        )
        page.goto((folder / "x.html").as_uri())
        if heading:
            page.get_by_role("heading", name=heading, exact=True).first.evaluate(
                "heading => heading.scrollIntoView()"
            )
        page.screenshot(path=HERE / f"{name}.png")
        browser.close()


def run(program: str, command: str, folder: Path) -> str:
    """What the program prints."""
    words = [program, *command.split(), "--quiet"]
    return subprocess.run(words, cwd=folder, check=True, text=True, stdout=subprocess.PIPE).stdout


def main() -> None:
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    program, rerun, *wanted = sys.argv[1:]
    program = str(Path(program).resolve())
    unknown = set(wanted) - RECORDINGS.keys() - REPORTS.keys()
    if unknown:
        raise SystemExit(f"no such picture: {', '.join(sorted(unknown))}")
    for name in wanted or [*RECORDINGS, *REPORTS]:
        with tempfile.TemporaryDirectory() as folder:
            if name in RECORDINGS:
                of_recording(program, rerun, name, Path(folder))
            else:
                of_report(program, name, Path(folder))
        print(name)


if __name__ == "__main__":
    main()
