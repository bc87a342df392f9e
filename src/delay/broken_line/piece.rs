//! A broken line whose break is between two neighbouring samples: what it subtracts from the squared
//! error, a quotient of two quadratics in the position.

/// Level and ramp behind a sample, without what a line can do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    pub(super) level_y: f64,
    pub(super) ramp_y: f64,
    pub(super) level_level: f64,
    pub(super) level_ramp: f64,
    pub(super) ramp_ramp: f64,
    /// Parts of level and ramp along a constant, and along a slope.
    pub(super) level_line: [f64; 2],
    pub(super) ramp_line: [f64; 2],
}

impl Piece {
    /// How much of the squared error a break at `s` takes away.
    #[inline]
    fn gain(&self, s: f64) -> f64 {
        // ((h − s·w)·y)²/|h − s·w|².
        let with = self.ramp_y - s * self.level_y;
        let size = self.size(s);
        if size > 0.0 { with * with / size } else { 0.0 }
    }

    /// The change of slope at a break at `s`.
    #[inline]
    pub(super) fn change(&self, s: f64) -> f64 {
        let size = self.size(s);
        if size > 0.0 { (self.ramp_y - s * self.level_y) / size } else { 0.0 }
    }

    #[inline]
    fn size(&self, s: f64) -> f64 {
        self.ramp_ramp - 2.0 * s * self.level_ramp + s * s * self.level_level
    }

    /// The best break within the piece, 0 to 1, and what it takes away.
    #[inline]
    pub(super) fn best(&self) -> (f64, f64) {
        // The gain's derivative is 0 where s·(wy·wh − hy·ww) = wy·hh − hy·wh, with wy for w·y and
        // so on.
        let below = self.level_y * self.level_ramp - self.ramp_y * self.level_level;
        let above = self.level_y * self.ramp_ramp - self.ramp_y * self.level_ramp;
        // Most pieces have nothing inside: they cost no division.
        let within = above * below >= 0.0 && above.abs() <= below.abs() && below != 0.0;
        let inside = if within { above / below } else { 0.0 };
        (inside, self.gain(inside))
    }

    /// Where the gain crosses `limit` between 0 and 1: the first time, and the last.
    pub(super) fn crossings(&self, limit: f64) -> Option<(f64, f64)> {
        // (hy − s·wy)² = limit·(hh − 2s·wh + s²·ww), that is a·s² − 2b·s + c = 0.
        let a = self.level_y * self.level_y - limit * self.level_level;
        let b = self.ramp_y * self.level_y - limit * self.level_ramp;
        let c = self.ramp_y * self.ramp_y - limit * self.ramp_ramp;
        let root = (b * b - a * c).max(0.0).sqrt();
        let roots = [(b - root) / a, (b + root) / a].into_iter();
        let mut inside: Vec<f64> = roots.filter(|s| (0.0..=1.0).contains(s)).collect();
        inside.sort_by(f64::total_cmp);
        inside.first().copied().zip(inside.last().copied())
    }
}
