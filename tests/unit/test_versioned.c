/* Structs that can grow: older and newer callers, sizes that were not set. */
#include "brio/testdata.h"
#include "base/versioned.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"

/* A struct of zeros is the default, as NULL is, with its size and without. */
static void zeros_are_the_default(void) {
    brio_context *ctx = new_context();
    double p[3 * 300];
    sphere_points(1, 300, p);
    const brio_surface_options zeros = {0}, sized = {.size = sizeof sized}, first = {.seed = 1};
    const brio_surface_options *ways[] = {NULL, &zeros, &sized, &first};
    size_t faces[4];
    for (int i = 0; i < 4; i++) {
        brio_mesh *mesh = NULL;
        EXPECT(brio_surface(ctx, p, 300, ways[i], &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
        faces[i] = mesh ? mesh->num_faces : 0;
        brio_mesh_free(mesh);
    }
    EXPECT(faces[0] > 500 && faces[1] == faces[0] && faces[2] == faces[0] && faces[3] == faces[0]);
    brio_context_free(ctx);
}

/* Without a size a struct ends where it ended in the first version, whatever follows it. */
static void without_a_size_nothing_follows(void) {
    brio_context *ctx = new_context();
    double p[3 * 300];
    sphere_points(1, 300, p);
    struct {
        brio_surface_options options;
        uint64_t later;
    } o = {.options = {.method = BRIO_SURFACE_COCONE}, .later = 1};
    struct {
        brio_surface_stats stats;
        uint64_t later;
    } s = {.later = 0x5a5a};
    brio_mesh *mesh = NULL;
    EXPECT(brio_surface(ctx, p, 300, &o.options, &mesh, &s.stats) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(s.stats.samples == 300 && s.stats.size == 0 && s.later == 0x5a5a);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void options_of_any_size_are_taken(void) {
    brio_context *ctx = new_context();
    double p[3 * 300];
    sphere_points(1, 300, p);
    struct {
        brio_surface_options options;
        uint64_t later;
    } newer = {.options = {.size = sizeof newer, .method = BRIO_SURFACE_TIGHT_COCONE}};
    brio_mesh *mesh = NULL;
    EXPECT(make_cocone(ctx, p, 300, &newer.options, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    size_t faces = mesh->num_faces;
    brio_mesh_free(mesh);
    newer.later = 1;
    EXPECT(make_cocone(ctx, p, 300, &newer.options, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(strstr(brio_message(ctx), "brio_surface_options") != NULL, "%s", brio_message(ctx));
    brio_surface_options older = {.size = offsetof(brio_surface_options, boundaries),
                                  .method = BRIO_SURFACE_TIGHT_COCONE};
    older.boundaries = older.density = 0x5a5a; /* not the caller's: it was compiled without them */
    EXPECT(make_cocone(ctx, p, 300, &older, &mesh, NULL) == BRIO_OK && mesh->num_faces == faces);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void results_stay_within_the_callers_size(void) {
    brio_context *ctx = new_context();
    double p[3 * 300];
    sphere_points(1, 300, p);
    struct {
        brio_surface_stats stats;
        uint64_t later[2];
    } s;
    brio_mesh *mesh;
    memset(&s, 0x5a, sizeof s);
    s.stats.size = offsetof(brio_surface_stats, candidates);
    EXPECT(make_cocone(ctx, p, 300, NULL, &mesh, &s.stats) == BRIO_OK);
    EXPECT(s.stats.size == offsetof(brio_surface_stats, candidates) && s.stats.samples == 300);
    for (size_t i = s.stats.size; i < sizeof s; i++) EXPECT(((unsigned char *)&s)[i] == 0x5a, "byte %zu", i);
    brio_mesh_free(mesh);
    s.stats.size = sizeof s;
    EXPECT(make_cocone(ctx, p, 300, NULL, &mesh, &s.stats) == BRIO_OK);
    EXPECT(s.stats.size == sizeof s && s.stats.candidates > 300 && s.later[0] == 0 && s.later[1] == 0);
    brio_certificate c = {.size = offsetof(brio_certificate, area)};
    c.area = 77;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK && c.manifold && c.area == 77);
    brio_certificate_free(&c);
    EXPECT(c.size == offsetof(brio_certificate, area) && !c.genera && c.area == 77);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Each public function that takes a struct with a size. */
static void sizes_that_were_not_set_are_arguments(void) {
    brio_context *ctx = new_context();
    double p[3 * 300];
    sphere_points(1, 300, p);
    static const size_t sizes[] = {1, 4, SIZE_MAX, 0x5a5a5a5a};
    brio_mesh *mesh = NULL, *shape = NULL;
    EXPECT(brio_generate(ctx, BRIO_KIND_SPHERE, 10, NULL, &mesh) == BRIO_OK);
    brio_mesh *out;
    brio_triangulation *t;
    for (int i = 0; i < 4; i++) {
        size_t size = sizes[i];
        EXPECT(brio_delaunay(ctx, p, NULL, 300, &(brio_delaunay_options){.size = size}, &t) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_surface(ctx, p, 300, &(brio_surface_options){.size = size}, &out, NULL) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_surface(ctx, p, 300, NULL, &out, &(brio_surface_stats){.size = size}) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_power_shape(ctx, p, 300, &(brio_power_shape_options){.size = size}, &shape, NULL, NULL) ==
               BRIO_ERR_ARGUMENT);
        EXPECT(brio_power_shape(ctx, p, 300, NULL, &shape, NULL, &(brio_power_shape_stats){.size = size}) ==
               BRIO_ERR_ARGUMENT);
        EXPECT(brio_generate(ctx, BRIO_KIND_BALL, 9, &(brio_generate_options){.size = size}, &out) ==
               BRIO_ERR_ARGUMENT);
        EXPECT(brio_iso_surface(ctx, "no.map", 1, &(brio_iso_surface_options){.size = size}, &out) ==
               BRIO_ERR_ARGUMENT);
        EXPECT(brio_write(ctx, "no.ply", mesh, &(brio_write_options){.size = size}) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_read(ctx, "no.ply", &(brio_read_options){.size = size}, &out) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_mesh_certificate(ctx, mesh, &(brio_certificate){.size = size}) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_mesh_distance(ctx, mesh, mesh, 9, 1, &(brio_distance){.size = size}) == BRIO_ERR_ARGUMENT);
        EXPECT(brio_mesh_merge_vertices(mesh, 0, &(brio_merge_stats){.size = size}) == BRIO_ERR_ARGUMENT);
    }
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* What such a struct owned was lost, or half a pointer was freed. */
static void results_that_cannot_be_freed_are_refused(void) {
    brio_context *ctx = new_context();
    double p[3 * 40];
    brio_mesh *mesh = NULL;
    brio_triangulation *t = NULL;
    uniform_points(1, 40, p);
    EXPECT(brio_generate(ctx, BRIO_KIND_SPHERE, 10, NULL, &mesh) == BRIO_OK);
    EXPECT(brio_delaunay(ctx, p, NULL, 40, NULL, &t) == BRIO_OK);
    size_t before = brio_context_memory(ctx);
    for (size_t size = sizeof size; size <= sizeof(brio_certificate) + 8; size++) {
        union {
            size_t size;
            brio_certificate it;
            unsigned char bytes[sizeof(brio_certificate) + 8];
        } c = {.bytes = {0}};
        c.size = size;
        bool whole = size >= offsetof(brio_certificate, genera) + sizeof c.it.genera;
        EXPECT(brio_mesh_certificate(ctx, mesh, &c.it) == (whole ? BRIO_OK : BRIO_ERR_ARGUMENT), "%zu", size);
        brio_certificate_free(&c.it);
        EXPECT(brio_context_memory(ctx) == before, "%zu", size);
    }
    for (size_t size = sizeof size; size <= sizeof(brio_alpha_complex) + 8; size++) {
        union {
            size_t size;
            brio_alpha_complex it;
            unsigned char bytes[sizeof(brio_alpha_complex) + 8];
        } c = {.bytes = {0}};
        c.size = size;
        bool whole = size >= sizeof c.it;
        EXPECT(brio_alpha_values(ctx, t, p, NULL, 40, &c.it) == (whole ? BRIO_OK : BRIO_ERR_ARGUMENT), "%zu", size);
        brio_alpha_complex_free(&c.it);
        EXPECT(brio_context_memory(ctx) == before, "%zu", size);
    }
    brio_triangulation_free(t);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* A field that is appended begins at the old size: no struct ends with padding, which would pass for the new field. */
#define ENDS_WITH(type, last)                                                                                          \
    _Static_assert(offsetof(type, last) + sizeof(((type *)0)->last) == sizeof(type), #type " ends with padding")
ENDS_WITH(brio_cells_options, reserved_int);
ENDS_WITH(brio_delaunay_options, reserved_int);
ENDS_WITH(brio_delaunay_stats, insert_seconds);
ENDS_WITH(brio_certificate, volume);
ENDS_WITH(brio_distance, diagonal);
ENDS_WITH(brio_dynamic_periodic_stats, snapshots);
ENDS_WITH(brio_dynamic_stats, exact_calls);
ENDS_WITH(brio_pole_options, reserved);
ENDS_WITH(brio_pole_stats, reserved);
ENDS_WITH(brio_surface_options, tiles);
ENDS_WITH(brio_surface_stats, rounding);
ENDS_WITH(brio_power_shape_options, scale_axis);
ENDS_WITH(brio_power_shape_stats, shape_seconds);
ENDS_WITH(brio_evidence, origin_of);
ENDS_WITH(brio_iso_surface_options, vertices);
ENDS_WITH(brio_write_options, reserved_int);
ENDS_WITH(brio_failure, bytes);
ENDS_WITH(brio_read_options, origins);
ENDS_WITH(brio_read_notes, rounded_column);
ENDS_WITH(brio_merge_stats, edges);
ENDS_WITH(brio_convert_stats, divide_seconds);
ENDS_WITH(brio_convert_options, tile_user);
ENDS_WITH(brio_convert_tile, kind);
ENDS_WITH(brio_mesh_simplify_options, reserved_int);
ENDS_WITH(brio_generate_options, reserved_int);
ENDS_WITH(brio_mesh, face_properties);
ENDS_WITH(brio_coverage, left_out);
ENDS_WITH(brio_alpha_complex, triangulation2);
ENDS_WITH(brio_restricted_stats, cut_seconds);
ENDS_WITH(brio_ball_union_options, seed);
ENDS_WITH(brio_ball_union_stats, mesh_seconds);
ENDS_WITH(brio_voronoi_axis_options, seed);
ENDS_WITH(brio_voronoi_axis_stats, label_seconds);
ENDS_WITH(brio_delaunay2_options, reserved_int);
ENDS_WITH(brio_convex_hull_options, seed);
ENDS_WITH(brio_convex_hull_stats, exact_calls);
ENDS_WITH(brio_curve_options, reserved_int);
ENDS_WITH(brio_curve_stats, curve_seconds);
ENDS_WITH(brio_curve_certificate, length);
ENDS_WITH(brio_page_layer, explanation);
ENDS_WITH(brio_page_options, reserved_int);
ENDS_WITH(brio_page_stats, reserved_int);
ENDS_WITH(brio_picture_options, reserved_int);
ENDS_WITH(brio_picture_stats, high);
ENDS_WITH(brio_planar_crust_stats, crust_seconds);
ENDS_WITH(brio_spanning_tree_stats, tree_seconds);
ENDS_WITH(brio_tiles_cells_stats, region_volume);
ENDS_WITH(brio_tiles_options, key);
ENDS_WITH(brio_tiles_stats, high);
ENDS_WITH(brio_tiles_alpha_stats, singular_facets);
ENDS_WITH(brio_faces_part, faces);
ENDS_WITH(brio_parts_options, high);
ENDS_WITH(brio_parts_stats, scratch_bytes);
ENDS_WITH(brio_ranks_options, key);
ENDS_WITH(brio_transport, room);
ENDS_WITH(brio_ranks_traffic, waited_seconds);
ENDS_WITH(brio_tile_part, num_tetrahedra);
ENDS_WITH(brio_periodic_options, reserved_more);
ENDS_WITH(brio_periodic_stats, seconds);
ENDS_WITH(brio_periodic_alpha, periodic);
ENDS_WITH(brio_periodic_shape_stats, volume);

static void statuses_have_words_of_their_own(void) {
    static const brio_status all[] = {BRIO_OK,        BRIO_ERR_ARGUMENT,  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_ANSWER,
                                      BRIO_ERR_CHECK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,  BRIO_ERR_CANCELLED,
                                      BRIO_ERR_OPEN,  BRIO_ERR_FORMAT,    BRIO_ERR_WRITE,      BRIO_ERR_INTERNAL,
                                      BRIO_STATUS_END};
    for (size_t a = 0; a < sizeof all / sizeof *all; a++)
        for (size_t b = 0; b < a; b++)
            EXPECT(strcmp(brio_status_string(all[a]), brio_status_string(all[b])) != 0, "%d, %d", all[a], all[b]);
}

static void the_library_is_of_the_headers_version(void) {
    EXPECT(!strcmp(brio_version(), BRIO_VERSION) && brio_version_number() == BRIO_VERSION_NUMBER);
}

SUITE(test_versioned) {
    RUN(zeros_are_the_default);
    RUN(without_a_size_nothing_follows);
    RUN(options_of_any_size_are_taken);
    RUN(results_stay_within_the_callers_size);
    RUN(sizes_that_were_not_set_are_arguments);
    RUN(results_that_cannot_be_freed_are_refused);
    RUN(statuses_have_words_of_their_own);
    RUN(the_library_is_of_the_headers_version);
    return harness_end();
}
