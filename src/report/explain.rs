//! `explain` as text.

use super::compare::parameters;
use super::finding::{Finding, ranking_table};
use super::words::printed;

/// For each joint the verdict, the ranking and what they mean.
pub fn explain_text(findings: &[Finding<'_>], horizon: &str) -> String {
    let joint = |finding: &Finding<'_>| {
        let words = finding.words();
        let ranking = match finding.ranking {
            [] => String::new(),
            ranking => format!("{}\n", ranking_table(finding.compared.joint, ranking)),
        };
        let (said, model) = (printed(&words), parameters(&finding.compared));
        format!("{}\n{ranking}\n{said}\nmodel of {model}\n", words.headline)
    };
    let joints: Vec<String> = findings.iter().map(joint).collect();
    format!("{}\nroot-mean-square errors, {horizon}\n", joints.join("\n\n"))
}
