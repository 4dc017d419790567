/* Flips that make the boundary of labels a manifold at little cost.
 *
 * The boundary is one fan at a sample exactly if the star of the sample has at most one outer and one inner part,
 * connected across facets (cocone/manifold_stars.c). A part too many can be flipped, or joined to another part by flips
 * along a path through the star; or a single flip helps. Of all these the one is taken that lowers
 *     energy + price * surplus - HANDLE / 2 * Euler characteristic of the boundary
 * most. The surplus is the number of parts too many, at all samples that the flips touch; for the Euler characteristic,
 * a sample counts once for each fan. The price of a part rises from next to nothing, so that what the votes decide
 * clearly is decided first.
 *
 * Where nothing helps at a price, it is known which price would help. Until then the sample sleeps, unless a label
 * changes in the star of a sample that an edge joins to it, or in its own: moves there read no others.
 *
 * Every flip lowers the sum, so the work ends. Stars that no price mends are left to cocone/manifold_stars.c.
 *
 * At each price all singular samples have their turn, then those that were queued meanwhile, and so on. Each turn goes
 * in the order of the samples' hashes (hash_order.h), and hashes decide between moves and paths that are as good. A
 * move at a sample depends on the labels of the stars of the star's samples. So what happens at a sample depends on
 * samples at most two edges away that have less hashes, and on no number of a sample or a tetrahedron.
 *
 * Based on: Jones, Plassmann. A parallel graph coloring heuristic. SIAM J. Sci. Comput. 1993 (hashes as priorities). */
#include "reconstruct/labeled_delaunay/mending.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "reconstruct/labeled_delaunay/hash_order.h"
#include <assert.h>
#include <string.h>

/* MOST: tetrahedra that are flipped together. PRICES: the price is a quarter of a log-odds at first and doubles. SMALL:
 * in stars of more tetrahedra, single flips are not tried. All chosen. */
enum { MOST = 64, PRICES = 9, SMALL = 96 };
#define FIRST_PRICE (BRIO_FLIP_UNIT / 4)

/* Chosen. MOST_PLACES: threads that look at all samples: each has two bytes a tetrahedron, all together at most 32
 * bytes a tetrahedron. */
enum { SAMPLES_A_THREAD = 1 << 11, MOST_PLACES = 16 };

/* What joining two sheets that touch costs, which makes a handle if they belong to one component. Chosen on seven
 * models beside the project, where 64 and 256 agree and 16 makes a handle more on two. */
static const int64_t HANDLE = 64 * BRIO_FLIP_UNIT;

typedef struct {
    uint32_t tet[MOST];
    int size;
    int64_t gain;
} move;

/* What is found at a sample. */
typedef struct {
    move best;
    int64_t helps; /* the least price at which some move has a gain */
} choice;

/* --- which samples to look at --- */

typedef struct {
    int surplus, fans;
} tally;

static tally count(brio_mending *m, uint32_t sample, brio_star_parts *s) {
    if (!brio_find_parts(m->flips, sample, s) || s->count == 0) return (tally){0, 0};
    int surplus = brio_surplus(s), fans = s->count - 1;
    return (tally){surplus < 255 ? surplus : 255, fans < 255 ? fans : 255};
}

static brio_status enqueue(brio_mending *m, uint32_t sample) {
    brio_status status = BRIO_OK;
    if (m->queued[sample]) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(m->flips->ctx, m->queue, m->capacity, m->size + 1));
    m->queue[m->size++] = sample;
    m->queued[sample] = 1;
    m->sleeps[sample] = 0;
done:
    return status;
}

static brio_status look_at(brio_mending *m, uint32_t sample) {
    brio_star_parts s;
    tally now = count(m, sample, &s);
    m->singular += (size_t)(now.surplus > 0) - (size_t)(m->surplus[sample] > 0);
    m->all_fans += now.fans - m->fans[sample];
    m->surplus[sample] = (uint8_t)now.surplus;
    m->fans[sample] = (uint8_t)now.fans;
    return now.surplus > 0 ? enqueue(m, sample) : BRIO_OK;
}

brio_status brio_mending_look(brio_mending *m, size_t from, size_t to) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &m->flips->g->dual->t;
    m->looks++;
    for (size_t i = from; i < to; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t sample = t->tet[m->flips->flipped[i]].vertex[k];
            if (m->looked[sample] != m->looks) BRIO_TRY(look_at(m, sample));
            m->looked[sample] = m->looks;
        }
done:
    return status;
}

typedef struct {
    brio_mending *m;
    uint16_t *place; /* #T for each thread */
} looking;

static void look_part(void *user, size_t begin, size_t end, int thread) {
    const looking *l = user;
    brio_label_flips flips = *l->m->flips;
    brio_mending own = {.flips = &flips};
    brio_star_parts s;
    flips.place = l->place + (size_t)thread * flips.num_tets;
    for (size_t p = begin; p < end; p++) {
        brio_expect_stars(flips.g, p);
        tally now = count(&own, (uint32_t)p, &s);
        l->m->surplus[p] = (uint8_t)now.surplus;
        l->m->fans[p] = (uint8_t)now.fans;
    }
}

/* Looks at all samples, in threads, and queues the singular ones. */
static brio_status look_at_all(brio_mending *m) {
    brio_status status = BRIO_OK;
    const brio_label_flips *f = m->flips;
    looking l = {.m = m};
    int threads = brio_threads(f->ctx, f->num_samples, SAMPLES_A_THREAD);
    if (threads > MOST_PLACES) threads = MOST_PLACES;
    BRIO_TRY(BRIO_ALLOC(f->ctx, l.place, (size_t)threads * f->num_tets));
    memset(l.place, 255, (size_t)threads * f->num_tets * sizeof *l.place);
    BRIO_TRY(brio_for(f->ctx, threads, f->num_samples, look_part, &l));
    for (uint32_t p = 0; p < f->num_samples; p++) {
        m->singular += m->surplus[p] > 0;
        m->all_fans += m->fans[p];
        if (m->surplus[p] > 0) BRIO_TRY(enqueue(m, p));
    }
done:
    brio_release(f->ctx, l.place);
    return status;
}

brio_status brio_mending_new(brio_label_flips *flips, brio_mending *out) {
    brio_status status = BRIO_OK;
    *out = (brio_mending){.flips = flips};
    BRIO_TRY(BRIO_ALLOC_ZERO(flips->ctx, out->surplus, flips->num_samples));
    BRIO_TRY(BRIO_ALLOC_ZERO(flips->ctx, out->fans, flips->num_samples));
    BRIO_TRY(BRIO_ALLOC_ZERO(flips->ctx, out->queued, flips->num_samples));
    BRIO_TRY(BRIO_ALLOC_ZERO(flips->ctx, out->sleeps, flips->num_samples));
    BRIO_TRY(BRIO_ALLOC_ZERO(flips->ctx, out->looked, flips->num_samples));
    BRIO_TRY(look_at_all(out));
done:
    return status;
}

void brio_mending_free(brio_mending *m) {
    brio_release(m->flips->ctx, m->surplus);
    brio_release(m->flips->ctx, m->fans);
    brio_release(m->flips->ctx, m->queued);
    brio_release(m->flips->ctx, m->sleeps);
    brio_release(m->flips->ctx, m->looked);
    brio_release(m->flips->ctx, m->queue);
}

void brio_mending_forget(brio_mending *m) {
    while (m->size > 0) m->queued[m->queue[--m->size]] = 0;
}

/* --- one star --- */

static uint64_t hash_of(const brio_mending *m, const move *x) {
    uint64_t sum = 0;
    for (int i = 0; i < x->size; i++) sum += brio_tet_hash(m->flips->g->dual, x->tet[i]);
    return sum;
}

static bool is_better(const brio_mending *m, const move *a, const move *b) {
    return a->gain != b->gain ? a->gain > b->gain : a->gain > 0 && hash_of(m, a) < hash_of(m, b);
}

/* Keeps a move if it is better than the best one so far. */
static brio_status consider(brio_mending *m, move *x, int64_t price, choice *out) {
    brio_status status = BRIO_OK;
    brio_label_flips *f = m->flips;
    uint32_t sample[4 * MOST];
    brio_star_parts s;
    size_t from = f->size, num_samples;
    int64_t energy = f->energy, faces = f->faces;
    for (int i = 0; i < x->size; i++) BRIO_TRY(brio_flip(f, x->tet[i]));
    num_samples = brio_list_samples(f, from, f->size, sample);
    int fewer = 0;
    int64_t cost = f->energy - energy, twice = faces - f->faces;
    for (size_t i = 0; i < num_samples; i++) {
        tally after = count(m, sample[i], &s);
        fewer += m->surplus[sample[i]] - after.surplus;
        twice += 2 * (after.fans - m->fans[sample[i]]);
    }
    cost -= HANDLE / 4 * twice;
    x->gain = price * fewer - cost;
    if (fewer > 0) {
        int64_t helps = cost < 0 ? 0 : cost / fewer + 1;
        if (helps < out->helps) out->helps = helps;
        if (is_better(m, x, &out->best)) out->best = *x;
    }
done:
    brio_take_back(f, from);
    return status;
}

/* Fills a move with the tetrahedra of a part. Returns false if that is impossible. */
static bool take_part(const brio_mending *m, const brio_star_parts *s, int part, move *x) {
    x->size = 0;
    for (size_t i = 0; i < s->size; i++) {
        if (s->part[i] != part) continue;
        if (brio_star_tet(s->at[i]) >= m->flips->num_finite || x->size == MOST) return false;
        x->tet[x->size++] = brio_star_tet(s->at[i]);
    }
    return true;
}

typedef struct {
    int64_t cost[BRIO_STAR_ROOM];
    int16_t from[BRIO_STAR_ROOM];
    bool done[BRIO_STAR_ROOM];
} paths;

static bool is_less(const brio_mending *m, const brio_star_parts *s, int i, int j) {
    const brio_pole_vectors *v = m->flips->g->dual;
    return brio_tet_hash(v, brio_star_tet(s->at[i])) < brio_tet_hash(v, brio_star_tet(s->at[j]));
}

static int nearest_open(const brio_star_parts *s, const paths *w) {
    int best = -1;
    for (int i = 0; i < (int)s->size; i++)
        if (!w->done[i] && w->cost[i] < INT64_MAX && (best < 0 || w->cost[i] < w->cost[best])) best = i;
    return best;
}

/* Offers the neighbours of tetrahedron i of a star the path through it. Each step costs at least 1: so tetrahedra of
 * one cost offer each other nothing, and their order does not matter. */
static void step_from(brio_mending *m, uint32_t sample, const brio_star_parts *s, uint8_t label, int i, paths *w) {
    const brio_tetrahedron *t = &m->flips->g->dual->t.tet[brio_star_tet(s->at[i])];
    for (int k = 0; k < 4; k++) {
        uint32_t other = t->mate[k] >> 2;
        uint16_t j = m->flips->place[other];
        if (t->vertex[k] == sample || j == BRIO_NOT_IN_STAR || w->done[j]) continue;
        bool there = m->flips->label[other] == label;
        if (!there && other >= m->flips->num_finite) continue;
        int64_t cost = there ? 0 : brio_flip_cost(m->flips, other);
        cost = w->cost[i] + 1 + (cost > 0 ? cost : 0);
        if (cost < w->cost[j] || (cost == w->cost[j] && is_less(m, s, i, w->from[j])))
            w->cost[j] = cost, w->from[j] = (int16_t)i;
    }
}

/* Fills a move with the tetrahedra of a path of low cost from a part to another part of the same label. */
static bool take_path(brio_mending *m, uint32_t sample, const brio_star_parts *s, int part, uint8_t label, move *x) {
    paths w;
    int at, end = -1;
    x->size = 0;
    for (size_t i = 0; i < s->size; i++) {
        w.cost[i] = s->part[i] == part ? 0 : INT64_MAX;
        w.from[i] = -1;
        w.done[i] = false;
        m->flips->place[brio_star_tet(s->at[i])] = (uint16_t)i;
    }
    while ((at = nearest_open(s, &w)) >= 0 && (end < 0 || w.cost[at] == w.cost[end])) {
        w.done[at] = true;
        if (m->flips->label[brio_star_tet(s->at[at])] != label || s->part[at] == part)
            step_from(m, sample, s, label, at, &w);
        else if (end < 0 || is_less(m, s, at, end))
            end = at;
    }
    for (size_t i = 0; i < s->size; i++) m->flips->place[brio_star_tet(s->at[i])] = BRIO_NOT_IN_STAR;
    for (int i = end < 0 ? -1 : w.from[end]; i >= 0; i = w.from[i])
        if (m->flips->label[brio_star_tet(s->at[i])] != label) {
            if (x->size == MOST) return false;
            x->tet[x->size++] = brio_star_tet(s->at[i]);
        }
    return x->size > 0;
}

/* Returns whether flipping one tetrahedron may leave fewer parts at one of its samples: a part of the tetrahedron's
 * label that is nothing else at the sample vanishes, or two facets to the other label join parts. Either way at most
 * one of the three facets at the sample leads to a tetrahedron of the same label. */
static bool may_join(const brio_mending *m, uint32_t tet) {
    const brio_label_flips *f = m->flips;
    int alike = 0;
    for (int i = 0; i < 4; i++) alike += f->label[brio_tet_of(f->g->dual->t.tet[tet].mate[i])] == f->label[tet];
    return alike <= 2;
}

static brio_status consider_all(brio_mending *m, uint32_t sample, const brio_star_parts *s, int64_t price,
                                choice *out) {
    brio_status status = BRIO_OK;
    move x;
    for (int part = 0; part < s->count; part++) {
        size_t i = 0;
        while (s->part[i] != part) i++;
        uint8_t label = m->flips->label[brio_star_tet(s->at[i])];
        if (s->of[label == BRIO_LABEL_INNER] < 2) continue;
        if (take_part(m, s, part, &x)) BRIO_TRY(consider(m, &x, price, out));
        if (take_path(m, sample, s, part, label, &x)) BRIO_TRY(consider(m, &x, price, out));
    }
    for (size_t i = 0; i < s->size && s->size <= SMALL; i++) {
        x.size = 1;
        x.tet[0] = brio_star_tet(s->at[i]);
        if (x.tet[0] < m->flips->num_finite && may_join(m, x.tet[0])) BRIO_TRY(consider(m, &x, price, out));
    }
done:
    return status;
}

/* Returns the first price that is not less than the one that helps. */
static uint8_t first_price(int64_t helps) {
    uint8_t i = 0;
    while (i < PRICES && FIRST_PRICE << i < helps) i++;
    return i;
}

/* Wakes the samples whose moves depend on the labels of flips [from, size): those in the stars of their samples. */
static void wake(const brio_mending *m, size_t from) {
    const brio_vote_graph *g = m->flips->g;
    const brio_tetrahedron *t = g->dual->t.tet;
    uint32_t sample[4 * MOST];
    size_t count = brio_list_samples(m->flips, from, m->flips->size, sample);
    for (size_t n = 0; n < count; n++)
        for (size_t i = g->first[sample[n]]; i < g->first[sample[n] + 1]; i++)
            for (int k = 0; k < 4; k++) {
                uint32_t p = t[brio_star_tet(g->star[i])].vertex[k];
                if (p != g->dual->t.infinite) m->sleeps[p] = 0;
            }
}

/* Makes the best move at a sample, again and again. */
static brio_status mend_star(brio_mending *m, uint32_t sample, int price) {
    brio_status status = BRIO_OK;
    brio_star_parts s;
    while (count(m, sample, &s).surplus > 0) {
        choice x = {.helps = INT64_MAX};
        BRIO_TRY(consider_all(m, sample, &s, FIRST_PRICE << price, &x));
        assert(x.best.gain <= 0 || m->sleeps[sample] <= price);
        m->sleeps[sample] = first_price(x.helps);
        if (x.best.gain <= 0) break;
        size_t from = m->flips->size;
        for (int i = 0; i < x.best.size; i++) BRIO_TRY(brio_flip(m->flips, x.best.tet[i]));
        BRIO_TRY(brio_mending_look(m, from, m->flips->size));
        wake(m, from);
    }
done:
    return status;
}

/* Lets the queued samples have their turn, and those that are queued meanwhile, at one price. Those that stay singular
 * are in the queue at the end. The turns of those that sleep are left out, except in checked builds. */
static brio_status mend_at(brio_mending *m, int price) {
    brio_status status = BRIO_OK;
    const brio_label_flips *f = m->flips;
    size_t left = 0;
    for (size_t begin = 0, end; begin < m->size; begin = end) {
        end = m->size;
        BRIO_TRY(
            brio_sort_many_indices(f->ctx, m->queue + begin, end - begin, brio_compare_hashes, f->g->dual->points));
        for (size_t i = begin; i < end; i++) {
            uint32_t p = m->queue[i];
            m->queued[p] = 0;
            if (BRIO_CHECKED_TURNS || m->sleeps[p] <= price) BRIO_TRY(mend_star(m, p, price));
        }
    }
    for (size_t i = 0; i < m->size; i++) {
        uint32_t p = m->queue[i];
        if (m->surplus[p] == 0 || m->queued[p]) continue;
        m->queued[p] = 1;
        m->queue[left++] = p;
    }
    m->size = left;
done:
    return status;
}

brio_status brio_mend(brio_mending *m) {
    brio_status status = BRIO_OK;
    for (size_t i = 0; i < m->size; i++) m->sleeps[m->queue[i]] = 0;
    for (int price = 0; price < PRICES && m->size > 0; price++) BRIO_TRY(mend_at(m, price));
done:
    return status;
}
