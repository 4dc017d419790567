/* Reads crystallographic information files: items of a tag and a value, and loops of tags and rows of values. Of the
 * first data block that has sites of atoms, the sites become points: of several models those of the first, and of
 * alternate locations those marked with none, A or 1, as of PDB files.
 *
 * Sites are fractions of the cell (_atom_site_fract_x), or positions (_atom_site_Cartn_x, as files of macromolecules
 * have them). Copies by symmetry are not made: fractions in another space group than P1 are refused, and positions in
 * one lose the cell. Operations, where they are listed, decide about the group, then its number, then its name. In tags
 * a dot counts as the underscore that older dictionaries have.
 *
 * Based on: Hall, Allen, Brown. The crystallographic information file (CIF). Acta Crystallographica A 1991. */
#include "base/memory.h"
#include "io/atoms/atoms.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/pdb.h"
#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

/* VALUE: characters of a value that are looked at. MOST_TAGS: of a loop. Both chosen. */
enum { VALUE = 256, MOST_TAGS = 256 };

typedef enum { TOKEN_END, TOKEN_DATA, TOKEN_LOOP, TOKEN_TAG, TOKEN_VALUE } token_kind;

typedef struct {
    token_kind kind;
    bool quoted;
    char text[VALUE]; /* the beginning of it */
} cif_token;

typedef enum {
    TAG_OTHER,
    TAG_FRACTION,
    TAG_POSITION,
    TAG_SYMBOL,
    TAG_LABEL,
    TAG_NUMBER,
    TAG_MODEL,
    TAG_ALTERNATE,
    TAG_OPERATION
} tag_role;

/* What a column of a loop is. */
typedef struct {
    tag_role role;
    size_t target; /* axis, or index of the property */
} cif_column;

typedef struct {
    brio_stream *s;
    brio_builder *b;
    char *at; /* in the line, NULL before it is read */
    cif_token token;
    double length[3], angle[3];
    bool has_length[3], has_angle[3];
    char group[VALUE];     /* its name */
    double group_number;   /* 0: not told */
    size_t operations;     /* of symmetry, that are listed */
    bool other_operations; /* one of them is not the identity */
    bool has_sites, fractions, has_symbols;
    char model[VALUE]; /* that of the first site, or empty */
    char tags[MOST_TAGS][64];
    cif_column columns[MOST_TAGS];
    size_t num_tags;
} cif_reader;

/* --- tokens --- */

static void take_text(cif_token *t, const char *from, size_t length) {
    if (length > VALUE - 1) length = VALUE - 1;
    memcpy(t->text, from, length);
    t->text[length] = 0;
}

/* Reads a field of several lines, which begin and end with a semicolon. The line that begins it is at hand. */
static brio_status take_field(cif_reader *r) {
    take_text(&r->token, r->at + 1, strlen(r->at + 1));
    size_t from = r->s->line;
    do {
        BRIO_FORWARD(brio_stream_line(r->s, &r->at));
        BRIO_EXPECT(r->s->ctx, r->at, BRIO_ERR_FORMAT,
                    "%s: line %zu: a text field that begins here has no end: expected a line with a semicolon first",
                    r->s->name, from);
    } while (*r->at != ';');
    r->at++;
    return BRIO_OK;
}

static brio_status take_quoted(cif_reader *r) {
    const char quote = *r->at++, *from = r->at;
    while (*r->at && (*r->at != quote || (r->at[1] && !isspace((unsigned char)r->at[1])))) r->at++;
    if (!*r->at) return brio_word_expected(r->s, NULL, "the end of a quoted value");
    take_text(&r->token, from, (size_t)(r->at - from));
    r->at++;
    return BRIO_OK;
}

static token_kind kind_of(const char *word) {
    if (*word == '_') return TOKEN_TAG;
    if (!strncasecmp(word, "data_", 5)) return TOKEN_DATA;
    return !strcasecmp(word, "loop_") ? TOKEN_LOOP : TOKEN_VALUE;
}

/* Reads the next token. */
static brio_status next(cif_reader *r) {
    cif_token *t = &r->token;
    *t = (cif_token){.kind = TOKEN_END};
    for (;;) {
        bool fresh = !r->at;
        if (fresh) BRIO_FORWARD(brio_stream_line(r->s, &r->at));
        if (!r->at) return BRIO_OK;
        if (fresh && *r->at == ';') {
            t->kind = TOKEN_VALUE, t->quoted = true;
            return take_field(r);
        }
        while (*r->at && isspace((unsigned char)*r->at)) r->at++;
        if (*r->at && *r->at != '#') break;
        r->at = NULL;
    }
    t->kind = TOKEN_VALUE;
    t->quoted = *r->at == '\'' || *r->at == '"';
    if (t->quoted) return take_quoted(r);
    const char *from = r->at;
    while (*r->at && !isspace((unsigned char)*r->at)) r->at++;
    take_text(t, from, (size_t)(r->at - from));
    t->kind = kind_of(t->text);
    return BRIO_OK;
}

/* --- values --- */

static bool is_missing(const cif_token *t) {
    return !t->quoted && (!strcmp(t->text, ".") || !strcmp(t->text, "?"));
}

/* Reads a number, whose uncertainty may stand behind it: 5.431(2). */
static brio_status number(const cif_reader *r, double *value) {
    const char *p = r->token.text;
    bool is_number = brio_parse_number(&p, value) && isfinite(*value);
    if (is_number && *p == '(') p += strspn(p, "(0123456789)");
    return is_number && !*p ? BRIO_OK : brio_word_expected(r->s, r->token.text, "a number");
}

/* Returns whether a tag is one of the names between blanks; a dot in the tag is an underscore. */
static bool is_tag(const char *tag, const char *names) {
    for (const char *at = names; *at; at += *at == ' ') {
        size_t length = strcspn(at, " "), i = 0;
        while (i < length && tag[i] && (tag[i] == '.' ? '_' : tolower((unsigned char)tag[i])) == at[i]) i++;
        if (i == length && !tag[i]) return true;
        at += length;
    }
    return false;
}

static void copy_tag(const cif_reader *r, char tag[64]) {
    size_t length = strlen(r->token.text);
    if (length > 63) length = 63;
    memcpy(tag, r->token.text, length);
    tag[length] = 0;
}

/* Returns whether an operation is x,y,z. */
static bool is_identity(const char *text) {
    const char *wanted = "x,y,z";
    for (; *text; text++) {
        if (isspace((unsigned char)*text) || *text == '+') continue;
        if (tolower((unsigned char)*text) != *wanted++) return false;
    }
    return !*wanted;
}

static void take_operation(cif_reader *r) {
    r->operations++;
    r->other_operations |= !is_identity(r->token.text);
}

#define OPERATION_TAGS "_symmetry_equiv_pos_as_xyz _space_group_symop_operation_xyz"

/* Takes an item. Those that say nothing of points or cell are left out. */
static brio_status take_item(cif_reader *r, const char *tag) {
    static const char *const lengths[3] = {"_cell_length_a", "_cell_length_b", "_cell_length_c"};
    static const char *const angles[3] = {"_cell_angle_alpha", "_cell_angle_beta", "_cell_angle_gamma"};
    if (is_missing(&r->token)) return BRIO_OK;
    for (int k = 0; k < 3; k++) {
        r->has_length[k] |= is_tag(tag, lengths[k]), r->has_angle[k] |= is_tag(tag, angles[k]);
        if (is_tag(tag, lengths[k])) return number(r, &r->length[k]);
        if (is_tag(tag, angles[k])) return number(r, &r->angle[k]);
    }
    if (is_tag(tag, "_symmetry_space_group_name_h-m _space_group_name_h-m_alt _space_group_name_h-m_full")) {
        memcpy(r->group, r->token.text, sizeof r->group);
        return BRIO_OK;
    }
    if (is_tag(tag, "_symmetry_int_tables_number _space_group_it_number")) return number(r, &r->group_number);
    if (is_tag(tag, OPERATION_TAGS))
        take_operation(r);
    else if (!is_tag(tag, "_cell_volume _cell_formula_units_z"))
        return brio_builder_leave_out(r->b, tag);
    return BRIO_OK;
}

/* --- loops --- */

/* Returns what a column is that has no property. */
static cif_column column_of(const char *tag) {
    static const char *const fractions[3] = {"_atom_site_fract_x", "_atom_site_fract_y", "_atom_site_fract_z"};
    static const char *const positions[3] = {"_atom_site_cartn_x", "_atom_site_cartn_y", "_atom_site_cartn_z"};
    for (size_t k = 0; k < 3; k++) {
        if (is_tag(tag, fractions[k])) return (cif_column){TAG_FRACTION, k};
        if (is_tag(tag, positions[k])) return (cif_column){TAG_POSITION, k};
    }
    if (is_tag(tag, "_atom_site_type_symbol")) return (cif_column){TAG_SYMBOL, 0};
    if (is_tag(tag, "_atom_site_label")) return (cif_column){TAG_LABEL, 0};
    if (is_tag(tag, "_atom_site_pdbx_pdb_model_num")) return (cif_column){TAG_MODEL, 0};
    if (is_tag(tag, "_atom_site_label_alt_id")) return (cif_column){TAG_ALTERNATE, 0};
    return (cif_column){is_tag(tag, OPERATION_TAGS) ? TAG_OPERATION : TAG_OTHER, 0};
}

/* Decides what the columns of a loop are. Returns in *sites whether its rows are atoms with positions. */
static brio_status plan(cif_reader *r, bool *sites) {
    static const char *const numbers[][2] = {{"_atom_site_occupancy", "occupancy"},
                                             {"_atom_site_u_iso_or_equiv", "u_iso"},
                                             {"_atom_site_b_iso_or_equiv", "b_iso"}};
    size_t found[TAG_OPERATION + 1] = {0};
    for (size_t i = 0; i < r->num_tags; i++) {
        r->columns[i] = column_of(r->tags[i]);
        found[r->columns[i].role]++;
    }
    *sites = found[TAG_FRACTION] == 3 || found[TAG_POSITION] == 3;
    if (*sites && r->has_sites) return brio_word_expected(r->s, r->tags[0], "one loop of sites");
    if (*sites) {
        r->has_sites = true;
        r->fractions = found[TAG_FRACTION] == 3;
        r->has_symbols = found[TAG_SYMBOL] > 0;
        BRIO_FORWARD(brio_atoms_plan(r->b));
    }
    for (size_t i = 0; i < r->num_tags; i++) {
        cif_column *c = &r->columns[i];
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers && *sites; n++) {
            if (!is_tag(r->tags[i], numbers[n][0]) || brio_builder_has(r->b, numbers[n][1])) continue;
            *c = (cif_column){TAG_NUMBER, r->b->mesh->num_properties};
            BRIO_FORWARD(brio_builder_property(r->b, numbers[n][1], BRIO_SCALAR_FLOAT64));
        }
        bool used = c->role == TAG_NUMBER || c->role == TAG_OPERATION ||
                    (*sites && (c->role == TAG_MODEL || c->role == TAG_ALTERNATE)) ||
                    (*sites && c->role == (r->fractions ? TAG_FRACTION : TAG_POSITION)) ||
                    (*sites && c->role == (r->has_symbols ? TAG_SYMBOL : TAG_LABEL));
        if (!used) BRIO_FORWARD(brio_builder_leave_out(r->b, r->tags[i]));
    }
    return BRIO_OK;
}

/* Finds the element of a label such as Si1, or OW2 for an oxygen: its longest beginning that is a symbol. */
static int element_of_label(const char *label) {
    int element = brio_element_of_word(label);
    for (size_t letters = 2; letters > 0 && !element; letters--)
        if (isalpha((unsigned char)label[letters - 1])) element = brio_element_of(label, letters);
    return element;
}

/* An atom, of a row whose values are read one after the other. */
typedef struct {
    double x[3];
    bool known[3];
    int element;
    double number[3];
    size_t target[3], num_numbers;
    bool further_model, alternate;
} cif_site;

static brio_status take_value(cif_reader *r, const cif_column *c, cif_site *site) {
    switch (c->role) {
    case TAG_OPERATION:
        take_operation(r);
        break;
    case TAG_FRACTION:
    case TAG_POSITION:
        if (r->fractions != (c->role == TAG_FRACTION) || is_missing(&r->token)) break;
        site->known[c->target] = true;
        return number(r, &site->x[c->target]);
    case TAG_SYMBOL:
        site->element = brio_element_of_word(r->token.text);
        break;
    case TAG_LABEL:
        if (!r->has_symbols) site->element = element_of_label(r->token.text);
        break;
    case TAG_NUMBER:
        site->target[site->num_numbers] = c->target;
        site->number[site->num_numbers] = NAN;
        site->num_numbers++;
        return is_missing(&r->token) ? BRIO_OK : number(r, &site->number[site->num_numbers - 1]);
    case TAG_MODEL:
        if (!r->model[0]) memcpy(r->model, r->token.text, sizeof r->model);
        site->further_model = strcmp(r->model, r->token.text) != 0;
        break;
    case TAG_ALTERNATE:
        site->alternate = !is_missing(&r->token) && strcmp(r->token.text, "A") != 0 && strcmp(r->token.text, "1") != 0;
        break;
    case TAG_OTHER:
        break;
    }
    return BRIO_OK;
}

static brio_status add_site(cif_reader *r, const cif_site *site) {
    brio_mesh *m = r->b->mesh;
    if (site->further_model) return brio_builder_leave_out(r->b, "further models");
    if (site->alternate) return brio_builder_leave_out(r->b, "alternate locations");
    if (!site->known[0] || !site->known[1] || !site->known[2])
        return brio_builder_leave_out(r->b, "sites without positions");
    BRIO_FORWARD(brio_builder_vertex(r->b, site->x));
    brio_atoms_set_element(r->b, site->element);
    for (size_t n = 0; n < site->num_numbers; n++)
        ((double *)m->properties[site->target[n]].data)[m->num_vertices - 1] = site->number[n];
    return BRIO_OK;
}

static brio_status read_loop(cif_reader *r) {
    bool sites;
    r->num_tags = 0;
    BRIO_FORWARD(next(r));
    while (r->token.kind == TOKEN_TAG) {
        BRIO_EXPECT(r->s->ctx, r->num_tags < MOST_TAGS, BRIO_ERR_FORMAT, "%s: line %zu: a loop of more than %d columns",
                    r->s->name, r->s->line, MOST_TAGS);
        copy_tag(r, r->tags[r->num_tags++]);
        BRIO_FORWARD(next(r));
    }
    if (!r->num_tags) return brio_word_expected(r->s, r->token.text, "a tag behind loop_");
    BRIO_FORWARD(plan(r, &sites));
    while (r->token.kind == TOKEN_VALUE) {
        cif_site site = {.element = 0};
        for (size_t i = 0; i < r->num_tags; i++) {
            BRIO_EXPECT(r->s->ctx, r->token.kind == TOKEN_VALUE, BRIO_ERR_FORMAT,
                        "%s: line %zu: a row of a loop ends at column %zu of %zu", r->s->name, r->s->line, i,
                        r->num_tags);
            BRIO_FORWARD(take_value(r, &r->columns[i], &site));
            BRIO_FORWARD(next(r));
        }
        if (sites) BRIO_FORWARD(add_site(r, &site));
    }
    return BRIO_OK;
}

/* --- the cell --- */

static bool has_cell(const cif_reader *r) {
    for (int k = 0; k < 3; k++)
        if (!r->has_length[k] || !r->has_angle[k]) return false;
    return true;
}

static bool is_in_p1(const cif_reader *r) {
    if (r->operations) return r->operations == 1 && !r->other_operations;
    return r->group_number > 0 ? r->group_number == 1 : brio_is_p1(r->group);
}

/* Makes positions of fractions, and keeps the cell. */
static brio_status use_cell(cif_reader *r) {
    static const bool all[3] = {true, true, true};
    double cell[9];
    brio_mesh *m = r->b->mesh;
    const char *group = r->group[0] ? r->group : "another one";
    BRIO_EXPECT(r->s->ctx, !r->fractions || has_cell(r), BRIO_ERR_FORMAT,
                "%s: sites are fractions of a cell, but its lengths and angles are not all there", r->s->name);
    BRIO_EXPECT(r->s->ctx, !r->fractions || is_in_p1(r), BRIO_ERR_FORMAT,
                "%s: the space group is not P1 (%s), so the file lists only some of the atoms of a cell; expected all "
                "of them, in P1",
                r->s->name, group);
    if (!has_cell(r)) return BRIO_OK;
    BRIO_EXPECT(r->s->ctx, brio_cell_of_lengths(r->length, r->angle, cell), BRIO_ERR_FORMAT,
                "%s: there is no cell of the lengths %g, %g, %g and the angles %g, %g, %g", r->s->name, r->length[0],
                r->length[1], r->length[2], r->angle[0], r->angle[1], r->angle[2]);
    if (!is_in_p1(r)) return brio_builder_leave_out(r->b, "cell, whose space group is not P1");
    for (size_t v = 0; v < m->num_vertices && r->fractions; v++)
        brio_cell_position(cell, m->vertices + 3 * v, m->vertices + 3 * v);
    return brio_cell_keep(r->b, cell, all);
}

/* Begins a data block: what blocks before it said of a cell is of no use. */
static void begin_block(cif_reader *r) {
    for (int k = 0; k < 3; k++) r->has_length[k] = r->has_angle[k] = false;
    r->group[0] = 0;
    r->group_number = 0;
    r->operations = 0;
    r->other_operations = false;
}

static brio_status read_blocks(cif_reader *r) {
    char tag[64];
    BRIO_FORWARD(next(r));
    while (r->token.kind != TOKEN_END) {
        switch (r->token.kind) {
        case TOKEN_DATA:
            if (r->has_sites) return brio_builder_leave_out(r->b, "further blocks");
            begin_block(r);
            BRIO_FORWARD(next(r));
            break;
        case TOKEN_LOOP:
            BRIO_FORWARD(read_loop(r));
            break;
        case TOKEN_TAG:
            copy_tag(r, tag);
            BRIO_FORWARD(next(r));
            if (r->token.kind != TOKEN_VALUE) return brio_word_expected(r->s, r->token.text, "the value of a tag");
            BRIO_FORWARD(take_item(r, tag));
            BRIO_FORWARD(next(r));
            break;
        default:
            return brio_word_expected(r->s, r->token.text, "a tag, loop_ or data_");
        }
    }
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    cif_reader *r = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, r, 1));
    r->s = s, r->b = b;
    BRIO_TRY(read_blocks(r));
    BRIO_REQUIRE(s->ctx, r->has_sites, BRIO_ERR_FORMAT,
                 "%s: there is no loop of sites of atoms: _atom_site_fract_x, _y and _z", s->name);
    BRIO_TRY(use_cell(r));
done:
    brio_release(s->ctx, r);
    return status;
}

const brio_codec brio_cif_codec = {.read = read_file};
