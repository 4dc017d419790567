/* A cell as the star of its site gives it.
 *
 * A facet of the Delaunay triangulation at the site p is dual to an edge of p's cell, between the centres c and d of
 * two mates. The edge borders the faces that the cell shares with the facet's other two vertices. The area vector of a
 * face is half the sum of the cross products (c - p) x (d - p) over its edges, in turn: the order of the edges does not
 * matter, so that one pass over the star suffices. The volume is the sum of the pyramids from p, a third of the area
 * vector times the foot of the face. Written out over all cells, the signed tetrahedra (p, foot, c, d) fill space and
 * share their triangles, so errors of the centres cancel in the sum of the volumes.
 *
 * Based on: Aurenhammer. Power diagrams: properties, algorithms and applications. SIAM J. Computing 1987. */
#include "cells/star_cell.h"
#include "base/memory.h"
#include "base/vector.h"
#include "triangulation/ring.h"
#include <assert.h>
#include <math.h>
#include <string.h>

void brio_star_cell_free(brio_star_cell *c) {
    brio_release(c->d->ctx, c->side);
    brio_release(c->d->ctx, c->slot);
    brio_release(c->d->ctx, c->polygon);
}

/* Makes room for the sides of a star of `size` tetrahedra, and empties the hash table. A star of n tetrahedra has at
 * most n / 2 + 2 neighbours, the infinite vertex included. */
static brio_status make_room(brio_star_cell *c, size_t size) {
    brio_context *ctx = c->d->ctx;
    size_t most = size / 2 + 3, slots = 32;
    while (slots < 4 * most) slots *= 2;
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->side, c->side_capacity, most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, c->slot, c->slot_capacity, slots));
    memset(c->slot, 0, slots * sizeof *c->slot);
    c->num_slots = slots;
    c->num_sides = 0;
    return BRIO_OK;
}

/* Writes the foot of the face that a site shares with its neighbour. */
static inline void find_foot(const brio_diagram *d, uint32_t site, uint32_t neighbour, double foot[3]) {
    const double *p = d->at + 3 * (size_t)site, *q = d->at + 3 * (size_t)neighbour;
    double share = 0.5, way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    if (d->square) share = 0.5 + 0.5 * ((d->square[site] - d->square[neighbour]) / brio_dot(way, way));
    for (int k = 0; k < 3; k++) foot[k] = share * way[k];
}

/* Returns the side of a neighbour, a new one if tetrahedron `tet` is the first with this neighbour. */
static inline brio_side *side_of(brio_star_cell *c, uint32_t neighbour, uint32_t tet) {
    size_t mask = c->num_slots - 1, at = (neighbour * UINT32_C(0x9E3779B1) >> 7) & mask;
    while (c->slot[at][1] && c->slot[at][0] != neighbour) at = (at + 1) & mask;
    if (c->slot[at][1]) return &c->side[c->slot[at][1] - 1];
    assert(c->num_sides < c->side_capacity && 2 * c->num_sides < c->num_slots); /* probing ends */
    brio_side *s = &c->side[c->num_sides++];
    *s = (brio_side){.site = neighbour, .tet = tet};
    if (neighbour != BRIO_INFINITE) find_foot(c->d, c->site, neighbour, s->foot);
    c->slot[at][0] = neighbour;
    c->slot[at][1] = (uint32_t)c->num_sides;
    return s;
}

/* Adds to `moment` that of the tetrahedron of the site, a foot, and an edge; six times its volume is foot . cross. */
static inline void add_moment(double moment[3], const double *foot, const double *cross, const double *ends,
                              double sign) {
    double volume = sign * brio_dot(foot, cross) / 24;
    for (int k = 0; k < 3; k++) moment[k] += volume * (foot[k] + ends[k]);
}

/* Adds the edge between the centres `from` and `to` to the faces a and b. Seen from a the edge runs counterclockwise
 * round a's face. */
static inline void add_edge(brio_star_cell *c, brio_side *a, brio_side *b, const double *from, const double *to,
                            const bool moments) {
    double cross[3];
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

/* Adds the edges at the centre of tetrahedron t that lead to later tetrahedra of the star. */
static inline void add_edges(brio_star_cell *c, uint32_t t, const bool moments) {
    const brio_diagram *d = c->d;
    const brio_tetrahedron *tet = &d->t.tet[t];
    const double *p = d->at + 3 * (size_t)c->site, *x = d->centre[t];
    int own = brio_slot_of_vertex(tet->vertex, c->site);
    assert(own < 4); /* the star has the tetrahedra of its site */
    double from[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
    brio_side *side[3];
    for (int e = 0; e < 3; e++) side[e] = side_of(c, tet->vertex[BRIO_FACET[own][e]], t);
    if (t >= d->num_finite) side[0]->open = side[1]->open = side[2]->open = c->open = true;
    assert(x[3] == BRIO_PLACE_INSIDE || x[3] == BRIO_PLACE_OUTSIDE || x[3] == BRIO_PLACE_FAR); /* I1 of diagram.h */
    if (x[3] > c->place) c->place = (brio_place)x[3];
    for (int e = 0; e < 3; e++) {
        uint32_t u = brio_tet_of(tet->mate[BRIO_FACET[own][e]]);
        if (u < t) continue;
        brio_side *a = side[(e + 1) % 3], *b = side[(e + 2) % 3];
        bool apart = !d->same || d->same[t] != d->same[u];
        a->vertices += apart, b->vertices += apart;
        const double *y = d->centre[u], to[3] = {y[0] - p[0], y[1] - p[1], y[2] - p[2]};
        add_edge(c, a, b, from, to, moments);
    }
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
    if (moments)
        for (size_t i = 0; i < size; i++) add_edges(c, star[i], true);
    else
        for (size_t i = 0; i < size; i++) add_edges(c, star[i], false);
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

/* Appends the centre of a tetrahedron, unless the centre before it is the same. */
static brio_status append(brio_star_cell *c, uint32_t tet, size_t *count) {
    uint32_t same = brio_same_centre(c->d, tet);
    if (*count && c->polygon[*count - 1] == same) return BRIO_OK;
    brio_status status = BRIO_RESERVE(c->d->ctx, c->polygon, c->polygon_capacity, *count + 1);
    if (status == BRIO_OK) c->polygon[(*count)++] = same;
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
    if (*count > 1 && c->polygon[0] == c->polygon[*count - 1]) --*count;
    if (side->open) drop_infinite(c, count);
    return BRIO_OK;
}
