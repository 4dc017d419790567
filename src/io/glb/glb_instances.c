/* The meshes of a glTF file at their places: the matrices of the nodes multiplied from the roots down.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "base/memory.h"
#include "io/glb/glb_mesh.h"
#include <string.h>

typedef struct {
    double matrix[16]; /* of the parent */
    uint32_t node;
} task;

typedef struct {
    const brio_glb_file *file;
    task *stack;
    size_t size, capacity;
    bool *visited;
} walk;

/* c = a b, of matrices whose last row is 0 0 0 1. Products with 0 and 1 leave numbers as they are. */
static void multiply(const double *a, const double *b, double *c) {
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 3; i++) {
            double sum = a[i] * b[4 * j] + a[4 + i] * b[4 * j + 1] + a[8 + i] * b[4 * j + 2];
            c[4 * j + i] = j == 3 ? sum + a[12 + i] : sum;
        }
        c[4 * j + 3] = j == 3;
    }
}

/* Puts nodes on the stack so that the first one comes first. */
static brio_status push(walk *w, const double *matrix, const uint32_t *nodes, size_t count) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(w->file->ctx, w->stack, w->capacity, w->size + count));
    for (size_t i = count; i > 0; i--) {
        task *t = &w->stack[w->size++];
        memcpy(t->matrix, matrix, sizeof t->matrix);
        t->node = nodes[i - 1];
    }
done:
    return status;
}

/* Takes a node from the stack, and puts its children there.   out  its mesh and its place. */
static brio_status visit(walk *w, brio_glb_instance *out) {
    brio_status status = BRIO_OK;
    const brio_glb_scene *s = &w->file->scene;
    const task t = w->stack[--w->size];
    const brio_glb_node *node = &s->nodes[t.node];
    BRIO_REQUIRE(w->file->ctx, !w->visited[t.node], BRIO_ERR_FORMAT,
                 "%s: nodes[%u] is there twice: expected nodes that are a tree", w->file->name, t.node);
    w->visited[t.node] = true;
    BRIO_REQUIRE(w->file->ctx, node->mesh == BRIO_GLB_NONE || node->mesh < s->num_meshes, BRIO_ERR_FORMAT,
                 "%s: nodes[%u].mesh: the file has %zu meshes", w->file->name, t.node, s->num_meshes);
    multiply(t.matrix, node->matrix, out->matrix);
    out->mesh = node->mesh;
    BRIO_TRY(push(w, out->matrix, s->children + node->child, node->children));
done:
    return status;
}

brio_status brio_glb_instances(const brio_glb_file *file, brio_glb_instance **out, size_t *count) {
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    brio_status status = BRIO_OK;
    const brio_glb_scene *s = &file->scene;
    walk w = {.file = file};
    size_t capacity = 0;
    *out = NULL;
    *count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(file->ctx, w.visited, s->num_nodes));
    BRIO_TRY(push(&w, identity, s->roots, s->num_roots));
    while (w.size) {
        brio_glb_instance instance;
        BRIO_TRY(visit(&w, &instance));
        if (instance.mesh == BRIO_GLB_NONE) continue;
        BRIO_TRY(BRIO_RESERVE(file->ctx, *out, capacity, *count + 1));
        (*out)[(*count)++] = instance;
    }
done:
    brio_release(file->ctx, w.stack);
    brio_release(file->ctx, w.visited);
    return status;
}
