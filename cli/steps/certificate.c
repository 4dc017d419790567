/* The certificate of a surface as facts. */
#include "cli/steps/certificate.h"
#include "cli/steps/hints.h"

static void report_genera(facts *f, const char *name, const brio_certificate *c) {
    cli_fact_open(f, name, FACT_LIST);
    for (size_t i = 0; i < c->components; i++) cli_fact_integer(f, NULL, c->genera[i]);
    cli_fact_close(f);
}

static void report_certificate(facts *f, const brio_certificate *c) {
    cli_fact_open(f, "certificate", FACT_OBJECT);
    cli_fact_bool(f, "closed", c->closed);
    cli_fact_bool(f, "manifold", c->manifold);
    cli_fact_bool(f, "oriented", c->oriented);
    cli_fact_count(f, "components", c->components);
    cli_fact_integer(f, "genus", c->genus);
    report_genera(f, "genera", c); /* the name of version 0.1, which scripts read */
    report_genera(f, "genus_by_component", c);
    cli_fact_count(f, "boundary_edges", c->boundary_edges);
    cli_fact_count(f, "boundary_loops", c->boundary_loops);
    cli_fact_count(f, "nonmanifold_edges", c->nonmanifold_edges);
    cli_fact_count(f, "nonmanifold_vertices", c->nonmanifold_vertices);
    cli_fact_count(f, "flipped_edges", c->flipped_edges);
    if (c->self_intersections < 0)
        cli_fact_missing(f, "self_intersections", "not counted");
    else
        cli_fact_integer(f, "self_intersections", c->self_intersections);
    cli_fact_real(f, "area", c->area);
    cli_fact_real(f, "volume", c->volume);
    cli_fact_close(f);
}

static brio_status judge(run *r, const brio_certificate *c, unsigned how) {
    if (!c->manifold)
        return cli_fail(r, BRIO_ERR_CHECK,
                        "the surface is not manifold: %zu edges with more than two faces, %zu pinched vertices",
                        c->nonmanifold_edges, c->nonmanifold_vertices);
    if (!c->oriented)
        return cli_fail(r, BRIO_ERR_CHECK, "the surface is not oriented: across %zu edges the faces disagree",
                        c->flipped_edges);
    if (!c->closed && !(how & CERTIFY_OPEN))
        return cli_because(r, BRIO_REASON_NOT_CLOSED,
                           cli_fail(r, BRIO_ERR_CHECK, "the surface is not closed: %zu boundary edge%s in %zu loop%s",
                                    c->boundary_edges, c->boundary_edges == 1 ? "" : "s", c->boundary_loops,
                                    c->boundary_loops == 1 ? "" : "s"));
    if (c->self_intersections > 0 && how & CERTIFY_EMBEDDED)
        return cli_fail(r, BRIO_ERR_CHECK, "the surface intersects itself: %lld pairs of faces",
                        (long long)c->self_intersections);
    return BRIO_OK;
}

brio_status cli_report_certificate(run *r, const brio_certificate *certificate, unsigned how) {
    report_certificate(&r->facts, certificate);
    return judge(r, certificate, how);
}

static brio_status count_self_intersections(run *r, const brio_mesh *mesh, brio_certificate *c) {
    brio_status status = brio_mesh_self_intersections(r->ctx, mesh, &c->self_intersections);
    cli_lap(r, "self_intersections");
    r->crossings = true;
    return status;
}

brio_status cli_certify(run *r, const brio_mesh *mesh, unsigned how) {
    brio_certificate c = {0};
    brio_status status = BRIO_OK;
    TRY(brio_mesh_certificate(r->ctx, mesh, &c));
    cli_lap(r, "certify");
    if (how & (CERTIFY_COUNTED | CERTIFY_EMBEDDED)) TRY(count_self_intersections(r, mesh, &c));
    report_certificate(&r->facts, &c);
    if (c.self_intersections > 0 && !(how & CERTIFY_EMBEDDED))
        cli_warn(r, WARNING_SELF, (long long)c.self_intersections);
    if (how & CERTIFY_INPUT && how & CERTIFY_OPEN) cli_tell_apart(r, mesh, c.boundary_edges == 0);
    if (!(how & CERTIFY_ANYTHING)) status = judge(r, &c, how);
done:
    brio_certificate_free(&c);
    return status;
}
