//! An expression as an effect.

use super::super::interned::{Interned, part_of_interned, text_of_interned};
use super::super::{
    Definition, Effect, Equations, InputChange, Moment, OwnParameter, OwnState, Parameter,
    RecordRange, Spec, Stage, UNLIMITED, by_id, contract,
};
use super::DefinitionError;
use super::grammar::{self, Names, SyntaxError};
use super::signals::{POSITION, of_change, of_moment, signals};
use super::tree::{Name, Node, Scope};

/// The most states of an effect: with more it is a model of its own.
const MOST_STATES: usize = 8;

/// The word for it in a model file.
pub(crate) const KIND: &str = "expression";

/// An effect that computes an expression.
#[derive(Debug)]
struct Expression {
    definition: Definition,
    spec: &'static Spec,
    node: Node,
    states: Vec<State>,
    nests: bool,
}

/// The expressions of a state.
#[derive(Debug)]
struct State {
    start: Node,
    next: Node,
}

/// The effect that `definition` describes.
///
/// # Errors
/// [`DefinitionError`] when a name is taken, numbers do not go together, or the expression
/// cannot be computed.
///
/// # Examples
/// ```
/// use tauscope::effect::{Definition, OwnParameter, expression::define};
/// use tauscope::effect::Stage;
///
/// let hose = define(Definition {
///     id: "hose".to_owned(),
///     summary: None,
///     stage: Stage::Load,
///     expression: "signal / (1 + loss * abs(signal))".to_owned(),
///     states: Vec::new(),
///     parameters: vec![OwnParameter { min: Some(0.0), ..OwnParameter::new("loss", 0.1) }],
/// })?;
/// assert_eq!(hose.spec().id, "hose");
/// assert!(hose.nests());
/// # Ok::<(), tauscope::effect::expression::DefinitionError>(())
/// ```
pub fn define(definition: Definition) -> Result<&'static dyn Effect, DefinitionError> {
    static DEFINED: Interned<Expression> = Interned::none();
    let effect =
        DEFINED.get_or_try(definition, |one, of| one.definition == *of, Expression::new)?;
    Ok(effect)
}

impl Expression {
    fn new(definition: Definition) -> Result<Self, DefinitionError> {
        let signals = signals(definition.stage);
        check_names(&definition, signals)?;
        if let Some(fault) = definition.parameters.iter().find_map(OwnParameter::fault) {
            return Err(fault);
        }
        let parameters: Vec<_> = definition.parameters.iter().map(|p| p.name.as_str()).collect();
        let states: Vec<_> = definition.states.iter().map(|state| state.name.as_str()).collect();
        let names = Names { signals, parameters: &parameters, memory: &states, locals: &[] };
        let node = grammar::parse(&definition.expression, names)?;
        let parsed = definition.states.iter().map(|OwnState { start, next, .. }| {
            let start = grammar::parse(start, Names { memory: &[], ..names })?;
            Ok(State { start, next: grammar::parse(next, names)? })
        });
        let parsed: Vec<State> = parsed.collect::<Result<_, SyntaxError>>()?;
        let named = (0..).zip(&parameters).map(|(index, name)| (Name::Parameter(index), name));
        let named =
            named.chain((0..).zip(&states).map(|(index, name)| (Name::Memory(index), name)));
        for (known, name) in named {
            let is_it = |node: &Node| matches!(node, Node::Named(used) if *used == known);
            if !nodes(&node, &parsed).any(|node| node.has(&is_it)) {
                return Err(unusable(name, "is in no expression: use it, or take it out"));
            }
        }
        let spec = part_of_interned(specified(&definition));
        let mut new = Self { definition, spec, node, states: parsed, nests: true };
        if let Some(fault) = new.neutral_fault() {
            if new.definition.parameters.iter().any(|parameter| parameter.neutral.is_some()) {
                return Err(fault);
            }
            new.nests = false;
        }
        Ok(new)
    }

    /// The value of the expression, or what it must be to change nothing.
    fn or_else(&self, unchanged: f64, scope: &Scope<'_>) -> f64 {
        let value = self.node.value(scope);
        if value.is_finite() { value } else { unchanged }
    }

    /// What the neutral values change, at a handful of moments.
    fn neutral_fault(&self) -> Option<DefinitionError> {
        /// Part of the signal, or of 1, that rounding may make.
        const TOLERANCE: f64 = 1e-9;
        let neutral = self.spec.neutral();
        let mut memory = vec![0.0; self.states.len()];
        samples().find_map(|sample| {
            let (signal, found) = match self.spec.stage {
                Stage::Transport => (0.0, self.extra_delay_s(&neutral, &change(&sample))),
                _ => (sample.signal, self.step(&neutral, &mut memory, &sample)),
            };
            let is_same = (found - signal).abs() <= TOLERANCE * signal.abs().max(1.0);
            (!is_same).then_some(DefinitionError::NotNeutral { signal, found })
        })
    }
}

impl Effect for Expression {
    fn spec(&self) -> &'static Spec {
        self.spec
    }

    fn settle(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) {
        let signals = of_moment(at);
        let scope = Scope { signals: &signals, parameters, ..Scope::default() };
        for (state, own) in memory.iter_mut().zip(&self.states) {
            *state = finite_or(own.start.value(&scope), 0.0);
        }
    }

    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        if self.spec.stage == Stage::Transport {
            return at.signal;
        }
        let signals = of_moment(at);
        if !self.states.is_empty() {
            let mut before = [0.0; MOST_STATES];
            for (before, state) in before.iter_mut().zip(memory.iter()) {
                *before = *state;
            }
            let scope =
                Scope { signals: &signals, parameters, memory: &before, ..Scope::default() };
            for (state, own) in memory.iter_mut().zip(&self.states) {
                *state = finite_or(own.next.value(&scope), *state);
            }
        }
        let scope = Scope { signals: &signals, parameters, memory, ..Scope::default() };
        self.or_else(at.signal, &scope)
    }

    fn extra_delay_s(&self, parameters: &[f64], change: &InputChange) -> f64 {
        if self.spec.stage != Stage::Transport {
            return 0.0;
        }
        let signals = of_change(change);
        self.or_else(0.0, &Scope { signals: &signals, parameters, ..Scope::default() })
    }

    fn nests(&self) -> bool {
        self.nests
    }

    fn depends_on_angle(&self) -> bool {
        let names = signals(self.spec.stage);
        let is_position = |index: usize| names.get(index) == Some(&POSITION);
        let by_stage = matches!(self.spec.stage, Stage::Load | Stage::Output);
        let has = |node: &Node| {
            node.has(&|node| matches!(node, Node::Named(Name::Signal(p)) if is_position(*p)))
        };
        by_stage || nodes(&self.node, &self.states).any(has)
    }

    fn definition(&self) -> Option<&Definition> {
        Some(&self.definition)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let own = self.definition.parameters.iter().zip(self.spec.parameters);
        let within = |(own, parameter): (&OwnParameter, &Parameter)| {
            let (min, max) = own.bounds();
            Parameter { min, max, ..*parameter }.bounds(record)
        };
        own.map(within).collect()
    }

    /// The start values of the definition; away from neutral where they are neutral.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let own = self.definition.parameters.iter().zip(self.spec.parameters);
        let start = |(own, parameter): (&OwnParameter, &Parameter)| {
            let given = own.start.filter(|start| (start - parameter.neutral).abs() > 0.0);
            given.unwrap_or_else(|| parameter.start(record))
        };
        vec![own.map(start).collect()]
    }
}

impl OwnParameter {
    /// Lowest and highest value of a fit.
    pub(super) fn bounds(&self) -> (f64, f64) {
        (self.min.unwrap_or(-UNLIMITED), self.max.unwrap_or(UNLIMITED))
    }

    /// As the specification has it: its range holds the neutral value, too.
    pub(super) fn specified(&self) -> Parameter {
        let neutral = self.neutral.unwrap_or(0.0);
        let (min, max) = self.bounds();
        Parameter {
            neutral,
            min: min.min(neutral),
            max: max.max(neutral),
            fitted: !self.fixed,
            ..Parameter::new(
                text_of_interned(self.name.as_str()),
                "a number in the expression",
                self.dimension,
            )
        }
    }

    /// What is wrong with its numbers.
    pub(super) fn fault(&self) -> Option<DefinitionError> {
        let (min, max) = self.bounds();
        let neutral = self.neutral.unwrap_or(0.0);
        let is_finite = [min, max, neutral].iter().all(|number| number.is_finite());
        let value = self.start.unwrap_or(min);
        let holds = is_finite && min <= max && (min..=max).contains(&value);
        let parameter = self.name.clone();
        (!holds).then_some(DefinitionError::Range { parameter, value, min, max, neutral })
    }
}

/// All expressions of an effect.
fn nodes<'a>(node: &'a Node, states: &'a [State]) -> impl Iterator<Item = &'a Node> {
    let of_states = states.iter().flat_map(|State { start, next }| [start, next]);
    std::iter::once(node).chain(of_states)
}

fn finite_or(value: f64, other: f64) -> f64 {
    if value.is_finite() { value } else { other }
}

fn unusable(name: &str, problem: &'static str) -> DefinitionError {
    DefinitionError::Name { name: name.to_owned(), problem }
}

fn check_names(definition: &Definition, signals: &[&str]) -> Result<(), DefinitionError> {
    let Definition { id, parameters, states, .. } = definition;
    let own = parameters.iter().map(|each| &each.name);
    let own: Vec<&String> = own.chain(states.iter().map(|each| &each.name)).collect();
    let mut names = std::iter::once(id).chain(own.iter().copied());
    if let Some(name) = names.find(|name| !contract::is_snake_case(name)) {
        let problem = "is not in snake case: small letters, digits and `_`, a letter first";
        return Err(unusable(name, problem));
    }
    if by_id(id).is_some() || id == KIND {
        return Err(unusable(id, "is taken; give the effect an id of its own"));
    }
    for (index, name) in own.iter().enumerate() {
        let mut before = own.iter().take(index);
        let is_taken = signals.contains(&name.as_str()) || grammar::is_taken(name);
        if is_taken || before.any(|other| other == name) {
            let problem = "is a name that is taken: rename the parameter or the state";
            return Err(unusable(name, problem));
        }
    }
    if definition.stage == Stage::Transport && !states.is_empty() {
        return Err(DefinitionError::States);
    }
    if states.len() > MOST_STATES {
        return Err(DefinitionError::TooManyStates { states: states.len(), most: MOST_STATES });
    }
    Ok(())
}

fn specified(definition: &Definition) -> Spec {
    let behind = if definition.stage == Stage::Transport { "extra delay" } else { "out" };
    let parameters: Vec<_> = definition.parameters.iter().map(OwnParameter::specified).collect();
    let summary = definition.summary.as_deref().unwrap_or("an effect of one's own");
    let text = text_of_interned;
    let states =
        definition.states.iter().map(|state| format!("; next {} = {}", state.name, state.next));
    let states: String = states.collect();
    Spec::new(text(definition.id.as_str()), definition.stage, text(summary))
        .equation(text_of_interned(format!("{behind} = {}{states}", definition.expression)))
        .memory(definition.states.len())
        .source("the model file")
        .parameters(part_of_interned(parameters))
        .equations(equations(definition))
}

/// The equations of a definition. Names in capital letters are free: its parameters have none.
fn equations(Definition { stage, states, expression, .. }: &Definition) -> Equations {
    let unchanged = if *stage == Stage::Transport { "0" } else { "signal" };
    let finite = |name: &str, other: &str| format!("if(is_finite({name}), {name}, {other})");
    // All states change together.
    let next = states.iter().map(|OwnState { name, next, .. }| format!("NEXT_{name} = {next}\n"));
    let becomes = states.iter().map(|OwnState { name, .. }| {
        format!("{name} = {}\n", finite(&format!("NEXT_{name}"), name))
    });
    let settle = states.iter().map(|OwnState { name, start, .. }| {
        format!("START_{name} = {start}\n{name} = {}\n", finite(&format!("START_{name}"), "0"))
    });
    let (settle, states_next): (String, String) = (settle.collect(), next.chain(becomes).collect());
    let out = finite("VALUE", unchanged);
    let step = text_of_interned(format!("{states_next}VALUE = {expression}\nOUT = {out}"));
    let memory: Vec<_> = states.iter().map(|state| text_of_interned(state.name.as_str())).collect();
    Equations::new(part_of_interned([step]))
        .remembering(part_of_interned(memory), text_of_interned(settle))
}

/// Moments at which an effect without an effect is seen to have one: signals of either
/// sign up to 1000, at several angles and times.
fn samples() -> impl Iterator<Item = Moment> {
    let sizes = [0.0, 0.01, 0.7, 3.0, 45.0, 1000.0];
    let signals = sizes.into_iter().flat_map(|size| [size, -size]);
    let states = [(0.0, 0.0, 0.0, 0.0), (30.0, -2.0, 12.0, 0.4), (-170.0, 25.0, 3600.0, 1.0)];
    signals.flat_map(move |signal| {
        states.map(|(position, velocity, time_s, others)| Moment {
            position,
            velocity,
            time_s,
            others,
            ..Moment::of(signal)
        })
    })
}

/// A change of the input at this moment.
fn change(at: &Moment) -> InputChange {
    let (before, held_s) = (0.1 * at.position, at.velocity.abs());
    InputChange { before, after: at.signal, held_s, time_s: at.time_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Dimension;
    use crate::effect::contract::{Fault, check};
    use crate::effect::testing::{assert_close, moment, run};

    fn definition(stage: Stage, expression: &str, parameters: &[OwnParameter]) -> Definition {
        let (id, parameters) = ("own".to_owned(), parameters.to_vec());
        let (expression, states) = (expression.to_owned(), Vec::new());
        Definition { id, summary: None, stage, expression, states, parameters }
    }

    fn own(expression: &str, parameters: &[OwnParameter]) -> &'static dyn Effect {
        define(definition(Stage::Input, expression, parameters)).unwrap()
    }

    fn number(name: &str, neutral: f64) -> OwnParameter {
        OwnParameter { neutral: Some(neutral), ..OwnParameter::new(name, 0.5) }
    }

    #[test]
    fn the_result_is_the_signal_behind_it() {
        let text = "if(signal > start, start + slope * (signal - start), signal)";
        let knee = own(text, &[number("start", 0.0), number("slope", 1.0)]);
        assert_close(&run(knee, &[1.0, 0.5], &[-2.0, 0.5, 1.0, 3.0]), &[-2.0, 0.5, 1.0, 2.0]);
        assert!(knee.nests());
    }

    #[test]
    fn every_signal_has_its_name() {
        let text = "signal + 10 * position + 100 * velocity + 1000 * time + 1e4 * dt + 1e5 * others
            + 1e6 * radians";
        let at = Moment {
            signal: 1.0,
            position: 2.0,
            velocity: 3.0,
            time_s: 4.0,
            dt_s: 5.0,
            others: 6.0,
            measured: f64::NAN,
            radians_per_output_unit: 7.0,
        };
        assert_close(&[own(text, &[]).step(&[], &mut [], &at)], &[7_654_321.0]);
        let text = "before + 10 * after + 100 * held + 1000 * time";
        let delay = define(definition(Stage::Transport, text, &[])).unwrap();
        let change = InputChange { before: 1.0, after: 2.0, held_s: 3.0, time_s: 4.0 };
        assert_close(&[delay.extra_delay_s(&[], &change)], &[4321.0]);
        assert_close(&[delay.step(&[], &mut [], &at)], &[1.0]);
    }

    #[test]
    fn effects_of_every_stage_keep_the_contract() {
        let bounded = OwnParameter { min: Some(-0.9), max: Some(0.9), ..number("k", 0.0) };
        for (stage, text) in [
            (Stage::Input, "sign(signal) * abs(signal)^(1 + k)"),
            (Stage::Dynamics, "signal * exp(-k * time)"),
            (Stage::Load, "signal * sqrt(1 - k * cos(position * radians))"),
            (Stage::Output, "signal + k * sin(2 * pi * signal / 360)"),
            (Stage::Transport, "k * abs(after - before) + ln(1 + k)"),
            (Stage::Load, "signal + k / 0 * 0"),
        ] {
            let effect = define(definition(stage, text, std::slice::from_ref(&bounded))).unwrap();
            assert_eq!(check(effect), Ok(()), "{text}");
            assert!(effect.nests(), "{text}");
        }
    }

    #[test]
    fn what_is_not_a_number_changes_nothing() {
        let root = own("sqrt(signal)", &[]);
        assert_close(&run(root, &[], &[4.0, -4.0]), &[2.0, -4.0]);
        let broken = own("signal / 0 + k", &[OwnParameter::new("k", 1.0)]);
        assert_close(&run(broken, &[1.0], &[4.0]), &[4.0]);
        assert_close(&run(broken, &[], &[4.0]), &[4.0]);
    }

    #[test]
    fn without_a_neutral_point_it_does_not_nest() {
        let always = own("signal / (1 + abs(signal))", &[]);
        assert!(!always.nests());
        assert_eq!(check(always), Ok(()));
        let promised = definition(Stage::Input, "signal + k", &[number("k", 1.0)]);
        let error = define(promised).unwrap_err();
        assert!(matches!(error, DefinitionError::NotNeutral { .. }), "{error}");
        let delay = define(definition(Stage::Transport, "0.1", &[])).unwrap();
        assert!(!delay.nests());
    }

    #[test]
    fn neutral_may_lie_outside_the_bounds_of_a_fit() {
        let start = OwnParameter { min: Some(0.0), max: Some(5.0), ..number("start", 1e3) };
        let limit = own("min(signal, start)", &[start]);
        let parameter = limit.spec().parameters[0];
        assert_close(&[parameter.min, parameter.neutral, parameter.max], &[0.0, 1e3, 1e3]);
        assert_eq!(limit.bounds(&RecordRange::default()), [(0.0, 5.0)]);
        assert_eq!(limit.starts(&RecordRange::default()), [[0.5]]);
        // Beyond the signals at which that is tested it is not neutral at all.
        assert!(matches!(check(limit).unwrap_err().fault, Fault::NotNeutral { .. }));
    }

    #[test]
    fn a_fit_starts_at_the_given_value_or_away_from_neutral() {
        let level =
            OwnParameter { start: Some(0.0), dimension: Dimension::Input, ..number("level", 0.0) };
        let effect = own("signal - level + k", &[level, number("k", 0.0)]);
        let record = RecordRange { input_abs_max: 4.0, ..RecordRange::default() };
        assert_close(&effect.starts(&record)[0], &[0.4, 0.5]);
        assert_eq!(effect.bounds(&record), [(-4.0, 4.0), (-UNLIMITED, UNLIMITED)]);
    }

    #[test]
    fn the_same_definition_is_the_same_effect() {
        let twice = [own("signal * 1", &[]), own("signal * 1", &[])];
        assert!(std::ptr::eq(twice[0].spec(), twice[1].spec()));
        assert!(!std::ptr::eq(twice[0].spec(), own("signal * 2", &[]).spec()));
    }

    #[test]
    fn names_that_are_taken_are_refused() {
        let error = |definition: Definition| define(definition).unwrap_err().to_string();
        let id = |id: &str| Definition { id: id.to_owned(), ..definition(Stage::Load, "1", &[]) };
        assert!(error(id("dead_band")).contains("`dead_band` is taken"));
        assert!(error(id("expression")).contains("is taken"));
        assert!(error(id("My knee")).contains("not in snake case"));
        for name in ["signal", "sqrt", "pi", "if"] {
            let given = definition(Stage::Load, "1", &[OwnParameter::new(name, 1.0)]);
            assert!(error(given).contains(&format!("`{name}` is a name that is taken")));
        }
        let twice = [OwnParameter::new("k", 1.0), OwnParameter::new("k", 2.0)];
        assert!(error(definition(Stage::Load, "1", &twice)).contains("`k` is a name"));
        // `before` is a signal of another stage, and `signal` none of the transport's.
        assert!(
            define(definition(Stage::Load, "before", &[OwnParameter::new("before", 1.0)])).is_ok()
        );
        let transport = error(definition(Stage::Transport, "signal", &[]));
        assert_eq!(transport, "the expression cannot be computed");
    }

    #[test]
    fn numbers_that_do_not_go_together_are_refused() {
        let own = |own: OwnParameter| define(definition(Stage::Load, "signal + k", &[own]));
        for wrong in [
            OwnParameter::new("k", f64::NAN),
            OwnParameter { min: Some(1.0), ..OwnParameter::new("k", 0.0) },
            OwnParameter { max: Some(f64::INFINITY), ..OwnParameter::new("k", 0.0) },
            OwnParameter { neutral: Some(f64::NAN), ..OwnParameter::new("k", 0.0) },
        ] {
            assert!(matches!(own(wrong), Err(DefinitionError::Range { .. })));
        }
    }

    #[test]
    fn it_depends_on_the_angle_where_it_says_so() {
        let on = |stage, text| define(definition(stage, text, &[])).unwrap().depends_on_angle();
        assert!(on(Stage::Input, "if(signal > 0, signal, signal * abs(position))"));
        assert!(!on(Stage::Dynamics, "signal * exp(-time)"));
        assert!(on(Stage::Load, "2 * signal"));
        assert!(!on(Stage::Transport, "0 * before"));
    }

    #[test]
    fn a_parameter_without_a_use_is_refused() {
        let k = OwnParameter::new("k", 1.0);
        let error = define(definition(Stage::Load, "if(signal > 0, signal, -signal)", &[k]));
        assert!(matches!(error, Err(DefinitionError::Name { name, .. }) if name == "k"));
    }

    /// A first-order lag, sampled at the ends of intervals.
    fn lag() -> Definition {
        let next = "x + (signal - x) * (1 - exp(-dt / lag))";
        let states = vec![OwnState::new("x", next)];
        Definition { states, ..definition(Stage::Dynamics, "x", &[OwnParameter::new("lag", 0.1)]) }
    }

    #[test]
    fn a_state_goes_on_from_moment_to_moment() {
        let lag = define(lag()).unwrap();
        assert!(lag.nests(), "without a lag it follows at once");
        let mut memory = vec![0.0; lag.spec().memory];
        lag.settle(&[0.05], &mut memory, &moment(2.0));
        let outputs: Vec<f64> =
            (0..4).map(|_| lag.step(&[0.05], &mut memory, &moment(3.0))).collect();
        let expected: Vec<f64> = (1..5).map(|k| 3.0 - (-0.2 * f64::from(k)).exp()).collect();
        assert_close(&outputs, &expected);
    }

    #[test]
    fn states_change_together() {
        let state = |name: &str, start: &str, next: &str| OwnState {
            start: start.to_owned(),
            ..OwnState::new(name, next)
        };
        let states = vec![state("a", "1", "b"), state("b", "2", "a")];
        let swap = Definition { states, ..definition(Stage::Input, "signal * (a - b)", &[]) };
        let swap = define(swap).unwrap();
        let mut memory = vec![0.0; 2];
        swap.settle(&[], &mut memory, &moment(1.0));
        let outputs: Vec<f64> = (0..3).map(|_| swap.step(&[], &mut memory, &moment(1.0))).collect();
        assert_close(&outputs, &[1.0, -1.0, 1.0]);
    }

    #[test]
    fn states_that_make_no_sense_are_refused() {
        let error = |definition: Definition| define(definition).unwrap_err().to_string();
        let with = |states: Vec<OwnState>| Definition { states, ..lag() };
        assert!(error(with(Vec::new())).contains("cannot be computed"), "`x` is not known");
        let named = OwnState::new("lag", "lag");
        assert!(error(with(vec![named])).contains("`lag` is a name that is taken"));
        let unused = [lag().states, vec![OwnState::new("y", "signal")]].concat();
        assert!(error(with(unused)).contains("`y` is in no expression"));
        let transport = Definition { stage: Stage::Transport, ..lag() };
        assert!(error(transport).contains("no states"));
        let many: Vec<_> = (0..9).map(|k| OwnState::new(&format!("s{k}"), "signal")).collect();
        assert!(error(with(many)).contains("9 states; 8 are the most"));
        // A start knows no other state.
        let circular = OwnState { start: "x".to_owned(), ..OwnState::new("x", "signal") };
        assert!(error(with(vec![circular])).contains("cannot be computed"));
    }

    #[test]
    fn it_runs_on_several_threads() {
        let effect = own("signal * 3", &[]);
        let run = || effect.step(&[], &mut [], &moment(2.0));
        std::thread::scope(|scope| {
            let threads = [scope.spawn(run), scope.spawn(run)];
            assert!(threads.into_iter().all(|thread| (thread.join().unwrap() - 6.0).abs() < 1e-9));
        });
    }
}
