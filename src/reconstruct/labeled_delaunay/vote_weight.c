/* Log-odds of votes, measured.
 *
 * The Delaunay triangulations of samples of generated solids were compared with the solids: for each tetrahedron and
 * each of its samples, by the direction of the Voronoi vertex and the thickness of the tetrahedron, how much of it is
 * on the side to which the sample's axis points. Within each thickness both sides count equally, so that four votes do
 * not count four times what the thickness alone tells. Samples without noise and with noise of 0.3 spacings in each
 * coordinate were measured; between them the log-odds are interpolated. */
#include "reconstruct/labeled_delaunay/vote_weight.h"

enum { DIRECTIONS = 20, THICKNESSES = 9 };

/* The upper bounds of all but the last thickness, in spacings. */
static const double THICKNESS[THICKNESSES - 1] = {0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1};

/* Samples with less noise than LEAST count as clean, those with more than MOST as noisy, as brio_least_noise finds it.
 * Generated samples with a noise of 0.3 spacings in each coordinate have over MOST, those without have less than LEAST
 * unless walls are as thin as the spacing. */
static const double LEAST = 0.07, MOST = 0.09;

/* Row: thickness; column: cosine, from -1 to 1. */
/* clang-format off */
static const float CLEAN[THICKNESSES][DIRECTIONS] = {
    {-3.0f, -1.3f, -1.2f, -1.1f, -1.1f, -1.1f, -1.1f, -1.1f, -1.0f, -1.1f, -1.1f, -1.1f, -1.1f, -1.0f, -1.0f, -0.9f, -0.9f, -0.8f, -0.7f, 0.3f},
    {-4.5f, -2.5f, -2.0f, -1.7f, -1.6f, -1.5f, -1.5f, -1.4f, -1.4f, -1.3f, -1.2f, -1.2f, -1.1f, -1.0f, -0.9f, -0.8f, -0.7f, -0.6f, -0.3f, 1.7f},
    {-5.8f, -4.1f, -3.3f, -3.0f, -2.6f, -2.3f, -2.1f, -1.9f, -1.6f, -1.4f, -1.1f, -0.9f, -0.8f, -0.5f, -0.4f, -0.2f, 0.1f, 0.4f, 1.0f, 3.4f},
    {-6.0f, -4.7f, -4.0f, -3.4f, -2.8f, -2.3f, -1.9f, -1.5f, -1.0f, -0.6f, -0.2f, 0.1f, 0.4f, 0.7f, 0.9f, 1.3f, 1.7f, 2.2f, 3.0f, 5.1f},
    {-6.0f, -4.9f, -4.1f, -3.4f, -2.7f, -2.0f, -1.3f, -0.7f, -0.1f, 0.5f, 1.0f, 1.5f, 1.9f, 2.3f, 2.7f, 3.0f, 3.4f, 3.8f, 4.4f, 5.9f},
    {-6.0f, -4.9f, -4.1f, -3.3f, -2.4f, -1.6f, -0.7f, -0.1f, 0.8f, 1.5f, 2.0f, 2.5f, 2.9f, 3.3f, 3.7f, 3.9f, 4.2f, 4.5f, 5.0f, 6.0f},
    {-6.0f, -5.5f, -4.8f, -3.9f, -3.1f, -2.3f, -1.4f, -0.5f, 0.2f, 1.2f, 1.9f, 2.4f, 2.9f, 3.5f, 3.8f, 4.1f, 4.4f, 4.7f, 5.2f, 6.0f},
    {-6.0f, -5.8f, -5.0f, -4.3f, -3.3f, -2.7f, -2.2f, -0.4f, 0.1f, 0.4f, 1.1f, 2.2f, 2.9f, 3.1f, 3.4f, 3.7f, 4.2f, 4.3f, 5.0f, 6.0f},
    {-6.0f, -6.0f, -5.6f, -4.2f, -3.1f, 0.0f, 0.0f, 0.1f, 0.5f, 0.5f, 0.8f, 1.2f, 1.9f, 2.3f, 3.3f, 2.4f, 5.0f, 3.7f, 5.5f, 6.0f},
};
static const float NOISY[THICKNESSES][DIRECTIONS] = {
{-2.3f, -1.9f, -1.7f, -1.5f, -1.4f, -1.4f, -1.4f, -1.3f, -1.2f, -1.1f, -1.1f, -1.1f, -1.0f, -0.9f, -0.8f, -0.6f, -0.5f, -0.3f, 0.1f, 1.1f},
    {-2.0f, -1.6f, -1.4f, -1.3f, -1.2f, -1.1f, -1.1f, -1.0f, -1.0f, -0.9f, -0.8f, -0.8f, -0.7f, -0.6f, -0.5f, -0.4f, -0.2f, -0.0f, 0.3f, 1.1f},
    {-1.7f, -1.3f, -1.1f, -1.0f, -0.9f, -0.8f, -0.7f, -0.7f, -0.6f, -0.6f, -0.5f, -0.4f, -0.3f, -0.3f, -0.1f, -0.0f, 0.1f, 0.3f, 0.6f, 1.3f},
    {-1.7f, -1.2f, -1.0f, -0.8f, -0.7f, -0.6f, -0.5f, -0.4f, -0.4f, -0.3f, -0.2f, -0.1f, -0.0f, 0.1f, 0.2f, 0.3f, 0.4f, 0.7f, 1.0f, 1.9f},
    {-2.4f, -1.7f, -1.4f, -1.2f, -1.0f, -0.8f, -0.7f, -0.5f, -0.3f, -0.2f, -0.1f, 0.1f, 0.2f, 0.3f, 0.5f, 0.7f, 0.9f, 1.3f, 1.9f, 3.1f},
    {-4.8f, -4.0f, -3.2f, -2.7f, -2.3f, -1.9f, -1.5f, -1.1f, -0.6f, -0.2f, 0.1f, 0.4f, 0.8f, 1.0f, 1.4f, 1.7f, 2.2f, 2.7f, 3.3f, 4.3f},
    {-6.0f, -6.0f, -6.0f, -5.7f, -4.3f, -3.3f, -2.2f, -1.3f, -0.2f, 0.9f, 1.5f, 2.2f, 2.7f, 3.3f, 3.3f, 3.6f, 3.9f, 4.0f, 4.3f, 4.6f},
    {-6.0f, -6.0f, -6.0f, -4.7f, -3.6f, 0.2f, 0.9f, 1.5f, 2.4f, 0.9f, 1.6f, 4.1f, 2.7f, 3.3f, 2.6f, 3.5f, 4.6f, 5.0f, 5.3f, 5.0f},
    {-6.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.4f, 0.0f, 0.6f, 0.2f, 0.9f, 1.3f, 1.1f, 2.3f, 2.8f, 3.4f, 4.2f, 5.3f, 6.0f, 6.0f},
};
/* clang-format on */

double brio_vote_log_odds(double cosine, double thickness, double noise) {
    int row = 0, column = (int)((cosine + 1) / 2 * DIRECTIONS);
    double share = noise < LEAST ? 0 : noise < MOST ? (noise - LEAST) / (MOST - LEAST) : 1;
    while (row < THICKNESSES - 1 && thickness >= THICKNESS[row]) row++;
    column = column < 0 ? 0 : column < DIRECTIONS ? column : DIRECTIONS - 1;
    return (1 - share) * (double)CLEAN[row][column] + share * (double)NOISY[row][column];
}
