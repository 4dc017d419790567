/* The exact check of a Delaunay or regular triangulation.
 *
 * Positive tetrahedra (a, b, c, d) have det [b-a, c-a, d-a] > 0. A hull facet is facet 3 of an infinite tetrahedron,
 * oriented so that (hull facet, x) is positive for x outside. The seed o is a point of the first finite tetrahedron,
 * infinitesimally close to its first vertex, on no plane of a facet.
 *
 * The tests:
 *   1  Every finite tetrahedron is positive, and the infinite vertex is only ever in slot 3.
 *   2  Mates are mutual and have the same three vertices.
 *   3  Mates see their vertices in opposite cyclic orders. For two positive tetrahedra that says: their apexes are
 *      strictly on opposite sides of the facet.
 *   4  o is strictly on the inner side of every hull facet, and in no finite tetrahedron except the first.
 *   5  At every hull edge, the apex of one hull facet is not strictly outside of the other hull facet.
 *   6  Across every facet, the apex of one tetrahedron is not inside the (ortho)sphere of the other tetrahedron.
 *   7  Every input point that is no vertex lies in a tetrahedron (closed). It is at a vertex that is not lighter, or it
 *      is not inside the (ortho)sphere of that tetrahedron.
 *
 * Theorem. Sets that pass are exactly the Delaunay (regular) triangulations of the points: simplicial complexes that
 * cover the convex hull, with no point inside the sphere of any tetrahedron.
 *
 * Proof. That triangulations pass is plain. Let a set pass.
 *   A. The cover. Let c(x) count the tetrahedra that hold x, for x on no facet. Follow a ray from o that meets no edge.
 *      At a facet that is no hull facet the ray leaves a tetrahedron and enters its mate (3): c stays. At a hull facet
 *      the ray leaves a finite tetrahedron: c drops by 1. (Two infinite tetrahedra cannot be mates there, or o would be
 *      on both inner sides, against 4.) Far away c = 0, and c(o) = 1 (4), so the ray meets exactly one hull facet; c is
 *      1 before it and 0 behind it. So no two tetrahedra overlap, and the union P of all of them is star-shaped about
 *      o.
 *   B. Convexity. Cut with a plane E through o that meets no vertex. Every hull facet that E meets gives a segment,
 *   with
 *      o strictly on its inner side. Mates join segments at hull edges, and the angle about o keeps growing from each
 *      segment to the next (3). So the segments form cycles round o; by A every direction is met once, so there is one
 *      cycle, and it goes round once. By 5 no corner is reflex: the polygon, and so the cut of P with E, is convex. Any
 *      two inner points of P are limits of pairs whose plane with o is such an E. P is closed, so P is convex.
 *   C. The complex. Near a point x of P, tetrahedra that hold x are connected across facets that hold x, because P
 *      without its edges and vertices is connected there, and by A only the mate lies behind a facet. Mates share the
 *      vertices of that facet, so the smallest face that holds x has the same vertices in all of these tetrahedra. So
 *      two tetrahedra meet in a common face, one position is one vertex, and Euler's relation holds.
 *   D. The spheres. Lift every vertex p to |p|^2 - w and interpolate over each tetrahedron: a function f on P. By 6 f
 *   is
 *      convex across every facet, so f is convex along every segment that meets no edge, so f is convex. So the linear
 *      function of any tetrahedron is at most f everywhere, and no vertex is inside the sphere of any tetrahedron.
 *      Another point x has a lift of at least f(x), by 7 for the tetrahedron that holds x, so x is inside no sphere
 *      either. By 7 all points are in P, and P is their convex hull.
 *   E. Ties. Under the symbolic perturbation the regular triangulation is unique, and D holds with perturbed lifts. So
 *      the set is the one that brio_delaunay computes if and only if every zero in 6 and 7 is "outside" when perturbed.
 *
 * In the argument A and B are the checks of convex polytopes in the first two papers, from one seed and for all facets
 * instead of one ray.
 *
 * Inputs of fewer dimensions have no tetrahedra to look at; their check is in check_flat.c.
 *
 * Based on: Mehlhorn, Naeher, Seel, Seidel, Schilz, Schirra, Uhrig. Checking geometric programs or verification of
 *           geometric structures. CGTA 1999.
 *           Devillers, Liotta, Preparata, Tamassia. Checking the convexity of polytopes and the planarity of
 *           subdivisions. CGTA 1998.
 *           Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/sort.h"
#include "triangulation/check.h"
#include "triangulation/records.h"
#include "triangulation/tetrahedra.h"
#include "triangulation/triangulation.h"
#include <assert.h>
#include <string.h>

/* --- neighbours --- */

/* Adjacency of tetrahedra from their vertices alone.
 *
 * Simplices of one dimension are matched by their sorted vertices: a counting sort by the smallest vertex, then a small
 * sort in each bucket brings the two sides of a facet, or of a hull edge, next to each other. */

/** Finite tetrahedra that a caller has: the four vertices of tetrahedron i are at vertices + stride * i. */
typedef struct {
    const uint32_t *vertices;
    size_t stride, count;
} brio_tetrahedron_list;

/* Writes the vertices of a handle in ascending order: three of a facet, or two of a hull edge (facet of an infinite
 * tetrahedron). */
static void sorted_vertices(const brio_tetrahedra *t, uint32_t handle, uint32_t v[3]) {
    const uint32_t *tet = t->tet[brio_tet_of(handle)].vertex;
    const uint8_t *f = BRIO_FACET[brio_slot_of(handle)];
    uint32_t a = tet[f[0]], b = tet[f[1]], c = tet[f[2]], swap;
    assert(brio_has_tet(t, brio_tet_of(handle)));
    if (a > b) swap = a, a = b, b = swap;
    if (b > c) swap = b, b = c, c = swap;
    if (a > b) swap = a, a = b, b = swap;
    v[0] = a, v[1] = b, v[2] = c;
}

static int compare_handles(uint32_t g, uint32_t h, const void *user) {
    uint32_t v[3], w[3];
    sorted_vertices(user, g, v);
    sorted_vertices(user, h, w);
    for (int i = 0; i < 3; i++)
        if (v[i] != w[i]) return v[i] < w[i] ? -1 : 1;
    return g < h ? -1 : g > h;
}

static bool same_vertices(const brio_tetrahedra *t, uint32_t g, uint32_t h) {
    uint32_t v[3], w[3];
    sorted_vertices(t, g, v);
    sorted_vertices(t, h, w);
    return v[0] == w[0] && v[1] == w[1] && v[2] == w[2];
}

/* Sorts handles by their vertices. */
static brio_status sort_handles(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, const uint32_t *handles,
                                size_t n, uint32_t *sorted) {
    size_t *end = NULL;
    brio_status status = BRIO_ALLOC_ZERO(ctx, end, num_points + 1);
    if (status != BRIO_OK) return status;
    uint32_t v[3];
    for (size_t i = 0; i < n; i++) {
        BRIO_TRY(brio_look(ctx, 1));
        sorted_vertices(t, handles[i], v), end[v[0]]++;
    }
    brio_counts_to_places(end, 1, num_points, 0);
    for (size_t i = 0; i < n; i++) {
        BRIO_TRY(brio_look(ctx, 1));
        sorted_vertices(t, handles[i], v), sorted[end[v[0]]++] = handles[i];
    }
    for (size_t b = 0, begin = 0; b < num_points; begin = end[b++]) {
        BRIO_TRY(brio_look(ctx, end[b] - begin));
        BRIO_TRY(brio_sort_many_indices(ctx, sorted + begin, end[b] - begin, compare_handles, t));
    }
done:
    brio_release(ctx, end);
    return status;
}

/* Makes equal neighbours in a sorted list mates; those without one go to the front of the list, *alone of them. */
static brio_status match(brio_context *ctx, brio_tetrahedra *t, uint32_t *sorted, size_t n, size_t *alone) {
    *alone = 0;
    for (size_t i = 0; i < n; i++) {
        bool pair = i + 1 < n && same_vertices(t, sorted[i], sorted[i + 1]);
        BRIO_FORWARD(brio_look(ctx, 1));
        if (!pair) {
            sorted[(*alone)++] = sorted[i];
            continue;
        }
        BRIO_EXPECT(ctx, i + 2 >= n || !same_vertices(t, sorted[i], sorted[i + 2]), BRIO_ERR_CHECK,
                    "tetrahedra %u, %u and %u share a facet", brio_tet_of(sorted[i]), brio_tet_of(sorted[i + 1]),
                    brio_tet_of(sorted[i + 2]));
        assert(*alone <= i); /* handles left alone are written behind those that are read */
        *brio_mate(t, sorted[i]) = sorted[i + 1];
        *brio_mate(t, sorted[i + 1]) = sorted[i];
        i++;
    }
    return BRIO_OK;
}

/* Copies the vertices, each tetrahedron made positive. */
static brio_status copy_positive(brio_context *ctx, const brio_record *r, size_t num_points,
                                 const brio_tetrahedron_list *from, brio_tetrahedron *to) {
    for (size_t tet = 0; tet < from->count; tet++) {
        uint32_t *v = to[tet].vertex;
        memcpy(v, from->vertices + from->stride * tet, 4 * sizeof *v);
        for (int i = 0; i < 4; i++)
            BRIO_EXPECT(ctx, v[i] < num_points, BRIO_ERR_CHECK, "tetrahedron %zu: no point %u", tet,
                        BRIO_POINT(ctx, v[i]));
        int sign = brio_orient3d(r[v[0]], r[v[1]], r[v[2]], r[v[3]]);
        BRIO_EXPECT(ctx, sign != 0, BRIO_ERR_CHECK, "tetrahedron %zu (%u %u %u %u) is flat", tet, v[0], v[1], v[2],
                    v[3]);
        if (sign < 0) {
            uint32_t swap = v[2];
            v[2] = v[3], v[3] = swap;
        }
    }
    return BRIO_OK;
}

/* Makes an infinite tetrahedron behind each hull facet.   edges  receives the handles of its three facets through the
 * infinite vertex. */
static void close_hull(brio_tetrahedra *t, size_t first, const uint32_t *hull, size_t num_hull, uint32_t *edges) {
    for (size_t i = 0; i < num_hull; i++) {
        uint32_t tet = (uint32_t)(first + i), *v = t->tet[tet].vertex;
        const uint32_t *inside = t->tet[brio_tet_of(hull[i])].vertex;
        const uint8_t *f = BRIO_FACET[brio_slot_of(hull[i])];
        v[0] = inside[f[0]], v[1] = inside[f[2]], v[2] = inside[f[1]], v[3] = BRIO_INFINITE;
        assert(brio_has_tet(t, tet));
        t->tet[tet].mate[3] = hull[i];
        *brio_mate(t, hull[i]) = brio_facet_of(tet, 3);
        for (int j = 0; j < 3; j++) edges[3 * i + (size_t)j] = brio_facet_of(tet, j);
    }
}

/* Builds the full structure of `tetrahedra.h` from the vertices of finite tetrahedra: makes each positive, matches
 * facets, and closes the hull with infinite tetrahedra. record holds num_points records; tet of
 *  *out becomes owned by the caller. Returns BRIO_OK, BRIO_ERR_CHECK (an index out of range, a flat tetrahedron, a
 *  facet of three tetrahedra, an edge of the hull without exactly two hull facets; the message says where),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
static brio_status adjacency_build(brio_context *ctx, const brio_record *record, size_t num_points,
                                   const brio_tetrahedron_list *tetrahedra, brio_tetrahedra *out) {
    brio_status status = BRIO_OK;
    size_t n = tetrahedra->count;
    brio_tetrahedra t = {.infinite = BRIO_INFINITE, .record = record};
    uint32_t *handles = NULL, *sorted = NULL, *edges = NULL;
    size_t num_hull = 0, alone = 0;
    BRIO_REQUIRE(ctx, n < UINT32_C(1) << 29, BRIO_ERR_TOO_LARGE, "%zu tetrahedra; at most 2^29 - 1", n);
    BRIO_TRY(BRIO_ALLOC(ctx, t.tet, n));
    t.count = n;
    BRIO_TRY(copy_positive(ctx, record, num_points, tetrahedra, t.tet));
    BRIO_TRY(BRIO_ALLOC(ctx, handles, 4 * n));
    BRIO_TRY(BRIO_ALLOC(ctx, sorted, 4 * n));
    for (size_t h = 0; h < 4 * n; h++) handles[h] = (uint32_t)h;
    BRIO_TRY(sort_handles(ctx, &t, num_points, handles, 4 * n, sorted));
    BRIO_TRY(match(ctx, &t, sorted, 4 * n, &num_hull));
    t.count = n + num_hull;
    BRIO_REQUIRE(ctx, t.count <= (size_t)1 << 30, BRIO_ERR_TOO_LARGE,
                 "%zu tetrahedra, infinite ones included; at most 2^30", t.count);
    BRIO_TRY(BRIO_RESIZE(ctx, t.tet, t.count));
    BRIO_TRY(BRIO_ALLOC(ctx, edges, 3 * num_hull));
    close_hull(&t, n, sorted, num_hull, edges);
    BRIO_TRY(BRIO_RESIZE(ctx, sorted, 3 * num_hull));
    BRIO_TRY(sort_handles(ctx, &t, num_points, edges, 3 * num_hull, sorted));
    BRIO_TRY(match(ctx, &t, sorted, 3 * num_hull, &alone));
    BRIO_REQUIRE(ctx, alone == 0, BRIO_ERR_CHECK, "the hull is open at facet %u of tetrahedron %u",
                 (unsigned)brio_slot_of(sorted[0]), brio_tet_of(sorted[0]));
    *out = t;
    t.tet = NULL;
done:
    brio_release(ctx, t.tet);
    brio_release(ctx, handles);
    brio_release(ctx, sorted);
    brio_release(ctx, edges);
    return status;
}

/* --- the check --- */

static brio_judge judge_of(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, bool weighted) {
    brio_judge j = {.ctx = ctx, .t = *t, .num_points = num_points, .weighted = weighted, .canonical = true};
    brio_filter_for(&j.filter, t->record, num_points, weighted);
    return j;
}

static const uint32_t *vertices_of(const brio_judge *j, size_t tet) {
    return j->t.tet[tet].vertex;
}

/* --- structure --- */

/* Reports progress of a pass over all tetrahedra, every BETWEEN of them. The pass begins at the fraction `from` of the
 * check and takes the fraction `share`. */
static brio_status report(const brio_judge *j, size_t tet, double from, double share) {
    enum { BETWEEN = 1 << 16 };
    if (tet % BETWEEN) return BRIO_OK;
    return brio_progress(j->ctx, "check", from + share * (double)tet / (double)j->t.count);
}

static brio_status check_orientation(brio_judge *j) {
    const brio_record *r = j->t.record;
    for (size_t tet = 0; tet < j->t.count; tet++) {
        BRIO_FORWARD(report(j, tet, 0, 0.2));
        const uint32_t *v = vertices_of(j, tet);
        bool infinite = v[3] == BRIO_INFINITE;
        for (int i = 0; i < 4 - infinite; i++)
            BRIO_EXPECT(j->ctx, v[i] < j->num_points, BRIO_ERR_CHECK, "tetrahedron %zu: no point %u", tet,
                        BRIO_POINT(j->ctx, v[i]));
        BRIO_EXPECT(j->ctx, infinite || brio_orient3d_sign(&j->filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]]) > 0,
                    BRIO_ERR_CHECK, "tetrahedron %zu (%u %u %u %u) is not positive", tet, v[0], v[1], v[2], v[3]);
    }
    return BRIO_OK;
}

/* Returns the slot of vertex v among the slots of a facet: 0 to 2, or 3 when v is no vertex of the facet. */
static int place_in_facet(const uint32_t *vertex, const uint8_t *facet, uint32_t v) {
    for (int i = 0; i < 3; i++)
        if (vertex[facet[i]] == v) return i;
    return 3;
}

/* Runs tests 2 and 3 on one facet whose mate's handle is in range. */
static brio_status check_mate(brio_judge *j, uint32_t f, uint32_t g) {
    assert(f < 4 * j->t.count && g < 4 * j->t.count);
    size_t tet = brio_tet_of(f), other = brio_tet_of(g);
    const uint32_t *v = vertices_of(j, tet), *w = vertices_of(j, other);
    const uint8_t *p = BRIO_FACET[brio_slot_of(f)], *q = BRIO_FACET[brio_slot_of(g)];
    int at[3];
    for (int i = 0; i < 3; i++) at[i] = place_in_facet(w, q, v[p[i]]);
    BRIO_EXPECT(j->ctx, *brio_mate(&j->t, g) == f && at[0] < 3 && at[1] < 3 && at[2] < 3, BRIO_ERR_CHECK,
                "facet %d of tetrahedron %zu and its mate do not match", brio_slot_of(f), tet);
    BRIO_EXPECT(j->ctx, at[1] == (at[0] + 2) % 3 && at[2] == (at[0] + 1) % 3, BRIO_ERR_CHECK,
                "tetrahedra %zu and %zu overlap: they lie on one side of the facet that they share", tet, other);
    return BRIO_OK;
}

static brio_status check_mates(brio_judge *j) {
    for (size_t f = 0; f < 4 * j->t.count; f++) {
        if (f % 4 == 0) BRIO_FORWARD(report(j, f / 4, 0.2, 0.1));
        uint32_t g = *brio_mate(&j->t, (uint32_t)f);
        BRIO_EXPECT(j->ctx, g < 4 * j->t.count, BRIO_ERR_CHECK, "facet %zu of tetrahedron %zu has no mate", f % 4,
                    f / 4);
        BRIO_FORWARD(check_mate(j, (uint32_t)f, g));
    }
    return BRIO_OK;
}

/* --- geometry --- */

static brio_status check_hull_edge(brio_judge *j, size_t tet, uint32_t far) {
    const uint32_t *v = vertices_of(j, tet);
    const brio_record *r = j->t.record;
    BRIO_EXPECT(j->ctx, brio_orient3d_sign(&j->filter, r[v[0]], r[v[1]], r[v[2]], r[far]) <= 0, BRIO_ERR_CHECK,
                "the hull is not convex: point %u is outside of facet (%u %u %u)", BRIO_POINT(j->ctx, far), v[0], v[1],
                v[2]);
    return BRIO_OK;
}

brio_status brio_check_sphere(brio_judge *j, size_t tet, uint32_t p) {
    const uint32_t *v = vertices_of(j, tet);
    const double *a = j->t.record[v[0]], *b = j->t.record[v[1]], *c = j->t.record[v[2]], *d = j->t.record[v[3]],
                 *e = j->t.record[p];
    int sign = brio_insphere_sign(&j->filter, a, b, c, d, e, j->weighted);
    BRIO_EXPECT(j->ctx, sign <= 0, BRIO_ERR_CHECK, "point %u is inside the sphere of tetrahedron %zu (%u %u %u %u)",
                BRIO_POINT(j->ctx, p), tet, v[0], v[1], v[2], v[3]);
    if (sign == 0 && brio_insphere_tie(&j->filter, a, b, c, d, e) > 0) j->canonical = false;
    return BRIO_OK;
}

/* Runs tests 5 and 6 on each pair of mates once. Skips pairs of a finite and an infinite tetrahedron, which need no
 * test. */
static brio_status check_facets(brio_judge *j) {
    for (size_t f = 0; f < 4 * j->t.count; f++) {
        if (f % 4 == 0) BRIO_FORWARD(report(j, f / 4, 0.3, 0.5));
        uint32_t g = *brio_mate(&j->t, (uint32_t)f);
        if (g < f) continue;
        bool infinite = brio_is_infinite(&j->t, (uint32_t)(f / 4)), other = brio_is_infinite(&j->t, brio_tet_of(g));
        uint32_t far = vertices_of(j, brio_tet_of(g))[brio_slot_of(g)];
        if (infinite && other)
            BRIO_FORWARD(check_hull_edge(j, f / 4, far));
        else if (!infinite && !other)
            BRIO_FORWARD(brio_check_sphere(j, f / 4, far));
    }
    return BRIO_OK;
}

/* Returns the side of the plane (a, b, c) on which o lies. An orientation is affine in its last point. So the first of
 * the seed's vertices off the plane decides: o is infinitely closer to this vertex than to the later ones. */
static int side_of_seed(brio_judge *j, const uint32_t *seed, uint32_t a, uint32_t b, uint32_t c) {
    const brio_record *r = j->t.record;
    int side = 0;
    for (int i = 0; i < 4 && !side; i++) side = brio_orient3d_sign(&j->filter, r[a], r[b], r[c], r[seed[i]]);
    return side;
}

static bool holds_seed(brio_judge *j, const uint32_t *seed, const uint32_t *v) {
    for (int i = 0; i < 4; i++) {
        const uint8_t *f = BRIO_FACET[i];
        if (side_of_seed(j, seed, v[f[0]], v[f[1]], v[f[2]]) < 0) return false;
    }
    return true;
}

/* Runs test 4. */
static brio_status check_cover(brio_judge *j) {
    size_t first = 0;
    while (first < j->t.count && brio_is_infinite(&j->t, (uint32_t)first)) first++;
    BRIO_EXPECT(j->ctx, first < j->t.count, BRIO_ERR_CHECK, "no finite tetrahedron");
    const uint32_t *seed = vertices_of(j, first);
    for (size_t tet = 0; tet < j->t.count; tet++) {
        BRIO_FORWARD(report(j, tet, 0.8, 0.2));
        const uint32_t *v = vertices_of(j, tet);
        if (v[3] == BRIO_INFINITE)
            BRIO_EXPECT(j->ctx, side_of_seed(j, seed, v[0], v[1], v[2]) < 0, BRIO_ERR_CHECK,
                        "tetrahedron %zu is outside of hull facet (%u %u %u)", first, v[0], v[1], v[2]);
        else
            BRIO_EXPECT(j->ctx, tet == first || !holds_seed(j, seed, v), BRIO_ERR_CHECK,
                        "tetrahedra %zu and %zu overlap", first, tet);
    }
    return BRIO_OK;
}

/* Runs tests 1 to 6 of check.c on the tetrahedra. Returns BRIO_OK, BRIO_ERR_CHECK, BRIO_ERR_CANCELLED. */
static brio_status check_tetrahedra(brio_judge *j) {
    BRIO_FORWARD(check_orientation(j));
    BRIO_FORWARD(check_mates(j));
    BRIO_FORWARD(check_facets(j));
    return check_cover(j);
}

/* --- the two public checks --- */

brio_status brio_tetrahedra_check(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                  const uint32_t *tetrahedra, size_t stride, size_t num_tetrahedra, int *canonical) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_record *record = NULL;
    brio_tetrahedra t = {0};
    bool same = true;
    BRIO_REQUIRE(ctx, stride >= 4, BRIO_ERR_ARGUMENT, "a stride of %zu numbers for four vertices", stride);
    BRIO_TRY(brio_refuse_many(ctx, num_points));
    BRIO_TRY(brio_records_new(ctx, &(brio_input){points, weights, num_points}, NULL, 1, NULL, &record));
    if (num_tetrahedra == 0) {
        BRIO_REQUIRE(ctx, brio_dimension(record, num_points) < 3, BRIO_ERR_CHECK,
                     "no tetrahedra, but the points are not in a plane");
    } else {
        BRIO_TRY(
            adjacency_build(ctx, record, num_points, &(brio_tetrahedron_list){tetrahedra, stride, num_tetrahedra}, &t));
        brio_judge j = judge_of(ctx, &t, num_points, weights != NULL);
        BRIO_TRY(check_tetrahedra(&j));
        BRIO_TRY(brio_check_points(&j, NULL));
        same = j.canonical;
    }
    if (canonical) *canonical = same;
done:
    brio_release(ctx, record);
    brio_release(ctx, t.tet);
    return status;
}

/* Checks that the finite tetrahedra come first. */
static brio_status check_sequence(brio_context *ctx, const brio_triangulation *t) {
    for (size_t tet = 0; tet < t->stats.tetrahedra + t->stats.hull_facets; tet++)
        BRIO_EXPECT(ctx, (t->tet[tet].vertex[3] == BRIO_INFINITE) == (tet >= t->stats.tetrahedra), BRIO_ERR_CHECK,
                    "tetrahedron %zu of %zu finite and %zu infinite ones is out of place", tet, t->stats.tetrahedra,
                    t->stats.hull_facets);
    return BRIO_OK;
}

static brio_status check_solid(brio_context *ctx, const brio_triangulation *t, const brio_record *record,
                               bool weighted) {
    brio_tetrahedra view = {t->tet, t->stats.tetrahedra + t->stats.hull_facets, BRIO_INFINITE, record};
    brio_judge j = judge_of(ctx, &view, t->stats.points, weighted);
    BRIO_FORWARD(check_sequence(ctx, t));
    BRIO_FORWARD(check_tetrahedra(&j));
    BRIO_FORWARD(brio_check_points(&j, t));
    BRIO_EXPECT(ctx, j.canonical, BRIO_ERR_CHECK, "ties are not broken by the symbolic perturbation");
    return BRIO_OK;
}

brio_status brio_triangulation_check(brio_context *ctx, const brio_triangulation *t, const double *points,
                                     const double *weights, size_t num_points) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_record *record = NULL;
    BRIO_REQUIRE(ctx, num_points == t->stats.points, BRIO_ERR_ARGUMENT, "%zu points for a triangulation of %zu",
                 num_points, t->stats.points);
    BRIO_TRY(brio_records_new(ctx, &(brio_input){points, weights, num_points}, NULL, 1, NULL, &record));
    BRIO_REQUIRE(ctx, brio_dimension(record, num_points) == t->stats.dimension, BRIO_ERR_CHECK,
                 "the points' dimension is not %d", t->stats.dimension);
    if (t->stats.dimension < 3)
        BRIO_TRY(brio_check_flat(ctx, t, points, weights));
    else
        BRIO_TRY(check_solid(ctx, t, record, weights != NULL));
done:
    brio_release(ctx, record);
    return status;
}
