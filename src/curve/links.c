/* Which Delaunay edges are links of the curve: those that both ends wish.
 *
 * A point wishes the two neighbours through which a curve passes it best: near ones, one in either direction. So a line
 * is followed past another one that is nearer than its own points, and both arms of a sharp corner reach its tip. Two
 * points that wish each other are linked. A point with two links is taken, and those that wished it wish again, among
 * the neighbours that are still free; so do points with one link. Each link takes a place of two points for good, and a
 * point wishes again only when a neighbour is taken: all is done in time linear in the edges.
 *
 * Based on: Dey, Kumar. A simple provable algorithm for curve reconstruction. SODA 1999: an edge to the nearest point,
 * and one to the nearest point on its other side.
 *           Dey, Wenger. Fast reconstruction of curves with sharp corners. IJCGA 2002: the direction of an edge counts
 *           beside
 * its length, and both ends judge.
 * Differs from the papers: they take an edge by thresholds of its angle with the normal, which the Voronoi cell shows,
 * and of the length of its Voronoi edge; here edges compete for places, and no threshold decides. */
#include "base/memory.h"
#include "curve/work.h"
#include <string.h>

/* MOST: neighbours that a point looks at, the nearest ones. Chosen; bounds the time where a point has many. */
enum { MOST = 16 };

/* What a turn costs: the way counts 1/sin^4 times, of half the angle between the two directions, but at most this many
 * times. Chosen: beside a tip of 20 degrees, where the other arm is three times as near as the tip, the way to the tip
 * is cheaper. */
static const double SHARPEST = 16;

/* A way over this many times the distance of the nearest neighbour leads past it to something else: the nearest one is
 * wished alone. Chosen, as above. */
static const double FAR_WAY = 8;

/* A neighbour, its distance and its direction. */
typedef struct {
    uint32_t row;
    double length, direction[2];
} neighbour;

/* Returns what a way over the point costs, from one neighbour to the other. */
static double cost_of(const neighbour *u, const neighbour *v) {
    double x = u->direction[0] - v->direction[0], y = u->direction[1] - v->direction[1];
    double square = 0.25 * (x * x + y * y), factor = 1 / (square * square);
    return (u->length + v->length) * (factor < SHARPEST ? factor : SHARPEST);
}

/* Inserts a neighbour into a list that is sorted by distance, and drops the last one of a full list. */
static int insert(neighbour *list, int count, const neighbour *n) {
    int at = count;
    while (at > 0 && n->length < list[at - 1].length) at--;
    if (at == MOST) return count;
    if (count == MOST) count--;
    memmove(list + at + 1, list + at, (size_t)(count - at) * sizeof *list);
    list[at] = *n;
    return count + 1;
}

/* Lists the nearest neighbours of p that have a place free. */
static int list_free(const brio_curve_work *w, uint32_t p, neighbour *list) {
    int count = 0;
    for (uint32_t k = w->start[p]; k < w->start[p + 1]; k++) {
        neighbour n = {.row = w->neighbour[k]};
        bool linked = w->link[p][0] == n.row || w->link[p][1] == n.row;
        if (w->gap[k] || linked || brio_curve_degree(w, n.row) == 2) continue;
        n.length = brio_curve_direction(w, p, n.row, n.direction);
        count = insert(list, count, &n);
    }
    return count;
}

/* Writes what p wishes, for its free places. */
static void wish(const brio_curve_work *w, uint32_t p, uint32_t out[2]) {
    neighbour list[MOST], own = {.row = w->link[p][0]};
    int count = list_free(w, p, list);
    double best = INFINITY;
    bool linked = own.row != BRIO_NO_ROW;
    out[0] = count ? list[0].row : BRIO_NO_ROW;
    out[1] = BRIO_NO_ROW;
    if (linked)
        own.length = brio_curve_direction(w, p, own.row, own.direction);
    else if (count)
        best = FAR_WAY * list[0].length;
    for (int i = 0; i < count; i++)
        for (int j = linked ? i : i + 1; j < (linked ? i + 1 : count); j++) {
            double cost = cost_of(&list[i], linked ? &own : &list[j]);
            if (!(cost < best)) continue;
            best = cost;
            out[0] = list[i].row;
            out[1] = linked ? BRIO_NO_ROW : list[j].row;
        }
}

/* Adds a row to the list unless it is there or has no place free. */
static void list_row(brio_curve_work *w, uint32_t p, uint32_t *rows, size_t *count) {
    if (w->listed[p] || brio_curve_degree(w, p) == 2) return;
    w->listed[p] = 1;
    rows[(*count)++] = p;
}

static void link_rows(brio_curve_work *w, uint32_t p, uint32_t q) {
    w->link[p][w->link[p][0] != BRIO_NO_ROW] = q;
    w->link[q][w->link[q][0] != BRIO_NO_ROW] = p;
    w->num_links++;
}

static bool wishes(const brio_curve_work *w, uint32_t p, uint32_t q) {
    return w->wished[p][0] == q || w->wished[p][1] == q;
}

/* Links p with the rows that it wishes and that wish it. */
static void link_wished(brio_curve_work *w, uint32_t p) {
    for (int k = 0; k < 2; k++) {
        uint32_t q = w->wished[p][k];
        if (q == BRIO_NO_ROW || !wishes(w, q, p) || w->link[p][0] == q || w->link[p][1] == q) continue;
        if (brio_curve_degree(w, p) == 2 || brio_curve_degree(w, q) == 2) continue;
        link_rows(w, p, q);
        w->changed[w->num_changed++] = p, w->changed[w->num_changed++] = q;
    }
}

/* Lists the rows that are to wish again: those that were linked, from `first` on, and those whose neighbours were
 * taken. */
static size_t list_changed(brio_curve_work *w, size_t first, uint32_t *rows) {
    size_t count = 0;
    for (size_t i = first; i < w->num_changed; i++) {
        uint32_t p = w->changed[i];
        list_row(w, p, rows, &count);
        if (brio_curve_degree(w, p) < 2) continue;
        for (uint32_t k = w->start[p]; k < w->start[p + 1]; k++) list_row(w, w->neighbour[k], rows, &count);
    }
    return count;
}

brio_status brio_curve_link(brio_curve_work *w, uint32_t *rows, size_t count) {
    w->num_changed = 0;
    while (count) {
        size_t first = w->num_changed;
        for (size_t i = 0; i < count; i++) {
            wish(w, rows[i], w->wished[rows[i]]);
            BRIO_FORWARD(brio_look(w->ctx, 1));
        }
        for (size_t i = 0; i < count; i++) link_wished(w, rows[i]);
        for (size_t i = 0; i < count; i++) w->listed[rows[i]] = 0;
        count = list_changed(w, first, rows);
    }
    return BRIO_OK;
}
