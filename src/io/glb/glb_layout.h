/* What a GLB file will hold, and where: planned before anything is written, because the JSON stands in front. */
#ifndef BRIO_IO_GLB_LAYOUT_H
#define BRIO_IO_GLB_LAYOUT_H

#include "io/formats.h"
#include "io/glb/glb_scene.h"

/* Numbers of the vertices: POSITION, or properties. */
typedef struct brio_glb_output {
    char name[BRIO_GLB_NAME];
    int type, components, stride; /* type: BRIO_GLB_INT8 ... ; stride: bytes of a row, a multiple of 4 */
    bool normalized;
    const brio_property *from[4]; /* NULL for POSITION */
    uint64_t offset;              /* in the binary chunk */
} brio_glb_output;

typedef struct brio_glb_layout {
    const brio_mesh *mesh;
    brio_glb_output *outputs;
    size_t num_outputs;
    uint64_t num_triangles, triangles_at, edges_at; /* where their indices begin */
    uint64_t size;                                  /* of the binary chunk */
    double origin[3];                               /* coordinates are stored relative to it */
    float least[3], most[3];                        /* of the stored coordinates */
    double moved;                                   /* the greatest distance between a vertex and its stored place */
    char *json;                                     /* padded to a multiple of 4 */
    size_t json_size;
} brio_glb_layout;

/** Plans the file.   layout  call brio_glb_layout_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (coordinates beyond single precision, or a file of over 4 GiB), BRIO_ERR_NO_MEMORY. */
brio_status brio_glb_layout_make(brio_context *ctx, const char *name, const brio_write_job *job,
                                 brio_glb_layout *layout);
void brio_glb_layout_free(brio_context *ctx, brio_glb_layout *layout);

/** Makes the JSON of a layout. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_glb_json(brio_context *ctx, const char *comment, brio_glb_layout *layout);

#endif
