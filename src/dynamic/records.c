/* The records that points get in a call, and how far they go. */
#include "base/finite.h"
#include "base/memory.h"
#include "base/team.h"
#include "dynamic/live.h"
#include <string.h>

enum { LEAST = 1 << 13, EXPONENTS = 1 << 11 }; /* LEAST: points that are worth a thread */

/* What a thread has seen. */
typedef struct {
    double low[4], high[4], longest; /* longest: the square of the longest path */
    size_t moved;
    bool finite;
    uint32_t with[EXPONENTS]; /* paths whose square has an exponent, biased as in a double */
} sight;

typedef struct {
    const brio_dynamic *d;
    const brio_moves *m;
    const uint32_t *names;
    brio_record *record;
    sight *seen;
} writing;

brio_status brio_new_record(const brio_dynamic *d, const brio_moves *m, size_t i, uint32_t name, double record[4]) {
    memcpy(record, d->record[d->row_of[name]], sizeof(brio_record));
    for (int c = 0; m->points && c < 3; c++) record[c] = m->points[3 * i + (size_t)c] + 0.0;
    if (m->weights) record[3] = m->weights[i] + 0.0;
    BRIO_EXPECT(d->ctx, brio_all_finite(record, 4), BRIO_ERR_NOT_FINITE, "point %zu is not finite", i);
    return BRIO_OK;
}

/* --- all rows --- */

static unsigned exponent_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (unsigned)(bits >> 52 & (EXPONENTS - 1));
}

static double square_path(const double *p, const double *q) {
    double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z;
}

/* Copies the records of the store. */
static void copy_part(void *user, size_t begin, size_t end, int thread) {
    writing *w = user;
    (void)thread;
    memcpy(w->record + begin, w->d->record + begin, (end - begin) * sizeof *w->record);
}

static void write_part(void *user, size_t begin, size_t end, int thread) {
    enum { AHEAD = 24 };
    writing *w = user;
    const brio_moves *m = w->m;
    sight *s = &w->seen[thread];
    double bad = 0;
    for (size_t i = begin; i < end; i++) {
        if (i + AHEAD < end) __builtin_prefetch(w->record[w->d->row_of[w->names ? w->names[i + AHEAD] : i + AHEAD]], 1);
        double *r = w->record[w->d->row_of[w->names ? w->names[i] : i]], p[4];
        for (int c = 0; c < 3; c++) p[c] = m->points ? m->points[3 * i + (size_t)c] + 0.0 : r[c];
        p[3] = m->weights ? m->weights[i] + 0.0 : r[3];
        double square = square_path(p, r);
        if (p[3] != r[3]) square = INFINITY;
        s->with[exponent_of(square)]++;
        s->moved += memcmp(p, r, sizeof p) != 0;
        s->longest = square > s->longest ? square : s->longest;
        for (int c = 0; c < 4; c++) {
            bad += p[c] - p[c];
            s->low[c] = p[c] < s->low[c] ? p[c] : s->low[c];
            s->high[c] = p[c] > s->high[c] ? p[c] : s->high[c];
            r[c] = p[c];
        }
    }
    s->finite &= bad == 0;
}

/* Returns the first thread's sight with what the others saw. */
static const sight *all_seen(writing *w, int threads) {
    sight *s = w->seen;
    for (int t = 1; t < threads; t++) {
        const sight *other = &w->seen[t];
        for (int c = 0; c < 4; c++) {
            s->low[c] = fmin(s->low[c], other->low[c]);
            s->high[c] = fmax(s->high[c], other->high[c]);
        }
        s->longest = fmax(s->longest, other->longest);
        s->moved += other->moved;
        s->finite &= other->finite;
        for (int e = 0; e < EXPONENTS; e++) s->with[e] += other->with[e];
    }
    return s;
}

/* Widens the filter's box. On a grid, each record has to say whether it is there, too. */
static void admit(brio_dynamic *d, const brio_record *record, const sight *s) {
    for (size_t r = 1; r < d->num_rows && (d->filter.lattice || d->filter.coarse); r++)
        if (brio_row_kind(d, (uint32_t)r) == ROW_VERTEX) brio_live_admit(d, record[r]);
    brio_live_admit(d, s->low);
    brio_live_admit(d, s->high);
}

/* Chooses the square of the step: the longest path, or a power of two that is much shorter where few are longer. */
static double choose_square(const sight *s, size_t count) {
    enum { SHARE = 256 };
    size_t longer = 0;
    int e = EXPONENTS - 1;
    while (e > 1 && longer + s->with[e] <= count / SHARE) longer += s->with[e--];
    double bound = ldexp(1, e - EXPONENTS / 2 + 2); /* above all squares of this exponent */
    return longer && 4 * bound < s->longest ? bound : s->longest;
}

/* Lists the rows that go further. */
static brio_status list_fast(brio_dynamic *d, double square, brio_paths *p) {
    size_t capacity = 0;
    for (uint32_t r = 1; r < d->num_rows; r++) {
        if (brio_row_kind(d, r) != ROW_VERTEX) continue;
        const double *from = d->record[r], *to = p->record[r];
        if (from[3] == to[3] && square_path(to, from) <= square) continue;
        BRIO_FORWARD(BRIO_RESERVE(d->ctx, p->fast, capacity, p->num_fast + 1));
        p->fast[p->num_fast++] = r;
    }
    return BRIO_OK;
}

/* Returns the names of all points, where these are not 0, 1, ...; else NULL. */
static brio_status list_names(const brio_dynamic *d, uint32_t **names) {
    size_t n = 0;
    if (d->counts.alive == d->num_names) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, *names, d->counts.alive));
    for (size_t i = 0; i < d->num_names; i++)
        if (d->row_of[i] != BRIO_NONE) (*names)[n++] = (uint32_t)i;
    return BRIO_OK;
}

brio_status brio_paths_new(brio_dynamic *d, const brio_moves *m, brio_paths *out) {
    int threads = brio_threads(d->ctx, d->num_rows, LEAST);
    brio_status status = BRIO_OK;
    uint32_t *names = NULL;
    writing w = {.d = d, .m = m};
    brio_paths p = {0};
    BRIO_TRY(BRIO_ALLOC(d->ctx, p.record, d->num_rows));
    if (!m->indices) BRIO_TRY(list_names(d, &names));
    w.names = m->indices ? m->indices : names;
    w.record = p.record;
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, w.seen, (size_t)threads));
    for (int t = 0; t < threads; t++) {
        w.seen[t].finite = true;
        for (int c = 0; c < 4; c++) w.seen[t].low[c] = d->low[c], w.seen[t].high[c] = d->high[c];
    }
    BRIO_TRY(brio_for(d->ctx, threads, d->num_rows, copy_part, &w));
    BRIO_TRY(brio_for(d->ctx, threads, m->count, write_part, &w));
    const sight *seen = all_seen(&w, threads);
    if (!seen->finite && m->points) BRIO_TRY(brio_refuse_not_finite(d->ctx, m->points, m->weights, m->count, NULL));
    for (size_t i = 0; !seen->finite && i < m->count; i++) { /* weights alone are named here */
        double record[4];
        BRIO_TRY(brio_new_record(d, m, i, w.names ? w.names[i] : (uint32_t)i, record));
    }
    admit(d, (const brio_record *)p.record, seen);
    double square = choose_square(seen, m->count);
    if (square < seen->longest || !(square < INFINITY)) BRIO_TRY(list_fast(d, square, &p));
    p.step = sqrt(square) * (1 + 0x1p-40) + (seen->moved ? 1e-160 : 0); /* of a path whose square is 0 */
    p.moved = seen->moved;
    *out = p;
    p = (brio_paths){0};
done:
    brio_release(d->ctx, names);
    brio_release(d->ctx, w.seen);
    brio_paths_free(d->ctx, &p);
    return status;
}

void brio_paths_free(brio_context *ctx, brio_paths *p) {
    brio_release(ctx, p->record);
    brio_release(ctx, p->fast);
    *p = (brio_paths){0};
}
