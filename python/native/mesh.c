/* Meshes: made of arrays, shown as arrays, certified, and changed. */
#include "mesh.h"
#include <string.h>

static void free_mesh(void *mesh) {
    brio_mesh_free(mesh);
}

PyObject *call_end_with_mesh(call *c, brio_status status, brio_mesh *mesh) {
    return call_end_with(c, status, KIND_MESH, mesh, free_mesh, NULL);
}

/* --- properties --- */

static const char letters[] = {'b', 'B', 'h', 'H', 'i', 'I', 'f', 'd'};

/* What properties are of. */
typedef struct {
    const char *name;
    brio_status (*add)(brio_mesh *mesh, const char *name, brio_scalar type, void **data);
} owner;

static const owner of_vertices = {"vertex", brio_mesh_add_property}, of_faces = {"face", brio_mesh_add_face_property};

/* Adds a property of one number for each of `count`, an array of one dimension. */
static brio_status add_property(brio_mesh *mesh, const owner *of, size_t count, const char *name, PyObject *array) {
    Py_buffer view;
    void *data;
    brio_status status = BRIO_ERR_ARGUMENT;
    if (PyObject_GetBuffer(array, &view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT)) return status;
    int type = 0;
    while (type < BRIO_SCALAR_END && !is_of_format(&view, letters[type])) type++;
    if (type == BRIO_SCALAR_END || view.ndim != 1 || (size_t)view.shape[0] != count)
        PyErr_Format(PyExc_ValueError, "property %s: not one number a %s, of a type of at most 32 bits or float64",
                     name, of->name);
    else if ((status = of->add(mesh, name, (brio_scalar)type, &data)) == BRIO_OK && view.len)
        memcpy(data, view.buf, (size_t)view.len);
    PyBuffer_Release(&view);
    return status;
}

static brio_status add_properties(brio_mesh *mesh, const owner *of, size_t count, PyObject *properties) {
    PyObject *name, *array;
    Py_ssize_t at = 0;
    brio_status status = BRIO_OK;
    while (status == BRIO_OK && PyDict_Next(properties, &at, &name, &array)) {
        const char *text = PyUnicode_AsUTF8AndSize(name, NULL);
        status = text ? add_property(mesh, of, count, text, array) : BRIO_ERR_ARGUMENT;
    }
    return status;
}

/* --- made of arrays --- */

typedef struct {
    input vertices, offsets, corners, tetrahedra, edges, steps;
} mesh_arrays;

static void close_arrays(mesh_arrays *a) {
    input_close(&a->vertices);
    input_close(&a->offsets);
    input_close(&a->corners);
    input_close(&a->tetrahedra);
    input_close(&a->edges);
    input_close(&a->steps);
}

static int maybe_open(input *in, PyObject *object, const char *name, char format, int columns) {
    return object == Py_None ? 0 : input_open(in, object, name, format, columns);
}

/* The library takes offsets on trust; here they come from anybody. */
static int offsets_are_sound(const mesh_arrays *a) {
    const uint64_t *offset = a->offsets.data;
    if (!a->offsets.data) return 1;
    int sound = a->offsets.rows && offset[0] == 0;
    for (size_t f = 1; sound && f < a->offsets.rows; f++) sound = offset[f - 1] <= offset[f];
    if (sound && a->corners.data && offset[a->offsets.rows - 1] == a->corners.rows) return 1;
    PyErr_SetString(PyExc_ValueError, "face_offsets: should rise from 0 to the number of face_vertices");
    return 0;
}

static brio_status set_arrays(brio_mesh *mesh, const mesh_arrays *a) {
    brio_status status = brio_mesh_set_vertices(mesh, a->vertices.data, a->vertices.rows);
    if (status == BRIO_OK && a->offsets.data)
        status = brio_mesh_set_faces(mesh, a->offsets.data, a->corners.data, a->offsets.rows - 1);
    if (status == BRIO_OK && a->tetrahedra.data)
        status = brio_mesh_set_tetrahedra(mesh, a->tetrahedra.data, 4, a->tetrahedra.rows);
    if (status == BRIO_OK && a->edges.data) status = brio_mesh_set_edges(mesh, a->edges.data, a->edges.rows);
    if (status == BRIO_OK && a->steps.data) {
        const double *steps = a->steps.data;
        memcpy(mesh->coordinate_step, steps, sizeof mesh->coordinate_step);
        memcpy(mesh->coordinate_origin, steps + 3, sizeof mesh->coordinate_origin);
    }
    return status;
}

/* Opens the steps and the origin of the coordinates, what a LAS file says of them. */
static int open_steps(input *in, PyObject *steps) {
    return maybe_open(in, steps, "steps", 'd', 3) || (in->data && input_has_rows(in, "steps", 2)) ? -1 : 0;
}

/* mesh(vertices, offsets, corners, tetrahedra, edges, properties, steps, face_properties): a mesh of copies; None for an
 * absent part. */
static PyObject *mesh(PyObject *module, PyObject *args) {
    PyObject *vertices, *offsets, *corners, *tetrahedra, *edges, *properties, *steps, *of_face, *result = NULL;
    mesh_arrays a = {{.held = 0}, {.held = 0}, {.held = 0}, {.held = 0}, {.held = 0}, {.held = 0}};
    call c;
    if (!PyArg_ParseTuple(args, "OOOOOOOO", &vertices, &offsets, &corners, &tetrahedra, &edges, &properties, &steps,
                          &of_face))
        return NULL;
    if (!PyDict_Check(properties) || !PyDict_Check(of_face)) {
        PyErr_SetString(PyExc_TypeError, "properties: a dict of arrays");
        return NULL;
    }
    if (!input_open(&a.vertices, vertices, "vertices", 'd', 3) &&
        !maybe_open(&a.offsets, offsets, "face_offsets", 'L', 0) &&
        !maybe_open(&a.corners, corners, "face_vertices", 'I', 0) &&
        !maybe_open(&a.tetrahedra, tetrahedra, "tetrahedra", 'I', 4) && !maybe_open(&a.edges, edges, "edges", 'I', 2) &&
        !open_steps(&a.steps, steps) && offsets_are_sound(&a) && !call_begin(&c, state_of(module), 1, Py_None)) {
        brio_mesh *made = NULL;
        brio_status status = brio_mesh_new(c.ctx, &made);
        if (status == BRIO_OK) status = set_arrays(made, &a);
        if (status == BRIO_OK) status = add_properties(made, &of_vertices, made->num_vertices, properties);
        if (status == BRIO_OK) status = add_properties(made, &of_faces, made->num_faces, of_face);
        result = call_end_with_mesh(&c, status, made);
    }
    close_arrays(&a);
    return result;
}

/* --- shown as arrays --- */

static PyObject *property_views(module_state *state, PyObject *mesh_object, const brio_property *list, size_t count,
                                size_t rows) {
    PyObject *dict = PyDict_New();
    for (size_t k = 0; dict && k < count; k++) {
        const brio_property *p = &list[k];
        PyObject *view = array_new(state, mesh_object, layout_of(p->data, letters[p->type], rows, 0));
        PyObject *name = view ? PyUnicode_DecodeUTF8(p->name, (Py_ssize_t)strlen(p->name), "replace") : NULL;
        if (!name || PyDict_SetItem(dict, name, view)) Py_CLEAR(dict);
        Py_XDECREF(name);
        Py_XDECREF(view);
    }
    return dict;
}

/* The cell of a file of atoms: the nine numbers of its vectors, and 1 for each that repeats; or None. */
static PyObject *cell_view(const brio_mesh *m) {
    double c[9];
    int open[3];
    if (!brio_mesh_cell(m, c, open)) Py_RETURN_NONE;
    return Py_BuildValue("((ddddddddd)(iii))", c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], !open[0], !open[1],
                         !open[2]);
}

static PyObject *mesh_views(PyObject *module, PyObject *object) {
    module_state *state = state_of(module);
    const brio_mesh *m = handle_object(state, object, KIND_MESH);
    if (!m) return NULL;
    size_t corners = m->num_faces ? m->face_offsets[m->num_faces] : 0;
#define VIEW(name, format, rows, columns) #name, array_new(state, object, layout_of(m->name, format, rows, columns))
    return Py_BuildValue(
        "{s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N}", "cell", cell_view(m), VIEW(vertices, 'd', m->num_vertices, 3),
        VIEW(face_offsets, 'L', m->face_offsets ? m->num_faces + 1 : 1, 0), VIEW(face_vertices, 'I', corners, 0),
        VIEW(tetrahedra, 'I', m->num_tetrahedra, 4), VIEW(edges, 'I', m->num_edges, 2),
        VIEW(coordinate_step, 'd', 3, 0), VIEW(coordinate_origin, 'd', 3, 0), "properties",
        property_views(state, object, m->properties, m->num_properties, m->num_vertices), "face_properties",
        property_views(state, object, m->face_properties, m->num_face_properties, m->num_faces));
#undef VIEW
}

/* --- what is computed of a mesh --- */

/* Copies the vertices and polygons of a mesh, and adds normals. */
static brio_status with_normals(brio_context *ctx, const brio_mesh *m, brio_mesh **out) {
    brio_status status = brio_mesh_new(ctx, out);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(*out, m->vertices, m->num_vertices);
    if (status == BRIO_OK && m->face_offsets)
        status = brio_mesh_set_faces(*out, m->face_offsets, m->face_vertices, m->num_faces);
    return status == BRIO_OK ? brio_mesh_add_normals(*out) : status;
}

/* A mesh of the same vertices and polygons with the properties nx, ny, nz. */
static PyObject *mesh_with_normals(PyObject *module, PyObject *object) {
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, with_normals(c.ctx, m, &made));
    return call_end_with_mesh(&c, status, made);
}

static brio_status copy_properties(brio_mesh *to, const owner *of, const brio_property *list, size_t count,
                                   size_t rows) {
    brio_status status = BRIO_OK;
    for (size_t i = 0; status == BRIO_OK && i < count; i++) {
        void *data;
        status = of->add(to, list[i].name, list[i].type, &data);
        if (status == BRIO_OK && rows) memcpy(data, list[i].data, rows * brio_scalar_size(list[i].type));
    }
    return status;
}

/* Copies what a mesh holds, except for tetrahedra and edges. */
static brio_status copy_surface(brio_context *ctx, const brio_mesh *m, brio_mesh **out) {
    brio_status status = brio_mesh_new(ctx, out);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(*out, m->vertices, m->num_vertices);
    if (status == BRIO_OK && m->num_faces)
        status = brio_mesh_set_faces(*out, m->face_offsets, m->face_vertices, m->num_faces);
    if (status == BRIO_OK)
        status = copy_properties(*out, &of_vertices, m->properties, m->num_properties, m->num_vertices);
    if (status == BRIO_OK)
        status = copy_properties(*out, &of_faces, m->face_properties, m->num_face_properties, m->num_faces);
    return status;
}

/* Returns a simplified copy, which is freed if that fails. */
static brio_status simplified(brio_context *ctx, const brio_mesh *m, const brio_mesh_simplify_options *o,
                              brio_mesh **out) {
    brio_status status = copy_surface(ctx, m, out);
    if (status == BRIO_OK) status = brio_mesh_simplify(ctx, *out, o);
    if (status == BRIO_OK) return status;
    brio_mesh_free(*out);
    *out = NULL;
    return status;
}

/* mesh_simplified(mesh, faces, tolerance, progress): a mesh of fewer triangles. */
static PyObject *mesh_simplified(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    Py_ssize_t faces;
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    brio_mesh_simplify_options o = {0};
    if (!PyArg_ParseTuple(args, "OndO", &object, &faces, &o.tolerance, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), 0, progress)) return NULL;
    o.target_faces = (size_t)faces;
    CALL(c, status, simplified(c.ctx, m, &o, &made));
    return call_end_with_mesh(&c, status, made);
}

/* Returns a copy of the components that are wanted, which is freed if that fails. */
static brio_status kept_components(brio_context *ctx, const brio_mesh *m, int largest, size_t least, brio_mesh **out) {
    brio_status status = copy_surface(ctx, m, out);
    if (status == BRIO_OK) status = brio_mesh_keep_components(*out, largest, least, NULL, NULL);
    if (status == BRIO_OK) return status;
    brio_mesh_free(*out);
    *out = NULL;
    return status;
}

/* mesh_kept_components(mesh, largest, least_faces): a mesh of fewer components. */
static PyObject *mesh_kept_components(PyObject *module, PyObject *args) {
    PyObject *object;
    int largest;
    Py_ssize_t least;
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    if (!PyArg_ParseTuple(args, "Opn", &object, &largest, &least)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, kept_components(c.ctx, m, largest, (size_t)least, &made));
    return call_end_with_mesh(&c, status, made);
}

/* Returns a copy whose vertices are merged, tetrahedra and edges included; it is freed if that fails. */
static brio_status merged_vertices(brio_context *ctx, const brio_mesh *m, double distance, brio_mesh **out) {
    brio_status status = copy_surface(ctx, m, out);
    if (status == BRIO_OK && m->num_tetrahedra)
        status = brio_mesh_set_tetrahedra(*out, m->tetrahedra, 4, m->num_tetrahedra);
    if (status == BRIO_OK && m->num_edges) status = brio_mesh_set_edges(*out, m->edges, m->num_edges);
    if (status == BRIO_OK) status = brio_mesh_merge_vertices(*out, distance, NULL);
    if (status == BRIO_OK) return status;
    brio_mesh_free(*out);
    *out = NULL;
    return status;
}

/* mesh_merged_vertices(mesh, distance, progress): a mesh of fewer vertices. */
static PyObject *mesh_merged_vertices(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    double distance;
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    if (!PyArg_ParseTuple(args, "OdO", &object, &distance, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), 0, progress)) return NULL;
    CALL(c, status, merged_vertices(c.ctx, m, distance, &made));
    return call_end_with_mesh(&c, status, made);
}

/* mesh_subdivided(mesh, levels, progress): a mesh whose triangles are cut into four, `levels` times. */
static PyObject *mesh_subdivided(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    int levels;
    call c;
    brio_mesh *made = NULL;
    brio_status status;
    if (!PyArg_ParseTuple(args, "OiO", &object, &levels, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), 0, progress)) return NULL;
    CALL(c, status, brio_mesh_subdivide(c.ctx, m, levels, &made));
    return call_end_with_mesh(&c, status, made);
}

static PyObject *certificate_dict(const brio_certificate *k) {
    PyObject *genera = PyList_New((Py_ssize_t)k->components);
    for (size_t n = 0; genera && n < k->components; n++)
        PyList_SetItem(genera, (Py_ssize_t)n, PyLong_FromLongLong(k->genera[n]));
#define COUNT(name) #name, (Py_ssize_t)k->name
    return Py_BuildValue("{s:N,s:N,s:N,s:n,s:n,s:N,s:n,s:n,s:n,s:n,s:n,s:d,s:d}", "closed", PyBool_FromLong(k->closed),
                         "manifold", PyBool_FromLong(k->manifold), "oriented", PyBool_FromLong(k->oriented),
                         COUNT(components), COUNT(genus), "genera", genera, COUNT(boundary_edges),
                         COUNT(boundary_loops), COUNT(nonmanifold_edges), COUNT(nonmanifold_vertices),
                         COUNT(flipped_edges), "area", k->area, "volume", k->volume);
#undef COUNT
}

static PyObject *mesh_certificate(PyObject *module, PyObject *object) {
    call c;
    brio_status status;
    brio_certificate k = {0};
    PyObject *result = NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, brio_mesh_certificate(c.ctx, m, &k));
    if (status == BRIO_OK) result = certificate_dict(&k);
    brio_certificate_free(&k);
    if (call_end(&c, status)) Py_CLEAR(result);
    return result;
}

/* mesh_self_intersections(mesh, threads, progress): the number of pairs of faces. */
static PyObject *mesh_self_intersections(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    int threads;
    call c;
    brio_status status;
    int64_t pairs = 0;
    if (!PyArg_ParseTuple(args, "OiO", &object, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (!m || call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_mesh_self_intersections(c.ctx, m, &pairs));
    return call_end(&c, status) ? NULL : PyLong_FromLongLong(pairs);
}

/* mesh_distance(a, b, samples, seed, threads, progress): a dict. */
static PyObject *mesh_distance(PyObject *module, PyObject *args) {
    PyObject *first, *second, *progress;
    int threads;
    Py_ssize_t samples;
    unsigned long long seed;
    call c;
    brio_status status;
    brio_distance d = {0};
    if (!PyArg_ParseTuple(args, "OOnKiO", &first, &second, &samples, &seed, &threads, &progress)) return NULL;
    const brio_mesh *a = handle_object(state_of(module), first, KIND_MESH);
    const brio_mesh *b = a ? handle_object(state_of(module), second, KIND_MESH) : NULL;
    if (!b || call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_mesh_distance(c.ctx, a, b, (size_t)samples, seed, &d));
    if (call_end(&c, status)) return NULL;
    return Py_BuildValue("{s:d,s:d,s:d,s:d,s:d,s:d}", "mean", d.mean, "rms", d.rms, "p95", d.p95, "hausdorff",
                         d.hausdorff, "normal_consistency", d.normal_consistency, "diagonal", d.diagonal);
}

/* mesh_signed_distances(mesh, points, out, threads, progress): writes a distance a point. */
static PyObject *mesh_signed_distances(PyObject *module, PyObject *args) {
    PyObject *object, *points, *out, *progress, *result = NULL;
    int threads;
    call c;
    brio_status status;
    input p = {.held = 0}, distance = {.held = 0};
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &out, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (m && !input_open(&p, points, "points", 'd', 3) && !output_open(&distance, out, "out", 'd', 0) &&
        !input_has_rows(&distance, "out", p.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        CALL(c, status, brio_mesh_signed_distances(c.ctx, m, p.data, p.rows, distance.data));
        if (!call_end(&c, status)) result = Py_NewRef(Py_None);
    }
    input_close(&p);
    input_close(&distance);
    return result;
}

/* mesh_coverage(mesh, points, bridge, threads, progress): a dict; writes whether each face is of a bridge. */
static PyObject *mesh_coverage(PyObject *module, PyObject *args) {
    PyObject *object, *points, *out, *progress, *result = NULL;
    int threads;
    call c;
    brio_status status;
    brio_coverage k = {.size = sizeof k};
    input p = {.held = 0}, bridge = {.held = 0};
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &out, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (m && !input_open(&p, points, "points", 'd', 3) && !output_open(&bridge, out, "out", 'B', 0) &&
        !input_has_rows(&bridge, "out", m->num_faces) && !call_begin(&c, state_of(module), threads, progress)) {
        CALL(c, status, brio_mesh_coverage(c.ctx, m, p.data, p.rows, bridge.data, &k));
        if (!call_end(&c, status))
            result = Py_BuildValue("{s:d,s:n,s:d,s:d,s:(ddd),s:n}", "far_share", k.far_share, "bridges",
                                   (Py_ssize_t)k.bridges, "bridge_share", k.bridge_share, "bridge_radius",
                                   k.bridge_radius, "bridge_centre", k.bridge_centre[0], k.bridge_centre[1],
                                   k.bridge_centre[2], "left_out", (Py_ssize_t)k.left_out);
    }
    input_close(&p);
    input_close(&bridge);
    return result;
}

/* mesh_left_out(mesh, points, out, threads, progress): writes whether the surface leaves each point. */
static PyObject *mesh_left_out(PyObject *module, PyObject *args) {
    PyObject *object, *points, *out, *progress, *result = NULL;
    int threads;
    call c;
    brio_status status;
    size_t count;
    input p = {.held = 0}, chosen = {.held = 0};
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &out, &threads, &progress)) return NULL;
    const brio_mesh *m = handle_object(state_of(module), object, KIND_MESH);
    if (m && !input_open(&p, points, "points", 'd', 3) && !output_open(&chosen, out, "out", 'B', 0) &&
        !input_has_rows(&chosen, "out", p.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        CALL(c, status, brio_mesh_left_out(c.ctx, m, p.data, p.rows, chosen.data, &count));
        if (!call_end(&c, status)) result = Py_NewRef(Py_None);
    }
    input_close(&p);
    input_close(&chosen);
    return result;
}

PyMethodDef mesh_methods[] = {
    {"mesh", mesh, METH_VARARGS,
     "mesh(vertices, offsets, corners, tetrahedra, edges, properties, steps, face_properties)"},
    {"mesh_views", mesh_views, METH_O, "The arrays of a mesh, in a dict."},
    {"mesh_with_normals", mesh_with_normals, METH_O, "The same surface with the properties nx, ny, nz."},
    {"mesh_simplified", mesh_simplified, METH_VARARGS, "mesh_simplified(mesh, faces, tolerance, progress)"},
    {"mesh_certificate", mesh_certificate, METH_O, "What the connectivity says, in a dict."},
    {"mesh_self_intersections", mesh_self_intersections, METH_VARARGS,
     "mesh_self_intersections(mesh, threads, progress)"},
    {"mesh_distance", mesh_distance, METH_VARARGS, "mesh_distance(a, b, samples, seed, threads, progress)"},
    {"mesh_signed_distances", mesh_signed_distances, METH_VARARGS,
     "mesh_signed_distances(mesh, points, out, threads, progress)"},
    {"mesh_coverage", mesh_coverage, METH_VARARGS, "mesh_coverage(mesh, points, bridge, threads, progress)"},
    {"mesh_left_out", mesh_left_out, METH_VARARGS, "mesh_left_out(mesh, points, out, threads, progress)"},
    {"mesh_merged_vertices", mesh_merged_vertices, METH_VARARGS, "mesh_merged_vertices(mesh, distance, progress)"},
    {"mesh_kept_components", mesh_kept_components, METH_VARARGS, "mesh_kept_components(mesh, largest, least_faces)"},
    {"mesh_subdivided", mesh_subdivided, METH_VARARGS, "mesh_subdivided(mesh, levels, progress)"},
    {NULL, NULL, 0, NULL},
};
