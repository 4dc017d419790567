/* Files of rows: see row_files.h. Few bytes wait for each where there are many files. */
#include "store/row_files.h"
#include "base/memory.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

/* Bytes that wait for a file, and for all together (brio_waiting_bytes). All chosen. */
enum { WAITING = 1 << 14, ALL_WAITING = 1 << 22, LEAST_WAITING = 1 << 10 };

static void name_of(const char *name, uint32_t i, char full[32]) {
    snprintf(full, 32, "%s-%u", name, i);
}

brio_status brio_row_files_open(brio_store_folder *folder, const char *name, uint32_t count, brio_row_files *out) {
    brio_context *ctx = folder->ctx;
    *out = (brio_row_files){.folder = folder, .count = count};
    out->room = brio_waiting_bytes(ctx, count, LEAST_WAITING, WAITING, ALL_WAITING);
    assert(strlen(name) < sizeof out->name);
    strcpy(out->name, name);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, out->file, count));
    for (uint32_t i = 0; i < count; i++) out->file[i].file.file = -1;
    for (uint32_t i = 0; i < count; i++) {
        char full[32];
        name_of(name, i, full);
        BRIO_FORWARD(brio_store_create(folder, full, &out->file[i].file));
        brio_store_shut(&out->file[i].file);
        BRIO_FORWARD(BRIO_ALLOC(ctx, out->file[i].bytes, out->room));
    }
    return BRIO_OK;
}

static brio_status flush(brio_row_file *f) {
    brio_status status = brio_store_append(&f->file, f->bytes, f->size);
    f->size = 0;
    return status;
}

brio_status brio_row_files_put(brio_row_files *all, uint32_t into, const void *row, size_t size) {
    assert(into < all->count && size <= all->room);
    brio_row_file *f = &all->file[into];
    if (f->size + size > all->room) BRIO_FORWARD(flush(f));
    memcpy(f->bytes + f->size, row, size);
    f->size += size;
    return BRIO_OK;
}

brio_status brio_row_files_flush(brio_row_files *all) {
    for (uint32_t i = 0; i < all->count; i++) BRIO_FORWARD(flush(&all->file[i]));
    return BRIO_OK;
}

void brio_row_files_close(brio_row_files *all) {
    for (uint32_t i = 0; all->file && i < all->count; i++) {
        brio_store_close(&all->file[i].file);
        brio_release(all->folder->ctx, all->file[i].bytes);
    }
    if (all->file) brio_release(all->folder->ctx, all->file);
    all->file = NULL;
}

brio_status brio_row_files_read(brio_store_folder *folder, const char *name, uint32_t i, size_t size, void **rows,
                                size_t *count) {
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    uint8_t *bytes = NULL;
    char full[32];
    name_of(name, i, full);
    BRIO_TRY(brio_store_open(folder, full, &f));
    *count = (size_t)(f.size / size);
    BRIO_TRY(BRIO_ALLOC(folder->ctx, bytes, *count * size + 1));
    *rows = bytes;
    status = brio_store_read(&f, 0, bytes, *count * size);
done:
    brio_store_close(&f);
    return status;
}

void brio_row_files_remove(brio_store_folder *folder, const char *name, uint32_t i) {
    char full[32];
    name_of(name, i, full);
    brio_store_remove(folder, full);
}
