/* Alpha complexes against brute force: Gabriel by dyadic numbers over all points, values against long doubles, monotone
 * values, the sorted order; alpha shapes: closed, of the volume of their tetrahedra. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "predicates/predicates.h"

enum { N = 120 };

typedef struct {
    double p[3 * N], w[N];
    size_t n;
    bool weighted;
    brio_context *ctx;
    brio_triangulation *t;
    brio_alpha_complex c;
} set;

static bool build(set *s) {
    s->c = (brio_alpha_complex){.size = sizeof s->c};
    const double *w = s->weighted ? s->w : NULL;
    EXPECT(brio_delaunay(s->ctx, s->p, w, s->n, NULL, &s->t) == BRIO_OK);
    if (brio_triangulation_stats(s->t)->dimension < 3) return false;
    brio_status status = brio_alpha_values(s->ctx, s->t, s->p, w, s->n, &s->c);
    EXPECT(status == BRIO_OK, "%s", brio_message(s->ctx));
    return status == BRIO_OK;
}

static void drop(set *s) {
    brio_alpha_complex_free(&s->c);
    brio_triangulation_free(s->t);
    brio_context_free(s->ctx);
}

static void make(set *s, int kind, uint64_t seed) {
    s->ctx = new_context();
    s->n = N;
    s->weighted = kind >= 4;
    if (kind % 4 == 0) uniform_points(seed, N, s->p);
    if (kind % 4 == 1) integer_points(seed, N, 4, s->p);
    if (kind % 4 == 2) sphere_points(seed, N, s->p);
    if (kind % 4 == 3) integer_points(seed, N, 1000, s->p);
    integer_weights(seed, N, kind % 4 == 3 ? 20000 : 3, s->w);
    if (kind % 2 == 0)
        for (int i = 0; i < N; i++) s->w[i] *= 0.01;
}

/* Whether any vertex of the complex is strictly inside the smallest orthosphere, by dyadic numbers. */
static bool is_gabriel(const set *s, int k, const uint32_t *v) {
    double record[4][4];
    const double *p[4];
    if (k == 3) return true; /* the triangulation's own property */
    for (int i = 0; i < 4; i++) p[i] = record[i];
    for (int i = 0; i <= k; i++) {
        memcpy(record[i], s->p + 3 * (size_t)v[i], 3 * sizeof(double));
        record[i][3] = s->weighted ? s->w[v[i]] : 0;
    }
    for (size_t n = 0; n < s->c.counts[0]; n++) {
        uint32_t other = s->c.simplices[0][n];
        bool own = false;
        for (int i = 0; i <= k; i++) own |= other == v[i];
        if (own) continue;
        memcpy(record[k + 1], s->p + 3 * (size_t)other, 3 * sizeof(double));
        record[k + 1][3] = s->weighted ? s->w[other] : 0;
        if (k == 0 ? brio_power_compare(record[0], record[1], record[0]) < 0
                   : brio_attached_dyadic(p, k + 1, s->weighted))
            return false;
    }
    return true;
}

static bool contains(const uint32_t *v, int k, const uint32_t *face, int l) {
    for (int i = 0; i <= l; i++) {
        bool found = false;
        for (int j = 0; j <= k; j++) found |= v[j] == face[i];
        if (!found) return false;
    }
    return true;
}

/* Solves for the centre by Gauss elimination of the Gram system in long doubles. */
static long double squared_radius(const set *s, int k, const uint32_t *v) {
    long double u[3][3], gram[3][4], y[3] = {0, 0, 0}, square = 0;
    const double *a = s->p + 3 * (size_t)v[0];
    long double wa = s->weighted ? (long double)s->w[v[0]] : 0;
    for (int i = 0; i < k; i++)
        for (int c = 0; c < 3; c++) u[i][c] = (long double)s->p[3 * (size_t)v[i + 1] + (size_t)c] - (long double)a[c];
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < k; j++) gram[i][j] = u[i][0] * u[j][0] + u[i][1] * u[j][1] + u[i][2] * u[j][2];
        gram[i][k] = (gram[i][i] - ((s->weighted ? (long double)s->w[v[i + 1]] : 0) - wa)) / 2;
    }
    for (int i = 0; i < k; i++)
        for (int j = 0; j < k; j++) {
            if (i == j) continue;
            long double factor = gram[j][i] / gram[i][i];
            for (int c = i; c <= k; c++) gram[j][c] -= factor * gram[i][c];
        }
    for (int i = 0; i < k; i++)
        for (int c = 0; c < 3; c++) y[c] += gram[i][k] / gram[i][i] * u[i][c];
    for (int c = 0; c < 3; c++) square += y[c] * y[c];
    return square - wa;
}

static void check_simplex(const set *s, int k, size_t i) {
    const brio_alpha_complex *c = &s->c;
    const uint32_t *v = c->simplices[k] + i * (size_t)(k + 1);
    double value = c->values[k][i], least = INFINITY, solid = k == 3 ? value : INFINITY;
    for (int l = k + 1; l < 4; l++)
        for (size_t j = 0; j < c->counts[l]; j++)
            if (contains(c->simplices[l] + j * (size_t)(l + 1), l, v, k)) {
                least = fmin(least, c->values[l][j]);
                if (l == 3) solid = fmin(solid, c->values[3][j]);
            }
    EXPECT(value <= least, "dimension %d: %g above %g", k, value, least);
    EXPECT(c->solid[k][i] == solid, "dimension %d", k);
    bool gabriel = is_gabriel(s, k, v);
    EXPECT(c->gabriel[k][i] == gabriel, "dimension %d, simplex %zu", k, i);
    if (!gabriel) {
        EXPECT(value == least, "dimension %d: %g, %g", k, value, least);
        return;
    }
    long double wanted = squared_radius(s, k, v);
    EXPECT(fabsl(value - wanted) <= 1e-9L * (1 + fabsl(wanted)), "dimension %d: %.17g, %.17Lg", k, value, wanted);
}

static void values_against_brute_force(void) {
    static set s;
    for (int kind = 0; kind < 8; kind++)
        for (uint64_t seed = 1; seed <= (BRIEF_TESTS ? 1 : 2); seed++) {
            make(&s, kind, seed);
            if (build(&s))
                for (int k = 0; k < 4; k++)
                    for (size_t i = 0; i < s.c.counts[k]; i++) check_simplex(&s, k, i);
            EXPECT(s.c.counts[0] + s.c.counts[2] == s.c.counts[1] + s.c.counts[3] + 1, "Euler");
            drop(&s);
        }
}

static int compare(const brio_alpha_complex *c, const uint32_t number[2]) {
    const uint32_t *v[2];
    int k[2];
    double value[2];
    for (int n = 0; n < 2; n++) {
        size_t i = number[n];
        for (k[n] = 0; k[n] < 3 && i >= c->counts[k[n]]; k[n]++) i -= c->counts[k[n]];
        v[n] = c->simplices[k[n]] + i * (size_t)(k[n] + 1);
        value[n] = c->values[k[n]][i];
    }
    if (value[0] != value[1]) return value[0] < value[1] ? -1 : 1;
    if (k[0] != k[1]) return k[0] - k[1];
    for (int i = 0; i <= k[0]; i++)
        if (v[0][i] != v[1][i]) return v[0][i] < v[1][i] ? -1 : 1;
    return 0;
}

static void order_is_strict(void) {
    static set s;
    for (int kind = 0; kind < 8; kind++) {
        make(&s, kind, 3);
        EXPECT(build(&s));
        size_t total = s.c.counts[0] + s.c.counts[1] + s.c.counts[2] + s.c.counts[3];
        uint32_t *order = malloc(total * sizeof *order);
        EXPECT(brio_alpha_order(s.ctx, &s.c, order) == BRIO_OK);
        for (size_t i = 1; i < total; i++) EXPECT(compare(&s.c, order + i - 1) < 0, "kind %d, place %zu", kind, i);
        free(order);
        drop(&s);
    }
}

/* At each value of a tetrahedron: closed, manifold, and of the volume of the tetrahedra. */
static void shapes_bound_their_tetrahedra(void) {
    static set s;
    for (int kind = 0; kind < 8; kind++) {
        make(&s, kind, 4);
        EXPECT(build(&s));
        double least;
        EXPECT(brio_alpha_auto(s.ctx, &s.c, &least) == BRIO_OK);
        for (size_t n = 0; n < s.c.counts[3]; n += 7) {
            double alpha = n ? s.c.values[3][n] : least, volume = 0;
            brio_certificate c = {0};
            brio_alpha_shape_stats stats = {0};
            brio_mesh *m;
            EXPECT(brio_alpha_shape(s.ctx, s.p, &s.c, alpha, &m, &stats) == BRIO_OK);
            EXPECT(brio_mesh_certificate(s.ctx, m, &c) == BRIO_OK);
            for (size_t t = 0; t < s.c.counts[3]; t++) {
                if (s.c.values[3][t] > alpha) continue;
                const uint32_t *v = brio_triangulation_tetrahedra(s.t)[t].vertex;
                double e[3][3];
                for (int i = 0; i < 3; i++)
                    for (size_t k = 0; k < 3; k++) e[i][k] = s.p[3 * (size_t)v[i + 1] + k] - s.p[3 * (size_t)v[0] + k];
                volume += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                           e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
                          6;
            }
            EXPECT(c.closed && c.manifold && c.oriented, "kind %d, alpha %g", kind, alpha);
            EXPECT(fabs(c.volume - volume) <= 1e-9 * volume, "kind %d, alpha %g: %g, %g", kind, alpha, c.volume,
                   volume);
            if (!n) EXPECT(stats.uncovered == 0);
            brio_certificate_free(&c);
            brio_mesh_free(m);
        }
        drop(&s);
    }
}

/* One and four threads: the same bits. */
/* At each value of a tetrahedron the facets that the three properties choose are those of the shape: as many, seen from
 * the same side, so that they bound the same volume. */
static void facets_hold_all_shapes(void) {
    static set s;
    for (int kind = 0; kind < 8; kind++) {
        make(&s, kind, 5);
        EXPECT(build(&s));
        brio_mesh *all, *m;
        EXPECT(brio_alpha_facets(s.ctx, s.p, &s.c, &all) == BRIO_OK, "%s", brio_message(s.ctx));
        EXPECT(all->num_faces == s.c.counts[2] && all->num_vertices == s.n);
        const double *appears = brio_mesh_face_property(all, "appears")->data;
        const double *solid = brio_mesh_face_property(all, "solid")->data;
        const double *vanishes = brio_mesh_face_property(all, "vanishes")->data;
        for (size_t n = 0; n < s.c.counts[3]; n += 11) {
            double alpha = s.c.values[3][n], volume = 0;
            brio_certificate c = {0};
            brio_alpha_shape_stats stats = {0};
            size_t bounding = 0, singular = 0;
            EXPECT(brio_alpha_shape(s.ctx, s.p, &s.c, alpha, &m, &stats) == BRIO_OK);
            EXPECT(brio_mesh_certificate(s.ctx, m, &c) == BRIO_OK);
            for (size_t f = 0; f < all->num_faces; f++) {
                const double *a = s.p + 3 * (size_t)all->face_vertices[3 * f];
                const double *b = s.p + 3 * (size_t)all->face_vertices[3 * f + 1];
                const double *d = s.p + 3 * (size_t)all->face_vertices[3 * f + 2];
                singular += appears[f] <= alpha && alpha < solid[f];
                if (!(solid[f] <= alpha && alpha < vanishes[f])) continue;
                bounding++;
                volume += (a[0] * (b[1] * d[2] - b[2] * d[1]) - a[1] * (b[0] * d[2] - b[2] * d[0]) +
                           a[2] * (b[0] * d[1] - b[1] * d[0])) /
                          6;
            }
            EXPECT(bounding == m->num_faces && singular == stats.singular_facets, "kind %d, alpha %g: %zu, %zu", kind,
                   alpha, bounding, singular);
            EXPECT(fabs(c.volume - volume) <= 1e-9 * fabs(volume), "kind %d: %g, %g", kind, c.volume, volume);
            brio_certificate_free(&c);
            brio_mesh_free(m);
        }
        brio_mesh_free(all);
        drop(&s);
    }
}

static void threads_change_nothing(void) {
    enum { MANY = 4000 };
    double *p = malloc(3 * MANY * sizeof *p), *w = malloc(MANY * sizeof *w);
    brio_context *ctx = new_context();
    brio_triangulation *t[2];
    brio_alpha_complex c[2] = {{.size = sizeof *c}, {.size = sizeof *c}};
    uniform_points(9, MANY, p);
    integer_weights(9, MANY, 100, w);
    for (size_t i = 0; i < MANY; i++) w[i] *= 1e-5;
    for (int n = 0; n < 2; n++) {
        brio_context_set_threads(ctx, n ? 4 : 1);
        EXPECT(brio_delaunay(ctx, p, w, MANY, NULL, &t[n]) == BRIO_OK);
        EXPECT(brio_alpha_values(ctx, t[n], p, w, MANY, &c[n]) == BRIO_OK);
    }
    size_t total = 0;
    for (int k = 0; k < 4; k++) {
        EXPECT(c[0].counts[k] == c[1].counts[k]);
        total += c[0].counts[k];
        EXPECT(!memcmp(c[0].simplices[k], c[1].simplices[k], c[0].counts[k] * (size_t)(k + 1) * sizeof(uint32_t)));
    }
    EXPECT(!memcmp(c[0].values[0], c[1].values[0], total * sizeof(double)));
    EXPECT(!memcmp(c[0].gabriel[0], c[1].gabriel[0], total));
    for (int n = 0; n < 2; n++) {
        brio_alpha_complex_free(&c[n]);
        brio_triangulation_free(t[n]);
    }
    brio_context_free(ctx);
    free(p), free(w);
}

static void hostile_inputs(void) {
    static set s;
    brio_mesh *m;
    make(&s, 0, 1);
    EXPECT(build(&s));
    EXPECT(brio_alpha_shape(s.ctx, s.p, &s.c, NAN, &m, NULL) == BRIO_ERR_ARGUMENT && !m);
    EXPECT(brio_alpha_shape(s.ctx, s.p, &s.c, -1, &m, NULL) == BRIO_ERR_NO_ANSWER && !m);
    brio_alpha_complex other = {0};
    EXPECT(brio_alpha_values(s.ctx, s.t, s.p, NULL, N - 1, &other) == BRIO_ERR_ARGUMENT && !other.values[0]);
    drop(&s);
    make(&s, 0, 1);
    for (int i = 0; i < N; i++) s.p[3 * i] = 0;
    EXPECT(!build(&s));
    EXPECT(brio_alpha_values(s.ctx, s.t, s.p, NULL, N, &other) == BRIO_ERR_NO_ANSWER);
    drop(&s);
}

static brio_status run_alpha(brio_context *ctx) {
    static double p[3 * 60];
    brio_triangulation *t = NULL;
    brio_alpha_complex c = {0};
    brio_mesh *m = NULL;
    uint32_t order[4000];
    double alpha;
    uniform_points(1, 60, p);
    brio_status status = brio_delaunay(ctx, p, NULL, 60, NULL, &t);
    if (status == BRIO_OK) status = brio_alpha_values(ctx, t, p, NULL, 60, &c);
    if (status == BRIO_OK) status = brio_alpha_order(ctx, &c, order);
    if (status == BRIO_OK) status = brio_alpha_auto(ctx, &c, &alpha);
    if (status == BRIO_OK) status = brio_alpha_shape(ctx, p, &c, alpha, &m, NULL);
    brio_mesh_free(m);
    m = NULL;
    if (status == BRIO_OK) status = brio_alpha_facets(ctx, p, &c, &m);
    brio_mesh_free(m);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    return status;
}

static void memory_that_runs_out(void) {
    expect_clean_failures(run_alpha);
}

/* A squared radius less a weight far below 0 was infinity less infinity. */
static void values_beyond_doubles_are_infinite(void) {
    static const double points[12] = {1.3e154, 0, 0, -1.3e154, 0, 0, 0, 1.3e154, 0, 0, 0, 1.3e154};
    static const double weights[4] = {-2e307, -2e307, -2e307, -2e307};
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    brio_alpha_complex c = {0};
    EXPECT(brio_delaunay(ctx, points, weights, 4, NULL, &t) == BRIO_OK);
    EXPECT(brio_alpha_values(ctx, t, points, weights, 4, &c) == BRIO_OK, "%s", brio_message(ctx));
    for (int k = 0; k < 4; k++)
        for (size_t i = 0; i < c.counts[k]; i++) EXPECT(!isnan(c.values[k][i]), "dimension %d", k);
    EXPECT(c.counts[3] == 1 && c.values[3][0] == INFINITY);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* The counts of the shape of the least alpha, for points times 2^exponent and weights times its square. */
static brio_status shape_at(int exponent, bool weighted, double alpha, brio_alpha_shape_stats *stats) {
    static set s;
    brio_mesh *m = NULL;
    make(&s, weighted ? 6 : 2, 5);
    for (size_t i = 0; i < 3 * N; i++) s.p[i] = ldexp(s.p[i], exponent);
    for (size_t i = 0; i < N; i++) s.w[i] = ldexp(s.w[i], 2 * exponent);
    EXPECT(build(&s));
    *stats = (brio_alpha_shape_stats){.size = sizeof *stats};
    brio_status status = isnan(alpha) ? brio_alpha_auto(s.ctx, &s.c, &alpha) : BRIO_OK;
    if (status == BRIO_OK) status = brio_alpha_shape(s.ctx, s.p, &s.c, alpha, &m, stats);
    if (status != BRIO_OK) EXPECT(strstr(brio_message(s.ctx), "beyond doubles: scale the points"));
    brio_mesh_free(m);
    drop(&s);
    return status;
}

/* Values that became infinite or 0 were equal: the least alpha of one solid had another shape than at other scales. */
static void shapes_are_the_same_at_every_scale_or_refused(void) {
    static const int exponents[] = {-1000, -560, -530, -515, -505, -300, 300, 505, 509, 515, 560, 900};
    for (int weighted = 0; weighted < 2; weighted++) {
        brio_alpha_shape_stats usual, scaled;
        EXPECT(shape_at(0, weighted, NAN, &usual) == BRIO_OK);
        for (int k = 0; k < 12; k++) {
            if (weighted && exponents[k] > 509) continue; /* the weights are infinite */
            brio_status status = shape_at(exponents[k], weighted, NAN, &scaled);
            bool fits = abs(exponents[k]) < 510;
            EXPECT(status == (fits ? BRIO_OK : BRIO_ERR_NO_ANSWER), "2^%d", exponents[k]);
            if (!fits) continue;
            EXPECT(scaled.alpha == ldexp(usual.alpha, 2 * exponents[k]), "2^%d: %g", exponents[k], scaled.alpha);
            EXPECT(scaled.tetrahedra == usual.tetrahedra && scaled.vertices == usual.vertices, "2^%d", exponents[k]);
        }
    }
}

/* Tetrahedra whose squared radii became 0 were in the shape of alpha 0. Weights make values of 0 and less right. */
static void alpha_where_values_are_lost_is_refused(void) {
    brio_alpha_shape_stats stats;
    EXPECT(shape_at(-560, false, 0, &stats) == BRIO_ERR_NO_ANSWER);
    EXPECT(shape_at(-530, false, 0x1p-1050, &stats) == BRIO_ERR_NO_ANSWER);
    EXPECT(shape_at(-530, false, 1, &stats) == BRIO_OK && stats.uncovered == 0);
    static set s;
    brio_mesh *m = NULL;
    make(&s, 4, 5);
    for (size_t i = 0; i < N; i++) s.w[i] = 9 + 0.001 * (double)i;
    EXPECT(build(&s));
    EXPECT(brio_alpha_shape(s.ctx, s.p, &s.c, 0, &m, NULL) == BRIO_OK, "%s", brio_message(s.ctx));
    brio_mesh_free(m);
    drop(&s);
}

SUITE(test_alpha) {
    RUN(values_against_brute_force);
    RUN(order_is_strict);
    RUN(shapes_bound_their_tetrahedra);
    RUN(facets_hold_all_shapes);
    RUN(threads_change_nothing);
    RUN(shapes_are_the_same_at_every_scale_or_refused);
    RUN(alpha_where_values_are_lost_is_refused);
    RUN(hostile_inputs);
    RUN(values_beyond_doubles_are_infinite);
    RUN(memory_that_runs_out);
    return harness_end();
}
