/* Vertices that have moved go back until their faces cross no others.
 *
 * A vertex has taken all of its way, half, a quarter, or nothing of it. Of the faces with a vertex that moved, all that
 * cross others are found exactly, and the vertices of both take the next smaller share. Then again, since a face may
 * cross others because of a vertex that went back. Of two faces that cross and did not cross before, some vertex has
 * not gone back all its way, so that the rounds end: a vertex takes part in three at most. What still crosses after a
 * round crosses a face of a vertex that has just gone back. Shares are of the way that the vertex took at first, so
 * that rounds do not add up errors. */
#include "mesh/back_off.h"
#include "base/memory.h"
#include "mesh/crossing_faces.h"
#include "mesh/edge_rings.h"
#include <string.h>

/* The shares of the way, the first one before anything goes back. Chosen. */
static const double SHARE[] = {1, 0.5, 0.25, 0};
enum { LAST = sizeof SHARE / sizeof *SHARE - 1 };

/* Gives the vertices of the faces that cross others the next share, and marks those that change. Returns whether one
 * does. */
static bool step_back(const brio_mesh *mesh, const uint8_t *crosses, uint8_t *step, uint8_t *now) {
    bool changed = false;
    memset(now, 0, mesh->num_vertices);
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (uint64_t h = mesh->face_offsets[f]; crosses[f] && h < mesh->face_offsets[f + 1]; h++)
            now[mesh->face_vertices[h]] = 1;
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        now[v] = now[v] && step[v] != LAST;
        step[v] = (uint8_t)(step[v] + now[v]);
        changed |= now[v];
    }
    return changed;
}

/* Marks the vertices that are elsewhere than before. */
static void mark_moved(const brio_mesh *mesh, const double *before, uint8_t *now) {
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        const double *a = before + 3 * v, *b = mesh->vertices + 3 * v;
        now[v] = a[0] != b[0] || a[1] != b[1] || a[2] != b[2];
    }
}

/* Marks the faces with a vertex that has changed. */
static void mark_changed(const brio_mesh *mesh, const uint8_t *now, uint8_t *changed) {
    for (size_t f = 0; f < mesh->num_faces; f++) {
        changed[f] = 0;
        for (uint64_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++)
            changed[f] |= now[mesh->face_vertices[h]];
    }
}

static void place(const brio_mesh *mesh, const double *before, const double *after, const uint8_t *step) {
    for (size_t v = 0; v < mesh->num_vertices; v++)
        for (size_t k = 3 * v; k < 3 * v + 3 && step[v]; k++)
            mesh->vertices[k] = step[v] == LAST ? before[k] : before[k] + SHARE[step[v]] * (after[k] - before[k]);
}

brio_status brio_back_off(brio_context *ctx, brio_mesh *mesh, const double *before, size_t *moved) {
    brio_status status = BRIO_OK;
    size_t n = mesh->num_vertices, count = 0;
    double *after = NULL;
    uint8_t *crosses = NULL, *changed = NULL, *step = NULL, *now = NULL;
    const brio_bar bar = brio_progress_bar(ctx);
    brio_face_groups groups = {.ctx = ctx};
    int64_t pairs;
    double from = 0.5;
    BRIO_TRY(BRIO_ALLOC(ctx, crosses, mesh->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, changed, mesh->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, now, n));
    mark_moved(mesh, before, now);
    mark_changed(mesh, now, changed);
    brio_progress_part(ctx, bar, 0, from);
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(brio_face_groups_new(ctx, mesh, &groups));
    BRIO_TRY(brio_search_crossings(&groups, changed, crosses, &pairs));
    if (pairs) {
        BRIO_TRY(BRIO_ALLOC(ctx, after, 3 * n));
        BRIO_TRY(BRIO_ALLOC_ZERO(ctx, step, n));
        memcpy(after, mesh->vertices, 3 * n * sizeof *after);
        while (pairs && step_back(mesh, crosses, step, now)) {
            place(mesh, before, after, step);
            mark_changed(mesh, now, changed);
            brio_progress_part(ctx, bar, from, (1 + from) / 2);
            from = (1 + from) / 2;
            BRIO_TRY(brio_face_groups_fit(&groups));
            BRIO_TRY(brio_search_crossings(&groups, changed, crosses, &pairs));
        }
        for (size_t v = 0; v < n; v++) count += step[v] > 0;
    }
    if (moved) *moved = count;
done:
    brio_progress_part(ctx, bar, 0, 1);
    brio_face_groups_free(&groups);
    brio_release(ctx, after);
    brio_release(ctx, crosses);
    brio_release(ctx, changed);
    brio_release(ctx, step);
    brio_release(ctx, now);
    return status;
}
