/* Reads VASP's POSCAR and CONTCAR: a comment; a scale; three vectors; the symbols of the species, which old files lack;
 * their numbers of atoms; "Selective dynamics", if there is such a line; "Direct" or "Cartesian"; a row for each atom.
 *
 * A negative scale is the volume of the cell. Three scales belong to x, y and z. Behind the atoms there may be
 * velocities and more, which are left out.
 *
 * Based on: The VASP Manual, POSCAR. University of Vienna. */
#include "base/memory.h"
#include "io/atoms/atoms.h"
#include "io/formats.h"
#include "io/number.h"
#include <math.h>
#include <string.h>

typedef struct {
    brio_stream *s;
    brio_builder *b;
    brio_words words;
    double scale[3], cell[9];
    uint64_t count[BRIO_MOST_WORDS]; /* atoms of each species */
    int element[BRIO_MOST_WORDS];
    size_t species;
    bool symbols, selective, cartesian;
    size_t type, moves; /* indices of properties */
} poscar_reader;

static const bool all_directions[3] = {true, true, true};

/* Reads the next line with words. Words from the second on end at a comment. */
static brio_status next(poscar_reader *r) {
    brio_words *w = &r->words;
    BRIO_FORWARD(brio_words_next(r->s, 0, w));
    if (!w->count) return brio_stream_truncated(r->s);
    for (size_t i = 1; i < w->count; i++) {
        if (!strchr("!#", *w->of[i])) continue;
        w->count = i;
        return brio_builder_leave_out(r->b, "comment");
    }
    return BRIO_OK;
}

/* Reads the scale and the vectors, and multiplies. */
static brio_status read_cell(poscar_reader *r) {
    BRIO_FORWARD(next(r));
    size_t scales = 0;
    for (double number; scales < 3 && scales < r->words.count; scales++) {
        const char *p = r->words.of[scales];
        if (scales && (!brio_parse_number(&p, &number) || *p)) break; /* words behind one scale */
        BRIO_FORWARD(brio_word_number(r->s, &r->words, scales, "a scale", &r->scale[scales]));
    }
    BRIO_EXPECT(r->s->ctx, scales != 2, BRIO_ERR_FORMAT, "%s: line %zu: 2 scales, expected 1 or 3", r->s->name,
                r->s->line);
    if (scales == 1) r->scale[1] = r->scale[2] = r->scale[0];
    for (int k = 0; k < 3; k++)
        if (r->scale[k] == 0 || (scales == 3 && r->scale[k] < 0))
            return brio_word_expected(r->s, r->words.of[k < (int)scales ? k : 0], "a scale that is not 0");
    for (size_t i = 0; i < 3; i++) {
        BRIO_FORWARD(next(r));
        for (size_t k = 0; k < 3; k++)
            BRIO_FORWARD(brio_word_number(r->s, &r->words, k, "a number of a vector of the cell", &r->cell[3 * i + k]));
    }
    double volume = brio_cell_volume(r->cell);
    BRIO_EXPECT(r->s->ctx, volume > 0 && isfinite(volume), BRIO_ERR_FORMAT,
                "%s: line %zu: the vectors of the cell span no volume", r->s->name, r->s->line);
    if (r->scale[0] < 0) r->scale[0] = r->scale[1] = r->scale[2] = cbrt(-r->scale[0] / volume);
    for (size_t i = 0; i < 9; i++) r->cell[i] *= r->scale[i % 3];
    return BRIO_OK;
}

/* Finds the element of a symbol such as Fe, Fe_pv or Fe/a1b2. */
static int element_of_symbol(char *word) {
    word[strcspn(word, "/_")] = 0;
    return brio_element_of_word(word);
}

static brio_status read_species(poscar_reader *r, uint64_t *all) {
    BRIO_FORWARD(next(r));
    const char *p = r->words.of[0];
    uint64_t number;
    r->symbols = !brio_parse_count(&p, &number) || *p;
    if (r->symbols) {
        r->species = r->words.count;
        for (size_t i = 0; i < r->species; i++) r->element[i] = element_of_symbol(r->words.of[i]);
        BRIO_FORWARD(next(r));
    }
    size_t counts = 0;
    *all = 0;
    for (; counts < r->words.count && counts < (r->symbols ? r->species : BRIO_MOST_WORDS); counts++) {
        p = r->words.of[counts];
        if (!r->symbols && counts && (!brio_parse_count(&p, &number) || *p)) break; /* a comment */
        BRIO_FORWARD(
            brio_word_count(r->s, &r->words, counts, "a number of atoms", BRIO_MAX_VERTICES, &r->count[counts]));
        *all += r->count[counts];
    }
    BRIO_EXPECT(r->s->ctx, !r->symbols || counts == r->species, BRIO_ERR_FORMAT,
                "%s: line %zu: %zu numbers of atoms for %zu species", r->s->name, r->s->line, counts, r->species);
    r->species = counts;
    BRIO_EXPECT(r->s->ctx, *all <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE, "%s: line %zu: more than 2^32 atoms",
                r->s->name, r->s->line);
    return BRIO_OK;
}

static brio_status read_mode(poscar_reader *r) {
    BRIO_FORWARD(next(r));
    r->selective = strchr("Ss", r->words.of[0][0]) != NULL;
    if (r->selective) BRIO_FORWARD(next(r));
    r->cartesian = strchr("CcKk", r->words.of[0][0]) != NULL;
    if (!r->cartesian && !strchr("Dd", r->words.of[0][0]))
        return brio_word_expected(r->s, r->words.of[0], "Direct or Cartesian");
    return BRIO_OK;
}

static brio_status plan(poscar_reader *r) {
    static const char *const moves[3] = {"moves_a", "moves_b", "moves_c"};
    if (r->symbols) BRIO_FORWARD(brio_atoms_plan(r->b));
    r->type = r->b->mesh->num_properties;
    BRIO_FORWARD(brio_builder_property(r->b, "type", BRIO_SCALAR_INT32));
    r->moves = r->b->mesh->num_properties;
    for (int k = 0; k < 3 && r->selective; k++) BRIO_FORWARD(brio_builder_property(r->b, moves[k], BRIO_SCALAR_UINT8));
    return BRIO_OK;
}

static brio_status read_atom(poscar_reader *r, size_t species) {
    double x[3];
    brio_mesh *m = r->b->mesh;
    for (size_t k = 0; k < 3; k++) BRIO_FORWARD(brio_word_number(r->s, &r->words, k, "a coordinate", &x[k]));
    for (int k = 0; k < 3 && r->cartesian; k++) x[k] *= r->scale[k];
    if (!r->cartesian) brio_cell_position(r->cell, x, x);
    BRIO_FORWARD(brio_builder_vertex(r->b, x));
    size_t v = m->num_vertices - 1;
    ((int32_t *)m->properties[r->type].data)[v] = (int32_t)species + 1;
    if (r->symbols) brio_atoms_set_element(r->b, r->element[species]);
    for (size_t k = 0; k < 3 && r->selective; k++) {
        const char *word = 3 + k < r->words.count ? r->words.of[3 + k] : NULL;
        if (!word || !strchr("TtFf.", *word)) return brio_word_expected(r->s, word, "T or F: whether the atom moves");
        ((uint8_t *)m->properties[r->moves + k].data)[v] = strchr("Tt", word[*word == '.']) != NULL;
    }
    if (r->words.count > (r->selective ? 6u : 3u)) BRIO_FORWARD(brio_builder_leave_out(r->b, "labels of atoms"));
    return BRIO_OK;
}

static brio_status read_atoms(poscar_reader *r, uint64_t all) {
    size_t species = 0;
    uint64_t left = r->species ? r->count[0] : 0;
    BRIO_FORWARD(brio_stream_expect(r->s, all, 6, "the line of the numbers of atoms")); /* "0 0 0" */
    brio_builder_stream(r->b, all);
    brio_stream_element(r->s, "atom", all);
    for (; r->s->row < all; r->s->row++) {
        while (!left) left = r->count[++species];
        BRIO_FORWARD(next(r));
        BRIO_FORWARD(read_atom(r, species));
        left--;
    }
    BRIO_FORWARD(brio_words_next(r->s, 0, &r->words));
    return r->words.count ? brio_builder_leave_out(r->b, "what follows the positions") : BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    poscar_reader r = {.s = s, .b = b};
    uint64_t all = 0;
    char *comment;
    BRIO_FORWARD(brio_stream_line(s, &comment));
    if (!comment) return brio_stream_truncated(s);
    brio_words_split(comment, 0, &r.words);
    if (r.words.count) BRIO_FORWARD(brio_builder_leave_out(b, "comment"));
    BRIO_FORWARD(read_cell(&r));
    BRIO_FORWARD(brio_cell_keep(b, r.cell, all_directions));
    BRIO_FORWARD(read_species(&r, &all));
    BRIO_FORWARD(read_mode(&r));
    BRIO_FORWARD(plan(&r));
    return read_atoms(&r, all);
}

const brio_codec brio_poscar_codec = {.read = read_file};
