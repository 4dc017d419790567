/* Reads buffers of a glTF file that are in other files.
 *
 * A file that is read must not be able to name any file of the machine, so a URI has no scheme, begins with no slash, and
 * never goes up to the parent folder. What is behind the name must be a regular file.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. Berners-Lee, Fielding, Masinter. Uniform
 * Resource Identifier (URI): generic syntax. RFC 3986, 2005. */
#include "io/glb/glb_uri.h"
#include "base/memory.h"
#include "io/textrow.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PART = 1 << 20 }; /* bytes read at a time; chosen */

/* --- the name --- */

static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Decodes %20 and the like in place. A percent sign that begins no such thing stays: exporters forget to write %25. */
static bool decode(char *text) {
    char *to = text;
    for (const char *from = text; *from; from++) {
        int high = *from == '%' ? digit(from[1]) : -1, low = high >= 0 ? digit(from[2]) : -1;
        *to = low >= 0 ? (char)(16 * high + low) : *from;
        if (!*to++) return false;
        if (low >= 0) from += 2;
    }
    *to = 0;
    return true;
}

/* Returns whether a name stays in its folder and those below. */
static bool stays(const char *name) {
    if (!*name || *name == '/' || strchr(name, '\\')) return false;
    for (const char *part = name; part; part = strchr(part, '/')) {
        part += *part == '/';
        size_t length = strcspn(part, "/");
        if (length == 2 && part[0] == '.' && part[1] == '.') return false;
    }
    return true;
}

/* Makes the path of the file.   out  owned by the caller (brio_release), on failure too. */
static brio_status make_path(brio_context *ctx, const char *path, const char *uri, size_t number, char **out) {
    brio_status status = BRIO_OK;
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash + 1 - path) : 0, length = strlen(uri);
    bool scheme = memchr(uri, ':', strcspn(uri, "/%")) != NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, *out, folder + length + 1));
    memcpy(*out, path, folder);
    memcpy(*out + folder, uri, length + 1);
    BRIO_REQUIRE(ctx, !scheme && decode(*out + folder) && stays(*out + folder), BRIO_ERR_FORMAT,
                 "%s: buffers[%zu] is in %s: expected a file in the folder of the glTF file, or below it", path, number,
                 brio_excerpt_of(uri).text);
done:
    return status;
}

/* --- the bytes --- */

static brio_status read_all(brio_context *ctx, int file, const char *name, char *bytes, uint64_t size) {
    brio_status status = BRIO_OK;
    for (uint64_t at = 0; at < size;) {
        size_t want = size - at < PART ? (size_t)(size - at) : PART;
        BRIO_TRY(brio_progress(ctx, "read", 0));
        ssize_t got = read(file, bytes + at, want);
        if (got < 0 && errno == EINTR) continue;
        BRIO_REQUIRE(ctx, got > 0, BRIO_ERR_OPEN, "%s: %s", name, got ? strerror(errno) : "ends while it is read");
        at += (uint64_t)got;
    }
done:
    return status;
}

brio_status brio_glb_load(brio_context *ctx, const char *path, bool on_disk, const char *uri, size_t number,
                          brio_glb_buffer *buffer) {
    brio_status status = BRIO_OK;
    char *name = NULL;
    int file = -1;
    struct stat facts;
    BRIO_REQUIRE(ctx, on_disk, BRIO_ERR_FORMAT,
                 "%s: buffers[%zu] is in another file, %s, which is only found beside a file: expected a .glb, which "
                 "holds its data, or data in the JSON",
                 path, number, brio_excerpt_of(uri).text);
    BRIO_TRY(make_path(ctx, path, uri, number, &name));
    file = open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    BRIO_REQUIRE(ctx, file >= 0 && !fstat(file, &facts), BRIO_ERR_OPEN, "%s: buffers[%zu] is in %s: %s", path, number,
                 name, strerror(errno));
    BRIO_REQUIRE(ctx, S_ISREG(facts.st_mode), BRIO_ERR_FORMAT, "%s: buffers[%zu] is in %s, which is no regular file",
                 path, number, name);
    BRIO_REQUIRE(ctx, (uint64_t)facts.st_size >= buffer->size, BRIO_ERR_FORMAT,
                 "%s: buffers[%zu] has %" PRIu64 " bytes, the file %s has %" PRIu64, path, number, buffer->size, name,
                 (uint64_t)facts.st_size);
    BRIO_TRY(BRIO_ALLOC(ctx, buffer->bytes, buffer->size));
    BRIO_TRY(read_all(ctx, file, name, buffer->bytes, buffer->size));
done:
    if (file >= 0) close(file);
    brio_release(ctx, name);
    return status;
}
