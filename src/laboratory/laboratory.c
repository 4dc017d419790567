/* Experiments made and ended: a context that has one does as its options say. The options choose the parts
 * (base/experiment.h) that it has in the context's calls; a part that they do not choose stays the library's. */
#include "laboratory/laboratory.h"
#include "base/memory.h"
#include "laboratory/blocks.h"

/* Twice their number fits in 32 bits, and where addresses have 32 bits so do the bytes of what is made of them. */
static const size_t MOST_EDGES = SIZE_MAX / 16 < INT32_MAX ? SIZE_MAX / 16 : INT32_MAX;

static brio_status check(brio_context *ctx, const brio_laboratory_options *o) {
    BRIO_EXPECT(ctx, !ctx->experiment, BRIO_ERR_ARGUMENT, "the context has an experiment already");
    BRIO_EXPECT(ctx, (unsigned)o->locate < BRIO_LOCATION_END, BRIO_ERR_ARGUMENT, "no location strategy %d",
                (int)o->locate);
    BRIO_EXPECT(ctx, (unsigned)o->order < BRIO_BLOCKS_END, BRIO_ERR_ARGUMENT, "no order by blocks %d", (int)o->order);
    BRIO_EXPECT(ctx, (unsigned)o->labeling < BRIO_LABELS_END, BRIO_ERR_ARGUMENT, "no such labeling: %d",
                (int)o->labeling);
    BRIO_EXPECT(ctx, (unsigned)o->extraction < BRIO_EXTRACTION_END, BRIO_ERR_ARGUMENT, "no such extraction: %d",
                (int)o->extraction);
    BRIO_EXPECT(ctx, o->num_edges <= MOST_EDGES, BRIO_ERR_TOO_LARGE, "%zu edges; at most %zu", o->num_edges,
                MOST_EDGES);
    BRIO_EXPECT(ctx, !(o->page_bytes & (o->page_bytes - 1)) && (!o->page_bytes || o->page_bytes >= 64),
                BRIO_ERR_ARGUMENT, "pages of %llu bytes; their size is a power of two from 64 on",
                (unsigned long long)o->page_bytes);
    BRIO_EXPECT(ctx, !o->cache_bytes || o->page_bytes, BRIO_ERR_ARGUMENT, "a cache of pages without a size of pages");
    BRIO_EXPECT(ctx, !o->all_conflicts || !o->first_conflict, BRIO_ERR_ARGUMENT,
                "only one of all conflicts and the first conflict");
    return BRIO_OK;
}

/* Makes the parts that the options choose. */
static void choose_parts(brio_laboratory *lab) {
    const brio_laboratory_options *o = &lab->options;
    bool theoretical = o->labeling == BRIO_LABELS_THEORETICAL;
    lab->trial = (brio_trial){.ctx = lab->ctx, .options = o};
    lab->order = (struct brio_order_part){o, brio_block_order};
    brio_trial_part(&lab->trial, &lab->insertion);
    lab->labels = (struct brio_label_part){lab, theoretical ? BRIO_DEEP_WEIGHT : 0,
                                           theoretical ? brio_label_theoretical : brio_label_naive};
    lab->extraction = (struct brio_extraction_part){lab, brio_extract_literally};
    bool inserts = o->locate != BRIO_LOCATION_WALK || o->record_every || o->page_bytes;
    lab->experiment = (struct brio_experiment){
        .order = o->order != BRIO_BLOCKS_NONE ? &lab->order : NULL,
        .insertion = inserts ? &lab->insertion : NULL,
        .labels = o->labeling != BRIO_LABELS_NONE ? &lab->labels : NULL,
        .extraction = o->extraction != BRIO_EXTRACTION_LABELS ? &lab->extraction : NULL,
    };
}

brio_status brio_laboratory_new(brio_context *ctx, const brio_laboratory_options *options, brio_laboratory **out) {
    brio_laboratory *lab = NULL;
    *out = NULL;
    BRIO_FORWARD(check(ctx, options));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, lab, 1));
    lab->ctx = ctx;
    lab->options = *options;
    choose_parts(lab);
    ctx->experiment = &lab->experiment;
    *out = lab;
    return BRIO_OK;
}

void brio_laboratory_end(brio_laboratory *lab) {
    if (lab && lab->ctx->experiment == &lab->experiment) lab->ctx->experiment = NULL;
}

void brio_laboratory_free(brio_laboratory *lab) {
    if (!lab) return;
    brio_laboratory_end(lab);
    brio_trial_clear(&lab->trial);
    brio_release(lab->ctx, lab);
}

const brio_laboratory_stats *brio_laboratory_results(brio_laboratory *lab) {
    brio_trial *trial = &lab->trial;
    if (trial->touches) brio_page_touches_total(trial->touches, &trial->stats);
    return &trial->stats;
}

const brio_round *brio_laboratory_rounds(const brio_laboratory *lab, size_t *count) {
    *count = lab->trial.count;
    return lab->trial.list;
}

const uint64_t *brio_laboratory_cache_faults(brio_laboratory *lab, size_t *count) {
    brio_trial *trial = &lab->trial;
    *count = trial->touches ? brio_page_touches_faults(trial->touches, trial->cache_faults) : 0;
    return *count ? trial->cache_faults : NULL;
}
