/* The exact check of a triangulation of the plane against wrong ones: results are damaged at random, and the check must
 * pass exactly those that are still right. Whether a damaged one is right is decided by comparison with the undamaged one:
 * the same set of triangles, mates that match, the same representatives and counts. */
#include "base/memory.h"
#include "harness.h"
#include "plane/plane_store.h"
#include "plane/triangulation2.h"
#include "points.h"

enum { MOST = 40, ROOM = 5 * MOST };

typedef struct {
    brio_rng rng;
    size_t n;
    bool weighted;
    double p[2 * MOST], w[MOST];
    brio_triangle triangle[ROOM], kept[ROOM];
    uint32_t representative[MOST], kept_representative[MOST], line[MOST], kept_line[MOST];
    brio_triangulation2 t;
    brio_delaunay2_stats kept_stats;
} scene;

static uint32_t draw(scene *s, size_t below) {
    return brio_rng_below(&s->rng, (uint32_t)below);
}

static size_t count_of(const brio_delaunay2_stats *s) {
    return s->triangles + s->hull_edges;
}

/* --- what is right --- */

static int compare_words(const void *a, const void *b) {
    uint64_t x, y;
    memcpy(&x, a, sizeof x), memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

/* A name of the triangle up to rotation. */
static uint64_t name_of(const brio_triangle *t) {
    const uint32_t *v = t->vertex;
    int first = v[0] < v[1] ? (v[0] < v[2] ? 0 : 2) : (v[1] < v[2] ? 1 : 2);
    return (uint64_t)(v[first] & 1023) << 20 | (v[(first + 1) % 3] & 1023) << 10 | (v[(first + 2) % 3] & 1023);
}

static void names_of(const brio_triangle *t, size_t n, uint64_t *out) {
    for (size_t i = 0; i < n; i++) out[i] = name_of(&t[i]);
    qsort(out, n, sizeof *out, compare_words);
}

/* Whether the infinite vertex is last where it is, and where it should be. */
static bool placed(const scene *s) {
    for (size_t t = 0; t < count_of(&s->t.stats); t++)
        for (int i = 0; i < 3; i++)
            if ((s->triangle[t].vertex[i] == BRIO_INFINITE) != (i == 2 && t >= s->t.stats.triangles)) return false;
    return true;
}

static bool mates_match(const scene *s) {
    size_t n = count_of(&s->t.stats);
    for (uint32_t t = 0; t < n; t++)
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t g = s->triangle[t].mate[i], u = g / 4, k = g % 4;
            if (u >= n || k > 2 || s->triangle[u].mate[k] != 4 * t + i) return false;
            if (s->triangle[t].vertex[(i + 1) % 3] != s->triangle[u].vertex[(k + 2) % 3]) return false;
            if (s->triangle[t].vertex[(i + 2) % 3] != s->triangle[u].vertex[(k + 1) % 3]) return false;
        }
    return true;
}

static bool is_right(const scene *s) {
    uint64_t now[ROOM], then[ROOM];
    const brio_delaunay2_stats *a = &s->t.stats, *b = &s->kept_stats;
    if (a->vertices != b->vertices || a->hidden != b->hidden || a->duplicates != b->duplicates) return false;
    if (a->dimension != b->dimension || a->triangles != b->triangles || a->hull_edges != b->hull_edges) return false;
    if (memcmp(s->representative, s->kept_representative, s->n * sizeof *s->representative)) return false;
    if (a->dimension == 1) return memcmp(s->line, s->kept_line, a->vertices * sizeof *s->line) == 0;
    names_of(s->triangle, count_of(a), now);
    names_of(s->kept, count_of(b), then);
    return memcmp(now, then, count_of(a) * sizeof *now) == 0 && placed(s) && mates_match(s);
}

/* --- damage --- */

static void change_vertex(scene *s) {
    s->triangle[draw(s, count_of(&s->t.stats))].vertex[draw(s, 3)] = draw(s, s->n + 2);
}
static void swap_vertices(scene *s) {
    uint32_t *v = s->triangle[draw(s, count_of(&s->t.stats))].vertex, i = draw(s, 3), k = draw(s, 3), swap = v[i];
    v[i] = v[k], v[k] = swap;
}
static void change_mate(scene *s) {
    size_t n = count_of(&s->t.stats);
    s->triangle[draw(s, n)].mate[draw(s, 3)] = draw(s, 4 * n + 9);
}
static void change_representative(scene *s) {
    s->representative[draw(s, s->n)] = draw(s, s->n + 1);
}
static void change_count(scene *s) {
    size_t *counts[] = {&s->t.stats.vertices, &s->t.stats.duplicates, &s->t.stats.hidden};
    *counts[draw(s, 3)] += draw(s, 3) - 1u;
}
static void change_dimension(scene *s) {
    s->t.stats.dimension = (int)draw(s, 4) - 1;
}

static void point_back(scene *s, uint32_t t) {
    for (uint32_t i = 0; i < 3; i++)
        s->triangle[s->triangle[t].mate[i] / 4].mate[s->triangle[t].mate[i] % 4] = 4 * t + i;
}

/* Rotates a triangle, with its mates. */
static void rotate(scene *s) {
    uint32_t t = draw(s, count_of(&s->t.stats));
    brio_triangle old = s->triangle[t];
    for (int i = 0; i < 3; i++) {
        s->triangle[t].vertex[(i + 1) % 3] = old.vertex[i];
        s->triangle[t].mate[(i + 1) % 3] = old.mate[i];
    }
    point_back(s, t);
}

/* Exchanges two triangles, with their mates. */
static void exchange(scene *s) {
    size_t n = count_of(&s->t.stats);
    uint32_t a = draw(s, n), b = draw(s, n);
    for (int step = 0; step < 3; step++) {
        uint32_t from = step == 0 ? a : step == 1 ? b : (uint32_t)n, to = step == 0 ? (uint32_t)n : step == 1 ? a : b;
        s->triangle[to] = s->triangle[from];
        point_back(s, to);
    }
}

/* Flips the edge of two triangles: right mates, another triangulation, or one that overlaps. */
static void flip(scene *s) {
    uint32_t t = draw(s, count_of(&s->t.stats)), i = draw(s, 3), g = s->triangle[t].mate[i], u = g / 4, k = g % 4;
    brio_triangle a = s->triangle[t], b = s->triangle[u];
    if (t == u) return;
    uint32_t p = a.vertex[i], q = a.vertex[(i + 1) % 3], r = a.vertex[(i + 2) % 3], x = b.vertex[k];
    s->triangle[t] = (brio_triangle){{p, q, x}, {b.mate[(k + 1) % 3], 4 * u + 2, a.mate[(i + 2) % 3]}};
    s->triangle[u] = (brio_triangle){{p, x, r}, {b.mate[(k + 2) % 3], a.mate[(i + 1) % 3], 4 * t + 1}};
    s->triangle[t].mate[1] = 4 * u + 2;
    s->triangle[u].mate[2] = 4 * t + 1;
    point_back(s, t);
    point_back(s, u);
}

/* Renames a vertex to another point everywhere, with its representative. */
static void rename_vertex(scene *s) {
    uint32_t from = draw(s, s->n), to = draw(s, s->n);
    for (size_t t = 0; t < count_of(&s->t.stats); t++)
        for (int i = 0; i < 3; i++)
            if (s->triangle[t].vertex[i] == from) s->triangle[t].vertex[i] = to;
    for (size_t i = 0; i < s->n; i++)
        if (s->representative[i] == from) s->representative[i] = to;
}

/* Takes a finite triangle at the hull away: the hull is no longer convex, and all circles are still empty. */
static void dent_hull(scene *s) {
    size_t finite = s->t.stats.triangles;
    if (finite < 2) return;
    uint32_t u = (uint32_t)finite + draw(s, s->t.stats.hull_edges), g = s->triangle[u].mate[2], i = g % 4;
    uint32_t last = (uint32_t)finite - 1;
    if (g / 4 != last) return;
    brio_triangle t = s->triangle[last], hull = s->triangle[u];
    uint32_t a = hull.vertex[1], b = hull.vertex[0], c = t.vertex[i];
    s->triangle[last] = (brio_triangle){{b, c, BRIO_INFINITE}, {4 * u + 1, hull.mate[1], t.mate[(i + 1) % 3]}};
    s->triangle[u] = (brio_triangle){{c, a, BRIO_INFINITE}, {hull.mate[0], 4 * last, t.mate[(i + 2) % 3]}};
    point_back(s, last);
    point_back(s, u);
    s->t.stats.triangles--, s->t.stats.hull_edges++;
}

/* Adds a component of two infinite triangles over one edge. */
static void add_flat_component(scene *s) {
    uint32_t n = (uint32_t)count_of(&s->t.stats), a = s->triangle[0].vertex[0], b = s->triangle[0].vertex[1];
    s->triangle[n] = (brio_triangle){{a, b, BRIO_INFINITE}, {4 * n + 5, 4 * n + 4, 4 * n + 6}};
    s->triangle[n + 1] = (brio_triangle){{b, a, BRIO_INFINITE}, {4 * n + 1, 4 * n, 4 * n + 2}};
    s->t.stats.hull_edges += 2;
}

/* Adds a second copy of all triangles. */
static void add_copy(scene *s) {
    size_t finite = s->t.stats.triangles, n = count_of(&s->t.stats);
    brio_triangle old[ROOM];
    memcpy(old, s->triangle, sizeof old);
    for (size_t copy = 0; copy < 2; copy++)
        for (size_t t = 0; t < n; t++) {
            brio_triangle *to = &s->triangle[t < finite ? t + copy * finite : finite + t + copy * (n - finite)];
            *to = old[t];
            for (int i = 0; i < 3; i++) {
                uint32_t u = old[t].mate[i] / 4,
                         shift = (uint32_t)(u < finite ? copy * finite : finite + copy * (n - finite));
                to->mate[i] = old[t].mate[i] + 4 * shift;
            }
        }
    s->t.stats.triangles *= 2, s->t.stats.hull_edges *= 2;
}

static void change_line(scene *s) {
    if (s->t.stats.dimension == 1) s->line[draw(s, s->t.stats.vertices)] = draw(s, s->n);
}

/* Takes a vertex of the line away, and counts it as hidden. */
static void drop_from_line(scene *s) {
    if (s->t.stats.dimension != 1 || s->t.stats.vertices < 3) return;
    uint32_t at = draw(s, s->t.stats.vertices);
    s->representative[s->line[at]] = s->line[at ? at - 1 : 1];
    for (size_t i = at; i + 1 < s->t.stats.vertices; i++) s->line[i] = s->line[i + 1];
    s->t.stats.vertices--, s->t.stats.hidden++;
}

static void (*const DAMAGES[])(scene *) = {change_vertex,
                                           swap_vertices,
                                           change_mate,
                                           rotate,
                                           exchange,
                                           flip,
                                           flip,
                                           dent_hull,
                                           dent_hull,
                                           dent_hull,
                                           add_flat_component,
                                           add_copy,
                                           rename_vertex,
                                           change_representative,
                                           change_count,
                                           change_dimension,
                                           change_line,
                                           drop_from_line};
enum { OF_TRIANGLES = 13 };

/* --- trials --- */

static void make_scene(scene *s, uint64_t trial) {
    s->rng = brio_rng_new(trial);
    s->n = 3 + draw(s, MOST - 4), s->weighted = trial % 2;
    uint32_t side = 2 + draw(s, 6), tall = trial % 6 == 0 ? 1 : side;
    for (size_t i = 0; i < s->n; i++) {
        s->p[2 * i] = draw(s, side), s->p[2 * i + 1] = draw(s, tall);
        s->w[i] = draw(s, 4);
    }
}

/* Copies the result into the scene, where it can be damaged. */
static void load(scene *s, const brio_triangulation2 *t) {
    s->t = *t;
    s->kept_stats = t->stats;
    size_t n = count_of(&t->stats);
    if (n) memcpy(s->triangle, t->triangle, n * sizeof *s->triangle);
    memcpy(s->kept, s->triangle, sizeof s->kept);
    memcpy(s->representative, t->representative, s->n * sizeof *s->representative);
    memcpy(s->kept_representative, s->representative, sizeof s->kept_representative);
    if (t->line) memcpy(s->line, t->line, t->stats.vertices * sizeof *s->line);
    memcpy(s->kept_line, s->line, sizeof s->kept_line);
    s->t.triangle = s->triangle, s->t.representative = s->representative;
    s->t.line = t->line ? s->line : NULL;
}

static void the_check_passes_what_is_right(void) {
    int passed = 0, failed = 0;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        static scene s;
        brio_context *ctx = new_context();
        brio_triangulation2 *t;
        memset(&s, 0, sizeof s);
        make_scene(&s, trial);
        const double *w = s.weighted ? s.w : NULL;
        EXPECT(brio_delaunay2(ctx, s.p, w, s.n, NULL, &t) == BRIO_OK);
        load(&s, t);
        uint32_t which = draw(&s, sizeof DAMAGES / sizeof *DAMAGES);
        if (which >= OF_TRIANGLES || s.t.stats.dimension == 2) DAMAGES[which](&s);
        bool right = is_right(&s);
        brio_status status = brio_triangulation2_check(ctx, &s.t, s.p, w, s.n);
        EXPECT(status == (right ? BRIO_OK : BRIO_ERR_CHECK), "trial %llu, damage %u, right %d: %s",
               (unsigned long long)trial, which, right, status ? brio_message(ctx) : "");
        passed += right, failed += !right;
        brio_triangulation2_free(t);
        brio_context_free(ctx);
    }
    EXPECT(passed > 2000 && failed > 8000, "%d %d", passed, failed);
}

SUITE(test_plane_check) {
    RUN(the_check_passes_what_is_right);
    return harness_end();
}
