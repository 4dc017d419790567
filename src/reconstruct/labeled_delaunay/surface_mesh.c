/* From triangles of samples to a mesh: vertices in the caller's order, their confidence, simplification.
 *
 * A simplified surface goes through brio_collapse_edges in scaled coordinates, so that squares do not overflow. What a
 * vertex is called rides along as a property.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997. */
#include "reconstruct/labeled_delaunay/surface_mesh.h"
#include "base/memory.h"
#include "base/scale.h"
#include "mesh/properties.h"
#include "mesh/simplify.h"
#include "reconstruct/labeled_delaunay/vote_confidence.h"
#include <math.h>
#include <string.h>

/* The longest edge that may collapse, and how far a vertex may be from the planes of its triangles, in spacings.
 * FEWEST: the share of the triangles that is aimed at. As for the power crust, but the edges of this surface are a
 * spacing long to begin with. */
static const double LONGEST_COLLAPSE = 4, COLLAPSE_TOLERANCE = 0.1, FEWEST = 0.25;

typedef struct {
    brio_sample_surface *s;
    brio_mesh *mesh;
    uint32_t *vertex; /* #P: of each point of the caller 1 + its vertex, or 0 */
    uint32_t *rank;   /* #P: of each point of the caller its place in the order */
} filling;

/* Numbers the points that faces use in the caller's order. Returns their number. */
static size_t number_vertices(const filling *x) {
    const brio_sample_surface *s = x->s;
    uint32_t used = 0;
    for (uint32_t i = 0; i < s->num_samples; i++) x->rank[s->order[i]] = i;
    for (size_t c = 0; c < 3 * s->num_faces; c++) x->vertex[s->order[s->faces[c]]] = 1;
    for (size_t p = 0; p < s->num_points; p++)
        if (x->vertex[p]) x->vertex[p] = ++used;
    return used;
}

/* Fills the vertices: the caller's points to the last bit, unless they moved; scaled, if they will be simplified. */
static void place_vertices(const filling *x) {
    const brio_sample_surface *s = x->s;
    int exponent = s->simplify ? 0 : s->exponent;
    for (size_t p = 0; p < s->num_points; p++) {
        if (!x->vertex[p]) continue;
        const double *placed = s->placed + 3 * (size_t)x->rank[p];
        double *to = x->mesh->vertices + 3 * (size_t)(x->vertex[p] - 1);
        for (size_t k = 0; k < 3; k++)
            to[k] = s->moved || s->simplify ? ldexp(placed[k], exponent) : s->points[3 * p + k];
    }
}

static brio_status add_confidence(const filling *x) {
    float *confidence;
    void *data;
    brio_status status = brio_mesh_add_property(x->mesh, "confidence", BRIO_SCALAR_FLOAT32, &data);
    confidence = data;
    for (size_t p = 0; status == BRIO_OK && p < x->s->num_points; p++)
        if (x->vertex[p]) confidence[x->vertex[p] - 1] = x->s->confidence[x->rank[p]];
    return status;
}

/* Says of each face whether it is a bridge and, if that is asked of vertices, how sure it is. */
static brio_status add_face_properties(const filling *x) {
    brio_status status = BRIO_OK;
    const brio_sample_surface *s = x->s;
    void *bridge, *confidence;
    BRIO_TRY(brio_mesh_add_face_property(x->mesh, "bridge", BRIO_SCALAR_UINT8, &bridge));
    memcpy(bridge, s->bridge, x->mesh->num_faces);
    if (!s->confidence) return BRIO_OK;
    const float *of_vertex = brio_mesh_property(x->mesh, "confidence")->data;
    BRIO_TRY(brio_mesh_add_face_property(x->mesh, "confidence", BRIO_SCALAR_FLOAT32, &confidence));
    for (size_t f = 0; f < x->mesh->num_faces; f++) {
        float corners[3];
        for (size_t k = 0; k < 3; k++) corners[k] = of_vertex[x->mesh->face_vertices[3 * f + k]];
        ((float *)confidence)[f] = brio_face_confidence(corners, s->size[f]);
    }
done:
    return status;
}

static void take_faces(const filling *x) {
    brio_sample_surface *s = x->s;
    for (size_t c = 0; c < 3 * s->num_faces; c++) s->faces[c] = x->vertex[s->order[s->faces[c]]] - 1;
    for (size_t f = 0; f <= s->num_faces; f++) x->mesh->face_offsets[f] = 3 * f;
    x->mesh->face_vertices = s->faces;
    x->mesh->num_faces = s->num_faces;
    s->faces = NULL;
}

/* Collapses edges. Writes the sample of each vertex that is left. */
static brio_status simplify(const filling *x, uint32_t *samples) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = x->mesh;
    void *spacing, *sample;
    BRIO_TRY(brio_mesh_add_property(mesh, "sample", BRIO_SCALAR_UINT32, &sample));
    BRIO_TRY(brio_mesh_add_property(mesh, "spacing", BRIO_SCALAR_FLOAT64, &spacing));
    for (uint32_t p = 0; p < x->s->num_points; p++)
        if (x->vertex[p]) {
            ((uint32_t *)sample)[x->vertex[p] - 1] = p;
            ((double *)spacing)[x->vertex[p] - 1] = x->s->spacing[x->rank[p]];
        }
    brio_collapse_options o = {.target_faces = (size_t)(FEWEST * (double)mesh->num_faces),
                               .spacing = spacing,
                               .longest = LONGEST_COLLAPSE,
                               .embedded = true,
                               .tolerance = COLLAPSE_TOLERANCE};
    BRIO_TRY(brio_collapse_edges(mesh->context, mesh, &o));
    for (size_t v = 0; samples && v < mesh->num_vertices; v++) samples[v] = ((uint32_t *)sample)[v];
    brio_mesh_drop_properties(mesh, mesh->num_properties - 1);
    brio_mesh_drop_properties(mesh, mesh->num_properties - 1);
    BRIO_TRY(brio_scale_vertices(mesh->context, mesh->vertices, mesh->num_vertices, x->s->exponent));
done:
    return status;
}

brio_status brio_surface_mesh(brio_sample_surface *s, brio_mesh *mesh, uint32_t *samples, size_t *used) {
    brio_status status = BRIO_OK;
    brio_context *ctx = mesh->context;
    filling x = {.s = s, .mesh = mesh};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, x.vertex, s->num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, x.rank, s->num_points));
    *used = number_vertices(&x);
    BRIO_TRY(brio_mesh_set_vertices(mesh, NULL, *used));
    place_vertices(&x);
    if (s->confidence) BRIO_TRY(add_confidence(&x));
    BRIO_TRY(BRIO_ALLOC(ctx, mesh->face_offsets, s->num_faces + 1));
    take_faces(&x);
    BRIO_TRY(add_face_properties(&x));
    if (s->simplify)
        BRIO_TRY(simplify(&x, samples));
    else
        for (uint32_t p = 0; samples && p < s->num_points; p++)
            if (x.vertex[p]) samples[x.vertex[p] - 1] = p;
done:
    brio_release(ctx, x.vertex);
    brio_release(ctx, x.rank);
    return status;
}
