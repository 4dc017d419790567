/* What a file's format cannot hold, said when the file has been written. */
#include "lost.h"

/* Lists the names of the properties, the first few of them. */
static void list_names(const brio_mesh *mesh, char text[1024]) {
    enum { MOST = 12 };
    size_t used = 0;
    for (size_t i = 0; i < mesh->num_properties && i < MOST; i++)
        used += (size_t)snprintf(text + used, 1024 - used, " %s", mesh->properties[i].name);
    if (mesh->num_properties > MOST) snprintf(text + used, 1024 - used, " ...");
}

void cli_tell_lost(run *r, const char *path, const brio_mesh *mesh, brio_format format) {
    char names[1024];
    unsigned holds = brio_format_facts(format)->holds;
    if (mesh->num_faces && !(holds & BRIO_HOLDS_FACES)) cli_warn(r, WARNING_FACES, path);
    if (mesh->num_edges && !(holds & BRIO_HOLDS_EDGES)) cli_warn(r, WARNING_EDGES, path);
    if (!mesh->num_properties || !r->has_properties) return;
    list_names(mesh, names);
    if (holds & BRIO_HOLDS_PROPERTIES && !(holds & BRIO_HOLDS_NAMES))
        cli_warn(r, WARNING_NAMES, path, names);
    else if (!(holds & BRIO_HOLDS_PROPERTIES))
        cli_warn(r, WARNING_PROPERTIES, path, names);
}

void cli_tell_idle(run *r, const char *path, bool ascii, bool float32) {
    if (r->common.ascii && !ascii) cli_warn(r, WARNING_IDLE_ASCII, path);
    if (r->common.float32 && !float32) cli_warn(r, WARNING_IDLE_FLOAT32, path);
}
