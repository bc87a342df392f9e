//! A function of MATLAB and GNU Octave.

use super::contents::{JointLookup, Lookup, numbers, side, support};
use crate::delay::DelayCurve;

/// Without `interp1`, which in Octave calls a `lookup` of its own: a file may have that name.
const TAIL: &str = "\
  delay_s = NaN;
  before = (level_from > neutral(2)) - (level_from < neutral(1));
  after = (level_to > neutral(2)) - (level_to < neutral(1));
  if before == after
    transition = 2;
  elseif before == 0
    transition = 0;
  elseif after == 0
    transition = 1;
  else
    transition = 3;
  end
  side = after;
  level = level_to;
  if transition == 1
    side = before;
    level = level_from;
  end
  if isnan(level_from) || isnan(level_to)
    return;
  end
  for k = 1:size(curves, 1)
    if isequal([curves{k, 1:3}], [transition, side, level_to > level_from])
      levels = curves{k, 4};
      delays = curves{k, 5};
      if numel(levels) == 1
        delay_s = delays;
      else
        level = min(max(level, levels(1)), levels(end));
        j = min(find(levels <= level, 1, 'last'), numel(levels) - 1);
        part = (level - levels(j)) / (levels(j + 1) - levels(j));
        delay_s = delays(j) + (delays(j + 1) - delays(j)) * part;
      end
    end
  end
end
";

/// The whole file; its function is called as the file is.
pub(super) fn source(lookup: &Lookup<'_>, name: &str) -> String {
    let origin = lookup.commented("%   ");
    let joints: String = lookup.joints.iter().map(joint).collect();
    let error = format!("error('{name}:joint', 'no joint is called ''%s''', joint);");
    format!(
        "function delay_s = {name}(joint, level_from, level_to)\n\
         %{upper} Delay in seconds of a step of the input of a joint.\n\
         %   delay_s = {name}(joint, level_from, level_to), levels in the units of the log.\n\
         %   Between measured levels it is interpolated within starts, stops, changes and\n\
         %   reversals of one side and direction; beyond them it stays that of the last level.\n\
         %   NaN where no such step was measured; an error where no joint is called so.\n%\n{origin}\n  \
         % A row per curve: 0 start, 1 stop, 2 change, 3 reversal; side of neutral; whether\n  \
         % the input rises; levels; delays in seconds.\n  \
         switch joint\n{joints}    otherwise\n      {error}\n  end\n{TAIL}",
        upper = name.to_uppercase(),
    )
}

fn joint(joint: &JointLookup<'_>) -> String {
    let name = joint.name.replace('\'', "''");
    let (low, high) = joint.neutral.map_or_else(
        || ("-Inf".to_owned(), "Inf".to_owned()),
        |neutral| (format!("{:?}", neutral.low), format!("{:?}", neutral.high)),
    );
    let row = |curve: &DelayCurve| {
        let (levels, delays) = numbers(curve);
        let (kind, side, rises) = (curve.transition as u8, side(curve.side), u8::from(curve.rises));
        format!("        {kind}, {side}, {rises}, [{levels}], [{delays}] % {}\n", support(curve))
    };
    let rows: String = joint.curves.iter().map(row).collect();
    let curves =
        if rows.is_empty() { "cell(0, 5)".to_owned() } else { format!("{{\n{rows}      }}") };
    format!("    case '{name}'\n      neutral = [{low}, {high}];\n      curves = {curves};\n")
}
