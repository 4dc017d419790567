/* A run of one command, between the command line on one side and the library on the other. */
#include "cli/run/run.h"
#include "cli/report/plain.h"
#include "cli/run/interrupt.h"
#include "platform/file.h"
#include "platform/pages.h"
#include "platform/program.h"
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* --- warnings and hints --- */

static void keep(notes *n, const char *format, va_list arguments) {
    size_t room = sizeof n->text - n->used;
    int length = vsnprintf(n->text + n->used, room, format, arguments);
    if (length > 0 && (size_t)length < room) n->used += (size_t)length + 1;
}

void cli_warn(run *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    keep(&r->warnings, format, arguments);
    va_end(arguments);
}

void cli_hint(run *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    keep(&r->hints, format, arguments);
    va_end(arguments);
}

void cli_notes_report(facts *f, const char *name, const notes *n) {
    if (n->used == 0) return;
    cli_fact_open(f, name, FACT_LIST);
    for (size_t i = 0; i < n->used; i += strlen(n->text + i) + 1) cli_fact_text(f, NULL, n->text + i);
    cli_fact_close(f);
}

void cli_notes_print(FILE *out, const char *kind, const notes *n) {
    for (size_t i = 0; i < n->used; i += strlen(n->text + i) + 1) {
        fprintf(out, "brio: %s: ", kind);
        cli_print_plain(out, n->text + i);
        fputc('\n', out);
    }
}

/* --- options of every command --- */

#define FIELD(name) offsetof(common_options, name)
const option cli_common_options[] = {
    {"output", 'o', OPTION_OUTPUT, FIELD(output), "FILE",
     "the file to write; its extension names the format; - is standard output", 0},
    {"format", 0, OPTION_TEXT, FIELD(format), "EXT", "format of the output, such as ply (needed with -o -)", 0},
    {"view", 0, OPTION_OUTPUT, FIELD(view), "FILE",
     "also write a page, .html, that shows the result in a browser (as brio view does)", 0},
    {"picture", 0, OPTION_OUTPUT, FIELD(picture), "FILE", "also write a picture of the result, .png", 0},
    {"look", 0, OPTION_TEXT, FIELD(look), "X,Y,Z",
     "direction of the picture's eye (default: of some the one that shows most)", 0},
    {"colour-by", 0, OPTION_TEXT, FIELD(colour_by), "NAME",
     "property that colours the picture, x, y, z, or none (default: the colours of the result)", 0},
    {"picture-size", 0, OPTION_TEXT, FIELD(picture_size), "WxH", "pixels of the picture (default 960x640)", 0},
    {"input-format", 0, OPTION_TEXT, FIELD(input_format), "EXT",
     "format of the input, where its name and content do not tell", 0},
    {"columns", 0, OPTION_TEXT, FIELD(columns), "NAMES", "columns of a text input: x,y,z,-,nx (- leaves one out)", 0},
    {"drop-invalid", 0, OPTION_FLAG, FIELD(drop_invalid), NULL,
     "leave out points of the input whose coordinates are not finite, instead of refusing the file", 0},
    {"salvage", 0, OPTION_FLAG, FIELD(salvage), NULL, "of an input that ends early, keep the points that are whole", 0},
    {"ascii", 0, OPTION_FLAG, FIELD(ascii), NULL, "write text where the format has text and binary", 0},
    {"float32", 0, OPTION_FLAG, FIELD(float32), NULL, "write coordinates in single precision", 0},
    {"compress", 0, OPTION_FLAG, FIELD(compress), NULL,
     "write numbers compressed, where the format has that (brio help formats)", 0},
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

/* --- what a command reads and writes --- */

void cli_list_inputs(const command *c, char *text) {
    if (c->choices)
        text[0] = 0;
    else if (c->inputs)
        snprintf(text, BRIO_FORMAT_LIST, "%s", c->inputs);
    else
        brio_format_list(0, 0, text, BRIO_FORMAT_LIST);
}

void cli_list_outputs(const command *c, char *text) {
    if (!c->has_output)
        text[0] = 0;
    else if (c->outputs)
        snprintf(text, BRIO_FORMAT_LIST, "%s", c->outputs);
    else
        brio_format_list(1, (unsigned)c->holds, text, BRIO_FORMAT_LIST);
}

/* --- failure --- */

brio_status cli_fail(run *r, brio_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(r->message, sizeof r->message, format, arguments);
    va_end(arguments);
    r->failure = (brio_failure){.status = status};
    return status;
}

brio_status cli_because(run *r, brio_reason reason, brio_status status) {
    r->failure.reason = reason;
    return status;
}

brio_failure cli_failure(const run *r) {
    brio_failure f = r->failure;
    f.size = sizeof f;
    if (!r->message[0] && r->ctx) (void)brio_last_failure(r->ctx, &f);
    return f;
}

void cli_keep_failure(run *r, brio_status status) {
    const brio_failure f = cli_failure(r);
    if (r->message[0]) return;
    cli_fail(r, status, "%s", brio_message(r->ctx));
    r->failure = f;
}

brio_status cli_fail_output(run *r, const char *format, ...) {
    char outputs[BRIO_FORMAT_LIST];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(r->message, sizeof r->message, format, arguments);
    va_end(arguments);
    r->failure = (brio_failure){.status = BRIO_ERR_ARGUMENT};
    cli_list_outputs(r->command, outputs);
    if (*outputs) cli_hint(r, HINT_OUTPUTS, r->command->name, outputs);
    return BRIO_ERR_ARGUMENT;
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

brio_status cli_begin(run *r) {
    const common_options *c = &r->common;
    FORWARD(brio_context_new(NULL, &r->ctx));
    brio_context_set_threads(r->ctx, c->threads);
    brio_context_set_memory_limit(r->ctx, c->max_memory);
    brio_context_set_progress(r->ctx, on_progress, r);
    if (c->scratch) {
        cli_interrupt_scratch(c->scratch, c->json);
        FORWARD(brio_context_set_scratch(r->ctx, c->scratch));
    }
    r->bar.terminal = brio_is_terminal(BRIO_MESSAGES);
    r->bar.shown = c->progress || (r->bar.terminal && !c->quiet);
    return BRIO_OK;
}

brio_status cli_experiment(run *r, const brio_laboratory_options *options) {
    brio_laboratory_free(r->lab);
    r->lab = NULL;
    return brio_laboratory_new(r->ctx, options, &r->lab);
}

void cli_end(run *r) {
    cli_facts_free(&r->facts);
    brio_explanation_free(r->explanation);
    brio_laboratory_free(r->lab);
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
    r->over_limit = true;
    return cli_fail(r, BRIO_ERR_NO_MEMORY, "about %.1f MiB needed, over the limit of %.1f MiB (--max-memory)",
                    bytes / 0x1p20, (double)c->max_memory / 0x1p20);
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
    cli_fact_bytes(f, "peak_bytes", brio_process_peak());
}
