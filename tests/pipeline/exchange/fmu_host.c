/* A host that is the library of a unit of FMI 3 itself, so that a compiler can watch its memory: fmu_host FOLDER TOKEN */
#include "heavylift_fmu.c"

static void say(void *place, int status, const char *kind, const char *text)
{
    (void)place;
    printf("%d %s: %s\n", status, kind, text);
}

static void *instance(char **argv)
{
    return fmi3InstantiateCoSimulation("one", argv[2], argv[1], false, false, false, false, NULL, 0, NULL, say, NULL);
}

int main(int argc, char **argv)
{
    const Reference wanted[] = {0, 1, 2, 3, 5}, gust = 2, odd = 999;
    double first[5], again[5], last, force = 1e5, none = NAN;
    bool event, end, early;
    void *unit, *other, *state = NULL, *copy = NULL;
    unsigned char *bytes;
    size_t size = 0;
    int k, codes[5];
    if (argc != 3 || !(unit = instance(argv))) return 1;
    fmi3EnterInitializationMode(unit, false, 0.0, 0.0, false, 0.0);
    fmi3ExitInitializationMode(unit);
    for (k = 0; k < 3; k++) {
        if (fmi3SetFloat64(unit, &gust, 1, &force, 1)) return 2;
        if (fmi3DoStep(unit, 0.1 * k, 0.1, false, &event, &end, &early, &last)) return 3;
        if (k == 0 && fmi3GetFMUState(unit, &state)) return 4;
    }
    if (fmi3GetFloat64(unit, wanted, 5, first, 5)) return 5;
    if (fmi3SerializedFMUStateSize(unit, state, &size) || !(bytes = malloc(size))) return 6;
    if (fmi3SerializeFMUState(unit, state, bytes, size)) return 7;
    codes[0] = fmi3SerializeFMUState(unit, state, bytes, size - 1);
    codes[1] = fmi3SetFloat64(unit, &odd, 1, &force, 1);
    codes[2] = fmi3SetFloat64(unit, &gust, 1, &none, 1);
    codes[3] = fmi3GetInt32(unit, &gust, 1);
    codes[4] = fmi3DeserializeFMUState(unit, bytes, 5, &copy);
    for (k = 0; k < 5; k++) printf("%d%s", codes[k], k < 4 ? " " : "\n");
    if (!(other = instance(argv))) return 8;
    if (fmi3DeserializeFMUState(other, bytes, size, &copy) || fmi3SetFMUState(other, copy)) return 9;
    for (k = 1; k < 3; k++) {
        if (fmi3SetFloat64(other, &gust, 1, &force, 1)) return 10;
        if (fmi3DoStep(other, 0.1 * k, 0.1, false, &event, &end, &early, &last)) return 11;
    }
    if (fmi3GetFloat64(other, wanted, 5, again, 5)) return 12;
    printf("%s\n", memcmp(first, again, sizeof first) ? "other bits" : "same bits");
    fmi3FreeFMUState(other, &copy);
    fmi3FreeInstance(other);
    if (fmi3SetFMUState(unit, state) || fmi3Reset(unit)) return 13;
    fmi3FreeFMUState(unit, &state);
    if (fmi3GetFloat64(unit, wanted, 1, first, 1) || first[0] != 0.0) return 14;
    fmi3Terminate(unit);
    fmi3FreeInstance(unit);
    free(bytes);
    unit = fmi3InstantiateCoSimulation("two", "another", argv[1], false, false, false, false, NULL, 0, NULL, say, NULL);
    printf("%s\n", unit ? "an instance" : "none");
    return 0;
}
