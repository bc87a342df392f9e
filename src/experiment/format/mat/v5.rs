//! MATLAB 5 to 7 (`save -v6`, `save -v7`), after the description "MAT-File Format" of its maker.
//!
//! Written here because no crate fits: those that know structures panic on damaged files.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::variable::{Content, Numbers, Variable, damaged};
use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, TooLarge};

/// Structures may lie in structures, but not without end.
const DEEPEST: usize = 32;

// The types of data elements and the classes of arrays, as the description numbers them.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const CELL: u32 = 1;
const STRUCTURE: u32 = 2;
const CHARACTERS: u32 = 4;

/// The flag of an array whose numbers have an imaginary part.
const COMPLEX: u32 = 0x800;

/// Letters of a name at most; MATLAB allows 63. Names are repeated with each part of a structure.
const LONGEST_NAME: usize = 255;

/// Memory of a number: itself, and its copy as a column.
const NUMBER_SIZE: usize = 2 * size_of::<f64>();

/// Memory of an array within another: itself twice, as a list that grows is copied to one of twice its
/// size, and its name and its lengths with what the allocator adds to each.
const ARRAY_SIZE: usize = 2 * size_of::<Array>() + 2 * 48;

/// The variables of a file, their numbers read.
pub(super) fn variables(path: &Path, budget: &Budget) -> Result<Vec<Variable>, ReadError> {
    let file =
        File::open(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    read(BufReader::new(file), budget).map_err(|fault| fault.refuse(path))
}

/// Why a file is refused.
#[derive(Debug)]
enum Fault {
    /// What is wrong with it.
    Damaged(String),
    TooLarge(TooLarge),
}

impl Fault {
    fn refuse(self, path: &Path) -> ReadError {
        match self {
            Self::Damaged(reason) => damaged(path, &reason),
            Self::TooLarge(error) => error.refuse(path),
        }
    }

    /// Says in what part of the file it is.
    fn within(self, place: &str) -> Self {
        match self {
            Self::Damaged(reason) => Self::Damaged(format!("{place}: {reason}")),
            Self::TooLarge(_) => self,
        }
    }
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl From<TooLarge> for Fault {
    fn from(error: TooLarge) -> Self {
        Self::TooLarge(error)
    }
}

fn fault<T>(text: &str) -> Result<T, Fault> {
    Err(Fault::Damaged(text.to_owned()))
}

fn read(mut file: impl Read, budget: &Budget) -> Result<Vec<Variable>, Fault> {
    let mut head = [0; 128];
    file.read_exact(&mut head)?;
    let big = &head[126..] == b"MI";
    let mut variables = Vec::new();
    let mut tag = [0; 8];
    while file.read(&mut tag[..1])? > 0 {
        let place = variables.last().map_or_else(
            || "the first variable".to_owned(),
            |last: &Variable| format!("the variable behind `{}`", last.name),
        );
        let ends = |_| Fault::Damaged(format!("the file ends in {place}"));
        file.read_exact(&mut tag[1..]).map_err(ends)?;
        let mut tag = Bytes { data: &tag, big, budget };
        let (kind, size) = (tag.u32()?, u64::from(tag.u32()?));
        let mut data = Vec::new();
        file.by_ref().take(size).read_to_end(&mut data)?;
        let held = data.capacity() as u64;
        budget.take(held)?;
        if (data.len() as u64) < size {
            return Err(Fault::Damaged(format!("the file ends in {place}")));
        }
        let within = |fault: Fault| fault.within(&format!("in {place}"));
        if kind == COMPRESSED {
            let inside = unpacked(&data, budget).map_err(within)?;
            let held = inside.capacity() as u64;
            budget.take(held)?;
            let (kind, data) = Bytes { data: &inside, big, budget }.element().map_err(within)?;
            add(kind, Bytes { data, big, budget }, &mut variables).map_err(within)?;
            budget.give_back(held);
        } else {
            add(kind, Bytes { data: &data, big, budget }, &mut variables).map_err(within)?;
        }
        budget.give_back(held);
    }
    Ok(variables)
}

/// The bytes that are packed, as they are found to be: what they say is not asked.
fn unpacked(packed: &[u8], budget: &Budget) -> Result<Vec<u8>, Fault> {
    const PIECE: u64 = 1 << 20;
    let mut decoder = ZlibDecoder::new(packed);
    let mut inside = Vec::new();
    // A vector that grows is copied to one of twice its size.
    while budget.check(3 * inside.len() as u64 + PIECE).map(|()| true)? {
        if decoder.by_ref().take(PIECE).read_to_end(&mut inside)? == 0 {
            break;
        }
    }
    Ok(inside)
}

fn add(kind: u32, data: Bytes<'_>, variables: &mut Vec<Variable>) -> Result<(), Fault> {
    if kind != MATRIX {
        return Ok(());
    }
    let array = Array::read(data, 0)?;
    // What has no name belongs to MATLAB's objects.
    if !array.name.is_empty() {
        let name = array.name.clone();
        array.flatten(name, data.budget, variables)?;
    }
    Ok(())
}

/// Bytes that are read from the front.
#[derive(Clone, Copy)]
struct Bytes<'a> {
    data: &'a [u8],
    big: bool,
    budget: &'a Budget,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let Some((taken, rest)) = self.data.split_at_checked(count) else {
            return fault("it is shorter than it says");
        };
        self.data = rest;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, Fault> {
        let bytes = self.take(4)?;
        let bytes = <[u8; 4]>::try_from(bytes).unwrap_or_default();
        Ok(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// The next data element: its type and its data. Small ones are packed into the tag.
    fn element(&mut self) -> Result<(u32, &'a [u8]), Fault> {
        let kind = self.u32()?;
        if kind >> 16 != 0 {
            let data = self.take(4)?;
            let Some(data) = data.get(..(kind >> 16) as usize) else {
                return fault("a small element is larger than four bytes");
            };
            return Ok((kind & 0xffff, data));
        }
        let size = self.u32()? as usize;
        let data = self.take(size)?;
        // Elements start at multiples of eight bytes; behind the last one nothing need be.
        let gap = (size.next_multiple_of(8) - size).min(self.data.len());
        self.take(gap)?;
        Ok((kind, data))
    }

    /// Whether the next element holds zeros alone.
    fn are_zeros(&mut self) -> Result<bool, Fault> {
        let (kind, numbers) = self.element()?;
        Ok(self.inside(numbers).numbers(kind)?.iter().all(|number| *number == 0.0))
    }

    fn inside(self, data: &'a [u8]) -> Self {
        Self { data, ..self }
    }

    /// The numbers of an element of the type `kind`.
    fn numbers(self, kind: u32) -> Result<Vec<f64>, Fault> {
        match kind {
            1 => self.each(|[byte]| f64::from(byte.cast_signed())),
            2 | 16 => self.each(|[byte]| f64::from(byte)),
            3 => self.each(|bytes| f64::from(i16::from_le_bytes(bytes))),
            4 | 17 => self.each(|bytes| f64::from(u16::from_le_bytes(bytes))),
            5 => self.each(|bytes| f64::from(i32::from_le_bytes(bytes))),
            6 => self.each(|bytes| f64::from(u32::from_le_bytes(bytes))),
            7 => self.each(|bytes| f64::from(f32::from_le_bytes(bytes))),
            9 => self.each(f64::from_le_bytes),
            12 => self.each(|bytes| i64::from_le_bytes(bytes) as f64),
            13 => self.each(|bytes| u64::from_le_bytes(bytes) as f64),
            _ => Err(Fault::Damaged(format!("numbers of the unknown type {kind}"))),
        }
    }

    /// Each number of `N` bytes, the lowest byte first.
    fn each<const N: usize>(self, number: impl Fn([u8; N]) -> f64) -> Result<Vec<f64>, Fault> {
        let (numbers, _) = self.data.as_chunks::<N>();
        self.budget.take_values(numbers.len(), NUMBER_SIZE)?;
        let lowest_first = |mut bytes: [u8; N]| {
            if self.big {
                bytes.reverse();
            }
            bytes
        };
        Ok(numbers.iter().map(|bytes| number(lowest_first(*bytes))).collect())
    }
}

/// An array as it is stored.
struct Array {
    name: String,
    dims: Vec<usize>,
    value: Value,
}

enum Value {
    Numbers(Vec<f64>),
    Text(String),
    Cells(Vec<Array>),
    /// Each element's fields.
    Structures(Vec<Vec<(String, Array)>>),
    /// Of this class.
    Object(String),
    Other(&'static str),
}

impl Array {
    fn read(mut data: Bytes<'_>, depth: usize) -> Result<Self, Fault> {
        if data.data.is_empty() {
            return Ok(Self {
                name: String::new(),
                dims: vec![0, 0],
                value: Value::Numbers(Vec::new()),
            });
        }
        if depth > DEEPEST {
            return fault("structures lie too deep in one another");
        }
        let (_, flags) = data.element()?;
        let flags = data.inside(flags).u32()?;
        // Objects follow their own order from here on.
        if flags & 0xff == 17 {
            return Self::opaque(data);
        }
        let (kind, dims) = data.element()?;
        let dims = data.inside(dims).numbers(kind)?;
        if dims.iter().any(|length| *length < 0.0) {
            return fault("an array has a negative length");
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
        let dims: Vec<usize> = dims.into_iter().map(|length| length as usize).collect();
        let (_, name) = data.element()?;
        let name = name_of(name)?;
        let size = dims.iter().try_fold(1_usize, |size, length| size.checked_mul(*length));
        let Some(size) = size else { return fault("it is larger than any memory") };
        let value = Value::read(data, flags, size, depth)
            .map_err(|fault| fault.within(&format!("array `{name}`")))?;
        Ok(Self { name, dims, value })
    }

    fn opaque(mut data: Bytes<'_>) -> Result<Self, Fault> {
        let (_, name) = data.element()?;
        let name = name_of(name)?;
        let (_, _system) = data.element()?;
        let (_, class) = data.element()?;
        Ok(Self { name, dims: Vec::new(), value: Value::Object(name_of(class)?) })
    }

    /// Adds this array, and what lies in it, under `name`.
    fn flatten(
        self,
        name: String,
        budget: &Budget,
        variables: &mut Vec<Variable>,
    ) -> Result<(), Fault> {
        budget.take_values(1, size_of::<Variable>() + 2 * name.len())?;
        let content = match self.value {
            Value::Numbers(values) => Content::Numbers(Numbers::Read(values)),
            Value::Text(text) => match self.dims.as_slice() {
                [rows, _] if *rows > 1 => Content::Texts(rows_of(&text, *rows)),
                _ => Content::Other("text"),
            },
            Value::Object(class) => Content::Object(class),
            Value::Other(kind) => Content::Other(kind),
            Value::Cells(cells) => texts(cells),
            Value::Structures(elements) => {
                let one = elements.len() == 1;
                for (element, number) in elements.into_iter().zip(1..) {
                    let name = if one { name.clone() } else { format!("{name}({number})") };
                    for (field, array) in element {
                        array.flatten(format!("{name}.{field}"), budget, variables)?;
                    }
                }
                return Ok(());
            }
        };
        variables.push(Variable { name, dims: self.dims, content });
        Ok(())
    }
}

/// The rows of a matrix of characters, which stand column after column, without the blanks that make
/// them alike long.
fn rows_of(text: &str, rows: usize) -> Vec<String> {
    let letters: Vec<char> = text.chars().collect();
    let row = |row: usize| letters.iter().skip(row).step_by(rows).collect::<String>();
    (0..rows).map(|at| row(at).trim_end().to_owned()).collect()
}

const TOO_LONG: &str = "a name is too long";

fn name_of(bytes: &[u8]) -> Result<String, Fault> {
    if bytes.len() > LONGEST_NAME {
        return fault(TOO_LONG);
    }
    Ok(String::from_utf8_lossy(bytes).into_owned())
}

/// The class of objects from before MATLAB 7.6, whose name is not looked for.
const OBJECT: &str = "an object of MATLAB; save its parts as arrays";

impl Value {
    fn read(mut data: Bytes<'_>, flags: u32, size: usize, depth: usize) -> Result<Self, Fault> {
        match flags & 0xff {
            CELL => {
                let cells = (0..size).map(|_| data.array(depth)).collect::<Result<_, _>>()?;
                Ok(Self::Cells(cells))
            }
            STRUCTURE => Self::structures(data, size, depth),
            CHARACTERS => {
                let (kind, text) = data.element()?;
                data.budget.take_values(text.len(), 4)?;
                let text = if matches!(kind, 4 | 17) {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "it was one"
                    )]
                    let units: Vec<u16> = data
                        .inside(text)
                        .numbers(kind)?
                        .into_iter()
                        .map(|unit| unit as u16)
                        .collect();
                    String::from_utf16_lossy(&units)
                } else {
                    String::from_utf8_lossy(text).into_owned()
                };
                Ok(Self::Text(text))
            }
            6..=15 => {
                let (kind, numbers) = data.element()?;
                let values = data.inside(numbers).numbers(kind)?;
                if values.len() == size {
                    let is_real = flags & COMPLEX == 0 || data.are_zeros()?;
                    return Ok(if is_real {
                        Self::Numbers(values)
                    } else {
                        Self::Other("complex numbers")
                    });
                }
                Err(Fault::Damaged(format!(
                    "it has {} values but should have {size}",
                    values.len()
                )))
            }
            5 => Ok(Self::Other("a sparse matrix")),
            _ => Ok(Self::Other(OBJECT)),
        }
    }

    fn structures(mut data: Bytes<'_>, size: usize, depth: usize) -> Result<Self, Fault> {
        let (kind, length) = data.element()?;
        let length = data.inside(length).numbers(kind)?.first().copied().unwrap_or_default();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
        let length = (length as usize).max(1);
        let (_, names) = data.element()?;
        let name = |bytes: &[u8]| {
            let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
            String::from_utf8_lossy(bytes.get(..end).unwrap_or_default()).into_owned()
        };
        let names: Vec<String> = names.chunks(length).map(name).collect();
        if names.iter().any(|name| name.len() > LONGEST_NAME) {
            return fault(TOO_LONG);
        }
        let budget = data.budget;
        let mut element = |_| {
            budget.take_values(names.len(), size_of::<Array>() + LONGEST_NAME)?;
            let field = |name: &String| Ok((name.clone(), data.array(depth)?));
            names.iter().map(field).collect::<Result<Vec<_>, Fault>>()
        };
        if names.is_empty() {
            return Ok(Self::Structures(Vec::new()));
        }
        Ok(Self::Structures((0..size).map(&mut element).collect::<Result<_, _>>()?))
    }
}

impl Bytes<'_> {
    /// The next element, which is an array.
    fn array(&mut self, depth: usize) -> Result<Array, Fault> {
        let (kind, data) = self.element()?;
        if kind != MATRIX {
            return fault("an array is missing");
        }
        self.budget.take_values(1, ARRAY_SIZE)?;
        Array::read(Self { data, ..*self }, depth + 1)
    }
}

/// A cell array of texts is a column; any other is not.
fn texts(cells: Vec<Array>) -> Content {
    let text = |cell: Array| match cell.value {
        Value::Text(text) => Some(text),
        _ => None,
    };
    let texts: Option<Vec<String>> = cells.into_iter().map(text).collect();
    texts.map_or(Content::Other("a cell array"), Content::Texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_of_characters_is_a_text_per_row() {
        // `char('free', 'loaded')`, column after column.
        assert_eq!(rows_of("flroeaed e d", 2), ["free", "loaded"]);
    }
    use crate::experiment::MemoryLimit;

    fn of(file: &[u8]) -> Result<Vec<Variable>, Fault> {
        read(file, &Budget::new(MemoryLimit::default()))
    }

    fn reason(fault: Fault) -> String {
        fault.refuse(Path::new("log.mat")).to_string()
    }

    /// A data element of the type `kind`.
    fn element(kind: u32, data: &[u8]) -> Vec<u8> {
        let size = u32::try_from(data.len()).unwrap();
        let mut bytes = [kind.to_le_bytes(), size.to_le_bytes()].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    /// A file with one array of doubles.
    fn file(name: &str, dims: [u32; 2], values: &[f64]) -> Vec<u8> {
        let flags = [6_u32.to_le_bytes(), [0; 4]].concat();
        let dims: Vec<u8> = dims.iter().flat_map(|length| length.to_le_bytes()).collect();
        let values: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let parts = [
            element(6, &flags),
            element(5, &dims),
            element(1, name.as_bytes()),
            element(9, &values),
        ];
        let mut file = vec![b' '; 124];
        file.extend([0, 1, b'I', b'M']);
        file.extend(element(MATRIX, &parts.concat()));
        file
    }

    #[test]
    fn an_array_is_read_with_its_name_and_shape() {
        let found = of(&file("u", [3, 1], &[1.0, 2.0, -3.0])).unwrap();
        assert_eq!((found[0].name.as_str(), found[0].shape()), ("u", (3, 1)));
        let Content::Numbers(Numbers::Read(values)) = &found[0].content else { panic!() };
        assert_eq!(values, &[1.0, 2.0, -3.0]);
    }

    #[test]
    fn a_small_element_stands_in_its_tag() {
        let bytes = [2, 0, 2, 0, 7, 9, 0, 0];
        let mut data =
            Bytes { data: &bytes, big: false, budget: &Budget::new(MemoryLimit::default()) };
        assert_eq!(data.element().unwrap(), (2, &[7, 9][..]));
        assert!(data.data.is_empty());
    }

    #[test]
    fn a_file_that_ends_too_early_says_where() {
        let whole = file("u", [3, 1], &[1.0, 2.0, -3.0]);
        for end in 129..whole.len() {
            let fault = of(&whole[..end]).map(|_| ()).unwrap_err();
            assert!(reason(fault).contains(": the file ends in the first variable;"));
        }
        let lies = file("u", [4, 1], &[1.0, 2.0, -3.0]);
        let fault = of(&lies).map(|_| ()).unwrap_err();
        assert!(reason(fault).contains("array `u`: it has 3 values but should have 4;"));
        assert!(of(&file("u", [u32::MAX, u32::MAX], &[])).is_err());
    }
}
