#!/usr/bin/env python3
"""Tests how models are displayed that have no camera, no light, no texture, or nothing at all.

    test_models.py LAMPYRIS SOURCE_ROOT
"""
import importlib.machinery
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import unittest

import png_pixels
from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))

# Functions for making models, from another test.
LOADER = importlib.machinery.SourceFileLoader(
    'make_models', os.path.join(ROOT, 'docs', 'pictures', 'make-models'))
make_models = importlib.util.module_from_spec(
    importlib.util.spec_from_loader('make_models', LOADER))
LOADER.exec_module(make_models)

SIZE = 64
WHITE = {'pbrMetallicRoughness': {'baseColorFactor': [.9, .9, .9, 1], 'metallicFactor': 0}}
MISSING = {'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}, 'metallicFactor': 0}}


class Base(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), 'w') as file:
            file.write(text)
        return self.path(name)

    def white(self):
        make_models.write_gltf(self.path('white.gltf'), make_models.stack(), WHITE)
        return self.path('white.gltf')

    def run_it(self, path, *arguments, code=0):
        result = subprocess.run(
            [LAMPYRIS, 'render', path, '--size', '%dx%d' % (SIZE, SIZE), '--spp', '16', '--json',
             *arguments, '-o', self.path('out.png')],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def picture(self, path, *arguments):
        """Renders and returns rows of (r, g, b), and the output of --json."""
        result = self.run_it(path, *arguments)
        width, _, rows = png_pixels.read(self.path('out.png'))
        return ([[tuple(row[3 * x:3 * x + 3]) for x in range(width)] for row in rows],
                json.loads(result.stdout))

    def mean(self, picture):
        return sum(sum(p) for row in picture for p in row) / (3 * 255 * SIZE * SIZE)

    def outline(self, path, *arguments):
        """Returns the bounding box of the model in front of a white background, if surfaces reflect
        nothing."""
        picture, _ = self.picture(path, '--studio', 'off', '--ground', 'off', '--max-bounces', '0',
                                  '--tone', 'none', '--exposure', '0', *arguments)
        points = [(x, y) for y, row in enumerate(picture) for x, p in enumerate(row)
                  if max(p) < 128]
        xs, ys = [p[0] for p in points], [p[1] for p in points]
        return min(xs), min(ys), max(xs) + 1, max(ys) + 1, set(points)


class Framing(Base):
    def test_it_fills_the_picture(self):
        x0, y0, x1, y1, _ = self.outline(self.white())
        self.assertGreaterEqual(max(x1 - x0, y1 - y0), .6 * SIZE)
        self.assertLessEqual(max(x1 - x0, y1 - y0), .9 * SIZE)
        self.assertLess(abs(x0 + x1 - SIZE), 4)
        self.assertLess(abs(y0 + y1 - SIZE), 4)

    def test_up(self):
        high = [(x, y, 4 * z) for x, y, z in make_models.stack()[0]]
        _, normals, uvs, triangles = make_models.stack()
        make_models.write_gltf(self.path('z.gltf'), (high, normals, uvs, triangles), WHITE)
        tall = {}
        for up in 'xyz':
            x0, y0, x1, y1, _ = self.outline(self.path('z.gltf'), '--up', up)
            tall[up] = (y1 - y0) / (x1 - x0)
        self.assertGreater(tall['z'], 1.3)
        self.assertLess(tall['y'], 1)

    def test_a_camera_of_the_file_stays(self):
        white = self.white()
        with open(white) as file:
            document = json.load(file)
        document['cameras'] = [{'type': 'perspective', 'perspective': {'yfov': .6, 'znear': .1}}]
        document['nodes'].append({'camera': 0, 'translation': [0, 1, 20]})
        document['scenes'][0]['nodes'].append(1)
        far = self.write('far.gltf', json.dumps(document))
        x0, _, x1, _, _ = self.outline(far)
        self.assertLess(x1 - x0, .35 * SIZE)
        _, facts = self.picture(far)
        self.assertIn('studio light', ' '.join(facts['notes']))
        self.assertNotIn('view', ' '.join(facts['notes']))


class Light(Base):
    def test_what_was_added_is_named(self):
        _, facts = self.picture(self.white())
        notes = ' '.join(facts['notes'])
        for option in ('--studio', '--env', '--ground', '--up'):
            self.assertIn(option, notes)
        result = subprocess.run(
            [LAMPYRIS, 'render', self.white(), '--size', '8x8', '--spp', '1', '-o',
             self.path('out.png')], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertRegex(result.stdout, r'wrote .*exposure [-+][0-9.]+ stops, tone '
                                        r'aces: --exposure, --tone')

    def test_white_and_black_are_seen(self):
        """The mean over the model differs from the pixels beside it, and is neither black nor white."""
        make_models.write_own(self.folder.name)
        for name, low, high in (('white', .6, .98), ('black', .02, .35)):
            *_, inside = self.outline(self.path(name + '.obj'))
            picture, _ = self.picture(self.path(name + '.obj'))
            mean = sum(sum(picture[y][x]) for x, y in inside) / (3 * 255 * len(inside))
            outside = [sum(p) / 765 for y, row in enumerate(picture) for x, p in enumerate(row)
                       if (x, y) not in inside]
            with self.subTest(name):
                self.assertGreater(mean, low)
                self.assertLess(mean, high)
                self.assertGreater(abs(mean - sum(outside) / len(outside)), .12)
                self.assertLess(sum(outside) / len(outside), .95)

    def test_the_ground_catches_a_shadow(self):
        white = self.white()
        x0, _, x1, y1, inside = self.outline(white)
        linear = ('--tone', 'none', '--exposure', '0')
        y = y1 - 8
        edge = max(x for x, line in inside if line == y)
        spots = [(edge + 2, y), (edge + 3, y), (edge + 2, y + 1), (edge + 3, y + 1)]
        dark = {}
        for ground in ('auto', 'off'):
            picture, _ = self.picture(white, '--ground', ground, *linear)
            near = sum(sum(picture[b][a]) for a, b in spots) / len(spots)
            left = sum(sum(picture[b][2 * ((x0 + x1) // 2) - a]) for a, b in spots) / len(spots)
            dark[ground] = near / left
        self.assertLess(dark['auto'], .85)
        self.assertGreater(dark['off'], .93)

    def test_a_sky_is_exposed(self):
        white = self.white()
        picture, _ = self.picture(white, '--env', 'sky:')
        self.assertGreater(self.mean(picture), .3)
        self.assertLess(self.mean(picture), .8)
        picture, _ = self.picture(white, '--env', 'sky:', '--exposure', '0', '--tone', 'none')
        self.assertGreater(self.mean(picture), .97)
        cornell = os.path.join(ROOT, 'scenes', 'cornell.json')
        picture, _ = self.picture(cornell, '--exposure', 'auto')
        self.assertGreater(self.mean(picture), .1)

    def test_a_sky_replaces_the_exposure_of_the_file(self):
        # The exposure in a file applies to the file's own lights or sky.
        cornell = os.path.join(ROOT, 'scenes', 'cornell.json')
        picture, _ = self.picture(cornell, '--env', 'sky:')
        self.assertLess(self.mean(picture), .8)
        told = [subprocess.run([LAMPYRIS, 'render', path, *arguments, '--size', '16x16', '--spp', '4',
                                '-o', self.path('out.png')], stdout=subprocess.PIPE, check=True,
                               text=True).stdout
                for path, *arguments in (
                    (cornell, '--env', 'sky:'), (cornell, '--env', 'sky:', '--exposure', '0.6'),
                    (self.write('sky.json', json.dumps({
                        'lampyris': 1, 'environment': {'type': 'sky'}, 'film': {'exposure': -9},
                        'camera': {'position': [0, 0, 9], 'direction': [0, 0, -1],
                                   'fov_degrees': 30}})),))]
        self.assertRegex(told[0], r"wrote .*\(exposure -\d+\.\d+ stops, not the file's, tone ")
        self.assertNotIn('exposure', told[1])
        self.assertNotIn('exposure', told[2])

    def test_emission_is_judged_by_what_it_sends(self):
        make_models.write_own(self.folder.name)
        weak = self.path('windows.gltf')
        picture, facts = self.picture(weak)
        self.assertIn("the file's own light is", ' '.join(facts['notes']))
        self.assertGreater(self.mean(picture), .3)
        picture, _ = self.picture(weak, '--studio', 'off', '--exposure', '0')
        self.assertLess(self.mean(picture), .05)
        with open(weak) as file:
            document = json.load(file)
        del document['materials'][0]['emissiveTexture']
        strong = self.write('strong.gltf', json.dumps(document))
        _, facts = self.picture(strong)
        self.assertNotIn('studio', ' '.join(facts['notes']))

    def test_scene_files_keep_theirs(self):
        hashes = set()
        scene = os.path.join(ROOT, 'scenes', 'cornell.json')
        for arguments in ((), ('--studio', 'off', '--ground', 'off', '--up', 'z')):
            _, facts = self.picture(scene, *arguments)
            hashes.add(facts['image_hash'])
            self.assertEqual(facts['notes'], [])
        self.assertEqual(len(hashes), 1)

    def test_wishes_that_contradict(self):
        result = self.run_it(self.white(), '--studio', 'on', '--env', '1,1,1', code=2)
        self.assertIn('expected no --env', result.stderr)
        result = subprocess.run([LAMPYRIS, 'compare', 'a.exr', 'b.exr', '--exposure', 'auto'],
                                stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, 2)
        self.assertIn('expected a number of stops', result.stderr)


class Missing(Base):
    def files(self):
        make_models.write_gltf(self.path('a.gltf'), make_models.stack(), MISSING,
                               textures=[{'source': 0}], images=[{'uri': 'nowhere.png'}])
        make_models.write_obj(self.path('b.obj'), make_models.stack(), .5)
        self.write('b.mtl', 'newmtl m\nKd .5 .5 .5\nmap_Kd nowhere.png\n')
        self.write('c.json', json.dumps({
            'lampyris': 1,
            'materials': {'m': {'type': 'principled', 'textures': [
                {'file': 'nowhere.png', 'parameters': {'roughness': 'r'}}]}},
            'shapes': [{'type': 'sphere', 'center': [0, 0, 0], 'radius': 1, 'material': 'm'}]}))
        return [self.path(name) for name in ('a.gltf', 'b.obj', 'c.json')]

    def test_a_missing_material_library(self):
        make_models.write_obj(self.path('d.obj'), make_models.stack(), .5)
        os.remove(self.path('d.mtl'))
        self.assertIn('d.mtl', self.run_it(self.path('d.obj')).stderr)
        result = self.run_it(self.path('d.obj'), '--strict', code=2)
        self.assertRegex(result.stderr, r'd\.obj:\d+: mtllib: .*d\.mtl')

    def test_it_is_pink_and_counted(self):
        for path in self.files():
            with self.subTest(path):
                result = self.run_it(path)
                self.assertIn('nowhere.png', result.stderr)
                self.assertIn('1 images are missing: 1 of', result.stderr)
                _, _, rows = png_pixels.read(self.path('out.png'))
                r, g, b = rows[SIZE // 2][3 * SIZE // 2 // 3 * 3:][:3]
                self.assertGreater(r, 1.5 * g)
                self.assertGreater(b, 1.2 * g)

    def test_strict(self):
        for path in self.files():
            with self.subTest(path):
                result = self.run_it(path, '--strict', code=2)
                self.assertIn('nowhere.png', result.stderr)


class Empty(Base):
    def test_nothing_to_see_is_an_error(self):
        gltf = {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{}]}
        for name, text in (('a.json', '{"lampyris": 1}'), ('b.gltf', json.dumps(gltf)),
                           ('c.obj', 'v 0 0 0\nv 1 0 0\n')):
            with self.subTest(name):
                result = self.run_it(self.write(name, text), code=2)
                self.assertRegex(result.stderr, 'empty|no face|no triangle')
        result = self.run_it(self.write('e.obj', 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n'), code=2)
        self.assertIn('no triangle with an area', result.stderr)
        hidden = {'lampyris': 1, 'materials': {'m': {'type': 'diffuse'}}, 'shapes': [
            {'type': 'sphere', 'center': [0, 0, 0], 'radius': 1, 'material': 'm',
             'visible': False}]}
        result = self.run_it(self.write('f.json', json.dumps(hidden)), code=2)
        self.assertIn('everything in the scene is hidden', result.stderr)
        hidden['shapes'].append({**hidden['shapes'][0], 'visible': True})
        self.run_it(self.write('f.json', json.dumps(hidden)))
        # A scene that contains only a sky can be viewed.
        self.run_it(self.write('d.json', '{"lampyris": 1, "environment": {"type": "sky"}}'))


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main(verbosity=0)
