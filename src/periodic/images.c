/* Translates of points, and their hash table: see images.h. The table is made when an image is first looked for: the
 * first images of a large set are appended in one go, and few are looked for. */
#include "periodic/images.h"
#include "base/memory.h"
#include "base/rng.h"
#include <assert.h>
#include <string.h>

/* Makes room for `count` images. */
static brio_status reserve(brio_images *m, size_t count, bool weighted) {
    BRIO_FORWARD(BRIO_RESIZE(m->ctx, m->list, count));
    BRIO_FORWARD(BRIO_RESIZE(m->ctx, m->x, count));
    if (weighted) BRIO_FORWARD(BRIO_RESIZE(m->ctx, m->weight, count));
    m->capacity = count;
    return BRIO_OK;
}

brio_status brio_images_new(brio_context *ctx, const brio_lattice *lattice, const double (*home)[3],
                            const double *weights, size_t n, brio_images *m) {
    *m = (brio_images){.ctx = ctx, .lattice = lattice, .num_points = n};
    BRIO_FORWARD(reserve(m, n + 1, weights != NULL));
    for (size_t p = 0; p < n; p++) m->list[p] = (brio_image){.point = (uint32_t)p};
    if (n) memcpy(m->x, home, n * sizeof *m->x);
    if (n && weights) memcpy(m->weight, weights, n * sizeof *weights);
    m->count = n;
    return BRIO_OK;
}

void brio_images_free(brio_images *m) {
    if (!m->ctx) return;
    brio_release(m->ctx, m->list);
    brio_release(m->ctx, m->x);
    brio_release(m->ctx, m->weight);
    brio_release(m->ctx, m->slot);
    *m = (brio_images){0};
}

brio_status brio_images_extend(brio_images *m, size_t more) {
    size_t count = m->count + more;
    BRIO_EXPECT(m->ctx, count <= BRIO_INFINITE - 16, BRIO_ERR_TOO_LARGE,
                "the points and the translates about them are 2^32 - 17 or more");
    if (count > m->capacity) BRIO_FORWARD(reserve(m, count + count / 8 + 16, m->weight != NULL));
    m->count = count;
    return BRIO_OK;
}

void brio_images_set(brio_images *m, size_t i, uint32_t point, const int32_t shift[3]) {
    assert(point < m->num_points && i >= m->num_points && i < m->count);
    m->list[i] = (brio_image){point, {shift[0], shift[1], shift[2]}};
    brio_lattice_move(m->lattice, m->x[point], shift, m->x[i]);
    if (m->weight) m->weight[i] = m->weight[point];
}

brio_status brio_images_add(brio_images *m, uint32_t point, const int32_t shift[3]) {
    BRIO_FORWARD(brio_images_extend(m, 1));
    brio_images_set(m, m->count - 1, point, shift);
    return BRIO_OK;
}

/* --- the table --- */

static bool is_image(const brio_image *i, uint32_t point, const int32_t *shift) {
    return i->point == point && i->shift[0] == shift[0] && i->shift[1] == shift[1] && i->shift[2] == shift[2];
}

static size_t place_of(const brio_images *m, uint32_t point, const int32_t *shift) {
    uint64_t low = (uint64_t)point << 32 | (uint32_t)shift[0],
             high = (uint64_t)(uint32_t)shift[1] << 32 | (uint32_t)shift[2];
    size_t at = brio_mix(brio_mix(low) + high) & (m->num_slots - 1);
    while (m->slot[at] && !is_image(&m->list[m->slot[at] - 1], point, shift)) at = (at + 1) & (m->num_slots - 1);
    return at;
}

/* Enters the images that are not in the table yet, and makes it larger where it must be. */
static brio_status enter_all(brio_images *m) {
    size_t behind = m->count - m->num_points;
    if (2 * (behind + 1) > m->num_slots) {
        size_t size = 64;
        while (size < 4 * (behind + 1)) size *= 2;
        brio_release(m->ctx, m->slot);
        m->num_slots = m->num_entered = 0;
        BRIO_FORWARD(BRIO_ALLOC_ZERO(m->ctx, m->slot, size));
        m->num_slots = size;
    }
    for (; m->num_entered < behind; m->num_entered++) {
        const brio_image *i = &m->list[m->num_points + m->num_entered];
        m->slot[place_of(m, i->point, i->shift)] = (uint32_t)(m->num_points + m->num_entered) + 1;
    }
    return BRIO_OK;
}

brio_status brio_images_find(brio_images *m, uint32_t point, const int32_t shift[3], uint32_t *index) {
    *index = point;
    if (!shift[0] && !shift[1] && !shift[2]) return BRIO_OK;
    BRIO_FORWARD(enter_all(m));
    size_t at = place_of(m, point, shift);
    if (!m->slot[at]) {
        BRIO_FORWARD(brio_images_add(m, point, shift));
        m->slot[at] = (uint32_t)m->count;
        m->num_entered++;
    }
    *index = m->slot[at] - 1;
    return BRIO_OK;
}

brio_status brio_images_copy(brio_context *ctx, const brio_images *from, const brio_lattice *lattice, brio_images *to) {
    BRIO_FORWARD(brio_images_new(ctx, lattice, (const double(*)[3])from->x, from->weight, from->num_points, to));
    for (size_t i = from->num_points; i < from->count; i++)
        BRIO_FORWARD(brio_images_add(to, from->list[i].point, from->list[i].shift));
    return BRIO_OK;
}
