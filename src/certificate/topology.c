/* Joins of faces and corners, and what is counted of them: see topology.h.
 *
 * A component has the vertices and edges that its faces use; a vertex in several components counts once in each.
 *
 * Conventions where the surface is not a manifold:
 * - An edge joins all its faces into one component, whatever their number. Only an edge of two faces continues a fan.
 * - A boundary loop is a set of boundary edges connected through fans and across edges of more than two faces. On a
 *   manifold a loop is a cycle. Two loops that touch where two fans share a vertex stay two.
 * - A face with fewer than three corners makes all its vertices non-manifold, and the surface not closed: such a face
 *   bounds nothing. A face with a vertex twice makes that vertex non-manifold.
 * - A face that runs along an edge twice counts as the edge's two faces.
 * - An odd 2 - chi - loops, as of a Moebius strip, is rounded down.
 *
 * Threads share the work. The result does not depend on their order: a root is the first element of its set, and
 * counts are integers. */
#include "certificate/topology.h"
#include "base/sort.h"
#include "base/team.h"
#include "mesh/edge_rings.h"

/* Faces, corners or vertices: a pass takes 1 to 25 ns an item. */
enum { ITEMS_A_THREAD = 1 << 15 };

/* --- connectivity --- */

/* Calls body on parts of the range 0 to n - 1. */
static brio_status for_each(const brio_topology *t, size_t n, brio_part_fn body, void *user) {
    return brio_for(t->ctx, brio_threads(t->ctx, n, ITEMS_A_THREAD), n, body, user);
}

void brio_topology_free(brio_topology *t) {
    if (!t->ctx) return;
    brio_release(t->ctx, t->ring);
    brio_release(t->ctx, t->face_of);
    brio_release(t->ctx, t->fan);
    brio_release(t->ctx, t->patch);
    brio_release(t->ctx, t->vertex);
}

static bool is_of_triangles(const brio_mesh *mesh) {
    bool all = true;
    for (size_t f = 0; f < mesh->num_faces && all; f++) all = mesh->face_offsets[f + 1] == 3 * (f + 1);
    return all;
}

/* Makes one set of each face, and one of each corner of these faces. */
static void make_sets(void *user, size_t begin, size_t end, int thread) {
    const brio_topology *t = user;
    const uint64_t *offsets = t->mesh->face_offsets;
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        t->patch[f] = (uint32_t)f;
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
            if (t->face_of) t->face_of[h] = (uint32_t)f;
            t->fan[h] = (uint32_t)h;
        }
    }
}

brio_status brio_topology_new(brio_context *ctx, const brio_mesh *mesh, const uint8_t *own, const uint64_t *index,
                              brio_topology *t) {
    *t = (brio_topology){.ctx = ctx, .mesh = mesh, .own = own, .index = index};
    t->corners = mesh->num_faces ? (size_t)mesh->face_offsets[mesh->num_faces] : 0;
    BRIO_FORWARD(brio_edge_rings(ctx, mesh, &t->ring));
    if (!is_of_triangles(mesh)) BRIO_FORWARD(BRIO_ALLOC(ctx, t->face_of, t->corners));
    BRIO_FORWARD(BRIO_ALLOC(ctx, t->fan, t->corners));
    BRIO_FORWARD(BRIO_ALLOC(ctx, t->patch, mesh->num_faces));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, t->vertex, mesh->num_vertices));
    return for_each(t, mesh->num_faces, make_sets, t);
}

/* Adds to a counter. The counter is read only after all threads have ended. */
static void add_relaxed(size_t *count, size_t amount) {
    __atomic_fetch_add(count, amount, __ATOMIC_RELAXED);
}

/* Joins the corners at both ends of the edge that half-edges h and g share. */
static void join_corners(const brio_topology *t, uint32_t h, uint32_t g, bool alone) {
    const uint32_t *v = t->mesh->face_vertices;
    uint32_t h_end = brio_next_corner(t, h), g_end = brio_next_corner(t, g);
    bool same_way = v[h] == v[g];
    brio_unite(t->fan, h, same_way ? g : g_end, alone);
    brio_unite(t->fan, h_end, same_way ? g_end : g, alone);
}

typedef struct {
    const brio_topology *t;
    bool alone; /* only one thread joins */
    size_t boundary, nonmanifold, flipped;
} edge_count;

/* Joins and counts at half-edges. The last half-edge of each edge represents the edge. */
static void join_at_half_edges(void *user, size_t begin, size_t end, int thread) {
    edge_count *c = user;
    const brio_topology *t = c->t;
    const uint32_t *v = t->mesh->face_vertices;
    size_t boundary = 0, nonmanifold = 0, flipped = 0;
    (void)thread;
    for (uint32_t h = (uint32_t)begin; h < end; h++) {
        uint32_t g = t->ring[h];
        bool last = g <= h, two = g != h && t->ring[g] == h;
        if (g != h && !(two && last)) brio_unite(t->patch, brio_face_at(t, h), brio_face_at(t, g), c->alone);
        if (two && last) join_corners(t, g, h, c->alone);
        if (!last || !brio_counts_edge(t, h)) continue;
        boundary += g == h;
        nonmanifold += g != h && !two;
        flipped += two && v[g] == v[h];
    }
    add_relaxed(&c->boundary, boundary);
    add_relaxed(&c->nonmanifold, nonmanifold);
    add_relaxed(&c->flipped, flipped);
}

brio_status brio_topology_join(const brio_topology *t, brio_edge_faults *out) {
    int threads = brio_threads(t->ctx, t->corners, ITEMS_A_THREAD);
    edge_count c = {.t = t, .alone = threads == 1};
    brio_status status = brio_for(t->ctx, threads, t->corners, join_at_half_edges, &c);
    *out = (brio_edge_faults){c.boundary, c.nonmanifold, c.flipped};
    return status;
}

/* --- degenerate faces --- */

/* Sets a state of a vertex. Several threads may set states; the states are read after all threads have ended. */
static void mark(const brio_topology *t, uint32_t v, uint8_t state) {
    __atomic_fetch_or(&t->vertex[v], state, __ATOMIC_RELAXED);
}

/* Returns whether a face has fewer than three corners or a vertex twice, and marks such vertices. Compares each corner
 * with all corners before it. */
static bool mark_small_face(const brio_topology *t, size_t f) {
    const uint32_t *v = t->mesh->face_vertices + t->mesh->face_offsets[f];
    size_t count = (size_t)(t->mesh->face_offsets[f + 1] - t->mesh->face_offsets[f]);
    bool bad = count < 3;
    for (size_t i = 0; i < count; i++) {
        bool twice = false;
        for (size_t j = 0; j < i; j++) twice |= v[i] == v[j];
        if (twice || count < 3) mark(t, v[i], BRIO_VERTEX_IN_DEGENERATE_FACE);
        bad |= twice;
    }
    return bad;
}

/* Does what mark_small_face does, in linear time: last_face holds the last face of each vertex, plus 1. */
static bool mark_large_face(const brio_topology *t, size_t f, uint32_t *last_face) {
    const uint64_t *offsets = t->mesh->face_offsets;
    bool bad = false;
    for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        bool twice = last_face[v] == f + 1;
        if (twice) mark(t, v, BRIO_VERTEX_IN_DEGENERATE_FACE);
        bad |= twice;
        last_face[v] = (uint32_t)f + 1;
    }
    return bad;
}

enum { SMALL = 32 }; /* most corners of a face that mark_small_face handles; chosen */

typedef struct {
    const brio_topology *t;
    size_t small, bad, thin; /* thin: of fewer than three corners */
} face_count;

static void mark_small_faces(void *user, size_t begin, size_t end, int thread) {
    face_count *c = user;
    const uint64_t *offsets = c->t->mesh->face_offsets;
    size_t small = 0, bad = 0, thin = 0;
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        if (offsets[f + 1] - offsets[f] > SMALL) continue;
        small++;
        thin += offsets[f + 1] - offsets[f] < 3;
        bad += mark_small_face(c->t, f);
    }
    add_relaxed(&c->small, small);
    add_relaxed(&c->bad, bad);
    add_relaxed(&c->thin, thin);
}

brio_status brio_topology_degenerate(const brio_topology *t, size_t *degenerate, size_t *thin) {
    brio_status status = BRIO_OK;
    const uint64_t *offsets = t->mesh->face_offsets;
    size_t num_faces = t->mesh->num_faces;
    uint32_t *last_face = NULL;
    face_count c = {t, 0, 0, 0};
    BRIO_TRY(for_each(t, num_faces, mark_small_faces, &c));
    bool large = c.small < num_faces;
    if (large) BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, last_face, t->mesh->num_vertices));
    for (size_t f = 0; large && f < num_faces; f++)
        if (offsets[f + 1] - offsets[f] > SMALL) c.bad += mark_large_face(t, f, last_face);
    *degenerate = c.bad;
    *thin = c.thin;
done:
    brio_release(t->ctx, last_face);
    return status;
}

/* --- components --- */

/* Adds to the counts of components. Collects one run of equal components at a time, so that threads seldom touch the
 * same counts. The counts are read after all threads have ended. */
typedef struct {
    brio_component *components, run;
    uint32_t number;
} tally;

static void tally_end(tally *t) {
    brio_component *c = &t->components[t->number];
    if (t->run.faces) __atomic_fetch_add(&c->faces, t->run.faces, __ATOMIC_RELAXED);
    if (t->run.edges) __atomic_fetch_add(&c->edges, t->run.edges, __ATOMIC_RELAXED);
    if (t->run.vertices) __atomic_fetch_add(&c->vertices, t->run.vertices, __ATOMIC_RELAXED);
    t->run = (brio_component){0, 0, 0, 0};
}

static brio_component *tally_of(tally *t, uint32_t number) {
    if (number != t->number) tally_end(t);
    t->number = number;
    return &t->run;
}

typedef struct {
    const brio_topology *t;
    const uint32_t *number;
    uint32_t *root;
    brio_component *components;
    const uint8_t *skipped;
    bool pinched; /* some vertex has two fans */
} component_count;

/* Sets root[f] to the root of face f. The parent links in the union-find are not enough: a thread that halves a path
 * may replace a link to a root by an older link. */
static void find_roots(void *user, size_t begin, size_t end, int thread) {
    const component_count *c = user;
    (void)thread;
    for (size_t f = begin; f < end; f++) c->root[f] = brio_find(c->t->patch, (uint32_t)f);
}

/* Turns roots into numbers of patches. A root is the first face of its patch, so it is numbered before any other face
 * of the patch. */
brio_status brio_topology_patches(const brio_topology *t, uint32_t *number, size_t *count) {
    component_count c = {.t = t, .root = number};
    size_t num_faces = t->mesh->num_faces;
    *count = 0;
    BRIO_FORWARD(for_each(t, num_faces, find_roots, &c));
    for (size_t f = 0; f < num_faces; f++) {
        number[f] = number[f] == f ? (uint32_t)(*count)++ : number[number[f]];
        BRIO_FORWARD(brio_look(t->ctx, 1));
    }
    return BRIO_OK;
}

static void count_faces(void *user, size_t begin, size_t end, int thread) {
    const component_count *c = user;
    tally own = {c->components, {0, 0, 0, 0}, 0};
    (void)thread;
    for (size_t f = begin; f < end; f++) tally_of(&own, c->number[f])->faces++;
    tally_end(&own);
}

brio_status brio_topology_count_faces(const brio_topology *t, const uint32_t *number, brio_component *components) {
    component_count c = {.t = t, .number = number, .components = components};
    return for_each(t, t->mesh->num_faces, count_faces, &c);
}

/* Counts the edges at their last half-edges. */
static void count_edges(void *user, size_t begin, size_t end, int thread) {
    const component_count *c = user;
    const brio_topology *t = c->t;
    tally own = {c->components, {0, 0, 0, 0}, 0};
    (void)thread;
    for (uint32_t h = (uint32_t)begin; h < end; h++)
        if (t->ring[h] <= h && brio_counts_edge(t, h)) tally_of(&own, c->number[brio_face_at(t, h)])->edges++;
    tally_end(&own);
}

/* Counts one vertex for each fan, in the component of the fan. Sets `pinched` when some vertex has two fans. */
static void count_fans(void *user, size_t begin, size_t end, int thread) {
    component_count *c = user;
    const brio_topology *t = c->t;
    tally own = {c->components, {0, 0, 0, 0}, 0};
    bool pinched = false;
    (void)thread;
    for (uint32_t h = (uint32_t)begin; h < end; h++) {
        if (t->fan[h] != h || !brio_starts_own(t, h) || (c->skipped && c->skipped[h])) continue;
        uint8_t *state = &t->vertex[t->mesh->face_vertices[h]];
        if (__atomic_fetch_or(state, BRIO_VERTEX_SEEN, __ATOMIC_RELAXED) & BRIO_VERTEX_SEEN) {
            __atomic_fetch_or(state, BRIO_VERTEX_TWO_FANS, __ATOMIC_RELAXED);
            pinched = true;
        }
        tally_of(&own, c->number[brio_face_at(t, h)])->vertices++;
    }
    tally_end(&own);
    if (pinched) __atomic_store_n(&c->pinched, true, __ATOMIC_RELAXED);
}

brio_status brio_topology_count(const brio_topology *t, const uint32_t *number, brio_component *components,
                                const uint8_t *skipped, bool *pinched) {
    component_count c = {.t = t, .number = number, .components = components, .skipped = skipped};
    BRIO_FORWARD(for_each(t, t->corners, count_edges, &c));
    BRIO_FORWARD(for_each(t, t->corners, count_fans, &c));
    *pinched = c.pinched;
    return BRIO_OK;
}

size_t brio_topology_used(const brio_topology *t) {
    size_t count = 0;
    for (size_t h = 0; h < t->corners; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        count += brio_is_own(t, v) && !(t->vertex[v] & BRIO_VERTEX_USED);
        t->vertex[v] |= BRIO_VERTEX_USED;
    }
    return count;
}

brio_status brio_topology_pinched(const brio_topology *t, const uint32_t *number, uint64_t **fans, size_t *count) {
    size_t capacity = 0;
    *fans = NULL;
    *count = 0;
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        BRIO_FORWARD(brio_look(t->ctx, 1));
        if (t->fan[h] != h || !(t->vertex[v] & BRIO_VERTEX_TWO_FANS) || !brio_is_own(t, v)) continue;
        BRIO_FORWARD(BRIO_RESERVE(t->ctx, *fans, capacity, *count + 1));
        (*fans)[(*count)++] = (uint64_t)v << 32 | number[brio_face_at(t, h)];
    }
    return brio_sort_many_keys(t->ctx, *fans, *count);
}

brio_status brio_topology_join_loops(const brio_topology *t) {
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h], next = brio_next_corner(t, h);
        if (g == h && brio_starts_own(t, h) && brio_starts_own(t, next)) brio_unite(t->fan, h, next, true);
        if (g > h && t->ring[g] != h) join_corners(t, h, g, true);
        BRIO_FORWARD(brio_look(t->ctx, 1));
    }
    return BRIO_OK;
}

typedef struct {
    const brio_topology *t;
    size_t count;
} vertex_count;

static void count_bad_vertices(void *user, size_t begin, size_t end, int thread) {
    vertex_count *c = user;
    size_t count = 0;
    (void)thread;
    for (size_t v = begin; v < end; v++)
        count += brio_is_own(c->t, (uint32_t)v) &&
                 (c->t->vertex[v] & (BRIO_VERTEX_TWO_FANS | BRIO_VERTEX_IN_DEGENERATE_FACE)) != 0;
    add_relaxed(&c->count, count);
}

brio_status brio_topology_bad_vertices(const brio_topology *t, size_t *count) {
    vertex_count c = {t, 0};
    brio_status status = for_each(t, t->mesh->num_vertices, count_bad_vertices, &c);
    *count = c.count;
    return status;
}

/* --- genera --- */

int64_t brio_component_genus(const brio_component *c) {
    int64_t twice = 2 - (c->vertices - c->edges + c->faces) - c->loops;
    return twice >= 0 ? twice / 2 : -((1 - twice) / 2);
}

static int compare_components(uint32_t i, uint32_t j, const void *user) {
    const brio_component *a = (const brio_component *)user + i, *b = (const brio_component *)user + j;
    if (a->faces != b->faces) return a->faces > b->faces ? -1 : 1;
    int64_t g = brio_component_genus(a), h = brio_component_genus(b);
    return (g < h) - (g > h);
}

brio_status brio_components_list(brio_context *ctx, const brio_component *components, size_t count,
                                 brio_certificate *out) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    size_t listed = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, order, count));
    for (size_t i = 0; i < count; i++)
        if (components[i].faces) order[listed++] = (uint32_t)i;
    BRIO_TRY(BRIO_ALLOC(ctx, out->genera, listed));
    BRIO_TRY(brio_sort_many_indices(ctx, order, listed, compare_components, components));
    for (size_t i = 0; i < listed; i++) {
        const brio_component *c = &components[order[i]];
        out->genera[i] = brio_component_genus(c);
        out->genus += out->genera[i];
        out->boundary_loops += (size_t)c->loops;
    }
    out->components = listed;
done:
    brio_release(ctx, order);
    return status;
}
