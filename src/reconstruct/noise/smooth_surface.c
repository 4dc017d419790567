/* Smoothing of a surface: every vertex moves along the normal of the surface fitted to its neighbours onto that
 * surface, PASSES times. Vertices of the rim stay: beyond them the surface is not known, and it would shrink. The
 * neighbours are found along edges, breadth first, whole rings at a time until there are MORE: not in space, where a
 * thin wall has its other side. Rings reach round a limb or a rim, too: neighbours whose normals are not within 73
 * degrees of the vertex's own do not count.
 *
 * A triangle that would look the other way than before holds its vertices back: they move half as far, after HALVINGS
 * not at all. A surface that was smoothed has no triangles inside out that it did not have before.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 * Differs from the paper: neighbours along the surface. */
#include "reconstruct/noise/smooth_surface.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/team.h"
#include "base/vector.h"
#include "reconstruct/noise/local_surface.h"
#include <string.h>

/* MORE, PASSES: as for samples (sample_noise.c). The others are chosen, too. */
enum { MORE = 36, PASSES = 2, HALVINGS = 3, VERTICES_A_THREAD = 256, FACES_A_THREAD = 1 << 12 };

/* The least cosine between the normals of a vertex and of a neighbour that counts. Chosen on scans of models that
 * nothing else was measured on, where 0 and 0.3 are alike and -0.3 is worse. */
static const double ALIKE = 0.3;

enum { SLOT_BITS = 9, SLOTS = 1 << SLOT_BITS }; /* eight times BRIO_MOST_NEAR, so that few vertices share a slot */

static const uint32_t NOBODY = UINT32_MAX;

typedef struct {
    size_t *first;  /* #P + 1: the vertices that faces join to p are next[first[p]] to next[first[p + 1] - 1] */
    uint32_t *next; /* 3 #F: the corner after p of each face at p */
    uint8_t *rim;   /* #P: whether the vertex is at a rim */
    const double *from;
    double *to;
    double (*normal)[3]; /* #P: sums over the faces of their normals, as long as twice their areas */
} smoothing;

static brio_status list_neighbours(brio_context *ctx, smoothing *s, size_t num_points, const uint32_t *faces,
                                   size_t num_faces) {
    brio_status status = BRIO_OK;
    size_t *place = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, place, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, s->first, num_points + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, s->next, 3 * num_faces));
    for (size_t c = 0; c < 3 * num_faces; c++) place[faces[c]]++;
    s->first[num_points] = brio_counts_to_places(place, 1, num_points, 0);
    memcpy(s->first, place, num_points * sizeof *place);
    for (size_t f = 0; f < num_faces; f++)
        for (size_t k = 0; k < 3; k++) s->next[place[faces[3 * f + k]]++] = faces[3 * f + (k + 1) % 3];
done:
    brio_release(ctx, place);
    return status;
}

/* Returns whether a face has a corner p followed by q. */
static bool has_half_edge(const smoothing *s, uint32_t p, uint32_t q) {
    for (size_t e = s->first[p]; e < s->first[p + 1]; e++)
        if (s->next[e] == q) return true;
    return false;
}

/* Marks the vertices of edges of one face. */
static void mark_rims(const smoothing *s, size_t num_points) {
    for (uint32_t p = 0; p < num_points; p++)
        for (size_t e = s->first[p]; e < s->first[p + 1]; e++)
            if (!has_half_edge(s, s->next[e], p)) s->rim[p] = s->rim[s->next[e]] = 1;
}

/* Distinct vertices in the order in which they came, and a hash table of them. */
typedef struct {
    uint32_t vertex[BRIO_MOST_NEAR + 1];
    size_t count;
    uint32_t slot[SLOTS]; /* a vertex, or NOBODY; vertices that fall into the same slot take the next free one */
} vertex_list;

/* Lists p unless it is listed. Whether it is cannot be predicted, so there is no branch. */
static inline void list(vertex_list *l, uint32_t p) {
    size_t i = p * 0x9E3779B1u >> (32 - SLOT_BITS);
    while (l->slot[i] != p && l->slot[i] != NOBODY) i = (i + 1) % SLOTS;
    l->vertex[l->count] = p;
    l->count += l->slot[i] != p;
    l->slot[i] = p;
}

/* Lists p and the vertices nearest to it along edges: whole rings, until they are MORE, at most BRIO_MOST_NEAR. */
static void list_rings(const smoothing *s, uint32_t p, vertex_list *l) {
    size_t ring = 0;
    memset(l->slot, 0xff, sizeof l->slot);
    l->count = 0;
    list(l, p);
    while (l->count < MORE && ring < l->count) {
        size_t end = l->count;
        for (; ring < end; ring++)
            for (size_t e = s->first[l->vertex[ring]]; e < s->first[l->vertex[ring] + 1] && l->count < BRIO_MOST_NEAR;
                 e++)
                list(l, s->next[e]);
    }
}

/* Vertices whose surfaces are fitted side by side. */
typedef struct {
    size_t count;
    uint32_t vertex[BRIO_SURFACE_BATCH];
    brio_neighbourhood near[BRIO_SURFACE_BATCH];
} batch;

static void smooth_batch(const smoothing *s, batch *b) {
    brio_local_surface surface[BRIO_SURFACE_BATCH];
    bool fitted[BRIO_SURFACE_BATCH];
    brio_fit_local_surfaces(b->near, b->count, surface, fitted);
    for (size_t i = 0; i < b->count; i++)
        if (fitted[i]) brio_move_onto(&surface[i], s->to + 3 * (size_t)b->vertex[i]);
    b->count = 0;
}

/* Returns whether two vertices look the same way. */
static bool is_alike(const smoothing *s, uint32_t p, uint32_t q) {
    const double *a = s->normal[p], *b = s->normal[q];
    double along = brio_dot(a, b);
    return along >= 0 && along * along >= ALIKE * ALIKE * brio_dot(a, a) * brio_dot(b, b);
}

static void add_vertex(const smoothing *s, uint32_t p, batch *b) {
    vertex_list l;
    brio_neighbourhood *n = &b->near[b->count];
    list_rings(s, p, &l);
    n->count = 0;
    for (size_t j = 0; j < l.count; j++)
        if (is_alike(s, p, l.vertex[j]))
            brio_add_neighbour(n, s->from + 3 * (size_t)p, s->from + 3 * (size_t)l.vertex[j]);
    b->vertex[b->count++] = p;
}

static void smooth_part(void *user, size_t begin, size_t end, int thread) {
    const smoothing *s = user;
    (void)thread;
    batch b;
    b.count = 0;
    for (size_t p = begin; p < end; p++) {
        if (s->first[p + 1] > s->first[p] && !s->rim[p]) add_vertex(s, (uint32_t)p, &b);
        if (b.count == BRIO_SURFACE_BATCH) smooth_batch(s, &b);
    }
    smooth_batch(s, &b);
}

/* Writes the normal of a face, as long as twice its area. */
static void find_normal(const double *points, const uint32_t *v, double normal[3]) {
    double u[3], w[3];
    for (int k = 0; k < 3; k++) {
        u[k] = points[3 * (size_t)v[1] + (size_t)k] - points[3 * (size_t)v[0] + (size_t)k];
        w[k] = points[3 * (size_t)v[2] + (size_t)k] - points[3 * (size_t)v[0] + (size_t)k];
    }
    brio_cross(u, w, normal);
}

static void add_normals(const smoothing *s, size_t num_points, const uint32_t *faces, size_t num_faces) {
    double normal[3];
    memset(s->normal, 0, num_points * sizeof *s->normal);
    for (size_t f = 0; f < num_faces; f++) {
        find_normal(s->from, faces + 3 * f, normal);
        for (size_t i = 0; i < 3; i++)
            for (size_t k = 0; k < 3; k++) s->normal[faces[3 * f + i]][k] += normal[k];
    }
}

/* --- faces that would turn --- */

typedef struct {
    const smoothing *s;
    const double *before; /* #P by 3: before all passes */
    const uint32_t *faces;
    uint8_t *held; /* #P: vertices of faces that look the other way than before */
    size_t turned;
} turning;

static void mark_turned(void *user, size_t begin, size_t end, int thread) {
    turning *t = user;
    double before[3], after[3];
    size_t turned = 0;
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        find_normal(t->before, t->faces + 3 * f, before);
        find_normal(t->s->to, t->faces + 3 * f, after);
        if (brio_dot(before, after) >= 0) continue;
        for (size_t k = 0; k < 3; k++) __atomic_store_n(&t->held[t->faces[3 * f + k]], 1, __ATOMIC_RELAXED);
        turned++;
    }
    __atomic_fetch_add(&t->turned, turned, __ATOMIC_RELAXED);
}

/* Moves vertices back until no face is turned. That ends: before the pass none was. */
static brio_status hold_back(brio_context *ctx, turning *t, size_t num_points, size_t num_faces) {
    for (int sweep = 0;; sweep++) {
        memset(t->held, 0, num_points);
        t->turned = 0;
        brio_status status = brio_for(ctx, brio_threads(ctx, num_faces, FACES_A_THREAD), num_faces, mark_turned, t);
        if (status != BRIO_OK || t->turned == 0) return status;
        for (size_t p = 0; p < num_points; p++) {
            const double *from = t->s->from + 3 * p;
            double *to = t->s->to + 3 * p;
            for (size_t k = 0; t->held[p] && k < 3; k++) to[k] = sweep < HALVINGS ? 0.5 * (from[k] + to[k]) : from[k];
        }
    }
}

brio_status brio_smooth_surface(brio_context *ctx, double *points, size_t num_points, const uint32_t *faces,
                                size_t num_faces) {
    brio_status status = BRIO_OK;
    smoothing s = {.to = points};
    turning t = {.s = &s, .faces = faces};
    double *from = NULL, *before = NULL;
    BRIO_TRY(list_neighbours(ctx, &s, num_points, faces, num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, from, 3 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, before, 3 * num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, s.normal, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, t.held, num_points));
    memcpy(before, points, 3 * num_points * sizeof *before);
    s.from = from, t.before = before;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.rim, num_points));
    mark_rims(&s, num_points);
    for (int pass = 0; pass < PASSES; pass++) {
        BRIO_TRY(brio_progress(ctx, "smooth", (double)pass / PASSES));
        memcpy(from, points, 3 * num_points * sizeof *from);
        add_normals(&s, num_points, faces, num_faces);
        BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, num_points, VERTICES_A_THREAD), num_points, VERTICES_A_THREAD,
                                 smooth_part, &s));
        BRIO_TRY(hold_back(ctx, &t, num_points, num_faces));
    }
done:
    brio_release(ctx, s.first);
    brio_release(ctx, s.next);
    brio_release(ctx, s.rim);
    brio_release(ctx, from);
    brio_release(ctx, before);
    brio_release(ctx, s.normal);
    brio_release(ctx, t.held);
    return status;
}
