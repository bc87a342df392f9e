/* The joint {{ joint | plain }} with the functions of FMI 3.0, for co-simulation.
 *
 * The types are those of the standard, written out, so that nothing else is needed to
 * compile this file. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "{{ name }}.h"

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

typedef void *fmi3Instance;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef const uint8_t *fmi3Binary;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;
typedef int fmi3DependencyKind;
typedef void (*fmi3LogMessageCallback)(void *, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(void *, double, bool, bool, bool, bool, bool *, double *);
typedef void (*fmi3ClockUpdateCallback)(void *);
typedef void (*fmi3LockPreemptionCallback)(void);

/* Variables by value reference; the parameters follow. */
enum { TIME, INPUT, OTHERS, OUTPUT, INITIAL_OUTPUT, PARAMETER };

/* Where the importer is in the life of an instance. */
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED } Phase;

/* What an instance is, but for whom it belongs to. */
typedef struct {
    Phase phase;
    double input;
    double initial_output;
    double start_time;
    double time;
    {{ name }}_parameters parameters;
    {{ name }}_state model;
} State;

typedef struct {
    void *environment;
    fmi3LogMessageCallback log;
    State state;
} Instance;

/* Seconds of a step that an input is settled with: what has long been held is the same with
 * any. */
static const double SETTLING_S = 0.01;

static fmi3Status fail(const Instance *instance, const char *message)
{
    if (instance && instance->log) {
        instance->log(instance->environment, fmi3Error, "logStatusError", message);
    }
    return fmi3Error;
}

static void begin(Instance *instance)
{
    State *state = &instance->state;
    memset(state, 0, sizeof *state);
    state->parameters = {{ name }}_defaults();
}

/* At rest, at the output and with the input and the parameters that are set. */
static void settle(State *state)
{
    const double others = state->model.others;
    {{ name }}_init(&state->model, &state->parameters, SETTLING_S, state->input, state->initial_output);
    state->model.others = others;
}

static double *variable(State *state, fmi3ValueReference reference)
{
    {{ name }}_parameters *p = &state->parameters;
    switch (reference) {
    case TIME: return &state->time;
    case INPUT: return &state->input;
    case OTHERS: return &state->model.others;
    case OUTPUT: return &state->model.measured;
    case INITIAL_OUTPUT: return &state->initial_output;
{% for p in parameters %}
    case PARAMETER + {{ loop.index0 }}: return &p->{{ p.name }};
{% endfor %}
    default: return NULL;
    }
}

EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, bool on, size_t count, const fmi3String categories[])
{
    (void)instance; (void)on; (void)count; (void)categories;
    return fmi3OK;
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging, bool events, bool early_return,
    const fmi3ValueReference intermediate[], size_t count, void *environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update)
{
    Instance *instance;
    (void)name; (void)resources; (void)visible; (void)logging; (void)events; (void)early_return;
    (void)intermediate; (void)count; (void)update;
    if (!token || strcmp(token, "{{ token }}") != 0) {
        if (log) {
            log(environment, fmi3Error, "logStatusError", "the instantiation token is that of another model");
        }
        return NULL;
    }
    instance = calloc(1, sizeof *instance);
    if (instance) {
        instance->environment = environment;
        instance->log = log;
        begin(instance);
        settle(&instance->state);
    }
    return instance;
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging, void *environment,
    fmi3LogMessageCallback log)
{
    (void)name; (void)token; (void)resources; (void)visible; (void)logging;
    if (log) {
        log(environment, fmi3Error, "logStatusError", "this model is for co-simulation");
    }
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging, void *environment,
    fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
    fmi3LockPreemptionCallback unlock)
{
    (void)clock; (void)lock; (void)unlock;
    return fmi3InstantiateModelExchange(name, token, resources, visible, logging, environment, log);
}

EXPORT void fmi3FreeInstance(fmi3Instance instance)
{
    free(instance);
}

EXPORT fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, bool has_tolerance, double tolerance, double start, bool has_stop, double stop)
{
    State *state = &((Instance *)instance)->state;
    (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
    if (state->phase != INSTANTIATED) {
        return fail(instance, "fmi3EnterInitializationMode: the instance is initialized already");
    }
    state->start_time = state->time = start;
    state->phase = INITIALIZING;
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    State *state = &((Instance *)instance)->state;
    if (state->phase != INITIALIZING) {
        return fail(instance, "fmi3ExitInitializationMode: the instance is not in initialization mode");
    }
    settle(state);
    state->phase = STEPPING;
    return fmi3OK;
}

EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    return fail(instance, "fmi3EnterEventMode: this model has no events");
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    return fail(instance, "fmi3EnterStepMode: this model has no events");
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance instance)
{
    ((Instance *)instance)->state.phase = TERMINATED;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance instance)
{
    begin(instance);
    settle(&((Instance *)instance)->state);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(
    fmi3Instance instance, const fmi3ValueReference references[], size_t count, double values[], size_t value_count)
{
    State *state = &((Instance *)instance)->state;
    size_t k;
    if (count != value_count) {
        return fail(instance, "fmi3GetFloat64: each variable has one value");
    }
    if (state->phase == INITIALIZING) {
        settle(state);
    }
    for (k = 0; k < count; k++) {
        const double *found = variable(state, references[k]);
        if (!found) {
            return fail(instance, "fmi3GetFloat64: no variable has this value reference");
        }
        values[k] = *found;
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(
    fmi3Instance instance, const fmi3ValueReference references[], size_t count, const double values[], size_t value_count)
{
    State *state = &((Instance *)instance)->state;
    size_t k;
    if (count != value_count) {
        return fail(instance, "fmi3SetFloat64: each variable has one value");
    }
    for (k = 0; k < count; k++) {
        double *found = variable(state, references[k]);
        const bool is_input = references[k] == INPUT || references[k] == OTHERS;
        if (!found || references[k] == TIME || references[k] == OUTPUT) {
            return fail(instance, "fmi3SetFloat64: no variable that can be set has this value reference");
        }
        if (!is_input && state->phase != INSTANTIATED && state->phase != INITIALIZING) {
            return fail(instance, "fmi3SetFloat64: parameters are set before the simulation begins");
        }
        if (!isfinite(values[k])) {
            return fail(instance, "fmi3SetFloat64: a value is not finite");
        }
        *found = values[k];
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(
    fmi3Instance instance, double now, double step, bool keeps_no_state, bool *event, bool *terminate, bool *early,
    double *reached)
{
    State *state = &((Instance *)instance)->state;
    const double start = now - state->start_time;
    (void)keeps_no_state;
    if (state->phase != STEPPING) {
        return fail(instance, "fmi3DoStep: the instance is not initialized");
    }
    if (!(step > 0.0)) {
        return fail(instance, "fmi3DoStep: a step takes more than no time");
    }
    {{ name }}_advance(&state->model, state->input, start, start + step, step);
    state->time = now + step;
    if (state->model.lost > 0) {
        return fail(instance, "fmi3DoStep: more changes of the input are on their way than there is room for");
    }
    *event = *terminate = *early = false;
    *reached = state->time;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *saved)
{
    if (!*saved) {
        *saved = malloc(sizeof(State));
    }
    if (!*saved) {
        return fail(instance, "fmi3GetFMUState: no memory is left");
    }
    memcpy(*saved, &((Instance *)instance)->state, sizeof(State));
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState saved)
{
    memcpy(&((Instance *)instance)->state, saved, sizeof(State));
    return fmi3OK;
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *saved)
{
    (void)instance;
    free(*saved);
    *saved = NULL;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState saved, size_t *size)
{
    (void)instance; (void)saved;
    *size = sizeof(State);
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState saved, uint8_t bytes[], size_t size)
{
    if (size != sizeof(State)) {
        return fail(instance, "fmi3SerializeFMUState: the size is not that of a state");
    }
    memcpy(bytes, saved, size);
    return fmi3OK;
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const uint8_t bytes[], size_t size, fmi3FMUState *saved)
{
    fmi3Status status;
    if (size != sizeof(State)) {
        return fail(instance, "fmi3DeserializeFMUState: the size is not that of a state");
    }
    status = fmi3GetFMUState(instance, saved);
    if (status == fmi3OK) {
        memcpy(*saved, bytes, size);
    }
    return status;
}

/* The standard asks for every function; of what this model does not have, there is nothing
 * to get or to set. */
#define NONE(name, arguments) \
    EXPORT fmi3Status name arguments; \
    EXPORT fmi3Status name arguments { return fail(instance, #name ": this model has nothing of this kind"); }
#define NO_VALUES(kind, type) \
    EXPORT fmi3Status fmi3Get##kind(fmi3Instance instance, const fmi3ValueReference r[], size_t n, type v[], size_t m) \
    { \
        (void)r; (void)v; (void)m; \
        return n == 0 ? fmi3OK : fail(instance, "fmi3Get" #kind ": this model has no variable of this type"); \
    } \
    EXPORT fmi3Status fmi3Set##kind(fmi3Instance instance, const fmi3ValueReference r[], size_t n, const type v[], size_t m) \
    { \
        (void)r; (void)v; (void)m; \
        return n == 0 ? fmi3OK : fail(instance, "fmi3Set" #kind ": this model has no variable of this type"); \
    }

NO_VALUES(Float32, float)
NO_VALUES(Int8, int8_t)
NO_VALUES(UInt8, uint8_t)
NO_VALUES(Int16, int16_t)
NO_VALUES(UInt16, uint16_t)
NO_VALUES(Int32, int32_t)
NO_VALUES(UInt32, uint32_t)
NO_VALUES(Int64, int64_t)
NO_VALUES(UInt64, uint64_t)
NO_VALUES(Boolean, bool)
NO_VALUES(String, fmi3String)

#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
typedef const fmi3ValueReference *References;
NONE(fmi3GetBinary, (fmi3Instance instance, References r, size_t n, size_t sizes[], fmi3Binary v[], size_t m))
NONE(fmi3SetBinary, (fmi3Instance instance, References r, size_t n, const size_t sizes[], const fmi3Binary v[], size_t m))
NONE(fmi3GetClock, (fmi3Instance instance, References r, size_t n, bool v[]))
NONE(fmi3SetClock, (fmi3Instance instance, References r, size_t n, const bool v[]))
NONE(fmi3GetNumberOfVariableDependencies, (fmi3Instance instance, fmi3ValueReference r, size_t *n))
NONE(fmi3GetVariableDependencies, (fmi3Instance instance, fmi3ValueReference r, size_t e[], fmi3ValueReference i[], size_t ei[], fmi3DependencyKind k[], size_t n))
NONE(fmi3GetDirectionalDerivative, (fmi3Instance instance, References u, size_t nu, References k, size_t nk, const double s[], size_t ns, double v[], size_t nv))
NONE(fmi3GetAdjointDerivative, (fmi3Instance instance, References u, size_t nu, References k, size_t nk, const double s[], size_t ns, double v[], size_t nv))
NONE(fmi3EnterConfigurationMode, (fmi3Instance instance))
NONE(fmi3ExitConfigurationMode, (fmi3Instance instance))
NONE(fmi3GetIntervalDecimal, (fmi3Instance instance, References r, size_t n, double v[], fmi3IntervalQualifier q[]))
NONE(fmi3GetIntervalFraction, (fmi3Instance instance, References r, size_t n, uint64_t c[], uint64_t d[], fmi3IntervalQualifier q[]))
NONE(fmi3GetShiftDecimal, (fmi3Instance instance, References r, size_t n, double v[]))
NONE(fmi3GetShiftFraction, (fmi3Instance instance, References r, size_t n, uint64_t c[], uint64_t d[]))
NONE(fmi3SetIntervalDecimal, (fmi3Instance instance, References r, size_t n, const double v[]))
NONE(fmi3SetIntervalFraction, (fmi3Instance instance, References r, size_t n, const uint64_t c[], const uint64_t d[]))
NONE(fmi3SetShiftDecimal, (fmi3Instance instance, References r, size_t n, const double v[]))
NONE(fmi3SetShiftFraction, (fmi3Instance instance, References r, size_t n, const uint64_t c[], const uint64_t d[]))
NONE(fmi3EvaluateDiscreteStates, (fmi3Instance instance))
NONE(fmi3UpdateDiscreteStates, (fmi3Instance instance, bool *a, bool *b, bool *c, bool *d, bool *e, double *t))
NONE(fmi3EnterContinuousTimeMode, (fmi3Instance instance))
NONE(fmi3CompletedIntegratorStep, (fmi3Instance instance, bool keeps_no_state, bool *event, bool *terminate))
NONE(fmi3SetTime, (fmi3Instance instance, double time))
NONE(fmi3SetContinuousStates, (fmi3Instance instance, const double v[], size_t n))
NONE(fmi3GetContinuousStateDerivatives, (fmi3Instance instance, double v[], size_t n))
NONE(fmi3GetEventIndicators, (fmi3Instance instance, double v[], size_t n))
NONE(fmi3GetContinuousStates, (fmi3Instance instance, double v[], size_t n))
NONE(fmi3GetNominalsOfContinuousStates, (fmi3Instance instance, double v[], size_t n))
NONE(fmi3GetNumberOfEventIndicators, (fmi3Instance instance, size_t *n))
NONE(fmi3GetNumberOfContinuousStates, (fmi3Instance instance, size_t *n))
NONE(fmi3GetOutputDerivatives, (fmi3Instance instance, References r, size_t n, const int32_t o[], double v[], size_t m))
NONE(fmi3ActivateModelPartition, (fmi3Instance instance, fmi3ValueReference clock, double time))
