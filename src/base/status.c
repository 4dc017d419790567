/* The sentences of statuses, the names of reasons, and the version. */
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

const char *brio_reason_name(brio_reason reason) {
    static const char *const names[] = {
        [BRIO_REASON_NONE] = "",
        [BRIO_REASON_NO_INSIDE] = "no_inside",
        [BRIO_REASON_OPEN_MESH] = "open_mesh",
        [BRIO_REASON_NOT_CLOSED] = "not_closed",
        [BRIO_REASON_SWALLOWED] = "swallowed",
        [BRIO_REASON_NOT_TRIANGLES] = "not_triangles",
        [BRIO_REASON_SCALE] = "scale",
        [BRIO_REASON_NO_VALUE] = "no_value",
        [BRIO_REASON_ALL_HOLES] = "all_holes",
        [BRIO_REASON_NO_COMPONENT] = "no_component",
        [BRIO_REASON_NOT_FLAT] = "not_flat",
        [BRIO_REASON_UNKNOWN_FORMAT] = "unknown_format",
    };
    _Static_assert(sizeof names / sizeof *names == BRIO_REASON_END, "a name for each reason");
    return (unsigned)reason < BRIO_REASON_END ? names[reason] : "";
}

const char *brio_version(void) {
    return BRIO_VERSION;
}

int brio_version_number(void) {
    return BRIO_VERSION_NUMBER;
}
