/* Reads NPZ files: zip archives of NumPy's arrays, stored or compressed by deflate.
 *
 * The points are read first, as from an NPY file. Arrays with as many rows become properties; arrays of indices become
 * polygons or tetrahedra. All other arrays are left out. What belongs to a point is in several arrays, so the file is one
 * block. A pipe, and a file that is compressed as a whole, is read into memory first, since the table of a zip archive is
 * at its end.
 *
 * Based on: NumPy enhancement proposal 1: a simple file format for NumPy arrays. 2007. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/npz/npz_arrays.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct {
    brio_npz npz;
    brio_builder *builder;
    size_t first_property; /* of the array that is read */
    double *table;         /* of an array of indices in Fortran's order: all of it, row by row */
} npz_reader;

bool brio_npz_starts(const char *bytes, size_t size) {
    return size >= 4 && (!memcmp(bytes, "PK\3\4", 4) || !memcmp(bytes, "PK\5\6", 4));
}

/* --- one array --- */

static brio_status put_index(npz_reader *r, const brio_npz_array *a, uint64_t row, uint64_t column, double value) {
    brio_status status = BRIO_OK;
    uint64_t last = a->header.shape[1] - 1;
    if (a->header.fortran) {
        r->table[row * (last + 1) + column] = value;
        return BRIO_OK;
    }
    if (a->use == BRIO_NPZ_TETRAHEDRA) {
        r->table[column] = value;
        return column == last ? brio_builder_tetrahedron(r->builder, r->table) : BRIO_OK;
    }
    BRIO_TRY(brio_builder_corner(r->builder, value));
    if (column == last) BRIO_TRY(brio_builder_face(r->builder));
done:
    return status;
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
    brio_status status = BRIO_OK;
    const brio_npy_array *h = &a->header;
    size_t size = brio_npy_size(&h->element);
    uint64_t outer = h->shape[h->fortran], inner = h->shape[!h->fortran];
    const char *bytes = NULL;
    brio_stream_element(s, h->fortran ? "column" : "row", outer);
    for (; s->row < outer; s->row++)
        for (uint64_t j = 0; j < inner; j++) {
            BRIO_TRY(brio_stream_take(s, size, &bytes));
            double value = brio_npy_load(&h->element, bytes);
            if (brio_npy_is_rounded(&h->element, bytes))
                BRIO_TRY(brio_builder_leave_out(r->builder, "integers beyond 2^53"));
            BRIO_TRY(h->fortran ? put(r, a, j, s->row, value) : put(r, a, s->row, j, value));
        }
done:
    return status;
}

/* Adds the properties of an array: one of its name, or one for each column. */
static brio_status add_properties(npz_reader *r, const brio_npz_array *a) {
    static const char *const components[][4] = {{"nx", "ny", "nz"}, {"red", "green", "blue", "alpha"}};
    static const char *const names[][4] = {{"normals", "normal"}, {"colors", "colours", "rgb", "color"}};
    brio_status status = BRIO_OK;
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
        BRIO_TRY(brio_builder_property(r->builder, known >= 0 ? components[known][i] : name,
                                       e->wide ? BRIO_SCALAR_FLOAT64 : e->type));
    }
done:
    return status;
}

/* Makes the faces or tetrahedra of an array in Fortran's order. */
static brio_status take_table(npz_reader *r, const brio_npz_array *a) {
    brio_status status = BRIO_OK;
    uint64_t columns = a->header.shape[1];
    for (uint64_t row = 0; row < a->header.shape[0]; row++) {
        const double *indices = r->table + row * columns;
        if (a->use == BRIO_NPZ_TETRAHEDRA) {
            BRIO_TRY(brio_builder_tetrahedron(r->builder, indices));
            continue;
        }
        for (uint64_t i = 0; i < columns; i++) BRIO_TRY(brio_builder_corner(r->builder, indices[i]));
        BRIO_TRY(brio_builder_face(r->builder));
    }
done:
    return status;
}

/* Makes room for what an array becomes, whose numbers have been held against the size of the file. */
static brio_status make_room(npz_reader *r, const brio_npz_array *a) {
    brio_status status = BRIO_OK;
    const brio_npy_array *h = &a->header;
    if (a->use == BRIO_NPZ_PROPERTY) return add_properties(r, a);
    if (a->use == BRIO_NPZ_X) {
        BRIO_TRY(brio_builder_expect_vertices(r->builder, h->shape[0]));
        return brio_builder_add_vertices(r->builder, (size_t)h->shape[0]);
    }
    if (a->use == BRIO_NPZ_FACES) BRIO_TRY(brio_builder_expect_faces(r->builder, h->shape[0]));
    if (a->use == BRIO_NPZ_TETRAHEDRA) BRIO_TRY(brio_builder_expect_tetrahedra(r->builder, h->shape[0]));
    uint64_t rows = h->fortran ? h->shape[0] : 1;
    if (a->use >= BRIO_NPZ_FACES) BRIO_TRY(BRIO_ALLOC(r->builder->ctx, r->table, rows * h->shape[1]));
done:
    return status;
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

brio_status brio_npz_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    npz_reader r = {.builder = b};
    b->sink = NULL; /* which would take the points before their properties are read */
    BRIO_TRY(brio_npz_open(&r.npz, s));
    BRIO_TRY(brio_npz_choose(&r.npz));
    for (int use = BRIO_NPZ_POINTS; use <= BRIO_NPZ_TETRAHEDRA; use++)
        for (size_t i = 0; i < r.npz.num_arrays; i++)
            if ((int)r.npz.arrays[i].use == use) BRIO_TRY(read_array(&r, &r.npz.arrays[i]));
    if (r.npz.num_arrays < r.npz.zip.num_entries) BRIO_TRY(brio_builder_leave_out(b, "files that are no arrays"));
    for (size_t i = 0; i < r.npz.num_arrays; i++)
        if (r.npz.arrays[i].use == BRIO_NPZ_LEFT_OUT)
            BRIO_TRY(brio_builder_leave_out(b, r.npz.arrays[i].name[0] ? r.npz.arrays[i].name : "arrays"));
done:
    brio_npz_close(&r.npz);
    return status;
}
