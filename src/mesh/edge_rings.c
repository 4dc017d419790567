/* Edges of a polygon mesh, found by sorting.
 *
 * A counting sort puts each half-edge into the bucket of the lower of its two vertices. Each bucket is sorted by
 * higher vertex, then by half-edge index. Then the half-edges of one edge are consecutive and ascending. Buckets are
 * short in ordinary surfaces, so the time is linear in practice; heapsort bounds the time of long buckets. */
#include "mesh/edge_rings.h"
#include "base/sort.h"
#include "base/team.h"

enum {
    CORNERS_A_THREAD = 1 << 17, /* for a pass that only checks, 1 ns a corner */
    FACES_A_THREAD = 1 << 14,
    BUCKETS_A_CHUNK = 1 << 10
};

typedef struct {
    const brio_mesh *mesh;
    bool sound;
} check;

/* Clears c->sound when a corner from begin to end - 1 names a vertex that does not exist. */
static void check_corners(void *user, size_t begin, size_t end, int thread) {
    check *c = user;
    bool sound = true;
    (void)thread;
    for (size_t h = begin; h < end; h++) sound = sound && c->mesh->face_vertices[h] < c->mesh->num_vertices;
    if (!sound) __atomic_store_n(&c->sound, false, __ATOMIC_RELAXED); /* read after all threads have ended */
}

brio_status brio_mesh_check_faces(brio_context *ctx, const brio_mesh *mesh) {
    const uint64_t *offsets = mesh->face_offsets;
    if (!mesh->num_faces) return BRIO_OK;
    BRIO_EXPECT(ctx, offsets[0] == 0, BRIO_ERR_ARGUMENT, "face 0: starts at corner %llu, expected 0",
                (unsigned long long)offsets[0]);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        BRIO_EXPECT(ctx, offsets[f] <= offsets[f + 1], BRIO_ERR_ARGUMENT, "face %zu: ends before it starts", f);
        if (f % BRIO_LOOK_EVERY == 0) BRIO_FORWARD(brio_look(ctx, BRIO_LOOK_EVERY));
    }
    BRIO_EXPECT(ctx, offsets[mesh->num_faces] < UINT32_MAX && mesh->num_faces < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "%zu faces with %llu corners are more than 32-bit indices can name", mesh->num_faces,
                (unsigned long long)offsets[mesh->num_faces]);
    size_t corners = (size_t)offsets[mesh->num_faces];
    check all = {mesh, true};
    BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, corners, CORNERS_A_THREAD), corners, check_corners, &all));
    for (size_t f = 0; !all.sound && f < mesh->num_faces; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++)
            BRIO_EXPECT(ctx, mesh->face_vertices[h] < mesh->num_vertices, BRIO_ERR_ARGUMENT,
                        "face %zu: vertex %u of a mesh of %zu vertices", f, mesh->face_vertices[h], mesh->num_vertices);
    return BRIO_OK;
}

typedef struct {
    uint32_t lower, higher;
} edge;

/* Returns the edge of half-edge h, in the face whose corners are first to end - 1. */
static edge edge_of(const uint32_t *corners, uint64_t first, uint64_t end, uint64_t h) {
    uint32_t u = corners[h], v = corners[h + 1 < end ? h + 1 : first];
    return u < v ? (edge){u, v} : (edge){v, u};
}

/* The half-edges as keys (higher vertex, half-edge), in buckets by lower vertex; buckets follow each other in the
 * order of vertices. */
typedef struct {
    const brio_mesh *mesh;
    uint32_t *bucket_end; /* #V */
    uint64_t *keys;       /* #corners */
    uint32_t *ring;       /* #corners */
    bool alone;           /* only one thread fills the buckets */
} buckets;

/* Adds 1 to a counter and returns the value before. Relaxed order suffices: until all threads have ended, no thread
 * reads what the counters guard. */
static inline uint32_t take_one(uint32_t *counter, bool alone) {
    return alone ? (*counter)++ : __atomic_fetch_add(counter, 1, __ATOMIC_RELAXED);
}

/* Counts the half-edges of each bucket. */
static void count_half_edges(void *user, size_t begin, size_t end, int thread) {
    const buckets *b = user;
    const uint64_t *offsets = b->mesh->face_offsets;
    (void)thread;
    for (size_t f = begin; f < end; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++)
            take_one(&b->bucket_end[edge_of(b->mesh->face_vertices, offsets[f], offsets[f + 1], h).lower], b->alone);
}

/* Puts the half-edges of faces into their buckets. The order inside a bucket depends on the threads. */
static void deal_half_edges(void *user, size_t begin, size_t end, int thread) {
    const buckets *b = user;
    const uint64_t *offsets = b->mesh->face_offsets;
    (void)thread;
    for (size_t f = begin; f < end; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
            edge e = edge_of(b->mesh->face_vertices, offsets[f], offsets[f + 1], h);
            b->keys[take_one(&b->bucket_end[e.lower], b->alone)] = (uint64_t)e.higher << 32 | h;
        }
}

/* Fills the buckets. The caller has zeroed bucket_end; afterwards bucket_end[v] is the end of the bucket of v. */
static brio_status deal_into_buckets(brio_context *ctx, buckets *b) {
    int threads = brio_threads(ctx, b->mesh->num_faces, FACES_A_THREAD);
    uint32_t start = 0;
    b->alone = threads == 1;
    BRIO_FORWARD(brio_for(ctx, threads, b->mesh->num_faces, count_half_edges, b));
    for (size_t v = 0; v < b->mesh->num_vertices; v++) {
        uint32_t count = b->bucket_end[v];
        b->bucket_end[v] = start;
        start += count;
        BRIO_FORWARD(brio_look(ctx, 1));
    }
    return brio_for(ctx, threads, b->mesh->num_faces, deal_half_edges, b);
}

/* Links each run of equal higher vertices, in the sorted keys of one bucket, into a ring. */
static void link_bucket(const uint64_t *keys, size_t count, uint32_t *ring) {
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && keys[end] >> 32 == keys[i] >> 32; end++)
            ring[(uint32_t)keys[end - 1]] = (uint32_t)keys[end];
        ring[(uint32_t)keys[end - 1]] = (uint32_t)keys[i];
    }
}

static void link_buckets(void *user, size_t begin, size_t end, int thread) {
    const buckets *b = user;
    (void)thread;
    for (size_t v = begin; v < end; v++) {
        uint32_t start = v ? b->bucket_end[v - 1] : 0, count = b->bucket_end[v] - start;
        brio_sort_keys(b->keys + start, count);
        link_bucket(b->keys + start, count, b->ring);
    }
}

brio_status brio_edge_rings(brio_context *ctx, const brio_mesh *mesh, uint32_t **ring) {
    brio_status status = BRIO_OK;
    size_t corners = mesh->num_faces ? mesh->face_offsets[mesh->num_faces] : 0;
    buckets b = {.mesh = mesh};
    *ring = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, b.bucket_end, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, b.keys, corners));
    BRIO_TRY(BRIO_ALLOC(ctx, *ring, corners));
    b.ring = *ring;
    BRIO_TRY(deal_into_buckets(ctx, &b));
    BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, mesh->num_vertices, BUCKETS_A_CHUNK), mesh->num_vertices,
                             BUCKETS_A_CHUNK, link_buckets, &b));
done:
    brio_release(ctx, b.bucket_end);
    brio_release(ctx, b.keys);
    return status;
}
