#!/usr/bin/env python3
"""Tests the comparison with Cycles: its estimates, its files, and that both programs get the same scenes.

    test_peers.py LAMPYRIS [CLASS...]

Estimates and Files need neither program, Scenes needs a device. Materials and Means need Blender, too, and are skipped without:
it is no package that the tests ask for.
"""
import array
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import estimate  # noqa: E402
import exr  # noqa: E402
import geometry  # noqa: E402
import lampyris_scene  # noqa: E402
import renderers  # noqa: E402
import scenes  # noqa: E402
from program import need_device  # noqa: E402

LAMPYRIS = os.path.abspath(sys.argv.pop(1))


def noisy(truth, deviation, numbers, size=64):
    """Returns a picture with this mean, whose values have independent noise."""
    planes = [array.array('f', (numbers.gauss(truth, deviation) for _ in range(size * size))) for _ in range(3)]
    return size, size, planes


class Estimates(unittest.TestCase):
    def test_the_noise_of_references_is_not_counted(self):
        # relMSE of a picture is s^2 / (r^2 + .01). The variance of the references is four times as large.
        numbers = random.Random(3)
        references = [noisy(2, .1, numbers) for _ in range(2)]
        found = [estimate.error(noisy(2, .05, numbers), references) for _ in range(8)]
        self.assertAlmostEqual(sum(found) / 8, .0025 / 4.01, delta=.06 * .0025 / 4.01)

    def test_rare_bright_pixels_are_not_in_the_trimmed_error(self):
        numbers = random.Random(8)
        references = [noisy(2, .02, numbers) for _ in range(2)]
        picture = noisy(2, .05, numbers)
        plain = estimate.errors(picture, references)
        for i in numbers.sample(range(64 * 64), 20):  # of 4096 pixels
            picture[2][1][i] = 300
        whole, trimmed = estimate.errors(picture, references)
        self.assertAlmostEqual(whole / (20 / (3 * 4096) * 298**2 / 4.01), 1, delta=.01)
        self.assertAlmostEqual(trimmed / plain[1], 1, delta=.05)
        self.assertLess(plain[1], plain[0])

    def test_a_bias_between_renderers_is_found(self):
        numbers = random.Random(4)
        ours, theirs = ([noisy(mean, .1, numbers) for _ in range(2)] for mean in (2.2, 2))
        same = [noisy(2, .1, numbers) for _ in range(2)]
        self.assertAlmostEqual(estimate.difference(ours, theirs), .04 / 4.42, delta=.05 * .04 / 4.42)
        self.assertLess(abs(estimate.difference(same, theirs)), .03 * .04 / 4.42)
        value, low, high = estimate.ratio_of_means(ours, theirs)
        self.assertLess(abs(value - 1.1), high - low)  # 3.9 deviations
        self.assertLess(high - low, .005)

    def test_intervals_of_means_hold(self):
        numbers, held = random.Random(5), 0
        for _ in range(200):
            mean, error = estimate.mean([noisy(1, .5, numbers, 32) for _ in range(2)])
            held += abs(mean - 1) < 1.96 * error
        self.assertGreater(held, 175)  # 186 are expected: the interval is from 16 tiles, and uncertain itself
        self.assertLess(held, 198)

    def test_intervals_of_ratios_hold(self):
        # What the machine does in a turn affects both renderers, and cancels.
        numbers, held, widths = random.Random(6), 0, []
        for _ in range(400):
            load = [numbers.uniform(1, 3) for _ in range(6)]
            ours = [[numbers.gauss(2, .2) for _ in range(6)], [t * numbers.gauss(1, .03) for t in load]]
            theirs = [[numbers.gauss(1, .1) for _ in range(6)], [t * numbers.gauss(1, .03) for t in load]]
            _, low, high = estimate.ratio(ours, theirs).interval()
            held += low < 2 < high
            widths.append(math.log(high / low))
        self.assertGreater(held, 360)
        self.assertLess(held, 398)
        self.assertLess(sum(widths) / 400, .5)

    def test_geometric_means(self):
        found = estimate.geometric_mean([estimate.Logarithm(math.log(v), .1, 4) for v in (.5, 2, 1, 4)])
        value, low, high = found.interval()
        self.assertAlmostEqual(value, math.sqrt(2))
        self.assertAlmostEqual(math.log(high / value), estimate.t_975(16) * .05)  # .1 / sqrt(4)
        self.assertAlmostEqual(low * high, value * value)

    def test_what_is_not_known_is_not_told(self):
        self.assertEqual(estimate.ratio([[1]], [[2]]).interval()[1:], (None, None))
        lost = estimate.ratio([[.1, -.2]], [[1, 1]])
        self.assertEqual(lost.interval(), (None, None, None))
        self.assertEqual(estimate.geometric_mean([lost, lost]).interval(), (None, None, None))


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def test_pictures_come_back(self):
        numbers = random.Random(1)
        planes = [array.array('f', (numbers.random() for _ in range(5 * 3))) for _ in range(3)]
        exr.write(self.path('a.exr'), 5, 3, planes)
        self.assertEqual(exr.read(self.path('a.exr')), (5, 3, tuple(planes)))

    def test_meshes_are_closed_and_face_outwards(self):
        for name, mesh, volume in (('box', geometry.box((0, 0, 0), (1, 2, 3), 30), 6),
                                   ('icosphere', geometry.icosphere(4), 4 / 3 * math.pi),
                                   ('globe', geometry.globe(64, 65), 4 / 3 * math.pi),
                                   ('torus', geometry.displaced_torus(96, 64), None)):
            with self.subTest(name):
                vertices, triangles, normals = mesh
                edges = [edge for a, b, c in triangles for edge in ((a, b), (b, c), (c, a))]
                self.assertEqual(len(set(edges)), len(edges))
                self.assertEqual({(b, a) for a, b in edges}, set(edges))
                found = sum(self.determinant(*(vertices[i] for i in face)) for face in triangles) / 6
                self.assertGreater(found, 0)
                if volume:
                    self.assertAlmostEqual(found / volume, 1, delta=.01)
                if normals:
                    self.assertEqual(len(normals), len(vertices))

    @staticmethod
    def determinant(a, b, c):
        return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                a[2] * (b[0] * c[1] - b[1] * c[0]))

    def test_scenes_are_of_the_sizes_that_are_said(self):
        self.assertGreater(2 * 1040 * 640, 10**6)
        self.assertEqual(5 * len(geometry.globe(32, 17)[1]), 5120)
        description = scenes.describe('spheres')
        copies = [one for one in description['objects'] if one['mesh'] == 'pebble']
        self.assertEqual(len(copies), 10**4)
        self.assertEqual({description['materials'][one['material']]['kind'] for one in copies},
                         {'diffuse', 'plastic', 'metal'})


class Scenes(unittest.TestCase):
    """Lampyris accepts the files. The long class Means has the larger scenes, too."""

    names = ['box', 'plates']

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def test_they_render(self):
        lampyris = renderers.Lampyris('Lampyris', LAMPYRIS)
        for name in self.names:
            with self.subTest(name):
                description = scenes.describe(name)
                scenes.write_files(description, self.folder.name)
                lampyris.open(description, self.folder.name, 16)
                path = os.path.join(self.folder.name, 'picture.exr')
                lampyris.render(2, 1, path)
                width, height, planes = exr.read(path)
                self.assertEqual((width, height), (16, 16))
                self.assertGreater(min(sum(plane) for plane in planes), 0)

    def test_pictures_of_both_readers_are_one(self):
        # A picture that this EXR reader reads and writes keeps its bits in the program.
        description = scenes.describe('box')
        scenes.write_files(description, self.folder.name)
        lampyris = renderers.Lampyris('Lampyris', LAMPYRIS)
        lampyris.open(description, self.folder.name, 40)
        paths = [os.path.join(self.folder.name, name) for name in ('picture.exr', 'again.exr')]
        lampyris.render(4, 1, paths[0])
        exr.write(paths[1], *exr.read(paths[0]))
        result = subprocess.run([LAMPYRIS, 'compare', *paths, '--json'], stdout=subprocess.PIPE, text=True, check=True)
        self.assertTrue(json.loads(result.stdout)['equal'])


class Both(unittest.TestCase):
    """Tests that need both renderers."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def references(self, renderer, description, spp):
        scenes.write_files(description, self.folder.name)
        renderer.open(description, self.folder.name, 48)
        try:
            pictures = []
            for seed in (7, 8):
                path = os.path.join(self.folder.name, '%s.exr' % renderer.family)
                renderer.render(spp, seed, path)
                pictures.append(exr.read(path))
            return pictures
        finally:
            renderer.close()

    def ratio(self, description, spp, change=None):
        """Returns the ratio of means with its interval. `change` modifies the description after Lampyris has
        read it."""
        ours = self.references(renderers.Lampyris('Lampyris', LAMPYRIS), description, spp)
        if change:
            change(description)
        theirs = self.references(renderers.Cycles('blender'), description, spp)
        found = estimate.ratio_of_means(ours, theirs)
        print('%-8s %.5f [%.5f, %.5f], relMSE between the means %.1e' % (
            description['name'], *found, estimate.difference(ours, theirs)))
        return found


class Materials(Both):
    """A ball of each material under constant light has the same albedo in both renderers, within single
    precision."""

    cases = {'diffuse': {'kind': 'diffuse', 'color': (.5, .2, .1)}, 'glass': {'kind': 'glass', 'ior': 1.5},
             'plastic': {'kind': 'plastic', 'color': (.5, .2, .1), 'ior': 1.5},
             'smooth': {'kind': 'metal', 'color': (.9, .7, .4), 'roughness': .08},
             'middle': {'kind': 'metal', 'color': (.9, .7, .4), 'roughness': .3},
             'rough': {'kind': 'metal', 'color': (.9, .7, .4), 'roughness': .5}}

    def of(self, name, change=None):
        value, low, high = self.ratio({
            'name': name, 'max_bounces': 9, 'camera': {'position': (0, 0, 5), 'target': (0, 0, 0), 'fov_degrees': 30},
            'materials': {'it': dict(self.cases[name])}, 'meshes': {'pebble': 'pebble.ply'}, 'quad_lights': [],
            'objects': [{'mesh': 'pebble', 'material': 'it', 'matrix': None}], 'environment': 'even.exr'}, 256, change)
        self.assertLess(high - low, 4e-4)
        return abs(value - 1)

    def test_albedos_agree(self):
        for name in self.cases:
            with self.subTest(name):
                self.assertLess(self.of(name), 5e-4)

    def test_a_difference_would_be_found(self):
        def rougher(description):
            description['materials']['it']['roughness'] += .01
        self.assertGreater(self.of('rough', rougher), 1e-3)


class Means(Both):
    """Both renderers solve the same problem."""

    # For each scene, the samples per pixel of two references with 48 x 48 pixels, and the required half-width
    # of the interval.
    cases = {'box': (128, .01), 'glass': (256, .015), 'mesh': (64, .015), 'plates': (1024, .06), 'spheres': (256, .05)}
    z = 3.9  # of five intervals, one in two thousand fails by chance

    def interval(self, name, change=None):
        value, low, high = self.ratio(scenes.describe(name), self.cases[name][0], change)
        half = (high - low) / 2 * self.z / 1.96
        return value - half, value + half

    def test_they_agree(self):
        for name, (_, width) in self.cases.items():
            with self.subTest(name):
                low, high = self.interval(name)
                self.assertLess(low, 1)
                self.assertGreater(high, 1)
                self.assertLess((high - low) / 2, width)

    def test_a_difference_would_be_found(self):
        def brighter(description):
            description['quad_lights'][0]['radiance'] = [1.02 * v for v in description['quad_lights'][0]['radiance']]
        self.assertLess(self.interval('box', brighter)[1], 1)

    def test_the_command(self):
        command = [sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), 'run.py'), '--quick',
                   '--lampyris', LAMPYRIS, '--also', 'before=%s --light-choice auto' % LAMPYRIS, '--scenes', 'box', '-o', self.folder.name]
        told = []
        for _ in range(2):  # the second run finds all rows
            result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
            self.assertEqual(result.returncode, 0, result.stderr)
            told.append(result.stdout)
        self.assertEqual(told[0], told[1])
        self.assertEqual(result.stderr, '')
        with open(os.path.join(self.folder.name, 'rows.csv')) as file:
            self.assertEqual(len(file.readlines()), 1 + 3 * 2)
        with open(os.path.join(self.folder.name, 'results.json')) as file:
            scene, = json.load(file)['scenes']
        pairs = [(ratio['of'], ratio['renderer']) for ratio in scene['ratios']]
        self.assertEqual(pairs, [('Lampyris', 'Cycles'), ('Lampyris', 'before'), ('before', 'Cycles')])
        before = scene['ratios'][1]
        # The same program with the same seeds.
        self.assertEqual([before[name][0] for name in ('relmse', 'relmse_99', 'rays')], [1, 1, 1])


if __name__ == '__main__':
    if {'Scenes', 'Materials', 'Means'} & set(sys.argv[1:]):
        need_device(LAMPYRIS)
    if {'Materials', 'Means'} & set(sys.argv[1:]) and not shutil.which('blender'):
        print('Blender is not installed')
        sys.exit(77)
    unittest.main()
