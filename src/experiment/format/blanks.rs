//! Tables whose cells are parted by blanks: a tab stands for each run of them.

/// `lines`, whole ones, with a tab for each run of blanks.
///
/// Those at the ends of a line make no cell, those between quotation marks and before the bracket of a unit
/// part none, and a line end closes a quotation.
pub(super) fn tabbed(lines: &[u8]) -> Vec<u8> {
    let mut made = Vec::with_capacity(lines.len());
    // Whether a cell or a comment, a blank behind it, and a quotation mark came before.
    let (mut is_begun, mut is_parted, mut is_quoted) = (false, false, false);
    for &byte in lines {
        match byte {
            b'\n' | b'\r' => (is_begun, is_parted, is_quoted) = (false, false, false),
            b' ' | b'\t' if !is_quoted => {
                is_parted = is_begun;
                continue;
            }
            // Blanks behind the mark of a comment are at its beginning.
            b'#' if !is_begun => {}
            _ => {
                is_begun = true;
                if std::mem::take(&mut is_parted) {
                    made.push(if b"[(".contains(&byte) { b' ' } else { b'\t' });
                }
                is_quoted ^= byte == b'"';
            }
        }
        made.push(byte);
    }
    made
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
}
