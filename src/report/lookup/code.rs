//! C99, MATLAB or GNU Octave, and Python 3, each without dependencies.
//!
//! The files `lookup.c`, `lookup.m` and `lookup.py` are what is written, with the joints left out. That
//! of MATLAB does without `interp1`, which in Octave calls a `lookup` of its own: a file may have that
//! name.

use super::contents::{JointLookup, Lookup, numbers, quoted, side, support};
use crate::delay::DelayCurve;

/// `template` with each text in the place of its mark; marks stand in the order of the template.
fn filled<const N: usize>(template: &str, texts: [(&str, &str); N]) -> String {
    let mut filled = String::new();
    let mut rest = template;
    for (mark, text) in texts {
        let (before, behind) = rest.split_once(mark).unwrap_or((rest, ""));
        filled.extend([before, text]);
        rest = behind;
    }
    filled + rest
}

/// Numbers by which C and MATLAB find a curve: kind of step, side, whether the input rises.
fn key(curve: &DelayCurve) -> String {
    let (kind, side, rises) = (curve.transition as u8, side(curve.side), u8::from(curve.rises));
    format!("{kind}, {side}, {rises}")
}

/// The file for C.
pub(super) fn c(lookup: &Lookup<'_>) -> String {
    let origin = lookup.commented(" * ").replace("??/", "?? /").replace("*/", "* /");
    let tables: String = lookup.joints.iter().enumerate().map(c_tables).collect();
    let joints: String = lookup.joints.iter().enumerate().map(c_joint).collect();
    let texts = [("{origin}", &*origin), ("{tables}", &*tables), ("{joints}", &*joints)];
    filled(include_str!("lookup.c"), texts)
}

fn c_joint((number, joint): (usize, &JointLookup<'_>)) -> String {
    // A trigraph may stand for the backslash before the mark that ends the text.
    let (name, count) = (quoted(joint.name).replace('?', "\\?"), joint.curves.len());
    let curves = if count > 0 { format!("curves_{number}") } else { "NULL".to_owned() };
    let [low, high] = joint.neutral_ends("INFINITY");
    format!("    {{{name}, {low}, {high}, {count}, {curves}}},\n")
}

/// The arrays of a joint.
fn c_tables((number, joint): (usize, &JointLookup<'_>)) -> String {
    if joint.curves.is_empty() {
        return String::new();
    }
    let curves = || joint.curves.iter().enumerate();
    let array = |(place, curve): (usize, &DelayCurve)| {
        let ((levels, delays), support) = (numbers(curve), support(curve));
        format!(
            "/* {support} */\n\
             static const double level_{number}_{place}[] = {{{levels}}};\n\
             static const double delay_{number}_{place}[] = {{{delays}}};\n"
        )
    };
    let row = |(place, curve): (usize, &DelayCurve)| {
        let (key, count) = (key(curve), curve.points.len());
        format!("    {{{key}, {count}, level_{number}_{place}, delay_{number}_{place}}},\n")
    };
    let (arrays, rows): (String, String) =
        (curves().map(array).collect(), curves().map(row).collect());
    format!("{arrays}static const tauscope_curve curves_{number}[] = {{\n{rows}}};\n\n")
}

/// The file for MATLAB; its function is called as the file is.
pub(super) fn matlab(lookup: &Lookup<'_>, name: &str) -> String {
    let (origin, upper) = (lookup.commented("%   "), name.to_uppercase());
    let joints: String = lookup.joints.iter().map(matlab_joint).collect();
    let texts = [
        ("{name}", name),
        ("{upper}", &*upper),
        ("{name}", name),
        ("{origin}", &*origin),
        ("{joints}", &*joints),
        ("{name}", name),
    ];
    filled(include_str!("lookup.m"), texts)
}

fn matlab_joint(joint: &JointLookup<'_>) -> String {
    let name = joint.name.replace('\'', "''");
    let [low, high] = joint.neutral_ends("Inf");
    let row = |curve: &DelayCurve| {
        let (levels, delays) = numbers(curve);
        format!("        {}, [{levels}], [{delays}] % {}\n", key(curve), support(curve))
    };
    let rows: String = joint.curves.iter().map(row).collect();
    let curves =
        if rows.is_empty() { "cell(0, 5)".to_owned() } else { format!("{{\n{rows}      }}") };
    format!("    case '{name}'\n      neutral = [{low}, {high}];\n      curves = {curves};\n")
}

/// The file for Python.
pub(super) fn python(lookup: &Lookup<'_>) -> String {
    let origin = lookup.commented("# ");
    let joints: String = lookup.joints.iter().map(python_joint).collect();
    filled(include_str!("lookup.py"), [("{origin}", &*origin), ("{joints}", &*joints)])
}

fn python_joint(joint: &JointLookup<'_>) -> String {
    let [low, high] = joint.neutral_ends("math.inf");
    let row = |curve: &DelayCurve| {
        let (levels, delays) = numbers(curve);
        let rises = if curve.rises { "True" } else { "False" };
        let (kind, side) = (curve.transition, side(curve.side));
        let support = support(curve);
        format!("        (\"{kind}\", {side}, {rises}): ([{levels}], [{delays}]),  # {support}\n")
    };
    let rows: String = joint.curves.iter().map(row).collect();
    format!("    {}: (({low}, {high}), {{\n{rows}    }}),\n", quoted(joint.name))
}
