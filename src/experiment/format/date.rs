//! Dates, and the seconds that they are.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime, Time};

/// Seconds since 1970 of a date and time of ISO 8601, or of a time of day since midnight.
pub(super) fn seconds_of_date(text: &str) -> Option<f64> {
    let text = text.trim().trim_matches('"').replace(',', ".");
    let seconds =
        |stamp: Timestamp| stamp.as_second() as f64 + f64::from(stamp.subsec_nanosecond()) * 1e-9;
    if let Ok(stamp) = text.parse::<Timestamp>() {
        return Some(seconds(stamp));
    }
    let midnight = Date::constant(1970, 1, 1);
    let civil = match text.parse::<Time>() {
        Ok(time) if !text.contains('-') => midnight.to_datetime(time),
        _ => text.parse::<DateTime>().ok()?,
    };
    civil.to_zoned(jiff::tz::TimeZone::UTC).ok().map(|zoned| seconds(zoned.timestamp()))
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
    fn the_date_of_a_time_since_1970_is_known_and_of_another_is_not() {
        assert_eq!(date_of_seconds(1.7e9).as_deref(), Some("2023-11-14T22:13:20Z"));
        assert_eq!(seconds_of_date("2023-11-14T22:13:20Z"), Some(1.7e9));
        assert_eq!(date_of_seconds(86_400.0), None);
    }
}
