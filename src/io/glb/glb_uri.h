/* Buffers of a glTF file that are in other files. */
#ifndef BRIO_IO_GLB_URI_H
#define BRIO_IO_GLB_URI_H

#include "io/glb/glb_scene.h"

/** Reads the file that a buffer names, whole. The name is a relative URI: it may be in a folder below that of the glTF file,
 *  and nowhere else.
 *  path     of the glTF file, for messages, too.   on_disk  whether it is a file with a folder.
 *  number   of the buffer, for messages.
 *  buffer   its size is what the JSON says; receives the bytes.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_glb_load(brio_context *ctx, const char *path, bool on_disk, const char *uri, size_t number,
                          brio_glb_buffer *buffer);

#endif
