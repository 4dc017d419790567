/* The certificate of a surface as facts, and what it takes for a surface to hold. */
#ifndef BRIO_CLI_CERTIFICATE_H
#define BRIO_CLI_CERTIFICATE_H

#include "cli/run/run.h"

enum certify_how {
    CERTIFY_OPEN = 1,     /* a boundary is no fault */
    CERTIFY_COUNTED = 2,  /* self-intersections are counted */
    CERTIFY_EMBEDDED = 4, /* they are counted, and a fault */
    CERTIFY_ANYTHING = 8, /* nothing is a fault */
    CERTIFY_INPUT = 16    /* a mesh that was given, or goes back to one: it may have vertices apart at one position */
};

/** Reports the certificate of the faces; BRIO_ERR_CHECK when it finds a fault.   how  bits of certify_how. */
brio_status cli_certify(run *r, const brio_mesh *mesh, unsigned how);

/** Reports a certificate that was found already, and judges it as cli_certify does.   how  0 or CERTIFY_OPEN. */
brio_status cli_report_certificate(run *r, const brio_certificate *certificate, unsigned how);

#endif
