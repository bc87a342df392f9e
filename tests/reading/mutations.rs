//! Files with a few bytes changed: whatever they say, they are read or refused, soon and without
//! a panic. `TAUSCOPE_MUTATIONS` says how many of each file are tried, 20 to 300 unless given.

use crate::attempts;
#[cfg(any(feature = "mat", feature = "mcap"))]
use crate::bytes;
use crate::log_text::log_text;

use std::fs;
use std::time::{Duration, Instant};

use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Far longer than any takes, also without optimisation on a machine that is busy.
const LONGEST: Duration = Duration::from_secs(20);

/// Numbers at the ends of what they may be.
const EXTREMES: [u64; 9] = [
    0,
    1,
    u64::MAX,
    u64::MAX >> 1,
    1 << 63,
    0xffff_ffff,
    0x7fff_ffff,
    100_000_000_000,
    0x4000_0000,
];

/// The files that are changed: those of the formats, and texts.
fn seeds() -> Vec<(String, Vec<u8>)> {
    let mut seeds = vec![("text.csv".to_owned(), log_text().into_bytes())];
    let files = fs::read_dir("tests/golden/formats").unwrap();
    for path in files.map(|file| file.unwrap().path()) {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if ["mat", "mcap", "parquet"].iter().any(|end| name.ends_with(end)) {
            seeds.push((name, fs::read(&path).unwrap()));
        }
    }
    #[cfg(feature = "mcap")]
    for compression in ["", "zstd", "lz4"] {
        let records = [bytes::mcap::topic(bytes::mcap::JOINT), bytes::mcap::messages()].concat();
        let file = bytes::mcap::file(&bytes::mcap::chunk(&records, compression, 0));
        seeds.push((format!("chunk_{compression}.mcap"), file));
    }
    seeds.sort();
    seeds
}

/// Changes a few bytes, or cuts or doubles a part.
fn mutate(bytes: &mut Vec<u8>, rng: &mut ChaCha8Rng) {
    for _ in 0..rng.random_range(1..4) {
        let place = rng.random_range(0..bytes.len());
        let extreme = EXTREMES[rng.random_range(0..EXTREMES.len())];
        match rng.random_range(0..6) {
            0 => bytes[place] ^= 1 << rng.random_range(0..8),
            1 => bytes[place] = rng.next_u32().to_le_bytes()[0],
            2 => overwrite(bytes, place, &extreme.to_le_bytes()),
            3 => overwrite(bytes, place, &extreme.to_le_bytes()[..4]),
            4 => bytes.truncate(place.max(1)),
            _ => {
                let end = bytes.len().min(place + rng.random_range(1..200));
                let part = bytes[place..end].to_vec();
                let to = rng.random_range(0..bytes.len());
                bytes.splice(to..to, part);
            }
        }
    }
}

fn overwrite(bytes: &mut [u8], place: usize, with: &[u8]) {
    bytes[place..].iter_mut().zip(with).for_each(|(byte, with)| *byte = *with);
}

#[test]
fn files_with_some_bytes_changed_are_read_or_refused() {
    for (name, seed) in seeds() {
        attempts::log(&name, &seed);
        for number in 0..count(60) {
            let mut rng = ChaCha8Rng::seed_from_u64(number);
            let mut bytes = seed.clone();
            mutate(&mut bytes, &mut rng);
            let start = Instant::now();
            let done = std::panic::catch_unwind(|| attempts::log(&name, &bytes));
            let took = start.elapsed();
            assert!(done.is_ok(), "{name}, mutation {number}: it panics");
            assert!(took < LONGEST, "{name}, mutation {number}: {took:?}");
        }
    }
}

/// How many changed files are tried of each.
fn count(unless_given: u64) -> u64 {
    let given = std::env::var("TAUSCOPE_MUTATIONS").ok().and_then(|count| count.parse().ok());
    given.unwrap_or(unless_given)
}

/// Swaps, repeats and changes words, so that most of a text keeps its form.
fn change_words(text: &str, rng: &mut ChaCha8Rng) -> String {
    const WORDS: [&str; 12] = [
        "1e308",
        "-1e-320",
        "0",
        "-1",
        "nan",
        "inf",
        "18446744073709551616",
        "\"\"",
        "[]",
        "{}",
        "\"((((((((((u))))))))))\"",
        "true",
    ];
    let mut words: Vec<&str> = text.split_inclusive([' ', '\n']).collect();
    for _ in 0..rng.random_range(1..4) {
        let (one, other) = (rng.random_range(0..words.len()), rng.random_range(0..words.len()));
        match rng.random_range(0..4) {
            0 => words.swap(one, other),
            1 => words[one] = words[other],
            2 => words.insert(one, words[other]),
            _ => {
                words[one] = WORDS[rng.random_range(0..WORDS.len())];
                words.insert(one + 1, "\n");
            }
        }
    }
    words.concat()
}

#[test]
fn models_plants_and_mappings_with_some_words_changed_are_read_or_refused() {
    let mapping = "time = \"t\"\ntrial = \"none\"\n[joint.boom]\ninput = \"u\"\noutput = \"y\"\n";
    let texts = [
        fs::read_to_string("tests/cli/own_effect.toml").unwrap(),
        fs::read_to_string("data/manipulator.plant.toml").unwrap(),
        mapping.to_owned(),
    ];
    for number in 0..count(300) {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        for text in &texts {
            let text = change_words(text, &mut rng);
            let read = std::panic::catch_unwind(|| {
                attempts::model(text.as_bytes());
                attempts::plant(text.as_bytes());
                attempts::columns(text.as_bytes());
            });
            assert!(read.is_ok(), "number {number}: {text}");
        }
    }
}
