//! The doubt of a decision in words.

use super::number::to_place;
#[cfg(feature = "rrd")]
use super::{counted, number, percent};
use crate::delay::{Condition, Doubt, Flag, Verdict};

/// Margin of a condition that failed up to which it failed by little.
const LITTLE: f64 = 0.3;

/// What speaks most against a decision with this verdict, on a trial sampled every `period_s`
/// seconds.
pub(crate) fn doubt_sentence(doubt: &Doubt, verdict: Verdict, period_s: f64) -> String {
    let seconds = |samples: f64| to_place(samples * period_s, 3);
    let near = doubt.nearest.filter(|(_, margin)| *margin < 1.0);
    if let Verdict::Rejected(_) = verdict {
        return near.map_or_else(
            || "no number is near its limit".to_owned(),
            |(condition, margin)| {
                let far = if margin < LITTLE { "by little" } else { "though not by far" };
                format!("{condition} fails {far}")
            },
        );
    }
    let [explained, placed, meeting] = doubt.margins();
    let mut reasons = vec![
        (explained, {
            let percent = to_place(100.0 * (1.0 - explained), 0);
            let of = if doubt.settles { "no reaction" } else { "one line" };
            let what = if doubt.settles { "reaction" } else { "break" };
            format!("the {what} leaves {percent} % of the squared error of {of}")
        }),
        (placed, format!("breakpoints {} s apart fit about as well", seconds(doubt.spread))),
        (meeting, format!("the lines cross {} s from the breakpoint", seconds(doubt.crossing))),
    ];
    reasons.extend(near.map(|(condition, margin)| (margin, by_little(condition))));
    let least = reasons.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let flags = doubt.flags.iter().map(|flag: &Flag| flag.meaning().to_owned());
    let sentences = flags.chain(least.map(|(_, reason)| reason));
    sentences.collect::<Vec<_>>().join("; ")
}

/// What speaks most against a decision, as short as it can be said.
#[cfg(feature = "rrd")]
pub(crate) fn doubt_in_short(doubt: &Doubt, verdict: Verdict, period_s: f64) -> String {
    let near = doubt.nearest.filter(|(_, margin)| *margin < 1.0);
    if let Verdict::Rejected(_) = verdict {
        return near.map_or_else(
            || "no number near its limit".to_owned(),
            |(condition, _)| format!("near the limit of {}", condition.id()),
        );
    }
    match doubt.flags.first() {
        Some(Flag::Edge) => return "edge of its segment".to_owned(),
        Some(Flag::Jump) => return "lines jump apart".to_owned(),
        Some(Flag::Stop) => return "output at its end".to_owned(),
        None => {}
    }
    let seconds = |samples: f64| to_place(samples * period_s, 3);
    let [explained, placed, meeting] = doubt.margins();
    let mut reasons = vec![
        (explained, format!("error left {}", percent(1.0 - explained))),
        (placed, format!("breaks {} s apart fit alike", seconds(doubt.spread))),
        (meeting, format!("lines cross {} s off", seconds(doubt.crossing))),
    ];
    reasons.extend(near.map(|(condition, margin)| (margin, format!("near {}", condition.id()))));
    let least = reasons.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    least.map_or_else(String::new, |(_, reason)| reason)
}

/// A condition that holds by little.
fn by_little(condition: Condition) -> String {
    let words = match condition {
        Condition::BeforeInput => "the breakpoint is close to the input step",
        Condition::SlopeChange => "the change of slope is close to its limit",
        Condition::ShortHold => "the hold is close to the shortest allowed",
        Condition::OutputLimit => "the output is near its limit",
        Condition::Sse => "the squared error is near its limit",
        Condition::AtRest => "the motion is close to that of a joint at rest",
        Condition::NothingHappened => "noise alone could explain it",
        Condition::FirstOrLast | Condition::TooShort | Condition::Reviewer => {
            return format!("{condition} is near its limit");
        }
    };
    format!("{words} ({condition})")
}

/// How many decisions are doubtful, and when one is: `6 of 587 decisions are doubtful (…)`.
#[cfg(feature = "rrd")]
pub(crate) fn doubtful_sentence<'d>(all: impl Iterator<Item = &'d Doubt>) -> String {
    let (doubtful, all) = all.fold((0_usize, 0_usize), |(doubtful, all), doubt| {
        (doubtful + usize::from(doubt.is_doubtful()), all + 1)
    });
    let (decisions, are) = (counted(all, "decision"), if doubtful == 1 { "is" } else { "are" });
    let from = number(Doubt::DOUBTFUL_PERCENT);
    format!("{doubtful} of {decisions} {are} doubtful (doubt of {from} % or more)")
}

/// What the number says.
#[cfg(feature = "rrd")]
pub(crate) const DOUBT_MEANS: &str = "\
A doubt of 0 % says that nothing speaks against the decision, one of 100 % that the least change \
would turn it; it is no probability.";

/// The doubt in percent.
pub(crate) fn doubt_percent(doubt: &Doubt) -> String {
    format!("{:.0} %", 100.0 * doubt.value())
}
