/* STL files: triangles as text or binary.
 *
 * The format has no vertices, only corners: corners at the same position become one vertex. Normals are passed
 * over, since they follow from the corners. Written are single-precision coordinates and the normals of the triangles;
 * polygons of more corners are cut into triangles from their first corner.
 *
 * A binary file may begin with the word "solid", too: what decides is whether its size is that of the triangles that it
 * announces, or, in a pipe, whether there is a byte 0 within its beginning.
 *
 * Based on: 3D Systems. Stereolithography interface specification. 1989. */
#include "base/memory.h"
#include "base/rng.h"
#include "io/builder.h"
#include "io/formats.h"
#include "io/little_endian.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* --- coincident corners --- */

/* Vertices by their positions, in a table with linear probing. -0 and 0 are the same position. */

typedef struct brio_weld {
    uint32_t *slots; /* vertex + 1 by the hash of its position; 0: none. At most half of the slots are used. */
    size_t size;     /* a power of two */
} brio_weld;

enum { FIRST_SIZE = 1 << 10 }; /* chosen */

static uint64_t hash_of(const double *point) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        double x = point[k] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        hash = brio_mix(hash ^ bits);
    }
    return hash;
}

/* Finds the slot of a position: the one that has its vertex, or the one that is free for it. */
static size_t find_slot(const brio_weld *weld, const double *vertices, const double *point) {
    size_t slot = hash_of(point) & (weld->size - 1);
    for (; weld->slots[slot]; slot = (slot + 1) & (weld->size - 1)) {
        const double *p = vertices + 3 * (size_t)(weld->slots[slot] - 1);
        if (p[0] == point[0] && p[1] == point[1] && p[2] == point[2]) break;
    }
    return slot;
}

static brio_status grow(brio_weld *weld, const brio_builder *b) {
    size_t size = weld->size ? 2 * weld->size : FIRST_SIZE;
    uint32_t *slots = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(b->ctx, slots, size));
    brio_release(b->ctx, weld->slots);
    *weld = (brio_weld){slots, size};
    for (size_t v = 0; v < b->mesh->num_vertices; v++)
        slots[find_slot(weld, b->mesh->vertices, b->mesh->vertices + 3 * v)] = (uint32_t)v + 1;
    return BRIO_OK;
}

/* Finds the vertex at a position in the mesh under construction, or adds it.
 *  weld  {0} before the first call; freed by weld_free.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
static brio_status weld_vertex(brio_weld *weld, brio_builder *b, const double *point, uint32_t *vertex) {
    if (2 * (b->mesh->num_vertices + 1) > weld->size) BRIO_FORWARD(grow(weld, b));
    size_t slot = find_slot(weld, b->mesh->vertices, point);
    if (!weld->slots[slot]) {
        BRIO_FORWARD(brio_builder_vertex(b, point));
        weld->slots[slot] = (uint32_t)b->mesh->num_vertices;
    }
    *vertex = weld->slots[slot] - 1;
    return BRIO_OK;
}

static void weld_free(brio_context *ctx, brio_weld *weld) {
    brio_release(ctx, weld->slots);
    weld->slots = NULL;
}

/* --- files --- */

enum { HEADER = 84, COUNT_AT = 80, TRIANGLE = 50, CORNERS_AT = 12, ATTRIBUTE_AT = 48 };

/* --- reading --- */

static brio_status add_triangle(brio_builder *b, brio_weld *weld, double corners[3][3]) {
    for (int i = 0; i < 3; i++) {
        uint32_t vertex = 0;
        for (int k = 0; k < 3; k++)
            BRIO_EXPECT(b->ctx, isfinite(corners[i][k]), BRIO_ERR_NOT_FINITE,
                        "%s: triangle %zu (counted from 0) has the coordinate %g", b->name, b->mesh->num_faces,
                        corners[i][k]);
        BRIO_FORWARD(weld_vertex(weld, b, corners[i], &vertex));
        BRIO_FORWARD(brio_builder_corner(b, vertex));
    }
    return brio_builder_face(b);
}

static brio_status read_binary(brio_stream *s, brio_builder *b, brio_weld *weld) {
    const char *bytes = NULL;
    double corners[3][3];
    brio_stream_element(s, "header", 1);
    BRIO_FORWARD(brio_stream_take(s, HEADER, &bytes));
    uint32_t count = brio_le32(bytes + COUNT_AT);
    BRIO_FORWARD(brio_stream_expect(s, count, TRIANGLE, "the header"));
    if (s->size != BRIO_SIZE_UNKNOWN) BRIO_FORWARD(brio_builder_expect_faces(b, count));
    brio_stream_element(s, "triangle", count);
    for (; s->row < count; s->row++) {
        BRIO_FORWARD(brio_stream_take(s, TRIANGLE, &bytes));
        if (brio_le16(bytes + ATTRIBUTE_AT)) BRIO_FORWARD(brio_builder_leave_out(b, "attributes of faces"));
        brio_scalar_convert_triples(corners[0], bytes + CORNERS_AT, 3, CORNERS_AT, BRIO_SCALAR_FLOAT32,
                                    !brio_host_is_little());
        BRIO_FORWARD(add_triangle(b, weld, corners));
    }
    /* some writers never set the number; a few bytes behind the triangles are theirs */
    BRIO_FORWARD(brio_stream_fill(s, TRIANGLE));
    BRIO_EXPECT(s->ctx, brio_stream_left(s) < TRIANGLE, BRIO_ERR_FORMAT,
                "%s: byte %d: %u triangles are announced, behind which the file has another one", s->name, COUNT_AT,
                count);
    return BRIO_OK;
}

/* Moves to the first word of the next line and checks it.   words  one or two of them, the second after one blank. */
static brio_status expect_line(brio_text *t, const char *words) {
    BRIO_FORWARD(brio_text_next_line(t));
    if (!t->at || strncasecmp(t->at, words, strlen(words)) != 0) return brio_text_expected(t, words);
    t->at += strlen(words);
    return BRIO_OK;
}

/* Notes that a solid has a name, which is the rest of its first line. The writer below knows no other than brio. */
static brio_status note_name(brio_builder *b, const brio_text *t) {
    const char *at = brio_skip_blanks(t->at);
    return *at && strcmp(at, "brio") != 0 ? brio_builder_leave_out(b, "names of solids") : BRIO_OK;
}

static brio_status read_facet(brio_text *t, double corners[3][3]) {
    BRIO_FORWARD(expect_line(t, "outer loop"));
    for (int i = 0; i < 3; i++) {
        BRIO_FORWARD(expect_line(t, "vertex"));
        for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_text_number(t, &corners[i][k]));
        BRIO_FORWARD(brio_text_row_end(t));
    }
    BRIO_FORWARD(expect_line(t, "endloop"));
    return expect_line(t, "endfacet");
}

static brio_status read_text(brio_stream *s, brio_builder *b, brio_weld *weld) {
    brio_text t = {s, 0, NULL};
    double corners[3][3];
    bool ended = false;
    brio_stream_element(s, "triangle", 0);
    BRIO_FORWARD(expect_line(&t, "solid"));
    BRIO_FORWARD(note_name(b, &t));
    for (;;) {
        BRIO_FORWARD(brio_text_next_line(&t));
        if (!t.at && ended) return BRIO_OK;
        bool ends = t.at && !strncasecmp(t.at, "endsolid", 8), begins = t.at && !strncasecmp(t.at, "solid", 5);
        if (ends || begins) {
            ended = ends;
            if (begins) t.at += strlen("solid");
            if (begins) BRIO_FORWARD(note_name(b, &t));
            continue;
        }
        if (!t.at || strncasecmp(t.at, "facet", 5) != 0) return brio_text_expected(&t, "facet or endsolid");
        BRIO_FORWARD(read_facet(&t, corners));
        BRIO_FORWARD(add_triangle(b, weld, corners));
        s->row++;
    }
    return BRIO_OK;
}

static bool is_text(const brio_stream *s) {
    const char *bytes = s->buffer + s->begin;
    size_t left = brio_stream_left(s);
    if (left < 5 || strncasecmp(bytes, "solid", 5) != 0) return false;
    if (left < HEADER) return true;
    if (s->size != BRIO_SIZE_UNKNOWN) return s->size != HEADER + (uint64_t)TRIANGLE * brio_le32(bytes + COUNT_AT);
    return !memchr(bytes, 0, left < HEADER + TRIANGLE ? left : HEADER + TRIANGLE);
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_weld weld = {.size = 0};
    BRIO_TRY(brio_stream_fill(s, HEADER + TRIANGLE));
    BRIO_TRY(is_text(s) ? read_text(s, b, &weld) : read_binary(s, b, &weld));
done:
    weld_free(b->ctx, &weld);
    return status;
}

/* --- writing --- */

/* The normal and the three corners of a triangle. */
typedef struct {
    float numbers[4][3];
} triangle;

/* Makes a triangle. The normal is computed from the rounded corners, scaled so that products neither overflow nor
 * vanish. */
static triangle make_triangle(const brio_mesh *m, const uint32_t *corners) {
    triangle t = {{{0}}};
    double edges[2][3], size = 0, normal[3], length = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) t.numbers[1 + i][k] = (float)m->vertices[3 * (size_t)corners[i] + (size_t)k];
    for (int e = 0; e < 2; e++)
        for (int k = 0; k < 3; k++) {
            edges[e][k] = (double)t.numbers[2 + e][k] - (double)t.numbers[1][k];
            size = fmax(size, fabs(edges[e][k]));
        }
    if (!(size > 0)) return t;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = edges[0][i] / size * (edges[1][j] / size) - edges[0][j] / size * (edges[1][i] / size);
        length += normal[k] * normal[k];
    }
    for (int k = 0; k < 3 && length > 0; k++) t.numbers[0][k] = (float)(normal[k] / sqrt(length));
    return t;
}

static brio_status write_numbers(brio_output *out, const char *words, const float *numbers) {
    brio_status status = brio_output_string(out, words);
    for (int k = 0; k < 3 && status == BRIO_OK; k++) {
        const brio_property number = {.type = BRIO_SCALAR_FLOAT32, .data = (void *)(uintptr_t)&numbers[k]};
        status = brio_output_scalar(out, ' ', &number, 0);
    }
    return status == BRIO_OK ? brio_output_string(out, "\n") : status;
}

static brio_status write_text(brio_output *out, const triangle *t) {
    BRIO_FORWARD(write_numbers(out, "facet normal", t->numbers[0]));
    BRIO_FORWARD(brio_output_string(out, "outer loop\n"));
    for (int i = 1; i < 4; i++) BRIO_FORWARD(write_numbers(out, "vertex", t->numbers[i]));
    return brio_output_string(out, "endloop\nendfacet\n");
}

static brio_status write_triangle(brio_output *out, const triangle *t, bool ascii) {
    char bytes[TRIANGLE] = {0};
    if (ascii) return write_text(out, t);
    for (int i = 0; i < 12; i++) {
        uint32_t bits;
        memcpy(&bits, &t->numbers[i / 3][i % 3], sizeof bits);
        brio_put_le32(bytes + 4 * i, bits);
    }
    return brio_output_bytes(out, bytes, sizeof bytes);
}

static brio_status write_header(brio_output *out, const brio_write_job *job, uint32_t count) {
    char header[HEADER] = {0};
    const char *comment = job->options->comment ? job->options->comment : "";
    if (job->options->ascii) return brio_output_string(out, "solid brio\n");
    snprintf(header, COUNT_AT, "binary STL %s", comment);
    brio_put_le32(header + COUNT_AT, count);
    return brio_output_bytes(out, header, sizeof header);
}

static brio_status write_file(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh;
    uint64_t count = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t corners = m->face_offsets[f + 1] - m->face_offsets[f];
        count += corners > 2 ? corners - 2 : 0;
    }
    BRIO_EXPECT(out->ctx, count && count <= UINT32_MAX, BRIO_ERR_ARGUMENT,
                "%s: %" PRIu64 " triangles, an STL file holds 1 to %" PRIu32, out->name, count, UINT32_MAX);
    BRIO_FORWARD(write_header(out, job, (uint32_t)count));
    for (size_t f = 0; f < m->num_faces; f++)
        for (uint64_t i = m->face_offsets[f] + 2; i < m->face_offsets[f + 1]; i++) {
            uint32_t corners[] = {m->face_vertices[m->face_offsets[f]], m->face_vertices[i - 1], m->face_vertices[i]};
            triangle t = make_triangle(m, corners);
            BRIO_FORWARD(write_triangle(out, &t, job->options->ascii));
        }
    if (job->options->ascii) BRIO_FORWARD(brio_output_string(out, "endsolid brio\n"));
    return BRIO_OK;
}

const brio_codec brio_stl_codec = {.read = read_file, .write = write_file};
