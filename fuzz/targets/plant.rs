//! Plants, of which small ones are driven.
#![no_main]

use libfuzzer_sys::{Corpus, fuzz_mutator, fuzz_target};
use tauscope_fuzz::{attempts, mutate, share};

fuzz_target!(|bytes: &[u8]| -> Corpus { share::count(attempts::plant(bytes)) });

fuzz_mutator!(|data: &mut [u8], size: usize, max: usize, seed: u32| {
    mutate::toml(data, size, max, seed)
});
