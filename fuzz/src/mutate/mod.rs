//! Ways to change an input that keep its form: bytes alone seldom get past a checksum, a size
//! or a compression.
//!
//! Each takes a file of the format apart, changes a part of it, by libFuzzer's own ways and its
//! dictionary too, and puts it together again. A corpus is made of files as users have them.

mod archive;
mod elements;
mod footer;
mod records;
mod tables;
mod tree;

use libfuzzer_sys::fuzzer_mutate;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// One of so many inputs is changed without heed of its form.
const BLIND: u32 = 16;

/// Numbers at the ends of what they may be.
const EXTREMES: [u64; 12] = [
    0,
    1,
    u64::MAX,
    u64::MAX - 7,
    u64::MAX >> 1,
    1 << 63,
    0xffff_ffff,
    0x7fff_ffff,
    0x8000_0000,
    100_000_000_000,
    0x4000_0000,
    0x1_0000,
];

/// Where random choices come from, and how long an input may become.
struct Mutation {
    rng: ChaCha8Rng,
    max: usize,
}

impl Mutation {
    fn below(&mut self, count: usize) -> usize {
        self.rng.random_range(0..count.max(1))
    }

    fn one_in(&mut self, count: u32) -> bool {
        self.rng.random_ratio(1, count)
    }

    fn extreme(&mut self) -> u64 {
        EXTREMES[self.below(EXTREMES.len())]
    }

    /// A number near another one, or at the ends of what numbers may be.
    fn float(&mut self, number: f64) -> f64 {
        const FLOATS: [f64; 12] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            1e-9,
            1e-300,
            5e-324,
            1e300,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ];
        match self.below(4) {
            0 => FLOATS[self.below(FLOATS.len())],
            1 => f64::from_bits(number.to_bits() ^ (1 << self.below(64))),
            2 => -number,
            _ => number * [0.1, 0.5, 2.0, 10.0][self.below(4)],
        }
    }

    /// Changes bytes as libFuzzer does.
    fn bytes(&mut self, bytes: &mut Vec<u8>) {
        let size = bytes.len();
        let max = (2 * size + 64).min(self.max.max(size));
        bytes.resize(max, 0);
        let size = fuzzer_mutate(bytes, size, max);
        bytes.truncate(size);
    }

    /// Changes a text as libFuzzer does; what is no text then is replaced.
    fn text(&mut self, text: &str) -> String {
        let mut bytes = text.as_bytes().to_vec();
        self.bytes(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Changes bytes, or overwrites a number of four or eight of them, as sizes and addresses
    /// are.
    fn numbers(&mut self, bytes: &mut Vec<u8>) {
        let width = [4, 8][self.below(2)];
        if bytes.len() < width || self.one_in(2) {
            return self.bytes(bytes);
        }
        let place = self.below(bytes.len() - width + 1);
        let place = if self.one_in(2) { place / 4 * 4 } else { place };
        let field = &mut bytes[place..place + width];
        let mut number = [0; 8];
        number[..width].copy_from_slice(field);
        let number = match self.below(3) {
            0 => u64::from_le_bytes(number).wrapping_add(1),
            1 => u64::from_le_bytes(number).wrapping_sub(1),
            _ => self.extreme(),
        };
        field.copy_from_slice(&number.to_le_bytes()[..width]);
    }

    /// Repeats, removes or swaps a part.
    fn shuffle<T: Clone>(&mut self, parts: &mut Vec<T>) {
        if parts.is_empty() {
            return;
        }
        let (one, other) = (self.below(parts.len()), self.below(parts.len()));
        match self.below(3) {
            0 => parts.insert(other, parts[one].clone()),
            1 => parts.swap(one, other),
            _ => drop(parts.remove(one)),
        }
    }
}

/// Changes `data[..size]` by `change`, which gives nothing where it finds no form to keep.
fn with_form(
    data: &mut [u8],
    size: usize,
    max: usize,
    seed: u32,
    change: impl FnOnce(&mut Mutation, &[u8]) -> Option<Vec<u8>>,
) -> usize {
    let mut mutation = Mutation { rng: ChaCha8Rng::seed_from_u64(seed.into()), max };
    let changed = if mutation.one_in(BLIND) {
        None
    } else {
        change(&mut mutation, &data[..size]).filter(|changed| changed.len() <= max)
    };
    let Some(changed) = changed else { return fuzzer_mutate(data, size, max) };
    data[..changed.len()].copy_from_slice(&changed);
    changed.len()
}

/// A mutator of a target, of a change to a form.
macro_rules! mutators {
    ($($(#[$doc:meta])* $name:ident = $change:path;)*) => {
        $($(#[$doc])*
        pub fn $name(data: &mut [u8], size: usize, max: usize, seed: u32) -> usize {
            with_form(data, size, max, seed, $change)
        })*
    };
}

mutators! {
    /// Numbers of four and eight bytes.
    numbers = overwritten;
    /// Cells of a table.
    table = tables::cells;
    /// Words of a text.
    words = tables::words;
    /// Values, keys and tables of a TOML file.
    toml = tree::toml;
    /// Records of MCAP, within chunks as well.
    mcap = records::mcap;
    /// Elements of a file of MATLAB 5, within packed ones as well.
    mat5 = elements::mat5;
    /// The pages of Parquet, and the footer that describes them.
    parquet = footer::parquet;
    /// The files of an archive.
    xlsx = archive::xlsx;
}

fn overwritten(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = bytes.to_vec();
    mutation.numbers(&mut bytes);
    Some(bytes)
}
