/* Pages that show meshes: --view of every command that writes a mesh, and brio view. */
#include "cli/files/read_write.h"
#include "cli/files/files.h"
#include "cli/run/interrupt.h"
#include "platform/program.h"
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

/* Writes the report so far. */
static void write_report(FILE *stream, void *object) {
    run *r = object;
    cli_text_write(stream, &r->facts, r->command->name, false);
}

brio_status cli_show(run *r, const brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    char *report = NULL;
    if (!r->common.view) return BRIO_OK;
    report = brio_program_text(write_report, r);
    if (!report) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for the report on a page");
    const char *path = r->common.output ? r->common.output : r->operands[0];
    const brio_page_layer layer = {.mesh = mesh, .name = cli_page_name(path), .report = report};
    const brio_page_layer *layers[] = {&layer};
    status = cli_write_page(r, r->common.view, layers, 1, NULL);
    r->shown = status == BRIO_OK;
done:
    free(report);
    return status;
}
