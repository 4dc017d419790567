/* One tetrahedron of each class of translates, and their mates.
 *
 * A tetrahedron stands for its class if its lexicographically least vertex is in the domain: comparisons of translates
 * do not change when both are moved, so exactly one of a class does. Most mates of such tetrahedra are such, too, and
 * stay. The other facets, near the domain's border, are moved until their least vertex is in the domain, and find each
 * other in a hash table.
 *
 * A tetrahedron with redone points is taken from the completion, once: seen from the least of its redone points. */
#include "periodic/periodic.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include <assert.h>
#include <string.h>

/* INSIDE, BORDER: that a tetrahedron stands for its class, with all vertices in the domain or not. Until it has a
 * number. */
enum { INSIDE = 0, BORDER = 1, NO_CLASS = UINT32_MAX, TETRAHEDRA_A_THREAD = 1 << 14 };

/* Facets without a mate that one thread found. */
typedef struct {
    uint32_t *list;
    size_t count, capacity;
    brio_status status;
} open_facets;

typedef struct {
    brio_context *ctx;
    brio_stars *s;
    const brio_tetrahedron *known; /* of s->t */
    size_t num_finite, num_known;
    uint32_t *class_of; /* of each of them: its class, or NO_CLASS */
    brio_tetrahedron *out;
    size_t count, finite;
    uint32_t *border; /* classes with a vertex that is not in the domain */
    size_t num_border, border_capacity;
    open_facets *open; /* one a thread; those of each thread ascend, and come before those of the next */
    int threads;
} folding;

/* --- classes --- */

static bool is_redone(const folding *f, uint32_t image) {
    return image != BRIO_INFINITE && f->s->redone[brio_images_point(&f->s->images, image)];
}

/* Returns whether a tetrahedron of the triangulation stands for its class. */
static bool stands(const folding *f, const uint32_t *v) {
    size_t n = f->s->images.num_points;
    int inside = (v[0] < n) + (v[1] < n) + (v[2] < n) + (v[3] < n);
    if (inside == 0) return false;
    if (f->s->num_redone && (is_redone(f, v[0]) || is_redone(f, v[1]) || is_redone(f, v[2]) || is_redone(f, v[3])))
        return false;
    if (inside == 4 || (inside == 3 && v[3] == BRIO_INFINITE)) return true;
    return v[brio_images_least(&f->s->images, v, 4)] < n;
}

static bool has_image(const folding *f, const uint32_t *v) {
    size_t n = f->s->images.num_points;
    return v[0] >= n || v[1] >= n || v[2] >= n || (v[3] >= n && v[3] != BRIO_INFINITE);
}

static void mark_some(void *user, size_t from, size_t to, int thread) {
    const folding *f = user;
    (void)thread;
    for (size_t t = from; t < to; t++) {
        const uint32_t *v = f->known[t].vertex;
        f->class_of[t] = !stands(f, v) ? NO_CLASS : has_image(f, v) ? BORDER : INSIDE;
    }
}

static brio_status add_border(folding *f, size_t class) {
    BRIO_FORWARD(BRIO_RESERVE(f->ctx, f->border, f->border_capacity, f->num_border + 1));
    f->border[f->num_border++] = (uint32_t) class;
    return BRIO_OK;
}

/* Numbers those that stand for their classes. */
static brio_status number(folding *f, size_t from, size_t to) {
    for (size_t t = from; t < to; t++) {
        BRIO_FORWARD(brio_look(f->ctx, 1));
        if (f->class_of[t] == NO_CLASS) continue;
        if (f->class_of[t] == BORDER) BRIO_FORWARD(add_border(f, f->count));
        f->class_of[t] = (uint32_t)f->count++;
    }
    return BRIO_OK;
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

/* Notes that a facet has no mate yet. */
static brio_status add_open(folding *f, int thread, size_t class, int i) {
    open_facets *o = &f->open[thread];
    f->out[class].mate[i] = UINT32_MAX;
    BRIO_FORWARD(BRIO_RESERVE(f->ctx, o->list, o->capacity, o->count + 1));
    o->list[o->count++] = (uint32_t)(4 * class) + (uint32_t)i;
    return BRIO_OK;
}

static brio_status keep_extra(folding *f, bool infinite) {
    for (size_t n = 0; n < f->s->num_extra; n++) {
        uint32_t v[4];
        memcpy(v, f->s->extra[n], sizeof v);
        if ((v[3] == BRIO_INFINITE) != infinite || !is_seen_once(f, v)) continue;
        BRIO_FORWARD(move_to_domain(f, v));
        if (has_image(f, v)) BRIO_FORWARD(add_border(f, f->count));
        memcpy(f->out[f->count].vertex, v, sizeof v);
        for (int i = 0; i < 4; i++) BRIO_FORWARD(add_open(f, 0, f->count, i));
        f->count++;
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

/* Writes what stands for its class, with the mates that stand, too. */
static brio_status write_one(folding *f, size_t t, int thread) {
    uint32_t class = f->class_of[t];
    brio_tetrahedron *out = &f->out[class];
    memcpy(out->vertex, f->known[t].vertex, sizeof out->vertex);
    for (int i = 0; i < 4; i++) {
        uint32_t mate = f->known[t].mate[i], other = f->class_of[mate >> 2];
        if (other == NO_CLASS)
            BRIO_FORWARD(add_open(f, thread, class, i));
        else
            out->mate[i] = 4 * other + (mate & 3);
    }
    return BRIO_OK;
}

static void write_some(void *user, size_t from, size_t to, int thread) {
    folding *f = user;
    for (size_t t = from; t < to && f->open[thread].status == BRIO_OK; t++)
        if (f->class_of[t] != NO_CLASS) f->open[thread].status = write_one(f, t, thread);
}

/* Finds the mate of a facet among those that wait for theirs, or lets it wait. */
static void find_mate(folding *f, uint32_t *slot, size_t size, uint32_t facet, size_t *waiting) {
    const brio_images *m = &f->s->images;
    brio_tetrahedron *t = &f->out[facet >> 2];
    facet_key key = key_of(m, t->vertex, (int)(facet & 3));
    size_t at = hash_of(&key) & (size - 1);
    for (; slot[at] != UINT32_MAX; at = (at + 1) & (size - 1)) {
        brio_tetrahedron *u = &f->out[slot[at] >> 2];
        if (u->mate[slot[at] & 3] != UINT32_MAX) continue; /* has found its mate */
        facet_key other = key_of(m, u->vertex, (int)(slot[at] & 3));
        if (memcmp(&key, &other, sizeof key) != 0) continue;
        t->mate[facet & 3] = slot[at];
        u->mate[slot[at] & 3] = facet;
        --*waiting;
        return;
    }
    slot[at] = facet;
    ++*waiting;
}

/* Finds the mates of facets that have none. */
static brio_status link_open(folding *f) {
    brio_status status = BRIO_OK;
    uint32_t *slot = NULL;
    size_t size = 64, open = 0, waiting = 0;
    for (int i = 0; i < f->threads; i++) open += f->open[i].count;
    while (size < 2 * open) size *= 2;
    BRIO_TRY(BRIO_ALLOC(f->ctx, slot, size));
    memset(slot, 0xff, size * sizeof *slot);
    for (int i = 0; i < f->threads; i++)
        for (size_t n = 0; n < f->open[i].count; n++) {
            find_mate(f, slot, size, f->open[i].list[n], &waiting);
            BRIO_TRY(brio_look(f->ctx, 1));
        }
    BRIO_REQUIRE(f->ctx, waiting == 0, BRIO_ERR_INTERNAL, "%zu facets of a periodic triangulation have no mates",
                 waiting);
done:
    brio_release(f->ctx, slot);
    return status;
}

static brio_status fold(folding *f) {
    size_t most = f->s->num_extra;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(f->ctx, f->open, (size_t)f->threads));
    BRIO_FORWARD(BRIO_ALLOC(f->ctx, f->class_of, f->num_known + 1));
    BRIO_FORWARD(brio_for(f->ctx, f->threads, f->num_known, mark_some, f));
    for (size_t t = 0; t < f->num_known; t++) most += f->class_of[t] != NO_CLASS;
    BRIO_EXPECT(f->ctx, most < (size_t)1 << 30, BRIO_ERR_TOO_LARGE, "2^30 tetrahedra or more");
    BRIO_FORWARD(BRIO_ALLOC(f->ctx, f->out, most + 1));
    BRIO_FORWARD(number(f, 0, f->num_finite));
    BRIO_FORWARD(keep_extra(f, false));
    f->finite = f->count;
    BRIO_FORWARD(number(f, f->num_finite, f->num_known));
    BRIO_FORWARD(keep_extra(f, true));
    BRIO_FORWARD(brio_for(f->ctx, f->threads, f->num_known, write_some, f));
    for (int i = 0; i < f->threads; i++) BRIO_FORWARD(f->open[i].status);
    return link_open(f);
}

brio_status brio_periodic_fold(brio_context *ctx, brio_stars *s, brio_folded *out) {
    const brio_delaunay_stats *facts = brio_triangulation_stats(s->t);
    folding f = {.ctx = ctx, .s = s, .known = brio_triangulation_tetrahedra(s->t)};
    f.num_finite = facts->tetrahedra;
    f.num_known = facts->tetrahedra + facts->hull_facets;
    f.threads = brio_threads(ctx, f.num_known, TETRAHEDRA_A_THREAD);
    brio_status status = fold(&f);
    if (status == BRIO_OK) {
        *out = (brio_folded){f.out, f.finite, f.count - f.finite, f.border, f.num_border};
        f.out = NULL;
        f.border = NULL;
    }
    for (int i = 0; f.open && i < f.threads; i++) brio_release(ctx, f.open[i].list);
    brio_release(ctx, f.open);
    brio_release(ctx, f.out);
    brio_release(ctx, f.border);
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
