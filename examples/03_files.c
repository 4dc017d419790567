/* Files: reads any format, says what is in the file, certifies its faces, and writes it in another format.
 *
 *   03_files IN OUT        for instance 03_files cube.off cube.ply */
#include "common.h"

static void print_contents(const brio_mesh *mesh) {
    printf("vertices %zu, faces %zu, tetrahedra %zu\n", mesh->num_vertices, mesh->num_faces, mesh->num_tetrahedra);
    for (size_t i = 0; i < mesh->num_properties; i++) {
        const brio_property *p = &mesh->properties[i];
        double least = brio_property_value(p, 0), most = least;
        for (size_t v = 1; v < mesh->num_vertices; v++) {
            double x = brio_property_value(p, v);
            if (x < least) least = x;
            if (x > most) most = x;
        }
        printf("property %s from %g to %g\n", p->name, least, most);
    }
}

static void print_certificate(brio_context *ctx, const brio_mesh *mesh) {
    brio_certificate c = {0};
    CHECK(ctx, brio_mesh_certificate(ctx, mesh, &c));
    printf("closed %s, manifold %s, oriented %s\n", yes(c.closed), yes(c.manifold), yes(c.oriented));
    printf("components %zu, genus %lld, boundary loops %zu\n", c.components, (long long)c.genus, c.boundary_loops);
    printf("area %g, volume %g\n", c.area, c.volume);
    brio_certificate_free(&c);
}

int main(int argc, char **argv) {
    brio_context *ctx = NULL;
    brio_mesh *mesh = NULL, *again = NULL;
    if (argc != 3) {
        fprintf(stderr, "usage: %s IN OUT\n", argv[0]);
        return EXIT_FAILURE;
    }
    CHECK(ctx, brio_context_new(NULL, &ctx));
    CHECK(ctx, brio_read(ctx, argv[1], NULL, &mesh));
    print_contents(mesh);
    if (mesh->num_faces) print_certificate(ctx, mesh);

    brio_write_options options = {0};
    options.comment = "written by 03_files";
    CHECK(ctx, brio_write(ctx, argv[2], mesh, &options));

    printf("read back:\n");
    CHECK(ctx, brio_read(ctx, argv[2], NULL, &again));
    print_contents(again);

    /* A failure is a status and a sentence, and leaves nothing to clean up. */
    brio_mesh *missing = NULL;
    if (brio_read(ctx, "no-such-file.ply", NULL, &missing) == BRIO_ERR_OPEN) printf("%s\n", brio_message(ctx));

    brio_mesh_free(again);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
