/* The inside of a closed mesh, by the winding number of a point. The vertical ray upwards from the point crosses
 * triangles; a crossing from below counts 1, a crossing from above -1. Every sign is exact. A ray through an edge or a
 * corner is decided as if the point were moved by (e, e^2, 0), with e > 0 infinitesimal. So the ray hits exactly one
 * of two triangles that continue each other across such an edge.
 *
 * The count has a meaning when the faces bound a solid: each edge has equally many half-edges in both directions.
 * Pinched edges and vertices, several components and overlapping pieces are allowed.
 *
 * Based on: Edelsbrunner, Muecke. Simulation of simplicity. ACM TOG 1990 (ties). */
#include "mesh/solid.h"
#include "base/finite.h"
#include "base/sort.h"
#include "mesh/edge_rings.h"
#include <math.h>
#include <string.h>

/* --- whether the faces bound a solid --- */

static int compare_positions(uint32_t a, uint32_t b, const void *user) {
    const double *p = (const double *)user + 3 * (size_t)a, *q = (const double *)user + 3 * (size_t)b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Sets number[v] to one value for all vertices at the position of v. */
static brio_status number_positions(brio_context *ctx, const brio_mesh *mesh, uint32_t *number) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    size_t n = mesh->num_vertices;
    BRIO_TRY(BRIO_ALLOC(ctx, order, n));
    for (size_t v = 0; v < n; v++) order[v] = (uint32_t)v;
    BRIO_TRY(brio_sort_rows(ctx, &(brio_row_order){mesh->vertices, 3, compare_positions, mesh->vertices}, order, n));
    for (size_t i = 0; i < n; i++) {
        bool same = i > 0 && compare_positions(order[i - 1], order[i], mesh->vertices) == 0;
        number[order[i]] = same ? number[order[i - 1]] : order[i];
    }
done:
    brio_release(ctx, order);
    return status;
}

/* Lists the half-edges as pairs of positions, the lower one first; upwards is 1 where the half-edge starts at the
 * lower one. */
static size_t list_half_edges(const brio_mesh *mesh, const uint32_t *number, uint64_t *keys, uint32_t *upwards) {
    size_t count = 0;
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (uint64_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++) {
            uint64_t next = h + 1 < mesh->face_offsets[f + 1] ? h + 1 : mesh->face_offsets[f];
            uint64_t a = number[mesh->face_vertices[h]], b = number[mesh->face_vertices[next]];
            if (a == b) continue;
            keys[count] = a < b ? a << 32 | b : b << 32 | a;
            upwards[count++] = a < b;
        }
    return count;
}

static brio_status check_boundary(brio_context *ctx, const brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL, *upwards = NULL;
    uint64_t *keys = NULL;
    size_t corners = (size_t)mesh->face_offsets[mesh->num_faces], open = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, number, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, upwards, corners));
    BRIO_TRY(BRIO_ALLOC(ctx, keys, corners));
    BRIO_TRY(number_positions(ctx, mesh, number));
    size_t count = list_half_edges(mesh, number, keys, upwards);
    BRIO_TRY(brio_radix_sort(ctx, keys, upwards, count, 64));
    for (size_t begin = 0, end; begin < count; begin = end) {
        int64_t sum = 0;
        for (end = begin; end < count && keys[end] == keys[begin]; end++) sum += upwards[end] ? 1 : -1;
        open += sum != 0;
    }
    BRIO_REQUIRE(ctx, open == 0, BRIO_BECAUSE(ctx, OPEN_MESH, BRIO_ERR_NO_ANSWER),
                 "the mesh has no inside: along %zu edges its faces do not close or disagree about their sides", open);
done:
    brio_release(ctx, number);
    brio_release(ctx, upwards);
    brio_release(ctx, keys);
    return status;
}

brio_status brio_solid_new(brio_context *ctx, const brio_mesh *mesh, brio_solid *out) {
    *out = (brio_solid){{0}};
    BRIO_FORWARD(brio_mesh_check_faces(ctx, mesh));
    BRIO_FORWARD(brio_refuse_vertices(ctx, mesh->vertices, mesh->num_vertices, "the solid"));
    BRIO_EXPECT(ctx, mesh->num_faces > 0, BRIO_BECAUSE(ctx, OPEN_MESH, BRIO_ERR_NO_ANSWER),
                "the mesh has no inside: it has no faces");
    BRIO_FORWARD(check_boundary(ctx, mesh));
    return brio_triangle_tree_new(ctx, mesh, &out->tree);
}

void brio_solid_free(brio_context *ctx, brio_solid *solid) {
    brio_triangle_tree_free(ctx, &solid->tree);
}

/* --- the ray --- */

static int sign_of(double x) {
    return (x > 0) - (x < 0);
}

/* Returns on which side of the directed line a to b the moved point q lies, seen from above: 1 left, -1 right. Returns
 * 0 only where a and b are one above the other. */
static int side_of_edge(const double *a, const double *b, const double *q) {
    double left = (b[0] - a[0]) * (q[1] - a[1]), right = (b[1] - a[1]) * (q[0] - a[0]), sum = fabs(left) + fabs(right);
    if (fabs(left - right) > 0x1p-50 * sum && sum > 0x1p-900) return sign_of(left - right);
    const double a0[3] = {a[0], a[1], 0}, b0[3] = {b[0], b[1], 0}, q0[3] = {q[0], q[1], 0}, up[3] = {q[0], q[1], 1};
    int sign = brio_orient3d(a0, b0, q0, up);
    if (sign) return sign;
    return a[1] != b[1] ? sign_of(a[1] - b[1]) : sign_of(b[0] - a[0]);
}

/* Returns 1 when the ray from q crosses the triangle from below, -1 when from above, else 0. */
static int crossing(const double *a, const double *b, const double *c, const double *q) {
    int side = side_of_edge(a, b, q);
    if (side == 0 || side_of_edge(b, c, q) != side || side_of_edge(c, a, q) != side) return 0;
    return brio_orient3d(a, b, c, q) * side < 0 ? side : 0;
}

static int crossings_in_leaf(const brio_triangle_tree *t, size_t low, size_t high, const double *q) {
    int sum = 0;
    for (size_t i = low; i < high; i++) {
        const double *a = t->vertices + 3 * (size_t)t->triangles[i][0];
        const double *b = t->vertices + 3 * (size_t)t->triangles[i][1];
        const double *c = t->vertices + 3 * (size_t)t->triangles[i][2];
        sum += crossing(a, b, c, q);
    }
    return sum;
}

static bool ray_meets(const brio_box *box, const double *q) {
    return q[0] >= box->low[0] && q[0] <= box->high[0] && q[1] >= box->low[1] && q[1] <= box->high[1] &&
           q[2] <= box->high[2];
}

int brio_winding_number(const brio_solid *solid, const double *q) {
    enum { MOST_LEVELS = 64 };
    const brio_triangle_tree *t = &solid->tree;
    struct {
        size_t node, low, high;
    } stack[MOST_LEVELS], r;
    int depth = 0, sum = 0;
    stack[depth].node = stack[depth].low = 0;
    stack[depth++].high = t->num_triangles;
    while (depth > 0) {
        r = stack[--depth];
        if (!ray_meets(&t->boxes[r.node], q)) continue;
        if (r.high - r.low <= BRIO_LEAF_TRIANGLES) {
            sum += crossings_in_leaf(t, r.low, r.high, q);
            continue;
        }
        size_t middle = r.low + (r.high - r.low) / 2;
        stack[depth].node = 2 * r.node + 1, stack[depth].low = r.low, stack[depth++].high = middle;
        stack[depth].node = 2 * r.node + 2, stack[depth].low = middle, stack[depth++].high = r.high;
    }
    return sum;
}
