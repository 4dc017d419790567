/* Queries of a periodic triangulation: the tetrahedron that holds a place, and the nearest vertex.
 *
 * A place is put on the grid and into the domain, as points are. The nearest vertex is found by the tree of boxes
 * (translates.h). From a tetrahedron there a walk goes across facets that have the place on their other side; the
 * class of a tetrahedron and a shift say where it is. Such a walk ends, because regular triangulations have no cycles
 * of tetrahedra that hide each other. One that takes more steps than any should is given up, and said.
 *
 * Based on: Edelsbrunner. An acyclicity theorem for cell complexes in d dimensions. Combinatorica 1990.
 *           Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/team.h"
#include "periodic/periodic.h"
#include "periodic/translates.h"
#include "triangulation/tetrahedra.h"
#include <assert.h>
#include <string.h>

/* Chosen: QUERIES_A_THREAD are worth a thread; CHUNK of them go to one at a time. MOST_STEPS: of a walk, with those for
 * each tetrahedron; far more than it takes. */
enum { QUERIES_A_THREAD = 256, CHUNK = 64, MOST_STEPS = 1 << 20, MOST_STEPS_A_TET = 64 };

struct brio_periodic_locator {
    brio_context *ctx;
    const brio_periodic *t;
    brio_translates translates;
    uint32_t *corner; /* #points: 4 c + i for a finite class c whose vertex i is a translate of the point */
};

void brio_periodic_locator_free(brio_periodic_locator *l) {
    if (!l) return;
    brio_translates_free(&l->translates);
    brio_release(l->ctx, l->corner);
    brio_release(l->ctx, l);
}

/* Finds a corner of each vertex, and marks the points that are no vertices. */
static brio_status find_corners(brio_periodic_locator *l, uint8_t *left_out) {
    const brio_periodic *t = l->t;
    BRIO_FORWARD(BRIO_ALLOC(l->ctx, l->corner, t->stats.points + 1));
    for (size_t p = 0; p < t->stats.points; p++) {
        const brio_image *r = &t->representative[p];
        l->corner[p] = UINT32_MAX;
        left_out[p] = r->point != p || r->shift[0] || r->shift[1] || r->shift[2];
    }
    for (size_t c = t->stats.tetrahedra; c-- > 0;) /* the first class of each point is left */
        for (int i = 0; i < 4; i++)
            l->corner[t->images.list[t->tet[c].vertex[i]].point] = (uint32_t)(4 * c) + (uint32_t)i;
    return BRIO_OK;
}

brio_status brio_periodic_locator_new(brio_context *ctx, const brio_periodic *t, brio_periodic_locator **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_periodic_locator *l = NULL;
    uint8_t *left_out = NULL;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, l, 1));
    l->ctx = ctx;
    l->t = t;
    BRIO_TRY(BRIO_ALLOC(ctx, left_out, t->stats.points + 1));
    BRIO_TRY(find_corners(l, left_out));
    BRIO_TRY(brio_translates_new(ctx, &t->images, left_out, &l->translates));
    *out = l;
    l = NULL;
done:
    brio_release(ctx, left_out);
    brio_periodic_locator_free(l);
    return status;
}

/* --- one query --- */

/* A tetrahedron: a class, and how far it is moved, in vectors of the reduced basis. */
typedef struct {
    uint32_t class;
    int32_t shift[3];
} brio_place;

/* Returns whether a place in the domain is beyond all translates that matter: outside, then. */
static bool is_far(const brio_translates *t, const double *x) {
    for (int k = 0; k < 3; k++)
        if (x[k] < t->all.low[k] || x[k] > t->all.high[k]) return true;
    return false;
}

/* Walks from a tetrahedron to that which holds x. Ends at an infinite one if none does. Returns false if the walk is
 * given up. */
static bool walk(const brio_periodic *t, brio_filter *filter, const double *x, brio_place *at) {
    size_t steps = MOST_STEPS + MOST_STEPS_A_TET * t->stats.tetrahedra;
    for (bool moved = true; moved && at->class < t->stats.tetrahedra;) {
        if (!steps--) return false;
        double v[4][3];
        moved = false;
        for (int i = 0; i < 4; i++)
            brio_lattice_move(&t->lattice, t->images.x[t->tet[at->class].vertex[i]], at->shift, v[i]);
        for (int i = 0; i < 4 && !moved; i++) {
            const uint8_t *f = BRIO_FACET[i];
            int32_t way[3];
            if (brio_orient3d_sign(filter, v[f[0]], v[f[1]], v[f[2]], x) >= 0) continue;
            brio_periodic_across(&t->images, t->tet, at->class, i, way);
            for (int k = 0; k < 3; k++) at->shift[k] += way[k];
            at->class = t->tet[at->class].mate[i] >> 2;
            moved = true;
        }
    }
    return true;
}

/* --- all queries --- */

typedef struct {
    const brio_periodic_locator *locator;
    const double *query;
    brio_image *out;
    bool nearest;    /* whether vertices are asked for, not tetrahedra */
    size_t *too_far; /* #threads: a query that is too many cells away, or SIZE_MAX */
    size_t *lost;    /* #threads, behind those: one whose walk was given up */
} query_job;

/* Answers a query. Returns false if a walk was given up. */
static bool answer(const query_job *job, brio_filter *filter, const brio_home *home, brio_image *out) {
    const brio_periodic_locator *l = job->locator;
    const brio_periodic *t = l->t;
    brio_image vertex;
    *out = (brio_image){.point = BRIO_INFINITE};
    if (!l->translates.count) return true;
    if (!job->nearest && (t->stats.tetrahedra == 0 || is_far(&l->translates, home->x))) return true;
    brio_translates_nearest(&l->translates, home->x, &vertex);
    if (!job->nearest) {
        uint32_t corner = l->corner[vertex.point];
        brio_place at = {.class = corner >> 2};
        const brio_image *seen = &t->images.list[t->tet[at.class].vertex[corner & 3]];
        assert(corner != UINT32_MAX && seen->point == vertex.point);
        for (int k = 0; k < 3; k++) at.shift[k] = vertex.shift[k] - seen->shift[k];
        if (!walk(t, filter, home->x, &at)) return false;
        if (at.class >= t->stats.tetrahedra) return true;
        vertex.point = at.class;
        memcpy(vertex.shift, at.shift, sizeof at.shift);
    }
    *out = brio_periodic_show(t, &vertex, job->nearest ? t->home[vertex.point] : NULL, home->shift);
    return true;
}

static void answer_some(void *user, size_t begin, size_t end, int thread) {
    const query_job *job = user;
    brio_filter filter = job->locator->translates.filter;
    for (size_t q = begin; q < end && job->lost[thread] == SIZE_MAX; q++) {
        brio_home home;
        if (!brio_lattice_home(&job->locator->t->lattice, job->query + 3 * q, &home)) {
            if (q < job->too_far[thread]) job->too_far[thread] = q;
        } else if (!answer(job, &filter, &home, &job->out[q])) {
            job->lost[thread] = q;
        }
    }
}

static brio_status answer_all(brio_context *ctx, query_job *job, size_t count) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(ctx, count, QUERIES_A_THREAD);
    size_t worst = SIZE_MAX;
    BRIO_TRY(brio_refuse_not_finite(ctx, job->query, NULL, count, NULL));
    BRIO_TRY(BRIO_ALLOC(ctx, job->too_far, 2 * (size_t)threads));
    job->lost = job->too_far + threads;
    for (int i = 0; i < 2 * threads; i++) job->too_far[i] = SIZE_MAX;
    BRIO_TRY(brio_for_chunks(ctx, threads, count, CHUNK, answer_some, job));
    for (int i = 0; i < threads; i++) {
        BRIO_REQUIRE(ctx, job->lost[i] == SIZE_MAX, BRIO_ERR_INTERNAL, "the walk to place %zu does not end",
                     job->lost[i]);
        if (job->too_far[i] < worst) worst = job->too_far[i];
    }
    BRIO_REQUIRE(ctx, worst == SIZE_MAX, BRIO_ERR_ARGUMENT, "place %zu is more than 2^26 cells away from the points",
                 worst);
done:
    brio_release(ctx, job->too_far);
    return status;
}

brio_status brio_periodic_locator_tetrahedra(brio_context *ctx, const brio_periodic_locator *locator,
                                             const double *queries, size_t num_queries, brio_image *tetrahedra) {
    BRIO_DOOR;
    query_job job = {.locator = locator, .query = queries, .out = tetrahedra};
    return answer_all(ctx, &job, num_queries);
}

brio_status brio_periodic_locator_least_power(brio_context *ctx, const brio_periodic_locator *locator,
                                              const double *queries, size_t num_queries, brio_image *vertices) {
    BRIO_DOOR;
    query_job job = {.locator = locator, .query = queries, .out = vertices, .nearest = true};
    return answer_all(ctx, &job, num_queries);
}
