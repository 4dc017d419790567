/* What single precision would do to points, see single_loss.h.
 *
 * Points merge, or move over their neighbours. The points of a file that goes by in blocks are never together: points that
 * merge are near each other in space, and in most files near each other in the order, too. Where the order is random, a
 * block of a cloud that singles ruin has pairs that merge, since so few positions are left. */
#include "single_loss.h"
#include "cloud.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The share of the points that may merge. Chosen: above the pairs of almost coincident points that scans have and that
 * the power crust makes (86 of 600,000 vertices on a torus), below what a country's grid does. */
static const double MOST_MERGED = 1e-3;
/* The share of the spacing of the points by which coordinates may move. Chosen. */
static const double MOST_MOVED = 0.1;
static const double LARGEST_SINGLE = 0x1.fffffep127;

typedef struct {
    run *r;
    const double *box; /* of the points that count; NULL: all do */
    single_loss *loss;
    size_t blocks; /* with points that move */
    brio_status status;
} survey;

/* --- blocks --- */

static bool fits(const single_loss *l) {
    return fabs(l->largest) <= LARGEST_SINGLE;
}

/* Finds the most that one of some coordinates moves. Raises `largest`. */
static double move_of(single_loss *l, const double *x, size_t count) {
    double moved = 0;
    for (size_t i = 0; i < count; i++)
        if (fabs(x[i]) > fabs(l->largest)) l->largest = x[i];
    if (!fits(l)) return 0;
    for (size_t i = 0; i < count; i++) {
        double d = fabs(x[i] - (double)(float)x[i]);
        if (d > moved) moved = d; /* with fmax, gcc 12 for aarch64 ends with an internal error */
    }
    return moved;
}

/* The spacing is searched in the blocks 1, 2, 4, 8 and so on, since that costs more than all else. */
static brio_status add_points(survey *s, const double *points, size_t count) {
    single_loss *l = s->loss;
    brio_status status = BRIO_OK;
    size_t merged;
    double spacing, moved = move_of(l, points, 3 * count);
    l->points += count;
    l->moved = fits(l) ? fmax(l->moved, moved) : 0;
    if (!(moved > 0) || !fits(l)) return BRIO_OK;
    TRY(cli_cloud_merged(s->r, points, count, &merged));
    l->merged += merged;
    s->blocks++;
    if (s->blocks & (s->blocks - 1)) goto done;
    TRY(cli_cloud_spacing(s->r, points, count, &spacing));
    if (spacing > 0 && (l->spacing == 0 || spacing < l->spacing)) l->spacing = spacing;
done:
    return status;
}

/* Copies the points in a box. */
static size_t crop(const brio_mesh *block, const double *box, double *kept) {
    size_t count = 0;
    for (size_t v = 0; v < block->num_vertices; v++) {
        const double *p = block->vertices + 3 * v;
        bool inside = true;
        for (int k = 0; k < 3; k++) inside &= p[k] >= box[k] && p[k] <= box[k + 3];
        if (inside) memcpy(kept + 3 * count++, p, 3 * sizeof *p);
    }
    return count;
}

/* A coordinate that singles cannot hold ends the search. */
static int take_block(const brio_mesh *block, void *user) {
    survey *s = user;
    size_t n = block->num_vertices;
    double *kept = s->box ? malloc((3 * n + 1) * sizeof *kept) : NULL;
    if (s->box && !kept)
        s->status = cli_fail(s->r, BRIO_ERR_NO_MEMORY, "out of memory: a block of %zu points", n);
    else if (s->box)
        s->status = add_points(s, kept, crop(block, s->box, kept));
    else
        s->status = add_points(s, block->vertices, n);
    free(kept);
    return s->status != BRIO_OK || !fits(s->loss);
}

/* --- the whole --- */

brio_status cli_single_loss(run *r, const brio_mesh *mesh, single_loss *loss) {
    survey s = {.r = r, .loss = loss};
    *loss = (single_loss){.points = 0};
    return add_points(&s, mesh->vertices, mesh->num_vertices);
}

static bool can_be_read_twice(const char *path) {
    struct stat info;
    return strcmp(path, "-") != 0 && stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

brio_status cli_single_loss_of_file(run *r, const char *path, const brio_convert_options *o, single_loss *loss) {
    survey s = {.r = r, .loss = loss, .box = o->crop ? o->box : NULL};
    *loss = (single_loss){.points = 0};
    if (!can_be_read_twice(path)) return BRIO_OK;
    brio_status status = brio_read_blocks(r->ctx, path, o->from, take_block, &s, NULL);
    if (s.status != BRIO_OK) return s.status;
    if (status == BRIO_ERR_CANCELLED && fits(loss)) return status;
    if (loss->moved <= MOST_MOVED * o->thin) loss->merged = 0; /* no thinned points are as near as that */
    loss->spacing = fmax(loss->spacing, o->thin);
    return BRIO_OK;
}

bool cli_single_is_harmful(const single_loss *l, char reason[200]) {
    if (!fits(l)) {
        snprintf(reason, 200, "single precision cannot hold %g", l->largest);
        return true;
    }
    if ((double)l->merged > MOST_MERGED * (double)l->points) {
        snprintf(reason, 200, "single precision would merge %zu of %zu points with others", l->merged, l->points);
        return true;
    }
    if (l->spacing > 0 && l->moved > MOST_MOVED * l->spacing) {
        snprintf(reason, 200, "single precision would move points by up to %.3g, and most are %.3g from the next",
                 l->moved, l->spacing);
        return true;
    }
    return false;
}
