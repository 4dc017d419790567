/* Completion: the stars of some points in the triangulation of a set that is not at hand as a whole.
 *
 * The caller has its own points, some other points of the set, and a source that finds points of the set that conflict
 * with given tetrahedra. The result is every tetrahedron of the set's triangulation that has an own point for a vertex:
 * those of brio_delaunay for the whole set, ties included. docs/decisions/017-tiles.md has the proof.
 *
 * The room knows nothing of tiles, files or periods: a source is two pointers. */
#ifndef BRIO_COMPLETION_COMPLETION_H
#define BRIO_COMPLETION_COMPLETION_H

#include "base/context.h"
#include "predicates/predicates.h"
#include <math.h>

/* --- regions of conflict --- */

/* The region of space in which a point conflicts with a tetrahedron: the ball of its (ortho)sphere, or, for an infinite
 * tetrahedron, the open half-space behind its facet. A box is tested in floating point, with a margin: the answer may
 * be yes where it ought to be no. A point is tested exactly, with ties broken as the triangulation breaks them. */

/** The region of one tetrahedron. Points are records: x, y, z, weight. */
typedef struct {
    double vertex[4]
                 [4]; /* of the positive tetrahedron; of an infinite one three, and (a, b, c, x) is positive outside */
    double centre[3]; /* of a finite one: a point x of weight w in conflict has |x - centre|^2 - w at most */
    double square;    /* this; INFINITY where the tetrahedron is too flat to say */
    double way[3];    /* from vertex[0] to the centre: a point of weight w in conflict, d away from vertex[0], has */
    double least;     /* at least this as d (2 way - d) + w; -INFINITY where the tetrahedron is too flat to say */
    bool infinite;
    bool is_free; /* a source sets it if no point of the set conflicts with the tetrahedron; it need not */
} brio_ball;

/** A box that holds points, none of which is heavier than `weight`. */
typedef struct {
    double low[3], high[3];
    double weight;
} brio_ball_box;

/* All roundings of a comparison of squares together stay below a factor of 1 +- BRIO_BALL_SLACK; what underflows is
 * less than BRIO_BALL_TINY. */
#define BRIO_BALL_SLACK 0x1p-46
#define BRIO_BALL_TINY  1e-290

/** Sets a ball's `square` from its first vertex, its centre, and a bound of the error of each of the centre's
 *  coordinates.
 *  all  a box that holds all points that will ever be compared with the ball. */
static inline void brio_ball_set_square(brio_ball *ball, double error, const brio_ball_box *all) {
    const double *p = ball->vertex[0];
    double diagonal = 0, square = 0;
    ball->square = INFINITY;
    if (ball->infinite || isnan(ball->centre[0])) return;
    for (int k = 0; k < 3; k++) {
        double d = p[k] - ball->centre[k];
        diagonal += fabs(all->high[k] - all->low[k]);
        square += d * d;
    }
    square += (square + fabs(p[3])) * BRIO_BALL_SLACK - p[3] + 4 * error * diagonal + BRIO_BALL_TINY;
    if (!isnan(square)) ball->square = square; /* else differences of infinities */
}

/** Sets a ball's `way` and `least`, which brio_ball_meets needs, and its `square`. The parameters are the same. */
void brio_ball_set_region(brio_ball *ball, double error, const brio_ball_box *all);

/** Returns what brio_ball_meets does, for an infinite tetrahedron. */
bool brio_facet_meets(brio_filter *f, const brio_ball *ball, const brio_ball_box *box);

/** Returns whether a point in the box may be in conflict. Never false where one is.   f  as in brio_ball_takes. */
static inline bool brio_ball_meets(brio_filter *f, const brio_ball *ball, const brio_ball_box *box) {
    if (ball->infinite) return brio_facet_meets(f, ball, box);
    double sum = box->weight;
    for (int k = 0; k < 3; k++) { /* of the box's point nearest to the centre */
        double low = box->low[k] - ball->vertex[0][k], high = box->high[k] - ball->vertex[0][k], d = ball->way[k];
        d = d < low ? low : d > high ? high : d;
        sum += d * (2 * ball->way[k] - d);
    }
    return !(sum < ball->least); /* true for NaN */
}

/** Returns whether every point in conflict lies strictly inside the box, whose weight is that of the heaviest point.
 *  May be false where they do. Always false for a half-space. */
static inline bool brio_ball_inside(const brio_ball *ball, const brio_ball_box *box) {
    if (ball->infinite || !(ball->square < INFINITY)) return false;
    double square = ball->square + (fabs(ball->square) + fabs(box->weight)) * BRIO_BALL_SLACK + box->weight;
    double nearest = INFINITY; /* side of the box */
    for (int k = 0; k < 3; k++) {
        double below = ball->centre[k] - box->low[k], above = box->high[k] - ball->centre[k];
        nearest = below < nearest ? below : nearest;
        nearest = above < nearest ? above : nearest;
    }
    /* no point of the set is as heavy, or the square of the radius is less than that of the distance */
    return square < 0 || (nearest > 0 && nearest * nearest * (1 - BRIO_BALL_SLACK) > square);
}

/** Returns whether a point conflicts with the tetrahedron, exactly. A point at the position of a vertex does if it is
 *  heavier.
 *  f  a filter whose extents hold the vertices and the point; each thread has its own. */
bool brio_ball_takes(brio_filter *f, const brio_ball *ball, const double *record);

/* --- completion --- */

/** A point of the set. */
typedef struct {
    double record[4]; /* x, y, z, weight; -0 is not used */
    uint64_t name;    /* by which points are told apart; the caller's choice */
} brio_set_point;

/** Points that a source finds: a list that brio_found_add lets grow. */
typedef struct {
    brio_context *ctx;
    brio_set_point *point;
    size_t count, capacity;
} brio_found;

/** Appends a point. Points may be there twice, or be known: the completion takes each name once.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_found_add(brio_found *found, const brio_set_point *point);

/** Finds points of the set for the regions of `count` tetrahedra.
 *  Must add, for each ball with which any point of the set conflicts, at least one such point. May leave out the
 *  others, and may add points that conflict with nothing. Should set ball.is_free where no point conflicts: the
 *  completion then ends a round earlier. Where the set has several points at one position, the source knows only the
 *  heaviest, and of equally heavy ones one. Returns BRIO_OK or an error, which ends the completion. */
typedef brio_status (*brio_conflicts_fn)(void *user, brio_ball *balls, size_t count, brio_found *found);

/** Receives tetrahedra that are final, positive, with indices of `known` for vertices. An infinite tetrahedron has
 *  BRIO_INFINITE last. Each comes once, in no particular order.
 *  Returns BRIO_OK or an error, which ends the completion. */
typedef brio_status (*brio_final_fn)(void *user, const brio_set_point *known, const uint32_t (*vertex)[4],
                                     size_t count);

typedef struct {
    const brio_set_point *points; /* own points first, at distinct positions or of one position the heaviest first */
    size_t num_own, num_points;   /* the others are known from the beginning: a coarse sample of the whole set, its
                                     extreme points, and four that span space if any do; they may be none */
    bool weighted;
    brio_ball_box all;         /* holds all points of the set */
    const brio_ball_box *home; /* NULL, or a box in whose interior every point of the set is among `points`. Sides may
                                  be infinite */
    brio_conflicts_fn source;  /* for brio_complete alone */
    void *source_user;
    brio_final_fn final;
    void *final_user;
    bool least_only; /* hands on only tetrahedra whose lexicographically least vertex is an own point */
    bool any_order;  /* the order in which tetrahedra are handed on may depend on the threads: a sixth faster */
} brio_completion_task;

enum { BRIO_COMPLETION_ROUNDS = 64, BRIO_COMPLETION_BALLS = 4096 /* in one call of a source */ };

/** Facts of a completion. */
typedef struct {
    int dimension;               /* below 3: the points known span no space; there are no tetrahedra */
    size_t vertices;             /* own points that are vertices of the whole triangulation */
    size_t not_vertices;         /* own points that are none: hidden, or at the position of another */
    size_t tetrahedra, infinite; /* handed on */
    size_t known;                /* own points, those of the task, and those that the source found */
    int rounds;
    uint64_t asked;                      /* balls */
    uint64_t found;                      /* points that were new */
    uint64_t triangulated;               /* points, all rounds together */
    size_t most_points, most_tetrahedra; /* of one round */
} brio_completion_stats;

/** Completes the stars of the own points: takes all steps below, and asks the task's source.
 *  is_vertex  NULL, or receives for each own point whether it is a vertex of the whole triangulation.
 *  Memory: a triangulation of the own points and those around them, and 60 bytes a known point.
 *  Cost: the first round triangulates all known points; later ones only those about unfinished stars.
 *  Returns what brio_delaunay, the source and `final` return. */
brio_status brio_complete(brio_context *ctx, const brio_completion_task *task, uint8_t *is_vertex,
                          brio_completion_stats *stats);

/* --- in steps --- */

/* A round begins with questions, numbered from 0, and ends when its answers are there. Between the two, other
 * completions may begin, so that many ask at once. Answers come in any order, in parts, from any number of sources:
 * neither the tetrahedra nor the points that a round knows, nor their order, depend on that.
 *
 *     brio_completion_new(ctx, &task, &c);
 *     for (bool goes_on = true; goes_on;) {
 *         brio_completion_begin(c, &questions);
 *         brio_completion_balls(c, 0, questions, balls);
 *         ... brio_completion_take(c, points, count) and brio_completion_is_free(c, question) in any order
 *         brio_completion_end(c, &goes_on);
 *     } */
typedef struct brio_completion brio_completion;

/** Makes a completion. The points of the task are copied; its home must stay. */
brio_status brio_completion_new(brio_context *ctx, const brio_completion_task *task, brio_completion **out);

/** Begins a round: triangulates, and judges which tetrahedra must be asked for.   *questions  receives how many. */
brio_status brio_completion_begin(brio_completion *c, size_t *questions);

/** Sets the balls of `count` questions from `first` on. Returns BRIO_OK or BRIO_ERR_CANCELLED. */
brio_status brio_completion_balls(const brio_completion *c, size_t first, size_t count, brio_ball *balls);

/** Notes that no point of the set conflicts with the ball of a question. It is not wrong to leave this out. */
void brio_completion_is_free(brio_completion *c, size_t question);

/** Takes points that were found, as a brio_conflicts_fn finds them. */
brio_status brio_completion_take(brio_completion *c, const brio_set_point *points, size_t count);

/** Ends a round: hands on the tetrahedra of stars that are final.   *goes_on  receives whether a further round is
 *  needed. Until then every question must have been answered: each ball with which a point conflicts had one taken. */
brio_status brio_completion_end(brio_completion *c, bool *goes_on);

/** Returns the facts so far. The view is valid until brio_completion_delete. */
const brio_completion_stats *brio_completion_facts(const brio_completion *c);

/** Sets for each own point whether it is a vertex of the whole triangulation. Call after the last round. */
void brio_completion_vertices(const brio_completion *c, uint8_t *is_vertex);

/** Returns the points that are known: own ones first. The view is valid until brio_completion_delete. */
const brio_set_point *brio_completion_known(const brio_completion *c, size_t *count);

/** Frees everything; NULL is accepted. */
void brio_completion_delete(brio_completion *c);

#endif
