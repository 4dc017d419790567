/* Calls of the library: contexts with their locks, and what happens while a call runs.
 *
 * Making a context costs more than triangulating ten points, since it reads how much memory the machine has; so contexts
 * are kept. There are as many as calls ever ran at a time. A context that another process was using when this one was
 * forked stays busy here, and is never used again.
 *
 * The library calls back often. Every LOOK seconds the module takes the interpreter's lock, looks for signals, and calls
 * the user's function. */
#include "native.h"
#include "system.h"
#include <string.h>

static const double LOOK = 0.02;

/* --- contexts --- */

static int is_idle(const pooled_context *context, int empty) {
    return !context->busy && !context->reserved && !(empty && brio_context_memory(context->ctx));
}

static pooled_context *take_idle(module_state *state, int empty) {
    PyThread_acquire_lock(state->lock, WAIT_LOCK);
    pooled_context *context = state->contexts;
    while (context && !is_idle(context, empty)) context = context->next;
    if (context) context->busy = 1;
    PyThread_release_lock(state->lock);
    return context;
}

/* Makes a context that is busy. */
static pooled_context *context_new(module_state *state) {
    pooled_context *context = calloc(1, sizeof *context);
    if (!context || brio_context_new(NULL, &context->ctx) != BRIO_OK) {
        free(context);
        PyErr_NoMemory();
        return NULL;
    }
    context->busy = 1;
    PyThread_acquire_lock(state->lock, WAIT_LOCK);
    context->next = state->contexts;
    state->contexts = context;
    PyThread_release_lock(state->lock);
    return context;
}

pooled_context *context_take(module_state *state, int empty) {
    pooled_context *context = take_idle(state, empty);
    return context ? context : context_new(state);
}

/* Takes a reserved context, once what is being freed in it is freed. */
static void context_enter(module_state *state, pooled_context *context) {
    for (int taken = 0; !taken;) {
        PyThread_acquire_lock(state->lock, WAIT_LOCK);
        taken = !context->busy;
        context->busy = 1;
        PyThread_release_lock(state->lock);
        if (!taken) PyEval_RestoreThread(PyEval_SaveThread());
    }
}

static void record_free(record *r) {
    r->release(r->object);
    free(r);
}

/* Takes what is pending; if nothing is, the context becomes idle. */
static record *take_pending(module_state *state, pooled_context *context) {
    PyThread_acquire_lock(state->lock, WAIT_LOCK);
    record *pending = context->pending;
    context->pending = NULL;
    if (!pending) context->busy = 0;
    PyThread_release_lock(state->lock);
    return pending;
}

void context_give(module_state *state, pooled_context *context) {
    for (record *r; (r = take_pending(state, context));)
        while (r) {
            record *next = r->next;
            record_free(r);
            r = next;
        }
}

void contexts_free(module_state *state) {
    while (state->contexts) {
        pooled_context *context = state->contexts;
        state->contexts = context->next;
        if (!context->busy) brio_context_free(context->ctx);
        free(context);
    }
}

/* --- calls --- */

static int call_user(call *c, const char *stage, double fraction) {
    if (c->progress == Py_None) return 0;
    PyObject *result = PyObject_CallFunction(c->progress, "sd", stage, fraction);
    int stop = result ? PyObject_IsTrue(result) : -1;
    Py_XDECREF(result);
    return stop;
}

/* What the library calls back: looks for signals now and then, and calls the user's function. Returns whether to stop. */
static int look(const char *stage, double fraction, void *user) {
    call *c = user;
    double now = seconds_now();
    if (now - c->looked < LOOK) return 0;
    c->looked = now;
    PyEval_RestoreThread(c->thread);
    int stop = PyErr_CheckSignals() || call_user(c, stage, fraction);
    c->thread = PyEval_SaveThread();
    return stop;
}

/* Reads progress, or a tuple of progress and limits. Returns 0 or -1 with an exception set. */
static int read_limits(call *c, PyObject *progress) {
    PyObject *folder = Py_None;
    Py_ssize_t most = 0;
    c->progress = progress;
    if (PyTuple_Check(progress) && !PyArg_ParseTuple(progress, "OOn", &c->progress, &folder, &most)) return -1;
    if (folder != Py_None && !(c->scratch = PyBytes_AsString(folder))) return -1;
    c->max_memory = (size_t)most;
    if (c->progress == Py_None || PyCallable_Check(c->progress)) return 0;
    PyErr_SetString(PyExc_TypeError, "progress must be a function of the stage and of the share that is done");
    return -1;
}

/* Sets what a context has for one call. Returns 0; or -1 with an exception set, and the call has ended. */
static int prepare(call *c, int threads) {
    c->ctx = c->context->ctx;
    brio_context_set_threads(c->ctx, threads);
    brio_context_set_progress(c->ctx, look, c);
    if (c->max_memory) brio_context_set_memory_limit(c->ctx, c->max_memory);
    brio_status status = c->scratch ? brio_context_set_scratch(c->ctx, c->scratch) : BRIO_OK;
    return status == BRIO_OK ? 0 : call_end(c, status);
}

/* Reads how a call is to be made. Returns 0 or -1 with an exception set. */
static int read_call(call *c, module_state *state, int threads, PyObject *progress) {
    *c = (call){.state = state, .looked = seconds_now()};
    if (read_limits(c, progress)) return -1;
    if (threads >= 0) return 0;
    return raise_argument(state, PyUnicode_FromFormat("threads: 0 or more are wanted, not %d", threads));
}

int call_begin(call *c, module_state *state, int threads, PyObject *progress) {
    if (read_call(c, state, threads, progress)) return -1;
    if (!(c->context = context_take(state, c->max_memory != 0))) return -1;
    return prepare(c, threads);
}

int call_begin_reserving(call *c, module_state *state, int threads, PyObject *progress) {
    if (read_call(c, state, threads, progress)) return -1;
    if (!(c->context = context_take(state, 1))) return -1;
    if (prepare(c, threads)) return -1;
    c->context->reserved = 1;
    return 0;
}

int call_begin_reserved(call *c, module_state *state, pooled_context *reserved, int threads, PyObject *progress) {
    if (read_call(c, state, threads, progress)) return -1;
    context_enter(state, reserved);
    c->context = reserved;
    return prepare(c, threads);
}

int call_begin_in(call *c, module_state *state, brio_context *own, int threads, PyObject *progress) {
    if (call_begin(c, state, threads, progress)) return -1;
    brio_context_set_progress(c->ctx, NULL, NULL);
    c->ctx = own;
    brio_context_set_threads(own, threads);
    brio_context_set_progress(own, look, c);
    return 0;
}

/* Sets the exception of a failure and a sentence, whose reference it takes; NULL leaves the exception that is set. */
static void raise(module_state *state, const brio_failure *f, PyObject *sentence) {
    PyObject *points = PyList_New(0), *error = NULL;
    for (size_t i = 0; points && i < f->num_points && i < sizeof f->points / sizeof *f->points; i++) {
        PyObject *point = PyLong_FromSize_t(f->points[i]);
        if (!point || PyList_Append(points, point)) Py_CLEAR(points);
        Py_XDECREF(point);
    }
    if (sentence && points)
        error = PyObject_CallFunction(state->make_error, "iOOs", (int)f->status, sentence, points,
                                      brio_reason_name(f->reason));
    Py_XDECREF(points);
    Py_XDECREF(sentence);
    if (!error) return;
    PyErr_SetObject((PyObject *)Py_TYPE(error), error);
    Py_DECREF(error);
}

/* The sentence of a failed call. It may have the bytes of a path, which need not be UTF-8: these are shown as \\xff. */
static PyObject *sentence_of(const call *c) {
    const char *text = brio_message(c->ctx);
    return PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "backslashreplace");
}

int raise_argument(module_state *state, PyObject *sentence) {
    raise(state, &(brio_failure){.status = BRIO_ERR_ARGUMENT}, sentence);
    return -1;
}

int call_end(call *c, brio_status status) {
    int failed = status != BRIO_OK || PyErr_Occurred();
    brio_failure failure = {.size = sizeof failure};
    if (failed && !PyErr_Occurred()) {
        (void)brio_last_failure(c->ctx, &failure);
        failure.status = status;
        raise(c->state, &failure, sentence_of(c));
    }
    brio_context_set_progress(c->ctx, NULL, NULL);
    if (c->max_memory) brio_context_set_memory_limit(c->context->ctx, 0);
    if (c->scratch) (void)brio_context_set_scratch(c->context->ctx, NULL);
    context_give(c->state, c->context);
    return failed ? -1 : 0;
}

/* --- handles --- */

PyObject *call_end_with(call *c, brio_status status, kind what, void *object, void (*release)(void *), PyObject *base) {
    record *r = object ? malloc(sizeof *r) : NULL;
    if (object && !r) {
        release(object);
        PyErr_NoMemory();
        object = NULL;
    }
    if (r) *r = (record){object, release, c->context, NULL};
    module_state *state = c->state;
    pooled_context *context = c->context;
    handle *h = r && status == BRIO_OK && !PyErr_Occurred() ? PyObject_New(handle, state->handle_type) : NULL;
    if (h) {
        h->kind = what;
        h->record = r;
        h->base = base;
        Py_XINCREF(base);
    } else if (r) {
        PyThread_acquire_lock(state->lock, WAIT_LOCK);
        r->next = context->pending;
        context->pending = r;
        PyThread_release_lock(state->lock);
    }
    if (call_end(c, status)) Py_CLEAR(h);
    return (PyObject *)h;
}

/* Frees the record now if its context is idle, else leaves it to the call that uses the context. */
static void drop(module_state *state, record *r) {
    pooled_context *context = r->context;
    PyThread_acquire_lock(state->lock, WAIT_LOCK);
    int idle = !context->busy;
    context->busy = 1;
    r->next = context->pending;
    context->pending = r;
    PyThread_release_lock(state->lock);
    if (idle) context_give(state, context);
}

static void handle_dealloc(PyObject *self) {
    handle *h = (handle *)self;
    PyTypeObject *type = Py_TYPE(self);
    module_state *state = PyType_GetModuleState(type);
    if (state && h->record) drop(state, h->record);
    Py_XDECREF(h->base);
    PyObject_Free(self);
    Py_DECREF(type);
}

void *handle_object(module_state *state, PyObject *object, kind wanted) {
    if (Py_TYPE(object) == state->handle_type && ((handle *)object)->kind == wanted)
        return ((handle *)object)->record->object;
    PyErr_SetString(PyExc_TypeError, "not an object of the library, or of another kind");
    return NULL;
}

int handle_has_points(module_state *state, PyObject *object, const input *points, const input *weights) {
    const handle *h = (const handle *)object;
    if (!h) return raise_argument(state, PyUnicode_FromString("the object has no triangulation of points"));
    const void *t = h->record->object;
    uint64_t own =
        h->kind == KIND_TRIANGULATION2 ? brio_triangulation2_points_hash(t) : brio_triangulation_points_hash(t);
    if (own == brio_points_hash(points->data, weights->data, points->rows, (int)points->columns)) return 0;
    return raise_argument(state,
                          PyUnicode_FromString("the points are not those of the triangulation: they were changed "
                                               "since"));
}

static PyType_Slot handle_slots[] = {
    {Py_tp_dealloc, handle_dealloc},
    {Py_tp_doc, "An object of the library; brio._native has the functions that use it."},
    {0, NULL},
};
PyType_Spec handle_spec = {"brio._native.Handle", sizeof(handle), 0,
                           Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, handle_slots};
