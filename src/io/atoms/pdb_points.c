/* Reads the atoms of the Protein Data Bank's files as points, with the cell.
 *
 * Of the first model, and of each atom's alternate locations those marked blank, A or 1; water stays. CRYST1 has the
 * cell: lengths in columns 7 to 33, angles in 34 to 54, the space group in 56 to 66. In another group than P1 the atoms
 * are only some of a cell, which is left out then.
 *
 * Based on: Worldwide Protein Data Bank. Atomic coordinate entry format version 3.3. 2012. */
#include "io/atoms/atoms.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/pdb.h"
#include "io/textrow.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Columns of a record, the first counted from 0. */
typedef struct {
    int first, width;
} pdb_columns;

static const pdb_columns OCCUPANCY = {54, 6}, FACTOR = {60, 6}, NUMBER = {22, 4};

enum { CELL = 6, LENGTH_WIDTH = 9, ANGLES = 33, ANGLE_WIDTH = 7, GROUP = 55, GROUP_WIDTH = 11 };

/* Copies columns of a line, those that it has. Returns them without blanks in front. */
static const char *take_columns(const char *line, pdb_columns c, char field[16]) {
    size_t length = strlen(line), n = 0;
    for (; n < (size_t)c.width && (size_t)c.first + n < length; n++) field[n] = line[(size_t)c.first + n];
    while (n > 0 && brio_is_blank(field[n - 1])) n--;
    field[n] = 0;
    return brio_skip_blanks(field);
}

/* Reads a number, NaN where the columns are blank. */
static brio_status parse_columns(const brio_stream *s, const char *line, pdb_columns c, const char *what,
                                 double *value) {
    char field[16];
    const char *p = take_columns(line, c, field);
    *value = NAN;
    BRIO_EXPECT(s->ctx, !*p || (brio_parse_number(&p, value) && !*p), BRIO_ERR_FORMAT,
                "%s: line %zu: columns %d to %d: expected %s, found \"%s\"", s->name, s->line, c.first + 1,
                c.first + c.width, what, brio_skip_blanks(field));
    return BRIO_OK;
}

/* Reads the number of a residue: NaN where the columns are blank, or have letters or stars instead, as many programs
 * write numbers that four columns cannot hold. */
static brio_status take_residue(brio_builder *b, const char *line, double *value) {
    char field[16];
    const char *p = take_columns(line, NUMBER, field);
    const bool blank = !*p, negative = *p == '-';
    uint64_t number;
    p += negative;
    *value = NAN;
    if (blank) return BRIO_OK;
    if (!brio_parse_count(&p, &number) || *p)
        return brio_builder_leave_out(b, "numbers of residues that are not decimal");
    *value = negative ? -(double)number : (double)number;
    return BRIO_OK;
}

/* Keeps the cell of CRYST1. Files without a crystal have one of 1 by 1 by 1, or of lengths of 0, which is none. */
static brio_status take_cell(const brio_stream *s, brio_builder *b, const char *line) {
    static const bool all[3] = {true, true, true};
    double lengths[3], angles[3], cell[9];
    char field[16], none[96];
    bool unit = true, zero = true;
    for (int k = 0; k < 3; k++) {
        const pdb_columns length = {CELL + k * LENGTH_WIDTH, LENGTH_WIDTH},
                          angle = {ANGLES + k * ANGLE_WIDTH, ANGLE_WIDTH};
        BRIO_FORWARD(parse_columns(s, line, length, "a length of the cell", &lengths[k]));
        BRIO_FORWARD(parse_columns(s, line, angle, "an angle of the cell", &angles[k]));
        unit &= lengths[k] == 1 && angles[k] == 90;
        zero &= lengths[k] == 0;
    }
    if (unit || zero) return BRIO_OK;
    BRIO_EXPECT(s->ctx, brio_cell_of_lengths(lengths, angles, cell), BRIO_ERR_FORMAT,
                "%s: line %zu: there is no cell of the lengths %g, %g, %g and the angles %g, %g, %g", s->name, s->line,
                lengths[0], lengths[1], lengths[2], angles[0], angles[1], angles[2]);
    const char *group = take_columns(line, (pdb_columns){GROUP, GROUP_WIDTH}, field);
    if (brio_is_p1(group)) return brio_cell_keep(b, cell, all);
    snprintf(none, sizeof none, "cell, whose space group is %s", group);
    return brio_builder_leave_out(b, none);
}

/* Names what an atom's record has and a point has not, where the columns are not blank. */
static brio_status leave_out_columns(brio_builder *b, const char *line) {
    static const struct {
        pdb_columns columns;
        const char *name;
    } parts[] = {{{12, 4}, "names of atoms"},  {{17, 3}, "names of residues"}, {{21, 1}, "chains"},
                 {{26, 1}, "insertion codes"}, {{72, 4}, "segments"},          {{78, 2}, "charges"}};
    char field[16];
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (*take_columns(line, parts[i].columns, field)) BRIO_FORWARD(brio_builder_leave_out(b, parts[i].name));
    return BRIO_OK;
}

static brio_status add_point(const brio_stream *s, brio_builder *b, const char *line) {
    double x[3], value[3];
    int element;
    BRIO_FORWARD(brio_pdb_atom(s, line, x, &element));
    if (!brio_pdb_is_first_location(line)) return brio_builder_leave_out(b, "alternate locations");
    BRIO_FORWARD(brio_builder_vertex(b, x));
    brio_atoms_set_element(b, element);
    BRIO_FORWARD(parse_columns(s, line, OCCUPANCY, "an occupancy", &value[0]));
    BRIO_FORWARD(parse_columns(s, line, FACTOR, "a temperature factor", &value[1]));
    BRIO_FORWARD(take_residue(b, line, &value[2]));
    for (size_t k = 0; k < 3; k++) ((double *)b->mesh->properties[2 + k].data)[b->mesh->num_vertices - 1] = value[k];
    return leave_out_columns(b, line);
}

/* Notes that a record is not read, by its name. */
static brio_status leave_out_record(brio_builder *b, const char *line) {
    static const char *const nothing[] = {"TER", "END", "MODEL", "MASTER", NULL};
    char name[7] = "";
    for (size_t i = 0; i < 6 && line[i] && !brio_is_blank(line[i]); i++) name[i] = line[i], name[i + 1] = 0;
    for (const char *const *n = nothing; *n; n++)
        if (!strcmp(name, *n)) return BRIO_OK;
    return name[0] ? brio_builder_leave_out(b, name) : BRIO_OK;
}

static brio_status read_points(brio_stream *s, brio_builder *b) {
    static const char *const names[3] = {"occupancy", "temperature_factor", "residue"};
    char *line;
    bool first = true; /* model */
    BRIO_FORWARD(brio_atoms_plan(b));
    for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_builder_property(b, names[k], BRIO_SCALAR_FLOAT64));
    for (;;) {
        BRIO_FORWARD(brio_stream_line(s, &line));
        if (!line) break;
        if (!strncmp(line, "ENDMDL", 6))
            first = false;
        else if (!strncmp(line, "CRYST1", 6))
            BRIO_FORWARD(take_cell(s, b, line));
        else if (!brio_pdb_is_atom(line))
            BRIO_FORWARD(leave_out_record(b, line));
        else if (first)
            BRIO_FORWARD(add_point(s, b, line));
        else
            BRIO_FORWARD(brio_builder_leave_out(b, "further models"));
    }
    BRIO_EXPECT(s->ctx, brio_builder_count(b), BRIO_ERR_FORMAT, "%s: no line is an atom (ATOM or HETATM)", s->name);
    return BRIO_OK;
}

const brio_codec brio_pdb_codec = {.read = read_points};
