/* The pairs of faces that cross each other: their number, and which faces they are.
 *
 * Each face searches the boxes of all faces (face_groups.c), and each pair whose boxes meet is tested once, exactly,
 * triangle by triangle. The time is near-linear where faces are about as far apart as they are large. */
#include "mesh/crossing_faces.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/team.h"
#include "mesh/edge_rings.h"
#include "mesh/triangles_cross.h"
#include <math.h>
#include <string.h>

enum {
    BATCH = 1 << 16,    /* faces between two reports of progress */
    FACES_A_CHUNK = 256 /* faces that a thread takes at once; chosen */
};

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
    const brio_face_box box = brio_box_at(s->g, at);
    stack[depth++] = (brio_group_branch){0, s->g->levels - 1};
    while (depth > 0) {
        brio_group_branch b = stack[--depth];
        unsigned meets = brio_group_meets(brio_group_at(s->g, b.level, b.group), &box);
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
