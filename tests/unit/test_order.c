/* Insertion orders: permutations, the curve's continuity, the share of each round. */
#include "harness.h"
#include "order/hilbert.h"
#include "order/order.h"
#include "points.h"

static void curve_visits_each_cell_once_in_unit_steps(void) {
    enum { BITS = 4, SIDE = 1 << BITS, CELLS = SIDE * SIDE * SIDE };
    static int at[CELLS][3];
    static char seen[CELLS];
    for (uint32_t x = 0; x < SIDE; x++)
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t z = 0; z < SIDE; z++) {
                uint64_t key = brio_hilbert_key(x, y, z, BITS);
                EXPECT(key < CELLS && !seen[key]);
                seen[key] = 1;
                at[key][0] = (int)x, at[key][1] = (int)y, at[key][2] = (int)z;
            }
    for (int k = 1; k < CELLS; k++) {
        int steps = 0;
        for (int c = 0; c < 3; c++) steps += abs(at[k][c] - at[k - 1][c]);
        EXPECT(steps == 1);
    }
}

static void every_order_is_a_permutation(void) {
    enum { N = 5000 };
    static double p[3 * N];
    static uint32_t order[N];
    brio_context *ctx = new_context();
    for (int set = 0; set < 3; set++) {
        if (set == 0) uniform_points(1, N, p);
        if (set == 1) integer_points(1, N, 3, p);
        if (set == 2)
            for (size_t i = 0; i < 3 * N; i++) p[i] = i % 2 ? 1.7e308 : -1.7e308;
        for (int kind = 0; kind < BRIO_ORDER_END; kind++) {
            brio_options o = brio_options_default();
            o.order = (brio_order)kind;
            EXPECT(brio_order_points(ctx, p, N, &o, order, NULL) == BRIO_OK);
            static char seen[N];
            memset(seen, 0, N);
            for (size_t i = 0; i < N; i++) EXPECT(order[i] < N && !seen[order[i]]++);
        }
    }
    brio_context_free(ctx);
}

/* With ratio 1/2 half of the points are in the last round: the positions at which the curve starts anew tell the
 * rounds. */
static void rounds_have_their_share(void) {
    enum { N = 40000 };
    static double p[3 * N];
    static uint32_t order[N];
    static uint64_t key[N];
    uniform_points(3, N, p);
    brio_hilbert_keys(p, N, 7, 2, key); /* coarser than the order's own curve */
    brio_options o = brio_options_default();
    o.round_ratio = 0.5;
    brio_context *ctx = new_context();
    EXPECT(brio_order_points(ctx, p, N, &o, order, NULL) == BRIO_OK);
    size_t last = N - 1;
    while (last > 0 && key[order[last - 1]] <= key[order[last]]) last--;
    EXPECT(last > 0.48 * N && last < 0.52 * N, "last round starts at %zu", last);
    brio_context_free(ctx);
}

int main(void) {
    RUN(curve_visits_each_cell_once_in_unit_steps);
    RUN(every_order_is_a_permutation);
    RUN(rounds_have_their_share);
    return harness_end();
}
