/* What is known of each format, in one table: all that needs a format's name, its extensions, its beginning, its
 * reader, its writer or what it can hold asks here.
 *
 * A new format is a file beside this one, which defines a codec, and a row here. Its number is the next that no row
 * has; a name for it in the enum brio_format is for programs that speak of that format alone. */
#include "io/row_format.h"
#include "mesh/properties.h"
#include <stdio.h>
#include <string.h>

enum {
    POINTS = BRIO_HOLDS_PROPERTIES | BRIO_HOLDS_NAMES,
    BOTH_PRECISIONS = BRIO_HOLDS_DOUBLES | BRIO_HOLDS_SINGLES,
    FACES = BRIO_HOLDS_FACES | BRIO_HOLDS_FACE_PROPERTIES,
    BOTH_FORMS = BRIO_HOLDS_TEXT | BRIO_HOLDS_BINARY
};

/* The codec of each format, in the format's own file. */
extern const brio_codec brio_ply_codec, brio_off_codec, brio_vtp_codec, brio_vtu_codec, brio_vtk_codec, brio_laz_codec,
    brio_las_codec, brio_pcd_codec, brio_npy_codec, brio_glb_codec, brio_e57_codec, brio_npz_codec, brio_stl_codec,
    brio_obj_codec, brio_node_codec, brio_ptx_codec, brio_bnpts_codec, brio_chemical_codec, brio_pts_codec,
    brio_xyzrgb_codec, brio_xyzn_codec, brio_xyz_codec, brio_pdb_codec, brio_cif_codec, brio_poscar_codec,
    brio_lammps_dump_codec, brio_lammps_data_codec;

/* In the order in which a file's beginning is compared with theirs: a format whose beginning is looser comes later. */
static const brio_format_row table[] = {
    {{sizeof(brio_format_info), BRIO_FORMAT_PLY, "a PLY file", "ply", "ply",
      POINTS | FACES | BRIO_HOLDS_TETRAHEDRA | BRIO_HOLDS_EDGES | BOTH_PRECISIONS | BOTH_FORMS | BRIO_HOLDS_PARTS,
      BRIO_MOST_NUMBERS - 3, NULL},
     .codec = &brio_ply_codec,
     .colours = BRIO_COLOURS_8,
     .face_colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_OFF, "an OFF file", "off", "off",
      BRIO_HOLDS_FACES | BRIO_HOLDS_FACE_COLOURS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_off_codec,
     .face_colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_VTP, "a VTP file", "vtp", "vtp",
      POINTS | FACES | BRIO_HOLDS_EDGES | BOTH_PRECISIONS | BOTH_FORMS | BRIO_HOLDS_COMPRESSED, BRIO_MOST_NUMBERS,
      NULL},
     .codec = &brio_vtp_codec,
     .colours = BRIO_COLOURS_8,
     .face_colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_VTU, "a VTU file", "vtu", "vtu",
      POINTS | FACES | BRIO_HOLDS_TETRAHEDRA | BRIO_HOLDS_EDGES | BOTH_PRECISIONS | BOTH_FORMS | BRIO_HOLDS_COMPRESSED,
      BRIO_MOST_NUMBERS, NULL},
     .codec = &brio_vtu_codec,
     .colours = BRIO_COLOURS_8,
     .face_colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_VTK, "a legacy VTK file", "vtk", "vtk",
      POINTS | FACES | BRIO_HOLDS_TETRAHEDRA | BRIO_HOLDS_EDGES | BOTH_PRECISIONS | BOTH_FORMS, 4096, NULL},
     .codec = &brio_vtk_codec,
     .colours = BRIO_COLOURS_8,
     .face_colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_LAZ, "a LAZ file", "laz", "laz", POINTS | BRIO_HOLDS_BINARY, 0, NULL},
     .codec = &brio_laz_codec,
     .colours = BRIO_COLOURS_16,
     .keeps = "crs. las."},
    {{sizeof(brio_format_info), BRIO_FORMAT_LAS, "a LAS file", "las", "las", POINTS | BRIO_HOLDS_BINARY, 0, NULL},
     .codec = &brio_las_codec,
     .colours = BRIO_COLOURS_16,
     .keeps = "crs. las."},
    {{sizeof(brio_format_info), BRIO_FORMAT_PCD, "a PCD file", "pcd", "pcd",
      POINTS | BOTH_PRECISIONS | BRIO_HOLDS_RARE_DOUBLES | BOTH_FORMS | BRIO_HOLDS_COMPRESSED, BRIO_MOST_NUMBERS - 3,
      NULL},
     .codec = &brio_pcd_codec,
     .colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_NPY, "an NPY file", "npy", "npy",
      POINTS | BOTH_PRECISIONS | BRIO_HOLDS_BINARY, BRIO_MOST_NUMBERS - 3, NULL},
     .codec = &brio_npy_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_GLB, "a GLB file", "glb gltf", "glb",
      POINTS | BRIO_HOLDS_FACES | BRIO_HOLDS_EDGES | BRIO_HOLDS_SINGLES | BRIO_HOLDS_ORIGIN | BRIO_HOLDS_BINARY, 256,
      NULL},
     .codec = &brio_glb_codec,
     .colours = BRIO_COLOURS_NORMALIZED},
    {{sizeof(brio_format_info), BRIO_FORMAT_E57, "an E57 file", "e57", "e57",
      POINTS | BOTH_PRECISIONS | BRIO_HOLDS_BINARY | BRIO_HOLDS_PLACES, 252, NULL},
     .codec = &brio_e57_codec,
     .colours = BRIO_COLOURS_8_OR_16,
     .scans = true,
     .keeps = "crs.wkt"},
    {{sizeof(brio_format_info), BRIO_FORMAT_NPZ, "an NPZ file", "npz", "", POINTS | BOTH_PRECISIONS | BRIO_HOLDS_BINARY,
      0, NULL},
     .codec = &brio_npz_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_STL, "an STL file", "stl", "stl",
      BRIO_HOLDS_FACES | BRIO_HOLDS_SINGLES | BOTH_FORMS, 0, NULL},
     .codec = &brio_stl_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_OBJ, "an OBJ file", "obj", "obj",
      BRIO_HOLDS_FACES | BRIO_HOLDS_COLOURS | BRIO_HOLDS_NORMALS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_obj_codec,
     .colours = BRIO_COLOURS_UNIT},
    {{sizeof(brio_format_info), BRIO_FORMAT_NODE, "a NODE file", "node ele", "node",
      BRIO_HOLDS_PROPERTIES | BRIO_HOLDS_TETRAHEDRA | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, BRIO_MOST_NUMBERS, NULL},
     .codec = &brio_node_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_PTX, "a PTX file", "ptx", "ptx",
      BRIO_HOLDS_COLOURS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, "intensity"},
     .codec = &brio_ptx_codec,
     .colours = BRIO_COLOURS_8,
     .scans = true},
    {{sizeof(brio_format_info), BRIO_FORMAT_BNPTS, "a BNPTS file", "bnpts", "", BRIO_HOLDS_SINGLES | BRIO_HOLDS_BINARY,
      0, NULL},
     .codec = &brio_bnpts_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_CHEMICAL, "a chemical XYZ file", "chemical extxyz", "",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_chemical_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_LAMMPS_DUMP, "a LAMMPS dump", "lammpstrj dump", "",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_lammps_dump_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_LAMMPS_DATA, "a LAMMPS data file", "lmp data", "",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_lammps_data_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_PDB, "a PDB file", "pdb ent", "",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_pdb_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_CIF, "a CIF file", "cif mmcif", "",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_cif_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_POSCAR, "a POSCAR file", "poscar contcar vasp", "",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_poscar_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_PTS, "a PTS file", "pts", "pts",
      BRIO_HOLDS_COLOURS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, "intensity"},
     .codec = &brio_pts_codec,
     .colours = BRIO_COLOURS_8},
    {{sizeof(brio_format_info), BRIO_FORMAT_XYZRGB, "a text of points with colours", "xyzrgb", "xyzrgb",
      BRIO_HOLDS_COLOURS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_xyzrgb_codec,
     .colours = BRIO_COLOURS_UNIT},
    {{sizeof(brio_format_info), BRIO_FORMAT_XYZN, "a text of points with normals", "xyzn", "xyzn",
      BRIO_HOLDS_NORMALS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, 0, NULL},
     .codec = &brio_xyzn_codec},
    {{sizeof(brio_format_info), BRIO_FORMAT_XYZ, "a text of points", "xyz txt csv asc tsv dat", "xyz txt csv asc tsv",
      POINTS | BRIO_HOLDS_DOUBLES | BRIO_HOLDS_TEXT, BRIO_MOST_NUMBERS - 3, NULL},
     .codec = &brio_xyz_codec}};

enum { NUM_FORMATS = sizeof table / sizeof *table };

const brio_format_row *brio_format_row_of(brio_format format) {
    for (size_t i = 0; i < NUM_FORMATS; i++)
        if (table[i].info.format == format) return &table[i];
    return NULL;
}

const brio_format_info *brio_format_facts(brio_format format) {
    const brio_format_row *row = brio_format_row_of(format);
    return row ? &row->info : NULL;
}

bool brio_format_holds(brio_format format, unsigned what) {
    const brio_format_row *row = brio_format_row_of(format);
    return row && (row->info.holds & what);
}

/* Returns whether a list has a name. */
static bool is_listed(const char *list, const char *name) {
    for (const char *at = list ? list : ""; *at; at += *at == ' ') {
        size_t length = strcspn(at, " ");
        if (length == strlen(name) && !strncmp(at, name, length)) return true;
        at += length;
    }
    return false;
}

bool brio_format_holds_property(brio_format format, const brio_mesh *m, size_t i) {
    brio_channels colour = brio_colour_of(m), normal = brio_normal_of(m);
    const brio_property *p = &m->properties[i];
    if (brio_format_holds(format, BRIO_HOLDS_PROPERTIES)) return true;
    if (colour.count > 3) colour.count = 3;
    if (is_listed(brio_format_facts(format)->properties, p->name)) return true;
    return (brio_format_holds(format, BRIO_HOLDS_COLOURS) && brio_channels_have(&colour, p)) ||
           (brio_format_holds(format, BRIO_HOLDS_NORMALS) && brio_channels_have(&normal, p));
}

bool brio_format_holds_face_property(brio_format format, const brio_mesh *m, size_t i) {
    const brio_mesh faces = brio_mesh_faces_as_points(m);
    const brio_channels colour = brio_colour_of(&faces);
    if (brio_format_holds(format, BRIO_HOLDS_FACE_PROPERTIES)) return true;
    return brio_format_holds(format, BRIO_HOLDS_FACE_COLOURS) && brio_channels_have(&colour, &m->face_properties[i]);
}

brio_colour_plan brio_format_colours(brio_format format) {
    const brio_format_row *row = brio_format_row_of(format);
    return (brio_colour_plan){.points.to = row->colours, .faces.to = row->face_colours};
}

bool brio_format_keeps(brio_format format, const char *metadata) {
    const brio_format_row *row = brio_format_row_of(format);
    for (const char *at = row && row->keeps ? row->keeps : ""; *at;) {
        size_t length = strcspn(at, " ");
        if (!strncmp(at, metadata, length)) return true;
        at += length + (at[length] == ' ');
    }
    return false;
}

brio_format brio_format_that_starts(const char *bytes, size_t size) {
    for (size_t i = 0; i < NUM_FORMATS; i++)
        if (table[i].codec->starts && table[i].codec->starts(bytes, size)) return table[i].info.format;
    return BRIO_FORMAT_AUTO;
}

brio_format brio_format_with(const char *path, bool (*has)(const char *path, const char *extension)) {
    for (size_t i = 0; i < NUM_FORMATS; i++)
        for (const char *at = table[i].info.extensions; *at;) {
            char extension[16];
            size_t length = strcspn(at, " ");
            memcpy(extension, at, length);
            extension[length] = 0;
            if (has(path, extension)) return table[i].info.format;
            at += length + (at[length] == ' ');
        }
    return BRIO_FORMAT_AUTO;
}

/* Appends extensions to a list, those that there is room for. */
static void append(const char *extensions, char *text, size_t size) {
    for (const char *at = extensions; *at; at += *at == ' ') {
        size_t length = strcspn(at, " "), used = strlen(text);
        if (used + length + 3 <= size) snprintf(text + used, size - used, "%s.%.*s", used ? " " : "", (int)length, at);
        at += length;
    }
}

void brio_format_list(int written, unsigned holds, char *text, size_t size) {
    if (size) text[0] = 0;
    for (int number = 1; number <= BRIO_FORMAT_MOST && size; number++) {
        const brio_format_info *info = brio_format_facts((brio_format)number);
        if (info && (info->holds & holds) == holds) append(written ? info->written : info->extensions, text, size);
    }
}

void brio_format_list_columns(char *text, size_t size) {
    text[0] = 0;
    for (size_t i = 0; i < NUM_FORMATS; i++)
        if (table[i].codec->read_columns) append(table[i].info.extensions, text, size);
}
