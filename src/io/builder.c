/* A mesh under construction.
 *
 * Small arrays grow by half, large ones by an eighth: large arrays are mappings that grow without copying, and unused
 * capacity counts against the memory limit. Messages count points, faces and tetrahedra from 0, and show indices of
 * vertices as they are in the file. */
#include "io/builder.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "io/colour.h"
#include "io/filter.h"
#include "io/scalar.h"
#include "mesh/properties.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- files that end early --- */

bool brio_salvage(brio_builder *b, brio_stream *s, uint64_t before, bool points, brio_status *status) {
    char text[64];
    bool may_lack_digits = *status == BRIO_OK && s->unended && s->row + 1 < s->rows;
    bool fails = *status == BRIO_ERR_FORMAT && (s->truncated || s->unended);
    if (!b->salvage || !(fails || may_lack_digits)) return false;
    brio_mesh *m = b->mesh;
    m->num_vertices -= (size_t)(brio_builder_count(b) - before);
    b->num_corners = m->num_faces ? (size_t)m->face_offsets[m->num_faces] : 0;
    s->begin = s->end; /* what is left of the row is no other row */
    s->salvaged = true;
    *status = BRIO_OK;
    if (points) b->missing = s->rows - s->row;
    if (points) return true;
    snprintf(text, sizeof text, "%" PRIu64 " rows of %.30s", s->rows - s->row, s->element);
    *status = brio_builder_leave_out(b, text);
    return true;
}

/* --- places of scanners --- */

/* Places of scanners as properties of the points that they saw. A place is written for each point: points are then
 * complete in blocks, however many scans a file has, and the properties pass through all that properties pass
 * through. */

static const char *const NAMES[] = {"x_origin", "y_origin", "z_origin"};

brio_status brio_plan_origins(brio_builder *b) {
    b->has_origins = false;
    if (!b->origins) return BRIO_OK;
    for (int k = 0; k < 3; k++)
        if (brio_mesh_property(b->mesh, NAMES[k])) return BRIO_OK;
    b->first_origin = b->mesh->num_properties;
    for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_builder_property(b, NAMES[k], BRIO_SCALAR_FLOAT64));
    b->has_origins = true;
    return BRIO_OK;
}

void brio_set_origins(brio_builder *b, size_t first, const double *place) {
    for (size_t k = 0; k < 3 && b->has_origins; k++) {
        double *value = b->mesh->properties[b->first_origin + k].data;
        for (size_t v = first; v < b->mesh->num_vertices; v++) value[v] = place ? place[k] : (double)NAN;
    }
}

/* --- the mesh --- */

/* All chosen. */
enum { FIRST_CAPACITY = 64, LARGE = 1 << 22, MOST_LEFT_OUT = 200 };

static size_t grown(size_t capacity, size_t need) {
    size_t target = capacity + (capacity < LARGE ? capacity / 2 : capacity / 8);
    if (target < FIRST_CAPACITY) target = FIRST_CAPACITY;
    return target < need ? need : target;
}

brio_status brio_builder_start(brio_builder *b, brio_context *ctx, const char *name) {
    *b = (brio_builder){.ctx = ctx, .name = name};
    return brio_mesh_new(ctx, &b->mesh);
}

/* --- vertices and their properties --- */

static brio_status set_vertex_capacity(brio_builder *b, size_t capacity) {
    BRIO_FORWARD(BRIO_RESIZE(b->ctx, b->mesh->vertices, 3 * capacity));
    brio_expect_sequence(b->mesh->vertices);
    for (size_t i = 0; i < b->mesh->num_properties; i++) {
        brio_property *p = &b->mesh->properties[i];
        BRIO_FORWARD(brio_resize_to(b->ctx, &p->data, capacity, brio_scalar_size(p->type)));
    }
    b->vertex_capacity = capacity;
    return BRIO_OK;
}

static brio_status too_many_vertices(const brio_builder *b, uint64_t count) {
    return brio_fail(b->ctx, BRIO_ERR_TOO_LARGE, "%s: %" PRIu64 " points, the most are %" PRIu64, b->name, count,
                     BRIO_MAX_VERTICES);
}

brio_status brio_builder_expect_vertices(brio_builder *b, uint64_t count) {
    if (b->streams) return BRIO_OK;
    if (count > BRIO_MAX_VERTICES) return too_many_vertices(b, count);
    return count > b->vertex_capacity ? set_vertex_capacity(b, count) : BRIO_OK;
}

/* --- blocks --- */

void brio_builder_stream(brio_builder *b, uint64_t announced) {
    b->streams = b->sink != NULL;
    if (b->announced) *b->announced = announced;
}

/* Leaves out the vertices that are not finite, with the faces, tetrahedra and edges that use them. */
static brio_status drop_not_finite(brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_mesh *m = b->mesh;
    uint8_t *stays = NULL;
    BRIO_TRY(BRIO_ALLOC(b->ctx, stays, m->num_vertices));
    for (size_t v = 0; v < m->num_vertices; v++) stays[v] = brio_all_finite(m->vertices + 3 * v, 3);
    BRIO_TRY(brio_filter_mesh(b->ctx, m, stays));
done:
    brio_release(b->ctx, stays);
    return status;
}

/* Hands the vertices on and begins again with none. After a vertex that is no number, vertices are counted only. */
static brio_status hand_on(brio_builder *b) {
    size_t count = b->mesh->num_vertices;
    uint64_t before = b->refused.count;
    if (!b->passed) brio_colour_name(b->mesh);
    brio_count_not_finite(&b->refused, b->passed, b->mesh->vertices, NULL, count);
    if (b->drop_invalid && b->refused.count > before) BRIO_FORWARD(drop_not_finite(b));
    if (b->drop_invalid || !b->refused.count) BRIO_FORWARD(b->sink->take(b->sink->user, b->mesh));
    b->passed += count;
    b->mesh->num_vertices = 0;
    return BRIO_OK;
}

brio_status brio_builder_add_vertices(brio_builder *b, size_t count) {
    if (b->streams && b->mesh->num_vertices && b->mesh->num_vertices + count > BRIO_BLOCK_ROWS)
        BRIO_FORWARD(hand_on(b));
    size_t need = b->mesh->num_vertices + count;
    if (need > b->vertex_capacity) {
        if (need > BRIO_MAX_VERTICES) return too_many_vertices(b, need);
        BRIO_FORWARD(set_vertex_capacity(b, grown(b->vertex_capacity, need)));
    }
    b->mesh->num_vertices = need;
    return BRIO_OK;
}

brio_status brio_builder_vertex(brio_builder *b, const double *point) {
    brio_status status = brio_builder_add_vertices(b, 1);
    if (status == BRIO_OK) memcpy(b->mesh->vertices + 3 * (b->mesh->num_vertices - 1), point, 3 * sizeof *point);
    return status;
}

/* Returns the slot of a name, or the empty one where it belongs. */
static uint16_t *slot_of(brio_builder *b, const char *name) {
    brio_names *n = &b->names;
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (const char *c = name; *c; c++) hash = (hash ^ (unsigned char)*c) * 16777619u;
    size_t at = (hash ^ hash >> 15) % BRIO_NAME_SLOTS;
    while (n->slot[at] && strcmp(b->mesh->properties[n->slot[at] - 1].name, name) != 0) at = (at + 1) % BRIO_NAME_SLOTS;
    return &n->slot[at];
}

/* Puts properties in the slots that were added since. */
static void note_names(brio_builder *b) {
    brio_names *n = &b->names;
    if (n->count > b->mesh->num_properties) *n = (brio_names){.count = 0};
    while (n->count < b->mesh->num_properties && n->count < BRIO_MOST_NUMBERS) {
        uint16_t *slot = slot_of(b, b->mesh->properties[n->count].name);
        n->next[n->count++] = 2;
        *slot = (uint16_t)n->count;
    }
}

bool brio_builder_has(brio_builder *b, const char *name) {
    char clean[64];
    note_names(b);
    return brio_utf8_copy(clean, sizeof clean, name) && *slot_of(b, clean);
}

brio_status brio_builder_property(brio_builder *b, const char *name, brio_scalar type) {
    char clean[64];
    size_t length = strlen(name);
    BRIO_EXPECT(b->ctx, length > 0 && length < sizeof clean, BRIO_ERR_FORMAT,
                "%s: a property name of %zu characters, expected 1 to 63", b->name, length);
    brio_utf8_copy(clean, sizeof clean, name); /* Latin-1 may be longer then: the end is cut */
    BRIO_EXPECT(b->ctx, !brio_builder_has(b, clean), BRIO_ERR_FORMAT, "%s: two properties named %s", b->name, clean);
    BRIO_FORWARD(brio_limit_numbers(b->ctx, b->name, 0, b->mesh->num_properties + 1));
    BRIO_FORWARD(brio_mesh_append_property(b->mesh, clean, type));
    brio_property *p = &b->mesh->properties[b->mesh->num_properties - 1];
    if (b->vertex_capacity) BRIO_FORWARD(brio_resize_to(b->ctx, &p->data, b->vertex_capacity, brio_scalar_size(type)));
    return BRIO_OK;
}

brio_status brio_builder_leave_out(brio_builder *b, const char *name) {
    char clean[64];
    brio_utf8_copy(clean, sizeof clean, b->num_left_out < MOST_LEFT_OUT ? name : "others");
    for (size_t i = 0; i < b->num_left_out; i++)
        if (!strcmp(b->left_out[i], clean)) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->left_out, b->left_out_capacity, b->num_left_out + 1));
    memcpy(b->left_out[b->num_left_out++], clean, sizeof clean);
    return BRIO_OK;
}

void brio_builder_new_name(brio_builder *b, const char *source, char name[64]) {
    brio_utf8_copy(name, 64, source);
    note_names(b);
    uint16_t taken = *slot_of(b, name);
    while (*slot_of(b, name)) brio_numbered_name(name, 64, source, b->names.next[taken - 1]++);
}

void brio_builder_component_name(brio_builder *b, const char *source, uint64_t which, uint64_t count, char name[64]) {
    char part[64];
    if (count > 1) brio_numbered_name(part, sizeof part, source, which);
    brio_builder_new_name(b, count > 1 ? part : source, name);
}

brio_status brio_builder_adopt_property(brio_builder *b, const char *name, brio_scalar type, void *data) {
    brio_status status = brio_builder_property(b, name, type);
    if (status != BRIO_OK) {
        brio_release(b->ctx, data);
        return status;
    }
    brio_property *p = &b->mesh->properties[b->mesh->num_properties - 1];
    brio_release(b->ctx, p->data);
    p->data = data;
    return BRIO_OK;
}

/* --- faces and tetrahedra --- */

static brio_status set_face_capacity(brio_builder *b, size_t capacity) {
    BRIO_FORWARD(BRIO_RESIZE(b->ctx, b->mesh->face_offsets, capacity + 1));
    if (!b->face_capacity) b->mesh->face_offsets[0] = 0;
    for (size_t i = 0; i < b->mesh->num_face_properties; i++) {
        brio_property *p = &b->mesh->face_properties[i];
        BRIO_FORWARD(brio_resize_to(b->ctx, &p->data, capacity, brio_scalar_size(p->type)));
    }
    b->face_capacity = capacity;
    return BRIO_OK;
}

brio_status brio_builder_face_property(brio_builder *b, const char *name, brio_scalar type) {
    BRIO_FORWARD(brio_limit_numbers(b->ctx, b->name, 0, b->mesh->num_face_properties + 1));
    BRIO_FORWARD(brio_mesh_append_face_property(b->mesh, name, type));
    brio_property *p = &b->mesh->face_properties[b->mesh->num_face_properties - 1];
    if (b->face_capacity) BRIO_FORWARD(brio_resize_to(b->ctx, &p->data, b->face_capacity, brio_scalar_size(type)));
    return BRIO_OK;
}

void brio_builder_new_face_name(const brio_builder *b, const char *source, char name[64]) {
    brio_utf8_copy(name, 64, source);
    for (size_t n = 2; brio_mesh_face_property(b->mesh, name); n++) brio_numbered_name(name, 64, source, n);
}

bool brio_builder_face_value(brio_builder *b, size_t which, double value) {
    const brio_property *p = &b->mesh->face_properties[which];
    return brio_scalar_store((char *)p->data + (b->mesh->num_faces - 1) * brio_scalar_size(p->type), p->type, value);
}

brio_status brio_builder_expect_faces(brio_builder *b, uint64_t count) {
    return count > b->face_capacity ? set_face_capacity(b, count) : BRIO_OK;
}

brio_status brio_builder_expect_tetrahedra(brio_builder *b, uint64_t count) {
    if (count <= b->tetrahedron_capacity) return BRIO_OK;
    brio_status status = brio_resize_to(b->ctx, &b->mesh->tetrahedra, count, 4 * sizeof *b->mesh->tetrahedra);
    if (status == BRIO_OK) b->tetrahedron_capacity = count;
    return status;
}

static bool is_index(double index) {
    return index >= 0 && index < UINT32_MAX && index == floor(index);
}

static brio_status no_index(const brio_builder *b, const char *what, size_t which, double index) {
    return brio_fail(b->ctx, BRIO_ERR_FORMAT, "%s: %s %zu (counted from 0): %.17g is not the index of a vertex",
                     b->name, what, which, index + b->index_base);
}

static brio_status bad_index(const brio_builder *b, const char *what, size_t which, double index) {
    size_t n = b->mesh->num_vertices;
    return brio_fail(b->ctx, BRIO_ERR_FORMAT,
                     "%s: %s %zu (counted from 0): index %.17g, expected one of the %zu vertices, numbered from %u",
                     b->name, what, which, index + b->index_base, n, b->index_base);
}

brio_status brio_builder_corner(brio_builder *b, double index) {
    if (!is_index(index)) return no_index(b, "face", b->mesh->num_faces, index);
    if (b->num_corners == b->corner_capacity) {
        size_t capacity = grown(b->corner_capacity, b->num_corners + 1);
        BRIO_FORWARD(BRIO_RESIZE(b->ctx, b->mesh->face_vertices, capacity));
        b->corner_capacity = capacity;
    }
    b->mesh->face_vertices[b->num_corners++] = (uint32_t)index;
    return BRIO_OK;
}

brio_status brio_builder_face(brio_builder *b) {
    size_t f = b->mesh->num_faces;
    if (f == b->face_capacity) BRIO_FORWARD(set_face_capacity(b, grown(f, f + 1)));
    b->mesh->face_offsets[f + 1] = b->num_corners;
    b->mesh->num_faces = f + 1;
    for (size_t i = 0; i < b->mesh->num_face_properties; i++) brio_builder_face_value(b, i, 0);
    return BRIO_OK;
}

brio_status brio_builder_tetrahedron(brio_builder *b, const double *indices) {
    size_t t = b->mesh->num_tetrahedra;
    for (int i = 0; i < 4; i++)
        if (!is_index(indices[i])) return no_index(b, "tetrahedron", t, indices[i]);
    if (t == b->tetrahedron_capacity) BRIO_FORWARD(brio_builder_expect_tetrahedra(b, grown(t, t + 1)));
    for (int i = 0; i < 4; i++) b->mesh->tetrahedra[4 * t + i] = (uint32_t)indices[i];
    b->mesh->num_tetrahedra = t + 1;
    return BRIO_OK;
}

brio_status brio_builder_edge(brio_builder *b, const double *indices) {
    size_t e = b->mesh->num_edges;
    for (int i = 0; i < 2; i++)
        if (!is_index(indices[i])) return no_index(b, "edge", e, indices[i]);
    if (e == b->edge_capacity) {
        size_t capacity = grown(e, e + 1);
        BRIO_FORWARD(brio_resize_to(b->ctx, &b->mesh->edges, capacity, 2 * sizeof *b->mesh->edges));
        b->edge_capacity = capacity;
    }
    for (int i = 0; i < 2; i++) b->mesh->edges[2 * e + (size_t)i] = (uint32_t)indices[i];
    b->mesh->num_edges = e + 1;
    return BRIO_OK;
}

/* --- the end --- */

static brio_status check_indices(const brio_builder *b) {
    const brio_mesh *m = b->mesh;
    for (size_t i = 0, f = 0; i < b->num_corners; i++) {
        if (m->face_vertices[i] < m->num_vertices) continue;
        while (m->face_offsets[f + 1] <= i) f++;
        return bad_index(b, "face", f, m->face_vertices[i]);
    }
    for (size_t i = 0; i < 4 * m->num_tetrahedra; i++)
        if (m->tetrahedra[i] >= m->num_vertices) return bad_index(b, "tetrahedron", i / 4, m->tetrahedra[i]);
    for (size_t i = 0; i < 2 * m->num_edges; i++)
        if (m->edges[i] >= m->num_vertices) return bad_index(b, "edge", i / 2, m->edges[i]);
    return BRIO_OK;
}

static brio_status trim(brio_builder *b) {
    brio_mesh *m = b->mesh;
    if (m->num_vertices) {
        if (m->num_vertices < b->vertex_capacity) BRIO_FORWARD(set_vertex_capacity(b, m->num_vertices));
    } else {
        brio_release(b->ctx, m->vertices);
        m->vertices = NULL;
    }
    if (m->num_faces) {
        if (m->num_faces < b->face_capacity) BRIO_FORWARD(set_face_capacity(b, m->num_faces));
        BRIO_FORWARD(BRIO_RESIZE(b->ctx, m->face_vertices, b->num_corners));
    } else {
        while (m->num_face_properties) brio_release(b->ctx, m->face_properties[--m->num_face_properties].data);
        brio_release(b->ctx, m->face_offsets);
        m->face_offsets = NULL;
    }
    if (m->num_tetrahedra) {
        BRIO_FORWARD(brio_resize_to(b->ctx, &m->tetrahedra, m->num_tetrahedra, 4 * sizeof *m->tetrahedra));
    } else {
        brio_release(b->ctx, m->tetrahedra);
        m->tetrahedra = NULL;
    }
    if (m->num_edges) BRIO_FORWARD(brio_resize_to(b->ctx, &m->edges, m->num_edges, 2 * sizeof *m->edges));
    return BRIO_OK;
}

brio_status brio_builder_finish(brio_builder *b) {
    if (b->streams) {
        if (b->mesh->num_vertices || !b->passed) BRIO_FORWARD(hand_on(b));
        if (!b->drop_invalid) BRIO_FORWARD(brio_refuse_counted(b->ctx, &b->refused, b->name));
        return BRIO_OK;
    }
    brio_mesh faces = brio_mesh_faces_as_points(b->mesh);
    brio_colour_name(b->mesh);
    brio_colour_name(&faces);
    BRIO_FORWARD(trim(b));
    BRIO_FORWARD(check_indices(b));
    brio_count_not_finite(&b->refused, 0, b->mesh->vertices, NULL, b->mesh->num_vertices);
    if (!b->drop_invalid) BRIO_FORWARD(brio_refuse_counted(b->ctx, &b->refused, b->name));
    if (b->refused.count) BRIO_FORWARD(drop_not_finite(b));
    return BRIO_OK;
}
