//! Which columns drive and measure which joint.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::signal::Signal;
use super::words::{INPUT_WORDS, OTHER_WORDS, OUTPUT_WORDS, WANTED_WORDS, rank, words};
use crate::experiment::table::{Head, Header};
use crate::experiment::unit;

/// A joint that was found, with the reasons.
pub(super) struct FoundJoint {
    pub(super) name: String,
    pub(super) input: usize,
    pub(super) output: usize,
    pub(super) why: [String; 2],
    /// Whether names say both what drives it and what it does, and nothing else could be meant.
    pub(super) is_sure: bool,
}

/// A log's columns by their names, and what they hold.
pub(super) struct Columns<'a> {
    pub(super) head: &'a Head,
    /// The numbers of each column; none of the time, and of what holds no numbers.
    pub(super) signals: &'a [Option<Signal>],
    /// Words that every column of numbers has, as the name of the machine before each: they say of
    /// no joint which it is.
    common: Vec<String>,
}

impl<'a> Columns<'a> {
    pub(super) fn of(head: &'a Head, signals: &'a [Option<Signal>]) -> Self {
        let columns = head.headers.iter().zip(signals).filter(|(_, signal)| signal.is_some());
        let mut columns = columns.map(|(header, _)| words(&header.name));
        let mut common = columns.next().unwrap_or_default();
        for words in columns {
            common.retain(|word| words.contains(word));
        }
        Self { head, signals, common }
    }
}

impl Columns<'_> {
    /// The joints: those whose columns have native names, else those whose names say so, else
    /// the one that the data show.
    pub(super) fn joints(&self) -> Vec<FoundJoint> {
        let native = self.native();
        if !native.is_empty() {
            return native;
        }
        let mut outputs = self.named(&OUTPUT_WORDS);
        outputs.retain(|column| rank(&self.words(*column), &WANTED_WORDS).is_none());
        let mut inputs = self.named(&INPUT_WORDS);
        inputs.retain(|column| !outputs.contains(column));
        let mut joints = self.by_names(&inputs, &outputs);
        if joints.is_empty()
            && let [input] = inputs.as_slice()
        {
            let follower = self.follower(*input, &outputs);
            let is_sure = follower.is_some() || outputs.len() == 1;
            let is_sure = is_sure && (!self.is_bare(*input) || self.are_the_only(*input, &outputs));
            let output = follower.or(outputs.first().copied());
            let joint = |output| FoundJoint { is_sure, ..self.joint(None, *input, output) };
            joints.extend(output.map(joint));
        }
        joints.retain(|joint| !self.is_doubtful(joint));
        if joints.is_empty() { self.by_data(&outputs).into_iter().collect() } else { joints }
    }

    /// For each of `joints` the columns that are named like what drives it, too, and are no joint's.
    pub(super) fn further_inputs(&self, joints: &[FoundJoint]) -> Vec<(String, usize)> {
        let taken: HashSet<usize> =
            joints.iter().flat_map(|joint| [joint.input, joint.output]).collect();
        let mut inputs = self.named(&INPUT_WORDS);
        inputs.retain(|column| {
            !taken.contains(column) && self.rank(*column, &OUTPUT_WORDS).is_none()
        });
        inputs.sort_unstable();
        let of_joint = |column: usize| {
            let words = self.own_words(column);
            let shares = |joint: &&FoundJoint| {
                self.own_words(joint.output).iter().any(|word| words.contains(word))
            };
            joints.iter().find(shares).map(|joint| (joint.name.clone(), column))
        };
        inputs.into_iter().filter_map(of_joint).collect()
    }

    /// Joints whose columns have native names.
    fn native(&self) -> Vec<FoundJoint> {
        let headers = self.head.headers.iter().enumerate();
        // Of two with one name the first.
        let places: HashMap<&str, usize> =
            headers.rev().map(|(index, header)| (header.name.as_str(), index)).collect();
        let place = |name: &str| places.get(name).copied();
        let joint = |(input, header): (usize, &Header)| {
            let name = header.name.strip_suffix(".input")?.to_owned();
            let output = place(&format!("{name}.output"))?;
            let why = ["its name ends in .input", "its name ends in .output"].map(str::to_owned);
            Some(FoundJoint { name, input, output, why, is_sure: true })
        };
        self.head.headers.iter().enumerate().filter_map(joint).collect()
    }

    /// Pairs whose names share the words that say which joint: those that share most first, and
    /// of these the likeliest. In the order of the file.
    fn by_names(&self, inputs: &[usize], outputs: &[usize]) -> Vec<FoundJoint> {
        let Some(mut pairs) = self.sharing(inputs, outputs) else { return Vec::new() };
        pairs.sort_by_key(|(shared, ..)| std::cmp::Reverse(shared.len()));
        let (mut joints, mut columns, mut names) = (Vec::new(), HashSet::new(), HashSet::new());
        for (shared, input, output) in pairs {
            let name = self.distinguishing(shared).join("_");
            let is_taken =
                columns.contains(&input) || columns.contains(&output) || names.contains(&name);
            if !is_taken {
                columns.extend([input, output]);
                names.insert(name.clone());
                joints.push(self.joint(Some(name), input, output));
            }
        }
        joints.sort_by_key(|joint| joint.input);
        joints
    }

    /// The pairs of an input and an output that share words, with these; none where there are so many
    /// that their names say nothing.
    fn sharing(
        &self,
        inputs: &[usize],
        outputs: &[usize],
    ) -> Option<Vec<(Vec<String>, usize, usize)>> {
        /// Pairs that are compared: those of a thousand inputs with as many outputs.
        const MOST: usize = 1_000_000;
        let words_of: Vec<BTreeSet<String>> =
            outputs.iter().map(|output| self.own_words(*output).into_iter().collect()).collect();
        let mut with: HashMap<&str, Vec<usize>> = HashMap::new();
        for (place, words) in words_of.iter().enumerate() {
            for word in words {
                with.entry(word).or_default().push(place);
            }
        }
        let (mut pairs, mut compared) = (Vec::new(), 0);
        for input in inputs {
            let words = self.own_words(*input);
            let near = words.iter().filter_map(|word| with.get(word.as_str()));
            compared += near.clone().map(Vec::len).sum::<usize>();
            if compared > MOST {
                return None;
            }
            let places: BTreeSet<usize> = near.flatten().copied().collect();
            for (others, output) in places.iter().map(|place| (&words_of[*place], outputs[*place]))
            {
                let shared = words.iter().filter(|word| others.contains(*word)).cloned().collect();
                pairs.push((shared, *input, output));
            }
        }
        Some(pairs)
    }

    /// Where names say nothing: what holds levels drives, what follows it best is driven.
    fn by_data(&self, outputs: &[usize]) -> Option<FoundJoint> {
        let all = 0..self.head.headers.len();
        let holds = |column: &usize| self.signal(*column).is_some_and(Signal::holds_levels);
        let held: Vec<usize> = all.clone().filter(holds).collect();
        let [input] = held.as_slice() else { return None };
        let moving = |column: &usize| column != input && self.signal(*column).is_some();
        let others: Vec<usize> = all.filter(moving).collect();
        let output = self.follower(*input, if outputs.is_empty() { &others } else { outputs })?;
        Some(FoundJoint { is_sure: false, ..self.joint(None, *input, output) })
    }

    /// Whether a name is no more than a word of block diagrams, which any column may have.
    fn is_bare(&self, column: usize) -> bool {
        const BARE: [&str; 5] = ["u", "in", "input", "control", "signal"];
        matches!(self.words(column).as_slice(), [word] if BARE.contains(&word.as_str()))
    }

    /// Whether the input and the one output are all that moves beside the time: then what else
    /// could be meant?
    fn are_the_only(&self, input: usize, outputs: &[usize]) -> bool {
        let moving = (0..self.head.headers.len()).filter(|column| self.signal(*column).is_some());
        let others: Vec<usize> = moving.filter(|column| *column != input).collect();
        others.as_slice() == outputs && outputs.len() == 1
    }

    /// Whether nothing but the little word `in` says that a joint's input is one: neither another
    /// word of its name, nor an output that follows it.
    fn is_doubtful(&self, joint: &FoundJoint) -> bool {
        let mut words = self.words(joint.input);
        words.retain(|word| word != "in");
        rank(&words, &INPUT_WORDS).is_none() && self.following(joint.input, joint.output).is_none()
    }

    fn joint(&self, name: Option<String>, input: usize, output: usize) -> FoundJoint {
        let word = |column: usize, known: &[&str]| {
            let words = self.words(column);
            let found = rank(&words, known).and_then(|rank| known.get(rank).copied());
            found.map_or_else(String::new, |word| format!("`{word}` in its name; "))
        };
        let says = |column: usize| self.signal(column).map_or_else(String::new, Signal::says);
        let own = self.own_words(output).into_iter().chain(self.own_words(input)).collect();
        let own = self.distinguishing(own).into_iter().next();
        let mut why = [
            format!("{}{}", word(input, &INPUT_WORDS), says(input)),
            format!("{}{}", word(output, &OUTPUT_WORDS), says(output)),
        ];
        if let Some(follows) = self.following(input, output) {
            let [_, output] = &mut why;
            *output = format!("{output}; its rate follows the input (correlation {follows:+.2})");
        }
        let name = name.or(own).unwrap_or_else(|| "joint".to_owned());
        FoundJoint { name, input, output, why, is_sure: true }
    }

    fn words(&self, column: usize) -> Vec<String> {
        self.head.headers.get(column).map(|header| words(&header.name)).unwrap_or_default()
    }

    /// The words of a name that say which joint, and not what of it.
    fn own_words(&self, column: usize) -> Vec<String> {
        let mut words = self.words(column);
        let is_kind = |word: &String| {
            let word = word.as_str();
            INPUT_WORDS.contains(&word) && word != "stick"
                || OUTPUT_WORDS.contains(&word)
                || OTHER_WORDS.contains(&word)
                || unit::is_unit(word)
                || unit::is_unit(&word.to_uppercase())
        };
        words.retain(|word| !is_kind(word));
        words
    }

    /// Those of a joint's `words` that say which it is; all of them where none does.
    fn distinguishing(&self, words: Vec<String>) -> Vec<String> {
        let rest: Vec<_> =
            words.iter().filter(|word| !self.common.contains(word)).cloned().collect();
        if rest.is_empty() { words } else { rest }
    }

    fn signal(&self, column: usize) -> Option<&Signal> {
        self.signals.get(column)?.as_ref().filter(|signal| !signal.is_constant())
    }

    /// The first pair that its names say is a joint, of the columns that `is_free` says are none's.
    pub(super) fn first_by_names(&self, is_free: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
        let named = |known: &[&str]| -> Vec<usize> {
            let all = (0..self.head.headers.len()).filter(|column| is_free(*column));
            all.filter(|column| self.rank(*column, known).is_some()).collect()
        };
        let outputs = named(&OUTPUT_WORDS);
        let mut inputs = named(&INPUT_WORDS);
        inputs.retain(|column| !outputs.contains(column));
        let pairs = self.sharing(&inputs, &outputs)?;
        pairs.into_iter().map(|(_, input, output)| (input, output)).min()
    }

    /// The place among these words of the one that a name has, and no word of something else.
    fn rank(&self, column: usize, known: &[&str]) -> Option<usize> {
        let words = self.words(column);
        rank(&words, known).filter(|_| rank(&words, &OTHER_WORDS).is_none())
    }

    /// Columns that move and whose names have one of these words, the likeliest first.
    fn named(&self, known: &[&str]) -> Vec<usize> {
        let ranked = |column: usize| {
            self.signal(column)?;
            self.rank(column, known).map(|rank| (rank, column))
        };
        let mut found: Vec<_> = (0..self.head.headers.len()).filter_map(ranked).collect();
        found.sort_unstable();
        found.into_iter().map(|(_, column)| column).collect()
    }

    /// The one of `outputs` whose rate follows `input` best.
    fn follower(&self, input: usize, outputs: &[usize]) -> Option<usize> {
        let follows = |&output: &usize| Some((self.following(input, output)?.abs(), output));
        let best = outputs.iter().filter_map(follows).max_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, output)| output)
    }

    /// The correlation of the output's rate with the input, where it is clear.
    fn following(&self, input: usize, output: usize) -> Option<f64> {
        self.signal(output)?.follows(self.signal(input)?)
    }
}
