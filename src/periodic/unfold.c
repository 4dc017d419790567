/* All tetrahedra with a vertex in the domain, from one of each class.
 *
 * Cells and stars of the points are made of them. A class has as many of them as its vertices have different shifts:
 * each moved back by one. The first is the class itself, whose least vertex is in the domain; the others are
 * appended. */
#include "base/memory.h"
#include "periodic/periodic.h"
#include <assert.h>
#include <string.h>

typedef struct {
    brio_context *ctx;
    const brio_periodic *t;
    brio_images *images;
    size_t num_classes, num_finite;
    uint32_t *more;      /* #classes: where the further ones of a class begin in the lists below; 0 is none */
    uint32_t *class_of;  /* of each further one, from 1 on */
    int32_t (*shift)[3]; /* and how it was moved */
    size_t count, class_capacity, shift_capacity;
    uint32_t *place; /* of each further one: where it is among the tetrahedra */
    uint8_t *inside; /* of each class: whether all its vertices are in the domain */
} unfolding;

static bool same_shift(const int32_t *a, const int32_t *b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Lists the further ones of a class. */
static brio_status list_more(unfolding *u, size_t c) {
    const uint32_t *v = u->t->tet[c].vertex;
    const brio_image *list = u->t->images.list;
    int32_t found[4][3] = {{0}};
    int n = 1;
    for (int k = 0; k < 4; k++) {
        if (v[k] < u->t->images.num_points || v[k] == BRIO_INFINITE) continue;
        int at = 0;
        while (at < n && !same_shift(found[at], list[v[k]].shift)) at++;
        if (at < n) continue;
        memcpy(found[n++], list[v[k]].shift, sizeof *found);
    }
    u->more[c] = n > 1 ? (uint32_t)u->count : 0;
    u->inside[c] = n == 1;
    for (int i = 1; i < n; i++) {
        BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->class_of, u->class_capacity, u->count + 1));
        BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->shift, u->shift_capacity, u->count + 1));
        u->class_of[u->count] = (uint32_t)c;
        for (int k = 0; k < 3; k++) u->shift[u->count][k] = -found[i][k];
        u->count++;
    }
    return BRIO_OK;
}

/* Returns the place of the tetrahedron of a class moved by a shift; UINT32_MAX if it has no vertex in the domain. */
static uint32_t find(const unfolding *u, uint32_t c, const int32_t *shift) {
    static const int32_t none[3] = {0, 0, 0};
    if (same_shift(shift, none)) return c < u->num_finite ? c : u->place[0] + (c - (uint32_t)u->num_finite);
    for (size_t i = u->more[c]; i && i < u->count && u->class_of[i] == c; i++)
        if (same_shift(u->shift[i], shift)) return u->place[i];
    return UINT32_MAX;
}

/* Writes the mates of the tetrahedron at `place`, which is class c moved by a shift. */
static void link(const unfolding *u, brio_tetrahedron *tet, uint32_t place, uint32_t c, const int32_t *shift) {
    const brio_tetrahedron *class = &u->t->tet[c];
    size_t n = u->t->images.num_points;
    for (int i = 0; i < 4; i++) {
        uint32_t mate = class->mate[i], other = mate >> 2;
        int32_t way[3], own = 0;
        if (u->inside[c] && u->inside[other]) { /* nearly all: they meet as they are */
            tet[place].mate[i] =
                4 * (other < u->num_finite ? other : u->place[0] + (other - (uint32_t)u->num_finite)) + (mate & 3);
            continue;
        }
        tet[place].mate[i] = 4 * place + (uint32_t)i;
        for (int k = 0; k < 4; k++) own += k != i && tet[place].vertex[k] < n;
        if (!own) continue;
        brio_periodic_across(&u->t->images, u->t->tet, c, i, way);
        for (int k = 0; k < 3; k++) way[k] += shift[k];
        uint32_t at = find(u, other, way);
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

/* Gives each its place: finite classes, further finite ones, infinite classes, further infinite ones. */
static brio_status place_all(unfolding *u, size_t *finite) {
    size_t next = u->num_finite;
    BRIO_FORWARD(BRIO_ALLOC(u->ctx, u->place, u->count + 1));
    for (size_t i = 1; i < u->count; i++)
        if (u->class_of[i] < u->num_finite) u->place[i] = (uint32_t)next++;
    *finite = next;
    u->place[0] = (uint32_t)next;
    next += u->num_classes - u->num_finite;
    for (size_t i = 1; i < u->count; i++)
        if (u->class_of[i] >= u->num_finite) u->place[i] = (uint32_t)next++;
    BRIO_EXPECT(u->ctx, next < (size_t)1 << 30, BRIO_ERR_TOO_LARGE, "more than 2^30 tetrahedra");
    return BRIO_OK;
}

static brio_status fill(unfolding *u, brio_tetrahedron *tet) {
    static const int32_t none[3] = {0, 0, 0};
    for (size_t c = 0; c < u->num_classes; c++) {
        uint32_t place = find(u, (uint32_t)c, none);
        memcpy(tet[place].vertex, u->t->tet[c].vertex, sizeof tet->vertex);
        link(u, tet, place, (uint32_t)c, none);
        BRIO_FORWARD(brio_look(u->ctx, 1));
    }
    for (size_t i = 1; i < u->count; i++) {
        uint32_t place = u->place[i];
        BRIO_FORWARD(move_vertices(u, u->t->tet[u->class_of[i]].vertex, u->shift[i], tet[place].vertex));
        link(u, tet, place, u->class_of[i], u->shift[i]);
        BRIO_FORWARD(brio_look(u->ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_periodic_unfold(brio_context *ctx, const brio_periodic *t, brio_images *images, brio_unfolded *out) {
    brio_status status = BRIO_OK;
    unfolding u = {.ctx = ctx, .t = t, .images = images, .num_finite = t->stats.tetrahedra, .count = 1};
    u.num_classes = t->stats.tetrahedra + t->stats.hull_facets;
    *out = (brio_unfolded){0};
    BRIO_TRY(BRIO_ALLOC(ctx, u.more, u.num_classes + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, u.inside, u.num_classes + 1));
    for (size_t c = 0; c < u.num_classes; c++) BRIO_TRY(list_more(&u, c));
    BRIO_TRY(place_all(&u, &out->num_finite));
    out->count = u.num_classes + u.count - 1;
    BRIO_TRY(BRIO_ALLOC(ctx, out->tet, out->count + 1));
    BRIO_TRY(fill(&u, out->tet));
done:
    brio_release(ctx, u.more);
    brio_release(ctx, u.inside);
    brio_release(ctx, u.class_of);
    brio_release(ctx, u.shift);
    brio_release(ctx, u.place);
    return status;
}
