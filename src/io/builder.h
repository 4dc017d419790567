/* A mesh under construction: arrays that grow as rows are read, and the checks that all formats share.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_FORMAT (with the file's name), BRIO_ERR_TOO_LARGE or
 * BRIO_ERR_NO_MEMORY. */
#ifndef BRIO_IO_BUILDER_H
#define BRIO_IO_BUILDER_H

#include "base/context.h"

#define BRIO_MAX_VERTICES ((uint64_t)UINT32_MAX - 16)

typedef struct brio_builder {
    brio_context *ctx;
    const char *name; /* the file's name, for messages */
    brio_mesh *mesh;
    unsigned index_base; /* the number that the file gives to its first vertex, for messages */
    size_t vertex_capacity, face_capacity, corner_capacity, tetrahedron_capacity, edge_capacity;
    size_t num_corners; /* corners of all faces, the unfinished face included */
} brio_builder;

/** Makes an empty mesh. It belongs to the caller: brio_mesh_free(b->mesh), on failure too. */
brio_status brio_builder_start(brio_builder *b, brio_context *ctx, const char *name);

/** Makes room for exactly `count` vertices, faces or tetrahedra. The caller knows that the file has as many. */
brio_status brio_builder_expect_vertices(brio_builder *b, uint64_t count);
brio_status brio_builder_expect_faces(brio_builder *b, uint64_t count);
brio_status brio_builder_expect_tetrahedra(brio_builder *b, uint64_t count);

/** Appends `count` vertices. The caller then sets their coordinates and properties. */
brio_status brio_builder_add_vertices(brio_builder *b, size_t count);
/** Appends one vertex. */
brio_status brio_builder_vertex(brio_builder *b, const double *point);
/** Adds a property. The caller sets the values of vertices that are there already. */
brio_status brio_builder_property(brio_builder *b, const char *name, brio_scalar type);
/** Adds a property whose values are in `data`. The mesh takes the block; on failure the function frees the block. */
brio_status brio_builder_adopt_property(brio_builder *b, const char *name, brio_scalar type, void *data);
/** Removes property i. */
void brio_builder_drop_property(brio_builder *b, size_t i);
/** Appends a corner to the face under construction.   index  the file's index minus its index base. */
brio_status brio_builder_corner(brio_builder *b, double index);
/** Ends the face under construction. */
brio_status brio_builder_face(brio_builder *b);
/** Appends a tetrahedron.   indices  4: the file's indices minus its index base. */
brio_status brio_builder_tetrahedron(brio_builder *b, const double *indices);
/** Appends an edge.   indices  2: the file's indices minus its index base. */
brio_status brio_builder_edge(brio_builder *b, const double *indices);

/** Releases unused memory, and checks all indices and coordinates. May also return BRIO_ERR_NOT_FINITE. */
brio_status brio_builder_finish(brio_builder *b);

#endif
