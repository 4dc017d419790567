/* Properties of points beside what a command computes. */
#include "cli/steps/properties.h"
#include <stdlib.h>
#include <string.h>

/* Returns the length of a name cut to at most `most` bytes, between two characters of UTF-8. */
static int cut_length(const char *name, size_t most) {
    if (strlen(name) <= most) return (int)strlen(name);
    while (most > 0 && ((unsigned char)name[most] & 0xc0) == 0x80) most--;
    return (int)most;
}

/* Makes input_NAME, or input_NAME_2 and so on where that is taken; cuts NAME so that the whole fits. */
static void make_free_name(const brio_mesh *mesh, const char *name, char out[64]) {
    char end[24] = "";
    for (size_t n = 2;; n++) {
        snprintf(out, 64, "input_%.*s%s", cut_length(name, 57 - strlen(end)), name, end);
        if (!brio_mesh_property(mesh, out)) return;
        snprintf(end, sizeof end, "_%zu", n);
    }
}

void cli_set_aside(run *r, brio_mesh *mesh, const char *name) {
    for (size_t i = 0; i < mesh->num_properties; i++) {
        brio_property *p = &mesh->properties[i];
        char free_name[64];
        if (strcmp(p->name, name) != 0) continue;
        make_free_name(mesh, name, free_name);
        memcpy(p->name, free_name, sizeof free_name);
        cli_warn(r, WARNING_SET_ASIDE, name, p->name);
    }
}

brio_status cli_add_representatives(run *r, brio_mesh *mesh, const uint32_t *representatives) {
    void *data;
    size_t others = 0;
    for (size_t i = 0; i < mesh->num_vertices; i++) others += representatives[i] != i;
    if (!others) return BRIO_OK;
    cli_set_aside(r, mesh, "representative");
    FORWARD(brio_mesh_add_property(mesh, "representative", BRIO_SCALAR_UINT32, &data));
    memcpy(data, representatives, mesh->num_vertices * sizeof *representatives);
    return BRIO_OK;
}

brio_status cli_carry_properties(run *r, const brio_mesh *points, const uint32_t *samples, brio_mesh *surface) {
    if (!points->num_properties) return BRIO_OK;
    double start = cli_clock();
    brio_status status = brio_mesh_carry_properties(r->ctx, points, samples, surface);
    double seconds = cli_clock() - start;
    cli_stage(r, "properties", seconds);
    r->lap += seconds; /* the next stage does not count them */
    return status;
}

brio_status cli_take_samples(run *r, brio_mesh *surface, uint32_t **samples) {
    const brio_property *property = brio_mesh_property(surface, "sample");
    *samples = malloc((surface->num_vertices + 1) * sizeof **samples);
    if (!*samples) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", surface->num_vertices);
    for (size_t v = 0; v < surface->num_vertices; v++) (*samples)[v] = (uint32_t)brio_property_value(property, v);
    brio_mesh_remove_property(surface, "sample");
    return BRIO_OK;
}

brio_status cli_copy_properties(run *r, const brio_mesh *points, brio_mesh *surface) {
    uint32_t *samples = points->num_properties ? malloc((surface->num_vertices + 1) * sizeof *samples) : NULL;
    if (!points->num_properties) return BRIO_OK;
    if (!samples) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", surface->num_vertices);
    for (uint32_t v = 0; v < surface->num_vertices; v++) samples[v] = v;
    brio_status status = cli_carry_properties(r, points, samples, surface);
    free(samples);
    return status;
}
