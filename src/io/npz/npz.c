/* Reads NPZ files: zip archives of NumPy's arrays, stored or compressed by deflate.
 *
 * The points are read first, as from an NPY file. Arrays with as many rows become properties; arrays of indices become
 * polygons or tetrahedra. All other arrays are left out. What belongs to a point is in several arrays, so the file is
 * one block. A pipe, and a file that is compressed as a whole, is read into memory first, since the table of a zip
 * archive is at its end.
 *
 * Based on: NumPy enhancement proposal 1: a simple file format for NumPy arrays. 2007. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/limits.h"
#include "io/npy_header.h"
#include "io/npz/zip.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* --- what each array is for --- */

/* Finds out which arrays of an NPZ file are points, properties, triangles and tetrahedra, by their names and shapes. */

typedef enum {
    BRIO_NPZ_LEFT_OUT,
    BRIO_NPZ_POINTS, /* rows of coordinates, or records */
    BRIO_NPZ_X,      /* BRIO_NPZ_X + k: coordinate k of all points */
    BRIO_NPZ_Y,
    BRIO_NPZ_Z,
    BRIO_NPZ_PROPERTY,
    BRIO_NPZ_FACES,
    BRIO_NPZ_TETRAHEDRA
} brio_npz_use;

typedef struct brio_npz_array {
    const brio_zip_entry *entry;
    char name[64]; /* without .npy; empty if it is too long for a property */
    brio_npy_array header;
    brio_npz_use use;
} brio_npz_array;

typedef struct brio_npz {
    brio_zip zip;
    brio_npz_array *arrays;
    size_t num_arrays;
    uint64_t rows; /* of the points */
} brio_npz;

static const char *const point_names[] = {"points", "vertices",    "verts",  "xyz",   "positions", "position",
                                          "pos",    "coordinates", "coords", "nodes", NULL};

/* --- the arrays --- */

static brio_status read_header(brio_npz *n, const brio_zip_entry *e) {
    brio_status status = BRIO_OK;
    brio_zip_part part = {.name = NULL};
    brio_npz_array *a = &n->arrays[n->num_arrays];
    size_t length = strlen(e->name);
    if (length < 4 || strcmp(e->name + length - 4, ".npy") != 0) return BRIO_OK;
    *a = (brio_npz_array){.entry = e};
    if (length - 4 < sizeof a->name) memcpy(a->name, e->name, length - 4);
    BRIO_TRY(brio_zip_part_open(&part, &n->zip, e));
    BRIO_TRY(brio_npy_array_read(&part.stream, &a->header));
    n->num_arrays++;
done:
    brio_zip_part_close(&part);
    return status;
}

/* Reads the headers of all arrays. Call npz_close even if this fails.   s  must outlive it.
 *  Returns as brio_zip_open. */
static brio_status npz_open(brio_npz *n, brio_stream *s) {
    *n = (brio_npz){.rows = 0};
    BRIO_FORWARD(brio_zip_open(&n->zip, s));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, n->arrays, n->zip.num_entries));
    for (size_t i = 0; i < n->zip.num_entries; i++) BRIO_FORWARD(read_header(n, &n->zip.entries[i]));
    return BRIO_OK;
}

static void npz_close(brio_npz *n) {
    if (n->zip.stream) brio_release(n->zip.stream->ctx, n->arrays);
    brio_zip_close(&n->zip);
}

/* --- the points --- */

static bool is_whole(const brio_npz_array *a) {
    return a->header.known && a->header.element.type != BRIO_SCALAR_FLOAT32 &&
           a->header.element.type != BRIO_SCALAR_FLOAT64;
}

static bool may_be_points(const brio_npz_array *a) {
    const brio_npy_array *h = &a->header;
    if (h->records) return h->dimensions == 1;
    return h->known && h->dimensions == 2 && h->shape[1] >= 3 && h->shape[1] <= BRIO_MOST_NUMBERS;
}

static bool has_name(const brio_npz_array *a, const char *const *names) {
    for (; *names; names++)
        if (!strcasecmp(a->name, *names)) return true;
    return false;
}

/* Appends the names and shapes of all arrays, as many as fit. */
static void list_arrays(const brio_npz *n, char *text, size_t size) {
    size_t used = 0;
    for (size_t i = 0; i < n->num_arrays && used < size; i++) {
        const brio_npz_array *a = &n->arrays[i];
        uint64_t rows = a->header.shape[0], columns = a->header.shape[1];
        char shape[64] = "()";
        if (a->header.dimensions == 1) snprintf(shape, sizeof shape, "(%" PRIu64 ")", rows);
        if (a->header.dimensions == 2) snprintf(shape, sizeof shape, "(%" PRIu64 ", %" PRIu64 ")", rows, columns);
        if (a->header.dimensions > 2) snprintf(shape, sizeof shape, "(%" PRIu64 ", %" PRIu64 ", ...)", rows, columns);
        used += (size_t)snprintf(text + used, size - used, "%s%s %s", i ? ", " : "", a->name[0] ? a->name : "?", shape);
    }
    if (used >= size) strcpy(text + size - 4, "...");
}

static brio_status unclear(const brio_npz *n, const char *what) {
    char list[240] = "none";
    list_arrays(n, list, sizeof list);
    return brio_fail(
        n->zip.stream->ctx, BRIO_ERR_FORMAT,
        "%s: %s: expected one array points, vertices, xyz, positions or coordinates of the shape (n, 3), or "
        "x, y and z; the arrays: %s",
        n->zip.stream->name, what, list);
}

/* Finds x, y and z: arrays of one dimension and length. Returns whether they are there. */
static bool find_coordinates(brio_npz *n) {
    brio_npz_array *found[3] = {NULL, NULL, NULL};
    for (size_t i = 0; i < n->num_arrays; i++) {
        brio_npz_array *a = &n->arrays[i];
        for (int k = 0; k < 3; k++)
            if (a->header.known && a->header.dimensions == 1 &&
                !strcasecmp(a->name, (const char *[]){"x", "y", "z"}[k]))
                found[k] = a;
    }
    for (int k = 0; k < 3; k++)
        if (!found[k] || found[k]->header.shape[0] != found[0]->header.shape[0]) return false;
    for (int k = 0; k < 3; k++) found[k]->use = (brio_npz_use)(BRIO_NPZ_X + k);
    n->rows = found[0]->header.shape[0];
    return true;
}

/* Finds the array of points: the one with a name of points; arr_0; the only one that is not whole numbers. NULL if
 * there is none or, with *several, if there are more. */
static brio_npz_array *find_points(brio_npz *n, bool *several) {
    brio_npz_array *named = NULL, *first = NULL, *only = NULL;
    size_t num_named = 0, num_only = 0;
    for (size_t i = 0; i < n->num_arrays; i++) {
        brio_npz_array *a = &n->arrays[i];
        if (!may_be_points(a)) continue;
        if (has_name(a, point_names)) named = a, num_named++;
        if (!strcmp(a->name, "arr_0")) first = a;
        if (a->header.records || (!is_whole(a) && a->header.shape[1] == 3)) only = a, num_only++;
    }
    *several = num_named > 1 || (!named && !first && num_only > 1);
    if (*several) return NULL;
    return named ? named : first ? first : only;
}

/* --- the others --- */

static brio_npz_use use_of(const brio_npz *n, const brio_npz_array *a) {
    static const char *const faces[] = {"faces", "face", "triangles", "polygons", "f", NULL};
    static const char *const tetrahedra[] = {"tetrahedra", "tetras", "tets", "tetra", NULL};
    static const char *const either[] = {"simplices", "cells", "elements", NULL};
    const brio_npy_array *h = &a->header;
    bool rows_of_indices = is_whole(a) && h->dimensions == 2 && h->shape[1] >= 3 && h->shape[1] <= BRIO_MOST_NUMBERS;
    if (rows_of_indices && has_name(a, faces)) return BRIO_NPZ_FACES;
    if (rows_of_indices && h->shape[1] == 4 && (has_name(a, tetrahedra) || has_name(a, either)))
        return BRIO_NPZ_TETRAHEDRA;
    if (rows_of_indices && h->shape[1] == 3 && has_name(a, either)) return BRIO_NPZ_FACES;
    bool fits = h->known && (h->dimensions == 1 || (h->dimensions == 2 && h->shape[1] <= BRIO_MOST_NUMBERS));
    bool coordinate = strlen(a->name) == 1 && strchr("xyzXYZ", a->name[0]);
    return fits && a->name[0] && !coordinate && h->shape[0] == n->rows ? BRIO_NPZ_PROPERTY : BRIO_NPZ_LEFT_OUT;
}

/* Sets what each array is for.
 *  Returns BRIO_OK, or BRIO_ERR_FORMAT with a list of the arrays if it is not clear which one holds the points. */
static brio_status npz_choose(brio_npz *n) {
    bool several = false;
    if (n->num_arrays == 0)
        return brio_fail(n->zip.stream->ctx, BRIO_ERR_FORMAT, "%s: a zip archive without arrays of NumPy (NPZ)",
                         n->zip.stream->name);
    brio_npz_array *points = find_points(n, &several);
    if (several) return unclear(n, "several arrays may be the points");
    if (points) {
        points->use = BRIO_NPZ_POINTS;
        n->rows = points->header.shape[0];
    } else if (!find_coordinates(n)) {
        return unclear(n, "no array is known to be the points");
    }
    for (size_t i = 0; i < n->num_arrays; i++)
        if (n->arrays[i].use == BRIO_NPZ_LEFT_OUT) n->arrays[i].use = use_of(n, &n->arrays[i]);
    return BRIO_OK;
}

/* --- the file --- */

typedef struct {
    brio_npz npz;
    brio_builder *builder;
    size_t first_property; /* of the array that is read */
    double *table;         /* of an array of indices in Fortran's order: all of it, row by row */
} npz_reader;

static bool starts(const char *bytes, size_t size) {
    return size >= 4 && (!memcmp(bytes, "PK\3\4", 4) || !memcmp(bytes, "PK\5\6", 4));
}

/* --- one array --- */

static brio_status put_index(npz_reader *r, const brio_npz_array *a, uint64_t row, uint64_t column, double value) {
    uint64_t last = a->header.shape[1] - 1;
    if (a->header.fortran) {
        r->table[row * (last + 1) + column] = value;
        return BRIO_OK;
    }
    if (a->use == BRIO_NPZ_TETRAHEDRA) {
        r->table[column] = value;
        return column == last ? brio_builder_tetrahedron(r->builder, r->table) : BRIO_OK;
    }
    BRIO_FORWARD(brio_builder_corner(r->builder, value));
    if (column == last) BRIO_FORWARD(brio_builder_face(r->builder));
    return BRIO_OK;
}

/* Stores the number in a row and column of an array where it belongs. */
static brio_status put(npz_reader *r, const brio_npz_array *a, uint64_t row, uint64_t column, double value) {
    brio_mesh *m = r->builder->mesh;
    if (a->use == BRIO_NPZ_FACES || a->use == BRIO_NPZ_TETRAHEDRA) return put_index(r, a, row, column, value);
    if (a->use == BRIO_NPZ_PROPERTY) {
        brio_property *p = &m->properties[r->first_property + column];
        brio_scalar_store((char *)p->data + row * brio_scalar_size(p->type), p->type, value);
    } else {
        m->vertices[3 * row + (uint64_t)(a->use - BRIO_NPZ_X)] = value;
    }
    return BRIO_OK;
}

/* Takes all numbers of an array, in the order of the file. */
static brio_status read_numbers(npz_reader *r, const brio_npz_array *a, brio_stream *s) {
    const brio_npy_array *h = &a->header;
    size_t size = brio_npy_size(&h->element);
    uint64_t outer = h->shape[h->fortran], inner = h->shape[!h->fortran];
    const char *bytes = NULL;
    brio_stream_element(s, h->fortran ? "column" : "row", outer);
    for (; s->row < outer; s->row++)
        for (uint64_t j = 0; j < inner; j++) {
            BRIO_FORWARD(brio_stream_take(s, size, &bytes));
            double value = brio_npy_load(&h->element, bytes);
            if (brio_npy_is_rounded(&h->element, bytes))
                BRIO_FORWARD(brio_builder_leave_out(r->builder, "integers beyond 2^53"));
            BRIO_FORWARD(h->fortran ? put(r, a, j, s->row, value) : put(r, a, s->row, j, value));
        }
    return BRIO_OK;
}

/* Adds the properties of an array: one of its name, or one for each column. */
static brio_status add_properties(npz_reader *r, const brio_npz_array *a) {
    static const char *const components[][4] = {{"nx", "ny", "nz"}, {"red", "green", "blue", "alpha"}};
    static const char *const names[][4] = {{"normals", "normal"}, {"colors", "colours", "rgb", "color"}};
    uint64_t columns = a->header.shape[1];
    int known = -1;
    for (int i = 0; i < 8; i++)
        if (columns >= 3 && columns <= 4 - (uint64_t)(i < 4) && names[i / 4][i % 4] &&
            !strcasecmp(a->name, names[i / 4][i % 4]))
            known = i / 4;
    r->first_property = r->builder->mesh->num_properties;
    for (uint64_t i = 0; i < columns; i++) {
        char name[64];
        brio_builder_component_name(r->builder, a->name, i, columns, name);
        const brio_npy_field *e = &a->header.element;
        BRIO_FORWARD(brio_builder_property(r->builder, known >= 0 ? components[known][i] : name,
                                           e->wide ? BRIO_SCALAR_FLOAT64 : e->type));
    }
    return BRIO_OK;
}

/* Makes the faces or tetrahedra of an array in Fortran's order. */
static brio_status take_table(npz_reader *r, const brio_npz_array *a) {
    uint64_t columns = a->header.shape[1];
    for (uint64_t row = 0; row < a->header.shape[0]; row++) {
        const double *indices = r->table + row * columns;
        if (a->use == BRIO_NPZ_TETRAHEDRA) {
            BRIO_FORWARD(brio_builder_tetrahedron(r->builder, indices));
            continue;
        }
        for (uint64_t i = 0; i < columns; i++) BRIO_FORWARD(brio_builder_corner(r->builder, indices[i]));
        BRIO_FORWARD(brio_builder_face(r->builder));
    }
    return BRIO_OK;
}

/* Makes room for what an array becomes, whose numbers have been held against the size of the file. */
static brio_status make_room(npz_reader *r, const brio_npz_array *a) {
    const brio_npy_array *h = &a->header;
    if (a->use == BRIO_NPZ_PROPERTY) return add_properties(r, a);
    if (a->use == BRIO_NPZ_X) {
        BRIO_FORWARD(brio_builder_expect_vertices(r->builder, h->shape[0]));
        return brio_builder_add_vertices(r->builder, (size_t)h->shape[0]);
    }
    if (a->use == BRIO_NPZ_FACES) BRIO_FORWARD(brio_builder_expect_faces(r->builder, h->shape[0]));
    if (a->use == BRIO_NPZ_TETRAHEDRA) BRIO_FORWARD(brio_builder_expect_tetrahedra(r->builder, h->shape[0]));
    uint64_t rows = h->fortran ? h->shape[0] : 1;
    if (a->use >= BRIO_NPZ_FACES) BRIO_FORWARD(BRIO_ALLOC(r->builder->ctx, r->table, rows * h->shape[1]));
    return BRIO_OK;
}

static brio_status read_array(npz_reader *r, const brio_npz_array *a) {
    brio_status status = BRIO_OK;
    brio_zip_part part = {.name = NULL};
    brio_npy_array again;
    const brio_npy_array *h = &a->header;
    r->table = NULL;
    BRIO_TRY(brio_zip_part_open(&part, &r->npz.zip, a->entry));
    if (a->use == BRIO_NPZ_POINTS) {
        BRIO_TRY(brio_npy_read(&part.stream, r->builder));
    } else {
        BRIO_TRY(brio_npy_array_read(&part.stream, &again));
        BRIO_TRY(brio_stream_expect(&part.stream, h->shape[0], h->shape[1] * brio_npy_size(&h->element), "the header"));
        BRIO_TRY(make_room(r, a));
        BRIO_TRY(read_numbers(r, a, &part.stream));
    }
    BRIO_TRY(brio_zip_part_finish(&part));
    if (a->use >= BRIO_NPZ_FACES && h->fortran) BRIO_TRY(take_table(r, a));
done:
    brio_release(r->builder->ctx, r->table);
    brio_zip_part_close(&part);
    return status;
}

/* --- all of them --- */

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    npz_reader r = {.builder = b};
    b->sink = NULL; /* which would take the points before their properties are read */
    BRIO_TRY(npz_open(&r.npz, s));
    BRIO_TRY(npz_choose(&r.npz));
    for (int use = BRIO_NPZ_POINTS; use <= BRIO_NPZ_TETRAHEDRA; use++)
        for (size_t i = 0; i < r.npz.num_arrays; i++)
            if ((int)r.npz.arrays[i].use == use) BRIO_TRY(read_array(&r, &r.npz.arrays[i]));
    if (r.npz.num_arrays < r.npz.zip.num_entries) BRIO_TRY(brio_builder_leave_out(b, "files that are no arrays"));
    for (size_t i = 0; i < r.npz.num_arrays; i++)
        if (r.npz.arrays[i].use == BRIO_NPZ_LEFT_OUT)
            BRIO_TRY(brio_builder_leave_out(b, r.npz.arrays[i].name[0] ? r.npz.arrays[i].name : "arrays"));
done:
    npz_close(&r.npz);
    return status;
}

const brio_codec brio_npz_codec = {.starts = starts, .read = read_file};
