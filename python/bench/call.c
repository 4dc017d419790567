/* call FILE DIMENSION TIMES: seconds of processor time of brio_delaunay (brio_delaunay2), one thread, for the doubles of
 * FILE; the least of TIMES runs is what performance.py compares with. A run triangulates until it has taken a millisecond. */
#include <brio/brio.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int triangulate(brio_context *ctx, int dimension, const double *points, size_t n) {
    brio_triangulation *space = NULL;
    brio_triangulation2 *plane = NULL;
    brio_status status = dimension == 3 ? brio_delaunay(ctx, points, NULL, n, NULL, &space)
                                        : brio_delaunay2(ctx, points, NULL, n, NULL, &plane);
    brio_triangulation_free(space);
    brio_triangulation2_free(plane);
    return status != BRIO_OK;
}

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    int dimension = atoi(argv[2]), times = atoi(argv[3]), wrong = 0;
    FILE *file = fopen(argv[1], "rb");
    brio_context *ctx;
    if (!file || brio_context_new(NULL, &ctx) != BRIO_OK) return 2;
    fseek(file, 0, SEEK_END);
    size_t bytes = (size_t)ftell(file);
    double *points = malloc(bytes);
    rewind(file);
    if (!points || fread(points, 1, bytes, file) != bytes) return 2;
    brio_context_set_threads(ctx, 1);
    for (int run = 0; run < times; run++) {
        double begin = seconds(), taken = 0;
        int calls = 0;
        for (; taken < 1e-3; calls++, taken = seconds() - begin)
            wrong |= triangulate(ctx, dimension, points, bytes / sizeof(double) / (size_t)dimension);
        printf("%.9g\n", taken / calls);
    }
    free(points);
    fclose(file);
    brio_context_free(ctx);
    return wrong;
}
