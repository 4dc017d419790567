/* Delaunay triangulation of random points, and a walk through it: which tetrahedron holds the centre of the cube, and
 * which vertices look at it across its facets. Facet handle 4*t + i names the facet of tetrahedron t opposite to its
 * vertex i; its mate is the same facet seen from the tetrahedron on the other side. */
#include "brio/testdata.h"
#include "common.h"

static const size_t NUM_POINTS = 10000;

/* The corners of facet i of a positive tetrahedron, in an order that makes (corners, x) positive for x inside. */
static const int facet[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

/* Walks from the first tetrahedron towards q, each step across a facet that has q on its other side. In a Delaunay
 * triangulation this ends. Outside the hull the walk would end in an infinite tetrahedron. */
static uint32_t locate(const brio_triangulation *t, const double *points, const double *q) {
    const brio_tetrahedron *tets = brio_triangulation_tetrahedra(t);
    uint32_t tet = 0;
    for (int i = 0; i < 4; i++) {
        const uint32_t *v = tets[tet].vertex;
        if (v[3] == BRIO_INFINITE) break;
        const double *a = points + 3 * (size_t)v[facet[i][0]], *b = points + 3 * (size_t)v[facet[i][1]],
                     *c = points + 3 * (size_t)v[facet[i][2]];
        if (brio_orient3d(a, b, c, q) >= 0) continue;
        tet = tets[tet].mate[i] / 4;
        i = -1;
    }
    return tet;
}

static int ascending(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void print_sorted(const char *title, const uint32_t v[4]) {
    uint32_t sorted[4] = {v[0], v[1], v[2], v[3]};
    qsort(sorted, 4, sizeof *sorted, ascending);
    printf("%s %u %u %u %u\n", title, sorted[0], sorted[1], sorted[2], sorted[3]);
}

int main(void) {
    brio_context *ctx = NULL;
    brio_mesh *cloud = NULL;
    brio_triangulation *t = NULL;
    CHECK(ctx, brio_context_new(NULL, &ctx));
    CHECK(ctx, brio_generate(ctx, BRIO_KIND_CUBE, NUM_POINTS, NULL, &cloud));
    CHECK(ctx, brio_delaunay(ctx, cloud->vertices, NULL, cloud->num_vertices, NULL, &t));

    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    printf("points      %zu\n", s->points);
    printf("dimension   %d\n", s->dimension);
    printf("tetrahedra  %zu\n", s->tetrahedra);
    printf("hull facets %zu\n", s->hull_facets);

    const double centre[3] = {0.5, 0.5, 0.5};
    const uint32_t tet = locate(t, cloud->vertices, centre);
    const brio_tetrahedron *tets = brio_triangulation_tetrahedra(t);
    uint32_t across[4];
    for (int i = 0; i < 4; i++) {
        const uint32_t mate = tets[tet].mate[i];
        across[i] = tets[mate / 4].vertex[mate % 4];
    }
    print_sorted("the centre lies among the points", tets[tet].vertex);
    print_sorted("seen across the facets by", across);

    CHECK(ctx, brio_triangulation_check(ctx, t, cloud->vertices, NULL, cloud->num_vertices));
    printf("checked exactly\n");

    brio_triangulation_free(t);
    brio_mesh_free(cloud);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
