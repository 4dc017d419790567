/* Where the vertices of the crust are: at orthocentres, or at samples.
 *
 * A sample lies on the balls of all poles whose tetrahedra it is a corner of. Their cells meet at the sample. So in
 * exact arithmetic the vertices between these cells are one point, the sample. Rounding the balls scatters the vertices
 * around the sample, and rounding the vertices turns the tiny faces between them over, so that faces cross. Therefore:
 *
 * - A vertex whose four balls go through one sample, and which is very close to the sample, moves onto the sample.
 * - If the four balls go through two samples, their cells meet along the line through both, and the orthocentre is an
 *   arbitrary point of this line. A vertex between the two samples moves onto the nearer one.
 *
 * A ball goes through a sample if it does so up to the rounding of the ball, because samples of a sphere or a plane lie
 * on balls whose tetrahedra they are no corners of. Only positions change: vertices at one position stay distinct, and
 * faces without area stay. */
#include "reconstruct/power_crust/crust_positions.h"
#include "base/vector.h"
#include "predicates/circumcentre.h"
#include <math.h>
#include <string.h>

/* How far a vertex may move off the segment between two samples of its balls, or onto a sample, as a share of the least
 * of its four radii. Chosen: vertices scatter over a share of 1e-9 or less; on dense samples those that belong
 * elsewhere are farther away than 1e-6. */
static const double NEAR = 0x1p-20;

/* Bounds of the error of |centre - sample|^2 - radius^2 for a sample that the ball should go through: shares of
 * radius^2, and of the radius times the largest coordinate. Derived: brio_centres errs by 2^-44 of the radius, which
 * counts twice, and rounds coordinates to 2^-53; the rest is room. */
static const double CENTRE_ERROR = 0x1p-42, ROUNDING = 0x1p-50;

enum { MOST_SAMPLES = 16 }; /* corners of four tetrahedra */

static const double *sample_at(const brio_power_diagram *d, uint32_t s) {
    return d->samples + 3 * (size_t)s;
}

/* A ball, with the error that it allows for. */
typedef struct {
    const double *centre;
    double square, error;
} ball;

static ball ball_of(const brio_power_diagram *d, uint32_t pole) {
    ball b = {d->poles->centre + 3 * (size_t)pole, d->poles->square[pole], 0};
    double most = 0;
    for (int k = 0; k < 3; k++) most = fabs(b.centre[k]) > most ? fabs(b.centre[k]) : most;
    b.error = CENTRE_ERROR * b.square + ROUNDING * most * sqrt(b.square);
    return b;
}

/* Returns whether the sample is on the ball, up to the rounding of the ball. */
static bool touches(const ball *b, const double *sample) {
    return fabs(brio_square_distance(b->centre, sample) - b->square) <= b->error;
}

/* Lists the corners of the poles' tetrahedra that are samples, each once. Returns their number.
 * at  receives for each the poles that it is a corner of, as bits. */
static int corner_samples(const brio_power_diagram *d, const uint32_t pole[4], uint32_t sample[MOST_SAMPLES],
                          unsigned at[MOST_SAMPLES]) {
    int count = 0;
    for (int i = 0; i < MOST_SAMPLES; i++) {
        uint32_t s = d->poles->touched[4 * (size_t)pole[i / 4] + (size_t)(i % 4)];
        int n = 0;
        if (s >= d->num_samples) continue;
        while (n < count && sample[n] != s) n++;
        if (n == count) sample[count] = s, at[count++] = 0;
        at[n] |= 1u << i / 4;
    }
    return count;
}

/* Writes the corners of the poles' tetrahedra that are samples on all four balls. Returns the number written. */
static int common_samples(const brio_power_diagram *d, const uint32_t pole[4], uint32_t sample[MOST_SAMPLES]) {
    unsigned at[MOST_SAMPLES];
    int count = 0, corners = corner_samples(d, pole, sample, at);
    ball b[4];
    for (int j = 0; j < 4; j++) b[j] = ball_of(d, pole[j]);
    for (int i = 0; i < corners; i++) {
        bool common = true;
        for (int j = 0; j < 4 && common; j++) common = at[i] >> j & 1 || touches(&b[j], sample_at(d, sample[i]));
        sample[count] = sample[i];
        count += common;
    }
    return count;
}

/* Returns the squared distance of p from the segment between a and b. */
static double square_from_segment(const double *p, const double *a, const double *b) {
    double u[3], v[3], off[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = p[k] - a[k];
    double square = brio_dot(u, u), along = square > 0 ? fmin(1, fmax(0, brio_dot(v, u) / square)) : 0;
    for (int k = 0; k < 3; k++) off[k] = v[k] - along * u[k];
    return brio_dot(off, off);
}

/* Returns the nearest of the samples. */
static const double *nearest_of(const brio_power_diagram *d, const uint32_t *sample, int count,
                                const double *position) {
    const double *nearest = sample_at(d, sample[0]);
    for (int i = 1; i < count; i++) {
        const double *s = sample_at(d, sample[i]);
        if (brio_square_distance(position, s) < brio_square_distance(position, nearest)) nearest = s;
    }
    return nearest;
}

static void move_to_sample(const brio_power_diagram *d, const uint32_t pole[4], double *position) {
    uint32_t sample[MOST_SAMPLES];
    int count = common_samples(d, pole, sample);
    double least = INFINITY;
    if (!count) return;
    for (int i = 0; i < 4; i++) least = fmin(least, d->poles->square[pole[i]]);
    const double *nearest = nearest_of(d, sample, count, position);
    bool near = false;
    for (int i = 0; i < count && !near; i++)
        near = square_from_segment(position, nearest, sample_at(d, sample[i])) <= NEAR * NEAR * least;
    if (near) memcpy(position, nearest, 3 * sizeof *position);
}

/* Takes the mean of four poles as their vertex. */
static void take_mean(const brio_poles *poles, const uint32_t pole[4], double *position) {
    for (size_t k = 0; k < 3; k++) {
        position[k] = 0;
        for (int i = 0; i < 4; i++) position[k] += 0.25 * poles->centre[3 * (size_t)pole[i] + k];
    }
}

/* Takes the mean of the four poles where doubles cannot hold an orthocentre. */
void brio_crust_positions(const brio_power_diagram *d, const uint32_t (*pole)[4], size_t count, double *position) {
    const brio_poles *poles = d->poles;
    brio_centres(&(brio_centre_batch){poles->centre, poles->square, pole, count}, position, NULL);
    for (size_t n = 0; n < count; n++, position += 3) {
        if (isnan(position[0])) take_mean(poles, pole[n], position);
        move_to_sample(d, pole[n], position);
    }
}
