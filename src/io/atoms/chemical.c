/* Reads atoms from chemical XYZ files: a line with their number, a comment, and a row for each atom: element, x, y, z,
 * and further numbers. The comment of an extended XYZ file names the columns: Properties=species:S:1:pos:R:3:...
 * It may have a cell, Lattice="ax ay az bx by bz cx cy cz", and say which of its vectors repeat, pbc="T T F".
 *
 * An atom is a point with the properties atomic_number and radius (van der Waals, in angstrom, as the coordinates of
 * these files are). Of several frames the first is read; the others are passed over, but a line that is no number where
 * the next frame should begin is an error, because then the first line lies.
 *
 * Based on: XYZ file format of XMol, Minnesota Supercomputer Center; extended XYZ as written by ASE and QUIP. */
#include "base/memory.h"
#include "io/atoms/atoms.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/textrow.h"
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Both chosen. MOST_COLUMNS: columns of a row. NAME: characters of a name in Properties=. */
enum { MOST_COLUMNS = 256, NAME = 48 };

typedef enum { ROLE_LEFT_OUT, ROLE_ELEMENT, ROLE_AXIS, ROLE_NUMBER, ROLE_INTEGER, ROLE_LOGICAL } role;

typedef struct {
    role role;
    size_t target; /* axis, or index of the property */
} chemical_column;

typedef struct {
    brio_text text;
    brio_builder *builder;
    chemical_column columns[MOST_COLUMNS];
    size_t num_columns;
    bool free_columns; /* there is no Properties=: the first row decides how many columns there are */
} chemical_reader;

/* --- words --- */

static bool ends_word(char c) {
    return !c || brio_is_blank(c);
}

static const char *skip_blanks(const char *p) {
    while (brio_is_blank(*p)) p++;
    return p;
}

/* --- the start --- */

static const char *next_line(const char *p, const char *end) {
    const char *line = memchr(p, '\n', (size_t)(end - p));
    return line ? line + 1 : end;
}

/* Copies a line, up to `size` - 1 characters of it. */
static void copy_line(const char *p, const char *end, char *to, size_t size) {
    size_t length = (size_t)(next_line(p, end) - p);
    if (length > size - 1) length = size - 1;
    memcpy(to, p, length);
    to[length] = 0;
}

static bool is_count(const char *line) {
    uint64_t count;
    const char *p = skip_blanks(line);
    if (!brio_parse_count(&p, &count)) return false;
    return !*skip_blanks(p);
}

/* Returns whether a row begins with a word and three numbers. */
static bool is_atom(const char *line, bool *symbol) {
    const char *p = skip_blanks(line);
    double value;
    *symbol = isalpha((unsigned char)*p);
    if (!brio_element_of_word(p)) return false;
    while (!ends_word(*p)) p++;
    for (int k = 0; k < 3; k++) {
        p = skip_blanks(p);
        if (!brio_parse_number(&p, &value) || !ends_word(*p)) return false;
    }
    return true;
}

/* Returns whether a comment cannot be a row of points, a comment of a text of points, or a line of three names or
 * more. */
static bool is_prose(const char *line) {
    double value;
    size_t words = 0, others = 0;
    for (const char *p = skip_blanks(line); *p; p = skip_blanks(p)) {
        const char *end = p;
        if (words++ == 0 && strchr("#%/;", *p)) return false;
        others += !brio_parse_number(&end, &value) || !ends_word(*end);
        while (!ends_word(*p)) p++;
    }
    return others && (words < 3 || others < words);
}

bool brio_chemical_starts(const char *bytes, size_t size) {
    const char *end = bytes + size, *comment = next_line(bytes, end), *row = next_line(comment, end);
    char first[64], second[1024], third[256];
    bool symbol;
    copy_line(bytes, end, first, sizeof first);
    copy_line(comment, end, second, sizeof second);
    copy_line(row, end, third, sizeof third);
    if (row == end || !is_count(first)) return false;
    return strstr(second, "Properties=") || (is_atom(third, &symbol) && (symbol || is_prose(second)));
}

/* --- columns --- */

static brio_status add_column(chemical_reader *r, role what, size_t target) {
    brio_stream *s = r->text.stream;
    if (r->num_columns == MOST_COLUMNS)
        return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: more than %d columns", s->name, s->line, MOST_COLUMNS);
    r->columns[r->num_columns++] = (chemical_column){what, target};
    return BRIO_OK;
}

static brio_status add_property_columns(chemical_reader *r, const char *name, role what, uint64_t count) {
    static const brio_scalar types[] = {
        [ROLE_NUMBER] = BRIO_SCALAR_FLOAT64, [ROLE_INTEGER] = BRIO_SCALAR_INT32, [ROLE_LOGICAL] = BRIO_SCALAR_UINT8};
    char part[64];
    for (uint64_t i = 0; i < count; i++) {
        brio_builder_component_name(r->builder, name, i, count, part);
        BRIO_FORWARD(add_column(r, what, r->builder->mesh->num_properties));
        BRIO_FORWARD(brio_builder_property(r->builder, count > 1 ? part : name, types[what]));
    }
    return BRIO_OK;
}

static bool is_one_of(const char *name, const char *const *names) {
    for (; *names; names++)
        if (!strcmp(name, *names)) return true;
    return false;
}

/* Adds the columns of one entry of Properties=, name:type:count. */
static brio_status add_entry(chemical_reader *r, const char *name, char type, uint64_t count) {
    static const char *const elements[] = {"species", "element",       "elements",       "symbols", "Z",
                                           "numbers", "atomic_number", "atomic_numbers", NULL};
    static const char *const positions[] = {"pos", "position", "positions", NULL};
    if (count == 1 && is_one_of(name, elements)) return add_column(r, ROLE_ELEMENT, 0);
    if (count == 3 && type == 'R' && is_one_of(name, positions)) {
        for (size_t k = 0; k < 3; k++) BRIO_FORWARD(add_column(r, ROLE_AXIS, k));
    } else if (type == 'S') {
        BRIO_FORWARD(brio_builder_leave_out(r->builder, name));
        for (uint64_t i = 0; i < count; i++) BRIO_FORWARD(add_column(r, ROLE_LEFT_OUT, 0));
    } else {
        role what = type == 'R' ? ROLE_NUMBER : type == 'I' ? ROLE_INTEGER : ROLE_LOGICAL;
        BRIO_FORWARD(add_property_columns(r, name, what, count));
    }
    return BRIO_OK;
}

static brio_status bad_properties(const chemical_reader *r, const char *what) {
    const brio_stream *s = r->text.stream;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: Properties=: expected %s", s->name, s->line, what);
}

static brio_status parse_properties(chemical_reader *r, const char *p) {
    uint64_t count;
    size_t elements = 0, axes = 0;
    for (bool more = true; more; p += more) {
        char name[NAME + 1];
        size_t length = strcspn(p, ": \t\"");
        if (!length || length > NAME || p[length] != ':') return bad_properties(r, "name:type:count of each column");
        memcpy(name, p, length);
        name[length] = 0;
        char type = p[length + 1];
        if (!type || !strchr("SRIL", type) || p[length + 2] != ':') return bad_properties(r, "a type S, R, I or L");
        p += length + 3;
        if (!brio_parse_count(&p, &count) || count < 1 || count > MOST_COLUMNS)
            return bad_properties(r, "a number of columns from 1 to 256");
        BRIO_FORWARD(add_entry(r, name, type, count));
        more = *p == ':';
    }
    for (size_t i = 0; i < r->num_columns; i++) {
        elements += r->columns[i].role == ROLE_ELEMENT;
        axes += r->columns[i].role == ROLE_AXIS;
    }
    if (elements != 1 || axes != 3) return bad_properties(r, "one column of species or Z, and pos:R:3");
    return BRIO_OK;
}

/* An entry of the comment: a word, or key=value. The value is without its quotes or brackets. */
typedef struct {
    const char *key, *value; /* value: NULL for a word */
    size_t key_length, value_length;
    bool bracketed; /* by quotes or brackets */
} comment_entry;

/* Finds the next entry at *p and moves *p behind it. Returns false at the end. */
static bool next_entry(const char **p, comment_entry *e) {
    static const char open[] = "\"'{[", close[] = "\"'}]";
    const char *at = skip_blanks(*p), *bracket;
    *e = (comment_entry){.key = at};
    if (!*at) return false;
    while (!ends_word(*at) && *at != '=') at++;
    e->key_length = (size_t)(at - e->key);
    if (*at == '=') {
        e->value = ++at;
        bracket = *at ? strchr(open, *at) : NULL;
        e->bracketed = bracket != NULL;
        if (bracket) {
            e->value = ++at;
            const char end = close[bracket - open];
            for (int depth = 1; *at; at++) {
                depth += (*at == *bracket && end != *bracket) - (*at == end);
                if (!depth) break;
            }
        } else {
            while (!ends_word(*at)) at++;
        }
        e->value_length = (size_t)(at - e->value);
        at += bracket && *at;
    }
    *p = at;
    return true;
}

static bool is_key(const comment_entry *e, const char *key) {
    return e->value && e->key_length == strlen(key) && !strncasecmp(e->key, key, e->key_length);
}

static brio_status bad_entry(const chemical_reader *r, const char *key, const char *what) {
    const brio_stream *s = r->text.stream;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: %s=: expected %s", s->name, s->line, key, what);
}

/* Reads the nine numbers of a lattice, or three, which are the lengths of a box. */
static brio_status parse_lattice(const chemical_reader *r, const comment_entry *e, double cell[9]) {
    static const char wanted[] = "9 numbers, a vector after the other, or 3 lengths";
    double numbers[9];
    int count = 0;
    for (const char *p = e->value; p < e->value + e->value_length;) {
        if (brio_is_blank(*p) || strchr(",;[]", *p)) {
            p++;
            continue;
        }
        if (count == 9 || !brio_parse_number(&p, &numbers[count]) || !isfinite(numbers[count]))
            return bad_entry(r, "Lattice", wanted);
        count++;
    }
    if (count != 3 && count != 9) return bad_entry(r, "Lattice", wanted);
    for (int i = 0; i < 9; i++) cell[i] = count == 9 ? numbers[i] : i % 4 == 0 ? numbers[i / 4] : 0;
    return BRIO_OK;
}

/* Reads T or F, True or False, or 1 or 0: three times, or once for all directions. */
static brio_status parse_pbc(const chemical_reader *r, const comment_entry *e, bool periodic[3]) {
    int count = 0;
    for (size_t i = 0; i < e->value_length; i++) {
        const char c = e->value[i];
        if (brio_is_blank(c) || strchr(",[]", c)) continue;
        if (count == 3 || !strchr("TtFf10", c)) return bad_entry(r, "pbc", "T or F of each direction");
        periodic[count++] = strchr("Tt1", c) != NULL;
        const char *rest = strchr("Tt", c) ? "rue" : "alse";
        if (i + strlen(rest) < e->value_length && !strncasecmp(e->value + i + 1, rest, strlen(rest))) i += strlen(rest);
    }
    if (count == 1) periodic[1] = periodic[2] = periodic[0];
    return count == 1 || count == 3 ? BRIO_OK : bad_entry(r, "pbc", "T or F of each direction");
}

/* Takes the cell of a comment, and notes that what else it has is left out. Without Properties= a comment may be any
 * text, so only values in quotes or brackets count. */
static brio_status take_comment(const chemical_reader *r, const char *comment) {
    comment_entry e;
    double cell[9] = {0};
    bool periodic[3] = {true, true, true}, more = false;
    const bool extended = strstr(comment, "Properties=");
    while (next_entry(&comment, &e)) {
        const bool counts = extended || e.bracketed;
        if (counts && is_key(&e, "Lattice"))
            BRIO_FORWARD(parse_lattice(r, &e, cell));
        else if (counts && is_key(&e, "pbc"))
            BRIO_FORWARD(parse_pbc(r, &e, periodic));
        else
            more |= !is_key(&e, "Properties");
    }
    if (more) BRIO_FORWARD(brio_builder_leave_out(r->builder, "comment"));
    return brio_cell_keep(r->builder, cell, periodic);
}

static brio_status plan(chemical_reader *r, const char *comment) {
    const char *properties = strstr(comment, "Properties=");
    BRIO_FORWARD(brio_atoms_plan(r->builder));
    BRIO_FORWARD(take_comment(r, comment));
    if (properties) {
        properties += strlen("Properties=");
        return parse_properties(r, properties + (*properties == '"'));
    }
    r->free_columns = true;
    BRIO_FORWARD(add_column(r, ROLE_ELEMENT, 0));
    for (size_t k = 0; k < 3; k++) BRIO_FORWARD(add_column(r, ROLE_AXIS, k));
    return BRIO_OK;
}

/* Adds a property for each number behind the coordinates of the first row. */
static brio_status plan_more(chemical_reader *r, const char *p) {
    double value;
    char name[32];
    r->free_columns = false;
    for (size_t i = 0;; i++) {
        p = skip_blanks(p);
        if (!*p) break;
        const char *end = p;
        bool number = brio_parse_number(&end, &value) && ends_word(*end);
        snprintf(name, sizeof name, "column%zu", i + 1);
        if (i >= 4 && !number) BRIO_FORWARD(brio_builder_leave_out(r->builder, name));
        if (i >= 4)
            BRIO_FORWARD(number ? add_property_columns(r, name, ROLE_NUMBER, 1) : add_column(r, ROLE_LEFT_OUT, 0));
        while (!ends_word(*p)) p++;
    }
    return BRIO_OK;
}

/* --- rows --- */

static brio_status read_element(chemical_reader *r) {
    brio_text *t = &r->text;
    int element = brio_element_of_word(t->at);
    if (!element) return brio_text_expected(t, "the symbol or number of an element");
    brio_atoms_set_element(r->builder, element);
    return BRIO_OK;
}

static brio_status read_integer(chemical_reader *r, size_t property) {
    double value;
    brio_mesh *m = r->builder->mesh;
    char *place = r->text.at;
    BRIO_FORWARD(brio_text_number(&r->text, &value));
    bool fits = value == floor(value) && value >= INT32_MIN && value <= INT32_MAX;
    if (fits) ((int32_t *)m->properties[property].data)[m->num_vertices - 1] = (int32_t)value;
    r->text.at = place;
    if (!fits) return brio_text_expected(&r->text, "a whole number of 32 bits");
    return BRIO_OK;
}

static brio_status read_column(chemical_reader *r, const chemical_column *c) {
    brio_text *t = &r->text;
    brio_mesh *m = r->builder->mesh;
    size_t v = m->num_vertices - 1;
    char *place = t->at;
    double value;
    switch (c->role) {
    case ROLE_ELEMENT:
        return read_element(r);
    case ROLE_INTEGER:
        return read_integer(r, c->target);
    case ROLE_LOGICAL:
        if (!strchr("TF", *t->at)) return brio_text_expected(t, "T or F");
        ((uint8_t *)m->properties[c->target].data)[v] = *t->at == 'T';
        return BRIO_OK;
    case ROLE_AXIS:
    case ROLE_NUMBER:
        BRIO_FORWARD(brio_text_number(t, &value));
        t->at = place;
        *(c->role == ROLE_AXIS ? &m->vertices[3 * v + c->target] : (double *)m->properties[c->target].data + v) = value;
        break;
    case ROLE_LEFT_OUT:
        break;
    }
    return BRIO_OK;
}

static brio_status read_atom(chemical_reader *r) {
    brio_text *t = &r->text;
    if (r->free_columns) BRIO_FORWARD(plan_more(r, t->at));
    BRIO_FORWARD(brio_builder_add_vertices(r->builder, 1));
    for (size_t i = 0; i < r->num_columns; i++) {
        if (!brio_text_more(t)) return brio_text_expected(t, "another column of the atom");
        BRIO_FORWARD(read_column(r, &r->columns[i]));
        while (!ends_word(*t->at)) t->at++;
    }
    return BRIO_OK;
}

/* Checks that the file ends, or that a next frame begins. */
static brio_status check_end(chemical_reader *r) {
    brio_text *t = &r->text;
    BRIO_FORWARD(brio_text_next_line(t));
    if (t->at && !is_count(t->at))
        return brio_text_expected(t, "the end of the file, or the number of atoms of a next frame");
    if (t->at) BRIO_FORWARD(brio_builder_leave_out(r->builder, "further frames"));
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    chemical_reader r = {.text = {s, 0, NULL}, .builder = b};
    uint64_t count = 0;
    char *comment;
    brio_stream_element(s, "line", 2);
    BRIO_FORWARD(brio_text_next_line(&r.text));
    if (!r.text.at) return brio_stream_truncated(s);
    BRIO_FORWARD(brio_text_count(&r.text, "the number of atoms", BRIO_MAX_VERTICES, &count));
    BRIO_FORWARD(brio_text_row_end(&r.text));
    BRIO_FORWARD(brio_stream_line(s, &comment));
    BRIO_FORWARD(plan(&r, comment ? comment : ""));
    BRIO_FORWARD(brio_stream_expect(s, count, 7, "the first line")); /* "C 0 0 0" */
    brio_stream_element(s, "atom", count);
    for (; s->row < count; s->row++) {
        BRIO_FORWARD(brio_text_next_line(&r.text));
        if (!r.text.at) return brio_stream_truncated(s);
        BRIO_FORWARD(read_atom(&r));
    }
    return check_end(&r);
}

const brio_codec brio_chemical_codec = {.read = read_file};
