/* Which triangles of a closed surface span what no sample shows.
 *
 * To keep a triangle costs its area, in squares of the usual radius, times what its own radius says: twice the
 * logarithm of how often it is BRIDGE times the usual radius, between -1 and 20. So triangles that samples carry gain,
 * and wide ones cost. A triangle that looks another way than its samples costs more: it is the back of a sheet, close
 * behind it, or a step between two sheets. A rim costs its length. The triangles that stay are those of least cost: one
 * minimum cut, exact. It judges a hole as a whole, with the short triangles at its rim, and leaves no shards of a lid.
 * Rims along folds are free: where a surface turns back on itself, a back that nobody saw comes apart from its front.
 *
 * Triangles that go and meet across edges make a hole. Random samples of a closed surface have gaps, too: the widest of
 * a million circles is about 6 times the lower quarter, and a few are wider where samples happen to lie close beside
 * the gap. So the holes have to prove that the surface is open: one by a circle and an area that chance does not make,
 * or all by their area together. If they do, gaps that are merely unlikely stay open, too; otherwise all are filled.
 * Wrong labels make wide triangles, too: a hole counts as proof only if it is very large or the samples end at its rim
 * (hole_rim.c), and none does where walls are so thin that labels cannot be trusted.
 *
 * Based on: Boykov, Kolmogorov. An experimental comparison of min-cut/max-flow algorithms for energy minimization in
 *           vision. IEEE PAMI 2004 (the cut).
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.4 (holes left open where large
 *           balls bulge out of the surface). */
#include "reconstruct/open_surface/hole_cut.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "base/scale.h"
#include "mesh/twins.h"
#include "reconstruct/cocone/triangle.h"
#include "reconstruct/labels/max_flow.h"
#include "reconstruct/open_surface/hole_rim.h"
#include <math.h>
#include <string.h>

/* Chosen on scans of models that nothing else was measured on; flat between 2 and 3 (BRIDGE) and between 0 and 1
 * (RIM). */
static const double BRIDGE = 2.5, RIM = 0.3, LEAST_COST = -1, MOST_COST = 20;

/* A triangle costs AWAY times as much more as the mean cosine between its normal and what its samples take for the
 * outside is under FACING. Holes of over SIDEWAYS_AREA squares of the usual radius whose mean is under SIDEWAYS stay
 * open, if the surface is open. Chosen on scans of models that nothing else was measured on. */
static const double AWAY = 4, FACING = 0.5, SIDEWAYS = 0.5, SIDEWAYS_AREA = 5;

/* A triangle costs BLIND times as much more as the cosine under which its scanners see it is under GRAZING: no scanner
 * measures under less than 6 degrees, nor from behind. Chosen. */
static const double BLIND = 10, GRAZING = 0.1;

/* The cosine between normals across an edge from which on the edge is a fold. Chosen. */
static const double FOLD = -0.7;

/* A circle SURE times the usual one, over SURE_AREA squares of the usual radius, is a hole, if the surface is open. It
 * is if one hole has a circle PROOF times the usual, over PROOF_AREA, or if all holes together have PROOF_SHARE of the
 * area: random samples of closed models reached 0.4 %. Chosen on these and on the scans. */
static const double SURE = 5, SURE_AREA = 50, PROOF = 8, PROOF_AREA = 100, PROOF_SHARE = 0.05;

/* Holes under LARGE squares of the usual radius prove nothing where over BEYOND times as many samples are beyond the
 * rim as before it. Holes of scans show 0.02 to 0.15, those that wrong labels made 0.2 to 0.7. */
static const double LARGE = 1000, BEYOND = 0.2;

/* In an open surface, holes of under PROOF_AREA may be chance where samples are at random. They stay open only if their
 * circle is CHANCE times as wide as all but a hundredth of those outside of holes. Of random samples that is 6.5 times
 * the usual radius, as wide as their gaps were. Chosen. */
static const double CHANCE = 2.2, MOST = 0.99;

/* A cost of 1 in the units of the flow. Chosen: fine enough for rims of a hundredth of the usual radius. */
static const double UNIT = 4096, MOST_CAPACITY = 0x1p29, MOST_TERMINAL = 0x1p50;

/* Chosen. */
enum { FACES_A_THREAD = 1 << 12 };

typedef struct {
    const brio_triangle_net *net;
    const double *radius, *usual;
    const brio_hole_rule *rule;
    int64_t *terminal; /* #F */
    int32_t *rim;      /* 3 #F: of the edge of each half-edge */
    uint8_t *part;
    uint32_t *queue; /* the triangles of all holes, one hole after another */
    brio_hole_list *holes;
} cutting;

static double area_of(const brio_triangle_net *n, size_t f) {
    return brio_triangle_area(brio_net_corner(n, 3 * f), brio_net_corner(n, 3 * f + 1), brio_net_corner(n, 3 * f + 2));
}

/* Returns the radius from which on a triangle rather goes. */
static double bridge_of(const cutting *c, size_t f) {
    double usual = BRIDGE * c->usual[f];
    return c->rule->choice == BRIO_HOLES_WIDER ? fmin(usual, c->rule->most) : usual;
}

/* Returns what it costs to keep a triangle. */
static double cost_of(const cutting *c, size_t f) {
    const brio_triangle_net *n = c->net;
    double area = area_of(n, f);
    double evidence = fmax(LEAST_COST, 2 * log(c->radius[f] / bridge_of(c, f)));
    if (c->rule->choice == BRIO_HOLES_SEEN)
        evidence += AWAY * fmax(0, FACING - brio_net_facing(n, f)) + BLIND * fmax(0, GRAZING - brio_net_viewing(n, f));
    return fmin(evidence, MOST_COST) * (area / c->usual[f] / c->usual[f]);
}

/* Returns what a rim along a half-edge costs. */
static double rim_of(const cutting *c, uint32_t h) {
    const brio_triangle_net *n = c->net;
    double a[3], b[3], u[3];
    uint32_t twin = n->twin[h];
    brio_net_normal(n, h / 3, a);
    brio_net_normal(n, twin / 3, b);
    if (brio_dot(a, b) <= FOLD) return 0;
    for (int k = 0; k < 3; k++) u[k] = brio_net_corner(n, brio_next_corner(h))[k] - brio_net_corner(n, h)[k];
    return RIM * brio_length(u) / (0.5 * (c->usual[h / 3] + c->usual[twin / 3]));
}

static double rounded(double cost, double most) {
    return isnan(cost) ? 0 : rint(fmax(-most, fmin(UNIT * cost, most)));
}

static void price(void *user, size_t begin, size_t end, int thread) {
    const cutting *c = user;
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        c->terminal[f] = -(int64_t)rounded(cost_of(c, f), MOST_TERMINAL);
        for (size_t h = 3 * f; h < 3 * f + 3; h++)
            c->rim[h] = brio_net_has_twin(c->net, h) && h < c->net->twin[h]
                            ? (int32_t)rounded(rim_of(c, (uint32_t)h), MOST_CAPACITY)
                            : 0;
    }
}

static brio_status cut(cutting *c) {
    brio_status status = BRIO_OK;
    const brio_triangle_net *n = c->net;
    brio_flow flow = brio_flow_new(n->ctx);
    brio_flow_edge *edges = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(n->ctx, c->terminal, n->num_faces));
    BRIO_TRY(BRIO_ALLOC(n->ctx, c->rim, 3 * n->num_faces));
    BRIO_TRY(BRIO_ALLOC(n->ctx, edges, 3 * n->num_faces / 2));
    BRIO_TRY(brio_for(n->ctx, brio_threads(n->ctx, n->num_faces, FACES_A_THREAD), n->num_faces, price, c));
    for (uint32_t h = 0; h < 3 * n->num_faces; h++)
        if (c->rim[h] > 0) edges[count++] = (brio_flow_edge){h / 3, n->twin[h] / 3, c->rim[h]};
    BRIO_TRY(brio_flow_maximum(&flow, n->num_faces, edges, count, c->terminal, c->part));
    for (size_t f = 0; f < n->num_faces; f++)
        c->part[f] = c->part[f] == BRIO_FLOW_SINK ? BRIO_TRIANGLE_GONE : BRIO_TRIANGLE_SEEN;
done:
    brio_flow_free(&flow);
    brio_release(n->ctx, edges);
    return status;
}

/* --- holes as a whole --- */

/* Returns the bits of a number that is not negative: they sort as the numbers do. */
static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double usual_area_of(const cutting *c, size_t f) {
    return area_of(c->net, f) / c->usual[f] / c->usual[f];
}

/* Lists the triangles of the hole of f in the queue, from `begin` on. Returns where they end. */
static size_t list_hole(const cutting *c, uint32_t f, size_t begin) {
    size_t end = begin + 1;
    c->part[f] = BRIO_TRIANGLE_BRIDGE;
    c->queue[begin] = f;
    for (size_t i = begin; i < end; i++)
        for (uint32_t k = 0, g = c->queue[i]; k < 3; k++) {
            if (!brio_net_has_twin(c->net, 3 * (size_t)g + k)) continue;
            uint32_t other = c->net->twin[3 * g + k] / 3;
            if (c->part[other] != BRIO_TRIANGLE_GONE) continue;
            c->part[other] = BRIO_TRIANGLE_BRIDGE;
            c->queue[end++] = other;
        }
    return end;
}

/* The sums over the triangles of a hole, in units of this hole: what a hole is does not depend on how large triangles
 * are elsewhere. */
typedef struct {
    brio_sum_unit of_area, of_usual_area;
    int64_t area, facing, viewing, usual_area;
} hole_sums;

static hole_sums sum_hole(const cutting *c, size_t begin, size_t end) {
    double area = 0, usual = 0;
    for (size_t i = begin; i < end; i++) {
        area = fmax(area, area_of(c->net, c->queue[i]));
        if (isfinite(usual_area_of(c, c->queue[i]))) usual = fmax(usual, usual_area_of(c, c->queue[i]));
    }
    hole_sums s = {.of_area = brio_sum_unit_for(area, end - begin),
                   .of_usual_area = brio_sum_unit_for(usual, end - begin)};
    for (size_t i = begin; i < end; i++) {
        uint32_t f = c->queue[i];
        area = area_of(c->net, f);
        s.area += brio_in_units(s.of_area, area);
        s.facing += brio_in_units(s.of_area, area * brio_net_facing(c->net, f));
        s.viewing += brio_in_units(s.of_area, area * brio_net_viewing(c->net, f));
        s.usual_area += brio_in_units(s.of_usual_area, usual_area_of(c, f));
    }
    return s;
}

/* Measures the hole of the triangles from `begin` to `end` of the queue. */
static brio_hole measure_hole(const cutting *c, size_t begin, size_t end) {
    brio_hole hole = {.widest = c->queue[begin]};
    hole_sums s = sum_hole(c, begin, end);
    for (size_t i = begin; i < end; i++) {
        uint32_t f = c->queue[i];
        double ratio = c->radius[f] / c->usual[f];
        bool ties = ratio == hole.ratio && brio_net_hash(c->net, f) < brio_net_hash(c->net, hole.widest);
        if (ratio > hole.ratio || ties) hole.ratio = ratio, hole.widest = f;
        hole.open |= c->rule->choice == BRIO_HOLES_WIDER && c->radius[f] > c->rule->most;
    }
    hole.area = (double)s.area * s.of_area.unit;
    hole.usual_area = (double)s.usual_area * s.of_usual_area.unit;
    hole.facing = s.area > 0 ? (double)s.facing / (double)s.area : 1;
    hole.viewing = s.area > 0 ? (double)s.viewing / (double)s.area : 1;
    return hole;
}

/* Returns whether the triangles of a hole look another way than the samples at its rim: it is a step between sheets,
 * one behind the other, and no gap in a sheet. */
static bool is_sideways(const brio_hole *h) {
    return (h->facing < SIDEWAYS || h->viewing < 0) && h->usual_area > SIDEWAYS_AREA;
}

/* Measures what is beyond the rims of the holes that might prove that the surface is open.   end  of each hole in the
 * queue. */
static brio_status look_beyond(const cutting *c, const size_t *end) {
    brio_status status = BRIO_OK;
    brio_hole_list *l = c->holes;
    brio_rim_view view = {0};
    for (size_t i = 0; i < l->count; i++) {
        brio_hole *h = &l->hole[i];
        size_t begin = i ? end[i - 1] : 0;
        if (!h->unlikely || h->usual_area > LARGE) continue;
        if (!view.net) BRIO_TRY(brio_rim_view_new(c->net, c->usual, &view));
        BRIO_TRY(brio_rim_beyond(&view, c->queue + begin, end[i] - begin, c->part, &h->beyond));
    }
done:
    brio_rim_view_free(&view);
    return status;
}

/* Returns how often the holes make up what proves that the surface is open: one of them, or all unlikely ones by their
 * area. Holes behind whose rims samples go on prove nothing. */
static double proof_of(const cutting *c) {
    const brio_hole_list *l = c->holes;
    double proof = 0, greatest = 0;
    int64_t all = 0, unlikely = 0;
    for (size_t f = 0; f < c->net->num_faces; f++) greatest = fmax(greatest, area_of(c->net, f));
    brio_sum_unit unit = brio_sum_unit_for(greatest, c->net->num_faces);
    for (size_t f = 0; f < c->net->num_faces; f++) all += brio_in_units(unit, area_of(c->net, f));
    for (size_t i = 0; i < l->count; i++) {
        const brio_hole *h = &l->hole[i];
        if (!h->unlikely || h->beyond > BEYOND) continue;
        unlikely += (int64_t)(h->area / unit.unit + 0.5);
        proof = fmax(proof, fmin(h->ratio / PROOF, h->usual_area / PROOF_AREA));
    }
    return all > 0 ? fmax(proof, (double)unlikely / (PROOF_SHARE * (double)all)) : proof;
}

/* Finds how wide circles outside of unlikely holes are, against what is usual there: all but a hundredth are under it.
 *   end  of each hole in the queue. */
static brio_status find_widest(const cutting *c, const size_t *end, double *widest) {
    brio_status status = BRIO_OK;
    const brio_hole_list *l = c->holes;
    uint64_t *key = NULL, ratio;
    size_t count = 0;
    *widest = 0;
    BRIO_TRY(BRIO_ALLOC(c->net->ctx, key, c->net->num_faces));
    for (size_t f = 0; f < c->net->num_faces; f++)
        if (c->part[f] == BRIO_TRIANGLE_SEEN) key[count++] = bits_of(c->radius[f] / c->usual[f]);
    for (size_t i = 0, at = 0; i < l->count; i++)
        for (; at < end[i]; at++)
            if (!l->hole[i].unlikely) key[count++] = bits_of(c->radius[c->queue[at]] / c->usual[c->queue[at]]);
    if (count == 0) goto done;
    BRIO_TRY(brio_key_of_rank(c->net->ctx, key, count, (size_t)(MOST * (double)count), &ratio));
    memcpy(widest, &ratio, sizeof *widest);
done:
    brio_release(c->net->ctx, key);
    return status;
}

/* Returns whether a hole of a surface that is open stays open. */
static bool stays_open(const brio_hole *h, double widest) {
    return is_sideways(h) || (h->unlikely && (h->usual_area > PROOF_AREA || h->ratio > CHANCE * widest));
}

/* Decides which holes stay open.   end  of each hole in the queue. */
static brio_status decide(const cutting *c, const size_t *end) {
    brio_status status = BRIO_OK;
    brio_hole_list *l = c->holes;
    double widest;
    for (size_t i = 0; i < l->count; i++)
        l->hole[i].unlikely = l->hole[i].ratio > SURE && l->hole[i].usual_area > SURE_AREA;
    if (c->rule->choice != BRIO_HOLES_SEEN) goto done;
    if (c->rule->layered && !c->rule->proven) goto done;
    if (!c->rule->proven) BRIO_TRY(look_beyond(c, end));
    l->proof = proof_of(c);
    if (!c->rule->proven && l->proof <= 1) goto done;
    BRIO_TRY(find_widest(c, end, &widest));
    for (size_t i = 0; i < l->count; i++) l->hole[i].open |= stays_open(&l->hole[i], widest);
done:
    return status;
}

static brio_status list_holes(cutting *c) {
    brio_status status = BRIO_OK;
    brio_hole_list *l = c->holes;
    size_t *end = NULL, capacity = 0, listed = 0;
    for (uint32_t f = 0; f < c->net->num_faces; f++) {
        if (c->part[f] != BRIO_TRIANGLE_GONE) continue;
        BRIO_TRY(BRIO_RESERVE(l->ctx, l->hole, l->capacity, l->count + 1));
        BRIO_TRY(BRIO_RESERVE(l->ctx, end, capacity, l->count + 1));
        end[l->count] = list_hole(c, f, listed);
        l->hole[l->count] = measure_hole(c, listed, end[l->count]);
        listed = end[l->count++];
    }
    BRIO_TRY(decide(c, end));
    for (size_t i = 0, at = 0; i < l->count; i++)
        for (; at < end[i]; at++)
            c->part[c->queue[at]] = l->hole[i].open       ? BRIO_TRIANGLE_GONE
                                    : l->hole[i].unlikely ? BRIO_TRIANGLE_BRIDGE
                                                          : BRIO_TRIANGLE_SEEN;
done:
    brio_release(l->ctx, end);
    return status;
}

void brio_hole_list_free(brio_hole_list *holes) {
    brio_release(holes->ctx, holes->hole);
    holes->hole = NULL;
}

brio_status brio_cut_holes(const brio_triangle_net *n, const double *radius, const double *usual,
                           const brio_hole_rule *rule, uint8_t *part, brio_hole_list *holes) {
    brio_status status = BRIO_OK;
    cutting c = {.net = n, .radius = radius, .usual = usual, .rule = rule, .part = part, .holes = holes};
    *holes = (brio_hole_list){.ctx = n->ctx};
    BRIO_TRY(cut(&c));
    BRIO_TRY(BRIO_ALLOC(n->ctx, c.queue, n->num_faces));
    BRIO_TRY(list_holes(&c));
done:
    brio_release(n->ctx, c.terminal);
    brio_release(n->ctx, c.rim);
    brio_release(n->ctx, c.queue);
    return status;
}
