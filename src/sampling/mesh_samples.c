/* Samples of the faces of a mesh: its vertices, and points between them where these are farther apart than the spacing.
 *
 * Each triangle gets rows of points parallel to its longest side, the rows and the points of a row at most SHARE of the
 * spacing apart. A place of the triangle is less than 1.12 SHARE spacings from one of them: half a step along the row
 * below it, and a step up. Of all these points those that are half a spacing from each vertex are thinned to half a
 * spacing. So each place is within (1.12 SHARE + 0.5) spacings of a sample.
 *
 * Based on: Cook. Stochastic sampling in computer graphics. ACM Transactions on Graphics 1986 (brio_thin). */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/scale.h"
#include "base/vector.h"
#include "mesh/closest_point.h"
#include "mesh/edge_rings.h"
#include "query/nearest_points.h"
#include <math.h>
#include <string.h>

static const double SHARE = 0.44, APART = 0.5;
enum { TRIANGLES_A_REPORT = 1 << 12 };

typedef struct {
    brio_context *ctx;
    double spacing;
    brio_point_tree vertices;
    double *points;
    size_t count, capacity;
} sampler;

static brio_status add_point(sampler *s, const double *p) {
    double near = APART * s->spacing;
    if (brio_nearest_square(&s->vertices, p, near * near) < near * near) return BRIO_OK;
    BRIO_EXPECT(s->ctx, s->count < UINT32_MAX / 2, BRIO_ERR_TOO_LARGE, "samples of %g are more than 2^31 on this mesh",
                s->spacing);
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, s->points, s->capacity, 3 * s->count + 3));
    memcpy(s->points + 3 * s->count++, p, 3 * sizeof *p);
    return BRIO_OK;
}

/* Returns into how many parts a length is cut. */
static brio_status parts_of(sampler *s, double length, uint32_t *parts) {
    double n = fmax(ceil(length / (SHARE * s->spacing)), 1);
    BRIO_EXPECT(s->ctx, n < UINT32_MAX / 2, BRIO_ERR_TOO_LARGE, "a side of %g spacings", length / s->spacing);
    *parts = (uint32_t)n;
    return BRIO_OK;
}

/* Adds rows of points parallel to side ab, which is the longest. */
static brio_status add_rows(sampler *s, const double *a, const double *b, const double *c) {
    double u[3], v[3], n[3];
    uint32_t rows, columns;
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    double length = brio_length(u);
    if (!(length > 0)) return BRIO_OK;
    brio_cross(u, v, n);
    BRIO_FORWARD(parts_of(s, brio_length(n) / length, &rows));
    for (uint32_t row = 0; row <= rows; row++) {
        double up = (double)row / rows;
        BRIO_FORWARD(parts_of(s, (1 - up) * length, &columns));
        for (uint32_t column = 0; column <= columns; column++) {
            double p[3], along = (1 - up) * column / columns;
            for (int k = 0; k < 3; k++) p[k] = a[k] + along * u[k] + up * v[k];
            BRIO_FORWARD(add_point(s, p));
        }
    }
    return BRIO_OK;
}

static brio_status add_triangle(sampler *s, const double *const p[3]) {
    int longest = 0;
    double most = -1;
    for (int i = 0; i < 3; i++) {
        double square = brio_square_distance(p[i], p[(i + 1) % 3]);
        if (square > most) most = square, longest = i;
    }
    return add_rows(s, p[longest], p[(longest + 1) % 3], p[(longest + 2) % 3]);
}

/* Writes the vertices and the chosen ones of the points. */
static brio_status give(sampler *s, const double *vertices, size_t num_vertices, int exponent, double **out,
                        size_t *num_out) {
    brio_status status = BRIO_OK;
    uint8_t *chosen = NULL;
    size_t kept = 0, n = num_vertices;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC(s->ctx, chosen, s->count));
    BRIO_TRY(brio_thin(s->ctx, s->points, s->count, APART * s->spacing, chosen, &kept));
    BRIO_TRY(BRIO_ALLOC(s->ctx, *out, 3 * (num_vertices + kept)));
    for (size_t i = 0; i < s->count; i++)
        if (chosen[i]) memcpy(*out + 3 * n++, s->points + 3 * i, 3 * sizeof **out);
    BRIO_TRY(brio_scale_vertices(s->ctx, *out + 3 * num_vertices, kept, exponent));
    memcpy(*out, vertices, 3 * num_vertices * sizeof **out);
    *num_out = n;
done:
    brio_release(s->ctx, chosen);
    return status;
}

brio_status brio_mesh_samples(brio_context *ctx, const brio_mesh *mesh, double spacing, brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    sampler s = {.ctx = ctx};
    brio_triangle_tree tree = {0};
    brio_mesh scaled = *mesh;
    double *vertices = NULL, *samples = NULL;
    size_t count = 0;
    *out = NULL;
    BRIO_REQUIRE(ctx, spacing > 0 && isfinite(spacing), BRIO_ERR_ARGUMENT,
                 "a spacing of %g, expected a finite number above 0", spacing);
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(brio_refuse_vertices(ctx, mesh->vertices, mesh->num_vertices, "the mesh"));
    int exponent = brio_exponent(brio_greatest(mesh->vertices, 3 * mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, vertices, 3 * mesh->num_vertices));
    BRIO_TRY(brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, vertices));
    scaled.vertices = vertices;
    s.spacing = fmin(ldexp(spacing, -exponent), 16); /* as wide as the mesh is as good */
    BRIO_REQUIRE(ctx, s.spacing > 0x1p-40, BRIO_ERR_TOO_LARGE, "a spacing of %g is too small for this mesh", spacing);
    BRIO_TRY(brio_point_tree_new(ctx, vertices, mesh->num_vertices, &s.vertices));
    BRIO_TRY(brio_triangle_tree_new(ctx, &scaled, &tree));
    for (size_t t = 0; t < tree.num_triangles; t++) {
        const double *p[3];
        if (t % TRIANGLES_A_REPORT == 0) BRIO_TRY(brio_progress(ctx, "sample", (double)t / (double)tree.num_triangles));
        for (int c = 0; c < 3; c++) p[c] = vertices + 3 * (size_t)tree.triangles[t][c];
        BRIO_TRY(add_triangle(&s, p));
    }
    BRIO_TRY(give(&s, mesh->vertices, mesh->num_vertices, exponent, &samples, &count));
    BRIO_TRY(brio_mesh_new(ctx, out));
    BRIO_TRY(brio_mesh_set_vertices(*out, samples, count));
done:
    brio_point_tree_free(ctx, &s.vertices);
    brio_triangle_tree_free(ctx, &tree);
    brio_release(ctx, s.points);
    brio_release(ctx, vertices);
    brio_release(ctx, samples);
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
    }
    return status;
}
