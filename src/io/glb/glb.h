/* What the parts of the reader of glTF files share: the scene that the JSON describes, and the mesh made of it. */
#ifndef BRIO_IO_GLB_H
#define BRIO_IO_GLB_H

#include "io/builder.h"
#include "io/formats.h"

/* --- the JSON --- */

/* What the JSON of a glTF file says about geometry: buffers, views of them, accessors, the primitives of the meshes,
 * and the nodes that place the meshes. */

#define BRIO_GLB_NONE UINT32_MAX /* no index */

/* Component types of accessors, as glTF numbers them. */
enum {
    BRIO_GLB_INT8 = 5120,
    BRIO_GLB_UINT8 = 5121,
    BRIO_GLB_INT16 = 5122,
    BRIO_GLB_UINT16 = 5123,
    BRIO_GLB_UINT32 = 5125,
    BRIO_GLB_FLOAT = 5126
};

typedef enum {
    BRIO_GLB_POINTS = 0,
    BRIO_GLB_LINES = 1,
    BRIO_GLB_LINE_LOOP = 2,
    BRIO_GLB_LINE_STRIP = 3,
    BRIO_GLB_TRIANGLES = 4,
    BRIO_GLB_TRIANGLE_STRIP = 5,
    BRIO_GLB_TRIANGLE_FAN = 6,
    BRIO_GLB_MODE_END
} brio_glb_mode;

typedef struct brio_glb_buffer {
    uint64_t size; /* as the JSON says */
    char *bytes;   /* decoded from the JSON or read from another file; NULL: the binary chunk */
} brio_glb_buffer;

typedef struct brio_glb_view {
    uint32_t buffer;
    uint64_t offset, size, stride; /* stride 0: elements lie one behind the other */
} brio_glb_view;

typedef struct brio_glb_accessor {
    uint32_t view;
    uint64_t offset, count;
    int type, components; /* type: BRIO_GLB_INT8 ... */
    bool normalized, sparse;
} brio_glb_accessor;

enum { BRIO_GLB_NAME = 72 }; /* bytes of the name of an attribute; the rest is cut off */

typedef struct brio_glb_attribute {
    char name[BRIO_GLB_NAME];
    uint32_t accessor;
} brio_glb_attribute;

typedef struct brio_glb_primitive {
    brio_glb_mode mode;
    uint32_t indices;             /* accessor, or BRIO_GLB_NONE */
    size_t attribute, attributes; /* from and how many */
    bool draco;                   /* compressed by Draco */
    bool targets;                 /* has morph targets */
} brio_glb_primitive;

typedef struct brio_glb_mesh {
    size_t primitive, primitives; /* from and how many */
} brio_glb_mesh;

typedef struct brio_glb_node {
    double matrix[16]; /* column by column */
    uint32_t mesh;     /* or BRIO_GLB_NONE */
    size_t child, children;
} brio_glb_node;

typedef struct brio_glb_scene {
    brio_glb_buffer *buffers;
    brio_glb_view *views;
    brio_glb_accessor *accessors;
    brio_glb_attribute *attributes;
    brio_glb_primitive *primitives;
    brio_glb_mesh *meshes;
    brio_glb_node *nodes;
    uint32_t *children; /* of all nodes */
    uint32_t *roots;    /* nodes of the scene */
    size_t num_buffers, num_views, num_accessors, num_attributes, num_primitives, num_meshes, num_nodes, num_children,
        num_roots;
} brio_glb_scene;

/** Reads the JSON of a file. What the mesh of the builder has no place for is noted there.
 *  on_disk  whether the builder's name is that of a file, beside which others may be.
 *  text     `size` bytes and a 0 behind them.
 *  scene  {0}; call brio_glb_scene_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (the message names the place in the JSON; or brio was built without a library of
 *  JSON), BRIO_ERR_NO_MEMORY. */
brio_status brio_glb_scene_read(brio_builder *b, bool on_disk, const char *text, size_t size, brio_glb_scene *scene);
void brio_glb_scene_free(brio_context *ctx, brio_glb_scene *scene);

/* A file: what its JSON says, and its binary chunk. */
typedef struct brio_glb_file {
    brio_context *ctx;
    const char *name;
    brio_glb_scene scene;
    char *binary; /* NULL: there is none */
    uint64_t binary_size;
    uint64_t bytes; /* of JSON and binary data together */
} brio_glb_file;

/** Adds the meshes of the scene.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_glb_add_scene(const brio_glb_file *file, brio_builder *b);

/** Writes a mesh as GLB. */
brio_status brio_glb_write(brio_output *out, const brio_write_job *job);

#endif
