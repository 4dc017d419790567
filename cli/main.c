/* brio: the command line.
 *
 * Finds the command, reads its options, runs it, and reports: facts to standard output (as JSON with --json), messages
 * to standard error, and the status as the exit code. */
#include "cli/run/commands.h"
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/help/help.h"
#include "cli/steps/hints.h"
#include "cli/run/interrupt.h"
#include "cli/report/plain.h"
#include "platform/program.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char *command_name(const void *list, size_t i) {
    const command *const *all = list;
    return all[i] ? all[i]->name : NULL;
}

/* --- one command --- */

/* Returns whether a flag is on a line that is not, or could not be, read through. */
static bool has_flag(int argc, char **argv, const char *flag) {
    for (int i = 0; i < argc && strcmp(argv[i], "--"); i++)
        if (!strcmp(argv[i], flag)) return true;
    return false;
}

/* Gives standard output a buffer, so that printing needs no memory: without a buffer, the C library loses it in
 * silence. */
static void buffer_output(void) {
    static char buffer[BUFSIZ];
    setvbuf(stdout, buffer, _IOFBF, sizeof buffer);
}

/* Returns whether standard output took all that was printed. */
static bool printed(void) {
    if (fflush(stdout) == 0 && !ferror(stdout)) return true;
    fprintf(stderr, "brio: standard output: %s\n", strerror(errno));
    return false;
}

/* Facts to where they are asked for; false when standard output does not take them. */
static bool report(run *r, brio_status status, int code) {
    bool answered = status == BRIO_OK || status == BRIO_ERR_CHECK;
    const char *name = r->command ? r->command->name : "";
    if (answered) cli_closing_facts(r);
    if (r->common.json && status != BRIO_OK) {
        cli_fact_text(&r->facts, "error", cli_message(r, status));
        cli_fact_integer(&r->facts, "exit", code);
    }
    if (r->common.json) {
        cli_notes_report(&r->facts, "warnings", &r->warnings);
        if (status != BRIO_OK) cli_notes_report(&r->facts, "hints", &r->hints);
    }
    if (r->facts.failed) {
        fputs("brio: out of memory for the report\n", stderr);
        return false;
    }
    bool data_on_stdout = cli_goes_to_stdout(r->common.output);
    if (r->common.json)
        cli_json_write(stdout, &r->facts, name);
    else if (answered && !r->common.quiet)
        cli_text_write(data_on_stdout ? stderr : stdout, &r->facts, name, r->common.verbose);
    return printed();
}

/* Turns a failure into an interruption. After a signal any failure is an interruption: a call of the system that it cut
 * short looks like another error. */
static brio_status interruption(run *r, brio_status status) {
    return status != BRIO_OK && cli_interrupted() ? cli_fail(r, BRIO_ERR_CANCELLED, "interrupted") : status;
}

/* Warnings, then the error, then what to do about it. */
static void complain(const run *r, brio_status status) {
    const char *name = r->command ? r->command->name : "";
    if (!r->common.quiet) cli_notes_print(stderr, "warning", &r->warnings);
    if (status == BRIO_OK) return;
    fputs("brio: ", stderr);
    cli_print_plain(stderr, cli_message(r, status));
    fputc('\n', stderr);
    if (!r->common.quiet) cli_notes_print(stderr, "hint", &r->hints);
    if (status == BRIO_ERR_ARGUMENT) fprintf(stderr, "brio: see 'brio %s%s--help'\n", name, *name ? " " : "");
    if (cli_exit_code(status) == 70) fputs("brio: this is a fault of brio; please report it with the input\n", stderr);
}

static int finish(run *r, brio_status status) {
    status = interruption(r, status);
    int code = cli_exit_code(status);
    cli_progress_end(&r->bar);
    cli_name_input(r, status);
    cli_suggest(r, status);
    bool reported = report(r, status, code);
    complain(r, status);
    if (!reported && status == BRIO_OK) code = r->facts.failed ? 4 : cli_exit_code(interruption(r, BRIO_ERR_WRITE));
    cli_end(r);
    return code;
}

static brio_status check_operands(run *r) {
    const command *c = r->command;
    if (r->num_operands < c->min_operands) {
        if (c->examples) cli_hint(r, HINT_EXAMPLE, (int)strcspn(c->examples, "\n"), c->examples);
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: expected %s, got %s", c->name, c->operands,
                        r->num_operands ? "one argument" : "no argument");
    }
    if (r->num_operands > c->max_operands)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: one argument too many: '%s'", c->name, r->operands[c->max_operands]);
    if (c->writes_last && r->num_operands > 1 && !r->common.output) r->common.output = r->operands[--r->num_operands];
    return BRIO_OK;
}

static brio_status parse_line(run *r, void *arguments, int argc, char **argv, bool *help) {
    const option_group groups[] = {{r->command->options, arguments}, {cli_common_options, &r->common}};
    option_parse parse = {.groups = groups, .num_groups = 2};
    bool json = has_flag(argc, argv, "--json"); /* asked before parsing reorders the arguments */
    if (!cli_parse(&parse, argc, argv)) {
        r->common.json = json;
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s", r->command->name, parse.message);
    }
    *help = parse.help;
    r->operands = parse.operands;
    r->num_operands = parse.num_operands;
    return parse.help ? BRIO_OK : check_operands(r);
}

static int run_command(const command *c, int argc, char **argv) {
    run r = {.command = c, .common = cli_common_defaults, .started = cli_clock()};
    brio_status status = BRIO_OK;
    bool help = false;
    void *arguments = malloc(c->size);
    if (!arguments) return finish(&r, BRIO_ERR_NO_MEMORY);
    memcpy(arguments, c->defaults, c->size);
    r.arguments = arguments;
    TRY(parse_line(&r, arguments, argc, argv, &help));
    if (help) {
        cli_print_command_help(stdout, c, has_flag(argc, argv, "--verbose"));
        free(arguments);
        return printed() ? 0 : cli_exit_code(BRIO_ERR_WRITE);
    }
    TRY(cli_check_common(&r));
    TRY(cli_begin(&r));
    cli_opening_facts(&r);
    r.lap = cli_clock();
    TRY(c->run(&r));
    if (cli_showing(&r) && !r.shown)
        FAIL(&r, BRIO_ERR_ARGUMENT, "%s: this run of %s makes nothing that can be shown", cli_showing(&r), c->name);
done:;
    int code = finish(&r, status);
    free(arguments);
    return code;
}

static int unknown_command(const char *name, bool json) {
    run r = {.common.json = json};
    const char *near = cli_nearest(name, command_name, cli_commands);
    if (near)
        return finish(&r, cli_fail(&r, BRIO_ERR_ARGUMENT, "unknown command '%s'; did you mean '%s'?", name, near));
    return finish(&r, cli_fail(&r, BRIO_ERR_ARGUMENT, "unknown command '%s'", name));
}

/* Runs brio help [COMMAND|methods|formats]. */
static int help(int argc, char **argv) {
    const char *subject = argc > 0 ? argv[0] : "--help";
    const command *c = cli_find_command(subject);
    if (c)
        cli_print_command_help(stdout, c, has_flag(argc, argv, "--verbose"));
    else if (!strcmp(subject, "methods"))
        cli_print_advice(stdout);
    else if (!strcmp(subject, "formats"))
        cli_print_formats(stdout, has_flag(argc, argv, "--json"));
    else if (subject[0] == '-' || !strcmp(subject, "help"))
        cli_print_help(stdout);
    else
        return unknown_command(subject, false);
    return printed() ? 0 : cli_exit_code(BRIO_ERR_WRITE);
}

static bool is_one_of(const char *word, const char *a, const char *b) {
    return !strcmp(word, a) || !strcmp(word, b);
}

int main(int argc, char **argv) {
    brio_program_begin(&argc, &argv);
    cli_interrupt_install();
    buffer_output();
    if (argc < 2) {
        fputs("brio: no command\nbrio: see 'brio --help'\n", stderr);
        return 1;
    }
    const char *first = argv[1];
    if (argc > 2 && !strcmp(first, "generate") && !strcmp(argv[2], "iso")) { /* as it was called in version 0.1 */
        first = "iso";
        argc--, argv++;
    }
    const command *c = cli_find_command(first);
    if (c) return run_command(c, argc - 2, argv + 2);
    if (!strcmp(first, "help")) return help(argc - 2, argv + 2);
    if (is_one_of(first, "--help", "-h")) return help(0, NULL);
    if (!is_one_of(first, "--version", "-V")) return unknown_command(first, has_flag(argc - 2, argv + 2, "--json"));
    printf("brio %s\n", brio_version());
    return printed() ? 0 : cli_exit_code(BRIO_ERR_WRITE);
}
