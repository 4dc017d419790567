/* Properties of points carried to the vertices of a mesh, against brute force. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"

enum { POINTS = 400, VERTICES = 600 };

static brio_mesh *mesh_of(brio_context *ctx, const double *positions, size_t count) {
    brio_mesh *mesh = NULL;
    if (brio_mesh_new(ctx, &mesh) != BRIO_OK) return NULL;
    if (brio_mesh_set_vertices(mesh, positions, count) == BRIO_OK) return mesh;
    brio_mesh_free(mesh);
    return NULL;
}

/* Adds the property "number": of each point its index. */
static brio_status number_points(brio_mesh *mesh) {
    void *data;
    brio_status status = brio_mesh_add_property(mesh, "number", BRIO_SCALAR_UINT16, &data);
    for (size_t i = 0; status == BRIO_OK && i < mesh->num_vertices; i++) ((uint16_t *)data)[i] = (uint16_t)i;
    return status;
}

static double square(const double *p, const double *q) {
    double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z;
}

static int compare(const double *p, const double *q) {
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* The nearest point; ties are lexicographic, then by index. */
static size_t nearest(const double *points, size_t count, const double *x) {
    size_t best = 0;
    for (size_t i = 1; i < count; i++) {
        const double *p = points + 3 * i, *q = points + 3 * best;
        double own = square(p, x), least = square(q, x);
        if (own < least || (own == least && compare(p, q) < 0)) best = i;
    }
    return best;
}

static void expect_nearest(brio_context *ctx, const double *points, size_t count, const double *vertices) {
    brio_mesh *source = mesh_of(ctx, points, count), *mesh = mesh_of(ctx, vertices, VERTICES);
    EXPECT(number_points(source) == BRIO_OK);
    EXPECT(brio_mesh_carry_properties(ctx, source, NULL, mesh) == BRIO_OK, "%s", brio_message(ctx));
    const brio_property *p = brio_mesh_property(mesh, "number");
    EXPECT(p && p->type == BRIO_SCALAR_UINT16);
    for (size_t v = 0; p && v < VERTICES; v++)
        EXPECT(((const uint16_t *)p->data)[v] == nearest(points, count, vertices + 3 * v), "vertex %zu", v);
    brio_mesh_free(source);
    brio_mesh_free(mesh);
}

/* Grids have ties and coincident points; the scales have squares that overflow, and squares that vanish. */
static void every_vertex_takes_the_nearest_point(void) {
    static const double scales[] = {1, 0x1p600, 0x1p-600};
    static double points[3 * POINTS], vertices[3 * VERTICES], scaled[3 * POINTS], scaled_vertices[3 * VERTICES];
    for (int threads = 1; threads <= 3; threads++)
        for (uint64_t seed = 1; seed <= 4; seed++) {
            brio_context *ctx = new_context();
            brio_context_set_threads(ctx, threads);
            uniform_points(seed, POINTS, points);
            uniform_points(seed + 50, VERTICES, vertices);
            expect_nearest(ctx, points, POINTS, vertices);
            integer_points(seed, POINTS, 6, points);
            integer_points(seed + 50, VERTICES, 9, vertices);
            for (size_t i = 0; i < 3 * VERTICES; i++) vertices[i] -= 1.5; /* between the points */
            expect_nearest(ctx, points, POINTS, vertices);
            expect_nearest(ctx, points, 1, vertices);
            brio_context_free(ctx);
        }
    brio_context *ctx = new_context();
    for (int s = 0; s < 3; s++) {
        for (size_t i = 0; i < 3 * POINTS; i++) scaled[i] = points[i] * scales[s];
        for (size_t i = 0; i < 3 * VERTICES; i++) scaled_vertices[i] = vertices[i] * scales[s];
        brio_mesh *source = mesh_of(ctx, scaled, POINTS), *mesh = mesh_of(ctx, scaled_vertices, VERTICES);
        EXPECT(number_points(source) == BRIO_OK);
        EXPECT(brio_mesh_carry_properties(ctx, source, NULL, mesh) == BRIO_OK);
        const uint16_t *data = brio_mesh_property(mesh, "number")->data;
        for (size_t v = 0; v < VERTICES; v++) EXPECT(data[v] == nearest(points, POINTS, vertices + 3 * v));
        brio_mesh_free(source);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static void named_samples_are_copied_with_every_bit(void) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, vertices[] = {9, 9, 9, 8, 8, 8};
    static const uint32_t samples[] = {2, 0}, wrong[] = {2, 3};
    brio_context *ctx = new_context();
    brio_mesh *source = mesh_of(ctx, points, 3), *mesh = mesh_of(ctx, vertices, 2);
    for (brio_scalar type = BRIO_SCALAR_INT8; type < BRIO_SCALAR_END; type++) {
        char name[64];
        void *data;
        snprintf(name, sizeof name, "odd name, %d", (int)type);
        EXPECT(brio_mesh_add_property(source, name, type, &data) == BRIO_OK);
        for (size_t i = 0; i < 3 * brio_scalar_size(type); i++) ((uint8_t *)data)[i] = (uint8_t)(200 + 7 * i + type);
    }
    EXPECT(brio_mesh_carry_properties(ctx, source, wrong, mesh) == BRIO_ERR_ARGUMENT && !mesh->num_properties);
    EXPECT(brio_mesh_carry_properties(ctx, source, samples, mesh) == BRIO_OK && mesh->num_properties == 8);
    for (size_t i = 0; i < mesh->num_properties; i++) {
        const brio_property *from = &source->properties[i], *to = &mesh->properties[i];
        size_t size = brio_scalar_size(from->type);
        EXPECT(!strcmp(from->name, to->name) && from->type == to->type);
        for (size_t v = 0; v < 2; v++)
            EXPECT(!memcmp((char *)to->data + v * size, (char *)from->data + samples[v] * size, size));
    }
    brio_mesh_free(source);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* A name that is taken lost the property before. */
static void no_name_that_is_taken_loses_a_property(void) {
    static const double points[3] = {0};
    static const char longest[] = "a123456789b123456789c123456789d123456789e123456789f123456789abc";
    brio_context *ctx = new_context();
    brio_mesh *mesh = mesh_of(ctx, points, 1), *source = mesh_of(ctx, points, 1);
    EXPECT(strlen(longest) == 63);
    EXPECT(brio_mesh_add_property(source, "r", BRIO_SCALAR_INT8, NULL) == BRIO_OK);
    EXPECT(brio_mesh_add_property(source, longest, BRIO_SCALAR_INT8, NULL) == BRIO_OK);
    for (int i = 0; i < 4; i++) EXPECT(brio_mesh_carry_properties(ctx, source, NULL, mesh) == BRIO_OK);
    EXPECT(mesh->num_properties == 8);
    EXPECT(brio_mesh_property(mesh, "r") && brio_mesh_property(mesh, "input_r"));
    EXPECT(brio_mesh_property(mesh, "input_r_2") && brio_mesh_property(mesh, "input_r_3"));
    EXPECT(brio_mesh_property(mesh, "input_a123456789b123456789c123456789d123456789e123456789f123456"));
    EXPECT(brio_mesh_property(mesh, "input_a123456789b123456789c123456789d123456789e123456789f1234_2"));
    brio_mesh_free(source);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void what_is_wrong_is_refused(void) {
    static const double origin[3] = {0}, wrong[3] = {0, NAN, 0};
    brio_context *ctx = new_context();
    brio_mesh *none = mesh_of(ctx, NULL, 0), *one = mesh_of(ctx, origin, 1), *nan = mesh_of(ctx, wrong, 1);
    EXPECT(brio_mesh_carry_properties(ctx, one, NULL, none) == BRIO_OK); /* no properties: nothing to do */
    EXPECT(number_points(none) == BRIO_OK && number_points(one) == BRIO_OK);
    brio_mesh *mesh = mesh_of(ctx, origin, 1), *empty = mesh_of(ctx, NULL, 0);
    EXPECT(brio_mesh_carry_properties(ctx, none, NULL, mesh) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_carry_properties(ctx, one, NULL, nan) == BRIO_ERR_NOT_FINITE);
    EXPECT(brio_mesh_carry_properties(ctx, one, NULL, empty) == BRIO_OK && empty->num_properties == 1);
    brio_mesh_free(none);
    brio_mesh_free(one);
    brio_mesh_free(nan);
    brio_mesh_free(mesh);
    brio_mesh_free(empty);
    brio_context_free(ctx);
}

/* The second property moved the mesh's, of which the loop had the first. */
static void a_mesh_may_carry_its_own_properties(void) {
    static double p[3 * 50];
    brio_context *ctx = new_context();
    uniform_points(5, 50, p);
    brio_mesh *mesh = mesh_of(ctx, p, 50);
    EXPECT(number_points(mesh) == BRIO_OK &&
           brio_mesh_add_property(mesh, "second", BRIO_SCALAR_FLOAT64, NULL) == BRIO_OK);
    EXPECT(brio_mesh_carry_properties(ctx, mesh, NULL, mesh) == BRIO_OK && mesh->num_properties == 4);
    const brio_property *copy = brio_mesh_property(mesh, "input_number");
    EXPECT(copy && !memcmp(copy->data, brio_mesh_property(mesh, "number")->data, 50 * sizeof(uint16_t)));
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static brio_status carry_some(brio_context *ctx) {
    static double points[3 * 50], vertices[3 * 40];
    brio_mesh *source, *mesh;
    uniform_points(3, 50, points);
    uniform_points(4, 40, vertices);
    brio_status status = brio_mesh_new(ctx, &source);
    if (status != BRIO_OK) return status;
    status = brio_mesh_new(ctx, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, vertices, 40);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(source, points, 50);
    if (status == BRIO_OK) status = number_points(source);
    if (status == BRIO_OK) status = brio_mesh_add_property(source, "second", BRIO_SCALAR_FLOAT64, NULL);
    if (status == BRIO_OK) {
        status = brio_mesh_carry_properties(ctx, source, NULL, mesh);
        EXPECT(mesh->num_properties == (status == BRIO_OK ? 2 : 0));
    }
    brio_mesh_free(source);
    brio_mesh_free(mesh);
    return status;
}

static void every_failing_allocation_leaves_the_mesh_as_it_was(void) {
    expect_clean_failures(carry_some);
}

static int refuse(const char *stage, double fraction, void *user) {
    (void)stage, (void)fraction, (void)user;
    return 1;
}

static void a_cancelled_call_leaves_nothing(void) {
    brio_context *ctx = new_context();
    brio_context_set_progress(ctx, refuse, NULL);
    EXPECT(carry_some(ctx) == BRIO_ERR_CANCELLED);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_carry_properties) {
    RUN(every_vertex_takes_the_nearest_point);
    RUN(named_samples_are_copied_with_every_bit);
    RUN(no_name_that_is_taken_loses_a_property);
    RUN(what_is_wrong_is_refused);
    RUN(every_failing_allocation_leaves_the_mesh_as_it_was);
    RUN(a_mesh_may_carry_its_own_properties);
    RUN(a_cancelled_call_leaves_nothing);
    return harness_end();
}
