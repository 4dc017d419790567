/* What a reconstructed surface gets before it is reported. */
#include "surface_extras.h"
#include <string.h>

/* The name for a property of the points. Returns whether there is one. */
static bool name_for(const brio_mesh *surface, const char *name, char out[80]) {
    snprintf(out, 80, "%s", name);
    if (brio_mesh_property(surface, name)) snprintf(out, 80, "input_%s", name);
    return strlen(out) < sizeof surface->properties->name && !brio_mesh_property(surface, out);
}

brio_status cli_copy_properties(run *r, const brio_mesh *points, const uint32_t *samples, brio_mesh *surface) {
    for (size_t i = 0; i < points->num_properties; i++) {
        const brio_property *p = &points->properties[i];
        size_t size = brio_scalar_size(p->type);
        char name[80];
        void *data;
        if (!name_for(surface, p->name, name)) {
            cli_warn(r, "the property %s of the points is left out: its name is taken or too long", p->name);
            continue;
        }
        brio_status status = brio_mesh_add_property(surface, name, p->type, &data);
        if (status != BRIO_OK) return status;
        for (size_t v = 0; v < surface->num_vertices; v++)
            memcpy((char *)data + v * size, (const char *)p->data + (samples ? samples[v] : v) * size, size);
    }
    return BRIO_OK;
}

brio_status cli_keep_components(run *r, const component_options *options, brio_mesh *surface, size_t dropped[2]) {
    dropped[0] = dropped[1] = 0;
    if (!options->largest && !options->least) return cli_check_interrupt(r);
    return brio_mesh_keep_components(surface, options->largest, options->least, &dropped[0], &dropped[1]);
}

void cli_report_dropped(run *r, const component_options *options, const size_t dropped[2]) {
    if (!options->largest && !options->least) return;
    cli_fact_count(&r->facts, "dropped_components", dropped[0]);
    cli_fact_count(&r->facts, "dropped_faces", dropped[1]);
}
