/* The labeled Delaunay triangulation: the surface between its inner and its outer tetrahedra.
 *
 *   1. The samples in canonical order, scaled by a power of two to coordinates of at most 1.
 *   2. Their Delaunay triangulation, without strays (stray_samples.c); the axis of each sample, the spacing of the
 *      samples.
 *   3. A first orientation of the samples: whether their axes point outwards, by their sheets (sheet_signs.c) and by
 *      what the file knows (cocone/sample_evidence.c).
 *   4. Labels of samples and tetrahedra of low energy: each sample votes on the side of its tetrahedra, and the area of
 *      the surface is weighed against the votes (vote_graph.c).
 *   5. Regions of a few tetrahedra are dropped. Labels change where the boundary is not one fan, at the least cost in
 *      energy (mending.c), and where little evidence holds a handle (weak_handles.c).
 *   6. If the surface proves to be open, 3 to 5 once more: the orientation of its sheets counts as evidence then, and
 *      what is beyond the hull is no longer outside by force. Where labels leave no doubt that are not the best yet,
 *      the better ones are not looked for before that.
 *   7. On request, the confidence of each sample, from the votes. What of the surface the samples do not show, and on
 *      request holes that stay open (open_surface/).
 *   8. The vertices of noisy samples are smoothed along the surface. On request, edges collapse.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009.
 *           Dey, Goswami. Tight cocone: a water-tight surface reconstructor. JCISE 2003.
 * Differs from the papers: no lines of sight; samples are unknowns, too, and their votes are weighed by log-odds that
 * were
 *                          measured on generated solids (vote_weight.c). */
#include "base/memory.h"
#include "base/sort.h"
#include "reconstruct/cocone/label_boundary.h"
#include "reconstruct/cocone/manifold_extraction.h"
#include "reconstruct/surface/method.h"
#include "reconstruct/labeled_delaunay/reconstruction.h"
#include "reconstruct/explanation/explanation.h"
#include "reconstruct/labeled_delaunay/small_regions.h"
#include "reconstruct/labeled_delaunay/surface_mesh.h"
#include "reconstruct/labeled_delaunay/vote_confidence.h"
#include "reconstruct/labeled_delaunay/vote_labels.h"
#include "reconstruct/labeled_delaunay/weak_handles.h"
#include "reconstruct/noise/smooth_surface.h"
#include "mesh/back_off.h"
#include "mesh/properties.h"
#include "triangulation/triangulation.h"
#include <math.h>
#include <string.h>

/* A region with fewer triangles than SPECK for each doubling of their number in all is a guess: crumbs of k triangles
 * get rarer the larger k is, but the more there are in all, the larger is the largest. Chosen. */
enum { SPECK = 2 };

/* Where labels that are not the best yet have proved so often that the surface is open, the best ones would, too.
 * Chosen. */
static const double CLEAR = 2;

/* Of at least MANY samples, one in FEW is asked first whether the surface is open. Chosen. */
enum { MANY = 200000, FEW = 8 };

/* Drops specks and bubbles: regions whose surface is smaller than SPECK says, and under a hundredth of all. */
static brio_status drop_specks(brio_reconstruction *r) {
    size_t all = brio_count_boundary(r->ctx, &r->dual.t, r->label), least = 0, dropped = 0;
    for (size_t n = all; n > 1; n /= 2) least += SPECK;
    brio_status status =
        brio_drop_small_regions(r->ctx, &r->dual.t, least < all / 100 ? least : all / 100, r->label, &dropped);
    r->stats.specks += dropped;
    return status;
}

/* Makes the boundary a manifold, as cheaply as possible in energy, and removes what little evidence holds. */
static brio_status mend(brio_reconstruction *r) {
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
static void take_signs(brio_reconstruction *r) {
    for (size_t p = 0; p < r->num_points; p++) r->turned[p] = r->label[r->dual.t.count + p] == BRIO_LABEL_INNER;
}

/* Finds the best labels of the tetrahedra for those of the samples, and of the samples for those of the tetrahedra. */
static brio_status vote(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->label, r->dual.t.count + r->num_points));
    BRIO_TRY(brio_vote_graph_new(r->ctx, &r->dual, r->spacing, r->left, r->own, &r->graph));
    if (r->is_closed) r->graph.num_free = r->dual.num_finite;
    BRIO_TRY(brio_vote_labels(&r->graph, r->turned, r->label));
done:
    return status;
}

static brio_status label(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_settle_labels(&r->graph, r->label, &r->stats.undecided));
    BRIO_TRY(brio_vote_energy(&r->graph, r->label, &r->stats.energy));
    brio_lap(r, &r->stats.labels_seconds);
    if (r->own && !r->is_closed) BRIO_TRY(brio_drop_hull_patches(r->ctx, &r->dual, r->label));
    BRIO_TRY(drop_specks(r));
    BRIO_TRY(mend(r));
    take_signs(r);
    for (size_t p = 0; p < r->num_points; p++)
        for (size_t k = 0; k < 3 && r->turned[p] != r->is_inverted; k++) r->outside[p][k] = -r->outside[p][k];
    brio_compare_with_evidence(r);
    brio_lap(r, &r->stats.manifold_seconds);
    if (!r->options->confidence && !r->options->explanation) brio_vote_graph_free(&r->graph);
done:
    return status;
}

/* Leaves out the facets between infinite tetrahedra: there the surface is open. */
static void drop_infinite(const brio_reconstruction *r, brio_facets *boundary) {
    size_t count = 0;
    for (size_t n = 0; n < boundary->count; n++) {
        uint32_t facet = boundary->facet[n], mate = *brio_mate(&r->dual.t, facet);
        if (brio_tet_of(facet) < r->dual.num_finite || brio_tet_of(mate) < r->dual.num_finite)
            boundary->facet[count++] = facet;
    }
    boundary->count = count;
}

/* Lists the boundary facets counterclockwise as seen from their outer tetrahedra, or from their inner ones if these
 * stand for the outside. */
static brio_status list_faces(brio_reconstruction *r, const brio_facets *boundary) {
    brio_status status = BRIO_ALLOC(r->ctx, r->faces, 3 * boundary->count);
    if (status != BRIO_OK) return status;
    for (size_t n = 0; n < boundary->count; n++) {
        uint32_t facet = boundary->facet[n];
        for (int k = 0; k < 3; k++)
            r->faces[3 * n + (size_t)(r->is_inverted ? 2 - k : k)] =
                r->dual.t.tet[brio_tet_of(facet)].vertex[BRIO_FACET[brio_slot_of(facet)][k]];
    }
    r->num_faces = boundary->count;
    return BRIO_OK;
}

/* Makes the boundary of the labels a manifold, and lists its facets. */
static brio_status find_boundary(brio_reconstruction *r, brio_facets *boundary) {
    brio_status status = BRIO_OK;
    size_t changed = 0;
    brio_tet_labels labels = {
        .dual = &r->dual, .turned = r->turned, .watertight = !r->own || r->is_closed, .label = r->label};
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

static brio_status extract(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_facets boundary = {0};
    BRIO_TRY(find_boundary(r, &boundary));
    BRIO_REQUIRE(r->ctx, boundary.count > 0, BRIO_BECAUSE(r->ctx, NO_INSIDE, BRIO_ERR_NO_ANSWER), "no inside found");
    BRIO_TRY(list_faces(r, &boundary));
    if (r->options->confidence) {
        BRIO_TRY(BRIO_ALLOC(r->ctx, r->confidence, r->num_points));
        BRIO_TRY(brio_vote_confidence(&r->graph, r->label, &boundary, r->confidence));
        if (!r->options->explanation) brio_vote_graph_free(&r->graph);
    }
    brio_lap(r, &r->stats.manifold_seconds);
done:
    brio_release(r->ctx, boundary.facet);
    return status;
}

/* Leaves holes open, and finds what the samples do not show of the rest. */
static brio_status cut_holes(brio_reconstruction *r, brio_unseen *u) {
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
static brio_status open_surface(brio_reconstruction *r) {
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
    BRIO_REQUIRE(r->ctx, r->num_faces > 0, BRIO_BECAUSE(r->ctx, ALL_HOLES, BRIO_ERR_NO_ANSWER),
                 "no surface is left: all triangles span holes");
    brio_lap(r, &r->stats.open_seconds);
done:
    return status;
}

/* Below this a vertex counts as a guess. Of such vertices of the solids that confidence was measured on, one in eight
 * (at random), one in five (noise) and four in five (sparse) were wrong. */
static const float GUESS = 0.7f;

static double share_of_guesses(const brio_mesh *mesh) {
    const float *confidence = brio_mesh_property(mesh, "confidence")->data;
    size_t count = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++) count += confidence[v] < GUESS;
    return (double)count / (double)mesh->num_vertices;
}

static brio_status make_mesh(brio_reconstruction *r, const double *points, brio_mesh *mesh, uint32_t *samples) {
    brio_status status = BRIO_OK;
    size_t used = 0;
    brio_sample_surface s = {.num_points = r->given,
                             .num_samples = r->num_points,
                             .points = points,
                             .order = r->order,
                             .placed = r->points,
                             .exponent = r->exponent,
                             .moved = r->stats.smoothed || r->stats.unrounded > 0,
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
    brio_lap(r, &r->stats.simplify_seconds);
done:
    brio_release(r->ctx, s.faces);
    return status;
}

/* Forgets the surface and what is known of it. */
static void forget_faces(brio_reconstruction *r) {
    brio_release(r->ctx, r->faces);
    brio_release(r->ctx, r->of_faces.bridge);
    brio_release(r->ctx, r->of_faces.size);
    r->of_faces = (brio_triangle_facts){0};
    r->faces = NULL;
    r->num_faces = 0;
}

/* Forgets the labels, all that they were found by, and the surface. The triangulation stays. */
static void forget_labels(brio_reconstruction *r) {
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
static brio_status look_ahead(brio_reconstruction *r) {
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
    brio_lap(r, &r->stats.labels_seconds);
    return status;
}

/* Lets a closed surface round what scanners saw from within, such as a room, bound the free space: beyond the hull is
 * the solid then. All signs change, and in the end the faces turn. */
static void invert(brio_reconstruction *r) {
    r->is_inverted = brio_hull_looks_inwards(&r->dual, r->own);
    for (size_t p = 0; p < r->num_points && r->is_inverted; p++) r->own[p] = -r->own[p], r->turned[p] ^= 1;
}

/* Finds the surface that has both, labels and holes.
 *  ahead     whether to end without one where the votes leave no doubt that it is open.
 *  from, to  of the progress `bar`. */
static brio_status find_faces(brio_reconstruction *r, bool ahead, brio_bar bar, double from, double to) {
    brio_status status = BRIO_OK;
    double step = (to - from) / 4;
    brio_progress_part(r->ctx, bar, from, from + step);
    BRIO_TRY(brio_orient_axes(r));
    if (r->own && r->is_closed) invert(r);
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

/* Finds the surface again, now that it is known to be open. Where it ends on the hull there is nothing to leave out
 * this time: the holes are still those that the closed surface had. */
static brio_status find_sheets(brio_reconstruction *r, brio_bar bar, double from, double to) {
    size_t holes = r->stats.holes, left_out = r->stats.left_out;
    r->is_open = true;
    forget_labels(r);
    brio_status status = find_faces(r, false, bar, from, to);
    if (holes > r->stats.holes) r->stats.holes = holes;
    if (left_out > r->stats.left_out) r->stats.left_out = left_out;
    return status;
}

/* Smooths the surface, as far as faces do not cross: those of a Delaunay triangulation did not. */
static brio_status smooth(brio_reconstruction *r) {
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
    brio_lap(r, &r->stats.noise_seconds);
done:
    brio_progress_part(r->ctx, bar, 0, 1);
    brio_release(r->ctx, mesh.face_offsets);
    brio_release(r->ctx, before);
    return status;
}

static void release(brio_reconstruction *r) {
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
static brio_status take_few(const brio_reconstruction *r, brio_reconstruction *few) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(r->ctx, few->points, 3 * r->num_points));
    for (size_t p = 0; p < r->num_points; p++) {
        const double *from = r->points + 3 * p;
        if (brio_position_hash(from) % FEW != 0) continue;
        memcpy(few->points + 3 * few->num_points++, from, 3 * sizeof *from);
    }
done:
    return status;
}

/* Asks a few of the samples whether the surface is open: holes that they prove all of them would prove. Otherwise
 * writes whether all are worth asking. */
static brio_status ask_few(brio_reconstruction *r, bool *maybe) {
    brio_status status = BRIO_OK;
    brio_reconstruction few = {.ctx = r->ctx,
                               .options = r->options,
                               .exponent = r->exponent,
                               .left = r->left / sqrt(FEW), /* in spacings */
                               .is_layered = r->is_layered,
                               .graph = {.ctx = r->ctx},
                               .lap = r->lap};
    *maybe = true;
    if (r->num_points < MANY) goto done;
    BRIO_TRY(take_few(r, &few));
    BRIO_TRY(brio_triangulate(r->ctx, few.points, few.num_points, 0, &few.delaunay));
    if (brio_triangulation_stats(few.delaunay)->dimension < 3) goto done;
    BRIO_TRY(brio_measure_spacing(&few, NULL));
    BRIO_TRY(brio_orient_axes(&few));
    BRIO_TRY(vote(&few));
    BRIO_TRY(look_ahead(&few));
    r->is_open = few.is_open;
    *maybe = few.proof > CLEAR / FEW;
done:
    release(&few);
    brio_lap(r, &r->stats.labels_seconds);
    return status;
}

/* Tells how the surface came to be, before its vertices are smoothed. */
static brio_status explain(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    float *confidence = NULL;
    brio_explained s = {.options = r->options,
                        .delaunay = r->delaunay,
                        .points = r->points,
                        .num_points = r->num_points,
                        .num_samples = r->num_points,
                        .order = r->order,
                        .exponent = r->exponent,
                        .theta = r->dual.theta,
                        .outside = (const float(*)[3])r->outside,
                        .label = r->label,
                        .inverted = r->is_inverted,
                        .faces = r->faces,
                        .num_faces = r->num_faces};
    BRIO_TRY(BRIO_ALLOC(r->ctx, confidence, r->dual.t.count));
    brio_tetrahedron_confidence(&r->graph, r->label, confidence);
    s.confidence = confidence;
    BRIO_TRY(brio_explain(r->ctx, &s));
done:
    brio_release(r->ctx, confidence);
    return status;
}

/* Finds the surface, and whether it is open. */
static brio_status find_surface(brio_reconstruction *r, const double *points) {
    brio_status status = BRIO_OK;
    const brio_bar bar = brio_progress_bar(r->ctx);
    bool by_itself = r->options->holes == BRIO_HOLES_AUTO && r->options->open == 0;
    bool evidence = r->evidence.given.normals || r->evidence.given.origins, maybe = true;
    BRIO_TRY(brio_take_samples(r, points));
    BRIO_TRY(brio_treat_noise(r));
    brio_progress_part(r->ctx, bar, 0, 0.4);
    BRIO_TRY(brio_triangulate_samples(r));
    BRIO_TRY(r->options->noise == BRIO_NOISE_KEEP ? brio_measure_spacing(r, NULL) : brio_drop_strays(r));
    brio_progress_part(r->ctx, bar, 0.4, 0.45);
    if (by_itself && !evidence) BRIO_TRY(ask_few(r, &maybe));
    if (!r->is_open) BRIO_TRY(find_faces(r, by_itself && maybe, bar, 0.45, by_itself ? 0.7 : 0.95));
    if (by_itself && (r->is_open || r->stats.holes > 0) && !r->own) BRIO_TRY(find_sheets(r, bar, 0.7, 0.95));
    brio_progress_part(r->ctx, bar, 0.95, 1);
    if (r->options->explanation) BRIO_TRY(explain(r));
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
    brio_reconstruction r = {.ctx = ctx,
                             .options = options,
                             .given = num_points,
                             .num_points = num_points,
                             .is_closed = options->holes == BRIO_HOLES_CLOSED && options->open == 0,
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

brio_method_fn brio_labeled_delaunay;

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
