/* Passes of parallel insertion: segments of the curve, taken, kept, given back; points, inserted or deferred.
 *
 * Follows src/triangulation/passes.c with THREADS threads, SEGMENTS segments and POINTS points. What an insertion
 * meets is any segment at all: the geometry is that of cavity.pml. Numbers of the code that are larger: RETRIES and PASSES (4),
 * SEGMENTS_KEPT (8). FAIL: some thread's insertion fails, as for want of memory.
 *
 * Holds: an insertion is alone in each segment that it met; every point is inserted once; a pass leaves no segment taken; all
 * processes end. BREAK is a mistake in the protocol that the model has to find. */
#ifndef THREADS
#define THREADS 2
#endif
#ifndef SEGMENTS
#define SEGMENTS 3
#endif
#ifndef POINTS
#define POINTS 4
#endif
#ifndef MEETS
#define MEETS 2 /* segments that an insertion meets at most, besides its point's */
#endif
#define RETRIES 1 /* of a thread's deferred points in a pass */
#define PASSES 2
#define KEPT 1 /* SEGMENTS_KEPT */
#define NOBODY 255

#define SEGMENT(p) ((p) * SEGMENTS / POINTS)
#define BIT(i) (1 << (i))

mtype = { no_break, racy_take, keeps_at_end, gives_back_early, forgets_deferred, failed_keeps_running };
#ifndef BREAK
#define BREAK no_break
#endif

bool taken[SEGMENTS];
bool stop, failed;
byte running, finished;
byte deferred[THREADS];  /* bits of points: read by the caller after the pass */
byte inside[SEGMENTS];   /* for the proof: insertions that count on the segment being theirs */
byte inserted[POINTS];   /* for the proof */

/* brio_zone_take: one compare-and-swap. */
inline take(s) {
    if
    :: BREAK == racy_take ->
        if
        :: !taken[s] -> skip; taken[s] = true; held = held | BIT(s)
        :: else -> own = false
        fi
    :: else ->
        if
        :: atomic { !taken[s] -> taken[s] = true; held = held | BIT(s) }
        :: atomic { taken[s] -> own = false }
        fi
    fi
}

/* brio_zone_has: what is held is met now. */
inline has(s) {
    if
    :: held & BIT(s) -> skip
    :: else -> take(s)
    fi;
    if
    :: own -> met = met | BIT(s)
    :: else -> skip
    fi
}

/* Gives back the segments that are held, except those of `but`. */
inline give_back(but) {
    s = 0;
    do
    :: s < SEGMENTS ->
        if
        :: (held & ~(but)) & BIT(s) -> held = held & ~BIT(s); taken[s] = false
        :: else -> skip
        fi;
        s++
    :: else -> break
    od;
    s = 0
}

inline enter_or_leave(change) {
    d_step {
        s = 0;
        do
        :: s < SEGMENTS ->
            if
            :: met & BIT(s) -> inside[s] = inside[s] + change; assert(inside[s] <= 1)
            :: else -> skip
            fi;
            s++
        :: else -> break
        od;
        s = 0
    }
}

inline count_bits(set, n) {
    d_step {
        n = 0; s = 0;
        do
        :: s < SEGMENTS -> n = n + ((set >> s) & 1); s++
        :: else -> break
        od;
        s = 0
    }
}

/* insert_in_zone: meets the point's segment and any others, inserts, tidies. */
inline try_point(p) {
    own = true; met = 0; meets = 0;
    has(SEGMENT(p));
    do
    :: own && meets < MEETS ->
        meets++;
        select(other : 0 .. SEGMENTS - 1);
        has(other)
    :: break
    od;
    other = 0;
    if
    :: !own -> left = left | BIT(p)
    :: own && FAIL && !failed -> failed = true; broken = true
    :: own ->
        enter_or_leave(1);
        if
        :: BREAK == gives_back_early -> give_back(0)
        :: else -> skip
        fi;
        inserted[p] = inserted[p] + 1;
        assert(inserted[p] == 1);
        enter_or_leave(-1)
    fi;
    count_bits(held, n);
    if
    :: !broken && n > KEPT -> give_back(met)
    :: else -> skip
    fi;
    n = 0; met = 0; meets = 0; own = false
}

/* work: its points, then those deferred again, then the end. */
proctype worker(byte thread; byte points) {
    byte todo, left, held, met, s, n, p, meets, other, tries;
    bool own, broken;
    todo = points;
    points = 0;
    do
    :: tries <= RETRIES && todo && !broken ->
        p = 0;
        do
        :: p < POINTS && !broken && !stop ->
            if
            :: todo & BIT(p) -> try_point(p)
            :: else -> skip
            fi;
            p++
        :: else -> break
        od;
        if
        :: BREAK == forgets_deferred && tries -> todo = 0 /* the list is emptied and not filled again */
        :: else -> todo = left
        fi;
        left = 0;
        tries++
    :: else -> break
    od;
    p = 0; tries = 0;
    deferred[thread] = todo;
    todo = 0;
    if
    :: !broken && BREAK != keeps_at_end -> give_back(0)
    :: else -> skip /* a cavity may be half filled */
    fi;
    if
    :: broken && BREAK == failed_keeps_running -> skip
    :: else -> running--
    fi;
    if
    :: broken -> stop = true
    :: !broken && thread == 0 -> running == 0 /* wait_for_others: sleeps and looks again */
    :: else -> skip
    fi;
    held = 0;
    finished++ /* the barrier at the end of a run: gates.pml */
}

/* brio_insert_parallel. */
init {
    byte pass, i, p, left, count, before;
    left = BIT(POINTS) - 1;
    before = POINTS;
    do
    :: pass < PASSES && left && !failed ->
        d_step { running = THREADS; finished = 0; i = 0 }
        atomic {
            do
            :: i < THREADS ->
                count = (BIT((i + 1) * POINTS / THREADS) - BIT(i * POINTS / THREADS)) & left;
                run worker(i, count);
                i++
            :: else -> break
            od
        };
        finished == THREADS;
        d_step {
            left = 0; count = 0; i = 0; p = 0;
            do
            :: i < THREADS -> left = left | deferred[i]; deferred[i] = 0; i++
            :: else -> break
            od;
            i = 0;
            do
            :: i < SEGMENTS -> assert(failed || !taken[i]); taken[i] = false; i++ /* divide_curve makes new ones */
            :: else -> break
            od;
            do
            :: p < POINTS -> count = count + ((left >> p) & 1); p++
            :: else -> break
            od;
            p = 0
        };
        pass++;
        if
        :: count > before / 2 -> break
        :: else -> before = count
        fi
    :: else -> break
    od;
    skip;
    d_step { /* insert_rest */
        p = 0;
        do
        :: p < POINTS && !failed ->
            inserted[p] = inserted[p] + ((left >> p) & 1);
            assert(inserted[p] == 1);
            p++
        :: else -> break
        od;
        p = 0
    }
}
