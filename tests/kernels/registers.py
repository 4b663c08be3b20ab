#!/usr/bin/env python3
"""Measures registers and instructions of the kernels on an AMD GPU with RADV's compiler, which needs no such
GPU.

    registers.py [--write | --print] [--family NAME] [--limits WORDS] REGISTERS TABLE

REGISTERS is the program of registers.c, TABLE the file that it is compared with: a kernel that takes a
tenth more registers or instructions, that spills, or that has become smaller than the table by a
quarter fails. --write writes the table anew, --print only prints; --family takes another GPU than the
table's and --limits sets LAMPYRIS_LIMITS, and both only print.

Exit status: 0 passed, 1 failed, 77 skipped (without RADV, or with another Mesa than the table's).
"""
import argparse
import glob
import os
import subprocess
import sys

# The scenes together use every kernel, and traversal with each kind of leaf. Each line says what its scene
# adds:
SCENES = [
    'scenes/cornell.json',                       # a little of everything
    'scenes/cornell.json,stack_entries=41',      # a stack as for a million triangles
    'scenes/cornell.json,settings.integrator=ao',
    'scenes/whitted.json',
    'scenes/materials_frosted.json',             # rough glass: the longest kernel
    'scenes/teapot_stadium.json',                # instances, textures
    'scenes/mandelbulb.json',                    # distance fields, suspended traversals
]
COLUMNS = {'VGPRs': 'VGPRs', 'Instructions': 'instructions', 'Subgroups per SIMD': 'subgroups',
           'LDS size': 'shared', 'Scratch size': 'scratch', 'Spilled VGPRs': 'spilled VGPRs',
           'Spilled SGPRs': 'spilled SGPRs'}
MARGIN = 1.1
STALE = 0.75
FAMILY = 'navi21'  # RDNA2
SKIPPED = 77


def radv():
    """Returns the path of the driver's manifest, or None."""
    found = glob.glob('/usr/share/vulkan/icd.d/radeon_icd*.json') + \
        glob.glob('/usr/local/share/vulkan/icd.d/radeon_icd*.json')
    return found[0] if found else None


def skip(reason):
    """Ends the test as skipped, or as failed if skipping is not allowed."""
    print('skipped: ' + reason)
    sys.exit(1 if os.environ.get('LAMPYRIS_NO_SKIP') else SKIPPED)


def measure(program, family, limits):
    """Returns the device with its driver, and {(scene, kernel): figures in the order of COLUMNS}."""
    driver = radv()
    if not driver:
        skip("RADV's radeon_icd.*.json is not there (Debian: mesa-vulkan-drivers)")
    # The cache is disabled, because it may contain code of an older compiler.
    environment = dict(os.environ, RADV_FORCE_FAMILY=family, VK_ICD_FILENAMES=driver,
                       VK_DRIVER_FILES=driver, MESA_SHADER_CACHE_DISABLE='true', LAMPYRIS_LIMITS=limits)
    done = subprocess.run([program] + SCENES, env=environment, stdout=subprocess.PIPE, text=True)
    if done.returncode == SKIPPED:
        skip('no Vulkan')
    if done.returncode != 0:
        sys.exit('%s: exit status %d' % (program, done.returncode))
    device, *rows = done.stdout.splitlines()
    found = {}
    for row in rows:
        scene, kernel, *figures = row.split('\t')
        figures = dict(figure.rsplit('=', 1) for figure in figures)
        found[scene, kernel] = [int(figures[name]) for name in COLUMNS]
    return device.replace('\t', ', '), found


def as_text(device, rows):
    """Returns the text of the table's file."""
    words = [[scene, kernel] + [str(figure) for figure in figures]
             for (scene, kernel), figures in rows.items()]
    head = ['scene', 'kernel'] + [name.replace(' ', '_') for name in COLUMNS.values()]
    widths = [max(len(row[i]) for row in [head] + words) for i in range(len(head))]
    lines = ['  '.join(word.ljust(width) if i < 2 else word.rjust(width)
                       for i, (word, width) in enumerate(zip(row, widths)))
             for row in [head] + words]
    return '# %s\n' % device + '\n'.join(lines) + '\n'


def from_text(text):
    """The inverse of as_text()."""
    device, _, *lines = text.splitlines()
    rows = {}
    for line in lines:
        scene, kernel, *figures = line.split()
        rows[scene, kernel] = [int(figure) for figure in figures]
    return device[2:], rows


def complaints(rows, expected):
    """Returns the kernels that are worse than in the table."""
    for scene, kernel in sorted(set(rows) ^ set(expected)):
        yield '%s: %s: %s the table' % (scene, kernel, 'not in' if (scene, kernel) in rows else 'only in')
    for key in (key for key in rows if key in expected):
        now, then = (dict(zip(COLUMNS, table[key])) for table in (rows, expected))
        for name in ('VGPRs', 'Instructions'):
            if not STALE * then[name] <= now[name] <= MARGIN * then[name]:
                yield '%s: %s: %d %s, expected about %d' % (*key, now[name], name, then[name])
        for name in ('Spilled VGPRs', 'Spilled SGPRs', 'Scratch size', 'LDS size'):
            if now[name] > then[name]:
                yield '%s: %s: %s of %d, expected at most %d' % (*key, name, now[name], then[name])
        if now['Spilled VGPRs'] or now['Spilled SGPRs']:
            yield '%s: %s: registers are spilled, expected none' % key


def main():
    """Measures the kernels, and prints, writes or compares the table."""
    arguments = argparse.ArgumentParser()
    arguments.add_argument('--write', action='store_true')
    arguments.add_argument('--print', action='store_true')
    arguments.add_argument('--family', default=FAMILY)
    arguments.add_argument('--limits', default='')
    arguments.add_argument('program')
    arguments.add_argument('table')
    options = arguments.parse_args()
    is_other = options.family != FAMILY or options.limits
    device, rows = measure(os.path.abspath(options.program), options.family, options.limits)
    print(as_text(device, rows), end='')
    if options.write and not is_other:
        with open(options.table, 'w', encoding='utf-8') as file:
            file.write(as_text(device, rows))
    if options.write or options.print or is_other:
        return
    with open(options.table, encoding='utf-8') as file:
        expected_device, expected = from_text(file.read())
    if device != expected_device:
        skip('the table is of %s' % expected_device)
    found = list(complaints(rows, expected))
    print('\n'.join(found))
    if found:
        sys.exit("failed; where that is meant, write the table anew: registers.py --write")


if __name__ == '__main__':
    main()
