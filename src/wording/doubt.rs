//! The doubt of a decision in words.

use super::number;
use crate::delay::{Doubt, Flag, Verdict};

/// What speaks most against a decision with this verdict, on a trial sampled every `period_s`
/// seconds.
pub(crate) fn doubt_sentence(doubt: &Doubt, verdict: Verdict, period_s: f64) -> String {
    let seconds = |samples: f64| number((samples * period_s * 1e3).round() / 1e3);
    let near = doubt.nearest.filter(|(_, margin)| *margin < 1.0);
    if let Verdict::Rejected(_) = verdict {
        return near.map_or_else(
            || "no number is near its limit".to_owned(),
            |(condition, _)| format!("{condition} fails by little"),
        );
    }
    let [explained, placed, meeting] = doubt.margins();
    let mut reasons = vec![
        (explained, {
            let percent = number((100.0 * explained).round());
            format!("the break removes {percent} % of the squared error of one line")
        }),
        (placed, format!("breakpoints {} s apart fit about as well", seconds(doubt.spread))),
        (meeting, format!("the lines cross {} s from the breakpoint", seconds(doubt.crossing))),
    ];
    reasons
        .extend(near.map(|(condition, margin)| (margin, format!("{condition} is near its limit"))));
    let least = reasons.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let flags = doubt.flags.iter().map(|flag: &Flag| flag.meaning().to_owned());
    let sentences = least.into_iter().map(|(_, reason)| reason).chain(flags);
    sentences.collect::<Vec<_>>().join("; ")
}

/// The doubt in percent.
pub(crate) fn doubt_percent(doubt: &Doubt) -> String {
    format!("{:.0} %", 100.0 * doubt.value())
}
