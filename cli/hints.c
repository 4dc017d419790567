/* What to try after a failure: by the command and the status, since the library's sentence says only what is wrong. */
#include "hints.h"
#include <string.h>

static bool is(const run *r, const char *name) {
    return !strcmp(r->command->name, name);
}

static void suggest_for_no_answer(run *r) {
    if (is(r, "alpha"))
        cli_hint(r, "a larger --alpha takes in more; --alpha auto finds the least that holds all points");
    if (is(r, "iso"))
        cli_hint(r, "try another --level; with --sigma it counts in standard deviations, 1 to 3 for most maps");
    if (is(r, "subdivide"))
        cli_hint(r, "'brio check FILE' says what is wrong with a mesh, 'brio surface' makes one of points");
    if (is(r, "medial") || is(r, "offset"))
        cli_hint(r, "the points, or the mesh, must surround a solid: see what 'brio surface' makes of them first");
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
    if (!r->common.input_format && strstr(cli_message(r, BRIO_ERR_FORMAT), "unknown format"))
        cli_hint(r, "--input-format EXT names the format of a file whose name does not tell it");
}

void cli_suggest(run *r, brio_status status) {
    if (!r->command) return;
    switch (status) {
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
