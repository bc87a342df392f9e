//! What all options have in common, and how they are shown: the few that most people need first, the
//! others under the question to which they are the answer.

use clap::{Arg, Command};

/// The options that come first in the help of a command, in this order; of other commands all do.
const FIRST: [(&str, &str); 9] = [
    ("estimate", "output joint decisions steps format"),
    ("sweep", "output joint alpha beta passband"),
    ("compare", "model against output joint format"),
    ("explain", "model effects output joint format"),
    ("add", "model write output joint format"),
    ("improve", "model write output joint max-effects"),
    ("report", "output model improve interactive joint"),
    ("first-look", "output joint model effects max-effects"),
    ("design", "model output output-range duration trials"),
];

/// The headings of all other options.
const QUESTIONS: [(&str, &str); 15] = [
    ("The columns are not recognized", "joint time trial columns"),
    ("The clock is uneven, or samples are missing", "sample-period resample fill"),
    ("The input is noisy, or moves all the time", "min-step input"),
    ("How delays are found", "method max-delay interval interpolate tolerance"),
    ("Algorithm 1 of Albrecht and Taylor", "paper alpha beta passband filter-order"),
    (
        "Steps are accepted or rejected wrongly",
        "confidence min-delay output-limits min-slope-change max-sse accept-anyway review \
         review-sheet",
    ),
    (
        "Which model, and how it is fitted",
        "model write improve fit effects max-effects refine uncertainty",
    ),
    ("What the record decides (for experts)", "first-last keep-first-last horizon split"),
    ("Compare with another result", "against"),
    (
        "Which input is designed",
        "output-range duration trials levels largest hold rate start seed \
         separate power noise rehearsals",
    ),
    ("The log is still being written", "follow idle"),
    (
        "What is written",
        "output decisions delays table export preview embed no-recording interactive \
         title author date detail safe-csv",
    ),
    ("What is printed", "steps against-state format quiet"),
    ("Show it in a viewer while the command runs", "connect spawn serve"),
    ("Many logs, memory and processors", "results shard summary threads max-memory"),
];

/// `command` with options that take `-1` for their value, so that whoever typed it learns what is expected.
pub(super) fn with_negative_numbers(command: Command) -> Command {
    command.mut_args(|arg| {
        let is_option = arg.get_long().is_some() && arg.get_action().takes_values();
        arg.allow_negative_numbers(is_option)
    })
}

/// The options of `command` in their order, the first ones alone in its short help.
pub(super) fn arranged(command: Command) -> Command {
    let command = with_negative_numbers(command);
    let name = command.get_name().to_owned();
    let Some((_, first)) = FIRST.iter().find(|(known, _)| *known == name) else {
        return command;
    };
    let place = |arg: Arg| {
        let long = arg.get_long().unwrap_or_default().to_owned();
        let place_in = |options: &str| options.split_whitespace().position(|option| option == long);
        let of_questions = QUESTIONS.iter().find(|(_, options)| place_in(options).is_some());
        match (place_in(first), of_questions) {
            (Some(place), _) => arg.help_heading(None).display_order(place),
            (None, Some((question, _))) => arg.help_heading(*question).hide_short_help(true),
            (None, None) => arg,
        }
    };
    let rest = format!("`tauscope {name} --help` shows all options.");
    command.mut_args(place).after_help(rest).after_long_help("")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_option_stands_under_one_question() {
        let mut all: Vec<&str> =
            QUESTIONS.iter().flat_map(|(_, options)| options.split_whitespace()).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
        let first = FIRST.iter().flat_map(|(_, options)| options.split_whitespace());
        let unknown: Vec<_> = first.filter(|option| !all.contains(option)).collect();
        assert_eq!(unknown, [""; 0]);
    }
}
