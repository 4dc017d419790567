"""check_functions.py ROOT: how large functions are, and how they end.

No function has more than 60 lines or 8 parameters; at most 10 functions have more than 6 parameters. Counted are the
functions defined in src, cli and include; those that a macro makes are not seen.

A function with the label done: frees something there, so it leaves by BRIO_TRY, BRIO_REQUIRE or goto: BRIO_FORWARD and BRIO_EXPECT
return past the label (in cli: TRY and FAIL; FORWARD). A label that only returns the status is a function that should use those two; LATER are the folders
that still have such labels.
"""

import pathlib
import re
import sys

MOST_LINES, MOST_PARAMETERS, MANY_PARAMETERS, MOST_WITH_MANY = 60, 8, 6, 10
DEFINED = re.compile(r"^(?!typedef|struct|enum|#|static const \w+ \w+\[)[A-Za-z_][\w\s*,()]*?\b(\w+)\(((?:[^;{}]|\n)*?)\) \{\n",
                     re.M)


LATER = {"src/reconstruct"}
IDLE_LABEL = re.compile(r"^    brio_status status = BRIO_OK;\n(?:(?!\bstatus\b)[^\0])*^done:\n    return status;\n\Z", re.M)


def wrong_ends(body, later):
    """What is wrong with the way that a function ends."""
    if "\ndone:\n" not in body:
        return
    if re.search(r"\b(BRIO_FORWARD|BRIO_EXPECT|FORWARD)\(", body):
        yield "leaves by BRIO_FORWARD or BRIO_EXPECT past its label done: use BRIO_TRY and BRIO_REQUIRE"
    elif not later and IDLE_LABEL.search(re.sub(r"/\*.*?\*/", "", body, flags=re.S)):
        yield "frees nothing at its label done: use BRIO_FORWARD and BRIO_EXPECT, and no label"


def parameters(text):
    """How many there are between the parentheses, of which some may hold parentheses."""
    depth, count = 0, 1
    for letter in text:
        depth += letter in "([" and 1 or letter in ")]" and -1 or 0
        count += letter == "," and depth == 0
    return 0 if text.strip() in ("", "void") else count


def functions(path):
    text = path.read_text(encoding="utf-8")
    for match in DEFINED.finditer(text):
        end = text.find("\n}", match.end() - 1)
        lines = text.count("\n", match.start(), end) + 2
        if not match.group(1).startswith("DEFINE_"):
            yield (match.group(1), lines, parameters(match.group(2)), text.count("\n", 0, match.start()) + 1,
                   text[match.end():end + 1])


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    wrong, many, count, longest = [], [], 0, 0
    for folder in "src", "cli", "include":
        for path in sorted((root / folder).rglob("*.[ch]")):
            later = any(path.is_relative_to(root / part) for part in LATER)
            for name, lines, number, at, body in functions(path):
                place = "%s:%d: %s" % (path.relative_to(root), at, name)
                wrong += ["%s %s" % (place, said) for said in wrong_ends(body, later)]
                count += 1
                longest = max(longest, lines)
                if lines > MOST_LINES:
                    wrong.append("%s has %d lines" % (place, lines))
                if number > MOST_PARAMETERS:
                    wrong.append("%s has %d parameters" % (place, number))
                if number > MANY_PARAMETERS:
                    many.append("%s has %d parameters" % (place, number))
    if len(many) > MOST_WITH_MANY or wrong:
        wrong += many
    print("\n".join([*wrong, "%d functions, the longest of %d lines, %d with more than %d parameters"
                     % (count, longest, len(many), MANY_PARAMETERS)]))
    return 1 if wrong or not count else 0


if __name__ == "__main__":
    sys.exit(main())
