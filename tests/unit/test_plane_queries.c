/* Queries of triangulations of the plane against brute force: location, nearest vertices, interpolation, Voronoi diagrams;
 * ties, hostile points, weights, every dimension. */
#include "failing_allocator.h"
#include "harness.h"
#include "plane_locate_brute.h"
#include "points.h"

enum { MOST = 400, QUERIES = 500 };

typedef struct {
    const char *name;
    double p[2 * MOST], w[MOST];
    bool weighted;
    size_t n;
} set;

typedef struct {
    brio_context *ctx;
    brio_triangulation2 *t;
    brio_locator2 *l;
    const double *w;
} fixture;

static fixture fixture_new(const set *s) {
    fixture f = {.ctx = new_context(), .w = s->weighted ? s->w : NULL};
    EXPECT(brio_delaunay2(f.ctx, s->p, f.w, s->n, NULL, &f.t) == BRIO_OK);
    EXPECT(brio_locator2_new(f.ctx, f.t, s->p, f.w, s->n, &f.l) == BRIO_OK, "%s: %s", s->name, brio_message(f.ctx));
    return f;
}

static void fixture_free(fixture *f) {
    brio_locator2_free(f->l);
    brio_triangulation2_free(f->t);
    EXPECT(brio_context_memory(f->ctx) == 0);
    brio_context_free(f->ctx);
}

/* --- sets --- */

static void place(set *s, const char *name, size_t n, bool weighted) {
    brio_rng rng = brio_rng_new(n + weighted);
    s->name = name, s->n = n, s->weighted = weighted;
    for (size_t i = 0; i < n; i++) s->w[i] = weighted ? 0.01 * brio_rng_double(&rng) : 0;
    for (size_t i = 0; i < 2 * n; i++) s->p[i] = brio_rng_double(&rng);
}

static void place_grid(set *s, size_t n, uint32_t side, bool weighted) {
    brio_rng rng = brio_rng_new(n + side);
    place(s, weighted ? "grid with weights" : "grid", n, weighted);
    for (size_t i = 0; i < 2 * n; i++) s->p[i] = brio_rng_below(&rng, side);
    for (size_t i = 0; i < n; i++) s->w[i] = brio_rng_below(&rng, 5);
}

static void place_circle(set *s, size_t n) {
    place(s, "circle", n, false);
    for (size_t i = 0; i < n; i++) s->p[2 * i] = cos((double)i), s->p[2 * i + 1] = sin((double)i);
}

static void place_line(set *s, size_t n, bool weighted) {
    brio_rng rng = brio_rng_new(n);
    place(s, "line", n, weighted);
    for (size_t i = 0; i < n; i++) s->p[2 * i] = brio_rng_below(&rng, 50), s->p[2 * i + 1] = 3 * s->p[2 * i];
    for (size_t i = 0; i < n; i++) s->w[i] = brio_rng_below(&rng, 40);
}

static void scale_set(set *s, const char *name, double factor) {
    s->name = name;
    for (size_t i = 0; i < 2 * s->n; i++) s->p[i] *= factor;
}

/* Far from 0, so that differences lose nothing but circles do. */
static void move_set(set *s, double by) {
    s->name = "far from 0";
    for (size_t i = 0; i < 2 * s->n; i++) s->p[i] = s->p[i] + by;
}

/* Points along two nearly parallel lines: slivers. */
static void place_slivers(set *s, size_t n) {
    place(s, "slivers", n, false);
    for (size_t i = 0; i < n; i++) s->p[2 * i + 1] = (i % 2 ? 1e-9 : 0) + 1e-12 * s->p[2 * i + 1];
}

static void for_all_sets(void (*check)(const set *s)) {
    static set s;
    for (size_t n = 0; n < 8; n++)
        for (uint32_t side = 1; side < 5; side++) place_grid(&s, n, side, n % 2), check(&s);
    place(&s, "uniform", 300, false), check(&s);
    place(&s, "uniform with weights", 300, true), check(&s);
    place_grid(&s, 300, 9, false), check(&s);
    place_grid(&s, 300, 12, true), check(&s);
    place_circle(&s, 200), check(&s);
    place_line(&s, 60, false), check(&s);
    place_line(&s, 60, true), check(&s);
    place(&s, "", 120, false), scale_set(&s, "huge", 1e150), check(&s);
    place(&s, "", 120, false), scale_set(&s, "tiny", 1e-150), check(&s);
    place(&s, "", 120, false), move_set(&s, 1e6), check(&s);
    place_slivers(&s, 100), check(&s);
}

/* Queries at vertices, on edges and their lines, inside and outside. */
static void make_queries(const set *s, double *x) {
    brio_rng rng = brio_rng_new(s->n + 9);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < 2 * s->n; i++)
        low[i % 2] = fmin(low[i % 2], s->p[i]), high[i % 2] = fmax(high[i % 2], s->p[i]);
    for (size_t i = 0; i < QUERIES; i++) {
        uint32_t kind = brio_rng_below(&rng, 5), most = s->n ? (uint32_t)s->n : 1;
        size_t a = brio_rng_below(&rng, most), b = brio_rng_below(&rng, most), c = brio_rng_below(&rng, most);
        for (size_t k = 0; k < 2; k++) {
            double *to = &x[2 * i + k];
            if (!s->n)
                *to = brio_rng_double(&rng);
            else if (kind == 0)
                *to = s->p[2 * a + k];
            else if (kind == 1)
                *to = 0.5 * s->p[2 * a + k] + 0.5 * s->p[2 * b + k];
            else if (kind == 2)
                *to = 0.25 * s->p[2 * a + k] + 0.25 * s->p[2 * b + k] + 0.5 * s->p[2 * c + k];
            else
                *to = low[k] + (kind == 3 ? brio_rng_double(&rng) : 3 * brio_rng_double(&rng) - 1) * (high[k] - low[k]);
        }
    }
}

/* --- location --- */

static void check_location(const set *s) {
    fixture f = fixture_new(s);
    double x[2 * QUERIES];
    uint32_t found[QUERIES];
    make_queries(s, x);
    EXPECT(brio_locator2_triangles(f.ctx, f.l, x, QUERIES, found) == BRIO_OK, "%s", brio_message(f.ctx));
    for (size_t i = 0; i < QUERIES; i++) {
        uint32_t right = brute_triangle(s->p, f.t, x + 2 * i);
        EXPECT(found[i] == right, "%s: query %zu (%a %a) got %u, not %u", s->name, i, x[2 * i], x[2 * i + 1], found[i],
               right);
    }
    fixture_free(&f);
}

static void triangles_are_those_of_brute_force(void) {
    for_all_sets(check_location);
}

static void check_nearest(const set *s) {
    fixture f = fixture_new(s);
    double x[2 * QUERIES];
    uint32_t found[QUERIES];
    const uint32_t *representative = brio_triangulation2_representatives(f.t);
    make_queries(s, x);
    x[0] = 1e300, x[1] = -1e300;
    EXPECT(brio_locator2_least_power(f.ctx, f.l, x, QUERIES, found) == BRIO_OK, "%s", brio_message(f.ctx));
    for (size_t i = 0; i < QUERIES; i++) {
        EXPECT((found[i] == BRIO_INFINITE) == (s->n == 0), "%s", s->name);
        if (found[i] == BRIO_INFINITE) continue;
        EXPECT(found[i] < s->n && representative[found[i]] == found[i], "%s: %u", s->name, found[i]);
        for (size_t p = 0; p < s->n; p++)
            EXPECT(!plane_comes_before(s->p, f.w, x + 2 * i, p, found[i]), "%s: query %zu got %u, not %zu", s->name, i,
                   found[i], p);
    }
    fixture_free(&f);
}

static void least_power_is_that_of_brute_force(void) {
    for_all_sets(check_nearest);
}

static void answers_do_not_depend_on_the_threads(void) {
    static set s;
    static double x[2 * 20 * QUERIES], values[MOST], rows[3][20 * QUERIES];
    static uint32_t found[3][20 * QUERIES], nearest[3][20 * QUERIES];
    size_t count = 20 * QUERIES;
    brio_interpolation o = {0};
    place(&s, "uniform", 300, false);
    for (size_t i = 0; i < 20; i++) make_queries(&s, x + 2 * QUERIES * i);
    for (size_t i = 0; i < s.n; i++) values[i] = sin((double)i);
    o.values = values;
    fixture f = fixture_new(&s);
    for (int k = 0; k < 3; k++) {
        brio_context_set_threads(f.ctx, k + 1);
        EXPECT(brio_locator2_triangles(f.ctx, f.l, x, count, found[k]) == BRIO_OK);
        EXPECT(brio_locator2_least_power(f.ctx, f.l, x, count, nearest[k]) == BRIO_OK);
        EXPECT(brio_locator2_interpolate(f.ctx, f.l, x, count, &o, rows[k]) == BRIO_OK);
        EXPECT(!memcmp(found[0], found[k], sizeof found[0]) && !memcmp(nearest[0], nearest[k], sizeof nearest[0]));
        EXPECT(!memcmp(rows[0], rows[k], sizeof rows[0]));
    }
    fixture_free(&f);
}

/* --- interpolation --- */

static brio_status interpolate(const fixture *f, int method, const double *values, size_t components, const double *x,
                               size_t count, double *rows) {
    brio_interpolation o = {0};
    o.method = (brio_interpolation_method)method;
    o.values = values;
    o.components = components;
    return brio_locator2_interpolate(f->ctx, f->l, x, count, &o, rows);
}

/* A constant, and the two coordinates. */
static void check_linear_functions(const set *s) {
    fixture f = fixture_new(s);
    double x[2 * QUERIES], rows[3 * QUERIES], values[3 * MOST], most = 0;
    uint32_t found[QUERIES];
    make_queries(s, x);
    for (size_t i = 0; i < s->n; i++) {
        values[3 * i] = 1;
        for (size_t k = 0; k < 2; k++) most = fmax(most, fabs(values[3 * i + 1 + k] = s->p[2 * i + k]));
    }
    if (brio_triangulation2_stats(f.t)->dimension < 2) { /* points_on_a_line_are_interpolated_along_it */
        fixture_free(&f);
        return;
    }
    EXPECT(brio_locator2_triangles(f.ctx, f.l, x, QUERIES, found) == BRIO_OK);
    for (int method = s->weighted; method < 2; method++) {
        EXPECT(interpolate(&f, method, values, 3, x, QUERIES, rows) == BRIO_OK, "%s", brio_message(f.ctx));
        for (size_t i = 0; i < QUERIES; i++) {
            EXPECT(isnan(rows[3 * i]) == (found[i] == BRIO_INFINITE), "%s: query %zu", s->name, i);
            if (found[i] == BRIO_INFINITE) continue;
            EXPECT(fabs(rows[3 * i] - 1) <= 1e-12, "%s, method %d: %.17g", s->name, method, rows[3 * i]);
            for (size_t k = 0; k < 2; k++)
                EXPECT(fabs(rows[3 * i + 1 + k] - x[2 * i + k]) <= 1e-13 * most,
                       "%s, method %d, query %zu: %.17g, not %.17g", s->name, method, i, rows[3 * i + 1 + k],
                       x[2 * i + k]);
        }
    }
    fixture_free(&f);
}

static void linear_functions_are_reproduced(void) {
    for_all_sets(check_linear_functions);
}

static void check_values_at_the_ends_of_doubles(const set *s) {
    static const double ends[] = {0x1p-1074, -0x1p-1074, 0x1.fffffffffffffp1023, -0x1.fffffffffffffp1023};
    fixture f = fixture_new(s);
    double x[2 * QUERIES], rows[4 * QUERIES], values[4 * MOST];
    make_queries(s, x);
    for (size_t i = 0; i < 4 * s->n; i++) values[i] = ends[i % 4];
    if (brio_triangulation2_stats(f.t)->dimension < 2) { /* points_on_a_line_are_interpolated_along_it */
        fixture_free(&f);
        return;
    }
    for (int method = s->weighted; method < 2; method++) {
        EXPECT(interpolate(&f, method, values, 4, x, QUERIES, rows) == BRIO_OK, "%s", brio_message(f.ctx));
        for (size_t i = 0; i < 4 * QUERIES; i++)
            EXPECT(isnan(rows[i]) || rows[i] == ends[i % 4], "%s, method %d: %.17g", s->name, method, rows[i]);
    }
    fixture_free(&f);
}

static void means_of_values_at_the_ends_of_doubles_stay_between_them(void) {
    for_all_sets(check_values_at_the_ends_of_doubles);
}

/* Beside the hull natural neighbours have far centres. */
static void check_beside_the_hull(const set *s) {
    fixture f = fixture_new(s);
    const brio_delaunay2_stats *stats = brio_triangulation2_stats(f.t);
    const brio_triangle *t = brio_triangulation2_triangles(f.t) + stats->triangles;
    double values[2 * MOST], row[2], most = 0;
    size_t inside = 0;
    for (size_t i = 0; i < 2 * s->n; i++) most = fmax(most, fabs(values[i] = s->p[i]));
    for (size_t i = 0; i < stats->hull_edges; i++)
        for (double way = 1e-3; way > 1e-18; way /= 10) {
            const double *a = s->p + 2 * (size_t)t[i].vertex[0], *b = s->p + 2 * (size_t)t[i].vertex[1];
            double x[2] = {0.3 * a[0] + 0.7 * b[0] + way * (b[1] - a[1]),
                           0.3 * a[1] + 0.7 * b[1] + way * (a[0] - b[0])};
            EXPECT(interpolate(&f, s->weighted, values, 2, x, 1, row) == BRIO_OK, "%s", brio_message(f.ctx));
            inside += !isnan(row[0]);
            for (int k = 0; k < 2 && !isnan(row[0]); k++)
                EXPECT(fabs(row[k] - x[k]) <= 1e-13 * most, "%s, %g from the hull: %.17g, not %.17g", s->name, way,
                       row[k], x[k]);
        }
    EXPECT(inside > 0 || stats->dimension < 2, "%s: no position is in the hull", s->name);
    fixture_free(&f);
}

static void linear_functions_are_reproduced_beside_the_hull(void) {
    for_all_sets(check_beside_the_hull);
}

static void check_values_at_vertices(const set *s) {
    fixture f = fixture_new(s);
    double values[MOST], rows[MOST];
    const uint32_t *representative = brio_triangulation2_representatives(f.t);
    for (size_t i = 0; i < s->n; i++) values[i] = sin((double)i);
    if (brio_triangulation2_stats(f.t)->dimension < 2) { /* points_on_a_line_are_interpolated_along_it */
        fixture_free(&f);
        return;
    }
    for (int method = s->weighted; method < 2; method++) {
        EXPECT(interpolate(&f, method, values, 1, s->p, s->n, rows) == BRIO_OK);
        for (size_t i = 0; i < s->n && !s->weighted; i++)
            EXPECT(rows[i] == values[representative[i]], "%s: point %zu", s->name, i);
        for (size_t i = 0; i < s->n && s->weighted; i++)
            if (representative[i] == i) EXPECT(rows[i] == values[i], "%s: point %zu", s->name, i);
    }
    fixture_free(&f);
}

static void values_at_vertices_are_exact(void) {
    for_all_sets(check_values_at_vertices);
}

/* --- Sibson's coordinates by clipping --- */

typedef struct {
    double corner[3 * MOST][2];
    size_t count;
} polygon;

/* Keeps what is nearer to p than to q. */
static void clip(polygon *g, const double *p, const double *q) {
    polygon out = {.count = 0};
    for (size_t i = 0; i < g->count; i++) {
        const double *a = g->corner[i], *b = g->corner[(i + 1) % g->count];
        double side[2];
        for (int end = 0; end < 2; end++) {
            const double *c = end ? b : a;
            side[end] = (c[0] - 0.5 * (p[0] + q[0])) * (q[0] - p[0]) + (c[1] - 0.5 * (p[1] + q[1])) * (q[1] - p[1]);
        }
        if (side[0] <= 0) memcpy(out.corner[out.count++], a, 2 * sizeof *a);
        if ((side[0] < 0 && side[1] > 0) || (side[0] > 0 && side[1] < 0)) {
            double along = side[0] / (side[0] - side[1]);
            for (int k = 0; k < 2; k++) out.corner[out.count][k] = a[k] + along * (b[k] - a[k]);
            out.count++;
        }
    }
    *g = out;
}

static double area_of(const polygon *g) {
    double area = 0;
    for (size_t i = 1; i + 1 < g->count; i++) {
        const double *o = g->corner[0], *a = g->corner[i], *b = g->corner[i + 1];
        area += 0.5 * ((a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]));
    }
    return area;
}

static void sibson_by_clipping(const set *s, const double *x, double *share) {
    static polygon own, part;
    double sum = 0;
    own = (polygon){{{-100, -100}, {100, -100}, {100, 100}, {-100, 100}}, 4};
    for (size_t i = 0; i < s->n; i++) clip(&own, x, s->p + 2 * i);
    for (size_t i = 0; i < s->n; i++) {
        part = own;
        for (size_t k = 0; k < s->n && part.count; k++)
            if (k != i) clip(&part, s->p + 2 * i, s->p + 2 * k);
        sum += share[i] = area_of(&part);
    }
    for (size_t i = 0; i < s->n; i++) share[i] /= sum;
}

static void expect_sibson(set *s) {
    enum { ASKED = 40 };
    static double values[MOST * MOST], rows[ASKED * MOST], share[MOST];
    double x[2 * ASKED];
    brio_rng rng = brio_rng_new(3);
    fixture f = fixture_new(s);
    for (size_t i = 0; i < s->n * s->n; i++) values[i] = i % (s->n + 1) == 0;
    for (size_t i = 0; i < 2 * ASKED; i++) x[i] = 0.3 + 0.4 * brio_rng_double(&rng);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_NATURAL, values, s->n, x, ASKED, rows) == BRIO_OK);
    for (size_t i = 0; i < ASKED; i++) {
        sibson_by_clipping(s, x + 2 * i, share);
        for (size_t p = 0; p < s->n; p++)
            EXPECT(fabs(rows[s->n * i + p] - share[p]) < 1e-9, "%s: query %zu: point %zu has %.12g, not %.12g", s->name,
                   i, p, rows[s->n * i + p], share[p]);
    }
    fixture_free(&f);
}

/* Points of a line were answered NaN. Directions of decimals: up to rounding, but not exactly, the points are on a line. */
static void points_on_a_line_are_interpolated_along_it(void) {
    static const double way[][2] = {{1, 0},       {0, 1},         {2, 1},           {0.1, 0.3},
                                    {-0.7, 1e-9}, {3e300, 1e300}, {1e-300, -3e-300}};
    enum { POINTS = 12 };
    for (size_t w = 0; w < sizeof way / sizeof *way; w++)
        for (int method = 0; method < 2; method++) {
            set s = {.name = "line", .n = POINTS};
            double values[POINTS], x[2 * POINTS + 4], rows[POINTS + 2];
            for (size_t i = 0; i < POINTS; i++) {
                double place = (double)(i * 7 % POINTS);
                for (int k = 0; k < 2; k++) s.p[2 * i + k] = way[w][k] * place;
                values[i] = 3 * place + 1;
                double side = 0.25 + (double)(i % 3); /* places off the line are projected */
                x[2 * i] = (place > 0 ? place - 0.5 : 0) * way[w][0] - side * way[w][1];
                x[2 * i + 1] = (place > 0 ? place - 0.5 : 0) * way[w][1] + side * way[w][0];
            }
            for (int k = 0; k < 2; k++)
                x[2 * POINTS + k] = -0.01 * way[w][k], x[2 * POINTS + 2 + k] = 11.01 * way[w][k];
            fixture f = fixture_new(&s);
            EXPECT(interpolate(&f, method, values, 1, x, POINTS + 2, rows) == BRIO_OK, "%s", brio_message(f.ctx));
            for (size_t i = 0; i < POINTS; i++) {
                double place = (double)(i * 7 % POINTS), wanted = 3 * (place > 0 ? place - 0.5 : 0) + 1;
                EXPECT(fabs(rows[i] - wanted) < 1e-12 || (place == 0 && isnan(rows[i])), "way %zu, place %g: %g", w,
                       place, rows[i]);
            }
            EXPECT(isnan(rows[POINTS]) && isnan(rows[POINTS + 1]), "beyond the ends: %g %g", rows[POINTS],
                   rows[POINTS + 1]);
            EXPECT(interpolate(&f, method, values, 1, s.p, POINTS, rows) == BRIO_OK);
            for (size_t i = 0; i < POINTS; i++) EXPECT(rows[i] == values[i], "way %zu, point %zu: %g", w, i, rows[i]);
            fixture_free(&f);
        }
}

static void one_position_has_nothing_to_interpolate(void) {
    set s = {.name = "one position", .n = 3, .p = {1, 2, 1, 2, 1, 2}};
    double values[3] = {1, 2, 3}, row;
    fixture f = fixture_new(&s);
    EXPECT(interpolate(&f, 0, values, 1, s.p, 1, &row) == BRIO_ERR_NO_ANSWER);
    EXPECT(strstr(brio_message(f.ctx), "one position") != NULL, "%s", brio_message(f.ctx));
    fixture_free(&f);
}

static void natural_neighbours_have_the_areas_of_clipping(void) {
    static set s;
    place(&s, "uniform", 80, false), expect_sibson(&s);
    place_circle(&s, 60), scale_set(&s, "circle", 0.5);
    for (size_t i = 0; i < 2 * s.n; i++) s.p[i] += 0.5;
    expect_sibson(&s);
    place(&s, "grid", 81, false);
    for (size_t i = 0; i < s.n; i++) s.p[2 * i] = (double)(i % 9) / 8, s.p[2 * i + 1] = (double)(i / 9) / 8;
    expect_sibson(&s);
}

/* --- Voronoi diagrams --- */

static double power(const set *s, size_t p, const double *x) {
    double dx = x[0] - s->p[2 * p], dy = x[1] - s->p[2 * p + 1];
    return dx * dx + dy * dy - (s->weighted ? s->w[p] : 0);
}

/* A vertex has one power distance from the corners of its triangles, and no point has a lesser one. */
static void expect_centre(const set *s, const brio_triangle *t, const double *x, double size) {
    double r = power(s, t->vertex[0], x), far = fabs(x[0]) + fabs(x[1]) + size, bound = 1e-11 * far * far;
    for (int i = 1; i < 3; i++) EXPECT(fabs(power(s, t->vertex[i], x) - r) <= bound, "%s", s->name);
    for (size_t p = 0; p < s->n; p++) EXPECT(power(s, p, x) >= r - bound, "%s: point %zu", s->name, p);
}

/* Items go counterclockwise round a convex region, and each is a vertex of a triangle at the point. */
static void expect_region(const set *s, const brio_diagram2 *d, size_t p, bool hull, double size) {
    const uint32_t *item = d->items + d->offsets[p];
    size_t n = (size_t)(d->offsets[p + 1] - d->offsets[p]);
    EXPECT(n > 0 && (item[0] == BRIO_INFINITE) == hull, "%s: point %zu", s->name, p);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < i; k++) EXPECT(item[i] != item[k], "%s: point %zu", s->name, p);
    for (size_t i = hull; i < n; i++) {
        EXPECT(item[i] < d->num_vertices, "%s", s->name);
        if (n < 3 + (size_t)hull || i + 2 >= n + (hull ? 0 : 2)) continue;
        const double *a = d->vertices + 2 * (size_t)item[i], *b = d->vertices + 2 * (size_t)item[(i + 1) % n],
                     *c = d->vertices + 2 * (size_t)item[(i + 2) % n];
        double turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        double far = fabs(a[0]) + fabs(b[0]) + fabs(c[0]) + fabs(a[1]) + fabs(b[1]) + fabs(c[1]) + size;
        EXPECT(turn > -1e-11 * far * far, "%s: point %zu: %g", s->name, p, turn);
    }
}

static void check_diagram(const set *s) {
    fixture f = fixture_new(s);
    brio_diagram2 *d;
    const brio_triangle *t = brio_triangulation2_triangles(f.t);
    const brio_delaunay2_stats *stats = brio_triangulation2_stats(f.t);
    const uint32_t *representative = brio_triangulation2_representatives(f.t);
    bool hull[MOST] = {false};
    double size = 0;
    EXPECT(brio_voronoi2(f.ctx, f.t, s->p, f.w, s->n, &d) == BRIO_OK, "%s: %s", s->name, brio_message(f.ctx));
    EXPECT(d->num_triangles == stats->triangles && d->num_points == s->n && d->offsets[0] == 0);
    for (size_t i = 0; i < 2 * s->n; i++) size = fmax(size, fabs(s->p[i]));
    for (size_t i = 0; i < stats->hull_edges; i++)
        for (int k = 0; k < 2; k++) hull[t[stats->triangles + i].vertex[k]] = true;
    for (uint32_t i = 0; i < stats->triangles; i++) {
        uint32_t vertex = d->triangle_vertex[i];
        EXPECT(vertex < d->num_vertices, "%s", s->name);
        expect_centre(s, &t[i], d->vertices + 2 * (size_t)vertex, size);
        for (int k = 0; k < 3; k++) {
            uint32_t other = t[i].mate[k] >> 2;
            if (other >= stats->triangles) continue;
            uint32_t v[4] = {t[i].vertex[0], t[i].vertex[1], t[i].vertex[2], t[other].vertex[t[i].mate[k] & 3]};
            double w[4] = {s->w[v[0]], s->w[v[1]], s->w[v[2]], s->w[v[3]]};
            bool same = !brio_incircle(s->p + 2 * (size_t)v[0], s->p + 2 * (size_t)v[1], s->p + 2 * (size_t)v[2],
                                       s->p + 2 * (size_t)v[3], s->weighted ? w : NULL);
            EXPECT((d->triangle_vertex[other] == vertex) == same, "%s: triangles %u, %u", s->name, i, other);
        }
    }
    for (size_t p = 0; p < s->n; p++) {
        if (stats->dimension == 2 && representative[p] == p)
            expect_region(s, d, p, hull[p], size);
        else
            EXPECT(d->offsets[p] == d->offsets[p + 1], "%s", s->name);
    }
    brio_diagram2_free(d);
    fixture_free(&f);
}

static void diagrams_are_dual(void) {
    for_all_sets(check_diagram);
}

static void grid_has_square_regions(void) {
    static set s;
    brio_diagram2 *d;
    size_t squares = 0;
    place(&s, "squares", 36, false);
    for (size_t i = 0; i < s.n; i++) s.p[2 * i] = (double)(i % 6), s.p[2 * i + 1] = (double)(i / 6);
    fixture f = fixture_new(&s);
    EXPECT(brio_voronoi2(f.ctx, f.t, s.p, NULL, s.n, &d) == BRIO_OK);
    EXPECT(d->num_vertices == 25, "%zu", d->num_vertices);
    for (size_t i = 0; i < 2 * d->num_vertices; i++)
        EXPECT(d->vertices[i] - floor(d->vertices[i]) == 0.5, "%g", d->vertices[i]);
    for (size_t p = 0; p < s.n; p++)
        squares += d->offsets[p + 1] - d->offsets[p] == 4 && d->items[d->offsets[p]] != BRIO_INFINITE;
    EXPECT(squares == 16, "%zu", squares);
    brio_diagram2_free(d);
    fixture_free(&f);
}

/* --- errors --- */

static void wrong_calls_are_errors(void) {
    static set s;
    double x[4] = {0.5, 0.5, 0, NAN}, out[4], values[MOST] = {0}, flat[12] = {0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
    uint32_t found[2];
    brio_locator2 *l;
    brio_diagram2 *d;
    brio_triangulation2 *t;
    place(&s, "uniform", 20, true);
    fixture f = fixture_new(&s);
    EXPECT(brio_locator2_triangles(f.ctx, f.l, x, 2, found) == BRIO_ERR_NOT_FINITE);
    EXPECT(strstr(brio_message(f.ctx), "query 1: y is NaN") != NULL, "%s", brio_message(f.ctx));
    EXPECT(brio_locator2_interpolate(f.ctx, f.l, x, 1, NULL, out) == BRIO_ERR_ARGUMENT);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_NATURAL, values, 1, x, 1, out) == BRIO_ERR_ARGUMENT);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_END, values, 1, x, 1, out) == BRIO_ERR_ARGUMENT);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_LINEAR, values, 1, x, 1, out) == BRIO_OK);
    EXPECT(brio_locator2_new(f.ctx, f.t, s.p, NULL, s.n, &l) == BRIO_ERR_ARGUMENT && !l);
    EXPECT(brio_locator2_new(f.ctx, f.t, s.p, s.w, s.n - 1, &l) == BRIO_ERR_ARGUMENT && !l);
    EXPECT(brio_voronoi2(f.ctx, f.t, s.p, NULL, s.n, &d) == BRIO_ERR_ARGUMENT && !d);
    EXPECT(brio_delaunay2_flat(f.ctx, flat, NULL, 4, NULL, &t) == BRIO_OK);
    EXPECT(brio_locator2_new(f.ctx, t, flat, NULL, 4, &l) == BRIO_ERR_ARGUMENT && !l);
    EXPECT(brio_voronoi2(f.ctx, t, flat, NULL, 4, &d) == BRIO_ERR_ARGUMENT && !d);
    brio_triangulation2_free(t);
    s.p[3] = NAN;
    EXPECT(brio_locator2_new(f.ctx, f.t, s.p, s.w, s.n, &l) == BRIO_ERR_NOT_FINITE && !l);
    fixture_free(&f);
    brio_locator2_free(NULL);
    brio_diagram2_free(NULL);
}

static brio_status all_work(brio_context *ctx) {
    static set s;
    static double values[MOST], out[QUERIES], x[2 * QUERIES];
    static uint32_t found[QUERIES];
    brio_triangulation2 *t = NULL;
    brio_locator2 *l = NULL;
    brio_diagram2 *d = NULL;
    brio_interpolation o = {0};
    o.values = values;
    place(&s, "uniform", 200, false);
    make_queries(&s, x);
    brio_status status = brio_delaunay2(ctx, s.p, NULL, s.n, NULL, &t);
    if (status == BRIO_OK) status = brio_locator2_new(ctx, t, s.p, NULL, s.n, &l);
    if (status == BRIO_OK) status = brio_locator2_triangles(ctx, l, x, QUERIES, found);
    if (status == BRIO_OK) status = brio_locator2_least_power(ctx, l, x, QUERIES, found);
    if (status == BRIO_OK) status = brio_locator2_interpolate(ctx, l, x, QUERIES, &o, out);
    if (status == BRIO_OK) status = brio_voronoi2(ctx, t, s.p, NULL, s.n, &d);
    brio_diagram2_free(d);
    brio_locator2_free(l);
    brio_triangulation2_free(t);
    return status;
}

static brio_status line_work(brio_context *ctx) {
    static set s;
    brio_triangulation2 *t = NULL;
    brio_locator2 *l = NULL;
    place_line(&s, 30, false);
    brio_status status = brio_delaunay2(ctx, s.p, NULL, s.n, NULL, &t);
    if (status == BRIO_OK) status = brio_locator2_new(ctx, t, s.p, NULL, s.n, &l);
    brio_locator2_free(l);
    brio_triangulation2_free(t);
    return status;
}

static void memory_that_runs_out_is_a_status(void) {
    expect_clean_failures(all_work);
    expect_clean_failures(line_work);
}

SUITE(test_plane_queries) {
    RUN(triangles_are_those_of_brute_force);
    RUN(least_power_is_that_of_brute_force);
    RUN(answers_do_not_depend_on_the_threads);
    RUN(linear_functions_are_reproduced);
    RUN(means_of_values_at_the_ends_of_doubles_stay_between_them);
    RUN(linear_functions_are_reproduced_beside_the_hull);
    RUN(values_at_vertices_are_exact);
    RUN(points_on_a_line_are_interpolated_along_it);
    RUN(one_position_has_nothing_to_interpolate);
    RUN(natural_neighbours_have_the_areas_of_clipping);
    RUN(diagrams_are_dual);
    RUN(grid_has_square_regions);
    RUN(wrong_calls_are_errors);
    RUN(memory_that_runs_out_is_a_status);
    return harness_end();
}
