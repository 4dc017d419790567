/* Pruning and the walk of the dissertation, without the labels of the tetrahedra.
 *
 * Candidates at sharp edges are removed recursively, whatever the votes of the samples say. What is left falls into
 * components, joined across edges. The walk on a component begins on the outside, at the component's last sample in
 * lexicographic order, from which nothing of the component lies in the direction of x. From each triangle it goes,
 * across each edge, to the next candidate round the edge on the outside.
 *
 * On a dense sample of a smooth surface this is the surface (theorem 19). Elsewhere one hole lets the pruning unravel a
 * component, and the walk can come round to the other side of triangles; the faces are then no manifold.
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.2 and appendix A. */
#include "laboratory/laboratory.h"
#include "base/memory.h"
#include "base/sort.h"
#include "reconstruct/cocone/cocone_prune.h"
#include "reconstruct/cocone/label_boundary.h"

typedef struct {
    brio_context *ctx;
    const brio_cocones *cocones;
    const brio_tetrahedra *t;
    const double *points;
    uint8_t *listed;  /* #T: bit i is 1 if facet i is in a component that was walked on */
    uint8_t *current; /* #T: bit i is 1 if facet i is in the component at hand */
    uint8_t *walked;  /* #T: bit i is 1 if the walk met facet i from this side */
    uint32_t *list;   /* facets of the component at hand */
    size_t size, capacity;
    uint32_t *stack; /* facets that the walk has yet to leave; before, tetrahedra of a star */
    size_t height, stack_capacity;
} walk;

static bool has_bit(const uint8_t *bits, uint32_t facet) {
    return bits[brio_tet_of(facet)] >> brio_slot_of(facet) & 1;
}

static void set_bit(uint8_t *bits, uint32_t facet) {
    bits[brio_tet_of(facet)] |= (uint8_t)(1 << brio_slot_of(facet));
}

/* Returns corner k of a facet, counterclockwise as seen from the facet's tetrahedron. */
static uint32_t corner_of(const walk *w, uint32_t facet, int k) {
    return w->t->tet[brio_tet_of(facet)].vertex[BRIO_FACET[brio_slot_of(facet)][k % 3]];
}

static brio_status push(walk *w, uint32_t entry) {
    brio_status status = BRIO_RESERVE(w->ctx, w->stack, w->stack_capacity, w->height + 1);
    if (status == BRIO_OK) w->stack[w->height++] = entry;
    return status;
}

/* Returns the next candidate round edge ab on the side of the facet's tetrahedron, as seen from this side. */
static uint32_t next_candidate(const walk *w, uint32_t facet, uint32_t a, uint32_t b) {
    for (;;) {
        uint32_t tet = brio_tet_of(facet);
        facet = brio_facet_of(tet, brio_last_slot(w->t->tet[tet].vertex, a, b, brio_slot_of(facet)));
        if (brio_is_candidate(w->cocones, facet)) return facet;
        facet = *brio_mate(w->t, facet);
    }
}

/* --- components --- */

/* Adds a facet to the component at hand. */
static brio_status add(walk *w, uint32_t facet) {
    uint32_t mate = *brio_mate(w->t, facet);
    if (has_bit(w->listed, facet)) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, w->list, w->capacity, w->size + 1));
    w->list[w->size++] = facet;
    set_bit(w->listed, facet), set_bit(w->listed, mate);
    set_bit(w->current, facet), set_bit(w->current, mate);
    return BRIO_OK;
}

/* Lists the candidates that are joined to a facet across edges. */
static brio_status list_component(walk *w, uint32_t first) {
    w->size = 0;
    BRIO_FORWARD(add(w, first));
    for (size_t n = 0; n < w->size; n++)
        for (int k = 0; k < 3; k++) {
            uint32_t a = corner_of(w, w->list[n], k), b = corner_of(w, w->list[n], k + 1), facet = w->list[n];
            do {
                facet = *brio_mate(w->t, next_candidate(w, facet, a, b));
                BRIO_FORWARD(add(w, facet));
            } while (facet != w->list[n]);
        }
    return BRIO_OK;
}

static void forget_component(const walk *w) {
    for (size_t n = 0; n < w->size; n++)
        w->current[brio_tet_of(w->list[n])] = w->current[brio_tet_of(*brio_mate(w->t, w->list[n]))] = 0;
}

/* --- where the walk begins --- */

/* Finds the last sample of the component in lexicographic order, and a tetrahedron of it. */
static uint32_t last_sample(const walk *w, uint32_t *tet) {
    uint32_t last = corner_of(w, w->list[0], 0);
    *tet = brio_tet_of(w->list[0]);
    for (size_t n = 0; n < w->size; n++)
        for (int k = 0; k < 3; k++) {
            uint32_t p = corner_of(w, w->list[n], k);
            if (brio_lexicographic(w->points + 3 * (size_t)p, w->points + 3 * (size_t)last) <= 0) continue;
            last = p;
            *tet = brio_tet_of(w->list[n]);
        }
    return last;
}

/* Returns whether a tetrahedron of p has points beyond p in the direction of x. Coordinates are at most 1. */
static bool faces_x(const walk *w, uint32_t tet, uint32_t p) {
    const uint32_t *v = w->t->tet[tet].vertex;
    const double *at = w->points + 3 * (size_t)p, far[3] = {at[0] + 4, at[1], at[2]};
    for (int i = 0; i < 4; i++) {
        const double *corner[4];
        if (v[i] == p || (v[3] == BRIO_INFINITE && i < 3)) continue;
        for (int k = 0; k < 4; k++) corner[k] = k == i ? far : w->points + 3 * (size_t)v[k];
        if (brio_orient3d(corner[0], corner[1], corner[2], corner[3]) < 0) return false;
    }
    return true;
}

/* Lists on the stack the tetrahedra of p that are joined to `tet` across facets at p which, with `bounded`, are not of
 * the component. Stops at a facet of the component with `bounded`, or at a tetrahedron that faces x without. Returns
 * the facet, or the tetrahedron. */
static brio_status search_star(walk *w, uint32_t tet, uint32_t p, bool bounded, uint32_t *found) {
    w->height = 0;
    BRIO_FORWARD(push(w, tet));
    for (size_t n = 0; n < w->height; n++) {
        uint32_t now = w->stack[n];
        *found = now;
        if (!bounded && faces_x(w, now, p)) return BRIO_OK;
        for (int i = 0; i < 4; i++) {
            uint32_t facet = brio_facet_of(now, i), other = brio_tet_of(*brio_mate(w->t, facet));
            bool known = w->t->tet[now].vertex[i] == p;
            *found = facet;
            if (!known && bounded && has_bit(w->current, facet)) return BRIO_OK;
            for (size_t m = 0; m < w->height && !known; m++) known = w->stack[m] == other;
            if (!known) BRIO_FORWARD(push(w, other));
        }
    }
    return BRIO_OK;
}

/* --- the walk --- */

static brio_status walk_on(walk *w, uint32_t start) {
    w->height = 0;
    set_bit(w->walked, start);
    BRIO_FORWARD(push(w, start));
    while (w->height > 0) {
        uint32_t facet = w->stack[--w->height];
        for (int k = 0; k < 3; k++) {
            uint32_t next = next_candidate(w, facet, corner_of(w, facet, k), corner_of(w, facet, k + 1));
            if (has_bit(w->walked, next)) continue;
            set_bit(w->walked, next);
            BRIO_FORWARD(push(w, next));
        }
    }
    return BRIO_OK;
}

static brio_status walk_on_all(walk *w) {
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, w->listed, w->t->count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, w->current, w->t->count));
    for (uint32_t tet = 0; tet < w->t->count; tet++)
        for (int i = 0; i < 4; i++) {
            uint32_t facet = brio_facet_of(tet, i), p, found;
            if (!brio_is_candidate(w->cocones, facet) || has_bit(w->listed, facet)) continue;
            BRIO_FORWARD(list_component(w, facet));
            p = last_sample(w, &found);
            BRIO_FORWARD(search_star(w, found, p, false, &found));
            BRIO_FORWARD(search_star(w, found, p, true, &found));
            BRIO_FORWARD(walk_on(w, found));
            forget_component(w);
        }
    return BRIO_OK;
}

/* --- faces --- */

/* Lists the candidates, each once: of those that were walked on, the side that the walk met; of others either side. */
static brio_status write_faces(walk *w, bool walked, uint32_t **faces, size_t *num_faces) {
    size_t capacity = 0, size = 0;
    for (uint32_t facet = 0; facet < 4 * (size_t)w->t->count; facet++) {
        uint32_t mate = *brio_mate(w->t, facet);
        bool twice = !walked || has_bit(w->walked, mate);
        if (walked ? !has_bit(w->walked, facet) : !brio_is_candidate(w->cocones, facet)) continue;
        if (twice && mate < facet) continue;
        BRIO_FORWARD(BRIO_RESERVE(w->ctx, *faces, capacity, size + 3));
        for (int k = 0; k < 3; k++) (*faces)[size++] = corner_of(w, facet, k);
    }
    *num_faces = size / 3;
    return BRIO_OK;
}

static brio_status prune(brio_context *ctx, const brio_cocones *cocones, size_t *pruned) {
    brio_tet_labels labels = {.cocones = cocones, .dual = cocones->dual};
    brio_status status = BRIO_ALLOC_ZERO(ctx, labels.label, cocones->dual->t.count); /* nobody has voted */
    if (status == BRIO_OK) status = brio_cocone_prune(ctx, &labels, pruned);
    brio_tet_labels_free(ctx, &labels);
    return status;
}

brio_status brio_extract_literally(void *user, brio_context *ctx, const brio_cocones *cocones, size_t *pruned,
                                   uint32_t **faces, size_t *num_faces) {
    brio_status status = BRIO_OK;
    const brio_extraction extraction = ((const brio_laboratory *)user)->options.extraction;
    walk w = {.ctx = ctx, .cocones = cocones, .t = &cocones->dual->t, .points = cocones->dual->points};
    *pruned = 0;
    if (extraction != BRIO_EXTRACTION_CANDIDATES) BRIO_TRY(prune(ctx, cocones, pruned));
    if (extraction == BRIO_EXTRACTION_WALK) {
        BRIO_TRY(BRIO_ALLOC_ZERO(ctx, w.walked, w.t->count));
        BRIO_TRY(walk_on_all(&w));
    }
    BRIO_TRY(write_faces(&w, extraction == BRIO_EXTRACTION_WALK, faces, num_faces));
done:
    brio_release(ctx, w.listed);
    brio_release(ctx, w.current);
    brio_release(ctx, w.walked);
    brio_release(ctx, w.list);
    brio_release(ctx, w.stack);
    return status;
}
