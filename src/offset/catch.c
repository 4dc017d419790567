/* Parts of an offset that the surface through its samples misses: points of the offset in the cells of a grid that it
 * crosses, which are looked for in an octree. A cell whose centre is farther from the offset than a corner is not
 * crossed, because the distance changes as much as the place at most. */
#include "base/team.h"
#include "base/vector.h"
#include "offset/work.h"
#include <math.h>
#include <string.h>

enum { BATCH = 1 << 13, CELLS_A_CHUNK = 32, MOST_LEVELS = 30, MOST_CELLS = 1 << 20 /* chosen */ };
enum { EMPTY, CROSSED, MISSED };

static const double MOST_APART = 2; /* of the error: between a point of the offset and the surface; chosen */

typedef uint32_t cell[3];

typedef struct {
    brio_offset_work *w;
    const brio_triangle_tree *surface; /* NULL: there is none */
    double low[3], side;               /* of the grid's corner; of a cell */
    cell *cells;
    size_t count, first;
    bool last; /* level */
    uint8_t *state;
    double (*sample)[3]; /* of the batch */
    double (*found)[3];  /* all that are missed */
    size_t num_found, capacity;
} net;

static bool is_crossed(const net *n, const double *centre) {
    const brio_offset_field *f = &n->w->field;
    double reach = 0.5 * sqrt(3) * n->side, most = f->distance + reach, nearest[3];
    size_t triangle;
    double d = sqrt(brio_closest_within(&f->solid->tree, centre, most * most, nearest, &triangle));
    if (!(d <= most) || f->distance - d > reach) return false;
    return f->distance + d <= reach || !brio_offset_is_beyond(f, centre);
}

/* Returns whether the offset near a cell's centre is far from the surface; then writes a point of it. */
static bool is_missed(const net *n, const double *centre, double *sample) {
    double normal[3], most = MOST_APART * n->w->error;
    size_t triangle = 0;
    if (!brio_offset_reach(&n->w->field, centre, BRIO_OFFSET_TOLERANCE * n->w->error, sample, normal)) return false;
    if (brio_square_distance(sample, centre) > 0.75 * n->side * n->side) return false;
    return !n->surface || !brio_is_within(n->surface, sample, most * most, &triangle);
}

static void look_part(void *user, size_t begin, size_t end, int thread) {
    const net *n = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *c = n->cells[n->first + i];
        double centre[3];
        for (int k = 0; k < 3; k++) centre[k] = n->low[k] + (c[k] + 0.5) * n->side;
        n->state[i] = is_crossed(n, centre) ? CROSSED : EMPTY;
        if (n->state[i] == CROSSED && n->last && is_missed(n, centre, n->sample[i])) n->state[i] = MISSED;
    }
}

/* Looks at a level's cells; makes those of the next level, or lists what is missed. */
static brio_status look(net *n) {
    brio_status status = BRIO_OK;
    brio_context *ctx = n->w->ctx;
    cell *next = NULL;
    size_t count = 0, capacity = 0;
    for (n->first = 0; n->first < n->count; n->first += BATCH) {
        size_t batch = n->count - n->first < BATCH ? n->count - n->first : BATCH;
        BRIO_TRY(brio_offset_progress(n->w));
        BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, batch, CELLS_A_CHUNK), batch, CELLS_A_CHUNK, look_part, n));
        for (size_t i = 0; i < batch; i++) {
            if (n->state[i] == MISSED) {
                BRIO_TRY(BRIO_RESERVE(ctx, n->found, n->capacity, n->num_found + 1));
                memcpy(n->found[n->num_found++], n->sample[i], sizeof *n->found);
            }
            if (n->last || n->state[i] == EMPTY) continue;
            BRIO_TRY(BRIO_RESERVE(ctx, next, capacity, count + 8));
            for (uint32_t c = 0; c < 8; c++, count++)
                for (uint32_t k = 0; k < 3; k++) next[count][k] = 2 * n->cells[n->first + i][k] + (c >> k & 1);
        }
    }
    brio_release(ctx, n->cells);
    n->cells = next;
    n->count = count;
    n->side *= 0.5;
    next = NULL;
done:
    brio_release(ctx, next);
    return status;
}

/* Makes the tree of the surface so far. */
static brio_status tree_of(brio_offset_work *w, brio_triangle_tree *tree) {
    brio_status status = BRIO_OK;
    uint64_t *offsets = NULL;
    size_t n = w->num_triangles;
    BRIO_TRY(BRIO_ALLOC(w->ctx, offsets, n + 1));
    for (size_t i = 0; i <= n; i++) offsets[i] = 3 * i;
    brio_mesh mesh = {.size = sizeof mesh,
                      .context = w->ctx,
                      .num_vertices = w->num_points,
                      .vertices = w->points,
                      .num_faces = n,
                      .face_offsets = offsets,
                      .face_vertices = w->triangles[0]};
    BRIO_TRY(brio_triangle_tree_new(w->ctx, &mesh, tree));
done:
    brio_release(w->ctx, offsets);
    return status;
}

brio_status brio_offset_catch(brio_offset_work *w, double spacing, double *reached, size_t *added) {
    brio_status status = BRIO_OK;
    brio_triangle_tree tree = {0};
    brio_point_tree samples = {0};
    const brio_box *box = &w->field.solid->tree.boxes[0];
    double margin = w->field.inwards ? 0 : w->field.distance;
    net n = {.w = w, .count = 1};
    *added = 0;
    for (int k = 0; k < 3; k++) {
        n.low[k] = box->low[k] - margin;
        n.side = fmax(n.side, box->high[k] + margin - n.low[k]);
    }
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, n.cells, 1));
    BRIO_TRY(BRIO_ALLOC(w->ctx, n.state, BATCH));
    BRIO_TRY(BRIO_ALLOC(w->ctx, n.sample, BATCH));
    if (w->num_triangles) BRIO_TRY(tree_of(w, &tree));
    n.surface = w->num_triangles ? &tree : NULL;
    for (int level = 0; level < MOST_LEVELS && !n.last; level++) {
        *reached = n.side;
        n.last = n.side <= spacing || n.count > MOST_CELLS;
        BRIO_TRY(look(&n));
    }
    if (n.num_found) BRIO_TRY(brio_point_tree_new(w->ctx, w->points, w->num_points, &samples));
    if (n.num_found) BRIO_TRY(brio_offset_add_apart(w, &samples, (const double(*)[3])n.found, n.num_found, added));
done:
    brio_release(w->ctx, n.found);
    brio_triangle_tree_free(w->ctx, &tree);
    brio_point_tree_free(w->ctx, &samples);
    brio_release(w->ctx, n.cells);
    brio_release(w->ctx, n.state);
    brio_release(w->ctx, n.sample);
    return status;
}
