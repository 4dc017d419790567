/* The geometry of a glTF file as a mesh. */
#ifndef BRIO_IO_GLB_MESH_H
#define BRIO_IO_GLB_MESH_H

#include "io/builder.h"
#include "io/glb/glb_column.h"

/* A mesh of the file at its place. */
typedef struct brio_glb_instance {
    double matrix[16]; /* column by column, from the mesh to the scene */
    uint32_t mesh;
} brio_glb_instance;

/** Finds the meshes of the scene, in the order of its tree.   out  owned by the caller (brio_release), also on failure.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (no tree), BRIO_ERR_NO_MEMORY. */
brio_status brio_glb_instances(const brio_glb_file *file, brio_glb_instance **out, size_t *count);

/** Adds the meshes of the scene.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_glb_add_scene(const brio_glb_file *file, brio_builder *b);

/** Adds the faces and edges of a primitive.
 *  first, count  its vertices.   flip  whether faces are turned round, because the place is a mirror image.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_glb_add_cells(const brio_glb_file *file, brio_builder *b, const brio_glb_primitive *p,
                               const uint64_t vertices[2], bool flip);

#endif
