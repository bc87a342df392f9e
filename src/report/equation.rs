//! The equation of an effect with its numbers in it.

use crate::effect::is_unlimited;
use crate::model::Component;
use crate::wording::number;

/// The equation of `component`, each parameter replaced by its value; in words where it takes
/// measured delays.
pub(super) fn filled_in(component: &Component) -> String {
    if component.takes_measured_delays() {
        return "each step has the delay that was measured of it".to_owned();
    }
    let spec = component.effect().spec();
    let value = |word: &str| {
        let named = spec.parameters.iter().zip(component.parameters());
        named.into_iter().find(|(parameter, _)| parameter.name == word).map(|(_, v)| v.value)
    };
    let mut filled = String::new();
    for word in words(spec.equation) {
        match value(word) {
            Some(value) => filled.push_str(&in_place(value, &filled)),
            None => filled.push_str(word),
        }
    }
    filled
}

/// `text` cut into names and what is between them.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let same = |c: &char| is_of_name(*c) == is_of_name(first);
        let length = rest.chars().take_while(same).map(char::len_utf8).sum();
        let (word, behind) = rest.split_at(length);
        rest = behind;
        Some(word)
    })
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A number as it is written behind `before`: in brackets where it would run into a sign or
/// another number.
fn in_place(value: f64, before: &str) -> String {
    if is_unlimited(value) {
        return if value < 0.0 { "-infinity" } else { "infinity" }.to_owned();
    }
    let last = before.trim_end().chars().next_back().unwrap_or('=');
    let is_factor = last == ')' || last.is_ascii_digit();
    let is_signed = value < 0.0 && "+-*/^".contains(last);
    let number = number(value);
    if is_factor || is_signed { format!("({number})") } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{REGISTRY, find};

    fn filled(id: &str, values: &[f64]) -> String {
        let values = values.iter().map(|value| (*value).into()).collect();
        filled_in(&Component::new(find(id).unwrap(), values).unwrap())
    }

    #[test]
    fn parameters_become_numbers() {
        let dead_band = "out = max(in - 0.61, 0) + min(in - (-0.6), 0)";
        assert_eq!(filled("dead_band", &[-0.6, 0.61]), dead_band);
        let drift = "out = in (1 + 0.01 (60) (1 - exp(-t / 60)))";
        assert_eq!(filled("thermal_drift", &[0.01, 60.0]), drift);
        assert_eq!(filled("input_offset", &[-0.2]), "out = in + (-0.2)");
        assert_eq!(filled("end_stop", &[-20.0, 1e12]), "-20 <= y <= infinity");
        assert_eq!(in_place(5e13, "= "), number(5e13));
    }

    #[test]
    fn every_fitted_parameter_of_the_catalogue_is_in_its_equation() {
        for effect in REGISTRY {
            let spec = effect.spec();
            for parameter in spec.parameters.iter().filter(|parameter| parameter.fitted) {
                let is_in = words(spec.equation).any(|word| word == parameter.name);
                assert!(is_in, "{}.{}", spec.id, parameter.name);
            }
        }
    }
}
