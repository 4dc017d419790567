/* Interpolation of values at the vertices, at many places. */
#include "base/float_state.h"
#include "base/versioned.h"
#include "base/weighted_mean.h"
#include "locate/natural.h"

typedef struct {
    const brio_interpolation *o;
    const brio_locator *l;
    double *results;
    brio_natural *natural; /* of each thread */
} interpolation_job;

/* Writes the mean of the values at some places to a row of the results. */
static void write_mean(const interpolation_job *job, const uint32_t *place, const double *share, size_t count,
                       double *row) {
    const brio_weighted_mean m = {job->o->values, job->o->components, place, job->l->name, share, count};
    brio_weighted_means(&m, row);
}

static void write_linear(const interpolation_job *job, const brio_holder *h, const double *x, double *row) {
    double share[4];
    brio_barycentric(job->l, h, x, share);
    write_mean(job, job->l->t.tet[h->tet].vertex, share, 4, row);
}

/* Writes the values of a query to a row of the results. */
static brio_status find_values(const interpolation_job *job, brio_querent *q, const brio_holder *h, const double *x,
                               double *row) {
    brio_natural *n = &job->natural[q->thread];
    bool natural = false;
    for (size_t c = 0; c < job->o->components && h->tet == BRIO_INFINITE; c++) row[c] = NAN;
    if (h->tet == BRIO_INFINITE) return BRIO_OK;
    if (job->o->method == BRIO_INTERPOLATION_NATURAL && __builtin_popcount(h->zeros) < 3 &&
        !brio_holder_on_hull(job->l, h)) {
        brio_status status = brio_natural_coordinates(n, q, h, x, &natural);
        if (status != BRIO_OK) return status;
    }
    if (natural)
        write_mean(job, n->place + 1, n->share + 1, n->num_vertices - 1, row);
    else
        write_linear(job, h, x, row);
    return BRIO_OK;
}

static brio_status answer_values(void *user, brio_querent *q, const brio_query_row *row) {
    const interpolation_job *job = user;
    brio_holder holders[BRIO_ABREAST];
    brio_status status = BRIO_OK;
    brio_find_lowest_holders(q, row, holders); /* rounding depends on the tetrahedron */
    for (size_t c = 0; c < row->count && status == BRIO_OK; c++)
        status = find_values(job, q, &holders[c], row->x[c], job->results + job->o->components * row->index[c]);
    return status;
}

static brio_status check_options(brio_context *ctx, const brio_locator *l, const brio_interpolation *o) {
    BRIO_EXPECT(ctx, o->method >= 0 && o->method < BRIO_INTERPOLATION_END, BRIO_ERR_ARGUMENT,
                "there is no interpolation method %d", (int)o->method);
    BRIO_EXPECT(ctx, o->components > 0, BRIO_ERR_ARGUMENT, "0 components of each value; at least 1");
    BRIO_EXPECT(ctx, o->values || !l->num_points, BRIO_ERR_ARGUMENT, "there are no values to interpolate");
    BRIO_EXPECT(ctx, o->method != BRIO_INTERPOLATION_NATURAL || !l->weighted, BRIO_ERR_ARGUMENT,
                "natural neighbour interpolation is for triangulations without weights");
    return BRIO_OK;
}

/* Interpolates in the plane of the points, at the projections of the queries. */
static brio_status interpolate_flat(brio_context *ctx, const brio_locator *l, const double *queries, size_t num_queries,
                                    const brio_interpolation *o, double *results) {
    brio_status status = BRIO_OK;
    double *places = NULL;
    BRIO_TRY(brio_refuse_queries(ctx, queries, num_queries));
    BRIO_TRY(BRIO_ALLOC(ctx, places, 2 * num_queries));
    brio_plane_project(&l->frame, queries, num_queries, places);
    BRIO_TRY(brio_locator2_interpolate(ctx, l->flat, places, num_queries, o, results));
done:
    brio_release(ctx, places);
    return status;
}

brio_status brio_locator_interpolate(brio_context *ctx, const brio_locator *l, const double *queries,
                                     size_t num_queries, const brio_interpolation *options, double *results) {
    BRIO_DOOR;
    brio_interpolation o = {0};
    brio_status status = BRIO_OK;
    int threads = brio_query_threads(ctx, num_queries);
    interpolation_job job = {.o = &o, .l = l, .results = results};
    BRIO_TRY(BRIO_TAKE(ctx, brio_interpolation, options, &o));
    if (!o.components) o.components = 1;
    BRIO_TRY(check_options(ctx, l, &o));
    if (l->flat) return interpolate_flat(ctx, l, queries, num_queries, &o, results);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, job.natural, (size_t)threads));
    for (int i = 0; i < threads; i++) job.natural[i].ctx = ctx;
    BRIO_TRY(brio_answer_all(ctx, threads,
                             &(brio_query_batch){l, queries, num_queries, "interpolate", answer_values, &job}));
done:
    for (int i = 0; job.natural && i < threads; i++) brio_natural_free(&job.natural[i]);
    brio_release(ctx, job.natural);
    return status;
}
