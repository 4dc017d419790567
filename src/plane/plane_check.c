/* The exact check of a triangulation of the plane.
 *
 * The tests are those of triangulation/check.c one dimension lower, where the theorem and its proof stand. The seed o
 * is a point of the first triangle, infinitesimally close to its first vertex, on no line of an edge.
 *   1  Every finite triangle is counterclockwise, and the infinite vertex is only ever in slot 2.
 *   2  Mates are mutual and have the same two vertices.
 *   3  Mates see their vertices in opposite orders.
 *   4  o is strictly on the inner side of every hull edge, and in no finite triangle except the first.
 *   5  At every hull vertex, the end of one hull edge is not strictly outside of the other hull edge.
 *   6  Across every edge, the vertex of one triangle is not inside the (ortho)circle of the other triangle.
 *   7  Every input point that is no vertex lies in a triangle (closed). It is at a vertex that is not lighter, or it is
 *      not inside the (ortho)circle of that triangle.
 * Part A of the proof holds as it stands: a ray from o that meets no vertex meets exactly one hull edge. So the hull
 * edges form one cycle around o, and by 5 none of its corners is reflex. That is part B.
 *
 * Points on a line have no triangles to look at; their check is in plane_check_line.c.
 *
 * Based on: Mehlhorn, Naeher, Seel, Seidel, Schilz, Schirra, Uhrig. Checking geometric programs or verification of
 *           geometric structures. CGTA 1999. */
#include "plane/plane_check.h"
#include "base/float_state.h"
#include "base/memory.h"

static bool is_infinite(const brio_plane_judge *j, size_t t) {
    return j->view.triangle[t].vertex[2] == BRIO_INFINITE;
}

static int orientation(brio_plane_judge *j, uint32_t a, uint32_t b, uint32_t c) {
    const brio_plane_record *r = j->view.record;
    return brio_orient2d_sign(&j->filter, r[a], r[b], r[c]);
}

static brio_status check_orientation(brio_plane_judge *j) {
    for (size_t t = 0; t < j->count; t++) {
        const uint32_t *v = j->view.triangle[t].vertex;
        bool infinite = t >= j->t->stats.triangles;
        BRIO_EXPECT(j->ctx, is_infinite(j, t) == infinite, BRIO_ERR_CHECK,
                    "triangle %zu of %zu finite and %zu infinite ones is out of place", t, j->t->stats.triangles,
                    j->t->stats.hull_edges);
        for (int i = 0; i < 3 - infinite; i++)
            BRIO_EXPECT(j->ctx, v[i] < j->num_points, BRIO_ERR_CHECK, "triangle %zu: no point %u", t,
                        BRIO_POINT(j->ctx, v[i]));
        BRIO_EXPECT(j->ctx, infinite || orientation(j, v[0], v[1], v[2]) > 0, BRIO_ERR_CHECK,
                    "triangle %zu (%u %u %u) is not counterclockwise", t, v[0], v[1], v[2]);
    }
    return BRIO_OK;
}

/* Runs tests 2 and 3. */
static brio_status check_mates(brio_plane_judge *j) {
    for (uint32_t t = 0; t < j->count; t++)
        for (uint32_t i = 0; i < 3; i++) {
            const brio_triangle *own = &j->view.triangle[t];
            uint32_t g = own->mate[i], u = brio_triangle_of(g), k = g & 3; /* may be no edge handle */
            BRIO_EXPECT(j->ctx, u < j->count && k < 3, BRIO_ERR_CHECK, "edge %u of triangle %u has no mate", i, t);
            const brio_triangle *other = &j->view.triangle[u];
            BRIO_EXPECT(j->ctx,
                        other->mate[k] == brio_edge_of(t, i) &&
                            own->vertex[brio_slot_after(i)] == other->vertex[brio_slot_before(k)] &&
                            own->vertex[brio_slot_before(i)] == other->vertex[brio_slot_after(k)],
                        BRIO_ERR_CHECK, "edge %u of triangle %u and its mate do not match", i, t);
        }
    return BRIO_OK;
}

/* Runs test 5 at the second vertex of the hull edge of infinite triangle t. By tests 1 and 2 the mate across the edge
 * opposite to vertex 0 has the next hull edge. */
static brio_status check_corner(brio_plane_judge *j, uint32_t t) {
    const brio_triangle *own = &j->view.triangle[t];
    const brio_triangle *next = &j->view.triangle[brio_triangle_of(own->mate[0])];
    BRIO_EXPECT(j->ctx, orientation(j, own->vertex[0], own->vertex[1], next->vertex[1]) <= 0, BRIO_ERR_CHECK,
                "the hull is not convex at vertex %u", own->vertex[1]);
    return BRIO_OK;
}

brio_status brio_plane_check_circle(brio_plane_judge *j, uint32_t t, uint32_t p) {
    const uint32_t *v = j->view.triangle[t].vertex;
    const double *a = j->view.record[v[0]], *b = j->view.record[v[1]], *c = j->view.record[v[2]];
    const double *x = j->view.record[p];
    int sign = brio_incircle_sign(&j->filter, a, b, c, x, j->filter.general);
    BRIO_EXPECT(j->ctx, sign <= 0, BRIO_ERR_CHECK, "point %u is inside the circle of triangle %u (%u %u %u)",
                BRIO_POINT(j->ctx, p), t, v[0], v[1], v[2]);
    BRIO_EXPECT(j->ctx, sign < 0 || brio_incircle_tie(&j->filter, a, b, c, x) < 0, BRIO_ERR_CHECK,
                "point %u is on the circle of triangle %u (%u %u %u), and the tie is not broken by the perturbation",
                BRIO_POINT(j->ctx, p), t, v[0], v[1], v[2]);
    return BRIO_OK;
}

/* Runs tests 5 and 6. */
static brio_status check_edges(brio_plane_judge *j) {
    for (uint32_t t = 0; t < j->count; t++) {
        if (is_infinite(j, t)) {
            BRIO_FORWARD(check_corner(j, t));
            continue;
        }
        for (int i = 0; i < 3; i++) {
            uint32_t g = j->view.triangle[t].mate[i], u = brio_triangle_of(g);
            if (u < t || is_infinite(j, u)) continue; /* one side suffices: the test is symmetric, ties included */
            BRIO_FORWARD(brio_plane_check_circle(j, t, j->view.triangle[u].vertex[brio_edge_slot(g)]));
        }
    }
    return BRIO_OK;
}

/* Returns the side of the line ab on which o lies. The first of the seed's vertices off the line decides: o is
 * infinitely closer to this vertex than to the later ones. */
static int side_of_seed(brio_plane_judge *j, uint32_t a, uint32_t b) {
    const uint32_t *seed = j->view.triangle[0].vertex;
    int side = 0;
    for (int i = 0; i < 3 && !side; i++) side = orientation(j, a, b, seed[i]);
    return side;
}

/* Runs test 4. */
static brio_status check_cover(brio_plane_judge *j) {
    BRIO_EXPECT(j->ctx, j->t->stats.triangles > 0, BRIO_ERR_CHECK, "no finite triangle");
    for (size_t t = 1; t < j->count; t++) {
        const uint32_t *v = j->view.triangle[t].vertex;
        if (is_infinite(j, t))
            BRIO_EXPECT(j->ctx, side_of_seed(j, v[0], v[1]) < 0, BRIO_ERR_CHECK,
                        "triangle 0 is outside of hull edge (%u %u)", v[0], v[1]);
        else
            BRIO_EXPECT(j->ctx,
                        side_of_seed(j, v[0], v[1]) < 0 || side_of_seed(j, v[1], v[2]) < 0 ||
                            side_of_seed(j, v[2], v[0]) < 0,
                        BRIO_ERR_CHECK, "triangles 0 and %zu overlap", t);
    }
    return BRIO_OK;
}

static brio_status check_triangles(brio_plane_judge *j) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_progress(j->ctx, "check", 0));
    BRIO_TRY(check_orientation(j));
    BRIO_TRY(check_mates(j));
    BRIO_TRY(brio_progress(j->ctx, "check", 0.3));
    BRIO_TRY(check_edges(j));
    BRIO_TRY(brio_progress(j->ctx, "check", 0.7));
    BRIO_TRY(check_cover(j));
    BRIO_TRY(brio_progress(j->ctx, "check", 0.9));
    BRIO_TRY(brio_plane_check_points(j));
    status = brio_progress(j->ctx, "check", 1);
done:
    return status;
}

/* Returns the dimension of the affine hull of records, exact: 0 to 2, or -1 for no records. */
static int dimension_of(brio_plane_filter *f, const brio_plane_record *r, size_t n) {
    size_t second = 0;
    for (size_t p = 1; p < n; p++) {
        if (!second && !brio_same_place(r[0], r[p])) second = p;
        if (second && brio_orient2d_sign(f, r[0], r[second], r[p])) return 2;
    }
    return n == 0 ? -1 : second > 0;
}

brio_status brio_triangulation2_check(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                      const double *weights, size_t num_points) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_plane_record *record = NULL;
    brio_plane_input input = {.own = NULL};
    BRIO_REQUIRE(ctx, num_points == t->stats.points, BRIO_ERR_ARGUMENT, "%zu points for a triangulation of %zu",
                 num_points, t->stats.points);
    BRIO_TRY(brio_plane_input_set(ctx, points, weights, num_points, t->stats.coordinates, &input));
    BRIO_TRY(brio_plane_records_new(ctx, &input, NULL, 1, &record));
    brio_plane_judge j = {.ctx = ctx, .t = t, .num_points = num_points, .weighted = weights != NULL};
    j.view = (brio_plane_view){t->triangle, (const brio_plane_record *)record, BRIO_INFINITE};
    j.count = t->stats.triangles + t->stats.hull_edges;
    brio_plane_filter_for(&j.filter, j.view.record, num_points, brio_plane_general(&input));
    brio_plane_input_key(&input, &j.filter);
    BRIO_REQUIRE(ctx, dimension_of(&j.filter, j.view.record, num_points) == t->stats.dimension, BRIO_ERR_CHECK,
                 "the points' dimension is not %d", t->stats.dimension);
    BRIO_TRY(t->stats.dimension < 2 ? brio_plane_check_line(&j, record) : check_triangles(&j));
done:
    brio_plane_input_free(ctx, &input);
    brio_release(ctx, record);
    return status;
}
