//! `tauscope simulate`

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::synthetic::scenario::{self, Noise, Scenario, Strength};
use crate::synthetic::{PlantSpec, Synthetic, simulate, write_log, write_truth};
use anyhow::{Context as _, bail};
use clap::Args as ClapArgs;

use crate::cli::args::{Choices, number, one_of};
use crate::cli::console::{Bar, Verbosity};
use crate::cli::failure::Completion;
use crate::cli::output::{OutputFile, OutputKind, Outputs, filled_file};
use crate::experiment::read_text;

/// Simulate a log of joints with known delays and effects
///
/// A plant file states each joint's gain, delay law, effects and noise, and what drives it;
/// `data/manipulator.plant.toml` is an example. Without one, a joint of random gain, delay
/// and levels is driven for two minutes, another one beside it, and `--effect` names what
/// it hides. The truth goes to files of its own, so that it can stay hidden.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// The plant (TOML, schema `tauscope/plant/1`)
    #[arg(value_name = "PLANT.toml")]
    plant: Option<PathBuf>,

    /// What the joint hides, without a plant file: an effect of the catalogue or outside it,
    /// with the keys of its table in a plant file; without them its size follows from
    /// `--strength`. May be repeated
    #[arg(
        long, value_name = "NAME[:KEY=NUMBER,...]", value_parser = hidden, conflicts_with = "plant"
    )]
    effect: Vec<Hidden>,

    /// How clearly an effect without numbers shows: the nearest plain integrator is wrong by
    /// some 3 times the noise, or 12 times [default: clear]
    #[arg(long, value_parser = one_of(STRENGTH), conflicts_with = "plant")]
    strength: Option<Strength>,

    /// Where the log goes
    #[arg(short, long = "output", value_name = "LOG.csv")]
    output: PathBuf,

    /// A file for the truth: the true delay of every step, or the whole plant if the name ends in
    /// `.toml`. May be repeated
    #[arg(long, value_name = "TRUTH.csv|TRUTH.toml")]
    truth: Vec<PathBuf>,

    /// Seed of everything random [default: the plant file's, or 1]
    #[arg(long, value_name = "N", value_parser = number::whole::<u64>)]
    seed: Option<u64>,

    /// Standard deviation of the noise of every joint [default: the plant file's, or 0.05]
    #[arg(long, value_name = "X")]
    noise: Option<f64>,

    /// Correlation of the noise of neighbouring samples [default: the plant file's, or 0]
    #[arg(long, value_name = "PHI")]
    noise_correlation: Option<f64>,

    /// Length of the log [default: the plant file's, or 120]
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,

    /// No progress, no notices
    #[arg(short, long)]
    quiet: bool,
}

/// How clearly an effect shows.
const STRENGTH: Choices<Strength> = &[
    ("weak", "Some 3 times the noise", Strength::Weak),
    ("clear", "Some 12 times the noise", Strength::Clear),
];

/// An effect, and its numbers where they are given.
#[derive(Clone, Debug)]
struct Hidden {
    name: String,
    numbers: Vec<(String, f64)>,
}

fn hidden(text: &str) -> Result<Hidden, String> {
    let (name, numbers) = text.split_once(':').unwrap_or((text, ""));
    let number = |part: &str| {
        let pair = part.split_once('=').and_then(|(key, number)| {
            Some((key.trim().to_owned(), number.trim().parse::<f64>().ok()?))
        });
        pair.ok_or_else(|| format!("`{part}` is not KEY=NUMBER, as in dead_band:lower=-0.5"))
    };
    let parts = numbers.split(',').filter(|part| !part.trim().is_empty());
    let numbers = parts.map(number).collect::<Result<_, _>>()?;
    Ok(Hidden { name: name.trim().to_owned(), numbers })
}

/// Seed where none is given.
const SEED: u64 = 1;

/// Standard deviation of the noise where none is given, in degrees.
const NOISE: f64 = 0.05;

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let verbosity = Verbosity::from(args.quiet);
    let spec = {
        let _bar = Bar::spinner(verbosity, "sizing effects");
        spec(args)?
    };
    let (plants, tables): (Vec<_>, Vec<_>) = args.truth.iter().partition(|path| is_plant(path));
    let outputs =
        Outputs::default().with(OutputKind::Log, [&args.output]).with(OutputKind::Toml, plants);
    outputs.with(OutputKind::Log, tables).check(args.plant.as_slice())?;
    let bar = Bar::spinner(verbosity, "simulating");
    let made = match &args.plant {
        Some(path) => simulate(&spec).with_context(|| path.display().to_string())?,
        None => simulate(&spec)?,
    };
    write(args, &spec, &made)?;
    drop(bar);
    let (joints, steps) = (made.joints.len(), made.truth.len());
    verbosity.say("log", format!("{}: {joints} joints, {steps} steps", args.output.display()));
    Ok(Completion::Whole)
}

/// Whether a truth of this name is the whole plant.
fn is_plant(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"))
}

/// Log and truth under their final names, or nothing.
fn write(args: &Args, spec: &PlantSpec, made: &Synthetic) -> anyhow::Result<()> {
    let mut files = vec![filled_file(&args.output, |file| Ok(write_log(made, file)?))?];
    for path in &args.truth {
        files.push(filled_file(path, |file| {
            if is_plant(path) {
                file.write_all(spec.to_toml()?.as_bytes())?;
            } else {
                write_truth(&made.truth, file)?;
            }
            Ok(())
        })?);
    }
    files.into_iter().try_for_each(OutputFile::commit)
}

/// The plant of the file or of the options.
fn spec(args: &Args) -> anyhow::Result<PlantSpec> {
    let mut spec = match &args.plant {
        Some(path) => read(path)?,
        None if args.effect.iter().any(|hidden| hidden.numbers.is_empty()) => calibrated(args)?,
        None => with_numbers(args)?,
    };
    spec.seed = args.seed.unwrap_or(spec.seed);
    spec.duration_s = args.duration.unwrap_or(spec.duration_s);
    for joint in &mut spec.joints {
        joint.noise = args.noise.unwrap_or(joint.noise);
        joint.noise_correlation = args.noise_correlation.unwrap_or(joint.noise_correlation);
    }
    Ok(spec)
}

fn read(path: &Path) -> anyhow::Result<PlantSpec> {
    let name = path.display();
    let text = read_text(path).with_context(|| format!("{name}: cannot be read"))?;
    PlantSpec::from_toml(&text).with_context(|| format!("{name}"))
}

/// A joint with effects whose numbers are given.
fn with_numbers(args: &Args) -> anyhow::Result<PlantSpec> {
    if args.strength.is_some() {
        bail!("--strength: is for effects without numbers, and there is none");
    }
    let mut spec = scenario::ideal(args.seed.unwrap_or(SEED));
    for joint in &mut spec.joints {
        joint.noise = NOISE;
    }
    if let Some(joint) = spec.joints.first_mut() {
        for Hidden { name, numbers } in &args.effect {
            joint.hide(name, numbers).context("--effect")?;
        }
    }
    Ok(spec)
}

/// A joint with effects whose numbers follow from the strength.
fn calibrated(args: &Args) -> anyhow::Result<PlantSpec> {
    if let Some(with) = args.effect.iter().find(|hidden| !hidden.numbers.is_empty()) {
        bail!("--effect {}: has numbers where others have none; give them to all", with.name);
    }
    if args.duration.is_some() {
        bail!("--duration: an effect without numbers is sized for 120 s; give it numbers");
    }
    let names: Vec<&str> = args.effect.iter().map(|hidden| hidden.name.as_str()).collect();
    let strength = args.strength.unwrap_or(Strength::Clear);
    let deviation = args.noise.unwrap_or(NOISE);
    if !(deviation.is_finite() && deviation > 0.0) {
        bail!("--noise {deviation}: an effect without numbers is sized by the noise, above zero");
    }
    let noise = Noise::correlated(deviation, args.noise_correlation.unwrap_or(0.0));
    let made = Scenario::new(&names, strength, noise, args.seed.unwrap_or(SEED))?;
    Ok(made.plant)
}
