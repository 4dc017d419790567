/* Wavefront OBJ: reads and writes the statements v and f, skips all others.
 *
 * Based on: Wavefront Technologies. Object files (.obj). Advanced Visualizer Manual, appendix B1. */
#include "io/formats.h"
#include "io/number.h"
#include "io/textrow.h"
#include <string.h>

/* Reads the line that continues the current one. */
static brio_status continue_line(brio_text *t) {
    brio_status status = brio_stream_line(t->stream, &t->at);
    char *comment = status == BRIO_OK && t->at ? strchr(t->at, t->comment) : NULL;
    if (comment) *comment = 0;
    return status;
}

/* Moves to the next word of the statement, across a backslash at the end of a line. */
static brio_status next_word(brio_text *t, bool *more) {
    brio_status status = BRIO_OK;
    for (;;) {
        *more = brio_text_more(t);
        if (!*more || t->at[0] != '\\' || *brio_skip_blanks(t->at + 1)) return BRIO_OK;
        BRIO_TRY(continue_line(t));
    }
done:
    return status;
}

static bool ends_word(const char *p) {
    return !*p || brio_is_blank(*p) || (*p == '\\' && !*brio_skip_blanks((char *)p + 1));
}

static brio_status read_vertex(brio_text *t, brio_builder *b) {
    brio_status status = BRIO_OK;
    double point[3];
    bool more;
    for (int k = 0; k < 3; k++) {
        BRIO_TRY(next_word(t, &more));
        const char *p = more ? t->at : "";
        if (!brio_parse_number(&p, &point[k]) || !ends_word(p)) return brio_text_expected(t, "a coordinate");
        t->at += p - t->at;
    }
    BRIO_TRY(brio_builder_vertex(b, point));
done:
    return status;
}

/* Reads a corner v, v/vt, v//vn or v/vt/vn. v counts from 1, or backwards: -1 is the last vertex before this
 * statement. */
static brio_status read_corner(brio_text *t, brio_builder *b) {
    const char *p = t->at;
    bool backwards = *p == '-';
    uint64_t number;
    p += backwards;
    if (!brio_parse_count(&p, &number) || (*p != '/' && !ends_word(p)))
        return brio_text_expected(t, "a corner such as 7, 7/1, 7//2 or 7/1/2");
    while (!ends_word(p)) p++;
    t->at += p - t->at;
    double first = backwards ? (double)b->mesh->num_vertices - (double)number : (double)number - 1;
    return brio_builder_corner(b, first);
}

static brio_status read_face(brio_text *t, brio_builder *b) {
    brio_status status = BRIO_OK;
    bool more;
    for (;;) {
        BRIO_TRY(next_word(t, &more));
        if (!more) return brio_builder_face(b);
        BRIO_TRY(read_corner(t, b));
    }
done:
    return status;
}

/* Skips a statement with the lines that continue it. */
static brio_status skip_statement(brio_text *t) {
    brio_status status = BRIO_OK;
    while (t->at && *t->at && t->at[strlen(t->at) - 1] == '\\') BRIO_TRY(continue_line(t));
done:
    return status;
}

static bool is_statement(const char *at, char key) {
    return at[0] == key && (brio_is_blank(at[1]) || at[1] == '\\');
}

brio_status brio_obj_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_text t = {s, '#', NULL};
    b->index_base = 1;
    for (;;) {
        BRIO_TRY(brio_text_next_line(&t));
        if (!t.at) break;
        bool vertex = is_statement(t.at, 'v'), face = is_statement(t.at, 'f');
        if (vertex || face) t.at++;
        if (vertex) BRIO_TRY(read_vertex(&t, b));
        if (face) BRIO_TRY(read_face(&t, b));
        BRIO_TRY(skip_statement(&t));
    }
done:
    return status;
}

brio_status brio_obj_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    BRIO_TRY(brio_output_comment(out, "# ", job->options->comment));
    for (size_t v = 0; v < m->num_vertices; v++) {
        BRIO_TRY(brio_output_string(out, "v "));
        BRIO_TRY(brio_output_point(out, m->vertices + 3 * v));
        BRIO_TRY(brio_output_string(out, "\n"));
    }
    for (size_t f = 0; f < m->num_faces; f++) {
        BRIO_TRY(brio_output_string(out, "f"));
        for (uint64_t i = m->face_offsets[f]; i < m->face_offsets[f + 1]; i++)
            BRIO_TRY(brio_output_integer(out, ' ', (int64_t)m->face_vertices[i] + 1));
        BRIO_TRY(brio_output_string(out, "\n"));
    }
done:
    return status;
}
