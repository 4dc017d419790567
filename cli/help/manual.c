/* Texts that the help and the manual pages share. */
#include "cli/help/manual.h"
#include <stddef.h>

const manual_entry cli_exit_codes[] = {
    {"0", "done"},
    {"1", "wrong usage"},
    {"2", "an input is missing, unreadable or malformed"},
    {"3", "the input has no answer, as the surface of three points has none"},
    {"4", "not enough memory, or over --max-memory"},
    {"5", "the result, or the file of `brio check`, does not check"},
    {"6", "the output could not be written"},
    {"130", "interrupted: at most half a second of processor time after the signal"},
    {NULL, NULL},
};

const manual_entry cli_advice[] = {
    {"brio surface IN -o OUT", "points of a surface, noisy or not; open where they end; no normals needed. Start here"},
    {"brio surface IN --method cocone -o OUT", "an open surface: a shell, a part of an object; clean points"},
    {"brio surface IN --closed -o OUT", "a scan with holes, to be closed all over"},
    {"brio surface IN --noise smooth -o OUT", "noise that you see but the report does not (`smoothed`)"},
    {"brio surface IN --sharp -R 0.4 -o OUT", "machine parts whose sharp edges have no points on them"},
    {"brio surface IN --method tight-cocone -o OUT", "clean, dense points of a closed object: all of them vertices"},
    {"brio surface IN --method cocone --pieces 30 -o OUT", "more points than memory; clean ones"},
    {"brio delaunay IN --plane xy -o OUT", "terrain: one height at each place, as from the air"},
    {"brio alpha IN --alpha auto -o OUT", "points throughout a volume, not only on its surface"},
    {"brio hull IN -o OUT", "the convex hull"},
    {"brio iso MAP --level L -o OUT", "values on a grid, or atoms, and not points of a surface"},
    {"brio medial IN -o OUT", "the medial axis: the balls that fill the object"},
    {"brio offset IN --distance D -o OUT", "the surface at a distance from the object"},
    {NULL, NULL},
};

const char *const cli_group_titles[] = {"meshes and files", "surfaces", "triangulations and cells", NULL};
