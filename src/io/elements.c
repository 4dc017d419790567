/* The table of elements.
 *
 * Based on: Bondi. Van der Waals volumes and radii. Journal of Physical Chemistry 1964.
 *           Rowland, Taylor. Intermolecular nonbonded contact distances in organic crystal structures. Journal of
 *           Physical Chemistry 1996 (hydrogen). */
#include "io/elements.h"
#include <string.h>
#include <strings.h>

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
