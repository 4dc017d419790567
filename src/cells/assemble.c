/* The faces and vertices of all cells, in the order of the cells.
 *
 * Voronoi vertices come first, in the order of their tetrahedra, each once; then the vertices that clipping made, in
 * the order of the cells. */
#include "base/memory.h"
#include "base/team.h"
#include "cells/cell_record.h"
#include <assert.h>
#include <string.h>

enum { CELLS_A_THREAD = 1 << 12 };

typedef struct {
    brio_cell_job *job;
    uint32_t *vertex_of;    /* of each tetrahedron: one more than the vertex at its centre; 0 if it is no corner */
    uint64_t *first_corner; /* of each cell, or NULL without vertices */
    uint64_t *first_vertex; /* of each cell: its first own vertex; or NULL without vertices */
    size_t num_voronoi;     /* vertices at centres */
} assembly;

/* Returns whether the faces of a cell come from the sweep. */
static inline bool is_swept(const brio_cell_job *job, size_t c) {
    return job->sweep && !job->sweep->left[job->sweep->rank[job->out->site[c]]];
}

/* Writes the number of faces of each cell to where the next cell's faces begin. */
static void count_faces(void *user, size_t from, size_t to, int thread) {
    const brio_cell_job *job = ((assembly *)user)->job;
    (void)thread;
    for (size_t c = from; c < to; c++)
        job->out->face_offsets[c + 1] = is_swept(job, c)
                                            ? brio_sweep_degree(job->sweep, job->sweep->rank[job->out->site[c]])
                                            : job->place[c].num_faces;
}

static brio_status offset_cells(assembly *a) {
    const brio_cell_job *job = a->job;
    brio_cells *out = job->out;
    brio_context *ctx = job->d->ctx;
    size_t n = out->num_cells;
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_offsets, n + 1));
    out->face_offsets[0] = 0;
    BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, n, CELLS_A_THREAD), n, count_faces, a));
    for (size_t c = 0; c < n; c++) out->face_offsets[c + 1] += out->face_offsets[c];
    if (!job->vertices) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(ctx, a->first_corner, n + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, a->first_vertex, n + 1));
    a->first_corner[0] = a->first_vertex[0] = 0;
    for (size_t c = 0; c < n; c++) {
        a->first_corner[c + 1] = a->first_corner[c] + job->place[c].num_corners;
        a->first_vertex[c + 1] = a->first_vertex[c] + job->place[c].num_vertices;
    }
    return BRIO_OK;
}

/* --- faces --- */

/* Lets the sweep write the neighbours of its cells. */
static brio_status copy_neighbours(const brio_cell_job *job) {
    brio_cells *out = job->out;
    brio_status status = BRIO_OK;
    uint64_t *first = NULL;
    BRIO_TRY(BRIO_ALLOC(job->d->ctx, first, job->d->num_sites));
    for (size_t c = 0; c < out->num_cells; c++) first[out->site[c]] = out->face_offsets[c];
    BRIO_TRY(brio_sweep_neighbours(job->sweep, first, out->face_neighbours));
done:
    brio_release(job->d->ctx, first);
    return status;
}

static void copy_faces(void *user, size_t from, size_t to, int thread) {
    const assembly *a = user;
    brio_cells *out = a->job->out;
    (void)thread;
    for (size_t c = from; c < to; c++) {
        const brio_cell_place *place = &a->job->place[c];
        if (is_swept(a->job, c)) continue;
        assert(0 <= place->thread && place->thread < a->job->threads &&
               place->face + place->num_faces <= a->job->recorder[place->thread].num_faces);
        const brio_cell_recorder *r = &a->job->recorder[place->thread];
        uint64_t corner = a->first_corner ? a->first_corner[c] : 0;
        for (size_t i = 0; i < place->num_faces; i++) {
            const brio_cell_face *face = &r->face[place->face + i];
            size_t f = (size_t)out->face_offsets[c] + i;
            out->face_neighbours[f] = face->neighbour;
            if (out->face_areas) out->face_areas[f] = face->area;
            if (out->face_normals) memcpy(out->face_normals + 3 * f, face->normal, sizeof face->normal);
            if (!out->corner_offsets) continue;
            out->corner_offsets[f] = corner;
            corner += face->corners;
            assert(corner <= a->first_corner[c + 1]);
        }
    }
}

static brio_status make_faces(assembly *a) {
    brio_cells *out = a->job->out;
    brio_context *ctx = a->job->d->ctx;
    size_t cells = out->num_cells, faces = (size_t)out->face_offsets[cells];
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_neighbours, faces));
    if (a->job->sizes) {
        BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_areas, faces));
        BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_normals, 3 * faces));
    }
    if (a->job->vertices) {
        BRIO_FORWARD(BRIO_ALLOC(ctx, out->corner_offsets, faces + 1));
        out->corner_offsets[faces] = a->first_corner[cells];
    }
    if (a->job->sweep) BRIO_FORWARD(copy_neighbours(a->job));
    if (a->job->sweep && !a->job->sweep->num_left) return BRIO_OK;
    return brio_for(ctx, brio_threads(ctx, cells, CELLS_A_THREAD), cells, copy_faces, a);
}

/* --- vertices --- */

/* Numbers the centres that are corners, in the order of their tetrahedra. */
static brio_status number_centres(assembly *a) {
    const brio_cell_job *job = a->job;
    const brio_diagram *d = job->d;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, a->vertex_of, d->t.count));
    for (int i = 0; i < job->threads; i++)
        for (size_t c = 0; c < job->recorder[i].num_corners; c++) {
            uint32_t corner = job->recorder[i].corner[c];
            if (!(corner & BRIO_OWN_VERTEX)) a->vertex_of[corner] = 1;
        }
    for (size_t t = 0; t < d->t.count; t++)
        if (a->vertex_of[t]) a->vertex_of[t] = (uint32_t)++a->num_voronoi;
    return BRIO_OK;
}

static void copy_corners(void *user, size_t from, size_t to, int thread) {
    const assembly *a = user;
    const brio_cell_job *job = a->job;
    double inverse = 1 / job->d->scale;
    (void)thread;
    for (size_t c = from; c < to; c++) {
        const brio_cell_place *place = &job->place[c];
        assert(place->corner + place->num_corners <= job->recorder[place->thread].num_corners);
        const brio_cell_recorder *r = &job->recorder[place->thread];
        size_t first = a->num_voronoi + (size_t)a->first_vertex[c];
        for (size_t i = 0; i < place->num_corners; i++) {
            uint32_t corner = r->corner[place->corner + i];
            bool own = corner & BRIO_OWN_VERTEX;
            assert(own ? (corner & ~BRIO_OWN_VERTEX) < place->num_vertices : a->vertex_of[corner] > 0);
            job->out->face_vertices[a->first_corner[c] + i] =
                own ? (uint32_t)(first + (corner & ~BRIO_OWN_VERTEX)) : a->vertex_of[corner] - 1;
        }
        for (size_t i = 0; i < place->num_vertices; i++)
            for (size_t k = 0; k < 3; k++)
                job->out->vertices[3 * (first + i) + k] = r->vertex[place->vertex + i][k] * inverse + job->d->origin[k];
    }
}

static void copy_centres(const assembly *a) {
    const brio_diagram *d = a->job->d;
    double inverse = 1 / d->scale;
    for (size_t t = 0; t < d->t.count; t++) {
        if (!a->vertex_of[t]) continue;
        double *x = a->job->out->vertices + 3 * (size_t)(a->vertex_of[t] - 1);
        for (int k = 0; k < 3; k++) x[k] = d->centre[t][k] * inverse + d->origin[k];
    }
}

static brio_status make_vertices(assembly *a) {
    const brio_cell_job *job = a->job;
    brio_cells *out = job->out;
    brio_context *ctx = job->d->ctx;
    size_t cells = out->num_cells;
    BRIO_FORWARD(number_centres(a));
    out->num_vertices = a->num_voronoi + (size_t)a->first_vertex[cells];
    BRIO_EXPECT(ctx, out->num_vertices < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu vertices of cells; at most 2^32 - 2",
                out->num_vertices);
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->vertices, 3 * out->num_vertices));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_vertices, (size_t)a->first_corner[cells]));
    copy_centres(a);
    return brio_for(ctx, brio_threads(ctx, cells, CELLS_A_THREAD), cells, copy_corners, a);
}

brio_status brio_cells_assemble(brio_cell_job *job) {
    brio_status status = BRIO_OK;
    assembly a = {.job = job};
    BRIO_TRY(offset_cells(&a));
    BRIO_TRY(make_faces(&a));
    if (job->vertices) BRIO_TRY(make_vertices(&a));
done:
    brio_release(job->d->ctx, a.vertex_of);
    brio_release(job->d->ctx, a.first_corner);
    brio_release(job->d->ctx, a.first_vertex);
    return status;
}
