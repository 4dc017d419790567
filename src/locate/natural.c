/* Sibson's coordinates of a query, from its cavity.
 *
 * The cavity is the set of tetrahedra whose circumspheres hold the query x (Bowyer, Watson). Inserted, x would take
 * from the Voronoi cell of each vertex a of the cavity a convex polytope R(a). Its corners are circumcentres of the
 * cavity's tetrahedra, and circumcentres of x with the facets on the cavity's border. Its facets are on the bisector of
 * a and x, and, for every edge ab of the cavity, on the bisector of a and b. The coordinate of a is the volume of R(a),
 * divided by the sum of all these volumes.
 *
 * Each facet of the cavity's tetrahedra is dual to one segment between two centres. The segments go round the polygon
 * on the bisector of ab, for each of the three edges of the facet. Summed up as cross products they give the polygon's
 * vector area, relative to a corner of the polygon. If ab is on the border, that corner is one of the two on the
 * bisector with x, so that the segment between these two adds nothing. The volume of R(a) is the sum of the cones over
 * its polygons from a corner on the bisector of a and x, so that the facet there adds nothing either. All heights and
 * areas are positive up to rounding; nothing large cancels, even where x is in the plane of a facet.
 *
 * Rounding leaves an error in what the coordinates must reproduce: x itself. The last step changes each coordinate by a
 * factor 1 + g . (a - x) + c near 1, with g and c such that the sum of the coordinates is 1 and x is reproduced. Where
 * the neighbours are in a plane up to rounding, as on the sides of a turned box, g may be anything: so x is looked for
 * at the end.
 *
 * Based on: Sibson. A vector identity for the Dirichlet tessellation. Math. Proc. Cambridge 1980.
 *           Ledoux, Gold. An efficient natural neighbour interpolation algorithm for geoscientific modelling. SDH 2005.
 * Differs from the paper (Ledoux, Gold): x is not inserted and removed; the volumes come from the cavity alone, and the
 * last step is new. */
#include "locate/natural.h"
#include "base/flat_shares.h"
#include "base/scale.h"
#include "base/vector.h"
#include "predicates/circumcentre.h"
#include <string.h>

/* --- barycentric coordinates --- */

/* Coordinates of a query in the tetrahedron that holds it: the volumes of the four tetrahedra that the query makes with
 * the facets, divided by their sum. Coordinates are relative to the query.
 *
 * A flat tetrahedron makes the volumes inexact. So the shares are refined: while the shares do not reproduce the query,
 * the shares of the residual are taken off. Where that does not reproduce the query, the tetrahedron is flat up to
 * rounding, and its faces take its place (base/flat_shares.h). So linear functions are reproduced almost to the
 * rounding of their values, whatever the shape. */

enum { REFINEMENTS = 2 };

/* Returns a power of two that scales the offsets from x to these places to at most 1, or 0 if doubles cannot hold the
 *  offsets. */
static double offset_scale(const brio_locator *l, const uint32_t *places, size_t count, const double *x) {
    double most = 0;
    int exponent;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(l->record[places[i]][k] - x[k]));
    if (!(most < INFINITY)) return 0;
    frexp(most, &exponent);
    return exponent < -1000 ? 0x1p1000 : exponent > 1000 ? 0x1p-1020 : brio_power_of_two(-exponent);
}

/* Returns det [a, b, c]. */
static double triple(const double *a, const double *b, const double *c) {
    double bc[3];
    brio_cross(b, c, bc);
    return brio_dot(a, bc);
}

/* Sets share to the solution of sum share[i] row[i] = target, sum share[i] = total: Cramer's rule. */
static bool solve(const double row[4][3], const double *target, double total, double share[4]) {
    double edge[3][3], rest[3], volume;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) edge[i][k] = row[i + 1][k] - row[0][k];
        rest[k] = target[k] - total * row[0][k];
    }
    volume = triple(edge[0], edge[1], edge[2]);
    share[1] = triple(rest, edge[1], edge[2]) / volume;
    share[2] = triple(edge[0], rest, edge[2]) / volume;
    share[3] = triple(edge[0], edge[1], rest) / volume;
    share[0] = total - share[1] - share[2] - share[3];
    return isfinite(share[0]);
}

/* Sets residual to -sum share[i] row[i]. */
static void find_residual(const double row[4][3], const double share[4], double residual[3]) {
    for (int k = 0; k < 3; k++) {
        residual[k] = 0;
        for (int i = 0; i < 4; i++) residual[k] -= share[i] * row[i][k];
    }
}

/* Clears the shares that are 0 exactly or would be negative, and divides the others by their sum. */
static void normalize(unsigned zeros, double share[4]) {
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        if (zeros >> i & 1 || !(share[i] > 0)) share[i] = 0;
        sum += share[i];
    }
    for (int i = 0; i < 4; i++) share[i] = sum > 0 ? share[i] / sum : 0.25;
}

void brio_barycentric(const brio_locator *l, const brio_holder *h, const double *x, double share[4]) {
    const uint32_t *v = l->t.tet[h->tet].vertex;
    double row[4][3], residual[3] = {0, 0, 0}, more[4], scale = offset_scale(l, v, 4, x);
    if (__builtin_popcount(h->zeros) == 3) {
        for (int i = 0; i < 4; i++) share[i] = !(h->zeros >> i & 1);
        return;
    }
    for (int i = 0; i < 4; i++) brio_offset(l, v[i], x, scale, row[i]);
    bool solved = solve(row, residual, 1, share);
    for (int n = 0; n < REFINEMENTS && solved; n++) {
        find_residual(row, share, residual);
        solved = solve(row, residual, 0, more);
        for (int i = 0; i < 4 && solved; i++) share[i] += more[i];
    }
    normalize(h->zeros, share);
    if (!brio_shares_hold((const double(*)[3])row, 4, share))
        brio_flat_shares((const double(*)[3])row, 4, h->zeros, share);
}

/* --- numbers of indices --- */

/* A small map from keys to numbers. */

enum { FIRST_CAPACITY = 256 };

brio_status brio_map_grow(brio_context *ctx, brio_index_map *map) {
    brio_index_map larger = {.capacity = map->capacity ? 2 * map->capacity : FIRST_CAPACITY, .generation = 1};
    brio_status status = BRIO_ALLOC_ZERO(ctx, larger.entry, larger.capacity);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < map->capacity; i++) {
        if (map->entry[i].generation != map->generation) continue;
        brio_map_entry *e = &larger.entry[brio_map_place(&larger, map->entry[i].key)];
        *e = (brio_map_entry){map->entry[i].key, 1, map->entry[i].value};
        larger.size++;
    }
    brio_release(ctx, map->entry);
    *map = larger;
    return BRIO_OK;
}

/* Forgets all keys. */
static void map_clear(brio_index_map *map) {
    map->size = 0;
    if (!map->capacity || ++map->generation) return;
    memset(map->entry, 0, map->capacity * sizeof *map->entry);
    map->generation = 1;
}

/* --- natural coordinates --- */

void brio_natural_free(brio_natural *n) {
    void *const block[] = {n->tets.entry, n->vertices.entry, n->edges.entry, n->tet,   n->place, n->corner,
                           n->offset,     n->centre,         n->base,        n->share, n->edge,  n->facet};
    if (!n->ctx) return;
    for (size_t i = 0; i < sizeof block / sizeof *block; i++) brio_release(n->ctx, block[i]);
    *n = (brio_natural){0};
}

/* --- the cavity --- */

enum { OUTSIDE = UINT32_MAX };

static brio_status add_tetrahedron(brio_natural *n, uint32_t tet) {
    brio_status status = BRIO_RESERVE(n->ctx, n->tet, n->tet_room, n->num_tets + 1);
    if (status == BRIO_OK) n->tet[n->num_tets++] = tet;
    return status;
}

/* Sets *number to the place of a tetrahedron in the cavity, or to OUTSIDE. Adds a tetrahedron that was not met before
 * and is in conflict. x is strictly inside the hull, so infinite tetrahedra are outside. */
static brio_status meet(brio_natural *n, brio_querent *q, uint32_t tet, const double *x, uint32_t *number) {
    bool is_new;
    uint32_t *value;
    *number = OUTSIDE;
    if (tet >= q->l->num_finite) return BRIO_OK;
    brio_status status = brio_map_find(n->ctx, &n->tets, tet, OUTSIDE, &value, &is_new);
    if (status != BRIO_OK) return status;
    if (is_new && brio_in_conflict(&q->l->t, &q->filter, tet, x, false)) {
        *value = (uint32_t)n->num_tets;
        status = add_tetrahedron(n, tet);
    }
    *number = *value;
    return status;
}

/* Sets *local to the number of a vertex. */
static brio_status add_vertex(brio_natural *n, uint32_t place, uint32_t *local) {
    bool is_new;
    uint32_t *value;
    BRIO_FORWARD(brio_map_find(n->ctx, &n->vertices, place, (uint32_t)n->num_vertices, &value, &is_new));
    *local = *value;
    if (!is_new) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->place, n->place_room, n->num_vertices + 1));
    n->place[n->num_vertices++] = place;
    return BRIO_OK;
}

static brio_status add_centre(brio_natural *n, const uint32_t corner[4], uint32_t *centre) {
    brio_status status = BRIO_RESERVE(n->ctx, n->corner, n->corner_room, n->num_centres + 1);
    if (status != BRIO_OK) return status;
    for (int i = 0; i < 4; i++) n->corner[n->num_centres][i] = corner[i];
    *centre = (uint32_t)n->num_centres++;
    return BRIO_OK;
}

/* Adds the facet opposite to slot i of tetrahedron `from`, seen from there, with the centre behind it. */
static brio_status add_edge(brio_natural *n, uint32_t from, int i, uint32_t to) {
    const uint32_t *corner = n->corner[from];
    brio_status status = BRIO_RESERVE(n->ctx, n->edge, n->edge_room, n->num_edges + 1);
    if (status != BRIO_OK) return status;
    brio_dual_edge *e = &n->edge[n->num_edges++];
    for (int k = 0; k < 3; k++) e->corner[k] = corner[BRIO_FACET[i][k]];
    e->from = from, e->to = to;
    return BRIO_OK;
}

/* Digs out the cavity from a tetrahedron that holds x: the centres of its tetrahedra have the tetrahedra's numbers. */
static brio_status dig(brio_natural *n, brio_querent *q, uint32_t first, const double *x) {
    uint32_t number, unused, corner[4];
    BRIO_FORWARD(meet(n, q, first, x, &number));
    for (size_t i = 0; i < n->num_tets; i++) {
        const brio_tetrahedron *tet = &q->l->t.tet[n->tet[i]];
        for (int k = 0; k < 4; k++) {
            BRIO_FORWARD(add_vertex(n, tet->vertex[k], &corner[k]));
            BRIO_FORWARD(meet(n, q, brio_tet_of(tet->mate[k]), x, &number));
        }
        BRIO_FORWARD(add_centre(n, corner, &unused));
    }
    return BRIO_OK;
}

/* Lists the dual edges: of the border, each with a centre of its own, then of the facets inside, each once. */
static brio_status list_edges(brio_natural *n, brio_querent *q, const double *x) {
    uint32_t other, centre;
    for (int inside = 0; inside < 2; inside++)
        for (uint32_t i = 0; i < n->num_tets; i++)
            for (int k = 0; k < 4; k++) {
                const brio_tetrahedron *tet = &q->l->t.tet[n->tet[i]];
                BRIO_FORWARD(meet(n, q, brio_tet_of(tet->mate[k]), x, &other));
                if (inside && other != OUTSIDE && i < other) BRIO_FORWARD(add_edge(n, i, k, other));
                if (inside || other != OUTSIDE) continue;
                const uint32_t *c = n->corner[i];
                const uint8_t *f = BRIO_FACET[k];
                BRIO_FORWARD(add_centre(n, (const uint32_t[4]){c[f[0]], c[f[1]], c[f[2]], 0}, &centre));
                BRIO_FORWARD(add_edge(n, i, k, centre));
            }
    return BRIO_OK;
}

/* --- volumes --- */

/* Computes the offsets of the vertices and the centres. *found becomes false where doubles do not hold them. */
static brio_status find_centres(brio_natural *n, const brio_locator *l, const double *x, bool *found) {
    double scale = offset_scale(l, n->place + 1, n->num_vertices - 1, x);
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->offset, n->offset_room, n->num_vertices));
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->centre, n->centre_room, n->num_centres));
    for (int k = 0; k < 3; k++) n->offset[0][k] = 0;
    for (size_t v = 1; v < n->num_vertices; v++) brio_offset(l, n->place[v], x, scale, n->offset[v]);
    for (size_t c = 0; c < n->num_centres; c += BRIO_CENTRE_BATCH) {
        size_t left = n->num_centres - c, count = left < BRIO_CENTRE_BATCH ? left : BRIO_CENTRE_BATCH;
        brio_centres(&(brio_centre_batch){*n->offset, NULL, (const uint32_t(*)[4])n->corner + c, count}, n->centre[c],
                     NULL);
    }
    *found = scale > 0;
    for (size_t c = 0; c < n->num_centres; c++) *found &= isfinite(n->centre[c][0]);
    return BRIO_OK;
}

/* Adds a segment between centres to the polygon of a directed edge. */
static brio_status add_segment(brio_natural *n, uint32_t a, uint32_t b, const brio_dual_edge *e) {
    bool is_new, forward = a < b;
    uint32_t *value, low = forward ? a : b, high = forward ? b : a;
    BRIO_FORWARD(
        brio_map_find(n->ctx, &n->edges, (uint64_t)low << 32 | high, (uint32_t)n->num_facets, &value, &is_new));
    if (is_new) {
        BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->facet, n->facet_room, n->num_facets + 1));
        n->facet[n->num_facets++] = (brio_dual_facet){{low, high}, e->to, {0, 0, 0}};
    }
    brio_dual_facet *f = &n->facet[*value];
    const double *origin = n->centre[f->origin], *from = n->centre[e->from], *to = n->centre[e->to];
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = from[k] - origin[k], v[k] = to[k] - origin[k];
    brio_cross(u, v, w);
    for (int k = 0; k < 3; k++) f->area[k] += forward ? -w[k] : w[k];
    return BRIO_OK;
}

static brio_status find_facets(brio_natural *n) {
    for (size_t i = 0; i < n->num_edges; i++) {
        const brio_dual_edge *e = &n->edge[i];
        for (int k = 0; k < 3; k++) {
            BRIO_FORWARD(add_segment(n, e->corner[k], e->corner[(k + 1) % 3], e));
            if (e->to >= n->num_tets) n->base[e->corner[k]] = e->to;
        }
    }
    return BRIO_OK;
}

/* Adds to the volume of R(a) the cone over a facet between the cells of a and b, times 6 |b - a|^2. */
static double cone(const brio_natural *n, uint32_t a, uint32_t b, const brio_dual_facet *f, double sign) {
    const double *p = n->offset[a], *q = n->offset[b], *base = n->centre[n->base[a]];
    double along[3], height = 0;
    for (int k = 0; k < 3; k++) along[k] = q[k] - p[k];
    for (int k = 0; k < 3; k++) height += (0.5 * p[k] + 0.5 * q[k] - base[k]) * along[k];
    return sign * brio_dot(f->area, along) * height / brio_dot(along, along);
}

/* Sets the shares to the volumes, and returns their sum. */
static double add_volumes(brio_natural *n) {
    double sum = 0;
    for (size_t v = 0; v < n->num_vertices; v++) n->share[v] = 0;
    for (size_t i = 0; i < n->num_facets; i++) {
        const brio_dual_facet *f = &n->facet[i];
        n->share[f->end[0]] += cone(n, f->end[0], f->end[1], f, 1);
        n->share[f->end[1]] += cone(n, f->end[1], f->end[0], f, -1);
    }
    for (size_t v = 0; v < n->num_vertices; v++) {
        if (!(n->share[v] > 0)) n->share[v] = 0;
        sum += n->share[v];
    }
    return sum;
}

/* --- the last step --- */

/* Adds up the shares' first moments r and second moments m about x. */
static void find_moments(const brio_natural *n, double r[3], double m[3][3]) {
    for (int k = 0; k < 3; k++) r[k] = m[k][0] = m[k][1] = m[k][2] = 0;
    for (size_t v = 1; v < n->num_vertices; v++)
        for (int k = 0; k < 3; k++) {
            r[k] += n->share[v] * n->offset[v][k];
            for (int j = 0; j < 3; j++) m[k][j] += n->share[v] * n->offset[v][k] * n->offset[v][j];
        }
}

/* Solves (m - r r') g = -r by Cramer's rule. */
static void solve_correction(const double r[3], double m[3][3], double g[3]) {
    double row[3][3], minor[3][3];
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) row[k][j] = m[k][j] - r[k] * r[j];
    for (int k = 0; k < 3; k++) brio_cross(row[(k + 1) % 3], row[(k + 2) % 3], minor[k]);
    double determinant = brio_dot(row[0], minor[0]);
    for (int k = 0; k < 3; k++) g[k] = -(r[0] * minor[0][k] + r[1] * minor[1][k] + r[2] * minor[2][k]) / determinant;
}

/* Makes the shares reproduce x. Returns false if that takes a change that is no rounding error. */
static bool correct(brio_natural *n) {
    static const double MOST = 1e-4; /* chosen: errors of volumes near the hull are up to here */
    double r[3], m[3][3], g[3];
    find_moments(n, r, m);
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) return true;
    solve_correction(r, m, g);
    for (size_t v = 1; v < n->num_vertices; v++) {
        double change = brio_dot(g, n->offset[v]) - brio_dot(g, r);
        if (!(fabs(change) <= MOST)) return false;
        n->share[v] *= 1 + change;
    }
    return true;
}

static bool divide_by_sum(brio_natural *n, double sum) {
    if (!(sum > 0 && sum < INFINITY)) return false;
    for (size_t v = 1; v < n->num_vertices; v++) n->share[v] /= sum;
    return true;
}

/* Returns whether the shares reproduce x. */
static bool reproduces(const brio_natural *n) {
    return brio_shares_hold((const double(*)[3])n->offset + 1, (int)n->num_vertices - 1, n->share + 1);
}

/* --- the whole --- */

static brio_status clear(brio_natural *n, brio_context *ctx) {
    n->ctx = ctx;
    map_clear(&n->tets);
    map_clear(&n->vertices);
    map_clear(&n->edges);
    n->num_tets = n->num_centres = n->num_edges = n->num_facets = 0;
    n->num_vertices = 1; /* the query */
    return BRIO_RESERVE(ctx, n->place, n->place_room, 1);
}

brio_status brio_natural_coordinates(brio_natural *n, brio_querent *q, const brio_holder *h, const double *x,
                                     bool *found) {
    BRIO_FORWARD(clear(n, n->ctx));
    BRIO_FORWARD(dig(n, q, h->tet, x));
    BRIO_FORWARD(list_edges(n, q, x));
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->base, n->base_room, n->num_vertices));
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->share, n->share_room, n->num_vertices));
    BRIO_FORWARD(find_centres(n, q->l, x, found));
    if (!*found) return BRIO_OK;
    BRIO_FORWARD(find_facets(n));
    *found = divide_by_sum(n, add_volumes(n)) && correct(n) && correct(n) && reproduces(n);
    return BRIO_OK;
}
