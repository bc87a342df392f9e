//! Tables whose cells are parted by blanks: a tab stands for each run of them.

use std::io::{self, Read};

/// Bytes of such a table, from the beginning of a line on.
pub(super) struct Tabbed<R> {
    inner: R,
    runs: Runs,
    /// What was made of the bytes that were read, and how much of it was handed on.
    ready: Vec<u8>,
    passed: usize,
}

impl<R: Read> Tabbed<R> {
    pub(super) fn new(inner: R) -> Self {
        Self { inner, runs: Runs::default(), ready: Vec::new(), passed: 0 }
    }
}

impl<R: Read> Read for Tabbed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut bytes = [0; 8192];
        while self.passed == self.ready.len() {
            let count = self.inner.read(&mut bytes)?;
            if count == 0 {
                return Ok(0);
            }
            self.ready.clear();
            self.passed = 0;
            self.runs.replace(bytes.get(..count).unwrap_or_default(), &mut self.ready);
        }
        let count = self.ready.get(self.passed..).unwrap_or_default().read(buffer)?;
        self.passed += count;
        Ok(count)
    }
}

/// `lines`, whole ones, with a tab for each run of blanks.
pub(super) fn tabbed(lines: &[u8]) -> Vec<u8> {
    let mut made = Vec::with_capacity(lines.len());
    Runs::default().replace(lines, &mut made);
    made
}

/// Where in a line the next byte is.
#[derive(Default)]
struct Runs {
    /// Whether a cell or a comment came before it.
    is_begun: bool,
    /// Whether blanks did.
    is_parted: bool,
    is_quoted: bool,
}

impl Runs {
    /// Those at the ends of a line make no cell, those between quotation marks and before the bracket of
    /// a unit part none, and a line end closes a quotation.
    fn replace(&mut self, bytes: &[u8], made: &mut Vec<u8>) {
        for &byte in bytes {
            match byte {
                b'\n' | b'\r' => *self = Self::default(),
                b' ' | b'\t' if !self.is_quoted => {
                    self.is_parted = self.is_begun;
                    continue;
                }
                // Blanks behind the mark of a comment are at its beginning.
                b'#' if !self.is_begun => {}
                _ => {
                    self.is_begun = true;
                    if std::mem::take(&mut self.is_parted) {
                        made.push(if b"[(".contains(&byte) { b' ' } else { b'\t' });
                    }
                    self.is_quoted ^= byte == b'"';
                }
            }
            made.push(byte);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tab_stands_for_each_run_of_blanks() {
        let made = |text: &str| String::from_utf8(tabbed(text.as_bytes())).unwrap();
        assert_eq!(made("  # t  u\r\n 1.0   2 \t 3  \n\n"), "#t\tu\r\n1.0\t2\t3\n\n");
        assert_eq!(made("t [s] \"a  b\" y(deg)"), "t [s]\t\"a  b\"\ty(deg)");
        assert_eq!(made("\"open  a\nb  c"), "\"open  a\nb\tc");
    }

    #[test]
    fn pieces_make_what_the_whole_makes() {
        /// Hands on few bytes at a time.
        struct Few<'t>(&'t [u8], usize);
        impl Read for Few<'_> {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let count = self.1.min(buffer.len());
                self.0.read(&mut buffer[..count])
            }
        }
        let text = b"  t    \"a  b\"  y [deg]  \n0   1   2\n   # a   b\n";
        for count in 1..12 {
            let mut made = Vec::new();
            Tabbed::new(Few(text, count)).read_to_end(&mut made).unwrap();
            assert_eq!(made, tabbed(text));
        }
    }
}
