/* Reads LAMMPS's data files: a comment; a header of counts and of the box; sections, of which Atoms is read. Columns
 * are those of an atom style, which a comment behind the word Atoms names, or else their number tells. The files do not
 * say which directions repeat; LAMMPS takes all three unless it is told otherwise, and so does this reader.
 *
 * Based on: LAMMPS Documentation, the command read_data. Sandia National Laboratories. */
#include "base/memory.h"
#include "io/atoms/atoms.h"
#include "io/formats.h"
#include "io/number.h"
#include <ctype.h>
#include <math.h>
#include <string.h>

enum { MOST_COLUMNS = 16 };

/* An atom style: its columns, and the names of their properties; x is the first of three coordinates. */
typedef struct {
    const char *style;
    size_t count;
    const char *columns[MOST_COLUMNS];
} atom_style;

static const atom_style styles[] = {{"atomic", 5, {"id", "type", "x", "y", "z"}},
                                    {"charge", 6, {"id", "type", "q", "x", "y", "z"}},
                                    {"molecular", 6, {"id", "molecule", "type", "x", "y", "z"}},
                                    {"bond", 6, {"id", "molecule", "type", "x", "y", "z"}},
                                    {"angle", 6, {"id", "molecule", "type", "x", "y", "z"}},
                                    {"full", 7, {"id", "molecule", "type", "q", "x", "y", "z"}},
                                    {"sphere", 7, {"id", "type", "diameter", "density", "x", "y", "z"}},
                                    {"dipole", 9, {"id", "type", "q", "x", "y", "z", "mux", "muy", "muz"}}};

enum { NUM_STYLES = sizeof styles / sizeof *styles };

static const char *const image_flags[3] = {"ix", "iy", "iz"};

typedef struct {
    brio_stream *s;
    brio_builder *b;
    brio_words words;
    brio_lammps_box box;
    uint64_t atoms;
    bool has_count, has_atoms;
    bool has_bounds[3];
    const atom_style *style;
    size_t first; /* property of the first column */
} data_reader;

/* --- the header --- */

/* A line of the header: numbers, and the words behind them. */
typedef struct {
    const char *words;
    size_t numbers;
} header_line;

enum { X_BOUNDS, Y_BOUNDS, Z_BOUNDS, TILTS, A, B, C, CORNER, ATOMS, NUM_HEADER_LINES };

static const header_line header[NUM_HEADER_LINES] = {{"xlo xhi", 2},  {"ylo yhi", 2},    {"zlo zhi", 2},
                                                     {"xy xz yz", 3}, {"avec", 3},       {"bvec", 3},
                                                     {"cvec", 3},     {"abc origin", 3}, {"atoms", 1}};

/* Returns whether the words from place `from` on are those of a name. */
static bool are_words(const brio_words *w, size_t from, const char *name) {
    for (; *name; from++) {
        size_t length = strcspn(name, " ");
        if (from >= w->count || strlen(w->of[from]) != length || strncmp(w->of[from], name, length) != 0) return false;
        name += length + (name[length] == ' ');
    }
    return from == w->count;
}

static brio_status take_header(data_reader *r) {
    brio_lammps_box *box = &r->box;
    int line = 0;
    double x[3];
    while (line < NUM_HEADER_LINES && !are_words(&r->words, header[line].numbers, header[line].words)) line++;
    if (line == NUM_HEADER_LINES) return BRIO_OK; /* counts of other things */
    if (line == ATOMS) {
        r->has_count = true;
        return brio_word_count(r->s, &r->words, 0, "the number of atoms", BRIO_MAX_VERTICES, &r->atoms);
    }
    for (size_t k = 0; k < header[line].numbers; k++)
        BRIO_FORWARD(brio_word_number(r->s, &r->words, k, "a number of the box", &x[k]));
    if (line <= Z_BOUNDS)
        box->low[line] = x[0], box->high[line] = x[1], r->has_bounds[line] = true;
    else if (line == TILTS)
        memcpy(box->tilt, x, sizeof x);
    else if (line == CORNER)
        memcpy(box->corner, x, sizeof x);
    else
        memcpy(box->vectors + 3 * (line - A), x, sizeof x), box->general = r->has_bounds[line - A] = true;
    return BRIO_OK;
}

/* --- the section Atoms --- */

static bool is_integer(const char *word) {
    word += *word == '-' || *word == '+';
    uint64_t number;
    return brio_parse_count(&word, &number) && !*word;
}

/* Returns the style that a name has, or NULL. */
static const atom_style *style_of(const char *name) {
    for (size_t i = 0; i < NUM_STYLES; i++)
        if (!strcmp(styles[i].style, name)) return &styles[i];
    return NULL;
}

/* Finds the style that the first row shows, if the file does not name one. */
static brio_status guess_style(data_reader *r) {
    const brio_words *w = &r->words;
    bool flags = w->count >= 8;
    for (size_t k = 0; k < 3 && flags; k++) flags = is_integer(w->of[w->count - 1 - k]);
    size_t count = w->count - (flags ? 3 : 0);
    const char *name = count == 5 ? "atomic" : count == 7 ? "full" : count == 9 ? "dipole" : NULL;
    if (count == 6) name = is_integer(w->of[2]) ? "molecular" : "charge";
    if (count == 7 && !is_integer(w->of[2])) name = "sphere";
    BRIO_EXPECT(r->s->ctx, name, BRIO_ERR_FORMAT,
                "%s: line %zu: %zu columns are those of no atom style that is known; the line Atoms names none",
                r->s->name, r->s->line, w->count);
    r->style = style_of(name);
    return BRIO_OK;
}

static brio_status plan(data_reader *r) {
    bool flags;
    if (!r->style) BRIO_FORWARD(guess_style(r));
    flags = r->words.count == r->style->count + 3;
    r->first = r->b->mesh->num_properties;
    for (size_t i = 0; i < r->style->count; i++) {
        const char *name = r->style->columns[i];
        if (strlen(name) == 1 && strchr("xyz", *name)) continue;
        BRIO_FORWARD(brio_builder_property(r->b, name, BRIO_SCALAR_FLOAT64));
    }
    for (int k = 0; k < 3 && flags; k++) BRIO_FORWARD(brio_builder_property(r->b, image_flags[k], BRIO_SCALAR_FLOAT64));
    return BRIO_OK;
}

static brio_status read_atom(data_reader *r) {
    brio_mesh *m = r->b->mesh;
    double x[3] = {0, 0, 0}, value;
    size_t property = r->first, wanted = m->num_properties - r->first + 3;
    if (r->words.count != wanted)
        return brio_word_expected(r->s, wanted < r->words.count ? r->words.of[wanted] : NULL,
                                  "as many columns as the first atom has");
    BRIO_FORWARD(brio_builder_vertex(r->b, x));
    size_t v = m->num_vertices - 1;
    for (size_t i = 0; i < wanted; i++) {
        const char *name = i < r->style->count ? r->style->columns[i] : "";
        BRIO_FORWARD(brio_word_number(r->s, &r->words, i, "a number of the atom", &value));
        if (strlen(name) == 1 && strchr("xyz", *name))
            m->vertices[3 * v + (size_t)(*name - 'x')] = value;
        else
            ((double *)m->properties[property++].data)[v] = value;
    }
    return BRIO_OK;
}

static brio_status read_atoms(data_reader *r) {
    BRIO_EXPECT(r->s->ctx, r->has_count && r->has_bounds[0] && r->has_bounds[1] && r->has_bounds[2], BRIO_ERR_FORMAT,
                "%s: line %zu: the section Atoms, but the header %s", r->s->name, r->s->line,
                r->has_count ? "lacks a bound or a vector of the box" : "has no number of atoms");
    double cell[9], corner[3];
    BRIO_FORWARD(brio_lammps_keep_box(r->s, r->b, &r->box, cell, corner));
    BRIO_FORWARD(brio_stream_expect(r->s, r->atoms, 9, "the number of atoms")); /* "1 1 0 0 0" */
    brio_stream_element(r->s, "atom", r->atoms);
    for (; r->s->row < r->atoms; r->s->row++) {
        BRIO_FORWARD(brio_words_next(r->s, '#', &r->words));
        if (!r->words.count) return brio_stream_truncated(r->s);
        if (!r->s->row) BRIO_FORWARD(plan(r));
        BRIO_FORWARD(read_atom(r));
    }
    brio_stream_element(r->s, NULL, 0);
    r->has_atoms = true;
    return BRIO_OK;
}

/* --- the file --- */

/* Reads the section whose name the line is. Its rows are passed over, except those of Atoms. */
static brio_status begin_section(data_reader *r, char *line) {
    char *comment = strchr(line, '#'), name[64];
    brio_words style;
    if (comment) *comment = 0;
    size_t length = strlen(line);
    while (length && isspace((unsigned char)line[length - 1])) length--;
    if (length > sizeof name - 1) length = sizeof name - 1;
    memcpy(name, line, length);
    name[length] = 0;
    if (strcmp(name, "Atoms") != 0) return brio_builder_leave_out(r->b, name);
    if (r->has_atoms) return brio_word_expected(r->s, name, "one section Atoms");
    if (comment) brio_words_split(comment + 1, 0, &style);
    if (comment && style.count) {
        r->style = style_of(style.of[0]);
        BRIO_EXPECT(r->s->ctx, r->style, BRIO_ERR_FORMAT,
                    "%s: line %zu: the atom style %s is not read, expected atomic, charge, molecular, bond, angle, "
                    "full, sphere or dipole",
                    r->s->name, r->s->line, style.of[0]);
    }
    return read_atoms(r);
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    data_reader r = {.s = s, .b = b, .box.periodic = {true, true, true}};
    char *line;
    bool header_ends = false;
    BRIO_FORWARD(brio_stream_line(s, &line));
    if (!line) return brio_stream_truncated(s);
    if (line[strspn(line, " \t\r")]) BRIO_FORWARD(brio_builder_leave_out(b, "comment"));
    for (;;) {
        BRIO_FORWARD(brio_stream_line(s, &line));
        if (!line) break;
        line += strspn(line, " \t\r");
        if (isalpha((unsigned char)*line)) {
            header_ends = true;
            BRIO_FORWARD(begin_section(&r, line));
            continue;
        }
        if (header_ends) continue;
        brio_words_split(line, '#', &r.words);
        if (r.words.count) BRIO_FORWARD(take_header(&r));
    }
    BRIO_EXPECT(s->ctx, r.has_atoms || (r.has_count && !r.atoms), BRIO_ERR_FORMAT,
                "%s: there is no section Atoms before the end at line %zu", s->name, s->line);
    return BRIO_OK;
}

/* Returns whether a beginning has the line of the number of atoms and one of the box. */
static bool starts(const char *bytes, size_t size) {
    bool count = false, box = false;
    char copy[256];
    brio_words words;
    const char *end = bytes + size, *at = memchr(bytes, '\n', size);
    for (int lines = 0; at && lines < 64 && !(count && box); lines++) {
        const char *line = at + 1;
        at = memchr(line, '\n', (size_t)(end - line));
        if (!at || (size_t)(at - line) >= sizeof copy) continue;
        memcpy(copy, line, (size_t)(at - line));
        copy[at - line] = 0;
        brio_words_split(copy, '#', &words);
        count |= are_words(&words, 1, "atoms") && is_integer(words.of[0]);
        box |= are_words(&words, 2, "xlo xhi") || are_words(&words, 3, "avec");
    }
    return count && box;
}

const brio_codec brio_lammps_data_codec = {.starts = starts, .read = read_file};
