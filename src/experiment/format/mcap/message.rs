//! Messages of ROS 2, decoded by the definition that the recording holds.
//!
//! Not by the decoder of the crate `re_ros_msg` 0.36, which follows definitions that contain
//! themselves until the stack ends, and reserves memory for as many elements as a message claims to have.

use std::collections::HashMap;

use re_cdr::{BigEndian, CdrEndian, CdrReader, Error, LittleEndian};
use re_ros_msg::MessageSchema;
use re_ros_msg::message_spec::{
    ArraySize, BuiltInType, ComplexType, MessageSpecification, Type, message_package,
};

/// Arrays longer than this are images and the like, not joints.
const MOST_ELEMENTS: usize = 64;

/// Types may lie in types, but not without end.
const DEEPEST: usize = 32;

/// Fields of a message and of those in it, at most: far more than a machine has joints, and no more than
/// memory allows.
const MOST_FIELDS: usize = 1 << 22;

/// Fields without a byte that a message may have: each message of a file is decoded.
const MOST_EMPTY: usize = 1 << 12;

/// A value in a message.
#[derive(Debug, PartialEq)]
pub(super) enum Value<'a> {
    Number(f64),
    Integer(i64),
    Text(&'a str),
    /// The elements of an array; none of one that is too long for joints.
    List(Vec<Self>),
    Message(Fields<'a>),
}

/// The fields of a message by their names, in the order of its definition.
pub(super) type Fields<'a> = Vec<(&'a str, Value<'a>)>;

impl<'a> Value<'a> {
    /// The field of this name, where this is a message that has it.
    pub(super) fn field(&self, name: &str) -> Option<&Self> {
        let Self::Message(fields) = self else { return None };
        fields.iter().find_map(|(field, value)| (*field == name).then_some(value))
    }

    /// The time in a message's header, in nanoseconds.
    pub(super) fn stamp(&self) -> Option<i64> {
        let stamp = self.field("header")?.field("stamp")?;
        match (stamp.field("sec")?, stamp.field("nanosec")?) {
            (Self::Integer(seconds), Self::Integer(rest)) => {
                seconds.checked_mul(1_000_000_000)?.checked_add(*rest)
            }
            _ => None,
        }
    }

    /// The text of one.
    pub(super) fn text(&self) -> Option<&'a str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }
}

/// Decodes the messages of one type.
#[derive(Debug)]
pub(super) struct Decoder {
    message: MessageSpecification,
    /// The types that a message is made of, by `package/Name`.
    types: HashMap<String, MessageSpecification>,
}

impl Decoder {
    /// Reads the definition of the type `name`, with those of the types in it.
    pub(super) fn new(name: &str, definition: &[u8]) -> Result<Self, String> {
        let text = std::str::from_utf8(definition).map_err(|error| error.to_string())?;
        let schema = MessageSchema::parse(name, text).map_err(|error| format!("{error:#}"))?;
        let types = schema.dependencies.into_iter().map(|part| (key(&part.name), part)).collect();
        Ok(Self { message: schema.spec, types })
    }

    /// The fields of a message. Its first bytes give the order of the others.
    pub(super) fn decode<'a>(&'a self, data: &'a [u8]) -> Result<Value<'a>, Error> {
        let Some(([_, kind, _, _], content)) = data.split_first_chunk::<4>() else {
            return Err(Error::UnexpectedEof);
        };
        match kind {
            0 => Decoding::<BigEndian>::new(content, self).message(&self.message, 0),
            1 => Decoding::<LittleEndian>::new(content, self).message(&self.message, 0),
            other => Err(refused(format!("its encoding {other} is not plain CDR"))),
        }
    }

    fn resolve(
        &self,
        scope: &MessageSpecification,
        wanted: &ComplexType,
    ) -> Option<&MessageSpecification> {
        let (package, name) = match wanted {
            ComplexType::Absolute { package, name } => (package.as_str(), name),
            ComplexType::Relative { name } => {
                (message_package(&scope.name).unwrap_or_default(), name)
            }
        };
        self.types.get(&key(&format!("{package}/{name}")))
    }
}

/// `std_msgs/msg/Header` is `std_msgs/Header` too.
fn key(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

fn refused(reason: String) -> Error {
    Error::Custom(reason)
}

/// A message that is being read.
struct Decoding<'a, E> {
    reader: CdrReader<'a, E>,
    decoder: &'a Decoder,
    /// Fields that may still be looked at: as many as there are bytes, and some that have none.
    fields: usize,
}

impl<'a, E: CdrEndian> Decoding<'a, E> {
    fn new(data: &'a [u8], decoder: &'a Decoder) -> Self {
        let fields = data.len().saturating_add(MOST_EMPTY).min(MOST_FIELDS);
        Self { reader: CdrReader::new(data), decoder, fields }
    }

    /// The fields of a message, which lies in so many others.
    fn message(
        &mut self,
        spec: &'a MessageSpecification,
        depth: usize,
    ) -> Result<Value<'a>, Error> {
        if depth > DEEPEST {
            return Err(refused(format!(
                "`{}` is nested too deeply in itself or in other types",
                spec.name
            )));
        }
        let left = self.fields.checked_sub(1 + spec.fields.len());
        self.fields = left.ok_or_else(|| refused("it has too many fields".to_owned()))?;
        let mut fields = Fields::with_capacity(spec.fields.len());
        for field in &spec.fields {
            let value = match &field.ty {
                Type::Array { ty, size } => self.array(spec, ty, size, depth)?,
                ty => self.value(spec, ty, depth)?,
            };
            fields.push((field.name.as_str(), value));
        }
        Ok(Value::Message(fields))
    }

    fn value(
        &mut self,
        scope: &'a MessageSpecification,
        ty: &'a Type,
        depth: usize,
    ) -> Result<Value<'a>, Error> {
        let wanted = match ty {
            // It takes a byte at least.
            Type::BuiltIn(kind) => return self.scalar(kind),
            Type::Complex(wanted) => wanted,
            Type::Array { .. } => return Err(refused("it has an array of arrays".to_owned())),
        };
        let spec = self.decoder.resolve(scope, wanted);
        let spec = spec.ok_or_else(|| refused(format!("its type {wanted:?} is not defined")))?;
        // An enumeration has constants alone, and is sent as one of them.
        let kind = spec.underlying_type_if_enum_like();
        match kind.map_err(|error| refused(error.to_string()))? {
            Some(kind) => self.scalar(kind),
            None => self.message(spec, depth + 1),
        }
    }

    /// The elements of an array, where these are few enough to be joints.
    fn array(
        &mut self,
        scope: &'a MessageSpecification,
        ty: &'a Type,
        size: &ArraySize,
        depth: usize,
    ) -> Result<Value<'a>, Error> {
        let count = match size {
            ArraySize::Fixed(count) => *count,
            ArraySize::Bounded(_) | ArraySize::Unbounded => self.reader.read_sequence_length()?,
        };
        if count > MOST_ELEMENTS && is_of_bytes(ty) {
            self.reader.read_bytes(count)?;
            return Ok(Value::List(Vec::new()));
        }
        let mut elements = Vec::new();
        for _ in 0..count {
            let place = self.reader.position();
            let element = self.value(scope, ty, depth)?;
            if count <= MOST_ELEMENTS {
                elements.push(element);
            } else if self.reader.position() == place {
                // Elements without a byte are all alike, and may be any number.
                break;
            }
        }
        Ok(Value::List(elements))
    }

    fn scalar(&mut self, kind: &BuiltInType) -> Result<Value<'a>, Error> {
        let reader = &mut self.reader;
        Ok(match kind {
            BuiltInType::Bool => Value::Integer(reader.read_bool()?.into()),
            BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8 => {
                Value::Integer(reader.read_u8()?.into())
            }
            BuiltInType::Int8 => Value::Integer(reader.read_i8()?.into()),
            BuiltInType::Int16 => Value::Integer(reader.read_i16()?.into()),
            BuiltInType::UInt16 => Value::Integer(reader.read_u16()?.into()),
            BuiltInType::Int32 => Value::Integer(reader.read_i32()?.into()),
            BuiltInType::UInt32 => Value::Integer(reader.read_u32()?.into()),
            BuiltInType::Int64 => Value::Integer(reader.read_i64()?),
            BuiltInType::UInt64 => Value::Number(reader.read_u64()? as f64),
            BuiltInType::Float32 => Value::Number(reader.read_f32()?.into()),
            BuiltInType::Float64 => Value::Number(reader.read_f64()?),
            BuiltInType::String(_) => Value::Text(reader.read_str()?),
            // They lie differently.
            BuiltInType::WString(_) => {
                return Err(refused("it has a text of wide letters (wstring)".to_owned()));
            }
        })
    }
}

/// Whether the elements of an array of this type are bytes, as those of images are.
fn is_of_bytes(ty: &Type) -> bool {
    use BuiltInType::{Byte, Char, Int8, UInt8};
    matches!(ty, Type::BuiltIn(Byte | Char | Int8 | UInt8))
}

#[cfg(test)]
mod tests {
    use super::super::fields::each_number;
    use super::*;

    /// Two joints of which each has a list of values, after an image.
    const DEFINITION: &str = "string[] joint_names\nuint16[] image\nPart[] parts\nfloat64[2] pair\nbool on\n\
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
        bytes.extend(100_u32.to_le_bytes());
        bytes.extend([9; 200]);
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
    fn every_number_has_a_name_and_images_have_none() {
        let decoder = Decoder::new("demo/msg/Twins", DEFINITION.as_bytes()).unwrap();
        let bytes = message();
        let mut found = Vec::new();
        let mut visit = |name: &str, value| {
            found.push((value, name.to_owned()));
            Ok(())
        };
        each_number(&decoder.decode(&bytes).unwrap(), &mut visit).unwrap();
        let expected = [
            (1.5, "parts[boom].values[effort]"),
            (2.5, "parts[arm].values[effort]"),
            (7.0, "pair[boom]"),
            (8.0, "pair[arm]"),
            (1.0, "on"),
        ];
        assert_eq!(found, expected.map(|(value, text)| (value, text.to_owned())));
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

    #[test]
    fn a_message_without_bytes_has_no_more_fields_than_memory_allows() {
        const LINE: &str = "\n====\n";
        let fields = (0..100).map(|k| format!("uint8[0] x{k}\n")).collect::<Vec<_>>().concat();
        let parts = |count: usize| {
            let text =
                format!("A[{count}] a{LINE}MSG: demo/A\nB[{count}] b{LINE}MSG: demo/B\n{fields}");
            Decoder::new("demo/msg/Many", text.as_bytes()).unwrap()
        };
        assert!(parts(2).decode(&[0, 1, 0, 0]).is_ok());
        let refused = parts(64).decode(&[0, 1, 0, 0]).unwrap_err();
        assert!(refused.to_string().contains("too many fields"), "{refused}");
    }

    #[test]
    fn the_stamp_of_a_message_is_in_nanoseconds() {
        let stamp =
            vec![("sec", Value::Integer(1_700_000_000)), ("nanosec", Value::Integer(123_456_789))];
        let header = Value::Message(vec![("stamp", Value::Message(stamp))]);
        let message = Value::Message(vec![("header", header)]);
        assert_eq!(message.stamp(), Some(1_700_000_000_123_456_789));
        assert_eq!(Value::Message(Vec::new()).stamp(), None);
    }
}
