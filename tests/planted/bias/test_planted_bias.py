"""Tests that lampyris converge finds a biased estimator: a program whose densities of light sampling are 1.02
times the correct ones is compared with the correct program, against a correct reference.

    test_planted_bias.py LAMPYRIS LAMPYRIS_BIASED
"""

import json
import os
import sys
import tempfile
import unittest

from program import checked, run

HONEST, BIASED = sys.argv[1:3]
del sys.argv[1:3]
SCENES = os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'scenes')

# A floor that fills the picture and is much brighter than relMSE's epsilon, and a lamp above the camera.
FLOOR = {
    'lampyris': 1,
    'camera': {'position': [0, 2, 1], 'target': [0, 0, 0], 'fov_degrees': 40},
    'film': {'width': 16, 'height': 16},
    'settings': {'max_bounces': 1},
    'materials': {'grey': {'base_color': [0.6, 0.5, 0.4]},
                  'lamp': {'base_color': [0, 0, 0], 'emission': [600, 500, 400]}},
    'shapes': [
        {'type': 'quad', 'material': 'grey', 'corner': [-9, 0, 9], 'u': [18, 0, 0], 'v': [0, 0, -18]},
        {'type': 'quad', 'material': 'lamp', 'corner': [-1, 3, -1], 'u': [2, 0, 0], 'v': [0, 0, 2]},
    ],
}
# All light comes from connections, each divided by a density that is too large: x = r / 1.02.
BIAS = (1 - 1 / 1.02) ** 2


class Planted(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.floor = os.path.join(cls.folder.name, 'floor.json')
        with open(cls.floor, 'w', encoding='utf-8') as file:
            json.dump(FLOOR, file)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def reference(self, scene, spp, *arguments):
        path = os.path.join(self.folder.name, f'reference-{len(os.listdir(self.folder.name))}.exr')
        checked(HONEST, 'render', scene, '--spp', str(spp), '--seed', '77', '--aov', 'halves', '-o', path,
            '-q', *arguments)
        return path

    def curve(self, program, scene, reference, *arguments):
        result = json.loads(checked(program, 'converge', scene, '--reference', reference, '--json', '-q',
                                '--sampler', 'pcg', *arguments))
        return result['curves'][0]

    # The interval excludes the truth in at most 5 % of cases, and lies above it in 2.5 %. The seeds are
    # fixed.
    def check(self, scene, reference, *arguments):
        honest = self.curve(HONEST, scene, reference, *arguments)
        biased = self.curve(BIASED, scene, reference, *arguments)
        self.assertIs(honest['biased'], False, honest['bias'])
        self.assertIs(biased['biased'], True, biased['bias'])
        self.assertLess(honest['slope']['ci_low'], -0.97)
        self.assertGreater(biased['slope']['value'], honest['slope']['value'] + 0.05)
        return biased

    def test_as_much_as_was_planted(self):
        reference = self.reference(self.floor, 20000)
        points = ('--spp-from', '16', '--spp', '512', '--replicates', '8')
        biased = self.check(self.floor, reference, '--mis', 'none', *points)
        self.assertLess(biased['bias']['ci_low'], BIAS)
        self.assertGreater(biased['bias']['ci_high'], BIAS)
        self.assertLess(biased['bias']['ci_high'] - biased['bias']['ci_low'], 0.2 * BIAS)
        # The remaining error exceeds this target, so no rendering time reaches it.
        self.assertIsNone(biased['time_to'][2]['seconds']['value'])
        # With the heuristic, light that both techniques find is divided between them, so less of it is wrong.
        self.check(self.floor, reference, *points)

    # The kernels differ, although the rest of the build is the same.
    def test_it_does_not_go_on_with_an_honest_render(self):
        checkpoint = os.path.join(self.folder.name, 'a.checkpoint')
        output = os.path.join(self.folder.name, 'a.exr')
        checked(HONEST, 'render', self.floor, '--spp', '4', '--checkpoint', checkpoint, '-o', output, '-q')
        arguments = ('render', self.floor, '--spp', '8', '--checkpoint', checkpoint, '--resume', '-o', output, '-q')
        refused = run(BIASED, *arguments)
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, 'was made with kernels=[0-9a-f]{16}, but this run has')
        checked(HONEST, *arguments)

    def test_in_a_scene_of_many_bounces(self):
        scene = os.path.join(SCENES, 'cornell.json')
        size = ('--size', '24x24')
        reference = self.reference(scene, 30000, *size)
        self.check(scene, reference, '--spp-from', '16', '--spp', '2048', *size)


if __name__ == '__main__':
    unittest.main()
