/* What to try after a failure, by the command, the status and words of the sentence that says what is wrong. A sentence
 * that changes its words loses its hint: tests/cli/test_report.py holds each of them. */
#include "hints.h"
#include <string.h>

static bool is(const run *r, const char *name) {
    return !strcmp(r->command->name, name);
}

static bool says(const run *r, brio_status status, const char *words) {
    return strstr(cli_message(r, status), words) != NULL;
}

/* Wrong usage: an example where an operand is missing, the formats where that of -o is wrong. */
static void suggest_for_argument(run *r) {
    const command *c = r->command;
    bool about_output = says(r, BRIO_ERR_ARGUMENT, "cannot hold") || says(r, BRIO_ERR_ARGUMENT, "no output") ||
                        says(r, BRIO_ERR_ARGUMENT, "this version writes");
    if (says(r, BRIO_ERR_ARGUMENT, ", got ") && r->num_operands < c->min_operands && c->examples)
        cli_hint(r, "for example: %.*s", (int)strcspn(c->examples, "\n"), c->examples);
    else if (about_output && c->outputs)
        cli_hint(r, "'brio %s' writes files with the extensions %s", c->name, c->outputs);
}

static void suggest_for_poles(run *r) {
    if (says(r, BRIO_ERR_NO_ANSWER, "swallows"))
        cli_hint(r, "a smaller --distance leaves something");
    else
        cli_hint(r, "the points, or the mesh, must surround a solid: see what 'brio surface' makes of them first");
}

static void suggest_for_no_answer(run *r) {
    if (is(r, "alpha"))
        cli_hint(r, "a larger --alpha takes in more; --alpha auto finds the least with all points in one solid");
    if (is(r, "iso")) cli_hint(r, "try another --level; with --sigma it counts in standard deviations above the mean");
    if (is(r, "subdivide"))
        cli_hint(r, "'brio check FILE' says what is wrong with a mesh, 'brio surface' makes one of points");
    if (is(r, "medial") || is(r, "offset")) suggest_for_poles(r);
    if (is(r, "surface") || is(r, "medial") || is(r, "offset") || is(r, "alpha"))
        cli_hint(r, "'brio help methods' says which command and method fits which points (docs/which-method.md)");
}

static void suggest_for_no_memory(run *r) {
    if (!r->common.scratch) cli_hint(r, "--scratch DIR keeps the big arrays in files on a disk");
    if (is(r, "surface")) cli_hint(r, "--method cocone --pieces N works through N parts, one after the other");
    if (r->num_operands > 0 && !is(r, "generate") && !is(r, "info"))
        cli_hint(r, "'brio info FILE' estimates what each command needs");
}

static void suggest_for_check(run *r) {
    if (!is(r, "check")) return;
    if (strstr(cli_message(r, BRIO_ERR_CHECK), "not closed")) cli_hint(r, "--open accepts a surface with a boundary");
    cli_hint(r, "'brio check --help --verbose' explains the lines of the report");
}

static void suggest_for_format(run *r) {
    bool unknown = says(r, BRIO_ERR_FORMAT, "unknown format");
    if (unknown && is(r, "iso"))
        cli_hint(r, "'brio iso' reads maps and atoms; 'brio surface' makes surfaces of points");
    else if (unknown && !r->common.input_format)
        cli_hint(r, "--input-format EXT names the format of a file whose name does not tell it");
    if (says(r, BRIO_ERR_FORMAT, "no faces") || says(r, BRIO_ERR_FORMAT, "points only"))
        cli_hint(r, "'brio surface' makes a surface of points");
    if (says(r, BRIO_ERR_FORMAT, "no property")) cli_hint(r, "'brio info FILE' lists the properties of the points");
}

void cli_suggest(run *r, brio_status status) {
    if (!r->command) return;
    switch (status) {
    case BRIO_ERR_ARGUMENT:
        suggest_for_argument(r);
        break;
    case BRIO_ERR_NO_ANSWER:
        suggest_for_no_answer(r);
        break;
    case BRIO_ERR_NO_MEMORY:
        suggest_for_no_memory(r);
        break;
    case BRIO_ERR_CHECK:
        suggest_for_check(r);
        break;
    case BRIO_ERR_FORMAT:
        suggest_for_format(r);
        break;
    default:
        break;
    }
}

void cli_name_input(run *r, brio_status status) {
    char message[sizeof r->message];
    bool about_input = status == BRIO_ERR_NO_ANSWER || status == BRIO_ERR_CHECK;
    if (!about_input || !r->command || r->command->first_input >= r->num_operands) return;
    const char *input = r->operands[r->command->first_input];
    snprintf(message, sizeof message, "%s", cli_message(r, status));
    if (strstr(message, input)) return;
    snprintf(r->message, sizeof r->message, "%.300s: %.700s", strcmp(input, "-") ? input : "standard input", message);
}
