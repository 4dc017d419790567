/* The half-edges of a mesh of triangles. Takes twins from the rings of edges, and checks the rules of an oriented
 * surface: at most two half-edges to an edge, in opposite directions. */
#include "mesh/twins.h"
#include "mesh/edge_rings.h"

static brio_status check_triangles(brio_context *ctx, const brio_mesh *mesh) {
    for (size_t f = 0; f < mesh->num_faces; f++) {
        BRIO_FORWARD(brio_look(ctx, 1));
        uint64_t first = mesh->face_offsets[f], sides = mesh->face_offsets[f + 1] - first;
        BRIO_EXPECT(ctx, sides == 3, BRIO_BECAUSE(ctx, NOT_TRIANGLES, BRIO_ERR_NO_ANSWER),
                    "face %zu has %llu corners: a mesh of triangles is needed", f, (unsigned long long)sides);
        const uint32_t *v = mesh->face_vertices + first;
        BRIO_EXPECT(ctx, v[0] != v[1] && v[1] != v[2] && v[2] != v[0], BRIO_ERR_NO_ANSWER,
                    "face %zu has a vertex twice", f);
    }
    return BRIO_OK;
}

/* Writes the twin of half-edge h: the second half-edge of its ring. Fails unless the ring has at most two half-edges,
 * in opposite directions. */
static brio_status twin_of(brio_context *ctx, const brio_mesh *mesh, const uint32_t *ring, uint32_t h, uint32_t *twin) {
    const uint32_t *v = mesh->face_vertices;
    uint32_t other = ring[h], end = v[brio_next_corner(h)];
    BRIO_EXPECT(ctx, ring[other] == h, BRIO_ERR_NO_ANSWER, "the edge of vertices %u and %u has more than two faces",
                v[h], end);
    BRIO_EXPECT(ctx, other == h || v[other] == end, BRIO_ERR_NO_ANSWER,
                "faces %u and %u disagree on the direction of the edge of vertices %u and %u", h / 3, other / 3, v[h],
                end);
    *twin = other == h ? BRIO_NO_HALF_EDGE : other;
    return BRIO_OK;
}

brio_status brio_mesh_twins(brio_context *ctx, const brio_mesh *mesh, uint32_t **twin) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL;
    *twin = NULL;
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(check_triangles(ctx, mesh));
    BRIO_TRY(brio_edge_rings(ctx, mesh, &ring));
    BRIO_TRY(BRIO_ALLOC(ctx, *twin, 3 * mesh->num_faces));
    for (uint32_t h = 0; h < 3 * mesh->num_faces; h++) {
        BRIO_TRY(brio_look(ctx, 1));
        BRIO_TRY(twin_of(ctx, mesh, ring, h, &(*twin)[h]));
    }
done:
    brio_release(ctx, ring);
    if (status != BRIO_OK) {
        brio_release(ctx, *twin);
        *twin = NULL;
    }
    return status;
}
