/* Reads text dumps of LAMMPS: sections that begin with ITEM:, the last of which has a row for each atom, whose columns
 * it names. Positions are x y z, unwrapped (xu), shares of the box (xs), or both (xsu); the first of these sets that is
 * whole counts. A column `element` has symbols. Other columns of numbers become properties.
 *
 * BOX BOUNDS has the bounds of the box along the axes; with xy xz yz, the bounds of the tilted box, and its tilts; with
 * abc origin, three vectors and a corner. Of several frames the first is read.
 *
 * Based on: LAMMPS Documentation, the commands dump and thermo, How-to triclinic. Sandia National Laboratories. */
#include "io/atoms/atoms.h"
#include "base/memory.h"
#include "io/formats.h"
#include "io/number.h"
#include <math.h>
#include <string.h>

typedef enum { COLUMN_LEFT_OUT, COLUMN_ELEMENT, COLUMN_AXIS, COLUMN_NUMBER } column_role;

typedef struct {
    column_role role;
    size_t target; /* axis, or index of the property */
} dump_column;

typedef struct {
    brio_stream *s;
    brio_builder *b;
    brio_words words;
    brio_lammps_box box;
    double cell[9], corner[3];
    uint64_t atoms;
    bool has_count, has_box, scaled;
    char (*names)[64];
    dump_column columns[BRIO_MOST_WORDS];
    size_t num_columns;
} dump_reader;

/* --- the box --- */

brio_status brio_lammps_keep_box(const brio_stream *s, brio_builder *b, const brio_lammps_box *box, double cell[9],
                                 double corner[3]) {
    const double tilted[9] = {
        box->high[0] - box->low[0], 0, 0, box->tilt[0], box->high[1] - box->low[1], 0, box->tilt[1], box->tilt[2],
        box->high[2] - box->low[2]};
    memcpy(cell, box->general ? box->vectors : tilted, sizeof tilted);
    memcpy(corner, box->general ? box->corner : box->low, 3 * sizeof *corner);
    double volume = brio_cell_volume(cell);
    BRIO_EXPECT(s->ctx, volume > 0 && isfinite(volume), BRIO_ERR_FORMAT, "%s: line %zu: the box has no volume", s->name,
                s->line);
    return brio_cell_keep(b, cell, box->periodic);
}

static brio_status next(dump_reader *r) {
    BRIO_FORWARD(brio_words_next(r->s, 0, &r->words));
    return r->words.count ? BRIO_OK : brio_stream_truncated(r->s);
}

/* Reads the three lines of a box.   bounds  the words behind BOX BOUNDS, which the next line overwrites. */
static brio_status read_box(dump_reader *r) {
    brio_lammps_box *box = &r->box;
    const brio_words *w = &r->words;
    static const char *const wanted[4] = {"a bound of the box", "a bound of the box", "a tilt of the box", "a corner"};
    bool tilted = w->count > 3 && !strcmp(w->of[3], "xy"), general = w->count > 3 && !strcmp(w->of[3], "abc");
    double rows[3][4] = {{0}};
    for (size_t k = 0; k < 3; k++) {
        bool flagged = w->count >= 6 && strlen(w->of[w->count - 3 + k]) == 2;
        box->periodic[k] = !flagged || w->of[w->count - 3 + k][0] == 'p';
    }
    for (size_t k = 0; k < 3; k++) {
        BRIO_FORWARD(next(r));
        for (size_t i = 0; i < (general ? 4 : tilted ? 3 : 2); i++)
            BRIO_FORWARD(brio_word_number(r->s, w, i, wanted[i], &rows[k][i]));
    }
    for (size_t k = 0; k < 3; k++) {
        box->low[k] = rows[k][0], box->high[k] = rows[k][1], box->tilt[k] = rows[k][2];
        memcpy(box->vectors + 3 * k, rows[k], 3 * sizeof(double));
        box->corner[k] = rows[k][3];
    }
    if (tilted) { /* bounds of the tilted box */
        double xy = box->tilt[0], xz = box->tilt[1], yz = box->tilt[2];
        box->low[0] -= fmin(fmin(0, xy), fmin(xz, xy + xz));
        box->high[0] -= fmax(fmax(0, xy), fmax(xz, xy + xz));
        box->low[1] -= fmin(0, yz);
        box->high[1] -= fmax(0, yz);
    }
    if (!tilted) box->tilt[0] = box->tilt[1] = box->tilt[2] = 0;
    box->general = general;
    r->has_box = true;
    return brio_lammps_keep_box(r->s, r->b, box, r->cell, r->corner);
}

/* --- columns --- */

/* Finds the columns of x, y and z. Returns false if there are none. */
static bool find_axes(dump_reader *r, size_t axes[3]) {
    static const char *const sets[4][3] = {
        {"x", "y", "z"}, {"xu", "yu", "zu"}, {"xs", "ys", "zs"}, {"xsu", "ysu", "zsu"}};
    for (int set = 0; set < 4; set++) {
        int found = 0;
        for (int k = 0; k < 3; k++)
            for (size_t i = 0; i < r->num_columns; i++)
                if (!strcmp(r->names[i], sets[set][k])) {
                    axes[k] = i, found++;
                    break;
                }
        r->scaled = set >= 2;
        if (found == 3) return true;
    }
    return false;
}

static brio_status take_names(dump_reader *r) {
    r->num_columns = r->words.count - 2; /* ITEM: ATOMS */
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->s->ctx, r->names, r->num_columns + 1));
    for (size_t i = 0; i < r->num_columns; i++) strncat(r->names[i], r->words.of[2 + i], sizeof r->names[i] - 1);
    return BRIO_OK;
}

static bool is_number(const char *word) {
    double value;
    return brio_parse_number(&word, &value) && !*word;
}

/* Decides what each column is; the words are those of the first row. */
static brio_status plan(dump_reader *r) {
    size_t axes[3];
    BRIO_EXPECT(r->s->ctx, find_axes(r, axes), BRIO_ERR_FORMAT,
                "%s: line %zu: ITEM: ATOMS names no columns x y z, xu yu zu, xs ys zs or xsu ysu zsu", r->s->name,
                r->s->line);
    for (size_t i = 0; i < r->num_columns; i++)
        if (!strcmp(r->names[i], "element") && r->b->mesh->num_properties == 0) {
            BRIO_FORWARD(brio_atoms_plan(r->b));
            r->columns[i].role = COLUMN_ELEMENT;
        }
    for (size_t i = 0; i < r->num_columns; i++) {
        char name[64];
        bool axis = false;
        for (size_t k = 0; k < 3; k++)
            if (axes[k] == i) r->columns[i] = (dump_column){COLUMN_AXIS, k}, axis = true;
        if (axis || r->columns[i].role == COLUMN_ELEMENT) continue;
        if (i < r->words.count && !is_number(r->words.of[i])) {
            BRIO_FORWARD(brio_builder_leave_out(r->b, r->names[i]));
            continue;
        }
        r->columns[i] = (dump_column){COLUMN_NUMBER, r->b->mesh->num_properties};
        brio_builder_new_name(r->b, r->names[i], name);
        BRIO_FORWARD(brio_builder_property(r->b, name, BRIO_SCALAR_FLOAT64));
    }
    return BRIO_OK;
}

/* --- atoms --- */

static brio_status read_atom(dump_reader *r) {
    brio_mesh *m = r->b->mesh;
    double x[3] = {0, 0, 0}, value;
    BRIO_FORWARD(brio_builder_vertex(r->b, x));
    size_t v = m->num_vertices - 1;
    for (size_t i = 0; i < r->num_columns; i++) {
        const dump_column *c = &r->columns[i];
        if (i >= r->words.count) return brio_word_expected(r->s, NULL, "another column of the atom");
        if (c->role == COLUMN_ELEMENT) brio_atoms_set_element(r->b, brio_element_of_word(r->words.of[i]));
        if (c->role == COLUMN_AXIS) BRIO_FORWARD(brio_word_number(r->s, &r->words, i, "a coordinate", &x[c->target]));
        if (c->role != COLUMN_NUMBER) continue;
        const char *p = r->words.of[i];
        if (!brio_parse_number(&p, &value) || *p) return brio_word_expected(r->s, r->words.of[i], "a number");
        ((double *)m->properties[c->target].data)[v] = value;
    }
    if (r->scaled) brio_cell_position(r->cell, x, x);
    for (int k = 0; k < 3; k++) m->vertices[3 * v + (size_t)k] = x[k] + (r->scaled ? r->corner[k] : 0);
    return BRIO_OK;
}

static brio_status read_atoms(dump_reader *r) {
    BRIO_EXPECT(r->s->ctx, r->has_count && r->has_box, BRIO_ERR_FORMAT, "%s: line %zu: ITEM: ATOMS stands before %s",
                r->s->name, r->s->line, r->has_count ? "BOX BOUNDS" : "NUMBER OF ATOMS");
    BRIO_FORWARD(take_names(r));
    BRIO_FORWARD(brio_stream_expect(r->s, r->atoms, 6, "the number of atoms")); /* "0 0 0" */
    brio_stream_element(r->s, "atom", r->atoms);
    r->words.count = 0;
    if (r->atoms) BRIO_FORWARD(next(r));
    BRIO_FORWARD(plan(r));
    brio_builder_stream(r->b, r->atoms);
    for (; r->s->row < r->atoms; r->s->row++) {
        if (r->s->row) BRIO_FORWARD(next(r));
        BRIO_FORWARD(read_atom(r));
    }
    BRIO_FORWARD(brio_words_next(r->s, 0, &r->words));
    if (!r->words.count) return BRIO_OK;
    if (strcmp(r->words.of[0], "ITEM:") != 0)
        return brio_word_expected(r->s, r->words.of[0], "the end of the file, or ITEM: of a next frame");
    return brio_builder_leave_out(r->b, "further frames");
}

/* --- sections --- */

/* Returns whether a section's words behind ITEM: begin with those of a name. */
static bool is_section(const brio_words *w, const char *name) {
    for (size_t i = 1; *name; i++) {
        size_t length = strcspn(name, " ");
        if (i >= w->count || strlen(w->of[i]) != length || strncmp(w->of[i], name, length) != 0) return false;
        name += length + (name[length] == ' ');
    }
    return true;
}

/* Reads a section. Sets *last at that of the atoms. */
static brio_status read_section(dump_reader *r, bool *last) {
    static const char *const others[][2] = {{"TIMESTEP", "timestep"}, {"UNITS", "units"}, {"TIME", "time"}};
    const brio_words *w = &r->words;
    if (strcmp(w->of[0], "ITEM:") != 0) return brio_word_expected(r->s, w->of[0], "ITEM: of a section");
    *last = is_section(w, "ATOMS");
    if (*last) return read_atoms(r);
    if (is_section(w, "BOX BOUNDS")) return read_box(r);
    if (is_section(w, "NUMBER OF ATOMS")) {
        BRIO_FORWARD(next(r));
        r->has_count = true;
        return brio_word_count(r->s, w, 0, "the number of atoms", BRIO_MAX_VERTICES, &r->atoms);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (!is_section(w, others[i][0])) continue;
        BRIO_FORWARD(next(r));
        return brio_builder_leave_out(r->b, others[i][1]);
    }
    return brio_word_expected(r->s, w->count > 1 ? w->of[1] : NULL,
                              "TIMESTEP, UNITS, TIME, NUMBER OF ATOMS, BOX BOUNDS or ATOMS");
}

static bool starts(const char *bytes, size_t size) {
    static const char *const sections[] = {"ITEM: TIMESTEP", "ITEM: UNITS", "ITEM: NUMBER OF ATOMS"};
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
        if (size >= strlen(sections[i]) && !memcmp(bytes, sections[i], strlen(sections[i]))) return true;
    return false;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    dump_reader r = {.s = s, .b = b};
    brio_status status = BRIO_OK;
    for (bool last = false; !last;) {
        BRIO_TRY(next(&r));
        BRIO_TRY(read_section(&r, &last));
    }
done:
    brio_release(s->ctx, r.names);
    return status;
}

const brio_codec brio_lammps_dump_codec = {.starts = starts, .read = read_file};
