/* A lattice of translations: reduced, put on a grid, and the translate of a point in one domain.
 *
 * The reduced vectors are computed from the caller's, in integer combinations, and rounded to the grid once; the cell
 * that is used is made of them. So a skewed cell of a lattice gives the same lattice as a plain one.
 *
 * A point is taken relative to the lexicographically least one, brought near by the vectors as they were given, and
 * rounded in its coordinates of the cell, not in those of space. So points that the caller moved by lattice vectors, or
 * by an origin, come to the same place of the grid if their differences are on the grid up to rounding.
 *
 * Based on: Nguyen, Stehle. Low-dimensional lattice basis reduction revisited. ACM Trans. Algorithms 2009. */
#include "periodic/lattice.h"
#include "base/finite.h"
#include "base/vector.h"
#include "predicates/predicates.h"
#include <math.h>
#include <string.h>

/* UNIT_BITS: a unit is this many binary digits below the size of a coordinate: 2^53 of them are 16 sizes. */
enum { UNIT_BITS = 49, MOST_ROUNDS = 200, REDUCTIONS = 3 };
static const double MOST_CHANGE = 0x1p26; /* so that all sums of shifts fit into an image */
#define TOO_SKEWED                                                                                                     \
    "the cell is too large, too small or too skewed: its vectors as sums of the shortest ones of their lattice have "  \
    "terms of more than 2^26"

/* --- bases --- */

/* Writes a unit vector along the axis of space that is most upright to v, without its part along v. */
static void upright(const double *v, double *out) {
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(v[k]) < fabs(v[least])) least = k;
    double share = v[least] / brio_dot(v, v);
    for (int k = 0; k < 3; k++) out[k] = (k == least) - share * v[k];
}

/* Completes `rank` vectors to a basis by vectors upright to them, up to rounding, and writes its dual. Returns false if
 * they span too little. */
static bool complete(double (*v)[3], int rank, double (*dual)[3]) {
    double size = 0;
    for (int i = 0; i < rank; i++) size = fmax(size, brio_length(v[i]));
    if (!(size > 0)) return false;
    if (rank == 1) upright(v[0], v[1]);
    if (rank < 3) brio_cross(v[0], v[1], v[2]);
    for (int i = rank; i < 3; i++) {
        double length = brio_length(v[i]);
        if (!(length > 0)) return false;
        for (int k = 0; k < 3; k++) v[i][k] = v[i][k] / length * size + 0.0;
    }
    for (int i = 0; i < 3; i++) brio_cross(v[(i + 1) % 3], v[(i + 2) % 3], dual[i]);
    double det = brio_dot(v[0], dual[0]);
    if (!(fabs(det) > brio_length(v[0]) * brio_length(v[1]) * brio_length(v[2]) * 0x1p-100)) return false;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) dual[i][k] /= det;
    return true;
}

/* Refuses vectors that `complete` does not take: they span nothing, or only if products of their coordinates were to
 * leave the range of doubles. */
static brio_status refuse_span(brio_context *ctx, const brio_lattice *l) {
    static const char *const SPAN[] = {"length", "area", "volume"};
    double longest = 0, scaled[3][3], dual[3][3];
    for (int i = 0; i < l->rank; i++)
        for (int k = 0; k < 3; k++) longest = fmax(longest, fabs(l->given[i][k]));
    for (int i = 0; i < l->rank && longest > 0; i++)
        for (int k = 0; k < 3; k++) scaled[i][k] = ldexp(l->given[i][k], -ilogb(longest));
    if (longest > 0 && complete(scaled, l->rank, dual))
        return brio_fail(ctx, BRIO_ERR_ARGUMENT,
                         "the vectors of the cell are too %s: their greatest coordinate is %g, and products of such "
                         "are no doubles; scale the cell and the points",
                         longest > 1 ? "long" : "short", longest);
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "the periodic vectors of the cell span no %s", SPAN[l->rank - 1]);
}

/* The vectors of a reduction: positions in doubles, and what they are of the first ones. */
typedef struct {
    int rank;
    double v[3][3];
    int64_t change[3][3];
} reduction;

static void swap_vectors(reduction *r, int i, int j) {
    for (int k = 0; k < 3; k++) {
        double x = r->v[i][k];
        int64_t c = r->change[i][k];
        r->v[i][k] = r->v[j][k], r->v[j][k] = x;
        r->change[i][k] = r->change[j][k], r->change[j][k] = c;
    }
}

/* Subtracts n times vector j from vector i. */
static void subtract(reduction *r, int i, int j, double n) {
    for (int k = 0; k < 3; k++) {
        r->v[i][k] = fma(-n, r->v[j][k], r->v[i][k]);
        r->change[i][k] = (int64_t)((uint64_t)r->change[i][k] - (uint64_t)(int64_t)n * (uint64_t)r->change[j][k]);
    }
}

/* Moves vector i to the shortest of its sums with multiples of the vectors before it, two at most. Returns whether it
 * became shorter. */
static bool shorten(reduction *r, int i) {
    double before = brio_dot(r->v[i], r->v[i]), first = brio_dot(r->v[0], r->v[0]);
    if (i == 1) {
        double n = rint(brio_dot(r->v[1], r->v[0]) / first);
        if (n != 0 && fabs(n) < 0x1p52) subtract(r, 1, 0, n);
        return brio_dot(r->v[1], r->v[1]) < before * (1 - 0x1p-40);
    }
    double b = brio_dot(r->v[1], r->v[1]), ab = brio_dot(r->v[0], r->v[1]), ca = brio_dot(r->v[2], r->v[0]),
           cb = brio_dot(r->v[2], r->v[1]), det = first * b - ab * ab;
    double y = floor((cb * first - ca * ab) / det), x = floor((ca * b - cb * ab) / det), best = INFINITY, m = 0, n = 0;
    if (!(fabs(x) < 0x1p52 && fabs(y) < 0x1p52)) return false;
    for (int t = -1; t < 3; t++)
        for (int s = -1; s < 3; s++) {
            double w[3];
            for (int k = 0; k < 3; k++) w[k] = fma(-(x + s), r->v[0][k], fma(-(y + t), r->v[1][k], r->v[2][k]));
            if (brio_dot(w, w) < best) best = brio_dot(w, w), m = x + s, n = y + t;
        }
    if (!(best < before * (1 - 0x1p-40))) return false;
    subtract(r, 2, 0, m);
    subtract(r, 2, 1, n);
    return true;
}

/* Reduces the vectors: the greedy algorithm, which sorts them by length and shortens the longest. */
static void reduce(reduction *r) {
    for (int round = 0; round < MOST_ROUNDS; round++) {
        bool shorter = false;
        for (int i = 1; i < r->rank; i++)
            for (int j = i; j > 0 && brio_dot(r->v[j], r->v[j]) < brio_dot(r->v[j - 1], r->v[j - 1]); j--)
                swap_vectors(r, j, j - 1);
        for (int i = 1; i < r->rank; i++) shorter |= shorten(r, i);
        if (!shorter) return;
    }
}

static void begin(const double (*v)[3], int rank, reduction *r) {
    memset(r, 0, sizeof *r);
    r->rank = rank;
    for (int i = 0; i < rank; i++) {
        memcpy(r->v[i], v[i], sizeof r->v[i]);
        r->change[i][i] = 1;
    }
}

/* --- the grid --- */

/* Returns the least power of two that is not less. */
static double power_above(double x) {
    int exponent;
    double share = frexp(x, &exponent);
    return share == 0.5 ? x : ldexp(1, exponent);
}

/* Chooses the units for a basis and for points that reach as far as `reach`. Returns false if they would underflow. */
static bool choose_units(brio_lattice *l, const double (*v)[3], const double *reach) {
    for (int k = 0; k < 3; k++) {
        double size = 0, whole = 0;
        for (int i = 0; i < l->rank; i++) {
            size = fmax(size, fabs(v[i][k]));
            whole = fmax(whole, fabs(l->given[i][k]));
        }
        l->unit[k] = 0;
        if (whole == 0) continue;
        size = power_above(fmax(size, reach[k]));
        l->unit[k] = size * exp2(-UNIT_BITS);
        if (!(l->unit[k] >= 0x1p-1000 && size <= 0x1p900)) return false;
    }
    return true;
}

/* Adds n v to a pair of doubles. */
static inline void add_product(double *high, double *low, double n, double v) {
    double product = n * v, error = fma(n, v, -product), sum = *high + product, part = sum - *high;
    *low += ((*high - (sum - part)) + (product - part)) + error;
    *high = sum;
}

/* Computes the reduced vectors from those that were given, rounded once. */
static void combine(const brio_lattice *l, const reduction *r, double (*out)[3]) {
    for (int i = 0; i < l->rank; i++)
        for (int k = 0; k < 3; k++) {
            double high = 0, low = 0;
            for (int j = 0; j < l->rank; j++) add_product(&high, &low, (double)r->change[i][j], l->given[j][k]);
            out[i][k] = high + low;
        }
}

/* Rounds the reduced vectors to the grid. */
static void round_basis(brio_lattice *l) {
    l->moved = 0;
    for (int i = 0; i < l->rank; i++)
        for (int k = 0; k < 3; k++) {
            double grain = BRIO_LATTICE_GRAIN * l->unit[k];
            l->basis[i][k] = grain > 0 ? rint(l->near[i][k] / grain) * grain + 0.0 : 0;
            l->moved = fmax(l->moved, fabs(l->basis[i][k] - l->near[i][k]));
        }
}

/* Computes the caller's vectors from the basis: `change` is inverted, whose determinant is 1 or -1. */
static void find_used(brio_lattice *l) {
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, inverse[3][3];
    for (int i = 0; i < l->rank; i++)
        for (int j = 0; j < l->rank; j++) m[i][j] = (double)l->change[i][j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            double high = 0, low = 0; /* exact below 2^106 */
            add_product(&high, &low, m[a][c], m[b][d]);
            add_product(&high, &low, -m[a][d], m[b][c]);
            inverse[i][j] = high + low;
        }
    double det = 0;
    for (int j = 0; j < 3; j++) det += m[0][j] * inverse[j][0];
    for (int j = 0; j < l->rank; j++)
        for (int k = 0; k < 3; k++) {
            double high = 0, low = 0;
            for (int i = 0; i < l->rank; i++)
                add_product(&high, &low, det < 0 ? -inverse[j][i] : inverse[j][i], l->basis[i][k]);
            l->used[j][k] = high + low + 0.0;
        }
}

/* Short vectors of a lattice, up to their signs: sums of the basis with factors -1, 0 and 1. */
typedef struct {
    double list[13][3];
    int count;
} short_vectors;

static void list_short(const brio_lattice *l, short_vectors *w) {
    w->count = 0;
    for (int n = 14; n < 27; n++) { /* factors in base 3; the others are the negatives */
        int factor[3] = {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
        bool used = true;
        for (int i = l->rank; i < 3; i++) used &= factor[2 - i] == 0;
        if (!used) continue;
        for (int k = 0; k < 3; k++) {
            w->list[w->count][k] = 0;
            for (int i = 0; i < l->rank; i++) w->list[w->count][k] += factor[2 - i] * l->basis[i][k];
        }
        w->count++;
    }
}

/* Returns a bound on |d . x| in twice the lattice's Voronoi cell, from the slabs of three vectors: d is a sum of these.
 * Rounding is in it: the nearer to a plane they are, and the longer, the more. INFINITY if they span too little. */
static double bound_by(const brio_lattice *l, const double *d, const double *const *v) {
    double cross[3][3], sum = 0;
    for (int i = 0; i < 3; i++) brio_cross(v[(i + 1) % 3], v[(i + 2) % 3], cross[i]);
    double det = brio_dot(v[0], cross[0]), plain[3];
    brio_cross(l->basis[1], l->basis[2], plain);
    if (!(fabs(det) > fabs(brio_dot(l->basis[0], plain)) / 2)) return INFINITY; /* a multiple of it, for a lattice */
    double lost = 0x1p-48 * brio_length(d) * brio_length(v[0]) * brio_length(v[1]) * brio_length(v[2]) / fabs(det);
    for (int i = 0; i < l->rank; i++)
        sum += fabs(brio_dot(d, cross[i]) / det) * brio_dot(v[i], v[i]) + lost * brio_length(v[i]);
    return sum;
}

/* Bounds how far two points of a tetrahedron differ. Each is in the lattice's Voronoi cell about the other's, which the
 * slabs |w . x| <= |w|^2 / 2 of short vectors w hold. The best three of these give the maximum (a linear program). */
static void find_range(brio_lattice *l, const double *reach) {
    short_vectors w;
    list_short(l, &w);
    for (int i = 0; i < l->rank; i++) {
        double slack = 1, least = INFINITY;
        for (int a = 0; a < w.count; a++)
            for (int b = l->rank > 1 ? a + 1 : 0; b < (l->rank > 1 ? w.count : 1); b++)
                for (int c = l->rank > 2 ? b + 1 : 0; c < (l->rank > 2 ? w.count : 1); c++) {
                    const double *v[3] = {w.list[a], l->rank > 1 ? w.list[b] : l->basis[1],
                                          l->rank > 2 ? w.list[c] : l->basis[2]};
                    least = fmin(least, bound_by(l, l->dual[i], v));
                }
        for (int k = 0; k < 3; k++) slack += fabs(l->dual[i][k]) * reach[k];
        l->range[i] = least + (least + slack) * 0x1p-44; /* rounding, and vectors that are not quite upright */
    }
}

static double volume_of(const double (*v)[3], int rank) {
    double cross[3];
    if (rank == 0) return 1;
    if (rank == 1) return brio_length(v[0]);
    brio_cross(v[rank - 2], v[rank - 1], cross);
    return rank == 2 ? brio_length(cross) : fabs(brio_dot(v[0], cross));
}

/* --- points --- */

/* Subtracts the origin and `n` of the given vectors from a point. Most points need none of them. */
static void subtract_cells(const brio_lattice *l, const double *point, const double *n, double *x) {
    for (int k = 0; k < 3; k++) {
        double high = point[k], low = 0;
        add_product(&high, &low, -1, l->origin[k]);
        for (int j = 0; j < l->rank; j++)
            if (n[j] != 0) add_product(&high, &low, -n[j], l->given[j][k]);
        x[k] = high + low;
    }
}

/* Brings a point near the origin by the vectors as they were given: into the given cell, then into the reduced one.
 *  n  receives how many were subtracted. */
static bool bring_near(const brio_lattice *l, const double *point, double *x, double *n) {
    double zero[3] = {0, 0, 0}, m[3] = {0, 0, 0};
    subtract_cells(l, point, zero, x);
    for (int j = 0; j < l->rank; j++) {
        n[j] = floor(brio_dot(l->given_dual[j], x));
        if (!(fabs(n[j]) <= MOST_CHANGE)) return false;
    }
    if (n[0] != 0 || n[1] != 0 || n[2] != 0) subtract_cells(l, point, n, x);
    for (int i = 0; i < l->rank; i++) m[i] = floor(brio_dot(l->near_dual[i], x));
    if (m[0] == 0 && m[1] == 0 && m[2] == 0) return true;
    for (int j = 0; j < l->rank; j++)
        for (int i = 0; i < l->rank; i++) n[j] += m[i] * (double)l->change[i][j];
    subtract_cells(l, point, n, x);
    return true;
}

/* Returns whether coordinate i in the basis is at least 0, exactly. */
static bool is_at_least_0(const brio_lattice *l, int i, const double *x) {
    static const double zero[3] = {0, 0, 0};
    const double *u = l->basis[(i + 1) % 3], *v = l->basis[(i + 2) % 3];
    int side = brio_orient3d(zero, u, v, x);
    return side == 0 || side == brio_orient3d(zero, u, v, l->basis[i]);
}

/* Returns how many vectors i to subtract from a position, so that its coordinate is in [0, 1). */
static double cells_off(const brio_lattice *l, int i, const double *x) {
    double share = brio_lattice_share(l, i, x), whole = floor(share), size = 1;
    for (int k = 0; k < 3; k++) size += fabs(l->dual[i][k] * x[k]);
    if (share - whole > size * 0x1p-40 && whole + 1 - share > size * 0x1p-40) return whole;
    double moved[3];
    whole = rint(share); /* the coordinate is about this integer */
    for (int k = 0; k < 3; k++) moved[k] = x[k] - whole * l->basis[i][k];
    return is_at_least_0(l, i, moved) ? whole : whole - 1;
}

bool brio_lattice_home(const brio_lattice *l, const double *point, brio_home *home) {
    double n[3] = {0, 0, 0}, near[3];
    if (!bring_near(l, point, near, n)) return false;
    memcpy(home->x, near, sizeof near);
    for (int i = 0; i < l->rank; i++) {
        double share = brio_dot(l->near_dual[i], near);
        for (int k = 0; k < 3; k++) home->x[k] += share * (l->basis[i][k] - l->near[i][k]);
    }
    home->moved = 0;
    for (int k = 0; k < 3; k++) {
        home->x[k] = l->unit[k] > 0 ? rint(home->x[k] / l->unit[k]) * l->unit[k] : near[k];
        double moved = fabs(home->x[k] - near[k]);
        home->moved = moved > home->moved ? moved : home->moved;
    }
    for (int k = 0; k < 3; k++) home->x[k] -= l->corner[k]; /* exact */
    double shift[3] = {-n[0], -n[1], -n[2]};
    for (int i = 0; i < l->rank; i++) {
        double m = cells_off(l, i, home->x);
        if (m == 0) continue;
        for (int k = 0; k < 3; k++) home->x[k] -= m * l->basis[i][k];
        for (int j = 0; j < l->rank; j++) shift[j] -= m * (double)l->change[i][j];
    }
    for (int j = 0; j < 3; j++) {
        if (!(fabs(shift[j]) <= 2 * MOST_CHANGE - 1)) return false;
        home->shift[j] = (int64_t)shift[j];
    }
    for (int k = 0; k < 3; k++) home->x[k] += 0.0; /* no -0 */
    return true;
}

double brio_lattice_size(const brio_lattice *l, int k) {
    return ldexp(l->unit[k], UNIT_BITS);
}

bool brio_lattice_reaches(const brio_lattice *l, const double *x) {
    for (int k = 0; k < 3 && l->rank < 3; k++) {
        double cells = 0; /* by which the coordinate may differ where the domain begins elsewhere */
        for (int i = 0; i < l->rank; i++) cells += fabs(l->basis[i][k]);
        if (!(fabs(x[k] + l->corner[k]) <= (brio_lattice_size(l, k) - cells) / 2) && l->unit[k] > 0) return false;
    }
    return true;
}

void brio_lattice_given(const brio_lattice *l, const double *x, const int32_t shift[3], double *out) {
    double whole[3], share[3];
    for (int k = 0; k < 3; k++) whole[k] = x[k] + l->corner[k]; /* exact: both are on the grid */
    for (int i = 0; i < l->rank; i++) share[i] = brio_lattice_share(l, i, whole);
    for (int k = 0; k < 3; k++) {
        double high = whole[k], low = 0;
        add_product(&high, &low, 1, l->origin[k]);
        for (int i = 0; i < l->rank; i++) add_product(&high, &low, -share[i], l->basis[i][k] - l->near[i][k]);
        for (int j = 0; j < l->rank; j++) add_product(&high, &low, -shift[j], l->given[j][k]);
        out[k] = high + low + 0.0;
    }
}

/* --- all together --- */

/* Takes the lexicographically least point for the origin, in the coordinates that are rounded. */
static void choose_origin(brio_lattice *l, const double *points, size_t n) {
    const double *least = points;
    for (size_t p = 1; p < n; p++)
        if (brio_lexicographic(points + 3 * p, least) < 0) least = points + 3 * p;
    for (int k = 0; k < 3; k++) {
        bool rounded = false;
        for (int j = 0; j < l->rank; j++) rounded |= l->given[j][k] != 0;
        l->origin[k] = n && rounded ? least[k] : 0;
    }
}

/* Finds how far points reach in space when they are near; with three translations, not beyond the basis. */
static bool find_reach(const brio_lattice *l, const double *points, size_t n, double *reach) {
    double x[3], cells[3] = {0, 0, 0};
    memset(reach, 0, 3 * sizeof *reach);
    for (size_t p = 0; p < n && l->rank < 3; p++) {
        if (!bring_near(l, points + 3 * p, x, cells)) return false;
        for (int k = 0; k < 3; k++) reach[k] = fmax(reach[k], fabs(x[k]));
    }
    return true;
}

/* Lets the domain begin where the points do, if they are in one cell already: then they stay where they are. */
static void choose_corner(brio_lattice *l, const double *points, size_t n) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, x[3];
    for (size_t p = 0; p < n; p++)
        for (int i = 0; i < l->rank; i++) {
            for (int k = 0; k < 3; k++) x[k] = points[3 * p + (size_t)k] - l->origin[k];
            double share = brio_lattice_share(l, i, x);
            low[i] = fmin(low[i], share), high[i] = fmax(high[i], share);
        }
    for (int i = 0; i < l->rank && n; i++)
        if (!(high[i] - low[i] < 1 + 0x1p-30 && fabs(low[i]) < 1)) return;
    for (int k = 0; k < 3 && n; k++) {
        double sum = 0;
        for (int i = 0; i < l->rank; i++) sum += (low[i] - 0x1p-40) * l->basis[i][k];
        l->corner[k] = l->unit[k] > 0 ? rint(sum / l->unit[k]) * l->unit[k] : 0;
    }
}

static brio_status take_vectors(brio_context *ctx, const brio_periodic_options *o, brio_lattice *l) {
    memset(l, 0, sizeof *l);
    for (int j = 0; j < 3; j++) {
        if (o->open[j]) continue;
        BRIO_EXPECT(ctx, brio_all_finite(o->cell + 3 * j, 3), BRIO_ERR_ARGUMENT, "vector %c of the cell is not finite",
                    "abc"[j]);
        memcpy(l->given[l->rank], o->cell + 3 * j, sizeof l->given[0]);
        l->axis[l->rank++] = j;
    }
    BRIO_EXPECT(ctx, l->rank > 0, BRIO_ERR_ARGUMENT, "no direction is periodic: this is what brio_delaunay does");
    return BRIO_OK;
}

brio_status brio_lattice_new(brio_context *ctx, const brio_periodic_options *options, const double *points,
                             size_t num_points, brio_lattice *l) {
    double reach[3];
    reduction r;
    BRIO_FORWARD(take_vectors(ctx, options, l));
    choose_origin(l, points, num_points);
    if (!complete(l->given, l->rank, l->given_dual)) return refuse_span(ctx, l);
    begin((const double(*)[3])l->given, l->rank, &r);
    for (int round = 0; round < REDUCTIONS; round++) {
        reduce(&r);
        for (int i = 0; i < l->rank; i++)
            for (int j = 0; j < l->rank; j++)
                BRIO_EXPECT(ctx, fabs((double)r.change[i][j]) <= MOST_CHANGE, BRIO_ERR_ARGUMENT, TOO_SKEWED);
        combine(l, &r, r.v);
    }
    memcpy(l->near, r.v, sizeof l->near);
    memcpy(l->change, r.change, sizeof l->change);
    if (!complete(l->near, l->rank, l->near_dual)) return refuse_span(ctx, l);
    BRIO_EXPECT(ctx, find_reach(l, points, num_points, reach), BRIO_ERR_ARGUMENT,
                "a point is more than 2^26 cells away from the others");
    for (int k = 0; k < 3 && l->rank < 3; k++) reach[k] = fmax(reach[k], options->reach);
    BRIO_EXPECT(ctx, choose_units(l, (const double(*)[3])l->near, reach), BRIO_ERR_ARGUMENT, TOO_SKEWED);
    round_basis(l);
    find_used(l);
    if (!complete(l->basis, l->rank, l->dual)) return refuse_span(ctx, l);
    find_range(l, reach);
    for (int i = 0; i < l->rank; i++) /* before all translates are made that would matter */
        BRIO_EXPECT(ctx, l->range[i] <= BRIO_LATTICE_MOST_SHIFT, BRIO_ERR_ARGUMENT,
                    "the reduced basis of the cell is so skewed that translates by %.0f cells matter",
                    ceil(l->range[i]));
    choose_corner(l, points, num_points);
    l->volume = volume_of((const double(*)[3])l->basis, l->rank);
    return BRIO_OK;
}
