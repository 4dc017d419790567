/* The iso-surface of a density.
 *
 * Finds the resolution for a wanted number of vertices by trial. The number of vertices grows about with the square of
 * the resolution, except for details that finer cells reveal; so a few rounds suffice. */
#include "iso/iso_source.h"
#include <float.h>
#include <math.h>

enum { FIRST_RESOLUTION = 100, MOST_RESOLUTION = 1 << 15, MOST_ROUNDS = 5 };

static const double CLOSE_ENOUGH = 0.02; /* share of the wanted number of vertices; chosen */
static const double BLOBBINESS = 2;      /* that 0 stands for; chosen */

/* Refuses a level over all values. Those of atoms are not all known. */
static brio_status nothing_above(brio_context *ctx, const brio_iso_source *from, double level) {
    if (!from->is_map) return brio_fail(ctx, BRIO_ERR_NO_ANSWER, "nothing is above the level %g", level);
    const brio_volume *v = &from->volume;
    size_t count = (size_t)v->size[0] * v->size[1] * v->size[2];
    float largest = v->values[0];
    for (size_t i = 1; i < count; i++)
        if (v->values[i] > largest) largest = v->values[i];
    return brio_fail(ctx, BRIO_ERR_NO_ANSWER, "nothing is above the level %g: the largest value of the map is %g",
                     level, (double)largest);
}

static brio_status make_surface(brio_context *ctx, const brio_iso_source *from, double level,
                                const brio_iso_surface_options *o, size_t resolution, brio_mesh **out) {
    brio_status status = BRIO_OK;
    if (from->is_map)
        BRIO_TRY(brio_volume_surface(ctx, &from->volume, level, resolution, o->conforming, out));
    else
        BRIO_TRY(brio_density_surface(ctx, from->atoms, from->num_atoms,
                                      &(brio_density_options){level, o->blobbiness, resolution, o->conforming}, out));
    if ((*out)->num_faces) return BRIO_OK;
    brio_mesh_free(*out);
    *out = NULL;
    status = nothing_above(ctx, from, level);
done:
    return status;
}

/* Returns the resolution to try next, if the number of vertices grows with a power of the resolution. The power is 2
 * at first, then the power that the last two tries give. */
static size_t next_resolution(double wanted, const double resolution[2], const double vertices[2]) {
    double power = 2;
    if (resolution[0] > 0 && resolution[0] != resolution[1])
        power = log(vertices[1] / vertices[0]) / log(resolution[1] / resolution[0]);
    double next = resolution[1] * pow(wanted / vertices[1], 1 / fmin(fmax(power, 1), 4));
    return (size_t)fmin(fmax(rint(next), 2), MOST_RESOLUTION);
}

/* Tries resolutions until the number of vertices is close to the wanted one; keeps the last try. */
static brio_status make_surface_of_size(brio_context *ctx, const brio_iso_source *from, double level,
                                        const brio_iso_surface_options *o, brio_mesh **out) {
    double wanted = (double)o->vertices, tried[2] = {0, FIRST_RESOLUTION}, vertices[2] = {0, 0};
    for (int round = 0; round < MOST_ROUNDS; round++) {
        brio_mesh_free(*out);
        *out = NULL;
        BRIO_FORWARD(make_surface(ctx, from, level, o, (size_t)tried[1], out));
        vertices[1] = (double)(*out)->num_vertices;
        size_t next = next_resolution(wanted, tried, vertices);
        if (fabs(vertices[1] / wanted - 1) < CLOSE_ENOUGH || (double)next == tried[1]) break;
        tried[0] = tried[1];
        vertices[0] = vertices[1];
        tried[1] = (double)next;
    }
    return BRIO_OK;
}

/* Converts a level in standard deviations to the map's unit. Rounds another level of a map as its values are, to single
 * precision: a level of 0.7 is then equal to values of 0.7. */
static brio_status settle_level(brio_context *ctx, const brio_iso_source *from, int deviations, double *level) {
    double mean, deviation;
    if (!deviations) {
        if (from->is_map && fabs(*level) <= (double)FLT_MAX) *level = (double)(float)*level;
        return BRIO_OK;
    }
    BRIO_EXPECT(ctx, from->is_map, BRIO_ERR_ARGUMENT,
                "a level in standard deviations is for maps: the density of atoms has no mean");
    brio_volume_statistics(&from->volume, &mean, &deviation);
    *level = mean + *level * deviation;
    return BRIO_OK;
}

brio_status brio_iso_source_surface(brio_context *ctx, const brio_iso_source *from, double level,
                                    const brio_iso_surface_options *options, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_iso_surface_options o = *options;
    *out = NULL;
    if (o.blobbiness == 0) o.blobbiness = BLOBBINESS;
    BRIO_TRY(settle_level(ctx, from, o.deviations, &level));
    BRIO_TRY(o.vertices ? make_surface_of_size(ctx, from, level, &o, out)
                        : make_surface(ctx, from, level, &o, o.resolution, out));
done:
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
    }
    return status;
}

void brio_iso_source_free(brio_context *ctx, brio_iso_source *source) {
    brio_volume_free(ctx, &source->volume);
    brio_release(ctx, source->atoms);
    *source = (brio_iso_source){0};
}
