/* Every hint and every warning of the program, one row each. A hint follows a failure and says what to try; a warning
 * is about a result that is there. tests/cli/test_hints.py has an input for each row that evokes the sentence, follows
 * what it proposes, and fails where a row has no such input. */
#ifndef BRIO_CLI_SENTENCES_H
#define BRIO_CLI_SENTENCES_H

#include <inttypes.h>

/* --- hints --- */

#define HINT_EXAMPLE      "for example: %.*s"
#define HINT_OUTPUTS      "'brio %s' writes files with the extensions %s"
#define HINT_DISTANCE     "a --distance nearer to 0 leaves something"
#define HINT_SOLID        "the points must surround a solid: see what 'brio surface' makes of them first"
#define HINT_LABELING     "--labeling global goes by the points of the mesh and not by its faces"
#define HINT_ALPHA        "a larger --alpha takes in more; --alpha auto finds the least with all points in one solid"
#define HINT_LEVEL        "a lower --level; with --sigma it counts in standard deviations above the mean"
#define HINT_TRIANGLES    "'brio convert FILE OUT.stl' cuts polygons into triangles"
#define HINT_CHECK        "'brio check FILE' says what is wrong with the mesh"
#define HINT_METHODS      "'brio help methods' says which command and method fits which points (docs/which-method.md)"
#define HINT_SCRATCH      "--scratch DIR keeps the big arrays in files on a disk"
#define HINT_LIMIT        "a larger --max-memory"
#define HINT_PIECES       "--method cocone --pieces %d works through the points in parts, one after the other"
#define HINT_ESTIMATE     "'brio info FILE' estimates what each command needs"
#define HINT_OPEN         "--open accepts a surface with a boundary, or curves with ends"
#define HINT_REPORT       "'brio check --help --verbose' explains the lines of the report"
#define HINT_ISO          "'brio iso' reads maps and atoms; 'brio surface' makes surfaces of points"
#define HINT_INPUT_FORMAT "--input-format EXT names the format of a file whose name does not tell it"
#define HINT_SURFACE      "'brio surface' makes a surface of points"
#define HINT_PROPERTIES   "'brio info FILE' lists the properties of the points"
#define HINT_HOLES        "a larger --open K takes fewer gaps between points for holes"
#define HINT_COMPONENTS   "a smaller --min-component N keeps more pieces"
#define HINT_COCONE       "--method cocone --boundaries makes an open surface, where there is no inside"
#define HINT_PLANE                                                                                                     \
    "the points lie in a plane: 'brio delaunay %s --plane %s -o OUT' makes triangles of them, --curves curves"
#define HINT_LINE  "the points lie on one line: no surface passes through them"
#define HINT_MERGE "%zu vertices are at the positions of others: 'brio convert %s OUT --merge' makes them one"

/* --- warnings --- */

#define WARNING_CELLS                                                                                                  \
    "%s: %zu of %zu cells are not shown: those without end, without a box those that reach far beyond the points, "    \
    "and of over 8,000 others all but an even choice"
#define WARNING_EXPLAIN "%s: the page explains an even choice of %zu of %zu samples"
#define WARNING_CHOSEN  "%s: shows an even choice of %zu of %zu tetrahedra"
#define WARNING_PAGE    "%s: %llu points are not on the page, which shows an even choice; --points N shows more"

#define WARNING_FILTRATION "%s: shows this alpha alone: with its %zu facets the page would be too large for all alphas"

#define WARNING_DENSITY                                                                                                \
    "the points hardly show the surface (median of r %.2f; points all over a volume have 1.05): too few of them, "     \
    "noise, or thin walls; with noise --method labeled-delaunay does better"
#define WARNING_GUESS                                                                                                  \
    "%.1f %% of the surface is a guess (vertices whose property confidence is under 0.7): points of an open or flat "  \
    "thing, too few of them, or walls too thin for them; see 'brio help methods'"
#define WARNING_BRIDGES                                                                                                \
    "%.1f %% of the area spans gaps between the points, where nothing was seen: %zu bridges, the largest at %g %g "    \
    "%g, "                                                                                                             \
    "%g across; --open %s"
#define WARNING_UNSEEN "%.1f %% of the area is where no point is near: %zu bridges, the largest at %g %g %g, %g across"
#define WARNING_ASIDE  "the %s of the points are of no use: they agree with the surface at %.0f %% of these"
#define WARNING_STEPS                                                                                                  \
    "depths are rounded to steps of about %g, which are higher than the points are apart: %zu points were moved by "   \
    "at "                                                                                                              \
    "most half a step, so that steps are slopes; --noise keep leaves them where they are"
#define WARNING_LEFT_OUT "%zu of %zu points are farther than two spacings from the surface"
#define WARNING_MORE_FACES                                                                                             \
    "%zu faces are left, more than the %zu asked for: borders and topology stay, and no faces may come to cross"
#define WARNING_THETA      "--theta: no guarantee holds under %g"
#define WARNING_LOST       "%s is without:%s"
#define WARNING_RENAMED    "%s has other names for:%s"
#define WARNING_DROPPED    "%s: left out %" PRIu64 " points that are not finite"
#define WARNING_MISSING    "%s: ends early: %" PRIu64 " points miss"
#define WARNING_OVERRULED  "--weights%s overrules the property %s of the points"
#define WARNING_RADII      "the points have radii: each weighs its radius squared (--unweighted ignores the radii)"
#define WARNING_TETRAHEDRA "%s: without the tetrahedra, which the format cannot hold"
#define WARNING_SINGLE     "%s: %s"
#define WARNING_DOUBLE     "%s: in double precision: %s"
#define WARNING_PROVEN     "the surface is proven to be within %g of the offset, not within %g"
#define WARNING_CONNECTED  "%s has %zu face%s, which do not count: 'brio %s' makes a surface of the points alone"
#define WARNING_COLOURS    "%s: the colours have fewer steps than those of the input"
#define WARNING_MERGED     "%s: single precision merges %zu points with others"
#define WARNING_MOVED      "%s: rounded coordinates move points by up to %.3g"
#define WARNING_FACES      "%s: without the faces, which the format cannot hold"
#define WARNING_EDGES      "%s: without the edges, which the format cannot hold"
#define WARNING_NAMES      "%s: without the names of the properties:%s"
#define WARNING_PROPERTIES "%s: without the properties, which the format cannot hold:%s"
#define WARNING_IDLE_ASCII "%s: --ascii changes nothing in this format"
#define WARNING_RARE_DOUBLES                                                                                           \
    "%s: coordinates are doubles, which PCL and Open3D take for zeros: --float32 writes singles"
#define WARNING_IDLE_FLOAT32 "%s: --float32 changes nothing in this format"
#define WARNING_NOT_FINITE   "%zu values of '%s' are not finite: neither are the results beside them"
#define WARNING_COINCIDENT   "%zu points are at the positions of others: the value of the first one there counts"
#define WARNING_IN_PLANE     "the points are in a plane: places are projected to it"
#define WARNING_ON_LINE      "the points are on a line: places are projected to it"
#define WARNING_BEYOND       "%zu of %zu squared radii in the filtration are beyond doubles: scale the points"
#define WARNING_SET_ASIDE    "the property %s of the points is now %s"
#define WARNING_SELF         "the surface intersects itself: %lld pairs of faces"
#define WARNING_APART                                                                                                  \
    "some vertices are at the positions of others, and the surface is not closed: 'brio convert %s OUT --merge' "      \
    "joins it there"
#define WARNING_OUTSIDE                                                                                                \
    "%zu of %zu points are outside the box, so that their cells are cut off or empty: 'brio info %s' says where the "  \
    "points are"
#define WARNING_CELL "%s has a cell, which is not used: --periodic %s lets its points repeat"
#define WARNING_FULL                                                                                                   \
    "all %zu tetrahedra are in the shape, which fills space and has no surface: a smaller --alpha leaves holes"
#define WARNING_NUMBERED                                                                                               \
    "%s: its first column numbers the rows and is read as x: --columns -,x,y,z leaves it out (names behind z keep "    \
    "further columns)"
#define WARNING_ROUNDED "%s: line %" PRIu64 ": a whole number beyond 2^53 is rounded (column %s; %" PRIu64 " in all)"

#endif
