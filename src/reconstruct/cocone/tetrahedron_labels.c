/* Labels of Delaunay tetrahedra: inside or outside the surface that the co-cones suggest.
 *
 * A sample votes on the tetrahedra whose Voronoi vertices lie in its two cones: those in one cone are outside, those in
 * the other are inside. The majority of its samples labels a tetrahedron. A tetrahedron without a majority, such as a
 * flat one within the surface, takes the label that reaches it first across facets that are no candidates. Tetrahedra
 * that candidates enclose on all sides are pockets between two layers of candidates, and inner. So on a dense sample
 * the boundary between the labels is the outer boundary of the candidates, which the paper finds by a depth-first walk.
 * A missing triangle far away does not matter here; to the walk it would.
 *
 * Based on: Dey, Goswami. Tight cocone: a water-tight surface reconstructor. JCISE 2003, for labels of tetrahedra from
 *           the two sides of each sample.
 * Differs from the paper: a majority of cones decides, instead of an umbrella of triangles, which some samples do not
 *                         have. */
#include "reconstruct/cocone/tetrahedron_labels.h"
#include "base/memory.h"
#include "base/team.h"

/* Returns the number of bits that are set in a number below 16, from a table of digits. */
static inline int count_bits(unsigned bits) {
    return (int)(0x4332322132212110u >> 4 * bits & 7);
}

/* Returns the vote of the samples in the first `count` slots: 1 for each sample that sees the centre in its cone to the
 * pole, -1 for each that sees it in the opposite cone. A sample whose axis is turned votes the other way. */
static inline int vote_of(const brio_pole_vectors *v, const uint8_t *turned, size_t tet, int count) {
    const uint32_t *vertex = v->t.tet[tet].vertex;
    unsigned outer = brio_pole_slots(v->sides[tet]), inner = brio_antipole_slots(v->sides[tet]), turn = 0;
    for (int i = 0; i < count; i++) turn |= (unsigned)turned[vertex[i]] << i;
    unsigned change = (outer ^ inner) & turn;
    return count_bits(outer ^ change) - count_bits(inner ^ change);
}

int brio_tet_vote(const brio_tet_labels *labels, size_t tet) {
    const brio_pole_vectors *v = labels->dual;
    return vote_of(v, labels->turned, tet, tet < v->num_finite ? 4 : 3);
}

static inline uint8_t label_of(int vote) {
    return vote > 0 ? BRIO_LABEL_OUTER : vote < 0 ? BRIO_LABEL_INNER : BRIO_LABEL_NONE;
}

/* Labels tetrahedra from to to - 1. Returns the number of tetrahedra without a majority. */
static size_t label_by_votes(const brio_tet_labels *labels, size_t from, size_t to) {
    const brio_pole_vectors v = *labels->dual;
    uint8_t *label = labels->label;
    const uint8_t *turned = labels->turned;
    size_t undecided = 0;
    for (size_t tet = from; tet < to && tet < v.num_finite; tet++) {
        int vote = vote_of(&v, turned, tet, 4);
        label[tet] = label_of(vote);
        undecided += vote == 0;
    }
    for (size_t tet = from < v.num_finite ? v.num_finite : from; tet < to; tet++) {
        int vote = labels->watertight ? 1 : vote_of(&v, turned, tet, 3);
        label[tet] = label_of(vote);
        undecided += vote == 0;
    }
    return undecided;
}

/* Chosen. */
enum { TETS_A_THREAD = 1 << 12 };

typedef struct {
    brio_tet_labels *labels;
    size_t undecided;
} voting;

static void vote_in_part(void *user, size_t begin, size_t end, int thread) {
    voting *v = user;
    (void)thread;
    __atomic_fetch_add(&v->undecided, label_by_votes(v->labels, begin, end), __ATOMIC_RELAXED);
}

/* Labels all tetrahedra. Writes the number of tetrahedra without a majority. */
static brio_status label_all_by_votes(brio_context *ctx, brio_tet_labels *labels, size_t *undecided) {
    voting v = {labels, 0};
    size_t size = labels->dual->t.count;
    brio_status status = brio_for(ctx, brio_threads(ctx, size, TETS_A_THREAD), size, vote_in_part, &v);
    *undecided = v.undecided;
    return status;
}

brio_status brio_tet_labels_vote(brio_context *ctx, brio_tet_labels *labels) {
    brio_status status = BRIO_OK;
    size_t count = labels->dual->t.count, undecided;
    BRIO_TRY(BRIO_ALLOC(ctx, labels->label, count));
    BRIO_TRY(label_all_by_votes(ctx, labels, &undecided));
    BRIO_TRY(BRIO_ALLOC(ctx, labels->undecided, undecided));
    for (size_t tet = 0; tet < count; tet++)
        if (labels->label[tet] == BRIO_LABEL_NONE) labels->undecided[labels->num_undecided++] = (uint32_t)tet;
done:
    return status;
}

/* Workspace of the spreading: the tetrahedra reached so far, and the new labels of those that the last wave reached. */
typedef struct {
    uint32_t *reached;
    uint8_t *news;
    size_t size, capacity, news_capacity;
} wave;

static const uint8_t REACHED = 0xff; /* the tetrahedron is reached, and its label comes with this wave */

/* Appends to w->reached the neighbours of a tetrahedron without a label, across facets that are no candidates. */
static brio_status reach_from(brio_context *ctx, brio_tet_labels *labels, size_t tet, wave *w) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &labels->dual->t;
    BRIO_TRY(BRIO_RESERVE(ctx, w->reached, w->capacity, w->size + 4));
    for (int i = 0; i < 4; i++) {
        uint32_t facet = brio_facet_of((uint32_t)tet, i), other = brio_tet_of(*brio_mate(t, facet));
        if (labels->label[other] != BRIO_LABEL_NONE || brio_is_candidate(labels->cocones, facet)) continue;
        labels->label[other] = REACHED;
        w->reached[w->size++] = other;
    }
done:
    return status;
}

/* Returns the label of most neighbours of a tetrahedron before this wave, outer at a tie. Neighbours across candidates
 * do not count. */
static uint8_t label_of_neighbours(const brio_tet_labels *labels, uint32_t tet) {
    const brio_tetrahedra *t = &labels->dual->t;
    int inner = 0;
    for (int i = 0; i < 4; i++) {
        uint8_t label = labels->label[brio_tet_of(t->tet[tet].mate[i])];
        if (label == REACHED || label == BRIO_LABEL_NONE || brio_is_candidate(labels->cocones, brio_facet_of(tet, i)))
            continue;
        inner += label == BRIO_LABEL_INNER ? 1 : -1;
    }
    return inner > 0 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
}

/* Returns whether a tetrahedron has a neighbour with a label across a facet that is no candidate. */
static bool is_next_to_label(const brio_tet_labels *labels, uint32_t tet) {
    for (int i = 0; i < 4; i++) {
        uint8_t label = labels->label[brio_tet_of(labels->dual->t.tet[tet].mate[i])];
        if ((label == BRIO_LABEL_INNER || label == BRIO_LABEL_OUTER) &&
            !brio_is_candidate(labels->cocones, brio_facet_of(tet, i)))
            return true;
    }
    return false;
}

/* Spreads labels in waves. Labels of one wave do not depend on each other, so the result does not depend on the order
 * of the tetrahedra. */
brio_status brio_tet_labels_spread(brio_context *ctx, brio_tet_labels *labels) {
    brio_status status = BRIO_OK;
    wave w = {0};
    BRIO_TRY(BRIO_RESERVE(ctx, w.reached, w.capacity, labels->num_undecided));
    for (size_t n = 0; n < labels->num_undecided; n++)
        if (is_next_to_label(labels, labels->undecided[n])) w.reached[w.size++] = labels->undecided[n];
    for (size_t n = 0; n < w.size; n++) labels->label[w.reached[n]] = REACHED;
    for (size_t begin = 0, end; begin < w.size; begin = end) {
        end = w.size;
        BRIO_TRY(BRIO_RESERVE(ctx, w.news, w.news_capacity, end - begin));
        for (size_t n = begin; n < end; n++) w.news[n - begin] = label_of_neighbours(labels, w.reached[n]);
        for (size_t n = begin; n < end; n++) labels->label[w.reached[n]] = w.news[n - begin];
        for (size_t n = begin; n < end; n++) BRIO_TRY(reach_from(ctx, labels, w.reached[n], &w));
    }
    for (size_t n = 0; n < labels->num_undecided; n++)
        if (labels->label[labels->undecided[n]] == BRIO_LABEL_NONE)
            labels->label[labels->undecided[n]] = BRIO_LABEL_INNER;
done:
    brio_release(ctx, w.reached);
    brio_release(ctx, w.news);
    return status;
}

void brio_tet_labels_free(brio_context *ctx, brio_tet_labels *labels) {
    brio_release(ctx, labels->label);
    brio_release(ctx, labels->undecided);
    *labels = (brio_tet_labels){0};
}
