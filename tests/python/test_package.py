#!/usr/bin/python3
"""Tests the Python package in the build folder: `PYTHONPATH=BUILD/python test_package.py LAMPYRIS
SOURCE_ROOT`.

With LAMPYRIS_WITHOUT_NUMPY in the environment, numpy is not to be had; without it, it must be there.
"""
import array
import ast
import ctypes
import gc
import json
import logging
import math
import os
import pickle
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import program

WITHOUT = 'LAMPYRIS_WITHOUT_NUMPY' in os.environ
if WITHOUT:
    sys.modules['numpy'] = None
    numpy = None
else:
    import numpy

import lampyris
from lampyris import _arrays, _native

LAMPYRIS, SOURCES = sys.argv.pop(1), os.path.abspath(sys.argv.pop(1))
CORNELL = os.path.join(SOURCES, 'scenes', 'cornell.json')
SMALL = {'size': (32, 24), 'spp': 8}
ROOM = {'environment': {'radiance': [1, 1, 1]},
        'camera': {'position': [0.3, 0.3, 3], 'target': [0.3, 0.3, 0], 'fov_degrees': 40},
        'materials': {'red': {'base_color': [0.8, 0.1, 0.1]}}}
POSITIONS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0.5)]
INDICES = [(0, 1, 2), (2, 1, 3)]


def hash_of_program(*arguments):
    with tempfile.TemporaryDirectory() as folder:
        said = program.checked(LAMPYRIS, 'render', *arguments, '--json', '-o', os.path.join(folder, 'x.exr'))
    return re.search('"image_hash": "([0-9a-f]{16})"', said).group(1)


class Pictures(unittest.TestCase):
    def test_bits_are_those_of_the_program(self):
        picture = lampyris.render(CORNELL, **SMALL, seed=3)
        self.assertEqual(picture.hash, hash_of_program(CORNELL, '--size', '32x24', '--spp', '8', '--seed', '3'))
        command = shlex.split(picture.repeat)
        self.assertEqual(command[:2], ['lampyris', 'render'])
        self.assertEqual(hash_of_program(*command[2:]), picture.hash)

    def test_a_picture_says_how_good_it_is_and_what_it_cost(self):
        picture = lampyris.render(CORNELL, **SMALL)
        self.assertTrue(picture.error)
        self.assertTrue(picture.error.low < float(picture.error) < picture.error.high)
        self.assertIsNone(picture.error.why)
        self.assertRegex(repr(picture), r'^<Picture 32x24, 8 samples, local relMSE 0\.\d+, 95 % interval ')
        self.assertGreater(picture.seconds.render, 0)
        self.assertGreater(picture.rays.closest, 0)
        self.assertEqual((picture.samples, picture.ended_by, picture.stopped), (8, 'spp', False))
        one = lampyris.render(CORNELL, size=(8, 8), spp=1)
        self.assertFalse(one.error)
        self.assertTrue(math.isnan(float(one.error)))
        self.assertIn('fewer than two samples', one.error.why)
        self.assertIn(one.error.why, str(one.error))

    def test_layers(self):
        picture = lampyris.render(CORNELL, **SMALL, aovs=['depth', 'ids', 'halves'])
        self.assertEqual(list(picture.layers), ['radiance', 'depth', 'id', 'half_a', 'half_b'])
        self.assertEqual(picture.array.shape, (24, 32, 3))
        self.assertEqual(picture['depth'].shape, (24, 32))
        self.assertEqual(picture.channels['id'], ['object', 'material', 'primitive'])
        for y, x in ((0, 0), (11, 30), (-1, -1)):
            for c in range(3):
                mean = (picture['half_a'][y, x][c] + picture['half_b'][y, x][c]) / 2
                self.assertAlmostEqual(picture.array[y, x][c], mean, delta=1e-5 * (1 + mean))
            self.assertIsInstance(picture['id'][y, x][0], int)
        self.assertEqual(picture.array.view[3, 4, 1], picture.array[3, 4][1])
        self.assertEqual(picture.array.tolist()[3][4], list(picture.array[3, 4]))
        self.assertEqual(picture.array[3][4], picture.array[3, 4])
        with self.assertRaisesRegex(KeyError, 'the picture has radiance, depth'):
            picture['albedo']
        with self.assertRaises(IndexError):
            picture.array[24, 0]

    def test_files_have_the_same_pixels(self):
        picture = lampyris.render(CORNELL, **SMALL, aovs=['depth'])
        with tempfile.TemporaryDirectory() as folder:
            path, other = os.path.join(folder, 'a.exr'), os.path.join(folder, 'b.exr')
            picture.save(path)
            self.assertEqual(lampyris.read(path).tolist(), picture.array.tolist())
            program.checked(LAMPYRIS, 'render', CORNELL, '--size', '32x24', '--spp', '8', '-o', other)
            same = lampyris.compare(path, other)
            self.assertEqual((same.mse.value, same.pixels_differing, same.flip), (0, 0, 0))
            picture.save(os.path.join(folder, 'half.exr'), half=True)
            half = lampyris.compare(os.path.join(folder, 'half.exr'), picture)
            self.assertGreater(half.pixels_differing, 0)
            self.assertLess(half.relmse.value, 1e-5)
            with self.assertRaises(lampyris.OutputError) as raised:
                picture.save(os.path.join(folder, 'none', 'a.exr'))
            self.assertEqual(raised.exception.path, os.path.join(folder, 'none', 'a.exr'))
        self.assertTrue(picture._repr_png_().startswith(b'\x89PNG'))
        self.assertIn('local relMSE', picture._repr_html_())

    def test_progressive_pictures_are_of_one_render(self):
        pictures = list(lampyris.progressive(CORNELL, size=(32, 24), spp=6))
        self.assertEqual([picture.samples for picture in pictures], [1, 2, 4, 6])
        whole = lampyris.render(CORNELL, size=(32, 24), spp=6)
        self.assertEqual(pictures[-1].hash, whole.hash)
        self.assertNotEqual(pictures[0].array.tolist(), pictures[-1].array.tolist())
        with self.assertRaisesRegex(lampyris.InputError, 'has made another step since'):
            pictures[0].save('never.exr')
        pictures = list(lampyris.progressive(CORNELL, size=(32, 24), error=0.05))
        self.assertLess(pictures[-1].error.at_most, 0.05)
        self.assertGreater(len(pictures), 2)
        timed = list(lampyris.progressive(CORNELL, size=(16, 16), seconds=0.2))
        self.assertEqual(timed[-1].ended_by, 'time')

    def test_steps_and_checkpoints(self):
        whole = lampyris.render(CORNELL, **SMALL)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'a.ck')
            with lampyris.Render(lampyris.load(CORNELL), **SMALL) as render:
                self.assertTrue(render.step(3))
                render.checkpoint(path)
                self.assertEqual(render.picture().samples, 3)
            resumed = lampyris.render(CORNELL, **SMALL, resume=path)
        self.assertEqual(resumed.hash, whole.hash)
        with self.assertRaisesRegex(lampyris.InputError, 'the render is closed'):
            render.step()

    def test_parts_that_are_left_out(self):
        parts = lampyris.render(CORNELL, **SMALL).render.parts
        left_out = [part for part in parts if part.is_left_out]
        self.assertGreater(len(left_out), 20)
        self.assertTrue(all(part.reason for part in left_out))

    def test_devices(self):
        self.assertGreater(len(lampyris.devices()), 0)
        self.assertTrue(lampyris.devices()[0].name)
        with lampyris.Context(device='no such device') as context, \
                self.assertRaisesRegex(lampyris.InputError, 'no such device'):
            lampyris.render(CORNELL, **SMALL, context=context)


class Scenes(unittest.TestCase):
    def test_values_by_pointers(self):
        scene = lampyris.load(CORNELL)
        first = lampyris.render(scene, **SMALL).hash
        former = scene['/materials/red']
        scene['/materials/red/base_color'] = (.1, .2, .9)
        self.assertEqual(scene['/materials/red/base_color'], [.1, .2, .9])
        blue = lampyris.render(scene, **SMALL)
        self.assertEqual(blue.hash, hash_of_program(CORNELL, '--size', '32x24', '--spp', '8', '-D',
                                                    'materials.red.base_color=[0.1, 0.2, 0.9]'))
        self.assertEqual(hash_of_program(*shlex.split(blue.repeat)[2:]), blue.hash)
        scene['/materials/red'] = former
        self.assertEqual(lampyris.render(scene, **SMALL).hash, first)
        self.assertIn('/materials/red', scene)
        del scene['/materials/red']
        self.assertNotIn('/materials/red', scene)

    def test_a_dict_is_a_scene(self):
        with open(CORNELL, encoding='utf-8') as file:
            document = json.load(file)
        self.assertEqual(lampyris.render(document, **SMALL).hash, lampyris.render(CORNELL, **SMALL).hash)
        self.assertIsNone(lampyris.render(document, **SMALL).repeat)
        self.assertEqual(lampyris.Scene(ROOM).document, {'lampyris': 1, **ROOM})

    def test_names_that_a_file_defines(self):
        path = os.path.join(SOURCES, 'scenes', 'mesh_room.json')
        mesh = os.path.join(SOURCES, 'scenes', 'models', 'knot.ply')
        picture = lampyris.render(lampyris.load(path, mesh=mesh), size=(16, 16), spp=2)
        self.assertEqual(picture.hash, hash_of_program(path, '-D', f'mesh={mesh}', '--size', '16x16', '--spp',
                                                       '2'))

    def test_errors_say_where_and_what(self):
        scene = lampyris.Scene({'materials': {'red': {'type': 'principled', 'roughness': 1.7}}})
        with self.assertRaises(lampyris.InputError) as raised:
            scene.check()
        error = raised.exception
        self.assertEqual((error.path, error.pointer, error.expected),
                         ('document.json', '/materials/red/roughness', '[0, 1]'))
        self.assertIsInstance(error, ValueError)
        self.assertEqual(error.status, 2)
        copy = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(copy), copy.pointer), (str(error), error.pointer))
        with self.assertRaises(lampyris.InputError) as raised:
            lampyris.load('none.json')
        self.assertEqual(raised.exception.path, 'none.json')
        with self.assertRaisesRegex(lampyris.InputError, 'did you mean spp'):
            lampyris.render(CORNELL, spq=3)
        with self.assertRaises(ValueError):
            scene['/materials/red/roughness'] = math.nan
        with self.assertRaises(TypeError):
            scene['/materials/red'] = object()

    def test_messages_are_logged(self):
        with self.assertLogs('lampyris', logging.INFO) as logs:
            lampyris.load(os.path.join(SOURCES, 'scenes', 'models', 'knot.ply')).check()
        self.assertIn('light', ' '.join(logs.output))


class Meshes(unittest.TestCase):
    def hash(self, positions=POSITIONS, indices=INDICES, **more):
        scene = lampyris.Scene(ROOM)
        scene.mesh('pair', positions, indices, material='red', **more)
        return lampyris.render(scene, **SMALL).hash

    def test_sequences_and_buffers(self):
        expected = self.hash()
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, 'pair.obj'), 'w', encoding='utf-8') as file:
                file.write(''.join('v %g %g %g\n' % position for position in POSITIONS))
                file.write(''.join('f %d %d %d\n' % tuple(i + 1 for i in face) for face in INDICES))
            shapes = [{'type': 'mesh', 'file': 'pair.obj', 'material': 'red'}]
            scene = lampyris.Scene({**ROOM, 'shapes': shapes}, folder=folder)
            self.assertEqual(lampyris.render(scene, **SMALL).hash, expected)
        flat = array.array('f', [number for position in POSITIONS for number in position])
        self.assertEqual(self.hash(flat, array.array('I', [0, 1, 2, 2, 1, 3])), expected)
        soup = [POSITIONS[i] for face in INDICES for i in face]
        self.assertEqual(self.hash(soup, None), expected)
        self.assertNotEqual(self.hash(colors=[(1, 0, 0, 1)] * 4), expected)
        self.assertNotEqual(self.hash(normals=[(0, .6, .8)] * 4), expected)

    def test_a_mesh_is_replaced_and_placed(self):
        scene = lampyris.Scene(ROOM)
        scene.mesh('pair', POSITIONS, INDICES, material='red')
        first = lampyris.render(scene, **SMALL).hash
        scene['/shapes/0/transform'] = {'scale': .5}
        self.assertNotEqual(lampyris.render(scene, **SMALL).hash, first)
        scene.mesh('pair', [tuple(2 * x for x in position) for position in POSITIONS], INDICES)
        self.assertEqual(lampyris.render(scene, **SMALL).hash, first)
        self.assertEqual(len(scene['/shapes']), 1)

    def test_what_is_wrong_is_said(self):
        for arguments, message in (
                (([(0, 0)], INDICES), 'pair: positions: element 0 is'),
                (([0, 1, 2, 3], INDICES), 'there are 4 numbers; expected 3 numbers'),
                ((POSITIONS, [(0, 1, -1)]), 'an index is'),
                ((POSITIONS, [(0, 1, 9)]), r'indices\[0\]\[2\]: 9; expected less than 4')):
            with self.assertRaisesRegex(lampyris.InputError, message):
                self.hash(*arguments)
        with self.assertRaisesRegex(lampyris.InputError, 'normals: there are 1 elements; expected 4'):
            self.hash(normals=[(0, 0, 1)])

    def test_the_arrays_are_kept(self):
        scene = lampyris.Scene(ROOM)
        scene.mesh('pair', list(POSITIONS), list(INDICES), material='red')
        gc.collect()
        junk = [(ctypes.c_float * 12)(*[9] * 12) for _ in range(100)]
        self.assertEqual(lampyris.render(scene, **SMALL).hash, self.hash())
        del junk


@unittest.skipIf(WITHOUT, 'without numpy')
class Numpy(unittest.TestCase):
    def test_pixels_are_not_copied(self):
        picture = lampyris.render(CORNELL, **SMALL, aovs=['ids', 'depth'])
        for pixels, dtype in ((picture, 'float32'), (picture.array, 'float32'), (picture['id'], 'uint32'),
                              (picture['depth'], 'float32')):
            values = numpy.asarray(pixels)
            self.assertEqual(values.dtype, dtype)
            again = numpy.asarray(pixels)
            self.assertTrue(numpy.shares_memory(values, again))
        values = numpy.asarray(picture)
        self.assertEqual(values.shape, (24, 32, 3))
        self.assertEqual(values.tolist(), picture.array.tolist())

    def test_arrays_of_the_right_type_are_not_copied(self):
        records = numpy.zeros(1000, [('weight', 'f4'), ('position', 'f4', 3)])
        for values in (numpy.zeros((1000, 3), 'f4'), numpy.zeros((1000, 5), 'f4')[:, 1:4],
                       numpy.zeros((2000, 3), 'f4')[::2], records['position'], numpy.zeros(3000, 'f4')):
            given = _arrays.take(values, 'x', 3)
            self.assertEqual((given.address, given.count), (values.__array_interface__['data'][0], 1000))
        for values in (numpy.zeros((1000, 3)), numpy.zeros((3, 1000), 'f4').T, numpy.zeros((1000, 3), 'f4')[::-1]):
            given = _arrays.take(values, 'x', 3)
            self.assertNotEqual(given.address, values.__array_interface__['data'][0])
            self.assertEqual((given.count, given.stride), (1000, 12))

    def test_meshes(self):
        def render(positions, indices):
            scene = lampyris.Scene(ROOM)
            scene.mesh('pair', positions, indices, material='red')
            return lampyris.render(scene, **SMALL).hash
        expected = render(POSITIONS, INDICES)
        wide = numpy.full((4, 7), 99, 'f4')
        wide[:, 2:5] = POSITIONS
        for positions in (numpy.array(POSITIONS), numpy.array(POSITIONS, 'f4'), wide[:, 2:5],
                          numpy.array(POSITIONS[::-1], 'f4')[::-1]):
            for indices in (numpy.array(INDICES), numpy.array(INDICES, 'u4')):
                self.assertEqual(render(positions, indices), expected)
        with self.assertRaisesRegex(lampyris.InputError, 'an index is -1'):
            render(POSITIONS, numpy.array([[0, 1, -1]]))

    def test_numbers_go_into_documents(self):
        scene = lampyris.Scene(ROOM)
        scene['/materials/red/base_color'] = numpy.array([.5, .25, .125])
        scene['/camera/fov_degrees'] = numpy.float32(35)
        self.assertEqual(scene['/materials/red/base_color'], [.5, .25, .125])
        self.assertEqual(scene['/camera/fov_degrees'], 35)

    def test_comparison_of_arrays(self):
        picture = lampyris.render(CORNELL, **SMALL)
        values = numpy.asarray(picture).copy()
        self.assertEqual(lampyris.compare(values, picture).mse.value, 0)
        brighter = lampyris.compare(values * numpy.float32(1.5), values)
        expected = numpy.mean((.5 * values.astype('f8')) ** 2)
        self.assertAlmostEqual(brighter.mse.value, expected, delta=1e-5 * expected)
        self.assertEqual(lampyris.compare(values[::-1], values[::-1].tolist()).mse.value, 0)

    def test_a_million_triangles_long(self):
        side = 708
        x, y = numpy.meshgrid(numpy.linspace(-1, 1, side, dtype='f4'), numpy.linspace(-1, 1, side, dtype='f4'))
        positions = numpy.stack([x, y, .1 * numpy.sin(9 * x) * numpy.sin(9 * y)], -1).reshape(-1, 3)
        corner = (numpy.arange(side - 1)[:, None] * side + numpy.arange(side - 1)).reshape(-1, 1)
        indices = numpy.concatenate([corner + [0, 1, side], corner + [side, 1, side + 1]]).astype('u4')
        self.assertGreater(len(indices), 999000)
        scene = lampyris.Scene(ROOM)
        scene.mesh('waves', positions, indices, material='red')
        kept = scene._kept['waves']
        self.assertEqual([given.address for given in kept],
                         [values.__array_interface__['data'][0] for values in (positions, indices)])
        picture = lampyris.render(scene, size=(64, 64), spp=4)
        self.assertGreater(numpy.asarray(picture).mean(), .05)


class Calls(unittest.TestCase):
    def test_callbacks(self):
        heard = []
        picture = lampyris.render(CORNELL, **SMALL, progress=heard.append)
        self.assertFalse(picture.stopped)
        self.assertTrue({'Loading', 'Building BVH', 'Rendering'} <= {moment.phase for moment in heard})
        self.assertTrue(all(0 <= moment.fraction <= 1 for moment in heard))
        with self.assertRaises(lampyris.Stopped):
            lampyris.render(CORNELL, **SMALL, progress=lambda moment: False)
        stopped = lampyris.render(CORNELL, size=(64, 64), spp=4096,
                                  progress=lambda moment: moment.phase != 'Rendering')
        self.assertTrue(stopped.stopped)
        self.assertLess(stopped.samples, 4096)
        self.assertIsNone(stopped.repeat if stopped.pixels_without_samples else None)

        def fail(moment):
            if moment.phase == 'Rendering':
                raise ArithmeticError('mine')
        with self.assertRaisesRegex(ArithmeticError, 'mine'):
            lampyris.render(CORNELL, **SMALL, progress=fail)

        def use(_):
            lampyris.devices()
        with self.assertRaisesRegex(lampyris.InputError, 'a callback used the context'):
            lampyris.render(CORNELL, **SMALL, progress=use)
        self.assertEqual(lampyris.render(CORNELL, **SMALL).hash, picture.hash)

    def interrupt(self, **settings):
        """Begins a render that would take hours, and interrupts it as soon as it renders."""
        rendering = threading.Event()

        def told(moment):
            if moment.phase == 'Rendering':
                rendering.set()

        def kill():
            rendering.wait()
            os.kill(os.getpid(), signal.SIGINT)
        former = signal.signal(signal.SIGINT, signal.default_int_handler)
        thread = threading.Thread(target=kill)
        thread.start()
        try:
            return lampyris.render(CORNELL, size=(64, 64), progress=told, **settings)
        finally:
            rendering.set()
            thread.join()
            self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
            signal.signal(signal.SIGINT, former)

    def test_ctrl_c_returns_the_picture_so_far(self):
        picture = self.interrupt(spp=2 ** 24)
        self.assertTrue(picture.stopped)
        self.assertGreater(picture.samples + picture.pixels_without_samples, 0)
        self.assertEqual(picture.array.shape, (64, 64, 3))

    def test_ctrl_c_before_there_is_a_picture(self):
        former = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with self.assertRaises(KeyboardInterrupt):
                lampyris.render(CORNELL, **SMALL, progress=lambda _: os.kill(os.getpid(), signal.SIGINT))
        finally:
            signal.signal(signal.SIGINT, former)

    def test_threads_share_a_context_or_have_their_own(self):
        expected, hashes = lampyris.render(CORNELL, **SMALL).hash, []

        def work(context):
            for _ in range(3):
                hashes.append(lampyris.render(CORNELL, **SMALL, context=context).hash)
        contexts = [None, None, lampyris.Context(), lampyris.Context()]
        threads = [threading.Thread(target=work, args=(context,)) for context in contexts]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(hashes, 12 * [expected])

    def test_memory_comes_back(self):
        def resident():
            with open('/proc/self/statm', encoding='ascii') as file:
                return int(file.read().split()[1])
        with lampyris.Context() as context:
            gc.disable()  # so that objects are only freed by reference counts
            self.addCleanup(gc.enable)
            for i in range(120):
                lampyris.render(CORNELL, size=(16, 16), spp=1, context=context)
                if i == 40:
                    before = resident()
        # A leaked render would keep at least its scene and its film, which are more than two pages each.
        self.assertLess(resident() - before, 160)

    def test_nothing_is_said_at_exit(self):
        code = ('import lampyris\nimport sys\n'
                'kept = lampyris.render(sys.argv[1], size=(8, 8), spp=1)\n'
                'scene = lampyris.load(sys.argv[1])\nloop = [kept, scene]\nloop.append(loop)\n')
        result = subprocess.run([sys.executable, '-X', 'dev', '-c', code, CORNELL], stderr=subprocess.PIPE,
                                text=True, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ''))


class Package(unittest.TestCase):
    def test_structs_are_those_of_the_header(self):
        """The sizes and offsets of the structs equal those that a C compiler computes."""
        structs = [cls for cls in vars(_native).values()
                   if isinstance(cls, type) and issubclass(cls, ctypes.Structure) and hasattr(cls, '_fields_')]
        self.assertGreater(len(structs), 12)
        lines, expected = [], []
        for cls in structs:
            name = 'lampyris' + re.sub('([A-Z])', lambda m: '_' + m.group(1).lower(), cls.__name__)
            lines.append(f'printf("{name} %zu\\n", sizeof(struct {name}));')
            expected.append(f'{name} {ctypes.sizeof(cls)}')
            for field, _ in cls._fields_:
                lines.append(f'printf("{field} %zu\\n", offsetof(struct {name}, {field}));')
                expected.append(f'{field} {getattr(cls, field).offset}')
        source = ('#include <lampyris/lampyris.h>\n#include <stdio.h>\nint main(void)\n{\n' +
                  '\n'.join(lines) + '\nreturn 0;\n}\n')
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'a.out')
            subprocess.run(['cc', '-x', 'c', '-', '-I', os.path.join(SOURCES, 'include'), '-o', path],
                           input=source, text=True, check=True)
            said = subprocess.run([path], stdout=subprocess.PIPE, text=True, check=True).stdout
        self.assertEqual(said.split('\n')[:-1], expected)

    def test_functions_are_those_of_the_header(self):
        with open(os.path.join(SOURCES, 'tests', 'library', 'interface.txt'), encoding='utf-8') as file:
            declared = re.findall(r'\blampyris_(\w+)\(([^)]*)\);', file.read())
        self.assertEqual({name for name, _ in declared}, set(_native.FUNCTIONS))
        for name, arguments in declared:
            count = 0 if arguments == 'void' else arguments.count(',') + 1
            self.assertEqual(len(_native.FUNCTIONS[name]) - 1, count, name)

    def test_stubs_have_all_that_is_public(self):
        with open(os.path.join(os.path.dirname(lampyris.__file__), '__init__.pyi'), encoding='utf-8') as file:
            tree = ast.parse(file.read())
        stubs = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(set(stubs), set(lampyris.__all__))
        for name, node in stubs.items():
            value = getattr(lampyris, name)
            if isinstance(node, ast.FunctionDef):
                continue
            members = {each.name for each in node.body if isinstance(each, ast.FunctionDef)}
            for member in members:
                self.assertTrue(hasattr(value, member), f'{name}.{member}')
            told = members | {each.target.id for each in node.body if isinstance(each, ast.AnnAssign)}
            inherited = set(dir(value.__base__))
            public = {member for member in vars(value) if not member.startswith('_')} - inherited
            if not issubclass(value, tuple):
                self.assertEqual(public - told, set(), name)

    def test_numpy_is_not_imported(self):
        code = 'import sys, lampyris\nassert "numpy" not in sys.modules'
        subprocess.run([sys.executable, '-c', code], check=True)


if __name__ == '__main__':
    program.need_device(LAMPYRIS)
    if not any(argument.endswith('_long') for argument in sys.argv[1:]):
        del Numpy.test_a_million_triangles_long
    unittest.main()
