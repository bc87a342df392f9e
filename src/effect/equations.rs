//! What an effect does, as text that can be written in other languages.

/// What an effect does, line by line in the notation of [expressions](super::expression).
///
/// ```text
/// name = expression
/// ```
///
/// A line gives a value to a number of the memory or to a name of its own, which the lines
/// below it may use; a name of its own is given a value once. Besides the signals of its
/// stage (those of an [expression](super::expression)) and its parameters a line may use the
/// memory, as it is then. The last line gives a value to `out`: the signal after the effect,
/// or in the transport stage the seconds by which a change of the input arrives later.
///
/// # Examples
/// ```
/// use tauscope::effect::Equations;
///
/// let hysteresis =
///     Equations::new(&["held = if(abs(signal - held) > width, signal, held)\nout = held"])
///         .remembering(&["held"], "held = signal");
/// assert_eq!(hysteresis.memory, ["held"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Equations {
    /// Names of what it remembers, all zero at first. A cache that
    /// [`step`](super::Effect::step) keeps to be faster is not part of it.
    pub memory: &'static [&'static str],
    /// What [`Effect::settle`](super::Effect::settle) does; it gives no `out`.
    pub settle: &'static str,
    /// What [`Effect::step`](super::Effect::step) does, or
    /// [`Effect::extra_delay_s`](super::Effect::extra_delay_s) in the transport stage: texts one
    /// after the other.
    pub step: &'static [&'static str],
}

impl Equations {
    /// These lines, without memory.
    pub const fn new(step: &'static [&'static str]) -> Self {
        Self { memory: &[], settle: "", step }
    }

    /// With this memory, which `settle` puts into the state of a signal that was long held.
    #[must_use]
    pub const fn remembering(self, memory: &'static [&'static str], settle: &'static str) -> Self {
        Self { memory, settle, ..self }
    }
}
