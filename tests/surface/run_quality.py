"""run_quality.py MODELS DATA JUDGE [METHOD]: surfaces of real samples, held against an independent judge.

Each row of MODELS names a file of samples in DATA, the true surface or '-', and what JUDGE (a program that prints the
topology of a mesh and its distance to the truth as JSON) has to find; '-' is not judged. The certificate that brio
prints has to say of closedness, orientation, components and genus what the judge says.

BRIO names the program. This script needs Python's standard library only, the judge numpy and scipy.
"""

import concurrent.futures
import csv
import importlib.util
import json
import os
import subprocess
import sys
import tempfile

BRIO = os.environ.get("BRIO", "brio")
PROCESSES = 2
LARGE = 310000  # bytes of a file of samples: larger ones are for make check-all
FAR = 0.3  # a chamfer distance that takes the judge ten times as long as a usual one: for make check-all, too
SKIPPED = 77
EXACT = {"watertight": "watertight", "flipped": "flipped_edges", "nonmanifold": "nonmanifold_vertices",
         "components": "components", "genus": "genus"}
MODEL_COLUMNS = ["file", "truth", *EXACT, "chamfer"]


def read_models(path):
    with open(path, newline="") as f:
        rows = csv.DictReader((line for line in f if not line.startswith("#")), delimiter="\t")
        models = list(rows)
    if rows.fieldnames != MODEL_COLUMNS:
        sys.exit("%s: the columns are %s, expected %s" % (path, rows.fieldnames, MODEL_COLUMNS))
    return models


def json_of(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
    if done.returncode:
        raise RuntimeError("%s: exit status %d: %s" % (" ".join(command), done.returncode, done.stderr.strip()))
    return json.loads(done.stdout)


def certificate_differences(certificate, judged):
    """What the certificate says otherwise than the judge, who gives open surfaces no genus."""
    claims = {
        "closed": (certificate["closed"], judged["watertight"]),
        "oriented": (certificate["oriented"], judged["flipped_edges"] == 0),
        "manifold": (certificate["manifold"], judged["nonmanifold_edges"] + judged["nonmanifold_vertices"] == 0),
        "components": (certificate["components"], judged["components"]),
        "genus": (certificate["genus"], judged["genus"]),
    }
    return ["the certificate says %s %s, the judge %s" % (key, ours, theirs)
            for key, (ours, theirs) in claims.items() if ours != theirs and theirs is not None]


def model_differences(model, judged):
    """What the judge finds otherwise than the table of models."""
    wrong = []
    for column, key in EXACT.items():
        if model[column] != "-" and int(judged[key]) != int(model[column]):
            wrong.append("%s %d, expected %s" % (key, judged[key], model[column]))
    if model["chamfer"] != "-" and not judged["chamfer"] <= float(model["chamfer"]):
        wrong.append("chamfer %.5f, at most %s" % (judged["chamfer"], model["chamfer"]))
    return wrong


def examine(model, data, judge, method):
    """Reconstructs one model. Returns the line to print of it and what is wrong."""
    with tempfile.TemporaryDirectory(prefix="brio-quality-") as folder:
        mesh = os.path.join(folder, "surface.ply")
        try:
            facts = json_of([BRIO, "surface", os.path.join(data, model["file"]), "-o", mesh, "--method", method,
                             *(["--polygons"] if method == "power-crust" else []),
                             "--json", "--quiet"])
            truth = [] if model["truth"] == "-" else [os.path.join(data, model["truth"])]
            judged = json_of([sys.executable, judge, mesh, *truth])
        except (RuntimeError, ValueError) as error:
            return model["file"], [str(error)]
    line = "%-22s %7d faces  components %d  genus %d" % (model["file"], judged["faces"], judged["components"],
                                                         judged["genus"] or 0)
    if truth:
        line += "  chamfer %.5f" % judged["chamfer"]
    return line, certificate_differences(facts["certificate"], judged) + model_differences(model, judged)


def reason_to_skip(data, judge):
    for path in (data, judge):
        if not os.path.exists(path):
            return "the shared data are not there: " + path
    for module in ("numpy", "scipy"):
        if not importlib.util.find_spec(module):
            return "the judge needs %s, which %s does not have" % (module, sys.executable)
    return None


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    table, data, judge, method = (sys.argv[1:] + ["power-crust"])[:4]
    reason = reason_to_skip(data, judge)
    if reason:
        print("skipped: data.surface: " + reason)
        return SKIPPED
    models, wrong = read_models(table), 0
    if not os.environ.get("BRIO_LONG"):
        large = [m for m in models if os.path.getsize(os.path.join(data, m["file"])) > LARGE]
        models = [m for m in models if m not in large]
        print("left out, for make check-all: " + " ".join(m["file"] for m in large))
        for m in models:
            if m["chamfer"] != "-" and float(m["chamfer"]) > FAR:
                m["truth"] = m["chamfer"] = "-"
    with concurrent.futures.ThreadPoolExecutor(PROCESSES) as pool:
        for line, differences in pool.map(lambda model: examine(model, data, judge, method), models):
            wrong += bool(differences)
            print("\n    ".join([line, *differences]), flush=True)
    print("%d models, %d wrong" % (len(models), wrong))
    return 1 if wrong or not models else 0


if __name__ == "__main__":
    sys.exit(main())
