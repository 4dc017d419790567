/* Voronoi and power cells.
 *
 * The diagram is computed once: the centres of the tetrahedra, exact ties among them, the tetrahedra of each vertex.
 * Then threads compute the cells, each from the star of its site, along the array of tetrahedra. A cell is computed the
 * same way whichever thread takes it. Cells that reach outside the region are clipped. Where nothing but volumes and
 * neighbours is asked for, a sweep over the tetrahedra gives those of most cells (sweep.c), and the diagram is computed
 * for the others alone.
 *
 * Based on: Aurenhammer. Power diagrams: properties, algorithms and applications. SIAM J. Computing 1987.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, sections 2.1 and 2.2. */
#include "base/context.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/team.h"
#include "base/versioned.h"
#include "cells/cell_record.h"
#include "predicates/predicates.h"
#include "triangulation/view.h"
#include <limits.h>
#include <math.h>
#include <string.h>

/* --- inputs in a plane or on a line --- */

/* Points in a plane, on a line, or at one position, completed to a set of dimension 3.
 *
 * Let q be a point off the plane of points of dimension 2. Every tetrahedron of all points has q as a vertex, and its
 * sphere meets the plane in the circle of the other three: the tetrahedra are cones over the Delaunay (regular)
 * triangulation of the plane. On a line the same holds for the edge between two added points. An added point is a
 * corner of the convex hull, so it is never hidden and hides no point. */

enum { BRIO_MOST_ADDED = 3 };

/** Points of dimension 3. */
typedef struct {
    double *points, *weights; /* num_points + 3 rows; weights NULL without weights */
    size_t added;             /* rows after num_points; the rows beyond them repeat the first point */
} brio_completed_points;

/* Points that span what was seen so far. */
typedef struct {
    const double *point[4];
    int count;
} basis;

static bool is_outside(const basis *b, const double *x) {
    switch (b->count) {
    case 1:
        return !brio_same_position(b->point[0], x);
    case 2:
        return !brio_collinear(b->point[0], b->point[1], x);
    case 3:
        return brio_orient3d(b->point[0], b->point[1], b->point[2], x) != 0;
    default:
        return b->count == 0;
    }
}

static bool extend(basis *b, const double *x) {
    if (!is_outside(b, x)) return false;
    b->point[b->count++] = x;
    return true;
}

/* Writes the first point moved along axis k by about the size of the point set. */
static void move_first(const double *points, size_t n, int k, double *x) {
    double most = 0;
    for (size_t i = 0; i < 3 * n; i++) {
        double way = fabs(points[i] * 0.5 - points[i % 3] * 0.5);
        most = way > most ? way : most;
    }
    double step = fmax(most, fabs(points[k]) * 0x1p-20);
    memcpy(x, points, 3 * sizeof *x);
    if (!(step > 0)) step = 1;
    x[k] += points[k] > 0 ? -step : step;
}

/* Copies the points, and adds points off their affine hull until the dimension is 3.
 *  points, weights  #P by 3; #P, or NULL.   num_points  at least 1.
 *  out  its arrays are owned by the caller (brio_release).
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
static brio_status complete_flat_points(brio_context *ctx, const double *points, const double *weights, size_t n,
                                        brio_completed_points *out) {
    brio_status status = BRIO_OK;
    double *x = NULL, *w = NULL;
    basis b = {{0}, 0};
    *out = (brio_completed_points){0};
    BRIO_TRY(BRIO_ALLOC(ctx, x, 3 * (n + BRIO_MOST_ADDED)));
    if (weights) BRIO_TRY(BRIO_ALLOC(ctx, w, n + BRIO_MOST_ADDED));
    memcpy(x, points, 3 * n * sizeof *x);
    for (size_t i = n; i < n + BRIO_MOST_ADDED; i++) memcpy(x + 3 * i, points, 3 * sizeof *x);
    for (size_t i = 0; w && i < n + BRIO_MOST_ADDED; i++) w[i] = weights[i < n ? i : 0];
    for (size_t i = 0; i < n && b.count < 4; i++) extend(&b, x + 3 * i);
    for (int k = 0; k < 3 && b.count < 4; k++) {
        double *next = x + 3 * (n + out->added);
        move_first(points, n, k, next);
        if (extend(&b, next))
            out->added++;
        else
            memcpy(next, points, 3 * sizeof *x);
    }
    out->points = x;
    out->weights = w;
    x = w = NULL;
done:
    brio_release(ctx, x);
    brio_release(ctx, w);
    return status;
}

/* --- cells --- */

/* CHUNK: cells that a thread takes at a time. SLICES: progress is reported between slices of the cells. All chosen. */
enum { CHUNK = 128, CELLS_A_THREAD = 512, SLICES = 64 };

void brio_cells_free(brio_cells *cells) {
    if (!cells) return;
    brio_context *ctx = cells->context;
    brio_release(ctx, cells->site);
    brio_release(ctx, cells->volume);
    brio_release(ctx, cells->bounded);
    brio_release(ctx, cells->area);
    brio_release(ctx, cells->centroid);
    brio_release(ctx, cells->face_offsets);
    brio_release(ctx, cells->face_neighbours);
    brio_release(ctx, cells->face_areas);
    brio_release(ctx, cells->face_normals);
    brio_release(ctx, cells->corner_offsets);
    brio_release(ctx, cells->face_vertices);
    brio_release(ctx, cells->vertices);
    brio_release(ctx, cells->face_shifts);
    brio_release(ctx, cells);
}

/* What a call works with, beside the job. */
typedef struct {
    brio_context *ctx;
    const brio_cell_complex *complex; /* of a space that repeats, or NULL */
    const double *points, *weights;
    size_t num_points;
    brio_cells_options options;
    brio_triangulation *own;         /* made by the call, or NULL */
    double *rows, *row_weights;      /* a copy of the caller's points; or NULL */
    brio_completed_points all;       /* of flat points */
    double *scaled, *scaled_weights; /* or NULL */
    brio_cell_frame frame;
    brio_cell_complex whole; /* for the cells that the sweep leaves, of a space that repeats */
    brio_sweep sweep;
    uint8_t *wanted; /* of each point: whether the sweep leaves its cell */
    brio_diagram diagram;
    brio_region region;
} cell_call;

/* --- what the diagram is made of --- */

/* Completes points of dimension 0 to 2 and triangulates them again. */
static brio_status triangulate_flat(cell_call *c) {
    brio_completed_points *all = &c->all;
    BRIO_FORWARD(complete_flat_points(c->ctx, c->points, c->weights, c->num_points, all));
    brio_triangulation_free(c->own);
    c->own = NULL;
    BRIO_FORWARD(brio_delaunay(c->ctx, all->points, all->weights, c->num_points + all->added, NULL, &c->own));
    c->points = all->points;
    c->weights = all->weights;
    c->diagram.flat = true;
    return BRIO_OK;
}

/* Copies the caller's points: another thread of the caller may change them meanwhile, and the triangulation and the
 * cells must be those of the same points. -0 becomes 0, as in triangulations: no number of a cell tells them apart. */
static brio_status copy_points(cell_call *c) {
    size_t n = c->num_points;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->rows, 3 * n));
    for (size_t i = 0; i < 3 * n; i++) c->rows[i] = c->points[i] + 0.0;
    c->points = c->rows;
    if (!c->weights) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->row_weights, n));
    if (n) memcpy(c->row_weights, c->weights, n * sizeof *c->row_weights);
    c->weights = c->row_weights;
    return BRIO_OK;
}

/* Finds the triangulation to work with. */
static brio_status triangulate(cell_call *c, const brio_triangulation *t) {
    brio_bar bar = brio_progress_bar(c->ctx);
    if (c->complex && c->complex->tet) {
        c->diagram.t = (brio_tetrahedra){.tet = c->complex->tet, .count = c->complex->count, .infinite = BRIO_INFINITE};
        c->diagram.num_finite = c->complex->num_finite;
        return BRIO_OK;
    }
    if (!c->complex) BRIO_FORWARD(copy_points(c));
    if (t) BRIO_FORWARD(brio_refuse_not_finite(c->ctx, c->points, c->weights, c->num_points, NULL));
    if (!t) {
        brio_progress_part(c->ctx, bar, 0, 0.6);
        BRIO_FORWARD(brio_delaunay(c->ctx, c->points, c->weights, c->num_points, NULL, &c->own));
        t = c->own;
        brio_progress_part(c->ctx, bar, 0.6, 1);
    }
    if (brio_triangulation_stats(t)->dimension < 3 && c->num_points) {
        BRIO_FORWARD(triangulate_flat(c));
        t = c->own;
    }
    c->diagram.t = brio_tetrahedra_of(t);
    c->diagram.num_finite = brio_triangulation_stats(t)->tetrahedra;
    return BRIO_OK;
}

/* Returns the greatest absolute value of an array. */
static double greatest(const double *x, size_t n) {
    double most = 0;
    for (size_t i = 0; x && i < n; i++) most = fabs(x[i]) > most ? fabs(x[i]) : most;
    return most;
}

static brio_cell_frame frame_of(const cell_call *c) {
    brio_cell_frame f = {.weight = greatest(c->weights, c->num_points)};
    for (size_t k = 0; k < 3 && c->num_points; k++) {
        f.low[k] = f.high[k] = c->points[k];
        for (size_t i = k; i < 3 * c->num_points; i += 3) {
            f.low[k] = c->points[i] < f.low[k] ? c->points[i] : f.low[k];
            f.high[k] = c->points[i] > f.high[k] ? c->points[i] : f.high[k];
        }
    }
    return f;
}

/* Chooses the origin: 0, unless all points are far from 0 in a coordinate. A difference of two numbers of one sign of
 * which neither is more than twice the other is exact [Sterbenz 1974]. */
static void choose_origin(const brio_cell_frame *f, double origin[3]) {
    for (size_t k = 0; k < 3; k++) {
        double low = f->low[k], high = f->high[k];
        bool far = (low > 0 && high * 0.5 <= low) || (high < 0 && low * 0.5 >= high);
        origin[k] = far ? low + (high - low) * 0.5 : 0;
    }
}

enum { MOST_EXPONENT = 1024 };

/* The exponents of the least and the greatest length that matters. */
typedef struct {
    int low, high;
} exponents;

static void take_length(exponents *e, double length, bool least) {
    int exponent = MOST_EXPONENT;
    if (!(length > 0)) return;
    if (length < INFINITY) frexp(length, &exponent);
    if (exponent > e->high) e->high = exponent;
    if (exponent < e->low && least) e->low = exponent;
}

/* Takes the size of the region, and how far off the points it reaches. */
static void take_region(const cell_call *c, exponents *e) {
    const brio_cells_options *o = &c->options;
    double width = 0, way = 0;
    for (size_t i = 0; i < 6 && o->box; i++) {
        way = fmax(way, fabs(o->box[i] * 0.5 - c->frame.low[i % 3] * 0.5));
        way = fmax(way, fabs(o->box[i] * 0.5 - c->frame.high[i % 3] * 0.5));
        width = fmax(width, fabs(o->box[i] * 0.5 - o->box[i % 3] * 0.5));
    }
    take_length(e, width, true);
    take_length(e, way, false);
    for (size_t i = 0; i < o->num_planes; i++) {
        const double *plane = o->planes + 4 * i;
        take_length(e, fabs(plane[3]) / greatest(plane, 3), false);
    }
}

/* Takes the extent of the points and the region. */
static exponents exponents_of(const cell_call *c) {
    exponents e = {INT_MAX, INT_MIN};
    double most = 0;
    for (size_t k = 0; k < 3; k++) most = fmax(most, c->frame.high[k] * 0.5 - c->frame.low[k] * 0.5);
    take_length(&e, most, true);
    take_region(c, &e);
    if (e.low > e.high) e.low = e.high;
    return e;
}

/* Chooses the power of two that lengths are multiplied by: 1, unless squares and cubes could overflow or underflow. One
 * above 1 leaves the weights, which are multiplied by its square, below 2^MOST. */
static double choose_scale(const cell_call *c, exponents e) {
    enum { ORDINARY = 100, MOST = 1000 };
    int of_weights;
    if (e.high == INT_MIN) return 1;
    if (e.low > -ORDINARY && e.high < ORDINARY) return 1;
    double weight = c->frame.weight;
    frexp(weight, &of_weights);
    int middle = (e.low + e.high) / 2, scale = middle < -MOST ? MOST : middle > MOST ? -MOST : -middle;
    int highest = weight == 0 ? MOST : of_weights < MOST ? (MOST - of_weights) / 2 : 0;
    return brio_power_of_two(scale < highest ? scale : highest);
}

/* Scales lengths of the points and of the region so that doubles hold their cubes. The exponents of these lengths
 * differ by at most FARTHEST; scaled to the middle of them, the exponents of cubes are at most 3 / 2 FARTHEST, below
 * 1022. */
static brio_status scale_points(cell_call *c) {
    enum { FARTHEST = 600 };
    brio_diagram *d = &c->diagram;
    c->frame = c->complex && c->complex->frame ? *c->complex->frame : frame_of(c);
    const exponents e = exponents_of(c);
    size_t rows = c->num_points + (d->flat ? BRIO_MOST_ADDED : 0);
    d->points = d->at = c->points;
    d->weights = d->square = c->weights;
    BRIO_EXPECT(c->ctx, e.high == INT_MIN || e.high - e.low <= FARTHEST, BRIO_ERR_ARGUMENT,
                "the region is too large or too small beside the points for doubles");
    d->scale = choose_scale(c, e);
    choose_origin(&c->frame, d->origin);
    bool moved = d->origin[0] != 0 || d->origin[1] != 0 || d->origin[2] != 0;
    if (d->scale == 1 && !moved) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->scaled, 3 * rows));
    for (size_t i = 0; i < 3 * rows; i++) c->scaled[i] = (c->points[i] - d->origin[i % 3]) * d->scale;
    d->at = c->scaled;
    if (!c->weights || d->scale == 1) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->scaled_weights, rows));
    for (size_t i = 0; i < rows; i++) c->scaled_weights[i] = c->weights[i] * d->scale * d->scale;
    d->square = c->scaled_weights;
    return BRIO_OK;
}

/* Refuses boxes and planes that are no numbers, and planes without a normal. */
static brio_status check_region(brio_context *ctx, const brio_cells_options *o) {
    BRIO_EXPECT(ctx, !o->reserved_int, BRIO_ERR_ARGUMENT, "brio_cells_options.reserved_int is not 0");
    BRIO_EXPECT(ctx, o->planes || !o->num_planes, BRIO_ERR_ARGUMENT, "%zu planes, but no array of them", o->num_planes);
    for (size_t i = 0; i < 6 && o->box; i++)
        BRIO_EXPECT(ctx, isfinite(o->box[i]), BRIO_ERR_ARGUMENT, "number %zu of the box is not finite", i);
    for (size_t i = 0; i < o->num_planes; i++) {
        BRIO_EXPECT(ctx, brio_all_finite(o->planes + 4 * i, 4), BRIO_ERR_ARGUMENT,
                    "plane %zu of the region is not finite", i);
        BRIO_EXPECT(ctx, greatest(o->planes + 4 * i, 3) > 0, BRIO_ERR_ARGUMENT,
                    "plane %zu of the region has the normal 0", i);
    }
    return BRIO_OK;
}

/* Makes the region of the walls of the box and of the planes. */
static brio_status make_region(cell_call *c) {
    const brio_cells_options *o = &c->options;
    brio_status status = BRIO_OK;
    size_t walls = o->box ? 6 : 0;
    double *planes = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, planes, 4 * (walls + o->num_planes)));
    for (size_t i = 0; i < walls; i++) {
        double at = o->box[i / 2 + 3 * (i % 2)];
        planes[4 * i + i / 2] = i % 2 ? 1 : -1;
        planes[4 * i + 3] = i % 2 ? at : -at;
    }
    if (o->num_planes) memcpy(planes + 4 * walls, o->planes, 4 * o->num_planes * sizeof *planes);
    BRIO_TRY(brio_region_new(c->ctx, planes, walls + o->num_planes, c->diagram.origin, c->diagram.scale, &c->region));
done:
    brio_release(c->ctx, planes);
    return status;
}

/* --- the cells --- */

/* Makes the arrays of numbers of cells, and lists the sites in ascending order. */
static brio_status make_cells(brio_cell_job *job) {
    const brio_diagram *d = job->d;
    brio_cells *out = job->out;
    const uint32_t *rank = job->sweep ? job->sweep->rank : d->rank;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, job->cell_of, d->num_points));
    for (size_t p = 0; p < d->num_sites; p++)
        if (rank[p] != UINT32_MAX) job->cell_of[p] = (uint32_t)out->num_cells++;
    size_t n = out->num_cells;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->site, n));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->volume, n));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->bounded, n));
    if (job->areas) BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->area, n));
    if (job->centroids) BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->centroid, 3 * n));
    if (job->faces) BRIO_FORWARD(BRIO_ALLOC(d->ctx, job->place, n));
    for (size_t p = 0; p < d->num_sites; p++)
        if (rank[p] != UINT32_MAX) out->site[job->cell_of[p]] = (uint32_t)p;
    return BRIO_OK;
}

typedef struct {
    const brio_cell_job *job;
    size_t first; /* of the slice, in the order of the vertices */
} cell_slice;

static void record_some(void *user, size_t from, size_t to, int thread) {
    const cell_slice *s = user;
    brio_cell_recorder *r = &s->job->recorder[thread];
    for (size_t i = from; i < to && r->status == BRIO_OK; i++) {
        uint32_t site = s->job->d->order[s->first + i];
        if (s->job->d->wanted && !s->job->d->wanted[site]) continue; /* the sweep has it */
        if (site < s->job->d->num_sites) r->status = brio_cell_record(s->job, r, site);
    }
}

static brio_status record_all(brio_cell_job *job) {
    const brio_diagram *d = job->d;
    brio_status status = BRIO_OK;
    size_t n = d->num_vertices, size = n / SLICES + 1;
    for (size_t first = 0; first < n; first += size) {
        cell_slice slice = {job, first};
        size_t count = n - first < size ? n - first : size;
        BRIO_TRY(brio_for_chunks(d->ctx, job->threads, count, CHUNK, record_some, &slice));
        for (int i = 0; i < job->threads; i++) BRIO_TRY(job->recorder[i].status);
        BRIO_TRY(brio_progress(d->ctx, "cells", 0.4 + 0.5 * ((double)first / (double)n)));
    }
done:
    return status;
}

static void take_some(void *user, size_t from, size_t to, int thread) {
    const brio_cell_job *job = user;
    const brio_sweep *s = job->sweep;
    double inverse = 1 / job->d->scale;
    (void)thread;
    for (size_t c = from; c < to; c++) {
        uint32_t r = s->rank[job->out->site[c]];
        if (s->left[r]) continue;
        job->out->volume[c] = brio_cells_held(s->sum[r][0] * inverse * inverse * inverse);
        job->out->bounded[c] = 1;
    }
}

/* Adds up the volumes of the bounded cells, in the order of their sites, with the rounding errors [Neumaier 1974]. */
static double sum_of_volumes(const brio_cells *cells) {
    double sum = 0, lost = 0;
    for (size_t c = 0; c < cells->num_cells; c++) {
        double x = cells->volume[c], next = sum + x;
        if (!cells->bounded[c]) continue;
        if (isfinite(next)) lost += fabs(sum) >= fabs(x) ? (sum - next) + x : (x - next) + sum;
        sum = next;
    }
    return sum + lost;
}

static brio_status compute(brio_cell_job *job) {
    const brio_diagram *d = job->d;
    brio_status status = BRIO_OK;
    job->threads = brio_threads(d->ctx, job->sweep ? job->sweep->num_ranks : d->num_vertices, CELLS_A_THREAD);
    BRIO_TRY(make_cells(job));
    if (job->sweep) BRIO_TRY(brio_for(d->ctx, job->threads, job->out->num_cells, take_some, job));
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, job->recorder, (size_t)job->threads));
    for (int i = 0; i < job->threads; i++) {
        job->recorder[i].ctx = job->recorder[i].shape.ctx = d->ctx;
        job->recorder[i].star.d = d;
    }
    BRIO_TRY(record_all(job));
    if (job->faces) BRIO_TRY(brio_cells_assemble(job));
    job->out->volume_sum = sum_of_volumes(job->out);
done:
    for (int i = 0; job->recorder && i < job->threads; i++) brio_cell_recorder_free(&job->recorder[i]);
    brio_release(d->ctx, job->recorder);
    brio_release(d->ctx, job->cell_of);
    brio_release(d->ctx, job->place);
    return status;
}

/* Checks that the cells fill the region. Where the region is much smaller than its distance from the sites, rounding
 * loses more than its volume. Skips volumes that doubles cannot hold. */
static brio_status check_filled(brio_context *ctx, const brio_cells *cells) {
    static const double MOST = 0.01; /* chosen: what is left of the accuracy of the cells is of no use */
    double filled = cells->volume_sum / cells->region_volume;
    if (!cells->num_cells || !isnormal(cells->region_volume) || !isfinite(filled)) return BRIO_OK;
    BRIO_EXPECT(ctx, fabs(filled - 1) <= MOST, BRIO_ERR_NO_ANSWER,
                "the cells fill %.3g of the region: it is too small or too thin beside its distance from the points",
                filled);
    return BRIO_OK;
}

/* --- the call --- */

static void end_call(cell_call *c) {
    brio_sweep_free(&c->sweep);
    brio_release(c->ctx, c->wanted);
    brio_release(c->ctx, c->whole.tet);
    brio_diagram_free(&c->diagram);
    brio_region_free(&c->region);
    brio_triangulation_free(c->own);
    brio_release(c->ctx, c->rows);
    brio_release(c->ctx, c->row_weights);
    brio_release(c->ctx, c->all.points);
    brio_release(c->ctx, c->all.weights);
    brio_release(c->ctx, c->scaled);
    brio_release(c->ctx, c->scaled_weights);
}

bool brio_cells_are_swept(const brio_cells_options *o) {
    return o->no_areas && o->no_centroids && !o->vertices && (o->no_faces || o->no_face_sizes);
}

/* Sweeps the tetrahedra, and makes the diagram that of the cells that are left. */
static brio_status sweep(cell_call *c) {
    brio_diagram *d = &c->diagram;
    const brio_cell_complex *complex = c->complex;
    brio_sweep_task task = {.tet = d->t.tet,
                            .num_finite = d->num_finite,
                            .count = d->t.count,
                            .at = d->at,
                            .square = d->square,
                            .num_rows = d->num_points,
                            .num_sites = d->num_sites,
                            .region = &c->region,
                            .neighbours = !c->options.no_faces};
    if (complex) task.more = complex->more, task.num_more = complex->num_more, task.owner = complex->owner;
    BRIO_FORWARD(brio_sweep_fill(c->ctx, &task, &c->sweep));
    if (!c->sweep.num_left) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->wanted, d->num_points));
    for (size_t r = 0; r < c->sweep.num_ranks; r++) c->wanted[c->sweep.order[r]] = c->sweep.left[r];
    d->wanted = c->wanted;
    if (!complex || !complex->whole) return BRIO_OK;
    BRIO_FORWARD(complex->whole(complex->user, c->wanted, &c->whole));
    d->t.tet = c->whole.tet;
    d->t.count = c->whole.count;
    d->num_finite = c->whole.num_finite;
    return BRIO_OK;
}

static brio_status run(cell_call *c, const brio_triangulation *t, brio_cells *out) {
    const brio_cells_options *o = &c->options;
    brio_cell_job job = {.d = &c->diagram, .region = &c->region, .out = out};
    job.areas = !o->no_areas, job.centroids = !o->no_centroids, job.vertices = o->vertices;
    job.faces = !o->no_faces || o->vertices;
    job.sizes = job.faces && (!o->no_face_sizes || o->vertices);
    c->diagram.ctx = c->ctx;
    c->diagram.num_points = c->num_points;
    c->diagram.num_sites = c->complex ? c->complex->num_sites : c->num_points;
    BRIO_FORWARD(check_region(c->ctx, o));
    BRIO_FORWARD(triangulate(c, t));
    BRIO_FORWARD(scale_points(c));
    BRIO_FORWARD(make_region(c));
    out->region_volume = c->region.num_planes ? c->region.volume : INFINITY;
    for (int k = 0; k < 3; k++) out->region_volume /= c->diagram.scale;
    if (brio_cells_are_swept(o) && !c->diagram.flat) {
        BRIO_FORWARD(sweep(c));
        job.sweep = &c->sweep;
    }
    if (!job.sweep || c->sweep.num_left) BRIO_FORWARD(brio_diagram_fill(&c->diagram, &c->region));
    BRIO_FORWARD(compute(&job));
    if (!c->complex) BRIO_FORWARD(check_filled(c->ctx, out)); /* else the region is wider than the sites */
    return brio_progress(c->ctx, "cells", 1);
}

/* Makes the struct of the cells and computes them. */
static brio_status make(cell_call *c, const brio_triangulation *t, brio_cells **out) {
    brio_status status = BRIO_OK;
    brio_cells *cells = NULL;
    brio_bar bar = brio_progress_bar(c->ctx);
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, cells, 1));
    cells->size = sizeof *cells;
    cells->context = c->ctx;
    BRIO_TRY(run(c, t, cells));
    *out = cells;
    cells = NULL;
done:
    end_call(c);
    brio_cells_free(cells);
    brio_progress_part(c->ctx, bar, 0, 1);
    return status;
}

brio_status brio_cells_of_complex(brio_context *ctx, const brio_cell_complex *complex,
                                  const brio_cells_options *options, brio_cells **out) {
    cell_call c = {.ctx = ctx,
                   .complex = complex,
                   .points = complex->points,
                   .weights = complex->weights,
                   .num_points = complex->num_points,
                   .options = *options};
    c.diagram.ctx = ctx;
    return make(&c, NULL, out);
}

brio_status brio_voronoi_cells(brio_context *ctx, const brio_triangulation *t, const double *points,
                               const double *weights, size_t num_points, const brio_cells_options *options,
                               brio_cells **out) {
    BRIO_DOOR;
    cell_call c = {.ctx = ctx, .points = points, .weights = weights, .num_points = num_points};
    *out = NULL;
    c.diagram.ctx = ctx;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_cells_options, options, &c.options));
    BRIO_EXPECT(ctx, !t || brio_triangulation_stats(t)->points == num_points, BRIO_ERR_ARGUMENT,
                "the triangulation has %zu points, not %zu", brio_triangulation_stats(t)->points, num_points);
    return make(&c, t, out);
}
