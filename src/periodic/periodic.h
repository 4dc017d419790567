/* A periodic triangulation: one tetrahedron of each class of translates.
 *
 * I1  Of each class there is the tetrahedron whose lexicographically least finite vertex is an image i < num_points.
 * I2  mate is an involution. Mates across a facet have its three vertices, up to a translation: the lexicographically
 *     least ones of both sides correspond. */
#ifndef BRIO_PERIODIC_PERIODIC_H
#define BRIO_PERIODIC_PERIODIC_H

#include "completion/completion.h"
#include "periodic/images.h"

/* --- the stars of the points in the domain, in the triangulation of all translates --- */

/** Tetrahedra from two sources. Those of `t` at points that are not `redone` are right where they have a vertex in the
 *  domain; those at redone points are in `extra`. */
typedef struct brio_stars {
    brio_images images;
    size_t num_known;      /* images that `t` is made of */
    brio_triangulation *t; /* of the first num_known images */
    uint8_t *redone;       /* #points, or NULL for none */
    uint8_t *is_vertex;    /* #points */
    size_t num_redone;
    uint32_t (*extra)[4]; /* images: finite ones with four vertices, infinite ones with BRIO_INFINITE last */
    size_t num_extra, extra_capacity;
    size_t triangulated, most_completed; /* by all rounds; by one round of the completion */
    int rounds;
} brio_stars;

/** A triangulation of images that is there already, where one is. */
typedef struct brio_stars_known {
    double margin[3]; /* #rank: that of its images; see brio_stars_shifts */
    /** Makes it: of the points of the domain, then of their translates in the margin, point by point.
     *  out  the owner is who called. */
    brio_status (*make)(void *user, const brio_images *images, brio_triangulation **out);
    void *user;
} brio_stars_known;

/** Points whose stars are to be found. */
typedef struct brio_stars_task {
    const brio_lattice *lattice;
    const double (*home)[3]; /* #points: their translates in the domain */
    const double *weights;   /* #points, or NULL */
    size_t num_points;
    double halo; /* in spacings */
    uint64_t seed;
    size_t max_tetrahedra;         /* that the first triangulation may have; 0: as many as it needs */
    const brio_stars_known *known; /* NULL: images in the halo are triangulated */
} brio_stars_task;

/** Finds the stars.   Returns BRIO_OK, and as brio_delaunay; freed with brio_stars_free in any case. */
brio_status brio_stars_new(brio_context *ctx, const brio_stars_task *task, brio_stars *stars);
void brio_stars_free(brio_stars *stars);

/** Returns the number of points and translates that brio_stars_new triangulates at first. */
double brio_stars_count(const brio_stars_task *task);

/** Sets the margin of a halo, at most the lattice's range: translates with coordinates in the basis from -margin to
 *  1 + margin are triangulated at first. */
void brio_stars_margin(const brio_stars_task *task, double margin[3]);

/** Sets the shifts, from `from` to `to` in each direction, of the translates in the margin of a position x in the
 *  domain. Shift 0 is one of them. */
void brio_stars_shifts(const brio_lattice *lattice, const double margin[3], const double *x, int32_t from[3],
                       int32_t to[3]);

/** Returns whether the margin has all translates that matter for any point of the domain. */
bool brio_stars_has_all(const brio_lattice *lattice, const double margin[3]);

/** Returns whether a translate outside of the margin may be in conflict with a ball.   heaviest  no weight is more. */
bool brio_stars_leaves(const brio_lattice *lattice, const double margin[3], double heaviest, const brio_ball *ball);

/** Counts them for a call of brio_delaunay_periodic.   Returns as it does.
 *  flat  whether all are in a plane or on a line: all translates that matter are triangulated then. */
brio_status brio_periodic_count(brio_context *ctx, const double *points, size_t num_points,
                                const brio_periodic_options *options, bool flat, double *count);

/** What is known of stars that are not kept. */
typedef struct brio_periodic_trial {
    size_t max_tetrahedra; /* in: as in brio_stars_task */
    size_t most_completed; /* as in brio_stars */
    bool flat;             /* all points are in a plane or on a line */
} brio_periodic_trial;

/** Finds the stars for a call of brio_delaunay_periodic, and frees them.
 *  Returns as brio_delaunay_periodic; BRIO_ERR_TOO_LARGE also for more than max_tetrahedra. */
brio_status brio_periodic_try(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                              const brio_periodic_options *options, brio_periodic_trial *trial);

/* --- the result --- */

struct brio_periodic {
    brio_context *ctx;
    brio_periodic_stats stats;
    brio_lattice lattice;
    brio_images images;
    brio_image *shown;          /* #images: the images as the caller sees them */
    double (*position)[3];      /* #images, the same */
    brio_image *representative; /* #points, as the caller sees them */
    int32_t (*home)[3];         /* #points: shifts of the caller's vectors from the points to the domain */
    bool stays;                 /* all points are in the domain as they were given: `home` is 0 */
    brio_tetrahedron *tet;      /* I1, I2: finite ones first */
    uint32_t *border;           /* those with a vertex that is not in the domain */
    size_t num_border;
};

/** The default halo, in spacings: in uniform points nearly all balls at points of the domain are within it.
 *  Measured. */
static const double BRIO_PERIODIC_HALO = 2.5;

/** Takes the caller's options, and refuses wrong ones. */
brio_status brio_periodic_take(brio_context *ctx, const brio_periodic_options *options, brio_periodic_options *own);

/** Makes all of a triangulation that has its lattice and its points' shifts to the domain. */
brio_status brio_periodic_make(brio_periodic *t, const brio_stars_task *task);

/** Classes of stars. */
typedef struct brio_folded {
    brio_tetrahedron *tet; /* finite ones first */
    size_t num_finite, num_infinite;
    uint32_t *border; /* those with a vertex that is not in the domain */
    size_t num_border;
} brio_folded;

/** Makes the classes of stars, of which the tetrahedra take the place of those of stars->t.
 *  out  its arrays are owned by the caller.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, BRIO_ERR_TOO_LARGE, or BRIO_ERR_INTERNAL if facets have no
 *  mates. */
brio_status brio_periodic_fold(brio_context *ctx, brio_stars *stars, brio_folded *out);

/** Returns the shift by which the mate behind facet i of tetrahedron t has to be moved to meet it there. */
void brio_periodic_across(const brio_images *images, const brio_tetrahedron *tet, size_t t, int i, int32_t shift[3]);

/** Returns a translate as the caller sees it: in the vectors that were given.   image  its shift is in the basis.
 *  home  #rank: from what the caller gave to the domain; NULL for none.   from  #rank: shift 0 of the result. */
brio_image brio_periodic_show(const brio_periodic *t, const brio_image *image, const int32_t *home,
                              const int64_t *from);

/** All tetrahedra with a vertex in the domain, and the mates across facets that have such a vertex. Other mates are the
 *  facet itself. */
typedef struct brio_unfolded {
    brio_tetrahedron *tet;
    size_t num_finite, count;
} brio_unfolded;

/** Makes the further ones: the finite tetrahedra with a vertex in the domain that do not stand for their class.
 *  images  gets the images that they name.   more  owned by the caller. */
brio_status brio_periodic_further(brio_context *ctx, const brio_periodic *t, brio_images *images, uint32_t (**more)[4],
                                  size_t *num_more);

/** Makes them.   wanted  #points: only those at classes with a point of a 1, and mates among these; NULL: all.
 *  images  gets the images that they name.   out  its array is owned by the caller; nothing on failure. */
brio_status brio_periodic_unfold(brio_context *ctx, const brio_periodic *t, const uint8_t *wanted, brio_images *images,
                                 brio_unfolded *out);

#endif
