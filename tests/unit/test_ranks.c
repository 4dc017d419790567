/* Triangulations by many ranks, which are threads here: the same checksum and counts as by one process, whatever the
 * number of ranks and tiles and the order of messages. A failure of one rank is that of all. */
#include "base/memory.h"
#include "base/sort.h"
#include "brio/ranks.h"
#include "harness.h"
#include "platform/thread.h"
#include "points.h"
#include "post_office.h"
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 6000, MOST_TILES = 4 /* of a rank whose neighbours are seen */ };

static double points[3 * MOST], weights[MOST];
static char folder[64];

/* --- a run --- */

typedef struct {
    size_t n;
    bool weighted, parts, cells, neighbours;
    int ordered;       /* of the cells */
    int ranks, fails;  /* fails: the rank that does, or -1 */
    int refuses;       /* 1 + the rank that ends the cells, or 0 */
    const char *step;  /* in which the rank `fails` has no memory; NULL: in that of the tiles */
    size_t allocation; /* of `step` that fails once on the rank `fails`; 0: none */
    bool goes_on;      /* each collective call that failed is made once more, when there is memory */
    int calls;         /* of the progress of `step` before memory ends */
    uint32_t tiles;
    uint64_t seed, key;
} plan;

/* What a rank saw of the cells. */
typedef struct {
    uint64_t hash; /* a sum over all numbers of all cells */
    uint64_t count, first, last;
    bool ascending;
} seen_cells;

/* A tile's tetrahedra by the indices of their vertices, and their neighbours. */
typedef struct {
    size_t count;
    uint64_t (*tet)[4];
    brio_tile_neighbour (*neighbours)[4];
} seen_tile;

typedef struct {
    const plan *plan;
    postman man;
    brio_thread thread;
    brio_status status, first_failure;
    ration memory;
    brio_tiles_stats facts;
    brio_ranks_traffic traffic;
    uint64_t checksum, parts; /* parts: a sum over the indices of the vertices of all tetrahedra */
    seen_cells cells;
    seen_tile tile[MOST_TILES];
    brio_tiles_cells_stats sums;
    bool had_points;
    char sentence[512];
} member;

static uint64_t hash_of_part(const brio_tile_part *p, bool weighted) {
    uint64_t sum = 0;
    for (size_t i = 0; i < p->num_tetrahedra; i++) {
        uint64_t hash = 0;
        for (int k = 0; k < 4; k++) {
            uint32_t v = p->tetrahedra[i][k];
            hash += brio_mix(p->index[v]);
            EXPECT(!memcmp(points + 3 * p->index[v], p->points + 3 * (size_t)v, 3 * sizeof *points));
            EXPECT(!weighted || p->weights[v] == weights[p->index[v]]);
        }
        sum += brio_mix(hash);
    }
    return sum;
}

static uint64_t with_doubles(uint64_t hash, const double *x, size_t n) {
    for (size_t i = 0; i < n; i++) hash = brio_mix(hash ^ brio_double_key(x[i]));
    return hash;
}

static uint64_t hash_of_cell(uint64_t site, const brio_cells *cells, size_t c, bool with_faces) {
    uint64_t begin = cells->face_offsets[c], end = cells->face_offsets[c + 1];
    uint64_t hash = brio_mix(site ^ brio_mix(end - begin) ^ cells->bounded[c]);
    hash = with_doubles(with_doubles(hash, &cells->volume[c], 1), &cells->area[c], 1);
    hash = with_doubles(hash, cells->centroid + 3 * c, 3);
    for (uint64_t f = begin; with_faces && f < end; f++) {
        hash = with_doubles(brio_mix(hash ^ (uint64_t)cells->face_neighbours[f]), &cells->face_areas[f], 1);
        hash = with_doubles(hash, cells->face_normals + 3 * f, 3);
    }
    return hash;
}

static int hash_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    seen_cells *s = user;
    for (size_t c = 0; c < cells->num_cells; c++) {
        if (!s->count++) *s = (seen_cells){.count = 1, .first = site[c], .ascending = true};
        if (s->count > 1) s->ascending &= site[c] > s->last;
        s->last = site[c];
        s->hash += hash_of_cell(site[c], cells, c, cells->face_neighbours != NULL);
    }
    return 0;
}

static int refuse_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    (void)cells, (void)site, (void)user;
    return 1;
}

static const double BOX[6] = {-0.5, -0.5, -0.5, 7, 7, 7};

/* Blocks of 101 points go to the ranks in turn. */
static brio_status add_share(brio_context *ctx, brio_ranks *r, const member *m) {
    const plan *p = m->plan;
    for (size_t i = 0, block = 0; i < p->n; i += 101, block++) {
        size_t some = p->n - i < 101 ? p->n - i : 101;
        if ((int)(block % (size_t)p->ranks) != m->man.rank) continue;
        brio_status status = brio_ranks_add(ctx, r, points + 3 * i, p->weighted ? weights + i : NULL, some, i);
        if (status != BRIO_OK) return status;
    }
    return BRIO_OK;
}

typedef struct {
    brio_context *ctx;
    const char *step;
    int calls; /* of the step's beginnings that pass */
} famine;

/* Leaves no memory from the moment when a step begins, as a brio_progress_fn. */
static int starve(const char *step, double fraction, void *user) {
    famine *f = user;
    (void)fraction;
    if (!strcmp(step, f->step) && f->calls-- == 0)
        brio_context_set_memory_limit(f->ctx, brio_context_memory(f->ctx) + 1000);
    return 0;
}

/* --- a rank's memory --- */

/* Lets an allocation of a step fail, if the plan says so. */
static void arm(member *m, const char *step) {
    const plan *p = m->plan;
    bool here = p->allocation && p->fails == m->man.rank && step && !strcmp(step, p->step);
    m->memory.left = here ? p->allocation : 0;
}

static brio_context *context_of(member *m) {
    const brio_allocator memory = {ration_alloc, ration_realloc, ration_free, &m->memory};
    brio_context *ctx;
    if (!m->plan->allocation) return new_context();
    EXPECT(brio_context_new(&memory, &ctx) == BRIO_OK);
    return ctx;
}

/* Whether a call is made once more: its failure is noted, and its cause is gone. */
static bool tries_again(brio_context *ctx, member *m, brio_status status) {
    if (status == BRIO_OK || !m->plan->goes_on || m->first_failure != BRIO_OK) return false;
    m->first_failure = status;
    brio_context_set_progress(ctx, NULL, NULL);
    brio_context_set_memory_limit(ctx, 0);
    return true;
}

#define STEP(call)                                                                                                     \
    do {                                                                                                               \
        brio_status ended = (call);                                                                                    \
        if (tries_again(ctx, m, ended)) ended = (call);                                                                \
        BRIO_TRY(ended);                                                                                               \
    } while (0)

static brio_status see_neighbours(brio_context *ctx, brio_ranks *r, uint32_t tile, seen_tile *s) {
    brio_tile_part part = {.size = sizeof part};
    brio_status status = brio_ranks_part(ctx, r, tile, &part);
    if (status != BRIO_OK) return status;
    free(s->tet), free(s->neighbours);
    s->count = part.num_tetrahedra;
    s->tet = malloc((s->count + 1) * sizeof *s->tet);
    s->neighbours = malloc((s->count + 1) * sizeof *s->neighbours);
    for (size_t i = 0; i < s->count; i++)
        for (int k = 0; k < 4; k++) s->tet[i][k] = part.index[part.tetrahedra[i][k]];
    status = brio_ranks_neighbours(ctx, r, tile, &part, s->neighbours);
    brio_tile_part_free(ctx, &part);
    return status;
}

static brio_status run_member(brio_context *ctx, member *m, brio_ranks *r) {
    const plan *p = m->plan;
    brio_status status = BRIO_OK;
    famine f = {ctx, p->step ? p->step : "insert", p->calls};
    m->had_points = brio_ranks_has_points(r);
    if (!m->had_points) BRIO_TRY(brio_ranks_agree(ctx, r, add_share(ctx, r, m), NULL));
    if (p->fails == m->man.rank && !p->allocation) brio_context_set_progress(ctx, starve, &f);
    arm(m, "run");
    STEP(brio_ranks_run(ctx, r));
    arm(m, "checksum");
    STEP(brio_ranks_checksum(ctx, r, &m->checksum));
    arm(m, NULL);
    for (uint32_t i = 0; p->parts && i < p->tiles; i++) {
        brio_tile_part part = {.size = sizeof part};
        STEP(brio_ranks_part(ctx, r, i, &part));
        m->parts += hash_of_part(&part, p->weighted);
        brio_tile_part_free(ctx, &part);
    }
    arm(m, "neighbours");
    for (uint32_t i = 0; p->neighbours && i < p->tiles; i++) STEP(see_neighbours(ctx, r, i, &m->tile[i]));
    arm(m, "cells");
    if (p->cells) {
        brio_cells_options o = {.size = sizeof o, .box = BOX};
        bool refuses = p->refuses == m->man.rank + 1;
        STEP((m->cells.count = 0,
              brio_ranks_cells(ctx, r, &o, p->ordered, refuses && !m->first_failure ? refuse_cells : hash_cells,
                               &m->cells)));
        m->sums = *brio_ranks_cells_facts(r);
    }
    m->facts = *brio_ranks_facts(r);
    m->traffic = *brio_ranks_sent(r);
done:
    return status;
}

static void work(void *argument) {
    member *m = argument;
    brio_context *ctx = context_of(m);
    brio_ranks *r = NULL;
    brio_transport t = {.size = sizeof t,
                        .rank = m->man.rank,
                        .ranks = m->plan->ranks,
                        .host = "here",
                        .user = &m->man,
                        .begin = post_begin,
                        .end = post_end,
                        .room = m->man.room};
    brio_ranks_options o = {
        .size = sizeof o, .scratch = folder, .tiles = m->plan->tiles, .key = m->plan->key, .stars = m->plan->cells};
    brio_context_set_threads(ctx, 1);
    arm(m, "new");
    m->status = brio_ranks_new(ctx, &t, &o, &r);
    arm(m, NULL);
    if (m->status == BRIO_OK) m->status = run_member(ctx, m, r);
    snprintf(m->sentence, sizeof m->sentence, "%s", m->status == BRIO_OK ? "" : brio_message(ctx));
    brio_ranks_free(r);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    for (int i = 0; i < m->plan->ranks; i++) free(m->man.held[i]);
}

/* Adds the cells of a rank to those of the ranks before it. In order, its sites are behind theirs. */
static void add_seen(const plan *p, seen_cells *all, const seen_cells *s) {
    if (!s->count) return;
    if (!all->count) {
        *all = *s;
        return;
    }
    EXPECT(!p->ordered || (all->ascending && s->ascending && s->first > all->last), "%d ranks of %u tiles", p->ranks,
           p->tiles);
    all->hash += s->hash, all->count += s->count, all->last = s->last;
}

static bool has_vertex(const uint64_t tet[4], uint64_t v) {
    return tet[0] == v || tet[1] == v || tet[2] == v || tet[3] == v;
}

/* Returns the facets without a neighbour. Neighbours share the facet, and each names the other one. */
static uint64_t check_neighbours(const plan *p, const member *members) {
    uint64_t hull = 0;
    for (uint32_t t = 0; t < (uint32_t)p->ranks * p->tiles; t++) {
        const seen_tile *s = &members[t / p->tiles].tile[t % p->tiles];
        for (size_t i = 0; i < s->count; i++)
            for (int k = 0; k < 4; k++) {
                brio_tile_neighbour n = s->neighbours[i][k];
                hull += n.tile == BRIO_NO_TILE;
                if (n.tile == BRIO_NO_TILE) continue;
                const seen_tile *other = &members[n.tile / p->tiles].tile[n.tile % p->tiles];
                bool mutual = false;
                for (int v = 0; v < 4; v++) {
                    brio_tile_neighbour back = other->neighbours[n.tetrahedron][v];
                    mutual |= back.tile == t && back.tetrahedron == i;
                    EXPECT(v == k || has_vertex(other->tet[n.tetrahedron], s->tet[i][v]));
                }
                EXPECT(mutual && (n.tile != t || n.tetrahedron != i), "tile %u, tetrahedron %zu", t, i);
            }
    }
    return hull;
}

/* Runs all ranks. They agree in what they return, except the parts, whose sum is in the first. */
static member run_ranks(const plan *p) {
    static post office;
    static member members[MOST_RANKS];
    office = (post){.ranks = p->ranks, .seed = p->seed};
    brio_mutex_new(&office.lock);
    brio_condition_new(&office.changed);
    for (int i = 0; i < p->ranks; i++) {
        members[i] =
            (member){.plan = p, .man = {.post = &office, .rank = i, .rng = brio_rng_new(p->seed + (uint64_t)i)}};
        EXPECT(brio_thread_start(&members[i].thread, work, &members[i], 1 << 21));
    }
    for (int i = 0; i < p->ranks; i++) brio_thread_join(&members[i].thread);
    for (int i = 1; i < p->ranks; i++) {
        EXPECT(members[i].first_failure == members[0].first_failure);
        EXPECT(members[i].status == members[0].status && !strcmp(members[i].sentence, members[0].sentence),
               "rank 0: %s; rank %d: %s", members[0].sentence, i, members[i].sentence);
        EXPECT(members[i].checksum == members[0].checksum);
        members[0].parts += members[i].parts;
        add_seen(p, &members[0].cells, &members[i].cells);
        EXPECT(!memcmp(&members[i].sums, &members[0].sums, sizeof members[0].sums));
    }
    if (p->neighbours && members[0].status == BRIO_OK)
        EXPECT(check_neighbours(p, members) == members[0].facts.hull_facets);
    for (int i = 0; i < p->ranks; i++)
        for (uint32_t t = 0; t < MOST_TILES; t++) free(members[i].tile[t].tet), free(members[i].tile[t].neighbours);
    brio_condition_free(&office.changed);
    brio_mutex_free(&office.lock);
    return members[0];
}

/* --- what one process says --- */

typedef struct {
    brio_delaunay_stats stats;
    uint64_t checksum, parts;
} expected;

static expected by_one(size_t n, bool weighted) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    expected e = {.parts = 0};
    EXPECT(brio_delaunay(ctx, points, weighted ? weights : NULL, n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_triangulation_checksum(ctx, t, points, &e.checksum) == BRIO_OK);
    e.stats = *brio_triangulation_stats(t);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    for (size_t i = 0; i < e.stats.tetrahedra; i++) {
        uint64_t hash = 0;
        for (int k = 0; k < 4; k++) hash += brio_mix(tet[i].vertex[k]);
        e.parts += brio_mix(hash);
    }
    brio_triangulation_free(t);
    brio_context_free(ctx);
    return e;
}

static size_t make_points(uint64_t seed, size_t n, int kind, bool weighted) {
    size_t side = (size_t)cbrt((double)n);
    if (kind == 0) uniform_points(seed, n, points);
    if (kind == 1) clustered_points(seed, n, points);
    if (kind == 2) sphere_points(seed, n, points);
    if (kind == 3) integer_points(seed, n, 6, points);
    if (kind == 4) {
        n = side * side * side;
        for (size_t i = 0; i < n; i++) {
            points[3 * i] = (double)(i % side), points[3 * i + 1] = (double)(i / side % side);
            points[3 * i + 2] = (double)(i / side / side);
        }
    }
    if (kind == 5) { /* most in a plane */
        uniform_points(seed, n, points);
        for (size_t i = 0; i < n; i++)
            if (i % 97) points[3 * i + 2] = points[3 * i];
    }
    if (kind == 6) { /* all in a plane */
        integer_points(seed, n, 30, points);
        for (size_t i = 0; i < n; i++) points[3 * i + 2] = 2;
    }
    if (weighted) integer_weights(seed, n, 3, weights);
    return n;
}

static void compare(const plan *p, const expected *e, const char *what) {
    member m = run_ranks(p);
    const brio_delaunay_stats *d = &e->stats;
    const brio_tiles_stats *s = &m.facts;
    if (p->weighted && d->dimension < 3 && d->points > 1) {
        EXPECT(m.status == BRIO_ERR_NO_ANSWER);
        return;
    }
    EXPECT(m.status == BRIO_OK, "%s, %d ranks of %u tiles: %s", what, p->ranks, p->tiles, m.sentence);
    EXPECT(m.checksum == e->checksum && s->tetrahedra == d->tetrahedra && s->hull_facets == d->hull_facets,
           "%s, %d ranks of %u tiles, %zu points: %llu tetrahedra, not %zu", what, p->ranks, p->tiles, p->n,
           (unsigned long long)s->tetrahedra, d->tetrahedra);
    EXPECT(s->points == d->points && s->vertices == d->vertices && s->duplicates == d->duplicates &&
           s->dimension == d->dimension && s->hidden == d->hidden);
    if (p->parts) EXPECT(m.parts == e->parts, "%s, %d ranks of %u tiles", what, p->ranks, p->tiles);
}

/* --- tests --- */

static void ranks_give_what_one_process_gives(void) {
    static const int RANKS[] = {1, 2, 3, 5, 8};
    static const char *const NAME[] = {"uniform", "clusters", "sphere", "integers", "grid", "a plane", "flat"};
    for (int i = 0; i < (BRIEF_TESTS ? 14 : SHORT_TESTS ? 28 : 280); i++) {
        plan p = {.weighted = i / 7 % 2,
                  .parts = i % 3 == 0,
                  .ranks = RANKS[i % 5],
                  .fails = -1,
                  .tiles = 1 + (uint32_t)i % 4,
                  .seed = i % 2 ? 77 + (uint64_t)i : 0};
        p.n = make_points(100 + (uint64_t)i, BRIEF_TESTS ? 500 : SHORT_TESTS ? 800 : 5000, i % 7, p.weighted);
        if (i % 7 == 2 && p.n > 900) p.n = 900;
        expected e = by_one(p.n, p.weighted);
        compare(&p, &e, NAME[i % 7]);
    }
}

/* Cells are those of one process. The sum of their volumes is exact, so it is the same for every number of ranks and
 * tiles. */
static void cells_are_those_of_one_process(void) {
    static const int RANKS[] = {1, 2, 3, 5, 8};
    for (int i = 0; i < (BRIEF_TESTS ? 6 : SHORT_TESTS ? 12 : 60); i++) {
        size_t n = make_points(300 + (uint64_t)i, SHORT_TESTS ? 500 : 3000, i % 6, i / 6 % 2);
        const double *w = i / 6 % 2 ? weights : NULL;
        if (i % 6 == 2 && n > 400) n = 400;
        brio_context *ctx = new_context();
        brio_delaunay_options plain = {.size = sizeof plain, .leave_hidden = 1};
        brio_cells_options o = {.size = sizeof o, .box = BOX};
        brio_triangulation *t;
        brio_cells *cells;
        uint64_t sum[2] = {0, 0}, bounded = 0; /* sum: without and with faces */
        long double volume = 0;
        EXPECT(brio_delaunay(ctx, points, w, n, &plain, &t) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_voronoi_cells(ctx, t, points, w, n, &o, &cells) == BRIO_OK, "%s", brio_message(ctx));
        for (size_t c = 0; c < cells->num_cells; c++) {
            for (int k = 0; k < 2; k++) sum[k] += hash_of_cell(cells->site[c], cells, c, k);
            bounded += cells->bounded[c];
            if (cells->bounded[c]) volume += cells->volume[c];
        }
        double first = 0;
        for (int k = 0; k < 3; k++) {
            plan p = {.n = n, .weighted = w, .cells = true, .ranks = RANKS[(i + 2 * k) % 5], .fails = -1};
            p.ordered = k;
            p.tiles = 1 + (uint32_t)(i + k) % 4, p.seed = (uint64_t)i;
            member m = run_ranks(&p);
            EXPECT(m.status == BRIO_OK, "%s", m.sentence);
            EXPECT(m.cells.hash == sum[p.ordered != 2] && m.cells.count == cells->num_cells &&
                       m.sums.cells == cells->num_cells && m.sums.bounded == bounded &&
                       m.sums.faces == cells->face_offsets[cells->num_cells] &&
                       m.sums.region_volume == cells->region_volume,
                   "set %d, %d ranks of %u tiles: %llu cells", i, p.ranks, p.tiles, (unsigned long long)m.sums.cells);
            EXPECT(fabs(m.sums.volume_sum - (double)volume) <= 1e-15 * m.sums.volume_sum, "%.17g", m.sums.volume_sum);
            if (k == 0) first = m.sums.volume_sum;
            EXPECT(m.sums.volume_sum == first, "%.17g, not %.17g", m.sums.volume_sum, first);
        }
        brio_cells_free(cells);
        brio_triangulation_free(t);
        brio_context_free(ctx);
    }
}

static void neighbours_of_all_ranks_are_mutual(void) {
    static const int RANKS[] = {1, 2, 3, 5, 8};
    for (int i = 0; i < (SHORT_TESTS ? 14 : 70); i++) {
        plan p = {.neighbours = true, .weighted = i / 7 % 2, .fails = -1, .tiles = 1 + (uint32_t)i % MOST_TILES};
        p.ranks = RANKS[i % 5], p.seed = (uint64_t)i;
        p.n = make_points(700 + (uint64_t)i, SHORT_TESTS ? 600 : 3000, i % 7, p.weighted);
        if (i % 7 == 2 && p.n > 400) p.n = 400;
        expected e = by_one(p.n, p.weighted);
        compare(&p, &e, "neighbours");
    }
}

static void cells_of_ranks_are_refused(void) {
    plan p = {.n = make_points(7, 400, 0, false), .cells = true, .ranks = 3, .fails = -1, .refuses = 2, .tiles = 2};
    member m = run_ranks(&p);
    EXPECT(m.status == BRIO_ERR_CANCELLED && strstr(m.sentence, "rank 1 on here"), "%s", m.sentence);
    p.n = make_points(7, 400, 6, false), p.refuses = 0;
    m = run_ranks(&p);
    EXPECT(m.status == BRIO_ERR_NO_ANSWER && strstr(m.sentence, "in a plane"), "%s", m.sentence);
}

static void small_sets_with_shuffled_letters(void) {
    brio_rng rng = brio_rng_new(3);
    for (int i = 0; i < (BRIEF_TESTS ? 20 : SHORT_TESTS ? 40 : 1000); i++) {
        plan p = {.weighted = i % 2,
                  .parts = true,
                  .ranks = 1 + (int)brio_rng_below(&rng, 8),
                  .fails = -1,
                  .tiles = 1 + brio_rng_below(&rng, 3),
                  .seed = 1 + brio_rng_next(&rng) / 2};
        p.n = make_points(brio_rng_next(&rng), brio_rng_below(&rng, 120), (int)brio_rng_below(&rng, 7), p.weighted);
        expected e = by_one(p.n, p.weighted);
        compare(&p, &e, "a small set");
    }
}

static size_t files_left(void) {
    DIR *d = opendir(folder);
    size_t n = 0;
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) n += e->d_name[0] != '.';
    if (d) closedir(d);
    return n;
}

static void a_rank_without_memory_ends_all_and_they_go_on(void) {
    size_t n = make_points(5, 5000, 0, false);
    expected e = by_one(n, false);
    plan p = {.n = n, .ranks = 3, .fails = 1, .tiles = 2, .key = 99};
    member m = run_ranks(&p);
    EXPECT(m.status == BRIO_ERR_NO_MEMORY && !strncmp(m.sentence, "rank 1 on here: ", 16), "%s", m.sentence);
    EXPECT(files_left() == 3, "%zu folders were left", files_left());
    p.fails = -1;
    m = run_ranks(&p);
    EXPECT(m.status == BRIO_OK && m.checksum == e.checksum, "%s", m.sentence);
    EXPECT(files_left() == 0);
}

/* A failure of one rank had ended the exchanges for good, and with them the object. */
static void a_call_that_failed_can_be_made_again(void) {
    static const struct {
        const char *step;
        int calls;
    } STEPS[] = {{"insert", 0}, {"insert", 1},     {"checksum", 0},   {"checksum", 1},  {"cells", 0},
                 {"cells", 1},  {"neighbours", 0}, {"neighbours", 1}, {"neighbours", 2}};
    size_t n = make_points(5, 3000, 0, false);
    expected e = by_one(n, false);
    plan p = {.n = n, .ranks = 3, .fails = -1, .tiles = 2, .cells = true, .parts = true, .goes_on = true};
    p.neighbours = true;
    member whole = run_ranks(&p);
    EXPECT(whole.status == BRIO_OK && whole.first_failure == BRIO_OK && whole.checksum == e.checksum);
    for (int rank = 0; rank < 3; rank++) {
        for (size_t i = 0; i < sizeof STEPS / sizeof *STEPS; i++) {
            p.fails = rank, p.refuses = 0, p.step = STEPS[i].step, p.calls = STEPS[i].calls;
            p.seed = i, p.ordered = (int)i % 3 ? 1 : 0;
            member m = run_ranks(&p);
            EXPECT(m.first_failure == BRIO_ERR_NO_MEMORY, "rank %d, %s %d", rank, p.step, p.calls);
            EXPECT(m.status == BRIO_OK && m.checksum == e.checksum && m.parts == e.parts &&
                       m.cells.hash == whole.cells.hash && m.facts.tetrahedra == e.stats.tetrahedra &&
                       m.facts.hidden == whole.facts.hidden,
                   "rank %d, %s %d: %s", rank, p.step, p.calls, m.sentence);
        }
        p.fails = -1, p.refuses = rank + 1;
        member m = run_ranks(&p);
        EXPECT(m.first_failure == BRIO_ERR_CANCELLED && m.status == BRIO_OK && m.cells.hash == whole.cells.hash &&
                   m.sums.volume_sum == whole.sums.volume_sum,
               "rank %d: %s", rank, m.sentence);
        EXPECT(files_left() == 0);
    }
}

/* Each allocation of a step fails once. Other ranks may have come farther than the rank that has no memory, and take part in
 * the exchanges again. */
static void a_step_that_failed_anywhere_can_be_made_again(void) {
    static const char *const STEPS[] = {"run", "checksum", "neighbours", "cells"};
    size_t n = make_points(6, 300, 0, false);
    plan p = {.n = n, .ranks = 3, .fails = -1, .tiles = 2, .goes_on = true, .parts = true, .cells = true};
    p.ordered = 1, p.neighbours = true;
    member whole = run_ranks(&p);
    EXPECT(whole.checksum == by_one(n, false).checksum);
    p.fails = 1;
    for (size_t i = 0; i < sizeof STEPS / sizeof *STEPS; i++) {
        size_t failed = 0;
        p.step = STEPS[i];
        for (p.allocation = 1;; p.allocation += 1 + (SHORT_TESTS ? p.allocation / 32 : 0)) {
            member m = run_ranks(&p);
            if (m.first_failure == BRIO_OK) break;
            failed++;
            if (m.status == BRIO_ERR_ARGUMENT && strstr(m.sentence, "while it divided the points")) continue;
            EXPECT(m.status == BRIO_OK && m.checksum == whole.checksum && m.parts == whole.parts &&
                       m.cells.hash == whole.cells.hash,
                   "%s, allocation %zu: %s", p.step, p.allocation, m.sentence);
        }
        EXPECT(failed > 10, "%s: %zu", p.step, failed);
    }
}

/* A rank without memory for its first words let the others wait for ever. */
static void a_rank_that_cannot_begin_ends_all(void) {
    for (int rank = 0; rank < 3; rank++) {
        plan p = {.n = make_points(6, 100, 0, false), .ranks = 3, .fails = rank, .step = "new", .tiles = 2};
        char begin[32];
        snprintf(begin, sizeof begin, "rank %d on here: ", rank);
        for (p.allocation = 1;; p.allocation++) {
            member m = run_ranks(&p);
            if (m.status == BRIO_OK) break;
            EXPECT(m.status == BRIO_ERR_NO_MEMORY && !strncmp(m.sentence, begin, strlen(begin)), "%s", m.sentence);
        }
        EXPECT(p.allocation > 7, "rank %d: %zu", rank, p.allocation);
        EXPECT(files_left() == 0);
    }
}

/* Ranks that wait for one that fails in the middle of the cells end with its sentence, whichever rank it is. */
static void a_rank_that_ends_its_cells_ends_all(void) {
    for (int rank = 0; rank < 4; rank++) {
        plan p = {.n = make_points(7, 2000, 0, false), .cells = true, .ranks = 4, .fails = -1, .tiles = 2, .seed = 5};
        char begin[32];
        p.refuses = rank + 1;
        member m = run_ranks(&p);
        snprintf(begin, sizeof begin, "rank %d on here: ", rank);
        EXPECT(m.status == BRIO_ERR_CANCELLED && !strncmp(m.sentence, begin, strlen(begin)), "%s", m.sentence);
        EXPECT(m.checksum != 0 && files_left() == 0);
    }
}

/* Without a cell the volume of the region was infinite, not that of the box. */
static void cells_of_no_points(void) {
    plan p = {.cells = true, .ranks = 3, .fails = -1, .tiles = 2};
    member m = run_ranks(&p);
    EXPECT(m.status == BRIO_OK && !m.sums.cells && !m.sums.faces && m.sums.volume_sum == 0, "%s", m.sentence);
    EXPECT(m.sums.region_volume == 7.5 * 7.5 * 7.5, "%g", m.sums.region_volume);
}

static void a_bad_point_of_one_rank_ends_all(void) {
    size_t n = make_points(5, 600, 0, false);
    points[3 * 250 + 1] = NAN; /* of the third block, which rank 2 has */
    plan p = {.n = n, .ranks = 3, .fails = -1, .tiles = 1};
    member m = run_ranks(&p);
    EXPECT(m.status == BRIO_ERR_NOT_FINITE && !strcmp(m.sentence, "rank 2 on here: point 250: y is NaN"), "%s",
           m.sentence);
    EXPECT(files_left() == 0);
}

SUITE(test_ranks) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-ranks-%ld", (long)getpid());
    mkdir(folder, 0700);
    RUN(ranks_give_what_one_process_gives);
    RUN(cells_are_those_of_one_process);
    RUN(neighbours_of_all_ranks_are_mutual);
    RUN(cells_of_ranks_are_refused);
    RUN(small_sets_with_shuffled_letters);
    RUN(a_rank_without_memory_ends_all_and_they_go_on);
    RUN(a_call_that_failed_can_be_made_again);
    RUN(a_step_that_failed_anywhere_can_be_made_again);
    RUN(a_rank_that_cannot_begin_ends_all);
    RUN(a_rank_that_ends_its_cells_ends_all);
    RUN(cells_of_no_points);
    RUN(a_bad_point_of_one_rank_ends_all);
    rmdir(folder);
    return harness_end();
}
