/* The labeled Delaunay triangulation: the surface between its inner and its outer tetrahedra.
 *
 *   1. The samples in canonical order, scaled by a power of two to coordinates of at most 1.
 *   2. Their Delaunay triangulation, without strays (stray_samples.c); the axis of each sample, the spacing of the samples.
 *   3. A first orientation of the samples: whether their axes point outwards, by their sheets (sheet_signs.c) and by what the
 *      file knows (cocone/sample_evidence.c).
 *   4. Labels of samples and tetrahedra of low energy: each sample votes on the side of its tetrahedra, and the area of the
 *      surface is weighed against the votes (vote_graph.c).
 *   5. Regions of a few tetrahedra are dropped. Labels change where the boundary is not one fan, at the least cost in
 *      energy (mending.c), and where little evidence holds a handle (weak_handles.c).
 *   6. If the surface proves to be open, 3 to 5 once more: the orientation of its sheets counts as evidence then, and what is
 *      beyond the hull is no longer outside by force. Where labels leave no doubt that are not the best yet, the better ones
 *      are not looked for before that.
 *   7. On request, the confidence of each sample, from the votes. What of the surface the samples do not show, and on
 *      request holes that stay open (open_surface/).
 *   8. The vertices of noisy samples are smoothed along the surface. On request, edges collapse.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009.
 *           Dey, Goswami. Tight cocone: a water-tight surface reconstructor. JCISE 2003.
 * Differs from the papers: no lines of sight; samples are unknowns, too, and their votes are weighed by log-odds that were
 *                          measured on generated solids (vote_weight.c). */
#include "base/memory.h"
#include "base/rng.h"
#include "base/scale.h"
#include "dual/spacing.h"
#include "order/canonical_points.h"
#include "reconstruct/cocone/label_boundary.h"
#include "reconstruct/cocone/manifold_extraction.h"
#include "reconstruct/cocone/rim_axes.h"
#include "reconstruct/cocone/sample_evidence.h"
#include "reconstruct/labeled_delaunay/hull_patches.h"
#include "reconstruct/labeled_delaunay/labeled_delaunay.h"
#include "reconstruct/labeled_delaunay/sheet_signs.h"
#include "reconstruct/labeled_delaunay/small_regions.h"
#include "reconstruct/labeled_delaunay/stray_samples.h"
#include "reconstruct/labeled_delaunay/surface_mesh.h"
#include "reconstruct/labeled_delaunay/vote_confidence.h"
#include "reconstruct/labeled_delaunay/vote_labels.h"
#include "reconstruct/labeled_delaunay/weak_handles.h"
#include "reconstruct/noise/sample_noise.h"
#include "reconstruct/noise/smooth_surface.h"
#include "mesh/back_off.h"
#include "mesh/properties.h"
#include "reconstruct/open_surface/open_surface.h"
#include <math.h>
#include <string.h>

/* As brio_least_noise finds it. Surfaces of samples with more than LEAST_NOISE are smoothed: between what generated solids
 * show without noise and with a noise of 0.3 spacings in each coordinate. Samples with more than MOST_NOISE are smoothed
 * before: above all that these showed with that noise, for which the log-odds were measured. */
static const double LEAST_NOISE = 0.085, MOST_NOISE = 0.13;

/* A region with fewer triangles than SPECK for each doubling of their number in all is a guess: crumbs of k triangles get
 * rarer the larger k is, but the more there are in all, the larger is the largest. Chosen. */
enum { SPECK = 2 };

/* In log-odds, what the sign of a sample's sheet weighs, of an open surface or beside evidence. Chosen on scans of models that
 * nothing else was measured on. */
static const double SHEET = 3;

/* Half the opening of the co-cones, for the first orientation: pi / 8 as in [Amenta Choi Dey Leekha 2000]. */
static const double THETA = 0.39269908169872414;

/* Where labels that are not the best yet have proved so often that the surface is open, the best ones would, too. Chosen. */
static const double CLEAR = 2;

/* Of at least MANY samples, one in FEW is asked first whether the surface is open. Chosen. */
enum { MANY = 200000, FEW = 8 };

typedef struct {
    brio_context *ctx;
    const brio_surface_options *options;
    size_t given; /* points of the caller */
    size_t num_points;
    uint32_t *order; /* #P: the caller's index of each sample */
    int exponent;    /* coordinates are scaled by 2^-exponent */
    double *points;  /* #P by 3: the samples, in order and scaled; at the end smoothed */
    double *spacing; /* #P */
    double left;     /* the noise that the triangulated samples have */
    brio_triangulation *delaunay;
    brio_pole_vectors dual;
    uint8_t *turned, *alone; /* #P: as brio_sign_sheets writes them */
    float (*outside)[3];     /* #P: the axes, and once there are labels, which way is outside */
    brio_sample_evidence evidence;
    float *own;            /* #P, or NULL: what evidence, or their sheet, tells of the samples, in BRIO_VOTE_UNIT */
    bool is_layered;       /* most samples have a second sheet close behind theirs */
    double proof;          /* as brio_unseen has it: of the votes alone */
    bool is_open;          /* the surface proved to be open */
    brio_vote_graph graph; /* until the surface is found */
    uint8_t *label;        /* #T and #P */
    uint32_t *faces;       /* #F by 3 */
    size_t num_faces;
    float *confidence; /* #P, or NULL */
    brio_triangle_facts of_faces;
    brio_surface_stats stats;
    double lap;
} reconstruction;

/* Adds the seconds since the last call to *seconds. */
static void lap(reconstruction *r, double *seconds) {
    double now = brio_seconds();
    *seconds += now - r->lap;
    r->lap = now;
}

static brio_status take_samples(reconstruction *r, const double *points) {
    brio_status status = BRIO_OK;
    size_t n = r->num_points;
    r->exponent = brio_exponent(brio_greatest(points, 3 * n));
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->points, 3 * n));
    BRIO_TRY(brio_canonical_points(r->ctx, points, n, &r->order));
    brio_copy_points(points, r->order, n, r->points);
    BRIO_TRY(brio_scale(r->ctx, r->points, 3 * n, -r->exponent, r->points));
done:
    return status;
}

static brio_status triangulate(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_delaunay_options o = {0};
    o.seed = r->options->seed;
    BRIO_TRY(brio_delaunay(r->ctx, r->points, NULL, r->num_points, &o, &r->delaunay));
    const brio_delaunay_stats *s = brio_triangulation_stats(r->delaunay);
    r->stats.samples = s->vertices;
    BRIO_REQUIRE(r->ctx, s->dimension == 3, BRIO_ERR_NO_ANSWER, "%zu distinct points of dimension %d bound no solid",
                 s->vertices, s->dimension);
    lap(r, &r->stats.delaunay_seconds);
done:
    return status;
}

/* Measures the spacings of the samples.   second  NULL, or as brio_sample_spacing writes it. */
static brio_status measure_spacing(reconstruction *r, float *second) {
    if (!r->spacing) {
        brio_status status = BRIO_ALLOC(r->ctx, r->spacing, r->num_points);
        if (status != BRIO_OK) return status;
    }
    return brio_sample_spacing(r->ctx, r->delaunay, r->points, r->num_points, r->spacing, second);
}

/* Measures the spacing. Takes the strays out of the samples, and triangulates the others again. */
static brio_status drop_strays(reconstruction *r) {
    brio_status status = BRIO_OK;
    uint8_t *stray = NULL;
    float *second = NULL;
    size_t kept = 0;
    BRIO_TRY(BRIO_ALLOC(r->ctx, second, r->num_points));
    BRIO_TRY(measure_spacing(r, second));
    BRIO_TRY(BRIO_ALLOC(r->ctx, stray, r->num_points));
    BRIO_TRY(brio_find_strays(r->ctx, r->delaunay, r->points, r->num_points, r->spacing, second, stray));
    for (size_t p = 0; p < r->num_points; p++) r->stats.strays += stray[p];
    if (!r->stats.strays) goto done;
    for (size_t p = 0; p < r->num_points; p++) {
        if (stray[p]) continue;
        for (size_t k = 0; k < 3; k++) r->points[3 * kept + k] = r->points[3 * p + k];
        r->order[kept++] = r->order[p];
    }
    r->num_points = kept;
    brio_triangulation_free(r->delaunay);
    r->delaunay = NULL;
    BRIO_TRY(triangulate(r));
    BRIO_TRY(measure_spacing(r, NULL));
done:
    brio_release(r->ctx, stray);
    brio_release(r->ctx, second);
    return status;
}

/* Gives signs to the axes, so that neighbours agree.   told  of the samples, or NULL. */
static brio_status sign_sheets(reconstruction *r, const float *told) {
    brio_sheet_samples samples = {r->spacing, r->left, told};
    return brio_sign_sheets(r->ctx, &r->dual, &samples, r->turned, r->alone);
}

/* Writes the weight of each sample's vote: what evidence tells of it, and the sign of its sheet. Where places of scanners see the
 * surface at a grazing angle their signs are wrong in patches; the sheet of a patch knows better. */
static void add_sheets(const reconstruction *r) {
    for (size_t p = 0; p < r->num_points; p++) {
        double sheet = r->alone[p] ? 0 : r->turned[p] ? -SHEET : SHEET, all = (double)r->own[p] + sheet;
        if (all != 0) r->turned[p] = all < 0;
        r->own[p] = (float)(all * BRIO_VOTE_UNIT);
    }
}

/* Lets evidence sign the axes, if it tells anything: each sheet by all that is told of it. At the rims of sheets axes change
 * then. */
static brio_status orient_by_evidence(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_cocones cocones = {0};
    unsigned *used = &r->stats.evidence;
    size_t candidates;
    r->evidence.order = r->order;
    r->evidence.exponent = r->exponent;
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
static brio_status orient_by_sheets(reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_mend_rim_axes(r->ctx, &r->dual));
    BRIO_TRY(sign_sheets(r, NULL));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, r->own, r->num_points));
    add_sheets(r);
done:
    return status;
}

/* Finds the axes of the samples, and whether they point outwards as far as their neighbours tell. */
static brio_status orient(reconstruction *r) {
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
    lap(r, &r->stats.poles_seconds);
done:
    return status;
}

/* Drops specks and bubbles: regions whose surface is smaller than SPECK says, and under a hundredth of all. */
static brio_status drop_specks(reconstruction *r) {
    size_t all = brio_count_boundary(&r->dual.t, r->label), least = 0, dropped = 0;
    for (size_t n = all; n > 1; n /= 2) least += SPECK;
    brio_status status =
        brio_drop_small_regions(r->ctx, &r->dual.t, least < all / 100 ? least : all / 100, r->label, &dropped);
    r->stats.specks += dropped;
    return status;
}

/* Makes the boundary a manifold, as cheaply as possible in energy, and removes what little evidence holds. */
static brio_status mend(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_label_flips flips = {.ctx = r->ctx};
    brio_mending mending = {.flips = &flips};
    BRIO_TRY(brio_label_flips_new(&r->graph, r->label, &flips));
    BRIO_TRY(brio_mending_new(&flips, &mending));
    BRIO_TRY(brio_mend(&mending));
    BRIO_TRY(brio_remove_weak_handles(&mending, &r->stats.handles));
    brio_label_samples(&flips);
    r->stats.relabeled = flips.size;
done:
    brio_mending_free(&mending);
    brio_label_flips_free(&flips);
    return status;
}

/* Takes from the labels whether the axes of the samples point inwards. */
static void take_signs(reconstruction *r) {
    for (size_t p = 0; p < r->num_points; p++) r->turned[p] = r->label[r->dual.t.count + p] == BRIO_LABEL_INNER;
}

/* Finds the best labels of the tetrahedra for those of the samples, and of the samples for those of the tetrahedra. */
static brio_status vote(reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->label, r->dual.t.count + r->num_points));
    BRIO_TRY(brio_vote_graph_new(r->ctx, &r->dual, r->spacing, r->left, r->own, &r->graph));
    BRIO_TRY(brio_vote_labels(&r->graph, r->turned, r->label));
done:
    return status;
}

/* Tells how well the result agrees with evidence, be it of use or not. */
static void compare_with_evidence(reconstruction *r) {
    brio_surface_stats *s = &r->stats;
    const float(*outside)[3] = (const float(*)[3])r->outside;
    s->normals_agreement =
        brio_evidence_agreement(&r->evidence, BRIO_EVIDENCE_NORMALS, r->points, outside, r->num_points, &s->normals);
    s->origins_agreement =
        brio_evidence_agreement(&r->evidence, BRIO_EVIDENCE_ORIGINS, r->points, outside, r->num_points, &s->origins);
    s->agreement = brio_evidence_agreement(&r->evidence, s->evidence, r->points, outside, r->num_points, &s->told);
}

static brio_status label(reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_settle_labels(&r->graph, r->label, &r->stats.undecided));
    BRIO_TRY(brio_vote_energy(&r->graph, r->label, &r->stats.energy));
    lap(r, &r->stats.labels_seconds);
    if (r->own) BRIO_TRY(brio_drop_hull_patches(r->ctx, &r->dual, r->label));
    BRIO_TRY(drop_specks(r));
    BRIO_TRY(mend(r));
    take_signs(r);
    for (size_t p = 0; p < r->num_points; p++)
        for (size_t k = 0; k < 3 && r->turned[p]; k++) r->outside[p][k] = -r->outside[p][k];
    compare_with_evidence(r);
    lap(r, &r->stats.manifold_seconds);
    if (!r->options->confidence) brio_vote_graph_free(&r->graph);
done:
    return status;
}

/* Leaves out the facets between infinite tetrahedra: there the surface is open. */
static void drop_infinite(const reconstruction *r, brio_facets *boundary) {
    size_t count = 0;
    for (size_t n = 0; n < boundary->count; n++) {
        uint32_t facet = boundary->facet[n], mate = *brio_mate(&r->dual.t, facet);
        if (brio_tet_of(facet) < r->dual.num_finite || brio_tet_of(mate) < r->dual.num_finite)
            boundary->facet[count++] = facet;
    }
    boundary->count = count;
}

/* Lists the boundary facets counterclockwise as seen from their outer tetrahedra. */
static brio_status list_faces(reconstruction *r, const brio_facets *boundary) {
    brio_status status = BRIO_ALLOC(r->ctx, r->faces, 3 * boundary->count);
    if (status != BRIO_OK) return status;
    for (size_t n = 0; n < boundary->count; n++) {
        uint32_t facet = boundary->facet[n];
        for (int k = 0; k < 3; k++)
            r->faces[3 * n + (size_t)k] = r->dual.t.tet[brio_tet_of(facet)].vertex[BRIO_FACET[brio_slot_of(facet)][k]];
    }
    r->num_faces = boundary->count;
    return BRIO_OK;
}

/* Makes the boundary of the labels a manifold, and lists its facets. */
static brio_status find_boundary(reconstruction *r, brio_facets *boundary) {
    brio_status status = BRIO_OK;
    size_t changed = 0;
    brio_tet_labels labels = {.dual = &r->dual, .turned = r->turned, .watertight = !r->own, .label = r->label};
    BRIO_TRY(brio_make_manifold(r->ctx, &labels, boundary, &changed));
    r->stats.relabeled += changed;
    BRIO_TRY(drop_specks(r));
    brio_release(r->ctx, boundary->facet);
    *boundary = (brio_facets){0};
    BRIO_TRY(brio_boundary_facets(r->ctx, &labels, boundary));
    drop_infinite(r, boundary);
done:
    return status;
}

static brio_status extract(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_facets boundary = {0};
    BRIO_TRY(find_boundary(r, &boundary));
    BRIO_REQUIRE(r->ctx, boundary.count > 0, BRIO_ERR_NO_ANSWER, "no inside found");
    BRIO_TRY(list_faces(r, &boundary));
    if (r->options->confidence) {
        BRIO_TRY(BRIO_ALLOC(r->ctx, r->confidence, r->num_points));
        BRIO_TRY(brio_vote_confidence(&r->graph, r->label, &boundary, r->confidence));
        brio_vote_graph_free(&r->graph);
    }
    lap(r, &r->stats.manifold_seconds);
done:
    brio_release(r->ctx, boundary.facet);
    return status;
}

/* Leaves holes open, and finds what the samples do not show of the rest. */
static brio_status cut_holes(reconstruction *r, brio_unseen *u) {
    brio_status status = BRIO_OK;
    const brio_surface_options *o = r->options;
    float(*scanner)[3] = NULL;
    if (r->stats.evidence & BRIO_EVIDENCE_ORIGINS)
        BRIO_TRY(brio_scanner_directions(r->ctx, &r->evidence, r->points, r->num_points, &scanner));
    brio_sample_points samples = {r->ctx, r->points, r->num_points, r->own ? (const float(*)[3])r->outside : NULL,
                                  (const float(*)[3])scanner};
    brio_hole_rule rule = {.choice = o->holes == BRIO_HOLES_AUTO ? BRIO_HOLES_SEEN : BRIO_HOLES_FILL,
                           .proven = r->is_open,
                           .layered = r->is_layered && !r->own};
    if (o->open > 0) rule = (brio_hole_rule){.choice = BRIO_HOLES_WIDER, .most = o->open};
    BRIO_TRY(brio_open_surface(&samples, &rule, r->faces, &r->num_faces, &r->of_faces, u));
done:
    brio_release(r->ctx, scanner);
    return status;
}

/* Finds what the samples do not show, and leaves holes open on request. */
static brio_status open_surface(reconstruction *r) {
    brio_status status = BRIO_OK;
    size_t before = r->num_faces;
    brio_unseen u;
    BRIO_TRY(cut_holes(r, &u));
    r->stats.left_out = before - r->num_faces;
    r->stats.holes = u.holes;
    r->stats.bridges = u.bridges;
    r->stats.bridge_share = u.bridge_share;
    r->stats.far_share = u.far_share;
    r->stats.bridge_radius = ldexp(u.largest_radius, r->exponent);
    for (size_t k = 0; k < 3; k++) r->stats.bridge_centre[k] = ldexp(u.largest_centre[k], r->exponent);
    BRIO_REQUIRE(r->ctx, r->num_faces > 0, BRIO_ERR_NO_ANSWER, "no surface is left: all triangles span holes");
    lap(r, &r->stats.open_seconds);
done:
    return status;
}

/* Below this a vertex counts as a guess. Of such vertices of the solids that confidence was measured on, one in eight (at
 * random), one in five (noise) and four in five (sparse) were wrong. */
static const float GUESS = 0.7f;

static double share_of_guesses(const brio_mesh *mesh) {
    const float *confidence = brio_mesh_property(mesh, "confidence")->data;
    size_t count = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++) count += confidence[v] < GUESS;
    return (double)count / (double)mesh->num_vertices;
}

static brio_status make_mesh(reconstruction *r, const double *points, brio_mesh *mesh, uint32_t *samples) {
    brio_status status = BRIO_OK;
    size_t used = 0;
    brio_sample_surface s = {.num_points = r->given,
                             .num_samples = r->num_points,
                             .points = points,
                             .order = r->order,
                             .placed = r->points,
                             .exponent = r->exponent,
                             .moved = r->stats.smoothed,
                             .spacing = r->spacing,
                             .confidence = r->confidence,
                             .bridge = r->of_faces.bridge,
                             .size = r->of_faces.size,
                             .simplify = r->options->simplify != 0,
                             .faces = r->faces,
                             .num_faces = r->num_faces};
    r->faces = NULL;
    BRIO_TRY(brio_surface_mesh(&s, mesh, samples, &used));
    r->stats.unused = r->stats.samples - used;
    if (r->confidence) r->stats.uncertain_share = share_of_guesses(mesh);
    lap(r, &r->stats.simplify_seconds);
done:
    brio_release(r->ctx, s.faces);
    return status;
}

/* Measures the noise. Where it is beyond what the log-odds were measured for, such as where scans do not fit together,
 * smooths the samples before they are triangulated. */
static brio_status treat_noise(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_noise how = r->options->noise;
    brio_least_scatter scatter;
    BRIO_TRY(brio_least_noise(r->ctx, r->points, r->num_points, &scatter));
    r->left = r->stats.noise = scatter.level;
    r->is_layered = scatter.layered;
    r->stats.smoothed = how == BRIO_NOISE_SMOOTH || (how == BRIO_NOISE_AUTO && r->stats.noise > LEAST_NOISE);
    if (r->stats.smoothed && r->stats.noise > MOST_NOISE && !(how == BRIO_NOISE_AUTO && scatter.layered)) {
        BRIO_TRY(brio_smooth_samples(r->ctx, r->points, r->num_points));
        BRIO_TRY(brio_least_noise(r->ctx, r->points, r->num_points, &scatter));
        r->left = scatter.level;
    }
    lap(r, &r->stats.noise_seconds);
done:
    return status;
}

/* Forgets the surface and what is known of it. */
static void forget_faces(reconstruction *r) {
    brio_release(r->ctx, r->faces);
    brio_release(r->ctx, r->of_faces.bridge);
    brio_release(r->ctx, r->of_faces.size);
    r->of_faces = (brio_triangle_facts){0};
    r->faces = NULL;
    r->num_faces = 0;
}

/* Forgets the labels, all that they were found by, and the surface. The triangulation stays. */
static void forget_labels(reconstruction *r) {
    brio_vote_graph_free(&r->graph);
    brio_pole_vectors_free(r->ctx, &r->dual);
    brio_release(r->ctx, r->label);
    brio_release(r->ctx, r->confidence);
    r->dual = (brio_pole_vectors){0};
    r->label = NULL, r->confidence = NULL;
    forget_faces(r);
    r->stats.specks = r->stats.handles = 0;
}

/* Looks whether the votes leave no doubt that the surface is open. Works on a copy of the labels. */
static brio_status look_ahead(reconstruction *r) {
    brio_status status = BRIO_OK;
    const brio_surface_stats before = r->stats;
    const double begun = r->lap;
    size_t size = r->dual.t.count + r->num_points, holes = 0, left_out = 0, num_faces;
    uint8_t *label = r->label;
    brio_facets boundary = {0};
    brio_unseen u;
    r->label = NULL;
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->label, size));
    memcpy(r->label, label, size);
    BRIO_TRY(drop_specks(r));
    take_signs(r);
    BRIO_TRY(find_boundary(r, &boundary));
    if (boundary.count == 0) goto done;
    BRIO_TRY(list_faces(r, &boundary));
    num_faces = r->num_faces;
    BRIO_TRY(cut_holes(r, &u));
    r->proof = u.proof;
    r->is_open = u.holes > 0 && u.proof > CLEAR;
    if (r->is_open) holes = u.holes, left_out = num_faces - r->num_faces;
done:
    brio_release(r->ctx, boundary.facet);
    brio_release(r->ctx, r->label);
    r->label = label;
    forget_faces(r);
    r->stats = before;
    r->stats.holes = holes, r->stats.left_out = left_out;
    r->lap = begun;
    lap(r, &r->stats.labels_seconds);
    return status;
}

/* Finds the surface that has both, labels and holes.
 *  ahead     whether to end without one where the votes leave no doubt that it is open.
 *  from, to  of the progress `bar`. */
static brio_status find_faces(reconstruction *r, bool ahead, brio_bar bar, double from, double to) {
    brio_status status = BRIO_OK;
    double step = (to - from) / 4;
    brio_progress_part(r->ctx, bar, from, from + step);
    BRIO_TRY(orient(r));
    brio_progress_part(r->ctx, bar, from + step, from + 2 * step);
    BRIO_TRY(vote(r));
    if (ahead && !r->own) BRIO_TRY(look_ahead(r));
    if (ahead && r->is_open) goto done;
    brio_progress_part(r->ctx, bar, from + 2 * step, from + 3 * step);
    BRIO_TRY(label(r));
    brio_progress_part(r->ctx, bar, from + 3 * step, to);
    BRIO_TRY(extract(r));
    BRIO_TRY(open_surface(r));
done:
    return status;
}

/* Finds the surface again, now that it is known to be open. Where it ends on the hull there is nothing to leave out this time:
 * the holes are still those that the closed surface had. */
static brio_status find_sheets(reconstruction *r, brio_bar bar, double from, double to) {
    size_t holes = r->stats.holes, left_out = r->stats.left_out;
    r->is_open = true;
    forget_labels(r);
    brio_status status = find_faces(r, false, bar, from, to);
    if (holes > r->stats.holes) r->stats.holes = holes;
    if (left_out > r->stats.left_out) r->stats.left_out = left_out;
    return status;
}

/* Smooths the surface, as far as faces do not cross: those of a Delaunay triangulation did not. */
static brio_status smooth(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_mesh mesh = {.size = sizeof mesh,
                      .context = r->ctx,
                      .num_vertices = r->num_points,
                      .vertices = r->points,
                      .num_faces = r->num_faces,
                      .face_vertices = r->faces};
    double *before = NULL;
    const brio_bar bar = brio_progress_bar(r->ctx);
    BRIO_TRY(BRIO_ALLOC(r->ctx, mesh.face_offsets, r->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(r->ctx, before, 3 * r->num_points));
    for (size_t f = 0; f <= r->num_faces; f++) mesh.face_offsets[f] = 3 * f;
    memcpy(before, r->points, 3 * r->num_points * sizeof *before);
    brio_progress_part(r->ctx, bar, 0, 0.5);
    BRIO_TRY(brio_smooth_surface(r->ctx, r->points, r->num_points, r->faces, r->num_faces));
    brio_progress_part(r->ctx, bar, 0.5, 1);
    BRIO_TRY(brio_back_off(r->ctx, &mesh, before, NULL));
    lap(r, &r->stats.noise_seconds);
done:
    brio_progress_part(r->ctx, bar, 0, 1);
    brio_release(r->ctx, mesh.face_offsets);
    brio_release(r->ctx, before);
    return status;
}

static void release(reconstruction *r) {
    brio_vote_graph_free(&r->graph);
    brio_pole_vectors_free(r->ctx, &r->dual);
    brio_triangulation_free(r->delaunay);
    brio_release(r->ctx, r->order);
    brio_release(r->ctx, r->points);
    brio_release(r->ctx, r->spacing);
    brio_release(r->ctx, r->turned);
    brio_release(r->ctx, r->alone);
    brio_release(r->ctx, r->outside);
    brio_release(r->ctx, r->own);
    brio_release(r->ctx, r->label);
    brio_release(r->ctx, r->faces);
    brio_release(r->ctx, r->confidence);
    brio_release(r->ctx, r->of_faces.bridge);
    brio_release(r->ctx, r->of_faces.size);
}

/* Copies about one in FEW of the samples, chosen by their positions. */
static brio_status take_few(const reconstruction *r, reconstruction *few) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(r->ctx, few->points, 3 * r->num_points));
    for (size_t p = 0; p < r->num_points; p++) {
        const double *from = r->points + 3 * p;
        uint64_t hash = 0;
        for (size_t k = 0; k < 3; k++) hash = brio_hash(hash, brio_double_key(from[k]));
        if (hash % FEW != 0) continue;
        memcpy(few->points + 3 * few->num_points++, from, 3 * sizeof *from);
    }
done:
    return status;
}

/* Asks a few of the samples whether the surface is open: holes that they prove all of them would prove. Otherwise writes
 * whether all are worth asking. */
static brio_status ask_few(reconstruction *r, bool *maybe) {
    brio_status status = BRIO_OK;
    reconstruction few = {.ctx = r->ctx,
                          .options = r->options,
                          .exponent = r->exponent,
                          .left = r->left / sqrt(FEW), /* in spacings */
                          .is_layered = r->is_layered,
                          .graph = {.ctx = r->ctx},
                          .lap = r->lap};
    *maybe = true;
    if (r->num_points < MANY) goto done;
    BRIO_TRY(take_few(r, &few));
    BRIO_TRY(brio_delaunay(r->ctx, few.points, NULL, few.num_points, NULL, &few.delaunay));
    if (brio_triangulation_stats(few.delaunay)->dimension < 3) goto done;
    BRIO_TRY(measure_spacing(&few, NULL));
    BRIO_TRY(orient(&few));
    BRIO_TRY(vote(&few));
    BRIO_TRY(look_ahead(&few));
    r->is_open = few.is_open;
    *maybe = few.proof > CLEAR / FEW;
done:
    release(&few);
    lap(r, &r->stats.labels_seconds);
    return status;
}

/* Finds the surface, and whether it is open. */
static brio_status find_surface(reconstruction *r, const double *points) {
    brio_status status = BRIO_OK;
    const brio_bar bar = brio_progress_bar(r->ctx);
    bool by_itself = r->options->holes == BRIO_HOLES_AUTO && r->options->open == 0;
    bool evidence = r->evidence.given.normals || r->evidence.given.origins, maybe = true;
    BRIO_TRY(take_samples(r, points));
    BRIO_TRY(treat_noise(r));
    brio_progress_part(r->ctx, bar, 0, 0.4);
    BRIO_TRY(triangulate(r));
    BRIO_TRY(r->options->noise == BRIO_NOISE_KEEP ? measure_spacing(r, NULL) : drop_strays(r));
    brio_progress_part(r->ctx, bar, 0.4, 0.45);
    if (by_itself && !evidence) BRIO_TRY(ask_few(r, &maybe));
    if (!r->is_open) BRIO_TRY(find_faces(r, by_itself && maybe, bar, 0.45, by_itself ? 0.7 : 0.95));
    if (by_itself && (r->is_open || r->stats.holes > 0) && !r->own) BRIO_TRY(find_sheets(r, bar, 0.7, 0.95));
    brio_progress_part(r->ctx, bar, 0.95, 1);
    if (r->stats.smoothed) BRIO_TRY(smooth(r));
done:
    brio_progress_part(r->ctx, bar, 0, 1);
    return status;
}

/* Fills the mesh.   samples  #P: receives the sample of each vertex. */
static brio_status reconstruct(brio_context *ctx, const double *points, size_t num_points,
                               const brio_surface_options *options, brio_mesh *mesh, uint32_t *samples,
                               brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    reconstruction r = {.ctx = ctx,
                        .options = options,
                        .given = num_points,
                        .num_points = num_points,
                        .graph = {.ctx = ctx},
                        .lap = brio_seconds()};
    const brio_bar bar = brio_progress_bar(ctx);
    BRIO_TRY(brio_take_evidence(ctx, options->evidence, num_points, &r.evidence));
    brio_progress_part(ctx, bar, 0, options->simplify ? 0.8 : 1);
    BRIO_TRY(find_surface(&r, points));
    brio_progress_part(ctx, bar, 0.8, 1);
    BRIO_TRY(make_mesh(&r, points, mesh, samples));
done:
    brio_progress_part(ctx, bar, 0, 1);
    *stats = r.stats;
    release(&r);
    return status;
}

brio_status brio_labeled_delaunay(brio_context *ctx, const double *points, size_t num_points,
                                  const brio_surface_options *options, brio_mesh *mesh, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    uint32_t *samples = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, samples, num_points));
    BRIO_TRY(reconstruct(ctx, points, num_points, options, mesh, samples, stats));
    BRIO_TRY(brio_mesh_add_samples(mesh, num_points, samples));
    if (options->normals) BRIO_TRY(brio_point_normals(ctx, points, num_points, mesh, samples, options->normals));
done:
    brio_release(ctx, samples);
    return status;
}
