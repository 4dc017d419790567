/* From a scan to a surface: reads points, makes a surface through them, says what it is, and writes it.
 *
 *   06_surface SCAN OUT        for instance 06_surface sphere.xyz sphere.ply */
#include "common.h"

int main(int argc, char **argv) {
    brio_context *ctx = NULL;
    brio_mesh *scan = NULL, *surface = NULL;
    brio_surface_stats found = {0};
    brio_certificate c = {0};
    if (argc != 3) {
        fprintf(stderr, "usage: %s SCAN OUT\n", argv[0]);
        return EXIT_FAILURE;
    }
    CHECK(ctx, brio_context_new(NULL, &ctx));
    CHECK(ctx, brio_read(ctx, argv[1], NULL, &scan));
    CHECK(ctx, brio_surface(ctx, scan->vertices, scan->num_vertices, NULL, &surface, &found));
    printf("%zu points, %zu of them on no face, noise %g spacings\n", found.samples, found.unused, found.noise);

    CHECK(ctx, brio_mesh_certificate(ctx, surface, &c));
    printf("%zu vertices, %zu faces, closed %s, genus %lld\n", surface->num_vertices, surface->num_faces, yes(c.closed),
           (long long)c.genus);

    /* The points may have colours or other properties: give them to the vertices. */
    const brio_property *sample = brio_mesh_property(surface, "sample");
    CHECK(ctx, brio_mesh_carry_properties(ctx, scan, sample->data, surface));
    CHECK(ctx, brio_write(ctx, argv[2], surface, NULL));

    brio_certificate_free(&c);
    brio_mesh_free(surface);
    brio_mesh_free(scan);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
