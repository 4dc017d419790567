/* The size of a triangulation, estimated from the surroundings of a few points.
 *
 * What the triangulation is like near a point depends on the points near it, and these are triangulated as they are. A
 * random sample of all points would not do: it keeps neither the noise of a scan, nor a lattice, nor what a weight
 * hides. On exact curved surfaces the number of tetrahedra a point grows with the size of the surroundings. There it is
 * extrapolated with the logarithm of the number of points; on curves, where it may grow as that number does, with a
 * power.
 *
 * Points times a power of two have the same estimate. Distances are of points times the power of two that brings the
 * greatest coordinate near 1: their squares would overflow or vanish. What is triangulated is times the power of two
 * that brings its usual point near 1, where the filters of the predicates work, and weights are times the square of
 * that. */
#include "estimate/triangulation_size.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* Chosen. MOST_TETRAHEDRA: a ball with more is made smaller. That is 32 a point of the largest. */
enum { BALLS = 12, BALL_MOST = 4096, BALL_AIM = 1500, BALL_LEAST = 400, MOST_TETRAHEDRA = 1 << 17 };
/* Chosen. MOST_EXACT: tests of triangulations that took exact arithmetic, after which FEW_BALLS are enough: points on a
 * line, or of a turned lattice, whose balls are alike, took seconds. */
enum { FEW_BALLS = 3, MOST_EXACT = 1 << 17 };
/* Derived: a set that fits into one ball is triangulated once. Twelve balls that hold all of it would cost more. */
enum { ALL = BALL_MOST };
/* Chosen. SAMPLE: points of the greatest sample; EXACT_SAMPLE: where balls took MOST_EXACT. HALVINGS: from the greatest
 * sample to the least. SAMPLE_TETRAHEDRA: a sample with more is left aside; of two lines it has 1,024 points.
 * MOST_SAMPLED: points of a set of which a sample tells a power. FEW: tetrahedra a point, of which surfaces and solids
 * have twice as many. */
enum { SAMPLE = 1 << 12, EXACT_SAMPLE = 1 << 10, HALVINGS = 5, SAMPLE_TETRAHEDRA = 1 << 18 };
enum { MOST_SAMPLED = 1 << 14, FEW = 2 };
/* Derived: scaled weights are below 2^MOST_EXPONENT, so they are finite. */
enum { MOST_EXPONENT = 1000 };

/* Chosen: of a sample, the tetrahedra a point for each of the surroundings. Scans, lattices and surfaces have less. */
static const double MORE = 1.5;
/* Chosen: a power of samples that is one of squares. Those of two lines have 1.98, of a cylinder 1.5. */
static const double SQUARE = 1.75;
static const double USUAL = 6.8; /* tetrahedra a point of uniform points */
/* The share of the tetrahedra a point that a ball has more than the ball of half its radius. In space the border of the
 * balls makes a share of 0.03. */
static const double GROWS = 0.1;
/* Chosen: the power from which on a power is extrapolated. A logarithm has less at all sizes of interest; points on a
 * curve have 1, on two lines, too. */
static const double POWER = 0.5;
/* The points that a ball has at least for each of the ball of half its radius, where its surroundings go on: on curves
 * 2. Between these and 1, where a ball holds all of a cluster. Chosen. */
static const double GOES_ON = 1.5;

/* A set of points. */
typedef struct {
    brio_context *ctx;
    const double *points, *weights;
    size_t count;
    double scale; /* distances are of points times this power of two */
} cloud;

/* The centre and the radius are scaled as distances are. */
typedef struct {
    double centre[3], radius2;
    size_t count;
    uint32_t member[BALL_MOST];
} ball;

static void scaled_point(const cloud *c, const double *p, double *scaled) {
    for (int k = 0; k < 3; k++) scaled[k] = p[k] * c->scale;
}

/* Returns the squared distance of point i from a place, both scaled. */
static double squared_distance(const cloud *c, size_t i, const double *place) {
    double p[3];
    scaled_point(c, c->points + 3 * i, p);
    return brio_square_distance(p, place);
}

/* Returns the squared diagonal of the bounding box, scaled. */
static double squared_diagonal(const cloud *c) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < c->count; i++)
        for (int k = 0; k < 3; k++) {
            double x = c->points[3 * i + (size_t)k];
            low[k] = fmin(low[k], x), high[k] = fmax(high[k], x);
        }
    scaled_point(c, low, low);
    scaled_point(c, high, high);
    return brio_square_distance(low, high);
}

static void gather_ball(const cloud *c, ball *b) {
    b->count = 0;
    for (size_t i = 0; i < c->count; i++)
        if (squared_distance(c, i, b->centre) <= b->radius2) {
            if (b->count < BALL_MOST) b->member[b->count] = (uint32_t)i;
            b->count++;
        }
}

/* Finds a ball around a point with some hundreds or thousands of points; false when there is none. */
static bool find_ball(const cloud *c, double diagonal2, size_t centre, ball *b) {
    enum { TRIES = 16 };
    scaled_point(c, c->points + 3 * centre, b->centre);
    b->radius2 = diagonal2 * BALL_AIM / (double)c->count;
    for (int i = 0; i < TRIES; i++) {
        gather_ball(c, b);
        if (b->count >= BALL_LEAST && b->count <= BALL_MOST) return true;
        b->radius2 *= (double)BALL_AIM / (double)(b->count ? b->count : 1);
    }
    return false;
}

/* What was counted at the inner points of balls: those within half of the radius. */
typedef struct {
    double points, hidden, tetrahedra;
    double balls, all; /* points of these balls, the outer ones included */
    uint64_t exact;    /* tests that took exact arithmetic */
} tally;

/* Counts the tetrahedra at inner points: a tetrahedron counts for each of its finite vertices with an equal share. */
static void count_inner(const brio_triangulation *t, const uint8_t *inner, tally *sum) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    for (size_t i = 0; i < s->tetrahedra + s->hull_facets; i++) {
        int finite = tet[i].vertex[3] == BRIO_INFINITE ? 3 : 4;
        for (int v = 0; v < finite; v++)
            if (inner[tet[i].vertex[v]]) sum->tetrahedra += 1.0 / finite;
    }
}

/* Returns the exponent of the power of two that a set is divided by: that of its usual point, or a greater one that
 * leaves all weights finite. */
static int exponent_of_set(const double *points, const double *weights, size_t count) {
    int exponent = brio_usual_exponent(points, count);
    if (!weights) return exponent;
    int least = (brio_exponent(brio_greatest(weights, count)) - MOST_EXPONENT) / 2;
    return exponent < least ? least : exponent;
}

/* Triangulates a small set, which it scales in place. BRIO_ERR_TOO_LARGE if there are too many tetrahedra. */
static brio_status triangulate(brio_context *ctx, double *points, double *weights, size_t count, uint64_t most,
                               brio_triangulation **t) {
    brio_delaunay_options o = {0};
    brio_status status = BRIO_OK;
    int exponent = exponent_of_set(points, weights, count);
    BRIO_TRY(brio_scale(ctx, points, 3 * count, -exponent, points));
    if (weights) BRIO_TRY(brio_scale(ctx, weights, count, -2 * exponent, weights));
    o.max_tetrahedra = most;
    status = brio_delaunay(ctx, points, weights, count, &o, t);
done:
    return status;
}

/* Triangulates the points of a ball within radius2 of its centre and counts at the inner ones. BRIO_ERR_TOO_LARGE if
 * there are too many tetrahedra. */
static brio_status count_ball(const cloud *c, const ball *b, double radius2, tally *sum) {
    brio_status status = BRIO_OK;
    double *points = NULL, *weights = NULL;
    uint8_t *inner = NULL;
    brio_triangulation *t = NULL;
    size_t n = 0;
    assert(BALL_LEAST <= b->count && b->count <= BALL_MOST); /* find_ball listed them all */
    BRIO_TRY(BRIO_ALLOC(c->ctx, points, 3 * b->count));
    BRIO_TRY(BRIO_ALLOC(c->ctx, weights, b->count));
    BRIO_TRY(BRIO_ALLOC(c->ctx, inner, b->count));
    for (size_t i = 0; i < b->count; i++) {
        double distance = squared_distance(c, b->member[i], b->centre);
        if (distance > radius2) continue;
        memcpy(points + 3 * n, c->points + 3 * (size_t)b->member[i], 3 * sizeof *points);
        weights[n] = c->weights ? c->weights[b->member[i]] : 0;
        assert(b->member[i] < c->count);
        inner[n++] = distance <= radius2 / 4;
    }
    BRIO_TRY(triangulate(c->ctx, points, c->weights ? weights : NULL, n, MOST_TETRAHEDRA, &t));
    const uint32_t *representative = brio_triangulation_representatives(t);
    sum->balls++, sum->all += (double)n;
    sum->exact += brio_triangulation_stats(t)->exact_calls;
    for (size_t i = 0; i < n; i++) {
        sum->points += inner[i];
        sum->hidden += inner[i] && representative[i] != i;
    }
    count_inner(t, inner, sum);
done:
    brio_triangulation_free(t);
    brio_release(c->ctx, points);
    brio_release(c->ctx, weights);
    brio_release(c->ctx, inner);
    return status;
}

/* Counts in the surroundings of some points (far), and half as far around them (near). The bar of the caller stands
 * still meanwhile. */
static brio_status count_surroundings(const cloud *c, tally *far, tally *near) {
    brio_status status = BRIO_OK;
    ball *b = NULL;
    double diagonal2 = squared_diagonal(c);
    BRIO_TRY(BRIO_ALLOC(c->ctx, b, 1));
    for (size_t i = 0; i < BALLS && (i < FEW_BALLS || far->exact < MOST_EXACT); i++) {
        BRIO_TRY(brio_progress(c->ctx, "estimate", 0));
        if (!find_ball(c, diagonal2, brio_sample_of(i, BALLS, c->count), b)) continue;
        while ((status = count_ball(c, b, b->radius2, far)) == BRIO_ERR_TOO_LARGE) b->radius2 /= 2;
        BRIO_TRY(status);
        BRIO_TRY(count_ball(c, b, b->radius2 / 4, near));
    }
done:
    brio_release(c->ctx, b);
    return status;
}

/* Triangulates as many random points, or all.   BRIO_ERR_TOO_LARGE if there are more than `most` tetrahedra. */
static brio_status size_of_sample(const cloud *c, size_t count, uint64_t most, brio_triangulation_size *size) {
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    double *points = NULL, *weights = NULL;
    BRIO_TRY(BRIO_ALLOC(c->ctx, points, 3 * count));
    if (c->weights) BRIO_TRY(BRIO_ALLOC(c->ctx, weights, count));
    for (size_t i = 0; i < count; i++) {
        size_t from = count < c->count ? brio_sample_of(i, count, c->count) : i;
        memcpy(points + 3 * i, c->points + 3 * from, 3 * sizeof *points);
        if (weights) weights[i] = c->weights[from];
    }
    BRIO_TRY(triangulate(c->ctx, points, weights, count, most, &t));
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    *size = (brio_triangulation_size){(double)(s->tetrahedra + s->hull_facets), (double)s->hidden};
done:
    brio_triangulation_free(t);
    brio_release(c->ctx, points);
    brio_release(c->ctx, weights);
    return status;
}

/* Extrapolates what was counted in surroundings. *by_power: with a power of the number of points. */
static void extrapolate(const cloud *c, const tally *far, const tally *near, brio_triangulation_size *size,
                        bool *by_power) {
    double points = (double)c->count;
    *by_power = false;
    if (far->points == 0 || near->points == 0) { /* nearly all points are at a few positions */
        *size = (brio_triangulation_size){points * USUAL, 0};
        return;
    }
    double ratio = far->tetrahedra / far->points, growth = ratio - near->tetrahedra / near->points;
    bool goes_on = far->points >= GOES_ON * near->points; /* else nothing is known of larger surroundings */
    double more = log(points * far->balls / far->all) / log(far->points / near->points);
    /* Of the ratio, from the near points to the far ones: at most as the points, since n points have at most n * n
     * tetrahedra. */
    double doubling = fmin(log(ratio / (ratio - growth)), log(far->points / near->points));
    *by_power = goes_on && doubling > POWER * log(far->points / near->points);
    if (*by_power)
        ratio *= exp(doubling * more);
    else if (goes_on && growth > GROWS * ratio)
        ratio += growth * more;
    *size = (brio_triangulation_size){points * ratio, c->weights ? points * far->hidden / far->points : 0};
}

/* The tetrahedra of samples, each of half as many points as the one before. */
typedef struct {
    double points, tetrahedra[3];
} sampled;

/* Triangulates samples, twice as many points each time, up to `most` points or SAMPLE_TETRAHEDRA. */
static brio_status take_samples(const cloud *c, size_t most, sampled *s) {
    *s = (sampled){0};
    for (int halvings = HALVINGS; halvings >= 0; halvings--) {
        brio_triangulation_size size;
        brio_status status = size_of_sample(c, most >> halvings, SAMPLE_TETRAHEDRA, &size);
        if (status == BRIO_ERR_TOO_LARGE) break;
        BRIO_FORWARD(status);
        *s = (sampled){(double)(most >> halvings), {size.tetrahedra, s->tetrahedra[0], s->tetrahedra[1]}};
    }
    return BRIO_OK;
}

/* Returns the power with which tetrahedra grow from a sample to one of twice as many points. */
static double power_of(double before, double after) {
    return before > 0 ? log2(after / before) : 1;
}

/* Corrects an estimate by what random samples tell. A sample keeps no noise and no lattice, and hides fewer points by
 * weights. So only sets without weights are sampled. The greatest sample whose tetrahedra are not too many and one of
 * half as many points give a power.
 *   Tetrahedra may join points far from each other, as those of two lines or two planes: no surroundings show them. The
 * estimate is raised, unless the sample has little more than the surroundings. A set of many points, of which a sample
 * says less, is raised with a power of 1 if it has next to no tetrahedra in surroundings; with a greater power,
 * whatever is there, if samples grow as their squares do, twice in turn.
 *   Surroundings that hold parts of several lines grow faster than the whole does. Where they are extrapolated by a
 * power, and samples tell less, the estimate is the geometric mean of both. */
static brio_status correct_by_samples(const cloud *c, const tally *far, bool by_power, brio_triangulation_size *size) {
    sampled s;
    double points = (double)c->count, known = size->tetrahedra / points;
    size_t most = far->exact < MOST_EXACT ? SAMPLE : EXACT_SAMPLE;
    bool many = c->count > MOST_SAMPLED;
    if (c->weights) return BRIO_OK;
    BRIO_FORWARD(take_samples(c, c->count < most ? c->count : most, &s));
    double power = power_of(s.tetrahedra[1], s.tetrahedra[0]), before = power_of(s.tetrahedra[2], s.tetrahedra[1]);
    double told = s.tetrahedra[0] * pow(points / s.points, fmin(power, 2));
    if (by_power && told < size->tetrahedra) size->tetrahedra = sqrt(size->tetrahedra * told);
    bool squares = power > SQUARE && before > SQUARE;
    if (s.tetrahedra[0] < MORE * known * s.points || (many && !squares && known >= FEW)) return BRIO_OK;
    if (many && !squares) told = s.tetrahedra[0] * pow(points / s.points, fmin(power, 1));
    size->tetrahedra = fmax(size->tetrahedra, told);
    return BRIO_OK;
}

brio_status brio_estimate_size(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                               brio_triangulation_size *size) {
    const double scale = brio_scale_to_one(brio_exponent(brio_greatest(points, 3 * num_points)));
    const cloud c = {ctx, points, weights, num_points, scale};
    tally far = {0}, near = {0};
    bool by_power = false;
    brio_aside aside = brio_aside_begin(ctx);
    brio_status status = num_points <= ALL ? size_of_sample(&c, num_points, MOST_TETRAHEDRA, size) : BRIO_ERR_TOO_LARGE;
    if (status == BRIO_ERR_TOO_LARGE) {
        status = count_surroundings(&c, &far, &near);
        if (status == BRIO_OK) extrapolate(&c, &far, &near, size, &by_power);
        if (status == BRIO_OK) status = correct_by_samples(&c, &far, by_power, size);
        if (status == BRIO_OK && num_points <= ALL) size->tetrahedra = fmax(size->tetrahedra, MOST_TETRAHEDRA);
    }
    brio_aside_end(ctx, &aside);
    return status;
}
