/* Tests of tetrahedra whose vertices have moved, side by side in the lanes of vector registers; included by one
 * source file an instruction set, after conflict_lanes.h.
 *
 * With all rows relative to vertex a, the in-sphere determinant of (a, b, c, d) and a query e is
 *   e.x X + e.y Y + e.z Z - lift(e) V,   V = det [b, c, d],   X, Y, Z = V with a column replaced by the lifts, so
 *   the minors of a tetrahedron are computed once for the vertices behind all of its facets. First-order errors:
 *   minors 13 u of their permanents, products 15 u, the sum 18 u; one and a half times the static bound, which is 18
 *   u, covers the rest. On a lattice everything is exact, as in conflict_lanes.h. */
#include "triangulation/engine.h"

/* Returns the determinant of three columns of three rows. */
static inline lanes determinant3(const lanes p[3], const lanes q[3], const lanes r[3]) {
    lanes x = multiply_subtract(q[1], r[2], q[2] * r[1]), y = multiply_subtract(q[2], r[0], q[0] * r[2]);
    lanes z = multiply_subtract(q[0], r[1], q[1] * r[0]);
    return multiply_add(p[0], x, multiply_add(p[1], y, p[2] * z));
}

/* Writes x, y, z and the lift of a vertex relative to vertex a. */
static inline void row_about(const double *const row[LANES], const lanes a[4], lanes out[4], const bool weighted) {
    lanes v[4];
    load_rows(row, true, v);
    for (int k = 0; k < 3; k++) out[k] = v[k] - a[k];
    out[3] = square_length(out[0], out[1], out[2]);
    if (weighted) out[3] -= v[3] - a[3];
}

/* Returns the bits of the lanes whose tetrahedra are certainly sound. */
static inline __attribute__((always_inline)) unsigned lanes_sound(const brio_tetrahedra *t, const brio_filter *f,
                                                                  const uint32_t tets[LANES], const bool weighted) {
    const double *row[4][LANES], *apex[4][LANES];
    unsigned asked[4] = {0, 0, 0, 0};
    for (int i = 0; i < LANES; i++) {
        const brio_tetrahedron *tet = &t->tet[tets[i]];
        for (int s = 0; s < 4; s++) {
            uint32_t mate = tet->mate[s], other = brio_tet_of(mate);
            const uint32_t *v = t->tet[other].vertex;
            uint32_t ask = (uint32_t)(other > tets[i]) & (uint32_t)(v[3] != t->infinite), own = tet->vertex[0];
            row[s][i] = t->record[tet->vertex[s]];
            apex[s][i] = t->record[own ^ ((v[brio_slot_of(mate)] ^ own) & (0 - ask))]; /* without a branch */
            asked[s] |= ask << i;
        }
    }
    lanes a[4], b[4], c[4], d[4];
    load_rows(row[0], true, a);
    row_about(row[1], a, b, weighted);
    row_about(row[2], a, c, weighted);
    row_about(row[3], a, d, weighted);
    lanes columns[4][3];
    for (int k = 0; k < 4; k++) columns[k][0] = b[k], columns[k][1] = c[k], columns[k][2] = d[k];
    lanes volume = determinant3(columns[0], columns[1], columns[2]);
    lanes x = determinant3(columns[3], columns[1], columns[2]), y = determinant3(columns[0], columns[3], columns[2]);
    lanes z = determinant3(columns[0], columns[1], columns[3]);
    unsigned sound = bits_of(greater(volume, all(1.5 * f->orient_static)));
    for (int s = 0; s < 4; s++) {
        lanes e[4];
        row_about(apex[s], a, e, weighted);
        lanes inside = multiply_add(e[0], x, multiply_add(e[1], y, e[2] * z));
        sound &= bits_of(greater(multiply_subtract(e[3], volume, inside), all(1.5 * f->insphere_static))) | ~asked[s];
    }
    return sound;
}

static inline __attribute__((always_inline)) unsigned
batch_sound(const brio_tetrahedra *t, const brio_filter *f, const uint32_t tets[BRIO_BATCH], const bool weighted) {
    unsigned sound = 0;
    for (int i = 0; i < BRIO_BATCH; i += LANES)
        sound |= (lanes_sound(t, f, tets + i, weighted) & ((1u << LANES) - 1)) << i;
    return sound;
}
