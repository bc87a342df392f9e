/*
 * The joint {{ joint | plain }}, as a model that stands alone.
 *
{% for line in origin %}
 * {{ line | plain }}
{% endfor %}
 *
 *     dy/dt = gain * s, where s is the input, delay seconds late, after its effects
 *
 * In C99, without allocation:
 *
 *     {{ name }}_parameters parameters = {{ name }}_defaults();
 *     {{ name }}_state joint;
 *     {{ name }}_init(&joint, &parameters, 0.01, input, output);
 *     output = {{ name }}_step(&joint, input);      once in every period
 */
#ifndef TAUSCOPE_{{ name | upper }}_H
#define TAUSCOPE_{{ name | upper }}_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Changes of the input that can be on their way at once: at most one comes in a period. */
#ifndef {{ name | upper }}_MOST_CHANGES
#define {{ name | upper }}_MOST_CHANGES 1024
#endif

/* What may be changed, in this order. */
typedef struct {
{% for p in parameters %}
    double {{ p.name }}; /* {{ p.described | plain }}; {{ p.value }} */
{% endfor %}
} {{ name }}_parameters;

/* A level of the input and the time from which it acts. */
typedef struct {
    double time;
    double level;
} {{ name }}_arrival;

/* The state of the joint between two instants. All but `others` is set by the functions. */
typedef struct {
    {{ name }}_parameters p;
    double others;    /* activity of the other joints, 0 to 1: set it before a step{% if not uses_others %}; this model has no use for it{% endif %} */
    size_t lost;      /* changes that acted too early, since too many were on their way */
    double period_s;  /* seconds from one step to the next */
    double sample;    /* steps so far */
    double before;    /* the input as it was last commanded */
    double since;     /* when that was, in seconds */
    double level;     /* the input that acts */
    size_t first;     /* the changes on their way: the first, and how many */
    size_t count;
    {{ name }}_arrival coming[{{ name | upper }}_MOST_CHANGES];
    double angle;     /* of the joint, output units */
    double velocity;  /* output units per second */
    double measured;  /* the angle as its sensor shows it */
    double load_adds; /* to the speed, in the last interval */
{% for name in memory %}
    double {{ name }};
{% endfor %}
} {{ name }}_state;

/* The parameters as they were exported. */
{{ name }}_parameters {{ name }}_defaults(void);

/* At rest in the output `output`, with an input of `input` that has long been held; a step
 * is `period_s` seconds. */
void {{ name }}_init({{ name }}_state *model, const {{ name }}_parameters *p, double period_s,
                 double input, double output);

/* The output now; then `input` is held for one period. */
double {{ name }}_step({{ name }}_state *model, double input);

/* Holds `input` from `start` to `end`, seconds since the first sample; `dt` is the time
 * between them. The output at the end is `model->measured`. */
void {{ name }}_advance({{ name }}_state *model, double input, double start, double end, double dt);

#ifdef __cplusplus
}
#endif

#endif
