/* The tetrahedra of all ranks as files: a file for each tile in a folder that all ranks see, and an index. */
#include "cli/files/new_file.h"
#include "cli/steps/tiles.h"
#include "mpi/job.h"
#include "platform/folder.h"
#include <inttypes.h>
#include <stdio.h>

static const char VTU[] = ".vtu";

static void name_part(const char *folder, uint64_t number, char path[BRIO_PATH_MOST + 64]) {
    snprintf(path, BRIO_PATH_MOST + 64, "%s/%" PRIu64 "%s", folder, number, VTU);
}

/* Writes a tile of this rank into a folder. */
static brio_status write_part(job *j, brio_tile_part *part, uint32_t tile, const char *folder) {
    char path[BRIO_PATH_MOST + 64];
    for (size_t v = 0; v < part->num_vertices; v++) part->index[v] = job_index(j, part->index[v]);
    name_part(folder, (uint64_t)j->rank * j->a.tiles + tile, path);
    return cli_write_part(j->r, part, brio_ranks_facts(j->ranks)->weighted, path);
}

static brio_status write_parts(job *j, const char *folder) {
    brio_status status = BRIO_OK;
    for (uint32_t i = 0; i < j->a.tiles; i++) {
        brio_tile_part part = {.size = sizeof part};
        FORWARD(brio_ranks_part(j->r->ctx, j->ranks, i, &part));
        status = write_part(j, &part, i, folder);
        if (status != BRIO_OK) cli_keep_failure(j->r, status);
        brio_tile_part_free(j->r->ctx, &part);
        FORWARD(job_agree(j, status));
    }
    return BRIO_OK;
}

/* Makes the folder, on rank 0. */
static brio_status open_folder(job *j, new_folder *folder) {
    return j->rank ? BRIO_OK : cli_new_folder_open(j->r, j->r->common.output, VTU, folder);
}

/* Rank 0 gives the folder its name, and then writes the index: without it there is no output. */
static brio_status publish(job *j, new_folder *folder) {
    char path[BRIO_PATH_MOST + 64];
    uint64_t all = (uint64_t)j->size * j->a.tiles;
    if (j->rank) return BRIO_OK;
    for (uint64_t i = 0; i < all; i++) {
        name_part(folder->path, i, path);
        if (!brio_is_there(path))
            return cli_fail(j->r, BRIO_ERR_WRITE,
                            "%s: another rank wrote it, and it is not there: all ranks must see one folder", path);
    }
    FORWARD(cli_new_folder_name(j->r, folder));
    return cli_write_tiles_index(j->r, folder, (uint32_t)all, brio_ranks_facts(j->ranks)->weighted);
}

/* Removes what this rank wrote into the folder, and the folder if it was the last in it. */
static void remove_parts(job *j, const char *folder) {
    char path[BRIO_PATH_MOST + 64];
    for (uint32_t i = 0; i < j->a.tiles; i++) {
        name_part(folder, (uint64_t)j->rank * j->a.tiles + i, path);
        brio_remove_file(path);
    }
    brio_remove_folder(folder);
}

brio_status job_write_parts(job *j) {
    new_folder folder = {.lock = -1};
    brio_status status = BRIO_OK;
    TRY(job_agree(j, open_folder(j, &folder)));
    MPI_Bcast(folder.path, sizeof folder.path, MPI_CHAR, 0, MPI_COMM_WORLD);
    TRY(write_parts(j, folder.path));
    status = job_agree(j, publish(j, &folder));
done:
    if (j->rank == 0) cli_new_folder_close(&folder, status == BRIO_OK);
    if (j->rank && status != BRIO_OK && *folder.path) remove_parts(j, folder.path);
    cli_lap(j->r, "write");
    return status;
}
