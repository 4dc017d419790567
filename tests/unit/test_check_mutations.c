/* The exact check against brute force: triangulations are mutated in many ways, and the check must accept exactly those
 * that brute force accepts. The number of mutated sets may be given, and a seed: test_check_mutations 1000000 7. */
#include "brute_check.h"
#include "brute_result.h"
#include "harness.h"
#include "mutate_tetrahedra.h"
#include "points.h"
#include "triangulation/triangulation.h"

static size_t num_sets = 12000;
static uint64_t first_seed = 1;

enum { SETS_A_SCENE = 200, RESULTS_A_SCENE = 200 };

typedef struct {
    size_t made, right, accepted, refused, canonical;
} tally;

/* --- points --- */

static void add_site(site_set *s, int64_t x, int64_t y, int64_t z) {
    if (s->n < BRUTE_POINTS) s->p[s->n++] = (site){{x, y, z}, 0};
}

static void add_grid(site_set *s, int64_t nx, int64_t ny, int64_t nz, int64_t step) {
    for (int64_t i = 0; i < nx * ny * nz; i++)
        add_site(s, step * (i % nx), step * (i / nx % ny), step * (i / (nx * ny)));
}

static void add_octahedron(site_set *s, int64_t r) {
    for (int i = 0; i < 6; i++) {
        int64_t x[3] = {0};
        x[i / 2] = i % 2 ? r : -r;
        add_site(s, x[0], x[1], x[2]);
    }
}

/* Twelve points on a sphere, combinatorially an icosahedron. */
static void add_icosahedron(site_set *s) {
    for (int i = 0; i < 12; i++) {
        int64_t x[3] = {0};
        x[(i + 1) % 3] = i & 4 ? 1 : -1;
        x[(i + 2) % 3] = (i / 3) & 1 ? 2 : -2;
        add_site(s, x[0], x[1], x[2]);
    }
}

/* A prism of `layers` layers over a polygon inscribed in a circle of twelve integer points. */
static void add_prism(scene *e, size_t corners, int64_t layers) {
    static const int64_t circle[12][2] = {{5, 0},  {4, 3},   {3, 4},   {0, 5},  {-3, 4}, {-4, 3},
                                          {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}};
    size_t from = draw(e, 12), step = 12 / corners;
    for (size_t i = 0; i < corners; i++)
        for (int64_t z = 0; z < layers; z++)
            add_site(&e->s, circle[(from + step * i) % 12][0], circle[(from + step * i) % 12][1], 3 * z);
}

/* The poles and the equator of a sphere. */
static void add_globe(scene *e) {
    add_site(&e->s, 0, 0, 5);
    add_site(&e->s, 0, 0, -5);
    add_prism(e, 12, 1);
    e->ring = 12;
}

static void add_random(scene *e, size_t n, uint32_t side) {
    for (size_t i = 0; i < n; i++)
        add_site(&e->s, (int64_t)draw(e, side), (int64_t)draw(e, side), (int64_t)draw(e, side));
}

static void add_body_centred(site_set *s) {
    add_grid(s, 3, 2, 2, 2);
    for (int i = 0; i < 2; i++) add_site(s, 1 + 2 * i, 1, 1);
}

static void add_lattice(scene *e) {
    switch (draw(e, 13)) {
    case 0:
        add_grid(&e->s, 2, 2, 2, 1);
        break;
    case 1:
        add_grid(&e->s, 3, 2, 2, 1);
        break;
    case 2:
        draw(e, 4) ? add_grid(&e->s, 3, 3, 2, 1) : add_grid(&e->s, 3, 3, 3, 1);
        break;
    case 3:
        add_octahedron(&e->s, 1), add_site(&e->s, 0, 0, 2);
        break;
    case 4:
        add_octahedron(&e->s, 2), add_grid(&e->s, 2, 2, 2, 1);
        break;
    case 5:
        add_body_centred(&e->s);
        break;
    case 6:
        add_icosahedron(&e->s);
        break;
    case 7:
        add_prism(e, 3 + draw(e, 2), 2);
        break;
    case 8:
        add_prism(e, 6, 2 + (int64_t)draw(e, 2));
        break;
    case 9:
        add_octahedron(&e->s, 1), add_octahedron(&e->s, 2);
        break;
    case 10:
        add_globe(e);
        break;
    default:
        add_random(e, 5 + draw(e, 8), 3 + (uint32_t)draw(e, 4));
    }
}

static void add_duplicates(scene *e) {
    for (size_t i = draw(e, 4); i > 0 && e->s.n < BRUTE_POINTS; i--) {
        site copy = e->s.p[draw_point(e)];
        e->s.p[e->s.n++] = copy;
    }
}

/* Weights from a few values, so that they tie; hidden points come about. */
static void set_weights(scene *e) {
    e->s.weighted = draw(e, 2);
    if (!e->s.weighted) return;
    uint32_t most = 1 + (uint32_t)draw(e, 6);
    for (size_t i = 0; i < e->s.n; i++) e->s.p[i].w = draw(e, 3) ? 0 : (int64_t)draw(e, most);
}

/* All on one plane, one line, or one position, where dimension says so. */
static void flatten(scene *e, int dimension) {
    int64_t a = (int64_t)draw(e, 3) - 1, b = (int64_t)draw(e, 3) - 1;
    size_t axis = draw(e, 3);
    for (size_t i = 0; i < e->s.n; i++) {
        int64_t *x = e->s.p[i].x;
        int64_t u = x[0], v = x[1];
        if (dimension < 2) v = 0;
        if (dimension < 1) u = 2;
        x[axis] = u, x[(axis + 1) % 3] = dimension < 2 ? a * u : v, x[(axis + 2) % 3] = a * u + b * v + 1;
    }
}

/* --- triangulations --- */

/* Coordinates and weights as the library takes them; axes permuted and reflected, which breaks ties in another way. */
static void as_doubles(const site_set *s, size_t turn, double *points, double *weights) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (size_t i = 0; i < s->n; i++) {
        for (size_t k = 0; k < 3; k++) {
            double x = (double)s->p[i].x[order[turn / 8 % 6][k]];
            points[3 * i + k] = turn >> k & 1 ? -x : x;
        }
        weights[i] = (double)s->p[i].w;
    }
}

static void triangulate(brio_context *ctx, const site_set *s, size_t turn, tet_set *out) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    brio_triangulation *t = NULL;
    as_doubles(s, turn, points, weights);
    EXPECT(brio_delaunay(ctx, points, s->weighted ? weights : NULL, s->n, NULL, &t) == BRIO_OK);
    out->count = t->stats.tetrahedra;
    EXPECT(out->count <= BRUTE_TETS);
    for (size_t i = 0; i < out->count; i++) memcpy(out->v[i], t->tet[i].vertex, sizeof *out->v);
    brio_triangulation_free(t);
}

/* The triangulation without one point, or with another weight of one point. */
static void triangulate_nearly(brio_context *ctx, scene *e, tet_set *out) {
    site_set s = e->s;
    uint32_t p = draw_point(e), q = draw_point(e);
    if (s.weighted && draw(e, 2)) {
        s.p[p].w += draw(e, 2) ? 3 : -3;
    } else { /* of coincident points the one with the lower index becomes the vertex */
        if (p < q) p ^= q, q ^= p, p ^= q;
        s.p[p] = s.p[q];
    }
    triangulate(ctx, &s, draw(e, 48), out);
}

/* Tetrahedra with an empty sphere: from a random point set of no ties, hardly more than the triangulation's. */
static void find_candidates(scene *e) {
    uint32_t v[4];
    e->num_candidates = 0;
    for (v[0] = 0; v[0] < e->s.n; v[0]++)
        for (v[1] = v[0] + 1; v[1] < e->s.n; v[1]++)
            for (v[2] = v[1] + 1; v[2] < e->s.n; v[2]++)
                for (v[3] = v[2] + 1; v[3] < e->s.n; v[3]++)
                    if (e->num_candidates < CANDIDATES && volume_at(&e->s, v) && sphere_is_empty(&e->s, v))
                        memcpy(e->candidate[e->num_candidates++], v, sizeof v);
}

static void make_scene(brio_context *ctx, scene *e, uint64_t seed, int dimension) {
    memset(e, 0, sizeof *e);
    e->rng = brio_rng_new(seed);
    do {
        e->s.n = 0, e->ring = 0;
        add_lattice(e);
        add_duplicates(e);
        if (dimension < 3) flatten(e, dimension);
        set_weights(e);
        e->s.hull_volume = hull_volume(&e->s);
    } while (dimension == 3 && !e->s.hull_volume);
    if (dimension < 3) return;
    for (size_t i = 0; i < ALTERNATIVES; i++) triangulate(ctx, &e->s, i ? draw(e, 48) : 0, &e->right[i]);
    for (size_t i = 0; i < NEAR_MISSES; i++) triangulate_nearly(ctx, e, &e->near_miss[i]);
    find_candidates(e);
}

/* --- tetrahedra from anywhere --- */

static void judge_set(brio_context *ctx, const scene *e, const tet_set *t, uint64_t seed, tally *sum) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    int canonical = -1;
    as_doubles(&e->s, 0, points, weights);
    brio_status status =
        brio_tetrahedra_check(ctx, points, e->s.weighted ? weights : NULL, e->s.n, *t->v, 4, t->count, &canonical);
    bool right = brute_accepts(&e->s, t), best = right && brute_canonical(&e->s, t);
    EXPECT(status == (right ? BRIO_OK : BRIO_ERR_CHECK), "seed %llu: %s set: %s", (unsigned long long)seed,
           right ? "right" : "wrong", brio_message(ctx));
    EXPECT(canonical == (right ? best : -1), "seed %llu: canonical %d", (unsigned long long)seed, canonical);
    sum->made++, sum->right += right, sum->canonical += best;
    sum->accepted += status == BRIO_OK, sum->refused += status == BRIO_ERR_CHECK;
}

static void report(const char *what, const tally *sum) {
    fprintf(stderr, "       %zu %s: %zu right (%zu canonical); %zu accepted, %zu refused\n", sum->made, what,
            sum->right, sum->canonical, sum->accepted, sum->refused);
}

static void the_check_accepts_what_brute_force_accepts(void) {
    static scene e;
    static tet_set t;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    tally sum = {0};
    for (uint64_t seed = first_seed; sum.made < num_sets; seed++) {
        make_scene(ctx, &e, seed, 3);
        for (size_t i = 0; i < SETS_A_SCENE && sum.made < num_sets; i++) {
            t = e.right[draw(&e, ALTERNATIVES)];
            if (draw(&e, 4) == 0) wind(&e, &t);
            for (size_t m = draw(&e, 5); m > 0 && t.count; m--) mutate(&e, &t);
            judge_set(ctx, &e, &t, seed, &sum);
        }
    }
    EXPECT(sum.right > sum.made / 20 && sum.right < sum.made);
    EXPECT(sum.canonical > 0 && sum.canonical < sum.right);
    report("mutated sets", &sum);
    brio_context_free(ctx);
}

/* --- results of brio_delaunay --- */

static uint32_t *any_handle(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    return &t->tet[draw(e, tets)].mate[draw(e, 4)];
}

static void wrong_mate(scene *e, brio_triangulation *t) {
    size_t handles = 4 * (t->stats.tetrahedra + t->stats.hull_facets);
    *any_handle(e, t) = draw(e, 8) ? (uint32_t)draw(e, handles) : draw(e, 2) ? UINT32_MAX : (uint32_t)handles;
}

/* Two pairs of mates change partners; the mates stay mutual. */
static void exchange_mates(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    uint32_t *f = any_handle(e, t), *g = any_handle(e, t), a = *f, b = *g;
    if (a / 4 >= tets || b / 4 >= tets) return;
    uint32_t handle_f = t->tet[a / 4].mate[a % 4], handle_g = t->tet[b / 4].mate[b % 4];
    *f = b, t->tet[b / 4].mate[b % 4] = handle_f;
    *g = a, t->tet[a / 4].mate[a % 4] = handle_g;
}

static void wrong_vertex(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    t->tet[draw(e, tets)].vertex[draw(e, 4)] = draw(e, 8) ? draw_point(e) : UINT32_MAX;
}

/* Slots of one tetrahedron change places, with their mates: right again when it is an even permutation that leaves the
 * infinite vertex where it is. */
static void turn_tet(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets, at = draw(e, tets);
    for (size_t n = 1 + draw(e, 2); n > 0; n--) {
        brio_tetrahedron *a = &t->tet[at];
        size_t i = draw(e, 4), j = (i + 1 + draw(e, 3)) % 4;
        uint32_t vertex = a->vertex[i], mate = a->mate[i];
        if (mate / 4 >= tets || a->mate[j] / 4 >= tets) return;
        a->vertex[i] = a->vertex[j], a->vertex[j] = vertex;
        a->mate[i] = a->mate[j], a->mate[j] = mate;
        t->tet[a->mate[i] / 4].mate[a->mate[i] % 4] = (uint32_t)(4 * at + i);
        t->tet[a->mate[j] / 4].mate[a->mate[j] % 4] = (uint32_t)(4 * at + j);
    }
}

/* Tetrahedra a and b change places, and their neighbours know it. */
static void swap_tets(brio_triangulation *t, size_t a, size_t b) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    brio_tetrahedron swap = t->tet[a];
    t->tet[a] = t->tet[b], t->tet[b] = swap;
    for (size_t i = 0; i < 4 * tets; i++) {
        uint32_t *mate = &t->tet[i / 4].mate[i % 4], tet = *mate / 4;
        if (tet == a || tet == b) *mate = (uint32_t)(4 * (tet == a ? b : a) + *mate % 4);
    }
}

/* Right again when both are finite or both infinite. */
static void exchange_tets(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    swap_tets(t, draw(e, tets), draw(e, tets));
}

/* The ties broken in another way, or other tetrahedra, with everything else as it should be. */
static void other_tets(scene *e, brio_triangulation *t) {
    tet_set other = e->right[draw(e, ALTERNATIVES)];
    for (size_t m = draw(e, 3); m > 0 && other.count; m--) mutate(e, &other);
    brute_result(&e->s, &other, t);
}

/* A flat tetrahedron on the hull, with everything else as it should be. */
static void flat_tet(scene *e, brio_triangulation *t) {
    tet_set other = e->right[0];
    add_flat_on_hull(e, &other);
    brute_result(&e->s, &other, t);
}

/* One tetrahedron more, a copy whose mates do not know it: the first infinite one goes to the end for a finite one. */
static void unknown_copy(scene *e, brio_triangulation *t) {
    size_t first = t->stats.tetrahedra, tets = first + t->stats.hull_facets, from = draw(e, tets);
    if (tets == 0 || tets == 2 * BRUTE_TETS) return;
    t->tet[tets] = t->tet[from];
    t->stats.hull_facets++;
    if (from >= first) return;
    t->stats.hull_facets--, t->stats.tetrahedra++;
    swap_tets(t, tets, first);
}

static void wrong_representative(scene *e, brio_triangulation *t) {
    t->representative[draw_point(e)] = draw(e, 8) ? draw_point(e) : UINT32_MAX;
}

/* A vertex and its twin change roles everywhere. */
static void other_twin(scene *e, brio_triangulation *t) {
    uint32_t p = draw_point(e), q = twin_of(e, p);
    for (size_t i = 0; i < 4 * (t->stats.tetrahedra + t->stats.hull_facets); i++) {
        uint32_t *v = &t->tet[i / 4].vertex[i % 4];
        *v = *v == p ? q : *v == q ? p : *v;
    }
    for (size_t i = 0; i < e->s.n; i++) {
        uint32_t *r = &t->representative[i];
        *r = *r == p ? q : *r == q ? p : *r;
    }
}

static void wrong_count(scene *e, brio_triangulation *t) {
    size_t *count[] = {&t->stats.vertices, &t->stats.duplicates, &t->stats.hidden};
    *count[draw(e, 3)] += draw(e, 2) ? 1 : SIZE_MAX;
    if (draw(e, 2)) *count[draw(e, 3)] += draw(e, 2) ? 1 : SIZE_MAX;
}

static void wrong_dimension(scene *e, brio_triangulation *t) {
    t->stats.dimension = (int)draw(e, 5) - 1;
}

/* The last tetrahedron goes to the other kind, or is not counted. */
static void wrong_kinds(scene *e, brio_triangulation *t) {
    if (t->stats.tetrahedra == 0) return;
    t->stats.tetrahedra--;
    t->stats.hull_facets += draw(e, 2);
}

/* Tetrahedra are counted that a flat input does not have. */
static void solid_counts(scene *e, brio_triangulation *t) {
    if (draw(e, 2)) t->stats.tetrahedra++;
    if (draw(e, 2)) t->stats.hull_facets++;
}

typedef void (*spoiling)(scene *, brio_triangulation *);

static const spoiling SPOILINGS[] = {
    wrong_mate,   exchange_mates,       wrong_vertex, turn_tet,    exchange_tets,   other_tets, flat_tet,
    unknown_copy, wrong_representative, other_twin,   wrong_count, wrong_dimension, wrong_kinds};
/* Those that need no tetrahedra. */
static const spoiling FLAT_SPOILINGS[] = {wrong_representative, other_twin, wrong_count, wrong_dimension, solid_counts};

static void judge_result(brio_context *ctx, scene *e, const brio_triangulation *t, uint64_t seed, tally *sum) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    as_doubles(&e->s, 0, points, weights);
    brio_status status = brio_triangulation_check(ctx, t, points, e->s.weighted ? weights : NULL, e->s.n);
    bool right = brute_accepts_result(&e->s, t);
    EXPECT(status == (right ? BRIO_OK : BRIO_ERR_CHECK), "seed %llu: %s result: %s", (unsigned long long)seed,
           right ? "right" : "wrong", brio_message(ctx));
    sum->made++, sum->right += right, sum->canonical += right;
    sum->accepted += status == BRIO_OK, sum->refused += status == BRIO_ERR_CHECK;
}

static void spoil_results(brio_context *ctx, scene *e, uint64_t seed, int dimension, tally *sum) {
    static brute_storage copy;
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    brio_triangulation *right = NULL, t;
    make_scene(ctx, e, seed, dimension);
    as_doubles(&e->s, 0, points, weights);
    EXPECT(brio_delaunay(ctx, points, e->s.weighted ? weights : NULL, e->s.n, NULL, &right) == BRIO_OK);
    for (size_t i = 0; i < RESULTS_A_SCENE; i++) {
        brute_copy(right, &copy, &t);
        for (size_t m = i ? 1 + draw(e, 2) : 0; m > 0; m--) {
            if (dimension == 3)
                SPOILINGS[draw(e, sizeof SPOILINGS / sizeof *SPOILINGS)](e, &t);
            else
                FLAT_SPOILINGS[draw(e, sizeof FLAT_SPOILINGS / sizeof *FLAT_SPOILINGS)](e, &t);
        }
        judge_result(ctx, e, &t, seed, sum);
    }
    brio_triangulation_free(right);
}

static void spoil_dimensions(int low, int high, size_t wanted, const char *what) {
    static scene e;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    tally sum = {0};
    for (uint64_t seed = first_seed; sum.made < wanted; seed++)
        spoil_results(ctx, &e, seed, low + (int)(seed % (uint64_t)(high - low + 1)), &sum);
    EXPECT(sum.right > 0 && sum.right < sum.made);
    report(what, &sum);
    brio_context_free(ctx);
}

static void results_pass_exactly_when_all_of_them_is_right(void) {
    spoil_dimensions(3, 3, num_sets, "results");
}

static void flat_results_pass_exactly_when_all_of_them_is_right(void) {
    spoil_dimensions(0, 2, num_sets / 4, "flat results");
}

int main(int argc, char **argv) {
    if (argc > 1) num_sets = strtoull(argv[1], NULL, 10);
    if (argc > 2) first_seed = strtoull(argv[2], NULL, 10);
    RUN(the_check_accepts_what_brute_force_accepts);
    RUN(results_pass_exactly_when_all_of_them_is_right);
    RUN(flat_results_pass_exactly_when_all_of_them_is_right);
    return harness_end();
}
