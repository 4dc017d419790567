/* How much is read, written and handed on at once. All chosen; builds for tests have less, so that small files have
 * several blocks, and a fault can come between any two parts of them. */
#ifndef BRIO_IO_BLOCKS_H
#define BRIO_IO_BLOCKS_H

/** Bytes of the buffers of files. A printed number must fit. */
#ifndef BRIO_IO_BLOCK
#define BRIO_IO_BLOCK (1 << 20)
#endif

/** Vertices that a reader hands on at once, at most, unless it adds more at once. */
#ifndef BRIO_BLOCK_ROWS
#define BRIO_BLOCK_ROWS (1 << 16)
#endif

#endif
