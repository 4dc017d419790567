#!/usr/bin/env python3
"""The comment above a function begins with a verb: the function is the subject of its first sentence.

    check_comments.py FOLDER_OF_THE_PROJECT

"Returns the vertex ...", "Sorts n keys ...": a reader who knows the verb knows what the function is for. The check looks at
functions with a comment right above them, in all rooms of src and cli. A comment above several functions may use the plain form of the verb:
"Return the sign by stages 4 and 5."
"""
import pathlib
import re
import sys

# The verb: its form for one function ends in s, and these words, which end so too, are none.
NO_VERBS = set("""
    As Areas Barriers Bits Blocks Bounds Cells Centres Circles Colours Coordinates Copies Corners Counters Edges Faces Facets
    Files Flags Functions Handles Hashes Indices Its Keys Lanes Less Lists Logs Marks Minors Names Needs Neighbours Nodes
    Normals Numbers Options Orders Others Pairs Parts Pieces Places Planes Points Poles Positions Powers Products Queries
    Ranges Ranks Records Regions Representatives Rooms Rounds Rows Samples Segments Sides Signs Simplices Sites Sizes Slots
    Sorts Spans Spheres Squares Stars States Steps Sums Terms Tests Tetrahedra Thus This Ties Triangles Units Values Vectors
    Vertices Volumes Walks Walls Was Weights Words
    """.split())
# Words of NO_VERBS that are verbs, too, and mostly used as such above functions.
BOTH = set("Blocks Bounds Copies Counts Handles Hashes Lists Marks Names Needs Numbers Orders Places Ranks Records Rounds "
           "Pairs Samples Sorts Spans Squares Sums Tests Walks Weights".split())
PLAIN = set("Add Compute Do Encode Estimate Print Sort Call Decode Free Give Make Read Return Set Start Take Tell Test Write".split())  # above several functions

COMMENT = re.compile(r"^/\*\*?\s+(?!---)((?:[^*]|\*(?!/))*)\*/\n(?=([^\n]+))", re.M)


def is_function(text, at):
    """Whether the code at a place is a declaration or a definition of a function."""
    head = re.match(r"(?:[^;{}=#]|=\s*\{\})*", text[at:]).group()
    if re.match(r"(typedef|struct\s+\w+\s*\{|enum|union|#|extern const|extern \w+ \w+;)", text[at:]):
        return False
    return re.search(r"\w\s*\(", head) is not None and text[at + len(head):at + len(head) + 1] in ("{", ";")


def first_word(comment):
    return re.match(r"\W*([\w'-]*)", comment.replace("\n * ", " ").replace("\n *", " ")).group(1)


def is_verb(word):
    if word in PLAIN or word in BOTH:
        return True
    return re.fullmatch(r"[A-Z][a-z]+s", word) is not None and word not in NO_VERBS


def main(folder):
    found, looked_at = {}, 0
    for path in sorted([*(folder / "src").rglob("*.[ch]"), *(folder / "cli").rglob("*.[ch]")]):
        text, room = path.read_text(), path.parent.relative_to(folder).as_posix()
        for match in COMMENT.finditer(text):
            if not is_function(text, match.end()):
                continue
            looked_at += 1
            word = first_word(match.group(1))
            if not is_verb(word):
                line = text.count("\n", 0, match.start()) + 1
                found.setdefault(room, []).append(f"{path.relative_to(folder)}:{line}: begins with \"{word}\": {match.group(2)}")
    if found:
        print("\n".join(line for room in sorted(found) for line in found[room]))
        print("Let the function be the subject: \"Returns ...\", \"Sets ...\". A verb that this check does not know belongs in its "
              "list BOTH.")
    print(f"{looked_at} comments above functions, {sum(map(len, found.values()))} of them begin with no verb")
    return 1 if found or not looked_at else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
