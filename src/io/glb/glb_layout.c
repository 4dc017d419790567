/* What a GLB file will hold.
 *
 * Single precision has 24 bits. If these hold every coordinate, the origin is 0. Otherwise coordinates are stored
 * relative to the middle of their box, rounded to a sixteenth of its longest side, if that moves vertices less. The node
 * that holds the mesh is translated by the origin, in double precision.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "io/glb/glb_layout.h"
#include "base/memory.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { HEADERS = 12 + 8 + 8, STEPS = 4 };

/* --- coordinates --- */

/* The greatest distance that a vertex moves if coordinates are stored relative to an origin; infinite if they are too
 * large. */
static double moved_by(const brio_mesh *m, const double *origin) {
    double most = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double square = 0;
        for (size_t k = 0; k < 3; k++) {
            double x = m->vertices[3 * v + k], relative = x - origin[k];
            if (!(fabs(relative) <= 0x1.fffffep127)) return (double)INFINITY;
            double d = (double)(float)relative + origin[k] - x;
            square += d * d;
            most = fmax(most, fabs(d)); /* squares of the smallest numbers are 0 */
        }
        most = fmax(most, sqrt(square));
    }
    return most;
}

/* Finds the middle of the box, rounded so that it has few digits. */
static void find_middle(const brio_mesh *m, double *middle) {
    double least[3], most[3], side = 0;
    for (size_t k = 0; k < 3; k++) least[k] = most[k] = m->vertices[k];
    for (size_t i = 3; i < 3 * m->num_vertices; i++) {
        least[i % 3] = fmin(least[i % 3], m->vertices[i]);
        most[i % 3] = fmax(most[i % 3], m->vertices[i]);
    }
    for (size_t k = 0; k < 3; k++) side = fmax(side, most[k] / 2 - least[k] / 2);
    double step = side > 0 ? ldexp(1, ilogb(side) + 1 - STEPS) : 0;
    for (size_t k = 0; k < 3; k++) {
        double x = least[k] / 2 + most[k] / 2, rounded = step > 0 ? rint(x / step) * step + 0.0 : x; /* no -0 */
        middle[k] = isfinite(rounded) ? rounded : 0;
    }
}

static void choose_origin(brio_glb_layout *l) {
    const brio_mesh *m = l->mesh;
    double middle[3] = {0, 0, 0}, moved = moved_by(m, l->origin);
    if (moved > 0) find_middle(m, middle);
    double less = moved > 0 ? moved_by(m, middle) : moved;
    l->moved = less < moved ? less : moved;
    for (int k = 0; k < 3; k++) l->origin[k] = less < moved ? middle[k] : 0;
    if (!isfinite(l->moved)) return;
    for (size_t i = 0; i < 3 * m->num_vertices; i++) {
        float x = (float)(m->vertices[i] - l->origin[i % 3]);
        l->least[i % 3] = i < 3 || x < l->least[i % 3] ? x : l->least[i % 3];
        l->most[i % 3] = i < 3 || x > l->most[i % 3] ? x : l->most[i % 3];
    }
}

/* --- attributes --- */

static int type_of(const brio_property *p) {
    switch (p->type) {
    case BRIO_SCALAR_INT8:
        return BRIO_GLB_INT8;
    case BRIO_SCALAR_UINT8:
        return BRIO_GLB_UINT8;
    case BRIO_SCALAR_INT16:
        return BRIO_GLB_INT16;
    case BRIO_SCALAR_UINT16:
        return BRIO_GLB_UINT16;
    default: /* attributes have no integers of 32 bits and no doubles */
        return BRIO_GLB_FLOAT;
    }
}

static void add_output(brio_glb_layout *l, const brio_glb_output *output) {
    brio_glb_output *o = &l->outputs[l->num_outputs++];
    int size = output->type == BRIO_GLB_FLOAT ? 4 : output->type >= BRIO_GLB_INT16 ? 2 : 1;
    *o = *output;
    o->stride = (size * o->components + 3) / 4 * 4;
    o->offset = l->size;
    l->size += (uint64_t)o->stride * l->mesh->num_vertices;
}

/* Adds properties that are one attribute, if the mesh has them all in one type. Returns how many were taken.
 *  names  the first three are needed, the fourth may be NULL or missing. */
static int add_group(brio_glb_layout *l, const char *name, const char *const names[4], bool floats) {
    brio_glb_output o = {.components = 0};
    strcpy(o.name, name);
    for (int k = 0; k < 4 && names[k]; k++) {
        const brio_property *p = brio_mesh_property(l->mesh, names[k]);
        bool same = p && (k == 0 || type_of(p) == o.type);
        if (!same ||
            (type_of(p) != BRIO_GLB_FLOAT && (floats || p->type == BRIO_SCALAR_INT8 || p->type == BRIO_SCALAR_INT16)))
            break;
        o.type = type_of(p);
        o.from[o.components++] = p;
    }
    if (o.components < 3) return 0;
    o.normalized = o.type != BRIO_GLB_FLOAT;
    add_output(l, &o);
    return o.components;
}

static bool is_taken(const brio_glb_layout *l, const brio_property *p) {
    for (size_t i = 0; i < l->num_outputs; i++)
        for (int k = 0; k < 4; k++)
            if (l->outputs[i].from[k] == p) return true;
    return false;
}

static brio_status plan_attributes(brio_context *ctx, brio_glb_layout *l) {
    static const char *const normal[4] = {"nx", "ny", "nz", NULL}, *const colour[4] = {"red", "green", "blue", "alpha"};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, l->outputs, l->mesh->num_properties + 1));
    add_output(l, &(brio_glb_output){.name = "POSITION", .type = BRIO_GLB_FLOAT, .components = 3});
    add_group(l, "NORMAL", normal, true);
    add_group(l, "COLOR_0", colour, false);
    for (size_t i = 0; i < l->mesh->num_properties; i++) {
        const brio_property *p = &l->mesh->properties[i];
        brio_glb_output o = {.name = "_", .type = type_of(p), .components = 1, .from = {p}};
        if (is_taken(l, p)) continue;
        strncat(o.name, p->name, sizeof o.name - 2);
        add_output(l, &o);
    }
done:
    return status;
}

/* --- the file --- */

static void plan_indices(brio_glb_layout *l) {
    const brio_mesh *m = l->mesh;
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t corners = m->face_offsets[f + 1] - m->face_offsets[f];
        l->num_triangles += corners > 2 ? corners - 2 : 0;
    }
    l->triangles_at = l->size;
    l->edges_at = l->triangles_at + 3 * sizeof(uint32_t) * l->num_triangles;
    l->size = l->edges_at + 2 * sizeof(uint32_t) * m->num_edges;
}

brio_status brio_glb_layout_make(brio_context *ctx, const char *name, const brio_write_job *job, brio_glb_layout *l) {
    brio_status status = BRIO_OK;
    *l = (brio_glb_layout){.mesh = job->mesh};
    if (l->mesh->num_vertices) {
        choose_origin(l);
        BRIO_REQUIRE(ctx, isfinite(l->moved), BRIO_ERR_ARGUMENT, "%s: coordinates do not fit single precision", name);
        BRIO_TRY(plan_attributes(ctx, l));
        plan_indices(l);
    }
    BRIO_TRY(brio_glb_json(ctx, job->options->comment, l));
    uint64_t size = HEADERS + l->json_size + l->size;
    BRIO_REQUIRE(ctx, size <= UINT32_MAX, BRIO_ERR_ARGUMENT, "%s: %" PRIu64 " bytes, a GLB file has at most %" PRIu32,
                 name, size, UINT32_MAX);
done:
    return status;
}

void brio_glb_layout_free(brio_context *ctx, brio_glb_layout *l) {
    brio_release(ctx, l->outputs);
    brio_release(ctx, l->json);
}
