//! Equations of several lines, parsed.

use super::grammar::{self, Names, Problem, SyntaxError};
use super::signals::{OTHERS, signals};
use super::tree::{Name, Node};
use crate::effect::Stage;

/// What [`Equations`](crate::effect::Equations) call the result.
pub(crate) const RESULT: &str = "out";

/// Lines of equations, and the names in them.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) lines: Vec<Line>,
    pub(crate) locals: Vec<String>,
    /// Names of the signals of the stage.
    pub(crate) signals: &'static [&'static str],
}

/// One equation.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// Memory, or a local name.
    pub(crate) to: Name,
    pub(crate) value: Node,
}

impl Program {
    /// The equations in `text`, of an effect of `stage` with these parameters and memory.
    ///
    /// # Errors
    /// [`SyntaxError`], with the line.
    pub(crate) fn parse(
        text: &str,
        stage: Stage,
        parameters: &[&str],
        memory: &[&str],
    ) -> Result<Self, SyntaxError> {
        let mut program = Self { lines: Vec::new(), locals: Vec::new(), signals: signals(stage) };
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let error = |problem| SyntaxError { text: line.to_owned(), column: 1, problem };
            let missing = || error(Problem::Expected("a name, ` = ` and an expression"));
            let (name, value) = line.split_once(" = ").ok_or_else(missing)?;
            let locals: Vec<&str> = program.locals.iter().map(String::as_str).collect();
            let names = Names { signals: program.signals, parameters, memory, locals: &locals };
            let value = grammar::parse(value, names)?;
            let to = match names.find(name) {
                None => Name::Local(program.locals.len()),
                Some(to @ Name::Memory(_)) => to,
                Some(_) => return Err(error(Problem::Expected("a name that is not taken"))),
            };
            if to == Name::Local(program.locals.len()) {
                program.locals.push(name.to_owned());
            }
            program.lines.push(Line { to, value });
        }
        Ok(program)
    }

    /// Whether its last line gives the result.
    pub(crate) fn gives_result(&self) -> bool {
        let last = self.lines.last().map(|line| line.to);
        let result = self.locals.iter().position(|local| local.eq_ignore_ascii_case(RESULT));
        result.map(Name::Local) == last && last.is_some()
    }

    /// Whether it uses the activity of other joints.
    pub(crate) fn uses_others(&self) -> bool {
        let others = self.signals.iter().position(|signal| *signal == OTHERS);
        let Some(others) = others else { return false };
        let is_others =
            |node: &Node| matches!(node, Node::Named(Name::Signal(index)) if *index == others);
        self.lines.iter().any(|line| line.value.has(&is_others))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::define;
    use super::super::signals::{of_change, of_moment};
    use super::super::tree::Scope;
    use super::*;
    use crate::effect::{
        Definition, Effect, InputChange, Moment, OwnParameter, OwnState, REGISTRY, Stage,
    };

    /// The equations of an effect, ready to run.
    struct Runner {
        settle: Program,
        step: Program,
        memory: Vec<f64>,
    }

    impl Runner {
        fn new(effect: &dyn Effect) -> Self {
            let id = effect.spec().id;
            let equations =
                effect.spec().equations.unwrap_or_else(|| panic!("{id} has no equations"));
            let names: Vec<_> = effect.spec().parameters.iter().map(|p| p.name).collect();
            let parse = |text: &str| {
                Program::parse(text, effect.spec().stage, &names, equations.memory).unwrap()
            };
            let (settle, step) = (parse(equations.settle), parse(&equations.step.concat()));
            assert!(step.gives_result(), "{id}");
            Self { settle, step, memory: vec![0.0; equations.memory.len()] }
        }

        fn settle(&mut self, signals: &[f64], parameters: &[f64]) -> f64 {
            run(&self.settle, &mut self.memory, signals, parameters)
        }

        fn step(&mut self, signals: &[f64], parameters: &[f64]) -> f64 {
            run(&self.step, &mut self.memory, signals, parameters)
        }
    }

    fn run(program: &Program, memory: &mut [f64], signals: &[f64], parameters: &[f64]) -> f64 {
        let mut locals = Vec::new();
        for line in &program.lines {
            let value = line.value.value(&Scope { signals, parameters, memory, locals: &locals });
            match line.to {
                Name::Memory(index) => memory[index] = value,
                _ => locals.push(value),
            }
        }
        locals.last().copied().unwrap_or(f64::NAN)
    }

    /// Parameters of an effect: each at a part of its range, the ranges kept to what machines
    /// have.
    fn parameters(effect: &dyn Effect, parts: &[f64]) -> Vec<f64> {
        let of = |(parameter, part): (&crate::effect::Parameter, &f64)| {
            let (low, high) = (parameter.min.max(-3.0), parameter.max.min(3.0));
            low + part * part * (high - low)
        };
        effect.spec().parameters.iter().zip(parts).map(of).collect()
    }

    /// An effect of one's own that remembers two numbers.
    fn with_states() -> &'static dyn Effect {
        let start = "abs(signal)".to_owned();
        let sum = OwnState { start, ..OwnState::new("sum", "sum + rate * abs(x) * dt") };
        let states = vec![sum, OwnState::new("x", "x + (signal - x) * min(1, dt / (rate + sum))")];
        define(Definition {
            id: "own_states".to_owned(),
            summary: None,
            stage: Stage::Dynamics,
            expression: "x / (1 + rate * sum)".to_owned(),
            states,
            parameters: vec![OwnParameter::new("rate", 0.5)],
        })
        .unwrap()
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-10 * a.abs().max(b.abs()).max(1.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn the_equations_of_each_effect_are_what_it_does(
            parts in proptest::collection::vec(0.0..1.0, 12),
            held in -4.0..4.0,
            signals in proptest::collection::vec((-4.0..4.0, -50.0..50.0, -9.0..9.0, 0.0..1.0), 12),
            dt_s in prop_oneof![Just(0.01), Just(1e-4), 0.001..0.3],
        ) {
            for effect in REGISTRY.iter().copied().chain([with_states()]) {
                let parameters = parameters(effect, &parts);
                let mut runner = Runner::new(effect);
                let mut memory = vec![0.0; effect.spec().memory];
                let at = |signal, position, velocity, others, time_s| Moment {
                    signal, position, velocity, time_s, dt_s, others,
                    measured: f64::NAN, radians_per_output_unit: 1_f64.to_radians(),
                };
                let start = at(held, 0.0, 0.0, 0.0, 0.0);
                effect.settle(&parameters, &mut memory, &start);
                runner.settle(&of_moment(&start), &parameters);
                for (k, (signal, position, velocity, others)) in signals.iter().enumerate() {
                    let time_s = 7.0 * k as f64;
                    let now = at(*signal, *position, *velocity, *others, time_s);
                    let change =
                        InputChange { before: *position, after: *signal, held_s: others * 9.0, time_s };
                    let (expected, found) = if effect.spec().stage == Stage::Transport {
                        let expected = effect.extra_delay_s(&parameters, &change);
                        (expected, runner.step(&of_change(&change), &parameters))
                    } else {
                        let expected = effect.step(&parameters, &mut memory, &now);
                        (expected, runner.step(&of_moment(&now), &parameters))
                    };
                    let id = effect.spec().id;
                    prop_assert!(close(expected, found), "{id} {parameters:?}: {found}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn a_line_that_gives_nothing_is_refused_with_its_place() {
        let parse = |text: &str| Program::parse(text, Stage::Input, &["gap"], &["state"]);
        for (text, column) in
            [("signal + gap", 1), ("gap = 1", 1), ("a = 1\na = 2", 1), ("out = sgnal", 1)]
        {
            assert_eq!(parse(text).unwrap_err().column, column, "{text}");
        }
        assert!(parse("state = signal\nout = state + gap").unwrap().gives_result());
        assert!(!parse("out = 1\nstate = out").unwrap().gives_result());
    }
}
