/* Some of the points of a file, with their properties, and some of the components of a surface. */
#include "cli/steps/selection.h"
#include <string.h>

brio_status cli_select_points(run *r, const brio_mesh *points, const uint8_t *chosen, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *made = NULL;
    size_t count = 0, at = 0;
    for (size_t i = 0; i < points->num_vertices; i++) count += chosen[i] != 0;
    TRY(brio_mesh_new(r->ctx, &made));
    TRY(brio_mesh_set_vertices(made, NULL, count));
    memcpy(made->coordinate_step, points->coordinate_step, sizeof made->coordinate_step);
    memcpy(made->coordinate_origin, points->coordinate_origin, sizeof made->coordinate_origin);
    for (size_t i = 0; i < points->num_metadata; i++) {
        const brio_metadata *m = &points->metadata[i];
        TRY(brio_mesh_set_metadata(made, m->name, m->bytes, m->size));
    }
    for (size_t k = 0; k < points->num_properties; k++)
        TRY(brio_mesh_add_property(made, points->properties[k].name, points->properties[k].type, NULL));
    for (size_t i = 0; i < points->num_vertices; i++) {
        if (!chosen[i]) continue;
        memcpy(made->vertices + 3 * at, points->vertices + 3 * i, 3 * sizeof *made->vertices);
        for (size_t k = 0; k < points->num_properties; k++) {
            size_t size = brio_scalar_size(points->properties[k].type);
            memcpy((char *)made->properties[k].data + at * size, (char *)points->properties[k].data + i * size, size);
        }
        at++;
    }
    *out = made;
    made = NULL;
done:
    brio_mesh_free(made);
    return status;
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
