/* The exact check of a Delaunay or regular triangulation.
 *
 * A closed adjacency of positive tetrahedra with a locally convex hull of genus 0, in which no point is covered twice,
 * triangulates the convex hull; and it is regular when every two neighbours are: the far vertex of one is not inside
 * the other's (ortho)sphere. With ties broken by the symbolic perturbation the regular triangulation is unique, so
 * "locally regular under the perturbation" means "the one that brio_delaunay computes". Every remaining point is
 * located exactly, and must be at a vertex that is not lighter, or outside the orthosphere of the tetrahedron that
 * holds it.
 *
 * Inputs of fewer dimensions have no tetrahedra to look at; their check is in check_flat.c. */
#include "base/float_state.h"
#include "base/memory.h"
#include "triangulation/adjacency.h"
#include "triangulation/check.h"
#include "triangulation/locate.h"
#include "triangulation/triangulation.h"

typedef struct {
    brio_context *ctx;
    brio_tetrahedra t;
    brio_filter filter;
    bool weighted;
    size_t num_points;
    uint32_t *vertex_tet; /* a tetrahedron of each vertex, BRIO_NO_TET of other points */
    bool canonical;
} judge;

static const uint32_t *vertices_of(const judge *j, size_t tet) {
    return j->t.tet[tet].vertex;
}

/* --- structure --- */

static bool same_facet(const judge *j, uint32_t f, uint32_t g) {
    const uint32_t *v = vertices_of(j, brio_tet_of(f)), *w = vertices_of(j, brio_tet_of(g));
    for (int i = 0; i < 3; i++)
        if (brio_slot_of_vertex(w, v[BRIO_FACET[brio_slot_of(f)][i]]) == 4) return false;
    return brio_slot_of_vertex(w, v[brio_slot_of(f)]) == 4;
}

static brio_status check_mates(const judge *j) {
    brio_status status = BRIO_OK;
    for (size_t f = 0; f < 4 * j->t.count; f++) {
        uint32_t g = *brio_mate(&j->t, (uint32_t)f);
        BRIO_REQUIRE(j->ctx, g < 4 * j->t.count && *brio_mate(&j->t, g) == f && same_facet(j, (uint32_t)f, g),
                     BRIO_ERR_CHECK, "facet %zu of tetrahedron %zu and its mate do not match", f % 4, f / 4);
    }
done:
    return status;
}

static brio_status check_orientation(judge *j) {
    brio_status status = BRIO_OK;
    const brio_record *r = j->t.record;
    for (size_t tet = 0; tet < j->t.count; tet++) {
        const uint32_t *v = vertices_of(j, tet);
        bool infinite = v[3] == BRIO_INFINITE;
        for (int i = 0; i < 4 - infinite; i++)
            BRIO_REQUIRE(j->ctx, v[i] < j->num_points, BRIO_ERR_CHECK, "tetrahedron %zu: no point %u", tet, v[i]);
        if (infinite) { /* its three vertices run the other way round than in the finite neighbour */
            uint32_t m = j->t.tet[tet].mate[3];
            const uint32_t *w = vertices_of(j, brio_tet_of(m));
            const uint8_t *f = BRIO_FACET[brio_slot_of(m)];
            int at = v[0] == w[f[0]] ? 0 : v[0] == w[f[1]] ? 1 : 2;
            BRIO_REQUIRE(j->ctx, w[3] != BRIO_INFINITE && v[1] == w[f[(at + 2) % 3]], BRIO_ERR_CHECK,
                         "infinite tetrahedron %zu is turned inside out", tet);
        } else {
            BRIO_REQUIRE(j->ctx, brio_orient3d_sign(&j->filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]]) > 0, BRIO_ERR_CHECK,
                         "tetrahedron %zu (%u %u %u %u) is not positive", tet, v[0], v[1], v[2], v[3]);
        }
    }
done:
    return status;
}

/* Whether `tet` is the least of the tetrahedra round the edge opposite to slots a and b; false also for a ring that
 * does not close. */
static bool leads_ring(const judge *j, uint32_t tet, int a, int b) {
    uint32_t from = tet;
    uint32_t u = vertices_of(j, tet)[a]; /* leave through the facet opposite to u, keep turning the same way */
    uint32_t pivot = vertices_of(j, tet)[b];
    for (size_t steps = 0; steps <= j->t.count; steps++) {
        uint32_t mate = j->t.tet[from].mate[brio_slot_of_vertex(vertices_of(j, from), u)];
        uint32_t next = brio_tet_of(mate);
        if (next == tet) return true;
        if (next < tet) return false;
        u = pivot;
        pivot = brio_apex(&j->t, mate);
        from = next;
    }
    return false;
}

/* V - E + F - T = 0 for the triangulated 3-sphere that the infinite vertex closes; 2 for the hull; one component. */
static brio_status check_euler(judge *j) {
    brio_status status = BRIO_OK;
    size_t vertices = 1, edges = 0, hull_facets = 0, hull_vertices = 0, reached = 0;
    uint32_t *stack = NULL;
    uint8_t *seen = NULL, *on_hull = NULL;
    BRIO_TRY(BRIO_ALLOC(j->ctx, stack, j->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(j->ctx, seen, j->t.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(j->ctx, on_hull, j->num_points));
    for (size_t p = 0; p < j->num_points; p++) vertices += j->vertex_tet[p] != BRIO_NO_TET;
    for (size_t tet = 0; tet < j->t.count; tet++) {
        const uint32_t *v = vertices_of(j, tet);
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++) edges += leads_ring(j, (uint32_t)tet, a, b);
        if (v[3] != BRIO_INFINITE) continue;
        hull_facets++;
        for (int i = 0; i < 3; i++) hull_vertices += !on_hull[v[i]], on_hull[v[i]] = 1;
    }
    BRIO_REQUIRE(j->ctx, vertices + 2 * j->t.count == edges + j->t.count, BRIO_ERR_CHECK,
                 "Euler's relation fails: %zu vertices, %zu edges, %zu tetrahedra", vertices, edges, j->t.count);
    BRIO_REQUIRE(j->ctx, 2 * hull_vertices == hull_facets + 4, BRIO_ERR_CHECK,
                 "the hull is no sphere: %zu vertices, %zu facets", hull_vertices, hull_facets);
    seen[0] = 1;
    for (stack[reached++] = 0; reached > 0;) {
        uint32_t tet = stack[--reached];
        for (int i = 0; i < 4; i++) {
            uint32_t other = brio_tet_of(j->t.tet[tet].mate[i]);
            if (!seen[other]) seen[other] = 1, stack[reached++] = other;
        }
    }
    for (size_t tet = 0; tet < j->t.count; tet++)
        BRIO_REQUIRE(j->ctx, seen[tet], BRIO_ERR_CHECK, "tetrahedron %zu is not connected to the first", tet);
done:
    brio_release(j->ctx, stack);
    brio_release(j->ctx, seen);
    brio_release(j->ctx, on_hull);
    return status;
}

/* --- geometry --- */

static brio_status check_hull_edge(judge *j, size_t tet, uint32_t far) {
    brio_status status = BRIO_OK;
    const uint32_t *v = vertices_of(j, tet);
    const brio_record *r = j->t.record;
    BRIO_REQUIRE(j->ctx, brio_orient3d_sign(&j->filter, r[v[0]], r[v[1]], r[v[2]], r[far]) <= 0, BRIO_ERR_CHECK,
                 "the hull is not convex: point %u is outside of facet (%u %u %u)", far, v[0], v[1], v[2]);
done:
    return status;
}

static brio_status check_sphere(judge *j, size_t tet, uint32_t far) {
    brio_status status = BRIO_OK;
    const uint32_t *v = vertices_of(j, tet);
    const double *a = j->t.record[v[0]], *b = j->t.record[v[1]], *c = j->t.record[v[2]], *d = j->t.record[v[3]],
                 *e = j->t.record[far];
    int sign = brio_insphere_sign(&j->filter, a, b, c, d, e, j->weighted);
    BRIO_REQUIRE(j->ctx, sign <= 0, BRIO_ERR_CHECK, "point %u is inside the sphere of tetrahedron %zu (%u %u %u %u)",
                 far, tet, v[0], v[1], v[2], v[3]);
    if (sign == 0 && brio_insphere_tie(&j->filter, a, b, c, d, e) > 0) j->canonical = false;
done:
    return status;
}

/* Across every facet, seen once; facets between a finite and an infinite tetrahedron hold by orientation. */
static brio_status check_facets(judge *j) {
    brio_status status = BRIO_OK;
    for (size_t f = 0; f < 4 * j->t.count; f++) {
        uint32_t g = *brio_mate(&j->t, (uint32_t)f);
        if (g < f) continue;
        if ((f & 0xffffc) == 0) BRIO_TRY(brio_progress(j->ctx, "check", (double)f / (double)(4 * j->t.count)));
        bool infinite = brio_is_infinite(&j->t, (uint32_t)(f / 4)), other = brio_is_infinite(&j->t, brio_tet_of(g));
        uint32_t far = vertices_of(j, brio_tet_of(g))[brio_slot_of(g)];
        if (infinite && other)
            BRIO_TRY(check_hull_edge(j, f / 4, far));
        else if (!infinite && !other)
            BRIO_TRY(check_sphere(j, f / 4, far));
    }
done:
    return status;
}

/* The side of (a, b, c) on which a point just inside the tetrahedron `seed` lies, next to its first vertex: an
 * orientation is affine in its last point, so the first of the seed's vertices off the plane decides. */
static int side_of_seed(judge *j, const uint32_t *seed, uint32_t a, uint32_t b, uint32_t c) {
    const brio_record *r = j->t.record;
    int side = 0;
    for (int i = 0; i < 4 && !side; i++) side = brio_orient3d_sign(&j->filter, r[a], r[b], r[c], r[seed[i]]);
    return side;
}

/* Nothing is covered twice: a point inside one finite tetrahedron is in no other and inside of every hull facet.
 * Positive tetrahedra cover every point inside the hull equally often, and a hull that is seen once from one point is
 * embedded. */
static brio_status check_cover(judge *j) {
    brio_status status = BRIO_OK;
    size_t first = 0;
    while (first < j->t.count && brio_is_infinite(&j->t, (uint32_t)first)) first++;
    BRIO_REQUIRE(j->ctx, first < j->t.count, BRIO_ERR_CHECK, "no finite tetrahedron");
    const uint32_t *seed = vertices_of(j, first);
    for (size_t tet = 0; tet < j->t.count; tet++) {
        const uint32_t *v = vertices_of(j, tet);
        if (v[3] == BRIO_INFINITE) {
            BRIO_REQUIRE(j->ctx, side_of_seed(j, seed, v[0], v[1], v[2]) < 0, BRIO_ERR_CHECK,
                         "tetrahedron %zu is outside of hull facet (%u %u %u)", first, v[0], v[1], v[2]);
            continue;
        }
        int inside = 0;
        for (; inside < 4; inside++) {
            const uint8_t *f = BRIO_FACET[inside];
            if (side_of_seed(j, seed, v[f[0]], v[f[1]], v[f[2]]) <= 0) break;
        }
        BRIO_REQUIRE(j->ctx, inside < 4 || tet == first, BRIO_ERR_CHECK, "tetrahedra %zu and %zu overlap", first, tet);
    }
done:
    return status;
}

/* A point that is no vertex: a duplicate of one that is not lighter, or hidden under the tetrahedron that holds it. */
static brio_status check_point(judge *j, brio_walk *walk, uint32_t p) {
    brio_status status = BRIO_OK;
    const double *x = j->t.record[p];
    uint32_t tet = brio_locate_walk(&j->t, &j->filter, walk, x, UINT64_MAX);
    const uint32_t *v = vertices_of(j, tet);
    walk->start = tet;
    BRIO_REQUIRE(j->ctx, v[3] != BRIO_INFINITE, BRIO_ERR_CHECK, "point %u is outside the hull", p);
    for (int i = 0; i < 4; i++)
        if (brio_same_position(j->t.record[v[i]], x)) {
            BRIO_REQUIRE(j->ctx, !j->weighted || x[3] <= j->t.record[v[i]][3], BRIO_ERR_CHECK,
                         "point %u is heavier than vertex %u at the same position", p, v[i]);
            goto done;
        }
    BRIO_REQUIRE(j->ctx, j->weighted, BRIO_ERR_CHECK, "point %u is no vertex", p);
    BRIO_TRY(check_sphere(j, tet, p));
done:
    return status;
}

static brio_status check_points(judge *j) {
    brio_status status = BRIO_OK;
    brio_walk walk = {0};
    for (size_t p = 0; p < j->num_points; p++)
        if (j->vertex_tet[p] == BRIO_NO_TET) BRIO_TRY(check_point(j, &walk, (uint32_t)p));
done:
    return status;
}

/* --- all of it --- */

brio_status brio_check_tetrahedra(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, bool weighted,
                                  bool *canonical) {
    judge j = {.ctx = ctx, .t = *t, .weighted = weighted, .num_points = num_points, .canonical = true};
    brio_status status = BRIO_OK;
    brio_filter_for(&j.filter, t->record, num_points, weighted);
    BRIO_TRY(BRIO_ALLOC(ctx, j.vertex_tet, num_points));
    for (size_t p = 0; p < num_points; p++) j.vertex_tet[p] = BRIO_NO_TET;
    BRIO_TRY(check_mates(&j));
    BRIO_TRY(check_orientation(&j));
    for (size_t tet = 0; tet < t->count; tet++)
        for (int i = 0; i < 4; i++)
            if (vertices_of(&j, tet)[i] != BRIO_INFINITE) j.vertex_tet[vertices_of(&j, tet)[i]] = (uint32_t)tet;
    BRIO_TRY(check_euler(&j));
    BRIO_TRY(check_facets(&j));
    BRIO_TRY(check_cover(&j));
    BRIO_TRY(check_points(&j));
    *canonical = j.canonical;
done:
    brio_release(ctx, j.vertex_tet);
    return status;
}

brio_status brio_tetrahedra_check(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                  const uint32_t *tetrahedra, size_t stride, size_t num_tetrahedra, int *canonical) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_record *record = NULL;
    brio_tetrahedra t = {0};
    bool same = true;
    BRIO_TRY(brio_records_new(ctx, points, weights, num_points, NULL, 1, &record));
    if (num_tetrahedra == 0) {
        BRIO_REQUIRE(ctx, brio_dimension(record, num_points) < 3, BRIO_ERR_CHECK,
                     "no tetrahedra, but the points are not in a plane");
    } else {
        BRIO_TRY(brio_adjacency_build(ctx, record, num_points, tetrahedra, stride, num_tetrahedra, &t));
        BRIO_TRY(brio_check_tetrahedra(ctx, &t, num_points, weights != NULL, &same));
    }
    if (canonical) *canonical = same;
done:
    brio_release(ctx, record);
    brio_release(ctx, t.tet);
    return status;
}

/* The vertices are the points that represent themselves, and each other point is represented by a vertex: of its own
 * position where there is one. */
static brio_status check_representatives(brio_context *ctx, const brio_triangulation *t, const brio_record *r) {
    brio_status status = BRIO_OK;
    size_t vertices = 0;
    for (size_t p = 0; p < t->stats.points; p++) {
        uint32_t v = t->representative[p];
        vertices += v == p;
        BRIO_REQUIRE(ctx, v < t->stats.points && t->representative[v] == v, BRIO_ERR_CHECK,
                     "point %zu is represented by %u, which is no vertex", p, v);
        bool right = !brio_same_position(r[p], r[v]) || r[v][3] > r[p][3] || (r[v][3] == r[p][3] && v <= p);
        BRIO_REQUIRE(ctx, right, BRIO_ERR_CHECK, "point %zu should represent its duplicate %u", p, v);
    }
    BRIO_REQUIRE(ctx, vertices == t->stats.vertices, BRIO_ERR_CHECK, "%zu vertices counted as %zu", vertices,
                 t->stats.vertices);
    BRIO_REQUIRE(ctx, t->stats.vertices + t->stats.duplicates + t->stats.hidden == t->stats.points, BRIO_ERR_CHECK,
                 "%zu points are not %zu vertices, %zu duplicates and %zu hidden", t->stats.points, t->stats.vertices,
                 t->stats.duplicates, t->stats.hidden);
done:
    return status;
}

static brio_status check_used(brio_context *ctx, const brio_triangulation *t, size_t tets) {
    brio_status status = BRIO_OK;
    for (size_t i = 0; i < 4 * tets; i++) {
        uint32_t v = t->tet[i / 4].vertex[i % 4];
        BRIO_REQUIRE(ctx, v == BRIO_INFINITE || (v < t->stats.points && t->representative[v] == v), BRIO_ERR_CHECK,
                     "tetrahedron %zu has the vertex %u, which represents nothing", i / 4, v);
    }
done:
    return status;
}

brio_status brio_triangulation_check(brio_context *ctx, const brio_triangulation *t, const double *points,
                                     const double *weights, size_t num_points) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_record *record = NULL;
    bool canonical = true;
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    BRIO_REQUIRE(ctx, num_points == t->stats.points, BRIO_ERR_ARGUMENT, "%zu points for a triangulation of %zu",
                 num_points, t->stats.points);
    BRIO_TRY(brio_records_new(ctx, points, weights, num_points, NULL, 1, &record));
    BRIO_REQUIRE(ctx, brio_dimension(record, num_points) == t->stats.dimension, BRIO_ERR_CHECK,
                 "the points' dimension is not %d", t->stats.dimension);
    BRIO_TRY(check_representatives(ctx, t, record));
    BRIO_TRY(check_used(ctx, t, tets));
    if (t->stats.dimension < 3) {
        BRIO_TRY(brio_check_flat(ctx, t, points, weights));
    } else {
        brio_tetrahedra view = {t->tet, tets, BRIO_INFINITE, record, NULL};
        BRIO_TRY(brio_check_tetrahedra(ctx, &view, num_points, weights != NULL, &canonical));
    }
    BRIO_REQUIRE(ctx, canonical, BRIO_ERR_CHECK, "ties are not broken by the symbolic perturbation");
done:
    brio_release(ctx, record);
    return status;
}
