//! Logs of ROS 2, in chunks that are compressed or not, and without chunks.
#![no_main]

use libfuzzer_sys::{Corpus, fuzz_mutator, fuzz_target};
use tauscope_fuzz::{attempts, mutate, share};

fuzz_target!(|bytes: &[u8]| -> Corpus { share::count(attempts::log("log.mcap", bytes)) });

fuzz_mutator!(|data: &mut [u8], size: usize, max: usize, seed: u32| {
    mutate::mcap(data, size, max, seed)
});
