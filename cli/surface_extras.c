/* What a reconstructed surface gets before it is reported. */
#include "surface_extras.h"

brio_status cli_keep_components(run *r, const component_options *options, brio_mesh *surface, size_t dropped[2]) {
    dropped[0] = dropped[1] = 0;
    if (!options->largest && !options->least) return cli_check_interrupt(r);
    return brio_mesh_keep_components(surface, options->largest, options->least, &dropped[0], &dropped[1]);
}

void cli_report_dropped(run *r, const component_options *options, const size_t dropped[2]) {
    if (!options->largest && !options->least) return;
    cli_fact_count(&r->facts, "dropped_components", dropped[0]);
    cli_fact_count(&r->facts, "dropped_faces", dropped[1]);
}
