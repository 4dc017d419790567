/* The hash of a caller's points, see points_hash.h. */
#include "base/points_hash.h"
#include "base/context.h"
#include "base/float_state.h"
#include <assert.h>

uint64_t brio_points_hash(const double *points, const double *weights, size_t num_points, int coordinates) {
    BRIO_DOOR;
    assert(coordinates == 2 || coordinates == 3);
    uint64_t sum = 0;
    size_t columns = coordinates == 2 ? 2 : 3;
    for (size_t i = 0; i < num_points; i++) {
        double record[4] = {0};
        for (size_t k = 0; k < columns; k++) record[k] = points[columns * i + k] + 0.0; /* -0 becomes 0 */
        record[3] = weights ? weights[i] + 0.0 : 0;
        sum += brio_point_hash(i, record);
    }
    return sum;
}
