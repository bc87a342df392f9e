//! The values of a message, by its definition.
//!
//! Written here and not taken from the crate `re_ros_msg` 0.36, which follows definitions that
//! contain themselves until the stack ends, and reserves memory for as many elements as a
//! message claims to have.

use std::collections::{BTreeMap, HashMap};

use re_cdr::{CdrEndian, CdrReader};
use re_ros_msg::deserialize::Value;
use re_ros_msg::deserialize::primitive_array::PrimitiveArray;
use re_ros_msg::message_spec::{
    ArraySize, BuiltInType, ComplexType, MessageSpecification, Type, message_package,
};

/// Types may lie in types, but not without end.
const DEEPEST: usize = 32;

/// Values apart from one another that are kept of a message: far more than a machine has joints.
const MOST_VALUES: usize = 1 << 18;

/// The types that a message is made of, by `package/Name`.
#[derive(Debug)]
pub(super) struct Types(pub(super) HashMap<String, MessageSpecification>);

impl Types {
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
        self.0.get(&key(&format!("{package}/{name}")))
    }
}

/// `std_msgs/msg/Header` is `std_msgs/Header` too.
pub(super) fn key(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// A message that is being read.
pub(super) struct Decoding<'a, E> {
    reader: CdrReader<'a, E>,
    types: &'a Types,
    /// Elements of an array that are kept; of a longer one, one more.
    most_elements: usize,
    /// Values that may still be looked at: as many as the bytes can be, and some that have none.
    steps: usize,
    kept: usize,
}

impl<'a, E: CdrEndian> Decoding<'a, E> {
    pub(super) fn new(data: &'a [u8], types: &'a Types, most_elements: usize) -> Self {
        let steps = data.len().saturating_mul(4).saturating_add(1 << 16);
        Self { reader: CdrReader::new(data), types, most_elements, steps, kept: 0 }
    }

    /// The fields of a message, which lies in so many others.
    pub(super) fn message(
        &mut self,
        spec: &MessageSpecification,
        depth: usize,
    ) -> Result<Value, String> {
        if depth > DEEPEST {
            return Err(format!("`{}` lies too deep in itself or in other types", spec.name));
        }
        let mut fields = BTreeMap::new();
        for field in &spec.fields {
            let value = match &field.ty {
                Type::Array { ty, size } => self.array(spec, ty, size, depth)?,
                ty => self.value(spec, ty, depth)?,
            };
            fields.insert(field.name.clone(), value);
        }
        Ok(Value::Message(fields))
    }

    fn value(
        &mut self,
        scope: &MessageSpecification,
        ty: &Type,
        depth: usize,
    ) -> Result<Value, String> {
        let left = self.steps.checked_sub(1);
        self.steps = left.ok_or("it has more values than bytes")?;
        self.kept += 1;
        if self.kept > MOST_VALUES {
            return Err(format!("it has more than {MOST_VALUES} values"));
        }
        match ty {
            Type::BuiltIn(kind) => self.scalar(kind),
            Type::Complex(wanted) => {
                let unknown = || format!("its type {wanted:?} is not defined");
                let spec = self.types.resolve(scope, wanted).ok_or_else(unknown)?;
                // An enumeration has constants alone, and is sent as one of them.
                match spec.underlying_type_if_enum_like().map_err(|error| error.to_string())? {
                    Some(kind) => self.scalar(kind),
                    None => self.message(spec, depth + 1),
                }
            }
            Type::Array { .. } => Err("it has an array of arrays".to_owned()),
        }
    }

    fn array(
        &mut self,
        scope: &MessageSpecification,
        ty: &Type,
        size: &ArraySize,
        depth: usize,
    ) -> Result<Value, String> {
        let (count, is_fixed) = match size {
            ArraySize::Fixed(count) => (*count, true),
            ArraySize::Bounded(_) | ArraySize::Unbounded => {
                (self.reader.read_sequence_length().map_err(|error| error.to_string())?, false)
            }
        };
        if let Type::BuiltIn(kind) = ty {
            let values = self.primitives(kind, count)?;
            let array = if is_fixed { Value::PrimitiveArray } else { Value::PrimitiveSeq };
            return Ok(array(values));
        }
        let values = self.elements(scope, ty, count, depth)?;
        Ok(if is_fixed { Value::Array(values) } else { Value::Sequence(values) })
    }

    /// The elements of an array of messages, as many as are of use.
    fn elements(
        &mut self,
        scope: &MessageSpecification,
        ty: &Type,
        count: usize,
        depth: usize,
    ) -> Result<Vec<Value>, String> {
        let mut values = Vec::new();
        for _ in 0..count {
            let (place, kept) = (self.reader.position(), self.kept);
            let value = self.value(scope, ty, depth)?;
            if values.len() <= self.most_elements {
                values.push(value);
            } else {
                self.kept = kept;
                // Elements without a byte are all alike, and may be any number.
                if self.reader.position() == place {
                    break;
                }
            }
        }
        Ok(values)
    }

    fn scalar(&mut self, kind: &BuiltInType) -> Result<Value, String> {
        let reader = &mut self.reader;
        let value = match kind {
            BuiltInType::Bool => reader.read_bool().map(Value::Bool),
            BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8 => {
                reader.read_u8().map(Value::U8)
            }
            BuiltInType::Int8 => reader.read_i8().map(Value::I8),
            BuiltInType::Int16 => reader.read_i16().map(Value::I16),
            BuiltInType::UInt16 => reader.read_u16().map(Value::U16),
            BuiltInType::Int32 => reader.read_i32().map(Value::I32),
            BuiltInType::UInt32 => reader.read_u32().map(Value::U32),
            BuiltInType::Int64 => reader.read_i64().map(Value::I64),
            BuiltInType::UInt64 => reader.read_u64().map(Value::U64),
            BuiltInType::Float32 => reader.read_f32().map(Value::F32),
            BuiltInType::Float64 => reader.read_f64().map(Value::F64),
            BuiltInType::String(_) => reader.read_string().map(Value::String),
            BuiltInType::WString(_) => return Err(WIDE.to_owned()),
        };
        value.map_err(|error| error.to_string())
    }

    fn primitives(&mut self, kind: &BuiltInType, count: usize) -> Result<PrimitiveArray, String> {
        let reader = &mut self.reader;
        // Each takes a byte at least.
        if count > reader.remaining() {
            return Err(format!("it has an array of {count} elements and ends before"));
        }
        let array = match kind {
            BuiltInType::Bool => {
                let values = (0..count).map(|_| reader.read_bool());
                values.collect::<Result<_, _>>().map(PrimitiveArray::Bool)
            }
            BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8 => {
                reader.read_numeric_vec(count).map(PrimitiveArray::U8)
            }
            BuiltInType::Int8 => reader.read_numeric_vec(count).map(PrimitiveArray::I8),
            BuiltInType::Int16 => reader.read_numeric_vec(count).map(PrimitiveArray::I16),
            BuiltInType::UInt16 => reader.read_numeric_vec(count).map(PrimitiveArray::U16),
            BuiltInType::Int32 => reader.read_numeric_vec(count).map(PrimitiveArray::I32),
            BuiltInType::UInt32 => reader.read_numeric_vec(count).map(PrimitiveArray::U32),
            BuiltInType::Int64 => reader.read_numeric_vec(count).map(PrimitiveArray::I64),
            BuiltInType::UInt64 => reader.read_numeric_vec(count).map(PrimitiveArray::U64),
            BuiltInType::Float32 => reader.read_numeric_vec(count).map(PrimitiveArray::F32),
            BuiltInType::Float64 => reader.read_numeric_vec(count).map(PrimitiveArray::F64),
            BuiltInType::String(_) => {
                let values = (0..count).map(|_| reader.read_string());
                values.collect::<Result<_, _>>().map(PrimitiveArray::String)
            }
            BuiltInType::WString(_) => return Err(WIDE.to_owned()),
        };
        array.map_err(|error| error.to_string())
    }
}

/// Why a text of wide letters is not read: they lie differently.
const WIDE: &str = "it has a text of wide letters (wstring)";
