/* brio as a module of WebAssembly: what brio.mjs calls. A call takes and gives addresses; brio.mjs turns them into arrays.
 *
 * A function that returns int returns a brio_status. Arrays of `parts` receive counts and addresses, arrays of `facts`
 * numbers, in the order that the function says. What a call makes stays until its _free. */
#include <brio/brio.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT(name) __attribute__((export_name(#name), visibility("default")))
#define ADDRESS(of)  ((uint32_t)(uintptr_t)(of))

/* Asks JavaScript whether to stop. */
__attribute__((import_module("brio"), import_name("progress"))) int brio_js_progress(const char *stage, double share);

static int on_progress(const char *stage, double share, void *user) {
    (void)user;
    return brio_js_progress(stage, share);
}

EXPORT(allocate) void *module_allocate(size_t size) {
    return malloc(size ? size : 1);
}

EXPORT(release) void module_release(void *block) {
    free(block);
}

EXPORT(version) const char *module_version(void) {
    return brio_version();
}

EXPORT(context) brio_context *module_context(void) {
    brio_context *ctx = NULL;
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return NULL;
    brio_context_set_progress(ctx, on_progress, NULL);
    return ctx;
}

EXPORT(message) const char *module_message(const brio_context *ctx) {
    return brio_message(ctx);
}

/* Lists extensions that are read, or written; of formats that hold all of `holds`. */
EXPORT(formats) const char *module_formats(int written, unsigned holds) {
    static char list[BRIO_FORMAT_LIST];
    brio_format_list(written, holds, list, sizeof list);
    return list;
}

/* --- triangulations --- */

EXPORT(delaunay)
int module_delaunay(brio_context *ctx, const double *points, const double *weights, size_t count,
                    brio_triangulation **out) {
    return brio_delaunay(ctx, points, weights, count, NULL, out);
}

/* Gives the finite tetrahedra and those of the hull, their address (of records of 8 numbers), the address of the
 * representatives; then the points, vertices, duplicates and hidden points, and the dimension. */
EXPORT(triangulation_parts) void module_triangulation_parts(const brio_triangulation *t, uint32_t parts[9]) {
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    const uint32_t found[9] = {(uint32_t)s->tetrahedra,
                               (uint32_t)s->hull_facets,
                               ADDRESS(brio_triangulation_tetrahedra(t)),
                               ADDRESS(brio_triangulation_representatives(t)),
                               (uint32_t)s->points,
                               (uint32_t)s->vertices,
                               (uint32_t)s->duplicates,
                               (uint32_t)s->hidden,
                               (uint32_t)s->dimension};
    memcpy(parts, found, sizeof found);
}

EXPORT(triangulation_checksum)
int module_triangulation_checksum(brio_context *ctx, const brio_triangulation *t, const double *points,
                                  uint64_t *checksum) {
    return brio_triangulation_checksum(ctx, t, points, checksum);
}

EXPORT(triangulation_check)
int module_triangulation_check(brio_context *ctx, const brio_triangulation *t, const double *points,
                               const double *weights, size_t count) {
    return brio_triangulation_check(ctx, t, points, weights, count);
}

EXPORT(triangulation_free) void module_triangulation_free(brio_triangulation *t) {
    brio_triangulation_free(t);
}

EXPORT(delaunay2)
int module_delaunay2(brio_context *ctx, const double *points, const double *weights, size_t count,
                     brio_triangulation2 **out) {
    return brio_delaunay2(ctx, points, weights, count, NULL, out);
}

/* As triangulation_parts, of triangles in records of 6 numbers. */
EXPORT(triangulation2_parts) void module_triangulation2_parts(const brio_triangulation2 *t, uint32_t parts[9]) {
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    const uint32_t found[9] = {(uint32_t)s->triangles,
                               (uint32_t)s->hull_edges,
                               ADDRESS(brio_triangulation2_triangles(t)),
                               ADDRESS(brio_triangulation2_representatives(t)),
                               (uint32_t)s->points,
                               (uint32_t)s->vertices,
                               (uint32_t)s->duplicates,
                               (uint32_t)s->hidden,
                               (uint32_t)s->dimension};
    memcpy(parts, found, sizeof found);
}

EXPORT(triangulation2_checksum)
int module_triangulation2_checksum(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                   uint64_t *checksum) {
    return brio_triangulation2_checksum(ctx, t, points, checksum);
}

EXPORT(triangulation2_check)
int module_triangulation2_check(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                const double *weights, size_t count) {
    return brio_triangulation2_check(ctx, t, points, weights, count);
}

EXPORT(triangulation2_free) void module_triangulation2_free(brio_triangulation2 *t) {
    brio_triangulation2_free(t);
}

/* --- alpha shapes --- */

EXPORT(alpha_values)
int module_alpha_values(brio_context *ctx, const brio_triangulation *t, const double *points, const double *weights,
                        size_t count, brio_alpha_complex **out) {
    brio_alpha_complex *made = calloc(1, sizeof *made);
    if (!made) return BRIO_ERR_NO_MEMORY;
    made->size = sizeof *made;
    *out = made;
    return brio_alpha_values(ctx, t, points, weights, count, made);
}

EXPORT(alpha_values2)
int module_alpha_values2(brio_context *ctx, const brio_triangulation2 *t, const double *points, const double *weights,
                         size_t count, brio_alpha_complex **out) {
    brio_alpha_complex *made = calloc(1, sizeof *made);
    if (!made) return BRIO_ERR_NO_MEMORY;
    made->size = sizeof *made;
    *out = made;
    return brio_alpha_values2(ctx, t, points, weights, count, made);
}

/* Gives for each dimension the number of simplices and the addresses of their vertices and values. */
EXPORT(alpha_parts) void module_alpha_parts(const brio_alpha_complex *complex, uint32_t parts[12]) {
    for (int k = 0; k < 4; k++) {
        parts[3 * k] = (uint32_t)complex->counts[k];
        parts[3 * k + 1] = ADDRESS(complex->simplices[k]);
        parts[3 * k + 2] = ADDRESS(complex->values[k]);
    }
}

EXPORT(alpha_free) void module_alpha_free(brio_alpha_complex *complex) {
    brio_alpha_complex_free(complex);
    free(complex);
}

/* Makes the shape of alpha, or of the least alpha that makes one solid of all vertices where alpha is negative.
 * facts  alpha, tetrahedra, vertices that are in none. */
EXPORT(alpha_shape)
int module_alpha_shape(brio_context *ctx, const double *points, const brio_alpha_complex *complex, double alpha,
                       brio_mesh **out, double facts[3]) {
    brio_alpha_shape_stats stats = {.size = sizeof stats};
    brio_status status = alpha < 0 ? brio_alpha_auto(ctx, complex, &alpha) : BRIO_OK;
    if (status == BRIO_OK) status = brio_alpha_shape(ctx, points, complex, alpha, out, &stats);
    facts[0] = stats.alpha;
    facts[1] = (double)stats.tetrahedra;
    facts[2] = (double)stats.uncovered;
    return status;
}

/* --- cells --- */

EXPORT(voronoi)
int module_voronoi(brio_context *ctx, const double *points, const double *weights, size_t count, const double *box,
                   int faces, int vertices, brio_cells **out) {
    const brio_cells_options o = {.size = sizeof o, .box = box, .no_faces = !faces && !vertices, .vertices = vertices};
    return brio_voronoi_cells(ctx, NULL, points, weights, count, &o, out);
}

/* Gives the numbers of cells, faces, corners and vertices, and the addresses of site, volume, bounded, area, centroid,
 * face_offsets, face_neighbours, face_areas, face_normals, corner_offsets, face_vertices and vertices.
 * facts  the sum of the volumes, and the volume of the box. */
EXPORT(cells_parts) void module_cells_parts(const brio_cells *c, uint32_t parts[16], double facts[2]) {
    size_t faces = c->face_offsets ? c->face_offsets[c->num_cells] : 0;
    const uint32_t found[16] = {(uint32_t)c->num_cells,
                                (uint32_t)faces,
                                (uint32_t)(c->corner_offsets ? c->corner_offsets[faces] : 0),
                                (uint32_t)c->num_vertices,
                                ADDRESS(c->site),
                                ADDRESS(c->volume),
                                ADDRESS(c->bounded),
                                ADDRESS(c->area),
                                ADDRESS(c->centroid),
                                ADDRESS(c->face_offsets),
                                ADDRESS(c->face_neighbours),
                                ADDRESS(c->face_areas),
                                ADDRESS(c->face_normals),
                                ADDRESS(c->corner_offsets),
                                ADDRESS(c->face_vertices),
                                ADDRESS(c->vertices)};
    memcpy(parts, found, sizeof found);
    facts[0] = c->volume_sum;
    facts[1] = c->region_volume;
}

EXPORT(cells_free) void module_cells_free(brio_cells *c) {
    brio_cells_free(c);
}

/* --- surfaces and hulls --- */

/* Makes the hull.   samples  room for as many numbers as points: receives the point of each vertex. */
EXPORT(hull)
int module_hull(brio_context *ctx, const double *points, size_t count, int polygons, uint32_t *samples, brio_mesh **out,
                int *dimension) {
    const brio_convex_hull_options o = {.size = sizeof o, .polygons = polygons, .samples = samples};
    brio_convex_hull_stats stats = {.size = sizeof stats};
    brio_status status = brio_convex_hull(ctx, points, count, &o, out, &stats);
    *dimension = stats.dimension;
    return status;
}

/* Makes a surface.   given  method, noise, open, holes, simplify, confidence, polygons, distance, theta, boundaries,
 * density, pieces, seed.   evidence  NULL, or where outside is.   facts  noise, smoothed, holes, bridges, strays,
 * agreement with the evidence.   explanation  NULL, or receives how the surface came to be. */
static int make_surface(brio_context *ctx, const double *points, size_t count, const double given[13],
                        const brio_evidence *evidence, brio_mesh **out, double facts[6],
                        brio_explanation **explanation) {
    brio_surface_options o = {.size = sizeof o};
    brio_surface_stats s = {.size = sizeof s};
    o.method = (brio_surface_method)given[0];
    o.noise = (brio_noise)given[1];
    o.open = given[2];
    o.holes = (brio_holes)given[3];
    o.simplify = given[4] != 0;
    o.confidence = given[5] != 0;
    o.polygons = given[6] != 0;
    o.distance = given[7];
    o.theta = given[8];
    o.boundaries = (int)given[9];
    o.density = given[10] != 0;
    o.pieces = (size_t)given[11];
    o.seed = (uint64_t)given[12];
    o.explanation = explanation;
    o.evidence = brio_surface_method_has(o.method, "evidence") && !o.pieces ? evidence : NULL;
    brio_status status = brio_surface(ctx, points, count, &o, out, &s);
    const double found[6] = {s.noise,           (double)s.smoothed, (double)s.holes,
                             (double)s.bridges, (double)s.strays,   s.agreement};
    memcpy(facts, found, sizeof found);
    return status;
}

/* normals  #P by 3, or NULL.   origins  places of scanners, or NULL. */
EXPORT(surface)
int module_surface(brio_context *ctx, const double *points, size_t count, const double given[13], const double *normals,
                   const double *origins, size_t num_origins, brio_mesh **out, double facts[6],
                   brio_explanation **explanation) {
    const brio_evidence e = {.size = sizeof e, .normals = normals, .origins = origins, .num_origins = num_origins};
    return make_surface(ctx, points, count, given, normals || origins ? &e : NULL, out, facts, explanation);
}

/* Returns the three properties of these names, row by row, or NULL where one is missing. */
static double *take_three(const brio_mesh *mesh, const char *const names[3]) {
    const brio_property *p[3];
    for (int k = 0; k < 3; k++)
        if (!(p[k] = brio_mesh_property(mesh, names[k]))) return NULL;
    double *rows = malloc(mesh->num_vertices * 3 * sizeof *rows + 1);
    for (size_t i = 0; rows && i < 3 * mesh->num_vertices; i++) rows[i] = brio_property_value(p[i % 3], i / 3);
    return rows;
}

/* Makes a surface through the points of a mesh. What the mesh says of normals and of scanners' places tells where outside
 * is, and the surface has the mesh's properties. */
EXPORT(surface_of)
int module_surface_of(brio_context *ctx, const brio_mesh *points, const double given[13], brio_mesh **out,
                      double facts[6], brio_explanation **explanation) {
    size_t n = points->num_vertices;
    double *normals = take_three(points, (const char *const[]){"nx", "ny", "nz"});
    double *origins = take_three(points, (const char *const[]){"x_origin", "y_origin", "z_origin"});
    const brio_evidence e = {.size = sizeof e, .normals = normals, .origins = origins, .num_origins = origins ? n : 0};
    int status = make_surface(ctx, points->vertices, n, given, normals || origins ? &e : NULL, out, facts, explanation);
    free(normals);
    free(origins);
    if (status == BRIO_OK && points->num_properties) {
        const brio_property *sample = brio_mesh_property(*out, "sample");
        bool own = brio_surface_method_facts((brio_surface_method)given[0])->traits & BRIO_METHOD_OWN_VERTICES;
        const uint32_t *samples = sample && !own && sample->type == BRIO_SCALAR_INT32 ? sample->data : NULL;
        status = brio_mesh_carry_properties(ctx, points, samples, *out);
    }
    return status;
}

/* Gives the numbers of the samples that are explained, and of all. */
EXPORT(explanation_parts) void module_explanation_parts(const brio_explanation *e, uint32_t parts[2]) {
    parts[0] = (uint32_t)e->num_samples;
    parts[1] = (uint32_t)e->all_samples;
}

EXPORT(explanation_free) void module_explanation_free(brio_explanation *e) {
    brio_explanation_free(e);
}

/* --- meshes --- */

EXPORT(read)
int module_read(brio_context *ctx, const void *bytes, size_t size, const char *name, brio_mesh **out) {
    int origins = 0;
    const brio_read_options o = {.size = sizeof o, .origins = &origins};
    return brio_read_memory(ctx, bytes, size, name, &o, out);
}

/* Writes a mesh to a file of the memory. */
EXPORT(write) int module_write(brio_context *ctx, const char *path, const brio_mesh *mesh, int ascii, int float32) {
    const brio_write_options o = {.size = sizeof o, .ascii = ascii, .float32 = float32};
    return brio_write(ctx, path, mesh, &o);
}

/* Writes a page that shows meshes; name, report and explanation of each, or NULL. */
EXPORT(page)
int module_page(brio_context *ctx, const char *path, const brio_mesh *const *meshes, const char *const *names,
                const char *const *reports, const brio_explanation *const *explanations, size_t count,
                int self_intersections) {
    const brio_page_options o = {.size = sizeof o, .self_intersections = self_intersections};
    brio_page_layer *layers = calloc(count + 1, sizeof *layers);
    const brio_page_layer **list = calloc(count + 1, sizeof *list);
    int status = layers && list ? BRIO_OK : BRIO_ERR_NO_MEMORY;
    for (size_t i = 0; status == BRIO_OK && i < count; i++) {
        layers[i] = (brio_page_layer){sizeof *layers, meshes[i], names[i], reports[i], explanations[i]};
        list[i] = &layers[i];
    }
    if (status == BRIO_OK) status = brio_write_page(ctx, path, list, count, &o, NULL);
    free(list);
    free(layers);
    return status;
}

EXPORT(mesh) int module_mesh(brio_context *ctx, brio_mesh **out) {
    return brio_mesh_new(ctx, out);
}

/* Sets the vertices, triangles, tetrahedra and edges of an empty mesh. */
EXPORT(mesh_set)
int module_mesh_set(brio_mesh *mesh, const double *vertices, size_t num_vertices, const uint64_t *offsets,
                    const uint32_t *corners, size_t num_faces, const uint32_t *tetrahedra, size_t num_tetrahedra,
                    const uint32_t *edges, size_t num_edges) {
    brio_status status = brio_mesh_set_vertices(mesh, vertices, num_vertices);
    if (status == BRIO_OK && num_faces) status = brio_mesh_set_faces(mesh, offsets, corners, num_faces);
    if (status == BRIO_OK && num_tetrahedra) status = brio_mesh_set_tetrahedra(mesh, tetrahedra, 4, num_tetrahedra);
    if (status == BRIO_OK && num_edges) status = brio_mesh_set_edges(mesh, edges, num_edges);
    return status;
}

/* Adds a property of the vertices, or of the faces, and gives its place. */
EXPORT(mesh_add)
int module_mesh_add(brio_mesh *mesh, const char *name, int type, int of_faces, void **data) {
    return of_faces ? brio_mesh_add_face_property(mesh, name, (brio_scalar)type, data)
                    : brio_mesh_add_property(mesh, name, (brio_scalar)type, data);
}

/* Gives the parts of a mesh: count and address of vertices; of faces, with offsets (64 bits) and corners; of tetrahedra;
 * of edges; the numbers of properties of vertices and of faces. */
EXPORT(mesh_parts) void module_mesh_parts(const brio_mesh *mesh, uint32_t parts[11]) {
    const uint32_t found[11] = {(uint32_t)mesh->num_vertices,
                                ADDRESS(mesh->vertices),
                                (uint32_t)mesh->num_faces,
                                ADDRESS(mesh->face_offsets),
                                ADDRESS(mesh->face_vertices),
                                (uint32_t)mesh->num_tetrahedra,
                                ADDRESS(mesh->tetrahedra),
                                (uint32_t)mesh->num_edges,
                                ADDRESS(mesh->edges),
                                (uint32_t)mesh->num_properties,
                                (uint32_t)mesh->num_face_properties};
    memcpy(parts, found, sizeof found);
}

/* Gives the address of a property's name, its type, and the address of its numbers. */
EXPORT(mesh_property)
void module_mesh_property(const brio_mesh *mesh, int of_faces, size_t i, uint32_t parts[3]) {
    const brio_property *p = of_faces ? &mesh->face_properties[i] : &mesh->properties[i];
    parts[0] = ADDRESS(p->name);
    parts[1] = (uint32_t)p->type;
    parts[2] = ADDRESS(p->data);
}

EXPORT(mesh_free) void module_mesh_free(brio_mesh *mesh) {
    brio_mesh_free(mesh);
}

/* Certifies a mesh.   facts  closed, manifold, oriented, components, genus, boundary edges and loops, edges of over two
 * faces, pinched vertices, edges whose faces disagree, crossing pairs of faces, area, volume. */
EXPORT(certificate) int module_certificate(brio_context *ctx, const brio_mesh *mesh, double facts[13]) {
    brio_certificate c = {.size = sizeof c};
    brio_status status = brio_mesh_certificate(ctx, mesh, &c);
    if (status == BRIO_OK) status = brio_mesh_self_intersections(ctx, mesh, &c.self_intersections);
    const double found[13] = {c.closed,
                              c.manifold,
                              c.oriented,
                              (double)c.components,
                              (double)c.genus,
                              (double)c.boundary_edges,
                              (double)c.boundary_loops,
                              (double)c.nonmanifold_edges,
                              (double)c.nonmanifold_vertices,
                              (double)c.flipped_edges,
                              (double)c.self_intersections,
                              c.area,
                              c.volume};
    memcpy(facts, found, sizeof found);
    brio_certificate_free(&c);
    return status;
}
