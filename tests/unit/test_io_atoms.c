/* Files of atoms with a cell: extended XYZ, PDB, CIF, POSCAR, LAMMPS. */
#include "failing_allocator.h"
#include "io_files.h"
#include <math.h>

static double value(const brio_mesh *m, const char *name, size_t i) {
    const brio_property *p = m ? brio_mesh_property(m, name) : NULL;
    EXPECT(p, "no %s", name);
    return p && i < m->num_vertices ? brio_property_value(p, i) : 0;
}

/* Expects a cell, and which of its vectors repeat. */
static void expect_cell(const brio_mesh *m, const char *directions, const double *wanted, double most) {
    double cell[9];
    int open[3];
    EXPECT(m && brio_mesh_cell(m, cell, open), "no cell");
    if (!m || !brio_mesh_cell(m, cell, open)) return;
    for (int i = 0; i < 9; i++)
        EXPECT(fabs(cell[i] - wanted[i]) <= most, "%d: %.17g, not %.17g", i, cell[i], wanted[i]);
    for (int k = 0; k < 3; k++) EXPECT(open[k] == !strchr(directions, "xyz"[k]), "%c", "xyz"[k]);
}

static void expect_no_cell(const char *name, const char *text) {
    double cell[9];
    int open[3];
    brio_mesh *m = io_read_text(name, text);
    EXPECT(m && !brio_mesh_cell(m, cell, open), "%s", text);
    brio_mesh_free(m);
}

static void expect_point(const brio_mesh *m, size_t v, double x, double y, double z) {
    const double wanted[3] = {x, y, z};
    for (size_t k = 0; m && v < m->num_vertices && k < 3; k++)
        EXPECT(fabs(m->vertices[3 * v + k] - wanted[k]) < 1e-14, "%zu: %.17g, not %g", v, m->vertices[3 * v + k],
               wanted[k]);
    EXPECT(m && v < m->num_vertices);
}

typedef struct {
    const char *name;
    bool found;
} part;

static void look_at(const char *name, void *user) {
    part *wanted = user;
    wanted->found |= !strcmp(name, wanted->name);
}

/* Expects that reading a text names a part that the mesh has not. */
static void expect_left_out(const char *name, const char *text, const char *what) {
    part wanted = {what, false};
    brio_read_options o = {.size = sizeof o, .left_out = look_at, .left_out_user = &wanted};
    brio_mesh *m = NULL;
    io_put(name, text, strlen(text));
    EXPECT(brio_read(io_ctx, io_path(name), &o, &m) == BRIO_OK && wanted.found, "%s", what);
    brio_mesh_free(m);
}

static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, tilted[9] = {2, 0, 0, 1, 2, 0, 0, 0, 2};

static void extended_xyz(void) {
    const double rows[9] = {1, 2, 3, 4, 5.5, 6, 7, 8, 9};
    static const char *const texts[] = {
        "1\nLattice=\"1 2 3 4 5.5 6 7 8 9\" Properties=species:S:1:pos:R:3 pbc=\"T F T\"\nH 0 0 0\n",
        "1\nProperties=species:S:1:pos:R:3 lattice={1 2 3 4 5.5 6 7 8 9} pbc={1 0 1}\nH 0 0 0\n",
        "1\npbc=[True, False, True] Lattice=[[1, 2, 3], [4, 5.5, 6], [7, 8, 9]] a=\"x y\"\nH 0 0 0\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        brio_mesh *m = io_read_text("a.extxyz", texts[i]);
        expect_cell(m, "xz", rows, 0);
        brio_mesh_free(m);
    }
    brio_mesh *m = io_read_text("a.extxyz", "1\nLattice=\"1 1 1\"\nH 0 0 0\n");
    expect_cell(m, "xyz", unit, 0);
    brio_mesh_free(m);
    expect_no_cell("a.extxyz", "1\nLattice=\"0 0 0 0 0 0 0 0 0\"\nH 0 0 0\n");
    expect_no_cell("a.extxyz", "1\nLattices=\"1 1 1\"\nH 0 0 0\n");
    m = io_read_text("a.extxyz", "1\nLattice=\"1 0 0 0 1 0 0 0 0\"\nH 0 0 0\n"); /* a vector of 0 does not repeat */
    expect_cell(m, "xy", (const double[9]){1, 0, 0, 0, 1}, 0);
    brio_mesh_free(m);
    io_expect_error("a.extxyz", "1\nLattice=\"1 2\"\nH 0 0 0\n", BRIO_ERR_FORMAT,
                    "line 2: Lattice=: expected 9 numbers");
    io_expect_error("a.extxyz", "1\nLattice=\"1 2 x\"\nH 0 0 0\n", BRIO_ERR_FORMAT, "line 2: Lattice=");
    io_expect_error("a.extxyz", "1\npbc=\"T T\"\nH 0 0 0\n", BRIO_ERR_FORMAT, "line 2: pbc=: expected T or F");
}

#define ATOM "ATOM      1  CA AGLY A  12       1.000   2.000   3.000  0.50 10.00           C\n"

static void pdb(void) {
    brio_mesh *m = io_read_text("a.pdb", "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\n" ATOM
                                         "HETATM    2  O   HOH A  13       4.000   5.000   6.000\n");
    expect_cell(m, "xyz", (const double[9]){10, 0, 0, 0, 20, 0, 0, 0, 30}, 0);
    EXPECT(m && m->num_vertices == 2 && value(m, "atomic_number", 1) == 8 && value(m, "occupancy", 0) == 0.5);
    EXPECT(isnan(value(m, "occupancy", 1)) && value(m, "residue", 1) == 13 && value(m, "radius", 0) == 1.7);
    expect_point(m, 0, 1, 2, 3);
    brio_mesh_free(m);
    expect_no_cell("a.ent", "CRYST1    1.000    1.000    1.000  90.00  90.00  90.00 P 1           1\n" ATOM);
    expect_no_cell("a.pdb", "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 21 21 21    8\n" ATOM);
    io_expect_error("a.pdb", "CRYST1   10.000   20.000   30.000  90.00  90.00  10.00 P 1\nCRYST1  xx\n",
                    BRIO_ERR_FORMAT, "line 2: columns 7 to 15: expected a length of the cell, found \"xx\"");
    io_expect_error("a.pdb", "CRYST1   10.000   20.000   30.000  20.00  20.00 120.00 P 1\n", BRIO_ERR_FORMAT,
                    "line 1: there is no cell of the lengths 10, 20, 30");
    io_expect_error("a.pdb", "ATOM      1  CA  GLY\n", BRIO_ERR_FORMAT, "line 1: an atom of");
    io_expect_error("a.pdb", "END\n", BRIO_ERR_FORMAT, "no line is an atom");
}

#define CELL                                                                                                           \
    "data_a\n_cell_length_a 2\n_cell_length_b 2.0(1)\n_cell_length_c 2\n_cell_angle_alpha 90\n_cell_angle_beta 90\n"   \
    "_cell_angle_gamma 60\n"
#define SITES "loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n"

static void cif(void) {
    static const char *const groups[] = {"",
                                         "_symmetry_space_group_name_H-M 'P 1'\n",
                                         "_space_group_IT_number 1\n",
                                         "_symmetry_space_group_name_H-M P1\n",
                                         "_space_group_symop_operation_xyz 'x, y, z'\n",
                                         "loop_\n_symmetry_equiv_pos_as_xyz\n+x,+y,+z\n"};
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        char text[2048];
        snprintf(text, sizeof text, "# c\n%s%s%sNa1 .5 .5 0.25(1) # c\n'OW 2' -0.5 0 1\n", CELL, groups[i], SITES);
        brio_mesh *m = io_read_text("a.cif", text);
        expect_cell(m, "xyz", (const double[9]){2, 0, 0, 1, sqrt(3), 0, 0, 0, 2}, 1e-15);
        EXPECT(m && m->num_vertices == 2 && value(m, "atomic_number", 0) == 11 && value(m, "atomic_number", 1) == 8);
        expect_point(m, 0, 1.5, sqrt(3) / 2, 0.5);
        expect_point(m, 1, -1, 0, 2);
        brio_mesh_free(m);
    }
    io_expect_error("a.cif", CELL "_symmetry_space_group_name_H-M 'F d -3 m'\n" SITES "Si 0 0 0\n", BRIO_ERR_FORMAT,
                    "the space group is not P1 (F d -3 m), so the file lists only some");
    io_expect_error("a.cif", CELL "loop_\n_symmetry_equiv_pos_as_xyz\nx,y,z\n-x,-y,-z\n" SITES "Si 0 0 0\n",
                    BRIO_ERR_FORMAT, "the space group is not P1");
    io_expect_error("a.cif", "data_a\n" SITES "Si 0 0 0\n", BRIO_ERR_FORMAT,
                    "its lengths and angles are not all there");
    io_expect_error("a.cif", CELL SITES "Si 0 0\n", BRIO_ERR_FORMAT, "line 13: a row of a loop ends at column 3 of 4");
    io_expect_error("a.cif", CELL SITES "Si 0 x 0\n", BRIO_ERR_FORMAT, "line 13: expected a number, found \"x\"");
    io_expect_error("a.cif", CELL "_a\n;b\n", BRIO_ERR_FORMAT, "line 9: a text field that begins here has no end");
    io_expect_error("a.cif", CELL "_a 'b\n", BRIO_ERR_FORMAT, "line 8: expected the end of a quoted value");
    io_expect_error("a.cif", CELL "_a _b\n", BRIO_ERR_FORMAT, "line 8: expected the value of a tag, found \"_b\"");
    io_expect_error("a.cif", CELL "b\n", BRIO_ERR_FORMAT, "line 8: expected a tag, loop_ or data_");
    io_expect_error("a.cif", CELL, BRIO_ERR_FORMAT, "there is no loop of sites of atoms");
    brio_mesh *m = io_read_text("a.cif", CELL "_symmetry.space_group_name_H-M 'P 21'\nloop_\n_atom_site.type_symbol\n"
                                              "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\nN 1 2 3\n");
    double cell[9];
    int open[3];
    EXPECT(m && !brio_mesh_cell(m, cell, open), "the cell of another group");
    expect_point(m, 0, 1, 2, 3);
    brio_mesh_free(m);
}

static void poscar(void) {
    brio_mesh *m =
        io_read_text("POSCAR", "c\n2.0 ! scale\n1 0 0\n.5 1 0\n0 0 1\nSi O_s\n1 2\nDirect\n0 0 0\n.5 .5 .5\n0 0 1\n");
    expect_cell(m, "xyz", tilted, 0);
    EXPECT(m && m->num_vertices == 3 && value(m, "atomic_number", 2) == 8 && value(m, "type", 2) == 2);
    expect_point(m, 1, 1.5, 1, 1);
    brio_mesh_free(m);
    m = io_read_text("a.CONTCAR",
                     "c\n-8\n1 0 0\n0 1 0\n0 0 1\n1\nSelective dynamics\nCartesian\n0 .5 1 T F T\n\n0 0 0\n");
    expect_cell(m, "xyz", (const double[9]){2, 0, 0, 0, 2, 0, 0, 0, 2}, 1e-15); /* the volume is 8 */
    expect_point(m, 0, 0, 1, 2);
    EXPECT(value(m, "moves_a", 0) == 1 && value(m, "moves_b", 0) == 0 && !brio_mesh_property(m, "atomic_number"));
    brio_mesh_free(m);
    m = io_read_text("a.vasp", "c\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1\nK\n1 1 1\n");
    expect_cell(m, "xyz", (const double[9]){1, 0, 0, 0, 2, 0, 0, 0, 3}, 0);
    expect_point(m, 0, 1, 2, 3);
    brio_mesh_free(m);
    io_expect_error("POSCAR", "c\n0\n", BRIO_ERR_FORMAT, "line 2: expected a scale that is not 0");
    io_expect_error("POSCAR", "c\n1 2\n", BRIO_ERR_FORMAT, "line 2: 2 scales");
    io_expect_error("POSCAR", "c\n1\n1 0 0\n0 1 0\n1 1 0\n", BRIO_ERR_FORMAT,
                    "line 5: the vectors of the cell span no");
    io_expect_error("POSCAR", "c\n1\n1 0 0\n0 1\n", BRIO_ERR_FORMAT, "line 4: expected a number of a vector");
#define BEGINNING "c\n1\n1 0 0\n0 1 0\n0 0 1\nSi O\n"
    io_expect_error("POSCAR", BEGINNING "1\n", BRIO_ERR_FORMAT, "line 7: 1 numbers of atoms for 2 species");
    io_expect_error("POSCAR", BEGINNING "1 x\n", BRIO_ERR_FORMAT, "line 7: expected a number of atoms, found \"x\"");
    io_expect_error("POSCAR", BEGINNING "1 1\nfoo\n", BRIO_ERR_FORMAT, "line 8: expected Direct or Cartesian");
    io_expect_error("POSCAR", BEGINNING "1 1\nD\n0 0 0\n0 0 y\n", BRIO_ERR_FORMAT, "line 10: expected a coordinate");
    io_expect_error("POSCAR", BEGINNING "1 900000000\nD\n0 0 0\n", BRIO_ERR_FORMAT, "promises");
    io_expect_error("POSCAR", BEGINNING "1 1\nD\n0.0000000 0.0000 0.0000\n", BRIO_ERR_FORMAT, "atom 1");
}

#define HEADER     "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\n"
#define ORTHOGONAL HEADER "ITEM: BOX BOUNDS pp ff pp\n1 3\n0 2\n0 2\n"

static void lammps_dump(void) {
    brio_mesh *m = io_read_text("a.dump", ORTHOGONAL "ITEM: ATOMS id type xs ys zs\n7 2 .5 .5 .25\n");
    expect_cell(m, "xz", (const double[9]){2, 0, 0, 0, 2, 0, 0, 0, 2}, 0);
    expect_point(m, 0, 2, 1, 0.5);
    EXPECT(value(m, "id", 0) == 7 && value(m, "type", 0) == 2);
    brio_mesh_free(m);
    /* a tilted box is told by the bounds of what it covers */
    m = io_read_text("a", HEADER
                     "ITEM: BOX BOUNDS xy xz yz pp pp pp\n0 3 1\n0 2 0\n0 2 0\nITEM: ATOMS x y z xs ys zs element\n"
                     "1 2 3 0 0 0 Si\n");
    expect_cell(m, "xyz", tilted, 0);
    expect_point(m, 0, 1, 2, 3);
    EXPECT(value(m, "atomic_number", 0) == 14);
    brio_mesh_free(m);
    m = io_read_text("a", HEADER
                     "ITEM: BOX BOUNDS xy xz yz pp pp pp\n-1 2 -1\n0 2 0\n0 2 0\nITEM: ATOMS xsu ysu zsu\n1 1 0\n");
    expect_cell(m, "xyz", (const double[9]){2, 0, 0, -1, 2, 0, 0, 0, 2}, 0);
    expect_point(m, 0, 1, 2, 0);
    brio_mesh_free(m);
    m = io_read_text("a", HEADER
                     "ITEM: BOX BOUNDS abc origin pp pp pp\n2 0 0 5\n1 2 0 6\n0 0 2 7\nITEM: ATOMS xs ys zs\n1 1 1\n");
    expect_cell(m, "xyz", tilted, 0);
    expect_point(m, 0, 8, 8, 9);
    brio_mesh_free(m);
    io_expect_error("a.dump", "x\n", BRIO_ERR_FORMAT, "line 1: expected ITEM: of a section");
    io_expect_error("a", "ITEM: TIMESTEP\n0\nITEM: ENTRIES\n", BRIO_ERR_FORMAT, "line 3: expected TIMESTEP, UNITS");
    io_expect_error("a", HEADER "ITEM: ATOMS x y z\n", BRIO_ERR_FORMAT, "line 5: ITEM: ATOMS stands before BOX BOUNDS");
    io_expect_error("a", HEADER "ITEM: BOX BOUNDS\n0 1\n0 x\n", BRIO_ERR_FORMAT, "line 7: expected a bound of the box");
    io_expect_error("a", HEADER "ITEM: BOX BOUNDS\n0 1\n1 1\n0 1\n", BRIO_ERR_FORMAT, "line 8: the box has no volume");
    io_expect_error("a", ORTHOGONAL "ITEM: ATOMS id x y\n1 2 3 4\n", BRIO_ERR_FORMAT, "names no columns x y z");
    io_expect_error("a", ORTHOGONAL "ITEM: ATOMS x y z q\n1 2 3\n\n", BRIO_ERR_FORMAT,
                    "line 10: expected another column");
    io_expect_error("a", ORTHOGONAL "ITEM: ATOMS x y z\n1 2 3\n4 5 6\n", BRIO_ERR_FORMAT, "line 11: expected the end");
    io_expect_error("a", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n-1\n", BRIO_ERR_FORMAT,
                    "line 4: expected the number");
}

#define BOX "c\n\n1 atoms\n1 atom types\n0 2 xlo xhi\n0 2 ylo yhi\n0 2 zlo zhi\n"

static void lammps_data(void) {
    static const char *const rows[] = {"# atomic\n\n7 1 1 2 3\n",    "\n\n7 1 1 2 3 0 0 -1\n",
                                       "# charge\n\n7 1 .5 1 2 3\n", "\n\n7 1 0.5 1 2 3\n",
                                       "# full\n\n7 1 1 0 1 2 3\n",  "\n\n7 1 1 1 2 3 # c\n"};
    char text[1024];
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        snprintf(text, sizeof text, "%s1 0 0 xy xz yz\n\nMasses\n\n1 28\n\nAtoms %s\nBonds\n\n1 1 1 1\n", BOX, rows[i]);
        brio_mesh *m = io_read_text(i % 2 ? "a.lmp" : "a", text); /* the content tells the format */
        expect_cell(m, "xyz", tilted, 0);
        expect_point(m, 0, 1, 2, 3);
        EXPECT(value(m, "id", 0) == 7 && value(m, "type", 0) == 1);
        brio_mesh_free(m);
    }
    brio_mesh *m = io_read_text(
        "a.lmp", "c\n\n1 atoms\n2 0 0 avec\n1 2 0 bvec\n0 0 2 cvec\n1 1 1 abc origin\n\nAtoms\n\n1 1 5 6 7\n");
    expect_cell(m, "xyz", tilted, 0);
    brio_mesh_free(m);
    io_expect_error("a.lmp", BOX "\nAtoms # body\n\n1 1 1 2 3\n", BRIO_ERR_FORMAT,
                    "line 9: the atom style body is not read");
    io_expect_error("a.lmp", BOX "\nAtoms\n\n1 1 2.000 3\n", BRIO_ERR_FORMAT,
                    "line 11: 4 columns are those of no atom style");
    io_expect_error("a.lmp", BOX "\nAtoms # atomic\n\n1 C 1 2 3\n", BRIO_ERR_FORMAT,
                    "line 11: expected a number of the atom, found \"C\"");
    io_expect_error("a.lmp", "c\n\n1 atoms\n0 1 xlo xhi\n\nAtoms\n\n1 1 1 2 3\n", BRIO_ERR_FORMAT,
                    "line 6: the section Atoms, but the header lacks a bound");
    io_expect_error("a.lmp",
                    "c\n\n2 atoms\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\nAtoms # atomic\n\n1 1 0 0 0\n1 1 0.000 0\n",
                    BRIO_ERR_FORMAT, "line 10: expected as many columns");
    io_expect_error("a.lmp", BOX, BRIO_ERR_FORMAT, "there is no section Atoms");
    io_expect_error("a.lmp", "", BRIO_ERR_FORMAT, "ends at byte 0");
}

/* --- what was read wrongly, or refused --- */

#define ZERO_CELL "CRYST1    0.000    0.000    0.000  90.00  90.00  90.00 P 1           1\n"

static void pdb_with_a_cell_of_zeros_was_refused(void) {
    expect_no_cell("a.pdb", ZERO_CELL ATOM); /* as VMD writes it where there is no cell */
}

static void pdb_whose_residues_are_no_decimal_numbers_was_refused(void) {
    static const char *const numbers[] = {"A000", "****", "1e10", "2-71"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char text[256];
        snprintf(text, sizeof text, "ATOM  186a0  OH2 TIP3W%s      -0.011   0.302   0.113\n" ATOM, numbers[i]);
        brio_mesh *m = io_read_text("a.pdb", text);
        EXPECT(m && m->num_vertices == 2 && isnan(value(m, "residue", 0)) && value(m, "residue", 1) == 12);
        expect_left_out("a.pdb", text, "numbers of residues that are not decimal");
        brio_mesh_free(m);
    }
    brio_mesh *m = io_read_text("a.pdb", "ATOM      1  CA  GLY A  -3       1.000   2.000   3.000\n");
    EXPECT(value(m, "residue", 0) == -3);
    brio_mesh_free(m);
}

static void cif_had_the_atoms_of_all_models_and_alternate_locations(void) {
    static const char text[] = "data_a\nloop_\n_atom_site.type_symbol\n_atom_site.label_alt_id\n_atom_site.Cartn_x\n"
                               "_atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.pdbx_PDB_model_num\n"
                               "C . 0 0 0 3\nC A 1 0 0 3\nC B 2 0 0 3\nC ? 3 0 0 3\nC 1 4 0 0 3\nC . 0 1 0 4\n";
    brio_mesh *m = io_read_text("a.cif", text);
    EXPECT(m && m->num_vertices == 4);
    for (size_t v = 0; m && v < m->num_vertices; v++) expect_point(m, v, (double)(v + (v > 1)), 0, 0);
    expect_left_out("a.cif", text, "further models");
    expect_left_out("a.cif", text, "alternate locations");
    brio_mesh_free(m);
}

static void poscar_with_comments_behind_its_species_was_refused(void) {
    static const char text[] = "c\n1 ! scale\n1 0 0 # a\n0 1 0\n0 0 1\nSi O ! of these\n1 1 #n\nDirect\n"
                               "0 0 0 ! Si\n.5 .5 .5\n";
    brio_mesh *m = io_read_text("POSCAR", text);
    EXPECT(m && m->num_vertices == 2 && value(m, "atomic_number", 1) == 8);
    expect_left_out("POSCAR", text, "comment");
    brio_mesh_free(m);
}

static void xyz_whose_comment_is_a_sentence_was_refused_for_a_cell(void) {
    expect_no_cell("a.xyz", "1\nthe lattice=small one, pbc=maybe\nC 0 0 0\n");
    io_expect_error("a.xyz", "1\nLattice=small Properties=species:S:1:pos:R:3\nC 0 0 0\n", BRIO_ERR_FORMAT,
                    "Lattice=: expected 9 numbers");
}

static void xyz_with_pbc_in_one_word_was_refused(void) {
    static const struct {
        const char *pbc, *directions;
    } words[] = {{"\"TFT\"", "xz"}, {"T", "xyz"}, {"\"F\"", ""}, {"[true,False,TRUE]", "xz"}, {"\"101\"", "xz"}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char text[256];
        snprintf(text, sizeof text, "1\nLattice=\"1 1 1\" Properties=species:S:1:pos:R:3 pbc=%s\nC 0 0 0\n",
                 words[i].pbc);
        brio_mesh *m = io_read_text("a.xyz", text);
        expect_cell(m, words[i].directions, unit, 0);
        brio_mesh_free(m);
    }
}

static void lammps_spheres_without_a_style_had_the_names_of_others(void) {
    brio_mesh *m = io_read_text("a.lmp", BOX "\nAtoms\n\n1 1 0.5 2.5 1 2 3\n");
    EXPECT(value(m, "diameter", 0) == 0.5 && value(m, "density", 0) == 2.5);
    expect_point(m, 0, 1, 2, 3);
    brio_mesh_free(m);
}

/* --- damage --- */

static const struct {
    const char *name, *text;
} samples[] = {
    {"a.extxyz", "1\nLattice=\"1 2 3 4 5.5 6 7 8 9\" Properties=species:S:1:pos:R:3 pbc=\"T F T\"\nH 0 0 0\n"},
    {"a.pdb", "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\n" ATOM},
    {"a.cif", CELL "_a\n;b\n;\nloop_\n_symmetry_equiv_pos_as_xyz\n'x,y,z'\n" SITES "Na1 .5 ? 0.25(1)\nCl 0 0 0\n"},
    {"POSCAR", "c\n-8\n1 0 0\n0 1 0\n0 0 1\nSi O\n1 1\nSel\nDirect\n0 0 0 T F T\n.5 .5 .5 T T T\n"},
    {"a.dump", ORTHOGONAL "ITEM: ATOMS id element xs ys zs\n7 Si .5 .5 .25\n"},
    {"a.lmp", BOX "1 0 0 xy xz yz\n\nAtoms # full\n\n7 1 1 0 1 2 3\n\nBonds\n\n1 1 1 1\n"}};

enum { SAMPLES = sizeof samples / sizeof *samples };

static void every_prefix_and_changed_byte(void) {
    uint64_t state = 9;
    for (size_t k = 0; k < SAMPLES; k++) {
        size_t size = strlen(samples[k].text);
        char *bytes = strdup(samples[k].text);
        for (size_t n = 0; bytes && n < size; n++)
            brio_mesh_free(io_expect_sane(samples[k].name, bytes, n, "prefix", n));
        for (size_t i = 0; bytes && i < 2 * size; i++) {
            char old = bytes[i / 2];
            bytes[i / 2] ^= (char)(1 << io_random(&state) % 8);
            brio_mesh_free(io_expect_sane(samples[k].name, bytes, size, "byte", i));
            bytes[i / 2] = old;
        }
        free(bytes);
    }
}

static const char *current;

static brio_status read_current(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path(current), NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void each_allocation_fails(void) {
    for (size_t k = 0; k < SAMPLES; k++) {
        current = samples[k].name;
        io_put(current, samples[k].text, strlen(samples[k].text));
        expect_clean_failures(read_current);
    }
}

SUITE(test_io_atoms) {
    io_begin();
    RUN(extended_xyz);
    RUN(pdb);
    RUN(cif);
    RUN(poscar);
    RUN(lammps_dump);
    RUN(lammps_data);
    RUN(pdb_with_a_cell_of_zeros_was_refused);
    RUN(pdb_whose_residues_are_no_decimal_numbers_was_refused);
    RUN(cif_had_the_atoms_of_all_models_and_alternate_locations);
    RUN(poscar_with_comments_behind_its_species_was_refused);
    RUN(xyz_whose_comment_is_a_sentence_was_refused_for_a_cell);
    RUN(xyz_with_pbc_in_one_word_was_refused);
    RUN(lammps_spheres_without_a_style_had_the_names_of_others);
    RUN(every_prefix_and_changed_byte);
    RUN(each_allocation_fails);
    return io_end();
}
