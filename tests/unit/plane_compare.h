/* A triangulation of the plane compared with brute force, in all that it says. */
#ifndef BRIO_TESTS_PLANE_COMPARE_H
#define BRIO_TESTS_PLANE_COMPARE_H

#include "harness.h"
#include "plane_brute.h"
#include "points.h"

static inline int compare_triples(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* The finite triangles, each turned so that its least vertex is first, sorted. */
static inline size_t triples_of(const brio_triangulation2 *t, uint32_t (*out)[3]) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    size_t n = brio_triangulation2_stats(t)->triangles;
    for (size_t i = 0; i < n; i++) {
        const uint32_t *v = triangle[i].vertex;
        int first = v[0] < v[1] ? (v[0] < v[2] ? 0 : 2) : (v[1] < v[2] ? 1 : 2);
        for (int k = 0; k < 3; k++) out[i][k] = v[(first + k) % 3];
    }
    qsort(out, n, sizeof *out, compare_triples);
    return n;
}

static inline void compare_with_brute(const plane_set *s, uint64_t trial) {
    double points[2 * BRUTE_MOST], weights[BRUTE_MOST];
    plane_answer answer;
    static uint32_t found[4 * BRUTE_MOST][3];
    brio_context *ctx = new_context();
    brio_triangulation2 *t = NULL;
    for (size_t i = 0; i < s->n; i++) {
        points[2 * i] = (double)s->p[i].x, points[2 * i + 1] = (double)s->p[i].y;
        weights[i] = (double)s->p[i].w;
    }
    plane_brute(s, &answer);
    const double *w = s->weighted ? weights : NULL;
    EXPECT(brio_delaunay2(ctx, points, w, s->n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    const brio_delaunay2_stats *stats = brio_triangulation2_stats(t);
    EXPECT(stats->dimension == answer.dimension && stats->vertices == answer.vertices &&
               stats->hidden == answer.hidden && stats->duplicates == s->n - answer.vertices - answer.hidden,
           "trial %llu", (unsigned long long)trial);
    EXPECT(triples_of(t, found) == answer.count, "trial %llu", (unsigned long long)trial);
    EXPECT(memcmp(found, answer.triple, answer.count * sizeof *found) == 0, "trial %llu", (unsigned long long)trial);
    for (size_t i = 0; i < s->n; i++)
        EXPECT(brio_triangulation2_representatives(t)[i] == answer.representative[i],
               "trial %llu, point %zu: %u, not %u", (unsigned long long)trial, i,
               brio_triangulation2_representatives(t)[i], answer.representative[i]);
    EXPECT(brio_triangulation2_check(ctx, t, points, w, s->n) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation2_free(t);
    brio_context_free(ctx);
}

#endif
