/* What the files of the module share: its state, calls of the library, objects of the library, arrays.
 *
 * The module is thin: it checks types and shapes, calls one function of brio.h without the interpreter's lock, and hands
 * out what the library made as views. Everything else is Python, in ../src/brio. It uses the limited API, so that one
 * build serves every CPython from 3.11 on, and the buffer protocol in place of numpy's C API. */
#ifndef BRIO_PYTHON_NATIVE_H
#define BRIO_PYTHON_NATIVE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stdint.h>
#include <stdlib.h>
#include <brio/brio.h>
#include <brio/laboratory.h>

/* --- contexts --- */

typedef struct record record;

/** A context with its lock. A call takes an idle context, or makes one; objects stay with the context that made them.
 *  I1  `busy`, `pending` and `next` change under module_state.lock only. `busy` is the context's lock.
 *  I2  An object is freed by who holds `busy`: by its handle, or, where a call holds it, at the end of that call.
 *  I3  `reserved` changes while `busy` is held. Then no other call takes the context: an object has it for itself. */
typedef struct pooled_context {
    brio_context *ctx;
    int busy, reserved;
    record *pending; /* objects to be freed */
    struct pooled_context *next;
} pooled_context;

typedef struct {
    PyThread_type_lock lock;
    pooled_context *contexts;
    PyTypeObject *handle_type, *array_type;
    PyObject *make_error; /* of status, sentence, points and reason, an exception; None until errors.py has set it */
} module_state;

module_state *state_of(PyObject *module);

/** Takes an idle context.   empty  whether it is to hold no object.   Returns NULL with an exception set. */
pooled_context *context_take(module_state *state, int empty);
/** Gives it back, and frees what became garbage meanwhile. */
void context_give(module_state *state, pooled_context *context);
/** Frees the contexts when the module goes. */
void contexts_free(module_state *state);

/* --- calls of the library --- */

typedef struct {
    module_state *state;
    pooled_context *context;
    brio_context *ctx;
    PyObject *progress;  /* a callable, or None */
    const char *scratch; /* the folder of this call, or NULL */
    size_t max_memory;   /* of this call; 0: no limit but the machine's */
    PyThreadState *thread;
    double looked; /* when it last looked for signals, in seconds */
} call;

/** Begins a call: takes a context, sets its threads and its progress. Returns 0 or -1 with an exception set.
 *  progress  a callable or None; of a call with limits a tuple of that, a folder for scratch files, as bytes, or None,
 *            and the most bytes that the call may hold, or 0. The caller keeps it until the end of the call. */
int call_begin(call *c, module_state *state, int threads, PyObject *progress);
/** Begins a call in a context without objects, which is reserved for what is made. Who frees that sets `reserved` to 0; a call that
 *  makes nothing does so before its end. */
int call_begin_reserving(call *c, module_state *state, int threads, PyObject *progress);
/** Begins a call in a reserved context, in which there is no other call. */
int call_begin_reserved(call *c, module_state *state, pooled_context *reserved, int threads, PyObject *progress);
/** Begins a call with a context that an object has for itself, and that no other call has now. */
int call_begin_in(call *c, module_state *state, brio_context *own, int threads, PyObject *progress);
/** Runs `expression`, which uses c.ctx, without the interpreter's lock. */
#define CALL(c, status, expression)                                                                                    \
    do {                                                                                                               \
        (c).thread = PyEval_SaveThread();                                                                              \
        (status) = (expression);                                                                                       \
        PyEval_RestoreThread((c).thread);                                                                              \
    } while (0)
/** Ends a call. Returns 0, or -1 with an exception set if the status is an error. */
int call_end(call *c, brio_status status);

/** Sets an ArgumentError with a sentence, whose reference it takes; NULL leaves the exception that is set. Returns -1. */
int raise_argument(module_state *state, PyObject *sentence);

/* --- arrays --- */

/** What a view shows: format in the notation of `struct`, sizes and strides in bytes. */
typedef struct {
    const void *data;
    const char *format;
    Py_ssize_t item;
    int ndim;
    Py_ssize_t shape[2], strides[2];
} layout;

/* Whether an array's format is that which is wanted: numpy may say q for l, or Q for L; and where long has 32 bits, as on
 * Windows, l for i, and L for I; and g for d where C's long double is a double, as on Windows and on Macs with ARM. */
int is_of_format(const Py_buffer *view, char wanted);

/** Makes an object with a read-only buffer that keeps `base` alive; numpy.asarray makes an array of it. */
PyObject *array_new(module_state *state, PyObject *base, layout shown);
/** Makes such an object of a copy of what is shown, one row after the other. */
PyObject *array_copy(module_state *state, layout shown);
/** The layouts that occur: #n, or #n by columns, one after the other. */
layout layout_of(const void *data, char format, size_t rows, size_t columns);
extern PyType_Spec array_spec;

/** An array of the caller during a call: C-contiguous, native, of the format asked for.
 *  I1  Other threads may write to the caller's array while the library works. The library bears that of the arrays that
 *      brio.h names. What it reads of all others is a copy, made before any check; without an interpreter's lock others
 *      may write during the copying, too. Nobody may resize or free an array meanwhile: numpy does so, under an open view,
 *      where it is told not to check (refcheck=False).
 *  I2  What the library writes is an array that Python has just made. */
typedef struct {
    void *data;
    Py_buffer view; /* of an array that is no copy */
    int held;       /* `view` is open */
    size_t rows, columns, bytes;
} input;

/** Copies an array.   format  one letter as in `struct`: d I L B.   columns  0: of one dimension; else of two, and of that
 *  many columns; -1: of two, and of any number of columns.   Returns 0 or -1 with an exception set. */
int input_open(input *in, PyObject *object, const char *name, char format, int columns);
/** Opens an array without a copy, for a function that bears changes of it. */
int input_borrow(input *in, PyObject *object, const char *name, char format, int columns);
/** Opens an array to write to. */
int output_open(input *in, PyObject *object, const char *name, char format, int columns);
/** Opens an array of one number a row of another, unless the object is None. */
int input_open_weights(input *in, PyObject *object, size_t rows);
/** The same without a copy. */
int input_borrow_weights(input *in, PyObject *object, size_t rows);
void input_close(input *in);
/** Returns 0, or -1 with ValueError set unless the array has that many rows. */
int input_has_rows(const input *in, const char *name, size_t rows);

/* --- objects of the library --- */

typedef enum {
    KIND_TRIANGULATION,
    KIND_TRIANGULATION2,
    KIND_LOCATOR,
    KIND_LOCATOR2,
    KIND_DIAGRAM2,
    KIND_INCIDENCES,
    KIND_CELLS,
    KIND_ALPHA,
    KIND_PERIODIC,
    KIND_PERIODIC_ALPHA,
    KIND_PERIODIC_LOCATOR,
    KIND_MESH,
    KIND_DYNAMIC,
    KIND_TILES,
    KIND_TILE_PART
} kind;

/** An object and the context that frees it. */
struct record {
    void *object;
    void (*release)(void *object);
    pooled_context *context;
    record *next;
};

typedef struct {
    PyObject_HEAD kind kind;
    record *record;
    PyObject *base; /* an object that this one reads, or NULL */
} handle;

/** Ends the call and makes a handle of what it made. Frees the object if the handle cannot be made. */
PyObject *call_end_with(call *c, brio_status status, kind what, void *object, void (*release)(void *), PyObject *base);
/** Returns the object of a handle of that kind, or NULL with TypeError set. */
void *handle_object(module_state *state, PyObject *object, kind kind);
/** Returns 0, or -1 with an exception set if these are not the points that a triangulation was made of. A triangulation
 *  with other points than its own would lead the library astray: what the library reads next has to be the copy that was
 *  checked here. */
int handle_has_points(module_state *state, PyObject *object, const input *points, const input *weights);
extern PyType_Spec handle_spec;

/** Returns a dict of the arrays of cells, which keep `owner` alive; None in place of those that were not asked for. An
 *  owner of NULL: they are copies. */
PyObject *cells_views(module_state *state, PyObject *owner, const brio_cells *c);
void cells_release(void *cells);

/** Returns a dict of the simplices of a complex and their values, which keep `owner` alive. The lists have an array for each
 *  dimension: 4 in space, 3 in the plane. */
PyObject *alpha_views(module_state *state, PyObject *owner, const brio_alpha_complex *a);
/** Frees a complex that lies in a block of malloc. */
void alpha_release(void *complex);

/** Reads options of reading: format or None, columns or None, drop_invalid, salvage. Returns 0 or -1 with an exception set;
 *  the tuple keeps the texts. */
int read_reading_options(module_state *state, PyObject *tuple, brio_read_options *o);

/* --- the functions of the module, by file --- */

extern PyMethodDef delaunay_methods[], locate_methods[], plane_methods[], dual_methods[], cells_methods[],
    mesh_methods[], files_methods[], points_methods[], surface_methods[], alpha_methods[], periodic_methods[],
    dynamic_methods[], tiles_methods[], estimate_methods[];

#endif
