/* Alpha complexes of periodic triangulations: one simplex of each class of translates, and the shape's facets.
 *
 * The tetrahedra with a vertex in the domain are unfolded (unfold.c). Images are numbered by their positions, so that a
 * simplex begins with its lexicographically least vertex, which is in the domain for one simplex of each class. All
 * its cofaces are unfolded. Positions are on the grid, where differences are exact: translates of a simplex have values
 * of the same bits, and no value is greater than that of a coface.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "alpha/alpha_complex.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "periodic/periodic.h"
#include "triangulation/tetrahedra.h"
#include <string.h>

typedef struct {
    brio_context *ctx;
    const brio_periodic *t;
    brio_images images;
    brio_unfolded unfolded;
    uint32_t *order, *rank; /* #images: by position */
    double *x, *weight;     /* #images, in that order; weight: NULL without */
    uint8_t *own;
} alpha_call;

static int by_position(uint32_t a, uint32_t b, const void *user) {
    return brio_images_compare(user, a, b);
}

/* Sorts the images, and names the vertices of the unfolded tetrahedra by their places. */
static brio_status number_images(alpha_call *c) {
    const brio_images *m = &c->images;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->order, m->count + 1));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->rank, m->count + 1));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->x, 3 * m->count + 1));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->own, m->count + 1));
    if (m->weight) BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->weight, m->count + 1));
    for (size_t i = 0; i < m->count; i++) c->order[i] = (uint32_t)i;
    BRIO_FORWARD(brio_sort_rows(c->ctx, &(brio_row_order){m->x[0], 3, by_position, m}, c->order, m->count));
    for (size_t n = 0; n < m->count; n++) {
        uint32_t i = c->order[n];
        c->rank[i] = (uint32_t)n;
        memcpy(c->x + 3 * n, m->x[i], sizeof *m->x);
        if (m->weight) c->weight[n] = m->weight[i];
        c->own[n] = i < m->num_points;
    }
    for (size_t t = 0; t < c->unfolded.count; t++)
        for (int i = 0; i < 4; i++) {
            uint32_t *v = &c->unfolded.tet[t].vertex[i];
            if (*v != BRIO_INFINITE) *v = c->rank[*v];
        }
    return BRIO_OK;
}

/* Gives the vertices of simplices their numbers in the list of images, ascending in each simplex. */
static void name_vertices(const alpha_call *c, brio_alpha_complex *complex) {
    for (size_t k = 0; k < 4; k++)
        for (size_t n = 0; n < complex->counts[k]; n++) {
            uint32_t *v = complex->simplices[k] + n * (k + 1);
            for (size_t i = 0; i <= k; i++) {
                uint32_t image = c->order[v[i]];
                size_t at = i;
                for (; at > 0 && v[at - 1] > image; at--) v[at] = v[at - 1];
                v[at] = image;
            }
        }
}

static brio_status show_images(const alpha_call *c, brio_periodic_alpha *out) {
    static const int64_t none[3] = {0, 0, 0};
    const brio_images *m = &c->images;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, out->images, m->count + 1));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, out->positions, 3 * m->count + 1));
    out->num_images = m->count;
    for (size_t i = 0; i < m->count; i++) {
        out->images[i] = brio_periodic_show(c->t, &m->list[i], c->t->home[m->list[i].point], none);
        for (int k = 0; k < 3; k++)
            out->positions[3 * i + (size_t)k] = brio_lattice_shown(&c->t->lattice, m->x[i][k], k);
    }
    return BRIO_OK;
}

void brio_periodic_alpha_free(brio_periodic_alpha *a) {
    if (!a) return;
    brio_context *ctx = a->context;
    brio_release(ctx, a->images);
    brio_release(ctx, a->positions);
    if (a->complex) brio_alpha_complex_free(a->complex);
    brio_release(ctx, a->complex);
    brio_release(ctx, a);
}

static brio_status find(alpha_call *c, brio_periodic_alpha *out) {
    BRIO_FORWARD(brio_images_copy(c->ctx, &c->t->images, &c->t->lattice, &c->images));
    BRIO_FORWARD(brio_periodic_unfold(c->ctx, c->t, NULL, &c->images, &c->unfolded));
    BRIO_FORWARD(number_images(c));
    const brio_alpha_input in = {.tet = c->unfolded.tet,
                                 .num_finite = c->unfolded.num_finite,
                                 .count = c->unfolded.count,
                                 .points = c->x,
                                 .weights = c->weight,
                                 .num_points = c->images.count,
                                 .own = c->own};
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, out->complex, 1));
    BRIO_FORWARD(brio_alpha_of_classes(c->ctx, &in, out->complex));
    name_vertices(c, out->complex);
    return show_images(c, out);
}

brio_status brio_periodic_alpha_values(brio_context *ctx, const brio_periodic *t, brio_periodic_alpha **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    alpha_call c = {.ctx = ctx, .t = t};
    brio_periodic_alpha *made = NULL;
    *out = NULL;
    BRIO_REQUIRE(ctx, t->stats.tetrahedra > 0, BRIO_ERR_NO_ANSWER,
                 "%zu vertices of dimension %d have no tetrahedra, so no alpha complex", t->stats.vertices,
                 t->stats.dimension);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, made, 1));
    made->size = sizeof *made;
    made->context = ctx;
    made->periodic = t;
    BRIO_TRY(find(&c, made));
    *out = made;
    made = NULL;
done:
    brio_periodic_alpha_free(made);
    brio_images_free(&c.images);
    brio_release(ctx, c.unfolded.tet);
    brio_release(ctx, c.order);
    brio_release(ctx, c.rank);
    brio_release(ctx, c.x);
    brio_release(ctx, c.weight);
    brio_release(ctx, c.own);
    return status;
}

brio_status brio_periodic_alpha_auto(brio_context *ctx, const brio_periodic_alpha *a, double *alpha) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    const brio_periodic *t = a->periodic;
    brio_tetrahedron *tet = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, tet, t->stats.tetrahedra + 1));
    for (size_t c = 0; c < t->stats.tetrahedra; c++) {
        tet[c] = t->tet[c];
        for (int i = 0; i < 4; i++) tet[c].vertex[i] = t->images.list[tet[c].vertex[i]].point;
    }
    BRIO_TRY(
        brio_alpha_auto_of(ctx, a->complex, &(brio_alpha_cells){(const uint32_t *)tet, 4, t->stats.points}, alpha));
done:
    brio_release(ctx, tet);
    return status;
}

/* --- simplices by their points --- */

typedef struct {
    const uint32_t *vertex;
    size_t corners;
} simplex_rows;

static int compare_rows(uint32_t a, uint32_t b, const void *user) {
    const simplex_rows *r = user;
    for (size_t i = 0; i < r->corners; i++) {
        uint32_t x = r->vertex[a * r->corners + i], y = r->vertex[b * r->corners + i];
        if (x != y) return x < y ? -1 : 1;
    }
    return 0;
}

/* Refuses simplices that have a point twice, or two of them with the same points. */
static brio_status refuse_doubles(brio_context *ctx, const brio_alpha_complex *c, size_t k) {
    brio_status status = BRIO_OK;
    const simplex_rows rows = {c->simplices[k], k + 1};
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, order, c->counts[k] + 1));
    for (size_t n = 0; n < c->counts[k]; n++) order[n] = (uint32_t)n;
    BRIO_TRY(brio_sort_many_indices(ctx, order, c->counts[k], compare_rows, &rows));
    for (size_t n = 0; n < c->counts[k]; n++) {
        const uint32_t *v = rows.vertex + order[n] * (k + 1);
        bool doubles = n > 0 && compare_rows(order[n - 1], order[n], &rows) == 0;
        for (size_t i = 1; i <= k; i++) doubles |= v[i - 1] == v[i];
        BRIO_REQUIRE(ctx, !doubles, BRIO_ERR_NO_ANSWER,
                     "the cell is too small for simplices named by their points: point %u is a neighbour of itself, or "
                     "of another point in two ways; repeat the cell",
                     v[0]);
    }
done:
    brio_release(ctx, order);
    return status;
}

/* Makes a complex of the same values, whose simplices may be named anew. */
static brio_status copy_complex(brio_context *ctx, const brio_alpha_complex *from, brio_alpha_complex *to) {
    size_t total = 0, corners = (size_t)(from->simplices[3] - from->simplices[0]) + 4 * from->counts[3];
    for (int k = 0; k < 4; k++) total += from->counts[k];
    to->context = ctx;
    BRIO_FORWARD(BRIO_ALLOC(ctx, to->simplices[0], corners));
    BRIO_FORWARD(BRIO_ALLOC(ctx, to->values[0], total));
    BRIO_FORWARD(BRIO_ALLOC(ctx, to->solid[0], total));
    BRIO_FORWARD(BRIO_ALLOC(ctx, to->gabriel[0], total));
    memcpy(to->simplices[0], from->simplices[0], corners * sizeof **from->simplices);
    memcpy(to->values[0], from->values[0], total * sizeof **from->values);
    memcpy(to->solid[0], from->solid[0], total * sizeof **from->solid);
    memcpy(to->gabriel[0], from->gabriel[0], total * sizeof **from->gabriel);
    for (int k = 0; k < 4; k++) {
        to->counts[k] = from->counts[k];
        to->simplices[k] = to->simplices[0] + (from->simplices[k] - from->simplices[0]);
        to->values[k] = to->values[0] + (from->values[k] - from->values[0]);
        to->solid[k] = to->solid[0] + (from->solid[k] - from->solid[0]);
        to->gabriel[k] = to->gabriel[0] + (from->gabriel[k] - from->gabriel[0]);
    }
    return BRIO_OK;
}

/* Names the vertices of a simplex by their points, ascending. */
static void name_points(const brio_image *images, uint32_t *v, size_t corners) {
    for (size_t i = 0; i < corners; i++) {
        uint32_t point = images[v[i]].point;
        size_t at = i;
        for (; at > 0 && v[at - 1] > point; at--) v[at] = v[at - 1];
        v[at] = point;
    }
}

brio_status brio_periodic_alpha_by_points(brio_context *ctx, const brio_periodic_alpha *a, brio_alpha_complex *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_alpha_complex mine = {.size = sizeof mine, .context = ctx};
    brio_status size = BRIO_CHECK_OWNER(ctx, brio_alpha_complex, out, triangulation2);
    if (size != BRIO_OK) return size;
    BRIO_TRY(copy_complex(ctx, a->complex, &mine));
    for (size_t k = 0; k < 4; k++) {
        for (size_t n = 0; n < mine.counts[k]; n++) name_points(a->images, mine.simplices[k] + n * (k + 1), k + 1);
        BRIO_TRY(refuse_doubles(ctx, &mine, k));
    }
done:
    if (status != BRIO_OK) brio_alpha_complex_free(&mine);
    if (status != BRIO_OK) mine = (brio_alpha_complex){.size = sizeof mine};
    BRIO_GIVE(brio_alpha_complex, out, &mine);
    return status;
}
