/* Explanations of surfaces: poles are those that the library finds, to the last bit; their balls touch the sample and are
 * empty; labels change where a face was taken and nowhere else; the faces are those of the surface; cells are the
 * nearest places; a choice of samples has what all of them have. */
#include "dual/pole_vectors.h"
#include "failing_allocator.h"
#include "reconstruct/explanation/explanation.h"
#include "points.h"

/* FEW: so that every sample can be held against all others. */
enum { FEW = 300 };
static const double NEAR = 1e-9;

typedef struct {
    brio_context *ctx;
    double points[3 * FEW];
    brio_mesh *mesh;
    brio_explanation *e;
} case_of;

/* Points on a box of round corners, so that there are sharp and smooth parts. */
static void make_points(double *points) {
    sphere_points(7, FEW, points);
    for (size_t i = 0; i < 3 * FEW; i++) points[i] = 100 + 3 * fmax(-0.8, fmin(0.8, points[i]));
    for (size_t i = 0; i < FEW; i++) points[3 * i] *= 1 + 1e-3 * (double)(i % 7); /* no four in a plane */
}

static case_of explained(brio_surface_method method, size_t most) {
    case_of c = {.ctx = new_context()};
    brio_surface_options o = {.size = sizeof o, .method = method, .explanation = &c.e, .explained = most};
    if (method == BRIO_SURFACE_LABELED) o.noise = BRIO_NOISE_KEEP;
    if (method == BRIO_SURFACE_POWER_CRUST) o.polygons = 1, o.noise = BRIO_NOISE_KEEP;
    make_points(c.points);
    EXPECT(brio_surface(c.ctx, c.points, FEW, &o, &c.mesh, NULL) == BRIO_OK, "%s", brio_message(c.ctx));
    return c;
}

static void end(case_of *c) {
    brio_explanation_free(c->e);
    brio_mesh_free(c->mesh);
    brio_context_free(c->ctx);
}

static double distance(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Returns the distance of the nearest point. */
static double nearest(const case_of *c, const double *from) {
    double least = INFINITY;
    for (size_t p = 0; p < FEW; p++) least = fmin(least, distance(from, c->points + 3 * p));
    return least;
}

/* What holds for every method. */
static void expect_sound(const case_of *c) {
    const brio_explanation *e = c->e;
    size_t poles = 0, labeled = 0;
    EXPECT(e->num_samples == FEW && e->all_samples == FEW, "%zu of %zu", e->num_samples, e->all_samples);
    for (size_t i = 0; i < e->num_samples; i++) {
        const double *place = e->place + 3 * i;
        EXPECT(!memcmp(place, c->points + 3 * (size_t)e->point[i], 3 * sizeof *place), "sample %u", e->point[i]);
        for (size_t k = 0; k < 2; k++) {
            const double *pole = e->pole + 8 * i + 4 * k;
            if (!isfinite(pole[3])) continue;
            EXPECT(fabs(distance(pole, place) - pole[3]) < NEAR * pole[3], "a ball does not touch its sample");
            EXPECT(nearest(c, pole) > (1 - NEAR) * pole[3], "a ball holds a sample");
            poles++, labeled += e->pole_side[2 * i + k] != 0;
        }
        for (uint64_t n = e->polygon_offsets[i]; n < e->polygon_offsets[i + 1]; n++)
            for (uint64_t k = e->corner_offsets[n]; k < e->corner_offsets[n + 1]; k++) {
                const double *corner = e->vertices + 3 * (size_t)e->corners[k];
                EXPECT(e->corners[k] >= e->vertex_offsets[i] && e->corners[k] < e->vertex_offsets[i + 1]);
                if (e->polygon_kind[n] == BRIO_EXPLAINED_CELL)
                    EXPECT(distance(corner, place) < nearest(c, corner) * (1 + 1e-6) + NEAR, "a cell is too large");
            }
    }
    EXPECT(poles > FEW && labeled == poles, "%zu poles, %zu with labels", poles, labeled);
}

/* --- faces --- */

static int compare_faces(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

static void sort_corners(uint32_t f[3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++)
            if (f[j] > f[j + 1]) {
                uint32_t kept = f[j];
                f[j] = f[j + 1], f[j + 1] = kept;
            }
}

/* Sorts faces and drops those that are there twice; returns their number. */
static size_t sort_faces(uint32_t (*f)[3], size_t n) {
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) sort_corners(f[i]);
    qsort(f, n, sizeof *f, compare_faces);
    for (size_t i = 0; i < n; i++)
        if (!kept || compare_faces(f[i], f[kept - 1])) memmove(f[kept++], f[i], sizeof *f);
    return kept;
}

/* The facets that were taken are the faces of the mesh, and between them labels change. */
static void expect_faces(const case_of *c) {
    const brio_explanation *e = c->e;
    const brio_mesh *m = c->mesh;
    size_t tetrahedra = (size_t)e->tetrahedron_offsets[FEW], n = 0;
    uint32_t(*taken)[3] = malloc(4 * tetrahedra * sizeof *taken), (*faces)[3] = malloc(m->num_faces * sizeof *faces);
    for (size_t t = 0; t < tetrahedra; t++)
        for (int i = 1; i < 4; i++) {
            const uint32_t *v = e->tetrahedra + 4 * t;
            if (!(e->tetrahedron_taken[t] >> i & 1)) continue;
            for (int k = 0, j = 0; k < 4; k++)
                if (k != i) taken[n][j++] = e->vertex_point[v[k]];
            n++;
        }
    for (size_t f = 0; f < m->num_faces; f++)
        for (size_t k = 0; k < 3; k++)
            faces[f][k] = (uint32_t)brio_property_value(brio_mesh_property(m, "sample"), m->face_vertices[3 * f + k]);
    size_t a = sort_faces(taken, n), b = sort_faces(faces, m->num_faces);
    EXPECT(a == b && !memcmp(taken, faces, a * sizeof *taken), "%zu facets were taken, and there are %zu faces", a, b);
    free(taken);
    free(faces);
}

/* Tetrahedra that share a facet at the sample have two labels if it was taken, and one if not.   strict  whether all
 * such facets are taken, as of closed surfaces. */
static void expect_labels(const case_of *c, bool strict) {
    const brio_explanation *e = c->e;
    size_t between = 0;
    for (size_t s = 0; s < e->num_samples; s++)
        for (uint64_t t = e->tetrahedron_offsets[s]; t < e->tetrahedron_offsets[s + 1]; t++)
            for (uint64_t u = e->tetrahedron_offsets[s]; u < t; u++)
                for (int i = 1; i < 4; i++)
                    for (int j = 1; j < 4; j++) {
                        uint32_t a[2], b[2];
                        for (int k = 0; k < 2; k++) {
                            a[k] = e->tetrahedra[4 * t + 1 + (uint64_t)(i + k) % 3];
                            b[k] = e->tetrahedra[4 * u + 1 + (uint64_t)(j + k) % 3];
                        }
                        if (!(a[0] == b[0] && a[1] == b[1]) && !(a[0] == b[1] && a[1] == b[0])) continue;
                        bool differ = e->tetrahedron_side[t] != e->tetrahedron_side[u];
                        bool taken = e->tetrahedron_taken[t] >> i & 1;
                        EXPECT(taken == (e->tetrahedron_taken[u] >> j & 1), "a facet is taken on one side");
                        EXPECT(strict ? taken == differ : !taken || differ, "labels and faces disagree");
                        between += taken;
                    }
    EXPECT(between > 3 * FEW, "%zu facets between labels", between);
}

/* --- poles --- */

/* Poles are those of a triangulation of the points as they come. */
static void expect_poles(const case_of *c) {
    brio_triangulation *t = NULL;
    brio_pole_vectors v = {0};
    size_t same = 0;
    EXPECT(brio_delaunay(c->ctx, c->points, NULL, FEW, NULL, &t) == BRIO_OK);
    EXPECT(brio_pole_vectors_find(c->ctx, t, c->points, FEW, c->e->theta, &v) == BRIO_OK);
    for (size_t i = 0; i < FEW; i++)
        for (size_t k = 0; k < 2; k++) {
            uint32_t tet = v.pole[2 * (size_t)c->e->point[i] + k];
            const double *pole = c->e->pole + 8 * i + 4 * k, *row = v.centre + 4 * (size_t)tet;
            if (tet == BRIO_INFINITE || tet >= v.num_finite) {
                EXPECT(!isfinite(pole[3]));
                continue;
            }
            bool equal = !memcmp(pole, row, 3 * sizeof *row) && pole[3] == sqrt(row[3]);
            EXPECT(equal, "pole %zu of sample %u", k, c->e->point[i]);
            same += equal;
        }
    EXPECT(same > FEW, "%zu finite poles", same);
    brio_pole_vectors_free(c->ctx, &v);
    brio_triangulation_free(t);
}

static void labeled_surfaces_are_explained(void) {
    case_of c = explained(BRIO_SURFACE_LABELED, 0);
    expect_sound(&c);
    expect_faces(&c);
    expect_labels(&c, false);
    expect_poles(&c);
    size_t sure = 0;
    for (size_t t = 0; t < c.e->tetrahedron_offsets[FEW]; t++) sure += c.e->tetrahedron_confidence[t] > 0.9F;
    EXPECT(2 * sure > c.e->tetrahedron_offsets[FEW], "%zu labels are sure", sure);
    end(&c);
}

static void cocones_are_explained(void) {
    const brio_surface_method methods[] = {BRIO_SURFACE_COCONE, BRIO_SURFACE_TIGHT_COCONE};
    for (int i = 0; i < 2; i++) {
        case_of c = explained(methods[i], 0);
        expect_sound(&c);
        expect_faces(&c);
        expect_labels(&c, i == 1);
        expect_poles(&c);
        end(&c);
    }
}

static bool is_vertex(const brio_mesh *m, const double *place) {
    for (size_t v = 0; v < m->num_vertices; v++)
        if (!memcmp(m->vertices + 3 * v, place, 3 * sizeof *place)) return true;
    return false;
}

/* Polar balls are those of the power shape, and the polygons taken have the vertices of the crust. */
static void power_crusts_are_explained(void) {
    case_of c = explained(BRIO_SURFACE_POWER_CRUST, 0);
    const brio_explanation *e = c.e;
    const brio_power_shape_options o = {.sides = BRIO_SIDES_BOTH, .noise = BRIO_NOISE_KEEP};
    brio_mesh *shape = NULL;
    size_t same = 0, poles = 0, taken = 0, left = 0;
    expect_sound(&c);
    EXPECT(brio_power_shape(c.ctx, c.points, FEW, &o, &shape, NULL, NULL) == BRIO_OK, "%s", brio_message(c.ctx));
    for (size_t i = 0; i < 2 * FEW; i++) {
        const double *pole = e->pole + 4 * i;
        poles += isfinite(pole[3]);
        for (size_t v = 0; v < shape->num_vertices; v++)
            if (!memcmp(shape->vertices + 3 * v, pole, 3 * sizeof *pole)) {
                same++;
                EXPECT(brio_property_value(brio_mesh_property(shape, "radius"), v) == pole[3]);
                EXPECT((int)brio_property_value(brio_mesh_property(shape, "side"), v) == e->pole_side[i]);
                break;
            }
    }
    EXPECT(same > FEW, "%zu of %zu poles are in the power shape", same, poles); /* others have no cell */
    for (uint64_t n = 0; n < e->polygon_offsets[FEW]; n++) {
        left += e->polygon_kind[n] == BRIO_EXPLAINED_LEFT;
        if (e->polygon_kind[n] != BRIO_EXPLAINED_TAKEN) continue;
        for (uint64_t k = e->corner_offsets[n]; k < e->corner_offsets[n + 1]; k++)
            EXPECT(is_vertex(c.mesh, e->vertices + 3 * (size_t)e->corners[k]), "a corner is none of the crust's");
        taken++;
    }
    EXPECT(taken >= c.mesh->num_faces && left > FEW, "%zu and %zu faces, the crust has %zu", taken, left,
           c.mesh->num_faces);
    brio_mesh_free(shape);
    end(&c);
}

/* A choice has the same numbers as all. */
static void some_samples_are_explained_alike(void) {
    case_of all = explained(BRIO_SURFACE_LABELED, 0), some = explained(BRIO_SURFACE_LABELED, 20);
    const brio_explanation *a = all.e, *b = some.e;
    EXPECT(b->num_samples == 20 && b->all_samples == FEW);
    for (size_t i = 0; i < b->num_samples; i++) {
        size_t at = 0;
        while (a->point[at] != b->point[i]) at++;
        uint64_t first[2] = {a->vertex_offsets[at], b->vertex_offsets[i]};
        uint64_t count = b->vertex_offsets[i + 1] - first[1];
        EXPECT(a->vertex_offsets[at + 1] - first[0] == count);
        EXPECT(!memcmp(a->vertices + 3 * first[0], b->vertices + 3 * first[1], 3 * count * sizeof *a->vertices));
        EXPECT(!memcmp(a->pole + 8 * at, b->pole + 8 * i, 8 * sizeof *a->pole));
    }
    end(&all);
    end(&some);
}

/* Returns how many balls of a surface through the points times 2^exponent are none, nor a direction to one that doubles
 * cannot hold. */
static size_t count_unheld(int exponent, size_t *at_infinity) {
    case_of c = {.ctx = new_context()};
    const brio_surface_options o = {.size = sizeof o, .method = BRIO_SURFACE_COCONE, .explanation = &c.e};
    size_t unheld = 0;
    make_points(c.points);
    for (size_t i = 0; i < 3 * FEW; i++) c.points[i] = ldexp(c.points[i] - 100, exponent);
    EXPECT(brio_surface(c.ctx, c.points, FEW, &o, &c.mesh, NULL) == BRIO_OK, "%s", brio_message(c.ctx));
    *at_infinity = 0;
    for (size_t i = 0; i < 2 * c.e->num_samples; i++) {
        const double *p = c.e->pole + 4 * i;
        double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        *at_infinity += p[3] == INFINITY;
        if (p[3] == INFINITY)
            unheld += !(fabs(length - 1) < NEAR);
        else if (!isnan(p[3]))
            unheld += isinf(p[0]) || isinf(p[1]) || isinf(p[2]);
    }
    end(&c);
    return unheld;
}

/* Points of which doubles hold the places and not all balls: such a ball had an infinite centre, which a page read as a
 * direction. */
static void polar_balls_beyond_doubles_were_no_directions(void) {
    size_t usual, beyond;
    EXPECT(count_unheld(0, &usual) == 0);
    EXPECT(count_unheld(1022, &beyond) == 0);
    EXPECT(beyond > usual, "%zu poles at infinity, before %zu", beyond, usual);
}

/* A ball's samples share the pole in its middle; its cell has a face for each of them. */
static void samples_that_share_a_pole_were_each_told_all_of_its_cell(void) {
    enum { MANY = 800, A_SAMPLE = 100 };
    brio_context *ctx = new_context();
    static double points[3 * MANY];
    brio_explanation *e = NULL;
    brio_mesh *mesh = NULL;
    const brio_surface_options o = {
        .size = sizeof o, .method = BRIO_SURFACE_POWER_CRUST, .noise = BRIO_NOISE_KEEP, .explanation = &e};
    sphere_points(5, MANY, points);
    EXPECT(brio_surface(ctx, points, MANY, &o, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(e->polygon_offsets[MANY] < A_SAMPLE * (uint64_t)MANY, "%llu polygons of %d samples",
           (unsigned long long)e->polygon_offsets[MANY], MANY);
    size_t without = 0;
    for (size_t i = 0; i < MANY; i++) {
        size_t taken = 0;
        for (uint64_t n = e->polygon_offsets[i]; n < e->polygon_offsets[i + 1]; n++)
            taken += e->polygon_kind[n] == BRIO_EXPLAINED_TAKEN;
        without += !taken && e->pole_side[2 * i] * e->pole_side[2 * i + 1] < 0;
    }
    EXPECT(without < MANY / 20, "%zu samples of an inner and an outer pole without a face that was taken", without);
    brio_explanation_free(e);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Numbers of vertices have 32 bits. */
static void numbers_of_vertices_wrapped_round(void) {
    brio_context *ctx = new_context();
    brio_explanation e = {0};
    brio_explaining x = {.ctx = ctx, .e = &e, .vertices = UINT32_MAX};
    EXPECT(brio_explain_vertex(&x, (double[3]){0, 0, 0}, 0) == BRIO_ERR_TOO_LARGE && !e.vertices);
    brio_context_free(ctx);
}

/* The estimate had the bytes of a point that an explanation takes, and none of the explained samples. */
static void explained_samples_were_not_estimated(void) {
    enum { POINTS = 100000, BYTES = 3000 };
    brio_context *ctx = new_context();
    brio_explanation *e = NULL;
    uint64_t few = 0, usual = 0, all = 0;
    brio_surface_options o = {.size = sizeof o, .explanation = &e, .explained = 10};
    EXPECT(brio_estimate_surface(ctx, POINTS, &o, &few) == BRIO_OK);
    o.explained = 0;
    EXPECT(brio_estimate_surface(ctx, POINTS, &o, &usual) == BRIO_OK);
    o.explained = 10 * POINTS;
    EXPECT(brio_estimate_surface(ctx, POINTS, &o, &all) == BRIO_OK);
    EXPECT(usual > few + 4990 * (uint64_t)BYTES && all > usual + 95000 * (uint64_t)BYTES);
    brio_context_free(ctx);
}

static void failures_leave_no_explanation(void) {
    brio_context *ctx = new_context();
    brio_explanation *e = (brio_explanation *)&ctx; /* what is no explanation */
    brio_mesh *m;
    double points[3 * FEW];
    make_points(points);
    brio_surface_options o = {.size = sizeof o, .explanation = &e, .method = BRIO_SURFACE_OFFSET};
    EXPECT(brio_surface(ctx, points, FEW, &o, &m, NULL) == BRIO_ERR_ARGUMENT && !e && !m);
    e = (brio_explanation *)&ctx;
    o.method = BRIO_SURFACE_COCONE, o.pieces = 2;
    EXPECT(brio_surface(ctx, points, FEW, &o, &m, NULL) == BRIO_ERR_ARGUMENT && !e && !m);
    e = (brio_explanation *)&ctx;
    o.method = BRIO_SURFACE_LABELED, o.pieces = 0;
    EXPECT(brio_surface(ctx, points, 3, &o, &m, NULL) == BRIO_ERR_NO_ANSWER && !e && !m);
    brio_context_free(ctx);
    brio_explanation_free(NULL);
}

static brio_status explain_few(brio_context *ctx, brio_surface_method method) {
    double points[3 * 40];
    brio_explanation *e = NULL;
    brio_mesh *m = NULL;
    sphere_points(3, 40, points);
    const brio_surface_options o = {.size = sizeof o, .method = method, .explanation = &e};
    brio_status status = brio_surface(ctx, points, 40, &o, &m, NULL);
    EXPECT((status == BRIO_OK) == (m && e), "a failure leaves a surface or an explanation");
    brio_explanation_free(e);
    brio_mesh_free(m);
    return status;
}

static brio_status explain_labeled(brio_context *ctx) {
    return explain_few(ctx, BRIO_SURFACE_LABELED);
}
static brio_status explain_crust(brio_context *ctx) {
    return explain_few(ctx, BRIO_SURFACE_POWER_CRUST);
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(explain_labeled);
    expect_clean_failures(explain_crust);
}

SUITE(test_explanation) {
    RUN(labeled_surfaces_are_explained);
    RUN(cocones_are_explained);
    RUN(power_crusts_are_explained);
    RUN(some_samples_are_explained_alike);
    RUN(polar_balls_beyond_doubles_were_no_directions);
    RUN(samples_that_share_a_pole_were_each_told_all_of_its_cell);
    RUN(numbers_of_vertices_wrapped_round);
    RUN(explained_samples_were_not_estimated);
    RUN(failures_leave_no_explanation);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
