/* Wigner-Seitz cells: the Voronoi cell of an atom in a crystal. One atom of a primitive cell is enough, and the vectors may
 * be skewed: a lattice has many cells, and its Wigner-Seitz cells are the same for all of them. */
#include "common.h"

#define ROOT3 1.7320508075688772

typedef struct crystal {
    const char *name;
    double cell[9];
    size_t atoms;
    double positions[6];
} crystal;

static const crystal crystals[] = {
    {"simple cubic", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 1, {0}},
    {"body-centred cubic", {-.5, .5, .5, .5, -.5, .5, .5, .5, -.5}, 1, {0}},
    {"face-centred cubic", {0, .5, .5, .5, 0, .5, .5, .5, 0}, 1, {0}},
    {"the same, skewed", {0, .5, .5, .5, 3.5, 4, -.5, 10.5, 9}, 1, {0}},
    {"diamond", {0, .5, .5, .5, 0, .5, .5, .5, 0}, 2, {0, 0, 0, .25, .25, .25}},
    {"hexagonal", {1, 0, 0, .5, ROOT3 / 2, 0, 0, 0, 1.5}, 1, {0}},
};

/* Faces of rounding's size are in lattices whose symmetry doubles cannot hold. */
static int is_face(const brio_cells *cells, size_t n, uint64_t face) {
    return cells->face_areas[face] > 1e-9 * cells->area[n];
}

static void show(brio_context *ctx, const crystal *c) {
    brio_periodic *t = NULL;
    brio_cells *cells = NULL;
    const brio_periodic_options options = {.size = sizeof options, .cell = c->cell};
    const brio_cells_options with_vertices = {.size = sizeof with_vertices, .vertices = 1};
    CHECK(ctx, brio_delaunay_periodic(ctx, c->positions, NULL, c->atoms, &options, &t));
    CHECK(ctx, brio_periodic_check(ctx, t));
    CHECK(ctx, brio_periodic_cells(ctx, t, &with_vertices, &cells));
    for (size_t n = 0; n < cells->num_cells; n++) {
        int corners[16] = {0}, faces = 0;
        for (uint64_t f = cells->face_offsets[n]; f < cells->face_offsets[n + 1]; f++) {
            if (!is_face(cells, n, f)) continue;
            uint64_t count = cells->corner_offsets[f + 1] - cells->corner_offsets[f];
            corners[count < 16 ? count : 15]++;
            faces++;
        }
        printf("%-20s volume %.4f, %2d faces:", c->name, cells->volume[n], faces);
        for (int k = 3; k < 16; k++)
            if (corners[k]) printf(" %d of %d corners", corners[k], k);
        printf("\n");
    }
    brio_cells_free(cells);
    brio_periodic_free(t);
}

int main(void) {
    brio_context *ctx = NULL;
    CHECK(ctx, brio_context_new(NULL, &ctx));
    for (size_t i = 0; i < sizeof crystals / sizeof *crystals; i++) show(ctx, &crystals[i]);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
