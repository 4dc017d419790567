/* brio/surface.h: surfaces from points.
 *
 * The power crust, offset surfaces and the power shape begin alike: with the Delaunay triangulation of the samples, the
 * poles of the samples (the vertices of a sample's Voronoi cell that are farthest from it on either side of the surface),
 * the power diagram of the polar balls, and a label, inner or outer, for each pole. What they share is in
 * brio_pole_options and brio_pole_stats.
 *
 * The result of every method is the same for every order of the points and every number of threads.
 */
#ifndef BRIO_SURFACE_H
#define BRIO_SURFACE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Ways to label poles as inner or outer. */
typedef enum brio_labeling {
    BRIO_LABELING_GLOBAL = 0,      /* seeks labels of least energy by roof duality [Boros Hammer 2002] */
    BRIO_LABELING_GREEDY = 1,      /* labels the most certain pole first [Choi 2003, figure 3.8] */
    BRIO_LABELING_NAIVE = 2,       /* breadth first from outside [Choi 2003, section 3.3.3] */
    BRIO_LABELING_THEORETICAL = 3, /* breadth first from one sample [Choi 2003, appendix B.3] */
    BRIO_LABELING_END
} brio_labeling;

/** What to do about noise in the samples. Smoothing moves each sample onto a quadratic surface through the middle of its
 *  48 nearest samples [Alexa et al. 2003]. */
typedef enum brio_noise {
    BRIO_NOISE_AUTO = 0,   /* smooths if it finds noise: if the quadratic surfaces are off the samples by a tenth of the
                              spacing or more, and by no more than quadratic surfaces of half as many samples are. Keeps
                              the samples when the option `solid` is set. */
    BRIO_NOISE_KEEP = 1,   /* the surface follows the samples as they are */
    BRIO_NOISE_SMOOTH = 2, /* smooths */
    BRIO_NOISE_END
} brio_noise;

/** How poles are found and labeled. Part of other options. */
typedef struct brio_pole_options {
    brio_labeling labeling; /* default BRIO_LABELING_GLOBAL */
    brio_noise noise;       /* default BRIO_NOISE_AUTO */
    const brio_mesh *solid; /* a closed mesh in the unit of the points: poles inside it are inner, and `labeling` is not
                                used; BRIO_ERR_NO_ANSWER if it is not closed; default NULL */
    double
        sampling_density; /* R in (0, 1): the Voronoi cell of a sample is badly shaped if its radius within the co-cone
                                is more than 1.3 R / (1 - R) times the distance to the nearer pole, which no cell of an
                                R-sample is; the nearer pole of such a sample is discarded. Smaller R find more such
                                cells; default 0: none */
    int sharp;            /* 1: discards both poles of a badly shaped cell, so that the faces on either side of a sharp
                                edge without samples are extended until they meet; sampling_density 0 then stands for 0.5.
                                default 0 */
    int reserved_int;
    uint64_t reserved[4];
} brio_pole_options;

/** What was counted while poles were found and labeled. Part of other statistics. */
typedef struct brio_pole_stats {
    size_t samples;      /* distinct positions */
    size_t poles;        /* polar balls */
    size_t hidden_poles; /* polar balls without a power cell */
    size_t bad_cells;    /* samples with badly shaped cells, whose poles were discarded */
    size_t inner, outer; /* poles by label */
    size_t confused;     /* poles that had evidence for both labels when they were labeled */
    size_t unreached;    /* NAIVE, THEORETICAL: poles that were left to the greedy labeling */
    size_t undecided;    /* GLOBAL: poles that the last roof duality did not decide */
    size_t toggled;      /* GLOBAL: poles whose label differs from the greedy one */
    double energy;       /* sum of the weights of the pairs of poles whose labels contradict the evidence. GLOBAL weighs
                             pairs differently from the other labelings: compare its energies with each other only
                             (docs/algorithms.md). */
    double energy_greedy; /* GLOBAL: the energy of the greedy labels that it started from */
    double noise;         /* AUTO: the standard deviation of the noise found, in spacings of the samples; 0: none */
    size_t smoothed;      /* 1: the samples were smoothed */
    double noise_seconds; /* for the search for noise, and for smoothing */
    double delaunay_seconds, poles_seconds, power_seconds, label_seconds;
    uint64_t reserved[4];
} brio_pole_stats;

typedef struct brio_power_crust_options {
    size_t size;
    uint64_t seed;           /* default 1 */
    brio_pole_options poles; /* how the poles are found and labeled */
    int triangulate;         /* 1: cuts the polygons into triangles; default 0 */
    int simplify; /* 1: triangles, about a quarter as many as the crust has polygons: collapses edges that are
                                much shorter than the local spacing of the samples; the surface stays the same as a
                                manifold; default 0 */
    double open;  /* K > 0, finite: leaves out the faces whose two balls intersect at an angle over pi / 4 while the
                                smaller ball's radius is over K local spacings, so that large holes of the samples stay
                                open; default 0: the surface is closed */
} brio_power_crust_options;

BRIO_API void brio_power_crust_options_init(brio_power_crust_options *options, size_t size);
static inline brio_power_crust_options brio_power_crust_options_default(void) {
    brio_power_crust_options options;
    brio_power_crust_options_init(&options, sizeof options);
    return options;
}

/** What the power crust counts. */
typedef struct brio_power_crust_stats {
    size_t size;
    brio_pole_stats poles;
    size_t left_out; /* faces that the option `open` left out */
    double crust_seconds, simplify_seconds;
} brio_power_crust_stats;

/** Reconstructs a closed surface from samples: the power crust. Its faces are the faces of the power diagram of the polar
 *  balls between a cell of an inner pole and a cell of an outer pole, as polygons seen counterclockwise from outside.
 *  With evidence, samples vote for the sides that it tells, the outside need not be beyond the hull, as in a scan of a
 *  room, and the surface ends at the hull where what is outside changes there.
 *  Guarantees: for every input that has an inside, the mesh is closed, manifold and oriented as a combinatorial object
 *  (with the option `open`, or with evidence that is of use: manifold and oriented). On a dense sample of a smooth closed surface the power crust is
 *  homeomorphic and close to the surface (appendix B of [Choi 2003]).
 *  Vertices that only rounding keeps apart from a sample are at the sample, and the faces between them have no area.
 *  Does not guarantee: triangular faces, faces above a least size, freedom from self-intersections. Faces cross each other
 *  where samples are too few; on dense samples crossing faces are a rare accident of rounding.
 *  brio_mesh_self_intersections counts the pairs.
 *  points   #P by 3.   options  NULL for the defaults.   out  owned by the caller.
 *  normals  NULL, or receives #P by 3: the oriented unit normal of the surface at each point.
 *  stats    NULL, or its `size` set.
 *  Cost: two triangulations, of the samples and of their about 2 n poles; 1,300 to 1,700 bytes a sample at the peak.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, or doubles cannot hold a vertex), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] sections 3.3 and 5. */
BRIO_API brio_status brio_power_crust(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_crust_options *options, brio_mesh **out, double *normals,
                                      brio_power_crust_stats *stats);

/** Evidence of the side from which points were seen: that is outside. It is weighed, so that a part of it may be wrong: how
 *  often neighbours agree is measured, and evidence drawn by lot weighs nothing. The arrays are not kept. */
typedef struct brio_evidence {
    size_t size;
    const double
        *normals; /* #P by 3, of any length, default NULL: none. Where one is 0 or not finite nothing is known */
    const double *origins; /* num_origins by 3, places of scanners, default NULL: none. Not finite: not known */
    size_t num_origins;    /* default 0 */
    const uint32_t
        *origin_of; /* #P: the row of `origins` of each point; from num_origins on: not known. Default NULL: there
                                  is one row for all points, or row p for point p */
} brio_evidence;

BRIO_API void brio_evidence_init(brio_evidence *evidence, size_t size);
static inline brio_evidence brio_evidence_default(void) {
    brio_evidence evidence;
    brio_evidence_init(&evidence, sizeof evidence);
    return evidence;
}

/** Kinds of evidence, as bits. */
enum { BRIO_EVIDENCE_NORMALS = 1, BRIO_EVIDENCE_ORIGINS = 2 };

/** What becomes of holes of the samples: places where a surface goes on and no sample shows it. */
typedef enum brio_holes {
    BRIO_HOLES_CLOSED = 0, /* all are filled: the surface is closed */
    BRIO_HOLES_AUTO = 1, /* filled where the samples round a hole make it likely that the surface goes on, else open */
    BRIO_HOLES_END
} brio_holes;

typedef struct brio_labeled_delaunay_options {
    size_t size;
    uint64_t seed;    /* default 1 */
    brio_noise noise; /* what to do about noisy samples; default BRIO_NOISE_AUTO */
    int confidence;   /* 1: adds the property "confidence" of vertices and of faces; default 0 */
    double
        open; /* K > 0, finite: leaves open the holes that have an empty circle along the surface whose radius is over
                         K spacings (the median distance from a vertex to its nearest neighbour), whatever `holes` is. The
                         surface is then manifold and oriented, with boundary; default 0: `holes` decides */
    int simplify;     /* 1: collapses edges of up to four spacings while the vertices stay within a tenth of a spacing
                         of the planes of their triangles, until a quarter of the triangles is left; the surface stays
                         the same as a manifold; default 0 */
    brio_holes holes; /* default BRIO_HOLES_CLOSED */
    const brio_evidence *evidence; /* of the side from which the points were seen; default NULL: none */
} brio_labeled_delaunay_options;

BRIO_API void brio_labeled_delaunay_options_init(brio_labeled_delaunay_options *options, size_t size);
static inline brio_labeled_delaunay_options brio_labeled_delaunay_options_default(void) {
    brio_labeled_delaunay_options options;
    brio_labeled_delaunay_options_init(&options, sizeof options);
    return options;
}

/** What the labeled Delaunay triangulation counts. */
typedef struct brio_labeled_delaunay_stats {
    size_t size;
    size_t samples;   /* distinct positions, without strays */
    size_t unused;    /* samples on no triangle of the surface */
    size_t undecided; /* samples and tetrahedra that the last roof duality did not decide */
    size_t specks;    /* regions, inner or outer, that were dropped: of under 30 triangles of 40,000, of under 42 of
                         2 million, and of under a hundredth of all */
    size_t relabeled; /* tetrahedra whose side was changed to make the surface a manifold or simpler */
    size_t handles;   /* handles, tunnels, crumbs, bubbles that were removed: little evidence held them */
    double energy;    /* of the labels, before these changes: a twenty-first of the log-odds of the votes that they
                         contradict, and of the area */
    double noise;     /* AUTO: the standard deviation of the noise found, in spacings of the samples; 0: none */
    size_t smoothed;  /* 1: the samples were smoothed */
    double noise_seconds, delaunay_seconds, poles_seconds, labels_seconds, manifold_seconds;
    size_t left_out;         /* triangles that holes left open, or crumbs between them, had */
    double uncertain_share;  /* with options.confidence: the share of the vertices whose confidence is under 0.7 */
    double simplify_seconds; /* for the mesh, and for its simplification */
    unsigned evidence; /* bits BRIO_EVIDENCE_NORMALS, BRIO_EVIDENCE_ORIGINS: what was of use; 0: inside and outside
                                are a guess */
    unsigned reserved;
    size_t told;          /* samples of which evidence tells the outside */
    double agreement;     /* the share of these whose side in the result is what evidence tells */
    size_t strays;        /* samples that lie alone, far from all others: left out, unless noise is BRIO_NOISE_KEEP */
    size_t holes;         /* left open */
    size_t bridges;       /* gaps of the samples that the surface spans: triangles several times larger than usual */
    double bridge_share;  /* of the area of the surface: that of the bridges */
    double bridge_radius; /* of the largest bridge, by area: the radius of its widest circle, and where that is; 0: */
    double bridge_centre[3]; /* there is none */
    double far_share; /* of the area: what is farther than five usual radii of circles round it from all samples */
    double open_seconds;
} brio_labeled_delaunay_stats;

/** Reconstructs a surface from samples: the boundary of the Delaunay tetrahedra that are labeled inner. A sample
 *  votes on the sides of the tetrahedra in its Voronoi cell, with log-odds that were measured on generated solids; the
 *  labels are those of low energy, votes and area together.
 *  Guarantees: for every input that has an inside, the mesh is closed, manifold and oriented as a combinatorial object
 *  (with the options `open` and `holes`: manifold and oriented, with boundary where samples are missing).
 *  Does not guarantee: the right topology where walls or gaps are under two spacings of the samples, freedom from
 *  self-intersections, that every sample is used.
 *  points   #P by 3.   options  NULL for the defaults.   stats  NULL, or its `size` set.
 *  out      owned by the caller: triangles, about two a sample, counterclockwise seen from outside. The vertices are the
 *           samples that the surface uses; with smoothing, where smoothing moved them. With options.confidence, their
 *           property "confidence" (float32) is the probability that the surface is right there, between 0 and 1: a
 *           logistic regression on the share of the votes round the vertex that the labels contradict and on the
 *           log-odds of the labels beside its triangles, measured on generated solids. Vertices under 0.7 are
 *           guesses (docs/algorithms.md tells how often those of real models were wrong). Faces have the property "bridge"
 *           (uint8): 1 for those that span gaps of the samples, which stats.bridges counts; and with options.confidence
 *           "confidence" (float32), the probability that the face is right, fitted to simulated scans.
 *  samples  NULL, or room for #P: receives for each vertex the index of its sample, ascending; with options.simplify, of
 *           the sample whose vertex it was before edges collapsed.
 *  Cost: one triangulation, and the labels, about as long; about 1,000 bytes a sample at the peak.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, or all of the surface spans holes), and as brio_delaunay.
 *  Based on: [Labatut Pons Keriven 2009], [Dey Goswami 2003], [Amenta Bern 1999]. */
BRIO_API brio_status brio_labeled_delaunay(brio_context *ctx, const double *points, size_t num_points,
                                           const brio_labeled_delaunay_options *options, brio_mesh **out,
                                           uint32_t *samples, brio_labeled_delaunay_stats *stats);

/** Finds the oriented unit normals of the points that a surface was made from. A point that is a vertex has the vertex's
 *  normal, as brio_mesh_add_normals finds it, and so have its duplicates. Every other point has the normal of the surface
 *  where the surface is nearest to it, interpolated between vertices.
 *  surface  its vertices are points, maybe moved.
 *  samples  #V: the point of each vertex; NULL: vertex v is point v, as in the co-cone.
 *  normals  #P by 3, written.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_ANSWER (no vertex has a
 *  normal), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_point_normals(brio_context *ctx, const double *points, size_t num_points,
                                        const brio_mesh *surface, const uint32_t *samples, double *normals);

/** How the co-cone makes a surface of its candidate triangles. */
typedef enum brio_extraction {
    BRIO_EXTRACTION_LABELS = 0, /* the candidates between tetrahedra labeled outer and inner, and small gaps filled */
    BRIO_EXTRACTION_CANDIDATES = 1, /* all candidates, as [Choi 2003] has implemented it; not oriented, no manifold */
    BRIO_EXTRACTION_PRUNED = 2,     /* those left when triangles at sharp edges are removed, recursively; likewise */
    BRIO_EXTRACTION_WALK = 3,       /* of these, each component's outside, by a walk from edge to edge
                                       [Amenta Choi Dey Leekha 2000]: a manifold on dense samples */
    BRIO_EXTRACTION_END
} brio_extraction;

typedef struct brio_cocone_options {
    size_t size;
    uint64_t seed;  /* default 1 */
    double theta;   /* half the opening angle of the co-cone in radians, in (0, pi/2); default pi/8 */
    int tight;      /* 1: the tight co-cone, a closed surface; default 0: the co-cone, which may come out open */
    int boundaries; /* 1: finds samples at boundaries and where the sampling is too sparse by the shape of their Voronoi
                       cells, and rejects triangles all of whose vertices are such samples; default 0 */
    int density;    /* 1: estimates the sampling density and adds it as vertex properties; default 0 */
    size_t pieces;  /* N > 1: the super co-cone, which triangulates the samples in about N pieces, one after the other,
                       and matches the surfaces at the seams; not with `tight`; default 0: one piece */
    brio_extraction extraction; /* default BRIO_EXTRACTION_LABELS; the others not with `tight` or `pieces` */
    int reserved_int;
    const brio_evidence
        *evidence; /* of the side from which the points were seen; not with `pieces`; default NULL: none */
} brio_cocone_options;

BRIO_API void brio_cocone_options_init(brio_cocone_options *options, size_t size);
static inline brio_cocone_options brio_cocone_options_default(void) {
    brio_cocone_options options;
    brio_cocone_options_init(&options, sizeof options);
    return options;
}

/** What the co-cone counts. */
typedef struct brio_cocone_stats {
    size_t size;
    size_t samples;           /* distinct positions */
    size_t unused;            /* samples on no triangle of the surface */
    size_t candidates;        /* triangles that pass the co-cone test */
    size_t pruned;            /* candidates rejected at sharp edges */
    size_t boundary_samples;  /* found with options.boundaries */
    size_t relabeled;         /* tetrahedra whose side was changed to keep the surface a manifold */
    size_t pieces;            /* with options.pieces: cells of the octree */
    size_t unmatched;         /* with options.pieces: triangles at seams left out because the pieces disagree on them */
    size_t outside_guarantee; /* with options.density: samples on the surface where the estimate of r is over 0.08 */
    double r_median, r_p95;   /* with options.density: of the estimates of r at the samples on the surface */
    double delaunay_seconds, poles_seconds, candidates_seconds, labels_seconds, manifold_seconds, density_seconds;
} brio_cocone_stats;

/** Reconstructs a surface from Delaunay triangles of the samples: the co-cone or the tight co-cone.
 *  Guarantees: for every input, the mesh is manifold and oriented as a combinatorial object, and the tight co-cone is
 *  closed; not so with another extraction than BRIO_EXTRACTION_LABELS. On an r-sample of a smooth closed surface with
 *  r <= 0.08, BRIO_EXTRACTION_WALK is homeomorphic to the surface and within
 *  1.3 r / (1 - r) times the local feature size of it (theorem 19 of [Choi 2003]). For BRIO_EXTRACTION_LABELS that is
 *  tested, not proven.
 *  Does not guarantee: a closed mesh on sparser samples, freedom from self-intersections, that every sample is used.
 *  points  #P by 3.   options  NULL for the defaults.   stats  NULL, or its `size` set.
 *  out     owned by the caller. Its vertices are the points, with the same indices, also those that no face uses.
 *          options.density adds three properties: "feature_size", the distance to the nearest pole; "r", an estimate of
 *          the sampling density, 0 at a sample on no face; "boundary", 1 at a boundary sample. options.boundaries adds
 *          "boundary" alone.
 *  Cost: one triangulation, and about 50 bytes a tetrahedron. In N pieces the memory is that of 1/N of the samples and
 *  their surroundings, and 60 bytes a point; on a dense sample the triangles are the same as in one piece.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no triangle found, or no inside), and as brio_delaunay.
 *  Based on: [Amenta Choi Dey Leekha 2000], [Choi 2003] section 3.2 and appendix A, [Dey Giesen 2001],
 *            [Dey Giesen Hudson 2001], [Dey Goswami 2003]. */
BRIO_API brio_status brio_cocone(brio_context *ctx, const double *points, size_t num_points,
                                 const brio_cocone_options *options, brio_mesh **out, brio_cocone_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
