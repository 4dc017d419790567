/* The surface through samples of an offset: the boundary between the tetrahedra of their Delaunay triangulation that
 * are covered and those that are free. It is closed and does not cross itself, whatever the samples are.
 *
 * A tetrahedron is what its centroid is. Between samples of one sheet are tetrahedra so flat that rounding decides;
 * they are of the solid that the offset bounds, so that all samples are on the surface. Specks take the other label:
 * sets of tetrahedra, joined across facets, all of whose centroids are close to the offset, and small ones thinner than
 * the error.
 *
 * Based on: Boissonnat, Oudot. Provably good sampling and meshing of surfaces. Graphical Models 2005 (the surface as
 * part of the Delaunay triangulation of points on it, refined where it is wrong).
 * Differs from the paper: tetrahedra are labeled, in place of Voronoi edges intersected, so that any number of samples
 * gives a closed surface. */
#include "base/team.h"
#include "base/union_find.h"
#include "base/vector.h"
#include "mesh/triangle_distance.h"
#include "offset/work.h"
#include <math.h>
#include <string.h>

enum { BATCH = 1 << 15, TETS_A_CHUNK = 16, FEW = 64 /* tetrahedra of a speck; chosen */ };
enum { COVERED = BRIO_OFFSET_COVERED, CERTAIN = BRIO_OFFSET_CERTAIN };

static const double FINE = 0.5;  /* of the distance: side of the smallest part of a facet that is looked at; chosen */
static const double CLEAR = 0.5; /* of the error: from the offset, where a place of a facet decides; chosen */
static const double SURE = 2;    /* of the error: from the offset, where a centroid is no matter of doubt; chosen */
static const double THIN = 2.7;  /* of the error: three times the volume over the area of a speck; chosen */
static const double BIAS = 0.05; /* of the error: what is so close to the offset is of the solid; chosen */

/* The facets of a positive tetrahedron, counterclockwise seen from outside; facet i is opposite to vertex i. */
static const uint8_t FACET[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

typedef brio_offset_labels labels;
typedef brio_offset_heights heights;

/* Adds the height of a place whose distance from the surface is known. */
static void add_height(const brio_offset_work *w, const double *p, double distance, heights *h) {
    double height = distance - w->field.distance;
    if (height > CLEAR * w->error && brio_offset_is_beyond(&w->field, p)) height = -distance - w->field.distance;
    h->least = fmin(h->least, height);
    h->greatest = fmax(h->greatest, height);
}

static void look_at(const brio_offset_work *w, const double *const facet[3], const double share[3], heights *h) {
    double p[3], nearest[3];
    size_t triangle;
    for (int k = 0; k < 3; k++) p[k] = share[0] * facet[0][k] + share[1] * facet[1][k] + share[2] * facet[2][k];
    add_height(w, p, sqrt(brio_closest_point(&w->field.solid->tree, p, nearest, &triangle)), h);
}

/* Looks at the heights of a triangle at places half an offset's distance apart, but not where none can be over `most`:
 * the distance from one triangle of the surface is a convex function. */
static void look_above(const brio_offset_work *w, const double *const corner[3], double most, heights *h) {
    const brio_triangle_tree *tree = &w->field.solid->tree;
    double centroid[3], nearest[3], middle[3], square = 0, side = 0;
    size_t triangle;
    int longest = 0;
    for (int k = 0; k < 3; k++) centroid[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
    add_height(w, centroid, sqrt(brio_closest_point(tree, centroid, nearest, &triangle)), h);
    for (int c = 0; c < 3; c++) {
        brio_closest_on_triangle(tree, triangle, corner[c], nearest);
        square = fmax(square, brio_square_distance(corner[c], nearest));
        double length = brio_square_distance(corner[c], corner[(c + 1) % 3]);
        if (length > side) side = length, longest = c;
    }
    if (h->greatest > most || sqrt(square) - w->field.distance <= most ||
        side < FINE * FINE * w->field.distance * w->field.distance)
        return;
    const double *a = corner[longest], *b = corner[(longest + 1) % 3], *c = corner[(longest + 2) % 3];
    for (int k = 0; k < 3; k++) middle[k] = 0.5 * (a[k] + b[k]);
    look_above(w, (const double *const[3]){a, middle, c}, most, h);
    look_above(w, (const double *const[3]){middle, b, c}, most, h);
}

/* Looks at a facet where the surface is tested. */
static void look_at_places(const brio_offset_work *w, const double *const facet[3], heights *h) {
    for (int i = 0; i < BRIO_OFFSET_PLACES; i++) look_at(w, facet, brio_offset_places[i], h);
}

/* Looks at a facet: at a small one where the surface is tested, at a large one everywhere. */
static void look_at_facet(const brio_offset_work *w, const double *const facet[3], heights *h) {
    double d = w->field.distance, clear = CLEAR * w->error, size = 0, at[3];
    look_at_places(w, facet, h);
    for (int c = 0; c < 3; c++) size = fmax(size, brio_square_distance(facet[c], facet[(c + 1) % 3]));
    if (size < d * d) return;
    double least = sqrt(brio_triangle_distance(&w->field.solid->tree, facet, (d - clear) * (d - clear), at));
    h->least = fmin(h->least, least - d);
    look_above(w, facet, clear, h);
}

static void corners_of(const brio_offset_work *w, const uint32_t *v, int facet, const double *corner[3]) {
    for (int c = 0; c < 3; c++) corner[c] = w->points + 3 * (size_t)v[FACET[facet][c]];
}

brio_offset_heights brio_offset_heights_of(const brio_offset_work *w, const uint32_t v[4]) {
    heights h = {0, 0};
    const double *facet[3];
    for (int i = 0; i < 4; i++) {
        corners_of(w, v, i, facet);
        look_at_places(w, facet, &h);
    }
    return h;
}

/* Returns the label of a tetrahedron whose centroid is close to the offset: that of the place of its facets farthest
 * from the offset. */
static uint8_t label_of_thin(const brio_offset_work *w, const uint32_t *v, double height) {
    heights h = {0, 0};
    const double *facet[3];
    for (int i = 0; i < 4; i++) {
        corners_of(w, v, i, facet);
        look_at_facet(w, facet, &h);
    }
    if (fmax(h.greatest, -h.least) > CLEAR * w->error) return h.greatest < -h.least ? COVERED | CERTAIN : CERTAIN;
    return height < (w->field.inwards ? -BIAS : BIAS) * w->error ? COVERED : 0;
}

static uint8_t label_of(const brio_offset_work *w, const uint32_t *v) {
    const brio_offset_field *f = &w->field;
    double centroid[3] = {0, 0, 0}, nearest[3];
    size_t triangle;
    if (v[3] == BRIO_INFINITE) return f->inwards ? COVERED | CERTAIN : CERTAIN;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) centroid[k] += w->points[3 * (size_t)v[i] + (size_t)k] / 4;
    double far = f->distance + SURE * w->error;
    double d = sqrt(brio_closest_within(&f->solid->tree, centroid, far * far, nearest, &triangle));
    if (d < f->distance - SURE * w->error || brio_offset_is_beyond(f, centroid)) return COVERED | CERTAIN;
    return d >= far ? CERTAIN : label_of_thin(w, v, d - f->distance);
}

typedef struct {
    const labels *l;
    size_t first; /* of the batch */
} batch;

static void label_part(void *user, size_t begin, size_t end, int thread) {
    const batch *b = user;
    const labels *l = b->l;
    (void)thread;
    for (size_t i = b->first + begin; i < b->first + end; i++) {
        const uint8_t *known = brio_seen_find(&l->w->labels, l->tet[i].vertex);
        l->label[i] = known ? *known : label_of(l->w, l->tet[i].vertex);
    }
}

static brio_status label_all(const labels *l) {
    brio_context *ctx = l->w->ctx;
    for (batch b = {l, 0}; b.first < l->count; b.first += BATCH) {
        size_t count = l->count - b.first < BATCH ? l->count - b.first : BATCH;
        BRIO_FORWARD(brio_offset_progress(l->w));
        BRIO_FORWARD(brio_for_chunks(ctx, brio_threads(ctx, count, TETS_A_CHUNK), count, TETS_A_CHUNK, label_part, &b));
    }
    return BRIO_OK;
}

/* Keeps the labels for the next round. */
static brio_status remember(const labels *l, size_t finite) {
    brio_seen_free(l->w->ctx, &l->w->labels);
    BRIO_FORWARD(brio_seen_new(l->w->ctx, finite, &l->w->labels));
    for (size_t i = 0; i < finite; i++) brio_seen_add(&l->w->labels, l->tet[i].vertex, l->label[i]);
    return BRIO_OK;
}

/* A set of tetrahedra of one label, joined across facets. */
typedef struct {
    double volume, area; /* six times the volume; twice the area of the facets to the other label */
    uint32_t count;
    bool certain; /* there is a certain one */
} part;

/* Returns twice the area of a facet. */
static double area_of(const brio_offset_work *w, const uint32_t *v, int facet) {
    double u[3], t[3], n[3];
    const double *a = w->points + 3 * (size_t)v[FACET[facet][0]];
    for (int k = 0; k < 3; k++) {
        u[k] = w->points[3 * (size_t)v[FACET[facet][1]] + (size_t)k] - a[k];
        t[k] = w->points[3 * (size_t)v[FACET[facet][2]] + (size_t)k] - a[k];
    }
    brio_cross(u, t, n);
    return brio_length(n);
}

static double volume_of(const brio_offset_work *w, const uint32_t *v) {
    double e[3][3], n[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = w->points[3 * (size_t)v[i + 1] + (size_t)k] - w->points[3 * (size_t)v[0] + (size_t)k];
    brio_cross(e[0], e[1], n);
    return fabs(brio_dot(n, e[2]));
}

/* Adds a tetrahedron to its part. */
static void add_to_part(const labels *l, size_t i, part *p) {
    p->count++;
    p->certain |= (l->label[i] & CERTAIN) != 0;
    if (l->tet[i].vertex[3] == BRIO_INFINITE) {
        p->volume = INFINITY;
        return;
    }
    p->volume += volume_of(l->w, l->tet[i].vertex);
    for (int f = 0; f < 4; f++)
        if ((l->label[l->tet[i].mate[f] / 4] ^ l->label[i]) & COVERED) p->area += area_of(l->w, l->tet[i].vertex, f);
}

/* Returns whether a part is none of the offset: nothing in it is certain, or it is of few tetrahedra and thinner than
 * the error. (The radius of a ball is three times its volume over its area.) */
static bool is_speck(const brio_offset_work *w, const part *p) {
    return !p->certain || (p->count <= FEW && p->volume < THIN * w->error * p->area);
}

/* Gives specks of one label the other label. */
static brio_status turn_specks(const labels *l, unsigned covered) {
    brio_status status = BRIO_OK;
    uint32_t *parent = NULL;
    part *parts = NULL;
    BRIO_TRY(BRIO_ALLOC(l->w->ctx, parent, l->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(l->w->ctx, parts, l->count));
    for (size_t i = 0; i < l->count; i++) parent[i] = (uint32_t)i;
    for (size_t i = 0; i < l->count; i++)
        for (int f = 0; f < 4; f++) {
            size_t j = l->tet[i].mate[f] / 4;
            if (j < i && (l->label[i] & COVERED) == covered && (l->label[j] & COVERED) == covered)
                brio_unite(parent, (uint32_t)i, (uint32_t)j, true);
        }
    for (size_t i = 0; i < l->count; i++)
        if ((l->label[i] & COVERED) == covered) add_to_part(l, i, &parts[brio_find(parent, (uint32_t)i)]);
    for (size_t i = 0; i < l->count; i++)
        if ((l->label[i] & COVERED) == covered && is_speck(l->w, &parts[brio_find(parent, (uint32_t)i)]))
            l->label[i] ^= COVERED;
done:
    brio_release(l->w->ctx, parent);
    brio_release(l->w->ctx, parts);
    return status;
}

/* Lists the facets between tetrahedra of the solid and others. */
static brio_status take_boundary(const labels *l) {
    brio_offset_work *w = l->w;
    unsigned solid = w->field.inwards ? 0 : COVERED;
    size_t n = 0;
    for (int pass = 0; pass < 2; pass++) {
        if (pass) BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->triangles, n));
        n = 0;
        for (size_t i = 0; i < l->count; i++)
            for (int f = 0; f < 4 && (l->label[i] & COVERED) == solid; f++) {
                if ((l->label[l->tet[i].mate[f] / 4] & COVERED) == solid) continue;
                for (int c = 0; pass && c < 3; c++) w->triangles[n][c] = l->tet[i].vertex[FACET[f][c]];
                n++;
            }
    }
    w->num_triangles = n;
    return BRIO_OK;
}

/* Passes progress on. The triangulation is a part of the work whose stages are not the caller's. */
static int pass_progress_on(const char *stage, double fraction, void *user) {
    const brio_offset_work *w = user;
    (void)stage, (void)fraction;
    return w->outer ? w->outer("offset", w->share, w->outer_user) : 0;
}

static brio_status triangulate(brio_offset_work *w, brio_triangulation **out) {
    w->outer = w->ctx->progress;
    w->outer_user = w->ctx->progress_user;
    brio_context_set_progress(w->ctx, w->outer ? pass_progress_on : NULL, w);
    brio_status status = brio_delaunay(w->ctx, w->points, NULL, w->num_points, NULL, out);
    brio_context_set_progress(w->ctx, w->outer, w->outer_user);
    return status;
}

brio_status brio_offset_connect(brio_offset_work *w) {
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    labels l = {.w = w};
    brio_release(w->ctx, w->triangles);
    w->triangles = NULL;
    w->num_triangles = 0;
    BRIO_TRY(triangulate(w, &t));
    const brio_delaunay_stats *stats = brio_triangulation_stats(t);
    if (stats->dimension < 3) goto done;
    l.tet = brio_triangulation_tetrahedra(t);
    l.count = stats->tetrahedra + stats->hull_facets;
    BRIO_TRY(BRIO_ALLOC(w->ctx, l.label, l.count));
    BRIO_TRY(label_all(&l));
    BRIO_TRY(remember(&l, stats->tetrahedra));
    BRIO_TRY(turn_specks(&l, COVERED));
    BRIO_TRY(turn_specks(&l, 0));
    BRIO_TRY(brio_offset_untie(&l));
    BRIO_TRY(take_boundary(&l));
done:
    brio_release(w->ctx, l.label);
    brio_triangulation_free(t);
    return status;
}
