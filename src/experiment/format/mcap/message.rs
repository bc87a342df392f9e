//! Messages of ROS 2: decoded by their definition, and their numbers by name.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use re_cdr::{BigEndian, LittleEndian};
use re_ros_msg::MessageSchema;
use re_ros_msg::deserialize::Value;
use re_ros_msg::deserialize::primitive_array::PrimitiveArray;
use re_ros_msg::message_spec::MessageSpecification;

use super::decode::{Decoding, Types, key};

type Fields = BTreeMap<String, Value>;

/// Arrays longer than this are images and the like, not joints.
const MOST_ELEMENTS: usize = 64;

/// Letters of a field's name: messages repeat it with each value.
const LONGEST_NAME: usize = 255;

/// Decodes the messages of one type.
#[derive(Debug)]
pub(super) struct Decoder {
    message: MessageSpecification,
    types: Types,
}

impl Decoder {
    /// Reads the definition of the type `name`, with those of the types in it.
    pub(super) fn new(name: &str, definition: &[u8]) -> Result<Self, String> {
        let text = std::str::from_utf8(definition).map_err(|error| error.to_string())?;
        let schema = MessageSchema::parse(name, text).map_err(|error| format!("{error:#}"))?;
        let specs = std::iter::once(&schema.spec).chain(&schema.dependencies);
        if let Some(field) =
            specs.flat_map(|spec| &spec.fields).find(|field| field.name.len() > LONGEST_NAME)
        {
            let start: String = field.name.chars().take(20).collect();
            return Err(format!("the name of the field `{start}…` is too long"));
        }
        let types = schema.dependencies.into_iter().map(|part| (key(&part.name), part)).collect();
        Ok(Self { message: schema.spec, types: Types(types) })
    }

    /// The fields of a message. Its first bytes give the order of the others.
    pub(super) fn decode(&self, data: &[u8]) -> Result<Value, String> {
        let Some(([_, kind, _, _], content)) = data.split_first_chunk::<4>() else {
            return Err("it is too short".to_owned());
        };
        match kind {
            0 => Decoding::<BigEndian>::new(content, &self.types, MOST_ELEMENTS)
                .message(&self.message, 0),
            1 => Decoding::<LittleEndian>::new(content, &self.types, MOST_ELEMENTS)
                .message(&self.message, 0),
            other => Err(format!("its encoding {other} is not plain CDR")),
        }
    }
}

/// A number in the messages of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    /// How it is called: `position[boom]`.
    pub(super) text: String,
    steps: Vec<Step>,
}

/// A step on the way to a number.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Field(String),
    Element(String),
}

impl Field {
    fn new() -> Self {
        Self { text: String::new(), steps: Vec::new() }
    }

    fn field(&self, name: &str) -> Self {
        let mut next = self.clone();
        if !next.text.is_empty() {
            next.text.push('.');
        }
        next.text += name;
        next.steps.push(Step::Field(name.to_owned()));
        next
    }

    fn element(&self, key: &str) -> Self {
        let mut next = self.clone();
        next.text.extend(["[", key, "]"]);
        next.steps.push(Step::Element(key.to_owned()));
        next
    }

    /// The number in a message, where it has one.
    pub(super) fn number(&self, message: &Value) -> Option<f64> {
        find(message, &mut Vec::new(), &self.steps)
    }
}

/// The number at the end of `steps`, in a message that lies in those of `outer`.
fn find<'m>(value: &'m Value, outer: &mut Vec<&'m Fields>, steps: &[Step]) -> Option<f64> {
    let Some((Step::Field(name), rest)) = steps.split_first() else {
        return scalar(value).filter(|_| steps.is_empty());
    };
    let Value::Message(fields) = value else { return None };
    let field = fields.get(name)?;
    outer.push(fields);
    let Some((Step::Element(key), rest)) = rest.split_first() else {
        return find(field, outer, rest);
    };
    let length = length(field)?;
    let index = match keys(outer, field, length) {
        Some(names) => names.iter().position(|name| name == key),
        None => key.parse().ok().filter(|index| *index < length),
    };
    let index = index?;
    match field {
        Value::Array(values) | Value::Sequence(values) => find(values.get(index)?, outer, rest),
        Value::PrimitiveArray(values) | Value::PrimitiveSeq(values) => {
            primitive(values, index).filter(|_| rest.is_empty())
        }
        _ => None,
    }
}

/// All numbers of a message.
pub(super) fn fields(message: &Value) -> Vec<Field> {
    let mut found = Vec::new();
    collect(message, &mut Vec::new(), &Field::new(), &mut found);
    found
}

fn collect<'m>(value: &'m Value, outer: &mut Vec<&'m Fields>, at: &Field, found: &mut Vec<Field>) {
    let Value::Message(fields) = value else {
        found.extend(scalar(value).map(|_| at.clone()));
        return;
    };
    outer.push(fields);
    for (name, field) in fields {
        let at = at.field(name);
        let elements = length(field).map(|length| length.min(MOST_ELEMENTS + 1));
        let Some(length) = elements else {
            collect(field, outer, &at, found);
            continue;
        };
        let names = keys(outer, field, length).map(|names| names.to_vec());
        for index in 0..length.min(if length > MOST_ELEMENTS { 0 } else { length }) {
            let name = names.as_ref().and_then(|names| names.get(index).cloned());
            let at = at.element(&name.unwrap_or_else(|| index.to_string()));
            match field {
                Value::Array(values) | Value::Sequence(values) => {
                    if let Some(value) = values.get(index) {
                        collect(value, outer, &at, found);
                    }
                }
                Value::PrimitiveArray(values) | Value::PrimitiveSeq(values) => {
                    found.extend(primitive(values, index).map(|_| at.clone()));
                }
                _ => {}
            }
        }
    }
    outer.pop();
}

/// Elements of an array.
fn length(value: &Value) -> Option<usize> {
    match value {
        Value::Array(values) | Value::Sequence(values) => Some(values.len()),
        Value::PrimitiveArray(values) | Value::PrimitiveSeq(values) => Some(match values {
            PrimitiveArray::Bool(values) => values.len(),
            PrimitiveArray::I8(values) => values.len(),
            PrimitiveArray::U8(values) => values.len(),
            PrimitiveArray::I16(values) => values.len(),
            PrimitiveArray::U16(values) => values.len(),
            PrimitiveArray::I32(values) => values.len(),
            PrimitiveArray::U32(values) => values.len(),
            PrimitiveArray::I64(values) => values.len(),
            PrimitiveArray::U64(values) => values.len(),
            PrimitiveArray::F32(values) => values.len(),
            PrimitiveArray::F64(values) => values.len(),
            PrimitiveArray::String(values) => values.len(),
        }),
        _ => None,
    }
}

/// The names of the elements of `array`, as the messages in which it lies give them, the last of which
/// has it; of numbers those further out may, as the joints of a trajectory; or as its elements do.
fn keys<'m>(outer: &[&'m Fields], array: &'m Value, length: usize) -> Option<Cow<'m, [String]>> {
    let (own, further) = outer.split_last()?;
    let of_itself = || names(own, length).map(|names| Cow::Borrowed(names.as_slice()));
    match array {
        Value::Array(values) | Value::Sequence(values) => {
            of_itself().or_else(|| own_names(values).map(Cow::Owned))
        }
        _ => of_itself().or_else(|| {
            let names = further.iter().rev().find_map(|fields| names(fields, length));
            names.map(|names| Cow::Borrowed(names.as_slice()))
        }),
    }
}

/// The names in a message of the elements of its arrays with `length` of them.
fn names(fields: &Fields, length: usize) -> Option<&Vec<String>> {
    const NAMES: [&str; 5] = ["name", "joint", "joints", "labels", "ids"];
    fields.iter().find_map(|(name, value)| match value {
        Value::PrimitiveSeq(PrimitiveArray::String(names))
        | Value::PrimitiveArray(PrimitiveArray::String(names))
            if names.len() == length
                && (NAMES.contains(&name.as_str()) || name.ends_with("names")) =>
        {
            Some(names)
        }
        _ => None,
    })
}

/// The names that messages bear themselves, where each has one of its own.
fn own_names(messages: &[Value]) -> Option<Vec<String>> {
    const NAMES: [&str; 5] = ["name", "joint", "label", "id", "child_frame_id"];
    let name = |message: &Value| {
        let Value::Message(fields) = message else { return None };
        fields.iter().find_map(|(field, value)| match value {
            Value::String(name) if NAMES.contains(&field.as_str()) || field.ends_with("_name") => {
                Some(name.clone()).filter(|name| !name.is_empty())
            }
            _ => None,
        })
    };
    let names: Vec<String> = messages.iter().map(name).collect::<Option<_>>()?;
    let different: BTreeSet<&String> = names.iter().collect();
    (different.len() == names.len()).then_some(names)
}

fn scalar(value: &Value) -> Option<f64> {
    Some(match value {
        Value::Bool(value) => f64::from(u8::from(*value)),
        Value::I8(value) => f64::from(*value),
        Value::U8(value) => f64::from(*value),
        Value::I16(value) => f64::from(*value),
        Value::U16(value) => f64::from(*value),
        Value::I32(value) => f64::from(*value),
        Value::U32(value) => f64::from(*value),
        Value::I64(value) => *value as f64,
        Value::U64(value) => *value as f64,
        Value::F32(value) => f64::from(*value),
        Value::F64(value) => *value,
        _ => return None,
    })
}

fn primitive(values: &PrimitiveArray, index: usize) -> Option<f64> {
    match values {
        PrimitiveArray::Bool(values) => values.get(index).map(|value| f64::from(u8::from(*value))),
        PrimitiveArray::I8(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::U8(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::I16(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::U16(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::I32(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::U32(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::I64(values) => values.get(index).map(|value| *value as f64),
        PrimitiveArray::U64(values) => values.get(index).map(|value| *value as f64),
        PrimitiveArray::F32(values) => values.get(index).copied().map(f64::from),
        PrimitiveArray::F64(values) => values.get(index).copied(),
        PrimitiveArray::String(_) => None,
    }
}

/// The time in a message's header, in nanoseconds.
pub(super) fn stamp(message: &Value) -> Option<i64> {
    let field = |value: &Value, name: &str| match value {
        Value::Message(fields) => fields.get(name).cloned(),
        _ => None,
    };
    let stamp = field(&field(message, "header")?, "stamp")?;
    match (field(&stamp, "sec")?, field(&stamp, "nanosec")?) {
        (Value::I32(seconds), Value::U32(rest)) => {
            Some(i64::from(seconds) * 1_000_000_000 + i64::from(rest))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints of which each has a list of values.
    const DEFINITION: &str = "string[] joint_names\nPart[] parts\nfloat64[2] pair\nbool on\n\
        ================================================================================\n\
        MSG: demo/Part\nstring[] names\nfloat32[] values\n";

    fn text(text: &str) -> Vec<u8> {
        let mut bytes = u32::try_from(text.len() + 1).unwrap().to_le_bytes().to_vec();
        bytes.extend(text.as_bytes());
        bytes.push(0);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    fn message() -> Vec<u8> {
        let mut bytes = 2_u32.to_le_bytes().to_vec();
        bytes.extend([text("boom"), text("arm")].concat());
        bytes.extend(2_u32.to_le_bytes());
        for value in [1.5_f32, 2.5] {
            bytes.extend(1_u32.to_le_bytes());
            bytes.extend(text("effort"));
            bytes.extend(1_u32.to_le_bytes());
            bytes.extend(value.to_le_bytes());
        }
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes.extend([7.0_f64, 8.0].iter().flat_map(|value| value.to_le_bytes()));
        bytes.push(1);
        [vec![0, 1, 0, 0], bytes].concat()
    }

    #[test]
    fn every_number_has_a_name_by_which_it_is_found() {
        let decoder = Decoder::new("demo/msg/Twins", DEFINITION.as_bytes()).unwrap();
        let value = decoder.decode(&message()).unwrap();
        let found: Vec<_> = fields(&value)
            .into_iter()
            .map(|field| (field.number(&value).unwrap(), field.text))
            .collect();
        let expected = [
            (1.0, "on"),
            (7.0, "pair[boom]"),
            (8.0, "pair[arm]"),
            (1.5, "parts[boom].values[effort]"),
            (2.5, "parts[arm].values[effort]"),
        ];
        assert_eq!(found, expected.map(|(value, text)| (value, text.to_owned())));
    }

    #[test]
    fn names_further_out_and_within_elements_name_them() {
        let text = |text: &str| Value::String(text.to_owned());
        let message = |fields: &[(&str, Value)]| {
            let fields = fields.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
            Value::Message(fields.collect())
        };
        let numbers = |numbers: &[f64]| Value::PrimitiveSeq(PrimitiveArray::F64(numbers.to_vec()));
        let joints = ["boom", "arm"].map(str::to_owned).to_vec();
        let trajectory = |joints: &[String]| {
            message(&[
                ("joint_names", Value::PrimitiveSeq(PrimitiveArray::String(joints.to_vec()))),
                ("points", Value::Sequence(vec![message(&[("velocities", numbers(&[1.0, 2.0]))])])),
            ])
        };
        let found = fields(&trajectory(&joints));
        let texts: Vec<&str> = found.iter().map(|field| field.text.as_str()).collect();
        assert_eq!(texts, ["points[0].velocities[boom]", "points[0].velocities[arm]"]);
        let turned: Vec<String> = joints.iter().rev().cloned().collect();
        assert_eq!(found[0].number(&trajectory(&joints)), Some(1.0));
        assert_eq!(found[0].number(&trajectory(&turned)), Some(2.0));
        let axis =
            |name: &str, angle| message(&[("name", text(name)), ("angle", Value::F64(angle))]);
        let axes = |axes: Vec<Value>| message(&[("axes", Value::Sequence(axes))]);
        let found = fields(&axes(vec![axis("boom", 1.0), axis("arm", 2.0)]));
        assert_eq!(found[0].text, "axes[boom].angle");
        assert_eq!(found[0].number(&axes(vec![axis("arm", 2.0), axis("boom", 3.0)])), Some(3.0));
        let unnamed = fields(&axes(vec![axis("", 1.0), axis("", 2.0)]));
        assert_eq!(unnamed[1].text, "axes[1].angle");
    }

    #[test]
    fn a_message_that_is_cut_says_so() {
        let decoder = Decoder::new("demo/msg/Twins", DEFINITION.as_bytes()).unwrap();
        let whole = message();
        for length in 0..whole.len() {
            assert!(decoder.decode(&whole[..length]).is_err(), "{length}");
        }
        assert!(Decoder::new("demo/msg/Twins", b"float64").is_err());
    }
}
