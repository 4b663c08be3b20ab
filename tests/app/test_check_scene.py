#!/usr/bin/env python3
"""`lampyris check SCENE`: each finding in a scene that has it, planted, and none of them in its clean
counterpart; what --fix changes, and that a check of the fixed scene no longer names it.

Usage: test_check_scene.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import base64
import html
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import zlib
try:
    import jsonschema
except ImportError:
    jsonschema = None

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SOURCE = os.path.abspath(sys.argv.pop(1))

FILM = {'width': 48, 'height': 48}
FRONT = {'type': 'orthographic', 'position': [0, 0, 8], 'target': [0, 0, 0], 'height': 6}
GREY = {'base_color': [0.5, 0.5, 0.5]}


def write_exr(path, width, height, texels):
    """Single precision, scan lines, not compressed; texels: rows of (r, g, b)."""
    def attribute(name, kind, data):
        return name + b'\0' + kind + b'\0' + struct.pack('<i', len(data)) + data
    channels = b''.join(name + b'\0' + struct.pack('<iiii', 2, 0, 1, 1) for name in (b'B', b'G', b'R'))
    window = struct.pack('<iiii', 0, 0, width - 1, height - 1)
    header = struct.pack('<ii', 20000630, 2) + b''.join([
        attribute(b'channels', b'chlist', channels + b'\0'),
        attribute(b'compression', b'compression', b'\0'),
        attribute(b'dataWindow', b'box2i', window), attribute(b'displayWindow', b'box2i', window),
        attribute(b'lineOrder', b'lineOrder', b'\0'),
        attribute(b'pixelAspectRatio', b'float', struct.pack('<f', 1)),
        attribute(b'screenWindowCenter', b'v2f', struct.pack('<ff', 0, 0)),
        attribute(b'screenWindowWidth', b'float', struct.pack('<f', 1))]) + b'\0'
    size, first = 12 * width, len(header) + 8 * height
    with open(path, 'wb') as file:
        file.write(header + b''.join(struct.pack('<Q', first + y * (size + 8)) for y in range(height)))
        for y, row in enumerate(texels):
            file.write(struct.pack('<ii', y, size))
            for channel in (2, 1, 0):
                file.write(struct.pack(f'<{width}f', *(texel[channel] for texel in row)))


def write_png(path, width, height, texels):
    """8 bits a channel; texels: rows of (r, g, b, a)."""
    def chunk(kind, data):
        return (struct.pack('>I', len(data)) + kind + data
                + struct.pack('>I', zlib.crc32(kind + data)))
    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n'
                   + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 6, 0, 0, 0))
                   + chunk(b'IDAT', zlib.compress(b''.join(
                       b'\0' + b''.join(bytes(texel) for texel in row) for row in texels)))
                   + chunk(b'IEND', b''))


def box(low, high, faces='abcdef', inside_out=False):
    """An OBJ file of a box whose corners run counter-clockwise seen from outside; of some faces."""
    corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1])
               for x in (low[0], high[0])]
    quads = {'a': (1, 3, 4, 2), 'b': (5, 6, 8, 7), 'c': (1, 2, 6, 5), 'd': (3, 7, 8, 4),
             'e': (1, 5, 7, 3), 'f': (2, 4, 8, 6)}
    lines = [f'v {x} {y} {z}' for x, y, z in corners]
    for name in faces:
        a, b, c, d = quads[name][::-1] if inside_out else quads[name]
        lines += [f'f {a} {b} {c}', f'f {a} {c} {d}']
    return '\n'.join(lines) + '\n'


class Checks(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, content):
        path = os.path.join(self.folder.name, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(content if isinstance(content, str) else json.dumps(content))
        return path

    def check(self, scene, *arguments, name='scene.json'):
        """What is found, by name."""
        path = self.write(name, {'lampyris': 1, 'film': FILM, **scene})
        return self.check_file(path, *arguments)

    def check_file(self, path, *arguments):
        """Where the machine is so busy that fewer pixels are looked at, it is tried again."""
        found = self.check_once(path, *arguments)
        for _ in range(4):
            if 'few-pixels' in found:
                found = self.check_once(path, *arguments)
        return found

    def check_once(self, path, *arguments):
        result = subprocess.run([LAMPYRIS, 'check', path, '--json', *arguments], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=600)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.result = json.loads(result.stdout)
        if jsonschema:
            with open(os.path.join(SOURCE, 'docs', 'check-scene.schema.json'), encoding='utf-8') as file:
                jsonschema.validate(self.result, json.load(file))
        found = {}
        for finding in self.result['findings']:
            known = found.setdefault(finding['name'], finding)
            if finding['level'] == 'wrong' and known['level'] != 'wrong':
                found[finding['name']] = finding
        remaining = [f for f in self.result['findings'] if f['level'] == 'wrong' and
                     not (self.result['fixed'] and f['change'])]
        self.assertEqual(result.returncode, 1 if remaining else 0)
        shares = [-1 if f['share'] is None else f['share'] for f in self.result['findings']]
        self.assertEqual(shares, sorted(shares, reverse=True))
        return found

    def assert_found(self, found, expected):
        self.assertEqual({name: finding['level'] for name, finding in found.items()}, expected)


class Geometry(Checks):
    def scene(self, planted):
        self.write('thin.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' + ('f 1 2 2\n' if planted else ''))
        height = 1e-7 if planted else 1e-2
        self.write('slivers.obj', ''.join(
            f'v {i} 0 0\nv {i + 1} 0 0\nv {i + 0.5} {height} 0\nf -3 -2 -1\n' for i in range(8)))
        turned = -1 if planted else 1
        self.write('normals.obj', 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n'
                   f'vn 0.1 0 {turned}\nf 1//1 2//1 3//2\nf 1//1 3//2 4//2\n')
        self.write('box.obj', box((0, 0, 0), (1, 1, 1)))

        def mesh(name, x, y, scale=1, **more):
            return {'type': 'mesh', 'file': name, 'material': 'grey',
                    'transform': [{'scale': scale}, {'translate': [x, y, 0]}], **more}
        return {
            'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
            'shapes': [
                mesh('thin.obj', -2.5, 1.5), mesh('slivers.obj', -2.5, 0, 0.5),
                mesh('normals.obj', -2.5, -2.5), mesh('box.obj', 0, 1.5, [1, 0 if planted else 1, 1]),
                {'type': 'sphere', 'material': 'grey', 'center': [0, -1, 0], 'radius': 0.6},
                {'type': 'sphere', 'material': 'red', 'center': [0, -1 if planted else -2.3, 0],
                 'radius': 0.6},
                {'type': 'quad', 'material': 'grey', 'corner': [1.5, 0, 0], 'u': [1, 0, 0], 'v': [0, 1, 0]},
                {'type': 'quad', 'material': 'red', 'corner': [1.9, 0.3, 0 if planted else -0.1],
                 'u': [1, 0, 0], 'v': [0, 1, 0]},
            ]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True))
        self.assert_found(found, {
            'zero-area': 'remark', 'sliver': 'remark', 'normals': 'wrong',
            'singular-transform': 'remark', 'object-twice': 'wrong', 'coincident-faces': 'wrong'})
        self.assertIn('triangle 1', found['zero-area']['place'])
        self.assertIn('thin', found['zero-area']['place'])
        self.assertIn('1 of ', found['singular-transform']['figure'])
        # What is touched of 36 square metres: a disc; where the two quads lie upon each other.
        self.assertAlmostEqual(found['object-twice']['share'], 3.14159 * 0.36 / 36, delta=0.006)
        self.assertAlmostEqual(found['coincident-faces']['share'], 0.6 * 0.7 / 36, delta=0.004)
        self.assertAlmostEqual(found['normals']['share'], 1 / 36, delta=0.006)
        self.assert_found(self.check(self.scene(False)), {})

    # Each shape has a mesh of its own, of the same triangles.
    def test_meshes_of_equal_files(self):
        def scene(x, material='grey'):
            self.write('box.obj', box((0, 0, 0), (1, 1, 1)))
            return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                    'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
                    'shapes': [{'type': 'mesh', 'file': 'box.obj', 'material': material,
                                'transform': [{'translate': [x, 0, 0]}]}
                               for x, material in ((0, 'grey'), (x, material))]}
        self.assert_found(self.check(scene(1.5)), {})
        self.assert_found(self.check(scene(0)), {'object-twice': 'remark'})
        self.assert_found(self.check(scene(0, 'red')), {'object-twice': 'wrong'})

    def test_fixed(self):
        fixed = os.path.join(self.folder.name, 'fixed.json')
        found = self.check(self.scene(True), '--fix', fixed)
        changed = {name for name, finding in found.items() if finding['change']}
        self.assertEqual(changed, {'singular-transform'})
        self.assertEqual(set(self.check_file(fixed)), set(found) - changed)


class Upon(Checks):
    def found(self, *shapes):
        return self.check({
            'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]},
                          'glass': {'type': 'dielectric'},
                          'water': {'type': 'dielectric', 'ior': 1.33}},
            'shapes': [{'material': 'grey', **shape} for shape in shapes]})

    def test_behind_glass(self):
        """Faces in one plane, behind a pane."""
        for gap, expected in ((0, {'coincident-faces': 'wrong'}), (0.1, {})):
            self.assert_found(self.found(
                {'type': 'quad', 'corner': [-3, -3, 0], 'u': [6, 0, 0], 'v': [0, 6, 0]},
                {'type': 'quad', 'material': 'red', 'corner': [-1, -1, gap], 'u': [2, 0, 0],
                 'v': [0, 2, 0]},
                {'type': 'box', 'material': 'glass', 'min': [-4, -4, 1], 'max': [4, 4, 1.1]}), expected)

    def test_curved(self):
        for near, expected in ((1e-14, {'coincident-faces': 'wrong'}), (1e-3, {})):
            found = self.found(
                {'type': 'sphere', 'center': [-1.5, 0, 0], 'radius': 1},
                {'type': 'sphere', 'material': 'red', 'center': [-1.5, near, 0], 'radius': 1},
                {'type': 'cylinder', 'from': [1.5, -1, 0], 'to': [1.5, 1, 0], 'radius': 0.5},
                {'type': 'cylinder', 'material': 'red', 'from': [1.5, 0, 0], 'to': [1.5, 2, 0],
                 'radius': 0.5 + near})
            self.assert_found(found, expected)
            if found:  # the disc of one, and what the cylinders share
                self.assertAlmostEqual(found['coincident-faces']['share'], (3.14159 + 1) / 36, delta=0.01)


    def test_from_far(self):
        """A wall behind another one that a line of sight as long does not tell apart, though their
        coordinates do; in the picture the one behind is seen, in the shadow of the other."""
        for away in (10, 1e4):
            def scene(gap, larger=1.01):
                size = 0.01 * away
                return {'camera': {'position': [0, 0, 0], 'target': [0, 0, -away], 'fov_degrees': 0.5},
                        'environment': {'radiance': [1, 1, 1]},
                        'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
                        'shapes': [{'type': 'quad', 'material': material, 'corner': [-size, -size, z],
                                    'u': [2 * size * u, 0, 0], 'v': [0, 2 * size, 0]}
                                   for material, z, u in (('grey', -away, 1),
                                                          ('red', gap * away - away, larger))]}
            with self.subTest(away):
                self.assertNotIn('object-twice', self.check(scene(2e-8, larger=1)))
                found = self.check(scene(2e-8))
                self.assertEqual(found['coincident-faces']['level'], 'wrong')
                self.assertIn(f'met from {away:.4g} m away', found['coincident-faces']['figure'])
                self.assertGreater(found['coincident-faces']['share'], 0.3)
                self.assert_found(self.check(scene(1e-4)), {})

    def test_boxes(self):
        """Faces of boxes and caps that no ray ignores, on a wall, on each other and under a quad."""
        def box(low, high, material='grey', form='analytic'):
            return {'type': 'box', 'as': form, 'material': material, 'min': low, 'max': high}
        sheet = {'type': 'quad', 'as': 'analytic', 'material': 'red', 'u': [0.5, 0, 0], 'v': [0, 0.5, 0]}
        pairs = {
            'boxes': lambda gap: [box([0, 0, 0], [1, 1, 1]), box([0.3, 0.3, 0.5], [2, 2, 1 + gap], 'red')],
            'side by side': lambda gap: [box([0, 0, 0], [1, 1, 1], 'glass'),
                                         box([0, 0, -1], [1, 1, -gap], 'glass')],
            'a box and a quad': lambda gap: [box([0, 0, 0], [1, 1, 1]),
                                             {**sheet, 'corner': [0.2, 0.2, 1 + gap]}],
            'a quad and a box': lambda gap: [{**sheet, 'corner': [0.2, 0.2, 1]},
                                             box([0, 0, 0], [1, 1, 1 - gap])],
            'a box and triangles': lambda gap: [box([0, 0, 0], [1, 1, 1]),
                                                box([0.5, 0.5, 0], [2, 2, 1 + gap], 'red', 'triangles')],
            'a cap and a box': lambda gap: [
                {'type': 'cylinder', 'from': [0, 0, 0], 'to': [0, 0, 1], 'radius': 1},
                box([0, 0, 0], [2, 2, 1 + gap], 'red')],
        }
        for name, pair in pairs.items():
            with self.subTest(name):
                self.assert_found(self.found(*pair(0)), {'coincident-faces': 'wrong'})
                self.assert_found(self.found(*pair(0.01)), {})

    def test_media(self):
        """Glass and water that share a face are closed, each of them."""
        for form in ('triangles', 'analytic'):
            for gap, expected in ((0, {'coincident-faces': 'wrong'}), (0.1, {})):
                self.assert_found(self.found(
                    {'type': 'box', 'as': form, 'material': 'glass', 'min': [-1, -1, 0.4], 'max': [1, 1, 0.5]},
                    {'type': 'box', 'as': form, 'material': 'water', 'min': [-1, -1, -1],
                     'max': [1, 1, 0.4 - gap]}), expected)


class Gaps(Checks):
    """Objects at one place whose materials have gaps: each is seen where the other is not."""

    def scene(self, second, first=None):
        for name, left, right in (('left.png', 255, 0), ('right.png', 0, 255)):
            texels = [(255, 255, 255, left), (255, 255, 255, right)]
            write_png(os.path.join(self.folder.name, name), 2, 1, [texels])

        def mask(name, color):
            return {'base_color': color, 'alpha': 'mask', 'textures': [
                {'file': name, 'filter': 'nearest', 'parameters': {'opacity': 'a'}}]}
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'materials': {'grey': GREY, 'left': mask('left.png', [0.6, 0.1, 0.1]),
                              'right': mask('right.png', [0.1, 0.6, 0.1]),
                              'veil': {'base_color': [0.1, 0.1, 0.6], 'opacity': 0.5}},
                'shapes': [{'type': 'quad', 'material': material, 'corner': [-1, -1, 0],
                            'u': [2, 0, 0], 'v': [0, 2, 0]} for material in (first or 'left', second)]}

    def test_are_no_twins(self):
        fixed = os.path.join(self.folder.name, 'fixed.json')
        for second, first in (('right', None), ('veil', None)):
            self.assert_found(self.check(self.scene(second, first), '--fix', fixed), {})

    def test_one_of_them_has_no_gaps(self):
        """The order of the objects decides whether the one with gaps is seen."""
        for second, first in (('grey', 'left'), ('grey', 'veil'), ('veil', 'grey')):
            found = self.check(self.scene(second, first))
            self.assert_found(found, {'object-twice': 'wrong'})
            self.assertIn('order of the objects', found['object-twice']['consequence'])

    def test_are_twins(self):
        self.assert_found(self.check(self.scene('left')), {'object-twice': 'remark'})
        self.assert_found(self.check(self.scene('veil', 'veil')), {'object-twice': 'wrong'})


class Twice(Checks):
    """Objects at one place: what is said of them, and that --fix changes no picture."""

    def scene(self, *materials, **more):
        quad = {'type': 'quad', 'corner': [-1, -1, 0], 'u': [2, 0, 0], 'v': [0, 2, 0]}
        emission = {'emission': [4, 4, 4]}
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]}, 'settings': {'spp': 4},
                'materials': {'grey': GREY, 'like-grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]},
                              'lamp': {**GREY, **emission}, 'veil': {**GREY, 'opacity': 0.5},
                              'glass': {'type': 'dielectric'}, 'pane': {'type': 'dielectric', 'thin': True}},
                'shapes': [{**quad, 'material': 'grey', 'corner': [-1, -1, -1], 'u': [2, 0, 1]}] +
                          [{**(more or quad), 'material': material} for material in materials]}

    def picture(self, name):
        """The hash of a scene's picture."""
        path = os.path.join(self.folder.name, name)
        result = subprocess.run([LAMPYRIS, 'render', path, '--json', '-o', path + '.exr'], text=True,
                                stdout=subprocess.PIPE, check=True, timeout=600)
        return json.loads(result.stdout)['image_hash']

    def test_fixes_leave_the_picture(self):
        """Of a lamp upon a wall, of two lamps and of two veils none may be hidden."""
        fixed = os.path.join(self.folder.name, 'fixed.json')
        for materials, level, hidden in (
                (('grey', 'lamp'), 'wrong', None), (('lamp', 'lamp'), 'wrong', None),
                (('veil', 'veil'), 'wrong', None), (('red', 'grey', 'grey'), 'wrong', None),
                (('grey', 'grey'), 'remark', 'instance 2 of mesh "quad" (material "grey") is hidden'),
                (('red', 'red', 'red'), 'remark',
                 '2 objects are hidden, the first one of them is instance 2 of mesh "quad" (material "red")'),
                (('grey', 'like-grey'), 'remark',
                 'instance 2 of mesh "quad" (material "like-grey") is hidden')):
            with self.subTest(materials):
                found = self.check(self.scene(*materials), '--fix', fixed)
                self.assert_found(found, {'object-twice': level})
                self.assertEqual(found['object-twice']['change'], hidden)
                self.assert_found(self.check_file(fixed), {} if hidden else {'object-twice': level})
                self.assertEqual(self.picture('scene.json'), self.picture('fixed.json'))

    def test_glass_is_as_one(self):
        sphere = {'type': 'sphere', 'center': [0, 0, 1.2], 'radius': 0.8}
        for material, more in (('glass', sphere), ('pane', {})):
            with self.subTest(material):
                found = self.check(self.scene(material, material, **more), name='two.json')
                self.assert_found(found, {'object-twice': 'remark'})
                self.assertIsNone(found['object-twice']['change'])
                self.write('one.json', {'lampyris': 1, 'film': FILM, **self.scene(material, **more)})
                self.assertEqual(self.picture('one.json'), self.picture('two.json'))


class Coarse(Checks):
    def test_objects(self):
        def scene(distance):
            return {'camera': {'position': [0, 0, 8], 'target': [distance, 0, 0],
                               'fov_degrees': 200 / distance}, 'environment': {'radiance': [1, 1, 1]},
                    'film': {'width': 16, 'height': 16},
                    'materials': {'grey': GREY},
                    'shapes': [{'type': 'sphere', 'material': 'grey', 'center': [0, 0, 0], 'radius': 2},
                               {'type': 'sphere', 'material': 'grey', 'center': [distance, 0, 0],
                                'radius': 1}]}
        found = self.check(scene(1e6))
        self.assert_found(found, {'coarse-object': 'wrong'})
        self.assertIn('shape 1', found['coarse-object']['place'])
        self.assertGreater(found['coarse-object']['share'], 0.1)
        self.assert_found(self.check(scene(1e3)), {})

    def test_meshes_and_cameras(self):
        def scene(offset, distance):
            self.write('far.obj', box((offset, 0, 0), (offset + 2, 2, 2)))
            return {'camera': {'position': [1, 1, distance], 'target': [1, 1, 0], 'fov_degrees': 40},
                    'environment': {'radiance': [1, 1, 1]}, 'materials': {'grey': GREY},
                    'shapes': [{'type': 'mesh', 'file': 'far.obj', 'material': 'grey',
                                'transform': [{'translate': [-offset, 0, 0]}]}]}
        found = self.check(scene(1e6, 8))
        self.assert_found(found, {'coarse-mesh': 'wrong'})
        self.assert_found(self.check(scene(0, 8)), {})
        self.assert_found(self.check(scene(0, 1e6)), {'far-camera': 'slow'})


class Media(Checks):
    def scene(self, planted):
        self.write('closed.obj', box((-2.8, 1.6, 0), (-1.8, 2.6, 1), inside_out=planted))
        self.write('open.obj', box((-1.4, 1.6, 0), (-0.4, 2.6, 1), 'bcdef' if planted else 'abcdef'))
        nested = [{'type': 'sphere', 'material': f'layer{i}', 'center': [2, 2, 0],
                   'radius': 0.9 - 0.15 * i} for i in range(5 if planted else 4)]
        materials = {f'layer{i}': {'type': 'dielectric', 'ior': 1.1 + 0.1 * i, 'priority': 2 + i}
                     for i in range(5)}
        return {
            'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'bubble': {'type': 'dielectric', 'ior': 1.0,
                                                   'priority': 1 if planted else 2},
                          'glass': {'type': 'dielectric', 'ior': 1.5},
                          'water': {'type': 'dielectric', 'ior': 1.33,
                                    'priority': 1 if planted else 2}, **materials},
            'shapes': [
                {'type': 'mesh', 'file': 'closed.obj', 'material': 'glass'},
                {'type': 'mesh', 'file': 'open.obj', 'material': 'glass'},
                {'type': 'sphere', 'material': 'glass', 'center': [-2, 0, 0], 'radius': 0.9},
                {'type': 'sphere', 'material': 'bubble', 'center': [-2, 0, 0], 'radius': 0.5},
                {'type': 'sphere', 'material': 'glass', 'center': [0, 0, 0], 'radius': 0.7},
                {'type': 'sphere', 'material': 'water', 'center': [0.6, 0, 0], 'radius': 0.7},
                {'type': 'sdf', 'material': 'glass', 'transform': {'translate': [-0.5, -2, 0]},
                 'field': {'type': 'sphere', 'radius': 0.6}},
                *nested]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True))
        for follows in ('depth', 'heavy-tail'):  # of paths that are in a medium which is not there
            found.pop(follows, None)
        self.assert_found(found, {'medium-not-entered': 'wrong', 'medium-not-left': 'wrong',
                                  'media-overlap': 'wrong', 'media-nested': 'wrong'})
        overlaps = [f for f in self.result['findings'] if f['name'] == 'media-overlap']
        self.assertEqual({(f['level'], 'bubble' in f['place'], 'water' in f['place'])
                          for f in overlaps}, {('wrong', True, False), ('remark', False, True)})
        self.assertIn('closed', found['medium-not-entered']['place'])
        self.assertIn('open', found['medium-not-left']['place'])
        self.assertAlmostEqual(found['medium-not-left']['share'], 1 / 36, delta=0.006)
        self.assertIn('layer4', found['media-nested']['place'])
        self.assert_found(self.check(self.scene(False)), {})

    def test_fixed(self):
        fixed = os.path.join(self.folder.name, 'fixed.json')
        self.check(self.scene(True), '--fix', fixed)
        overlaps = [f['change'] for f in self.result['findings'] if f['name'] == 'media-overlap']
        self.assertEqual(sum(change is not None for change in overlaps), 1)
        self.check_file(fixed)
        overlaps = [f for f in self.result['findings'] if f['name'] == 'media-overlap']
        self.assertEqual([f['level'] for f in overlaps], ['remark'])


class Pane(Checks):
    def test_closed(self):
        """A pane in front of all: no line to the inside runs along its face, the first one's neither."""
        for shift in (0, 0.3):
            self.assert_found(self.check({
                'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'film': {'width': 16, 'height': 16},
                'materials': {'glass': {'type': 'dielectric'}},
                'shapes': [{'type': 'box', 'material': 'glass', 'min': [-4 + shift, -4, 1],
                            'max': [4, 4 + shift, 1.05]}]}), {})


class Light(Checks):
    def scene(self, planted):
        white = [1, 1, 1] if planted else [0.8, 0.8, 0.8]
        sdf = [{'type': 'plane', 'material': 'lamp', 'point': [0, -20, 0], 'normal': [0, 1, 0]}]
        slab = {'type': 'box', 'material': 'glass', 'min': [-2.9, 1, -0.9], 'max': [-0.1, 1.1, 0.9]}
        return {
            'camera': {**FRONT, 'position': [0, 3, 8]},
            'materials': {'white': {'base_color': white}, 'glass': {'type': 'dielectric'},
                          'lamp': {'emission': [5, 5, 5]},
                          'varnish': {'type': 'microfacet', 'base_color': [0.9] * 3, 'roughness': 0.1,
                                      'specular_color': [0.04] * 3,
                                      'diffuse': 'uncoupled' if planted else 'coupled'}},
            'lights': [{'type': 'point', 'position': [-1, 2.5, 0], 'intensity': [5, 5, 5]}],
            'shapes': [
                {'type': 'quad', 'material': 'white', 'corner': [-3, 0, 1], 'u': [6, 0, 0],
                 'v': [0, 0, -2]},
                {'type': 'sphere', 'material': 'lamp', 'center': [-2, 2.5, 0], 'radius': 0.2},
                {'type': 'sphere', 'material': 'varnish', 'center': [2, 0.5, 0], 'radius': 0.5},
                *(sdf + [slab] if planted else [])]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True), '--max-bounces', '64')
        self.assert_found(found, {'light-lost': 'wrong', 'light-by-chance': 'slow',
                                  'albedo-1': 'remark', 'gains-light': 'wrong',
                                  'lamp-unaimed': 'slow'})
        self.assertIn('glass', found['light-lost']['place'])
        self.assertIn('varnish', found['gains-light']['place'])
        self.assertIsNone(found['lamp-unaimed']['share'])
        self.assert_found(self.check(self.scene(False), '--max-bounces', '64'), {})


class Many(Checks):
    def test_gains_of_all_materials(self):
        """More of them than a furnace holds at once: the last one is looked at, too."""
        def ball(name, i):
            return {'type': 'sphere', 'material': name, 'center': [i % 20 - 10, i // 20 - 7, 0],
                    'radius': 0.4}
        last = {'type': 'microfacet', 'base_color': [0.9] * 3, 'roughness': 0.1,
                'specular_color': [0.04] * 3, 'diffuse': 'uncoupled'}
        plain = {f'm{i}': {'type': 'principled', 'base_color': [i / 400] * 3} for i in range(280)}
        found = self.check({
            'camera': {**FRONT, 'height': 24}, 'environment': {'radiance': [1, 1, 1]},
            'film': {'width': 24, 'height': 24}, 'materials': {**plain, 'varnish': last},
            'shapes': [*(ball(f'm{i}', i) for i in range(280)), ball('varnish', 285)]})
        self.assert_found(found, {'gains-light': 'wrong'})
        self.assertIn('varnish', found['gains-light']['place'])


class Lost(Checks):
    """A light over a floor, with a pane of glass in between, and a lamp beside it."""

    def found(self, *lights, lamp=1):
        self.write('up.ies', 'IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 0\n'
                   '0 45 90\n0\n1000 1000 0\n')
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 6, 6], 'target': [0, 0, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'glass': {'type': 'dielectric'},
                          'lamp': {'base_color': [0, 0, 0], 'emission': [lamp] * 3}},
            'lights': [{'type': 'point', 'position': [0, 2, -3], 'intensity': [1, 1, 1], **light}
                       for light in lights],
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0],
                        'v': [0, 0, -6]},
                       {'type': 'box', 'material': 'glass', 'min': [-9, 1.5, -3.5], 'max': [9, 1.6, -2]},
                       {'type': 'quad', 'material': 'lamp', 'corner': [-4, 0.1, 3], 'u': [0, 1, 0],
                        'v': [0, 0, -6]}]})

    def test_by_what_is_sent(self):
        def spot(y):
            return {'type': 'spot', 'direction': [0, y, 0], 'outer_degrees': 60}

        def profile(y):
            return {'profile': 'up.ies', 'direction': [0, y, 0]}
        for lost, sends_nothing in (({'range': 9}, {'range': 0.4}), (spot(-1), spot(1)),
                                    (profile(-1), profile(1)), ({}, {'intensity': [1e-9] * 3})):
            self.assertEqual(self.found(lost)['light-lost']['level'], 'wrong', lost)
            self.assertNotIn('light-lost', self.found(sends_nothing), sends_nothing)
        # One of 200 behind glass: a thousandth of the light.
        grid = [{'position': [5 / 14 * (i % 14 - 7), 1.2, 5 / 14 * (i // 14 - 7)]} for i in range(199)]
        self.assertNotIn('light-lost', self.found(*grid, {'intensity': [2, 2, 2]}))
        many = 99 * [{'range': 0.4}]
        self.assertEqual(self.found(*many, {'intensity': [9, 9, 9]})['light-lost']['level'], 'wrong')
        self.assertNotIn('light-lost', self.found(*many))


class Mirrors(Checks):
    """A light without extent over a floor, before a wall that may be a mirror."""

    def found(self, wall, **light):
        return self.check({
            'film': {'width': 32, 'height': 24},
            'camera': {'position': [0, 1, 5], 'target': [0, 1, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'wall': wall},
            'environment': {'radiance': [0.05, 0.05, 0.05]},
            'lights': [{'type': 'directional', 'direction': [0, -1, -1], 'irradiance': [3, 3, 3],
                        **light}],
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-5, 0, 5], 'u': [10, 0, 0],
                        'v': [0, 0, -10]},
                       {'type': 'quad', 'material': 'wall', 'corner': [-2, 0, -2], 'u': [4, 0, 0],
                        'v': [0, 3, 0]}]})

    def test_what_they_would_send_on(self):
        mirror = {'type': 'mirror', 'base_color': [0.95, 0.95, 0.95]}
        silver = {'type': 'conductor', 'metal': 'silver'}
        for wall in (mirror, {**silver, 'roughness': 0}):
            self.assertEqual(self.found(wall)['light-lost']['level'], 'wrong')
        for wall in (GREY, {**silver, 'roughness': 0.3}):
            self.assertNotIn('light-lost', self.found(wall))
        self.assertNotIn('light-lost', self.found(mirror, direction=[0, -1, 1]))  # behind the mirror
        self.assertNotIn('light-lost', self.found(mirror, angular_diameter_degrees=5))


class Chance(Checks):
    """Lamps over a floor, one of them behind glass: by what they send there, not by their number."""

    def found(self, glass, *lamps, more=()):
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 6, 6], 'target': [0, 0, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'glass': {'type': 'dielectric'},
                          **{f'lamp{i}': {'base_color': [0, 0, 0], 'emission': [radiance] * 3}
                             for i, (_, radiance) in enumerate(lamps)}},
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0],
                        'v': [0, 0, -6]}, {**glass, 'material': 'glass'},
                       *({**shape, 'material': f'lamp{i}'} for i, (shape, _) in enumerate(lamps)), *more]})

    def test_of_bulbs(self):
        ball = {'type': 'sphere', 'center': [-0.5, 2, -2], 'radius': 0.3}
        bulb = {**ball, 'radius': 0.05}
        open_lamps = [{'type': 'sphere', 'center': [(i % 20 - 10) / 4, 2.5, -3 - (i // 20) / 4], 'radius': 0.02}
                      for i in range(199)]
        dim = [(lamp, 1e-6) for lamp in open_lamps]
        found = self.found(ball, (bulb, 10), *dim)
        self.assertEqual(found['light-by-chance']['level'], 'slow')
        self.assertGreater(found['light-by-chance']['share'], 0.5)
        self.assertRegex(found['light-by-chance']['figure'], r'^200 lamps.* (99\.\d|100) % of the light')
        self.assertNotIn('light-by-chance', self.found(ball, (bulb, 1e-6), *dim[1:], (open_lamps[0], 10)))
        # Half of the light, from a lamp of the same power in the open.
        figure = self.found(ball, (bulb, 10), ({**bulb, 'center': [0.5, 2, -2]}, 10))['light-by-chance']['figure']
        self.assertAlmostEqual(float(re.search(r'and ([\d.]+) %', figure)[1]), 50, delta=5)

    def test_of_two_rooms(self):
        """A bulb in a glass ball in one, and a lamp of 16 times its light in the other: all of the first
        room's light comes by chance."""
        ball = {'type': 'sphere', 'center': [-2, 3, -1], 'radius': 0.2}
        wall = {'type': 'box', 'material': 'grey', 'min': [-0.01, 0, -4], 'max': [0.01, 9, 4]}
        found = self.found(ball, ({**ball, 'radius': 0.05}, 10),
                           ({**ball, 'center': [2, 3, -1]}, 10), more=[wall])
        self.assertGreater(found['light-by-chance']['share'], 0.2)
        self.assertLess(found['light-by-chance']['share'], 0.5)

    def test_of_large_lamps(self):
        """A panel of many triangles that paths find easily, and one that they do not."""
        pane = {'type': 'box', 'min': [-4, 2, -4], 'max': [4, 2.1, 0]}
        for size, expected in ((0.3, True), (6, False)):
            self.write('panel.obj', ''.join(f'v {size * (i / 8 - 0.5)} {4} {size * (j / 8 - 0.5) - 2}\n'
                                            for j in range(9) for i in range(9))
                       + ''.join(f'f {k} {k + 1} {k + 10} {k + 9}\n' for j in range(8)
                                 for k in range(9 * j + 1, 9 * j + 9)))
            found = self.found(pane, ({'type': 'mesh', 'file': 'panel.obj'}, 1))
            self.assertEqual('light-by-chance' in found, expected, found)


class Window(Checks):
    """Eight suns of two texels each in an image, whose light falls into a room by its open side."""

    def scene(self, suns, glass, more=()):
        sky = [[(0.2, 0.2, 0.3)] * 64 for _ in range(32)]
        for row in (8, 9) if suns else ():
            for column in range(64):
                if column % 16 < 2:
                    sky[row][column] = (3e3, 3e3, 3e3)
        write_exr(os.path.join(self.folder.name, 'sky.exr'), 64, 32, sky)
        walls = [([-2, -2, -4], [4, 0, 0], [0, 4, 0]), ([-2, -2, 0], [0, 0, -4], [0, 4, 0]),
                 ([2, -2, 0], [0, 4, 0], [0, 0, -4]), ([-2, -2, 0], [4, 0, 0], [0, 0, -4]),
                 ([-2, 2, 0], [0, 0, -4], [4, 0, 0])]
        pane = {'type': 'box', 'material': 'glass', 'min': [-2.5, -2.5, 0.1], 'max': [2.5, 2.5, 0.2]}
        return {'camera': {'position': [0, 0, -0.1], 'target': [0, -0.3, -4], 'fov_degrees': 70},
                'environment': {'file': 'sky.exr'},
                'materials': {'grey': GREY, 'glass': {'type': 'dielectric'}},
                'shapes': [*({'type': 'quad', 'material': 'grey', 'corner': corner, 'u': u, 'v': v}
                             for corner, u, v in walls), *([pane] if glass else []), *more]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True, True))
        self.assert_found(found, {'light-by-chance': 'slow'})
        self.assertIn('glass', found['light-by-chance']['place'])
        self.assertIn('the environment', found['light-by-chance']['figure'])
        self.assertEqual(found['light-by-chance']['share'], 1)
        # A window of a hundredth of that.
        shutters = [{'type': 'quad', 'material': 'grey', 'corner': corner, 'u': u, 'v': v}
                    for corner, u, v in (([-2, -2, 0], [4, 0, 0], [0, 1.8, 0]),
                                         ([-2, 0.2, 0], [4, 0, 0], [0, 1.8, 0]),
                                         ([-2, -0.2, 0], [1.8, 0, 0], [0, 0.4, 0]),
                                         ([0.2, -0.2, 0], [1.8, 0, 0], [0, 0.4, 0]))]
        found = self.check(self.scene(True, True, shutters))
        self.assertEqual(found['light-by-chance']['share'], 1)
        self.assert_found(self.check(self.scene(True, False)), {})
        self.assert_found(self.check(self.scene(False, True)), {})  # which paths find easily


class Texels(Checks):
    def scene(self, planted):
        texels = [[(1.0, 1.0, 1.0)] * 32 for _ in range(16)]
        if planted:
            texels[3][7] = (2e5, 2e5, 2e5)
            texels[9][9] = (float('nan'), 1.0, 1.0)
            texels[9][10] = (-1.0, 1.0, 1.0)
        write_exr(os.path.join(self.folder.name, 'sky.exr'), 32, 16, texels)
        image = {'textures': [{'file': 'gone.png', 'parameters': {'base_color': 'rgb'}}]} if planted else {}
        return {'camera': FRONT, 'environment': {'file': 'sky.exr'},
                'settings': {'clamp': 100} if planted else {},
                'materials': {'grey': {**GREY, **image}},
                'shapes': [{'type': 'sphere', 'material': 'grey', 'center': [0, 0, 0], 'radius': 2}]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True))
        self.assert_found(found, {'missing-image': 'wrong', 'texels': 'wrong',
                                  'one-texel-sun': 'slow', 'beyond-half': 'remark',
                                  'biased-setting': 'wrong'})
        self.assertIn('2 of 512', found['texels']['figure'])
        self.assertIn('(7, 3)', found['one-texel-sun']['figure'])
        self.assertAlmostEqual(found['missing-image']['share'], 3.14159 * 4 / 36, delta=0.02)
        self.assert_found(self.check(self.scene(False)), {})


class Textures(Checks):
    """What textures make of a base colour of 1, which is the usual factor before an image."""

    def scene(self, texels, **material):
        write_exr(os.path.join(self.folder.name, 'paint.exr'), len(texels[0]), len(texels),
                  [[(x, x, x) for x in row] for row in texels])
        image = [{'file': 'paint.exr', 'parameters': {'base_color': 'rgb'}}]
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'materials': {'paint': {**material, 'base_color': [1, 1, 1], 'textures': image}},
                'shapes': [{'type': 'sphere', 'material': 'paint', 'center': [0, 0, 0], 'radius': 2}]}

    def test_gains(self):
        varnish = {'type': 'microfacet', 'roughness': 0.1, 'specular_color': [0.04] * 3,
                   'diffuse': 'uncoupled'}
        self.assert_found(self.check(self.scene([[0.05] * 4] * 4, **varnish)), {})
        # One bright texel reflects too much, whatever the mean of all is.
        found = self.check(self.scene([[0.05] * 4, [0.05, 0.05, 0.95, 0.05]], **varnish))
        self.assert_found(found, {'gains-light': 'wrong'})
        self.assertIn('paint', found['gains-light']['place'])

    def test_vertex_colors(self):
        varnish = {'type': 'microfacet', 'roughness': 0.1, 'specular_color': [0.04] * 3,
                   'diffuse': 'uncoupled', 'base_color': [1, 1, 1]}

        def scene(brightest):
            self.write('quad.ply', 'ply\nformat ascii 1.0\nelement vertex 4\n'
                       'property float x\nproperty float y\nproperty float z\nproperty uchar red\n'
                       'property uchar green\nproperty uchar blue\nelement face 1\n'
                       'property list uchar int vertex_indices\nend_header\n'
                       + ''.join(f'{x} {y} 0 {level} {level} {level}\n' for x, y, level in
                                 ((-1, -1, 9), (1, -1, 9), (1, 1, brightest), (-1, 1, 9)))
                       + '4 0 1 2 3\n')
            return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                    'materials': {'paint': varnish},
                    'shapes': [{'type': 'mesh', 'file': 'quad.ply', 'material': 'paint'}]}
        for instancing in ('auto', 'on'):
            self.assert_found(self.check(scene(20), '--instances', instancing), {})
            self.assert_found(self.check(scene(255), '--instances', instancing),
                              {'gains-light': 'wrong'})

    def test_white(self):
        self.assert_found(self.check(self.scene([[0.8] * 4] * 4)), {})
        self.assert_found(self.check(self.scene([[1, 0.8], [0.8, 0.8]])), {})
        self.assert_found(self.check(self.scene([[1, 1], [1, 0.8]])), {'albedo-1': 'remark'})
        found = self.check(self.scene([[2, 2], [2, 0.8]]))
        self.assert_found(found, {'albedo-1': 'remark', 'texels-above-1': 'remark'})
        self.assertIn('3 of 4 texels are above 1, up to 2', found['texels-above-1']['figure'])
        self.assertAlmostEqual(found['albedo-1']['share'], 3.14159 * 4 / 36, delta=0.02)


class Black(Checks):
    def test_light_inside_of_a_ball(self):
        def scene(place):
            return {'camera': FRONT, 'materials': {'grey': GREY},
                    'lights': [{'type': 'point', 'position': [0, 0, place], 'intensity': [5, 5, 5]}],
                    'shapes': [{'type': 'sphere', 'material': 'grey', 'center': [0, 0, 0], 'radius': 1}]}
        found = self.check(scene(0))
        self.assert_found(found, {'black': 'wrong'})
        self.assertEqual(found['black']['share'], 1)
        self.assert_found(self.check(scene(4)), {})


class Settings(Checks):
    def scene(self, bounces, **settings):
        return {'camera': {'position': [0, 0, 4], 'target': [0, 0, 0], 'fov_degrees': 60},
                'materials': {'pale': {'base_color': [0.85, 0.85, 0.85]}, 'lamp': {'emission': [9, 9, 9]}},
                'settings': {'max_bounces': bounces, **settings},
                'lights': [{'type': 'point', 'position': [1, 1, 1], 'intensity': [1, 1, 1]}],
                'shapes': [{'type': 'sphere', 'material': 'pale', 'center': [0, 0, 0], 'radius': 5},
                           {'type': 'sphere', 'material': 'lamp', 'center': [0, 0, -2], 'radius': 1}]}

    def test_depth(self):
        """In a closed sphere of albedo a, n bounces have all light but the part a^(n + 1)."""
        fixed = os.path.join(self.folder.name, 'fixed.json')
        found = self.check(self.scene(4, nee_depth=2), '--fix', fixed)
        self.assert_found(found, {'depth': 'wrong', 'biased-setting': 'wrong'})
        self.assertGreater(float(found['depth']['figure'].split('bring ')[1].split(' %')[0]), 20)
        self.assertEqual(found['depth']['change'], 'max_bounces is 64')
        self.assert_found(self.check_file(fixed), {})
        self.assert_found(self.check(self.scene(100)), {})

    def test_depth_asked_for(self):
        self.assert_found(self.check(self.scene(1)), {'depth': 'remark'})


class Noise(Checks):
    def scene(self, radius):
        """A lamp of 1 W/sr over a floor with a ball of rough metal."""
        radiance = 1 / (3.14159 * radius ** 2)
        return {'camera': {'position': [0, 3, 6], 'target': [0, 0.5, 0], 'fov_degrees': 40},
                'materials': {'grey': GREY, 'metal': {'type': 'conductor', 'roughness': 0.3},
                              'lamp': {'base_color': [0, 0, 0], 'emission': [radiance] * 3}},
                'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0],
                            'v': [0, 0, -6]},
                           {'type': 'sphere', 'material': 'metal', 'center': [0, 1, 0], 'radius': 1},
                           {'type': 'sphere', 'material': 'lamp', 'center': [1.6, 2, 0],
                            'radius': radius}]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(1e-3))
        self.assert_found(found, {'heavy-tail': 'slow', 'tiny-lights': 'slow'})
        self.assertIn('material "metal"', found['heavy-tail']['place'])
        self.assert_found(self.check(self.scene(0.3)), {})


class TinyPictures(Checks):
    def test_pixels_are_no_lamps(self):
        """A lamp of some pixels has edges of less than a pixel."""
        path = os.path.join(SOURCE, 'scenes', 'cornell.json')
        for size in ('8x8', '12x12', '16x16'):
            self.assertNotIn('tiny-lights', self.check_file(path, '--size', size))


class Outlook(Checks):
    def lines(self, radius):
        """Of a floor onto which a mirror ball throws the light of a lamp that is not in the picture."""
        radiance = 0.3 / radius ** 2
        path = self.write('scene.json', {
            'lampyris': 1, 'film': {'width': 24, 'height': 24},
            'camera': {'position': [2.2, 1.2, 3.2], 'target': [2, 0, 0.8], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'mirror': {'type': 'conductor', 'roughness': 0},
                          'lamp': {'base_color': [0, 0, 0], 'emission': [radiance] * 3}},
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0],
                        'v': [0, 0, -6]},
                       {'type': 'sphere', 'material': 'mirror', 'center': [0, 1, 0], 'radius': 1},
                       {'type': 'sphere', 'material': 'lamp', 'center': [1.6, 2, 0],
                        'radius': radius}]})
        return subprocess.run([LAMPYRIS, 'check', path, '-q'], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=600).stdout

    def test_why_it_is_a_bound(self):
        """Caustics that no sample has met are in no finding, but the outlook allows for them."""
        self.assertRegex(self.lines(0.01), 'takes at most [0-9]{6} spp, .*; at most, since no sample '
                         'has found the brightest light that chance may find\n$')
        self.assertRegex(self.lines(0.1), 'takes about [0-9]{4} spp, .* on the device\n$')


class Range(Checks):
    def scene(self, height):
        """The point below a light of 1e30 W/sr."""
        return {'camera': {**FRONT, 'height': 6e-6}, 'materials': {'grey': GREY},
                'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-4, -4, 0], 'u': [8, 0, 0],
                            'v': [0, 8, 0]}],
                'lights': [{'type': 'point', 'position': [0, 0, height], 'intensity': [1e30] * 3}]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(1e-5))  # 1e40 W/m^2
        self.assert_found(found, {'not-finite': 'wrong'})
        # Two renders of 64 samples a pixel; what is found looks at the last one of them.
        self.assertRegex(found['not-finite']['figure'], f'^{64 * 48 * 48} contributions of ')
        self.assert_found(self.check(self.scene(1e-3)), {})


class Slow(Checks):
    def test_fewer_pixels(self):
        """A simulated slow device, which sleeps: the check's own renders have a bound."""
        environment = {**os.environ, 'LAMPYRIS_LIMITS': 'no-timestamps,group-ns=600000'}
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        result = subprocess.run([LAMPYRIS, 'check', scene, '--size', '64x64', '--json', '-q'], text=True,
                                stdout=subprocess.PIPE, timeout=300, env=environment)
        self.assertEqual(result.returncode, 0)
        found = {finding['name']: finding for finding in json.loads(result.stdout)['findings']}
        self.assert_found(found, {'few-pixels': 'remark'})
        seconds = re.match(r'one sample of 4096 pixels takes (\S+) s', found['few-pixels']['figure'])[1]
        width, height = re.search(r'picture of (\d+) x (\d+) pixels only',
                                  found['few-pixels']['consequence']).groups()
        self.assertGreater(float(seconds), 0.2)
        # Its 200 samples of each pixel; seconds have two digits, and pixels are in squares.
        self.assertAlmostEqual(int(width) * int(height) / 4096 * 200 * float(seconds), 30, delta=3)


class Memory(Checks):
    def test_too_little_for_usual_waves(self):
        """Each of a check's renders has what there is, and does with smaller waves, as all renders."""
        scene = {'camera': FRONT, 'materials': {'plastic': {'type': 'principled', 'roughness': 0.4}},
                 'environment': {'radiance': [1, 1, 1]}, 'film': {'width': 64, 'height': 64},
                 'shapes': [{'type': 'sphere', 'material': 'plastic', 'center': [0, 0, 0], 'radius': 2}]}
        for limit in ('memory', 'memory-budget'):
            for most in (1000000, 3000000):
                with unittest.mock.patch.dict(os.environ, LAMPYRIS_LIMITS=f'{limit}={most}'):
                    self.assert_found(self.check(scene), {})
                self.assertLess(self.result['outlook']['device_bytes'], most)


def read_png(data):
    """Rows of (r, g, b) of 8 bits."""
    assert data[:8] == b'\x89PNG\r\n\x1a\n' and data[24:26] == b'\x08\x02', data[:26]
    width, height = struct.unpack('>II', data[16:24])
    packed, at = b'', 8
    while at < len(data):
        size = struct.unpack('>I', data[at:at + 4])[0]
        packed += data[at + 8:at + 8 + size] if data[at + 4:at + 8] == b'IDAT' else b''
        at += size + 12
    raw, rows, above = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        kind, row = raw[y * (3 * width + 1)], bytearray(raw[y * (3 * width + 1) + 1:][:3 * width])
        for i, value in enumerate(row):
            a, b, c = (row[i - 3], above[i], above[i - 3]) if i >= 3 else (0, above[i], 0)
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[i] = (value + (0, a, b, (a + b) // 2, paeth)[kind]) % 256
        above = bytes(row)
        rows.append([tuple(row[i:i + 3]) for i in range(0, 3 * width, 3)])
    return rows


class Report(Checks):
    def test_pictures_mark_the_places(self):
        """As much of a finding's picture is red as its share says: of a white ball, pi / 9."""
        page = os.path.join(self.folder.name, 'page.html')
        found = self.check({'camera': FRONT, 'materials': {'white': {'base_color': [1, 1, 1]}},
                            'environment': {'radiance': [1, 1, 1]},
                            'shapes': [{'type': 'sphere', 'material': 'white', 'center': [0, 0, 0],
                                        'radius': 2}]}, '--report', page)
        self.assert_found(found, {'albedo-1': 'remark'})
        with open(page, encoding='utf-8') as file:
            text = file.read()
        self.assertIn('<h2>albedo-1</h2>', text)
        for part in ('place', 'figure', 'consequence', 'remedy'):
            self.assertIn(html.escape(found['albedo-1'][part]), text)
        plain, marked = (read_png(base64.b64decode(data))
                         for data in re.findall('src="data:image/png;base64,([^"]*)"', text))
        self.assertEqual([(len(rows), len(rows[0])) for rows in (plain, marked)], 2 * [(48, 48)])
        red = [(r > g) for row in marked for r, g, _ in row]
        self.assertTrue(red[24 * 48 + 24] and not red[0])
        self.assertAlmostEqual(sum(red) / len(red), found['albedo-1']['share'])
        self.assertAlmostEqual(found['albedo-1']['share'], 3.14159 / 9, delta=0.01)

    def test_what_cannot_be_written_is_found_first(self):
        """Before there is a device: with none at all the file is what is wrong."""
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        environment = {**os.environ, 'VK_ICD_FILENAMES': '/nowhere', 'VK_DRIVER_FILES': '/nowhere'}
        for page, code in ((scene, 2), (os.path.join(self.folder.name, 'no', 'page.html'), 4),
                           (os.path.join(self.folder.name, 'page.html'), 69)):
            result = subprocess.run([LAMPYRIS, 'check', scene, '--report', page], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                                    env=environment)
            self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(os.listdir(self.folder.name), [])


class Words(Checks):
    def test_extreme_pictures(self):
        """Nothing to see but light; a row of pixels; a single one."""
        for film in ({'width': 16384, 'height': 1}, {'width': 1, 'height': 1}):
            self.assert_found(self.check({
                'camera': {'position': [0, 0, 8], 'target': [0, 0, 0], 'fov_degrees': 40},
                'environment': {'radiance': [1, 1, 1]}, 'film': film, 'shapes': []}), {})

    def test_what_cannot_be_fixed_is_found_first(self):
        """Before there is a device: with none at all the file is what is wrong."""
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        environment = {**os.environ, 'VK_ICD_FILENAMES': '/nowhere', 'VK_DRIVER_FILES': '/nowhere'}
        for out, code in ((scene, 2), (os.path.join(self.folder.name, 'out.txt'), 2),
                          (os.path.join(self.folder.name, 'no', 'out.json'), 4),
                          (os.path.join(self.folder.name, 'out.json'), 69)):
            result = subprocess.run([LAMPYRIS, 'check', scene, '--fix', out], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                                    env=environment)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertFalse(out != scene and os.path.exists(out))

    def test_what_is_of_devices_is_refused(self):
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        for arguments in (['--long'], ['--list'], ['--only', 'bits']):
            result = subprocess.run([LAMPYRIS, 'check', scene, *arguments], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(f'{arguments[0]} is of devices', result.stderr)

    @unittest.skipUnless(os.path.exists('/dev/full'), 'there is no /dev/full')
    def test_a_finding_that_cannot_be_written(self):
        """What has not arrived is told, not what it would have said."""
        quad = {'type': 'quad', 'corner': [-1, -1, 0], 'u': [2, 0, 0], 'v': [0, 2, 0]}
        path = self.write('twice.json', {
            'lampyris': 1, 'film': FILM, 'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
            'shapes': [{**quad, 'material': 'grey'}, {**quad, 'material': 'red'}]})
        for out, code in (('/dev/null', 1), ('/dev/full', 4)):
            with open(out, 'w', encoding='utf-8') as file:
                result = subprocess.run([LAMPYRIS, 'check', path, '-q'], stdout=file, text=True,
                                        stderr=subprocess.PIPE, timeout=600)
            self.assertEqual(result.returncode, code, result.stderr)

    def test_a_clean_scene_is_one_line(self):
        path = os.path.join(SOURCE, 'scenes', 'cornell.json')
        result = subprocess.run([LAMPYRIS, 'check', path, '--size', '48x48', '-q'], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=600)
        self.assertEqual((result.returncode, result.stdout.count('\n')), (0, 1), result.stdout)
        self.assertRegex(result.stdout, r'nothing in it is stiff or extreme; local relMSE 0.001 '
                         r'takes .* spp, .* s of rendering and .* MiB on the device')


if __name__ == '__main__':
    unittest.main()
