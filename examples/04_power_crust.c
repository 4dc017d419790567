/* Surface reconstruction: points in, closed mesh out, with a certificate of what it is.
 *
 *   04_power_crust [OUT]      writes the mesh when a file is named */
#include "brio/testdata.h"
#include "common.h"

static const size_t NUM_POINTS = 4000;

int main(int argc, char **argv) {
    brio_context *ctx = NULL;
    brio_mesh *cloud = NULL, *surface = NULL;
    brio_surface_stats stats = {0};
    brio_certificate c = {0};
    CHECK(ctx, brio_context_new(NULL, &ctx));
    CHECK(ctx, brio_generate(ctx, BRIO_KIND_TORUS, NUM_POINTS, NULL, &cloud)); /* radii 1 and 0.4 */

    brio_surface_options options = {.method = BRIO_SURFACE_POWER_CRUST};
    CHECK(ctx, brio_surface(ctx, cloud->vertices, cloud->num_vertices, &options, &surface, &stats));
    printf("samples %zu, confused poles %zu\n", stats.samples, stats.poles.confused);

    CHECK(ctx, brio_mesh_certificate(ctx, surface, &c));
    printf("closed %s, manifold %s, oriented %s\n", yes(c.closed), yes(c.manifold), yes(c.oriented));
    printf("components %zu, genus %lld\n", c.components, (long long)c.genus);
    printf("volume %.2f, of the torus 2 pi^2 0.4^2 = 3.16\n", c.volume);

    if (argc > 1) CHECK(ctx, brio_write(ctx, argv[1], surface, NULL));
    brio_certificate_free(&c);
    brio_mesh_free(surface);
    brio_mesh_free(cloud);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
