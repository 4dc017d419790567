/* What single precision does to coordinates, said before or beside the loss.
 *
 * Coordinates of a country's grid, such as 4100000.456, are half a metre apart in single precision: points of a scan
 * merge, and triangles fold over. Where a format has double precision, too, --float32 then gives way to it. A STL file
 * has no other, so that points that it would ruin are refused as soon as they are read. A surface that is finished is
 * written in any case. Single pairs of points that are almost coincident are merged, and counted. */
#include "precision.h"
#include "cloud.h"
#include "lost.h"
#include <math.h>

/* The share of the points that may merge. Chosen: above the pairs of almost coincident points that scans have and that
 * the power crust makes (86 of 600,000 vertices on a torus), below what a country's grid does. */
static const double MOST_MERGED = 1e-3;
/* The share of the spacing of the points by which coordinates may move. Chosen. */
static const double MOST_MOVED = 0.1;
static const double LARGEST_SINGLE = 0x1.fffffep127;

typedef struct {
    bool is_harmful;
    size_t merged;
    char reason[200]; /* why it is harmful */
} loss;

/* Finds the coordinate of largest magnitude and, where singles hold all, the most that one of them moves. */
static bool fits_single(const brio_mesh *mesh, double *largest, double *moved) {
    size_t count = 3 * mesh->num_vertices;
    *largest = *moved = 0;
    for (size_t i = 0; i < count; i++)
        if (fabs(mesh->vertices[i]) > fabs(*largest)) *largest = mesh->vertices[i];
    if (fabs(*largest) > LARGEST_SINGLE) return false;
    for (size_t i = 0; i < count; i++) {
        double move = fabs(mesh->vertices[i] - (double)(float)mesh->vertices[i]);
        if (move > *moved) *moved = move;
    }
    return true;
}

static brio_status measure_loss(run *r, const brio_mesh *mesh, loss *l) {
    brio_status status = BRIO_OK;
    double largest, moved, spacing = 0;
    size_t n = mesh->num_vertices;
    *l = (loss){.is_harmful = true};
    if (!fits_single(mesh, &largest, &moved)) {
        snprintf(l->reason, sizeof l->reason, "single precision cannot hold %g", largest);
        return BRIO_OK;
    }
    if (moved > 0) TRY(cli_cloud_merged(r, mesh->vertices, n, &l->merged));
    if (moved > 0) TRY(cli_cloud_spacing(r, mesh->vertices, n, &spacing));
    if ((double)l->merged > MOST_MERGED * (double)n)
        snprintf(l->reason, sizeof l->reason, "single precision would merge %zu of %zu points with others", l->merged,
                 n);
    else if (moved > 0 && moved > MOST_MOVED * spacing)
        snprintf(l->reason, sizeof l->reason,
                 "single precision would move points by up to %.3g, and most are %.3g from the next", moved, spacing);
    else
        l->is_harmful = false;
done:
    return status;
}

brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh) {
    const common_options *c = &r->common;
    loss l;
    if (!c->output || brio_format_of(c->format ? c->format : c->output) != BRIO_FORMAT_STL) return BRIO_OK;
    brio_status status = measure_loss(r, mesh, &l);
    if (status != BRIO_OK || !l.is_harmful) return status;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s: a STL file has no other; .ply has double precision", path, l.reason);
}

static bool has_both(brio_format format) {
    return format == BRIO_FORMAT_PLY || format == BRIO_FORMAT_VTU || format == BRIO_FORMAT_VTP ||
           format == BRIO_FORMAT_NPY;
}

brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *o,
                                 size_t *merged) {
    loss l = {.merged = 0};
    brio_status status = BRIO_OK;
    bool always = o->format == BRIO_FORMAT_STL, chosen = o->float32 && has_both(o->format);
    bool binary = o->format == BRIO_FORMAT_LAS || o->format == BRIO_FORMAT_NPY || o->format == BRIO_FORMAT_GLB;
    cli_tell_idle(r, path, !binary, always || has_both(o->format) || o->format == BRIO_FORMAT_GLB);
    if (always || chosen) TRY(measure_loss(r, mesh, &l));
    if (chosen && l.is_harmful) {
        cli_warn(r, "%s: in double precision: %s", path, l.reason);
        cli_fact_bool(&r->facts, "float32", false);
        o->float32 = 0;
        l.merged = 0;
    }
    if (always && l.is_harmful) cli_warn(r, "%s: %s", path, l.reason);
    *merged = l.merged;
done:
    return status;
}

void cli_tell_moved(run *r, const char *path, double moved, size_t merged) {
    if (moved > 0) cli_fact_real(&r->facts, "moved", moved);
    if (merged) cli_fact_count(&r->facts, "merged", merged);
    if (merged) cli_warn(r, "%s: single precision merges %zu points with others", path, merged);
    if (moved > 0) cli_warn(r, "%s: rounded coordinates move points by up to %.3g", path, moved);
}
