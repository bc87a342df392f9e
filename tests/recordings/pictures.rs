//! What a person sees: pictures of recordings in the real viewer, in which no view is empty.
//!
//! Asked are the viewers that `RERUN_VIEWERS` names, paths separated by `:`, or the `rerun` on the
//! path; where there is none that makes pictures, it is said.
#![cfg(feature = "rrd")]

use std::io::{BufRead as _, BufReader, Cursor, Write as _};
use std::ops::Range;
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use crate::desk::{Desk, banded};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Width and height of the window, points.
const WINDOW: (usize, usize) = (1280, 720);

/// Columns and rows of a view within the window, points: less than all of it, since viewers differ
/// in the heights of their bars, and without the corner that messages of the viewer cover.
type View = (&'static str, Range<usize>, Range<usize>);

/// What is looked at of the recording that a command makes, one after the other.
const LOOKS: [(&str, &[Look]); 3] = [
    (
        "estimate log.csv -o page.rrd",
        &[Look {
            page: "Decisions",
            steps: &[],
            views: &[
                ("segment", 5..860, 140..420),
                ("whole record", 5..860, 478..545),
                ("lanes", 5..830, 605..680),
                ("list", 880..1270, 580..680),
            ],
        }],
    ),
    (
        "compare log.csv -o page.rrd",
        &[
            Look { page: "Models on time", steps: &[], views: &MODELS },
            Look { page: "Models on doubt", steps: &[Step::Time("doubt", 2)], views: &MODELS },
            Look {
                page: "Record on doubt",
                steps: &[Step::Click(210, [65, 79])],
                views: &[("output", 5..1270, 190..420), ("delay, input", 5..1270, 460..650)],
            },
        ],
    ),
    (
        "improve log.csv --effects dead_band -o page.rrd",
        &[Look {
            page: "Revisions",
            steps: &[],
            views: &[
                ("ladder and evidence", 5..910, 135..330),
                ("whole record", 5..910, 400..680),
                ("words", 945..1270, 110..400),
            ],
        }],
    ),
];

const MODELS: [View; 3] = [
    ("whole record", 5..910, 170..480),
    ("residual", 5..910, 560..680),
    ("words", 930..1270, 110..400),
];

/// A picture that is taken after some steps.
struct Look {
    page: &'static str,
    steps: &'static [Step],
    views: &'static [View],
}

/// What is done in the viewer.
enum Step {
    /// A place on a timeline.
    Time(&'static str, i64),
    /// A column, and the row of the tabs in viewers before 0.41 and from it on.
    Click(u32, [u32; 2]),
    /// A key.
    Key(&'static str),
}

/// A picture, a brightness from 0 to 255 for each pixel: that of its brightest colour.
struct Picture {
    brightness: Vec<u8>,
    width: usize,
    /// Pixels per point.
    scale: usize,
}

impl Picture {
    fn of(png: Vec<u8>) -> Self {
        let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut bytes).unwrap();
        let samples = frame.color_type.samples();
        let colors = samples.min(3);
        let brightest = |pixel: &[u8]| pixel[..colors].iter().copied().max().unwrap();
        let width = usize::try_from(frame.width).unwrap();
        Self {
            brightness: bytes.chunks_exact(samples).map(brightest).collect(),
            width,
            scale: width / WINDOW.0,
        }
    }

    /// The part of a view's pixels that something is drawn on: brighter than ground and grid.
    fn drawn(&self, (_, columns, rows): &View) -> f64 {
        /// Grids have 66, texts, curves and marks more than twice as much.
        const BRIGHT: u8 = 110;
        let of = |points: &Range<usize>| points.start * self.scale..points.end * self.scale;
        let bright = |row: usize| {
            let line = &self.brightness[row * self.width..][of(columns)];
            line.iter().filter(|brightness| **brightness > BRIGHT).count()
        };
        let all = of(columns).len() * of(rows).len();
        of(rows).map(bright).sum::<usize>() as f64 / all as f64
    }

    /// The part of a view's pixels that is seen to be another one in `other`.
    fn differs(&self, other: &Self, (_, columns, rows): &View) -> f64 {
        const SEEN: u8 = 40;
        let of = |points: &Range<usize>| points.start * self.scale..points.end * self.scale;
        let line = |picture: &Self, row: usize| {
            picture.brightness[row * self.width..][of(columns)].to_vec()
        };
        let changed = |row: usize| {
            let pairs = line(self, row).into_iter().zip(line(other, row));
            pairs.filter(|(a, b)| a.abs_diff(*b) > SEEN).count()
        };
        let all = of(columns).len() * of(rows).len();
        of(rows).map(changed).sum::<usize>() as f64 / all as f64
    }
}

/// The viewers that can be asked for a picture.
fn viewers() -> Vec<String> {
    let named = std::env::var("RERUN_VIEWERS").unwrap_or_else(|_| "rerun".to_owned());
    let makes_pictures = |viewer: &String| {
        let help = Command::new(viewer).arg("--help").output();
        help.is_ok_and(|help| {
            let text = String::from_utf8_lossy(&help.stdout);
            text.contains("viewer-mcp") && text.contains("--headless")
        })
    };
    named.split(':').map(str::to_owned).filter(makes_pictures).collect()
}

/// A viewer without a window, and the program through which it is driven.
struct Viewer {
    window: Child,
    driver: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    calls: u64,
    /// Whether its tools have the names of 0.41.
    is_new: bool,
}

impl Drop for Viewer {
    fn drop(&mut self) {
        for child in [&mut self.driver, &mut self.window] {
            // It may have ended by itself.
            child.kill().ok();
            child.wait().ok();
        }
    }
}

impl Viewer {
    fn open(program: &str, recording: &Path, port: u32) -> Self {
        let command = || {
            let mut command = Command::new(program);
            // A machine without a display has no other renderer.
            command.envs([("RERUN_ANALYTICS", "0"), ("WGPU_BACKEND", "vulkan")]);
            command.stderr(Stdio::null()).stdout(Stdio::null());
            command
        };
        let mut window = command();
        window.args(["--headless", "--hide-welcome-screen", "--bind", "127.0.0.1"]);
        window.args(["--port", &port.to_string()]);
        window.args(["--window-size", &format!("{}x{}", WINDOW.0, WINDOW.1)]).arg(recording);
        let mut driver = command();
        driver.arg("viewer-mcp").stdin(Stdio::piped()).stdout(Stdio::piped());
        let (window, mut driver) = (window.spawn().unwrap(), driver.spawn().unwrap());
        let input = driver.stdin.take().unwrap();
        let output = BufReader::new(driver.stdout.take().unwrap());
        let mut viewer = Self { window, driver, input, output, calls: 0, is_new: false };
        let client = json!({"name": "pictures", "version": "1"});
        viewer.call(
            "initialize",
            &json!({"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": client}),
        );
        viewer.send(&json!({"jsonrpc": "2.0", "method": "notifications/initialized"}));
        let tools = viewer.call("tools/list", &json!({})).to_string();
        viewer.is_new = tools.contains("\"rerun_connect\"");
        let endpoint = json!({"endpoint": format!("http://127.0.0.1:{port}")});
        viewer.until(["connect", "rerun_connect"], &endpoint, |answer| answer["isError"] != true);
        viewer.until(["viewer_state", "rerun_get_state"], &json!({}), |answer| {
            let text = answer.to_string().replace([' ', '\\'], "");
            text.contains("_id\"")
                && text.contains("\"timelines\":[")
                && !text.contains("\"timelines\":[]")
        });
        viewer
    }

    fn send(&mut self, message: &Value) {
        writeln!(self.input, "{message}").unwrap();
    }

    fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        self.send(&json!({"jsonrpc": "2.0", "id": id, "method": method, "params": parameters}));
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).unwrap() > 0, "the viewer has ended");
            let answer: Value = serde_json::from_str(&line).unwrap();
            if answer["id"] == id {
                return answer["result"].clone();
            }
        }
    }

    /// Calls the tool, whose names are before 0.41 and from it on.
    fn tool(&mut self, [old, new]: [&str; 2], arguments: &Value) -> Value {
        let name = if self.is_new { new } else { old };
        self.call("tools/call", &json!({"name": name, "arguments": arguments}))
    }

    fn until(&mut self, tool: [&str; 2], arguments: &Value, is_so: impl Fn(&Value) -> bool) {
        /// Half a minute.
        const TRIES: usize = 120;
        let answered = (0..TRIES).any(|_| {
            std::thread::sleep(Duration::from_millis(250));
            is_so(&self.tool(tool, arguments))
        });
        assert!(answered, "the viewer does not answer: {}", tool[0]);
    }

    fn frames(&mut self, count: u32) {
        let arguments = json!({"min_steps": count, "timeout_secs": 20});
        self.tool(["wait_for"; 2], &arguments);
    }

    fn go(&mut self, step: &Step) {
        match *step {
            Step::Time(timeline, time) if self.is_new => {
                let arguments = json!({"timeline": {"name": timeline}, "time": {"time": time}});
                self.tool(["rerun_set_time_cursor"; 2], &arguments);
            }
            Step::Time(timeline, time) => {
                self.tool(["set_time"; 2], &json!({"timeline": timeline, "time": time}));
            }
            Step::Click(x, rows) => {
                let y = rows[usize::from(self.is_new)];
                self.tool(["click"; 2], &json!({"pos": {"x": x, "y": y}}));
            }
            Step::Key(key) => {
                self.tool(["press_key"; 2], &json!({"key": key}));
            }
        }
        self.frames(3);
    }

    fn picture(&mut self) -> Picture {
        self.frames(30);
        let answer = self.tool(["screenshot"; 2], &json!({}));
        let contents = answer["content"].as_array().unwrap();
        let image = contents.iter().find(|part| part["type"] == "image").unwrap();
        Picture::of(STANDARD.decode(image["data"].as_str().unwrap()).unwrap())
    }
}

#[test]
fn no_view_is_empty() {
    let viewers = viewers();
    if viewers.is_empty() {
        // Not `eprintln`, which the test runner keeps to itself.
        let why = "skipped: no viewer that makes pictures; name some in RERUN_VIEWERS";
        writeln!(std::io::stderr(), "{why}").unwrap();
        return;
    }
    let desk = Desk::with(vec![banded("boom")]);
    let mut ports = 20_000 + std::process::id() % 20_000..;
    for (command, looks) in LOOKS {
        assert!(desk.run(&format!("{command} --quiet")).status.success(), "{command}");
        for (program, port) in viewers.iter().zip(&mut ports) {
            let mut viewer = Viewer::open(program, &desk.folder.path().join("page.rrd"), port);
            for Look { page, steps, views } in looks {
                for step in *steps {
                    viewer.go(step);
                }
                let picture = viewer.picture();
                for view in *views {
                    let drawn = picture.drawn(view);
                    assert!(drawn > LEAST, "{program}: {page}, {}: {drawn}", view.0);
                }
            }
        }
    }
}

#[test]
fn the_first_arrow_leads_from_the_last_revision_to_the_first() {
    let desk = Desk::with(vec![banded("boom")]);
    let command = "improve log.csv --effects dead_band -o page.rrd --quiet";
    assert!(desk.run(command).status.success());
    let mut ports = 40_000 + std::process::id() % 20_000..;
    for (program, port) in viewers().iter().zip(&mut ports) {
        let mut viewer = Viewer::open(program, &desk.folder.path().join("page.rrd"), port);
        let opened = viewer.picture();
        viewer.go(&Step::Key("ArrowRight"));
        let first = viewer.picture();
        viewer.go(&Step::Key("ArrowRight"));
        let last = viewer.picture();
        let ladder_and_words = ("", 5..1270, 110..680);
        let changed = |other: &Picture| opened.differs(other, &ladder_and_words);
        assert!(changed(&first) > LEAST, "{program}: the arrow only paused");
        assert!(changed(&last) < 0.1 * changed(&first), "{program}: {}", changed(&last));
    }
}

/// The part of a view that is drawn on where there is anything, at least.
const LEAST: f64 = 0.004;

#[test]
fn an_empty_view_is_found() {
    let mut picture = Picture { brightness: vec![66; 1280 * 720], width: 1280, scale: 1 };
    let view = ("a view", 100..300, 100..200);
    assert!(picture.drawn(&view) < LEAST);
    for row in 120..180 {
        picture.brightness[row * 1280 + 120..][..160].fill(200);
    }
    assert!((picture.drawn(&view) - 160.0 * 60.0 / 20_000.0).abs() < 1e-9);
}
