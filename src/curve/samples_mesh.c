/* A mesh whose vertices are the distinct positions of points: what curves and trees are made over. */
#include "curve/samples_mesh.h"

brio_status brio_samples_mesh(brio_context *ctx, const double *points, size_t num_points, uint32_t *vertex,
                              brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    void *sample;
    size_t count = 0;
    for (size_t i = 0; i < num_points; i++)
        if (vertex[i] != BRIO_INFINITE) vertex[i] = (uint32_t)count++;
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(brio_mesh_set_vertices(mesh, NULL, count));
    BRIO_TRY(brio_mesh_add_property(mesh, "sample", BRIO_SCALAR_UINT32, &sample));
    for (size_t i = 0; i < num_points; i++) {
        if (vertex[i] == BRIO_INFINITE) continue;
        for (size_t k = 0; k < 3; k++) mesh->vertices[3 * (size_t)vertex[i] + k] = points[3 * i + k];
        ((uint32_t *)sample)[vertex[i]] = (uint32_t)i;
    }
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    return status;
}
