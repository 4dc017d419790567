/* The steps that all commands share, between the command line on one side and the library on the other. */
#include "run.h"
#include "files.h"
#include "interrupt.h"
#include "lost.h"
#include "precision.h"
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <unistd.h>

enum { MAX_THREADS = 1024 };

#define FIELD(name) offsetof(common_options, name)
const option cli_common_options[] = {
    {"output", 'o', OPTION_OUTPUT, FIELD(output), "FILE",
     "the file to write; its extension names the format; - is standard output", 0},
    {"format", 0, OPTION_TEXT, FIELD(format), "EXT", "format of the output, such as ply (needed with -o -)", 0},
    {"input-format", 0, OPTION_TEXT, FIELD(input_format), "EXT",
     "format of the input, where its name and content do not tell", 0},
    {"columns", 0, OPTION_TEXT, FIELD(columns), "NAMES", "columns of a text input: x,y,z,-,nx (- leaves one out)", 0},
    {"drop-invalid", 0, OPTION_FLAG, FIELD(drop_invalid), NULL,
     "leave out points of the input whose coordinates are not finite, instead of refusing the file", 0},
    {"salvage", 0, OPTION_FLAG, FIELD(salvage), NULL, "of an input that ends early, keep the points that are whole", 0},
    {"ascii", 0, OPTION_FLAG, FIELD(ascii), NULL, "write text where the format has text and binary", 0},
    {"float32", 0, OPTION_FLAG, FIELD(float32), NULL, "write coordinates in single precision", 0},
    {"compress", 0, OPTION_FLAG, FIELD(compress), NULL, "write numbers compressed: .vtu, .vtp, .pcd", 0},
    {"json", 0, OPTION_FLAG, FIELD(json), NULL, "print the report as one JSON object on standard output", 0},
    {"threads", 0, OPTION_INT, FIELD(threads), "N", "threads to use (default 0: all cores)", 0},
    {"seed", 0, OPTION_NATURAL, FIELD(seed), "N", "every random choice follows from it (default 1)", 0},
    {"max-memory", 0, OPTION_SIZE | OPTION_POSITIVE, FIELD(max_memory), "SIZE",
     "refuse work estimated over SIZE, such as 500M or 8G", 0},
    {"scratch", 0, OPTION_TEXT, FIELD(scratch), "DIR", "keep the big arrays in files in DIR instead of memory", 0},
    {"verbose", 0, OPTION_FLAG, FIELD(verbose), NULL,
     "report also how it was done: seconds by stage, internal counts; with --help what each line means", 0},
    {"quiet", 0, OPTION_FLAG, FIELD(quiet), NULL, "no progress bar, no report, no warnings or hints", 0},
    {"progress", 0, OPTION_FLAG, FIELD(progress), NULL,
     "show the progress bar even where standard error is no terminal", 0},
    {0},
};
#undef FIELD

const common_options cli_common_defaults = {.seed = 1};

/* --- failure --- */

brio_status cli_fail(run *r, brio_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(r->message, sizeof r->message, format, arguments);
    va_end(arguments);
    return status;
}

const char *cli_message(const run *r, brio_status status) {
    if (r->message[0]) return r->message;
    if (r->ctx && brio_message(r->ctx)[0]) return brio_message(r->ctx);
    return brio_status_string(status);
}

int cli_exit_code(brio_status status) {
    switch (status) {
    case BRIO_OK:
        return 0;
    case BRIO_ERR_ARGUMENT:
        return 1;
    case BRIO_ERR_OPEN:
    case BRIO_ERR_FORMAT:
    case BRIO_ERR_NOT_FINITE:
        return 2;
    case BRIO_ERR_NO_ANSWER:
        return 3;
    case BRIO_ERR_NO_MEMORY:
    case BRIO_ERR_TOO_LARGE:
        return 4;
    case BRIO_ERR_CHECK:
        return 5;
    case BRIO_ERR_WRITE:
        return 6;
    case BRIO_ERR_CANCELLED:
        return 130;
    case BRIO_ERR_INTERNAL:
    case BRIO_STATUS_END:
        break;
    }
    return 70; /* EX_SOFTWARE of sysexits.h: a fault of the program */
}

/* --- beginning and end --- */

static int on_progress(const char *stage, double fraction, void *user) {
    run *r = user;
    cli_progress_show(&r->bar, stage, fraction);
    return cli_interrupted();
}

static brio_status check_compress(run *r) {
    const common_options *c = &r->common;
    if (!c->compress || !c->output) return BRIO_OK;
    if (c->ascii) return cli_fail(r, BRIO_ERR_ARGUMENT, "--compress and --ascii: text is not compressed");
    const brio_format_info *info = brio_format_facts(brio_format_of(c->format ? c->format : c->output));
    if (info && info->holds & BRIO_HOLDS_COMPRESSED) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a file of this format cannot be compressed; .vtu, .vtp and .pcd can",
                    c->output);
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
    return cli_fail(r, BRIO_ERR_ARGUMENT, "no output: --%s needs -o FILE", name);
}

/* Options about a file that is not written are a mistake. */
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
        if (r->command->outputs) return cli_require_output_for(r, given[i].name, true);
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s writes no file; --%s has no meaning here", r->command->name,
                        given[i].name);
    }
    return BRIO_OK;
}

static brio_status check_common(run *r) {
    const common_options *c = &r->common;
    brio_status status = BRIO_OK;
    TRY(refuse_idle(r));
    if (c->threads < 0 || c->threads > MAX_THREADS)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--threads: %d is not between 0 and %d", c->threads, MAX_THREADS);
    if (c->json && cli_goes_to_stdout(c->output))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--json and -o %s both want standard output", c->output);
    if (c->input_format && brio_format_of(c->input_format) == BRIO_FORMAT_AUTO)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--input-format: unknown format '%s'", c->input_format);
    status = check_compress(r);
done:
    return status;
}

brio_status cli_begin(run *r) {
    const common_options *c = &r->common;
    brio_status status = BRIO_OK;
    TRY(check_common(r));
    TRY(cli_check_named_twice(r));
    TRY(brio_context_new(NULL, &r->ctx));
    brio_context_set_threads(r->ctx, c->threads);
    brio_context_set_memory_limit(r->ctx, c->max_memory);
    brio_context_set_progress(r->ctx, on_progress, r);
    if (c->scratch) {
        cli_interrupt_scratch(c->scratch, c->json);
        TRY(brio_context_set_scratch(r->ctx, c->scratch));
    }
    r->bar.terminal = isatty(STDERR_FILENO);
    r->bar.shown = c->progress || (r->bar.terminal && !c->quiet);
done:
    return status;
}

void cli_end(run *r) {
    cli_facts_free(&r->facts);
    brio_context_free(r->ctx);
}

/* --- the clock --- */

void cli_stage(run *r, const char *stage, double seconds) {
    int i = 0;
    while (i < r->num_stages && strcmp(r->stages[i].stage, stage)) i++;
    if (i == MAX_STAGES) return;
    if (i == r->num_stages) r->num_stages++;
    r->stages[i].stage = stage;
    r->stages[i].seconds += seconds;
}

void cli_lap(run *r, const char *stage) {
    double now = cli_clock();
    cli_stage(r, stage, now - r->lap);
    r->lap = now;
}

brio_status cli_check_interrupt(run *r) {
    return cli_interrupted() ? cli_fail(r, BRIO_ERR_CANCELLED, "interrupted") : BRIO_OK;
}

/* --- memory --- */

bool cli_limits_memory(const run *r) {
    return r->common.max_memory && !r->common.scratch;
}

brio_status cli_require_memory(run *r, double bytes) {
    const common_options *c = &r->common;
    if (!cli_limits_memory(r) || bytes <= (double)c->max_memory) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_NO_MEMORY, "about %.1f MiB needed, over the limit of %.1f MiB (--max-memory)",
                    bytes / 0x1p20, (double)c->max_memory / 0x1p20);
}

/* The kernel's high-water mark of this program's own memory. getrusage stands in where /proc is missing: it also counts
 * what the process held before it became this program. */
static uint64_t peak_bytes(void) {
    unsigned long long kib = 0;
    char line[256];
    FILE *file = fopen("/proc/self/status", "r");
    while (file && !kib && fgets(line, sizeof line, file)) sscanf(line, "VmHWM: %llu", &kib);
    if (file) fclose(file);
    struct rusage usage;
    if (!kib && getrusage(RUSAGE_SELF, &usage) == 0) kib = (unsigned long long)usage.ru_maxrss;
    return kib * 1024;
}

/* --- files --- */

brio_read_options cli_read_options(run *r) {
    const common_options *c = &r->common;
    brio_read_options options = brio_read_options_default();
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
    brio_status status = BRIO_OK;
    TRY(brio_read_as(r->ctx, path, &options, out));
    TRY(cli_check_interrupt(r));
    cli_tell_input(r, path);
    TRY(cli_check_precision(r, path, *out));
    r->has_properties |= (*out)->num_properties > 0 || (*out)->num_face_properties > 0;
    cli_lap(r, "read");
done:
    return status;
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
    brio_mesh_free(rest);
    mesh->face_offsets = NULL;
    mesh->face_vertices = mesh->tetrahedra = mesh->edges = NULL;
    mesh->num_faces = mesh->num_tetrahedra = mesh->num_edges = 0;
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

const brio_format cli_mesh_formats[] = {BRIO_FORMAT_PLY, BRIO_FORMAT_OBJ, BRIO_FORMAT_OFF,
                                        BRIO_FORMAT_STL, BRIO_FORMAT_VTU, BRIO_FORMAT_VTP,
                                        BRIO_FORMAT_VTK, BRIO_FORMAT_GLB, BRIO_FORMAT_AUTO};

const brio_format cli_point_formats[] = {BRIO_FORMAT_PLY, BRIO_FORMAT_XYZ,  BRIO_FORMAT_VTU, BRIO_FORMAT_VTK,
                                         BRIO_FORMAT_VTP, BRIO_FORMAT_NODE, BRIO_FORMAT_LAS, BRIO_FORMAT_LAZ,
                                         BRIO_FORMAT_NPY, BRIO_FORMAT_GLB,  BRIO_FORMAT_PCD, BRIO_FORMAT_AUTO};

static brio_status check_format(run *r, const brio_format *formats, brio_format format) {
    for (; formats && *formats != format; formats++)
        if (*formats == BRIO_FORMAT_AUTO)
            return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a file of this format cannot hold the result of '%s'",
                            r->common.output, r->command->name);
    return BRIO_OK;
}

brio_status cli_require_output(run *r, const brio_format *formats, bool optional) {
    const common_options *c = &r->common;
    brio_format format;
    brio_status status = BRIO_OK;
    if (!c->output && (optional || c->json)) return BRIO_OK;
    if (!c->output) return cli_fail(r, BRIO_ERR_ARGUMENT, "no output: -o FILE is missing");
    TRY(cli_output_format(r, c->output, c->format, &format));
    TRY(check_format(r, formats, format));
    if (strcmp(c->output, "-")) TRY(cli_check_target(r, c->output));
done:
    return status;
}

static brio_status write_file(run *r, const char *path, const char *extension, const brio_mesh *mesh) {
    brio_write_options options = brio_write_options_default();
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
    return r->common.output ? write_file(r, r->common.output, r->common.format, mesh) : BRIO_OK;
}

brio_status cli_write_to(run *r, const char *path, const brio_mesh *mesh) {
    return write_file(r, path, NULL, mesh);
}

/* --- the frame of a report --- */

void cli_opening_facts(run *r) {
    facts *f = &r->facts;
    int first = r->command->first_input < r->num_operands ? r->command->first_input : 0;
    cli_fact_text(f, "command", r->command->name);
    if (r->num_operands == first + 1) {
        cli_fact_text(f, "input", r->operands[first]);
    } else {
        cli_fact_open(f, "input", FACT_LIST);
        for (int i = first; i < r->num_operands; i++) cli_fact_text(f, NULL, r->operands[i]);
        cli_fact_close(f);
    }
    if (r->common.output) cli_fact_text(f, "output", r->common.output);
    cli_fact_count(f, "threads", (uint64_t)brio_context_threads(r->ctx));
}

void cli_closing_facts(run *r) {
    facts *f = &r->facts;
    cli_fact_open(f, "seconds", FACT_OBJECT);
    for (int i = 0; i < r->num_stages; i++) cli_fact_seconds(f, r->stages[i].stage, r->stages[i].seconds);
    cli_fact_seconds(f, "total", cli_clock() - r->started);
    cli_fact_close(f);
    cli_fact_bytes(f, "peak_bytes", peak_bytes());
}
