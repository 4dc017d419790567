/* Voronoi and power cells: against a brute force that cuts by every bisector, sums of volumes, lattices, flat inputs,
 * vertices, threads, scales, memory that runs out. */
#include "brio/testdata.h"
#include "cells/polyhedron.h"
#include "cells/shares.h"
#include "failing_allocator.h"
#include "instruction_sets.h"
#include "points.h"
#include <float.h>

static const double UNIT_BOX[6] = {0, 0, 0, 1, 1, 1}, WIDE_BOX[6] = {-2, -2, -2, 3, 3, 3};

static brio_cells *cells_of(brio_context *ctx, const double *points, const double *weights, size_t n, const double *box,
                            int vertices) {
    brio_cells_options o = {0};
    brio_cells *cells;
    o.box = box;
    o.vertices = vertices;
    brio_status status = brio_voronoi_cells(ctx, NULL, points, weights, n, &o, &cells);
    EXPECT(status == BRIO_OK, "%s", brio_message(ctx));
    return cells;
}

static size_t faces_of(const brio_cells *cells, size_t c) {
    return (size_t)(cells->face_offsets[c + 1] - cells->face_offsets[c]);
}

static int near_to(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance * fmax(1, fmax(fabs(a), fabs(b)));
}

/* --- brute force --- */

/* Cuts the box by the bisectors of p and all other points. */
static void brute_cell(brio_polyhedron *shape, const double *points, const double *weights, size_t n, size_t p,
                       const double *box) {
    double low[3], high[3];
    for (size_t k = 0; k < 3; k++) low[k] = box[k] - points[3 * p + k], high[k] = box[3 + k] - points[3 * p + k];
    brio_polyhedron_set_box(shape, low, high);
    for (size_t q = 0; q < n; q++) {
        double plane[4], square = 0;
        if (q == p) continue;
        for (size_t k = 0; k < 3; k++) plane[k] = points[3 * q + k] - points[3 * p + k], square += plane[k] * plane[k];
        plane[3] = (square + (weights ? weights[p] - weights[q] : 0)) / 2;
        brio_polyhedron_cut(shape, plane, (int64_t)q);
    }
}

static void expect_brute(brio_context *ctx, const double *points, const double *weights, size_t n, const double *box) {
    brio_cells *cells = cells_of(ctx, points, weights, n, box, 0);
    brio_polyhedron shape = {.ctx = ctx};
    size_t c = 0;
    for (size_t p = 0; p < n; p++) {
        double moment[3] = {0, 0, 0}, volume = 0, area = 0, vector[3];
        brute_cell(&shape, points, weights, n, p, box);
        volume = brio_polyhedron_volume(&shape, moment);
        for (size_t f = 0; f < shape.faces.count; f++) {
            brio_polyhedron_area(&shape, &shape.faces.list[f], vector);
            area += sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
        }
        if (c == cells->num_cells || cells->site[c] != p) {
            EXPECT(volume < 1e-9, "point %zu has no cell, but the volume %g", p, volume);
            continue;
        }
        EXPECT(near_to(cells->volume[c], volume, 1e-9), "point %zu: %.17g %.17g", p, cells->volume[c], volume);
        EXPECT(near_to(cells->area[c], area, 1e-7), "point %zu: %.17g %.17g", p, cells->area[c], area);
        for (size_t k = 0; k < 3 && volume > 1e-3; k++)
            EXPECT(near_to(cells->centroid[3 * c + k], points[3 * p + k] + moment[k] / volume, 1e-7), "point %zu", p);
        c++;
    }
    EXPECT(c == cells->num_cells);
    EXPECT(near_to(cells->volume_sum, cells->region_volume, 1e-12), "%.17g", cells->volume_sum);
    brio_polyhedron_free(&shape);
    brio_cells_free(cells);
}

static void cells_equal_those_of_brute_force(void) {
    enum { N = 40 };
    brio_context *ctx = new_context();
    double points[3 * N], weights[N];
    for (uint64_t seed = 1; seed <= 30; seed++) {
        size_t n = 1 + seed % N;
        brio_rng rng = brio_rng_new(seed);
        uniform_points(seed, n, points);
        for (size_t i = 0; i < n; i++) weights[i] = 0.2 * brio_rng_double(&rng);
        expect_brute(ctx, points, NULL, n, UNIT_BOX);
        expect_brute(ctx, points, NULL, n, WIDE_BOX);
        expect_brute(ctx, points, weights, n, UNIT_BOX);
        integer_points(seed, n, 1 + (uint32_t)seed % 3, points);
        const double box[6] = {-0.7, -0.5, -1, 2.5, 3, 2.25};
        for (size_t i = 0; i < n; i++) /* distinct positions, or the brute force has no bisector */
            for (size_t j = 0; j < i; j++)
                if (!memcmp(points + 3 * i, points + 3 * j, 3 * sizeof *points))
                    n--, memcpy(points + 3 * i, points + 3 * n, 3 * sizeof *points), j = i, i--;
        expect_brute(ctx, points, NULL, n, box);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- lattices --- */

static void cells_of_a_lattice_have_six_faces(void) {
    enum { SIDE = SHORT_TESTS ? 20 : 50, N = SIDE * SIDE * SIDE };
    brio_context *ctx = new_context();
    double *points = malloc(3 * N * sizeof *points), box[6] = {-0.5, -0.5, -0.5, SIDE - 0.5, SIDE - 0.5, SIDE - 0.5};
    for (size_t i = 0; i < N; i++) {
        points[3 * i] = (double)(i % SIDE), points[3 * i + 1] = (double)(i / SIDE % SIDE);
        points[3 * i + 2] = (double)(i / SIDE / SIDE);
    }
    for (int clip = 0; clip < 2; clip++) {
        brio_cells *cells = cells_of(ctx, points, NULL, N, clip ? box : NULL, 0);
        size_t inside = 0;
        for (size_t c = 0; c < cells->num_cells; c++) {
            size_t faces = faces_of(cells, c);
            EXPECT(cells->bounded[c] && clip ? faces == 6 : faces >= 3 && faces <= 6, "cell %zu: %zu", c, faces);
            if (cells->bounded[c]) EXPECT(faces == 6 && near_to(cells->volume[c], 1, 1e-12));
            inside += cells->bounded[c];
        }
        EXPECT(inside == (clip ? N : (SIDE - 2) * (SIDE - 2) * (SIDE - 2)), "%zu", inside);
        if (clip) EXPECT(near_to(cells->volume_sum, N, 1e-13));
        brio_cells_free(cells);
    }
    free(points);
    brio_context_free(ctx);
}

/* --- sums --- */

static void volumes_add_up_to_the_box(void) {
    brio_context *ctx = new_context();
    for (int kind = 0; kind < BRIO_KIND_END; kind++)
        for (int weighted = 0; weighted < 2; weighted++) {
            brio_mesh *m;
            EXPECT(brio_generate(ctx, (brio_kind)kind,
                                 kind == BRIO_KIND_MOMENT ? 200
                                 : SHORT_TESTS            ? 800
                                                          : 3000,
                                 NULL, &m) == BRIO_OK);
            double box[6], *weights = malloc(m->num_vertices * sizeof *weights);
            for (int k = 0; k < 3; k++) {
                double low = INFINITY, high = -INFINITY;
                for (size_t i = 0; i < m->num_vertices; i++) {
                    low = fmin(low, m->vertices[3 * i + (size_t)k]);
                    high = fmax(high, m->vertices[3 * i + (size_t)k]);
                }
                box[k] = low - 0.01 * (high - low), box[3 + k] = high + 0.02 * (high - low);
            }
            for (size_t i = 0; i < m->num_vertices; i++) weights[i] = (double)(i * 7919 % 1000) * 1e-7;
            brio_cells *cells = cells_of(ctx, m->vertices, weighted ? weights : NULL, m->num_vertices, box, 0);
            EXPECT(fabs(cells->volume_sum / cells->region_volume - 1) < 1e-12, "kind %d: %.3g", kind,
                   cells->volume_sum / cells->region_volume - 1);
            brio_cells_free(cells);
            brio_mesh_free(m);
            free(weights);
        }
    brio_context_free(ctx);
}

static void a_polytope_clips(void) {
    enum { N = 500 };
    brio_context *ctx = new_context();
    double points[3 * N], box[6] = {0.125, 0.25, 0, 1, 1, 1};
    const double corner[] = {-1, 0, 0, 0, 0, -2, 0, 0, 0, 0, -1, 0, 3, 3, 3, 2.7}; /* x, y, z >= 0, x + y + z <= 0.9 */
    uniform_points(5, N, points);
    brio_cells_options o = {0};
    brio_cells *cells;
    o.planes = corner, o.num_planes = 4;
    EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &cells) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(near_to(cells->region_volume, 0.9 * 0.9 * 0.9 / 6, 1e-13) && near_to(cells->volume_sum, 0.1215, 1e-13));
    brio_cells_free(cells);
    o.box = box;
    EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &cells) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(near_to(cells->region_volume, 0.525 * 0.525 * 0.525 / 6, 1e-13));
    EXPECT(near_to(cells->volume_sum, cells->region_volume, 1e-13));
    brio_cells_free(cells);
    brio_context_free(ctx);
}

/* --- faces and vertices --- */

/* Each face of a cell and a neighbour is a face of the neighbour, with the opposite normal and the same area. */
static void expect_symmetric(const brio_cells *cells) {
    for (size_t c = 0; c < cells->num_cells; c++)
        for (uint64_t f = cells->face_offsets[c]; f < cells->face_offsets[c + 1]; f++) {
            size_t d = 0, found = 0;
            if (cells->face_neighbours[f] < 0) continue;
            while (d < cells->num_cells && cells->site[d] != cells->face_neighbours[f]) d++;
            for (uint64_t g = cells->face_offsets[d]; g < cells->face_offsets[d + 1]; g++) {
                if (cells->face_neighbours[g] != cells->site[c]) continue;
                found++;
                EXPECT(cells->face_areas[f] == cells->face_areas[g] ||
                       near_to(cells->face_areas[f], cells->face_areas[g], 1e-12));
                for (int k = 0; k < 3; k++) EXPECT(cells->face_normals[3 * f + k] == -cells->face_normals[3 * g + k]);
            }
            EXPECT(found == 1, "cell %zu, face %zu: %zu", c, (size_t)f, found);
        }
}

static void area_of_corners(const brio_cells *cells, uint64_t f, double area[3]) {
    uint64_t first = cells->corner_offsets[f];
    const double *a = cells->vertices + 3 * (size_t)cells->face_vertices[first];
    area[0] = area[1] = area[2] = 0;
    for (uint64_t i = first + 1; i + 1 < cells->corner_offsets[f + 1]; i++) {
        const double *b = cells->vertices + 3 * (size_t)cells->face_vertices[i];
        const double *c = cells->vertices + 3 * (size_t)cells->face_vertices[i + 1];
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            area[k] += ((b[m] - a[m]) * (c[n] - a[n]) - (b[n] - a[n]) * (c[m] - a[m])) / 2;
        }
    }
}

static void expect_corners(const brio_cells *cells) {
    for (size_t i = 0; i < 3 * cells->num_vertices; i++) EXPECT(isfinite(cells->vertices[i]), "vertex %zu", i / 3);
    for (size_t c = 0; c < cells->num_cells; c++)
        for (uint64_t f = cells->face_offsets[c]; f < cells->face_offsets[c + 1]; f++) {
            double area[3];
            if (!isfinite(cells->face_areas[f])) continue;
            EXPECT(cells->corner_offsets[f + 1] - cells->corner_offsets[f] >= 3);
            area_of_corners(cells, f, area);
            for (int k = 0; k < 3; k++)
                EXPECT(near_to(area[k], cells->face_areas[f] * cells->face_normals[3 * f + k], 1e-10), "cell %zu", c);
        }
}

static void faces_are_symmetric_and_have_their_corners(void) {
    enum { N = 300 };
    brio_context *ctx = new_context();
    double points[3 * N], weights[N];
    const double box[6] = {0.1, 0.05, 0.1, 0.95, 1.2, 0.9};
    for (int kind = 0; kind < 4; kind++) {
        if (kind % 2)
            integer_points(3, N, 5, points);
        else
            uniform_points(4, N, points);
        integer_weights(3, N, 2, weights);
        for (int clip = 0; clip < (kind % 2 ? 1 : 2); clip++) {
            brio_cells *cells = cells_of(ctx, points, kind > 1 ? weights : NULL, N, clip ? box : NULL, 1);
            expect_symmetric(cells);
            expect_corners(cells);
            brio_cells_free(cells);
        }
    }
    brio_context_free(ctx);
}

static void cells_of_the_hull_are_unbounded(void) {
    enum { N = 400 };
    brio_context *ctx = new_context();
    double points[3 * N];
    uint8_t hull[N] = {0};
    brio_triangulation *t;
    integer_points(8, N, 7, points);
    EXPECT(brio_delaunay(ctx, points, NULL, N, NULL, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t) + s->tetrahedra;
    for (size_t i = 0; i < s->hull_facets; i++)
        for (int k = 0; k < 3; k++) hull[tet[i].vertex[k]] = 1;
    brio_cells *cells;
    EXPECT(brio_voronoi_cells(ctx, t, points, NULL, N, NULL, &cells) == BRIO_OK);
    EXPECT(cells->num_cells == s->vertices && s->duplicates > 0);
    for (size_t c = 0; c < cells->num_cells; c++) {
        EXPECT(cells->bounded[c] == !hull[cells->site[c]] && isfinite(cells->volume[c]) == !hull[cells->site[c]]);
        EXPECT(isnan(cells->centroid[3 * c]) == hull[cells->site[c]]);
    }
    brio_cells_free(cells);
    EXPECT(brio_voronoi_cells(ctx, t, points, NULL, N - 1, NULL, &cells) == BRIO_ERR_ARGUMENT && !cells);
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- points of dimension 2 or less --- */

static void flat_points_have_cells(void) {
    brio_context *ctx = new_context();
    const double box[6] = {-0.5, -0.5, -1, 3.5, 3.5, 1};
    double points[48], none[3] = {0};
    for (size_t i = 0; i < 16; i++)
        points[3 * i] = (double)(i % 4), points[3 * i + 1] = (double)(i / 4), points[3 * i + 2] = 0;
    for (size_t n = 16; n > 0; n = n == 16 ? 4 : n == 4 ? 1 : 0) { /* a plane, a line, a point */
        brio_cells *cells = cells_of(ctx, points, NULL, n, box, 1);
        EXPECT(cells->num_cells == n && near_to(cells->volume_sum, 32, 1e-13));
        for (size_t c = 0; c < n; c++)
            EXPECT(near_to(cells->volume[c], 32 / (double)n, 1e-13) && faces_of(cells, c) == 6);
        brio_cells_free(cells);
        cells = cells_of(ctx, points, NULL, n, NULL, 1);
        size_t faces = (size_t)cells->face_offsets[cells->num_cells];
        EXPECT(faces == (n == 16 ? 48 : n == 4 ? 6 : 0), "%zu", faces);
        for (size_t c = 0; c < n; c++) EXPECT(!cells->bounded[c] && cells->volume[c] == INFINITY);
        brio_cells_free(cells);
    }
    brio_cells *cells = cells_of(ctx, none, NULL, 0, box, 1);
    EXPECT(cells->num_cells == 0 && cells->volume_sum == 0);
    brio_cells_free(cells);
    brio_context_free(ctx);
}

/* --- shares of tetrahedra --- */

#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 quad; /* 113 bits */
#elif LDBL_MANT_DIG >= 113
typedef long double quad;
#endif
#if defined(__SIZEOF_FLOAT128__) || LDBL_MANT_DIG >= 113
/* Computes what each vertex has of a tetrahedron, by the determinants of its orthoschemes. */
static void shares_in_quads(const double (*p)[3], const double *w, quad *share) {
    for (int a = 0; a < 4; a++) {
        share[a] = 0;
        for (int turn = 0; turn < 6; turn++) {
            static const int ORDER[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
            quad r[3][3], lift[3], base[3][3] = {{0}}, x[3][3] = {{0}};
            int rest[3], n = 0;
            for (int i = 0; i < 4; i++)
                if (i != a) rest[n++] = i;
            for (int i = 0; i < 3; i++) {
                int v = rest[ORDER[turn][i]];
                lift[i] = w ? (quad)w[a] - w[v] : 0;
                for (int k = 0; k < 3; k++) r[i][k] = (quad)p[v][k] - p[a][k], lift[i] += r[i][k] * r[i][k];
            }
            /* the power centres of 2, 3 and 4 of them: along orthogonal directions */
            for (int i = 0; i < 3; i++) {
                quad way = 0, at = lift[i] / 2, square = 0;
                for (int k = 0; k < 3; k++) base[i][k] = r[i][k];
                for (int twice = 0; twice < 2; twice++)
                    for (int j = 0; j < i; j++) {
                        quad along = 0, length = 0;
                        for (int k = 0; k < 3; k++) along += base[i][k] * base[j][k], length += base[j][k] * base[j][k];
                        for (int k = 0; k < 3; k++) base[i][k] -= along / length * base[j][k];
                    }
                for (int k = 0; k < 3; k++) square += base[i][k] * base[i][k];
                for (int k = 0; k < 3 && i; k++) way += x[i - 1][k] * r[i][k];
                for (int k = 0; k < 3; k++) x[i][k] = (i ? x[i - 1][k] : 0) + (at - way) / square * base[i][k];
            }
            quad det = 0;
            for (int k = 0; k < 3; k++) {
                int m = (k + 1) % 3, o = (k + 2) % 3;
                det += x[0][k] * (x[1][m] * x[2][o] - x[1][o] * x[2][m]);
            }
            share[a] += ((turn < 3) == (a % 2 == 0) ? det : -det) / 6;
        }
    }
}

/* Four points of one of many shapes, positive. Returns false where they are flat. */
static int hostile_tetrahedron(brio_rng *rng, double (*p)[3], double *w) {
    int shape = (int)(brio_rng_next(rng) % 5);
    double thin = ldexp(1, -(int)(brio_rng_next(rng) % 34));
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) p[i][k] = brio_rng_double(rng);
    for (int k = 0; k < 3; k++) {
        if (shape == 1) p[1][k] = p[0][k] + thin * (p[1][k] - 0.5);                     /* a short edge */
        if (shape == 2) p[3][k] = (p[0][k] + p[1][k] + p[2][k]) / 3 + thin * p[3][k];   /* a cap */
        if (shape == 3) p[3][k] = p[1][k] + p[2][k] - p[0][k] + thin * (p[3][k] - 0.5); /* a sliver */
        if (shape == 4) p[2][k] = (p[0][k] + p[1][k]) / 2 + thin * (p[2][k] - 0.5);     /* a needle */
    }
    for (int i = 0; i < 4; i++) w[i] = thin * brio_rng_double(rng);
    int side = brio_orient3d(p[0], p[1], p[2], p[3]);
    for (int k = 0; k < 3 && side < 0; k++) {
        double x = p[0][k];
        p[0][k] = p[1][k], p[1][k] = x;
    }
    return side != 0;
}

/* The errors of shares are within their bounds, which are small for tetrahedra of ordinary shape; the shares of a
 * tetrahedron add up to it; every instruction set computes the same bits. */
static void shares_are_within_their_bounds(void) {
    brio_rng rng = brio_rng_new(77);
    size_t few = 0, fine = 0;
    for (int trial = 0; trial < 1000; trial++) {
        double p[4][3], w[4], centre[1][3], error[1], share[1][4], bound[1], first[4];
        static const uint32_t vertex[1][4] = {{0, 1, 2, 3}};
        quad exact[4];
        const double *weights = trial % 2 ? w : NULL;
        if (!hostile_tetrahedron(&rng, p, w)) continue;
        shares_in_quads((const double(*)[3])p, weights, exact);
        for (int set = BRIO_PLAIN; set < BRIO_INSTRUCTION_SETS; set++) {
            if (!brio_use_instructions((brio_instruction_set)set)) continue;
            brio_shares(&(brio_share_batch){p[0], weights, vertex, 1, centre, error, share, bound});
            if (set == BRIO_PLAIN) memcpy(first, share, sizeof first);
            if (bound[0] < INFINITY)
                EXPECT(!memcmp(first, share, sizeof first), "%d: other bits in set %d", trial, set);
        }
        use_largest_set();
        double worst = 0;
        for (int i = 0; i < 4; i++) worst = fmax(worst, fabs(share[0][i] - (double)exact[i]));
        if (!(bound[0] < INFINITY)) continue;
        few++;
        fine += bound[0] < 1e-10;
        EXPECT(worst <= bound[0], "%d: %g is more than %g", trial, worst, bound[0]);
    }
    EXPECT(few > 600 && fine > 150, "%zu bounds, %zu below 1e-10", few, fine);
}
/* Bounds of small tetrahedra, edges of 2^-98, were 0: their products are below what doubles hold. */
static void bounds_of_small_tetrahedra_were_0(void) {
    brio_rng rng = brio_rng_new(78);
    size_t few = 0;
    for (int trial = 0; trial < 600; trial++) {
        double p[4][3], w[4], centre[1][3], error[1], share[1][4], bound[1];
        static const uint32_t vertex[1][4] = {{0, 1, 2, 3}};
        quad exact[4];
        if (!hostile_tetrahedron(&rng, p, w)) continue;
        for (int i = 0; i < 12; i++) p[i / 3][i % 3] = ldexp(p[i / 3][i % 3], trial % 2 ? -98 : -70);
        shares_in_quads((const double(*)[3])p, NULL, exact);
        brio_shares(&(brio_share_batch){p[0], NULL, vertex, 1, centre, error, share, bound});
        if (!(bound[0] < INFINITY)) continue;
        few++;
        for (int i = 0; i < 4; i++) {
            double off = fabs(share[0][i] - (double)exact[i]);
            EXPECT(bound[0] > 0 && off <= bound[0], "%d: %g is more than %g", trial, off, bound[0]);
        }
    }
    EXPECT(few > 200, "%zu bounds", few);
}
#else
static void shares_are_within_their_bounds(void) {
    printf("skipped: the compiler has no numbers of 113 bits\n");
}
static void bounds_of_small_tetrahedra_were_0(void) {
    printf("skipped: the compiler has no numbers of 113 bits\n");
}
#endif

/* --- volumes and neighbours --- */

/* Volumes and neighbours alone, against cells with everything. */
static void expect_neighbours(brio_context *ctx, const double *points, const double *weights, size_t n,
                              const double *box, const char *what) {
    brio_cells_options o = {.size = sizeof o, .no_areas = 1, .no_centroids = 1, .no_face_sizes = 1, .box = box};
    brio_cells *whole = cells_of(ctx, points, weights, n, box, 0), *alone;
    EXPECT(brio_voronoi_cells(ctx, NULL, points, weights, n, &o, &alone) == BRIO_OK, "%s", brio_message(ctx));
    size_t c = whole->num_cells, faces = (size_t)whole->face_offsets[c];
    EXPECT(alone->num_cells == c && !alone->face_areas && !alone->face_normals && !alone->area, "%s", what);
    EXPECT(!memcmp(whole->site, alone->site, c * sizeof *whole->site), "%s", what);
    EXPECT(!memcmp(whole->bounded, alone->bounded, c), "%s", what);
    EXPECT(!memcmp(whole->face_offsets, alone->face_offsets, (c + 1) * sizeof *whole->face_offsets), "%s", what);
    EXPECT(!memcmp(whole->face_neighbours, alone->face_neighbours, faces * sizeof *whole->face_neighbours), "%s", what);
    for (size_t i = 0; i < c; i++)
        EXPECT(alone->volume[i] == whole->volume[i] ||
                   near_to(alone->volume[i] * (double)n, whole->volume[i] * (double)n, 1e-11),
               "%s, cell %zu of %zu: %.17g %.17g", what, i, c, alone->volume[i], whole->volume[i]);
    brio_cells_free(whole);
    brio_cells_free(alone);
}

static void neighbours_alone_are_those_of_whole_cells(void) {
    enum { N = 900 };
    const double box[6] = {-0.5, -0.5, -0.5, 7.5, 7.5, 7.5};
    brio_context *ctx = new_context();
    double *points = malloc(3 * N * sizeof *points), *weights = malloc(N * sizeof *weights);
    for (int threads = 1; threads < 4; threads += 2) {
        brio_context_set_threads(ctx, threads);
        uniform_points(31, N, points);
        uniform_points(32, N / 3, weights);
        for (size_t i = 0; i < N; i++) weights[i] *= 0.01;
        expect_neighbours(ctx, points, NULL, N, UNIT_BOX, "uniform");
        expect_neighbours(ctx, points, NULL, N, NULL, "uniform, no box");
        expect_neighbours(ctx, points, weights, N, UNIT_BOX, "weighted");
        sphere_points(33, N / 2, points); /* slivers and ties between uniform ones */
        expect_neighbours(ctx, points, NULL, N, WIDE_BOX, "sphere");
        integer_points(34, N, 8, points);
        expect_neighbours(ctx, points, NULL, N, box, "integers");
        for (size_t i = 0; i < N / 2; i++) points[3 * i] += 1e-3 * weights[i];
        expect_neighbours(ctx, points, NULL, N, box, "integers, half of them moved");
        for (size_t i = 0; i < N; i++) points[3 * i] = floor(points[3 * i]) + 1e-14 * (double)(i % 7);
        expect_neighbours(ctx, points, NULL, N, box, "nearly integers");
        for (size_t i = 0; i < N; i++) points[3 * i + 2] = 1;
        expect_neighbours(ctx, points, NULL, N, box, "flat");
    }
    EXPECT(brio_context_memory(ctx) == 0);
    free(points);
    free(weights);
    brio_context_free(ctx);
}

/* --- volumes alone --- */

/* Only volumes, in another pass than the cells with faces. */
static void expect_volumes(brio_context *ctx, const double *points, const double *weights, size_t n,
                           const double *box) {
    brio_cells_options o = {0};
    brio_cells *whole = cells_of(ctx, points, weights, n, box, 0), *alone;
    o.no_areas = o.no_centroids = o.no_faces = 1;
    o.box = box;
    EXPECT(brio_voronoi_cells(ctx, NULL, points, weights, n, &o, &alone) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(alone->num_cells == whole->num_cells && !alone->area && !alone->centroid && !alone->face_offsets);
    EXPECT(!memcmp(alone->bounded, whole->bounded, n < whole->num_cells ? n : whole->num_cells));
    for (size_t c = 0; c < whole->num_cells; c++) {
        EXPECT(alone->site[c] == whole->site[c]);
        EXPECT(alone->volume[c] == whole->volume[c] ||
                   near_to(alone->volume[c] * (double)n, whole->volume[c] * (double)n, 1e-11),
               "cell %zu of %zu: %.17g %.17g", c, whole->num_cells, alone->volume[c], whole->volume[c]);
    }
    if (box)
        EXPECT(fabs(alone->volume_sum / alone->region_volume - 1) < 1e-12, "%.3g of %.3g", alone->volume_sum,
               alone->region_volume);
    brio_cells_free(whole);
    brio_cells_free(alone);
}

static void volumes_alone_equal_those_with_faces(void) {
    enum { N = BRIEF_TESTS ? 1500 : 3000 };
    brio_context *ctx = new_context();
    double *points = malloc(3 * N * sizeof *points), *weights = malloc(N * sizeof *weights);
    const double box[6] = {-0.5, -0.5, -0.5, 7.5, 7.5, 7.5}, inner[6] = {0.25, 0.25, 0.25, 0.75, 0.75, 0.75};
    for (int threads = 1; threads < 4; threads += 2) {
        brio_context_set_threads(ctx, threads);
        uniform_points(21, N, points);
        uniform_points(22, N / 3, weights);
        for (size_t i = 0; i < N; i++) weights[i] *= 0.01;
        expect_volumes(ctx, points, NULL, N, UNIT_BOX);
        expect_volumes(ctx, points, NULL, N, inner);
        expect_volumes(ctx, points, NULL, N, NULL);
        expect_volumes(ctx, points, weights, N, UNIT_BOX);
        expect_volumes(ctx, points, weights, N, NULL);
        integer_points(23, N, 8, points);
        expect_volumes(ctx, points, NULL, N, box);
        integer_weights(23, N, 2, weights);
        expect_volumes(ctx, points, weights, N, box);
        for (size_t i = 0; i < N; i++) points[3 * i + 2] = 1;
        expect_volumes(ctx, points, NULL, N, box);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    free(points);
    free(weights);
    brio_context_free(ctx);
}

/* What brio/cells.h says of the memory of a sweep holds. */
static void sweeps_take_the_memory_that_is_told(void) {
    enum { POINTS = 20000 };
    static const double TOLD[2] = {390, 940};
    static double many[3 * POINTS];
    brio_rng rng = brio_rng_new(12);
    for (size_t i = 0; i < 3 * POINTS; i++) many[i] = brio_rng_double(&rng);
    for (int faces = 0; faces < 2; faces++) {
        brio_cells_options o = {.size = sizeof o, .no_areas = 1, .no_centroids = 1, .no_face_sizes = 1};
        brio_context *ctx = new_context();
        brio_triangulation *t = NULL;
        brio_cells *cells = NULL;
        o.no_faces = !faces;
        EXPECT(brio_delaunay(ctx, many, NULL, POINTS, NULL, &t) == BRIO_OK);
        size_t held = brio_context_memory(ctx);
        EXPECT(brio_voronoi_cells(ctx, t, many, NULL, POINTS, &o, &cells) == BRIO_OK);
        double taken = (double)(brio_context_memory_peak(ctx) - held) / POINTS;
        EXPECT(fabs(taken / TOLD[faces] - 1) <= 0.15, "%d: %g bytes a point", faces, taken);
        brio_cells_free(cells);
        brio_triangulation_free(t);
        brio_context_free(ctx);
    }
}

static void volumes_alone_have_the_same_bits_with_threads(void) {
    enum { N = BRIEF_TESTS ? 10000 : 30000 };
    brio_context *ctx = new_context();
    double *points = malloc(3 * N * sizeof *points);
    brio_cells_options o = {0};
    brio_cells *one, *more;
    clustered_points(9, N, points);
    o.no_areas = o.no_centroids = o.no_faces = 1;
    o.box = WIDE_BOX;
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &one) == BRIO_OK);
    for (int threads = 2; threads < 6; threads++) {
        brio_context_set_threads(ctx, threads);
        EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &more) == BRIO_OK);
        EXPECT(more->num_cells == one->num_cells && more->volume_sum == one->volume_sum);
        EXPECT(!memcmp(one->volume, more->volume, one->num_cells * sizeof *one->volume), "%d threads", threads);
        brio_cells_free(more);
    }
    brio_cells_free(one);
    free(points);
    brio_context_free(ctx);
}

/* The same points and box far from 0: the numbers are those near 0, where the coordinates are on a grid. */
static void an_offset_moves_the_cells(void) {
    enum { N = 2000 };
    static const double OFFSET[3] = {1e6, -0x1p23, 0};
    brio_context *ctx = new_context();
    double points[3 * N], moved[3 * N], box[6];
    uniform_points(31, N, points);
    for (size_t i = 0; i < 3 * N; i++) {
        points[i] = rint(points[i] * 0x1p25) * 0x1p-25;
        moved[i] = points[i] + OFFSET[i % 3];
    }
    for (size_t i = 0; i < 6; i++) box[i] = UNIT_BOX[i] + OFFSET[i % 3];
    brio_cells *here = cells_of(ctx, points, NULL, N, UNIT_BOX, 1), *there = cells_of(ctx, moved, NULL, N, box, 1);
    EXPECT(here->num_cells == N && there->num_cells == N && fabs(there->region_volume - 1) < 1e-15);
    EXPECT(fabs(there->volume_sum - 1) < 1e-14, "%.3g", there->volume_sum - 1);
    for (size_t c = 0; c < N; c++) {
        EXPECT(near_to(here->volume[c] * N, there->volume[c] * N, 1e-12) && faces_of(here, c) == faces_of(there, c));
        for (size_t k = 0; k < 3; k++)
            EXPECT(fabs(here->centroid[3 * c + k] + OFFSET[k] - there->centroid[3 * c + k]) <= 0x1p-28, "cell %zu", c);
    }
    EXPECT(here->num_vertices == there->num_vertices);
    expect_volumes(ctx, moved, NULL, N, box);
    brio_cells_free(here);
    brio_cells_free(there);
    brio_context_free(ctx);
}

/* --- determinism, scale, errors --- */

static void threads_give_the_same_bits(void) {
    enum { N = 20000 };
    brio_context *ctx = new_context();
    double *points = malloc(3 * N * sizeof *points);
    clustered_points(7, N, points);
    brio_context_set_threads(ctx, 1);
    brio_cells *one = cells_of(ctx, points, NULL, N, UNIT_BOX, 1);
    brio_context_set_threads(ctx, 4);
    brio_cells *four = cells_of(ctx, points, NULL, N, UNIT_BOX, 1);
    size_t n = one->num_cells, faces = (size_t)one->face_offsets[n], corners = (size_t)one->corner_offsets[faces];
    EXPECT(four->num_cells == n && four->num_vertices == one->num_vertices);
    EXPECT(!memcmp(one->volume, four->volume, n * sizeof *one->volume));
    EXPECT(!memcmp(one->centroid, four->centroid, 3 * n * sizeof *one->centroid));
    EXPECT(!memcmp(one->face_offsets, four->face_offsets, (n + 1) * sizeof *one->face_offsets));
    EXPECT(!memcmp(one->face_neighbours, four->face_neighbours, faces * sizeof *one->face_neighbours));
    EXPECT(!memcmp(one->face_vertices, four->face_vertices, corners * sizeof *one->face_vertices));
    EXPECT(!memcmp(one->vertices, four->vertices, 3 * one->num_vertices * sizeof *one->vertices));
    brio_cells_free(one);
    brio_cells_free(four);
    free(points);
    brio_context_free(ctx);
}

/* Returns the cell of `cells` whose site is at x. */
static size_t cell_at(const brio_cells *cells, const double *points, const double *x) {
    for (size_t c = 0; c < cells->num_cells; c++)
        if (!memcmp(points + 3 * (size_t)cells->site[c], x, 3 * sizeof *x)) return c;
    return SIZE_MAX;
}

static bool are_the_same_cell(const brio_cells *a, size_t i, const double *x, const brio_cells *b, size_t j,
                              const double *y) {
    uint64_t f = a->face_offsets[i], g = b->face_offsets[j], n = a->face_offsets[i + 1] - f;
    if (memcmp(&a->volume[i], &b->volume[j], sizeof(double)) || memcmp(&a->area[i], &b->area[j], sizeof(double)) ||
        memcmp(&a->centroid[3 * i], &b->centroid[3 * j], 3 * sizeof(double)) || a->bounded[i] != b->bounded[j] ||
        b->face_offsets[j + 1] - g != n)
        return false;
    if (memcmp(&a->face_areas[f], &b->face_areas[g], n * sizeof(double)) ||
        memcmp(&a->face_normals[3 * f], &b->face_normals[3 * g], 3 * n * sizeof(double)))
        return false;
    for (uint64_t k = 0; k < n; k++) {
        int64_t p = a->face_neighbours[f + k], q = b->face_neighbours[g + k];
        if (p < 0 || q < 0 ? p != q : memcmp(x + 3 * p, y + 3 * q, 3 * sizeof *x) != 0) return false;
    }
    return true;
}

/* Sums within a cell are in an order that its star tells: whatever the order of the points, where many are on one
 * sphere, too. */
static void cells_do_not_depend_on_the_order_of_the_points(void) {
    enum { N = 700 };
    static double points[3 * N], turned[3 * N], weights[N], turned_weights[N];
    static const double BOX[6] = {-0.5, 1, 0.25, 6.5, 7, 6.75};
    for (int kind = 0; kind < 6; kind++) {
        brio_context *ctx = new_context();
        brio_rng rng = brio_rng_new(70 + (uint64_t)kind);
        bool weighted = kind % 2;
        if (kind / 2 == 0) uniform_points(3, N, points);
        if (kind / 2 == 1) integer_points(3, N, 9, points);
        if (kind / 2 == 2) sphere_points(3, N, points);
        integer_weights(5, N, kind / 2 == 1 ? 5 : 1, weights);
        memcpy(turned, points, sizeof points), memcpy(turned_weights, weights, sizeof weights);
        for (size_t i = N - 1; i > 0; i--) {
            size_t j = brio_rng_below(&rng, (uint32_t)i + 1);
            for (int k = 0; k < 3; k++) {
                double x = turned[3 * i + (size_t)k];
                turned[3 * i + (size_t)k] = turned[3 * j + (size_t)k], turned[3 * j + (size_t)k] = x;
            }
            double w = turned_weights[i];
            turned_weights[i] = turned_weights[j], turned_weights[j] = w;
        }
        const double *box = kind / 2 == 1 ? BOX : NULL;
        brio_cells *a = cells_of(ctx, points, weighted ? weights : NULL, N, box, 0);
        brio_cells *b = cells_of(ctx, turned, weighted ? turned_weights : NULL, N, box, 0);
        EXPECT(a->num_cells == b->num_cells);
        size_t differ = 0;
        for (size_t c = 0; c < a->num_cells; c++) {
            size_t other = cell_at(b, turned, points + 3 * (size_t)a->site[c]);
            differ += other == SIZE_MAX || !are_the_same_cell(a, c, points, b, other, turned);
        }
        EXPECT(differ == 0, "kind %d: %zu of %zu cells differ", kind, differ, a->num_cells);
        brio_cells_free(a);
        brio_cells_free(b);
        brio_context_free(ctx);
    }
}

static void powers_of_two_scale_the_cells(void) {
    enum { N = 200 };
    static const int EXPONENT[] = {-990, -800, -320, -150, 3, 150, 320};
    brio_context *ctx = new_context();
    double points[3 * N], scaled[3 * N], box[6];
    uniform_points(11, N, points);
    brio_cells *cells = cells_of(ctx, points, NULL, N, UNIT_BOX, 1);
    for (size_t e = 0; e < sizeof EXPONENT / sizeof *EXPONENT; e++) {
        for (size_t i = 0; i < 3 * N; i++) scaled[i] = ldexp(points[i], EXPONENT[e]);
        for (size_t i = 0; i < 6; i++) box[i] = ldexp(UNIT_BOX[i], EXPONENT[e]);
        brio_cells *other = cells_of(ctx, scaled, NULL, N, box, 1);
        for (size_t c = 0; c < N; c++) {
            EXPECT(other->volume[c] == ldexp(cells->volume[c], 3 * EXPONENT[e]), "2^%d", EXPONENT[e]);
            EXPECT(other->area[c] == ldexp(cells->area[c], 2 * EXPONENT[e]), "2^%d", EXPONENT[e]);
            EXPECT(other->centroid[3 * c] == ldexp(cells->centroid[3 * c], EXPONENT[e]), "2^%d", EXPONENT[e]);
        }
        brio_cells_free(other);
    }
    brio_cells_free(cells);
    brio_context_free(ctx);
}

static void wrong_regions_are_refused(void) {
    brio_context *ctx = new_context();
    const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, nan_point[3] = {0, NAN, 0};
    const double empty[6] = {0, 0, 0, 1, 0, 1}, endless[6] = {0, 0, 0, 1, INFINITY, 1};
    const double half[4] = {1, 0, 0, 1}, no_normal[4] = {0, 0, 0, 1};
    const double apart[8] = {1, 0, 0, 1, -1, 0, 0, -2};
    brio_cells_options o = {0};
    brio_cells *cells;
#define EXPECT_REFUSED(status) EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, 4, &o, &cells) == (status) && !cells)
    o.box = empty;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    o.box = endless;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    o.box = NULL, o.num_planes = 1;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    o.planes = half;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    o.planes = no_normal;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    o.planes = apart, o.num_planes = 2;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    o.size = 0;
    EXPECT_REFUSED(BRIO_ERR_ARGUMENT);
    EXPECT(brio_voronoi_cells(ctx, NULL, nan_point, NULL, 1, NULL, &cells) == BRIO_ERR_NOT_FINITE && !cells);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void expect_region_message(const brio_cells_options *o, const char *part) {
    const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    brio_context *ctx = new_context();
    for (size_t n = 0; n <= 4; n++) {
        brio_cells *cells;
        EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, n, o, &cells) == BRIO_ERR_ARGUMENT && !cells);
        EXPECT(strstr(brio_message(ctx), part), "%zu points: %s", n, brio_message(ctx));
    }
    brio_context_free(ctx);
}

/* With two points or more these regions were called too large or too small, and one without an end empty. */
static void messages_say_what_is_wrong_with_a_region(void) {
    const double far[6] = {-INFINITY, -1, -1, 2, 2, 2}, nan[6] = {-1, -1, -1, 2, NAN, 2};
    const double planes[8] = {1, 0, 0, 1, 0, NAN, 0, 1}, distant[4] = {0, 1, 0, INFINITY}, no_normal[4] = {0, 0, 0, 1};
    const double endless[20] = {1, 0, 0, 1, -1, 0, 0, 0, 0, 1, 0, 1, 0, -1, 0, 0, 0, 0, 1, 1};
    brio_cells_options o = {0};
    o.box = far;
    expect_region_message(&o, "number 0 of the box is not finite");
    o.box = nan;
    expect_region_message(&o, "number 4 of the box is not finite");
    o.box = WIDE_BOX, o.planes = planes, o.num_planes = 2;
    expect_region_message(&o, "plane 1 of the region is not finite");
    o.planes = distant, o.num_planes = 1;
    expect_region_message(&o, "plane 0 of the region is not finite");
    o.planes = no_normal;
    expect_region_message(&o, "plane 0 of the region has the normal 0");
    o.box = NULL, o.planes = endless, o.num_planes = 5;
    expect_region_message(&o, "the region is unbounded");
}

static brio_status compute_some(brio_context *ctx) {
    enum { N = 60 };
    double points[3 * N];
    brio_cells_options o = {0};
    brio_cells *cells;
    integer_points(2, N, 4, points);
    o.box = WIDE_BOX;
    o.vertices = 1;
    brio_mesh *mesh = NULL;
    brio_status status = brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &cells);
    if (status == BRIO_OK) status = brio_cells_mesh(ctx, cells, 7, 0.1, NULL, &mesh);
    brio_mesh_free(mesh);
    brio_cells_free(cells);
    if (status != BRIO_OK) return status;
    o.vertices = 0;
    o.no_faces = o.no_areas = o.no_centroids = 1;
    status = brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &cells);
    brio_cells_free(cells);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < N; i++) points[3 * i + 2] = 0;
    o.vertices = 1;
    status = brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &cells);
    brio_cells_free(cells);
    return status;
}

/* Rounding left walls of the box from which the region was cut, whose numbers were beyond the planes. */
static void a_region_too_flat_for_doubles_is_refused(void) {
    static const double point[3] = {-4, -4, -4}, box[6] = {-4, -4, -4, 2, -2, 3};
    static const double planes[16] = {1e77, 1e77, -4, -4, -4, 6, 1e77, 1e77, 10, 2, 2, 1.9e98, -4, -4, -4, -4};
    brio_context *ctx = new_context();
    brio_cells_options o = {0};
    brio_cells *cells;
    o.box = box, o.planes = planes, o.num_planes = 4;
    EXPECT(brio_voronoi_cells(ctx, NULL, point, NULL, 1, &o, &cells) == BRIO_ERR_ARGUMENT && !cells);
    EXPECT(strstr(brio_message(ctx), "region"), "%s", brio_message(ctx));
    brio_context_free(ctx);
}

/* Squares of lengths of the region were beyond doubles: areas were infinite, centroids NaN; or below them: an empty region. */
static void a_region_much_larger_or_smaller_than_the_points(void) {
    static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const double sizes[] = {1e80, 1e90, 1e-80, 1e-90};
    brio_context *ctx = new_context();
    for (size_t n = 1; n <= 4; n += 3)
        for (size_t k = 0; k < 4; k++) {
            double s = sizes[k], volume = 0, box[6] = {-s, -s, -s, s, s, s};
            brio_cells_options o = {0};
            brio_cells *cells = NULL;
            o.box = box;
            EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, n, &o, &cells) == BRIO_OK, "%s", brio_message(ctx));
            for (size_t c = 0; cells && c < cells->num_cells; c++) {
                volume += cells->volume[c];
                EXPECT(isfinite(cells->area[c]), "size %g: area %g", s, cells->area[c]);
                EXPECT(!(cells->volume[c] > 0) || isfinite(cells->centroid[3 * c]), "size %g", s);
            }
            EXPECT(fabs(volume / (8 * s * s * s) - 1) < 1e-9, "size %g, %zu points: volume %g", s, n, volume);
            brio_cells_free(cells);
        }
    brio_context_free(ctx);
}

/* Cells that are bounded had no faces and no volume, since the squares of lengths of the points were below doubles. */
static void a_region_too_large_beside_the_points_is_refused(void) {
    static const double points[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.25, 0.25, 0.25};
    brio_context *ctx = new_context();
    for (int exponent = 0; exponent < 1023; exponent++) {
        double s = ldexp(1, exponent + 1), box[6] = {-s, -s, -s, s, s, s};
        brio_cells_options o = {0};
        brio_cells *cells = NULL;
        o.box = box;
        brio_status status = brio_voronoi_cells(ctx, NULL, points, NULL, 5, &o, &cells);
        EXPECT(status == (exponent < 599 ? BRIO_OK : BRIO_ERR_ARGUMENT), "2^%d: %s", exponent, brio_message(ctx));
        for (size_t c = 0; cells && c < cells->num_cells; c++)
            EXPECT(cells->volume[c] > 0 && cells->face_offsets[c] < cells->face_offsets[c + 1], "2^%d", exponent);
        brio_cells_free(cells);
    }
    brio_context_free(ctx);
}

/* Rounding lost more than the region was large: no cell had a volume, or all cells too much of it. */
static void a_region_too_small_beside_its_sites_is_refused(void) {
    enum { N = 200 };
    double points[3 * N];
    brio_context *ctx = new_context();
    uniform_points(5, N, points);
    for (size_t i = 0; i < 3 * N; i++) points[i] -= 0.5;
    for (int exponent = 0; exponent < 100; exponent++) {
        double s = ldexp(1, -exponent), box[6] = {-s, -s, -s, s, s, s};
        brio_cells_options o = {0};
        brio_cells *cells = NULL;
        o.box = box;
        brio_status status = brio_voronoi_cells(ctx, NULL, points, NULL, N, &o, &cells);
        EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && exponent > 40), "2^-%d: %s", exponent,
               brio_message(ctx));
        if (cells) EXPECT(near_to(cells->volume_sum, cells->region_volume, 0.01), "2^-%d", exponent);
        EXPECT(!cells || exponent < 60, "2^-%d", exponent);
        brio_cells_free(cells);
    }
    brio_context_free(ctx);
}

/* Centres beyond doubles made the volume and the areas NaN, in the other set minus infinity. */
static void what_doubles_cannot_hold_is_infinite(void) {
    static const double points[2][36] = {
        {5e-324, -4, -4, -4, 6.999999999999973, 5e-324, -1, -2, -4, -4, -4, -6.312163081858048e+212, -4, -4, -4},
        {4,
         5,
         -1.0000000000000001e-09,
         1,
         9.7882873059849429e+97,
         -2,
         0.99999999999998579,
         -3,
         6,
         2,
         -4,
         1e-150,
         1e+17,
         6,
         -8.7843122217192694e-127,
         -1.2199398052693137e-60,
         8,
         1e+100,
         5,
         11,
         -9.8110353327812743e+197,
         0.33333333333333331,
         6.7534574514433321e-59,
         1e+17,
         1,
         11,
         3,
         -0.,
         3,
         10,
         1,
         6,
         4,
         2.5095400757544485e+76,
         1e+17,
         6}};
    static const double weights[12] = {
        -8.7843122217192694e-127, -1.2199398052693137e-60, 8,     1e+100, 5, 11, -9.8110353327812743e+197,
        0.33333333333333331,      6.7534574514433321e-59,  1e+17, 1,      11};
    brio_context *ctx = new_context();
    for (int run = 0; run < 4; run++) {
        bool areas = run % 2;
        brio_cells_options o = {0};
        brio_cells *cells;
        o.no_areas = o.no_centroids = o.no_faces = !areas;
        EXPECT(brio_voronoi_cells(ctx, NULL, points[run / 2], run < 2 ? NULL : weights, run < 2 ? 5 : 12, &o, &cells) ==
                   BRIO_OK,
               "%s", brio_message(ctx));
        for (size_t c = 0; c < cells->num_cells; c++) {
            EXPECT(cells->volume[c] >= 0, "run %d, cell %zu: volume %g", run, c, cells->volume[c]);
            EXPECT(!areas || cells->area[c] >= 0, "run %d, cell %zu: area %g", run, c, cells->area[c]);
        }
        for (uint64_t f = 0; areas && f < cells->face_offsets[cells->num_cells]; f++)
            EXPECT(cells->face_areas[f] >= 0, "run %d, face %llu", run, (unsigned long long)f);
        brio_cells_free(cells);
    }
    brio_context_free(ctx);
}

/* Small coordinates vanish when they are scaled with large ones. */
static void normals_are_unit_vectors_between_points_of_any_sizes(void) {
    static const double points[3][15] = {{0, 0, 0, 1e-170, 0, 0, 0, 1e-170, 0, 0, 0, 1e-170, 1e170, 1e170, 1e170},
                                         {0, 0, 0, 5e-324, 0, 0, 0, 5e-324, 0, 0, 0, 5e-324, 1, 1, 1},
                                         {-1.7e308, 0, 0, 1.7e308, 0, 0, 0, 1.7e308, 0, 0, -1.7e308, 0, 0, 0, 1.7e308}};
    brio_context *ctx = new_context();
    for (size_t s = 0; s < 3; s++) {
        brio_cells *cells = cells_of(ctx, points[s], NULL, 5, NULL, 0);
        size_t faces = cells ? (size_t)cells->face_offsets[cells->num_cells] : 0;
        EXPECT(faces > 0, "set %zu", s);
        for (size_t f = 0; f < faces; f++) {
            const double *n = cells->face_normals + 3 * f;
            double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
            EXPECT(fabs(square - 1) < 1e-14, "set %zu, face %zu: %g %g %g", s, f, n[0], n[1], n[2]);
        }
        brio_cells_free(cells);
    }
    brio_context_free(ctx);
}

/* Cells as a mesh: each a closed solid of its volume; a choice is of whole cells, and shrinks each towards its middle. */
static void cells_are_solids_of_a_mesh(void) {
    enum { N = 100, FEW = 9 };
    double points[3 * N], volume = 0;
    brio_context *ctx = new_context();
    brio_mesh *all, *few;
    size_t left_out;
    uniform_points(3, N, points);
    brio_cells *cells = cells_of(ctx, points, NULL, N, UNIT_BOX, 1),
               *flat = cells_of(ctx, points, NULL, N, UNIT_BOX, 0);
    EXPECT(brio_cells_mesh(ctx, cells, 0, 0, &left_out, &all) == BRIO_OK && left_out == 0, "%s", brio_message(ctx));
    EXPECT(brio_cells_mesh(ctx, cells, FEW, 0.5, &left_out, &few) == BRIO_OK && left_out == N - FEW);
    const brio_mesh *meshes[] = {all, few};
    for (int i = 0; i < 2; i++) {
        const brio_mesh *m = meshes[i];
        const brio_property *site = &m->face_properties[0];
        brio_certificate c = {.size = sizeof c};
        size_t f = 0, components = i ? FEW : N;
        EXPECT(brio_mesh_certificate(ctx, m, &c) == BRIO_OK && c.closed && c.manifold && c.oriented);
        EXPECT(c.components == components && c.genus == 0, "%zu components", c.components);
        for (volume = 0; f < m->num_faces; f++) /* each cell's faces follow each other */
            if (!f || brio_property_value(site, f) != brio_property_value(site, f - 1))
                volume += brio_property_value(&m->face_properties[1], f);
        EXPECT(near_to(i ? c.volume * 8 : c.volume, volume, 1e-12), "%g, and cells of %g", c.volume, volume);
        brio_certificate_free(&c);
    }
    brio_mesh_free(few);
    EXPECT(brio_cells_mesh(ctx, flat, 0, 0, NULL, &few) == BRIO_ERR_ARGUMENT && !few);
    EXPECT(brio_cells_mesh(ctx, cells, 0, 1, NULL, &few) == BRIO_ERR_ARGUMENT && !few);
    brio_mesh_free(all);
    brio_cells_free(cells);
    brio_cells_free(flat);
    brio_context_free(ctx);
}

static void memory_may_run_out(void) {
    expect_clean_failures(compute_some);
}

SUITE(test_cells) {
    RUN(cells_equal_those_of_brute_force);
    RUN(cells_of_a_lattice_have_six_faces);
    RUN(volumes_add_up_to_the_box);
    RUN(a_polytope_clips);
    RUN(faces_are_symmetric_and_have_their_corners);
    RUN(cells_of_the_hull_are_unbounded);
    RUN(flat_points_have_cells);
    RUN(shares_are_within_their_bounds);
    RUN(bounds_of_small_tetrahedra_were_0);
    RUN(neighbours_alone_are_those_of_whole_cells);
    RUN(volumes_alone_equal_those_with_faces);
    RUN(sweeps_take_the_memory_that_is_told);
    RUN(volumes_alone_have_the_same_bits_with_threads);
    RUN(an_offset_moves_the_cells);
    RUN(threads_give_the_same_bits);
    RUN(cells_do_not_depend_on_the_order_of_the_points);
    RUN(powers_of_two_scale_the_cells);
    RUN(wrong_regions_are_refused);
    RUN(messages_say_what_is_wrong_with_a_region);
    RUN(a_region_too_flat_for_doubles_is_refused);
    RUN(a_region_much_larger_or_smaller_than_the_points);
    RUN(a_region_too_large_beside_the_points_is_refused);
    RUN(a_region_too_small_beside_its_sites_is_refused);
    RUN(what_doubles_cannot_hold_is_infinite);
    RUN(normals_are_unit_vectors_between_points_of_any_sizes);
    RUN(cells_are_solids_of_a_mesh);
    RUN(memory_may_run_out);
    return harness_end();
}
