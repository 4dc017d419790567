/* make_corpus FOLDER: writes FOLDER/read and FOLDER/iso, the first inputs of the fuzzers that read files. All other inputs of
 * the corpora were found by the fuzzers. */
#include "e57_image.h"
#include "fuzz.h"
#include "laz_samples.h"
#include "packed_samples.h"

/* The first byte of an input of fuzz_read: the place in the list of corpus.h. */
enum { PLY, XYZ, CSV, OBJ, OFF, VTU, VTP, NODE, LAS, LAZ, PCD, PTX, STL, NPY, NPZ, GLB, TXT, GLTF, E57, PTS };
enum { NONE = 20, BNPTS, CHEMICAL, IN_E57, IN_NPZ, IN_GZIP, IN_ZSTD };

static char folder[1024];

static void put(const char *subject, const char *name, const void *first, size_t firsts, const void *bytes,
                size_t size) {
    char path[1200];
    snprintf(path, sizeof path, "%s/%s", folder, subject);
    mkdir(folder, 0777), mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/%s/%s", folder, subject, name);
    FILE *f = fopen(path, "wb");
    FUZZ_EXPECT(f && fwrite(first, 1, firsts, f) == firsts && fwrite(bytes, 1, size, f) == size && fclose(f) == 0, "%s",
                path);
}

static void put_read(const char *name, int choice, const void *bytes, size_t size) {
    uint8_t first = (uint8_t)choice;
    put("read", name, &first, 1, bytes, size);
}

static void put_text(const char *name, int choice, const char *text) {
    put_read(name, choice, text, strlen(text));
}

/* --- texts --- */

#define TRANSFORM "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n10 20 30 1\n"
#define POSITIONS "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"

static void put_texts(void) {
    put_text("ply-text", PLY,
             "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty double x\nproperty float y\nproperty int z\n"
             "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int "
             "vertex1\nproperty int vertex2\nend_header\n0 0 0 1\n1 0 0 2\n0 1e0 0 3\n3 0 1 2\n0 1\n");
    put_text("xyz", XYZ, "# x y z v\n1 2 3 4\n-1.5e3 .5 7 nan\n");
    put_text("csv", CSV, "id;Easting;Northing;elev\n1;2,5;3,5;4\n2;3,5;4,5;5\n");
    put_text("csv-named", 31, "1,2,3\n4,5,6\n");
    put_text("txt-fortran", TXT, "1.0D+00 2 3\n4 5 6\n");
    put_text("pts", PTS, "2\n1 2 3 10 20 30 40\n4 5 6 10 20 30 40\n");
    put_text("obj", OBJ, "mtllib a\nv 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2//1 -1\nl 1 2\n");
    put_text("off", OFF, "COFF\n# c\n4 2 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n0 0 1 1 2 3\n3 0 1 2\n3 0 2 3\n");
    put_text("node", NODE, "# c\n3 3 1 1\n1 0 0 0 5 1\n2 1 0 0 6 0\n3 0 1 0 7 1\n");
    put_text("pcd-text", PCD,
             "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
             "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 3 4\n5 6 7 8\n");
    put_text("ptx", PTX, "2\n1\n" TRANSFORM "1 2 3 0.5 10 20 30\n4 5 6 0.5 10 20 30\n");
    put_text("stl-text", STL,
             "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
             "endloop\nendfacet\nendsolid s\n");
    put_text("chemical", NONE, "2\na comment\nC 0 0 0\nO 1.2 0 0\n");
    put_text("extxyz", CHEMICAL,
             "1\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=species:S:1:pos:R:3:f:R:2\n8 0 0 0 1 2\n");
    put_text("pdb", CORPUS_FORMATS + BRIO_FORMAT_PDB,
             "CRYST1   10.000   11.000   12.000  90.00  90.00 120.00 P 1           1\n"
             "ATOM      1  CA AGLY A  12       1.000   2.000   3.000  0.50 10.00           C\nENDMDL\n");
    put_text("cif", CORPUS_FORMATS + BRIO_FORMAT_CIF,
             "data_a\n_cell_length_a 5.6(1)\n_cell_length_b 5\n_cell_length_c 5\n_cell_angle_alpha 90\n"
             "_cell_angle_beta 90\n_cell_angle_gamma 60\n_text\n;a\n;\nloop_\n_space_group_symop_operation_xyz\n"
             "'x, y, z'\nloop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n"
             "Na1 0 .5 0.25(1)\nCl ? . 1\n");
    put_text("poscar", CORPUS_FORMATS + BRIO_FORMAT_POSCAR,
             "c\n-8\n1 0 0\n0 1 0\n0 0 1\nSi O\n1 1\nSelective\nDirect\n0 0 0 T F T\n.5 .5 .5 F F F\n");
    put_text("poscar-old", CORPUS_FORMATS + BRIO_FORMAT_POSCAR,
             "c\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n2\nCart\n0 0 0\n1 1 1\n\n0 0 0\n");
    put_text("dump", CORPUS_FORMATS + BRIO_FORMAT_LAMMPS_DUMP,
             "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS xy xz yz pp pp ff\n0 3 1\n0 2 0\n0 2 0\n"
             "ITEM: ATOMS id element xs ys zs\n7 Si .5 .5 .5\n");
    put_text("dump-vectors", CORPUS_FORMATS + BRIO_FORMAT_LAMMPS_DUMP,
             "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS abc origin pp pp pp\n1 0 0 5\n0 1 0 6\n"
             "0 0 1 7\nITEM: ATOMS x y z\n1 2 3\n");
    put_text("lammps-data", CORPUS_FORMATS + BRIO_FORMAT_LAMMPS_DATA,
             "c\n\n2 atoms\n0 2 xlo xhi\n0 2 ylo yhi\n0 2 zlo zhi\n1 0 0 xy xz yz\n\nAtoms # full\n\n"
             "1 1 1 0.5 1 1 1 0 0 -1\n2 1 1 0.5 1 1 1 0 0 0\n\nBonds\n\n1 1 1 2\n");
    put_text("gltf", GLTF,
             "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,"
             "\"translation\":[1,2,3],\"children\":[1]},{\"mesh\":0,\"matrix\":[2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1]}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":4}]}],\"accessors\":[{"
             "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,"
             "\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"" POSITIONS "\"}]}");
    put_text("gzip", IN_GZIP, packed_text);
    put_text("zstd", IN_ZSTD, packed_text);
}

/* --- files that the library writes --- */

static void put_written(const char *name, const char *path, int choice, int parts, brio_write_options o) {
    size_t size;
    brio_mesh *m = io_make(5, parts | IO_SINGLE);
    EXPECT(brio_write(io_ctx, io_path(path), m, &o) == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    char *bytes = io_get(path, &size);
    put_read(name, choice, bytes, size);
    free(bytes);
    brio_mesh_free(m);
}

static void put_all_written(void) {
    const brio_write_options o = {0};
    brio_write_options text = o, packed = o;
    text.ascii = 1, packed.compress = 1;
    put_written("ply", "a.ply", PLY, IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES, o);
    put_written("vtu", "a.vtu", VTU, IO_FACES | IO_TETRAHEDRA | IO_PROPERTIES, o);
    put_written("vtu-text", "a.vtu", VTU, IO_FACES | IO_TETRAHEDRA, text);
    put_written("vtu-packed", "a.vtu", VTU, IO_FACES | IO_TETRAHEDRA, packed);
    put_written("vtp", "a.vtp", VTP, IO_FACES | IO_PROPERTIES, o);
    put_written("vtp-packed", "a.vtp", VTP, IO_FACES, packed);
    put_written("stl", "a.stl", STL, IO_FACES, o);
    put_written("npy", "a.npy", NPY, 0, o);
    put_written("npy-records", "a.npy", NPY, IO_PROPERTIES, o);
    put_written("npz-array", "a.npy", IN_NPZ, 0, o);
    put_written("glb", "a.glb", GLB, IO_FACES | IO_PROPERTIES, o);
    put_written("las", "a.las", LAS, 0, o);
}

/* --- files made of bytes --- */

static void put_e57(void) {
    static const uint64_t doubles[3] = {0, 0x3ff0000000000000, 0x4000000000000000}, whole[3] = {1, 2, 3};
    const e57_test_field fields[] = {
        {"cartesianX", "type=\"Float\"", 64, doubles},
        {"cartesianY", "type=\"Float\"", 64, doubles},
        {"cartesianZ", "type=\"ScaledInteger\" minimum=\"0\" maximum=\"7\" scale=\"0.5\"", 3, whole},
        {"intensity", "type=\"Integer\" minimum=\"0\" maximum=\"255\"", 8, whole}};
    e57_image f = e57_begin();
    size_t size;
    uint64_t section = e57_put_section(&f, fields, 4, 3, 64);
    e57_begin_xml(&f);
    e57_put_scan(&f, fields, 4, "3", section,
                 "<pose type=\"Structure\"><translation type=\"Structure\"><x type=\"Float\">1</x><y "
                 "type=\"Float\">2</y><z type=\"Float\">3</z></translation></pose>");
    e57_end_xml(&f);
    e57_set_header(&f);
    uint8_t *pages = e57_pages(&f, &size);
    put_read("e57", E57, pages, size);
    put_read("e57-content", IN_E57, f.bytes, (f.size + E57_CONTENT - 1) / E57_CONTENT * E57_CONTENT);
    free(pages);
    free(f.bytes);
}

static void put_packed(void) {
    static zip_sample z;
    const float oriented[12] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1};
    packed_npz(&z, false);
    put_read("npz", NPZ, z.file.bytes, z.file.size);
    packed_npz(&z, true);
    put_read("npz-wide", NPZ, z.file.bytes, z.file.size);
    put_read("bnpts", BNPTS, oriented, sizeof oriented);
    put_read("las-3", LAS, las_format_3, sizeof las_format_3);
    put_read("las-8", LAS, las_format_8, sizeof las_format_8);
    put_read("laz-3", LAZ, laz_format_3, sizeof laz_format_3);
    put_read("laz-8", LAZ, laz_format_8, sizeof laz_format_8);
}

/* A map of 3 x 3 x 3 numbers in a unit cell. */
static void put_map(void) {
    static const uint8_t options[2] = {1, 0};
    const int32_t words[] = {3, 3, 3, 2, 0, 0, 0, 3, 3, 3};
    const float cell[] = {3, 3, 3, 90, 90, 90};
    const int32_t axes[] = {1, 2, 3};
    char bytes[1024 + 27 * 4] = {0};
    memcpy(bytes, words, sizeof words);
    memcpy(bytes + 40, cell, sizeof cell);
    memcpy(bytes + 64, axes, sizeof axes);
    memcpy(bytes + 208, "MAP ", 4);
    for (int i = 0; i < 27; i++) memcpy(bytes + 1024 + 4 * i, &(float){i == 13 ? 3.0f : 0.5f}, 4);
    put("iso", "map", options, 2, bytes, sizeof bytes);
}

static void put_atoms(void) {
    static const uint8_t options[2] = {2, 16};
    static const char text[] =
        "HEADER x\nATOM      1  C   ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"
        "HETATM    2  O   HOH A   2       9.000   0.000   0.000  1.00  0.00           O\n"
        "ATOM      3  CA BALA A   1       1.200   0.300   0.000  1.00  0.00\nENDMDL\n";
    put("iso", "atoms", options, 2, text, sizeof text - 1);
}

int main(int argc, char **argv) {
    if (argc != 2) return 1;
    snprintf(folder, sizeof folder, "%s", argv[1]);
    io_begin();
    put_texts();
    put_all_written();
    put_e57();
    put_packed();
    put_map();
    put_atoms();
    return io_end();
}
