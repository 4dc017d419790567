/* brio terrain: triangles of points over a map, of some classes, without long edges; and a raster of their heights. */
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include "cli/files/raster.h"
#include "cli/files/read_write.h"
#include "cli/files/cloud.h"
#include "cli/steps/selection.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *classes, *raster;
    double max_edge, cell;
} arguments;

static const option options[] = {
    {"class", 0, OPTION_TEXT, offsetof(arguments, classes), "LIST",
     "only points whose property classification is one of these, such as 2,8", 0},
    {"max-edge", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, max_edge), "D",
     "leave out triangles with a side over D on the map", 0},
    {"raster", 0, OPTION_OUTPUT, offsetof(arguments, raster), "FILE",
     "write the heights of cells: .asc (Esri's ASCII grid) or .tif (GeoTIFF)", 0},
    {"cell", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, cell), "SIZE", "side of a cell of the raster", 0},
    {0},
};

static const arguments defaults = {0};

enum { MOST_CLASSES = 256 };
static const double MOST_CELLS = 4e9, COORDINATES = 16, HEIGHT = 8;

/* A triangulation of the map. */
typedef struct {
    brio_mesh *points;
    double *map, *height; /* #P by 2, #P */
    brio_triangulation2 *t;
    brio_locator2 *locator;
    uint8_t *kept; /* of each triangle */
    size_t num_kept;
    raster grid;
    double *places; /* of the cells of a row */
    uint32_t *triangle;
    size_t empty; /* cells without a height */
} terrain;

/* --- classes --- */

static brio_status read_classes(run *r, const char *text, bool wanted[MOST_CLASSES]) {
    for (const char *at = text; *at;) {
        char *end;
        errno = 0;
        long number = strtol(at, &end, 10);
        if (end == at || errno || number < 0 || number >= MOST_CLASSES || (*end && *end != ',') || (*end && !end[1]))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--class: '%s' is no list of numbers from 0 to 255, such as 2,8",
                            text);
        wanted[number] = true;
        at = *end ? end + 1 : end;
    }
    if (!*text) return cli_fail(r, BRIO_ERR_ARGUMENT, "--class: no number");
    return BRIO_OK;
}

/* Replaces the points by those of the classes that are asked for. */
static brio_status choose_classes(run *r, const char *text, terrain *t) {
    brio_status status = BRIO_OK;
    bool wanted[MOST_CLASSES] = {false};
    size_t n = t->points->num_vertices;
    brio_mesh *some = NULL;
    uint8_t *chosen = NULL;
    TRY(read_classes(r, text, wanted));
    const brio_property *class = brio_mesh_property(t->points, "classification");
    if (!class) {
        cli_hint(r, HINT_PROPERTIES);
        FAIL(r, BRIO_ERR_FORMAT, "%s: the points have no property classification, which --class needs", r->operands[0]);
    }
    chosen = malloc(n + 1);
    if (!chosen) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu points", n);
    for (size_t i = 0; i < n; i++) {
        double x = brio_property_value(class, i);
        chosen[i] = x >= 0 && x < MOST_CLASSES && wanted[(int)x];
    }
    TRY(cli_select_points(r, t->points, chosen, &some));
    cli_fact_count(&r->facts, "other_classes", n - some->num_vertices);
    brio_mesh_free(t->points);
    t->points = some;
done:
    free(chosen);
    return status;
}

/* --- triangles --- */

static brio_status triangulate(run *r, terrain *t) {
    size_t n = t->points->num_vertices;
    brio_delaunay2_options o = {0};
    o.seed = r->common.seed;
    FORWARD(cli_require_work(r, BRIO_OK, t->points,
                             brio_estimate_delaunay2(n, false) + (uint64_t)((COORDINATES + HEIGHT) * (double)n)));
    t->map = malloc((2 * n + 1) * sizeof *t->map);
    t->height = malloc((n + 1) * sizeof *t->height);
    if (!t->map || !t->height) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu points of the map", n);
    for (size_t i = 0; i < n; i++) {
        memcpy(t->map + 2 * i, t->points->vertices + 3 * i, 2 * sizeof *t->map);
        t->height[i] = t->points->vertices[3 * i + 2];
    }
    FORWARD(brio_delaunay2(r->ctx, t->map, NULL, n, &o, &t->t));
    cli_lap(r, "triangulate");
    if (!brio_triangulation2_stats(t->t)->triangles)
        return cli_fail(r, BRIO_ERR_NO_ANSWER, "%s: %zu points on the map make no triangle", r->operands[0], n);
    return BRIO_OK;
}

/* Chooses the triangles without a side over `most`, up to rounding; 0: all. */
static brio_status choose_triangles(run *r, double most, terrain *t) {
    size_t count = brio_triangulation2_stats(t->t)->triangles;
    const brio_triangle *triangle = brio_triangulation2_triangles(t->t);
    double up_to = cli_up_to(most, cli_rounding(t->points));
    t->kept = malloc(count + 1);
    if (!t->kept) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu triangles", count);
    for (size_t i = 0; i < count; i++) {
        double longest = 0;
        for (int k = 0; k < 3; k++) {
            const double *a = t->map + 2 * (size_t)triangle[i].vertex[k];
            const double *b = t->map + 2 * (size_t)triangle[i].vertex[(k + 1) % 3];
            longest = fmax(longest, hypot(a[0] - b[0], a[1] - b[1]));
        }
        t->kept[i] = !(most > 0) || longest <= up_to;
        t->num_kept += t->kept[i];
    }
    if (!t->num_kept) return cli_fail(r, BRIO_ERR_NO_ANSWER, "no triangle is left: all have a side over %g", most);
    return BRIO_OK;
}

static brio_status set_faces(run *r, const terrain *t) {
    size_t count = brio_triangulation2_stats(t->t)->triangles, f = 0;
    const brio_triangle *triangle = brio_triangulation2_triangles(t->t);
    uint64_t *offsets = malloc((t->num_kept + 1) * sizeof *offsets);
    uint32_t *corners = malloc((3 * t->num_kept + 1) * sizeof *corners);
    brio_status status = BRIO_OK;
    if (!offsets || !corners) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu triangles", t->num_kept);
    for (size_t i = 0; i < count; i++)
        if (t->kept[i]) memcpy(corners + 3 * f++, triangle[i].vertex, 3 * sizeof *corners);
    for (size_t i = 0; i <= t->num_kept; i++) offsets[i] = 3 * i;
    TRY(brio_mesh_set_faces(t->points, offsets, corners, t->num_kept));
done:
    free(offsets);
    free(corners);
    return status;
}

/* --- raster --- */

/* Fills a row with the heights at the middles of its cells, linear in each triangle. */
static brio_status fill_row(run *r, void *user, size_t row, double *heights) {
    terrain *t = user;
    const raster *g = &t->grid;
    brio_interpolation how = {0};
    how.method = BRIO_INTERPOLATION_LINEAR;
    how.values = t->height;
    for (size_t i = 0; i < g->columns; i++) {
        t->places[2 * i] = g->west + ((double)i + 0.5) * g->cell;
        t->places[2 * i + 1] = g->south + ((double)(g->rows - row) - 0.5) * g->cell;
    }
    FORWARD(brio_locator2_triangles(r->ctx, t->locator, t->places, g->columns, t->triangle));
    FORWARD(brio_locator2_interpolate(r->ctx, t->locator, t->places, g->columns, &how, heights));
    for (size_t i = 0; i < g->columns; i++) {
        bool none = t->triangle[i] == BRIO_INFINITE || !t->kept[t->triangle[i]];
        if (none) heights[i] = (double)NAN;
        t->empty += none;
    }
    return BRIO_OK;
}

/* Lays a grid whose lines are at multiples of the cell over the points. A point that is beyond a line by rounding alone
 * needs no cell there. */
static brio_status lay_grid(run *r, double cell, terrain *t) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, cells[2];
    double share = cli_up_to(cell, cli_rounding(t->points)) / cell - 1; /* of a cell */
    for (size_t i = 0; i < 2 * t->points->num_vertices; i++) {
        low[i % 2] = fmin(low[i % 2], t->map[i]);
        high[i % 2] = fmax(high[i % 2], t->map[i]);
    }
    for (int k = 0; k < 2; k++) {
        double first = floor(low[k] / cell + share);
        low[k] = first * cell;
        cells[k] = fmax(ceil(high[k] / cell - share) - first, 1);
    }
    if (!(cells[0] * cells[1] <= MOST_CELLS))
        return cli_fail(r, BRIO_ERR_TOO_LARGE, "--cell: %g makes %.0f by %.0f cells, more than %g", cell, cells[0],
                        cells[1], MOST_CELLS);
    t->grid = (raster){(size_t)cells[0], (size_t)cells[1], low[0], low[1], cell, t->points};
    return BRIO_OK;
}

static brio_status make_raster(run *r, const arguments *a, terrain *t) {
    FORWARD(lay_grid(r, a->cell, t));
    t->places = malloc((2 * t->grid.columns + 1) * sizeof *t->places);
    t->triangle = malloc((t->grid.columns + 1) * sizeof *t->triangle);
    if (!t->places || !t->triangle)
        return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu cells", t->grid.columns);
    FORWARD(brio_locator2_new(r->ctx, t->t, t->map, NULL, t->points->num_vertices, &t->locator));
    FORWARD(cli_write_raster(r, a->raster, &t->grid, fill_row, t));
    cli_fact_count(&r->facts, "columns", t->grid.columns);
    cli_fact_count(&r->facts, "rows", t->grid.rows);
    cli_fact_count(&r->facts, "empty_cells", t->empty);
    return BRIO_OK;
}

/* --- the command --- */

static void free_terrain(terrain *t) {
    brio_locator2_free(t->locator);
    brio_triangulation2_free(t->t);
    brio_mesh_free(t->points);
    free(t->map);
    free(t->height);
    free(t->kept);
    free(t->places);
    free(t->triangle);
}

static brio_status run_terrain(run *r) {
    const arguments *a = r->arguments;
    terrain t = {0};
    brio_status status = BRIO_OK;
    if ((a->raster != NULL) != (a->cell > 0)) FAIL(r, BRIO_ERR_ARGUMENT, "--raster FILE and --cell SIZE go together");
    TRY(cli_require_output(r, a->raster != NULL));
    if (a->raster) TRY(cli_check_raster(r, a->raster));
    TRY(cli_read_points(r, r->operands[0], &t.points));
    size_t all = t.points->num_vertices;
    cli_fact_count(&r->facts, "points", all);
    if (a->classes) TRY(choose_classes(r, a->classes, &t));
    TRY(triangulate(r, &t));
    TRY(choose_triangles(r, a->max_edge, &t));
    cli_fact_count(&r->facts, "duplicates", brio_triangulation2_stats(t.t)->duplicates);
    cli_fact_count(&r->facts, "triangles", t.num_kept);
    cli_fact_count(&r->facts, "left_out", brio_triangulation2_stats(t.t)->triangles - t.num_kept);
    if (a->raster) TRY(make_raster(r, a, &t));
    if (!cli_wants_mesh(r)) goto done;
    TRY(set_faces(r, &t));
    TRY(cli_write(r, t.points));
done:
    free_terrain(&t);
    return status;
}

const command cli_terrain = {
    .name = "terrain",
    .operands = "IN",
    .summary = "triangles of points over a map, of some classes; a raster of their heights",
    .description = "The Delaunay triangulation of x and y, over the points in space. Of points at one place of the map "
                   "the first one counts. "
                   "The heights of a raster are those at the middles of its cells, linear in each triangle.",
    .examples = "brio terrain survey.laz --class 2 --max-edge 50 -o ground.ply\nthe ground, without what bridges lakes "
                "and the rim\n"
                "brio terrain survey.laz --class 2,8 --raster ground.tif --cell 1 -o ground.ply\nits heights, a metre "
                "apart, too\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = run_terrain,
};
