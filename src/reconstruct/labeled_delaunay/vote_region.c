/* Part of the graph of votes as a signed graph of its own: small, and with its edges in lists, which the graph of votes
 * leaves to the triangulation. */
#include "reconstruct/labeled_delaunay/vote_region.h"
#include "base/memory.h"
#include "base/read_ahead.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/hilbert.h"

/* EDGES: of a finite tetrahedron. NODES_A_THREAD: chosen. SOON: a piece of brio_for. KEY_BITS: of each coordinate along
 * the curve; a surface in 2^24 of its cells has few nodes in each. Chosen. */
enum { EDGES = 8, NODES_A_THREAD = 1 << 12, SOON = 1 << 11, KEY_BITS = 12 };

typedef struct {
    const brio_vote_graph *g;
    const uint8_t *fixed, *label;
    uint32_t *number; /* #nodes of the graph: 1 + the number in the region, or 0 */
    uint64_t *key;    /* #nodes of the region: along the curve */
    brio_vote_region *out;
} copier;

/* Writes the edges of a free node of the graph of votes.   edges  room for num_edges. */
static void list_edges(const brio_vote_graph *g, uint32_t node, brio_signed_edge *edges) {
    uint32_t num_tets = (uint32_t)g->dual->t.count;
    size_t count = 0;
    if (node >= num_tets) {
        uint32_t p = node - num_tets;
        for (size_t i = g->first[p]; i < g->first[p + 1]; i++)
            edges[count++] = (brio_signed_edge){brio_star_tet(g->star[i]), brio_star_vote(g, g->star[i])};
        if (g->own) edges[count] = (brio_signed_edge){num_tets + (uint32_t)g->dual->num_points, g->own[p]};
        return;
    }
    const brio_tetrahedron *t = &g->dual->t.tet[node];
    for (int i = 0; i < 4; i++) edges[count++] = (brio_signed_edge){num_tets + t->vertex[i], g->vote[node][i]};
    for (int i = 0; i < 4; i++) edges[count++] = (brio_signed_edge){brio_tet_of(t->mate[i]), g->facet[node][i]};
}

/* Returns the number of edges of a free node: tetrahedra are free only if they are finite. Where there is evidence,
 * samples have an edge to it. */
static size_t num_edges(const brio_vote_graph *g, uint32_t node) {
    size_t num_tets = g->dual->t.count;
    return node < num_tets ? EDGES : g->first[node - num_tets + 1] - g->first[node - num_tets] + (g->own != NULL);
}

/* Marks the nodes of the region, counts them, and returns a bound of their edges. */
static size_t mark(const copier *c) {
    const brio_vote_graph *g = c->g;
    uint32_t num_tets = (uint32_t)g->dual->t.count;
    size_t nodes = num_tets + g->dual->num_points, bound = 0;
    for (uint32_t node = 0; node < nodes; node++) {
        if (node < num_tets) brio_along(g->ctx, node, num_tets, BRIO_READS(g->dual->t.tet));
        if (c->fixed[node]) continue;
        bound += num_edges(g, node);
        c->number[node] = 1;
        if (node < num_tets) {
            const brio_tetrahedron *t = &g->dual->t.tet[node];
            for (int i = 0; i < 4; i++) c->number[num_tets + t->vertex[i]] = c->number[brio_tet_of(t->mate[i])] = 1;
        } else {
            for (size_t i = g->first[node - num_tets]; i < g->first[node - num_tets + 1]; i++)
                c->number[brio_star_tet(g->star[i])] = 1;
        }
    }
    for (size_t node = 0; node < nodes; node++) c->out->num_nodes += c->number[node];
    c->out->count = c->out->num_nodes + (g->own != NULL);
    return bound;
}

/* Finds the place of a sample, or the centroid of a tetrahedron: in whole numbers, so that the order of its samples
 * does not matter. Coordinates are at most 1. */
static void place(const brio_vote_graph *g, uint32_t node, double at[3]) {
    const brio_pole_vectors *v = g->dual;
    bool sample = node >= v->t.count;
    for (size_t k = 0; k < 3; k++) {
        int64_t sum = 0;
        for (int i = 0; i < 4 && !sample; i++)
            sum += (int64_t)(0x1p56 * v->points[3 * (size_t)v->t.tet[node].vertex[i] + k]);
        at[k] = sample ? v->points[3 * (node - v->t.count) + k] : 0x1p-58 * (double)sum;
    }
}

/* Lists the nodes of the region in the order of the graph. */
static void list_nodes(const copier *c) {
    size_t nodes = c->g->dual->t.count + c->g->dual->num_points, count = 0;
    for (uint32_t node = 0; node < nodes; node++)
        if (c->number[node]) c->out->node[count++] = node;
}

static void find_keys(void *user, size_t begin, size_t end, int thread) {
    const copier *c = user;
    const double most = (1 << KEY_BITS) - 1;
    const uint32_t num_tets = (uint32_t)c->g->dual->t.count;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint32_t cell[3], node = c->out->node[i];
        bool infinite = node >= c->g->dual->num_finite && node < num_tets;
        double at[3];
        place(c->g, infinite ? num_tets + c->g->dual->t.tet[node].vertex[0] : node, at);
        for (int k = 0; k < 3; k++) cell[k] = (uint32_t)(most * (0.5 + 0.5 * at[k]));
        c->key[i] = brio_hilbert_key(cell[0], cell[1], cell[2], KEY_BITS);
    }
}

/* Brings the nodes in the order of a curve through their places: a block of nodes that are near in space has its edges
 * on few pages then, and samples are among their tetrahedra. */
static brio_status sort_nodes(copier *c) {
    brio_status status = BRIO_OK;
    brio_vote_region *r = c->out;
    int threads = brio_threads(r->ctx, r->num_nodes, NODES_A_THREAD);
    BRIO_TRY(BRIO_ALLOC(r->ctx, c->key, r->num_nodes));
    BRIO_TRY(brio_sweep(r->ctx, threads, r->num_nodes, find_keys, c, BRIO_READS(r->node), BRIO_WRITES(c->key)));
    BRIO_TRY(brio_radix_sort(r->ctx, c->key, r->node, r->num_nodes, 3 * KEY_BITS));
done:
    brio_release(r->ctx, c->key);
    return status;
}

/* Numbers the listed nodes, and finds where their edges begin. */
static void number_nodes(const copier *c) {
    brio_vote_region *r = c->out;
    size_t edges = 0;
    for (size_t i = 0; i < r->num_nodes; i++) {
        uint32_t node = r->node[i];
        c->number[node] = (uint32_t)i + 1;
        r->first[i] = edges;
        if (!c->fixed[node]) edges += num_edges(c->g, node);
    }
    for (size_t i = r->num_nodes; i <= r->count; i++) r->first[i] = edges;
    if (r->count == r->num_nodes) return;
    c->number[c->g->dual->t.count + c->g->dual->num_points] = (uint32_t)r->count;
    r->fixed[r->num_nodes] = 1, r->label[r->num_nodes] = BRIO_LABEL_OUTER;
}

/* Announces what is copied of the nodes from a place in the list on. */
static void expect_listed(const copier *c, size_t from) {
    const brio_vote_graph *g = c->g;
    const brio_vote_region *r = c->out;
    brio_read_ahead ahead;
    size_t to = from + SOON < r->num_nodes ? from + SOON : r->num_nodes;
    if (!g->ctx->scratch) return;
    brio_read_ahead_start(&ahead, g->ctx);
    for (size_t i = from; i < to; i++) {
        uint32_t node = r->node[i];
        if (node >= g->dual->t.count) {
            brio_expect(&ahead, g->star + g->first[node - g->dual->t.count]);
            continue;
        }
        brio_expect(&ahead, &g->dual->t.tet[node]);
        brio_expect(&ahead, g->vote[node]);
        brio_expect(&ahead, g->facet[node]);
    }
}

static void copy_nodes(void *user, size_t begin, size_t end, int thread) {
    const copier *c = user;
    const brio_vote_region *r = c->out;
    (void)thread;
    expect_listed(c, end);
    for (size_t i = begin; i < end; i++) {
        uint32_t node = r->node[i];
        r->fixed[i] = c->fixed[node];
        r->label[i] = c->label[node];
        if (c->fixed[node]) continue;
        place(c->g, node, r->position + 3 * i);
        list_edges(c->g, node, r->edge + r->first[i]);
        for (size_t e = r->first[i]; e < r->first[i + 1]; e++) r->edge[e].node = c->number[r->edge[e].node] - 1;
    }
}

brio_status brio_vote_region_new(const brio_vote_graph *g, const uint8_t *fixed, const uint8_t *label,
                                 brio_vote_region *out) {
    brio_status status = BRIO_OK;
    copier c = {.g = g, .fixed = fixed, .label = label, .out = out};
    *out = (brio_vote_region){.ctx = g->ctx};
    BRIO_TRY(BRIO_ALLOC_ZERO(g->ctx, c.number, g->dual->t.count + g->dual->num_points + 1));
    size_t bound = mark(&c);
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->node, out->count));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->fixed, out->count));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->label, out->count));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->position, 3 * out->count));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->first, out->count + 1));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->edge, bound));
    list_nodes(&c);
    if (g->ctx->scratch) BRIO_TRY(sort_nodes(&c));
    number_nodes(&c);
    BRIO_TRY(brio_for(g->ctx, brio_threads(g->ctx, out->num_nodes, NODES_A_THREAD), out->num_nodes, copy_nodes, &c));
done:
    brio_release(g->ctx, c.number);
    return status;
}

void brio_vote_region_free(brio_vote_region *r) {
    brio_release(r->ctx, r->node);
    brio_release(r->ctx, r->fixed);
    brio_release(r->ctx, r->label);
    brio_release(r->ctx, r->position);
    brio_release(r->ctx, r->first);
    brio_release(r->ctx, r->edge);
    *r = (brio_vote_region){.ctx = r->ctx};
}
