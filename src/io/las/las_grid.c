/* Finds scale and offset for the coordinates of a mesh.
 *
 * A grid is accepted if for every coordinate x the nearest whole number n gives x = n * step + origin in doubles, the
 * way a reader computes it. Most grids that do not fit fail at one of the first points. */
#include "io/las/las_grid.h"
#include <math.h>

/* Powers of 1/10 and of 1/2 that are tried: a nanometre, and the last bits of singles near 1. ORIGINS: whole numbers
 * within the range that are tried as origins of the first COARSE decimals. All chosen. */
enum { DECIMALS = 9, HALVES = 24, ORIGINS = 1024, COARSE = 4 };

static const double tenths[] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

static double number_of(double x, double step, double origin) {
    return rint((x - origin) / step);
}

static bool gives_back(const brio_mesh *m, int axis, double step, double origin) {
    if (!(step != 0) || !isfinite(step) || !isfinite(origin)) return false;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double x = m->vertices[3 * v + (size_t)axis], n = number_of(x, step, origin);
        if (!(n >= INT32_MIN && n <= INT32_MAX) || n * step + origin != x) return false;
    }
    return true;
}

static bool try_grid(const brio_mesh *m, int axis, double step, double origin, brio_las_grid *grid) {
    grid->step[axis] = step;
    grid->origin[axis] = origin;
    return gives_back(m, axis, step, origin);
}

static void find_range(const brio_mesh *m, int axis, double *low, double *high) {
    *low = *high = m->num_vertices ? m->vertices[axis] : 0;
    for (size_t v = 1; v < m->num_vertices; v++) {
        double x = m->vertices[3 * v + (size_t)axis];
        if (x < *low) *low = x;
        if (x > *high) *high = x;
    }
}

/* Tries whole numbers within the range as origins. Near an origin products with the step are small, so their sums with
 * the origin round to the double nearest to the decimal number. The doubles of most texts are such. */
static bool try_origins(const brio_mesh *m, int axis, double low, double high, brio_las_grid *grid) {
    double first = floor(low), count = ceil(high) - first;
    if (!(count > 0 && fabs(low) + fabs(high) < 0x1p53)) return false;
    double step = count > ORIGINS ? ceil(count / ORIGINS) : 1;
    for (int i = 0; i <= COARSE; i++)
        for (double origin = first; origin <= high; origin += step)
            if (try_grid(m, axis, tenths[i], origin, grid)) return true;
    return false;
}

static void find_axis(const brio_mesh *m, int axis, brio_las_grid *grid) {
    double low, high;
    if (try_grid(m, axis, m->coordinate_step[axis], m->coordinate_origin[axis], grid)) return;
    find_range(m, axis, &low, &high);
    double origins[] = {0, floor(low)};
    for (int o = 0; o < 2; o++)
        for (int i = 0; i <= DECIMALS; i++)
            if (try_grid(m, axis, tenths[i], origins[o], grid)) return;
    for (int o = 0; o < 2; o++)
        for (int i = 1; i <= HALVES; i++)
            if (try_grid(m, axis, ldexp(1, -i), origins[o], grid)) return;
    if (try_origins(m, axis, low, high, grid)) return;
    /* halves, because the difference of two doubles may overflow */
    double half = high / 2 - low / 2;
    grid->origin[axis] = low / 2 + high / 2;
    grid->step[axis] = half > 0 ? pow(10, ceil(log10(half / (INT32_MAX - 1)))) : 1;
    if (!(grid->step[axis] > 0)) grid->step[axis] = 0x1p-1022;
}

void brio_las_grid_find(const brio_mesh *mesh, brio_las_grid *grid) {
    for (int k = 0; k < 3; k++) find_axis(mesh, k, grid);
}

int32_t brio_las_grid_number(const brio_las_grid *grid, int axis, double x) {
    double n = number_of(x, grid->step[axis], grid->origin[axis]);
    return n <= INT32_MIN ? INT32_MIN : n >= INT32_MAX ? INT32_MAX : (int32_t)n;
}

double brio_las_grid_moved(const brio_las_grid *grid, const brio_mesh *m) {
    double most = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double by[3];
        for (int k = 0; k < 3; k++) {
            double x = m->vertices[3 * v + (size_t)k];
            by[k] = x - (brio_las_grid_number(grid, k, x) * grid->step[k] + grid->origin[k]);
        }
        if (by[0] != 0 || by[1] != 0 || by[2] != 0) most = fmax(most, hypot(by[0], hypot(by[1], by[2])));
    }
    return most;
}
