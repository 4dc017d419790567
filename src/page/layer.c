/* A mesh on a page: see page.h.
 *
 * Coordinates for pictures are whole numbers up to QUANTUM, from the least corner of the mesh's box on, in one step for
 * the three of them; those for the user are doubles, as they are. */
#include "page/page.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "io/colour.h"
#include "mesh/crossing_faces.h"
#include "mesh/edge_rings.h"
#include "mesh/properties.h"
#include "mesh/tetrahedra_adjacency.h"
#include "page/block.h"
#include "page/sent_order.h"
#include <math.h>
#include <string.h>

/* QUANTUM: 21 bits; a graphics card holds 24, and differences of 21 bits fit in three bytes. NAME_BYTES: of a block's
 * name. */
enum { QUANTUM = (1 << 21) - 1, NAME_BYTES = 32 };

/* The greatest number for the values of a property in 16 bits; 0 stands for NaN and infinities. */
static const double STEPS = 65534;

typedef struct {
    brio_output *out;
    const brio_mesh *mesh;
    const brio_page_how *how;
    brio_sent_order order;
    double low[3], step;
} layer;

/* --- texts --- */

brio_status brio_page_json(brio_output *out, const char *text) {
    if (!text) return brio_output_string(out, "null");
    BRIO_FORWARD(brio_output_string(out, "\""));
    for (const char *at = text; *at;) {
        unsigned char c = (unsigned char)*at;
        size_t length = brio_utf8_length(at);
        bool plain = c >= 0x20 && c < 0x7f && !strchr("\"\\<>&'", c);
        bool separator = length == 3 && !memcmp(at, "\xe2\x80", 2) && ((unsigned char)at[2] | 1) == 0xa9;
        if (plain || (length > 1 && !separator))
            BRIO_FORWARD(brio_output_bytes(out, at, length));
        else
            BRIO_FORWARD(brio_output_format(out, "\\u%04x", separator ? 0x2000u | ((unsigned char)at[2] & 0x3f) : c));
        at += length ? length : 1;
    }
    return brio_output_string(out, "\"");
}

/* Writes ,"name":number; null for what JSON lacks. */
static brio_status put_real(brio_output *out, const char *name, double x) {
    BRIO_FORWARD(brio_output_format(out, ",\"%s\":", name));
    return isfinite(x) ? brio_output_double(out, 0, x) : brio_output_string(out, "null");
}

static brio_status put_count(brio_output *out, const char *name, uint64_t count) {
    return brio_output_format(out, ",\"%s\":%llu", name, (unsigned long long)count);
}

/* --- columns --- */

/* Writes a column of integers, by their differences. */
static brio_status put_column(layer *l, const char *name, brio_page_value value, const void *user, size_t n,
                              int width) {
    const brio_page_column c = {value, user, n, width, BRIO_PAGE_DELTA};
    return brio_page_put_column(l->out, l->how->number, name, &c);
}

/* Writes a column of floating-point numbers, by their bits. */
static brio_status put_reals(layer *l, const char *name, brio_page_value value, const void *user, size_t n, int width) {
    const brio_page_column c = {value, user, n, width, BRIO_PAGE_XOR};
    return brio_page_put_column(l->out, l->how->number, name, &c);
}

/* One coordinate of the vertices. */
typedef struct {
    const layer *l;
    int axis;
} coordinate;

static double coordinate_at(const coordinate *c, size_t i) {
    return c->l->mesh->vertices[3 * (size_t)c->l->order.vertex[i] + (size_t)c->axis];
}

/* Works in halves, so that boxes wider than the largest double have a width. */
static uint64_t quantised(const void *user, size_t i) {
    const coordinate *c = user;
    double x = coordinate_at(c, i) / 2 - c->l->low[c->axis] / 2, half = c->l->step / 2;
    double q = half > 0 ? rint(x / half) : 0;
    return q < 0 ? 0 : q > QUANTUM ? QUANTUM : (uint64_t)q;
}

static uint64_t exact_bits(const void *user, size_t i) {
    double x = coordinate_at(user, i);
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static brio_status put_coordinates(layer *l) {
    static const char *const near[] = {"x", "y", "z"}, *const exact[] = {"exact-x", "exact-y", "exact-z"};
    for (int k = 0; k < 3; k++) {
        coordinate c = {l, k};
        BRIO_FORWARD(put_column(l, near[k], quantised, &c, l->order.num_vertices, 3));
    }
    for (int k = 0; k < 3 && l->how->exact; k++) {
        coordinate c = {l, k};
        BRIO_FORWARD(put_reals(l, exact[k], exact_bits, &c, l->order.num_vertices, 8));
    }
    return BRIO_OK;
}

/* Finds the box's least corner, and the step that divides its longest side. */
static void find_box(layer *l) {
    double high[3], widest = 0;
    for (int k = 0; k < 3; k++) {
        l->low[k] = l->mesh->num_vertices ? INFINITY : 0;
        high[k] = -INFINITY;
        for (size_t v = 0; v < l->mesh->num_vertices; v++) {
            double x = l->mesh->vertices[3 * v + (size_t)k];
            l->low[k] = x < l->low[k] ? x : l->low[k];
            high[k] = x > high[k] ? x : high[k];
        }
        if (l->mesh->num_vertices && high[k] / 2 - l->low[k] / 2 > widest) widest = high[k] / 2 - l->low[k] / 2;
    }
    l->step = widest / QUANTUM * 2;
}

/* Entry i * stride + offset of indices, as they are or as places of vertices on the page. */
typedef struct {
    const uint32_t *index, *place; /* place NULL: as they are */
    size_t stride, offset;
} indices;

static uint64_t index_at(const void *user, size_t i) {
    const indices *x = user;
    uint32_t v = x->index[x->stride * i + x->offset];
    return x->place ? x->place[v] : v;
}

/* Writes the corners of simplices: a block for each corner, NAME-0 and so on. */
static brio_status put_corners(layer *l, const char *name, const uint32_t *corners, int stride, size_t n) {
    for (int k = 0; k < stride; k++) {
        char block[NAME_BYTES];
        indices x = {corners, l->order.place, (size_t)stride, (size_t)k};
        snprintf(block, sizeof block, "%s-%d", name, k);
        BRIO_FORWARD(put_column(l, block, index_at, &x, n, 4));
    }
    return BRIO_OK;
}

/* --- edges, tetrahedra, faces --- */

/* Edges by their half-edges. */
typedef struct {
    const brio_sent_order *o;
    const uint32_t *half_edge;
    bool ends;
} half_edges;

static uint64_t end_at(const void *user, size_t i) {
    const half_edges *e = user;
    uint32_t h = e->half_edge[i];
    return e->o->place[e->o->mesh->face_vertices[e->ends ? brio_sent_next(e->o, h) : h]];
}

static brio_status put_half_edges(layer *l, const char *name, const uint32_t *list, size_t n) {
    for (int k = 0; k < 2 && n > 0; k++) {
        char block[NAME_BYTES];
        half_edges e = {&l->order, list, k == 1};
        snprintf(block, sizeof block, "%s-%d", name, k);
        BRIO_FORWARD(put_column(l, block, end_at, &e, n, 4));
    }
    return BRIO_OK;
}

/* Writes the facets of tetrahedra that have no other side: what is seen of them from outside. */
static brio_status put_hull(layer *l, size_t *count) {
    brio_status status = BRIO_OK;
    brio_context *ctx = l->out->ctx;
    const brio_mesh *m = l->mesh;
    uint32_t *neighbours = NULL, *hull = NULL;
    size_t n = 0, capacity = 0;
    BRIO_TRY(brio_tetrahedra_neighbours(ctx, m, &neighbours));
    for (size_t f = 0; f < 4 * m->num_tetrahedra; f++) {
        if (neighbours[f] != BRIO_INFINITE) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, hull, capacity, 3 * n + 3));
        for (int k = 0; k < 3; k++)
            hull[3 * n + (size_t)k] = m->tetrahedra[(f & ~(size_t)3) + brio_facet_corners[f & 3][k]];
        n++;
    }
    BRIO_TRY(put_corners(l, "hull", hull, 3, n));
    *count = n;
done:
    brio_release(ctx, neighbours);
    brio_release(ctx, hull);
    return status;
}

static uint64_t corners_of(const void *user, size_t i) {
    const layer *l = user;
    uint32_t f = l->order.face[i];
    return l->mesh->face_offsets[f + 1] - l->mesh->face_offsets[f];
}

/* Marks of faces in the order of the page. */
typedef struct {
    const layer *l;
    const uint8_t *mark;
} marks;

static uint64_t mark_at(const void *user, size_t i) {
    const marks *m = user;
    return m->mark[m->l->order.face[i]];
}

static brio_status put_crossings(layer *l, brio_certificate *c) {
    brio_status status = BRIO_OK;
    uint8_t *crosses = NULL;
    BRIO_TRY(BRIO_ALLOC(l->out->ctx, crosses, l->mesh->num_faces + 1));
    BRIO_TRY(brio_crossing_faces(l->out->ctx, l->mesh, NULL, crosses, &c->self_intersections));
    const marks m = {l, crosses};
    if (c->self_intersections > 0) BRIO_TRY(put_column(l, "crossing", mark_at, &m, l->order.num_faces, 1));
done:
    brio_release(l->out->ctx, crosses);
    return status;
}

static brio_status put_faces(layer *l) {
    const brio_sent_order *o = &l->order;
    BRIO_FORWARD(brio_page_triangles(o, l->out, l->how->number));
    if (o->face_of) BRIO_FORWARD(put_column(l, "corners", corners_of, l, o->num_faces, 4));
    const indices numbers = {o->face, NULL, 1, 0};
    if (l->how->exact) BRIO_FORWARD(put_column(l, "faces", index_at, &numbers, o->num_faces, 4));
    BRIO_FORWARD(put_half_edges(l, "boundary", o->boundary, o->num_boundary));
    BRIO_FORWARD(put_half_edges(l, "nonmanifold", o->nonmanifold, o->num_nonmanifold));
    return put_half_edges(l, "flipped", o->flipped, o->num_flipped);
}

/* --- properties --- */

typedef struct {
    const brio_property *p;
    const uint32_t *row; /* of the page's vertices or faces */
    double low, high;    /* of the values, for those in 16 bits */
} values;

static uint64_t bits_at(const void *user, size_t i) {
    const values *x = user;
    size_t size = brio_scalar_size(x->p->type);
    const uint8_t *from = (const uint8_t *)x->p->data + size * x->row[i];
    uint16_t half;
    uint32_t word;
    uint64_t whole;
    switch (size) {
    case 1:
        return *from;
    case 2:
        memcpy(&half, from, sizeof half);
        return half;
    case 4:
        memcpy(&word, from, sizeof word);
        return word;
    default:
        memcpy(&whole, from, sizeof whole);
        return whole;
    }
}

static uint64_t step_at(const void *user, size_t i) {
    const values *x = user;
    double value = brio_property_value(x->p, x->row[i]), half = x->high / 2 - x->low / 2;
    if (!isfinite(value)) return 0;
    return 1 + (uint64_t)(half > 0 ? rint((value / 2 - x->low / 2) / half * STEPS) : 0);
}

static void find_range(values *x, size_t n) {
    x->low = INFINITY;
    x->high = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        double value = brio_property_value(x->p, x->row[i]);
        if (!isfinite(value)) continue;
        if (value < x->low) x->low = value;
        if (value > x->high) x->high = value;
    }
    if (x->low > x->high) x->low = x->high = 0;
}

static bool is_real(const brio_property *p) {
    return p->type == BRIO_SCALAR_FLOAT32 || p->type == BRIO_SCALAR_FLOAT64;
}

/* Returns whether the values of a property are rounded to 16 bits of their range. */
static bool is_rounded(const layer *l, const brio_property *p) {
    return is_real(p) && !l->how->exact;
}

/* Returns whether a property stays away: normals, which the page's program finds from the faces. */
static bool is_left_out(const layer *l, const brio_property *p) {
    bool normal = !strcmp(p->name, "nx") || !strcmp(p->name, "ny") || !strcmp(p->name, "nz");
    return !l->how->exact && normal && l->order.num_faces;
}

static bool leaves_normals_out(const layer *l) {
    for (size_t i = 0; i < l->mesh->num_properties; i++)
        if (is_left_out(l, &l->mesh->properties[i])) return true;
    return false;
}

/* The properties of the vertices or of the faces. */
typedef struct {
    const char *title; /* in the description */
    char prefix;       /* of the blocks' names, which end with the property's number */
    const brio_property *list;
    size_t count;
    const uint32_t *row; /* of each vertex or face on the page */
    size_t n;
} properties;

static properties of_vertices(const layer *l) {
    return (properties){"properties",         'v', l->mesh->properties, l->mesh->num_properties, l->order.vertex,
                        l->order.num_vertices};
}

static properties of_faces(const layer *l) {
    return (properties){"face_properties", 'f', l->mesh->face_properties, l->mesh->num_face_properties, l->order.face,
                        l->order.num_faces};
}

static brio_status put_property(layer *l, const properties *all, size_t i) {
    char block[NAME_BYTES];
    const brio_property *p = &all->list[i];
    values x = {p, all->row, 0, 0};
    int width = (int)brio_scalar_size(p->type);
    if (is_left_out(l, p)) return BRIO_OK;
    snprintf(block, sizeof block, "%c%zu", all->prefix, i);
    if (is_rounded(l, p)) {
        find_range(&x, all->n);
        return put_column(l, block, step_at, &x, all->n, 2);
    }
    return is_real(p) ? put_reals(l, block, bits_at, &x, all->n, width)
                      : put_column(l, block, bits_at, &x, all->n, width);
}

static brio_status put_properties(layer *l, properties all) {
    for (size_t i = 0; i < all.count; i++) BRIO_FORWARD(put_property(l, &all, i));
    return BRIO_OK;
}

/* Describes them: [{"name":..,"type":..,"block":..}, ...]. Those in 16 bits have low and high. */
static brio_status describe_properties(layer *l, properties all) {
    static const char *const types[] = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
    bool first = true;
    BRIO_FORWARD(brio_output_format(l->out, ",\"%s\":[", all.title));
    for (size_t i = 0; i < all.count; i++) {
        const brio_property *p = &all.list[i];
        values x = {p, all.row, 0, 0};
        if (is_left_out(l, p)) continue;
        BRIO_FORWARD(brio_output_string(l->out, first ? "{\"name\":" : ",{\"name\":"));
        BRIO_FORWARD(brio_page_json(l->out, p->name));
        BRIO_FORWARD(brio_output_format(l->out, ",\"type\":\"%s\",\"block\":\"%c%zu\"", types[p->type], all.prefix, i));
        if (is_rounded(l, p)) {
            find_range(&x, all.n);
            BRIO_FORWARD(put_real(l->out, "low", x.low));
            BRIO_FORWARD(put_real(l->out, "high", x.high));
        }
        BRIO_FORWARD(brio_output_string(l->out, "}"));
        first = false;
    }
    return brio_output_string(l->out, "]");
}

/* --- the layer --- */

static brio_status describe_certificate(brio_output *out, const brio_certificate *c) {
    const struct {
        const char *name;
        int yes;
    } answers[] = {{"closed", c->closed}, {"manifold", c->manifold}, {"oriented", c->oriented}};
    BRIO_FORWARD(brio_output_format(out, ",\"certificate\":{\"components\":%zu", c->components));
    for (size_t i = 0; i < 3; i++)
        BRIO_FORWARD(brio_output_format(out, ",\"%s\":%s", answers[i].name, answers[i].yes ? "true" : "false"));
    BRIO_FORWARD(brio_output_format(out, ",\"genus\":%lld", (long long)c->genus));
    BRIO_FORWARD(put_count(out, "boundary_edges", c->boundary_edges));
    BRIO_FORWARD(put_count(out, "boundary_loops", c->boundary_loops));
    BRIO_FORWARD(put_count(out, "nonmanifold_edges", c->nonmanifold_edges));
    BRIO_FORWARD(put_count(out, "nonmanifold_vertices", c->nonmanifold_vertices));
    BRIO_FORWARD(put_count(out, "flipped_edges", c->flipped_edges));
    BRIO_FORWARD(brio_output_format(out, ",\"self_intersections\":%lld", (long long)c->self_intersections));
    BRIO_FORWARD(put_real(out, "area", c->area));
    BRIO_FORWARD(put_real(out, "volume", c->volume));
    return brio_output_string(out, "}");
}

static brio_status describe(layer *l, const brio_certificate *c, size_t hull) {
    brio_output *out = l->out;
    const brio_sent_order *o = &l->order;
    const brio_mesh *m = l->mesh;
    BRIO_FORWARD(brio_output_string(out, "<script type=\"application/json\" class=\"layer\">{\"name\":"));
    BRIO_FORWARD(brio_page_json(out, l->how->name));
    BRIO_FORWARD(brio_output_string(out, ",\"report\":"));
    BRIO_FORWARD(brio_page_json(out, l->how->report));
    BRIO_FORWARD(brio_output_string(out, ",\"low\":["));
    for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_output_double(out, k ? ',' : 0, l->low[k]));
    BRIO_FORWARD(brio_output_string(out, "]"));
    BRIO_FORWARD(put_real(out, "step", l->step));
    BRIO_FORWARD(put_count(out, "exact", l->how->exact));
    BRIO_FORWARD(put_count(out, "normals_left_out", leaves_normals_out(l)));
    BRIO_FORWARD(put_count(out, "vertices", o->num_vertices));
    BRIO_FORWARD(put_count(out, "all_vertices", m->num_vertices));
    BRIO_FORWARD(put_count(out, "faces", o->num_faces));
    BRIO_FORWARD(put_count(out, "all_faces", m->num_faces));
    BRIO_FORWARD(put_count(out, "triangles", o->num_triangles));
    BRIO_FORWARD(put_count(out, "tetrahedra", m->num_tetrahedra));
    BRIO_FORWARD(put_count(out, "hull", hull));
    BRIO_FORWARD(put_count(out, "edges", m->num_edges));
    BRIO_FORWARD(put_count(out, "boundary", o->num_boundary));
    BRIO_FORWARD(put_count(out, "nonmanifold", o->num_nonmanifold));
    BRIO_FORWARD(put_count(out, "flipped", o->num_flipped));
    const brio_mesh faces = brio_mesh_faces_as_points(m);
    BRIO_FORWARD(put_real(out, "white", brio_colour_white(m)));
    BRIO_FORWARD(put_real(out, "face_white", brio_colour_white(&faces)));
    BRIO_FORWARD(describe_properties(l, of_vertices(l)));
    BRIO_FORWARD(describe_properties(l, of_faces(l)));
    if (m->num_faces) BRIO_FORWARD(describe_certificate(out, c));
    BRIO_FORWARD(brio_page_describe_explanation(out, l->how->explanation));
    return brio_output_string(out, "}</script>\n");
}

/* Refuses indices out of range, and more than the numbers of a page can name. */
static brio_status check(brio_context *ctx, const brio_mesh *m) {
    const size_t most = (size_t)1 << 28;
    BRIO_FORWARD(brio_refuse_vertices(ctx, m->vertices, m->num_vertices, "the mesh"));
    BRIO_FORWARD(brio_mesh_check_faces(ctx, m));
    BRIO_EXPECT(ctx, m->num_vertices <= UINT32_MAX && m->num_faces <= most && m->num_tetrahedra <= most,
                BRIO_ERR_TOO_LARGE, "a page shows at most 2^28 faces and tetrahedra");
    for (size_t i = 0; i < 4 * m->num_tetrahedra; i++)
        BRIO_EXPECT(ctx, m->tetrahedra[i] < m->num_vertices, BRIO_ERR_ARGUMENT,
                    "tetrahedron %zu has the vertex %u, and there are %zu", i / 4, m->tetrahedra[i], m->num_vertices);
    for (size_t i = 0; i < 2 * m->num_edges; i++)
        BRIO_EXPECT(ctx, m->edges[i] < m->num_vertices, BRIO_ERR_ARGUMENT,
                    "edge %zu has the vertex %u, and there are %zu", i / 2, m->edges[i], m->num_vertices);
    return BRIO_OK;
}

static brio_status put_numbers(layer *l) {
    indices x = {l->order.vertex, NULL, 1, 0};
    if (!l->how->exact) return BRIO_OK;
    return put_column(l, "vertices", index_at, &x, l->order.num_vertices, 4);
}

brio_status brio_page_layer_write(brio_output *out, const brio_mesh *mesh, const brio_page_how *how,
                                  uint64_t *thinned) {
    brio_status status = BRIO_OK;
    layer l = {.out = out, .mesh = mesh, .how = how, .order.ctx = out->ctx};
    brio_certificate c = {0};
    size_t hull = 0;
    BRIO_TRY(check(out->ctx, mesh));
    if (mesh->num_faces) BRIO_TRY(brio_mesh_certificate(out->ctx, mesh, &c));
    find_box(&l);
    BRIO_TRY(brio_sent_order_find(out->ctx, mesh, how->most_points, &l.order));
    BRIO_TRY(put_coordinates(&l));
    BRIO_TRY(put_numbers(&l));
    if (mesh->num_faces) BRIO_TRY(put_faces(&l));
    if (mesh->num_faces && how->self_intersections) BRIO_TRY(put_crossings(&l, &c));
    if (mesh->num_tetrahedra) BRIO_TRY(put_corners(&l, "tetrahedra", mesh->tetrahedra, 4, mesh->num_tetrahedra));
    if (mesh->num_tetrahedra) BRIO_TRY(put_hull(&l, &hull));
    if (mesh->num_edges) BRIO_TRY(put_corners(&l, "edges", mesh->edges, 2, mesh->num_edges));
    BRIO_TRY(put_properties(&l, of_vertices(&l)));
    BRIO_TRY(put_properties(&l, of_faces(&l)));
    BRIO_TRY(brio_page_explanation(out, how));
    BRIO_TRY(describe(&l, &c, hull));
    *thinned = mesh->num_vertices - l.order.num_vertices;
done:
    brio_sent_order_free(&l.order);
    brio_certificate_free(&c);
    return status;
}
