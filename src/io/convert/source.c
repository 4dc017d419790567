/* The points of a conversion, see source.h.
 *
 * A file of points that can be read again is read anew in every pass, so that it is never in memory; each block is
 * filtered where it lies. Any other file is in memory after the first pass, filtered once. A text whose later rows lack
 * a column is read again without the column. */
#include "io/convert/source.h"
#include "base/memory.h"
#include "io/filter.h"
#include <inttypes.h>
#include <string.h>

typedef struct {
    brio_source *source;
    const brio_sink *sink;
    uint64_t boxed; /* points in the box so far */
    uint8_t *stays;
    size_t capacity;
} pass;

bool brio_source_rereadable(const char *path) {
    brio_place_facts facts;
    return strcmp(path, "-") != 0 && brio_find_facts(path, &facts) && facts.kind == BRIO_IS_FILE;
}

brio_status brio_source_changed(const brio_source *s) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: the file changed while it was read", s->path);
}

/* Returns whether the file is the one that the first pass found: another one may have other properties and more
 * points. */
static bool is_unchanged(brio_source *s) {
    brio_place_facts facts, *first = &s->facts;
    if (!brio_source_rereadable(s->path) || !brio_find_facts(s->path, &facts)) return true; /* reading it tells */
    if (!s->has_facts) *first = facts;
    s->has_facts = true;
    return brio_is_same_file(&facts, first) && facts.size == first->size && facts.seconds == first->seconds &&
           facts.nanoseconds == first->nanoseconds;
}

/* Finds which points of a block stay. */
static brio_status find_stays(pass *p, const brio_mesh *block) {
    brio_source *s = p->source;
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, p->stays, p->capacity, block->num_vertices + 1));
    if (s->options->crop)
        brio_find_in_box(block, s->options->box, p->stays);
    else
        memset(p->stays, 1, block->num_vertices);
    for (size_t v = 0; v < block->num_vertices; v++) {
        if (!p->stays[v]) continue;
        if (s->chosen && p->boxed == s->num_boxed) return brio_source_changed(s);
        if (s->chosen) p->stays[v] = s->chosen[p->boxed];
        p->boxed++;
    }
    return BRIO_OK;
}

/* Filters a block in place: the reader does not look at its rows again. */
static brio_status take_block(void *user, const brio_mesh *block) {
    pass *p = user;
    brio_source *s = p->source;
    brio_mesh rest = *block;
    s->points_read += block->num_vertices;
    if (s->options->crop || s->chosen) {
        BRIO_FORWARD(find_stays(p, block));
        BRIO_FORWARD(brio_filter_mesh(s->ctx, &rest, p->stays));
    }
    return p->sink->take(p->sink->user, &rest);
}

static brio_status read_pass(pass *p) {
    brio_source *s = p->source;
    const brio_sink sink = {take_block, p};
    s->job.sink = s->whole ? NULL : &sink;
    s->points_read = 0;
    s->passes++;
    if (!is_unchanged(s)) return brio_source_changed(s);
    brio_status status = brio_read_file(s->ctx, &s->job);
    if (status == BRIO_OK && !s->job.mesh && !is_unchanged(s)) return brio_source_changed(s);
    if (status == BRIO_OK && !s->job.mesh && s->chosen && p->boxed != s->num_boxed) return brio_source_changed(s);
    return status;
}

/* Goes through the points that were read before. */
static brio_status rows_pass(pass *p) {
    brio_source *s = p->source;
    const brio_sink sink = {take_block, p};
    uint64_t read = s->points_read;
    brio_status status = brio_rows_pass(s->rows, s->first, s->num_rows, &sink);
    s->points_read = read;
    return status;
}

/* Filters the file in memory. */
static brio_status filter_whole(pass *p) {
    brio_source *s = p->source;
    s->points_read = s->job.mesh->num_vertices;
    if (!s->options->crop) return BRIO_OK;
    BRIO_FORWARD(find_stays(p, s->job.mesh));
    return brio_filter_mesh(s->ctx, s->job.mesh, p->stays);
}

brio_status brio_source_pass(brio_source *s, const brio_sink *sink) {
    brio_status status = BRIO_OK;
    pass p = {.source = s, .sink = sink};
    if (s->rows) {
        status = rows_pass(&p);
        goto done;
    }
    if (!s->job.mesh) {
        BRIO_TRY(read_pass(&p));
        if (s->job.mesh) BRIO_TRY(filter_whole(&p));
    }
    if (s->job.mesh) BRIO_TRY(sink->take(sink->user, s->job.mesh));
done:
    brio_release(s->ctx, p.stays);
    return status;
}

/* --- choosing --- */

typedef struct {
    brio_context *ctx;
    double *points;
    size_t count, capacity;
} collection;

static brio_status collect(void *user, const brio_mesh *block) {
    collection *c = user;
    size_t need = c->count + block->num_vertices;
    if (need > c->capacity) {
        size_t capacity = c->capacity + c->capacity / 8;
        if (capacity < need) capacity = need;
        BRIO_FORWARD(BRIO_RESIZE(c->ctx, c->points, 3 * capacity));
        c->capacity = capacity;
    }
    if (!block->num_vertices) return BRIO_OK; /* then there may be no arrays */
    memcpy(c->points + 3 * c->count, block->vertices, 3 * block->num_vertices * sizeof *c->points);
    c->count = need;
    return BRIO_OK;
}

/* Packs the points whose flag is `kept`. */
static size_t pack(double *points, size_t count, const uint8_t *flags, uint8_t kept) {
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (flags[i] == kept) memmove(points + 3 * n++, points + 3 * i, 3 * sizeof *points);
    return n;
}

static brio_status drop_outliers(brio_source *s, collection *c) {
    size_t all = c->count;
    BRIO_FORWARD(brio_outliers(s->ctx, c->points, all, s->options->drop_outliers, s->options->outliers, s->chosen));
    c->count = pack(c->points, all, s->chosen, 0);
    s->outliers = all - c->count;
    for (size_t i = 0; i < all; i++) s->chosen[i] = !s->chosen[i];
    return BRIO_OK;
}

/* Thins the points that are chosen. */
static brio_status thin(brio_source *s, collection *c) {
    brio_status status = BRIO_OK;
    uint8_t *kept = NULL;
    size_t num_kept;
    BRIO_TRY(BRIO_ALLOC(s->ctx, kept, c->count));
    BRIO_TRY(brio_thin(s->ctx, c->points, c->count, s->options->thin, kept, &num_kept));
    for (size_t i = 0, j = 0; j < c->count; i++)
        if (s->chosen[i]) s->chosen[i] = kept[j++];
    s->thinned = c->count - num_kept;
done:
    brio_release(s->ctx, kept);
    return status;
}

/* Removes the points that are not chosen from the file in memory. */
static brio_status apply_choice(brio_source *s) {
    if (!s->job.mesh) return BRIO_OK;
    const brio_mesh *m = s->job.mesh;
    size_t cells = m->num_faces + m->num_tetrahedra + m->num_edges;
    brio_status status = brio_filter_mesh(s->ctx, s->job.mesh, s->chosen);
    s->torn = m->num_faces + m->num_tetrahedra + m->num_edges < cells;
    brio_release(s->ctx, s->chosen);
    s->chosen = NULL;
    return status;
}

brio_status brio_source_choose(brio_source *s) {
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(s->ctx);
    collection c = {.ctx = s->ctx};
    const brio_sink sink = {collect, &c};
    uint8_t *chosen = NULL;
    brio_progress_part(s->ctx, bar, 0, 0.3);
    BRIO_TRY(brio_source_pass(s, &sink));
    BRIO_TRY(BRIO_ALLOC(s->ctx, chosen, c.count + 1));
    memset(chosen, 1, c.count);
    s->chosen = chosen;
    s->num_boxed = c.count;
    brio_progress_part(s->ctx, bar, 0.3, 0.7);
    if (s->options->drop_outliers) BRIO_TRY(drop_outliers(s, &c));
    brio_progress_part(s->ctx, bar, 0.7, 1);
    if (s->options->thin > 0) BRIO_TRY(thin(s, &c));
    BRIO_TRY(apply_choice(s));
done:
    brio_progress_part(s->ctx, bar, 0, 1);
    brio_release(s->ctx, c.points);
    return status;
}

void brio_source_free(brio_source *s) {
    brio_read_job_free(s->ctx, &s->job);
    brio_mesh_free(s->job.mesh);
    brio_release(s->ctx, s->chosen);
}
