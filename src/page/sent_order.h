/* The order in which a page stores the vertices and faces of a mesh. Neighbours stand near each other there, so that
 * the page is small. */
#ifndef BRIO_PAGE_SENT_ORDER_H
#define BRIO_PAGE_SENT_ORDER_H

#include "io/output.h"

/** I1  vertex[] lists the vertices on the page, and place[vertex[i]] == i. Without `place` there is no connectivity.
 *  I2  Where there are faces, vertices stand in the order in which the corners of face[0], face[1] ... name them first.
 *  I3  face[] lists the faces of three corners or more, each once.
 *  I4  Half-edges are those of mesh/edge_rings.h. Each of the lists of half-edges names an edge once. */
typedef struct brio_sent_order {
    brio_context *ctx;
    const brio_mesh *mesh;
    uint32_t *vertex, *place; /* vertex[i]: of the mesh; place[v]: on the page */
    size_t num_vertices;
    uint32_t *face;
    size_t num_faces, num_triangles;            /* triangles: of the fans of the faces */
    uint32_t *face_of;                          /* of each corner; NULL if all faces are triangles */
    uint32_t *boundary, *nonmanifold, *flipped; /* half-edges of edges of one face, of more than two, and of two faces
                                                   that run along it in the same direction */
    size_t num_boundary, num_nonmanifold, num_flipped;
    size_t capacity[3]; /* of these lists */
} brio_sent_order;

/** Finds the order.
 *  mesh  with finite coordinates; its indices are in range.   most  a cloud of more points is thinned to this number.
 *  out   freed with brio_sent_order_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_sent_order_find(brio_context *ctx, const brio_mesh *mesh, size_t most, brio_sent_order *out);
void brio_sent_order_free(brio_sent_order *o);

/** Returns the corner behind a corner of a face. */
static inline uint32_t brio_sent_next(const brio_sent_order *o, uint32_t h) {
    if (!o->face_of) return h % 3 == 2 ? h - 2 : h + 1;
    uint32_t f = o->face_of[h];
    return h + 1 < o->mesh->face_offsets[f + 1] ? h + 1 : (uint32_t)o->mesh->face_offsets[f];
}

/** Writes the block of triangles: those of the fans of the faces, in the order of the page.
 *  Each triangle has a byte. Its high half says which of the last edges, from 0 on, the triangle shares, 15 that it
 *  shares none; its low half says where the third corner is: 0 a new vertex, 1 to 14 one of the last corners, 15 a
 *  vertex that the numbers behind these bytes name. New vertices have ascending numbers (I2), so that a byte suffices
 *  for most triangles.
 *  A vertex behind the bytes is a difference by brio_zigzag and brio_page_varint: of a third corner, from the third
 *  corner before; of the corners of a triangle without an edge, each from the next new number.
 *  Based on: [Kapoulkine 2017] for the two queues. */
brio_status brio_page_triangles(const brio_sent_order *o, brio_output *out, size_t layer);

#endif
