/* Triangulations in tiles. Each has a context that is reserved for it; one call at a time uses it. Parts belong to that
 * context, too, and keep the triangulation's handle, so that they are freed first. What a callback shows is a copy.
 *
 * The files are those of the process that made them. A child of a fork has a copy of all this and must leave them
 * alone: it makes no calls, and what it frees is left as it is. */
#include "native.h"
#include "system.h"
#include <string.h>

typedef struct {
    pooled_context *context;
    brio_tiles *t; /* NULL: closed */
    long process;
    int busy; /* a call uses it; atomic */
} tiled;

typedef struct {
    brio_context *ctx;
    brio_tile_part part;
    uint32_t tile;
} held_part;

/* Frees the triangulation with its files, and gives the context to all. */
static void free_tiled(void *object) {
    tiled *d = object;
    if (d->process == process_now()) brio_tiles_free(d->t);
    d->context->reserved = 0;
    free(d);
}

static void free_part(void *object) {
    held_part *p = object;
    brio_tile_part_free(p->ctx, &p->part);
    free(p);
}

static void leave(tiled *d) {
    __atomic_store_n(&d->busy, 0, __ATOMIC_RELEASE);
}

static tiled *refuse(tiled *d, module_state *state, const char *why) {
    leave(d);
    raise_argument(state, PyUnicode_FromString(why));
    return NULL;
}

/* Returns the object for a call that it alone has until `leave`, or NULL with an exception set. */
static tiled *enter(module_state *state, PyObject *object) {
    tiled *d = handle_object(state, object, KIND_TILES);
    if (!d) return NULL;
    if (__atomic_exchange_n(&d->busy, 1, __ATOMIC_ACQUIRE)) {
        PyErr_SetString(PyExc_RuntimeError, "another call of this triangulation is not at its end");
        return NULL;
    }
    return d->t ? d : refuse(d, state, "the tiles are closed");
}

/* Begins a call of the object, which ends with `end`. Returns the object, or NULL with an exception set. */
static tiled *begin(call *c, module_state *state, PyObject *object, int threads, PyObject *progress) {
    tiled *d = enter(state, object);
    if (d && d->process != process_now()) return refuse(d, state, "the tiles are of the process that forked this one");
    if (d && call_begin_reserved(c, state, d->context, threads, progress)) {
        leave(d);
        return NULL;
    }
    return d;
}

static int end(call *c, tiled *d, brio_status status) {
    int failed = call_end(c, status);
    leave(d);
    return failed;
}

/* --- life --- */

/* tiles_new(scratch, tiles, stars, key, threads, progress) */
static PyObject *tiles_new(PyObject *module, PyObject *args) {
    brio_tiles_options o = {.size = sizeof o};
    unsigned long long key;
    int threads;
    PyObject *progress;
    call c;
    brio_status status = BRIO_ERR_NO_MEMORY;
    if (!PyArg_ParseTuple(args, "yIiKiO", &o.scratch, &o.tiles, &o.stars, &key, &threads, &progress)) return NULL;
    tiled *d = calloc(1, sizeof *d);
    if (!d) return PyErr_NoMemory();
    o.key = key;
    if (call_begin_reserving(&c, state_of(module), threads, progress)) {
        free(d);
        return NULL;
    }
    *d = (tiled){.context = c.context, .process = process_now()};
    CALL(c, status, brio_tiles_new(c.ctx, &o, &d->t));
    if (status == BRIO_OK) return call_end_with(&c, status, KIND_TILES, d, free_tiled, NULL);
    free_tiled(d);
    call_end(&c, status);
    return NULL;
}

/* tiles_close(object): removes the files. What was closed stays closed. */
static PyObject *tiles_close(PyObject *module, PyObject *object) {
    call c;
    tiled *d = handle_object(state_of(module), object, KIND_TILES);
    if (!d) return NULL;
    if (!d->t || d->process != process_now()) Py_RETURN_NONE;
    d = begin(&c, state_of(module), object, 0, Py_None);
    if (!d) return NULL;
    brio_status status;
    CALL(c, status, (brio_tiles_free(d->t), BRIO_OK));
    d->t = NULL;
    if (end(&c, d, status)) return NULL;
    Py_RETURN_NONE;
}

/* --- points --- */

/* tiles_add(object, points, weights, threads, progress) */
static PyObject *tiles_add(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *progress;
    int threads, failed = -1;
    input p, w = {.held = 0};
    call c;
    tiled *d = NULL;
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &weights, &threads, &progress)) return NULL;
    if (input_open(&p, points, "points", 'd', 3)) return NULL;
    if (!input_open_weights(&w, weights, p.rows)) d = begin(&c, state_of(module), object, threads, progress);
    if (d) {
        brio_status status;
        CALL(c, status, brio_tiles_add(c.ctx, d->t, p.data, w.data, p.rows));
        failed = end(&c, d, status);
    }
    input_close(&w);
    input_close(&p);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

/* A file's points on their way. */
typedef struct {
    brio_context *ctx;
    brio_tiles *t;
    const char *weights; /* the property that has them, or NULL */
    brio_status status;
    int missing; /* the file has no such property */
} intake;

static brio_status add_block(intake *in, const brio_mesh *block) {
    const brio_property *property = in->weights ? brio_mesh_property(block, in->weights) : NULL;
    size_t n = block->num_vertices;
    double *weights = property ? malloc((n + 1) * sizeof *weights) : NULL;
    in->missing = in->weights && !property;
    if (in->missing) return BRIO_ERR_ARGUMENT;
    if (property && !weights) return BRIO_ERR_NO_MEMORY;
    for (size_t i = 0; property && i < n; i++) weights[i] = brio_property_value(property, i);
    brio_status status = brio_tiles_add(in->ctx, in->t, block->vertices, weights, n);
    free(weights);
    return status;
}

static int take_block(const brio_mesh *block, void *user) {
    intake *in = user;
    in->status = add_block(in, block);
    return in->status != BRIO_OK;
}

static brio_status read_into(intake *in, const char *path, const brio_read_options *options) {
    brio_status status = brio_read_blocks(in->ctx, path, options, take_block, in, NULL);
    return in->status != BRIO_OK ? in->status : status;
}

/* tiles_read(object, path, options of reading, weights or None, threads, progress) */
static PyObject *tiles_read(PyObject *module, PyObject *args) {
    PyObject *object, *options, *progress;
    const char *path;
    brio_read_options o = {0};
    intake in = {.status = BRIO_OK};
    int threads;
    call c;
    if (!PyArg_ParseTuple(args, "OyOziO", &object, &path, &options, &in.weights, &threads, &progress)) return NULL;
    if (read_reading_options(state_of(module), options, &o)) return NULL;
    tiled *d = begin(&c, state_of(module), object, threads, progress);
    if (!d) return NULL;
    in.ctx = c.ctx, in.t = d->t;
    brio_status status;
    CALL(c, status, read_into(&in, path, &o));
    if (in.missing)
        raise_argument(c.state, PyUnicode_FromFormat("weights: the points have no property '%s'", in.weights));
    if (end(&c, d, status)) return NULL;
    Py_RETURN_NONE;
}

/* --- the work, and what is known of it --- */

/* tiles_run(object, threads, progress) */
static PyObject *tiles_run(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    int threads;
    call c;
    if (!PyArg_ParseTuple(args, "OiO", &object, &threads, &progress)) return NULL;
    tiled *d = begin(&c, state_of(module), object, threads, progress);
    if (!d) return NULL;
    brio_status status;
    CALL(c, status, brio_tiles_run(c.ctx, d->t));
    if (end(&c, d, status)) return NULL;
    Py_RETURN_NONE;
}

/* tiles_facts(object): a dict. */
static PyObject *tiles_facts(PyObject *module, PyObject *object) {
    tiled *d = enter(state_of(module), object);
    if (!d) return NULL;
    const brio_tiles_stats *s = brio_tiles_facts(d->t);
#define COUNT(name) #name, (unsigned long long)s->name
    PyObject *facts = Py_BuildValue(
        "{s:N,s:K,s:K,s:K,s:K,s:i,s:K,s:K,s:N,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:d,s:d,s:d,s:(ddd),s:(ddd)}",
        "has_points", PyBool_FromLong(brio_tiles_has_points(d->t)), COUNT(points), COUNT(vertices), COUNT(duplicates),
        COUNT(hidden), "dimension", s->dimension, "simplices", (unsigned long long)s->tetrahedra, "hull",
        (unsigned long long)s->hull_facets, "weighted", PyBool_FromLong(s->weighted), COUNT(tiles), COUNT(resumed),
        COUNT(asked), COUNT(found), COUNT(sampled), COUNT(read), COUNT(triangulated), COUNT(most_rounds),
        COUNT(most_points), "most_simplices", (unsigned long long)s->most_tetrahedra, COUNT(scratch_bytes),
        "divide_seconds", s->divide_seconds, "triangulate_seconds", s->triangulate_seconds, "rank_seconds",
        s->rank_seconds, "low", s->low[0], s->low[1], s->low[2], "high", s->high[0], s->high[1], s->high[2]);
#undef COUNT
    leave(d);
    return facts;
}

/* tiles_checksum(object, threads, progress) */
static PyObject *tiles_checksum(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    int threads;
    call c;
    uint64_t sum = 0;
    if (!PyArg_ParseTuple(args, "OiO", &object, &threads, &progress)) return NULL;
    tiled *d = begin(&c, state_of(module), object, threads, progress);
    if (!d) return NULL;
    brio_status status;
    CALL(c, status, brio_tiles_checksum(c.ctx, d->t, &sum));
    return end(&c, d, status) ? NULL : PyLong_FromUnsignedLongLong(sum);
}

/* --- parts --- */

/* Views of points, weights or None, indices and tetrahedra, which keep the handle, whose reference is taken. */
static PyObject *part_views(module_state *state, PyObject *owner, const brio_tile_part *p) {
    PyObject *weights = Py_None;
    if (p->weights)
        weights = array_new(state, owner, layout_of(p->weights, 'd', p->num_vertices, 0));
    else
        Py_INCREF(weights);
    return Py_BuildValue("NNNNN", owner, array_new(state, owner, layout_of(p->points, 'd', p->num_vertices, 3)),
                         weights, array_new(state, owner, layout_of(p->index, 'L', p->num_vertices, 0)),
                         array_new(state, owner, layout_of(p->tetrahedra, 'I', p->num_tetrahedra, 4)));
}

/* tiles_part(object, tile, threads, progress): a handle, points, weights or None, indices, tetrahedra. */
static PyObject *tiles_part(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    unsigned tile;
    int threads;
    call c;
    if (!PyArg_ParseTuple(args, "OIiO", &object, &tile, &threads, &progress)) return NULL;
    held_part *p = calloc(1, sizeof *p);
    if (!p) return PyErr_NoMemory();
    tiled *d = begin(&c, state_of(module), object, threads, progress);
    if (!d) {
        free(p);
        return NULL;
    }
    brio_status status;
    *p = (held_part){.ctx = c.ctx, .part = {.size = sizeof p->part}, .tile = tile};
    CALL(c, status, brio_tiles_part(c.ctx, d->t, tile, &p->part));
    PyObject *owner = call_end_with(&c, status, KIND_TILE_PART, p, free_part, object);
    leave(d);
    return owner ? part_views(state_of(module), owner, &p->part) : NULL;
}

/* tiles_neighbors(part, out, threads, progress): writes tile and row of four neighbours for each tetrahedron, 2^32 - 1
 * for the tile of none. */
static PyObject *tiles_neighbors(PyObject *module, PyObject *args) {
    PyObject *object, *array, *progress;
    int threads, failed = -1;
    input out;
    call c;
    module_state *state = state_of(module);
    if (!PyArg_ParseTuple(args, "OOiO", &object, &array, &threads, &progress)) return NULL;
    const held_part *p = handle_object(state, object, KIND_TILE_PART);
    if (!p || output_open(&out, array, "out", 'I', 8)) return NULL;
    tiled *d = input_has_rows(&out, "out", p->part.num_tetrahedra)
                   ? NULL
                   : begin(&c, state, ((handle *)object)->base, threads, progress);
    if (d) {
        brio_status status;
        CALL(c, status, brio_tiles_neighbours(c.ctx, d->t, p->tile, &p->part, out.data));
        failed = end(&c, d, status);
    }
    input_close(&out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

/* --- what comes block by block --- */

/* Whom the blocks go to. */
typedef struct {
    call *c;
    PyObject *take;
} taker;

/* Calls the user's function with arguments, whose reference it takes. Returns whether to stop. */
static int hand_over(const taker *to, PyObject *arguments) {
    PyObject *result = arguments ? PyObject_CallObject(to->take, arguments) : NULL;
    Py_XDECREF(arguments);
    Py_XDECREF(result);
    return !result;
}

static int take_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    const taker *to = user;
    PyEval_RestoreThread(to->c->thread);
    module_state *state = to->c->state;
    PyObject *views = cells_views(state, NULL, cells);
    PyObject *sites = views ? array_copy(state, layout_of(site, 'L', cells->num_cells, 0)) : NULL;
    int is_whole = sites && !PyDict_SetItemString(views, "site", sites);
    int stop = hand_over(to, is_whole ? Py_BuildValue("(O)", views) : NULL);
    Py_XDECREF(sites);
    Py_XDECREF(views);
    to->c->thread = PyEval_SaveThread();
    return stop;
}

/* Computes all cells, and copies the facts. */
static brio_status run_cells(taker *to, tiled *d, const brio_cells_options *o, int ordered,
                             brio_tiles_cells_stats *stats) {
    brio_status status = brio_tiles_cells(to->c->ctx, d->t, o, ordered, take_cells, to);
    if (status == BRIO_OK) memcpy(stats, brio_tiles_cells_facts(d->t), sizeof *stats);
    return status;
}

/* tiles_cells(object, take, (ordered, no_areas, no_centroids, no_faces, no_face_sizes, vertices), box or None, threads,
 * progress): calls take(dict of arrays) for some cells at a time; returns a dict. */
static PyObject *tiles_cells(PyObject *module, PyObject *args) {
    PyObject *object, *box, *progress;
    int threads, ordered, failed = -1;
    brio_cells_options o = {.size = sizeof o};
    brio_tiles_cells_stats s = {.size = sizeof s};
    input b = {.held = 0};
    call c;
    tiled *d = NULL;
    taker to = {.c = &c};
    if (!PyArg_ParseTuple(args, "OO(iiiiii)OiO", &object, &to.take, &ordered, &o.no_areas, &o.no_centroids, &o.no_faces,
                          &o.no_face_sizes, &o.vertices, &box, &threads, &progress))
        return NULL;
    if (box == Py_None || (!input_open(&b, box, "box", 'd', 0) && !input_has_rows(&b, "box", 6)))
        d = begin(&c, state_of(module), object, threads, progress);
    if (d) {
        brio_status status;
        o.box = b.data;
        CALL(c, status, run_cells(&to, d, &o, ordered, &s));
        failed = end(&c, d, status);
    }
    input_close(&b);
    if (failed) return NULL;
#define COUNT(name) #name, (unsigned long long)s.name
    return Py_BuildValue("{s:K,s:K,s:K,s:K,s:d,s:d}", COUNT(cells), COUNT(bounded), COUNT(faces), COUNT(outside),
                         "volume_sum", s.volume_sum, "region_volume", s.region_volume);
#undef COUNT
}

static int take_faces(const brio_faces_part *part, uint32_t tile, void *user) {
    const taker *to = user;
    PyEval_RestoreThread(to->c->thread);
    module_state *state = to->c->state;
    PyObject *arguments =
        Py_BuildValue("INNN", (unsigned)tile, array_copy(state, layout_of(part->points, 'd', part->num_vertices, 3)),
                      array_copy(state, layout_of(part->index, 'L', part->num_vertices, 0)),
                      array_copy(state, layout_of(part->faces, 'I', part->num_faces, 3)));
    int stop = hand_over(to, arguments);
    to->c->thread = PyEval_SaveThread();
    return stop;
}

/* tiles_alpha(object, alpha, take or None, threads, progress): calls take(tile, points, indices, faces) for each tile
 * that has faces; returns a dict. */
static PyObject *tiles_alpha(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    double alpha;
    int threads;
    brio_tiles_alpha_stats s = {.size = sizeof s};
    call c;
    taker to = {.c = &c};
    if (!PyArg_ParseTuple(args, "OdOiO", &object, &alpha, &to.take, &threads, &progress)) return NULL;
    tiled *d = begin(&c, state_of(module), object, threads, progress);
    if (!d) return NULL;
    brio_status status;
    CALL(c, status, brio_tiles_alpha(c.ctx, d->t, alpha, to.take == Py_None ? NULL : take_faces, &to, &s));
    if (end(&c, d, status)) return NULL;
#define COUNT(name) #name, (unsigned long long)s.name
    return Py_BuildValue("{s:(KKKK),s:K,s:K,s:K,s:K,s:K,s:K}", "simplices", (unsigned long long)s.counts[0],
                         (unsigned long long)s.counts[1], (unsigned long long)s.counts[2],
                         (unsigned long long)s.counts[3], COUNT(tetrahedra), COUNT(faces), COUNT(uncovered),
                         COUNT(singular_vertices), COUNT(singular_edges), COUNT(singular_facets));
#undef COUNT
}

PyMethodDef tiles_methods[] = {
    {"tiles_new", tiles_new, METH_VARARGS, "tiles_new(scratch, tiles, stars, key, threads, progress)"},
    {"tiles_close", tiles_close, METH_O, "tiles_close(t): removes its files."},
    {"tiles_add", tiles_add, METH_VARARGS, "tiles_add(t, points, weights, threads, progress)"},
    {"tiles_read", tiles_read, METH_VARARGS, "tiles_read(t, path, options of reading, weights, threads, progress)"},
    {"tiles_run", tiles_run, METH_VARARGS, "tiles_run(t, threads, progress)"},
    {"tiles_facts", tiles_facts, METH_O, "tiles_facts(t): a dict."},
    {"tiles_checksum", tiles_checksum, METH_VARARGS, "tiles_checksum(t, threads, progress)"},
    {"tiles_part", tiles_part, METH_VARARGS, "tiles_part(t, tile, threads, progress): a part, and its arrays."},
    {"tiles_neighbors", tiles_neighbors, METH_VARARGS, "tiles_neighbors(part, out, threads, progress)"},
    {"tiles_cells", tiles_cells, METH_VARARGS,
     "tiles_cells(t, take, (ordered, no_areas, no_centroids, no_faces, no_face_sizes, vertices), box, threads, "
     "progress): calls take(dict)."},
    {"tiles_alpha", tiles_alpha, METH_VARARGS,
     "tiles_alpha(t, alpha, take, threads, progress): calls take(tile, points, indices, faces)."},
    {NULL, NULL, 0, NULL},
};
