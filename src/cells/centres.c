/* The centres of all tetrahedra, and where they are in the region.
 *
 * Until the ties are known, the fourth number of a row is a bound of the centre's error (ties.c). */
#include "base/memory.h"
#include "base/team.h"
#include "cells/diagram.h"
#include "predicates/circumcentre.h"
#include <math.h>
#include <string.h>

enum { BATCHES_A_THREAD = 64 };

/* FAR_REACHES, chosen: centres farther than this many sides of the region from it are "far". An error of 2^-44 of that
 * distance is below 1e-12 of the region. */
static const double FAR_REACHES = 8;

typedef struct {
    brio_diagram *d;
    const brio_region *region;
} placing;

static brio_place place_of(const brio_diagram *d, const brio_region *r, const double *centre) {
    if (d->flat || isnan(centre[0])) return BRIO_PLACE_FAR;
    if (r->box && r->low[0] < centre[0] && centre[0] < r->high[0] && r->low[1] < centre[1] && centre[1] < r->high[1] &&
        r->low[2] < centre[2] && centre[2] < r->high[2])
        return BRIO_PLACE_INSIDE; /* settles most centres */
    for (int k = 0; k < 3 && r->num_planes; k++)
        if (!(fabs(centre[k] - r->middle[k]) < FAR_REACHES * r->reach)) return BRIO_PLACE_FAR;
    for (size_t i = 0; i < r->num_planes; i++)
        if (brio_region_is_over(r, i, centre)) return BRIO_PLACE_OUTSIDE;
    return BRIO_PLACE_INSIDE;
}

/* Marks the vertices of a tetrahedron whose centre is not in the region. */
static inline void mark(const brio_diagram *d, const uint32_t *rank, int count) {
    for (int i = 0; i < count; i++) __atomic_store_n(&d->marked[rank[i]], 1, __ATOMIC_RELAXED);
}

/* Computes the centres of a batch, the tetrahedra from `first`. */
static void find_batch(const placing *p, size_t first, size_t count) {
    brio_diagram *d = p->d;
    uint32_t rank[BRIO_CENTRE_BATCH][4];
    double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
    for (size_t n = 0; n < count; n++)
        for (int i = 0; i < 4; i++) rank[n][i] = d->rank[d->t.tet[first + n].vertex[i]];
    brio_centres(&(brio_centre_batch){d->ranked, d->ranked_square, (const uint32_t(*)[4])rank, count}, centre[0],
                 error);
    for (size_t n = 0; n < count; n++) {
        double *row = d->centre[first + n];
        bool known = !isnan(centre[n][0]);
        for (int k = 0; k < 3; k++) row[k] = known ? centre[n][k] : NAN;
        row[3] = known ? error[n] : NAN;
        if (d->marked && place_of(d, p->region, row) != BRIO_PLACE_INSIDE) mark(d, rank[n], 4);
    }
    if (d->id) memcpy(d->id[first], rank, count * sizeof *rank);
}

static void find_batches(void *user, size_t from, size_t to, int thread) {
    const placing *p = user;
    size_t finite = p->d->num_finite;
    (void)thread;
    for (size_t t = from * BRIO_CENTRE_BATCH; t < to * BRIO_CENTRE_BATCH && t < finite; t += BRIO_CENTRE_BATCH)
        find_batch(p, t, finite - t < BRIO_CENTRE_BATCH ? finite - t : BRIO_CENTRE_BATCH);
}

/* Gives the infinite tetrahedra no centres. */
static void set_infinite(brio_diagram *d) {
    for (size_t t = d->num_finite; t < d->t.count; t++) {
        const uint32_t *v = d->t.tet[t].vertex;
        for (int k = 0; k < 4; k++) d->centre[t][k] = NAN;
        if (d->marked) mark(d, (const uint32_t[]){d->rank[v[0]], d->rank[v[1]], d->rank[v[2]]}, 3);
    }
}

/* Lists the tetrahedra with marked vertices, in ascending order. Infinite ones have them. */
static void list_tetrahedra(brio_diagram *d) {
    size_t n = 0;
    for (size_t t = 0; t < d->num_finite; t++) {
        const uint32_t *v = d->id[t];
        d->listed[n] = (uint32_t)t;
        n += d->marked[v[0]] | d->marked[v[1]] | d->marked[v[2]] | d->marked[v[3]];
    }
    for (size_t t = d->num_finite; t < d->t.count; t++) d->listed[n++] = (uint32_t)t;
    d->num_listed = n;
}

brio_status brio_diagram_find_centres(brio_diagram *d, const brio_region *region) {
    placing p = {d, region};
    size_t batches = (d->num_finite + BRIO_CENTRE_BATCH - 1) / BRIO_CENTRE_BATCH;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->centre, d->t.count));
    if (d->volumes_only) {
        BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->id, d->num_finite));
        BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, d->marked, d->num_vertices));
    }
    BRIO_FORWARD(brio_for(d->ctx, brio_threads(d->ctx, batches, BATCHES_A_THREAD), batches, find_batches, &p));
    set_infinite(d);
    d->num_listed = d->t.count;
    if (!d->volumes_only) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->listed, d->t.count));
    list_tetrahedra(d);
    return BRIO_OK;
}

static void find_places(void *user, size_t from, size_t to, int thread) {
    const placing *p = user;
    (void)thread;
    for (size_t i = from; i < to; i++) {
        double *row = p->d->centre[brio_listed(p->d, i)];
        row[3] = place_of(p->d, p->region, row);
    }
}

brio_status brio_diagram_find_places(brio_diagram *d, const brio_region *region) {
    placing p = {d, region};
    size_t least = (size_t)BATCHES_A_THREAD * BRIO_CENTRE_BATCH;
    return brio_for(d->ctx, brio_threads(d->ctx, d->num_listed, least), d->num_listed, find_places, &p);
}
