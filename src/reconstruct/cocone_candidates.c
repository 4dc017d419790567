/* The co-cone test.
 *
 * The co-cone of a sample p is the complement of the double cone about the direction v to its pole: the points x with
 * the angle between x - p and v in [pi/2 - theta, pi/2 + theta]. The Voronoi edge dual to a triangle is the segment
 * between the centres of the tetrahedra on its two sides, or a ray for a triangle on the hull. Each half of the double
 * cone is convex, so the edge misses the co-cone exactly when both its ends lie in the same half; the end of a ray is
 * its direction. So the test needs two bits for each tetrahedron and each of its vertices.
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.2.
 * Differs from the paper: the error bounds of the centres count in favour of the triangle, so that rounding loses
 * none. */
#include "reconstruct/cocone_candidates.h"
#include "base/memory.h"
#include "base/parallel.h"

static brio_side side_of(const brio_pole_vectors *v, size_t tet, size_t p, double sine) {
    const double *axis = v->vector + 3 * p;
    double to[3];
    brio_towards_centre(v, tet, p, to);
    double along = to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2];
    double length = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    double limit = sine * length + 4 * v->error[tet] + 0x1p-48 * length;
    return along > limit ? BRIO_SIDE_POLE : along < -limit ? BRIO_SIDE_ANTIPOLE : BRIO_SIDE_COCONE;
}

static void find_sides(const brio_context *ctx, brio_cocones *c) {
    const brio_pole_vectors *v = c->dual;
    double sine = sin(c->theta);
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t tet = 0; tet < v->t.count; tet++) {
        int bits = 0;
        for (int i = 0; i < (tet < v->num_finite ? 4 : 3); i++)
            bits |= (int)side_of(v, tet, v->t.tet[tet].vertex[i], sine) << 2 * i;
        c->sides[tet] = (uint8_t)bits;
    }
}

brio_status brio_cocones_new(brio_context *ctx, const brio_pole_vectors *dual, double theta, brio_cocones *out) {
    brio_status status = BRIO_OK;
    *out = (brio_cocones){.dual = dual, .theta = theta};
    BRIO_TRY(BRIO_ALLOC(ctx, out->sides, dual->t.count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->candidates, dual->t.count));
    find_sides(ctx, out);
done:
    return status;
}

void brio_cocones_free(brio_context *ctx, brio_cocones *c) {
    brio_release(ctx, c->sides);
    brio_release(ctx, c->candidates);
    *c = (brio_cocones){0};
}

static bool passes(const brio_cocones *c, uint32_t facet) {
    const uint32_t *v = c->dual->t.tet[brio_tet_of(facet)].vertex;
    int asked = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t p = v[BRIO_FACET[brio_slot_of(facet)][k]];
        if (p == BRIO_INFINITE) return false;
        if (c->boundary && c->boundary[p]) continue;
        if (!brio_meets_cocone(c, facet, p)) return false;
        asked++;
    }
    return asked > 0;
}

void brio_cocones_select(const brio_context *ctx, brio_cocones *c, size_t *count) {
    size_t sides = 0;
    (void)ctx; /* without OpenMP */
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)) reduction(+ : sides))
    for (size_t tet = 0; tet < c->dual->t.count; tet++) {
        int bits = 0;
        for (int i = 0; i < 4; i++)
            if (passes(c, brio_facet_of((uint32_t)tet, i))) bits |= 1 << i, sides++;
        c->candidates[tet] = (uint8_t)bits;
    }
    *count = sides / 2;
}
