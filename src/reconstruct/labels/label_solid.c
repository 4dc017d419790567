/* Labels of poles from a known surface: a pole is inner when the surface winds round it, which is decided exactly.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, chapter 4 (the medial axis of a known surface).
 */
#include "reconstruct/labels/label_solid.h"
#include "base/parallel.h"
#include "surface/solid.h"
#include <math.h>

enum { CHUNK = 1 << 16 };

/* A pole that doubles cannot hold in the unit of the mesh is farther away than the mesh reaches. */
static uint8_t label_of(const brio_solid *solid, const double *centre, int exponent) {
    double q[3];
    for (int k = 0; k < 3; k++) q[k] = ldexp(centre[k], exponent);
    if (!isfinite(q[0]) || !isfinite(q[1]) || !isfinite(q[2])) return BRIO_LABEL_OUTER;
    return brio_winding_number(solid, q) != 0 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
}

brio_status brio_label_by_solid(brio_context *ctx, const brio_poles *poles, int exponent, const brio_mesh *mesh,
                                uint8_t *label) {
    brio_status status = BRIO_OK;
    brio_solid solid;
    BRIO_TRY(brio_solid_new(ctx, mesh, &solid));
    for (size_t begin = 0; begin < poles->count; begin += CHUNK) {
        size_t end = begin + CHUNK < poles->count ? begin + CHUNK : poles->count;
        BRIO_TRY(brio_progress(ctx, "label", (double)begin / (double)poles->count));
        BRIO_OMP(parallel for schedule(dynamic, 256) num_threads(brio_context_threads(ctx)))
        for (size_t p = begin; p < end; p++) label[p] = label_of(&solid, poles->centre + 3 * p, exponent);
    }
done:
    brio_solid_free(ctx, &solid);
    return status;
}
