/* A cell as the star of its site gives it.
 *
 * A facet of the Delaunay triangulation at the site p is dual to an edge of p's cell, between the centres c and d of
 * two mates. The edge borders the faces that the cell shares with the facet's other two vertices. The area vector of a
 * face is half the sum of the cross products (c - p) x (d - p) over its edges, in turn. The volume is the sum of the
 * pyramids from p, a third of the area vector times the foot of the face. Written out over all cells, the signed
 * tetrahedra (p, foot, c, d) fill space and share their triangles, so errors of the centres cancel in the sum of the
 * volumes.
 *
 * Sums are taken in the order of the neighbours' positions: edges by their two sides, then sides. An edge is found from
 * both of its tetrahedra, and taken from the one from which its sides ascend.
 *
 * Based on: Aurenhammer. Power diagrams: properties, algorithms and applications. SIAM J. Computing 1987. */
#include "cells/star_cell.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/vector.h"
#include "predicates/predicates.h"
#include "triangulation/ring.h"
#include <assert.h>
#include <math.h>
#include <string.h>

void brio_star_cell_free(brio_star_cell *c) {
    brio_release(c->d->ctx, c->side);
    brio_release(c->d->ctx, c->slot);
    brio_release(c->d->ctx, c->neighbour);
    brio_release(c->d->ctx, c->order);
    brio_release(c->d->ctx, c->rank);
    brio_release(c->d->ctx, c->corner);
    for (int i = 0; i < 2; i++) brio_release(c->d->ctx, c->edge[i]);
    brio_release(c->d->ctx, c->bucket);
    brio_release(c->d->ctx, c->polygon);
}

/* MOST_INSERTED, chosen: at most this number of neighbours are sorted by insertion. */
enum { MOST_INSERTED = 32 };

/* Makes room for the sides of a star of `size` tetrahedra, and empties the hash table. A star of n tetrahedra has at
 * most n / 2 + 2 neighbours, the infinite vertex included, and 3 n / 2 edges. */
static brio_status make_room(brio_star_cell *c, size_t size) {
    brio_context *ctx = c->d->ctx;
    size_t most = size / 2 + 3, slots = 32;
    while (slots < 4 * most) slots *= 2;
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->side, c->side_capacity, most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->slot, c->slot_capacity, slots));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->neighbour, c->neighbour_capacity, most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->order, c->order_capacity, most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->rank, c->rank_capacity, most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->corner, c->corner_capacity, size));
    for (int i = 0; i < 2; i++) BRIO_FORWARD(BRIO_RESERVE(ctx, c->edge[i], c->edge_capacity[i], size + size / 2 + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->bucket, c->bucket_capacity, most + 1));
    memset(c->slot, 0, slots * sizeof *c->slot);
    c->num_slots = slots;
    c->num_sides = 0;
    return BRIO_OK;
}

/* --- sides --- */

/* Writes the foot of the face that a site shares with its neighbour. */
static inline void find_foot(const brio_diagram *d, uint32_t site, uint32_t neighbour, double foot[3]) {
    const double *p = d->at + 3 * (size_t)site, *q = d->at + 3 * (size_t)neighbour;
    double share = 0.5, way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    if (d->square) share = 0.5 + 0.5 * ((d->square[site] - d->square[neighbour]) / brio_dot(way, way));
    for (int k = 0; k < 3; k++) foot[k] = share * way[k];
}

/* Returns the number of a neighbour, a new one if it is met first. */
static inline uint32_t number_of(brio_star_cell *c, uint32_t neighbour) {
    size_t mask = c->num_slots - 1, at = (neighbour * UINT32_C(0x9E3779B1) >> 7) & mask;
    while (c->slot[at][1] && c->slot[at][0] != neighbour) at = (at + 1) & mask;
    if (c->slot[at][1]) return c->slot[at][1] - 1;
    assert(c->num_sides < c->side_capacity && 2 * c->num_sides < c->num_slots); /* probing ends */
    c->neighbour[c->num_sides] = neighbour;
    c->slot[at][0] = neighbour;
    c->slot[at][1] = (uint32_t)++c->num_sides;
    return (uint32_t)c->num_sides - 1;
}

/* Numbers the neighbours in the star. */
static void number_neighbours(brio_star_cell *c, const uint32_t *star, size_t size) {
    const brio_diagram *d = c->d;
    for (size_t i = 0; i < size; i++) {
        const uint32_t *v = d->t.tet[star[i]].vertex;
        double place = d->centre[star[i]][3];
        int own = brio_slot_of_vertex(v, c->site);
        assert(own < 4); /* the star has the tetrahedra of its site */
        for (int e = 0; e < 3; e++) c->corner[i][e] = number_of(c, v[BRIO_FACET[own][e]]);
        assert(place == BRIO_PLACE_INSIDE || place == BRIO_PLACE_OUTSIDE ||
               place == BRIO_PLACE_FAR); /* I1 of diagram.h */
        if (place > c->place) c->place = (brio_place)place;
    }
}

static inline bool comes_before(const brio_star_cell *c, uint32_t i, uint32_t j) {
    uint32_t p = c->neighbour[i], q = c->neighbour[j];
    if (p == BRIO_INFINITE || q == BRIO_INFINITE) return q == BRIO_INFINITE && p != q;
    const double *x = c->d->points + 3 * (size_t)p, *y = c->d->points + 3 * (size_t)q;
    return x[0] != y[0] ? x[0] < y[0] : x[1] != y[1] ? x[1] < y[1] : x[2] < y[2];
}

static int compare_numbers(uint32_t i, uint32_t j, const void *user) {
    return comes_before(user, i, j) ? -1 : comes_before(user, j, i);
}

/* Makes the sides, in their order. */
static void order_sides(brio_star_cell *c) {
    size_t n = c->num_sides;
    for (uint32_t i = 0; i < n; i++) c->order[i] = i;
    if (n > MOST_INSERTED) brio_sort_indices(c->order, n, compare_numbers, c);
    for (size_t i = 1; i < n && n <= MOST_INSERTED; i++) {
        uint32_t moved = c->order[i];
        size_t j = i;
        for (; j > 0 && comes_before(c, moved, c->order[j - 1]); j--) c->order[j] = c->order[j - 1];
        c->order[j] = moved;
    }
    for (uint32_t s = 0; s < n; s++) {
        uint32_t number = c->order[s], neighbour = c->neighbour[number];
        c->rank[number] = s;
        c->side[s] = (brio_side){.site = neighbour};
        if (neighbour != BRIO_INFINITE) find_foot(c->d, c->site, neighbour, c->side[s].foot);
    }
}

/* --- edges --- */

/* Lists the edges: each from the tetrahedron from which its sides ascend. Marks the sides of infinite tetrahedra. */
static size_t list_edges(brio_star_cell *c, const uint32_t *star, size_t size) {
    const brio_diagram *d = c->d;
    size_t n = 0;
    for (size_t i = 0; i < size; i++) {
        const brio_tetrahedron *tet = &d->t.tet[star[i]];
        int own = brio_slot_of_vertex(tet->vertex, c->site);
        uint32_t side[3];
        for (int e = 0; e < 3; e++) side[e] = c->rank[c->corner[i][e]];
        if (star[i] >= d->num_finite)
            c->side[side[0]].open = c->side[side[1]].open = c->side[side[2]].open = c->open = true;
        for (int e = 0; e < 3; e++) {
            uint32_t a = side[(e + 1) % 3], b = side[(e + 2) % 3];
            c->edge[0][n] = (brio_cell_edge){a, b, star[i], brio_tet_of(tet->mate[BRIO_FACET[own][e]])};
            n += a < b;
            assert(n <= size + size / 2);
        }
    }
    return n;
}

/* Sorts edges stably by one of their sides. */
static void sort_edges(brio_star_cell *c, const brio_cell_edge *from, brio_cell_edge *to, size_t n, bool by_a) {
    memset(c->bucket, 0, (c->num_sides + 1) * sizeof *c->bucket);
    for (size_t i = 0; i < n; i++) c->bucket[(by_a ? from[i].a : from[i].b) + 1]++;
    for (size_t s = 1; s < c->num_sides; s++) c->bucket[s] += c->bucket[s - 1];
    for (size_t i = 0; i < n; i++) to[c->bucket[by_a ? from[i].a : from[i].b]++] = from[i];
}

/* Adds to `moment` that of the tetrahedron of the site, a foot, and an edge; six times its volume is foot . cross. */
static inline void add_moment(double moment[3], const double *foot, const double *cross, const double *ends,
                              double sign) {
    double volume = sign * brio_dot(foot, cross) / 24;
    for (int k = 0; k < 3; k++) moment[k] += volume * (foot[k] + ends[k]);
}

/* Adds an edge to the faces of its two sides. */
static inline void add_edge(brio_star_cell *c, const brio_cell_edge *edge, const bool moments) {
    const brio_diagram *d = c->d;
    const double *p = d->at + 3 * (size_t)c->site, *x = d->centre[edge->from], *y = d->centre[edge->to];
    double from[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]}, to[3] = {y[0] - p[0], y[1] - p[1], y[2] - p[2]}, cross[3];
    brio_side *a = &c->side[edge->a], *b = &c->side[edge->b];
    bool apart = !d->same || d->same[edge->from] != d->same[edge->to];
    a->vertices += apart, b->vertices += apart;
    a->tet = b->tet = edge->from;
    brio_cross(from, to, cross);
    for (int k = 0; k < 3; k++) {
        a->area[k] += cross[k];
        b->area[k] -= cross[k];
    }
    if (!moments) return;
    double ends[3] = {from[0] + to[0], from[1] + to[1], from[2] + to[2]};
    add_moment(c->moment, a->foot, cross, ends, 1);
    add_moment(c->moment, b->foot, cross, ends, -1);
}

brio_status brio_star_cell_fill(brio_star_cell *c, uint32_t site, bool moments) {
    const brio_diagram *d = c->d;
    const uint32_t *star = d->star + d->begin[site];
    size_t size = d->size[site];
    brio_status status = make_room(c, size);
    if (status != BRIO_OK) return status;
    c->site = site;
    c->open = d->flat;
    c->place = BRIO_PLACE_INSIDE;
    memset(c->moment, 0, sizeof c->moment);
    number_neighbours(c, star, size);
    order_sides(c);
    size_t edges = list_edges(c, star, size);
    sort_edges(c, c->edge[0], c->edge[1], edges, false);
    sort_edges(c, c->edge[1], c->edge[0], edges, true);
    if (moments)
        for (size_t i = 0; i < edges; i++) add_edge(c, &c->edge[0][i], true);
    else
        for (size_t i = 0; i < edges; i++) add_edge(c, &c->edge[0][i], false);
    return BRIO_OK;
}

double brio_star_cell_volume(const brio_star_cell *c) {
    double volume = 0;
    for (size_t i = 0; i < c->num_sides; i++) {
        const brio_side *s = &c->side[i];
        if (s->vertices > 2) volume += brio_dot(s->foot, s->area) / 6;
    }
    return volume;
}

/* --- polygons --- */

static inline bool share_centre(const brio_diagram *d, uint32_t t, uint32_t u) {
    return brio_same_centre(d, t) == brio_same_centre(d, u);
}

/* Appends the centre of a tetrahedron, unless the centre before it is the same. */
static brio_status append(brio_star_cell *c, uint32_t tet, size_t *count) {
    if (*count && share_centre(c->d, c->polygon[*count - 1], tet)) return BRIO_OK;
    brio_status status = BRIO_RESERVE(c->d->ctx, c->polygon, c->polygon_capacity, *count + 1);
    if (status == BRIO_OK) c->polygon[(*count)++] = tet;
    return status;
}

static void reverse(uint32_t *v, size_t begin, size_t end) {
    for (; begin + 1 < end; begin++, end--) {
        uint32_t first = v[begin];
        v[begin] = v[end - 1];
        v[end - 1] = first;
    }
}

/* Turns the polygon so that its infinite vertices come last, and drops them. */
static void drop_infinite(brio_star_cell *c, size_t *count) {
    size_t n = *count, first = 0, finite = 0;
    uint32_t *v = c->polygon;
    for (size_t i = 0; i < n; i++) {
        bool here = v[i] < c->d->num_finite;
        finite += here;
        if (here && v[(i + n - 1) % n] >= c->d->num_finite) first = i;
    }
    reverse(v, 0, first);
    reverse(v, first, n);
    reverse(v, 0, n);
    assert(finite <= n);
    *count = finite;
}

brio_status brio_star_cell_polygon(brio_star_cell *c, const brio_side *side, size_t *count) {
    const brio_tetrahedra *t = &c->d->t;
    const uint32_t *v = t->tet[side->tet].vertex;
    *count = 0;
    if (c->d->flat) return BRIO_OK;
    brio_ring ring =
        brio_ring_second(t, side->tet, brio_slot_of_vertex(v, c->site), brio_slot_of_vertex(v, side->site));
    BRIO_FORWARD(append(c, side->tet, count));
    do BRIO_FORWARD(append(c, ring.tet, count));
    while (brio_ring_next(&ring));
    if (*count > 1 && share_centre(c->d, c->polygon[0], c->polygon[*count - 1])) --*count;
    if (side->open) drop_infinite(c, count);
    return BRIO_OK;
}
