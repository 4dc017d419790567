/* Fewer balls for nearly the same union: larger balls stand for smaller ones.
 *
 * Noise makes bumps whose balls vanish in a larger ball when all balls are scaled by s about their centres: bumps up to
 * (s - 1) times the difference of the radii. Along a sheet of balls of about equal radius nothing vanishes this way.
 * There, a ball that is enlarged a little covers the balls that it then contains.
 *
 * The balls are taken by descending radius, and each is compared with the balls kept so far. A tree of boxes over all
 * centres finds these; each node stores the largest radius kept in it. Put a ball of that radius at the point of the
 * node's box nearest to the query: if this ball does not cover the query, no kept ball of the node does.
 *
 * Based on: Miklos, Giesen, Pauly. Discrete scale axis representations for 3D geometry. SIGGRAPH 2010 (scaling).
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001 (redundancy: larger balls first).
 * Differs from the papers: one ball has to contain the other one; the scale axis, which asks for the union of
 *                          all balls, is in scale_axis.c. */
#include "reconstruct/medial/ball_cover.h"
#include "base/memory.h"
#include "base/sort.h"
#include <math.h>

/* LEAF_BALLS: chosen. MOST_LEVELS: a tree of 2^32 balls has fewer levels. */
enum { LEAF_BALLS = 8, MOST_LEVELS = 64 };
static const double SAME = 1e-9; /* chosen: relative slack, so that rounding does not keep two copies of one ball */

/* A node is a range of `balls`. The root is node 0. The children of node i are nodes 2i + 1 and 2i + 2, the halves of
 * its range. */
typedef struct {
    double low[3], high[3];
    double largest; /* the largest radius kept in the range; -1: none is kept */
} node;

typedef struct {
    const double *centre, *square;
    const uint32_t *balls;
    size_t count;
    const brio_cover_rule *rule;
    node *nodes;
    uint8_t *kept; /* count: whether the ball is kept */
} cover;

typedef struct {
    size_t node, low, high;
} range;

static size_t count_nodes(size_t balls) {
    size_t nodes = 1;
    for (size_t most = balls; most > LEAF_BALLS; most -= most / 2) nodes = 2 * nodes + 1;
    return nodes;
}

static void build_node(const cover *c, range r) {
    node *n = &c->nodes[r.node];
    n->largest = -1;
    for (int k = 0; k < 3; k++) n->low[k] = INFINITY, n->high[k] = -INFINITY;
    for (size_t i = r.low; i < r.high; i++)
        for (size_t k = 0; k < 3; k++) {
            double x = c->centre[3 * (size_t)c->balls[i] + k];
            n->low[k] = fmin(n->low[k], x);
            n->high[k] = fmax(n->high[k], x);
        }
    if (r.high - r.low <= LEAF_BALLS) return;
    size_t middle = r.low + (r.high - r.low) / 2;
    build_node(c, (range){2 * r.node + 1, r.low, middle});
    build_node(c, (range){2 * r.node + 2, middle, r.high});
}

/* Returns the greatest distance of the centres at which a ball of radius `large` covers a ball of radius `small`. */
static double reach(const cover *c, double large, double small) {
    return fmax(c->rule->scale * (large - small), (1 + c->rule->redundancy) * large - small) + SAME * large;
}

static double distance_from_box(const node *n, const double *p) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double d = fmax(fmax(n->low[k] - p[k], p[k] - n->high[k]), 0);
        square += d * d;
    }
    return sqrt(square);
}

static bool covered_in_leaf(const cover *c, range r, const double *p, double radius) {
    for (size_t i = r.low; i < r.high; i++) {
        if (!c->kept[i]) continue;
        const double *q = c->centre + 3 * (size_t)c->balls[i];
        double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
        if (sqrt(x * x + y * y + z * z) <= reach(c, sqrt(c->square[c->balls[i]]), radius)) return true;
    }
    return false;
}

static bool covered(const cover *c, uint32_t ball) {
    const double *p = c->centre + 3 * (size_t)ball;
    double radius = sqrt(c->square[ball]);
    range stack[MOST_LEVELS], r;
    int depth = 0;
    stack[depth++] = (range){0, 0, c->count};
    while (depth > 0) {
        r = stack[--depth];
        const node *n = &c->nodes[r.node];
        if (n->largest < 0 || distance_from_box(n, p) > reach(c, n->largest, radius)) continue;
        if (r.high - r.low <= LEAF_BALLS) {
            if (covered_in_leaf(c, r, p, radius)) return true;
            continue;
        }
        size_t middle = r.low + (r.high - r.low) / 2;
        stack[depth++] = (range){2 * r.node + 1, r.low, middle};
        stack[depth++] = (range){2 * r.node + 2, middle, r.high};
    }
    return false;
}

/* Keeps ball `at`. Radii come in descending order, so the first radius that a node gets is its largest. */
static void keep_ball(cover *c, size_t at) {
    double radius = sqrt(c->square[c->balls[at]]);
    range r = {0, 0, c->count};
    c->kept[at] = 1;
    for (;;) {
        if (c->nodes[r.node].largest < 0) c->nodes[r.node].largest = radius;
        if (r.high - r.low <= LEAF_BALLS) return;
        size_t middle = r.low + (r.high - r.low) / 2;
        r = at < middle ? (range){2 * r.node + 1, r.low, middle} : (range){2 * r.node + 2, middle, r.high};
    }
}

/* Sorts the indices of `balls` by descending radius. Equal radii stay in the order of `balls`. */
static brio_status sort_by_radius(brio_context *ctx, const cover *c, uint32_t *order) {
    uint64_t *keys = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, keys, c->count));
    for (size_t i = 0; i < c->count; i++) {
        keys[i] = ~brio_double_key(c->square[c->balls[i]]);
        order[i] = (uint32_t)i;
    }
    BRIO_TRY(brio_radix_sort(ctx, keys, order, c->count, 64));
done:
    brio_release(ctx, keys);
    return status;
}

brio_status brio_cover_balls(brio_context *ctx, const brio_balls *b, const brio_cover_rule *rule, uint8_t *keep) {
    brio_status status = BRIO_OK;
    size_t count = b->count;
    cover c = {.centre = b->centre, .square = b->square, .balls = b->ball, .count = count, .rule = rule};
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, order, count));
    BRIO_TRY(BRIO_ALLOC(ctx, c.nodes, count_nodes(count)));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, c.kept, count));
    BRIO_TRY(sort_by_radius(ctx, &c, order));
    build_node(&c, (range){0, 0, count});
    for (size_t i = 0; i < count; i++) {
        if (i % 65536 == 0) BRIO_TRY(brio_progress(ctx, "simplify", (double)i / (double)count));
        if (covered(&c, b->ball[order[i]]))
            keep[b->ball[order[i]]] = 0;
        else
            keep_ball(&c, order[i]);
    }
done:
    brio_release(ctx, order);
    brio_release(ctx, c.nodes);
    brio_release(ctx, c.kept);
    return status;
}
