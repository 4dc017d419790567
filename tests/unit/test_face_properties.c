/* Properties of faces: in files of every format that holds them, and through what changes a mesh. */
#include "brio/testdata.h"
#include "io_files.h"

static void fill(const brio_property *p, size_t count) {
    uint64_t state = 7 + (uint64_t)p->type;
    size_t size = brio_scalar_size(p->type);
    for (size_t i = 0; i < count * size; i++) ((uint8_t *)p->data)[i] = (uint8_t)(io_random(&state) >> 7);
    for (size_t i = 0; i < count; i++) {
        if (p->type == BRIO_SCALAR_FLOAT32 && !isfinite(((float *)p->data)[i])) ((float *)p->data)[i] = -0.1f;
        if (p->type == BRIO_SCALAR_FLOAT64 && !isfinite(((double *)p->data)[i])) ((double *)p->data)[i] = -0.25;
    }
}

/* Adds a property of faces of every type. */
static void add_all(brio_mesh *m) {
    for (brio_scalar type = BRIO_SCALAR_INT8; type < BRIO_SCALAR_END; type++) {
        char name[16];
        snprintf(name, sizeof name, "q%d", (int)type);
        EXPECT(brio_mesh_add_face_property(m, name, type, NULL) == BRIO_OK);
        fill(brio_mesh_face_property(m, name), m->num_faces);
    }
}

static void expect_same(const brio_mesh *a, const brio_mesh *b, const char *what) {
    EXPECT(a->num_face_properties == b->num_face_properties, "%s: %zu properties of faces of %zu", what,
           b->num_face_properties, a->num_face_properties);
    EXPECT(io_same_faces(a, b), "%s", what);
    for (size_t i = 0; i < a->num_face_properties; i++) {
        const brio_property *p = &a->face_properties[i], *q = brio_mesh_face_property(b, p->name);
        EXPECT(q && q->type == p->type, "%s: %s", what, p->name);
        EXPECT(q && io_same_bytes(p->data, q->data, a->num_faces * brio_scalar_size(p->type)), "%s: %s", what, p->name);
    }
}

static void files_give_back_every_type(void) {
    static const char *const names[] = {"a.ply", "a.vtu", "a.vtp", "a.vtk"};
    for (int e = 0; e < 4; e++)
        for (int how = 0; how < 4; how++) { /* binary, text, compressed, with other cells */
            int parts = IO_FACES | IO_PROPERTIES | (how == 3 && e != 2 ? IO_TETRAHEDRA : 0);
            bool packed = how == 2 && (e == 1 || e == 2);
            brio_mesh *m = io_make(10, parts), *back = NULL;
            const uint32_t edges[] = {0, 1, 1, 2};
            brio_write_options o = {0};
            o.ascii = how == 1;
            o.compress = packed;
            add_all(m);
            if (how == 3) EXPECT(brio_mesh_set_edges(m, edges, 2) == BRIO_OK);
            EXPECT(brio_write(io_ctx, io_path(names[e]), m, &o) == BRIO_OK || packed, "%s", brio_message(io_ctx));
            EXPECT(brio_read(io_ctx, io_path(names[e]), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
            if (back) expect_same(m, back, names[e]);
            EXPECT(back && back->num_properties == m->num_properties && back->num_edges == m->num_edges);
            brio_mesh_free(back);
            brio_mesh_free(m);
        }
}

/* Faces have colours of bytes: one array in VTK's files; numbers from 0 to 1 become bytes. */
static void colours_of_faces_become_bytes(void) {
    static const char *const names[] = {"c.ply", "c.vtu", "c.vtp", "c.vtk", "c.off"};
    static const char *const channels[] = {"red", "green", "blue"};
    for (int e = 0; e < 5; e++) {
        brio_mesh *m = io_make(10, IO_FACES), *back = NULL;
        for (int k = 0; k < 3; k++) {
            void *data;
            EXPECT(brio_mesh_add_face_property(m, channels[k], BRIO_SCALAR_FLOAT32, &data) == BRIO_OK);
            for (size_t f = 0; f < m->num_faces; f++) ((float *)data)[f] = (float)(51 * (size_t)k + f) / 255;
        }
        EXPECT(brio_write(io_ctx, io_path(names[e]), m, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path(names[e]), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
        for (int k = 0; k < 3 && back; k++) {
            const brio_property *p = brio_mesh_face_property(back, channels[k]);
            EXPECT(p && (e == 4 || p->type == BRIO_SCALAR_UINT8), "%s", names[e]);
            for (size_t f = 0; p && f < back->num_faces; f++)
                EXPECT(brio_property_value(p, f) == (double)(51 * (size_t)k + f), "%s face %zu", names[e], f);
        }
        brio_mesh_free(back);
        brio_mesh_free(m);
    }
}

/* Cell data of VTK's files in their order of rows: points, lines, polygons, strips. Each triangle of a strip has its value. */
static void rows_of_cell_data_go_by_kind(void) {
    brio_mesh *m = io_read_text("kinds.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
                                             "0 0 0 1 0 0 0 1 0 1 1 0\nVERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\n"
                                             "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\nPOLYGONS 1 4\n3 0 1 2\nCELL_DATA 4\n"
                                             "SCALARS heat int\nLOOKUP_TABLE default\n5 6 7 8\n");
    const brio_property *heat = m ? brio_mesh_face_property(m, "heat") : NULL;
    EXPECT(heat && m->num_faces == 3);
    for (size_t f = 0; heat && f < 3; f++) {
        bool of_strip = !(m->face_vertices[3 * f] == 0 && m->face_vertices[3 * f + 1] == 1 &&
                          m->face_vertices[3 * f + 2] == 2 && brio_property_value(heat, f) == 7);
        EXPECT(brio_property_value(heat, f) == (of_strip ? 8 : 7), "face %zu", f);
    }
    brio_mesh_free(m);
}

/* Numbers may stand before the corners and behind them; a name that is taken gets a number. */
static void numbers_of_faces_in_ply(void) {
    brio_mesh *m = io_read_text(
        "n.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 2\nproperty short flags\nproperty list uchar int vertex_indices\nproperty double flags\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n-3 3 0 1 2 0.5\n4 3 2 1 0 1.5\n");
    const brio_property *first = m ? brio_mesh_face_property(m, "flags") : NULL;
    const brio_property *second = m ? brio_mesh_face_property(m, "flags_2") : NULL;
    EXPECT(first && first->type == BRIO_SCALAR_INT16 && brio_property_value(first, 0) == -3);
    EXPECT(second && second->type == BRIO_SCALAR_FLOAT64 && brio_property_value(second, 1) == 1.5);
    brio_mesh_free(m);
    io_expect_error("w.ply",
                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                    "property uchar flags\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 256\n",
                    BRIO_ERR_FORMAT, "face 0 (counted from 0): flags is 256");
}

/* OFF: faces with a colour and without one. */
static void faces_without_colour_have_nan(void) {
    brio_mesh *m = io_read_text("f.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0 255 0 7\n3 0 1 2 4\n");
    const brio_property *blue = m ? brio_mesh_face_property(m, "blue") : NULL;
    EXPECT(blue && m->num_face_properties == 3 && isnan(brio_property_value(blue, 0)));
    EXPECT(blue && brio_property_value(blue, 1) == 7 && isnan(brio_property_value(blue, 2)));
    brio_mesh_free(m);
}

/* --- what changes a mesh --- */

/* Two tetrahedra's surfaces apart, corner 8 at the place of corner 0, and a property that tells a face by its corners. */
static brio_mesh *two_solids(void) {
    static const double at[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 0, 0, 7, 0, 0, 5, 2, 0, 5, 0, 2, 0, 0, 0};
    static const uint32_t corners[] = {0, 2, 1, 8, 8, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2, 4, 6, 5, 4, 5, 7, 5, 6, 7, 4, 7, 6};
    uint64_t offsets[10];
    brio_mesh *m = NULL;
    void *data;
    for (size_t f = 0; f < 10; f++) offsets[f] = 3 * f;
    EXPECT(brio_mesh_new(io_ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, at, 9) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(m, offsets, corners, 9) == BRIO_OK);
    EXPECT(brio_mesh_add_face_property(m, "key", BRIO_SCALAR_FLOAT64, &data) == BRIO_OK);
    for (size_t f = 0; f < 9; f++)
        for (size_t k = 0; k < 3; k++) {
            const double *p = at + 3 * (size_t)corners[3 * f + k];
            ((double *)data)[f] += p[0] + 100 * p[1] + 10000 * p[2];
        }
    return m;
}

static void expect_keys(const brio_mesh *m, size_t faces, const char *what) {
    const brio_property *key = brio_mesh_face_property(m, "key");
    EXPECT(key && m->num_faces == faces, "%s: %zu faces", what, m->num_faces);
    for (size_t f = 0; key && f < m->num_faces; f++) {
        double sum = 0;
        for (uint64_t h = m->face_offsets[f]; h < m->face_offsets[f + 1]; h++) {
            const double *p = m->vertices + 3 * (size_t)m->face_vertices[h];
            sum += p[0] + 100 * p[1] + 10000 * p[2];
        }
        EXPECT(brio_property_value(key, f) == sum, "%s: face %zu", what, f);
    }
}

static void faces_that_stay_keep_their_properties(void) {
    brio_mesh *m = two_solids();
    EXPECT(brio_mesh_merge_vertices(m, 0, NULL) == BRIO_OK);
    expect_keys(m, 8, "merge");
    EXPECT(brio_mesh_keep_components(m, 1, 0, NULL, NULL) == BRIO_OK);
    expect_keys(m, 4, "components");
    brio_mesh_free(m);
    m = two_solids();
    brio_convert_options o = {0};
    EXPECT(brio_write(io_ctx, io_path("s.ply"), m, NULL) == BRIO_OK);
    const double box[] = {4, -1, -1, 8, 8, 8};
    memcpy(o.box, box, sizeof box);
    o.crop = 1;
    brio_mesh_free(m);
    m = NULL;
    EXPECT(brio_convert(io_ctx, io_path("s.ply"), io_path("t.vtp"), &o, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(brio_read(io_ctx, io_path("t.vtp"), NULL, &m) == BRIO_OK);
    if (m) expect_keys(m, 4, "crop");
    brio_mesh_free(m);
}

/* Each of the four parts of a triangle has its properties. */
static void parts_have_the_properties_of_the_whole(void) {
    brio_mesh *m = two_solids(), *fine = NULL;
    EXPECT(brio_mesh_merge_vertices(m, 0, NULL) == BRIO_OK);
    EXPECT(brio_mesh_subdivide(io_ctx, m, 2, &fine) == BRIO_OK && fine->num_faces == 16 * m->num_faces);
    const brio_property *key = fine ? brio_mesh_face_property(fine, "key") : NULL;
    for (size_t f = 0; key && f < fine->num_faces; f++)
        EXPECT(brio_property_value(key, f) == brio_property_value(brio_mesh_face_property(m, "key"), f / 16));
    EXPECT(key != NULL);
    brio_mesh_free(fine);
    brio_mesh_free(m);
}

/* A simplified triangle is one that was there: it has one corner or more of its own, and its own number. */
static void triangles_that_stay_have_their_numbers(void) {
    brio_mesh *m = NULL;
    void *data;
    brio_mesh_simplify_options o = {0};
    EXPECT(brio_generate_truth(io_ctx, 24, &m) == BRIO_OK);
    size_t faces = m->num_faces;
    EXPECT(brio_mesh_add_face_property(m, "number", BRIO_SCALAR_UINT32, &data) == BRIO_OK);
    for (uint32_t f = 0; f < faces; f++) ((uint32_t *)data)[f] = f;
    o.target_faces = faces / 3;
    EXPECT(brio_mesh_simplify(io_ctx, m, &o) == BRIO_OK && m->num_faces <= faces / 3 + 2);
    const brio_property *number = brio_mesh_face_property(m, "number");
    for (size_t f = 1; f < m->num_faces; f++)
        EXPECT(brio_property_value(number, f - 1) < brio_property_value(number, f), "face %zu", f);
    EXPECT(brio_property_value(number, m->num_faces - 1) < (double)faces);
    brio_mesh_free(m);
}

static void wrong_calls_are_refused(void) {
    brio_mesh *m = NULL;
    const uint64_t offsets[] = {0, 3};
    const uint32_t corners[] = {0, 0, 0};
    void *data;
    EXPECT(brio_mesh_new(io_ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, NULL, 1) == BRIO_OK);
    EXPECT(brio_mesh_add_face_property(m, "a", BRIO_SCALAR_UINT8, &data) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(m, offsets, corners, 1) == BRIO_ERR_ARGUMENT && !m->num_faces);
    EXPECT(brio_mesh_add_face_property(m, "a", BRIO_SCALAR_UINT8, &data) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_add_face_property(m, "", BRIO_SCALAR_UINT8, &data) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_add_face_property(m, "b", BRIO_SCALAR_END, &data) == BRIO_ERR_ARGUMENT);
    brio_mesh_remove_face_property(m, "none");
    brio_mesh_remove_face_property(m, "a");
    EXPECT(!m->num_face_properties && !brio_mesh_face_property(m, "a"));
    EXPECT(brio_mesh_add_property(m, "a", BRIO_SCALAR_UINT8, &data) == BRIO_OK && !brio_mesh_face_property(m, "a"));
    brio_mesh_free(m);
}

SUITE(test_face_properties) {
    io_begin();
    RUN(files_give_back_every_type);
    RUN(colours_of_faces_become_bytes);
    RUN(rows_of_cell_data_go_by_kind);
    RUN(numbers_of_faces_in_ply);
    RUN(faces_without_colour_have_nan);
    RUN(faces_that_stay_keep_their_properties);
    RUN(parts_have_the_properties_of_the_whole);
    RUN(triangles_that_stay_have_their_numbers);
    RUN(wrong_calls_are_refused);
    return io_end();
}
