/* The crust, read off the dual of the power diagram.
 *
 * A tetrahedron of the regular triangulation of the polar balls with both labels is a vertex of the crust, at its
 * orthocentre. An edge with both labels is a face; its corners are the tetrahedra of the ring round the edge. A
 * triangle with both labels has exactly two such edges, so each edge of the crust has two faces. A tetrahedron has its
 * labels split one to three or two to two, and either way its faces make one cycle round the vertex. Hull vertices are
 * outer, so every ring closes. So the crust is a closed oriented 2-manifold whatever the coordinates are: no vertices
 * are merged, and no faces are dropped.
 *
 * A face belongs to the first tetrahedron of its ring. Each block of tetrahedra lists its faces. Then the faces are
 * copied, each block after the blocks before it, so that the result does not depend on the threads.
 *
 * Diagonals that cut a face into triangles keep all this, because two faces share at most one edge.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3. */
#include "reconstruct/power_crust/crust_faces.h"
#include "base/memory.h"
#include "base/team.h"
#include "mesh/split_vertices.h"
#include "predicates/circumcentre.h"
#include "reconstruct/labels/labeling.h"
#include "reconstruct/power_crust/crust_positions.h"
#include "reconstruct/power_crust/fan_start.h"
#include "triangulation/ring.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* BLOCK: tetrahedra in a block. AHEAD: the neighbours of the tetrahedron this far ahead are prefetched. Both chosen. */
enum { NO_VERTEX = UINT32_MAX, BLOCK = 1 << 13, AHEAD = 8 };

/* Counts of a block of tetrahedra; after sum_blocks, the counts of all blocks before it. */
typedef struct {
    size_t vertices, faces, corners, rings, left_out;
} block_counts;

/* The faces of a block. Each face is its number of corners, then the corners. */
typedef struct {
    uint32_t *entry;
    size_t count, capacity;
} face_list;

typedef struct {
    const brio_power_diagram *d;
    int threads;
    const uint8_t *label;
    const brio_crust_options *options;
    uint32_t *number; /* #finite tetrahedra: the crust vertex of each, or NO_VERTEX */
    brio_mesh *mesh;
    block_counts *blocks; /* num_blocks + 1 */
    face_list *lists;     /* num_blocks */
    size_t num_blocks;
    brio_status status; /* the first failure that a thread reported */
} builder;

/* Returns the first tetrahedron of a block. Loops over blocks call their functions with one block at a time. */
static size_t block_begin(const builder *b, size_t block) {
    return block < b->num_blocks ? block * BLOCK : b->d->num_finite;
}

/* --- vertices --- */

static bool inner(const builder *b, uint32_t pole) {
    return b->label[pole] == BRIO_LABEL_INNER;
}

/* Returns the least spacing of four poles. A pole with a large ball may have a sample where samples are few. */
static double vertex_spacing(const builder *b, const uint32_t *v) {
    double least = INFINITY;
    for (int i = 0; i < 4; i++) least = fmin(least, b->options->spacing[v[i]]);
    return least;
}

static brio_status add_spacing(builder *b) {
    brio_status status = BRIO_OK;
    void *data;
    BRIO_TRY(brio_mesh_add_property(b->mesh, "spacing", BRIO_SCALAR_FLOAT64, &data));
    double *spacing = data;
    for (size_t tet = 0; tet < b->d->num_finite; tet++)
        if (b->number[tet] != NO_VERTEX) spacing[b->number[tet]] = vertex_spacing(b, b->d->power.tet[tet].vertex);
done:
    return status;
}

static void count_vertices(void *user, size_t block, size_t end_block, int thread) {
    const builder *b = user;
    (void)end_block, (void)thread;
    for (size_t tet = block_begin(b, block); tet < block_begin(b, block + 1); tet++) {
        int inside = 0;
        for (int i = 0; i < 4; i++) inside += inner(b, b->d->power.tet[tet].vertex[i]);
        b->number[tet] = inside % 4 ? 0 : NO_VERTEX;
        b->blocks[block].vertices += inside % 4 != 0;
    }
}

static void fill_vertices(void *user, size_t block, size_t end_block, int thread) {
    const builder *b = user;
    (void)end_block, (void)thread;
    size_t next = b->blocks[block].vertices, end = block_begin(b, block + 1), waiting = 0;
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    for (size_t tet = block_begin(b, block); tet < end; tet++) {
        if (b->number[tet] == NO_VERTEX) continue;
        b->number[tet] = (uint32_t)next++;
        memcpy(vertex[waiting++], b->d->power.tet[tet].vertex, sizeof *vertex);
        if (waiting < BRIO_CENTRE_BATCH) continue;
        brio_crust_positions(b->d, (const uint32_t(*)[4])vertex, waiting, b->mesh->vertices + 3 * (next - waiting));
        waiting = 0;
    }
    brio_crust_positions(b->d, (const uint32_t(*)[4])vertex, waiting, b->mesh->vertices + 3 * (next - waiting));
}

/* Replaces the counts of each block by the sums over the blocks before it. The entry after the last block is the
 * total. */
static void sum_blocks(builder *b) {
    block_counts sum = {0, 0, 0, 0, 0};
    for (size_t i = 0; i <= b->num_blocks; i++) {
        block_counts own = b->blocks[i];
        b->blocks[i] = sum;
        sum.vertices += own.vertices;
        sum.faces += own.faces;
        sum.corners += own.corners;
        sum.rings += own.rings;
        sum.left_out += own.left_out;
    }
}

static brio_status make_vertices(builder *b) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_for_chunks(b->mesh->context, b->threads, b->num_blocks, 1, count_vertices, b));
    sum_blocks(b);
    BRIO_TRY(brio_mesh_set_vertices(b->mesh, NULL, b->blocks[b->num_blocks].vertices));
    BRIO_TRY(brio_for_chunks(b->mesh->context, b->threads, b->num_blocks, 1, fill_vertices, b));
    memset(b->blocks, 0, (b->num_blocks + 1) * sizeof *b->blocks);
done:
    return status;
}

/* --- faces --- */

/* Returns whether the face between two poles spans a hole: both balls are large and intersect at more than pi / 4. In
 * dense samples an inner and an outer ball do not intersect that deeply [Choi 2003, lemma 38]. */
static bool spans_hole(const builder *b, uint32_t p, uint32_t q) {
    if (!(b->options->open > 0) || !(brio_ball_weight(b->d->poles, p, q) > BRIO_DEEP_WEIGHT)) return false;
    double limit = b->options->open * fmax(b->options->spacing[p], b->options->spacing[q]);
    return fmin(b->d->poles->square[p], b->d->poles->square[q]) > limit * limit;
}

static brio_status push_corner(const builder *b, face_list *list, size_t n, uint32_t tet) {
    brio_status status = BRIO_RESERVE(b->mesh->context, list->entry, list->capacity, n + 1);
    if (status == BRIO_OK) list->entry[n] = b->number[tet];
    return status;
}

/* Writes the corners round the edge from slot i to slot j behind the end of the list. *size is their number, or 0 if
 * another tetrahedron is the first in the ring. */
static brio_status find_corners(const builder *b, uint32_t tet, int i, int j, face_list *list, size_t *size) {
    size_t n = list->count + 1;
    brio_status status = BRIO_OK;
    brio_ring r = brio_ring_second(&b->d->power, tet, i, j);
    *size = 0;
    BRIO_TRY(push_corner(b, list, n++, tet));
    do {
        if (r.tet < tet) return BRIO_OK;
        BRIO_TRY(push_corner(b, list, n++, r.tet));
    } while (brio_ring_next(&r));
    *size = n - list->count - 1;
done:
    return status;
}

/* Turns the corners of the face between the inner pole p and the outer pole q to where its fan of triangles starts. */
static void turn_to_fan_start(const builder *b, uint32_t p, uint32_t q, uint32_t *corner, size_t size) {
    const double *inside = b->d->poles->centre + 3 * (size_t)p, *outside = b->d->poles->centre + 3 * (size_t)q;
    double normal[3];
    for (int k = 0; k < 3; k++) normal[k] = outside[k] - inside[k];
    brio_turn_to_fan_start(b->mesh->vertices, corner, size, normal);
}

static brio_status list_face(const builder *b, uint32_t tet, int i, int j, face_list *list, block_counts *counts) {
    const uint32_t *v = b->d->power.tet[tet].vertex;
    size_t size;
    if (!brio_ring_may_lead(&b->d->power, tet, i, j)) return BRIO_OK;
    brio_status status = find_corners(b, tet, i, j, list, &size);
    if (status != BRIO_OK || !size) return status;
    if (spans_hole(b, v[i], v[j])) {
        counts->left_out++;
        return BRIO_OK;
    }
    turn_to_fan_start(b, v[i], v[j], list->entry + list->count + 1, size);
    list->entry[list->count] = (uint32_t)size;
    list->count += size + 1;
    counts->rings++;
    counts->faces += b->options->triangulate ? size - 2 : 1;
    counts->corners += b->options->triangulate ? 3 * (size - 2) : size;
    return BRIO_OK;
}

static brio_status list_faces(const builder *b, size_t block) {
    brio_status status = BRIO_OK;
    block_counts counts = {0, 0, 0, 0, 0};
    size_t end = block_begin(b, block + 1);
    for (size_t tet = block_begin(b, block); tet < end; tet++) {
        bool inside[4];
        if (tet + AHEAD < end && b->number[tet + AHEAD] != NO_VERTEX) brio_ring_fetch(&b->d->power, tet + AHEAD);
        if (b->number[tet] == NO_VERTEX) continue;
        for (int i = 0; i < 4; i++) inside[i] = inner(b, b->d->power.tet[tet].vertex[i]);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                if (inside[i] && !inside[j]) BRIO_TRY(list_face(b, (uint32_t)tet, i, j, &b->lists[block], &counts));
    }
    b->blocks[block] = counts;
done:
    return status;
}

static void list_block(void *user, size_t block, size_t end_block, int thread) {
    builder *b = user;
    (void)end_block, (void)thread;
    brio_report(&b->status, list_faces(b, block));
}

/* The place where the next face of a block goes. */
typedef struct {
    uint32_t *corner;
    uint64_t *end; /* where the face's end goes in face_offsets */
    uint64_t corners;
} cursor;

static void end_face(cursor *c, size_t size) {
    c->corner += size;
    c->corners += size;
    *c->end++ = c->corners;
}

static void copy_triangles(const uint32_t *corner, size_t size, cursor *c) {
    for (size_t i = 2; i < size; i++) {
        c->corner[0] = corner[0], c->corner[1] = corner[i - 1], c->corner[2] = corner[i];
        end_face(c, 3);
    }
}

static void copy_faces(void *user, size_t block, size_t end_block, int thread) {
    const builder *b = user;
    (void)end_block, (void)thread;
    const block_counts *at = &b->blocks[block];
    const face_list *list = &b->lists[block];
    cursor c = {b->mesh->face_vertices + at->corners, b->mesh->face_offsets + at->faces + 1, at->corners};
    for (size_t n = 0, size; n < list->count; n += size + 1) {
        const uint32_t *corner = list->entry + n + 1;
        size = list->entry[n];
        if (b->options->triangulate) {
            copy_triangles(corner, size, &c);
        } else {
            memcpy(c.corner, corner, size * sizeof *corner);
            end_face(&c, size);
        }
    }
}

static brio_status make_faces(builder *b) {
    brio_status status = BRIO_OK;
    brio_context *ctx = b->mesh->context;
    brio_mesh *m = b->mesh;
    BRIO_TRY(brio_progress(ctx, "crust", 0.4));
    BRIO_TRY(brio_for_chunks(ctx, b->threads, b->num_blocks, 1, list_block, b));
    BRIO_TRY(b->status);
    sum_blocks(b);
    const block_counts *total = &b->blocks[b->num_blocks];
    BRIO_REQUIRE(ctx, total->faces > 0, BRIO_BECAUSE(ctx, ALL_HOLES, BRIO_ERR_NO_ANSWER),
                 "no surface is left: all faces span holes");
    BRIO_TRY(brio_progress(ctx, "crust", 0.8));
    BRIO_TRY(BRIO_ALLOC(ctx, m->face_offsets, total->faces + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, m->face_vertices, total->corners));
    m->face_offsets[0] = 0;
    m->num_faces = total->faces;
    BRIO_TRY(brio_for_chunks(b->mesh->context, b->threads, b->num_blocks, 1, copy_faces, b));
done:
    return status;
}

#ifndef NDEBUG
/* Returns whether every pole has a label and every pole on the hull of the triangulation is outer. Then every face
 * between an inner and an outer cell is bounded, and the crust closes. */
static bool labels_close(const brio_power_diagram *d, const uint8_t *label) {
    for (size_t p = 0; p < d->poles->count; p++)
        if (label[p] != BRIO_LABEL_INNER && label[p] != BRIO_LABEL_OUTER) return false;
    for (size_t tet = d->num_finite; tet < d->power.count; tet++)
        for (int i = 0; i < 3; i++)
            if (label[d->power.tet[tet].vertex[i]] != BRIO_LABEL_OUTER) return false;
    return true;
}
#endif

brio_status brio_crust_faces(const brio_power_diagram *d, const uint8_t *label, const brio_crust_options *options,
                             brio_mesh *mesh, brio_crust_counts *counts) {
    brio_status status = BRIO_OK;
    brio_context *ctx = mesh->context;
    builder b = {.d = d, .label = label, .options = options, .mesh = mesh};
    assert(labels_close(d, label));
    b.num_blocks = (d->num_finite + BLOCK - 1) / BLOCK;
    b.threads = brio_threads(ctx, b.num_blocks, 1);
    BRIO_TRY(BRIO_ALLOC(ctx, b.number, d->num_finite));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, b.blocks, b.num_blocks + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, b.lists, b.num_blocks));
    BRIO_TRY(make_vertices(&b));
    BRIO_REQUIRE(ctx, mesh->num_vertices > 0, BRIO_BECAUSE(ctx, NO_INSIDE, BRIO_ERR_NO_ANSWER),
                 "no inside found: no pole with a cell is inner");
    if (options->spacing) BRIO_TRY(add_spacing(&b));
    BRIO_TRY(make_faces(&b));
    *counts = (brio_crust_counts){b.blocks[b.num_blocks].rings, b.blocks[b.num_blocks].left_out};
    if (counts->left_out) BRIO_TRY(brio_mesh_split_vertices(ctx, mesh));
done:
    brio_release(ctx, b.number);
    for (size_t i = 0; b.lists && i < b.num_blocks; i++) brio_release(ctx, b.lists[i].entry);
    brio_release(ctx, b.lists);
    brio_release(ctx, b.blocks);
    return status;
}
