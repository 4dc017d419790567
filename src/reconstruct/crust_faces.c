/* The crust, read off the dual.
 *
 * A tetrahedron of the regular triangulation of the polar balls with both labels is a vertex of the crust (its
 * orthocentre); an edge with both labels is a face, the ring of tetrahedra round it. A triangle with both labels has
 * exactly two such edges, so each edge of the crust has two faces; a tetrahedron split one to three or two to two gives
 * one cycle round its vertex. Hull vertices are outer, so every ring closes: the crust is a closed oriented 2-manifold
 * whatever the coordinates are. It stays combinatorial: no vertices are merged, no faces dropped.
 *
 * Cutting a face into triangles by diagonals keeps all this, since two faces share at most one edge.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3. */
#include "reconstruct/crust_faces.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "predicates/circumcentre.h"
#include "reconstruct/labelling.h"
#include "surface/split_vertices.h"
#include <math.h>
#include <string.h>

typedef struct {
    const brio_pole_graph *g;
    const uint8_t *label;
    const brio_crust_options *options;
    uint32_t *number; /* of the crust vertex of each finite tetrahedron, or NO_VERTEX */
    brio_mesh *mesh;
    uint64_t *offsets;
    uint32_t *indices;
    size_t num_faces, faces_capacity, num_indices, indices_capacity;
    brio_crust_counts counts;
    uint32_t *ring;
    size_t ring_size, ring_capacity;
} builder;

enum { NO_VERTEX = UINT32_MAX };

static bool inner(const builder *b, uint32_t pole) {
    return b->label[pole] == BRIO_LABEL_INNER;
}

static void vertex_position(const builder *b, const uint32_t *v, double *position) {
    double r[4][4];
    for (int i = 0; i < 4; i++) {
        memcpy(r[i], b->g->poles->centre + 3 * (size_t)v[i], 3 * sizeof **r);
        r[i][3] = b->g->poles->square[v[i]];
    }
    if (brio_centre(r[0], r[1], r[2], r[3], true, position, NULL)) return;
    for (int k = 0; k < 3; k++) position[k] = 0.25 * r[0][k] + 0.25 * r[1][k] + 0.25 * r[2][k] + 0.25 * r[3][k];
}

/* The least of its poles': a pole that reaches far may have a sample where samples are few. */
static double vertex_spacing(const builder *b, const uint32_t *v) {
    double least = INFINITY;
    for (int i = 0; i < 4; i++) least = fmin(least, b->options->spacing[v[i]]);
    return least;
}

static brio_status add_spacing(builder *b) {
    brio_status status = BRIO_OK;
    void *data;
    BRIO_TRY(brio_mesh_add_property(b->mesh, "spacing", BRIO_FLOAT64, &data));
    double *spacing = data;
    for (size_t tet = 0; tet < b->g->num_finite; tet++)
        if (b->number[tet] != NO_VERTEX) spacing[b->number[tet]] = vertex_spacing(b, b->g->power.tet[tet].vertex);
done:
    return status;
}

static brio_status make_vertices(builder *b) {
    brio_status status = BRIO_OK;
    brio_context *ctx = b->g->ctx;
    const brio_tetrahedron *power = b->g->power.tet;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, b->number, b->g->num_finite));
    for (size_t tet = 0; tet < b->g->num_finite; tet++) {
        int inside = 0;
        for (int i = 0; i < 4; i++) inside += inner(b, power[tet].vertex[i]);
        b->number[tet] = inside % 4 ? (uint32_t)count++ : NO_VERTEX;
    }
    BRIO_TRY(brio_mesh_set_vertices(b->mesh, NULL, count));
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(ctx)))
    for (size_t tet = 0; tet < b->g->num_finite; tet++)
        if (b->number[tet] != NO_VERTEX)
            vertex_position(b, power[tet].vertex, b->mesh->vertices + 3 * (size_t)b->number[tet]);
done:
    return status;
}

/* The ring of tetrahedra round the edge from slot i to slot j of `tet`, counterclockwise seen from the far end; *leads
 * tells whether `tet` is the first of them in memory, and the ring is complete only then. */
static brio_status walk_ring(builder *b, uint32_t tet, int i, int j, bool *leads) {
    const brio_tetrahedra *t = &b->g->power;
    uint32_t from = tet, leave = t->tet[tet].vertex[BRIO_EDGE[i][j][0]], pivot = t->tet[tet].vertex[BRIO_EDGE[i][j][1]];
    b->ring_size = 0;
    *leads = false;
    do {
        brio_status status = BRIO_RESERVE(b->g->ctx, b->ring, b->ring_capacity, b->ring_size + 1);
        if (status != BRIO_OK) return status;
        b->ring[b->ring_size++] = b->number[from];
        uint32_t mate = t->tet[from].mate[brio_slot_of_vertex(t->tet[from].vertex, leave)];
        from = brio_tet_of(mate);
        if (from < tet) return BRIO_OK;
        leave = pivot;
        pivot = brio_apex(t, mate);
    } while (from != tet);
    *leads = true;
    return BRIO_OK;
}

static brio_status add_face(builder *b, const uint32_t *v, size_t n) {
    brio_context *ctx = b->g->ctx;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(ctx, b->offsets, b->faces_capacity, b->num_faces + 2));
    BRIO_TRY(BRIO_RESERVE(ctx, b->indices, b->indices_capacity, b->num_indices + n));
    memcpy(b->indices + b->num_indices, v, n * sizeof *v);
    b->num_indices += n;
    b->offsets[++b->num_faces] = b->num_indices;
done:
    return status;
}

static brio_status add_ring(builder *b) {
    brio_status status = BRIO_OK;
    b->counts.faces++;
    if (!b->options->triangulate) return add_face(b, b->ring, b->ring_size);
    for (size_t i = 1; i + 1 < b->ring_size; i++) {
        uint32_t triangle[3] = {b->ring[0], b->ring[i], b->ring[i + 1]};
        BRIO_TRY(add_face(b, triangle, 3));
    }
done:
    return status;
}

/* A pair of large balls that intersect deeply: no sample is where they meet. Deep is what well sampled surfaces do not
 * have, an angle over pi / 4 [Choi 2003, lemma 38]. */
static bool spans_hole(const builder *b, uint32_t p, uint32_t q) {
    if (!(b->options->open > 0) || !(brio_pole_graph_weight(b->g, p, q) > BRIO_THEORETICAL_WEIGHT)) return false;
    double limit = b->options->open * fmax(b->options->spacing[p], b->options->spacing[q]);
    return fmin(b->g->poles->square[p], b->g->poles->square[q]) > limit * limit;
}

static brio_status add_face_between(builder *b, uint32_t tet, int i, int j) {
    const uint32_t *v = b->g->power.tet[tet].vertex;
    bool leads;
    brio_status status = walk_ring(b, tet, i, j, &leads);
    if (status != BRIO_OK || !leads) return status;
    if (!spans_hole(b, v[i], v[j])) return add_ring(b);
    b->counts.left_out++;
    return BRIO_OK;
}

static brio_status make_faces(builder *b) {
    brio_status status = BRIO_OK;
    const brio_tetrahedron *power = b->g->power.tet;
    BRIO_TRY(BRIO_RESERVE(b->g->ctx, b->offsets, b->faces_capacity, 1));
    b->offsets[0] = 0;
    for (size_t tet = 0; tet < b->g->num_finite; tet++) {
        if (b->number[tet] == NO_VERTEX) continue;
        if (tet % 65536 == 0) BRIO_TRY(brio_progress(b->g->ctx, "crust", (double)tet / (double)b->g->num_finite));
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                if (inner(b, power[tet].vertex[i]) && !inner(b, power[tet].vertex[j]))
                    BRIO_TRY(add_face_between(b, (uint32_t)tet, i, j));
    }
done:
    return status;
}

brio_status brio_crust_faces(const brio_pole_graph *g, const uint8_t *label, const brio_crust_options *options,
                             brio_mesh *mesh, brio_crust_counts *counts) {
    brio_status status = BRIO_OK;
    builder b = {.g = g, .label = label, .options = options, .mesh = mesh};
    BRIO_TRY(make_vertices(&b));
    BRIO_REQUIRE(g->ctx, mesh->num_vertices > 0, BRIO_ERR_NO_ANSWER, "no inside found: no pole with a cell is inner");
    if (options->spacing) BRIO_TRY(add_spacing(&b));
    BRIO_TRY(make_faces(&b));
    BRIO_REQUIRE(g->ctx, b.num_faces > 0, BRIO_ERR_NO_ANSWER, "no surface is left: all faces span holes");
    BRIO_TRY(brio_mesh_set_faces(mesh, b.offsets, b.indices, b.num_faces));
    if (b.counts.left_out) BRIO_TRY(brio_mesh_split_vertices(g->ctx, mesh));
    *counts = b.counts;
done:
    brio_release(g->ctx, b.number);
    brio_release(g->ctx, b.offsets);
    brio_release(g->ctx, b.indices);
    brio_release(g->ctx, b.ring);
    return status;
}
