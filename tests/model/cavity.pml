/* Cavities of several threads in one triangulation: what decision 006 proves, tried for every interleaving.
 *
 * Follows src/triangulation: insert.c, engine_body.h, cavity.c and zone.h, with P1 to P4 of store.h. The triangulation is that of
 * an octahedron with the infinite vertex: 4 finite and 8 infinite tetrahedra. There are no coordinates: a walk goes anywhere, a
 * cavity is any tetrahedron or any two neighbours. Each vertex is a segment, or two vertices are (VERTICES_A_SEGMENT).
 *
 * Holds: what a thread reads or writes of a tetrahedron, of its neighbours, or behind their facets is being changed by no other
 * thread; the mates lead back, over facets with the same vertices, at the end. BREAK is a mistake that the model has to find. */
#ifndef THREADS
#define THREADS 2
#endif
#ifndef POINTS
#define POINTS 1 /* of each thread */
#endif
#ifndef VERTICES_A_SEGMENT
#define VERTICES_A_SEGMENT 1
#endif
#ifndef STEPS
#define STEPS 1 /* of a walk at most */
#endif
#ifndef RETRIES
#define RETRIES 1 /* of a point that was deferred */
#endif
#define OLD 6     /* vertices of the octahedron */
#define NEW (THREADS * POINTS)
#define INFINITE (OLD + NEW)
#define START 12 /* tetrahedra at the start */
#define SLOTS (START + 4 * NEW)
#define SEGMENTS ((OLD + NEW + VERTICES_A_SEGMENT - 1) / VERTICES_A_SEGMENT)
#define BIT(i) (1 << (i))
#define TET(facet) ((facet) / 4)
#define SLOT(facet) ((facet) % 4)

mtype = { no_break, two_vertices, gives_back_early, takes_not_beyond, forgets_undo };
#ifndef BREAK
#define BREAK no_break
#endif

byte vertex[4 * SLOTS], mate[4 * SLOTS];
bool taken[SEGMENTS];
byte count;          /* slots handed out */
byte writer[SLOTS];  /* for the proof: 1 + the thread that changes the tetrahedron, from its first mark on */
byte done;

#define SAFE(tet) (writer[tet] == 0 || writer[tet] == me + 1)

/* brio_zone_has */
inline has(v) {
    if
    :: held & BIT((v) / VERTICES_A_SEGMENT) -> skip
    :: else ->
        if
        :: atomic { !taken[(v) / VERTICES_A_SEGMENT] ->
            taken[(v) / VERTICES_A_SEGMENT] = true; held = held | BIT((v) / VERTICES_A_SEGMENT) }
        :: atomic { taken[(v) / VERTICES_A_SEGMENT] -> own = false }
        fi
    fi;
    if
    :: own -> met = met | BIT((v) / VERTICES_A_SEGMENT)
    :: else -> skip
    fi
}

/* brio_owns: the finite vertices, one at a time; the infinite one is in slot 3. */
inline owns(t) {
    k = 0;
    do
    :: own && k < (BREAK == two_vertices -> 2 : 4) ->
        if
        :: vertex[4 * (t) + k] != INFINITE -> has(vertex[4 * (t) + k])
        :: else -> skip
        fi;
        k++
    :: else -> break
    od;
    k = 0
}

/* brio_owns_beyond: the vertex opposite to the facet is new. */
inline owns_beyond(f) {
    if
    :: vertex[f] == INFINITE || BREAK == takes_not_beyond -> skip
    :: else -> has(vertex[f])
    fi
}

/* A tetrahedron that shares a facet with one that is held is read: its vertices, its mates, and the vertices behind. */
inline reads_neighbour(t) {
    d_step {
        assert(SAFE(t));
        k = 0;
        do
        :: k < 4 -> assert(SAFE(TET(mate[4 * (t) + k]))); k++
        :: else -> break
        od;
        k = 0
    }
}

inline give_back(but) {
    k = 0;
    do
    :: k < SEGMENTS ->
        if
        :: (held & ~(but)) & BIT(k) -> atomic { held = held & ~BIT(k); taken[k] = false }
        :: else -> skip
        fi;
        k++
    :: else -> break
    od;
    k = 0
}

/* The walk: to any neighbour of a tetrahedron that is held. */
inline walk() {
    tet = start;
    owns(tet);
    do
    :: own && steps < STEPS ->
        steps++;
        if
        :: across = mate[4 * tet]
        :: across = mate[4 * tet + 1]
        :: across = mate[4 * tet + 2]
        :: across = mate[4 * tet + 3]
        fi;
        reads_neighbour(TET(across));
        owns_beyond(across);
        if
        :: own -> tet = TET(across)
        :: else -> skip
        fi
    :: break
    od;
    steps = 0; across = 0
}

/* dig_cavity: marks the first tetrahedron, tests those behind its facets, and takes at most one of them. */
inline dig() {
    other = SLOTS;
    d_step { assert(SAFE(tet)); writer[tet] = me + 1 };
    j = 0;
    do
    :: own && j < 4 ->
        across = mate[4 * tet + j];
        reads_neighbour(TET(across));
        if
        :: true -> skip
        :: other == SLOTS && vertex[across] != vertex[4 * tet + j] -> /* in conflict; two facets are not shared */
            owns_beyond(across);
            if
            :: own -> d_step { other = TET(across); assert(SAFE(other)); writer[other] = me + 1 }
            :: else -> skip
            fi
        fi;
        j++
    :: else -> break
    od;
    j = 0; across = 0;
    if
    :: !own && BREAK != forgets_undo -> d_step { /* brio_cavity_undo */
        writer[tet] = 0;
        if
        :: other != SLOTS -> writer[other] = 0
        :: else -> skip
        fi;
        other = 0 }
    :: else -> skip
    fi
}

/* Lists the border: facets of the tetrahedra outside. */
inline list_border(t, not) {
    j = 0;
    do
    :: j < 4 ->
        if
        :: TET(mate[4 * (t) + j]) != (not) -> border[borders] = mate[4 * (t) + j]; borders++
        :: else -> skip
        fi;
        j++
    :: else -> break
    od
}

/* The edge that the new tetrahedron's facet j % 3 + 1 has of the border, as a set of two vertices. */
#define EDGE_SIDE(j, n) BIT(vertex[4 * created[(j) / 3] + 1 + ((j) % 3 + (n)) % 3])
#define edge(j) (EDGE_SIDE(j, 1) | EDGE_SIDE(j, 2))

/* brio_cavity_fill. Slots of the cavity first, then fresh ones. One step for each border facet, then the star is joined. */
inline fill(p) {
    d_step {
        borders = 0;
        list_border(tet, other);
        if
        :: other != SLOTS -> list_border(other, tet)
        :: else -> skip
        fi;
        slots = 0; j = 0
    };
    atomic { fresh = count; count = count + borders - 1 - (other != SLOTS) }; /* brio_store_take */
    do
    :: j < borders -> d_step { /* create */
        made = (j == 0 -> tet : (j == 1 && other != SLOTS -> other : fresh + j - 1 - (other != SLOTS)));
        created[j] = made;
        assert(SAFE(made));
        writer[made] = me + 1;
        across = border[j];
        assert(SAFE(TET(across)));
        mate[across] = 4 * made;
        vertex[4 * made] = p;
        k = 0; slots = 1;
        do
        :: k < 4 ->
            if
            :: k != SLOT(across) -> vertex[4 * made + slots] = vertex[4 * TET(across) + k]; slots++
            :: else -> skip
            fi;
            k++
        :: else -> break
        od;
        mate[4 * made] = across;
        k = 0; slots = 0; made = 0; across = 0;
        j++ }
    :: else -> break
    od;
    skip;
    d_step { /* join_by_table */
        j = 0;
        do
        :: j < borders * 3 ->
            i = 0;
            do
            :: i < borders * 3 ->
                if
                :: i / 3 != j / 3 && edge(j) == edge(i) ->
                    mate[4 * created[j / 3] + 1 + j % 3] = 4 * created[i / 3] + 1 + i % 3
                :: else -> skip
                fi;
                i++
            :: else -> break
            od;
            j++
        :: else -> break
        od;
        j = 0; i = 0
    };
    if
    :: BREAK == gives_back_early -> give_back(0)
    :: else -> skip
    fi;
    skip;
    d_step {
        start = tet;
        do
        :: j < borders -> writer[created[j]] = 0; created[j] = 0; border[j] = 0; j++
        :: else -> break
        od;
        j = 0; borders = 0; other = 0; fresh = 0
    }
}

proctype inserter(byte me; byte start; short held) {
    short met;
    byte tet, other, across, made, fresh, borders, slots, steps, i, j, k, point, tries;
    byte border[6], created[6];
    bool own;
    point = OLD + me * POINTS;
    do
    :: point < OLD + (me + 1) * POINTS ->
        own = true; met = 0;
        has(point);
        if
        :: own -> walk()
        :: else -> skip
        fi;
        if
        :: own -> owns(tet) /* judge */
        :: else -> skip
        fi;
        if
        :: own -> dig()
        :: else -> skip
        fi;
        if
        :: own -> fill(point)
        :: else -> skip
        fi;
        tet = 0;
        if
        :: own || tries == RETRIES -> tries = 0; point++ /* in, or left to another pass */
        :: else -> tries++
        fi;
        own = true;
        owns(start); /* N1 */
        give_back(met)
    :: else -> break
    od;
    skip;
    d_step { point = 0; own = false; met = 0; start = 0 };
    give_back(0);
    done++
}

inline tetrahedron(a, b, c, d) {
    vertex[4 * count] = a; vertex[4 * count + 1] = b; vertex[4 * count + 2] = c; vertex[4 * count + 3] = d;
    count++
}

/* Vertices 2 k and 2 k + 1 are opposite to each other. */
inline octahedron() {
    tetrahedron(4, 5, 0, 2); tetrahedron(4, 5, 2, 1); tetrahedron(4, 5, 1, 3); tetrahedron(4, 5, 3, 0);
    i = 0;
    do
    :: i < 8 -> tetrahedron(i % 2, 2 + i / 2 % 2, 4 + i / 4, INFINITE); i++
    :: else -> break
    od
}

/* The vertices of a facet, as a set. */
#define ALL(t) (BIT(vertex[4 * (t)]) | BIT(vertex[4 * (t) + 1]) | BIT(vertex[4 * (t) + 2]) | BIT(vertex[4 * (t) + 3]))
#define FACET(f) (ALL(TET(f)) & ~BIT(vertex[f]))

inline find_mates() {
    i = 0;
    do
    :: i < 4 * count ->
        j = 0;
        do
        :: j < 4 * count ->
            if
            :: i != j && FACET(i) == FACET(j) -> mate[i] = j
            :: else -> skip
            fi;
            j++
        :: else -> break
        od;
        i++
    :: else -> break
    od
}

/* place_worker: the segments of a tetrahedron, if all are free. */
inline place(t) {
    d_step {
        held = 0; own = true; j = 0;
        do
        :: j < 4 ->
            if
            :: vertex[4 * (t) + j] != INFINITE ->
                own = own && !taken[vertex[4 * (t) + j] / VERTICES_A_SEGMENT];
                held = held | BIT(vertex[4 * (t) + j] / VERTICES_A_SEGMENT)
            :: else -> skip
            fi;
            j++
        :: else -> break
        od;
        j = 0;
        do
        :: own && j < SEGMENTS -> taken[j] = taken[j] || (held & BIT(j)); j++
        :: else -> break
        od;
        j = 0
    }
}

init {
    byte i, j, tet;
    short held;
    bool own;
    d_step { octahedron(); find_mates(); i = 0; j = 0 };
    atomic {
        do
        :: i < THREADS ->
            select(tet : 0 .. START - 1);
            place(tet);
            if
            :: own -> run inserter(i, tet, held)
            :: else -> done++
            fi;
            i++
        :: else -> break
        od;
        held = 0; own = false; i = 0; tet = 0
    };
    done == THREADS;
    done == THREADS;
    d_step {
        i = 0;
        do
        :: i < 4 * count -> assert(mate[mate[i]] == i && FACET(mate[i]) == FACET(i) && mate[i] != i); i++
        :: else -> break
        od;
        i = 0;
        do
        :: i < SEGMENTS -> assert(!taken[i]); i++
        :: else -> break
        od
    }
}
