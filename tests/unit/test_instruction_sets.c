/* Every instruction set that the processor has gives the same bits: triangulations, centres, surfaces. */
#include "harness.h"
#include "instruction_sets.h"
#include "points.h"
#include "surface_calls.h"
#include "predicates/circumcentre.h"

enum { POINTS = 4000, BATCHES = 200 };

/* A hash of everything that is under test, by which runs are compared: bytes in their order. */
typedef struct {
    uint64_t hash;
} digest;

static void add_bytes(digest *d, const void *bytes, size_t size) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++) d->hash = (d->hash ^ b[i]) * UINT64_C(0x100000001b3);
}

static digest digest_begin(void) {
    return (digest){UINT64_C(0xcbf29ce484222325)};
}

static void add_triangulation(brio_context *ctx, const double *points, const double *weights, digest *d) {
    brio_triangulation *t = NULL;
    EXPECT(brio_delaunay(ctx, points, weights, POINTS, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    const brio_delaunay_stats *stats = brio_triangulation_stats(t);
    size_t count = stats->tetrahedra + stats->hull_facets;
    add_bytes(d, brio_triangulation_tetrahedra(t), count * sizeof(brio_tetrahedron));
    brio_triangulation_free(t);
}

static void add_mesh(brio_mesh *mesh, digest *d) {
    EXPECT(mesh && mesh->num_faces > 0);
    if (!mesh) return;
    add_bytes(d, mesh->vertices, 3 * mesh->num_vertices * sizeof *mesh->vertices);
    add_bytes(d, mesh->face_vertices, mesh->face_offsets[mesh->num_faces] * sizeof *mesh->face_vertices);
    brio_mesh_free(mesh);
}

/* Uniform, on a lattice, nearly cospherical, each without and with weights. */
static digest digest_of_triangulations(void) {
    static double points[3 * POINTS], weights[POINTS];
    brio_context *ctx = new_context();
    digest d = digest_begin();
    for (int kind = 0; kind < 3; kind++) {
        if (kind == 0) uniform_points(3, POINTS, points);
        if (kind == 1) integer_points(3, POINTS, 20, points);
        if (kind == 2) sphere_points(3, POINTS, points);
        integer_weights(5, POINTS, 100, weights);
        for (size_t i = 0; i < POINTS; i++) weights[i] *= kind == 1 ? 1 : 1e-4;
        add_triangulation(ctx, points, NULL, &d);
        add_triangulation(ctx, points, weights, &d);
    }
    brio_context_free(ctx);
    return d;
}

/* Tetrahedra of ordinary shape, nearly flat, flat, tiny and huge. */
static void mixed_batch(uint64_t trial, double *p, double *w) {
    enum { ROWS = 4 * BRIO_CENTRE_BATCH };
    uniform_points(trial, ROWS, p);
    for (size_t i = 0; i < ROWS; i++) {
        w[i] = 0.1 * p[3 * i];
        size_t kind = i / 4 % 5;
        if (kind == 1) p[3 * i + 2] *= ldexp(1, -(int)(trial % 60));
        if (kind == 2) p[3 * i + 2] = 0.25;
        for (size_t k = 0; kind == 3 && k < 3; k++) p[3 * i + k] = ldexp(p[3 * i + k], trial % 2 ? -1060 : -500);
        for (size_t k = 0; kind == 4 && k < 3; k++) p[3 * i + k] = ldexp(p[3 * i + k], trial % 2 ? 1020 : 300);
    }
}

static digest digest_of_centres(void) {
    enum { COUNT = BRIO_CENTRE_BATCH };
    static double p[12 * COUNT], w[4 * COUNT], centre[3 * COUNT], error[COUNT], rough[4 * COUNT];
    uint32_t vertex[COUNT][4];
    digest d = digest_begin();
    for (uint32_t i = 0; i < 4 * COUNT; i++) vertex[i / 4][i % 4] = i;
    for (uint64_t trial = 0; trial < BATCHES; trial++) {
        brio_centre_batch b = {p, trial % 2 ? w : NULL, (const uint32_t(*)[4])vertex, COUNT - trial % 3};
        mixed_batch(trial / 2, p, w);
        brio_centres(&b, centre, error);
        for (size_t n = 0; n < b.count; n++) {
            if (isnan(centre[3 * n])) continue;
            add_bytes(&d, centre + 3 * n, 3 * sizeof *centre);
            add_bytes(&d, error + n, sizeof *error);
        }
        uniform_points(trial, 4 * COUNT, p);
        for (size_t i = 0; i < 4 * COUNT; i++) p[3 * i + 2] *= ldexp(1, -(int)(i / 4));
        b.weights = NULL;
        brio_rough_centres(&b, rough);
        for (size_t n = 0; n < b.count; n++)
            if (!isnan(rough[4 * n])) add_bytes(&d, rough + 4 * n, 4 * sizeof *rough);
    }
    return d;
}

static digest digest_of_surfaces(void) {
    static double points[3 * POINTS];
    brio_context *ctx = new_context();
    digest d = digest_begin();
    brio_mesh *mesh = NULL;
    torus_points(9, POINTS, points);
    EXPECT(make_crust(ctx, points, POINTS, NULL, &mesh, NULL, NULL) == BRIO_OK, "%s", brio_message(ctx));
    add_mesh(mesh, &d);
    mesh = NULL;
    EXPECT(make_cocone(ctx, points, POINTS, NULL, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    add_mesh(mesh, &d);
    brio_context_free(ctx);
    return d;
}

static void compare_sets(digest (*digest_of)(void)) {
    brio_use_instructions(BRIO_PLAIN);
    digest plain = digest_of();
    for (int set = BRIO_PLAIN + 1; set < BRIO_INSTRUCTION_SETS; set++) {
        if (!use_set(set)) continue;
        EXPECT(digest_of().hash == plain.hash, "%s", brio_instruction_set_name((brio_instruction_set)set));
    }
    use_largest_set();
}

static void triangulations_have_the_same_bits(void) {
    compare_sets(digest_of_triangulations);
}

static void centres_have_the_same_bits(void) {
    compare_sets(digest_of_centres);
}

static void surfaces_have_the_same_bits(void) {
    compare_sets(digest_of_surfaces);
}

static void the_environment_lowers_the_set(void) {
    brio_instruction_set most = brio_most_instructions();
    EXPECT(brio_instructions_for(NULL) == most);
    EXPECT(brio_instructions_for("") == most && brio_instructions_for("AVX2") == most);
    for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++) {
        brio_instruction_set named = (brio_instruction_set)set;
        EXPECT(brio_instructions_for(brio_instruction_set_name(named)) == (named < most ? named : most));
    }
}

/* What the system lists of an x86 processor, or NULL. A program for another one may see this machine's list through its
 * emulator. */
static const char *listed_flags(void) {
    bool listed = false;
    static char line[1 << 16];
#ifdef __x86_64__
    FILE *facts = fopen("/proc/cpuinfo", "r");
    while (facts && !listed && fgets(line, sizeof line, facts)) listed = !strncmp(line, "flags", 5);
    if (facts) fclose(facts);
#endif
    return listed ? line : NULL;
}

/* The programs and packages of the cross compiler used no instruction set but the plain one. */
static void the_largest_set_is_that_which_the_system_lists(void) {
    const char *line = listed_flags();
    if (!line) {
        printf("skipped: no system lists here what an x86 processor has\n");
        return;
    }
    bool avx2 = strstr(line, " avx2 ") && strstr(line, " fma ");
    bool avx512 = avx2 && strstr(line, " avx512f ") && strstr(line, " avx512dq ") && strstr(line, " avx512vl ");
    EXPECT(brio_most_instructions() == (avx512 ? BRIO_AVX512
                                        : avx2 ? BRIO_AVX2
                                               : BRIO_PLAIN),
           "%s: %s", brio_instruction_set_name(brio_most_instructions()), line);
}

SUITE(test_instruction_sets) {
    RUN(the_largest_set_is_that_which_the_system_lists);
    RUN(the_environment_lowers_the_set);
    RUN(triangulations_have_the_same_bits);
    RUN(centres_have_the_same_bits);
    RUN(surfaces_have_the_same_bits);
    return harness_end();
}
