/* Pages that show meshes: brio_write_page.
 *
 * A page is the text of web/page.html with the layers in its middle, one after the other, so that at no time more than
 * one layer is worked on. Texts of files stand in JSON only, without the characters that HTML knows (layer.c); the
 * page's program puts them into text nodes. The page's own rule (Content-Security-Policy) forbids it every request. */
#include "base/float_state.h"
#include "base/versioned.h"
#include "page/page.h"

/* Vertices up to which all numbers are exact, and points up to which clouds are whole: pages of about 20 and 60 MB. */
enum { MOST_EXACT = 250000, MOST_POINTS = 5000000 };

/* Reads the options of a layer. */
static brio_status take_layer(brio_context *ctx, const brio_page_layer *given, brio_page_layer *layer) {
    *layer = (brio_page_layer){0};
    BRIO_FORWARD(brio_versioned_take(ctx, given, layer, BRIO_LAYOUT(brio_page_layer)));
    BRIO_EXPECT(ctx, layer->mesh, BRIO_ERR_ARGUMENT, "a layer of a page has no mesh");
    return BRIO_OK;
}

/* Decides whether all numbers are exact, and estimates the bytes of the page for the progress bar. */
static brio_status weigh(brio_context *ctx, const brio_page_layer *const *layers, size_t num_layers, brio_page_how *how,
                         uint64_t *bytes) {
    enum { VERTEX = 12, EXACT_VERTEX = 40, CORNERS = 2 };
    uint64_t vertices = 0, corners = 0;
    for (size_t i = 0; i < num_layers; i++) {
        brio_page_layer layer;
        BRIO_FORWARD(take_layer(ctx, layers[i], &layer));
        const brio_mesh *m = layer.mesh;
        vertices += m->num_vertices;
        corners += m->num_faces + 4 * m->num_tetrahedra;
    }
    how->exact |= vertices <= MOST_EXACT;
    *bytes = vertices * (how->exact ? EXACT_VERTEX : VERTEX) + CORNERS * corners + 100000;
    return BRIO_OK;
}

/* Says what the page opens with. */
static brio_status put_scene(brio_output *out, const brio_page_options *o) {
    BRIO_FORWARD(brio_output_string(out, "<script type=\"application/json\" id=\"scene\">{\"title\":"));
    BRIO_FORWARD(brio_page_json(out, o->title));
    return brio_output_format(out, ",\"beside\":%d,\"version\":\"%s\"}</script>\n", o->side_by_side != 0,
                              brio_version());
}

static brio_status put_layers(brio_output *out, const brio_page_layer *const *layers, size_t num_layers,
                              brio_page_how *how, brio_page_stats *stats) {
    for (size_t i = 0; i < num_layers; i++) {
        brio_page_layer layer;
        uint64_t thinned = 0;
        BRIO_FORWARD(take_layer(out->ctx, layers[i], &layer));
        how->number = i;
        how->name = layer.name;
        how->report = layer.report;
        how->explanation = layer.explanation;
        BRIO_FORWARD(brio_page_layer_write(out, layer.mesh, how, &thinned));
        stats->points_thinned += thinned;
    }
    return BRIO_OK;
}

brio_status brio_write_page(brio_context *ctx, const char *path, const brio_page_layer *const *layers,
                            size_t num_layers, const brio_page_options *options, brio_page_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_output out = {.ctx = ctx, .target.folder = -1, .file = -1};
    brio_page_options o = {0};
    brio_page_stats mine = {0};
    uint64_t bytes = 0;
    BRIO_TRY(brio_versioned_take(ctx, options, &o, BRIO_LAYOUT(brio_page_options)));
    BRIO_TRY(brio_versioned_check(ctx, stats, BRIO_LAYOUT(brio_page_stats)));
    BRIO_REQUIRE(ctx, num_layers > 0, BRIO_ERR_ARGUMENT, "a page needs a mesh to show");
    brio_page_how how = {.most_points = o.most_points ? o.most_points : MOST_POINTS,
                         .exact = o.exact != 0,
                         .self_intersections = o.self_intersections != 0};
    BRIO_TRY(weigh(ctx, layers, num_layers, &how, &bytes));
    BRIO_TRY(brio_output_open(&out, ctx, path, bytes));
    BRIO_TRY(brio_output_bytes(&out, brio_page_head, brio_page_head_size));
    BRIO_TRY(put_scene(&out, &o));
    BRIO_TRY(put_layers(&out, layers, num_layers, &how, &mine));
    BRIO_TRY(brio_output_bytes(&out, brio_page_tail, brio_page_tail_size));
    mine.bytes = brio_output_offset(&out);
    mine.exact = how.exact;
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
    brio_versioned_give(stats, &mine, BRIO_LAYOUT(brio_page_stats));
done:
    brio_output_close(&out);
    return status;
}
