//! What the words of a column's name say of it.

use std::collections::BTreeSet;

use crate::experiment::table::Header;
use crate::experiment::unit;

/// Whether a column drives a joint or measures it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Input,
    Output,
}

/// How much a name says, the most first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Grade {
    /// A word that has one meaning: `valve`, `angle`.
    Word,
    /// A letter, or a word of any block diagram: `u`, `in`.
    Letter,
    /// Its unit alone: percent and volts drive, degrees and millimetres are measured.
    Unit,
    /// What is also logged beside an input and an output: a setpoint, a pressure.
    Beside,
    /// Nothing; the data may.
    Silent,
}

/// Words by what they say, in the order in which they decide on a name that has several; in a group the
/// likelier ones are first. Those of the first group make a column neither. Ones that begin with `-` end a
/// German noun.
const WORDS: [(Option<Side>, Grade, &str); 9] = [
    (
        None,
        Grade::Word,
        "error err raw valid enable enabled flag status state mode limit min max std var seq count counter \
         fault fehler freigabe grenze",
    ),
    (Some(Side::Input), Grade::Word, "cmd command demand des"),
    (
        Some(Side::Input),
        Grade::Beside,
        "setpoint sp ref reference target desired goal soll -sollwert",
    ),
    (
        Some(Side::Output),
        Grade::Beside,
        "pressure -druck temp temperature -temperatur flow -durchfluss force -kraft torque -moment tau effort \
         pilot acc p t",
    ),
    (
        Some(Side::Output),
        Grade::Word,
        "angle pos position output stroke displacement encoder length extension travel speed velocity vel rate \
         level height meas measured actual ist -istwert pv adc ai feedback fb qpos odom twist -winkel -weg \
         -position -hub drehzahl -geschwindigkeit",
    ),
    (
        Some(Side::Input),
        Grade::Word,
        "duty valve pwm joystick joy lever spool drive current volt voltage servo throttle solenoid sol heater \
         mv op dac ao ctrl action swash esc steer -ventil -strom -spannung stell -stellgröße stellwert drossel",
    ),
    (Some(Side::Output), Grade::Word, "y phi theta"),
    (Some(Side::Input), Grade::Letter, "u input in control signal"),
    (Some(Side::Output), Grade::Letter, "q x out"),
];

/// Units, as they are shown, by what has them.
const UNITS: [(Side, Grade, &str); 3] = [
    (Side::Output, Grade::Beside, "bar mbar Pa kPa MPa psi N kN N·m °C K l/min"),
    (
        Side::Output,
        Grade::Unit,
        "deg ° rad mrad mm cm m µm in counts rpm deg/s rad/s m/s mm/s cm/s",
    ),
    (Side::Input, Grade::Unit, "% V mV A mA µs W kW"),
];

/// Words of what a position changes with.
const SPEEDS: &str = "speed velocity vel rate drehzahl -geschwindigkeit";

/// Words of programs and messages, which say of no joint which it is.
const GENERIC: &str =
    "data value values field msg joint joints states controller gvl main plc prg wert";

/// What a name says.
#[derive(Clone, Debug)]
pub(super) struct Name {
    /// Its words in lower case, but for the unit and what programs put before it.
    pub(super) words: Vec<String>,
    /// What in them says which joint: `boom` and `1` of `u_boom1`.
    pub(super) own: BTreeSet<String>,
    pub(super) side: Option<Side>,
    pub(super) grade: Grade,
    /// The place of its word among those of its side: the likelier first.
    pub(super) rank: usize,
    /// The word or the unit that says it.
    pub(super) by: String,
}

impl Name {
    pub(super) fn of(header: &Header) -> Self {
        let unit = header.unit.clone().or_else(|| unit::of_signal(&header.name));
        let itself = || unit::shown(&header.name).filter(|_| header.name.len() > 1);
        let unit = unit.or_else(|| itself().map(str::to_owned));
        let bare = unit::without(&header.name).unwrap_or(&header.name);
        let words = words(bare);
        let parts: Vec<String> = words.iter().flat_map(|word| parts(word)).collect();
        let own = parts.iter().filter(|part| !is_known(part)).cloned().collect();
        let words = words.into_iter().filter(|word| !is_in(GENERIC, word)).collect();
        // Pressures and forces are no inputs, whatever else is in the name.
        let of_units = |units| unit.as_deref().and_then(|unit| said_by_unit(unit, units));
        let said = said(&parts, 0..3)
            .or_else(|| of_units(0..1))
            .or_else(|| said(&parts, 3..WORDS.len()))
            .or_else(|| of_units(1..UNITS.len()));
        let (side, grade, rank, by) = said.unwrap_or((None, Grade::Silent, 0, String::new()));
        Self { words, own, side, grade, rank, by }
    }

    /// Its words, and the parts of these.
    pub(super) fn parts(&self) -> BTreeSet<String> {
        let parts = self.words.iter().flat_map(|word| parts(word));
        parts.chain(self.words.iter().cloned()).collect()
    }

    /// Whether it is that of a speed.
    pub(super) fn is_speed(&self) -> bool {
        self.words.iter().any(|word| is_in(SPEEDS, word))
    }

    /// Whether it says that a column is neither an input nor an output.
    pub(super) fn is_neither(&self) -> bool {
        self.side.is_none() && self.grade == Grade::Word
    }
}

type Said = (Option<Side>, Grade, usize, String);

/// What the first of these groups that has one of the `parts` says.
fn said(parts: &[String], groups: std::ops::Range<usize>) -> Option<Said> {
    let mut groups = WORDS.get(groups)?.iter();
    groups.find_map(|(side, grade, known)| {
        let place = |part: &String| known.split_whitespace().position(|known| is_word(known, part));
        let rank = parts.iter().filter_map(place).min()?;
        let by = known.split_whitespace().nth(rank)?.trim_start_matches('-');
        Some((*side, *grade, rank, format!("`{by}` in its name; ")))
    })
}

fn said_by_unit(unit: &str, groups: std::ops::Range<usize>) -> Option<Said> {
    let mut groups = UNITS.get(groups)?.iter();
    groups.find_map(|(side, grade, known)| {
        let rank = known.split_whitespace().position(|known| known == unit)?;
        Some((Some(*side), *grade, rank, format!("its unit `{unit}`; ")))
    })
}

fn is_word(known: &str, part: &str) -> bool {
    known.strip_prefix('-').map_or(known == part, |end| part.ends_with(end))
}

fn is_in(known: &str, part: &str) -> bool {
    known.split_whitespace().any(|known| is_word(known, part))
}

/// Whether a part of a name says what a column is, and not of which joint.
fn is_known(part: &str) -> bool {
    let is_unit = |part: &str| unit::is_unit(part) || unit::is_unit(&part.to_uppercase());
    WORDS.iter().any(|(_, _, known)| is_in(known, part)) || is_in(GENERIC, part) || is_unit(part)
}

/// The words of a name in lower case: of `uBoom_duty (pct)` they are `u`, `boom`, `duty`, `pct`.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut is_lower = false;
    for letter in name.chars() {
        if !letter.is_alphanumeric() || is_lower && letter.is_uppercase() {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
        is_lower = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// A word and the number after it: `u` and `1` of `u1`.
pub(super) fn parts(word: &str) -> Vec<String> {
    let stem = word.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = word.strip_prefix(stem).unwrap_or("");
    [stem, number].into_iter().filter(|part| !part.is_empty()).map(str::to_owned).collect()
}
