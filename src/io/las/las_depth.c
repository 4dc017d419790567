/* Finds out whether the colours of a LAS file have 8 bits.
 *
 * LAS has colours of 16 bits, and says that numbers of 8 bits are to be scaled; many programs write them as they are. A
 * file is of that kind if no number of its colours is over 255. All points are looked at, so that the answer does not
 * depend on which come first; the search ends at the first larger number. Black alone tells nothing. */
#include "io/las/las_depth.h"
#include <string.h>

enum { MOST_OF_8_BITS = 255 };

void brio_las_depth_see(brio_las_depth *d, const brio_mesh *block) {
    static const char *const names[] = {"red", "green", "blue"};
    for (int k = 0; k < 3 && !d->deep; k++) {
        const brio_property *p = brio_mesh_property(block, names[k]);
        const uint16_t *values = p->data;
        uint16_t most = 0;
        for (size_t i = 0; i < block->num_vertices; i++)
            if (values[i] > most) most = values[i];
        d->coloured |= most > 0;
        d->deep |= most > MOST_OF_8_BITS;
    }
}

brio_status brio_las_depth_give(const brio_las_depth *d, brio_mesh *mesh) {
    return d->coloured && !d->deep ? brio_mesh_set_metadata(mesh, "colour.depth", "8", 1) : BRIO_OK;
}

static brio_status look(void *user, const brio_mesh *block) {
    brio_las_depth *d = user;
    brio_las_depth_see(d, block);
    return d->deep ? BRIO_ERR_CANCELLED : BRIO_OK; /* more points change nothing */
}

brio_status brio_las_depth_find(brio_stream *s, const brio_builder *b, const brio_las_header *h, brio_las_depth *d) {
    brio_status status = BRIO_OK;
    brio_stream again = {.ctx = s->ctx, .file = -1};
    brio_builder colours = {.ctx = s->ctx};
    brio_las_plan plan = {.ctx = s->ctx};
    const brio_sink sink = {look, d};
    *d = (brio_las_depth){.deep = false};
    BRIO_TRY(brio_stream_open_again(&again, s));
    BRIO_TRY(brio_stream_skip(&again, brio_stream_offset(s)));
    BRIO_TRY(brio_builder_start(&colours, s->ctx, b->name));
    colours.sink = &sink;
    colours.drop_invalid = true; /* the reading that counts refuses */
    colours.salvage = b->salvage;
    brio_builder_stream(&colours, BRIO_COUNT_UNKNOWN);
    BRIO_TRY(brio_las_plan_colours(&plan, &colours, h));
    BRIO_TRY(brio_las_read_points(&again, &colours, h, &plan));
    BRIO_TRY(brio_builder_finish(&colours));
done:
    if (d->deep) status = BRIO_OK;
    brio_las_plan_free(&plan);
    brio_mesh_free(colours.mesh);
    brio_stream_close(&again);
    return status;
}
