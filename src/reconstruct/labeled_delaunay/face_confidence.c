/* The confidence of the surface at a triangle.
 *
 * A logistic regression on two measures: the mean, in log-odds, of the confidences of its corners (vote_confidence.c), and how
 * often its circle is larger than usual there (open_surface/face_sizes.c): the corners of a lid over a hole are samples, of which many
 * are sure, and its width tells it. Right are triangles of which at least half is within two pixels, about two spacings, of what some
 * camera saw, and faces the same way. Fitted to simulated scans, one-sided ones and complete clouds, of models that
 * nothing is judged on (docs/algorithms.md). */
#include "reconstruct/labeled_delaunay/face_confidence.h"
#include <math.h>

/* Measured on 27 surfaces of 5 models, with holes left open and closed; each counts equally, and in it each triangle by its area. */
static const double CONSTANT = 4.94, OF_CORNERS = 0.678, OF_SIZE = -3.64;

/* Confidences below this, mean log-odds over this, and sizes beyond this, count as these. Chosen. */
static const double LEAST = 1e-6, MOST_ODDS = 4, MOST_SIZE = 20;

float brio_face_confidence(const float corners[3], float size) {
    double odds = 0;
    for (int k = 0; k < 3; k++) {
        double p = fmin(fmax((double)corners[k], LEAST), 1 - LEAST);
        odds += log(p / (1 - p)) / 3;
    }
    double wide = log(fmin(fmax((double)size, 1), MOST_SIZE));
    return (float)(1 / (1 + exp(-CONSTANT - OF_CORNERS * fmin(odds, MOST_ODDS) - OF_SIZE * wide)));
}
