/* A mesh under construction: arrays that grow as rows come in, and the checks that every format shares. */
#ifndef BRIO_IO_BUILDER_H
#define BRIO_IO_BUILDER_H

#include "base/context.h"

#define BRIO_MAX_VERTICES ((uint64_t)UINT32_MAX - 16)

typedef struct brio_builder {
    brio_context *ctx;
    const char *name; /* of the file, for messages */
    brio_mesh *mesh;
    unsigned index_base; /* the file's number of the first vertex, for messages */
    size_t vertex_capacity, face_capacity, corner_capacity, tetrahedron_capacity;
    size_t num_corners; /* of all faces, the unfinished one included */
} brio_builder;

/** Makes the empty mesh. */
brio_status brio_builder_start(brio_builder *b, brio_context *ctx, const char *name);

/** Makes room for exactly so many vertices, faces, tetrahedra: for counts that are known to be true. */
brio_status brio_builder_expect_vertices(brio_builder *b, uint64_t count);
brio_status brio_builder_expect_faces(brio_builder *b, uint64_t count);
brio_status brio_builder_expect_tetrahedra(brio_builder *b, uint64_t count);

/** Appends `count` vertices, whose coordinates and properties the caller then sets. */
brio_status brio_builder_add_vertices(brio_builder *b, size_t count);
/** Appends one vertex. */
brio_status brio_builder_vertex(brio_builder *b, const double *point);
/** Adds a property; before the first vertex. */
brio_status brio_builder_property(brio_builder *b, const char *name, brio_scalar type);
/** Adds a property whose values are there; the mesh takes the block over, and frees it when this fails. */
brio_status brio_builder_adopt_property(brio_builder *b, const char *name, brio_scalar type, void *data);
/** Takes property i away again. */
void brio_builder_drop_property(brio_builder *b, size_t i);
/** Appends a corner to the face under construction.   index  as the file has it, less its index base. */
brio_status brio_builder_corner(brio_builder *b, double index);
/** Ends the face under construction. */
brio_status brio_builder_face(brio_builder *b);
brio_status brio_builder_tetrahedron(brio_builder *b, const double *indices);

/** Gives back the room not used, and checks all indices and coordinates. */
brio_status brio_builder_finish(brio_builder *b);

#endif
