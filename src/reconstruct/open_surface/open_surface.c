/* A closed surface, opened where the samples end.
 *
 *   1. The usual radius of the circles round each triangle (face_sizes.c).
 *   2. The triangles that span gaps, by one minimum cut, and which gaps stay open, each as a whole (hole_cut.c).
 *   3. Crumbs go (small_pieces.c), and fans that meet others at one sample (single_fans.c).
 *   4. What of the rest no sample shows.
 *
 * docs/decisions/015-open-where-the-data-end.md says why the labels are not asked. */
#include "reconstruct/open_surface/open_surface.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/vector.h"
#include "base/scale.h"
#include "mesh/twins.h"
#include "reconstruct/cocone/triangle.h"
#include "reconstruct/open_surface/face_sizes.h"
#include "reconstruct/open_surface/single_fans.h"
#include "reconstruct/open_surface/small_pieces.h"
#include <math.h>
#include <string.h>

/* FAR: usual radii, as the contract says. GRID: parts of each side of a triangle whose far share is measured;
 * chosen. */
static const double FAR = 5;
enum { GRID = 12 };

/* Finds the median over the vertices of the distance to the nearest neighbour. */
static brio_status find_spacing(const brio_triangle_net *n, double *spacing) {
    brio_status status = BRIO_OK;
    uint64_t *key = NULL, middle;
    size_t count = 0;
    double value;
    *spacing = 0;
    BRIO_TRY(BRIO_ALLOC(n->ctx, key, n->num_points));
    memset(key, 0xff, n->num_points * sizeof *key);
    for (uint32_t h = 0; h < 3 * n->num_faces; h++) {
        uint32_t head = n->faces[brio_next_corner(h)];
        double square = brio_square_distance(brio_net_corner(n, h), brio_net_corner(n, brio_next_corner(h)));
        uint64_t k;
        memcpy(&k, &square, sizeof k); /* keys of numbers that are not negative sort as these do */
        if (k < key[n->faces[h]]) key[n->faces[h]] = k;
        if (k < key[head]) key[head] = k;
    }
    for (size_t p = 0; p < n->num_points; p++)
        if (key[p] != UINT64_MAX) key[count++] = key[p];
    if (count == 0) goto done;
    BRIO_TRY(brio_key_of_rank(n->ctx, key, count, count / 2, &middle));
    memcpy(&value, &middle, sizeof value);
    *spacing = sqrt(value);
done:
    brio_release(n->ctx, key);
    return status;
}

static double area_of(const brio_triangle_net *n, size_t f) {
    return brio_triangle_area(brio_net_corner(n, 3 * f), brio_net_corner(n, 3 * f + 1), brio_net_corner(n, 3 * f + 2));
}

/* Returns the share of a triangle that is farther than `most` from its corners. Its circle holds no other sample. */
static double far_share_of(const brio_triangle_net *n, size_t f, double most) {
    const double *corner[3];
    size_t count = 0, all = 0;
    for (size_t k = 0; k < 3; k++) corner[k] = brio_net_corner(n, 3 * f + k);
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID - i; j++) {
            double u = (i + 1.0 / 3) / GRID, v = (j + 1.0 / 3) / GRID, x[3];
            bool is_far = true;
            for (int k = 0; k < 3; k++)
                x[k] = corner[0][k] + u * (corner[1][k] - corner[0][k]) + v * (corner[2][k] - corner[0][k]);
            for (int k = 0; k < 3; k++) is_far &= brio_square_distance(x, corner[k]) > most * most;
            count += is_far, all++;
        }
    return (double)count / (double)all;
}

static void report_largest(const brio_triangle_net *n, const double *radius, const brio_hole *bridge,
                           brio_unseen *out) {
    size_t f = bridge->widest;
    out->largest_radius = radius[f];
    for (size_t k = 0; k < 3; k++)
        out->largest_centre[k] =
            (brio_net_corner(n, 3 * f)[k] + brio_net_corner(n, 3 * f + 1)[k] + brio_net_corner(n, 3 * f + 2)[k]) / 3;
}

static bool is_larger(const brio_triangle_net *n, const brio_hole *a, const brio_hole *b) {
    return a->area != b->area ? a->area > b->area : brio_net_hash(n, a->widest) < brio_net_hash(n, b->widest);
}

static void report_unseen(const brio_triangle_net *n, const double *radius, const double *usual, const uint8_t *part,
                          const brio_hole_list *holes, brio_unseen *out) {
    double greatest = 0;
    int64_t all = 0, bridges = 0, distant = 0;
    const brio_hole *largest = NULL;
    *out = (brio_unseen){.proof = holes->proof};
    for (size_t i = 0; i < holes->count; i++) {
        const brio_hole *h = &holes->hole[i];
        if (h->open)
            out->holes++;
        else if (h->unlikely && part[h->widest] != BRIO_TRIANGLE_GONE) {
            out->bridges++;
            if (!largest || is_larger(n, h, largest)) largest = h;
        }
    }
    for (size_t f = 0; f < n->num_faces; f++) greatest = fmax(greatest, area_of(n, f));
    brio_sum_unit unit = brio_sum_unit_for(greatest, n->num_faces);
    for (size_t f = 0; f < n->num_faces; f++) {
        if (part[f] == BRIO_TRIANGLE_GONE) continue;
        double area = area_of(n, f);
        all += brio_in_units(unit, area);
        if (part[f] == BRIO_TRIANGLE_BRIDGE) bridges += brio_in_units(unit, area);
        if (radius[f] > FAR * usual[f]) distant += brio_in_units(unit, area * far_share_of(n, f, FAR * usual[f]));
    }
    out->bridge_share = all > 0 ? (double)bridges / (double)all : 0;
    out->far_share = all > 0 ? (double)distant / (double)all : 0;
    if (largest) report_largest(n, radius, largest, out);
}

/* Moves the triangles that stay to the front, and what is known of them. Returns their number. */
static size_t move_faces(uint8_t *part, float *size, uint32_t *faces, size_t num_faces) {
    size_t kept = 0;
    for (size_t f = 0; f < num_faces; f++) {
        if (part[f] == BRIO_TRIANGLE_GONE) continue;
        for (size_t k = 0; k < 3; k++) faces[3 * kept + k] = faces[3 * f + k];
        size[kept] = size[f];
        part[kept++] = part[f] == BRIO_TRIANGLE_BRIDGE;
    }
    return kept;
}

static bool is_any_open(const brio_triangle_net *n, const brio_hole_list *holes) {
    for (size_t i = 0; i < holes->count; i++)
        if (holes->hole[i].open) return true;
    for (size_t h = 0; h < 3 * n->num_faces; h++)
        if (!brio_net_has_twin(n, h)) return true;
    return false;
}

brio_status brio_open_surface(const brio_sample_points *points, const brio_hole_rule *rule, uint32_t *faces,
                              size_t *num_faces, brio_triangle_facts *facts, brio_unseen *unseen) {
    brio_status status = BRIO_OK;
    brio_context *ctx = points->ctx;
    brio_triangle_net net = {.ctx = ctx};
    brio_hole_list holes = {.ctx = ctx};
    double *radius = NULL, *usual = NULL, spacing = 0;
    uint8_t *part = NULL;
    float *size = NULL;
    *facts = (brio_triangle_facts){NULL, NULL};
    BRIO_TRY(brio_triangle_net_new(ctx, points->points, points->num_points, faces, *num_faces, &net));
    net.outside = points->outside;
    net.scanner = points->scanner;
    BRIO_TRY(BRIO_ALLOC(ctx, radius, *num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, usual, *num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, part, *num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, size, *num_faces));
    BRIO_TRY(brio_face_sizes(&net, radius, usual));
    if (rule->choice == BRIO_HOLES_WIDER) BRIO_TRY(find_spacing(&net, &spacing));
    brio_hole_rule scaled = *rule;
    scaled.most *= spacing;
    BRIO_TRY(brio_cut_holes(&net, radius, usual, &scaled, part, &holes));
    if (is_any_open(&net, &holes)) {
        BRIO_TRY(brio_drop_small_pieces(&net, part));
        BRIO_TRY(brio_keep_single_fans(&net, part));
    }
    report_unseen(&net, radius, usual, part, &holes, unseen);
    for (size_t f = 0; f < *num_faces; f++) size[f] = (float)(radius[f] / usual[f]);
    *num_faces = move_faces(part, size, faces, *num_faces);
    *facts = (brio_triangle_facts){part, size};
    part = NULL, size = NULL;
done:
    brio_triangle_net_free(&net);
    brio_hole_list_free(&holes);
    brio_release(ctx, radius);
    brio_release(ctx, usual);
    brio_release(ctx, part);
    brio_release(ctx, size);
    return status;
}
