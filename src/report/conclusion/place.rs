//! How large an error is, and where in the record it arises.

use super::{Passage, Topic};
use crate::diagnosis::ShownBy;
use crate::diagnosis::failure::WorstSegment;
use crate::report::consequence::{in_proportion, times_as_large};
use crate::report::finding::Finding;
use crate::wording::{capitalized, failure_sentences, percent, rounded, worst_segment_text};

impl Finding<'_> {
    /// How large the error is.
    pub(super) fn size(&self) -> String {
        let error = self.output(self.error());
        match (self.comparison().judged(), self.noise()) {
            (Some(judged), Some(noise)) => {
                format!("The error is {error}, {}.", in_proportion(judged, Some(noise)))
            }
            _ => format!("The error is {error}."),
        }
    }

    /// How large the error is, and where.
    pub(in crate::report) fn fails(&self) -> Vec<Passage> {
        let size = std::iter::once(self.size()).chain(self.shown_beside_size());
        let passages =
            [Passage::of(Topic::Error, size), self.where_it_fails(), self.worst_segments()];
        passages.into_iter().flatten().collect()
    }

    /// What shows the lack of fit of an error that may be no larger than noise.
    fn shown_beside_size(&self) -> Option<String> {
        let test = self.comparison().lack_of_fit?;
        match test.shown_by? {
            ShownBy::UnseenPart => {
                let times = times_as_large(test.times_training?);
                Some(format!("On the part that was not fitted it is {times}."))
            }
            ShownBy::FewWindows => {
                let times = rounded(test.local?.times_noise?);
                Some(format!(
                    "It is not spread as noise would be: in one window the motion that is \
                     missed is {times} times the noise."
                ))
            }
            ShownBy::Shapes | ShownBy::Size => None,
        }
    }

    /// Under which conditions most of the error arises.
    pub(super) fn where_it_fails(&self) -> Option<Passage> {
        let conditions = failure_sentences(self.joint(), self.comparison());
        let has_segments = self.segments().next().is_some();
        let none = "No condition was found that holds most of the error.".to_owned();
        let none = Some(none).filter(|_| conditions.is_empty() && has_segments);
        let conditions = conditions.iter().map(|when| format!("{}.", capitalized(when)));
        Passage::of(Topic::WhereItFails, conditions.chain(none))
    }

    /// Times to look at.
    pub(super) fn worst_segments(&self) -> Option<Passage> {
        let several = self.joint().trials.len() > 1;
        let time = |(index, worst): (usize, &WorstSegment)| {
            let trial = if several { format!("trial {}, ", worst.trial) } else { String::new() };
            let of = if index == 0 { " of its squared error" } else { "" };
            let share = percent(worst.share_of_squared_error);
            format!("{trial}{} ({share}{of})", worst_segment_text(worst))
        };
        let times: Vec<String> = self.segments().take(3).enumerate().map(time).collect();
        let look = format!("The residual is largest in {}.", times.join(", "));
        Passage::of(Topic::WorstSegments, Some(look).filter(|_| !times.is_empty()))
    }

    fn segments(&self) -> impl Iterator<Item = &WorstSegment> {
        self.comparison().failure.iter().flat_map(|failure| &failure.worst_segments)
    }
}
