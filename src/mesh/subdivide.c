/* Butterfly subdivision of triangle meshes.
 *
 * Every edge gets a new vertex and every triangle becomes four; the old vertices stay. Where both ends of an edge have
 * six neighbours, the new vertex is the butterfly's: 1/2 of each end, plus 1/8 of the two opposite vertices, less 1/16
 * of the four wings. At an end v with K != 6 neighbours e_j, counted from the far end of the edge, it is 3/4 v + sum
 * s_j e_j. There s_j = (1/4 + cos(2 pi j / K) + cos(4 pi j / K) / 2) / K for K > 4; a table has the weights for K < 5.
 * Where both ends have K != 6, the new vertex is the mean of the two ends' points. A boundary edge has the four-point
 * rule along the boundary, so the boundary curve depends on itself only. A wing beyond the boundary is replaced by the
 * fourth corner of a parallelogram.
 *
 * The weights s_j consist of three harmonics, so five sums over the neighbours of a vertex give the sums for all its
 * edges: a vertex of K neighbours takes time O(K), not O(K^2).
 *
 * Based on: Dyn, Levin, Gregory. A butterfly subdivision scheme for surface interpolation with tension control. ACM
 * Transactions on Graphics 1990 (tension 1/16). Zorin, Schroeder, Sweldens. Interpolating subdivision for meshes with
 * arbitrary topology. SIGGRAPH 1996.
 * Differs from the paper of 1996: next to the boundary, a wing by parallelogram replaces the special cases. A vertex
 * of two neighbours, which the papers exclude, has midpoints. */
#include "base/float_state.h"
#include "base/scale.h"
#include "base/team.h"
#include "mesh/twins.h"
#include <math.h>
#include <string.h>

enum { MOST_LEVELS = 15, HALF_EDGES_A_THREAD = 1 << 10 };

/* Sums of coordinates below 2^MOST_EXPONENT stay finite: the fewer than 2^32 neighbours of a vertex add less than 2^36
 * times the largest coordinate, and a level makes coordinates at most 4.5 times as large. */
enum { MOST_EXPONENT = 950 };

static const size_t MOST_VERTICES = UINT32_MAX - 16;
static const size_t BATCH = (size_t)1 << 20; /* half-edges or vertices between two reports of progress */
static const double PI = 3.14159265358979323846;

/* The kind of a corner's vertex: with six triangles all round; at the boundary; with another number of triangles all
 * round; or extraordinary with its share of the new vertices already added. */
enum { REGULAR, BOUNDARY, EXTRAORDINARY, PLACED };

typedef struct {
    const brio_mesh *mesh;
    brio_mesh *fine;
    uint32_t *twin;
    uint32_t *edge_vertex; /* new vertex of each half-edge */
    uint8_t *kind;         /* kind of each corner's vertex */
    size_t from;           /* first half-edge of the batch in work */
} subdivider;

/* Reports progress of a level once in BATCH rounds of a loop: the loop is the part from `from` to `to` of the level. */
static inline brio_status report(brio_context *ctx, size_t i, size_t n, double from, double to) {
    if (i % BATCH) return BRIO_OK;
    return brio_progress(ctx, "subdivide", from + (to - from) * ((double)i / (double)n));
}

/* --- neighbourhoods --- */

/* Returns the corner to the left at the same vertex, or BRIO_NO_HALF_EDGE. */
static uint32_t left_of(const subdivider *s, uint32_t corner) {
    return s->twin[brio_previous_corner(corner)];
}

/* Returns the number of triangles round the vertex of a corner, or 0 at the boundary. */
static uint32_t count_round(const subdivider *s, uint32_t corner) {
    uint32_t count = 0, at = corner;
    do {
        at = left_of(s, at);
        count++;
    } while (at != corner && at != BRIO_NO_HALF_EDGE);
    return at == corner ? count : 0;
}

/* Finds the kind of each corner's vertex. Walks left from every boundary corner first: a walk to the left from another
 * corner may miss some corners. */
static brio_status find_kinds(brio_context *ctx, subdivider *s) {
    const uint8_t unknown = UINT8_MAX;
    size_t corners = 3 * s->mesh->num_faces;
    memset(s->kind, unknown, corners);
    for (uint32_t c = 0; c < corners; c++) {
        BRIO_FORWARD(report(ctx, c, corners, 0.2, 0.25));
        if (s->twin[c] != BRIO_NO_HALF_EDGE) continue;
        for (uint32_t at = c; at != BRIO_NO_HALF_EDGE; at = left_of(s, at)) s->kind[at] = BOUNDARY;
    }
    for (uint32_t c = 0; c < corners; c++) {
        BRIO_FORWARD(report(ctx, c, corners, 0.25, 0.4));
        if (s->kind[c] != unknown) continue;
        uint8_t kind = count_round(s, c) == 6 ? REGULAR : EXTRAORDINARY;
        for (uint32_t at = c; s->kind[at] == unknown; at = left_of(s, at)) s->kind[at] = kind;
    }
    return BRIO_OK;
}

static const double *position(const subdivider *s, uint32_t corner) {
    return s->mesh->vertices + 3 * (size_t)s->mesh->face_vertices[corner];
}

/* --- rules --- */

/* Writes the wing across half-edge h: the far vertex of the triangle there, or at the boundary the fourth corner of a
 * parallelogram. */
static void find_wing(const subdivider *s, uint32_t h, double *wing) {
    uint32_t twin = s->twin[h];
    const double *a = position(s, h), *b = position(s, brio_next_corner(h)),
                 *apex = position(s, brio_previous_corner(h));
    for (int k = 0; k < 3; k++)
        wing[k] = twin == BRIO_NO_HALF_EDGE ? a[k] + b[k] - apex[k] : position(s, brio_previous_corner(twin))[k];
}

static void butterfly(const subdivider *s, uint32_t h, double *p) {
    const uint32_t sides[2] = {h, s->twin[h]};
    const double *a = position(s, h), *b = position(s, s->twin[h]);
    double wings[3] = {0}, wing[3];
    for (int i = 0; i < 2; i++) {
        find_wing(s, brio_next_corner(sides[i]), wing);
        for (int k = 0; k < 3; k++) wings[k] += wing[k];
        find_wing(s, brio_previous_corner(sides[i]), wing);
        for (int k = 0; k < 3; k++) wings[k] += wing[k];
    }
    const double *c = position(s, brio_previous_corner(sides[0])), *d = position(s, brio_previous_corner(sides[1]));
    for (int k = 0; k < 3; k++) p[k] = (a[k] + b[k]) / 2 + (c[k] + d[k]) / 8 - wings[k] / 16;
}

/* Applies the four-point rule to the edge's ends and the boundary vertices before and after the edge. */
static void along_boundary(const subdivider *s, uint32_t h, double *p) {
    uint32_t before = brio_previous_corner(h), after = brio_next_corner(h);
    while (s->twin[before] != BRIO_NO_HALF_EDGE) before = brio_previous_corner(s->twin[before]);
    while (s->twin[after] != BRIO_NO_HALF_EDGE) after = brio_next_corner(s->twin[after]);
    const double *a = position(s, h), *b = position(s, brio_next_corner(h));
    const double *o = position(s, before), *e = position(s, brio_next_corner(after));
    for (int k = 0; k < 3; k++) p[k] = 9 * (a[k] + b[k]) / 16 - (o[k] + e[k]) / 16;
}

/* Sums over the neighbours of an extraordinary vertex, relative to the vertex: plain, and weighted by cosines and
 * sines of the angle and of twice the angle. */
typedef struct {
    uint32_t count;
    double plain[3], cosine[2][3], sine[2][3];
} harmonics;

static harmonics sum_round(const subdivider *s, uint32_t corner, uint32_t count) {
    harmonics sums = {.count = count};
    const double *v = position(s, corner);
    for (uint32_t j = 0; j < count; j++, corner = left_of(s, corner)) {
        const double *e = position(s, brio_next_corner(corner));
        for (int turn = 0; turn < 2; turn++) {
            double angle = 2 * PI * (turn + 1) * j / count, c = cos(angle), sn = sin(angle);
            for (int k = 0; k < 3; k++) {
                sums.cosine[turn][k] += c * (e[k] - v[k]);
                sums.sine[turn][k] += sn * (e[k] - v[k]);
            }
        }
        for (int k = 0; k < 3; k++) sums.plain[k] += e[k] - v[k];
    }
    return sums;
}

/* Writes the point of edge j at a vertex of more than four neighbours, relative to the vertex. */
static void from_harmonics(const harmonics *sums, uint32_t j, double *p) {
    double angle = 2 * PI * j / sums->count;
    double c[2] = {cos(angle), cos(2 * angle)}, sn[2] = {sin(angle), sin(2 * angle)};
    for (int k = 0; k < 3; k++) {
        double once = c[0] * sums->cosine[0][k] + sn[0] * sums->sine[0][k];
        double twice = c[1] * sums->cosine[1][k] + sn[1] * sums->sine[1][k];
        p[k] = (sums->plain[k] / 4 + once + twice / 2) / sums->count;
    }
}

/* Writes the point of the corner's edge at a vertex of two to four neighbours, relative to the vertex; the weights are
 * in a table. */
static void from_table(const subdivider *s, uint32_t corner, uint32_t count, double *p) {
    static const double weights[3][4] = {{1. / 2, 0}, {5. / 12, -1. / 12, -1. / 12}, {3. / 8, 0, -1. / 8, 0}};
    const double *v = position(s, corner);
    memset(p, 0, 3 * sizeof *p);
    for (uint32_t j = 0; j < count; j++, corner = left_of(s, corner)) {
        const double *e = position(s, brio_next_corner(corner));
        for (int k = 0; k < 3; k++) p[k] += weights[count - 2][j] * (e[k] - v[k]);
    }
}

/* Adds the share of an extraordinary vertex to the new vertices of its edges. */
static void place_round(subdivider *s, uint32_t start) {
    uint32_t count = count_round(s, start), corner = start;
    harmonics sums = {0};
    if (count > 4) sums = sum_round(s, start, count);
    for (uint32_t j = 0; j < count; j++, corner = left_of(s, corner)) {
        const double *v = position(s, corner);
        double *target = s->fine->vertices + 3 * (size_t)s->edge_vertex[corner], p[3];
        double share = s->kind[brio_next_corner(corner)] >= EXTRAORDINARY ? 0.5 : 1;
        if (count > 4)
            from_harmonics(&sums, j, p);
        else
            from_table(s, corner, count, p);
        for (int k = 0; k < 3; k++) target[k] += share * (v[k] + p[k]);
    }
}

/* --- one level --- */

/* Numbers the edges after the old vertices, in the order of their lower half-edges. */
static brio_status number_edges(brio_context *ctx, subdivider *s, size_t *count) {
    size_t next = s->mesh->num_vertices, corners = 3 * s->mesh->num_faces;
    for (uint32_t h = 0; h < corners; h++) {
        BRIO_FORWARD(report(ctx, h, corners, 0, 0.1));
        next += h < s->twin[h];
    }
    BRIO_EXPECT(ctx, next <= MOST_VERTICES && 4 * s->mesh->num_faces < UINT32_MAX / 3, BRIO_ERR_TOO_LARGE,
                "the subdivided mesh has %zu vertices and %zu faces, more than 32-bit indices can name", next,
                4 * s->mesh->num_faces);
    next = s->mesh->num_vertices;
    for (uint32_t h = 0; h < corners; h++) {
        BRIO_FORWARD(report(ctx, h, corners, 0.1, 0.2));
        s->edge_vertex[h] = h < s->twin[h] ? (uint32_t)next++ : s->edge_vertex[s->twin[h]];
    }
    *count = next;
    return BRIO_OK;
}

static void place_by_own_rule(const subdivider *s, uint32_t h) {
    double *target = s->fine->vertices + 3 * (size_t)s->edge_vertex[h];
    if (s->twin[h] == BRIO_NO_HALF_EDGE)
        along_boundary(s, h, target);
    else if (s->kind[h] < EXTRAORDINARY && s->kind[brio_next_corner(h)] < EXTRAORDINARY)
        butterfly(s, h, target);
}

/* Places the new vertices of half-edges from + begin to from + end - 1. */
static void place_part(void *user, size_t begin, size_t end, int thread) {
    const subdivider *s = user;
    (void)thread;
    for (size_t h = s->from + begin; h < s->from + end; h++)
        if (h < s->twin[h]) place_by_own_rule(s, (uint32_t)h);
}

static brio_status place_vertices(brio_context *ctx, subdivider *s) {
    size_t corners = 3 * s->mesh->num_faces, old = 3 * s->mesh->num_vertices;
    if (old) memcpy(s->fine->vertices, s->mesh->vertices, old * sizeof(double));
    for (s->from = 0; s->from < corners; s->from += BATCH) {
        size_t count = corners - s->from < BATCH ? corners - s->from : BATCH;
        BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, count, HALF_EDGES_A_THREAD), count, place_part, s));
        BRIO_FORWARD(brio_progress(ctx, "subdivide", 0.4 + 0.2 * ((double)(s->from + count) / (double)corners)));
    }
    for (uint32_t c = 0; c < corners; c++) {
        BRIO_FORWARD(report(ctx, c, corners, 0.6, 0.7));
        if (s->kind[c] != EXTRAORDINARY) continue;
        place_round(s, c);
        for (uint32_t at = c; s->kind[at] == EXTRAORDINARY; at = left_of(s, at)) s->kind[at] = PLACED;
    }
    return BRIO_OK;
}

static brio_status make_faces(brio_context *ctx, subdivider *s) {
    size_t faces = s->mesh->num_faces;
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->fine->face_offsets, 4 * faces + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->fine->face_vertices, 12 * faces));
    for (size_t f = 0; f <= 4 * faces; f++) s->fine->face_offsets[f] = 3 * f;
    for (size_t f = 0; f < faces; f++) {
        BRIO_FORWARD(report(ctx, f, faces, 0.7, 0.8));
        const uint32_t *v = s->mesh->face_vertices + 3 * f, *e = s->edge_vertex + 3 * f;
        const uint32_t four[12] = {v[0], e[0], e[2], e[0], v[1], e[1], e[2], e[1], v[2], e[0], e[1], e[2]};
        memcpy(s->fine->face_vertices + 12 * f, four, sizeof four);
    }
    s->fine->num_faces = 4 * faces;
    return BRIO_OK;
}

/* Halves come last where the sum is finite: half of the least double is 0. */
static double mean_of(double a, double b) {
    return isfinite(a + b) ? (a + b) / 2 : a / 2 + b / 2;
}

/* Copies a property for the old vertices. A new vertex gets the mean of its edge's ends for floating-point types. For
 * integer types it gets the value of the first end, because labels have no mean. */
static brio_status make_property(brio_context *ctx, subdivider *s, size_t number) {
    const brio_property *property = &s->mesh->properties[number];
    const uint32_t *v = s->mesh->face_vertices;
    size_t size = brio_scalar_size(property->type), corners = 3 * s->mesh->num_faces;
    double share = 0.2 / (double)s->mesh->num_properties, from = 0.8 + share * (double)number;
    char *data;
    BRIO_FORWARD(brio_mesh_add_property(s->fine, property->name, property->type, (void **)&data));
    memcpy(data, property->data, s->mesh->num_vertices * size);
    for (uint32_t h = 0; h < corners; h++) {
        BRIO_FORWARD(report(ctx, h, corners, from, from + share));
        if (h > s->twin[h]) continue;
        uint32_t a = v[h], b = v[brio_next_corner(h)];
        char *target = data + s->edge_vertex[h] * size;
        double mean = mean_of(brio_property_value(property, a), brio_property_value(property, b));
        if (property->type == BRIO_SCALAR_FLOAT64)
            memcpy(target, &mean, size);
        else if (property->type == BRIO_SCALAR_FLOAT32)
            memcpy(target, &(float){(float)mean}, size);
        else
            memcpy(target, (const char *)property->data + a * size, size);
    }
    return BRIO_OK;
}

/* Makes a property of the new faces. The four parts of a face have its properties. */
static brio_status make_face_property(brio_context *ctx, const subdivider *s, const brio_property *property) {
    size_t size = brio_scalar_size(property->type), faces = s->mesh->num_faces;
    char *data;
    BRIO_FORWARD(brio_mesh_add_face_property(s->fine, property->name, property->type, (void **)&data));
    for (size_t f = 0; f < 4 * faces; f++) {
        BRIO_FORWARD(report(ctx, (uint32_t)f, 4 * faces, 1, 1));
        memcpy(data + f * size, (const char *)property->data + f / 4 * size, size);
    }
    return BRIO_OK;
}

static brio_status subdivide_once(brio_context *ctx, const brio_mesh *mesh, brio_mesh **out) {
    brio_status status = BRIO_OK;
    subdivider s = {.mesh = mesh};
    size_t count = 0;
    *out = NULL;
    BRIO_TRY(brio_mesh_twins(ctx, mesh, &s.twin));
    BRIO_TRY(BRIO_ALLOC(ctx, s.edge_vertex, 3 * mesh->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, s.kind, 3 * mesh->num_faces));
    BRIO_TRY(number_edges(ctx, &s, &count));
    BRIO_TRY(brio_mesh_new(ctx, &s.fine));
    BRIO_TRY(brio_mesh_set_vertices(s.fine, NULL, count));
    BRIO_TRY(find_kinds(ctx, &s));
    BRIO_TRY(place_vertices(ctx, &s));
    BRIO_TRY(make_faces(ctx, &s));
    for (size_t i = 0; i < mesh->num_properties; i++) BRIO_TRY(make_property(ctx, &s, i));
    for (size_t i = 0; i < mesh->num_face_properties; i++)
        BRIO_TRY(make_face_property(ctx, &s, &mesh->face_properties[i]));
    *out = s.fine;
    s.fine = NULL;
done:
    brio_release(ctx, s.twin);
    brio_release(ctx, s.edge_vertex);
    brio_release(ctx, s.kind);
    brio_mesh_free(s.fine);
    return status;
}

/* --- all levels --- */

/* Subdivides level by level. A level is four times the work of the level before, and has its share of the progress
 * bar. */
static brio_status subdivide_levels(brio_context *ctx, const brio_mesh *mesh, int levels, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *coarse = NULL, *fine = NULL;
    const brio_bar bar = brio_progress_bar(ctx);
    *out = NULL;
    for (int level = 0; level < levels; level++) {
        brio_progress_part(ctx, bar, level ? ldexp(1, 2 * (level - levels)) : 0, ldexp(1, 2 * (level + 1 - levels)));
        coarse = fine;
        fine = NULL;
        BRIO_TRY(subdivide_once(ctx, level ? coarse : mesh, &fine));
        brio_mesh_free(coarse);
        coarse = NULL;
    }
    *out = fine;
    fine = NULL;
done:
    brio_progress_part(ctx, bar, 0, 1);
    brio_mesh_free(coarse);
    brio_mesh_free(fine);
    return status;
}

/* Subdivides a mesh whose sums of coordinates doubles cannot hold, times 2^-exponent. Factors of 2 do not change how a
 * new vertex is rounded. Old vertices stay as they are, also those that are too small for the factor. */
static brio_status subdivide_scaled(brio_context *ctx, const brio_mesh *mesh, int levels, int exponent,
                                    brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh scaled = *mesh, *fine = NULL;
    size_t old = 3 * mesh->num_vertices;
    scaled.vertices = NULL;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, scaled.vertices, old));
    BRIO_TRY(brio_scale(ctx, mesh->vertices, old, -exponent, scaled.vertices));
    BRIO_TRY(subdivide_levels(ctx, &scaled, levels, &fine));
    BRIO_TRY(brio_scale_vertices(ctx, fine->vertices, fine->num_vertices, exponent));
    memcpy(fine->vertices, mesh->vertices, old * sizeof *fine->vertices);
    *out = fine;
    fine = NULL;
done:
    brio_release(ctx, scaled.vertices);
    brio_mesh_free(fine);
    return status;
}

brio_status brio_mesh_subdivide(brio_context *ctx, const brio_mesh *mesh, int levels, brio_mesh **out) {
    BRIO_DOOR;
    *out = NULL;
    BRIO_EXPECT(ctx, levels >= 1 && levels <= MOST_LEVELS, BRIO_ERR_ARGUMENT, "%d levels: expected 1 to %d", levels,
                MOST_LEVELS);
    double faces = ldexp((double)mesh->num_faces, 2 * levels);
    BRIO_EXPECT(ctx, faces < (double)(UINT32_MAX / 3), BRIO_ERR_TOO_LARGE,
                "%d levels make %.0f faces of %zu, more than 32-bit indices can name", levels, faces, mesh->num_faces);
    int exponent = brio_exponent(brio_greatest(mesh->vertices, 3 * mesh->num_vertices)) - MOST_EXPONENT;
    return exponent > 0 ? subdivide_scaled(ctx, mesh, levels, exponent, out) : subdivide_levels(ctx, mesh, levels, out);
}
