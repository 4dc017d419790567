/* Parts, box and thin places of a random solid's mesh. */
#include "brio/testdata.h"
#include "testdata/solid_parts.h"
#include "base/team.h"
#include "base/union_find.h"
#include "base/vector.h"
#include <math.h>
#include <string.h>

enum {
    PROBES = 8,            /* points of a line that are looked at */
    MOST_PROBED = 1 << 15, /* vertices with such lines: of more, every second, every third, ... */
    VERTICES_A_THREAD = 1 << 8
};

static const double FIRST_PROBE = 0.15; /* of the line's length: nearer, rounding decides the side */
static const double OPPOSITE = -0.5;    /* cosine of normals of about parallel sides of a wall */
static const double STEP = 1e-3;        /* of differences, in cells */

/* --- parts --- */

typedef struct {
    double low[3], high[3], volume, diagonal;
} part;

static void add_triangle(part *a, const double *p, const double *q, const double *r) {
    double n[3];
    brio_cross(q, r, n);
    a->volume += brio_dot(p, n) / 6;
    for (int k = 0; k < 3; k++) {
        a->low[k] = fmin(a->low[k], fmin(p[k], fmin(q[k], r[k])));
        a->high[k] = fmax(a->high[k], fmax(p[k], fmax(q[k], r[k])));
    }
}

static void measure_parts(const brio_mesh *mesh, uint32_t *parent, part *parts) {
    for (uint32_t v = 0; v < mesh->num_vertices; v++)
        parts[v] = (part){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0, 0};
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *c = mesh->face_vertices + 3 * f;
        add_triangle(&parts[brio_find(parent, c[0])], mesh->vertices + 3 * (size_t)c[0],
                     mesh->vertices + 3 * (size_t)c[1], mesh->vertices + 3 * (size_t)c[2]);
    }
    for (uint32_t v = 0; v < mesh->num_vertices; v++)
        if (brio_find(parent, v) == v) parts[v].diagonal = sqrt(brio_square_distance(parts[v].low, parts[v].high));
}

/* Returns the diagonal that a part needs so that at most keep->most are kept. */
static double least_of_largest(const brio_mesh *mesh, const part *parts, const brio_solid_parts *keep) {
    double largest[BRIO_SOLID_MOST_PARTS] = {0};
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        double d = parts[v].volume > 0 || keep->voids ? parts[v].diagonal : 0;
        for (int i = 0; i < BRIO_SOLID_MOST_PARTS; i++)
            if (d > largest[i]) {
                double other = largest[i];
                largest[i] = d;
                d = other;
            }
    }
    return fmax(keep->least, largest[keep->most - 1]);
}

/* Keeps the triangles of the parts whose `diagonal` is positive. */
static void compact(brio_mesh *mesh, uint32_t *parent, const part *parts, uint32_t *number) {
    size_t faces = 0;
    uint32_t vertices = 0;
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        if (!(parts[brio_find(parent, v)].diagonal > 0)) continue;
        number[v] = vertices++;
        memmove(mesh->vertices + 3 * (size_t)number[v], mesh->vertices + 3 * (size_t)v, 3 * sizeof(double));
    }
    for (size_t f = 0; f < mesh->num_faces; f++) {
        uint32_t *c = mesh->face_vertices + 3 * f, *to = mesh->face_vertices + 3 * faces;
        if (!(parts[brio_find(parent, c[0])].diagonal > 0)) continue;
        for (int i = 0; i < 3; i++) to[i] = number[c[i]];
        faces++;
    }
    mesh->num_vertices = vertices;
    mesh->num_faces = faces;
}

brio_status brio_solid_keep_parts(brio_context *ctx, brio_mesh *mesh, const brio_solid_parts *keep) {
    brio_status status = BRIO_OK;
    uint32_t *parent = NULL, *number = NULL;
    part *parts = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, parent, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, number, mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, parts, mesh->num_vertices));
    for (uint32_t v = 0; v < mesh->num_vertices; v++) parent[v] = v;
    for (size_t i = 0; i < 3 * mesh->num_faces; i++)
        brio_unite(parent, mesh->face_vertices[i], mesh->face_vertices[i / 3 * 3], true);
    measure_parts(mesh, parent, parts);
    double least = least_of_largest(mesh, parts, keep);
    for (uint32_t v = 0; v < mesh->num_vertices; v++)
        if (parts[v].diagonal < least || (parts[v].volume <= 0 && !keep->voids)) parts[v].diagonal = 0;
    compact(mesh, parent, parts, number);
done:
    brio_release(ctx, parent);
    brio_release(ctx, number);
    brio_release(ctx, parts);
    return status;
}

/* --- box and area --- */

void brio_solid_box_of(const brio_mesh *mesh, double *low, double *high) {
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) {
        low[i % 3] = fmin(low[i % 3], mesh->vertices[i]);
        high[i % 3] = fmax(high[i % 3], mesh->vertices[i]);
    }
}

double brio_solid_area(const brio_mesh *mesh) {
    double area = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *c = mesh->face_vertices + 3 * f;
        const double *p = mesh->vertices + 3 * (size_t)c[0], *q = mesh->vertices + 3 * (size_t)c[1];
        const double *r = mesh->vertices + 3 * (size_t)c[2];
        double u[3], v[3], n[3];
        for (int k = 0; k < 3; k++) u[k] = q[k] - p[k], v[k] = r[k] - p[k];
        brio_cross(u, v, n);
        area += 0.5 * sqrt(brio_dot(n, n));
    }
    return area;
}

/* --- thin places --- */

typedef struct {
    const brio_implicit_grid *grid;
    const brio_mesh *mesh;
    double thickness;
    size_t stride, thin;
} probe;

static void normal_at(const brio_implicit_grid *grid, const double *p, double *n) {
    double h = STEP * grid->cell;
    for (int k = 0; k < 3; k++) {
        double q[3] = {p[0], p[1], p[2]};
        q[k] = p[k] + h;
        n[k] = grid->value(q, grid->user);
        q[k] = p[k] - h;
        n[k] -= grid->value(q, grid->user);
    }
    double length = sqrt(brio_dot(n, n));
    for (int k = 0; k < 3; k++) n[k] = length > 0 ? n[k] / length : 0;
}

/* Returns whether the line from p along side * n leaves that side of the surface soon. */
static bool is_thin(const probe *w, const double *p, const double *n, double side) {
    for (int i = 0; i < PROBES; i++) {
        double t = w->thickness * (FIRST_PROBE + (1 - FIRST_PROBE) * i / (PROBES - 1)), q[3], other[3];
        for (int k = 0; k < 3; k++) q[k] = p[k] + side * t * n[k];
        if (side * w->grid->value(q, w->grid->user) > 0) continue;
        normal_at(w->grid, q, other);
        return brio_dot(n, other) < OPPOSITE;
    }
    return false;
}

static void count_thin(void *user, size_t begin, size_t end, int thread) {
    probe *w = user;
    size_t thin = 0;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const double *p = w->mesh->vertices + 3 * i * w->stride;
        double n[3];
        normal_at(w->grid, p, n);
        thin += is_thin(w, p, n, -1) || is_thin(w, p, n, 1);
    }
    __atomic_fetch_add(&w->thin, thin, __ATOMIC_RELAXED); /* read after all threads have ended */
}

brio_status brio_solid_thin_share(brio_context *ctx, const brio_implicit_grid *grid, const brio_mesh *mesh,
                                  double thickness, double *out) {
    size_t stride = mesh->num_vertices / MOST_PROBED + 1, n = mesh->num_vertices / stride;
    probe w = {grid, mesh, thickness, stride, 0};
    int threads = brio_threads(ctx, n, VERTICES_A_THREAD);
    brio_status status = brio_for_chunks(ctx, threads, n, VERTICES_A_THREAD, count_thin, &w);
    *out = n ? (double)w.thin / (double)n : 0;
    return status;
}
