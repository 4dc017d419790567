/* A simulated laser scan of the sculpture.
 *
 * The sensors stand on a sphere round the sculpture, evenly spread by the golden-angle spiral, so that parts occlude
 * each other as in a real scan. Each sensor looks at the centre through a square raster of pixels, rolled by a random
 * angle. Sphere tracing moves along a ray in steps of the function's value, which never exceeds the distance to the
 * surface, until the ray touches. Hits at a grazing angle are dropped, as scanners drop them. All other hits move
 * along the ray by Gaussian noise. Its standard deviation is a share of the distance between neighbouring rays at that
 * depth.
 *
 * A coarse pass estimates the share of rays that hit; the size of the raster follows from this share. The seed, the
 * view and the pixel determine every number, for any number of threads.
 *
 * Based on: Hart. Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces. The Visual
 * Computer 1996. Marsaglia, Bray. A convenient method for generating normal variables. SIAM Review 1964. */
#include "brio/testdata.h"
#include "testdata/scan.h"
#include "base/finite.h"
#include "base/rng.h"
#include "base/team.h"
#include "base/vector.h"
#include "testdata/sculpture.h"
#include <math.h>
#include <string.h>

enum {
    LEAST_COARSE_RAYS = 1 << 13,
    MOST_COARSE_RAYS = 1 << 17,
    BLOCK = 1 << 14,   /* pixels between two reports of progress */
    RAYS_A_CHUNK = 64, /* rays that a thread takes at once; chosen */
    MOST_STEPS = 1000
};

static const double DISTANCE = 4;           /* of a sensor from the centre, in radii of the ball round the sculpture */
static const double GRAZING_COSINE = 0.225; /* cosine of 77 degrees, between ray and normal */
static const double TOUCH = 1e-7;           /* distance at which a ray has hit */

typedef struct {
    double position[3], forward[3], right[3], up[3];
} sensor;

typedef struct {
    double centre[3], radius; /* of the ball that holds the sculpture */
    double half_width;        /* half width of a raster at unit depth: the raster just covers that ball */
    uint64_t seed;
    int views;
    double noise;
} scanner;

/* The state of a running scan. */
typedef struct {
    brio_context *ctx;
    const scanner *scanner;
    double raster;    /* pixels a side */
    double *measured; /* positions of a block of pixels */
    bool *seen;       /* whether each pixel of the block has a position */
    double *points;   /* all points so far */
    uint16_t *views;
    size_t count, point_capacity, view_capacity;
} scan;

/* --- vectors --- */

static void normalise(double *a) {
    double length = sqrt(brio_dot(a, a));
    for (int k = 0; k < 3; k++) a[k] /= length;
}

/* --- sensors --- */

static scanner scanner_new(const brio_generate_options *options) {
    scanner s = {.seed = brio_mix(options->seed), .views = options->views, .noise = options->noise};
    double low[3], high[3], square = 0;
    brio_sculpture_box(low, high);
    for (int k = 0; k < 3; k++) {
        s.centre[k] = 0.5 * (low[k] + high[k]);
        square += 0.25 * (high[k] - low[k]) * (high[k] - low[k]);
    }
    s.radius = sqrt(square);
    s.half_width = 1 / sqrt(DISTANCE * DISTANCE - 1);
    return s;
}

static sensor sensor_of_view(const scanner *s, int view) {
    const double golden_angle = 2.39996322972865332, full_turn = 6.28318530717958648;
    sensor e;
    double z = 1 - (2 * view + 1.0) / s->views, r = sqrt(1 - z * z), angle = golden_angle * view;
    double towards[3] = {r * cos(angle), r * sin(angle), z};
    for (int k = 0; k < 3; k++) {
        e.position[k] = s->centre[k] + DISTANCE * s->radius * towards[k];
        e.forward[k] = -towards[k];
    }
    double other[3] = {fabs(z) > 0.9, 0, fabs(z) <= 0.9}, right[3], up[3];
    brio_cross(e.forward, other, right);
    normalise(right);
    brio_cross(right, e.forward, up);
    brio_rng rng = brio_rng_new(s->seed + (uint64_t)view);
    double roll = full_turn * brio_rng_double(&rng), c = cos(roll), q = sin(roll);
    for (int k = 0; k < 3; k++) {
        e.right[k] = c * right[k] + q * up[k];
        e.up[k] = c * up[k] - q * right[k];
    }
    return e;
}

/* --- rays --- */

/* Returns the direction of the ray through a pixel. The raster has `raster` pixels a side. This number need not be an
 * integer, so that the number of hits can be chosen; it is rounded up evenly on all sides. */
static void ray_of_pixel(const scanner *s, const sensor *e, double raster, uint64_t pixel, double *ray) {
    uint64_t side = (uint64_t)ceil(raster), row = pixel / side, column = pixel % side;
    double x = s->half_width * (2 * (double)column + 1 - (double)side) / raster;
    double y = s->half_width * ((double)side - 1 - 2 * (double)row) / raster;
    for (int k = 0; k < 3; k++) ray[k] = e->forward[k] + x * e->right[k] + y * e->up[k];
    normalise(ray);
}

static void walk(const double *from, const double *ray, double t, double *p) {
    for (int k = 0; k < 3; k++) p[k] = from[k] + t * ray[k];
}

/* Returns the cosine of the angle between the ray and the surface's normal, by central differences. */
static double incidence(const double *p, const double *ray) {
    const double h = 1e-5;
    double normal[3];
    for (int k = 0; k < 3; k++) {
        double q[3] = {p[0], p[1], p[2]};
        q[k] += h;
        normal[k] = brio_sculpture(q, NULL);
        q[k] -= 2 * h;
        normal[k] -= brio_sculpture(q, NULL);
    }
    return -brio_dot(normal, ray) / sqrt(brio_dot(normal, normal));
}

/* Returns the distance along the ray at which the scanner sees the surface, or 0 when the ray misses. */
static double trace(const scanner *s, const sensor *e, const double *ray) {
    double t = (DISTANCE - 1) * s->radius, end = (DISTANCE + 1) * s->radius, p[3];
    for (int step = 0; step < MOST_STEPS && t < end; step++) {
        walk(e->position, ray, t, p);
        double f = brio_sculpture(p, NULL);
        if (f < TOUCH) return incidence(p, ray) > GRAZING_COSINE ? t : 0;
        t += f;
    }
    return 0;
}

/* Draws a standard normal variable by the polar method. */
static double gaussian(brio_rng *rng) {
    double x, square;
    do {
        double y = 2 * brio_rng_double(rng) - 1;
        x = 2 * brio_rng_double(rng) - 1;
        square = x * x + y * y;
    } while (square >= 1 || square == 0);
    return x * sqrt(-2 * log(square) / square);
}

/* --- rasters --- */

/* The coarse rasters of all views. */
typedef struct {
    const scanner *scanner;
    uint64_t side;
    int64_t hits;
} coarse_scan;

/* Counts the rays that hit, for some views. */
static void count_hits(void *user, size_t begin, size_t end, int thread) {
    coarse_scan *c = user;
    int64_t hits = 0;
    (void)thread;
    for (size_t view = begin; view < end; view++) {
        sensor e = sensor_of_view(c->scanner, (int)view);
        for (uint64_t pixel = 0; pixel < c->side * c->side; pixel++) {
            double ray[3];
            ray_of_pixel(c->scanner, &e, (double)c->side, pixel, ray);
            hits += trace(c->scanner, &e, ray) > 0;
        }
    }
    __atomic_fetch_add(&c->hits, hits, __ATOMIC_RELAXED); /* read after all threads have ended */
}

/* Chooses the size of the raster, in pixels a side: all views together hit about n times. */
static brio_status choose_raster(scan *c, size_t n) {
    const scanner *s = c->scanner;
    double rays = fmin(fmax(4 * (double)n, LEAST_COARSE_RAYS), MOST_COARSE_RAYS);
    uint64_t side = (uint64_t)ceil(sqrt(rays / s->views)), pixels = side * side;
    size_t views = (size_t)s->views;
    coarse_scan coarse = {s, side, 0};
    int threads = brio_threads(c->ctx, views * pixels, RAYS_A_CHUNK);
    brio_status status = brio_for_chunks(c->ctx, threads, views, 1, count_hits, &coarse);
    c->raster = sqrt((double)n / fmax((double)coarse.hits, 1) * (double)pixels);
    return status;
}

/* Measures one pixel. Returns false when the scanner sees nothing there. */
static bool measure(const scanner *s, const sensor *e, double raster, int view, uint64_t pixel, double *p) {
    double ray[3];
    ray_of_pixel(s, e, raster, pixel, ray);
    double t = trace(s, e, ray);
    if (t == 0) return false;
    double spacing = 2 * s->half_width / raster * t * brio_dot(ray, e->forward);
    brio_rng rng = brio_rng_new(brio_mix(s->seed ^ (uint64_t)view) + pixel);
    walk(e->position, ray, t + s->noise * spacing * gaussian(&rng), p);
    return true;
}

/* Pixels of one view, from pixel `first` on. */
typedef struct {
    const scan *scan;
    const sensor *sensor;
    int view;
    uint64_t first;
} block;

static void measure_pixels(void *user, size_t begin, size_t end, int thread) {
    const block *b = user;
    const scan *c = b->scan;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        c->seen[i] = measure(c->scanner, b->sensor, c->raster, b->view, b->first + i, c->measured + 3 * i);
}

static brio_status scan_block(scan *c, const sensor *e, int view, uint64_t first, uint64_t end) {
    size_t pixels = (size_t)(end - first);
    BRIO_FORWARD(brio_for_chunks(c->ctx, brio_threads(c->ctx, pixels, RAYS_A_CHUNK), pixels, RAYS_A_CHUNK,
                                 measure_pixels, &(block){c, e, view, first}));
    for (uint64_t i = 0; i < end - first; i++) {
        const double *p = c->measured + 3 * i;
        if (!c->seen[i]) continue;
        BRIO_EXPECT(c->ctx, brio_all_finite(p, 3), BRIO_ERR_ARGUMENT,
                    "noise %g moves a point farther than doubles can hold", c->scanner->noise);
        BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->points, c->point_capacity, 3 * c->count + 3));
        BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->views, c->view_capacity, c->count + 1));
        for (int k = 0; k < 3; k++) c->points[3 * c->count + k] = p[k];
        c->views[c->count++] = (uint16_t)view;
    }
    return BRIO_OK;
}

static brio_status scan_view(scan *c, int view) {
    sensor e = sensor_of_view(c->scanner, view);
    uint64_t side = (uint64_t)ceil(c->raster), pixels = side * side;
    for (uint64_t first = 0; first < pixels; first += BLOCK) {
        double done_pixels = (double)first / (double)pixels;
        BRIO_FORWARD(brio_progress(c->ctx, "scan", (view + done_pixels) / c->scanner->views));
        BRIO_FORWARD(scan_block(c, &e, view, first, pixels - first < BLOCK ? pixels : first + BLOCK));
    }
    return BRIO_OK;
}

static brio_status make_mesh(scan *c, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    void *views;
    BRIO_TRY(brio_mesh_new(c->ctx, &mesh));
    BRIO_TRY(BRIO_RESIZE(c->ctx, c->points, 3 * c->count));
    mesh->vertices = c->points;
    mesh->num_vertices = c->count;
    c->points = NULL;
    BRIO_TRY(brio_mesh_add_property(mesh, "view", BRIO_SCALAR_UINT16, &views));
    if (c->count) memcpy(views, c->views, c->count * sizeof *c->views);
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    return status;
}

brio_status brio_scan(brio_context *ctx, size_t n, const brio_generate_options *options, brio_mesh **out) {
    brio_status status = BRIO_OK;
    scanner s = scanner_new(options);
    scan c = {.ctx = ctx, .scanner = &s};
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, c.measured, 3 * BLOCK));
    BRIO_TRY(BRIO_ALLOC(ctx, c.seen, BLOCK));
    if (n) BRIO_TRY(choose_raster(&c, n));
    for (int view = 0; view < s.views; view++) BRIO_TRY(scan_view(&c, view));
    BRIO_TRY(brio_progress(ctx, "scan", 1));
    BRIO_TRY(make_mesh(&c, out));
done:
    brio_release(ctx, c.points);
    brio_release(ctx, c.views);
    brio_release(ctx, c.measured);
    brio_release(ctx, c.seen);
    return status;
}
