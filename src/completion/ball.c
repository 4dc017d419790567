/* Regions of conflict: see completion.h.
 *
 * Let c be the centre of a tetrahedron's orthosphere and c' the one that was computed, with |c - c'| <= d. For a point
 * x of weight w and a vertex p of weight v,
 *     |x - c'|^2 - w - (|p - c'|^2 - v) = (|x - c|^2 - w) - (|p - c|^2 - v) + 2 (x - p)(c - c').
 * If x is in conflict, the first two terms on the right are at most 0 together, so the left side is at most
 * 2 d |x - p|. So `square` is |p - c'|^2 - v + 2 d D for any vertex p, where D is the diagonal of the box of all
 * points. All roundings together stay below a factor of 1 +- 2^-46, and TINY stands for what underflows.
 *
 * Of a nearly flat tetrahedron |c - p| may be 10^13 times D. A comparison of squares as large as |c - p|^2 then says of
 * no point that it is outside. So points and boxes are compared by the difference of the squares. With u = c - p and
 * d = x - p,
 *     |p - c|^2 - |x - c|^2 = d (2 u - d),
 * and x is in conflict if this is at least v - w. The roundings of the sum over the coordinates stay below 2^-48 of
 * |d| (2 |u| + |d|) + |v| + |w|, and the error of u changes it by at most 4 error |d|. What is in conflict has
 * |d| <= |u| + sqrt(square + w), and |d| <= D. */
#include "completion/completion.h"

static const double SLACK = BRIO_BALL_SLACK, TINY = BRIO_BALL_TINY, ROUNDINGS = 0x1p-48;

void brio_ball_set_region(brio_ball *ball, double error, const brio_ball_box *all) {
    const double *p = ball->vertex[0];
    double diagonal = 0, length = 0, heaviest = fabs(all->weight);
    brio_ball_set_square(ball, error, all);
    ball->least = -INFINITY;
    if (!(ball->square < INFINITY)) return;
    for (int k = 0; k < 3; k++) {
        ball->way[k] = ball->centre[k] - p[k];
        diagonal += fabs(all->high[k] - all->low[k]);
        length += fabs(ball->way[k]) + error;
    }
    double most = fmin(diagonal, length + sqrt(fmax(0, ball->square + all->weight))) * (1 + SLACK);
    double margin = (most * (2 * length + most) + fabs(p[3]) + heaviest) * ROUNDINGS + 4 * error * most + TINY;
    if (margin < INFINITY) ball->least = p[3] - margin;
}

/* Returns whether a corner of the box may be behind the facet: the corners at which the facet's normal n is greatest.
 * Where the sign of a coordinate of n is not sure, both sides of the box count. */
bool brio_facet_meets(brio_filter *f, const brio_ball *ball, const brio_ball_box *box) {
    const double *a = ball->vertex[0], *b = ball->vertex[1], *c = ball->vertex[2];
    double u[3], v[3], value = 0, margin = 0;
    int first[3], last[3]; /* sides of the box to try: 0 low, 1 high */
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double n = u[i] * v[j] - u[j] * v[i], error = (fabs(u[i] * v[j]) + fabs(u[j] * v[i])) * SLACK + TINY;
        double low = box->low[k] - a[k], high = box->high[k] - a[k], far = fmax(fabs(low), fabs(high));
        value += fmax(n * low, n * high);
        margin += (error + fabs(n) * SLACK) * far + TINY;
        first[k] = n > error ? 1 : 0;
        last[k] = n < -error ? 0 : 1;
    }
    if (value > margin) return true;
    if (value < -margin) return false;
    for (int x = first[0]; x <= last[0]; x++)
        for (int y = first[1]; y <= last[1]; y++)
            for (int z = first[2]; z <= last[2]; z++) {
                double corner[4] = {x ? box->high[0] : box->low[0], y ? box->high[1] : box->low[1],
                                    z ? box->high[2] : box->low[2], 0};
                if (brio_orient3d_sign(f, a, b, c, corner) > 0) return true;
            }
    return false;
}

bool brio_ball_takes(brio_filter *f, const brio_ball *ball, const double *record) {
    const double *a = ball->vertex[0], *b = ball->vertex[1], *c = ball->vertex[2], *d = ball->vertex[3];
    if (ball->infinite) return brio_orient3d_sign(f, a, b, c, record) > 0;
    for (int i = 0; i < 4; i++)
        if (brio_same_position(ball->vertex[i], record)) return f->weighted && record[3] > ball->vertex[i][3];
    return brio_conflict(f, a, b, c, d, record, f->weighted);
}
