/* Voronoi and power cells: in a box they fill it, each one has its site's faces in pairs, and hostile points, boxes and planes
 * are answered. */
#include "points_input.h"

enum { MOST = 20 };

static void expect_arrays(const brio_cells *c, const brio_cells_options *o, size_t n) {
    for (size_t i = 0; i < c->num_cells; i++) {
        FUZZ_EXPECT(c->site[i] < n && (!i || c->site[i - 1] < c->site[i]), "cell %zu", i);
        FUZZ_EXPECT(c->volume[i] >= 0, "cell %zu: volume %g", i, c->volume[i]);
        FUZZ_EXPECT(o->no_areas || c->area[i] >= 0, "cell %zu: area %g", i, c->area[i]);
    }
    if (!c->face_offsets || !c->num_cells) return;
    uint64_t faces = c->face_offsets[c->num_cells];
    for (uint64_t f = 0; f < faces; f++) {
        FUZZ_EXPECT(c->face_neighbours[f] < (int64_t)n, "face %llu", (unsigned long long)f);
        FUZZ_EXPECT(c->face_areas[f] >= 0, "face %llu: area %g", (unsigned long long)f, c->face_areas[f]);
        for (uint64_t i = o->vertices ? c->corner_offsets[f] : 0; o->vertices && i < c->corner_offsets[f + 1]; i++)
            FUZZ_EXPECT(c->face_vertices[i] < c->num_vertices, "face %llu", (unsigned long long)f);
    }
}

/* A face between two cells is listed in both. Without a region this is decided exactly. */
static void expect_pairs(const brio_cells *c) {
    for (size_t i = 0; i < c->num_cells; i++)
        for (uint64_t f = c->face_offsets[i]; f < c->face_offsets[i + 1]; f++) {
            size_t j = 0, found = 0;
            FUZZ_EXPECT(c->face_neighbours[f] >= 0, "a wall without a region");
            while (j < c->num_cells && c->site[j] != c->face_neighbours[f]) j++;
            FUZZ_EXPECT(j < c->num_cells, "cell %zu: a neighbour without a cell", i);
            for (uint64_t g = c->face_offsets[j]; g < c->face_offsets[j + 1]; g++)
                found += c->face_neighbours[g] == c->site[i];
            FUZZ_EXPECT(found == 1, "cells %zu and %zu: %zu", i, j, found);
        }
}

/* Small integers in a box about them. */
static void small_cells(brio_context *ctx, fuzz_input *in, brio_cells_options *o) {
    static const double boxes[][6] = {
        {-1, -1, -1, 4, 4, 4}, {0, 0, 0, 3, 3, 3}, {-9, 1, 1, 9, 2, 2}, {5, 5, 5, 6, 7, 8}};
    site_set s;
    double points[3 * MOST], weights[MOST];
    brio_cells *c;
    fuzz_sites(in, MOST, &s);
    for (size_t i = 0; i < s.n; i++) {
        for (size_t k = 0; k < 3; k++) points[3 * i + k] = (double)s.p[i].x[k];
        weights[i] = (double)s.p[i].w;
    }
    size_t box = fuzz_below(in, 8);
    o->box = box < 4 ? boxes[box] : NULL;
    FUZZ_EXPECT(brio_voronoi_cells(ctx, NULL, points, s.weighted ? weights : NULL, s.n, o, &c) == BRIO_OK, "%s",
                brio_message(ctx));
    expect_arrays(c, o, s.n);
    if (o->box && s.n)
        FUZZ_EXPECT(fabs(c->volume_sum - c->region_volume) < 1e-9 * c->region_volume, "%.17g of %.17g", c->volume_sum,
                    c->region_volume);
    if (!o->box && c->face_offsets) expect_pairs(c);
    brio_cells_free(c);
}

/* Any doubles, box and planes. */
static void hostile_cells(brio_context *ctx, fuzz_input *in, brio_cells_options *o) {
    double points[3 * MOST], weights[MOST], box[6], planes[16];
    size_t n = fuzz_below(in, MOST + 1);
    bool weighted = fuzz_flag(in);
    brio_cells *c;
    if (fuzz_flag(in)) o->box = box;
    o->num_planes = fuzz_below(in, 5), o->planes = planes;
    for (size_t i = 0; i < 6; i++) box[i] = fuzz_double(in);
    for (size_t i = 0; i < 4 * o->num_planes; i++) planes[i] = fuzz_double(in);
    for (size_t i = 0; i < 3 * n; i++) points[i] = fuzz_double(in);
    for (size_t i = 0; i < n; i++) weights[i] = weighted ? fuzz_double(in) : 0;
    brio_status status = brio_voronoi_cells(ctx, NULL, points, weighted ? weights : NULL, n, o, &c);
    fuzz_expect_failure(status);
    FUZZ_EXPECT(status == BRIO_OK || status == BRIO_ERR_ARGUMENT || status == BRIO_ERR_NOT_FINITE ||
                    status == BRIO_ERR_NO_ANSWER,
                "%s", brio_message(ctx));
    if (c) expect_arrays(c, o, n);
    brio_cells_free(c);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    brio_cells_options o = {0};
    uint8_t bits = fuzz_byte(&in);
    o.no_areas = !(bits & 1), o.no_centroids = !(bits >> 1 & 1), o.no_faces = !(bits >> 2 & 1);
    o.vertices = bits >> 3 & 1;
    brio_context_set_threads(ctx, bits >= 240 ? 2 : 1);
    (bits & 16 ? hostile_cells : small_cells)(ctx, &in, &o);
    fuzz_end();
    return 0;
}
