# Delays of the steps of an input: delay_s(joint, level_from, level_to).
#
{% for line in origin %}
# {{ line }}
{% endfor %}
import math

# The neutral band of each joint; levels and delays in seconds by kind of step, side
# of neutral (0 where it is not known) and whether the input rises.
JOINTS = {
{% for joint in joints %}
    {{ joint.name }}: (({{ joint.low }}, {{ joint.high }}), {
{% for curve in joint.curves %}
        ("{{ curve.kind }}", {{ curve.side }}, {{ "True" if curve.rises else "False" }}): ([{{ curve.levels }}], [{{ curve.delays }}]),  # {{ curve.support }}
{% endfor %}
    }),
{% endfor %}
}


def delay_s(joint, level_from, level_to):
    """The delay in seconds of a step of the input of `joint` from one level to another.

    Levels are in the units of the log. Between measured levels the delay is interpolated
    within starts, stops, changes and reversals of one side and direction; beyond them it
    stays that of the last level. NaN where no such step was measured. Raises KeyError where
    the joint is not known.
    """
    (low, high), curves = JOINTS[joint]
    if math.isnan(level_from) or math.isnan(level_to):
        return math.nan
    before = (level_from > high) - (level_from < low)
    after = (level_to > high) - (level_to < low)
    if before == after:
        kind, side, level = "change", after, level_to
    elif before == 0:
        kind, side, level = "start", after, level_to
    elif after == 0:
        kind, side, level = "stop", before, level_from
    else:
        kind, side, level = "reversal", after, level_to
    curve = curves.get((kind, side, level_to > level_from))
    return math.nan if curve is None else _interpolate(*curve, level)


def _interpolate(levels, delays, level):
    if level <= levels[0]:
        return delays[0]
    for k in range(1, len(levels)):
        if level <= levels[k]:
            part = (level - levels[k - 1]) / (levels[k] - levels[k - 1])
            return delays[k - 1] + (delays[k] - delays[k - 1]) * part
    return delays[-1]
