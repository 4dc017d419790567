/* Cuts a surface along the Voronoi cells of samples.
 *
 * Vertices: from a sample near the last one, along Delaunay edges to a nearer sample, until none is nearer. Edges: from
 * the cell of one end through the bisector that is met first, and so on to the cell of the other end. Faces: from the
 * cells that the border meets to all that the face meets. A polygon is convex, so the lines between polygons hang
 * together with the border; and the Voronoi edges round each cell that the face meets lead to all the others.
 * A Voronoi edge is where a line of points with three nearest samples is on the near sides of the bisectors of the two
 * tetrahedra at the Delaunay triangle. On the hull there is one.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 2.7.
 *           Yan, Levy, Liu, Sun, Wang. Isotropic remeshing with fast and exact computation of restricted Voronoi
 *           diagram. SGP 2009, for going from cell to cell.
 * Differs from the paper: polygons are not clipped; only signs say what is there. */
#include "base/memory.h"
#include "base/sort.h"
#include "restricted/work.h"

static inline const double *sample(const brio_restriction *r, uint32_t s) {
    return r->points + 3 * (size_t)s;
}

static inline const double *corner(const brio_restriction *r, uint32_t v) {
    return r->surface->vertices + 3 * (size_t)v;
}

static inline const uint32_t *face(const brio_restriction *r, size_t f) {
    return r->surface->face_vertices + 3 * f;
}

/* --- edges --- */

brio_status brio_restriction_edges(brio_restriction *r) {
    brio_context *ctx = r->ctx;
    brio_status status = BRIO_OK;
    size_t n = 3 * r->surface->num_faces;
    uint64_t *key = NULL;
    uint32_t *half = NULL;
    BRIO_REQUIRE(ctx, n < UINT32_MAX && r->surface->num_vertices < UINT32_C(1) << 31, BRIO_ERR_TOO_LARGE,
                 "%zu faces of the surface; at most 2^32 / 3", n / 3);
    BRIO_TRY(BRIO_ALLOC(ctx, key, n));
    BRIO_TRY(BRIO_ALLOC(ctx, half, n));
    BRIO_TRY(BRIO_ALLOC(ctx, r->end, n / 2));
    BRIO_TRY(BRIO_ALLOC(ctx, r->side, n / 2));
    BRIO_TRY(BRIO_ALLOC(ctx, r->edge_of, n / 3));
    for (uint32_t h = 0; h < n; h++) {
        uint64_t u = face(r, h / 3)[h % 3], v = face(r, h / 3)[(h + 1) % 3];
        key[h] = u < v ? u << 31 | v : v << 31 | u;
        half[h] = h;
    }
    BRIO_TRY(brio_radix_sort(ctx, key, half, n, 62));
    for (size_t i = 0; i < n; i += 2) {
        bool two = i + 1 < n && key[i] == key[i + 1] && (i + 2 == n || key[i + 2] != key[i]);
        BRIO_REQUIRE(ctx, two, BRIO_BECAUSE(ctx, NOT_CLOSED, BRIO_ERR_ARGUMENT),
                     "the surface is not closed: an edge of face %u has not two faces", half[i] / 3);
        size_t e = r->num_edges++;
        r->end[e][0] = (uint32_t)(key[i] >> 31), r->end[e][1] = (uint32_t)(key[i] & ((UINT32_C(1) << 31) - 1));
        for (int k = 0; k < 2; k++) {
            r->side[e][k] = half[i + (size_t)k] / 3;
            r->edge_of[half[i + (size_t)k] / 3][half[i + (size_t)k] % 3] = (uint32_t)e;
        }
    }
done:
    brio_release(ctx, key);
    brio_release(ctx, half);
    return status;
}

/* --- vertices --- */

static uint32_t nearest_sample(brio_restriction *r, uint32_t from, const double *p) {
    const brio_incidences *near = &r->neighbours;
    for (uint32_t last = BRIO_INFINITE; from != last;) {
        last = from;
        for (uint64_t i = near->offsets[last]; i < near->offsets[last + 1]; i++)
            if (brio_nearer_sample(&r->counts, sample(r, near->items[i]), sample(r, from), p) > 0)
                from = near->items[i];
    }
    return from;
}

static brio_status locate_vertices(brio_restriction *r) {
    const brio_mesh *m = r->surface;
    uint32_t near = r->first_sample;
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, r->cell, m->num_vertices));
    for (size_t v = 0; v < m->num_vertices; v++) r->cell[v] = BRIO_INFINITE;
    for (size_t i = 0; i < 3 * m->num_faces; i++) { /* in the order of the faces, which is often one through space */
        uint32_t v = m->face_vertices[i];
        if (r->cell[v] == BRIO_INFINITE) r->cell[v] = nearest_sample(r, near, corner(r, v));
        near = r->cell[v];
    }
    return BRIO_OK;
}

/* --- along edges --- */

/* Returns the cell that the line from p to q enters when it leaves that of sample a; BRIO_INFINITE when q is in it. */
static uint32_t next_cell(brio_restriction *r, uint32_t a, const double *p, const double *q) {
    const brio_incidences *near = &r->neighbours;
    uint32_t next = BRIO_INFINITE;
    for (uint64_t i = near->offsets[a]; i < near->offsets[a + 1]; i++) {
        uint32_t b = near->items[i];
        if (brio_nearer_sample(&r->counts, sample(r, a), sample(r, b), q) > 0) continue;
        /* both are left behind: g_b(p) / -g_b(q) tells how far away a bisector is */
        if (next == BRIO_INFINITE ||
            brio_bisector_order(&r->counts, sample(r, a), sample(r, b), sample(r, next), p, q) > 0)
            next = b;
    }
    return next;
}

static brio_status follow_edges(brio_restriction *r) {
    size_t count = 0;
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, r->first, r->num_edges + 1));
    for (size_t e = 0; e < r->num_edges; e++) {
        const double *p = corner(r, r->end[e][0]), *q = corner(r, r->end[e][1]);
        r->first[e] = count;
        for (uint32_t a = r->cell[r->end[e][0]]; a != BRIO_INFINITE; a = next_cell(r, a, p, q)) {
            BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->met, r->met_capacity, count + 1));
            r->met[count++] = a;
        }
        BRIO_EXPECT(r->ctx, r->met[count - 1] == r->cell[r->end[e][1]], BRIO_ERR_INTERNAL,
                    "edge %zu of the surface ends in another cell than its corner", e);
        if (e % 65536 == 0) BRIO_FORWARD(brio_progress(r->ctx, "edges", (double)e / (double)r->num_edges));
    }
    r->first[r->num_edges] = count;
    return BRIO_OK;
}

/* --- faces --- */

typedef struct {
    uint32_t *seen; /* of each sample, the last face whose list has it, plus 1 */
    uint32_t *list; /* samples whose cells the face meets */
    size_t count, capacity;
} face_cells;

static brio_status meet(brio_restriction *r, face_cells *c, uint32_t f, uint32_t s) {
    if (c->seen[s] == f + 1) return BRIO_OK;
    brio_status status = BRIO_RESERVE(r->ctx, c->list, c->capacity, c->count + 1);
    if (status != BRIO_OK) return status;
    c->seen[s] = f + 1;
    c->list[c->count++] = s;
    return BRIO_OK;
}

/* Returns whether a face meets the Voronoi edge of the facet of tetrahedron t opposite to slot i; its samples ascend.
 * The sign is that of brio_crossing, 0 for no. */
static int crosses(brio_restriction *r, uint32_t f, uint32_t t, int i, uint32_t s[3]) {
    const uint32_t *v = face(r, f);
    const double *p[3] = {corner(r, v[0]), corner(r, v[1]), corner(r, v[2])};
    const double *g[4] = {sample(r, s[0]), sample(r, s[1]), sample(r, s[2]), NULL};
    int sign = brio_bisector_order(&r->counts, g[0], g[1], g[2], p[0], p[1]);
    for (int k = 1; k < 3; k++)
        if (sign == 0 || brio_bisector_order(&r->counts, g[0], g[1], g[2], p[k], p[(k + 1) % 3]) != sign) return 0;
    uint32_t mate = r->tet[t].mate[i], apex[2] = {r->tet[t].vertex[i], r->tet[mate / 4].vertex[mate % 4]};
    for (int k = 0; k < 2; k++) {
        if (apex[k] == BRIO_INFINITE) continue;
        g[3] = sample(r, apex[k]);
        if (brio_bisector_side(&r->counts, g, p) != sign) return 0;
    }
    return sign;
}

static void sort_three(uint32_t s[3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j + 1 < 3; j++)
            if (s[j] > s[j + 1]) {
                uint32_t swap = s[j];
                s[j] = s[j + 1], s[j + 1] = swap;
            }
}

/* Tries the Voronoi edges of one tetrahedron at the cell of sample a. Each is tried from one of its two tetrahedra. */
static brio_status try_tetrahedron(brio_restriction *r, face_cells *c, uint32_t f, uint32_t a, uint32_t t) {
    for (int i = 0; i < 4; i++) {
        uint32_t other = r->tet[t].mate[i] / 4, s[3];
        bool infinite = r->tet[other].vertex[3] == BRIO_INFINITE;
        if (r->tet[t].vertex[i] == a || (!infinite && other < t)) continue;
        for (int j = 0, k = 0; j < 4; j++)
            if (j != i) s[k++] = r->tet[t].vertex[j];
        sort_three(s);
        int sign = crosses(r, f, t, i, s);
        if (!sign) continue;
        for (int k = 0; k < 3; k++) BRIO_FORWARD(meet(r, c, f, s[k]));
        if (a != s[0]) continue; /* the face meets all three cells: one of them lists the crossing */
        BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->crossing, r->crossing_capacity, r->num_crossings + 1));
        r->crossing[r->num_crossings++] = (brio_crossing){f, {s[0], s[1], s[2]}, sign};
    }
    return BRIO_OK;
}

static brio_status cut_face(brio_restriction *r, face_cells *c, uint32_t f) {
    size_t before = r->num_pieces;
    c->count = 0;
    for (int i = 0; i < 3; i++) {
        uint32_t e = r->edge_of[f][i];
        for (uint64_t k = r->first[e]; k < r->first[e + 1]; k++) BRIO_FORWARD(meet(r, c, f, r->met[k]));
    }
    bool one = c->count == 1; /* it meets no bisector */
    for (size_t k = 0; k < c->count; k++) {
        uint32_t a = c->list[k];
        for (uint64_t i = r->tets.offsets[a]; i < r->tets.offsets[a + 1] && !one; i++)
            BRIO_FORWARD(try_tetrahedron(r, c, f, a, r->tets.items[i]));
        BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->piece, r->piece_capacity, r->num_pieces + 1));
        r->piece[r->num_pieces++] = (uint64_t)a << 32 | f;
    }
    brio_sort_keys(r->piece + before, r->num_pieces - before);
    return BRIO_OK;
}

static brio_status cut_faces(brio_restriction *r) {
    brio_status status = BRIO_OK;
    face_cells c = {0};
    size_t n = r->surface->num_faces;
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, c.seen, r->tets.count));
    for (uint32_t f = 0; f < n; f++) {
        if (f % 16384 == 0) BRIO_TRY(brio_progress(r->ctx, "faces", (double)f / (double)n));
        BRIO_TRY(cut_face(r, &c, f));
    }
done:
    brio_release(r->ctx, c.seen);
    brio_release(r->ctx, c.list);
    return status;
}

brio_status brio_restriction_cut(brio_restriction *r) {
    brio_status status = locate_vertices(r);
    if (status == BRIO_OK) status = follow_edges(r);
    return status == BRIO_OK ? cut_faces(r) : status;
}
