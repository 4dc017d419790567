/* unit_tests SUITE [ARGUMENT ...]: runs one suite of the unit tests; without arguments lists them. */
#include <stdio.h>
#include <string.h>

/* suites.h has a line SUITE(test_sort) for each file: CMake writes it. */
#define SUITE(name) int name(int argc, char **argv);
#include "suites.h"
#undef SUITE

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
} suites[] = {
#define SUITE(name) {#name, name},
#include "suites.h"
#undef SUITE
};

int main(int argc, char **argv) {
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) {
        if (argc < 2) puts(suites[i].name);
        if (argc >= 2 && !strcmp(suites[i].name, argv[1])) return suites[i].run(argc - 1, argv + 1);
    }
    if (argc < 2) return 0;
    fprintf(stderr, "unit_tests: there is no suite %s\n", argv[1]);
    return 1;
}
