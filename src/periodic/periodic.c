/* Periodic Delaunay and regular triangulations: the call, and what its result shows.
 *
 * The lattice is reduced and put on a grid with the points (lattice.c); the stars of the points are found (stars.c);
 * one tetrahedron of each class stays (fold.c).
 *
 * Based on: decision 018. */
#include "periodic/periodic.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/versioned.h"
#include "periodic/translates.h"
#include <math.h>
#include <string.h>

enum { POINTS_A_THREAD = 1 << 14 };

void brio_periodic_free(brio_periodic *t) {
    if (!t) return;
    brio_context *ctx = t->ctx;
    brio_images_free(&t->images);
    brio_release(ctx, t->shown);
    brio_release(ctx, t->position);
    brio_release(ctx, t->representative);
    brio_release(ctx, t->home);
    brio_release(ctx, t->tet);
    brio_release(ctx, t->border);
    brio_release(ctx, t);
}

/* --- points --- */

/* What one thread found of the points that it put into the domain. */
typedef struct {
    bool stays;
    double moved;
    size_t far; /* the first point that is too far away */
} arrival;

typedef struct {
    brio_periodic *t;
    const double *points;
    double (*home)[3];
    arrival *of; /* each thread */
} homing;

static void bring_some(void *user, size_t from, size_t to, int thread) {
    const homing *h = user;
    arrival *a = &h->of[thread];
    for (size_t p = from; p < to; p++) {
        brio_home at = {0};
        if (!brio_lattice_home(&h->t->lattice, h->points + 3 * p, &at) && p < a->far) a->far = p;
        memcpy(h->home[p], at.x, sizeof at.x);
        for (int j = 0; j < 3; j++) h->t->home[p][j] = (int32_t)at.shift[j];
        a->stays &= !at.shift[0] && !at.shift[1] && !at.shift[2];
        a->moved = fmax(a->moved, at.moved);
    }
}

/* Puts the points into the domain. */
static brio_status bring_home(brio_periodic *t, const double *points, size_t n, double (**out)[3]) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(t->ctx, n, POINTS_A_THREAD);
    homing h = {.t = t, .points = points};
    BRIO_TRY(BRIO_ALLOC(t->ctx, h.home, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, t->home, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, h.of, (size_t)threads));
    for (int i = 0; i < threads; i++) h.of[i] = (arrival){.stays = true, .far = SIZE_MAX};
    BRIO_TRY(brio_for(t->ctx, threads, n, bring_some, &h));
    t->stays = true;
    for (int i = 0; i < threads; i++) {
        BRIO_REQUIRE(t->ctx, h.of[i].far == SIZE_MAX, BRIO_ERR_ARGUMENT,
                     "point %zu is more than 2^26 cells away from the others", h.of[i].far);
        t->stays &= h.of[i].stays;
        t->stats.moved = fmax(t->stats.moved, h.of[i].moved);
    }
    *out = h.home;
    h.home = NULL;
done:
    brio_release(t->ctx, h.home);
    brio_release(t->ctx, h.of);
    return status;
}

/* --- images --- */

/* Drops the images that no tetrahedron has. */
static brio_status drop_images(brio_periodic *t) {
    brio_images *m = &t->images;
    uint32_t *name = NULL; /* of each image behind the points */
    size_t count = m->num_points, n = m->num_points;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(t->ctx, name, m->count - n + 1));
    for (size_t i = 0; i < t->num_border; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = t->tet[t->border[i]].vertex[k];
            if (v >= n && v != BRIO_INFINITE) name[v - n] = 1;
        }
    for (size_t i = n; i < m->count; i++) {
        if (!name[i - n]) continue;
        size_t at = count++;
        name[i - n] = (uint32_t)at;
        m->list[at] = m->list[i];
        memcpy(m->x[at], m->x[i], sizeof *m->x);
        if (m->weight) m->weight[at] = m->weight[i];
    }
    for (size_t i = 0; i < t->num_border; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t *v = &t->tet[t->border[i]].vertex[k];
            if (*v >= n && *v != BRIO_INFINITE) *v = name[*v - n];
        }
    m->count = count;
    brio_release(t->ctx, m->slot);
    m->slot = NULL;
    m->num_slots = m->num_entered = 0;
    brio_release(t->ctx, name);
    return BRIO_OK;
}

brio_image brio_periodic_show(const brio_periodic *t, const brio_image *image, const int32_t *home,
                              const int64_t *from) {
    const brio_lattice *l = &t->lattice;
    brio_image out = {.point = image->point};
    for (int j = 0; j < l->rank; j++) {
        int64_t shift = (home ? home[j] : 0) - from[j];
        for (int i = 0; i < l->rank; i++) shift += image->shift[i] * l->change[i][j];
        out.shift[l->axis[j]] = (int32_t)shift;
    }
    return out;
}

/* Returns an image as the caller sees it: relative to the points and the vectors that were given. */
static brio_image show(const brio_periodic *t, const brio_image *image, const int32_t *from) {
    const int64_t wide[3] = {from[0], from[1], from[2]};
    return brio_periodic_show(t, image, t->home[image->point], wide);
}

static void show_some(void *user, size_t from, size_t to, int thread) {
    static const int32_t none[3] = {0, 0, 0};
    brio_periodic *t = user;
    const brio_images *m = &t->images;
    (void)thread;
    for (size_t i = from; i < to; i++) {
        t->shown[i] = show(t, &m->list[i], none);
        for (int k = 0; k < 3; k++) t->position[i][k] = brio_lattice_shown(&t->lattice, m->x[i][k], k);
    }
}

static brio_status show_images(brio_periodic *t) {
    size_t n = t->stats.images = t->images.count;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->shown, n + 1));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->position, n + 1));
    return brio_for(t->ctx, brio_threads(t->ctx, n, POINTS_A_THREAD), n, show_some, t);
}

/* --- representatives --- */

static int compare_positions(uint32_t a, uint32_t b, const void *user) {
    const brio_images *m = user;
    int sign = brio_images_compare(m, a, b);
    if (sign) return sign;
    if (m->weight && m->weight[a] != m->weight[b]) return m->weight[a] > m->weight[b] ? -1 : 1;
    return a < b ? -1 : a > b;
}

/* Finds the vertices of least power distance of points that are hidden, and counts these by their positions. */
static brio_status represent_hidden(brio_periodic *t, const uint8_t *is_vertex, uint32_t *hidden, size_t count) {
    const brio_images *m = &t->images;
    brio_status status = BRIO_OK;
    brio_translates translates = {0};
    uint8_t *left_out = NULL;
    BRIO_TRY(BRIO_ALLOC(t->ctx, left_out, m->num_points + 1));
    for (size_t p = 0; p < m->num_points; p++) left_out[p] = !is_vertex[p];
    BRIO_TRY(brio_translates_new(t->ctx, m, left_out, &translates));
    BRIO_TRY(brio_sort_rows(t->ctx, &(brio_row_order){m->x[0], 3, compare_positions, m}, hidden, count));
    for (size_t n = 0; n < count; n++) {
        brio_image nearest;
        brio_translates_nearest(&translates, m->x[hidden[n]], &nearest);
        t->representative[hidden[n]] = show(t, &nearest, t->home[hidden[n]]);
        if (n > 0 && brio_images_compare(m, hidden[n - 1], hidden[n]) == 0)
            t->stats.duplicates++;
        else
            t->stats.hidden++;
        BRIO_TRY(brio_look(t->ctx, 16));
    }
done:
    brio_translates_free(&translates);
    brio_release(t->ctx, left_out);
    return status;
}

static brio_status represent(brio_periodic *t, const brio_stars *s) {
    const brio_images *m = &s->images;
    const uint32_t *known = brio_triangulation_representatives(s->t);
    brio_status status = BRIO_OK;
    uint32_t *hidden = NULL;
    size_t n = m->num_points, count = 0;
    BRIO_TRY(BRIO_ALLOC(t->ctx, t->representative, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, hidden, n + 1));
    for (uint32_t p = 0; p < n; p++) {
        uint32_t v = known[p];
        t->stats.vertices += s->is_vertex[p];
        t->representative[p] = (brio_image){.point = p};
        if (s->is_vertex[p]) continue;
        if (v < n && s->is_vertex[v] && brio_images_compare(m, p, v) == 0) {
            brio_image image = {.point = v};
            t->representative[p] = show(t, &image, t->home[p]);
            t->stats.duplicates++;
        } else {
            hidden[count++] = p;
        }
    }
    if (count) BRIO_TRY(represent_hidden(t, s->is_vertex, hidden, count));
done:
    brio_release(t->ctx, hidden);
    return status;
}

/* --- the call --- */

static void describe(brio_periodic *t, const brio_stars *s) {
    const brio_lattice *l = &t->lattice;
    t->stats.size = sizeof t->stats;
    t->stats.points = s->images.num_points;
    t->stats.directions = l->rank;
    t->stats.dimension = brio_triangulation_stats(s->t)->dimension;
    for (int j = 0; j < l->rank; j++) memcpy(t->stats.cell + 3 * l->axis[j], l->used[j], sizeof l->used[j]);
    t->stats.cell_volume = l->volume;
    t->stats.cell_moved = l->moved;
    t->stats.triangulated = s->triangulated;
    t->stats.completed = s->num_redone;
    t->stats.rounds = s->rounds;
}

brio_status brio_periodic_make(brio_periodic *t, const brio_stars_task *task) {
    brio_context *ctx = t->ctx;
    brio_status status = BRIO_OK;
    brio_stars stars = {0};
    brio_folded folded = {0};
    BRIO_TRY(brio_stars_new(ctx, task, &stars));
    describe(t, &stars);
    BRIO_TRY(brio_periodic_fold(ctx, &stars, &folded));
    t->tet = folded.tet;
    t->stats.tetrahedra = folded.num_finite;
    t->stats.hull_facets = folded.num_infinite;
    t->border = folded.border;
    t->num_border = folded.num_border;
    t->images = stars.images;
    BRIO_TRY(represent(t, &stars));
    stars.images = (brio_images){.ctx = ctx};
    BRIO_TRY(drop_images(t));
    BRIO_TRY(show_images(t));
done:
    if (stars.images.list == t->images.list) stars.images = (brio_images){.ctx = ctx};
    brio_stars_free(&stars);
    return status;
}

static brio_stars_task task_of(const brio_periodic *t, const double (*home)[3], const double *weights, size_t n,
                               const brio_periodic_options *o) {
    return (brio_stars_task){.lattice = &t->lattice,
                             .home = home,
                             .weights = weights,
                             .num_points = n,
                             .halo = o->halo > 0 ? o->halo : BRIO_PERIODIC_HALO,
                             .seed = o->seed ? o->seed : BRIO_SEED};
}

static brio_status build(brio_periodic *t, const double *points, const double *weights, size_t n,
                         const brio_periodic_options *o) {
    brio_status status = BRIO_OK;
    double(*home)[3] = NULL;
    BRIO_TRY(bring_home(t, points, n, &home));
    brio_stars_task task = task_of(t, (const double(*)[3])home, weights, n, o);
    status = brio_periodic_make(t, &task);
done:
    brio_release(t->ctx, home);
    return status;
}

brio_status brio_periodic_take(brio_context *ctx, const brio_periodic_options *options, brio_periodic_options *o) {
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_periodic_options, options, o));
    BRIO_EXPECT(ctx, o->cell, BRIO_ERR_ARGUMENT, "the options have no cell");
    BRIO_EXPECT(ctx, !o->reserved_int, BRIO_ERR_ARGUMENT, "brio_periodic_options.reserved_int is not 0");
    BRIO_EXPECT(ctx, o->halo >= 0, BRIO_ERR_ARGUMENT, "a halo of %g spacings", o->halo);
    BRIO_EXPECT(ctx, o->reach >= 0 && o->reach < INFINITY, BRIO_ERR_ARGUMENT, "a reach of %g", o->reach);
    BRIO_EXPECT(ctx, !o->reserved_more, BRIO_ERR_ARGUMENT, "brio_periodic_options.reserved_more is not 0");
    return BRIO_OK;
}

/* Takes the options, and makes what a triangulation begins with: its lattice. */
static brio_status begin(brio_context *ctx, const double *points, size_t n, const brio_periodic_options *options,
                         brio_periodic_options *o, brio_periodic **out) {
    BRIO_FORWARD(brio_periodic_take(ctx, options, o));
    BRIO_FORWARD(brio_refuse_many(ctx, n));
    BRIO_EXPECT(ctx, n < UINT32_MAX / 2, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^31 - 1", n);
    BRIO_FORWARD(brio_refuse_not_finite(ctx, points, NULL, n, NULL));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, *out, 1));
    (*out)->ctx = ctx;
    return brio_lattice_new(ctx, o, points, n, &(*out)->lattice);
}

brio_status brio_delaunay_periodic(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_periodic_options *options, brio_periodic **out) {
    BRIO_DOOR;
    brio_periodic_options o = {0};
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    double start = brio_seconds();
    *out = NULL;
    brio_keep_begin(ctx);
    BRIO_TRY(begin(ctx, points, num_points, options, &o, &t));
    if (weights) BRIO_TRY(brio_refuse_not_finite(ctx, points, weights, num_points, NULL));
    BRIO_TRY(build(t, points, weights, num_points, &o));
    t->images.lattice = &t->lattice;
    t->stats.seconds = brio_seconds() - start;
    *out = t;
    t = NULL;
done:
    brio_periodic_free(t);
    brio_keep_end(ctx);
    return status;
}

brio_status brio_periodic_count(brio_context *ctx, const double *points, size_t num_points,
                                const brio_periodic_options *options, bool flat, double *count) {
    brio_periodic_options o = {0};
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    double(*home)[3] = NULL;
    BRIO_TRY(begin(ctx, points, num_points, options, &o, &t));
    BRIO_TRY(bring_home(t, points, num_points, &home));
    brio_stars_task task = task_of(t, (const double(*)[3])home, NULL, num_points, &o);
    if (flat) task.halo = INFINITY;
    *count = brio_stars_count(&task);
done:
    brio_release(ctx, home);
    brio_periodic_free(t);
    return status;
}

brio_status brio_periodic_try(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                              const brio_periodic_options *options, brio_periodic_trial *trial) {
    brio_periodic_options o = {0};
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    brio_stars stars = {0};
    double(*home)[3] = NULL;
    BRIO_TRY(begin(ctx, points, num_points, options, &o, &t));
    BRIO_TRY(bring_home(t, points, num_points, &home));
    brio_stars_task task = task_of(t, (const double(*)[3])home, weights, num_points, &o);
    task.max_tetrahedra = trial->max_tetrahedra;
    BRIO_TRY(brio_stars_new(ctx, &task, &stars));
    trial->most_completed = stars.most_completed;
    trial->flat = brio_triangulation_stats(stars.t)->dimension < 3;
done:
    brio_stars_free(&stars);
    brio_release(ctx, home);
    brio_periodic_free(t);
    return status;
}

const brio_periodic_stats *brio_periodic_facts(const brio_periodic *t) {
    return &t->stats;
}
const brio_image *brio_periodic_images(const brio_periodic *t) {
    return t->shown;
}
const double *brio_periodic_positions(const brio_periodic *t) {
    return (const double *)t->position;
}
const brio_tetrahedron *brio_periodic_tetrahedra(const brio_periodic *t) {
    return t->tet;
}
const brio_image *brio_periodic_representatives(const brio_periodic *t) {
    return t->representative;
}
