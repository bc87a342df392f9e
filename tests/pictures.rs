//! What a person sees: pictures of recordings in the real viewer, in which no view is empty.
//!
//! Asked are the viewers that `RERUN_VIEWERS` names, paths separated by `:`, or the `rerun` on the
//! path; where there is none that makes pictures, it is said.
#![cfg(feature = "rrd")]
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

#[expect(dead_code, reason = "other tests do more with it")]
mod desk;

use std::io::Write as _;
use std::ops::Range;
use std::path::Path;
use std::process::Command;

use desk::{Desk, banded};

/// Width and height of the window, points.
const WINDOW: (usize, usize) = (1280, 720);

/// Columns and rows of a view within the window, points: less than all of it, since viewers differ
/// in the heights of their bars, and without the corner that messages of the viewer cover.
type View = (&'static str, Range<usize>, Range<usize>);

/// The page that a recording opens on, by the command that makes it.
const PAGES: [(&str, &str, &[View]); 3] = [
    (
        "Decisions",
        "estimate log.csv -o page.rrd",
        &[
            ("segment", 5..860, 135..420),
            ("whole record", 5..860, 478..545),
            ("lanes", 5..830, 605..680),
            ("list", 880..1270, 580..680),
        ],
    ),
    (
        "Models",
        "compare log.csv -o page.rrd",
        &[
            ("whole record", 5..910, 165..480),
            ("residual", 5..910, 560..680),
            ("words", 930..1270, 400..680),
        ],
    ),
    (
        "Revisions",
        "improve log.csv --effects dead_band -o page.rrd",
        &[
            ("ladder and evidence", 5..910, 135..330),
            ("whole record", 5..910, 400..680),
            ("words", 945..1270, 400..680),
        ],
    ),
];

/// A picture, a brightness from 0 to 255 for each pixel: that of its brightest colour.
struct Picture {
    brightness: Vec<u8>,
    width: usize,
    /// Pixels per point.
    scale: usize,
}

impl Picture {
    fn read(path: &Path) -> Self {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
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
}

/// The viewers that can be asked for a picture.
fn viewers() -> Vec<String> {
    let named = std::env::var("RERUN_VIEWERS").unwrap_or_else(|_| "rerun".to_owned());
    let makes_pictures = |viewer: &String| {
        let help = Command::new(viewer).arg("--help").output();
        help.is_ok_and(|help| {
            let text = String::from_utf8_lossy(&help.stdout);
            text.contains("--screenshot-to") && text.contains("--headless")
        })
    };
    named.split(':').map(str::to_owned).filter(makes_pictures).collect()
}

/// The page that `recording` opens on.
fn picture(viewer: &str, recording: &Path, port: u32) -> Picture {
    let path = recording.with_extension("png");
    let mut command = Command::new(viewer);
    command.args(["--headless", "--hide-welcome-screen", "--bind", "127.0.0.1"]);
    command.args(["--port", &port.to_string()]);
    command.args(["--window-size", &format!("{}x{}", WINDOW.0, WINDOW.1)]);
    command.arg("--screenshot-to").arg(&path).arg(recording);
    // A machine without a display has no other renderer.
    command.envs([("RERUN_ANALYTICS", "0"), ("WGPU_BACKEND", "vulkan")]);
    let output = command.output().unwrap();
    assert!(path.exists(), "{viewer}: {}", String::from_utf8_lossy(&output.stderr));
    Picture::read(&path)
}

#[test]
fn no_view_of_the_first_page_is_empty() {
    let viewers = viewers();
    if viewers.is_empty() {
        // Not `eprintln`, which the test runner keeps to itself.
        let why = "skipped: no viewer that makes pictures; name some in RERUN_VIEWERS";
        writeln!(std::io::stderr(), "{why}").unwrap();
        return;
    }
    let desk = Desk::with(vec![banded("boom")]);
    let ports = 20_000 + std::process::id() % 20_000;
    for (page, command, views) in PAGES {
        assert!(desk.run(&format!("{command} --quiet")).status.success(), "{command}");
        for (viewer, port) in viewers.iter().zip(ports..) {
            let picture = picture(viewer, &desk.folder.path().join("page.rrd"), port);
            for view in views {
                let drawn = picture.drawn(view);
                assert!(drawn > LEAST, "{viewer}: {page}, {}: {drawn}", view.0);
            }
        }
    }
}

/// The part of a view that is drawn on where there is something: the emptiest has four times as much.
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
