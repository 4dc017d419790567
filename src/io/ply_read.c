/* Reads PLY files: text, little and big endian.
 *
 * Each element is read in one of three ways. Binary rows of fixed size are read block by block: vertices are converted
 * column by column, and other elements are skipped, except edges. All other rows are read scalar by scalar, whatever
 * their lists and encoding.
 *
 * Based on: Turk. The PLY polygon file format. Stanford 1994. */
#include "base/memory.h"
#include "io/crs.h"
#include "io/formats.h"
#include "io/ply_header.h"
#include "io/builder.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK_BYTES = 1 << 16 }; /* chosen: a block of rows and its result fit in the cache */

/* The last two corners of a strip of triangles, and how many it has. */
typedef struct {
    double before, last;
    uint64_t corners;
} strip;

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    brio_text text;
    bool ascii, swap;
    double *of_face; /* numbers of the face that is being read */
} ply_reader;

static bool starts(const char *bytes, size_t size) {
    return size >= 4 && !memcmp(bytes, "ply", 3) && brio_is_blank(bytes[3]);
}

/* --- what becomes of the properties --- */

/* Returns the axis of a name that is one of three letters, "xyz" or "XYZ", or -1. */
static int axis_of(const char *name, const char *letters) {
    const char *at = name[0] && !name[1] ? strchr(letters, name[0]) : NULL;
    return at ? (int)(at - letters) : -1;
}

/* Returns the letters of the axes: capitals where no property has a small one. */
static const char *letters_of(const brio_ply_element *e) {
    for (size_t i = 0; i < e->num_properties; i++)
        if (axis_of(e->properties[i].name, "xyz") >= 0) return "xyz";
    return "XYZ";
}

static brio_status plan_vertex(brio_builder *b, brio_ply_element *e) {
    unsigned seen = 0;
    const char *letters = letters_of(e);
    for (size_t i = 0; i < e->num_properties; i++) {
        brio_ply_property *p = &e->properties[i];
        int axis = axis_of(p->name, letters);
        if (p->list) continue;
        if (axis >= 0) {
            BRIO_EXPECT(b->ctx, !(seen & 1u << axis), BRIO_ERR_FORMAT, "%s: two properties named %s", b->name, p->name);
            seen |= 1u << axis;
            p->role = BRIO_PLY_COORDINATE;
            p->target = (size_t)axis;
        } else {
            p->role = BRIO_PLY_PROPERTY;
            p->target = b->mesh->num_properties;
            BRIO_FORWARD(brio_builder_property(b, p->name, p->type));
        }
    }
    BRIO_EXPECT(b->ctx, seen == 7 || e->count == 0, BRIO_ERR_FORMAT, "%s: the vertices have no property %c", b->name,
                "xyxzxyx"[seen]);
    return BRIO_OK;
}

static void plan_list(brio_ply_element *e, brio_ply_role role) {
    for (size_t i = 0; i < e->num_properties; i++) {
        brio_ply_property *p = &e->properties[i];
        if (!p->list || (strcmp(p->name, "vertex_indices") != 0 && strcmp(p->name, "vertex_index") != 0)) continue;
        p->role = role;
        return;
    }
}

/* Numbers of the faces are properties, unless there are strips, too: their triangles have none. */
static brio_status plan_of_faces(brio_builder *b, const brio_ply_header *header, brio_ply_element *e) {
    for (size_t i = 0; i < header->num_elements; i++)
        if (header->elements[i].count && !strcmp(header->elements[i].name, "tristrips")) return BRIO_OK;
    for (size_t i = 0; i < e->num_properties && e->count; i++) {
        brio_ply_property *p = &e->properties[i];
        char name[64];
        if (p->list) continue;
        p->role = BRIO_PLY_OF_FACE;
        p->target = b->mesh->num_face_properties;
        brio_builder_new_face_name(b, p->name, name);
        BRIO_FORWARD(brio_builder_face_property(b, name, p->type));
    }
    return BRIO_OK;
}

/* Plans an edge. Edges are read if both their ends are there. */
static void plan_edge(brio_ply_element *e) {
    brio_ply_property *ends[2] = {NULL, NULL};
    for (size_t i = 0; i < e->num_properties; i++) {
        brio_ply_property *p = &e->properties[i];
        if (!p->list && !strcmp(p->name, "vertex1")) ends[0] = p;
        if (!p->list && !strcmp(p->name, "vertex2")) ends[1] = p;
    }
    for (size_t k = 0; k < 2 && ends[0] && ends[1]; k++) ends[k]->role = BRIO_PLY_EDGE, ends[k]->target = k;
}

static bool has_role(const brio_ply_element *e, brio_ply_role role) {
    for (size_t i = 0; i < e->num_properties; i++)
        if (e->properties[i].role == role) return true;
    return false;
}

/* Returns whether the file has faces, tetrahedra or edges. */
static bool holds_cells(const brio_ply_header *header) {
    for (size_t i = 0; i < header->num_elements; i++) {
        const brio_ply_element *e = &header->elements[i];
        if (e->count && (!strcmp(e->name, "face") || !strcmp(e->name, "tristrips") || !strcmp(e->name, "tetrahedron") ||
                         !strcmp(e->name, "edge")))
            return true;
    }
    return false;
}

/* Names what is not read of an element: all of it, or some of its properties. */
static brio_status name_left_out(brio_builder *b, const brio_ply_element *e) {
    bool used = false, vertices = !strcmp(e->name, "vertex");
    for (size_t i = 0; i < e->num_properties; i++) used |= e->properties[i].role != BRIO_PLY_SKIP;
    if (!e->count || !e->num_properties) return BRIO_OK;
    if (!used) return brio_builder_leave_out(b, e->name);
    for (size_t i = 0; i < e->num_properties; i++) {
        const brio_ply_property *p = &e->properties[i];
        char name[64 + 4 + 64 + 2];
        if (p->role != BRIO_PLY_SKIP) continue;
        snprintf(name, sizeof name, vertices ? "%s" : "%s of %s", p->name, e->name);
        BRIO_FORWARD(brio_builder_leave_out(b, name));
    }
    return BRIO_OK;
}

/* Takes the coordinate system from the comments: well-known text, or a code. */
static brio_status take_crs(brio_builder *b, const char *text) {
    if (!strncmp(text, "EPSG:", 5)) return brio_mesh_set_metadata(b->mesh, "crs.code", text, strlen(text));
    if (!strchr(text, '[')) return BRIO_OK;
    BRIO_FORWARD(brio_mesh_set_metadata(b->mesh, "crs.wkt", text, strlen(text)));
    return brio_crs_describe(b->mesh);
}

static brio_status plan(ply_reader *r, brio_ply_header *header) {
    brio_builder *b = r->builder;
    bool known = r->stream->size != BRIO_SIZE_UNKNOWN && !b->salvage, vertices = false;
    for (size_t i = 0; i < header->num_elements; i++) {
        brio_ply_element *e = &header->elements[i];
        if (!strcmp(e->name, "vertex")) {
            vertices = true;
            if (!holds_cells(header)) brio_builder_stream(b, b->salvage ? BRIO_COUNT_UNKNOWN : e->count);
            BRIO_EXPECT(b->ctx, b->streams || e->count <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                        "%s: %zu points, the most are %zu", b->name, (size_t)e->count, (size_t)BRIO_MAX_VERTICES);
            BRIO_FORWARD(plan_vertex(b, e));
            if (known) BRIO_FORWARD(brio_builder_expect_vertices(b, e->count));
        } else if (!strcmp(e->name, "face")) {
            plan_list(e, BRIO_PLY_FACE);
            if (has_role(e, BRIO_PLY_FACE)) BRIO_FORWARD(plan_of_faces(b, header, e));
            if (known && has_role(e, BRIO_PLY_FACE)) BRIO_FORWARD(brio_builder_expect_faces(b, e->count));
        } else if (!strcmp(e->name, "tristrips")) {
            plan_list(e, BRIO_PLY_STRIP);
        } else if (!strcmp(e->name, "tetrahedron")) {
            plan_list(e, BRIO_PLY_TETRAHEDRON);
            if (known && has_role(e, BRIO_PLY_TETRAHEDRON)) BRIO_FORWARD(brio_builder_expect_tetrahedra(b, e->count));
        } else if (!strcmp(e->name, "edge")) {
            plan_edge(e);
        }
        BRIO_FORWARD(name_left_out(b, e));
    }
    if (header->crs) BRIO_FORWARD(take_crs(b, header->crs));
    if (header->textures) BRIO_FORWARD(brio_builder_leave_out(b, "textures"));
    BRIO_EXPECT(b->ctx, vertices, BRIO_ERR_FORMAT, "%s: the header has no element vertex", b->name);
    return BRIO_OK;
}

/* --- rows of fixed size --- */

/* Returns 3 if properties i to i + 2 are x, y, z in this order, of one type and without gaps, otherwise 1. */
static size_t consecutive(const brio_ply_element *e, size_t i) {
    for (size_t j = 0; j < 3; j++) {
        if (i + j >= e->num_properties) return 1;
        const brio_ply_property *p = &e->properties[i + j];
        if (p->role != BRIO_PLY_COORDINATE || p->target != j || p->type != e->properties[i].type) return 1;
    }
    return 3;
}

static void convert_axis(double *target, const char *source, size_t rows, size_t stride, brio_scalar type, bool swap) {
    for (size_t i = 0; i < rows; i++) target[3 * i] = brio_scalar_load(source + i * stride, type, swap);
}

static void convert_vertices(const ply_reader *r, const brio_ply_element *e, const char *bytes, size_t first,
                             size_t rows) {
    const brio_mesh *mesh = r->builder->mesh;
    size_t stride = e->row_size;
    for (size_t i = 0; i < e->num_properties; i++) {
        const brio_ply_property *p = &e->properties[i];
        const char *source = bytes + p->offset;
        if (p->role == BRIO_PLY_PROPERTY) {
            size_t size = brio_scalar_size(p->type);
            char *target = (char *)mesh->properties[p->target].data + first * size;
            brio_scalar_gather(target, source, rows, stride, size, r->swap);
        } else if (consecutive(e, i) == 3) {
            brio_scalar_convert_triples(mesh->vertices + 3 * first, source, rows, stride, p->type, r->swap);
            i += 2;
        } else {
            convert_axis(mesh->vertices + 3 * first + p->target, source, rows, stride, p->type, r->swap);
        }
    }
}

static brio_status read_blocks(ply_reader *r, const brio_ply_element *e) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    bool vertices = has_role(e, BRIO_PLY_COORDINATE);
    size_t most = e->row_size < BLOCK_BYTES ? BLOCK_BYTES / e->row_size : 1;
    while (s->row < e->count) {
        BRIO_TRY(brio_stream_fill(s, e->row_size));
        size_t rows = brio_stream_left(s) / e->row_size;
        if (rows > most) rows = most;
        if (rows > e->count - s->row) rows = (size_t)(e->count - s->row);
        if (!rows) {
            status = brio_stream_truncated(s);
            brio_salvage(r->builder, s, brio_builder_count(r->builder), vertices, &status);
            return status;
        }
        if (vertices) {
            BRIO_TRY(brio_builder_add_vertices(r->builder, rows));
            convert_vertices(r, e, s->buffer + s->begin, r->builder->mesh->num_vertices - rows, rows);
        }
        s->begin += rows * e->row_size;
        s->row += rows;
    }
done:
    return status;
}

/* --- rows walked scalar by scalar --- */

static brio_status next_scalar(ply_reader *r, brio_scalar type, double *value) {
    if (r->ascii) return brio_text_number(&r->text, value);
    const char *bytes = NULL;
    brio_status status = brio_stream_take(r->stream, brio_scalar_size(type), &bytes);
    if (status == BRIO_OK) *value = brio_scalar_load(bytes, type, r->swap);
    return status;
}

static brio_status bad_value(const ply_reader *r, const brio_ply_property *p, double value) {
    return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: %s %zu (counted from 0): %s is %.17g, not a number of its type %s", r->stream->name,
                     r->stream->element, (size_t)r->stream->row, p->name, value, brio_ply_type_name(p->type));
}

static brio_status store_scalar(ply_reader *r, const brio_ply_property *p, double value) {
    const brio_mesh *mesh = r->builder->mesh;
    size_t row = mesh->num_vertices - 1;
    if (p->role == BRIO_PLY_COORDINATE) {
        /* not rounded to the declared type: texts often have more digits than the float that they declare */
        mesh->vertices[3 * row + p->target] = value;
        return BRIO_OK;
    }
    char *target = (char *)mesh->properties[p->target].data + row * brio_scalar_size(p->type);
    return brio_scalar_store(target, p->type, value) ? BRIO_OK : bad_value(r, p, value);
}

/* Adds a corner to a strip, and the triangle that the corner ends: every second one is turned round. A negative number
 * begins another strip, and two equal corners join parts of one: a triangle with such corners is none. */
static brio_status add_strip_corner(brio_builder *b, strip *s, double corner) {
    if (corner < 0) {
        s->corners = 0;
        return BRIO_OK;
    }
    bool turned = s->corners & 1, flat = corner == s->last || corner == s->before || s->before == s->last;
    if (s->corners++ >= 2 && !flat) {
        BRIO_FORWARD(brio_builder_corner(b, turned ? s->last : s->before));
        BRIO_FORWARD(brio_builder_corner(b, turned ? s->before : s->last));
        BRIO_FORWARD(brio_builder_corner(b, corner));
        BRIO_FORWARD(brio_builder_face(b));
    }
    s->before = s->last;
    s->last = corner;
    return BRIO_OK;
}

static brio_status read_list(ply_reader *r, const brio_ply_property *p) {
    brio_stream *s = r->stream;
    double count, item, corners[4];
    strip triangles = {-1, -1, 0};
    BRIO_FORWARD(next_scalar(r, p->count_type, &count));
    BRIO_EXPECT(s->ctx, count >= 0 && count < 0x1p53 && count == floor(count), BRIO_ERR_FORMAT,
                "%s: %s %zu (counted from 0): a list of %.17g numbers", s->name, s->element, (size_t)s->row, count);
    BRIO_EXPECT(s->ctx, p->role != BRIO_PLY_TETRAHEDRON || count == 4, BRIO_ERR_FORMAT,
                "%s: tetrahedron %zu (counted from 0): %g corners, expected 4", s->name, (size_t)s->row, count);
    uint64_t items = (uint64_t)count;
    for (uint64_t i = 0; i < items; i++) {
        BRIO_FORWARD(next_scalar(r, p->type, &item));
        if (p->role == BRIO_PLY_FACE) BRIO_FORWARD(brio_builder_corner(r->builder, item));
        if (p->role == BRIO_PLY_STRIP) BRIO_FORWARD(add_strip_corner(r->builder, &triangles, item));
        if (p->role == BRIO_PLY_TETRAHEDRON) corners[i] = item;
    }
    if (p->role == BRIO_PLY_FACE) BRIO_FORWARD(brio_builder_face(r->builder));
    if (p->role == BRIO_PLY_TETRAHEDRON) BRIO_FORWARD(brio_builder_tetrahedron(r->builder, corners));
    return BRIO_OK;
}

static brio_status read_row(ply_reader *r, const brio_ply_element *e) {
    double ends[2], *of_face = r->of_face;
    bool edge = false;
    for (size_t i = 0; i < e->num_properties; i++) {
        const brio_ply_property *p = &e->properties[i];
        double value;
        if (p->list) {
            BRIO_FORWARD(read_list(r, p));
            continue;
        }
        BRIO_FORWARD(next_scalar(r, p->type, &value));
        if (p->role == BRIO_PLY_EDGE)
            ends[p->target] = value, edge = true;
        else if (p->role == BRIO_PLY_OF_FACE)
            of_face[p->target] = value;
        else if (p->role != BRIO_PLY_SKIP)
            BRIO_FORWARD(store_scalar(r, p, value));
    }
    if (edge) BRIO_FORWARD(brio_builder_edge(r->builder, ends));
    for (size_t i = 0; i < e->num_properties; i++) { /* numbers may stand before the corners */
        const brio_ply_property *p = &e->properties[i];
        if (p->role == BRIO_PLY_OF_FACE && !brio_builder_face_value(r->builder, p->target, of_face[p->target]))
            return bad_value(r, p, of_face[p->target]);
    }
    if (r->ascii) BRIO_FORWARD(brio_text_row_end(&r->text));
    return BRIO_OK;
}

static brio_status read_rows(ply_reader *r, const brio_ply_element *e) {
    brio_status status = BRIO_OK;
    bool vertices = has_role(e, BRIO_PLY_COORDINATE);
    for (; r->stream->row < e->count; r->stream->row++) {
        uint64_t before = brio_builder_count(r->builder);
        if (vertices) BRIO_TRY(brio_builder_add_vertices(r->builder, 1));
        status = read_row(r, e);
        if (brio_salvage(r->builder, r->stream, before, vertices, &status)) r->text.at = NULL;
        if (r->stream->salvaged) break;
        BRIO_TRY(status);
    }
done:
    return status;
}

static brio_status read_element(ply_reader *r, const brio_ply_element *e) {
    brio_stream_element(r->stream, e->name, e->count);
    if (!e->num_properties) return BRIO_OK;
    if (r->ascii || e->has_list || has_role(e, BRIO_PLY_EDGE)) return read_rows(r, e);
    return read_blocks(r, e);
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_ply_header header;
    ply_reader r = {.stream = s, .builder = b, .text = {s, 0, NULL}};
    BRIO_TRY(brio_ply_header_read(s, b->salvage, &header));
    r.ascii = header.encoding == BRIO_PLY_ASCII;
    r.swap = !r.ascii && (header.encoding == BRIO_PLY_LITTLE) != brio_host_is_little();
    BRIO_TRY(plan(&r, &header));
    BRIO_TRY(BRIO_ALLOC(b->ctx, r.of_face, b->mesh->num_face_properties));
    for (size_t i = 0; i < header.num_elements; i++) BRIO_TRY(read_element(&r, &header.elements[i]));
    if (r.ascii && !s->salvaged) BRIO_TRY(brio_text_end(&r.text));
done:
    brio_release(b->ctx, r.of_face);
    brio_ply_header_free(b->ctx, &header);
    return status;
}

const brio_codec brio_ply_codec = {.starts = starts, .read = read_file, .rows = &brio_ply_rows};
