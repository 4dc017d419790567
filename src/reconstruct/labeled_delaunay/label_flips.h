/* Labels of tetrahedra that change one at a time, with the energy that each change costs. */
#ifndef BRIO_RECONSTRUCT_LABEL_FLIPS_H
#define BRIO_RECONSTRUCT_LABEL_FLIPS_H

#include "reconstruct/labeled_delaunay/vote_graph.h"

/** A log-odds of 1, in the unit of brio_label_flips.energy. Whole numbers, so that a flip that is taken back leaves no
 *  trace, and sums do not depend on their order. */
#define BRIO_FLIP_UNIT ((int64_t)1 << 16)

static const brio_vote_unit BRIO_FLIP_VOTES = {BRIO_VOTE_UNIT, (double)BRIO_FLIP_UNIT};

/** Returns a weight in that unit. */
static inline int64_t brio_vote_of(float weight) {
    return brio_in_vote_units(BRIO_FLIP_VOTES, weight);
}

/** In brio_label_flips.place: the tetrahedron is not in the star at hand. */
#define BRIO_NOT_IN_STAR UINT16_MAX

/** Every sample always has the label that most of its votes want, so the energy is a function of the tetrahedra. */
typedef struct {
    brio_context *ctx;
    const brio_vote_graph *g;
    size_t num_tets, num_finite, num_samples;
    uint8_t *label;    /* #nodes of the graph: the caller's */
    int64_t *outer;    /* #P: the sum of the weights of a sample's votes for outer, less those for inner */
    int64_t energy;    /* of all flips since the start */
    int64_t faces;     /* facets between two labels, more than at the start */
    uint32_t *flipped; /* the tetrahedra that were flipped, in order */
    size_t size, capacity;
    uint16_t *place; /* #T: of each tetrahedron in the star at hand, BRIO_NOT_IN_STAR between calls */
} brio_label_flips;

/** The parts of a star that are connected across facets. */
enum { BRIO_STAR_ROOM = 512 };
typedef struct {
    size_t size;        /* of the star */
    const uint32_t *at; /* its entries in the graph of votes: tetrahedron brio_star_tet(at[i]) */
    int count;          /* of parts */
    int of[2];          /* outer ones, inner ones */
    int16_t part[BRIO_STAR_ROOM];
} brio_star_parts;

/** Begins with labels, and sums the votes on each sample.
 *  label  kept, read and written: of tetrahedra and samples.   out  freed with brio_label_flips_free, on failure
 *  too. */
brio_status brio_label_flips_new(const brio_vote_graph *g, uint8_t *label, brio_label_flips *out);
void brio_label_flips_free(brio_label_flips *f);

/** Gives a finite tetrahedron the other label. Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_flip(brio_label_flips *f, uint32_t tet);
/** Takes all flips back but the first `size` ones. */
void brio_take_back(brio_label_flips *f, size_t size);
/** Returns the energy that flipping one tetrahedron costs. */
int64_t brio_flip_cost(const brio_label_flips *f, uint32_t tet);
/** Writes the samples' labels. */
void brio_label_samples(const brio_label_flips *f);

/** Lists the samples of the tetrahedra flipped[from .. to), each once.   sample  room for four a tetrahedron. Returns
 *  their number. Cost: quadratic. */
size_t brio_list_samples(const brio_label_flips *f, size_t from, size_t to, uint32_t *sample);

/** Finds the parts of the star of a sample. Writes f->place only: threads have copies of f that differ there. Returns
 *  false for a star of more than BRIO_STAR_ROOM tetrahedra. */
bool brio_find_parts(brio_label_flips *f, uint32_t sample, brio_star_parts *out);

/** Returns by how many the parts of a star are more than one outer and one inner part. */
static inline int brio_surplus(const brio_star_parts *s) {
    return (s->of[0] > 1 ? s->of[0] - 1 : 0) + (s->of[1] > 1 ? s->of[1] - 1 : 0);
}

#endif
