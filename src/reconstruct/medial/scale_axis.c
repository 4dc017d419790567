/* The scale axis: of balls that are all scaled by s about their centres, those that reach the boundary of the union.
 *
 * The others lie in the union of the scaled balls, and are no medial balls of it. Where only they filled a hollow, the
 * union of those that are left would have a void: the ball that is deepest at a corner of the void's boundary is kept,
 * until there is no more void than in the union of all.
 *
 * Based on: Miklos, Giesen, Pauly. Discrete scale axis representations for 3D geometry. SIGGRAPH 2010.
 *           Giesen, Miklos, Pauly, Wormser. The scale axis transform. SCG 2009.
 * Differs from the papers: medial balls of the scaled union that are no ball of the input are not added, so each ball
 *                          of the result is as empty as it was. */
#include "balls/union_boundary.h"
#include "base/memory.h"
#include "reconstruct/medial/ball_cover.h"
#include <math.h>
#include <string.h>

enum { MOST_ROUNDS = 16 };          /* chosen: each round keeps a ball at each corner of a void that is too many */
static const double TOUCHES = 1e-9; /* chosen: a corner deeper in a ball than by this share of its square is inside */

/* The scaled balls. */
typedef struct {
    brio_context *ctx;
    double *centre, *weight; /* of all */
    uint8_t *kept;
    size_t count;
    uint64_t seed;
} scaled;

static brio_status take_scaled(scaled *s, const brio_balls *balls, double scale) {
    s->count = balls->count;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->centre, 3 * s->count));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->weight, s->count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, s->kept, s->count));
    for (size_t i = 0; i < s->count; i++) {
        memcpy(s->centre + 3 * i, balls->centre + 3 * (size_t)balls->ball[i], 3 * sizeof *s->centre);
        s->weight[i] = balls->square[balls->ball[i]] * scale * scale;
    }
    return BRIO_OK;
}

/* Finds the boundary of the union of the balls that are kept: the others get the weight 0 for it. */
static brio_status find_boundary_of_kept(const scaled *s, brio_union_boundary *b) {
    brio_status status = BRIO_OK;
    double *weight = NULL;
    BRIO_TRY(BRIO_ALLOC(s->ctx, weight, s->count));
    for (size_t i = 0; i < s->count; i++) weight[i] = s->kept[i] ? s->weight[i] : 0;
    BRIO_TRY(brio_union_boundary_find(s->ctx, s->centre, weight, s->count, s->seed, b));
done:
    brio_release(s->ctx, weight);
    return status;
}

/* Keeps the deepest ball at each corner that is inside the union of all. */
static brio_status keep_at_corners(scaled *s, const brio_locator *all, const brio_union_boundary *b, size_t *found) {
    brio_status status = BRIO_OK;
    double *place = NULL;
    uint32_t *ball = NULL;
    *found = 0;
    BRIO_TRY(BRIO_ALLOC(s->ctx, place, 3 * b->num_corners));
    BRIO_TRY(BRIO_ALLOC(s->ctx, ball, b->num_corners));
    for (size_t c = 0; c < b->num_corners; c++)
        for (size_t k = 0; k < 3; k++) place[3 * c + k] = ldexp(b->corner[c].place[k], b->exponent);
    BRIO_TRY(brio_locator_least_power(s->ctx, all, place, b->num_corners, ball));
    for (size_t c = 0; c < b->num_corners; c++) {
        uint32_t i = ball[c];
        double power = -s->weight[i];
        for (size_t k = 0; k < 3; k++) power += pow(place[3 * c + k] - s->centre[3 * (size_t)i + k], 2);
        if (s->kept[i] || power >= -TOUCHES * s->weight[i]) continue;
        s->kept[i] = 1;
        ++*found;
    }
done:
    brio_release(s->ctx, place);
    brio_release(s->ctx, ball);
    return status;
}

/* Keeps balls until the union of those that are kept has no more voids than the union of all. */
static brio_status fill_voids(scaled *s, size_t voids) {
    brio_status status = BRIO_OK;
    brio_delaunay_options o = {.size = sizeof o, .seed = s->seed};
    brio_triangulation *t = NULL;
    brio_locator *all = NULL;
    for (int round = 0; round < MOST_ROUNDS; round++) {
        brio_union_boundary b = {.ctx = s->ctx};
        size_t found = 0;
        status = find_boundary_of_kept(s, &b);
        if (status == BRIO_OK && b.voids > voids && !all) {
            status = brio_delaunay(s->ctx, s->centre, s->weight, s->count, &o, &t);
            if (status == BRIO_OK) status = brio_locator_new(s->ctx, t, s->centre, s->weight, s->count, &all);
        }
        if (status == BRIO_OK && b.voids > voids) status = keep_at_corners(s, all, &b, &found);
        brio_union_boundary_free(&b);
        if (status != BRIO_OK || !found) break;
    }
    brio_locator_free(all);
    brio_triangulation_free(t);
    return status;
}

brio_status brio_scale_axis(brio_context *ctx, const brio_balls *balls, double scale, uint64_t seed, uint8_t *keep) {
    brio_status status = BRIO_OK;
    scaled s = {.ctx = ctx, .seed = seed};
    brio_union_boundary b = {.ctx = ctx};
    if (!balls->count) return BRIO_OK;
    BRIO_TRY(take_scaled(&s, balls, scale));
    BRIO_TRY(brio_union_boundary_find(ctx, s.centre, s.weight, s.count, seed, &b));
    for (size_t p = 0; p < b.num_patches; p++) s.kept[b.of_ball[b.patch[p]]] = 1;
    BRIO_TRY(fill_voids(&s, b.voids));
    for (size_t i = 0; i < s.count; i++)
        if (!s.kept[i]) keep[balls->ball[i]] = 0;
done:
    brio_union_boundary_free(&b);
    brio_release(ctx, s.centre);
    brio_release(ctx, s.weight);
    brio_release(ctx, s.kept);
    return status;
}
