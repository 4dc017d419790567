/* How long cells in space that repeats take, volumes and neighbours included, beside those in an open box.
 *   bench_periodic POINTS WAY THREADS
 * WAY: open, box (a cubic cell) or tilted (a triclinic one). Uniform points. Prints wall and processor seconds of the
 * triangulation and of the cells, the sum of volumes and the faces a point. */
#include "brio/brio.h"
#include "measure.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv) {
    static const double tilt[9] = {1, 0, 0, 0.3, 1, 0, 0.2, -0.4, 1}, plain[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const double box[6] = {0, 0, 0, 1, 1, 1};
    if (argc != 4) return fprintf(stderr, "usage: bench_periodic POINTS open|box|tilted THREADS\n"), 2;
    size_t n = (size_t)atoll(argv[1]);
    bool open = !strcmp(argv[2], "open");
    const double *cell = !strcmp(argv[2], "tilted") ? tilt : plain;
    double *points = malloc(3 * n * sizeof *points);
    brio_context *ctx = NULL;
    if (!points || brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    brio_context_set_threads(ctx, atoi(argv[3]));
    for (size_t i = 0; i < n; i++) {
        double share[3] = {draw(), draw(), draw()};
        for (int k = 0; k < 3; k++)
            points[3 * i + (size_t)k] = share[0] * cell[k] + share[1] * cell[3 + k] + share[2] * cell[6 + k];
    }
    brio_triangulation *t = NULL;
    brio_periodic *p = NULL;
    brio_cells *cells = NULL;
    brio_periodic_options o = {.size = sizeof o, .cell = cell};
    brio_cells_options how = {
        .size = sizeof how, .no_areas = 1, .no_centroids = 1, .no_face_sizes = 1, .box = open ? box : NULL};
    double wall[3] = {seconds(CLOCK_MONOTONIC)}, cpu[3] = {seconds(CLOCK_PROCESS_CPUTIME_ID)};
    check(ctx,
          open ? brio_delaunay(ctx, points, NULL, n, NULL, &t) : brio_delaunay_periodic(ctx, points, NULL, n, &o, &p));
    wall[1] = seconds(CLOCK_MONOTONIC), cpu[1] = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx,
          open ? brio_voronoi_cells(ctx, t, points, NULL, n, &how, &cells) : brio_periodic_cells(ctx, p, &how, &cells));
    wall[2] = seconds(CLOCK_MONOTONIC), cpu[2] = seconds(CLOCK_PROCESS_CPUTIME_ID);
    printf("%.4f %.4f  %.4f %.4f  %.15g %.4f\n", wall[1] - wall[0], cpu[1] - cpu[0], wall[2] - wall[1], cpu[2] - cpu[1],
           cells->volume_sum, (double)cells->face_offsets[cells->num_cells] / (double)n);
    brio_cells_free(cells);
    brio_periodic_free(p);
    brio_triangulation_free(t);
    brio_context_free(ctx);
    free(points);
    return 0;
}
