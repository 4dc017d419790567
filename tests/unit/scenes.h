/* Scenes: points with many ties, several of their Delaunay (regular) triangulations, and triangulations of nearly the same
 * points, for tests that spoil sets of tetrahedra. */
#ifndef BRIO_TESTS_SCENES_H
#define BRIO_TESTS_SCENES_H

#include "harness.h"
#include "mutate_tetrahedra.h"
#include "triangulation/triangulation.h"

/* --- points --- */

static inline void add_site(site_set *s, int64_t x, int64_t y, int64_t z) {
    if (s->n < BRUTE_POINTS) s->p[s->n++] = (site){{x, y, z}, 0};
}

static inline void add_grid(site_set *s, int64_t nx, int64_t ny, int64_t nz, int64_t step) {
    for (int64_t i = 0; i < nx * ny * nz; i++)
        add_site(s, step * (i % nx), step * (i / nx % ny), step * (i / (nx * ny)));
}

static inline void add_octahedron(site_set *s, int64_t r) {
    for (int i = 0; i < 6; i++) {
        int64_t x[3] = {0};
        x[i / 2] = i % 2 ? r : -r;
        add_site(s, x[0], x[1], x[2]);
    }
}

/* Twelve points on a sphere, combinatorially an icosahedron. */
static inline void add_icosahedron(site_set *s) {
    for (int i = 0; i < 12; i++) {
        int64_t x[3] = {0};
        x[(i + 1) % 3] = i & 4 ? 1 : -1;
        x[(i + 2) % 3] = (i / 3) & 1 ? 2 : -2;
        add_site(s, x[0], x[1], x[2]);
    }
}

/* A prism of `layers` layers over a polygon inscribed in a circle of twelve integer points. */
static inline void add_prism(scene *e, size_t corners, int64_t layers) {
    static const int64_t circle[12][2] = {{5, 0},  {4, 3},   {3, 4},   {0, 5},  {-3, 4}, {-4, 3},
                                          {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}};
    size_t from = draw(e, 12), step = 12 / corners;
    for (size_t i = 0; i < corners; i++)
        for (int64_t z = 0; z < layers; z++)
            add_site(&e->s, circle[(from + step * i) % 12][0], circle[(from + step * i) % 12][1], 3 * z);
}

/* The poles and the equator of a sphere. */
static inline void add_globe(scene *e) {
    add_site(&e->s, 0, 0, 5);
    add_site(&e->s, 0, 0, -5);
    add_prism(e, 12, 1);
    e->ring = 12;
}

static inline void add_random(scene *e, size_t n, uint32_t side) {
    for (size_t i = 0; i < n; i++)
        add_site(&e->s, (int64_t)draw(e, side), (int64_t)draw(e, side), (int64_t)draw(e, side));
}

static inline void add_body_centred(site_set *s) {
    add_grid(s, 3, 2, 2, 2);
    for (int i = 0; i < 2; i++) add_site(s, 1 + 2 * i, 1, 1);
}

static inline void add_lattice(scene *e) {
    switch (draw(e, 13)) {
    case 0:
        add_grid(&e->s, 2, 2, 2, 1);
        break;
    case 1:
        add_grid(&e->s, 3, 2, 2, 1);
        break;
    case 2:
        draw(e, 4) ? add_grid(&e->s, 3, 3, 2, 1) : add_grid(&e->s, 3, 3, 3, 1);
        break;
    case 3:
        add_octahedron(&e->s, 1), add_site(&e->s, 0, 0, 2);
        break;
    case 4:
        add_octahedron(&e->s, 2), add_grid(&e->s, 2, 2, 2, 1);
        break;
    case 5:
        add_body_centred(&e->s);
        break;
    case 6:
        add_icosahedron(&e->s);
        break;
    case 7:
        add_prism(e, 3 + draw(e, 2), 2);
        break;
    case 8:
        add_prism(e, 6, 2 + (int64_t)draw(e, 2));
        break;
    case 9:
        add_octahedron(&e->s, 1), add_octahedron(&e->s, 2);
        break;
    case 10:
        add_globe(e);
        break;
    default:
        add_random(e, 5 + draw(e, 8), 3 + (uint32_t)draw(e, 4));
    }
}

static inline void add_duplicates(scene *e) {
    for (size_t i = draw(e, 4); i > 0 && e->s.n < BRUTE_POINTS; i--) {
        site copy = e->s.p[draw_point(e)];
        e->s.p[e->s.n++] = copy;
    }
}

/* Weights from a few values, so that they tie; hidden points come about. */
static inline void set_weights(scene *e) {
    e->s.weighted = draw(e, 2);
    if (!e->s.weighted) return;
    uint32_t most = 1 + (uint32_t)draw(e, 6);
    for (size_t i = 0; i < e->s.n; i++) e->s.p[i].w = draw(e, 3) ? 0 : (int64_t)draw(e, most);
}

/* All on one plane, one line, or one position, where dimension says so. */
static inline void flatten(scene *e, int dimension) {
    int64_t a = (int64_t)draw(e, 3) - 1, b = (int64_t)draw(e, 3) - 1;
    size_t axis = draw(e, 3);
    for (size_t i = 0; i < e->s.n; i++) {
        int64_t *x = e->s.p[i].x;
        int64_t u = x[0], v = x[1];
        if (dimension < 2) v = 0;
        if (dimension < 1) u = 2;
        x[axis] = u, x[(axis + 1) % 3] = dimension < 2 ? a * u : v, x[(axis + 2) % 3] = a * u + b * v + 1;
    }
}

/* --- triangulations --- */

/* Coordinates and weights as the library takes them; axes permuted and reflected, which breaks ties in another way. */
static inline void as_doubles(const site_set *s, size_t turn, double *points, double *weights) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (size_t i = 0; i < s->n; i++) {
        for (size_t k = 0; k < 3; k++) {
            double x = (double)s->p[i].x[order[turn / 8 % 6][k]];
            points[3 * i + k] = turn >> k & 1 ? -x : x;
        }
        weights[i] = (double)s->p[i].w;
    }
}

static inline void triangulate(brio_context *ctx, const site_set *s, size_t turn, tet_set *out) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    brio_triangulation *t = NULL;
    as_doubles(s, turn, points, weights);
    EXPECT(brio_delaunay(ctx, points, s->weighted ? weights : NULL, s->n, NULL, &t) == BRIO_OK);
    out->count = t->stats.tetrahedra;
    EXPECT(out->count <= BRUTE_TETS);
    for (size_t i = 0; i < out->count; i++) memcpy(out->v[i], t->tet[i].vertex, sizeof *out->v);
    brio_triangulation_free(t);
}

/* The triangulation without one point, or with another weight of one point. */
static inline void triangulate_nearly(brio_context *ctx, scene *e, tet_set *out) {
    site_set s = e->s;
    uint32_t p = draw_point(e), q = draw_point(e);
    if (s.weighted && draw(e, 2)) {
        s.p[p].w += draw(e, 2) ? 3 : -3;
    } else { /* of coincident points the one with the lower index becomes the vertex */
        if (p < q) p ^= q, q ^= p, p ^= q;
        s.p[p] = s.p[q];
    }
    triangulate(ctx, &s, draw(e, 48), out);
}

/* Tetrahedra with an empty sphere: from a random point set of no ties, hardly more than the triangulation's. */
static inline void find_candidates(scene *e) {
    uint32_t v[4];
    e->num_candidates = 0;
    for (v[0] = 0; v[0] < e->s.n; v[0]++)
        for (v[1] = v[0] + 1; v[1] < e->s.n; v[1]++)
            for (v[2] = v[1] + 1; v[2] < e->s.n; v[2]++)
                for (v[3] = v[2] + 1; v[3] < e->s.n; v[3]++)
                    if (e->num_candidates < CANDIDATES && volume_at(&e->s, v) && sphere_is_empty(&e->s, v))
                        memcpy(e->candidate[e->num_candidates++], v, sizeof v);
}

static inline void make_scene(brio_context *ctx, scene *e, uint64_t seed, int dimension) {
    memset(e, 0, sizeof *e);
    e->rng = brio_rng_new(seed);
    do {
        e->s.n = 0, e->ring = 0;
        add_lattice(e);
        add_duplicates(e);
        if (dimension < 3) flatten(e, dimension);
        set_weights(e);
        e->s.hull_volume = hull_volume(&e->s);
    } while (dimension == 3 && !e->s.hull_volume);
    if (dimension < 3) return;
    for (size_t i = 0; i < ALTERNATIVES; i++) triangulate(ctx, &e->s, i ? draw(e, 48) : 0, &e->right[i]);
    for (size_t i = 0; i < NEAR_MISSES; i++) triangulate_nearly(ctx, e, &e->near_miss[i]);
    find_candidates(e);
}

#endif
