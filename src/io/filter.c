/* Parts of a mesh, see filter.h. Rows that stay move to the front of their arrays. */
#include "io/filter.h"
#include "base/memory.h"
#include "mesh/properties.h"
#include <string.h>

void brio_find_in_box(const brio_mesh *mesh, const double *box, uint8_t *stays) {
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        const double *p = mesh->vertices + 3 * v;
        stays[v] =
            p[0] >= box[0] && p[0] <= box[3] && p[1] >= box[1] && p[1] <= box[4] && p[2] >= box[2] && p[2] <= box[5];
    }
}

static size_t pack(void *rows, size_t size, size_t count, const uint8_t *stays) {
    char *bytes = rows;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (stays[i]) memmove(bytes + size * kept++, bytes + size * i, size);
    return kept;
}

/* Keeps the cells whose corners all stay.   corners  of a cell.   place  new indices of the vertices. */
static size_t pack_cells(uint32_t *cells, size_t corners, size_t count, const uint8_t *stays, const uint32_t *place) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool whole = true;
        for (size_t k = 0; k < corners; k++) whole &= stays[cells[corners * i + k]];
        if (!whole) continue;
        for (size_t k = 0; k < corners; k++) cells[corners * kept + k] = place[cells[corners * i + k]];
        kept++;
    }
    return kept;
}

static void pack_faces(brio_mesh *m, const uint8_t *stays, const uint32_t *place) {
    size_t kept = 0;
    uint64_t corners = 0, from = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t to = m->face_offsets[f + 1];
        bool whole = true;
        for (uint64_t c = from; c < to; c++) whole &= stays[m->face_vertices[c]];
        for (uint64_t c = from; c < to && whole; c++) m->face_vertices[corners++] = place[m->face_vertices[c]];
        from = to;
        if (!whole) continue;
        brio_properties_move(m->face_properties, m->num_face_properties, f, kept);
        m->face_offsets[++kept] = corners;
    }
    m->num_faces = kept;
}

brio_status brio_filter_mesh(brio_context *ctx, brio_mesh *m, const uint8_t *stays) {
    brio_status status = BRIO_OK;
    uint32_t *place = NULL;
    size_t n = m->num_vertices;
    if (m->num_faces || m->num_tetrahedra || m->num_edges) {
        BRIO_TRY(BRIO_ALLOC(ctx, place, n));
        for (size_t v = 0, kept = 0; v < n; v++) place[v] = (uint32_t)(stays[v] ? kept++ : 0);
        pack_faces(m, stays, place);
        m->num_tetrahedra = pack_cells(m->tetrahedra, 4, m->num_tetrahedra, stays, place);
        m->num_edges = pack_cells(m->edges, 2, m->num_edges, stays, place);
    }
    m->num_vertices = pack(m->vertices, 3 * sizeof *m->vertices, n, stays);
    for (size_t i = 0; i < m->num_properties; i++)
        pack(m->properties[i].data, brio_scalar_size(m->properties[i].type), n, stays);
done:
    brio_release(ctx, place);
    return status;
}
