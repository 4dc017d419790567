/* Edges of a polygon mesh, found by sorting.
 *
 * The half-edges are dealt into one bucket for each vertex, by the lower of their two vertices (a counting sort);
 * inside a bucket they are sorted by the higher vertex and then by their own index. Half-edges of one edge are then
 * neighbours, in ascending order. Buckets are short in any surface worth the name, so this is linear in practice;
 * heapsort bounds the buckets of the others. */
#include "surface/edge_rings.h"
#include "base/parallel.h"
#include "base/sort.h"

brio_status brio_mesh_check_faces(brio_context *ctx, const brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    const uint64_t *offsets = mesh->face_offsets;
    if (!mesh->num_faces) return BRIO_OK;
    BRIO_REQUIRE(ctx, offsets[0] == 0, BRIO_ERR_ARGUMENT, "face 0: starts at corner %llu, expected 0",
                 (unsigned long long)offsets[0]);
    for (size_t f = 0; f < mesh->num_faces; f++)
        BRIO_REQUIRE(ctx, offsets[f] <= offsets[f + 1], BRIO_ERR_ARGUMENT, "face %zu: ends before it starts", f);
    BRIO_REQUIRE(ctx, offsets[mesh->num_faces] < UINT32_MAX && mesh->num_faces < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                 "%zu faces with %llu corners are more than 32-bit indices can name", mesh->num_faces,
                 (unsigned long long)offsets[mesh->num_faces]);
    bool sound = true;
    BRIO_OMP(parallel for num_threads(brio_context_threads(ctx)) reduction(&& : sound))
    for (uint64_t h = 0; h < offsets[mesh->num_faces]; h++)
        sound = sound && mesh->face_vertices[h] < mesh->num_vertices;
    for (size_t f = 0; !sound && f < mesh->num_faces; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++)
            BRIO_REQUIRE(ctx, mesh->face_vertices[h] < mesh->num_vertices, BRIO_ERR_ARGUMENT,
                         "face %zu: vertex %u of a mesh of %zu vertices", f, mesh->face_vertices[h],
                         mesh->num_vertices);
done:
    return status;
}

typedef struct {
    uint32_t lower, higher;
} edge;

/* The edge of half-edge h of the face with corners first to end. */
static edge edge_of(const uint32_t *corners, uint64_t first, uint64_t end, uint64_t h) {
    uint32_t u = corners[h], v = corners[h + 1 < end ? h + 1 : first];
    return u < v ? (edge){u, v} : (edge){v, u};
}

/* Half-edges as keys (higher vertex, half-edge), the bucket of each lower vertex after that of the one before; in a
 * bucket the order is left to the threads.
 * bucket_end  #V, zeroed. */
static void deal_into_buckets(const brio_mesh *mesh, int threads, uint32_t *bucket_end, uint64_t *keys) {
    const uint64_t *offsets = mesh->face_offsets;
    BRIO_OMP(parallel for num_threads(threads))
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
            uint32_t *count = &bucket_end[edge_of(mesh->face_vertices, offsets[f], offsets[f + 1], h).lower];
            if (threads == 1)
                ++*count;
            else
                __atomic_fetch_add(count, 1, __ATOMIC_RELAXED);
        }
    uint32_t start = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        uint32_t count = bucket_end[v];
        bucket_end[v] = start;
        start += count;
    }
    BRIO_OMP(parallel for num_threads(threads))
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) {
            edge e = edge_of(mesh->face_vertices, offsets[f], offsets[f + 1], h);
            uint32_t *end = &bucket_end[e.lower];
            uint32_t at = threads == 1 ? (*end)++ : __atomic_fetch_add(end, 1, __ATOMIC_RELAXED);
            keys[at] = (uint64_t)e.higher << 32 | h;
        }
}

/* Links each run of equal higher vertices among the sorted keys of one bucket. */
static void link_bucket(const uint64_t *keys, size_t count, uint32_t *ring) {
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && keys[end] >> 32 == keys[i] >> 32; end++)
            ring[(uint32_t)keys[end - 1]] = (uint32_t)keys[end];
        ring[(uint32_t)keys[end - 1]] = (uint32_t)keys[i];
    }
}

brio_status brio_edge_rings(brio_context *ctx, const brio_mesh *mesh, uint32_t **ring) {
    brio_status status = BRIO_OK;
    size_t corners = mesh->num_faces ? mesh->face_offsets[mesh->num_faces] : 0;
    uint32_t *bucket_end = NULL;
    uint64_t *keys = NULL;
    *ring = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, bucket_end, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, keys, corners));
    BRIO_TRY(BRIO_ALLOC(ctx, *ring, corners));
    int threads = brio_context_threads(ctx);
    deal_into_buckets(mesh, threads, bucket_end, keys);
    BRIO_OMP(parallel for schedule(dynamic, 4096) num_threads(threads))
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        uint32_t start = v ? bucket_end[v - 1] : 0;
        brio_sort_keys(keys + start, bucket_end[v] - start);
        link_bucket(keys + start, bucket_end[v] - start, *ring);
    }
done:
    brio_release(ctx, bucket_end);
    brio_release(ctx, keys);
    return status;
}
