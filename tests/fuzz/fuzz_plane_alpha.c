/* Alpha complexes of points in the plane, or in a plane in space, against integers: which simplices are Gabriel, their values
 * as fractions, those of simplices that contain them; the order, and the least alpha of one region. */
#include "plane_input.h"

enum { MOST = 14 };

/* Sites in space: the plane's, lifted to a plane of integers. */
typedef struct {
    size_t n;
    int64_t x[MOST][3], w[MOST];
} space_set;

typedef struct {
    const space_set *s;
    const brio_alpha_complex *c;
    const brio_triangulation2 *t;
} task;

static int64_t product(const space_set *s, uint32_t from, uint32_t a, uint32_t b) {
    int64_t sum = 0;
    for (int k = 0; k < 3; k++) sum += (s->x[a][k] - s->x[from][k]) * (s->x[b][k] - s->x[from][k]);
    return sum;
}

/* A value of n / d is that to a few units in the last place. */
static bool is_value(double value, int64_t n, int64_t d) {
    long double right = (long double)n / (long double)d;
    return fabsl((long double)value - right) <= 0x1p-48L * fabsl(right) + 0x1p-80L;
}

/* The squared radius of a triangle's orthocircle: of a + alpha u + beta v, as Gram's matrix gives it. */
static bool is_triangle_value(const space_set *s, const uint32_t *v, double value) {
    int64_t uu = product(s, v[0], v[1], v[1]), vv = product(s, v[0], v[2], v[2]), uv = product(s, v[0], v[1], v[2]);
    int64_t a = s->w[v[0]], p = uu - s->w[v[1]] + a, q = vv - s->w[v[2]] + a, d = 4 * (uu * vv - uv * uv);
    return is_value(value, p * p * vv - 2 * p * q * uv + q * q * uu - a * d, d);
}

static bool is_edge_value(const space_set *s, const uint32_t *v, double value) {
    int64_t uu = product(s, v[0], v[1], v[1]), a = s->w[v[0]], p = uu - s->w[v[1]] + a;
    return is_value(value, p * p - 4 * uu * a, 4 * uu);
}

/* Whether q is strictly inside the smallest orthocircle of an edge, or of a vertex. */
static bool is_inside(const space_set *s, const uint32_t *v, int k, uint32_t q) {
    int64_t far = product(s, v[0], q, q) - s->w[q] + s->w[v[0]];
    if (k == 0) return far < 0;
    int64_t uu = product(s, v[0], v[1], v[1]), p = uu - s->w[v[1]] + s->w[v[0]];
    return uu * far < p * product(s, v[0], v[1], q);
}

static bool contains(const uint32_t *v, int corners, const uint32_t *face, int faces) {
    for (int i = 0; i < faces; i++) {
        bool found = false;
        for (int j = 0; j < corners; j++) found |= v[j] == face[i];
        if (!found) return false;
    }
    return true;
}

/* The least value of the simplices of dimension `of` that contain a simplex of dimension k. */
static double least_value(const task *a, int k, const uint32_t *v, int of) {
    double least = INFINITY;
    for (size_t i = 0; i < a->c->counts[of]; i++)
        if (contains(a->c->simplices[of] + ((size_t)of + 1) * i, of + 1, v, k + 1))
            least = fmin(least, a->c->values[of][i]);
    return least;
}

static void expect_simplex(const task *a, int k, size_t i) {
    const uint32_t *v = a->c->simplices[k] + ((size_t)k + 1) * i;
    double value = a->c->values[k][i], above = least_value(a, k, v, k + 1);
    bool gabriel = true;
    for (size_t n = 0; n < a->c->counts[0]; n++) {
        uint32_t q = a->c->simplices[0][n];
        gabriel &= q == v[0] || q == v[k] || !is_inside(a->s, v, k, q);
    }
    FUZZ_EXPECT(a->c->gabriel[k][i] == gabriel && value <= above, "dimension %d, %zu: %g over %g", k, i, value, above);
    FUZZ_EXPECT(a->c->solid[k][i] == least_value(a, k, v, 2), "dimension %d, %zu", k, i);
    if (!gabriel)
        FUZZ_EXPECT(value == above, "dimension %d, %zu: %g, not %g", k, i, value, above);
    else
        FUZZ_EXPECT(k ? is_edge_value(a->s, v, value) : value == fmin(above, (double)-a->s->w[v[0]]),
                    "dimension %d, %zu", k, i);
}

static int compare_simplices(const brio_alpha_complex *c, uint32_t a, uint32_t b) {
    double x = c->values[0][a], y = c->values[0][b];
    if (x != y) return x < y ? -1 : 1;
    size_t first[4] = {0, c->counts[0], c->counts[0] + c->counts[1], SIZE_MAX};
    int k = 0, l = 0;
    while (a >= first[k + 1]) k++;
    while (b >= first[l + 1]) l++;
    if (k != l) return k < l ? -1 : 1;
    const uint32_t *v = c->simplices[k] + ((size_t)k + 1) * (a - first[k]);
    const uint32_t *w = c->simplices[k] + ((size_t)k + 1) * (b - first[k]);
    for (int i = 0; i <= k; i++)
        if (v[i] != w[i]) return v[i] < w[i] ? -1 : 1;
    return 0;
}

static void expect_order(brio_context *ctx, const brio_alpha_complex *c) {
    uint32_t order[8 * MOST];
    size_t count = c->counts[0] + c->counts[1] + c->counts[2];
    FUZZ_EXPECT(brio_alpha_order(ctx, c, order) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < count; i++) {
        FUZZ_EXPECT(order[i] < count, "place %zu", i);
        FUZZ_EXPECT(!i || compare_simplices(c, order[i - 1], order[i]) < 0, "place %zu", i);
    }
}

/* Whether the triangles of at most alpha are one region with all vertices, by flooding across edges. */
static bool is_one_region(const task *a, double alpha) {
    bool in[2 * MOST] = {false}, met[MOST] = {false};
    const brio_triangle *t = brio_triangulation2_triangles(a->t);
    size_t n = a->c->counts[2], begun = 0, vertices = 0;
    for (size_t k = 0; k < n && !begun; k++) begun = in[k] = a->c->values[2][k] <= alpha;
    for (size_t round = 0; round < n; round++)
        for (size_t k = 0; k < n; k++)
            for (int i = 0; i < 3 && a->c->values[2][k] <= alpha; i++) {
                size_t other = t[k].mate[i] >> 2;
                in[k] |= other < n && in[other];
            }
    for (size_t k = 0; k < n; k++) {
        if (in[k] != (a->c->values[2][k] <= alpha)) return false;
        for (int i = 0; i < 3 && in[k]; i++) met[t[k].vertex[i]] = true;
    }
    for (size_t v = 0; v < a->s->n; v++) vertices += met[v];
    return begun && vertices == a->c->counts[0];
}

static void expect_complex(brio_context *ctx, const task *a) {
    const brio_delaunay2_stats *stats = brio_triangulation2_stats(a->t);
    const brio_alpha_complex *c = a->c;
    double alpha = 0;
    FUZZ_EXPECT(c->counts[0] == stats->vertices && c->counts[2] == stats->triangles && !c->counts[3]);
    FUZZ_EXPECT(c->counts[0] + c->counts[2] == c->counts[1] + 1, "no disk");
    for (size_t i = 0; i < c->counts[2]; i++)
        FUZZ_EXPECT(is_triangle_value(a->s, c->simplices[2] + 3 * i, c->values[2][i]), "triangle %zu: %.17g", i,
                    c->values[2][i]);
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < c->counts[k]; i++) expect_simplex(a, k, i);
    expect_order(ctx, c);
    FUZZ_EXPECT(brio_alpha_auto(ctx, c, &alpha) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(is_one_region(a, alpha), "%g is too little", alpha);
    for (size_t i = 0; i < c->counts[2]; i++)
        FUZZ_EXPECT(c->values[2][i] >= alpha || !is_one_region(a, c->values[2][i]), "%g is too much", alpha);
}

/* The plane's sites, or the same on a plane in space.   points  room for MOST rows of three. */
static void make_points(fuzz_input *in, bool flat, space_set *s, double *points, double *weights) {
    plane_set plane;
    uint8_t mode = fuzz_byte(in), slope = flat ? fuzz_byte(in) : 0;
    int64_t a = slope % 5 - 2, b = slope / 5 % 5 - 2;
    size_t d = flat ? 3 : 2;
    fuzz_plane_sites(in, mode, MOST, &plane);
    s->n = plane.n;
    for (size_t i = 0; i < s->n; i++) {
        const plane_site *p = &plane.p[i];
        s->x[i][0] = p->x, s->x[i][1] = p->y, s->x[i][2] = flat ? a * p->x + b * p->y + 3 : 0, s->w[i] = p->w;
        for (size_t k = 0; k < d; k++) points[d * i + k] = (double)s->x[i][k];
        weights[i] = (double)p->w;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    space_set s;
    double points[3 * MOST], weights[MOST];
    brio_triangulation2 *t;
    brio_alpha_complex c = {0};
    bool flat = fuzz_flag(&in);
    make_points(&in, flat, &s, points, weights);
    FUZZ_EXPECT((flat ? brio_delaunay2_flat : brio_delaunay2)(ctx, points, weights, s.n, NULL, &t) == BRIO_OK, "%s",
                brio_message(ctx));
    brio_status status = brio_alpha_values2(ctx, t, points, weights, s.n, &c);
    bool solid = brio_triangulation2_stats(t)->dimension == 2;
    FUZZ_EXPECT(status == (solid ? BRIO_OK : BRIO_ERR_NO_ANSWER), "%s", brio_message(ctx));
    const task a = {&s, &c, t};
    if (solid) expect_complex(ctx, &a);
    brio_alpha_complex_free(&c);
    brio_triangulation2_free(t);
    fuzz_end();
    return 0;
}
