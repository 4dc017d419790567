/* Mappings that blocks have given back, kept for later blocks.
 *
 * I1  Outside the functions of this file, kept bytes + live bytes <= peak of live bytes. So keeping mappings needs no
 *     more memory than the work needed without. */
#include "base/kept.h"
#include "base/poison.h"
#include "platform/pages.h"
#include <assert.h>

/* Most bytes kept outside brio_keep_begin and brio_keep_end. Chosen. */
static const size_t BETWEEN_CALLS = (size_t)64 << 20;

void brio_unmap(void *base, size_t size) {
    brio_poison_show(base, size);
    brio_pages_unmap(base, size);
}

/* Unmaps the last bytes of kept mapping i. */
static void cut(brio_context *ctx, int i, size_t size) {
    brio_mapping *m = &ctx->kept[i];
    assert(0 < size && size <= m->size && size % BRIO_PAGE == 0);
    assert(ctx->kept_bytes >= size); /* the sum of the sizes */
    m->size -= size;
    brio_unmap((char *)m->base + m->size, size);
    __atomic_sub_fetch(&ctx->kept_bytes, size, __ATOMIC_RELAXED);
    if (!m->size) *m = ctx->kept[--ctx->num_kept];
}

/* Unmaps kept bytes until at most `most` are left, the smallest mappings first. */
static void trim(brio_context *ctx, size_t most) {
    while (ctx->kept_bytes > most) {
        assert(ctx->num_kept > 0);
        int least = 0;
        for (int i = 1; i < ctx->num_kept; i++)
            if (ctx->kept[i].size < ctx->kept[least].size) least = i;
        size_t over = (ctx->kept_bytes - most + BRIO_PAGE - 1) / BRIO_PAGE * BRIO_PAGE, size = ctx->kept[least].size;
        cut(ctx, least, size < over ? size : over);
    }
}

/* Returns how many bytes may be kept now. */
static size_t most_kept(const brio_context *ctx) {
    size_t live = __atomic_load_n(&ctx->live, __ATOMIC_RELAXED), peak = __atomic_load_n(&ctx->peak, __ATOMIC_RELAXED);
    size_t most = peak > live ? peak - live : 0;
    return ctx->keeping || most < BETWEEN_CALLS ? most : BETWEEN_CALLS;
}

/* Returns the index of the smallest kept mapping of at least `least` bytes, or -1. */
static int smallest(const brio_context *ctx, size_t least) {
    int best = -1;
    for (int i = 0; i < ctx->num_kept; i++)
        if (ctx->kept[i].size >= least && (best < 0 || ctx->kept[i].size < ctx->kept[best].size)) best = i;
    return best;
}

void *brio_kept_take(brio_context *ctx, size_t size) {
    void *base = NULL;
    assert(size > 0 && size % BRIO_PAGE == 0);
    brio_mutex_lock(&ctx->lock);
    int i = smallest(ctx, size);
    if (i >= 0) {
        brio_mapping *m = &ctx->kept[i];
        assert(m->size >= size && ctx->kept_bytes >= size);
        base = m->base;
        m->base = (char *)m->base + size;
        m->size -= size;
        __atomic_sub_fetch(&ctx->kept_bytes, size, __ATOMIC_RELAXED);
        if (!m->size) *m = ctx->kept[--ctx->num_kept];
    }
    brio_mutex_unlock(&ctx->lock);
    if (base) brio_poison_fill(base, size);
    return base;
}

void brio_kept_give(brio_context *ctx, void *base, size_t size) {
    assert(size > 0 && size % BRIO_PAGE == 0);
    brio_poison_hide(base, size);
    brio_mutex_lock(&ctx->lock);
    assert(0 <= ctx->num_kept && ctx->num_kept <= BRIO_MOST_KEPT);
    bool full = ctx->num_kept == BRIO_MOST_KEPT || !brio_pages_divide();
    if (!full) {
        ctx->kept[ctx->num_kept++] = (brio_mapping){base, size};
        __atomic_add_fetch(&ctx->kept_bytes, size, __ATOMIC_RELAXED);
        trim(ctx, most_kept(ctx));
    }
    brio_mutex_unlock(&ctx->lock);
    if (full) brio_unmap(base, size);
}

void brio_kept_make_room(brio_context *ctx) {
    if (__atomic_load_n(&ctx->kept_bytes, __ATOMIC_RELAXED) <= most_kept(ctx)) return;
    brio_mutex_lock(&ctx->lock);
    trim(ctx, most_kept(ctx));
    brio_mutex_unlock(&ctx->lock);
}

void brio_kept_free(brio_context *ctx) {
    trim(ctx, 0);
    assert(ctx->num_kept == 0 && ctx->kept_bytes == 0);
}

void brio_keep_begin(brio_context *ctx) {
    ctx->keeping++;
}

void brio_keep_end(brio_context *ctx) {
    assert(ctx->keeping > 0);
    ctx->keeping--;
    brio_kept_make_room(ctx);
}
