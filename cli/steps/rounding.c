/* Two units in the last place of each coordinate may be missing: src/base/scale.h has the same for the library. */
#include "cli/steps/rounding.h"
#include <math.h>

static const double TWO_UNITS = 0x1p-50, MOST = 0x1p-14; /* the second is chosen */

double cli_rounding(const brio_mesh *mesh) {
    double greatest = 0;
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) greatest = fmax(greatest, fabs(mesh->vertices[i]));
    return TWO_UNITS * greatest;
}

double cli_up_to(double threshold, double rounding) {
    return threshold + fmin(rounding, MOST * threshold);
}
