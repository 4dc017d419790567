/* The certificate of a polygon mesh: what connectivity alone says of a surface.
 *
 * The half-edges of each edge are linked into rings (edge_rings). Two union-finds run over the rings: of the faces,
 * joined across edges, whose sets are the components; and of the corners, joined at both ends of every edge of two
 * faces, whose sets are the fans: a vertex is manifold when its corners form one fan. A component has the vertices and
 * edges its faces use; a vertex in several components counts once in each.
 *
 * Where the surface is not a manifold, these conventions hold. An edge joins all its faces into one component, however
 * many they are; but only an edge of two faces continues a fan. A boundary loop is a set of boundary edges connected
 * through fans and across edges of more than two faces: a cycle where the surface is manifold, while two loops that
 * touch where two fans share a vertex stay two. A face with fewer than three corners, or with a vertex twice, makes
 * each of its vertices (each it has twice) non-manifold. An odd 2 - chi - loops, as of a Moebius strip, is rounded
 * down.
 *
 * Threads share the work. Nothing depends on its order: a root is the first element of its set, counts are whole
 * numbers, and areas and volumes are summed in parts of their own. */
#include "base/float_state.h"
#include "base/parallel.h"
#include "base/sort.h"
#include "surface/edge_rings.h"
#include "surface/union_find.h"
#include <math.h>

typedef struct {
    const brio_mesh *mesh;
    int threads;
    size_t corners;
    uint32_t *ring;    /* #corners: edge rings */
    uint32_t *face_of; /* #corners; NULL where all faces are triangles, one after the other */
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

/* On failure the caller frees what there is. */
static brio_status topology_new(brio_context *ctx, const brio_mesh *mesh, topology *t) {
    brio_status status = BRIO_OK;
    *t = (topology){.mesh = mesh,
                    .threads = brio_context_threads(ctx),
                    .corners = mesh->num_faces ? mesh->face_offsets[mesh->num_faces] : 0};
    BRIO_TRY(brio_edge_rings(ctx, mesh, &t->ring));
    if (!is_of_triangles(mesh)) BRIO_TRY(BRIO_ALLOC(ctx, t->face_of, t->corners));
    BRIO_TRY(BRIO_ALLOC(ctx, t->fan, t->corners));
    BRIO_TRY(BRIO_ALLOC(ctx, t->patch, mesh->num_faces));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t->vertex, mesh->num_vertices));
    BRIO_OMP(parallel for num_threads(t->threads))
    for (size_t f = 0; f < mesh->num_faces; f++) {
        t->patch[f] = (uint32_t)f;
        for (uint64_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++) {
            if (t->face_of) t->face_of[h] = (uint32_t)f;
            t->fan[h] = (uint32_t)h;
        }
    }
done:
    return status;
}

/* Joins the corners at either end of the edge of the half-edges h and g. */
static void join_corners(topology *t, uint32_t h, uint32_t g, bool alone) {
    const uint32_t *v = t->mesh->face_vertices;
    uint32_t h_end = next_corner(t, h), g_end = next_corner(t, g);
    bool same_way = v[h] == v[g];
    brio_unite(t->fan, h, same_way ? g : g_end, alone);
    brio_unite(t->fan, h_end, same_way ? g_end : g, alone);
}

/* Joins the faces across every edge, and the corners at either end of the edges of two faces; counts the edges that a
 * closed oriented manifold does not have. Of each edge's half-edges the last one speaks for it. */
static void join_across_edges(topology *t, brio_certificate *out) {
    const uint32_t *v = t->mesh->face_vertices;
    bool alone = t->threads == 1;
    size_t boundary = 0, nonmanifold = 0, flipped = 0;
    BRIO_OMP(parallel for num_threads(t->threads) reduction(+ : boundary, nonmanifold, flipped))
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h];
        bool last = g <= h, two = g != h && t->ring[g] == h;
        if (g != h && !(two && last)) brio_unite(t->patch, face_at(t, h), face_at(t, g), alone);
        if (!last) continue;
        boundary += g == h;
        nonmanifold += g != h && !two;
        flipped += two && v[g] == v[h];
        if (two) join_corners(t, g, h, alone);
    }
    out->boundary_edges = boundary;
    out->nonmanifold_edges = nonmanifold;
    out->flipped_edges = flipped;
}

/* --- degenerate faces --- */

static void mark(topology *t, uint32_t v, uint8_t state) {
    __atomic_fetch_or(&t->vertex[v], state, __ATOMIC_RELAXED);
}

/* Whether a face has fewer than three corners, or a vertex twice; marks such vertices. Each corner is held against all
 * before it. */
static bool mark_small_face(topology *t, size_t f) {
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

/* The same with the last face of each vertex, plus 1. */
static bool mark_large_face(topology *t, size_t f, uint32_t *last_face) {
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

/* Marks the vertices of degenerate faces; counts these faces, those without any corner included. */
static brio_status mark_degenerate_faces(brio_context *ctx, topology *t, size_t *degenerate) {
    enum { SMALL = 32 };
    brio_status status = BRIO_OK;
    const uint64_t *offsets = t->mesh->face_offsets;
    uint32_t *last_face = NULL;
    size_t small = 0, large = 0, bad = 0;
    BRIO_OMP(parallel for num_threads(t->threads) reduction(+ : small, bad))
    for (size_t f = 0; f < t->mesh->num_faces; f++) {
        if (offsets[f + 1] - offsets[f] > SMALL) continue;
        small++;
        bad += mark_small_face(t, f);
    }
    large = t->mesh->num_faces - small;
    if (large) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, last_face, t->mesh->num_vertices));
    for (size_t f = 0; large && f < t->mesh->num_faces; f++)
        if (offsets[f + 1] - offsets[f] > SMALL) bad += mark_large_face(t, f, last_face);
    *degenerate = bad;
done:
    brio_release(ctx, last_face);
    return status;
}

/* --- components --- */

/* Adds to the counts of components: one run of equals at a time, so that threads seldom meet. */
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

/* Numbers the components in the order of their first faces: number[f] becomes that of face f. */
static size_t number_components(topology *t, uint32_t *number) {
    size_t num_faces = t->mesh->num_faces, count = 0;
    BRIO_OMP(parallel for num_threads(t->threads))
    for (uint32_t f = 0; f < num_faces; f++) {
        uint32_t root = brio_find(t->patch, f);
        __atomic_store_n(&t->patch[f], root, __ATOMIC_RELAXED);
    }
    for (uint32_t f = 0; f < num_faces; f++)
        if (t->patch[f] == f) number[f] = (uint32_t)count++;
    BRIO_OMP(parallel for num_threads(t->threads))
    for (uint32_t f = 0; f < num_faces; f++)
        if (t->patch[f] != f) number[f] = number[t->patch[f]];
    return count;
}

/* Counts the faces and the edges of each component. */
static void count_in_components(const topology *t, const uint32_t *number, component *components) {
    BRIO_OMP(parallel num_threads(t->threads)) {
        tally own = {components, {0, 0, 0, 0}, 0};
        BRIO_OMP(for schedule(static))
        for (uint32_t f = 0; f < t->mesh->num_faces; f++) {
            component *c = tally_of(&own, number[f]);
            c->faces++;
            for (uint64_t h = t->mesh->face_offsets[f]; h < t->mesh->face_offsets[f + 1]; h++)
                c->edges += t->ring[h] <= h;
        }
        if (t->mesh->num_faces) tally_end(&own);
    }
}

/* Counts one vertex for each fan in the component of the fan; whether some vertex has two. */
static bool count_fans(topology *t, const uint32_t *number, component *components) {
    bool pinched = false;
    BRIO_OMP(parallel num_threads(t->threads) reduction(|| : pinched)) {
        tally own = {components, {0, 0, 0, 0}, 0};
        BRIO_OMP(for schedule(static))
        for (uint32_t h = 0; h < t->corners; h++) {
            if (t->fan[h] != h) continue;
            uint8_t *state = &t->vertex[t->mesh->face_vertices[h]];
            if (__atomic_fetch_or(state, VERTEX_SEEN, __ATOMIC_RELAXED) & VERTEX_SEEN) {
                __atomic_fetch_or(state, VERTEX_TWO_FANS, __ATOMIC_RELAXED);
                pinched = true;
            }
            tally_of(&own, number[face_at(t, h)])->vertices++;
        }
        if (t->corners) tally_end(&own);
    }
    return pinched;
}

/* Takes back what count_fans counted too much: several fans of one vertex in the same component. */
static brio_status recount_pinched_vertices(brio_context *ctx, const topology *t, const uint32_t *number,
                                            component *components) {
    brio_status status = BRIO_OK;
    uint64_t *fans = NULL; /* (vertex, component) */
    size_t count = 0, capacity = 0;
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        if (t->fan[h] != h || !(t->vertex[v] & VERTEX_TWO_FANS)) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, fans, capacity, count + 1));
        fans[count++] = (uint64_t)v << 32 | number[face_at(t, h)];
    }
    brio_sort_keys(fans, count);
    for (size_t i = 1; i < count; i++)
        if (fans[i] == fans[i - 1]) components[(uint32_t)fans[i]].vertices--;
done:
    brio_release(ctx, fans);
    return status;
}

/* Joins fans across edges of more than two faces, and at the two ends of each boundary edge: every set with such an
 * edge is a boundary loop. This is the end of t->fan as the partition into fans. */
static brio_status count_loops(brio_context *ctx, topology *t, const uint32_t *number, component *components) {
    brio_status status = BRIO_OK;
    uint8_t *counted = NULL; /* of each root of a set */
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, counted, t->corners));
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h];
        if (g == h) brio_unite(t->fan, h, next_corner(t, h), true);
        if (g > h && t->ring[g] != h) join_corners(t, h, g, true);
    }
    for (uint32_t h = 0; h < t->corners; h++) {
        if (t->ring[h] != h) continue;
        uint32_t root = brio_find(t->fan, h);
        if (!counted[root]) components[number[face_at(t, h)]].loops++;
        counted[root] = 1;
    }
done:
    brio_release(ctx, counted);
    return status;
}

static int64_t genus_of(const component *c) {
    int64_t twice = 2 - (c->vertices - c->edges + c->faces) - c->loops;
    return twice >= 0 ? twice / 2 : -((1 - twice) / 2);
}

/* Writes the genera, largest component first. */
static brio_status list_genera(brio_context *ctx, const component *components, size_t count, brio_certificate *out) {
    brio_status status = BRIO_OK;
    uint64_t *order = NULL; /* (complement of the number of faces, component) */
    BRIO_TRY(BRIO_ALLOC(ctx, order, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->genera, count));
    for (size_t i = 0; i < count; i++) order[i] = (uint64_t)(UINT32_MAX - components[i].faces) << 32 | i;
    brio_sort_keys(order, count);
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

static brio_status certify_components(brio_context *ctx, topology *t, brio_certificate *out) {
    brio_status status = BRIO_OK;
    component *components = NULL;
    uint32_t *number = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, number, t->mesh->num_faces));
    count = number_components(t, number);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, components, count));
    count_in_components(t, number, components);
    if (count_fans(t, number, components)) BRIO_TRY(recount_pinched_vertices(ctx, t, number, components));
    if (out->boundary_edges) BRIO_TRY(count_loops(ctx, t, number, components));
    BRIO_TRY(list_genera(ctx, components, count, out));
done:
    brio_release(ctx, components);
    brio_release(ctx, number);
    return status;
}

static size_t count_nonmanifold_vertices(const topology *t) {
    size_t count = 0;
    BRIO_OMP(parallel for num_threads(t->threads) reduction(+ : count))
    for (size_t v = 0; v < t->mesh->num_vertices; v++)
        count += (t->vertex[v] & (VERTEX_TWO_FANS | VERTEX_IN_DEGENERATE_FACE)) != 0;
    return count;
}

static brio_status certify_topology(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    brio_status status = BRIO_OK;
    topology t = {0};
    size_t degenerate_faces;
    BRIO_TRY(topology_new(ctx, mesh, &t));
    BRIO_TRY(mark_degenerate_faces(ctx, &t, &degenerate_faces));
    join_across_edges(&t, out);
    BRIO_TRY(certify_components(ctx, &t, out));
    out->nonmanifold_vertices = count_nonmanifold_vertices(&t);
    out->closed = t.corners > 0 && !out->boundary_edges && !out->nonmanifold_edges;
    out->manifold = !out->nonmanifold_edges && !out->nonmanifold_vertices && !degenerate_faces;
    out->oriented = !out->flipped_edges;
done:
    topology_free(ctx, &t);
    return status;
}

/* --- measure --- */

enum { PARTS = 256 }; /* of the faces, so that rounding does not depend on the number of threads */

typedef struct {
    double low[3], high[3], area, volume;
} measure;

static void box_of_part(const brio_mesh *mesh, int part, measure *m) {
    uint64_t corners = mesh->face_offsets[mesh->num_faces], end = brio_part(corners, part + 1, PARTS);
    for (int k = 0; k < 3; k++) m->low[k] = INFINITY, m->high[k] = -INFINITY;
    for (uint64_t h = brio_part(corners, part, PARTS); h < end; h++)
        for (int k = 0; k < 3; k++) {
            double x = mesh->vertices[3 * (size_t)mesh->face_vertices[h] + (size_t)k];
            if (x < m->low[k]) m->low[k] = x;
            if (x > m->high[k]) m->high[k] = x;
        }
}

/* Adds a face, cut into a fan of triangles from its first corner. */
static void measure_face(const brio_mesh *mesh, size_t f, const double *centre, measure *m) {
    const uint32_t *corners = mesh->face_vertices + mesh->face_offsets[f];
    uint64_t count = mesh->face_offsets[f + 1] - mesh->face_offsets[f];
    for (uint64_t i = 2; i < count; i++) {
        const double *a = mesh->vertices + 3 * (size_t)corners[0];
        const double *b = mesh->vertices + 3 * (size_t)corners[i - 1];
        const double *c = mesh->vertices + 3 * (size_t)corners[i];
        double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        m->area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
        m->volume += ((a[0] - centre[0]) * n[0] + (a[1] - centre[1]) * n[1] + (a[2] - centre[2]) * n[2]) / 6;
    }
}

/* Area and volume. Volumes are summed about the centre of the box of the vertices that faces use, so that a surface far
 * from the origin loses no digits. */
static void measure_faces(const brio_mesh *mesh, int threads, brio_certificate *out) {
    measure part[PARTS] = {0};
    double centre[3];
    (void)threads; /* without OpenMP */
    if (!mesh->num_faces || !mesh->face_offsets[mesh->num_faces]) return;
    BRIO_OMP(parallel for schedule(dynamic, 1) num_threads(threads))
    for (int i = 0; i < PARTS; i++) box_of_part(mesh, i, &part[i]);
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < PARTS; i++) low = fmin(low, part[i].low[k]), high = fmax(high, part[i].high[k]);
        centre[k] = 0.5 * low + 0.5 * high;
    }
    BRIO_OMP(parallel for schedule(dynamic, 1) num_threads(threads))
    for (int i = 0; i < PARTS; i++)
        for (size_t f = brio_part(mesh->num_faces, i, PARTS); f < brio_part(mesh->num_faces, i + 1, PARTS); f++)
            measure_face(mesh, f, centre, &part[i]);
    for (int i = 0; i < PARTS; i++) out->area += part[i].area, out->volume += part[i].volume;
}

brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    *out = (brio_certificate){.self_intersections = -1, .context = ctx};
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(certify_topology(ctx, mesh, out));
    measure_faces(mesh, brio_context_threads(ctx), out);
done:
    if (status != BRIO_OK) brio_certificate_free(out);
    return status;
}

void brio_certificate_free(brio_certificate *certificate) {
    if (!certificate || !certificate->context) return;
    brio_release(certificate->context, certificate->genera);
    *certificate = (brio_certificate){0};
}
