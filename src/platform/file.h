/* Files, pipes and devices, by descriptors. Names are UTF-8 on every system.
 *
 * A call that writes, closes or resizes raises no signal: a pipe without a reader and a limit on the size of files are
 * errors, EPIPE and EFBIG (quiet_signals.h). */
#ifndef BRIO_PLATFORM_FILE_H
#define BRIO_PLATFORM_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* BRIO_PATH_MOST: bytes of the longest path, BRIO_NAME_MOST of the longest name in it, with a 0. */
enum { BRIO_PATH_MOST = 4096, BRIO_NAME_MOST = 1024 };

/** The standard streams. */
enum { BRIO_INPUT, BRIO_OUTPUT, BRIO_MESSAGES };

/* --- what is there --- */

typedef enum {
    BRIO_IS_FILE,
    BRIO_IS_FOLDER,
    BRIO_IS_PIPE,
    BRIO_IS_CHARACTERS, /* a terminal, or another device of bytes */
    BRIO_IS_BLOCKS,     /* a device of blocks */
    BRIO_IS_OTHER
} brio_file_kind;

typedef struct {
    brio_file_kind kind;
    uint64_t volume, number; /* together they are one file's alone */
    uint64_t size;           /* bytes of a regular file */
    int64_t seconds;         /* when it was changed last */
    int64_t nanoseconds;
} brio_place_facts;

/** Return whether a path, through links, or a descriptor leads to something, and find what it is. */
bool brio_find_facts(const char *path, brio_place_facts *facts);
bool brio_find_facts_open(int file, brio_place_facts *facts);

static inline bool brio_is_same_file(const brio_place_facts *a, const brio_place_facts *b) {
    return a->volume == b->volume && a->number == b->number;
}

/** Return whether something of the name is there, may be written, is a folder in which files may be made. */
bool brio_is_there(const char *path);
bool brio_may_write(const char *path);
bool brio_may_make_files(const char *folder);

/** Returns whether a name is that of a symbolic link, whether or not it leads to something. */
bool brio_is_link(const char *path);

/** Returns the bytes of a path's folder, with what separates it from the name; 0 for a name without a folder. */
size_t brio_folder_length(const char *path);

/* --- descriptors --- */

/** Opens a file to read. A pipe is opened at once, without a writer. Returns -1 if it cannot. */
int brio_open_input(const char *path);

/** Opens a pipe or a device to write, where a write may return EAGAIN. A pipe without a reader is the error ENXIO. */
int brio_open_device(const char *path);

/** Opens a file to write behind its end. */
int brio_open_end(const char *path);

/** Returns whether an open descriptor takes bytes; errno is EBADF if not. */
bool brio_is_writable(int file);

/** Return a descriptor's copy; the descriptor's C stream, which owns it then; a C stream's descriptor. */
int brio_copy_descriptor(int file);
FILE *brio_stream_of(int file);
int brio_descriptor_of(FILE *stream);

/** Opens a C stream as fopen does. */
FILE *brio_open_stream(const char *path, const char *mode);

/** Closes a descriptor. Returns false if something was not written; a signal that ends the call is no failure. */
bool brio_close(int file);

/* --- bytes --- */

/** Read or write at most `size` bytes, from where the file stands or at a place that does not move it. Return how many;
 *  a read of 0 is the end; -1 for a failure, also EINTR and EAGAIN. */
int64_t brio_read_bytes(int file, void *bytes, size_t size);
int64_t brio_read_bytes_at(int file, void *bytes, size_t size, uint64_t place);
int64_t brio_write_bytes(int file, const void *bytes, size_t size);
int64_t brio_write_bytes_at(int file, const void *bytes, size_t size, uint64_t place);

/** Returns where a file stands, or -1. */
int64_t brio_place_in(int file);

/** Returns how many bytes a pipe takes at once whenever it takes any. */
size_t brio_pipe_room(void);

/** Waits until a descriptor can be read or written, its other side is gone, or a signal came; at most this long.
 *  Returns whether a read or write will not wait. */
bool brio_wait_ready(int file, bool writes, int milliseconds);

/** Waits. A signal ends it. */
void brio_wait_milliseconds(int milliseconds);

/** Makes the disk take all of a file, and waits. Returns false if it does not. */
bool brio_flush_to_disk(int file);

#endif
