/* brio locate: the tetrahedron that holds each point of a file, and the nearest vertex. */
#include "cli/run/commands.h"
#include "cli/steps/located.h"
#include "cli/files/table.h"
#include <stdlib.h>

typedef struct arguments {
    weights_options weights;
    periodic_options periodic;
    const char *at;
    int plane;
} arguments;

static const option options[] = {
    AT_ROW(arguments, at),
    LOCATED_PLANE_ROW(arguments, plane),
    WEIGHTS_ROWS(arguments, weights),
    PERIODIC_ROWS(arguments, periodic),
    {0},
};

static const arguments defaults = {.weights.exponent = NO_EXPONENT, .plane = LOCATED_SPACE};

/* Fills the rows (tetrahedron, vertex); -1 stands for none. Returns how many places are inside. */
static size_t fill_rows(const uint32_t *tetrahedra, const uint32_t *vertices, size_t count, int64_t *rows) {
    size_t inside = 0;
    for (size_t i = 0; i < count; i++) {
        inside += tetrahedra[i] != BRIO_INFINITE;
        rows[2 * i] = tetrahedra[i] == BRIO_INFINITE ? -1 : (int64_t)tetrahedra[i];
        rows[2 * i + 1] = vertices[i] == BRIO_INFINITE ? -1 : (int64_t)vertices[i];
    }
    return inside;
}

static brio_status answer(run *r, const located *l) {
    brio_status status = BRIO_OK;
    size_t count = l->at->num_vertices;
    uint32_t *tetrahedra = malloc((count + 1) * sizeof *tetrahedra), *vertices = malloc((count + 1) * sizeof *vertices);
    int64_t *rows = malloc((2 * count + 1) * sizeof *rows);
    if (!tetrahedra || !vertices || !rows) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu places", count);
    if (l->plane) {
        TRY(brio_locator2_triangles(r->ctx, l->plane, l->places, count, tetrahedra));
        TRY(brio_locator2_least_power(r->ctx, l->plane, l->places, count, vertices));
    } else {
        TRY(brio_locator_tetrahedra(r->ctx, l->locator, l->at->vertices, count, tetrahedra));
        TRY(brio_locator_least_power(r->ctx, l->locator, l->at->vertices, count, vertices));
    }
    cli_lap(r, "locate");
    cli_report_inside(r, fill_rows(tetrahedra, vertices, count, rows), count);
    TRY(cli_write_table(r, &(table){l->plane ? "triangle,vertex" : "tetrahedron,vertex", count, 2, rows, NULL}));
done:
    free(tetrahedra);
    free(vertices);
    free(rows);
    return status;
}

/* Fills the rows (tetrahedron, its shift, vertex, its shift); -1 stands for none. Returns how many are inside. */
static size_t fill_shifts(const brio_image *tetrahedra, const brio_image *vertices, size_t count, int64_t *rows) {
    size_t inside = 0;
    for (size_t i = 0; i < count; i++) {
        const brio_image *parts[2] = {&tetrahedra[i], &vertices[i]};
        inside += tetrahedra[i].point != BRIO_INFINITE;
        for (size_t part = 0; part < 2; part++) {
            int64_t *row = rows + 8 * i + 4 * part;
            row[0] = parts[part]->point == BRIO_INFINITE ? -1 : (int64_t)parts[part]->point;
            for (int k = 0; k < 3; k++) row[1 + k] = parts[part]->shift[k];
        }
    }
    return inside;
}

static brio_status answer_periodic(run *r, const located *l) {
    static const char names[] =
        "tetrahedron,shift_a,shift_b,shift_c,vertex,vertex_shift_a,vertex_shift_b,vertex_shift_c";
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    brio_periodic_locator *locator = NULL;
    size_t count = l->at->num_vertices;
    brio_image *found = malloc((2 * count + 1) * sizeof *found);
    int64_t *rows = malloc((8 * count + 1) * sizeof *rows);
    if (!found || !rows) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu places", count);
    TRY(cli_periodic(r, &a->periodic, l->points, l->weights, &t));
    TRY(brio_periodic_locator_new(r->ctx, t, &locator));
    cli_lap(r, "locator");
    TRY(brio_periodic_locator_tetrahedra(r->ctx, locator, l->at->vertices, count, found));
    TRY(brio_periodic_locator_least_power(r->ctx, locator, l->at->vertices, count, found + count));
    cli_lap(r, "locate");
    cli_fact_count(&r->facts, "tetrahedra", brio_periodic_facts(t)->tetrahedra);
    cli_report_inside(r, fill_shifts(found, found + count, count, rows), count);
    TRY(cli_write_table(r, &(table){names, count, 8, rows, NULL}));
done:
    brio_periodic_locator_free(locator);
    brio_periodic_free(t);
    free(found);
    free(rows);
    return status;
}

static brio_status locate(run *r) {
    const arguments *a = r->arguments;
    located l = {0};
    brio_status status = BRIO_OK;
    TRY(cli_check_weights_options(r, &a->weights));
    TRY(cli_check_periodic(r, &a->periodic));
    if (cli_is_periodic(&a->periodic) && a->plane != LOCATED_SPACE)
        FAIL(r, BRIO_ERR_ARGUMENT, "--plane: not in space that repeats (--cell, --periodic)");
    TRY(cli_require_table(r));
    TRY(cli_read_located(r, a->at, &a->weights, &a->periodic, a->plane, &l));
    if (cli_is_periodic(&a->periodic)) {
        status = answer_periodic(r, &l);
        goto done;
    }
    if (a->plane == LOCATED_SPACE) cli_tell_cell(r, &a->periodic, l.points);
    TRY(cli_make_locator(r, a->plane, true, &l));
    TRY(answer(r, &l));
done:
    cli_located_free(&l);
    return status;
}

const command cli_locate = {
    .name = "locate",
    .operands = "IN",
    .summary = "the tetrahedron that holds each place (-1 outside), and the nearest vertex",
    .examples =
        "brio locate points.ply --at places.xyz -o tetrahedra.csv\na row for each place\n"
        "brio locate stations.csv --at places.csv --plane xy -o triangles.csv\ntriangles of a map\n"
        "brio locate atoms.xyz --at places.xyz --cell 20,20,20 -o tetrahedra.csv\natoms in a box that repeats\n",
    .has_output = true,
    .outputs = ".csv .npy",
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = locate,
};
