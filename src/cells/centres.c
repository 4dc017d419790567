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

/* Computes the centres of the batches [from, to), each of BRIO_CENTRE_BATCH tetrahedra. */
static void find_batches(void *user, size_t from, size_t to, int thread) {
    brio_diagram *d = user;
    (void)thread;
    for (size_t first = from * BRIO_CENTRE_BATCH; first < to * BRIO_CENTRE_BATCH && first < d->num_finite;
         first += BRIO_CENTRE_BATCH) {
        uint32_t vertex[BRIO_CENTRE_BATCH][4];
        double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
        size_t left = d->num_finite - first, count = left < BRIO_CENTRE_BATCH ? left : BRIO_CENTRE_BATCH;
        for (size_t n = 0; n < count; n++) memcpy(vertex[n], d->t.tet[first + n].vertex, sizeof *vertex);
        brio_centres(&(brio_centre_batch){d->points, d->weights, (const uint32_t(*)[4])vertex, count}, centre[0],
                     error);
        for (size_t n = 0; n < count; n++) {
            double *row = d->centre[first + n];
            bool known = !isnan(centre[n][0]);
            for (int k = 0; k < 3; k++) row[k] = known ? centre[n][k] * d->scale : NAN;
            row[3] = known ? error[n] * d->scale : NAN;
        }
    }
}

brio_status brio_diagram_find_centres(brio_diagram *d) {
    brio_status status = BRIO_OK;
    size_t batches = (d->num_finite + BRIO_CENTRE_BATCH - 1) / BRIO_CENTRE_BATCH;
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->centre, d->t.count));
    brio_for(d->ctx, brio_threads(d->ctx, batches, BATCHES_A_THREAD), batches, find_batches, d);
    for (size_t t = d->num_finite; t < d->t.count; t++)
        for (int k = 0; k < 4; k++) d->centre[t][k] = NAN;
done:
    return status;
}

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

static void find_places(void *user, size_t from, size_t to, int thread) {
    const placing *p = user;
    (void)thread;
    for (size_t t = from; t < to; t++) p->d->centre[t][3] = place_of(p->d, p->region, p->d->centre[t]);
}

void brio_diagram_find_places(brio_diagram *d, const brio_region *region) {
    placing p = {d, region};
    size_t least = (size_t)BATCHES_A_THREAD * BRIO_CENTRE_BATCH;
    brio_for(d->ctx, brio_threads(d->ctx, d->t.count, least), d->t.count, find_places, &p);
}
