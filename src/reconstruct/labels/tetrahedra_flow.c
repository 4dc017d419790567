/* Maximum flow of tetrahedra: see flow_body.h. An arc is a facet handle: 4 t + i leads from tetrahedron t across its facet
 * i. So the triangulation has heads and mates, and a tetrahedron costs 41 bytes, a third of what lists of edges take. */
#include "reconstruct/labels/tetrahedra_flow.h"
#include "base/memory.h"
#include <string.h>

#define FLOW                brio_tet_flow
#define FLOW_TERMINAL       int32_t
#define FLOW_NODES(f)       ((f)->num_open)
#define FLOW_NODE(f, i)     ((f)->open ? (f)->open[i] : (uint32_t)(i))
#define FLOW_FIRST(f, v)    brio_facet_of(v, 0)
#define FLOW_END(f, v)      (brio_facet_of(v, 3) + 1)
#define FLOW_HEAD(f, a)     brio_tet_of(*brio_mate((f)->t, a))
#define FLOW_MATE(f, a)     (*brio_mate((f)->t, a))
#define FLOW_RESIDUAL(f, a) ((f)->residual[brio_tet_of(a)][brio_slot_of(a)])
#include "reconstruct/labels/flow_body.h"

brio_status brio_tet_flow_new(brio_context *ctx, const brio_tetrahedra *t, const uint32_t *open, size_t num_open,
                              brio_tet_flow *out) {
    brio_status status = BRIO_OK;
    *out = (brio_tet_flow){.ctx = ctx, .t = t, .open = open, .num_open = num_open, .trees.room = t->count};
    BRIO_TRY(BRIO_ALLOC(ctx, out->node, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->residual, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->terminal, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->side, t->count));
    memset(out->side, BRIO_FLOW_FREE, t->count);
done:
    return status;
}

void brio_tet_flow_free(brio_tet_flow *f) {
    brio_release(f->ctx, f->node);
    brio_release(f->ctx, f->residual);
    brio_release(f->ctx, f->terminal);
    brio_release(f->ctx, f->side);
    *f = (brio_tet_flow){.ctx = f->ctx};
}

void brio_tet_flow_run(brio_tet_flow *f) {
    run(f);
}
