/* Convex hulls, surfaces of samples, medial axes, offsets, and normals of points. */
#include "mesh.h"
#include <limits.h>

/* --- options: read from a dict, by name --- */

typedef enum { INT, DOUBLE, SIZE, COUNT, SEED } option_type;

typedef struct {
    const char *name;
    option_type type;
    void *field;
} option;

/* Returns an int; sets OverflowError if the value is beyond ints. */
static int as_int(PyObject *value) {
    long number = PyLong_AsLong(value);
    if (number < INT_MIN || number > INT_MAX) PyErr_SetNone(PyExc_OverflowError);
    return (int)number;
}

/* Returns a uint32_t; sets OverflowError if the value is beyond these. */
static uint32_t as_uint(PyObject *value) {
    size_t number = PyLong_AsSize_t(value);
    if (number > UINT32_MAX && !PyErr_Occurred()) PyErr_SetNone(PyExc_OverflowError);
    return (uint32_t)number;
}

static void set_option(const option *o, PyObject *value) {
    switch (o->type) {
    case INT:
        *(int *)o->field = as_int(value);
        break;
    case DOUBLE:
        *(double *)o->field = PyFloat_AsDouble(value);
        break;
    case SIZE:
        *(size_t *)o->field = PyLong_AsSize_t(value);
        break;
    case COUNT:
        *(uint32_t *)o->field = as_uint(value);
        break;
    case SEED:
        *(uint64_t *)o->field = PyLong_AsUnsignedLongLong(value);
        break;
    }
}

/* Makes an ArgumentError of the exception that a value of an option raised. Returns -1. */
static int raise_option(module_state *state, const option *o, PyObject *value) {
    static const char *const wanted[] = {
        "a whole number or a truth value is wanted", "a number is wanted", "a whole number of at least 0 is wanted",
        "a whole number from 0 to 2^32 - 1 is wanted", "a whole number from 0 to 2^64 - 1 is wanted"};
    PyErr_Clear();
    return raise_argument(state, PyUnicode_FromFormat("%s: %s, not %R", o->name, wanted[o->type], value));
}

/* Sets the options that the dict names. Returns 0, or -1 with an exception set; a name that is not there is an error. */
static int set_options(module_state *state, const option *options, PyObject *dict) {
    PyObject *name, *value;
    Py_ssize_t at = 0;
    while (PyDict_Next(dict, &at, &name, &value)) {
        const option *o = options;
        while (o->name && PyUnicode_CompareWithASCIIString(name, o->name)) o++;
        if (!o->name) {
            PyErr_Format(PyExc_TypeError, "this method has no option %R", name);
            return -1;
        }
        set_option(o, value);
        if (PyErr_Occurred()) return raise_option(state, o, value);
    }
    return 0;
}

/* --- a call: (points, options, ..., threads, progress) --- */

typedef struct {
    PyObject *points, *options, *extra, *progress;
    int threads;
    double number;
    input p, out;
} surface_call;

/* Opens points: input_open, or input_borrow for a method that bears changes of them. */
typedef int opener(input *in, PyObject *object, const char *name, char format, int columns);

/* Reads (points, options, number, extra or None, threads, progress). `extra` is an array to write, of `columns`. */
static int open_surface_call(surface_call *s, PyObject *args, opener *opens, char format, int columns) {
    s->p = s->out = (input){.held = 0};
    if (!PyArg_ParseTuple(args, "OO!dOiO", &s->points, &PyDict_Type, &s->options, &s->number, &s->extra, &s->threads,
                          &s->progress))
        return -1;
    if (opens(&s->p, s->points, "points", 'd', 3)) return -1;
    if (s->extra == Py_None) return 0;
    if (output_open(&s->out, s->extra, "out", format, columns)) return -1;
    return input_has_rows(&s->out, "out", s->p.rows);
}

static void close_surface_call(surface_call *s) {
    input_close(&s->p);
    input_close(&s->out);
}

/* --- methods --- */

/* What the options ask for beside those of the library. */
typedef struct {
    int labeling; /* a brio_labeling; from its end on those of experiments */
    int extraction;
} experiment;

/* Begins the experiment that the options ask for, to be freed; sets the labeling of the library.   poles  NULL: none. */
static brio_status begin_experiment(brio_context *ctx, const experiment *e, brio_pole_options *poles,
                                    brio_laboratory **lab) {
    brio_laboratory_options o = {.extraction = (brio_extraction)e->extraction};
    if (e->labeling >= BRIO_LABELING_END)
        o.labeling = (brio_laboratory_labeling)(e->labeling - BRIO_LABELING_END + BRIO_LABELS_NAIVE);
    else
        poles->labeling = (brio_labeling)e->labeling;
    return brio_laboratory_new(ctx, &o, lab);
}

/* Fields that every method with poles has. */
#define POLE_OPTIONS(o)                                                                                                \
    {"seed", SEED, &(o).seed}, {"noise", INT, &(o).noise}, {"sampling_density", DOUBLE, &(o).poles.sampling_density},  \
    {                                                                                                                  \
        "sharp", INT, &(o).poles.sharp                                                                                 \
    }

/* Begins the call, runs `expression` with `o`, the options that `table` names, and makes a handle of `mesh`. */
#define RUN_SURFACE(table, expression)                                                                                 \
    do {                                                                                                               \
        if (!set_options(state_of(module), table, s.options) &&                                                        \
            !call_begin(&c, state_of(module), s.threads, s.progress)) {                                                \
            CALL(c, status, expression);                                                                               \
            result = call_end_with_mesh(&c, status, mesh);                                                             \
        }                                                                                                              \
    } while (0)

/* The arrays of a brio_evidence. */
typedef struct {
    input normals, origins;
    brio_evidence taken;
} evidence_input;

/* Opens an array that the options name, and takes it out of them. Returns 1, 0 if it is not there, or -1. */
static int open_evidence_array(input *in, PyObject *options, const char *name) {
    PyObject *array = PyDict_GetItemString(options, name);
    if (!array) return 0;
    if (input_open(in, array, name, 'd', 3)) return -1;
    return PyDict_DelItemString(options, name) ? -1 : 1;
}

/* Opens the options normals and origins: one row a point; origins may also be one row for all points. */
static int open_evidence(evidence_input *e, PyObject *options, size_t rows) {
    int normals, origins;
    *e = (evidence_input){.taken = (brio_evidence){0}};
    if ((normals = open_evidence_array(&e->normals, options, "normals")) < 0) return -1;
    if (normals && input_has_rows(&e->normals, "normals", rows)) return -1;
    if ((origins = open_evidence_array(&e->origins, options, "origins")) < 0) return -1;
    if (origins && e->origins.rows != 1 && input_has_rows(&e->origins, "origins", rows)) return -1;
    e->taken.normals = normals ? e->normals.data : NULL;
    e->taken.origins = origins ? e->origins.data : NULL;
    e->taken.num_origins = origins ? e->origins.rows : 0;
    return 0;
}

static void close_evidence(evidence_input *e) {
    input_close(&e->normals);
    input_close(&e->origins);
}

/* Makes the surface. Its property "sample" goes to an array, where one is given, and not to the interpreter.
 * tiles  how many triangulate, in the folder of the call; 0: none. */
static brio_status make_surface(const call *c, const surface_call *s, brio_surface_options *o, const experiment *e,
                                uint32_t tiles, uint32_t *samples, brio_mesh **mesh, brio_surface_stats *stats) {
    brio_context *ctx = c->ctx;
    const brio_tiles_options in_tiles = {.size = sizeof in_tiles, .scratch = c->scratch, .tiles = tiles};
    if (tiles) o->tiles = &in_tiles;
    brio_laboratory *lab;
    brio_status status = begin_experiment(ctx, e, &o->poles, &lab);
    if (status == BRIO_OK) status = brio_surface(ctx, s->p.data, s->p.rows, o, mesh, stats);
    brio_laboratory_free(lab);
    if (status != BRIO_OK) return status;
    const brio_property *property = brio_mesh_property(*mesh, "sample");
    for (size_t v = 0; samples && v < (*mesh)->num_vertices; v++)
        samples[v] = (uint32_t)brio_property_value(property, v);
    brio_mesh_remove_property(*mesh, "sample");
    return BRIO_OK;
}

/* Makes a dict of what the surface is worth, by the names that the command line's report has. */
static PyObject *report_of(const brio_surface_stats *s) {
    static const char *const by[] = {"guess", "normals", "scanner", "evidence"};
#define FACT(name) #name, (Py_ssize_t)s->name
    PyObject *bridges = Py_BuildValue("{s:n,s:d,s:d,s:(ddd)}", "number", (Py_ssize_t)s->bridges, "area_share",
                                      s->bridge_share, "largest_radius", s->bridge_radius, "largest_centre",
                                      s->bridge_centre[0], s->bridge_centre[1], s->bridge_centre[2]);
    PyObject *report =
        Py_BuildValue("{s:d,s:N,s:d,s:n,s:n,s:n,s:n,s:n,s:n,s:n,s:n,s:N,s:d,s:d,s:s}", "noise", s->noise, "smoothed",
                      PyBool_FromLong((long)s->smoothed), "rounding", s->rounding, FACT(unused), FACT(undecided),
                      FACT(specks), FACT(relabeled), FACT(handles), FACT(strays), FACT(holes), FACT(left_out),
                      "bridges", bridges, "far_area_percent", 100 * s->far_share, "uncertain_share", s->uncertain_share,
                      "orientation", by[s->evidence & 3]);
#undef FACT
    const struct {
        const char *name;
        size_t told;
        double share;
    } agreement[] = {{"agreement", s->told, s->agreement},
                     {"normals_agreement", s->normals, s->normals_agreement},
                     {"origins_agreement", s->origins, s->origins_agreement}};
    for (int k = 0; report && k < 3; k++) {
        PyObject *share = agreement[k].told ? PyFloat_FromDouble(agreement[k].share) : Py_NewRef(Py_None);
        if (!share || PyDict_SetItemString(report, agreement[k].name, share)) Py_CLEAR(report);
        Py_XDECREF(share);
    }
    return report;
}

/* An option of brio_surface, by the name that Python has for it, and the field that a method must have for it; NULL: all
 * have it. */
typedef struct {
    option option;
    const char *field;
} surface_option;

/* Copies the options that a method has into a table, which has room for all. */
static void choose_options(const surface_option *all, const brio_surface_method_info *method, option *table) {
    for (; all->option.name; all++)
        if (!all->field || brio_surface_method_has(method->method, all->field)) *table++ = all->option;
    *table = all->option;
}

/* Takes the number of a method out of the options. Returns NULL with an exception set where it names none. */
static const brio_surface_method_info *take_method(PyObject *options) {
    PyObject *value = PyDict_GetItemString(options, "method");
    const brio_surface_method_info *method = NULL;
    if (value) method = brio_surface_method_facts((brio_surface_method)as_int(value));
    if (!method && !PyErr_Occurred()) PyErr_SetString(PyExc_TypeError, "no such method");
    return method && !PyErr_Occurred() && !PyDict_DelItemString(options, "method") ? method : NULL;
}

/* Returns a handle of the mesh and a report. The option `method` is a brio_surface_method. Polygons stay polygons, unless
 * triangles are asked for. */
static PyObject *surface(PyObject *module, PyObject *args) {
    surface_call s;
    evidence_input e = {.taken = {0}};
    call c;
    brio_status status;
    brio_surface_stats stats = {.size = sizeof stats};
    brio_mesh *mesh = NULL;
    PyObject *result = NULL;
    int triangulate = 0;
    brio_surface_options o = {.size = sizeof o};
    uint32_t tiles = 0;
    experiment tried = {0, 0};
    const surface_option all[] = {{{"seed", SEED, &o.seed}, NULL},
                                  {{"noise", INT, &o.noise}, "noise"},
                                  {{"open", DOUBLE, &o.open}, "open"},
                                  {{"holes", INT, &o.holes}, "holes"},
                                  {{"simplify", INT, &o.simplify}, "simplify"},
                                  {{"confidence", INT, &o.confidence}, "confidence"},
                                  {{"triangulate", INT, &triangulate}, "polygons"},
                                  {{"labeling", INT, &tried.labeling}, "poles.labeling"},
                                  {{"sampling_density", DOUBLE, &o.poles.sampling_density}, "poles.sampling_density"},
                                  {{"sharp", INT, &o.poles.sharp}, "poles.sharp"},
                                  {{"theta", DOUBLE, &o.theta}, "theta"},
                                  {{"boundaries", INT, &o.boundaries}, "boundaries"},
                                  {{"density", INT, &o.density}, "density"},
                                  {{"pieces", SIZE, &o.pieces}, "pieces"},
                                  {{"tiles", COUNT, &tiles}, "tiles"},
                                  {{"extraction", INT, &tried.extraction}, "pieces"},
                                  {{NULL, INT, NULL}, NULL}};
    option table[sizeof all / sizeof *all];
    PyObject *options = PyTuple_Size(args) > 1 ? PyTuple_GetItem(args, 1) : NULL;
    if (!options || !PyDict_Check(options))
        return PyErr_Format(PyExc_TypeError, "surface: options in a dict are wanted");
    const brio_surface_method_info *method = take_method(options);
    if (!method) return NULL;
    int own = method->traits & BRIO_METHOD_OWN_VERTICES;
    choose_options(all, method, table);
    if (!open_surface_call(&s, args, input_open, own ? 'd' : 'I', own ? 3 : 0) &&
        !open_evidence(&e, s.options, s.p.rows)) {
        o.method = method->method;
        o.distance = s.number;
        o.normals = own ? s.out.data : NULL;
        if (e.taken.normals || e.taken.origins) o.evidence = &e.taken;
        RUN_SURFACE(table, (o.polygons = brio_surface_method_has(o.method, "polygons") && !triangulate && !o.simplify,
                            make_surface(&c, &s, &o, &tried, tiles, own ? NULL : s.out.data, &mesh, &stats)));
    }
    close_evidence(&e);
    close_surface_call(&s);
    return result ? Py_BuildValue("NN", result, report_of(&stats)) : NULL;
}

/* surface_methods(): a list of tuples: name, number, options, traits. */
static PyObject *list_surface_methods(PyObject *module, PyObject *args) {
    PyObject *list = PyList_New(0);
    (void)module, (void)args;
    for (int m = 0; list && m < BRIO_SURFACE_END; m++) {
        const brio_surface_method_info *i = brio_surface_method_facts((brio_surface_method)m);
        PyObject *row = Py_BuildValue("sisI", i->name, m, i->options, i->traits);
        if (!row || PyList_Append(list, row)) Py_CLEAR(list);
        Py_XDECREF(row);
    }
    return list;
}

/* The options of medial axes: those of the power shape, and those of the Voronoi facets where `voronoi` is not 0. */
typedef struct {
    brio_power_shape_options shape;
    brio_voronoi_axis_options axis;
    experiment tried;
    int voronoi;
} axis_options;

#define AXIS_OPTIONS(o)                                                                                                \
    POLE_OPTIONS((o).shape), {"labeling", INT, &(o).tried.labeling}, {"sides", INT, &(o).shape.sides},                 \
        {"scale", DOUBLE, &(o).shape.scale}, {"redundancy", DOUBLE, &(o).shape.redundancy},                            \
        {"scale_axis", DOUBLE, &(o).shape.scale_axis}, {"theta", DOUBLE, &(o).axis.theta},                             \
        {"rho", DOUBLE, &(o).axis.rho}, {                                                                              \
        "voronoi", INT, &(o).voronoi                                                                                   \
    }

static brio_status make_axis(brio_context *ctx, const double *points, size_t n, axis_options *o, brio_mesh **out) {
    if (!o->voronoi) {
        brio_laboratory *lab;
        brio_status status = begin_experiment(ctx, &o->tried, &o->shape.poles, &lab);
        if (status == BRIO_OK) status = brio_power_shape(ctx, points, n, &o->shape, out, NULL, NULL);
        brio_laboratory_free(lab);
        return status;
    }
    o->axis.noise = o->shape.noise;
    o->axis.sides = o->shape.sides;
    o->axis.seed = o->shape.seed;
    o->axis.solid = o->shape.poles.solid;
    return brio_voronoi_axis(ctx, points, n, &o->axis, out, NULL);
}

static PyObject *power_shape(PyObject *module, PyObject *args) {
    surface_call s;
    call c;
    brio_status status;
    brio_mesh *mesh = NULL;
    PyObject *result = NULL;
    axis_options o = {.shape = {.size = sizeof o.shape}, .axis = {.size = sizeof o.axis}};
    const option table[] = {AXIS_OPTIONS(o), {NULL, INT, NULL}};
    if (!open_surface_call(&s, args, input_open, 'd', 3))
        RUN_SURFACE(table, make_axis(c.ctx, s.p.data, s.p.rows, &o, &mesh));
    close_surface_call(&s);
    return result;
}

static PyObject *curve(PyObject *module, PyObject *args) {
    surface_call s;
    call c;
    brio_status status;
    brio_mesh *mesh = NULL;
    PyObject *result = NULL;
    brio_curve_options o = {0};
    const option table[] = {{"open", DOUBLE, &o.open}, {"closed", INT, &o.closed}, {NULL, INT, NULL}};
    if (!open_surface_call(&s, args, input_open, 'd', 3))
        RUN_SURFACE(table, brio_curve(c.ctx, s.p.data, s.p.rows, &o, &mesh, NULL));
    close_surface_call(&s);
    return result;
}

static PyObject *spanning_tree(PyObject *module, PyObject *args) {
    surface_call s;
    call c;
    brio_status status;
    brio_mesh *mesh = NULL;
    PyObject *result = NULL;
    const option table[] = {{NULL, INT, NULL}};
    if (!open_surface_call(&s, args, input_open, 'd', 3))
        RUN_SURFACE(table, brio_spanning_tree(c.ctx, s.p.data, s.p.rows, &mesh, NULL));
    close_surface_call(&s);
    return result;
}

static PyObject *planar_crust(PyObject *module, PyObject *args) {
    surface_call s;
    call c;
    brio_status status;
    brio_mesh *mesh = NULL;
    PyObject *result = NULL;
    const option table[] = {{NULL, INT, NULL}};
    if (!open_surface_call(&s, args, input_open, 'd', 3))
        RUN_SURFACE(table, brio_planar_crust(c.ctx, s.p.data, s.p.rows, &mesh, NULL, NULL));
    close_surface_call(&s);
    return result;
}

/* Of options: polygons. The extra array receives the point of each vertex. */
static PyObject *convex_hull(PyObject *module, PyObject *args) {
    surface_call s;
    call c;
    brio_status status;
    brio_mesh *mesh = NULL;
    PyObject *result = NULL;
    brio_convex_hull_options o = {0};
    const option table[] = {{"polygons", INT, &o.polygons}, {NULL, INT, NULL}};
    if (!open_surface_call(&s, args, input_borrow, 'I', 0)) {
        o.samples = s.out.data;
        RUN_SURFACE(table, brio_convex_hull(c.ctx, s.p.data, s.p.rows, &o, &mesh, NULL));
    }
    close_surface_call(&s);
    return result;
}

/* --- closed meshes --- */

/* mesh_offset(mesh, distance, error, threads, progress): a mesh. */
static PyObject *mesh_offset(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    double distance;
    int threads;
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    brio_mesh_offset_options o = {0};
    if (!PyArg_ParseTuple(args, "OddiO", &object, &distance, &o.error, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_mesh_offset(c.ctx, m, distance, &o, &made, NULL));
    return call_end_with_mesh(&c, status, made);
}

/* The power shape of samples of a mesh's faces, whose labels the mesh gives. */
static brio_status shape_of_mesh(brio_context *ctx, const brio_mesh *m, double spacing, axis_options *o,
                                 brio_mesh **out) {
    brio_mesh *samples = NULL;
    brio_status status = brio_mesh_samples(ctx, m, spacing, &samples);
    o->shape.poles.solid = m;
    if (status == BRIO_OK) status = make_axis(ctx, samples->vertices, samples->num_vertices, o, out);
    brio_mesh_free(samples);
    return status;
}

/* mesh_shape(mesh, spacing, options, threads, progress): a mesh. */
static PyObject *mesh_shape(PyObject *module, PyObject *args) {
    PyObject *object, *options, *progress;
    double spacing;
    int threads;
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    axis_options o = {.shape = {.size = sizeof o.shape}, .axis = {.size = sizeof o.axis}};
    const option table[] = {AXIS_OPTIONS(o), {NULL, INT, NULL}};
    if (!PyArg_ParseTuple(args, "OdO!iO", &object, &spacing, &PyDict_Type, &options, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || set_options(state_of(module), table, options) || call_begin(&c, state_of(module), threads, progress))
        return NULL;
    CALL(c, status, shape_of_mesh(c.ctx, m, spacing, &o, &made));
    return call_end_with_mesh(&c, status, made);
}

/* --- unions of balls --- */

/* ball_union(centres, weights, areas, error, threads, progress): a mesh, and what was measured as a dict. */
static PyObject *ball_union(PyObject *module, PyObject *args) {
    PyObject *centres, *weights, *areas, *progress, *mesh = NULL;
    brio_ball_union_options o = {.size = sizeof o};
    brio_ball_union_stats s = {.size = sizeof s};
    brio_mesh *made = NULL;
    brio_status status;
    int threads;
    input p, w = {.held = 0}, a = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOOdiO", &centres, &weights, &areas, &o.error, &threads, &progress)) return NULL;
    if (input_open(&p, centres, "centres", 'd', 3)) return NULL;
    if (!input_open(&w, weights, "radii", 'd', 0) && !input_has_rows(&w, "radii", p.rows) &&
        !output_open(&a, areas, "areas", 'd', 0) && !input_has_rows(&a, "areas", p.rows) &&
        !call_begin(&c, state_of(module), threads, progress)) {
        CALL(c, status, brio_ball_union(c.ctx, p.data, w.data, p.rows, &o, a.data, &made, &s));
        mesh = call_end_with_mesh(&c, status, made);
    }
    input_close(&p);
    input_close(&w);
    input_close(&a);
    return mesh ? Py_BuildValue("N{sdsdsnsnsnsn}", mesh, "volume", s.volume, "area", s.area, "components",
                                (Py_ssize_t)s.components, "tunnels", (Py_ssize_t)s.tunnels, "voids",
                                (Py_ssize_t)s.voids, "exposed", (Py_ssize_t)s.exposed)
                : NULL;
}

/* --- normals --- */

/* point_normals(points, mesh, samples or None, out, threads, progress) */
static PyObject *point_normals(PyObject *module, PyObject *args) {
    PyObject *points, *object, *samples, *array, *progress;
    int threads, failed = -1;
    input p, out = {.held = 0}, of = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOOOiO", &points, &object, &samples, &array, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || input_open(&p, points, "points", 'd', 3)) return NULL;
    size_t rows = samples == Py_None ? p.rows : m->num_vertices; /* without samples, vertex v is point v */
    if (!output_open(&out, array, "out", 'd', 3) && !input_has_rows(&out, "out", p.rows) &&
        (samples == Py_None ||
         (!input_open(&of, samples, "samples", 'I', 0) && !input_has_rows(&of, "samples", rows))) &&
        !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        CALL(c, status, brio_point_normals(c.ctx, p.data, p.rows, m, of.data, out.data));
        failed = call_end(&c, status);
    }
    input_close(&p);
    input_close(&out);
    input_close(&of);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

#define SURFACE(name, what)                                                                                            \
    { #name, name, METH_VARARGS, #name "(points, options, number, out, threads, progress): " what }

PyMethodDef surface_methods[] = {
    SURFACE(surface,
            "a mesh and a report; number: the distance; out: the sample of each vertex, or normals of the points."),
    SURFACE(power_shape, "a mesh."),
    SURFACE(curve, "a mesh of edges."),
    SURFACE(spanning_tree, "a mesh of edges."),
    SURFACE(planar_crust, "a mesh of edges."),
    SURFACE(convex_hull, "a mesh; out: the point of each vertex."),
    {"surface_methods", list_surface_methods, METH_NOARGS,
     "surface_methods(): tuples of name, number, options, traits"},
    {"mesh_offset", mesh_offset, METH_VARARGS, "mesh_offset(mesh, distance, error, threads, progress)"},
    {"mesh_shape", mesh_shape, METH_VARARGS, "mesh_shape(mesh, spacing, options, threads, progress)"},
    {"ball_union", ball_union, METH_VARARGS, "ball_union(centres, weights, areas, error, threads, progress)"},
    {"point_normals", point_normals, METH_VARARGS, "point_normals(points, mesh, samples, out, threads, progress)"},
    {NULL, NULL, 0, NULL},
};
