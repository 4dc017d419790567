/* Numbers on a grid in space, and their iso-surfaces.
 *
 * Between the values the field is the product of Catmull-Rom splines; beyond the border the border's values are
 * repeated. The surface is made in coordinates of cells, where the grid is rectangular, and its vertices are then
 * mapped to space. The part above the level may leave the volume. To close the surface, a box half a cell inside the
 * border cuts this part: the function is the greater of the field's distance below the level and the distance outside
 * the box, scaled to the values. Mapping does not keep triangles Delaunay, because balls do not stay balls. So a
 * surface of Delaunay triangles uses a grid of cubes in space.
 *
 * Based on: Catmull, Rom. A class of local interpolating splines. Computer Aided Geometric Design 1974. */
#include "iso/volume.h"
#include "iso/iso_surface.h"
#include <math.h>

enum { MOST_RESOLUTION = 1 << 15 };

/* Most cubes for each value of the volume, where the steps choose the size of cubes: the number for cubes of a quarter
 * step. Chosen; volumes with nearly equal steps along all axes stay below 8. */
static const double MOST_CUBES_A_VALUE = 64;

void brio_volume_free(brio_context *ctx, brio_volume *volume) {
    brio_release(ctx, volume->values);
    *volume = (brio_volume){0};
}

static size_t count_values(const brio_volume *volume) {
    return (size_t)volume->size[0] * volume->size[1] * volume->size[2];
}

void brio_volume_statistics(const brio_volume *volume, double *mean, double *deviation) {
    size_t count = count_values(volume);
    double sum = 0, squares = 0;
    for (size_t i = 0; i < count; i++) sum += (double)volume->values[i];
    *mean = count ? sum / (double)count : 0;
    for (size_t i = 0; i < count; i++) squares += pow((double)volume->values[i] - *mean, 2);
    *deviation = count ? sqrt(squares / (double)count) : 0;
}

/* --- the field --- */

/* Finds the indices and weights of the four values along an axis that determine the field at a place. */
static void spline(double place, uint32_t size, uint32_t index[4], double weight[4]) {
    double low = floor(fmin(fmax(place, 0), size - 1)), t = place - low;
    for (int i = 0; i < 4; i++) index[i] = (uint32_t)fmin(fmax(low + i - 1, 0), size - 1);
    weight[0] = t * (-0.5 + t * (1 - 0.5 * t));
    weight[1] = 1 + t * t * (-2.5 + 1.5 * t);
    weight[2] = t * (0.5 + t * (2 - 1.5 * t));
    weight[3] = t * t * (-0.5 + 0.5 * t);
}

/* Returns the value at a place inside the grid, given in steps along the axes. The field is piecewise cubic along
 *  each axis, smooth (C1), and equal to the values at the grid's places. */
static double volume_at(const brio_volume *volume, const double *place) {
    uint32_t index[3][4];
    double weight[3][4], sum = 0;
    for (int k = 0; k < 3; k++) spline(place[k], volume->size[k], index[k], weight[k]);
    for (int z = 0; z < 4; z++)
        for (int y = 0; y < 4; y++) {
            const float *row = volume->values + ((size_t)index[2][z] * volume->size[1] + index[1][y]) * volume->size[0];
            double along = 0;
            for (int x = 0; x < 4; x++) along += weight[0][x] * (double)row[index[0][x]];
            sum += weight[2][z] * weight[1][y] * along;
        }
    return sum;
}

/* --- the surface --- */

typedef struct {
    const brio_volume *volume;
    double level, scale;  /* scale: factor of the distance outside the box */
    double stretch[3];    /* steps of the volume in a cell, along each axis */
    double cells[3];      /* number of cells along each axis */
    double inverse[3][3]; /* maps space, minus the origin, to steps of the volume */
} level_set;

/* Returns the function at p, given in cells. */
static double below_level(const double *p, const void *user) {
    const level_set *s = user;
    double place[3], outside = -INFINITY;
    for (int k = 0; k < 3; k++) {
        place[k] = p[k] * s->stretch[k];
        outside = fmax(outside, fmax(0.5 - p[k], p[k] - s->cells[k] + 0.5));
    }
    return fmax(s->level - volume_at(s->volume, place), s->scale * outside);
}

static double below_level_in_space(const double *p, const void *user) {
    const level_set *s = user;
    double q[3] = {0};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) q[k] += s->inverse[k][i] * (p[i] - s->volume->origin[i]);
        q[k] /= s->stretch[k];
    }
    return below_level(q, user);
}

static double step_length(const brio_volume *volume, int axis) {
    const double *s = volume->step[axis];
    return sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
}

/* Chooses cells of about equal length along all axes, with `resolution` of them along the longest. */
static brio_status choose_cells(brio_context *ctx, const brio_volume *volume, size_t resolution, uint32_t cells[3]) {
    double length[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        length[k] = step_length(volume, k) * (volume->size[k] - 1.0);
        longest = fmax(longest, length[k]);
    }
    for (int k = 0; k < 3; k++) {
        double wanted = fmax(1, rint(length[k] / longest * (double)resolution));
        BRIO_FORWARD(brio_implicit_cells(ctx, resolution ? wanted : volume->size[k] - 1.0, &cells[k]));
    }
    return BRIO_OK;
}

static void carry_to_space(const level_set *s, brio_mesh *mesh) {
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        double *p = mesh->vertices + 3 * i, place[3];
        for (int k = 0; k < 3; k++) place[k] = p[k] * s->stretch[k];
        for (int k = 0; k < 3; k++)
            p[k] = s->volume->origin[k] + place[0] * s->volume->step[0][k] + place[1] * s->volume->step[1][k] +
                   place[2] * s->volume->step[2][k];
    }
}

/* Inverts the matrix of steps. Its rows are cross products of two steps, divided by the volume of the three steps. */
static void invert_steps(const brio_volume *volume, double inverse[3][3]) {
    for (int k = 0; k < 3; k++) {
        const double *u = volume->step[(k + 1) % 3], *v = volume->step[(k + 2) % 3], *w = volume->step[k];
        double across = 0;
        for (int i = 0; i < 3; i++) {
            inverse[k][i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
            across += inverse[k][i] * w[i];
        }
        for (int i = 0; i < 3; i++) inverse[k][i] /= across;
    }
}

/* Finds the box round the volume, and the side of its cubes. */
static void choose_cube(const level_set *s, size_t resolution, double low[3], double high[3], double *cube) {
    const brio_volume *volume = s->volume;
    double longest = 0, shortest_step = INFINITY;
    for (int i = 0; i < 3; i++) low[i] = high[i] = volume->origin[i];
    for (int k = 0; k < 3; k++) {
        longest = fmax(longest, step_length(volume, k) * (volume->size[k] - 1.0));
        shortest_step = fmin(shortest_step, step_length(volume, k));
        for (int i = 0; i < 3; i++) {
            double reach = volume->step[k][i] * (volume->size[k] - 1.0);
            low[i] += fmin(reach, 0);
            high[i] += fmax(reach, 0);
        }
    }
    *cube = resolution ? longest / (double)resolution : shortest_step;
}

/* Chooses a grid of cubes in space round the volume, with one cell to spare. Refuses steps of very different lengths,
 * which would make a grid far too large: then the caller must choose the resolution. */
static brio_status choose_cubes(brio_context *ctx, level_set *s, size_t resolution, brio_implicit_grid *grid) {
    const brio_volume *volume = s->volume;
    double high[3], count[3] = {0}, product = 1;
    choose_cube(s, resolution, grid->low, high, &grid->cell);
    for (int i = 0; i < 3; i++) {
        grid->low[i] -= grid->cell;
        count[i] = ceil((high[i] - grid->low[i]) / grid->cell) + 1;
        product *= count[i];
    }
    BRIO_EXPECT(ctx, resolution || product <= MOST_CUBES_A_VALUE * (double)count_values(volume), BRIO_ERR_TOO_LARGE,
                "cubes as wide as the shortest step of the volume make a grid of %.0f x %.0f x %.0f: choose their "
                "number with a resolution",
                count[0], count[1], count[2]);
    for (int k = 0; k < 3; k++) {
        BRIO_FORWARD(brio_implicit_cells(ctx, count[k], &grid->cells[k]));
        s->cells[k] = step_length(volume, k) * (volume->size[k] - 1.0) / grid->cell;
        s->stretch[k] = (volume->size[k] - 1.0) / s->cells[k];
    }
    invert_steps(volume, s->inverse);
    grid->value = below_level_in_space;
    return BRIO_OK;
}

static brio_status choose_grid(brio_context *ctx, level_set *s, size_t resolution, brio_implicit_grid *grid) {
    BRIO_FORWARD(choose_cells(ctx, s->volume, resolution, grid->cells));
    for (int k = 0; k < 3; k++) {
        s->cells[k] = grid->cells[k];
        s->stretch[k] = (s->volume->size[k] - 1.0) / s->cells[k];
    }
    grid->cell = 1;
    grid->value = below_level;
    return BRIO_OK;
}

brio_status brio_volume_surface(brio_context *ctx, const brio_volume *volume, double level, size_t resolution,
                                bool conforming, brio_mesh **out) {
    level_set s = {.volume = volume, .level = level};
    brio_implicit_grid grid = {.user = &s};
    double mean;
    *out = NULL;
    for (int k = 0; k < 3; k++)
        BRIO_EXPECT(ctx, volume->size[k] >= 2, BRIO_ERR_NO_ANSWER, "a volume of %u x %u x %u values has no inside",
                    volume->size[0], volume->size[1], volume->size[2]);
    BRIO_EXPECT(ctx, resolution <= MOST_RESOLUTION, BRIO_ERR_ARGUMENT, "resolution %zu: expected 0 to %d", resolution,
                MOST_RESOLUTION);
    brio_volume_statistics(volume, &mean, &s.scale);
    if (!(s.scale > 0)) s.scale = 1;
    if (conforming) {
        BRIO_FORWARD(choose_cubes(ctx, &s, resolution, &grid));
        return brio_conforming_surface(ctx, &grid, out);
    }
    BRIO_FORWARD(choose_grid(ctx, &s, resolution, &grid));
    BRIO_FORWARD(brio_marched_surface(ctx, &grid, out));
    carry_to_space(&s, *out);
    return BRIO_OK;
}
