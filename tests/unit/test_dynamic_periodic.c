/* Triangulations that live in space that repeats. The oracle: after any sequence of changes the snapshot has the
 * checksum of a fresh build of the points that are left, on the same grid. */
#include "wrapped_world.h"

#include "failing_allocator.h"

static const shape SHAPES[] = {UNIFORM, GRID, CLUSTERS};

static void changes(shape s, int weighted, int cell, int open, size_t usual, size_t count, size_t every) {
    wrapped w = wrapped_new(s, weighted, cell, open, 64 * count + 1);
    wrapped_start(&w);
    for (size_t i = 1; i <= count; i++) {
        change_wrapped(&w, usual, draw() < 0.8 ? 1 : 1 + draw_below(24));
        if (i % every) continue;
        int same = is_as_fresh(&w);
        EXPECT(same, "%s, weighted %d, cell %d, open %d, usual %zu, change %zu", SHAPE[s], weighted, cell, open, usual,
               i);
        EXPECT(brio_dynamic_periodic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        EXPECT(are_in_place(&w));
        if (!same) break;
    }
    wrapped_free(&w);
}

static void any_changes_end_as_a_fresh_build(void) {
    for (int s = 0; s < 3; s++)
        for (int weighted = 0; weighted < 2; weighted++)
            for (int open = 0; open < 7; open++)
                for (int cell = 0; cell < WRAPPED_CELLS; cell++) {
                    if (SHORT_TESTS && (open + 3 * cell + 2 * s + weighted) % (BRIEF_TESTS ? 17 : 9)) continue;
                    changes(SHAPES[s], weighted, cell, open, 3, SHORT_TESTS ? 16 : 40, SHORT_TESTS ? 2 : 1);
                    changes(SHAPES[s], weighted, cell, open, SHORT_TESTS ? 40 : 100, SHORT_TESTS ? 20 : 60,
                            SHORT_TESTS ? 10 : 7);
                }
}

/* Fills a triangulation with many points. */
static void fill_wrapped(wrapped *w, size_t n) {
    static wish v;
    for (size_t left = n, now; left > 0; left -= now) {
        now = left < AT_ONCE ? left : AT_ONCE;
        draw_wish(w, 0, now, 1, &v);
        EXPECT(make_wish(w, &v) == BRIO_OK, "%s", brio_message(w->ctx));
        note_wish(w, &v);
    }
}

/* All points drift through the box, over its borders: their translates go with them in place. */
static void points_drift_round_the_box(void) {
    size_t n = SHORT_TESTS ? 1050 : 4000;
    for (int open = 0; open < 5; open += 4) {
        wrapped w = wrapped_new(UNIFORM, 0, 1, open, n + 1);
        wrapped_start(&w);
        brio_context_set_threads(w.ctx, 2);
        fill_wrapped(&w, n);
        brio_dynamic_periodic_stats before = {.size = sizeof before}, after = before;
        EXPECT(brio_dynamic_periodic_facts(w.d, &before) == BRIO_OK);
        double *p = malloc(3 * n * sizeof *p);
        for (int step = 0; step < 6; step++) {
            for (size_t i = 0; i < n; i++)
                for (size_t c = 0; c < 3; c++)
                    p[3 * i + c] = w.point[4 * i + c] += (c < 2 ? 0.004 : 0) + 0.0005 * draw();
            EXPECT(brio_dynamic_periodic_move(w.d, NULL, p, NULL, n) == BRIO_OK, "%s", brio_message(w.ctx));
        }
        free(p);
        EXPECT(brio_dynamic_periodic_facts(w.d, &after) == BRIO_OK);
        EXPECT(after.anew == before.anew && after.in_place - before.in_place > 6 * n, "%llu in place",
               (unsigned long long)(after.in_place - before.in_place));
        EXPECT(is_as_fresh(&w) && are_in_place(&w));
        EXPECT(brio_dynamic_periodic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        wrapped_free(&w);
    }
}

/* Names of translates are given anew where many of them are those of points that went. */
static void translates_that_come_and_go_need_no_room(void) {
    static wish in, out;
    wrapped w = wrapped_new(UNIFORM, 0, 0, 0, 40000);
    wrapped_start(&w);
    fill_wrapped(&w, 20);
    for (int round = 0; round < 60; round++) {
        draw_wish(&w, 0, 8, 1, &in);
        EXPECT(make_wish(&w, &in) == BRIO_OK);
        note_wish(&w, &in);
        draw_wish(&w, 1, 8, 1, &out);
        EXPECT(make_wish(&w, &out) == BRIO_OK);
        note_wish(&w, &out);
    }
    brio_dynamic_periodic_stats s = {.size = sizeof s};
    EXPECT(brio_dynamic_periodic_facts(w.d, &s) == BRIO_OK && s.indices == 500 && s.points == 20);
    EXPECT(w.d->inner->num_names < 3 * s.translates + 10000, "%zu", w.d->inner->num_names);
    EXPECT(is_as_fresh(&w));
    EXPECT(brio_dynamic_periodic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
    wrapped_free(&w);
}

/* Two points at one place, of which the first one's translates went and came back: there the second one's were the
 * vertices, whose classes had no mates. */
static void points_at_one_place_have_one_vertex(void) {
    static const double NEAR[6] = {0.01, 0.5, 0.5, 0.01, 0.5, 0.5}, AWAY[3] = {0.5, 0.5, 0.5};
    wrapped w = wrapped_new(UNIFORM, 0, 0, 0, 400);
    uint32_t first, gone;
    wrapped_start(&w);
    EXPECT(brio_dynamic_periodic_insert(w.d, NEAR, NULL, 2, &first) == BRIO_OK);
    for (int i = 0; i < 2; i++, w.num_points++) w.alive[w.num_indices++] = 1;
    memcpy(w.point, (double[8]){0.01, 0.5, 0.5, 0, 0.01, 0.5, 0.5, 0}, 8 * sizeof(double));
    fill_wrapped(&w, 300);
    EXPECT(brio_dynamic_periodic_move(w.d, &first, AWAY, NULL, 1) == BRIO_OK);
    EXPECT(brio_dynamic_periodic_move(w.d, &first, NEAR, NULL, 1) == BRIO_OK);
    const brio_image *neighbours;
    size_t count = 0;
    for (uint32_t i = 0; i < 2; i++) {
        EXPECT(brio_dynamic_periodic_neighbours(w.d, i, &neighbours, &count) == BRIO_OK && (count > 0) == (i == 0));
    }
    EXPECT(is_as_fresh(&w));
    EXPECT(brio_dynamic_periodic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
    gone = 0;
    EXPECT(brio_dynamic_periodic_remove(w.d, &gone, 1) == BRIO_OK);
    w.alive[0] = 0, w.num_points--;
    EXPECT(is_as_fresh(&w));
    wrapped_free(&w);
}

/* The vectors of a cell whose lengths are no sums of few powers of 2 were rounded to the grid. Positions were written
 * as they are in these vectors, and were moved by that once more by who built anew: ties were others then. */
static void positions_in_a_cell_off_the_grid_come_back(void) {
    static wish v;
    for (int cell = 0; cell < 2; cell++)
        for (int open = 0; open < 5; open += 4) {
            wrapped w = wrapped_new(GRID, 0, cell, open, 400);
            for (int k = 0; k < 9; k++) w.cell[k] *= 0.7e-3;
            wrapped_start(&w);
            fill_wrapped(&w, 30);
            for (int i = 0; i < 3; i++) {
                draw_wish(&w, i == 2 ? 0 : 1, 8, 1, &v); /* the origin is one of those that go */
                EXPECT(make_wish(&w, &v) == BRIO_OK, "%s", brio_message(w.ctx));
                note_wish(&w, &v);
                EXPECT(is_as_fresh(&w), "cell %d, open %d, change %d", cell, open, i);
            }
            EXPECT(are_in_place(&w));
            wrapped_free(&w);
        }
}

/* A slab whose first points are in one cell, which is another one than that in which they are near their origin: the
 * grid did not reach these. */
static void the_first_points_are_not_too_far_for_their_grid(void) {
    static const double CELL[9] = {1, 1, 1, -1, 1, 1},
                        POINTS[6] = {0, 0, 0, 0.26358238452267102, -1.0952636551093196, -2.1502671300587517};
    wrapped w = wrapped_new(UNIFORM, 0, 0, 4, 8);
    memcpy(w.cell, CELL, sizeof CELL);
    for (int small = 0; small < 2; small++) {
        brio_dynamic_periodic *d;
        w.options.cell = w.cell, w.options.reach = small ? 1e-3 : 0;
        EXPECT(brio_dynamic_periodic_new(w.ctx, POINTS, NULL, 2, &w.options, &d) == BRIO_OK, "%s", brio_message(w.ctx));
        brio_dynamic_periodic_free(d);
    }
    wrapped_free(&w);
}

/* Two points at both ends of what the grid reaches, after the one between them, its origin, went: a fresh build found
 * them a vector too far from each other, and took a coarser grid. */
static void points_at_the_ends_of_the_reach_have_the_same_grid(void) {
    static const double CELL[9] = {-1, 0.8, 0}, FIRST[3] = {0, 0, 0};
    wrapped w = wrapped_new(UNIFORM, 0, 0, 6, 8);
    uint32_t none = 0;
    memcpy(w.cell, CELL, sizeof CELL);
    w.options.reach = 64;
    wrapped_start(&w);
    EXPECT(brio_dynamic_periodic_insert(w.d, FIRST, NULL, 1, NULL) == BRIO_OK);
    for (int end = -1; end < 2; end += 2)
        for (double far = 33; far > 28; far -= 0.125) { /* the farthest that is taken */
            double share = end < 0 ? 0.9 : 0.05;
            double p[3] = {0.8 * end * far - share, end * far + 0.8 * share, 0};
            if (brio_dynamic_periodic_insert(w.d, p, NULL, 1, NULL) == BRIO_OK) break;
        }
    EXPECT(brio_dynamic_periodic_remove(w.d, &none, 1) == BRIO_OK);
    w.num_indices = 3, w.num_points = 2;
    brio_periodic *fresh = build_fresh(&w);
    for (int k = 0; k < 3; k++) EXPECT(fresh->lattice.unit[k] == w.d->lattice.unit[k], "coordinate %d", k);
    brio_periodic_free(fresh);
    wrapped_free(&w);
}

/* --- failures --- */

/* All points move together, and memory runs out when some translates come and go: their records were written without
 * a journal. */
static void failures_after_a_move_of_all_leave_all(void) {
    enum { POINTS = 1050 };
    static double p[3 * POINTS];
    failing_memory memory = {0, 0};
    brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
    wrapped w = wrapped_new(UNIFORM, 0, 0, 0, POINTS);
    size_t failed = 0;
    brio_context_free(w.ctx);
    EXPECT(brio_context_new(&allocator, &w.ctx) == BRIO_OK);
    brio_context_set_threads(w.ctx, 1);
    wrapped_start(&w);
    fill_wrapped(&w, POINTS);
    for (size_t i = 0; i < POINTS; i++)
        for (size_t c = 0; c < 3; c++) p[3 * i + c] = w.point[4 * i + c] + (c == 0 ? 0.01 : 0) + 2e-4 * draw();
    brio_status status = BRIO_ERR_NO_MEMORY;
    for (size_t k = 1; status != BRIO_OK; k += BRIEF_TESTS ? 5 : 1) {
        memory.left = k;
        status = brio_dynamic_periodic_move(w.d, NULL, p, NULL, POINTS);
        memory.left = 0;
        failed += status == BRIO_ERR_NO_MEMORY;
        if (status == BRIO_OK || (SHORT_TESTS && k % 8)) continue;
        EXPECT(status == BRIO_ERR_NO_MEMORY && brio_dynamic_periodic_check(w.ctx, w.d) == BRIO_OK, "%s",
               brio_message(w.ctx));
    }
    for (size_t i = 0; i < POINTS; i++) memcpy(w.point + 4 * i, p + 3 * i, 3 * sizeof *p);
    EXPECT(failed > 4 && is_as_fresh(&w) && are_in_place(&w));
    wrapped_free(&w);
}

/* One of each kind of change fails at each request for memory, or is stopped at each look; all stays as it was. */
static void failures_leave_all(void) {
    static wish v;
    for (int kind = 0; kind < 8; kind++) {
        failing_memory memory = {0, 0};
        brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
        wrapped w = wrapped_new(kind < 4 ? UNIFORM : GRID, 1, 1, kind % 2 ? 4 : 0, 2000);
        brio_context_free(w.ctx);
        EXPECT(brio_context_new(&allocator, &w.ctx) == BRIO_OK);
        brio_context_set_threads(w.ctx, 1);
        wrapped_start(&w);
        fill_wrapped(&w, 60);
        for (int many = 0; many < 2; many++) {
            uint64_t before = 0, after = 1;
            size_t looks = 0, failed = 0;
            brio_status status = BRIO_ERR_NO_MEMORY;
            EXPECT(brio_dynamic_periodic_checksum(w.ctx, w.d, &before) == BRIO_OK);
            draw_wish(&w, kind % 4, many ? 40 : 2, 0.125, &v); /* 40 that come or go: built anew */
            for (size_t k = 1; status != BRIO_OK; k += SHORT_TESTS ? 9 : 1) {
                memory.left = kind % 3 ? k : 0;
                looks = kind % 3 ? 0 : k;
                brio_context_set_progress(w.ctx, looks ? stop_at : NULL, &looks);
                status = make_wish(&w, &v);
                memory.left = 0;
                brio_context_set_progress(w.ctx, NULL, NULL);
                if (status == BRIO_OK) break;
                failed++;
                EXPECT(status == (kind % 3 ? BRIO_ERR_NO_MEMORY : BRIO_ERR_CANCELLED), "%s", brio_message(w.ctx));
                if (failed % 3 && SHORT_TESTS) continue;
                EXPECT(brio_dynamic_periodic_checksum(w.ctx, w.d, &after) == BRIO_OK && before == after);
                EXPECT(are_in_place(&w));
            }
            EXPECT(failed > 0 || !(kind % 3), "kind %d, many %d", kind, many);
            note_wish(&w, &v);
            EXPECT(is_as_fresh(&w) && are_in_place(&w));
            EXPECT(brio_dynamic_periodic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        }
        wrapped_free(&w);
    }
}

static brio_status make_and_ask(brio_context *ctx) {
    static const double POINTS[] = {0.1, 0.2, 0.3, 0.6, 0.5, 0.9}, AT[3] = {0.5, 0.5, 0.5};
    brio_periodic_options o = {.size = sizeof o, .cell = WRAPPED_CELL[0], .halo = 1e-3};
    brio_dynamic_periodic *d = NULL;
    brio_image vertices[4];
    brio_status status = brio_dynamic_periodic_new(ctx, POINTS, NULL, 2, &o, &d);
    if (status == BRIO_OK) status = brio_dynamic_periodic_locate(d, AT, vertices);
    brio_dynamic_periodic_free(d);
    return status;
}

static void memory_that_runs_out_is_reported(void) {
    expect_clean_failures(make_and_ask);
}

static void wrong_arguments_are_refused(void) {
    static const double FAR[3] = {1e12, 0, 0}, HIGH[3] = {0, 0, 1e6}, P[3] = {0.5, 0.5, 0.5}, WEIGHT[1] = {1};
    uint32_t twice[2] = {0, 0}, none = 7;
    wrapped w = wrapped_new(UNIFORM, 0, 2, 4, 8);
    wrapped_start(&w);
    brio_dynamic_periodic *other;
    const uint32_t gone = 1;
    EXPECT(brio_dynamic_periodic_insert(w.d, P, NULL, 1, NULL) == BRIO_OK);
    EXPECT(brio_dynamic_periodic_insert(w.d, FAR, NULL, 1, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_insert(w.d, P, WEIGHT, 1, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_insert(w.d, (double[3]){NAN, 0, 0}, NULL, 1, NULL) == BRIO_ERR_NOT_FINITE);
    EXPECT(brio_dynamic_periodic_remove(w.d, twice, 2) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_remove(w.d, &none, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_insert(w.d, P, NULL, 1, NULL) == BRIO_OK);
    EXPECT(brio_dynamic_periodic_remove(w.d, &gone, 1) == BRIO_OK);
    EXPECT(brio_dynamic_periodic_remove(w.d, &gone, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_move(w.d, &gone, P, NULL, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_move(w.d, NULL, P, NULL, 2) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_reweight(w.d, twice, WEIGHT, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_periodic_new(w.ctx, NULL, NULL, 0, &(brio_periodic_options){0}, &other) == BRIO_ERR_ARGUMENT);
    wrapped_free(&w);
    /* positions are rounded where a vector of the cell goes, and have to be near there */
    for (int high = 0; high < 2; high++) {
        w = wrapped_new(UNIFORM, 0, 1, 1, 8);
        w.options.reach = high ? 4e6 : 0;
        wrapped_start(&w);
        EXPECT(brio_dynamic_periodic_insert(w.d, P, NULL, 1, NULL) == BRIO_OK);
        EXPECT(brio_dynamic_periodic_insert(w.d, HIGH, NULL, 1, NULL) == (high ? BRIO_OK : BRIO_ERR_ARGUMENT));
        wrapped_free(&w);
    }
    w = wrapped_new(UNIFORM, 0, 2, 4, 8);
    wrapped_start(&w);
    EXPECT(brio_dynamic_periodic_insert(w.d, HIGH, NULL, 1, NULL) == BRIO_OK, "%s", brio_message(w.ctx));
    wrapped_free(&w);
}

/* --- questions --- */

static int compare_images(const void *p, const void *q) {
    return memcmp(p, q, sizeof(brio_image));
}

/* Whether the neighbours of a point are those that a fresh build shows. */
static int has_neighbours_of(wrapped *w, const brio_periodic *fresh, const uint32_t *index, uint32_t place) {
    enum { MOST = 4096 };
    static brio_image own[MOST], other[MOST];
    const brio_periodic_stats *s = brio_periodic_facts(fresh);
    const brio_image *images = brio_periodic_images(fresh), *neighbours;
    const brio_tetrahedron *t = brio_periodic_tetrahedra(fresh);
    size_t count = 0, all = 0, kept = 0;
    for (size_t i = 0; i < 16 * s->tetrahedra && all < MOST; i++) {
        brio_image a = images[t[i / 16].vertex[i / 4 % 4]], b = images[t[i / 16].vertex[i % 4]];
        if (a.point != place || i / 4 % 4 == i % 4) continue;
        other[all] = (brio_image){.point = index[b.point]};
        for (int k = 0; k < 3; k++) other[all].shift[k] = b.shift[k] - a.shift[k];
        all++;
    }
    qsort(other, all, sizeof *other, compare_images);
    for (size_t i = 0; i < all; i++)
        if (i == 0 || memcmp(&other[i - 1], &other[i], sizeof *other) != 0) other[kept++] = other[i];
    EXPECT(brio_dynamic_periodic_neighbours(w->d, index[place], &neighbours, &count) == BRIO_OK);
    if (count != kept) return 0;
    memcpy(own, neighbours, count * sizeof *own);
    qsort(own, count, sizeof *own, compare_images);
    return memcmp(own, other, count * sizeof *own) == 0;
}

/* Whether translates that are the corners of a tetrahedron hold a position, up to rounding. */
static int holds(const wrapped *w, const brio_image v[4], const double *x) {
    double q[4][3], row[3][3];
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++) {
            q[k][c] = w->point[4 * v[k].point + (size_t)c];
            for (int j = 0; j < 3; j++) q[k][c] += v[k].shift[j] * w->cell[3 * j + c];
        }
    for (int k = 0; k < 4; k++) {
        for (int i = 0, n = 0; i < 4; i++) {
            if (i == 3) continue;
            for (int c = 0; c < 3; c++) row[n][c] = (i == k ? x[c] : q[i][c]) - (k == 3 ? x[c] : q[3][c]);
            n++;
        }
        double det = 0;
        for (int c = 0; c < 3; c++)
            det += row[0][c] * (row[1][(c + 1) % 3] * row[2][(c + 2) % 3] - row[1][(c + 2) % 3] * row[2][(c + 1) % 3]);
        if (det > 1e-12) return 0; /* (a, b, c) about d: negative where (a, b, c, d) is positive */
    }
    return 1;
}

static void questions_are_answered_between_changes(void) {
    for (int turn = 0; turn < (SHORT_TESTS ? 6 : 12); turn++) {
        int open = turn % 4 == 3 || turn == 5 ? 4 : 0, few = turn % 3 == 2;
        wrapped w = wrapped_new(turn % 5 == 4 ? GRID : UNIFORM, turn % 2, turn / 2 % 2, open, 3000);
        wrapped_start(&w);
        fill_wrapped(&w, few ? 1 + (size_t)turn % 3 : 250);
        change_wrapped(&w, 0, 5);
        brio_periodic *fresh = build_fresh(&w);
        uint32_t *index = malloc((w.num_points + 1) * sizeof *index);
        brio_dynamic_periodic_points(w.d, index, NULL, NULL);
        for (uint32_t p = 0; p < w.num_points; p += few ? 1 : 5)
            EXPECT(has_neighbours_of(&w, fresh, index, p), "turn %d, point %u", turn, index[p]);
        for (int i = 0; i < 30 && w.num_points; i++) {
            double x[4];
            brio_image v[4];
            draw_wrapped(&w, x);
            EXPECT(brio_dynamic_periodic_locate(w.d, x, v) == BRIO_OK, "%s", brio_message(w.ctx));
            if (v[0].point == BRIO_INFINITE)
                EXPECT(open || brio_periodic_facts(fresh)->tetrahedra == 0);
            else
                EXPECT(holds(&w, v, x), "turn %d", turn);
        }
        free(index);
        brio_periodic_free(fresh);
        wrapped_free(&w);
    }
}

/* At the hull of a slab each question read all tetrahedra of the snapshot. */
static void a_question_reads_the_star_of_its_point(void) {
    wrapped w = wrapped_new(UNIFORM, 0, 0, 4, 200);
    const brio_image *neighbours;
    size_t count, wrong = 0;
    wrapped_start(&w);
    fill_wrapped(&w, 200);
    for (uint32_t i = 0; i < 200; i++) EXPECT(brio_dynamic_periodic_neighbours(w.d, i, &neighbours, &count) == BRIO_OK);
    const brio_periodic *t = w.d->snapshot;
    EXPECT(t && w.d->snapshots == 1 && w.d->star_begin[200] == 4 * t->stats.tetrahedra);
    for (uint32_t p = 0; t && p < 200; p++)
        for (size_t i = w.d->star_begin[p]; i < w.d->star_begin[p + 1]; i++)
            wrong += t->shown[t->tet[w.d->star[i] / 4].vertex[w.d->star[i] % 4]].point != p;
    EXPECT(wrong == 0, "%zu corners", wrong);
    wrapped_free(&w);
}

/* In uniform points nearly all questions are answered without a snapshot. */
static void few_questions_need_a_snapshot(void) {
    wrapped w = wrapped_new(UNIFORM, 0, 0, 0, 2000);
    const brio_image *neighbours;
    size_t count, sum = 0, before = 0;
    brio_dynamic_periodic_stats s = {.size = sizeof s};
    wrapped_start(&w);
    fill_wrapped(&w, 1000);
    for (uint32_t i = 0; i < 1000 && before < 40; i++, before = s.snapshots) {
        EXPECT(brio_dynamic_periodic_neighbours(w.d, i, &neighbours, &count) == BRIO_OK);
        EXPECT(brio_dynamic_periodic_facts(w.d, &s) == BRIO_OK);
        sum += count;
        if (s.snapshots > before) brio_wrapped_forget(w.d);
    }
    EXPECT(s.snapshots < 15, "%llu snapshots", (unsigned long long)s.snapshots);
    EXPECT((double)sum / 1000 > 15 && (double)sum / 1000 < 16, "%g neighbours", (double)sum / 1000);
    wrapped_free(&w);
}

/* In a link that is triangulated anew, a tetrahedron that had gone was tested beside the living ones, though its mates were others by
 * then: an assertion of checked builds failed. */
static void links_forget_what_has_gone(void) {
    state = 32000;
    wrapped w = wrapped_new(GRID, 0, (int)draw_below(WRAPPED_CELLS), (int)draw_below(7), 4000);
    brio_context_set_threads(w.ctx, 1);
    wrapped_start(&w);
    for (int i = 0; i < 200; i++) change_wrapped(&w, 60, 1);
    EXPECT(is_as_fresh(&w));
    wrapped_free(&w);
}

SUITE(test_dynamic_periodic) {
    RUN(any_changes_end_as_a_fresh_build);
    RUN(points_drift_round_the_box);
    RUN(translates_that_come_and_go_need_no_room);
    RUN(points_at_one_place_have_one_vertex);
    RUN(positions_in_a_cell_off_the_grid_come_back);
    RUN(the_first_points_are_not_too_far_for_their_grid);
    RUN(points_at_the_ends_of_the_reach_have_the_same_grid);
    RUN(failures_after_a_move_of_all_leave_all);
    RUN(failures_leave_all);
    RUN(memory_that_runs_out_is_reported);
    RUN(wrong_arguments_are_refused);
    RUN(questions_are_answered_between_changes);
    RUN(a_question_reads_the_star_of_its_point);
    RUN(few_questions_need_a_snapshot);
    RUN(links_forget_what_has_gone);
    return harness_end();
}
