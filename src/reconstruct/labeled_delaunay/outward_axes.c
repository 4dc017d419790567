/* The axes of the samples, and the way to the outside along them.
 *
 * The axis of a sample is that of its Voronoi cell. Neighbours along a sheet agree on its sign (sheet_signs.c); normals
 * of the points and places of scanners tell it for a whole sheet (../cocone/sample_evidence.c).
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000. */
#include "base/memory.h"
#include "base/vector.h"
#include "base/scale.h"
#include "reconstruct/cocone/rim_axes.h"
#include "reconstruct/cocone/triangle.h"
#include "reconstruct/labeled_delaunay/reconstruction.h"
#include "reconstruct/labeled_delaunay/sheet_signs.h"
#include <math.h>
#include <stdlib.h>

/* In log-odds, what the sign of a sample's sheet weighs, of an open surface or beside evidence. Chosen on scans of
 * models that nothing else was measured on. */
static const double SHEET = 3;

/* Share of what looks outwards on the hull, by area, that has to look inwards. The hull of a room, or a bowl, looks
 * inwards all over, that of ground seen from above by half; with a solid below it, as thin as the noise, the ground
 * would fall to pieces. Of an object seen from any side next to nothing does. Chosen. */
static const double INWARDS = 0.5;

/* Half the opening of the co-cones, for the first orientation: pi / 8 as in [Amenta Choi Dey Leekha 2000]. */
static const double THETA = 0.39269908169872414;

/* Gives signs to the axes, so that neighbours agree.   told  of the samples, or NULL. */
static brio_status sign_sheets(brio_reconstruction *r, const float *told) {
    brio_sheet_samples samples = {r->spacing, r->left, told};
    return brio_sign_sheets(r->ctx, &r->dual, &samples, r->turned, r->alone);
}

/* Writes the weight of each sample's vote: what evidence tells of it, and the sign of its sheet. Where places of
 * scanners see the surface at a grazing angle their signs are wrong in patches; the sheet of a patch knows better. */
static void add_sheets(const brio_reconstruction *r) {
    for (size_t p = 0; p < r->num_points; p++) {
        double sheet = r->alone[p] ? 0 : r->turned[p] ? -SHEET : SHEET, all = (double)r->own[p] + sheet;
        if (all != 0) r->turned[p] = all < 0;
        r->own[p] = (float)(all * BRIO_VOTE_UNIT);
    }
}

/* Lets evidence sign the axes, if it tells anything: each sheet by all that is told of it. At the rims of sheets axes
 * change then. */
static brio_status orient_by_evidence(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_cocones cocones = {0};
    unsigned *used = &r->stats.evidence;
    size_t candidates;
    if (!r->evidence.given.normals && !r->evidence.given.origins) return BRIO_OK;
    BRIO_TRY(brio_cocones_new(r->ctx, &r->dual, &cocones));
    BRIO_TRY(brio_cocones_select(r->ctx, &cocones, &candidates));
    BRIO_TRY(brio_weigh_evidence(r->ctx, &r->evidence, &cocones, &r->own, used));
    if (!r->own) goto done;
    brio_release(r->ctx, r->own);
    r->own = NULL;
    BRIO_TRY(brio_mend_rim_axes(r->ctx, &r->dual));
    BRIO_TRY(brio_weigh_evidence(r->ctx, &r->evidence, &cocones, &r->own, used));
    BRIO_TRY(sign_sheets(r, r->own));
    if (r->own) add_sheets(r);
done:
    brio_cocones_free(r->ctx, &cocones);
    return status;
}

/* Lets the samples of an open surface keep the signs of their sheets. */
static brio_status orient_by_sheets(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_mend_rim_axes(r->ctx, &r->dual));
    BRIO_TRY(sign_sheets(r, NULL));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, r->own, r->num_points));
    add_sheets(r);
done:
    return status;
}

brio_status brio_orient_axes(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_pole_vectors_find(r->ctx, r->delaunay, r->points, r->num_points, THETA, &r->dual));
    if (!r->turned) {
        BRIO_TRY(BRIO_ALLOC(r->ctx, r->turned, r->num_points));
        BRIO_TRY(BRIO_ALLOC(r->ctx, r->alone, r->num_points));
        BRIO_TRY(BRIO_ALLOC(r->ctx, r->outside, r->num_points));
    }
    if (r->is_open) {
        BRIO_TRY(orient_by_sheets(r));
    } else {
        BRIO_TRY(sign_sheets(r, NULL));
        BRIO_TRY(orient_by_evidence(r));
    }
    for (size_t p = 0; p < r->num_points; p++)
        for (size_t k = 0; k < 3; k++) r->outside[p][k] = (float)r->dual.plane[4 * p + k];
    brio_lap(r, &r->stats.poles_seconds);
done:
    return status;
}

/* Returns what a sample of an infinite tetrahedron tells of the side beyond its facet, by the facet's area. */
static double told_of_side(const brio_pole_vectors *v, const float *own, size_t tet, int k) {
    const uint32_t *s = v->t.tet[tet].vertex;
    double area =
        brio_triangle_area(v->points + 3 * (size_t)s[0], v->points + 3 * (size_t)s[1], v->points + 3 * (size_t)s[2]);
    double to[3];
    brio_towards_centre(v, tet, s[k], to);
    return brio_dot(to, v->plane + 4 * (size_t)s[k]) * (double)own[s[k]] * area;
}

bool brio_hull_looks_inwards(const brio_pole_vectors *v, const float *own) {
    double greatest = 0;
    int64_t inwards = 0, outwards = 0;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int k = 0; k < 3; k++) greatest = fmax(greatest, fabs(told_of_side(v, own, tet, k)));
    brio_sum_unit unit = brio_sum_unit_for(greatest, 3 * (v->t.count - v->num_finite));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int k = 0; k < 3; k++) {
            int64_t told = brio_in_units(unit, told_of_side(v, own, tet, k));
            *(told < 0 ? &inwards : &outwards) += llabs(told);
        }
    return (double)inwards > INWARDS * (double)outwards;
}

void brio_compare_with_evidence(brio_reconstruction *r) {
    brio_surface_stats *s = &r->stats;
    const float(*outside)[3] = (const float(*)[3])r->outside;
    s->normals_agreement =
        brio_evidence_agreement(&r->evidence, BRIO_EVIDENCE_NORMALS, r->points, outside, r->num_points, &s->normals);
    s->origins_agreement =
        brio_evidence_agreement(&r->evidence, BRIO_EVIDENCE_ORIGINS, r->points, outside, r->num_points, &s->origins);
    s->agreement = brio_evidence_agreement(&r->evidence, s->evidence, r->points, outside, r->num_points, &s->told);
}
