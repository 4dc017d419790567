/* Where curves end: links that are long for their surroundings span gaps, and are taken out.
 *
 * A link is held against the links near it, up to eight along the curve on either side. It spans a gap if it is longer
 * than the longest of them times a limit. The limit is 2.25 where they are all alike, so that one missing point makes
 * no gap. It rises with their spread, since points at random leave wide gaps now and then. It falls by two fifths where
 * the curve turns back over the link, as between the ends of two parallel lines: a corner without a sample is bridged
 * by a link shorter than its neighbours. A link with no other one near it spans no gap.
 *
 * After gaps were taken out, links near them are held against what is left, and points that became free wish again.
 *
 * Based on: Zeng, Nguyen, Yan, Li. A distance-based parameter-free algorithm for curve reconstruction. CAD 2008: a link
 * is held against the mean and the spread of those beside it.
 * Differs from the paper: more links than the two beside it, and the longest of them, so that an even and an uneven
 * curve are both closed. */
#include "base/memory.h"
#include "curve/work.h"

/* NEAR: links along the curve on either side. Chosen: of a thousand points at random on a circle, 0.1 gaps are expected
 * to be found. */
enum { NEAR = 8 };

/* The limit of even links, and what a link with right angles at both ends loses of it. Chosen. */
static const double EVEN_LIMIT = 2.25, TURN_LOSS = 0.4;

/* How much of the limit is added for links whose standard deviation is their mean. Chosen with NEAR. */
static const double SPREAD = 1.5;

typedef struct {
    size_t count;
    double largest, sum, squares;
} lengths;

/* Adds the links from p on, away from q, and not beyond the link of p and q where the curve is closed. */
static void add_links(const brio_curve_work *w, uint32_t p, uint32_t q, lengths *near) {
    uint32_t from = q, at = p;
    for (int i = 0; i < NEAR; i++) {
        uint32_t next = brio_curve_beyond(w, at, from);
        if (next == BRIO_NO_ROW || next == q) return;
        double length = brio_curve_length(w, at, next);
        near->count++;
        near->largest = fmax(near->largest, length);
        near->sum += length;
        near->squares += length * length;
        from = at, at = next;
    }
}

/* Returns the turn at p of the walk that goes on from the link of p and q; 0 at an end. */
static double turn_at(const brio_curve_work *w, uint32_t p, uint32_t q) {
    uint32_t beyond = brio_curve_beyond(w, p, q);
    return beyond == BRIO_NO_ROW ? 0 : brio_curve_turn(w, beyond, p, q, NULL);
}

static double limit_of(const brio_curve_work *w, uint32_t p, uint32_t q, const lengths *near) {
    double mean = near->sum / (double)near->count;
    double variance = fmax(0, near->squares / (double)near->count - mean * mean);
    double turn = fmin(1, fmin(turn_at(w, p, q), turn_at(w, q, p)) / acos(0));
    return EVEN_LIMIT * (1 + SPREAD * sqrt(variance) / mean) * (1 - TURN_LOSS * turn);
}

/* Returns the length of the link beyond p, as seen from q; 0 at an end. */
static double length_beyond(const brio_curve_work *w, uint32_t p, uint32_t q) {
    uint32_t beyond = brio_curve_beyond(w, p, q);
    return beyond == BRIO_NO_ROW ? 0 : brio_curve_length(w, p, beyond);
}

static bool spans_gap(const brio_curve_work *w, uint32_t p, uint32_t q, double open) {
    double length = brio_curve_length(w, p, q), least = open > 0 ? open : EVEN_LIMIT * (1 - TURN_LOSS);
    lengths near = {0};
    if (length <= least * length_beyond(w, p, q) || length <= least * length_beyond(w, q, p)) return false;
    add_links(w, p, q, &near);
    add_links(w, q, p, &near);
    if (!near.count) return false;
    return length > near.largest * (open > 0 ? open : limit_of(w, p, q, &near));
}

static void mark_gap(brio_curve_work *w, uint32_t p, uint32_t q) {
    for (uint32_t k = w->start[p]; k < w->start[p + 1]; k++)
        if (w->neighbour[k] == q) w->gap[k] = 1;
}

static void unlink_row(brio_curve_work *w, uint32_t p, uint32_t q) {
    if (w->link[p][0] == q) w->link[p][0] = w->link[p][1];
    w->link[p][1] = BRIO_NO_ROW;
}

/* The links that are to be looked at, and what is done with the gaps among them. */
typedef struct {
    brio_curve_work *w;
    double open;
    uint32_t *row;  /* of the links to be looked at; each once */
    uint8_t *dirty; /* of each row: it is among them */
    size_t count;
    uint32_t *end; /* of gaps, in pairs */
    size_t num_ends;
    uint32_t *free; /* rows that are to wish again */
} search;

static void add_row(search *s, uint32_t p) {
    if (!s->dirty[p]) s->dirty[p] = 1, s->row[s->count++] = p;
}

/* Adds p and the rows along its curve whose links may be held against another length now. */
static void add_reach(search *s, uint32_t p) {
    add_row(s, p);
    for (int side = 0; side < 2; side++) {
        uint32_t from = p, at = s->w->link[p][side];
        for (int i = 0; i < NEAR && at != BRIO_NO_ROW && at != p; i++) {
            add_row(s, at);
            uint32_t next = brio_curve_beyond(s->w, at, from);
            from = at, at = next;
        }
    }
}

/* Marks the gaps among the links of the rows, and lists their ends. */
static brio_status mark_gaps(search *s) {
    s->num_ends = 0;
    for (size_t i = 0; i < s->count; i++) {
        uint32_t p = s->row[i];
        for (int k = 0; k < 2; k++) {
            uint32_t q = s->w->link[p][k];
            if (q == BRIO_NO_ROW || (s->dirty[q] && q < p) || !spans_gap(s->w, p, q, s->open)) continue;
            mark_gap(s->w, p, q);
            mark_gap(s->w, q, p);
            s->end[s->num_ends++] = p, s->end[s->num_ends++] = q;
        }
        BRIO_FORWARD(brio_look(s->w->ctx, 1));
    }
    for (size_t i = 0; i < s->count; i++) s->dirty[s->row[i]] = 0;
    s->count = 0;
    return BRIO_OK;
}

/* Takes the gaps out, and lets their ends and the free rows beside them wish again. */
static brio_status take_out(search *s) {
    brio_curve_work *w = s->w;
    size_t num_free = 0;
    for (size_t i = 0; i < s->num_ends; i++) unlink_row(w, s->end[i], s->end[i ^ 1]);
    w->num_links -= s->num_ends / 2;
    w->num_gaps += s->num_ends / 2;
    for (size_t i = 0; i < s->num_ends; i++) {
        uint32_t p = s->end[i];
        if (!w->listed[p]) w->listed[p] = 1, s->free[num_free++] = p;
        for (uint32_t k = w->start[p]; k < w->start[p + 1]; k++) {
            uint32_t q = w->neighbour[k];
            if (!w->listed[q] && brio_curve_degree(w, q) < 2) w->listed[q] = 1, s->free[num_free++] = q;
        }
    }
    brio_status status = brio_curve_link(w, s->free, num_free);
    for (size_t i = 0; i < s->num_ends; i++) add_reach(s, s->end[i]);
    for (size_t i = 0; i < w->num_changed; i++) add_reach(s, w->changed[i]);
    return status;
}

brio_status brio_curve_find_gaps(brio_curve_work *w, double open) {
    brio_status status = BRIO_OK;
    search s = {.w = w, .open = open};
    BRIO_TRY(BRIO_ALLOC(w->ctx, s.row, w->num_rows));
    BRIO_TRY(BRIO_ALLOC(w->ctx, s.end, 2 * w->num_rows));
    BRIO_TRY(BRIO_ALLOC(w->ctx, s.free, w->num_rows));
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, s.dirty, w->num_rows));
    for (uint32_t p = 0; p < w->num_rows; p++)
        if (w->link[p][0] != BRIO_NO_ROW) add_row(&s, p);
    while (s.count) {
        BRIO_TRY(mark_gaps(&s));
        if (s.num_ends) BRIO_TRY(take_out(&s));
    }
done:
    brio_release(w->ctx, s.row);
    brio_release(w->ctx, s.end);
    brio_release(w->ctx, s.free);
    brio_release(w->ctx, s.dirty);
    return status;
}
