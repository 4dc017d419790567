/* Metamorphic runs: points are changed in a way whose effect is known, and both results are compared.
 *   metamorphic [--inputs N] [--seed S] [--first I]      half of the runs for triangulations, half for surfaces
 * Prints the runs of each change; --inputs 1 --first I repeats run I. */
#include "changed_surfaces.h"
#include <time.h>

typedef struct {
    uint64_t runs[CHANGES], wrong[CHANGES];
    uint64_t surfaces[METHODS][CHANGES], faces[METHODS][CHANGES], topology[METHODS][CHANGES], unsound;
    uint64_t mistakes;
} tally;

static bool is_promised(change how) {
    return how == SHUFFLE || how == SCALE || how == THREADS;
}

static void complain(tally *sum, const oracle_run *run, uint64_t index, const char *what, const char *why) {
    sum->mistakes++;
    printf("WRONG: %s: %s: metamorphic --inputs 1 --seed %llu --first %llu\n", what, why, (unsigned long long)run->seed,
           (unsigned long long)index);
}

static void run_triangulation(brio_context *ctx, const oracle_run *run, uint64_t index, tally *sum) {
    static changed_set s;
    dice d = dice_of(run->seed, index);
    change how = (change)(index / 2 % CHANGES);
    bool skipped = true;
    const char *wrong = NULL;
    while (skipped) wrong = try_change(ctx, &d, how, &s, &skipped);
    sum->runs[how]++;
    if (!wrong) return;
    sum->wrong[how]++;
    complain(sum, run, index, CHANGE_NAMES[how], wrong);
    if (s.n < 20) print_points(s.x, s.weighted ? s.w : NULL, s.n, s.dimension);
}

static void run_surface(brio_context *ctx, const oracle_run *run, uint64_t index, tally *sum) {
    static const change changes[] = {SHUFFLE, SCALE, THREADS, DUPLICATE, MOVE, EXCHANGE_AXES, NEGATE};
    static changed_set s;
    dice d = dice_of(run->seed, index);
    size_t kinds = sizeof changes / sizeof *changes;
    change how = changes[index / 2 % kinds];
    method which = (method)(index / 2 / kinds % METHODS);
    surface_verdict v = try_surface(ctx, &d, which, how, &s);
    sum->surfaces[which][how]++;
    sum->faces[which][how] += v.same_faces, sum->topology[which][how] += v.same_topology;
    if (!v.sound) complain(sum, run, index, METHOD_NAMES[which], "not the surface that is promised");
    if (is_promised(how) && !v.same_faces) complain(sum, run, index, METHOD_NAMES[which], CHANGE_NAMES[how]);
}

static void report(const oracle_run *run, const tally *sum) {
    printf("%-18s %10s %6s\n", "triangulations", "runs", "wrong");
    for (int c = 0; c < CHANGES; c++)
        printf("%-18s %10llu %6llu\n", CHANGE_NAMES[c], (unsigned long long)sum->runs[c],
               (unsigned long long)sum->wrong[c]);
    printf("\n%-18s %-16s %8s %11s %16s\n", "surfaces", "change", "runs", "same faces", "same topology");
    for (int m = 0; m < METHODS; m++)
        for (int c = 0; c < CHANGES; c++)
            if (sum->surfaces[m][c])
                printf("%-18s %-16s %8llu %11llu %16llu%s\n", METHOD_NAMES[m], CHANGE_NAMES[c],
                       (unsigned long long)sum->surfaces[m][c], (unsigned long long)sum->faces[m][c],
                       (unsigned long long)sum->topology[m][c], is_promised((change)c) ? "  promised" : "");
    printf("%llu runs, seed %llu, first %llu, %.0f s of processor time: %llu wrong\n", (unsigned long long)run->inputs,
           (unsigned long long)run->seed, (unsigned long long)run->first, (double)clock() / CLOCKS_PER_SEC,
           (unsigned long long)sum->mistakes);
}

int main(int argc, char **argv) {
    static tally sum;
    oracle_run run = oracle_arguments(argc, argv, 400);
    brio_context *ctx = oracle_context();
    for (uint64_t i = run.first; i < run.first + run.inputs && sum.mistakes < 20; i++)
        if (i % 2)
            run_surface(ctx, &run, i, &sum);
        else
            run_triangulation(ctx, &run, i, &sum);
    if (brio_context_memory(ctx)) sum.mistakes++, printf("WRONG: %zu bytes left\n", brio_context_memory(ctx));
    report(&run, &sum);
    brio_context_free(ctx);
    return sum.mistakes ? 1 : 0;
}
