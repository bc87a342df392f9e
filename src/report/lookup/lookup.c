/*
{% for line in origin %}
 * {{ line | plain }}
{% endfor %}
 *
 * double tauscope_delay_s(const char *joint, double level_from, double level_to);
 *
 * The delay in seconds of a step of the input of `joint` from one level to another, in
 * the units of the log. Between measured levels it is interpolated within starts, stops,
 * changes and reversals of one side and direction; beyond them it stays that of the last
 * level. NAN where no such step was measured, and where no joint is called so.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

typedef struct {
    int transition; /* 0 start, 1 stop, 2 change, 3 reversal */
    int side;       /* of neutral: 1 above, -1 below, 0 where it is not known */
    int rises;
    size_t count;
    const double *level;
    const double *delay_s;
} tauscope_curve;

typedef struct {
    const char *name;
    double neutral_low;
    double neutral_high;
    size_t count;
    const tauscope_curve *curves;
} tauscope_joint;

{% for joint in joints %}
{% set number = loop.index0 %}
{% if joint.curves %}
{% for curve in joint.curves %}
/* {{ curve.support }} */
static const double level_{{ number }}_{{ loop.index0 }}[] = {{ "{" }}{{ curve.levels }}};
static const double delay_{{ number }}_{{ loop.index0 }}[] = {{ "{" }}{{ curve.delays }}};
{% endfor %}
static const tauscope_curve curves_{{ number }}[] = {
{% for curve in joint.curves %}
    {{ "{" }}{{ curve.key }}, {{ curve.count }}, level_{{ number }}_{{ loop.index0 }}, delay_{{ number }}_{{ loop.index0 }}},
{% endfor %}
};

{% endif %}
{% endfor %}
static const tauscope_joint tauscope_joints[] = {
{% for joint in joints %}
    {{ "{" }}{{ joint.name }}, {{ joint.low }}, {{ joint.high }}, {{ joint.curves | length }}, {{ "curves_" ~ loop.index0 if joint.curves else "NULL" }}},
{% endfor %}
};

static int tauscope_side(const tauscope_joint *joint, double level)
{
    return (level > joint->neutral_high) - (level < joint->neutral_low);
}

static double tauscope_interpolate(const tauscope_curve *curve, double level)
{
    const double *x = curve->level;
    const double *y = curve->delay_s;
    size_t k;
    if (level <= x[0]) {
        return y[0];
    }
    for (k = 1; k < curve->count; k++) {
        if (level <= x[k]) {
            return y[k - 1] + (y[k] - y[k - 1]) * (level - x[k - 1]) / (x[k] - x[k - 1]);
        }
    }
    return y[curve->count - 1];
}

double tauscope_delay_s(const char *joint, double level_from, double level_to)
{
    size_t j, k;
    for (j = 0; j < sizeof tauscope_joints / sizeof *tauscope_joints; j++) {
        const tauscope_joint *found = &tauscope_joints[j];
        int before = tauscope_side(found, level_from);
        int after = tauscope_side(found, level_to);
        int transition = before == after ? 2 : before == 0 ? 0 : after == 0 ? 1 : 3;
        int side = transition == 1 ? before : after;
        if (strcmp(found->name, joint) != 0 || isnan(level_from) || isnan(level_to)) {
            continue;
        }
        for (k = 0; k < found->count; k++) {
            const tauscope_curve *curve = &found->curves[k];
            if (curve->transition == transition && curve->side == side &&
                curve->rises == (level_to > level_from)) {
                return tauscope_interpolate(curve, transition == 1 ? level_from : level_to);
            }
        }
    }
    return NAN;
}
