/* The sentences of statuses, and the version. */
#include "brio/brio.h"

const char *brio_status_string(brio_status status) {
    switch (status) {
    case BRIO_OK:
        return "done";
    case BRIO_ERR_ARGUMENT:
        return "an argument is out of its range";
    case BRIO_ERR_NOT_FINITE:
        return "a coordinate or weight is not a finite number";
    case BRIO_ERR_NO_ANSWER:
        return "the input has no such answer";
    case BRIO_ERR_CHECK:
        return "the check failed";
    case BRIO_ERR_NO_MEMORY:
        return "out of memory";
    case BRIO_ERR_TOO_LARGE:
        return "too many objects for an index";
    case BRIO_ERR_CANCELLED:
        return "cancelled";
    case BRIO_ERR_OPEN:
        return "a file is missing or unreadable";
    case BRIO_ERR_FORMAT:
        return "a file is malformed";
    case BRIO_ERR_WRITE:
        return "a file could not be written";
    case BRIO_ERR_INTERNAL:
        return "a fault of the library";
    case BRIO_STATUS_END:
        break;
    }
    return "not a status";
}

const char *brio_version(void) {
    return BRIO_VERSION;
}

int brio_version_number(void) {
    return BRIO_VERSION_NUMBER;
}
