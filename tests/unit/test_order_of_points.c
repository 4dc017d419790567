/* Surfaces of the same points in another order, by any number of threads: the same to the last bit.
 *
 * Two surfaces are the same when their faces run round the same positions, their vertices have the same positions and
 * properties, and their statistics agree; the order in which vertices and faces are listed, and the corner that a face
 * starts with, are left out of the comparison.
 *
 * Without an argument: a few sets of each kind. With a number: that many noisy scans and sets of every kind beside them,
 * and the counts of sets that differ, method by method. Then may come how many times as large the scans are, without the
 * other sets, and a part of the names of the methods. */
#include "brio/testdata.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "trial.h"

enum { MOST = 60000 };

/* --- what is compared --- */

/* Sums of hashes, so that the order of what is added is of no importance. */
typedef struct {
    brio_status status;
    uint64_t faces, vertices, samples, stats;
} outcome;

static uint64_t hash_double(uint64_t hash, double x) {
    uint64_t bits;
    x += 0.0; /* -0 is 0 */
    memcpy(&bits, &x, sizeof bits);
    return brio_hash(hash, bits);
}

static uint64_t hash_position(uint64_t hash, const double *p) {
    for (int k = 0; k < 3; k++) hash = hash_double(hash, p[k]);
    return hash;
}

/* The positions round a face, hashed from the corner with which the hash is least. */
static uint64_t hash_face(const brio_mesh *m, size_t f) {
    uint64_t least = UINT64_MAX, first = m->face_offsets[f], size = m->face_offsets[f + 1] - first;
    for (uint64_t start = 0; start < size; start++) {
        uint64_t hash = size;
        for (uint64_t i = 0; i < size; i++)
            hash = hash_position(hash, m->vertices + 3 * (size_t)m->face_vertices[first + (start + i) % size]);
        least = hash < least ? hash : least;
    }
    return least;
}

static void add_mesh(const brio_mesh *m, outcome *out) {
    for (size_t f = 0; f < m->num_faces; f++) out->faces += hash_face(m, f);
    for (size_t e = 0; e < m->num_edges; e++) {
        uint64_t a = hash_position(2, m->vertices + 3 * (size_t)m->edges[2 * e]);
        uint64_t b = hash_position(2, m->vertices + 3 * (size_t)m->edges[2 * e + 1]);
        out->faces += brio_hash(a < b ? a : b, a < b ? b : a);
    }
    for (size_t v = 0; v < m->num_vertices; v++) {
        uint64_t hash = hash_position(1, m->vertices + 3 * v);
        for (size_t i = 0; i < m->num_properties; i++)
            if (strcmp(m->properties[i].name, "sample") != 0) /* whose numbers are those of the order */
                hash = hash_double(hash, brio_property_value(&m->properties[i], v));
        out->vertices += hash;
    }
}

static uint64_t hash_bytes(const void *data, size_t size) {
    uint64_t hash = size;
    for (size_t i = 0; i < size; i++) hash = brio_hash(hash, ((const uint8_t *)data)[i]);
    return hash;
}

/* --- methods --- */

typedef struct {
    const double *points;
    size_t n;
    double size; /* of the set: a distance to measure others by */
} input;

typedef struct {
    const char *name;
    void (*run)(brio_context *ctx, const input *in, int option, outcome *out);
    int option;
} method;

static uint64_t hash_crust_stats(brio_surface_stats s) {
    s.delaunay_seconds = s.poles_seconds = s.poles.power_seconds = s.poles.label_seconds = s.crust_seconds =
        s.simplify_seconds = s.noise_seconds = 0;
    return hash_bytes(&s, sizeof s);
}

enum {
    TRIANGLES = 1,
    SIMPLER = 2,
    SHARP = 4,
    OPEN = 8,
    NORMALS = 16,
    KEPT = 32,
    SMOOTHED = 64,
    SOLID = 128,
    LABELING = 256 /* times the labeling */
};

static brio_surface_options surface_options(int bits) {
    brio_surface_options o = CRUST_OPTIONS;
    o.polygons = !((bits & TRIANGLES) != 0);
    o.simplify = (bits & SIMPLER) != 0;
    o.poles.sharp = (bits & SHARP) != 0;
    o.open = bits & OPEN ? 3 : 0;
    o.noise = bits & KEPT ? BRIO_NOISE_KEEP : bits & SMOOTHED ? BRIO_NOISE_SMOOTH : BRIO_NOISE_AUTO;
    return o;
}

/* A box round the middle of the set: poles in it are inner. */
static brio_mesh *box_mesh(brio_context *ctx, const input *in) {
    static const uint32_t corner[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    uint64_t offset[13];
    double low[3], high[3], point[24];
    brio_mesh *mesh = NULL;
    for (size_t k = 0; k < 3; k++) {
        low[k] = high[k] = in->points[k];
        for (size_t i = 0; i < in->n; i++) {
            low[k] = fmin(low[k], in->points[3 * i + k]);
            high[k] = fmax(high[k], in->points[3 * i + k]);
        }
    }
    for (size_t i = 0; i < 24; i++) point[i] = i / 3 >> i % 3 & 1 ? high[i % 3] : low[i % 3];
    for (uint64_t f = 0; f < 13; f++) offset[f] = 3 * f;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, point, 8) == BRIO_OK &&
           brio_mesh_set_faces(mesh, offset, corner, 12) == BRIO_OK);
    return mesh;
}

static void add_normals(const input *in, const double *normals, outcome *out) {
    for (size_t i = 0; i < in->n; i++)
        out->samples += hash_position(hash_position(3, in->points + 3 * i), normals + 3 * i);
}

static void run_crust(brio_context *ctx, const input *in, int bits, outcome *out) {
    brio_surface_options o = surface_options(bits);
    brio_surface_stats stats = {0};
    brio_mesh *mesh = NULL, *box = bits & SOLID ? box_mesh(ctx, in) : NULL;
    double *normals = bits & NORMALS ? calloc(3 * in->n, sizeof *normals) : NULL;
    brio_laboratory *lab;
    EXPECT(trial_labeling(ctx, bits / LABELING, &o.poles, &lab) == BRIO_OK);
    o.poles.solid = box;
    out->status = make_crust(ctx, in->points, in->n, &o, &mesh, normals, &stats);
    brio_laboratory_free(lab);
    if (mesh) add_mesh(mesh, out);
    if (mesh && normals) add_normals(in, normals, out);
    out->stats = hash_crust_stats(stats);
    brio_mesh_free(mesh);
    brio_mesh_free(box);
    free(normals);
}

static void run_offset(brio_context *ctx, const input *in, int bits, outcome *out) {
    brio_surface_options crust = surface_options(bits);
    brio_surface_options o = OFFSET_OPTIONS;
    o.seed = crust.seed;
    o.poles = crust.poles;
    o.noise = crust.noise;
    o.polygons = crust.polygons;
    o.simplify = crust.simplify;
    brio_surface_stats stats = {0};
    brio_mesh *mesh = NULL;
    double distance = bits & OPEN ? -0.01 * in->size : 0.03 * in->size; /* there is no other use for the bit here */
    out->status = make_offset(ctx, in->points, in->n, distance, &o, &mesh, &stats);
    if (mesh) add_mesh(mesh, out);
    out->stats = hash_crust_stats(stats);
    brio_mesh_free(mesh);
}

static void run_medial(brio_context *ctx, const input *in, int way, outcome *out) {
    brio_power_shape_options o = {0};
    brio_power_shape_stats s = {0};
    brio_mesh *shape = NULL, *crust = NULL;
    o.sides = way & 1 ? BRIO_SIDES_BOTH : BRIO_SIDES_INNER;
    o.scale = way & 2 ? 1.1 : 1;
    o.redundancy = way & 4 ? 0.1 : 0;
    out->status = brio_power_shape(ctx, in->points, in->n, &o, &shape, way & 1 ? &crust : NULL, &s);
    if (shape) add_mesh(shape, out);
    if (crust) add_mesh(crust, out);
    s.delaunay_seconds = s.poles_seconds = s.poles.power_seconds = s.poles.label_seconds = s.simplify_seconds =
        s.shape_seconds = s.noise_seconds = 0;
    out->stats = hash_bytes(&s, sizeof s);
    brio_mesh_free(shape);
    brio_mesh_free(crust);
}

enum { TIGHT = 1, DENSITY = 2, BOUNDARIES = 4, PIECES = 8 };

static void run_cocone(brio_context *ctx, const input *in, int bits, outcome *out) {
    brio_surface_options o = COCONE_OPTIONS;
    brio_surface_stats s = {0};
    brio_mesh *mesh = NULL;
    o.method = (bits & TIGHT) != 0 ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
    o.density = (bits & DENSITY) != 0;
    o.boundaries = (bits & BOUNDARIES) != 0;
    o.pieces = bits & PIECES ? 5 : 0;
    out->status = make_cocone(ctx, in->points, in->n, &o, &mesh, &s);
    if (mesh) add_mesh(mesh, out);
    s.delaunay_seconds = s.poles_seconds = s.candidates_seconds = s.labels_seconds = s.manifold_seconds =
        s.density_seconds = 0;
    out->stats = hash_bytes(&s, sizeof s);
    brio_mesh_free(mesh);
}

static const method methods[] = {
    {"crust, global", run_crust, KEPT},
    {"crust, greedy", run_crust, KEPT | BRIO_LABELING_GREEDY *LABELING},
    {"crust, naive", run_crust, KEPT | TRIAL_NAIVE *LABELING},
    {"crust, theoretical", run_crust, KEPT | TRIAL_THEORETICAL *LABELING},
    {"crust, noise found", run_crust, TRIANGLES},
    {"crust, smoothed", run_crust, SMOOTHED | NORMALS},
    {"crust, simpler", run_crust, KEPT | SIMPLER},
    {"crust, smoothed, simpler", run_crust, SMOOTHED | SIMPLER},
    {"crust, sharp, with normals", run_crust, KEPT | SHARP | NORMALS},
    {"crust, sharp, simpler", run_crust, KEPT | SHARP | SIMPLER},
    {"crust, open", run_crust, KEPT | OPEN},
    {"crust, open, simpler", run_crust, KEPT | OPEN | SIMPLER},
    {"crust, by a solid", run_crust, KEPT | SOLID},
    {"crust, by a solid, simpler", run_crust, KEPT | SOLID | SIMPLER | NORMALS},
    {"offset outwards", run_offset, KEPT},
    {"offset inwards, simpler", run_offset, KEPT | OPEN | SIMPLER},
    {"medial axis", run_medial, 0},
    {"medial axes, crust", run_medial, 1},
    {"medial axis, scaled", run_medial, 2},
    {"medial axes, fewer balls", run_medial, 5},
    {"co-cone", run_cocone, 0},
    {"tight co-cone", run_cocone, TIGHT},
    {"co-cone, density, boundaries", run_cocone, DENSITY | BOUNDARIES},
    {"super co-cone", run_cocone, PIECES},
    {"super co-cone, density, boundaries", run_cocone, PIECES | DENSITY | BOUNDARIES},
};
enum { METHODS = sizeof methods / sizeof *methods };

/* --- sets --- */

static double points[3 * MOST], shuffled[3 * MOST];
static size_t place[MOST];

/* A scan with noise, as sparse as its number says. */
static size_t noisy_scan(brio_context *ctx, uint64_t seed, size_t wanted) {
    brio_generate_options g = {0};
    brio_mesh *mesh = NULL;
    g.noise = 0.3;
    g.seed = seed;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, wanted, &g, &mesh) == BRIO_OK);
    size_t n = mesh->num_vertices;
    memcpy(points, mesh->vertices, 3 * n * sizeof *points);
    brio_mesh_free(mesh);
    return n;
}

static double rounded(double x) {
    return round(x * 1e12) / 1e12;
}

static void set_point(size_t i, double x, double y, double z) {
    points[3 * i] = rounded(x), points[3 * i + 1] = rounded(y), points[3 * i + 2] = rounded(z);
}

/* A regular grid on a cylinder that is open at its ends: all inner poles lie on the axis, many at the same place. */
static size_t cylinder_grid(size_t around, size_t along) {
    for (size_t i = 0; i < around * along; i++) {
        double t = 6.283185307179586 * (double)(i % around) / (double)around;
        set_point(i, cos(t), sin(t), 2 * (double)(i / around) / (double)along);
    }
    return around * along;
}

static size_t torus_grid(size_t around, size_t across) {
    for (size_t i = 0; i < around * across; i++) {
        double u = 6.283185307179586 * (double)(i % around) / (double)around;
        double v = 6.283185307179586 * (double)(i / around) / (double)across;
        set_point(i, (2 + cos(v)) * cos(u), (2 + cos(v)) * sin(u), sin(v));
    }
    return around * across;
}

/* The points of a cubic lattice on the surface of a cube. */
static size_t cube_lattice(int side) {
    size_t n = 0;
    for (int x = 0; x <= side; x++)
        for (int y = 0; y <= side; y++)
            for (int z = 0; z <= side; z++)
                if (x == 0 || x == side || y == 0 || y == side || z == 0 || z == side) set_point(n++, x, y, z);
    return n;
}

/* Random points of the unit sphere with their images under the 48 symmetries of the cube. */
static size_t symmetric_sphere(uint64_t seed, size_t orbits) {
    static const int turn[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    double *one = malloc(3 * orbits * sizeof *one);
    sphere_points(seed, orbits, one);
    size_t n = 0;
    for (size_t i = 0; i < orbits; i++)
        for (int t = 0; t < 6; t++)
            for (int signs = 0; signs < 8; signs++, n++)
                for (int k = 0; k < 3; k++)
                    points[3 * n + (size_t)k] = (signs >> k & 1 ? -1 : 1) * one[3 * i + (size_t)turn[t][k]];
    free(one);
    return n;
}

static size_t clusters(uint64_t seed, size_t n) {
    clustered_points(seed, n, points);
    return n;
}

static size_t integers(uint64_t seed, size_t n) {
    integer_points(seed, n, 7, points);
    return n;
}

/* A torus whose samples stand there once to three times, zeros being of either sign. */
static size_t repeated_torus(uint64_t seed, size_t n) {
    brio_rng rng = brio_rng_new(seed + 5);
    torus_points(seed, n, points);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            if (fabs(points[3 * i + k]) < 0.02) points[3 * i + k] = 0;
    size_t all = n;
    for (size_t i = 0; i < n; i++)
        for (uint32_t twins = brio_rng_below(&rng, 3); twins > 0; twins--, all++)
            for (size_t k = 0; k < 3; k++) {
                double x = points[3 * i + k];
                points[3 * all + k] = x == 0 && twins == 2 ? -0.0 : x;
            }
    return all;
}

static size_t depth_map(uint64_t seed, size_t side) {
    depth_points(seed, side, points);
    return side * side;
}

/* --- runs --- */

static size_t sets, differing[METHODS], answered[METHODS];
static const char *wanted_methods = ""; /* a part of their names */
static bool counting;                   /* differences are counted and not failures */

static outcome outcome_of(brio_context *ctx, const method *m, const double *p, size_t n, double size, int threads) {
    outcome out = {BRIO_OK, 0, 0, 0, 0};
    input in = {p, n, size};
    brio_context_set_threads(ctx, threads);
    m->run(ctx, &in, m->option, &out);
    return out;
}

static double size_of(size_t n) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < 3 * n; i++) low = fmin(low, points[i]), high = fmax(high, points[i]);
    return high - low;
}

/* Holds the method's surfaces of two shuffles of the set, by 1 and 8 or by 2 and 3 threads, or of one of them, against
 * that of the set as it is by one thread. */
static void try_method(brio_context *ctx, size_t which, const char *set, size_t n) {
    static const int teams[2][2] = {{1, 8}, {2, 3}};
    const method *m = &methods[which];
    double size = size_of(n);
    outcome one = outcome_of(ctx, m, points, n, size, 1);
    bool same = true;
    answered[which] += one.status == BRIO_OK;
    for (int i = 0; i < (SHORT_TESTS ? 1 : 2); i++) {
        int threads = teams[(sets + which) % 2][(i + (int)(which / 2)) % 2];
        shuffle_points(100 + (uint64_t)i, n, points, shuffled, place);
        outcome other = outcome_of(ctx, m, shuffled, n, size, threads);
        bool status = one.status == other.status, faces = one.faces == other.faces;
        bool vertices = one.vertices == other.vertices && one.samples == other.samples,
             stats = one.stats == other.stats;
        same &= status & faces & vertices & stats;
        if (counting) continue;
        EXPECT(status && faces && vertices && stats,
               "%s, %zu points, %s, %d threads: another order gives another%s%s%s%s", set, n, m->name, threads,
               status ? "" : " status", faces ? "" : " surface", vertices ? "" : " vertex", stats ? "" : " count");
    }
    differing[which] += !same;
}

static void try_set(brio_context *ctx, const char *set, size_t n) {
    sets++;
    for (size_t i = 0; i < METHODS; i++)
        if (strstr(methods[i].name, wanted_methods)) try_method(ctx, i, set, n);
}

#define TRY(name, set)                                                                                                 \
    do {                                                                                                               \
        brio_context *ctx = new_context();                                                                             \
        try_set(ctx, name, set);                                                                                       \
        EXPECT(brio_context_memory(ctx) == 0);                                                                         \
        brio_context_free(ctx);                                                                                        \
    } while (0)

static void noisy_scans_are_the_same_in_every_order(void) {
    TRY("scan", noisy_scan(ctx, 3, 117));
    TRY("scan", noisy_scan(ctx, 2, 293));
}

static void grids_are_the_same_in_every_order(void) {
    TRY("cylinder", cylinder_grid(SHORT_TESTS ? 20 : 30, 7));
    if (!SHORT_TESTS) TRY("torus", torus_grid(20, 12));
    TRY("cube", cube_lattice(SHORT_TESTS ? 5 : 6));
    TRY("depth map", depth_map(1, 15));
}

static void symmetric_samples_are_the_same_in_every_order(void) {
    TRY("sphere", symmetric_sphere(1, 4));
    TRY("integers", integers(2, 150));
}

static void clusters_are_the_same_in_every_order(void) {
    TRY("clusters", clusters(3, 200));
}

static void coincident_samples_are_the_same_in_every_order(void) {
    TRY("repeated", repeated_torus(4, 150));
}

/* Many sets; `times` makes the scans larger, and leaves out the other sets. */
static int count_differences(long wanted, double times) {
    counting = true;
    brio_context *ctx = new_context();
    for (long i = 0; i < wanted; i++) {
        uint64_t seed = (uint64_t)i + 1;
        size_t n = (size_t)(60 * times * pow(1.25, (double)(i / 8 % 16)));
        try_set(ctx, "scan", noisy_scan(ctx, seed, n));
        if (i % 8 == 0 && times <= 1) {
            size_t k = (size_t)(i / 8);
            try_set(ctx, "cylinder", cylinder_grid(20 + 7 * k % 60, 5 + k % 17));
            try_set(ctx, "torus", torus_grid(16 + 5 * k % 50, 10 + 3 * k % 21));
            try_set(ctx, "cube", cube_lattice(4 + (int)(k % 12)));
            try_set(ctx, "depth map", depth_map(seed, 10 + k % 20));
            try_set(ctx, "sphere", symmetric_sphere(seed, 2 + k % 20));
            try_set(ctx, "integers", integers(seed, 100 + 50 * k));
            try_set(ctx, "clusters", clusters(seed, 100 + 50 * k));
            try_set(ctx, "repeated", repeated_torus(seed, 100 + 50 * k));
        }
    }
    brio_context_free(ctx);
    size_t all = 0;
    for (size_t i = 0; i < METHODS; i++) {
        if (!strstr(methods[i].name, wanted_methods)) continue;
        printf("%-36s %4zu of %zu sets differ, %zu have a surface\n", methods[i].name, differing[i], sets, answered[i]);
        all += differing[i];
    }
    return all > 0;
}

SUITE(test_order_of_points) {
    if (argc > 3) wanted_methods = argv[3];
    if (argc > 1) return count_differences(strtol(argv[1], NULL, 10), argc > 2 ? strtod(argv[2], NULL) : 1);
    RUN(noisy_scans_are_the_same_in_every_order);
    RUN(grids_are_the_same_in_every_order);
    RUN(symmetric_samples_are_the_same_in_every_order);
    RUN(clusters_are_the_same_in_every_order);
    RUN(coincident_samples_are_the_same_in_every_order);
    return harness_end();
}
