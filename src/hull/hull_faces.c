/* The faces of a polytope of triangles.
 *
 * An edge is a crease when the triangles on its two sides are in different planes, decided exactly. Triangles that are
 * joined across other edges make one face. Each face at a vertex takes one sector, between two creases. So a vertex
 * with three or more creases is strictly extreme; one with two is inside an edge of the hull, and one without inside a
 * face. */
#include "hull/hull_faces.h"
#include "base/memory.h"
#include <assert.h>
#include <string.h>

/* Sets crease[4 f + i] for each edge, and counts the creases of each vertex, up to 3. */
static void find_creases(const brio_polytope *p, brio_filter *filter, const double (*record)[4], uint8_t *crease,
                         uint8_t *degree) {
    for (uint32_t f = 0; f < p->count; f++)
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t h = 4 * f + i, mate = p->triangle[f].mate[i];
            const uint32_t *v = p->triangle[f].vertex;
            crease[h] = mate < h ? crease[mate]
                                 : brio_orient3d_sign(filter, record[v[0]], record[v[1]], record[v[2]],
                                                      record[brio_hull_apex(p, mate)]) != 0;
            uint8_t *d = &degree[brio_hull_origin(p, h)];
            assert(crease[h] <= 1);
            if (crease[h] && *d < 3) ++*d;
        }
}

/* Returns the next crease round the face of a crease. */
static uint32_t next_crease(const brio_polytope *p, const uint8_t *crease, uint32_t h) {
    for (h = brio_hull_next(h); !crease[h];) h = brio_hull_next(p->triangle[h >> 2].mate[h & 3]);
    assert(h >> 2 < p->count);
    return h;
}

void brio_rotate_polygon(const double (*record)[4], uint32_t *corner, size_t size) {
    size_t least = 0;
    for (size_t i = 1; i < size; i++)
        if (brio_lexicographic(record[corner[i]], record[corner[least]]) < 0) least = i;
    for (size_t from = 0, middle = least, to = size; from < middle && middle < to;) { /* rotates in place */
        size_t n = middle - from < to - middle ? middle - from : to - middle;
        for (size_t i = 0; i < n; i++) {
            uint32_t swap = corner[from + i];
            corner[from + i] = corner[middle + i], corner[middle + i] = swap;
        }
        if (n == middle - from && n == to - middle) break;
        from += n;
        if (from == middle) middle += n;
    }
}

/* Walks round each face once. Crossed creases become 2. */
static brio_status list_faces(brio_context *ctx, const brio_polytope *p, const double (*record)[4], uint8_t *crease,
                              const uint8_t *degree, brio_hull_polygons *out) {
    uint64_t corners = 0;
    for (uint32_t f = 0; f < p->count; f++) {
        BRIO_FORWARD(brio_look(ctx, 4));
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t h = 4 * f + i, first = (uint32_t)corners;
            if (crease[h] != 1) continue;
            out->first[out->count++] = corners;
            for (; crease[h] == 1; h = next_crease(p, crease, h)) {
                uint32_t v = brio_hull_origin(p, h);
                crease[h] = 2;
                if (degree[v] == 3) out->corner[corners++] = p->same[v];
            }
            assert(corners - first >= 3 && corners <= 3 * p->count); /* a polygon */
            brio_rotate_polygon(record, out->corner + first, corners - first);
        }
    }
    out->first[out->count] = corners;
    return BRIO_OK;
}

brio_status brio_hull_faces(brio_context *ctx, const brio_polytope *p, const brio_hull_records *records,
                            brio_hull_polygons *out) {
    brio_status status = BRIO_OK;
    const double(*record)[4] = (const double(*)[4])records->record;
    uint8_t *crease = NULL, *degree = NULL;
    brio_filter filter;
    *out = (brio_hull_polygons){0};
    brio_filter_for(&filter, record, records->count, false);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, crease, 4 * p->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, degree, records->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->first, p->count + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->corner, 3 * p->count));
    find_creases(p, &filter, record, crease, degree);
    BRIO_TRY(list_faces(ctx, p, record, crease, degree, out));
done:
    brio_release(ctx, crease);
    brio_release(ctx, degree);
    if (status != BRIO_OK) brio_hull_polygons_free(ctx, out);
    return status;
}

void brio_hull_polygons_free(brio_context *ctx, brio_hull_polygons *polygons) {
    brio_release(ctx, polygons->first);
    brio_release(ctx, polygons->corner);
    *polygons = (brio_hull_polygons){0};
}
