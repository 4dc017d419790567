/* Distance between two surfaces: random points on each and their exact nearest points on the other surface.
 *
 * The seed and i determine sample i of a surface: a triangle chosen by area (bisection in the running sums) and a
 * uniform point in the triangle. The queries run in parallel and store one result each. One thread sums the results in
 * order afterwards, so the figures do not depend on the number of threads. Both surfaces have the same number of
 * samples. So the mean, the root mean square and the 95th percentile (nearest rank) give both directions equal weight.
 *
 * Nearest points need fourth powers of lengths, which would overflow or vanish for surfaces beyond 2^HUGE_EXPONENT or
 * below 2^-HUGE_EXPONENT. Such surfaces are measured in a unit that is a power of two: the size of both together. The
 * figures are those of any other size, to the last bit.
 *
 * Based on: Cignoni, Rocchini, Scopigno. Metro: measuring error on simplified surfaces. Comput. Graph. Forum 1998. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/versioned.h"
#include "base/rng.h"
#include "base/scale.h"
#include "base/team.h"
#include "mesh/closest_point.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include <math.h>
#include <stdlib.h>

enum {
    HUGE_EXPONENT = 100, /* see above */
    DEFAULT_SAMPLES = 100000,
    BATCH = 1 << 15,     /* samples between two reports of progress */
    SAMPLES_A_CHUNK = 64 /* samples that a thread takes at once; chosen */
};

/* One of the two surfaces. */
typedef struct {
    double *scaled; /* the vertices, if the unit of the measurement is not that of the meshes; else NULL */
    brio_triangle_tree tree;
    double scale;       /* makes the surface about as large as 1, so that no normal overflows or vanishes */
    double *area_up_to; /* [t]: area of triangles 0 to t, times scale^2 */
} surface;

/* The results of the samples, in the unit of the measurement. */
typedef struct {
    size_t samples;   /* on each surface */
    double *distance; /* 2 * samples: the samples on a, then the samples on b */
    float *cosine;    /* of the angle between the normals; negative where a normal is 0 */
} measurement;

/* --- surfaces --- */

/* Returns the exponent of the size of both surfaces together, or 0 where that is an ordinary size. */
static int exponent_of(const brio_mesh *a, const brio_mesh *b) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    if (a->num_faces) brio_box_add_corners(a, 0, a->face_offsets[a->num_faces], low, high);
    if (b->num_faces) brio_box_add_corners(b, 0, b->face_offsets[b->num_faces], low, high);
    int exponent = brio_box_exponent(low, high);
    return abs(exponent) > HUGE_EXPONENT ? exponent : 0;
}

/* Writes the normal, of length twice the area, both scaled. */
static void triangle_normal(const surface *s, size_t t, double *n) {
    const double *vertices = s->tree.vertices;
    const uint32_t *corner = s->tree.triangles[t];
    brio_scaled_normal(vertices + 3 * (size_t)corner[0], vertices + 3 * (size_t)corner[1],
                       vertices + 3 * (size_t)corner[2], s->scale, n);
}

static void surface_free(brio_context *ctx, surface *s) {
    brio_triangle_tree_free(ctx, &s->tree);
    brio_release(ctx, s->scaled);
    brio_release(ctx, s->area_up_to);
}

/* Builds the tree of the surface, times 2^-exponent. */
static brio_status build_tree(brio_context *ctx, const brio_mesh *mesh, int exponent, surface *s) {
    brio_mesh in_unit = *mesh;
    if (exponent) {
        BRIO_FORWARD(BRIO_ALLOC(ctx, s->scaled, 3 * mesh->num_vertices));
        BRIO_FORWARD(brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, s->scaled));
        in_unit.vertices = s->scaled;
    }
    BRIO_FORWARD(brio_triangle_tree_new(ctx, &in_unit, &s->tree));
    s->scale = brio_power_of_two(-brio_box_exponent(s->tree.boxes[0].low, s->tree.boxes[0].high));
    return BRIO_OK;
}

static brio_status surface_new(brio_context *ctx, const brio_mesh *mesh, int exponent, const char *name, surface *s) {
    double sum = 0;
    BRIO_FORWARD(build_tree(ctx, mesh, exponent, s));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->area_up_to, s->tree.num_triangles));
    for (size_t t = 0; t < s->tree.num_triangles; t++) {
        double n[3];
        triangle_normal(s, t, n);
        sum += 0.5 * brio_length(n);
        s->area_up_to[t] = sum;
    }
    BRIO_EXPECT(ctx, sum > 0 && isfinite(sum), BRIO_ERR_ARGUMENT, "the faces of %s have area %g", name, sum);
    return BRIO_OK;
}

/* --- samples --- */

/* Returns the first triangle whose running sum exceeds `area`. */
static size_t triangle_at(const surface *s, double area) {
    size_t low = 0, high = s->tree.num_triangles - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (s->area_up_to[middle] > area)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Draws a uniform point of the surface; returns its triangle. */
static size_t sample(const surface *s, brio_rng rng, double *p) {
    size_t t = triangle_at(s, brio_rng_double(&rng) * s->area_up_to[s->tree.num_triangles - 1]);
    double r = sqrt(brio_rng_double(&rng)), q = brio_rng_double(&rng);
    double weight[3] = {1 - r, r * (1 - q), r * q};
    for (int k = 0; k < 3; k++) {
        p[k] = 0;
        for (int c = 0; c < 3; c++) p[k] += weight[c] * s->tree.vertices[3 * (size_t)s->tree.triangles[t][c] + k];
    }
    return t;
}

static float normal_cosine(const double *m, const double *n) {
    double lengths = brio_length(m) * brio_length(n);
    if (!(lengths > 0)) return -1;
    return (float)fmin(fabs(m[0] * n[0] + m[1] * n[1] + m[2] * n[2]) / lengths, 1);
}

static void measure_sample(const surface *from, const surface *to, brio_rng rng, double *distance, float *cosine) {
    double p[3], q[3], m[3], n[3];
    size_t nearest, t = sample(from, rng, p);
    *distance = sqrt(brio_closest_point(&to->tree, p, q, &nearest));
    triangle_normal(from, t, m);
    triangle_normal(to, nearest, n);
    *cosine = normal_cosine(m, n);
}

/* The samples of one surface. Their results go to m, from entry `start` on. */
typedef struct {
    const surface *from, *to;
    uint64_t seed;
    size_t start, first; /* first: first sample of the batch in work */
    measurement *m;
} sampler;

/* Measures samples first + begin to first + end - 1. */
static void measure_part(void *user, size_t begin, size_t end, int thread) {
    const sampler *s = user;
    (void)thread;
    for (size_t i = s->first + begin; i < s->first + end; i++)
        measure_sample(s->from, s->to, brio_rng_new(s->seed + i), &s->m->distance[s->start + i],
                       &s->m->cosine[s->start + i]);
}

static brio_status measure(brio_context *ctx, sampler s) {
    size_t samples = s.m->samples;
    for (; s.first < samples; s.first += BATCH) {
        size_t count = samples - s.first < BATCH ? samples - s.first : BATCH;
        BRIO_FORWARD(brio_progress(ctx, "distance", 0.5 * (double)(s.start + s.first) / (double)samples));
        BRIO_FORWARD(
            brio_for_chunks(ctx, brio_threads(ctx, count, SAMPLES_A_CHUNK), count, SAMPLES_A_CHUNK, measure_part, &s));
    }
    return BRIO_OK;
}

/* --- figures --- */

/* Returns the number that has rank `rank` when all are sorted; reorders x. */
static double select_rank(double *x, ptrdiff_t count, ptrdiff_t rank) {
    ptrdiff_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = x[low + (high - low) / 2];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (x[i] < pivot) i++;
            while (pivot < x[j]) j--;
            if (i > j) break;
            double swap = x[i];
            x[i++] = x[j];
            x[j--] = swap;
        }
        if (rank > j) low = i;
        if (rank < i) high = j;
    }
    return x[rank];
}

/* Writes the figures, in the unit of the measurement. */
static void summarise(measurement *m, brio_distance *out) {
    size_t count = 2 * m->samples, normals = 0;
    double sum = 0, squares = 0, cosines = 0;
    for (size_t i = 0; i < count; i++) {
        double d = m->distance[i];
        sum += d;
        squares += d * d;
        out->hausdorff = fmax(out->hausdorff, d);
        if (m->cosine[i] < 0) continue;
        cosines += (double)m->cosine[i];
        normals++;
    }
    out->mean = sum / (double)count;
    out->rms = sqrt(squares / (double)count);
    out->normal_consistency = normals ? cosines / (double)normals : 0;
    size_t rank = (size_t)ceil(0.95 * (double)count) - 1;
    out->p95 = select_rank(m->distance, (ptrdiff_t)count, (ptrdiff_t)rank);
}

static double diagonal_of(const brio_box *box) {
    double diagonal[3] = {box->high[0] - box->low[0], box->high[1] - box->low[1], box->high[2] - box->low[2]};
    return brio_length(diagonal);
}

/* Turns the figures into the unit of the meshes. */
static brio_status scale_back(brio_context *ctx, int exponent, brio_distance *d) {
    double *const figures[] = {&d->mean, &d->rms, &d->p95, &d->hausdorff, &d->diagonal};
    for (int i = 0; i < 5; i++) {
        *figures[i] = ldexp(*figures[i], exponent);
        BRIO_EXPECT(ctx, isfinite(*figures[i]), BRIO_BECAUSE(ctx, SCALE, BRIO_ERR_NO_ANSWER),
                    "doubles cannot hold the distances: scale the meshes down");
    }
    return BRIO_OK;
}

brio_status brio_mesh_distance(brio_context *ctx, const brio_mesh *a, const brio_mesh *b, size_t samples, uint64_t seed,
                               brio_distance *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    surface surfaces[2] = {0};
    measurement m = {.samples = samples ? samples : DEFAULT_SAMPLES};
    brio_distance found = {0};
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_distance, out));
    BRIO_GIVE(brio_distance, out, &found);
    BRIO_REQUIRE(ctx, m.samples <= SIZE_MAX / 4, BRIO_ERR_NO_MEMORY, "out of memory: %zu samples", m.samples);
    BRIO_TRY(brio_mesh_check_faces(ctx, a));
    BRIO_TRY(brio_mesh_check_faces(ctx, b));
    BRIO_TRY(brio_refuse_vertices(ctx, a->vertices, a->num_vertices, "the first mesh"));
    BRIO_TRY(brio_refuse_vertices(ctx, b->vertices, b->num_vertices, "the second mesh"));
    int exponent = exponent_of(a, b);
    BRIO_TRY(surface_new(ctx, a, exponent, "the first mesh", &surfaces[0]));
    BRIO_TRY(surface_new(ctx, b, exponent, "the second mesh", &surfaces[1]));
    BRIO_TRY(BRIO_ALLOC(ctx, m.distance, 2 * m.samples));
    BRIO_TRY(BRIO_ALLOC(ctx, m.cosine, 2 * m.samples));
    BRIO_TRY(measure(ctx, (sampler){&surfaces[0], &surfaces[1], brio_mix(seed), 0, 0, &m}));
    BRIO_TRY(measure(ctx, (sampler){&surfaces[1], &surfaces[0], brio_mix(brio_mix(seed)), m.samples, 0, &m}));
    BRIO_TRY(brio_progress(ctx, "distance", 1));
    summarise(&m, &found);
    found.diagonal = diagonal_of(&surfaces[1].tree.boxes[0]);
    BRIO_TRY(scale_back(ctx, exponent, &found));
    BRIO_GIVE(brio_distance, out, &found);
done:
    surface_free(ctx, &surfaces[0]);
    surface_free(ctx, &surfaces[1]);
    brio_release(ctx, m.distance);
    brio_release(ctx, m.cosine);
    return status;
}
