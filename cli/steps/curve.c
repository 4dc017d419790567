/* brio surface of points in a plane: curves, with the certificate of polylines. */
#include "cli/steps/curve.h"
#include "cli/files/files.h"
#include "cli/steps/estimate.h"
#include "cli/steps/properties.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIED = 64 }; /* points that decide at first whether all may be in a plane */

/* THICK: some of the points that are thicker than this share of their extent are in no plane, whatever the rounding of
 * the points. Chosen. THIN: of brio_curve, for all points. */
static const double THICK = 1e-3, THIN = 0x1p-20;

/* Bytes of a point during the work. Measured: 219 along a circle. */
static const double POINT_BYTES = 250;

/* Sets *flat to whether points are in a plane, up to a share of their extent, and on no line. */
static brio_status find_flat(run *r, const double *points, size_t count, double share, bool *flat) {
    double extent = 0;
    brio_plane_frame frame = {0};
    for (size_t k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            low = fmin(low, points[3 * i + k]);
            high = fmax(high, points[3 * i + k]);
        }
        extent = fmax(extent, high / 2 - low / 2); /* half of it is always finite */
    }
    FORWARD(brio_plane_fit(r->ctx, points, count, &frame));
    *flat = frame.dimension == 2 || (frame.dimension == 3 && frame.thickness / 2 <= share * extent);
    return BRIO_OK;
}

brio_status cli_is_flat(run *r, const brio_mesh *points, bool *flat) {
    double row[TRIED][3];
    size_t n = points->num_vertices, count = n < TRIED ? n : TRIED;
    *flat = false;
    if (n <= 3) return BRIO_OK;
    for (size_t i = 0; i < count; i++) memcpy(row[i], points->vertices + 3 * (i * n / count), sizeof row[i]);
    FORWARD(find_flat(r, *row, count, THICK, flat));
    return *flat ? find_flat(r, points->vertices, n, THIN, flat) : BRIO_OK;
}

static void report(run *r, const brio_curve_stats *s) {
    facts *f = &r->facts;
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "curve", s->curve_seconds);
    cli_fact_text(f, "method", "curves");
    cli_fact_count(f, "samples", s->samples);
    cli_fact_count(f, "vertices", s->samples);
    cli_fact_count(f, "faces", 0);
    cli_fact_count(f, "edges", s->edges);
    cli_fact_count(f, "gaps", s->gaps);
}

brio_status cli_certify_edges(run *r, const brio_mesh *mesh, const size_t *corners, bool delaunay,
                              brio_curve_certificate *found) {
    facts *f = &r->facts;
    brio_curve_certificate c = {0};
    brio_status status = brio_mesh_curve_certificate(r->ctx, mesh, &c);
    if (status != BRIO_OK) return status;
    cli_lap(r, "certify");
    cli_fact_open(f, "certificate", FACT_OBJECT);
    cli_fact_bool(f, "closed", c.closed);
    cli_fact_bool(f, "manifold", c.manifold);
    cli_fact_count(f, "components", c.components);
    cli_fact_count(f, "loops", c.loops);
    cli_fact_count(f, "ends", c.ends);
    if (corners) cli_fact_count(f, "corners", *corners);
    cli_fact_count(f, "branches", c.branches);
    cli_fact_count(f, "isolated", c.isolated);
    if (delaunay) cli_fact_count(f, "self_intersections", 0);
    cli_fact_real(f, "length", c.length);
    cli_fact_close(f);
    if (found) *found = c;
    return BRIO_OK;
}

brio_status cli_check_edges(run *r, const brio_mesh *mesh, bool open) {
    brio_curve_certificate c = {0};
    FORWARD(cli_certify_edges(r, mesh, NULL, false, &c));
    if (!c.manifold)
        return cli_fail(r, BRIO_ERR_CHECK, "the curves branch: %zu vertices have more than two edges", c.branches);
    if (!c.closed && !open)
        return cli_because(r, BRIO_REASON_NOT_CLOSED,
                           cli_fail(r, BRIO_ERR_CHECK, "the curves are not closed: %zu ends in %zu of %zu curves",
                                    c.ends, c.components - c.loops, c.components));
    return BRIO_OK;
}

brio_status cli_require_edges(run *r) {
    brio_format format;
    if (!r->common.output) return BRIO_OK;
    FORWARD(cli_output_format(r, r->common.output, r->common.format, &format));
    char others[BRIO_FORMAT_LIST];
    if (brio_format_facts(format)->holds & BRIO_HOLDS_EDGES) return BRIO_OK;
    brio_format_list(1, BRIO_HOLDS_EDGES, others, sizeof others);
    return cli_fail_output(r, "%s cannot hold edges: %s can", r->common.output, others);
}

/* Refuses outputs without edges, and work beyond the memory. */
static brio_status require(run *r, const brio_mesh *points) {
    FORWARD(cli_require_edges(r));
    return cli_require_work(r, BRIO_OK, points, (uint64_t)(POINT_BYTES * (double)points->num_vertices));
}

/* Gives the vertices the properties of their points. */
static brio_status carry(run *r, const brio_mesh *points, brio_mesh *curve) {
    const brio_property *sample = brio_mesh_property(curve, "sample");
    uint32_t *samples = malloc((curve->num_vertices + 1) * sizeof *samples);
    if (!samples) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", curve->num_vertices);
    for (size_t i = 0; i < curve->num_vertices; i++) samples[i] = (uint32_t)brio_property_value(sample, i);
    brio_status status = cli_carry_properties(r, points, samples, curve);
    free(samples);
    return status;
}

brio_status cli_curve(run *r, const brio_mesh *points, double open, bool closed, brio_mesh **out) {
    brio_curve_options o = {0};
    brio_curve_stats s = {0};
    o.open = open;
    o.closed = closed;
    FORWARD(require(r, points));
    FORWARD(brio_curve(r->ctx, points->vertices, points->num_vertices, &o, out, &s));
    r->lap = cli_clock();
    FORWARD(carry(r, points, *out));
    report(r, &s);
    FORWARD(cli_check_interrupt(r));
    return cli_certify_edges(r, *out, &s.corners, true, NULL);
}

/* --- power crusts --- */

/* From this share of fat edges on the points lie on an area. Chosen: 10 % along an open curve, where the crust closes
 * it, 58 % of a grid. */
static const double MOST_FAT = 0.25;

static brio_status crust_of_curves(run *r, const brio_mesh *points, brio_mesh **crust, brio_mesh **shape,
                                   brio_planar_crust_stats *s) {
    FORWARD(require(r, points));
    FORWARD(brio_planar_crust(r->ctx, points->vertices, points->num_vertices, crust, shape, s));
    if ((double)s->fat <= MOST_FAT * (double)s->edges) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_NO_ANSWER,
                    "the points lie on an area, not on curves: %zu of %zu edges between inside and outside have points "
                    "nearly as near on either side",
                    s->fat, s->edges);
}

static void report_crust(run *r, const brio_planar_crust_stats *s) {
    facts *f = &r->facts;
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "crust", s->crust_seconds);
    cli_fact_count(f, "poles", s->poles);
    cli_fact_count(f, "inner", s->inner);
    cli_fact_count(f, "outer", s->outer);
    cli_fact_count(f, "confused", s->confused);
    cli_fact_text(f, "method", "power-crust");
    cli_fact_count(f, "samples", s->samples);
    cli_fact_count(f, "vertices", s->samples);
    cli_fact_count(f, "faces", 0);
    cli_fact_count(f, "edges", s->edges);
    cli_fact_text(f, "labeling", "greedy");
}

static brio_status refuse_options_of_space(run *r, const power_crust_options *o, bool any_labeling) {
    const struct {
        const char *name;
        bool given;
    } idle[] = {{"labeling", !any_labeling && o->labeling != BRIO_LABELING_GREEDY},
                {"sampling-density", o->sampling_density != 0},
                {"sharp", o->sharp},
                {"open", o->open != NULL},
                {"simplify", o->simplify},
                {"normals", o->normals != NULL}};
    for (size_t i = 0; i < sizeof idle / sizeof *idle; i++)
        if (idle[i].given)
            return cli_fail(r, BRIO_ERR_ARGUMENT,
                            "--%s is for points in space, and these lie in a plane: their power crust has the greedy "
                            "labels and is closed",
                            idle[i].name);
    return BRIO_OK;
}

brio_status cli_planar_crust(run *r, const brio_mesh *points, const power_crust_options *options, bool any_labeling,
                             brio_mesh **out) {
    brio_planar_crust_stats s = {0};
    FORWARD(crust_of_curves(r, points, out, NULL, &s));
    FORWARD(refuse_options_of_space(r, options, any_labeling));
    r->lap = cli_clock();
    FORWARD(carry(r, points, *out));
    report_crust(r, &s);
    FORWARD(cli_check_interrupt(r));
    return cli_certify_edges(r, *out, NULL, true, NULL);
}

brio_status cli_planar_shape(run *r, const brio_mesh *points, brio_mesh **crust, brio_mesh **shape) {
    brio_planar_crust_stats s = {0};
    facts *f = &r->facts;
    FORWARD(crust_of_curves(r, points, crust, shape, &s));
    cli_stage(r, "delaunay", s.delaunay_seconds);
    cli_stage(r, "shape", s.crust_seconds);
    r->lap = cli_clock();
    cli_fact_count(f, "samples", s.samples);
    cli_fact_count(f, "poles", s.poles);
    cli_fact_count(f, "inner", s.inner);
    cli_fact_count(f, "outer", s.outer);
    cli_fact_text(f, "labeling", "greedy");
    cli_fact_count(f, "vertices", (*shape)->num_vertices);
    cli_fact_count(f, "edges", (*shape)->num_edges);
    return carry(r, points, *crust);
}

brio_status cli_check_curve_gaps(run *r, double open) {
    if (isnan(open) || open == 0 || open >= 1) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "--open: %g is under 1; curves end at gaps over that many links", open);
}
