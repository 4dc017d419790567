/* Points as rows of numbers: .xyz .pts .txt .csv.
 *
 * Fields are separated by blanks, or by a comma or semicolon with blanks around it. Between two commas is an empty
 * field. Comments begin with #, % or // and end with the line; a ; at the start of a line begins a comment, too. A line
 * of names before the first row, plain or as a comment, names the columns and gives the places of x, y and z. A column
 * becomes a property if the first row has a number (or nothing) in it and no row lacks it. A single number before the
 * first row is the number of rows. */
#include "base/memory.h"
#include "io/number.h"
#include "io/row_format.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef enum { FIELD_NUMBER, FIELD_EMPTY, FIELD_WORD } field_kind;

typedef struct {
    field_kind kind;
    double value;     /* NaN if the field is empty */
    const char *word; /* its place in the line */
    size_t length;
} field;

typedef enum { COLUMN_IGNORED, COLUMN_AXIS, COLUMN_PROPERTY } column_role;

typedef struct {
    column_role role;
    size_t target; /* axis, or index of the property */
    bool missing;  /* whether some row lacks it */
} column;

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    field *fields; /* the fields of the last line */
    size_t num_fields, field_capacity;
    char (*names)[64];
    size_t num_names, name_capacity;
    bool plain_names; /* the names are no comment: they hold for any number of columns */
    column *columns;
    size_t num_columns;
    size_t axes[3]; /* columns of x, y, z */
    bool counted;   /* whether the first line announced a number of rows */
    uint64_t promised;
    size_t count_line;
} xyz_reader;

/* --- lines to fields --- */

static bool starts_comment(const char *p) {
    return *p == '#' || *p == '%' || (*p == '/' && p[1] == '/');
}

static bool ends_field(const char *p) {
    return !*p || brio_is_blank(*p) || *p == ',' || *p == ';' || starts_comment(p);
}

/* Reads the field at p, which is neither a blank nor the end of the line. Returns the place behind the field. */
static const char *scan_field(const char *p, field *f) {
    *f = (field){FIELD_EMPTY, (double)NAN, p, 0};
    if (*p == ',' || *p == ';') return p;
    const char *end = p;
    if (brio_parse_number(&end, &f->value) && ends_field(end)) {
        f->kind = FIELD_NUMBER;
        return end;
    }
    f->kind = FIELD_WORD;
    end = p;
    if (*p == '"') {
        for (end++; *end && *end != '"'; end++) {}
        if (*end) end++;
    }
    while (!ends_field(end)) end++;
    f->length = (size_t)(end - p);
    return end;
}

static brio_status add_field(xyz_reader *r, field f) {
    brio_status status = BRIO_RESERVE(r->stream->ctx, r->fields, r->field_capacity, r->num_fields + 1);
    if (status == BRIO_OK) r->fields[r->num_fields++] = f;
    return status;
}

/* Splits a line into fields. A comma at the end of the line is followed by an empty field if there is a column for it;
 * otherwise it means nothing. */
static brio_status split_fields(xyz_reader *r, const char *p) {
    brio_status status = BRIO_OK;
    field f;
    bool comma = false;
    r->num_fields = 0;
    for (;;) {
        while (brio_is_blank(*p)) p++;
        if (!*p || starts_comment(p)) break;
        p = scan_field(p, &f);
        BRIO_TRY(add_field(r, f));
        while (brio_is_blank(*p)) p++;
        comma = *p == ',' || *p == ';';
        p += comma;
    }
    size_t columns = r->num_columns ? r->num_columns : r->plain_names ? r->num_names : 0;
    if (comma && r->num_fields < columns) BRIO_TRY(add_field(r, (field){FIELD_EMPTY, (double)NAN, p, 0}));
done:
    return status;
}

/* --- names of columns --- */

static void copy_name(char name[64], const field *f) {
    const char *word = f->word;
    size_t length = f->length;
    if (length > 1 && word[0] == '"' && word[length - 1] == '"') {
        word++;
        length -= 2;
    }
    if (length > 63) length = 63;
    memcpy(name, word, length);
    name[length] = 0;
}

/* Joins words that no comma separates: in a line with commas, names can contain blanks. */
static void join_words(xyz_reader *r) {
    size_t kept = 0;
    for (size_t i = 0; i < r->num_fields; i++) {
        field *f = &r->fields[i], *last = kept ? &r->fields[kept - 1] : NULL;
        const char *gap = last ? last->word + last->length : NULL;
        bool joined =
            last && last->kind == FIELD_WORD && f->kind == FIELD_WORD && strcspn(gap, ",;") >= (size_t)(f->word - gap);
        if (joined)
            last->length = (size_t)(f->word - last->word) + f->length;
        else
            r->fields[kept++] = *f;
    }
    r->num_fields = kept;
}

static brio_status keep_names(xyz_reader *r, bool plain) {
    brio_status status = BRIO_OK;
    if (r->num_fields && strpbrk(r->fields[0].word, ",;")) join_words(r);
    BRIO_TRY(BRIO_RESERVE(r->stream->ctx, r->names, r->name_capacity, r->num_fields));
    for (size_t i = 0; i < r->num_fields; i++) copy_name(r->names[i], &r->fields[i]);
    r->num_names = r->num_fields;
    r->plain_names = plain;
done:
    return status;
}

static size_t find_name(const xyz_reader *r, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcasecmp(r->names[i], name)) return i;
    return SIZE_MAX;
}

static bool find_axes(const xyz_reader *r, size_t count, size_t axes[3]) {
    static const char *const names[] = {"x", "y", "z"};
    for (int k = 0; k < 3; k++) {
        axes[k] = find_name(r, count, names[k]);
        if (axes[k] == SIZE_MAX) return false;
    }
    return true;
}

/* Reads a comment before the first row as a line of names if x, y and z are among its words. */
static brio_status try_comment(xyz_reader *r, const char *comment) {
    brio_status status = BRIO_OK;
    size_t axes[3];
    if (r->num_columns || r->plain_names) return BRIO_OK;
    comment += strspn(comment, "#/;% \t");
    BRIO_TRY(split_fields(r, comment));
    for (size_t i = 0; i < r->num_fields; i++)
        if (r->fields[i].kind != FIELD_WORD) return BRIO_OK;
    BRIO_TRY(keep_names(r, false));
    if (!find_axes(r, r->num_names, axes)) r->num_names = 0;
done:
    return status;
}

/* --- columns, from the names and the first row --- */

static brio_status add_property(xyz_reader *r, size_t i) {
    char name[64] = "";
    if (i < r->num_names) strcpy(name, r->names[i]);
    bool axis = strlen(name) == 1 && strchr("xyzXYZ", name[0]);
    if (!name[0] || axis || brio_mesh_property(r->builder->mesh, name)) snprintf(name, sizeof name, "column%zu", i + 1);
    r->columns[i].role = COLUMN_PROPERTY;
    r->columns[i].target = r->builder->mesh->num_properties;
    return brio_builder_property(r->builder, name, BRIO_SCALAR_FLOAT64);
}

static brio_status plan_columns(xyz_reader *r) {
    brio_status status = BRIO_OK;
    size_t found = r->num_fields;
    if (!r->plain_names && r->num_names != found) r->num_names = 0;
    size_t count = r->num_names > found ? r->num_names : found;
    BRIO_TRY(BRIO_ALLOC_ZERO(r->stream->ctx, r->columns, count));
    r->num_columns = count;
    bool named = find_axes(r, r->num_names, r->axes);
    for (size_t k = 0; k < 3; k++) {
        if (!named) r->axes[k] = k;
        r->columns[r->axes[k]] = (column){COLUMN_AXIS, k, false};
    }
    for (size_t i = 0; i < found; i++)
        if (r->columns[i].role == COLUMN_IGNORED && r->fields[i].kind != FIELD_WORD) BRIO_TRY(add_property(r, i));
done:
    return status;
}

/* --- rows --- */

static brio_status bad_field(const xyz_reader *r, size_t i) {
    const field *f = &r->fields[i];
    brio_stream *s = r->stream;
    if (f->kind == FIELD_EMPTY)
        return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: column %zu is empty, expected a number", s->name,
                         s->line, i + 1);
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected a number, found \"%s\"", s->name, s->line,
                     brio_excerpt_of(f->word).text);
}

static brio_status read_point(xyz_reader *r, double point[3]) {
    brio_stream *s = r->stream;
    for (int k = 0; k < 3; k++) {
        size_t i = r->axes[k];
        if (i >= r->num_fields)
            return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s numbers, found %zu", s->name, s->line,
                             i < 3 ? "3" : "more", r->num_fields);
        if (r->fields[i].kind != FIELD_NUMBER) return bad_field(r, i);
        point[k] = r->fields[i].value;
    }
    return BRIO_OK;
}

static brio_status read_row(xyz_reader *r) {
    brio_status status = BRIO_OK;
    double point[3];
    BRIO_TRY(read_point(r, point));
    BRIO_TRY(brio_builder_vertex(r->builder, point));
    brio_mesh *mesh = r->builder->mesh;
    for (size_t i = 0; i < r->num_columns; i++) {
        column *c = &r->columns[i];
        if (c->role != COLUMN_PROPERTY) continue;
        if (i >= r->num_fields) {
            c->missing = true;
            continue;
        }
        if (r->fields[i].kind == FIELD_WORD) return bad_field(r, i);
        ((double *)mesh->properties[c->target].data)[mesh->num_vertices - 1] = r->fields[i].value;
    }
done:
    return status;
}

static size_t count_words(const xyz_reader *r) {
    size_t words = 0;
    for (size_t i = 0; i < r->num_fields; i++) words += r->fields[i].kind != FIELD_NUMBER;
    return words;
}

/* Reads a line before the first row: names, the number of rows, or the first row itself. */
static brio_status read_first(xyz_reader *r) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    double first = r->fields[0].value;
    if (r->num_fields == 1 && !r->counted && !r->num_names && first >= 0 && first < 0x1p53 && first == floor(first)) {
        r->counted = true;
        r->promised = (uint64_t)first;
        r->count_line = s->line;
        return BRIO_OK;
    }
    BRIO_REQUIRE(s->ctx, r->num_fields >= 3, BRIO_ERR_FORMAT, "%s: line %zu: expected 3 numbers, found %zu", s->name,
                 s->line, r->num_fields - count_words(r));
    if (!r->plain_names && count_words(r) == r->num_fields) return keep_names(r, true);
    BRIO_TRY(plan_columns(r));
    BRIO_TRY(read_row(r));
done:
    return status;
}

static brio_status read_line(xyz_reader *r, const char *line) {
    brio_status status = BRIO_OK;
    while (brio_is_blank(*line)) line++;
    if (!*line) return BRIO_OK;
    if (*line == ';' || starts_comment(line)) return try_comment(r, line);
    BRIO_TRY(split_fields(r, line));
    BRIO_TRY(r->num_columns ? read_row(r) : read_first(r));
done:
    return status;
}

static void drop_missing(xyz_reader *r) {
    for (size_t i = r->num_columns; i-- > 0;)
        if (r->columns[i].role == COLUMN_PROPERTY && r->columns[i].missing)
            brio_builder_drop_property(r->builder, r->columns[i].target);
}

brio_status brio_xyz_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    xyz_reader r = {.stream = s, .builder = b};
    char *line;
    brio_builder_stream(b, BRIO_COUNT_UNKNOWN);
    for (;;) {
        BRIO_TRY(brio_stream_line(s, &line));
        if (!line) break;
        BRIO_TRY(read_line(&r, line));
    }
    BRIO_REQUIRE(s->ctx, !r.counted || r.promised == brio_builder_count(b), BRIO_ERR_FORMAT,
                 "%s: line %zu: promises %" PRIu64 " points, %" PRIu64 " rows follow", s->name, r.count_line,
                 r.promised, brio_builder_count(b));
    drop_missing(&r);
done:
    brio_release(s->ctx, r.fields);
    brio_release(s->ctx, r.names);
    brio_release(s->ctx, r.columns);
    return status;
}

/* --- writing --- */

static bool wants_commas(const char *path) {
    size_t length = strlen(path);
    return length >= 4 && !strcasecmp(path + length - 4, ".csv");
}

static brio_status write_names(brio_output *out, const brio_write_job *job, char separator) {
    brio_status status = BRIO_OK;
    /* spreadsheets read a line that begins with # as data */
    BRIO_TRY(brio_output_format(out, "%sx%cy%cz", separator == ',' ? "" : "# ", separator, separator));
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        BRIO_TRY(brio_output_format(out, "%c%s", separator, job->names[i]));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    (void)state;
    BRIO_TRY(brio_output_comment(out, "# ", job->options->comment));
    BRIO_TRY(write_names(out, job, wants_commas(out->name) ? ',' : ' '));
done:
    return status;
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    char separator = wants_commas(out->name) ? ',' : ' ';
    (void)state;
    for (size_t v = 0; v < m->num_vertices; v++) {
        for (int k = 0; k < 3; k++)
            BRIO_TRY(brio_output_double(out, k ? separator : 0, m->vertices[3 * v + (size_t)k]));
        for (size_t i = 0; i < m->num_properties; i++)
            BRIO_TRY(brio_output_scalar(out, separator, &m->properties[i], v));
        BRIO_TRY(brio_output_string(out, "\n"));
    }
done:
    return status;
}

const brio_row_format brio_xyz_rows = {.begin = begin, .rows = write_rows};
