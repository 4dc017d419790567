/* What the tags of a VTU or VTP file say: how arrays are encoded, the pieces with their counts, and the arrays. */
#ifndef BRIO_IO_VTK_HEADER_H
#define BRIO_IO_VTK_HEADER_H

#include "io/stream.h"
#include "io/vtk/xml_tag.h"

/* Types of arrays: the types of properties, then two types that become doubles. */
enum { BRIO_VTK_INT64 = BRIO_SCALAR_END, BRIO_VTK_UINT64, BRIO_VTK_TYPE_END };

/* Where an array is. VTU has CELLS; VTP has LINES, STRIPS and POLYS. */
typedef enum {
    BRIO_VTK_OTHER,      /* also cells that are points */
    BRIO_VTK_FIELD_DATA, /* passed over */
    BRIO_VTK_POINTS,
    BRIO_VTK_POINT_DATA,
    BRIO_VTK_CELL_DATA,
    BRIO_VTK_CELLS,
    BRIO_VTK_LINES,
    BRIO_VTK_STRIPS,
    BRIO_VTK_POLYS,
    BRIO_VTK_SECTION_END
} brio_vtk_section;

typedef enum { BRIO_VTK_RAW, BRIO_VTK_BASE64, BRIO_VTK_TEXT } brio_vtk_encoding;

typedef struct brio_vtk_array {
    char name[BRIO_XML_VALUE];
    brio_vtk_section section;
    int type;
    brio_vtk_encoding encoding; /* of an array that is not appended */
    bool appended;
    bool empty;                  /* the tag has no content */
    uint64_t components, offset; /* offset: from the start of the appended data */
    size_t piece;
} brio_vtk_array;

typedef struct brio_vtk_piece {
    uint64_t first_point, num_points; /* first_point: the points of the pieces before */
    uint64_t first_cell;              /* likewise of all cells */
    uint64_t
        num_cells[BRIO_VTK_SECTION_END]; /* of the sections from BRIO_VTK_CELLS on, and of points in BRIO_VTK_OTHER */
} brio_vtk_piece;

typedef struct brio_vtk_header {
    bool known;      /* whether the tag VTKFile was read */
    bool polygonal;  /* PolyData, otherwise UnstructuredGrid */
    bool swap;       /* whether the arrays are in the other byte order than this machine's */
    bool compressed; /* whether arrays that are no text are compressed, and by what */
    char compressor[BRIO_XML_VALUE];
    size_t word; /* bytes of the numbers in front of an array */
    brio_vtk_piece *pieces;
    size_t num_pieces, piece_capacity;
    brio_vtk_section section;
} brio_vtk_header;

/** Returns the number of cells of a piece. */
uint64_t brio_vtk_cells_of(const brio_vtk_piece *piece);
/** Returns the first row that a section of a piece has in cell data: points come first, then lines, polygons, strips. */
uint64_t brio_vtk_first_row(const brio_vtk_piece *piece, brio_vtk_section section);

/** Takes what a tag says, except DataArray. */
brio_status brio_vtk_header_tag(brio_stream *s, brio_vtk_header *header, const char *tag);
/** Reads the tag DataArray. The type of an array that is passed over may be BRIO_VTK_TYPE_END. */
brio_status brio_vtk_header_array(brio_stream *s, const brio_vtk_header *header, const char *tag,
                                  brio_vtk_array *array);
/** Frees what a header owns. */
void brio_vtk_header_free(brio_context *ctx, brio_vtk_header *header);

/** Returns the bytes of a type of arrays. */
size_t brio_vtk_type_size(int type);
/** Returns the name of a type of arrays. */
const char *brio_vtk_type_name(int type);

#endif
