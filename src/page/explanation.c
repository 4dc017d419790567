/* How a surface came to be, on a page: see page.h.
 *
 * What is shown as numbers is exact: places of samples, centres and radii of polar balls. Vertices, which are only
 * drawn, are single precision numbers, relative to their sample; a power of two brings lengths into their range. */
#include "base/memory.h"
#include "page/block.h"
#include "page/page.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 32, UNKNOWN = 255 }; /* UNKNOWN: no confidence */
static const double CONFIDENCES = 254;   /* steps of a confidence */

typedef struct {
    brio_output *out;
    const brio_page_how *how;
    const brio_explanation *e;
    uint32_t *of; /* #vertices: the sample of each */
    int exponent; /* lengths on the page are those of the explanation times 2^-exponent */
} explained;

/* Entry i * stride + offset of an array. */
typedef struct {
    const void *data;
    size_t stride, offset;
} entries;

static uint64_t byte_at(const void *user, size_t i) {
    const entries *x = user;
    return ((const uint8_t *)x->data)[x->stride * i + x->offset];
}

static uint64_t double_at(const void *user, size_t i) {
    const entries *x = user;
    uint64_t bits;
    memcpy(&bits, (const double *)x->data + x->stride * i + x->offset, sizeof bits);
    return bits;
}

static uint64_t float_bits(double x) {
    float single = (float)x;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    return bits;
}

static uint64_t single_at(const void *user, size_t i) {
    const entries *x = user;
    return float_bits(((const double *)x->data)[x->stride * i + x->offset]);
}

/* Returns how many items a list has, by its offsets. */
static uint64_t count_at(const void *user, size_t i) {
    const uint64_t *offsets = ((const entries *)user)->data;
    return offsets[i + 1] - offsets[i];
}

static uint64_t side_at(const void *user, size_t i) {
    return (uint64_t)(((const int8_t *)((const entries *)user)->data)[i] + 1);
}

static uint64_t confidence_at(const void *user, size_t i) {
    double c = (double)((const float *)((const entries *)user)->data)[i];
    return isnan(c) ? UNKNOWN : (uint64_t)rint(CONFIDENCES * c);
}

/* A coordinate of the vertices, and numbers of vertices, relative to their sample. */
typedef struct {
    const explained *x;
    size_t offset;
} relative;

static uint64_t vertex_at(const void *user, size_t i) {
    const relative *r = user;
    const brio_explanation *e = r->x->e;
    double at = e->vertices[3 * i + r->offset], from = e->place[3 * (size_t)r->x->of[i] + r->offset];
    return float_bits(ldexp(at, -r->x->exponent) - ldexp(from, -r->x->exponent));
}

static uint64_t local(const explained *x, uint32_t v) {
    return v - x->e->vertex_offsets[x->of[v]];
}

static uint64_t corner_at(const void *user, size_t i) {
    const relative *r = user;
    return local(r->x, r->x->e->corners[i]);
}

static uint64_t tetrahedron_at(const void *user, size_t i) {
    const relative *r = user;
    return local(r->x, r->x->e->tetrahedra[4 * i + r->offset]);
}

static brio_status put(const explained *x, const char *name, brio_page_column column) {
    return brio_page_put_column(x->out, x->how->number, name, &column);
}

/* Writes rows of doubles as columns NAME-0 and so on. */
static brio_status put_doubles(const explained *x, const char *name, const double *rows, size_t stride, size_t n,
                               bool exact) {
    for (size_t k = 0; k < stride; k++) {
        char block[NAME_BYTES];
        const entries column = {rows, stride, k};
        snprintf(block, sizeof block, "%s-%zu", name, k);
        BRIO_FORWARD(
            put(x, block, (brio_page_column){exact ? double_at : single_at, &column, n, exact ? 8 : 4, BRIO_PAGE_XOR}));
    }
    return BRIO_OK;
}

static brio_status put_counts(const explained *x, const char *name, const uint64_t *offsets, size_t n) {
    const entries counts = {.data = offsets};
    return put(x, name, (brio_page_column){count_at, &counts, n, 4, BRIO_PAGE_DELTA});
}

static brio_status put_samples(const explained *x) {
    const brio_explanation *e = x->e;
    const size_t n = e->num_samples;
    const entries sides = {.data = e->pole_side};
    BRIO_FORWARD(put_doubles(x, "e-place", e->place, 3, n, true));
    BRIO_FORWARD(put_doubles(x, "e-pole", e->pole, 8, n, true));
    BRIO_FORWARD(put_doubles(x, "e-axis", e->axis, 3, n, false));
    BRIO_FORWARD(put(x, "e-pole-side", (brio_page_column){side_at, &sides, 2 * n, 1, BRIO_PAGE_DELTA}));
    BRIO_FORWARD(put_counts(x, "e-vertices", e->vertex_offsets, n));
    BRIO_FORWARD(put_counts(x, "e-tetrahedra", e->tetrahedron_offsets, n));
    return put_counts(x, "e-polygons", e->polygon_offsets, n);
}

static uint64_t point_at(const void *user, size_t i) {
    return ((const uint32_t *)((const entries *)user)->data)[i];
}

static brio_status put_items(const explained *x) {
    const brio_explanation *e = x->e;
    const size_t n = e->num_samples, vertices = (size_t)e->vertex_offsets[n], tets = (size_t)e->tetrahedron_offsets[n];
    const size_t polygons = (size_t)e->polygon_offsets[n], corners = (size_t)e->corner_offsets[polygons];
    const relative of_vertices = {x, 0};
    const entries points = {.data = e->point}, kinds = {e->polygon_kind, 1, 0}, sides = {.data = e->tetrahedron_side};
    const entries sure = {.data = e->tetrahedron_confidence}, taken = {e->tetrahedron_taken, 1, 0};
    BRIO_FORWARD(put(x, "e-point", (brio_page_column){point_at, &points, n, 4, BRIO_PAGE_DELTA}));
    for (size_t k = 0; k < 3; k++) {
        char block[NAME_BYTES];
        const relative column = {x, k}, corner = {x, k + 1};
        snprintf(block, sizeof block, "e-vertex-%zu", k);
        BRIO_FORWARD(put(x, block, (brio_page_column){vertex_at, &column, vertices, 4, BRIO_PAGE_XOR}));
        snprintf(block, sizeof block, "e-tetrahedron-%zu", k);
        BRIO_FORWARD(put(x, block, (brio_page_column){tetrahedron_at, &corner, tets, 4, BRIO_PAGE_DELTA}));
    }
    BRIO_FORWARD(put(x, "e-side", (brio_page_column){side_at, &sides, tets, 1, BRIO_PAGE_DELTA}));
    BRIO_FORWARD(put(x, "e-confidence", (brio_page_column){confidence_at, &sure, tets, 1, BRIO_PAGE_DELTA}));
    BRIO_FORWARD(put(x, "e-taken", (brio_page_column){byte_at, &taken, tets, 1, BRIO_PAGE_DELTA}));
    BRIO_FORWARD(put(x, "e-kind", (brio_page_column){byte_at, &kinds, polygons, 1, BRIO_PAGE_DELTA}));
    BRIO_FORWARD(put_counts(x, "e-corners", e->corner_offsets, polygons));
    return put(x, "e-corner", (brio_page_column){corner_at, &of_vertices, corners, 4, BRIO_PAGE_DELTA});
}

/* Returns 0, or the exponent of the greatest coordinate if single precision would lose lengths like it. */
static int exponent_of(const brio_explanation *e) {
    enum { USUAL = 60 };
    double most = 0;
    for (size_t i = 0; i < 3 * e->num_samples; i++) most = fmax(most, fabs(e->place[i]));
    int exponent = most > 0 ? ilogb(most) : 0;
    return abs(exponent) > USUAL ? exponent : 0;
}

brio_status brio_page_explanation(brio_output *out, const brio_page_how *how) {
    brio_status status = BRIO_OK;
    const brio_explanation *e = how->explanation;
    if (!e) return BRIO_OK;
    explained x = {out, how, e, NULL, exponent_of(e)};
    BRIO_TRY(BRIO_ALLOC(out->ctx, x.of, e->vertex_offsets[e->num_samples] + 1));
    for (size_t s = 0; s < e->num_samples; s++)
        for (uint64_t v = e->vertex_offsets[s]; v < e->vertex_offsets[s + 1]; v++) x.of[v] = (uint32_t)s;
    BRIO_TRY(put_samples(&x));
    BRIO_TRY(put_items(&x));
done:
    brio_release(out->ctx, x.of);
    return status;
}

brio_status brio_page_describe_explanation(brio_output *out, const brio_explanation *e) {
    if (!e) return BRIO_OK;
    const size_t n = e->num_samples, polygons = (size_t)e->polygon_offsets[n];
    const struct {
        const char *name;
        uint64_t count;
    } counts[] = {{"samples", n},
                  {"all_samples", e->all_samples},
                  {"vertices", e->vertex_offsets[n]},
                  {"tetrahedra", e->tetrahedron_offsets[n]},
                  {"polygons", polygons},
                  {"corners", e->corner_offsets[polygons]}};
    BRIO_FORWARD(brio_output_string(out, ",\"explanation\":{\"method\":"));
    BRIO_FORWARD(brio_page_json(out, brio_surface_method_facts(e->method)->name));
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        BRIO_FORWARD(brio_output_format(out, ",\"%s\":%llu", counts[i].name, (unsigned long long)counts[i].count));
    BRIO_FORWARD(brio_output_string(out, ",\"theta\":"));
    BRIO_FORWARD(brio_output_double(out, 0, e->theta));
    return brio_output_format(out, ",\"exponent\":%d}", exponent_of(e));
}
