/* brio surface: a surface through the points of a file, with its certificate. */
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/run/run.h"
#include "cli/steps/certificate.h"
#include "cli/steps/coverage.h"
#include "cli/steps/curve.h"
#include "cli/steps/estimate.h"
#include "cli/steps/evidence.h"
#include "cli/steps/hints.h"
#include "cli/steps/power_crust.h"
#include "cli/steps/properties.h"
#include "cli/steps/selection.h"
#include "cli/steps/tiles.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the command --- */

/* The methods of the library, and CURVES. NO_METHOD: not given; then it is the default of the library, or the power
 * crust if an option of its alone is given; of points in a plane, curves. */
enum { NO_METHOD = -1, CURVES = BRIO_SURFACE_END };
enum { NO_LABELING = -1 };

typedef struct arguments {
    int method;
    power_crust_options crust;
    bool curves, polygons, boundaries, density, vertex_normals, self_intersections, explain;
    double theta;           /* 0: not given */
    uint64_t pieces, tiles; /* 0: not given */
    int extraction;
    component_options components;
    evidence_options evidence;
    const char *left_out; /* file for the points that the surface leaves */
} arguments;

/* What is known of a surface before it is looked at. */
typedef struct {
    bool open;        /* it may end where the points do */
    bool leaves_many; /* samples on no face are enough in number for those left out to be counted */
} outcome;

static const option_choice no_surfaces[] = {{"curves", CURVES}, {NULL, 0}};

static const option_choice extractions[] = {{"labels", BRIO_EXTRACTION_LABELS},
                                            {"candidates", BRIO_EXTRACTION_CANDIDATES},
                                            {"pruned", BRIO_EXTRACTION_PRUNED},
                                            {"walk", BRIO_EXTRACTION_WALK},
                                            {NULL, 0}};

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    {"method", 0, OPTION_METHOD, FIELD(method), "NAME", "how to reconstruct (default labeled-delaunay)", no_surfaces},
    {"curves", 0, OPTION_NOTE, 0, NULL, "polylines, with corners and ends; the default of points in a plane", 0},
    {"curves", 0, OPTION_FLAG, FIELD(curves), NULL, "the same as --method curves", 0},
    COMPONENT_ROWS(arguments, components),
    {"vertex-normals", 0, OPTION_FLAG, FIELD(vertex_normals), NULL, "give the vertices normals, as properties nx ny nz",
     0},
    {"self-intersections", 0, OPTION_FLAG, FIELD(self_intersections), NULL,
     "count the pairs of faces that run through each other", 0},
    {"left-out", 0, OPTION_OUTPUT, FIELD(left_out), "FILE",
     "write the points that the surface leaves more than two spacings away", 0},
    {"explain", 0, OPTION_FLAG, FIELD(explain), NULL,
     "with --view: the page also shows how the surface came to be at each sample, or at 5,000 of them", 0},
    {"normals", 0, OPTION_OUTPUT, FIELD(crust.normals), "FILE", "also write the points with oriented normals", 0},
    {"", 0, OPTION_TITLE, 0, NULL, "options of labeled-delaunay and power-crust", 0},
    SOLID_ROWS(arguments, crust),
    {"", 0, OPTION_TITLE, 0, NULL, "options of labeled-delaunay, cocone and tight-cocone", 0},
    EVIDENCE_ROWS(arguments, evidence),
    {"", 0, OPTION_TITLE, 0, NULL, "options of labeled-delaunay", 0},
    TILES_ROWS(arguments, tiles),
    {"", 0, OPTION_TITLE, 0, NULL, "options of power-crust (each of them chooses it)", 0},
    POWER_CRUST_ROWS(arguments, crust),
    {"polygons", 0, OPTION_FLAG, FIELD(polygons), NULL, "write its polygons, not cut into triangles", 0},
    {"", 0, OPTION_TITLE, 0, NULL, "options of cocone and tight-cocone", 0},
    {"theta", 0, OPTION_NUMBER | OPTION_POSITIVE, FIELD(theta), "ANGLE",
     "half the opening of the co-cones, radians (default pi/8)", 0},
    {"boundaries", 0, OPTION_FLAG, FIELD(boundaries), NULL,
     "leave the surface open at the points found at boundaries, also where these are over 15 % of all", 0},
    {"density", 0, OPTION_FLAG, FIELD(density), NULL,
     "estimate how densely the points sample the surface, also in properties of the vertices", 0},
    {"", 0, OPTION_TITLE, 0, NULL, "options of cocone", 0},
    {"pieces", 0, OPTION_NATURAL | OPTION_POSITIVE, FIELD(pieces), "N",
     "work through about N parts one after the other, in less memory", 0},
    {"extraction", 0, OPTION_CHOICE, FIELD(extraction), "NAME",
     "which candidate triangles make the surface (default labels)", extractions},
    {"labels", 0, OPTION_NOTE, 0, NULL, "those between inside and outside: a manifold", 0},
    {"candidates", 0, OPTION_NOTE, 0, NULL, "all of them", 0},
    {"pruned", 0, OPTION_NOTE, 0, NULL, "all but those at sharp edges", 0},
    {"walk", 0, OPTION_NOTE, 0, NULL, "the outer ones of these, found by a walk, as in the dissertation", 0},
    {0},
};
#undef FIELD

static const arguments defaults = {.method = NO_METHOD, .crust.labeling = NO_LABELING};
/* The least theta that theorem 22 needs: r + 2 arcsin(r / (1 - r)) at r = 0.08. */
static const double LEAST_THETA = 0.2542;

/* Returns whether there are options of the power crust alone. */
static bool has_power_crust_options(const arguments *a) {
    return a->polygons || a->crust.labeling != NO_LABELING || a->crust.sampling_density != 0 || a->crust.sharp;
}

/* Returns a brio_surface_method, or CURVES. */
static int method_of(const arguments *a) {
    if (a->curves) return CURVES;
    return a->method != NO_METHOD       ? a->method
           : has_power_crust_options(a) ? BRIO_SURFACE_POWER_CRUST
                                        : BRIO_SURFACE_LABELED;
}

static const char *name_of(int method) {
    return method == CURVES ? "curves" : brio_surface_method_facts((brio_surface_method)method)->name;
}

static bool is(int method, unsigned trait) {
    return method != CURVES && brio_surface_method_facts((brio_surface_method)method)->traits & trait;
}

/* Returns whether a method has an option of the library; NULL is one that all surfaces have. */
static bool has(int method, const char *name) {
    return method != CURVES && (!name || brio_surface_method_has((brio_surface_method)method, name));
}

/* Completes the surface: normals, the properties of its points, fewer components. Reports what it then has.
 * samples  the point of each vertex; NULL where no vertex is a point.   num_samples  distinct positions. */
static brio_status complete(run *r, const brio_mesh *points, const uint32_t *samples, size_t num_samples,
                            brio_mesh *surface) {
    const arguments *a = r->arguments;
    int method = method_of(a);
    size_t dropped[2];
    if (a->vertex_normals || method == BRIO_SURFACE_LABELED) FORWARD(brio_mesh_add_normals(surface));
    FORWARD(cli_carry_properties(r, points, samples, surface));
    FORWARD(cli_keep_components(r, &a->components, surface, dropped));
    while (a->crust.triangulate && surface->num_face_properties > 0)
        brio_mesh_remove_face_property(surface, surface->face_properties[0].name);
    cli_fact_text(&r->facts, "method", name_of(method));
    cli_fact_count(&r->facts, "samples", num_samples);
    cli_fact_count(&r->facts, "vertices", surface->num_vertices);
    cli_fact_count(&r->facts, "faces", surface->num_faces);
    cli_report_dropped(r, &a->components, dropped);
    return BRIO_OK;
}

/* --- the power crust --- */

static power_crust_options crust_of(const arguments *a) {
    power_crust_options o = a->crust;
    o.triangulate = !a->polygons;
    if (o.labeling == NO_LABELING) o.labeling = BRIO_LABELING_GLOBAL;
    return o;
}

static void report_power_crust_stages(run *r, const brio_surface_stats *s) {
    power_crust_options o = crust_of(r->arguments);
    cli_report_power_crust_stages(r, &o, s);
}

static void report_power_crust(run *r, const brio_surface_stats *s) {
    power_crust_options o = crust_of(r->arguments);
    cli_report_power_crust(r, &o, s);
}

/* --- the co-cones --- */

/* Returns how brio_cocone treats boundaries. */
static int ways_with_boundaries(const arguments *a) {
    bool by_itself = a->method == BRIO_SURFACE_COCONE && a->pieces <= 1 && a->extraction == BRIO_EXTRACTION_LABELS;
    return a->boundaries ? 1 : by_itself ? BRIO_BOUNDARIES_AUTO : 0;
}

/* Over this median of r the user is told that the points hardly show the surface. Measured: points all over a cube or a
 * ball, with no surface at all, have a median of 1.05; of 60 sets with a surface those that came out right had at most
 * 0.69, and those that came out with wrong handles or pieces at least 0.75. Where r is over 0.08 only the guarantee
 * ends, and nearly every scan is there; at sharp edges, where the feature size is 0, r is large for any sampling. */
static const double MOST_R = 0.75;

/* Reports the sampling condition of the guarantee (theorem 19: r <= 0.08), as far as the samples themselves tell. */
static void report_density(run *r, const brio_surface_stats *s) {
    facts *f = &r->facts;
    size_t used = s->samples - s->unused;
    double share = used ? (double)s->outside_guarantee / (double)used : 0;
    cli_fact_open(f, "sampling", FACT_OBJECT);
    cli_fact_real(f, "r_median", s->r_median);
    cli_fact_real(f, "r_p95", s->r_p95);
    cli_fact_count(f, "outside_guarantee", s->outside_guarantee);
    cli_fact_real(f, "outside_share", share);
    cli_fact_close(f);
    if (s->r_median > MOST_R) cli_warn(r, WARNING_DENSITY, s->r_median);
}

static bool estimates_density(const run *r) {
    const arguments *a = r->arguments;
    return a->density || (r->common.json && a->extraction == BRIO_EXTRACTION_LABELS);
}

static void report_cocone_stages(run *r, const brio_surface_stats *s) {
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "poles", s->poles_seconds);
    cli_stage(r, "candidates", s->candidates_seconds);
    cli_stage(r, "label", s->labels_seconds);
    cli_stage(r, "manifold", s->manifold_seconds);
    cli_stage(r, "density", s->density_seconds);
}

static void report_cocone(run *r, const brio_surface_stats *s) {
    const arguments *a = r->arguments;
    facts *f = &r->facts;
    cli_fact_count(f, "unused", s->unused);
    cli_fact_count(f, "candidates", s->candidates);
    cli_fact_count(f, "pruned", s->pruned);
    cli_fact_text(f, "extraction", extractions[a->extraction].name);
    if (ways_with_boundaries(a)) cli_fact_count(f, "boundary_samples", s->boundary_samples);
    cli_fact_count(f, "relabeled", s->relabeled);
    if (a->pieces > 1) {
        cli_fact_count(f, "pieces", s->pieces);
        cli_fact_count(f, "unmatched", s->unmatched);
    }
    if (estimates_density(r)) report_density(r, s);
}

/* --- the labeled Delaunay triangulation --- */

/* Over this share of guesses the user is told. Chosen. */
static const double MANY_GUESSES = 0.02;

/* Over this share of samples on no face it is counted how many of them the surface leaves. Chosen: smaller shares are
 * strays and samples beside others. */
static const double MANY_UNUSED = 0.005;

static void report_confidence(run *r, double share) {
    cli_fact_real(&r->facts, "uncertain_share", share);
    if (share > MANY_GUESSES) cli_warn(r, WARNING_GUESS, 100 * share);
}

/* Reports what tells the outside, and how well it agrees with the result. */
static void report_orientation(run *r, const brio_surface_stats *s) {
    static const char *const by[] = {"guess", "normals", "scanner", "evidence"};
    cli_fact_text(&r->facts, "orientation", by[s->evidence & 3]);
    if (s->evidence) cli_fact_real(&r->facts, "agreement", s->agreement);
    const struct {
        const char *name, *words;
        unsigned kind;
        size_t told;
        double share;
    } kinds[] = {{"normals_agreement", "normals", BRIO_EVIDENCE_NORMALS, s->normals, s->normals_agreement},
                 {"origins_agreement", "scanners' places", BRIO_EVIDENCE_ORIGINS, s->origins, s->origins_agreement}};
    for (int k = 0; k < 2; k++) {
        bool aside = !(s->evidence & kinds[k].kind);
        if (!kinds[k].told) continue;
        cli_fact_real(&r->facts, kinds[k].name, kinds[k].share);
        if (aside) cli_warn(r, WARNING_ASIDE, kinds[k].words, 100 * kinds[k].share);
    }
}

/* Warns of bridges over a share of the area, and of guesses. */
static void report_unseen(run *r, const brio_surface_stats *s) {
    const power_crust_options *a = &((const arguments *)r->arguments)->crust;
    bool automatic = !a->closed && (!a->open || strcmp(a->open, "auto") == 0);
    facts *f = &r->facts;
    cli_fact_count(f, "strays", s->strays);
    cli_fact_count(f, "holes", s->holes);
    if (s->holes) cli_fact_count(f, "left_out", s->left_out);
    cli_fact_open(f, "bridges", FACT_OBJECT);
    cli_fact_count(f, "number", s->bridges);
    cli_fact_real(f, "area_share", s->bridge_share);
    cli_fact_real(f, "largest_radius", s->bridge_radius);
    cli_fact_open(f, "largest_centre", FACT_LIST);
    for (int k = 0; k < 3; k++) cli_fact_real(f, NULL, s->bridge_centre[k]);
    cli_fact_close(f);
    cli_fact_close(f);
    cli_fact_real(f, "far_area_percent", 100 * s->far_share);
    if (s->bridge_share > MANY_GUESSES)
        cli_warn(r, WARNING_BRIDGES, 100 * s->bridge_share, s->bridges, s->bridge_centre[0], s->bridge_centre[1],
                 s->bridge_centre[2], 2 * s->bridge_radius,
                 automatic ? "K leaves out what is wider than K spacings" : "auto leaves out what was not seen");
}

static void report_labeled_delaunay(run *r, const brio_surface_stats *s) {
    facts *f = &r->facts;
    cli_report_noise(r, s->noise, s->smoothed);
    cli_fact_real(f, "rounding", s->rounding);
    if (s->rounding > 0) cli_warn(r, WARNING_STEPS, s->rounding, s->unrounded);
    cli_fact_count(f, "unused", s->unused);
    cli_fact_count(f, "undecided", s->undecided);
    cli_fact_count(f, "specks", s->specks);
    cli_fact_count(f, "relabeled", s->relabeled);
    cli_fact_count(f, "handles", s->handles);
    report_unseen(r, s);
    cli_fact_real(f, "energy", s->energy);
    report_confidence(r, s->uncertain_share);
    report_orientation(r, s);
}

static void report_labeled_delaunay_stages(run *r, const brio_surface_stats *s) {
    const arguments *a = r->arguments;
    cli_stage(r, "noise", s->noise_seconds);
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "poles", s->poles_seconds);
    cli_stage(r, "label", s->labels_seconds);
    cli_stage(r, "manifold", s->manifold_seconds);
    cli_stage(r, "open", s->open_seconds);
    if (a->crust.simplify) cli_stage(r, "simplify", s->simplify_seconds);
}

/* --- any method --- */

/* What a method counts besides what all do. A method without a row has one stage, and counts nothing. */
static const struct {
    void (*stages)(run *r, const brio_surface_stats *stats);
    void (*counts)(run *r, const brio_surface_stats *stats);
} reports[BRIO_SURFACE_END] = {
    [BRIO_SURFACE_LABELED] = {report_labeled_delaunay_stages, report_labeled_delaunay},
    [BRIO_SURFACE_POWER_CRUST] = {report_power_crust_stages, report_power_crust},
    [BRIO_SURFACE_COCONE] = {report_cocone_stages, report_cocone},
    [BRIO_SURFACE_TIGHT_COCONE] = {report_cocone_stages, report_cocone},
};

/* Returns the options of the library: those that the method does not have are not given, as check_method found. */
static brio_surface_options library_options(run *r, int method) {
    const arguments *a = r->arguments;
    power_crust_options crust = crust_of(a);
    brio_surface_options o = {.size = sizeof o,
                              .method = (brio_surface_method)method,
                              .noise = (brio_noise)crust.noise,
                              .seed = r->common.seed,
                              .simplify = crust.simplify,
                              .confidence = has(method, "confidence"),
                              .polygons = a->polygons && !crust.simplify,
                              .poles = cli_pole_options(&crust),
                              .theta = a->theta,
                              .boundaries = has(method, "boundaries") ? ways_with_boundaries(a) : 0,
                              .density = has(method, "density") && estimates_density(r),
                              .pieces = a->pieces};
    double spacings = NAN;
    (void)cli_read_open(r, &a->crust, &spacings); /* check_arguments has read it before */
    if (!isnan(spacings)) o.holes = BRIO_HOLES_CLOSED;
    if (spacings > 0) o.open = spacings;
    return o;
}

/* Makes the surface by a method of the library. */
static brio_status reconstruct(run *r, brio_mesh *points, brio_mesh **surface, outcome *found) {
    const arguments *a = r->arguments;
    int method = method_of(a);
    brio_surface_options o = library_options(r, method);
    brio_surface_stats s = {.size = sizeof s};
    const brio_tiles_options tiles = {.size = sizeof tiles, .scratch = r->common.scratch, .tiles = (uint32_t)a->tiles};
    uint64_t work = 0;
    size_t usual;
    uint32_t *samples = NULL;
    double *normals = NULL;
    evidence e = {0};
    brio_status status = BRIO_OK;
    if (a->crust.normals) {
        o.normals = normals = malloc((3 * points->num_vertices + 1) * sizeof *normals);
        if (!normals) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu normals", points->num_vertices);
    }
    if (a->explain) o.explanation = &r->explanation;
    if (a->tiles) o.tiles = &tiles;
    TRY(cli_usual_points(r, points, NULL, false, &usual));
    status = brio_estimate_surface(r->ctx, usual, &o, &work);
    TRY(cli_require_work(r, status, points, work));
    found->open = o.open > 0 || (is(method, BRIO_METHOD_MAY_END) && o.holes != BRIO_HOLES_CLOSED);
    bool sided = has(method, "evidence");
    if (sided) TRY(cli_find_evidence(r, &a->evidence, points, &e));
    if (sided && a->pieces <= 1) o.evidence = &e.taken;
    TRY(cli_experiment(r, &(brio_laboratory_options){.labeling = cli_label_experiment(a->crust.labeling),
                                                     .extraction = (brio_extraction)a->extraction}));
    TRY(brio_surface(r->ctx, points->vertices, points->num_vertices, &o, surface, &s));
    brio_laboratory_end(r->lab);
    if (reports[method].stages)
        reports[method].stages(r, &s);
    else
        cli_lap(r, "surface");
    if (normals) TRY(cli_write_normals(r, a->crust.normals, points, normals));
    TRY(cli_take_samples(r, *surface, &samples));
    TRY(complete(r, points, is(method, BRIO_METHOD_OWN_VERTICES) ? NULL : samples, s.samples, *surface));
    if (reports[method].counts) reports[method].counts(r, &s);
    if (a->tiles) cli_fact_count(&r->facts, "tiles", a->tiles);
    found->leaves_many = method == BRIO_SURFACE_LABELED && (double)s.unused > MANY_UNUSED * (double)s.samples;
done:
    cli_evidence_free(&e);
    free(normals);
    free(samples);
    return status;
}

/* --- what was asked for --- */

/* An option of the command line, and whether it was given. */
typedef struct method_option {
    const char *name;
    bool given;
    const char *of_library; /* the option of the library that it stands for; NULL: all surfaces have it */
    bool of_curves;
} method_option;

/* Returns name i of the methods that have an option. */
static const char *name_of_user(const void *option_given, size_t i) {
    const method_option *o = option_given;
    for (int m = 0; m <= CURVES; m++) {
        if (is(m, BRIO_METHOD_AT_DISTANCE) || !(m == CURVES ? o->of_curves : has(m, o->of_library))) continue;
        if (i-- == 0) return name_of(m);
    }
    return NULL;
}

/* Refuses options of another method. */
static brio_status check_method(run *r, int method) {
    const arguments *a = r->arguments;
    const method_option given[] = {
        {"theta", a->theta != 0, "theta", false},
        {"boundaries", a->boundaries, "boundaries", false},
        {"density", a->density, "density", false},
        {"pieces", a->pieces > 0, "pieces", false},
        {"extraction", a->extraction != BRIO_EXTRACTION_LABELS, "pieces", false}, /* an experiment on the co-cone */
        {"polygons", a->polygons, "polygons", false},
        {"labeling", a->crust.labeling != NO_LABELING, "poles.labeling", false},
        {"sampling-density", a->crust.sampling_density != 0, "poles.sampling_density", false},
        {"sharp", a->crust.sharp, "poles.sharp", false},
        {"triangulate", a->crust.triangulate, "simplify", false},
        {"noise", a->crust.noise != 0, "noise", false},
        {"simplify", a->crust.simplify, "simplify", false},
        {"open", a->crust.open != NULL, "open", true},
        {"closed", a->crust.closed, "holes", true},
        {"keep-largest", a->components.largest, NULL, false},
        {"min-component", a->components.least > 0, NULL, false},
        {"vertex-normals", a->vertex_normals, NULL, false},
        {"self-intersections", a->self_intersections, NULL, false},
        {"left-out", a->left_out != NULL, NULL, false},
        {"explain", a->explain, "explanation", false},
        {"tiles", a->tiles > 0 && (method != CURVES || method_of(a) == CURVES), "tiles",
         false}, /* points may prove to be in a plane */
        {"normals", a->crust.normals != NULL, "normals", false},
        {"from", a->evidence.from != NULL, "evidence", false},
        {"ignore-normals", a->evidence.ignore_normals, "evidence", false},
        {"ignore-origins", a->evidence.ignore_origins, "evidence", false}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        char names[128] = "";
        if (!given[i].given || (method == CURVES ? given[i].of_curves : has(method, given[i].of_library))) continue;
        cli_list_words(name_of_user, &given[i], names, sizeof names);
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s is for --method %s, and the method is %s", given[i].name, names,
                        name_of(method));
    }
    return BRIO_OK;
}

/* Checks the options. A theta that voids the guarantee is worth a word. */
static brio_status check_arguments(run *r) {
    const arguments *a = r->arguments;
    brio_status status = check_method(r, method_of(a));
    if (status != BRIO_OK) return status;
    if (a->curves && a->method != NO_METHOD && a->method != CURVES)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--curves and --method %s exclude each other", name_of(a->method));
    double spacings;
    if (a->tiles) TRY(cli_check_tile_count(r, a->tiles));
    if (a->explain && !r->common.view) return cli_fail(r, BRIO_ERR_ARGUMENT, "--explain has no meaning without --view");
    if (a->explain && a->pieces > 1) return cli_fail(r, BRIO_ERR_ARGUMENT, "--explain and --pieces exclude each other");
    TRY(cli_read_open(r, &a->crust, &spacings));
    if (method_of(a) == CURVES) TRY(cli_check_curve_gaps(r, spacings));
    if (a->crust.open && isnan(spacings) && method_of(a) == BRIO_SURFACE_POWER_CRUST)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--open auto is for --method labeled-delaunay, and the method is power-crust");
    if (a->extraction != BRIO_EXTRACTION_LABELS && a->pieces > 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--extraction is for --method cocone without --pieces");
    if (a->polygons && a->crust.triangulate)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--polygons and --triangulate exclude each other");
    if (a->theta >= 1.57) return cli_fail(r, BRIO_ERR_ARGUMENT, "--theta: %g is not between 0 and pi/2", a->theta);
    if (a->theta > 0 && a->theta < LEAST_THETA) cli_warn(r, WARNING_THETA, LEAST_THETA);
done:
    return status;
}

/* Hints to work in pieces, if that meets the limit of memory. */
static void suggest_pieces(run *r, const brio_mesh *points) {
    enum { PIECES = 30 };
    brio_surface_options o = {.method = BRIO_SURFACE_COCONE};
    const arguments *a = r->arguments;
    uint64_t work = 0;
    size_t usual;
    o.pieces = PIECES;
    if (a->pieces > 1 || r->common.scratch || cli_usual_points(r, points, NULL, false, &usual) != BRIO_OK) return;
    if (brio_estimate_surface(r->ctx, usual, &o, &work) != BRIO_OK) return;
    double bytes = CLI_PROGRAM_BYTES + cli_mesh_bytes(points) + (double)work;
    if (!r->common.max_memory || bytes <= (double)r->common.max_memory) cli_hint(r, HINT_PIECES, PIECES);
}

static void suggest(run *r, brio_status status, const brio_mesh *points) {
    const arguments *a = r->arguments;
    if (status == BRIO_ERR_NO_MEMORY) {
        cli_keep_failure(r, status);
        suggest_pieces(r, points);
    }
    if (status != BRIO_ERR_NO_ANSWER) return;
    cli_examine(r, status, points);
    if (r->flat) return;
    const brio_reason reason = cli_failure(r).reason;
    if (reason == BRIO_REASON_ALL_HOLES) cli_hint(r, HINT_HOLES);
    if (reason == BRIO_REASON_NO_COMPONENT) cli_hint(r, HINT_COMPONENTS);
    if (a->method != BRIO_SURFACE_COCONE && reason == BRIO_REASON_NO_INSIDE) cli_hint(r, HINT_COCONE);
}

/* --- curves --- */

static brio_status curves(run *r, const brio_mesh *points, brio_mesh **result) {
    const arguments *a = r->arguments;
    double open;
    brio_status status = check_method(r, CURVES);
    TRY(status);
    TRY(cli_read_open(r, &a->crust, &open));
    TRY(cli_check_curve_gaps(r, open));
    bool closed = open == 0; /* --closed, too */
    status = cli_curve(r, points, isnan(open) || closed ? 0 : open, closed, result);
done:
    return status;
}

/* Tries curves: asked for, or the default of points in a plane.   done  false: they are not. */
static brio_status try_curves(run *r, const brio_mesh *points, brio_mesh **result, bool *done) {
    const arguments *a = r->arguments;
    bool asked = method_of(a) == CURVES, crust = method_of(a) == BRIO_SURFACE_POWER_CRUST, flat = asked;
    brio_status status = BRIO_OK;
    *done = false;
    if (!asked && (a->method == NO_METHOD || crust)) TRY(cli_is_flat(r, points, &flat));
    if (!flat) return BRIO_OK;
    status = crust ? cli_planar_crust(r, points, &a->crust, a->crust.labeling == NO_LABELING, result)
                   : curves(r, points, result);
    *done = asked || status != BRIO_ERR_NO_ANSWER || cli_failure(r).reason != BRIO_REASON_NOT_FLAT;
    if (!*done) status = BRIO_OK;
done:
    return status;
}

static brio_status finish_surface(run *r, brio_mesh **points, brio_mesh *result, const outcome *found) {
    const arguments *a = r->arguments;
    if (a->left_out || found->leaves_many) FORWARD(cli_report_left_out(r, result, *points, a->left_out));
    brio_mesh_free(*points);
    *points = NULL;
    unsigned how = found->open ? CERTIFY_OPEN : 0u;
    if (a->extraction != BRIO_EXTRACTION_LABELS) how |= CERTIFY_ANYTHING;
    return cli_certify(r, result, how | (a->self_intersections ? CERTIFY_COUNTED : 0u));
}

static brio_status surface(run *r) {
    const arguments *a = r->arguments;
    bool is_curve;
    brio_mesh *points = NULL, *result = NULL;
    brio_status status = BRIO_OK;
    TRY(check_arguments(r));
    TRY(cli_require_output_for(r, "vertex-normals", a->vertex_normals));
    TRY(cli_check_evidence(r, &a->evidence));
    if (a->evidence.from && a->pieces > 1) FAIL(r, BRIO_ERR_ARGUMENT, "--from and --pieces exclude each other");
    TRY(cli_require_output(r, false));
    if (a->crust.normals) TRY(cli_check_mesh_beside(r, "normals", a->crust.normals, CLI_POINTS));
    if (a->left_out) TRY(cli_check_mesh_beside(r, "left-out", a->left_out, CLI_POINTS));
    r->wants_origins =
        (method_of(a) == CURVES || has(method_of(a), "evidence")) && !a->evidence.ignore_origins && !a->evidence.from;
    TRY(cli_read_samples(r, r->operands[0], &points));
    if (!points->num_vertices) FAIL(r, BRIO_ERR_NO_ANSWER, "%s: no points, no surface", r->operands[0]);
    outcome found = {0};
    status = try_curves(r, points, &result, &is_curve);
    if (status == BRIO_OK && !is_curve) status = reconstruct(r, points, &result, &found);
    suggest(r, status, points);
    if (status != BRIO_OK) goto done;
    r->lap = cli_clock();
    TRY(cli_check_interrupt(r));
    if (!is_curve) TRY(finish_surface(r, &points, result, &found));
    TRY(cli_write(r, result));
done:
    brio_mesh_free(result);
    brio_mesh_free(points);
    return status;
}

const command cli_surface = {
    .name = "surface",
    .operands = "IN",
    .summary = "surface through points, with a certificate of what it is",
    .description =
        "The default method needs no parameters and no normals: points all over a closed object give a closed surface, "
        "others a surface that ends where they end. "
        "Other points: brio help methods. The certificate in the report says what the surface is, whatever the method.",
    .examples = "brio surface scan.ply -o surface.ply\nthe usual way\n"
                "brio surface part.xyz --method cocone -o shell.ply\nan open surface\n"
                "brio surface scan.ply --closed -o solid.stl\nwithout holes, as a printer needs it\n"
                "brio surface scan.las --open 5 --keep-largest -o surface.ply\nleaves holes over 5 point spacings "
                "open, drops crumbs\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = surface,
};
