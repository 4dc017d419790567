/* brio/surface.h: a surface through points.
 *
 *     brio_mesh *surface;
 *     status = brio_surface(ctx, points, num_points, NULL, &surface, NULL);
 *
 * There are five methods, of one call, one struct of options, one result and one struct of statistics. The default is
 * the one that is right most often; docs/which-method.md tells when another one is better. The result of every method
 * is the same for every order of the points and every number of threads.
 */
#ifndef BRIO_SURFACE_H
#define BRIO_SURFACE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_surface_options brio_surface_options;
typedef struct brio_surface_stats brio_surface_stats;
typedef struct brio_explanation brio_explanation; /* explanation.h */

/** Makes a surface through points.
 *  points   #P by 3.   options  NULL for the defaults.
 *  stats    NULL, or receives what was found, also before a failure.
 *  out      owned by the caller: triangles, counterclockwise seen from outside. Methods go by the ends of their names
 *           here. The property "sample" (int32; float64 from 2^31 points on) of a vertex is the index of its point, by
 *           which brio_mesh_carry_properties gives it the properties of that point; -1 for all vertices of POWER_CRUST
 *           and OFFSET, which are no points. A vertex has the position of its point, unless points were smoothed or
 *           edges collapsed (`simplify`); the vertex that two became keeps the point of one of them.
 *           LABELED: vertices in the order of their points. Faces have the property "bridge" (uint8): 1 for those that
 *           span gaps of the points. With `confidence` vertices have "confidence" (float32), the probability that the
 *           surface is right there: a logistic regression on the votes round the vertex, measured on generated solids;
 *           vertices under 0.7 are guesses (docs/algorithms.md tells how often those of real models were wrong). Faces
 *           have theirs, fitted to simulated scans. COCONE, TIGHT_COCONE: vertex v is point v, also where no face uses
 *           it. `density` adds "feature_size", the distance to the nearest pole, "r", an estimate of the sampling
 *           density, 0 at a point on no face, and with `boundaries` "boundary", 1 at a boundary point.
 *           POWER_CRUST, OFFSET: vertices that only rounding keeps apart from a point are at the point, and the faces
 *           between them have no area.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, no triangle found, all of the surface spans holes, an inward
 *  offset leaves nothing, or doubles cannot hold a vertex), and what brio_delaunay returns. */
BRIO_API brio_status brio_surface(brio_context *ctx, const double *points, size_t num_points,
                                  const brio_surface_options *options, brio_mesh **out, brio_surface_stats *stats);

/** The methods of brio_surface. A mesh is "manifold" if each edge has one or two faces and the faces at each vertex
 *  form one fan, "oriented" if neighbouring faces are seen counterclockwise from the same side, and "closed" if each
 *  edge has two faces. These hold for the connections of the mesh, whatever its coordinates are: faces may still cross
 *  each other where points are too few (brio_mesh_self_intersections counts the pairs). */
typedef enum brio_surface_method {
    /* The labeled Delaunay triangulation: the boundary between tetrahedra that are labeled inner and outer. A point
     * votes on the sides of the tetrahedra in its Voronoi cell, and the labels are those of least votes against them
     * and least area. Also for noisy points, and for points that show a part of a surface. The vertices are the points
     * that the surface uses. Always manifold and oriented; with BRIO_HOLES_CLOSED closed.
     * Cost: one triangulation, and the labels, about as long; about 1,000 bytes a point at the peak.
     * Based on: [Labatut Pons Keriven 2009], [Dey Goswami 2003], [Amenta Bern 1999]. */
    BRIO_SURFACE_LABELED = 0,
    /* The power crust. The poles of a point are the vertices of its Voronoi cell that are farthest from it on either
     * side of the surface; a polar ball is the empty ball round a pole. The crust is what separates the inner from the
     * outer balls. Closed (unless `open` is set), manifold and oriented, for sharp edges without points on them. On a
     * dense sample of a smooth closed surface it is close to it, and has its topology. Its vertices are not the points.
     * Cost: two triangulations, of the points and of about twice as many poles; 1,300 to 1,700 bytes a point at the
     * peak. Based on: [Amenta Choi Kolluri 2001], [Choi 2003] sections 3.3 and 5. */
    BRIO_SURFACE_POWER_CRUST = 1,
    /* The co-cone: Delaunay triangles that lie along the surface at all their corners. Manifold and oriented; with
     * `boundaries` open where the points end. The vertices are all points, in their order. On an r-sample with r <= 0.08
     * the surface's topology is that of the sampled one: proven for the walk of laboratory.h, tested for this method.
     * Cost: one triangulation, and about 50 bytes a tetrahedron; with `pieces` the memory of one piece, and 60 bytes a
     * point. Based on: [Amenta Choi Dey Leekha 2000], [Choi 2003] section 3.2 and appendix A, [Dey Giesen 2001],
     *           [Dey Giesen Hudson 2001]. */
    BRIO_SURFACE_COCONE = 2,
    /* The tight co-cone: the same, closed. Based on: [Dey Goswami 2003]. */
    BRIO_SURFACE_TIGHT_COCONE = 3,
    /* The power crust, moved outwards by `distance`, or inwards if that is negative. Parts that meet are merged, and
     * parts that are too thin vanish. Its error is that of the polar balls; of a mesh, brio_mesh_offset has a proven
     * one. Based on: [Choi 2003] section 3.3.4. */
    BRIO_SURFACE_OFFSET = 4,
    BRIO_SURFACE_END
} brio_surface_method;

/** What holds for every surface of a method, as bits of brio_surface_method_info.traits. */
enum {
    BRIO_METHOD_ALL_POINTS = 1,   /* vertex v is point v */
    BRIO_METHOD_OWN_VERTICES = 2, /* no vertex is a point */
    BRIO_METHOD_MAY_END = 4,      /* it ends where the points do, unless `holes` closes it */
    BRIO_METHOD_AT_DISTANCE = 8   /* it is not through the points, but at `distance` from them */
};

/** What is known of a method. */
typedef struct brio_surface_method_info {
    size_t size; /* of the struct in the library that runs */
    brio_surface_method method;
    const char *name;    /* as the command line and Python call it: "tight-cocone" */
    const char *words;   /* what it is good for, in a line of help; options in it are those of the command line */
    const char *options; /* the fields of brio_surface_options that it has, besides method and seed, blanks between:
                            "noise open poles.sharp" */
    unsigned traits;     /* BRIO_METHOD_ALL_POINTS and so on */
} brio_surface_method_info;

/** Returns what is known of a method; NULL for a number that names none. */
BRIO_API const brio_surface_method_info *brio_surface_method_facts(brio_surface_method method);

/** Returns 1 if a method has an option of the list in its info, 0 if it has not, or if there is no such method. */
BRIO_API int brio_surface_method_has(brio_surface_method method, const char *option);

/** What becomes of holes of the points: places where a surface goes on and no point shows it. */
typedef enum brio_holes {
    BRIO_HOLES_AUTO = 0,   /* filled where the points round a hole make it likely that the surface goes on, else open */
    BRIO_HOLES_CLOSED = 1, /* all are filled: the surface is closed */
    BRIO_HOLES_END
} brio_holes;

/** What to do about noise in the points. Smoothing moves each point onto a quadratic surface through the middle of its
 *  48 nearest points [Alexa et al. 2003]. */
typedef enum brio_noise {
    BRIO_NOISE_AUTO = 0, /* smooths if it finds noise: if the quadratic surfaces are off the points by a tenth of the
                            spacing or more, and by no more than quadratic surfaces of half as many points are. Keeps
                            the points when `poles.solid` is set. */
    BRIO_NOISE_KEEP = 1, /* the surface follows the points as they are */
    BRIO_NOISE_SMOOTH = 2,
    BRIO_NOISE_END
} brio_noise;

/** Evidence of the side from which points were seen: that is outside. It is weighed, so that a part of it may be wrong:
 *  how often neighbours agree is measured, and evidence drawn by lot weighs nothing. The arrays are not kept. */
typedef struct brio_evidence {
    size_t size;
    const double *normals; /* #P by 3, of any length; NULL: none. Where one is 0 or not finite nothing is known */
    const double *origins; /* num_origins by 3, places of scanners; NULL: none. Not finite: not known */
    size_t num_origins;
    const uint32_t *origin_of; /* #P: the row of `origins` of each point; from num_origins on: not known. NULL: there
                                  is one row for all points, or row p for point p */
} brio_evidence;

/** Kinds of evidence, as bits. */
enum { BRIO_EVIDENCE_NORMALS = 1, BRIO_EVIDENCE_ORIGINS = 2 };

/** Ways to label poles as inner or outer. */
typedef enum brio_labeling {
    BRIO_LABELING_GLOBAL = 0, /* seeks labels of least energy by roof duality [Boros Hammer 2002] */
    BRIO_LABELING_GREEDY = 1, /* labels the most certain pole first [Choi 2003, figure 3.8] */
    BRIO_LABELING_END
} brio_labeling;

/** How poles are found and labeled. Part of other options. */
typedef struct brio_pole_options {
    brio_labeling labeling;
    int sharp; /* 1: discards both poles of a badly shaped cell, so that the faces on either side of a sharp edge without
                  points are extended until they meet; sampling_density 0 then stands for 0.5 */
    double
        sampling_density;   /* R in (0, 1): the Voronoi cell of a point is badly shaped if its radius within the co-cone
                                is more than 1.3 R / (1 - R) times the distance to the nearer pole, which no cell of an
                                R-sample is; the nearer pole of such a point is discarded. Smaller R find more such
                                cells; 0: none */
    const brio_mesh *solid; /* a closed mesh in the unit of the points: poles inside it are inner, and `labeling` is not
                                used; BRIO_ERR_NO_ANSWER if it is not closed; NULL: none */
    uint64_t reserved[4];
} brio_pole_options;

/** What was counted while poles were found and labeled. Part of other statistics. */
typedef struct brio_pole_stats {
    size_t poles;        /* polar balls */
    size_t hidden_poles; /* polar balls without a power cell */
    size_t bad_cells;    /* points with badly shaped cells, whose poles were discarded */
    size_t inner, outer; /* poles by label */
    size_t confused;     /* poles that had evidence for both labels when they were labeled */
    size_t undecided;    /* GLOBAL: poles that the last roof duality did not decide */
    size_t toggled;      /* GLOBAL: poles whose label differs from the greedy one */
    double energy;       /* sum of the weights of the pairs of poles whose labels contradict the evidence. GLOBAL weighs
                            pairs differently from the other labelings: compare its energies with each other only
                            (docs/algorithms.md). */
    double energy_greedy; /* GLOBAL: the energy of the greedy labels that it started from */
    double power_seconds, label_seconds;
    uint64_t reserved[4];
} brio_pole_stats;

enum { BRIO_BOUNDARIES_AUTO = 2 }; /* for brio_surface_options.boundaries */

/** Options of brio_surface. A field of 0 is the default. One that is set and that the method does not have is
 *  BRIO_ERR_ARGUMENT; the methods that have it are named first, as brio_surface_method_facts lists them. */
struct brio_surface_options {
    size_t size;
    brio_surface_method method;
    brio_noise noise; /* LABELED, POWER_CRUST, OFFSET */
    uint64_t seed;    /* every random choice follows from it */
    /* LABELED, TIGHT_COCONE, and COCONE without `pieces`: where outside is. NULL: not known. */
    const brio_evidence *evidence;
    /* All but OFFSET: NULL, or receives #P by 3: the unit normal of the surface at each point, outwards. */
    double *normals;
    /* LABELED, POWER_CRUST: K > 0 leaves open the holes whose radius is over K spacings: for LABELED that of the widest
     * empty circle along the surface; `holes` then does not count. POWER_CRUST leaves out faces whose two balls
     * intersect at an angle over pi / 4 while the smaller ball's radius is that large. 0: LABELED goes by `holes`,
     * POWER_CRUST is closed. */
    double open;
    brio_holes holes; /* LABELED; BRIO_HOLES_CLOSED is taken by all but COCONE, as they are closed */
    /* LABELED, POWER_CRUST, OFFSET, 1: about a quarter as many triangles, as far as the shape allows. Edges collapse
     * while the vertices stay within a tenth of a spacing of the planes of their triangles: edges of up to four
     * spacings of LABELED, and those much shorter than the spacing of the others. The surface stays the same as a
     * manifold. */
    int simplify;
    int confidence;          /* LABELED, 1: adds the property "confidence" of vertices and of faces */
    int polygons;            /* POWER_CRUST, OFFSET, 1: keeps polygons, uncut; not with `simplify` */
    double distance;         /* OFFSET: in the unit of the points, at most 2^60 times their greatest coordinate */
    brio_pole_options poles; /* POWER_CRUST, OFFSET */
    double theta;            /* COCONE, TIGHT_COCONE: half the opening angle in radians, below pi/2; 0: pi/8 */
    /* COCONE, TIGHT_COCONE, 1: finds points at boundaries and where the sampling is too sparse by the shape of their
     * Voronoi cells, and rejects triangles all of whose vertices are such points. BRIO_BOUNDARIES_AUTO: likewise,
     * unless over 15 % of the points are such, which tells nothing. */
    int boundaries;
    int density; /* COCONE, TIGHT_COCONE, 1: estimates the sampling density, and adds it as properties of the vertices */
    /* COCONE: N > 1 is the super co-cone. It triangulates the points in about N pieces, one after the other, and
     * matches the surfaces at the seams; on dense points the triangles are the same. */
    size_t pieces;
    /* This and what follows came later. All but OFFSET, and not with `pieces`: NULL, or receives how the surface came
     * to be at its samples, owned by the caller (brio_explanation_free); NULL on failure. Of more samples than
     * `explained` (0: 5,000) an even choice. Takes 700 bytes a point more, and 4 kB an explained sample. */
    brio_explanation **explanation;
    size_t explained;
    /* LABELED: NULL, or how the triangulations are made in tiles (brio/tiles.h): a folder, and how many; neither
     * `stars` nor a key. The surface has the same bits, however many. With a scratch folder of the context
     * (brio_context_set_scratch), which may be the same one, nothing but a tile and parts of the other steps is in
     * memory. Memory and disk of a triangulation: as of brio_tiles_run; tiles whose share of the points does not fit in
     * the memory limit are refused before the work (BRIO_ERR_NO_MEMORY). */
    const struct brio_tiles_options *tiles;
};

/** What brio_surface found. A number that the method does not count is 0. */
struct brio_surface_stats {
    size_t size;
    size_t samples;   /* distinct positions; of LABELED without strays */
    double noise;     /* AUTO: the standard deviation of the noise found, in spacings; 0: none */
    size_t smoothed;  /* 1: the points were smoothed */
    size_t unused;    /* LABELED, co-cones: samples on no triangle of the surface */
    size_t left_out;  /* LABELED, POWER_CRUST: faces that holes left open, or crumbs between them, had */
    size_t relabeled; /* LABELED, co-cones: tetrahedra whose side was changed, for a manifold or a simpler surface */
    /* LABELED */
    size_t undecided; /* samples and tetrahedra that the last roof duality did not decide */
    size_t specks;    /* regions, inner or outer, that were dropped: of under 30 triangles of 40,000, of under 42 of
                         2 million, and of under a hundredth of all */
    size_t handles;   /* handles, tunnels, crumbs, bubbles that were removed: little evidence held them */
    double energy;    /* of the labels, before these changes: a twenty-first of the log-odds of the votes that they
                         contradict, and of the area */
    double uncertain_share; /* with `confidence`: the share of the vertices whose confidence is under 0.7 */
    unsigned evidence;      /* bits BRIO_EVIDENCE_NORMALS, BRIO_EVIDENCE_ORIGINS: what was of use; 0: inside and outside
                               are a guess */
    unsigned reserved;
    size_t told;              /* samples of which evidence tells the outside */
    double agreement;         /* the share of what evidence tells of these that is so in the result */
    size_t normals, origins;  /* samples with a normal, and with a place of the scanner, be they of use or not */
    double normals_agreement; /* the shares of these whose side in the result is what the normal, or the place, tells */
    double origins_agreement;
    size_t strays;        /* samples that lie alone, far from all others: left out, unless noise is BRIO_NOISE_KEEP */
    size_t holes;         /* left open */
    size_t bridges;       /* gaps of the samples that the surface spans: triangles several times larger than usual */
    double bridge_share;  /* of the area of the surface: that of the bridges */
    double bridge_radius; /* of the largest bridge, by area: the radius of its widest circle, and where that is; 0: */
    double bridge_centre[3]; /* there is none */
    double far_share; /* of the area: what is farther than five usual radii of circles round it from all samples */
    /* COCONE and TIGHT_COCONE */
    size_t candidates;        /* triangles that pass the co-cone test */
    size_t pruned;            /* candidates rejected at sharp edges */
    size_t boundary_samples;  /* found with `boundaries` */
    size_t pieces;            /* with `pieces`: cells of the octree */
    size_t unmatched;         /* with `pieces`: triangles at seams left out because the pieces disagree on them */
    size_t outside_guarantee; /* with `density`: samples on the surface where the estimate of r is over 0.08 */
    double r_median, r_p95;   /* with `density`: of the estimates of r at the samples on the surface */
    /* POWER_CRUST and OFFSET */
    brio_pole_stats poles; /* of OFFSET: of the balls that are left */
    double noise_seconds, delaunay_seconds, poles_seconds, candidates_seconds, labels_seconds, manifold_seconds,
        open_seconds, density_seconds, crust_seconds, simplify_seconds;
    /* LABELED, unless noise is BRIO_NOISE_KEEP: depths from a scanner that are rounded to steps of over a spacing
     * become slopes */
    size_t unrounded; /* points that were moved for that, by at most half a step */
    double rounding;  /* the median of these steps; 0: there are none */
};

/** Finds the oriented unit normals of the points that a surface was made from. A point that is a vertex has the
 *  vertex's normal, as brio_mesh_add_normals finds it, and so have its duplicates. Every other point has the normal of
 *  the surface where the surface is nearest to it, interpolated between vertices.
 *  surface  its vertices are points, maybe moved.
 *  samples  #V: the point of each vertex, such as the data of the property "sample"; NULL: vertex v is point v.
 *  normals  #P by 3, written.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_ANSWER (no vertex has a
 *  normal), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_point_normals(brio_context *ctx, const double *points, size_t num_points,
                                        const brio_mesh *surface, const uint32_t *samples, double *normals);

#ifdef __cplusplus
}
#endif
#endif
