/* The certificate of a polygon mesh: what connectivity alone proves about a surface.
 *
 * edge_rings links the half-edges of each edge into a ring. Two union-finds then run over the rings. The first joins
 * faces across every edge; its sets are the components. The second joins corners at both ends of every edge of two
 * faces; its sets are the fans. A vertex is manifold when its corners form one fan. A component has the vertices and
 * edges that its faces use; a vertex in several components counts once in each.
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
 * Threads share the work. The result does not depend on their order: a root is the first element of its set, counts
 * are integers, and areas and volumes are summed in fixed parts. */
#include "base/float_state.h"
#include "base/scale.h"
#include "base/versioned.h"
#include "base/sort.h"
#include "base/team.h"
#include "mesh/edge_rings.h"
#include "base/union_find.h"
#include "base/vector.h"
#include "mesh/extent.h"
#include <math.h>

/* Faces, corners or vertices: a pass takes 1 to 25 ns an item. */
enum { ITEMS_A_THREAD = 1 << 15 };

typedef struct {
    brio_context *ctx;
    const brio_mesh *mesh;
    size_t corners;
    uint32_t *ring;    /* #corners: edge rings (edge_rings.h) */
    uint32_t *face_of; /* #corners; NULL where all faces are triangles */
    uint32_t *fan;     /* #corners: union-find of the corners */
    uint32_t *patch;   /* #F: union-find of the faces */
    uint8_t *vertex;   /* #V: bits of vertex_state */
} topology;

enum vertex_state { VERTEX_SEEN = 1, VERTEX_TWO_FANS = 2, VERTEX_IN_DEGENERATE_FACE = 4 };

typedef struct {
    int64_t faces, edges, vertices, loops;
} component;

/* --- connectivity --- */

static inline uint32_t face_at(const topology *t, uint32_t h) {
    return t->face_of ? t->face_of[h] : h / 3;
}

static uint32_t next_corner(const topology *t, uint32_t h) {
    const uint64_t *offsets = t->mesh->face_offsets;
    uint32_t f = face_at(t, h);
    return h + 1 < offsets[f + 1] ? h + 1 : (uint32_t)offsets[f];
}

/* Calls body on parts of the range 0 to n - 1. */
static brio_status for_each(const topology *t, size_t n, brio_part_fn body, void *user) {
    return brio_for(t->ctx, brio_threads(t->ctx, n, ITEMS_A_THREAD), n, body, user);
}

static void topology_free(brio_context *ctx, topology *t) {
    brio_release(ctx, t->ring);
    brio_release(ctx, t->face_of);
    brio_release(ctx, t->fan);
    brio_release(ctx, t->patch);
    brio_release(ctx, t->vertex);
}

static bool is_of_triangles(const brio_mesh *mesh) {
    bool all = true;
    for (size_t f = 0; f < mesh->num_faces && all; f++) all = mesh->face_offsets[f + 1] == 3 * (f + 1);
    return all;
}

/* Makes one set of each face, and one of each corner of these faces. */
static void make_sets(void *user, size_t begin, size_t end, int thread) {
    const topology *t = user;
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

/* Allocates and fills a topology. On failure the caller frees it. */
static brio_status topology_new(brio_context *ctx, const brio_mesh *mesh, topology *t) {
    *t = (topology){.ctx = ctx, .mesh = mesh, .corners = mesh->num_faces ? mesh->face_offsets[mesh->num_faces] : 0};
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
static void join_corners(const topology *t, uint32_t h, uint32_t g, bool alone) {
    const uint32_t *v = t->mesh->face_vertices;
    uint32_t h_end = next_corner(t, h), g_end = next_corner(t, g);
    bool same_way = v[h] == v[g];
    brio_unite(t->fan, h, same_way ? g : g_end, alone);
    brio_unite(t->fan, h_end, same_way ? g_end : g, alone);
}

/* Counts of the edges that a closed oriented manifold does not have. */
typedef struct {
    const topology *t;
    bool alone; /* only one thread joins */
    size_t boundary, nonmanifold, flipped;
} edge_count;

/* Joins and counts at half-edges. The last half-edge of each edge represents the edge. */
static void join_at_half_edges(void *user, size_t begin, size_t end, int thread) {
    edge_count *c = user;
    const topology *t = c->t;
    const uint32_t *v = t->mesh->face_vertices;
    size_t boundary = 0, nonmanifold = 0, flipped = 0;
    (void)thread;
    for (uint32_t h = (uint32_t)begin; h < end; h++) {
        uint32_t g = t->ring[h];
        bool last = g <= h, two = g != h && t->ring[g] == h;
        if (g != h && !(two && last)) brio_unite(t->patch, face_at(t, h), face_at(t, g), c->alone);
        if (!last) continue;
        boundary += g == h;
        nonmanifold += g != h && !two;
        flipped += two && v[g] == v[h];
        if (two) join_corners(t, g, h, c->alone);
    }
    add_relaxed(&c->boundary, boundary);
    add_relaxed(&c->nonmanifold, nonmanifold);
    add_relaxed(&c->flipped, flipped);
}

/* Joins the faces across every edge, and the corners at both ends of every edge of two faces. */
static brio_status join_across_edges(const topology *t, brio_certificate *out) {
    int threads = brio_threads(t->ctx, t->corners, ITEMS_A_THREAD);
    edge_count c = {.t = t, .alone = threads == 1};
    brio_status status = brio_for(t->ctx, threads, t->corners, join_at_half_edges, &c);
    out->boundary_edges = c.boundary;
    out->nonmanifold_edges = c.nonmanifold;
    out->flipped_edges = c.flipped;
    return status;
}

/* --- degenerate faces --- */

/* Sets a state of a vertex. Several threads may set states; the states are read after all threads have ended. */
static void mark(const topology *t, uint32_t v, uint8_t state) {
    __atomic_fetch_or(&t->vertex[v], state, __ATOMIC_RELAXED);
}

/* Returns whether a face has fewer than three corners or a vertex twice, and marks such vertices. Compares each corner
 * with all corners before it. */
static bool mark_small_face(const topology *t, size_t f) {
    const uint32_t *v = t->mesh->face_vertices + t->mesh->face_offsets[f];
    size_t count = (size_t)(t->mesh->face_offsets[f + 1] - t->mesh->face_offsets[f]);
    bool bad = count < 3;
    for (size_t i = 0; i < count; i++) {
        bool twice = false;
        for (size_t j = 0; j < i; j++) twice |= v[i] == v[j];
        if (twice || count < 3) mark(t, v[i], VERTEX_IN_DEGENERATE_FACE);
        bad |= twice;
    }
    return bad;
}

/* Does what mark_small_face does, in linear time: last_face holds the last face of each vertex, plus 1. */
static bool mark_large_face(const topology *t, size_t f, uint32_t *last_face) {
    const uint64_t *offsets = t->mesh->face_offsets;
    bool bad = false;
    for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        bool twice = last_face[v] == f + 1;
        if (twice) mark(t, v, VERTEX_IN_DEGENERATE_FACE);
        bad |= twice;
        last_face[v] = (uint32_t)f + 1;
    }
    return bad;
}

enum { SMALL = 32 }; /* most corners of a face that mark_small_face handles; chosen */

typedef struct {
    const topology *t;
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

/* Marks the vertices of degenerate faces. Counts the degenerate faces, including faces without corners, and those of
 * fewer than three corners. */
static brio_status mark_degenerate_faces(const topology *t, size_t *degenerate, size_t *thin) {
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
    component *components, run;
    uint32_t number;
} tally;

static void tally_end(tally *t) {
    component *c = &t->components[t->number];
    if (t->run.faces) __atomic_fetch_add(&c->faces, t->run.faces, __ATOMIC_RELAXED);
    if (t->run.edges) __atomic_fetch_add(&c->edges, t->run.edges, __ATOMIC_RELAXED);
    if (t->run.vertices) __atomic_fetch_add(&c->vertices, t->run.vertices, __ATOMIC_RELAXED);
    t->run = (component){0, 0, 0, 0};
}

static component *tally_of(tally *t, uint32_t number) {
    if (number != t->number) tally_end(t);
    t->number = number;
    return &t->run;
}

typedef struct {
    const topology *t;
    uint32_t *number;      /* component of each face, numbered in the order of the components' first faces */
    component *components; /* counts of faces, edges, vertices and loops of each component */
    size_t count;          /* number of components */
    bool pinched;          /* some vertex has two fans */
} component_count;

/* Sets number[f] to the root of face f. The parent links in the union-find are not enough: a thread that halves a path
 * may replace a link to a root by an older link. */
static void find_roots(void *user, size_t begin, size_t end, int thread) {
    const component_count *c = user;
    (void)thread;
    for (size_t f = begin; f < end; f++) c->number[f] = brio_find(c->t->patch, (uint32_t)f);
}

/* Turns roots into component numbers. A root is the first face of its component, so it is numbered before any other
 * face of the component. */
static brio_status number_components(component_count *c) {
    size_t num_faces = c->t->mesh->num_faces;
    BRIO_FORWARD(for_each(c->t, num_faces, find_roots, c));
    for (size_t f = 0; f < num_faces; f++) {
        c->number[f] = c->number[f] == f ? (uint32_t)c->count++ : c->number[c->number[f]];
        BRIO_FORWARD(brio_look(c->t->ctx, 1));
    }
    return BRIO_OK;
}

/* Counts faces and edges of each component. */
static void count_faces(void *user, size_t begin, size_t end, int thread) {
    const component_count *c = user;
    const topology *t = c->t;
    tally own = {c->components, {0, 0, 0, 0}, 0};
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        component *run = tally_of(&own, c->number[f]);
        run->faces++;
        for (uint64_t h = t->mesh->face_offsets[f]; h < t->mesh->face_offsets[f + 1]; h++)
            run->edges += t->ring[h] <= h;
    }
    tally_end(&own);
}

/* Counts one vertex for each fan, in the component of the fan. Sets `pinched` when some vertex has two fans. */
static void count_fans(void *user, size_t begin, size_t end, int thread) {
    component_count *c = user;
    const topology *t = c->t;
    tally own = {c->components, {0, 0, 0, 0}, 0};
    bool pinched = false;
    (void)thread;
    for (uint32_t h = (uint32_t)begin; h < end; h++) {
        if (t->fan[h] != h) continue;
        uint8_t *state = &t->vertex[t->mesh->face_vertices[h]];
        if (__atomic_fetch_or(state, VERTEX_SEEN, __ATOMIC_RELAXED) & VERTEX_SEEN) {
            __atomic_fetch_or(state, VERTEX_TWO_FANS, __ATOMIC_RELAXED);
            pinched = true;
        }
        tally_of(&own, c->number[face_at(t, h)])->vertices++;
    }
    tally_end(&own);
    if (pinched) __atomic_store_n(&c->pinched, true, __ATOMIC_RELAXED);
}

/* Corrects what count_fans counted twice: several fans of one vertex in one component count as one vertex. */
static brio_status recount_pinched_vertices(const component_count *c) {
    brio_status status = BRIO_OK;
    const topology *t = c->t;
    uint64_t *fans = NULL; /* pairs (vertex, component) */
    size_t count = 0, capacity = 0;
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        BRIO_TRY(brio_look(t->ctx, 1));
        if (t->fan[h] != h || !(t->vertex[v] & VERTEX_TWO_FANS)) continue;
        BRIO_TRY(BRIO_RESERVE(t->ctx, fans, capacity, count + 1));
        fans[count++] = (uint64_t)v << 32 | c->number[face_at(t, h)];
    }
    BRIO_TRY(brio_sort_many_keys(t->ctx, fans, count));
    for (size_t i = 1; i < count; i++)
        if (fans[i] == fans[i - 1]) c->components[(uint32_t)fans[i]].vertices--;
done:
    brio_release(t->ctx, fans);
    return status;
}

/* Joins fans across edges of more than two faces, and at the two ends of each boundary edge. Every resulting set with
 * a boundary edge is a boundary loop. Afterwards t->fan no longer describes the fans. */
static brio_status count_loops(const component_count *c) {
    brio_status status = BRIO_OK;
    const topology *t = c->t;
    uint8_t *counted = NULL; /* 1 at a root whose loop has been counted */
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, counted, t->corners));
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h];
        if (g == h) brio_unite(t->fan, h, next_corner(t, h), true);
        if (g > h && t->ring[g] != h) join_corners(t, h, g, true);
        BRIO_TRY(brio_look(t->ctx, 1));
    }
    for (uint32_t h = 0; h < t->corners; h++) {
        BRIO_TRY(brio_look(t->ctx, 1));
        if (t->ring[h] != h) continue;
        uint32_t root = brio_find(t->fan, h);
        if (!counted[root]) c->components[c->number[face_at(t, h)]].loops++;
        counted[root] = 1;
    }
done:
    brio_release(t->ctx, counted);
    return status;
}

static int64_t genus_of(const component *c) {
    int64_t twice = 2 - (c->vertices - c->edges + c->faces) - c->loops;
    return twice >= 0 ? twice / 2 : -((1 - twice) / 2);
}

/* Writes the genera, the component with the most faces first. */
static brio_status list_genera(brio_context *ctx, const component *components, size_t count, brio_certificate *out) {
    brio_status status = BRIO_OK;
    uint64_t *order = NULL; /* pairs (UINT32_MAX - number of faces, component) */
    BRIO_TRY(BRIO_ALLOC(ctx, order, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->genera, count));
    for (size_t i = 0; i < count; i++) order[i] = (uint64_t)(UINT32_MAX - components[i].faces) << 32 | i;
    BRIO_TRY(brio_sort_many_keys(ctx, order, count));
    for (size_t i = 0; i < count; i++) {
        const component *c = &components[(uint32_t)order[i]];
        out->genera[i] = genus_of(c);
        out->genus += out->genera[i];
        out->boundary_loops += (size_t)c->loops;
    }
    out->components = count;
done:
    brio_release(ctx, order);
    return status;
}

static brio_status certify_components(const topology *t, brio_certificate *out) {
    brio_status status = BRIO_OK;
    component_count c = {.t = t};
    BRIO_TRY(BRIO_ALLOC(t->ctx, c.number, t->mesh->num_faces));
    BRIO_TRY(number_components(&c));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, c.components, c.count));
    BRIO_TRY(for_each(t, t->mesh->num_faces, count_faces, &c));
    BRIO_TRY(for_each(t, t->corners, count_fans, &c));
    if (c.pinched) BRIO_TRY(recount_pinched_vertices(&c));
    if (out->boundary_edges) BRIO_TRY(count_loops(&c));
    BRIO_TRY(list_genera(t->ctx, c.components, c.count, out));
done:
    brio_release(t->ctx, c.components);
    brio_release(t->ctx, c.number);
    return status;
}

typedef struct {
    const topology *t;
    size_t count;
} vertex_count;

static void count_nonmanifold_vertices(void *user, size_t begin, size_t end, int thread) {
    vertex_count *c = user;
    size_t count = 0;
    (void)thread;
    for (size_t v = begin; v < end; v++)
        count += (c->t->vertex[v] & (VERTEX_TWO_FANS | VERTEX_IN_DEGENERATE_FACE)) != 0;
    add_relaxed(&c->count, count);
}

static brio_status certify_topology(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    brio_status status = BRIO_OK;
    topology t = {0};
    vertex_count nonmanifold = {&t, 0};
    size_t degenerate_faces, thin_faces;
    BRIO_TRY(topology_new(ctx, mesh, &t));
    BRIO_TRY(mark_degenerate_faces(&t, &degenerate_faces, &thin_faces));
    BRIO_TRY(join_across_edges(&t, out));
    BRIO_TRY(certify_components(&t, out));
    BRIO_TRY(for_each(&t, mesh->num_vertices, count_nonmanifold_vertices, &nonmanifold));
    out->nonmanifold_vertices = nonmanifold.count;
    out->closed = t.corners > 0 && !out->boundary_edges && !out->nonmanifold_edges && !thin_faces;
    out->manifold = !out->nonmanifold_edges && !out->nonmanifold_vertices && !degenerate_faces;
    out->oriented = !out->flipped_edges;
done:
    topology_free(ctx, &t);
    return status;
}

/* --- measure --- */

enum {
    PARTS = 256
}; /* parts of the faces; a fixed number, so that rounding does not depend on the number of threads */

typedef struct {
    double low[3], high[3], area, volume;
} measure;

typedef struct {
    const brio_mesh *mesh;
    double centre[3], scale; /* the centre is scaled, too */
    measure part[PARTS];
} measures;

static void box_of_part(const brio_mesh *mesh, int part, measure *m) {
    uint64_t corners = mesh->face_offsets[mesh->num_faces];
    for (int k = 0; k < 3; k++) m->low[k] = INFINITY, m->high[k] = -INFINITY;
    brio_box_add_corners(mesh, brio_part(corners, part, PARTS), brio_part(corners, part + 1, PARTS), m->low, m->high);
}

static void scale_vertex(const measures *all, uint32_t vertex, double *x) {
    for (size_t k = 0; k < 3; k++) x[k] = all->mesh->vertices[3 * (size_t)vertex + k] * all->scale;
}

/* Adds the area and volume of a face, scaled, cut into a fan of triangles from its first corner. */
static void measure_face(const measures *all, size_t f, measure *m) {
    const brio_mesh *mesh = all->mesh;
    const uint32_t *corners = mesh->face_vertices + mesh->face_offsets[f];
    const double *centre = all->centre;
    uint64_t count = mesh->face_offsets[f + 1] - mesh->face_offsets[f];
    for (uint64_t i = 2; i < count; i++) {
        double a[3], b[3], c[3];
        scale_vertex(all, corners[0], a);
        scale_vertex(all, corners[i - 1], b);
        scale_vertex(all, corners[i], c);
        double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        m->area += brio_length(n) / 2;
        m->volume += ((a[0] - centre[0]) * n[0] + (a[1] - centre[1]) * n[1] + (a[2] - centre[2]) * n[2]) / 6;
    }
}

static void find_boxes(void *user, size_t begin, size_t end, int thread) {
    measures *m = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) box_of_part(m->mesh, (int)i, &m->part[i]);
}

static void measure_parts(void *user, size_t begin, size_t end, int thread) {
    measures *m = user;
    size_t num_faces = m->mesh->num_faces;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        for (size_t f = brio_part(num_faces, (int)i, PARTS); f < brio_part(num_faces, (int)i + 1, PARTS); f++)
            measure_face(m, f, &m->part[i]);
}

/* Sums area and volume. Volumes are relative to the centre of the box of the used vertices, so that a surface far from
 * the origin loses no digits. */
static brio_status measure_faces(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    measures m = {.mesh = mesh};
    if (!mesh->num_faces || !mesh->face_offsets[mesh->num_faces]) return BRIO_OK;
    int threads = brio_threads(ctx, (size_t)mesh->face_offsets[mesh->num_faces], ITEMS_A_THREAD);
    BRIO_FORWARD(brio_for_chunks(ctx, threads, PARTS, 1, find_boxes, &m));
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < 3 * PARTS; i++) {
        low[i % 3] = fmin(low[i % 3], m.part[i / 3].low[i % 3]);
        high[i % 3] = fmax(high[i % 3], m.part[i / 3].high[i % 3]);
    }
    int exponent = brio_box_exponent(low, high); /* so that no square overflows or underflows */
    m.scale = brio_power_of_two(-exponent);
    for (int k = 0; k < 3; k++) m.centre[k] = (0.5 * low[k] + 0.5 * high[k]) * m.scale;
    BRIO_FORWARD(brio_for_chunks(ctx, threads, PARTS, 1, measure_parts, &m));
    for (int i = 0; i < PARTS; i++) out->area += m.part[i].area, out->volume += m.part[i].volume;
    out->area = ldexp(out->area, 2 * exponent);
    out->volume = ldexp(out->volume, 3 * exponent);
    return BRIO_OK;
}

brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_certificate c = {.size = sizeof c, .self_intersections = -1, .context = ctx};
    BRIO_TRY(BRIO_CHECK_OWNER(ctx, brio_certificate, out, genera));
    BRIO_GIVE(brio_certificate, out, &(brio_certificate){0});
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(certify_topology(ctx, mesh, &c));
    BRIO_TRY(measure_faces(ctx, mesh, &c));
    BRIO_GIVE(brio_certificate, out, &c);
done:
    if (status != BRIO_OK) brio_certificate_free(&c);
    return status;
}

void brio_certificate_free(brio_certificate *certificate) {
    if (!certificate || !BRIO_OWNS(brio_certificate, certificate, genera) || !certificate->context) return;
    brio_release(certificate->context, certificate->genera);
    BRIO_GIVE(brio_certificate, certificate, &(brio_certificate){0});
}
