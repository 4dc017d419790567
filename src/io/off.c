/* OFF, the Object File Format of Geomview, as text. Reads OFF and its variants with normals (N), colours (C) and
 * texture coordinates (ST) of the vertices, which become properties. Skips colours of faces.
 *
 * Based on: Phillips et al. Geomview manual, section 4.2.5. The Geometry Center 1992. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/textrow.h"
#include <string.h>

enum { MAX_EXTRA = 9 }; /* three for the normal, four for the colour, two for the texture */

typedef struct {
    bool texture, colour, normal;
    size_t num_extra; /* numbers behind the coordinates of a vertex */
} off_kind;

/* Reads the keyword at p. Returns the place behind it, or NULL if there is none. */
static const char *scan_keyword(const char *p, off_kind *kind) {
    *kind = (off_kind){.num_extra = 0};
    if (!strncmp(p, "ST", 2)) {
        kind->texture = true;
        p += 2;
    }
    if (*p == 'C') {
        kind->colour = true;
        p++;
    }
    if (*p == 'N') {
        kind->normal = true;
        p++;
    }
    if (strncmp(p, "OFF", 3) != 0) return NULL;
    p += 3;
    return !*p || brio_is_blank(*p) || *p == '#' ? p : NULL;
}

bool brio_off_starts(const char *bytes, size_t size) {
    char start[16] = "";
    off_kind kind;
    memcpy(start, bytes, size < sizeof start - 1 ? size : sizeof start - 1);
    return scan_keyword(start, &kind) != NULL;
}

/* Reads the keyword, which a file named .off may lack. */
static brio_status read_keyword(brio_text *t, off_kind *kind) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_text_next_line(t));
    if (!t->at) return brio_text_expected(t, "OFF");
    const char *behind = scan_keyword(t->at, kind);
    if (!behind && (t->at[0] < '0' || t->at[0] > '9' || strstr(t->at, "OFF")))
        return brio_text_expected(t, "OFF, COFF, NOFF, STOFF or a combination of these, in three dimensions");
    if (behind) t->at += behind - t->at;
    if (brio_text_more(t) && !strncmp(t->at, "BINARY", 6))
        return brio_text_expected(t, "a text; binary OFF is not read");
done:
    return status;
}

static brio_status read_counts(brio_text *t, uint64_t *vertices, uint64_t *faces) {
    brio_status status = BRIO_OK;
    brio_stream *s = t->stream;
    uint64_t edges;
    brio_stream_element(s, "count", 2);
    BRIO_TRY(brio_text_count(t, "the number of vertices", UINT64_MAX >> 1, vertices));
    BRIO_TRY(brio_text_count(t, "the number of faces", UINT64_MAX >> 1, faces));
    if (brio_text_more(t)) BRIO_TRY(brio_text_count(t, "the number of edges", UINT64_MAX >> 1, &edges));
    BRIO_TRY(brio_text_row_end(t));
    /* a vertex has at least "0 0 0" and a line's end, except the last one; a face has at least "0" */
    BRIO_TRY(brio_stream_expect(s, *vertices, 5, "the number of vertices"));
    BRIO_TRY(brio_stream_expect(s, *faces, 1, "the number of faces"));
done:
    return status;
}

/* Plans properties for the numbers behind the coordinates, from the first vertex: a colour has three or four. */
static brio_status plan_extra(brio_text *t, brio_builder *b, off_kind *kind, size_t found) {
    static const char *const normal[] = {"nx", "ny", "nz"}, *const colour[] = {"red", "green", "blue", "alpha"},
                             *const texture[] = {"s", "t"};
    brio_status status = BRIO_OK;
    size_t others = (kind->normal ? 3 : 0) + (kind->texture ? 2 : 0);
    size_t colours = kind->colour && found > others ? found - others : 0;
    BRIO_REQUIRE(b->ctx, found == others + colours && (!kind->colour || colours == 3 || colours == 4), BRIO_ERR_FORMAT,
                 "%s: line %zu: %zu numbers behind the coordinates, expected those of normal, colour, texture", b->name,
                 t->stream->line, found);
    for (size_t i = 0; kind->normal && i < 3; i++) BRIO_TRY(brio_builder_property(b, normal[i], BRIO_SCALAR_FLOAT64));
    for (size_t i = 0; i < colours; i++) BRIO_TRY(brio_builder_property(b, colour[i], BRIO_SCALAR_FLOAT64));
    for (size_t i = 0; kind->texture && i < 2; i++) BRIO_TRY(brio_builder_property(b, texture[i], BRIO_SCALAR_FLOAT64));
    kind->num_extra = found;
done:
    return status;
}

static brio_status read_vertex(brio_text *t, brio_builder *b, off_kind *kind) {
    brio_status status = BRIO_OK;
    double point[3], extra[MAX_EXTRA];
    size_t found = 0;
    for (int k = 0; k < 3; k++) BRIO_TRY(brio_text_number(t, &point[k]));
    /* plain OFF files with colours behind the coordinates are common: their extra numbers are skipped */
    bool kept = kind->normal || kind->colour || kind->texture;
    while (kept && found < MAX_EXTRA && brio_text_more(t)) BRIO_TRY(brio_text_number(t, &extra[found++]));
    if (kept && t->stream->row == 0) BRIO_TRY(plan_extra(t, b, kind, found));
    BRIO_REQUIRE(b->ctx, found == kind->num_extra, BRIO_ERR_FORMAT,
                 "%s: line %zu: %zu numbers behind the coordinates, expected %zu as for the first vertex", b->name,
                 t->stream->line, found, kind->num_extra);
    BRIO_TRY(brio_builder_vertex(b, point));
    for (size_t i = 0; i < found; i++) ((double *)b->mesh->properties[i].data)[b->mesh->num_vertices - 1] = extra[i];
    if (kept) BRIO_TRY(brio_text_row_end(t));
    t->at = NULL;
done:
    return status;
}

static brio_status read_face(brio_text *t, brio_builder *b) {
    brio_status status = BRIO_OK;
    uint64_t corners;
    double index;
    BRIO_TRY(brio_text_count(t, "the number of corners", UINT32_MAX, &corners));
    for (uint64_t i = 0; i < corners; i++) {
        BRIO_TRY(brio_text_number(t, &index));
        BRIO_TRY(brio_builder_corner(b, index));
    }
    BRIO_TRY(brio_builder_face(b));
    t->at = NULL; /* the rest of the line is the colour of the face */
done:
    return status;
}

brio_status brio_off_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_text t = {s, '#', NULL};
    off_kind kind = {.num_extra = 0};
    uint64_t vertices, faces;
    BRIO_TRY(read_keyword(&t, &kind));
    BRIO_TRY(read_counts(&t, &vertices, &faces));
    brio_stream_element(s, "vertex", vertices);
    for (; s->row < vertices; s->row++) BRIO_TRY(read_vertex(&t, b, &kind));
    brio_stream_element(s, "face", faces);
    for (; s->row < faces; s->row++) BRIO_TRY(read_face(&t, b));
    BRIO_TRY(brio_text_end(&t));
done:
    return status;
}

brio_status brio_off_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    BRIO_TRY(brio_output_string(out, "OFF\n"));
    BRIO_TRY(brio_output_comment(out, "# ", job->options->comment));
    BRIO_TRY(brio_output_format(out, "%zu %zu 0\n", m->num_vertices, m->num_faces));
    for (size_t v = 0; v < m->num_vertices; v++) {
        BRIO_TRY(brio_output_point(out, m->vertices + 3 * v));
        BRIO_TRY(brio_output_string(out, "\n"));
    }
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t from = m->face_offsets[f], to = m->face_offsets[f + 1];
        BRIO_TRY(brio_output_integer(out, 0, (int64_t)(to - from)));
        for (uint64_t i = from; i < to; i++) BRIO_TRY(brio_output_integer(out, ' ', m->face_vertices[i]));
        BRIO_TRY(brio_output_string(out, "\n"));
    }
done:
    return status;
}
