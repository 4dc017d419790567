/* What a file's format cannot hold, said when the file has been written. */
#include "lost.h"

static bool holds_properties(brio_format format) {
    return format != BRIO_FORMAT_OBJ && format != BRIO_FORMAT_OFF && format != BRIO_FORMAT_STL;
}

static bool holds_faces(brio_format format) {
    return format != BRIO_FORMAT_XYZ && format != BRIO_FORMAT_NODE && format != BRIO_FORMAT_LAS &&
           format != BRIO_FORMAT_NPY;
}

static bool holds_edges(brio_format format) {
    return format == BRIO_FORMAT_PLY || format == BRIO_FORMAT_VTU || format == BRIO_FORMAT_VTP ||
           format == BRIO_FORMAT_GLB;
}

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
    if (mesh->num_faces && !holds_faces(format))
        cli_warn(r, "%s: without the faces, which the format cannot hold", path);
    if (mesh->num_edges && !holds_edges(format))
        cli_warn(r, "%s: without the edges, which the format cannot hold", path);
    if (!mesh->num_properties || !r->has_properties) return;
    list_names(mesh, names);
    if (format == BRIO_FORMAT_NODE)
        cli_warn(r, "%s: without the names of the properties:%s", path, names);
    else if (!holds_properties(format))
        cli_warn(r, "%s: without the properties, which the format cannot hold:%s", path, names);
}

void cli_tell_idle(run *r, const char *path, bool ascii, bool float32) {
    if (r->common.ascii && !ascii) cli_warn(r, "%s: --ascii changes nothing in this format", path);
    if (r->common.float32 && !float32) cli_warn(r, "%s: --float32 changes nothing in this format", path);
}
