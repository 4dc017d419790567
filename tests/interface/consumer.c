/* A program of the version whose header it was compiled with: every struct that it hands to the library lies between
 * bytes of its own, which no library may touch. */
#include <brio/brio.h>
#include <stdio.h>
#include <string.h>

#define GUARDED(type)                                                                                                  \
    struct {                                                                                                           \
        char before[64];                                                                                               \
        type value;                                                                                                    \
        char after[64];                                                                                                \
    }

static int broken;

static void expect_guard(const char *name, const char *before, const char *after) {
    for (int i = 0; i < 64; i++)
        if (before[i] != 0x5a || after[i] != 0x5a) {
            printf("%s: the library wrote beyond the struct\n", name);
            broken = 1;
            return;
        }
}

#define OPTIONS(type, name)                                                                                            \
    GUARDED(type) name;                                                                                                \
    memset(&name, 0x5a, sizeof name);                                                                                  \
    type##_init(&name.value, sizeof name.value);                                                                       \
    expect_guard(#type, name.before, name.after);                                                                      \
    {                                                                                                                  \
        type standard = type##_default();                                                                              \
        if (memcmp(&standard, &name.value, sizeof standard)) printf(#type ": two defaults\n"), broken = 1;             \
    }

#define RESULT(type, name)                                                                                             \
    GUARDED(type) name;                                                                                                \
    memset(&name, 0x5a, sizeof name);                                                                                  \
    memset(&name.value, 0, sizeof name.value);                                                                         \
    name.value.size = sizeof name.value

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        brio_status try_status = (call);                                                                               \
        if (try_status) printf("%s: %d %s\n", #call, (int)try_status, brio_message(ctx)), broken = 1;                  \
    } while (0)

int main(void) {
    brio_context *ctx = NULL;
    brio_mesh *points = NULL, *mesh = NULL, *crust = NULL;
    brio_triangulation *t = NULL;
    if (brio_context_new(NULL, &ctx)) return 1;
    OPTIONS(brio_generate_options, generate);
    OPTIONS(brio_delaunay_options, delaunay);
    OPTIONS(brio_interpolation, interpolation);
    OPTIONS(brio_power_crust_options, power_crust);
    OPTIONS(brio_offset_surface_options, offset);
    OPTIONS(brio_power_shape_options, power_shape);
    OPTIONS(brio_cocone_options, cocone);
    OPTIONS(brio_labeled_delaunay_options, labeled);
    OPTIONS(brio_iso_surface_options, iso);
    OPTIONS(brio_write_options, write);
    OPTIONS(brio_read_options, read);
    OPTIONS(brio_cells_options, cells_options);
    brio_cells *cells;
    RESULT(brio_power_crust_stats, crust_stats);
    RESULT(brio_offset_surface_stats, offset_stats);
    RESULT(brio_power_shape_stats, shape_stats);
    RESULT(brio_cocone_stats, cocone_stats);
    RESULT(brio_labeled_delaunay_stats, labeled_stats);
    RESULT(brio_certificate, certificate);
    RESULT(brio_distance, distance);

    TRY(brio_generate(ctx, BRIO_KIND_TORUS, 1500, &generate.value, &points));
    TRY(brio_delaunay(ctx, points->vertices, NULL, 1500, &delaunay.value, &t));
    printf("dimension %d, %d vertices\n", brio_triangulation_stats(t)->dimension,
           (int)brio_triangulation_stats(t)->vertices);
    brio_locator *locator = NULL;
    double value = 0;
    TRY(brio_locator_new(ctx, t, points->vertices, NULL, 1500, &locator));
    interpolation.value.values = points->vertices; /* any 1500 numbers */
    TRY(brio_locator_interpolate(ctx, locator, points->vertices, 1, &interpolation.value, &value));
    printf("interpolated %d\n", value == points->vertices[0]);
    brio_locator_free(locator);
    TRY(brio_power_crust(ctx, points->vertices, 1500, &power_crust.value, &crust, NULL, &crust_stats.value));
    expect_guard("brio_power_crust_stats", crust_stats.before, crust_stats.after);
    TRY(brio_mesh_certificate(ctx, crust, &certificate.value));
    expect_guard("brio_certificate", certificate.before, certificate.after);
    printf("closed %d, genus %d, %d samples\n", certificate.value.closed, (int)certificate.value.genus,
           (int)crust_stats.value.poles.samples);
    TRY(brio_offset_surface(ctx, points->vertices, 1500, 0.05, &offset.value, &mesh, &offset_stats.value));
    expect_guard("brio_offset_surface_stats", offset_stats.before, offset_stats.after);
    TRY(brio_mesh_distance(ctx, crust, mesh, 1000, 1, &distance.value));
    expect_guard("brio_distance", distance.before, distance.after);
    printf("offset %.1f\n", distance.value.mean);
    brio_mesh_free(mesh);
    TRY(brio_power_shape(ctx, points->vertices, 1500, &power_shape.value, &mesh, NULL, &shape_stats.value));
    expect_guard("brio_power_shape_stats", shape_stats.before, shape_stats.after);
    printf("shape %d\n", mesh->num_vertices > 0);
    brio_mesh_free(mesh);
    TRY(brio_cocone(ctx, points->vertices, 1500, &cocone.value, &mesh, &cocone_stats.value));
    expect_guard("brio_cocone_stats", cocone_stats.before, cocone_stats.after);
    printf("cocone %d\n", cocone_stats.value.candidates > 1000);
    brio_mesh_free(mesh);
    TRY(brio_labeled_delaunay(ctx, points->vertices, 1500, &labeled.value, &mesh, NULL, &labeled_stats.value));
    expect_guard("brio_labeled_delaunay_stats", labeled_stats.before, labeled_stats.after);
    printf("labeled %d\n", (int)labeled_stats.value.samples);
    brio_mesh_free(mesh);
    if (brio_iso_surface(ctx, "there is no such file.map", &iso.value, &mesh) != BRIO_ERR_OPEN) broken = 1;
    if (brio_read_as(ctx, "there is no such file.xyz", &read.value, &mesh) != BRIO_ERR_OPEN) broken = 1;
    if (brio_write(ctx, "no such folder/x.ply", points, &write.value) != BRIO_ERR_WRITE) broken = 1;
    brio_certificate_free(&certificate.value);
    expect_guard("brio_certificate", certificate.before, certificate.after);
    if (brio_voronoi_cells(ctx, t, points->vertices, NULL, 1500, &cells_options.value, &cells) != BRIO_OK ||
        cells->num_cells != 1500)
        broken = 1;
    brio_cells_free(cells);
    brio_triangulation_free(t);
    brio_mesh_free(points);
    brio_mesh_free(crust);
    brio_context_free(ctx);
    puts(broken ? "broken" : "whole");
    return broken;
}
