/* The joint @JOINT@: see the header. */
#include "@FILE@.h"

#include <math.h>

/* What an effect sees of the joint. */
typedef struct {
    double signal;   /* after the effects before it */
    double position; /* angle of the joint, output units */
    double velocity; /* in the interval before, output units per second */
    double time;     /* seconds since the start of the record */
    double dt;       /* length of the interval, seconds */
    double others;   /* activity of the other joints, 0 to 1 */
} @NAME@_moment;

/* A change of the input, as it is commanded. */
typedef struct {
    double before;
    double after;
    double held; /* seconds for which the level before was held */
    double time; /* seconds since the start of the record */
} @NAME@_change;

@HELPERS@@EFFECTS@static @NAME@_moment @NAME@_at(const @NAME@_state *model, double signal, double time, double dt)
{
    @NAME@_moment at;
    at.signal = signal;
    at.position = model->angle;
    at.velocity = model->velocity;
    at.time = model->p.start_s + time;
    at.dt = dt;
    at.others = model->others;
    return at;
}

@NAME@_parameters @NAME@_defaults(void)
{
    @NAME@_parameters p;
@DEFAULTS@    return p;
}

/* Moves the sensor on to the present angle. */
static void @NAME@_measure(@NAME@_state *model, double time, double dt)
{
    @NAME@_moment at = @NAME@_at(model, model->angle, time, dt);
@SENSOR@    model->measured = at.signal;
}

void @NAME@_init(@NAME@_state *model, const @NAME@_parameters *p, double period_s,
                 double input, double output)
{
    static const @NAME@_state none;
    @NAME@_moment at;
    double play;
    *model = none;
    model->p = *p;
    model->period_s = period_s;
    model->before = input;
    model->level = input;
    at = @NAME@_at(model, input, 0.0, period_s);
@SETTLE_DRIVE@    at = @NAME@_at(model, 0.0, 0.0, period_s);
@SETTLE_LIMITS@    model->angle = at.signal;
    at = @NAME@_at(model, model->angle, 0.0, period_s);
@SETTLE_SENSOR@    play = model->angle - at.signal;
    at = @NAME@_at(model, output, 0.0, period_s);
@SETTLE_SENSOR@    model->angle = output + play;
    @NAME@_measure(model, 0.0, period_s);
}

/* Lets `dt` seconds pass with a constant input. */
static void @NAME@_pass(@NAME@_state *model, double input, double time, double dt)
{
    @NAME@_moment at;
    if (!(dt > 0.0)) {
        return;
    }
    at = @NAME@_at(model, input, time, dt);
@DRIVE@    at.signal *= model->p.gain;
@LOAD@    model->velocity = at.signal;
    model->angle += model->velocity * dt;
@LIMITS@    @NAME@_measure(model, time, dt);
}

/* The first of the changes on their way acts from now on. */
static void @NAME@_arrive(@NAME@_state *model)
{
    model->level = model->coming[model->first].level;
    model->first = (model->first + 1) % @UPPER@_MOST_CHANGES;
    model->count--;
}

static const @NAME@_arrival *@NAME@_coming(const @NAME@_state *model, size_t number)
{
    return &model->coming[(model->first + number) % @UPPER@_MOST_CHANGES];
}

/* The input changes to `level`, which arrives later. A change that would act before an
 * earlier one takes its place. */
static void @NAME@_command(@NAME@_state *model, double level, double now)
{
    @NAME@_arrival *last;
    double arrives = model->p.delay;
@TRANSPORT@    arrives = now + fmax(arrives, 0.0);
    while (model->count > 0 && @NAME@_coming(model, model->count - 1)->time >= arrives) {
        model->count--;
    }
    if (model->count == @UPPER@_MOST_CHANGES) {
        @NAME@_arrive(model);
        model->lost++;
    }
    last = &model->coming[(model->first + model->count) % @UPPER@_MOST_CHANGES];
    last->time = arrives;
    last->level = level;
    model->count++;
    model->before = level;
    model->since = now;
}

void @NAME@_advance(@NAME@_state *model, double input, double start, double end, double dt)
{
    double now = start;
    if (input != model->before) {
        @NAME@_command(model, input, start);
    }
    while (model->count > 0 && @NAME@_coming(model, 0)->time <= start) {
        @NAME@_arrive(model);
    }
    if (!(model->count > 0 && @NAME@_coming(model, 0)->time < end)) {
        @NAME@_pass(model, model->level, start, dt);
        return;
    }
    while (model->count > 0 && @NAME@_coming(model, 0)->time < end) {
        const double change = @NAME@_coming(model, 0)->time;
        @NAME@_pass(model, model->level, now, change - now);
        now = change;
        @NAME@_arrive(model);
    }
    @NAME@_pass(model, model->level, now, end - now);
}

double @NAME@_step(@NAME@_state *model, double input)
{
    const double output = model->measured;
    const double start = model->sample * model->period_s;
    model->sample += 1.0;
    @NAME@_advance(model, input, start, model->sample * model->period_s, model->period_s);
    return output;
}
