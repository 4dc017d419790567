/* The boundary of an alpha shape in space that repeats.
 *
 * A class of tetrahedra is inside when its value is at most alpha. The surface is the facets between inside and
 * outside, one of each class. From a facet, tetrahedra inside are passed about each of its edges, until a facet of the
 * surface is met again: these two are neighbours there. So parts of the solid that touch in an edge or a vertex only
 * have surfaces that do not. Where a fan of faces passes one edge twice all the same, two pairs of neighbours are
 * exchanged, which makes two fans of it (as in mesh/split_vertices.c): the surface is a closed manifold. Corners of
 * neighbours at one vertex are one sheet: a vertex of the surface. Two faces that meet at different images of their
 * edge are cut apart in the mesh, which has a vertex for each fan of faces that is left.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "alpha/alpha_complex.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/union_find.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "periodic/periodic.h"
#include "triangulation/tetrahedra.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { NO_FACE = UINT32_MAX };

typedef struct {
    brio_context *ctx;
    const brio_periodic *t;
    const brio_alpha_complex *complex;
    double alpha;
    uint32_t *handle;      /* #faces: the facet, from inside */
    uint32_t *face_of;     /* #facets of finite tetrahedra */
    uint32_t *sheet, *fan; /* #faces by 3: sets of corners */
    uint32_t *partner;     /* #faces by 3: the half-edge at the other face of each */
    uint32_t *around;      /* #faces by 3 */
    uint32_t *part;        /* #faces: sets of faces */
    uint32_t *number;      /* #faces by 3: the vertex at a corner */
    uint32_t *first;       /* #vertices: the first corner there */
    size_t num_faces, num_vertices;
    brio_mesh *mesh;
    brio_periodic_shape_stats stats;
} shape;

static bool is_inside(const shape *s, uint32_t class) {
    return class < s->complex->counts[3] && s->complex->values[3][class] <= s->alpha;
}

/* Corner k of a face is slot FACET[i][FROM_OUTSIDE[k]] of its tetrahedron. */
static const uint8_t FROM_OUTSIDE[3] = {0, 2, 1};

static int slot_of(const shape *s, uint32_t corner) {
    return BRIO_FACET[s->handle[corner / 3] & 3][FROM_OUTSIDE[corner % 3]];
}

static uint32_t corner_of(const shape *s, uint32_t facet, int slot) {
    for (uint32_t k = 0; k < 3; k++)
        if (BRIO_FACET[facet & 3][FROM_OUTSIDE[k]] == slot) return 3 * s->face_of[facet] + k;
    assert(false);
    return 0;
}

/* Returns the image of a corner of a face. */
static uint32_t image_at(const shape *s, uint32_t corner) {
    return s->t->tet[s->handle[corner / 3] >> 2].vertex[slot_of(s, corner)];
}

static brio_status list_faces(shape *s) {
    size_t facets = 4 * s->complex->counts[3];
    const brio_tetrahedron *tet = s->t->tet;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->face_of, facets + 1));
    for (uint32_t h = 0; h < facets; h++) {
        bool is_face = is_inside(s, h >> 2) && !is_inside(s, tet[h >> 2].mate[h & 3] >> 2);
        s->face_of[h] = is_face ? (uint32_t)s->num_faces++ : NO_FACE;
    }
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->handle, s->num_faces + 1));
    for (uint32_t h = 0; h < facets; h++)
        if (s->face_of[h] != NO_FACE) s->handle[s->face_of[h]] = h;
    return brio_look(s->ctx, facets);
}

/* --- neighbours --- */

/* A tetrahedron on the way about an edge: the facet by which it was entered, and the edge's slots. */
typedef struct {
    uint32_t class;
    int in, edge[2];
} step;

static uint32_t next_corner(uint32_t c) {
    return c % 3 == 2 ? c - 2 : c + 1;
}

/* Returns the slot of the tetrahedron behind a facet that has the vertex of a slot here. */
static int slot_behind(const shape *s, uint32_t class, int facet, int slot) {
    const brio_images *m = &s->t->images;
    uint32_t mate = s->t->tet[class].mate[facet];
    const uint32_t *v = s->t->tet[mate >> 2].vertex;
    const brio_image *a = &m->list[s->t->tet[class].vertex[slot]];
    int32_t way[3];
    brio_periodic_across(m, s->t->tet, class, facet, way);
    for (int j = 0; j < 4; j++) {
        if (j == (int)(mate & 3) || v[j] == BRIO_INFINITE) continue;
        const brio_image *b = &m->list[v[j]];
        bool same = a->point == b->point;
        for (int k = 0; k < 3; k++) same = same && a->shift[k] == b->shift[k] + way[k];
        if (same) return j;
    }
    assert(false); /* I2 of periodic.h */
    return 0;
}

static step cross(const shape *s, const step *at, int facet) {
    uint32_t mate = s->t->tet[at->class].mate[facet];
    step next = {mate >> 2, (int)(mate & 3), {0, 0}};
    for (int k = 0; k < 2; k++) next.edge[k] = slot_behind(s, at->class, facet, at->edge[k]);
    return next;
}

/* Returns the half-edge across the inside wedge of one or, with inside false, across its outside wedge. A half-edge
 * begins at the corner of its number. */
static uint32_t turn(const shape *s, uint32_t half_edge, bool inside) {
    step at = {s->handle[half_edge / 3] >> 2,
               (int)(s->handle[half_edge / 3] & 3),
               {slot_of(s, half_edge), slot_of(s, next_corner(half_edge))}};
    if (!inside) at = cross(s, &at, at.in);
    for (;;) {
        int out = 6 - at.in - at.edge[0] - at.edge[1];
        if (inside && s->face_of[4 * at.class + (uint32_t)out] != NO_FACE)
            return corner_of(s, 4 * at.class + (uint32_t)out, at.edge[1]);
        at = cross(s, &at, out);
        if (!inside && is_inside(s, at.class)) return corner_of(s, 4 * at.class + (uint32_t)at.in, at.edge[1]);
    }
}

/* Pairs half-edges across inside wedges. `around` is the next one of the same edge and direction. */
static brio_status pair_all(shape *s) {
    size_t count = 3 * s->num_faces;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->partner, count + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->around, count + 1));
    for (uint32_t h = 0; h < count; h++) {
        s->partner[h] = turn(s, h, true);
        s->around[h] = turn(s, s->partner[h], false);
        BRIO_FORWARD(brio_look(s->ctx, 1));
    }
    return BRIO_OK;
}

static void join_corners(shape *s) {
    for (uint32_t c = 0; c < 3 * s->num_faces; c++) s->sheet[c] = s->fan[c] = c;
    for (uint32_t h = 0; h < 3 * s->num_faces; h++) {
        const uint32_t g = s->partner[h], here[2] = {h, next_corner(h)}, there[2] = {next_corner(g), g};
        bool cut = image_at(s, here[0]) != image_at(s, there[0]) || image_at(s, here[1]) != image_at(s, there[1]);
        for (int k = 0; k < 2; k++) {
            brio_unite(s->sheet, here[k], there[k], true);
            if (!cut) brio_unite(s->fan, here[k], there[k], true);
        }
    }
}

static bool are_one(shape *s, uint32_t g, uint32_t h) {
    return brio_find(s->sheet, g) == brio_find(s->sheet, h) &&
           brio_find(s->sheet, next_corner(g)) == brio_find(s->sheet, next_corner(h));
}

/* Looks for half-edges of one edge, direction and sheet at both ends: four faces or more have that edge. There the fans
 * of both ends pass the edge twice; the other pairing splits them. Does so at one edge a sheet. Returns whether any
 * was found. */
static bool repair_pairs(shape *s, uint8_t *changed) {
    bool any = false;
    memset(changed, 0, 3 * s->num_faces);
    for (uint32_t h = 0; h < 3 * s->num_faces; h++)
        for (uint32_t g = s->around[h]; g != h; g = s->around[g]) {
            uint32_t ends[2] = {brio_find(s->sheet, h), brio_find(s->sheet, next_corner(h))};
            if (g < h || !are_one(s, g, h) || changed[ends[0]] || changed[ends[1]]) continue;
            uint32_t mates[2] = {s->partner[h], s->partner[g]};
            s->partner[h] = mates[1], s->partner[mates[1]] = h;
            s->partner[g] = mates[0], s->partner[mates[0]] = g;
            changed[ends[0]] = changed[ends[1]] = 1;
            any = true;
        }
    return any;
}

static brio_status join_faces(shape *s) {
    brio_status status = BRIO_OK;
    uint8_t *changed = NULL;
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->sheet, 3 * s->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->fan, 3 * s->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->part, s->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(s->ctx, changed, 3 * s->num_faces + 1));
    BRIO_TRY(pair_all(s));
    do {
        join_corners(s);
        BRIO_TRY(brio_look(s->ctx, 3 * s->num_faces));
    } while (repair_pairs(s, changed));
    for (uint32_t f = 0; f < s->num_faces; f++) s->part[f] = f;
    for (uint32_t h = 0; h < 3 * s->num_faces; h++) brio_unite(s->part, h / 3, s->partner[h] / 3, true);
done:
    brio_release(s->ctx, changed);
    return status;
}

/* --- the mesh --- */

/* Numbers the fans in the order of their first corners. */
static brio_status number_fans(shape *s) {
    size_t count = 3 * s->num_faces;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->first, count + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->number, count + 1));
    for (uint32_t c = 0; c < count; c++) {
        uint32_t root = brio_find(s->fan, c); /* the least corner of the fan */
        if (root == c) s->first[s->num_vertices++] = c;
        s->number[c] = root == c ? (uint32_t)s->num_vertices - 1 : s->number[root];
    }
    return BRIO_OK;
}

static brio_status fill_mesh(shape *s) {
    static const char *const names[5] = {"point", "shift_a", "shift_b", "shift_c", "sheet"};
    brio_mesh *m = s->mesh;
    void *data[5];
    BRIO_FORWARD(number_fans(s));
    BRIO_FORWARD(brio_mesh_set_vertices(m, NULL, s->num_vertices));
    for (int k = 0; k < 5; k++)
        BRIO_FORWARD(brio_mesh_add_property(m, names[k], k % 4 ? BRIO_SCALAR_INT32 : BRIO_SCALAR_UINT32, &data[k]));
    for (size_t v = 0; v < s->num_vertices; v++) {
        uint32_t i = image_at(s, s->first[v]);
        const brio_image *image = &s->t->shown[i];
        memcpy(m->vertices + 3 * v, s->t->position[i], sizeof *s->t->position);
        ((uint32_t *)data[0])[v] = image->point;
        for (int k = 0; k < 3; k++) ((int32_t *)data[1 + k])[v] = image->shift[k];
        ((uint32_t *)data[4])[v] = brio_find(s->sheet, s->first[v]);
    }
    m->num_faces = s->num_faces;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, m->face_offsets, m->num_faces + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, m->face_vertices, 3 * m->num_faces + 1));
    for (size_t f = 0; f <= m->num_faces; f++) m->face_offsets[f] = 3 * f;
    memcpy(m->face_vertices, s->number, 3 * m->num_faces * sizeof *s->number);
    return BRIO_OK;
}

/* --- facts --- */

static brio_status count_surface(shape *s) {
    brio_status status = BRIO_OK;
    uint8_t *met = NULL;
    size_t sheets = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, met, s->t->stats.points + 1));
    for (uint32_t c = 0; c < 3 * s->num_faces; c++) {
        uint32_t point = s->t->images.list[image_at(s, c)].point;
        sheets += brio_find(s->sheet, c) == c;
        s->stats.vertices += !met[point];
        met[point] = 1;
    }
    for (uint32_t f = 0; f < s->num_faces; f++) s->stats.components += brio_find(s->part, f) == f;
    s->stats.split = sheets - s->stats.vertices;
    s->stats.euler = (int64_t)sheets - (int64_t)(s->num_faces / 2);
done:
    brio_release(s->ctx, met);
    return status;
}

static void measure(shape *s) {
    const brio_images *m = &s->t->images;
    for (size_t c = 0; c < s->complex->counts[3]; c++) {
        const uint32_t *v = s->t->tet[c].vertex;
        if (!is_inside(s, (uint32_t)c)) continue;
        double e[3][3], cross[3];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) e[k][a] = m->x[v[k + 1]][a] - m->x[v[0]][a];
        brio_cross(e[1], e[2], cross);
        s->stats.volume += brio_dot(e[0], cross) / 6;
        for (int i = 0; i < 4; i++) {
            if (s->face_of[4 * c + (size_t)i] == NO_FACE) continue;
            const double *x = m->x[v[BRIO_FACET[i][0]]], *y = m->x[v[BRIO_FACET[i][1]]], *z = m->x[v[BRIO_FACET[i][2]]];
            double a[3], b[3];
            for (int k = 0; k < 3; k++) a[k] = y[k] - x[k], b[k] = z[k] - x[k];
            brio_cross(a, b, cross);
            s->stats.area += brio_length(cross) / 2;
        }
    }
}

static brio_status make_surface(shape *s) {
    const brio_alpha_complex *c = s->complex;
    for (size_t t = 0; t < c->counts[3]; t++) s->stats.tetrahedra += c->values[3][t] <= s->alpha;
    for (size_t v = 0; v < c->counts[0]; v++) s->stats.uncovered += c->solid[0][v] > s->alpha;
    s->stats.alpha = s->alpha;
    s->stats.singular_vertices = brio_count_singular(s->complex, 0, s->alpha);
    s->stats.singular_edges = brio_count_singular(s->complex, 1, s->alpha);
    s->stats.singular_facets = brio_count_singular(s->complex, 2, s->alpha);
    BRIO_EXPECT(s->ctx, s->stats.tetrahedra > 0, BRIO_BECAUSE(s->ctx, NO_VALUE, BRIO_ERR_NO_ANSWER),
                "no tetrahedron has a value of at most alpha = %g", s->alpha);
    BRIO_FORWARD(brio_refuse_small_alpha(s->ctx, brio_greatest(c->values[0], c->counts[0]), s->alpha));
    BRIO_FORWARD(list_faces(s));
    BRIO_FORWARD(join_faces(s));
    BRIO_FORWARD(count_surface(s));
    measure(s);
    return fill_mesh(s);
}

brio_status brio_periodic_alpha_shape(brio_context *ctx, const brio_periodic_alpha *complex, double alpha,
                                      brio_mesh **out, brio_periodic_shape_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    shape s = {.ctx = ctx, .t = complex->periodic, .complex = complex->complex, .alpha = alpha};
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_periodic_shape_stats, stats));
    BRIO_REQUIRE(ctx, !isnan(alpha), BRIO_ERR_ARGUMENT, "alpha is NaN");
    BRIO_TRY(brio_mesh_new(ctx, &s.mesh));
    BRIO_TRY(make_surface(&s));
    *out = s.mesh;
    s.mesh = NULL;
done:
    BRIO_GIVE(brio_periodic_shape_stats, stats, &s.stats);
    brio_mesh_free(s.mesh);
    brio_release(ctx, s.handle);
    brio_release(ctx, s.face_of);
    brio_release(ctx, s.sheet);
    brio_release(ctx, s.partner);
    brio_release(ctx, s.around);
    brio_release(ctx, s.part);
    brio_release(ctx, s.fan);
    brio_release(ctx, s.number);
    brio_release(ctx, s.first);
    return status;
}
