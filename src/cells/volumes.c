/* Volumes alone, in one pass over the tetrahedra.
 *
 * A facet abc of two mates with the centres c and d is dual to an edge of three cells. By star_cell.c the edge adds
 * (2 f_y - 2 f_z) . (c - p) x (d - p) to 12 times the volume of the cell of each vertex p, where f_y and f_z are the
 * feet of the faces with the facet's other two vertices y and z. Here 2 f_y = k (y - p), with k = 1, or with weights
 * k = 1 + (w_p - w_y) / |y - p|^2. For all three p these are combinations of the same three numbers. With a as the
 * origin, X = c x d and e, g the edges to the other two vertices, they are e . X, g . X, and (d - c) . (e x g). What a
 * facet adds to its three cells is -2 (d - c) . (e x g), whatever the rounding of the other two numbers.
 *
 * A slice of tetrahedra at a time: first the terms of each tetrahedron and vertex, then the sums, where a thread adds
 * to the vertices that it owns. A vertex takes its terms in the order of the tetrahedra, for every number of threads.
 *
 * Cells that the region clips, and unbounded ones, get wrong numbers here; they are computed from their stars.
 *
 * Based on: Aurenhammer. Power diagrams: properties, algorithms and applications. SIAM J. Computing 1987. */
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "cells/diagram.h"
#include <assert.h>
#include <string.h>

/* SLICE, chosen: tetrahedra a thread and slice, whose terms fit the second-level cache. SLICES: between progress. */
enum { SLICE = 1 << 12, SLICES = 64, TETRAHEDRA_A_THREAD = 1 << 14 };

typedef struct {
    const brio_diagram *d;
    double (*term)[4]; /* of the tetrahedra of the slice: what each vertex gets */
    double *volume;
    size_t first, count; /* the slice */
} volume_pass;

static inline void subtract(const double *a, const double *b, double *out) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

/* Returns k - 1 for the vertices p and y. */
static inline double shift(const brio_diagram *d, uint32_t p, uint32_t y, const double *way) {
    assert(p < d->num_vertices && y < d->num_vertices && p != y);
    return (d->ranked_square[p] - d->ranked_square[y]) / brio_dot(way, way);
}

/* Adds the terms of the facet opposite to slot i of tetrahedron t, whose mate is in u. */
static inline void add_facet(const brio_diagram *d, size_t t, int i, uint32_t u, double term[4], const bool weighted) {
    assert(u > t && d->id);
    const uint8_t *slot = BRIO_FACET[i];
    const uint32_t *id = d->id[t];
    const double *a = d->ranked + 3 * (size_t)id[slot[0]];
    double e[3], g[3], c[3], x[3], cross[3], way[3], area[3];
    subtract(d->ranked + 3 * (size_t)id[slot[1]], a, e);
    subtract(d->ranked + 3 * (size_t)id[slot[2]], a, g);
    subtract(d->centre[t], a, c);
    subtract(d->centre[u], a, x);
    subtract(x, c, way);
    brio_cross(c, x, cross);
    brio_cross(e, g, area);
    double ex = brio_dot(e, cross), gx = brio_dot(g, cross), both = brio_dot(way, area), third = ex - gx - both;
    double ab = 0, ac = 0, bc = 0;
    if (weighted) {
        double bc_way[3] = {g[0] - e[0], g[1] - e[1], g[2] - e[2]};
        ab = shift(d, id[slot[0]], id[slot[1]], e) * ex;
        ac = shift(d, id[slot[0]], id[slot[2]], g) * gx;
        bc = shift(d, id[slot[1]], id[slot[2]], bc_way) * third;
    }
    term[slot[0]] += (gx + ac) - (ex + ab);
    term[slot[1]] += (third + bc) - (ex - ab);
    term[slot[2]] += (third - bc) + (gx - ac);
}

/* Finds the terms of the tetrahedra of a slice. A facet counts once, with the lesser of its two tetrahedra. */
static inline void find_terms(const volume_pass *v, size_t from, size_t to, const bool weighted) {
    const brio_diagram *d = v->d;
    for (size_t n = from; n < to; n++) {
        size_t t = v->first + n;
        double term[4] = {0, 0, 0, 0};
        for (int i = 0; i < 4; i++) {
            uint32_t u = brio_tet_of(d->t.tet[t].mate[i]);
            if (u > t) add_facet(d, t, i, u, term, weighted);
        }
        memcpy(v->term[n], term, sizeof term);
    }
}

static void find_some(void *user, size_t from, size_t to, int thread) {
    const volume_pass *v = user;
    (void)thread;
    if (v->d->square)
        find_terms(v, from, to, true);
    else
        find_terms(v, from, to, false);
}

/* Adds the terms of the slice at the vertices [from, to). */
static void add_some(void *user, size_t from, size_t to, int thread) {
    const volume_pass *v = user;
    const uint32_t(*id)[4] = (const uint32_t(*)[4])(v->d->id + v->first);
    (void)thread;
    for (size_t n = 0; n < v->count; n++)
        for (int i = 0; i < 4; i++)
            if (id[n][i] - from < to - from) v->volume[id[n][i]] += v->term[n][i];
}

brio_status brio_diagram_add_volumes(const brio_diagram *d, double *volume) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(d->ctx, d->num_finite, TETRAHEDRA_A_THREAD);
    volume_pass v = {.d = d, .volume = volume};
    size_t size = SLICE * (size_t)threads, shown = 0;
    BRIO_TRY(BRIO_ALLOC(d->ctx, v.term, size));
    for (; v.first < d->num_finite; v.first += size) {
        v.count = d->num_finite - v.first < size ? d->num_finite - v.first : size;
        BRIO_TRY(brio_for(d->ctx, threads, v.count, find_some, &v));
        BRIO_TRY(brio_for_parts(d->ctx, threads, d->num_vertices, add_some, &v));
        if (v.first < shown) continue;
        BRIO_TRY(brio_progress(d->ctx, "cells", 0.4 + 0.4 * ((double)v.first / (double)d->num_finite)));
        shown += d->num_finite / SLICES;
    }
    for (size_t r = 0; r < d->num_vertices; r++) volume[r] /= 12;
done:
    brio_release(d->ctx, v.term);
    return status;
}
