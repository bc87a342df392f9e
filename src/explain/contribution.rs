//! To which effects the fall of an error is attributed.

/// What an effect of a model carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Contribution {
    /// Its id.
    pub effect: &'static str,
    /// What the error beyond the noise grows by without it, in parts of that of the first model.
    pub error_share: f64,
    /// The error that the model has without it, the rest fitted again, output units: on the part that
    /// was not fitted, where there is one.
    pub error_without: f64,
    /// What leaves as little in its place: an effect, or two together.
    pub alternatives: Vec<Vec<&'static str>>,
    /// Effects that would not show beside it: what they do, its parameters do too.
    pub hidden: Vec<&'static str>,
}

impl Contribution {
    /// What leaves as little in its place, in names: `gravity_load`, or `leakage + input_offset` for a leakage
    /// beside which an offset would not show.
    pub fn alternative_names(&self) -> Vec<String> {
        let others = self.alternatives.iter().map(|effects| effects.join(" + "));
        others.chain(self.hidden.iter().map(|id| format!("{} + {id}", self.effect))).collect()
    }
}

/// To which effects the fall of the error is attributed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribution {
    /// Effects with consequence, the largest share first.
    pub found: Vec<Contribution>,
    /// Effects of the model that lower the error, and take less of it than remains unexplained beside
    /// them: each may be the nearest of the known effects to one that is not known.
    pub doubtful: Vec<Contribution>,
    /// Effects that are significant, and that have no practical consequence.
    pub refinements: Vec<&'static str>,
}

impl Attribution {
    /// Whether effects lower the error, and each of them is doubtful.
    pub(super) fn is_doubtful_throughout(&self) -> bool {
        self.found.is_empty() && !self.doubtful.is_empty()
    }
}
