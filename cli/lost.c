/* What a file's format cannot hold, said when the file has been written. */
#include "lost.h"
#include <string.h>

static bool holds_properties(brio_format format) {
    return format != BRIO_FORMAT_OBJ && format != BRIO_FORMAT_OFF && format != BRIO_FORMAT_STL;
}

static bool holds_faces(brio_format format) {
    return format != BRIO_FORMAT_XYZ && format != BRIO_FORMAT_NODE && format != BRIO_FORMAT_LAS &&
           format != BRIO_FORMAT_NPY;
}

static bool holds_edges(brio_format format) {
    return format == BRIO_FORMAT_PLY || format == BRIO_FORMAT_VTU || format == BRIO_FORMAT_VTP;
}

/* Control characters in names from files would reach the terminal. */
static void print_name(const char *name) {
    for (; *name; name++) fputc((unsigned char)*name < 0x20 || *name == 0x7f ? '?' : *name, stderr);
}

static void print_names(const brio_mesh *mesh) {
    enum { MOST = 12 };
    for (size_t i = 0; i < mesh->num_properties && i < MOST; i++) {
        fputc(' ', stderr);
        print_name(mesh->properties[i].name);
    }
    fputs(mesh->num_properties > MOST ? " ...\n" : "\n", stderr);
}

void cli_tell_lost(const run *r, const char *path, const brio_mesh *mesh, brio_format format) {
    if (r->common.quiet) return;
    if (mesh->num_faces && !holds_faces(format))
        fprintf(stderr, "brio: %s: without the faces, which the format cannot hold\n", path);
    if (mesh->num_edges && !holds_edges(format))
        fprintf(stderr, "brio: %s: without the edges, which the format cannot hold\n", path);
    if (!mesh->num_properties || !r->has_properties) return;
    if (format == BRIO_FORMAT_NODE)
        fprintf(stderr, "brio: %s: without the names of the properties:", path);
    else if (!holds_properties(format))
        fprintf(stderr, "brio: %s: without the properties, which the format cannot hold:", path);
    else
        return;
    print_names(mesh);
}

void cli_tell_idle(const run *r, const char *path, bool ascii, bool float32) {
    if (r->common.quiet) return;
    if (r->common.ascii && !ascii) fprintf(stderr, "brio: %s: --ascii changes nothing in this format\n", path);
    if (r->common.float32 && !float32) fprintf(stderr, "brio: %s: --float32 changes nothing in this format\n", path);
}
