/* Finds the smallest cube around many points, with all threads. */
#include "order/cube.h"
#include "base/team.h"
#include <assert.h>

enum { PARTS = 64 };

/* The points, cut into equal parts. Each part has its own cube until the end, so no thread waits for another thread. */
typedef struct {
    const double *points;
    const uint64_t *items;
    size_t n, parts;
    brio_cube cube[PARTS];
} finder;

static void add_parts(void *user, size_t begin, size_t end, int thread) {
    finder *f = user;
    (void)thread;
    for (size_t part = begin; part < end; part++) {
        brio_cube own = f->cube[part];
        size_t to = brio_part(f->n, (int)part + 1, (int)f->parts);
        for (size_t i = brio_part(f->n, (int)part, (int)f->parts); i < to; i++)
            brio_cube_add(&own, f->points + 3 * (f->items ? (size_t)(uint32_t)f->items[i] : i));
        f->cube[part] = own;
    }
}

brio_status brio_cube_of(brio_context *ctx, const double *points, const uint64_t *items, size_t n, int threads,
                         brio_cube *out) {
    finder f; /* no initializer, because it would set all PARTS cubes: most calls have few points and one part */
    f.points = points, f.items = items, f.n = n;
    assert(n > 0 && threads >= 1);
    f.parts = threads > 1 ? PARTS : 1;
    brio_cube_new(&f.cube[0], points + 3 * (items ? (size_t)(uint32_t)items[0] : 0));
    for (size_t part = 1; part < f.parts; part++) f.cube[part] = f.cube[0];
    brio_status status = brio_for_chunks(ctx, threads, f.parts, 1, add_parts, &f);
    for (size_t part = 1; part < f.parts; part++) brio_cube_join(&f.cube[0], &f.cube[part]);
    *out = f.cube[0];
    return status;
}
