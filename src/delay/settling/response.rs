//! How an output that settles moves about one step of the input.
//!
//! Before the onset `τ` the output is on its way to one level, behind it to another, with time
//! constants `T₀` and `T₁` of the two directions; a further lag `T₂` may follow both:
//!
//! ```text
//! x(t) = A₀ + B·e^(−t/T₀)                       t ≤ τ
//! x(t) = A₁ + (x(τ) − A₁)·e^(−(t − τ)/T₁)       t > τ
//! T₂ y' + y = x                                 y = x without a further lag
//! ```
//!
//! `A₀`, `B`, `A₁`, and what the further lag still holds at the start, are linear: a column each.

/// The output about one step as it was fitted, in closed form: a record may have many steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    pub(super) constants: Constants,
    /// What was solved for, a number for each column.
    pub(super) parts: Vec<f64>,
    /// Added to all of them.
    pub(super) origin: f64,
    /// Samples from the first one that was looked at to the onset.
    pub(in crate::delay) onset: f64,
    /// Samples that were looked at.
    pub(super) samples: usize,
    /// Part of the squared error without a reaction that it removes: `1 − SSE / SSE₀`.
    pub(super) explained: f64,
}

impl Response {
    /// Samples that were looked at.
    pub(in crate::delay) fn len(&self) -> usize {
        self.samples
    }

    /// The output at each sample of the segment, without noise, output units.
    pub fn values(&self) -> Vec<f64> {
        let columns = self.constants.responses(self.onset, self.samples);
        let combined = combined(&columns, self.samples, &self.parts);
        combined.into_iter().map(|y| self.origin + y).collect()
    }

    /// Part of the squared error without a reaction that it removes, 0 to 1.
    pub fn explained(&self) -> f64 {
        self.explained
    }
}

/// The sum of columns of `length` samples, each times its part.
pub(super) fn combined(columns: &[f64], length: usize, parts: &[f64]) -> Vec<f64> {
    let value = |k: usize| {
        let columns = columns.chunks_exact(length).zip(parts);
        columns.map(|(column, part)| column[k] * part).sum()
    };
    (0..length).map(value).collect()
}

/// Time constants about one step, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Constants {
    /// `T₀`.
    pub(super) before: f64,
    /// `T₁`.
    pub(super) behind: f64,
    /// `T₂`; 0 without a further lag.
    pub(super) further: f64,
}

impl Constants {
    /// Number of columns.
    pub(super) fn columns(&self) -> usize {
        if self.further > 0.0 { 4 } else { 3 }
    }

    /// The columns over `length` samples, one behind the other: the levels before and behind the
    /// onset at the sample `onset`, the decay of what was before, and that of the further lag.
    ///
    /// The second is zero where no onset is among the samples.
    pub(super) fn responses(&self, onset: f64, length: usize) -> Vec<f64> {
        let mut columns = vec![0.0; self.columns() * length];
        for k in 0..length {
            let time = k as f64;
            let row = if time <= onset { self.before(time) } else { self.behind(time, onset) };
            for (column, value) in columns.chunks_exact_mut(length).zip(row) {
                column[k] = value;
            }
        }
        columns
    }

    /// What a further lag makes of a decay of this time constant.
    fn gain(&self, time_constant: f64) -> f64 {
        // T₂ y′ + y = e^(−t/T) is solved by T/(T − T₂)·e^(−t/T).
        time_constant / (time_constant - self.further)
    }

    fn further_decay(&self, time: f64) -> f64 {
        if self.further > 0.0 { (-time / self.further).exp() } else { 0.0 }
    }

    fn before(&self, time: f64) -> [f64; 4] {
        let decay = self.gain(self.before) * (-time / self.before).exp();
        [1.0, 0.0, decay, self.further_decay(time)]
    }

    fn behind(&self, time: f64, onset: f64) -> [f64; 4] {
        let gain = self.gain(self.behind);
        let decay = gain * (-(time - onset) / self.behind).exp();
        let further = self.further_decay(time - onset);
        // x(τ) and y(τ) of each column go on as x·decay + (y − gain·x)·further.
        let state = (-onset / self.before).exp();
        let lagged = self.gain(self.before) * state;
        let level = decay + (1.0 - gain) * further;
        [
            level,
            1.0 - level,
            state * decay + (lagged - gain * state) * further,
            self.further_decay(onset) * further,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The response by small steps in time, from a level of 2 and a decay of 3 to a level of 5.
    fn simulated(constants: &Constants, onset: f64, length: usize) -> Vec<f64> {
        const PARTS: usize = 2000;
        let (mut x, mut y) = (5.0, 5.0);
        let mut values = Vec::new();
        for part in 0..length * PARTS {
            if part % PARTS == 0 {
                values.push(y);
            }
            let time = part as f64 / PARTS as f64;
            let (to, constant) =
                if time < onset { (2.0, constants.before) } else { (5.0, constants.behind) };
            x += (to - x) / constant / PARTS as f64;
            y = if constants.further > 0.0 {
                y + (x - y) / constants.further / PARTS as f64
            } else {
                x
            };
        }
        values
    }

    #[test]
    fn the_columns_are_those_of_the_differential_equation() {
        for further in [0.0, 1.5] {
            let constants = Constants { before: 12.0, behind: 7.0, further };
            let columns = constants.responses(20.4, 60);
            // At the start y = x = 5: the decay of the further lag makes up for its gain.
            let gain = constants.gain(constants.before);
            let parts = [2.0, 5.0, 3.0, 3.0 * (1.0 - gain)];
            for (k, value) in simulated(&constants, 20.4, 60).into_iter().enumerate() {
                let column = columns.iter().skip(k).step_by(60);
                let sum: f64 = column.zip(parts).map(|(column, part)| column * part).sum();
                assert!((sum - value).abs() < 5e-3, "{further} {k}: {sum} {value}");
            }
        }
    }

    #[test]
    fn without_an_onset_nothing_approaches_another_level() {
        let columns = Constants { before: 9.0, behind: 9.0, further: 0.0 }.responses(30.0, 30);
        assert!(columns[30..60].iter().all(|value| *value == 0.0));
    }
}
