/* Reads atoms from files of the Protein Data Bank, as balls; their records, which atoms/pdb_points.c reads as points.
 *
 * An atom is a line that begins with ATOM or HETATM. Its columns are fixed: 13 to 16 the name, 17 the alternate
 * location, 18 to 20 the residue, 31 to 54 the coordinates in angstrom, 77 and 78 the element. If the element is
 * missing, the first two columns of the name give it, right-justified.
 *
 * Based on: Worldwide Protein Data Bank. Atomic coordinate entry format version 3.3. 2012.
 *           Bondi. Van der Waals volumes and radii. Journal of Physical Chemistry 1964.
 *           Rowland, Taylor. Intermolecular nonbonded contact distances in organic crystal structures. Journal of
 *           Physical Chemistry 1996 (hydrogen). */
#include "io/pdb.h"
#include "base/memory.h"
#include "io/number.h"
#include "io/textrow.h"
#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

/* --- elements --- */

static const double OTHER_RADIUS = 1.8; /* of elements that are not in the table, mostly metals; chosen */

static const char symbols[BRIO_LAST_ELEMENT + 1][3] = {
    "",   "H",  "He", "Li", "Be", "B",  "C",  "N",  "O",  "F",  "Ne", "Na", "Mg", "Al", "Si", "P",  "S",
    "Cl", "Ar", "K",  "Ca", "Sc", "Ti", "V",  "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As",
    "Se", "Br", "Kr", "Rb", "Sr", "Y",  "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In", "Sn",
    "Sb", "Te", "I",  "Xe", "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho",
    "Er", "Tm", "Yb", "Lu", "Hf", "Ta", "W",  "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po",
    "At", "Rn", "Fr", "Ra", "Ac", "Th", "Pa", "U",  "Np", "Pu", "Am", "Cm", "Bk", "Cf", "Es", "Fm", "Md",
    "No", "Lr", "Rf", "Db", "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh", "Fl", "Mc", "Lv", "Ts", "Og"};

static const double radii[BRIO_LAST_ELEMENT + 1] = {
    [1] = 1.10,  [3] = 1.82,  [6] = 1.70,  [7] = 1.55,  [8] = 1.52,  [9] = 1.47,  [11] = 2.27,
    [12] = 1.73, [14] = 2.10, [15] = 1.80, [16] = 1.80, [17] = 1.75, [19] = 2.75, [28] = 1.63,
    [29] = 1.40, [30] = 1.39, [33] = 1.85, [34] = 1.90, [35] = 1.85, [53] = 1.98};

int brio_element_of(const char *symbol, size_t length) {
    if (length == 1 && strchr("DdTt", *symbol)) return 1;
    for (int i = 1; i <= BRIO_LAST_ELEMENT; i++)
        if (strlen(symbols[i]) == length && !strncasecmp(symbols[i], symbol, length)) return i;
    return 0;
}

double brio_van_der_waals_radius(int atomic_number) {
    return radii[atomic_number] > 0 ? radii[atomic_number] : OTHER_RADIUS;
}

/* --- atoms --- */

enum {
    NAME = 12,
    ALTERNATE = 16,
    RESIDUE = 17,
    COORDINATES = 30,
    COORDINATE_WIDTH = 8,
    ELEMENT = 76,
    NEEDED = COORDINATES + 3 * COORDINATE_WIDTH
};

/* Copies the letters of two columns, in capitals. */
static void take_letters(const char *columns, char element[3]) {
    size_t n = 0;
    for (int i = 0; i < 2; i++)
        if (isalpha((unsigned char)columns[i])) element[n++] = (char)toupper((unsigned char)columns[i]);
    element[n] = 0;
}

/* Finds the element of an atom. A name of four characters that begins with H is that of a hydrogen. */
static void find_element(const char *line, size_t length, char element[3]) {
    element[0] = 0;
    if (length >= ELEMENT + 2) take_letters(line + ELEMENT, element);
    if (element[0]) return;
    bool hydrogen = toupper((unsigned char)line[NAME]) == 'H' && line[NAME + 3] != ' ';
    if (hydrogen)
        strcpy(element, "H");
    else
        take_letters(line + NAME, element);
}

bool brio_pdb_is_atom(const char *line) {
    return !strncmp(line, "ATOM", 4) || !strncmp(line, "HETATM", 6);
}

bool brio_pdb_is_first_location(const char *line) {
    return strchr(" A1", line[ALTERNATE]) != NULL;
}

static bool is_wanted(const char *line) {
    static const char *const water[] = {"HOH", "WAT", "DOD", "H2O"};
    for (size_t i = 0; i < sizeof water / sizeof *water; i++)
        if (!strncmp(line + RESIDUE, water[i], 3)) return false;
    return brio_pdb_is_first_location(line);
}

static brio_status parse_coordinate(const brio_stream *s, const char *line, int axis, double *value) {
    char field[COORDINATE_WIDTH + 1] = {0};
    int first = COORDINATES + axis * COORDINATE_WIDTH;
    memcpy(field, line + first, COORDINATE_WIDTH);
    const char *p = brio_skip_blanks(field);
    BRIO_EXPECT(s->ctx, brio_parse_number(&p, value) && !p[strspn(p, " ")], BRIO_ERR_FORMAT,
                "%s: line %zu: columns %d to %d: expected the coordinate %c, found \"%s\"", s->name, s->line, first + 1,
                first + COORDINATE_WIDTH, "xyz"[axis], field);
    BRIO_EXPECT(s->ctx, isfinite(*value), BRIO_ERR_NOT_FINITE, "%s: line %zu: the coordinate %c is not finite", s->name,
                s->line, "xyz"[axis]);
    return BRIO_OK;
}

brio_status brio_pdb_atom(const brio_stream *s, const char *line, double position[3], int *atomic_number) {
    char element[3];
    size_t length = strlen(line);
    BRIO_EXPECT(s->ctx, length >= NEEDED, BRIO_ERR_FORMAT,
                "%s: line %zu: an atom of %zu columns, expected coordinates in columns %d to %d", s->name, s->line,
                length, COORDINATES + 1, NEEDED);
    for (int k = 0; k < 3; k++) BRIO_FORWARD(parse_coordinate(s, line, k, &position[k]));
    find_element(line, length, element);
    *atomic_number = brio_element_of(element, strlen(element));
    return BRIO_OK;
}

brio_status brio_pdb_read(brio_stream *s, brio_atom **atoms, size_t *num_atoms) {
    brio_status status = BRIO_OK;
    brio_atom *list = NULL;
    size_t count = 0, capacity = 0;
    char *line;
    int element;
    *atoms = NULL;
    *num_atoms = 0;
    for (;;) {
        BRIO_TRY(brio_stream_line(s, &line));
        if (!line || !strncmp(line, "ENDMDL", 6)) break;
        if (!brio_pdb_is_atom(line)) continue;
        BRIO_TRY(BRIO_RESERVE(s->ctx, list, capacity, count + 1));
        BRIO_TRY(brio_pdb_atom(s, line, list[count].position, &element));
        list[count].radius = brio_van_der_waals_radius(element);
        count += is_wanted(line);
    }
    BRIO_REQUIRE(s->ctx, count, BRIO_ERR_FORMAT, "%s: no line is an atom (ATOM or HETATM) other than of water",
                 s->name);
    *atoms = list;
    *num_atoms = count;
    list = NULL;
done:
    brio_release(s->ctx, list);
    return status;
}
