/* Vertices at equal positions, or near each other, become one.
 *
 * The vertices are sorted by the place of each coordinate: by the coordinate itself where only equal positions merge,
 * otherwise by its cell of half the distance. Vertices of one cell are near each other without a test. A cell is then
 * compared with the cells at most two places further on; in the sorted order those of one row stand together, and a
 * cursor for each of the 13 rows moves forward only. A union-find joins what is near, so that the sets depend on the
 * positions alone. Of each set the vertex of the lexicographically least position stays. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/union_find.h"
#include "base/versioned.h"
#include "mesh/edge_rings.h"
#include "mesh/properties.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* Cells are wider than half the distance by this factor, and a coordinate has fewer than MOST_PLACES of them. Derived:
 * a place is then rounded by less than 2^-13 cells. So vertices within the distance are at most two places apart, and
 * those of one cell, whose diagonal is 0.87 distances, are within it. */
static const double WIDER = 1 + 0x1p-8, MOST_PLACES = 0x1p40;
/* Chosen: the most that rounding of coordinates counts for, a share of the distance. Far less than WIDER adds. */
static const double MOST_ROUNDED = 0x1p-14;
enum { REACH = 2, ROWS = 13, TESTS_A_REPORT = 1 << 20, VERTICES_A_REPORT = 1 << 16 };

typedef struct {
    double place[3];
    size_t begin; /* of its vertices in the order; they end where those of the next cell begin */
} cell;

typedef struct {
    brio_context *ctx;
    brio_mesh *mesh;
    double side;          /* of a cell; 0: the coordinates themselves are the places */
    double scale, square; /* scale: a power of two that brings the distance near 1; square: of the scaled distance */
    uint32_t *order;      /* #V: the vertices by their places */
    uint32_t *parent;     /* #V: union-find */
    uint32_t *number;     /* #V: of the vertex that stays in the place of this one, among those that stay */
    uint8_t *stays;       /* #V */
    cell *cells;          /* and one more, which begins behind the last vertex */
    size_t num_cells;
    size_t tests; /* of pairs, since the last report */
} merger;

/* --- what is near --- */

static double place_of(const merger *m, uint32_t v, size_t axis) {
    double x = m->mesh->vertices[3 * (size_t)v + axis];
    return m->side > 0 ? floor(x / m->side) : x;
}

/* Sorts the vertices by their places along x, y and z. */
static brio_status sort_vertices(merger *m) {
    brio_status status = BRIO_OK;
    size_t n = m->mesh->num_vertices;
    uint64_t *keys = NULL;
    BRIO_TRY(BRIO_ALLOC(m->ctx, m->order, n));
    BRIO_TRY(BRIO_ALLOC(m->ctx, keys, n));
    for (uint32_t v = 0; v < n; v++) m->order[v] = v;
    for (size_t axis = 3; axis-- > 0;) {
        for (size_t i = 0; i < n; i++) keys[i] = brio_double_key(place_of(m, m->order[i], axis));
        BRIO_TRY(brio_radix_sort(m->ctx, keys, m->order, n, 64));
        BRIO_TRY(brio_progress(m->ctx, "merge", 0.2 * (double)(3 - axis)));
    }
done:
    brio_release(m->ctx, keys);
    return status;
}

static bool is_in_cell(const merger *m, uint32_t v, const cell *c) {
    for (size_t axis = 0; axis < 3; axis++)
        if (place_of(m, v, axis) != c->place[axis]) return false;
    return true;
}

/* Finds the cells, and joins the vertices of each one. */
static brio_status join_cells(merger *m) {
    size_t n = m->mesh->num_vertices, capacity = 0;
    BRIO_FORWARD(BRIO_ALLOC(m->ctx, m->parent, n));
    for (uint32_t v = 0; v < n; v++) m->parent[v] = v;
    for (size_t i = 0; i < n; i++) {
        uint32_t v = m->order[i];
        if (i > 0 && is_in_cell(m, v, &m->cells[m->num_cells - 1])) {
            brio_unite(m->parent, v, m->order[i - 1], true);
            continue;
        }
        BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->cells, capacity, m->num_cells + 2));
        m->cells[m->num_cells++] = (cell){{place_of(m, v, 0), place_of(m, v, 1), place_of(m, v, 2)}, i};
        m->cells[m->num_cells].begin = n;
    }
    return BRIO_OK;
}

/* Returns whether two vertices are near: rounded, but the same for both orders of the two. */
static bool is_near(const merger *m, uint32_t a, uint32_t b) {
    const double *p = m->mesh->vertices + 3 * (size_t)a, *q = m->mesh->vertices + 3 * (size_t)b;
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double d = (p[k] - q[k]) * m->scale;
        sum += d * d;
    }
    return sum <= m->square;
}

/* Joins two cells if a vertex of one is near a vertex of the other. */
static brio_status join_near(merger *m, const cell *a, const cell *b) {
    size_t of_b = b[1].begin - b->begin;
    if (brio_find(m->parent, m->order[a->begin]) == brio_find(m->parent, m->order[b->begin])) return BRIO_OK;
    for (size_t i = a->begin; i < a[1].begin; i++) {
        for (size_t j = b->begin; j < b[1].begin; j++)
            if (is_near(m, m->order[i], m->order[j])) {
                brio_unite(m->parent, m->order[i], m->order[j], true);
                return BRIO_OK;
            }
        m->tests += of_b;
        if (m->tests < TESTS_A_REPORT) continue;
        m->tests = 0;
        BRIO_FORWARD(brio_progress(m->ctx, "merge", 0.6 + 0.3 * (double)i / (double)m->mesh->num_vertices));
    }
    return BRIO_OK;
}

static int compare_places(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

/* Joins each cell with the near ones behind it in the order. */
static brio_status join_neighbours(merger *m) {
    size_t cursor[ROWS] = {0};
    for (size_t i = 0; i < m->num_cells; i++) {
        const cell *c = &m->cells[i];
        int row = 0;
        for (int x = 0; x <= REACH; x++)
            for (int y = x ? -REACH : 0; y <= REACH; y++, row++) {
                const double first[3] = {c->place[0] + x, c->place[1] + y, c->place[2] + (x || y ? -REACH : 1)};
                const double last[3] = {first[0], first[1], c->place[2] + REACH};
                size_t *at = &cursor[row];
                while (*at < m->num_cells && compare_places(m->cells[*at].place, first) < 0) ++*at;
                for (size_t j = *at; j < m->num_cells && compare_places(m->cells[j].place, last) <= 0; j++)
                    BRIO_FORWARD(join_near(m, c, &m->cells[j]));
            }
        if (i % VERTICES_A_REPORT == 0)
            BRIO_FORWARD(brio_progress(m->ctx, "merge", 0.6 + 0.3 * (double)i / (double)m->num_cells));
    }
    return BRIO_OK;
}

/* --- what stays --- */

static bool comes_before(const brio_mesh *mesh, uint32_t a, uint32_t b) {
    int order = compare_places(mesh->vertices + 3 * (size_t)a, mesh->vertices + 3 * (size_t)b);
    return order < 0 || (order == 0 && a < b);
}

/* Chooses the vertex of each set that stays, and numbers these in the order of the mesh. */
static brio_status choose(merger *m) {
    size_t n = m->mesh->num_vertices;
    uint32_t *best = m->order, kept = 0; /* the order is not needed any more */
    BRIO_FORWARD(BRIO_ALLOC(m->ctx, m->number, n));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(m->ctx, m->stays, n));
    for (uint32_t v = 0; v < n; v++) {
        uint32_t root = brio_find(m->parent, v);
        if (root == v || comes_before(m->mesh, v, best[root])) best[root] = v; /* the root is the first of its set */
    }
    for (uint32_t v = 0; v < n; v++) m->stays[best[brio_find(m->parent, v)]] = 1;
    for (uint32_t v = 0; v < n; v++) m->number[v] = m->stays[v] ? kept++ : 0;
    for (uint32_t v = 0; v < n; v++)
        if (!m->stays[v]) m->number[v] = m->number[best[brio_find(m->parent, v)]];
    return BRIO_OK;
}

/* --- the mesh, where nothing can fail any more --- */

static void move_vertices(const merger *m, brio_merge_stats *stats) {
    brio_mesh *mesh = m->mesh;
    size_t n = mesh->num_vertices, kept = 0;
    for (size_t v = 0; v < n; v++) {
        if (!m->stays[v]) continue;
        memmove(mesh->vertices + 3 * kept, mesh->vertices + 3 * v, 3 * sizeof *mesh->vertices);
        brio_properties_move(mesh->properties, mesh->num_properties, v, kept);
        kept++;
    }
    stats->vertices = n - kept;
    mesh->num_vertices = kept;
}

/* Returns whether at least three of some corners are distinct. No corner equals the next one. */
static bool has_three(const uint32_t *corner, size_t count) {
    for (size_t i = 2; i < count; i++)
        if (corner[i] != corner[0] && corner[i] != corner[1]) return true;
    return false;
}

/* Gives a face of the mesh its new corners, at `to`, without those that equal the next one. Returns their number, 0 if
 * fewer than three distinct ones are left. */
static size_t move_face(const merger *m, const uint32_t *from, size_t count, uint32_t *to) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t v = m->number[from[i]];
        if (kept == 0 || to[kept - 1] != v) to[kept++] = v;
    }
    while (kept > 1 && to[kept - 1] == to[0]) kept--;
    return has_three(to, kept) ? kept : 0;
}

static void move_faces(const merger *m, brio_merge_stats *stats) {
    brio_mesh *mesh = m->mesh;
    size_t kept = 0;
    uint64_t corners = 0, begin = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        uint64_t end = mesh->face_offsets[f + 1];
        size_t count = move_face(m, mesh->face_vertices + begin, (size_t)(end - begin), mesh->face_vertices + corners);
        begin = end;
        if (!count) continue;
        corners += count;
        brio_properties_move(mesh->face_properties, mesh->num_face_properties, f, kept);
        mesh->face_offsets[++kept] = corners;
    }
    stats->faces = mesh->num_faces - kept;
    mesh->num_faces = kept;
}

/* Gives tetrahedra, or edges, their new corners. Returns how many are left, those whose corners are distinct. */
static size_t move_cells(const merger *m, uint32_t *corners, size_t of_each, size_t count) {
    size_t kept = 0;
    for (size_t c = 0; c < count; c++) {
        uint32_t *to = corners + of_each * kept;
        bool distinct = true;
        for (size_t i = 0; i < of_each; i++) {
            to[i] = m->number[corners[of_each * c + i]];
            for (size_t j = 0; j < i; j++) distinct &= to[j] != to[i];
        }
        kept += distinct;
    }
    return kept;
}

static void change_mesh(const merger *m, brio_merge_stats *stats) {
    brio_mesh *mesh = m->mesh;
    size_t tetrahedra = mesh->num_tetrahedra, edges = mesh->num_edges;
    move_vertices(m, stats);
    if (mesh->num_faces) move_faces(m, stats);
    mesh->num_tetrahedra = move_cells(m, mesh->tetrahedra, 4, tetrahedra);
    mesh->num_edges = move_cells(m, mesh->edges, 2, edges);
    stats->tetrahedra = tetrahedra - mesh->num_tetrahedra;
    stats->edges = edges - mesh->num_edges;
}

/* --- the whole --- */

static brio_status check_indices(const merger *m, const uint32_t *indices, size_t count, const char *what) {
    for (size_t i = 0; i < count; i++)
        BRIO_EXPECT(m->ctx, indices[i] < m->mesh->num_vertices, BRIO_ERR_ARGUMENT, "%s: vertex %u of %zu", what,
                    indices[i], m->mesh->num_vertices);
    return BRIO_OK;
}

/* Checks the call, and finds the side of cells. */
static brio_status prepare(merger *m, double distance) {
    const brio_mesh *mesh = m->mesh;
    double largest = 0;
    BRIO_EXPECT(m->ctx, distance == 0 || (distance >= DBL_MIN && isfinite(distance)), BRIO_ERR_ARGUMENT,
                "a distance of %g between vertices that merge, expected 0 or a normal number above 0", distance);
    BRIO_FORWARD(brio_mesh_check_faces(m->ctx, mesh));
    BRIO_FORWARD(check_indices(m, mesh->tetrahedra, 4 * mesh->num_tetrahedra, "a tetrahedron"));
    BRIO_FORWARD(check_indices(m, mesh->edges, 2 * mesh->num_edges, "an edge"));
    BRIO_FORWARD(brio_refuse_vertices(m->ctx, mesh->vertices, mesh->num_vertices, "the mesh"));
    m->side = distance / 2 * WIDER;
    m->scale = distance > 0 ? ldexp(1, -ilogb(distance)) : 1;
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) largest = fmax(largest, fabs(mesh->vertices[i]));
    double within = (distance + fmin(brio_distance_rounding(largest), MOST_ROUNDED * distance)) * m->scale;
    m->square = within * within;
    BRIO_EXPECT(m->ctx, m->side == 0 || largest / m->side < MOST_PLACES, BRIO_ERR_ARGUMENT,
                "a distance of %g between vertices that merge, expected 0 or at least %g for coordinates of %g",
                distance, largest / MOST_PLACES * 4, largest);
    return BRIO_OK;
}

brio_status brio_mesh_merge_vertices(brio_mesh *mesh, double distance, brio_merge_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    merger m = {.ctx = mesh->context, .mesh = mesh};
    brio_merge_stats found = {.size = sizeof found};
    BRIO_TRY(BRIO_CHECK_RESULT(m.ctx, brio_merge_stats, stats));
    BRIO_TRY(prepare(&m, distance));
    BRIO_TRY(sort_vertices(&m));
    BRIO_TRY(join_cells(&m));
    if (m.side > 0) BRIO_TRY(join_neighbours(&m));
    BRIO_TRY(choose(&m));
    BRIO_TRY(brio_progress(m.ctx, "merge", 1));
    change_mesh(&m, &found);
    BRIO_GIVE(brio_merge_stats, stats, &found);
done:
    brio_release(m.ctx, m.order);
    brio_release(m.ctx, m.parent);
    brio_release(m.ctx, m.number);
    brio_release(m.ctx, m.stays);
    brio_release(m.ctx, m.cells);
    return status;
}
