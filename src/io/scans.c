/* Finds the scans among the points of a file that is written, see scans.h. */
#include "io/scans.h"
#include "base/memory.h"
#include <math.h>
#include <string.h>

/* MOST: scans of a file. Where places change more often the scanner moved, and each point has its own place: they stay
 * properties. Chosen. */
enum { MOST = 4096 };

static const char *const PLACES[] = {"x_origin", "y_origin", "z_origin"};

/* What the properties say of a point. */
typedef struct {
    const brio_property *place[3], *number, *column, *row;
} sources;

static sources sources_of(const brio_mesh *m) {
    sources from = {.number = brio_mesh_property(m, "scan"),
                    .column = brio_mesh_property(m, "column_index"),
                    .row = brio_mesh_property(m, "row_index")};
    for (int k = 0; k < 3; k++) from.place[k] = brio_mesh_property(m, PLACES[k]);
    if (!from.place[0] || !from.place[1] || !from.place[2]) from.place[0] = NULL;
    return from;
}

static bool is_same(double a, double b) {
    return a == b || (isnan(a) && isnan(b));
}

static brio_status add_scan(brio_context *ctx, brio_scans *s, const double place[3]) {
    brio_scan new = {.grid = true};
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->list, s->capacity, s->count + 1));
    bool known = isfinite(place[0]) && isfinite(place[1]) && isfinite(place[2]);
    for (int k = 0; k < 3 && known; k++) new.place[k] = place[k];
    s->list[s->count++] = new;
    return BRIO_OK;
}

/* Notes the place of a point in the grid of its scan. */
static void note_cell(brio_scan *scan, double column, double row) {
    bool whole = column >= 0 && row >= 0 && column < UINT32_MAX && row < UINT32_MAX && column == floor(column) &&
                 row == floor(row);
    uint64_t cell = whole ? (uint64_t)column << 32 | (uint64_t)row : 0;
    scan->grid &= whole && cell >= scan->next;
    if (!scan->grid) return;
    scan->next = cell + 1;
    if ((uint64_t)column >= scan->columns) scan->columns = (uint64_t)column + 1;
    if ((uint64_t)row >= scan->rows) scan->rows = (uint64_t)row + 1;
}

/* Takes note of a block. */
static brio_status see(brio_context *ctx, brio_scans *s, const brio_mesh *block) {
    const sources from = sources_of(block);
    if (!s->points) s->split = s->numbered = true;
    s->has_number = from.number != NULL;
    for (size_t v = 0; v < block->num_vertices; v++, s->points++) {
        double place[3] = {0, 0, 0}, number = from.number ? brio_property_value(from.number, v) : 0;
        for (int k = 0; k < 3 && from.place[0]; k++) place[k] = brio_property_value(from.place[k], v);
        bool other = !s->points || !is_same(number, s->number);
        for (int k = 0; k < 3; k++) other |= !is_same(place[k], s->last[k]);
        s->split &= !other || s->count < MOST;
        if (other && s->split) BRIO_FORWARD(add_scan(ctx, s, place));
        brio_scan *scan = &s->list[s->count - 1];
        s->numbered &= number == (double)(s->count - 1);
        s->number = number;
        memcpy(s->last, place, sizeof place);
        scan->points++;
        if (from.column && from.row)
            note_cell(scan, brio_property_value(from.column, v), brio_property_value(from.row, v));
        else
            scan->grid = false;
    }
    return BRIO_OK;
}

brio_status brio_scans_survey(brio_context *ctx, const brio_write_job *job, void *state) {
    return see(ctx, state, job->mesh);
}

/* Makes a file one of several. A reader numbers the scans of each from 0 on, and those of a tile may be the third and
 * the fifth of all: then its points are one scan, and keep their places and numbers as properties. */
brio_status brio_scans_share(brio_context *ctx, void *state, const void *from, size_t columns) {
    (void)ctx, (void)from, (void)columns;
    ((brio_scans *)state)->is_part = true;
    return BRIO_OK;
}

uint64_t brio_scans_points(const void *state) {
    return ((const brio_scans *)state)->points;
}

bool brio_scans_round(const void *state) {
    return ((const brio_scans *)state)->rounds;
}

double brio_scans_moved(const void *state, const brio_mesh *block) {
    (void)block;
    return ((const brio_scans *)state)->moved;
}

brio_status brio_scans_settle(brio_context *ctx, brio_scans *s) {
    if (s->is_part && s->has_number && s->count > 1) s->split &= s->numbered;
    if (!s->points || !s->split) {
        s->count = 0;
        BRIO_FORWARD(add_scan(ctx, s, (const double[]){0, 0, 0}));
        s->list[0].points = s->points;
        s->list[0].grid = false;
    }
    s->numbered &= s->split && s->count > 1; /* a reader does not number one scan */
    return BRIO_OK;
}

void brio_scans_free(brio_context *ctx, brio_scans *s) {
    brio_release(ctx, s->list);
    s->list = NULL;
}

bool brio_scans_hold(const brio_scans *s, const brio_mesh *m, size_t i) {
    const sources from = sources_of(m);
    const brio_property *p = &m->properties[i];
    if (p == from.number) return s->numbered;
    return s->split && from.place[0] && (p == from.place[0] || p == from.place[1] || p == from.place[2]);
}

bool brio_scans_next(brio_scans *s, const brio_mesh *block, brio_scan_part *part) {
    if (part->end == block->num_vertices || s->current == s->count) return false;
    const brio_scan *scan = &s->list[s->current];
    uint64_t left = scan->points - s->done, here = block->num_vertices - part->end;
    size_t count = (size_t)(left < here ? left : here);
    *part = (brio_scan_part){.scan = scan, .first = part->end, .end = part->end + count, .begins = !s->done};
    s->done += count;
    part->ends = s->done == scan->points;
    if (!part->ends) return true;
    s->current++;
    s->done = 0;
    return true;
}
