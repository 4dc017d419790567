/* Places of scanners as properties of the points that they saw. A place is written for each point: points are then
 * complete in blocks, however many scans a file has, and the properties pass through all that properties pass through. */
#include "io/origins.h"
#include <math.h>

static const char *const NAMES[] = {"x_origin", "y_origin", "z_origin"};

brio_status brio_plan_origins(brio_builder *b) {
    brio_status status = BRIO_OK;
    b->has_origins = false;
    if (!b->origins) return BRIO_OK;
    for (int k = 0; k < 3; k++)
        if (brio_mesh_property(b->mesh, NAMES[k])) return BRIO_OK;
    b->first_origin = b->mesh->num_properties;
    for (int k = 0; k < 3; k++) BRIO_TRY(brio_builder_property(b, NAMES[k], BRIO_SCALAR_FLOAT64));
    b->has_origins = true;
done:
    return status;
}

void brio_set_origins(brio_builder *b, size_t first, const double *place) {
    for (size_t k = 0; k < 3 && b->has_origins; k++) {
        double *value = b->mesh->properties[b->first_origin + k].data;
        for (size_t v = first; v < b->mesh->num_vertices; v++) value[v] = place ? place[k] : (double)NAN;
    }
}
