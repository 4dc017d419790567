/* The formats, each in its own file: readers take a stream and fill a builder, writers put a mesh on an output. */
#ifndef BRIO_IO_FORMATS_H
#define BRIO_IO_FORMATS_H

#include "io/builder.h"
#include "io/output.h"
#include "io/stream.h"

typedef struct brio_write_job {
    const brio_mesh *mesh;
    const brio_write_options *options;
    char (*names)[64]; /* of the properties, made one word each; PLY and XYZ only */
} brio_write_job;

brio_status brio_ply_read(brio_stream *s, brio_builder *b);
brio_status brio_xyz_read(brio_stream *s, brio_builder *b);
brio_status brio_obj_read(brio_stream *s, brio_builder *b);
brio_status brio_off_read(brio_stream *s, brio_builder *b);
brio_status brio_vtu_read(brio_stream *s, brio_builder *b);
brio_status brio_node_read(brio_stream *s, brio_builder *b);
brio_status brio_ele_read(brio_stream *s, brio_builder *b); /* after the .node: its index base is in the builder */

brio_status brio_ply_write(brio_output *out, const brio_write_job *job);
brio_status brio_xyz_write(brio_output *out, const brio_write_job *job);
brio_status brio_obj_write(brio_output *out, const brio_write_job *job);
brio_status brio_off_write(brio_output *out, const brio_write_job *job);
brio_status brio_vtu_write(brio_output *out, const brio_write_job *job);
brio_status brio_vtp_write(brio_output *out, const brio_write_job *job);
brio_status brio_node_write(brio_output *out, const brio_write_job *job);
brio_status brio_ele_write(brio_output *out, const brio_write_job *job);

/** True when the first bytes of a file are those of a PLY, OFF or VTU file. */
bool brio_ply_starts(const char *bytes, size_t size);
bool brio_off_starts(const char *bytes, size_t size);
bool brio_vtu_starts(const char *bytes, size_t size);

/** True for the name of an .ele file, which stands for the pair of .node and .ele. */
bool brio_is_ele(const char *path);
/** The name of the other file of the pair; the caller releases it. */
brio_status brio_sibling(brio_context *ctx, const char *path, const char *extension, char **out);

#endif
