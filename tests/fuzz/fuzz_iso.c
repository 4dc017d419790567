/* Iso-surfaces, plain and conforming: of small grids of values, and of files (maps and atoms) from memory. The surface is
 * closed, manifold and oriented, and the triangles of a conforming one are facets of the Delaunay triangulation of its
 * vertices. */
#include "base/memory.h"
#include "io/ccp4.h"
#include "io/pdb.h"
#include "iso/iso_source.h"
#include "surface_oracle.h"

enum { MOST_VALUES = 216, MOST_CORNERS = 3000 };

static int compare_facets(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

static void sort_corners(uint32_t v[3]) {
    for (int k = 0; k < 3; k++) {
        uint32_t *a = v + k % 2, kept = a[0];
        if (a[0] > a[1]) a[0] = a[1], a[1] = kept;
    }
}

/* All facets of the tetrahedra, in order. */
static uint32_t (*sorted_facets(const brio_triangulation *t, size_t *count))[3] {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    size_t n = brio_triangulation_stats(t)->tetrahedra;
    uint32_t(*facets)[3] = malloc((4 * n + 1) * sizeof *facets);
    FUZZ_EXPECT(facets);
    for (size_t i = 0; i < 4 * n; i++) {
        for (size_t k = 0; k < 3; k++) facets[i][k] = tet[i / 4].vertex[(i + k + 1) % 4];
        sort_corners(facets[i]);
    }
    qsort(facets, 4 * n, sizeof *facets, compare_facets);
    *count = 4 * n;
    return facets;
}

/* Of coincident vertices the one that represents them stands in the tetrahedra. */
static void expect_conforming(brio_context *ctx, const brio_mesh *m) {
    brio_triangulation *t;
    if (3 * m->num_faces > MOST_CORNERS) return;
    FUZZ_EXPECT(brio_delaunay(ctx, m->vertices, NULL, m->num_vertices, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    const uint32_t *name = brio_triangulation_representatives(t);
    size_t count;
    uint32_t(*facets)[3] = sorted_facets(t, &count);
    for (size_t f = 0; f < m->num_faces && brio_triangulation_stats(t)->dimension == 3; f++) {
        uint32_t v[3];
        for (size_t k = 0; k < 3; k++) v[k] = name[m->face_vertices[3 * f + k]];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        sort_corners(v);
        FUZZ_EXPECT(bsearch(v, facets, count, sizeof *facets, compare_facets), "face %zu is not Delaunay", f);
    }
    free(facets);
    brio_triangulation_free(t);
}

static void expect_iso(brio_context *ctx, brio_iso_source *from, double level, const brio_iso_surface_options *o) {
    brio_mesh *m;
    brio_status status = brio_iso_source_surface(ctx, from, level, o, &m);
    fuzz_expect_failure(status);
    FUZZ_EXPECT((status == BRIO_OK) == (m != NULL), "status %d", (int)status);
    if (!m) return;
    expect_surface(ctx, m, true, "iso-surface");
    if (o->conforming) expect_conforming(ctx, m);
    brio_mesh_free(m);
}

/* Values on a grid of up to 6 x 6 x 6 places. */
static void make_values(brio_context *ctx, fuzz_input *in, brio_iso_source *from) {
    brio_volume *v = &from->volume;
    size_t count = 1;
    from->is_map = true;
    for (size_t k = 0; k < 3; k++) {
        v->size[k] = 1 + (uint32_t)fuzz_below(in, 6), count *= v->size[k];
        v->step[k][k] = fuzz_flag(in) ? 1 : 0.25;
        v->origin[k] = (double)fuzz_byte(in) - 128;
    }
    FUZZ_EXPECT(BRIO_ALLOC(ctx, v->values, count) == BRIO_OK);
    for (size_t i = 0; i < count; i++) v->values[i] = (float)(fuzz_byte(in) % 9) / 4;
}

static brio_status read_file(brio_context *ctx, fuzz_input *in, brio_iso_source *from) {
    brio_stream s;
    brio_status status = brio_stream_open_memory(&s, ctx, "memory", in->at, in->left);
    if (status == BRIO_OK && from->is_map) status = brio_ccp4_read(&s, &from->volume);
    if (status == BRIO_OK && !from->is_map) status = brio_pdb_read(&s, &from->atoms, &from->num_atoms);
    brio_stream_close(&s);
    fuzz_expect_failure(status);
    return status;
}

/* Chosen by all bytes: what is done then is slow, as it tries fine grids, and changes of such an input seldom are one. */
static bool is_one_of_1024(const uint8_t *bytes, size_t size) {
    uint32_t hash = 2166136261U;
    for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * 16777619U;
    return hash >> 22 == 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static const double levels[] = {1, 0, 0.25, -1, 1e30, 0.7, 1e-30, 3};
    static const size_t resolutions[] = {4, 0, 1, 7};
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    brio_iso_source from = {0};
    brio_iso_surface_options o = {0};
    uint8_t kind = fuzz_byte(&in), bits = fuzz_byte(&in);
    o.deviations = bits >> 3 & 1, o.conforming = bits >> 4 & 1;
    o.resolution = resolutions[bits >> 5 & 3];
    o.vertices = bits & 128 && is_one_of_1024(bytes, size) ? 50 : 0;
    if (o.vertices) o.resolution = 0;
    from.is_map = kind % 4 == 1;
    brio_status status = BRIO_OK;
    if (kind % 4 == 0 || kind % 4 == 3)
        make_values(ctx, &in, &from);
    else
        status = read_file(ctx, &in, &from);
    size_t values = (size_t)from.volume.size[0] * from.volume.size[1] * from.volume.size[2];
    bool small = from.is_map ? values <= MOST_VALUES : from.num_atoms <= 8 && o.resolution;
    if (status == BRIO_OK && small) expect_iso(ctx, &from, levels[bits & 7], &o);
    brio_iso_source_free(ctx, &from);
    fuzz_end();
    return 0;
}
