/* The mesh handle: what it refuses to hold, and what no file is written of. */
#include "harness.h"
#include "points.h"
#include <unistd.h>

static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

static brio_mesh *triangle(brio_context *ctx, uint32_t last) {
    brio_mesh *mesh;
    const uint64_t offsets[] = {0, 3};
    const uint32_t indices[] = {0, 1, last};
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && mesh->size == sizeof *mesh);
    EXPECT(brio_mesh_set_vertices(mesh, corners, 3) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, indices, 1) == BRIO_OK);
    return mesh;
}

/* A property made before the vertices was too short for them. */
static void vertices_come_before_properties(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    void *data;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_add_property(mesh, "x", BRIO_SCALAR_FLOAT64, &data) == BRIO_OK);
    EXPECT(brio_mesh_set_vertices(mesh, corners, 3) == BRIO_ERR_ARGUMENT && mesh->num_vertices == 0);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* 3 * num_vertices wrapped, and a small array passed for a large one. */
static void counts_whose_bytes_wrap_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    const uint64_t offsets[] = {0, SIZE_MAX / 4 + 2};
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_set_vertices(mesh, NULL, SIZE_MAX / 3 + 1) == BRIO_ERR_TOO_LARGE && !mesh->vertices);
    if (SIZE_MAX > UINT32_MAX)
        EXPECT(brio_mesh_set_vertices(mesh, NULL, (size_t)UINT32_MAX + 1) == BRIO_ERR_TOO_LARGE && !mesh->vertices);
    EXPECT(brio_mesh_set_faces(mesh, offsets, NULL, 1) == BRIO_ERR_ARGUMENT && !mesh->num_faces);
    EXPECT(brio_mesh_set_faces(mesh, NULL, NULL, SIZE_MAX) == BRIO_ERR_TOO_LARGE);
    EXPECT(brio_mesh_set_tetrahedra(mesh, NULL, 4, SIZE_MAX / 4 + 1) == BRIO_ERR_TOO_LARGE);
    EXPECT(brio_mesh_set_edges(mesh, NULL, SIZE_MAX / 2 + 1) == BRIO_ERR_TOO_LARGE);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void wrong_offsets_and_strides_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    static const uint64_t wrong[][4] = {{2, 3, 6, 9}, {0, 3, 2, 9}, {0, 9, 6, 3}};
    const uint32_t indices[9] = {0};
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, corners, 3) == BRIO_OK);
    for (int i = 0; i < 3; i++)
        EXPECT(brio_mesh_set_faces(mesh, wrong[i], indices, 3) == BRIO_ERR_ARGUMENT && !mesh->face_offsets);
    EXPECT(brio_mesh_set_tetrahedra(mesh, indices, 0, 1) == BRIO_ERR_ARGUMENT && !mesh->tetrahedra);
    EXPECT(brio_mesh_set_tetrahedra(mesh, indices, 3, 1) == BRIO_ERR_ARGUMENT && !mesh->tetrahedra);
    EXPECT(brio_mesh_set_vertices(mesh, corners, 3) == BRIO_ERR_ARGUMENT); /* a second time */
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* The first offset was looked at only if there was a face. */
static void offsets_of_no_faces_begin_at_0(void) {
    const uint64_t wrong[1] = {3}, right[1] = {0};
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, wrong, NULL, 0) == BRIO_ERR_ARGUMENT && !mesh->face_offsets);
    EXPECT(brio_mesh_set_faces(mesh, right, NULL, 0) == BRIO_OK);
    brio_mesh_free(mesh);
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_faces(mesh, NULL, NULL, 0) == BRIO_OK);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* A face of three vertices and a fourth index was written as it was. */
static void no_file_is_written_of_indices_out_of_range(void) {
    static const char *const extensions[] = {"ply", "obj", "off", "vtu", "vtp"};
    brio_context *ctx = new_context();
    for (int e = 0; e < 5; e++) {
        char path[64];
        brio_mesh *mesh = triangle(ctx, 99);
        snprintf(path, sizeof path, "/tmp/brio-test-mesh-%ld.%s", (long)getpid(), extensions[e]);
        EXPECT(brio_write(ctx, path, mesh, NULL) == BRIO_ERR_ARGUMENT, "%s", extensions[e]);
        EXPECT(access(path, F_OK) != 0);
        brio_mesh_free(mesh);
        mesh = triangle(ctx, 2);
        const uint32_t edge[2] = {0, 3};
        EXPECT(brio_mesh_set_edges(mesh, edge, 1) == BRIO_OK);
        EXPECT(brio_write(ctx, path, mesh, NULL) == BRIO_ERR_ARGUMENT && access(path, F_OK) != 0);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

SUITE(test_mesh) {
    RUN(vertices_come_before_properties);
    RUN(counts_whose_bytes_wrap_are_refused);
    RUN(wrong_offsets_and_strides_are_refused);
    RUN(offsets_of_no_faces_begin_at_0);
    RUN(no_file_is_written_of_indices_out_of_range);
    return harness_end();
}
