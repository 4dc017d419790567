/* The super co-cone: on dense samples the same triangles as the whole, on anything a manifold, in less memory. */
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/cocone/octree_pieces.h"
#include "reconstruct/cocone/seams.h"
#include "same_faces.h"
#include "surface_calls.h"

/* What threads do is for test_parallel_cocone; here they would only wait for each other. */
static brio_context *serial_context(void) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    return ctx;
}

static void dense_samples_give_the_faces_of_the_whole(void) {
    static double p[3 * 4000];
    brio_context *ctx = serial_context();
    for (int sphere = 0; sphere < 2; sphere++) {
        brio_surface_options o = COCONE_OPTIONS;
        brio_mesh *whole, *pieces;
        brio_surface_stats s = {0}, t = {.size = sizeof t};
        sphere ? sphere_points(3, 4000, p) : torus_points(3, 4000, p);
        EXPECT(make_cocone(ctx, p, 4000, &o, &whole, &s) == BRIO_OK);
        for (o.pieces = 2; o.pieces < 20; o.pieces += 7) {
            EXPECT(make_cocone(ctx, p, 4000, &o, &pieces, &t) == BRIO_OK, "%s", brio_message(ctx));
            EXPECT(t.pieces >= o.pieces && t.unmatched == 0 && t.samples == s.samples && t.unused == 0);
            expect_same_faces(whole, NULL, pieces);
            brio_mesh_free(pieces);
        }
        brio_mesh_free(whole);
    }
    brio_context_free(ctx);
}

/* 4,000 noisy samples of a torus, and all of them once more. */
static void noisy_torus_twice(uint64_t seed, double noise, double *p) {
    brio_rng rng = brio_rng_new(5);
    torus_points(seed, 4000, p);
    for (size_t i = 0; i < 12000; i++) p[i] += noise * brio_rng_double(&rng);
    memcpy(p + 12000, p, 12000 * sizeof *p);
}

static void expect_closed_torus(brio_context *ctx, const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 1);
    brio_certificate_free(&c);
}

/* The whole at once, in pieces, shuffled, and with every sample twice; noise up to one spacing is no obstacle. */
static void order_of_samples_and_duplicates_change_nothing(void) {
    static double p[3 * 8000], q[3 * 4000];
    static size_t to[4000];
    brio_context *ctx = serial_context();
    for (uint64_t seed = 4; seed < (BRIEF_TESTS ? 5 : 7); seed++) {
        brio_surface_options o = COCONE_OPTIONS;
        brio_mesh *whole, *pieces, *shuffled, *twice;
        brio_surface_stats s = {0};
        noisy_torus_twice(seed, seed % 2 ? 0.02 : 0.04, p);
        shuffle_points(seed + 2, 4000, p, q, to);
        EXPECT(make_cocone(ctx, p, 4000, &o, &whole, NULL) == BRIO_OK);
        o.pieces = 5;
        EXPECT(make_cocone(ctx, p, 4000, &o, &pieces, NULL) == BRIO_OK);
        EXPECT(make_cocone(ctx, q, 4000, &o, &shuffled, NULL) == BRIO_OK);
        EXPECT(make_cocone(ctx, p, 8000, &o, &twice, &s) == BRIO_OK && s.samples == 4000);
        expect_closed_torus(ctx, whole);
        expect_same_faces(whole, NULL, pieces);
        expect_same_faces(whole, to, shuffled);
        expect_same_faces(whole, NULL, twice);
        brio_mesh_free(whole);
        brio_mesh_free(pieces);
        brio_mesh_free(shuffled);
        brio_mesh_free(twice);
    }
    brio_context_free(ctx);
}

static void anything_is_manifold_oriented(void) {
    static double p[3 * 402];
    brio_context *ctx = serial_context();
    int surfaces = 0;
    for (uint64_t trial = 0; trial < 120; trial += BRIEF_TESTS ? 5 : 1) {
        brio_surface_options o = COCONE_OPTIONS;
        brio_certificate c = {0};
        brio_mesh *mesh;
        brio_surface_stats s = {0};
        size_t n = 4 + trial * 3;
        o.pieces = 2 + trial % 9;
        o.boundaries = trial >> 1 & 1;
        o.density = trial >> 2 & 1;
        trial % 3 ? integer_points(trial, n, 3 + (uint32_t)(trial % 7), p) : clustered_points(trial, n, p);
        brio_status status = make_cocone(ctx, p, n, &o, &mesh, &s);
        EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !mesh), "%s", brio_message(ctx));
        if (status != BRIO_OK) continue;
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.manifold && c.oriented, "trial %d: manifold %d oriented %d", (int)trial, c.manifold, c.oriented);
        surfaces++;
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
    EXPECT(surfaces > (BRIEF_TESTS ? 12 : 60), "%d", surfaces);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void pieces_need_a_quarter_of_the_memory(void) {
    static double p[3 * 80000];
    brio_context *whole = serial_context(), *parts = serial_context();
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    torus_points(3, 80000, p);
    EXPECT(make_cocone(whole, p, 80000, &o, &mesh, NULL) == BRIO_OK);
    brio_mesh_free(mesh);
    o.pieces = 24;
    EXPECT(make_cocone(parts, p, 80000, &o, &mesh, NULL) == BRIO_OK);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory_peak(parts) < brio_context_memory_peak(whole) / 4, "%zu of %zu",
           brio_context_memory_peak(parts), brio_context_memory_peak(whole));
    brio_context_free(whole);
    brio_context_free(parts);
}

/* --- the parts --- */

static void pieces_cover_all_samples_once(void) {
    static double p[3 * 5000];
    brio_context *ctx = serial_context();
    for (int kind = 0; kind < 3; kind++)
        for (size_t wanted = 1; wanted < 5000; wanted = wanted * 3 + 1) {
            brio_pieces pieces;
            size_t count = 0;
            kind == 0   ? uniform_points(1, 5000, p)
            : kind == 1 ? clustered_points(2, 5000, p)
                        : integer_points(3, 5000, 2, p);
            EXPECT(brio_pieces_new(ctx, p, 5000, wanted, &pieces) == BRIO_OK);
            for (size_t i = 0; i < pieces.num_pieces; i++) {
                const brio_piece *piece = &pieces.pieces[i];
                EXPECT(piece->begin == count && piece->end > piece->begin);
                EXPECT(kind > 0 || piece->end - piece->begin <= (5000 + wanted - 1) / wanted);
                count = piece->end;
            }
            EXPECT(count == 5000, "%zu of 5000 samples in %zu pieces", count, pieces.num_pieces);
            brio_pieces_free(ctx, &pieces);
        }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void triangles_that_one_piece_denies_are_left_out(void) {
    static const uint32_t piece_of[5] = {0, 0, 1, 1, 2};
    static const uint32_t found[5][3] = {{1, 2, 0}, {2, 0, 1}, {3, 1, 2}, {4, 2, 0}, {2, 0, 4}};
    brio_context *ctx = serial_context();
    brio_triangles seam = {0}, faces = {0};
    uint8_t frayed[5] = {0};
    size_t unmatched;
    for (int i = 0; i < 5; i++) EXPECT(brio_triangles_add(ctx, &seam, found[i]) == BRIO_OK);
    EXPECT(brio_match_seams(ctx, piece_of, &seam, &faces, frayed, &unmatched) == BRIO_OK);
    EXPECT(unmatched == 2 && faces.count == 1 && faces.corner[0][0] == 0 && faces.corner[0][1] == 1);
    EXPECT(frayed[0] && frayed[1] && frayed[2] && frayed[3] && frayed[4]);
    brio_release(ctx, seam.corner);
    brio_release(ctx, faces.corner);
    brio_context_free(ctx);
}

/* A wheel of six triangles round sample 0 without two of them: fans of three and of one. */
static void the_longest_fan_stays(void) {
    brio_context *ctx = serial_context();
    brio_triangles faces = {0};
    double p[21] = {0};
    uint8_t frayed[7] = {1};
    for (uint32_t i = 0; i < 6; i++)
        if (i != 0 && i != 2)
            EXPECT(brio_triangles_add(ctx, &faces, (uint32_t[3]){0, 1 + i, 1 + (i + 1) % 6}) == BRIO_OK);
    EXPECT(brio_trim_fans(ctx, p, 7, frayed, &faces) == BRIO_OK);
    EXPECT(faces.count == 3 && faces.corner[0][1] == 4);
    brio_release(ctx, faces.corner);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static brio_status small_pieces(brio_context *ctx) {
    double p[3 * 90];
    brio_mesh *mesh;
    brio_surface_options o = COCONE_OPTIONS;
    o.boundaries = o.density = 1;
    o.pieces = 3;
    sphere_points(3, 90, p);
    brio_status status = make_cocone(ctx, p, 90, &o, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_pieces);
}

static void hopeless_inputs_say_so(void) {
    const double flat[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, .5, .5, 0}, bad[6] = {0, 0, 0, 1, NAN, 0};
    brio_context *ctx = serial_context();
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    o.pieces = 3;
    EXPECT(make_cocone(ctx, NULL, 0, &o, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_cocone(ctx, flat, 5, &o, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_cocone(ctx, bad, 2, &o, &mesh, NULL) == BRIO_ERR_NOT_FINITE && !mesh);
    o.method = BRIO_SURFACE_TIGHT_COCONE;
    EXPECT(make_cocone(ctx, flat, 5, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_super_cocone) {
    RUN(dense_samples_give_the_faces_of_the_whole);
    RUN(order_of_samples_and_duplicates_change_nothing);
    RUN(anything_is_manifold_oriented);
    if (!SHORT_TESTS) RUN(pieces_need_a_quarter_of_the_memory);
    RUN(pieces_cover_all_samples_once);
    RUN(triangles_that_one_piece_denies_are_left_out);
    RUN(the_longest_fan_stays);
    RUN(every_failed_allocation_is_a_status);
    RUN(hopeless_inputs_say_so);
    return harness_end();
}
