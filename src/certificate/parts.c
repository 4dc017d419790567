/* The certificate of a surface whose faces come in parts, none of which is kept.
 *
 * A part counts what its unshared vertices have, and writes the faces at shared ones to buckets by their indices. When
 * all parts have come, bucket after bucket is read. A bucket has all faces at its vertices, and counts the same. So a
 * vertex has one owner, a part or a bucket. What one owner alone cannot know is left open: whether fans of one vertex
 * that are in two patches are in one component in the end, and which pieces of boundary loops are one. A patch is
 * known to be one component with another when an owner sees a face of each at one edge.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988. */
#include "certificate/parts.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/rng.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include <string.h>

enum { BUCKETS = 64, MOST_BUCKETS = 1 << 16, FACES_A_THREAD = 1 << 14 };

/* --- life --- */

static brio_status take_box(brio_parts_certificate *c, const brio_parts_options *o) {
    bool given = false;
    for (int k = 0; k < 3; k++) {
        BRIO_EXPECT(c->ctx, isfinite(o->low[k]) && isfinite(o->high[k]) && o->low[k] <= o->high[k], BRIO_ERR_ARGUMENT,
                    "the box of the surface from %g to %g has no room", o->low[k], o->high[k]);
        given |= o->low[k] != 0 || o->high[k] != 0;
    }
    c->exponent = given ? brio_box_exponent(o->low, o->high) : 0;
    c->scale = brio_power_of_two(-c->exponent);
    for (int k = 0; k < 3; k++) c->centre[k] = (0.5 * o->low[k] + 0.5 * o->high[k]) * c->scale;
    return BRIO_OK;
}

brio_status brio_parts_certificate_new(brio_context *ctx, const brio_parts_options *options,
                                       brio_parts_certificate **out) {
    BRIO_DOOR;
    brio_parts_options o = {0};
    brio_parts_certificate *c = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_parts_options, options, &o));
    BRIO_REQUIRE(ctx, o.scratch, BRIO_ERR_ARGUMENT, "a certificate of parts needs a scratch folder");
    BRIO_REQUIRE(ctx, o.buckets <= MOST_BUCKETS, BRIO_ERR_ARGUMENT, "%u buckets; at most %d", o.buckets, MOST_BUCKETS);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, c, 1));
    c->ctx = ctx;
    c->folder.lock = -1;
    c->buckets = o.buckets ? o.buckets : BUCKETS;
    c->sheets = o.sheets != 0;
    BRIO_TRY(take_box(c, &o));
    BRIO_TRY(brio_store_begin_free(ctx, o.scratch, "brio-faces", &c->folder));
    BRIO_TRY(brio_row_files_open(&c->folder, "faces", c->buckets, &c->faces));
    BRIO_TRY(brio_row_files_open(&c->folder, "pinched", c->buckets, &c->pinched));
    BRIO_TRY(
        brio_row_files_open(&c->folder, c->sheets ? "knots" : "ends", c->buckets, c->sheets ? &c->knots : &c->ends));
    *out = c;
    c = NULL;
done:
    brio_parts_certificate_free(c);
    return status;
}

static void free_sets(brio_context *ctx, brio_open_sets *s) {
    brio_release(ctx, s->parent);
    brio_release(ctx, s->patch);
}

void brio_parts_certificate_free(brio_parts_certificate *c) {
    if (!c) return;
    brio_row_files_close(&c->faces);
    brio_row_files_close(&c->pinched);
    brio_row_files_close(&c->ends);
    brio_row_files_close(&c->knots);
    brio_store_end(&c->folder);
    brio_release(c->ctx, c->component);
    brio_release(c->ctx, c->parent);
    free_sets(c->ctx, &c->loops);
    free_sets(c->ctx, &c->fans);
    brio_release(c->ctx, c);
}

/* --- what is joined later --- */

brio_status brio_open_sets_add(brio_context *ctx, brio_open_sets *s, uint32_t patch, uint32_t *set) {
    BRIO_EXPECT(ctx, s->count < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "2^32 places where parts of a surface meet: take larger "
                "parts");
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->parent, s->parents, s->count + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->patch, s->patches, s->count + 1));
    *set = (uint32_t)s->count++;
    s->parent[*set] = *set;
    s->patch[*set] = patch;
    return BRIO_OK;
}

/* Appends patches without counts. */
static brio_status add_patches(brio_parts_certificate *c, size_t count) {
    BRIO_EXPECT(c->ctx, count < UINT32_MAX - c->count, BRIO_ERR_TOO_LARGE, "2^32 patches of a surface in parts");
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->component, c->components, c->count + count));
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->parent, c->parents, c->count + count));
    for (size_t i = c->count; i < c->count + count; i++) {
        c->component[i] = (brio_component){0, 0, 0, 0};
        c->parent[i] = (uint32_t)i;
    }
    c->count += count;
    return BRIO_OK;
}

uint32_t brio_bucket_of_edge(const brio_parts_certificate *c, const uint64_t edge[2]) {
    return (uint32_t)(brio_mix(edge[0] ^ brio_mix(edge[1])) % c->buckets);
}

static uint32_t bucket_of(const brio_parts_certificate *c, uint64_t index) {
    return (uint32_t)(brio_mix(index) % c->buckets);
}

/* --- counts at own vertices --- */

/* Counts once the fans of a vertex that are in one patch. Those of several patches may be in one component in the end,
 * so they are written. */
static brio_status settle_pinched(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t) {
    uint64_t *fans = NULL;
    size_t count;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_topology_pinched(t, o->patch, &fans, &count));
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && fans[end] >> 32 == fans[i] >> 32; end++) {}
        bool one = fans[i] == fans[end - 1];
        for (size_t k = i; k < end; k++) {
            const brio_pinched_row row = {o->index[fans[k] >> 32], (uint32_t)fans[k]};
            if (k > i && fans[k] == fans[k - 1])
                c->component[row.patch].vertices--;
            else if (!one)
                BRIO_TRY(brio_row_files_put(&c->pinched, bucket_of(c, row.index), &row, sizeof row));
        }
        BRIO_TRY(brio_look(c->ctx, end - i));
    }
done:
    brio_release(c->ctx, fans);
    return status;
}

/* Writes the other end of a boundary edge that leaves the own vertices.   set  of each root, or UINT32_MAX. */
static brio_status leave_open(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t, uint32_t h,
                              uint32_t *set) {
    const uint32_t *v = t->mesh->face_vertices, next = brio_next_corner(t, h);
    const uint32_t root = brio_find(t->fan, brio_starts_own(t, h) ? h : next);
    uint64_t a = o->index[v[h]], b = o->index[v[next]];
    if (set[root] == UINT32_MAX)
        BRIO_FORWARD(brio_open_sets_add(c->ctx, &c->loops, o->patch[brio_face_at(t, h)], &set[root]));
    const brio_end_row row = {{a < b ? a : b, a < b ? b : a}, set[root]};
    return brio_row_files_put(&c->ends, brio_bucket_of_edge(c, row.edge), &row, sizeof row);
}

/* Counts the boundary loops at own vertices alone. Pieces of others become open sets, which their ends join. */
static brio_status count_loops(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t) {
    enum { COUNTED = UINT32_MAX - 1 };
    uint32_t *set = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(c->ctx, set, t->corners));
    memset(set, 0xff, t->corners * sizeof *set);
    BRIO_TRY(brio_topology_join_loops(t));
    for (uint32_t h = 0; h < t->corners; h++) {
        BRIO_TRY(brio_look(c->ctx, 1));
        if (t->ring[h] == h && brio_starts_own(t, h) != brio_starts_own(t, brio_next_corner(t, h)))
            BRIO_TRY(leave_open(c, o, t, h, set));
    }
    for (uint32_t h = 0; h < t->corners; h++) {
        BRIO_TRY(brio_look(c->ctx, 1));
        if (t->ring[h] != h || !brio_starts_own(t, h) || !brio_starts_own(t, brio_next_corner(t, h))) continue;
        uint32_t root = brio_find(t->fan, h);
        if (set[root] != UINT32_MAX) continue;
        c->component[o->patch[brio_face_at(t, h)]].loops++;
        set[root] = (uint32_t)COUNTED;
    }
done:
    brio_release(c->ctx, set);
    return status;
}

/* Counts all that a surface has at the own vertices, unless it is to be split. */
static brio_status count_surface(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t) {
    size_t bad, degenerate, thin;
    bool pinched;
    BRIO_FORWARD(brio_topology_degenerate(t, &degenerate, &thin)); /* the vertices of these are bad */
    BRIO_FORWARD(brio_topology_count(t, o->patch, c->component, NULL, &pinched));
    if (pinched) BRIO_FORWARD(settle_pinched(c, o, t));
    BRIO_FORWARD(brio_topology_bad_vertices(t, &bad));
    c->bad_vertices += bad;
    return count_loops(c, o, t);
}

/* Numbers the patches of a part among those of all parts, and counts its faces. */
static brio_status begin_patches(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t) {
    size_t patches, first = c->count;
    BRIO_FORWARD(brio_topology_patches(t, o->patch, &patches));
    BRIO_FORWARD(add_patches(c, patches));
    for (size_t f = 0; f < o->mesh.num_faces; f++) o->patch[f] += (uint32_t)first;
    return brio_topology_count_faces(t, o->patch, c->component);
}

/* Joins the patches of faces that a bucket joins. */
static brio_status join_patches(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t) {
    for (uint32_t f = 0; f < o->mesh.num_faces; f++) {
        brio_unite(c->parent, o->patch[f], o->patch[brio_find(t->patch, f)], true);
        BRIO_FORWARD(brio_look(c->ctx, 1));
    }
    return BRIO_OK;
}

/* Joins what has an own vertex in common, and counts.   is_part  whether its patches are new. */
static brio_status count_owned(brio_parts_certificate *c, const brio_owned_faces *o, bool is_part) {
    brio_topology t = {0};
    brio_strands strands = {0};
    brio_edge_faults edges = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_topology_new(c->ctx, &o->mesh, o->own, o->index, &t));
    if (c->sheets)
        BRIO_TRY(brio_sheets_pair(&t, &strands));
    else
        BRIO_TRY(brio_topology_join(&t, &edges));
    BRIO_TRY(is_part ? begin_patches(c, o, &t) : join_patches(c, o, &t));
    if (c->sheets)
        BRIO_TRY(brio_sheets_count(c, o, &t, &strands));
    else
        BRIO_TRY(count_surface(c, o, &t));
    c->edges.boundary += edges.boundary;
    c->edges.nonmanifold += edges.nonmanifold;
    c->edges.flipped += edges.flipped;
    c->points += brio_topology_used(&t);
done:
    brio_topology_free(&t);
    brio_release(c->ctx, strands.strand);
    return status;
}

/* --- area and volume --- */

typedef struct {
    const brio_parts_certificate *c;
    const brio_faces_part *part;
    brio_exact_sum *area, *volume; /* one for each thread */
} measure;

/* Measures triangles from their vertices of least index on, so that the terms do not depend on the corner that is
 * first. */
static void measure_faces(void *user, size_t begin, size_t end, int thread) {
    const measure *m = user;
    const double *centre = m->c->centre;
    for (size_t f = begin; f < end; f++) {
        const uint32_t *v = m->part->faces[f];
        double p[3][3], n[3];
        int first = 0;
        for (int k = 1; k < 3; k++)
            if (m->part->index[v[k]] < m->part->index[v[first]]) first = k;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                p[i][k] = m->part->points[3 * (size_t)v[(first + i) % 3] + (size_t)k] * m->c->scale;
        brio_scaled_normal(p[0], p[1], p[2], 1, n);
        brio_exact_add(&m->area[thread], brio_length(n) / 2);
        brio_exact_add(&m->volume[thread],
                       ((p[0][0] - centre[0]) * n[0] + (p[0][1] - centre[1]) * n[1] + (p[0][2] - centre[2]) * n[2]) /
                           6);
    }
}

static brio_status measure_part(brio_parts_certificate *c, const brio_faces_part *part) {
    int threads = brio_threads(c->ctx, part->num_faces, FACES_A_THREAD);
    measure m = {.c = c, .part = part};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, m.area, threads));
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, m.volume, threads));
    BRIO_TRY(brio_for(c->ctx, threads, part->num_faces, measure_faces, &m));
    for (int i = 0; i < threads; i++) {
        brio_exact_carry(&m.area[i]);
        brio_exact_carry(&m.volume[i]);
        brio_exact_add_sum(&c->area, &m.area[i]);
        brio_exact_add_sum(&c->volume, &m.volume[i]);
    }
done:
    brio_release(c->ctx, m.area);
    brio_release(c->ctx, m.volume);
    return status;
}

/* --- parts --- */

static brio_status offsets_of_triangles(brio_context *ctx, size_t num_faces, uint64_t **offsets) {
    BRIO_FORWARD(BRIO_ALLOC(ctx, *offsets, num_faces + 1));
    for (size_t f = 0; f <= num_faces; f++) (*offsets)[f] = 3 * f;
    return BRIO_OK;
}

static size_t bytes_of_row(const brio_parts_certificate *c) {
    return c->sheets ? sizeof(brio_face_row) : offsetof(brio_face_row, point);
}

/* Writes a face to the bucket of each of its shared vertices, once to each bucket. */
static brio_status share_face(brio_parts_certificate *c, const brio_owned_faces *o, size_t f) {
    const uint32_t *v = o->mesh.face_vertices + 3 * f;
    brio_face_row row = {.patch = o->patch[f]};
    uint32_t bucket[3];
    for (uint32_t k = 0; k < 3; k++) {
        row.index[k] = o->index[v[k]];
        row.shared |= (uint32_t)!o->own[v[k]] << k;
        memcpy(row.point[k], o->mesh.vertices + 3 * (size_t)v[k], sizeof row.point[k]);
        bucket[k] = bucket_of(c, row.index[k]);
    }
    for (int k = 0; k < 3; k++) {
        bool again = false;
        for (int i = 0; i < k; i++) again |= row.shared >> i & 1 && bucket[i] == bucket[k];
        if (row.shared >> k & 1 && !again)
            BRIO_FORWARD(brio_row_files_put(&c->faces, bucket[k], &row, bytes_of_row(c)));
    }
    return brio_look(c->ctx, 1);
}

/* Counts the degenerate faces, which are in one part each, and marks nothing. */
static void count_degenerate(brio_parts_certificate *c, const brio_faces_part *part) {
    for (size_t f = 0; f < part->num_faces; f++) {
        const uint32_t *v = part->faces[f];
        c->degenerate += v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    }
}

static brio_status add_part(brio_parts_certificate *c, const brio_faces_part *part) {
    brio_context *ctx = c->ctx;
    brio_status status = BRIO_OK;
    brio_owned_faces o = {.index = part->index};
    uint64_t *offsets = NULL;
    BRIO_TRY(offsets_of_triangles(ctx, part->num_faces, &offsets));
    o.mesh = (brio_mesh){.context = ctx,
                         .num_vertices = part->num_vertices,
                         .num_faces = part->num_faces,
                         .vertices = (double *)part->points, /* all three are only read */
                         .face_offsets = offsets,
                         .face_vertices = (uint32_t *)part->faces};
    BRIO_TRY(brio_mesh_check_faces(ctx, &o.mesh));
    BRIO_TRY(brio_refuse_not_finite(ctx, part->points, NULL, part->num_vertices, "part of a surface"));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, o.own, part->num_vertices));
    for (size_t v = 0; part->shared && v < part->num_vertices; v++) o.own[v] = !part->shared[v];
    BRIO_TRY(BRIO_ALLOC(ctx, o.patch, part->num_faces));
    count_degenerate(c, part);
    BRIO_TRY(count_owned(c, &o, true));
    for (size_t f = 0; f < part->num_faces; f++) BRIO_TRY(share_face(c, &o, f));
    BRIO_TRY(measure_part(c, part));
    c->num_faces += part->num_faces;
done:
    brio_release(ctx, offsets);
    brio_release(ctx, o.own);
    brio_release(ctx, o.patch);
    return status;
}

brio_status brio_parts_certificate_add(brio_context *ctx, brio_parts_certificate *c, const brio_faces_part *part) {
    BRIO_DOOR;
    brio_faces_part p = {0};
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_faces_part, part, &p));
    BRIO_EXPECT(ctx, ctx == c->ctx, BRIO_ERR_ARGUMENT, "the certificate is of another context");
    BRIO_EXPECT(ctx, !c->ended, BRIO_ERR_ARGUMENT, "the certificate of parts has ended, or a part of it failed");
    if (!p.num_faces) return BRIO_OK;
    brio_status status = add_part(c, &p);
    c->ended = status != BRIO_OK; /* some of the part may be counted */
    return status;
}

/* --- buckets --- */

static brio_status was_changed(const brio_parts_certificate *c, const char *name, uint32_t bucket) {
    return brio_fail(c->ctx, BRIO_ERR_OPEN, "%s/%s-%u was changed from outside", c->folder.path, name, bucket);
}

/* Returns the place of an index in an ascending list that has it. */
static uint32_t place_of(const uint64_t *list, size_t count, uint64_t index) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (list[middle] < index)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint32_t)low;
}

/* Makes the mesh of a bucket's faces, with vertices in the order of their indices.   rows  at least one, of `size`. */
static brio_status fill_bucket(brio_parts_certificate *c, uint32_t bucket, const uint8_t *rows, size_t size,
                               brio_owned_faces *o, uint64_t *index) {
    size_t n = o->mesh.num_faces;
    for (size_t f = 0; f < n; f++)
        memcpy(index + 3 * f, ((const brio_face_row *)(const void *)(rows + f * size))->index, 24);
    BRIO_FORWARD(brio_sort_many_keys(c->ctx, index, 3 * n));
    for (size_t i = 0; i < 3 * n; i++)
        if (i == 0 || index[i] != index[i - 1]) index[o->mesh.num_vertices++] = index[i];
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, o->own, o->mesh.num_vertices));
    if (c->sheets) BRIO_FORWARD(BRIO_ALLOC(c->ctx, o->mesh.vertices, 3 * o->mesh.num_vertices));
    for (size_t f = 0; f < n; f++) {
        const brio_face_row *row = (const void *)(rows + f * size);
        if (row->patch >= c->count) return was_changed(c, "faces", bucket);
        o->patch[f] = row->patch;
        for (size_t k = 0; k < 3; k++) {
            uint32_t v = place_of(index, o->mesh.num_vertices, row->index[k]);
            o->mesh.face_vertices[3 * f + k] = v;
            o->own[v] |= row->shared >> k & 1 && bucket_of(c, row->index[k]) == bucket;
            if (c->sheets) memcpy(o->mesh.vertices + 3 * (size_t)v, row->point[k], sizeof row->point[k]);
        }
        BRIO_FORWARD(brio_look(c->ctx, 3));
    }
    return BRIO_OK;
}

static brio_status count_bucket(brio_parts_certificate *c, uint32_t bucket) {
    brio_context *ctx = c->ctx;
    brio_owned_faces o = {.mesh = {.context = ctx}};
    uint8_t *rows = NULL;
    uint64_t *index = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&c->folder, "faces", bucket, bytes_of_row(c), (void **)&rows, &o.mesh.num_faces));
    if (!o.mesh.num_faces) goto done;
    BRIO_REQUIRE(ctx, o.mesh.num_faces < UINT32_MAX / 3, BRIO_ERR_TOO_LARGE, "%zu faces in a bucket: take more buckets",
                 o.mesh.num_faces);
    BRIO_TRY(offsets_of_triangles(ctx, o.mesh.num_faces, &o.mesh.face_offsets));
    BRIO_TRY(BRIO_ALLOC(ctx, o.mesh.face_vertices, 3 * o.mesh.num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, o.patch, o.mesh.num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, index, 3 * o.mesh.num_faces));
    o.index = index;
    BRIO_TRY(fill_bucket(c, bucket, rows, bytes_of_row(c), &o, index));
    brio_release(ctx, rows);
    rows = NULL;
    status = count_owned(c, &o, false);
done:
    brio_release(ctx, rows);
    brio_release(ctx, index);
    brio_release(ctx, o.own);
    brio_release(ctx, o.patch);
    brio_release(ctx, o.mesh.vertices);
    brio_release(ctx, o.mesh.face_offsets);
    brio_release(ctx, o.mesh.face_vertices);
    return status;
}

/* --- the end --- */

static int compare_ends(uint32_t i, uint32_t j, const void *user) {
    return memcmp((const brio_end_row *)user + i, (const brio_end_row *)user + j, sizeof(uint64_t[2]));
}

/* Joins the pieces of boundary loops at edges both of whose ends were written. */
static brio_status join_ends(brio_parts_certificate *c, uint32_t bucket) {
    brio_end_row *row = NULL;
    uint32_t *order = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&c->folder, "ends", bucket, sizeof *row, (void **)&row, &n));
    BRIO_TRY(BRIO_ALLOC(c->ctx, order, n + 1));
    for (size_t i = 0; i < n; i++) {
        order[i] = (uint32_t)i;
        if (row[i].set >= c->loops.count) BRIO_TRY(was_changed(c, "ends", bucket));
    }
    BRIO_TRY(brio_sort_many_indices(c->ctx, order, n, compare_ends, row));
    for (size_t i = 1; i < n; i++)
        if (!compare_ends(order[i - 1], order[i], row))
            brio_unite(c->loops.parent, (uint32_t)row[order[i - 1]].set, (uint32_t)row[order[i]].set, true);
done:
    brio_release(c->ctx, row);
    brio_release(c->ctx, order);
    return status;
}

static int compare_pinched(uint32_t i, uint32_t j, const void *user) {
    const brio_pinched_row *a = (const brio_pinched_row *)user + i, *b = (const brio_pinched_row *)user + j;
    if (a->index != b->index) return a->index < b->index ? -1 : 1;
    return (a->patch > b->patch) - (a->patch < b->patch);
}

/* Counts once the fans of a vertex that are in one component in the end. All patches are joined. */
static brio_status recount_pinched(brio_parts_certificate *c, uint32_t bucket) {
    brio_pinched_row *row = NULL;
    uint32_t *order = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&c->folder, "pinched", bucket, sizeof *row, (void **)&row, &n));
    BRIO_TRY(BRIO_ALLOC(c->ctx, order, n + 1));
    for (size_t i = 0; i < n; i++) {
        if (row[i].patch >= c->count) BRIO_TRY(was_changed(c, "pinched", bucket));
        row[i].patch = brio_find(c->parent, (uint32_t)row[i].patch);
        order[i] = (uint32_t)i;
    }
    BRIO_TRY(brio_sort_many_indices(c->ctx, order, n, compare_pinched, row));
    for (size_t i = 1; i < n; i++)
        if (!compare_pinched(order[i - 1], order[i], row)) c->component[row[order[i]].patch].vertices--;
done:
    brio_release(c->ctx, row);
    brio_release(c->ctx, order);
    return status;
}

/* Brings the counts of patches to the patch that stands for their component. */
static brio_status gather_components(brio_parts_certificate *c) {
    for (uint32_t i = 0; i < c->count; i++) {
        brio_component *from = &c->component[i], *to = &c->component[brio_find(c->parent, i)];
        BRIO_FORWARD(brio_look(c->ctx, 1));
        if (from == to) continue;
        to->faces += from->faces, to->edges += from->edges, to->vertices += from->vertices, to->loops += from->loops;
        *from = (brio_component){0, 0, 0, 0};
    }
    return BRIO_OK;
}

static brio_status count_open(brio_parts_certificate *c) {
    for (uint32_t i = 0; i < c->loops.count; i++)
        c->component[brio_find(c->parent, c->loops.patch[i])].loops += c->loops.parent[i] == i;
    for (uint32_t i = 0; i < c->fans.count; i++)
        c->component[brio_find(c->parent, c->fans.patch[i])].vertices += c->fans.parent[i] == i;
    return brio_look(c->ctx, c->loops.count + c->fans.count);
}

static brio_status end_counts(brio_parts_certificate *c) {
    BRIO_FORWARD(brio_row_files_flush(&c->faces));
    for (uint32_t i = 0; i < c->buckets; i++) {
        BRIO_FORWARD(brio_progress(c->ctx, "certificate", (double)i / c->buckets));
        BRIO_FORWARD(count_bucket(c, i));
        brio_row_files_remove(&c->folder, "faces", i);
    }
    BRIO_FORWARD(brio_row_files_flush(&c->pinched));
    BRIO_FORWARD(brio_row_files_flush(c->sheets ? &c->knots : &c->ends));
    if (c->sheets) BRIO_FORWARD(brio_sheets_join(c));
    for (uint32_t i = 0; !c->sheets && i < c->buckets; i++) BRIO_FORWARD(join_ends(c, i));
    for (uint32_t i = 0; !c->sheets && i < c->buckets; i++) BRIO_FORWARD(recount_pinched(c, i));
    BRIO_FORWARD(gather_components(c));
    return count_open(c);
}

static void give_stats(const brio_parts_certificate *c, brio_parts_stats *stats) {
    brio_parts_stats s = {.size = sizeof s, .faces = c->num_faces, .vertices = c->points};
    int64_t vertices = 0;
    for (size_t i = 0; c->sheets && i < c->count; i++) vertices += c->component[i].vertices;
    if (c->sheets) s.vertices = (uint64_t)vertices;
    s.split = s.vertices - c->points;
    s.scratch_bytes = c->folder.most;
    BRIO_GIVE(brio_parts_stats, stats, &s);
}

brio_status brio_parts_certificate_end(brio_context *ctx, brio_parts_certificate *c, brio_certificate *out,
                                       brio_parts_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_certificate all = {.size = sizeof all, .self_intersections = -1, .context = ctx};
    BRIO_TRY(BRIO_CHECK_OWNER(ctx, brio_certificate, out, genera));
    BRIO_GIVE(brio_certificate, out, &(brio_certificate){0});
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_parts_stats, stats));
    BRIO_REQUIRE(ctx, ctx == c->ctx, BRIO_ERR_ARGUMENT, "the certificate is of another context");
    BRIO_REQUIRE(ctx, !c->ended, BRIO_ERR_ARGUMENT, "the certificate of parts has ended, or a part of it failed");
    c->ended = true;
    BRIO_TRY(end_counts(c));
    BRIO_TRY(brio_components_list(ctx, c->component, c->count, &all));
    all.boundary_edges = c->edges.boundary;
    all.nonmanifold_edges = c->edges.nonmanifold;
    all.flipped_edges = c->edges.flipped;
    all.nonmanifold_vertices = (size_t)c->bad_vertices;
    all.closed = c->num_faces && !all.boundary_edges && !all.nonmanifold_edges;
    all.manifold = !all.nonmanifold_edges && !all.nonmanifold_vertices && !c->degenerate;
    all.oriented = !all.flipped_edges;
    all.area = ldexp(brio_exact_rounded(&c->area), 2 * c->exponent);
    all.volume = ldexp(brio_exact_rounded(&c->volume), 3 * c->exponent);
    give_stats(c, stats);
    BRIO_GIVE(brio_certificate, out, &all);
done:
    if (status != BRIO_OK) brio_certificate_free(&all);
    return status;
}
