/* brio as a module of WebAssembly: what brio.mjs calls. A call takes and gives addresses; brio.mjs turns them into arrays.
 *
 * A function that returns int returns a brio_status. An array of `parts` receives counts and addresses, in the order that
 * its function says. */
#include <brio/brio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT(name) __attribute__((export_name(#name), visibility("default")))

/* Asks JavaScript whether to stop. */
__attribute__((import_module("brio"), import_name("progress"))) int brio_js_progress(const char *stage, double share);

static int on_progress(const char *stage, double share, void *user) {
    (void)user;
    return brio_js_progress(stage, share);
}

EXPORT(allocate) void *module_allocate(size_t size) {
    return malloc(size ? size : 1);
}

EXPORT(release) void module_release(void *block) {
    free(block);
}

EXPORT(version) const char *module_version(void) {
    return brio_version();
}

EXPORT(context) brio_context *module_context(void) {
    brio_context *ctx = NULL;
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return NULL;
    brio_context_set_progress(ctx, on_progress, NULL);
    return ctx;
}

EXPORT(message) const char *module_message(const brio_context *ctx) {
    return brio_message(ctx);
}

/* --- triangulations --- */

/* Gives its parts: tetrahedra, those of the hull's facets, the address of all, and the checksum's halves, low and high. */
static int give_triangulation(brio_context *ctx, brio_triangulation *t, const double *points, uint32_t parts[5]) {
    uint64_t checksum = 0;
    brio_status status = brio_triangulation_checksum(ctx, t, points, &checksum);
    const brio_delaunay_stats *stats = brio_triangulation_stats(t);
    parts[0] = (uint32_t)stats->tetrahedra;
    parts[1] = (uint32_t)stats->hull_facets;
    parts[2] = (uint32_t)(uintptr_t)brio_triangulation_tetrahedra(t);
    parts[3] = (uint32_t)checksum;
    parts[4] = (uint32_t)(checksum >> 32);
    return status;
}

EXPORT(delaunay)
int module_delaunay(brio_context *ctx, const double *points, const double *weights, size_t count,
                    brio_triangulation **out, uint32_t parts[5]) {
    brio_status status = brio_delaunay(ctx, points, weights, count, NULL, out);
    return status == BRIO_OK ? give_triangulation(ctx, *out, points, parts) : (int)status;
}

EXPORT(triangulation_free) void module_triangulation_free(brio_triangulation *t) {
    brio_triangulation_free(t);
}

/* --- meshes --- */

EXPORT(surface)
int module_surface(brio_context *ctx, const double *points, size_t count, brio_mesh **out) {
    return brio_surface(ctx, points, count, NULL, out, NULL);
}

EXPORT(read)
int module_read(brio_context *ctx, const void *bytes, size_t size, const char *name, brio_mesh **out) {
    return brio_read_memory(ctx, bytes, size, name, NULL, out);
}

EXPORT(write) int module_write(brio_context *ctx, const char *path, const brio_mesh *mesh) {
    return brio_write(ctx, path, mesh, NULL);
}

EXPORT(mesh) int module_mesh(brio_context *ctx, brio_mesh **out) {
    return brio_mesh_new(ctx, out);
}

EXPORT(mesh_set)
int module_mesh_set(brio_mesh *mesh, const double *vertices, size_t num_vertices, const uint32_t *triangles,
                    size_t num_triangles) {
    brio_status status = brio_mesh_set_vertices(mesh, vertices, num_vertices);
    uint64_t *offsets = malloc((num_triangles + 1) * sizeof *offsets);
    if (!offsets) return BRIO_ERR_NO_MEMORY;
    for (size_t i = 0; i <= num_triangles; i++) offsets[i] = 3 * i;
    if (status == BRIO_OK && num_triangles) status = brio_mesh_set_faces(mesh, offsets, triangles, num_triangles);
    free(offsets);
    return status;
}

/* Gives the parts of a mesh: count and address of vertices; of faces, with offsets (64 bits) and corners; of tetrahedra. */
EXPORT(mesh_parts) void module_mesh_parts(const brio_mesh *mesh, uint32_t parts[7]) {
    const uint32_t found[7] = {
        (uint32_t)mesh->num_vertices,
        (uint32_t)(uintptr_t)mesh->vertices,
        (uint32_t)mesh->num_faces,
        (uint32_t)(uintptr_t)mesh->face_offsets,
        (uint32_t)(uintptr_t)mesh->face_vertices,
        (uint32_t)mesh->num_tetrahedra,
        (uint32_t)(uintptr_t)mesh->tetrahedra,
    };
    memcpy(parts, found, sizeof found);
}

EXPORT(mesh_free) void module_mesh_free(brio_mesh *mesh) {
    brio_mesh_free(mesh);
}

/* Certifies a mesh: closed, manifold, oriented, components, genus, boundary edges and loops, crossing pairs of faces, area,
 * volume. */
EXPORT(certificate) int module_certificate(brio_context *ctx, const brio_mesh *mesh, double facts[10]) {
    brio_certificate c = {0};
    brio_status status = brio_mesh_certificate(ctx, mesh, &c);
    if (status == BRIO_OK) status = brio_mesh_self_intersections(ctx, mesh, &c.self_intersections);
    const double found[10] = {c.closed,
                              c.manifold,
                              c.oriented,
                              (double)c.components,
                              (double)c.genus,
                              (double)c.boundary_edges,
                              (double)c.boundary_loops,
                              (double)c.self_intersections,
                              c.area,
                              c.volume};
    memcpy(facts, found, sizeof found);
    brio_certificate_free(&c);
    return status;
}
