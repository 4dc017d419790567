/* Triangulations by many ranks, which are threads here: the same checksum and counts as by one process, whatever the
 * number of ranks and tiles and the order of messages. A failure of one rank is that of all. */
#include "base/memory.h"
#include "base/sort.h"
#include "brio/ranks.h"
#include "harness.h"
#include "platform/thread.h"
#include "points.h"
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 6000, MOST_RANKS = 8, BOXES = 4 };

static double points[3 * MOST], weights[MOST];
static char folder[64];

/* --- ranks that are threads --- */

typedef struct {
    uint8_t *bytes;
    uint64_t size, note;
    bool full;
} letter_box;

typedef struct {
    brio_mutex lock;
    brio_condition changed;
    int ranks;
    uint64_t seed;                                 /* of the order of letters; 0: that of ranks */
    letter_box box[BOXES][MOST_RANKS][MOST_RANKS]; /* by exchange, from, to */
} post;

typedef struct {
    post *post;
    int rank;
    uint64_t begun, ended;
    uint8_t *held[MOST_RANKS]; /* what the last end gave */
    brio_rng rng;
} postman;

static int post_begin(void *user, const brio_letter *letters) {
    postman *m = user;
    post *p = m->post;
    brio_mutex_lock(&p->lock);
    for (int i = 0; i < p->ranks; i++) {
        letter_box *b = &p->box[m->begun % BOXES][m->rank][i];
        EXPECT(!b->full && letters[i].rank == i, "an exchange began too early");
        b->bytes = malloc(letters[i].size + 1);
        if (letters[i].size) memcpy(b->bytes, letters[i].bytes, letters[i].size);
        b->size = letters[i].size, b->note = letters[i].note, b->full = true;
    }
    m->begun++;
    EXPECT(m->begun - m->ended <= 2);
    brio_condition_wake_all(&p->changed);
    brio_mutex_unlock(&p->lock);
    return 0;
}

static int post_end(void *user, brio_letter *received) {
    postman *m = user;
    post *p = m->post;
    for (int i = 0; i < p->ranks; i++) {
        free(m->held[i]);
        m->held[i] = NULL;
    }
    brio_mutex_lock(&p->lock);
    for (int i = 0; i < p->ranks; i++) {
        letter_box *b = &p->box[m->ended % BOXES][i][m->rank];
        while (!b->full) brio_condition_wait(&p->changed, &p->lock);
        m->held[i] = b->bytes;
        received[i] = (brio_letter){.bytes = b->bytes, .size = b->size, .note = b->note, .rank = i};
        b->full = false;
    }
    m->ended++;
    brio_mutex_unlock(&p->lock);
    for (int i = p->ranks; p->seed && i > 1; i--) {
        uint32_t j = brio_rng_below(&m->rng, (uint32_t)i);
        brio_letter swap = received[i - 1];
        received[i - 1] = received[j], received[j] = swap;
    }
    return 0;
}

/* --- a run --- */

typedef struct {
    size_t n;
    bool weighted, parts, cells;
    int ranks, fails; /* fails: the rank that does, or -1 */
    int refuses;      /* 1 + the rank that ends the cells, or 0 */
    uint32_t tiles;
    uint64_t seed, key;
    brio_status expected_failure;
} plan;

typedef struct {
    const plan *plan;
    postman man;
    brio_thread thread;
    brio_status status;
    brio_tiles_stats facts;
    brio_ranks_traffic traffic;
    uint64_t checksum, parts; /* parts: a sum over the indices of the vertices of all tetrahedra */
    uint64_t cells;           /* a sum over the sites and volumes of all cells */
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

static uint64_t hash_of_cell(uint64_t site, const brio_cells *cells, size_t c) {
    uint64_t faces = cells->face_offsets[c + 1] - cells->face_offsets[c];
    return brio_mix(site ^ brio_mix(brio_double_key(cells->volume[c]) ^ brio_mix(faces)));
}

static int hash_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    uint64_t *sum = user;
    for (size_t c = 0; c < cells->num_cells; c++) *sum += hash_of_cell(site[c], cells, c);
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

/* Leaves no memory from the moment when a tile is triangulated, as a brio_progress_fn. */
static int starve(const char *stage, double fraction, void *user) {
    (void)fraction;
    if (!strcmp(stage, "insert")) brio_context_set_memory_limit(user, brio_context_memory(user) + 1000);
    return 0;
}

static brio_status run_member(brio_context *ctx, member *m, brio_ranks *r) {
    const plan *p = m->plan;
    brio_status status = BRIO_OK;
    m->had_points = brio_ranks_has_points(r);
    if (!m->had_points) BRIO_TRY(brio_ranks_agree(ctx, r, add_share(ctx, r, m), NULL));
    if (p->fails == m->man.rank) brio_context_set_progress(ctx, starve, ctx);
    BRIO_TRY(brio_ranks_run(ctx, r));
    BRIO_TRY(brio_ranks_checksum(ctx, r, &m->checksum));
    for (uint32_t i = 0; p->parts && i < p->tiles; i++) {
        brio_tile_part part = {.size = sizeof part};
        BRIO_TRY(brio_ranks_part(ctx, r, i, &part));
        m->parts += hash_of_part(&part, p->weighted);
        brio_tile_part_free(ctx, &part);
    }
    if (p->cells) {
        brio_cells_options o = {.size = sizeof o, .box = BOX};
        brio_tile_cells_fn take = p->refuses == m->man.rank + 1 ? refuse_cells : hash_cells;
        BRIO_TRY(brio_ranks_cells(ctx, r, &o, take, &m->cells));
        m->sums = *brio_ranks_cells_facts(r);
    }
    m->facts = *brio_ranks_facts(r);
    m->traffic = *brio_ranks_sent(r);
done:
    return status;
}

static void work(void *argument) {
    member *m = argument;
    brio_context *ctx = new_context();
    brio_ranks *r = NULL;
    brio_transport t = {.size = sizeof t,
                        .rank = m->man.rank,
                        .ranks = m->plan->ranks,
                        .host = "here",
                        .user = &m->man,
                        .begin = post_begin,
                        .end = post_end};
    brio_ranks_options o = {
        .size = sizeof o, .scratch = folder, .tiles = m->plan->tiles, .key = m->plan->key, .stars = m->plan->cells};
    brio_context_set_threads(ctx, 1);
    m->status = brio_ranks_new(ctx, &t, &o, &r);
    if (m->status == BRIO_OK) m->status = run_member(ctx, m, r);
    snprintf(m->sentence, sizeof m->sentence, "%s", m->status == BRIO_OK ? "" : brio_message(ctx));
    brio_ranks_free(r);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    for (int i = 0; i < m->plan->ranks; i++) free(m->man.held[i]);
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
        EXPECT(members[i].status == members[0].status && !strcmp(members[i].sentence, members[0].sentence),
               "rank 0: %s; rank %d: %s", members[0].sentence, i, members[i].sentence);
        EXPECT(members[i].checksum == members[0].checksum);
        members[0].parts += members[i].parts;
        members[0].cells += members[i].cells;
        EXPECT(!memcmp(&members[i].sums, &members[0].sums, sizeof members[0].sums));
    }
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
        uint64_t sum = 0, bounded = 0;
        long double volume = 0;
        EXPECT(brio_delaunay(ctx, points, w, n, &plain, &t) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_voronoi_cells(ctx, t, points, w, n, &o, &cells) == BRIO_OK, "%s", brio_message(ctx));
        for (size_t c = 0; c < cells->num_cells; c++) {
            sum += hash_of_cell(cells->site[c], cells, c);
            bounded += cells->bounded[c];
            if (cells->bounded[c]) volume += cells->volume[c];
        }
        double first = 0;
        for (int k = 0; k < 3; k++) {
            plan p = {.n = n, .weighted = w, .cells = true, .ranks = RANKS[(i + 2 * k) % 5], .fails = -1};
            p.tiles = 1 + (uint32_t)(i + k) % 4, p.seed = (uint64_t)i;
            member m = run_ranks(&p);
            EXPECT(m.status == BRIO_OK, "%s", m.sentence);
            EXPECT(m.cells == sum && m.sums.cells == cells->num_cells && m.sums.bounded == bounded &&
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
    RUN(cells_of_ranks_are_refused);
    RUN(small_sets_with_shuffled_letters);
    RUN(a_rank_without_memory_ends_all_and_they_go_on);
    RUN(a_bad_point_of_one_rank_ends_all);
    rmdir(folder);
    return harness_end();
}
