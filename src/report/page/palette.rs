//! Colours: one meaning each, distinct for colour-blind readers too.
//!
//! Okabe and Ito's hues, which the recording has as well, in a shade for light ground and
//! one for dark ground. A figure is drawn in the shades for light ground, which are right
//! wherever no style sheet is read; the style sheet finds each by its number and gives it
//! the shade that the reader's ground asks for. So each shade for light ground stands for
//! one meaning only.

use std::fmt::Write as _;

use crate::figure::{Revision, Role};

/// Shades of the revisions behind the first one, on light and on dark ground: the hues that the
/// recording has.
const REVISIONS: [(u32, u32); Revision::COUNT as usize] = [
    (0x00_7F5C, 0x00_9E73),
    (0xB0_4A8A, 0xCC_79A7),
    (0xB8_4A00, 0xD5_5E00),
    (0x1F_6FB5, 0x78_BEFF),
    (0x7A_6B00, 0xF0_E442),
    (0x6A_4FC0, 0xA0_78F0),
    (0x3F_7F2A, 0x96_DC78),
    (0xB0_4040, 0xFF_9696),
    (0x00_7C85, 0x00_C8D2),
];

impl Role {
    /// Its shades on light and on dark ground, as `0xRRGGBB`.
    const fn shades(self) -> (u32, u32) {
        match self {
            Self::Ink => (0x1C_1F23, 0xE8_EAED),
            Self::Faint => (0x5A_6067, 0xA7_AEB6),
            Self::Grid => (0xDD_E0E3, 0x39_3E44),
            Self::Input => (0x8C_7A00, 0xF0_E442),
            Self::Measured => (0x80_8487, 0x96_9A9E),
            Self::Smoothed => (0x00_72B2, 0x56_B4E9),
            Self::Accepted => (0x00_8F68, 0x00_BE8C),
            Self::Rejected => (0xD5_5E00, 0xF2_8A4B),
            Self::Error => (0xA8_4F87, 0xD9_8CB8),
            Self::Model => (0xC4_7A00, 0xE6_9F00),
            Self::Noise => (0x2F_8FCB, 0x57_B5EA),
            Self::Attention => (0xCC_79A7, 0xCC_79A8),
            Self::Revision(one) => REVISIONS[one.place()],
            Self::Own(red, green, blue) => {
                let shade = u32::from_be_bytes([0, red, green, blue]);
                (shade, shade)
            }
        }
    }

    /// Red, green and blue on light ground.
    pub(super) const fn rgb(self) -> (u8, u8, u8) {
        let [_, red, green, blue] = self.shades().0.to_be_bytes();
        (red, green, blue)
    }
}

/// The rules that give the lines and texts of figures their shade.
pub(super) fn figure_style() -> String {
    let (mut light, mut dark, mut rules) = (String::new(), String::new(), String::new());
    for (number, role) in Role::ALL.into_iter().enumerate() {
        let (on_light, on_dark) = role.shades();
        write!(light, "--c{number}:#{on_light:06X};").unwrap_or_default();
        write!(dark, "--c{number}:#{on_dark:06X};").unwrap_or_default();
        for part in ["stroke", "fill"] {
            write!(rules, "[{part}=\"#{on_light:06X}\"]{{{part}:var(--c{number})}}")
                .unwrap_or_default();
        }
    }
    format!(
        ":root{{{light}}}@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\
         @media print{{:root{{{light}}}}}{rules}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shade_means_one_thing() {
        let mut shades: Vec<u32> = Role::ALL.map(|role| role.shades().0).to_vec();
        shades.sort_unstable();
        shades.dedup();
        assert_eq!(shades.len(), Role::ALL.len());
    }

    /// Relative luminance (WCAG 2.2).
    fn luminance(shade: u32) -> f64 {
        let [_, red, green, blue] = shade.to_be_bytes();
        let linear = |part: u8| {
            let part = f64::from(part) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue)
    }

    #[test]
    fn lines_stand_out_from_both_grounds() {
        let contrast = |a: f64, b: f64| (a.max(b) + 0.05) / (a.min(b) + 0.05);
        for role in Role::ALL {
            let least = match role {
                Role::Grid | Role::Attention => 1.2,
                Role::Ink | Role::Faint => 5.0,
                _ => 3.0,
            };
            let (light, dark) = role.shades();
            assert!(contrast(luminance(light), 1.0) > least, "{role:?} on white");
            assert!(contrast(luminance(dark), luminance(0x16_181B)) > least, "{role:?} on black");
        }
    }
}
