/* The certificate of a surface as facts, and what it takes for a surface to hold. */
#ifndef BRIO_CLI_CERTIFICATE_H
#define BRIO_CLI_CERTIFICATE_H

#include "run.h"

/** Certifies the faces of a mesh and reports what is found. BRIO_ERR_CHECK with the reason when it is not manifold and
 *  oriented or, unless `open`, not closed. The time is lapped as `certify`. */
brio_status cli_certify(run *r, const brio_mesh *mesh, bool open);

#endif
