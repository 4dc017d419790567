/* Flips that only deform the boundary of labels.
 *
 * The link of a sample is a sphere, triangulated by the tetrahedra of its star, and the boundary of the labels cuts the
 * link along closed curves. At a sample that is not singular, the curve is a single one that does not touch itself, or
 * there is none. A flip keeps that, at all four samples, in three cases. Of the facets of the tetrahedron,
 *   one leads to the other label, and the sample opposite to it is not on the boundary, but is afterwards; or
 *   two do, and the edge that they do not share is not on the boundary, but is afterwards; or
 *   three do, and the sample that they share leaves the boundary.
 * The facets of the boundary become more by 2, 0 and -2, its samples by 1, 0 and -1. So the Euler characteristic stays.
 *
 * Tetrahedra are flipped in any order in which they are ready. This may end before all are flipped, although another
 * order exists.
 *
 * Based on: Bertrand, Malandain. A new characterization of three-dimensional simple points. Pattern Recognition Letters
 *           1994.
 * Differs from the paper: tetrahedra instead of voxels. */
#include "reconstruct/labeled_delaunay/simple_flips.h"

static bool is_regular(const brio_mending *m, uint32_t sample) {
    const size_t *first = m->flips->g->first + sample;
    return m->surplus[sample] == 0 && first[1] - first[0] <= BRIO_STAR_ROOM;
}

/* Returns whether all tetrahedra round the edge between the samples in slots a and b of a tetrahedron have its
 * label. */
static bool is_off_boundary(const brio_label_flips *f, uint32_t tet, int a, int b) {
    const brio_tetrahedra *t = &f->g->dual->t;
    uint32_t p = t->tet[tet].vertex[a], q = t->tet[tet].vertex[b], at = tet;
    int out = 0; /* the slot whose facet the walk leaves through */
    while (out == a || out == b) out++;
    do {
        uint32_t mate = t->tet[at].mate[out], next = brio_tet_of(mate);
        const uint32_t *v = t->tet[next].vertex;
        if (f->label[next] != f->label[tet]) return false;
        /* the walk came in through facet brio_slot_of(mate), and leaves through the other one at the edge */
        out = 6 - brio_slot_of(mate) - brio_slot_of_vertex(v, p) - brio_slot_of_vertex(v, q);
        at = next;
    } while (at != tet);
    return true;
}

/* Returns whether flipping a tetrahedron only deforms the boundary.
 * sample, more  receive a sample and by how much its fans become more. */
static bool is_simple(const brio_mending *m, uint32_t tet, uint32_t *sample, int *more) {
    const brio_label_flips *f = m->flips;
    const brio_tetrahedron *t = &f->g->dual->t.tet[tet];
    int differs[4], alike[4], num_differing = 0, num_alike = 0;
    for (int i = 0; i < 4; i++) {
        if (!is_regular(m, t->vertex[i])) return false;
        if (f->label[brio_tet_of(t->mate[i])] == f->label[tet])
            alike[num_alike++] = i;
        else
            differs[num_differing++] = i;
    }
    *more = 2 - num_differing;
    if (num_differing == 2) {
        *sample = t->vertex[0];
        return is_off_boundary(f, tet, differs[0], differs[1]);
    }
    if (num_differing == 1) *sample = t->vertex[differs[0]];
    if (num_differing == 3) *sample = t->vertex[alike[0]];
    return num_differing == 3 || (num_differing == 1 && m->fans[*sample] == 0);
}

typedef struct {
    uint32_t tet, sample;
    int more;
} simple_flip;

static void flip(const brio_mending *m, const simple_flip *x, int sign) {
    uint8_t *label = &m->flips->label[x->tet];
    *label = brio_other_label(*label);
    m->fans[x->sample] = (uint8_t)(m->fans[x->sample] + sign * x->more);
}

/* Flips the tetrahedra that are simple. Keeps the others in tet, and returns their number. */
static size_t flip_simple(const brio_mending *m, uint32_t *tet, size_t count, simple_flip *done, size_t *num_done) {
    size_t left = 0;
    for (size_t i = 0; i < count; i++) {
        simple_flip *x = &done[*num_done];
        x->tet = tet[i];
        if (is_simple(m, tet[i], &x->sample, &x->more)) {
            flip(m, x, 1);
            ++*num_done;
        } else {
            tet[left++] = tet[i];
        }
    }
    return left;
}

bool brio_flips_deform(brio_mending *m, const uint32_t *tet, size_t count) {
    uint32_t rest[BRIO_MOST_SIMPLE];
    simple_flip done[BRIO_MOST_SIMPLE];
    size_t num_done = 0, left = count;
    for (size_t i = 0; i < count; i++) rest[i] = tet[i];
    for (size_t before = count + 1; left > 0 && left < before;) {
        before = left;
        left = flip_simple(m, rest, left, done, &num_done);
    }
    while (num_done > 0) flip(m, &done[--num_done], -1);
    return left == 0;
}
