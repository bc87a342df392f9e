//! Which column holds the times of a log, and in what unit.

use super::error::ReadError;
use super::table::{Head, Header};
use super::unit;
use crate::units::SamplePeriod;

/// Names of a time column, the preferred first.
const TIME_NAMES: [&str; 3] = ["time_s", "t_s", "time"];

/// Further names of a column of times, in lower case, without the unit they may end in.
const FURTHER_TIME_NAMES: &str = "time|t|timestamp|time_stamp|time stamp|stamp|ts|\
    elapsed|elapsed_time|elapsed time|datetime|date_time|date time|date&time|\
    seconds|sec|millis|micros|epoch|unix|unix_time|unixtime|time_unix|unix timestamp|unix_timestamp|\
    posix|posix_time|utc|clock|tick|log_time|recorded_at|__time|%time|rosbagtimestamp|\
    zeit|uhrzeit|zeitstempel|temps|tiempo|tempo|tid|aika|czas|čas|時間|时间|время|x_value";

/// Those of them that are units themselves.
const TIME_UNIT_NAMES: [&str; 4] = ["seconds", "sec", "millis", "micros"];

/// The place of a name, in lower case and without a unit, among those of times.
fn known_place(name: &str) -> Option<usize> {
    FURTHER_TIME_NAMES.split('|').position(|known| known == without_unit(name))
}

/// Where the time of a row comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimeSource {
    /// A column of times, and the seconds in its unit where the unit is known.
    Times(usize, Option<f64>),
    /// A column of sample numbers, one period apart.
    SampleNumbers(usize, SamplePeriod),
    /// The rows themselves, one period apart.
    Rows(SamplePeriod),
}

impl TimeSource {
    /// The column that it is read from.
    pub(super) fn column(self) -> Option<usize> {
        match self {
            Self::Times(column, _) | Self::SampleNumbers(column, _) => Some(column),
            Self::Rows(_) => None,
        }
    }
}

/// A column of times in the unit that is `given`, else that its header states, else that its
/// name ends in, else that is one of its words.
pub(super) fn times(
    head: &Head,
    column: usize,
    given: Option<&str>,
) -> Result<TimeSource, ReadError> {
    let header = head.headers.get(column);
    let name = header.map_or("", |header| header.name.as_str());
    let stated = given.or_else(|| header?.unit.as_deref());
    let lower = name.to_lowercase();
    let named = || unit::of_time(name).or_else(|| unit::of_time(&lower));
    let is_itself = || Some(lower.as_str()).filter(|name| TIME_UNIT_NAMES.contains(name));
    let Some(unit) = stated.or_else(named).or_else(is_itself) else {
        let text = header.map_or("", |header| header.text.as_str());
        return Ok(TimeSource::Times(column, unit::time_within(text)));
    };
    let unknown = || {
        let text = format!(
            "time in [{unit}] is not known; expected [s], [ms], [us], [ns], [min] or no unit"
        );
        ReadError::content(text).in_row(head.header_row).in_column(name)
    };
    // `[hh:mm:ss]` is how a time is written, and no unit.
    if unit.to_lowercase().contains("mm:ss") {
        return Ok(TimeSource::Times(column, None));
    }
    Ok(TimeSource::Times(column, Some(unit::time_in(unit).ok_or_else(unknown)?)))
}

/// The column that a name such as `timestamp`, `t_us` or `elapsed` says holds the time.
pub(super) fn find_time_column(head: &Head) -> Option<usize> {
    let place = |header: &Header| known_place(&header.name.to_lowercase());
    let columns = head.headers.iter().enumerate().filter(|(_, header)| header.name != "T");
    let named = columns.filter_map(|(column, header)| Some((place(header)?, column)));
    // `T` is a temperature, too.
    let is_t = |header: &Header| header.name == "t";
    find_any(head, &TIME_NAMES)
        .or_else(|| head.headers.iter().position(is_t))
        .or_else(|| named.min().map(|(_, column)| column))
        .or_else(|| find_any(head, &["t"]))
}

/// The column of what the whole seconds in `column` leave over, where a stamp is written in two, as those of
/// ROS are (`sec`, `nanosec`), and its unit in seconds.
pub(super) fn rest_of_times(head: &Head, column: usize) -> Option<(usize, f64)> {
    const WHOLE: [&str; 3] = ["seconds", "secs", "sec"];
    let name = head.headers.get(column)?.text.to_lowercase();
    let before = WHOLE.iter().find_map(|whole| name.strip_suffix(whole))?;
    let mut headers = head.headers.iter().enumerate();
    headers.find_map(|(place, header)| {
        let text = header.text.to_lowercase();
        let rest = text.strip_prefix(before).filter(|rest| rest.contains("sec"))?;
        unit::time_in(rest).filter(|unit_s| *unit_s < 1e-3).map(|unit_s| (place, unit_s))
    })
}

/// What a reader should know of a log whose times are those of `column`: that others, which no joint
/// `uses` as a signal, are not used, and that what may be a temperature is taken for a time.
pub(super) fn note_on_times(head: &Head, column: usize, uses: &[usize]) -> Option<String> {
    /// Columns that are named.
    const MOST: usize = 3;
    let text = &head.headers.get(column)?.text;
    let rest = rest_of_times(head, column).map(|(rest, _)| rest);
    let others = head.headers.iter().enumerate().filter(|(other, header)| {
        let is_within = *other > 0 && other + 1 < head.headers.len();
        // Those of its name say the same.
        header.text != *text
            && !uses.contains(other)
            && rest != Some(*other)
            && (is_like_a_time(head, header) || header.name.is_empty() && is_within)
    });
    let mut names: Vec<String> = others.map(|(other, header)| named(other, header)).collect();
    let header = head.headers.get(column)?;
    let used = format!("the times are those in {}", named(column, header));
    if names.is_empty() {
        return (header.name == "T").then_some(used);
    }
    let are = if names.len() == 1 { "is" } else { "are" };
    if names.len() > MOST {
        names.truncate(MOST);
        names.push("…".to_owned());
    }
    Some(format!("{used}; {} {are} not used", names.join(", ")))
}

/// A column as a note calls it.
fn named(column: usize, header: &Header) -> String {
    match header.text.as_str() {
        "" => format!("column {} (without a name)", column + 1),
        text => format!("`{text}`"),
    }
}

/// Whether a name is one of a time, also with a number after it or that of a joint before it; or of a time and
/// of something else, as of a signal that has a clock of its own: `time_y`, `stamp_out`, `Time(1)`; `t_y` beside
/// a signal `y`, as `t_oil` is a temperature.
fn is_like_a_time(head: &Head, header: &Header) -> bool {
    const TIMES: [&str; 6] = ["time", "times", "timestamp", "stamp", "zeit", "temps"];
    const SIGNALS: [&str; 6] = ["in", "out", "input", "output", "u", "y"];
    let name = header.name.to_lowercase();
    let is_other = header.unit.as_deref().is_some_and(|unit| !unit::is_time(unit));
    // Messages and their parts have stamps of their own.
    let is_stamp = name.starts_with('/') || name.contains("header.stamp") || name == "publish_time";
    if header.name == "T" || is_other || is_stamp {
        return false;
    }
    let words = name.split(|c: char| !c.is_alphanumeric());
    let words: Vec<&str> = words.map(|word| word.trim_end_matches(char::is_numeric)).collect();
    let is_signal = |word: &&str| {
        let of = |other: &Header| other.name.eq_ignore_ascii_case(word);
        SIGNALS.contains(word) || word.len() > 1 && head.headers.iter().any(of)
    };
    known_place(&name).is_some()
        || words.iter().any(|word| TIMES.contains(word))
        || words.contains(&"t") && words.iter().any(is_signal)
}

/// A name in lower case without the unit of time that it ends in.
fn without_unit(name: &str) -> &str {
    let bare = unit::of_time(name).and_then(|unit| name.strip_suffix(unit));
    bare.map_or(name, |bare| bare.trim_end_matches('_'))
}

pub(super) fn find_any(head: &Head, wanted: &[&str]) -> Option<usize> {
    wanted.iter().find_map(|wanted| {
        head.headers.iter().position(|header| header.name.eq_ignore_ascii_case(wanted))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note(names: &[&str]) -> Option<String> {
        let headers = names.iter().map(|name| Header::parse(name)).collect();
        let head = Head { headers, header_row: 1, unread: Vec::new() };
        note_on_times(&head, find_time_column(&head)?, &[])
    }

    #[test]
    fn a_second_column_of_times_is_not_passed_over_in_silence() {
        for other in [
            "time_s.1",
            "Time2 [s]",
            "Time (s) 2",
            "arm.time_s",
            "",
            "t",
            "timestamp",
            "time_y",
            "t_y",
            "timestamp_y",
            "t_out_s",
            "time_y_s",
            "y_timestamp",
            "Time(1)",
            "stamp y",
        ] {
            let found = note(&["time_s", "boom.input", "boom.output", other, "arm.input"]);
            assert!(found.is_some_and(|note| note.contains("not used")), "{other}");
        }
        for other in ["T", "T [degC]", "t_oil_degC", "boom.speed", "/joint/header.stamp.sec"] {
            assert_eq!(note(&["time_s", "boom.input", other]), None, "{other}");
        }
        assert_eq!(
            note(&["", "time_s", "u", "y", ""]),
            None,
            "an index, and a separator after the row"
        );
        assert_eq!(note(&["T", "u", "y"]).as_deref(), Some("the times are those in `T`"));
    }

    #[test]
    fn stamps_in_two_columns_are_one() {
        for (whole, rest, unit_s) in [
            ("sec", "nanosec", 1e-9),
            ("time_sec", "time_nsec", 1e-9),
            ("header.stamp.sec", "header.stamp.nanosec", 1e-9),
            ("tv_sec", "tv_usec", 1e-6),
        ] {
            let headers = [whole, "u", rest].map(Header::parse).to_vec();
            let head = Head { headers, header_row: 1, unread: Vec::new() };
            assert_eq!(rest_of_times(&head, 0), Some((2, unit_s)), "{whole}");
            assert_eq!(rest_of_times(&head, 1), None);
        }
        assert_eq!(note(&["sec", "nanosec", "u"]), None, "it is used");
    }

    #[test]
    fn a_stamp_is_preferred_to_a_temperature() {
        for stamp in ["ts", "ts_ms", "unix_ms", "clock_ms", "log_time", "recorded_at"] {
            let headers = [stamp, "T", "u"].map(Header::parse).to_vec();
            let head = Head { headers, header_row: 1, unread: Vec::new() };
            assert_eq!(find_time_column(&head), Some(0), "{stamp}");
        }
    }
}
