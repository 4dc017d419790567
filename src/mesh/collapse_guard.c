/* An octree of the triangles of a mesh whose edges collapse.
 *
 * A triangle is in the deepest node whose side is at least that of the triangle's box and that holds the middle of the
 * box. So it reaches beyond its node by half the node's side at most: a loose octree, in which a triangle is put and
 * from which it is taken along one path. Each node counts the triangles in and below it, so that a search passes over
 * what is empty.
 *
 * A collapse makes new triangles round one point. They are tested, exactly, against each other and against all others
 * whose boxes they meet, but those that the collapse replaces. So the pairs of triangles that cross never become more.
 *
 * Based on: Ulrich. Loose octrees. Game Programming Gems 2000. Gumhold, Borodin, Klein. Intersection free
 * simplification.
 *           International Journal of Shape Modeling 2003 (tests before each collapse). */
#include "mesh/collapse_guard.h"
#include "base/memory.h"
#include "mesh/triangles_cross.h"
#include <math.h>
#include <string.h>

/* DEEPEST: levels below the root. STACK: at most seven nodes a level wait for a search. */
enum { NONE = BRIO_COLLAPSE_NONE, DEEPEST = 24, STACK = 8 * (DEEPEST + 2) };

typedef struct {
    uint32_t child[8], parent; /* NONE: there is none */
    uint32_t first;            /* of the triangles in this node */
    uint32_t count;            /* of the triangles in it and below it */
} node;

/* A triangle that a collapse would make: the point, and two corners of the triangle that it replaces. */
typedef struct {
    uint32_t face, corner[2];
} fan_triangle;

struct brio_collapse_guard {
    brio_context *ctx;
    brio_status status;
    double centre[3], half; /* of the root */
    node *nodes;
    size_t num_nodes, node_capacity;
    uint32_t *node_of, *next; /* #F: the node of a triangle, and the next triangle there */
    fan_triangle *fan;        /* of the last edge that was asked for */
    size_t fan_count, fan_capacity;
    uint32_t gone[2]; /* the triangles beside that edge */
};

typedef struct {
    double low[3], high[3];
} box;

/* --- boxes --- */

static void corners_of(const brio_collapse_mesh *m, uint32_t face, const double *t[3]) {
    for (size_t k = 0; k < 3; k++) t[k] = brio_collapse_at(m, m->vertex[3 * (size_t)face + k]);
}

static box box_of(const double *const t[3]) {
    box b;
    for (int k = 0; k < 3; k++) {
        b.low[k] = fmin(fmin(t[0][k], t[1][k]), t[2][k]);
        b.high[k] = fmax(fmax(t[0][k], t[1][k]), t[2][k]);
    }
    return b;
}

static void widen(box *b, const box *by) {
    for (int k = 0; k < 3; k++) b->low[k] = fmin(b->low[k], by->low[k]), b->high[k] = fmax(b->high[k], by->high[k]);
}

static bool boxes_meet(const box *a, const box *b) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return false;
    return true;
}

/* --- the octree --- */

/* Moves to the child that holds a point. Returns its number. */
static int descend(double centre[3], double *half, const double *point) {
    int which = 0;
    *half /= 2;
    for (int k = 0; k < 3; k++) {
        bool upper = point[k] > centre[k];
        which |= upper << k;
        centre[k] += upper ? *half : -*half;
    }
    return which;
}

static brio_status add_node(brio_collapse_guard *g, uint32_t parent, uint32_t *out) {
    brio_status status = BRIO_RESERVE(g->ctx, g->nodes, g->node_capacity, g->num_nodes + 1);
    if (status != BRIO_OK) return status;
    node *n = &g->nodes[g->num_nodes];
    *out = (uint32_t)g->num_nodes++;
    *n = (node){.parent = parent, .first = NONE};
    memset(n->child, 0xff, sizeof n->child);
    return BRIO_OK;
}

static brio_status insert(brio_collapse_guard *g, const brio_collapse_mesh *m, uint32_t face) {
    const double *t[3];
    double centre[3], half = g->half, middle[3], side = 0;
    uint32_t at = 0;
    corners_of(m, face, t);
    box b = box_of(t);
    memcpy(centre, g->centre, sizeof centre);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * b.low[k] + 0.5 * b.high[k];
        side = fmax(side, b.high[k] - b.low[k]);
    }
    for (int level = 0; level < DEEPEST && side <= half; level++) {
        int which = descend(centre, &half, middle);
        uint32_t below = g->nodes[at].child[which];
        if (below == NONE) {
            BRIO_FORWARD(add_node(g, at, &below));
            g->nodes[at].child[which] = below;
        }
        at = below;
    }
    g->node_of[face] = at;
    g->next[face] = g->nodes[at].first;
    g->nodes[at].first = face;
    for (uint32_t n = at; n != NONE; n = g->nodes[n].parent) g->nodes[n].count++;
    return BRIO_OK;
}

static void take_out(brio_collapse_guard *g, uint32_t face) {
    uint32_t at = g->node_of[face], *link = &g->nodes[at].first;
    while (*link != face) link = &g->next[*link];
    *link = g->next[face];
    for (uint32_t n = at; n != NONE; n = g->nodes[n].parent) g->nodes[n].count--;
}

brio_status brio_collapse_guard_new(const brio_collapse_mesh *m, brio_collapse_guard **out) {
    brio_collapse_guard *g;
    box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    uint32_t root;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(m->ctx, *out, 1));
    g = *out;
    g->ctx = m->ctx;
    BRIO_FORWARD(BRIO_ALLOC(g->ctx, g->node_of, m->num_faces));
    BRIO_FORWARD(BRIO_ALLOC(g->ctx, g->next, m->num_faces));
    for (size_t v = 0; v < m->num_vertices; v++) {
        box point;
        memcpy(point.low, brio_collapse_at(m, (uint32_t)v), sizeof point.low);
        memcpy(point.high, point.low, sizeof point.high);
        widen(&all, &point);
    }
    for (int k = 0; k < 3 && m->num_vertices; k++) {
        g->centre[k] = 0.5 * all.low[k] + 0.5 * all.high[k];
        g->half = fmax(g->half, all.high[k] - all.low[k]);
    }
    BRIO_FORWARD(add_node(g, NONE, &root));
    for (uint32_t f = 0; f < m->num_faces; f++) {
        if (f % (1 << 16) == 0) BRIO_FORWARD(brio_progress(g->ctx, "simplify", 0));
        BRIO_FORWARD(insert(g, m, f));
    }
    return BRIO_OK;
}

void brio_collapse_guard_free(brio_context *ctx, brio_collapse_guard *g) {
    if (!g) return;
    brio_release(ctx, g->nodes);
    brio_release(ctx, g->node_of);
    brio_release(ctx, g->next);
    brio_release(ctx, g->fan);
    brio_release(ctx, g);
}

brio_status brio_collapse_guard_status(const brio_collapse_guard *g) {
    return g->status;
}

/* --- the test of a collapse --- */

/* Lists the triangles round the start of h that the collapse of h replaces. */
static brio_status list_fan(brio_collapse_guard *g, const brio_collapse_mesh *m, uint32_t h) {
    uint32_t last = brio_collapse_next(m->mate[h]);
    for (uint32_t i = brio_collapse_turn(m, h); i != h; i = brio_collapse_turn(m, i)) {
        if (i == last) continue;
        BRIO_FORWARD(BRIO_RESERVE(g->ctx, g->fan, g->fan_capacity, g->fan_count + 1));
        g->fan[g->fan_count++] = (fan_triangle){i / 3, {brio_collapse_end(m, i), m->vertex[brio_collapse_before(i)]}};
    }
    return BRIO_OK;
}

static void new_corners(const brio_collapse_mesh *m, const fan_triangle *f, const double *point, const double *t[3]) {
    t[0] = point;
    t[1] = brio_collapse_at(m, f->corner[0]);
    t[2] = brio_collapse_at(m, f->corner[1]);
}

static bool is_replaced(const brio_collapse_guard *g, uint32_t face) {
    if (face == g->gone[0] || face == g->gone[1]) return true;
    for (size_t i = 0; i < g->fan_count; i++)
        if (g->fan[i].face == face) return true;
    return false;
}

/* Returns whether a triangle that stays meets one of the new ones.   all  the box of these. */
static bool meets_fan(const brio_collapse_mesh *m, uint32_t face, const box *all, const double *point) {
    const brio_collapse_guard *g = m->guard;
    const double *t[3], *u[3];
    corners_of(m, face, t);
    box b = box_of(t);
    if (!boxes_meet(&b, all) || is_replaced(g, face)) return false;
    for (size_t i = 0; i < g->fan_count; i++) {
        new_corners(m, &g->fan[i], point, u);
        box of_new = box_of(u);
        if (boxes_meet(&b, &of_new) && brio_triangles_cross(t, u)) return true;
    }
    return false;
}

/* A node that waits for a search. */
typedef struct {
    uint32_t node;
    double centre[3], half;
} place;

/* Returns whether what is in or below a node may meet a box. */
static bool node_meets(const place *p, const box *b) {
    for (int k = 0; k < 3; k++)
        if (b->low[k] > p->centre[k] + 2 * p->half || b->high[k] < p->centre[k] - 2 * p->half) return false;
    return true;
}

static bool any_meets_fan(const brio_collapse_mesh *m, const box *all, const double *point) {
    const brio_collapse_guard *g = m->guard;
    place stack[STACK];
    size_t depth = 0;
    stack[depth] = (place){.node = 0, .half = g->half};
    memcpy(stack[depth++].centre, g->centre, sizeof g->centre);
    while (depth) {
        place p = stack[--depth];
        const node *n = &g->nodes[p.node];
        for (uint32_t f = n->first; f != NONE; f = g->next[f])
            if (meets_fan(m, f, all, point)) return true;
        for (int i = 0; i < 8; i++) {
            if (n->child[i] == NONE || !g->nodes[n->child[i]].count) continue;
            place below = {.node = n->child[i], .half = p.half / 2};
            for (int k = 0; k < 3; k++) below.centre[k] = p.centre[k] + (i >> k & 1 ? below.half : -below.half);
            if (node_meets(&below, all)) stack[depth++] = below;
        }
    }
    return false;
}

/* Returns whether two of the new triangles meet in more than what they share. */
static bool fan_meets_itself(const brio_collapse_mesh *m, const double *point) {
    const brio_collapse_guard *g = m->guard;
    const double *t[3], *u[3];
    for (size_t i = 1; i < g->fan_count; i++)
        for (size_t j = 0; j < i; j++) {
            new_corners(m, &g->fan[i], point, t);
            new_corners(m, &g->fan[j], point, u);
            if (brio_triangles_cross(t, u)) return true;
        }
    return false;
}

bool brio_collapse_guard_allows(const brio_collapse_mesh *m, uint32_t h, const double *point) {
    brio_collapse_guard *g = m->guard;
    box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    g->fan_count = 0;
    g->gone[0] = h / 3, g->gone[1] = m->mate[h] / 3;
    brio_status status = list_fan(g, m, h);
    if (status == BRIO_OK) status = list_fan(g, m, m->mate[h]);
    if (status != BRIO_OK) g->status = status;
    if (g->status != BRIO_OK) return false;
    for (size_t i = 0; i < g->fan_count; i++) {
        const double *t[3];
        new_corners(m, &g->fan[i], point, t);
        box b = box_of(t);
        widen(&all, &b);
    }
    return !any_meets_fan(m, &all, point) && !fan_meets_itself(m, point);
}

void brio_collapse_guard_before(const brio_collapse_mesh *m) {
    brio_collapse_guard *g = m->guard;
    for (size_t i = 0; i < g->fan_count; i++) take_out(g, g->fan[i].face);
    for (int i = 0; i < 2; i++) take_out(g, g->gone[i]);
}

void brio_collapse_guard_after(const brio_collapse_mesh *m) {
    brio_collapse_guard *g = m->guard;
    for (size_t i = 0; i < g->fan_count && g->status == BRIO_OK; i++) g->status = insert(g, m, g->fan[i].face);
}
