/* The triangles of a page, a byte each: see brio_page_triangles in sent_order.h.
 *
 * Based on: Kapoulkine. meshoptimizer, index codec. 2017.
 * Differs from it: corners that the queues lack stand behind all bytes, relative to the vertex named last. */
#include "base/memory.h"
#include "page/block.h"
#include "page/sent_order.h"
#include <assert.h>

/* QUEUE: edges and corners that are remembered, a power of two. EDGES, CORNERS: how far back a byte can name them.
 * NONE, NAMED: halves of a byte without an edge, and with a corner that follows. */
enum { QUEUE = 16, EDGES = 15, CORNERS = 14, NONE = 15, NAMED = 15 };

typedef struct {
    uint32_t edge[QUEUE][2]; /* as the face on the other side runs along it */
    uint32_t corner[QUEUE];
    unsigned edges, corners; /* pushed so far */
    uint32_t next, last;     /* the number of the next new vertex; the corner named last */
    brio_page_block *block;
    uint32_t *named; /* what stands behind the bytes */
    size_t num_named, capacity;
    brio_context *ctx;
} encoder;

static void push_edge(encoder *e, uint32_t a, uint32_t b) {
    e->edge[e->edges % QUEUE][0] = a;
    e->edge[e->edges++ % QUEUE][1] = b;
}

static void push_corner(encoder *e, uint32_t v) {
    e->corner[e->corners++ % QUEUE] = v;
}

static brio_status name(encoder *e, uint64_t code) {
    BRIO_FORWARD(BRIO_RESERVE(e->ctx, e->named, e->capacity, e->num_named + 1));
    e->named[e->num_named++] = (uint32_t)code;
    return BRIO_OK;
}

/* Finds a remembered edge of a triangle, and turns the triangle so that it is its first one. */
static int find_edge(const encoder *e, uint32_t t[3]) {
    for (unsigned i = 0; i < EDGES && i < e->edges; i++) {
        const uint32_t *edge = e->edge[(e->edges - 1 - i) % QUEUE];
        for (int k = 0; k < 3; k++) {
            uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
            if (a != edge[0] || b != edge[1]) continue;
            t[0] = a, t[1] = b, t[2] = c;
            return (int)i;
        }
    }
    return NONE;
}

/* Returns the low half of a byte for a corner, and remembers the corner. */
static brio_status encode_corner(encoder *e, uint32_t v, unsigned *code) {
    *code = NAMED;
    for (unsigned i = 0; i < CORNERS && i < e->corners; i++)
        if (e->corner[(e->corners - 1 - i) % QUEUE] == v) *code = 1 + i, i = CORNERS;
    if (v == e->next) *code = 0, e->next++;
    if (*code == NAMED) BRIO_FORWARD(name(e, brio_zigzag((int64_t)v - e->last)));
    if (*code == NAMED || *code == 0) push_corner(e, v);
    e->last = v;
    return BRIO_OK;
}

static brio_status encode(encoder *e, uint32_t t[3]) {
    int edge = find_edge(e, t);
    unsigned code = 0;
    if (edge == NONE) {
        for (int k = 0; k < 3; k++) {
            BRIO_FORWARD(name(e, brio_zigzag((int64_t)e->next - t[k])));
            e->next += t[k] == e->next;
            push_corner(e, t[k]);
        }
        push_edge(e, t[1], t[0]);
        e->last = t[2];
    } else {
        BRIO_FORWARD(encode_corner(e, t[2], &code));
    }
    push_edge(e, t[2], t[1]);
    push_edge(e, t[0], t[2]);
    return brio_page_byte(e->block, (uint8_t)((unsigned)edge << 4 | code));
}

brio_status brio_page_triangles(const brio_sent_order *o, brio_output *out, size_t layer) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = o->mesh;
    encoder e = {.ctx = out->ctx};
    BRIO_TRY(brio_page_block_begin(&e.block, out, layer, "triangles"));
    for (size_t i = 0; i < o->num_faces; i++) {
        const uint32_t *corner = m->face_vertices + m->face_offsets[o->face[i]];
        size_t corners = (size_t)(m->face_offsets[o->face[i] + 1] - m->face_offsets[o->face[i]]);
        for (size_t k = 2; k < corners; k++) {
            uint32_t t[3] = {o->place[corner[0]], o->place[corner[k - 1]], o->place[corner[k]]};
            BRIO_TRY(encode(&e, t));
        }
        BRIO_TRY(brio_look(out->ctx, corners));
    }
    for (size_t i = 0; i < e.num_named; i++) BRIO_TRY(brio_page_varint(e.block, e.named[i]));
    BRIO_TRY(brio_page_block_end(e.block));
done:
    brio_page_block_free(e.block);
    brio_release(out->ctx, e.named);
    return status;
}
