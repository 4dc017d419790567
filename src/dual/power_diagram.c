/* The power diagram of polar balls: see power_diagram.h. */
#include "dual/power_diagram.h"
#include "base/vector.h"
#include "triangulation/view.h"
#include <assert.h>
#include <math.h>

double brio_ball_weight(const brio_poles *poles, uint32_t p, uint32_t q) {
    assert(p < poles->count && q < poles->count);
    double pp = poles->square[p], qq = poles->square[q];
    double between = brio_square_distance(poles->centre + 3 * (size_t)p, poles->centre + 3 * (size_t)q);
    return (pp + qq - between) / (2 * sqrt(pp * qq));
}

brio_power_diagram brio_power_diagram_of(const brio_poles *poles, const double *samples, size_t num_samples,
                                         const brio_triangulation *power) {
    return (brio_power_diagram){
        .poles = poles,
        .samples = samples,
        .num_samples = num_samples,
        .power = brio_tetrahedra_of(power),
        .num_finite = brio_triangulation_stats(power)->tetrahedra,
        .representative = brio_triangulation_representatives(power),
    };
}
