/* Euler characteristics of level sets, without their meshes.
 *
 * Marching tetrahedra make a vertex on each edge of Kuhn's subdivision whose ends are on different sides. A tetrahedron
 * adds one triangle where one of its corners is alone on its side, two where two are. A closed surface of F triangles
 * has 3 F / 2 edges, so its Euler characteristic is V - F / 2. A cell counts its own triangles, and the vertices on the
 * seven edges from its least corner; edges from nodes without a cell are on the border, where all is outside. So the
 * sides of a cell's eight corners give its share, by a table. */
#include "brio/testdata.h"
#include "testdata/solid_levels.h"

enum { CORNERS = 8, SIDES = 1 << CORNERS };

/* Returns the number of triangles in the tetrahedron of corners 0, a, b, 7. */
static int triangles_in(unsigned inside, unsigned a, unsigned b) {
    int count = (int)((inside & 1) + (inside >> a & 1) + (inside >> b & 1) + (inside >> 7 & 1));
    return count == 0 || count == 4 ? 0 : count == 2 ? 2 : 1;
}

/* Fills the table with twice each cell's share. Bit i of the index: corner i is inside. */
static void fill_table(int8_t table[SIDES]) {
    for (unsigned inside = 0; inside < SIDES; inside++) {
        unsigned other = inside & 1 ? ~inside & (SIDES - 1) : inside; /* corners on the other side than corner 0 */
        int share = 2 * __builtin_popcount(other);
        for (unsigned i = 0; i < 3; i++)
            for (unsigned j = 0; j < 3; j++)
                if (i != j) share -= triangles_in(inside, 1u << i, 1u << i | 1u << j);
        table[inside] = (int8_t)share;
    }
}

/* Adds the shares of the cells between two layers of nodes, for one level. */
static int64_t count_layer(const brio_implicit_grid *grid, double *const value[2], double level, const int8_t *table) {
    size_t row = (size_t)grid->cells[0] + 1;
    int64_t sum = 0;
    for (uint32_t y = 0; y < grid->cells[1]; y++) {
        unsigned column[2]; /* corners at x and at x + 1, in the bits of the corners at x */
        for (uint32_t x = 0; x <= grid->cells[0]; x++) {
            size_t at = y * row + x;
            column[1] = (unsigned)(value[0][at] < level) | (unsigned)(value[0][at + row] < level) << 2 |
                        (unsigned)(value[1][at] < level) << 4 | (unsigned)(value[1][at + row] < level) << 6;
            if (x) sum += table[column[0] | column[1] << 1];
            column[0] = column[1];
        }
    }
    return sum;
}

brio_status brio_solid_euler(brio_context *ctx, const brio_implicit_grid *grid, const double levels[BRIO_SOLID_LEVELS],
                             int64_t euler[BRIO_SOLID_LEVELS]) {
    brio_status status = BRIO_OK;
    size_t layer = ((size_t)grid->cells[0] + 1) * ((size_t)grid->cells[1] + 1);
    double *value[2] = {NULL, NULL};
    int8_t table[SIDES];
    fill_table(table);
    for (int i = 0; i < BRIO_SOLID_LEVELS; i++) euler[i] = 0;
    BRIO_TRY(brio_implicit_check(ctx, grid));
    for (int i = 0; i < 2; i++) BRIO_TRY(BRIO_ALLOC(ctx, value[i], layer));
    BRIO_TRY(brio_implicit_layer(ctx, grid, 0, value[1]));
    for (uint32_t z = 0; z < grid->cells[2]; z++) {
        double *lower = value[0];
        value[0] = value[1];
        value[1] = lower;
        BRIO_TRY(brio_implicit_layer(ctx, grid, z + 1, value[1]));
        for (int i = 0; i < BRIO_SOLID_LEVELS; i++) euler[i] += count_layer(grid, value, levels[i], table);
    }
    for (int i = 0; i < BRIO_SOLID_LEVELS; i++) euler[i] /= 2;
done:
    brio_release(ctx, value[0]);
    brio_release(ctx, value[1]);
    return status;
}
