//! MATLAB 5 to 7 (`save -v6`, `save -v7`), after the description "MAT-File Format" of its maker.
//!
//! Written here because no crate fits: `matrw` 0.1.4 overflows its stack at cells within cells, unpacks
//! without a limit, and reads no file of SciPy; `matfile` 0.5 reads no structures.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::variable::{Content, Variable, damaged, object};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::table::LONGEST_NAME;

/// Structures may lie in structures, but not without end.
const DEEPEST: usize = 32;

// The types of data elements and the classes of arrays, as the description numbers them.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const CELL: u32 = 1;
const STRUCTURE: u32 = 2;
const OLD_OBJECT: u32 = 3;
const CHARACTERS: u32 = 4;
const SPARSE: u32 = 5;
const OPAQUE: u32 = 17;

/// The flag of an array whose numbers have an imaginary part.
const COMPLEX: u32 = 0x800;

/// Memory for a byte of a variable, at most: a number of one byte becomes a double twice while its list grows,
/// and letters and names take less.
const COPIES: u64 = 16;

/// The variables of a file, their numbers read.
pub(super) fn variables(path: &Path, budget: &Budget) -> Result<Vec<Variable>, ReadError> {
    read(BufReader::new(File::open(path)?), budget)
}

fn read(mut file: impl Read, budget: &Budget) -> Result<Vec<Variable>, ReadError> {
    let mut head = [0; 128];
    file.read_exact(&mut head).map_err(damaged)?;
    let like = Bytes { data: &[], big: head.ends_with(b"MI") };
    let (mut listing, mut number) = (Listing::default(), 1);
    while listing
        .take(&mut file, like, budget)
        .map_err(|fault| fault.within(&format!("variable {number}")))?
    {
        number += 1;
    }
    Ok(listing.found)
}

/// The bytes that are packed, as they are found to be: what they say is not asked.
fn unpacked(packed: &[u8], budget: &Budget) -> Result<Vec<u8>, ReadError> {
    let mut inside = Vec::new();
    let most = budget.left() / COPIES + 1;
    ZlibDecoder::new(packed).take(most).read_to_end(&mut inside).map_err(damaged)?;
    budget.check(COPIES * inside.len() as u64)?;
    Ok(inside)
}

fn fault<T>(text: &str) -> Result<T, ReadError> {
    Err(damaged(text))
}

/// Bytes that are read from the front.
#[derive(Clone, Copy)]
struct Bytes<'a> {
    data: &'a [u8],
    big: bool,
}

impl Bytes<'_> {
    fn take(&mut self, count: usize) -> Result<Self, ReadError> {
        let Some((taken, rest)) = self.data.split_at_checked(count) else {
            return fault("it is shorter than it says");
        };
        self.data = rest;
        Ok(Self { data: taken, ..*self })
    }

    fn u32(&mut self) -> Result<u32, ReadError> {
        let bytes = self.take(4)?.data.try_into().unwrap_or_default();
        Ok(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// The next data element: its type and its data. Small ones are packed into the tag.
    fn element(&mut self) -> Result<(u32, Self), ReadError> {
        let kind = self.u32()?;
        if kind >> 16 != 0 {
            let data = self.take(4)?.take((kind >> 16) as usize)?;
            return Ok((kind & 0xffff, data));
        }
        let size = self.u32()? as usize;
        let data = self.take(size)?;
        // Elements start at multiples of eight bytes; after the last one nothing need be.
        self.take((size.next_multiple_of(8) - size).min(self.data.len()))?;
        Ok((kind, data))
    }

    /// The numbers of the next element.
    fn numbers(&mut self) -> Result<Vec<f64>, ReadError> {
        let (kind, data) = self.element()?;
        Ok(match kind {
            1 => data.each(|[byte]| f64::from(byte.cast_signed())),
            2 | 16 => data.each(|[byte]| f64::from(byte)),
            3 => data.each(|bytes| f64::from(i16::from_le_bytes(bytes))),
            4 | 17 => data.each(|bytes| f64::from(u16::from_le_bytes(bytes))),
            5 => data.each(|bytes| f64::from(i32::from_le_bytes(bytes))),
            6 => data.each(|bytes| f64::from(u32::from_le_bytes(bytes))),
            7 => data.each(|bytes| f64::from(f32::from_le_bytes(bytes))),
            9 => data.each(f64::from_le_bytes),
            12 => data.each(|bytes| i64::from_le_bytes(bytes) as f64),
            13 => data.each(|bytes| u64::from_le_bytes(bytes) as f64),
            _ => return fault(&format!("numbers of the unknown type {kind}")),
        })
    }

    /// The next element as whole numbers that are not negative.
    fn counts(&mut self) -> Result<Vec<usize>, ReadError> {
        let numbers = self.numbers()?;
        if numbers.iter().any(|number| *number < 0.0) {
            return fault("an array has a negative length");
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
        Ok(numbers.into_iter().map(|number| number as usize).collect())
    }

    /// Each value of `N` bytes, the lowest byte first.
    fn each<const N: usize, T>(self, value: impl Fn([u8; N]) -> T) -> Vec<T> {
        let (values, _) = self.data.as_chunks::<N>();
        let lowest_first = |mut bytes: [u8; N]| {
            if self.big {
                bytes.reverse();
            }
            bytes
        };
        values.iter().map(|bytes| value(lowest_first(*bytes))).collect()
    }

    /// The next element as text.
    fn text(&mut self) -> Result<String, ReadError> {
        let (kind, data) = self.element()?;
        Ok(match kind {
            4 | 17 => String::from_utf16_lossy(&data.each(u16::from_le_bytes)),
            _ => String::from_utf8_lossy(data.data).into_owned(),
        })
    }
}

/// A file whose variables are being listed.
#[derive(Default)]
struct Listing {
    found: Vec<Variable>,
    /// Arrays that the one which is being read lies in.
    depth: usize,
}

impl Listing {
    /// Takes the next variable, where there is one, its numbers as `like` has them.
    fn take(
        &mut self,
        file: &mut impl Read,
        like: Bytes<'_>,
        budget: &Budget,
    ) -> Result<bool, ReadError> {
        let (mut tag, mut data) = (Vec::new(), Vec::new());
        file.take(8).read_to_end(&mut tag).map_err(damaged)?;
        if tag.is_empty() {
            return Ok(false);
        }
        let mut tag = Bytes { data: &tag, ..like };
        let (mut kind, size) = (tag.u32()?, u64::from(tag.u32()?));
        file.take(size).read_to_end(&mut data).map_err(damaged)?;
        if (data.len() as u64) < size {
            return fault("it is cut off by the end of the file");
        }
        let is_packed = kind == COMPRESSED;
        if is_packed {
            data = unpacked(&data, budget)?;
        }
        budget.take(COPIES.saturating_mul(data.len() as u64))?;
        let mut data = Bytes { data: &data, ..like };
        if is_packed {
            (kind, data) = data.element()?;
        }
        if kind == MATRIX {
            self.array(data, None)?;
        }
        Ok(true)
    }

    /// Takes the next element of `data`, which is an array of this name within another.
    fn inner(&mut self, data: &mut Bytes<'_>, name: String) -> Result<(), ReadError> {
        let (MATRIX, data) = data.element()? else { return fault("an array is missing") };
        if self.depth == DEEPEST {
            return fault("structures are nested too deeply");
        }
        self.depth += 1;
        self.array(data, Some(name))?;
        self.depth -= 1;
        Ok(())
    }

    /// Takes an array, and what lies in it. It is called `name`, or as it says itself.
    fn array(&mut self, mut data: Bytes<'_>, name: Option<String>) -> Result<(), ReadError> {
        // An empty array may have no bytes.
        if data.data.is_empty() {
            let (name, content) = (name.unwrap_or_default(), Content::Numbers(Vec::new()));
            self.add(Variable { name, dims: vec![0, 0], content });
            return Ok(());
        }
        let flags = data.element()?.1.u32()?;
        // Objects have no lengths.
        let dims = if flags & 0xff == OPAQUE { vec![0, 0] } else { data.counts()? };
        let own = data.text()?;
        let name = name.unwrap_or(own);
        if name.len() > LONGEST_NAME {
            return fault("its name is too long");
        }
        let content = self.content(data, flags, &dims, &name);
        if let Some(content) = content.map_err(|fault| fault.within(&format!("array `{name}`")))? {
            self.add(Variable { name, dims, content });
        }
        Ok(())
    }

    /// What has no name belongs to MATLAB's objects.
    fn add(&mut self, variable: Variable) {
        self.found.extend((self.depth > 0 || !variable.name.is_empty()).then_some(variable));
    }

    /// What is in an array; nothing is left where it is a structure, whose fields are found.
    fn content(
        &mut self,
        mut data: Bytes<'_>,
        flags: u32,
        dims: &[usize],
        name: &str,
    ) -> Result<Option<Content>, ReadError> {
        let size = dims.iter().try_fold(1_usize, |size, length| size.checked_mul(*length));
        let Some(size) = size else { return fault("it is larger than any memory") };
        Ok(Some(match flags & 0xff {
            CELL => {
                let before = self.found.len();
                for _ in 0..size {
                    self.inner(&mut data, String::new())?;
                }
                texts(self.found.split_off(before))
            }
            STRUCTURE => {
                self.structures(data, size, name)?;
                return Ok(None);
            }
            CHARACTERS => {
                let (text, rows) = (data.text()?, dims.first().copied().unwrap_or(1));
                Content::Texts(rows_of(&text, rows))
            }
            SPARSE => Content::Other("a sparse matrix".to_owned()),
            OPAQUE => {
                data.element()?;
                object(&data.text()?)
            }
            6..=15 => {
                let values = data.numbers()?;
                if values.len() != size {
                    let count = values.len();
                    return fault(&format!("it has {count} values but should have {size}"));
                }
                // Those that have no imaginary part at all are real.
                if flags & COMPLEX == 0 || data.numbers()?.iter().all(|part| *part == 0.0) {
                    Content::Numbers(values)
                } else {
                    Content::Other("complex numbers".to_owned())
                }
            }
            OLD_OBJECT => object(&data.text()?),
            _ => Content::Other("a value of another kind".to_owned()),
        }))
    }

    /// Takes the fields of an array of `size` structures.
    fn structures(
        &mut self,
        mut data: Bytes<'_>,
        size: usize,
        name: &str,
    ) -> Result<(), ReadError> {
        let length = data.counts()?.first().copied().unwrap_or_default().max(1);
        let (_, names) = data.element()?;
        let fields = names.data.chunks(length).map(|bytes| {
            let letters = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
            String::from_utf8_lossy(letters).into_owned()
        });
        let fields: Vec<String> = fields.collect();
        for number in 1..=if fields.is_empty() { 0 } else { size } {
            let name = if size == 1 { name.to_owned() } else { format!("{name}({number})") };
            for field in &fields {
                self.inner(&mut data, format!("{name}.{field}"))?;
            }
        }
        Ok(())
    }
}

/// The rows of a matrix of characters, which stand column after column, without the blanks that make
/// them alike long.
fn rows_of(text: &str, rows: usize) -> Vec<String> {
    let letters: Vec<char> = text.chars().collect();
    let rows = rows.clamp(1, letters.len().max(1));
    let row = |row: usize| letters.iter().skip(row).step_by(rows).collect::<String>();
    (0..rows).map(|at| row(at).trim_end().to_owned()).collect()
}

/// A cell array of texts is a column; any other is not.
fn texts(cells: Vec<Variable>) -> Content {
    let mut texts = Vec::new();
    for cell in cells {
        match cell.content {
            Content::Texts(text) if text.len() == 1 => texts.extend(text),
            _ => return Content::Other("a cell array".to_owned()),
        }
    }
    Content::Texts(texts)
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

    fn of(file: &[u8]) -> Result<Vec<Variable>, ReadError> {
        read(file, &Budget::new(MemoryLimit::default()))
    }

    fn reason(fault: ReadError) -> String {
        fault.in_file(Path::new("log.mat")).to_string()
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
        let Content::Numbers(values) = &found[0].content else { panic!() };
        assert_eq!(values, &[1.0, 2.0, -3.0]);
    }

    #[test]
    fn a_small_element_stands_in_its_tag() {
        let bytes = [2, 0, 2, 0, 7, 9, 0, 0];
        let mut data = Bytes { data: &bytes, big: false };
        let (kind, inside) = data.element().unwrap();
        assert_eq!((kind, inside.data), (2, &[7, 9][..]));
        assert!(data.data.is_empty());
    }

    #[test]
    fn a_file_that_ends_too_early_says_where() {
        let whole = file("u", [3, 1], &[1.0, 2.0, -3.0]);
        for end in 129..whole.len() {
            let fault = of(&whole[..end]).map(|_| ()).unwrap_err();
            assert!(reason(fault).contains(": variable 1: "));
        }
        let lies = file("u", [4, 1], &[1.0, 2.0, -3.0]);
        let fault = of(&lies).map(|_| ()).unwrap_err();
        assert!(reason(fault).contains("array `u`: it has 3 values but should have 4;"));
        assert!(of(&file("u", [u32::MAX, u32::MAX], &[])).is_err());
    }
}
