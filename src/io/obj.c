/* Wavefront OBJ: reads vertices with their colours, their normals, and faces; writes the same.
 *
 * A vertex may have a colour behind its coordinates, as most programs write it, or in the comments #MRGB of ZBrush,
 * which follow the vertices. Colours go from 0 to 1; a file with one beyond 1 has bytes. A vertex without a colour
 * beside others that have one is white.
 *
 * Normals belong to corners. They become nx, ny, nz of the vertices where all corners at a vertex have one normal. In a
 * file without faces normal i is that of vertex i. Whatever else is in the file is named as left out.
 *
 * Based on: Wavefront Technologies. Object files (.obj). Advanced Visualizer Manual, appendix B1. */
#include "base/memory.h"
#include "io/colour.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/textrow.h"
#include <math.h>
#include <string.h>
#include <strings.h>

/* UNSET, SEVERAL: in the place of a vertex's normal. MOST_EXTRA: numbers behind x, y, z. NO_COLOUR: chosen. */
enum { UNSET = 0, SEVERAL = UINT32_MAX, MOST_EXTRA = 4, NO_COLOUR = -1 };

typedef struct {
    brio_text text;
    brio_builder *builder;
    size_t colour;      /* the property red, behind which are green and blue, */
    bool coloured;      /* if some vertex has a colour */
    double *normals;    /* three numbers each */
    size_t num_normals; /* of the statements vn */
    size_t normal_capacity;
    uint32_t *normal_of; /* of each vertex: UNSET, SEVERAL, or the index of a normal plus 1 */
    size_t num_known, known_capacity;
    uint8_t *painted; /* mask, red, green, blue of each entry of #MRGB */
    size_t num_painted, painted_capacity;
} obj_reader;

/* --- lines and words --- */

/* Reads the line that continues the current one. */
static brio_status continue_line(brio_text *t) {
    brio_status status = brio_stream_line(t->stream, &t->at);
    char *comment = status == BRIO_OK && t->at ? strchr(t->at, t->comment) : NULL;
    if (comment) *comment = 0;
    return status;
}

/* Moves to the next word of the statement, across a backslash at the end of a line. */
static brio_status next_word(brio_text *t, bool *more) {
    for (;;) {
        *more = brio_text_more(t);
        if (!*more || t->at[0] != '\\' || *brio_skip_blanks(t->at + 1)) return BRIO_OK;
        BRIO_FORWARD(continue_line(t));
    }
    return BRIO_OK;
}

static bool ends_word(const char *p) {
    return !*p || brio_is_blank(*p) || (*p == '\\' && !*brio_skip_blanks((char *)p + 1));
}

/* Reads numbers up to the end of the statement, `most` at most. */
static brio_status read_numbers(brio_text *t, size_t most, double *values, size_t *count) {
    bool more;
    for (*count = 0; *count < most; ++*count) {
        BRIO_FORWARD(next_word(t, &more));
        if (!more) return BRIO_OK;
        const char *p = t->at;
        if (!brio_parse_number(&p, &values[*count]) || !ends_word(p)) return brio_text_expected(t, "a coordinate");
        t->at += p - t->at;
    }
    return BRIO_OK;
}

/* --- colours --- */

/* Adds the properties of colours. Vertices before the first one with a colour have none yet. */
static brio_status begin_colours(obj_reader *r) {
    static const char *const names[] = {"red", "green", "blue"};
    brio_mesh *m = r->builder->mesh;
    r->colour = m->num_properties;
    for (size_t k = 0; k < 3; k++) {
        BRIO_FORWARD(brio_builder_property(r->builder, names[k], BRIO_SCALAR_FLOAT64));
        for (size_t v = 0; v < m->num_vertices; v++) ((double *)m->properties[r->colour + k].data)[v] = NO_COLOUR;
    }
    r->coloured = true;
    return BRIO_OK;
}

/* Turns whole numbers of 0 to 255 into bytes, so that no reader of the mesh has to guess. */
static brio_status make_bytes(obj_reader *r) {
    brio_mesh *m = r->builder->mesh;
    for (size_t k = 0; k < 3; k++) {
        brio_property *p = &m->properties[r->colour + k];
        uint8_t *bytes = NULL;
        brio_status status = BRIO_ALLOC(r->builder->ctx, bytes, m->num_vertices + 1);
        if (status != BRIO_OK) return status;
        for (size_t v = 0; v < m->num_vertices; v++) bytes[v] = (uint8_t)((double *)p->data)[v];
        brio_release(r->builder->ctx, p->data);
        p->data = bytes;
        p->type = BRIO_SCALAR_UINT8;
    }
    strcpy(r->builder->version, "colours of 0 to 255");
    return BRIO_OK;
}

/* Finds out over all vertices whether colours are bytes, and makes vertices without a colour white. */
static brio_status end_colours(obj_reader *r) {
    brio_mesh *m = r->builder->mesh;
    double most = 0;
    bool whole = true;
    if (!r->coloured) return BRIO_OK;
    for (size_t k = 0; k < 3; k++)
        for (size_t v = 0; v < m->num_vertices; v++)
            most = fmax(most, ((double *)m->properties[r->colour + k].data)[v]);
    for (size_t k = 0; k < 3; k++)
        for (size_t v = 0; v < m->num_vertices; v++) {
            double *x = (double *)m->properties[r->colour + k].data + v;
            if (*x == NO_COLOUR) *x = most > 1 ? 255 : 1;
            whole &= *x >= 0 && *x <= 255 && *x == floor(*x);
        }
    return most > 1 && whole ? make_bytes(r) : BRIO_OK;
}

static int digit_of(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Takes the entries of a comment #MRGB: eight digits each, of mask, red, green and blue. */
static brio_status read_painted(obj_reader *r, const char *digits) {
    size_t length = strspn(digits, "0123456789abcdefABCDEF") / 8 * 8;
    BRIO_FORWARD(BRIO_RESERVE(r->builder->ctx, r->painted, r->painted_capacity, r->num_painted + length / 2));
    for (size_t i = 0; i < length; i += 2)
        r->painted[r->num_painted++] = (uint8_t)(digit_of(digits[i]) << 4 | digit_of(digits[i + 1]));
    return BRIO_OK;
}

/* Ends the colours. The colours of #MRGB are those of the vertices if there are as many. */
static brio_status end_painted(obj_reader *r) {
    static const char *const names[] = {"red", "green", "blue"};
    brio_mesh *m = r->builder->mesh;
    bool masked = false;
    if (!r->num_painted) return BRIO_OK;
    if (r->coloured || r->num_painted != 4 * m->num_vertices) return brio_builder_leave_out(r->builder, "#MRGB");
    for (size_t v = 0; v < m->num_vertices; v++) masked |= r->painted[4 * v] != 255;
    if (masked) BRIO_FORWARD(brio_builder_leave_out(r->builder, "mask of #MRGB"));
    for (size_t k = 0; k < 3; k++) {
        BRIO_FORWARD(brio_builder_property(r->builder, names[k], BRIO_SCALAR_UINT8));
        uint8_t *target = m->properties[m->num_properties - 1].data;
        for (size_t v = 0; v < m->num_vertices; v++) target[v] = r->painted[4 * v + 1 + k];
    }
    return BRIO_OK;
}

/* --- vertices and normals --- */

static brio_status read_vertex(obj_reader *r) {
    double values[3 + MOST_EXTRA];
    size_t count;
    BRIO_FORWARD(read_numbers(&r->text, 3 + MOST_EXTRA, values, &count));
    if (count < 3) return brio_text_expected(&r->text, "a coordinate");
    const double *colour = count == 6 || count == 7 ? values + 3 : NULL;
    if (count == 4 && values[3] != 1) BRIO_FORWARD(brio_builder_leave_out(r->builder, "weights of vertices"));
    if (count == 5) BRIO_FORWARD(brio_builder_leave_out(r->builder, "numbers behind the coordinates"));
    if (count == 7 && values[6] != 1) BRIO_FORWARD(brio_builder_leave_out(r->builder, "alpha"));
    if (colour && !r->coloured) BRIO_FORWARD(begin_colours(r));
    BRIO_FORWARD(brio_builder_vertex(r->builder, values));
    brio_mesh *m = r->builder->mesh;
    for (size_t k = 0; r->coloured && k < 3; k++)
        ((double *)m->properties[r->colour + k].data)[m->num_vertices - 1] = colour ? colour[k] : NO_COLOUR;
    return BRIO_OK;
}

static brio_status read_normal(obj_reader *r) {
    size_t count;
    BRIO_FORWARD(BRIO_RESERVE(r->builder->ctx, r->normals, r->normal_capacity, 3 * r->num_normals + 3));
    BRIO_FORWARD(read_numbers(&r->text, 3, r->normals + 3 * r->num_normals, &count));
    if (count < 3) return brio_text_expected(&r->text, "a coordinate");
    r->num_normals++;
    return BRIO_OK;
}

static bool same_normal(const obj_reader *r, uint32_t a, uint32_t b) {
    return !memcmp(r->normals + 3 * (a - 1), r->normals + 3 * (b - 1), 3 * sizeof *r->normals);
}

/* Notes the normal that a corner gives to its vertex.   normal  counts from 1 */
static brio_status note_normal(obj_reader *r, double vertex, uint64_t normal) {
    size_t before = r->num_known;
    bool known = vertex >= 0 && vertex < (double)r->builder->mesh->num_vertices && normal && normal <= r->num_normals &&
                 normal < SEVERAL;
    if (!known) return brio_builder_leave_out(r->builder, "normals of corners"); /* of what comes later in the file */
    size_t v = (size_t)vertex;
    BRIO_FORWARD(BRIO_RESERVE(r->builder->ctx, r->normal_of, r->known_capacity, v + 1));
    for (; r->num_known <= v; r->num_known++) r->normal_of[r->num_known] = UNSET;
    uint32_t *mine = &r->normal_of[v], given = (uint32_t)normal;
    if (v >= before || *mine == UNSET)
        *mine = given;
    else if (*mine != SEVERAL && *mine != given && !same_normal(r, *mine, given))
        *mine = SEVERAL;
    return BRIO_OK;
}

/* Gives each vertex its normal, 0 to those without a corner. */
static brio_status end_normals(obj_reader *r) {
    static const char *const names[] = {"nx", "ny", "nz"};
    brio_mesh *m = r->builder->mesh;
    bool each = !m->num_faces && r->num_normals == m->num_vertices, one = r->num_known || each;
    if (!r->num_normals) return BRIO_OK;
    for (size_t v = 0; v < r->num_known; v++) one &= r->normal_of[v] != SEVERAL;
    if (!one) return brio_builder_leave_out(r->builder, "normals of corners");
    for (size_t k = 0; k < 3; k++) {
        BRIO_FORWARD(brio_builder_property(r->builder, names[k], BRIO_SCALAR_FLOAT64));
        double *target = m->properties[m->num_properties - 1].data;
        for (size_t v = 0; v < m->num_vertices; v++) {
            size_t normal = each ? v + 1 : v < r->num_known ? r->normal_of[v] : UNSET;
            target[v] = normal == UNSET ? 0 : r->normals[3 * (normal - 1) + k];
        }
    }
    return BRIO_OK;
}

/* --- faces --- */

/* Reads the index at *p of `count` items: it counts from 1, or backwards: -1 is the last item before this statement.
 * Returns it counted from 0; negative: there is no such item. */
static bool scan_index(const char **p, size_t count, double *index) {
    bool backwards = **p == '-';
    uint64_t number;
    const char *digits = *p + backwards;
    if (!brio_parse_count(&digits, &number)) return false;
    *p = digits;
    *index = backwards ? (double)count - (double)number : (double)number - 1;
    return true;
}

/* Reads a corner v, v/vt, v//vn or v/vt/vn. */
static brio_status read_corner(obj_reader *r) {
    brio_text *t = &r->text;
    const char *p = t->at;
    double vertex, normal;
    if (!scan_index(&p, r->builder->mesh->num_vertices, &vertex) || (*p != '/' && !ends_word(p)))
        return brio_text_expected(t, "a corner such as 7, 7/1, 7//2 or 7/1/2");
    if (*p == '/')
        for (p++; *p != '/' && !ends_word(p);) p++;
    bool has_normal = *p == '/' && (p++, scan_index(&p, r->num_normals, &normal));
    while (!ends_word(p)) p++;
    t->at += p - t->at;
    BRIO_FORWARD(brio_builder_corner(r->builder, vertex));
    if (has_normal) BRIO_FORWARD(note_normal(r, vertex, normal >= 0 ? (uint64_t)normal + 1 : 0));
    return BRIO_OK;
}

static brio_status read_face(obj_reader *r) {
    bool more;
    for (;;) {
        BRIO_FORWARD(next_word(&r->text, &more));
        if (!more) return brio_builder_face(r->builder);
        BRIO_FORWARD(read_corner(r));
    }
    return BRIO_OK;
}

/* --- the file --- */

/* Skips a statement with the lines that continue it. */
static brio_status skip_statement(brio_text *t) {
    while (t->at && *t->at && t->at[strlen(t->at) - 1] == '\\') BRIO_FORWARD(continue_line(t));
    return BRIO_OK;
}

static bool is_statement(const char *at, const char *key) {
    size_t length = strlen(key);
    return !strncmp(at, key, length) && (!at[length] || brio_is_blank(at[length]) || at[length] == '\\');
}

/* Names a statement that is not read. */
static brio_status name_left_out(obj_reader *r) {
    static const char *const known[][2] = {{"vt", "texture coordinates"},
                                           {"l", "lines"},
                                           {"usemtl", "materials"},
                                           {"mtllib", "materials"},
                                           {"usemap", "textures"},
                                           {"maplib", "textures"},
                                           {"g", "groups"},
                                           {"o", "objects"},
                                           {"s", "smoothing groups"},
                                           {"mg", "merging groups"},
                                           {"vp", "free-form geometry"},
                                           {"curv", "free-form geometry"},
                                           {"curv2", "free-form geometry"},
                                           {"surf", "free-form geometry"}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (is_statement(r->text.at, known[i][0])) {
            /* "s off", "s 0" and "g" of no name say that there is none */
            const char *word = brio_skip_blanks(r->text.at + strlen(known[i][0]));
            bool none = !*word || (*known[i][0] == 's' && (!strcmp(word, "0") || !strcmp(word, "off")));
            return none ? BRIO_OK : brio_builder_leave_out(r->builder, known[i][1]);
        }
    return BRIO_OK;
}

/* Moves to the next statement. text.at becomes NULL at the end of the file. */
static brio_status next_statement(obj_reader *r) {
    brio_text *t = &r->text;
    do {
        BRIO_FORWARD(brio_stream_line(t->stream, &t->at));
        if (!t->at) return BRIO_OK;
        t->at = brio_skip_blanks(t->at);
        if (!strncmp(t->at, "#MRGB ", 6)) BRIO_FORWARD(read_painted(r, brio_skip_blanks(t->at + 6)));
        char *comment = strchr(t->at, t->comment);
        if (comment) *comment = 0;
        for (size_t end = strlen(t->at); end && brio_is_blank(t->at[end - 1]);) t->at[--end] = 0;
    } while (!*t->at);
    return BRIO_OK;
}

static brio_status read_statements(obj_reader *r) {
    brio_text *t = &r->text;
    for (;;) {
        BRIO_FORWARD(next_statement(r));
        if (!t->at) return BRIO_OK;
        bool vertex = is_statement(t->at, "v"), face = is_statement(t->at, "f") || is_statement(t->at, "fo"),
             normal = is_statement(t->at, "vn");
        if (!vertex && !face && !normal) BRIO_FORWARD(name_left_out(r));
        if (vertex || face || normal)
            while (*t->at && !brio_is_blank(*t->at) && *t->at != '\\') t->at++;
        if (vertex) BRIO_FORWARD(read_vertex(r));
        if (face) BRIO_FORWARD(read_face(r));
        if (normal) BRIO_FORWARD(read_normal(r));
        BRIO_FORWARD(skip_statement(t));
    }
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    obj_reader r = {.text = {s, '#', NULL}, .builder = b};
    b->index_base = 1;
    BRIO_TRY(read_statements(&r));
    BRIO_TRY(end_colours(&r));
    BRIO_TRY(end_painted(&r));
    BRIO_TRY(end_normals(&r));
done:
    brio_release(s->ctx, r.normals);
    brio_release(s->ctx, r.normal_of);
    brio_release(s->ctx, r.painted);
    return status;
}

/* --- writing --- */

static brio_status write_vertices(brio_output *out, const brio_mesh *m, const brio_channels *colour) {
    for (size_t v = 0; v < m->num_vertices; v++) {
        BRIO_FORWARD(brio_output_string(out, "v "));
        BRIO_FORWARD(brio_output_point(out, m->vertices + 3 * v));
        for (int k = 0; k < colour->count && k < 3; k++) BRIO_FORWARD(brio_output_scalar(out, ' ', colour->of[k], v));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static brio_status write_normals(brio_output *out, const brio_mesh *m, const brio_channels *normal) {
    for (size_t v = 0; v < m->num_vertices && normal->count; v++) {
        BRIO_FORWARD(brio_output_string(out, "vn"));
        for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_output_scalar(out, ' ', normal->of[k], v));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static brio_status write_file(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh;
    brio_channels colour = brio_colour_of(m), normal = brio_normal_of(m);
    BRIO_FORWARD(brio_output_comment(out, "# ", job->options->comment));
    BRIO_FORWARD(write_vertices(out, m, &colour));
    BRIO_FORWARD(write_normals(out, m, &normal));
    for (size_t f = 0; f < m->num_faces; f++) {
        BRIO_FORWARD(brio_output_string(out, "f"));
        for (uint64_t i = m->face_offsets[f]; i < m->face_offsets[f + 1]; i++) {
            int64_t corner = (int64_t)m->face_vertices[i] + 1;
            BRIO_FORWARD(brio_output_integer(out, ' ', corner));
            if (normal.count) BRIO_FORWARD(brio_output_string(out, "//"));
            if (normal.count) BRIO_FORWARD(brio_output_integer(out, 0, corner));
        }
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

const brio_codec brio_obj_codec = {.read = read_file, .write = write_file};
