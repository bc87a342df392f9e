//! Units in the names of columns: `boom.output [deg]`, `angle (rad)`, `u_duty_pct`, `t_ms`.

/// How units are written in names, and how they are shown.
const UNITS: &str = "deg=deg degrees=deg °=° rad=rad mrad=mrad pct=% percent=% %=% \
    mm=mm cm=cm m=m um=µm inch=in V=V volt=V mV=mV A=A mA=mA \
    bar=bar mbar=mbar Pa=Pa kPa=kPa MPa=MPa psi=psi N=N kN=kN Nm=N·m kg=kg \
    rpm=rpm Hz=Hz W=W kW=kW degC=°C °C=°C K=K ms=ms us=µs ns=ns \
    deg_s=deg/s deg/s=deg/s rad_s=rad/s rad/s=rad/s \
    m_s=m/s m/s=m/s mm_s=mm/s mm/s=mm/s cm_s=cm/s \
    lpm=l/min l_min=l/min l/min=l/min L/min=l/min cnt=counts cnts=counts counts=counts ticks=ticks";

/// Units of time: names of which each is a unit by itself or ends the name of a column, further words
/// for it in lower case, and its seconds.
const TIMES: [(&str, &str, f64); 7] = [
    ("s sec secs second seconds", "sekunde sekunden seconde secondes", 1.0),
    (
        "ms msec millis milliseconds",
        "msecs millisecond millisekunde millisekunden milliseconde millisecondes milisegundos millisecondi",
        1e-3,
    ),
    (
        "us µs μs usec micros microseconds",
        "usecs microsec microsecond mikrosekunden microsecondes",
        1e-6,
    ),
    ("ns nsec nanos nanoseconds", "nsecs nanosec nanosecond nanosekunden nanosecondes", 1e-9),
    ("min minutes", "mins minute minuten minutos minuti", 60.0),
    ("h hours", "hr hrs hour stunde stunden heure heures", 3600.0),
    ("", "d day days tag tage jour jours", 86_400.0),
];

fn is_in(words: &str, word: &str) -> bool {
    words.split_whitespace().any(|known| known == word)
}

/// The units as they are written and as they are shown.
fn units() -> impl Iterator<Item = (&'static str, &'static str)> {
    UNITS.split_whitespace().filter_map(|unit| unit.split_once('='))
}

/// The seconds of the one unit of time that `text` names, as `Time in ms`, `Millisekunden` or `10 ms`;
/// none where it names none or several.
pub(super) fn time_in(text: &str) -> Option<f64> {
    let lower = text.to_lowercase();
    // `seconds since 1970-01-01 00:00:00`
    let lower = lower.split(" since ").next()?.trim();
    if lower.contains(|letter: char| letter.is_ascii_digit() || letter == '/') {
        return with_factor(lower);
    }
    let words = lower.split(|letter: char| !letter.is_alphabetic());
    let mut found = words.filter_map(|word| {
        let mut times = TIMES.iter();
        let time = times.find(|(names, words, _)| is_in(names, word) || is_in(words, word));
        time.map(|(_, _, seconds)| *seconds)
    });
    let first = found.next()?;
    #[expect(clippy::float_cmp, reason = "each stands in the list above")]
    found.all(|other| other == first).then_some(first)
}

/// The seconds of the one unit of time among the words of a header that is one of times: `Time (mins)`,
/// `t/min`, `timeMin`. Days are none: a tag may be a label.
pub(super) fn time_within(header: &str) -> Option<f64> {
    let mut words = String::new();
    for letter in header.chars() {
        if words.ends_with(char::is_lowercase) && letter.is_uppercase() {
            words.push(' ');
        }
        words.push(if letter.is_alphabetic() { letter } else { ' ' });
    }
    // As a unit, `seconds since 1970` ends with its first word.
    let words = words.to_lowercase().replace("since", " ");
    time_in(&words).filter(|seconds| *seconds <= 3600.0)
}

/// The seconds of a unit of time with a factor before it: `10ms`, `0.01 s`, `x10 ms`.
fn with_factor(text: &str) -> Option<f64> {
    let is_between = |letter: char| letter.is_whitespace() || "x*·×".contains(letter);
    let text = text.trim_start_matches(is_between);
    let end = text.find(|letter: char| !letter.is_ascii_digit() && !".,".contains(letter))?;
    let (factor, unit) = text.split_at_checked(end)?;
    let factor: f64 = factor.replace(',', ".").parse().ok()?;
    let unit = unit.trim_start_matches(is_between);
    let is_word = unit.chars().all(char::is_alphabetic);
    Some(factor)
        .filter(|factor| *factor > 0.0 && is_word)
        .zip(time_in(unit))
        .map(|(factor, unit)| factor * unit)
}

/// Whether `unit` is one of time.
pub(super) fn is_time(unit: &str) -> bool {
    time_in(unit).is_some()
}

/// Whether `text` is a unit by itself.
pub(super) fn is_unit(text: &str) -> bool {
    shown(text).is_some() || seconds_of(text).is_some()
}

/// How a unit is shown.
pub(super) fn shown(text: &str) -> Option<&'static str> {
    units().find(|(written, _)| *written == text).map(|(_, shown)| shown)
}

/// The seconds of a unit of time.
pub(super) fn seconds_of(unit: &str) -> Option<f64> {
    TIMES.iter().find(|(names, ..)| is_in(names, unit)).map(|(_, _, seconds)| *seconds)
}

/// Name and unit of a header: a unit in square brackets is any text, one in round brackets or after a
/// slash must be known.
pub(super) fn parted(text: &str) -> (&str, Option<String>) {
    let split = |open: char, close: char| {
        let (name, unit) = text.strip_suffix(close)?.rsplit_once(open)?;
        Some((name.trim(), unit.trim()))
    };
    // `x[0]` is an element, and `x [1]` has no dimension.
    let is_index = text.split_once('[').is_some_and(|(name, index)| {
        !name.ends_with(' ') && index.trim_end_matches(']').bytes().all(|b| b.is_ascii_digit())
    });
    if let Some((name, unit)) = split('[', ']').filter(|_| !is_index) {
        return (name, Some(unit.to_owned()));
    }
    let is_known = |unit: &str| is_unit(unit) || seconds_of(&unit.to_lowercase()).is_some();
    // As standards have it: `angle / deg`.
    let over = || text.rsplit_once(" / ").map(|(name, unit)| (name.trim(), unit.trim()));
    let known = split('(', ')').or_else(over);
    let known = known.filter(|(name, unit)| is_known(unit) && !name.is_empty());
    known.map_or((text, None), |(name, unit)| (name, Some(shown(unit).unwrap_or(unit).to_owned())))
}

/// The unit at the end of a name: `°` of none, `deg` of `angle_deg`, `deg/s` of `v_deg_per_s`.
pub(super) fn of_signal(name: &str) -> Option<String> {
    ended(name).map(|(_, unit)| unit.to_owned())
}

/// A name without the unit that it ends in, of a signal or of a time.
pub(super) fn without(name: &str) -> Option<&str> {
    let time = || of_time(name).and_then(|unit| name.strip_suffix(unit)?.strip_suffix('_'));
    ended(name).map(|(rest, _)| rest).or_else(time).filter(|rest| !rest.is_empty())
}

/// Name and unit of the input or the output of a joint: `boom.input_pct`.
pub(super) fn of_native(name: &str) -> Option<(&str, String)> {
    let (rest, unit) = ended(name)?;
    let (_, signal) = rest.rsplit_once('.')?;
    ["input", "output"].contains(&signal).then(|| (rest, unit.to_owned()))
}

/// A name in two: before the unit at its end, and the unit.
fn ended(name: &str) -> Option<(&str, &'static str)> {
    let mut found: Option<(&str, &'static str)> = None;
    for (written, unit) in units() {
        let per = written.strip_suffix("_s").map(|unit| format!("{unit}_per_s"));
        for text in std::iter::once(written).chain(per.as_deref()) {
            let rest = name.strip_suffix(text).and_then(|rest| rest.strip_suffix('_'));
            // Of `v_deg_s` the unit is no `s`, and of `v_m_s` no `m_s` less.
            let is_longer = |rest: &&str| found.is_none_or(|(other, _)| rest.len() < other.len());
            let rest = rest.filter(|rest| !rest.is_empty()).filter(is_longer);
            found = rest.map(|rest| (rest, unit)).or(found);
        }
    }
    found
}

/// The unit of time at the end of a name: `ms` of `t_ms` and `time_ms`.
pub(super) fn of_time(name: &str) -> Option<&str> {
    let (_, last) = name.rsplit_once('_')?;
    seconds_of(last).map(|_| last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_in_brackets() {
        let unit = |text: &str| parted(text).1;
        assert_eq!(parted("boom.output [deg/s]"), ("boom.output", Some("deg/s".to_owned())));
        assert_eq!(parted("angle (rad)"), ("angle", Some("rad".to_owned())));
        assert_eq!(unit("Time (s)").as_deref(), Some("s"));
        assert_eq!((unit("y(2)"), unit("angle (left)"), unit("boom.output")), (None, None, None));
    }

    #[test]
    fn a_unit_of_time_may_have_a_factor() {
        let close = |text: &str, seconds: f64| {
            time_in(text).is_some_and(|found| (found / seconds - 1.0).abs() < 1e-12)
        };
        for (text, seconds) in [
            ("ms", 1e-3),
            ("Time in ms", 1e-3),
            ("seconds since 1970-01-01 00:00:00", 1.0),
            ("10ms", 0.01),
            ("x10 ms", 0.01),
            ("10*ms", 0.01),
            ("0.01 s", 0.01),
            ("0,01 s", 0.01),
            ("100us", 1e-4),
        ] {
            assert!(close(text, seconds), "{text}: {:?}", time_in(text));
        }
        for text in ["1/100 s", "s/100", "ticks", "10", "0 s", "ms or s", "10 ms or 5"] {
            assert_eq!(time_in(text), None, "{text}");
        }
    }

    #[test]
    fn a_unit_of_time_may_be_a_word_of_a_header() {
        let minutes = [
            "Time (mins)",
            "t/min",
            "Zeit/min",
            "Time in minutes",
            "Zeit in Minuten",
            "Time min",
            "Minutes",
            "min",
            "timeMin",
            "time:min",
            "time - min",
            "TIME(MINUTE)",
            "Time {min}",
        ];
        for header in minutes {
            assert_eq!(time_within(header), Some(60.0), "{header}");
        }
        assert_eq!(time_within("Time since start, ms"), Some(1e-3));
        assert_eq!(time_within("elapsed hours"), Some(3600.0));
        for header in ["time", "Timestamp", "time tag", "T", "x_value", "Zeit", "min/ms"] {
            assert_eq!(time_within(header), None, "{header}");
        }
    }

    #[test]
    fn units_end_names() {
        let of = |name: &str| of_signal(name);
        assert_eq!(of("u_duty_pct").as_deref(), Some("%"));
        assert_eq!(of("v_deg_per_s").as_deref(), Some("deg/s"));
        assert_eq!(of("valve_V").as_deref(), Some("V"));
        assert_eq!(
            (without("v_deg_per_s"), without("t_ms"), without("deg")),
            (Some("v"), Some("t"), None)
        );
        assert_eq!(of_native("j.input_pct"), Some(("j.input", "%".to_owned())));
        assert_eq!((of_native("j.pressure_bar"), of_native("j.input")), (None, None));
        assert_eq!(
            (of("boom_v"), of("deg"), of("y_boom"), of("jaw_torque_raw")),
            (None, None, None, None)
        );
        assert_eq!(of("angle_cnt").as_deref(), Some("counts"));
        assert_eq!((of_time("time_ms"), of_time("t"), of_time("t_boom")), (Some("ms"), None, None));
    }
}
