/* What single precision does to coordinates, said before or beside the loss.
 *
 * Coordinates of a country's grid, such as 4100000.456, are half a metre apart in single precision: points of a scan
 * merge. Where a format has double precision, too, --float32 then gives way to it. A STL file has no other, so that
 * points which it would merge are refused as soon as they are read. A surface that is finished is written in any case.
 * Single pairs of points that are almost coincident are merged, and counted. */
#include "precision.h"
#include "cloud.h"
#include "files.h"
#include <math.h>
#include <string.h>

/* The share of the points that may merge. Chosen: above the pairs of almost coincident points that scans have and that
 * the power crust makes, below what a country's grid does. */
static const double MOST_MERGED = 1e-3;

static bool fits_single(const brio_mesh *mesh, double *largest) {
    *largest = 0;
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++)
        if (fabs(mesh->vertices[i]) > fabs(*largest)) *largest = mesh->vertices[i];
    return fabs(*largest) <= 0x1.fffffep127;
}

static bool is_single(const brio_mesh *mesh) {
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++)
        if ((double)(float)mesh->vertices[i] != mesh->vertices[i]) return false;
    return true;
}

/* Counts the points that merge; the coordinates fit single precision. */
static brio_status count_merged(run *r, const brio_mesh *mesh, size_t *merged) {
    *merged = 0;
    return is_single(mesh) ? BRIO_OK : cli_cloud_merged(r, mesh->vertices, mesh->num_vertices, merged);
}

static bool are_many(size_t merged, const brio_mesh *mesh) {
    return (double)merged > MOST_MERGED * (double)mesh->num_vertices;
}

brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh) {
    const common_options *c = &r->common;
    brio_status status = BRIO_OK;
    size_t merged;
    double largest;
    if (!c->output || brio_format_of(c->format ? c->format : c->output) != BRIO_FORMAT_STL) return BRIO_OK;
    if (!fits_single(mesh, &largest))
        TRY(cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %g does not fit the single precision of a STL file; .ply holds it",
                     path, largest));
    TRY(count_merged(r, mesh, &merged));
    if (are_many(merged, mesh))
        status =
            cli_fail(r, BRIO_ERR_ARGUMENT,
                     "%s: %zu of %zu points would merge with others in the single precision of a STL file; .ply keeps "
                     "them apart",
                     path, merged, mesh->num_vertices);
done:
    return status;
}

static bool has_both(brio_format format) {
    return format == BRIO_FORMAT_PLY || format == BRIO_FORMAT_VTU || format == BRIO_FORMAT_VTP ||
           format == BRIO_FORMAT_NPY;
}

brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *o,
                                 size_t *merged) {
    double largest;
    *merged = 0;
    if (o->float32 && !has_both(o->format) && o->format != BRIO_FORMAT_STL && !r->common.quiet)
        fprintf(stderr, "brio: %s: --float32 changes nothing in this format\n", path);
    if (o->format != BRIO_FORMAT_STL && !(o->float32 && has_both(o->format))) return BRIO_OK;
    bool fits = fits_single(mesh, &largest);
    brio_status status = fits ? count_merged(r, mesh, merged) : BRIO_OK;
    if (status != BRIO_OK || o->format == BRIO_FORMAT_STL || (fits && !are_many(*merged, mesh))) return status;
    if (fits)
        fprintf(stderr,
                "brio: warning: %s: in double precision, because --float32 would merge %zu of %zu points with others\n",
                path, *merged, mesh->num_vertices);
    else
        fprintf(stderr, "brio: warning: %s: in double precision, because %g does not fit single precision\n", path,
                largest);
    cli_fact_bool(&r->facts, "float32", false);
    o->float32 = 0;
    *merged = 0;
    return BRIO_OK;
}

void cli_tell_moved(run *r, const char *path, double moved, size_t merged) {
    if (moved > 0) cli_fact_real(&r->facts, "moved", moved);
    if (merged) {
        cli_fact_count(&r->facts, "merged", merged);
        fprintf(stderr, "brio: warning: %s: single precision merges %zu points with others\n", path, merged);
    }
    if (moved > 0 && !r->common.quiet)
        fprintf(stderr, "brio: warning: %s: rounded coordinates move points by up to %.3g\n", path, moved);
}
