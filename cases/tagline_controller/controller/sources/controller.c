/* A tagline controller for FMI 2.0 co-simulation: force = -stiffness x - damping v, within a limit. It answers to the x and v
   of the beginning of a step; its state is all of it, so it is copied to be saved. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { X, V, FORCE, STIFFNESS, DAMPING, LIMIT, COUNT };
enum { OK, WARNING, DISCARD, ERROR };
typedef struct { double value[COUNT]; } Unit;
typedef unsigned Reference;

static void control(double a[]) {
    double force = -a[STIFFNESS] * a[X] - a[DAMPING] * a[V];
    a[FORCE] = force > a[LIMIT] ? a[LIMIT] : force < -a[LIMIT] ? -a[LIMIT] : force;
}

static void begin(Unit *unit) {
    const double start[COUNT] = {0.0, 0.0, 0.0, 2e4, 6e4, 1e5};
    memcpy(unit->value, start, sizeof start);
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const names[]) { (void)c; (void)on; (void)n; (void)names; return OK; }

void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources, const void *callbacks, int visible, int logging) {
    Unit *unit = calloc(1, sizeof *unit);
    (void)name; (void)type; (void)token; (void)resources; (void)callbacks; (void)visible; (void)logging;
    if (unit) begin(unit);
    return unit;
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int given, double tolerance, double start, int ends, double stop) {
    (void)c; (void)given; (void)tolerance; (void)start; (void)ends; (void)stop;
    return OK;
}
int fmi2EnterInitializationMode(void *c) { (void)c; return OK; }
int fmi2ExitInitializationMode(void *c) { control(((Unit *)c)->value); return OK; }
int fmi2Terminate(void *c) { (void)c; return OK; }
int fmi2Reset(void *c) { begin(c); return OK; }

int fmi2SetReal(void *c, const Reference r[], size_t n, const double v[]) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT || r[i] == FORCE) return ERROR;
        ((Unit *)c)->value[r[i]] = v[i];
    }
    control(((Unit *)c)->value);
    return OK;
}
int fmi2GetReal(void *c, const Reference r[], size_t n, double v[]) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return ERROR;
        v[i] = ((Unit *)c)->value[r[i]];
    }
    return OK;
}
int fmi2DoStep(void *c, double t, double h, int no_set) { (void)t; (void)h; (void)no_set; control(((Unit *)c)->value); return OK; }
int fmi2CancelStep(void *c) { (void)c; return ERROR; }

int fmi2GetFMUstate(void *c, void **s) {
    if (!*s && !(*s = malloc(sizeof(Unit)))) return ERROR;
    memcpy(*s, c, sizeof(Unit));
    return OK;
}
int fmi2SetFMUstate(void *c, void *s) { memcpy(c, s, sizeof(Unit)); return OK; }
int fmi2FreeFMUstate(void *c, void **s) { (void)c; free(*s); *s = NULL; return OK; }
int fmi2SerializedFMUstateSize(void *c, void *s, size_t *n) { (void)c; (void)s; *n = sizeof(Unit); return OK; }
int fmi2SerializeFMUstate(void *c, void *s, char b[], size_t n) { (void)c; memcpy(b, s, n); return OK; }
int fmi2DeSerializeFMUstate(void *c, const char b[], size_t n, void **s) {
    (void)c;
    if (n != sizeof(Unit) || (!*s && !(*s = malloc(sizeof(Unit))))) return ERROR;
    memcpy(*s, b, n);
    return OK;
}

/* it has nothing but real numbers, and gives no derivatives */
#define REFUSE(name) int name(void *c, const void *r, size_t n, const void *v) { (void)c; (void)r; (void)v; return n ? ERROR : OK; }
REFUSE(fmi2GetInteger) REFUSE(fmi2GetBoolean) REFUSE(fmi2GetString) REFUSE(fmi2SetInteger) REFUSE(fmi2SetBoolean) REFUSE(fmi2SetString)
#define NONE(name) int name(void *c) { (void)c; return ERROR; }
NONE(fmi2GetDirectionalDerivative) NONE(fmi2SetRealInputDerivatives) NONE(fmi2GetRealOutputDerivatives)
NONE(fmi2GetStatus) NONE(fmi2GetRealStatus) NONE(fmi2GetIntegerStatus) NONE(fmi2GetBooleanStatus) NONE(fmi2GetStringStatus)
