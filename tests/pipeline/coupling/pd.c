/* A controller as an FMU of FMI 2 (-DFMI=2) or 3: force = -stiffness x - damping v, within a limit; it sums up its steps.
   Its parameter "fault" makes it fail from t = 0.05 s on: 1 crashes, 2 hangs, 3 returns an error with a message, 4 gives no
   number, 5 ends its process; "-DLAGS" holds the force of the last step, so that it has a state that matters. */
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { X, V, FORCE, STIFFNESS, DAMPING, LIMIT, SUM, COUNT };
typedef struct {
    double value[COUNT];
    double lag;
    int fault;
    char text[32];
} Unit;

static Unit *create(void) {
    Unit *unit = calloc(1, sizeof *unit);
    unit->value[STIFFNESS] = 2e4;
    unit->value[DAMPING] = 6e4;
    unit->value[LIMIT] = 1e5;
    return unit;
}

static void control(Unit *unit) {
    double *a = unit->value, f = -a[STIFFNESS] * a[X] - a[DAMPING] * a[V];
    f = f > a[LIMIT] ? a[LIMIT] : f < -a[LIMIT] ? -a[LIMIT] : f;
#ifdef LAGS
    a[FORCE] = 0.5 * (f + unit->lag);
    unit->lag = f;
#else
    a[FORCE] = f;
#endif
}

/* an output follows from the inputs that are set when it is asked for, but for one with a state of its own */
static double output(Unit *unit, unsigned reference) {
#ifndef LAGS
    if (reference == FORCE && isfinite(unit->value[FORCE])) control(unit);
#endif
    return unit->value[reference];
}

/* 0: go on; 3: an error, whose message the caller sends */
static int advance(Unit *unit, double t, double h) {
    control(unit);
    unit->value[SUM] += h;
    if (t + h < 0.05) return 0;
    if (unit->fault == 1) raise(11);
    if (unit->fault == 2) for (;;) pause();
    if (unit->fault == 3) return 3;
    if (unit->fault == 4) unit->value[FORCE] = NAN;
    if (unit->fault == 5) { printf("out of hydraulic oil\n"); fflush(stdout); _exit(9); }
    return 0;
}

/* what the standards name besides: these have no variables of other types, and no other interfaces */
#define REFUSE(name) int name(void) { return 3; }

#if FMI == 2
REFUSE(fmi2CancelStep) REFUSE(fmi2GetBoolean) REFUSE(fmi2GetBooleanStatus) REFUSE(fmi2GetDirectionalDerivative)
REFUSE(fmi2GetInteger) REFUSE(fmi2GetIntegerStatus) REFUSE(fmi2GetRealOutputDerivatives) REFUSE(fmi2GetRealStatus)
REFUSE(fmi2GetStatus) REFUSE(fmi2GetString) REFUSE(fmi2GetStringStatus) REFUSE(fmi2SetBoolean)
REFUSE(fmi2SetRealInputDerivatives)

typedef struct {
    void (*log)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *place;
} Callbacks;
static const Callbacks *callbacks;

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const s[]) { return 0; }
void *fmi2Instantiate(const char *name, int kind, const char *token, const char *place, const Callbacks *f, int seen, int on) {
    callbacks = f;
    return strcmp(token, "pd") ? NULL : create();
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int a, double b, double t, int e, double s) { return 0; }
int fmi2EnterInitializationMode(void *c) { return 0; }
int fmi2ExitInitializationMode(void *c) { control(c); return 0; }
int fmi2Terminate(void *c) { return 0; }
int fmi2Reset(void *c) { return 0; }
int fmi2SetReal(void *c, const unsigned r[], size_t n, const double v[]) {
    for (size_t i = 0; i < n; i++) ((Unit *)c)->value[r[i]] = v[i];
    return 0;
}
int fmi2GetReal(void *c, const unsigned r[], size_t n, double v[]) {
    for (size_t i = 0; i < n; i++) v[i] = output(c, r[i]);
    return 0;
}
int fmi2SetInteger(void *c, const unsigned r[], size_t n, const int v[]) { ((Unit *)c)->fault = v[0]; return 0; }
int fmi2SetString(void *c, const unsigned r[], size_t n, const char *const v[]) {
    strncpy(((Unit *)c)->text, v[0], 31);
    return 0;
}
int fmi2DoStep(void *c, double t, double h, int no) {
    int status = advance(c, t, h);
    if (status) callbacks->log(callbacks->place, "pd", status, "error", "the %s pump is dry at %g s", ((Unit *)c)->text, t + h);
    return status;
}
int fmi2GetFMUstate(void *c, void **s) {
    if (!*s) *s = malloc(sizeof(Unit));
    memcpy(*s, c, sizeof(Unit));
    return 0;
}
int fmi2SetFMUstate(void *c, void *s) { memcpy(c, s, sizeof(Unit)); return 0; }
int fmi2FreeFMUstate(void *c, void **s) { free(*s); *s = NULL; return 0; }
int fmi2SerializedFMUstateSize(void *c, void *s, size_t *n) { *n = sizeof(Unit); return 0; }
int fmi2SerializeFMUstate(void *c, void *s, char b[], size_t n) { memcpy(b, s, sizeof(Unit)); return 0; }
int fmi2DeSerializeFMUstate(void *c, const char b[], size_t n, void **s) {
    if (!*s) *s = malloc(sizeof(Unit));
    memcpy(*s, b, sizeof(Unit));
    return 0;
}
#else
REFUSE(fmi3ActivateModelPartition) REFUSE(fmi3CompletedIntegratorStep) REFUSE(fmi3EnterConfigurationMode)
REFUSE(fmi3EnterContinuousTimeMode) REFUSE(fmi3EnterEventMode) REFUSE(fmi3EnterStepMode) REFUSE(fmi3EvaluateDiscreteStates)
REFUSE(fmi3ExitConfigurationMode) REFUSE(fmi3GetAdjointDerivative) REFUSE(fmi3GetBinary) REFUSE(fmi3GetBoolean)
REFUSE(fmi3GetClock) REFUSE(fmi3GetContinuousStateDerivatives) REFUSE(fmi3GetContinuousStates)
REFUSE(fmi3GetDirectionalDerivative) REFUSE(fmi3GetEventIndicators) REFUSE(fmi3GetFloat32) REFUSE(fmi3GetInt16)
REFUSE(fmi3GetInt32) REFUSE(fmi3GetInt64) REFUSE(fmi3GetInt8) REFUSE(fmi3GetIntervalDecimal) REFUSE(fmi3GetIntervalFraction)
REFUSE(fmi3GetNominalsOfContinuousStates) REFUSE(fmi3GetNumberOfContinuousStates) REFUSE(fmi3GetNumberOfEventIndicators)
REFUSE(fmi3GetNumberOfVariableDependencies) REFUSE(fmi3GetOutputDerivatives) REFUSE(fmi3GetShiftDecimal)
REFUSE(fmi3GetShiftFraction) REFUSE(fmi3GetString) REFUSE(fmi3GetUInt16) REFUSE(fmi3GetUInt32) REFUSE(fmi3GetUInt64)
REFUSE(fmi3GetUInt8) REFUSE(fmi3GetVariableDependencies) REFUSE(fmi3InstantiateModelExchange)
REFUSE(fmi3InstantiateScheduledExecution) REFUSE(fmi3SetBinary) REFUSE(fmi3SetBoolean) REFUSE(fmi3SetClock)
REFUSE(fmi3SetContinuousStates) REFUSE(fmi3SetDebugLogging) REFUSE(fmi3SetFloat32) REFUSE(fmi3SetInt16) REFUSE(fmi3SetInt64)
REFUSE(fmi3SetInt8) REFUSE(fmi3SetIntervalDecimal) REFUSE(fmi3SetIntervalFraction) REFUSE(fmi3SetShiftDecimal)
REFUSE(fmi3SetShiftFraction) REFUSE(fmi3SetTime) REFUSE(fmi3SetUInt16) REFUSE(fmi3SetUInt32) REFUSE(fmi3SetUInt64)
REFUSE(fmi3SetUInt8) REFUSE(fmi3UpdateDiscreteStates)

typedef void (*Log)(void *, int, const char *, const char *);
static Log say;
static void *place;

const char *fmi3GetVersion(void) { return "3.0"; }
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *folder, _Bool seen, _Bool on, _Bool events,
    _Bool early, const uint32_t r[], size_t n, void *env, Log log, void *update) {
    say = log;
    place = env;
    return strcmp(token, "pd") ? NULL : create();
}
void fmi3FreeInstance(void *c) { free(c); }
int fmi3EnterInitializationMode(void *c, _Bool d, double tol, double t0, _Bool s, double t1) { return 0; }
int fmi3ExitInitializationMode(void *c) { control(c); return 0; }
int fmi3Terminate(void *c) { return 0; }
int fmi3Reset(void *c) { return 0; }
int fmi3SetFloat64(void *c, const uint32_t r[], size_t n, const double v[], size_t m) {
    for (size_t i = 0; i < n; i++) ((Unit *)c)->value[r[i]] = v[i];
    return 0;
}
int fmi3GetFloat64(void *c, const uint32_t r[], size_t n, double v[], size_t m) {
    for (size_t i = 0; i < n; i++) v[i] = output(c, r[i]);
    return 0;
}
int fmi3SetInt32(void *c, const uint32_t r[], size_t n, const int32_t v[], size_t m) { ((Unit *)c)->fault = v[0]; return 0; }
int fmi3SetString(void *c, const uint32_t r[], size_t n, const char *const v[], size_t m) {
    strncpy(((Unit *)c)->text, v[0], 31);
    return 0;
}
int fmi3DoStep(void *c, double t, double h, _Bool no, _Bool *event, _Bool *end, _Bool *early, double *last) {
    int status = advance(c, t, h);
    *event = *end = *early = 0;
    *last = t + h;
    if (status) {
        char words[99];
        snprintf(words, sizeof words, "the %s pump is dry at %g s", ((Unit *)c)->text, t + h);
        say(place, status, "error", words);
    }
    return status;
}
int fmi3GetFMUState(void *c, void **s) {
    if (!*s) *s = malloc(sizeof(Unit));
    memcpy(*s, c, sizeof(Unit));
    return 0;
}
int fmi3SetFMUState(void *c, void *s) { memcpy(c, s, sizeof(Unit)); return 0; }
int fmi3FreeFMUState(void *c, void **s) { free(*s); *s = NULL; return 0; }
int fmi3SerializedFMUStateSize(void *c, void *s, size_t *n) { *n = sizeof(Unit); return 0; }
int fmi3SerializeFMUState(void *c, void *s, uint8_t b[], size_t n) { memcpy(b, s, sizeof(Unit)); return 0; }
int fmi3DeserializeFMUState(void *c, const uint8_t b[], size_t n, void **s) {
    if (!*s) *s = malloc(sizeof(Unit));
    memcpy(*s, b, sizeof(Unit));
    return 0;
}
#endif
