/* brio-mpi: what `brio delaunay --tiles`, `brio voronoi --tiles` and `brio surface` compute, by the ranks of an MPI job. Rank 0 reports;
 * all have one exit code. */
#include "cli/files/files.h"
#include "cli/files/lost.h"
#include "cli/files/read_write.h"
#include "cli/report/plain.h"
#include "cli/run/commands.h"
#include "cli/run/interrupt.h"
#include "cli/run/run.h"
#include "cli/steps/tiles.h"
#include "mpi/job.h"
#include "platform/program.h"
#include "platform/thread.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TILES = 1 << 12 };

#define TILES_A_RANK                                                                                                   \
    {                                                                                                                  \
        "tiles-per-rank", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(arguments, tiles), "N",                        \
            "tiles of each rank, two of which are in memory (default 4)", 0                                            \
    }

static const option of_delaunay[] = {WEIGHTS_ROWS(arguments, weights), TILES_A_RANK, {0}};
static const option of_voronoi[] = {
    WEIGHTS_ROWS(arguments, weights),
    TILES_A_RANK,
    {"box", 0, OPTION_TEXT, offsetof(arguments, box), "B", "clip the cells to x0,y0,z0,x1,y1,z1", 0},
    {"faces", 0, OPTION_OUTPUT, offsetof(arguments, faces), "FILE", "write a row for each face of each cell (.csv)", 0},
    {0},
};

static const option of_surface[] = {TILES_A_RANK, {0}};

/* --- reading --- */

/* A file, and whose turn it is: blocks go to the ranks that read it in turns. */
typedef struct {
    job *j;
    uint64_t file, blocks, points;
    uint64_t readers, turn;
    brio_status status;
} share;

static brio_status add_block(share *s, const brio_mesh *block) {
    double *weights = NULL;
    brio_status status = BRIO_OK;
    run *r = s->j->r;
    if (s->blocks % s->readers == s->turn && !brio_ranks_has_points(s->j->ranks)) {
        uint64_t name = s->file << FILE_SHIFT | s->points;
        TRY(cli_block_weights(r, &s->j->a.weights, block, s->points, &weights));
        TRY(brio_ranks_add(r->ctx, s->j->ranks, block->vertices, weights, block->num_vertices, name));
    }
    s->blocks++;
    s->points += block->num_vertices;
done:
    free(weights);
    return status;
}

static int take_block(const brio_mesh *block, void *user) {
    share *s = user;
    s->status = add_block(s, block);
    if (s->status != BRIO_OK) cli_keep_failure(s->j->r, s->status);
    return s->status != BRIO_OK;
}

static brio_status read_file(job *j, uint64_t file, uint64_t readers, uint64_t turn, uint64_t *points) {
    share s = {.j = j, .file = file, .readers = readers, .turn = turn};
    brio_read_options how = cli_read_options(j->r);
    brio_status status = brio_read_blocks(j->r->ctx, j->r->operands[file], &how, take_block, &s, NULL);
    FORWARD(s.status);
    *points = s.points;
    return status;
}

/* Reads this rank's share. Ranks that are more than files read one together; files that are more than ranks are dealt
 * out.   points  of each file, as far as this rank has read it. */
static brio_status read_share(job *j, uint64_t *points) {
    uint64_t files = (uint64_t)j->r->num_operands, ranks = (uint64_t)j->size, rank = (uint64_t)j->rank;
    if (files < ranks) {
        uint64_t file = rank % files;
        return read_file(j, file, (ranks - file + files - 1) / files, rank / files, &points[file]);
    }
    for (uint64_t file = rank; file < files; file += ranks) FORWARD(read_file(j, file, 1, 0, &points[file]));
    return BRIO_OK;
}

brio_status job_agree(job *j, brio_status status) {
    run *r = j->r;
    const char *sentence = status != BRIO_OK ? cli_message(r, status) : NULL;
    if (status != BRIO_OK && cli_interrupted()) status = BRIO_ERR_CANCELLED, sentence = "interrupted";
    char copy[1024];
    snprintf(copy, sizeof copy, "%s", sentence ? sentence : "");
    r->message[0] = 0; /* from now on that of all */
    return brio_ranks_agree(r->ctx, j->ranks, status, sentence ? copy : NULL);
}

/* Reads all files, and finds where each begins. Points that a run before left are not read again; the output needs where
 * files begin, if they are several. */
static brio_status read_all(job *j) {
    size_t n = (size_t)j->r->num_operands;
    uint64_t *points = calloc(n + 1, sizeof *points);
    brio_status status = BRIO_OK;
    j->first = calloc(n + 1, sizeof *j->first);
    if (!points || !j->first)
        status = cli_fail(j->r, BRIO_ERR_NO_MEMORY, "no memory for %zu files", n);
    else if (n > 1 || !brio_ranks_has_points(j->ranks))
        status = read_share(j, points);
    TRY(job_agree(j, status));
    MPI_Allreduce(points, j->first, (int)n, MPI_UINT64_T, MPI_MAX, MPI_COMM_WORLD);
    for (size_t i = 0, before = 0; i < n; i++) {
        size_t count = j->first[i];
        j->first[i] = before;
        before += count;
    }
done:
    free(points);
    return status;
}

/* --- commands --- */

static const command delaunay = {
    .name = "delaunay",
    .operands = "IN...",
    .summary = "Delaunay triangulation of points by the ranks of an MPI job; regular with weights",
    .examples = "mpirun -n 8 brio-mpi delaunay scan.laz --scratch /var/tmp\n",
    .has_output = true,
    .holds = CLI_TETRAHEDRA,
    .options = of_delaunay,
};

static const command voronoi = {
    .name = "voronoi",
    .operands = "IN...",
    .summary = "Voronoi cells of points by the ranks of an MPI job; power cells with weights",
    .examples = "mpirun -n 8 brio-mpi voronoi scan.laz --scratch /var/tmp --box 0,0,0,1,1,1 -o cells.npy\n",
    .has_output = true,
    .outputs = ".npy .csv",
    .options = of_voronoi,
};

/* --- the run --- */

static void report_ranks(job *j) {
    const brio_ranks_traffic *t = brio_ranks_sent(j->ranks);
    facts *f = &j->r->facts;
    cli_fact_open(f, "ranks", FACT_OBJECT);
    cli_fact_integer(f, "count", j->size);
    cli_fact_count(f, "exchanges", t->exchanges);
    cli_fact_count(f, "bytes", t->bytes);
    cli_fact_count(f, "question_bytes", t->question_bytes);
    cli_fact_count(f, "far_asked", t->far_asked);
    cli_fact_count(f, "far_found", t->far_found);
    cli_fact_count(f, "rounds", t->rounds);
    cli_fact_count(f, "least_points", t->least_points);
    cli_fact_count(f, "most_points", t->most_points);
    cli_fact_seconds(f, "waited", t->waited_seconds);
    cli_fact_close(f);
}

static uint64_t key_of(const job *j) {
    uint64_t key = 0;
    for (int i = 0; i < j->r->num_operands; i++) {
        uint64_t one = cli_tiles_key(j->r, &j->a.weights, j->r->operands[i]);
        if (!one) return 0;
        key = key * UINT64_C(0x9e3779b97f4a7c15) + one;
    }
    return key;
}

/* Computes the checksum, and writes the tetrahedra. */
static brio_status finish_delaunay(job *j) {
    run *r = j->r;
    uint64_t checksum;
    FORWARD(brio_ranks_checksum(r->ctx, j->ranks, &checksum));
    cli_lap(r, "checksum");
    cli_report_tiles(r, brio_ranks_facts(j->ranks), checksum);
    report_ranks(j);
    return r->common.output ? job_write_parts(j) : BRIO_OK;
}

/* What takes the cells of a rank. */
typedef struct {
    job *j;
    job_table cells, faces;
    brio_status status;
} tables;

/* Does not end the run where rows cannot be written: the sentence of that would be lost. */
static int take_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    tables *t = user;
    if (t->status != BRIO_OK) return 0;
    t->status = job_table_add(t->j, &t->cells, cells, site);
    if (t->status == BRIO_OK) t->status = job_table_add(t->j, &t->faces, cells, site);
    if (t->status != BRIO_OK) cli_keep_failure(t->j->r, t->status);
    return 0;
}

/* Returns the format of -o, or AUTO: there is none, or it holds no rows of cells. */
static brio_cells_format format_of(const run *r) {
    const common_options *c = &r->common;
    brio_cells_format format = c->output ? brio_cells_format_of(c->format ? c->format : c->output) : 0;
    return format == BRIO_CELLS_FORMAT_VTU ? BRIO_CELLS_FORMAT_AUTO : format;
}

/* Computes the cells, and writes the tables that are asked for. */
static brio_status finish_voronoi(job *j) {
    run *r = j->r;
    double box[6];
    brio_cells_options o = {.size = sizeof o};
    int ordered = j->a.faces ? 1 : r->common.output ? 2 : 0;
    tables t = {.j = j};
    brio_status status = BRIO_OK;
    if (j->a.box) FORWARD(cli_read_box(r, j->a.box, box));
    if (j->a.box) o.box = box;
    t.faces.folder.lock = t.faces.rows = -1;
    TRY(job_table_open(j, r->common.output, format_of(r), &t.cells));
    TRY(job_table_open(j, j->a.faces, BRIO_CELLS_FORMAT_FACES_CSV, &t.faces));
    if (t.cells.path) cli_tell_idle(r, t.cells.path, t.cells.format == BRIO_CELLS_FORMAT_CSV, false);
    if (t.faces.path) cli_tell_idle(r, t.faces.path, true, false);
    TRY(brio_ranks_cells(r->ctx, j->ranks, &o, ordered, take_cells, &t));
    TRY(job_agree(j, t.status));
    cli_lap(r, "cells");
    cli_report_tile_cells(r, brio_ranks_facts(j->ranks), brio_ranks_cells_facts(j->ranks));
    report_ranks(j);
    TRY(job_table_join(j, &t.cells));
    TRY(job_table_join(j, &t.faces));
    status = job_table_publish(j, &t.cells);
    if (status == BRIO_OK) status = job_table_publish(j, &t.faces);
    status = job_agree(j, status);
    cli_lap(r, "write");
done:
    job_table_close(&t.cells);
    job_table_close(&t.faces);
    return status;
}

static brio_status triangulate(job *j) {
    run *r = j->r;
    bool cells = r->command == &voronoi;
    brio_ranks_options o = {.size = sizeof o, .scratch = r->common.scratch, .tiles = (uint32_t)j->a.tiles};
    brio_transport t = brio_mpi_transport(j->mpi);
    if (cells) o.stars = j->a.faces ? 1 : r->common.output ? 3 : 2;
    o.key = key_of(j);
    MPI_Bcast(&o.key, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    FORWARD(brio_ranks_new(r->ctx, &t, &o, &j->ranks));
    FORWARD(read_all(j));
    cli_lap(r, "read");
    FORWARD(brio_ranks_run(r->ctx, j->ranks));
    const brio_tiles_stats *s = brio_ranks_facts(j->ranks);
    cli_stage(r, "divide", s->divide_seconds);
    cli_stage(r, "insert", s->triangulate_seconds);
    r->lap = cli_clock();
    return cells ? finish_voronoi(j) : finish_delaunay(j);
}

/* --- the command line --- */

static void print_help(void) {
    puts("usage: mpirun -n RANKS brio-mpi delaunay IN... --scratch DIR [options]\n"
         "       mpirun -n RANKS brio-mpi voronoi IN... --scratch DIR [options]\n"
         "       mpirun -n RANKS brio-mpi surface IN --scratch DIR [options of 'brio surface']\n\n"
         "What 'brio delaunay IN --tiles N', 'brio voronoi IN --tiles N' and 'brio surface IN' compute, by many\n"
         "processes on many hosts:\n"
         "docs/mpi.md.\n\n"
         "  --tiles-per-rank N   tiles of each rank, two of which are in memory (default 4)\n"
         "  --scratch DIR        a folder of each host, for about 190 bytes a point of its ranks;\n"
         "                       surface: that of rank 0 also has the arrays of the surface\n"
         "  -o FILE              delaunay: .pvtu, a file for each tile; voronoi: .npy or .csv, a row for each cell.\n"
         "                       In a folder that all hosts see\n"
         "  --box B              voronoi: clip the cells to x0,y0,z0,x1,y1,z1\n"
         "  --faces FILE.csv     voronoi: a row for each face of each cell\n"
         "  --max-memory SIZE    of each rank\n"
         "and --json, --quiet, --progress, --threads, --input-format, --columns, --drop-invalid, --salvage,\n"
         "--unweighted, --weights-mod, --compress as 'brio delaunay' has them.");
}

/* Finds everything wrong with a table that can be found before the work. */
static brio_status check_table(run *r, const char *path) {
    if (!path) return BRIO_OK;
    if (cli_is_single(path)) return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: ranks write side by side, into a file", path);
    FORWARD(cli_check_target(r, path));
    return cli_new_folder_check_for(r, path);
}

/* Rank 0 checks the output for all: it removes what a killed run left of it, which others would find half removed. */
static brio_status check_output(run *r) {
    const arguments *a = r->arguments;
    if (r->command == &cli_surface) return BRIO_OK; /* it looks itself */
    if (r->command == &delaunay) return cli_check_tile_files(r, ".pvtu");
    FORWARD(check_table(r, r->common.output));
    return check_table(r, a->faces);
}

/* Returns what is wrong with the names of tables. */
static brio_status check_format(run *r) {
    const char *output = r->common.output;
    if (r->command != &voronoi || !output) return BRIO_OK;
    if (r->common.compress) return cli_fail(r, BRIO_ERR_ARGUMENT, "--compress: cells are written without compression");
    if (format_of(r) != BRIO_CELLS_FORMAT_AUTO) return BRIO_OK;
    return cli_fail_output(r, "%s: ranks write cells to .npy and .csv", output);
}

/* Returns the method among the values of the command `surface`. */
static int *method_of(void *values) {
    const option *o = cli_surface.options;
    while (strcmp(o->name, "method") != 0) o++;
    return (int *)(void *)((char *)values + o->offset);
}

/* Refuses the other methods, which have no work for ranks. */
static brio_status check_method(run *r, void *values) {
    if (*method_of(values) == BRIO_SURFACE_LABELED) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_ARGUMENT,
                    "--method: ranks make surfaces by labeled-delaunay; brio surface has the others");
}

static brio_status check(run *r, arguments *a) {
    if (r->num_operands < 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: expected %s, got no argument", r->command->name,
                        r->command->operands);
    if (r->command == &cli_surface && r->num_operands > 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "surface: one argument too many: '%s'", r->operands[1]);
    if (a->tiles > MOST_TILES)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--tiles-per-rank: %" PRIu64 " are more than %d", a->tiles, MOST_TILES);
    if (a->weights.exponent != NO_EXPONENT && r->num_operands > 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--weights-mod: with one file only");
    for (int i = 0; i < r->num_operands; i++)
        if (!strcmp(r->operands[i], "-"))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "-: the ranks have no standard input; give files");
    double box[6];
    if (a->box) FORWARD(cli_read_box(r, a->box, box));
    if (cli_showing(r))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: ranks show nothing; brio view shows files", cli_showing(r));
    FORWARD(check_format(r));
    if (a->of_surface) FORWARD(check_method(r, a->of_surface));
    return cli_check_tiles(r, &a->weights, a->tiles);
}

static brio_status parse(run *r, arguments *a, int argc, char **argv, bool *help) {
    const option_group groups[] = {
        {r->command->options, a->of_surface ? a->of_surface : a}, {cli_common_options, &r->common}, {of_surface, a}};
    option_parse p = {.groups = groups, .num_groups = a->of_surface ? 3 : 2};
    if (!cli_parse(&p, argc, argv)) return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s", r->command->name, p.message);
    *help = p.help;
    r->operands = p.operands;
    r->num_operands = p.num_operands;
    return p.help ? BRIO_OK : check(r, a);
}

/* Shares the processors of a host among its ranks, unless the launcher bound each to its own. */
static int threads_of_rank(void) {
    MPI_Comm host;
    int ranks = 1, processors = brio_processors();
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &host);
    MPI_Comm_size(host, &ranks);
    MPI_Comm_free(&host);
    return processors > ranks ? processors / ranks : 1;
}

/* Asks this rank to stop if another was asked. Returns whether it was. */
static int stop(void *user) {
    job *j = user;
    if (brio_mpi_stopped(j->mpi)) cli_interrupt();
    return cli_interrupted();
}

static int on_progress(const char *stage, double fraction, void *user) {
    job *j = user;
    cli_progress_show(&j->r->bar, stage, fraction);
    return stop(j);
}

static void print_sentence(run *r, brio_status status) {
    fputs("brio-mpi: ", stderr);
    cli_print_plain(stderr, cli_message(r, status));
    fputc('\n', stderr);
}

/* Reports, on rank 0. Returns the exit code. */
static int finish(job *j, brio_status status) {
    run *r = j->r;
    int code = cli_exit_code(status);
    cli_progress_end(&r->bar);
    if (j->rank) return code;
    if (status == BRIO_OK) cli_closing_facts(r);
    if (r->common.json && status != BRIO_OK) {
        cli_fact_text(&r->facts, "error", cli_message(r, status));
        cli_fact_integer(&r->facts, "exit", code);
    }
    if (r->common.json) {
        cli_notes_report(&r->facts, "warnings", &r->warnings);
        if (status != BRIO_OK) cli_notes_report(&r->facts, "hints", &r->hints);
        cli_json_write(stdout, &r->facts, r->command->name);
    } else if (status == BRIO_OK && !r->common.quiet) {
        FILE *out = cli_goes_to_stdout(r->common.output) ? stderr : stdout; /* the output is there */
        cli_text_write(out, &r->facts, r->command->name, r->common.verbose);
    }
    if (!r->common.quiet) cli_notes_print(stderr, "warning", &r->warnings);
    if (status != BRIO_OK) {
        print_sentence(r, status);
        if (!r->common.quiet) cli_notes_print(stderr, "hint", &r->hints);
    }
    if (fflush(stdout) && status == BRIO_OK) code = cli_exit_code(BRIO_ERR_WRITE);
    return code;
}

/* Makes the failure of one rank that of all, before there are exchanges. The sentence is that of the least rank. */
static brio_status agree_early(job *j, brio_status status) {
    run *r = j->r;
    char words[1024] = "", host[MPI_MAX_PROCESSOR_NAME];
    int mine = status != BRIO_OK ? j->rank : j->size, least, failed = status != BRIO_OK, all, length;
    MPI_Allreduce(&mine, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    MPI_Allreduce(&failed, &all, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    if (!all) return BRIO_OK;
    int code = (int)status;
    MPI_Get_processor_name(host, &length);
    if (j->rank == least && all < j->size)
        snprintf(words, sizeof words, "rank %d on %s: %s", j->rank, host, cli_message(r, status));
    else if (j->rank == least)
        snprintf(words, sizeof words, "%s", cli_message(r, status));
    MPI_Bcast(&code, 1, MPI_INT, least, MPI_COMM_WORLD);
    MPI_Bcast(words, sizeof words, MPI_CHAR, least, MPI_COMM_WORLD);
    return cli_fail(r, (brio_status)code, "%s", words);
}

/* Prepares this rank. */
static brio_status begin_job(job *j) {
    run *r = j->r;
    if (!j->mpi) return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for the exchange of %d ranks", j->size);
    FORWARD(cli_check_common(r));
    FORWARD(cli_begin(r));
    if (j->rank || r->command != &cli_surface)
        FORWARD(brio_context_set_scratch(r->ctx, NULL)); /* tiles are in memory */
    return j->rank ? BRIO_OK : check_output(r);
}

/* Takes the options of the command `surface`, with the one method that ranks share. */
static brio_status take_surface(job *j) {
    void *values = malloc(cli_surface.size);
    if (!values) return cli_fail(j->r, BRIO_ERR_NO_MEMORY, "no memory for the options");
    memcpy(values, cli_surface.defaults, cli_surface.size);
    *method_of(values) = BRIO_SURFACE_LABELED;
    j->r->arguments = j->a.of_surface = values;
    return BRIO_OK;
}

static brio_status read_command_line(job *j, int argc, char **argv, bool *help) {
    if (j->r->command == &cli_surface) FORWARD(take_surface(j));
    return parse(j->r, &j->a, argc, argv, help);
}

static brio_status run_job(job *j, int argc, char **argv, bool *help) {
    run *r = j->r;
    FORWARD(agree_early(j, read_command_line(j, argc, argv, help)));
    if (*help) return BRIO_OK;
    int threads = threads_of_rank();
    if (!r->common.threads) r->common.threads = threads;
    if (j->rank) r->common.quiet = true, r->common.progress = false;
    FORWARD(agree_early(j, begin_job(j)));
    brio_mpi_set_stop(j->mpi, stop, j);
    brio_context_set_progress(r->ctx, on_progress, j);
    cli_opening_facts(r);
    r->lap = cli_clock();
    return r->command == &cli_surface ? job_surface(j) : triangulate(j);
}

int main(int argc, char **argv) {
    run r = {.command = &delaunay, .common = cli_common_defaults, .started = cli_clock()};
    job j = {.r = &r, .a = {.weights.exponent = NO_EXPONENT, .tiles = 4}};
    r.arguments = &j.a;
    bool help = false;
    int level;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    brio_program_begin(&argc, &argv);
    cli_interrupt_install();
    MPI_Comm_rank(MPI_COMM_WORLD, &j.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &j.size);
    j.mpi = brio_mpi_new(MPI_COMM_WORLD);
    brio_status status = BRIO_OK;
    if (argc > 1 && !strcmp(argv[1], voronoi.name)) r.command = &voronoi;
    if (argc > 1 && !strcmp(argv[1], cli_surface.name)) r.command = &cli_surface;
    if (argc < 2 || strcmp(argv[1], r.command->name)) {
        help = argc > 1 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"));
        if (!help) status = cli_fail(&r, BRIO_ERR_ARGUMENT, "expected 'delaunay', 'surface' or 'voronoi'; see --help");
    } else {
        status = run_job(&j, argc - 2, argv + 2, &help);
    }
    if (help && j.rank == 0) print_help();
    bool broken = j.mpi && brio_mpi_has_failed(j.mpi); /* others wait for what does not come */
    if (broken && j.rank) print_sentence(&r, status);  /* rank 0 may not get to know it */
    if (status == BRIO_ERR_CANCELLED || (status != BRIO_OK && cli_interrupted()))
        status = cli_fail(&r, BRIO_ERR_CANCELLED, "interrupted"); /* this rank, or another */
    int code = help ? 0 : finish(&j, status);
    brio_ranks_free(j.ranks);
    free(j.first);
    free(j.a.of_surface);
    cli_end(&r);
    if (broken) MPI_Abort(MPI_COMM_WORLD, code);
    brio_mpi_free(j.mpi);
    MPI_Finalize();
    return code;
}
