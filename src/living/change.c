/* A living triangulation in space that repeats: the public calls that make and change one.
 *
 * A call checks all it was given, puts its points on the grid and into the domain, and hands these edits on (plan.c).
 *
 * Based on: decisions 018, 019 and 034. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "living/living.h"
#include <string.h>

/* For how much farther than the first points, and than the vectors, the grid is made. A point in the domain is no more
 * than 3 of these away, with vectors of up to 2 off a half of the grid (brio_lattice_reaches). */
static const double ROOM = 8;

void brio_wrapped_forget(brio_dynamic_periodic *d) {
    brio_periodic_locator_free(d->locator);
    brio_periodic_free(d->snapshot);
    brio_release(d->ctx, d->place);
    brio_release(d->ctx, d->index);
    brio_release(d->ctx, d->star_begin);
    brio_release(d->ctx, d->star);
    d->locator = NULL, d->snapshot = NULL, d->place = d->index = d->star = NULL, d->star_begin = NULL;
}

void brio_wrapped_clear(brio_dynamic_periodic *d) {
    brio_dynamic_free(d->inner);
    brio_release(d->ctx, d->point);
    brio_release(d->ctx, d->kept);
}

void brio_dynamic_periodic_free(brio_dynamic_periodic *d) {
    if (!d) return;
    brio_wrapped_forget(d);
    brio_wrapped_clear(d);
    brio_release(d->ctx, d->list);
    brio_release(d->ctx, d);
}

/* --- points --- */

static brio_status check_points(brio_dynamic_periodic *d, const double *points, const double *weights, size_t n) {
    BRIO_EXPECT(d->ctx, d->weighted || !weights, BRIO_ERR_ARGUMENT, "weights for a triangulation without weights");
    BRIO_FORWARD(brio_refuse_many(d->ctx, n));
    BRIO_EXPECT(d->ctx, n < UINT32_MAX / 2, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^31 - 1", n);
    return brio_refuse_not_finite(d->ctx, points, weights, n, NULL);
}

/* Puts point i of a call on the grid and into the domain. */
static brio_status wrap(brio_dynamic_periodic *d, const double *point, size_t i, double *moved, brio_wrapped *out) {
    brio_home h;
    BRIO_EXPECT(d->ctx, brio_lattice_home(&d->lattice, point, &h), BRIO_ERR_ARGUMENT,
                "point %zu is more than 2^26 cells away from the others", i);
    BRIO_EXPECT(d->ctx, brio_lattice_reaches(&d->lattice, h.x), BRIO_ERR_ARGUMENT,
                "point %zu is farther than the grid reaches: make the triangulation with a greater `reach` than %g", i,
                d->reach);
    memcpy(out->x, h.x, sizeof out->x);
    for (int j = 0; j < 3; j++) out->shift[j] = (int32_t)h.shift[j];
    *moved = fmax(*moved, h.moved);
    return BRIO_OK;
}

/* --- edits --- */

static bool is_there(const void *user, uint32_t index) {
    const brio_dynamic_periodic *d = user;
    return d->point[index].first != BRIO_NONE;
}

static brio_status check_indices(brio_dynamic_periodic *d, const uint32_t *indices, size_t n) {
    return brio_live_check_indices(d->ctx, indices, n, d->num_points, is_there, d);
}

brio_status brio_dynamic_periodic_insert(brio_dynamic_periodic *d, const double *points, const double *weights,
                                         size_t num_points, uint32_t *first) {
    BRIO_DOOR;
    brio_edit *edit = NULL;
    double moved = d->moved;
    brio_status status = BRIO_OK;
    size_t begin = d->num_points;
    BRIO_TRY(check_points(d, points, weights, num_points));
    BRIO_TRY(BRIO_ALLOC(d->ctx, edit, num_points + 1));
    for (size_t i = 0; i < num_points; i++) {
        edit[i] = (brio_edit){.index = (uint32_t)(begin + i), .to.weight = weights ? weights[i] + 0.0 : 0};
        BRIO_TRY(wrap(d, points + 3 * i, i, &moved, &edit[i].to));
        BRIO_TRY(brio_look(d->ctx, 1));
    }
    BRIO_TRY(brio_wrapped_apply(d, edit, num_points, begin + num_points, d->alive + num_points));
    d->moved = moved;
    if (first) *first = (uint32_t)begin;
done:
    brio_release(d->ctx, edit);
    return status;
}

brio_status brio_dynamic_periodic_remove(brio_dynamic_periodic *d, const uint32_t *indices, size_t num_indices) {
    BRIO_DOOR;
    brio_edit *edit = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(check_indices(d, indices, num_indices));
    BRIO_TRY(BRIO_ALLOC(d->ctx, edit, num_indices + 1));
    for (size_t i = 0; i < num_indices; i++) edit[i] = (brio_edit){.index = indices[i], .gone = true};
    status = brio_wrapped_apply(d, edit, num_indices, d->num_points, d->alive - num_indices);
done:
    brio_release(d->ctx, edit);
    return status;
}

/* Moves or reweights points.   points, weights  NULL where they stay. */
static brio_status move_points(brio_dynamic_periodic *d, const uint32_t *indices, const double *points,
                               const double *weights, size_t n) {
    brio_edit *edit = NULL;
    double moved = d->moved;
    brio_status status = BRIO_OK;
    if (indices) BRIO_TRY(check_indices(d, indices, n));
    BRIO_REQUIRE(d->ctx, indices || n == d->alive, BRIO_ERR_ARGUMENT, "%zu positions for %zu points", n, d->alive);
    BRIO_REQUIRE(d->ctx, d->weighted || !weights, BRIO_ERR_ARGUMENT, "weights for a triangulation without weights");
    if (points) BRIO_TRY(brio_refuse_not_finite(d->ctx, points, weights, n, NULL));
    BRIO_TRY(BRIO_ALLOC(d->ctx, edit, n + 1));
    for (size_t i = 0, index = 0; i < n; i++, index++) {
        while (!indices && d->point[index].first == BRIO_NONE) index++;
        edit[i] = (brio_edit){.index = indices ? indices[i] : (uint32_t)index};
        edit[i].to = d->point[edit[i].index];
        if (points) BRIO_TRY(wrap(d, points + 3 * i, i, &moved, &edit[i].to));
        if (weights) edit[i].to.weight = weights[i] + 0.0;
        BRIO_REQUIRE(d->ctx, isfinite(edit[i].to.weight), BRIO_ERR_NOT_FINITE, "weight %zu is not finite", i);
        BRIO_TRY(brio_look(d->ctx, 1));
    }
    BRIO_TRY(brio_wrapped_apply(d, edit, n, d->num_points, d->alive));
    d->moved = moved;
done:
    brio_release(d->ctx, edit);
    return status;
}

brio_status brio_dynamic_periodic_move(brio_dynamic_periodic *d, const uint32_t *indices, const double *points,
                                       const double *weights, size_t num_indices) {
    BRIO_DOOR;
    return move_points(d, indices, points, weights, num_indices);
}

brio_status brio_dynamic_periodic_reweight(brio_dynamic_periodic *d, const uint32_t *indices, const double *weights,
                                           size_t num_indices) {
    BRIO_DOOR;
    return move_points(d, indices, NULL, weights, num_indices);
}

/* --- a new one --- */

/* Makes the grid. With open directions it is made for points that will go farther than these, and `reach` alone gives
 * it again. */
static brio_status make_grid(brio_dynamic_periodic *d, const double *points, size_t n,
                             const brio_periodic_options *options) {
    brio_periodic_options o = *options;
    double most = 0;
    o.reach = 0;
    BRIO_FORWARD(brio_lattice_new(d->ctx, &o, points, n, &d->lattice));
    if (d->lattice.rank == 3) return BRIO_OK;
    for (int k = 0; k < 3; k++) most = fmax(most, brio_lattice_size(&d->lattice, k));
    d->reach = o.reach = fmax(options->reach, ROOM * most);
    return brio_lattice_new(d->ctx, &o, points, n, &d->lattice);
}

brio_status brio_dynamic_periodic_new(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                      const brio_periodic_options *options, brio_dynamic_periodic **out) {
    BRIO_DOOR;
    brio_dynamic_periodic *d = NULL;
    brio_periodic_options o = {0};
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(brio_periodic_take(ctx, options, &o));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, d, 1));
    d->ctx = ctx;
    d->weighted = o.weighted || weights;
    d->halo = o.halo > 0 ? o.halo : BRIO_PERIODIC_HALO;
    BRIO_TRY(check_points(d, points, weights, num_points));
    BRIO_TRY(make_grid(d, points, num_points, &o));
    BRIO_TRY(brio_dynamic_periodic_insert(d, points, weights, num_points, NULL));
    *out = d;
    d = NULL;
done:
    brio_dynamic_periodic_free(d);
    return status;
}
