/* Offsets of small solids are manifolds whose vertices have positions of their own, in single precision, too: written
 * as STL, which has positions only, and read again, they are as they were. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "io_files.h"
#include "mesh/solid.h"
#include "offset/work.h"
#include "points.h"
#include "surfaces.h"
#include <math.h>
#include <string.h>

#define PI 3.141592653589793

enum { SIDES = 7, BOXES = 5, SEEDS = SHORT_TESTS ? 1 : 12, AROUND = 16, ACROSS = 8, MOST = 512 };

/* --- solids --- */

typedef struct {
    double vertex[MOST][3];
    uint32_t corner[MOST];
    uint64_t offset[MOST];
    size_t vertices, faces;
} solid;

static void add_face(solid *s, const uint32_t *corner, uint64_t count) {
    memcpy(s->corner + s->offset[s->faces], corner, count * sizeof *corner);
    s->offset[s->faces + 1] = s->offset[s->faces] + count;
    s->faces++;
}

/* Adds a prism: a polygon of n corners, counterclockwise, between two heights. */
static void add_prism(solid *s, const double (*corner)[2], uint32_t n, double low, double high) {
    uint32_t first = (uint32_t)s->vertices, lid[2][MOST];
    for (uint32_t i = 0; i < 2 * n; i++) {
        double *p = s->vertex[s->vertices++];
        p[0] = corner[i % n][0], p[1] = corner[i % n][1], p[2] = i < n ? low : high;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = (i + 1) % n, side[4] = {first + i, first + j, first + n + j, first + n + i};
        add_face(s, side, 4);
        lid[0][i] = first + n - 1 - i;
        lid[1][i] = first + n + i;
    }
    for (int i = 0; i < 2; i++) add_face(s, lid[i], n);
}

static void add_box(solid *s, double x, double y, double z, double a, double b, double c) {
    const double corner[4][2] = {{x, y}, {x + a, y}, {x + a, y + b}, {x, y + b}};
    add_prism(s, corner, 4, z, z + c);
}

static void make_l(solid *s) {
    static const double corner[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    add_prism(s, corner, 6, 0, 1);
}

static void make_gear(solid *s) {
    double corner[4 * SIDES][2];
    for (int i = 0; i < 4 * SIDES; i++) {
        double r = i % 4 < 2 ? 1 : 0.7, turn = 2 * PI * i / (4 * SIDES);
        corner[i][0] = r * cos(turn), corner[i][1] = r * sin(turn);
    }
    add_prism(s, (const double(*)[2])corner, 4 * SIDES, 0, 0.5);
}

static void make_torus(solid *s) {
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < ACROSS; j++) {
            double a = 2 * PI * i / AROUND, b = 2 * PI * j / ACROSS, *p = s->vertex[s->vertices++];
            uint32_t ii = (i + 1) % AROUND, jj = (j + 1) % ACROSS;
            p[0] = (1 + 0.4 * cos(b)) * cos(a), p[1] = (1 + 0.4 * cos(b)) * sin(a), p[2] = 0.4 * sin(b);
            add_face(s, (const uint32_t[4]){i * ACROSS + j, ii * ACROSS + j, ii * ACROSS + jj, i * ACROSS + jj}, 4);
        }
}

static brio_mesh *mesh_of(brio_context *ctx, const solid *s) {
    brio_mesh *mesh = NULL;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_set_vertices(mesh, s->vertex[0], s->vertices) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, s->offset, s->corner, s->faces) == BRIO_OK);
    return mesh;
}

/* --- judging --- */

/* The largest distance of places of the faces from the exact offset. */
static double largest_error(brio_context *ctx, const brio_mesh *mesh, const brio_mesh *out, double distance) {
    enum { CORNERS = 3 };
    brio_solid of = {{0}};
    double most = 0;
    EXPECT(brio_solid_new(ctx, mesh, &of) == BRIO_OK);
    for (size_t f = 0; f < out->num_faces; f++)
        for (int i = 0; i < BRIO_OFFSET_PLACES; i++) {
            double p[3] = {0, 0, 0}, nearest[3];
            size_t triangle;
            for (int c = 0; c < CORNERS; c++)
                for (int k = 0; k < 3; k++)
                    p[k] +=
                        brio_offset_places[i][c] * out->vertices[3 * out->face_vertices[3 * f + (size_t)c] + (size_t)k];
            double d = sqrt(brio_closest_point(&of.tree, p, nearest, &triangle));
            if (brio_winding_number(&of, p) != 0) d = -d;
            most = fmax(most, fabs(d - distance));
        }
    brio_solid_free(ctx, &of);
    return most;
}

/* Expects that a mesh that was written as STL and read again is closed, manifold, oriented, and has as many vertices.
 * Returns its volume. */
static double expect_same_as_stl(brio_context *ctx, const brio_mesh *mesh, const char *what) {
    brio_mesh *again = NULL;
    brio_certificate c = {0};
    EXPECT(brio_write(ctx, io_path("offset.stl"), mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_read(ctx, io_path("offset.stl"), NULL, &again) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, again, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented, "%s", what);
    EXPECT(again->num_vertices == mesh->num_vertices && again->num_faces == mesh->num_faces, "%s: %zu vertices of %zu",
           what, again->num_vertices, mesh->num_vertices);
    double volume = c.volume;
    brio_certificate_free(&c);
    brio_mesh_free(again);
    return volume;
}

/* Offsets a solid by ascending distances, within a share of them. */
static void expect_manifolds(const solid *s, const double *distance, int count, double share, const char *name) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = mesh_of(ctx, s);
    double last = 0;
    for (int i = 0; i < count; i++) {
        brio_mesh *out = NULL;
        brio_mesh_offset_options o = {.error = share * fabs(distance[i])};
        brio_mesh_offset_stats stats = {0};
        int64_t pairs = -1;
        char what[64];
        snprintf(what, sizeof what, "%s by %g within %g", name, distance[i], o.error);
        EXPECT(brio_mesh_offset(ctx, mesh, distance[i], &o, &out, &stats) == BRIO_OK, "%s: %s", what,
               brio_message(ctx));
        if (!out) continue;
        double volume = expect_same_as_stl(ctx, out, what), most = largest_error(ctx, mesh, out, distance[i]);
        EXPECT(brio_mesh_self_intersections(ctx, out, &pairs) == BRIO_OK && pairs == 0, "%s: %lld pairs cross", what,
               (long long)pairs);
        EXPECT(stats.error <= o.error * (1 + 1e-9), "%s: proven %g", what, stats.error);
        EXPECT(most <= stats.error * (1 + 1e-9), "%s: %g away, proven %g", what, most, stats.error);
        EXPECT(volume > last, "%s: volume %g, before %g", what, volume, last);
        last = volume;
        brio_mesh_free(out);
    }
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* --- tests --- */

static const double distances[] = {-0.25, -0.1, 0.1, 0.25, 0.7071067811865476, 1};
enum { DISTANCES = 6, OUTWARDS = 2 /* the first distance above 0 */ };

static void boxes_that_touch_in_an_edge(void) {
    solid s = {.faces = 0};
    add_box(&s, 0, 0, 0, 1, 1, 1);
    add_box(&s, 1, 1, 0, 1, 1, 1);
    expect_manifolds(&s, distances, DISTANCES, 0.1, "boxes with an edge");
}

/* By half the distance of the edges, the offsets of both boxes touch in a line. */
static void boxes_whose_offsets_touch_in_a_line(void) {
    solid s = {.faces = 0};
    add_box(&s, 0, 0, 0, 1, 1, 1);
    add_box(&s, 2, 2, 0, 1, 1, 1);
    expect_manifolds(&s, distances, DISTANCES, 0.1, "boxes across");
}

static void boxes_that_touch_in_a_corner(void) {
    solid s = {.faces = 0};
    add_box(&s, 0, 0, 0, 1, 1, 1);
    add_box(&s, 1, 1, 1, 1, 1, 1);
    expect_manifolds(&s, distances + OUTWARDS, DISTANCES - OUTWARDS, 0.03, "boxes with a corner");
}

static void l_shape(void) {
    solid s = {.faces = 0};
    make_l(&s);
    expect_manifolds(&s, distances, DISTANCES, 0.1, "L");
}

static void gear(void) {
    solid s = {.faces = 0};
    make_gear(&s);
    expect_manifolds(&s, distances + 1, DISTANCES - 1, 0.1, "gear");
}

static void coarse_torus(void) {
    solid s = {.faces = 0};
    make_torus(&s);
    expect_manifolds(&s, distances, DISTANCES, 0.1, "torus");
}

static void unions_of_boxes(void) {
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        solid s = {.faces = 0};
        brio_rng rng = brio_rng_new(seed);
        for (int i = 0; i < BOXES; i++) {
            double x[6];
            for (int k = 0; k < 6; k++) x[k] = floor((k < 3 ? 3 : 2) * brio_rng_double(&rng)) + (k < 3 ? 0 : 1);
            add_box(&s, x[0], x[1], x[2], x[3], x[4], x[5]);
        }
        expect_manifolds(&s, distances, DISTANCES, 0.1, "boxes");
    }
}

static brio_status offset_of_touching_boxes(brio_context *ctx) {
    brio_mesh *out = NULL;
    brio_mesh_offset_options o = {.error = 0.2};
    solid s = {.faces = 0};
    add_box(&s, 0, 0, 0, 1, 1, 1);
    add_box(&s, 2, 2, 0, 1, 1, 1);
    brio_mesh mesh = {.size = sizeof mesh,
                      .context = ctx,
                      .num_vertices = s.vertices,
                      .vertices = s.vertex[0],
                      .num_faces = s.faces,
                      .face_offsets = s.offset,
                      .face_vertices = s.corner};
    brio_status status = brio_mesh_offset(ctx, &mesh, 0.7071067811865476, &o, &out, NULL);
    brio_mesh_free(out);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(offset_of_touching_boxes);
}

/* Triangles without a common corner may find samples at one place of a crease, apart by rounding. */
static void samples_of_a_round_are_apart(void) {
    brio_context *ctx = new_context();
    brio_offset_work w = {.ctx = ctx, .error = 1};
    brio_point_tree tree;
    const double old[3] = {5, 0, 0};
    const double found[4][3] = {{0, 0, 0}, {1e-9, 0, 0}, {0, 3, 0}, {5, 1e-9, 0}};
    size_t added = 0;
    EXPECT(brio_offset_add(&w, old) == BRIO_OK);
    EXPECT(brio_point_tree_new(ctx, w.points, w.num_points, &tree) == BRIO_OK);
    EXPECT(brio_offset_add_apart(&w, &tree, found, 4, &added) == BRIO_OK);
    EXPECT(added == 2 && w.num_points == 3, "%zu", added);
    brio_point_tree_free(ctx, &tree);
    brio_release(ctx, w.points);
    brio_context_free(ctx);
}

SUITE(test_offset_manifold) {
    io_begin();
    RUN(boxes_that_touch_in_an_edge);
    RUN(boxes_whose_offsets_touch_in_a_line);
    RUN(boxes_that_touch_in_a_corner);
    RUN(l_shape);
    RUN(gear);
    RUN(coarse_torus);
    RUN(unions_of_boxes);
    RUN(samples_of_a_round_are_apart);
    RUN(every_failed_allocation_is_a_status);
    return io_end();
}
