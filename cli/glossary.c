/* What the lines of reports mean. */
#include "glossary.h"
#include <stdio.h>
#include <string.h>

#define MESHES         "surface hull alpha offset iso generate subdivide medial check"
#define TRIANGULATIONS "delaunay voronoi"
#define POLES          "surface medial offset"

const glossary_line cli_glossary[] = {
    {NULL, NULL, "command", NULL, "the command that ran", LINE_VERBOSE, STYLE_PLAIN},
    {"generate", NULL, "input", "kind", "the kind of data", LINE_PLAIN, STYLE_PLAIN},
    {NULL, NULL, "input", NULL, "the file that was read", LINE_PLAIN, STYLE_PLAIN},
    {NULL, NULL, "output", NULL, "the file of -o", LINE_PLAIN, STYLE_PLAIN},

    /* What was made. */
    {"surface offset hull alpha", NULL, "method", NULL, "how the surface was made", LINE_PLAIN, STYLE_PLAIN},
    {"offset", NULL, "distance", NULL, "from the surface through the points to this one, as asked for", LINE_PLAIN,
     STYLE_PLAIN},
    {"alpha", NULL, "alpha", NULL, "squared radius of the alpha shape", LINE_PLAIN, STYLE_PLAIN},
    {"alpha", NULL, "radius", NULL, "the square root of alpha", LINE_PLAIN, STYLE_PLAIN},
    {NULL, NULL, "float32", NULL, "no: --float32 gave way, since single precision would merge points or move them far",
     LINE_PLAIN, STYLE_PLAIN},
    {NULL, NULL, "moved", NULL, "the most that a coordinate in the file differs from what it was", LINE_PLAIN,
     STYLE_PLAIN},
    {NULL, NULL, "merged", NULL, "points that have another point's position in the file", LINE_PLAIN, STYLE_PLAIN},
    {"subdivide", NULL, "levels", NULL, "how many times each triangle became four", LINE_PLAIN, STYLE_PLAIN},
    {"surface offset hull alpha medial", NULL, "samples", "distinct points",
     "distinct positions among the points of the input", LINE_PLAIN, STYLE_PLAIN},
    {"iso", NULL, "points", NULL, "the same as vertices", LINE_JSON, STYLE_PLAIN},
    {"info generate convert", NULL, "points", NULL, "points in the file", LINE_PLAIN, STYLE_PLAIN},
    {TRIANGULATIONS " locate interpolate", NULL, "points", NULL, "points of the input, duplicates included", LINE_PLAIN,
     STYLE_PLAIN},
    {TRIANGULATIONS, NULL, "duplicates", NULL, "points at the position of another point; that one stands for them",
     LINE_PLAIN, STYLE_PLAIN},
    {"info locate interpolate", NULL, "duplicates", NULL, "points at the position of another point", LINE_PLAIN,
     STYLE_PLAIN},
    {TRIANGULATIONS, NULL, "hidden", NULL,
     "points that are no vertex since heavier points hide them (with weights only)", LINE_PLAIN, STYLE_UNLESS_ZERO},
    {"delaunay voronoi check", NULL, "weighted", NULL, "whether the points have weights", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay", NULL, "vertices", NULL, "points that the triangulation has as corners", LINE_PLAIN, STYLE_PLAIN},
    {"medial", NULL, "vertices", NULL, "balls of the medial axis, each a vertex with the property radius", LINE_PLAIN,
     STYLE_PLAIN},
    {MESHES, NULL, "vertices", NULL, "vertices of the mesh", LINE_PLAIN, STYLE_PLAIN},
    {"voronoi", NULL, "cells", NULL, "cells, one for each vertex of the triangulation", LINE_PLAIN, STYLE_PLAIN},
    {"voronoi", NULL, "bounded", NULL, "cells of finite volume", LINE_PLAIN, STYLE_PLAIN},
    {"voronoi", NULL, "faces", NULL, "faces of all cells, a face between two cells counted for each", LINE_PLAIN,
     STYLE_PLAIN},
    {"voronoi", NULL, "volume", NULL, "sum of the volumes of the bounded cells", LINE_PLAIN, STYLE_PLAIN},
    {"voronoi", NULL, "box_volume", NULL, "volume of the box of --box", LINE_PLAIN, STYLE_PLAIN},
    {"voronoi", NULL, "box_error", NULL, "how far the cells' volume is from the box's, as a share of it", LINE_PLAIN,
     STYLE_PLAIN},
    {MESHES " info convert", NULL, "faces", NULL, "faces of the mesh", LINE_PLAIN, STYLE_PLAIN},
    {"convert", NULL, "tetrahedra", NULL, "tetrahedra of the mesh", LINE_PLAIN, STYLE_PLAIN},
    {"convert", NULL, "points_read", NULL, "points of the input", LINE_PLAIN, STYLE_PLAIN},
    {"convert", NULL, "outliers", NULL, "points dropped by --drop-outliers", LINE_PLAIN, STYLE_PLAIN},
    {"convert", NULL, "thinned", NULL, "points dropped by --thin", LINE_PLAIN, STYLE_PLAIN},
    {"convert", NULL, "lost", NULL, "names of what the output format cannot hold", LINE_PLAIN, STYLE_PLAIN},
    {"convert", NULL, "streamed", NULL, "whether the points went by in blocks; else the whole file was in memory",
     LINE_VERBOSE, STYLE_PLAIN},
    {"hull", NULL, "facets", NULL, "convex polygons that the hull consists of, of which faces may be parts", LINE_PLAIN,
     STYLE_PLAIN},
    {TRIANGULATIONS " hull", NULL, "dimension", NULL,
     "3; of points in one plane 2, on one line 1, at one position 0, of no points -1", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay", NULL, "triangles", NULL, "triangles (--plane)", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay", NULL, "hull_edges", NULL, "edges of the convex hull (--plane)", LINE_PLAIN, STYLE_PLAIN},
    {"medial", NULL, "edges", NULL, "edges between balls", LINE_PLAIN, STYLE_PLAIN},
    {"medial", NULL, "triangles", NULL, "triangles of three balls", LINE_PLAIN, STYLE_PLAIN},
    {"medial", NULL, "tetrahedra", NULL, "tetrahedra of four balls", LINE_PLAIN, STYLE_PLAIN},
    {"alpha", NULL, "tetrahedra", NULL, "tetrahedra inside the shape", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay locate interpolate check info", NULL, "tetrahedra", NULL, "tetrahedra", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay", NULL, "hull_facets", NULL, "triangles of the convex hull", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "format", NULL, "of the file, found by its content or its name", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "version", NULL, "of the format", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "coordinate_step", NULL, "coordinates are whole multiples of this (LAS)", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "coordinate_origin", NULL, "counted from here (LAS)", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "box", NULL, "smallest and largest coordinates", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "spacing", NULL, "typical distance of a point to its nearest neighbour", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "properties", NULL, "what the file holds for each point besides the position, with the types",
     LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "ranges", NULL, "least and greatest value of each property", LINE_PLAIN, STYLE_PLAIN},
    {"info", NULL, "estimate_bytes", "memory needed", "estimate for each command; --max-memory goes by it", LINE_PLAIN,
     STYLE_PLAIN},
    {"locate interpolate", NULL, "inside", NULL, "places inside the convex hull of the points", LINE_PLAIN,
     STYLE_PLAIN},
    {"locate interpolate", NULL, "outside", NULL, "places outside it, which have no tetrahedron and no value",
     LINE_PLAIN, STYLE_PLAIN},
    {"generate", NULL, "truth_vertices", NULL, "vertices of the surface that was scanned (--truth)", LINE_PLAIN,
     STYLE_PLAIN},
    {"generate", NULL, "truth_faces", NULL, "its faces", LINE_PLAIN, STYLE_PLAIN},
    {"compare", NULL, "mean", "mean distance", "mean distance between the surfaces, both ways", LINE_PLAIN,
     STYLE_PLAIN},
    {"compare", NULL, "rms", "rms distance", "root of the mean squared distance", LINE_PLAIN, STYLE_PLAIN},
    {"compare", NULL, "p95", "95 % within", "distance that 95 in 100 places are within", LINE_PLAIN, STYLE_PLAIN},
    {"compare", NULL, "hausdorff", "largest distance", "largest distance that was met (Hausdorff)", LINE_PLAIN,
     STYLE_PLAIN},
    {"compare", NULL, "normal_consistency", NULL,
     "mean |cosine| of the angle between normals at nearest places; 1 is best", LINE_PLAIN, STYLE_PLAIN},
    {"compare", NULL, "diagonal", NULL, "of the box of the second surface, the measure of its size", LINE_PLAIN,
     STYLE_PLAIN},
    {"compare", NULL, "percent_of_diagonal", "per cent of the diagonal", "the distances, in per cent of it", LINE_PLAIN,
     STYLE_PLAIN},

    /* Whether it is sound. */
    {"delaunay check", NULL, "verified", NULL, "whether the exact check of the triangulation passed", LINE_PLAIN,
     STYLE_PLAIN},
    {"check", NULL, "canonical", NULL, "whether ties are broken as brio breaks them", LINE_PLAIN, STYLE_PLAIN},
    {MESHES, NULL, "certificate", NULL, "what was found of the surface that was made or read:", LINE_PLAIN,
     STYLE_PLAIN},
    {NULL, "certificate", "closed", NULL, "every edge has two faces: watertight, without a hole in it", LINE_PLAIN,
     STYLE_PLAIN},
    {NULL, "certificate", "manifold", NULL, "no edge has more than two faces, no vertex joins two fans of faces",
     LINE_PLAIN, STYLE_PLAIN},
    {NULL, "certificate", "oriented", NULL, "neighbouring faces have the same side outside", LINE_PLAIN, STYLE_PLAIN},
    {NULL, "certificate", "components", NULL, "separate pieces of surface", LINE_PLAIN, STYLE_PLAIN},
    {NULL, "certificate", "genus", NULL, "handles of all pieces together: 0 for a ball, 1 for a ring", LINE_PLAIN,
     STYLE_PLAIN},
    {NULL, "certificate", "genera", NULL, "the older name of genus_by_component", LINE_JSON, STYLE_PLAIN},
    {NULL, "certificate", "genus_by_component", NULL,
     "handles of each piece, the piece of most faces first; shown where there are several", LINE_PLAIN,
     STYLE_UNLESS_ZERO},
    {NULL, "certificate", "boundary_edges", NULL, "edges with one face; shown where there are any", LINE_PLAIN,
     STYLE_UNLESS_ZERO},
    {NULL, "certificate", "boundary_loops", NULL, "closed chains of such edges: the rims of holes; likewise",
     LINE_PLAIN, STYLE_UNLESS_ZERO},
    {NULL, "certificate", "nonmanifold_edges", NULL, "edges with more than two faces; likewise", LINE_PLAIN,
     STYLE_UNLESS_ZERO},
    {NULL, "certificate", "nonmanifold_vertices", NULL, "vertices that join several fans of faces; likewise",
     LINE_PLAIN, STYLE_UNLESS_ZERO},
    {NULL, "certificate", "flipped_edges", NULL, "edges across which the faces disagree about the outside; likewise",
     LINE_PLAIN, STYLE_UNLESS_ZERO},
    {NULL, "certificate", "self_intersections", "self-intersections",
     "pairs of faces that run through each other; counted with --self-intersections only", LINE_PLAIN, STYLE_COUNTED},
    {NULL, "certificate", "area", NULL, "of all faces", LINE_PLAIN, STYLE_PLAIN},
    {NULL, "certificate", "volume", NULL, "enclosed, of a closed surface; negative if it is turned inside out",
     LINE_PLAIN, STYLE_PLAIN},
    {"surface", NULL, "uncertain_share", "uncertain",
     "share of the surface that is a guess: vertices whose property confidence is under 0.7", LINE_PLAIN,
     STYLE_PER_CENT},
    {POLES, NULL, "noise", "noise found", "standard deviation of the noise of the points, in spacings of them; 0: none",
     LINE_PLAIN, STYLE_SPACINGS},
    {POLES, NULL, "smoothed", NULL, "whether the points were smoothed because of it (--noise)", LINE_PLAIN,
     STYLE_PLAIN},
    {"surface", NULL, "dropped_components", NULL, "pieces dropped by --keep-largest and --min-component", LINE_PLAIN,
     STYLE_PLAIN},
    {"surface", NULL, "dropped_faces", NULL, "their faces", LINE_PLAIN, STYLE_PLAIN},
    {"surface", NULL, "boundary_samples", NULL, "points found to be at a boundary of the surface (--boundaries)",
     LINE_PLAIN, STYLE_PLAIN},
    {"medial", NULL, "left_out", NULL, "balls left out by --simplify, --scale or --redundancy", LINE_PLAIN,
     STYLE_PLAIN},
    {"surface offset", NULL, "left_out", "left open", "faces left out because they span holes (--open)", LINE_PLAIN,
     STYLE_PLAIN},
    {POLES, NULL, "labeling", NULL, "what told inside from outside (--labeling)", LINE_PLAIN, STYLE_PLAIN},
    {"surface", NULL, "extraction", NULL, "which candidate triangles make the surface (--extraction)", LINE_VERBOSE,
     STYLE_PLAIN},
    {"surface", NULL, "pieces", NULL, "parts that were triangulated one after the other (--pieces)", LINE_PLAIN,
     STYLE_PLAIN},
    {"surface", NULL, "sampling", NULL,
     "how densely the points sample the surface, for the co-cones' guarantee:", LINE_PLAIN, STYLE_PLAIN},
    {NULL, "sampling", "r_median", NULL,
     "median over the points of the estimated r: distance to neighbours by distance "
     "to the medial axis",
     LINE_PLAIN, STYLE_PLAIN},
    {NULL, "sampling", "r_p95", NULL, "the r that 95 in 100 points are under", LINE_PLAIN, STYLE_PLAIN},
    {NULL, "sampling", "outside_guarantee", NULL, "points whose r is over 0.08, so that nothing is guaranteed there",
     LINE_PLAIN, STYLE_PLAIN},
    {NULL, "sampling", "outside_share", NULL, "their share", LINE_PLAIN, STYLE_PER_CENT},
    {"alpha", NULL, "uncovered", "points left out", "points that are in no tetrahedron of the shape", LINE_PLAIN,
     STYLE_PLAIN},
    {"delaunay", NULL, "checksum", NULL, "equal for equal triangulations, whatever the order of the points", LINE_PLAIN,
     STYLE_PLAIN},
    {"delaunay", NULL, "subgraph", NULL,
     "edges of the mesh that were gone along: which, how many, the most at a vertex", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay", NULL, "rounds", NULL,
     "the counters at the ends of rounds (--rounds), or now and then (--record-every)", LINE_PLAIN, STYLE_PLAIN},

    /* What it cost. */
    {NULL, NULL, "threads", NULL, "threads that could be used", LINE_VERBOSE, STYLE_PLAIN},
    {NULL, NULL, "seconds", NULL, "how long it took; with --verbose by stage", LINE_PLAIN, STYLE_PLAIN},
    {NULL, NULL, "peak_bytes", "memory", "the most memory that the program held at a time", LINE_PLAIN, STYLE_PLAIN},
    {"delaunay", NULL, "created", NULL, "tetrahedra made on the way, infinite ones included (--plane: triangles)",
     LINE_VERBOSE, STYLE_PLAIN},
    {"delaunay", NULL, "destroyed", NULL, "those of them that later points replaced", LINE_VERBOSE, STYLE_PLAIN},
    {"delaunay", NULL, "walk_steps", NULL, "steps from tetrahedron to tetrahedron in search of points", LINE_VERBOSE,
     STYLE_PLAIN},
    {"delaunay", NULL, "insphere_calls", NULL, "tests of a point against a sphere", LINE_VERBOSE, STYLE_PLAIN},
    {"delaunay", NULL, "incircle_calls", NULL, "tests of a point against a circle (--plane)", LINE_VERBOSE,
     STYLE_PLAIN},
    {"delaunay", NULL, "exact_calls", NULL, "tests that floating-point arithmetic did not settle", LINE_VERBOSE,
     STYLE_PLAIN},
    {"medial", NULL, "poles", NULL, "polar balls of the points, two a point at most", LINE_VERBOSE, STYLE_PLAIN},
    {"medial", NULL, "inner", NULL, "those inside the surface", LINE_VERBOSE, STYLE_PLAIN},
    {"medial", NULL, "outer", NULL, "those outside", LINE_VERBOSE, STYLE_PLAIN},
    {"medial", NULL, "unlabelled", NULL, "those on no side", LINE_VERBOSE, STYLE_PLAIN},
    {NULL, NULL, "error", NULL, "why a run failed", LINE_JSON, STYLE_PLAIN},
    {NULL, NULL, "exit", NULL, "the exit code of a failed run", LINE_JSON, STYLE_PLAIN},

    /* How it was done: the words of the papers, see docs/algorithms.md. */
    {"delaunay", NULL, "deferred", NULL, "insertions put off since threads met", LINE_INTERNAL, STYLE_PLAIN},
    {"delaunay", NULL, "serial", NULL, "insertions left to one thread", LINE_INTERNAL, STYLE_PLAIN},
    {"delaunay", NULL, "history", NULL, "nodes of the history DAG (--locate history, trace)", LINE_INTERNAL,
     STYLE_PLAIN},
    {"delaunay", NULL, "history_tests", NULL, "nodes of it that searches looked at", LINE_INTERNAL, STYLE_PLAIN},
    {"delaunay", NULL, "trace_intersections", NULL, "tetrahedra entered along the edges of the mesh (--locate trace)",
     LINE_INTERNAL, STYLE_PLAIN},
    {"surface", NULL, "unused", NULL, "points that are no vertex of the surface", LINE_INTERNAL, STYLE_PLAIN},
    {"surface", NULL, "specks", NULL, "small regions, inside or outside, that were dropped", LINE_INTERNAL,
     STYLE_PLAIN},
    {"surface", NULL, "relabeled", NULL, "tetrahedra whose side was changed to make the surface a manifold or simpler",
     LINE_INTERNAL, STYLE_PLAIN},
    {"surface", NULL, "handles", NULL, "handles, tunnels and bubbles removed because little evidence held them",
     LINE_INTERNAL, STYLE_PLAIN},
    {"hull", NULL, "candidates", NULL, "points that were not certainly inside", LINE_INTERNAL, STYLE_PLAIN},
    {"surface", NULL, "candidates", NULL, "triangles that pass the co-cone test", LINE_INTERNAL, STYLE_PLAIN},
    {"surface", NULL, "pruned", NULL, "candidates rejected at sharp edges", LINE_INTERNAL, STYLE_PLAIN},
    {"surface", NULL, "unmatched", NULL, "triangles left out where the pieces disagree (--pieces)", LINE_INTERNAL,
     STYLE_PLAIN},
    {"surface offset", NULL, "poles", NULL, "polar balls of the points, two a point at most", LINE_INTERNAL,
     STYLE_PLAIN},
    {POLES, NULL, "hidden_poles", NULL, "polar balls without a power cell", LINE_INTERNAL, STYLE_PLAIN},
    {"surface offset", NULL, "inner", NULL, "polar balls inside the surface", LINE_INTERNAL, STYLE_PLAIN},
    {"surface offset", NULL, "outer", NULL, "polar balls outside", LINE_INTERNAL, STYLE_PLAIN},
    {POLES, NULL, "confused", NULL, "polar balls with evidence for both sides", LINE_INTERNAL, STYLE_PLAIN},
    {POLES, NULL, "unreached", NULL, "polar balls that the labeling left to the greedy one", LINE_INTERNAL,
     STYLE_PLAIN},
    {POLES, NULL, "energy", NULL, "weight of the evidence that the labels contradict", LINE_INTERNAL, STYLE_PLAIN},
    {POLES, NULL, "energy_greedy", NULL, "that of the greedy labels, which the labeling started from", LINE_INTERNAL,
     STYLE_PLAIN},
    {POLES, NULL, "undecided", NULL, "labels that the last optimization did not settle", LINE_INTERNAL, STYLE_PLAIN},
    {POLES, NULL, "toggled", NULL, "labels that differ from the greedy ones", LINE_INTERNAL, STYLE_PLAIN},
    {POLES, NULL, "bad_cells", NULL, "points with badly shaped cells, whose balls were discarded (-R, --sharp)",
     LINE_INTERNAL, STYLE_PLAIN},
    {"alpha", NULL, "simplices", NULL, "vertices, edges, triangles and tetrahedra of the filtration", LINE_INTERNAL,
     STYLE_PLAIN},
    {"alpha", NULL, "split", NULL, "vertices doubled where parts of the solid touch", LINE_INTERNAL, STYLE_PLAIN},
    {"alpha", NULL, "singular_vertices", NULL, "vertices of the alpha complex that bound no tetrahedron of it",
     LINE_INTERNAL, STYLE_PLAIN},
    {"alpha", NULL, "singular_edges", NULL, "such edges", LINE_INTERNAL, STYLE_PLAIN},
    {"alpha", NULL, "singular_facets", NULL, "such triangles", LINE_INTERNAL, STYLE_PLAIN},
    {NULL, NULL, NULL, NULL, NULL, LINE_PLAIN, STYLE_PLAIN},
};

/* Whether a word stands in a list of words with blanks between. */
static bool lists(const char *words, const char *word) {
    size_t length = strlen(word);
    while (*words) {
        size_t next = strcspn(words, " ");
        if (next == length && !memcmp(words, word, length)) return true;
        words += next + strspn(words + next, " ");
    }
    return false;
}

bool cli_glossary_fits(const glossary_line *line, const char *command, const char *parent) {
    bool nested = line->parent && parent && !strcmp(line->parent, parent);
    if (!nested && (line->parent || parent)) return false;
    return !line->commands || lists(line->commands, command);
}

const glossary_line *cli_glossary_find(const char *command, const char *parent, const char *key) {
    for (const glossary_line *line = cli_glossary; line->key; line++)
        if (!strcmp(line->key, key) && cli_glossary_fits(line, command, parent)) return line;
    return NULL;
}

bool cli_is_internal(const char *command, const char *key) {
    const glossary_line *line = cli_glossary_find(command, NULL, key);
    return line && line->level == LINE_INTERNAL;
}

void cli_glossary_label(const glossary_line *line, const char *key, char *label, size_t size) {
    bool named = line && line->label;
    snprintf(label, size, "%s", named ? line->label : key);
    for (char *c = label; line && *c; c++)
        if (*c == '_') *c = ' ';
}
