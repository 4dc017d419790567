/* Pictures: what is refused, memory that runs out, work that is stopped, threads. What a picture shows is in
 * tests/cli/test_picture.py. */
#include "failing_allocator.h"
#include "io_files.h"
#include <math.h>

static brio_status write_one(brio_context *ctx, const brio_mesh *m, const brio_picture_options *o) {
    const brio_page_layer layer = {.mesh = m};
    const brio_page_layer *layers[] = {&layer};
    return brio_write_picture(ctx, io_path("picture.png"), layers, 1, o, NULL);
}

static void expect_refused(const brio_mesh *m, const brio_picture_options *o, brio_status status, const char *words) {
    brio_status found = write_one(io_ctx, m, o);
    EXPECT(found == status, "%s: %s", words, brio_status_string(found));
    EXPECT(strstr(brio_message(io_ctx), words), "%s", brio_message(io_ctx));
    EXPECT(access(io_path("picture.png"), F_OK) != 0, "%s: a picture was left", words);
}

static void wrong_meshes_and_options_leave_no_picture(void) {
    const brio_page_layer empty = {.mesh = NULL};
    const brio_page_layer *layers[13] = {&empty};
    brio_picture_options o = {.size = sizeof o};
    EXPECT(brio_write_picture(io_ctx, io_path("picture.png"), NULL, 0, NULL, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_write_picture(io_ctx, io_path("picture.png"), layers, 1, NULL, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_write_picture(io_ctx, io_path("picture.png"), layers, 13, NULL, NULL) == BRIO_ERR_ARGUMENT);
    brio_mesh *m = io_make(9, IO_FACES | IO_TETRAHEDRA);
    o.width = -1;
    expect_refused(m, &o, BRIO_ERR_ARGUMENT, "1 to 16384 pixels");
    o.width = 0;
    o.from[1] = INFINITY;
    expect_refused(m, &o, BRIO_ERR_ARGUMENT, "not finite");
    o.from[1] = 0;
    o.colour = "nothing";
    expect_refused(m, &o, BRIO_ERR_ARGUMENT, "\"nothing\"");
    m->vertices[7] = NAN;
    expect_refused(m, NULL, BRIO_ERR_NOT_FINITE, "vertex 2");
    m->vertices[7] = 1;
    m->face_vertices[2] = 12;
    expect_refused(m, NULL, BRIO_ERR_ARGUMENT, "12");
    brio_mesh_free(m);
}

static brio_status make_picture(brio_context *ctx) {
    const double vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    const uint64_t offsets[] = {0, 3, 7};
    const uint32_t corners[] = {0, 1, 2, 0, 1, 3, 4}, tetrahedra[] = {0, 1, 2, 3}, edges[] = {0, 4};
    brio_picture_options o = {.size = sizeof o, .width = 40, .height = 30, .self_intersections = 1, .colour = "q"};
    brio_mesh *m = NULL;
    brio_status status = brio_mesh_new(ctx, &m);
    if (!status) status = brio_mesh_set_vertices(m, vertices, 5);
    if (!status) status = brio_mesh_set_tetrahedra(m, tetrahedra, 4, 1);
    if (!status) status = brio_mesh_set_edges(m, edges, 1);
    if (!status) status = brio_mesh_add_property(m, "q", BRIO_SCALAR_FLOAT64, NULL);
    if (!status) status = write_one(ctx, m, &o);
    if (!status) status = brio_mesh_set_faces(m, offsets, corners, 2);
    if (!status) status = write_one(ctx, m, &o);
    brio_mesh_free(m);
    return status;
}

static void out_of_memory_leaves_nothing_behind(void) {
    expect_clean_failures(make_picture);
}

static int stop(const char *stage, double fraction, void *user) {
    (void)stage, (void)fraction;
    return ++*(int *)user > 3;
}

static void a_picture_can_be_stopped(void) {
    brio_mesh *m = io_make(200000, 0);
    int asked = 0;
    unlink(io_path("picture.png"));
    brio_context_set_progress(io_ctx, stop, &asked);
    EXPECT(write_one(io_ctx, m, NULL) == BRIO_ERR_CANCELLED);
    brio_context_set_progress(io_ctx, NULL, NULL);
    EXPECT(access(io_path("picture.png"), F_OK) != 0);
    brio_mesh_free(m);
}

static void boxes_beyond_doubles_and_at_one_place_are_drawn(void) {
    brio_mesh *m = io_make(40, IO_FACES);
    const brio_picture_options o = {.size = sizeof o, .width = 64, .height = 48};
    for (size_t i = 0; i < 3 * m->num_vertices; i++) m->vertices[i] = i % 2 ? 1.7e308 : -1.7e308;
    EXPECT(write_one(io_ctx, m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
    for (size_t i = 0; i < 3 * m->num_vertices; i++) m->vertices[i] = 5;
    EXPECT(write_one(io_ctx, m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
    for (size_t i = 0; i < 3 * m->num_vertices; i++) m->vertices[i] = i % 3 ? 5 : 5e-324 * (double)i;
    EXPECT(write_one(io_ctx, m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
}

SUITE(test_picture) {
    io_begin();
    RUN(wrong_meshes_and_options_leave_no_picture);
    RUN(out_of_memory_leaves_nothing_behind);
    RUN(a_picture_can_be_stopped);
    RUN(boxes_beyond_doubles_and_at_one_place_are_drawn);
    return io_end();
}
