/* A program of the version whose header it was compiled with: every struct that it hands to the library lies between
 * bytes of its own, which no library may touch. */
#include <brio/brio.h>
#include <math.h>
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

/* A struct of zeros: what it had at first; SIZED: with its size. */
#define ZEROS(type, name)                                                                                              \
    GUARDED(type) name;                                                                                                \
    memset(&name, 0x5a, sizeof name);                                                                                  \
    memset(&name.value, 0, sizeof name.value)

#define SIZED(type, name)                                                                                              \
    ZEROS(type, name);                                                                                                 \
    name.value.size = sizeof name.value

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        brio_status try_status = (call);                                                                               \
        if (try_status) printf("%s: %d %s\n", #call, (int)try_status, brio_message(ctx)), broken = 1;                  \
    } while (0)

/* Makes 1500 points on a torus, evenly. */
static void make_torus(double *places) {
    for (int i = 0; i < 1500; i++) {
        double u = 6.283185307179586 * i / 1500, v = 41 * u + 0.3 * sin(7 * u);
        places[3 * i] = (1 + 0.4 * cos(v)) * cos(u), places[3 * i + 1] = (1 + 0.4 * cos(v)) * sin(u);
        places[3 * i + 2] = 0.4 * sin(v);
    }
}

int main(void) {
    static double places[3 * 1500];
    brio_context *ctx = NULL;
    brio_mesh *points = NULL, *mesh = NULL, *crust = NULL;
    brio_triangulation *t = NULL;
    if (brio_context_new(NULL, &ctx)) return 1;
    ZEROS(brio_delaunay_options, delaunay);
    SIZED(brio_interpolation, interpolation);
    ZEROS(brio_surface_options, surface);
    SIZED(brio_surface_options, sized_surface);
    ZEROS(brio_power_shape_options, power_shape);
    SIZED(brio_iso_surface_options, iso);
    ZEROS(brio_write_options, write);
    SIZED(brio_read_options, read);
    ZEROS(brio_cells_options, cells_options);
    brio_cells *cells;
    ZEROS(brio_surface_stats, stats);
    SIZED(brio_surface_stats, sized_stats);
    ZEROS(brio_power_shape_stats, shape_stats);
    ZEROS(brio_certificate, certificate);
    SIZED(brio_distance, distance);

    TRY(brio_mesh_new(ctx, &points));
    make_torus(places);
    TRY(brio_mesh_set_vertices(points, places, 1500));
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
    surface.value.method = BRIO_SURFACE_POWER_CRUST;
    TRY(brio_surface(ctx, points->vertices, 1500, &surface.value, &crust, &stats.value));
    expect_guard("brio_surface_stats", stats.before, stats.after);
    TRY(brio_mesh_certificate(ctx, crust, &certificate.value));
    expect_guard("brio_certificate", certificate.before, certificate.after);
    printf("closed %d, genus %d, %d samples\n", certificate.value.closed, (int)certificate.value.genus,
           (int)stats.value.samples);
    sized_surface.value.method = BRIO_SURFACE_OFFSET;
    sized_surface.value.distance = 0.05;
    TRY(brio_surface(ctx, points->vertices, 1500, &sized_surface.value, &mesh, &sized_stats.value));
    expect_guard("brio_surface_stats", sized_stats.before, sized_stats.after);
    TRY(brio_mesh_distance(ctx, crust, mesh, 1000, 1, &distance.value));
    expect_guard("brio_distance", distance.before, distance.after);
    printf("offset %.1f\n", distance.value.mean);
    brio_mesh_free(mesh);
    TRY(brio_power_shape(ctx, points->vertices, 1500, &power_shape.value, &mesh, NULL, &shape_stats.value));
    expect_guard("brio_power_shape_stats", shape_stats.before, shape_stats.after);
    printf("shape %d\n", mesh->num_vertices > 0);
    brio_mesh_free(mesh);
    surface.value.method = BRIO_SURFACE_COCONE;
    TRY(brio_surface(ctx, points->vertices, 1500, &surface.value, &mesh, &stats.value));
    expect_guard("brio_surface_stats", stats.before, stats.after);
    printf("cocone %d\n", stats.value.candidates > 1000);
    brio_mesh_free(mesh);
    surface.value.method = BRIO_SURFACE_LABELED;
    TRY(brio_surface(ctx, points->vertices, 1500, &surface.value, &mesh, &stats.value));
    expect_guard("brio_surface_stats", stats.before, stats.after);
    printf("labeled %d\n", (int)stats.value.samples);
    brio_mesh_free(mesh);
    if (brio_iso_surface(ctx, "there is no such file.map", 1, &iso.value, &mesh) != BRIO_ERR_OPEN) broken = 1;
    if (brio_read(ctx, "there is no such file.xyz", &read.value, &mesh) != BRIO_ERR_OPEN) broken = 1;
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
