//! What a recording was made from: files, how they were read, the program.

use std::fmt::Write as _;

use super::markdown::plain;
use crate::experiment::{ReadOptions, Source};

/// The files, how they were read, and the program.
pub(super) fn made_from(
    page: &mut String,
    sources: &[Source],
    reading: &ReadOptions,
) -> std::fmt::Result {
    writeln!(page, "\n## Made from\n")?;
    for source in sources {
        let path = source.path.display();
        writeln!(page, "- `{path}`, {} bytes, SHA-256 `{}`", source.bytes, source.sha256)?;
    }
    writeln!(page, "\n{}", read_with(reading))?;
    writeln!(page, "\nMade by tauscope {}.\n", env!("CARGO_PKG_VERSION"))
}

/// How the files were read, where it was not as they are.
fn read_with(reading: &ReadOptions) -> String {
    let ReadOptions { columns, repair, .. } = reading;
    let mut parts = Vec::new();
    parts.extend(repair.resample.map(|period| format!("resampled to {period}")));
    parts.extend(
        repair.fill_s.map(|fill| format!("gaps up to {fill} s filled, split at longer ones")),
    );
    parts.extend(columns.sample_period_s.map(|s| format!("a sample period of {s} s given")));
    parts.extend(columns.time.iter().map(|time| format!("time from column `{time}`")));
    parts.extend(columns.trial.iter().map(|trial| format!("trials from column `{trial}`")));
    parts.extend(columns.joints.iter().map(|joint| {
        format!("{} from `{}` and `{}`", plain(&joint.name), joint.input, joint.output)
    }));
    if parts.is_empty() {
        "Read as they are.".to_owned()
    } else {
        format!("Read with: {}.", parts.join("; "))
    }
}
