/* Temporary names of outputs, the same on every system. */
#include "platform/target.h"
#include <inttypes.h>
#include <string.h>

/* Returns how many bytes of a name the temporary name begins with: whole UTF-8 characters, as some file systems
 * require. */
static int kept_bytes(const char *name) {
    size_t length = strlen(name);
    if (length <= BRIO_NAME_IN_TEMPORARY) return (int)length;
    length = BRIO_NAME_IN_TEMPORARY;
    while (length > 0 && ((unsigned char)name[length] & 0xc0) == 0x80) length--;
    return (int)length;
}

void brio_target_temporary(brio_target *target) {
    snprintf(target->temporary, sizeof target->temporary, "%.*s.part-%016" PRIx64, kept_bytes(target->name),
             target->name, brio_unguessable());
}

int brio_path_descriptor(const char *path) {
    brio_target target;
    int found = brio_target_find(&target, path) ? brio_target_descriptor(&target) : -1;
    brio_target_close(&target);
    return found;
}
