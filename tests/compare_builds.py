#!/usr/bin/env python3
"""Compares two builds of lampyris: whether their images have the same bits, and which build is faster.

    tests/compare_builds.py BEFORE AFTER [--speed ROUNDS] [--scenes FOLDER]

BEFORE and AFTER are programs. Each renders the small images listed below, over scenes, settings and
the fallbacks of devices, and the hashes of the images are compared. --speed then renders
scenes/cornell.json ROUNDS times by each in turn, and prints the ratio of their sample rates with a
95 % interval: the median of the pairs' ratios, and the order statistics of the sign test around it.
Nothing else should run at the same time.

Exits with 1 where bits differ or a render fails.
"""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

# Scenes that are rendered with their own settings.
SCENES = ['absorption', 'all_classes', 'classical', 'cornell', 'forest', 'furnace_sky', 'glass',
          'glow_worms', 'mandelbulb', 'many_lights', 'materials_clearcoat', 'materials_roughness',
          'phong_lobes', 'profiles', 'sdf_csg', 'shapes', 'sky', 'spheres',
          'teapot_room', 'teapot_stadium', 'veach_mis', 'whitted']

# Scenes with options.
SETTINGS = [
    'cornell --sampler stratified --spp 9', 'cornell --sampler grid --spp 9',
    'cornell --sampler blue-noise', 'cornell --sampler lcg', 'cornell --halves contiguous',
    'cornell --adaptive on --spp 48', 'cornell --roulette frame', 'cornell --frames 5',
    'cornell --error 0.05', 'cornell --nee off', 'cornell --nee-depth 1',
    'veach_mis --mis none', 'glass --max-bounces 3', 'many_lights --light-choice power',
    'teapot_room --bvh median', 'cornell --integrator ao', 'cornell --roulette constant',
    'cornell --filter gaussian', 'cornell --clamp 0.5', 'veach_mis --mis balance',
    'phong_lobes --directions hemisphere', 'many_lights --light-choice tree',
    'cornell --light-choice all', 'sky --env-filter nearest', 'teapots --instances on',
    'teapots --instances off',
]

# Scenes with fallbacks of the device, as LAMPYRIS_LIMITS names them.
FALLBACKS = ['teapot_room no-texel', 'cornell no-ballot', 'all_classes no-texel,no-ballot']


def render(program, scene, options, folder, limits=None, size='48x32'):
    environment = dict(os.environ, LAMPYRIS_LIMITS=limits) if limits else None
    spp = [] if {'--spp', '--frames', '--error'} & set(options) else ['--spp', '4']
    result = subprocess.run([program, 'render', '-q', '--json', scene, '--size', size, *spp,
                             *options, '-o', os.path.join(folder, 'image.exr')],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            env=environment, check=False)
    if result.returncode != 0:
        return {'image_hash': 'exit code %d: %s' % (result.returncode, result.stderr.strip())}
    return json.loads(result.stdout)


def cases():
    for name in SCENES:
        yield name, name, [], None
    for line in SETTINGS:
        name, *options = line.split()
        yield line, name, options, None
    for line in FALLBACKS:
        name, limits = line.split()
        yield '%s, %s' % (name, limits), name, [], limits


def compare_bits(programs, scenes, folder):
    """Returns the number of images that differ or fail."""
    differing, count = 0, 0
    for label, name, options, limits in cases():
        scene = os.path.join(scenes, name + '.json')
        hashes = [render(program, scene, options, folder, limits)['image_hash']
                  for program in programs]
        same = hashes[0] == hashes[1] and 'exit code' not in hashes[0]
        print('%-9s %s  %s' % ('equal' if same else 'DIFFERENT', label,
                               hashes[0] if same else ' | '.join(hashes)), flush=True)
        differing += not same
        count += 1
    print('%d of %d images have equal bits' % (count - differing, count))
    return differing


def sign_interval(ratios):
    """Returns the order statistics that enclose the median with at least 95 %, or the extremes if there are
    too few values."""
    ratios = sorted(ratios)
    count = len(ratios)
    tail, least = 0.0, 0
    for i in range(count):
        tail += math.comb(count, i) / 2.0 ** count
        if tail > 0.025:
            break
        least = i + 1
    least = max(least - 1, 0)
    return ratios[least], ratios[count - 1 - least]


def compare_speed(programs, scenes, folder, rounds):
    scene = os.path.join(scenes, 'cornell.json')
    ratios = []
    for i in range(rounds):
        rates = {}
        for program in programs if i % 2 == 0 else reversed(programs):
            result = render(program, scene, ['--spp', '64'], folder, size='256x256')
            rates[program] = result['spp'] * 256 * 256 / result['seconds']['render']
        ratios.append(rates[programs[1]] / rates[programs[0]])
        print('%d of %d: %.3f and %.3f Msamples/s' % (i + 1, rounds, rates[programs[0]] / 1e6,
                                                      rates[programs[1]] / 1e6), flush=True)
    low, high = sign_interval(ratios)
    print('samples/s, after / before: %.3f, 95 %% interval %.3f to %.3f'
          % (statistics.median(ratios), low, high))


def main():
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    parser = argparse.ArgumentParser(description=__doc__.split('\n', maxsplit=1)[0])
    parser.add_argument('before')
    parser.add_argument('after')
    parser.add_argument('--speed', type=int, default=0, metavar='ROUNDS')
    parser.add_argument('--scenes', default=os.path.join(root, 'scenes'), metavar='FOLDER')
    options = parser.parse_args()
    programs = [options.before, options.after]
    with tempfile.TemporaryDirectory() as folder:
        differing = compare_bits(programs, options.scenes, folder)
        if options.speed:
            compare_speed(programs, options.scenes, folder, options.speed)
    sys.exit(1 if differing else 0)


if __name__ == '__main__':
    main()
