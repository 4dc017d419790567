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
#include <assert.h>
#include <string.h>

enum { NO_CLASS = UINT32_MAX };

typedef struct {
    brio_context *ctx;
    brio_stars *s;
    const brio_tetrahedron *known; /* of s->t */
    size_t num_finite, num_known;
    uint32_t *class_of; /* of each of them: its class, or NO_CLASS */
    brio_tetrahedron *out;
    size_t count, capacity, finite;
    uint32_t *open; /* facets without a mate */
    size_t num_open, open_capacity;
} folding;

/* --- classes --- */

static bool is_redone(const folding *f, uint32_t image) {
    return image != BRIO_INFINITE && f->s->redone[f->s->images.list[image].point];
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

static brio_status append(folding *f, const uint32_t *v) {
    BRIO_EXPECT(f->ctx, f->count < (size_t)1 << 30, BRIO_ERR_TOO_LARGE, "more than 2^30 tetrahedra");
    BRIO_FORWARD(BRIO_RESERVE(f->ctx, f->out, f->capacity, f->count + 1));
    memcpy(f->out[f->count].vertex, v, sizeof f->out->vertex);
    for (int i = 0; i < 4; i++) f->out[f->count].mate[i] = UINT32_MAX;
    f->count++;
    return BRIO_OK;
}

static brio_status keep(folding *f, size_t from, size_t to) {
    for (size_t t = from; t < to; t++) {
        f->class_of[t] = NO_CLASS;
        if (!stands(f, f->known[t].vertex)) continue;
        f->class_of[t] = (uint32_t)f->count;
        BRIO_FORWARD(append(f, f->known[t].vertex));
        BRIO_FORWARD(brio_look(f->ctx, 1));
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

static brio_status keep_extra(folding *f, bool infinite) {
    for (size_t n = 0; n < f->s->num_extra; n++) {
        uint32_t v[4];
        memcpy(v, f->s->extra[n], sizeof v);
        if ((v[3] == BRIO_INFINITE) != infinite || !is_seen_once(f, v)) continue;
        BRIO_FORWARD(move_to_domain(f, v));
        BRIO_FORWARD(append(f, v));
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

static brio_status link_direct(folding *f, size_t from, size_t to) {
    for (size_t t = from; t < to; t++) {
        uint32_t class = f->class_of[t];
        if (class == NO_CLASS) continue;
        BRIO_FORWARD(brio_look(f->ctx, 1));
        for (int i = 0; i < 4; i++) {
            uint32_t mate = f->known[t].mate[i], other = f->class_of[mate >> 2];
            if (other != NO_CLASS) f->out[class].mate[i] = 4 * other + (mate & 3);
        }
    }
    return BRIO_OK;
}

/* Finds the mates of facets that have none, by a hash table of those that wait for theirs. */
static brio_status link_open(folding *f) {
    const brio_images *m = &f->s->images;
    brio_status status = BRIO_OK;
    uint32_t *slot = NULL;
    size_t size = 64, waiting = 0;
    for (size_t t = 0; t < f->count; t++)
        for (int i = 0; i < 4; i++) {
            if (f->out[t].mate[i] != UINT32_MAX) continue;
            BRIO_TRY(BRIO_RESERVE(f->ctx, f->open, f->open_capacity, f->num_open + 1));
            f->open[f->num_open++] = (uint32_t)(4 * t) + (uint32_t)i;
        }
    while (size < 2 * f->num_open) size *= 2;
    BRIO_TRY(BRIO_ALLOC(f->ctx, slot, size));
    memset(slot, 0xff, size * sizeof *slot);
    for (size_t n = 0; n < f->num_open; n++) {
        uint32_t facet = f->open[n];
        brio_tetrahedron *t = &f->out[facet >> 2];
        facet_key key = key_of(m, t->vertex, (int)(facet & 3));
        size_t at = hash_of(&key) & (size - 1);
        BRIO_TRY(brio_look(f->ctx, 1));
        for (; slot[at] != UINT32_MAX; at = (at + 1) & (size - 1)) {
            brio_tetrahedron *u = &f->out[slot[at] >> 2];
            if (u->mate[slot[at] & 3] != UINT32_MAX) continue; /* has found its mate */
            facet_key other = key_of(m, u->vertex, (int)(slot[at] & 3));
            if (memcmp(&key, &other, sizeof key) != 0) continue;
            t->mate[facet & 3] = slot[at];
            u->mate[slot[at] & 3] = facet;
            break;
        }
        if (t->mate[facet & 3] != UINT32_MAX) {
            waiting--;
            continue;
        }
        slot[at] = facet;
        waiting++;
    }
    BRIO_REQUIRE(f->ctx, waiting == 0, BRIO_ERR_INTERNAL, "%zu facets of a periodic triangulation have no mates",
                 waiting);
done:
    brio_release(f->ctx, slot);
    return status;
}

brio_status brio_periodic_fold(brio_context *ctx, brio_stars *s, brio_tetrahedron **tet, size_t *num_finite,
                               size_t *num_infinite) {
    brio_status status = BRIO_OK;
    const brio_delaunay_stats *facts = brio_triangulation_stats(s->t);
    folding f = {.ctx = ctx, .s = s, .known = brio_triangulation_tetrahedra(s->t)};
    f.num_finite = facts->tetrahedra;
    f.num_known = facts->tetrahedra + facts->hull_facets;
    BRIO_TRY(BRIO_ALLOC(ctx, f.class_of, f.num_known + 1));
    BRIO_TRY(keep(&f, 0, f.num_finite));
    if (s->num_extra) BRIO_TRY(keep_extra(&f, false));
    f.finite = f.count;
    BRIO_TRY(keep(&f, f.num_finite, f.num_known));
    if (s->num_extra) BRIO_TRY(keep_extra(&f, true));
    BRIO_TRY(link_direct(&f, 0, f.num_known));
    BRIO_TRY(link_open(&f));
    *num_finite = f.finite;
    *num_infinite = f.count - f.finite;
    *tet = f.out;
    f.out = NULL;
done:
    brio_release(ctx, f.out);
    brio_release(ctx, f.class_of);
    brio_release(ctx, f.open);
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
