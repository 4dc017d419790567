/* Normals of samples from their poles: the direction from the inner pole to the outer pole. The farther a pole, the
 * more accurate its direction, so the vectors to the poles are added without normalisation. If both poles have one
 * label, the direction of the farther pole alone counts.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999 (poles as normals). */
#include "reconstruct/power_crust/sample_normals.h"
#include "base/memory.h"
#include "base/vector.h"
#include "mesh/closest_point.h"
#include <math.h>
#include <string.h>

static bool normalise(double *n) {
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0) || isinf(length)) return false;
    for (int k = 0; k < 3; k++) n[k] /= length;
    return true;
}

/* Writes the normal of a triangle, of length twice its area. */
static void normal_of(const double *a, const double *b, const double *c, double *n) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    brio_cross(u, v, n);
}

/* Adds the vector between the sample and a pole, pointing outwards. */
static void add_pole(const brio_power_diagram *d, const uint8_t *label, size_t s, uint32_t pole, double *n) {
    double sign = label[pole] == BRIO_LABEL_INNER ? -1 : 1;
    for (size_t k = 0; k < 3; k++) n[k] += sign * (d->poles->centre[3 * (size_t)pole + k] - d->samples[3 * s + k]);
}

static bool normal_from_poles(const brio_power_diagram *d, const uint8_t *label, size_t s, double *n) {
    uint32_t far = d->poles->of_sample[2 * s], near = d->poles->of_sample[2 * s + 1];
    n[0] = n[1] = n[2] = 0;
    if (far == BRIO_NO_POLE) return false;
    add_pole(d, label, s, far, n);
    if (near != BRIO_NO_POLE && label[near] != label[far]) add_pole(d, label, s, near, n);
    return normalise(n);
}

/* The triangles of the crust that have area: vertices at one sample make faces without area, which have no normal. */
typedef struct {
    brio_mesh mesh; /* borrows the crust's vertices */
    brio_triangle_tree tree;
} crust_triangles;

static brio_status crust_triangles_new(const brio_mesh *crust, crust_triangles *t) {
    brio_status status = BRIO_OK;
    const uint64_t *offsets = crust->face_offsets, corners = offsets[crust->num_faces];
    brio_mesh *m = &t->mesh;
    *m = (brio_mesh){.num_vertices = crust->num_vertices, .vertices = crust->vertices};
    BRIO_TRY(BRIO_ALLOC(crust->context, m->face_offsets, corners + 1));
    BRIO_TRY(BRIO_ALLOC(crust->context, m->face_vertices, 3 * corners));
    m->face_offsets[0] = 0;
    for (size_t f = 0; f < crust->num_faces; f++)
        for (uint64_t h = offsets[f] + 2; h < offsets[f + 1]; h++) {
            const uint32_t *corner = crust->face_vertices;
            uint32_t v[3] = {corner[offsets[f]], corner[h - 1], corner[h]};
            double n[3];
            normal_of(m->vertices + 3 * (size_t)v[0], m->vertices + 3 * (size_t)v[1], m->vertices + 3 * (size_t)v[2],
                      n);
            if (!normalise(n)) continue;
            memcpy(m->face_vertices + 3 * m->num_faces++, v, sizeof v);
            m->face_offsets[m->num_faces] = 3 * m->num_faces;
        }
    if (m->num_faces) BRIO_TRY(brio_triangle_tree_new(crust->context, m, &t->tree));
done:
    return status;
}

static void crust_triangles_free(brio_context *ctx, crust_triangles *t) {
    brio_release(ctx, t->mesh.face_offsets);
    brio_release(ctx, t->mesh.face_vertices);
    brio_triangle_tree_free(ctx, &t->tree);
}

static void normal_from_crust(const crust_triangles *t, const double *p, double *n) {
    const brio_triangle_tree *tree = &t->tree;
    double closest[3];
    size_t triangle;
    n[0] = n[1] = n[2] = 0;
    if (!t->mesh.num_faces) return;
    brio_closest_point(tree, p, closest, &triangle);
    const uint32_t *v = tree->triangles[triangle];
    normal_of(tree->vertices + 3 * (size_t)v[0], tree->vertices + 3 * (size_t)v[1], tree->vertices + 3 * (size_t)v[2],
              n);
    if (!normalise(n)) n[0] = n[1] = n[2] = 0;
}

brio_status brio_sample_normals(const brio_power_diagram *d, const uint8_t *label, const uint32_t *representative,
                                const uint32_t *order, const brio_mesh *crust, double *normals) {
    brio_status status = BRIO_OK;
    crust_triangles triangles = {0};
    for (size_t s = 0; s < d->num_samples; s++) {
        double *n = normals + 3 * (size_t)order[s];
        size_t r = representative[s];
        if (r < s) {
            memcpy(n, normals + 3 * (size_t)order[r], 3 * sizeof *n);
        } else if (!normal_from_poles(d, label, r, n)) {
            if (!triangles.mesh.vertices) BRIO_TRY(crust_triangles_new(crust, &triangles));
            normal_from_crust(&triangles, d->samples + 3 * r, n);
        }
    }
done:
    crust_triangles_free(crust->context, &triangles);
    return status;
}
