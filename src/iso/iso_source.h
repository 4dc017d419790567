/* The iso-surface of a density from either source. */
#ifndef BRIO_ISO_ISO_SOURCE_H
#define BRIO_ISO_ISO_SOURCE_H

#include "iso/density.h"
#include "iso/volume.h"

/** The source of a density: a map of values, or atoms. */
typedef struct {
    bool is_map;
    brio_volume volume; /* when is_map */
    brio_atom *atoms;   /* when not is_map */
    size_t num_atoms;
} brio_iso_source;

/** Makes the surface that the options describe. A wanted number of vertices is met as closely as a few tries allow.
 *  out  NULL on failure.   Returns BRIO_OK, BRIO_ERR_NO_ANSWER (nothing is above the level), BRIO_ERR_ARGUMENT (a
 *  level in deviations with atoms), or an error of brio_volume_surface or brio_density_surface. */
brio_status brio_iso_source_surface(brio_context *ctx, const brio_iso_source *source, double level,
                                    const brio_iso_surface_options *options, brio_mesh **out);

void brio_iso_source_free(brio_context *ctx, brio_iso_source *source);

#endif
