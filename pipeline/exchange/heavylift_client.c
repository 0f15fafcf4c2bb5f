/* A client of a served case in C99, in one file without dependencies but POSIX: over TCP, or to a child process.
 *
 *     heavylift serve CASE --port 5000          hl_connect(&crane, "127.0.0.1", 5000, token, "master", 600.0)
 *     (no command: it is started)               hl_open_child(&crane, argv, 600.0)
 *
 * Include this file in one source file; in others, if there are some, define HEAVYLIFT_CLIENT_DECLARATIONS first.
 *
 * Each function returns HL_OK or what went wrong, of which hl_error has the words. A client belongs to one thread at a
 * time; several clients are independent. The format of the messages is that of docs/interface.md, protocol 1.
 */
#ifndef HEAVYLIFT_CLIENT_H
#define HEAVYLIFT_CLIENT_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define HL_NO_RATE HUGE_VAL /* of an input among others that have rates */

#ifdef __cplusplus
extern "C" {
#endif

enum {
    HL_OK = 0,
    HL_INPUT = 1,    /* the call is wrong; nothing has changed */
    HL_STOPPED = 2,  /* the simulation has stopped by itself; what was computed is kept */
    HL_REFUSED = 3,  /* the server does not do this for this client */
    HL_INTERNAL = 4, /* a fault of the other program */
    HL_LOST = 5,     /* the connection cannot be used any more: the other process is gone, or silent for too long */
    HL_MEMORY = 6    /* there is no memory for it */
};

typedef struct hl_client hl_client;

/* An input or an output: SI unit, and what it is. Of an input also how it goes from value to value ("held" or "linear"),
 * its value, and its limits, infinite without. */
typedef struct {
    const char *name, *unit, *sentence, *interpolation;
    double value, smallest, largest;
} hl_port;

typedef struct {
    size_t input_count, output_count;
    const hl_port *inputs, *outputs;
    double step_size, duration; /* [s] */
} hl_description;

/* Start a command, as {"heavylift", "serve", "CASE", "--pipe", "--quiet", NULL}, and drive what it serves; it ends with
 * this process. Answers have to come within `timeout` [s]. The client has to be closed, also after an error. */
int hl_open_child(hl_client **client, const char *const argv[], double timeout);

/* Connect to a server, as "master" or "observer". The client has to be closed, also after an error. */
int hl_connect(hl_client **client, const char *host, int port, const char *token, const char *role, double timeout);

/* The same, with host, port and token from a file of `heavylift serve CASE --token-file FILE`. */
int hl_connect_file(hl_client **client, const char *file, const char *role, double timeout);

/* What the simulation has; valid until the next call of this function. */
int hl_describe(hl_client *client, const hl_description **description);

/* Set inputs from now on. `rates` [1/s] may be NULL, or have HL_NO_RATE. */
int hl_set(hl_client *client, size_t count, const char *const names[], const double values[], const double rates[]);

/* Advance by dt [s], a multiple of the step, and read outputs at the end. Held inputs act from now on, linear ones are
 * reached at the end; with rates, values are those of now. */
int hl_step(hl_client *client, double dt, size_t input_count, const char *const inputs[], const double values[],
            const double rates[], size_t output_count, const char *const outputs[], double results[]);

/* Read outputs of one number each. */
int hl_get(hl_client *client, size_t count, const char *const names[], double results[]);

/* Keep the state, inputs included, in the other process; go back to it; forget it. */
int hl_save(hl_client *client, int64_t *state);
int hl_restore(hl_client *client, int64_t state);
int hl_free(hl_client *client, int64_t state);

/* The state as bytes, which another process can go on from; of a state that is kept, or 0: of the present one. They are
 * valid until the next call with this client. */
int hl_save_bytes(hl_client *client, int64_t state, const void **bytes, size_t *size);
int hl_restore_bytes(hl_client *client, const void *bytes, size_t size);

/* Time of the simulation [s] after the last answer that said it, and whether it goes no further. */
double hl_time(const hl_client *client);
int hl_ended(const hl_client *client);

/* Words for what went wrong in the last call; empty if nothing did. */
const char *hl_error(const hl_client *client);

/* Close the connection; a master ends the run by it, unless `end` is 0. A child ends in any case. */
void hl_close(hl_client *client, int end);

#ifdef __cplusplus
}
#endif
#endif

#ifndef HEAVYLIFT_CLIENT_DECLARATIONS
#if !defined(_POSIX_C_SOURCE) && !defined(_GNU_SOURCE) && !defined(__APPLE__)
#error "define _POSIX_C_SOURCE 200809L before the first header"
#endif

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define HL_PROTOCOL 1
#define HL_LARGEST (1u << 26) /* bytes of a message */
#define HL_DEPTH 16           /* of lists and maps in an answer */
#define HL_STOP_SECONDS 60.0  /* that a child has to write its results and end */

typedef struct {
    unsigned char *data;
    size_t size, room;
    int failed;
} hl_buffer;

/* Bytes that are read from the front; `bad` once they have not been what was expected. */
typedef struct {
    const unsigned char *at, *end;
    int bad;
} hl_reader;

struct hl_client {
    int socket;
    pid_t child;
    int64_t number;
    int ended;
    double timeout, time;
    hl_buffer request, answer, texts;
    hl_port *ports;
    hl_description description;
    char error[1024];
};

/* ---- words ---- */

static int hl__fail(hl_client *c, int code, const char *words, const char *more)
{
    snprintf(c->error, sizeof c->error, "%s%s%s", words, *more ? ": " : "", more);
    return code;
}

static int hl__lost(hl_client *c, const char *words, const char *more)
{
    if (c->socket >= 0) close(c->socket);
    c->socket = -1;
    return hl__fail(c, HL_LOST, words, more);
}

/* ---- writing msgpack ---- */

static unsigned char *hl__room(hl_buffer *b, size_t size)
{
    if (b->failed || size > (size_t)-1 - b->size) {
        b->failed = 1;
        return NULL;
    }
    if (b->size + size > b->room) {
        size_t room = b->size + size < 512 ? 1024 : 2 * (b->size + size);
        unsigned char *data = realloc(b->data, room);
        if (!data) {
            b->failed = 1;
            return NULL;
        }
        b->data = data;
        b->room = room;
    }
    b->size += size;
    return b->data + b->size - size;
}

static void hl__put(hl_buffer *b, const void *data, size_t size)
{
    unsigned char *to = hl__room(b, size);
    if (to && size) memcpy(to, data, size);
}

/* A type and a number of some bytes, the highest first. */
static void hl__put_number(hl_buffer *b, unsigned type, uint64_t number, int bytes)
{
    unsigned char *to = hl__room(b, (size_t)bytes + 1);
    int k;
    if (!to) return;
    to[0] = (unsigned char)type;
    for (k = 0; k < bytes; k++) to[1 + k] = (unsigned char)(number >> 8 * (bytes - 1 - k));
}

static void hl__put_integer(hl_buffer *b, int64_t value) { hl__put_number(b, 0xd3, (uint64_t)value, 8); }
static void hl__put_map(hl_buffer *b, size_t count) { hl__put_number(b, 0xdf, count, 4); }
static void hl__put_list(hl_buffer *b, size_t count) { hl__put_number(b, 0xdd, count, 4); }
static void hl__put_flag(hl_buffer *b, int flag) { hl__put_number(b, flag ? 0xc3 : 0xc2, 0, 0); }

static void hl__put_double(hl_buffer *b, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    hl__put_number(b, 0xcb, bits, 8);
}

static void hl__put_text(hl_buffer *b, const char *text)
{
    size_t size = strlen(text);
    if (size < 32)
        hl__put_number(b, 0xa0u | (unsigned)size, 0, 0);
    else
        hl__put_number(b, 0xdb, size, 4);
    hl__put(b, text, size);
}

/* ---- reading msgpack ---- */

static const unsigned char *hl__take(hl_reader *r, size_t size)
{
    const unsigned char *found = r->at;
    if (r->bad || (size_t)(r->end - r->at) < size) {
        r->bad = 1;
        return NULL;
    }
    r->at += size;
    return found;
}

static uint64_t hl__take_number(hl_reader *r, size_t bytes)
{
    const unsigned char *from = hl__take(r, bytes);
    uint64_t number = 0;
    size_t k;
    for (k = 0; from && k < bytes; k++) number = number << 8 | from[k];
    return number;
}

/* The head of a value: its sort ('n'ull, 'f'lag, 'i'nteger, 'd'ouble, 't'ext, 'b'ytes, 'l'ist, 'm'ap, 'x' else), and its
 * size, count or bits. */
static char hl__head(hl_reader *r, uint64_t *size)
{
    unsigned type = (unsigned)hl__take_number(r, 1);
    *size = 0;
    if (r->bad) return 'x';
    if (type < 0x80) return *size = type, 'i';
    if (type < 0x90) return *size = type & 15, 'm';
    if (type < 0xa0) return *size = type & 15, 'l';
    if (type < 0xc0) return *size = type & 31, 't';
    if (type >= 0xe0) return *size = (uint64_t)((int64_t)type - 256), 'i';
    switch (type) {
    case 0xc0: return 'n';
    case 0xc2: return 'f';
    case 0xc3: return *size = 1, 'f';
    case 0xc4: case 0xc5: case 0xc6: return *size = hl__take_number(r, (size_t)1 << (type - 0xc4)), 'b';
    case 0xca: case 0xcb: return *size = hl__take_number(r, type == 0xca ? 4 : 8), type == 0xca ? 's' : 'd';
    case 0xcc: case 0xcd: case 0xce: case 0xcf: return *size = hl__take_number(r, (size_t)1 << (type - 0xcc)), 'i';
    case 0xd0: *size = (uint64_t)(int64_t)(int8_t)hl__take_number(r, 1); return 'i';
    case 0xd1: *size = (uint64_t)(int64_t)(int16_t)hl__take_number(r, 2); return 'i';
    case 0xd2: *size = (uint64_t)(int64_t)(int32_t)hl__take_number(r, 4); return 'i';
    case 0xd3: return *size = hl__take_number(r, 8), 'i';
    case 0xd9: case 0xda: case 0xdb: return *size = hl__take_number(r, (size_t)1 << (type - 0xd9)), 't';
    case 0xdc: case 0xdd: return *size = hl__take_number(r, type == 0xdc ? 2 : 4), 'l';
    case 0xde: case 0xdf: return *size = hl__take_number(r, type == 0xde ? 2 : 4), 'm';
    default: r->bad = 1; return 'x'; /* extensions: no message has one */
    }
}

static void hl__skip(hl_reader *r, int depth)
{
    uint64_t size, k;
    char sort = hl__head(r, &size);
    if (depth > HL_DEPTH) r->bad = 1;
    if (sort == 't' || sort == 'b') hl__take(r, (size_t)size);
    if (sort == 'm' || sort == 'l')
        for (k = 0; k < (sort == 'm' ? 2 * size : size) && !r->bad; k++) hl__skip(r, depth + 1);
}

static double hl__take_double(hl_reader *r)
{
    uint64_t bits;
    double value = 0.0;
    float single;
    uint32_t half;
    char sort = hl__head(r, &bits);
    if (sort == 'd') {
        memcpy(&value, &bits, sizeof value);
    } else if (sort == 's') {
        half = (uint32_t)bits;
        memcpy(&single, &half, sizeof single);
        value = (double)single;
    } else if (sort == 'i') {
        value = (double)(int64_t)bits;
    } else {
        r->bad = 1;
    }
    return value;
}

static const unsigned char *hl__take_chars(hl_reader *r, char sort, size_t *size)
{
    uint64_t found;
    if (hl__head(r, &found) != sort) r->bad = 1;
    *size = (size_t)found;
    return hl__take(r, *size);
}

static uint64_t hl__take_count(hl_reader *r, char sort)
{
    uint64_t count;
    if (hl__head(r, &count) != sort || count > (uint64_t)(r->end - r->at)) r->bad = 1; /* each takes a byte or more */
    return r->bad ? 0 : count;
}

/* The value of a key of the map at the front, or a reader that is bad. */
static hl_reader hl__value(hl_reader map, const char *key)
{
    uint64_t count = hl__take_count(&map, 'm');
    for (; count && !map.bad; count--) {
        size_t size;
        const unsigned char *name = hl__take_chars(&map, 't', &size);
        if (name && size == strlen(key) && !memcmp(name, key, size)) return map;
        hl__skip(&map, 0);
    }
    map.bad = 1;
    return map;
}

static hl_reader hl__field(const hl_client *c, const char *key)
{
    hl_reader map = {c->answer.data, c->answer.data + c->answer.size, 0};
    return hl__value(map, key);
}

/* Text of a field of a map, as much as there is room for. */
static void hl__copy_text(hl_reader map, const char *key, char *to, size_t room)
{
    hl_reader r = hl__value(map, key);
    size_t size = 0;
    const unsigned char *text = r.bad ? NULL : hl__take_chars(&r, 't', &size);
    if (!text) size = 0;
    if (size > room - 1) size = room - 1;
    if (size) memcpy(to, text, size);
    to[size] = 0;
}

/* ---- the connection ---- */

static double hl__now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Wait until the socket can be read or written. */
static int hl__wait(hl_client *c, short event, double end)
{
    for (;;) {
        struct pollfd p;
        double left = end - hl__now();
        int found;
        p.fd = c->socket;
        p.events = event;
        p.revents = 0;
        if (left <= 0.0) return hl__lost(c, "no answer in time", "");
        found = poll(&p, 1, left > 1e6 ? 1000000000 : 1 + (int)(1e3 * left));
        if (found > 0) return HL_OK;
        if (found < 0 && errno != EINTR) return hl__lost(c, strerror(errno), "");
    }
}

static int hl__send(hl_client *c, const unsigned char *data, size_t size, double end)
{
#ifdef MSG_NOSIGNAL
    const int flags = MSG_NOSIGNAL;
#else
    const int flags = 0;
#endif
    while (size) {
        ssize_t sent = send(c->socket, data, size, flags);
        if (sent > 0) {
            data += sent;
            size -= (size_t)sent;
        } else if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            int code = hl__wait(c, POLLOUT, end);
            if (code) return code;
        } else if (sent < 0 && errno != EINTR) {
            return HL_OK; /* it may have said why it is gone */
        }
    }
    return HL_OK;
}

static int hl__receive(hl_client *c, unsigned char *data, size_t size, double end)
{
    while (size) {
        ssize_t got = recv(c->socket, data, size, 0);
        if (got > 0) {
            data += got;
            size -= (size_t)got;
        } else if (got == 0 || errno == ECONNRESET) {
            return hl__lost(c, "the other process has closed the connection", "");
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            int code = hl__wait(c, POLLIN, end);
            if (code) return code;
        } else if (errno != EINTR) {
            return hl__lost(c, strerror(errno), "");
        }
    }
    return HL_OK;
}

/* Begin a request of some fields besides its number and word. */
static void hl__begin(hl_client *c, const char *what, size_t fields)
{
    c->request.size = 0;
    c->request.failed = 0;
    hl__room(&c->request, 4);
    hl__put_map(&c->request, fields + 2);
    hl__put_text(&c->request, "id");
    hl__put_integer(&c->request, ++c->number);
    hl__put_text(&c->request, "do");
    hl__put_text(&c->request, what);
}

static int hl__error_of(hl_client *c)
{
    static const struct {
        const char *word;
        int code;
    } kinds[] = {{"input", HL_INPUT}, {"stopped", HL_STOPPED}, {"refused", HL_REFUSED}, {"internal", HL_INTERNAL}};
    hl_reader error = hl__field(c, "error");
    char kind[16], key[200], problem[400], expected[300];
    size_t k;
    if (error.bad) return hl__lost(c, "an answer that is none", "");
    hl__copy_text(error, "kind", kind, sizeof kind);
    hl__copy_text(error, "key", key, sizeof key);
    hl__copy_text(error, "problem", problem, sizeof problem);
    hl__copy_text(error, "expected", expected, sizeof expected);
    snprintf(c->error, sizeof c->error, "%s%s%s%s%s", key, *key ? ": " : "", problem, *expected ? "; expected " : "",
             expected);
    for (k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (!strcmp(kind, kinds[k].word)) return kinds[k].code;
    return HL_INTERNAL;
}

/* Send the request, and read its answer. */
static int hl__ask(hl_client *c)
{
    unsigned char head[4];
    double end = hl__now() + c->timeout;
    size_t size = c->request.size - 4;
    hl_reader r;
    uint64_t value;
    int code, k;
    c->error[0] = 0;
    if (c->socket < 0) return hl__fail(c, HL_LOST, "the connection is closed", "");
    if (c->request.failed) return hl__fail(c, HL_MEMORY, "there is no memory for a request", "");
    if (size > HL_LARGEST) return hl__fail(c, HL_INPUT, "a message that is too long", "");
    for (k = 0; k < 4; k++) c->request.data[k] = (unsigned char)(size >> 8 * (3 - k));
    code = hl__send(c, c->request.data, c->request.size, end);
    if (!code) code = hl__receive(c, head, 4, end);
    if (code) return code;
    size = (size_t)head[0] << 24 | (size_t)head[1] << 16 | (size_t)head[2] << 8 | head[3];
    if (size > HL_LARGEST) return hl__lost(c, "not a server of heavylift", "");
    c->answer.size = 0;
    c->answer.failed = 0;
    if (!hl__room(&c->answer, size)) return hl__lost(c, "there is no memory for an answer", "");
    code = hl__receive(c, c->answer.data, size, end);
    if (code) return code;
    r = hl__field(c, "id");
    if (r.bad) return hl__lost(c, "not a server of heavylift", "");
    if (hl__head(&r, &value) != 'i' || (int64_t)value != c->number) { /* it says why it ends */
        code = hl__error_of(c);
        if (c->socket >= 0) close(c->socket);
        c->socket = -1;
        return code;
    }
    r = hl__field(c, "time");
    if (!r.bad) c->time = hl__take_double(&r);
    r = hl__field(c, "ended");
    if (!r.bad && hl__head(&r, &value) == 'f') c->ended = (int)value;
    r = hl__field(c, "ok");
    return hl__head(&r, &value) != 'f' || r.bad || !value ? hl__error_of(c) : HL_OK;
}

static int hl__greet(hl_client *c, const char *token, const char *role)
{
    hl__begin(c, "hello", 3);
    hl__put_text(&c->request, "protocol");
    hl__put_integer(&c->request, HL_PROTOCOL);
    hl__put_text(&c->request, "role");
    hl__put_text(&c->request, role);
    hl__put_text(&c->request, "token");
    hl__put_text(&c->request, token);
    return hl__ask(c);
}

static hl_client *hl__new(double timeout)
{
    hl_client *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    c->socket = -1;
    c->timeout = timeout > 0.0 ? timeout : 1e9;
    return c;
}

static void hl__own(int descriptor)
{
    fcntl(descriptor, F_SETFD, fcntl(descriptor, F_GETFD) | FD_CLOEXEC); /* no child of this process keeps it open */
#ifdef SO_NOSIGPIPE
    {
        int on = 1;
        setsockopt(descriptor, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
    }
#endif
}

static void hl__unblock(int descriptor)
{
    fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

#ifdef SOCK_CLOEXEC
#define HL_STREAM (SOCK_STREAM | SOCK_CLOEXEC)
#else
#define HL_STREAM SOCK_STREAM
#endif

int hl_open_child(hl_client **client, const char *const argv[], double timeout)
{
    hl_client *c = *client = hl__new(timeout);
    int pair[2], why[2], fault = 0;
    ssize_t got;
    if (!c) return HL_MEMORY;
    if (socketpair(AF_UNIX, HL_STREAM, 0, pair)) return hl__fail(c, HL_LOST, strerror(errno), "");
    hl__own(pair[0]);
    hl__own(pair[1]);
    if (pipe(why)) {
        close(pair[0]);
        close(pair[1]);
        return hl__fail(c, HL_LOST, strerror(errno), "");
    }
    hl__own(why[0]);
    hl__own(why[1]);
    c->child = fork();
    if (c->child == 0) {
        int ours = fcntl(pair[1], F_DUPFD, 3); /* a host may have closed its standard streams */
        setsid(); /* Ctrl-C reaches the host alone, with whose end the child ends */
        if (ours >= 0 && dup2(ours, 0) == 0 && dup2(ours, 1) == 1) {
            close(ours);
            execvp(argv[0], (char *const *)(uintptr_t)argv);
        }
        fault = errno;
        got = write(why[1], &fault, sizeof fault);
        _exit(got == sizeof fault ? 127 : 126);
    }
    close(pair[1]);
    close(why[1]);
    if (c->child < 0) {
        fault = errno;
    } else {
        do got = read(why[0], &fault, sizeof fault);
        while (got < 0 && errno == EINTR);
    }
    close(why[0]);
    c->socket = pair[0];
    if (fault) return hl__lost(c, argv[0], strerror(fault));
    hl__unblock(c->socket);
    return hl__greet(c, "", "master");
}

int hl_connect(hl_client **client, const char *host, int port, const char *token, const char *role, double timeout)
{
    hl_client *c = *client = hl__new(timeout);
    struct addrinfo hints, *found = NULL, *each;
    char service[16];
    int code, on = 1, fault = 0;
    socklen_t length = sizeof fault;
    if (!c) return HL_MEMORY;
    memset(&hints, 0, sizeof hints);
    hints.ai_socktype = SOCK_STREAM;
    snprintf(service, sizeof service, "%d", port);
    code = getaddrinfo(host, service, &hints, &found);
    if (code) return hl__fail(c, HL_LOST, host, gai_strerror(code));
    for (each = found; each && c->socket < 0; each = each->ai_next) {
        c->socket = socket(each->ai_family, HL_STREAM, each->ai_protocol);
        if (c->socket < 0) continue;
        hl__own(c->socket);
        hl__unblock(c->socket);
        fault = 0;
        if (connect(c->socket, each->ai_addr, each->ai_addrlen)) {
            fault = errno;
            if (fault == EINPROGRESS || fault == EINTR) {
                if (hl__wait(c, POLLOUT, hl__now() + c->timeout)) break;
                if (getsockopt(c->socket, SOL_SOCKET, SO_ERROR, &fault, &length)) fault = errno;
            }
        }
        if (fault) hl__lost(c, host, strerror(fault));
    }
    freeaddrinfo(found);
    if (c->socket < 0) return HL_LOST;
    setsockopt(c->socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return hl__greet(c, token, role);
}

int hl_connect_file(hl_client **client, const char *file, const char *role, double timeout)
{
    char host[256], token[256];
    int port = 0, found = 0;
    FILE *stream = fopen(file, "r");
    if (stream) {
        found = fscanf(stream, "%255s %d %255s", host, &port, token);
        fclose(stream);
    }
    if (found == 3) return hl_connect(client, host, port, token, role, timeout);
    *client = hl__new(timeout);
    if (!*client) return HL_MEMORY;
    return hl__fail(*client, HL_INPUT, file, "not a file that heavylift serve CASE --token-file has written");
}

/* ---- requests ---- */

static void hl__put_inputs(hl_client *c, size_t count, const char *const names[], const double values[],
                           const double rates[])
{
    size_t k;
    hl__put_text(&c->request, "inputs");
    hl__put_map(&c->request, count);
    for (k = 0; k < count; k++) {
        hl__put_text(&c->request, names[k]);
        int sloped = rates && !(rates[k] == HL_NO_RATE); /* what is no number is refused there */
        if (sloped) hl__put_list(&c->request, 2);
        hl__put_double(&c->request, values[k]);
        if (sloped) hl__put_double(&c->request, rates[k]);
    }
}

static void hl__put_outputs(hl_client *c, size_t count, const char *const names[])
{
    size_t k;
    hl__put_text(&c->request, "outputs");
    hl__put_list(&c->request, count);
    for (k = 0; k < count; k++) hl__put_text(&c->request, names[k]);
}

static int hl__read_values(hl_client *c, size_t count, const char *const names[], double results[])
{
    hl_reader r = hl__field(c, "values");
    size_t k;
    if (hl__take_count(&r, 'l') != count || r.bad) return hl__lost(c, "not a server of heavylift", "");
    for (k = 0; k < count; k++) {
        results[k] = hl__take_double(&r);
        if (r.bad) return hl__fail(c, HL_INPUT, names[k], "not one number: name a component of it");
    }
    return HL_OK;
}

int hl_set(hl_client *client, size_t count, const char *const names[], const double values[], const double rates[])
{
    hl__begin(client, "set", 1);
    hl__put_inputs(client, count, names, values, rates);
    return hl__ask(client);
}

int hl_step(hl_client *client, double dt, size_t input_count, const char *const inputs[], const double values[],
            const double rates[], size_t output_count, const char *const outputs[], double results[])
{
    int code;
    hl__begin(client, "step", 1u + (input_count > 0) + (output_count > 0));
    hl__put_text(&client->request, "dt");
    hl__put_double(&client->request, dt);
    if (input_count) hl__put_inputs(client, input_count, inputs, values, rates);
    if (output_count) hl__put_outputs(client, output_count, outputs);
    code = hl__ask(client);
    return code ? code : hl__read_values(client, output_count, outputs, results);
}

int hl_get(hl_client *client, size_t count, const char *const names[], double results[])
{
    int code;
    hl__begin(client, "get", 1);
    hl__put_outputs(client, count, names);
    code = hl__ask(client);
    return code ? code : hl__read_values(client, count, names, results);
}

int hl_save(hl_client *client, int64_t *state)
{
    hl_reader r;
    uint64_t handle;
    int code;
    hl__begin(client, "save", 0);
    code = hl__ask(client);
    if (code) return code;
    r = hl__field(client, "state");
    if (r.bad || hl__head(&r, &handle) != 'i') return hl__lost(client, "not a server of heavylift", "");
    *state = (int64_t)handle;
    return HL_OK;
}

static int hl__with_state(hl_client *c, const char *what, int64_t state)
{
    hl__begin(c, what, 1);
    hl__put_text(&c->request, "state");
    hl__put_integer(&c->request, state);
    return hl__ask(c);
}

int hl_restore(hl_client *client, int64_t state) { return hl__with_state(client, "restore", state); }
int hl_free(hl_client *client, int64_t state) { return hl__with_state(client, "free", state); }

int hl_save_bytes(hl_client *client, int64_t state, const void **bytes, size_t *size)
{
    hl_reader r;
    int code;
    hl__begin(client, "save", state ? 2 : 1);
    hl__put_text(&client->request, "bytes");
    hl__put_flag(&client->request, 1);
    if (state) {
        hl__put_text(&client->request, "state");
        hl__put_integer(&client->request, state);
    }
    code = hl__ask(client);
    if (code) return code;
    r = hl__field(client, "bytes");
    *bytes = hl__take_chars(&r, 'b', size);
    return r.bad ? hl__lost(client, "not a server of heavylift", "") : HL_OK;
}

int hl_restore_bytes(hl_client *client, const void *bytes, size_t size)
{
    if (size > HL_LARGEST) return hl__fail(client, HL_INPUT, "a state that is too long", "");
    hl__begin(client, "restore", 1);
    hl__put_text(&client->request, "bytes");
    hl__put_number(&client->request, 0xc6, size, 4);
    hl__put(&client->request, bytes, size);
    return hl__ask(client);
}

/* ---- what there is ---- */

/* A text that stays: its place among the texts of the description, which may still move. */
static size_t hl__keep(hl_client *c, hl_reader map, const char *key)
{
    hl_reader r = hl__value(map, key);
    size_t size = 0, at = c->texts.size;
    const unsigned char *text = r.bad ? NULL : hl__take_chars(&r, 't', &size);
    if (text) hl__put(&c->texts, text, size);
    hl__put(&c->texts, "", 1);
    return at;
}

static double hl__number_of(hl_reader map, const char *key)
{
    hl_reader r = hl__value(map, key);
    double value = hl__take_double(&r);
    return r.bad ? 0.0 : value;
}

static const char *hl__text_at(const hl_client *c, size_t at) { return (const char *)c->texts.data + at; }

int hl_describe(hl_client *client, const hl_description **description)
{
    static const char *const keys[4] = {"name", "unit", "sentence", "interpolation"};
    static const char *const lists[2] = {"inputs", "outputs"};
    hl_client *c = client;
    hl_reader r[2];
    size_t counts[2], k, j, list, total, *places;
    hl_port *ports;
    int code;
    hl__begin(c, "describe", 0);
    code = hl__ask(c);
    if (code) return code;
    for (list = 0; list < 2; list++) {
        r[list] = hl__field(c, lists[list]);
        counts[list] = (size_t)hl__take_count(&r[list], 'l');
        if (r[list].bad) return hl__lost(c, "not a server of heavylift", "");
    }
    total = counts[0] + counts[1];
    ports = realloc(c->ports, (total + 1) * sizeof *ports);
    if (ports) c->ports = ports;
    places = malloc((4 * total + 1) * sizeof *places);
    c->texts.size = 0;
    c->texts.failed = !ports || !places;
    for (k = 0; k < total && !c->texts.failed; k++) {
        hl_reader *at = &r[k >= counts[0]];
        for (j = 0; j < 4; j++) places[4 * k + j] = hl__keep(c, *at, keys[j]);
        ports[k].value = hl__number_of(*at, "value");
        ports[k].smallest = k < counts[0] ? hl__number_of(*at, "smallest") : -HUGE_VAL;
        ports[k].largest = k < counts[0] ? hl__number_of(*at, "largest") : HUGE_VAL;
        hl__skip(at, 0);
        if (at->bad) {
            free(places);
            return hl__lost(c, "not a server of heavylift", "");
        }
    }
    if (c->texts.failed) {
        free(places);
        return hl__fail(c, HL_MEMORY, "there is no memory for a description", "");
    }
    for (k = 0; k < total; k++) {
        ports[k].name = hl__text_at(c, places[4 * k]);
        ports[k].unit = hl__text_at(c, places[4 * k + 1]);
        ports[k].sentence = hl__text_at(c, places[4 * k + 2]);
        ports[k].interpolation = hl__text_at(c, places[4 * k + 3]);
    }
    free(places);
    c->description.input_count = counts[0];
    c->description.output_count = counts[1];
    c->description.inputs = ports;
    c->description.outputs = ports + counts[0];
    r[0].at = c->answer.data;
    r[0].end = c->answer.data + c->answer.size;
    c->description.step_size = hl__number_of(r[0], "step_size");
    c->description.duration = hl__number_of(r[0], "duration");
    *description = &c->description;
    return HL_OK;
}

double hl_time(const hl_client *client) { return client->time; }
int hl_ended(const hl_client *client) { return client->ended; }
const char *hl_error(const hl_client *client) { return client ? client->error : "there is no memory for a client"; }

void hl_close(hl_client *client, int end)
{
    hl_client *c = client;
    double last;
    int status;
    if (!c) return;
    if (c->socket >= 0) {
        hl__begin(c, "close", end ? 0 : 1);
        if (!end) {
            hl__put_text(&c->request, "end");
            hl__put_flag(&c->request, 0);
        }
        hl__ask(c);
        if (c->socket >= 0) close(c->socket);
    }
    if (c->child > 0) {
        last = hl__now() + HL_STOP_SECONDS;
        while (waitpid(c->child, &status, WNOHANG) == 0) {
            struct timespec pause = {0, 10000000};
            nanosleep(&pause, NULL);
            if (hl__now() > last) {
                kill(c->child, SIGKILL);
                waitpid(c->child, &status, 0);
                break;
            }
        }
    }
    free(c->request.data);
    free(c->answer.data);
    free(c->texts.data);
    free(c->ports);
    free(c);
}
#endif
