/* A mesh under construction: arrays that grow as rows are read, and the checks that all formats share.
 *
 * A builder with a sink hands the vertices on in blocks, if the reader says that it appends rows and does not look at
 * earlier ones (brio_builder_stream). Each time that new vertices do not fit in a block, the sink receives those that
 * are there, and the mesh begins again with none. So a file of any length needs the memory of a block. A reader that
 * does not say so fills one mesh, whatever the sink.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_FORMAT (with the file's name), BRIO_ERR_TOO_LARGE or
 * BRIO_ERR_NO_MEMORY. */
#ifndef BRIO_IO_BUILDER_H
#define BRIO_IO_BUILDER_H

#include "base/finite.h"
#include "io/blocks.h"
#include "io/limits.h"
#include "io/stream.h"

#define BRIO_MAX_VERTICES ((uint64_t)UINT32_MAX - 16)

/** Receives a file's vertices with their properties, block by block. A file without vertices is one empty block. The
 *  block is valid during the call. */
typedef struct brio_sink {
    brio_status (*take)(void *user, const brio_mesh *block);
    void *user;
} brio_sink;

#define BRIO_COUNT_UNKNOWN UINT64_MAX

enum { BRIO_NAME_SLOTS = 2 * BRIO_MOST_NUMBERS };

/** The names of the properties, so that a new one is compared with few of them. Slots hold one more than the property's
 *  number, 0 if they are empty; `next` is the number by which the next name like that of the property differs. */
typedef struct brio_names {
    uint16_t slot[BRIO_NAME_SLOTS], next[BRIO_MOST_NUMBERS];
    size_t count; /* properties that are in the slots */
} brio_names;

typedef struct brio_builder {
    brio_context *ctx;
    const char *name; /* the file's name, for messages */
    brio_mesh *mesh;
    unsigned index_base; /* the number that the file gives to its first vertex, for messages */
    size_t vertex_capacity, face_capacity, corner_capacity, tetrahedron_capacity, edge_capacity;
    size_t num_corners;    /* corners of all faces, the unfinished face included */
    const brio_sink *sink; /* NULL: the mesh keeps all vertices */
    bool streams;          /* whether vertices go to the sink block by block */
    uint64_t passed;       /* vertices that the sink has received */
    uint64_t *announced;   /* NULL, or receives the number of vertices that the file will have (brio_builder_stream) */
    bool flat;             /* texts of points may have no z, which then is 0 */
    bool drop_invalid;     /* leaves out vertices that are not finite, instead of refusing the file */
    bool salvage;          /* readers keep the whole points of a file that ends early, and say how many miss */
    uint64_t missing;      /* points that such a file lacks */
    brio_not_finite refused; /* vertices seen that are not finite: with `streams` or `drop_invalid` */
    bool origins;            /* the caller wants the places of scanners as properties */
    bool has_origins;        /* the properties are there, */
    size_t first_origin;     /* from this one on */
    bool scans;              /* the caller wants the places in the grids of scans as properties, too */
    char version[64];        /* what the reader says of the file's version; may be empty */
    brio_names names;
    char (*left_out)[64]; /* names of what the file has and the mesh has not, each once: brio_builder_leave_out */
    size_t num_left_out, left_out_capacity;
    brio_read_notes notes; /* what the reader says of the file's content; without its size */
} brio_builder;

/** Makes an empty mesh. It belongs to the caller: brio_mesh_free(b->mesh), on failure too. */
brio_status brio_builder_start(brio_builder *b, brio_context *ctx, const char *name);

/** Announces that vertices are appended, and not looked at again once others follow. Readers call this before the first
 *  vertex.   announced  the number of vertices, if every row becomes one; otherwise BRIO_COUNT_UNKNOWN. */
void brio_builder_stream(brio_builder *b, uint64_t announced);

/** Returns the number of vertices that were appended. */
static inline uint64_t brio_builder_count(const brio_builder *b) {
    return b->passed + b->mesh->num_vertices;
}

/** Makes room for exactly `count` vertices, faces or tetrahedra. The caller knows that the file has as many. */
brio_status brio_builder_expect_vertices(brio_builder *b, uint64_t count);
brio_status brio_builder_expect_faces(brio_builder *b, uint64_t count);
brio_status brio_builder_expect_tetrahedra(brio_builder *b, uint64_t count);

/** Appends `count` vertices: the last ones of b->mesh. The caller then sets their coordinates and properties. */
brio_status brio_builder_add_vertices(brio_builder *b, size_t count);
/** Appends one vertex. */
brio_status brio_builder_vertex(brio_builder *b, const double *point);
/** Notes that a part of the file is not in the mesh, such as "textures". A name that was noted before adds nothing, and
 *  behind the 200th all are "others". */
brio_status brio_builder_leave_out(brio_builder *b, const char *name);
/** Returns whether a property has the name. */
bool brio_builder_has(brio_builder *b, const char *name);

/** Adds a property, one of at most BRIO_MOST_NUMBERS. The caller sets the values of vertices that are there already. */
brio_status brio_builder_property(brio_builder *b, const char *name, brio_scalar type);
/** Makes a name that no property has: SOURCE, or SOURCE_2, SOURCE_3 and so on, cut in whole characters.
 *  source  any bytes; those that are no UTF-8 are taken for Latin-1 */
void brio_builder_new_name(brio_builder *b, const char *source, char name[64]);
/** Makes the name of number `which` of the `count` numbers that SOURCE is the name of: as above, of SOURCE_WHICH if
 *  there are several. */
void brio_builder_component_name(brio_builder *b, const char *source, uint64_t which, uint64_t count, char name[64]);
/** Adds a property whose values are in `data`. The mesh takes the block; on failure the function frees the block. */
brio_status brio_builder_adopt_property(brio_builder *b, const char *name, brio_scalar type, void *data);
/** Adds a property of the faces, one of at most BRIO_MOST_NUMBERS. Faces that are there already, and new ones, have 0
 *  until the caller sets their values. The name may be taken by no other property of the faces:
 *  brio_builder_new_face_name. The property is b->mesh->face_properties[which], with `which` their number before. */
brio_status brio_builder_face_property(brio_builder *b, const char *name, brio_scalar type);
/** Makes a name that no property of the faces has: SOURCE, or SOURCE_2 and so on; as brio_builder_new_name. */
void brio_builder_new_face_name(const brio_builder *b, const char *source, char name[64]);
/** Sets property `which` of the face that was added last. Returns whether its type holds the value. */
bool brio_builder_face_value(brio_builder *b, size_t which, double value);
/** Appends a corner to the face under construction.   index  the file's index minus its index base. */
brio_status brio_builder_corner(brio_builder *b, double index);
/** Ends the face under construction. */
brio_status brio_builder_face(brio_builder *b);
/** Appends a tetrahedron.   indices  4: the file's indices minus its index base. */
brio_status brio_builder_tetrahedron(brio_builder *b, const double *indices);
/** Appends an edge.   indices  2: the file's indices minus its index base. */
brio_status brio_builder_edge(brio_builder *b, const double *indices);

/** Releases unused memory, and checks all indices and coordinates. With `streams` hands on the last block. May also
 *  return BRIO_ERR_NOT_FINITE, and what the sink returns. */
brio_status brio_builder_finish(brio_builder *b);

/* --- files that end early --- */

/* Keeps the whole rows of a file that ends early, where the caller asked for that (brio_builder.salvage). */

/** Looks at the row s->row that was read, or could not be, because the file ended within it. A last line without its
 *  end is such a row unless the file announces no row behind it: its last number may have lost digits.
 *  before  the number of vertices before the row; what the row added disappears.
 *  points  whether the rows are the points, which b->missing then counts; other rows are named as left out.
 *  status  of the row; becomes that of this function if the row is given up.
 *  Returns whether the row and all behind it are given up. */
bool brio_salvage(brio_builder *b, brio_stream *s, uint64_t before, bool points, brio_status *status);

/* --- places of scanners --- */

/* Places of scanners as properties of the points that they saw. */

/** Adds the properties x_origin, y_origin, z_origin (float64), if the caller asked for them (brio_read_options.origins)
 *  and the file has none of these names. Call once all other properties are there, before the first vertex or with all
 *  of them NaN. Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_plan_origins(brio_builder *b);

/** Gives the mesh's vertices from `first` on their place. Does nothing if there is no such property.
 *  place  3; NULL: not known, which is NaN. */
void brio_set_origins(brio_builder *b, size_t first, const double *place);

#endif
