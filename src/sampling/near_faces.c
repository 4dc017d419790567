/* The faces of a mesh that some balls may meet: the boxes of the balls stand in a tree, which each face asks. The tree
 * is one of faces (mesh/face_groups.c), so each ball takes the shape of a triangle with the ball's box. */
#include "sampling/near_faces.h"
#include "base/memory.h"
#include "base/team.h"
#include "mesh/face_groups.h"
#include <string.h>

enum { FACES_A_THREAD = 1 << 12 };

typedef struct {
    const brio_mesh *mesh;
    brio_face_groups balls;
    uint8_t *near; /* #F */
} search;

static void ask(void *user, size_t begin, size_t end, int thread) {
    const search *s = user;
    double low[3], high[3];
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        brio_face_bounds(s->mesh, f, low, high);
        bool has_area = s->mesh->face_offsets[f + 1] - s->mesh->face_offsets[f] > 2;
        s->near[f] = has_area && brio_groups_meet(&s->balls, low, high);
    }
}

/* Makes a mesh of triangles from the lowest to the highest corner of the box of each ball. */
static brio_status draw_boxes(brio_context *ctx, const brio_ball *ball, size_t num_balls, brio_mesh *out) {
    brio_status status = BRIO_OK;
    *out = (brio_mesh){.context = ctx, .num_vertices = 2 * num_balls, .num_faces = num_balls};
    BRIO_TRY(BRIO_ALLOC(ctx, out->vertices, 6 * num_balls));
    BRIO_TRY(BRIO_ALLOC(ctx, out->face_offsets, num_balls + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->face_vertices, 3 * num_balls));
    for (size_t i = 0; i <= num_balls; i++) out->face_offsets[i] = 3 * i;
    for (size_t i = 0; i < num_balls; i++) {
        for (size_t k = 0; k < 3; k++) {
            out->vertices[6 * i + k] = ball[i].centre[k] - ball[i].radius;
            out->vertices[6 * i + 3 + k] = ball[i].centre[k] + ball[i].radius;
            out->face_vertices[3 * i + k] = (uint32_t)(2 * i + (k == 1));
        }
    }
done:
    return status;
}

static brio_status copy_near(brio_context *ctx, const search *s, brio_mesh *out) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = s->mesh;
    size_t faces = 0, corners = 0;
    for (size_t f = 0; f < m->num_faces; f++)
        if (s->near[f]) faces++, corners += (size_t)(m->face_offsets[f + 1] - m->face_offsets[f]);
    BRIO_TRY(BRIO_ALLOC(ctx, out->face_offsets, faces + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->face_vertices, corners));
    out->face_offsets[0] = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        if (!s->near[f]) continue;
        size_t from = (size_t)m->face_offsets[f], count = (size_t)m->face_offsets[f + 1] - from;
        uint64_t at = out->face_offsets[out->num_faces++];
        if (count) memcpy(out->face_vertices + at, m->face_vertices + from, count * sizeof *out->face_vertices);
        out->face_offsets[out->num_faces] = at + count;
    }
done:
    return status;
}

brio_status brio_near_faces(brio_context *ctx, const brio_mesh *mesh, const brio_ball *ball, size_t num_balls,
                            brio_mesh *out) {
    brio_status status = BRIO_OK;
    brio_mesh boxes = {0};
    search s = {.mesh = mesh, .balls.ctx = ctx};
    *out = (brio_mesh){
        .size = sizeof *out, .context = ctx, .num_vertices = mesh->num_vertices, .vertices = mesh->vertices};
    BRIO_TRY(draw_boxes(ctx, ball, num_balls, &boxes));
    BRIO_TRY(brio_face_groups_new(ctx, &boxes, &s.balls));
    BRIO_TRY(BRIO_ALLOC(ctx, s.near, mesh->num_faces));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, mesh->num_faces, FACES_A_THREAD), mesh->num_faces, ask, &s));
    BRIO_TRY(copy_near(ctx, &s, out));
done:
    brio_face_groups_free(&s.balls);
    brio_release(ctx, boxes.vertices);
    brio_release(ctx, boxes.face_offsets);
    brio_release(ctx, boxes.face_vertices);
    brio_release(ctx, s.near);
    return status;
}
