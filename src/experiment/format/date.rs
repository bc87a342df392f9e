//! Dates, and the seconds that they are.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;

/// Dates whose order follows from their form: with dots the day is first, as everywhere; where clocks count to twelve,
/// the month is. Which comes first in `3/1/2026 10:15:00` is not known.
const FORMS: [&str; 8] = [
    "%d.%m.%Y %H:%M:%S%.f",
    "%d.%m.%Y %H:%M",
    "%Y/%m/%d %H:%M:%S%.f",
    "%Y/%m/%d %H:%M",
    "%d-%b-%Y %H:%M:%S%.f",
    "%d-%b-%Y %H:%M",
    "%m/%d/%Y %I:%M:%S%.f %p",
    "%m/%d/%Y %I:%M %p",
];

/// Seconds since 1970 of a date and time, since midnight of a time of day, or of a time that has passed.
pub(super) fn seconds_of_date(text: &str) -> Option<f64> {
    let text = text.trim().trim_matches('"');
    // Most words are known at once to be no date.
    if !text.starts_with(|first: char| first.is_ascii_digit() || "+-".contains(first)) {
        return None;
    }
    let text = with_point(&text.replace(',', "."));
    if let Some(seconds) = text.strip_suffix(" sec").or_else(|| text.strip_suffix(" s")) {
        return seconds.parse().ok();
    }
    if let Ok(stamp) = with_zone(&text).parse::<Timestamp>() {
        return Some(seconds(stamp));
    }
    let civil = match text.parse::<Time>() {
        Ok(time) if !text.contains('-') => Some(Date::constant(1970, 1, 1).to_datetime(time)),
        _ => text.parse().ok().or_else(|| spelled(&text)),
    };
    let zoned = civil.and_then(|civil| civil.to_zoned(TimeZone::UTC).ok());
    zoned.map_or_else(|| passed(&text), |zoned| Some(seconds(zoned.timestamp())))
}

fn seconds(stamp: Timestamp) -> f64 {
    stamp.as_second() as f64 + f64::from(stamp.subsec_nanosecond()) * 1e-9
}

/// `2026-03-01 10:15:00+01:00`, of which databases write `2026-03-01 10:15:00 +0100`, and `… UTC`.
fn with_zone(text: &str) -> String {
    match text.rsplit_once(' ') {
        Some((date, "UTC" | "GMT" | "Z")) => format!("{date}Z"),
        Some((date, zone)) if zone.starts_with(['+', '-']) => format!("{date}{zone}"),
        _ => text.to_owned(),
    }
}

/// A date in one of the forms.
fn spelled(text: &str) -> Option<DateTime> {
    let (date, _) = text.split_once(' ')?;
    // Of two digits it is not known which century they are of.
    date.split(['.', '/', '-']).find(|part| part.len() == 4)?;
    FORMS.iter().find_map(|form| DateTime::strptime(form, text).ok())
}

/// Seconds since 1970 of `20260301101500`, or with milliseconds, `20260301101500120`. Counts of seconds,
/// ms, µs and ns since 1970 have 10, 13, 16 and 19 digits.
pub(super) fn seconds_of_compact_date(text: &str) -> Option<f64> {
    let (whole, part) = text.split_once(['.', ',']).unwrap_or((text, ""));
    let is_date = [14, 17].contains(&whole.len()) && ["19", "20"].contains(&whole.get(..2)?);
    let is_number = |digits: &str| digits.bytes().all(|digit| digit.is_ascii_digit());
    if !is_date || !is_number(whole) || !is_number(part) {
        return None;
    }
    let (seconds_of, millis) = whole.split_at_checked(14)?;
    let civil =
        DateTime::strptime("%Y%m%d%H%M%S", seconds_of).ok()?.to_zoned(TimeZone::UTC).ok()?;
    let behind: f64 = format!("0.{millis}{part}").parse().ok()?;
    Some(seconds(civil.timestamp()) + behind)
}

/// `10:00:01.250`, with the milliseconds after a point that some loggers write after a colon.
fn with_point(text: &str) -> String {
    if let Some((before, millis)) = text.rsplit_once(':')
        && before.matches(':').count() == 2
        && millis.bytes().take_while(u8::is_ascii_digit).count() == 3
    {
        return format!("{before}.{millis}");
    }
    text.to_owned()
}

/// Seconds of a time that has passed: `1 days 02:03:04.5` as pandas writes it, `26:03:04.5`, or `03:04.5`,
/// minutes and seconds, as spreadsheet programs show it.
fn passed(text: &str) -> Option<f64> {
    let (days, clock) = match text.split_once(" day") {
        Some((days, clock)) => {
            // The comma of Python is a point by now.
            (days.parse::<i32>().ok()?, clock.trim_start_matches(['s', '.', ' ', '+']))
        }
        None => (0, text),
    };
    let (before, seconds) = clock.rsplit_once(':')?;
    // `12:30` may be hours and minutes.
    let short = || seconds.contains('.').then_some(("0", before));
    let (hours, minutes) = before.split_once(':').or_else(short)?;
    let number = |digits: &str| {
        let is_number = digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        is_number.then(|| digits.parse::<f64>().ok())?
    };
    let (hours, minutes, seconds) = (number(hours)?, number(minutes)?, number(seconds)?);
    let is_time =
        hours.fract() == 0.0 && minutes.fract() == 0.0 && minutes < 60.0 && seconds < 60.0;
    is_time.then(|| f64::from(days) * DAY + hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Seconds of a day.
pub(super) const DAY: f64 = 86_400.0;

/// A date as it stands in a text, `days` after the first of January 1970; none beyond the calendar.
#[cfg(feature = "xlsx")]
pub(super) fn date_of_days(days: f64) -> Option<String> {
    let second = (days * DAY).floor();
    #[expect(clippy::cast_possible_truncation, reason = "nanoseconds of a second, and checked")]
    let (whole, part) = (second as i64, ((days * DAY - second) * 1e9) as i32);
    Timestamp::new(whole, part).ok().map(|date| date.to_string())
}

/// The date of a time in whole seconds since 1970, from 2001 on; none of other times.
pub(in crate::experiment) fn date_of_seconds(seconds: f64) -> Option<String> {
    #[expect(clippy::cast_possible_truncation, reason = "whole seconds in range")]
    let whole = (1e9..5e9).contains(&seconds).then_some(seconds as i64)?;
    Some(Timestamp::from_second(whole).ok()?.to_string())
}

/// Days from the first of January 1970 to a day of the calendar; none where there is no such day.
#[cfg(feature = "xlsx")]
pub(super) fn days_since_1970(year: u16, month: u8, day: u8) -> Option<f64> {
    let (month, day) = (i8::try_from(month).ok()?, i8::try_from(day).ok()?);
    let date = Date::new(i16::try_from(year).ok()?, month, day).ok()?;
    Some((date.duration_since(Date::constant(1970, 1, 1)).as_hours() / 24) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_read_where_their_form_tells_day_from_month() {
        let expected = Some(1_772_359_190.125);
        for text in [
            "2026-03-01T09:59:50.125",
            "01.03.2026 09:59:50.125",
            "1.3.2026 9:59:50,125",
            "3/1/2026 9:59:50.125 AM",
            "03/01/2026 09:59:50.125 am",
        ] {
            assert_eq!(seconds_of_date(text), expected, "{text}");
        }
        assert_eq!(seconds_of_date("3/1/2026 12:30 PM"), Some(1_772_368_200.0));
        assert_eq!(seconds_of_date("09:59:50:125"), Some(35_990.125));
        assert_eq!(seconds_of_date("01.03.2026 09:59:50:125"), expected);
        assert_eq!(seconds_of_date("3/1/2026 9:59:50:125 AM"), expected);
        for text in
            ["3/1/2026 09:59:50.125", "01.13.2026 09:59:50", "01.03.26 09:59:50", "09:59:50:12"]
        {
            assert_eq!(seconds_of_date(text), None, "{text}");
        }
    }

    #[test]
    fn the_date_of_a_time_since_1970_is_known_and_of_another_is_not() {
        assert_eq!(date_of_seconds(1.7e9).as_deref(), Some("2023-11-14T22:13:20Z"));
        assert_eq!(seconds_of_date("2023-11-14T22:13:20Z"), Some(1.7e9));
        assert_eq!(date_of_seconds(86_400.0), None);
    }
}
