#!/usr/bin/env python3
"""Tests which integrator --integrator auto chooses, and that the picture is that of this integrator.

Usage: test_auto.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import subprocess
import sys
import unittest

import program

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
CORNELL = os.path.join(ROOT, 'scenes', 'cornell.json')
CAUSTIC = os.path.join(ROOT, 'tests', 'render', 'scenes', 'caustic.json')
POINT = {'type': 'point', 'position': [1, 4, 0], 'intensity': [5] * 3}
LAMP = {'type': 'sphere', 'material': 'lamp', 'center': [1, 4, 0], 'radius': 1}
LIGHT_KERNELS = {'generate_light_rays', 'shade_light', 'intersect_camera', 'add_splats'}
# A render to an error limit is worth a pilot, and this one ends at its first test.
WORTH_A_PILOT = ('--error', '10')


class Auto(program.FolderCase):
    def ball(self, material, *shapes, lights=()):
        """Writes a scene of a floor and a ball, and returns its path."""
        with open(self.path('ball.json'), 'w', encoding='utf-8') as file:
            json.dump({
                'lampyris': 1, 'camera': {'position': [0, 3, 6], 'target': [0, 0, 0], 'fov_degrees': 40},
                'materials': {'grey': {'base_color': [0.5] * 3}, 'ball': material,
                              'lamp': {'emission': [5] * 3}},
                'lights': list(lights),
                'shapes': [
                    {'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0], 'v': [0, 0, -6]},
                    {'type': 'sphere', 'material': 'ball', 'center': [0, 1, 0], 'radius': 0.8}, *shapes]}, file)
        return self.path('ball.json')

    def run_program(self, *arguments):
        result = subprocess.run([LAMPYRIS, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                cwd=self.folder, timeout=300)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def render(self, scene, *arguments, integrator='auto', spp=('--spp', '4'), size='16x12'):
        return json.loads(self.run_program('render', scene, '--size', size, *spp, '--integrator', integrator,
                                           *arguments, '-o', 'out.exr', '--json', '-q'))

    def check_same(self, chosen, scene, *arguments, **options):
        """Checks that the picture is that of the chosen integrator."""
        named = self.render(scene, *arguments, integrator=chosen['integrator']['name'], **options)
        self.assertEqual(chosen['image_hash'], named['image_hash'])
        self.assertEqual(named['integrator'], {'name': chosen['integrator']['name'], 'auto': False, 'reason': None,
                                               'pilot': None})
        return named

    def test_nothing_focuses_light(self):
        chosen = self.render(CORNELL, '--explain', *WORTH_A_PILOT, spp=())
        self.assertEqual(chosen['integrator'], {
            'name': 'path', 'auto': True, 'reason': 'no surface is smooth enough to focus light', 'pilot': None})
        left_out = {part['name']: part['saved']['why'] for part in chosen['features']['left_out']}
        for kernel in LIGHT_KERNELS:
            self.assertEqual(left_out[kernel], '--integrator auto has chosen path: no surface is smooth enough to '
                                               'focus light')
        named = self.check_same(chosen, CORNELL, *WORTH_A_PILOT, spp=())
        self.assertEqual(chosen['rays'], named['rays'])

    def test_what_only_light_paths_find(self):
        scene = self.ball({'type': 'dielectric'}, lights=[POINT])
        chosen = self.render(scene)
        self.assertEqual(chosen['integrator']['name'], 'bidir')
        self.assertRegex(chosen['integrator']['reason'], r'path cannot find the caustics of the delta lights \(1\)')
        self.assertEqual(chosen['bias'], [])
        self.check_same(chosen, scene)
        refused = self.render(scene, '--clamp', '9')
        self.assertEqual(refused['integrator']['name'], 'path')
        self.assertIn('cannot have --clamp', refused['integrator']['reason'])
        self.assertIn('integrator', [bias['kind'] for bias in refused['bias']])
        text = self.run_program('render', scene, '--size', '8x8', '--spp', '1', '--integrator', 'auto', '-o', 'out.exr')
        self.assertRegex(text, r'(?m)^auto      bidir: path cannot find')

    def test_pilot(self):
        for scene, name in ((CAUSTIC, 'bidir'), (self.ball({'type': 'conductor', 'roughness': 0.29}, LAMP), 'path')):
            chosen = self.render(scene, *WORTH_A_PILOT, spp=())
            pilot = chosen['integrator']['pilot']
            self.assertEqual(chosen['integrator']['name'], name, chosen['integrator'])
            self.assertEqual((pilot['width'], pilot['height'], pilot['spp']), (16, 12, 682))
            self.assertGreater(pilot['bidir']['rays'], pilot['path']['rays'])
            cost = {name: trial['local_relmse'] * trial['rays']
                    for name, trial in pilot.items() if isinstance(trial, dict)}
            self.assertEqual(cost['bidir'] < cost['path'], name == 'bidir')
            self.check_same(chosen, scene, *WORTH_A_PILOT, spp=())
            again = self.render(scene, '--wave', '256', *WORTH_A_PILOT, spp=())['integrator']
            for trial in ('path', 'bidir'):
                self.assertEqual(again['pilot'][trial], pilot[trial])
            self.assertEqual(again['reason'], chosen['integrator']['reason'])

    def test_short_renders_have_no_pilot(self):
        chosen = self.render(CAUSTIC)
        self.assertEqual(chosen['integrator'], {
            'name': 'path', 'auto': True, 'reason': 'the render is too short for a pilot of bidir', 'pilot': None})
        # More samples would be worth one, but a film has the samples of one integrator.
        self.render(CAUSTIC, '--checkpoint', 'film')
        resumed = self.render(CAUSTIC, '--checkpoint', 'film', '--resume', *WORTH_A_PILOT, spp=())
        self.assertEqual(resumed['integrator'], {
            'name': 'path', 'auto': True, 'reason': 'an earlier run has chosen it', 'pilot': None})

    def test_parts_have_the_same_integrator(self):
        scene = self.ball({'type': 'dielectric'}, lights=[POINT])
        for part in '12':
            self.render(scene, '--shard', part + '/2', '--checkpoint', 'part' + part)
        self.run_program('merge', 'part1', 'part2', '-o', 'merged.exr')
        whole = self.render(scene, integrator='bidir')
        compared = json.loads(self.run_program('compare', 'merged.exr', 'out.exr', '--json'))
        self.assertEqual(compared['differing'], 0, (compared, whole['image_hash']))

    def test_sequences_keep_path(self):
        scene = self.ball({'type': 'dielectric'}, lights=[POINT])
        lines = self.run_program('render', scene, '--size', '8x8', '--spp', '1', '--integrator', 'auto', '--turntable',
                                 '2', '-o', 'out.exr', '--json', '-q').splitlines()
        frames = [json.loads(line)['integrator'] for line in lines if 'image_hash' in line]
        self.assertEqual([(frame['name'], frame['auto']) for frame in frames], 2 * [('path', True)])


if __name__ == '__main__':
    unittest.main()
