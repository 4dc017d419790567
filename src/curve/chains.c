/* Curves as chains of links, and where they have corners.
 *
 * A corner is where a curve turns by 40 degrees or more at a point while it turns by less than a third of that at the
 * two points beside it; or at a link whose two ends turn the same way by so much together, where the corner lies
 * between two points. Two ends that turn by nearly 180 degrees together, such as those of the short side of a strip,
 * are two corners, since lines that part meet in none. */
#include "base/memory.h"
#include "curve/work.h"
#include <stddef.h>
#include <string.h>

/* SHARP: the least turn of a corner. CALM: the share of it by which the points beside may turn. PARTING: from this turn
 * on the two ends of a link are two corners. Radians. Chosen. */
static const double SHARP = 0.6981317007977318, CALM = 1.0 / 3, PARTING = 2.9670597283903604;

/* --- chains --- */

/* Appends the chain that begins at row p, with the link that is given, if any. */
static brio_status append_chain(const brio_curve_work *w, uint32_t p, uint8_t *seen, brio_curve_chains *c,
                                uint32_t *place) {
    uint32_t from = p, at = w->link[p][0];
    c->begin[c->num_curves] = *place;
    c->row[(*place)++] = p;
    seen[p] = 1;
    while (at != BRIO_NO_ROW && at != p) {
        c->row[(*place)++] = at;
        seen[at] = 1;
        BRIO_FORWARD(brio_look(w->ctx, 1));
        uint32_t next = brio_curve_beyond(w, at, from);
        from = at, at = next;
    }
    c->closed[c->num_curves++] = at == p;
    return BRIO_OK;
}

/* Returns the first end of the chain of p, or p if it is closed. */
static uint32_t beginning_of(const brio_curve_work *w, uint32_t p) {
    uint32_t end[2];
    for (int side = 0; side < 2; side++) {
        uint32_t from = p, at = w->link[p][side];
        end[side] = p;
        while (at != BRIO_NO_ROW && at != p) {
            uint32_t next = brio_curve_beyond(w, at, from);
            from = at, end[side] = at, at = next;
        }
        if (at == p) return p;
    }
    return end[0] < end[1] ? end[0] : end[1];
}

static brio_status list_chains(const brio_curve_work *w, brio_curve_chains *c) {
    brio_status status = BRIO_OK;
    uint8_t *seen = NULL;
    uint32_t place = 0;
    size_t linked = 0, curves = 0;
    for (uint32_t p = 0; p < w->num_rows; p++) linked += w->link[p][0] != BRIO_NO_ROW;
    curves = linked / 2 + 1;
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, seen, w->num_rows));
    BRIO_TRY(BRIO_ALLOC(w->ctx, c->row, linked));
    BRIO_TRY(BRIO_ALLOC(w->ctx, c->begin, curves));
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, c->closed, curves));
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, c->corner, linked));
    for (uint32_t p = 0; p < w->num_rows; p++) {
        if (seen[p] || w->link[p][0] == BRIO_NO_ROW) continue;
        BRIO_TRY(append_chain(w, beginning_of(w, p), seen, c, &place));
    }
    c->begin[c->num_curves] = place;
done:
    brio_release(w->ctx, seen);
    return status;
}

/* --- corners --- */

/* A curve, by places from 0 to count - 1. */
typedef struct {
    const brio_curve_work *w;
    const uint32_t *row;
    size_t count;
    bool closed;
} walk;

/* Returns the turn at a place, positive to the left; 0 at ends and beyond. */
static double turn_at(const walk *c, ptrdiff_t i) {
    ptrdiff_t n = (ptrdiff_t)c->count;
    int left;
    if (c->closed)
        i = (i + n) % n;
    else if (i <= 0 || i + 1 >= n)
        return 0;
    double turn = brio_curve_turn(c->w, c->row[(i + n - 1) % n], c->row[i], c->row[(i + 1) % n], &left);
    return left * turn;
}

/* Returns whether the turn beside a corner is small, or goes the other way, as at a step. */
static bool is_calm(double beside, double turn) {
    return beside * turn <= 0 || fabs(beside) < CALM * fabs(turn);
}

/* Marks the corner at a place, or of the place and the next one, if there is one; returns how many corners there are.
 * t  the turns from the place before to the second one behind. */
static size_t mark_corner(const walk *c, size_t i, const double t[4], uint8_t *corner) {
    if (fabs(t[1]) >= SHARP && is_calm(t[0], t[1]) && is_calm(t[2], t[1])) return corner[i] = 1;
    double sum = t[1] + t[2];
    bool both = t[1] * t[2] > 0 && fabs(sum) >= SHARP && is_calm(t[0], sum) && is_calm(t[3], sum);
    if (!both || is_calm(t[1], t[2]) || is_calm(t[2], t[1])) return 0;
    corner[i] = corner[i + 1 < c->count ? i + 1 : 0] = 1;
    return fabs(sum) < PARTING ? 1 : 2;
}

static brio_status find_corners(const walk *c, uint8_t *corner, size_t *num_corners) {
    double t[4] = {0, turn_at(c, -1), turn_at(c, 0), turn_at(c, 1)};
    for (size_t i = 0; i < c->count; i++) {
        memmove(t, t + 1, 3 * sizeof *t);
        t[3] = turn_at(c, (ptrdiff_t)i + 2);
        *num_corners += mark_corner(c, i, t, corner);
        BRIO_FORWARD(brio_look(c->w->ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_curve_trace(const brio_curve_work *w, brio_curve_chains *out) {
    brio_status status = BRIO_OK;
    *out = (brio_curve_chains){0};
    BRIO_TRY(list_chains(w, out));
    for (size_t i = 0; i < out->num_curves; i++) {
        walk c = {w, out->row + out->begin[i], out->begin[i + 1] - out->begin[i], out->closed[i]};
        BRIO_TRY(find_corners(&c, out->corner + out->begin[i], &out->num_corners));
    }
done:
    if (status != BRIO_OK) brio_curve_chains_free(w->ctx, out);
    return status;
}

void brio_curve_chains_free(brio_context *ctx, brio_curve_chains *chains) {
    brio_release(ctx, chains->row);
    brio_release(ctx, chains->begin);
    brio_release(ctx, chains->closed);
    brio_release(ctx, chains->corner);
    *chains = (brio_curve_chains){0};
}
