/* brio: the command line.
 *
 * Finds the command, reads its options, runs it, and reports: facts to standard output (as JSON with --json), messages
 * to standard error, and the status as the exit code. */
#include "commands.h"
#include "interrupt.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define COMMAND_ADDRESS(name) &cli_##name,
static const command *const commands[] = {COMMANDS(COMMAND_ADDRESS) NULL};

static const char *command_name(const void *list, size_t i) {
    const command *const *all = list;
    return all[i] ? all[i]->name : NULL;
}

static const command *find_command(const char *name) {
    for (size_t i = 0; commands[i]; i++)
        if (!strcmp(commands[i]->name, name)) return commands[i];
    return NULL;
}

/* --- help --- */

static void print_help(FILE *out) {
    fputs("brio " BRIO_VERSION ": exact Delaunay and regular triangulations, and surfaces from points\n\n"
          "usage: brio COMMAND [options] INPUT\n\ncommands:\n",
          out);
    for (size_t i = 0; commands[i]; i++) fprintf(out, "  %-10s %s\n", commands[i]->name, commands[i]->summary);
    fputs("\nbrio COMMAND --help lists the options of a command, brio --version prints the version.\n"
          "An input or output of - is standard input or output.\n\n"
          "exit codes: 0 done, 1 wrong usage, 2 bad input, 3 no answer, 4 not enough memory, 5 the result does not\n"
          "check, 6 could not write, 130 interrupted\n",
          out);
}

static void print_command_help(FILE *out, const command *c) {
    const option_group own = {"options of this command", c->options, NULL};
    const option_group common = {"options of every command", cli_common_options, NULL};
    fprintf(out, "usage: brio %s %s [options]\n\n%s\n", c->name, c->operands, c->summary);
    if (c->options[0].kind) cli_print_options(out, &own);
    cli_print_options(out, &common);
    fprintf(out, "  %-28s%s\n", "-h, --help", "print this");
}

/* --- one command --- */

/* Whether a line that could not be read through asks for JSON. */
static bool asks_for_json(int argc, char **argv) {
    for (int i = 0; i < argc && strcmp(argv[i], "--"); i++)
        if (!strcmp(argv[i], "--json")) return true;
    return false;
}

/* Facts to where they are asked for; false when standard output does not take them. */
static bool report(run *r, brio_status status, int code) {
    bool answered = status == BRIO_OK || status == BRIO_ERR_CHECK;
    if (answered) cli_closing_facts(r);
    if (r->common.json && status != BRIO_OK) {
        cli_fact_text(&r->facts, "error", cli_message(r, status));
        cli_fact_integer(&r->facts, "exit", code);
    }
    if (r->facts.failed) {
        fputs("brio: out of memory for the report\n", stderr);
        return false;
    }
    bool data_on_stdout = r->common.output && !strcmp(r->common.output, "-");
    if (r->common.json)
        cli_json_write(stdout, &r->facts);
    else if (answered && !r->common.quiet)
        cli_text_write(data_on_stdout ? stderr : stdout, &r->facts);
    if (fflush(stdout) == 0 && !ferror(stdout)) return true;
    fprintf(stderr, "brio: standard output: %s\n", strerror(errno));
    return false;
}

/* After a signal any failure is an interruption: a call of the system that it cut short looks like another error. */
static brio_status interruption(run *r, brio_status status) {
    return status != BRIO_OK && cli_interrupted() ? cli_fail(r, BRIO_ERR_CANCELLED, "interrupted") : status;
}

/* The library's sentence about an input without an answer does not know the file, unless the library read it. */
static brio_status name_input(run *r, brio_status status) {
    int input = r->command ? r->command->first_input : 0;
    if (status != BRIO_ERR_NO_ANSWER || r->message[0] || !r->ctx || r->num_operands != input + 1) return status;
    const char *operand = r->operands[input], *message = brio_message(r->ctx);
    const char *name = strcmp(operand, "-") ? operand : "standard input";
    if (!strncmp(message, name, strlen(name))) return status;
    return cli_fail(r, status, "%s: %s", name, message);
}

static int finish(run *r, brio_status status) {
    status = name_input(r, interruption(r, status));
    int code = cli_exit_code(status);
    cli_progress_end(&r->bar);
    bool reported = report(r, status, code);
    if (status != BRIO_OK) fprintf(stderr, "brio: %s\n", cli_message(r, status));
    if (status == BRIO_ERR_ARGUMENT) {
        const char *name = r->command ? r->command->name : "";
        fprintf(stderr, "brio: see 'brio %s%s--help'\n", name, *name ? " " : "");
    }
    if (code == 70) fputs("brio: this is a fault of brio; please report it with the input\n", stderr);
    if (!reported && status == BRIO_OK) code = r->facts.failed ? 4 : cli_exit_code(interruption(r, BRIO_ERR_WRITE));
    cli_end(r);
    return code;
}

static brio_status check_operands(run *r) {
    const command *c = r->command;
    if (r->num_operands < c->min_operands)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: expected %s, got %d argument%s", c->name, c->operands,
                        r->num_operands, r->num_operands == 1 ? "" : "s");
    if (r->num_operands > c->max_operands)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: one argument too many: '%s'", c->name, r->operands[c->max_operands]);
    return BRIO_OK;
}

static brio_status parse_line(run *r, void *arguments, int argc, char **argv, bool *help) {
    const option_group groups[] = {{"", r->command->options, arguments}, {"", cli_common_options, &r->common}};
    option_parse parse = {.groups = groups, .num_groups = 2};
    bool json = asks_for_json(argc, argv); /* asked before parsing reorders the arguments */
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
        print_command_help(stdout, c);
        free(arguments);
        return fflush(stdout) == 0 ? 0 : 6;
    }
    TRY(cli_begin(&r));
    cli_opening_facts(&r);
    r.lap = cli_clock();
    TRY(c->run(&r));
done:;
    int code = finish(&r, status);
    free(arguments);
    return code;
}

static int unknown_command(const char *name, bool json) {
    run r = {.common.json = json};
    const char *near = cli_nearest(name, command_name, commands);
    if (near)
        return finish(&r, cli_fail(&r, BRIO_ERR_ARGUMENT, "unknown command '%s'; did you mean '%s'?", name, near));
    return finish(&r, cli_fail(&r, BRIO_ERR_ARGUMENT, "unknown command '%s'", name));
}

int main(int argc, char **argv) {
    cli_interrupt_install();
    if (argc < 2) {
        fputs("brio: no command\nbrio: see 'brio --help'\n", stderr);
        return 1;
    }
    const char *first = argv[1];
    if (argc > 2 && !strcmp(first, "generate") && !strcmp(argv[2], "iso")) { /* as it was called in version 0.1 */
        first = "iso";
        argc--, argv++;
    }
    const command *c = find_command(first);
    if (c) return run_command(c, argc - 2, argv + 2);
    if (!strcmp(first, "--help") || !strcmp(first, "-h"))
        print_help(stdout);
    else if (!strcmp(first, "--version"))
        printf("brio %s\n", brio_version());
    else
        return unknown_command(first, asks_for_json(argc - 2, argv + 2));
    return fflush(stdout) == 0 ? 0 : 6;
}
