/* All tetrahedra with a vertex in the domain, from one of each class.
 *
 * Cells and stars of the points, or of some of them, are made of them. A class has as many of them as its vertices have
 * different shifts: each moved back by one. The first is the class itself, whose least vertex is in the domain; the
 * others are appended. */
#include "base/memory.h"
#include "base/team.h"
#include "periodic/periodic.h"
#include <assert.h>
#include <string.h>

enum { WORD = 64, WORDS_A_THREAD = 1 << 9 };

/* Where a class is among those that are listed. */
typedef struct {
    uint64_t bits;   /* of WORD classes: whether each is listed */
    uint32_t before; /* the number of listed classes before these */
} listing;

typedef struct {
    brio_context *ctx;
    const brio_periodic *t;
    brio_images *images;
    const uint8_t *wanted; /* of each point whether tetrahedra at it are wanted; NULL: all are */
    size_t num_classes, num_finite;
    listing *list; /* #classes / WORD, rounded up */
    size_t num_listed, listed_finite;
    uint32_t *more;      /* #listed: where the further ones of a class begin in the lists below; 0 is none */
    uint8_t *inside;     /* #listed: whether all its vertices are in the domain */
    uint32_t *class_of;  /* of each further one, from 1 on */
    int32_t (*shift)[3]; /* and how it was moved */
    size_t count, class_capacity, shift_capacity;
    uint32_t *place; /* of each further one: where it is among the tetrahedra */
    size_t more_finite;
} unfolding;

/* Returns the number of a class among those that are listed; UINT32_MAX if it is not. */
static inline uint32_t number_of(const unfolding *u, size_t c) {
    const listing *l = &u->list[c / WORD];
    uint64_t bit = UINT64_C(1) << c % WORD;
    return l->bits & bit ? l->before + (uint32_t)__builtin_popcountll(l->bits & (bit - 1)) : UINT32_MAX;
}

/* Returns the place of a listed class: finite classes, further finite ones, infinite classes, further infinite ones. */
static inline uint32_t place_of(const unfolding *u, uint32_t number) {
    return number < u->listed_finite ? number : number + (uint32_t)u->more_finite;
}

/* Returns the first listed class from c on; num_classes if there is none. */
static size_t next_listed(const unfolding *u, size_t c) {
    for (; c < u->num_classes; c = (c / WORD + 1) * WORD) {
        uint64_t bits = u->list[c / WORD].bits >> c % WORD;
        if (bits) return c + (size_t)__builtin_ctzll(bits);
    }
    return u->num_classes;
}

static bool same_shift(const int32_t *a, const int32_t *b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Lists the further ones of a class. Sets the number of all of it. */
static brio_status list_more(unfolding *u, size_t c, int *count) {
    const uint32_t *v = u->t->tet[c].vertex;
    const brio_image *list = u->t->images.list;
    size_t points = u->t->images.num_points;
    int32_t found[4][3] = {{0}};
    int n = 1;
    *count = 1;
    if (v[0] < points && v[1] < points && v[2] < points && (v[3] < points || v[3] == BRIO_INFINITE)) return BRIO_OK;
    for (int k = 0; k < 4; k++) {
        if (v[k] < points || v[k] == BRIO_INFINITE) continue;
        int at = 0;
        while (at < n && !same_shift(found[at], list[v[k]].shift)) at++;
        if (at < n) continue;
        memcpy(found[n++], list[v[k]].shift, sizeof *found);
    }
    *count = n;
    for (int i = 1; i < n; i++) {
        BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->class_of, u->class_capacity, u->count + 1));
        BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->shift, u->shift_capacity, u->count + 1));
        u->class_of[u->count] = (uint32_t)c;
        for (int k = 0; k < 3; k++) u->shift[u->count][k] = -found[i][k];
        u->count++;
    }
    return BRIO_OK;
}

/* Returns the place of the tetrahedron of a listed class moved by a shift; UINT32_MAX if it has no vertex in the
 * domain. */
static uint32_t find(const unfolding *u, uint32_t c, uint32_t number, const int32_t *shift) {
    static const int32_t none[3] = {0, 0, 0};
    if (same_shift(shift, none)) return place_of(u, number);
    for (size_t i = u->more[number]; i && i < u->count && u->class_of[i] == c; i++)
        if (same_shift(u->shift[i], shift)) return u->place[i];
    return UINT32_MAX;
}

/* Writes the mates of the tetrahedron at `place`, which is class c moved by a shift. */
static void link(const unfolding *u, brio_tetrahedron *tet, uint32_t place, uint32_t c, const int32_t *shift) {
    const brio_tetrahedron *class = &u->t->tet[c];
    size_t n = u->t->images.num_points;
    bool inside = u->inside[number_of(u, c)];
    for (int i = 0; i < 4; i++) {
        uint32_t mate = class->mate[i], other = mate >> 2, number = number_of(u, other);
        int32_t way[3], own = 0;
        tet[place].mate[i] = 4 * place + (uint32_t)i;
        if (number == UINT32_MAX) continue;
        if (inside && u->inside[number]) { /* nearly all: they meet as they are */
            tet[place].mate[i] = 4 * place_of(u, number) + (mate & 3);
            continue;
        }
        for (int k = 0; k < 4; k++) own += k != i && tet[place].vertex[k] < n;
        if (!own) continue;
        brio_periodic_across(&u->t->images, u->t->tet, c, i, way);
        for (int k = 0; k < 3; k++) way[k] += shift[k];
        uint32_t at = find(u, other, number, way);
        assert(at != UINT32_MAX); /* it has the facet's vertex in the domain */
        tet[place].mate[i] = 4 * at + (mate & 3);
    }
}

static brio_status move_vertices(unfolding *u, const uint32_t *v, const int32_t *shift, uint32_t *out) {
    for (int k = 0; k < 4; k++) {
        out[k] = v[k];
        if (v[k] == BRIO_INFINITE) continue;
        brio_image i = u->t->images.list[v[k]];
        for (int a = 0; a < 3; a++) i.shift[a] += shift[a];
        BRIO_FORWARD(brio_images_find(u->images, i.point, i.shift, &out[k]));
    }
    return BRIO_OK;
}

/* Returns whether a class has a point whose tetrahedra are wanted. */
static inline bool is_wanted(const unfolding *u, size_t c) {
    const uint32_t *v = u->t->tet[c].vertex;
    for (int k = 0; k < 4 && u->wanted; k++)
        if (v[k] != BRIO_INFINITE && u->wanted[brio_images_point(&u->t->images, v[k])]) return true;
    return !u->wanted;
}

static void mark_some(void *user, size_t from, size_t to, int thread) {
    const unfolding *u = user;
    (void)thread;
    for (size_t w = from; w < to; w++) {
        size_t end = (w + 1) * WORD < u->num_classes ? (w + 1) * WORD : u->num_classes;
        uint64_t bits = 0;
        for (size_t c = w * WORD; c < end; c++) bits |= (uint64_t)is_wanted(u, c) << c % WORD;
        u->list[w].bits = bits;
    }
}

/* Lists the classes that are wanted, and their further ones. */
static brio_status list_all(unfolding *u) {
    size_t words = (u->num_classes + WORD - 1) / WORD, n = 0;
    BRIO_FORWARD(BRIO_ALLOC(u->ctx, u->list, words + 1));
    BRIO_FORWARD(brio_for(u->ctx, brio_threads(u->ctx, words, WORDS_A_THREAD), words, mark_some, u));
    for (size_t w = 0; w < words; w++) {
        u->list[w].before = (uint32_t)u->num_listed;
        u->num_listed += (size_t)__builtin_popcountll(u->list[w].bits);
    }
    BRIO_FORWARD(BRIO_ALLOC(u->ctx, u->more, u->num_listed + 1));
    BRIO_FORWARD(BRIO_ALLOC(u->ctx, u->inside, u->num_listed + 1));
    for (size_t c = next_listed(u, 0); c < u->num_classes; c = next_listed(u, c + 1), n++) {
        size_t first = u->count;
        int count;
        u->listed_finite += c < u->num_finite;
        BRIO_FORWARD(brio_look(u->ctx, 1));
        BRIO_FORWARD(list_more(u, c, &count));
        u->more[n] = count > 1 ? (uint32_t)first : 0;
        u->inside[n] = count == 1;
    }
    return BRIO_OK;
}

/* Gives the further ones their places: see place_of. */
static brio_status place_more(unfolding *u, size_t *finite, size_t *all) {
    size_t next;
    for (size_t i = 1; i < u->count; i++) u->more_finite += u->class_of[i] < u->num_finite;
    *finite = u->listed_finite + u->more_finite;
    *all = u->num_listed + u->count - 1;
    BRIO_FORWARD(BRIO_ALLOC(u->ctx, u->place, u->count + 1));
    next = u->listed_finite;
    for (size_t i = 1; i < u->count; i++)
        if (u->class_of[i] < u->num_finite) u->place[i] = (uint32_t)next++;
    next = u->num_listed + u->more_finite;
    for (size_t i = 1; i < u->count; i++)
        if (u->class_of[i] >= u->num_finite) u->place[i] = (uint32_t)next++;
    BRIO_EXPECT(u->ctx, *all < (size_t)1 << 30, BRIO_ERR_TOO_LARGE, "more than 2^30 tetrahedra");
    return BRIO_OK;
}

static brio_status fill(unfolding *u, brio_tetrahedron *tet) {
    static const int32_t none[3] = {0, 0, 0};
    uint32_t number = 0;
    for (size_t c = next_listed(u, 0); c < u->num_classes; c = next_listed(u, c + 1), number++) {
        uint32_t place = place_of(u, number);
        BRIO_FORWARD(brio_look(u->ctx, 1));
        memcpy(tet[place].vertex, u->t->tet[c].vertex, sizeof tet->vertex);
        link(u, tet, place, (uint32_t)c, none);
    }
    for (size_t i = 1; i < u->count; i++) {
        uint32_t place = u->place[i];
        BRIO_FORWARD(move_vertices(u, u->t->tet[u->class_of[i]].vertex, u->shift[i], tet[place].vertex));
        link(u, tet, place, u->class_of[i], u->shift[i]);
        BRIO_FORWARD(brio_look(u->ctx, 1));
    }
    return BRIO_OK;
}

static void free_lists(unfolding *u) {
    brio_release(u->ctx, u->list);
    brio_release(u->ctx, u->more);
    brio_release(u->ctx, u->inside);
    brio_release(u->ctx, u->class_of);
    brio_release(u->ctx, u->shift);
    brio_release(u->ctx, u->place);
}

brio_status brio_periodic_further(brio_context *ctx, const brio_periodic *t, brio_images *images, uint32_t (**more)[4],
                                  size_t *num_more) {
    brio_status status = BRIO_OK;
    unfolding u = {.ctx = ctx, .t = t, .images = images, .num_finite = t->stats.tetrahedra, .count = 1};
    *more = NULL;
    *num_more = 0;
    for (size_t i = 0; i < t->num_border; i++) {
        int n;
        if (t->border[i] < t->stats.tetrahedra) BRIO_TRY(list_more(&u, t->border[i], &n));
        BRIO_TRY(brio_look(ctx, 1));
    }
    BRIO_TRY(BRIO_ALLOC(ctx, *more, u.count));
    for (size_t i = 1; i < u.count; i++) {
        BRIO_TRY(move_vertices(&u, t->tet[u.class_of[i]].vertex, u.shift[i], (*more)[i - 1]));
        BRIO_TRY(brio_look(ctx, 1));
    }
    *num_more = u.count - 1;
done:
    free_lists(&u);
    return status;
}

brio_status brio_periodic_unfold(brio_context *ctx, const brio_periodic *t, const uint8_t *wanted, brio_images *images,
                                 brio_unfolded *out) {
    brio_status status = BRIO_OK;
    unfolding u = {.ctx = ctx, .t = t, .images = images, .wanted = wanted, .count = 1};
    u.num_finite = t->stats.tetrahedra;
    u.num_classes = t->stats.tetrahedra + t->stats.hull_facets;
    *out = (brio_unfolded){0};
    BRIO_TRY(list_all(&u));
    BRIO_TRY(place_more(&u, &out->num_finite, &out->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->tet, out->count + 1));
    BRIO_TRY(fill(&u, out->tet));
done:
    free_lists(&u);
    if (status != BRIO_OK) {
        brio_release(ctx, out->tet);
        *out = (brio_unfolded){0};
    }
    return status;
}
