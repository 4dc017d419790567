/* Pieces of an opened surface that are too small to be more than a guess.
 *
 * The triangles that stay between holes are sheets of the surface, and crumbs: shards of membranes that happened to be
 * narrow, and tents over stray samples. Pieces are compared by their triangles, not by their area: a few strays far
 * away span more area than the surface. A scene has many objects, and a small one is no crumb. So a piece goes if it
 * has
 *   - fewer triangles than SPECK for each doubling of their number in all, and under a hundredth of those of the
 *     largest piece: so are the specks judged that the labels make; or
 *   - under FEW of those of the largest piece, and it is as rough as samples in space are and a surface is not: on
 *     average across its edges, half of 1 less the cosine between the normals is over ROUGH. */
#include "reconstruct/open_surface/small_pieces.h"
#include "base/memory.h"
#include "base/vector.h"

/* Chosen. */
enum { SPECK = 2 };
static const double CRUMB = 0.01, FEW = 0.05, ROUGH = 0.15, BEND_UNIT = 0x1p30;

typedef struct {
    size_t begin, end; /* of the list of triangles */
    bool has_rim;
} piece;

typedef struct {
    const brio_triangle_net *net;
    uint8_t *part, *listed; /* #F */
    uint32_t *list;         /* #F: triangles that stay, one piece after another */
    size_t size;
    piece *pieces;
    size_t count, capacity;
} sieve;

/* Returns half of 1 less the cosine between the normals of two triangles. */
static double bend_between(const brio_triangle_net *n, size_t f, size_t g) {
    double a[3], b[3];
    brio_net_normal(n, f, a);
    brio_net_normal(n, g, b);
    return 0.5 - 0.5 * brio_dot(a, b);
}

static piece list_piece(sieve *s, uint32_t face) {
    const brio_triangle_net *n = s->net;
    piece p = {.begin = s->size};
    s->list[s->size++] = face;
    s->listed[face] = 1;
    for (size_t i = p.begin; i < s->size; i++) {
        uint32_t f = s->list[i];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t twin = n->twin[3 * f + k], other = twin / 3;
            if (twin == BRIO_NO_HALF_EDGE || s->part[other] == BRIO_TRIANGLE_GONE) {
                p.has_rim = true;
                continue;
            }
            if (s->listed[other]) continue;
            s->listed[other] = 1;
            s->list[s->size++] = other;
        }
    }
    p.end = s->size;
    return p;
}

static brio_status list_pieces(sieve *s) {
    brio_status status = BRIO_OK;
    for (uint32_t f = 0; f < s->net->num_faces; f++) {
        if (s->part[f] == BRIO_TRIANGLE_GONE || s->listed[f]) continue;
        BRIO_TRY(BRIO_RESERVE(s->net->ctx, s->pieces, s->capacity, s->count + 1));
        s->pieces[s->count++] = list_piece(s, f);
    }
done:
    return status;
}

/* Returns whether a piece is rough. */
static bool is_rough(const sieve *s, const piece *p) {
    const brio_triangle_net *n = s->net;
    int64_t bend = 0, edges = 0; /* bend: in whole numbers, so that the order does not matter */
    for (size_t i = p->begin; i < p->end; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t f = s->list[i], twin = n->twin[3 * f + k];
            if (twin == BRIO_NO_HALF_EDGE || s->part[twin / 3] == BRIO_TRIANGLE_GONE) continue;
            bend += (int64_t)(BEND_UNIT * bend_between(n, f, twin / 3)), edges++;
        }
    return edges <= 0 || (double)bend > BEND_UNIT * ROUGH * (double)edges;
}

static bool is_crumb(const sieve *s, const piece *p, size_t largest, size_t least) {
    double size = (double)(p->end - p->begin), share = size / (double)largest;
    if (!p->has_rim) return false;
    return (size < (double)least && share < CRUMB) || (share < FEW && is_rough(s, p));
}

brio_status brio_drop_small_pieces(const brio_triangle_net *n, uint8_t *part) {
    brio_status status = BRIO_OK;
    sieve s = {.net = n, .part = part};
    size_t largest = 0, least = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(n->ctx, s.listed, n->num_faces));
    BRIO_TRY(BRIO_ALLOC(n->ctx, s.list, n->num_faces));
    BRIO_TRY(list_pieces(&s));
    for (size_t i = 0; i < s.count; i++)
        if (s.pieces[i].end - s.pieces[i].begin > largest) largest = s.pieces[i].end - s.pieces[i].begin;
    for (size_t all = s.size; all > 1; all /= 2) least += SPECK;
    for (size_t i = 0; i < s.count; i++)
        if (is_crumb(&s, &s.pieces[i], largest, least))
            for (size_t k = s.pieces[i].begin; k < s.pieces[i].end; k++) part[s.list[k]] = BRIO_TRIANGLE_GONE;
done:
    brio_release(n->ctx, s.listed);
    brio_release(n->ctx, s.list);
    brio_release(n->ctx, s.pieces);
    return status;
}
