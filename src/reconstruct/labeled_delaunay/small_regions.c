/* Small regions of labels, found by walks across facets. A walk begins at each tetrahedron that no walk has reached, and
 * stops at facets between two labels, which it counts. */
#include "reconstruct/labeled_delaunay/small_regions.h"
#include "base/memory.h"
#include "reconstruct/labels/label.h"

typedef struct {
    const brio_tetrahedra *t;
    uint8_t *label, *reached;
    uint32_t *tet; /* of the region at hand; what is not walked from yet is at the end */
    size_t size, boundary;
    bool infinite;
} walk;

static void reach(walk *w, uint32_t tet) {
    w->reached[tet] = 1;
    w->tet[w->size++] = tet;
    w->infinite |= brio_is_infinite(w->t, tet);
}

static void walk_from(walk *w, uint32_t start) {
    w->size = w->boundary = 0;
    w->infinite = false;
    reach(w, start);
    for (size_t n = 0; n < w->size; n++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = brio_tet_of(w->t->tet[w->tet[n]].mate[i]);
            if (w->label[other] != w->label[start])
                w->boundary++;
            else if (!w->reached[other])
                reach(w, other);
        }
}

brio_status brio_drop_small_regions(brio_context *ctx, const brio_tetrahedra *t, size_t least, uint8_t *label,
                                    size_t *changed) {
    brio_status status = BRIO_OK;
    walk w = {.t = t, .label = label};
    uint8_t *flip = NULL;
    *changed = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, w.reached, t->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, flip, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, w.tet, t->count));
    for (uint32_t tet = 0; tet < t->count; tet++) {
        if (w.reached[tet]) continue;
        walk_from(&w, tet);
        bool small = w.boundary < least && !w.infinite;
        *changed += small;
        for (size_t n = 0; n < w.size && small; n++) flip[w.tet[n]] = 1;
    }
    for (size_t tet = 0; tet < t->count; tet++)
        if (flip[tet]) label[tet] = brio_other_label(label[tet]);
done:
    brio_release(ctx, w.reached);
    brio_release(ctx, w.tet);
    brio_release(ctx, flip);
    return status;
}

size_t brio_count_boundary(const brio_tetrahedra *t, const uint8_t *label) {
    size_t count = 0;
    for (size_t tet = 0; tet < t->count; tet++)
        for (int i = 0; i < 4; i++) count += label[tet] < label[brio_tet_of(t->tet[tet].mate[i])];
    return count;
}
