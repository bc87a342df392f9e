//! The numbers of a message by name: `position[boom]`, `points[0].velocities[arm]`.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::message::{Fields, Value};
use crate::experiment::error::ReadError;

/// Hands each number of a message to `visit` with its name, until that fails.
pub(super) fn each_number(
    message: &Value<'_>,
    visit: &mut impl FnMut(&str, f64) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let Value::Message(fields) = message else { return Ok(()) };
    let mut outer = vec![fields];
    for (field, value) in fields {
        walk(value, &mut outer, &mut (*field).to_owned(), visit)?;
    }
    Ok(())
}

/// [`each_number`] of a value of this `name` that lies in the messages `outer`.
fn walk<'m>(
    value: &'m Value<'m>,
    outer: &mut Vec<&'m Fields<'m>>,
    name: &mut String,
    visit: &mut impl FnMut(&str, f64) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let length = name.len();
    match value {
        Value::Number(number) => visit(name, *number)?,
        Value::Integer(number) => visit(name, *number as f64)?,
        Value::Text(_) => {}
        Value::List(elements) => {
            let keys = keys(outer, elements).unwrap_or_default();
            for (index, element) in elements.iter().enumerate() {
                // Writing to a string does not fail.
                let _ = match keys.get(index) {
                    Some(key) => write!(name, "[{key}]"),
                    None => write!(name, "[{index}]"),
                };
                walk(element, outer, name, visit)?;
                name.truncate(length);
            }
        }
        Value::Message(fields) => {
            outer.push(fields);
            for (field, value) in fields {
                name.push('.');
                name.push_str(field);
                walk(value, outer, name, visit)?;
                name.truncate(length);
            }
            outer.pop();
        }
    }
    Ok(())
}

/// The names of the elements of an array, as the messages in which it lies give them, the last of which
/// has it; of numbers those further out may, as the joints of a trajectory; or as its elements do.
fn keys<'m>(outer: &[&'m Fields<'m>], elements: &'m [Value<'m>]) -> Option<Vec<&'m str>> {
    let (own, further) = outer.split_last()?;
    let count = elements.len();
    listed_names(own, count).or_else(|| match elements.first()? {
        Value::Message(_) => own_names(elements),
        _ => further.iter().rev().find_map(|fields| listed_names(fields, count)),
    })
}

/// The names that a message lists for the elements of its arrays with `count` of them.
fn listed_names<'m>(fields: &'m Fields<'m>, count: usize) -> Option<Vec<&'m str>> {
    const NAMES: [&str; 5] = ["name", "joint", "joints", "labels", "ids"];
    fields.iter().find_map(|(name, value)| match value {
        Value::List(names)
            if names.len() == count && (NAMES.contains(name) || name.ends_with("names")) =>
        {
            names.iter().map(Value::text).collect()
        }
        _ => None,
    })
}

/// The names that messages bear themselves, where each has one of its own.
fn own_names<'m>(messages: &'m [Value<'m>]) -> Option<Vec<&'m str>> {
    const NAMES: [&str; 5] = ["name", "joint", "label", "id", "child_frame_id"];
    let name = |message: &'m Value<'m>| {
        let Value::Message(fields) = message else { return None };
        let is_name = |field: &str| NAMES.contains(&field) || field.ends_with("_name");
        let mut names = fields.iter().filter(|(field, _)| is_name(field));
        names.find_map(|(_, value)| value.text()).filter(|name| !name.is_empty())
    };
    let names: Vec<&str> = messages.iter().map(name).collect::<Option<_>>()?;
    let different: BTreeSet<&str> = names.iter().copied().collect();
    (different.len() == names.len()).then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(message: &Value<'_>) -> Vec<(String, f64)> {
        let mut found = Vec::new();
        let mut visit = |name: &str, number| {
            found.push((name.to_owned(), number));
            Ok(())
        };
        each_number(message, &mut visit).unwrap();
        found
    }

    fn named(expected: [(&str, f64); 2]) -> Vec<(String, f64)> {
        expected.map(|(name, number)| (name.to_owned(), number)).to_vec()
    }

    #[test]
    fn names_further_out_name_the_joints_of_a_trajectory() {
        let names = Value::List(vec![Value::Text("boom"), Value::Text("arm")]);
        let speeds = Value::List(vec![Value::Number(1.0), Value::Number(2.0)]);
        let points = Value::List(vec![Value::Message(vec![("velocities", speeds)])]);
        let trajectory = Value::Message(vec![("joint_names", names), ("points", points)]);
        let expected = [("points[0].velocities[boom]", 1.0), ("points[0].velocities[arm]", 2.0)];
        assert_eq!(numbers(&trajectory), named(expected));
    }

    #[test]
    fn elements_that_bear_names_of_their_own_are_called_by_them() {
        let axis = |name: &'static str, angle| {
            Value::Message(vec![("name", Value::Text(name)), ("angle", Value::Number(angle))])
        };
        let axes = |axes: Vec<Value<'static>>| Value::Message(vec![("axes", Value::List(axes))]);
        let turned = axes(vec![axis("arm", 2.0), axis("boom", 3.0)]);
        let expected = [("axes[arm].angle", 2.0), ("axes[boom].angle", 3.0)];
        assert_eq!(numbers(&turned), named(expected));
        for name in ["", "boom"] {
            let unnamed = axes(vec![axis(name, 1.0), axis(name, 2.0)]);
            let expected = [("axes[0].angle", 1.0), ("axes[1].angle", 2.0)];
            assert_eq!(numbers(&unnamed), named(expected), "`{name}`");
        }
    }
}
