"""check_doors.py ROOT: every public function that computes begins with BRIO_DOOR, which sets the floating-point state
that exactness needs and gives the host's back (src/base/float_state.h)."""

import pathlib
import re
import sys

# Handles, settings and views: no arithmetic on doubles in them, nor in what they call.
NO_ARITHMETIC = re.compile(r"brio_(\w+_)?(free|string|message|size|format_of|format_facts|format_list|surface_method_facts|surface_method_has|version|version_number)$|brio_context_|brio_laboratory_|brio_last_failure$|brio_reason_name$|brio_tiles_(facts|cells_facts|has_points)$|brio_ranks_(facts|cells_facts|has_points|sent|led)$|brio_triangulation2?_"
                           r"(stats|tetrahedra|triangles|representatives|points_hash|line)$|brio_periodic_(facts|images|positions|tetrahedra|representatives)$|brio_mesh_(new|set_\w+|add_property|add_face_property|cell|metadata|property\w*|face_property)$")
DECLARED = re.compile(r"BRIO_API\s+[\w\s*]*?\b(brio_\w+)\s*\(")


def body_of(name, sources):
    """Where a function is defined, and the text after its opening brace."""
    defined = re.compile(r"^(?:[\w*]+[\s*]+)+%s\([^;{}]*\)\s*\{\n" % name, re.M)
    for path, text in sources.items():
        match = defined.search(text)
        if match:
            return path, text[match.end():match.end() + 200]
    return None, ""


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    header = "".join(path.read_text(encoding="utf-8") for path in sorted((root / "include/brio").glob("*.h")))
    sources = {path.relative_to(root): path.read_text(encoding="utf-8") for path in sorted((root / "src").rglob("*.c"))}
    names = sorted(set(DECLARED.findall(header)))
    wrong = []
    for name in names:
        path, body = body_of(name, sources)
        if path is None:
            wrong.append("%s: declared, and defined nowhere in src" % name)
        elif not NO_ARITHMETIC.match(name) and not body.lstrip().startswith("BRIO_DOOR;"):
            wrong.append("%s: %s does not begin with BRIO_DOOR" % (path, name))
    print("\n".join([*wrong, "%d public functions, %d complaints" % (len(names), len(wrong))]))
    return 1 if wrong or not names else 0


if __name__ == "__main__":
    sys.exit(main())
