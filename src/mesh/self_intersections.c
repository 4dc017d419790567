/* The pairs of faces that cross each other: their number, and which faces they are.
 *
 * Faces are sorted along a space-filling curve through the centres of their boxes. A binary tree of boxes stands over
 * this sequence. A node is a range of the sequence, so only the boxes are stored. Each face searches the tree, and
 * each pair whose boxes meet is tested once, exactly, triangle by triangle. The time is near-linear where faces are
 * about as far apart as they are large.
 *
 * Based on: Rubin, Whitted. A 3-dimensional representation for fast rendering of complex scenes. SIGGRAPH 1980
 * (boxes). Morton. A computer oriented geodetic data base. IBM 1966 (the curve). */
#include "mesh/crossing_faces.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "mesh/edge_rings.h"
#include "mesh/triangles_cross.h"
#include <math.h>
#include <string.h>

enum {
    LEAF_FACES = 4,
    MOST_LEVELS = 64,
    CURVE_BITS = 16,
    BATCH = 1 << 12,    /* faces between two reports of progress */
    FACES_A_CHUNK = 64, /* faces that a thread takes at once; chosen */
    BOXES_A_THREAD = 1 << 12
};

typedef struct {
    double low[3], high[3];
} box;

/* Node i is a range of `order`; the root, node 0, is the whole of `order`. The children 2i + 1 and 2i + 2 are the
 * halves of the range, the lower one shorter by at most 1. A range of at most LEAF_FACES is a leaf. */
typedef struct {
    const brio_mesh *mesh;
    uint32_t *order; /* faces with three corners or more, along the curve */
    size_t count;
    box *nodes;
    box *faces;       /* along the curve, too */
    uint32_t *beside; /* NULL, or #order + 1: how many faces before each place are not asked about */
} tree;

typedef struct {
    size_t node, low, high;
} range;

/* --- boxes --- */

static box empty_box(void) {
    return (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void box_add(box *b, const double *low, const double *high) {
    for (int k = 0; k < 3; k++) {
        if (low[k] < b->low[k]) b->low[k] = low[k];
        if (high[k] > b->high[k]) b->high[k] = high[k];
    }
}

/* Returns whether boxes meet. Which side misses cannot be predicted, so there is no branch. */
static inline bool boxes_meet(const box *a, const box *b) {
    bool meet = true;
    for (int k = 0; k < 3; k++) meet &= (a->low[k] <= b->high[k]) & (b->low[k] <= a->high[k]);
    return meet;
}

static const double *corner(const brio_mesh *m, uint64_t h) {
    return m->vertices + 3 * (size_t)m->face_vertices[h];
}

/* --- the tree --- */

/* Moves bit i of x to bit 3i. */
static uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t curve_key(const box *all, const box *face) {
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double size = 0.5 * all->high[k] - 0.5 * all->low[k];
        double place = 0.25 * face->low[k] + 0.25 * face->high[k] - 0.5 * all->low[k];
        double unit =
            size > 0 && place > 0 ? fmin(place / size, 1) : 0; /* halves of the least doubles round either way */
        key |= spread_bits((uint64_t)(unit * ((1 << CURVE_BITS) - 1))) << k;
    }
    return key;
}

/* Returns the box of a face. */
static box box_of(const brio_mesh *m, size_t face) {
    box b = empty_box();
    for (uint64_t h = m->face_offsets[face]; h < m->face_offsets[face + 1]; h++)
        box_add(&b, corner(m, h), corner(m, h));
    return b;
}

static void find_boxes(void *user, size_t begin, size_t end, int thread) {
    tree *t = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) t->faces[i] = box_of(t->mesh, t->order[i]);
}

static brio_status sort_faces(brio_context *ctx, tree *t) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = t->mesh;
    int threads = brio_threads(ctx, m->num_faces, BOXES_A_THREAD);
    box all = empty_box();
    uint64_t *keys = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, t->faces, m->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, t->order, m->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, keys, m->num_faces));
    for (size_t f = 0; f < m->num_faces; f++)
        if (m->face_offsets[f + 1] - m->face_offsets[f] > 2) t->order[t->count++] = (uint32_t)f;
    BRIO_TRY(brio_for(ctx, threads, t->count, find_boxes, t));
    for (size_t i = 0; i < t->count; i++) box_add(&all, t->faces[i].low, t->faces[i].high);
    for (size_t i = 0; i < t->count; i++) keys[i] = curve_key(&all, &t->faces[i]);
    BRIO_TRY(brio_radix_sort(ctx, keys, t->order, t->count, 3 * CURVE_BITS));
    BRIO_TRY(brio_for(ctx, threads, t->count, find_boxes, t));
done:
    brio_release(ctx, keys);
    return status;
}

static void build_node(tree *t, range r) {
    box b = empty_box();
    if (r.high - r.low <= LEAF_FACES) {
        for (size_t i = r.low; i < r.high; i++) box_add(&b, t->faces[i].low, t->faces[i].high);
    } else {
        size_t middle = r.low + (r.high - r.low) / 2, child = 2 * r.node + 1;
        build_node(t, (range){child, r.low, middle});
        build_node(t, (range){child + 1, middle, r.high});
        b = t->nodes[child];
        box_add(&b, t->nodes[child + 1].low, t->nodes[child + 1].high);
    }
    t->nodes[r.node] = b;
}

static size_t count_nodes(size_t faces) {
    size_t nodes = 1;
    for (size_t most = faces; most > LEAF_FACES; most -= most / 2) nodes = 2 * nodes + 1;
    return nodes;
}

static brio_status tree_new(brio_context *ctx, const brio_mesh *mesh, tree *t) {
    *t = (tree){.mesh = mesh};
    BRIO_FORWARD(sort_faces(ctx, t));
    BRIO_FORWARD(BRIO_ALLOC(ctx, t->nodes, count_nodes(t->count)));
    build_node(t, (range){0, 0, t->count});
    return BRIO_OK;
}

/* Counts the faces that are not asked about. */
static brio_status count_beside(brio_context *ctx, tree *t, const uint8_t *only) {
    brio_status status = BRIO_ALLOC(ctx, t->beside, t->count + 1);
    if (status != BRIO_OK) return status;
    t->beside[0] = 0;
    for (size_t i = 0; i < t->count; i++) t->beside[i + 1] = t->beside[i] + !only[t->order[i]];
    return BRIO_OK;
}

static void tree_free(brio_context *ctx, tree *t) {
    brio_release(ctx, t->beside);
    brio_release(ctx, t->order);
    brio_release(ctx, t->nodes);
    brio_release(ctx, t->faces);
}

/* --- pairs --- */

/* Writes triangle i of the fan of a face. */
static void fan_triangle(const brio_mesh *m, size_t face, uint64_t i, const double *t[3]) {
    uint64_t first = m->face_offsets[face];
    t[0] = corner(m, first);
    t[1] = corner(m, first + i + 1);
    t[2] = corner(m, first + i + 2);
}

static bool box_of_triangle_meets(const double *const t[3], const box *b) {
    for (int k = 0; k < 3; k++) {
        if (t[0][k] < b->low[k] && t[1][k] < b->low[k] && t[2][k] < b->low[k]) return false;
        if (t[0][k] > b->high[k] && t[1][k] > b->high[k] && t[2][k] > b->high[k]) return false;
    }
    return true;
}

/* Returns whether the faces at two places of the order cross. */
static bool faces_cross(const tree *tr, size_t at, size_t other) {
    const brio_mesh *m = tr->mesh;
    size_t f = tr->order[at], g = tr->order[other];
    uint64_t nf = m->face_offsets[f + 1] - m->face_offsets[f] - 2, ng = m->face_offsets[g + 1] - m->face_offsets[g] - 2;
    const double *t[3], *u[3];
    for (uint64_t i = 0; i < nf; i++) {
        fan_triangle(m, f, i, t);
        if (!box_of_triangle_meets(t, &tr->faces[other])) continue;
        box b = empty_box();
        for (int k = 0; k < 3; k++) box_add(&b, t[k], t[k]);
        for (uint64_t j = 0; j < ng; j++) {
            fan_triangle(m, g, j, u);
            if (box_of_triangle_meets(u, &b) && brio_triangles_cross(t, u)) return true;
        }
    }
    return false;
}

static void mark(uint8_t *crosses, size_t face) {
    __atomic_store_n(&crosses[face], 1, __ATOMIC_RELAXED); /* read after all threads have ended */
}

/* Returns whether the faces of a range up to place `at` find all their pairs with the face there by themselves. */
static bool is_done(const tree *t, range r, size_t at) {
    return r.high <= at + 1 && (!t->beside || t->beside[r.low] == t->beside[r.high]);
}

/* Counts the faces that cross the face at place `at` of the order and come after `at` in the order, or are not asked
 * about.
 * only     NULL, or #F: the faces that are asked about.
 * crosses  NULL, or #F: set to 1 for the faces of these pairs. */
static int64_t count_crossing(const tree *t, size_t at, const uint8_t *only, uint8_t *crosses) {
    range stack[MOST_LEVELS];
    size_t face = t->order[at];
    int depth = 0;
    int64_t count = 0;
    if (only && !only[face]) return 0;
    stack[depth++] = (range){0, 0, t->count};
    while (depth > 0) {
        range r = stack[--depth];
        if (is_done(t, r, at) || !boxes_meet(&t->nodes[r.node], &t->faces[at])) continue;
        if (r.high - r.low > LEAF_FACES) {
            size_t middle = r.low + (r.high - r.low) / 2, child = 2 * r.node + 1;
            stack[depth++] = (range){child, r.low, middle};
            stack[depth++] = (range){child + 1, middle, r.high};
            continue;
        }
        for (size_t i = only || r.low > at ? r.low : at + 1; i < r.high; i++) {
            if (i <= at && (i == at || only[t->order[i]])) continue;
            if (!boxes_meet(&t->faces[i], &t->faces[at]) || !faces_cross(t, at, i)) continue;
            count++;
            if (crosses) mark(crosses, face), mark(crosses, t->order[i]);
        }
    }
    return count;
}

/* The crossing pairs of a batch of faces. */
typedef struct {
    const tree *tree;
    const uint8_t *only;
    uint8_t *crosses;
    size_t first; /* place of the batch's first face in the order */
    int64_t count;
} batch;

static void count_pairs(void *user, size_t begin, size_t end, int thread) {
    batch *b = user;
    int64_t count = 0;
    (void)thread;
    for (size_t i = begin; i < end; i++) count += count_crossing(b->tree, b->first + i, b->only, b->crosses);
    if (count) __atomic_fetch_add(&b->count, count, __ATOMIC_RELAXED); /* read after all threads have ended */
}

brio_status brio_crossing_faces(brio_context *ctx, const brio_mesh *mesh, const uint8_t *only, uint8_t *crosses,
                                int64_t *pairs) {
    brio_status status = BRIO_OK;
    tree t = {0};
    batch b = {.tree = &t, .only = only, .crosses = crosses};
    *pairs = 0;
    if (crosses && mesh->num_faces) memset(crosses, 0, mesh->num_faces);
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(tree_new(ctx, mesh, &t));
    if (only) BRIO_TRY(count_beside(ctx, &t, only));
    for (; b.first < t.count; b.first += BATCH) {
        size_t faces = t.count - b.first < BATCH ? t.count - b.first : BATCH;
        BRIO_TRY(brio_progress(ctx, "self-intersections", (double)b.first / (double)t.count));
        BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, faces, FACES_A_CHUNK), faces, FACES_A_CHUNK, count_pairs, &b));
    }
    *pairs = b.count;
done:
    tree_free(ctx, &t);
    return status;
}

brio_status brio_mesh_self_intersections(brio_context *ctx, const brio_mesh *mesh, int64_t *pairs) {
    BRIO_DOOR;
    return brio_crossing_faces(ctx, mesh, NULL, NULL, pairs);
}
