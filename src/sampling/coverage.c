/* How well points cover a surface, and the surface the points.
 *
 * The spacing at a point is what it would be on a square grid that has as many points within the distance of the sixth
 * nearest one. Faces are cut into fans, and these into parts of about two spacings, at most GRID to a side. The
 * distance of a part is that of its middle from the nearest point, in spacings at that point. Faces that are over
 * SUSPECT somewhere and meet across edges are a bridge if one of them is over FAR.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999 (empty balls along the surface measure
 * the
 *           sampling). */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/team.h"
#include "base/union_find.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "mesh/closest_point.h"
#include "mesh/crossing_faces.h"
#include "mesh/edge_rings.h"
#include "query/nearest_points.h"
#include <stdlib.h>
#include <string.h>

/* In spacings: LEFT_OUT and FAR as the contract says; SUSPECT chosen, as for the bridges of surfaces. GRID_SHARE: the
 * spacing by the distance of the sixth nearest point, the root of pi / 6. */
static const double LEFT_OUT = 2, SUSPECT = 2.5, FAR = 5, GRID_SHARE = 0.72360125455826767;

/* FEW: where at most 1 / FEW of the points are still open, the faces near them are picked first. NEIGHBOURS is the
 * contract's; all others are chosen. */
enum { NEIGHBOURS = 6, GRID = 12, BATCH = 1 << 14, ITEMS_A_CHUNK = 64, FEW = 8, HUGE_EXPONENT = 100 };

enum { NOT_LEFT = 0, IS_LEFT = 1, OPEN = 2 };
static const uint32_t NO_VERTEX = UINT32_MAX;

/* What is known of a face. */
typedef struct {
    double area, far_area;
    double ratio, distance; /* at its widest place, in spacings and as a length */
    double widest[3];
} face_facts;

typedef struct {
    brio_context *ctx;
    const brio_mesh *mesh;
    brio_point_tree tree;
    double *spacing; /* in the order of the tree; NULL where few are needed */
    brio_triangle_tree faces;
    face_facts *of;
    const double *points;
    uint8_t *used;     /* #V: whether a vertex is one of a face that has an area */
    uint32_t *vertex;  /* in the order of the tree: a vertex that is near the point, or NO_VERTEX */
    uint8_t *left_out; /* #P: whether the surface leaves a point; OPEN where that is not known yet */
    size_t first;
} coverage;

/* Returns the spacing at a point of the tree: 0 where too many coincide. */
static double spacing_at(const brio_point_tree *tree, size_t place) {
    brio_near_point near[BRIO_NEAR_ROOM];
    for (size_t wanted = NEIGHBOURS + 1; wanted <= BRIO_MOST_NEAR; wanted = wanted < 32 ? 32 : 2 * wanted) {
        size_t found = brio_nearest_points(tree, tree->point[place], wanted, INFINITY, near);
        brio_sort_near_points(tree, near, found);
        size_t last = found > NEIGHBOURS ? NEIGHBOURS : found - 1;
        while (last + 1 < found && !(near[last].square > 0)) last++;
        if (near[last].square > 0 || found < wanted) return GRID_SHARE * sqrt(near[last].square);
    }
    return 0;
}

static void measure_spacings(void *user, size_t begin, size_t end, int thread) {
    const coverage *c = user;
    (void)thread;
    for (size_t i = c->first + begin; i < c->first + end; i++) c->spacing[i] = spacing_at(&c->tree, i);
}

/* Returns how far a place is from the nearest point, and writes the spacing there. */
static double distance_of(const coverage *c, const double *p, double *spacing) {
    brio_near_point near[BRIO_NEAR_ROOM];
    brio_nearest_points(&c->tree, p, 1, INFINITY, near);
    *spacing = c->spacing[near[0].place];
    return sqrt(near[0].square);
}

/* Looks at one part of a face, of the given area. */
static void look(const coverage *c, const double *p, double area, face_facts *f) {
    double spacing, d = distance_of(c, p, &spacing), ratio = spacing > 0 ? d / spacing : 0;
    if (ratio > FAR) f->far_area += area;
    if (ratio <= f->ratio) return;
    f->ratio = ratio;
    f->distance = d;
    memcpy(f->widest, p, sizeof f->widest);
}

static void look_at_triangle(const coverage *c, const double *const t[3], face_facts *f) {
    double u[3], v[3], n[3], p[3], spacing;
    for (int k = 0; k < 3; k++) {
        u[k] = t[1][k] - t[0][k], v[k] = t[2][k] - t[0][k];
        p[k] = (t[0][k] + t[1][k] + t[2][k]) / 3;
    }
    brio_cross(u, v, n);
    double area = 0.5 * brio_length(n),
           longest = sqrt(fmax(brio_dot(u, u), fmax(brio_dot(v, v), brio_square_distance(t[1], t[2]))));
    f->area += area;
    distance_of(c, p, &spacing);
    double wanted = spacing > 0 ? ceil(longest / (2 * spacing)) : 1;
    int parts = wanted < 1 ? 1 : wanted > GRID ? GRID : (int)wanted;
    for (int i = 0; i < parts; i++)
        for (int j = 0; j < 2 * (parts - i) - 1; j++) { /* triangles of the row, every second one upside down */
            double x = (j / 2 + (j % 2 ? 2.0 : 1.0) / 3) / parts, y = (i + (j % 2 ? 2.0 : 1.0) / 3) / parts;
            for (int k = 0; k < 3; k++) p[k] = t[0][k] + x * u[k] + y * v[k];
            look(c, p, area / (parts * parts), f);
        }
}

static void look_at_faces(void *user, size_t begin, size_t end, int thread) {
    const coverage *c = user;
    const brio_mesh *m = c->mesh;
    (void)thread;
    for (size_t f = c->first + begin; f < c->first + end; f++) {
        c->of[f] = (face_facts){.area = 0};
        for (uint64_t h = m->face_offsets[f] + 2; h < m->face_offsets[f + 1]; h++) {
            const uint64_t corner[3] = {m->face_offsets[f], h - 1, h};
            const double *t[3];
            for (int k = 0; k < 3; k++) t[k] = m->vertices + 3 * (size_t)m->face_vertices[corner[k]];
            look_at_triangle(c, t, &c->of[f]);
        }
    }
}

/* Runs over all items in threads, and reports. */
static brio_status run(coverage *c, size_t count, double from, double to, void (*body)(void *, size_t, size_t, int)) {
    for (c->first = 0; c->first < count; c->first += BATCH) {
        size_t part = count - c->first < BATCH ? count - c->first : BATCH;
        BRIO_FORWARD(brio_progress(c->ctx, "coverage", from + (to - from) * (double)c->first / (double)count));
        BRIO_FORWARD(brio_for_chunks(c->ctx, brio_threads(c->ctx, part, ITEMS_A_CHUNK), part, ITEMS_A_CHUNK, body, c));
    }
    return BRIO_OK;
}

/* --- bridges --- */

/* Joins suspicious faces across edges: parent[f] leads to the first face of its set. */
static brio_status join_faces(const coverage *c, uint32_t *parent) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = c->mesh;
    uint32_t *ring = NULL, *face = NULL;
    BRIO_TRY(brio_edge_rings(c->ctx, m, &ring));
    BRIO_TRY(BRIO_ALLOC(c->ctx, face, m->face_offsets[m->num_faces]));
    for (uint32_t f = 0; f < m->num_faces; f++) {
        parent[f] = f;
        for (uint64_t h = m->face_offsets[f]; h < m->face_offsets[f + 1]; h++) face[h] = f;
    }
    for (uint64_t h = 0; h < m->face_offsets[m->num_faces]; h++)
        if (c->of[face[h]].ratio > SUSPECT && c->of[face[ring[h]]].ratio > SUSPECT)
            brio_unite(parent, face[h], face[ring[h]], true);
done:
    brio_release(c->ctx, ring);
    brio_release(c->ctx, face);
    return status;
}

/* Sums up what is known of the faces. Afterwards of[f].ratio of the first face of a bridge is that of the bridge, and
 * its area, distance and place are the bridge's. */
static brio_status sum_up(const coverage *c, uint8_t *bridge, brio_coverage *out) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = c->mesh;
    uint32_t *parent = NULL;
    double all = 0, far = 0, bridges = 0, largest = 0;
    BRIO_TRY(BRIO_ALLOC(c->ctx, parent, m->num_faces));
    BRIO_TRY(join_faces(c, parent));
    for (uint32_t f = 0; f < m->num_faces; f++) all += c->of[f].area, far += c->of[f].far_area;
    for (uint32_t f = 0; f < m->num_faces; f++) {
        face_facts *of = &c->of[f], *root = &c->of[brio_find(parent, f)];
        if (of == root || !(of->ratio > SUSPECT)) continue;
        root->area += of->area;
        if (of->distance > root->distance) {
            root->distance = of->distance;
            memcpy(root->widest, of->widest, sizeof root->widest);
        }
        root->ratio = fmax(root->ratio, of->ratio);
    }
    for (uint32_t f = 0; f < m->num_faces; f++) {
        uint32_t first = brio_find(parent, f);
        const face_facts *root = &c->of[first];
        bool is_bridge = root->ratio > FAR;
        if (bridge) bridge[f] = is_bridge;
        if (!is_bridge || first != f) continue;
        out->bridges++;
        bridges += root->area;
        if (root->area <= largest) continue;
        largest = root->area;
        out->bridge_radius = root->distance;
        memcpy(out->bridge_centre, root->widest, sizeof root->widest);
    }
    out->far_share = all > 0 ? far / all : 0;
    out->bridge_share = all > 0 ? bridges / all : 0;
done:
    brio_release(c->ctx, parent);
    return status;
}

/* --- faces near a few points --- */

enum { FACES_A_THREAD = 1 << 12 };

typedef struct {
    double centre[3], radius;
} ball;

typedef struct {
    const brio_mesh *mesh;
    brio_face_groups balls;
    uint8_t *near; /* #F */
} near_search;

static void ask_face(void *user, size_t begin, size_t end, int thread) {
    const near_search *s = user;
    double low[3], high[3];
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        brio_face_bounds(s->mesh, f, low, high);
        bool has_area = s->mesh->face_offsets[f + 1] - s->mesh->face_offsets[f] > 2;
        s->near[f] = has_area && brio_groups_meet(&s->balls, low, high);
    }
}

/* Makes a mesh of triangles from the lowest to the highest corner of the box of each ball. */
static brio_status draw_boxes(brio_context *ctx, const ball *balls, size_t num_balls, brio_mesh *out) {
    *out = (brio_mesh){.context = ctx, .num_vertices = 2 * num_balls, .num_faces = num_balls};
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->vertices, 6 * num_balls));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_offsets, num_balls + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_vertices, 3 * num_balls));
    for (size_t i = 0; i <= num_balls; i++) out->face_offsets[i] = 3 * i;
    for (size_t i = 0; i < num_balls; i++) {
        for (size_t k = 0; k < 3; k++) {
            out->vertices[6 * i + k] = balls[i].centre[k] - balls[i].radius;
            out->vertices[6 * i + 3 + k] = balls[i].centre[k] + balls[i].radius;
            out->face_vertices[3 * i + k] = (uint32_t)(2 * i + (k == 1));
        }
    }
    return BRIO_OK;
}

static brio_status copy_near(brio_context *ctx, const near_search *s, brio_mesh *out) {
    const brio_mesh *m = s->mesh;
    size_t faces = 0, corners = 0;
    for (size_t f = 0; f < m->num_faces; f++)
        if (s->near[f]) faces++, corners += (size_t)(m->face_offsets[f + 1] - m->face_offsets[f]);
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_offsets, faces + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->face_vertices, corners));
    out->face_offsets[0] = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        if (!s->near[f]) continue;
        size_t from = (size_t)m->face_offsets[f], count = (size_t)m->face_offsets[f + 1] - from;
        uint64_t at = out->face_offsets[out->num_faces++];
        if (count) memcpy(out->face_vertices + at, m->face_vertices + from, count * sizeof *out->face_vertices);
        out->face_offsets[out->num_faces] = at + count;
    }
    return BRIO_OK;
}

/* Lists the faces of three corners or more whose boxes meet the box of a ball. Each ball takes the shape of a triangle
 * with its box, so that the tree is one of faces.
 *  out  its vertices are those of the mesh; the caller frees face_offsets and face_vertices, on failure too. */
static brio_status near_faces(brio_context *ctx, const brio_mesh *mesh, const ball *balls, size_t num_balls,
                              brio_mesh *out) {
    brio_status status = BRIO_OK;
    brio_mesh boxes = {0};
    near_search s = {.mesh = mesh, .balls.ctx = ctx};
    *out = (brio_mesh){
        .size = sizeof *out, .context = ctx, .num_vertices = mesh->num_vertices, .vertices = mesh->vertices};
    BRIO_TRY(draw_boxes(ctx, balls, num_balls, &boxes));
    BRIO_TRY(brio_face_groups_new(ctx, &boxes, &s.balls));
    BRIO_TRY(BRIO_ALLOC(ctx, s.near, mesh->num_faces));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, mesh->num_faces, FACES_A_THREAD), mesh->num_faces, ask_face, &s));
    BRIO_TRY(copy_near(ctx, &s, out));
done:
    brio_face_groups_free(&s.balls);
    brio_release(ctx, boxes.vertices);
    brio_release(ctx, boxes.face_offsets);
    brio_release(ctx, boxes.face_vertices);
    brio_release(ctx, s.near);
    return status;
}

/* --- points that the surface leaves --- */

/* Marks the vertices of faces that have an area. */
static void mark_used(const brio_mesh *m, uint8_t *used) {
    for (size_t f = 0; f < m->num_faces; f++)
        for (uint64_t h = m->face_offsets[f]; h < m->face_offsets[f + 1]; h++)
            if (m->face_offsets[f + 1] - m->face_offsets[f] > 2) used[m->face_vertices[h]] = 1;
}

/* Finds for vertices the nearest point: of a point that is so found several times, any of its vertices is kept. */
static void find_points(void *user, size_t begin, size_t end, int thread) {
    const coverage *c = user;
    brio_near_point near[BRIO_NEAR_ROOM];
    (void)thread;
    for (size_t v = c->first + begin; v < c->first + end; v++) {
        if (!c->used[v]) continue;
        brio_nearest_points(&c->tree, c->mesh->vertices + 3 * v, 1, INFINITY, near);
        __atomic_store_n(&c->vertex[near[0].place], (uint32_t)v, __ATOMIC_RELAXED);
    }
}

/* Lists for each point a vertex that is near it, where there is one. */
static brio_status list_vertices(coverage *c) {
    const brio_mesh *m = c->mesh;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->vertex, c->tree.count));
    memset(c->vertex, 0xff, c->tree.count * sizeof *c->vertex);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->used, m->num_vertices));
    mark_used(m, c->used);
    return run(c, m->num_vertices, 0.7, 0.75, find_points);
}

/* Returns whether the point at a place of the tree is within LEFT_OUT spacings of its vertex. That needs no spacing:
 * where the sixth nearest point is farther than the vertex by more than this shares, the spacing is large enough. */
static bool is_at_vertex(const coverage *c, size_t place) {
    static const double SURE = 0.999;
    brio_near_point near[BRIO_NEAR_ROOM];
    uint32_t vertex = c->vertex[place];
    if (vertex == NO_VERTEX || c->tree.count <= NEIGHBOURS) return false;
    double square = brio_square_distance(c->mesh->vertices + 3 * (size_t)vertex, c->tree.point[place]);
    double share = SURE * LEFT_OUT * GRID_SHARE;
    if (square == 0) return true;
    return brio_nearest_points(&c->tree, c->tree.point[place], NEIGHBOURS + 1, square / (share * share), near) <=
           NEIGHBOURS;
}

static double reach_of(const coverage *c, size_t place) {
    return LEFT_OUT * (c->spacing ? c->spacing[place] : spacing_at(&c->tree, place));
}

/* Returns whether a vertex of one of the nearest points is within LEFT_OUT spacings of the point at a place of the
 * tree. */
static bool is_near_vertex(const coverage *c, size_t place) {
    static const double SURE = 0.999;
    brio_near_point near[BRIO_NEAR_ROOM];
    const double *p = c->tree.point[place];
    double most = SURE * reach_of(c, place);
    size_t found = brio_nearest_points(&c->tree, p, NEIGHBOURS + 1, INFINITY, near);
    for (size_t i = 0; i < found; i++) {
        uint32_t vertex = c->vertex[near[i].place];
        if (vertex == NO_VERTEX) continue;
        if (brio_square_distance(c->mesh->vertices + 3 * (size_t)vertex, p) < most * most) return true;
    }
    return false;
}

static void look_at_vertices(void *user, size_t begin, size_t end, int thread) {
    const coverage *c = user;
    (void)thread;
    for (size_t i = c->first + begin; i < c->first + end; i++)
        c->left_out[c->tree.index[i]] = is_at_vertex(c, i) || is_near_vertex(c, i) ? NOT_LEFT : OPEN;
}

static void look_at_points(void *user, size_t begin, size_t end, int thread) {
    const coverage *c = user;
    (void)thread;
    for (size_t i = c->first + begin, triangle = 0; i < c->first + end; i++) {
        uint8_t *left_out = &c->left_out[c->tree.index[i]];
        if (i % ITEMS_A_CHUNK == 0)
            triangle = 0; /* however the threads share the points, each looks at the same triangles */
        if (*left_out != OPEN) continue;
        double most = reach_of(c, i);
        *left_out = most > 0 &&
                    !(c->faces.num_triangles && brio_is_within(&c->faces, c->tree.point[i], most * most, &triangle));
    }
}

/* Picks the faces near the points that are open. */
static brio_status pick_faces(const coverage *c, size_t num_open, brio_mesh *out) {
    brio_status status = BRIO_OK;
    ball *balls = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(c->ctx, balls, num_open));
    for (size_t i = 0; i < c->tree.count; i++) {
        if (c->left_out[c->tree.index[i]] != OPEN) continue;
        memcpy(balls[count].centre, c->tree.point[i], sizeof balls->centre);
        balls[count++].radius = reach_of(c, i);
    }
    BRIO_TRY(near_faces(c->ctx, c->mesh, balls, count, out));
done:
    brio_release(c->ctx, balls);
    return status;
}

/* Judges the points that are open. */
static brio_status judge_open(coverage *c, size_t num_open) {
    brio_status status = BRIO_OK;
    brio_mesh near = {0};
    bool few = num_open < c->tree.count / FEW;
    if (few) BRIO_TRY(pick_faces(c, num_open, &near));
    if (!few || near.num_faces) BRIO_TRY(brio_triangle_tree_new(c->ctx, few ? &near : c->mesh, &c->faces));
    BRIO_TRY(run(c, c->tree.count, 0.8, 1, look_at_points));
done:
    brio_release(c->ctx, near.face_offsets);
    brio_release(c->ctx, near.face_vertices);
    return status;
}

/* Counts the points that the surface leaves.   left_out  NULL, or receives them. */
static brio_status judge_points(coverage *c, size_t num_points, uint8_t *left_out, size_t *count) {
    size_t open = 0;
    BRIO_FORWARD(list_vertices(c));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->left_out, num_points));
    BRIO_FORWARD(run(c, num_points, 0.75, 0.8, look_at_vertices));
    for (size_t i = 0; i < num_points; i++) open += c->left_out[i] == OPEN;
    if (open) BRIO_FORWARD(judge_open(c, open));
    *count = 0;
    for (size_t i = 0; i < num_points; i++) *count += c->left_out[i];
    if (left_out) memcpy(left_out, c->left_out, num_points);
    return BRIO_OK;
}

/* --- the whole --- */

static brio_status measure_points(coverage *c, size_t num_points) {
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->spacing, num_points));
    return run(c, num_points, 0, 0.3, measure_spacings);
}

static brio_status judge_faces(coverage *c, uint8_t *bridge, brio_coverage *out) {
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->of, c->mesh->num_faces));
    BRIO_FORWARD(run(c, c->mesh->num_faces, 0.3, 0.7, look_at_faces));
    return sum_up(c, bridge, out);
}

/* A surface and points, of any size, in a unit in which squares neither overflow nor vanish. */
typedef struct {
    coverage c;
    brio_mesh scaled;
    double *vertices, *places;
    int exponent;
} comparison;

static brio_status begin(comparison *x, brio_context *ctx, const brio_mesh *mesh, const double *points,
                         size_t num_points) {
    *x = (comparison){.c = {.ctx = ctx, .mesh = mesh, .points = points}, .scaled = *mesh};
    BRIO_FORWARD(brio_mesh_check_faces(ctx, mesh));
    BRIO_FORWARD(brio_refuse_vertices(ctx, mesh->vertices, mesh->num_vertices, "the surface"));
    BRIO_FORWARD(brio_refuse_vertices(ctx, points, num_points, "the points"));
    BRIO_EXPECT(ctx, mesh->num_faces && num_points, BRIO_ERR_ARGUMENT,
                "a surface and points are needed: %zu faces, %zu points", mesh->num_faces, num_points);
    int exponent = brio_exponent(
        fmax(brio_greatest(mesh->vertices, 3 * mesh->num_vertices), brio_greatest(points, 3 * num_points)));
    if (abs(exponent) > HUGE_EXPONENT) {
        x->exponent = exponent;
        BRIO_FORWARD(BRIO_ALLOC(ctx, x->vertices, 3 * mesh->num_vertices));
        BRIO_FORWARD(BRIO_ALLOC(ctx, x->places, 3 * num_points));
        brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, x->vertices);
        brio_scale(ctx, points, 3 * num_points, -exponent, x->places);
        x->scaled.vertices = x->vertices;
        x->c.mesh = &x->scaled;
        x->c.points = x->places;
    }
    return brio_point_tree_new(ctx, x->c.points, num_points, &x->c.tree);
}

static void end(comparison *x) {
    brio_context *ctx = x->c.ctx;
    brio_point_tree_free(ctx, &x->c.tree);
    brio_triangle_tree_free(ctx, &x->c.faces);
    brio_release(ctx, x->c.spacing);
    brio_release(ctx, x->c.of);
    brio_release(ctx, x->c.used);
    brio_release(ctx, x->c.vertex);
    brio_release(ctx, x->c.left_out);
    brio_release(ctx, x->vertices);
    brio_release(ctx, x->places);
}

brio_status brio_mesh_coverage(brio_context *ctx, const brio_mesh *mesh, const double *points, size_t num_points,
                               uint8_t *bridge, brio_coverage *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    comparison x = {.c.ctx = ctx};
    brio_coverage found = {.size = sizeof found};
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_coverage, out));
    BRIO_TRY(begin(&x, ctx, mesh, points, num_points));
    BRIO_TRY(measure_points(&x.c, num_points));
    BRIO_TRY(judge_faces(&x.c, bridge, &found));
    BRIO_TRY(judge_points(&x.c, num_points, NULL, &found.left_out));
    found.bridge_radius = ldexp(found.bridge_radius, x.exponent);
    for (int k = 0; k < 3; k++) found.bridge_centre[k] = ldexp(found.bridge_centre[k], x.exponent);
    BRIO_GIVE(brio_coverage, out, &found);
done:
    end(&x);
    return status;
}

brio_status brio_mesh_left_out(brio_context *ctx, const brio_mesh *mesh, const double *points, size_t num_points,
                               uint8_t *left_out, size_t *count) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    comparison x = {.c.ctx = ctx};
    BRIO_TRY(begin(&x, ctx, mesh, points, num_points));
    BRIO_TRY(judge_points(&x.c, num_points, left_out, count));
done:
    end(&x);
    return status;
}
