/* Iso-surfaces by marching tetrahedra.
 *
 * Every cube of the grid is cut into the six tetrahedra round its diagonal from least to greatest corner (Kuhn's
 * subdivision). All cubes are cut alike, so the cuts agree on shared faces and the tetrahedra form one complex. The
 * zero set of a piecewise linear function on a complex is a manifold when no node is zero. Here each node is inside or
 * outside, so no node counts as zero. A tetrahedron with both kinds of nodes adds one or two triangles. Their vertices
 * are on edges of the complex, at roots of the function itself.
 *
 * An edge joins a node to one of the seven nodes above it in the order of coordinates; (node, direction) names the
 * edge. Cubes are visited layer by layer. A table holds the vertices on the edges of two layers of nodes, so every
 * edge has one vertex and memory is that of two layers.
 *
 * Based on: Doi, Koide. An efficient method of triangulating equi-valued surfaces by using tetrahedral cells. IEICE
 * Transactions 1991. */
#include "iso/iso_surface.h"
#include "base/team.h"
#include <math.h>

enum {
    DIRECTIONS = 7,
    ROOT_STEPS = 12,
    NODES_A_THREAD = 1 << 9,
    ROWS_A_CHUNK = 8 /* rows that a thread takes at once; chosen */
};

static const uint32_t NO_VERTEX = UINT32_MAX;

/* A corner of a cube is a number of three bits: bit 0 for x, bit 1 for y, bit 2 for z. All six tetrahedra are
 * positive. */
static const uint8_t TETRAHEDRA[6][4] = {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7},
                                         {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}};

/* For each set of inside vertices of a tetrahedron (bit i for vertex i): an even permutation that puts the inside
 * vertices first. With three inside vertices it puts the outside vertex first. */
static const uint8_t INSIDE_FIRST[16][4] = {
    {0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 3, 1}, {1, 2, 0, 3}, {3, 0, 2, 1},
    {3, 0, 2, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 0, 1, 3}, {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {0, 1, 2, 3}};

/* Layers of nodes are z = constant. value[0] and edge_vertex[0] belong to the lower layer of the cubes in work,
 * value[1] and edge_vertex[1] to the upper one. */
typedef struct {
    brio_context *ctx;
    const brio_implicit_grid *grid;
    size_t row, layer;        /* number of nodes of a row, of a layer */
    double *value[2];         /* of each node */
    uint32_t *edge_vertex[2]; /* of each node and direction - 1 */
    double *vertices;
    uint32_t *triangles;
    size_t num_vertices, vertex_capacity, num_triangles, triangle_capacity;
} marcher;

/* --- layers --- */

void brio_implicit_node(const brio_implicit_grid *grid, const uint32_t node[3], double *p) {
    for (int k = 0; k < 3; k++) p[k] = grid->low[k] + node[k] * grid->cell;
}

brio_status brio_implicit_cells(brio_context *ctx, double cells, uint32_t *out) {
    *out = 0;
    BRIO_EXPECT(ctx, cells >= 0 && cells <= BRIO_MOST_CELLS, BRIO_ERR_TOO_LARGE,
                "a grid of %g cells along an axis: expected at most %d", cells, BRIO_MOST_CELLS);
    *out = (uint32_t)cells;
    return BRIO_OK;
}

brio_status brio_implicit_check(brio_context *ctx, const brio_implicit_grid *grid) {
    const uint32_t *cells = grid->cells;
    bool finite = isfinite(grid->cell) && grid->cell > 0, large = false;
    for (int k = 0; k < 3; k++) {
        finite = finite && isfinite(grid->low[k]) && isfinite(grid->low[k] + cells[k] * grid->cell) && cells[k] > 0;
        large = large || cells[k] > BRIO_MOST_CELLS;
    }
    BRIO_EXPECT(ctx, finite, BRIO_ERR_ARGUMENT, "a grid of %u x %u x %u cells with the side %g is no grid", cells[0],
                cells[1], cells[2], grid->cell);
    BRIO_EXPECT(ctx, !large && (cells[0] + 1.0) * (cells[1] + 1.0) < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "a grid of %u x %u x %u cells: expected at most 2^32 nodes in a layer", cells[0], cells[1], cells[2]);
    return BRIO_OK;
}

brio_status brio_implicit_progress(brio_context *ctx, const brio_implicit_grid *grid, uint32_t z, double share) {
    return brio_progress(ctx, "surface", (z + share) / grid->cells[2]);
}

typedef struct {
    const brio_implicit_grid *grid;
    uint32_t z, from; /* the layer, and the first row of this part */
    double *values;
    bool closed; /* no value on the border of the grid is negative */
} layer_job;

/* Evaluates a row of nodes. Returns whether no value on the border of the grid is negative. */
static bool fill_row(const layer_job *job, uint32_t y) {
    const uint32_t *cells = job->grid->cells;
    double *values = job->values + y * ((size_t)cells[0] + 1);
    bool closed = true, border_row = job->z == 0 || job->z == cells[2] || y == 0 || y == cells[1];
    for (uint32_t x = 0; x <= cells[0]; x++) {
        double p[3];
        brio_implicit_node(job->grid, (const uint32_t[3]){x, y, job->z}, p);
        values[x] = job->grid->value(p, job->grid->user);
        if (values[x] < 0 && (border_row || x == 0 || x == cells[0])) closed = false;
    }
    return closed;
}

static void fill_rows(void *user, size_t begin, size_t end, int thread) {
    layer_job *job = user;
    bool closed = true;
    (void)thread;
    for (size_t y = begin; y < end; y++) closed &= fill_row(job, job->from + (uint32_t)y);
    if (!closed) __atomic_store_n(&job->closed, false, __ATOMIC_RELAXED); /* read after all threads have ended */
}

/* Reports the evaluation of a layer as the first half of the work on the cells below the layer. */
brio_status brio_implicit_layer(brio_context *ctx, const brio_implicit_grid *grid, uint32_t z, double *values) {
    uint32_t rows = grid->cells[1] + 1;
    size_t step = (size_t)BRIO_IMPLICIT_WORK * (size_t)brio_context_threads(ctx) / ((size_t)grid->cells[0] + 1) + 1;
    bool closed = true;
    for (uint32_t y = 0; y < rows;) {
        uint32_t end = rows - y < step ? rows : y + (uint32_t)step;
        size_t nodes = ((size_t)grid->cells[0] + 1) * (end - y);
        layer_job job = {grid, z, y, values, true};
        BRIO_FORWARD(
            brio_for_chunks(ctx, brio_threads(ctx, nodes, NODES_A_THREAD), end - y, ROWS_A_CHUNK, fill_rows, &job));
        closed = job.closed && closed;
        y = end;
        BRIO_FORWARD(brio_implicit_progress(ctx, grid, z ? z - 1 : 0, z ? 0.5 * y / rows : 0));
    }
    BRIO_EXPECT(ctx, closed, BRIO_ERR_ARGUMENT, "the function is negative on the border of the grid");
    return BRIO_OK;
}

/* Evaluates layer z into slot 1 and clears the edges of the layer that slot 1 held. */
static brio_status fill_upper_layer(marcher *m, uint32_t z) {
    BRIO_FORWARD(brio_implicit_layer(m->ctx, m->grid, z, m->value[1]));
    for (size_t i = 0; i < m->layer * DIRECTIONS; i++) m->edge_vertex[1][i] = NO_VERTEX;
    return BRIO_OK;
}

static void upper_layer_becomes_lower(marcher *m) {
    double *value = m->value[0];
    uint32_t *edge_vertex = m->edge_vertex[0];
    m->value[0] = m->value[1];
    m->edge_vertex[0] = m->edge_vertex[1];
    m->value[1] = value;
    m->edge_vertex[1] = edge_vertex;
}

/* --- vertices --- */

/* Finds the root by regula falsi in the Illinois variant: it halves the value at an end that stays, so that both ends
 * converge. */
void brio_implicit_root(const brio_implicit_grid *grid, const double *a, const double *b, double f_a, double f_b,
                        double *p) {
    double s = 0, t = 1, root = 0.5;
    for (int step = 0, side = 0; step < ROOT_STEPS; step++) {
        root = f_a == f_b ? 0.5 * (s + t) : s + (t - s) * (f_a / (f_a - f_b));
        for (int k = 0; k < 3; k++) p[k] = a[k] + root * (b[k] - a[k]);
        double f = grid->value(p, grid->user);
        if (f == 0 || t - s < 1e-12) return;
        if ((f < 0) == (f_a < 0)) {
            s = root;
            f_a = f;
            if (side == 1) f_b /= 2;
            side = 1;
        } else {
            t = root;
            f_b = f;
            if (side == 2) f_a /= 2;
            side = 2;
        }
    }
}

/* Returns the vertex on the edge between two corners of cube (x, y, z); makes the vertex when the edge has none yet. */
static brio_status vertex_on_edge(marcher *m, const uint32_t cube[3], uint32_t corner, uint32_t other, uint32_t *out) {
    uint32_t low = corner < other ? corner : other, high = corner ^ other ^ low;
    uint32_t at[2][3];
    size_t node[2];
    double p[2][3];
    for (int end = 0; end < 2; end++) {
        uint32_t bits = end ? high : low;
        for (int k = 0; k < 3; k++) at[end][k] = cube[k] + (bits >> k & 1);
        node[end] = at[end][1] * m->row + at[end][0];
    }
    uint32_t *slot = &m->edge_vertex[low >> 2][node[0] * DIRECTIONS + (low ^ high) - 1];
    if (*slot == NO_VERTEX) {
        BRIO_EXPECT(m->ctx, m->num_vertices < NO_VERTEX, BRIO_ERR_TOO_LARGE, "a surface of 2^32 vertices");
        BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->vertices, m->vertex_capacity, 3 * m->num_vertices + 3));
        for (int end = 0; end < 2; end++) brio_implicit_node(m->grid, at[end], p[end]);
        brio_implicit_root(m->grid, p[0], p[1], m->value[low >> 2][node[0]], m->value[high >> 2][node[1]],
                           m->vertices + 3 * m->num_vertices);
        *slot = (uint32_t)m->num_vertices++;
    }
    *out = *slot;
    return BRIO_OK;
}

/* --- triangles --- */

static brio_status add_triangle(marcher *m, uint32_t a, uint32_t b, uint32_t c) {
    BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->triangles, m->triangle_capacity, 3 * m->num_triangles + 3));
    uint32_t *triangle = m->triangles + 3 * m->num_triangles++;
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    return BRIO_OK;
}

/* Adds the surface inside one tetrahedron. In a positive tetrahedron (a, b, c, d) with only a inside, triangle (ab,
 * ac, ad) faces away from a. With a and b inside, quadrilateral (ac, ad, bd, bc) faces away from both. */
static brio_status march_tetrahedron(marcher *m, const uint32_t cube[3], const uint8_t *tetrahedron, unsigned inside) {
    unsigned set = 0;
    for (unsigned i = 0; i < 4; i++) set |= (inside >> tetrahedron[i] & 1) << i;
    if (set == 0 || set == 15) return BRIO_OK;
    uint32_t corner[4], v[4];
    for (int i = 0; i < 4; i++) corner[i] = tetrahedron[INSIDE_FIRST[set][i]];
    int count = __builtin_popcount(set);
    if (count == 2) {
        BRIO_FORWARD(vertex_on_edge(m, cube, corner[0], corner[2], &v[0]));
        BRIO_FORWARD(vertex_on_edge(m, cube, corner[0], corner[3], &v[1]));
        BRIO_FORWARD(vertex_on_edge(m, cube, corner[1], corner[3], &v[2]));
        BRIO_FORWARD(vertex_on_edge(m, cube, corner[1], corner[2], &v[3]));
        BRIO_FORWARD(add_triangle(m, v[0], v[1], v[2]));
        BRIO_FORWARD(add_triangle(m, v[0], v[2], v[3]));
        return BRIO_OK;
    }
    for (int i = 0; i < 3; i++) BRIO_FORWARD(vertex_on_edge(m, cube, corner[0], corner[i + 1], &v[i]));
    return count == 1 ? add_triangle(m, v[0], v[1], v[2]) : add_triangle(m, v[2], v[1], v[0]);
}

static brio_status march_layer(marcher *m, uint32_t z) {
    const size_t most = BRIO_IMPLICIT_WORK / (ROOT_STEPS * DIRECTIONS); /* cubes between two reports of progress */
    size_t work = 0;
    for (uint32_t y = 0; y < m->grid->cells[1]; y++)
        for (uint32_t x = 0; x < m->grid->cells[0]; x++) {
            const uint32_t cube[3] = {x, y, z};
            unsigned inside = 0;
            for (unsigned c = 0; c < 8; c++) {
                size_t node = (y + (c >> 1 & 1)) * m->row + x + (c & 1);
                inside |= (unsigned)(m->value[c >> 2][node] < 0) << c;
            }
            if (inside == 0 || inside == 255) continue;
            for (int t = 0; t < 6; t++) BRIO_FORWARD(march_tetrahedron(m, cube, TETRAHEDRA[t], inside));
            if (++work % most == 0)
                BRIO_FORWARD(brio_implicit_progress(m->ctx, m->grid, z, 0.5 + 0.5 * y / m->grid->cells[1]));
        }
    return BRIO_OK;
}

/* --- all of it --- */

brio_status brio_mesh_of_triangles(brio_context *ctx, double **vertices, size_t num_vertices, uint32_t **triangles,
                                   size_t num_triangles, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    *out = NULL;
    BRIO_TRY(BRIO_RESIZE(ctx, *vertices, 3 * num_vertices));
    BRIO_TRY(BRIO_RESIZE(ctx, *triangles, 3 * num_triangles));
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(BRIO_ALLOC(ctx, mesh->face_offsets, num_triangles + 1));
    for (size_t f = 0; f <= num_triangles; f++) mesh->face_offsets[f] = 3 * f;
    mesh->num_vertices = num_vertices;
    mesh->vertices = *vertices;
    mesh->num_faces = num_triangles;
    mesh->face_vertices = *triangles;
    *vertices = NULL;
    *triangles = NULL;
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    return status;
}

brio_status brio_marched_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out) {
    brio_status status = BRIO_OK;
    marcher m = {.ctx = ctx, .grid = grid, .row = (size_t)grid->cells[0] + 1};
    m.layer = m.row * ((size_t)grid->cells[1] + 1);
    *out = NULL;
    BRIO_TRY(brio_implicit_check(ctx, grid));
    BRIO_TRY(brio_implicit_progress(ctx, grid, 0, 0));
    for (int i = 0; i < 2; i++) {
        BRIO_TRY(BRIO_ALLOC(ctx, m.value[i], m.layer));
        BRIO_TRY(BRIO_ALLOC(ctx, m.edge_vertex[i], m.layer * DIRECTIONS));
    }
    BRIO_TRY(fill_upper_layer(&m, 0));
    for (uint32_t z = 0; z < grid->cells[2]; z++) {
        upper_layer_becomes_lower(&m);
        BRIO_TRY(fill_upper_layer(&m, z + 1));
        BRIO_TRY(march_layer(&m, z));
        BRIO_TRY(brio_implicit_progress(ctx, grid, z, 1));
    }
    BRIO_TRY(brio_mesh_of_triangles(ctx, &m.vertices, m.num_vertices, &m.triangles, m.num_triangles, out));
done:
    for (int i = 0; i < 2; i++) {
        brio_release(ctx, m.value[i]);
        brio_release(ctx, m.edge_vertex[i]);
    }
    brio_release(ctx, m.vertices);
    brio_release(ctx, m.triangles);
    return status;
}
