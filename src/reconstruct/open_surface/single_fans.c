/* One fan of triangles at each sample.
 *
 * A part of a manifold is a manifold with boundary, except at samples with several fans of triangles. There all
 * fans except the longest go, too, until nothing changes. */
#include "reconstruct/open_surface/single_fans.h"
#include "base/memory.h"
#include "base/sort.h"
#include "mesh/twins.h"

typedef struct {
    const brio_triangle_net *net;
    uint8_t *part;   /* #F: brio_triangle_part */
    uint32_t *start; /* #P: a half-edge from each point that has one */
    uint32_t *queue; /* points to look at */
    size_t size, capacity;
} thinning;

/* A run of triangles that stay, counterclockwise round a vertex from the triangle of half-edge `first` on. */
typedef struct {
    uint32_t first;
    size_t length;
} fan;

/* Return the next half-edge from the start of h, counterclockwise and clockwise, or BRIO_NO_HALF_EDGE. */
static uint32_t turn(const thinning *o, uint32_t h) {
    return o->net->twin[brio_previous_corner(h)];
}
static uint32_t turn_back(const thinning *o, uint32_t h) {
    uint32_t twin = o->net->twin[h];
    return twin == BRIO_NO_HALF_EDGE ? twin : brio_next_corner(twin);
}

static bool goes(const thinning *o, uint32_t h) {
    return o->part[h / 3] == BRIO_TRIANGLE_GONE;
}

/* Returns the half-edge from which turning meets every fan at a point in one part: at a rim, or of a triangle that goes. */
static uint32_t begin_of(const thinning *o, uint32_t p) {
    uint32_t h = o->start[p], back;
    while ((back = turn_back(o, h)) != BRIO_NO_HALF_EDGE) {
        h = back;
        if (goes(o, h) || h == o->start[p]) break;
    }
    return h;
}

/* Returns the point at which the fan begins. */
static uint32_t rim_of(const thinning *o, fan f) {
    return o->net->faces[brio_next_corner(f.first)];
}

static bool is_better(const thinning *o, fan a, fan b) {
    return a.length != b.length ? a.length > b.length : rim_of(o, a) < rim_of(o, b);
}

/* Counts the fans at a point, and finds the best of them. */
static size_t count_fans(const thinning *o, uint32_t p, fan *best) {
    uint32_t begin = begin_of(o, p), h = begin;
    size_t count = 0;
    fan now = {0};
    do {
        uint32_t next = turn(o, h);
        bool last = next == BRIO_NO_HALF_EDGE || next == begin;
        if (!goes(o, h) && now.length++ == 0) now.first = h;
        if ((goes(o, h) || last) && now.length > 0) {
            if (count++ == 0 || is_better(o, now, *best)) *best = now;
            now.length = 0;
        }
        h = last ? begin : next;
    } while (h != begin);
    return count;
}

static brio_status push_corners(thinning *o, uint32_t face) {
    brio_status status = BRIO_RESERVE(o->net->ctx, o->queue, o->capacity, o->size + 3);
    for (size_t k = 0; status == BRIO_OK && k < 3; k++) o->queue[o->size++] = o->net->faces[3 * (size_t)face + k];
    return status;
}

/* Removes the triangles at a point outside one fan. */
static brio_status keep_fan(thinning *o, uint32_t p, fan kept) {
    brio_status status = BRIO_OK;
    uint32_t begin = begin_of(o, p), h = begin;
    size_t left = 0; /* of the fan */
    do {
        if (h == kept.first) left = kept.length;
        bool stays = left > 0 || goes(o, h);
        left -= left > 0;
        uint32_t next = turn(o, h);
        if (!stays) {
            o->part[h / 3] = BRIO_TRIANGLE_GONE;
            BRIO_TRY(push_corners(o, h / 3));
        }
        h = next == BRIO_NO_HALF_EDGE ? begin : next;
    } while (h != begin);
done:
    return status;
}

static int compare_points(uint32_t p, uint32_t q, const void *user) {
    (void)user;
    return (p > q) - (p < q);
}

/* Removes all fans except the best at each point. Works in rounds, each in the order of the points. */
static brio_status drop_small_fans(thinning *o) {
    brio_status status = BRIO_OK;
    fan best = {0};
    o->size = 0;
    for (uint32_t f = 0; f < o->net->num_faces; f++)
        if (o->part[f] == BRIO_TRIANGLE_GONE) BRIO_TRY(push_corners(o, f));
    for (size_t begin = 0, end; begin < o->size; begin = end) {
        end = o->size;
        brio_sort_indices(o->queue + begin, end - begin, compare_points, NULL);
        for (size_t n = begin; n < end; n++)
            if (count_fans(o, o->queue[n], &best) > 1) BRIO_TRY(keep_fan(o, o->queue[n], best));
    }
done:
    return status;
}

brio_status brio_keep_single_fans(const brio_triangle_net *n, uint8_t *part) {
    brio_status status = BRIO_OK;
    thinning o = {.net = n, .part = part};
    BRIO_TRY(BRIO_ALLOC(n->ctx, o.start, n->num_points));
    for (uint32_t h = 0; h < 3 * n->num_faces; h++) o.start[n->faces[h]] = h;
    BRIO_TRY(drop_small_fans(&o));
done:
    brio_release(n->ctx, o.start);
    brio_release(n->ctx, o.queue);
    return status;
}
