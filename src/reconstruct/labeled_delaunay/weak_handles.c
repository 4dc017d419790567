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
 * That order goes here and there, and where arrays are in scratch files each place is a page to wait for. Nearly all
 * patches only deform the boundary. So this is found out when they are listed, along the tetrahedra, and it stands
 * until a flip that stays has a sample of the patch (forget_patches): the order of hashes meets no other patch's
 * pages. */
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
    uint8_t *deforms; /* of each patch: whether it deforms the boundary only, as far as is known */
    uint64_t *owner;  /* tetrahedron << 32 | patch, ascending; listed when it is needed */
    size_t num_owners, deforms_room, owner_room;
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

/* Lists the patch of a tetrahedron, and marks it as done. Leaves it out if it is too large. Looks at once whether it
 * deforms the boundary only, which nearly all do: patches are listed in the order of the tetrahedra, so what one reads
 * is near what the last one read. */
static brio_status list_patch(search *s, uint32_t seed, uint8_t label) {
    brio_status status = BRIO_OK;
    size_t begin = s->size;
    uint64_t hash;
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
    if (s->size - begin > MOST_PATCH) {
        s->size = begin;
        return BRIO_OK;
    }
    hash = sort_by_hash(s, s->tet + begin, s->size - begin);
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->first, s->first_room, s->num_patches + 2));
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->hash, s->hash_room, s->num_patches + 1));
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->deforms, s->deforms_room, s->num_patches + 1));
    s->hash[s->num_patches] = hash;
    s->first[s->num_patches] = begin;
    s->deforms[s->num_patches] = brio_flips_deform(s->m, s->tet + begin, s->size - begin);
    s->first[++s->num_patches] = s->size;
done:
    return status;
}

/* Lists the patches of tetrahedra with a label that have the other one if the votes lean to it. */
static brio_status list_patches(search *s, uint8_t label) {
    brio_status status = BRIO_OK;
    s->size = s->num_patches = s->num_owners = 0;
    for (uint32_t tet = 0; tet < s->f->num_finite; tet++) {
        brio_along(s->f->ctx, tet, s->f->num_finite, BRIO_READS(s->t->tet));
        if (leans(s, tet, label)) BRIO_TRY(list_patch(s, tet, label));
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

/* Returns whether the tetrahedra with a label next to flips are connected nearby, or whether there are none. Looks ring
 * after ring round one of them, each as a whole: so the order within a ring does not matter. */
static neighbours look_next_to(search *s, size_t from, uint8_t label) {
    uint32_t wanted = ++s->stamp, done = ++s->stamp;
    size_t size = 1, ring = 1, left = mark_next_to(s, from, label, wanted, s->front);
    if (left == 0) return NOTHING;
    s->seen[s->front[0]] = done;
    left--;
    for (size_t i = 0; i < size && left > 0; i++) {
        if (i == ring && size > NEARBY) break;
        if (i == ring) ring = size;
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->front[i]].mate[k]);
            if (s->f->label[other] != label || s->seen[other] == done) continue;
            left -= s->seen[other] == wanted;
            s->seen[other] = done;
            s->front[size++] = other;
        }
    }
    return left == 0 ? TOGETHER : APART;
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

/* Returns whether flips are worth what they cost.   twice  by how much they raise twice the Euler characteristic. */
static bool is_worth(search *s, uint8_t label, size_t from, int64_t cost, int64_t twice) {
    if (twice == 0) return false;
    neighbours left = look_next_to(s, from, label), grown = look_next_to(s, from, brio_other_label(label));
    if (left == NOTHING) twice = 4;
    return left != APART && grown == TOGETHER && twice > 0 && 4 * cost < twice * HANDLE;
}

/* Flips a patch, and takes the flips back unless they are worth their energy. */
static brio_status weigh_patch(search *s, const uint32_t *patch, size_t count, uint8_t label) {
    brio_status status = BRIO_OK;
    size_t from = s->f->size, singular = s->m->singular;
    int64_t energy = s->f->energy, twice = s->f->faces - 2 * s->m->all_fans;
    brio_mending_forget(s->m);
    BRIO_TRY(flip_patch(s, patch, count));
    size_t to = s->f->size;
    twice += 2 * s->m->all_fans - s->f->faces;
    bool worth = s->m->singular <= singular && is_worth(s, label, from, s->f->energy - energy, twice);
    s->removed += worth;
    if (worth) goto done;
    brio_take_back(s->f, from);
    BRIO_TRY(brio_mending_look(s->m, from, to));
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

/* Lists which patch each tetrahedron of the patches is in, by tetrahedra. */
static brio_status list_owners(search *s) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(s->f->ctx, s->owner, s->owner_room, s->size));
    for (size_t i = 0; i < s->num_patches; i++)
        for (size_t k = s->first[i]; k < s->first[i + 1]; k++) s->owner[k] = (uint64_t)s->tet[k] << 32 | i;
    BRIO_TRY(brio_sort_many_keys(s->f->ctx, s->owner, s->size));
    s->num_owners = s->size;
done:
    return status;
}

/* Forgets what is known of the patch that a tetrahedron is in. */
static void forget_patch(search *s, uint32_t tet) {
    size_t low = 0, high = s->num_owners;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (s->owner[middle] >> 32 < tet)
            low = middle + 1;
        else
            high = middle;
    }
    if (low < s->num_owners && s->owner[low] >> 32 == tet) s->deforms[(uint32_t)s->owner[low]] = 0;
}

/* Forgets what is known of the patches at the samples of flips [from, size). Whether a patch deforms the boundary only
 * is read from the stars of its samples. What is flipped in such a star has the sample, too. A patch at a sample with a
 * star of over BRIO_STAR_ROOM tetrahedra is never known to deform only, so that these stars need not be read. */
static brio_status forget_patches(search *s, size_t from) {
    brio_status status = BRIO_OK;
    const brio_vote_graph *g = s->f->g;
    if (s->num_owners == 0) BRIO_TRY(list_owners(s));
    for (size_t i = from; i < s->f->size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t p = s->t->tet[s->f->flipped[i]].vertex[k];
            if (g->first[p + 1] - g->first[p] > BRIO_STAR_ROOM) continue;
            for (size_t n = g->first[p]; n < g->first[p + 1]; n++) forget_patch(s, brio_star_tet(g->star[n]));
        }
done:
    return status;
}

/* Weighs a patch unless it deforms the boundary only. */
static brio_status try_patch(search *s, size_t i, uint8_t label) {
    brio_status status = BRIO_OK;
    size_t from = s->f->size, count;
    uint32_t *patch = s->tet + s->first[i];
    assert(!s->deforms[i] || brio_flips_deform(s->m, patch, s->first[i + 1] - s->first[i]));
    if (s->deforms[i]) return BRIO_OK;
    count = keep_label(s, patch, s->first[i + 1] - s->first[i], label);
    if (count == 0 || brio_flips_deform(s->m, patch, count)) return BRIO_OK;
    BRIO_TRY(weigh_patch(s, patch, count, label));
    if (s->f->size > from) BRIO_TRY(forget_patches(s, from));
done:
    return status;
}

/* Weighs the patches of tetrahedra with a label that have the other one if the votes lean to it. */
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
    for (size_t i = 0; i < s->num_patches; i++) BRIO_TRY(try_patch(s, order[i], label));
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
        brio_release(ctx, s->deforms);
        brio_release(ctx, s->owner);
    }
    brio_release(ctx, s);
    return status;
}
