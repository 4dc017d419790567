/* The iso-surface of a file: finds out whether the file is a map or a list of atoms, reads it, and makes the surface.
 *
 * For a wanted number of vertices, the resolution is found by trial. The number of vertices grows about with the square
 * of the resolution, so a few rounds suffice; finer cells also show more detail. */
#include "io/ccp4.h"
#include "base/float_state.h"
#include "base/versioned.h"
#include "io/pdb.h"
#include <math.h>
#include <string.h>
#include <strings.h>

/* MAP_WORD: byte offset of "MAP " in the header of a map. The others are chosen. */
enum { MAP_WORD = 208, FIRST_RESOLUTION = 100, MOST_RESOLUTION = 1 << 15, MOST_ROUNDS = 5 };

static const double CLOSE_ENOUGH = 0.02; /* share of the wanted number of vertices; chosen */

typedef enum { SOURCE_MAP, SOURCE_ATOMS } source_kind;

/* The source of the surface: a volume, or atoms. */
typedef struct {
    source_kind kind;
    brio_volume volume;
    brio_atom *atoms;
    size_t num_atoms;
} source;

static const brio_iso_options STANDARD = {.size = sizeof STANDARD, .level = 1, .blobbiness = 2};

BRIO_OPTIONS_INIT(brio_iso_options)

/* --- reading --- */

static bool has_extension(const char *path, const char *const *extensions) {
    const char *dot = strrchr(path, '.');
    for (; dot && *extensions; extensions++)
        if (!strcasecmp(dot, *extensions)) return true;
    return false;
}

/* Finds the kind of a source by its content or, failing that, its extension. Standard input that is no map is read as
 * atoms. */
static brio_status find_kind(brio_stream *s, const char *path, source_kind *kind) {
    static const char *const maps[] = {".map", ".mrc", ".ccp4", NULL}, *const atoms[] = {".pdb", ".ent", NULL};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_stream_fill(s, MAP_WORD + 4));
    bool is_map = brio_stream_left(s) >= MAP_WORD + 4 && !memcmp(s->buffer + s->begin + MAP_WORD, "MAP ", 4);
    bool known = is_map || !strcmp(path, "-") || has_extension(path, maps) || has_extension(path, atoms);
    BRIO_REQUIRE(s->ctx, known, BRIO_ERR_FORMAT, "%s: unknown format, expected .map .mrc .ccp4 or .pdb .ent", s->name);
    *kind = is_map || has_extension(path, maps) ? SOURCE_MAP : SOURCE_ATOMS;
done:
    return status;
}

static brio_status read_source(brio_context *ctx, const char *path, source *from) {
    brio_status status = BRIO_OK;
    brio_stream s = {.ctx = ctx, .file = -1};
    BRIO_TRY(brio_stream_open(&s, ctx, path));
    BRIO_TRY(find_kind(&s, path, &from->kind));
    if (from->kind == SOURCE_MAP)
        BRIO_TRY(brio_ccp4_read(&s, &from->volume));
    else
        BRIO_TRY(brio_pdb_read(&s, &from->atoms, &from->num_atoms));
    BRIO_TRY(brio_progress(ctx, "read", 1));
done:
    brio_stream_close(&s);
    return status;
}

/* --- surface --- */

static brio_status make_surface(brio_context *ctx, const source *from, const brio_iso_options *o, size_t resolution,
                                brio_mesh **out) {
    brio_status status = BRIO_OK;
    if (from->kind == SOURCE_MAP)
        BRIO_TRY(brio_volume_surface(ctx, &from->volume, o->level, resolution, o->conforming, out));
    else
        BRIO_TRY(brio_density_surface(ctx, from->atoms, from->num_atoms,
                                      &(brio_density_options){o->level, o->blobbiness, resolution, o->conforming},
                                      out));
    if ((*out)->num_faces) return BRIO_OK;
    brio_mesh_free(*out);
    *out = NULL;
    status = brio_fail(ctx, BRIO_ERR_NO_ANSWER, "nothing is above the level %g", o->level);
done:
    return status;
}

/* Returns the resolution to try next. Assumes that the number of vertices grows with a power of the resolution: 2 at
 * first, then the power that the last two tries show. */
static size_t next_resolution(double wanted, const double resolution[2], const double vertices[2]) {
    double power = 2;
    if (resolution[0] > 0 && resolution[0] != resolution[1])
        power = log(vertices[1] / vertices[0]) / log(resolution[1] / resolution[0]);
    double next = resolution[1] * pow(wanted / vertices[1], 1 / fmin(fmax(power, 1), 4));
    return (size_t)fmin(fmax(rint(next), 2), MOST_RESOLUTION);
}

/* Tries resolutions until the number of vertices is about the wanted one. The surface of the last try is the result. */
static brio_status make_surface_of_size(brio_context *ctx, const source *from, const brio_iso_options *o,
                                        brio_mesh **out) {
    brio_status status = BRIO_OK;
    double wanted = (double)o->vertices, tried[2] = {0, FIRST_RESOLUTION}, vertices[2] = {0, 0};
    for (int round = 0; round < MOST_ROUNDS; round++) {
        brio_mesh_free(*out);
        *out = NULL;
        BRIO_TRY(make_surface(ctx, from, o, (size_t)tried[1], out));
        vertices[1] = (double)(*out)->num_vertices;
        size_t next = next_resolution(wanted, tried, vertices);
        if (fabs(vertices[1] / wanted - 1) < CLOSE_ENOUGH || (double)next == tried[1]) break;
        tried[0] = tried[1];
        vertices[0] = vertices[1];
        tried[1] = (double)next;
    }
done:
    return status;
}

static brio_status check_options(brio_context *ctx, const brio_iso_options *o) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, isfinite(o->level), BRIO_ERR_ARGUMENT, "level %g: expected a finite number", o->level);
    BRIO_REQUIRE(ctx, !o->resolution || !o->vertices, BRIO_ERR_ARGUMENT,
                 "a resolution and a number of vertices: one decides the other");
done:
    return status;
}

/* Converts a level in standard deviations to the unit of the map. */
static brio_status settle_level(brio_context *ctx, const source *from, brio_iso_options *o) {
    brio_status status = BRIO_OK;
    double mean, deviation;
    if (!o->deviations) return BRIO_OK;
    BRIO_REQUIRE(ctx, from->kind == SOURCE_MAP, BRIO_ERR_ARGUMENT,
                 "a level in standard deviations is for maps: the density of atoms has no mean");
    brio_volume_statistics(&from->volume, &mean, &deviation);
    o->level = mean + o->level * deviation;
    o->deviations = 0;
done:
    return status;
}

brio_status brio_iso_surface(brio_context *ctx, const char *path, const brio_iso_options *options, brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_iso_options o = STANDARD;
    source from = {0};
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_iso_options, options, &o));
    BRIO_TRY(check_options(ctx, &o));
    BRIO_TRY(read_source(ctx, path, &from));
    BRIO_TRY(settle_level(ctx, &from, &o));
    BRIO_TRY(o.vertices ? make_surface_of_size(ctx, &from, &o, out) : make_surface(ctx, &from, &o, o.resolution, out));
done:
    brio_volume_free(ctx, &from.volume);
    brio_release(ctx, from.atoms);
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
    }
    return status;
}
