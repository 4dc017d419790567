/* Meshes of any polygons: the certificate against surface_oracle.h; crossings, distances, subdivision, simplification,
 * subgraphs, normals and components answer, and keep what they promise. */
#include "surface_oracle.h"
#include "brio/laboratory.h"

enum { MOST_VERTICES = 14, MOST_FACES = 28 };

static void add_faces(fuzz_input *in, brio_mesh *m, bool triangles) {
    uint64_t offsets[MOST_FACES + 1] = {0};
    uint32_t corners[MOST_FACES * 5];
    size_t faces = fuzz_below(in, MOST_FACES + 1), n = m->num_vertices;
    for (size_t f = 0; f < faces; f++) {
        size_t sides = triangles ? 3 : 3 + fuzz_below(in, 3);
        uint32_t *v = corners + offsets[f];
        for (size_t i = 0; i < sides; i++) { /* none twice */
            v[i] = (uint32_t)fuzz_below(in, n);
            for (size_t j = 0; j < i; j++)
                if (v[j] == v[i]) v[i] = (v[i] + 1) % (uint32_t)n, j = SIZE_MAX;
        }
        offsets[f + 1] = offsets[f] + sides;
    }
    FUZZ_EXPECT(brio_mesh_set_faces(m, offsets, corners, faces) == BRIO_OK);
}

/* A closed surface to begin with, as most random faces make none: a torus of squares, of which some may go. */
static void add_torus(fuzz_input *in, brio_mesh *m) {
    uint64_t offsets[MOST_FACES + 1] = {0};
    uint32_t corners[MOST_FACES * 5];
    size_t faces = 0;
    for (uint32_t i = 0; i < 12; i++) {
        uint32_t right = i / 3 * 3 + (i + 1) % 3, up = (i + 3) % 12, over = (right + 3) % 12;
        const uint32_t both[2][3] = {{i, right, over}, {i, over, up}};
        for (int k = 0; k < 2; k++) {
            uint8_t fate = fuzz_byte(in);
            if (fate >= 250) continue;
            memcpy(corners + 3 * faces, both[k], sizeof both[k]);
            if (fate >= 245) corners[3 * faces] = both[k][1], corners[3 * faces + 1] = both[k][0];
            faces++;
            offsets[faces] = 3 * faces;
        }
    }
    FUZZ_EXPECT(brio_mesh_set_faces(m, offsets, corners, faces) == BRIO_OK);
}

static brio_mesh *make_mesh(brio_context *ctx, fuzz_input *in) {
    brio_mesh *m;
    void *data;
    uint8_t kind = fuzz_byte(in);
    bool torus = kind & 1, hostile = (kind & 6) == 6;
    size_t n = torus ? 12 : 5 + fuzz_below(in, MOST_VERTICES - 4);
    FUZZ_EXPECT(brio_mesh_new(ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, NULL, n) == BRIO_OK);
    for (size_t i = 0; i < 3 * n; i++) m->vertices[i] = hostile ? fuzz_double(in) : (double)(fuzz_byte(in) % 5);
    if (torus)
        add_torus(in, m);
    else
        add_faces(in, m, kind & 8);
    if (kind & 16) FUZZ_EXPECT(brio_mesh_add_property(m, "value", (brio_scalar)(kind >> 5), &data) == BRIO_OK);
    return m;
}

static void simplify(brio_context *ctx, fuzz_input *in, brio_mesh *m) {
    brio_mesh_simplify_options o = {0};
    surface_facts before = judge_surface(m);
    o.target_faces = fuzz_below(in, 16), o.tolerance = fuzz_byte(in) % 4 / 2.0;
    brio_status status = brio_mesh_simplify(ctx, m, &o);
    fuzz_expect_failure(status);
    if (status == BRIO_ERR_ARGUMENT || status == BRIO_ERR_NOT_FINITE) fuzz_expect_sound(m);
    if (status != BRIO_OK) return;
    fuzz_expect_sound(m);
    surface_facts after = expect_certificate(ctx, m);
    FUZZ_EXPECT(after.manifold && after.oriented && after.closed == before.closed, "simplified");
    FUZZ_EXPECT(after.euler == before.euler && after.components == before.components, "euler %lld, was %lld",
                (long long)after.euler, (long long)before.euler);
}

static void components(brio_context *ctx, fuzz_input *in, brio_mesh *m) {
    size_t dropped[2] = {0, 0}, faces = m->num_faces, count = judge_surface(m).components;
    brio_status status = brio_mesh_keep_components(m, fuzz_flag(in), fuzz_below(in, 6), &dropped[0], &dropped[1]);
    fuzz_expect_failure(status);
    fuzz_expect_sound(m);
    if (status != BRIO_OK) return;
    FUZZ_EXPECT(faces == m->num_faces + dropped[1]);
    FUZZ_EXPECT(expect_certificate(ctx, m).components == count - dropped[0]);
}

/* Merging a second time changes nothing, as no two positions that are left are equal. */
static void merge(fuzz_input *in, brio_mesh *m) {
    brio_merge_stats stats = {0};
    double distance = fuzz_flag(in) ? (double)fuzz_below(in, 4) : 0;
    size_t vertices = m->num_vertices, faces = m->num_faces;
    brio_status status = brio_mesh_merge_vertices(m, distance, &stats);
    fuzz_expect_failure(status);
    fuzz_expect_sound(m);
    if (status != BRIO_OK) return;
    FUZZ_EXPECT(vertices == m->num_vertices + stats.vertices && faces == m->num_faces + stats.faces);
    status = brio_mesh_merge_vertices(m, 0, &stats);
    FUZZ_EXPECT(status == BRIO_OK && !stats.vertices && !stats.faces, "merged twice");
}

/* Whether two triangles have the same corners: parts of them share the ends of two edges, so that vertices do not tell the
 * edges apart. */
static bool has_doubled_faces(const brio_mesh *m) {
    for (size_t f = 0; f < m->num_faces; f++)
        for (size_t g = 0; g < f; g++) {
            const uint32_t *a = m->face_vertices + m->face_offsets[f], *b = m->face_vertices + m->face_offsets[g];
            int same = 0;
            for (int i = 0; i < 9; i++) same += a[i / 3] == b[i % 3];
            if (same == 3) return true;
        }
    return false;
}

static void subdivide(brio_context *ctx, fuzz_input *in, const brio_mesh *m) {
    brio_mesh *fine;
    surface_facts before = judge_surface(m);
    int levels = 1 + (int)fuzz_below(in, 2);
    brio_status status = brio_mesh_subdivide(ctx, m, levels, &fine);
    fuzz_expect_failure(status);
    if (!fine) return;
    FUZZ_EXPECT(fine->num_faces == m->num_faces << 2 * levels);
    if (has_doubled_faces(m)) {
        brio_mesh_free(fine);
        return;
    }
    surface_facts after = expect_certificate(ctx, fine);
    FUZZ_EXPECT(after.closed == before.closed && after.components == before.components && after.euler == before.euler);
    brio_mesh_free(fine);
}

static void measure(brio_context *ctx, fuzz_input *in, brio_mesh *m) {
    brio_distance d = {0};
    brio_edges edges = {0};
    int64_t pairs = -1;
    fuzz_expect_failure(brio_mesh_self_intersections(ctx, m, &pairs));
    FUZZ_EXPECT(pairs >= 0, "%s", brio_message(ctx));
    fuzz_expect_failure(brio_mesh_distance(ctx, m, m, 20, 1, &d));
    brio_status status = brio_mesh_subgraph(ctx, m, (brio_subgraph)fuzz_below(in, BRIO_SUBGRAPH_END), &edges);
    fuzz_expect_failure(status);
    for (size_t i = 0; i < 2 * edges.count; i++) FUZZ_EXPECT(edges.ends[i] < m->num_vertices);
    brio_edges_free(&edges);
    fuzz_expect_failure(brio_mesh_add_normals(m));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    uint8_t what = fuzz_byte(&in);
    brio_mesh *m = make_mesh(ctx, &in);
    expect_certificate(ctx, m);
    if (what >= 128) merge(&in, m);
    switch (what % 4) {
    case 0:
        simplify(ctx, &in, m);
        break;
    case 1:
        components(ctx, &in, m);
        break;
    case 2:
        subdivide(ctx, &in, m);
        break;
    default:
        measure(ctx, &in, m);
    }
    brio_mesh_free(m);
    fuzz_end();
    return 0;
}
