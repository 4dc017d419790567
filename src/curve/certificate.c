/* The certificate of polylines: what the edges of a mesh alone prove about the curves that they form.
 *
 * A union-find joins the ends of the edges; its sets are the components. Degrees tell ends, branches and closed
 * curves. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "base/versioned.h"
#include <math.h>

enum { IS_OPEN = 1, IS_THERE = 2 }; /* of a component's root */

static brio_status count_degrees(brio_context *ctx, const brio_mesh *mesh, uint32_t *degree, uint32_t *parent) {
    for (size_t v = 0; v < mesh->num_vertices; v++) parent[v] = (uint32_t)v;
    for (size_t e = 0; e < mesh->num_edges; e++) {
        uint32_t a = mesh->edges[2 * e], b = mesh->edges[2 * e + 1];
        BRIO_EXPECT(ctx, a < mesh->num_vertices && b < mesh->num_vertices && a != b, BRIO_ERR_ARGUMENT,
                    "edge %zu joins vertices %u and %u of %zu; two different ones are needed", e, a, b,
                    mesh->num_vertices);
        degree[a]++, degree[b]++;
        brio_unite(parent, a, b, true);
        BRIO_FORWARD(brio_look(ctx, 1));
    }
    return BRIO_OK;
}

static double length_of(const brio_mesh *mesh) {
    double length = 0;
    for (size_t e = 0; e < mesh->num_edges; e++) {
        const double *a = mesh->vertices + 3 * (size_t)mesh->edges[2 * e];
        const double *b = mesh->vertices + 3 * (size_t)mesh->edges[2 * e + 1];
        length += hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
    }
    return length;
}

brio_status brio_mesh_curve_certificate(brio_context *ctx, const brio_mesh *mesh, brio_curve_certificate *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_curve_certificate c = {0};
    uint32_t *degree = NULL, *parent = NULL;
    uint8_t *state = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_curve_certificate, out));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, degree, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, parent, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, state, mesh->num_vertices));
    BRIO_TRY(count_degrees(ctx, mesh, degree, parent));
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        c.isolated += degree[v] == 0;
        c.ends += degree[v] == 1;
        c.branches += degree[v] > 2;
        if (degree[v]) state[brio_find(parent, v)] |= degree[v] == 2 ? IS_THERE : IS_THERE | IS_OPEN;
    }
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        c.components += state[v] != 0;
        c.loops += state[v] == IS_THERE;
    }
    c.closed = c.components > 0 && c.loops == c.components;
    c.manifold = c.branches == 0;
    c.length = length_of(mesh);
    BRIO_GIVE(brio_curve_certificate, out, &c);
done:
    brio_release(ctx, degree);
    brio_release(ctx, parent);
    brio_release(ctx, state);
    return status;
}
