/* brio surface of points in a plane: curves, with the certificate of polylines. */
#include "cli/steps/curve.h"
#include "cli/files/files.h"
#include "cli/steps/estimate.h"
#include "cli/steps/properties.h"
#include <math.h>
#include <stdlib.h>

enum { TRIED = 64 }; /* points that decide at first whether all may be in a plane */

/* Points thicker than this share of their extent are in no plane, whatever the rounding of the points. Chosen. */
static const double THICK = 1e-3;

/* Bytes of a point during the work. Measured: 219 along a circle. */
static const double POINT_BYTES = 250;

brio_status cli_may_be_flat(run *r, const brio_mesh *points, bool *flat) {
    double row[TRIED][3], low[3], high[3], extent = 0;
    size_t n = points->num_vertices, count = n < TRIED ? n : TRIED;
    brio_plane_frame frame = {0};
    *flat = false;
    if (n <= 3) return BRIO_OK;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) {
            row[i][k] = points->vertices[3 * (i * n / count) + k];
            low[k] = i ? fmin(low[k], row[i][k]) : row[i][k];
            high[k] = i ? fmax(high[k], row[i][k]) : row[i][k];
            extent = fmax(extent, high[k] / 2 - low[k] / 2);
        }
    brio_status status = brio_plane_fit(r->ctx, *row, count, &frame);
    if (status != BRIO_OK) return status;
    *flat = frame.dimension == 2 || (frame.dimension == 3 && frame.thickness <= 2 * THICK * extent);
    return BRIO_OK;
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

/* Reports the certificate. Edges of a Delaunay triangulation do not cross. */
static brio_status certify(run *r, const brio_mesh *curve, const brio_curve_stats *s) {
    facts *f = &r->facts;
    brio_curve_certificate c = {0};
    brio_status status = brio_mesh_curve_certificate(r->ctx, curve, &c);
    if (status != BRIO_OK) return status;
    cli_lap(r, "certify");
    cli_fact_open(f, "certificate", FACT_OBJECT);
    cli_fact_bool(f, "closed", c.closed);
    cli_fact_bool(f, "manifold", c.manifold);
    cli_fact_count(f, "components", c.components);
    cli_fact_count(f, "loops", c.loops);
    cli_fact_count(f, "ends", c.ends);
    cli_fact_count(f, "corners", s->corners);
    cli_fact_count(f, "branches", c.branches);
    cli_fact_count(f, "isolated", c.isolated);
    cli_fact_count(f, "self_intersections", 0);
    cli_fact_real(f, "length", c.length);
    cli_fact_close(f);
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

brio_status cli_curve(run *r, const brio_mesh *points, double open, bool closed, brio_mesh **out) {
    brio_curve_options o = {0};
    brio_curve_stats s = {0};
    uint32_t *samples = NULL;
    brio_status status = BRIO_OK;
    o.open = open;
    o.closed = closed;
    TRY(cli_require_edges(r));
    TRY(cli_require_work(r, BRIO_OK, points, (uint64_t)(POINT_BYTES * (double)points->num_vertices)));
    TRY(brio_curve(r->ctx, points->vertices, points->num_vertices, &o, out, &s));
    samples = malloc((s.samples + 1) * sizeof *samples);
    if (!samples) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", s.samples);
    for (size_t i = 0; i < s.samples; i++)
        samples[i] = (uint32_t)brio_property_value(brio_mesh_property(*out, "sample"), i);
    r->lap = cli_clock();
    TRY(cli_carry_properties(r, points, samples, *out));
    report(r, &s);
    TRY(cli_check_interrupt(r));
    TRY(certify(r, *out, &s));
done:
    free(samples);
    return status;
}
