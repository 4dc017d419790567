/* The centres of all tetrahedra, and where they are in the region.
 *
 * Until the ties are known, the fourth number of a row is a bound of the centre's error (ties.c). */
#include "base/memory.h"
#include "base/team.h"
#include "cells/diagram.h"
#include "predicates/circumcentre.h"
#include <math.h>

enum { BATCHES_A_THREAD = 64 };

/* FAR_REACHES, chosen: centres farther than this many sides of the region from it are "far". An error of 2^-44 of that
 * distance is below 1e-12 of the region. */
static const double FAR_REACHES = 8;

typedef struct {
    brio_diagram *d;
    const brio_region *region;
} placing;

brio_place brio_place_of(const brio_region *r, const double *centre) {
    if (isnan(centre[0])) return BRIO_PLACE_FAR;
    if (r->box && r->low[0] < centre[0] && centre[0] < r->high[0] && r->low[1] < centre[1] && centre[1] < r->high[1] &&
        r->low[2] < centre[2] && centre[2] < r->high[2])
        return BRIO_PLACE_INSIDE; /* settles most centres */
    for (int k = 0; k < 3 && r->num_planes; k++)
        if (!(fabs(centre[k] - r->middle[k]) < FAR_REACHES * r->reach)) return BRIO_PLACE_FAR;
    for (size_t i = 0; i < r->num_planes; i++)
        if (brio_region_is_over(r, i, centre)) return BRIO_PLACE_OUTSIDE;
    return BRIO_PLACE_INSIDE;
}

/* Computes the centres of a batch, of the listed tetrahedra from `first`. */
static void find_batch(brio_diagram *d, size_t first, size_t count) {
    uint32_t rank[BRIO_CENTRE_BATCH][4];
    double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
    for (size_t n = 0; n < count; n++)
        for (int i = 0; i < 4; i++) rank[n][i] = d->rank[d->t.tet[brio_listed(d, first + n)].vertex[i]];
    brio_centres(&(brio_centre_batch){d->ranked, d->ranked_square, (const uint32_t(*)[4])rank, count}, centre[0],
                 error);
    for (size_t n = 0; n < count; n++) {
        double *row = d->centre[brio_listed(d, first + n)];
        bool known = !isnan(centre[n][0]);
        for (int k = 0; k < 3; k++) row[k] = known ? centre[n][k] : NAN;
        row[3] = known ? error[n] : NAN;
    }
}

typedef struct {
    brio_diagram *d;
    size_t finite; /* listed ones */
} centre_search;

static void find_batches(void *user, size_t from, size_t to, int thread) {
    const centre_search *s = user;
    (void)thread;
    for (size_t n = from * BRIO_CENTRE_BATCH; n < to * BRIO_CENTRE_BATCH && n < s->finite; n += BRIO_CENTRE_BATCH)
        find_batch(s->d, n, s->finite - n < BRIO_CENTRE_BATCH ? s->finite - n : BRIO_CENTRE_BATCH);
}

brio_status brio_diagram_find_centres(brio_diagram *d) {
    centre_search s = {.d = d, .finite = d->num_listed};
    while (s.finite > 0 && brio_listed(d, s.finite - 1) >= d->num_finite) s.finite--;
    size_t batches = (s.finite + BRIO_CENTRE_BATCH - 1) / BRIO_CENTRE_BATCH;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->centre, d->t.count));
    BRIO_FORWARD(brio_for(d->ctx, brio_threads(d->ctx, batches, BATCHES_A_THREAD), batches, find_batches, &s));
    for (size_t t = d->num_finite; t < d->t.count; t++) /* infinite tetrahedra have no centres */
        for (int k = 0; k < 4; k++) d->centre[t][k] = NAN;
    return BRIO_OK;
}

static void find_places(void *user, size_t from, size_t to, int thread) {
    const placing *p = user;
    (void)thread;
    for (size_t i = from; i < to; i++) {
        double *row = p->d->centre[brio_listed(p->d, i)];
        row[3] = p->d->flat ? BRIO_PLACE_FAR : brio_place_of(p->region, row);
    }
}

brio_status brio_diagram_find_places(brio_diagram *d, const brio_region *region) {
    placing p = {d, region};
    size_t least = (size_t)BATCHES_A_THREAD * BRIO_CENTRE_BATCH;
    return brio_for(d->ctx, brio_threads(d->ctx, d->num_listed, least), d->num_listed, find_places, &p);
}
