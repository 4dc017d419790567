/* OFF, the Object File Format of Geomview. Reads OFF and its variants with normals (N), colours (C) and texture
 * coordinates (ST) of the vertices, which become properties, as text and binary. Colours of faces are three or four
 * numbers behind the corners: bytes, or from 0 to 1; faces without one have NaN. An index in a table of colours is
 * passed over, and said so.
 *
 * A binary file has the keyword and BINARY in its first line. Behind it are integers and floats of 32 bits, the most
 * significant byte first, in the order of the text; a vertex's colour is four floats, and behind the corners of a face
 * is the number of its colour's floats.
 *
 * Based on: Phillips et al. Geomview manual, section 4.2.5. The Geometry Center 1992. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/little_endian.h"
#include "io/number.h"
#include "io/builder.h"
#include "io/textrow.h"
#include "mesh/properties.h"
#include <math.h>
#include <string.h>

enum { MAX_EXTRA = 9 }; /* three for the normal, four for the colour, two for the texture */

typedef struct {
    bool texture, colour, normal;
    size_t num_extra; /* numbers behind the coordinates of a vertex */
} off_kind;

/* Reads the keyword at p, whose letters may come in any order. Returns the place behind it, or NULL if there is
 * none. */
static const char *scan_keyword(const char *p, off_kind *kind) {
    *kind = (off_kind){.num_extra = 0};
    for (;;) {
        if (!kind->texture && !strncmp(p, "ST", 2))
            kind->texture = true, p += 2;
        else if (!kind->colour && *p == 'C')
            kind->colour = true, p++;
        else if (!kind->normal && *p == 'N')
            kind->normal = true, p++;
        else
            break;
    }
    if (strncmp(p, "OFF", 3) != 0) return NULL;
    p += 3;
    /* some collections have the counts at the keyword: OFF490 518 0 */
    return !*p || brio_is_blank(*p) || *p == '#' || (*p >= '0' && *p <= '9') ? p : NULL;
}

static bool starts(const char *bytes, size_t size) {
    char start[16] = "";
    off_kind kind;
    memcpy(start, bytes, size < sizeof start - 1 ? size : sizeof start - 1);
    return scan_keyword(start, &kind) != NULL;
}

/* Reads the keyword, which a file named .off may lack, and finds out whether binary numbers follow its line. */
static brio_status read_keyword(brio_text *t, off_kind *kind, bool *binary) {
    BRIO_FORWARD(brio_text_next_line(t));
    if (!t->at) return brio_text_expected(t, "OFF");
    const char *behind = scan_keyword(t->at, kind);
    if (!behind && (t->at[0] < '0' || t->at[0] > '9' || strstr(t->at, "OFF")))
        return brio_text_expected(t, "OFF, COFF, NOFF, STOFF or a combination of these, in three dimensions");
    if (behind) t->at += behind - t->at;
    *binary = brio_text_more(t) && !strncmp(t->at, "BINARY", 6);
    return BRIO_OK;
}

static brio_status read_counts(brio_text *t, bool salvages, uint64_t *vertices, uint64_t *faces) {
    brio_stream *s = t->stream;
    uint64_t edges;
    brio_stream_element(s, "count", 2);
    BRIO_FORWARD(brio_text_count(t, "the number of vertices", UINT64_MAX >> 1, vertices));
    BRIO_FORWARD(brio_text_count(t, "the number of faces", UINT64_MAX >> 1, faces));
    if (brio_text_more(t)) BRIO_FORWARD(brio_text_count(t, "the number of edges", UINT64_MAX >> 1, &edges));
    BRIO_FORWARD(brio_text_row_end(t));
    if (salvages) return BRIO_OK;
    /* a vertex has at least "0 0 0" and a line's end, except the last one; a face has at least "0" */
    BRIO_FORWARD(brio_stream_expect(s, *vertices, 5, "the number of vertices"));
    return brio_stream_expect(s, *faces, 1, "the number of faces");
}

/* Plans properties for the numbers behind the coordinates, from the first vertex: a colour has three or four. */
static brio_status plan_extra(brio_text *t, brio_builder *b, off_kind *kind, size_t found) {
    static const char *const normal[] = {"nx", "ny", "nz"}, *const colour[] = {"red", "green", "blue", "alpha"},
                             *const texture[] = {"s", "t"};
    size_t others = (kind->normal ? 3 : 0) + (kind->texture ? 2 : 0);
    size_t colours = kind->colour && found > others ? found - others : 0;
    BRIO_EXPECT(b->ctx, found == others + colours && (!kind->colour || colours == 3 || colours == 4), BRIO_ERR_FORMAT,
                "%s: line %zu: %zu numbers behind the coordinates, expected those of normal, colour, texture", b->name,
                t->stream->line, found);
    for (size_t i = 0; kind->normal && i < 3; i++)
        BRIO_FORWARD(brio_builder_property(b, normal[i], BRIO_SCALAR_FLOAT64));
    for (size_t i = 0; i < colours; i++) BRIO_FORWARD(brio_builder_property(b, colour[i], BRIO_SCALAR_FLOAT64));
    for (size_t i = 0; kind->texture && i < 2; i++)
        BRIO_FORWARD(brio_builder_property(b, texture[i], BRIO_SCALAR_FLOAT64));
    kind->num_extra = found;
    return BRIO_OK;
}

static bool are_bytes(const double *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(values[i] >= 0 && values[i] <= 255) || values[i] != floor(values[i])) return false;
    return true;
}

/* Plans properties for what a plain OFF file has behind the coordinates of the first vertex: three or four bytes are a
 * colour. */
static brio_status plan_plain(brio_builder *b, off_kind *kind, const double *extra, size_t found) {
    static const char *const colour[] = {"red", "green", "blue", "alpha"};
    if ((found != 3 && found != 4) || !are_bytes(extra, found)) return BRIO_OK;
    for (size_t i = 0; i < found; i++) BRIO_FORWARD(brio_builder_property(b, colour[i], BRIO_SCALAR_FLOAT64));
    kind->colour = true;
    kind->num_extra = found;
    return BRIO_OK;
}

static brio_status read_vertex(brio_text *t, brio_builder *b, off_kind *kind) {
    double point[3], extra[MAX_EXTRA];
    size_t found = 0;
    for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_text_number(t, &point[k]));
    /* plain OFF files with colours behind the coordinates are common */
    bool kept = kind->normal || kind->colour || kind->texture;
    while (found < MAX_EXTRA && brio_text_more(t)) BRIO_FORWARD(brio_text_number(t, &extra[found++]));
    if (!kept && t->stream->row == 0) BRIO_FORWARD(plan_plain(b, kind, extra, found));
    if (kept && t->stream->row == 0) BRIO_FORWARD(plan_extra(t, b, kind, found));
    kept = kind->normal || kind->colour || kind->texture;
    if (!kept && found) BRIO_FORWARD(brio_builder_leave_out(b, "numbers behind the coordinates"));
    if (!kept) found = 0;
    BRIO_EXPECT(b->ctx, found == kind->num_extra, BRIO_ERR_FORMAT,
                "%s: line %zu: %zu numbers behind the coordinates, expected %zu as for the first vertex", b->name,
                t->stream->line, found, kind->num_extra);
    BRIO_FORWARD(brio_builder_vertex(b, point));
    for (size_t i = 0; i < found; i++) ((double *)b->mesh->properties[i].data)[b->mesh->num_vertices - 1] = extra[i];
    if (kept) BRIO_FORWARD(brio_text_row_end(t));
    t->at = NULL;
    return BRIO_OK;
}

/* Gives the face that was added last its colour, 3 or 4 numbers or none; all other numbers are left out. The first
 * colour decides whether there is an alpha. */
static brio_status keep_face_colour(brio_builder *b, const double *numbers, size_t count) {
    static const char *const names[] = {"red", "green", "blue", "alpha"};
    const brio_mesh *m = b->mesh;
    bool colour = count == 3 || count == 4;
    if (!m->num_face_properties && colour) {
        for (size_t i = 0; i < count; i++) {
            BRIO_FORWARD(brio_builder_face_property(b, names[i], BRIO_SCALAR_FLOAT64));
            for (size_t f = 0; f < m->num_faces; f++) ((double *)m->face_properties[i].data)[f] = (double)NAN;
        }
    }
    if (count && (!colour || count > m->num_face_properties))
        BRIO_FORWARD(brio_builder_leave_out(b, "colours of faces"));
    for (size_t i = 0; i < m->num_face_properties; i++)
        brio_builder_face_value(b, i, colour && i < count ? numbers[i] : (double)NAN);
    return BRIO_OK;
}

static brio_status read_face(brio_text *t, brio_builder *b) {
    uint64_t corners;
    double index, colour[4];
    size_t count = 0;
    BRIO_FORWARD(brio_text_count(t, "the number of corners", UINT32_MAX, &corners));
    for (uint64_t i = 0; i < corners; i++) {
        BRIO_FORWARD(brio_text_number(t, &index));
        BRIO_FORWARD(brio_builder_corner(b, index));
    }
    BRIO_FORWARD(brio_builder_face(b));
    while (count < 4 && brio_text_more(t)) {
        const char *at = t->at;
        if (!brio_parse_number(&at, &colour[count])) break;
        t->at += at - t->at;
        count++;
    }
    if (brio_text_more(t)) { /* a word, or too many numbers */
        count = 0;
        BRIO_FORWARD(brio_builder_leave_out(b, "colours of faces"));
    }
    BRIO_FORWARD(keep_face_colour(b, colour, count));
    t->at = NULL;
    return BRIO_OK;
}

/* --- binary --- */

static brio_status take_word(brio_stream *s, uint32_t *word) {
    const char *bytes = NULL;
    brio_status status = brio_stream_take(s, sizeof *word, &bytes);
    if (status == BRIO_OK) *word = __builtin_bswap32(brio_le32(bytes));
    return status;
}

static brio_status take_real(brio_stream *s, double *value) {
    uint32_t bits = 0;
    float single;
    brio_status status = take_word(s, &bits);
    memcpy(&single, &bits, sizeof single);
    *value = (double)single;
    return status;
}

static brio_status plan_binary(brio_builder *b, off_kind *kind) {
    static const char *const names[MAX_EXTRA] = {"nx", "ny", "nz", "red", "green", "blue", "alpha", "s", "t"};
    for (size_t i = 0; i < MAX_EXTRA; i++) {
        if (!(i < 3 ? kind->normal : i < 7 ? kind->colour : kind->texture)) continue;
        BRIO_FORWARD(brio_builder_property(b, names[i], BRIO_SCALAR_FLOAT32));
        kind->num_extra++;
    }
    return BRIO_OK;
}

static brio_status read_binary_vertex(brio_stream *s, brio_builder *b, const off_kind *kind) {
    double point[3], extra;
    for (int k = 0; k < 3; k++) BRIO_FORWARD(take_real(s, &point[k]));
    BRIO_FORWARD(brio_builder_vertex(b, point));
    for (size_t i = 0; i < kind->num_extra; i++) {
        BRIO_FORWARD(take_real(s, &extra));
        ((float *)b->mesh->properties[i].data)[b->mesh->num_vertices - 1] = (float)extra;
    }
    return BRIO_OK;
}

static brio_status read_binary_face(brio_stream *s, brio_builder *b) {
    uint32_t corners, index, colours;
    double colour[4];
    BRIO_FORWARD(take_word(s, &corners));
    BRIO_FORWARD(brio_stream_expect(s, corners, sizeof index, "the number of corners"));
    for (uint32_t i = 0; i < corners; i++) {
        BRIO_FORWARD(take_word(s, &index));
        BRIO_FORWARD(brio_builder_corner(b, index));
    }
    BRIO_FORWARD(brio_builder_face(b));
    BRIO_FORWARD(take_word(s, &colours));
    for (size_t i = 0; i < colours && i < 4; i++) BRIO_FORWARD(take_real(s, &colour[i]));
    BRIO_FORWARD(keep_face_colour(b, colour, colours));
    if (colours > 4) BRIO_FORWARD(brio_stream_skip(s, sizeof(float) * (uint64_t)(colours - 4)));
    return BRIO_OK;
}

static brio_status read_binary(brio_stream *s, brio_builder *b, off_kind *kind) {
    uint32_t vertices, faces, edges;
    BRIO_FORWARD(take_word(s, &vertices));
    BRIO_FORWARD(take_word(s, &faces));
    BRIO_FORWARD(take_word(s, &edges));
    BRIO_FORWARD(plan_binary(b, kind));
    BRIO_FORWARD(brio_stream_expect(s, vertices, (3 + kind->num_extra) * sizeof(float), "the number of vertices"));
    BRIO_FORWARD(brio_stream_expect(s, faces, 2 * sizeof(uint32_t), "the number of faces"));
    brio_stream_element(s, "vertex", vertices);
    for (; s->row < vertices; s->row++) BRIO_FORWARD(read_binary_vertex(s, b, kind));
    brio_stream_element(s, "face", faces);
    for (; s->row < faces; s->row++) BRIO_FORWARD(read_binary_face(s, b));
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_text t = {s, '#', NULL};
    off_kind kind = {.num_extra = 0};
    uint64_t vertices, faces;
    bool binary = false;
    BRIO_TRY(read_keyword(&t, &kind, &binary));
    if (binary) return read_binary(s, b, &kind);
    BRIO_TRY(read_counts(&t, b->salvage, &vertices, &faces));
    brio_stream_element(s, "vertex", vertices);
    for (; s->row < vertices; s->row++) {
        uint64_t before = brio_builder_count(b);
        status = read_vertex(&t, b, &kind);
        if (brio_salvage(b, s, before, true, &status)) t.at = NULL;
        if (s->salvaged) break;
        BRIO_TRY(status);
    }
    brio_stream_element(s, "face", faces);
    for (; s->row < faces; s->row++) {
        status = read_face(&t, b);
        if (brio_salvage(b, s, brio_builder_count(b), false, &status)) break;
        BRIO_TRY(status);
    }
    BRIO_TRY(status);
    if (!s->salvaged) BRIO_TRY(brio_text_end(&t));
done:
    return status;
}

/* Writes a face. Its colour has been made bytes, if numbers of that range can be. */
static brio_status write_face(brio_output *out, const brio_mesh *m, const brio_channels *colour, size_t f) {
    uint64_t from = m->face_offsets[f], to = m->face_offsets[f + 1];
    BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)(to - from)));
    for (uint64_t i = from; i < to; i++) BRIO_FORWARD(brio_output_integer(out, ' ', m->face_vertices[i]));
    for (int k = 0; k < colour->count; k++) BRIO_FORWARD(brio_output_scalar(out, ' ', colour->of[k], f));
    return brio_output_string(out, "\n");
}

static brio_status write_file(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh, faces = brio_mesh_faces_as_points(m);
    const brio_channels colour = brio_colour_of(&faces);
    BRIO_FORWARD(brio_output_string(out, "OFF\n"));
    BRIO_FORWARD(brio_output_comment(out, "# ", job->options->comment));
    BRIO_FORWARD(brio_output_format(out, "%zu %zu 0\n", m->num_vertices, m->num_faces));
    for (size_t v = 0; v < m->num_vertices; v++) {
        BRIO_FORWARD(brio_output_point(out, m->vertices + 3 * v));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    for (size_t f = 0; f < m->num_faces; f++) BRIO_FORWARD(write_face(out, m, &colour, f));
    return BRIO_OK;
}

const brio_codec brio_off_codec = {.starts = starts, .read = read_file, .write = write_file};
