/* The graph of votes.
 *
 * A sample sees the Voronoi vertices of its cell: those towards its pole are on one side of the surface, those in the
 * opposite direction are on the other side. Which of the two sides is outside is unknown, too. So a wrong guess
 * about one sample does not spread: its tetrahedra have three other samples each.
 *
 * A flat tetrahedron within the surface tells next to nothing, whatever the direction of its Voronoi vertex. A thick one
 * tells much: hence the log-odds by direction and thickness. The four votes of a tetrahedron are counted as independent.
 * The area between the labels decides where nobody votes, and keeps single flat tetrahedra from sticking out. Area costs
 * little where the samples of a facet see its two tetrahedra in opposite directions, so that thin walls do not vanish to
 * save area.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009 (labels of
 *           Delaunay tetrahedra of least energy).
 *           Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999 (the two sides of a cell).
 * Differs from the papers: no lines of sight are known. Samples are unknowns, too. */
#include "reconstruct/labeled_delaunay/vote_graph.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/team.h"
#include "base/vector.h"
#include "reconstruct/cocone/triangle.h"
#include "reconstruct/labeled_delaunay/vote_weight.h"
#include <math.h>

enum { TETS_A_THREAD = 1 << 11, VOTES = 4, EDGES = 8, HULL_VOTES = 3, HULL_EDGES = 4 };

/* In log-odds, of a facet of the area of an equilateral triangle whose sides are one spacing: AREA is its weight in any
 * case, DOUBT is added if its samples see both of its tetrahedra in one direction. Larger facets weigh more, up to
 * MOST_AREA times as much. All chosen on generated solids. */
static const double AREA = 1, DOUBT = 6, MOST_AREA = 3;

typedef struct {
    brio_vote_graph *g;
    const brio_pole_vectors *dual;
    const double *spacing;
    double noise;
    float *cosine; /* #T by 4: between the axis of the sample in each slot and the direction to the Voronoi vertex */
} builder;

static size_t edges_before(const brio_pole_vectors *v, size_t tet) {
    return tet < v->num_finite ? EDGES * tet : EDGES * v->num_finite + HULL_EDGES * (tet - v->num_finite);
}

/* Returns the place of the edge across facet i of a tetrahedron. */
static size_t place_of_facet(const brio_pole_vectors *v, size_t tet, int i) {
    return edges_before(v, tet) + (tet < v->num_finite ? VOTES + (size_t)i : HULL_VOTES);
}

static const double *corner_of(const brio_pole_vectors *v, size_t tet, int slot) {
    return v->points + 3 * (size_t)v->t.tet[tet].vertex[slot];
}

/* Returns the inradius: three times the volume by the area. */
static double inradius(const brio_pole_vectors *v, size_t tet) {
    double u[3][3], n[3], area = 0;
    const double *o = corner_of(v, tet, 0);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) u[i][k] = corner_of(v, tet, i + 1)[k] - o[k];
    for (int i = 0; i < 4; i++) {
        const uint8_t *f = BRIO_FACET[i];
        area += brio_triangle_area(corner_of(v, tet, f[0]), corner_of(v, tet, f[1]), corner_of(v, tet, f[2]));
    }
    brio_cross(u[0], u[1], n);
    return area > 0 ? fabs(brio_dot(n, u[2])) / (2 * area) : 0;
}

/* Returns the cosine of the angle between the axis of a sample and the direction to the Voronoi vertex, 0 if the vertex
 * is not known. */
static double cosine_at(const brio_pole_vectors *v, size_t tet, uint32_t p) {
    double to[3], square;
    brio_towards_centre(v, tet, p, to);
    square = brio_dot(to, to);
    return square > 0 && square < INFINITY ? brio_dot(to, v->plane + 4 * (size_t)p) / sqrt(square) : 0;
}

/* Writes the edges from a tetrahedron to its samples. */
static void weigh_votes(const builder *b, size_t tet) {
    const brio_pole_vectors *v = b->dual;
    brio_signed_edge *edge = b->g->edge + edges_before(v, tet);
    bool finite = tet < v->num_finite;
    double thick = finite ? inradius(v, tet) : INFINITY;
    for (int i = 0; i < (finite ? VOTES : HULL_VOTES); i++) {
        uint32_t p = v->t.tet[tet].vertex[i];
        double log_odds = brio_vote_log_odds((double)b->cosine[4 * tet + (size_t)i], thick / b->spacing[p], b->noise);
        edge[i] = (brio_signed_edge){(uint32_t)v->t.count + p, (float)(BRIO_VOTE_UNIT * log_odds)};
    }
}

/* Returns the log-odds that the two tetrahedra of a facet have one label. */
static double facet_log_odds(const builder *b, uint32_t facet) {
    const brio_pole_vectors *v = b->dual;
    uint32_t tet = brio_tet_of(facet), other = brio_tet_of(*brio_mate(&v->t, facet));
    const uint8_t *f = BRIO_FACET[brio_slot_of(facet)];
    double spacing = 0, alike = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t p = v->t.tet[tet].vertex[f[k]];
        size_t there = (size_t)brio_slot_of_vertex(v->t.tet[other].vertex, p);
        spacing += b->spacing[p] / 3;
        alike += (double)b->cosine[4 * (size_t)tet + f[k]] * (double)b->cosine[4 * (size_t)other + there] / 3;
    }
    double unit = sqrt(3) / 4 * spacing * spacing;
    double area = brio_triangle_area(corner_of(v, tet, f[0]), corner_of(v, tet, f[1]), corner_of(v, tet, f[2]));
    return (AREA + DOUBT * (1 + alike) / 2) * (area < MOST_AREA * unit ? area / unit : MOST_AREA);
}

/* Writes the edge across a facet, at both ends. */
static void weigh_facet(const builder *b, uint32_t facet) {
    const brio_pole_vectors *v = b->dual;
    uint32_t tet = brio_tet_of(facet), mate = *brio_mate(&v->t, facet), other = brio_tet_of(mate);
    float weight = (float)(BRIO_VOTE_UNIT * facet_log_odds(b, facet));
    b->g->edge[place_of_facet(v, tet, brio_slot_of(facet))] = (brio_signed_edge){other, weight};
    b->g->edge[place_of_facet(v, other, brio_slot_of(mate))] = (brio_signed_edge){tet, weight};
}

static void place_node(const builder *b, size_t tet) {
    const brio_pole_vectors *v = b->dual;
    int count = tet < v->num_finite ? 4 : 3;
    double *at = b->g->position + 3 * tet;
    for (int k = 0; k < 3; k++) {
        at[k] = 0;
        for (int i = 0; i < count; i++) at[k] += corner_of(v, tet, i)[k] / count;
    }
}

static void find_cosines(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++)
        for (int i = 0; i < (tet < b->dual->num_finite ? VOTES : HULL_VOTES); i++)
            b->cosine[4 * tet + (size_t)i] = (float)cosine_at(b->dual, tet, b->dual->t.tet[tet].vertex[i]);
}

static void weigh_tetrahedra(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    const brio_pole_vectors *v = b->dual;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) {
        b->g->first[tet] = edges_before(v, tet);
        place_node(b, tet);
        weigh_votes(b, tet);
        for (int i = tet < v->num_finite ? 0 : 3; i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            if (facet < *brio_mate(&v->t, facet)) weigh_facet(b, facet);
        }
    }
}

/* Copies the edges between tetrahedra and samples to the samples, in the order of the tetrahedra. */
static void deal_out_votes(const builder *b, size_t *next) {
    const brio_pole_vectors *v = b->dual;
    for (size_t tet = 0; tet < v->t.count; tet++) {
        const brio_signed_edge *vote = b->g->edge + edges_before(v, tet);
        for (int i = 0; i < (tet < v->num_finite ? VOTES : HULL_VOTES); i++)
            b->g->edge[next[v->t.tet[tet].vertex[i]]++] = (brio_signed_edge){(uint32_t)tet, vote[i].weight};
    }
}

static brio_status list_votes(const builder *b) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = b->dual;
    brio_context *ctx = b->g->ctx;
    size_t *next = NULL, *first = b->g->first + v->t.count, n = v->num_points;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, next, n));
    for (size_t tet = 0; tet < v->t.count; tet++)
        for (int i = 0; i < (tet < v->num_finite ? VOTES : HULL_VOTES); i++) next[v->t.tet[tet].vertex[i]]++;
    first[n] = brio_counts_to_places(next, 1, n, edges_before(v, v->t.count));
    for (size_t p = 0; p < n; p++) first[p] = next[p];
    deal_out_votes(b, next);
done:
    brio_release(ctx, next);
    return status;
}

brio_status brio_vote_graph_new(brio_context *ctx, const brio_pole_vectors *dual, const double *spacing, double noise,
                                brio_vote_graph *out) {
    brio_status status = BRIO_OK;
    size_t size = dual->t.count, n = dual->num_points, hull = size - dual->num_finite;
    builder b = {.g = out, .dual = dual, .spacing = spacing, .noise = noise};
    int threads = brio_threads(ctx, size, TETS_A_THREAD);
    *out = (brio_vote_graph){.ctx = ctx, .dual = dual};
    BRIO_TRY(BRIO_ALLOC(ctx, out->first, size + n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->edge, edges_before(dual, size) + VOTES * dual->num_finite + HULL_VOTES * hull));
    BRIO_TRY(BRIO_ALLOC(ctx, out->position, 3 * (size + n)));
    BRIO_TRY(BRIO_ALLOC(ctx, b.cosine, 4 * size));
    brio_for(ctx, threads, size, find_cosines, &b);
    brio_for(ctx, threads, size, weigh_tetrahedra, &b);
    for (size_t i = 0; i < 3 * n; i++) out->position[3 * size + i] = dual->points[i];
    BRIO_TRY(list_votes(&b));
done:
    brio_release(ctx, b.cosine);
    return status;
}

void brio_vote_graph_free(brio_vote_graph *g) {
    brio_release(g->ctx, g->first);
    brio_release(g->ctx, g->edge);
    brio_release(g->ctx, g->position);
    *g = (brio_vote_graph){.ctx = g->ctx};
}
