/* Labels of poles from a known surface: a pole is inner if the surface winds round its centre. The decision is exact.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, chapter 4 (the medial axis of a known
 * surface). */
#include "reconstruct/labels/label_solid.h"
#include "base/team.h"
#include "mesh/solid.h"
#include <math.h>

/* STEP: poles between two calls of the progress callback. All chosen. */
enum { STEP = 1 << 16, POLES_A_THREAD = 32, CHUNK = 64 };

/* Returns the label of a pole. A centre that doubles cannot hold in the unit of the mesh is outside, since the
 * coordinates of the mesh are finite. */
static uint8_t label_of(const brio_solid *solid, const double *centre, int exponent) {
    double q[3];
    for (int k = 0; k < 3; k++) q[k] = ldexp(centre[k], exponent);
    if (!isfinite(q[0]) || !isfinite(q[1]) || !isfinite(q[2])) return BRIO_LABEL_OUTER;
    return brio_winding_number(solid, q) != 0 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
}

typedef struct {
    const brio_solid *solid;
    const double *centre; /* centre and label begin at the first pole of the step */
    int exponent;
    uint8_t *label;
} labeller;

static void label_part(void *user, size_t begin, size_t end, int thread) {
    const labeller *l = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) l->label[p] = label_of(l->solid, l->centre + 3 * p, l->exponent);
}

brio_status brio_label_by_solid(brio_context *ctx, const brio_poles *poles, int exponent, const brio_mesh *mesh,
                                uint8_t *label) {
    brio_status status = BRIO_OK;
    brio_solid solid;
    BRIO_TRY(brio_solid_new(ctx, mesh, &solid));
    for (size_t begin = 0; begin < poles->count; begin += STEP) {
        size_t count = poles->count - begin < STEP ? poles->count - begin : STEP;
        labeller l = {&solid, poles->centre + 3 * begin, exponent, label + begin};
        BRIO_TRY(brio_progress(ctx, "label", (double)begin / (double)poles->count));
        BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, count, POLES_A_THREAD), count, CHUNK, label_part, &l));
    }
done:
    brio_solid_free(ctx, &solid);
    return status;
}
