/* The module brio._native: its functions, types and state. */
#include "native.h"

module_state *state_of(PyObject *module) {
    return PyModule_GetState(module);
}

static PyObject *set_make_error(PyObject *module, PyObject *function) {
    module_state *state = state_of(module);
    Py_INCREF(function);
    Py_XDECREF(state->make_error);
    state->make_error = function;
    Py_RETURN_NONE;
}

#ifdef BRIO_HAS_ZLIB
#define HAS_ZLIB Py_True
#else
#define HAS_ZLIB Py_False
#endif
#ifdef BRIO_HAS_ZSTD
#define HAS_ZSTD Py_True
#else
#define HAS_ZSTD Py_False
#endif
#ifdef BRIO_HAS_EXPAT
#define HAS_EXPAT Py_True
#else
#define HAS_EXPAT Py_False
#endif
#ifdef BRIO_HAS_CJSON
#define HAS_CJSON Py_True
#else
#define HAS_CJSON Py_False
#endif
#ifdef Py_GIL_DISABLED
#define IS_FREE_THREADED Py_True
#else
#define IS_FREE_THREADED Py_False
#endif

/* What the library was built with: its optional libraries, and the kind of CPython. */
static PyObject *build_info(PyObject *module, PyObject *unused) {
    (void)module, (void)unused;
    return Py_BuildValue("{s:s,s:O,s:O,s:O,s:O,s:O}", "version", brio_version(), "zlib", HAS_ZLIB, "zstd", HAS_ZSTD,
                         "expat", HAS_EXPAT, "cjson", HAS_CJSON, "free_threaded", IS_FREE_THREADED);
}

static PyMethodDef methods[] = {
    {"build_info", build_info, METH_NOARGS, "How the library was built, in a dict."},
    {"set_make_error", set_make_error, METH_O,
     "Sets the function that makes exceptions of status, sentence, points and reason."},
    {NULL, NULL, 0, NULL},
};

static int add_all(PyObject *module) {
    PyMethodDef *all[] = {methods,       delaunay_methods, locate_methods,  plane_methods,  dual_methods,
                          cells_methods, mesh_methods,     files_methods,   points_methods, surface_methods,
                          alpha_methods, periodic_methods, dynamic_methods, tiles_methods,  estimate_methods};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        if (PyModule_AddFunctions(module, all[k])) return -1;
    return PyModule_AddStringConstant(module, "version", brio_version());
}

static int execute(PyObject *module) {
    module_state *state = state_of(module);
    state->make_error = Py_None;
    Py_INCREF(Py_None);
    state->lock = PyThread_allocate_lock();
    state->handle_type = (PyTypeObject *)PyType_FromModuleAndSpec(module, &handle_spec, NULL);
    state->array_type = (PyTypeObject *)PyType_FromModuleAndSpec(module, &array_spec, NULL);
    if (!state->lock || !state->handle_type || !state->array_type) return -1;
    return add_all(module);
}

static int traverse(PyObject *module, visitproc visit, void *arg) {
    module_state *state = state_of(module);
    Py_VISIT(state->handle_type);
    Py_VISIT(state->array_type);
    Py_VISIT(state->make_error);
    return 0;
}

static int clear(PyObject *module) {
    Py_CLEAR(state_of(module)->make_error);
    return 0;
}

static void release(void *module) {
    module_state *state = state_of(module);
    if (!state) return;
    clear(module);
    Py_CLEAR(state->handle_type);
    Py_CLEAR(state->array_type);
    contexts_free(state);
    if (state->lock) PyThread_free_lock(state->lock);
    state->lock = NULL;
}

/* Slots that CPython 3.11 does not know, by number, for builds on the limited API of 3.11: Py_mod_multiple_interpreters
 * and Py_mod_gil. They are added when the interpreter that runs knows them. */
enum { SLOT_INTERPRETERS = 3, SLOT_GIL = 4 };
#define PER_INTERPRETER_GIL ((void *)2)
#define GIL_NOT_USED        ((void *)1)

static PyModuleDef_Slot slots[4] = {{Py_mod_exec, execute}};

static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT,
                                        "_native",
                                        "The C library brio, for the package brio.",
                                        sizeof(module_state),
                                        NULL,
                                        slots,
                                        traverse,
                                        clear,
                                        release};

PyMODINIT_FUNC PyInit__native(void) {
    int n = 1;
    if (Py_Version >= 0x030c0000) slots[n++] = (PyModuleDef_Slot){SLOT_INTERPRETERS, PER_INTERPRETER_GIL};
    if (Py_Version >= 0x030d0000) slots[n++] = (PyModuleDef_Slot){SLOT_GIL, GIL_NOT_USED};
    slots[n] = (PyModuleDef_Slot){0, NULL};
    return PyModuleDef_Init(&definition);
}
