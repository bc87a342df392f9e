//! `explain` as text.

use super::compare::{ComparedJoint, horizons};
use super::finding::Finding;
use super::parameters::model_text;
use super::ranking::ranking_table;

/// For each joint the verdict, the ranking and what they mean.
pub(crate) fn explain_text(findings: &[Finding<'_>]) -> String {
    let joint = |finding: &Finding<'_>| {
        let ComparedJoint { joint, comparison, .. } = finding.compared;
        let conclusion = finding.conclusion();
        let ranking = match finding.ranking {
            [] => String::new(),
            ranking => format!("{}\n", ranking_table(joint, ranking)),
        };
        let (text, model) = (conclusion.printed(), model_text(joint, comparison, None));
        format!("{}\n{ranking}\n{text}\n{model}\n", conclusion.headline)
    };
    let joints: Vec<String> = findings.iter().map(joint).collect();
    let horizon = horizons(findings.iter().map(|finding| finding.compared));
    format!(
        "{}\nroot-mean-square errors without the mean of each run, {horizon}\n",
        joints.join("\n\n")
    )
}
