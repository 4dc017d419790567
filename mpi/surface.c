/* brio-mpi surface: rank 0 runs the command `surface` of brio, in whose context all ranks triangulate and cut. */
#include "cli/run/commands.h"
#include "cli/run/interrupt.h"
#include "cli/steps/hints.h"
#include "mpi/job.h"

static void report(job *j, const brio_team_facts *t) {
    facts *f = &j->r->facts;
    cli_fact_open(f, "ranks", FACT_OBJECT);
    cli_fact_integer(f, "count", j->size);
    cli_fact_count(f, "triangulations", t->triangulations);
    cli_fact_count(f, "bytes", t->bytes);
    cli_fact_count(f, "bytes_received", t->bytes_received);
    cli_fact_count(f, "parts", t->parts);
    cli_fact_count(f, "part_bytes", t->part_bytes);
    cli_fact_count(f, "part_bytes_received", t->part_bytes_received);
    cli_fact_close(f);
}

/* Runs the command on rank 0. */
static brio_status lead(job *j, const brio_transport *t, const brio_ranks_options *o) {
    run *r = j->r;
    brio_team_of_ranks *team;
    FORWARD(brio_ranks_lead(r->ctx, t, o, &team));
    brio_status status = cli_surface.run(r);
    if (status == BRIO_OK) report(j, brio_ranks_led(team));
    if (status != BRIO_OK && cli_interrupted()) status = cli_fail(r, BRIO_ERR_CANCELLED, "interrupted");
    if (status != BRIO_OK) cli_keep_failure(r, status);
    cli_name_input(r, status);
    char sentence[sizeof r->message];
    snprintf(sentence, sizeof sentence, "%s", r->message);
    r->message[0] = 0; /* from now on that of all */
    return brio_ranks_dismiss(team, status, *sentence ? sentence : NULL);
}

brio_status job_surface(job *j) {
    const brio_ranks_options o = {.size = sizeof o, .scratch = j->r->common.scratch, .tiles = (uint32_t)j->a.tiles};
    const brio_transport t = brio_mpi_transport(j->mpi);
    return j->rank ? brio_ranks_serve(j->r->ctx, &t, &o) : lead(j, &t, &o);
}
