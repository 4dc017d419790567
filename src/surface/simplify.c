/* Edge collapses on half-edges.
 *
 * Half-edge h of triangle h / 3 starts at vertex[h]; mate[h] is the same edge in the other triangle. An edge collapses
 * into a point chosen by quadric errors when
 *   - both its ends are inside the surface, and its link condition holds: the ends have two neighbours in common and
 *     not three each, so that the surface stays the one it was;
 *   - no triangle round it turns over or loses its area. (Needles must be let be: the crust is full of them, and each
 *     is on the way to a better shape.)
 * Lists hold the edges by their error, a hundredth of it to a list; the first list that is not empty has become a heap,
 * which also takes what comes back below it. So the order is that of one heap, and the heap stays in the cache. An entry
 * is out of date when one of the ends has changed since.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997.
 *           Dey, Edelsbrunner, Guha, Nekhayev. Topology preserving edge contraction. Publ. Inst. Math. Beograd 1999 (the
 *           link condition). */
#include "surface/simplify.h"
#include "base/memory.h"
#include "base/vector.h"
#include "surface/edge_rings.h"
#include "surface/quadric.h"
#include <math.h>
#include <string.h>

enum { NONE = UINT32_MAX };

/* A triangle may turn by less than acos of this. */
static const double LEAST_COSINE = 0.2;

enum { LISTS = 1 << 15 };

typedef struct {
    float error;
    uint32_t half_edge, version; /* of both ends, added */
    uint32_t next;               /* in its list */
} entry;

typedef struct {
    brio_context *ctx;
    brio_mesh *mesh;
    const brio_simplify_options *options;
    double *position;
    uint32_t *vertex, *mate; /* #half-edges; vertex NONE in triangles that are gone */
    size_t num_half_edges, num_faces;
    uint32_t *half_edge; /* #V: one that starts there, or NONE */
    uint32_t *version, *seen;
    uint32_t round;
    uint8_t *boundary;
    double *spacing;
    brio_quadric *quadric;
    uint32_t *list; /* LISTS first entries, or NONE */
    entry *pool;    /* of all lists */
    size_t pool_size, pool_capacity;
    uint32_t unused; /* entries of the pool that no list has */
    uint32_t level;  /* the list that has become the heap */
    entry *heap;
    size_t heap_size, heap_capacity;
} simplifier;

static uint32_t next_in_triangle(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

static uint32_t before_in_triangle(uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

/* The next half-edge round the vertex where h starts. */
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

static brio_status heap_push(simplifier *s, entry e) {
    brio_status status = BRIO_RESERVE(s->ctx, s->heap, s->heap_capacity, s->heap_size + 1);
    if (status != BRIO_OK) return status;
    size_t i = s->heap_size++;
    for (; i > 0 && before(&e, &s->heap[(i - 1) / 2]); i = (i - 1) / 2) s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = e;
    return BRIO_OK;
}

static entry heap_pop(simplifier *s) {
    entry top = s->heap[0], last = s->heap[--s->heap_size];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < s->heap_size; i = child) {
        if (child + 1 < s->heap_size && before(&s->heap[child + 1], &s->heap[child])) child++;
        if (!before(&s->heap[child], &last)) break;
        s->heap[i] = s->heap[child];
    }
    if (s->heap_size) s->heap[i] = last;
    return top;
}

/* --- lists --- */

/* Grows with the error, from the exponent and seven more bits. */
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

/* Makes the next list the heap. */
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

/* The edge of the least error; *found is false when none is left. */
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

/* The squared distance, weighted by area, of the best point for the edge of h, which goes to `point`. */
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

/* Whether the ends of h have just the two neighbours in common that their triangles give them. */
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

/* Whether the triangle of g, its first corner moved to `point`, looks the way it did, or, where it was turned over
 * before, the way that all of them do together. */
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

/* The same for all triangles round the start of h but the two at its edge. */
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

/* The triangle of h vanishes: the other sides of its two other edges become one. */
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
    /* above both, so that no old entry of an edge that changed its end is taken for a new one */
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

/* The number of half-edges that start at the same vertex as h, in the one fan of triangles that h belongs to. */
static uint32_t fan_size(const simplifier *s, uint32_t h) {
    uint32_t size = 1, g = h, side = before_in_triangle(g);
    for (; s->mate[side] != side; side = before_in_triangle(g)) {
        g = s->mate[side];
        if (g == h) return size;
        size++;
    }
    for (g = h; s->mate[g] != g; size++) g = next_in_triangle(s->mate[g]); /* from h the other way */
    return size;
}

/* Refuses vertices of several fans: a collapse moves one fan only. Needs half_edge; `seen` counts, and is 0 again. */
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

/* Writes what is left over the arrays of the mesh. */
static void write_mesh(simplifier *s) {
    brio_mesh *m = s->mesh;
    size_t faces = 0, vertices = 0;
    uint32_t *number = s->seen;
    for (size_t v = 0; v < m->num_vertices; v++) {
        if (s->half_edge[v] == NONE) continue;
        memmove(m->vertices + 3 * vertices, m->vertices + 3 * v, 3 * sizeof *m->vertices);
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

brio_status brio_mesh_simplify(brio_context *ctx, brio_mesh *mesh, const brio_simplify_options *options) {
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
