/* Iso-surfaces whose triangles are Delaunay.
 *
 * Vertices are placed where edges of the grid cross the surface. A crossed cell is a cell with such an edge. The sites
 * are the vertices and the corners of crossed cells. The grid cuts the Delaunay triangulation of the sites into
 * pieces: each cell is a union of tetrahedra, which depend on the cell's sites only.
 *
 * No Delaunay edge joins an inside corner to an outside one. Along an edge of the grid a vertex lies between such
 * corners. A ball through two corners that are opposite in a face or in the cell contains the vertices on the edges
 * around them. So a tetrahedron with a corner takes the side of its corners; a tetrahedron without a corner takes the
 * side of its centroid. The surface is the boundary of the inside tetrahedra. It separates the corners, so no corner
 * is on it. A triangle with an empty ball among all sites has an empty ball among the vertices. So each triangle is
 * Delaunay, ties included, because the order of the sites breaks ties.
 *
 * Why cells are independent: take a ball centred in a cell that contains no corner of the cell. The nearest of all
 * corners is a corner of that cell, and lines of the grid that miss the cell are farther away than that corner. So the
 * ball meets the grid only in the cell's edges. The smallest balls of the segments on a cell's edges and of the
 * triangles in its faces are such balls. So segments and triangles are Delaunay, and so are the cell's tetrahedra,
 * whose balls are centred in the cell.
 *
 * The code works in slabs one cell thick. Triangles in the plane between two slabs occur from both sides; they are
 * dropped where both sides are inside. An edge of four triangles, where two sheets touch, is possible; each sheet then
 * gets its own vertices.
 *
 * Based on: Attali, Lachaud. Delaunay conforming iso-surface, skeleton extraction and noise removal. Computational
 * Geometry 2001.
 * Differs from the paper: the corners of the grid are sites, so the construction only labels tetrahedra. */
#include "base/sort.h"
#include "iso/iso_surface.h"
#include "mesh/split_vertices.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { AXES = 3, ROOT_WORK = 12 /* most evaluations for one root */, CELLS_AN_EVALUATION = 16 };

static const uint32_t NONE = UINT32_MAX;

/* Least distance of a vertex from the ends of its edge, as a share of the edge (chosen): a vertex must not be a
 * corner. Where doubles are too coarse, the distance is that of two neighbouring doubles. */
static const double LEAST_SHARE = 1.0 / 1024;

/* The facets of a positive tetrahedron, counterclockwise seen from outside; facet i is opposite to vertex i. */
static const uint8_t FACET[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

typedef enum { OUTSIDE, INSIDE, BEYOND } tet_side; /* BEYOND: outside the slab */

/* A point of a slab: a corner of its cells, or a vertex on one of their edges. */
typedef struct {
    uint32_t vertex; /* NONE for a corner */
    bool inside;     /* of a corner */
} site;

typedef struct {
    uint32_t *corners; /* three vertices for each triangle */
    size_t count, capacity;
} triangle_list;

/* The sides are two layers of nodes: 0 the lower, 1 the upper side of the slab in work. */
typedef struct {
    brio_context *ctx;
    const brio_implicit_grid *grid;
    double least;      /* least distance of a vertex from the ends of its edge */
    uint32_t z;        /* number of the slab */
    size_t work;       /* evaluations since the last report of progress */
    size_t row, layer; /* number of nodes of a row, of a layer */
    struct {
        double *value;         /* of each node */
        uint32_t *node_site;   /* of each node in this slab */
        uint32_t *edge_vertex; /* of each node and axis */
        uint32_t *edge_site;
    } side[2];
    site *sites;
    double *points; /* of the sites */
    uint8_t *label; /* tet_side of each tetrahedron of the slab */
    size_t num_sites, site_capacity, point_capacity, label_capacity;
    double *vertices;
    size_t num_vertices, vertex_capacity;
    triangle_list surface;
    triangle_list below, above; /* triangles in the plane under the slab, from both sides; in the plane over the slab */
    brio_progress_fn progress;  /* the caller's callback */
    void *progress_user;
} slab;

/* --- layers --- */

/* Counts evaluations, and reports progress every BRIO_IMPLICIT_WORK evaluations.   share  of the slab's work that is
 * done. */
static brio_status count_work(slab *s, size_t evaluations, double share) {
    s->work += evaluations;
    if (s->work < BRIO_IMPLICIT_WORK) return BRIO_OK;
    s->work = 0;
    return brio_implicit_progress(s->ctx, s->grid, s->z, share);
}

static void forget_sites(slab *s) {
    s->num_sites = 0;
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < s->layer; i++) s->side[side].node_site[i] = NONE;
        for (size_t i = 0; i < AXES * s->layer; i++) s->side[side].edge_site[i] = NONE;
    }
}

static brio_status fill_upper_layer(slab *s, uint32_t z) {
    for (size_t i = 0; i < AXES * s->layer; i++) s->side[1].edge_vertex[i] = NONE;
    return brio_implicit_layer(s->ctx, s->grid, z, s->side[1].value);
}

/* --- sites --- */

static brio_status add_site(slab *s, const site *new_site, const double *p, uint32_t *out) {
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, s->sites, s->site_capacity, s->num_sites + 1));
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, s->points, s->point_capacity, 3 * s->num_sites + 3));
    s->sites[s->num_sites] = *new_site;
    for (size_t k = 0; k < 3; k++) s->points[3 * s->num_sites + k] = p[k];
    *out = (uint32_t)s->num_sites++;
    return BRIO_OK;
}

/* Makes the corner at node (x, y, z) a site. */
static brio_status add_corner(slab *s, const uint32_t node[3], uint32_t lowest) {
    size_t i = node[1] * s->row + node[0];
    uint32_t side = node[2] - lowest, *slot = &s->side[side].node_site[i];
    double p[3];
    if (*slot != NONE) return BRIO_OK;
    site corner = {NONE, s->side[side].value[i] < 0};
    brio_implicit_node(s->grid, node, p);
    return add_site(s, &corner, p, slot);
}

/* Places a vertex on the edge from a node to the next one along an axis. */
static brio_status add_vertex(slab *s, const uint32_t node[3], uint32_t axis, double value, double next_value,
                              uint32_t *out) {
    uint32_t next[3] = {node[0], node[1], node[2]};
    double a[3], b[3];
    next[axis]++;
    BRIO_EXPECT(s->ctx, s->num_vertices < NONE, BRIO_ERR_TOO_LARGE, "a surface of 2^32 vertices");
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, s->vertices, s->vertex_capacity, 3 * s->num_vertices + 3));
    double *p = s->vertices + 3 * s->num_vertices;
    brio_implicit_node(s->grid, node, a);
    brio_implicit_node(s->grid, next, b);
    brio_implicit_root(s->grid, a, b, value, next_value, p);
    p[axis] = fmin(fmax(p[axis], a[axis] + s->least), b[axis] - s->least);
    *out = (uint32_t)s->num_vertices++;
    return count_work(s, ROOT_WORK, 0.5);
}

/* Makes the vertex between a node and the next node along an axis a site, when the surface passes between them. */
static brio_status add_crossing(slab *s, const uint32_t node[3], uint32_t axis, uint32_t lowest) {
    const size_t step[3] = {1, s->row, 0};
    size_t i = node[1] * s->row + node[0];
    uint32_t side = node[2] - lowest, next_side = side + (axis == 2);
    double value = s->side[side].value[i], next_value = s->side[next_side].value[i + step[axis]];
    uint32_t *vertex = &s->side[side].edge_vertex[AXES * i + axis], *slot = &s->side[side].edge_site[AXES * i + axis];
    if (*slot != NONE || (value < 0) == (next_value < 0)) return BRIO_OK;
    if (*vertex == NONE) BRIO_FORWARD(add_vertex(s, node, axis, value, next_value, vertex));
    site crossing = {.vertex = *vertex};
    return add_site(s, &crossing, s->vertices + 3 * (size_t)*vertex, slot);
}

static brio_status add_cell(slab *s, const uint32_t cell[3]) {
    for (uint32_t corner = 0; corner < 8; corner++) {
        uint32_t node[3];
        for (uint32_t k = 0; k < 3; k++) node[k] = cell[k] + (corner >> k & 1);
        BRIO_FORWARD(add_corner(s, node, cell[2]));
        for (uint32_t axis = 0; axis < AXES; axis++)
            if (!(corner >> axis & 1)) BRIO_FORWARD(add_crossing(s, node, axis, cell[2]));
    }
    return BRIO_OK;
}

/* Adds the sites of the slab's crossed cells. */
static brio_status add_cells(slab *s, uint32_t z) {
    for (uint32_t y = 0; y < s->grid->cells[1]; y++)
        for (uint32_t x = 0; x < s->grid->cells[0]; x++) {
            unsigned inside = 0;
            if (x % CELLS_AN_EVALUATION == 0) BRIO_FORWARD(count_work(s, 1, 0.5));
            for (unsigned c = 0; c < 8; c++)
                inside += s->side[c >> 2].value[(y + (c >> 1 & 1)) * s->row + x + (c & 1)] < 0;
            if (inside == 0 || inside == 8) continue;
            BRIO_FORWARD(add_cell(s, (const uint32_t[3]){x, y, z}));
        }
    return BRIO_OK;
}

/* --- labels --- */

/* Returns the side of a tetrahedron. The side of a tetrahedron with corners only, between crossed cells, does not
 * matter. */
static tet_side side_of(const slab *s, const uint32_t *v) {
    double centroid[3] = {0};
    if (v[3] == BRIO_INFINITE) return BEYOND;
    for (int i = 0; i < 4; i++) {
        const site *corner = &s->sites[v[i]];
        if (corner->vertex == NONE) return corner->inside ? INSIDE : OUTSIDE;
        for (size_t k = 0; k < 3; k++) centroid[k] += s->points[3 * (size_t)v[i] + k] / 4;
    }
    return s->grid->value(centroid, s->grid->user) < 0 ? INSIDE : OUTSIDE;
}

/* --- triangles --- */

static brio_status add_triangle(slab *s, triangle_list *list, const uint32_t corners[3]) {
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, list->corners, list->capacity, 3 * list->count + 3));
    memcpy(list->corners + 3 * list->count++, corners, 3 * sizeof *corners);
    return BRIO_OK;
}

/* Returns whether a facet at the border of the slab is in the plane over the slab; otherwise it is in the plane under
 * it. */
static bool is_above(const slab *s, const uint32_t *v, int facet) {
    double node[3];
    brio_implicit_node(s->grid, (const uint32_t[3]){0, 0, s->z}, node);
    for (int i = 0; i < 3; i++)
        if (s->points[3 * (size_t)v[FACET[facet][i]] + 2] == node[2]) return false;
    return true;
}

static brio_status add_facet(slab *s, const uint32_t *v, int facet, bool is_shared) {
    uint32_t corners[3];
    for (int i = 0; i < 3; i++) corners[i] = s->sites[v[FACET[facet][i]]].vertex;
    triangle_list *list = !is_shared ? &s->surface : is_above(s, v, facet) ? &s->above : &s->below;
    return add_triangle(s, list, corners);
}

static bool is_of_vertices(const slab *s, const uint32_t *v, int facet) {
    for (int i = 0; i < 3; i++)
        if (s->sites[v[FACET[facet][i]]].vertex == NONE) return false;
    return true;
}

static brio_status take_boundary(slab *s, const brio_triangulation *t) {
    const brio_delaunay_stats *stats = brio_triangulation_stats(t);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    size_t count = stats->tetrahedra + stats->hull_facets;
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, s->label, s->label_capacity, count));
    for (size_t i = 0; i < count; i++) {
        s->label[i] = (uint8_t)side_of(s, tet[i].vertex);
        BRIO_FORWARD(count_work(s, 1, 0.9));
    }
    for (size_t i = 0; i < count; i++)
        for (int f = 0; s->label[i] == INSIDE && f < 4; f++) {
            tet_side beyond = (tet_side)s->label[tet[i].mate[f] / 4];
            if (beyond == INSIDE || !is_of_vertices(s, tet[i].vertex, f)) continue;
            BRIO_FORWARD(add_facet(s, tet[i].vertex, f, beyond == BEYOND));
        }
    return BRIO_OK;
}

/* --- slabs --- */

/* Reports the triangulation's progress as progress of the slab; hides the triangulation's stages from the caller. */
static int pass_progress_on(const char *stage, double fraction, void *user) {
    const slab *s = user;
    (void)stage;
    return s->progress("surface", (s->z + 0.6 + 0.3 * fraction) / s->grid->cells[2], s->progress_user);
}

static brio_status triangulate(slab *s, brio_triangulation **out) {
    s->progress = s->ctx->progress;
    s->progress_user = s->ctx->progress_user;
    if (s->progress) brio_context_set_progress(s->ctx, pass_progress_on, s);
    brio_status status = brio_delaunay(s->ctx, s->points, NULL, s->num_sites, NULL, out);
    brio_context_set_progress(s->ctx, s->progress, s->progress_user);
    return status;
}

static brio_status march_slab(slab *s) {
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    forget_sites(s);
    BRIO_TRY(add_cells(s, s->z));
    if (s->num_sites) {
        BRIO_TRY(triangulate(s, &t));
        BRIO_TRY(take_boundary(s, t));
    }
done:
    brio_triangulation_free(t);
    return status;
}

static void upper_layer_becomes_lower(slab *s) {
    double *value = s->side[0].value;
    uint32_t *edge_vertex = s->side[0].edge_vertex;
    s->side[0].value = s->side[1].value;
    s->side[0].edge_vertex = s->side[1].edge_vertex;
    s->side[1].value = value;
    s->side[1].edge_vertex = edge_vertex;
}

/* --- planes between slabs --- */

static int compare_triangles(uint32_t a, uint32_t b, const void *user) {
    const uint32_t *s = user, *pair[2] = {s + 3 * (size_t)a, s + 3 * (size_t)b};
    uint32_t sorted[2][3];
    for (int i = 0; i < 2; i++) {
        uint32_t x = pair[i][0], y = pair[i][1], z = pair[i][2];
        uint32_t low = x < y ? x : y, high = x < y ? y : x;
        sorted[i][0] = low < z ? low : z;
        sorted[i][2] = high > z ? high : z;
        sorted[i][1] = x ^ y ^ z ^ sorted[i][0] ^ sorted[i][2];
    }
    for (int k = 0; k < 3; k++)
        if (sorted[0][k] != sorted[1][k]) return sorted[0][k] < sorted[1][k] ? -1 : 1;
    return 0;
}

/* Adds the triangles of a plane that occur from one side only, and empties the list. */
static brio_status settle_plane(slab *s, triangle_list *plane) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    const uint32_t *corners = plane->corners;
    size_t count = plane->count;
    BRIO_REQUIRE(s->ctx, count < NONE, BRIO_ERR_TOO_LARGE, "%zu triangles in a plane of the grid", count);
    BRIO_TRY(BRIO_ALLOC(s->ctx, order, count));
    for (size_t i = 0; i < count; i++) order[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(s->ctx, order, count, compare_triangles, corners));
    for (size_t i = 0; i < count; i++) {
        if (i + 1 < count && compare_triangles(order[i], order[i + 1], corners) == 0)
            i++;
        else
            BRIO_TRY(add_triangle(s, &s->surface, corners + 3 * (size_t)order[i]));
    }
    plane->count = 0;
done:
    brio_release(s->ctx, order);
    return status;
}

/* Settles the plane under the slab, which is complete. Then the plane over the slab becomes the plane under the next
 * slab. */
static brio_status settle_lower_plane(slab *s) {
    brio_status status = settle_plane(s, &s->below);
    triangle_list empty = s->below;
    s->below = s->above;
    s->above = empty;
    return status;
}

/* --- the grid --- */

/* Rounds the grid so that all its nodes are doubles: multiples of the unit, which is the distance of neighbouring
 * doubles at the largest coordinate. Otherwise rounded nodes could coincide, or leave no double between them for a
 * vertex.   *least  least distance of a vertex from the ends of its edge. */
static brio_status settle_grid(brio_context *ctx, brio_implicit_grid *grid, double *least) {
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fmax(fabs(grid->low[k]), fabs(grid->low[k] + (grid->cells[k] + 1.0) * grid->cell)));
    double unit = fmax(ldexp(1, ilogb(most) + 1 - (DBL_MANT_DIG - 1)), DBL_TRUE_MIN);
    grid->cell = ceil(grid->cell / unit) * unit;
    for (int k = 0; k < 3; k++) grid->low[k] = floor(grid->low[k] / unit) * unit;
    *least = fmax(LEAST_SHARE * grid->cell, unit);
    BRIO_EXPECT(ctx, 2 * unit <= grid->cell, BRIO_ERR_NO_ANSWER,
                "cells of %g are too small at coordinates of %g: doubles are %g apart there", grid->cell, most, unit);
    return BRIO_OK;
}

/* --- all of it --- */

static brio_status slab_start(slab *s) {
    for (int i = 0; i < 2; i++) {
        BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->side[i].value, s->layer));
        BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->side[i].node_site, s->layer));
        BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->side[i].edge_vertex, AXES * s->layer));
        BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->side[i].edge_site, AXES * s->layer));
    }
    return BRIO_OK;
}

static void slab_free(slab *s) {
    for (int i = 0; i < 2; i++) {
        brio_release(s->ctx, s->side[i].value);
        brio_release(s->ctx, s->side[i].node_site);
        brio_release(s->ctx, s->side[i].edge_vertex);
        brio_release(s->ctx, s->side[i].edge_site);
    }
    brio_release(s->ctx, s->sites);
    brio_release(s->ctx, s->points);
    brio_release(s->ctx, s->label);
    brio_release(s->ctx, s->vertices);
    brio_release(s->ctx, s->surface.corners);
    brio_release(s->ctx, s->below.corners);
    brio_release(s->ctx, s->above.corners);
}

brio_status brio_conforming_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_implicit_grid settled = *grid;
    slab s = {.ctx = ctx, .grid = &settled, .row = (size_t)grid->cells[0] + 1};
    s.layer = s.row * ((size_t)grid->cells[1] + 1);
    *out = NULL;
    BRIO_TRY(brio_implicit_check(ctx, grid));
    BRIO_TRY(brio_implicit_progress(ctx, grid, 0, 0));
    BRIO_TRY(settle_grid(ctx, &settled, &s.least));
    BRIO_TRY(slab_start(&s));
    BRIO_TRY(fill_upper_layer(&s, 0));
    for (s.z = 0; s.z < grid->cells[2]; s.z++) {
        upper_layer_becomes_lower(&s);
        BRIO_TRY(fill_upper_layer(&s, s.z + 1));
        BRIO_TRY(march_slab(&s));
        BRIO_TRY(settle_lower_plane(&s));
        BRIO_TRY(brio_implicit_progress(ctx, grid, s.z, 1));
    }
    BRIO_TRY(settle_plane(&s, &s.below));
    BRIO_TRY(brio_mesh_of_triangles(ctx, &s.vertices, s.num_vertices, &s.surface.corners, s.surface.count, out));
    BRIO_TRY(brio_mesh_split_sheets(ctx, *out));
done:
    slab_free(&s);
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
    }
    return status;
}
