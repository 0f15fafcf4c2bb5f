/* A case as a functional mock-up unit for co-simulation, of FMI 2 (-DFMI=2) or FMI 3 (-DFMI=3), in C99.
 *
 * The solver runs in a child process, which this library drives by heavylift_client.c; nothing of Python is loaded into
 * the host, and the child ends with it. The folder of resources says what there is:
 *
 *     variables.txt   a line a variable in the order of value references, from 1 on: "held VALUE NAME" or "linear VALUE
 *                     NAME" of an input with the 64 bits of its start value in hexadecimal digits, which are the same in
 *                     all locales of hosts, "output NAME"; reference 0 is the time
 *     command.txt     arguments of the command that serves the case, a line each; a leading "@" stands for this folder
 *     python.txt      the Python that has written it
 *
 * That Python is taken if it is there, else "python3"; HEAVYLIFT_PYTHON names another one. HEAVYLIFT_TIMEOUT is the longest
 * time [s] of an answer, 600 by default. Declarations follow FMI 2.0.5 and FMI 3.0.2.
 */
#define _POSIX_C_SOURCE 200809L
#include "heavylift_client.c"

#include <stdarg.h>
#include <stdbool.h>

#if defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

enum { OK = 0, ERROR = 3, FATAL = 4 }; /* of both standards */

#if FMI == 2
typedef unsigned int Reference;
typedef struct {
    void (*log)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *place;
} Callbacks;
#else
typedef uint32_t Reference;
typedef void (*Log)(void *, int, const char *, const char *);
#endif

typedef struct {
    hl_client *client;
    char *name, *texts;      /* of the instance; of the variables */
    const char **names;      /* of variables, by reference - 1 */
    double *values, *rates;  /* of inputs, and of the outputs that were read last */
    unsigned char *linear;   /* inputs that arrive at the end of a step */
    unsigned char *pending;  /* inputs that the other process has not been told */
    unsigned char *wanted;   /* outputs that were asked for */
    unsigned char *known;    /* outputs whose value is that of now */
    const char **asked;      /* room for the names of a request */
    double *given, *slopes;  /* and for its numbers */
    size_t *places;
    size_t count, inputs;
    int64_t begin;           /* the state at the start */
    double time;             /* of the host's clock [s], which may start anywhere */
    void *place;
#if FMI == 2
    const Callbacks *callbacks;
#else
    Log log;
#endif
} Unit;

/* Of an instance: what is not in the other process, and there a state; or its bytes. */
typedef struct {
    int64_t state;
    double time;
    double *values, *rates;
    unsigned char *pending;
    void *bytes;
    size_t size;
} State;

static int fail(Unit *unit, int status, const char *format, ...)
{
    char words[1400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
#if FMI == 2
    if (unit->callbacks && unit->callbacks->log)
        unit->callbacks->log(unit->place, unit->name, status, status == FATAL ? "logStatusFatal" : "logStatusError", "%s", words);
#else
    if (unit->log) unit->log(unit->place, status, status == FATAL ? "logStatusFatal" : "logStatusError", words);
#endif
    return status;
}

/* What a call of the client has come to. */
static int outcome(Unit *unit, int code)
{
    if (code == HL_OK) return OK;
    return fail(unit, code == HL_LOST || code == HL_INTERNAL || code == HL_MEMORY ? FATAL : ERROR, "%s", hl_error(unit->client));
}

/* ---- what there is ---- */

/* A file of the resources with a NUL behind it; NULL if it cannot be read. */
static char *content(const char *folder, const char *name)
{
    char path[4096], *text = NULL;
    FILE *file;
    long size;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return NULL;
    file = fopen(path, "rb");
    if (!file) return NULL;
    if (!fseek(file, 0, SEEK_END) && (size = ftell(file)) >= 0 && !fseek(file, 0, SEEK_SET)) {
        text = malloc((size_t)size + 1);
        if (text) text[fread(text, 1, (size_t)size, file)] = 0;
    }
    fclose(file);
    return text;
}

static size_t lines_of(const char *text)
{
    size_t count = 0;
    for (; *text; text++) count += *text == '\n';
    return count;
}

static int read_variables(Unit *unit, const char *folder)
{
    char *line, *end;
    size_t k, count;
    uint64_t bits;
    unit->texts = content(folder, "variables.txt");
    if (!unit->texts) return fail(unit, ERROR, "%s: variables.txt cannot be read", folder);
    count = lines_of(unit->texts);
    unit->count = count;
    unit->names = calloc(count + 1, sizeof *unit->names);
    unit->asked = calloc(count + 1, sizeof *unit->asked);
    unit->values = calloc(count + 1, sizeof *unit->values);
    unit->rates = calloc(count + 1, sizeof *unit->rates);
    unit->given = calloc(count + 1, sizeof *unit->given);
    unit->slopes = calloc(count + 1, sizeof *unit->slopes);
    unit->places = calloc(count + 1, sizeof *unit->places);
    unit->linear = calloc(count + 1, 1);
    unit->pending = calloc(count + 1, 1);
    unit->wanted = calloc(count + 1, 1);
    unit->known = calloc(count + 1, 1);
    if (!unit->names || !unit->asked || !unit->values || !unit->rates || !unit->given || !unit->slopes || !unit->places ||
        !unit->linear || !unit->pending || !unit->wanted || !unit->known)
        return fail(unit, FATAL, "there is no memory for %lu variables", (unsigned long)count);
    for (k = 0, line = unit->texts; k < count; k++, line = end + 1) {
        end = strchr(line, '\n');
        *end = 0;
        if (!strncmp(line, "output ", 7)) {
            unit->names[k] = line + 7;
            continue;
        }
        unit->linear[k] = !strncmp(line, "linear ", 7);
        line = strchr(line, ' ');
        if (!line || k != unit->inputs) return fail(unit, ERROR, "%s: variables.txt is damaged", folder);
        bits = strtoull(line + 1, &line, 16);
        memcpy(&unit->values[k], &bits, sizeof bits);
        unit->names[k] = *line ? line + 1 : line;
        unit->inputs++;
    }
    return OK;
}

/* Start the process that serves the case. */
static int serve(Unit *unit, const char *folder)
{
    char *text = content(folder, "command.txt"), *python = content(folder, "python.txt"), *line, *end, *at;
    const char *chosen = getenv("HEAVYLIFT_PYTHON"), *limit = getenv("HEAVYLIFT_TIMEOUT");
    const char **arguments = NULL;
    char *room = NULL;
    double timeout = limit ? strtod(limit, NULL) : 600.0;
    size_t k = 0, count = text ? lines_of(text) : 0;
    int code, status;
    if (text && python) {
        arguments = calloc(count + 2, sizeof *arguments);
        room = malloc(strlen(text) + (count + 1) * (strlen(folder) + 2));
    }
    if (!arguments || !room) {
        status = fail(unit, ERROR, "%s: command.txt or python.txt cannot be read", folder);
    } else {
        python[strcspn(python, "\n")] = 0;
        if (!chosen || !*chosen) chosen = access(python, X_OK) ? "python3" : python;
        arguments[k++] = chosen;
        for (line = text, at = room; k <= count; line = end + 1) {
            end = strchr(line, '\n');
            *end = 0;
            arguments[k++] = at;
            at += 1 + (*line == '@' ? sprintf(at, "%s%s", folder, line + 1) : sprintf(at, "%s", line));
        }
        code = hl_open_child(&unit->client, arguments, timeout > 0.0 ? timeout : 600.0);
        status = OK;
        if (code == HL_LOST)
            status = fail(unit, ERROR, "%s; %s must be a Python with heavylift, or set HEAVYLIFT_PYTHON to one",
                          hl_error(unit->client), chosen);
        else if (code)
            status = fail(unit, ERROR, "%s", hl_error(unit->client));
    }
    free(text);
    free(python);
    free(arguments);
    free(room);
    return status == OK ? outcome(unit, hl_save(unit->client, &unit->begin)) : status;
}

static void dispose(Unit *unit)
{
    if (!unit) return;
    hl_close(unit->client, 1);
    free(unit->name);
    free(unit->texts);
    free(unit->names);
    free(unit->asked);
    free(unit->values);
    free(unit->rates);
    free(unit->given);
    free(unit->slopes);
    free(unit->places);
    free(unit->linear);
    free(unit->pending);
    free(unit->wanted);
    free(unit->known);
    free(unit);
}

/* Fill an instance whose log is there; NULL if it cannot be, and then it is gone. */
static Unit *begin(Unit *unit, const char *name, const char *token, const char *folder)
{
    char *path = folder ? strdup(folder) : NULL, *expected;
    size_t size = path ? strlen(path) : 0;
    int status = OK;
    unit->name = strdup(name ? name : "heavylift");
    while (size > 1 && path[size - 1] == '/') path[--size] = 0;
    if (!path || !unit->name) {
        status = fail(unit, ERROR, "no folder of resources is given");
    } else {
        expected = content(path, "token.txt");
        if (!expected || !token || strcmp(expected, token))
            status = fail(unit, ERROR, "the token %s is not that of this unit", token ? token : "");
        free(expected);
        if (status == OK) status = read_variables(unit, path);
        if (status == OK) status = serve(unit, path);
    }
    free(path);
    if (status == OK) return unit;
    dispose(unit);
    return NULL;
}

/* ---- values ---- */

static int check(Unit *unit, const Reference references[], size_t count, int inputs)
{
    size_t k;
    for (k = 0; k < count; k++)
        if (references[k] > (inputs ? unit->inputs : unit->count) || (inputs && references[k] == 0))
            return fail(unit, ERROR, "value reference %lu is not that of an %s", (unsigned long)references[k],
                        inputs ? "input" : "input or output");
    return OK;
}

static int set_values(Unit *unit, const Reference references[], size_t count, const double values[])
{
    size_t k;
    int status = check(unit, references, count, 1);
    if (status) return status;
    for (k = 0; k < count; k++) {
        size_t i = references[k] - 1;
        if (!isfinite(values[k])) return fail(unit, ERROR, "%s: %g is not finite", unit->names[i], values[k]);
        unit->values[i] = values[k];
        unit->rates[i] = 0.0;
        unit->pending[i] = 1;
    }
    return OK;
}

/* Values of outputs that are wanted are read at once, with the next step too. */
static int get_values(Unit *unit, const Reference references[], size_t count, double values[])
{
    size_t k, i, missing = 0;
    int status = check(unit, references, count, 0);
    if (status) return status;
    for (k = 0; k < count; k++) {
        if (references[k] == 0) continue;
        i = references[k] - 1;
        if (i < unit->inputs || unit->known[i]) continue;
        unit->wanted[i] = 1;
        missing = 1;
    }
    if (missing) {
        for (i = unit->inputs, missing = 0; i < unit->count; i++) {
            if (!unit->wanted[i] || unit->known[i]) continue;
            unit->asked[missing] = unit->names[i];
            unit->places[missing++] = i;
        }
        status = outcome(unit, hl_get(unit->client, missing, unit->asked, unit->given));
        if (status) return status;
        for (k = 0; k < missing; k++) {
            unit->values[unit->places[k]] = unit->given[k];
            unit->known[unit->places[k]] = 1;
        }
    }
    for (k = 0; k < count; k++) values[k] = references[k] ? unit->values[references[k] - 1] : unit->time;
    return OK;
}

static int step(Unit *unit, double time, double dt)
{
    size_t k, told = 0, read = 0;
    int sloped = 0, code;
    const char **outputs;
    if (fabs(time - unit->time) > 1e-9 * (1.0 + fabs(time)))
        return fail(unit, ERROR, "a step from t = %.9g s, and the unit is at %.9g s", time, unit->time);
    for (k = 0; k < unit->inputs; k++) {
        if (!unit->pending[k]) continue;
        unit->asked[told] = unit->names[k];
        unit->given[told] = unit->values[k] + (unit->linear[k] ? unit->rates[k] * dt : 0.0); /* where it arrives */
        unit->slopes[told++] = unit->linear[k] || unit->rates[k] == 0.0 ? HL_NO_RATE : unit->rates[k];
        sloped |= !unit->linear[k] && unit->rates[k] != 0.0;
    }
    outputs = unit->asked + told;
    for (k = unit->inputs; k < unit->count; k++) {
        unit->known[k] = 0;
        if (!unit->wanted[k]) continue;
        outputs[read] = unit->names[k];
        unit->places[read++] = k;
    }
    code = hl_step(unit->client, dt, told, unit->asked, unit->given, sloped ? unit->slopes : NULL, read, outputs,
                   unit->given + told);
    if (code) return outcome(unit, code);
    for (k = 0; k < read; k++) {
        unit->values[unit->places[k]] = unit->given[told + k];
        unit->known[unit->places[k]] = 1;
    }
    for (k = 0; k < unit->inputs; k++) {
        unit->pending[k] = unit->rates[k] != 0.0; /* it goes on from there */
        unit->values[k] += unit->rates[k] * dt;
    }
    unit->time = time + dt;
    return OK;
}

/* ---- states ---- */

static void forget(Unit *unit)
{
    memset(unit->known, 0, unit->count);
}

static void release(State *state)
{
    if (!state) return;
    free(state->values);
    free(state->rates);
    free(state->pending);
    free(state->bytes);
    free(state);
}

static State *new_state(const Unit *unit)
{
    State *state = calloc(1, sizeof *state);
    if (!state) return NULL;
    state->values = malloc((unit->inputs + 1) * sizeof *state->values);
    state->rates = malloc((unit->inputs + 1) * sizeof *state->rates);
    state->pending = malloc(unit->inputs + 1);
    if (state->values && state->rates && state->pending) return state;
    release(state);
    return NULL;
}

static int free_state(Unit *unit, State **state)
{
    int code = HL_OK;
    if (!state || !*state) return OK;
    if ((*state)->state) code = hl_free(unit->client, (*state)->state);
    release(*state);
    *state = NULL;
    return outcome(unit, code);
}

static int get_state(Unit *unit, State **kept)
{
    int status = free_state(unit, kept);
    State *state = new_state(unit);
    if (status || !state) {
        release(state);
        return status ? status : fail(unit, FATAL, "there is no memory for a state");
    }
    status = outcome(unit, hl_save(unit->client, &state->state));
    if (status) {
        release(state);
        return status;
    }
    state->time = unit->time;
    memcpy(state->values, unit->values, unit->inputs * sizeof *state->values);
    memcpy(state->rates, unit->rates, unit->inputs * sizeof *state->rates);
    memcpy(state->pending, unit->pending, unit->inputs);
    *kept = state;
    return OK;
}

static int set_state(Unit *unit, const State *state)
{
    int status;
    if (!state) return fail(unit, ERROR, "no state is given");
    status = outcome(unit, state->state ? hl_restore(unit->client, state->state)
                                        : hl_restore_bytes(unit->client, state->bytes, state->size));
    if (status) return status;
    unit->time = state->time;
    memcpy(unit->values, state->values, unit->inputs * sizeof *state->values);
    memcpy(unit->rates, state->rates, unit->inputs * sizeof *state->rates);
    memcpy(unit->pending, state->pending, unit->inputs);
    forget(unit);
    return OK;
}

#define HEAD "heavylift fmu 1"

/* Bytes of a state in this machine's order: head, time, inputs, and the state of the other process. */
static size_t head_size(const Unit *unit)
{
    return sizeof HEAD + sizeof(double) + unit->inputs * (2 * sizeof(double) + 1);
}

static int load_bytes(Unit *unit, State *state)
{
    const void *bytes;
    int status;
    if (state->bytes) return OK;
    status = outcome(unit, hl_save_bytes(unit->client, state->state, &bytes, &state->size));
    if (status) return status;
    state->bytes = malloc(state->size ? state->size : 1);
    if (!state->bytes) return fail(unit, FATAL, "there is no memory for a state");
    memcpy(state->bytes, bytes, state->size);
    return OK;
}

static int serialized_size(Unit *unit, State *state, size_t *size)
{
    int status = state ? load_bytes(unit, state) : fail(unit, ERROR, "no state is given");
    if (!status) *size = head_size(unit) + state->size;
    return status;
}

static void move(unsigned char **at, const void *data, size_t size)
{
    memcpy(*at, data, size);
    *at += size;
}

static int serialize(Unit *unit, State *state, void *to, size_t room)
{
    size_t size = 0, n = unit->inputs;
    unsigned char *at = to;
    int status = serialized_size(unit, state, &size);
    if (status) return status;
    if (room < size) return fail(unit, ERROR, "%lu bytes for a state of %lu", (unsigned long)room, (unsigned long)size);
    move(&at, HEAD, sizeof HEAD);
    move(&at, &state->time, sizeof(double));
    move(&at, state->values, n * sizeof(double));
    move(&at, state->rates, n * sizeof(double));
    move(&at, state->pending, n);
    move(&at, state->bytes, state->size);
    return OK;
}

static void take(const unsigned char **at, void *data, size_t size)
{
    memcpy(data, *at, size);
    *at += size;
}

static int deserialize(Unit *unit, const void *from, size_t size, State **kept)
{
    size_t n = unit->inputs;
    const unsigned char *at = from;
    State *state;
    int status;
    if (size < head_size(unit) || memcmp(at, HEAD, sizeof HEAD))
        return fail(unit, ERROR, "%lu bytes that are no state of this unit", (unsigned long)size);
    status = free_state(unit, kept);
    if (status) return status;
    state = new_state(unit);
    if (state) {
        state->size = size - head_size(unit);
        state->bytes = malloc(state->size ? state->size : 1);
    }
    if (!state || !state->bytes) {
        release(state);
        return fail(unit, FATAL, "there is no memory for a state");
    }
    at += sizeof HEAD;
    take(&at, &state->time, sizeof(double));
    take(&at, state->values, n * sizeof(double));
    take(&at, state->rates, n * sizeof(double));
    take(&at, state->pending, n);
    take(&at, state->bytes, state->size);
    *kept = state;
    return OK;
}

static int reset(Unit *unit)
{
    int status = outcome(unit, hl_restore(unit->client, unit->begin));
    const char *line;
    size_t k;
    const hl_description *about;
    if (status) return status;
    status = outcome(unit, hl_describe(unit->client, &about));
    if (status) return status;
    for (k = 0; k < unit->inputs; k++) {
        line = unit->names[k];
        unit->values[k] = k < about->input_count && !strcmp(about->inputs[k].name, line) ? about->inputs[k].value : 0.0;
        unit->rates[k] = 0.0;
        unit->pending[k] = 0;
    }
    unit->time = 0.0;
    forget(unit);
    return OK;
}

static int setup(Unit *unit, double start)
{
    if (start != 0.0) return fail(unit, ERROR, "a start at t = %g s: a case begins at 0", start);
    unit->time = start;
    return OK;
}

/* ---- what the standards name besides ---- */

static int refuse(Unit *unit, const char *name)
{
    return unit ? fail(unit, ERROR, "%s: this unit has inputs and outputs that are numbers, and co-simulation alone", name) : ERROR;
}
#define REFUSE(name)                                     \
    EXPORTED int name(void *unit);                       \
    EXPORTED int name(void *unit) { return refuse(unit, #name); }
#define REFUSE_SOME(name)                                                        \
    EXPORTED int name(void *unit, const Reference references[], size_t count);   \
    EXPORTED int name(void *unit, const Reference references[], size_t count)    \
    {                                                                            \
        (void)references;                                                        \
        return count ? refuse(unit, #name) : OK;                                 \
    }
#define DEFINE(type, name, parameters) \
    EXPORTED type name parameters;     \
    EXPORTED type name parameters

#if FMI == 2

REFUSE_SOME(fmi2SetInteger)
REFUSE_SOME(fmi2SetBoolean)
REFUSE_SOME(fmi2SetString)
REFUSE_SOME(fmi2GetInteger)
REFUSE_SOME(fmi2GetBoolean)
REFUSE_SOME(fmi2GetString)
REFUSE_SOME(fmi2GetRealOutputDerivatives)
REFUSE(fmi2GetDirectionalDerivative)
REFUSE(fmi2CancelStep)
REFUSE(fmi2GetStatus)
REFUSE(fmi2GetRealStatus)
REFUSE(fmi2GetIntegerStatus)
REFUSE(fmi2GetBooleanStatus)
REFUSE(fmi2GetStringStatus)

DEFINE(const char *, fmi2GetTypesPlatform, (void)) { return "default"; }
DEFINE(const char *, fmi2GetVersion, (void)) { return "2.0"; }

/* A path of a "file:" URI: escapes are bytes. */
static char *path_of(const char *uri)
{
    char *path, *to;
    if (!uri) return NULL;
    if (!strncmp(uri, "file:", 5)) {
        uri += 5;
        if (!strncmp(uri, "//", 2)) {
            uri = strchr(uri + 2, '/');
            if (!uri) return NULL;
        }
    }
    to = path = malloc(strlen(uri) + 1);
    if (!path) return NULL;
    while (*uri) {
        unsigned byte;
        if (*uri == '%' && uri[1] && sscanf(uri + 1, "%2x", &byte) == 1) {
            *to++ = (char)byte;
            uri += 3;
        } else {
            *to++ = *uri++;
        }
    }
    *to = 0;
    return path;
}

DEFINE(void *, fmi2Instantiate, (const char *name, int kind, const char *token, const char *place, const Callbacks *callbacks,
                                 int visible, int logging))
{
    Unit *unit = calloc(1, sizeof *unit);
    char *folder;
    (void)visible;
    (void)logging;
    if (!unit) return NULL;
    unit->callbacks = callbacks;
    unit->place = callbacks ? callbacks->place : NULL;
    if (kind != 1) {
        fail(unit, ERROR, "model exchange; this unit brings its own solver");
        free(unit);
        return NULL;
    }
    folder = path_of(place);
    unit = begin(unit, name, token, folder);
    free(folder);
    return unit;
}

DEFINE(void, fmi2FreeInstance, (void *unit)) { dispose(unit); }
DEFINE(int, fmi2SetDebugLogging, (void *unit, int on, size_t count, const char *const categories[]))
{
    (void)unit;
    (void)on;
    (void)count;
    (void)categories;
    return OK; /* errors alone are logged, and always */
}
DEFINE(int, fmi2SetupExperiment, (void *unit, int tolerates, double tolerance, double start, int stops, double stop))
{
    (void)tolerates;
    (void)tolerance;
    (void)stops;
    (void)stop;
    return setup(unit, start);
}
DEFINE(int, fmi2EnterInitializationMode, (void *unit)) { return unit ? OK : ERROR; }
DEFINE(int, fmi2ExitInitializationMode, (void *unit)) { return unit ? OK : ERROR; }
DEFINE(int, fmi2Terminate, (void *unit)) { return unit ? OK : ERROR; }
DEFINE(int, fmi2Reset, (void *unit)) { return reset(unit); }
DEFINE(int, fmi2SetReal, (void *unit, const Reference references[], size_t count, const double values[]))
{
    return set_values(unit, references, count, values);
}
DEFINE(int, fmi2GetReal, (void *unit, const Reference references[], size_t count, double values[]))
{
    return get_values(unit, references, count, values);
}
DEFINE(int, fmi2SetRealInputDerivatives, (void *instance, const Reference references[], size_t count, const int orders[],
                                          const double values[]))
{
    Unit *unit = instance;
    size_t k;
    int status = check(unit, references, count, 1);
    if (status) return status;
    for (k = 0; k < count; k++) {
        size_t i = references[k] - 1;
        if (orders[k] != 1) return fail(unit, ERROR, "%s: a derivative of order %d; expected 1", unit->names[i], orders[k]);
        if (!isfinite(values[k])) return fail(unit, ERROR, "%s: a rate of %g", unit->names[i], values[k]);
        unit->rates[i] = values[k];
        unit->pending[i] = 1;
    }
    return OK;
}
DEFINE(int, fmi2DoStep, (void *unit, double time, double dt, int final))
{
    (void)final;
    return step(unit, time, dt);
}
DEFINE(int, fmi2GetFMUstate, (void *unit, void **state)) { return get_state(unit, (State **)state); }
DEFINE(int, fmi2SetFMUstate, (void *unit, void *state)) { return set_state(unit, state); }
DEFINE(int, fmi2FreeFMUstate, (void *unit, void **state)) { return free_state(unit, (State **)state); }
DEFINE(int, fmi2SerializedFMUstateSize, (void *unit, void *state, size_t *size)) { return serialized_size(unit, state, size); }
DEFINE(int, fmi2SerializeFMUstate, (void *unit, void *state, char bytes[], size_t size))
{
    return serialize(unit, state, bytes, size);
}
DEFINE(int, fmi2DeSerializeFMUstate, (void *unit, const char bytes[], size_t size, void **state))
{
    return deserialize(unit, bytes, size, (State **)state);
}

#else

REFUSE_SOME(fmi3GetFloat32)
REFUSE_SOME(fmi3GetInt8)
REFUSE_SOME(fmi3GetUInt8)
REFUSE_SOME(fmi3GetInt16)
REFUSE_SOME(fmi3GetUInt16)
REFUSE_SOME(fmi3GetInt32)
REFUSE_SOME(fmi3GetUInt32)
REFUSE_SOME(fmi3GetInt64)
REFUSE_SOME(fmi3GetUInt64)
REFUSE_SOME(fmi3GetBoolean)
REFUSE_SOME(fmi3GetString)
REFUSE_SOME(fmi3GetBinary)
REFUSE_SOME(fmi3GetClock)
REFUSE_SOME(fmi3SetFloat32)
REFUSE_SOME(fmi3SetInt8)
REFUSE_SOME(fmi3SetUInt8)
REFUSE_SOME(fmi3SetInt16)
REFUSE_SOME(fmi3SetUInt16)
REFUSE_SOME(fmi3SetInt32)
REFUSE_SOME(fmi3SetUInt32)
REFUSE_SOME(fmi3SetInt64)
REFUSE_SOME(fmi3SetUInt64)
REFUSE_SOME(fmi3SetBoolean)
REFUSE_SOME(fmi3SetString)
REFUSE_SOME(fmi3SetBinary)
REFUSE_SOME(fmi3SetClock)
REFUSE_SOME(fmi3GetIntervalDecimal)
REFUSE_SOME(fmi3GetIntervalFraction)
REFUSE_SOME(fmi3GetShiftDecimal)
REFUSE_SOME(fmi3GetShiftFraction)
REFUSE_SOME(fmi3SetIntervalDecimal)
REFUSE_SOME(fmi3SetIntervalFraction)
REFUSE_SOME(fmi3SetShiftDecimal)
REFUSE_SOME(fmi3SetShiftFraction)
REFUSE_SOME(fmi3GetOutputDerivatives)
REFUSE(fmi3ActivateModelPartition)
REFUSE(fmi3CompletedIntegratorStep)
REFUSE(fmi3EnterConfigurationMode)
REFUSE(fmi3EnterContinuousTimeMode)
REFUSE(fmi3EnterEventMode)
REFUSE(fmi3EnterStepMode)
REFUSE(fmi3EvaluateDiscreteStates)
REFUSE(fmi3ExitConfigurationMode)
REFUSE(fmi3GetAdjointDerivative)
REFUSE(fmi3GetContinuousStateDerivatives)
REFUSE(fmi3GetContinuousStates)
REFUSE(fmi3GetDirectionalDerivative)
REFUSE(fmi3GetEventIndicators)
REFUSE(fmi3GetNominalsOfContinuousStates)
REFUSE(fmi3GetNumberOfContinuousStates)
REFUSE(fmi3GetNumberOfEventIndicators)
REFUSE(fmi3GetNumberOfVariableDependencies)
REFUSE(fmi3GetVariableDependencies)
REFUSE(fmi3SetContinuousStates)
REFUSE(fmi3SetTime)
REFUSE(fmi3UpdateDiscreteStates)

DEFINE(void *, fmi3InstantiateModelExchange, (void)) { return NULL; }
DEFINE(void *, fmi3InstantiateScheduledExecution, (void)) { return NULL; }
DEFINE(const char *, fmi3GetVersion, (void)) { return "3.0"; }

DEFINE(void *, fmi3InstantiateCoSimulation,
       (const char *name, const char *token, const char *folder, bool visible, bool logging, bool events, bool early,
        const Reference required[], size_t count, void *place, Log log, void *update))
{
    Unit *unit = calloc(1, sizeof *unit);
    (void)visible;
    (void)logging;
    (void)events;
    (void)early;
    (void)required;
    (void)count;
    (void)update;
    if (!unit) return NULL;
    unit->log = log;
    unit->place = place;
    return begin(unit, name, token, folder);
}
DEFINE(void, fmi3FreeInstance, (void *unit)) { dispose(unit); }
DEFINE(int, fmi3SetDebugLogging, (void *unit, bool on, size_t count, const char *const categories[]))
{
    (void)unit;
    (void)on;
    (void)count;
    (void)categories;
    return OK; /* errors alone are logged, and always */
}
DEFINE(int, fmi3EnterInitializationMode, (void *unit, bool tolerates, double tolerance, double start, bool stops, double stop))
{
    (void)tolerates;
    (void)tolerance;
    (void)stops;
    (void)stop;
    return setup(unit, start);
}
DEFINE(int, fmi3ExitInitializationMode, (void *unit)) { return unit ? OK : ERROR; }
DEFINE(int, fmi3Terminate, (void *unit)) { return unit ? OK : ERROR; }
DEFINE(int, fmi3Reset, (void *unit)) { return reset(unit); }
DEFINE(int, fmi3SetFloat64, (void *unit, const Reference references[], size_t count, const double values[], size_t size))
{
    (void)size;
    return set_values(unit, references, count, values);
}
DEFINE(int, fmi3GetFloat64, (void *unit, const Reference references[], size_t count, double values[], size_t size))
{
    (void)size;
    return get_values(unit, references, count, values);
}
DEFINE(int, fmi3DoStep, (void *instance, double time, double dt, bool final, bool *event, bool *terminate, bool *early,
                         double *last))
{
    Unit *unit = instance;
    int status = step(unit, time, dt);
    (void)final;
    *event = *terminate = *early = false;
    *last = unit->time;
    return status;
}
DEFINE(int, fmi3GetFMUState, (void *unit, void **state)) { return get_state(unit, (State **)state); }
DEFINE(int, fmi3SetFMUState, (void *unit, void *state)) { return set_state(unit, state); }
DEFINE(int, fmi3FreeFMUState, (void *unit, void **state)) { return free_state(unit, (State **)state); }
DEFINE(int, fmi3SerializedFMUStateSize, (void *unit, void *state, size_t *size)) { return serialized_size(unit, state, size); }
DEFINE(int, fmi3SerializeFMUState, (void *unit, void *state, uint8_t bytes[], size_t size))
{
    return serialize(unit, state, bytes, size);
}
DEFINE(int, fmi3DeserializeFMUState, (void *unit, const uint8_t bytes[], size_t size, void **state))
{
    return deserialize(unit, bytes, size, (State **)state);
}

#endif
