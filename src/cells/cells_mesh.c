/* Cells as a mesh: to be looked at. See brio_cells_mesh. */
#include "base/context.h"
#include "base/float_state.h"
#include "base/memory.h"
#include <math.h>
#include <string.h>

typedef struct {
    brio_context *ctx;
    const brio_cells *cells;
    double shrink;
    uint32_t *place; /* of each vertex of the cells in the mesh; one of an earlier cell if it is below `first` */
    uint32_t first;  /* the cell's first vertex */
    size_t vertices, corners; /* so far */
    size_t vertex_room, corner_room, face_room;
    brio_mesh *mesh;
    uint32_t *site;  /* #F: of the cell, a row each face */
    double *volume;  /* #F */
    size_t rooms[2]; /* of these two */
} work;

static bool is_shown(const brio_cells *cells, size_t c) {
    if (!cells->bounded[c] || cells->face_offsets[c] == cells->face_offsets[c + 1]) return false;
    for (uint64_t k = cells->corner_offsets[cells->face_offsets[c]];
         k < cells->corner_offsets[cells->face_offsets[c + 1]]; k++)
        for (size_t i = 0; i < 3; i++)
            if (!isfinite(cells->vertices[3 * (size_t)cells->face_vertices[k] + i])) return false;
    return true;
}

/* Returns the row of a vertex of the cell at work; adds it if it is not there. */
static brio_status find_vertex(work *w, uint32_t v, uint32_t *row) {
    brio_mesh *m = w->mesh;
    *row = w->place[v];
    if (*row >= w->first && *row != UINT32_MAX) return BRIO_OK;
    BRIO_EXPECT(w->ctx, w->vertices < UINT32_MAX - 1, BRIO_ERR_TOO_LARGE, "cells of more than 2^32 vertices in a mesh");
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, m->vertices, w->vertex_room, 3 * w->vertices + 3));
    memcpy(m->vertices + 3 * w->vertices, w->cells->vertices + 3 * (size_t)v, 3 * sizeof *m->vertices);
    *row = w->place[v] = (uint32_t)w->vertices++;
    return BRIO_OK;
}

static brio_status add_face(work *w, size_t c, uint64_t f) {
    brio_mesh *m = w->mesh;
    const uint64_t *at = w->cells->corner_offsets + f;
    size_t n = m->num_faces;
    if (at[1] - at[0] < 3) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, m->face_offsets, w->face_room, n + 2));
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, w->site, w->rooms[0], n + 1));
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, w->volume, w->rooms[1], n + 1));
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, m->face_vertices, w->corner_room, w->corners + (size_t)(at[1] - at[0])));
    for (uint64_t k = at[0]; k < at[1]; k++)
        BRIO_FORWARD(find_vertex(w, w->cells->face_vertices[k], &m->face_vertices[w->corners++]));
    w->site[n] = w->cells->site[c];
    w->volume[n] = w->cells->volume[c];
    m->face_offsets[++m->num_faces] = w->corners;
    return brio_look(w->ctx, (size_t)(at[1] - at[0]));
}

/* Moves the vertices of the cell at work towards their middle. */
static void shrink_cell(work *w) {
    double middle[3] = {0, 0, 0}, count = (double)(w->vertices - w->first), *v = w->mesh->vertices;
    for (size_t i = 3 * (size_t)w->first; i < 3 * w->vertices; i++) middle[i % 3] += v[i] / count;
    for (size_t i = 3 * (size_t)w->first; i < 3 * w->vertices; i++)
        v[i] = w->shrink * middle[i % 3] + (1 - w->shrink) * v[i];
}

static brio_status add_cell(work *w, size_t c) {
    w->first = (uint32_t)w->vertices;
    for (uint64_t f = w->cells->face_offsets[c]; f < w->cells->face_offsets[c + 1]; f++)
        BRIO_FORWARD(add_face(w, c, f));
    if (w->shrink > 0) shrink_cell(w);
    w->mesh->num_vertices = w->vertices;
    return BRIO_OK;
}

static brio_status add_properties(work *w) {
    uint32_t *site = NULL;
    double *volume = NULL;
    size_t n = w->mesh->num_faces;
    BRIO_FORWARD(brio_mesh_add_face_property(w->mesh, "site", BRIO_SCALAR_UINT32, (void **)&site));
    if (n) memcpy(site, w->site, n * sizeof *site);
    BRIO_FORWARD(brio_mesh_add_face_property(w->mesh, "volume", BRIO_SCALAR_FLOAT64, (void **)&volume));
    if (n) memcpy(volume, w->volume, n * sizeof *volume);
    return BRIO_OK;
}

brio_status brio_cells_mesh(brio_context *ctx, const brio_cells *cells, size_t most, double shrink, size_t *left_out,
                            brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    work w = {.ctx = ctx, .cells = cells, .shrink = shrink};
    size_t shown = 0, seen = 0, taken = 0;
    *out = NULL;
    BRIO_REQUIRE(ctx, cells->vertices || !cells->num_vertices, BRIO_ERR_ARGUMENT,
                 "cells without vertices: brio_cells_options.vertices is 0");
    BRIO_REQUIRE(ctx, cells->corner_offsets && cells->face_offsets, BRIO_ERR_ARGUMENT, "cells without faces");
    BRIO_REQUIRE(ctx, shrink >= 0 && shrink < 1, BRIO_ERR_ARGUMENT, "shrink is %g, expected 0 to 1", shrink);
    for (size_t c = 0; c < cells->num_cells; c++) shown += is_shown(cells, c);
    if (!most || most > shown) most = shown;
    BRIO_TRY(brio_mesh_new(ctx, &w.mesh));
    BRIO_TRY(BRIO_ALLOC(ctx, w.place, cells->num_vertices + 1));
    memset(w.place, 0xff, (cells->num_vertices + 1) * sizeof *w.place);
    BRIO_TRY(BRIO_RESERVE(ctx, w.mesh->face_offsets, w.face_room, 1));
    w.mesh->face_offsets[0] = 0;
    for (size_t c = 0; c < cells->num_cells && taken < most; c++) {
        if (!is_shown(cells, c) || seen++ != (uint64_t)taken * shown / most) continue;
        BRIO_TRY(add_cell(&w, c));
        taken++;
    }
    BRIO_TRY(add_properties(&w));
    if (left_out) *left_out = cells->num_cells - taken;
    *out = w.mesh;
    w.mesh = NULL;
done:
    brio_mesh_free(w.mesh);
    brio_release(ctx, w.place);
    brio_release(ctx, w.site);
    brio_release(ctx, w.volume);
    return status;
}
