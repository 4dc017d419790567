#!/usr/bin/env python3
"""Compares what an analyzer found with the findings that are explained: explained.py TOOL LOGS LIST [all].

LOGS is a folder with one log a source file, LIST is scripts/analysis.txt. Prints each finding that LIST does not explain,
and with `all`, where all source files were analysed, each entry of LIST that matches no finding. Exits with 1 if it
printed any."""
import os
import re
import sys

# gcc prints "cc1" in place of FILE:LINE:COLUMN where it has no place
FINDING = re.compile(r"^(?:(?P<file>[^\s:]+):(?P<line>\d+):\d+|(?P<none>cc1)): (?P<kind>warning|error|style|performance|"
                     r"portability|fatal error): (?P<message>.*?)(?: \[(?P<check>[^]]*)\])?$")


def source_line(path, line):
    with open(path, encoding="utf-8") as source:
        return source.read().split("\n")[line - 1].strip()


def findings(logs):
    """Yields (check, file, source line, printed line); the message stands for a source line that is not known."""
    for name in sorted(os.listdir(logs)):
        with open(os.path.join(logs, name), encoding="utf-8") as log:
            for text in log:
                m = FINDING.match(text.rstrip("\n"))
                if not m:
                    continue
                check = (m["check"] or m["kind"]).split(",")[0].removeprefix("-W")
                file = os.path.relpath(m["file"]) if m["file"] else m["none"]
                key = source_line(file, int(m["line"])) if m["line"] else m["message"]
                yield check, file, key, text.rstrip("\n")


def explained(path, tool):
    """Returns the entries of a tool. A paragraph of LIST is a reason, lines with #, then its entries."""
    entries, reason = set(), False
    with open(path, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            line = line.strip()
            if not line or line.startswith("#"):
                reason = bool(line)
                continue
            place, key = line.split(": ", 1)
            name, check, file = place.split()
            if not reason:
                sys.exit(f"{path}:{number}: an entry without a reason")
            if name == tool:
                entries.add((check, file, key))
    return entries


def main(tool, logs, path, *everything):
    entries, met, bad = explained(path, tool), set(), {}
    for check, file, key, text in findings(logs):
        met.add((check, file, key))
        if (check, file, key) not in entries:
            bad[text] = f"  as an entry: {tool} {check} {file}: {key}"
    for text, entry in bad.items():
        print(text, entry, sep="\n")
    stale = entries - met if everything else set()
    for check, file, key in sorted(stale):
        print(f"{path}: no longer found: {tool} {check} {file}: {key}")
    print(f"{tool}: {len(os.listdir(logs))} files, {len(met & entries)} findings explained, {len(bad)} not explained; "
          f"the logs are in {logs}")
    return 1 if bad or stale else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
