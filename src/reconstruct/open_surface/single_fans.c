/* One fan of triangles at each sample.
 *
 * A part of a manifold is a manifold with boundary, except at samples with several fans of triangles. There all
 * fans except the longest go, too, until nothing changes. The surface may have a boundary before: where the sides of
 * infinite tetrahedra were left out of it, a sample of the hull can have several fans from the start. */
#include "reconstruct/open_surface/single_fans.h"
#include "base/memory.h"
#include "base/sort.h"
#include "mesh/twins.h"

typedef struct {
    const brio_triangle_net *net;
    uint8_t *part;     /* #F: brio_triangle_part */
    size_t *first;     /* #P + 1, as brio_net_leaving lists them */
    uint32_t *leaving; /* 3 #F */
    uint32_t *queue;   /* points to look at */
    size_t size, capacity;
} thinning;

/* A run of triangles that stay, counterclockwise round a vertex from the triangle of half-edge `first` on. */
typedef struct {
    uint32_t first;
    size_t length;
} fan;

/* Return the next half-edge from the start of h, counterclockwise and clockwise, or BRIO_NO_HALF_EDGE where there is no
 * triangle that stays. */
static uint32_t staying(const thinning *o, uint32_t h) {
    return h != BRIO_NO_HALF_EDGE && o->part[h / 3] != BRIO_TRIANGLE_GONE ? h : BRIO_NO_HALF_EDGE;
}
static uint32_t turn(const thinning *o, uint32_t h) {
    return staying(o, o->net->twin[brio_previous_corner(h)]);
}
static uint32_t turn_back(const thinning *o, uint32_t h) {
    uint32_t twin = o->net->twin[h];
    return staying(o, twin == BRIO_NO_HALF_EDGE ? twin : brio_next_corner(twin));
}

/* Returns whether the triangle of h is the first one of a fan. Triangles all round a point make no fan. */
static bool begins_fan(const thinning *o, uint32_t h) {
    return o->part[h / 3] != BRIO_TRIANGLE_GONE && turn_back(o, h) == BRIO_NO_HALF_EDGE;
}

static fan fan_from(const thinning *o, uint32_t first) {
    fan f = {.first = first};
    for (uint32_t h = first; h != BRIO_NO_HALF_EDGE; h = turn(o, h)) f.length++;
    return f;
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
    size_t count = 0;
    for (size_t i = o->first[p]; i < o->first[p + 1]; i++) {
        if (!begins_fan(o, o->leaving[i])) continue;
        fan now = fan_from(o, o->leaving[i]);
        if (count++ == 0 || is_better(o, now, *best)) *best = now;
    }
    return count;
}

static brio_status push_corners(thinning *o, uint32_t face) {
    brio_status status = BRIO_RESERVE(o->net->ctx, o->queue, o->capacity, o->size + 3);
    for (size_t k = 0; status == BRIO_OK && k < 3; k++) o->queue[o->size++] = o->net->faces[3 * (size_t)face + k];
    return status;
}

/* Removes the triangles of all fans at a point except one. */
static brio_status keep_fan(thinning *o, uint32_t p, fan kept) {
    brio_status status = BRIO_OK;
    for (size_t i = o->first[p]; i < o->first[p + 1]; i++) {
        if (o->leaving[i] == kept.first || !begins_fan(o, o->leaving[i])) continue;
        for (uint32_t h = o->leaving[i], next; h != BRIO_NO_HALF_EDGE; h = next) {
            next = turn(o, h);
            o->part[h / 3] = BRIO_TRIANGLE_GONE;
            BRIO_TRY(push_corners(o, h / 3));
        }
    }
done:
    return status;
}

static int compare_points(uint32_t p, uint32_t q, const void *user) {
    (void)user;
    return (p > q) - (p < q);
}

static bool is_at_rim(const thinning *o, uint32_t f) {
    if (o->part[f] == BRIO_TRIANGLE_GONE) return true;
    for (size_t k = 0; k < 3; k++)
        if (!brio_net_has_twin(o->net, 3 * (size_t)f + k)) return true;
    return false;
}

/* Removes all fans except the best at each point. Works in rounds, each in the order of the points. */
static brio_status drop_small_fans(thinning *o) {
    brio_status status = BRIO_OK;
    fan best = {0};
    o->size = 0;
    for (uint32_t f = 0; f < o->net->num_faces; f++)
        if (is_at_rim(o, f)) BRIO_TRY(push_corners(o, f));
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
    BRIO_TRY(brio_net_leaving(n, &o.first, &o.leaving));
    BRIO_TRY(drop_small_fans(&o));
done:
    brio_release(n->ctx, o.first);
    brio_release(n->ctx, o.leaving);
    brio_release(n->ctx, o.queue);
    return status;
}
