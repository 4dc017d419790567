/* One tetrahedron of each class of translates, and their mates.
 *
 * A tetrahedron stands for its class if its lexicographically least vertex is in the domain: comparisons of translates
 * do not change when both are moved, so exactly one of a class does. Most mates of such tetrahedra are such, too, and
 * stay. The other facets, near the domain's border, are moved until their least vertex is in the domain, and find each
 * other in a hash table.
 *
 * Classes keep the order of their tetrahedra, and take the place of these: each thread moves those of its part to the
 * part's beginning, and then the parts close up. So no second array is needed.
 *
 * A tetrahedron with redone points is taken from the completion, once: seen from the least of its redone points. */
#include "periodic/periodic.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include "triangulation/triangulation.h"
#include <assert.h>
#include <string.h>

enum { NO_CLASS = UINT32_MAX, TETRAHEDRA_A_THREAD = 1 << 14, FACETS_A_THREAD = 1 << 12 };

/* A list of classes or facets that grows. */
typedef struct {
    uint32_t *list;
    size_t count, capacity;
} numbers;

/* What one thread finds in its part of a run. */
typedef struct {
    size_t first, count; /* its classes */
    numbers border;      /* those with a vertex that is not in the domain */
    numbers open;        /* facets without a mate */
    brio_status status;
} share;

/* The finite or the infinite tetrahedra of the triangulation: `size` of them, from `begin` on. */
typedef struct {
    size_t begin, size;
    size_t first, count; /* their classes */
    share *of;           /* each thread; these ascend */
} run;

typedef struct {
    brio_context *ctx;
    brio_stars *s;
    brio_tetrahedron *tet;   /* of s->t, then of the classes */
    size_t num_known, count; /* tetrahedra of s->t, and classes */
    uint32_t *class_of;      /* of each tetrahedron of s->t: its class, or NO_CLASS */
    run finite, infinite;
    run *at; /* the run that the threads work on */
    numbers border, open;
    int threads;
} folding;

static brio_status append(brio_context *ctx, numbers *n, uint32_t x) {
    BRIO_FORWARD(BRIO_RESERVE(ctx, n->list, n->capacity, n->count + 1));
    n->list[n->count++] = x;
    return BRIO_OK;
}

/* --- classes --- */

static bool is_redone(const folding *f, uint32_t image) {
    return image != BRIO_INFINITE && f->s->redone[brio_images_point(&f->s->images, image)];
}

/* Returns whether a tetrahedron of the triangulation stands for its class.
 *  border  set to whether it has a vertex that is not in the domain. */
static inline bool stands(const folding *f, const uint32_t *v, bool *border) {
    size_t n = f->s->images.num_points;
    int inside = (v[0] < n) + (v[1] < n) + (v[2] < n) + (v[3] < n);
    *border = inside + (v[3] == BRIO_INFINITE) < 4;
    if (inside == 0) return false;
    if (f->s->num_redone && (is_redone(f, v[0]) || is_redone(f, v[1]) || is_redone(f, v[2]) || is_redone(f, v[3])))
        return false;
    return !*border || v[brio_images_least(&f->s->images, v, 4)] < n;
}

/* Numbers those that stand for their classes: in the part of thread 0 from the run's first class on, in the others
 * from 0. */
static void number_some(void *user, size_t from, size_t to, int thread) {
    const folding *f = user;
    share *own = &f->at->of[thread];
    uint32_t *class_of = f->class_of + f->at->begin;
    const brio_tetrahedron *tet = f->tet + f->at->begin;
    for (size_t t = from; t < to && own->status == BRIO_OK; t++) {
        bool border;
        class_of[t] = NO_CLASS;
        if (!stands(f, tet[t].vertex, &border)) continue;
        class_of[t] = (uint32_t)(own->first + own->count++);
        if (border) own->status = append(f->ctx, &own->border, class_of[t]);
    }
}

/* Adds the classes of the threads before. */
static void raise_some(void *user, size_t from, size_t to, int thread) {
    const folding *f = user;
    const share *own = &f->at->of[thread];
    uint32_t *class_of = f->class_of + f->at->begin;
    if (thread == 0) return;
    for (size_t t = from; t < to; t++)
        if (class_of[t] != NO_CLASS) class_of[t] += (uint32_t)own->first;
}

/* Numbers the classes of a run. */
static brio_status number(folding *f, run *r, size_t first) {
    f->at = r;
    r->first = first;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(f->ctx, r->of, (size_t)f->threads));
    r->of[0].first = first;
    BRIO_FORWARD(brio_for(f->ctx, f->threads, r->size, number_some, f));
    for (int i = 0; i < f->threads; i++) {
        share *own = &r->of[i];
        BRIO_FORWARD(own->status);
        own->first = first + r->count;
        r->count += own->count;
        for (size_t n = 0; n < own->border.count && i > 0; n++) own->border.list[n] += (uint32_t)own->first;
    }
    return f->threads > 1 ? brio_for(f->ctx, f->threads, r->size, raise_some, f) : BRIO_OK;
}

/* Moves the vertices of a tetrahedron so that the least one is in the domain. */
static brio_status move_to_domain(folding *f, uint32_t *v) {
    brio_images *m = &f->s->images;
    const brio_image least = m->list[v[brio_images_least(m, v, 4)]];
    for (int k = 0; k < 4; k++) {
        if (v[k] == BRIO_INFINITE) continue;
        brio_image i = m->list[v[k]];
        for (int a = 0; a < 3; a++) i.shift[a] -= least.shift[a];
        BRIO_FORWARD(brio_images_find(m, i.point, i.shift, &v[k]));
    }
    return BRIO_OK;
}

/* Returns whether a completed tetrahedron is seen from the least of its redone points. */
static bool is_seen_once(const folding *f, const uint32_t *v) {
    const brio_images *m = &f->s->images;
    uint32_t least = BRIO_INFINITE;
    for (int k = 0; k < 4; k++)
        if (is_redone(f, v[k]) && (least == BRIO_INFINITE || brio_images_compare(m, v[k], least) < 0)) least = v[k];
    return least < m->num_points;
}

/* Returns whether a completed tetrahedron, finite or infinite as is asked for, stands for its class. */
static bool is_kept(const folding *f, const uint32_t *v, bool infinite) {
    return (v[3] == BRIO_INFINITE) == infinite && is_seen_once(f, v);
}

static size_t count_extra(const folding *f, bool infinite) {
    size_t count = 0;
    for (size_t n = 0; n < f->s->num_extra; n++) count += is_kept(f, f->s->extra[n], infinite);
    return count;
}

/* Notes that a facet has no mate yet.   class  of the tetrahedron, which is `tet`. */
static brio_status add_open(brio_context *ctx, numbers *open, brio_tetrahedron *tet, size_t class, int i) {
    tet->mate[i] = UINT32_MAX;
    return append(ctx, open, (uint32_t)(4 * class) + (uint32_t)i);
}

/* Writes the completed ones, from a class on. */
static brio_status keep_extra(folding *f, bool infinite, size_t class) {
    for (size_t n = 0; n < f->s->num_extra; n++) {
        uint32_t v[4];
        bool border = false;
        memcpy(v, f->s->extra[n], sizeof v);
        if (!is_kept(f, v, infinite)) continue;
        BRIO_FORWARD(move_to_domain(f, v));
        for (int k = 0; k < 4; k++) border |= v[k] >= f->s->images.num_points && v[k] != BRIO_INFINITE;
        if (border) BRIO_FORWARD(append(f->ctx, &f->border, (uint32_t) class));
        memcpy(f->tet[class].vertex, v, sizeof v);
        for (int i = 0; i < 4; i++) BRIO_FORWARD(add_open(f->ctx, &f->open, &f->tet[class], class, i));
        class ++;
        BRIO_FORWARD(brio_look(f->ctx, 1));
    }
    return BRIO_OK;
}

/* --- mates --- */

/* A facet, moved so that its least vertex is in the domain: the vertices in their order, BRIO_INFINITE last. */
typedef struct {
    uint32_t point[3];
    int32_t shift[3][3];
} facet_key;

static facet_key key_of(const brio_images *m, const uint32_t *v, int but) {
    uint32_t w[3];
    facet_key key;
    int n = 0;
    memset(&key, 0, sizeof key);
    for (int k = 0; k < 4; k++) {
        if (k == but) continue;
        int at = n++;
        for (; at > 0 &&
               (w[at - 1] == BRIO_INFINITE || (v[k] != BRIO_INFINITE && brio_images_compare(m, v[k], w[at - 1]) < 0));
             at--)
            w[at] = w[at - 1];
        w[at] = v[k];
    }
    for (int k = 0; k < 3; k++) {
        key.point[k] = BRIO_INFINITE;
        if (w[k] == BRIO_INFINITE) continue;
        key.point[k] = m->list[w[k]].point;
        for (int a = 0; a < 3; a++) key.shift[k][a] = m->list[w[k]].shift[a] - m->list[w[0]].shift[a];
    }
    return key;
}

static uint64_t hash_of(const facet_key *key) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        hash = brio_mix(hash + key->point[k]);
        for (int a = 0; a < 3; a++) hash = hash * 31 + (uint32_t)key->shift[k][a];
    }
    return brio_mix(hash);
}

/* Writes what stands for its class to the beginning of the thread's part, with the mates that stand, too. */
static void write_some(void *user, size_t from, size_t to, int thread) {
    const folding *f = user;
    const run *r = f->at;
    share *own = &r->of[thread];
    brio_tetrahedron *out = f->tet + r->begin + brio_part(r->size, thread, f->threads);
    for (size_t t = r->begin + from; t < r->begin + to && own->status == BRIO_OK; t++) {
        uint32_t class = f->class_of[t];
        if (class == NO_CLASS) continue;
        const brio_tetrahedron tet = f->tet[t];
        brio_tetrahedron *to_write = &out[class - own->first];
        assert(to_write <= &f->tet[t]);
        memcpy(to_write->vertex, tet.vertex, sizeof tet.vertex);
        for (int i = 0; i < 4; i++) {
            uint32_t other = f->class_of[tet.mate[i] >> 2];
            to_write->mate[i] = 4 * other + (tet.mate[i] & 3);
            if (other == NO_CLASS) brio_report(&own->status, add_open(f->ctx, &own->open, to_write, class, i));
        }
    }
}

static void move(folding *f, size_t to, size_t from, size_t count) {
    if (to != from && count) memmove(f->tet + to, f->tet + from, count * sizeof *f->tet);
}

/* Writes the classes of a run, one after another from the run's beginning on. */
static brio_status write(folding *f, run *r) {
    f->at = r;
    BRIO_FORWARD(brio_for(f->ctx, f->threads, r->size, write_some, f));
    for (int i = 0; i < f->threads; i++) {
        const share *own = &r->of[i];
        BRIO_FORWARD(own->status);
        move(f, r->begin + own->first - r->first, r->begin + brio_part(r->size, i, f->threads), own->count);
    }
    return BRIO_OK;
}

/* Adds what the threads found in a run to the lists. */
static brio_status collect(folding *f, const run *r) {
    for (int i = 0; i < f->threads; i++) {
        const numbers *from[] = {&r->of[i].border, &r->of[i].open};
        numbers *to[] = {&f->border, &f->open};
        for (int k = 0; k < 2; k++) {
            if (!from[k]->count) continue;
            BRIO_FORWARD(BRIO_RESERVE(f->ctx, to[k]->list, to[k]->capacity, to[k]->count + from[k]->count));
            memcpy(to[k]->list + to[k]->count, from[k]->list, from[k]->count * sizeof *from[k]->list);
            to[k]->count += from[k]->count;
        }
    }
    return BRIO_OK;
}

/* Open facets that find each other. Each thread joins those whose hashes are its own. */
typedef struct {
    folding *f;
    uint64_t *hash; /* of each open facet */
    int threads;
    size_t waiting; /* facets without a mate; atomic */
    brio_status status;
} joining;

static void hash_some(void *user, size_t from, size_t to, int thread) {
    const joining *j = user;
    (void)thread;
    for (size_t n = from; n < to; n++) {
        uint32_t facet = j->f->open.list[n];
        facet_key key = key_of(&j->f->s->images, j->f->tet[facet >> 2].vertex, (int)(facet & 3));
        j->hash[n] = hash_of(&key);
    }
}

/* Returns whether two open facets are one, up to a translation. */
static bool are_mates(const joining *j, uint32_t n, uint32_t other) {
    const uint32_t *open = j->f->open.list;
    if (j->hash[n] != j->hash[other]) return false;
    facet_key a = key_of(&j->f->s->images, j->f->tet[open[n] >> 2].vertex, (int)(open[n] & 3));
    facet_key b = key_of(&j->f->s->images, j->f->tet[open[other] >> 2].vertex, (int)(open[other] & 3));
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Finds the mate of open facet n among those that wait for theirs, or lets it wait.   slot  `size` of them. */
static void find_mate(const joining *j, uint32_t *slot, size_t size, uint32_t n, size_t *waiting) {
    const uint32_t *open = j->f->open.list;
    brio_tetrahedron *tet = j->f->tet;
    size_t at = j->hash[n] & (size - 1);
    for (; slot[at] != UINT32_MAX; at = (at + 1) & (size - 1)) {
        uint32_t facet = open[n], other = open[slot[at]];
        if (tet[other >> 2].mate[other & 3] != UINT32_MAX || !are_mates(j, n, slot[at])) continue;
        tet[facet >> 2].mate[facet & 3] = other;
        tet[other >> 2].mate[other & 3] = facet;
        --*waiting;
        return;
    }
    slot[at] = n;
    ++*waiting;
}

static inline bool is_own(const joining *j, size_t n, int thread) {
    return (j->hash[n] >> 32) % (unsigned)j->threads == (unsigned)thread;
}

static void join_own(void *user, size_t from, size_t to, int thread) {
    joining *j = user;
    uint32_t *slot = NULL;
    size_t size = 64, own = 0, waiting = 0, count = j->f->open.count;
    (void)from, (void)to;
    for (size_t n = 0; n < count; n++) own += is_own(j, n, thread);
    while (size < 2 * own) size *= 2;
    brio_report(&j->status, BRIO_ALLOC(j->f->ctx, slot, size));
    if (!slot) return;
    memset(slot, 0xff, size * sizeof *slot);
    for (size_t n = 0; n < count; n++)
        if (is_own(j, n, thread)) find_mate(j, slot, size, (uint32_t)n, &waiting);
    __atomic_add_fetch(&j->waiting, waiting, __ATOMIC_RELAXED);
    brio_release(j->f->ctx, slot);
}

/* Finds the mates of facets that have none. */
static brio_status link_open(folding *f) {
    brio_status status = BRIO_OK;
    joining j = {.f = f, .threads = brio_threads(f->ctx, f->open.count, FACETS_A_THREAD)};
    BRIO_TRY(BRIO_ALLOC(f->ctx, j.hash, f->open.count + 1));
    BRIO_TRY(brio_for(f->ctx, j.threads, f->open.count, hash_some, &j));
    BRIO_TRY(brio_for_parts(f->ctx, j.threads, (size_t)j.threads, join_own, &j));
    BRIO_TRY(j.status);
    BRIO_REQUIRE(f->ctx, j.waiting == 0, BRIO_ERR_INTERNAL, "%zu facets of a periodic triangulation have no mates",
                 j.waiting);
done:
    brio_release(f->ctx, j.hash);
    return status;
}

static brio_status fold(folding *f) {
    BRIO_FORWARD(BRIO_ALLOC(f->ctx, f->class_of, f->num_known + 1));
    BRIO_FORWARD(number(f, &f->finite, 0));
    size_t finite = f->finite.count + count_extra(f, false);
    BRIO_FORWARD(number(f, &f->infinite, finite));
    size_t behind = finite + f->infinite.count, count = f->count = behind + count_extra(f, true);
    BRIO_EXPECT(f->ctx, count < (size_t)1 << 30, BRIO_ERR_TOO_LARGE, "2^30 tetrahedra or more");
    BRIO_FORWARD(write(f, &f->finite));
    BRIO_FORWARD(write(f, &f->infinite));
    if (count > f->num_known) BRIO_FORWARD(BRIO_RESIZE(f->ctx, f->tet, count));
    move(f, finite, f->infinite.begin, f->infinite.count);
    BRIO_FORWARD(collect(f, &f->finite));
    BRIO_FORWARD(keep_extra(f, false, f->finite.count));
    BRIO_FORWARD(collect(f, &f->infinite));
    BRIO_FORWARD(keep_extra(f, true, behind));
    BRIO_FORWARD(BRIO_RESIZE(f->ctx, f->tet, count + 1));
    return link_open(f);
}

static void free_run(const folding *f, run *r) {
    for (int i = 0; r->of && i < f->threads; i++) {
        brio_release(f->ctx, r->of[i].border.list);
        brio_release(f->ctx, r->of[i].open.list);
    }
    brio_release(f->ctx, r->of);
}

brio_status brio_periodic_fold(brio_context *ctx, brio_stars *s, brio_folded *out) {
    const brio_delaunay_stats *facts = brio_triangulation_stats(s->t);
    folding f = {.ctx = ctx, .s = s, .tet = s->t->tet, .num_known = facts->tetrahedra + facts->hull_facets};
    f.finite = (run){.size = facts->tetrahedra};
    f.infinite = (run){.begin = facts->tetrahedra, .size = facts->hull_facets};
    f.threads = brio_threads(ctx, f.num_known, TETRAHEDRA_A_THREAD);
    s->t->tet = NULL; /* the classes take its place */
    brio_status status = fold(&f);
    if (status == BRIO_OK) {
        size_t finite = f.infinite.first;
        *out = (brio_folded){f.tet, finite, f.count - finite, f.border.list, f.border.count};
        f.tet = NULL;
        f.border.list = NULL;
    }
    free_run(&f, &f.finite);
    free_run(&f, &f.infinite);
    brio_release(ctx, f.border.list);
    brio_release(ctx, f.open.list);
    brio_release(ctx, f.tet);
    brio_release(ctx, f.class_of);
    return status;
}

/* --- steps across facets --- */

void brio_periodic_across(const brio_images *m, const brio_tetrahedron *tet, size_t t, int i, int32_t shift[3]) {
    uint32_t facet = tet[t].mate[i], n = (uint32_t)m->num_points;
    const uint32_t *v = tet[t].vertex, *w = tet[facet >> 2].vertex;
    memset(shift, 0, 3 * sizeof *shift);
    if (v[0] < n && v[1] < n && v[2] < n && v[3] < n && w[0] < n && w[1] < n && w[2] < n && w[3] < n) return;
    const brio_image *a = &m->list[v[brio_images_least(m, v, i)]];
    const brio_image *b = &m->list[w[brio_images_least(m, w, (int)(facet & 3))]];
    assert(a->point == b->point); /* I2 of periodic.h */
    for (int k = 0; k < 3; k++) shift[k] = a->shift[k] - b->shift[k];
}
