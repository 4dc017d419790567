/* Files that rows are divided into, to be read and sorted one after the other: what is in no memory as a whole is
 * brought together by a hash of what belongs together. The rows of a file have one size.
 *
 * Use: open, put all rows, flush, close; then read each file, and remove it. A failed run leaves its files to who ends
 * the folder, or removes them by brio_row_files_remove.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988. */
#ifndef BRIO_STORE_ROW_FILES_H
#define BRIO_STORE_ROW_FILES_H

#include "store/store.h"

/** A file, and its rows that wait. */
typedef struct {
    brio_store_file file;
    uint8_t *bytes;
    size_t size;
} brio_row_file;

/** Files NAME-0, NAME-1 and so on. Zeros: none. */
typedef struct {
    brio_store_folder *folder;
    char name[16];
    brio_row_file *file;
    uint32_t count;
    size_t room; /* bytes that wait for a file, at most */
} brio_row_files;

/** Makes `count` empty files. Call brio_row_files_close in any case.   name  at most 15 characters.
 *  Memory: 16 kB a file, at most 4 MB, or 1 kB a file.
 *  Returns BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY. */
brio_status brio_row_files_open(brio_store_folder *folder, const char *name, uint32_t count, brio_row_files *out);
/** Appends a row to a file; it may wait for others.
 *  into  below the number of files.   size  at most 1 kB.
 *  Returns BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_CANCELLED. */
brio_status brio_row_files_put(brio_row_files *f, uint32_t into, const void *row, size_t size);
/** Writes the rows that wait. */
brio_status brio_row_files_flush(brio_row_files *f);
/** Frees memory; the files stay. Accepts zeros, and what brio_row_files_open made before it failed: rows that wait are
 *  lost then. */
void brio_row_files_close(brio_row_files *f);

/** Reads all rows of a file.   *rows  the caller's: brio_release; receives them.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_row_files_read(brio_store_folder *folder, const char *name, uint32_t i, size_t size, void **rows,
                                size_t *count);
/** Removes a file, and gives its room back. */
void brio_row_files_remove(brio_store_folder *folder, const char *name, uint32_t i);

#endif
