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
 * The energy alone cannot do this, because it knows nothing of topology: it is a sum over tetrahedra and facets. */
#include "reconstruct/labeled_delaunay/weak_handles.h"
#include "base/memory.h"
#include "reconstruct/labeled_delaunay/simple_flips.h"
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include <stdlib.h>

/* BIASES: cuts for each label. MOST_PATCH: tetrahedra of a patch. NEARBY: tetrahedra
 * looked at until those next to a patch are connected. All chosen. */
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
    uint32_t patch[MOST_PATCH], front[NEARBY];
    size_t patch_size, removed;
} search;

/* --- patches --- */

/* Opens the tetrahedra of samples in doubt: those whose violated votes are over DOUBT of all their votes. */
static void open_doubtful(search *s) {
    const brio_vote_graph *g = s->f->g;
    for (size_t p = 0; p < s->f->num_samples; p++) {
        int64_t all = llabs(brio_vote_of(brio_own_vote(g, p))), outer = llabs(s->f->outer[p]);
        for (size_t i = g->first[p]; i < g->first[p + 1]; i++)
            all += llabs(brio_vote_of(brio_star_vote(g, g->star[i])));
        if ((double)(all - outer) <= 2 * DOUBT * (double)all) continue;
        for (size_t i = g->first[p]; i < g->first[p + 1]; i++) s->open[brio_star_tet(g->star[i])] = 1;
    }
}

static bool leans(const search *s, uint32_t tet, uint8_t label) {
    return tet < s->f->num_finite && s->f->label[tet] == label && s->leaning[tet] != label;
}

/* Collects the patch of a tetrahedron, and marks it as done. Returns false if it is too large. */
static bool collect_patch(search *s, uint32_t first, uint8_t label) {
    bool fits = true;
    s->patch[0] = first;
    s->patch_size = 1;
    s->leaning[first] = label;
    for (size_t i = 0; i < s->patch_size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->patch[i]].mate[k]);
            if (!leans(s, other, label)) continue;
            if (s->patch_size == MOST_PATCH) {
                fits = false;
                continue;
            }
            s->leaning[other] = label;
            s->patch[s->patch_size++] = other;
        }
    return fits;
}

/* --- what a flip does to the topology --- */

/* Marks the tetrahedra with a label next to flips [from, size) with a stamp. Returns their number.
 * first  receives one of them. */
static size_t mark_next_to(search *s, size_t from, uint8_t label, uint32_t stamp, uint32_t *first) {
    size_t count = 0;
    for (size_t i = from; i < s->f->size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->f->flipped[i]].mate[k]);
            if (s->f->label[other] != label || s->seen[other] == stamp) continue;
            s->seen[other] = stamp;
            *first = other;
            count++;
        }
    return count;
}

typedef enum { APART, TOGETHER, NOTHING } neighbours;

/* Returns whether the tetrahedra with a label next to flips are connected nearby, or whether there are none. */
static neighbours look_next_to(search *s, size_t from, uint8_t label) {
    uint32_t wanted = ++s->stamp, done = ++s->stamp;
    size_t size = 1, left = mark_next_to(s, from, label, wanted, s->front);
    if (left == 0) return NOTHING;
    s->seen[s->front[0]] = done;
    left--;
    for (size_t i = 0; i < size && left > 0; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(s->t->tet[s->front[i]].mate[k]);
            if (s->f->label[other] != label || s->seen[other] == done || size == NEARBY) continue;
            left -= s->seen[other] == wanted;
            s->seen[other] = done;
            s->front[size++] = other;
        }
    return left == 0 ? TOGETHER : APART;
}

/* --- one patch --- */

static brio_status flip_patch(search *s) {
    brio_status status = BRIO_OK;
    size_t from = s->f->size;
    for (size_t i = 0; i < s->patch_size; i++) BRIO_TRY(brio_flip(s->f, s->patch[i]));
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
static brio_status weigh_patch(search *s, uint8_t label) {
    brio_status status = BRIO_OK;
    size_t from = s->f->size, singular = s->m->singular;
    int64_t energy = s->f->energy, twice = s->f->faces - 2 * s->m->all_fans;
    brio_mending_forget(s->m);
    BRIO_TRY(flip_patch(s));
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

/* Weighs the patches of tetrahedra with a label that have the other one if the votes lean to it. */
static brio_status weigh_patches(search *s, uint8_t label, double bias) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_progress(s->f->ctx, "handles", 1));
    BRIO_TRY(brio_vote_cut_find(&s->cut, label == BRIO_LABEL_INNER ? bias : -bias, s->f->label, s->leaning));
    for (uint32_t tet = 0; tet < s->f->num_finite; tet++)
        if (leans(s, tet, label) && collect_patch(s, tet, label) && !brio_flips_deform(s->m, s->patch, s->patch_size))
            BRIO_TRY(weigh_patch(s, label));
done:
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
    open_doubtful(s);
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
    }
    brio_release(ctx, s);
    return status;
}
