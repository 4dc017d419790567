/* A user of the installed library: the triangulation of the corners of a cube and its centre. */
#include <brio/brio.h>
#include <stdio.h>

int main(void) {
    const double points[27] = {0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, .5, .5, .5};
    brio_context *ctx = NULL;
    brio_triangulation *t = NULL;
    if (brio_context_new(NULL, &ctx) || brio_delaunay(ctx, points, NULL, 9, NULL, &t)) return 1;
    printf("%zu tetrahedra\n", brio_triangulation_stats(t)->tetrahedra);
    brio_triangulation_free(t);
    brio_context_free(ctx);
    return 0;
}
