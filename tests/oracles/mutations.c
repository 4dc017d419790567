/* The checks against wrong results: triangulations and surfaces are spoiled at random, exact arithmetic that shares no code
 * with the library judges what came of them, and the library's checks must refuse the wrong ones and pass the others.
 *   mutations [--inputs N] [--seed S] [--first I]      until N wrong ones were judged
 * Prints what was judged. --inputs 1 --first I repeats a set of points. */
#include "compare_exact.h"
#include "judge_tets.h"
#include "mutate_result.h"
#include "surface_oracle.h"
#include <time.h>

enum { KINDS = 4, SETS_OF_TETS = 24, RESULTS = 16, SURFACES = 8, MOST_FACES = 40 };

static const char *const KIND_NAMES[KINDS] = {"brio_tetrahedra_check", "brio_triangulation_check",
                                              "brio_triangulation2_check", "brio_mesh_certificate"};

typedef struct {
    uint64_t wrong[KINDS], right[KINDS], mistakes;
    const oracle_run *run;
    uint64_t index;
} tally;

/* A judgement of the library's against the judge's. */
static void judge(tally *sum, int kind, bool accepted, bool right, const char *why) {
    if (right)
        sum->right[kind]++;
    else
        sum->wrong[kind]++;
    if (accepted == right) return;
    sum->mistakes++;
    printf("MISTAKE: %s %s what is %s (%s): mutations --inputs 1 --seed %llu --first %llu\n", KIND_NAMES[kind],
           accepted ? "passes" : "refuses", right ? "right" : "wrong", why ? why : "", //
           (unsigned long long)sum->run->seed, (unsigned long long)sum->index);
}

/* --- sets of tetrahedra --- */

/* The triangulation of the points with some axes reflected: its ties are broken in another way. */
static void triangulate_reflected(brio_context *ctx, const patient *p) {
    point_set s = *p->s;
    brio_triangulation *t;
    uint32_t axes = below(p->d, 8);
    for (size_t i = 0; i < 3 * s.n; i++)
        if (axes >> i % 3 & 1) s.x[i] = -s.x[i];
    p->t->count = 0;
    if (brio_delaunay(ctx, s.x, s.weighted ? s.w : NULL, s.n, NULL, &t)) return;
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    for (size_t i = 0; i < brio_triangulation_stats(t)->tetrahedra; i++)
        append_tet(p, tet[i].vertex[0], tet[i].vertex[1], tet[i].vertex[2], tet[i].vertex[3]);
    brio_triangulation_free(t);
}

static void judge_tets(brio_context *ctx, const patient *p, tally *sum) {
    bool best, right = tets_are_right(p, &best);
    int canonical = -1;
    brio_status status = brio_tetrahedra_check(ctx, p->s->x, p->s->weighted ? p->s->w : NULL, p->s->n, *p->t->v, 4,
                                               p->t->count, &canonical);
    bool known = canonical == (right ? best : -1) && (status == BRIO_OK || status == BRIO_ERR_CHECK);
    judge(sum, 0, known ? status == BRIO_OK : !right, right, known ? brio_message(ctx) : "canonical or not");
}

static void spoil_tets(brio_context *ctx, dice *d, const point_set *s, const exact_answer *a, tally *sum) {
    static tet_list first, t;
    patient p = {s, a, d, &first};
    if (a->dimension < 3) return;
    for (int i = 0; i < SETS_OF_TETS; i++) {
        if (i % 6 == 0) p.t = &first, triangulate_reflected(ctx, &p);
        t = first;
        p.t = &t;
        for (uint32_t n = i % 6 ? 1 + below(d, one_in(d, 3) ? 5 : 2) : 0; n > 0; n--) mutate_tets(&p);
        judge_tets(ctx, &p, sum);
    }
}

/* --- results --- */

static void spoil_solid(brio_context *ctx, dice *d, const point_set *s, const exact_answer *a, tally *sum) {
    static uint32_t cells[MOST_NUMBERS], representatives[MOST_POINTS];
    const double *w = s->weighted ? s->w : NULL;
    brio_triangulation *t;
    if (brio_delaunay(ctx, s->x, w, s->n, NULL, &t)) return;
    brio_delaunay_stats *f = (brio_delaunay_stats *)brio_triangulation_stats(t), stats = *f;
    result_view r = {.d = d, .s = s, .a = a, .dimension = 3, .cells = f->tetrahedra + f->hull_facets};
    r.cell = (uint32_t *)brio_triangulation_tetrahedra(t);
    r.representative = (uint32_t *)brio_triangulation_representatives(t);
    r.count[0] = &f->points, r.count[1] = &f->vertices, r.count[2] = &f->duplicates, r.count[3] = &f->hidden;
    r.count[4] = &f->tetrahedra, r.count[5] = &f->hull_facets, r.stated_dimension = &f->dimension;
    if (r.cells) memcpy(cells, r.cell, r.cells * 8 * sizeof *cells);
    memcpy(representatives, r.representative, s->n * sizeof *representatives);
    for (int i = 0; i < RESULTS; i++) {
        for (uint32_t n = i ? 1 + one_in(d, 4) : 0; n > 0; n--) mutate_result(&r);
        const char *wrong = compare_solid(s, a, t, false);
        judge(sum, 1, brio_triangulation_check(ctx, t, s->x, w, s->n) == BRIO_OK, !wrong, wrong);
        *f = stats;
        if (r.cells) memcpy(r.cell, cells, r.cells * 8 * sizeof *cells);
        memcpy(r.representative, representatives, s->n * sizeof *representatives);
    }
    brio_triangulation_free(t);
}

/* Where the parts of a plane's result are. */
static result_view view_of_plane(dice *d, const point_set *s, const exact_answer *a, const brio_triangulation2 *t) {
    brio_delaunay2_stats *f = (brio_delaunay2_stats *)brio_triangulation2_stats(t);
    result_view r = {.d = d, .s = s, .a = a, .dimension = 2, .cells = f->triangles + f->hull_edges};
    r.cell = (uint32_t *)brio_triangulation2_triangles(t);
    r.representative = (uint32_t *)brio_triangulation2_representatives(t);
    r.count[0] = &f->points, r.count[1] = &f->vertices, r.count[2] = &f->duplicates, r.count[3] = &f->hidden;
    r.count[4] = &f->triangles, r.count[5] = &f->hull_edges, r.stated_dimension = &f->dimension;
    r.line = (uint32_t *)brio_triangulation2_line(t, &r.line_length);
    return r;
}

static void spoil_plane(brio_context *ctx, dice *d, const point_set *s, const exact_answer *a, tally *sum) {
    static uint32_t cells[MOST_NUMBERS], representatives[MOST_POINTS], line[MOST_POINTS];
    const double *w = s->weighted ? s->w : NULL;
    brio_triangulation2 *t;
    brio_status status = s->coordinates == 2 ? brio_delaunay2(ctx, s->x, w, s->n, NULL, &t)
                                             : brio_delaunay2_flat(ctx, s->x, w, s->n, NULL, &t);
    if (status) return;
    brio_delaunay2_stats *f = (brio_delaunay2_stats *)brio_triangulation2_stats(t), stats = *f;
    result_view r = view_of_plane(d, s, a, t);
    if (r.cells) memcpy(cells, r.cell, r.cells * 6 * sizeof *cells);
    if (r.line) memcpy(line, r.line, r.line_length * sizeof *line);
    memcpy(representatives, r.representative, s->n * sizeof *representatives);
    for (int i = 0; i < RESULTS; i++) {
        for (uint32_t n = i ? 1 + one_in(d, 4) : 0; n > 0; n--) mutate_result(&r);
        const char *wrong = compare_plane(s, a, t);
        judge(sum, 2, brio_triangulation2_check(ctx, t, s->x, w, s->n) == BRIO_OK, !wrong, wrong);
        *f = stats;
        if (r.cells) memcpy(r.cell, cells, r.cells * 6 * sizeof *cells);
        if (r.line) memcpy(r.line, line, r.line_length * sizeof *line);
        memcpy(r.representative, representatives, s->n * sizeof *representatives);
    }
    brio_triangulation2_free(t);
}

/* --- surfaces --- */

typedef struct {
    size_t faces, vertices;
    uint32_t v[MOST_FACES][3];
} face_list;

/* One change of a face; those that give a face a vertex twice are left out. */
static void mutate_faces(dice *d, face_list *l) {
    uint32_t *v = l->v[below(d, (uint32_t)l->faces)], other[3], way = below(d, 6);
    memcpy(other, v, sizeof other);
    if (way == 0) other[0] = v[1], other[1] = v[0];
    if (way == 1 || way == 2) other[below(d, 3)] = below(d, (uint32_t)l->vertices);
    if (way == 3) memcpy(other, l->v[below(d, (uint32_t)l->faces)], sizeof other);
    if (way == 4) memcpy(other, l->v[--l->faces], sizeof other);
    if (way == 5 && l->faces < MOST_FACES)
        for (int k = 0; k < 3; k++) other[k] = l->v[l->faces][k] = below(d, (uint32_t)l->vertices);
    if (other[0] == other[1] || other[1] == other[2] || other[0] == other[2]) return;
    if (way == 5 && l->faces < MOST_FACES) l->faces++;
    memcpy(v, other, sizeof other);
}

/* The certificate says everything as surface_oracle.h does. Right is a closed, oriented surface of one component, genus 0. */
static void judge_faces(brio_context *ctx, const face_list *l, tally *sum) {
    uint64_t offsets[MOST_FACES + 1];
    brio_certificate c = {0};
    brio_mesh *m;
    for (size_t f = 0; f <= l->faces; f++) offsets[f] = 3 * f;
    if (brio_mesh_new(ctx, &m)) return;
    bool made = !brio_mesh_set_vertices(m, NULL, l->vertices) && !brio_mesh_set_faces(m, offsets, *l->v, l->faces);
    if (made && brio_mesh_certificate(ctx, m, &c) == BRIO_OK) {
        surface_facts f = judge_surface(m);
        bool right = f.closed && f.manifold && f.oriented && f.components == 1 && f.euler == 2;
        bool passed = c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 0;
        bool same = c.closed == f.closed && c.manifold == f.manifold && c.components == f.components &&
                    (!f.manifold || c.oriented == f.oriented);
        judge(sum, 3, same ? passed : !right, right, "facts");
    }
    brio_certificate_free(&c);
    brio_mesh_free(m);
}

static void spoil_surfaces(brio_context *ctx, dice *d, const point_set *s, tally *sum) {
    static face_list first, l;
    brio_mesh *hull;
    if (brio_convex_hull(ctx, s->x, s->n, NULL, &hull, NULL)) return;
    first.faces = hull->num_faces, first.vertices = hull->num_vertices;
    if (first.faces) memcpy(first.v, hull->face_vertices, 3 * first.faces * sizeof **first.v);
    brio_mesh_free(hull);
    for (int i = 0; first.faces > 3 && i < SURFACES; i++) {
        l = first;
        for (uint32_t n = i ? 1 + below(d, 3) : 0; n > 0 && l.faces > 1; n--) mutate_faces(d, &l);
        judge_faces(ctx, &l, sum);
    }
}

/* --- runs --- */

static void try_points(brio_context *ctx, tally *sum) {
    static point_set s;
    static exact_answer a;
    dice d = dice_of(sum->run->seed ^ 0x6d757461, sum->index);
    s.coordinates = below(&d, 4) ? 3 : 2, s.weighted = one_in(&d, 2);
    hostile_points(&d, &s);
    if (s.n == 0) return;
    exact_solve(&s, &a);
    if (s.coordinates == 3) {
        spoil_tets(ctx, &d, &s, &a, sum);
        spoil_solid(ctx, &d, &s, &a, sum);
        spoil_surfaces(ctx, &d, &s, sum);
    }
    if (a.dimension < 3) spoil_plane(ctx, &d, &s, &a, sum);
}

static uint64_t report(const tally *sum) {
    uint64_t wrong = 0, right = 0;
    printf("%-26s %14s %15s\n", "", "wrong, refused", "right, accepted");
    for (int k = 0; k < KINDS; k++) {
        printf("%-26s %14llu %15llu\n", KIND_NAMES[k], (unsigned long long)sum->wrong[k],
               (unsigned long long)sum->right[k]);
        wrong += sum->wrong[k], right += sum->right[k];
    }
    printf("%llu wrong and %llu right ones, seed %llu, points from %llu on, %.0f s of processor time: %llu mistakes\n",
           (unsigned long long)wrong, (unsigned long long)right, (unsigned long long)sum->run->seed,
           (unsigned long long)sum->run->first, (double)clock() / CLOCKS_PER_SEC, (unsigned long long)sum->mistakes);
    return sum->mistakes;
}

int main(int argc, char **argv) {
    oracle_run run = oracle_arguments(argc, argv, 20000);
    tally sum = {.run = &run, .index = run.first};
    uint64_t judged = 0;
    brio_context *ctx = oracle_context();
    exact_begin();
    for (; judged < run.inputs && sum.mistakes < 20; sum.index++) {
        try_points(ctx, &sum);
        judged = 0;
        for (int k = 0; k < KINDS; k++) judged += sum.wrong[k];
    }
    if (brio_context_memory(ctx)) sum.mistakes++, printf("MISTAKE: %zu bytes left\n", brio_context_memory(ctx));
    brio_context_free(ctx);
    return report(&sum) ? 1 : 0;
}
