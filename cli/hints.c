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
        cli_hint(r, HINT_EXAMPLE, (int)strcspn(c->examples, "\n"), c->examples);
    else if (about_output && c->outputs)
        cli_hint(r, HINT_OUTPUTS, c->name, c->outputs);
}

static void suggest_for_poles(run *r) {
    if (says(r, BRIO_ERR_NO_ANSWER, "swallows"))
        cli_hint(r, HINT_DISTANCE);
    else
        cli_hint(r, HINT_SOLID);
}

static void suggest_for_no_answer(run *r) {
    if (is(r, "alpha")) cli_hint(r, HINT_ALPHA);
    if (is(r, "iso")) cli_hint(r, HINT_LEVEL);
    if (is(r, "subdivide")) cli_hint(r, HINT_SUBDIVIDE);
    if (is(r, "medial") || is(r, "offset")) suggest_for_poles(r);
    if (is(r, "surface") || is(r, "medial") || is(r, "offset") || is(r, "alpha")) cli_hint(r, HINT_METHODS);
}

static void suggest_for_no_memory(run *r) {
    if (!r->common.scratch) cli_hint(r, HINT_SCRATCH);
    if (is(r, "surface")) cli_hint(r, HINT_PIECES);
    if (r->num_operands > 0 && !is(r, "generate") && !is(r, "info")) cli_hint(r, HINT_ESTIMATE);
}

static void suggest_for_check(run *r) {
    if (!is(r, "check")) return;
    if (strstr(cli_message(r, BRIO_ERR_CHECK), "not closed")) cli_hint(r, HINT_OPEN);
    cli_hint(r, HINT_REPORT);
}

static void suggest_for_format(run *r) {
    bool unknown = says(r, BRIO_ERR_FORMAT, "unknown format");
    if (unknown && is(r, "iso"))
        cli_hint(r, HINT_ISO);
    else if (unknown && !r->common.input_format)
        cli_hint(r, HINT_INPUT_FORMAT);
    if (says(r, BRIO_ERR_FORMAT, "no faces") || says(r, BRIO_ERR_FORMAT, "points only")) cli_hint(r, HINT_SURFACE);
    if (says(r, BRIO_ERR_FORMAT, "no property")) cli_hint(r, HINT_PROPERTIES);
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
