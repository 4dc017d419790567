/* Arrays: views of what the library made, and arrays of the caller, both by the buffer protocol. */
#include "native.h"
#include "system.h"
#include <stdint.h>
#include <string.h>

/* --- views --- */

typedef struct {
    PyObject_HEAD PyObject *base;
    layout shown;
} array;

static Py_ssize_t size_of(char format) {
    switch (format) {
    case 'd':
    case 'L':
    case 'l':
        return 8;
    case 'I':
    case 'i':
    case 'f':
        return 4;
    case 'h':
    case 'H':
        return 2;
    default:
        return 1;
    }
}

/* Returns what the buffer protocol calls a format. As in numpy, integers of 64 bits are `long` where that has 64. */
static const char *format_of(char format) {
    static const char formats[][2] = {"d", "L", "l", "I", "i", "f", "h", "H", "b", "B", "?"};
    if (sizeof(long) == 4 && (format == 'L' || format == 'l')) return format == 'L' ? "Q" : "q";
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++)
        if (formats[k][0] == format) return formats[k];
    return "B";
}

layout layout_of(const void *data, char format, size_t rows, size_t columns) {
    Py_ssize_t item = size_of(format), width = columns ? (Py_ssize_t)columns * item : item;
    layout shown = {data,         format_of(format), item, columns ? 2 : 1, {(Py_ssize_t)rows, (Py_ssize_t)columns},
                    {width, item}};
    return shown;
}

PyObject *array_new(module_state *state, PyObject *base, layout shown) {
    static const uint64_t nothing; /* for arrays of 0 elements, which may be NULL in C */
    array *a = PyObject_New(array, state->array_type);
    if (!a) return NULL;
    Py_INCREF(base);
    a->base = base;
    a->shown = shown;
    if (!a->shown.data) a->shown.data = &nothing;
    return (PyObject *)a;
}

PyObject *array_copy(module_state *state, layout shown) {
    Py_ssize_t row = shown.item * (shown.ndim > 1 ? shown.shape[1] : 1), rows = shown.shape[0];
    PyObject *bytes = PyBytes_FromStringAndSize(shown.data, rows * row), *copy = NULL;
    if (!bytes) return NULL;
    shown.data = PyBytes_AsString(bytes);
    copy = array_new(state, bytes, shown);
    Py_DECREF(bytes);
    return copy;
}

static int is_contiguous(const layout *shown) {
    Py_ssize_t stride = shown->item;
    for (int k = shown->ndim - 1; k >= 0; k--) {
        if (shown->shape[k] > 1 && shown->strides[k] != stride) return 0;
        stride *= shown->shape[k];
    }
    return 1;
}

static int array_getbuffer(PyObject *self, Py_buffer *view, int flags) {
    layout *shown = &((array *)self)->shown;
    Py_ssize_t length = shown->item;
    for (int k = 0; k < shown->ndim; k++) length *= shown->shape[k];
    view->obj = NULL;
    if ((flags & PyBUF_WRITABLE) || ((flags & PyBUF_STRIDES) != PyBUF_STRIDES && !is_contiguous(shown))) {
        PyErr_SetString(PyExc_BufferError, "the array is read-only, and may have strides");
        return -1;
    }
    *view = (Py_buffer){.buf = (void *)shown->data,
                        .obj = self,
                        .len = length,
                        .readonly = 1,
                        .itemsize = shown->item,
                        .format = (flags & PyBUF_FORMAT) ? (char *)shown->format : NULL,
                        .ndim = shown->ndim,
                        .shape = (flags & PyBUF_ND) ? shown->shape : NULL,
                        .strides = (flags & PyBUF_STRIDES) == PyBUF_STRIDES ? shown->strides : NULL};
    Py_INCREF(self);
    return 0;
}

static void array_dealloc(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    Py_DECREF(((array *)self)->base);
    PyObject_Free(self);
    Py_DECREF(type);
}

static PyType_Slot array_slots[] = {
    {Py_tp_dealloc, array_dealloc},
    {Py_bf_getbuffer, array_getbuffer},
    {Py_tp_doc, "Numbers of an object of the library, for numpy.asarray."},
    {0, NULL},
};
PyType_Spec array_spec = {"brio._native.Array", sizeof(array), 0,
                          Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, array_slots};

/* --- arrays of the caller --- */

int is_of_format(const Py_buffer *view, char wanted) {
    static const char of_64[] = "LQ", signed_of_64[] = "lq", of_32[] = "IL", signed_of_32[] = "il";
    const int wide = sizeof(long) == 8;
    const char *found = view->format;
    if (!found || found[1] || !*found) return 0;
    if (wanted == 'L') return strchr(wide ? of_64 : "Q", *found) != NULL;
    if (wanted == 'l') return strchr(wide ? signed_of_64 : "q", *found) != NULL;
    if (wanted == 'I') return strchr(wide ? "I" : of_32, *found) != NULL;
    if (wanted == 'i') return strchr(wide ? "i" : signed_of_32, *found) != NULL;
    if (wanted == 'B') return strchr("B?", *found) != NULL;
    if (wanted == 'd' && view->itemsize == sizeof(double)) return strchr("dg", *found) != NULL;
    return *found == wanted;
}

static int open_view(input *in, PyObject *object, const char *name, char format, int columns, int flags) {
    *in = (input){.held = 0};
    if (PyObject_GetBuffer(object, &in->view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | flags)) return -1;
    in->held = 1;
    const Py_buffer *view = &in->view;
    int ndim = columns ? 2 : 1;
    in->data = view->buf;
    in->rows = view->ndim > 0 ? (size_t)view->shape[0] : 0;
    in->columns = view->ndim > 1 ? (size_t)view->shape[1] : 1;
    in->bytes = (size_t)view->len;
    if (is_of_format(view, format) && view->ndim == ndim && (columns <= 0 || in->columns == (size_t)columns)) return 0;
    PyErr_Format(PyExc_ValueError, "%s: an array of another type or shape than wanted (%c, %d dimensions)", name,
                 format, ndim);
    PyBuffer_Release(&in->view);
    *in = (input){.held = 0};
    return -1;
}

int input_borrow(input *in, PyObject *object, const char *name, char format, int columns) {
    return open_view(in, object, name, format, columns, 0);
}

int input_open(input *in, PyObject *object, const char *name, char format, int columns) {
    if (open_view(in, object, name, format, columns, 0)) return -1;
    in->data = place_new(in->bytes);
    if (in->data) memcpy(in->data, in->view.buf, in->bytes);
    PyBuffer_Release(&in->view);
    in->held = 0;
    if (in->data) return 0;
    PyErr_NoMemory();
    return -1;
}

int output_open(input *in, PyObject *object, const char *name, char format, int columns) {
    return open_view(in, object, name, format, columns, PyBUF_WRITABLE);
}

int input_has_rows(const input *in, const char *name, size_t rows) {
    if (in->rows == rows) return 0;
    PyErr_Format(PyExc_ValueError, "%s: %zu rows, where there should be %zu", name, in->rows, rows);
    return -1;
}

/* Opens weights by one of the functions above. */
static int open_weights(input *in, PyObject *object, size_t rows,
                        int (*open)(input *, PyObject *, const char *, char, int)) {
    *in = (input){.held = 0};
    if (object == Py_None) return 0;
    if (open(in, object, "weights", 'd', 0)) return -1;
    if (!input_has_rows(in, "weights", rows)) return 0;
    input_close(in);
    return -1;
}

int input_open_weights(input *in, PyObject *object, size_t rows) {
    return open_weights(in, object, rows, input_open);
}

int input_borrow_weights(input *in, PyObject *object, size_t rows) {
    return open_weights(in, object, rows, input_borrow);
}

void input_close(input *in) {
    if (in->held)
        PyBuffer_Release(&in->view);
    else
        place_free(in->data);
    *in = (input){.held = 0};
}
