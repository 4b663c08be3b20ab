#!/usr/bin/env python3
"""The metadata of an EXR file has every setting, and a render repeated from it has the same hash.

Usage: test_metadata.py LAMPYRIS LOAD_SCENE SCENE [unittest arguments]
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

LAMPYRIS, LOAD_SCENE, SCENE = (os.path.abspath(sys.argv.pop(1)) for _ in range(3))
TABLE = {row['key']: row for row in json.loads(
    subprocess.run([LOAD_SCENE, '--settings'], stdout=subprocess.PIPE, check=True).stdout)}
# Values that differ from every default. Several renders are necessary, because some settings exclude each
# other.
SOME = {'width': '18', 'height': '13', 'exposure': '-1.5', 'tone': 'agx', 'spp': '3', 'seed': '7'}
RENDERS = [
    {},
    {'roulette': 'frame', 'roulette_min_bounces': '0', 'roulette_max_bounces': '2', 'roulette_survival': '0.3',
     'max_bounces': '5', 'nee_depth': '1', 'light_choice': 'uniform', 'mis': 'balance', 'sampler': 'pcg',
     'film_accumulation': 'running', 'normals': 'ndf', 'pixel_sampling': 'stratified', 'pixel_strata': '2', 'split_lobes': '1'},
    {'directions': 'power-cosine', 'direction_exponent': '2.5', 'filter': 'gaussian', 'filter_radius': '2.25',
     'clamp': '0.1', 'sampler': 'stratified', 'halves': 'contiguous', 'roulette': 'constant', 'roulette_survival': '0.55',
     'roulette_min_bounces': '1', 'mis_exponent': '3', 'min_density': '0.01', 'radiance_scaling': 'off'},
    {'integrator': 'ao', 'ao_distance': '0.3', 'pixel_jitter': 'off', 'nee': 'off',
     'environment_filter': 'nearest', 'environment_sampling': 'luminance',
     'sampler': 'lcg'},
]


class Metadata(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def render(self, settings, more=()):
        """Renders with settings given as text. Returns the film's hash and the settings in the metadata."""
        path = os.path.join(self.folder.name, 'out.exr')
        command = [LAMPYRIS, 'render', SCENE, '--json', '-q', '-o', path, *more]
        for key, value in settings.items():
            if TABLE[key]['type'] == 'switch':
                value = {'on': 'true', 'off': 'false'}[value]
            command += ['-D', f'{TABLE[key]["section"]}.{key}={value}']
        result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=100)
        if result.returncode == 69:
            sys.exit(77)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(path, 'rb') as file:
            header = file.read(20000)
        told = {}
        for found in re.finditer(rb'lampyris:(\w+)\0string\0(....)', header, re.S):
            size = int.from_bytes(found[2], 'little')
            told[found[1].decode()] = header[found.end():found.end() + size].decode()
        return json.loads(result.stdout)['image_hash'], told

    def test_every_setting_is_there_and_repeats_the_render(self):
        hashes = set()
        for settings in RENDERS:
            settings = {**SOME, **settings}
            image_hash, told = self.render(settings)
            self.assertEqual({key for key in TABLE if key not in told}, set())
            for key, value in settings.items():
                self.assertEqual(told[key], value, key)
            again, _ = self.render({key: told[key] for key in TABLE})
            self.assertEqual(again, image_hash, settings)
            hashes.add(image_hash)
        self.assertEqual(len(hashes), len(RENDERS))
        self.assertEqual(set(TABLE) - set().union(SOME, *RENDERS), set())

    def test_plans_are_told(self):
        """Methods that use a planned number of samples store that number, or 0 if none was planned."""
        for sampler, more, planned in (('pcg', [], None), ('blue-noise', [], '3'),
                                       ('blue-noise', ['--time', '1000', '--spp', '3'], '0')):
            _, told = self.render({**SOME, 'sampler': sampler}, more)
            self.assertEqual(told.get('samples_planned'), planned, (sampler, more))


if __name__ == '__main__':
    unittest.main()
