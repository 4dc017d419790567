/* Triangles at the seams between pieces of a surface.
 *
 * A triangle with samples of several pieces is accepted if all of these pieces have found it. Then all triangles at a
 * sample are triangles of the one piece that the sample belongs to, whatever the pieces disagree on. This piece is a
 * manifold, so no edge has more than two triangles, and their orientations agree. Only the fan round a sample can be
 * incomplete; there the longest part is kept.
 *
 * Based on: Dey, Giesen, Hudson. Delaunay based shape reconstruction from large data. PVG 2001, for the matching. */
#include "reconstruct/cocone/seams.h"
#include "base/memory.h"
#include "base/sort.h"
#include "predicates/predicates.h"
#include <string.h>

brio_status brio_triangles_add(brio_context *ctx, brio_triangles *list, const uint32_t corner[3]) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(ctx, list->corner, list->capacity, list->count + 1));
    memcpy(list->corner[list->count++], corner, sizeof *list->corner);
done:
    return status;
}

/* --- matching --- */

/* Rotates the corners of a triangle so that the least comes first. */
static void turn(uint32_t corner[3]) {
    for (int n = 0; n < 2 && (corner[0] > corner[1] || corner[0] > corner[2]); n++) {
        uint32_t first = corner[0];
        corner[0] = corner[1], corner[1] = corner[2], corner[2] = first;
    }
}

static int compare_triangles(uint32_t a, uint32_t b, const void *user) {
    const uint32_t(*corner)[3] = user;
    for (int k = 0; k < 3; k++)
        if (corner[a][k] != corner[b][k]) return corner[a][k] < corner[b][k] ? -1 : 1;
    return 0;
}

static size_t pieces_of(const uint32_t *piece_of, const uint32_t corner[3]) {
    uint32_t a = piece_of[corner[0]], b = piece_of[corner[1]], c = piece_of[corner[2]];
    return 1 + (b != a) + (c != a && c != b);
}

brio_status brio_match_seams(brio_context *ctx, const uint32_t *piece_of, brio_triangles *seam, brio_triangles *faces,
                             uint8_t *frayed, size_t *unmatched) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    *unmatched = 0;
    BRIO_REQUIRE(ctx, seam->count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu triangles at seams, 2^32 is the limit",
                 seam->count);
    BRIO_TRY(BRIO_ALLOC(ctx, order, seam->count));
    for (size_t i = 0; i < seam->count; i++) {
        turn(seam->corner[i]);
        order[i] = (uint32_t)i;
    }
    brio_sort_indices(order, seam->count, compare_triangles, seam->corner);
    for (size_t begin = 0, end; begin < seam->count; begin = end) {
        const uint32_t *corner = seam->corner[order[begin]];
        for (end = begin + 1; end < seam->count && !compare_triangles(order[begin], order[end], seam->corner);) end++;
        if (end - begin == pieces_of(piece_of, corner)) {
            BRIO_TRY(brio_triangles_add(ctx, faces, corner));
            continue;
        }
        ++*unmatched;
        for (int k = 0; k < 3; k++) frayed[corner[k]] = 1;
    }
done:
    brio_release(ctx, order);
    return status;
}

/* --- fans --- */

/* A face at a frayed sample: its corners after and before the sample. */
typedef struct {
    uint32_t sample, after, before, face;
} spoke;

typedef struct {
    brio_context *ctx;
    const double *points;
    brio_triangles *faces;
    spoke *spokes; /* sorted by sample, then by the corner after it */
    size_t num_spokes, capacity;
    uint8_t *frayed;
    bool *dropped; /* #faces */
} trimming;

static int compare_spokes(uint32_t a, uint32_t b, const void *user) {
    const spoke *s = user;
    if (s[a].sample != s[b].sample) return s[a].sample < s[b].sample ? -1 : 1;
    return s[a].after < s[b].after ? -1 : s[a].after > s[b].after;
}

static brio_status collect_spokes(trimming *t) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    spoke *sorted = NULL;
    t->num_spokes = 0;
    for (size_t f = 0; f < t->faces->count; f++)
        for (int k = 0; k < 3 && !t->dropped[f]; k++) {
            const uint32_t *v = t->faces->corner[f];
            if (!t->frayed[v[k]]) continue;
            BRIO_TRY(BRIO_RESERVE(t->ctx, t->spokes, t->capacity, t->num_spokes + 1));
            t->spokes[t->num_spokes++] = (spoke){v[k], v[(k + 1) % 3], v[(k + 2) % 3], (uint32_t)f};
        }
    BRIO_TRY(BRIO_ALLOC(t->ctx, order, t->num_spokes));
    BRIO_TRY(BRIO_ALLOC(t->ctx, sorted, t->num_spokes));
    for (size_t i = 0; i < t->num_spokes; i++) order[i] = (uint32_t)i;
    if (t->num_spokes > 0) brio_sort_indices(order, t->num_spokes, compare_spokes, t->spokes);
    for (size_t i = 0; i < t->num_spokes; i++) sorted[i] = t->spokes[order[i]];
    if (t->num_spokes > 0) memcpy(t->spokes, sorted, t->num_spokes * sizeof *sorted);
done:
    brio_release(t->ctx, order);
    brio_release(t->ctx, sorted);
    return status;
}

/* Returns the spoke among [begin, end) that has `corner` after the sample, or `end`. */
static size_t spoke_after(const trimming *t, size_t begin, size_t end, uint32_t corner) {
    size_t low = begin, high = end;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (t->spokes[middle].after < corner)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && t->spokes[low].after == corner ? low : end;
}

/* Finds the longest fan of a sample. Returns the spoke that the fan begins with, or `end` if no fan has a beginning.
 * Among equal lengths, the position of the first corner decides. */
static size_t longest_fan(const trimming *t, size_t begin, size_t end, const bool *follows, size_t *length) {
    size_t best = end;
    *length = 0;
    for (size_t i = begin; i < end; i++) {
        size_t count = 0;
        if (follows[i - begin]) continue;
        for (size_t j = i; j < end; j = spoke_after(t, begin, end, t->spokes[j].before)) count++;
        const double *at = t->points + 3 * (size_t)t->spokes[i].after;
        bool tie = count == *length && best < end;
        if (count > *length || (tie && brio_lexicographic(at, t->points + 3 * (size_t)t->spokes[best].after) > 0))
            best = i, *length = count;
    }
    return best;
}

/* Removes all fans of a sample except the longest.   [begin, end)  the spokes of the sample.   changed  set to true if
 * a face was removed. */
static brio_status trim(trimming *t, size_t begin, size_t end, bool *changed) {
    brio_status status = BRIO_OK;
    bool *follows = NULL, *kept = NULL; /* one for each spoke */
    size_t length;
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, follows, end - begin));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, kept, end - begin));
    for (size_t i = begin; i < end; i++) {
        size_t next = spoke_after(t, begin, end, t->spokes[i].before);
        if (next < end) follows[next - begin] = true;
    }
    size_t best = longest_fan(t, begin, end, follows, &length);
    if (best == end || length == end - begin) goto done; /* a closed fan, or a single open one */
    for (size_t j = best; j < end; j = spoke_after(t, begin, end, t->spokes[j].before)) kept[j - begin] = true;
    for (size_t i = begin; i < end; i++) {
        if (kept[i - begin]) continue;
        t->dropped[t->spokes[i].face] = true;
        t->frayed[t->spokes[i].after] = t->frayed[t->spokes[i].before] = 1;
        *changed = true;
    }
done:
    brio_release(t->ctx, follows);
    brio_release(t->ctx, kept);
    return status;
}

/* Works in rounds. A round tests the faces that the round before left, so the result does not depend on the order. */
brio_status brio_trim_fans(brio_context *ctx, const double *points, size_t num_points, uint8_t *frayed,
                           brio_triangles *faces) {
    brio_status status = BRIO_OK;
    trimming t = {.ctx = ctx, .points = points, .faces = faces, .frayed = frayed};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t.dropped, faces->count));
    for (bool changed = true; changed;) {
        changed = false;
        BRIO_TRY(collect_spokes(&t));
        memset(frayed, 0, num_points);
        for (size_t begin = 0, end; begin < t.num_spokes; begin = end) {
            for (end = begin + 1; end < t.num_spokes && t.spokes[end].sample == t.spokes[begin].sample;) end++;
            BRIO_TRY(trim(&t, begin, end, &changed));
        }
    }
    size_t left = 0;
    for (size_t f = 0; f < faces->count; f++)
        if (!t.dropped[f]) memmove(faces->corner[left++], faces->corner[f], sizeof *faces->corner);
    faces->count = left;
done:
    brio_release(ctx, t.spokes);
    brio_release(ctx, t.dropped);
    return status;
}
