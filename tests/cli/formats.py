"""What tests know of formats: the program's own list, and one table of files.

A test that goes through formats takes them from formats(), which the program lists. EVERYTHING has a file of each, with all
that the format allows: a new format needs a row there, and in no other test.
"""

import functools
import json
import struct
import subprocess

import whole_files
from brio_cli import BRIO


@functools.lru_cache(maxsize=None)
def formats():
    """The formats as brio lists them: format, name, number, read, written, holds."""
    return json.loads(subprocess.run([BRIO, "help", "formats", "--json"], stdout=subprocess.PIPE, check=True).stdout)["formats"]


def written_of(kind):
    """The extensions that brio writes of a format: the first one, and .csv, which is another kind of text."""
    return [e[1:] for e in kind["written"] if e in kind["written"][:1] or e == ".csv"]


def holding(*what):
    """The extensions, one a format, of those that are written and hold all of that."""
    return [kind["written"][0][1:] for kind in formats() if kind["written"] and set(what) <= set(kind["holds"])]


def everything_of(kind):
    """The row of EVERYTHING for a format, by any of its extensions; None where there is none."""
    return next((EVERYTHING[e[1:]] for e in kind["read"] if e[1:] in EVERYTHING), None)


PLY = ("ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\n"
       "property float z\nproperty uchar red\nproperty list uchar int near\nelement face 1\n"
       "property list uchar int vertex_indices\nproperty uchar flags\nproperty list uchar float texcoord\n"
       "element tristrips 1\nproperty list int int vertex_indices\nelement tetrahedron 1\n"
       "property list uchar int vertex_indices\nproperty int region\nelement edge 1\nproperty int vertex1\n"
       "property int vertex2\nproperty uchar crease\nelement camera 1\nproperty float view_px\nend_header\n"
       "0 0 0 1 1 1\n1 0 0 2 0\n0 1 0 3 0\n0 0 1 4 0\n3 0 2 1 5 2 0.5 0.5\n3 0 1 3\n4 0 1 2 3 9\n0 1 1\n0.5\n")
OBJ = ("mtllib a.mtl\no thing\ng part\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 1 1 1 0.5\nvt 0 0\n"
       "vn 0 0 1\nvn 0 1 0\nvp 0.5\nusemtl m\ns 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/2 2/1/2 4/1/2\nl 1 2\n"
       "#MRGB ff336699ffff0000ff00ff00ff4080bf\n")
OFF = "STCNOFF\n3 1 0\n" + "0 0 0 0 0 1 255 0 0 255 0.5 0.5\n" * 3 + "3 0 1 2 255 0 0\n"
PCD = ("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb normal_x normal_y normal_z stamp _\nSIZE 4 4 4 4 4 4 4 8 1\n"
       "TYPE F F F U F F F U U\nCOUNT 1 1 1 1 1 1 1 1 4\nWIDTH 1\nHEIGHT 2\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 2\n"
       "DATA ascii\n0 0 0 255 0 0 1 9007199254740993 1 1 1 1\n1 0 0 255 0 0 1 2 0 0 0 0\n")
XYZ = "# x y z R G B Nx Ny Nz Intensity id label\n0 0 0 1 2 3 0 0 1 0.5 9007199254740993 wall\n"
VTK = ["time of the file", "wide", "label", "area of cells that are no polygons"]
LAS = ["intensity", "return_number", "number_of_returns", "scan_direction_flag", "edge_of_flight_line", "classification",
       "classification_flags", "scan_angle_rank", "user_data", "point_source_id", "gps_time"]
METADATA = ["crs"] + ["las." + name for name in "records system software date gps_time returns extras".split()]
CELL = ["cell.vectors", "cell.periodic"]
PDB = ("HEADER    A CRYSTAL\nCRYST1   10.000   11.000   12.000  90.00  90.00 120.00 P 1           1\n"
       "ATOM      1  CA AGLY A  12A      1.000   2.000   3.000  0.50 10.00      MAIN C1+\n"
       "ATOM      2  CA BGLY A  12A      1.500   2.000   3.000  0.50 10.00      MAIN C1+\nANISOU    1\nTER\n"
       "HETATM    3  O   HOH A  13       4.000   5.000   6.000\nENDMDL\nMODEL\n"
       "ATOM      1  CA  GLY A  12       1.000   2.000   3.000\nENDMDL\nCONECT    1\nEND\n")
CIF = ("#\\#CIF_1.1\ndata_paper\n_chemical_name 'a salt'\ndata_crystal\n_cell_length_a 5.64(1)\n_cell_length_b 5.64\n_cell_length_c 5.64\n"
       "_cell_angle_alpha 90\n_cell_angle_beta 90\n_cell_angle_gamma 90\n_symmetry_space_group_name_H-M 'P 1'\n"
       "_symmetry_Int_Tables_number 1\n_text\n;one\n_two 3\n;\nloop_\n_symmetry_equiv_pos_as_xyz\n'x, y, z'\nloop_\n_atom_site_label\n"
       "_atom_site_type_symbol\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n_atom_site_occupancy\n"
       "_atom_site_U_iso_or_equiv\nNa1 Na1+ 0 0 0.00(1) 1 .\nCl1 Cl1- .5 .5 .5 0.5 0.01\nH1 H ? ? ? 1 1\nloop_\n_atom_site_aniso_label\n"
       "_atom_site_aniso_U_11\nNa1 0.1\ndata_other\n")
DUMP = ("ITEM: TIMESTEP\n5\nITEM: TIME\n0.5\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS xy xz yz pp pp ff\n0 3 1\n0 2 0\n0 2 0\n"
        "ITEM: ATOMS id element name q xs ys zs\n7 Si wall 0.5 .5 .5 .5\n")
# format: the file, what stays as properties, what is named as left out, metadata that PLY has no place for
EVERYTHING = {
    "ply": (PLY, ["red"], ["near", "textures", "flags of face", "texcoord of face", "region of tetrahedron",
                           "crease of edge", "camera"]),
    "obj": (OBJ, ["red", "green", "blue"],
            ["alpha", "materials", "objects", "groups", "texture coordinates", "free-form geometry", "smoothing groups",
             "lines", "#MRGB", "normals of corners"]),
    "off": (OFF, "nx ny nz red green blue alpha s t".split(), []),
    "pcd": (PCD, "red green blue nx ny nz stamp".split(), ["integers beyond 2^53", "viewpoint", "order in rows"]),
    "xyz": (XYZ, "red green blue nx ny nz intensity id".split(), ["label"]),
    "pts": ("1\n1 2 3 -900 0 255 77\n", "intensity red green blue".split(), []),
    "xyzrgb": ("1 2 3 0 0.5 1\n", "red green blue".split(), []),
    "xyzn": ("1 2 3 0 0 1\n", "nx ny nz".split(), []),
    "e57": (whole_files.e57_of_everything(), "intensity red green blue row_index".split(),
            ["images", "date of the file", "names of scans", "descriptions of scans", "sensors", "elements of extensions",
             "weather", "times", "groups of points", "spherical coordinates", "own:label", "poses"]),
    "las": (whole_files.las_of_everything(), LAS + ["wide", "large"],
            ["waveforms", "COPC index", "LAStools index", "odd (extra bytes of a reserved type)",
             "blob (extra bytes without a type)", "extra bytes that nothing describes",
             "last digits of integers of 64 bits"],
            METADATA),
    "laz": (None, LAS + ["wide", "large"], ["COPC index"], METADATA),
    "npy": (whole_files.npy_of_everything(), "red green blue id".split(), ["label", "time", "integers beyond 2^53"]),
    "npz": (whole_files.npz_of_everything(), ["heat", "id"],
            ["integers beyond 2^53", "words", "other", "files that are no arrays"]),
    "glb": (whole_files.glb_of_everything(), "nx ny nz HEAT3_0 HEAT3_1 HEAT3_2 red green blue".split(),
            ["other scenes", "materials", "textures", "animations", "skins", "cameras", "lights",
             "names of nodes and meshes", "morph targets", "texture coordinates", "further colours", "tangents"]),
    "vtp": (whole_files.vtp_of_everything(), "red green blue nx ny nz heat".split(), VTK),
    "vtu": (whole_files.vtu_of_everything(), "red green blue nx ny nz heat".split(),
            VTK + ["cells of other types", "curved sides of cells"]),
    "vtk": (whole_files.vtk_of_everything(), "heat|nx|ny|nz|my flow_0|my flow_1|my flow_2|red|green|blue|t_0|t_1".split("|"),
            ["time of the file", "area of cells that are no polygons", "tables of colours", "label", "on", "wide", "cells of other types",
             "curved sides of cells"]),
    "stl": (whole_files.stl_of_everything(), [], ["attributes of faces"]),
    "ptx": ("2\n2\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n" + "1 0 0 0.5 1 2 3\n" * 4,
            "intensity red green blue".split(), ["order in rows", "poses"]),
    "node": ("2 3 1 1\n1 0 0 0 5 1\n2 1 0 0 6 0\n", ["attribute1", "boundary_marker"], []),
    "bnpts": (struct.pack("<6f", 1, 2, 3, 0, 0, 1), ["nx", "ny", "nz"], []),
    "extxyz": ('1\nLattice="1 0 0 0 1 0 0 0 1" Properties=species:S:1:pos:R:3:name:S:1:charge:R:1 energy=2\nH 0 0 0 one 1.5\n',
               ["atomic_number", "radius", "charge"], ["name", "comment"], CELL),
    "pdb": (PDB, ["atomic_number", "radius", "occupancy", "temperature_factor", "residue"],
            ["HEADER", "ANISOU", "CONECT", "names of atoms", "names of residues", "chains", "insertion codes", "segments",
             "charges", "alternate locations", "further models"], CELL),
    "cif": (CIF, ["atomic_number", "radius", "occupancy", "u_iso"],
            ["_chemical_name", "_atom_site_label", "_atom_site_aniso_label", "_atom_site_aniso_U_11", "_text", "sites without positions",
             "further blocks"], CELL),
    "poscar": ("quartz\n2.0\n1 0 0\n0 1 0\n0 0 1\nSi O_s\n1 1\nSelective dynamics\nDirect\n0 0 0 T F T Si1\n.5 .5 .5 F F F O1\n\n0 0 0\n0 0 0\n",
               ["atomic_number", "radius", "type", "moves_a", "moves_b", "moves_c"],
               ["comment", "labels of atoms", "what follows the positions"], CELL),
    "lammpstrj": ("ITEM: UNITS\nlj\n" + DUMP + DUMP, ["atomic_number", "radius", "id", "q"],
                  ["units", "timestep", "time", "name", "further frames"], CELL),
    "lmp": ("quartz\n\n1 atoms\n1 atom types\n2 bonds\n0 2 xlo xhi\n0 2 ylo yhi\n0 2 zlo zhi\n1 0 0 xy xz yz\n\nMasses\n\n1 28 # Si\n\n"
            "Atoms # full\n\n1 1 1 0.5 1 1 1 0 0 -1 # Si\n\nVelocities\n\n1 0 0 0\n", "id molecule type q ix iy iz".split(),
            ["comment", "Masses", "Velocities"], CELL)}
