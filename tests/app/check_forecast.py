#!/usr/bin/env python3
"""Tests the forecast of the error: renders with many seeds are continued from a checkpoint to twice their
samples, and the forecast's interval must contain the error then measured against a reference.

    check_forecast.py LAMPYRIS SCENE... [--seeds 20] [--samplers sobol,pcg] [--spp 128]
                      [--reference-factor 50] [--references FOLDER]

Prints for each scene and sampler in how many runs it held, how wide it was, and the ratio of the
truth to the forecast; with slopes from a trace, and by 1 / samples alone. Fails where intervals hold
in fewer than 85 % of all runs: with 95 % each, that happens to one in 20,000 sets of 120 runs.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

SIZE = '48x48'


def render(lampyris, *arguments):
    result = subprocess.run([lampyris, 'render', *arguments, '--size', SIZE, '--json', '-q'],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if result.returncode != 0:
        sys.exit(result.stderr)
    return json.loads(result.stdout)


def run_one(lampyris, folder, scene, sampler, seed, spp, reference):
    """Returns the forecast, the error from which it was made, and the error after twice the samples."""
    checkpoint, trace = os.path.join(folder, 'c'), os.path.join(folder, 't.csv')
    arguments = [scene, '--sampler', sampler, '--seed', str(seed), '--checkpoint', checkpoint, '-o',
                 os.path.join(folder, 'o.exr')]
    now = render(lampyris, *arguments, '--spp', str(spp), '--trace', trace)
    then = render(lampyris, *arguments, '--spp', str(2 * spp), '--resume', '--reference', reference)
    os.unlink(checkpoint)
    return now['forecast'], now['error'], then['reference']['local_relmse']


def report(name, runs):
    known = [(f, t) for f, t in runs if f[0] is not None]
    held = sum(f[1] <= t <= f[2] for f, t in known)
    below = sum(t <= f[2] for f, t in known)
    if not known:
        print(f'{name:40} not known')
        return 0, 0
    logs = [math.log(t / f[0]) for f, t in known]
    width = sum(math.log(f[2] / f[1]) for f, _ in known) / len(known)
    print(f'{name:40} held {held}/{len(known)} (not above {below}), null {len(runs) - len(known)}, '
          f'truth/forecast {math.exp(sum(logs) / len(logs)):.2f}, '
          f'interval +-{100 * (math.exp(width / 2) - 1):.0f} %', flush=True)
    return held, len(known)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('lampyris')
    parser.add_argument('scenes', nargs='+')
    parser.add_argument('--seeds', type=int, default=20)
    parser.add_argument('--samplers', default='sobol,pcg')
    parser.add_argument('--spp', type=int, default=128)
    parser.add_argument('--reference-factor', type=int, default=50)
    parser.add_argument('--references')
    options = parser.parse_args()
    held, count = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes:
            name = os.path.splitext(os.path.basename(scene))[0]
            reference = os.path.join(options.references or folder, f'ref-{name}.exr')
            if not os.path.exists(reference):
                render(options.lampyris, scene, '--seed', '987654', '--aov', 'halves', '--spp',
                       str(2 * options.spp * options.reference_factor), '-o', reference)
            for sampler in options.samplers.split(','):
                told, plain = [], []
                for seed in range(1, options.seeds + 1):
                    forecast, error, truth = run_one(options.lampyris, folder, scene, sampler, seed,
                                                     options.spp, reference)
                    keys = ('local_relmse', 'ci_low', 'ci_high')
                    told.append(([forecast[key] for key in keys], truth))
                    plain.append(([error[key] and 0.5 * error[key] for key in keys], truth))
                a, b = report(f'{name} {sampler}', told)
                report(f'{name} {sampler}, by 1 / samples', plain)
                held, count = held + a, count + b
    print(f'in all: {held} of {count}')
    return 0 if count and held >= 0.85 * count else 1


if __name__ == '__main__':
    sys.exit(main())
