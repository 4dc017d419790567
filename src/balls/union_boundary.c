/* The boundary of a union of balls from its dual complex.
 *
 *   1. The regular triangulation of the balls, and of eight helpers around them that are no balls.
 *   2. The dual complex: the simplices whose value in the alpha filtration is below 0 (alpha/alpha_values.c), and
 *      tetrahedra at 0 with their faces.
 *   3. A facet of the complex has a corner on each side where no tetrahedron of the complex is: the point of its three
 *      spheres there.
 *   4. Round an edge of the complex, each run of tetrahedra that are not in it has an arc, between the corners of the
 *      facets at its ends. Its angle is the dihedral angle of the run less what the balls of those facets cover.
 *   5. A vertex of the complex has a patch for each component of what the complex leaves of its link.
 *
 * The dual complex is homotopy equivalent to the union, so it also has the union's components, voids and tunnels.
 * Values are rounded: where spheres meet within rounding, the boundary is that of balls moved as little.
 *
 * Based on: Edelsbrunner. The union of balls and its dual shape. DCG 1995. */
#include "alpha/alpha_complex.h"
#include "balls/union_boundary.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/union_find.h"
#include "base/vector.h"
#include "triangulation/ring.h"
#include "triangulation/view.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { HELPERS = 8 };
static const double TURN = 6.283185307179586476925;
static const double HELPERS_AT = 2; /* the helpers' distance in boxes of the centres. Chosen */

/* --- balls and helpers --- */

static void place_helpers(brio_union_boundary *b, double greatest_weight) {
    double low[3], high[3], longest = 0;
    size_t n = b->num_balls;
    for (size_t k = 0; k < 3; k++) {
        low[k] = high[k] = b->centre[k];
        for (size_t i = 1; i < n; i++) {
            low[k] = fmin(low[k], b->centre[3 * i + k]);
            high[k] = fmax(high[k], b->centre[3 * i + k]);
        }
        longest = fmax(longest, high[k] - low[k]);
    }
    longest = fmax(longest, sqrt(greatest_weight));
    for (size_t h = 0; h < HELPERS; h++) {
        for (size_t k = 0; k < 3; k++)
            b->centre[3 * (n + h) + k] = 0.5 * (low[k] + high[k]) + (h >> k & 1 ? HELPERS_AT : -HELPERS_AT) * longest;
        b->weight[n + h] = -longest * longest;
    }
}

static brio_status take_balls(brio_union_boundary *b, const double *centres, const double *weights, size_t n) {
    double greatest = 0;
    BRIO_FORWARD(BRIO_ALLOC(b->ctx, b->of_ball, n));
    for (size_t i = 0; i < n; i++) {
        BRIO_EXPECT(b->ctx, isfinite(weights[i]), BRIO_ERR_NOT_FINITE, "the weight of ball %zu is %g", i, weights[i]);
        if (weights[i] <= 0) continue;
        b->of_ball[b->num_balls++] = (uint32_t)i;
        greatest = fmax(greatest, weights[i]);
    }
    BRIO_EXPECT(b->ctx, b->num_balls > 0, BRIO_ERR_NO_ANSWER, "no ball: none of %zu weights is positive", n);
    b->exponent = brio_exponent(fmax(sqrt(greatest), brio_greatest(centres, 3 * n)));
    BRIO_FORWARD(BRIO_ALLOC(b->ctx, b->centre, 3 * (b->num_balls + HELPERS)));
    BRIO_FORWARD(BRIO_ALLOC(b->ctx, b->weight, b->num_balls + HELPERS));
    for (size_t i = 0; i < b->num_balls; i++) {
        for (size_t k = 0; k < 3; k++)
            b->centre[3 * i + k] = ldexp(centres[3 * (size_t)b->of_ball[i] + k], -b->exponent);
        b->weight[i] = ldexp(weights[b->of_ball[i]], -2 * b->exponent);
    }
    place_helpers(b, ldexp(greatest, -2 * b->exponent));
    return BRIO_OK;
}

/* --- the dual complex --- */

/* Returns whether a simplex is in the complex: its power face meets the inside of the union. A tetrahedron is in it
 * also when its spheres meet in one point, which is then no void, and so are its faces; but balls that only touch stay
 * apart. */
static bool is_in(const brio_alpha_complex *c, int dimension, size_t i) {
    return c->values[dimension][i] < 0 || c->solid[dimension][i] <= 0;
}

/* Marks what is in the complex. Facets and edges come in the order in which the filtration lists them
 * (alpha_complex.h). */
static void mark_simplices(brio_union_boundary *b, const brio_alpha_complex *c) {
    size_t f = 0;
    for (size_t t = 0; t < b->num_finite; t++) b->tet_in[t] = is_in(c, 3, t);
    for (uint32_t h = 0; h < 4 * b->num_finite; h++) {
        uint32_t mate = *brio_mate(&b->t, h);
        if (h > mate) continue;
        bool in = is_in(c, 2, f++);
        b->facet_in[h] = in;
        if (brio_tet_of(mate) < b->num_finite) b->facet_in[mate] = in;
    }
    assert(f == c->counts[2]);
    for (size_t v = 0; v < c->counts[0]; v++)
        if (is_in(c, 0, v)) b->ball_in[c->simplices[0][v]] = 1;
}

static void count_euler(brio_union_boundary *b, const brio_alpha_complex *c) {
    for (int k = 0; k < 4; k++)
        for (size_t i = 0; i < c->counts[k]; i++)
            if (is_in(c, k, i)) b->euler += k % 2 ? -1 : 1;
}

static brio_status count_components(brio_union_boundary *b, const brio_alpha_complex *c) {
    brio_status status = BRIO_OK;
    uint32_t *parent = NULL;
    size_t n = b->num_balls;
    BRIO_TRY(BRIO_ALLOC(b->ctx, parent, n > b->num_finite ? n : b->num_finite));
    for (size_t i = 0; i < n; i++) parent[i] = (uint32_t)i;
    for (size_t e = 0; e < c->counts[1]; e++)
        if (is_in(c, 1, e)) brio_unite(parent, c->simplices[1][2 * e], c->simplices[1][2 * e + 1], true);
    for (size_t i = 0; i < n; i++) b->components += b->ball_in[i] && parent[i] == i;
    for (size_t t = 0; t < b->num_finite; t++) parent[t] = (uint32_t)t;
    uint32_t outside = BRIO_INFINITE; /* all infinite tetrahedra are outside, and so are their finite neighbours (I2) */
    for (uint32_t h = 0; h < 4 * b->num_finite; h++) {
        uint32_t tet = brio_tet_of(h), mate = brio_tet_of(*brio_mate(&b->t, h));
        if (b->tet_in[tet] || b->facet_in[h]) continue;
        if (mate >= b->num_finite && outside == BRIO_INFINITE) outside = tet;
        if (mate >= b->num_finite) mate = outside;
        brio_unite(parent, tet, mate, true);
    }
    for (size_t t = 0; t < b->num_finite; t++) b->voids += !b->tet_in[t] && parent[t] == t;
    b->voids--; /* the outside */
done:
    brio_release(b->ctx, parent);
    return status;
}

/* --- corners --- */

double brio_circle_plane(const brio_union_boundary *b, uint32_t i, uint32_t j, double axis[3], double *distance) {
    const double *p = b->centre + 3 * (size_t)i, *q = b->centre + 3 * (size_t)j;
    for (int k = 0; k < 3; k++) axis[k] = q[k] - p[k];
    double d = brio_length(axis);
    for (int k = 0; k < 3; k++) axis[k] /= d;
    *distance = d;
    return 0.5 * (d + (b->weight[i] - b->weight[j]) / d);
}

static void make_unit(double v[3]) {
    double length = brio_length(v);
    for (int k = 0; k < 3; k++) v[k] = length > 0 ? v[k] / length : 0;
}

/* Places a corner: on the side of the facet from which its balls turn counterclockwise. Computed from the balls in
 * ascending order, so that the two corners of a facet are mirror images. */
static void place_corner(const brio_union_boundary *b, brio_corner *c) {
    uint32_t v[3] = {c->ball[0], c->ball[1], c->ball[2]};
    double u[3], w[3], m[3], n[3], d;
    bool odd = false;
    for (int s = 0; s < 3; s++) { /* three compares sort three */
        int k = s % 2;
        if (v[k] < v[k + 1]) continue;
        uint32_t swap = v[k];
        v[k] = v[k + 1], v[k + 1] = swap, odd = !odd;
    }
    const double *p = b->centre + 3 * (size_t)v[0], *r = b->centre + 3 * (size_t)v[2];
    double x = brio_circle_plane(b, v[0], v[1], u, &d);
    for (int k = 0; k < 3; k++) w[k] = r[k] - p[k];
    double along = brio_dot(u, w), square = brio_dot(w, w);
    brio_cross(u, w, n);
    make_unit(n);
    brio_cross(n, u, m);
    double across = brio_dot(m, w);
    double y = (0.5 * (square + b->weight[v[0]] - b->weight[v[2]]) - x * along) / across;
    double h = sqrt(fmax(0, b->weight[v[0]] - x * x - y * y)) * (odd ? -1 : 1);
    for (int k = 0; k < 3; k++) c->place[k] = p[k] + x * u[k] + y * m[k] + h * n[k];
}

static brio_status find_corners(brio_union_boundary *b) {
    size_t count = 0, handles = 4 * b->num_finite;
    for (size_t h = 0; h < handles; h++) count += b->facet_in[h] && !b->tet_in[h / 4];
    BRIO_FORWARD(BRIO_ALLOC(b->ctx, b->corner, count));
    BRIO_FORWARD(BRIO_ALLOC(b->ctx, b->corner_at, handles));
    for (uint32_t h = 0; h < handles; h++) {
        b->corner_at[h] = BRIO_NO_CORNER;
        if (h % BRIO_LOOK_EVERY == 0) BRIO_FORWARD(brio_look(b->ctx, BRIO_LOOK_EVERY));
        if (!b->facet_in[h] || b->tet_in[brio_tet_of(h)]) continue;
        brio_corner *c = &b->corner[b->num_corners];
        for (int k = 0; k < 3; k++) c->ball[k] = b->t.tet[brio_tet_of(h)].vertex[BRIO_FACET[brio_slot_of(h)][k]];
        place_corner(b, c);
        b->corner_at[h] = (uint32_t)b->num_corners++;
    }
    return BRIO_OK;
}

/* --- patches --- */

/* Numbers the patches: sets of corners of outside tetrahedra at one ball, joined across facets outside the complex.
 *   node  4 #finite: receives the patch of a slot of a tetrahedron. */
static brio_status find_patches(brio_union_boundary *b, uint32_t *node) {
    size_t slots = 4 * b->num_finite, capacity = 0;
    for (size_t s = 0; s < slots; s++) node[s] = (uint32_t)s;
    for (uint32_t h = 0; h < slots; h++) {
        uint32_t tet = brio_tet_of(h), mate = brio_tet_of(*brio_mate(&b->t, h));
        if (b->facet_in[h] || b->tet_in[tet] || mate >= b->num_finite || mate < tet) continue;
        for (int i = 0; i < 4; i++) {
            if (i == brio_slot_of(h)) continue;
            int other = brio_slot_of_vertex(b->t.tet[mate].vertex, b->t.tet[tet].vertex[i]);
            brio_unite(node, 4 * tet + (uint32_t)i, 4 * mate + (uint32_t)other, true);
        }
    }
    for (uint32_t s = 0; s < slots; s++) { /* roots are the lowest of their sets: they are numbered first */
        uint32_t v = b->t.tet[s / 4].vertex[s % 4];
        if (b->tet_in[s / 4] || v >= b->num_balls || !b->ball_in[v] || brio_find(node, s) != s) continue;
        BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->patch, capacity, b->num_patches + 1));
        b->patch[b->num_patches++] = v;
    }
    return BRIO_OK;
}

/* Replaces the root of each set of slots by the number of its patch, in the order in which find_patches counted. */
static brio_status number_patches(const brio_union_boundary *b, uint32_t *node) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL, next = 0;
    size_t slots = 4 * b->num_finite;
    BRIO_TRY(BRIO_ALLOC(b->ctx, number, slots));
    for (uint32_t s = 0; s < slots; s++) {
        uint32_t v = b->t.tet[s / 4].vertex[s % 4], root = brio_find(node, s);
        bool here = !b->tet_in[s / 4] && v < b->num_balls && b->ball_in[v];
        number[s] = !here ? BRIO_NO_CORNER : root == s ? next++ : number[root];
    }
    assert(next == b->num_patches);
    memcpy(node, number, slots * sizeof *node);
done:
    brio_release(b->ctx, number);
    return status;
}

/* --- arcs --- */

/* The tetrahedra round an edge, counterclockwise about it. Tetrahedron k lies between the facets to before[k] and
 * after[k]. */
typedef struct {
    uint32_t *tet, *before, *after;
    size_t count, capacity, before_capacity, after_capacity;
} ring;

static brio_status add_to_ring(const brio_union_boundary *b, ring *r, uint32_t tet, uint32_t before, uint32_t after) {
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, r->tet, r->capacity, r->count + 1));
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, r->before, r->before_capacity, r->count + 1));
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, r->after, r->after_capacity, r->count + 1));
    r->tet[r->count] = tet, r->before[r->count] = before, r->after[r->count++] = after;
    return BRIO_OK;
}

static brio_status walk_ring(const brio_union_boundary *b, uint32_t tet, int i, int j, ring *r) {
    const uint32_t *v = b->t.tet[tet].vertex;
    r->count = 0;
    BRIO_FORWARD(add_to_ring(b, r, tet, v[BRIO_EDGE[i][j][0]], v[BRIO_EDGE[i][j][1]]));
    brio_ring at = brio_ring_second(&b->t, tet, i, j);
    do BRIO_FORWARD(add_to_ring(b, r, at.tet, at.pivot, at.apex));
    while (brio_ring_next(&at));
    return BRIO_OK;
}

/* Returns the facet of ring tetrahedron k opposite to `vertex`. */
static uint32_t facet_of(const brio_union_boundary *b, const ring *r, size_t k, uint32_t vertex) {
    return brio_facet_of(r->tet[k], brio_slot_of_vertex(b->t.tet[r->tet[k]].vertex, vertex));
}

/* Returns the angle between the half-planes from an edge to two vertices, from 0 to pi. */
static double dihedral(const brio_union_boundary *b, const double axis[3], uint32_t i, uint32_t k, uint32_t l) {
    const double *o = b->centre + 3 * (size_t)i, *p = b->centre + 3 * (size_t)k, *q = b->centre + 3 * (size_t)l;
    double u[3], v[3], n[3];
    for (int c = 0; c < 3; c++) u[c] = p[c] - o[c], v[c] = q[c] - o[c];
    double a = brio_dot(u, axis), d = brio_dot(v, axis);
    for (int c = 0; c < 3; c++) u[c] -= a * axis[c], v[c] -= d * axis[c];
    brio_cross(u, v, n);
    return fabs(atan2(brio_dot(axis, n), brio_dot(u, v)));
}

/* Returns half the angle of the circle of an edge that the third ball of a corner covers. */
static double covered_angle(const brio_union_boundary *b, const double axis[3], uint32_t i, uint32_t third,
                            const double place[3]) {
    const double *o = b->centre + 3 * (size_t)i, *q = b->centre + 3 * (size_t)third;
    double u[3], v[3], n[3];
    for (int c = 0; c < 3; c++) u[c] = place[c] - o[c], v[c] = q[c] - o[c];
    double a = brio_dot(u, axis), d = brio_dot(v, axis);
    for (int c = 0; c < 3; c++) u[c] -= a * axis[c], v[c] -= d * axis[c];
    brio_cross(u, v, n);
    return atan2(fabs(brio_dot(axis, n)), brio_dot(u, v));
}

/* Adds an arc, and tells its corners. `first` is a tetrahedron of its run. */
static brio_status add_arc(brio_union_boundary *b, const uint32_t *node, uint32_t first, const brio_arc *arc) {
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->arc, b->arc_capacity, b->num_arcs + 1));
    brio_arc *a = &b->arc[b->num_arcs];
    *a = *arc;
    for (int s = 0; s < 2; s++)
        a->patch[s] = node[4 * first + (uint32_t)brio_slot_of_vertex(b->t.tet[first].vertex, a->ball[s])];
    for (int e = 0; e < 2 && a->corner[e] != BRIO_NO_CORNER; e++) {
        brio_corner *c = &b->corner[a->corner[e]];
        for (int k = 0; k < 3; k++)
            if (c->ball[k] != a->ball[0] && c->ball[k] != a->ball[1]) c->arc[k] = (uint32_t)b->num_arcs;
    }
    b->num_arcs++;
    return BRIO_OK;
}

/* Finds the arc of the run of tetrahedra that begins with ring tetrahedron `from`, behind a facet of the complex. */
static brio_status find_run(brio_union_boundary *b, const uint32_t *node, const ring *r, size_t from, brio_arc *a) {
    double axis[3], distance, angle = 0;
    size_t k = from;
    uint32_t start = facet_of(b, r, from, r->after[from]), stop;
    brio_circle_plane(b, a->ball[0], a->ball[1], axis, &distance);
    for (;;) {
        assert(!b->tet_in[r->tet[k]]); /* I1 */
        angle += dihedral(b, axis, a->ball[0], r->before[k], r->after[k]);
        stop = facet_of(b, r, k, r->before[k]);
        if (b->facet_in[stop]) break;
        k = (k + 1) % r->count;
    }
    a->corner[0] = b->corner_at[start];
    a->corner[1] = b->corner_at[stop];
    angle -= covered_angle(b, axis, a->ball[0], r->before[from], b->corner[a->corner[0]].place);
    angle -= covered_angle(b, axis, a->ball[0], r->after[k], b->corner[a->corner[1]].place);
    a->angle = fmin(fmax(angle, 0), TURN);
    return add_arc(b, node, r->tet[from], a);
}

static brio_status find_arcs_of(brio_union_boundary *b, const uint32_t *node, const ring *r, uint32_t i, uint32_t j) {
    bool alone = true;
    brio_arc a = {.ball = {i, j}};
    for (size_t k = 0; k < r->count; k++) alone = alone && !b->facet_in[facet_of(b, r, k, r->before[k])];
    if (alone) {
        a.corner[0] = a.corner[1] = BRIO_NO_CORNER;
        a.angle = TURN;
        return add_arc(b, node, r->tet[0], &a);
    }
    for (size_t k = 0; k < r->count; k++)
        if (b->facet_in[facet_of(b, r, k, r->after[k])] && !b->tet_in[r->tet[k]])
            BRIO_FORWARD(find_run(b, node, r, k, &a));
    return BRIO_OK;
}

static brio_status find_arcs(brio_union_boundary *b, const uint32_t *node, const brio_alpha_complex *c) {
    brio_status status = BRIO_OK;
    ring r = {0};
    size_t e = 0;
    for (uint32_t tet = 0; tet < b->num_finite; tet++) {
        if (tet % BRIO_LOOK_EVERY == 0) BRIO_TRY(brio_look(b->ctx, BRIO_LOOK_EVERY));
        for (int i = 0; i < 4; i++)
            for (int j = i + 1; j < 4; j++) {
                if (!brio_ring_size(&b->t, tet, i, j)) continue;
                if (!is_in(c, 1, e++)) continue;
                BRIO_TRY(walk_ring(b, tet, i, j, &r));
                BRIO_TRY(find_arcs_of(b, node, &r, b->t.tet[tet].vertex[i], b->t.tet[tet].vertex[j]));
            }
    }
    assert(e == c->counts[1]);
done:
    brio_release(b->ctx, r.tet);
    brio_release(b->ctx, r.before);
    brio_release(b->ctx, r.after);
    return status;
}

/* --- all of it --- */

static brio_status read_boundary(brio_union_boundary *b, const brio_alpha_complex *c) {
    brio_status status = BRIO_OK;
    uint32_t *node = NULL;
    b->t = brio_tetrahedra_of(b->triangulation);
    b->num_finite = c->counts[3];
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, b->tet_in, b->num_finite));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, b->facet_in, 4 * b->num_finite));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, b->ball_in, b->num_balls + HELPERS));
    BRIO_TRY(BRIO_ALLOC(b->ctx, node, 4 * b->num_finite));
    mark_simplices(b, c);
    count_euler(b, c);
    BRIO_TRY(count_components(b, c));
    BRIO_TRY(find_corners(b));
    BRIO_TRY(find_patches(b, node));
    BRIO_TRY(number_patches(b, node));
    BRIO_TRY(find_arcs(b, node, c));
done:
    brio_release(b->ctx, node);
    return status;
}

brio_status brio_union_boundary_find(brio_context *ctx, const double *centres, const double *weights, size_t num_points,
                                     uint64_t seed, brio_union_boundary *b) {
    brio_status status = BRIO_OK;
    brio_alpha_complex c = {.size = sizeof c};
    brio_delaunay_options o = {.size = sizeof o, .seed = seed};
    *b = (brio_union_boundary){.ctx = ctx};
    BRIO_TRY(brio_refuse_vertices(ctx, centres, num_points, "the balls"));
    BRIO_TRY(take_balls(b, centres, weights, num_points));
    size_t n = b->num_balls + HELPERS;
    BRIO_TRY(brio_delaunay(ctx, b->centre, b->weight, n, &o, &b->triangulation));
    BRIO_TRY(brio_alpha_values(ctx, b->triangulation, b->centre, b->weight, n, &c));
    BRIO_TRY(read_boundary(b, &c));
done:
    brio_alpha_complex_free(&c);
    return status;
}

void brio_union_boundary_free(brio_union_boundary *b) {
    brio_triangulation_free(b->triangulation);
    brio_release(b->ctx, b->of_ball);
    brio_release(b->ctx, b->centre);
    brio_release(b->ctx, b->weight);
    brio_release(b->ctx, b->tet_in);
    brio_release(b->ctx, b->facet_in);
    brio_release(b->ctx, b->ball_in);
    brio_release(b->ctx, b->corner_at);
    brio_release(b->ctx, b->corner);
    brio_release(b->ctx, b->arc);
    brio_release(b->ctx, b->patch);
}
