#!/usr/bin/env python3
"""Numbered pictures: turntables, animations, their names, what they cost, how they go on after an
interruption, and their videos.

Usage: test_sequences.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import base64
import json
import math
import os
import shutil
import signal
import stat
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))
import program

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SOURCE = os.path.abspath(sys.argv.pop(1))
ROOM = {'lampyris': 1, 'environment': {'radiance': [1, 1, 1]},
        'camera': {'position': [0, 0.4, 4], 'target': [0, 0, 0], 'up': [0.3, 1, 0],
                   'fov_degrees': 30},
        'materials': {'a': {'base_color': [0.8, 0.2, 0.1]}, 'b': {'base_color': [0.1, 0.3, 0.8]}},
        'shapes': [{'type': 'sphere', 'center': [0, 0, 0.5], 'radius': 0.5, 'material': 'a'},
                   {'type': 'sphere', 'center': [0, 0, -0.5], 'radius': 0.5, 'material': 'b'}]}
SMALL = ('--size', '16x12', '--spp', '2')


def gltf(path, has_camera):
    """A square that rises by a metre a second for two seconds, above one that is still."""
    data = struct.pack('<12f', -1, 0, 1, 1, 0, 1, 1, 0, -1, -1, 0, -1)
    data += struct.pack('<6H', 0, 1, 2, 0, 2, 3) + struct.pack('<2f', 0, 2)
    data += struct.pack('<6f', 0, 0, 0, 0, 2, 0)
    uri = 'data:application/octet-stream;base64,' + base64.b64encode(data).decode()
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1] + [2] * has_camera}],
        'nodes': [{'mesh': 0}, {'mesh': 0, 'translation': [0, -1, 0], 'scale': [2, 1, 2]},
                  {'camera': 0, 'translation': [0, 1, 6]}],
        'cameras': [{'type': 'perspective', 'perspective': {'yfov': 0.8, 'znear': 0.1}}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1}]}],
        'buffers': [{'byteLength': len(data), 'uri': uri}],
        'bufferViews': [{'buffer': 0, 'byteOffset': at, 'byteLength': size}
                        for at, size in ((0, 48), (48, 12), (60, 8), (68, 24))],
        'accessors': [
            {'bufferView': 0, 'componentType': 5126, 'count': 4, 'type': 'VEC3',
             'min': [-1, 0, -1], 'max': [1, 0, 1]},
            {'bufferView': 1, 'componentType': 5123, 'count': 6, 'type': 'SCALAR'},
            {'bufferView': 2, 'componentType': 5126, 'count': 2, 'type': 'SCALAR', 'min': [0],
             'max': [2]},
            {'bufferView': 3, 'componentType': 5126, 'count': 2, 'type': 'VEC3'}],
        'animations': [{'samplers': [{'input': 2, 'output': 3}],
                        'channels': [{'sampler': 0, 'target': {'node': 0, 'path': 'translation'}}]}]}
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(document, file)


def texts(path):
    """Of a PNG: its metadata, by their names, and its pixels as they are stored."""
    with open(path, 'rb') as file:
        data = file.read()
    found, pixels, at = {}, b'', 8
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b'tEXt':
            key, _, value = body.partition(b'\0')
            found[key.decode('latin-1')] = value.decode('latin-1')
        elif kind == b'zTXt':
            key, _, value = body.partition(b'\0')
            found[key.decode('latin-1')] = zlib.decompress(value[1:]).decode('latin-1')
        elif kind == b'iTXt':
            key, _, rest = body.partition(b'\0')
            value = rest[2:].split(b'\0', 2)[2]
            value = zlib.decompress(value) if rest[0] else value
            found[key.decode('latin-1')] = value.decode()
        elif kind == b'IDAT':
            pixels += body
        at += size + 12
    return found, zlib.decompress(pixels)


class Folder(program.FolderCase):
    def setUp(self):
        super().setUp()
        with open(self.path('room.json'), 'w', encoding='utf-8') as file:
            json.dump(ROOM, file)
        gltf(self.path('rises.gltf'), True)
        gltf(self.path('framed.gltf'), False)

    def run_here(self, *arguments, code=0, path=None):
        environment = {**os.environ, **({'PATH': path} if path else {})}
        result = program.run(LAMPYRIS, 'render', *SMALL, *arguments, cwd=self.folder,
                             env=environment)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def lines(self, *arguments):
        """The objects of all lines but the last, and the last."""
        out = self.run_here(*arguments, '--json').stdout
        objects = [json.loads(line) for line in out.splitlines()]
        return objects[:-1], objects[-1]

    def hashes(self, *arguments):
        return [line['image_hash'] for line in self.lines(*arguments)[0]]

    def one(self, *arguments):
        return json.loads(self.run_here(*arguments, '--json').stdout)['image_hash']

    def names(self, *beginnings):
        return sorted(name for name in os.listdir(self.folder) if name.startswith(beginnings))


class Turntables(Folder):
    def test_views_are_spread_over_one_turn(self):
        four = self.hashes('room.json', '--turntable', '4', '-o', 'a.exr')
        eight = self.hashes('room.json', '--turntable', '8', '-o', 'b.exr')
        self.assertEqual(four, eight[::2])
        self.assertEqual(len(set(eight)), 8)

    def test_views_are_those_of_cameras_around_the_middle(self):
        # The camera stands on a circle about the axis of `up`, counter-clockwise, and its horizon
        # is level.
        self.lines('room.json', '--turntable', '3', '-o', 'a.exr')
        axis = [v / math.hypot(0.3, 1) for v in (0.3, 1, 0)]
        angle = 2 * math.pi / 3
        arm = ROOM['camera']['position']
        across = [axis[1] * arm[2] - axis[2] * arm[1], axis[2] * arm[0] - axis[0] * arm[2],
                  axis[0] * arm[1] - axis[1] * arm[0]]
        along = sum(a * b for a, b in zip(axis, arm)) * (1 - math.cos(angle))
        position = [v * math.cos(angle) + w * math.sin(angle) + k * along
                    for v, w, k in zip(arm, across, axis)]
        moved = {**ROOM, 'camera': {**ROOM['camera'], 'position': position}}
        with open(self.path('moved.json'), 'w', encoding='utf-8') as file:
            json.dump(moved, file)
        self.run_here('moved.json', '-o', 'm.exr')
        program.checked(LAMPYRIS, 'compare', 'a.0002.exr', 'm.exr', '--max', 'mse=1e-6',
                        cwd=self.folder)
        # A view from the other side is no such picture.
        self.assertEqual(program.run(LAMPYRIS, 'compare', 'a.0003.exr', 'm.exr', '--max',
                                     'mse=1e-6', cwd=self.folder).returncode, 1)

    def test_the_first_view_is_the_picture_itself(self):
        self.assertEqual(self.hashes('rises.gltf', '--turntable', '2', '-o', 'a.exr')[0],
                         self.one('rises.gltf', '-o', 'b.exr'))

    def test_a_pose_is_turned(self):
        turned = self.hashes('rises.gltf', '--at', '1', '--turntable', '2', '-o', 'a.exr')
        self.assertEqual(turned[0], self.one('rises.gltf', '--at', '1', '-o', 'b.exr'))

    def test_renders_that_need_a_new_renderer(self):
        # Tiles and the classes of the error have no renderer that another camera fits.
        arguments = ('room.json', '--adaptive', 'on', '--spp', '16', '--turntable')
        self.assertEqual(self.hashes(*arguments, '1', '-o', 'a.exr')[0],
                         self.hashes(*arguments, '3', '-o', 'b.exr')[0])
        self.assertEqual(self.hashes(*arguments, '2', '-o', 'a.exr')[1],
                         self.hashes(*arguments, '4', '-o', 'b.exr')[2])


class Animations(Folder):
    def test_pictures_are_those_of_single_renders(self):
        hashes = self.hashes('rises.gltf', '--at', '0:2:2', '--ground', 'off', '-o', 'a.exr')
        alone = [self.one('rises.gltf', '--at', str(at), '--ground', 'off', '-o', 'b.exr')
                 for at in (0, 0.5, 1, 1.5)]
        self.assertEqual(hashes, alone)
        self.assertEqual(len(set(hashes)), 4)

    def test_the_number_of_pictures_is_rounded(self):
        for at, times in (('0.5:1.1:5', [0.5, 0.7, 0.9]), ('1:1.01:24', [1]),
                          ('0:0.35:10', [0, 0.1, 0.2, 0.3])):
            lines, end = self.lines('rises.gltf', '--at', at, '-o', 'a.exr')
            self.assertEqual(end['pictures'], len(times))
            for line, time in zip(lines, times):
                self.assertAlmostEqual(line['frame']['at_seconds'], time)

    def test_additions_and_exposure_stay(self):
        """Of a camera that follows, pictures with the square alone would have the same bits."""
        self.run_here('framed.gltf', '--at', '0:2:1', '-o', 'a.png')
        first, second = (texts(self.path(name))[0] for name in ('a.0001.png', 'a.0002.png'))
        self.assertEqual(first['lampyris:exposure'], second['lampyris:exposure'])
        cameras = [[line for line in one['lampyris:sequence'].splitlines()
                    if line.startswith('camera=')] for one in (first, second)]
        self.assertEqual(cameras[0], cameras[1])
        self.run_here('framed.gltf', '--at', '1', '-o', 'b.png')
        alone = texts(self.path('b.png'))
        self.assertNotEqual(alone[1], texts(self.path('a.0002.png'))[1])


class Names(Folder):
    def test_forms(self):
        for output, names in (('t_##.png', ['t_01.png', 't_02.png']),
                              ('t_#.png', ['t_1.png', 't_2.png']),
                              ('t_%03d.png', ['t_001.png', 't_002.png']),
                              ('t%d.png', ['t1.png', 't2.png']),
                              ('t.png', ['t.0001.png', 't.0002.png']),
                              ('t####', None)):
            if names is None:
                self.run_here('room.json', '--turntable', '2', '-o', output, code=2)
                continue
            self.run_here('room.json', '--turntable', '2', '-o', output)
            self.assertEqual(self.names('t'), names, output)
            for name in names:
                os.remove(self.path(name))

    def test_the_default_and_more_than_fit(self):
        self.run_here('room.json', '--turntable', '11', '-q', '-o', 't#.png')
        self.assertEqual(len(self.names('t')), 11)
        self.assertIn('t11.png', self.names('t'))
        self.run_here('room.json', '--turntable', '1')
        self.assertIn('room.0001.exr', self.names('room'))

    def test_what_is_ambiguous_is_refused(self):
        for output, why in (('a_##_#.png', 'two placeholders'), ('a_#_%d.png', 'two placeholders'),
                            ('a_%4d.png', 'is not part of a placeholder'), ('50%.png', 'is not part of a placeholder'),
                            ('a_%s.png', 'is not part of a placeholder')):
            error = self.run_here('room.json', '--turntable', '2', '-o', output, code=2).stderr
            self.assertIn(why, error, output)
            self.assertIn('name_%04d.png', error)
        error = self.run_here('room.json', '--turntable', '12', '-o', 'a_##.png', '-o', 'a_#.png',
                              code=2).stderr
        self.assertIn('a_10.png', error)
        self.assertEqual(self.names('a'), [])

    def test_inputs_are_not_replaced(self):
        shutil.copy(self.path('room.json'), self.path('r.json'))
        self.run_here('room.json', '-o', 'e.0002.exr')
        error = self.run_here('room.json', '--env', 'e.0002.exr', '--turntable', '2', '-o', 'e.exr',
                              code=2).stderr
        self.assertIn('e.0002.exr: is read by this run', error)

    def test_what_excludes_each_other(self):
        one = ('--turntable', '2', '-o', 'a.exr')
        for more, words in ((('--checkpoint', 'c'), '--turntable and --checkpoint exclude'),
                            (('--explain',), '--turntable and --explain exclude each other'),
                            (('--trace', 't.csv'), '--turntable and --trace exclude'),
                            (('--shard', '1/2'), '--turntable and --shard exclude each other: a shard is a part of one '
                                                 'picture, but --turntable renders several; expected no --shard'),
                            (('--at', '0:1:2'), '--turntable and --at START:END:FPS exclude'),
                            (('--device', '0,1'), 'by one device')):
            self.assertIn(words, self.run_here('rises.gltf', *one, *more, code=2).stderr)
        for at, words in (('0:1', 'not of the form'), ('1:0:24', 'ends before it begins'),
                          ('0:1:0', 'FPS is outside'), ('0:1e6:900', 'more than 1000000 pictures'),
                          ('x', 'is not a finite number, nor START:END:FPS')):
            self.assertIn(words, self.run_here('rises.gltf', '--at', at, code=2).stderr)
        self.assertIn('--at is only for', self.run_here('room.json', '--at', '0:1:2', code=2).stderr)
        self.assertIn('--fps needs --turntable', self.run_here('room.json', '--fps', '5', code=2).stderr)
        self.assertIn('--resume needs --checkpoint, or the pictures',
                      self.run_here('room.json', '--resume', code=2).stderr)
        result = program.run(LAMPYRIS, 'info', 'rises.gltf', '--at', '0:1:2', cwd=self.folder)
        self.assertEqual(result.returncode, 2)
        self.assertIn('only render makes several pictures', result.stderr)


class Resuming(Folder):
    TURN = ('room.json', '--turntable', '4', '-o', 'a_#.png')

    def test_finished_pictures_are_skipped(self):
        before = self.hashes(*self.TURN)
        kept = texts(self.path('a_1.png'))
        os.remove(self.path('a_2.png'))
        with open(self.path('a_3.png'), 'r+b') as file:
            file.truncate(os.path.getsize(self.path('a_3.png')) - 20)
        lines, end = self.lines(*self.TURN, '--resume')
        self.assertEqual([line.get('skipped', False) for line in lines], [True, False, False, True])
        self.assertEqual([lines[i]['image_hash'] for i in (1, 2)], before[1:3])
        self.assertEqual((end['rendered'], end['skipped']), (2, 2))
        self.assertEqual(texts(self.path('a_1.png')), kept)

    def test_the_exposure_is_that_of_the_first_run(self):
        arguments = ('framed.gltf', '--at', '0:2:1', '-o', 'a_#.png')
        self.run_here(*arguments)
        before = texts(self.path('a_2.png'))
        os.remove(self.path('a_2.png'))
        self.run_here(*arguments, '--resume')
        after = texts(self.path('a_2.png'))
        self.assertEqual(after[1], before[1])
        self.assertEqual(after[0]['lampyris:sequence'], before[0]['lampyris:sequence'])

    def test_others_are_refused(self):
        self.run_here(*self.TURN)
        with open(self.path('a_1.png'), 'rb') as file:
            was = file.read()
        for more in (('--seed', '5'), ('--exposure', '1'), ('--turntable', '5'), ('--sampler', 'pcg'),
                     ('--png16',), ('-D', 'camera.fov_degrees=20')):
            error = self.run_here(*self.TURN, *more, '--resume', code=2).stderr
            self.assertIn('a_1.png: was made with', error)
            self.assertIn('without --resume', error)
        with open(self.path('a_1.png'), 'rb') as file:
            self.assertEqual(file.read(), was)
        self.run_here('room.json', '-o', 'b_1.png')
        error = self.run_here('room.json', '--turntable', '2', '-o', 'b_#.png', '--resume',
                              code=2).stderr
        self.assertIn('b_1.png: does not name the sequence to which it belongs', error)
        # Another output of that picture is missing, so it would be rendered and replace the file.
        error = self.run_here('room.json', '--turntable', '2', '-o', 'b_#.exr', '-o', 'b_#.png',
                              '--resume', code=2).stderr
        self.assertIn('b_1.png: does not name the sequence to which it belongs', error)
        error = self.run_here('room.json', '--turntable', '2', '-o', 'b_#.jpg', '--resume',
                              code=2).stderr
        self.assertIn('expected an output in EXR or PNG', error)

    def test_without_resume_all_are_rendered(self):
        self.run_here(*self.TURN)
        lines, _ = self.lines(*self.TURN, '--seed', '3')
        self.assertEqual([line.get('skipped') for line in lines], [None] * 4)

    def test_an_interrupted_run_goes_on(self):
        turn = ('rises.gltf', '--at', '0:2:3', '--size', '40x30', '--spp', '64')
        whole = self.hashes(*turn, '-o', 'w_#.png')
        # Small waves take longer, and change no bit.
        command = [LAMPYRIS, 'render', *turn, '-o', 'i_#.png', '--json', '--wave', '256']
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            process.stdout.readline() # the first picture is finished
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=60)
        if process.returncode == 0:
            self.skipTest('it was finished before the signal')
        self.assertEqual(process.returncode, 130, error)
        self.assertIn('the same command with --resume continues', error)
        there = self.names('i_')
        self.assertIn('i_1.png', there)
        lines, end = self.lines(*turn, '-o', 'i_#.png', '--resume')
        self.assertEqual(end['skipped'], len(there))
        for number, (line, expected) in enumerate(zip(lines, whole), 1):
            self.assertEqual(line.get('image_hash', expected), expected)
            self.assertEqual(texts(self.path(f'i_{number}.png'))[1],
                             texts(self.path(f'w_{number}.png'))[1])
        self.assertEqual([name for name in os.listdir(self.folder) if 'lock' in name], [])


class Reports(Folder):
    def test_lines_are_as_the_schema_says(self):
        import jsonschema
        with open(os.path.join(SOURCE, 'docs', 'render.schema.json'), encoding='utf-8') as file:
            schema = json.load(file)
        self.run_here('room.json', '--turntable', '2', '-o', 'a_#.png')
        os.remove(self.path('a_2.png'))
        lines, end = self.lines('room.json', '--turntable', '2', '-o', 'a_#.png', '--resume')

        def check(value, name):
            jsonschema.Draft202012Validator(
                {**schema, **({'$ref': f'#/$defs/{name}', 'properties': {}, 'required': [],
                               'additionalProperties': True} if name else {})}).validate(value)
        check(lines[0], 'skipped')
        check(lines[1], None)
        check(end, 'sequence')
        self.assertEqual(lines[1]['frame'], {'number': 2, 'count': 2, 'at_seconds': None, 'degrees': 180.0})
        self.assertTrue(lines[1]['error']['reason'] or lines[1]['error']['known'])

    def test_a_picture_bears_its_own_costs(self):
        """Kernels are compiled for the first picture, and each has the rays of its own."""
        lines, _ = self.lines('room.json', '--turntable', '3', '-o', 'a_#.exr')
        rays = [line['rays']['closest'] for line in lines]
        self.assertLess(max(rays), 1.5 * min(rays))
        self.assertEqual([line['seconds']['compile'] == 0 for line in lines], [False, True, True])
        self.assertEqual([line['seconds']['bvh'] == 0 for line in lines], [False, True, True])
        text = self.run_here('room.json', '--turntable', '3', '-o', 'a_#.exr').stdout
        self.assertIn('picture 2/3 from 120 degrees: ', text)
        self.assertIn('3 pictures, 3 of them rendered now', text)


FAKE = '''#!/usr/bin/python3
import json, os, sys
with open(os.environ['FAKE_LOG'], 'w') as file:
    json.dump(sys.argv[1:], file)
if os.environ.get('FAKE_FAILS'):
    sys.exit('no such codec')
with open(sys.argv[-1], 'w') as file:
    file.write('a video')
'''


class Videos(Folder):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path('bin'))
        with open(self.path('bin/ffmpeg'), 'w', encoding='utf-8') as file:
            file.write(FAKE)
        os.chmod(self.path('bin/ffmpeg'), stat.S_IRWXU)
        os.environ['FAKE_LOG'] = self.path('log')
        self.addCleanup(os.environ.pop, 'FAKE_LOG')

    def video(self, *arguments, code=0):
        return self.run_here(*arguments, code=code, path=self.path('bin'))

    def asked(self, option):
        with open(self.path('log'), encoding='utf-8') as file:
            arguments = json.load(file)
        return arguments[arguments.index(option) + 1]

    def test_pictures_are_kept_where_they_were_asked_for(self):
        self.video('room.json', '--turntable', '3', '--fps', '12.5', '-o', 'turn.mp4', '-o', 't_##.png')
        self.assertEqual(self.names('t'), ['t_01.png', 't_02.png', 't_03.png', 'turn.mp4'])
        self.assertEqual([self.asked(option) for option in ('-i', '-framerate', '-frames:v', '-c:v')],
                         ['./t_%02d.png', '12.5', '3', 'libx264'])

    def test_else_they_are_removed_at_the_end(self):
        self.video('rises.gltf', '--at', '0:1:4', '-o', 'turn.webm')
        self.assertEqual(self.names('turn'), ['turn.webm'])
        self.assertEqual([self.asked(option) for option in ('-i', '-framerate', '-c:v')],
                         ['./turn.webm.frames/%04d.png', '4', 'libvpx-vp9'])

    def test_a_failure_keeps_them(self):
        os.environ['FAKE_FAILS'] = '1'
        self.addCleanup(os.environ.pop, 'FAKE_FAILS')
        error = self.video('room.json', '--turntable', '2', '-o', 'turn.mp4', code=4).stderr
        self.assertIn('turn.mp4: ffmpeg failed: no such codec; the pictures are kept', error)
        self.assertEqual(sorted(os.listdir(self.path('turn.mp4.frames'))), ['0001.png', '0002.png'])
        self.assertEqual(self.names('turn'), ['turn.mp4.frames'])
        del os.environ['FAKE_FAILS']
        text = self.video('room.json', '--turntable', '2', '-o', 'turn.mp4', '--resume').stdout
        os.environ['FAKE_FAILS'] = '1'
        self.assertIn('0 of them rendered now, 2 finished before', text)
        self.assertEqual(self.names('turn'), ['turn.mp4'])

    def test_refusals(self):
        os.remove(self.path('bin/ffmpeg'))
        error = self.video('room.json', '--turntable', '2', '-o', 'turn.mp4', code=2).stderr
        self.assertIn('"turn.mp4" needs the program ffmpeg', error)
        self.assertEqual(self.names('turn'), [])
        error = self.video('room.json', '-o', 'turn.mp4', code=2).stderr
        self.assertIn('"turn.mp4" is a video; expected --turntable', error)

    def test_sizes(self):
        error = program.run(LAMPYRIS, 'render', 'room.json', '--turntable', '2', '--size', '15x12', '-o',
                            't.mp4', cwd=self.folder, env={**os.environ, 'PATH': self.path('bin')})
        self.assertEqual(error.returncode, 2)
        self.assertIn('expected 16x12 pixels, or .webm', error.stderr)

    @unittest.skipUnless(shutil.which('ffmpeg'), 'ffmpeg is not installed')
    def test_real_ones(self):
        for name, codec in (('t.mp4', 'h264'), ('t.webm', 'vp9')):
            self.run_here('room.json', '--turntable', '5', '-o', name)
            words = program.run('ffmpeg', '-i', self.path(name), '-f', 'null', '-').stderr
            self.assertIn(codec, words)
            self.assertIn('16x12', words)
            self.assertIn('frame=    5', words)


if __name__ == '__main__':
    program.need_device(LAMPYRIS)
    unittest.main()
