/* A run of brio-mpi on one rank: what its files share. */
#ifndef BRIO_MPI_JOB_H
#define BRIO_MPI_JOB_H

#include "brio/mpi.h"
#include "cli/files/new_file.h"
#include "cli/run/run.h"
#include "cli/steps/weights.h"

enum { FILE_SHIFT = 40 /* of a point's name: below it the index in its file */ };

typedef struct {
    weights_options weights;
    uint64_t tiles;
    const char *box, *faces;
    void *of_surface; /* the values of the command `surface`; NULL for others */
} arguments;

typedef struct {
    run *r;
    arguments a;
    brio_mpi *mpi;
    brio_ranks *ranks;
    int rank, size;
    uint64_t *first; /* of each file, the index of its first point */
} job;

/** Collective. Returns the failure of a rank on all, with its sentence. */
brio_status job_agree(job *j, brio_status status);

/** Returns the index in the input of a point. */
static inline uint64_t job_index(const job *j, uint64_t name) {
    return j->first[name >> FILE_SHIFT] + (name & ((UINT64_C(1) << FILE_SHIFT) - 1));
}

/** Collective. Makes the surface of the command line's input, which rank 0 reads and writes. */
brio_status job_surface(job *j);

/** --- output; each function is collective --- */

/** Writes the tetrahedra of all tiles: x.pvtu, and a file for each tile in a folder that all ranks see. On failure the
 *  files are removed, and an older output stays as it was. */
brio_status job_write_parts(job *j);

/** A table of cells that all ranks write into one file, which all see. */
typedef struct {
    const char *path; /* NULL: none is written */
    brio_cells_format format;
    new_folder folder;      /* path: on all ranks; the rest on rank 0 */
    int rows;               /* descriptor of this rank's rows, until all have theirs; -1: none */
    brio_cells_table *file; /* that writes them */
} job_table;

/** Opens a table.   path  NULL: does nothing.   Call job_table_close in any case. */
brio_status job_table_open(job *j, const char *path, brio_cells_format format, job_table *t);
/** Appends cells of this rank, in the order of their sites, which are names of points. Not collective. */
brio_status job_table_add(job *j, job_table *t, const brio_cells *cells, const uint64_t *site);
/** Brings the rows of all ranks into one file, in the order of the ranks. */
brio_status job_table_join(job *j, job_table *t);
/** Gives the file its name, on rank 0; not collective. */
brio_status job_table_publish(job *j, job_table *t);
/** Frees everything. What was not published disappears, and an older file of that name stays. Not collective. */
void job_table_close(job_table *t);

#endif
