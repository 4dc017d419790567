/* The methods for surfaces, in one table: what each is called, what it is good for, the options that it has, its
 * function, and the memory that it takes. brio_surface, the estimates, the program and the Python module read it.
 *
 * Measured, the samples not included: models take the power crust 1,460 to 1,570 bytes a sample, a raw scan 1,590, its
 * offsets 1,240, the co-cones 540 to 640. The labeled triangulation takes a raw scan of a million samples 993 bytes a
 * sample, simulated scans of 60,000 and 20,000 samples 1,063 and 1,213. */
#include "reconstruct/surface/method.h"
#include <math.h>
#include <string.h>

brio_method_fn brio_labeled_delaunay, brio_power_crust, brio_cocone, brio_offset_surface;

enum {
    LABELED_BYTES = 1110,
    CRUST_BYTES = 1426,
    OFFSET_BYTES = 1300,
    COCONE_BYTES = 616,
    EXPLANATION_BYTES = 700
};                               /* a point */
enum { EXPLAINED_BYTES = 4096 }; /* an explained sample */

/* Adds what triangles and a simplification take to the bytes of a crust's balls and faces. Triangles: a scan of 20,000
 * points 210 bytes a point, bunny 350. Simplified: knot2 2,080, bunny 2,150, fandisk 2,200. */
static double crust_bytes(double each, double points, const brio_surface_options *o) {
    return (each + (o->polygons ? 0 : 300) + (o->simplify ? 2150 : 0)) * points;
}

static double power_crust_bytes(double points, const brio_surface_options *o) {
    return crust_bytes(CRUST_BYTES, points, o);
}

static double offset_bytes(double points, const brio_surface_options *o) {
    return crust_bytes(OFFSET_BYTES, points, o);
}

/* Returns the estimate of the co-cones. The super co-cone keeps the points and the triangles of all pieces, and works
 * on one piece of up to twice the mean size. Measured on scans of 60,000 and 200,000 points in 3 to 154 pieces, with
 * one thread. */
static double cocone_bytes(double points, const brio_surface_options *o) {
    static const double KEPT_A_POINT = 210, A_PIECE = 180e3;
    double whole = COCONE_BYTES * points, pieces = (double)o->pieces;
    return pieces < 2 ? whole : fmin(whole, KEPT_A_POINT * points + whole * 2 / pieces) + A_PIECE * pieces;
}

#define METHOD(name) sizeof(brio_surface_method_info), BRIO_SURFACE_##name
#define POLES        " poles.labeling poles.sharp poles.sampling_density poles.solid"

static const brio_method_row table[] = {
    [BRIO_SURFACE_LABELED] =
        {{METHOD(LABELED), "labeled-delaunay",
          "also from noisy points; open where they end (--closed: closed); the one that is right most often",
          "noise evidence normals open holes simplify confidence explanation tiles", BRIO_METHOD_MAY_END},
         "BRIO_SURFACE_LABELED",
         brio_labeled_delaunay,
         .bytes_a_point = LABELED_BYTES},
    [BRIO_SURFACE_POWER_CRUST] = {{METHOD(POWER_CRUST), "power-crust",
                                   "closed; sharp edges without points on them (--sharp)",
                                   "noise normals open holes simplify polygons explanation" POLES,
                                   BRIO_METHOD_OWN_VERTICES},
                                  "BRIO_SURFACE_POWER_CRUST",
                                  brio_power_crust,
                                  .bytes_a_point = CRUST_BYTES,
                                  .bytes = power_crust_bytes},
    [BRIO_SURFACE_COCONE] = {{METHOD(COCONE), "cocone", "the points are the vertices; open where they end",
                              "evidence normals theta boundaries density pieces explanation",
                              BRIO_METHOD_ALL_POINTS | BRIO_METHOD_MAY_END},
                             "BRIO_SURFACE_COCONE",
                             brio_cocone,
                             .bytes_a_point = COCONE_BYTES,
                             .bytes = cocone_bytes},
    [BRIO_SURFACE_TIGHT_COCONE] = {{METHOD(TIGHT_COCONE), "tight-cocone", "the points are the vertices; closed",
                                    "evidence normals holes theta boundaries density explanation",
                                    BRIO_METHOD_ALL_POINTS},
                                   "BRIO_SURFACE_TIGHT_COCONE",
                                   brio_cocone,
                                   .bytes_a_point = COCONE_BYTES,
                                   .bytes = cocone_bytes},
    [BRIO_SURFACE_OFFSET] = {{METHOD(OFFSET), "offset", "the power crust, moved outwards or inwards",
                              "noise holes simplify polygons distance" POLES,
                              BRIO_METHOD_OWN_VERTICES | BRIO_METHOD_AT_DISTANCE},
                             "BRIO_SURFACE_OFFSET",
                             brio_offset_surface,
                             .bytes_a_point = OFFSET_BYTES,
                             .bytes = offset_bytes},
};
_Static_assert(sizeof table / sizeof *table == BRIO_SURFACE_END, "a row for each method");

const brio_method_row *brio_method_row_of(brio_surface_method method) {
    return (unsigned)method < BRIO_SURFACE_END ? &table[method] : NULL;
}

const brio_surface_method_info *brio_surface_method_facts(brio_surface_method method) {
    const brio_method_row *row = brio_method_row_of(method);
    return row ? &row->info : NULL;
}

int brio_surface_method_has(brio_surface_method method, const char *option) {
    const brio_surface_method_info *info = brio_surface_method_facts(method);
    size_t length = strlen(option);
    for (const char *at = info ? info->options : NULL; at && (at = strstr(at, option)); at += length)
        if ((at == info->options || at[-1] == ' ') && (!at[length] || at[length] == ' ')) return 1;
    return 0;
}

double brio_method_bytes(const brio_method_row *row, double points, const brio_surface_options *options) {
    double bytes = row->bytes ? row->bytes(points, options) : row->bytes_a_point * points;
    if (!options || !options->explanation) return bytes;
    double most = (double)(options->explained ? options->explained : BRIO_MOST_EXPLAINED);
    return bytes + EXPLANATION_BYTES * points + EXPLAINED_BYTES * fmin(points, most);
}
