/* Handles, tunnels and crumbs that little evidence holds.
 *
 * A false handle costs little energy to remove: that is what makes it suspicious. Candidates are found by minimum cuts
 * with a bias: what becomes outer when all votes lean a little to outer, or inner when they lean to inner, falls into
 * patches. Each patch is flipped by itself, and stars that this spoils are mended. The flips stay if the Euler
 * characteristic of the boundary grows by 2 for each HANDLE of energy, and if no component appeared: on either side of
 * the boundary, the tetrahedra next to the patch must still be connected, and nearby. A patch with nothing but the
 * other label about it is a crumb or a bubble, which counts as much as a handle. Otherwise the flips are taken back. A
 * patch whose flip is known to deform the boundary only (simple_flips.c) leaves the Euler characteristic, and is not
 * weighed.
 *
 * The energy alone cannot do this, because it knows nothing of topology: it is a sum over tetrahedra and facets.
 *
 * The patches of a cut are listed before any is flipped, and go in the order of their hashes (hash_order.h). So what
 * becomes of one depends on those beside it, and on no number of a tetrahedron.
 *
 * That order goes here and there, and where arrays are in scratch files each place is pages to wait for. Nearly all
 * patches only deform the boundary, and of the others most are not worth what they cost. So each is weighed when it is
 * listed, along the tetrahedra, with the samples noted whose stars that reads. What is found stands until a flip that
 * stays has one of these samples (forget_readers): the order of hashes meets the pages of few patches. */
#include "reconstruct/labeled_delaunay/weak_handles.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "reconstruct/labeled_delaunay/hash_order.h"
#include "reconstruct/labeled_delaunay/simple_flips.h"
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include <assert.h>
#include <stdlib.h>

/* BIASES: cuts for each label. MOST_PATCH: tetrahedra of a patch. NEARBY: while no more tetrahedra were looked at,
 * their neighbours are, too, until those next to a patch are connected. All chosen. */
enum { BIASES = 3, MOST_PATCH = BRIO_MOST_SIMPLE, NEARBY = 4096 };

/* Samples of a block, which are near each other: blocks are noted. Chosen. */
enum { BLOCK = 16 };

/* In log-odds. BIAS: what all votes lean by. HANDLE: how much more likely a surface is without a small handle than with
 * it, before samples are looked at. Chosen: on generated solids, raw scans and the models beside the project 8, 16 and
 * 32 differ by a run of 321 or two. */
static const double BIAS[BIASES] = {1, 2, 4};
static const int64_t HANDLE = 16 * BRIO_FLIP_UNIT;

/* A sample is in doubt if its violated votes are over this share of its votes. Chosen on raw scans. */
static const double DOUBT = 0.1;

typedef struct {
    brio_mending *m;
    brio_label_flips *f;
    const brio_tetrahedra *t;
    brio_vote_cut cut;
    uint8_t *open;    /* #T: 1 if a sample of the tetrahedron is in doubt */
    uint8_t *leaning; /* #T: the labels of the cut with a bias */
    uint32_t *seen;   /* #T: the last stamp of each tetrahedron */
    uint32_t stamp;
    uint32_t front[4 * NEARBY];
    uint32_t *tet;  /* the patches of the cut, one after another */
    size_t *first;  /* where each begins */
    uint64_t *hash; /* of each */
    size_t size, num_patches, room, first_room, hash_room;
    uint8_t *settled; /* of each patch: whether it is known that its flips do not stay */
    uint32_t *noted;  /* #P / BLOCK: the last weighing that read samples of the block, counted by `weighings` */
    uint32_t weighings;
    uint32_t *read;   /* blocks of samples whose stars the last weighing read */
    uint64_t *reader; /* block << 32 | settled patch that has read it; ascending when the first flips stay */
    size_t num_read, num_readers, settled_room, read_room, reader_room;
    bool is_sorted; /* `reader` */
    size_t removed;
} search;

/* --- patches --- */

/* Opens the tetrahedra of samples in doubt: those whose violated votes are over DOUBT of all their votes. */
static brio_status open_doubtful(search *s) {
    brio_status status = BRIO_OK;
    const brio_vote_graph *g = s->f->g;
    int64_t *outer = NULL, *all = NULL;
    BRIO_TRY(BRIO_ALLOC(s->f->ctx, outer, s->f->num_samples));
    BRIO_TRY(BRIO_ALLOC(s->f->ctx, all, s->f->num_samples));
    BRIO_TRY(brio_sum_votes(g, BRIO_FLIP_VOTES, s->f->label, outer, all));
    for (size_t p = 0; p < s->f->num_samples; p++) {
        if ((double)(all[p] - llabs(outer[p])) <= 2 * DOUBT * (double)all[p]) continue;
        for (size_t i = g->first[p]; i < g->first[p + 1]; i++) s->open[brio_star_tet(g->star[i])] = 1;
    }
done:
    brio_release(s->f->ctx, outer);
    brio_release(s->f->ctx, all);
    return status;
}

static bool leans(const search *s, uint32_t tet, uint8_t label) {
    return tet < s->f->num_finite && s->f->label[tet] == label && s->leaning[tet] != label;
}

/* Sorts the tetrahedra of a patch by their hashes, and returns the hash of the patch. */
static uint64_t sort_by_hash(const search *s, uint32_t *tet, size_t count) {
    uint64_t key[MOST_PATCH], sum = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t moved = tet[i];
        uint64_t hash = brio_tet_hash(s->f->g->dual, moved);
        size_t at = i;
        for (; at > 0 && key[at - 1] > hash; at--) key[at] = key[at - 1], tet[at] = tet[at - 1];
        key[at] = hash, tet[at] = moved;
        sum += hash;
    }
    return sum;
}

/* --- what a weighing reads --- */

static brio_status note(search *s, uint32_t sample) {
    brio_status status = BRIO_OK;
    if (sample == s->t->infinite || s->noted[sample / BLOCK] == s->weighings) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->read, s->read_room, s->num_read + 1));
    s->read[s->num_read++] = sample / BLOCK;
    s->noted[sample / BLOCK] = s->weighings;
done:
    return status;
}

/* Notes the first samples of a tetrahedron. Each of its neighbours has one of any two. */
static brio_status note_samples(search *s, uint32_t tet, int count) {
    brio_status status = BRIO_OK;
    for (int k = 0; k < count; k++) BRIO_TRY(note(s, s->t->tet[tet].vertex[k]));
done:
    return status;
}

/* Notes what flips [from, size) and the mending after them read: of samples of these flips, which are all that were
 * mended, the stars, and the stars of their samples. */
static brio_status note_flips(search *s, size_t from) {
    brio_status status = BRIO_OK;
    const brio_vote_graph *g = s->f->g;
    for (size_t i = from; i < s->f->size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t p = s->t->tet[s->f->flipped[i]].vertex[k];
            BRIO_TRY(note(s, p));
            if (g->first[p + 1] - g->first[p] > BRIO_STAR_ROOM) continue;
            for (size_t n = g->first[p]; n < g->first[p + 1]; n++)
                BRIO_TRY(note_samples(s, brio_star_tet(g->star[n]), 4));
        }
done:
    return status;
}

/* --- what a flip does to the topology --- */

/* Marks the tetrahedra with a label next to flips [from, size) with a stamp. Returns their number.
 * first  receives the one of the least hash. */
static size_t mark_next_to(search *s, size_t from, uint8_t label, uint32_t stamp, uint32_t *first) {
    size_t count = 0;
    uint64_t least = 0;
    for (size_t i = from; i < s->f->size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->f->flipped[i]].mate[k]);
            if (s->f->label[other] != label || s->seen[other] == stamp) continue;
            uint64_t hash = brio_tet_hash(s->f->g->dual, other);
            if (count == 0 || hash < least) least = hash, *first = other;
            s->seen[other] = stamp;
            count++;
        }
    return count;
}

typedef enum { APART, TOGETHER, NOTHING } neighbours;

/* Finds whether the tetrahedra with a label next to flips are connected nearby, or whether there are none. Looks ring
 * after ring round one of them, each as a whole: so the order within a ring does not matter. */
static brio_status look_next_to(search *s, size_t from, uint8_t label, neighbours *out) {
    brio_status status = BRIO_OK;
    uint32_t wanted = ++s->stamp, done = ++s->stamp;
    size_t size = 1, ring = 1, left = mark_next_to(s, from, label, wanted, s->front);
    *out = NOTHING;
    if (left == 0) return BRIO_OK;
    s->seen[s->front[0]] = done;
    left--;
    for (size_t i = 0; i < size && left > 0; i++) {
        if (i == ring && size > NEARBY) break;
        if (i == ring) ring = size;
        BRIO_TRY(note_samples(s, s->front[i], 2));
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->front[i]].mate[k]);
            if (s->f->label[other] != label || s->seen[other] == done) continue;
            left -= s->seen[other] == wanted;
            s->seen[other] = done;
            s->front[size++] = other;
        }
    }
    *out = left == 0 ? TOGETHER : APART;
done:
    return status;
}

/* --- one patch --- */

static brio_status flip_patch(search *s, const uint32_t *patch, size_t count) {
    brio_status status = BRIO_OK;
    size_t from = s->f->size;
    for (size_t i = 0; i < count; i++) BRIO_TRY(brio_flip(s->f, patch[i]));
    BRIO_TRY(brio_mending_look(s->m, from, s->f->size));
    BRIO_TRY(brio_mend(s->m));
done:
    return status;
}

/* Finds whether flips are worth what they cost.   twice  by how much they raise twice the Euler characteristic. */
static brio_status is_worth(search *s, uint8_t label, size_t from, int64_t cost, int64_t twice, bool *worth) {
    brio_status status = BRIO_OK;
    enum { ALONE = 4 }; /* what a crumb or a bubble counts */
    neighbours left, grown;
    *worth = false;
    if (twice == 0 || 4 * cost >= (twice > ALONE ? twice : ALONE) * HANDLE) return BRIO_OK;
    BRIO_TRY(look_next_to(s, from, label, &left));
    if (left == NOTHING) twice = ALONE;
    if (left == APART || twice <= 0 || 4 * cost >= twice * HANDLE) return BRIO_OK;
    BRIO_TRY(look_next_to(s, from, brio_other_label(label), &grown));
    *worth = grown == TOGETHER;
done:
    return status;
}

/* Flips a patch, and takes the flips back unless they are worth their energy.
 * stays  whether the flips may stay.   worth  receives whether they are worth it. */
static brio_status weigh_patch(search *s, const uint32_t *patch, size_t count, uint8_t label, bool stays, bool *worth) {
    brio_status status = BRIO_OK;
    size_t from = s->f->size, singular = s->m->singular;
    int64_t energy = s->f->energy, twice = s->f->faces - 2 * s->m->all_fans;
    *worth = false;
    brio_mending_forget(s->m);
    BRIO_TRY(flip_patch(s, patch, count));
    BRIO_TRY(note_flips(s, from));
    size_t to = s->f->size;
    twice += 2 * s->m->all_fans - s->f->faces;
    if (s->m->singular <= singular) BRIO_TRY(is_worth(s, label, from, s->f->energy - energy, twice, worth));
    if (*worth && stays) goto done;
    brio_take_back(s->f, from);
    BRIO_TRY(brio_mending_look(s->m, from, to));
done:
    return status;
}

/* Weighs a patch unless it deforms the boundary only, and notes what that reads. */
static brio_status try_patch(search *s, const uint32_t *patch, size_t count, uint8_t label, bool stays, bool *worth) {
    brio_status status = BRIO_OK;
    *worth = false;
    s->num_read = 0;
    s->weighings++;
    if (brio_flips_deform(s->m, patch, count))
        for (size_t i = 0; i < count; i++) BRIO_TRY(note_samples(s, patch[i], 4));
    else
        BRIO_TRY(weigh_patch(s, patch, count, label, stays, worth));
done:
    return status;
}

/* --- all patches of a cut --- */

/* Lists the patch of a tetrahedron, and marks it as done. */
static brio_status flood_patch(search *s, uint32_t seed, uint8_t label) {
    brio_status status = BRIO_OK;
    size_t begin = s->size;
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->tet, s->room, begin + 1));
    s->tet[s->size++] = seed;
    s->leaning[seed] = label;
    for (size_t i = begin; i < s->size; i++) {
        BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->tet, s->room, s->size + 4));
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->tet[i]].mate[k]);
            if (!leans(s, other, label)) continue;
            s->leaning[other] = label;
            s->tet[s->size++] = other;
        }
    }
done:
    return status;
}

/* Adds a settled patch to the readers of what its weighing read. */
static brio_status list_reader(search *s, size_t patch) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->reader, s->reader_room, s->num_readers + s->num_read));
    for (size_t i = 0; i < s->num_read; i++) s->reader[s->num_readers++] = (uint64_t)s->read[i] << 32 | patch;
done:
    return status;
}

/* Lists the patch of a tetrahedron, and weighs it. Leaves it out if it is too large. Patches are listed in the order of
 * the tetrahedra, so what one reads is near what the last one read. */
static brio_status list_patch(search *s, uint32_t seed, uint8_t label) {
    brio_status status = BRIO_OK;
    size_t begin = s->size, patch = s->num_patches;
    bool worth;
    BRIO_TRY(flood_patch(s, seed, label));
    if (s->size - begin > MOST_PATCH) {
        s->size = begin;
        return BRIO_OK;
    }
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->first, s->first_room, patch + 2));
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->hash, s->hash_room, patch + 1));
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->settled, s->settled_room, patch + 1));
    s->hash[patch] = sort_by_hash(s, s->tet + begin, s->size - begin);
    s->first[patch] = begin;
    s->first[patch + 1] = s->size;
    s->num_patches++;
    BRIO_TRY(try_patch(s, s->tet + begin, s->size - begin, label, false, &worth));
    s->settled[patch] = !worth;
    if (!worth) BRIO_TRY(list_reader(s, patch));
done:
    return status;
}

/* Announces what the weighing of patches reads, at the first tetrahedron of a stretch: of the next stretch, from the
 * first tetrahedron that leans to the last one. So stretches without patches are not read. */
static void expect_patches(const search *s, uint32_t tet, uint8_t label) {
    const brio_vote_graph *g = s->f->g;
    size_t from = tet + (size_t)BRIO_SWEEP_STRETCH, to = from + BRIO_SWEEP_STRETCH;
    if (!s->f->ctx->scratch || tet % BRIO_SWEEP_STRETCH != 0) return;
    if (to > s->f->num_finite) to = s->f->num_finite;
    while (from < to && !leans(s, (uint32_t)from, label)) from++;
    while (from < to && !leans(s, (uint32_t)to - 1, label)) to--;
    brio_expect_rows(s->f->ctx, BRIO_ARRAYS(BRIO_READS(s->t->tet), BRIO_READS(g->vote), BRIO_READS(g->facet)), from,
                     to);
}

/* Lists the patches of tetrahedra with a label that have the other one if the votes lean to it. */
static brio_status list_patches(search *s, uint8_t label) {
    brio_status status = BRIO_OK;
    s->size = s->num_patches = s->num_readers = 0;
    s->is_sorted = false;
    for (uint32_t tet = 0; tet < s->f->num_finite; tet++) {
        expect_patches(s, tet, label);
        if (leans(s, tet, label)) BRIO_TRY(list_patch(s, tet, label));
    }
done:
    return status;
}

/* Returns the first reader of a block of samples, or one of a later block, or s->num_readers. */
static size_t first_reader(const search *s, uint32_t block) {
    size_t low = 0, high = s->num_readers;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (s->reader[middle] >> 32 < block)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Forgets what is known of the patches that have read stars of samples of flips [from, size). */
static brio_status forget_readers(search *s, size_t from) {
    brio_status status = BRIO_OK;
    if (!s->is_sorted) BRIO_TRY(brio_sort_many_keys(s->f->ctx, s->reader, s->num_readers));
    s->is_sorted = true;
    for (size_t i = from; i < s->f->size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t block = s->t->tet[s->f->flipped[i]].vertex[k] / BLOCK;
            for (size_t n = first_reader(s, block); n < s->num_readers && s->reader[n] >> 32 == block; n++)
                s->settled[(uint32_t)s->reader[n]] = 0;
        }
done:
    return status;
}

/* Leaves out what other patches have flipped since. Returns how many tetrahedra are left. */
static size_t keep_label(const search *s, uint32_t *patch, size_t count, uint8_t label) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (s->f->label[patch[i]] == label) patch[kept++] = patch[i];
    return kept;
}

/* Gives a patch its turn: its flips stay if they are worth what they cost. */
static brio_status take_turn(search *s, size_t patch, uint8_t label) {
    brio_status status = BRIO_OK;
    uint32_t *tet = s->tet + s->first[patch];
    size_t from = s->f->size, count = keep_label(s, tet, s->first[patch + 1] - s->first[patch], label);
    bool worth;
    if (count == 0) return BRIO_OK;
    BRIO_TRY(try_patch(s, tet, count, label, !s->settled[patch], &worth));
    assert(!s->settled[patch] || !worth);
    s->removed += worth;
    if (worth) BRIO_TRY(forget_readers(s, from));
done:
    return status;
}

/* Weighs the patches of tetrahedra with a label that have the other one if the votes lean to it. Checked builds weigh
 * the settled ones again. */
static brio_status weigh_patches(search *s, uint8_t label, double bias) {
    brio_status status = BRIO_OK;
    brio_context *ctx = s->f->ctx;
    uint32_t *order = NULL;
    BRIO_TRY(brio_progress(ctx, "handles", 1));
    BRIO_TRY(brio_vote_cut_find(&s->cut, label == BRIO_LABEL_INNER ? bias : -bias, s->f->label, s->leaning));
    BRIO_TRY(list_patches(s, label));
    BRIO_TRY(BRIO_ALLOC(ctx, order, s->num_patches));
    for (size_t i = 0; i < s->num_patches; i++) order[i] = (uint32_t)i;
    BRIO_TRY(brio_radix_sort(ctx, s->hash, order, s->num_patches, 64));
    for (size_t i = 0; i < s->num_patches; i++)
        if (BRIO_CHECKED_TURNS || !s->settled[order[i]]) BRIO_TRY(take_turn(s, order[i], label));
done:
    brio_release(ctx, order);
    return status;
}

brio_status brio_remove_weak_handles(brio_mending *m, size_t *removed) {
    brio_status status = BRIO_OK;
    brio_context *ctx = m->flips->ctx;
    search *s = NULL;
    *removed = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s, 1));
    s->m = m, s->f = m->flips, s->t = &m->flips->g->dual->t;
    BRIO_TRY(BRIO_ALLOC(ctx, s->leaning, s->f->num_tets));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->open, s->f->num_tets));
    BRIO_TRY(open_doubtful(s));
    BRIO_TRY(brio_vote_cut_new(s->f->g, s->open, &s->cut));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->seen, s->f->num_tets));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->noted, s->f->num_samples / BLOCK + 1));
    for (int i = 0; i < BIASES; i++) {
        brio_label_samples(s->f);
        BRIO_TRY(weigh_patches(s, BRIO_LABEL_OUTER, BIAS[i]));
        BRIO_TRY(weigh_patches(s, BRIO_LABEL_INNER, BIAS[i]));
    }
    *removed = s->removed;
done:
    if (s) {
        brio_vote_cut_free(&s->cut);
        brio_release(ctx, s->leaning);
        brio_release(ctx, s->open);
        brio_release(ctx, s->seen);
        brio_release(ctx, s->tet);
        brio_release(ctx, s->first);
        brio_release(ctx, s->hash);
        brio_release(ctx, s->settled);
        brio_release(ctx, s->noted);
        brio_release(ctx, s->read);
        brio_release(ctx, s->reader);
    }
    brio_release(ctx, s);
    return status;
}
