/* What single precision does to coordinates, said before or beside the loss.
 *
 * Coordinates of a country's grid, such as 4100000.456, are half a metre apart in single precision: points of a scan
 * merge, and triangles fold over. Where a format has double precision, too, --float32 then gives way to it. A STL file
 * has no other, so that points that it would ruin are refused as soon as they are read. A surface that is finished is
 * written in any case. Single pairs of points that are almost coincident are merged, and counted. */
#include "precision.h"
#include "lost.h"
#include "single_loss.h"

brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh) {
    const common_options *c = &r->common;
    single_loss l;
    char reason[200];
    if (!c->output || brio_format_of(c->format ? c->format : c->output) != BRIO_FORMAT_STL) return BRIO_OK;
    brio_status status = cli_single_loss(r, mesh, &l);
    if (status != BRIO_OK || !cli_single_is_harmful(&l, reason)) return status;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s: a STL file has no other; .ply has double precision", path, reason);
}

static bool has(brio_format format, unsigned what) {
    return (brio_format_facts(format)->holds & what) == what;
}

/* Whether points are rounded to singles: a STL file's always, others' by choice. */
static bool rounds(const brio_write_options *o) {
    return o->format == BRIO_FORMAT_STL || (o->float32 && has(o->format, BRIO_HOLDS_SINGLES | BRIO_HOLDS_DOUBLES));
}

static void tell_idle(run *r, const char *path, brio_format format) {
    cli_tell_idle(r, path, has(format, BRIO_HOLDS_TEXT), has(format, BRIO_HOLDS_SINGLES));
}

/* Takes back --float32 if the loss is harmful. Returns the number of points that merge. */
static size_t settle(run *r, const char *path, const single_loss *l, brio_write_options *o) {
    char reason[200];
    bool harmful = cli_single_is_harmful(l, reason);
    if (!harmful) return l->merged;
    if (o->format == BRIO_FORMAT_STL) {
        cli_warn(r, WARNING_SINGLE, path, reason);
        return l->merged;
    }
    cli_warn(r, WARNING_DOUBLE, path, reason);
    cli_fact_bool(&r->facts, "float32", false);
    o->float32 = 0;
    return 0;
}

brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *o,
                                 size_t *merged) {
    single_loss l = {.points = 0};
    brio_status status = BRIO_OK;
    tell_idle(r, path, o->format);
    if (rounds(o)) TRY(cli_single_loss(r, mesh, &l));
    *merged = settle(r, path, &l, o);
done:
    return status;
}

brio_status cli_settle_conversion(run *r, const char *from, const char *to, const brio_convert_options *o,
                                  brio_write_options *written, size_t *merged) {
    single_loss l = {.points = 0};
    brio_status status = BRIO_OK;
    tell_idle(r, to, written->format);
    if (rounds(written)) TRY(cli_single_loss_of_file(r, from, o, &l));
    *merged = settle(r, to, &l, written);
done:
    return status;
}

void cli_tell_moved(run *r, const char *path, double moved, size_t merged) {
    if (moved > 0) cli_fact_real(&r->facts, "moved", moved);
    if (merged) cli_fact_count(&r->facts, "merged", merged);
    if (merged) cli_warn(r, WARNING_MERGED, path, merged);
    if (moved > 0) cli_warn(r, WARNING_MOVED, path, moved);
}
