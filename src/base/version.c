/* The version of the library that runs. */
#include "brio/brio.h"

const char *brio_version(void) {
    return BRIO_VERSION;
}

int brio_version_number(void) {
    return BRIO_VERSION_NUMBER;
}
