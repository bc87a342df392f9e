//! Which columns drive and measure which joint.

use std::cmp::Reverse;
use std::collections::{BTreeSet, HashMap, HashSet};

use super::signal::Signal;
use super::words::{Grade, Name, Side, parts};
use crate::experiment::table::{Head, Header};
use crate::units::floor_to_index;

/// A joint that was found, with the reasons.
pub(super) struct FoundJoint {
    pub(super) name: String,
    pub(super) input: usize,
    pub(super) output: usize,
    pub(super) why: [String; 2],
    /// Whether names say both what drives it and what it does, and nothing else could be meant.
    pub(super) is_sure: bool,
    /// Inputs and outputs that could be meant as well, where it is not sure.
    pub(super) instead: Vec<([usize; 2], String)>,
}

/// A log's columns by their names, and what they hold.
pub(super) struct Columns<'a> {
    pub(super) head: &'a Head,
    /// The numbers of each column; none of the time, and of what holds no numbers.
    pub(super) signals: &'a [Option<Signal>],
    /// Of each column that may be one of a joint.
    names: Vec<Option<Name>>,
    /// These columns.
    moving: Vec<usize>,
    /// Words that each of these has, as the name of the machine: they say of no joint which it is.
    common: BTreeSet<String>,
}

/// Further columns that are compared with those of a joint.
const COMPARED: usize = 100;

/// An input and an output.
struct Pair {
    input: usize,
    output: usize,
    /// What both names say of which joint it is.
    shared: BTreeSet<String>,
    /// How the output's rate follows the input, where that is clear.
    follows: Option<f64>,
    /// Whether no other input could be meant.
    is_only: bool,
}

impl Pair {
    fn alone(input: usize, output: usize) -> Self {
        Self { input, output, shared: BTreeSet::new(), follows: None, is_only: false }
    }

    fn reversed(self) -> Self {
        Self { input: self.output, output: self.input, ..self }
    }

    /// How much the output follows the input, in whichever direction.
    fn strength(&self) -> f64 {
        self.follows.map_or(0.0, f64::abs)
    }
}

impl<'a> Columns<'a> {
    /// The columns that hold numbers which change.
    pub(super) fn of(head: &'a Head, signals: &'a [Option<Signal>]) -> Self {
        let moves = |signal: &Option<Signal>| signal.as_ref().is_some_and(|s| !s.is_constant());
        let moving: Vec<usize> =
            (0..signals.len()).filter(|column| moves(&signals[*column])).collect();
        let mut names: Vec<Option<Name>> = vec![None; head.headers.len()];
        for column in &moving {
            names[*column] = head.headers.get(*column).map(Name::of);
        }
        let mut all = names.iter().flatten();
        let mut common = all.next().map(Name::parts).unwrap_or_default();
        for name in all {
            common = &common & &name.parts();
        }
        Self { head, signals, names, moving, common }
    }
}

impl Columns<'_> {
    /// The joints: those whose columns have native names, else those that share words which say so, else
    /// those of outputs that follow one input and no other.
    pub(super) fn joints(&self) -> Vec<FoundJoint> {
        let native = self.native();
        if !native.is_empty() {
            return native;
        }
        let named = self.judged(self.by_names());
        if named.is_empty() { self.judged(self.by_data()) } else { named }
    }

    /// Joints whose columns have native names.
    fn native(&self) -> Vec<FoundJoint> {
        let headers = self.head.headers.iter().enumerate();
        // Of two with one name the first.
        let places: HashMap<&str, usize> =
            headers.clone().rev().map(|(place, header)| (header.name.as_str(), place)).collect();
        let why = ["its name ends in .input", "its name ends in .output"].map(str::to_owned);
        let joint = |(input, header): (usize, &Header)| {
            let name = header.name.strip_suffix(".input")?.to_owned();
            let (output, why) = (*places.get(&*format!("{name}.output"))?, why.clone());
            Some(FoundJoint { name, input, output, why, is_sure: true, instead: Vec::new() })
        };
        headers.filter_map(joint).collect()
    }

    /// Inputs and outputs by their names that share words of a joint.
    fn by_names(&self) -> Vec<Pair> {
        let mut inputs: Vec<usize> = self.on(Side::Input).collect();
        let mut outputs: Vec<usize> = self.on(Side::Output).collect();
        let is_named = !inputs.is_empty();
        if !is_named {
            // Where nothing is named like an input, the speed of a joint may be what is given.
            let is_speed = |column: &usize| self.name(*column).is_some_and(Name::is_speed);
            (inputs, outputs) = outputs.into_iter().partition(is_speed);
        }
        let mut pairs = self.sharing(&inputs, &outputs, |name| &name.own - &self.common);
        let is_one = inputs.len() == 1 || outputs.len() == 1;
        if pairs.is_empty() && is_one {
            pairs = self.sharing(&inputs, &outputs, |name| name.own.clone());
        }
        for pair in &mut pairs {
            pair.is_only = is_named;
        }
        pairs.retain(|pair| !self.is_measured_rate(pair.input, pair.output));
        pairs
    }

    /// The pairs of these columns that share words of those which names have as their `own`.
    fn sharing(
        &self,
        inputs: &[usize],
        outputs: &[usize],
        own: impl Fn(&Name) -> BTreeSet<String>,
    ) -> Vec<Pair> {
        /// Pairs that are compared: those of a thousand inputs with as many outputs.
        const MOST: usize = 1_000_000;
        let own = |column: usize| self.name(column).map(&own).unwrap_or_default();
        let mut with: HashMap<String, Vec<usize>> = HashMap::new();
        for output in outputs {
            for word in own(*output) {
                with.entry(word).or_default().push(*output);
            }
        }
        let mut pairs = Vec::new();
        for input in inputs {
            let words = own(*input);
            let near = words.iter().filter_map(|word| with.get(word)).flatten();
            for output in near.collect::<BTreeSet<_>>() {
                let shared = &words & &own(*output);
                pairs.push(Pair { shared, ..Pair::alone(*input, *output) });
            }
            if pairs.len() > MOST {
                return Vec::new();
            }
        }
        self.each_column_once(pairs)
    }

    /// The outputs that follow an input, and no other more, of the columns whose names say most; where names
    /// say nothing, what holds levels drives.
    fn by_data(&self) -> Vec<Pair> {
        /// Pairs that are compared, which takes a second.
        const MOST: usize = 2_500;
        let inputs = self.likely_inputs();
        let outputs = self.best_on(Side::Output, &inputs);
        if let ([input], [output]) = (&*inputs, &*outputs) {
            return vec![Pair { is_only: true, ..Pair::alone(*input, *output) }];
        }
        if inputs.len() * outputs.len() > MOST {
            return Vec::new();
        }
        let is_only = inputs.len() == 1;
        let mut pairs = Vec::new();
        for output in outputs {
            let pair = |input| self.followed(Pair { is_only, ..Pair::alone(input, output) });
            let of_inputs: Vec<Pair> = inputs.iter().copied().map(pair).collect();
            let most = of_inputs.iter().map(Pair::strength).fold(0.0, f64::max);
            let is_near = |pair: &Pair| pair.follows.is_some() && is_alike(pair.strength(), most);
            pairs.extend(of_inputs.into_iter().filter(is_near));
        }
        self.each_column_once(pairs)
    }

    /// The first of `pairs` that have columns which no pair before has: those that share most words come first,
    /// of these the outputs that follow most, and the likeliest names.
    fn each_column_once(&self, mut pairs: Vec<Pair>) -> Vec<Pair> {
        /// A position and its speed, which differ by less, follow alike.
        const ALIKE: f64 = 0.2;
        pairs.sort_by_cached_key(|pair| {
            let follows = floor_to_index(pair.strength() / ALIKE);
            let columns = [pair.input, pair.output];
            let names = columns.map(|column| self.likelihood(column));
            (Reverse((pair.shared.len(), follows)), names, columns)
        });
        let mut taken = HashSet::new();
        pairs.retain(|pair| {
            let is_free = !taken.contains(&pair.input) && !taken.contains(&pair.output);
            taken.extend([pair.input, pair.output].into_iter().filter(|_| is_free));
            is_free
        });
        pairs
    }

    /// The columns whose names say most that they drive; else those that hold levels.
    fn likely_inputs(&self) -> Vec<usize> {
        let inputs = self.best_on(Side::Input, &[]);
        if !inputs.is_empty() {
            return inputs;
        }
        let holds = |column: usize| self.signal(column).is_some_and(Signal::holds_levels);
        let is_open = |column: usize| self.name(column).is_some_and(|name| !name.is_neither());
        self.moving.iter().copied().filter(|column| holds(*column) && is_open(*column)).collect()
    }

    /// The joints of `pairs` whose names say so, or whose data do; it is sure what names alone say, or what
    /// weaker names and the data say together where nothing else moves.
    fn judged(&self, mut pairs: Vec<Pair>) -> Vec<FoundJoint> {
        let grade = |pair: &Pair| {
            self.grade(pair.input, Side::Input).max(self.grade(pair.output, Side::Output))
        };
        let best = pairs.iter().map(grade).min();
        // A setpoint and a pressure beside real joints are none.
        pairs.retain(|pair| grade(pair) < Grade::Beside || best >= Some(Grade::Beside));
        let others = self.moving.len().saturating_sub(2 * pairs.len());
        let taken: HashSet<usize> = pairs.iter().flat_map(|p| [p.input, p.output]).collect();
        let free: Vec<usize> = self.free_inputs(&taken).take(COMPARED).collect();
        let count = pairs.len();
        let (mut joints, mut names) = (Vec::new(), HashSet::new());
        for pair in pairs {
            // `AnalogOut` drives, and `AnalogIn` measures; a setpoint is never what follows.
            let is_reversed = grade(&pair) > Grade::Word && self.is_reversed(&pair);
            if is_reversed && self.grade(pair.input, Side::Input) == Grade::Beside {
                continue;
            }
            let pair = self.followed(if is_reversed { pair.reversed() } else { pair });
            let is_sure =
                pair.is_only && self.is_said(&pair, others) && !self.has_rival(&pair, &free, count);
            let name = self.joint_name(&pair);
            let is_speed = !pair.is_only && !pair.shared.is_empty();
            if (is_sure || is_speed || pair.follows.is_some()) && names.insert(name.clone()) {
                let instead = if is_sure { Vec::new() } else { self.instead(&pair, &taken) };
                let why = self.reasons(&pair);
                let (input, output) = (pair.input, pair.output);
                joints.push(FoundJoint { name, input, output, why, is_sure, instead });
            }
        }
        joints.sort_by_key(|joint| joint.input);
        joints
    }

    /// Whether names say that a pair is a joint, with the data where they say it less clearly, where so many
    /// `others` move.
    fn is_said(&self, pair: &Pair, others: usize) -> bool {
        let (input, output) =
            (self.grade(pair.input, Side::Input), self.grade(pair.output, Side::Output));
        let is_clear = input == Grade::Word || input == Grade::Letter && !pair.shared.is_empty();
        let (follows, are_all) = (pair.follows.is_some(), others == 0);
        match input.max(output) {
            Grade::Word | Grade::Letter => is_clear || are_all,
            Grade::Unit => follows && (is_clear || are_all),
            Grade::Beside => follows && are_all,
            Grade::Silent => false,
        }
    }

    /// Whether the output follows one of the `free` inputs clearly more, which is named like one of this joint,
    /// too.
    fn has_rival(&self, pair: &Pair, free: &[usize], joints: usize) -> bool {
        let words = self.own(pair.output, joints);
        free.iter().filter(|input| !self.own(**input, joints).is_disjoint(&words)).any(|input| {
            self.following(*input, pair.output).is_some_and(|f| !is_alike(pair.strength(), f.abs()))
        })
    }

    /// The columns whose names say that they are inputs, but for those that are `taken`.
    fn free_inputs(&self, taken: &HashSet<usize>) -> impl Iterator<Item = usize> {
        self.on(Side::Input).filter(|input| {
            !taken.contains(input) && self.grade(*input, Side::Input) == Grade::Word
        })
    }

    /// What of a name says which joint: of several `joints`, not what all columns have.
    fn own(&self, column: usize, joints: usize) -> BTreeSet<String> {
        let own = self.name(column).map(|name| name.own.clone()).unwrap_or_default();
        if joints == 1 { own } else { &own - &self.common }
    }

    /// Whether the input follows the output more than the output follows the input.
    fn is_reversed(&self, pair: &Pair) -> bool {
        let follows = |a: usize, b: usize| self.following(a, b).map_or(0.0, f64::abs);
        follows(pair.output, pair.input) > follows(pair.input, pair.output)
    }

    /// What may as well be the output of this input, or the input of this output, of the columns that are not
    /// `taken`.
    fn instead(&self, pair: &Pair, taken: &HashSet<usize>) -> Vec<([usize; 2], String)> {
        /// Pairs that are said.
        const SAID: usize = 3;
        let free = self.moving.iter().copied().filter(|column| !taken.contains(column));
        let free = free.filter(|column| self.name(*column).is_some_and(|name| !name.is_neither()));
        let mut found = Vec::new();
        for column in free.take(COMPARED) {
            let holds = self.signal(column).is_some_and(Signal::holds_levels);
            let as_joint = if holds { [column, pair.output] } else { [pair.input, column] };
            let [input, output] = as_joint;
            if self.following(input, output).is_some_and(|f| is_alike(f.abs(), pair.strength())) {
                found.push((as_joint, self.joint_name(&Pair::alone(input, output))));
            }
        }
        found.truncate(SAID);
        found
    }

    /// Why a pair is taken for a joint: of the input, and of the output.
    fn reasons(&self, pair: &Pair) -> [String; 2] {
        let sides = [(pair.input, Side::Input), (pair.output, Side::Output)];
        let mut why = sides.map(|(column, side)| {
            let by = self.name(column).filter(|name| name.side == Some(side)).map(|n| &*n.by);
            let says = self.signal(column).map(Signal::says);
            format!("{}{}", by.unwrap_or_default(), says.unwrap_or_default())
        });
        if let Some(follows) = pair.follows {
            let follows =
                format!("its rate of change follows the input (correlation {follows:+.2})");
            why[1] = [&why[1], "; ", &follows].concat();
        }
        why
    }

    /// The words that both names share, but for what all columns have where there is more; else the output's.
    fn joint_name(&self, pair: &Pair) -> String {
        let [Some(input), Some(output)] = [pair.input, pair.output].map(|c| self.name(c)) else {
            return String::new();
        };
        let all_shared = &input.own & &output.own;
        let shared = if pair.shared.is_empty() { &all_shared } else { &pair.shared };
        let is_shared = |word: &&String| {
            let parts = parts(word);
            parts.iter().all(|part| all_shared.contains(part))
                && parts.iter().any(|part| shared.contains(part))
        };
        let is_number = |word: &&String| word.bytes().all(|byte| byte.is_ascii_digit());
        let mut words: Vec<&String> = output.words.iter().filter(is_shared).collect();
        if words.iter().all(is_number) {
            let says = |word: &&String| is_shared(word) || !is_number(word);
            words = output.words.iter().filter(says).collect();
            if words.iter().any(|word| !self.common.contains(*word)) {
                words.retain(|word| !self.common.contains(*word));
            }
        }
        // `f` of `fBoom` says what type a number has.
        let is_letter = |word: &&String| word.chars().count() == 1 && !is_number(word);
        if !words.iter().all(|word| is_letter(word) || is_number(word)) {
            words.retain(|word| !is_letter(word));
        }
        let words: Vec<&str> = words.into_iter().map(String::as_str).collect();
        if words.is_empty() { "joint".to_owned() } else { words.join("_") }
    }

    /// For each of `joints` the columns that are named like what drives it, too, and are no joint's.
    pub(super) fn further_inputs(&self, joints: &[FoundJoint]) -> Vec<(String, String)> {
        let taken = joints.iter().flat_map(|joint| [joint.input, joint.output]).collect();
        let mut by_word: HashMap<String, &FoundJoint> = HashMap::new();
        for joint in joints {
            for word in self.own(joint.output, joints.len()) {
                by_word.entry(word).or_insert(joint);
            }
        }
        let of_joint = |input: usize| {
            let words = self.own(input, joints.len());
            let joint = words.iter().find_map(|word| by_word.get(word))?;
            Some((joint.name.clone(), self.head.text(input)))
        };
        self.free_inputs(&taken).filter_map(of_joint).collect()
    }

    fn name(&self, column: usize) -> Option<&Name> {
        self.names.get(column)?.as_ref()
    }

    fn signal(&self, column: usize) -> Option<&Signal> {
        self.signals.get(column)?.as_ref()
    }

    /// How well its name says that a column stands on this side.
    fn grade(&self, column: usize, side: Side) -> Grade {
        let name = self.name(column).filter(|name| name.side == Some(side));
        name.map_or(Grade::Silent, |name| name.grade)
    }

    fn likelihood(&self, column: usize) -> (Grade, usize) {
        self.name(column).map_or((Grade::Silent, 0), |name| (name.grade, name.rank))
    }

    /// The columns whose names say that they stand on this side.
    fn on(&self, side: Side) -> impl Iterator<Item = usize> {
        let is_on = move |column: &usize| self.name(*column).is_some_and(|n| n.side == Some(side));
        self.moving.iter().copied().filter(is_on)
    }

    /// Those of them whose names say it best, but for the `others`; where no name says it, those of which
    /// names say nothing, if any output is looked for.
    fn best_on(&self, side: Side, others: &[usize]) -> Vec<usize> {
        let is_free = |column: &usize| !others.contains(column);
        let best = self.on(side).filter(is_free).map(|column| self.grade(column, side)).min();
        let is_best = |column: &usize| match best {
            Some(best) => self.grade(*column, side) == best,
            None => side == Side::Output && self.likelihood(*column).0 == Grade::Silent,
        };
        self.moving.iter().copied().filter(is_free).filter(is_best).collect()
    }

    /// The pair with how its output follows.
    fn followed(&self, pair: Pair) -> Pair {
        Pair { follows: self.following(pair.input, pair.output), ..pair }
    }

    /// How the output's rate follows the input, where that is clear; a speed that is measured is none.
    fn following(&self, input: usize, output: usize) -> Option<f64> {
        let follows = self.signal(output)?.follows(self.signal(input)?)?;
        (!self.is_measured_rate(input, output)).then_some(follows)
    }

    /// Whether a column that is not named like an input is the rate of `output`.
    fn is_measured_rate(&self, input: usize, output: usize) -> bool {
        let is_input = self.name(input).is_some_and(|name| name.side == Some(Side::Input));
        let signals = self.signal(input).zip(self.signal(output)).filter(|_| !is_input);
        signals.is_some_and(|(input, output)| input.is_rate_of(output))
    }
}

/// Whether one follows about as much as the one that does most.
fn is_alike(follows: f64, most: f64) -> bool {
    follows >= 0.8 * most
}
