//! Logs as Parquet.
#![no_main]

use libfuzzer_sys::{Corpus, fuzz_mutator, fuzz_target};
use tauscope_fuzz::{attempts, mutate, share};

fuzz_target!(|bytes: &[u8]| -> Corpus { share::count(attempts::log("log.parquet", bytes)) });

fuzz_mutator!(|data: &mut [u8], size: usize, max: usize, seed: u32| {
    mutate::parquet(data, size, max, seed)
});
