/* The gates of a team of threads: starts of runs, and the barrier at their ends.
 *
 * Follows src/base/team.c: gate_change, gate_wait, brio_barrier, brio_run, live, brio_team_end. Two runs, of all MEMBERS and of
 * two of them, then the end of the team. A lock is a process' number; waiting for a condition gives the lock back, is woken by a
 * broadcast or, as POSIX permits, without one.
 *
 * Holds: no wakeup is lost (all processes end); each member works once in each run that it belongs to, while the run goes on.
 * BREAK is a mistake that the model has to find. */
#ifndef MEMBERS
#define MEMBERS 3
#endif
#define GATES (MEMBERS + 1)
#define BARRIER MEMBERS /* gates 1 to MEMBERS - 1: starts */
#define RUNS 2
#define FREE 255

mtype = { no_break, looks_for_sleepers_first, sleeps_without_looking, arrived_reset_late };
#ifndef BREAK
#define BREAK no_break
#endif

byte value[GATES], sleepers[GATES], lock[GATES], broadcasts[GATES];
byte arrived;
byte threads_of[MEMBERS]; /* of the run that the member belongs to */
bool work;                /* team->work: whether there is a run to do, not the end */
byte run_now;             /* for the proof: number of the run that goes on, 0 between runs */
byte worked[MEMBERS];     /* for the proof */

inline acquire(g) { atomic { lock[g] == FREE -> lock[g] = _pid } }
inline release(g) { lock[g] = FREE }

inline gate_change(g) {
    if
    :: BREAK == looks_for_sleepers_first ->
        awake = sleepers[g] == 0;
        value[g]++
    :: else ->
        value[g]++;
        awake = sleepers[g] == 0
    fi;
    if
    :: !awake -> acquire(g); broadcasts[g]++; release(g)
    :: else -> skip
    fi;
    awake = false
}

/* The looks before sleeping change nothing but time: one look is any number of them. */
inline gate_wait(g, old) {
    if
    :: value[g] != old -> skip
    :: true ->
        acquire(g);
        sleepers[g]++;
        do
        :: BREAK != sleeps_without_looking && value[g] != old -> break
        :: BREAK == sleeps_without_looking && seen_broadcast -> break
        :: else ->
            atomic { seen_broadcast = true; mine = broadcasts[g]; lock[g] = FREE };
            broadcasts[g] != mine;
            mine = 0;
            acquire(g)
        od;
        seen_broadcast = false;
        sleepers[g]--;
        release(g)
    fi
}

inline barrier(threads) {
    before = value[BARRIER];
    atomic { arrived++; last = arrived == threads };
    if
    :: last && BREAK == arrived_reset_late -> gate_change(BARRIER); arrived = 0
    :: last && BREAK != arrived_reset_late -> arrived = 0; gate_change(BARRIER)
    :: else -> gate_wait(BARRIER, before)
    fi;
    before = 0; last = false
}

inline do_work(i) {
    assert(run_now);
    worked[i]++
}

/* live */
proctype member(byte i) {
    byte seen, before, mine, threads;
    bool awake, last, seen_broadcast;
    do
    :: gate_wait(i, seen);
        if
        :: !work -> break
        :: else -> skip
        fi;
        do_work(i);
        threads = threads_of[i];
        barrier(threads);
        threads = 0;
        seen++
    od
}

inline run_team(number, threads) {
    run_now = number;
    work = true;
    i = 1;
    do
    :: i < threads -> threads_of[i] = threads; gate_change(i); i++
    :: else -> break
    od;
    do_work(0);
    barrier(threads);
    d_step {
        run_now = 0;
        i = 0;
        do
        :: i < MEMBERS -> assert(worked[i] == number || i >= threads); i++
        :: else -> break
        od;
        i = 0
    }
}

init {
    byte i, before, mine;
    bool awake, last, seen_broadcast;
    d_step {
        do
        :: i < GATES -> lock[i] = FREE; i++
        :: else -> break
        od
    };
    atomic {
        i = 1;
        do
        :: i < MEMBERS -> run member(i); i++
        :: else -> break
        od
    };
    run_team(1, MEMBERS);
    run_team(2, 2);
    work = false; /* brio_team_end */
    i = 1;
    do
    :: i < MEMBERS -> gate_change(i); i++
    :: else -> break
    od;
    _nr_pr == 1; /* pthread_join */
    assert(arrived == 0)
}
