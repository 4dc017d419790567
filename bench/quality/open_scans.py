"""Surfaces of partial scans, judged against what their cameras saw: the part `scans` of quality.py.

The judge is a program beside the project, tools/scans.py. It makes scans of the models, gives each to a program, and measures the surface:
invented, missing, turned and inward area. It keeps its scans, so that all programs get the same ones. Rows are those of one
program, one kind of evidence, one scan and one model.

Evidence is spoiled between the judge and brio by spoiled_evidence.py. Rivals are programs of their own: those of bench/peers,
which CMake builds, and open3d_surface.py, which runs in an environment that has Open3D."""
import csv
import datetime
import json
import os
import subprocess
import sys
import tempfile

from corpus_tables import by, mean, right_of, table
from spoiled_evidence import KINDS

HERE = os.path.dirname(os.path.abspath(__file__))
SHARED = os.environ.get('BRIO_SHARED', os.path.join(HERE, '..', '..', '..', 'shared'))
JUDGE = os.path.join(SHARED, 'tools', 'scans.py')
SCANS = ['front', 'three', 'ground', 'far', 'noisy', 'stray']
COLUMNS = ['program', 'evidence', 'scan', 'model', 'points', 'invented', 'missing', 'turned', 'inward', 'right', 'agreement',
           'seconds', 'version', 'date']
KEY = COLUMNS[:4]
GIVEN = 'normals,origins'

# How often every model is taken: the others are those that constants were chosen on.
EVERY = 4

# The evidence that most programs get, and the scans that evidence is spoiled of.
DEFAULT_EVIDENCE = {'brio': 'none', 'brio, scanners known': 'origins', 'brio, co-cone': 'none', 'CGAL, advancing front': 'none',
                    'Open3D, Poisson, 5 % cut': 'normals', 'Open3D, Poisson, 20 % cut': 'normals', 'Open3D, ball pivoting': 'normals'}
SPOILED_SCANS = ['front', 'noisy']
RIVALS = [name for name in DEFAULT_EVIDENCE if not name.startswith('brio')]


def reason_to_skip():
    return None if os.path.exists(JUDGE) else 'there is no ' + JUDGE


# --- programs ---

def spoiled(brio, evidence, report):
    return [sys.executable, os.path.join(HERE, 'spoiled_evidence.py'), brio, evidence.replace(' ', '_'), report, 'IN', 'OUT']


def output_of(command):
    try:
        return subprocess.run(command, capture_output=True, text=True).stdout.strip()
    except OSError:
        return ''


def rival_command(name, options):
    """The command of a rival and its version, or None where it is not installed."""
    if name.startswith('CGAL'):
        command = [os.path.join(options.peers, 'cgal_advancing_front')]
        version = output_of([*command, '--version'])
        return ([*command, 'IN', 'OUT'], version) if version else None
    way = 'pivoting' if 'pivoting' in name else 'poisson-5' if ' 5 ' in name else 'poisson-20'
    version = output_of([options.open3d, '-c', 'import open3d; print("Open3D", open3d.__version__)'])
    script = os.path.join(HERE, 'open3d_surface.py')
    return ([options.open3d, script, way, 'IN', 'OUT'], version) if version else None


def command_of(name, evidence, report, options):
    """The command, its version, and what the judge has to give; None where the program is missing."""
    if name in RIVALS:
        found = rival_command(name, options)
        return (*found, evidence) if found else None
    version = 'brio ' + output_of([options.brio, '--version']).split()[-1]
    if name == 'brio, co-cone':
        return [options.brio, 'surface', 'IN', '-o', 'OUT', '--method', 'cocone', '--quiet'], version, ''
    return spoiled(options.brio, evidence, report), version, '' if evidence == 'none' else GIVEN


# --- runs ---

def reports_of(path):
    """What brio told of each file."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding='utf-8') as f:
        return {row['file']: row for row in map(json.loads, f)}


def judge(name, evidence, scans, options):
    """The rows of a program with one kind of evidence."""
    with tempfile.TemporaryDirectory(prefix='brio-scans-') as folder:
        report, figures = os.path.join(folder, 'report'), os.path.join(folder, 'figures.tsv')
        found = command_of(name, evidence, report, options)
        if not found:
            return None
        command, version, give = found
        run = ['/usr/bin/python3', JUDGE, '--command', ' '.join(command), '--scans', ','.join(scans), '--every', str(options.every),
               '--tsv', figures, '--give', give, '--only', ','.join(options.only or [])]
        subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
        told = reports_of(report)
        with open(figures, newline='', encoding='utf-8') as f:
            rows = list(csv.DictReader((line for line in f if not line.startswith('#')), delimiter='\t'))
    for row in rows:
        agreement = told.get('%s-%s-points.ply' % (row['model'], row['scan']), {}).get('agreement')
        row.update(program=name, evidence=evidence, version=version, date=datetime.date.today().isoformat(),
                   agreement='-' if agreement is None else '%.3f' % agreement)
    return [{column: row[column] for column in COLUMNS} for row in rows]


def tasks_of(options):
    """Programs with one kind of evidence, and the scans that they get."""
    for name, evidence in DEFAULT_EVIDENCE.items():
        if (options.methods and name in options.methods) or (not options.methods and (options.rivals or name not in RIVALS)):
            yield name, evidence, options.scans or SCANS
    for evidence in KINDS if not options.methods or 'evidence' in options.methods else []:
        if not options.evidence or evidence in options.evidence:
            yield 'brio, evidence', evidence, options.scans or SPOILED_SCANS


def run_all(options):
    """Yields the rows of each program; names those that are missing."""
    for name, evidence, scans in tasks_of(options):
        rows = judge(name, evidence, scans, options)
        if rows is None:
            print('skipped: %s: not installed' % name, flush=True)
            continue
        print('%s, %s: right %d of %d' % (name, evidence, right_of(rows), len(rows)), file=sys.stderr, flush=True)
        yield rows


# --- the tables of docs/measured/quality.md ---

def means(rows, columns):
    return [mean([float(row[column]) for row in rows], '%.1f') for column in columns]


def program_table(rows):
    lines = []
    for scan, of_scan in by(rows, 'scan', SCANS):
        for name, of_name in by(of_scan, 'program', DEFAULT_EVIDENCE):
            lines.append([scan, name, '%d of %d' % (right_of(of_name), len(of_name)),
                          *means(of_name, ['invented', 'missing', 'turned', 'inward'])])
    return table(['scan', 'program', 'right', 'invented', 'missing', 'turned', 'inward'], lines)


def evidence_table(rows):
    lines = []
    for kind, of_kind in by(rows, 'evidence', KINDS):
        told = [float(row['agreement']) for row in of_kind if row['agreement'] != '-']
        line = [kind]
        for _, of_scan in by(of_kind, 'scan', SPOILED_SCANS):
            line += ['%d of %d' % (right_of(of_scan), len(of_scan)), *means(of_scan, ['missing', 'turned', 'inward'])]
        lines.append([*line, mean([100 * share for share in told], '%.0f') if told else 'not used'])
    head = ['%s: %s' % (scan, what) for scan in SPOILED_SCANS for what in ('right', 'missing', 'turned', 'inward')]
    return table(['evidence', *head, 'agreement'], lines)


def section(rows):
    """The lines of the page; none where nothing was measured."""
    programs = [row for row in rows if row['program'] in DEFAULT_EVIDENCE]
    spoiled_rows = [row for row in rows if row['program'] == 'brio, evidence']
    versions = sorted({'%s (%s)' % (row['version'], row['date']) for row in rows})
    if not rows:
        return ''
    return '\n'.join(['## Open scans', '', INTRO % '; '.join(versions), '', *program_table(programs), '',
                      *([EVIDENCE, '', *evidence_table(spoiled_rows), ''] if spoiled_rows else []), ''])


INTRO = '''Closed models beside the project, each scanned by simulated depth cameras: a part of it, with the visible part as truth. *Invented* is
area farther than 4 pixels from all that was seen, *missing* is seen area farther than 2 pixels from the surface, *turned* is
area that faces away from the cameras, each component turned as suits it best, *inward* the same as it is: mean per cent. Right: at
most 3, 3 and 1 %%, manifold and oriented. Seconds, in the CSV file, are those of a clock on a shared machine. brio and CGAL get points alone, "scanners known" gets places of the cameras, Open3D gets normals that look to the camera, estimated from 16 points.
Measured with %s.'''

EVIDENCE = '''What a file knows of the side, and how wrong it may be: normals by angles and flips, places of scanners off by a part of the size or
behind the points that they see. The agreement is what the report says, in per cent.'''
