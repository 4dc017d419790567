/* The co-cone of a large set of samples, in pieces: the super co-cone.
 *
 * An octree divides the samples into pieces (octree_pieces.c). One piece after the other is triangulated, and its
 * surface is found from its samples and their surroundings. Of the resulting triangles, those with a sample of the
 * piece count. Triangles at the seams are matched (seams.c).
 *
 * Based on: Dey, Giesen, Hudson. Delaunay based shape reconstruction from large data. PVG 2001.
 * Differs from the paper: the pieces are matched after each has become a manifold, and by agreement, so that the result
 *                         is a manifold, too. */
#include "reconstruct/cocone/super_cocone.h"
#include "base/memory.h"
#include "base/scale.h"
#include "order/canonical_points.h"
#include "reconstruct/cocone/octree_pieces.h"
#include "reconstruct/cocone/seams.h"

typedef struct {
    brio_context *ctx;
    const double *points;
    size_t num_points;
    int exponent; /* each piece is scaled by 2^-exponent */
    const brio_surface_options *options;
    brio_pieces pieces;
    brio_triangles faces, seam;
    uint8_t *frayed; /* #P: 1 where pieces disagree */
    brio_cocone_surface *out;
} assembly;

/* Adds the faces of a piece with at least one sample of the piece: to `faces` if all samples are, otherwise to
 * `seam`. */
static brio_status take_faces(assembly *a, uint32_t piece, const uint32_t *samples, const brio_cocone_surface *s) {
    brio_status status = BRIO_OK;
    for (size_t f = 0; f < s->num_faces; f++) {
        uint32_t corner[3];
        int own = 0;
        for (int k = 0; k < 3; k++) {
            corner[k] = samples[s->faces[3 * f + (size_t)k]];
            own += a->pieces.piece_of[corner[k]] == piece;
        }
        if (own > 0) BRIO_TRY(brio_triangles_add(a->ctx, own == 3 ? &a->faces : &a->seam, corner));
    }
done:
    return status;
}

/* Copies what was found out about the piece's own samples. */
static void take_samples(assembly *a, uint32_t piece, const uint32_t *samples, size_t count,
                         const brio_cocone_surface *s) {
    for (size_t n = 0; n < count; n++) {
        uint32_t p = samples[n];
        if (a->pieces.piece_of[p] != piece || !s->distinct[n]) continue;
        a->out->distinct[p] = 1;
        a->out->stats.samples++;
        if (s->size) a->out->size[p] = s->size[n];
        if (s->boundary) a->out->boundary[p] = s->boundary[n], a->out->stats.boundary_samples += s->boundary[n];
    }
}

static void add_stats(brio_surface_stats *sum, const brio_surface_stats *s) {
    sum->candidates += s->candidates;
    sum->pruned += s->pruned;
    sum->relabeled += s->relabeled;
    sum->delaunay_seconds += s->delaunay_seconds;
    sum->poles_seconds += s->poles_seconds;
    sum->candidates_seconds += s->candidates_seconds;
    sum->labels_seconds += s->labels_seconds;
    sum->manifold_seconds += s->manifold_seconds;
    sum->density_seconds += s->density_seconds;
}

/* Finds the surface of a piece. A piece without a surface is no error. */
static brio_status find_piece(assembly *a, uint32_t piece) {
    brio_status status = BRIO_OK;
    brio_context *ctx = a->ctx;
    brio_cocone_surface s = {0};
    uint32_t *samples = NULL;
    double *points = NULL;
    size_t count;
    BRIO_TRY(brio_piece_samples(ctx, &a->pieces, piece, &samples, &count));
    BRIO_TRY(BRIO_ALLOC(ctx, points, 3 * count));
    brio_copy_points(a->points, samples, count, points);
    BRIO_TRY(brio_scale(ctx, points, 3 * count, -a->exponent, points));
    status = brio_cocone_surface_find(ctx, points, count, a->options, NULL, &s);
    if (status == BRIO_ERR_NO_ANSWER) status = BRIO_OK;
    if (status != BRIO_OK) goto done;
    BRIO_TRY(take_faces(a, piece, samples, &s));
    take_samples(a, piece, samples, count, &s);
    add_stats(&a->out->stats, &s.stats);
done:
    brio_cocone_surface_free(ctx, &s);
    brio_release(ctx, points);
    brio_release(ctx, samples);
    return status;
}

static brio_status find_pieces(assembly *a) {
    brio_status status = BRIO_OK;
    size_t count = a->pieces.num_pieces;
    const brio_bar bar = brio_progress_bar(a->ctx);
    for (size_t i = 0; i < count; i++) {
        brio_progress_part(a->ctx, bar, (double)i / (double)count, (double)(i + 1) / (double)count);
        BRIO_TRY(find_piece(a, (uint32_t)i));
    }
    a->out->stats.pieces = count;
done:
    brio_progress_part(a->ctx, bar, 0, 1);
    return status;
}

static brio_status match(assembly *a) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    BRIO_TRY(BRIO_ALLOC_ZERO(a->ctx, a->frayed, a->num_points));
    BRIO_TRY(brio_match_seams(a->ctx, a->pieces.piece_of, &a->seam, &a->faces, a->frayed, &a->out->stats.unmatched));
    if (a->out->stats.unmatched > 0) BRIO_TRY(brio_trim_fans(a->ctx, a->points, a->num_points, a->frayed, &a->faces));
    BRIO_REQUIRE(a->ctx, a->faces.count > 0, BRIO_ERR_NO_ANSWER, "no triangle passes the co-cone test in any piece");
    a->out->faces = (uint32_t *)a->faces.corner;
    a->out->num_faces = a->faces.count;
    a->faces.corner = NULL;
    a->out->stats.manifold_seconds += brio_seconds() - start;
done:
    return status;
}

brio_status brio_super_cocone(brio_context *ctx, const double *points, size_t num_points, int exponent,
                              const brio_surface_options *options, brio_cocone_surface *out) {
    brio_status status = BRIO_OK;
    assembly a = {
        .ctx = ctx, .points = points, .num_points = num_points, .exponent = exponent, .options = options, .out = out};
    *out = (brio_cocone_surface){0};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->distinct, num_points));
    if (options->density) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->size, num_points));
    if (options->boundaries) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->boundary, num_points));
    BRIO_TRY(brio_pieces_new(ctx, points, num_points, options->pieces, &a.pieces));
    BRIO_TRY(find_pieces(&a));
    BRIO_TRY(match(&a));
done:
    brio_pieces_free(ctx, &a.pieces);
    brio_release(ctx, a.faces.corner);
    brio_release(ctx, a.seam.corner);
    brio_release(ctx, a.frayed);
    return status;
}
