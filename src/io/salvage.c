/* Keeps the whole rows of a file that ends early, see salvage.h. */
#include "io/salvage.h"
#include <inttypes.h>
#include <stdio.h>

bool brio_salvage(brio_builder *b, brio_stream *s, uint64_t before, bool points, brio_status *status) {
    char text[64];
    bool may_lack_digits = *status == BRIO_OK && s->unended && s->row + 1 < s->rows;
    bool fails = *status == BRIO_ERR_FORMAT && (s->truncated || s->unended);
    if (!b->salvage || !(fails || may_lack_digits)) return false;
    brio_mesh *m = b->mesh;
    m->num_vertices -= (size_t)(brio_builder_count(b) - before);
    b->num_corners = m->num_faces ? (size_t)m->face_offsets[m->num_faces] : 0;
    s->begin = s->end; /* what is left of the row is no other row */
    s->salvaged = true;
    *status = BRIO_OK;
    if (points) b->missing = s->rows - s->row;
    if (points) return true;
    snprintf(text, sizeof text, "%" PRIu64 " rows of %.30s", s->rows - s->row, s->element);
    *status = brio_builder_leave_out(b, text);
    return true;
}
