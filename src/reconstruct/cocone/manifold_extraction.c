/* A surface from the boundary between outer and inner tetrahedra.
 *
 * The faces are the candidates in the boundary, and the facets that fill small gaps between these (surface_gaps.c).
 * After brio_make_manifold the boundary is a closed manifold. A part of a closed manifold is a manifold with boundary,
 * except at samples where the part has several fans. There all fans except the largest are removed. A removal can
 * shorten or divide fans at other samples, so these samples are tested again, until nothing changes.
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000, whose
 *           outer boundary this is on a dense sample.
 * Differs from the paper: there is no walk. The labels of the tetrahedra say what is outside, so that one hole does not
 *                         turn the whole surface inside out. */
#include "reconstruct/cocone/manifold_extraction.h"
#include "base/memory.h"
#include "reconstruct/cocone/surface_gaps.h"

typedef struct {
    brio_context *ctx;
    brio_face_choice choice;
    uint32_t *facet_of; /* #P: a boundary facet at each sample in the queue, seen from outside */
    uint32_t *queue;    /* samples to test */
    size_t size, capacity;
} extraction;

static void choose_candidates(const brio_face_choice *c) {
    for (size_t n = 0; n < c->num_facets; n++)
        if (brio_is_candidate(c->cocones, c->facets[n])) brio_set_face(c, c->facets[n]);
}

/* Queues the samples of a boundary facet. */
static brio_status push_corners(extraction *x, uint32_t facet) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(x->ctx, x->queue, x->capacity, x->size + 3));
    for (int k = 0; k < 3; k++) {
        uint32_t p = brio_corner_of(&x->choice, facet, k);
        if (p == BRIO_INFINITE) continue;
        x->facet_of[p] = facet;
        x->queue[x->size++] = p;
    }
done:
    return status;
}

/* --- one fan a sample --- */

/* A fan of faces: its first face, counterclockwise, and its number of faces. */
typedef struct {
    uint32_t first;
    size_t length;
} fan;

/* Returns whether to keep fan a rather than b: the longer one. Among equal lengths, the positions where they begin
 * decide. */
static bool is_better(const extraction *x, uint32_t v, fan a, fan b) {
    const double *points = x->choice.dual->points;
    if (a.length != b.length) return a.length > b.length;
    return brio_lexicographic(points + 3 * (size_t)brio_corner_after(&x->choice.dual->t, a.first, v),
                              points + 3 * (size_t)brio_corner_after(&x->choice.dual->t, b.first, v)) > 0;
}

/* Counts the fans of faces at v that have two ends, and finds the best of them. Returns 0 for a closed fan. */
static size_t count_fans(const extraction *x, uint32_t v, fan *best) {
    uint32_t start = x->facet_of[v];
    size_t fans = 0;
    while (brio_is_face(&x->choice, start)) { /* goes to a gap, so that no fan is met in two parts */
        start = brio_next_round_vertex(x->choice.labels, start, v);
        if (start == x->facet_of[v]) return 0;
    }
    fan now = {0};
    uint32_t facet = start;
    do {
        facet = brio_next_round_vertex(x->choice.labels, facet, v);
        if (brio_is_face(&x->choice, facet)) {
            if (now.length++ == 0) now.first = facet;
        } else if (now.length > 0) {
            if (fans++ == 0 || is_better(x, v, now, *best)) *best = now;
            now.length = 0;
        }
    } while (facet != start);
    return fans;
}

/* Removes the faces at v outside one fan. */
static brio_status keep_fan(extraction *x, uint32_t v, fan kept) {
    brio_status status = BRIO_OK;
    uint32_t facet = kept.first;
    for (size_t n = 0; n == 0 || facet != kept.first; n++) {
        if (n >= kept.length && brio_is_face(&x->choice, facet)) {
            brio_clear_face(&x->choice, facet);
            BRIO_TRY(push_corners(x, facet));
        }
        facet = brio_next_round_vertex(x->choice.labels, facet, v);
    }
done:
    return status;
}

/* Removes all fans except the best at each sample. Works in rounds, each in the order of positions, so that the result
 * does not depend on the numbers of the samples. */
static brio_status drop_small_fans(extraction *x) {
    brio_status status = BRIO_OK;
    fan best = {0};
    for (size_t begin = 0, end; begin < x->size; begin = end) {
        end = x->size;
        brio_sort_by_position(x->choice.dual->points, x->queue + begin, end - begin);
        for (size_t n = begin; n < end; n++) {
            uint32_t v = x->queue[n];
            if (count_fans(x, v, &best) > 1) BRIO_TRY(keep_fan(x, v, best));
        }
    }
done:
    return status;
}

static brio_status write_faces(const extraction *x, uint32_t **faces, size_t *num_faces) {
    brio_status status = BRIO_OK;
    const brio_face_choice *c = &x->choice;
    size_t count = 0;
    for (size_t n = 0; n < c->num_facets; n++) count += brio_is_face(c, c->facets[n]);
    BRIO_TRY(BRIO_ALLOC(x->ctx, *faces, 3 * count));
    *num_faces = count;
    count = 0;
    for (size_t n = 0; n < c->num_facets; n++)
        for (int k = 0; k < 3 && brio_is_face(c, c->facets[n]); k++)
            (*faces)[count++] = brio_corner_of(c, c->facets[n], k);
done:
    return status;
}

brio_status brio_extract_faces(brio_context *ctx, const brio_tet_labels *labels, bool candidates_only,
                               const brio_facets *facets, uint32_t **faces, size_t *num_faces) {
    brio_status status = BRIO_OK;
    extraction x = {.ctx = ctx,
                    .choice = {.labels = labels,
                               .cocones = labels->cocones,
                               .dual = labels->dual,
                               .facets = facets->facet,
                               .num_facets = facets->count}};
    uint32_t *open = NULL;
    size_t num_open;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, x.choice.face, labels->dual->t.count));
    BRIO_TRY(BRIO_ALLOC(ctx, x.facet_of, labels->dual->num_points));
    choose_candidates(&x.choice);
    BRIO_TRY(brio_fill_gaps(ctx, &x.choice, !candidates_only, &open, &num_open));
    for (size_t n = 0; n < num_open; n++) BRIO_TRY(push_corners(&x, open[n]));
    BRIO_TRY(drop_small_fans(&x));
    BRIO_TRY(write_faces(&x, faces, num_faces));
done:
    brio_release(ctx, x.choice.face);
    brio_release(ctx, x.facet_of);
    brio_release(ctx, x.queue);
    brio_release(ctx, open);
    return status;
}
