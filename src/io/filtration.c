/* Filtrations as text: for GUDHI all simplices, for ripser the edges as a sparse distance matrix.
 *
 * Based on: GUDHI's file formats (simplex tree), https://gudhi.inria.fr/doc/latest/fileformats.html.
 *           Bauer. Ripser: efficient computation of Vietoris-Rips persistence barcodes. J. Appl. Comput. Topol.
 *           2021. */
#include "base/float_state.h"
#include "base/memory.h"
#include "io/output.h"

enum { BYTES_A_LINE = 40, SIMPLICES_A_CALL = 1 << 14 };

/* Returns the dimension of the simplex of that number, and its row. */
static size_t dimension_of(const brio_alpha_complex *c, size_t number, size_t *row) {
    size_t k = 0;
    for (; k < 3 && number >= c->counts[k]; k++) number -= c->counts[k];
    *row = number;
    return k;
}

static brio_status write_simplex(brio_output *out, const brio_alpha_complex *c, size_t number, bool gudhi) {
    size_t row, k = dimension_of(c, number, &row);
    if (!gudhi && k != 1) return BRIO_OK;
    if (gudhi) BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)k));
    for (size_t i = 0; i <= k; i++)
        BRIO_FORWARD(brio_output_integer(out, gudhi || i ? ' ' : 0, c->simplices[k][row * (k + 1) + i]));
    BRIO_FORWARD(brio_output_double(out, ' ', c->values[k][row]));
    return brio_output_string(out, "\n");
}

brio_status brio_write_filtration(brio_context *ctx, const char *path, const brio_alpha_complex *c,
                                  const uint32_t *order, brio_filtration_format format) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_output out = {.ctx = ctx, .target.folder = -1, .file = -1};
    size_t total = c->counts[0] + c->counts[1] + c->counts[2] + c->counts[3];
    BRIO_REQUIRE(ctx, (unsigned)format < BRIO_FILTRATION_END, BRIO_ERR_ARGUMENT, "no such format of filtrations: %d",
                 (int)format);
    for (size_t i = 0; i < total; i++)
        BRIO_REQUIRE(ctx, order[i] < total, BRIO_ERR_ARGUMENT, "order: %u is no simplex of %zu", order[i], total);
    BRIO_TRY(brio_output_open(&out, ctx, path, BYTES_A_LINE * (uint64_t)total));
    for (size_t i = 0; i < total; i++) BRIO_TRY(write_simplex(&out, c, order[i], format == BRIO_FILTRATION_GUDHI));
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    return status;
}
