//! Statistics on simulated joints whose truth is known: the figures of the documents.
//!
//! Each statistic prints a table or a page to standard output, and takes minutes to hours; the
//! tests beside them are the same on a sample of seconds.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

mod dead_time_coverage;
mod delay_methods;
mod design_power;
mod design_validation;
mod doubt_order;
mod fit_coverage;
mod hidden_effect_table;
mod in_order;
mod stroke_coverage;

use clap::Parser as _;

/// Statistics on simulated joints whose truth is known
#[derive(Debug, clap::Parser)]
enum Statistic {
    DeadTimeCoverage(dead_time_coverage::Args),
    DelayMethods(delay_methods::Args),
    DesignPower(design_power::Args),
    DesignValidation(design_validation::Args),
    DoubtOrder(doubt_order::Args),
    FitCoverage(fit_coverage::Args),
    HiddenEffectTable(hidden_effect_table::Args),
    StrokeCoverage(stroke_coverage::Args),
}

fn main() -> anyhow::Result<()> {
    match Statistic::parse() {
        Statistic::DeadTimeCoverage(args) => dead_time_coverage::run(&args),
        Statistic::DelayMethods(args) => delay_methods::run(&args),
        Statistic::DesignPower(args) => design_power::run(&args),
        Statistic::DesignValidation(args) => design_validation::run(&args),
        Statistic::DoubtOrder(args) => doubt_order::run(&args),
        Statistic::FitCoverage(args) => fit_coverage::run(&args),
        Statistic::HiddenEffectTable(args) => hidden_effect_table::run(&args),
        Statistic::StrokeCoverage(args) => stroke_coverage::run(&args),
    }
}
