/* Reads points as rows of numbers: .xyz .pts .txt .csv .asc .xyzrgb .xyzn .tsv .dat.
 *
 * A line of names before the first row, plain or as a comment, names the columns and gives the places of x, y and z;
 * names that the caller gives stand in its place. Without names the first three columns are x, y, z. Plain names that
 * do not say which are x, y and z are an error: the first column may be a number of the point. A column becomes a
 * property if the first row has no word in it, or one for a missing number. A single number before the first row is the
 * number of rows; another one behind these rows is that of a further block. A ; at the start of a line begins a
 * comment, too.
 *
 * Columns without names have those that the extension gives them: .pts has an intensity, a colour, or both, .xyzrgb a
 * colour, .xyzn a normal. A line "sep=;" comes first where Excel is told the separator. Where single tabs separate the
 * names, two tabs in a row have an empty field between them. The points3D.txt of COLMAP has columns behind those that
 * its comment names, which are left out. */
#include "base/memory.h"
#include "base/utf8.h"
#include "io/formats.h"
#include "io/limits.h"
#include "io/number.h"
#include "io/builder.h"
#include "io/text/text_fields.h"
#include "io/textrow.h"
#include <ctype.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef enum { COLUMN_IGNORED, COLUMN_AXIS, COLUMN_PROPERTY } column_role;

typedef struct {
    column_role role;
    size_t target; /* axis, or index of the property */
} column;

typedef enum { NAMES_NONE, NAMES_COMMENT, NAMES_PLAIN, NAMES_GIVEN /* by the caller */ } names_source;

typedef struct {
    char (*at)[64];
    size_t count, capacity;
} name_list;

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    brio_fields fields; /* of the last line */
    name_list names, tried;
    names_source source;
    size_t name_line;
    bool header_passed; /* names are given, and the file's own line of names was passed over */
    column *columns;
    size_t num_columns;
    size_t axes[3]; /* columns of x, y, z; NO_COLUMN for the z of a flat text */
    bool counted;   /* whether the first line announced a number of rows */
    uint64_t promised;
    size_t count_line;
    bool tabs;               /* whether every tab separates two fields */
    bool tracks;             /* whether columns without names follow the named ones */
    uint64_t there, lacking; /* fields of all rows, and columns that rows lack */
    char shown[2][64];       /* the beginnings of the first lines, for messages */
    int num_shown;
    bool may_be_numbered; /* whether x may number the rows: no names, a column that is no axis, whole numbers so far */
    double least;         /* x of these rows */
    uint64_t found[3], due[3]; /* sums of powers 1 to 3, modulo 2^64, of x, and of 0, 1, 2 and so on */
} xyz_reader;

enum { NO_COLUMN = INT_MAX };

/* --- messages --- */

static const char several_columns[] = "several columns have a name of x, y or z";
static const char angles_are_no_lengths[] =
    "latitude and longitude are angles, not lengths (project the points first), or else";

static void show_line(xyz_reader *r, const char *line) {
    char *to = r->shown[r->num_shown++];
    size_t n = 0;
    for (; line[n] && n + 1 < sizeof *r->shown; n++)
        to[n] = (unsigned char)line[n] < ' ' || line[n] == '"' ? ' ' : line[n];
    to[n] = 0;
}

/* Returns the error of names that do not give x, y and z.   why  what is wrong with them. */
static brio_status unclear_columns(const xyz_reader *r, const char *why) {
    const brio_stream *s = r->stream;
    return brio_fail(
        s->ctx, BRIO_ERR_FORMAT,
        "%s: line %zu: %s: name the columns in their order (--columns x,y,z,-: - leaves one out); the file "
        "begins \"%s\"%s%s%s",
        s->name, r->name_line, why, r->shown[0], r->num_shown > 1 ? ", \"" : "", r->num_shown > 1 ? r->shown[1] : "",
        r->num_shown > 1 ? "\"" : "");
}

static brio_status bad_field(const xyz_reader *r, size_t i) {
    const brio_field *f = &r->fields.at[i];
    brio_stream *s = r->stream;
    if (f->kind == BRIO_FIELD_EMPTY)
        return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: column %zu is empty, expected a number", s->name,
                         s->line, i + 1);
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected a number, found \"%s\"", s->name, s->line,
                     brio_excerpt_of(f->word).text);
}

/* --- names of columns --- */

static void copy_name(char name[64], const brio_field *f) {
    char bytes[64 + 3]; /* with the rest of a character that does not fit */
    const char *word = f->word;
    size_t length = f->length;
    if (length > 1 && word[0] == '"' && word[length - 1] == '"') {
        word++;
        length -= 2;
    }
    if (length >= sizeof bytes) length = sizeof bytes - 1;
    memcpy(bytes, word, length);
    bytes[length] = 0;
    brio_utf8_copy(name, 64, bytes);
}

/* Finds x, y and z among names. Those of a flat text may have no height. */
static brio_axes_result axes_of(const xyz_reader *r, const name_list *list, size_t axes[3]) {
    const char(*names)[64] = (const char(*)[64])list->at;
    brio_axes_result result = brio_axes_of_names(names, list->count, axes);
    if (result != BRIO_AXES_UNKNOWN || !r->builder->flat) return result;
    result = brio_pair_of_names(names, list->count, axes);
    axes[2] = NO_COLUMN;
    return result;
}

/* Takes the fields as names for a try. */
static brio_status try_names(xyz_reader *r, brio_axes_result *result, size_t axes[3]) {
    name_list *t = &r->tried;
    BRIO_FORWARD(BRIO_RESERVE(r->stream->ctx, t->at, t->capacity, r->fields.count));
    t->count = r->fields.count;
    for (size_t i = 0; i < t->count; i++) copy_name(t->at[i], &r->fields.at[i]);
    *result = axes_of(r, t, axes);
    return BRIO_OK;
}

static void keep_tried_names(xyz_reader *r, names_source source) {
    name_list names = r->tried;
    r->tried = r->names;
    r->names = names;
    r->source = source;
    r->name_line = r->stream->line;
}

static size_t count_words(const xyz_reader *r) {
    size_t words = 0;
    for (size_t i = 0; i < r->fields.count; i++) words += r->fields.at[i].kind != BRIO_FIELD_NUMBER;
    return words;
}

static bool are_first(const size_t axes[3]) {
    return axes[0] == 0 && axes[1] == 1 && axes[2] == 2;
}

/* Returns how many columns of points3D.txt have names: what follows is a list of images. */
static size_t find_tracks(const xyz_reader *r) {
    for (size_t i = 0; i < r->fields.count; i++)
        if (!strncmp(r->fields.at[i].word, "TRACK[]", 7)) return i;
    return r->fields.count;
}

/* Reads a comment before the first row as a line of names if x, y and z, or angles, are among its words. Behind x, y
 * and z a number is a name, too. */
static brio_status try_comment(xyz_reader *r, const char *comment) {
    brio_axes_result result;
    size_t axes[3];
    if (r->num_columns || r->source > NAMES_COMMENT) return BRIO_OK;
    BRIO_FORWARD(brio_fields_of_words(&r->fields, comment + strspn(comment, "#/;% \t")));
    size_t all = r->fields.count;
    r->fields.count = find_tracks(r);
    BRIO_FORWARD(try_names(r, &result, axes));
    bool words = count_words(r) == r->fields.count;
    if (!words && (result != BRIO_AXES_FOUND || !are_first(axes))) return BRIO_OK;
    bool clear = result == BRIO_AXES_FOUND || result == BRIO_AXES_ANGLES;
    bool first = result == BRIO_AXES_SEVERAL && r->source == NAMES_NONE;
    if (clear || first) keep_tried_names(r, NAMES_COMMENT);
    if (clear || first) r->tracks = r->fields.count < all;
    return BRIO_OK;
}

/* Returns whether the line before the first row is one of names: words alone, or words that give x, y and z. */
static brio_status try_plain_names(xyz_reader *r, bool *are_names) {
    brio_axes_result result;
    size_t words = count_words(r), count = r->fields.count, axes[3];
    *are_names = false;
    if (!words || r->source == NAMES_PLAIN || r->header_passed) return BRIO_OK;
    BRIO_FORWARD(try_names(r, &result, axes));
    *are_names = words == count || result == BRIO_AXES_FOUND;
    return BRIO_OK;
}

/* --- columns, from the names and the first row --- */

static brio_status add_property(xyz_reader *r, size_t i) {
    char plain[64], name[64] = "";
    if (i < r->names.count) strcpy(name, r->names.at[i]);
    bool axis = strlen(name) == 1 && strchr("xyzXYZ", name[0]);
    snprintf(plain, sizeof plain, "column%zu", i + 1);
    if (!name[0] || axis || brio_builder_has(r->builder, name)) brio_builder_new_name(r->builder, plain, name);
    r->columns[i].role = COLUMN_PROPERTY;
    r->columns[i].target = r->builder->mesh->num_properties;
    return brio_builder_property(r->builder, name, BRIO_SCALAR_FLOAT64);
}

static void first_three(size_t axes[3]) {
    for (size_t k = 0; k < 3; k++) axes[k] = k;
}

/* Names in a comment count if there are as many as columns. What looks like names and is not harms nobody if x, y and z
 * would be the first columns anyway, or columns that are not there. */
static brio_status place_by_comment(xyz_reader *r, brio_axes_result result) {
    size_t found = r->fields.count, count = r->names.count, *axes = r->axes;
    if (r->tracks && count <= found && result == BRIO_AXES_FOUND) return BRIO_OK;
    if (count == found && result == BRIO_AXES_ANGLES) return unclear_columns(r, angles_are_no_lengths);
    if (count == found && result == BRIO_AXES_SEVERAL) return unclear_columns(r, several_columns);
    if (count == found) return BRIO_OK;
    bool there = axes[0] < found && axes[1] < found && (axes[2] < found || axes[2] == NO_COLUMN);
    if (result == BRIO_AXES_FOUND && there && !are_first(axes))
        return unclear_columns(r, "a comment names columns, but not as many as there are");
    r->names.count = 0;
    first_three(axes);
    return BRIO_OK;
}

static brio_status place_by_names(const xyz_reader *r, brio_axes_result result) {
    switch (result) {
    case BRIO_AXES_FOUND:
        return BRIO_OK;
    case BRIO_AXES_ANGLES:
        return unclear_columns(r, angles_are_no_lengths);
    case BRIO_AXES_SEVERAL:
        break;
    case BRIO_AXES_UNKNOWN:
        return unclear_columns(r, "the names do not say which columns are x, y and z");
    }
    return unclear_columns(r, several_columns);
}

/* Places columns as the caller names them. The caller's names have been checked: x, y and z are there. */
static brio_status place_as_given(xyz_reader *r) {
    const brio_stream *s = r->stream;
    if (r->fields.count < r->names.count)
        return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: %zu columns, but %zu are named (--columns)", s->name,
                         s->line, r->fields.count, r->names.count);
    r->axes[2] = NO_COLUMN;
    for (size_t i = 0; i < r->names.count; i++) {
        const char *name = r->names.at[i];
        if (name[0] >= 'x' && name[0] <= 'z' && !name[1]) r->axes[name[0] - 'x'] = i;
    }
    return BRIO_OK;
}

static brio_status place_axes(xyz_reader *r) {
    if (r->source == NAMES_GIVEN) return place_as_given(r);
    first_three(r->axes);
    if (r->source == NAMES_NONE && r->fields.count == 2) r->axes[2] = NO_COLUMN; /* of a flat text */
    if (r->source == NAMES_NONE) return BRIO_OK;
    brio_axes_result result = axes_of(r, &r->names, r->axes);
    return r->source == NAMES_COMMENT ? place_by_comment(r, result) : place_by_names(r, result);
}

/* Returns whether a column that is no axis becomes a property. Of columns that the caller names, those with a name
 * do. */
static bool is_property(const xyz_reader *r, size_t i) {
    if (r->source == NAMES_GIVEN) return i < r->names.count && r->names.at[i][0];
    if (r->source == NAMES_PLAIN && i >= r->names.count) return false; /* empty: a row may end with separators */
    if (r->source == NAMES_COMMENT && r->tracks && i >= r->names.count) return false;
    return r->fields.at[i].kind != BRIO_FIELD_WORD || brio_field_is_missing(&r->fields.at[i]);
}

/* Names a column of words, which is passed over. Columns that the caller leaves out need no name. */
static brio_status name_left_out(xyz_reader *r, size_t i) {
    char name[64];
    if (r->source == NAMES_GIVEN || r->fields.at[i].kind != BRIO_FIELD_WORD) return BRIO_OK;
    snprintf(name, sizeof name, "column%zu", i + 1);
    bool named = i < r->names.count && r->names.at[i][0];
    return brio_builder_leave_out(r->builder, named ? r->names.at[i] : name);
}

/* Refuses more columns than names: an index that has no name, or commas that do not separate, so that x, y and z are
 * elsewhere. */
static brio_status refuse_nameless(const xyz_reader *r) {
    size_t names = r->names.count, found = r->fields.count;
    while (found > names && r->fields.at[found - 1].kind == BRIO_FIELD_EMPTY) found--;
    if (r->source != NAMES_PLAIN || found <= names) return BRIO_OK;
    return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT, "%s: line %zu: %zu columns, but line %zu names %zu",
                     r->stream->name, r->stream->line, found, r->name_line, names);
}

/* Returns whether a file's name, perhaps with .gz or .zst behind it, has an extension. */
static bool has_extension(const char *name, const char *extension) {
    size_t length = strlen(extension);
    for (const char *at = name; (at = strchr(at, '.')); at++) {
        const char *behind = at + length;
        if (!strncasecmp(at, extension, length) &&
            (!*behind || !strcasecmp(behind, ".gz") || !strcasecmp(behind, ".zst") || !strncasecmp(behind, ".gz,", 4) ||
             !strncasecmp(behind, ".zst,", 5)))
            return true;
    }
    return false;
}

/* Returns whether three fields of the first row are bytes. */
static bool are_bytes(const brio_field *f) {
    for (int k = 0; k < 3; k++)
        if (f[k].kind != BRIO_FIELD_NUMBER || !(f[k].value >= 0 && f[k].value <= 255) ||
            f[k].value != floor(f[k].value))
            return false;
    return true;
}

/* Gives columns without names those that the extension tells. */
static brio_status name_by_extension(xyz_reader *r) {
    static const char intensity[][64] = {"", "", "", "intensity"},
                      both[][64] = {"", "", "", "intensity", "red", "green", "blue"},
                      colour[][64] = {"", "", "", "red", "green", "blue"},
                      normal[][64] = {"", "", "", "nx", "ny", "nz"};
    size_t found = r->fields.count;
    const char(*names)[64] = NULL, *file = r->stream->name;
    if (has_extension(file, ".pts") && found == 4) names = intensity;
    if (has_extension(file, ".pts") && found == 6 && are_bytes(r->fields.at + 3)) names = colour;
    if (has_extension(file, ".pts") && found == 7 && are_bytes(r->fields.at + 4)) names = both;
    if (has_extension(file, ".xyzrgb") && found == 6) names = colour;
    if (has_extension(file, ".xyzn") && found == 6) names = normal;
    if (r->source != NAMES_NONE || !names) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(r->stream->ctx, r->names.at, r->names.capacity, found));
    memcpy(r->names.at, names, found * sizeof *names);
    r->names.count = found;
    return BRIO_OK;
}

static brio_status plan_columns(xyz_reader *r) {
    size_t found = r->fields.count;
    BRIO_FORWARD(refuse_nameless(r));
    BRIO_FORWARD(place_axes(r));
    BRIO_FORWARD(name_by_extension(r));
    if (r->tracks && found > r->names.count) BRIO_FORWARD(brio_builder_leave_out(r->builder, "tracks"));
    size_t count = r->names.count > found ? r->names.count : found;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->stream->ctx, r->columns, count));
    r->num_columns = count;
    for (size_t k = 0; k < 3; k++)
        if (r->axes[k] != NO_COLUMN) r->columns[r->axes[k]] = (column){COLUMN_AXIS, k};
    for (size_t i = 0; i < found; i++) {
        if (r->columns[i].role != COLUMN_IGNORED) continue;
        if (is_property(r, i))
            BRIO_FORWARD(add_property(r, i));
        else
            BRIO_FORWARD(name_left_out(r, i));
    }
    return BRIO_OK;
}

/* --- what a user may not expect --- */

/* Adds a row to what decides whether x numbers the rows. */
static void count_numbered(xyz_reader *r, double x) {
    uint64_t row = brio_builder_count(r->builder);
    bool numbers = x >= 0 && x < BRIO_MAX_VERTICES && x == floor(x);
    if (row == 0) {
        r->may_be_numbered = r->source == NAMES_NONE && r->num_columns > 3;
        r->least = x;
    }
    r->may_be_numbered &= numbers;
    if (!r->may_be_numbered) return;
    if (x < r->least) r->least = x;
    uint64_t of_x = 1, of_row = 1;
    for (int k = 0; k < 3; k++) {
        of_x *= (uint64_t)x;
        of_row *= row;
        r->found[k] += of_x;
        r->due[k] += of_row;
    }
}

/* Returns whether x was 0 to n - 1 or 1 to n, in any order: then the sums of their first three powers are equal. Other
 * whole numbers with such sums are possible, and rare. */
static bool is_numbered(const xyz_reader *r) {
    enum { FEWEST = 4 };
    uint64_t n = brio_builder_count(r->builder), power = 1;
    bool equal = r->may_be_numbered && n >= FEWEST && r->least <= 1;
    for (int k = 0; k < 3 && equal; k++) {
        power *= n;
        equal = r->found[k] == r->due[k] + (r->least > 0 ? power : 0);
    }
    return equal;
}

/* Counts a whole number that was rounded.   i  column. */
static void note_rounding(const xyz_reader *r, size_t i) {
    const brio_field *f = &r->fields.at[i];
    brio_read_notes *n = &r->builder->notes;
    const column *c = &r->columns[i];
    const char *word = f->word, *end = word + f->length;
    if (*word == '"') /* blanks may stand between the quotes and the number */
        for (word++, end--; word < end && (brio_is_blank(*word) || brio_is_blank(end[-1]));)
            brio_is_blank(*word) ? (void)word++ : (void)end--;
    if (f->kind != BRIO_FIELD_NUMBER || !brio_is_rounded(word, (size_t)(end - word), f->value) || n->rounded++) return;
    const char axis[2] = {(char)('x' + c->target), 0};
    const char *name = c->role == COLUMN_AXIS ? axis : r->builder->mesh->properties[c->target].name;
    n->rounded_line = r->stream->line;
    snprintf(n->rounded_column, sizeof n->rounded_column, "%s", name);
}

/* --- rows --- */

static brio_status read_point(const xyz_reader *r, double point[3]) {
    brio_stream *s = r->stream;
    for (int k = 0; k < 3; k++) {
        size_t i = r->axes[k];
        if (i == NO_COLUMN) {
            point[k] = 0;
            continue;
        }
        if (i >= r->fields.count)
            return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s numbers, found %zu", s->name, s->line,
                             i < 3 ? "3" : "more", r->fields.count);
        if (r->fields.at[i].kind != BRIO_FIELD_NUMBER) return bad_field(r, i);
        point[k] = r->fields.at[i].value;
    }
    return BRIO_OK;
}

static brio_status read_row(xyz_reader *r) {
    double point[3];
    BRIO_FORWARD(read_point(r, point));
    count_numbered(r, point[0]);
    BRIO_FORWARD(brio_builder_vertex(r->builder, point));
    brio_mesh *mesh = r->builder->mesh;
    r->there += r->fields.count;
    if (r->fields.count < r->num_columns) r->lacking += r->num_columns - r->fields.count;
    BRIO_FORWARD(brio_limit_lacking(r->stream->ctx, r->stream->name, r->stream->line, r->lacking, r->there));
    for (size_t i = 0; i < r->num_columns; i++) {
        const column *c = &r->columns[i];
        if (i < r->fields.count && c->role != COLUMN_IGNORED && fabs(r->fields.at[i].value) >= 0x1p53)
            note_rounding(r, i);
        if (c->role != COLUMN_PROPERTY) continue;
        /* programs leave out empty fields at the end */
        const brio_field *f = i < r->fields.count ? &r->fields.at[i] : NULL;
        if (f && f->kind == BRIO_FIELD_WORD && !brio_field_is_missing(f)) return bad_field(r, i);
        ((double *)mesh->properties[c->target].data)[mesh->num_vertices - 1] = f ? f->value : NAN;
    }
    return BRIO_OK;
}

/* Reads a line before the first row: the number of rows, names, or the first row itself. */
static brio_status read_first(xyz_reader *r) {
    brio_stream *s = r->stream;
    bool are_names;
    double first = r->fields.at[0].kind == BRIO_FIELD_NUMBER ? r->fields.at[0].value : -1;
    if (r->fields.count == 1 && !r->counted && r->source != NAMES_PLAIN && first >= 0 && first < 0x1p53 &&
        first == floor(first)) {
        r->counted = true;
        r->promised = (uint64_t)first;
        r->count_line = s->line;
        return BRIO_OK;
    }
    size_t least = r->builder->flat ? 2 : 3;
    BRIO_EXPECT(s->ctx, r->fields.count >= least, BRIO_ERR_FORMAT, "%s: line %zu: expected %zu numbers, found %zu",
                s->name, s->line, least, r->fields.count - count_words(r));
    BRIO_FORWARD(try_plain_names(r, &are_names));
    if (are_names && r->source == NAMES_GIVEN)
        r->header_passed = true;
    else if (are_names)
        keep_tried_names(r, NAMES_PLAIN);
    if (are_names) return BRIO_OK;
    BRIO_FORWARD(plan_columns(r));
    return read_row(r);
}

/* Returns whether the line is the one that tells Excel the separator; other separators than those that are known are
 * refused. */
static brio_status read_separator(const xyz_reader *r, const char *line, bool *is_one) {
    line += *line == '"';
    *is_one = r->stream->line == 1 && !strncasecmp(line, "sep=", 4);
    if (!*is_one || (line[4] && strchr(",;\t ", line[4]))) return BRIO_OK;
    return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: line 1: the separator %.1s, expected a comma, semicolon or tab", r->stream->name, line + 4);
}

/* Returns whether a line before the first row has words between single tabs. */
static bool has_single_tabs(const char *line) {
    size_t tabs = 0, letters = 0;
    for (; *line; line++) {
        if (*line == ',' || *line == ';' || (*line == '\t' && line[1] == '\t')) return false;
        tabs += *line == '\t';
        letters += isalpha((unsigned char)*line) != 0;
    }
    return tabs >= 2 && letters;
}

/* Begins another block of a file whose blocks have their numbers of rows before them. */
static bool begins_block(xyz_reader *r) {
    const brio_field *f = r->fields.at;
    bool whole = r->fields.count == 1 && f->kind == BRIO_FIELD_NUMBER && f->value >= 0 && f->value < 0x1p53 &&
                 f->value == floor(f->value);
    if (!r->counted || !whole || r->promised != brio_builder_count(r->builder)) return false;
    r->promised += (uint64_t)f->value;
    return true;
}

static brio_status read_line(xyz_reader *r, char *line) {
    bool separator;
    if (!r->num_columns && r->source == NAMES_NONE) r->tabs |= has_single_tabs(line);
    while (brio_is_blank(*line) && !(r->tabs && *line == '\t')) line++;
    if (!*line) return BRIO_OK;
    if (r->num_shown < 2) show_line(r, line);
    BRIO_FORWARD(read_separator(r, line, &separator));
    if (separator) return BRIO_OK;
    if (*line == ';' || brio_starts_comment(line)) return try_comment(r, line);
    if (r->tabs)
        for (char *tab = line; (tab = strchr(tab, '\t'));) *tab = ';';
    size_t columns = r->num_columns ? r->num_columns : r->source > NAMES_COMMENT ? r->names.count : 0;
    BRIO_FORWARD(brio_fields_of_line(&r->fields, line, columns));
    if (r->num_columns && begins_block(r)) return BRIO_OK;
    return r->num_columns ? read_row(r) : read_first(r);
}

/* Returns whether the last line has no end, and fewer fields than the rows before. */
static bool is_short(const xyz_reader *r) {
    return r->builder->salvage && r->stream->unended && r->num_columns && r->fields.count < r->num_columns;
}

brio_status brio_xyz_read(brio_stream *s, brio_builder *b, const char *columns) {
    brio_status status = BRIO_OK;
    xyz_reader r = {.stream = s, .builder = b, .fields = {.stream = s}};
    char *line;
    brio_builder_stream(b, BRIO_COUNT_UNKNOWN);
    if (columns) {
        BRIO_TRY(brio_columns_parse(s->ctx, columns, b->flat, &r.names.at, &r.names.count));
        r.source = NAMES_GIVEN;
    }
    for (;;) {
        BRIO_TRY(brio_stream_line(s, &line));
        if (!line) break;
        uint64_t before = brio_builder_count(b);
        s->row = before, s->rows = r.counted ? r.promised : before + 1;
        status = read_line(&r, line);
        if (is_short(&r)) status = brio_stream_truncated(s);
        if (brio_salvage(b, s, before, true, &status)) break;
        BRIO_TRY(status);
    }
    if (b->salvage && r.counted && r.promised > brio_builder_count(b)) b->missing = r.promised - brio_builder_count(b);
    BRIO_REQUIRE(s->ctx, !r.counted || r.promised == brio_builder_count(b) + b->missing, BRIO_ERR_FORMAT,
                 "%s: line %zu: promises %" PRIu64 " points, %" PRIu64 " rows follow", s->name, r.count_line,
                 r.promised, brio_builder_count(b));
    b->notes.numbered = is_numbered(&r);
done:
    brio_release(s->ctx, r.fields.at);
    brio_release(s->ctx, r.names.at);
    brio_release(s->ctx, r.tried.at);
    brio_release(s->ctx, r.columns);
    return status;
}
