/* A session with a served hoist: session child COMMAND... | session tcp HOST PORT TOKEN | session file FILE ROLE */
#define _POSIX_C_SOURCE 200809L
#include "heavylift_client.c"

static const char *const names[] = {"load.position.x", "load.position.z", "fall.tension"};
#define COUNT (sizeof names / sizeof *names)

static int check(hl_client *c, int code, const char *what)
{
    if (code) printf("%s: %d %s\n", what, code, hl_error(c));
    return code;
}

static void show(hl_client *c, const double values[])
{
    size_t k;
    printf("%a", hl_time(c));
    for (k = 0; k < COUNT; k++) printf(" %a", values[k]);
    printf("\n");
}

int main(int argc, char **argv)
{
    hl_client *c = NULL;
    const hl_description *d;
    const char *const vector[] = {"load.position"}, *const unknown[] = {"load.speed"};
    const void *bytes;
    void *kept;
    double values[COUNT], again[COUNT];
    int64_t state = 0;
    size_t size;
    int k, code = HL_INPUT;
    if (argc > 2 && !strcmp(argv[1], "child"))
        code = hl_open_child(&c, (const char *const *)(argv + 2), 100.0);
    else if (argc == 5)
        code = hl_connect(&c, argv[2], atoi(argv[3]), argv[4], "master", 20.0);
    else if (argc == 4)
        code = hl_connect_file(&c, argv[2], argv[3], 20.0);
    if (check(c, code, "open")) return hl_close(c, 1), 1;
    if (check(c, hl_describe(c, &d), "describe")) return hl_close(c, 1), 1;
    printf("%lu inputs, %lu outputs, step %a s, duration %a s, %s [%s]: %s\n", (unsigned long)d->input_count,
           (unsigned long)d->output_count, d->step_size, d->duration, d->outputs[0].name, d->outputs[0].unit,
           d->outputs[0].sentence);
    for (k = 0; k < 5; k++) {
        if (check(c, hl_step(c, 0.1, 0, NULL, NULL, NULL, COUNT, names, values), "step")) break;
        show(c, values);
    }
    check(c, hl_save(c, &state), "save");
    check(c, hl_step(c, 0.1, 0, NULL, NULL, NULL, COUNT, names, values), "step");
    show(c, values);
    check(c, hl_restore(c, state), "restore");
    check(c, hl_step(c, 0.1, 0, NULL, NULL, NULL, COUNT, names, again), "step");
    printf("restored: %s\n", memcmp(values, again, sizeof values) ? "other bits" : "same bits");
    if (!check(c, hl_save_bytes(c, state, &bytes, &size), "save bytes") && (kept = malloc(size)) != NULL) {
        memcpy(kept, bytes, size);
        check(c, hl_restore_bytes(c, kept, size), "restore bytes");
        check(c, hl_step(c, 0.1, 0, NULL, NULL, NULL, COUNT, names, again), "step");
        printf("from bytes: %s\n", memcmp(values, again, sizeof values) ? "other bits" : "same bits");
        ((char *)kept)[size / 2] ^= 1;
        check(c, hl_restore_bytes(c, kept, size), "damaged");
        free(kept);
    }
    check(c, hl_free(c, state), "free");
    check(c, hl_restore(c, state), "restore");
    check(c, hl_step(c, NAN, 0, NULL, NULL, NULL, 0, NULL, NULL), "step");
    check(c, hl_step(c, 1e9, 0, NULL, NULL, NULL, 0, NULL, NULL), "step");
    check(c, hl_get(c, 1, unknown, values), "get");
    check(c, hl_get(c, 1, vector, values), "get");
    check(c, hl_step(c, d->duration - hl_time(c), 0, NULL, NULL, NULL, COUNT, names, values), "step");
    show(c, values);
    printf("%s\n", hl_ended(c) ? "ended" : "goes on");
    hl_close(c, 1);
    return 0;
}
