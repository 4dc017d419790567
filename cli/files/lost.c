/* What a file's format cannot hold, said when the file has been written. */
#include "cli/files/lost.h"
#include <string.h>

/* Returns whether a property is one of three that a mesh has all, and a format has a place for. */
static bool is_held(const brio_mesh *mesh, const char *name, unsigned holds) {
    static const struct {
        unsigned what;
        const char *names[3];
    } groups[] = {{BRIO_HOLDS_COLOURS, {"red", "green", "blue"}}, {BRIO_HOLDS_NORMALS, {"nx", "ny", "nz"}}};
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        bool all = holds & groups[g].what, one = false;
        for (int k = 0; k < 3; k++) {
            all = all && brio_mesh_property(mesh, groups[g].names[k]);
            one |= !strcmp(name, groups[g].names[k]);
        }
        if (all && one) return true;
    }
    return false;
}

/* Returns whether a format has a place for a property of faces: for all, or for their colours. */
static bool is_held_of_faces(const char *name, unsigned holds) {
    static const char *const colour[] = {"red", "green", "blue", "alpha"};
    bool one = false;
    for (int k = 0; k < 4; k++) one |= !strcmp(name, colour[k]);
    return holds & BRIO_HOLDS_FACE_PROPERTIES || (one && holds & BRIO_HOLDS_FACE_COLOURS);
}

/* Lists the names of the properties that a format does not hold, the first few of them. Returns how many there are. */
static size_t list_names(const brio_mesh *mesh, unsigned holds, char text[1024]) {
    enum { MOST = 12 };
    size_t used = 0, count = 0;
    for (size_t i = 0; i < mesh->num_face_properties && mesh->num_faces && holds & BRIO_HOLDS_FACES; i++) {
        const char *name = mesh->face_properties[i].name;
        if (is_held_of_faces(name, holds)) continue;
        if (count++ < MOST) used += (size_t)snprintf(text + used, 1024 - used, " \"%s of faces\"", name);
    }
    for (size_t i = 0; i < mesh->num_properties && !(holds & BRIO_HOLDS_NAMES); i++) {
        if (is_held(mesh, mesh->properties[i].name, holds)) continue;
        if (count++ < MOST) used += (size_t)snprintf(text + used, 1024 - used, " %s", mesh->properties[i].name);
    }
    if (count > MOST) snprintf(text + used, 1024 - used, " ...");
    return count;
}

void cli_tell_lost(run *r, const char *path, const brio_mesh *mesh, brio_format format) {
    char names[1024];
    unsigned holds = brio_format_facts(format)->holds;
    if (mesh->num_faces && !(holds & BRIO_HOLDS_FACES)) cli_warn(r, WARNING_FACES, path);
    if (mesh->num_edges && !(holds & BRIO_HOLDS_EDGES)) cli_warn(r, WARNING_EDGES, path);
    if (!r->has_properties || !list_names(mesh, holds, names)) return;
    if (holds & BRIO_HOLDS_PROPERTIES && !(holds & BRIO_HOLDS_NAMES))
        cli_warn(r, WARNING_NAMES, path, names);
    else
        cli_warn(r, WARNING_PROPERTIES, path, names);
}

void cli_tell_idle(run *r, const char *path, bool ascii, bool float32) {
    if (r->common.ascii && !ascii) cli_warn(r, WARNING_IDLE_ASCII, path);
    if (r->common.float32 && !float32) cli_warn(r, WARNING_IDLE_FLOAT32, path);
}
