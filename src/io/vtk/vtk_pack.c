/* Compressed arrays of VTK's XML files: blocks of zlib, and their sizes in front of them.
 *
 * Threads compress a batch of blocks at a time. The blocks do not depend on the number of threads.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_pack.h"
#include "base/memory.h"
#include "base/team.h"
#include "io/vtk/vtk_zlib.h"
#include <string.h>

/* BLOCK: bytes of a block; a multiple of every scalar's size, and large enough that beginning anew costs little. BATCH:
 * blocks compressed at a time. Both chosen. */
enum { BLOCK = 1 << 17, BATCH = 32, WORDS = 3 };

typedef struct {
    brio_context *ctx;
    char *plain, *packed; /* BATCH blocks, and room for as many when they are compressed */
    size_t plain_size;    /* of all blocks of the batch */
    size_t sizes[BATCH];
    brio_status status;
} batch;

static void pack_blocks(void *user, size_t begin, size_t end, int thread) {
    batch *b = user;
    size_t bound = brio_vtk_deflate_bound(BLOCK);
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        size_t left = b->plain_size - i * BLOCK;
        b->sizes[i] = bound;
        brio_report(&b->status, brio_vtk_deflate(b->ctx, b->plain + i * BLOCK, left < BLOCK ? left : BLOCK,
                                                 b->packed + i * bound, &b->sizes[i]));
    }
}

/* Appends the blocks of a batch, and stores their sizes in front.   first  the number of the first one. */
static brio_status append(brio_vtk_appended *a, const batch *b, uint64_t first, size_t count) {
    brio_status status = BRIO_OK;
    for (size_t i = 0; i < count; i++) {
        uint64_t size = b->sizes[i];
        BRIO_TRY(BRIO_RESERVE(b->ctx, a->packed, a->capacity, a->packed_size + size));
        memcpy(a->packed + (WORDS + first + i) * sizeof size, &size, sizeof size);
        memcpy(a->packed + a->packed_size, b->packed + i * brio_vtk_deflate_bound(BLOCK), size);
        a->packed_size += size;
    }
done:
    return status;
}

static brio_status report(brio_vtk_writer *w, size_t size) {
    w->compressed += size;
    double share = w->out->expected ? (double)w->compressed / (double)w->out->expected : 0;
    return brio_progress(w->out->ctx, "write", share < 1 ? share : 1);
}

static brio_status pack_batches(brio_vtk_writer *w, brio_vtk_appended *a, batch *b) {
    brio_status status = BRIO_OK;
    const brio_vtk_source *source = &a->source;
    size_t size = brio_vtk_type_size(source->type);
    uint64_t most = BATCH * (uint64_t)BLOCK / size;
    for (uint64_t first = 0; first < source->count; first += most) {
        size_t numbers = (size_t)(source->count - first < most ? source->count - first : most);
        source->fill(source->user, first, numbers, b->plain);
        b->plain_size = numbers * size;
        size_t blocks = (b->plain_size + BLOCK - 1) / BLOCK;
        BRIO_TRY(brio_for_chunks(b->ctx, brio_threads(b->ctx, blocks, 1), blocks, 1, pack_blocks, b));
        BRIO_TRY(b->status);
        BRIO_TRY(append(a, b, first * size / BLOCK, blocks));
        BRIO_TRY(report(w, b->plain_size));
    }
done:
    return status;
}

brio_status brio_vtk_pack(brio_vtk_writer *w, brio_vtk_appended *a) {
    brio_status status = BRIO_OK;
    batch b = {.ctx = w->out->ctx, .status = BRIO_OK};
    uint64_t bytes = a->source.count * brio_vtk_type_size(a->source.type), blocks = (bytes + BLOCK - 1) / BLOCK;
    const uint64_t words[WORDS] = {blocks, BLOCK, bytes % BLOCK};
    size_t most = blocks < BATCH ? (size_t)blocks : BATCH;
    BRIO_TRY(BRIO_ALLOC(b.ctx, b.plain, most * BLOCK));
    BRIO_TRY(BRIO_ALLOC(b.ctx, b.packed, most * brio_vtk_deflate_bound(BLOCK)));
    a->packed_size = (WORDS + (size_t)blocks) * sizeof *words;
    BRIO_TRY(BRIO_RESERVE(b.ctx, a->packed, a->capacity, a->packed_size));
    memcpy(a->packed, words, sizeof words);
    BRIO_TRY(pack_batches(w, a, &b));
    BRIO_TRY(BRIO_RESIZE(b.ctx, a->packed, a->packed_size));
done:
    brio_release(b.ctx, b.plain);
    brio_release(b.ctx, b.packed);
    return status;
}
