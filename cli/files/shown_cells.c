/* The cells that a page and a picture show: those that end, near the points, and of many an even choice. A page moves
 * them apart by itself; in a picture they are smaller, so that each can be told from others. */
#include "cli/files/read_write.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SHOWN = 8000 };
/* Bytes of a cell that is shown, twice in a picture, its share of it included. Measured. */
static const double SHOWN_BYTES = 6000;
static const double SMALLER = 0.1;

/* How far cells that are shown reach beyond the box of the points at most, as parts of its longest side. Open sets have
 * long needles of cells at their border, beside which all others would be too small to see: what is shown is at most
 * one and a half times as long as the points. Chosen. */
static const double BEYOND = 0.25;

void cli_shown_cells_stay_near(shown_cells *s, const double *points, size_t count) {
    for (const double *p = points; p < points + 3 * count; p += 3) {
        if (!s->is_near) memcpy(s->low, p, sizeof s->low), memcpy(s->high, p, sizeof s->high);
        s->is_near = true;
        for (int k = 0; k < 3; k++) {
            s->low[k] = fmin(s->low[k], p[k]);
            s->high[k] = fmax(s->high[k], p[k]);
        }
    }
}

static bool is_near(const shown_cells *s, const double *vertex, double beyond) {
    for (int k = 0; k < 3; k++)
        if (!(vertex[k] >= s->low[k] - beyond && vertex[k] <= s->high[k] + beyond)) return false;
    return true;
}

/* Takes out of cells that end those that reach far beyond the points.   bounded  of each cell. */
static void drop_far(const shown_cells *s, const brio_cells *cells, uint8_t *bounded) {
    double beyond = 0;
    for (int k = 0; k < 3; k++) beyond = fmax(beyond, BEYOND * (s->high[k] - s->low[k]));
    for (size_t c = 0; c < cells->num_cells; c++) {
        uint64_t k = cells->corner_offsets[cells->face_offsets[c]];
        uint64_t end = cells->corner_offsets[cells->face_offsets[c + 1]];
        for (; bounded[c] && k < end; k++)
            bounded[c] = is_near(s, cells->vertices + 3 * (size_t)cells->face_vertices[k], beyond);
    }
}

/* Makes the meshes of one part.   count  how many cells are shown, at most. */
static brio_status add_meshes(run *r, shown_cells *s, const brio_cells *cells, size_t count) {
    size_t left_out;
    FORWARD(brio_cells_mesh(r->ctx, cells, count, 0, &left_out, &s->whole[s->count]));
    s->count++;
    s->left_out -= cells->num_cells - left_out;
    if (!r->common.picture) return BRIO_OK;
    return brio_cells_mesh(r->ctx, cells, count, SMALLER, NULL, &s->small[s->count - 1]);
}

brio_status cli_shown_cells_add(run *r, shown_cells *s, const brio_cells *cells, const uint64_t *site) {
    brio_status status = BRIO_OK;
    size_t n = cells->num_cells;
    uint64_t most = cli_most_shown(r, s->all, MOST_SHOWN, SHOWN_BYTES), end = s->seen + n;
    if (!n) return BRIO_OK;
    size_t count = (size_t)(end * most / s->all - s->seen * most / s->all);
    brio_cells named = *cells;
    s->seen = end;
    s->left_out += n;
    if (!count) return BRIO_OK;
    named.site = malloc(n * sizeof *named.site);
    named.bounded = malloc(n * sizeof *named.bounded);
    if (!s->whole) s->whole = calloc((size_t)most, sizeof *s->whole); /* a part has one of these cells, or more */
    if (!s->small) s->small = calloc((size_t)most, sizeof *s->small);
    if (!named.site || !named.bounded || !s->whole || !s->small)
        FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu cells that are shown", n);
    for (size_t c = 0; c < n; c++) named.site[c] = site ? (uint32_t)site[c] : cells->site[c];
    memcpy(named.bounded, cells->bounded, n * sizeof *named.bounded);
    if (s->is_near) drop_far(s, cells, named.bounded);
    status = add_meshes(r, s, &named, count);
done:
    free(named.site);
    free(named.bounded);
    return status;
}

/* Copies a property of the faces of meshes, one after the other. */
static brio_status join_property(const shown_cells *s, brio_mesh *const *parts, const char *name, brio_scalar type,
                                 size_t bytes, brio_mesh *joined) {
    void *data;
    size_t at = 0;
    FORWARD(brio_mesh_add_face_property(joined, name, type, &data));
    for (size_t i = 0; i < s->count; i++) {
        size_t n = parts[i]->num_faces;
        if (n) memcpy((char *)data + at * bytes, brio_mesh_face_property(parts[i], name)->data, n * bytes);
        at += n;
    }
    return BRIO_OK;
}

/* Joins meshes of cells, with their sites and volumes. */
static brio_status join(run *r, const shown_cells *s, brio_mesh *const *parts, brio_mesh **out) {
    brio_status status = BRIO_OK;
    size_t vertices = 0, faces = 0, corners = 0;
    for (size_t i = 0; i < s->count; i++) {
        vertices += parts[i]->num_vertices;
        faces += parts[i]->num_faces;
        corners += (size_t)parts[i]->face_offsets[parts[i]->num_faces];
    }
    double *places = malloc((3 * vertices + 1) * sizeof *places);
    uint64_t *offsets = calloc(faces + 1, sizeof *offsets);
    uint32_t *corner = malloc((corners + 1) * sizeof *corner);
    if (!places || !offsets || !corner) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu faces of cells", faces);
    if (vertices > UINT32_MAX) FAIL(r, BRIO_ERR_TOO_LARGE, "cells of more than 2^32 vertices in a mesh");
    vertices = faces = corners = 0;
    for (size_t i = 0; i < s->count; i++) {
        const brio_mesh *m = parts[i];
        if (m->num_vertices) memcpy(places + 3 * vertices, m->vertices, 3 * m->num_vertices * sizeof *places);
        for (uint64_t k = 0; k < m->face_offsets[m->num_faces]; k++)
            corner[corners + k] = (uint32_t)vertices + m->face_vertices[k];
        for (size_t f = 1; f <= m->num_faces; f++) offsets[faces + f] = corners + m->face_offsets[f];
        vertices += m->num_vertices;
        faces += m->num_faces;
        corners = (size_t)offsets[faces];
    }
    TRY(brio_mesh_new(r->ctx, out));
    TRY(brio_mesh_set_vertices(*out, places, vertices));
    TRY(brio_mesh_set_faces(*out, offsets, corner, faces));
    if (s->has_sites) TRY(join_property(s, parts, "site", BRIO_SCALAR_UINT32, sizeof(uint32_t), *out));
    TRY(join_property(s, parts, "volume", BRIO_SCALAR_FLOAT64, sizeof(double), *out));
done:
    free(places);
    free(offsets);
    free(corner);
    return status;
}

brio_status cli_shown_cells_show(run *r, const shown_cells *s) {
    brio_mesh *whole = NULL, *small = NULL;
    brio_status status = BRIO_OK;
    TRY(join(r, s, s->whole, &whole));
    if (r->common.picture) TRY(join(r, s, s->small, &small));
    if (!whole->num_faces)
        FAIL(r, BRIO_ERR_NO_ANSWER, "no cell ends near the points: nothing to show; --box cuts cells off");
    TRY(cli_show_both(r, whole, small, "volume"));
    if (s->left_out) cli_warn(r, WARNING_CELLS, cli_showing(r), s->left_out, (size_t)s->all);
done:
    brio_mesh_free(whole);
    brio_mesh_free(small);
    return status;
}

void cli_shown_cells_free(shown_cells *s) {
    for (size_t i = 0; i < s->count; i++) {
        brio_mesh_free(s->whole[i]);
        brio_mesh_free(s->small[i]);
    }
    free(s->whole);
    free(s->small);
}
