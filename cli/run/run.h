/* A run of one command: the options that every command has, the library's context, the facts to report, the clock, the
 * memory. Steps return a status; what it means for the process is decided in one place, cli_exit_code. */
#ifndef BRIO_CLI_RUN_H
#define BRIO_CLI_RUN_H

#include "brio/brio.h"
#include "brio/laboratory.h"
#include "cli/report/facts.h"
#include "cli/report/progress.h"
#include "cli/run/options.h"
#include "cli/run/sentences.h"

/* --- warnings and hints --- */

/* Sentences beside the report and the error of a run: warnings about a result that is there, hints what to try after a
 * failure. They are kept during the run and printed at its end, each in one form. */

/** Sentences one after the other, each ended by a zero. Zeroed to begin with. What does not fit is left out. */
typedef struct notes {
    char text[8192];
    size_t used;
} notes;

struct run;

/** Keeps a sentence about a result: something in it may not be what the user expects. */
void cli_warn(struct run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Keeps a sentence that says what to try after a failure. */
void cli_hint(struct run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Adds the sentences to the facts as a list of that name; nothing where there are none. */
void cli_notes_report(facts *f, const char *name, const notes *n);

/** Prints a line for each sentence: `brio: KIND: SENTENCE`. */
void cli_notes_print(FILE *out, const char *kind, const notes *n);

/* --- failures --- */

/* The shapes of error handling, as in the library. FORWARD returns from a function that has nothing to free; TRY and
 * FAIL go to the label `done:` of one that has. */
#define FORWARD(call)                                                                                                  \
    do {                                                                                                               \
        const brio_status forwarded = (call);                                                                          \
        if (forwarded != BRIO_OK) return forwarded;                                                                    \
    } while (0)
#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        status = (call);                                                                                               \
        if (status != BRIO_OK) goto done;                                                                              \
    } while (0)

/** Stores a sentence, assigns `code` to `status` and jumps to `done`. */
#define FAIL(r, code, ...)                                                                                             \
    do {                                                                                                               \
        status = (code);                                                                                               \
        cli_fail(r, status, __VA_ARGS__);                                                                              \
        goto done;                                                                                                     \
    } while (0)

typedef struct common_options {
    const char *output, *format, *view, *input_format, *columns, *scratch;
    const char *picture, *look, *colour_by, *picture_size;
    bool json, quiet, verbose, progress, ascii, float32, compress, drop_invalid, salvage;
    int threads;
    uint64_t seed;
    size_t max_memory; /* 0: no limit */
} common_options;

extern const option cli_common_options[];
extern const common_options cli_common_defaults;

/** What the files hold that a command writes: the library tells the formats. */
typedef enum cli_holds {
    CLI_ANYTHING = 0,
    CLI_SURFACES = BRIO_HOLDS_FACES,
    CLI_POINTS = BRIO_HOLDS_PROPERTIES, /* each with its properties */
    CLI_TETRAHEDRA = BRIO_HOLDS_TETRAHEDRA,
    CLI_EDGES = BRIO_HOLDS_EDGES,
    CLI_BALLS = BRIO_HOLDS_PROPERTIES | BRIO_HOLDS_NAMES /* points with the property radius */
} cli_holds;

enum { MAX_STAGES = 16 };

typedef struct run {
    const struct command *command;
    common_options common;
    const void *arguments; /* the command's own options */
    char **operands;
    int num_operands;
    brio_context *ctx;
    brio_laboratory *lab; /* the experiment of an option, or NULL */
    facts facts;
    bool over_map;             /* texts of points may have no z, which then is 0 */
    bool has_properties;       /* an input's points or faces have */
    bool wants_origins;        /* set by a command before it reads: cli_read_options asks for places of scanners, */
    int added_origins;         /* 1: which the file that was read last then has as properties that are not its own */
    uint64_t dropped, missing; /* of the file that was read last, as in brio_read_options */
    brio_read_notes noted;     /* the same */
    progress bar;
    struct {
        const char *stage;
        double seconds;
    } stages[MAX_STAGES];
    int num_stages;
    double started, lap;           /* clock at the beginning, and at the end of the last stage */
    bool neighbours, faces, edges; /* whether cli_write writes these files beside .node and .ele */
    char message[1024];            /* of a failure found here; the library's is in the context */
    brio_failure failure;          /* what is known of the failure of `message` */
    notes warnings, hints;
    bool flat;                     /* a failure is explained by the points: they lie in a plane or on a line */
    const brio_mesh *beside;       /* set by a command before it writes: a second layer of the page of --view, */
    const char *beside_name;       /* and what it is called there */
    brio_explanation *explanation; /* set by a command: how its surface came to be, for the page; freed with the run */
    bool crossings;                /* faces that cross others were counted: the page and the picture mark them */
    bool shown;                    /* the page of --view, the picture of --picture was written */
    bool over_limit;               /* an estimate is over --max-memory */
} run;

/** Where the help lists a command. */
typedef enum command_group { GROUP_FILES, GROUP_SURFACES, GROUP_TRIANGULATIONS } command_group;

typedef struct command {
    const char *name, *operands, *summary; /* the summary: what it does, on a line */
    const char *description;               /* more of it, for the help and the manual; NULL: nothing */
    const char *examples;                  /* command lines, each followed by a line that says what it does */
    const char *inputs;                    /* ".map .mrc": files that the command itself reads; NULL: all formats */
    const char *outputs;                   /* ".csv .npy": files that the command itself writes; NULL: formats */
    bool has_output;                       /* whether there is -o: of `outputs`, or of all formats that hold: */
    cli_holds holds;
    bool output_optional;         /* it has a use without -o, and without --json */
    const option_choice *choices; /* the words that the first operand can be; NULL: it is a file */
    command_group group;
    int min_operands, max_operands;
    bool writes_last; /* the last of several operands is the output unless -o names one */
    bool shown;       /* what it makes can be shown (cli_show), though it writes files of `outputs` */
    bool shows;       /* shows files: its output is a page, and it has pictures, but no --view */
    int first_input;  /* operands before it say what to do; without inputs the report names the first */
    const option *options;
    const void *defaults; /* what the command's options are before the line is read */
    size_t size;          /* of that struct */
    brio_status (*run)(run *r);
} command;

/** Lists extensions, ".ply .vtu", of what the operands and what -o can name; "" for none.
 *  text  of BRIO_FORMAT_LIST bytes, receives the list. */
void cli_list_inputs(const command *c, char *text);
void cli_list_outputs(const command *c, char *text);

/** Prepares context, progress and signals' callback from the common options. */
brio_status cli_begin(run *r);

/** Begins the experiment of the options, in place of the run's last one: what the command calls now does as they say,
 *  until brio_laboratory_end. Its records stay until the run ends. */
brio_status cli_experiment(run *r, const brio_laboratory_options *options);
void cli_end(run *r);

/** Stores the sentence for a status and returns the status. */
brio_status cli_fail(run *r, brio_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));
/** Does the same for an -o that does not fit the command: BRIO_ERR_ARGUMENT, and a hint what the command writes. */
brio_status cli_fail_output(run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
/** Gives the failure that cli_fail has stored a reason; returns its status. */
brio_status cli_because(run *r, brio_reason reason, brio_status status);
/** Keeps the sentence and the reason of a failure of the library: the context's next call changes its own. */
void cli_keep_failure(run *r, brio_status status);
/** Returns what is known of the failure, found here or in the library. */
brio_failure cli_failure(const run *r);
/** Returns the sentence of the failure, found here or in the library. */
const char *cli_message(const run *r, brio_status status);
int cli_exit_code(brio_status status);

/** Returns the option that shows the result, "--view" or "--picture", or NULL. */
static inline const char *cli_showing(const run *r) {
    return r->common.view ? "--view" : r->common.picture ? "--picture" : NULL;
}

/** Returns whether a mesh is asked for: a file of it, or a page or a picture that shows it. */
static inline bool cli_wants_mesh(const run *r) {
    return r->common.output || cli_showing(r);
}

/** Ends a stage of the clock. */
void cli_lap(run *r, const char *stage);
/** Adds to a stage what something else has timed. */
void cli_stage(run *r, const char *stage, double seconds);
/** Returns BRIO_ERR_CANCELLED when a signal asked to stop. */
brio_status cli_check_interrupt(run *r);

/** Returns whether an estimate can refuse the work. */
bool cli_limits_memory(const run *r);
/** Refuses an estimate over --max-memory. With --scratch the big arrays are not in memory and only the limit of the
 *  context holds. */
brio_status cli_require_memory(run *r, double bytes);

/** Add the facts that begin and end every report. */
void cli_opening_facts(run *r);
void cli_closing_facts(run *r);

#endif
