/* The boundary between two labels of tetrahedra, as a list of facets. Each thread lists parts of the tetrahedra, and
 * the parts are joined in order. */
#include "reconstruct/cocone/label_boundary.h"
#include "base/memory.h"
#include "base/team.h"
#include <string.h>

/* Both chosen. */
enum { PARTS = 64, TETS_A_THREAD = 1 << 13 };

typedef struct {
    uint32_t *facets;
    size_t count, capacity;
} part;

/* Lists the boundary facets of the outer ones among tetrahedra from to to - 1. */
static brio_status list_part(brio_context *ctx, const brio_tet_labels *labels, size_t from, size_t to, part *p) {
    brio_status status = BRIO_OK;
    const brio_tetrahedron *t = labels->dual->t.tet;
    const uint8_t *label = labels->label;
    for (size_t tet = from; tet < to; tet++) {
        brio_along(ctx, tet, to, BRIO_READS(t));
        if (label[tet] != BRIO_LABEL_OUTER) continue;
        unsigned inner = 0; /* bit i: the neighbour behind facet i is inner */
        for (int i = 0; i < 4; i++) inner |= (unsigned)(label[brio_tet_of(t[tet].mate[i])] != BRIO_LABEL_OUTER) << i;
        if (inner == 0) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, p->facets, p->capacity, p->count + 4));
        for (; inner; inner &= inner - 1) p->facets[p->count++] = brio_facet_of((uint32_t)tet, __builtin_ctz(inner));
    }
done:
    return status;
}

typedef struct {
    brio_context *ctx;
    const brio_tet_labels *labels;
    part *parts;
    size_t size;
    brio_status status;
} listing;

static void list_parts(void *user, size_t begin, size_t end, int thread) {
    listing *a = user;
    (void)thread;
    for (int i = (int)begin; i < (int)end; i++)
        brio_report(&a->status, list_part(a->ctx, a->labels, brio_part(a->size, i, PARTS),
                                          brio_part(a->size, i + 1, PARTS), &a->parts[i]));
}

brio_status brio_boundary_facets(brio_context *ctx, const brio_tet_labels *labels, brio_facets *out) {
    brio_status status = BRIO_OK;
    part parts[PARTS] = {{0}};
    size_t size = labels->dual->t.count;
    *out = (brio_facets){0};
    listing all = {ctx, labels, parts, size, BRIO_OK};
    BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, size, TETS_A_THREAD), PARTS, 1, list_parts, &all));
    BRIO_TRY(all.status);
    for (int i = 0; i < PARTS; i++) out->count += parts[i].count;
    BRIO_TRY(BRIO_ALLOC(ctx, out->facet, out->count));
    for (size_t i = 0, at = 0; i < PARTS; at += parts[i++].count)
        if (parts[i].count > 0) memcpy(out->facet + at, parts[i].facets, parts[i].count * sizeof *out->facet);
done:
    for (int i = 0; i < PARTS; i++) brio_release(ctx, parts[i].facets);
    return status;
}
