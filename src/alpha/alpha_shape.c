/* The boundary of an alpha shape as a mesh.
 *
 * A tetrahedron is inside when its value is at most alpha. The boundary is the facets between inside and outside, seen
 * counterclockwise from outside. Where parts of the solid touch in an edge or a vertex only, the boundary is no
 * manifold: there the mesh gets one vertex for each sheet (mesh/split_vertices.c), so that the mesh is a manifold and
 * the solid stays the same. Facets, edges and vertices of the complex that bound no inside tetrahedron are singular:
 * they are counted, and are no part of the mesh.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "alpha/alpha_complex.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/versioned.h"
#include "mesh/split_vertices.h"
#include "triangulation/view.h"
#include <assert.h>
#include <math.h>
#include <string.h>

typedef struct {
    brio_context *ctx;
    brio_tetrahedra t;
    const brio_alpha_complex *complex;
    double alpha;
    size_t num_points;
    uint32_t *vertex; /* #P: 1 + the number in the mesh, or 0 */
    brio_mesh *mesh;
    brio_alpha_shape_stats stats;
} shape;

static bool is_inside(const shape *s, uint32_t tet) {
    assert(brio_has_tet(&s->t, tet));
    return tet < s->complex->counts[3] && s->complex->values[3][tet] <= s->alpha;
}

static bool is_boundary(const shape *s, uint32_t facet) {
    return is_inside(s, brio_tet_of(facet)) && !is_inside(s, brio_tet_of(*brio_mate(&s->t, facet)));
}

/* Lists the facets between inside and outside. A facet seen from inside is FACET[i]; from outside its order is
 * reversed. */
static brio_status list_faces(shape *s) {
    static const uint8_t FROM_OUTSIDE[3] = {0, 2, 1};
    brio_mesh *m = s->mesh;
    size_t handles = 4 * s->complex->counts[3], at = 0;
    for (uint32_t h = 0; h < handles; h++) m->num_faces += is_boundary(s, h);
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, m->face_offsets, m->num_faces + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, m->face_vertices, 3 * m->num_faces));
    for (size_t f = 0; f <= m->num_faces; f++) m->face_offsets[f] = 3 * f;
    for (uint32_t h = 0; h < handles; h++) {
        if (!is_boundary(s, h)) continue;
        const uint32_t *v = s->t.tet[brio_tet_of(h)].vertex;
        for (int k = 0; k < 3; k++) m->face_vertices[at++] = v[BRIO_FACET[brio_slot_of(h)][FROM_OUTSIDE[k]]];
    }
    assert(at == 3 * m->num_faces);
    return BRIO_OK;
}

/* Numbers the vertices of the faces in the order of the points. */
static brio_status place_vertices(shape *s, const double *points) {
    brio_mesh *m = s->mesh;
    uint32_t used = 0;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, s->vertex, s->num_points));
    for (size_t c = 0; c < 3 * m->num_faces; c++) s->vertex[m->face_vertices[c]] = 1;
    for (size_t p = 0; p < s->num_points; p++)
        if (s->vertex[p]) s->vertex[p] = ++used;
    BRIO_FORWARD(brio_mesh_set_vertices(m, NULL, used));
    for (size_t p = 0; p < s->num_points; p++)
        if (s->vertex[p]) memcpy(m->vertices + 3 * (size_t)(s->vertex[p] - 1), points + 3 * p, 3 * sizeof *points);
    for (size_t c = 0; c < 3 * m->num_faces; c++) m->face_vertices[c] = s->vertex[m->face_vertices[c]] - 1;
    assert(used <= s->num_points);
    s->stats.vertices = used;
    return BRIO_OK;
}

/* --- all alphas at once --- */

static double value_of(const shape *s, uint32_t tet) {
    return tet < s->complex->counts[3] ? s->complex->values[3][tet] : INFINITY;
}

/* Lists all facets in the order of the complex, each by its lower handle. A facet looks away from the tetrahedron of
 * the lesser value, which is inside first. */
static brio_status list_facets(shape *s) {
    static const char *const names[3] = {"appears", "solid", "vanishes"};
    brio_mesh *m = s->mesh;
    const size_t count = s->complex->counts[2];
    double *value[3];
    size_t f = 0;
    void *data;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, m->face_offsets, count + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, m->face_vertices, 3 * count + 1));
    m->num_faces = count;
    for (size_t i = 0; i <= count; i++) m->face_offsets[i] = 3 * i;
    for (int k = 0; k < 3; k++) {
        BRIO_FORWARD(brio_mesh_add_face_property(m, names[k], BRIO_SCALAR_FLOAT64, &data));
        value[k] = data;
    }
    for (uint32_t h = 0; h < 4 * s->complex->counts[3]; h++) {
        const uint32_t mate = *brio_mate(&s->t, h), *v = s->t.tet[brio_tet_of(h)].vertex;
        const double mine = value_of(s, brio_tet_of(h)), other = value_of(s, brio_tet_of(mate));
        BRIO_FORWARD(brio_look(s->ctx, 1));
        if (mate < h) continue;
        for (int k = 0; k < 3; k++) { /* FACET is seen from inside */
            int from = mine <= other ? (3 - k) % 3 : k;
            m->face_vertices[3 * f + (size_t)k] = v[BRIO_FACET[brio_slot_of(h)][from]];
        }
        value[0][f] = s->complex->values[2][f];
        value[1][f] = fmin(mine, other);
        value[2][f++] = fmax(mine, other);
    }
    assert(f == count);
    return BRIO_OK;
}

brio_status brio_alpha_facets(brio_context *ctx, const double *points, const brio_alpha_complex *complex,
                              brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    shape s = {.ctx = ctx, .complex = complex};
    *out = NULL;
    BRIO_REQUIRE(ctx, complex->triangulation, BRIO_ERR_ARGUMENT, "the complex is of points in the plane");
    s.t = brio_tetrahedra_of(complex->triangulation);
    BRIO_TRY(brio_mesh_new(ctx, &s.mesh));
    BRIO_TRY(brio_mesh_set_vertices(s.mesh, points, brio_triangulation_stats(complex->triangulation)->points));
    BRIO_TRY(list_facets(&s));
    *out = s.mesh;
    s.mesh = NULL;
done:
    brio_mesh_free(s.mesh);
    return status;
}

/* --- one alpha --- */

static void count_all(shape *s) {
    const brio_alpha_complex *c = s->complex;
    for (size_t t = 0; t < c->counts[3]; t++) s->stats.tetrahedra += c->values[3][t] <= s->alpha;
    for (size_t v = 0; v < c->counts[0]; v++) s->stats.uncovered += c->solid[0][v] > s->alpha;
    s->stats.alpha = s->alpha;
    s->stats.singular_vertices = brio_count_singular(c, 0, s->alpha);
    s->stats.singular_edges = brio_count_singular(c, 1, s->alpha);
    s->stats.singular_facets = brio_count_singular(c, 2, s->alpha);
}

static brio_status make_surface(shape *s, const double *points) {
    count_all(s);
    BRIO_EXPECT(s->ctx, s->stats.tetrahedra > 0, BRIO_BECAUSE(s->ctx, NO_VALUE, BRIO_ERR_NO_ANSWER),
                "no tetrahedron has a value of at most alpha = %g", s->alpha);
    double greatest = brio_greatest(s->complex->values[0], s->complex->counts[0]);
    BRIO_FORWARD(brio_refuse_small_alpha(s->ctx, greatest, s->alpha));
    BRIO_FORWARD(list_faces(s));
    BRIO_FORWARD(place_vertices(s, points));
    BRIO_FORWARD(brio_mesh_split_sheets(s->ctx, s->mesh));
    s->stats.split = s->mesh->num_vertices - s->stats.vertices;
    return BRIO_OK;
}

brio_status brio_alpha_shape(brio_context *ctx, const double *points, const brio_alpha_complex *complex, double alpha,
                             brio_mesh **out, brio_alpha_shape_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    shape s = {.ctx = ctx, .complex = complex, .alpha = alpha};
    *out = NULL;
    BRIO_REQUIRE(ctx, complex->triangulation, BRIO_ERR_ARGUMENT,
                 "the complex is of points in the plane, or of space that repeats");
    s.t = brio_tetrahedra_of(complex->triangulation);
    s.num_points = brio_triangulation_stats(complex->triangulation)->points;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_alpha_shape_stats, stats));
    BRIO_REQUIRE(ctx, !isnan(alpha), BRIO_ERR_ARGUMENT, "alpha is NaN");
    BRIO_TRY(brio_mesh_new(ctx, &s.mesh));
    BRIO_TRY(make_surface(&s, points));
    *out = s.mesh;
    s.mesh = NULL;
done:
    BRIO_GIVE(brio_alpha_shape_stats, stats, &s.stats);
    brio_mesh_free(s.mesh);
    brio_release(ctx, s.vertex);
    return status;
}
