/* What a file cannot hold: how far coordinates move, and names that become equal. */
#include "io_files.h"
#include "points.h"

enum { N = 600 };

/* Triangles of three vertices each, so that a STL file keeps their order. */
static brio_mesh *triangles(const double *points, size_t n, bool faces) {
    static uint64_t offsets[N / 3 + 1];
    static uint32_t corners[N];
    brio_mesh *mesh;
    EXPECT(brio_mesh_new(io_ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, n) == BRIO_OK);
    for (size_t i = 0; i <= n / 3; i++) offsets[i] = 3 * i;
    for (size_t i = 0; i < n; i++) corners[i] = (uint32_t)i;
    if (faces) EXPECT(brio_mesh_set_faces(mesh, offsets, corners, n / 3) == BRIO_OK);
    return mesh;
}

static double greatest_distance(const brio_mesh *a, const brio_mesh *b) {
    double most = 0;
    for (size_t v = 0; v < a->num_vertices; v++) {
        const double *p = a->vertices + 3 * v, *q = b->vertices + 3 * (b->num_faces ? b->face_vertices[v] : v);
        double by[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
        most = fmax(most, hypot(by[0], hypot(by[1], by[2])));
    }
    return most;
}

/* Writes, reads, and compares the distance that was said with the one that is seen. Returns it. */
static double check_moved(const double *points, const char *name, int float32) {
    brio_mesh *back = NULL, *mesh = triangles(points, N, strstr(name, "stl") != NULL);
    double moved = -1;
    brio_write_options options = {0};
    options.float32 = float32;
    options.moved = &moved;
    EXPECT(brio_write(io_ctx, io_path(name), mesh, &options) == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    EXPECT(brio_read(io_ctx, io_path(name), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
    if (back) EXPECT(moved == greatest_distance(mesh, back), "%s: %.17g", name, moved);
    brio_mesh_free(mesh);
    brio_mesh_free(back);
    return moved;
}

static void the_distance_that_points_move_is_the_one_that_is_read(void) {
    static const char *const doubles[] = {"m.ply", "m.vtu", "m.npy", "m.xyz", "m.obj", "m.off", "m.node"};
    static const char *const singles[] = {"m.ply", "m.vtu", "m.npy"};
    static const double scales[] = {1, 1e7, 1e-300, 0x1p-160};
    static double points[3 * N];
    for (int s = 0; s < 4; s++) {
        uniform_points(5, N, points);
        for (size_t i = 0; i < 3 * N; i++) points[i] *= scales[s];
        for (int i = 0; i < 7; i++) EXPECT(check_moved(points, doubles[i], 0) == 0, "%s", doubles[i]);
        for (int i = 0; i < 3; i++) EXPECT(check_moved(points, singles[i], 1) > 0, "%s", singles[i]);
        EXPECT(check_moved(points, "m.obj", 1) == 0);
        if (s < 2) EXPECT(check_moved(points, "m.stl", 0) > 0); /* tiny corners become one vertex */
        if (s < 2) EXPECT(check_moved(points, "m.las", 0) > 0);
    }
    integer_points(5, N, 1 << 20, points);
    for (int i = 0; i < 3; i++) EXPECT(check_moved(points, singles[i], 1) == 0, "%s", singles[i]);
    for (size_t i = 0; i < 3 * N; i++) points[i] *= 1e-3;
    EXPECT(check_moved(points, "m.las", 0) == 0);
}

static void the_largest_double_that_a_single_holds(void) {
    static const double fits[3] = {0x1.fffffefffffffp127}, not [3] = {0x1.ffffffp127};
    brio_write_options options = {0};
    double moved;
    options.float32 = 1;
    options.moved = &moved;
    brio_mesh *mesh = triangles(fits, 1, false);
    EXPECT(brio_write(io_ctx, io_path("a.ply"), mesh, &options) == BRIO_OK && moved > 0 && moved < 0x1p104);
    brio_mesh_free(mesh);
    mesh = triangles(not, 1, false);
    EXPECT(brio_write(io_ctx, io_path("b.ply"), mesh, &options) == BRIO_ERR_ARGUMENT); /* it was written as infinity */
    EXPECT(io_count_files("b.ply") == 0);
    brio_mesh_free(mesh);
}

/* They were refused, at the end of the work. */
static void names_that_become_equal_get_numbers(void) {
    static const char *const given[] = {"two words", "two,words", "X", "y", "two_words_2", "x_2", "two;words"};
    static const char *const found[] = {"two_words",     "two_words_2", "X_2",        "y_2",
                                        "two_words_2_2", "x_2",         "two_words_3"};
    static const char *const files[] = {"n.ply", "n.xyz", "n.csv", "n.npy"};
    static double points[3 * N];
    brio_mesh *mesh = triangles(points, 3, false);
    char longest[64];
    for (int i = 0; i < 7; i++) {
        void *data;
        EXPECT(brio_mesh_add_property(mesh, given[i], BRIO_SCALAR_INT32, &data) == BRIO_OK);
        for (int v = 0; v < 3; v++) ((int32_t *)data)[v] = 10 * i + v;
    }
    memset(longest, 'a', 63);
    longest[63] = 0;
    longest[62] = ' ';
    EXPECT(brio_mesh_add_property(mesh, longest, BRIO_SCALAR_INT8, NULL) == BRIO_OK);
    longest[62] = ',';
    EXPECT(brio_mesh_add_property(mesh, longest, BRIO_SCALAR_INT8, NULL) == BRIO_OK);
    for (int f = 0; f < 4; f++) {
        brio_mesh *back = NULL;
        EXPECT(brio_write(io_ctx, io_path(files[f]), mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path(files[f]), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(back && back->num_properties == 9, "%s", files[f]);
        for (int i = 0; back && i < 7; i++) {
            const brio_property *p = brio_mesh_property(back, found[i]);
            EXPECT(p, "%s: %s", files[f], found[i]);
            for (size_t v = 0; p && v < 3; v++) EXPECT(brio_property_value(p, v) == (double)(10 * i + (int)v));
        }
        brio_mesh_free(back);
    }
    brio_mesh_free(mesh);
}

SUITE(test_io_loss) {
    io_begin();
    RUN(the_distance_that_points_move_is_the_one_that_is_read);
    RUN(the_largest_double_that_a_single_holds);
    RUN(names_that_become_equal_get_numbers);
    return io_end();
}
