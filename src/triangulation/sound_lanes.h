/* Tetrahedra whose vertices have moved: whether they are still those of the triangulation, and for how long; included
 * after conflict_lanes.h.
 *
 * With all rows relative to vertex a, the in-sphere determinant of (a, b, c, d) and a query e is
 *   D = lift(e) V - e . X,   V = det [b, c, d],   X = lift(b) (c x d) + lift(c) (d x b) + lift(d) (b x c),
 * so what a tetrahedron has is computed once for the vertices behind all of its facets. First-order errors:
 * minors 13 u of their permanents, products 15 u, the sum 18 u; one and a half times that covers the rest, 20 u and
 * 27 u. A permanent is at most what the static bound has. Where no row is longer than L, and no lift greater than L^2,
 * it is also at most the product of the sums of the magnitudes in three rows, sqrt(27) L^3, and four times that with
 * lifts: the errors are below 128 u L^3 and 1024 u L^5, far less than the static bounds in a large box. On a lattice
 * everything is exact, as in conflict_lanes.h.
 *
 * The slack of a tetrahedron is a distance that each point may go while V > 0 and all D > 0 hold; derived in
 * docs/decisions/025. X = 2 V c for the orthocentre c. With V_i, V with vertex i replaced by e, M the largest of
 * 2 V |p - c| for the vertices p, E that of e, and A twice the area of all facets, points that go by s change D and V
 * by at most
 *   s (E + (M / V) (|V_a| + |V_b| + |V_c| + |V_d|) + D A / V) + 320 s^2 L^3   and   s A + 12.3 s^2 L,
 * where no row is longer, and no lift greater than of a row of length L >= 32 s. Without weights M is 2 V |a - c|, and
 * E is at most M + 2 D V / M. The first part gets 0.9 of D and V, the second 0.1.
 *
 * Based on: de Castro, Tournois, Alliez, Devillers. Filtering relocations on a Delaunay triangulation. CGF 2009.
 * Differs from the paper: the distance is of a tetrahedron, from the gradient of the determinant; no spheres. */

/* Of LANES tetrahedra: the records of their vertices and of those behind facets. Where a vertex behind a facet is not
 * asked for, or is infinite, that of vertex 0 stands for it. */
typedef struct {
    const double *vertex[4][LANES], *apex[4][LANES];
    unsigned asked[4];
} star_rows;

/* Finds the rows of finite tetrahedra. Asked for are vertices of finite ones of higher number; behind a facet of a
 * finite tetrahedron is an infinite one just where the vertex there is infinite. */
static inline void find_rows(const brio_tetrahedra *t, const uint32_t tets[LANES], star_rows *r) {
    for (int s = 0; s < 4; s++) r->asked[s] = 0;
    for (int i = 0; i < LANES; i++) {
        const brio_tetrahedron *tet = &t->tet[tets[i]];
        uint32_t last = brio_facet_of(tets[i], 3), own = tet->vertex[0];
        for (int s = 0; s < 4; s++) {
            uint32_t mate = tet->mate[s], apex = t->tet[brio_tet_of(mate)].vertex[brio_slot_of(mate)];
            unsigned ask = (unsigned)(mate > last) & (unsigned)(apex != t->infinite);
            r->vertex[s][i] = t->record[tet->vertex[s]];
            r->apex[s][i] = t->record[own ^ ((apex ^ own) & (0 - ask))]; /* without a branch */
            r->asked[s] |= ask << i;
        }
    }
}

/* --- the arithmetic --- */

typedef struct {
    lanes v[4]; /* x, y, z, lift, relative to vertex a */
    lanes square;
} moved_row;

/* What a batch of tetrahedra has. */
typedef struct {
    lanes b_normal[3], c_normal[3], d_normal[3]; /* c x d, d x b, b x c */
    lanes x[3], volume;
    lanes most;         /* M */
    lanes longest;      /* the square of L */
    lanes above, below; /* of the facet that gives the least slack so far: what s multiplies, and D */
    lanes least;        /* of all D */
} moved_tets;

/* Sets x, y, z and the lift of a vertex relative to vertex a. */
static inline void row_about(const double *const row[LANES], const lanes a[4], moved_row *r, const bool weighted) {
    lanes v[4];
    load_rows(row, true, v);
    for (int k = 0; k < 3; k++) r->v[k] = v[k] - a[k];
    r->v[3] = r->square = square_length(r->v[0], r->v[1], r->v[2]);
    if (weighted) r->v[3] -= v[3] - a[3];
}

static inline lanes dot(const lanes p[3], const lanes q[3]) {
    return multiply_add(p[0], q[0], multiply_add(p[1], q[1], p[2] * q[2]));
}

static inline void cross(const lanes p[3], const lanes q[3], lanes out[3]) {
    out[0] = multiply_subtract(p[1], q[2], p[2] * q[1]);
    out[1] = multiply_subtract(p[2], q[0], p[0] * q[2]);
    out[2] = multiply_subtract(p[0], q[1], p[1] * q[0]);
}

/* Returns the square of 2 V |p - c| for the vertices of a row. */
static inline lanes square_reach(const moved_tets *m, const moved_row *r) {
    lanes from[3];
    for (int k = 0; k < 3; k++) from[k] = multiply_subtract(all(2) * m->volume, r->v[k], m->x[k]);
    return dot(from, from);
}

/* Takes vertices into the bound of lengths. */
static inline void lengthen(moved_tets *m, const moved_row *r, const bool weighted) {
    m->longest = maximum(m->longest, r->square);
    if (weighted) m->longest = maximum(m->longest, magnitude(r->v[3]));
}

static inline void tets_set(moved_tets *m, const moved_row *b, const moved_row *c, const moved_row *d,
                            const bool weighted) {
    cross(c->v, d->v, m->b_normal);
    cross(d->v, b->v, m->c_normal);
    cross(b->v, c->v, m->d_normal);
    for (int k = 0; k < 3; k++)
        m->x[k] =
            multiply_add(b->v[3], m->b_normal[k], multiply_add(c->v[3], m->c_normal[k], d->v[3] * m->d_normal[k]));
    m->volume = dot(b->v, m->b_normal);
    m->longest = b->square;
    lengthen(m, b, weighted), lengthen(m, c, weighted), lengthen(m, d, weighted);
    m->most = dot(m->x, m->x);
    if (weighted) {
        lanes others = maximum(square_reach(m, c), square_reach(m, d));
        m->most = maximum(maximum(m->most, square_reach(m, b)), others);
    }
    m->most = root(m->most);
    m->above = all(0), m->below = m->least = all(1e200);
}

/* Takes the vertices behind a facet into the bounds. Returns the bits of those at the position of vertex a, which are
 * left out. */
static inline unsigned stand(moved_tets *m, const moved_row *e, const bool weighted) {
    lanes b = dot(e->v, m->b_normal), c = dot(e->v, m->c_normal), d = dot(e->v, m->d_normal);
    lanes volumes = magnitude(b) + magnitude(c) + magnitude(d) + magnitude(m->volume - b - c - d);
    lanes rate = weighted ? m->most * volumes + m->volume * root(square_reach(m, e)) : m->most * (volumes + m->volume);
    lane_mask none = equal(e->square, all(0));
    lanes det = choose(none, all(1e200), multiply_subtract(e->v[3], m->volume, dot(e->v, m->x)));
    lane_mask worse = greater(rate * m->below, m->above * det);
    m->above = choose(worse, rate, m->above);
    m->below = choose(worse, det, m->below);
    m->least =
        choose(greater(m->least, det), det, m->least) + (det - det); /* no number where det is none or infinite */
    lengthen(m, e, weighted);
    return bits_of(none);
}

static inline lanes minimum(lanes x, lanes y) {
    return choose(greater(x, y), y, x);
}

/* Takes what roundings may have added off V and all D; every D loses the share that the least one does, at least.
 * Returns the bits of the lanes in which they stay positive. */
static inline unsigned take_errors_off(moved_tets *m, const brio_filter *f, lane_mask ordinary, lanes length) {
    lanes cube = length * m->longest, none = all(INFINITY);
    lanes orient = choose(ordinary, all(0x1p-46) * cube, none);
    lanes insphere = choose(ordinary, all(0x1p-43) * (cube * m->longest), none);
    lanes least = m->least - minimum(insphere, all(1.5 * f->insphere_static));
    m->volume -= minimum(orient, all(1.5 * f->orient_static));
    m->below *= all(1 - 0x1p-40) * least / m->least;
    m->least = least;
    return bits_of(both(greater(m->volume, all(0)), greater(least, all(0))));
}

/* Returns the slacks of tetrahedra that are sound: 0 where roundings might count. */
static inline lanes slacks(const moved_tets *m, lane_mask ordinary, lanes length, const bool weighted) {
    lanes about[3], cube = length * m->longest, volume = m->volume;
    for (int k = 0; k < 3; k++) about[k] = m->b_normal[k] + m->c_normal[k] + m->d_normal[k];
    lanes area = all(2) * root(dot(about, about) + dot(m->b_normal, m->b_normal) + dot(m->c_normal, m->c_normal) +
                               dot(m->d_normal, m->d_normal)); /* of four lengths, by their squares */
    lanes rate = m->above / m->below + area;
    if (!weighted) rate += all(2) * volume * volume / m->most;
    lanes first = all(0.9) * volume / rate;
    lanes second = root(all(0.1 / 320) * minimum(all(26) * volume * m->longest, m->least) / cube);
    lanes slack = minimum(minimum(first, second), length * all(1.0 / 32));
    return choose(both(ordinary, greater(volume, all(0x1p-20) * cube)), all(0.999) * slack, all(0));
}

/* Returns the bits of the lanes whose tetrahedra are certainly sound, and their slacks. */
static inline __attribute__((always_inline)) unsigned lanes_sound(const star_rows *near, const brio_filter *f,
                                                                  double slack[LANES], const bool weighted) {
    lanes a[4];
    moved_row b, c, d, e;
    moved_tets m;
    load_rows(near->vertex[0], true, a);
    row_about(near->vertex[1], a, &b, weighted);
    row_about(near->vertex[2], a, &c, weighted);
    row_about(near->vertex[3], a, &d, weighted);
    tets_set(&m, &b, &c, &d, weighted);
    unsigned met = 0; /* vertices that have met vertex a */
    for (int s = 0; s < 4; s++) {
        row_about(near->apex[s], a, &e, weighted);
        met |= stand(&m, &e, weighted) & near->asked[s];
    }
    lanes length = root(m.longest);
    lane_mask ordinary = both(greater(m.longest, all(1e-40)), greater(all(1e40), m.longest));
    unsigned sound = take_errors_off(&m, f, ordinary, length) & ~met;
    store_lanes(slack, slacks(&m, ordinary, length, weighted));
    return sound & ((1u << LANES) - 1);
}
