/* Pages: what is refused, what is not taken for HTML, memory that runs out, work that is stopped. What a page holds is read
 * back in tests/cli/test_view.py, and seen in tests/browser. */
#include "failing_allocator.h"
#include "io_files.h"
#include <math.h>

static brio_status write_one(brio_context *ctx, const brio_mesh *m, const char *name, const brio_page_options *o,
                             brio_page_stats *stats) {
    const brio_page_layer layer = {.mesh = m, .name = name, .report = "line <b>\n"};
    const brio_page_layer *layers[] = {&layer};
    return brio_write_page(ctx, io_path("page.html"), layers, 1, o, stats);
}

static void expect_refused(const brio_mesh *m, brio_status status, const char *words) {
    brio_status found = write_one(io_ctx, m, "m", NULL, NULL);
    EXPECT(found == status, "%s: %s", words, brio_status_string(found));
    EXPECT(strstr(brio_message(io_ctx), words), "%s", brio_message(io_ctx));
    EXPECT(access(io_path("page.html"), F_OK) != 0, "%s: a page was left", words);
}

static void wrong_meshes_are_refused_and_leave_no_page(void) {
    const brio_page_layer empty = {.mesh = NULL};
    const brio_page_layer *layers[] = {&empty};
    EXPECT(brio_write_page(io_ctx, io_path("page.html"), NULL, 0, NULL, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_write_page(io_ctx, io_path("page.html"), layers, 1, NULL, NULL) == BRIO_ERR_ARGUMENT);
    brio_mesh *m = io_make(9, IO_FACES | IO_TETRAHEDRA);
    m->vertices[7] = NAN;
    expect_refused(m, BRIO_ERR_NOT_FINITE, "vertex 2");
    m->vertices[7] = 1;
    uint32_t kept = m->tetrahedra[1];
    m->tetrahedra[1] = 9;
    expect_refused(m, BRIO_ERR_ARGUMENT, "the vertex 9");
    m->tetrahedra[1] = kept;
    m->face_vertices[2] = 12;
    expect_refused(m, BRIO_ERR_ARGUMENT, "12");
    brio_mesh_free(m);
}

/* Returns how often a text is in the page. */
static size_t times(const char *text) {
    size_t size, count = 0;
    char *page = io_get("page.html", &size);
    for (const char *at = page; (at = strstr(at, text)); at++) count++;
    free(page);
    return count;
}

static void texts_are_not_taken_for_html(void) {
    brio_mesh *m = io_make(5, IO_FACES);
    size_t before;
    EXPECT(write_one(io_ctx, m, "plain", NULL, NULL) == BRIO_OK);
    before = times("</script");
    EXPECT(brio_mesh_add_property(m, "</script><i>&\"\\\x01", BRIO_SCALAR_UINT8, NULL) == BRIO_OK);
    EXPECT(write_one(io_ctx, m, "</script><img src=x>\xff\xe2\x80\xa8", NULL, NULL) == BRIO_OK);
    EXPECT(times("</script") == before + 1, "%zu after %zu", times("</script"), before); /* the property's block */
    EXPECT(times("<img") == 0 && times("<i>") == 0 && times("line <b>") == 0);
    EXPECT(times("\\u003c/script\\u003e\\u003cimg src=x\\u003e\\u00ff\\u2028") == 1);
    EXPECT(times("\\u003ci\\u003e\\u0026\\u0022\\u005c\\u0001") == 1);
    brio_mesh_free(m);
}

static void large_layers_are_rounded_unless_exact_is_asked_for(void) {
    brio_mesh *m = io_make(250001, 0);
    brio_page_stats stats = {.size = sizeof stats}, exact = {.size = sizeof exact};
    brio_page_options o = {.size = sizeof o, .exact = 1, .most_points = 1000};
    EXPECT(write_one(io_ctx, m, "m", NULL, &stats) == BRIO_OK);
    EXPECT(!stats.exact && stats.points_thinned == 0 && times("exact-x") == 0);
    EXPECT(write_one(io_ctx, m, "m", &o, &exact) == BRIO_OK);
    EXPECT(exact.exact && exact.points_thinned == 249001 && times("data-name=\"exact-x\"") == 1);
    brio_mesh_free(m);
}

static void normals_that_are_left_out_are_told(void) {
    brio_mesh *m = io_make(250001, IO_FACES), *small = io_make(9, IO_FACES);
    EXPECT(write_one(io_ctx, m, "m", NULL, NULL) == BRIO_OK && times("\"normals_left_out\":0") == 1);
    EXPECT(brio_mesh_add_property(m, "nx", BRIO_SCALAR_FLOAT32, NULL) == BRIO_OK);
    EXPECT(write_one(io_ctx, m, "m", NULL, NULL) == BRIO_OK && times("\"normals_left_out\":1") == 1);
    EXPECT(brio_mesh_add_property(small, "nx", BRIO_SCALAR_FLOAT32, NULL) == BRIO_OK);
    EXPECT(write_one(io_ctx, small, "m", NULL, NULL) == BRIO_OK && times("\"normals_left_out\":0") == 1);
    brio_mesh_free(m);
    brio_mesh_free(small);
}

static brio_status make_page(brio_context *ctx) {
    const double vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    const uint64_t offsets[] = {0, 3, 7};
    const uint32_t corners[] = {0, 1, 2, 0, 1, 3, 4}, tetrahedra[] = {0, 1, 2, 3}, edges[] = {0, 4};
    brio_page_options o = {.size = sizeof o, .self_intersections = 1};
    brio_mesh *m = NULL;
    brio_status status = brio_mesh_new(ctx, &m);
    if (!status) status = brio_mesh_set_vertices(m, vertices, 5);
    if (!status) status = brio_mesh_set_faces(m, offsets, corners, 2);
    if (!status) status = brio_mesh_set_tetrahedra(m, tetrahedra, 4, 1);
    if (!status) status = brio_mesh_set_edges(m, edges, 1);
    if (!status) status = brio_mesh_add_property(m, "q", BRIO_SCALAR_FLOAT64, NULL);
    if (!status) status = write_one(ctx, m, "m", &o, NULL);
    brio_mesh_free(m);
    return status;
}

static void out_of_memory_leaves_nothing_behind(void) {
    expect_clean_failures(make_page);
}

static int stop(const char *stage, double fraction, void *user) {
    (void)stage, (void)fraction;
    return ++*(int *)user > 3;
}

static void a_page_can_be_stopped(void) {
    brio_mesh *m = io_make(200000, 0);
    int asked = 0;
    unlink(io_path("page.html"));
    brio_context_set_progress(io_ctx, stop, &asked);
    EXPECT(write_one(io_ctx, m, "m", NULL, NULL) == BRIO_ERR_CANCELLED);
    brio_context_set_progress(io_ctx, NULL, NULL);
    EXPECT(access(io_path("page.html"), F_OK) != 0);
    brio_mesh_free(m);
}

SUITE(test_page) {
    io_begin();
    RUN(wrong_meshes_are_refused_and_leave_no_page);
    RUN(texts_are_not_taken_for_html);
    RUN(large_layers_are_rounded_unless_exact_is_asked_for);
    RUN(normals_that_are_left_out_are_told);
    RUN(out_of_memory_leaves_nothing_behind);
    RUN(a_page_can_be_stopped);
    return io_end();
}
