{% macro body(program) %}
{% set text = program.lines | join %}
{% if "model->" not in text %}
    (void)model;
{% endif %}
{% if "at->" not in text %}
    (void)at;
{% endif %}
{% for line in program.lines %}
    {{ line | replace("sign_of(", name ~ "_sign(") }}
{% endfor %}
{% endmacro %}
/* The joint {{ joint | plain }}: see the header. */
#include "{{ name }}.h"

#include <math.h>

/* What an effect sees of the joint. */
typedef struct {
    double signal;   /* after the effects before it */
    double position; /* angle of the joint, output units */
    double velocity; /* in the interval before, output units per second */
    double time;     /* seconds since the start of the record */
    double dt;       /* length of the interval, seconds */
    double others;   /* activity of the other joints, 0 to 1 */
} {{ name }}_moment;

/* A change of the input, as it is commanded. */
typedef struct {
    double before;
    double after;
    double held; /* seconds for which the level before was held */
    double time; /* seconds since the start of the record */
} {{ name }}_change;

{% macro lines() %}{% for e in effects %}{{ e.settle.lines | join }}{{ e.step.lines | join }}{% endfor %}{% endmacro %}
{% if "sign_of(" in lines() %}
static double {{ name }}_sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x;
}

{% endif %}
{% for e in effects %}
{% set kind = "change" if e in transport else "moment" %}
/* {{ e.id }}: {{ e.summary | plain }}
 *     {{ e.equation | plain }} */
static double {{ name }}_effect_{{ e.id }}({{ name }}_state *model, const {{ name }}_{{ kind }} *at)
{
{{ body(e.step) }}    return {{ e.step.result }};
}

{% if e.settle.lines %}
static void {{ name }}_effect_{{ e.id }}_settle({{ name }}_state *model, const {{ name }}_{{ kind }} *at)
{
{{ body(e.settle) }}}

{% endif %}
{% endfor %}
static {{ name }}_moment {{ name }}_at(const {{ name }}_state *model, double signal, double time, double dt)
{
    {{ name }}_moment at;
    at.signal = signal;
    at.position = model->angle;
    at.velocity = model->velocity;
    at.time = model->p.start_s + time;
    at.dt = dt;
    at.others = model->others;
    return at;
}

{{ name }}_parameters {{ name }}_defaults(void)
{
    {{ name }}_parameters p;
{% for p in parameters %}
    p.{{ p.name }} = {{ p.value }};
{% endfor %}
    return p;
}

/* Moves the sensor on to the present angle. */
static void {{ name }}_measure({{ name }}_state *model, double time, double dt)
{
    {{ name }}_moment at = {{ name }}_at(model, model->angle, time, dt);
{% for e in sensor %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    model->measured = at.signal;
}

void {{ name }}_init({{ name }}_state *model, const {{ name }}_parameters *p, double period_s,
                 double input, double output)
{
    static const {{ name }}_state none;
    {{ name }}_moment at;
    double play;
    *model = none;
    model->p = *p;
    model->period_s = period_s;
    model->before = input;
    model->level = input;
    at = {{ name }}_at(model, input, 0.0, period_s);
{% for e in drive %}
{% if e.settle.lines %}
    {{ name }}_effect_{{ e.id }}_settle(model, &at);
{% endif %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    at = {{ name }}_at(model, 0.0, 0.0, period_s);
{% for e in limits %}
{% if e.settle.lines %}
    {{ name }}_effect_{{ e.id }}_settle(model, &at);
{% endif %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    model->angle = at.signal;
    at = {{ name }}_at(model, model->angle, 0.0, period_s);
{% for e in sensor %}
{% if e.settle.lines %}
    {{ name }}_effect_{{ e.id }}_settle(model, &at);
{% endif %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    play = model->angle - at.signal;
    at = {{ name }}_at(model, output, 0.0, period_s);
{% for e in sensor %}
{% if e.settle.lines %}
    {{ name }}_effect_{{ e.id }}_settle(model, &at);
{% endif %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    model->angle = output + play;
    {{ name }}_measure(model, 0.0, period_s);
}

/* Lets `dt` seconds pass with a constant input. */
static void {{ name }}_pass({{ name }}_state *model, double input, double time, double dt)
{
    {{ name }}_moment at;
    if (!(dt > 0.0)) {
        return;
    }
    at = {{ name }}_at(model, input, time, dt);
{% for e in drive %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    at.signal *= model->p.gain;
{% if load %}
    {
        const double commanded = at.signal;
        at.position += 0.5 * dt * (commanded + model->load_adds);
        at.time += 0.5 * dt;
{% for e in load %}
        at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
        model->load_adds = at.signal - commanded;
    }
{% endif %}
    model->velocity = at.signal;
    model->angle += model->velocity * dt;
{% if limits %}
    at = {{ name }}_at(model, model->angle, time, dt);
{% for e in limits %}
    at.signal = {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    if (at.signal != model->angle) {
        model->velocity = 0.0;
    }
    model->angle = at.signal;
{% endif %}
    {{ name }}_measure(model, time, dt);
}

/* The first of the changes on their way acts from now on. */
static void {{ name }}_arrive({{ name }}_state *model)
{
    model->level = model->coming[model->first].level;
    model->first = (model->first + 1) % {{ name | upper }}_MOST_CHANGES;
    model->count--;
}

static const {{ name }}_arrival *{{ name }}_coming(const {{ name }}_state *model, size_t number)
{
    return &model->coming[(model->first + number) % {{ name | upper }}_MOST_CHANGES];
}

/* The input changes to `level`, which arrives later. A change that would act before an
 * earlier one takes its place. */
static void {{ name }}_command({{ name }}_state *model, double level, double now)
{
    {{ name }}_arrival *last;
    double arrives = model->p.delay;
{% if transport %}
    {
        {{ name }}_change at;
        at.before = model->before;
        at.after = level;
        at.held = now - model->since;
        at.time = model->p.start_s + now;
{% for e in transport %}
        arrives += {{ name }}_effect_{{ e.id }}(model, &at);
{% endfor %}
    }
{% endif %}
    arrives = now + fmax(arrives, 0.0);
    while (model->count > 0 && {{ name }}_coming(model, model->count - 1)->time >= arrives) {
        model->count--;
    }
    if (model->count == {{ name | upper }}_MOST_CHANGES) {
        {{ name }}_arrive(model);
        model->lost++;
    }
    last = &model->coming[(model->first + model->count) % {{ name | upper }}_MOST_CHANGES];
    last->time = arrives;
    last->level = level;
    model->count++;
    model->before = level;
    model->since = now;
}

void {{ name }}_advance({{ name }}_state *model, double input, double start, double end, double dt)
{
    double now = start;
    if (input != model->before) {
        {{ name }}_command(model, input, start);
    }
    while (model->count > 0 && {{ name }}_coming(model, 0)->time <= start) {
        {{ name }}_arrive(model);
    }
    if (!(model->count > 0 && {{ name }}_coming(model, 0)->time < end)) {
        {{ name }}_pass(model, model->level, start, dt);
        return;
    }
    while (model->count > 0 && {{ name }}_coming(model, 0)->time < end) {
        const double change = {{ name }}_coming(model, 0)->time;
        {{ name }}_pass(model, model->level, now, change - now);
        now = change;
        {{ name }}_arrive(model);
    }
    {{ name }}_pass(model, model->level, now, end - now);
}

double {{ name }}_step({{ name }}_state *model, double input)
{
    const double output = model->measured;
    const double start = model->sample * model->period_s;
    model->sample += 1.0;
    {{ name }}_advance(model, input, start, model->sample * model->period_s, model->period_s);
    return output;
}
