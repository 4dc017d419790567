/* The certificate of a polygon mesh: what connectivity alone proves about a surface. Components, fans and loops are
 * those of topology.h; an odd 2 - chi - loops, as of a Moebius strip, is rounded down. Areas and volumes are summed in
 * fixed parts, so that they do not depend on the threads. */
#include "base/float_state.h"
#include "base/scale.h"
#include "base/team.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "certificate/topology.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include <math.h>

/* Corners: a pass takes 1 to 25 ns each. */
enum { CORNERS_A_THREAD = 1 << 15 };

/* --- components --- */

/* Corrects what was counted twice: several fans of one vertex in one component count as one vertex. */
static brio_status recount_pinched_vertices(const brio_topology *t, const uint32_t *number,
                                            brio_component *components) {
    uint64_t *fans = NULL;
    size_t count;
    brio_status status = brio_topology_pinched(t, number, &fans, &count);
    for (size_t i = 1; status == BRIO_OK && i < count; i++)
        if (fans[i] == fans[i - 1]) components[(uint32_t)fans[i]].vertices--;
    brio_release(t->ctx, fans);
    return status;
}

static brio_status count_loops(const brio_topology *t, const uint32_t *number, brio_component *components) {
    brio_status status = BRIO_OK;
    uint8_t *counted = NULL; /* 1 at a root whose loop has been counted */
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, counted, t->corners));
    BRIO_TRY(brio_topology_join_loops(t));
    for (uint32_t h = 0; h < t->corners; h++) {
        BRIO_TRY(brio_look(t->ctx, 1));
        if (t->ring[h] != h) continue;
        uint32_t root = brio_find(t->fan, h);
        if (!counted[root]) components[number[brio_face_at(t, h)]].loops++;
        counted[root] = 1;
    }
done:
    brio_release(t->ctx, counted);
    return status;
}

static brio_status certify_components(const brio_topology *t, brio_certificate *out) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL;
    brio_component *components = NULL;
    size_t count;
    bool pinched;
    BRIO_TRY(BRIO_ALLOC(t->ctx, number, t->mesh->num_faces));
    BRIO_TRY(brio_topology_patches(t, number, &count));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, components, count));
    BRIO_TRY(brio_topology_count_faces(t, number, components));
    BRIO_TRY(brio_topology_count(t, number, components, NULL, &pinched));
    if (pinched) BRIO_TRY(recount_pinched_vertices(t, number, components));
    if (out->boundary_edges) BRIO_TRY(count_loops(t, number, components));
    BRIO_TRY(brio_components_list(t->ctx, components, count, out));
done:
    brio_release(t->ctx, components);
    brio_release(t->ctx, number);
    return status;
}

static brio_status certify_topology(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    brio_status status = BRIO_OK;
    brio_topology t = {0};
    brio_edge_faults edges;
    size_t degenerate_faces, thin_faces;
    BRIO_TRY(brio_topology_new(ctx, mesh, NULL, NULL, &t));
    BRIO_TRY(brio_topology_degenerate(&t, &degenerate_faces, &thin_faces));
    BRIO_TRY(brio_topology_join(&t, &edges));
    out->boundary_edges = edges.boundary;
    out->nonmanifold_edges = edges.nonmanifold;
    out->flipped_edges = edges.flipped;
    BRIO_TRY(certify_components(&t, out));
    BRIO_TRY(brio_topology_bad_vertices(&t, &out->nonmanifold_vertices));
    out->closed = t.corners > 0 && !out->boundary_edges && !out->nonmanifold_edges && !thin_faces;
    out->manifold = !out->nonmanifold_edges && !out->nonmanifold_vertices && !degenerate_faces;
    out->oriented = !out->flipped_edges;
done:
    brio_topology_free(&t);
    return status;
}

/* --- measure --- */

enum {
    PARTS = 256
}; /* parts of the faces; a fixed number, so that rounding does not depend on the number of threads */

typedef struct {
    double low[3], high[3], area, volume;
} measure;

typedef struct {
    const brio_mesh *mesh;
    double centre[3], scale; /* the centre is scaled, too */
    measure part[PARTS];
} measures;

static void box_of_part(const brio_mesh *mesh, int part, measure *m) {
    uint64_t corners = mesh->face_offsets[mesh->num_faces];
    for (int k = 0; k < 3; k++) m->low[k] = INFINITY, m->high[k] = -INFINITY;
    brio_box_add_corners(mesh, brio_part(corners, part, PARTS), brio_part(corners, part + 1, PARTS), m->low, m->high);
}

static void scale_vertex(const measures *all, uint32_t vertex, double *x) {
    for (size_t k = 0; k < 3; k++) x[k] = all->mesh->vertices[3 * (size_t)vertex + k] * all->scale;
}

/* Adds the area and volume of a face, scaled, cut into a fan of triangles from its first corner. */
static void measure_face(const measures *all, size_t f, measure *m) {
    const brio_mesh *mesh = all->mesh;
    const uint32_t *corners = mesh->face_vertices + mesh->face_offsets[f];
    const double *centre = all->centre;
    uint64_t count = mesh->face_offsets[f + 1] - mesh->face_offsets[f];
    for (uint64_t i = 2; i < count; i++) {
        double a[3], b[3], c[3];
        scale_vertex(all, corners[0], a);
        scale_vertex(all, corners[i - 1], b);
        scale_vertex(all, corners[i], c);
        double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        m->area += brio_length(n) / 2;
        m->volume += ((a[0] - centre[0]) * n[0] + (a[1] - centre[1]) * n[1] + (a[2] - centre[2]) * n[2]) / 6;
    }
}

static void find_boxes(void *user, size_t begin, size_t end, int thread) {
    measures *m = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) box_of_part(m->mesh, (int)i, &m->part[i]);
}

static void measure_parts(void *user, size_t begin, size_t end, int thread) {
    measures *m = user;
    size_t num_faces = m->mesh->num_faces;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        for (size_t f = brio_part(num_faces, (int)i, PARTS); f < brio_part(num_faces, (int)i + 1, PARTS); f++)
            measure_face(m, f, &m->part[i]);
}

/* Sums area and volume. Volumes are relative to the centre of the box of the used vertices, so that a surface far from
 * the origin loses no digits. */
static brio_status measure_faces(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    measures m = {.mesh = mesh};
    if (!mesh->num_faces || !mesh->face_offsets[mesh->num_faces]) return BRIO_OK;
    int threads = brio_threads(ctx, (size_t)mesh->face_offsets[mesh->num_faces], CORNERS_A_THREAD);
    BRIO_FORWARD(brio_for_chunks(ctx, threads, PARTS, 1, find_boxes, &m));
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < 3 * PARTS; i++) {
        low[i % 3] = fmin(low[i % 3], m.part[i / 3].low[i % 3]);
        high[i % 3] = fmax(high[i % 3], m.part[i / 3].high[i % 3]);
    }
    int exponent = brio_box_exponent(low, high); /* so that no square overflows or underflows */
    m.scale = brio_power_of_two(-exponent);
    for (int k = 0; k < 3; k++) m.centre[k] = (0.5 * low[k] + 0.5 * high[k]) * m.scale;
    BRIO_FORWARD(brio_for_chunks(ctx, threads, PARTS, 1, measure_parts, &m));
    for (int i = 0; i < PARTS; i++) out->area += m.part[i].area, out->volume += m.part[i].volume;
    out->area = ldexp(out->area, 2 * exponent);
    out->volume = ldexp(out->volume, 3 * exponent);
    return BRIO_OK;
}

brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_certificate c = {.size = sizeof c, .self_intersections = -1, .context = ctx};
    BRIO_TRY(BRIO_CHECK_OWNER(ctx, brio_certificate, out, genera));
    BRIO_GIVE(brio_certificate, out, &(brio_certificate){0});
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(certify_topology(ctx, mesh, &c));
    BRIO_TRY(measure_faces(ctx, mesh, &c));
    BRIO_GIVE(brio_certificate, out, &c);
done:
    if (status != BRIO_OK) brio_certificate_free(&c);
    return status;
}

void brio_certificate_free(brio_certificate *certificate) {
    if (!certificate || !BRIO_OWNS(brio_certificate, certificate, genera) || !certificate->context) return;
    brio_release(certificate->context, certificate->genera);
    BRIO_GIVE(brio_certificate, certificate, &(brio_certificate){0});
}
