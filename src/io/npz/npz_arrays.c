/* Finds out which arrays of an NPZ file are points, properties, triangles and tetrahedra, by their names and shapes. */
#include "io/npz/npz_arrays.h"
#include "base/memory.h"
#include "io/limits.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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

brio_status brio_npz_open(brio_npz *n, brio_stream *s) {
    brio_status status = BRIO_OK;
    *n = (brio_npz){.rows = 0};
    BRIO_TRY(brio_zip_open(&n->zip, s));
    BRIO_TRY(BRIO_ALLOC(s->ctx, n->arrays, n->zip.num_entries));
    for (size_t i = 0; i < n->zip.num_entries; i++) BRIO_TRY(read_header(n, &n->zip.entries[i]));
done:
    return status;
}

void brio_npz_close(brio_npz *n) {
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

brio_status brio_npz_choose(brio_npz *n) {
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
