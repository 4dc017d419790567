/* Interpolation of values at the vertices of a triangulation of the plane, at many places. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "base/weighted_mean.h"
#include "plane/plane_natural.h"
#include <math.h>

typedef struct {
    const brio_interpolation *o;
    const brio_locator2 *l;
    double *results;
    brio_plane_natural *natural; /* of each thread */
} interpolation_job;

/* Writes the mean of the values at some points to a row of the results. */
static void write_mean(const brio_interpolation *o, const uint32_t *point, const double *share, size_t count,
                       double *row) {
    brio_weighted_means(&(brio_weighted_mean){o->values, o->components, point, NULL, share, count}, row);
}

static void write_linear(const interpolation_job *job, const brio_plane_holder *h, const double *x, double *row) {
    double share[3];
    brio_plane_barycentric(job->l, h, x, share);
    write_mean(job->o, job->l->triangle[h->triangle].vertex, share, 3, row);
}

/* --- on a line --- */

/* Returns the place of the projection of x along the line, in units of its length, from the first vertex on. */
static double along_line(const brio_locator2 *l, const double *x) {
    const double *a = l->record[l->line[0]], *b = l->record[l->line[l->num_line - 1]];
    double most = fmax(fabs(b[0] / 2 - a[0] / 2), fabs(b[1] / 2 - a[1] / 2));
    double u = (b[0] / 2 - a[0] / 2) / most, v = (b[1] / 2 - a[1] / 2) / most;
    return ((x[0] / 2 - a[0] / 2) / most * u + (x[1] / 2 - a[1] / 2) / most * v) / (u * u + v * v);
}

/* Writes the mean of the two vertices that the projection of x is between. */
static void write_on_line(const interpolation_job *job, const double *x, double *row) {
    const brio_locator2 *l = job->l;
    double place = along_line(l, x), share[2];
    size_t low = 0, high = l->num_line - 1;
    if (!(place >= 0 && place <= along_line(l, l->record[l->line[high]]))) {
        for (size_t c = 0; c < job->o->components; c++) row[c] = NAN;
        return;
    }
    while (low + 1 < high) {
        size_t middle = low + (high - low) / 2;
        if (along_line(l, l->record[l->line[middle]]) <= place)
            low = middle;
        else
            high = middle;
    }
    double begin = along_line(l, l->record[l->line[low]]), end = along_line(l, l->record[l->line[high]]);
    share[1] = end > begin ? (place - begin) / (end - begin) : 0;
    share[1] = share[1] > 0 ? share[1] < 1 ? share[1] : 1 : 0;
    share[0] = 1 - share[1];
    write_mean(job->o, l->line + low, share, 2, row);
}

/* --- in triangles --- */

static brio_status answer_values(void *user, brio_plane_querent *q, size_t index, const double *x) {
    const interpolation_job *job = user;
    const brio_interpolation *o = job->o;
    brio_plane_natural *n = &job->natural[q->thread];
    double *row = job->results + o->components * index;
    bool natural = false;
    if (job->l->num_line) {
        write_on_line(job, x, row);
        return BRIO_OK;
    }
    brio_plane_holder h = brio_plane_find_holder(q, x);
    for (size_t c = 0; c < o->components && h.triangle == BRIO_INFINITE; c++) row[c] = NAN;
    if (h.triangle == BRIO_INFINITE) return BRIO_OK;
    if (o->method == BRIO_INTERPOLATION_NATURAL && __builtin_popcount(h.zeros) < 2 &&
        !brio_plane_holder_on_hull(job->l, &h)) {
        brio_status status = brio_plane_natural_coordinates(n, q, &h, x, &natural);
        if (status != BRIO_OK) return status;
    }
    if (natural)
        write_mean(o, n->point, n->share, n->num_points, row);
    else
        write_linear(job, &h, x, row);
    return BRIO_OK;
}

static brio_status check_options(brio_context *ctx, const brio_locator2 *l, const brio_interpolation *o) {
    BRIO_EXPECT(ctx, o->method >= 0 && o->method < BRIO_INTERPOLATION_END, BRIO_ERR_ARGUMENT,
                "there is no interpolation method %d", (int)o->method);
    BRIO_EXPECT(ctx, o->components > 0, BRIO_ERR_ARGUMENT, "0 components of each value; at least 1");
    BRIO_EXPECT(ctx, o->values || !l->num_points, BRIO_ERR_ARGUMENT, "there are no values to interpolate");
    BRIO_EXPECT(ctx, o->method != BRIO_INTERPOLATION_NATURAL || !l->weighted, BRIO_ERR_ARGUMENT,
                "natural neighbour interpolation is for triangulations without weights");
    BRIO_EXPECT(ctx, l->num_line != 1, BRIO_ERR_NO_ANSWER,
                "all points are at one position: there is nothing to interpolate between");
    return BRIO_OK;
}

brio_status brio_locator2_interpolate(brio_context *ctx, const brio_locator2 *l, const double *queries,
                                      size_t num_queries, const brio_interpolation *options, double *results) {
    BRIO_DOOR;
    brio_interpolation o = {0};
    brio_status status = BRIO_OK;
    int threads = brio_plane_query_threads(ctx, num_queries);
    interpolation_job job = {&o, l, results, NULL};
    BRIO_TRY(BRIO_TAKE(ctx, brio_interpolation, options, &o));
    if (!o.components) o.components = 1;
    BRIO_TRY(check_options(ctx, l, &o));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, job.natural, (size_t)threads));
    for (int i = 0; i < threads; i++) job.natural[i].ctx = ctx;
    BRIO_TRY(brio_plane_answer_all(ctx, threads,
                                   &(brio_plane_batch){l, queries, num_queries, "interpolate", answer_values, &job}));
done:
    for (int i = 0; job.natural && i < threads; i++) brio_plane_natural_free(&job.natural[i]);
    brio_release(ctx, job.natural);
    return status;
}
