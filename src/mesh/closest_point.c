/* Nearest points on a surface by a bounding-volume hierarchy.
 *
 * Building halves the triangles in place (quickselect), again and again, at the median of their centroids along the
 * longest side of the centroids' box. The search visits the nearer child first and skips every box that is not nearer
 * than the best point found. So the answer is exact for every tree.
 *
 * Based on: Rubin, Whitted. A 3-dimensional representation for fast rendering of complex scenes. SIGGRAPH 1980
 * (boxes). Hoare. Algorithm 65: find. Communications of the ACM 1961 (medians). Ericson. Real-time collision detection.
 * 2005, section 5.1.5 (triangles). */
#include "mesh/closest_point.h"
#include "base/rng.h"
#include "base/team.h"
#include "base/vector.h"
#include "mesh/cut_polygon.h"
#include <math.h>
#include <string.h>

enum {
    MOST_LEVELS = 64,
    TRIANGLES_A_THREAD = 1 << 12,
    SUBTREES_A_THREAD = 8, /* chosen: several, so that no thread waits long for the last subtree */
    LOOKED_AT = 1 << 14    /* chosen: most triangles of a subtree, so that a look comes between two in time */
};

/* A triangle while the tree is built: its centroid, in units of the mesh's box, and its index. */
typedef struct {
    float centroid[3];
    uint32_t triangle;
} item;

typedef struct {
    const double *vertices;
    uint32_t (*triangles)[3]; /* in the order of the mesh's faces */
    item *items;
    size_t count; /* number of triangles */
    brio_box *boxes;
    size_t first; /* first node of the level in work */
} builder;

/* The items of a node: low to high - 1. */
typedef struct {
    size_t low, high;
} range;

/* --- boxes --- */

static brio_box empty_box(void) {
    return (brio_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void box_add_point(brio_box *box, const double *p) {
    for (int k = 0; k < 3; k++) {
        if (p[k] < box->low[k]) box->low[k] = p[k];
        if (p[k] > box->high[k]) box->high[k] = p[k];
    }
}

static double box_distance(const brio_box *box, const double *p) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double below = box->low[k] - p[k], above = p[k] - box->high[k], d = below > above ? below : above;
        if (d > 0) square += d * d;
    }
    return square;
}

static void box_add_box(brio_box *box, const brio_box *other) {
    box_add_point(box, other->low);
    box_add_point(box, other->high);
}

/* --- building --- */

/* Reorders the items so that no item before `middle` has a larger coordinate than any item from `middle` on. Pivots
 * are at pseudorandom places, so that no fixed order of the triangles is slow. */
static void split_at(item *items, ptrdiff_t count, ptrdiff_t middle, int axis) {
    ptrdiff_t low = 0, high = count - 1;
    while (low < high) {
        size_t place = (size_t)(brio_mix((uint64_t)(low ^ high << 32)) % (uint64_t)(high - low + 1));
        float pivot = items[low + (ptrdiff_t)place].centroid[axis];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (items[i].centroid[axis] < pivot) i++;
            while (pivot < items[j].centroid[axis]) j--;
            if (i > j) break;
            item swap = items[i];
            items[i++] = items[j];
            items[j--] = swap;
        }
        if (middle > j) low = i;
        if (middle < i) high = j;
    }
}

static int longest_axis(const item *items, size_t count) {
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fminf(low[k], items[i].centroid[k]);
            high[k] = fmaxf(high[k], items[i].centroid[k]);
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    return axis;
}

static size_t middle_of(range r) {
    return r.low + (r.high - r.low) / 2;
}

/* Splits the items of a node between its two children. */
static void split_node(const builder *b, range r) {
    item *items = b->items + r.low;
    size_t count = r.high - r.low;
    split_at(items, (ptrdiff_t)count, (ptrdiff_t)(middle_of(r) - r.low), longest_axis(items, count));
}

/* Sets the box of a node to the union of its children's boxes. */
static void join_children(const builder *b, size_t node) {
    brio_box box = b->boxes[2 * node + 1];
    box_add_box(&box, &b->boxes[2 * node + 2]);
    b->boxes[node] = box;
}

static void build_leaf(const builder *b, size_t node, range r) {
    brio_box box = empty_box();
    for (size_t i = r.low; i < r.high; i++)
        for (int k = 0; k < 3; k++)
            box_add_point(&box, b->vertices + 3 * (size_t)b->triangles[b->items[i].triangle][k]);
    b->boxes[node] = box;
}

static void build_node(const builder *b, size_t node, range r) {
    if (r.high - r.low <= BRIO_LEAF_TRIANGLES) {
        build_leaf(b, node, r);
        return;
    }
    split_node(b, r);
    build_node(b, 2 * node + 1, (range){r.low, middle_of(r)});
    build_node(b, 2 * node + 2, (range){middle_of(r), r.high});
    join_children(b, node);
}

/* Returns the range of a node. The bits of node + 1 below the highest one are the path from the root: 0 for the lower
 * child, 1 for the upper child. */
static range range_of(const builder *b, size_t node) {
    range r = {0, b->count};
    int bit = 0;
    while ((node + 1) >> bit > 1) bit++;
    while (bit-- > 0) {
        if ((node + 1) >> bit & 1)
            r.low = middle_of(r);
        else
            r.high = middle_of(r);
    }
    return r;
}

/* Splits some nodes of the level in work. */
static void split_nodes(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) split_node(b, range_of(b, b->first + i));
}

/* Builds the subtrees of some nodes of the level in work. */
static void build_subtrees(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) build_node(b, b->first + i, range_of(b, b->first + i));
}

/* Calls body on the nodes of a level; one node is one job. */
static brio_status for_level(brio_context *ctx, builder *b, size_t nodes, brio_part_fn body) {
    b->first = nodes - 1;
    return brio_for_chunks(ctx, brio_threads(ctx, nodes, 1), nodes, 1, body, b);
}

/* Splits level after level until each thread has SUBTREES_A_THREAD nodes, then builds the subtrees. A node split here
 * has at least TRIANGLES_A_THREAD / SUBTREES_A_THREAD triangles, so no leaf is split. A split depends only on the
 * node's items, so the tree does not depend on the number of threads. */
static brio_status build_tree(brio_context *ctx, builder *b) {
    size_t threads = (size_t)brio_threads(ctx, b->count, TRIANGLES_A_THREAD), nodes = 1;
    size_t wanted = threads > 1 ? SUBTREES_A_THREAD * threads : 1;
    if (wanted < b->count / LOOKED_AT) wanted = b->count / LOOKED_AT;
    for (; nodes < wanted; nodes *= 2) BRIO_FORWARD(for_level(ctx, b, nodes, split_nodes));
    BRIO_FORWARD(for_level(ctx, b, nodes, build_subtrees));
    for (size_t node = nodes - 1; node-- > 0;) join_children(b, node);
    return BRIO_OK;
}

static brio_status cut_faces(brio_context *ctx, const brio_mesh *mesh, uint32_t (**triangles)[3], size_t *count) {
    brio_status status = BRIO_OK;
    const uint64_t *offsets = mesh->face_offsets;
    uint32_t *room = NULL;
    size_t n = 0, most = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        size_t corners = (size_t)(offsets[f + 1] - offsets[f]);
        if (corners > 2) n += corners - 2;
        if (corners > most) most = corners;
    }
    BRIO_REQUIRE(ctx, mesh->num_faces > 0, BRIO_ERR_ARGUMENT, "a mesh without faces has no surface");
    BRIO_REQUIRE(ctx, n > 0, BRIO_ERR_ARGUMENT, "no face of the mesh has three corners, so it has no surface");
    BRIO_TRY(BRIO_ALLOC(ctx, *triangles, n));
    BRIO_TRY(BRIO_ALLOC(ctx, room, most));
    *count = n;
    n = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        size_t corners = (size_t)(offsets[f + 1] - offsets[f]);
        if (corners < 3) continue;
        brio_cut_polygon(mesh->vertices, mesh->face_vertices + offsets[f], corners, room, *triangles + n);
        n += corners - 2;
    }
done:
    brio_release(ctx, room);
    return status;
}

static void fill_items(const builder *b, size_t count) {
    brio_box box = empty_box();
    double centre[3], scale = 0;
    for (size_t t = 0; t < count; t++)
        for (int k = 0; k < 3; k++) box_add_point(&box, b->vertices + 3 * (size_t)b->triangles[t][k]);
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * box.low[k] + 0.5 * box.high[k];
        scale = fmax(scale, 0.5 * box.high[k] - 0.5 * box.low[k]);
    }
    if (scale == 0) scale = 1;
    for (size_t t = 0; t < count; t++) {
        b->items[t].triangle = (uint32_t)t;
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int c = 0; c < 3; c++) sum += (b->vertices[3 * (size_t)b->triangles[t][c] + k] - centre[k]) / scale;
            b->items[t].centroid[k] = (float)(sum / 3);
        }
    }
}

/* Returns the number of nodes of the complete binary tree whose deepest level holds the deepest leaves. */
static size_t count_nodes(size_t triangles) {
    size_t nodes = 1;
    for (size_t most = triangles; most > BRIO_LEAF_TRIANGLES; most -= most / 2) nodes = 2 * nodes + 1;
    return nodes;
}

brio_status brio_triangle_tree_new(brio_context *ctx, const brio_mesh *mesh, brio_triangle_tree *out) {
    brio_status status = BRIO_OK;
    builder b = {.vertices = mesh->vertices};
    size_t count = 0;
    *out = (brio_triangle_tree){.vertices = mesh->vertices};
    BRIO_TRY(cut_faces(ctx, mesh, &b.triangles, &count));
    BRIO_TRY(BRIO_ALLOC(ctx, b.items, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->triangles, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->boxes, count_nodes(count)));
    out->num_triangles = b.count = count;
    b.boxes = out->boxes;
    fill_items(&b, count);
    BRIO_TRY(build_tree(ctx, &b));
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) out->triangles[i][k] = b.triangles[b.items[i].triangle][k];
done:
    brio_release(ctx, b.triangles);
    brio_release(ctx, b.items);
    return status;
}

void brio_triangle_tree_free(brio_context *ctx, brio_triangle_tree *tree) {
    brio_release(ctx, tree->triangles);
    brio_release(ctx, tree->boxes);
    *tree = (brio_triangle_tree){0};
}

/* --- one triangle --- */

/* Writes the point of segment ab nearest to p; a may equal b. */
static void closest_on_segment(const double *a, const double *b, const double *p, double *closest) {
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, w[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
    double length = brio_dot(u, u), t = length > 0 ? fmin(fmax(brio_dot(w, u) / length, 0), 1) : 0;
    for (int k = 0; k < 3; k++) closest[k] = t < 1 ? a[k] + t * u[k] : b[k];
}

/* Writes the nearest point of the sides of a triangle, which may be degenerate. */
static void closest_on_sides(const double *a, const double *b, const double *c, const double *p, double *closest) {
    double other[3];
    closest_on_segment(a, b, p, closest);
    closest_on_segment(b, c, p, other);
    if (brio_square_distance(p, other) < brio_square_distance(p, closest)) memcpy(closest, other, sizeof other);
    closest_on_segment(c, a, p, other);
    if (brio_square_distance(p, other) < brio_square_distance(p, closest)) memcpy(closest, other, sizeof other);
}

static void walk_along(const double *a, const double *u, double x, double *closest) {
    for (int k = 0; k < 3; k++) closest[k] = a[k] + x * u[k];
}

/* Writes the point of triangle abc nearest to p. The signs of products of the sides with the ways to p tell whether it
 * is a corner, on a side, or inside. Triangles without area have sides only. */
static void closest_on_triangle(const double *a, const double *b, const double *c, const double *p, double *closest) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = p[k] - a[k];
    double uu = brio_dot(u, u), uv = brio_dot(u, v), vv = brio_dot(v, v), wu = brio_dot(w, u), wv = brio_dot(w, v);
    double determinant = uu * vv - uv * uv, s = vv * wu - uv * wv, t = uu * wv - uv * wu;
    double bu = wu - uu, bv = wv - uv, cu = wu - uv, cv = wv - vv; /* of p - b and p - c with u and v */
    if (!(determinant > 0))
        closest_on_sides(a, b, c, p, closest);
    else if (s >= 0 && t >= 0 && s + t <= determinant)
        for (int k = 0; k < 3; k++) closest[k] = a[k] + s / determinant * u[k] + t / determinant * v[k];
    else if (wu <= 0 && wv <= 0)
        memcpy(closest, a, 3 * sizeof *closest);
    else if (bu >= 0 && bv <= bu)
        memcpy(closest, b, 3 * sizeof *closest);
    else if (cv >= 0 && cu <= cv)
        memcpy(closest, c, 3 * sizeof *closest);
    else if (t <= 0 && wu >= 0 && bu <= 0)
        walk_along(a, u, wu / uu, closest);
    else if (s <= 0 && wv >= 0 && cv <= 0)
        walk_along(a, v, wv / vv, closest);
    else
        closest_on_sides(a, b, c, p, closest);
}

void brio_closest_on_corners(const double *const corners[3], const double *p, double *closest) {
    closest_on_triangle(corners[0], corners[1], corners[2], p, closest);
}

void brio_closest_on_triangle(const brio_triangle_tree *tree, size_t triangle, const double *p, double *closest) {
    const uint32_t *c = tree->triangles[triangle];
    closest_on_triangle(tree->vertices + 3 * (size_t)c[0], tree->vertices + 3 * (size_t)c[1],
                        tree->vertices + 3 * (size_t)c[2], p, closest);
}

/* --- searching --- */

typedef struct {
    size_t node, low, high; /* the range of triangles */
    double distance;        /* square of the distance to the box */
} visit;

static visit visit_child(const brio_triangle_tree *tree, const visit *parent, int upper, const double *p) {
    size_t middle = parent->low + (parent->high - parent->low) / 2;
    visit child = {2 * parent->node + 1 + (size_t)upper, upper ? middle : parent->low, upper ? parent->high : middle,
                   0};
    child.distance = box_distance(&tree->boxes[child.node], p);
    return child;
}

double brio_closest_within(const brio_triangle_tree *tree, const double *p, double bound, double *closest,
                           size_t *triangle) {
    visit stack[MOST_LEVELS];
    int depth = 0;
    double best = bound, q[3];
    stack[depth++] = (visit){0, 0, tree->num_triangles, 0};
    while (depth > 0) {
        visit v = stack[--depth];
        if (v.distance >= best) continue;
        if (v.high - v.low > BRIO_LEAF_TRIANGLES) {
            visit lower = visit_child(tree, &v, 0, p), upper = visit_child(tree, &v, 1, p);
            bool lower_first = lower.distance <= upper.distance;
            stack[depth++] = lower_first ? upper : lower;
            stack[depth++] = lower_first ? lower : upper;
            continue;
        }
        for (size_t t = v.low; t < v.high; t++) {
            brio_closest_on_triangle(tree, t, p, q);
            double distance = brio_square_distance(p, q);
            if (distance >= best) continue;
            best = distance;
            *triangle = t;
            memcpy(closest, q, sizeof q);
        }
    }
    return best < bound ? best : INFINITY;
}

/* Returns the square of the distance of a triangle. */
static double distance_to(const brio_triangle_tree *tree, size_t triangle, const double *p) {
    double q[3];
    brio_closest_on_triangle(tree, triangle, p, q);
    return brio_square_distance(p, q);
}

bool brio_is_within(const brio_triangle_tree *tree, const double *p, double bound, size_t *triangle) {
    visit stack[MOST_LEVELS];
    int depth = 0;
    if (distance_to(tree, *triangle, p) < bound) return true;
    stack[depth++] = (visit){0, 0, tree->num_triangles, 0};
    while (depth > 0) {
        visit v = stack[--depth];
        if (v.high - v.low > BRIO_LEAF_TRIANGLES) {
            visit lower = visit_child(tree, &v, 0, p), upper = visit_child(tree, &v, 1, p);
            bool lower_first = lower.distance <= upper.distance;
            const visit *first = lower_first ? &lower : &upper, *then = lower_first ? &upper : &lower;
            if (then->distance < bound) stack[depth++] = *then;
            if (first->distance < bound) stack[depth++] = *first;
            continue;
        }
        for (size_t t = v.low; t < v.high; t++)
            if (distance_to(tree, t, p) < bound) {
                *triangle = t;
                return true;
            }
    }
    return false;
}

double brio_closest_point(const brio_triangle_tree *tree, const double *p, double *closest, size_t *triangle) {
    *triangle = 0;
    memcpy(closest, tree->vertices + 3 * (size_t)tree->triangles[0][0], 3 * sizeof *closest);
    return brio_closest_within(tree, p, INFINITY, closest, triangle);
}
