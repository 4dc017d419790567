/* Pictures of meshes: brio_write_picture.
 *
 * All meshes stand in one box, and are seen along one direction. The projection is parallel, so that a length of the
 * picture is one of the meshes, and the scale is the largest with which all of them fit. */
#include "picture/picture.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "mesh/edge_rings.h"
#include <math.h>
#include <string.h>

/* WIDTH, HEIGHT: of a picture, in pixels. MOST: of each. MOST_MESHES: on a picture, as it has colours for. */
enum { WIDTH = 960, HEIGHT = 640, MOST = 16384, MOST_MESHES = 12 };

/* The margin, a part of each side. Chosen. */
static const double MARGIN = 0.04;

static const brio_rgb LIGHT = {{238, 240, 243}}, DARK = {{22, 25, 29}};

/* A picture that is being made. Mesh i is in panel i of a row of panels, or all are in one. */
typedef struct {
    brio_context *ctx;
    brio_drawn_mesh *drawn;
    const brio_mesh **mesh;
    size_t count, panels;
    brio_scene_box box;
    brio_look_axes axes;
    brio_raster raster;
    double scale; /* samples of the unit of the box */
} picture;

/* --- what comes in --- */

static brio_status check(brio_context *ctx, const brio_mesh *m) {
    BRIO_FORWARD(brio_refuse_vertices(ctx, m->vertices, m->num_vertices, "the mesh"));
    BRIO_FORWARD(brio_mesh_check_faces(ctx, m));
    for (size_t i = 0; i < 4 * m->num_tetrahedra; i++)
        BRIO_EXPECT(ctx, m->tetrahedra[i] < m->num_vertices, BRIO_ERR_ARGUMENT,
                    "tetrahedron %zu has the vertex %u, and there are %zu", i / 4, m->tetrahedra[i], m->num_vertices);
    for (size_t i = 0; i < 2 * m->num_edges; i++)
        BRIO_EXPECT(ctx, m->edges[i] < m->num_vertices, BRIO_ERR_ARGUMENT,
                    "edge %zu has the vertex %u, and there are %zu", i / 2, m->edges[i], m->num_vertices);
    return BRIO_OK;
}

static brio_status take_layers(picture *p, const brio_page_layer *const *layers, size_t count) {
    BRIO_EXPECT(p->ctx, count > 0, BRIO_ERR_ARGUMENT, "a picture needs a mesh to show");
    BRIO_EXPECT(p->ctx, count <= MOST_MESHES, BRIO_ERR_ARGUMENT, "a picture shows at most %d meshes", MOST_MESHES);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(p->ctx, p->drawn, count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(p->ctx, p->mesh, count));
    for (p->count = 0; p->count < count; p->count++) {
        brio_page_layer layer = {0};
        BRIO_FORWARD(brio_versioned_take(p->ctx, layers[p->count], &layer, BRIO_LAYOUT(brio_page_layer)));
        BRIO_EXPECT(p->ctx, layer.mesh, BRIO_ERR_ARGUMENT, "a layer of a picture has no mesh");
        BRIO_FORWARD(check(p->ctx, layer.mesh));
        p->drawn[p->count].mesh = p->mesh[p->count] = layer.mesh;
    }
    return BRIO_OK;
}

static void find_box(picture *p) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, half = 0;
    for (size_t i = 0; i < p->count; i++)
        for (size_t v = 0; v < 3 * p->mesh[i]->num_vertices; v++) {
            double x = p->mesh[i]->vertices[v];
            low[v % 3] = x < low[v % 3] ? x : low[v % 3];
            high[v % 3] = x > high[v % 3] ? x : high[v % 3];
        }
    for (int k = 0; k < 3; k++) {
        bool empty = low[k] > high[k];
        p->box.centre[k] = empty ? 0 : low[k] / 2 + high[k] / 2;
        if (!empty && high[k] / 2 - low[k] / 2 > half) half = high[k] / 2 - low[k] / 2;
    }
    p->box.half = half > 0 ? half : 1;
}

/* --- where things are --- */

static void place_of(const picture *p, const brio_mesh *m, size_t v, double out[3]) {
    double at[3];
    brio_scene_place(&p->box, m->vertices + 3 * v, at);
    out[0] = brio_dot(at, p->axes.right);
    out[1] = -brio_dot(at, p->axes.up);
    out[2] = brio_dot(at, p->axes.back);
}

static void widen(double low[2], double high[2], const double *place) {
    for (int k = 0; k < 2; k++) {
        low[k] = place[k] < low[k] ? place[k] : low[k];
        high[k] = place[k] > high[k] ? place[k] : high[k];
    }
}

/* Finds what the drawn parts of a mesh cover. */
static void cover(const brio_drawn_mesh *d, double low[2], double high[2]) {
    const brio_shapes *s = &d->shapes;
    for (size_t t = 0; t < s->num_triangles; t++)
        for (int k = 0; k < 3; k++) widen(low, high, d->place[s->corner[t][k]]);
    for (size_t l = 0; l < s->num_lines; l++)
        for (int k = 0; k < 2; k++) widen(low, high, d->place[s->end[l][k]]);
    for (size_t v = 0; v < d->mesh->num_vertices && s->discs; v++) widen(low, high, d->place[v]);
}

/* Returns the radius of discs that touch about their neighbours, in samples: the points lie in `area` pixels. */
static double radius_of(const brio_drawn_mesh *d, double area) {
    double pixels = 0.8 * sqrt(0.5 * area / fmax(1, (double)d->mesh->num_vertices));
    return BRIO_SAMPLES * fmin(4, fmax(0.9, pixels));
}

/* Scales what is drawn so that it fits, and moves each mesh to the middle of its panel. */
static void fit(picture *p) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, room[2], middle[2] = {0, 0};
    for (size_t i = 0; i < p->count; i++) cover(p->drawn + i, low, high);
    room[0] = (double)p->raster.width / (double)p->panels * (1 - 2 * MARGIN) * BRIO_SAMPLES;
    room[1] = (double)p->raster.height * (1 - 2 * MARGIN) * BRIO_SAMPLES;
    p->scale = INFINITY;
    for (int k = 0; k < 2 && low[k] <= high[k]; k++) {
        if (high[k] > low[k]) p->scale = fmin(p->scale, room[k] / (high[k] - low[k]));
        middle[k] = low[k] / 2 + high[k] / 2;
    }
    if (isinf(p->scale)) p->scale = fmin(room[0], room[1]) / 2; /* one position: as of a box of the side 2 */
    for (size_t i = 0; i < p->count; i++) {
        brio_drawn_mesh *d = p->drawn + i;
        double panel = p->panels > 1 ? (double)i : 0, area = 1;
        double at[2] = {(panel + 0.5) * p->raster.width * BRIO_SAMPLES / (double)p->panels,
                        0.5 * p->raster.height * BRIO_SAMPLES};
        for (size_t v = 0; v < d->mesh->num_vertices; v++) {
            for (int k = 0; k < 2; k++) d->place[v][k] = at[k] + p->scale * (d->place[v][k] - middle[k]);
            d->place[v][2] *= p->scale;
        }
        for (int k = 0; k < 2; k++) area *= low[k] < high[k] ? (high[k] - low[k]) * p->scale / BRIO_SAMPLES : 1;
        d->radius = radius_of(d, area);
    }
}

/* --- normals --- */

static void add_normal(const brio_drawn_mesh *d, const uint32_t *corner) {
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) {
        u[k] = d->place[corner[1]][k] - d->place[corner[0]][k];
        v[k] = d->place[corner[2]][k] - d->place[corner[0]][k];
    }
    brio_cross(v, u, n); /* y is downwards, so that the other order is the one that looks outwards */
    for (int k = 0; k < 3; k++)
        for (int x = 0; x < 3; x++) d->normal[corner[k]][x] += (float)n[x];
}

/* Takes the properties nx, ny, nz of a cloud. Returns whether it has them. */
static bool take_given(const picture *p, const brio_drawn_mesh *d) {
    static const char *const names[3] = {"nx", "ny", "nz"};
    const brio_property *of[3];
    for (int k = 0; k < 3; k++) {
        of[k] = brio_mesh_property(d->mesh, names[k]);
        if (!of[k]) return false;
    }
    for (size_t v = 0; v < d->mesh->num_vertices; v++) {
        double n[3];
        for (int k = 0; k < 3; k++) n[k] = brio_property_value(of[k], v);
        d->normal[v][0] = (float)brio_dot(n, p->axes.right);
        d->normal[v][1] = (float)-brio_dot(n, p->axes.up);
        d->normal[v][2] = (float)brio_dot(n, p->axes.back);
    }
    return true;
}

static brio_status find_normals(const picture *p, brio_drawn_mesh *d) {
    const brio_shapes *s = &d->shapes;
    bool faces = s->num_triangles > 0 && !s->flat;
    if (!faces && !s->discs) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(p->ctx, d->normal, d->mesh->num_vertices + 1));
    for (size_t t = 0; t < s->num_triangles && faces; t++) add_normal(d, s->corner[t]);
    if (!faces && !take_given(p, d)) {
        brio_release(p->ctx, d->normal);
        d->normal = NULL;
        return BRIO_OK;
    }
    for (size_t v = 0; v < d->mesh->num_vertices; v++) {
        float *n = d->normal[v], size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int k = 0; k < 3; k++) n[k] = size > 0 && isfinite(size) ? n[k] / size : 0;
    }
    return BRIO_OK;
}

/* --- the picture --- */

static brio_status choose_direction(picture *p, const brio_picture_options *o, double direction[3]) {
    for (int k = 0; k < 3; k++) direction[k] = o->from[k];
    BRIO_EXPECT(p->ctx, brio_all_finite(o->from, 3), BRIO_ERR_ARGUMENT, "the direction of a picture is not finite");
    if (!direction[0] && !direction[1] && !direction[2])
        BRIO_FORWARD(brio_look_best(p->ctx, p->mesh, p->count, &p->box, direction));
    brio_look_from(direction, &p->axes);
    for (int k = 0; k < 3; k++) direction[k] = p->axes.back[k];
    return BRIO_OK;
}

/* Gives meshes that show the same property one range, so that a colour is the same value on all of them. */
static void share_ranges(picture *p) {
    for (size_t i = 0; i < p->count; i++)
        for (size_t j = 0; j < p->count; j++) {
            brio_paint *a = &p->drawn[i].paint;
            const brio_paint *b = &p->drawn[j].paint;
            if (!a->name || !b->name || strcmp(a->name, b->name) != 0) continue;
            a->low = fmin(a->low, b->low);
            a->high = fmax(a->high, b->high);
        }
}

static brio_status prepare(picture *p, const brio_picture_options *o, brio_picture_stats *stats) {
    bool found = false;
    for (size_t i = 0; i < p->count; i++) {
        brio_drawn_mesh *d = p->drawn + i;
        bool has;
        BRIO_FORWARD(brio_paint_find(p->ctx, d->mesh, i, o->colour, &has, &d->paint));
        found |= has;
    }
    share_ranges(p);
    for (size_t i = 0; i < p->count; i++) {
        brio_drawn_mesh *d = p->drawn + i;
        BRIO_FORWARD(brio_paint_values(p->ctx, d->mesh, &d->paint));
        if (d->paint.name && !(stats->low < stats->high)) stats->low = d->paint.low, stats->high = d->paint.high;
        BRIO_FORWARD(brio_shapes_find(p->ctx, d->mesh, &p->box, &p->axes, o->self_intersections != 0, &d->shapes));
        BRIO_FORWARD(BRIO_ALLOC(p->ctx, d->place, d->mesh->num_vertices + 1));
        for (size_t v = 0; v < d->mesh->num_vertices; v++) place_of(p, d->mesh, v, d->place[v]);
        BRIO_FORWARD(find_normals(p, d));
    }
    BRIO_EXPECT(p->ctx, found, BRIO_ERR_ARGUMENT, "no mesh of the picture has a property \"%s\"", o->colour);
    fit(p);
    return BRIO_OK;
}

static brio_status take_size(picture *p, const brio_picture_options *o) {
    p->raster = (brio_raster){.width = o->width ? o->width : WIDTH,
                              .height = o->height ? o->height : HEIGHT,
                              .background = o->dark ? DARK : LIGHT};
    BRIO_EXPECT(p->ctx,
                p->raster.width > 0 && p->raster.width <= MOST && p->raster.height > 0 && p->raster.height <= MOST,
                BRIO_ERR_ARGUMENT, "a picture has 1 to %d pixels along each side, not %d by %d", MOST, p->raster.width,
                p->raster.height);
    p->panels = o->side_by_side ? p->count : 1;
    return BRIO_ALLOC(p->ctx, p->raster.pixels, 3 * (size_t)p->raster.width * (size_t)p->raster.height);
}

brio_status brio_write_picture(brio_context *ctx, const char *path, const brio_page_layer *const *layers,
                               size_t num_layers, const brio_picture_options *options, brio_picture_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    picture p = {.ctx = ctx};
    brio_picture_options o = {0};
    brio_picture_stats mine = {0};
    BRIO_TRY(brio_versioned_take(ctx, options, &o, BRIO_LAYOUT(brio_picture_options)));
    BRIO_TRY(brio_versioned_check(ctx, stats, BRIO_LAYOUT(brio_picture_stats)));
    BRIO_TRY(take_layers(&p, layers, num_layers));
    BRIO_TRY(take_size(&p, &o));
    find_box(&p);
    BRIO_TRY(choose_direction(&p, &o, mine.from));
    BRIO_TRY(prepare(&p, &o, &mine));
    BRIO_TRY(brio_raster_draw(ctx, p.drawn, p.count, &p.raster));
    BRIO_TRY(brio_png_write(ctx, path, &p.raster, &mine.bytes));
    mine.pixel = p.box.half / p.scale * BRIO_SAMPLES;
    brio_versioned_give(stats, &mine, BRIO_LAYOUT(brio_picture_stats));
done:
    for (size_t i = 0; i < p.count; i++) {
        brio_shapes_free(ctx, &p.drawn[i].shapes);
        brio_paint_free(ctx, &p.drawn[i].paint);
        brio_release(ctx, p.drawn[i].place);
        brio_release(ctx, p.drawn[i].normal);
    }
    brio_release(ctx, p.drawn);
    brio_release(ctx, p.mesh);
    brio_release(ctx, p.raster.pixels);
    return status;
}
