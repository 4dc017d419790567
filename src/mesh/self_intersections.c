/* The pairs of faces that cross each other: their number, and which faces they are.
 *
 * Faces are sorted along a space-filling curve through the centres of their boxes. Eight boxes that follow each other
 * are a group, whose box is one of the next level. A group's numbers lie side by side, so that a few instructions test
 * all eight, and they are floats: a box is mapped into the unit cube and rounded by functions that never decrease, so
 * boxes that meet still do. Each face searches the groups, and each pair whose boxes meet is tested once, exactly,
 * triangle by triangle. The time is near-linear where faces are about as far apart as they are large.
 *
 * Based on: Rubin, Whitted. A 3-dimensional representation for fast rendering of complex scenes. SIGGRAPH 1980
 * (boxes). Morton. A computer oriented geodetic data base. IBM 1966 (the curve). Wald, Benthin, Boulos. Getting rid of
 * packets: efficient SIMD single-ray traversal using multi-branching BVHs. IEEE RT 2008 (many children side by side).
 * Differs from the papers: no rays; the tree is the order, without pointers. */
#include "mesh/crossing_faces.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "mesh/edge_rings.h"
#include "mesh/triangles_cross.h"
#include <math.h>
#include <string.h>

/* BATCH: faces between two reports of progress. FACES_A_CHUNK: faces that a thread takes at once. All chosen. */
enum { CURVE_BITS = 16, FACES_A_THREAD = 1 << 12, GROUPS_A_THREAD = 1 << 9, BATCH = 1 << 16, FACES_A_CHUNK = 256 };

typedef struct {
    double low[3], high[3];
} box;

static box empty_box(void) {
    return (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void box_add(box *b, const double *low, const double *high) {
    for (int k = 0; k < 3; k++) {
        if (low[k] < b->low[k]) b->low[k] = low[k];
        if (high[k] > b->high[k]) b->high[k] = high[k];
    }
}

static box box_of(const brio_mesh *m, size_t face) {
    box b;
    brio_face_bounds(m, face, b.low, b.high);
    return b;
}

/* --- the unit cube --- */

typedef struct {
    const brio_face_groups *g;
    box *all; /* one for each thread */
} bounding;

static void bound_part(void *user, size_t begin, size_t end, int thread) {
    const bounding *b = user;
    for (size_t i = begin; i < end; i++) {
        box face = box_of(b->g->mesh, b->g->order[i]);
        box_add(&b->all[thread], face.low, face.high);
    }
}

/* Finds the function of I1. Takes halves, so that no difference overflows. */
static brio_status find_cube(brio_face_groups *g) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(g->ctx, g->count, FACES_A_THREAD);
    bounding b = {.g = g};
    BRIO_TRY(BRIO_ALLOC(g->ctx, b.all, (size_t)threads));
    for (int t = 0; t < threads; t++) b.all[t] = empty_box();
    BRIO_TRY(brio_for(g->ctx, threads, g->count, bound_part, &b));
    for (int t = 1; t < threads; t++) box_add(&b.all[0], b.all[t].low, b.all[t].high);
    for (int k = 0; k < 3; k++) {
        g->low[k] = 0.5 * b.all[0].low[k];
        g->size[k] = 0.5 * b.all[0].high[k] - g->low[k];
    }
done:
    brio_release(g->ctx, b.all);
    return status;
}

/* Returns a coordinate under the function of I1. Vertices that moved since may be a little outside of the cube. */
static double in_cube(const brio_face_groups *g, int k, double x) {
    return g->size[k] > 0 ? (0.5 * x - g->low[k]) / g->size[k] : 0;
}

/* --- along the curve --- */

/* Moves bit i of x to bit 3i. */
static uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

typedef struct {
    const brio_face_groups *g;
    uint64_t *key;
} keys;

static void find_keys(void *user, size_t begin, size_t end, int thread) {
    const keys *k = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        box face = box_of(k->g->mesh, k->g->order[i]);
        k->key[i] = 0;
        for (int c = 0; c < 3; c++) {
            double middle = 0.5 * in_cube(k->g, c, face.low[c]) + 0.5 * in_cube(k->g, c, face.high[c]);
            double unit = middle > 0 ? fmin(middle, 1) : 0;
            k->key[i] |= spread_bits((uint64_t)(unit * ((1 << CURVE_BITS) - 1))) << c;
        }
    }
}

static brio_status sort_faces(brio_face_groups *g) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = g->mesh;
    keys k = {.g = g};
    BRIO_TRY(BRIO_ALLOC(g->ctx, g->order, m->num_faces));
    for (size_t f = 0; f < m->num_faces; f++)
        if (m->face_offsets[f + 1] - m->face_offsets[f] > 2) g->order[g->count++] = (uint32_t)f;
    BRIO_TRY(find_cube(g));
    BRIO_TRY(BRIO_ALLOC(g->ctx, k.key, g->count));
    BRIO_TRY(brio_for(g->ctx, brio_threads(g->ctx, g->count, FACES_A_THREAD), g->count, find_keys, &k));
    BRIO_TRY(brio_radix_sort(g->ctx, k.key, g->order, g->count, 3 * CURVE_BITS));
done:
    brio_release(g->ctx, k.key);
    return status;
}

/* --- boxes --- */

/* Puts a box into a group. What is rounded to float never decreases either. */
static void put(brio_box_group *g, size_t i, const double *low, const double *high) {
    for (int k = 0; k < 3; k++) g->low[k][i / 4][i % 4] = (float)low[k], g->high[k][i / 4][i % 4] = (float)high[k];
}

static void fit_faces(void *user, size_t begin, size_t end, int thread) {
    const brio_face_groups *g = user;
    (void)thread;
    for (size_t n = begin; n < end; n++)
        for (size_t i = 0; i < BRIO_GROUP; i++) {
            box b = empty_box();
            size_t place = BRIO_GROUP * n + i;
            if (place < g->count) {
                b = box_of(g->mesh, g->order[place]);
                for (int k = 0; k < 3; k++) b.low[k] = in_cube(g, k, b.low[k]), b.high[k] = in_cube(g, k, b.high[k]);
            }
            put(&g->group[n], i, b.low, b.high);
        }
}

typedef struct {
    const brio_face_groups *g;
    int level;
} fitting;

static void fit_groups(void *user, size_t begin, size_t end, int thread) {
    const fitting *f = user;
    const brio_face_groups *g = f->g;
    size_t below = g->first[f->level] - g->first[f->level - 1];
    (void)thread;
    for (size_t n = begin; n < end; n++)
        for (size_t i = 0; i < BRIO_GROUP; i++) {
            box b = empty_box();
            size_t child = BRIO_GROUP * n + i;
            for (size_t c = 0; child < below && c < BRIO_GROUP; c++) {
                brio_face_box x = brio_lane_of(brio_group_at(g, f->level - 1, child), c);
                double low[3] = {x.low[0], x.low[1], x.low[2]}, high[3] = {x.high[0], x.high[1], x.high[2]};
                box_add(&b, low, high);
            }
            put(&g->group[g->first[f->level] + n], i, b.low, b.high);
        }
}

brio_status brio_face_groups_fit(brio_face_groups *g) {
    for (int level = 0; level < g->levels; level++) {
        size_t groups = g->first[level + 1] - g->first[level];
        fitting f = {g, level};
        BRIO_FORWARD(brio_for(g->ctx, brio_threads(g->ctx, groups, GROUPS_A_THREAD), groups,
                              level ? fit_groups : fit_faces, level ? (void *)&f : (void *)g));
    }
    return BRIO_OK;
}

brio_status brio_face_groups_new(brio_context *ctx, const brio_mesh *mesh, brio_face_groups *out) {
    *out = (brio_face_groups){.ctx = ctx, .mesh = mesh};
    BRIO_FORWARD(sort_faces(out));
    for (size_t boxes = out->count; boxes > 1 || (boxes > 0 && out->levels == 0); out->levels++) {
        boxes = (boxes + BRIO_GROUP - 1) / BRIO_GROUP;
        out->first[out->levels + 1] = out->first[out->levels] + boxes;
    }
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->group, out->first[out->levels]));
    return brio_face_groups_fit(out);
}

void brio_face_groups_free(brio_face_groups *g) {
    brio_release(g->ctx, g->order);
    brio_release(g->ctx, g->group);
    *g = (brio_face_groups){.ctx = g->ctx};
}

bool brio_groups_meet(const brio_face_groups *g, const double low[3], const double high[3]) {
    brio_group_branch stack[BRIO_GROUP * BRIO_GROUP_LEVELS];
    int depth = 0;
    brio_face_box asked;
    for (int k = 0; k < 3; k++)
        asked.low[k] = (float)in_cube(g, k, low[k]), asked.high[k] = (float)in_cube(g, k, high[k]);
    if (g->levels > 0) stack[depth++] = (brio_group_branch){0, g->levels - 1};
    while (depth > 0) {
        brio_group_branch b = stack[--depth];
        unsigned meets = brio_group_meets(brio_group_at(g, b.level, b.group), &asked);
        if (meets && b.level == 0) return true;
        for (; meets; meets &= meets - 1)
            stack[depth++] = (brio_group_branch){BRIO_GROUP * b.group + (size_t)__builtin_ctz(meets), b.level - 1};
    }
    return false;
}

/* --- two faces --- */

/* Writes triangle i of the fan of a face. */
static void fan_triangle(const brio_mesh *m, size_t face, uint64_t i, const double *t[3]) {
    const double *v = m->vertices;
    const uint32_t *corner = m->face_vertices + m->face_offsets[face];
    t[0] = v + 3 * (size_t)corner[0];
    t[1] = v + 3 * (size_t)corner[i + 1];
    t[2] = v + 3 * (size_t)corner[i + 2];
}

/* Returns whether the box of a triangle meets another box. */
static bool box_of_triangle_meets(const double *const t[3], const double low[3], const double high[3]) {
    for (int k = 0; k < 3; k++) {
        if (t[0][k] < low[k] && t[1][k] < low[k] && t[2][k] < low[k]) return false;
        if (t[0][k] > high[k] && t[1][k] > high[k] && t[2][k] > high[k]) return false;
    }
    return true;
}

/* Returns whether a triangle crosses one of the fan of a face of n triangles. */
static bool crosses_fan(const brio_mesh *m, const double *const t[3], size_t face, uint64_t n) {
    const double *u[3];
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(fmin(t[0][k], t[1][k]), t[2][k]);
        high[k] = fmax(fmax(t[0][k], t[1][k]), t[2][k]);
    }
    for (uint64_t i = 0; i < n; i++) {
        fan_triangle(m, face, i, u);
        if (box_of_triangle_meets(u, low, high) && brio_triangles_cross(t, u)) return true;
    }
    return false;
}

/* Returns whether two faces cross whose boxes meet. */
static bool faces_cross(const brio_mesh *m, size_t f, size_t g) {
    uint64_t nf = m->face_offsets[f + 1] - m->face_offsets[f] - 2, ng = m->face_offsets[g + 1] - m->face_offsets[g] - 2;
    const double *t[3], *u[3];
    double low[3], high[3];
    if (nf == 1 && ng == 1) {
        fan_triangle(m, f, 0, t);
        fan_triangle(m, g, 0, u);
        return brio_triangles_cross(t, u);
    }
    brio_face_bounds(m, g, low, high);
    for (uint64_t i = 0; i < nf; i++) {
        fan_triangle(m, f, i, t);
        if (box_of_triangle_meets(t, low, high) && crosses_fan(m, t, g, ng)) return true;
    }
    return false;
}

/* --- pairs --- */

typedef struct {
    const brio_face_groups *g;
    const uint8_t *only; /* NULL, or #F: the faces that are asked about */
    uint32_t *beside;    /* NULL, or #order + 1: how many faces before each place are not asked about */
    uint8_t *crosses;    /* NULL, or #F: set to 1 for the faces of pairs */
    size_t first;        /* place of the batch's first face in the order */
    int64_t count;
} search;

static void mark(uint8_t *crosses, size_t face) {
    __atomic_store_n(&crosses[face], 1, __ATOMIC_RELAXED); /* read after all threads have ended */
}

/* Returns whether the faces under a box up to place `at` find all their pairs with the face there by themselves. */
static bool is_done(const search *s, int level, size_t i, size_t at) {
    size_t low = i << 3 * level, high = (i + 1) << 3 * level;
    if (high > s->g->count) high = s->g->count;
    return high <= at + 1 && (!s->beside || s->beside[low] == s->beside[high]);
}

/* Returns 1 if the pair of the face at place `at` with another one counts here, and they cross. */
static int64_t try_pair(const search *s, size_t at, size_t other) {
    uint32_t f = s->g->order[at], g = s->g->order[other];
    if (other <= at && (other == at || !s->only || s->only[g])) return 0;
    if (!faces_cross(s->g->mesh, f, g)) return 0;
    if (s->crosses) mark(s->crosses, f), mark(s->crosses, g);
    return 1;
}

/* Counts the faces that cross the face at place `at` of the order and come after `at` in the order, or are not asked
 * about. */
static int64_t count_crossing(const search *s, size_t at) {
    brio_group_branch stack[BRIO_GROUP * BRIO_GROUP_LEVELS];
    int depth = 0;
    int64_t count = 0;
    if (s->only && !s->only[s->g->order[at]]) return 0;
    const brio_face_box asked = brio_box_at(s->g, at);
    stack[depth++] = (brio_group_branch){0, s->g->levels - 1};
    while (depth > 0) {
        brio_group_branch b = stack[--depth];
        unsigned meets = brio_group_meets(brio_group_at(s->g, b.level, b.group), &asked);
        for (; meets; meets &= meets - 1) {
            size_t i = BRIO_GROUP * b.group + (size_t)__builtin_ctz(meets);
            if (b.level == 0)
                count += try_pair(s, at, i);
            else if (!is_done(s, b.level, i, at))
                stack[depth++] = (brio_group_branch){i, b.level - 1};
        }
    }
    return count;
}

static void count_pairs(void *user, size_t begin, size_t end, int thread) {
    search *s = user;
    int64_t count = 0;
    (void)thread;
    for (size_t i = begin; i < end; i++) count += count_crossing(s, s->first + i);
    if (count) __atomic_fetch_add(&s->count, count, __ATOMIC_RELAXED); /* read after all threads have ended */
}

/* Counts the faces that are not asked about. */
static brio_status count_beside(search *s) {
    brio_status status = BRIO_ALLOC(s->g->ctx, s->beside, s->g->count + 1);
    if (status != BRIO_OK) return status;
    s->beside[0] = 0;
    for (size_t i = 0; i < s->g->count; i++) s->beside[i + 1] = s->beside[i] + !s->only[s->g->order[i]];
    return BRIO_OK;
}

brio_status brio_search_crossings(const brio_face_groups *g, const uint8_t *only, uint8_t *crosses, int64_t *pairs) {
    brio_status status = BRIO_OK;
    search s = {.g = g, .only = only, .crosses = crosses};
    *pairs = 0;
    if (crosses && g->mesh->num_faces) memset(crosses, 0, g->mesh->num_faces);
    if (only) BRIO_TRY(count_beside(&s));
    for (; s.first < g->count; s.first += BATCH) {
        size_t faces = g->count - s.first < BATCH ? g->count - s.first : BATCH;
        BRIO_TRY(brio_progress(g->ctx, "self-intersections", (double)s.first / (double)g->count));
        BRIO_TRY(
            brio_for_chunks(g->ctx, brio_threads(g->ctx, faces, FACES_A_CHUNK), faces, FACES_A_CHUNK, count_pairs, &s));
    }
    *pairs = s.count;
done:
    brio_release(g->ctx, s.beside);
    return status;
}

brio_status brio_crossing_faces(brio_context *ctx, const brio_mesh *mesh, const uint8_t *only, uint8_t *crosses,
                                int64_t *pairs) {
    brio_status status = BRIO_OK;
    brio_face_groups groups = {.ctx = ctx};
    *pairs = 0;
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(brio_face_groups_new(ctx, mesh, &groups));
    BRIO_TRY(brio_search_crossings(&groups, only, crosses, pairs));
done:
    brio_face_groups_free(&groups);
    return status;
}

brio_status brio_mesh_self_intersections(brio_context *ctx, const brio_mesh *mesh, int64_t *pairs) {
    BRIO_DOOR;
    return brio_crossing_faces(ctx, mesh, NULL, NULL, pairs);
}
