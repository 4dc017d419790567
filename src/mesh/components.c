/* Components of a mesh, dropped by area or by number of faces.
 *
 * A union-find joins the faces of every edge; its sets are the components, as in the certificate. The faces that stay
 * keep their order, and so do the vertices. */
#include "base/float_state.h"
#include "base/union_find.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include "mesh/properties.h"
#include <math.h>
#include <string.h>

/* A component, at the place of its first face. */
typedef struct {
    double area;
    size_t faces;
} component;

typedef struct {
    brio_context *ctx;
    brio_mesh *mesh;
    uint32_t *parent; /* #F: union-find of the faces; a root is the first face of its component */
    component *of;    /* #F: of each root */
    uint8_t *used;    /* #V: bits of vertex_use */
    uint32_t *number; /* #V: new numbers of the vertices that stay */
} sieve;

enum vertex_use { USED_BEFORE = 1, USED_AFTER = 2 };

/* Joins the faces of each edge. */
static brio_status join_faces(sieve *s) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = s->mesh;
    uint32_t *ring = NULL, *face = NULL;
    BRIO_TRY(brio_mesh_check_faces(s->ctx, m));
    BRIO_TRY(brio_edge_rings(s->ctx, m, &ring));
    BRIO_TRY(BRIO_ALLOC(s->ctx, face, m->face_offsets[m->num_faces]));
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->parent, m->num_faces));
    for (uint32_t f = 0; f < m->num_faces; f++) {
        s->parent[f] = f;
        for (uint64_t h = m->face_offsets[f]; h < m->face_offsets[f + 1]; h++) face[h] = f;
    }
    for (uint64_t h = 0; h < m->face_offsets[m->num_faces]; h++) brio_unite(s->parent, face[h], face[ring[h]], true);
done:
    brio_release(s->ctx, ring);
    brio_release(s->ctx, face);
    return status;
}

/* Returns the area of a face whose corners are multiplied by `scale`. */
static double area_of(const brio_mesh *m, size_t face, double scale) {
    const double *o = m->vertices + 3 * (size_t)m->face_vertices[m->face_offsets[face]];
    double area = 0;
    for (uint64_t h = m->face_offsets[face] + 2; h < m->face_offsets[face + 1]; h++) {
        double n[3];
        brio_scaled_normal(o, m->vertices + 3 * (size_t)m->face_vertices[h - 1],
                           m->vertices + 3 * (size_t)m->face_vertices[h], scale, n);
        area += 0.5 * brio_length(n);
    }
    return area;
}

/* Measures the components of the surface scaled to about 1, so that areas neither overflow nor vanish. */
static brio_status measure(sieve *s) {
    brio_status status = BRIO_ALLOC_ZERO(s->ctx, s->of, s->mesh->num_faces);
    if (status != BRIO_OK) return status;
    double scale = brio_surface_scale(s->mesh);
    for (uint32_t f = 0; f < s->mesh->num_faces; f++) {
        component *c = &s->of[brio_find(s->parent, f)];
        if (s->mesh->face_offsets[f + 1] > s->mesh->face_offsets[f]) c->area += area_of(s->mesh, f, scale);
        c->faces++;
    }
    return BRIO_OK;
}

/* Returns whether component f is larger than component g: by area, then by faces. */
static bool is_larger(const sieve *s, uint32_t f, uint32_t g) {
    const component *a = &s->of[f], *b = &s->of[g];
    return a->area != b->area ? a->area > b->area : a->faces > b->faces;
}

/* Sets the faces of each component that goes to 0. Returns the number of components that stay. */
static size_t choose(const sieve *s, bool largest, size_t least_faces, size_t *dropped) {
    uint32_t best = UINT32_MAX;
    size_t kept = 0, all = 0;
    for (uint32_t f = 0; f < s->mesh->num_faces; f++) {
        if (s->parent[f] != f) continue;
        all++;
        if (s->of[f].faces < least_faces)
            s->of[f].faces = 0;
        else if (kept++ == 0 || is_larger(s, f, best))
            best = f;
    }
    for (uint32_t f = 0; f < s->mesh->num_faces && largest; f++)
        if (f != best) s->of[f].faces = 0;
    if (largest && kept > 0) kept = 1;
    *dropped = all - kept;
    return kept;
}

/* Moves the faces that stay to the front, and marks the vertices. */
static void move_faces(const sieve *s) {
    brio_mesh *m = s->mesh;
    size_t faces = 0;
    uint64_t corners = 0, begin = 0;
    for (uint32_t f = 0; f < m->num_faces; f++) {
        uint64_t end = m->face_offsets[f + 1];
        bool stays = s->of[brio_find(s->parent, f)].faces > 0;
        for (uint64_t h = begin; h < end; h++) {
            s->used[m->face_vertices[h]] |= stays ? USED_BEFORE | USED_AFTER : USED_BEFORE;
            if (stays) m->face_vertices[corners++] = m->face_vertices[h];
        }
        begin = end;
        if (!stays) continue;
        brio_properties_move(m->face_properties, m->num_face_properties, f, faces);
        m->face_offsets[++faces] = corners;
    }
    m->num_faces = faces;
}

/* Moves the vertices that stay, and their properties, to the front: those that a face uses and those that none used. */
static void move_vertices(const sieve *s) {
    brio_mesh *m = s->mesh;
    size_t count = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        if (s->used[v] == USED_BEFORE) continue;
        memmove(m->vertices + 3 * count, m->vertices + 3 * v, 3 * sizeof *m->vertices);
        brio_properties_move(m->properties, m->num_properties, v, count);
        s->number[v] = (uint32_t)count++;
    }
    m->num_vertices = count;
    for (uint64_t h = 0; h < m->face_offsets[m->num_faces]; h++) m->face_vertices[h] = s->number[m->face_vertices[h]];
}

brio_status brio_mesh_keep_components(brio_mesh *mesh, int largest, size_t least_faces, size_t *dropped_components,
                                      size_t *dropped_faces) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    sieve s = {.ctx = mesh->context, .mesh = mesh};
    size_t faces = mesh->num_faces, dropped = 0;
    BRIO_REQUIRE(s.ctx, !mesh->num_edges && !mesh->num_tetrahedra, BRIO_ERR_ARGUMENT,
                 "a mesh with edges or tetrahedra of its own: components are of faces");
    if (faces > 0) {
        BRIO_TRY(join_faces(&s));
        BRIO_TRY(measure(&s));
        BRIO_TRY(BRIO_ALLOC_ZERO(s.ctx, s.used, mesh->num_vertices));
        BRIO_TRY(BRIO_ALLOC(s.ctx, s.number, mesh->num_vertices));
        BRIO_REQUIRE(s.ctx, choose(&s, largest != 0, least_faces, &dropped) > 0,
                     BRIO_BECAUSE(s.ctx, NO_COMPONENT, BRIO_ERR_NO_ANSWER),
                     "no component is left: none of %zu has %zu faces", dropped, least_faces);
        move_faces(&s);
        move_vertices(&s);
    }
    if (dropped_components) *dropped_components = dropped;
    if (dropped_faces) *dropped_faces = faces - mesh->num_faces;
done:
    brio_release(s.ctx, s.parent);
    brio_release(s.ctx, s.of);
    brio_release(s.ctx, s.used);
    brio_release(s.ctx, s.number);
    return status;
}
