/* Files: reading, writing, converting, and what this build of the library reads and writes. */
#include "mesh.h"
#include <string.h>

/* Sets the format of a name or an extension, unless it is NULL. Returns 0, or -1 with an exception set. */
static int read_format(module_state *state, const char *name, brio_format *format) {
    if (!name) return 0;
    *format = brio_format_of(name);
    if (*format != BRIO_FORMAT_AUTO) return 0;
    return raise_argument(state, PyUnicode_FromFormat("format: the extension of a format is wanted, such as \"ply\" or "
                                                      "\"xyz\", not \"%s\"",
                                                      name));
}

int read_reading_options(module_state *state, PyObject *tuple, brio_read_options *o) {
    const char *format;
    if (!PyTuple_Check(tuple)) {
        PyErr_SetString(PyExc_TypeError, "options of reading in a tuple are wanted");
        return -1;
    }
    if (!PyArg_ParseTuple(tuple, "zzpp", &format, &o->columns, &o->drop_invalid, &o->salvage)) return -1;
    return read_format(state, format, &o->format);
}

/* read(path, options of reading, threads, progress): a mesh. The path is bytes. */
static PyObject *read_mesh(PyObject *module, PyObject *args) {
    PyObject *options, *progress;
    brio_read_options o = {0};
    const char *path;
    int threads;
    call c;
    brio_status status;
    brio_mesh *made = NULL;
    if (!PyArg_ParseTuple(args, "yOiO", &path, &options, &threads, &progress)) return NULL;
    if (read_reading_options(state_of(module), options, &o)) return NULL;
    if (call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_read(c.ctx, path, &o, &made));
    return call_end_with_mesh(&c, status, made);
}

/* Reads the options of writing that Python offers: (ascii, float32, compress, comment or None). */
static int read_write_options(PyObject *tuple, brio_write_options *o) {
    return PyArg_ParseTuple(tuple, "pppz", &o->ascii, &o->float32, &o->compress, &o->comment) ? 0 : -1;
}

/* write(path, mesh, options, threads, progress) */
static PyObject *write_mesh(PyObject *module, PyObject *args) {
    PyObject *object, *options, *progress;
    brio_write_options o = {0};
    const char *path;
    int threads;
    call c;
    brio_status status;
    if (!PyArg_ParseTuple(args, "yOO!iO", &path, &object, &PyTuple_Type, &options, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || read_write_options(options, &o) || call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_write(c.ctx, path, m, &o));
    if (call_end(&c, status)) return NULL;
    Py_RETURN_NONE;
}

/* --- converting --- */

/* The names of what a conversion loses. The library calls back without the interpreter's lock. */
typedef struct {
    char *names; /* one after the other, each with its 0 */
    size_t bytes;
    int failed;
} losses;

static void lose(const char *name, void *user) {
    losses *l = user;
    size_t bytes = strlen(name) + 1;
    char *names = realloc(l->names, l->bytes + bytes);
    if (!names) {
        l->failed = 1;
        return;
    }
    memcpy(names + l->bytes, name, bytes);
    l->names = names;
    l->bytes += bytes;
}

static PyObject *list_of(const losses *l) {
    PyObject *list = PyList_New(0);
    for (size_t at = 0; list && at < l->bytes; at += strlen(l->names + at) + 1) {
        PyObject *name = PyUnicode_DecodeUTF8(l->names + at, (Py_ssize_t)strlen(l->names + at), "replace");
        if (!name || PyList_Append(list, name)) Py_CLEAR(list);
        Py_XDECREF(name);
    }
    return list;
}

static PyObject *conversion_dict(const brio_convert_stats *s, const losses *l) {
    PyObject *lost = l->failed ? PyErr_NoMemory() : list_of(l);
    if (!lost) return NULL;
#define COUNT(name) #name, (unsigned long long)s->name
    return Py_BuildValue("{s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:K,s:N,s:N}", COUNT(points_read), COUNT(points),
                         COUNT(faces), COUNT(tetrahedra), COUNT(edges), COUNT(outliers), COUNT(thinned), COUNT(merged),
                         COUNT(degenerate), COUNT(tiles), COUNT(largest_tile), "streamed", PyBool_FromLong(s->streamed),
                         "lost", lost);
#undef COUNT
}

/* convert(from, to, options of reading, write options, box or None, (neighbours, factor, thin, merge, distance),
 * (tiles, scratch or ""), threads, progress): a dict. */
static PyObject *convert(PyObject *module, PyObject *args) {
    PyObject *reading, *options, *box, *progress, *result = NULL;
    brio_read_options in = {0};
    brio_write_options out = {0};
    brio_outliers_options outliers = {0};
    brio_convert_options o = {.size = sizeof o};
    brio_convert_stats stats = {.size = sizeof stats};
    const char *from, *to, *scratch;
    int threads;
    call c;
    input corners = {.held = 0};
    losses lost = {NULL, 0, 0};
    if (!PyArg_ParseTuple(args, "yyOO!O(iddpd)(Iy)iO", &from, &to, &reading, &PyTuple_Type, &options, &box,
                          &o.drop_outliers, &outliers.factor, &o.thin, &o.merge, &o.merge_distance, &o.tiles, &scratch,
                          &threads, &progress) ||
        read_reading_options(state_of(module), reading, &in) || read_write_options(options, &out))
        return NULL;
    o.scratch = *scratch ? scratch : NULL;
    o.from = &in, o.to = &out, o.outliers = &outliers, o.lost = lose, o.lost_user = &lost;
    if (box != Py_None) {
        if (input_open(&corners, box, "box", 'd', 0)) return NULL;
        o.crop = corners.rows == 6;
        if (o.crop) memcpy(o.box, corners.data, sizeof o.box);
        int wrong = input_has_rows(&corners, "box", 6);
        input_close(&corners);
        if (wrong) return NULL;
    }
    if (call_begin(&c, state_of(module), threads, progress)) return NULL;
    brio_status status;
    CALL(c, status, brio_convert(c.ctx, from, to, &o, &stats));
    if (!call_end(&c, status)) result = conversion_dict(&stats, &lost);
    free(lost.names);
    return result;
}

/* --- pages --- */

enum { MOST_LAYERS = 12 }; /* as brio view shows: the page has as many colours */

/* Reads ((mesh, name, report), ...) as layers; returns their number, -1 after an error. */
static Py_ssize_t take_layers(module_state *state, PyObject *given, brio_page_layer layers[MOST_LAYERS],
                              const brio_page_layer *list[MOST_LAYERS]) {
    Py_ssize_t count = PyTuple_Size(given);
    if (count > MOST_LAYERS) {
        raise_argument(state, PyUnicode_FromFormat("a page shows at most %d meshes", MOST_LAYERS));
        return -1;
    }
    for (Py_ssize_t i = 0; i < count; i++) {
        PyObject *object;
        if (!PyArg_ParseTuple(PyTuple_GetItem(given, i), "Ozz", &object, &layers[i].name, &layers[i].report)) return -1;
        layers[i].mesh = handle_object(state, object, KIND_MESH);
        if (!layers[i].mesh) return -1;
        list[i] = &layers[i];
    }
    return count;
}

/* write_page(path, ((mesh, name, report), ...), (title, most_points, exact, self_intersections, side_by_side), threads,
 * progress); name, report and title may be None */
static PyObject *write_page(PyObject *module, PyObject *args) {
    PyObject *given, *progress;
    brio_page_options o = {.size = sizeof o};
    brio_page_layer layers[MOST_LAYERS] = {{0}};
    const brio_page_layer *list[MOST_LAYERS];
    Py_ssize_t points, count;
    const char *path;
    int threads;
    call c;
    brio_status status;
    if (!PyArg_ParseTuple(args, "yO!(znppp)iO", &path, &PyTuple_Type, &given, &o.title, &points, &o.exact,
                          &o.self_intersections, &o.side_by_side, &threads, &progress))
        return NULL;
    if ((count = take_layers(state_of(module), given, layers, list)) < 0) return NULL;
    o.most_points = (size_t)points;
    if (call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_write_page(c.ctx, path, list, (size_t)count, &o, NULL));
    if (call_end(&c, status)) return NULL;
    Py_RETURN_NONE;
}

/* write_picture(path, ((mesh, name, report), ...), (width, height, colour, self_intersections, side_by_side, dark),
 * (x, y, z), threads, progress); colour may be None. Returns ((x, y, z), pixel, (low, high)). */
static PyObject *write_picture(PyObject *module, PyObject *args) {
    PyObject *given, *progress;
    brio_picture_options o = {.size = sizeof o};
    brio_picture_stats s = {.size = sizeof s};
    brio_page_layer layers[MOST_LAYERS] = {{0}};
    const brio_page_layer *list[MOST_LAYERS];
    Py_ssize_t count;
    const char *path;
    int threads;
    call c;
    brio_status status;
    if (!PyArg_ParseTuple(args, "yO!(iizppp)(ddd)iO", &path, &PyTuple_Type, &given, &o.width, &o.height, &o.colour,
                          &o.self_intersections, &o.side_by_side, &o.dark, &o.from[0], &o.from[1], &o.from[2], &threads,
                          &progress))
        return NULL;
    if ((count = take_layers(state_of(module), given, layers, list)) < 0) return NULL;
    if (call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_write_picture(c.ctx, path, list, (size_t)count, &o, &s));
    if (call_end(&c, status)) return NULL;
    return Py_BuildValue("(ddd)d(dd)", s.from[0], s.from[1], s.from[2], s.pixel, s.low, s.high);
}

PyMethodDef files_methods[] = {
    {"read", read_mesh, METH_VARARGS,
     "read(path, (format, columns, drop_invalid, salvage), threads, progress): a mesh."},
    {"write", write_mesh, METH_VARARGS, "write(path, mesh, (ascii, float32, compress, comment), threads, progress)"},
    {"convert", convert, METH_VARARGS,
     "convert(from, to, options of reading, write options, box, (neighbours, factor, thin, merge, distance), "
     "(tiles, scratch), threads, progress)"},
    {"write_page", write_page, METH_VARARGS, "write_page(path, layers, options, threads, progress)"},
    {"write_picture", write_picture, METH_VARARGS, "write_picture(path, layers, options, look, threads, progress)"},
    {NULL, NULL, 0, NULL},
};
