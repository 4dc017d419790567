/* Tables of cells that ranks write into one file.
 *
 * Each rank has the cells of a range of sites, in order. It writes their rows into a file without a name in its scratch
 * folder, for the size of a text is known only then. When all sizes are known, each rank copies its rows to their place
 * in one file, which is in a folder beside the output (cli/files/new_file.h). At the end that file gets the output's
 * name. No rank has more than a block of it in memory.
 *
 * A rank writes whole blocks. The rows at its beginning that share a block with a rank before go to that rank. So no
 * two hosts write into one page: some file systems write a page back as the host that wrote last knew it. */
#include "cli/run/interrupt.h"
#include "mpi/job.h"
#include "platform/disk.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1 << 20, HEAD_TAG = 1 };

/* --- the rows of a rank --- */

brio_status job_table_open(job *j, const char *path, brio_cells_format format, job_table *t) {
    run *r = j->r;
    char own[32];
    *t = (job_table){.path = path, .format = format, .folder.lock = -1, .rows = -1};
    if (!path) return BRIO_OK;
    FORWARD(job_agree(j, j->rank ? BRIO_OK : cli_new_folder_open_for(r, path, &t->folder)));
    MPI_Bcast(t->folder.path, sizeof t->folder.path, MPI_CHAR, 0, MPI_COMM_WORLD);
    brio_status status = BRIO_OK;
    t->rows = brio_open_nameless(r->common.scratch);
    if (t->rows < 0) status = cli_fail(r, BRIO_ERR_WRITE, "%s: %s", r->common.scratch, strerror(errno));
    snprintf(own, sizeof own, "/dev/fd/%d", t->rows);
    if (status == BRIO_OK)
        status =
            brio_cells_table_piece(r->ctx, own, format, brio_ranks_facts(j->ranks)->vertices, j->rank == 0, &t->file);
    return job_agree(j, status);
}

/* Makes cells whose sites and neighbours are indices in the input of cells whose are names. */
typedef struct {
    uint64_t *site;
    brio_cells cells;
} renamed;

static brio_status rename_cells(const job *j, const brio_cells *cells, const uint64_t *site, renamed *out) {
    size_t n = cells->num_cells, faces = cells->face_neighbours ? (size_t)cells->face_offsets[n] : 0;
    *out = (renamed){.site = malloc((n + 1) * sizeof *site), .cells = *cells};
    if (cells->face_neighbours) out->cells.face_neighbours = malloc((faces + 1) * sizeof *cells->face_neighbours);
    if (!out->site || (cells->face_neighbours && !out->cells.face_neighbours))
        return cli_fail(j->r, BRIO_ERR_NO_MEMORY, "no memory for the rows of %zu cells", n);
    for (size_t c = 0; c < n; c++) out->site[c] = job_index(j, site[c]);
    for (size_t f = 0; f < faces; f++) {
        int64_t neighbour = cells->face_neighbours[f];
        out->cells.face_neighbours[f] = neighbour < 0 ? neighbour : (int64_t)job_index(j, (uint64_t)neighbour);
    }
    return BRIO_OK;
}

brio_status job_table_add(job *j, job_table *t, const brio_cells *cells, const uint64_t *site) {
    renamed n;
    brio_status status = BRIO_OK;
    if (!t->path) return BRIO_OK;
    TRY(rename_cells(j, cells, site, &n));
    status = brio_cells_table_add(j->r->ctx, t->file, &n.cells, n.site);
done:
    free(n.site);
    if (cells->face_neighbours) free(n.cells.face_neighbours);
    return status;
}

/* --- one file --- */

/* Where the rows of all ranks go. */
typedef struct {
    job *j;
    job_table *t;
    int file;
    uint64_t *begin; /* of each rank, and the end of all */
    char *block;
    char path[BRIO_PATH_MOST + 64];
} joining;

static uint64_t block_of(uint64_t at) {
    return at / BLOCK;
}

/* Returns the rank that writes the block in which the rows of a rank begin: the last one whose rows begin at that block
 * or before it, itself included. */
static int writer_of(const joining *g, int rank) {
    uint64_t at = block_of(g->begin[rank]) * BLOCK;
    int writer = rank;
    while (writer > 0 && g->begin[writer] > at) writer--;
    return writer;
}

/* Returns how many bytes of a rank's rows another one writes: those up to the next block. */
static uint64_t head_of(const joining *g, int rank) {
    uint64_t all = g->begin[rank + 1] - g->begin[rank], rest = BLOCK - g->begin[rank] % BLOCK;
    return writer_of(g, rank) == rank ? 0 : all < rest ? all : rest;
}

static brio_status read_rows(joining *g, uint64_t at, uint64_t size) {
    for (uint64_t done = 0; done < size;) {
        int64_t n = brio_read_bytes_at(g->t->rows, g->block + done, (size_t)(size - done), at + done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return cli_fail(g->j->r, BRIO_ERR_OPEN, "%s: %s", g->j->r->common.scratch,
                            n < 0 ? strerror(errno) : "rows of cells are missing");
        done += (uint64_t)n;
    }
    return BRIO_OK;
}

static brio_status write_rows(joining *g, uint64_t at, uint64_t size) {
    for (uint64_t done = 0; done < size;) {
        int64_t n = brio_write_bytes_at(g->file, g->block + done, (size_t)(size - done), at + done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return cli_fail(g->j->r, BRIO_ERR_WRITE, "%s: %s", g->path, strerror(errno));
        done += (uint64_t)n;
    }
    return BRIO_OK;
}

/* Copies this rank's rows, except its head. */
static brio_status copy_rows(joining *g) {
    uint64_t begin = g->begin[g->j->rank], end = g->begin[g->j->rank + 1];
    for (uint64_t at = begin + head_of(g, g->j->rank), size; at < end; at += size) {
        size = BLOCK - at % BLOCK < end - at ? BLOCK - at % BLOCK : end - at;
        FORWARD(read_rows(g, at - begin, size));
        FORWARD(write_rows(g, at, size));
        FORWARD(cli_check_interrupt(g->j->r));
    }
    return BRIO_OK;
}

/* Sends this rank's head, and writes those of other ranks. All of it is sent and received, whatever fails. */
static brio_status pass_heads(joining *g) {
    int rank = g->j->rank;
    uint64_t size = head_of(g, rank);
    brio_status status = BRIO_OK;
    if (size) {
        status = read_rows(g, 0, size);
        MPI_Send(g->block, (int)size, MPI_BYTE, writer_of(g, rank), HEAD_TAG, MPI_COMM_WORLD);
    }
    for (int from = rank + 1; from < g->j->size; from++) {
        size = head_of(g, from);
        if (!size || writer_of(g, from) != rank) continue;
        MPI_Recv(g->block, (int)size, MPI_BYTE, from, HEAD_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        if (status == BRIO_OK) status = write_rows(g, g->begin[from], size);
    }
    return status;
}

/* Opens the file, which rank 0 made. */
static brio_status open_file(joining *g, bool makes) {
    FILE *file = brio_open_stream(g->path, makes ? "w" : "r+");
    if (!file)
        return cli_fail(g->j->r, BRIO_ERR_WRITE, "%s: %s; all ranks must see one folder", g->path, strerror(errno));
    g->file = brio_copy_descriptor(brio_descriptor_of(file));
    fclose(file);
    return g->file >= 0 ? BRIO_OK : cli_fail(g->j->r, BRIO_ERR_WRITE, "%s: %s", g->path, strerror(errno));
}

/* Ends this rank's rows, and finds how many bytes they are. */
static brio_status finish_rows(joining *g, uint64_t *size) {
    brio_place_facts own = {.size = 0};
    FORWARD(brio_cells_table_finish(g->j->r->ctx, g->t->file));
    if (!brio_find_facts_open(g->t->rows, &own))
        return cli_fail(g->j->r, BRIO_ERR_WRITE, "%s: %s", g->j->r->common.scratch, strerror(errno));
    *size = own.size;
    g->block = malloc(BLOCK);
    g->begin = calloc((size_t)g->j->size + 1, sizeof *g->begin);
    return g->block && g->begin ? BRIO_OK : cli_fail(g->j->r, BRIO_ERR_NO_MEMORY, "no memory for a block of rows");
}

static brio_status flush(joining *g) {
    if (brio_flush_to_disk(g->file)) return BRIO_OK;
    return cli_fail(g->j->r, BRIO_ERR_WRITE, "%s: %s", g->path, strerror(errno));
}

/* Rank 0 looks whether the file has the bytes of all: other ranks may see another folder. */
static brio_status check_size(const joining *g) {
    brio_place_facts found;
    if (g->j->rank) return BRIO_OK;
    if (brio_find_facts(g->path, &found) && found.size == g->begin[g->j->size]) return BRIO_OK;
    return cli_fail(g->j->r, BRIO_ERR_WRITE, "%s: what other ranks wrote is not there: all ranks must see one folder",
                    g->path);
}

brio_status job_table_join(job *j, job_table *t) {
    joining g = {.j = j, .t = t, .file = -1};
    brio_status status = BRIO_OK;
    uint64_t size = 0;
    if (!t->path) return BRIO_OK;
    cli_new_folder_file(&t->folder, g.path);
    TRY(job_agree(j, finish_rows(&g, &size)));
    MPI_Allgather(&size, 1, MPI_UINT64_T, g.begin + 1, 1, MPI_UINT64_T, MPI_COMM_WORLD);
    for (int i = 0; i < j->size; i++) g.begin[i + 1] += g.begin[i];
    TRY(job_agree(j, j->rank ? BRIO_OK : open_file(&g, true)));
    TRY(job_agree(j, j->rank ? open_file(&g, false) : BRIO_OK));
    TRY(job_agree(j, copy_rows(&g)));
    TRY(job_agree(j, pass_heads(&g)));
    TRY(job_agree(j, flush(&g)));
    status = job_agree(j, check_size(&g));
done:
    if (g.file >= 0) brio_close(g.file);
    free(g.block);
    free(g.begin);
    return status;
}

/* --- its end --- */

brio_status job_table_publish(job *j, job_table *t) {
    if (!t->path || j->rank) return BRIO_OK;
    return cli_new_folder_adopt(j->r, &t->folder, t->path);
}

void job_table_close(job_table *t) {
    brio_cells_table_free(t->file);
    if (t->rows >= 0) brio_close(t->rows);
    cli_new_folder_close(&t->folder, false);
    t->file = NULL, t->rows = -1;
}
