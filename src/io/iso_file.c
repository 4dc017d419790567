/* The iso-surface of a file: finds out whether the file is a map or a list of atoms, and reads it. */
#include "io/ccp4.h"
#include "base/float_state.h"
#include "base/versioned.h"
#include "io/pdb.h"
#include "io/unpack.h"
#include "iso/iso_source.h"
#include <math.h>
#include <string.h>
#include <strings.h>

enum { MAP_WORD = 208 };

/* --- reading --- */

static bool has_extension(const char *path, const char *const *extensions) {
    size_t length = brio_unpacked_length(path);
    for (; *extensions; extensions++) {
        size_t suffix = strlen(*extensions);
        if (length >= suffix && !strncasecmp(path + length - suffix, *extensions, suffix)) return true;
    }
    return false;
}

/* Finds the kind, by content before extension; standard input that is no map is taken for atoms. */
static brio_status find_kind(brio_stream *s, const char *path, bool *is_map) {
    static const char *const maps[] = {".map", ".mrc", ".ccp4", NULL}, *const atoms[] = {".pdb", ".ent", NULL};
    BRIO_FORWARD(brio_stream_fill(s, MAP_WORD + 4));
    bool marked = brio_stream_left(s) >= MAP_WORD + 4 && !memcmp(s->buffer + s->begin + MAP_WORD, "MAP ", 4);
    bool known = marked || !strcmp(path, "-") || has_extension(path, maps) || has_extension(path, atoms);
    BRIO_EXPECT(s->ctx, known, BRIO_BECAUSE(s->ctx, UNKNOWN_FORMAT, BRIO_ERR_FORMAT),
                "%s: unknown format, expected .map .mrc .ccp4 or .pdb .ent", s->name);
    *is_map = marked || has_extension(path, maps);
    return BRIO_OK;
}

static brio_status read_source(brio_context *ctx, const char *path, brio_iso_source *from) {
    brio_status status = BRIO_OK;
    brio_stream s = {.ctx = ctx, .file = -1};
    BRIO_TRY(brio_stream_open(&s, ctx, path));
    BRIO_TRY(find_kind(&s, path, &from->is_map));
    if (from->is_map)
        BRIO_TRY(brio_ccp4_read(&s, &from->volume));
    else
        BRIO_TRY(brio_pdb_read(&s, &from->atoms, &from->num_atoms));
    BRIO_TRY(brio_progress(ctx, "read", 1));
done:
    brio_stream_close(&s);
    return status;
}

static brio_status check_options(brio_context *ctx, double level, const brio_iso_surface_options *o) {
    BRIO_EXPECT(ctx, isfinite(level), BRIO_ERR_ARGUMENT, "level %g: expected a finite number", level);
    BRIO_EXPECT(ctx, !o->resolution || !o->vertices, BRIO_ERR_ARGUMENT,
                "a resolution and a number of vertices: one decides the other");
    return BRIO_OK;
}

brio_status brio_iso_surface(brio_context *ctx, const char *path, double level, const brio_iso_surface_options *options,
                             brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_iso_surface_options o = {0};
    brio_iso_source from = {0};
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_iso_surface_options, options, &o));
    BRIO_TRY(check_options(ctx, level, &o));
    BRIO_TRY(read_source(ctx, path, &from));
    BRIO_REQUIRE(ctx, !from.is_map || o.blobbiness == 0, BRIO_ERR_ARGUMENT,
                 "%s: blobbiness %g: the file is a map, and blobbiness is of atoms", path, o.blobbiness);
    BRIO_TRY(brio_iso_source_surface(ctx, &from, level, &o, out));
done:
    brio_iso_source_free(ctx, &from);
    return status;
}
