/* The points of other tiles near a tile's border, with which its first round begins.
 *
 * Most spheres that leave a tile leave it by about a spacing. With the points up to two spacings beyond the border they
 * are final in the first round, without a question: all points in the tile's box, widened by that much, are known. So
 * the source is asked for the large spheres alone.
 *
 * The spacing is that of the blocks at the border; the box is widened less where so many points would come that a round
 * more costs less. */
#include "base/memory.h"
#include "tiles/work.h"

/* SPACINGS: chosen by the time of uniform points. MOST_SHARE: of the tile's own points. */
static const double SPACINGS = 2, MOST_SHARE = 0.25;
enum { HALVINGS = 16 };

typedef struct {
    brio_tiles *t;
    uint32_t tile, root;
    uint32_t *block; /* nodes */
    size_t count, capacity;
} nearby;

static double longest_side(const brio_ball_box *b) {
    double most = 0;
    for (int k = 0; k < 3; k++) most = fmax(most, b->high[k] - b->low[k]);
    return most;
}

static brio_ball_box widened(const brio_ball_box *box, double width) {
    brio_ball_box wide = *box;
    for (int k = 0; k < 3; k++) wide.low[k] -= width, wide.high[k] += width;
    return wide;
}

static bool overlap(const brio_ball_box *a, const brio_ball_box *b) {
    for (int k = 0; k < 3; k++)
        if (a->high[k] < b->low[k] || b->high[k] < a->low[k]) return false;
    return true;
}

/* Lists the blocks of other tiles below a node that meet `reach`, or if that is NULL, those not farther from the tile's
 * box than they are large. */
static brio_status list_blocks(nearby *n, uint32_t at, const brio_ball_box *reach) {
    const brio_tile_node *node = &n->t->node[at];
    brio_ball_box wide = reach ? *reach : widened(&n->t->tile[n->tile].home, longest_side(&node->box));
    if (node->tile == n->tile || !overlap(&node->box, &wide)) return BRIO_OK;
    for (uint32_t c = 0; c < node->children; c++) BRIO_FORWARD(list_blocks(n, node->first + c, reach));
    if (node->children) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(n->t->ctx, n->block, n->capacity, n->count + 1));
    n->block[n->count++] = at;
    return brio_look(n->t->ctx, 1);
}

static brio_status relist_blocks(nearby *n, const brio_ball_box *reach) {
    n->count = 0;
    return list_blocks(n, n->root, reach);
}

/* Returns about how far apart the points of a block are, whether they fill space, a surface or a line: its longest d
 * sides have room for that many points in a grid, and the next side is shorter than the grid is wide. */
static double spacing_of(const brio_tile_node *node) {
    double side[3], room = 1, spacing = 0;
    for (int k = 0; k < 3; k++) side[k] = node->box.high[k] - node->box.low[k];
    for (int i = 0; i < 3; i++) {
        for (int j = i + 1; j < 3; j++) {
            double longer = fmax(side[i], side[j]), shorter = fmin(side[i], side[j]);
            side[i] = longer, side[j] = shorter;
        }
        if (side[i] < spacing) break;
        room *= side[i];
        spacing = pow(room / node->points, 1.0 / (i + 1));
    }
    return spacing;
}

/* Returns how far to widen the box; 0 if nothing is near. */
static double first_width(const nearby *n) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < n->count; i++) {
        double spacing = spacing_of(&n->t->node[n->block[i]]);
        if (!(spacing > 0 && spacing < INFINITY)) continue;
        sum += log(spacing);
        count++;
    }
    return count ? SPACINGS * exp(sum / (double)count) : 0;
}

/* Returns about how many points of the listed blocks are in a box. */
static double points_in(const nearby *n, const brio_ball_box *box) {
    double sum = 0;
    for (size_t i = 0; i < n->count; i++) {
        const brio_tile_node *node = &n->t->node[n->block[i]];
        double share = 1;
        for (int k = 0; k < 3; k++) {
            double low = fmax(node->box.low[k], box->low[k]), high = fmin(node->box.high[k], box->high[k]);
            double side = node->box.high[k] - node->box.low[k];
            if (side > 0) share *= (high - low) / side;
        }
        sum += share * node->points;
    }
    return sum;
}

/* Adds the points of the listed blocks that are in a box. */
static brio_status add_points(const nearby *n, const brio_ball_box *box, brio_found *found) {
    brio_store_file f = {.file = -1};
    brio_set_point some[TILE_BLOCK];
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_store_open(&n->t->folder, "points", &f));
    for (size_t i = 0; i < n->count; i++) {
        const brio_tile_node *node = &n->t->node[n->block[i]];
        if (node->tile == TILE_FAR) continue;
        uint64_t row = node->place - n->t->first_place;
        BRIO_TRY(brio_store_read(&f, row * sizeof *some, some, node->points * sizeof *some));
        for (uint32_t p = 0; p < node->points; p++) {
            const double *x = some[p].record;
            some[p].name = node->place + p;
            if (overlap(&(brio_ball_box){{x[0], x[1], x[2]}, {x[0], x[1], x[2]}, 0}, box))
                BRIO_TRY(brio_found_add(found, &some[p]));
        }
        BRIO_TRY(brio_look(n->t->ctx, node->points));
    }
done:
    brio_store_close(&f);
    return status;
}

brio_status brio_tile_halo_box(brio_tiles *t, uint32_t tile, brio_ball_box *seen) {
    nearby n = {.t = t, .tile = tile, .root = (uint32_t)t->num_nodes - 1};
    brio_status status = BRIO_OK;
    *seen = t->tile[tile].home;
    BRIO_TRY(relist_blocks(&n, NULL));
    double width = first_width(&n);
    for (int i = 0; i < HALVINGS && width > 0; i++, width /= 2) {
        brio_ball_box wide = widened(&t->tile[tile].home, width);
        BRIO_TRY(relist_blocks(&n, &wide));
        if (!(points_in(&n, &wide) <= MOST_SHARE * t->tile[tile].points)) continue;
        *seen = wide;
        break;
    }
done:
    brio_release(t->ctx, n.block);
    return status;
}

brio_status brio_tile_halo_add(brio_tiles *t, uint32_t tile, uint32_t root, const brio_ball_box *box,
                               brio_found *found) {
    nearby n = {.t = t, .tile = tile, .root = root};
    brio_status status = relist_blocks(&n, box);
    if (status == BRIO_OK) status = add_points(&n, box, found);
    brio_release(t->ctx, n.block);
    return status;
}

brio_status brio_tile_halo_ranks(brio_tiles *t, const brio_ball_box *box, brio_tile_roots *ranks) {
    nearby n = {.t = t, .tile = TILE_OTHER, .root = (uint32_t)t->num_nodes - 1};
    brio_status status = relist_blocks(&n, box);
    for (size_t i = 0; status == BRIO_OK && i < n.count; i++)
        if (t->node[n.block[i]].tile == TILE_FAR) status = brio_tile_roots_add(t, ranks, t->node[n.block[i]].first);
    brio_release(t->ctx, n.block);
    return status;
}
