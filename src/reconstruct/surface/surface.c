/* A surface through points: the methods, which options each of them has, and one call for all.
 *
 * A method is a row of METHODS and a function that fills a mesh: from options whose defaults are filled in and that are
 * all its own. It adds the property "sample" and, where options.normals asks for them, writes the normals of the
 * points. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/versioned.h"
#include "order/canonical_points.h"
#include "reconstruct/cocone/cocone.h"
#include "reconstruct/labeled_delaunay/labeled_delaunay.h"
#include "reconstruct/power_crust/power_crust.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef brio_status method_fn(brio_context *ctx, const double *points, size_t num_points,
                              const brio_surface_options *options, brio_mesh *mesh, brio_surface_stats *stats);

static const struct {
    const char *name;
    method_fn *make;
} METHODS[] = {
    [BRIO_SURFACE_LABELED] = {"BRIO_SURFACE_LABELED", brio_labeled_delaunay},
    [BRIO_SURFACE_POWER_CRUST] = {"BRIO_SURFACE_POWER_CRUST", brio_power_crust},
    [BRIO_SURFACE_COCONE] = {"BRIO_SURFACE_COCONE", brio_cocone},
    [BRIO_SURFACE_TIGHT_COCONE] = {"BRIO_SURFACE_TIGHT_COCONE", brio_cocone},
    [BRIO_SURFACE_OFFSET] = {"BRIO_SURFACE_OFFSET", brio_offset_surface},
};
_Static_assert(sizeof METHODS / sizeof *METHODS == BRIO_SURFACE_END, "a row for each method");

/* Sets of methods. */
enum {
    LABELED = 1 << BRIO_SURFACE_LABELED,
    CRUST = 1 << BRIO_SURFACE_POWER_CRUST,
    COCONE = 1 << BRIO_SURFACE_COCONE,
    COCONES = COCONE | 1 << BRIO_SURFACE_TIGHT_COCONE,
    OFFSET = 1 << BRIO_SURFACE_OFFSET
};

/* An option, whether it is set, and the methods that have it. */
typedef struct {
    const char *name;
    bool set;
    unsigned methods;
} option_use;

/* Writes the names of the methods of a set, with commas between. */
static void list_methods(unsigned set, char *text, size_t room) {
    size_t used = 0;
    text[0] = 0;
    for (int m = 0; m < BRIO_SURFACE_END; m++)
        if (set >> m & 1 && used < room)
            used += (size_t)snprintf(text + used, room - used, "%s%s", used ? ", " : "", METHODS[m].name);
}

/* Options of another method are a mistake. */
static brio_status check_uses(brio_context *ctx, const brio_surface_options *o) {
    const option_use uses[] = {{"noise", o->noise == BRIO_NOISE_SMOOTH, LABELED | CRUST | OFFSET},
                               {"evidence", o->evidence != NULL, LABELED | COCONES},
                               {"normals", o->normals != NULL, LABELED | CRUST | COCONES},
                               {"open", o->open != 0, LABELED | CRUST},
                               {"holes", o->holes == BRIO_HOLES_CLOSED, LABELED | CRUST | OFFSET | (COCONES ^ COCONE)},
                               {"simplify", o->simplify != 0, LABELED | CRUST | OFFSET},
                               {"confidence", o->confidence != 0, LABELED},
                               {"polygons", o->polygons != 0, CRUST | OFFSET},
                               {"distance", o->distance != 0, OFFSET},
                               {"poles.labeling", o->poles.labeling != 0, CRUST | OFFSET},
                               {"poles.sharp", o->poles.sharp != 0, CRUST | OFFSET},
                               {"poles.sampling_density", o->poles.sampling_density != 0, CRUST | OFFSET},
                               {"poles.solid", o->poles.solid != NULL, CRUST | OFFSET},
                               {"theta", o->theta != 0, COCONES},
                               {"boundaries", o->boundaries != 0, COCONES},
                               {"density", o->density != 0, COCONES},
                               {"pieces", o->pieces > 1, COCONE},
                               {"extraction", o->extraction != 0, COCONE}};
    for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
        char names[160];
        if (!uses[i].set || uses[i].methods >> o->method & 1) continue;
        list_methods(uses[i].methods, names, sizeof names);
        return brio_fail(ctx, BRIO_ERR_ARGUMENT, "%s is an option of %s, and the method is %s", uses[i].name, names,
                         METHODS[o->method].name);
    }
    return BRIO_OK;
}

/* Takes the options and fills in the defaults that all methods share. */
static brio_status settle(brio_context *ctx, const brio_surface_options *options, brio_surface_options *o) {
    *o = (brio_surface_options){0};
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_surface_options, options, o));
    BRIO_EXPECT(ctx, (unsigned)o->method < BRIO_SURFACE_END, BRIO_ERR_ARGUMENT, "no such method: %d", (int)o->method);
    BRIO_EXPECT(ctx, (unsigned)o->noise < BRIO_NOISE_END, BRIO_ERR_ARGUMENT, "no such way with noise: %d",
                (int)o->noise);
    BRIO_EXPECT(ctx, (unsigned)o->holes < BRIO_HOLES_END, BRIO_ERR_ARGUMENT, "no such way with holes: %d",
                (int)o->holes);
    BRIO_EXPECT(ctx, !o->reserved_int, BRIO_ERR_ARGUMENT, "brio_surface_options.reserved_int is not 0");
    BRIO_FORWARD(check_uses(ctx, o));
    BRIO_EXPECT(ctx, o->open >= 0 && o->open < INFINITY, BRIO_ERR_ARGUMENT,
                "open: %g spacings, expected a finite number, 0 or more", o->open);
    BRIO_EXPECT(ctx, !o->polygons || !o->simplify, BRIO_ERR_ARGUMENT,
                "a simplified surface has triangles, no polygons");
    if (!o->seed) o->seed = BRIO_SEED;
    return BRIO_OK;
}

brio_status brio_surface(brio_context *ctx, const double *points, size_t num_points,
                         const brio_surface_options *options, brio_mesh **out, brio_surface_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_surface_options o;
    brio_surface_stats s = {0};
    brio_mesh *mesh = NULL;
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_surface_stats, stats));
    BRIO_TRY(settle(ctx, options, &o));
    BRIO_TRY(brio_refuse_points(ctx, points, num_points)); /* before anything is read by their number */
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(METHODS[o.method].make(ctx, points, num_points, &o, mesh, &s));
    *out = mesh;
    mesh = NULL;
done:
    BRIO_GIVE(brio_surface_stats, stats, &s);
    brio_mesh_free(mesh);
    return status;
}
