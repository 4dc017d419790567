/* TetGen's files of neighbours, faces and edges, against brute force over all pairs of tetrahedra; all files of a set or
 * none; what has no such files is refused. */
#include "brio/testdata.h"
#include "failing_allocator.h"
#include "io_files.h"
#include "base/memory.h"
#include "mesh/tetrahedra_adjacency.h"

enum { MOST = 4000 };

typedef struct {
    long long rows, columns;
    double *numbers; /* the rows, without their first numbers, which count from 0 */
} table;

/* Reads a file of TetGen: the header's two numbers, then rows of `width` numbers behind the row's. */
static table read_table(const char *name, int width) {
    size_t size;
    table t = {-1, -1, calloc((size_t)MOST * 4, sizeof *t.numbers)};
    char *text = io_get(name, &size), *at = text;
    while (*at == '#') at = strchr(at, '\n') + 1;
    t.rows = strtoll(at, &at, 10);
    t.columns = strtoll(at, &at, 10);
    EXPECT(t.rows >= 0 && t.rows <= MOST, "%s: %lld rows", name, t.rows);
    for (long long i = 0; i < t.rows && i < MOST; i++) {
        EXPECT(strtoll(at, &at, 10) == i, "%s: row %lld", name, i);
        for (int k = 0; k < width; k++) t.numbers[i * width + k] = strtod(at, &at);
    }
    at += strspn(at, "\n ");
    EXPECT(!*at, "%s: more than %lld rows: %.20s", name, t.rows, at);
    free(text);
    return t;
}

static brio_mesh *triangulated(brio_kind kind, size_t n) {
    brio_mesh *m = NULL;
    brio_triangulation *t = NULL;
    EXPECT(brio_generate(io_ctx, kind, n, NULL, &m) == BRIO_OK);
    EXPECT(brio_delaunay(io_ctx, m->vertices, NULL, m->num_vertices, NULL, &t) == BRIO_OK);
    EXPECT(brio_mesh_set_tetrahedra(m, (const uint32_t *)brio_triangulation_tetrahedra(t), 8,
                                    brio_triangulation_stats(t)->tetrahedra) == BRIO_OK);
    brio_triangulation_free(t);
    return m;
}

static bool has(const uint32_t *tetrahedron, double vertex) {
    for (int i = 0; i < 4; i++)
        if (tetrahedron[i] == vertex) return true;
    return false;
}

/* The other tetrahedron with the three vertices, or -1. */
static long long other_with(const brio_mesh *m, size_t own, const double v[3]) {
    for (size_t t = 0; t < m->num_tetrahedra; t++)
        if (t != own && has(m->tetrahedra + 4 * t, v[0]) && has(m->tetrahedra + 4 * t, v[1]) &&
            has(m->tetrahedra + 4 * t, v[2]))
            return (long long)t;
    return -1;
}

static void expect_neighbours(const brio_mesh *m, long long *hull) {
    table t = read_table("a.neigh", 4);
    EXPECT(t.rows == (long long)m->num_tetrahedra && t.columns == 4, "%lld %lld", t.rows, t.columns);
    *hull = 0;
    for (size_t i = 0; i < 4 * m->num_tetrahedra; i++) {
        double v[3];
        for (size_t k = 0, n = 0; k < 4; k++)
            if (k != i % 4) v[n++] = m->tetrahedra[i / 4 * 4 + k];
        long long other = other_with(m, i / 4, v);
        *hull += other < 0;
        EXPECT(t.numbers[i] == (double)other, "tetrahedron %zu, corner %zu: %g, not %lld", i / 4, i % 4, t.numbers[i],
               other);
    }
    free(t.numbers);
}

/* The determinant of the tetrahedron of a facet and the vertex d: negative where d is inside, the facet's vertices
 * running counterclockwise as seen from outside. */
static double side(const brio_mesh *m, const double v[3], uint32_t d) {
    const double *p[4] = {m->vertices + 3 * (size_t)v[0], m->vertices + 3 * (size_t)v[1],
                          m->vertices + 3 * (size_t)v[2], m->vertices + 3 * (size_t)d};
    double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) e[i][k] = p[i + 1][k] - p[0][k];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static void expect_faces(const brio_mesh *m, long long hull) {
    table t = read_table("a.face", 4);
    long long marked = 0;
    size_t before = 0;
    EXPECT(t.rows == (4 * (long long)m->num_tetrahedra + hull) / 2 && t.columns == 1, "%lld rows", t.rows);
    for (long long i = 0; i < t.rows; i++) {
        const double *v = t.numbers + 4 * i;
        long long first = other_with(m, SIZE_MAX, v), second = other_with(m, (size_t)first, v);
        EXPECT(first >= 0 && (size_t)first >= before, "face %lld is of tetrahedron %lld", i, first);
        EXPECT(v[3] == (second < 0), "face %lld has the marker %g", i, v[3]);
        before = (size_t)first;
        marked += second < 0;
        const uint32_t *own = m->tetrahedra + 4 * (size_t)first;
        for (int k = 0; k < 4; k++)
            EXPECT(own[k] == v[0] || own[k] == v[1] || own[k] == v[2] || side(m, v, own[k]) < 0, "face %lld", i);
    }
    EXPECT(marked == hull, "%lld marked, %lld on the hull", marked, hull);
    free(t.numbers);
}

static void expect_edges(const brio_mesh *m) {
    size_t n = m->num_vertices, expected = 0;
    uint8_t *kinds = calloc(n * n, 1); /* 1: an edge, 2: on the hull */
    table neighbours = read_table("a.neigh", 4), t = read_table("a.edge", 3);
    for (size_t i = 0; i < m->num_tetrahedra; i++)
        for (size_t j = 0; j < 4; j++)
            for (size_t k = 0; k < 4; k++) {
                uint32_t a = m->tetrahedra[4 * i + j], b = m->tetrahedra[4 * i + k];
                bool hull = false;
                for (size_t f = 0; f < 4; f++) hull |= f != j && f != k && neighbours.numbers[4 * i + f] < 0;
                if (a < b) kinds[a * n + b] |= hull ? 3 : 1;
            }
    for (size_t i = 0; i < n * n; i++) {
        if (!kinds[i]) continue;
        const double *row = t.numbers + 3 * expected++;
        EXPECT(row[0] == (double)(i / n) && row[1] == (double)(i % n) && row[2] == (kinds[i] >> 1), "edge %zu",
               expected);
    }
    EXPECT(t.rows == (long long)expected && t.columns == 1, "%lld rows, not %zu", t.rows, expected);
    free(kinds);
    free(neighbours.numbers);
    free(t.numbers);
}

static brio_write_options all_files(void) {
    brio_write_options o = {0};
    o.neighbours = o.faces = o.edges = 1;
    return o;
}

static void against_brute_force(void) {
    const struct {
        brio_kind kind;
        size_t n;
    } cases[] = {{BRIO_KIND_CUBE, 4},    {BRIO_KIND_CUBE, 5},  {BRIO_KIND_CUBE, 60},
                 {BRIO_KIND_SPHERE, 90}, {BRIO_KIND_GRID, 64}, {BRIO_KIND_MOMENT, 30}};
    brio_write_options o = all_files();
    o.comment = "a comment";
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        long long hull;
        brio_mesh *m = triangulated(cases[i].kind, cases[i].n), *again = NULL;
        EXPECT(brio_write(io_ctx, io_path("a.node"), m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path("a.node"), NULL, &again) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(io_same_points(m, again) && io_same_tetrahedra(m, again));
        expect_neighbours(m, &hull);
        expect_faces(m, hull);
        expect_edges(m);
        brio_mesh_free(m);
        brio_mesh_free(again);
    }
    io_empty_folder();
}

/* A vertex in thousands of tetrahedra, around one edge. */
static void a_long_edge(void) {
    enum { RING = 900 };
    brio_mesh *m = NULL;
    uint32_t tetrahedra[4 * RING], *neighbours = NULL;
    brio_tetrahedra_edges edges = {.ends = NULL};
    EXPECT(brio_mesh_new(io_ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, NULL, RING + 2) == BRIO_OK);
    for (uint32_t i = 0; i < RING; i++) {
        const uint32_t corners[] = {0, 1, 2 + i, 2 + (i + 1) % RING};
        memcpy(tetrahedra + 4 * i, corners, sizeof corners);
    }
    EXPECT(brio_mesh_set_tetrahedra(m, tetrahedra, 4, RING) == BRIO_OK);
    EXPECT(brio_tetrahedra_neighbours(io_ctx, m, &neighbours) == BRIO_OK, "%s", brio_message(io_ctx));
    for (uint32_t i = 0; neighbours && i < RING; i++) {
        EXPECT(neighbours[4 * i] == BRIO_INFINITE && neighbours[4 * i + 1] == BRIO_INFINITE, "%u", i);
        EXPECT(neighbours[4 * i + 2] == (i + 1) % RING && neighbours[4 * i + 3] == (i + RING - 1) % RING, "%u", i);
    }
    EXPECT(brio_tetrahedra_edges_find(io_ctx, m, neighbours, &edges) == BRIO_OK);
    EXPECT(edges.count == 1 + 3 * RING && !edges.hull[0] && edges.hull[1], "%zu edges", edges.count);
    brio_tetrahedra_edges_free(io_ctx, &edges);
    brio_release(io_ctx, neighbours);
    brio_write_options o = all_files();
    EXPECT(brio_write(io_ctx, io_path("ring.ele"), m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(io_count_files("ring.") == 5);
    brio_mesh_free(m);
    io_empty_folder();
}

static void without_tetrahedra(void) {
    brio_mesh *m = io_make(5, 0);
    brio_write_options o = all_files();
    EXPECT(brio_write(io_ctx, io_path("a.node"), m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
    table neighbours = read_table("a.neigh", 4), faces = read_table("a.face", 4), edges = read_table("a.edge", 3);
    EXPECT(!neighbours.rows && !faces.rows && !edges.rows && io_count_files("a.") == 4);
    free(neighbours.numbers);
    free(faces.numbers);
    free(edges.numbers);
    brio_mesh_free(m);
    io_empty_folder();
}

static void only_what_is_asked_for(void) {
    brio_mesh *m = io_make(7, IO_TETRAHEDRA);
    brio_write_options o = {0};
    o.faces = 1;
    EXPECT(brio_write(io_ctx, io_path("a.node"), m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(io_count_files("") == 3 && io_count_files(".face") == 1);
    io_put("a.face", "mine", 4);
    EXPECT(brio_write(io_ctx, io_path("a.node"), m, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    size_t size;
    char *old = io_get("a.face", &size);
    EXPECT(!strcmp(old, "mine"), "a file that was not asked for was written");
    free(old);
    io_empty_folder();
    EXPECT(brio_write(io_ctx, io_path("a.ply"), m, &o) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), "beside .node only"), "%s", brio_message(io_ctx));
    o.format = BRIO_FORMAT_NODE;
    EXPECT(brio_write(io_ctx, "-", m, &o) == BRIO_ERR_ARGUMENT);
    EXPECT(io_count_files("") == 0);
    brio_mesh_free(m);
}

static void three_at_a_facet(void) {
    brio_mesh *m = io_make(6, 0);
    const uint32_t tetrahedra[] = {0, 1, 2, 3, 4, 2, 1, 0, 1, 0, 5, 2};
    brio_write_options o = all_files();
    EXPECT(brio_mesh_set_tetrahedra(m, tetrahedra, 4, 3) == BRIO_OK);
    EXPECT(brio_write(io_ctx, io_path("a.node"), m, &o) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), "is a facet of three tetrahedra or more"), "%s", brio_message(io_ctx));
    EXPECT(io_count_files("") == 0, "files are left");
    brio_mesh_free(m);
}

/* One file of the set cannot be written: none is. */
static void all_or_none(void) {
    brio_mesh *m = io_make(7, 0);
    const uint32_t tetrahedra[] = {0, 1, 2, 3, 3, 2, 1, 4};
    brio_write_options o = all_files();
    EXPECT(brio_mesh_set_tetrahedra(m, tetrahedra, 4, 2) == BRIO_OK);
    EXPECT(mkdir(io_path("a.edge"), 0700) == 0);
    EXPECT(brio_write(io_ctx, io_path("a.node"), m, &o) == BRIO_ERR_WRITE);
    EXPECT(io_count_files("") == 1, "files are left");
    EXPECT(rmdir(io_path("a.edge")) == 0);
    brio_mesh_free(m);
}

static const brio_mesh *to_write;

static brio_status write_all_files(brio_context *ctx) {
    brio_write_options o = all_files();
    brio_status status = brio_write(ctx, io_path("f.node"), to_write, &o);
    EXPECT(status == BRIO_OK || io_count_files("") == 0, "a file is left");
    return status;
}

static void each_allocation_fails(void) {
    brio_mesh *m = triangulated(BRIO_KIND_CUBE, 30);
    to_write = m;
    expect_clean_failures(write_all_files);
    EXPECT(io_count_files("") == 5);
    brio_mesh_free(m);
}

SUITE(test_io_node_files) {
    io_begin();
    RUN(against_brute_force);
    RUN(a_long_edge);
    RUN(without_tetrahedra);
    RUN(only_what_is_asked_for);
    RUN(three_at_a_facet);
    RUN(all_or_none);
    RUN(each_allocation_fails);
    return io_end();
}
