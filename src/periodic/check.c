/* The checksum of a periodic triangulation, and its exact check.
 *
 * Positions of translates depend on which the caller gave, and on the origin; how two vertices lie to each other does
 * not. So the name of a tetrahedron is the signs of the differences of its vertices' coordinates, its vertices in
 * lexicographic order. The colour of a vertex is a hash of the names of its tetrahedra, twice more of the colours about
 * it; the checksum is the sum of hashes of tetrahedra with the colours of their vertices.
 *
 * The check: a complex of positive tetrahedra, each facet of which has a mate on its other side, covers space evenly;
 * its volume tells how often. Once: then it is a triangulation of space. If no vertex behind a facet conflicts with the
 * tetrahedron before it, the lifted complex is convex along every line, so no vertex at all does. This holds where all
 * directions repeat.
 *
 * With fewer, how often space is covered changes at the hull alone, from none outside. The hull of all translates is a
 * slab or a prism: its facets hold the directions that repeat, and its edges are convex. Of a slab, the facets cover
 * two planes, whose area tells how often. Of a prism, the edges between planes turn once about the direction: the sum
 * of angles times lengths tells how often. Once: then space within is covered once.
 *
 * Based on: Edelsbrunner. Geometry and Topology for Mesh Generation. 2001 (the local test). */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "periodic/periodic.h"
#include "base/vector.h"
#include "predicates/predicates.h"
#include <math.h>
#include <string.h>

/* --- the checksum --- */

enum { COLOUR_ROUNDS = 2 };

/* Sorts the finite vertices of a tetrahedron lexicographically, and returns a hash of how they lie. */
static uint64_t name_of(const brio_images *m, const uint32_t *v, uint32_t *sorted, int *count) {
    uint64_t name = v[3] == BRIO_INFINITE;
    int n = 0;
    for (int k = 0; k < 4; k++) {
        if (v[k] == BRIO_INFINITE) continue;
        int at = n++;
        for (; at > 0 && brio_images_compare(m, v[k], sorted[at - 1]) < 0; at--) sorted[at] = sorted[at - 1];
        sorted[at] = v[k];
    }
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            for (int k = 0; k < 3; k++) {
                const double *x = m->x[sorted[i]], *y = m->x[sorted[j]];
                name = 3 * name + (x[k] < y[k] ? 1 : x[k] > y[k] ? 2 : 0);
            }
    *count = n;
    return brio_mix(name);
}

brio_status brio_periodic_checksum(brio_context *ctx, const brio_periodic *t, uint64_t *checksum) {
    BRIO_DOOR;
    const brio_images *m = &t->images;
    brio_status status = BRIO_OK;
    uint64_t *colour = NULL, *next = NULL, sum = brio_mix(t->stats.vertices);
    size_t count = t->stats.tetrahedra + t->stats.hull_facets;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, colour, m->num_points + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, next, m->num_points + 1));
    for (int round = 0; round <= COLOUR_ROUNDS; round++) {
        memset(next, 0, (m->num_points + 1) * sizeof *next);
        for (size_t i = 0; i < count; i++) {
            uint32_t sorted[4];
            int n;
            uint64_t name = name_of(m, t->tet[i].vertex, sorted, &n);
            for (int k = 0; k < n; k++) name = brio_mix(name + colour[m->list[sorted[k]].point]);
            for (int k = 0; k < n && round < COLOUR_ROUNDS; k++)
                next[m->list[sorted[k]].point] += brio_mix(name + (uint64_t)k);
            if (round == COLOUR_ROUNDS) sum += name;
            BRIO_TRY(brio_look(ctx, 1));
        }
        for (size_t p = 0; p < m->num_points && round < COLOUR_ROUNDS; p++) colour[p] = brio_mix(colour[p] + next[p]);
    }
    *checksum = sum;
done:
    brio_release(ctx, colour);
    brio_release(ctx, next);
    return status;
}

/* --- the check --- */

typedef struct {
    brio_context *ctx;
    const brio_periodic *t;
    brio_filter filter;
    size_t count;
    double scale;       /* a power of two by which vectors of the lattice have lengths near 1 */
    double basis[3][3]; /* those, scaled */
    double covered;     /* of a slab twice its hull's area; of a prism twice the angles of its edges */
} checking;

/* Writes b - a, scaled: exact. */
static void way(const checking *c, const double *a, const double *b, double *out) {
    for (int k = 0; k < 3; k++) out[k] = (b[k] - a[k]) * c->scale;
}

static void record_of(const brio_images *m, uint32_t image, const int32_t *shift, double *record) {
    brio_image i = m->list[image];
    for (int k = 0; k < 3; k++) i.shift[k] += shift[k];
    brio_lattice_move(m->lattice, m->x[i.point], i.shift, record);
    record[3] = m->weight ? m->weight[i.point] : 0;
}

/* Checks that the mate behind facet i, moved there, has the facet's vertices, from the other side. */
static brio_status check_mate(const checking *c, size_t t, int i, const int32_t *shift) {
    const brio_images *m = &c->t->images;
    const brio_tetrahedron *tet = c->t->tet;
    uint32_t facet = tet[t].mate[i];
    BRIO_EXPECT(c->ctx, (facet >> 2) < c->count && tet[facet >> 2].mate[facet & 3] == 4 * (uint32_t)t + (uint32_t)i,
                BRIO_ERR_CHECK, "tetrahedron %zu is not the mate of its mate at facet %d", t, i);
    for (int k = 0; k < 4; k++) {
        uint32_t v = tet[t].vertex[k];
        bool found = false;
        if (k == i) continue;
        for (int j = 0; j < 4 && !found; j++) {
            uint32_t w = tet[facet >> 2].vertex[j];
            if (j == (int)(facet & 3)) continue;
            if (v == BRIO_INFINITE || w == BRIO_INFINITE) {
                found = v == w;
                continue;
            }
            found = m->list[v].point == m->list[w].point;
            for (int a = 0; a < 3; a++) found &= m->list[v].shift[a] == m->list[w].shift[a] + shift[a];
        }
        BRIO_EXPECT(c->ctx, found, BRIO_ERR_CHECK, "tetrahedra %zu and %u are mates, but have no common facet", t,
                    facet >> 2);
    }
    return BRIO_OK;
}

/* A tetrahedron, and the one behind a facet of it, moved there. */
typedef struct {
    size_t t;
    int facet;
    double r[4][4]; /* its vertices; of an infinite one, the fourth is that of its finite mate */
    double e[4];    /* the apex of the one behind */
} neighbours;

/* Writes a x b, each coordinate with a relative error of some units in the last place. */
static void exact_cross(const double *a, const double *b, double *out) {
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double product = a[j] * b[i];
        out[k] = fma(a[i], b[j], -product) + fma(-a[j], b[i], product);
    }
}

/* Writes the normal out of a hull facet of a prism: upright to its direction, of any length. */
static void normal_of(checking *c, const double *x, const double *y, const double *z, const double *inner,
                      double *out) {
    double u[3], v[3], m[2][3], along[3];
    way(c, x, y, u);
    way(c, x, z, v);
    for (int k = 0; k < 3; k++) along[k] = x[k] + c->t->lattice.basis[0][k];
    exact_cross(c->basis[0], u, m[0]);
    exact_cross(c->basis[0], v, m[1]);
    int best = brio_dot(m[1], m[1]) > brio_dot(m[0], m[0]);
    int side = brio_orient3d_sign(&c->filter, x, along, best ? z : y, inner);
    for (int k = 0; k < 3; k++) out[k] = side > 0 ? -m[best][k] : m[best][k];
}

/* Adds the turn of a prism's hull at an edge between facets that are not in one plane.
 * inner  a vertex of the tetrahedron at the facet behind. */
static void add_turn(checking *c, const neighbours *n, const double *inner) {
    const double *a = c->basis[0], *x = n->r[(n->facet + 1) % 3], *y = n->r[(n->facet + 2) % 3];
    double here[3], there[3], sine[3], edge[3];
    normal_of(c, n->r[0], n->r[1], n->r[2], n->r[3], here);
    normal_of(c, x, y, n->e, inner, there);
    brio_cross(here, there, sine);
    way(c, x, y, edge);
    c->covered += atan2(brio_length(sine), brio_dot(here, there)) * fabs(brio_dot(edge, a)) / brio_dot(a, a);
}

/* Checks a hull facet: it holds the directions that repeat. */
static brio_status check_hull_facet(checking *c, size_t t, const double (*r)[4]) {
    const brio_lattice *l = &c->t->lattice;
    double u[3], v[3], cross[3], moved[3];
    for (int i = 0; i < l->rank; i++) {
        for (int k = 0; k < 3; k++) moved[k] = r[0][k] + l->basis[i][k];
        BRIO_EXPECT(c->ctx, brio_orient3d_sign(&c->filter, r[0], r[1], r[2], moved) == 0, BRIO_ERR_CHECK,
                    "hull facet %zu does not lie along the vectors that repeat", t);
    }
    way(c, r[0], r[1], u);
    way(c, r[0], r[2], v);
    exact_cross(u, v, cross);
    if (l->rank == 2) c->covered += brio_length(cross);
    return BRIO_OK;
}

/* Checks the edge of a hull facet to the one behind it: it is convex, or both go on in one plane. */
static brio_status check_hull_edge(checking *c, const neighbours *n, const double *inner) {
    const double *x = n->r[(n->facet + 1) % 3], *y = n->r[(n->facet + 2) % 3];
    int bend = brio_orient3d_sign(&c->filter, n->r[0], n->r[1], n->r[2], n->e);
    BRIO_EXPECT(c->ctx, bend <= 0, BRIO_ERR_CHECK, "the hull is not convex at tetrahedron %zu", n->t);
    if (bend < 0 && c->t->lattice.rank == 1) add_turn(c, n, inner);
    if (bend < 0) return BRIO_OK;
    int own = brio_orient3d_sign(&c->filter, x, y, n->r[3], n->r[n->facet]);
    BRIO_EXPECT(c->ctx, own * brio_orient3d_sign(&c->filter, x, y, n->r[3], n->e) < 0, BRIO_ERR_CHECK,
                "the hull is folded at tetrahedron %zu", n->t);
    return BRIO_OK;
}

/* Writes the vertex of the finite tetrahedron behind an infinite one, which is moved by a shift. */
static brio_status inner_of(const checking *c, size_t t, const int32_t *shift, double *record) {
    const brio_images *m = &c->t->images;
    int32_t way[3];
    uint32_t facet = c->t->tet[t].mate[3], apex = c->t->tet[facet >> 2].vertex[facet & 3];
    BRIO_EXPECT(c->ctx, (facet >> 2) < c->t->stats.tetrahedra, BRIO_ERR_CHECK,
                "no tetrahedron is behind hull facet %zu", t);
    brio_periodic_across(m, c->t->tet, t, 3, way);
    for (int k = 0; k < 3; k++) way[k] += shift[k];
    record_of(m, apex, way, record);
    return BRIO_OK;
}

/* Checks what is behind a facet: it is on the other side, and not in conflict. */
static brio_status check_behind(checking *c, neighbours *n, const int32_t *shift) {
    const brio_images *m = &c->t->images;
    const brio_tetrahedron *tet = c->t->tet;
    uint32_t facet = tet[n->t].mate[n->facet], apex = tet[facet >> 2].vertex[facet & 3];
    bool weighted = m->weight != NULL, infinite = tet[n->t].vertex[3] == BRIO_INFINITE;
    double inner[4];
    if (apex == BRIO_INFINITE) return BRIO_OK;
    record_of(m, apex, shift, n->e);
    if (infinite && n->facet < 3) {
        BRIO_FORWARD(inner_of(c, facet >> 2, shift, inner));
        return check_hull_edge(c, n, inner);
    }
    const double *at[4] = {n->r[0], n->r[1], n->r[2], n->r[3]};
    at[n->facet] = n->e;
    BRIO_EXPECT(c->ctx, brio_orient3d_sign(&c->filter, at[0], at[1], at[2], at[3]) < 0, BRIO_ERR_CHECK,
                "tetrahedron %u is not on the other side of facet %d of tetrahedron %zu", facet >> 2, n->facet, n->t);
    BRIO_EXPECT(c->ctx, infinite || !brio_conflict(&c->filter, n->r[0], n->r[1], n->r[2], n->r[3], n->e, weighted),
                BRIO_ERR_CHECK, "a vertex behind facet %d of tetrahedron %zu is in conflict with it", n->facet, n->t);
    return BRIO_OK;
}

static brio_status check_tetrahedron(checking *c, size_t t) {
    static const int32_t none[3] = {0, 0, 0};
    const brio_images *m = &c->t->images;
    const uint32_t *v = c->t->tet[t].vertex;
    neighbours n = {.t = t};
    bool infinite = v[3] == BRIO_INFINITE;
    for (int k = 0; k < (infinite ? 3 : 4); k++) record_of(m, v[k], none, n.r[k]);
    if (infinite) {
        BRIO_FORWARD(inner_of(c, t, none, n.r[3]));
        BRIO_FORWARD(check_hull_facet(c, t, (const double(*)[4])n.r));
    }
    BRIO_EXPECT(c->ctx, infinite || brio_orient3d_sign(&c->filter, n.r[0], n.r[1], n.r[2], n.r[3]) > 0, BRIO_ERR_CHECK,
                "tetrahedron %zu is not positive", t);
    int least = brio_images_least(m, v, 4);
    BRIO_EXPECT(c->ctx, v[least] < m->num_points, BRIO_ERR_CHECK,
                "the least vertex of tetrahedron %zu is not in the domain", t);
    for (n.facet = 0; n.facet < 4; n.facet++) {
        int32_t shift[3];
        brio_periodic_across(m, c->t->tet, t, n.facet, shift);
        BRIO_FORWARD(check_mate(c, t, n.facet, shift));
        BRIO_FORWARD(check_behind(c, &n, shift));
    }
    return BRIO_OK;
}

/* Adds up the volumes of the tetrahedra, with the rounding errors. Exact enough to tell one covering from two. */
static double volume_sum(const checking *c) {
    const brio_periodic *t = c->t;
    double sum = 0, lost = 0;
    for (size_t i = 0; i < t->stats.tetrahedra; i++) {
        const uint32_t *v = t->tet[i].vertex;
        double e[3][3], cross[3];
        for (int k = 0; k < 3; k++) way(c, t->images.x[v[0]], t->images.x[v[k + 1]], e[k]);
        exact_cross(e[1], e[2], cross);
        double x = brio_dot(e[0], cross), next = sum + x;
        lost += (sum - (next - (next - sum))) + (x - (next - sum));
        sum = next;
    }
    return sum + lost;
}

/* Scales the vectors that repeat by a power of two, by which volumes are in the range of doubles. */
static void begin_measure(checking *c) {
    const brio_lattice *l = &c->t->lattice;
    double longest = 0;
    for (int i = 0; i < l->rank; i++) longest = fmax(longest, brio_length(l->basis[i]));
    c->scale = exp2(-ilogb(longest));
    for (int i = 0; i < l->rank; i++)
        for (int k = 0; k < 3; k++) c->basis[i][k] = l->basis[i][k] * c->scale;
}

/* Returns how often space within the hull is covered. */
static double covering_of(const checking *c) {
    static const double TWO_TURNS = 12.566370614359172954;
    double cross[3];
    exact_cross(c->basis[0], c->basis[1], cross);
    if (c->t->lattice.rank == 1) return c->covered / TWO_TURNS;
    if (c->t->lattice.rank == 2) return c->covered / (4 * brio_length(cross));
    return volume_sum(c) / (6 * fabs(brio_dot(c->basis[2], cross)));
}

/* Checks that the points of dimension 2 or less lie in a plane or on a line with all their translates, which the first
 * point and the vectors span, and that there are no tetrahedra. */
static brio_status check_flat(const checking *c) {
    const brio_images *m = &c->t->images;
    const brio_lattice *l = m->lattice;
    double first[3][3];
    int count = 0, steps = m->num_points ? l->rank : 0;
    for (size_t i = 0; i < m->num_points + (size_t)steps; i++) {
        int32_t shift[3] = {0, 0, 0};
        double x[3];
        if (i > 0 && i <= (size_t)steps) shift[i - 1] = 1;
        brio_lattice_move(l, m->x[i <= (size_t)steps ? 0 : i - (size_t)steps], shift, x);
        if (count == 3) {
            BRIO_EXPECT(c->ctx, brio_orient3d(first[0], first[1], first[2], x) == 0, BRIO_ERR_CHECK,
                        "the points and their translates are not in one plane");
            continue;
        }
        if (count == 1 && brio_same_position(first[0], x)) continue;
        if (count == 2 && brio_collinear(first[0], first[1], x)) continue;
        memcpy(first[count++], x, sizeof x);
        BRIO_FORWARD(brio_look(c->ctx, 1));
    }
    BRIO_EXPECT(c->ctx, count - 1 == c->t->stats.dimension, BRIO_ERR_CHECK,
                "the points and their translates have dimension %d, not %d", count - 1, c->t->stats.dimension);
    BRIO_EXPECT(c->ctx, c->count == 0, BRIO_ERR_CHECK, "%zu tetrahedra of points of dimension %d", c->count, count - 1);
    return BRIO_OK;
}

/* Checks that representatives are vertices, and that vertices are those of the tetrahedra, where there are any. */
static brio_status check_points(const checking *c) {
    const brio_periodic *t = c->t;
    size_t vertices = 0;
    brio_status status = BRIO_OK;
    uint8_t *used = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, used, t->stats.points + 1));
    for (size_t i = 0; i < c->count; i++)
        for (int k = 0; k < 4; k++)
            if (t->tet[i].vertex[k] != BRIO_INFINITE) used[t->images.list[t->tet[i].vertex[k]].point] = 1;
    for (size_t p = 0; p < t->stats.points && t->stats.dimension < 3; p++) used[p] = t->representative[p].point == p;
    for (size_t p = 0; p < t->stats.points; p++) {
        bool is_vertex = t->representative[p].point == p;
        vertices += is_vertex;
        BRIO_REQUIRE(c->ctx, is_vertex == (used[p] != 0), BRIO_ERR_CHECK,
                     "point %zu is a vertex of tetrahedra or represents itself, but not both", p);
        BRIO_REQUIRE(c->ctx, used[t->representative[p].point], BRIO_ERR_CHECK, "point %zu is represented by no vertex",
                     p);
    }
    BRIO_REQUIRE(c->ctx,
                 vertices == t->stats.vertices && vertices + t->stats.duplicates + t->stats.hidden == t->stats.points,
                 BRIO_ERR_CHECK, "the numbers of vertices, duplicates and hidden points are wrong");
done:
    brio_release(c->ctx, used);
    return status;
}

brio_status brio_periodic_check(brio_context *ctx, const brio_periodic *t) {
    BRIO_DOOR;
    checking c = {.ctx = ctx, .t = t, .count = t->stats.tetrahedra + t->stats.hull_facets};
    const brio_lattice *l = &t->lattice;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, least = 0, most = 0;
    if (t->stats.dimension < 3) {
        BRIO_FORWARD(check_flat(&c));
        return check_points(&c);
    }
    for (size_t i = 0; i < t->images.count; i++) {
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], t->images.x[i][k]);
            high[k] = fmax(high[k], t->images.x[i][k]);
        }
        if (t->images.weight) least = fmin(least, t->images.weight[i]), most = fmax(most, t->images.weight[i]);
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < l->rank; i++) {
            low[k] -= 2 * BRIO_LATTICE_MOST_SHIFT * fabs(l->basis[i][k]);
            high[k] += 2 * BRIO_LATTICE_MOST_SHIFT * fabs(l->basis[i][k]);
        }
    double extent[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    begin_measure(&c);
    brio_filter_set(&c.filter, extent, most - least, t->images.weight != NULL);
    for (size_t i = 0; i < c.count; i++) {
        BRIO_FORWARD(check_tetrahedron(&c, i));
        BRIO_FORWARD(brio_look(ctx, 4));
    }
    BRIO_EXPECT(ctx, t->stats.hull_facets == 0 || l->rank < 3, BRIO_ERR_CHECK,
                "%zu infinite tetrahedra in a space that repeats", t->stats.hull_facets);
    double filled = covering_of(&c);
    BRIO_EXPECT(ctx, fabs(filled - 1) < 0x1p-20, BRIO_ERR_CHECK, "the tetrahedra fill their space %.9g times", filled);
    return check_points(&c);
}
