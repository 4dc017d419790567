/* Edge collapses on half-edges.
 *
 * Half-edge h of triangle h / 3 starts at vertex[h]; mate[h] is the half-edge of the same edge in the neighbouring
 * triangle. An edge may collapse into a point chosen by quadric errors when
 * - both its ends are inside the surface;
 * - the link condition holds, so that the topology of the surface stays: the ends have exactly two common neighbours,
 *   and not both ends have degree three;
 * - no triangle round the edge turns over or loses its area. Needles stay allowed: the crust is full of them, and each
 *   collapse of a needle is a step to better shapes.
 * The queue sorts edges by error into lists; the errors in one list differ by less than 1%. The first list that is not
 * empty becomes a heap. The heap also takes later entries with errors below the end of its list. So the queue has the
 * order of one heap, while the heap fits into the cache. An entry is out of date when one of its edge's ends has
 * changed since the entry was made.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997. Dey, Edelsbrunner,
 * Guha, Nekhayev. Topology preserving edge contraction. Publ. Inst. Math. Beograd 1999 (the link condition). */
#include "mesh/simplify.h"
#include "base/memory.h"
#include "base/vector.h"
#include "mesh/edge_rings.h"
#include "mesh/quadric.h"
#include <math.h>
#include <string.h>

enum { NONE = UINT32_MAX };

/* A collapse may turn a triangle by at most the angle with this cosine; chosen. */
static const double LEAST_COSINE = 0.2;

enum { LISTS = 1 << 15 };

typedef struct {
    float error;
    uint32_t half_edge, version; /* sum of the versions of both ends */
    uint32_t next;               /* next entry in the list */
} entry;

typedef struct {
    brio_context *ctx;
    brio_mesh *mesh;
    const brio_collapse_options *options;
    double *position;
    uint32_t *vertex, *mate; /* #half-edges; vertex is NONE in triangles that have vanished */
    size_t num_half_edges, num_faces;
    uint32_t *half_edge; /* #V: a half-edge that starts at the vertex, or NONE */
    uint32_t *version, *seen;
    uint32_t round;
    uint8_t *boundary;
    double *spacing;
    brio_quadric *quadric;
    uint32_t *list; /* first entry of each of LISTS lists, or NONE */
    entry *pool;    /* entries of all lists */
    size_t pool_size, pool_capacity;
    uint32_t unused; /* first of the pool's entries that are in no list */
    uint32_t level;  /* list that has become the heap */
    entry *heap;
    size_t heap_size, heap_capacity;
} simplifier;

static uint32_t next_in_triangle(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

static uint32_t before_in_triangle(uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

/* Returns the next half-edge round the start of h. */
static uint32_t turn(const simplifier *s, uint32_t h) {
    return s->mate[before_in_triangle(h)];
}

static uint32_t end_of(const simplifier *s, uint32_t h) {
    return s->vertex[next_in_triangle(h)];
}

static const double *at(const simplifier *s, uint32_t v) {
    return s->position + 3 * (size_t)v;
}

/* --- heap --- */

static bool before(const entry *a, const entry *b) {
    return a->error != b->error ? a->error < b->error : a->half_edge < b->half_edge;
}

#define HEAP_ITEM              entry
#define HEAP_ABOVE(a, b, user) before(&(a), &(b))
#define HEAP_DOWN              entry_down
#define HEAP_UP                entry_up
#include "base/heap.h"

static brio_status heap_push(simplifier *s, entry e) {
    brio_status status = BRIO_RESERVE(s->ctx, s->heap, s->heap_capacity, s->heap_size + 1);
    if (status != BRIO_OK) return status;
    entry_up(s->heap, s->heap_size++, e, NULL);
    return BRIO_OK;
}

static entry heap_pop(simplifier *s) {
    entry top = s->heap[0], last = s->heap[--s->heap_size];
    if (s->heap_size) entry_down(s->heap, 0, s->heap_size, last, NULL);
    return top;
}

/* --- lists --- */

/* Returns the list of an error, which grows with the error: the exponent and the highest seven bits of the mantissa. */
static uint32_t level_of(float error) {
    uint32_t bits;
    memcpy(&bits, &error, sizeof bits);
    return bits >> 16 & (LISTS - 1);
}

static brio_status queue_push(simplifier *s, entry e) {
    uint32_t level = level_of(e.error), at = s->unused;
    if (level <= s->level) return heap_push(s, e);
    if (at == NONE) {
        brio_status status = BRIO_RESERVE(s->ctx, s->pool, s->pool_capacity, s->pool_size + 1);
        if (status != BRIO_OK) return status;
        at = (uint32_t)s->pool_size++;
    } else {
        s->unused = s->pool[at].next;
    }
    e.next = s->list[level];
    s->pool[at] = e;
    s->list[level] = at;
    return BRIO_OK;
}

static bool up_to_date(const simplifier *s, const entry *e) {
    if (s->vertex[e->half_edge] == NONE) return false;
    return s->version[s->vertex[e->half_edge]] + s->version[end_of(s, e->half_edge)] == e->version;
}

/* Moves the entries of the next list into the heap. */
static brio_status next_level(simplifier *s) {
    brio_status status = BRIO_OK;
    s->level++;
    for (uint32_t i = s->list[s->level], next; i != NONE; i = next) {
        next = s->pool[i].next;
        if (up_to_date(s, &s->pool[i])) BRIO_TRY(heap_push(s, s->pool[i]));
        s->pool[i].next = s->unused;
        s->unused = i;
    }
    s->list[s->level] = NONE;
done:
    return status;
}

/* Takes the edge of least error off the queue. Sets *found to false when no edge is left. */
static brio_status queue_pop(simplifier *s, entry *e, bool *found) {
    brio_status status = BRIO_OK;
    *found = false;
    for (;;) {
        while (!s->heap_size && s->level + 1 < LISTS) BRIO_TRY(next_level(s));
        if (!s->heap_size) break;
        *e = heap_pop(s);
        if ((*found = up_to_date(s, e))) break;
    }
done:
    return status;
}

/* --- the point of a collapse, and its error --- */

/* Writes the best point for the edge of h to `point`. Returns the squared distance of that point from the planes,
 * weighted by area. */
static double best_point(const simplifier *s, uint32_t h, brio_quadric *sum, double *point) {
    const double *a = at(s, s->vertex[h]), *b = at(s, end_of(s, h));
    double candidate[3][3], edge = 0, away = 0, least = INFINITY;
    *sum = s->quadric[s->vertex[h]];
    brio_quadric_add(sum, &s->quadric[end_of(s, h)]);
    for (int k = 0; k < 3; k++) {
        candidate[0][k] = a[k], candidate[1][k] = b[k], candidate[2][k] = 0.5 * (a[k] + b[k]);
        edge += (b[k] - a[k]) * (b[k] - a[k]);
    }
    if (brio_quadric_minimum(sum, point)) {
        for (int k = 0; k < 3; k++) away += (point[k] - candidate[2][k]) * (point[k] - candidate[2][k]);
        if (away <= edge) return brio_quadric_at(sum, point);
    }
    for (int i = 0; i < 3; i++) {
        double error = brio_quadric_at(sum, candidate[i]);
        if (error >= least) continue;
        least = error;
        memcpy(point, candidate[i], sizeof candidate[i]);
    }
    return least;
}

static double squared_distance(const double *a, const double *b) {
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

static brio_status offer(simplifier *s, uint32_t h) {
    uint32_t u = s->vertex[h], v = end_of(s, h);
    double spacing = fmin(s->spacing[u], s->spacing[v]), longest = s->options->longest * spacing;
    if (s->boundary[u] || s->boundary[v] || squared_distance(at(s, u), at(s, v)) > longest * longest) return BRIO_OK;
    brio_quadric sum;
    double point[3], error = best_point(s, h, &sum, point), allowed = s->options->tolerance * spacing;
    if (error > allowed * allowed * sum.area) return BRIO_OK;
    return queue_push(s, (entry){(float)error, h, s->version[u] + s->version[v], NONE});
}

/* --- what a collapse must not do --- */

/* Returns whether the ends of h have exactly two common neighbours, the apexes of the edge's two triangles, and not
 * both ends have degree three. */
static bool link_condition(simplifier *s, uint32_t h) {
    uint32_t m = s->mate[h], degree[2] = {0, 0}, common = 0, g = h;
    s->round++;
    do {
        s->seen[end_of(s, g)] = s->round;
        degree[0]++;
    } while ((g = turn(s, g)) != h);
    g = m;
    do {
        common += s->seen[end_of(s, g)] == s->round;
        degree[1]++;
    } while ((g = turn(s, g)) != m);
    return common == 2 && degree[0] >= 3 && degree[1] >= 3 && degree[0] + degree[1] > 6;
}

static void normal_of(const double *a, const double *b, const double *c, double *n) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
}

static void normal_before(const simplifier *s, uint32_t h, double *n) {
    normal_of(at(s, s->vertex[h]), at(s, end_of(s, h)), at(s, s->vertex[before_in_triangle(h)]), n);
}

static void add_normals(const simplifier *s, uint32_t h, double *sum) {
    uint32_t g = h;
    do {
        double n[3];
        normal_before(s, g, n);
        for (int k = 0; k < 3; k++) sum[k] += n[k];
    } while ((g = turn(s, g)) != h);
}

/* Returns whether the triangle of g keeps its side when its first corner moves to `point`: its new normal agrees with
 * its old normal. If the old normal disagrees with `together`, the new normal must agree with `together`. */
static bool keeps_its_side(const simplifier *s, uint32_t g, const double *point, const double *together) {
    const double *b = at(s, end_of(s, g)), *c = at(s, s->vertex[before_in_triangle(g)]);
    double old[3], new[3];
    normal_before(s, g, old);
    normal_of(point, b, c, new);
    const double *side = brio_dot(old, together) > 0 ? old : together;
    double size = sqrt(brio_dot(new, new));
    if (!(size > 0) && brio_dot(old, old) > 0) return false;
    return brio_dot(new, side) >= LEAST_COSINE * size * sqrt(brio_dot(side, side));
}

/* Returns whether all triangles round the start of h, except the two at the edge of h, keep their sides. */
static bool keep_their_sides(const simplifier *s, uint32_t h, const double *point, const double *together) {
    for (uint32_t g = turn(s, h), last = next_in_triangle(s->mate[h]); g != h; g = turn(s, g))
        if (g != last && !keeps_its_side(s, g, point, together)) return false;
    return true;
}

static bool allowed(simplifier *s, uint32_t h, const double *point) {
    double together[3] = {0, 0, 0};
    if (!link_condition(s, h)) return false;
    add_normals(s, h, together);
    add_normals(s, s->mate[h], together);
    return keep_their_sides(s, h, point, together) && keep_their_sides(s, s->mate[h], point, together);
}

/* --- the collapse --- */

static void glue(simplifier *s, uint32_t g, uint32_t h) {
    s->mate[g] = h;
    s->mate[h] = g;
    s->half_edge[s->vertex[g]] = g;
    s->half_edge[s->vertex[h]] = h;
}

/* Removes the triangle of h: its two sides other than h become one edge. */
static void close_triangle(simplifier *s, uint32_t h) {
    uint32_t first = h - h % 3;
    glue(s, s->mate[next_in_triangle(h)], s->mate[before_in_triangle(h)]);
    for (uint32_t i = 0; i < 3; i++) s->vertex[first + i] = NONE;
    s->num_faces--;
}

static brio_status collapse(simplifier *s, uint32_t h, const brio_quadric *sum, const double *point) {
    brio_status status = BRIO_OK;
    uint32_t m = s->mate[h], gone = s->vertex[h], kept = s->vertex[m], g = h;
    do s->vertex[g] = kept;
    while ((g = turn(s, g)) != h);
    close_triangle(s, h);
    close_triangle(s, m);
    memcpy(s->position + 3 * (size_t)kept, point, 3 * sizeof *point);
    s->quadric[kept] = *sum;
    s->spacing[kept] = fmin(s->spacing[kept], s->spacing[gone]);
    s->half_edge[gone] = NONE;
    /* above both versions, so that no old entry of an edge whose end has changed looks up to date */
    s->version[kept] = (s->version[kept] > s->version[gone] ? s->version[kept] : s->version[gone]) + 1;
    g = s->half_edge[kept];
    do BRIO_TRY(offer(s, g));
    while ((g = turn(s, g)) != s->half_edge[kept]);
done:
    return status;
}

/* --- beginning --- */

static brio_status read_mesh(simplifier *s) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = s->mesh;
    brio_context *ctx = s->ctx;
    uint32_t *ring = NULL;
    BRIO_TRY(brio_mesh_check_faces(ctx, m));
    for (size_t f = 0; f < m->num_faces; f++)
        BRIO_REQUIRE(ctx, m->face_offsets[f + 1] == 3 * (f + 1), BRIO_ERR_ARGUMENT, "face %zu is not a triangle", f);
    s->num_faces = m->num_faces;
    s->num_half_edges = 3 * m->num_faces;
    s->position = m->vertices;
    s->vertex = m->face_vertices;
    BRIO_TRY(brio_edge_rings(ctx, m, &ring));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->boundary, m->num_vertices));
    for (uint32_t h = 0; h < s->num_half_edges; h++) {
        uint32_t g = ring[h];
        BRIO_REQUIRE(ctx, g == h || (ring[g] == h && s->vertex[g] == end_of(s, h)), BRIO_ERR_ARGUMENT,
                     "the surface is not manifold and oriented at the edge from vertex %u to %u", s->vertex[h],
                     end_of(s, h));
        if (g == h) s->boundary[s->vertex[h]] = s->boundary[end_of(s, h)] = 1;
    }
    s->mate = ring;
    ring = NULL;
done:
    brio_release(ctx, ring);
    return status;
}

/* Returns the number of half-edges that start where h starts and belong to the fan of triangles of h. */
static uint32_t fan_size(const simplifier *s, uint32_t h) {
    uint32_t size = 1, g = h, side = before_in_triangle(g);
    for (; s->mate[side] != side; side = before_in_triangle(g)) {
        g = s->mate[side];
        if (g == h) return size;
        size++;
    }
    for (g = h; s->mate[g] != g; size++) g = next_in_triangle(s->mate[g]); /* from h in the opposite direction */
    return size;
}

/* Refuses vertices with several fans, because a collapse moves one fan only. Needs half_edge. Uses `seen` for counting
 * and leaves it 0. */
static brio_status check_fans(simplifier *s) {
    brio_status status = BRIO_OK;
    for (uint32_t h = 0; h < s->num_half_edges; h++) s->seen[s->vertex[h]]++;
    for (size_t v = 0; v < s->mesh->num_vertices; v++) {
        BRIO_REQUIRE(s->ctx, !s->seen[v] || s->seen[v] == fan_size(s, s->half_edge[v]), BRIO_ERR_ARGUMENT,
                     "the surface is not manifold at vertex %zu: its triangles are several fans", v);
        s->seen[v] = 0;
    }
done:
    return status;
}

static brio_status prepare(simplifier *s) {
    brio_status status = BRIO_OK;
    brio_context *ctx = s->ctx;
    size_t n = s->mesh->num_vertices;
    BRIO_TRY(read_mesh(s));
    BRIO_TRY(BRIO_ALLOC(ctx, s->half_edge, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->version, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->seen, n));
    BRIO_TRY(BRIO_ALLOC(ctx, s->spacing, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->quadric, n));
    BRIO_TRY(BRIO_ALLOC(ctx, s->list, LISTS));
    for (size_t i = 0; i < LISTS; i++) s->list[i] = NONE;
    s->unused = NONE;
    for (size_t v = 0; v < n; v++) s->half_edge[v] = NONE, s->spacing[v] = s->options->spacing[v];
    for (uint32_t h = 0; h < s->num_half_edges; h++) {
        uint32_t v = s->vertex[h];
        s->half_edge[v] = h;
        brio_quadric_add_triangle(&s->quadric[v], at(s, v), at(s, end_of(s, h)),
                                  at(s, s->vertex[before_in_triangle(h)]));
    }
    BRIO_TRY(check_fans(s));
    for (uint32_t h = 0; h < s->num_half_edges; h++)
        if (s->mate[h] > h) BRIO_TRY(offer(s, h));
done:
    return status;
}

/* --- end --- */

static void move_properties(const brio_mesh *m, size_t from, size_t to) {
    for (size_t i = 0; i < m->num_properties; i++) {
        size_t size = brio_scalar_size(m->properties[i].type);
        char *row = m->properties[i].data;
        memmove(row + to * size, row + from * size, size);
    }
}

/* Writes the remaining surface over the arrays of the mesh. */
static void write_mesh(simplifier *s) {
    brio_mesh *m = s->mesh;
    size_t faces = 0, vertices = 0;
    uint32_t *number = s->seen;
    for (size_t v = 0; v < m->num_vertices; v++) {
        if (s->half_edge[v] == NONE) continue;
        memmove(m->vertices + 3 * vertices, m->vertices + 3 * v, 3 * sizeof *m->vertices);
        move_properties(m, v, vertices);
        number[v] = (uint32_t)vertices++;
    }
    for (size_t f = 0; f < m->num_faces; f++) {
        if (s->vertex[3 * f] == NONE) continue;
        for (size_t i = 0; i < 3; i++) m->face_vertices[3 * faces + i] = number[s->vertex[3 * f + i]];
        faces++;
        m->face_offsets[faces] = 3 * faces;
    }
    m->num_faces = faces;
    m->num_vertices = vertices;
}

static void simplifier_free(simplifier *s) {
    brio_release(s->ctx, s->mate);
    brio_release(s->ctx, s->half_edge);
    brio_release(s->ctx, s->version);
    brio_release(s->ctx, s->seen);
    brio_release(s->ctx, s->boundary);
    brio_release(s->ctx, s->spacing);
    brio_release(s->ctx, s->quadric);
    brio_release(s->ctx, s->list);
    brio_release(s->ctx, s->pool);
    brio_release(s->ctx, s->heap);
}

brio_status brio_collapse_edges(brio_context *ctx, brio_mesh *mesh, const brio_collapse_options *options) {
    brio_status status = BRIO_OK;
    simplifier s = {.ctx = ctx, .mesh = mesh, .options = options};
    BRIO_TRY(prepare(&s));
    for (size_t step = 0; s.num_faces > options->target_faces; step++) {
        entry e;
        bool found;
        brio_quadric sum;
        double point[3];
        if (step % 65536 == 0)
            BRIO_TRY(brio_progress(ctx, "simplify", 1 - (double)s.num_faces / (double)mesh->num_faces));
        BRIO_TRY(queue_pop(&s, &e, &found));
        if (!found) break;
        best_point(&s, e.half_edge, &sum, point);
        if (allowed(&s, e.half_edge, point)) BRIO_TRY(collapse(&s, e.half_edge, &sum, point));
    }
    write_mesh(&s);
done:
    simplifier_free(&s);
    return status;
}
