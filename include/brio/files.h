/* brio/files.h: reading, writing and converting files. */
#ifndef BRIO_FILES_H
#define BRIO_FILES_H

#include "mesh.h"
#include "points.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_read_options brio_read_options;
typedef struct brio_write_options brio_write_options;

/** Reads a file. Keeps vertices, polygons, tetrahedra and every scalar property of vertices and polygons; skips other
 *  elements. What is read, kept and lost of each format is in docs/formats.md. Chunks of LAZ files are decoded in
 *  threads. A file compressed by gzip or zstd is decompressed while it is read, if the library was built with zlib or
 *  libzstd; messages then count lines and bytes of what was decompressed.
 *  path  "-" reads standard input.   options  NULL for the defaults.   out  owned by the caller; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (columns of a format that has none, or that lack x, y or z), BRIO_ERR_OPEN,
 *  BRIO_ERR_FORMAT (the message names the file, the line or byte offset, and what was expected), BRIO_ERR_NOT_FINITE
 *  (the message names the first such point and their number), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_read(brio_context *ctx, const char *path, const brio_read_options *options, brio_mesh **out);

/** Writes a mesh. Writes a temporary file beside the target, flushes it, and renames it to the target, so that no
 *  half-written file is ever left. A symbolic link stays, and the file that it leads to is made or replaced. The
 *  permissions of an existing file stay. "-" writes to standard output; the format must then be given. Standard output,
 *  pipes and devices are written in place, and the progress callback can cancel a wait for their readers. So is a
 *  descriptor of the process (/dev/stdout, /dev/fd/7, /proc/self/fd/7), at its place, also when it leads to a file. The
 *  process receives neither SIGPIPE nor SIGXFSZ. What a format cannot hold is left out: properties, edges, faces, as
 *  brio_format_facts tells; faces of fewer than three corners by STL and GLB. In the names of
 *  properties, formats that cannot quote have _ for blanks and commas, and _2 behind a name that is taken, also by a
 *  coordinate; a comment of several lines becomes several comments. Of several files (.node and those beside it) none
 *  gets its name before all are complete.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the format cannot hold the mesh, an index is out of range, or three tetrahedra
 *  whose neighbours are asked for share a facet), BRIO_ERR_NOT_FINITE, before a file is opened, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write(brio_context *ctx, const char *path, const brio_mesh *mesh,
                                const brio_write_options *options);

/** File formats. BRIO_FORMAT_AUTO decides by the extension, and by the content of the file where it tells the
 *  format. A format need not have a name here: brio_format_of finds the number of each, up to BRIO_FORMAT_MOST, and
 *  numbers for which brio_format_facts returns NULL are free. */
typedef enum brio_format {
    BRIO_FORMAT_AUTO = 0,
    BRIO_FORMAT_PLY = 1,
    BRIO_FORMAT_XYZ = 2, /* .xyz .txt .csv .asc .tsv .dat */
    BRIO_FORMAT_OBJ = 3,
    BRIO_FORMAT_OFF = 4,
    BRIO_FORMAT_VTU = 5,
    BRIO_FORMAT_NODE = 6, /* TetGen's .node, with .ele beside it */
    BRIO_FORMAT_VTP = 7,
    BRIO_FORMAT_LAS = 8, /* versions 1.0 to 1.5, point formats 0 to 10 without waveforms */
    BRIO_FORMAT_LAZ = 9, /* LAS, compressed as by LASzip; written in formats 0 to 3 and 6 to 8 */
    BRIO_FORMAT_PCD = 10,
    BRIO_FORMAT_PTX = 11,
    BRIO_FORMAT_STL = 12,      /* single precision; where it is read, corners at the same position become one vertex */
    BRIO_FORMAT_NPY = 13,      /* NumPy: an array of rows of coordinates, or of records with names */
    BRIO_FORMAT_GLB = 14,      /* glTF 2.0: .glb; .gltf is read, not written. Single precision about an origin */
    BRIO_FORMAT_E57 = 15,      /* read where brio was built with the library expat; written to files, not to pipes */
    BRIO_FORMAT_CHEMICAL = 16, /* .xyz with element symbols or atomic numbers: read, not written */
    BRIO_FORMAT_BNPTS = 17,    /* oriented points of Kazhdan's Poisson programs: read, not written */
    BRIO_FORMAT_NPZ = 18,      /* NumPy's zip of arrays: read, not written */
    BRIO_FORMAT_VTK = 19,      /* VTK's legacy files of polygonal data and unstructured grids */
    BRIO_FORMAT_PTS = 20,      /* texts without names: the number of points, then x y z, intensity, red green blue */
    BRIO_FORMAT_XYZRGB = 21,   /* x y z, red green blue from 0 to 1 */
    BRIO_FORMAT_XYZN = 22,     /* x y z, nx ny nz */
    BRIO_FORMAT_PDB = 23,      /* atoms of the Protein Data Bank's files; this and the next four: read, not written */
    BRIO_FORMAT_CIF = 24,      /* atoms of crystals whose sites are listed in P1, and of macromolecules */
    BRIO_FORMAT_POSCAR = 25,   /* VASP's POSCAR and CONTCAR */
    BRIO_FORMAT_LAMMPS_DUMP = 26, /* the first frame of a text dump of LAMMPS */
    BRIO_FORMAT_LAMMPS_DATA = 27, /* what LAMMPS's read_data reads: the section Atoms */
    BRIO_FORMAT_MOST = 255        /* no number is larger */
} brio_format;

/** Returns the format of a file name or of an extension with or without its dot; BRIO_FORMAT_AUTO if it is unknown. */
BRIO_API brio_format brio_format_of(const char *path);

/** What a format can hold, as bits of brio_format_info.holds. */
enum {
    BRIO_HOLDS_FACES = 1,
    BRIO_HOLDS_TETRAHEDRA = 2,
    BRIO_HOLDS_EDGES = 4,              /* of brio_mesh.edges */
    BRIO_HOLDS_PROPERTIES = 8,         /* of the vertices, any of them */
    BRIO_HOLDS_NAMES = 16,             /* the names of the properties */
    BRIO_HOLDS_DOUBLES = 32,           /* coordinates in double precision */
    BRIO_HOLDS_SINGLES = 64,           /* coordinates in single precision: by choice where doubles are held, too */
    BRIO_HOLDS_TEXT = 128,             /* the file can be a text */
    BRIO_HOLDS_BINARY = 256,           /* the file can be binary */
    BRIO_HOLDS_COMPRESSED = 512,       /* brio_write_options.compress has a meaning */
    BRIO_HOLDS_COLOURS = 1024,         /* red, green and blue, though not all properties */
    BRIO_HOLDS_NORMALS = 2048,         /* nx, ny and nz, though not all properties */
    BRIO_HOLDS_RARE_DOUBLES = 4096,    /* doubles that the usual readers of the format take for zeros: not singles */
    BRIO_HOLDS_FACE_PROPERTIES = 8192, /* of the faces, any of them */
    BRIO_HOLDS_FACE_COLOURS = 16384,   /* red, green, blue and alpha of the faces, though not all properties */
    BRIO_HOLDS_ORIGIN = 32768,         /* an origin, from which coordinates in single precision are counted */
    BRIO_HOLDS_PLACES = 65536,         /* places of its parts, known at its end: it goes to a file, not into a pipe */
    BRIO_HOLDS_PARTS = 131072          /* points and tetrahedra that are written part by part: brio_mesh_parts_new */
};

/** What is known of a format. */
typedef struct brio_format_info {
    size_t size; /* of the struct in the library that runs */
    brio_format format;
    const char *name; /* as messages call it, with its article: "a PLY file" */
    const char
        *extensions; /* that are read, without dots, blanks between them; the first one is the format's short name */
    const char *written;      /* those of them that are written; "" if the format is read only */
    unsigned holds;           /* BRIO_HOLDS_FACES and so on: what a file that brio writes can hold */
    unsigned most_properties; /* in a file; 0: any number */
    const char *properties;   /* names of single ones that are held though not all are, such as "intensity", blanks
                                 between them; NULL: none */
} brio_format_info;

/** Returns what is known of a format, valid for ever; NULL for BRIO_FORMAT_AUTO and what is no format. */
BRIO_API const brio_format_info *brio_format_facts(brio_format format);

enum { BRIO_FORMAT_LIST = 512 }; /* bytes that a list of all extensions fits in */
/** Lists extensions, as messages do, in the order of the formats' numbers: ".ply .vtu .vtp".
 *  written  1: those that are written; 0: those that are read.
 *  holds    BRIO_HOLDS_FACES and so on: of formats that hold all of that; 0: of all formats.
 *  text     receives the list; where `size` bytes are too few, extensions are left out. */
BRIO_API void brio_format_list(int written, unsigned holds, char *text, size_t size);

/** Receives the name of something that a mesh or a file cannot hold, valid during the call. */
typedef void (*brio_lost_fn)(const char *name, void *user);
/** What a reader found that the caller may not expect. */
typedef struct brio_read_notes {
    size_t size;
    int numbered; /* 1: a text whose columns have no names, and whose first column, read as x, numbers the rows from 0 or 1
                     on, as in id x y z; in any order, 4 rows at least */
    int reserved_int;
    uint64_t rounded;        /* whole numbers of a text that doubles do not hold (beyond 2^53) and that were rounded */
    uint64_t rounded_line;   /* of the first of them */
    char rounded_column[64]; /* its property, or x, y or z */
} brio_read_notes;

/** Options of reading. A field of 0 is the default. */
struct brio_read_options {
    size_t size;
    brio_format format;
    const char
        *columns;     /* texts of points (BRIO_FORMAT_XYZ): the names of the columns in their order, "x,y,z,-,nx"; - and
                            _ leave a column out, as it happens to columns behind the last name. x, y and z have to be
                            there. NULL: by the file's line of names, or else the first three */
    int drop_invalid; /* 1: leaves out points whose coordinates are not finite, and the polygons, tetrahedra and edges
                              that use them; 0: such points are an error */
    int salvage;      /* 1: of a file that ends early, keeps the points that are whole; 0: an error.
                              docs/formats.md lists the formats */
    uint64_t *dropped;     /* receives the number of points that drop_invalid left out */
    uint64_t *missing;     /* receives the number of points that the file announces and lacks */
    brio_lost_fn left_out; /* called once for each part of the file that the mesh has not, such as "textures", after all
                              has been read; docs/formats.md lists the names */
    void *left_out_user;
    brio_read_notes *notes; /* NULL, or receives what was found */
    int flat; /* texts of points, 1: data over a map. Names of columns that have x and y and no height mean that z is 0, and so
                 do rows of two numbers without names; 0: z has to be there */
    int reserved_int;
    int *origins; /* NULL, or adds the places of the scanners as properties x_origin, y_origin, z_origin
                     (float64) of their points, NaN where a place is not known, and receives 1; receives 0 if the file has
                     such properties or tells no place. docs/formats.md tells when PTX, E57 and PCD files do */
};

/** brio_read of a file's bytes in memory, compressed ones included. No file is opened: a .node file's tetrahedra, which
 *  are in another file, are not read.
 *  bytes  size of them, not kept.
 *  name   what messages call the file, "scan.ply"; its extension tells the format where the content does not. NULL is
 *         for none: then bytes in no known format are rows of numbers.
 *  Returns what brio_read returns, but not BRIO_ERR_OPEN. */
BRIO_API brio_status brio_read_memory(brio_context *ctx, const void *bytes, size_t size, const char *name,
                                      const brio_read_options *options, brio_mesh **out);

/** Finds the cell in which the points of a file repeat: the metadata "cell.vectors" and "cell.periodic", which files of
 *  atoms have (docs/formats.md).
 *  cell, open  receive the vectors and the directions that do not repeat, as brio_periodic_options takes them.
 *  Returns 1, or 0 where the mesh has no cell: then nothing is set. */
BRIO_API int brio_mesh_cell(const brio_mesh *mesh, double cell[9], int open[3]);

/** What a file is. */
typedef struct brio_file_facts {
    size_t size;
    brio_format format;
    int streamed;     /* 1: the callback received the points block by block */
    char version[64]; /* of the file, where the format has versions, such as "1.2, point format 3"; else "" */
} brio_file_facts;

/** Receives a part of a file. `block` is valid during the call. A result other than 0 cancels the reading. If a call of
 *  the callback with the same context failed, brio_message then still has the sentence of that failure. */
typedef int (*brio_rows_fn)(const brio_mesh *block, void *user);

/** Reads a file as brio_read does, and hands over its points in blocks of some 65,536, in the order of the file, each
 *  with its part of the properties: a file of any size needs the memory of a few blocks. All blocks have the same
 *  properties; a file without points is one empty block. Files with polygons or tetrahedra, and formats and orders that
 *  do not hold one point after the other (OBJ, OFF, VTU, NODE, STL, NPZ, NPY in Fortran's order), are one block.
 *  facts  NULL, or receives what the file is.
 *  Returns what brio_read returns; BRIO_ERR_CANCELLED if the callback asked for it; BRIO_ERR_FORMAT if a row of a text
 *  lacks a column that earlier blocks have. Earlier blocks were handed over when an error is found. */
BRIO_API brio_status brio_read_blocks(brio_context *ctx, const char *path, const brio_read_options *options,
                                      brio_rows_fn take, void *user, brio_file_facts *facts);

/** Options of writing. A field of 0 is the default. */
struct brio_write_options {
    size_t size;
    brio_format format;  /* BRIO_FORMAT_AUTO: by the extension */
    int ascii;           /* 1: text, in formats with a text and a binary form */
    int float32;         /* 1: coordinates in single precision, in formats with both */
    const char *comment; /* a line for the header */
    double *moved;       /* receives the greatest distance between a vertex and the point that a reader gets: not 0
                            where the format or `float32` rounds coordinates */
    int compress;        /* 1: compressed by zlib: VTU and VTP, if the library was built with zlib */
    /* NODE, 1: TetGen's .neigh, .face and .edge too, beside .ele. They are found from the tetrahedra, with 40
     * bytes a tetrahedron. Facets of one tetrahedron alone are the hull, whose faces and edges have the marker 1. */
    int neighbours, faces, edges;
    const char *separator; /* XYZ: "," or " " between numbers; with "," there is no comment; NULL: by the name, ","
                              for .csv */
    int *colours_rounded;  /* receives 1 if the file's colours have fewer steps than the mesh's, else 0 */
    int crs_comment;       /* PLY, 1: the metadata crs.wkt, or without it crs.code, as comments "crs TEXT" */
    int reserved_int;
};

/** A file of points and tetrahedra that is written part by part, for meshes that are in no memory as a whole: a format
 *  with BRIO_HOLDS_PARTS, which is PLY. It has the rows of brio_write: first all points, in blocks with the same
 *  properties, then the tetrahedra. The file gets its name at the end.
 *
 *     brio_mesh_parts_new(ctx, path, NULL, num_vertices, num_tetrahedra, &p);
 *     ... brio_mesh_parts_vertices(ctx, p, block) for each block, then
 *     ... brio_mesh_parts_tetrahedra(ctx, p, tetrahedra, count) for each part
 *     brio_mesh_parts_finish(ctx, p);
 *     brio_mesh_parts_free(p); */
typedef struct brio_mesh_parts brio_mesh_parts;

/** Begins a file.
 *  options  NULL, or as in brio_write; its strings and results stay valid until brio_mesh_parts_free.
 *  num_vertices, num_tetrahedra  of all parts; at most 2^32 - 1 points.
 *  out      owned by the caller: brio_mesh_parts_free; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no .ply), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_parts_new(brio_context *ctx, const char *path, const brio_write_options *options,
                                         uint64_t num_vertices, uint64_t num_tetrahedra, brio_mesh_parts **out);
/** Does what brio_mesh_parts_new does for a file of points and triangles.   num_faces  of all parts. */
BRIO_API brio_status brio_mesh_parts_new_faces(brio_context *ctx, const char *path, const brio_write_options *options,
                                               uint64_t num_vertices, uint64_t num_faces, brio_mesh_parts **out);
/** Looks at the colours of a block, before any points are appended: numbers that can be bytes, or from 0 to 1, or 16
 *  bits, tell by the greatest one which of these they are. Without a look the first block decides.
 *  Returns 1 if the other blocks have to be shown as well, in any order and more than once; 0 if none has to be. */
BRIO_API int brio_mesh_parts_look(brio_mesh_parts *p, const brio_mesh *block);
/** Appends points with their properties; faces, tetrahedra and edges of the block are not written.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (also for more points than were announced), BRIO_ERR_NOT_FINITE, BRIO_ERR_FORMAT
 *  (other properties than the first block's; colours that it did not show), BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_parts_vertices(brio_context *ctx, brio_mesh_parts *p, const brio_mesh *block);
/** Appends tetrahedra, once all points are there.   tetrahedra  count by 4: rows of points.   Returns as the above. */
BRIO_API brio_status brio_mesh_parts_tetrahedra(brio_context *ctx, brio_mesh_parts *p, const uint32_t *tetrahedra,
                                                size_t count);
/** Appends triangles, once all points are there.   faces  count by 3: rows of points.   Returns as the above. */
BRIO_API brio_status brio_mesh_parts_faces(brio_context *ctx, brio_mesh_parts *p, const uint32_t (*faces)[3],
                                           size_t count);
/** Ends the file and gives it its name.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (not as many as were announced), BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_parts_finish(brio_context *ctx, brio_mesh_parts *p);
/** Frees everything; NULL is accepted. A file that was not finished disappears. */
BRIO_API void brio_mesh_parts_free(brio_mesh_parts *p);

/** A file of a tile that was written. */
typedef struct brio_convert_tile {
    size_t size;
    const char *path;
    uint64_t points;
    double low[3], high[3]; /* box of the points; 0 if there are none */
    const brio_mesh *kind;  /* names and types of the properties, metadata: of all points that were read; no vertices */
} brio_convert_tile;

/** Is called for each tile, valid during the call. Returns 0 to go on, anything else to cancel. */
typedef int (*brio_convert_tile_fn)(const brio_convert_tile *tile, void *user);

typedef struct brio_convert_options {
    size_t size;
    const brio_read_options *from;         /* NULL: the defaults of reading */
    const brio_write_options *to;          /* NULL: the defaults of writing */
    int crop;                              /* 1: keeps what is in the box */
    int drop_outliers;                     /* neighbours by which brio_outliers judges; 0: keeps outliers */
    double box[6];                         /* x0, y0, z0, x1, y1, z1; its border belongs to it */
    const brio_outliers_options *outliers; /* NULL: the defaults of brio_outliers */
    double thin;                           /* spacing of brio_thin; 0: keeps all points */
    brio_lost_fn lost; /* NULL: called once for each part that is lost, before the file gets its name */
    void *lost_user;
    brio_lost_fn renamed; /* NULL: called once for each property that has another name in the file */
    void *renamed_user;
    int merge; /* 1: brio_mesh_merge_vertices, within merge_distance */
    int reserved_int;
    double merge_distance;   /* 0: equal positions only */
    const char *crs;         /* NULL: a file that receives the coordinate system as well-known text, such as scan.prj */
    uint32_t tiles;          /* 0: one file; else the points are divided among as many, at most 65,536 */
    uint32_t num_more;       /* with tiles: further inputs, */
    const char *const *more; /* whose points follow those of the first one */
    const char *scratch;     /* with tiles: a folder for the points meanwhile */
    brio_convert_tile_fn tile; /* NULL: called when the file of a tile has its name */
    void *tile_user;
} brio_convert_options;

typedef struct brio_convert_stats {
    size_t size;
    uint64_t points_read, points, faces, tetrahedra, edges; /* read; written */
    uint64_t outliers, thinned;                             /* points dropped by the options of these names */
    int streamed;                                           /* 1: block by block; 0: the whole file was in memory */
    int passes;                                             /* how often the file was read */
    double select_seconds, seconds;                         /* finding outliers and thinning, reading included; all */
    uint64_t merged;                                        /* vertices that others stand for, by options->merge */
    uint64_t degenerate;                                    /* faces, tetrahedra and edges dropped by merging */
    uint64_t tiles, largest_tile;        /* with options->tiles: those that have points; of the largest */
    uint64_t scratch_bytes;              /* of the disk, at most */
    double read_seconds, divide_seconds; /* with options->tiles */
} brio_convert_stats;

/** Converts a file to another format, or chooses among its points, or both. First come the points in the box, of these
 *  those that are no outliers, of these a thinned set; the points keep their order and all properties. A polygon,
 *  tetrahedron or edge stays if all its vertices stay. Merging comes last; the whole file is then in memory.
 *  Memory: files of points are converted block by block, in less than 64 MB with two threads, from LAS, LAZ, PLY, text,
 *  NPY, PCD (uncompressed) and PTX to LAS, LAZ, PLY, text, NPY, PCD, E57 and PTX. The input is read twice or three
 *  times if the output must know all points before the first one (LAS, LAZ, E57 and PTX; PLY and NPY into a pipe, if
 *  their number is not known), or if outliers are dropped or points are thinned. Outliers and thinning need the
 *  coordinates in memory: 24 bytes a point, and what brio_outliers and brio_thin take. Where an input that must be read
 *  again is no regular file, and for other formats and meshes, the whole file is in memory.
 *  What the other format cannot hold is left out and named to options->lost: "faces", "tetrahedra", "edges", the names
 *  of properties, "NAME of faces" for those of faces, the names of metadata ("crs" for a coordinate system), "faces of
 *  dropped points" if outliers or thinning take corners of faces, tetrahedra or edges, and "precision" if coordinates,
 *  or whole numbers of a text, are rounded; and so is what brio does not read of the input, by the names of
 *  brio_read_options.left_out. What is only renamed goes to options->renamed. With options->crs an input without a
 *  coordinate system as well-known text is BRIO_ERR_NO_ANSWER, and nothing is written. Progress begins anew where a
 *  text is read again because late rows lack a column.
 *  With options->tiles points of any number become as many tiles of about equal numbers of points, by a k-d tree over a
 *  sample, as brio_tiles divides them. `to` has a # in the place of the number of a tile, as in "folder/#.laz", whose
 *  folder is there. Each point is in one file, with all that the conversion to one file keeps, in the order of the
 *  input; together the files have the same depth of colours and, LAS and LAZ, the same grid and fields. Tiles without
 *  points have no file; if no tile has points, there is one empty file. Numbers are 0, 1 and so on. The points go to a
 *  file without a name in the folder `scratch`, twice: 24 bytes each and their properties. No tile is
 *  in memory for the formats that are written block by block; else the largest is. Faces, tetrahedra and edges are
 *  left out, and `merge` is refused. Several inputs have the same properties, in any order, and the same coordinate
 *  system; all else that the first one says is kept. Files of tiles stay where a later one fails: the caller removes
 *  them.
 *  from, to  paths of different files; "-" as in brio_read and brio_write.
 *  stats     NULL, or receives facts.
 *  Returns what brio_read, brio_write, brio_outliers, brio_thin and brio_mesh_merge_vertices return, and
 *  BRIO_ERR_FORMAT if the input changed between two readings. */
BRIO_API brio_status brio_convert(brio_context *ctx, const char *from, const char *to,
                                  const brio_convert_options *options, brio_convert_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
