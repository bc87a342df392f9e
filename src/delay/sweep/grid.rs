//! The settings that are tried: every combination of some values of each.

use std::fmt;

use crate::delay::Settings;
use crate::delay::lengths::common_period;
use crate::experiment::Trial;
use crate::numerics::LowPass;
use crate::units::Length;

/// A setting that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Factor {
    /// How a delay is found.
    Method,
    /// The low-pass on the output.
    Passband,
    /// α: samples that a segment reaches beyond its input steps.
    Alpha,
    /// β: samples between two candidates.
    Beta,
}

impl Factor {
    /// All of them, the slowest of a [`Grid`] first.
    pub const ALL: [Self; 4] = [Self::Method, Self::Passband, Self::Alpha, Self::Beta];

    /// Its name in sentences.
    pub fn word(self) -> &'static str {
        match self {
            Self::Method => "method",
            Self::Passband => "passband",
            Self::Alpha => "α",
            Self::Beta => "β",
        }
    }
}

impl fmt::Display for Factor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// One value of each setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Combination {
    /// Index of the value of each factor, in the order of [`Factor::ALL`].
    pub levels: [usize; 4],
    /// Index of its run: methods without rows have one run for all of them.
    pub run: usize,
}

/// A method, with all settings that are not varied.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// The settings.
    pub settings: Settings,
    /// It keeps its own low-pass, or none, whatever the others try.
    pub keeps_low_pass: bool,
}

/// Every combination of some methods, passbands, α and β.
///
/// Each combination counts once when votes are counted, so that a method whose delays do not
/// come in steps of β counts as much as another; what is the same is run once.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    bases: Vec<Base>,
    passbands: Vec<Option<LowPass>>,
    alphas: Vec<Length>,
    betas: Vec<Length>,
    runs: Vec<Settings>,
    combinations: Vec<Combination>,
}

impl Grid {
    /// All combinations of the methods of `bases` with `passbands`, `alphas` and `betas`.
    pub fn new(
        bases: Vec<Base>,
        passbands: Vec<Option<LowPass>>,
        alphas: impl IntoIterator<Item = impl Into<Length>>,
        betas: impl IntoIterator<Item = impl Into<Length>>,
    ) -> Self {
        let alphas = alphas.into_iter().map(Into::into).collect();
        let betas = betas.into_iter().map(Into::into).collect();
        let (runs, combinations) = (Vec::new(), Vec::new());
        let mut grid = Self { bases, passbands, alphas, betas, runs, combinations };
        for m in 0..grid.bases.len() {
            for p in 0..grid.passbands.len() {
                for a in 0..grid.alphas.len() {
                    grid.add_row([m, p, a]);
                }
            }
        }
        grid
    }

    /// These combinations with other settings that are not varied.
    #[must_use]
    pub(crate) fn with_settings(&self, of: impl Fn(&Settings) -> Settings) -> Self {
        let base = |base: &Base| Base { settings: of(&base.settings), ..base.clone() };
        let bases = self.bases.iter().map(base).collect();
        let (passbands, alphas, betas) = (&self.passbands, &self.alphas, &self.betas);
        Self::new(bases, passbands.clone(), alphas.iter().copied(), betas.iter().copied())
    }

    /// This grid with other low-passes.
    #[must_use]
    pub(crate) fn with_passbands(&self, passbands: Vec<Option<LowPass>>) -> Self {
        let (alphas, betas) = (self.alphas.iter().copied(), self.betas.iter().copied());
        Self::new(self.bases.clone(), passbands, alphas, betas)
    }

    /// This grid with all lengths in samples, where all of `trials` have one period.
    ///
    /// Lengths that are then equal are tried once.
    #[must_use]
    pub(crate) fn in_samples<'a>(&self, trials: impl Iterator<Item = &'a Trial>) -> Self {
        let Some(period) = common_period(trials) else { return self.clone() };
        let each = |lengths: &[Length]| {
            let mut found: Vec<Length> = Vec::new();
            for length in lengths {
                let length = Length::Samples(length.samples(period).max(1));
                if !found.contains(&length) {
                    found.push(length);
                }
            }
            found
        };
        let grid = self.with_settings(|settings| settings.at(period));
        Self::new(grid.bases, grid.passbands, each(&self.alphas), each(&self.betas))
    }

    /// The combinations with every β.
    fn add_row(&mut self, [m, p, a]: [usize; 3]) {
        let Base { settings, keeps_low_pass } = self.bases[m].clone();
        let has_rows = !settings.method.spec().has_intervals;
        let low_pass = if keeps_low_pass { settings.low_pass } else { self.passbands[p] };
        // Two runs that differ by a low-pass that is left out would be one.
        let varied = Settings { low_pass, low_pass_required: true, ..settings };
        let varied = varied.with_alpha(self.alphas[a]);
        for b in 0..self.betas.len() {
            let settings = varied.clone().with_beta(self.betas[if has_rows { b } else { 0 }]);
            let is_new = has_rows && !keeps_low_pass;
            let same =
                if is_new { None } else { self.runs.iter().rposition(|run| *run == settings) };
            let run = same.unwrap_or(self.runs.len());
            if same.is_none() {
                self.runs.push(settings);
            }
            self.combinations.push(Combination { levels: [m, p, a, b], run });
        }
    }

    /// The settings that are run, each once.
    pub fn runs(&self) -> &[Settings] {
        &self.runs
    }

    /// All combinations; the values of β vary fastest.
    pub fn combinations(&self) -> &[Combination] {
        &self.combinations
    }

    /// The methods that are tried, and what is not varied.
    pub fn bases(&self) -> &[Base] {
        &self.bases
    }

    /// The low-passes that are tried.
    pub fn passbands(&self) -> &[Option<LowPass>] {
        &self.passbands
    }

    /// The values of α that are tried.
    pub fn alphas(&self) -> &[Length] {
        &self.alphas
    }

    /// The values of β that are tried.
    pub fn betas(&self) -> &[Length] {
        &self.betas
    }

    /// How many values of `factor` there are.
    pub fn levels(&self, factor: Factor) -> usize {
        match factor {
            Factor::Method => self.bases.len(),
            Factor::Passband => self.passbands.len(),
            Factor::Alpha => self.alphas.len(),
            Factor::Beta => self.betas.len(),
        }
    }

    /// The combinations with the value `level` of `factor`, of methods that it applies to.
    pub fn at(&self, factor: Factor, level: usize) -> impl Iterator<Item = &Combination> {
        let index = factor as usize;
        let has = move |one: &&Combination| one.levels.get(index) == Some(&level);
        self.combinations.iter().filter(has).filter(move |one| self.applies(one, factor))
    }

    /// Sets of combinations that differ in `factor` alone, as indices.
    pub(super) fn lines(&self, factor: Factor) -> impl Iterator<Item = Vec<usize>> {
        let index = factor as usize;
        let faster = Factor::ALL.iter().skip(index + 1).map(|factor| self.levels(*factor));
        let stride: usize = faster.product();
        let count = self.levels(factor);
        let first = move |one: &Combination| one.levels.get(index) == Some(&0);
        let starts = self.combinations.iter().enumerate();
        let starts = starts.filter(move |(_, one)| first(one) && self.applies(one, factor));
        starts.map(move |(start, _)| (0..count).map(|n| start + n * stride).collect())
    }

    /// Whether `factor` applies to the method of a combination.
    fn applies(&self, one: &Combination, factor: Factor) -> bool {
        let [method, ..] = one.levels;
        let applies = |base: &Base| match factor {
            Factor::Method | Factor::Alpha => true,
            Factor::Passband => !base.keeps_low_pass,
            Factor::Beta => !base.settings.method.spec().has_intervals,
        };
        self.bases.get(method).is_some_and(applies)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;

    /// Two methods, of which the one that is given keeps its own low-pass.
    fn grid(kept: Option<Method>) -> Grid {
        let bases = [Method::TWO_LINE, Method::HINGE].map(|method| Base {
            settings: Settings::of(method),
            keeps_low_pass: kept == Some(method),
        });
        let slow = Some(LowPass { cutoff_hz: 2.0, order: 4 });
        Grid::new(bases.to_vec(), vec![slow, None], vec![10], vec![1, 2, 5])
    }

    fn runs(grid: &Grid) -> Vec<usize> {
        grid.combinations().iter().map(|one| one.run).collect()
    }

    #[test]
    fn what_is_the_same_is_run_once() {
        let all = grid(None);
        assert_eq!(runs(&all), [0, 1, 2, 3, 4, 5, 6, 6, 6, 7, 7, 7]);
        assert_eq!((all.runs()[4].beta, all.runs()[4].low_pass), (2, None));
        let kept = grid(Some(Method::HINGE));
        assert_eq!(runs(&kept), [0, 1, 2, 3, 4, 5, 6, 6, 6, 6, 6, 6]);
        assert_eq!(kept.runs()[6].low_pass, Settings::of(Method::HINGE).low_pass);
    }

    #[test]
    fn a_line_varies_one_setting_alone() {
        let all = grid(None);
        let lines = |grid: &Grid, factor| grid.lines(factor).collect::<Vec<_>>();
        // The onsets of a model do not come in steps of β.
        assert_eq!(lines(&all, Factor::Beta), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(lines(&all, Factor::Passband)[1], [1, 4]);
        assert_eq!(lines(&all, Factor::Method)[2], [2, 8]);
        assert_eq!(all.at(Factor::Beta, 0).count(), 2);
        assert_eq!(all.at(Factor::Passband, 0).count(), 6);
        assert_eq!(lines(&grid(Some(Method::HINGE)), Factor::Passband).len(), 3);
    }
}
