//! Units of data sheets in SI units.

/// Pascal in a bar.
pub(super) const PASCAL_PER_BAR: f64 = 1e5;

/// Cubic metres in a litre.
pub(super) const LITRE: f64 = 1e-3;

/// Cubic metres per second in a litre per minute.
pub(super) const LITRE_PER_MINUTE: f64 = LITRE / 60.0;
