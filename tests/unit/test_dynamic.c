/* Triangulations that live. The oracle: after any sequence of changes the snapshot is the result of brio_delaunay of the
 * points that are left, equal in every byte. */
#include "living_world.h"

#include "failing_allocator.h"

static void change(world *w, size_t usual) {
    static const double STEP[] = {1e-9, 1e-3, 0.125, 1};
    size_t n = draw() < 0.8 ? 1 : 1 + draw_below(64);
    double more = w->num_points < usual ? 0.6 : 0.4, what = draw();
    if (what < 0.7 * more)
        insert_some(w, n);
    else if (what < 0.7)
        remove_some(w, n);
    else if (what < 0.9)
        move_some(w, n, STEP[draw_below(4)]);
    else
        reweight_some(w, n);
}

static void changes(shape s, int weighted, size_t usual, size_t count, size_t every) {
    world w = world_new(s, weighted, 64 * count + 1);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, weighted, &w.d) == BRIO_OK);
    size_t differences = 0;
    for (size_t i = 1; i <= count; i++) {
        change(&w, usual);
        if (i % every) continue;
        differences += !is_as_built(&w);
        EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        if (differences) break;
    }
    EXPECT(differences == 0, "%s, weighted %d, usual %zu", SHAPE[s], weighted, usual);
    world_free(&w);
}

static void any_changes_end_as_built(void) {
    for (int s = 0; s < NUM_SHAPES; s++)
        for (int weighted = 0; weighted < 2; weighted++) {
            changes((shape)s, weighted, 12, BRIEF_TESTS ? 60 : 300, 1);
            changes((shape)s, weighted, 150, BRIEF_TESTS ? 60 : SHORT_TESTS ? 300 : 20000, 7);
        }
}

/* --- many at once --- */

static void move_all(world *w, double step) {
    double *p = calloc(3 * w->num_points, sizeof *p);
    brio_dynamic_points(w->d, NULL, p, NULL);
    for (size_t i = 0; i < 3 * w->num_points; i++) p[i] += step * (draw() - 0.5);
    EXPECT(brio_dynamic_move(w->d, NULL, p, NULL, w->num_points) == BRIO_OK, "%s", brio_message(w->ctx));
    for (size_t i = 0, n = 0; i < w->num_indices; i++)
        if (w->alive[i]) memcpy(w->point + 3 * i, p + 3 * n++, 3 * sizeof *p);
    free(p);
}

/* All points move by shares of their spacing: together, where tetrahedra are mended, until building anew is faster. */
static void all_points_move(void) {
    static const double SHARE[] = {1e-4, 1e-3, 1e-2, 5e-2, 0.5};
    size_t n = BRIEF_TESTS ? 1500 : SHORT_TESTS ? 4000 : 20000, together = 0;
    for (int s = 0; s < 2; s++) {
        world w = world_new(s ? CLUSTERS : UNIFORM, 0, n + 1);
        EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
        insert_many(&w, n);
        remove_some(&w, 40);
        for (size_t i = 0; i < sizeof SHARE / sizeof *SHARE; i++) {
            brio_dynamic_stats before = {.size = sizeof before}, after = {.size = sizeof after};
            EXPECT(brio_dynamic_facts(w.d, &before) == BRIO_OK);
            move_all(&w, SHARE[i] / cbrt((double)n) * (s ? 1e-3 : 1));
            EXPECT(brio_dynamic_facts(w.d, &after) == BRIO_OK);
            together += before.anew == after.anew && after.in_place - before.in_place > n / 2;
            EXPECT(is_as_built(&w), "%s, %g", SHAPE[w.shape], SHARE[i]);
            EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        }
        world_free(&w);
    }
    EXPECT(together >= 4, "%zu moves without building anew", together);
}

/* Many steps of all points, so that most tetrahedra are not tested in most of them: some points jump, weights change,
 * single points come, go and move in between, and calls are cancelled. */
static void steps_of_all_points_end_as_built(void) {
    static const double STEP[] = {1e-4, 2e-3, 1e-2};
    size_t n = BRIEF_TESTS ? 1100 : 1500, left = 0, cancelled = 0;
    for (int s = 0; s < 6; s++) {
        int weighted = s % 2;
        shape kind = s < 4 ? UNIFORM : CLUSTERS;
        double spacing = (kind == CLUSTERS ? 1e-3 : 1) / cbrt((double)n);
        world w = world_new(kind, weighted, 40000);
        EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, weighted, &w.d) == BRIO_OK);
        insert_many(&w, n);
        double *p = calloc(3 * 40000, sizeof *p);
        brio_context_set_threads(w.ctx, s < 2 ? 1 : 3);
        for (int step = 0; step < (BRIEF_TESTS ? 12 : 24); step++) {
            brio_dynamic_points(w.d, NULL, p, NULL);
            for (size_t i = 0; i < 3 * w.num_points; i++) p[i] += STEP[(step / 5) % 3] * spacing * (draw() - 0.5);
            for (size_t i = 0; i < 2 && step % 3 == 0; i++) p[3 * draw_below(w.num_points)] += spacing;
            left = step % 7 == 3 ? 2 + (size_t)step / 7 : 0;
            brio_context_set_progress(w.ctx, left ? stop_at : NULL, &left);
            brio_status status = brio_dynamic_move(w.d, NULL, p, NULL, w.num_points);
            brio_context_set_progress(w.ctx, NULL, NULL);
            cancelled += status == BRIO_ERR_CANCELLED;
            EXPECT(status == BRIO_OK || status == BRIO_ERR_CANCELLED, "%s", brio_message(w.ctx));
            for (size_t i = 0, k = 0; i < w.num_indices && status == BRIO_OK; i++)
                if (w.alive[i]) memcpy(w.point + 3 * i, p + 3 * k++, 3 * sizeof *p);
            if (step % 4 == 1) insert_some(&w, 2), remove_some(&w, 2), move_some(&w, 60, 0.02 * spacing);
            if (step % 4 == 3) reweight_some(&w, 1);
            EXPECT(is_as_built(&w), "%s, weighted %d, step %d", SHAPE[kind], weighted, step);
        }
        EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
        free(p);
        world_free(&w);
    }
    EXPECT(cancelled > 0);
}

/* Points that change places in one call: the first meets the second where that still is, and took its name for what
 * followed, so that the second's wish went to the first. */
static void points_change_places(void) {
    size_t n = 1500;
    world w = world_new(UNIFORM, 0, n + 1);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
    insert_many(&w, n);
    double *p = calloc(3 * n, sizeof *p);
    for (size_t ring = 2; ring <= 5; ring++) {
        memcpy(p, w.point, 3 * n * sizeof *p);
        for (size_t i = 0; i < ring; i++) {
            size_t from = 7 + 211 * i, to = 7 + 211 * ((i + 1) % ring);
            memcpy(p + 3 * from, w.point + 3 * to, 3 * sizeof *p);
        }
        EXPECT(brio_dynamic_move(w.d, NULL, p, NULL, n) == BRIO_OK, "%s", brio_message(w.ctx));
        memcpy(w.point, p, 3 * n * sizeof *p);
        EXPECT(is_as_built(&w), "%zu points", ring);
        EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
    }
    free(p);
    world_free(&w);
}

/* Weights that hide neighbours, in calls that give all points their weight: a repair that took in the whole stars of
 * both, the hidden point first, lost it. */
static void weights_of_all_may_hide_some(void) {
    size_t n = 1200;
    double spacing = 1 / cbrt((double)n);
    world w = world_new(UNIFORM, 1, n + 1);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 1, &w.d) == BRIO_OK);
    insert_many(&w, n);
    for (int round = 0; round < (BRIEF_TESTS ? 20 : 100); round++) {
        for (size_t i = 0; i < n; i++) w.weight[i] = 0;
        EXPECT(brio_dynamic_reweight(w.d, NULL, w.weight, n) == BRIO_OK, "%s", brio_message(w.ctx));
        for (int some = 0; some < 3; some++) w.weight[draw_below(n)] = (0.2 + 1.3 * draw()) * spacing * spacing;
        EXPECT(brio_dynamic_reweight(w.d, NULL, w.weight, n) == BRIO_OK, "%s", brio_message(w.ctx));
        EXPECT(is_as_built(&w), "round %d", round);
        EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
    }
    world_free(&w);
}

/* Coordinates whose differences overflow, and those whose squares underflow. */
static void coordinates_may_be_huge_or_tiny(void) {
    static const double SCALE[] = {1.7e308, 1e160, 1e-160, 3e-323, 0};
    for (size_t s = 0; s < sizeof SCALE / sizeof *SCALE; s++)
        for (int weighted = 0; weighted < 2; weighted++) {
            world w = world_new(UNIFORM, weighted, 200);
            EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, weighted, &w.d) == BRIO_OK);
            for (uint32_t i = 0; i < 40; i++) {
                double p[3], q[3], weight = weighted ? 1e-3 * draw() * SCALE[s] : 0;
                for (int c = 0; c < 3; c++) p[c] = (2 * draw() - 1) * SCALE[s], q[c] = (2 * draw() - 1) * SCALE[s];
                EXPECT(brio_dynamic_insert(w.d, p, weighted ? &weight : NULL, 1, NULL) == BRIO_OK);
                enter(&w, w.num_indices++, p, weight);
                if (i % 3 == 0) {
                    EXPECT(brio_dynamic_move(w.d, &i, q, NULL, 1) == BRIO_OK);
                    enter(&w, i, q, weight);
                }
                uint32_t v[4];
                EXPECT(brio_dynamic_locate(w.d, q, v) == BRIO_OK);
                EXPECT(is_as_built(&w), "%g, weighted %d, %u", SCALE[s], weighted, i);
            }
            EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(w.ctx));
            while (w.num_points > 0) remove_some(&w, 3);
            EXPECT(is_as_built(&w));
            world_free(&w);
        }
}

/* Vertices whose stars have hundreds of tetrahedra: their links go through brio_delaunay; the whole star, anew. */
static void centres_of_spheres_go(void) {
    world w = world_new(UNIFORM, 0, 2000);
    double p[3 * 402];
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
    for (size_t i = 0; i < 400; i++) {
        double length = 0;
        for (size_t c = 0; c < 3; c++) p[3 * i + c] = draw() - 0.5, length += p[3 * i + c] * p[3 * i + c];
        for (size_t c = 0; c < 3; c++) p[3 * i + c] /= sqrt(length);
    }
    for (size_t c = 0; c < 3; c++) p[1200 + c] = 0, p[1203 + c] = 0.01 * (double)(c + 1);
    EXPECT(brio_dynamic_insert(w.d, p, NULL, 402, NULL) == BRIO_OK);
    for (size_t i = 0; i < 402; i++) enter(&w, w.num_indices++, p + 3 * i, 0);
    const uint32_t *neighbours;
    size_t degree;
    EXPECT(brio_dynamic_neighbours(w.d, 400, &neighbours, &degree) == BRIO_OK && degree > 100, "%zu", degree);
    for (uint32_t gone = 400; gone < 402; gone++) {
        EXPECT(brio_dynamic_remove(w.d, &gone, 1) == BRIO_OK, "%s", brio_message(w.ctx));
        w.alive[gone] = 0, w.num_points--;
        EXPECT(is_as_built(&w), "%u", gone);
    }
    world_free(&w);
}

/* --- holes that moved points have folded --- */

/* Whether mates are mates of each other and have the same three vertices. */
static int mates_agree(const brio_dynamic *d) {
    for (uint32_t slot = 0; slot < d->t.count; slot++) {
        if (d->state[slot] & SLOT_UNUSED) continue;
        for (int k = 0; k < 4; k++) {
            uint32_t mate = d->t.tet[slot].mate[k], other = brio_tet_of(mate);
            if (d->state[other] & SLOT_UNUSED || *brio_mate(&d->t, mate) != brio_facet_of(slot, k)) return 0;
            for (int i = 0; i < 4; i++) {
                uint32_t v = d->t.tet[slot].vertex[i];
                if (i != k && brio_slot_of_vertex(d->t.tet[other].vertex, v) > 3) return 0;
                if (i != k && brio_slot_of_vertex(d->t.tet[other].vertex, v) == brio_slot_of(mate)) return 0;
            }
        }
    }
    return 1;
}

/* Makes a hole of some tetrahedra that hang together. */
static void dig_anywhere(brio_dynamic *d, size_t most) {
    brio_hole *h = &d->hole;
    uint32_t first = (uint32_t)draw_below(d->t.count);
    while (d->state[first] & SLOT_UNUSED) first = (uint32_t)draw_below(d->t.count);
    h->tet[0] = first, h->num_tets = 1, h->num_border = 0;
    d->state[first] |= SLOT_HOLE;
    for (size_t tries = 0; tries < 4 * most && h->num_tets < most; tries++) {
        uint32_t next = brio_tet_of(d->t.tet[h->tet[draw_below(h->num_tets)]].mate[draw_below(4)]);
        if (brio_in_hole(d, next)) continue;
        d->state[next] |= SLOT_HOLE;
        h->tet[h->num_tets++] = next;
    }
    for (size_t i = 0; i < h->num_tets; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t mate = d->t.tet[h->tet[i]].mate[k];
            if (!brio_in_hole(d, brio_tet_of(mate))) h->border[h->num_border++] = mate;
        }
}

/* Whatever a hole has become when points moved, it is filled with mates that agree, or it stays. */
static void a_folded_hole_is_filled_well_or_not_at_all(void) {
    size_t mended = 0, kept = 0;
    for (int trial = 0; trial < (BRIEF_TESTS ? 200 : 800); trial++) {
        world w = world_new(UNIFORM, 0, 64);
        EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
        insert_some(&w, 8 + draw_below(10));
        bool filled = false;
        brio_live_begin(w.d);
        for (size_t moved = 0; moved < (size_t)(trial % 8); moved++) {
            double *r = w.d->record[1 + draw_below(w.d->num_rows - 1)];
            for (int c = 0; c < 3; c++) r[c] = draw();
        }
        EXPECT(brio_hole_reserve(w.d, 64) == BRIO_OK);
        dig_anywhere(w.d, 2 + draw_below(12));
        EXPECT(brio_hole_reserve_fresh(w.d, w.d->hole.num_border) == BRIO_OK);
        EXPECT(brio_hole_mend(w.d, &filled) == BRIO_OK);
        EXPECT(mates_agree(w.d), "trial %d", trial);
        mended += filled, kept += !filled;
        EXPECT(brio_live_end(w.d, BRIO_ERR_INTERNAL) == BRIO_ERR_INTERNAL);
        EXPECT(mates_agree(w.d));
        world_free(&w);
    }
    EXPECT(mended > 20 && kept > 20, "%zu and %zu", mended, kept);
}

/* Two tetrahedra of a hole, of which the first has come to hold the second: their borders are facets of the triangulation
 * of all eight vertices, and bound what lies between them from both sides. Filled, the hole would have tetrahedra whose
 * mates have other mates. */
static void a_hole_that_covers_a_place_twice_stays(void) {
    static const double CORNER[4][3] = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}};
    size_t tried = 0;
    for (int trial = 0; trial < 40; trial++) {
        world w = world_new(UNIFORM, 0, 64);
        bool filled = false;
        EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
        insert_some(&w, 50);
        brio_live_begin(w.d);
        brio_hole *h = &w.d->hole;
        uint32_t pair[2] = {(uint32_t)draw_below(w.d->t.count), (uint32_t)draw_below(w.d->t.count)};
        int apart = !brio_is_infinite(&w.d->t, pair[0]) && !brio_is_infinite(&w.d->t, pair[1]);
        for (int k = 0; k < 4; k++)
            apart &= brio_slot_of_vertex(w.d->t.tet[pair[1]].vertex, w.d->t.tet[pair[0]].vertex[k]) == 4;
        for (int i = 0; i < 2 && apart; i++) {
            h->tet[h->num_tets++] = pair[i];
            w.d->state[pair[i]] |= SLOT_HOLE;
            for (int k = 0; k < 4; k++) {
                double *r = w.d->record[w.d->t.tet[pair[i]].vertex[k]];
                for (int c = 0; c < 3; c++) r[c] = i ? 1.5 + CORNER[k][c] / 18 : CORNER[k][c];
                h->border[h->num_border++] = w.d->t.tet[pair[i]].mate[k];
            }
        }
        if (apart) {
            EXPECT(brio_hole_reserve_fresh(w.d, h->num_border) == BRIO_OK);
            EXPECT(brio_hole_mend(w.d, &filled) == BRIO_OK);
            EXPECT(!filled && mates_agree(w.d), "trial %d", trial);
        }
        tried += (size_t)apart;
        EXPECT(brio_live_end(w.d, BRIO_ERR_INTERNAL) == BRIO_ERR_INTERNAL);
        world_free(&w);
    }
    EXPECT(tried > 5, "%zu", tried);
}

/* --- what fails leaves all as it was --- */

/* A change that was about to be made by building anew when it failed otherwise: it has failed. */
static void only_one_failure_asks_for_building_anew(void) {
    static const brio_status FAILURE[] = {BRIO_ERR_CANCELLED, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE};
    world w = world_new(UNIFORM, 0, 64);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
    insert_some(&w, 20);
    for (size_t i = 0; i < sizeof FAILURE / sizeof *FAILURE; i++) {
        brio_live_begin(w.d);
        w.d->needs_anew = true;
        EXPECT(brio_live_end(w.d, FAILURE[i]) == FAILURE[i] && !w.d->needs_anew);
    }
    brio_live_begin(w.d);
    w.d->needs_anew = true;
    EXPECT(brio_live_end(w.d, BRIO_ERR_INTERNAL) == BRIO_ERR_INTERNAL && w.d->needs_anew);
    EXPECT(is_as_built(&w));
    world_free(&w);
}

/* A world of about 70 points, some of them coincident or hidden. */
static world small_world(brio_context *ctx, int weighted) {
    world w = world_new(MIXED, weighted, 4000);
    brio_context_free(w.ctx);
    w.ctx = ctx;
    state = 7;
    EXPECT(brio_dynamic_new(ctx, NULL, NULL, 0, weighted, &w.d) == BRIO_OK);
    insert_some(&w, 60);
    insert_some(&w, 10);
    return w;
}

/* Makes change number `which`; on failure the world's own list stays, too. */
static brio_status try_change(world *w, int which) {
    uint32_t index[40];
    double p[3 * 40], weight[40];
    state = 99;
    size_t n = draw_indices(w, 20, index);
    for (size_t i = 0; i < 40; i++) {
        draw_point(w->shape, p + 3 * i);
        weight[i] = w->weighted ? draw_weight(w->shape) : 0;
    }
    const double *weights = w->weighted ? weight : NULL;
    if (which == 0) return brio_dynamic_insert(w->d, p, weights, 40, NULL);
    if (which == 1) return brio_dynamic_remove(w->d, index, n);
    if (which == 2) return brio_dynamic_move(w->d, index, p, weights, n);
    return brio_dynamic_insert(w->d, p, weights, 1, NULL);
}

enum { NUM_CHANGES = 4 };

static void failing_memory_leaves_all(void) {
    for (int weighted = 0; weighted < 2; weighted++)
        for (int which = 0; which < NUM_CHANGES; which++) {
            brio_status status = BRIO_ERR_NO_MEMORY;
            for (size_t k = 1; k < 4000 && status != BRIO_OK; k += BRIEF_TESTS ? 11 : 1) {
                failing_memory memory = {0, 0};
                brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
                brio_context *ctx;
                EXPECT(brio_context_new(&allocator, &ctx) == BRIO_OK);
                brio_context_set_threads(ctx, 1);
                world w = small_world(ctx, weighted);
                memory.left = k;
                status = try_change(&w, which);
                memory.left = 0;
                EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "%s", brio_status_string(status));
                if (status != BRIO_OK) {
                    EXPECT(is_as_built(&w), "weighted %d, change %d, request %zu", weighted, which, k);
                    EXPECT(brio_dynamic_check(w.ctx, w.d) == BRIO_OK, "%s", brio_message(ctx));
                    EXPECT(try_change(&w, which) == BRIO_OK);
                }
                world_free(&w);
                EXPECT(memory.live == 0, "%zu blocks left", memory.live);
            }
            EXPECT(status == BRIO_OK);
        }
}

static void cancelled_changes_leave_all(void) {
    world w = world_new(UNIFORM, 0, 60000);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
    insert_many(&w, 3000);
    size_t n = 20000, cancelled = 0, left = 0;
    double *p = calloc(3 * n, sizeof *p);
    for (size_t i = 0; i < 3 * n; i++) p[i] = draw();
    brio_context_set_progress(w.ctx, stop_at, &left);
    for (size_t k = 1; k < 40; k += BRIEF_TESTS ? 7 : 2) {
        for (size_t some = 500; some <= n; some += n - 500) {
            left = k;
            brio_status status = brio_dynamic_insert(w.d, p, NULL, some, NULL);
            left = 0;
            cancelled += status == BRIO_ERR_CANCELLED;
            if (status == BRIO_OK) {
                for (size_t i = 0; i < some; i++) enter(&w, w.num_indices++, p + 3 * i, 0);
                k = 40;
                break;
            }
            EXPECT(status == BRIO_ERR_CANCELLED && is_as_built(&w));
        }
    }
    EXPECT(cancelled > 0 && is_as_built(&w));
    free(p);
    world_free(&w);
}

/* A call that was told to stop has failed, wherever it was: one that was about to build anew did so, and succeeded. */
static int stop_at_a_look(const char *stage, double fraction, void *user) {
    world *w = user;
    (void)stage, (void)fraction;
    w->ctx->unlooked = BRIO_LOOK_EVERY; /* the next look asks, too */
    return w->looks > 0 && --w->looks == 0;
}

static void cancelled_moves_of_all_leave_all(void) {
    static const double SHARE[] = {0.01, 0.03, 0.06};
    size_t n = 1200, cancelled = 0;
    double *p = calloc(3 * n, sizeof *p);
    for (int s = 0; s < 3; s++) {
        world w = world_new(UNIFORM, 0, n + 1);
        brio_status status = BRIO_ERR_CANCELLED;
        EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
        insert_many(&w, n);
        brio_context_set_progress(w.ctx, stop_at_a_look, &w);
        for (size_t k = 1; k < 1000000 && status != BRIO_OK; k += 1 + k / (BRIEF_TESTS ? 4 : SHORT_TESTS ? 12 : 60)) {
            for (size_t i = 0; i < 3 * n; i++) p[i] = w.point[i] + SHARE[s] / cbrt((double)n) * (2 * draw() - 1);
            w.looks = k;
            w.ctx->unlooked = BRIO_LOOK_EVERY;
            status = brio_dynamic_move(w.d, NULL, p, NULL, n);
            EXPECT((status == BRIO_OK) == (w.looks > 0) && (status == BRIO_OK || status == BRIO_ERR_CANCELLED),
                   "%s, %zu are left", brio_message(w.ctx), w.looks);
            w.looks = 0;
            cancelled += status != BRIO_OK;
            if (status == BRIO_OK) memcpy(w.point, p, 3 * n * sizeof *p);
            EXPECT(is_as_built(&w), "share %g, stopped at %zu", SHARE[s], k);
        }
        world_free(&w);
    }
    EXPECT(cancelled > 3, "%zu", cancelled);
    free(p);
}

static void wrong_arguments_are_refused(void) {
    world w = world_new(UNIFORM, 0, 200);
    double p[9] = {0.1, 0.2, 0.3, NAN, 0, 0, 1, 1, 1}, weight[3] = {1, 1, 1};
    uint32_t twice[2] = {3, 3}, none[1] = {70}, gone[1] = {5};
    EXPECT(brio_dynamic_new(w.ctx, p, weight, 1, 0, &w.d) == BRIO_ERR_ARGUMENT && !w.d);
    EXPECT(brio_dynamic_new(w.ctx, p, NULL, 3, 0, &w.d) == BRIO_ERR_NOT_FINITE && !w.d);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 0, &w.d) == BRIO_OK);
    insert_some(&w, 50);
    EXPECT(brio_dynamic_insert(w.d, p, NULL, 3, NULL) == BRIO_ERR_NOT_FINITE);
    EXPECT(brio_dynamic_insert(w.d, p, weight, 1, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_remove(w.d, twice, 2) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_remove(w.d, none, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_move(w.d, twice, p, NULL, 2) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_move(w.d, gone, p + 3, NULL, 1) == BRIO_ERR_NOT_FINITE);
    EXPECT(brio_dynamic_move(w.d, NULL, p, NULL, 3) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_reweight(w.d, gone, weight, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(is_as_built(&w));
    EXPECT(brio_dynamic_remove(w.d, gone, 1) == BRIO_OK);
    w.alive[5] = 0, w.num_points--;
    EXPECT(brio_dynamic_remove(w.d, gone, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_dynamic_point(w.d, 5, NULL) == BRIO_DYNAMIC_NONE);
    EXPECT(is_as_built(&w));
    world_free(&w);
}

/* --- questions --- */

static void questions_are_answered_between_changes(void) {
    world w = world_new(MIXED, 1, 5000);
    EXPECT(brio_dynamic_new(w.ctx, NULL, NULL, 0, 1, &w.d) == BRIO_OK);
    for (int round = 0; round < 20; round++) {
        insert_some(&w, 40);
        remove_some(&w, 20);
        brio_dynamic_stats s = {.size = sizeof s};
        size_t kinds[5] = {0}, ends = 0;
        EXPECT(brio_dynamic_facts(w.d, &s) == BRIO_OK && s.points == w.num_points && s.indices == w.num_indices);
        for (uint32_t i = 0; i < w.num_indices; i++) {
            double record[4];
            brio_dynamic_state kind = brio_dynamic_point(w.d, i, record);
            kinds[kind]++;
            EXPECT((kind != BRIO_DYNAMIC_NONE) == w.alive[i]);
            if (kind == BRIO_DYNAMIC_NONE) continue;
            for (int c = 0; c < 3; c++) EXPECT(record[c] == w.point[3 * i + (uint32_t)c]); /* -0 is 0 */
            EXPECT(record[3] == w.weight[i]);
            const uint32_t *neighbours;
            size_t count;
            EXPECT(brio_dynamic_neighbours(w.d, i, &neighbours, &count) == BRIO_OK);
            EXPECT((count > 0) == (kind == BRIO_DYNAMIC_VERTEX));
            ends += count;
        }
        EXPECT(kinds[BRIO_DYNAMIC_VERTEX] == s.vertices && kinds[BRIO_DYNAMIC_FLAT] == 0);
        /* Euler's relation of a ball: vertices - edges + facets - tetrahedra = 1 */
        EXPECT(s.vertices - ends / 2 + (4 * s.tetrahedra + s.hull_facets) / 2 - s.tetrahedra == 1);
        for (int i = 0; i < 20; i++) {
            double x[3] = {draw(), draw(), i ? draw() : 1e300}; /* the first is far away */
            uint32_t v[4];
            EXPECT(brio_dynamic_locate(w.d, x, v) == BRIO_OK);
            for (int k = 0; k < 4 && v[0] != BRIO_INFINITE; k++) {
                const double *q[4];
                for (int c = 0; c < 4; c++) q[c] = c == k ? x : w.point + 3 * v[c];
                EXPECT(brio_orient3d(q[0], q[1], q[2], q[3]) >= 0);
            }
        }
        EXPECT(is_as_built(&w));
    }
    world_free(&w);
}

SUITE(test_dynamic) {
    RUN(any_changes_end_as_built);
    RUN(all_points_move);
    RUN(steps_of_all_points_end_as_built);
    RUN(points_change_places);
    RUN(weights_of_all_may_hide_some);
    RUN(coordinates_may_be_huge_or_tiny);
    RUN(centres_of_spheres_go);
    RUN(a_folded_hole_is_filled_well_or_not_at_all);
    RUN(a_hole_that_covers_a_place_twice_stays);
    RUN(only_one_failure_asks_for_building_anew);
    RUN(failing_memory_leaves_all);
    RUN(cancelled_changes_leave_all);
    RUN(cancelled_moves_of_all_leave_all);
    RUN(wrong_arguments_are_refused);
    RUN(questions_are_answered_between_changes);
    return harness_end();
}
