/* Colours of meshes in pictures: those of the mesh, a property by a colour map, or one colour for the layer. The same
 * as on pages (web/src/colours.js), except for the range of a property: layers share it, for want of sliders. */
#include "base/memory.h"
#include "io/colour.h"
#include "mesh/properties.h"
#include "picture/picture.h"
#include <math.h>
#include <string.h>

static const brio_rgb LAYERS[12] = {{{0xc9, 0xce, 0xd6}}, {{0xe0, 0xa4, 0x58}}, {{0x6f, 0xa8, 0xdc}},
                                    {{0x93, 0xc4, 0x7d}}, {{0xc2, 0x7b, 0xa0}}, {{0x76, 0xa5, 0xaf}},
                                    {{0xff, 0xd9, 0x66}}, {{0x8e, 0x7c, 0xc3}}, {{0xe0, 0x66, 0x66}},
                                    {{0xa2, 0xc4, 0xc9}}, {{0xb6, 0xd7, 0xa8}}, {{0xd5, 0xa6, 0xbd}}};

/* viridis, after its public table, at even distances. */
static const uint8_t VIRIDIS[11][3] = {{0x44, 0x01, 0x54}, {0x48, 0x24, 0x75}, {0x41, 0x44, 0x87}, {0x35, 0x5f, 0x8d},
                                       {0x2a, 0x78, 0x8e}, {0x21, 0x91, 0x8c}, {0x22, 0xa8, 0x84}, {0x44, 0xbf, 0x70},
                                       {0x7a, 0xd1, 0x51}, {0xbd, 0xdf, 0x26}, {0xfd, 0xe7, 0x25}};

/* Properties of clouds that are shown without being asked for. */
static const char *const TELLING[] = {"confidence", "distance", "intensity", "value", "radius"};

brio_rgb brio_map_colour(float t) {
    if (isnan(t)) return (brio_rgb){{128, 128, 128}};
    float x = (t < 0 ? 0 : t > 1 ? 1 : t) * 10;
    int i = x >= 10 ? 9 : (int)x;
    brio_rgb out;
    for (int k = 0; k < 3; k++) {
        float from = VIRIDIS[i][k], to = VIRIDIS[i + 1][k];
        out.c[k] = (uint8_t)lrintf(from + (x - (float)i) * (to - from));
    }
    return out;
}

/* Returns a property, or NULL. Those of faces colour nothing where there are no faces. */
static const brio_property *find(const brio_mesh *m, const char *name, bool of_faces) {
    if (of_faces) return m->num_faces ? brio_mesh_face_property(m, name) : NULL;
    return brio_mesh_property(m, name);
}

/* Takes the colours of the vertices or of the faces, if there are some. */
static brio_status take_colours(brio_context *ctx, const brio_mesh *m, bool of_faces, brio_paint *out) {
    const brio_mesh rows = of_faces ? brio_mesh_faces_as_points(m) : *m;
    const brio_channels colour = brio_colour_of(&rows);
    const double white = brio_colour_white(&rows);
    if (white == 0) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->rgb, rows.num_vertices + 1));
    for (size_t i = 0; i < rows.num_vertices; i++)
        for (int k = 0; k < 3; k++) out->rgb[i].c[k] = brio_colour_byte(brio_property_value(colour.of[k], i), white);
    out->of_faces = of_faces;
    return BRIO_OK;
}

/* --- numbers --- */

/* Numbers of the vertices or the faces: a property, or a coordinate where p is NULL. */
typedef struct {
    const brio_property *p;
    const double *vertices;
    int axis;
    size_t n;
} numbers;

static numbers numbers_of(const brio_mesh *m, const brio_paint *p) {
    return (numbers){.p = find(m, p->name, p->of_faces),
                     .vertices = m->vertices,
                     .axis = p->name[0] - 'x',
                     .n = p->of_faces ? m->num_faces : m->num_vertices};
}

static double number_at(const numbers *x, size_t i) {
    return x->p ? brio_property_value(x->p, i) : x->vertices[3 * i + (size_t)x->axis];
}

/* Takes what is to be shown, and its range. Returns false if the mesh does not have it. */
static bool take_property(const brio_mesh *m, const char *name, brio_paint *out) {
    bool is_axis = strlen(name) == 1 && name[0] >= 'x' && name[0] <= 'z', of_vertices = find(m, name, false) != NULL;
    out->of_faces = !of_vertices && find(m, name, true);
    if (!of_vertices && !out->of_faces && !is_axis) return false;
    out->name = name;
    out->low = INFINITY;
    out->high = -INFINITY;
    const numbers x = numbers_of(m, out);
    for (size_t i = 0; i < x.n; i++) {
        double value = number_at(&x, i);
        if (!isfinite(value)) continue;
        out->low = value < out->low ? value : out->low;
        out->high = value > out->high ? value : out->high;
    }
    return true;
}

brio_status brio_paint_values(brio_context *ctx, const brio_mesh *m, brio_paint *p) {
    if (!p->name) return BRIO_OK;
    const numbers x = numbers_of(m, p);
    if (p->low > p->high) p->low = p->high = 0;
    const double half = p->high / 2 - p->low / 2;
    BRIO_FORWARD(BRIO_ALLOC(ctx, p->value, x.n + 1));
    for (size_t i = 0; i < x.n; i++) {
        double value = number_at(&x, i);
        p->value[i] = !isfinite(value) ? NAN : half > 0 ? (float)((value / 2 - p->low / 2) / half) : 0.5F;
    }
    return BRIO_OK;
}

/* --- all together --- */

brio_status brio_paint_find(brio_context *ctx, const brio_mesh *m, size_t layer, const char *wanted, bool *found,
                            brio_paint *out) {
    *out = (brio_paint){.plain = LAYERS[layer % (sizeof LAYERS / sizeof *LAYERS)]};
    *found = true;
    if (wanted && !strcmp(wanted, "none")) return BRIO_OK;
    if (wanted) {
        *found = take_property(m, wanted, out);
        return BRIO_OK;
    }
    BRIO_FORWARD(take_colours(ctx, m, false, out));
    if (!out->rgb) BRIO_FORWARD(take_colours(ctx, m, true, out));
    if (out->rgb) return BRIO_OK;
    if (m->num_faces || m->num_tetrahedra || m->num_edges) {
        if (find(m, "distance", false)) take_property(m, "distance", out); /* of brio compare */
        return BRIO_OK;
    }
    const char *name = "z";
    for (size_t i = sizeof TELLING / sizeof *TELLING; i-- > 0;)
        if (find(m, TELLING[i], false)) name = TELLING[i];
    take_property(m, name, out);
    return BRIO_OK;
}

void brio_paint_free(brio_context *ctx, brio_paint *p) {
    brio_release(ctx, p->rgb);
    brio_release(ctx, p->value);
}
