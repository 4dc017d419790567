/* Pages and pictures that show meshes: --view and --picture of every command that writes a mesh, and brio view. */
#include "cli/files/read_write.h"
#include "cli/files/files.h"
#include "cli/run/interrupt.h"
#include "platform/program.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_page(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && (!strcasecmp(dot, ".html") || !strcasecmp(dot, ".htm"));
}

const char *cli_page_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return !strcmp(path, "-") ? "a stream" : slash && slash[1] ? slash + 1 : path;
}

brio_status cli_check_page(run *r, const char *name, const char *path) {
    if (!path) return BRIO_OK;
    if (!is_page(path)) return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a page is .html or .htm", path);
    return cli_check_beside(r, name, path);
}

brio_status cli_write_page(run *r, const char *path, const brio_page_layer *const *layers, size_t num_layers,
                           const brio_page_options *options) {
    brio_page_stats stats = {.size = sizeof stats};
    FORWARD(cli_check_interrupt(r));
    cli_interrupt_writing(strcmp(path, "-") != 0);
    brio_status status = brio_write_page(r->ctx, path, layers, num_layers, options, &stats);
    cli_interrupt_writing(false);
    cli_lap(r, "view");
    if (status != BRIO_OK) return status;
    cli_fact_bytes(&r->facts, r->common.view ? "view_bytes" : "bytes", stats.bytes);
    if (!r->common.view) cli_fact_bool(&r->facts, "exact", stats.exact != 0);
    if (stats.points_thinned) cli_warn(r, WARNING_PAGE, path, (unsigned long long)stats.points_thinned);
    return BRIO_OK;
}

/* --- pictures --- */

/* Reads three numbers X,Y,Z, not all 0. */
static bool read_direction(const char *text, double direction[3]) {
    bool zero = true;
    for (int k = 0; k < 3; k++) {
        char *end;
        direction[k] = strtod(text, &end);
        if (end == text || !isfinite(direction[k]) || *end != (k < 2 ? ',' : 0)) return false;
        zero &= direction[k] == 0;
        text = end + 1;
    }
    return !zero;
}

/* The sides of a picture, as the library draws it: a larger one is refused before the work. */
enum { MOST_PIXELS = 16384 };

/* Reads two whole numbers WxH. */
static bool read_size(const char *text, int size[2]) {
    for (int k = 0; k < 2; k++) {
        char *end;
        long number = strtol(text, &end, 10);
        if (end == text || number < 1 || number > MOST_PIXELS || *end != (k < 1 ? 'x' : 0)) return false;
        size[k] = (int)number;
        text = end + 1;
    }
    return true;
}

brio_status cli_check_picture(run *r) {
    const common_options *c = &r->common;
    const char *dot = c->picture ? strrchr(c->picture, '.') : NULL, *idle = NULL;
    double direction[3];
    int size[2];
    if (!c->picture) idle = c->look ? "look" : c->colour_by ? "colour-by" : c->picture_size ? "picture-size" : NULL;
    if (idle) return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s has no meaning without --picture", idle);
    if (!c->picture) return BRIO_OK;
    if (!dot || strcasecmp(dot, ".png") != 0)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a picture is .png", c->picture);
    if (c->look && !read_direction(c->look, direction))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--look: '%s' is no direction; expected three numbers X,Y,Z, not all 0",
                        c->look);
    if (c->picture_size && !read_size(c->picture_size, size))
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--picture-size: '%s' is no size; expected WxH, 1 to %d pixels, such as 1920x1080",
                        c->picture_size, MOST_PIXELS);
    return cli_check_beside(r, "picture", c->picture);
}

brio_status cli_write_picture(run *r, const brio_page_layer *const *layers, size_t num_layers,
                              const brio_page_options *page) {
    const common_options *c = &r->common;
    brio_picture_options o = {.size = sizeof o, .colour = c->colour_by};
    brio_picture_stats stats = {.size = sizeof stats};
    int size[2] = {0, 0};
    if (c->look) read_direction(c->look, o.from);
    if (c->picture_size) read_size(c->picture_size, size);
    o.width = size[0];
    o.height = size[1];
    o.self_intersections = page && page->self_intersections;
    o.side_by_side = page && page->side_by_side;
    FORWARD(cli_check_interrupt(r));
    cli_interrupt_writing(true);
    brio_status status = brio_write_picture(r->ctx, c->picture, layers, num_layers, &o, &stats);
    cli_interrupt_writing(false);
    cli_lap(r, "picture");
    if (status != BRIO_OK) return status;
    cli_fact_open(&r->facts, "picture", FACT_OBJECT);
    cli_fact_bytes(&r->facts, "bytes", stats.bytes);
    cli_fact_open(&r->facts, "look", FACT_LIST);
    for (int k = 0; k < 3; k++) cli_fact_real(&r->facts, NULL, stats.from[k]);
    cli_fact_close(&r->facts);
    cli_fact_real(&r->facts, "pixel", stats.pixel);
    if (stats.low < stats.high) cli_fact_real(&r->facts, "low", stats.low);
    if (stats.low < stats.high) cli_fact_real(&r->facts, "high", stats.high);
    cli_fact_close(&r->facts);
    return BRIO_OK;
}

/* --- what a command shows --- */

uint64_t cli_most_shown(const run *r, uint64_t all, double most, double bytes) {
    static const double SHARE = 0.25; /* of --max-memory; chosen */
    if (r->common.max_memory) most = fmin(most, fmax(1, SHARE * (double)r->common.max_memory / bytes));
    return (double)all < most ? all : (uint64_t)most;
}

/* Writes the report so far. */
static void write_report(FILE *stream, void *object) {
    run *r = object;
    cli_text_write(stream, &r->facts, r->command->name, false);
}

brio_status cli_show(run *r, const brio_mesh *mesh) {
    return cli_show_both(r, mesh, mesh, NULL);
}

brio_status cli_show_both(run *r, const brio_mesh *mesh, const brio_mesh *pictured, const char *colour) {
    brio_status status = BRIO_OK;
    char *report = NULL;
    if (!cli_showing(r)) return BRIO_OK;
    if (!r->facts.failed) report = brio_program_text(write_report, r);
    if (!report) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for the report on a page");
    const char *path = r->common.output ? r->common.output : r->operands[0];
    const brio_page_layer layer = {.size = sizeof layer,
                                   .mesh = mesh,
                                   .name = cli_page_name(path),
                                   .report = report,
                                   .explanation = r->explanation};
    const brio_page_layer more = {.mesh = r->beside, .name = r->beside_name};
    const brio_page_layer drawn = {.mesh = pictured, .name = layer.name};
    const brio_page_layer *layers[] = {&layer, &more}, *drawing[] = {&drawn};
    const brio_page_options how = {.size = sizeof how, .self_intersections = r->crossings};
    if (r->common.view) TRY(cli_write_page(r, r->common.view, layers, r->beside ? 2 : 1, &how));
    if (!r->common.colour_by) r->common.colour_by = colour;
    if (r->common.picture) TRY(cli_write_picture(r, drawing, 1, &how));
    if (r->explanation && r->explanation->num_samples < r->explanation->all_samples)
        cli_warn(r, WARNING_EXPLAIN, r->common.view, r->explanation->num_samples, r->explanation->all_samples);
    r->shown = true;
done:
    free(report);
    return status;
}
