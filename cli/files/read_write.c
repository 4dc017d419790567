/* The input of a command, read, and its output, written: the steps that all commands share. */
#include "cli/files/read_write.h"
#include "cli/files/files.h"
#include "cli/files/lost.h"
#include "cli/run/interrupt.h"
#include <string.h>
#include <strings.h>

enum { MAX_THREADS = 1024 };

/* --- options --- */

/* Returns a name with the extension of the output, or of the files that it is the index of. */
static const char *files_of_output(const run *r) {
    const char *output = r->common.output, *dot = strrchr(output, '.');
    if (cli_is_point_index(output)) return cli_point_tile_format(r);
    return r->common.format ? r->common.format : dot && !strcasecmp(dot, ".pvtu") ? "vtu" : output;
}

static brio_status check_compress(run *r) {
    const common_options *c = &r->common;
    if (!c->compress || !c->output) return BRIO_OK;
    if (c->ascii) return cli_fail(r, BRIO_ERR_ARGUMENT, "--compress and --ascii: text is not compressed");
    const brio_format_info *info = brio_format_facts(brio_format_of(files_of_output(r)));
    char others[BRIO_FORMAT_LIST];
    if (info && info->holds & BRIO_HOLDS_COMPRESSED) return BRIO_OK;
    brio_format_list(1, BRIO_HOLDS_COMPRESSED, others, sizeof others);
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a file of this format cannot be compressed; %s can", c->output, others);
}

static bool names_output(const run *r) {
    if (r->common.output) return true;
    for (const option *row = r->command->options; row->kind; row++) {
        const char *path = NULL;
        if (row->kind == OPTION_OUTPUT) memcpy(&path, (const char *)r->arguments + row->offset, sizeof path);
        if (path) return true;
    }
    return false;
}

brio_status cli_require_output_for(run *r, const char *name, bool given) {
    if (!given || r->common.output) return BRIO_OK;
    return cli_fail_output(r, "no output: --%s needs -o FILE", name);
}

/* Refuses options about a file that is not written. */
static brio_status refuse_idle(run *r) {
    const common_options *c = &r->common;
    bool written = names_output(r);
    const struct {
        const char *name;
        bool idle;
    } given[] = {{"format", c->format && !c->output},
                 {"ascii", c->ascii && !written},
                 {"float32", c->float32 && !written},
                 {"compress", c->compress && !written}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        if (!given[i].idle) continue;
        if (r->command->has_output) return cli_require_output_for(r, given[i].name, true);
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s writes no file; --%s has no meaning here", r->command->name,
                        given[i].name);
    }
    return BRIO_OK;
}

/* Refuses --view and --picture for a command that makes no mesh: it writes nothing, or what is no mesh, or a file by
 * itself. */
static brio_status check_shown(run *r) {
    const command *c = r->command;
    const char *name = c->shows ? r->common.view ? "--view" : NULL : cli_showing(r);
    if (name && !c->shown && (!c->has_output || c->outputs || c->writes_last))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s has no meaning for %s; brio view shows files", name, c->name);
    FORWARD(cli_check_page(r, "view", r->common.view));
    return cli_check_picture(r);
}

brio_status cli_check_common(run *r) {
    const common_options *c = &r->common;
    FORWARD(refuse_idle(r));
    FORWARD(check_shown(r));
    if (c->threads < 0 || c->threads > MAX_THREADS)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--threads: %d is not between 0 and %d", c->threads, MAX_THREADS);
    if (c->json && cli_goes_to_stdout(c->output))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--json and -o %s both want standard output", c->output);
    if (c->input_format && brio_format_of(c->input_format) == BRIO_FORMAT_AUTO)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--input-format: unknown format '%s'", c->input_format);
    FORWARD(check_compress(r));
    return cli_check_named_twice(r);
}

/* --- reading --- */

brio_read_options cli_read_options(run *r) {
    const common_options *c = &r->common;
    brio_read_options options = {0};
    if (c->input_format) options.format = brio_format_of(c->input_format);
    options.columns = c->columns;
    options.flat = r->over_map;
    options.drop_invalid = c->drop_invalid;
    options.dropped = &r->dropped;
    options.salvage = c->salvage;
    options.missing = &r->missing;
    options.notes = &r->noted;
    options.origins = r->wants_origins ? &r->added_origins : NULL;
    r->dropped = r->missing = 0;
    r->noted = (brio_read_notes){.size = sizeof r->noted};
    return options;
}

void cli_tell_input(run *r, const char *path) {
    const brio_read_notes *found = &r->noted;
    if (found->numbered) cli_warn(r, WARNING_NUMBERED, path);
    if (found->rounded) cli_warn(r, WARNING_ROUNDED, path, found->rounded_line, found->rounded_column, found->rounded);
    if (r->common.drop_invalid) cli_fact_count(&r->facts, "dropped", r->dropped);
    if (r->dropped) cli_warn(r, WARNING_DROPPED, path, r->dropped);
    if (r->common.salvage) cli_fact_count(&r->facts, "missing", r->missing);
    if (r->missing) cli_warn(r, WARNING_MISSING, path, r->missing);
}

brio_status cli_read(run *r, const char *path, brio_mesh **out) {
    brio_read_options options = cli_read_options(r);
    FORWARD(brio_read(r->ctx, path, &options, out));
    FORWARD(cli_check_interrupt(r));
    cli_tell_input(r, path);
    FORWARD(cli_check_precision(r, path, *out));
    r->has_properties |= (*out)->num_properties > 0 || (*out)->num_face_properties > 0;
    cli_lap(r, "read");
    return BRIO_OK;
}

brio_status cli_refuse_input_options(run *r) {
    const common_options *c = &r->common;
    const char *given = c->columns        ? "columns"
                        : c->input_format ? "input-format"
                        : c->drop_invalid ? "drop-invalid"
                        : c->salvage      ? "salvage"
                                          : NULL;
    if (!given) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s reads no points; --%s has no meaning here", r->command->name, given);
}

/* Moves the arrays into a mesh that is freed. */
brio_status cli_drop_connectivity(run *r, brio_mesh *mesh) {
    brio_mesh *rest = NULL;
    brio_status status = brio_mesh_new(r->ctx, &rest);
    if (status != BRIO_OK) return status;
    rest->face_offsets = mesh->face_offsets;
    rest->face_vertices = mesh->face_vertices;
    rest->tetrahedra = mesh->tetrahedra;
    rest->edges = mesh->edges;
    rest->face_properties = mesh->face_properties;
    rest->num_face_properties = mesh->num_face_properties;
    brio_mesh_free(rest);
    mesh->face_offsets = NULL;
    mesh->face_vertices = mesh->tetrahedra = mesh->edges = NULL;
    mesh->face_properties = NULL;
    mesh->num_faces = mesh->num_tetrahedra = mesh->num_edges = mesh->num_face_properties = 0;
    return BRIO_OK;
}

brio_status cli_read_points(run *r, const char *path, brio_mesh **out) {
    brio_status status = cli_read(r, path, out);
    return status == BRIO_OK ? cli_drop_connectivity(r, *out) : status;
}

brio_status cli_read_samples(run *r, const char *path, brio_mesh **out) {
    brio_status status = cli_read(r, path, out);
    if (status != BRIO_OK) return status;
    size_t faces = (*out)->num_faces;
    if (faces) cli_warn(r, WARNING_CONNECTED, path, faces, faces == 1 ? "" : "s", r->command->name);
    return cli_drop_connectivity(r, *out);
}

brio_status cli_require_output_holding(run *r, cli_holds holds, bool optional) {
    const common_options *c = &r->common;
    brio_format format;
    if (!c->output && (optional || c->json || cli_showing(r))) return BRIO_OK;
    if (!c->output) return cli_fail_output(r, "no output: -o FILE is missing");
    FORWARD(cli_output_format(r, c->output, c->format, &format));
    const brio_format_info *info = brio_format_facts(format);
    if ((info->holds & holds) != holds)
        return cli_fail_output(r, "%s: a file of this format cannot hold the result of '%s'", c->output,
                               r->command->name);
    if (info->holds & BRIO_HOLDS_PLACES && cli_is_single(c->output))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: the beginning of %s is written last: that needs a file, no pipe",
                        strcmp(c->output, "-") ? c->output : "standard output", info->name);
    return strcmp(c->output, "-") ? cli_check_target(r, c->output) : BRIO_OK;
}

brio_status cli_require_output(run *r, bool optional) {
    return cli_require_output_holding(r, r->command->holds, optional);
}

static brio_status write_file(run *r, const char *path, const char *extension, const brio_mesh *mesh) {
    brio_write_options options = {0};
    brio_status status = BRIO_OK;
    double moved = 0;
    int rounded = 0;
    size_t merged = 0;
    TRY(cli_output_format(r, path, extension, &options.format));
    if (extension && !strcasecmp(extension, "csv")) options.separator = ",";
    options.ascii = r->common.ascii;
    options.float32 = r->common.float32;
    options.moved = &moved;
    options.colours_rounded = &rounded;
    TRY(cli_settle_precision(r, path, mesh, &options, &merged));
    options.compress = r->common.compress && brio_format_facts(options.format)->holds & BRIO_HOLDS_COMPRESSED;
    options.comment = "brio " BRIO_VERSION;
    options.neighbours = r->neighbours;
    options.faces = r->faces;
    options.edges = r->edges;
    TRY(cli_check_interrupt(r));
    cli_interrupt_writing(strcmp(path, "-") != 0);
    status = brio_write(r->ctx, path, mesh, &options);
    cli_interrupt_writing(false);
    cli_lap(r, "write");
    if (status != BRIO_OK) goto done;
    cli_tell_moved(r, path, moved, merged);
    cli_tell_lost(r, path, mesh, options.format);
    if (rounded) cli_warn(r, WARNING_COLOURS, path);
done:
    return status;
}

brio_status cli_write(run *r, const brio_mesh *mesh) {
    if (r->common.output) FORWARD(write_file(r, r->common.output, r->common.format, mesh));
    return cli_show(r, mesh);
}

brio_status cli_write_to(run *r, const char *path, const brio_mesh *mesh) {
    return write_file(r, path, NULL, mesh);
}
