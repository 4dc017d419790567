/* Log-odds that the axes of neighbouring samples have one sign, measured.
 *
 * Where a surface is smooth, the axes of neighbours are nearly parallel, and that tells their signs. Across an edge of
 * the surface they are not. But two points of a circle have normals that are mirror images across the plane between
 * them, and so do points on both sides of an edge, equally far from it. In noise the plane between close neighbours is
 * an accident, and the axes themselves tell more. So both cosines were measured, on scans of models that nothing else
 * was measured on: by the distance in spacings, how often the sign is that which makes the axes' cosine positive. The
 * noise of the noisy scans was 0.4 spacings along the line of sight, with registration errors of 0.3.
 *
 * Based on: Xie, Wang, Hua, Qin, Kaufman. Piecewise C1 continuous surface reconstruction of noisy point clouds via
 * local
 *           implicit quadric regression. IEEE Visualization 2003 (mirrored normals).
 *           Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH
 *           1992. */
#include "reconstruct/labeled_delaunay/axis_agreement.h"
#include <math.h>

enum { DISTANCES = 3, ALONG = 5, MIRRORED = 10 };

/* The upper bounds of all but the last distance, in spacings. */
static const double DISTANCE[DISTANCES - 1] = {1.5, 2.5};

/* As in vote_weight.c. */
static const double LEAST = 0.07, MOST = 0.09;

/* Of each distance; row: cosine between the axes, from 0 to 1; column: mirrored, from -1 to 1. */
/* clang-format off */
static const float CLEAN[DISTANCES][ALONG][MIRRORED] = {
    {{-4.6f, -4.0f, -3.4f, -2.3f, -0.7f, 1.5f, 2.8f, 3.5f, 4.1f, 4.7f},
     {-3.4f, -2.8f, -2.2f, -1.7f, -0.9f, 1.1f, 2.3f, 3.5f, 3.7f, 4.4f},
     {-2.8f, -2.4f, -1.5f, -1.1f, -0.2f, 0.5f, 1.9f, 3.1f, 3.8f, 4.3f},
     {-2.8f, -2.1f, -1.7f, -0.9f, -0.2f, 0.2f, 1.0f, 2.5f, 3.6f, 4.8f},
     {-3.2f, -2.0f, -1.6f, -0.9f, -0.3f, 0.3f, 1.1f, 1.8f, 3.5f, 7.0f}},
    {{-3.6f, -3.2f, -2.5f, -1.3f, -0.6f, 0.7f, 1.3f, 2.1f, 2.9f, 4.4f},
     {-2.6f, -2.5f, -1.6f, -1.1f, -0.5f, 0.1f, 1.2f, 1.1f, 1.5f, 3.2f},
     {-3.5f, -2.8f, -1.6f, -1.2f, -0.7f, -0.1f, 0.9f, 1.5f, 1.8f, 3.5f},
     {-3.2f, -2.5f, -2.2f, -1.8f, -1.2f, -0.2f, 0.6f, 0.6f, 1.6f, 4.0f},
     {-3.7f, -2.7f, -1.9f, -1.2f, -0.7f, -0.4f, -0.1f, 0.6f, 2.0f, 5.6f}},
    {{-3.2f, -1.4f, -0.6f, -0.6f, -0.6f, 0.1f, -0.1f, 0.2f, 0.9f, 2.9f},
     {-2.4f, -1.0f, -0.6f, -1.1f, -0.6f, 0.1f, 0.7f, 0.5f, 0.1f, 2.2f},
     {-1.7f, -0.7f, -0.5f, -0.3f, 0.2f, 0.2f, -0.1f, 0.4f, 0.7f, 2.2f},
     {-1.4f, -1.2f, -1.0f, -1.0f, -0.7f, -0.4f, 0.2f, 0.9f, 1.0f, 3.4f},
     {-3.0f, -1.4f, -0.7f, -0.6f, -0.4f, -0.4f, 0.1f, 0.8f, 1.7f, 4.8f}},
};
static const float NOISY[DISTANCES][ALONG][MIRRORED] = {
    {{-1.8f, -1.3f, -0.8f, -0.2f, 0.2f, 0.6f, 1.1f, 1.5f, 1.9f, 2.4f},
     {-1.3f, -0.5f, -0.1f, 0.4f, 1.0f, 1.4f, 1.5f, 2.2f, 2.5f, 3.3f},
     {-0.1f, 0.2f, 0.8f, 1.0f, 1.7f, 2.1f, 2.3f, 2.6f, 3.0f, 3.6f},
     {1.0f, 1.1f, 1.7f, 2.0f, 2.4f, 2.8f, 3.2f, 3.5f, 3.7f, 4.2f},
     {2.8f, 3.3f, 3.4f, 3.7f, 4.3f, 4.5f, 4.7f, 4.9f, 5.2f, 5.6f}},
    {{-2.9f, -2.6f, -1.9f, -0.8f, -0.2f, 0.6f, 1.3f, 2.1f, 2.6f, 3.7f},
     {-3.4f, -2.4f, -1.7f, -0.8f, 0.0f, 1.0f, 1.6f, 2.3f, 3.0f, 3.2f},
     {-3.1f, -2.9f, -1.7f, -0.8f, 0.2f, 1.2f, 1.7f, 2.4f, 3.4f, 3.4f},
     {-3.0f, -2.0f, -1.8f, -0.7f, 0.4f, 1.1f, 1.9f, 3.0f, 3.5f, 4.1f},
     {-3.2f, -2.3f, -1.6f, -0.7f, 0.3f, 1.4f, 2.5f, 3.5f, 4.4f, 5.5f}},
    {{-3.4f, -2.8f, -2.1f, -1.1f, -0.1f, 0.1f, 1.4f, 1.7f, 2.3f, 3.3f},
     {-3.0f, -3.0f, -2.3f, -1.6f, -0.5f, 0.4f, 0.9f, 1.7f, 2.6f, 3.6f},
     {-3.3f, -2.8f, -3.3f, -0.8f, -0.8f, 0.1f, 0.7f, 1.7f, 2.5f, 3.7f},
     {-4.6f, -3.8f, -2.0f, -1.9f, -0.8f, 0.2f, 0.7f, 2.0f, 3.0f, 3.9f},
     {-3.6f, -3.9f, -2.7f, -2.2f, -1.4f, -0.8f, 0.6f, 1.6f, 2.9f, 4.9f}},
};
/* clang-format on */

static int class_of(double share, int classes) {
    int class = (int)(share * classes);
    return class < 0 ? 0 : class < classes ? class : classes - 1;
}

double brio_axis_log_odds(double along, double mirrored, double distance, double noise) {
    double sign = along < 0 ? -1 : 1, share = noise < LEAST ? 0 : noise < MOST ? (noise - LEAST) / (MOST - LEAST) : 1;
    int d = 0, a = class_of(sign * along, ALONG), m = class_of((sign * mirrored + 1) / 2, MIRRORED);
    while (d < DISTANCES - 1 && distance >= DISTANCE[d]) d++;
    return sign * ((1 - share) * (double)CLEAN[d][a][m] + share * (double)NOISY[d][a][m]);
}
