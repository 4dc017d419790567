/* What a file knows of the side from which its points were seen. Normals are the properties nx, ny, nz; places of
 * scanners are the properties x_origin, y_origin, z_origin, which readers of scans add on request. */
#include "cli/steps/evidence.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* LATEST: the rows of places among which the place of the next point is looked for. */
enum { LATEST = 8 };

static const char *const NORMALS[] = {"nx", "ny", "nz"}, *const ORIGINS[] = {"x_origin", "y_origin", "z_origin"};

/* Reads X,Y,Z. */
static bool read_place(const char *text, double place[3]) {
    for (int k = 0; k < 3; k++) {
        char *end;
        place[k] = strtod(text, &end);
        if (end == text || !isfinite(place[k]) || *end != (k < 2 ? ',' : 0)) return false;
        text = end + 1;
    }
    return true;
}

brio_status cli_check_evidence(run *r, const evidence_options *options) {
    double place[3];
    if (options->from && !read_place(options->from, place))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--from: '%s' is no place; expected three numbers X,Y,Z", options->from);
    if (options->from && options->ignore_origins)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--from and --ignore-origins exclude each other");
    return BRIO_OK;
}

/* Finds three properties; returns false if one of them is not there. */
static bool find_three(const brio_mesh *points, const char *const names[3], const brio_property *out[3]) {
    for (int k = 0; k < 3; k++)
        if (!(out[k] = brio_mesh_property(points, names[k]))) return false;
    return true;
}

static brio_status take_normals(run *r, const brio_mesh *points, evidence *out) {
    const brio_property *n[3];
    if (!find_three(points, NORMALS, n)) return BRIO_OK;
    out->normals = malloc((3 * points->num_vertices + 1) * sizeof *out->normals);
    if (!out->normals) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu normals", points->num_vertices);
    for (size_t p = 0; p < points->num_vertices; p++)
        for (size_t k = 0; k < 3; k++) out->normals[3 * p + k] = brio_property_value(n[k], p);
    return BRIO_OK;
}

/* Returns the row of a place among the latest ones; num_origins if it is not there. */
static size_t row_of(const evidence *e, const double place[3]) {
    size_t from = e->num_origins > LATEST ? e->num_origins - LATEST : 0;
    for (size_t i = e->num_origins; i > from; i--)
        if (!memcmp(e->origins + 3 * (i - 1), place, 3 * sizeof *place)) return i - 1;
    return e->num_origins;
}

/* Makes room for one more place. */
static brio_status grow_places(run *r, evidence *e, size_t *capacity) {
    if (e->num_origins < *capacity) return BRIO_OK;
    size_t more = *capacity ? 2 * *capacity : LATEST;
    double *grown = realloc(e->origins, 3 * more * sizeof *grown);
    if (!grown) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu places of scanners", more);
    e->origins = grown;
    *capacity = more;
    return BRIO_OK;
}

static brio_status take_origins(run *r, const brio_mesh *points, evidence *out) {
    const brio_property *o[3];
    size_t capacity = 0;
    if (!find_three(points, ORIGINS, o)) return BRIO_OK;
    out->origin_of = malloc((points->num_vertices + 1) * sizeof *out->origin_of);
    if (!out->origin_of) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", points->num_vertices);
    for (size_t p = 0; p < points->num_vertices; p++) {
        double place[3];
        for (int k = 0; k < 3; k++) place[k] = brio_property_value(o[k], p);
        size_t row = row_of(out, place);
        if (row == out->num_origins) {
            FORWARD(grow_places(r, out, &capacity));
            memcpy(out->origins + 3 * out->num_origins++, place, sizeof place);
        }
        out->origin_of[p] = (uint32_t)row;
    }
    return BRIO_OK;
}

static brio_status take_from(run *r, const char *text, evidence *out) {
    out->origins = malloc(3 * sizeof *out->origins);
    if (!out->origins) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for a place");
    read_place(text, out->origins);
    out->num_origins = 1;
    return BRIO_OK;
}

brio_status cli_find_evidence(run *r, const evidence_options *options, brio_mesh *points, evidence *out) {
    *out = (evidence){0};
    if (!options->ignore_normals) FORWARD(take_normals(r, points, out));
    if (options->from)
        FORWARD(take_from(r, options->from, out));
    else if (!options->ignore_origins)
        FORWARD(take_origins(r, points, out));
    out->taken = (brio_evidence){0};
    out->taken.normals = out->normals;
    out->taken.origins = out->origins;
    out->taken.num_origins = out->num_origins;
    out->taken.origin_of = out->origin_of;
    for (int k = 0; k < 3 && r->added_origins; k++) brio_mesh_remove_property(points, ORIGINS[k]);
    return BRIO_OK;
}

void cli_evidence_free(evidence *e) {
    free(e->normals);
    free(e->origins);
    free(e->origin_of);
    *e = (evidence){0};
}
