/* The tetrahedra that share a centre exactly, because five or more points are on one empty sphere.
 *
 * Two mates share their centre if and only if the fifth point is on the sphere of the other four: the in-sphere
 * determinant is 0. Computed centres that are farther apart than their error bounds are different, which settles nearly
 * all mates of points in general position; the exact predicate settles the others. Two infinite tetrahedra that are
 * mates share their normal if and only if the four vertices of their hull facets are coplanar.
 *
 * Rows of tetrahedra that share a centre stay as they are, and may differ in their last bits: a row depends on the four
 * vertices alone, so that a part of the tetrahedra has the same rows as all. */
#include "base/memory.h"
#include "base/team.h"
#include "base/union_find.h"
#include "cells/diagram.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { TETRAHEDRA_A_THREAD = 1 << 12, CHUNK = 1 << 12 };

typedef struct {
    brio_diagram *d;
    int threads;
    brio_filter filter;
    brio_record *record; /* #P: the points as the predicates want them */
    size_t candidates;   /* pairs of mates that the error bounds do not settle; atomic */
    bool search;         /* whether candidates are only counted */
} tie_search;

/* Returns whether the error bounds of the centres of two finite tetrahedra allow both to be one point. */
static inline bool may_share(const double *a, const double *b) {
    double bound = (a[3] + b[3]) * (1 + 0x1p-50);
    if (fabs(a[0] - b[0]) > bound) return false;                         /* settles most pairs */
    return !(fabs(a[1] - b[1]) > bound) && !(fabs(a[2] - b[2]) > bound); /* true also if a number is NaN */
}

/* Returns whether tetrahedron t and its mate behind facet i share their centre. Both are finite or both infinite. */
static bool shares(const tie_search *s, brio_filter *f, uint32_t t, int i) {
    assert((t >= s->d->num_finite) == (brio_tet_of(s->d->t.tet[t].mate[i]) >= s->d->num_finite));
    const uint32_t *v = s->d->t.tet[t].vertex;
    const brio_record *r = (const brio_record *)s->record;
    const double *apex = r[brio_apex(&s->d->t, s->d->t.tet[t].mate[i])];
    if (t >= s->d->num_finite) return brio_orient3d_sign(f, r[v[0]], r[v[1]], r[v[2]], apex) == 0;
    return brio_insphere_sign(f, r[v[0]], r[v[1]], r[v[2]], r[v[3]], apex, s->d->weights != NULL) == 0;
}

static void look_at_some(void *user, size_t from, size_t to, int thread) {
    tie_search *s = user;
    brio_diagram *d = s->d;
    brio_filter filter = s->filter;
    size_t candidates = 0, finite = d->num_finite;
    (void)thread;
    const brio_tetrahedron *tet = d->t.tet;
    const double(*centre)[4] = (const double(*)[4])d->centre;
    for (size_t n = from; n < to; n++) {
        uint32_t t = brio_listed(d, n);
        for (int i = 0; i < (t < finite ? 4 : 3); i++) {
            uint32_t u = brio_tet_of(tet[t].mate[i]);
            if (u <= t || (u >= finite) != (t >= finite) || !brio_is_listed(d, u)) continue;
            if (t < finite && !may_share(centre[t], centre[u])) continue;
            candidates++;
            if (s->search && shares(s, &filter, t, i)) brio_unite(d->same, t, u, s->threads == 1);
        }
    }
    __atomic_add_fetch(&s->candidates, candidates, __ATOMIC_RELAXED);
}

static void fill_records(tie_search *s, size_t num_points) {
    const brio_diagram *d = s->d;
    for (size_t p = 0; p < num_points; p++) {
        memcpy(s->record[p], d->points + 3 * p, 3 * sizeof(double));
        s->record[p][3] = d->weights ? d->weights[p] : 0;
    }
}

brio_status brio_diagram_unite_ties(brio_diagram *d) {
    brio_status status = BRIO_OK;
    tie_search s = {.d = d, .threads = brio_threads(d->ctx, d->num_listed, TETRAHEDRA_A_THREAD)};
    size_t rows = d->num_points + (d->flat ? 3 : 0);
    BRIO_TRY(brio_for_chunks(d->ctx, s.threads, d->num_listed, CHUNK, look_at_some, &s));
    if (!s.candidates) goto done;
    BRIO_TRY(BRIO_ALLOC(d->ctx, s.record, rows));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->same, d->t.count));
    for (size_t t = 0; t < d->t.count; t++) d->same[t] = (uint32_t)t;
    fill_records(&s, rows);
    brio_filter_for(&s.filter, (const brio_record *)s.record, rows, d->weights != NULL);
    s.search = true;
    BRIO_TRY(brio_for_chunks(d->ctx, s.threads, d->num_listed, CHUNK, look_at_some, &s));
    for (size_t t = 0; t < d->t.count; t++) {
        d->same[t] = brio_find(d->same, (uint32_t)t);
        assert(d->same[t] <= t); /* I2: the least of them */
    }
done:
    brio_release(d->ctx, s.record);
    return status;
}
