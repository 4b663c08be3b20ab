#!/usr/bin/env python3
"""Tests memory: small files that need much of it, machines that have none left, and signals before rendering,
which must end the program as well.

    test_memory.py LAMPYRIS SOURCE_ROOT SHIM [unittest arguments]

SHIM: the library made of failing_malloc.c.
"""
import base64
import json
import os
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

from program import FolderCase, by_the_clock

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
SHIM = os.path.abspath(sys.argv.pop(1))
CORNELL = os.path.join(ROOT, 'scenes', 'cornell.json')
MIB = 1 << 20
ONE_MATERIAL = {'lampyris': 1, 'materials': {'m': {'base_color': [0.5, 0.5, 0.5]}}}


def black_png(side):
    """Returns a PNG with one bit per pixel; 20000 x 20000 pixels take 48 kB."""
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    packer = zlib.compressobj(9)
    line = bytes(1 + (side + 7) // 8)
    pixels = b''.join(packer.compress(line) for _ in range(side)) + packer.flush()
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', side, side, 1, 0, 0, 0, 0)) +
            chunk(b'IDAT', pixels) + chunk(b'IEND', b''))


def black_exr(side):
    """Returns only the header of an EXR; the pixels are never read."""
    def attribute(name, kind, value):
        return name + b'\0' + kind + b'\0' + struct.pack('<i', len(value)) + value
    channels = b''.join(c + b'\0' + struct.pack('<iiii', 2, 0, 1, 1) for c in (b'B', b'G', b'R'))
    window = struct.pack('<iiii', 0, 0, side - 1, side - 1)
    return (struct.pack('<ii', 20000630, 2) + attribute(b'channels', b'chlist', channels + b'\0') +
            attribute(b'compression', b'compression', b'\0') +
            attribute(b'dataWindow', b'box2i', window) +
            attribute(b'displayWindow', b'box2i', window) +
            attribute(b'lineOrder', b'lineOrder', b'\0') +
            attribute(b'pixelAspectRatio', b'float', struct.pack('<f', 1)) +
            attribute(b'screenWindowCenter', b'v2f', struct.pack('<ff', 0, 0)) +
            attribute(b'screenWindowWidth', b'float', struct.pack('<f', 1)) + b'\0' +
            bytes(8 * side + 64))


# Waits for a command and reports its memory and time. Through exec, a process inherits the peak of the
# program before it, which for a child of this script is the script's own peak. So there is a small process in
# between.
MEASURE = """
import json, os, resource, sys
limit = int(sys.argv[2])
pid = os.fork()
if pid == 0:
    if limit:
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    os.execv(sys.argv[3], sys.argv[3:])
_, status, usage = os.wait4(pid, 0)
with open(sys.argv[1], 'w') as file:
    json.dump([os.waitstatus_to_exitcode(status), usage.ru_maxrss * 1024,
               usage.ru_utime + usage.ru_stime], file)
"""


def triangle_gltf(**more):
    points = struct.pack('<9f', 0, 0, 0, 1, 0, 0, 0, 1, 0)
    uri = 'data:application/octet-stream;base64,' + base64.b64encode(points).decode()
    document = {'asset': {'version': '2.0'}, 'buffers': [{'uri': uri, 'byteLength': 36}],
                'bufferViews': [{'buffer': 0, 'byteLength': 36}],
                'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3'}],
                'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}]}
    document.update(more)
    return document


class Base(FolderCase):
    def write(self, name, content):
        if not isinstance(content, bytes):
            content = json.dumps(content).encode()
        with open(self.path(name), 'wb') as file:
            file.write(content)
        return self.path(name)

    def shapes(self, *shapes, **more):
        return self.write('scene.json', {**ONE_MATERIAL, **more, 'shapes': list(shapes)})


class Budget(Base):
    """What exceeds it is refused before it is taken."""

    def measure(self, *arguments, limit=None):
        """Returns the exit code, the most bytes, the processor seconds and what was said."""
        # glibc fills what it hands out, so that whatever is allocated counts, used or not.
        environment = {**os.environ, 'MALLOC_PERTURB_': '165'}
        stderr = subprocess.run([sys.executable, '-ISc', MEASURE, self.path('measured'),
                                 str(limit or 0), LAMPYRIS, *arguments], stderr=subprocess.PIPE,
                                text=True, stdout=subprocess.DEVNULL, cwd=self.folder,
                                env=environment).stderr
        with open(self.path('measured'), encoding='ascii') as file:
            return *json.load(file), stderr

    def refuse(self, *arguments, memory='64M', peak=None, thing='', limit=None, seconds=None):
        """peak: in bytes; by default 40 MiB besides what the driver takes."""
        arguments = [*arguments, *(['--memory', memory] if memory else [])]
        code, bytes_taken, seconds_taken, stderr = self.measure(*arguments, limit=limit)
        peak = peak or self.measure('devices')[1] + 40 * MIB
        self.assertEqual(code, 2, stderr)
        self.assertRegex(stderr, r'out of memory for .*: [0-9.]+ \wiB are needed, but .* left of the '
                                 r'budget of .*--memory')
        self.assertIn(thing, stderr)
        self.assertLess(bytes_taken, peak)
        if seconds:
            self.assertLess(seconds_taken, seconds)
        return stderr

    def test_pictures_are_refused_by_their_headers(self):
        self.write('bomb.png', black_png(20000))
        self.write('bomb.exr', black_exr(20000))
        self.write('bomb.hdr', b'#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n\2\2')
        scene = self.shapes({'type': 'quad', 'material': 't', 'corner': [-1, 0, 1], 'u': [2, 0, 0],
                             'v': [0, 0, -2]},
                            materials={'t': {'textures': [
                                {'file': 'bomb.png', 'parameters': {'base_color': 'rgb'}}]}})
        # 12 MiB are the program's.
        self.refuse('info', scene, thing='bomb.png: out of memory for a picture of 20000 x 20000',
                    peak=30 * MIB)
        for name in 'bomb.png', 'bomb.exr', 'bomb.hdr':
            self.refuse('info', CORNELL, '--env', name, peak=30 * MIB,
                        thing=name + ': out of memory for a picture of 20000 x 20000')
        self.refuse('compare', 'bomb.png', 'bomb.png', peak=30 * MIB)

    def test_metrics_of_pictures(self):
        """Two pictures of 48 MB fit; FLIP of them, which takes 368 MB more, does not."""
        self.write('large.png', black_png(2000))
        stderr = self.refuse('compare', 'large.png', 'large.png', memory='150M',
                             peak=(150 + 40) * MIB, thing='comparing pictures of 2000 x 2000')
        # The reference is read; the picture and HDR-FLIP take 12 + 92 bytes a pixel.
        self.assertIn('for comparing pictures of 2000 x 2000: 396.7 MiB are needed', stderr)
        small = self.write('small.png', black_png(500))
        subprocess.run([LAMPYRIS, 'compare', small, small, '--memory', '40M'], check=True,
                       stdout=subprocess.DEVNULL)

    def test_shapes(self):
        for shape in ({'type': 'generated', 'triangles': 200000000},
                      {'type': 'torus', 'segments': 4096, 'tube_segments': 4096},
                      {'type': 'teapot', 'resolution': 1000},
                      {'type': 'scatter', 'count': 1000000, 'disc_radius': 1, 'radius': [0.01, 0.02],
                       'materials': [{'material': 'm'}]}):
            with self.subTest(shape['type']):
                if shape['type'] != 'scatter':
                    shape['material'] = 'm'
                self.refuse('info', self.shapes(shape), thing='shapes[0]', memory='16M')

    def test_copies_of_copies(self):
        original = {'type': 'sphere', 'radius': 1, 'name': 'a', 'material': 'm', 'hidden': True}
        copies = {'type': 'scatter', 'of': 'a', 'count': 1 << 18, 'disc_radius': 100}
        self.refuse('info', self.shapes(original, *[copies] * 200), thing='scene.json: shapes[2]')

    @by_the_clock
    def test_all_shapes_are_asked_for_before_the_first(self):
        """Each of them fits."""
        torus = {'type': 'torus', 'segments': 4096, 'tube_segments': 2048, 'material': 'm'}
        original = {'type': 'sphere', 'radius': 1, 'name': 'a', 'material': 'm', 'hidden': True}
        copies = {'type': 'scatter', 'of': ['a'], 'count': 1 << 21, 'disc_radius': 100}
        for shapes, first, needed in (([torus] * 20, 2, '7.5 GiB'),
                                      ([original, *[copies] * 20], 4, '5.6 GiB')):
            with self.subTest(shapes[-1]['type']):
                stderr = self.refuse(
                    'info', self.shapes(*shapes), memory='1G', peak=30 * MIB, seconds=1,
                    thing='shapes[%d]: out of memory for all shapes' % first)
                self.assertIn(': %s are needed' % needed, stderr)

    @by_the_clock
    def test_instances_of_gltf(self):
        # A million each, of which the file has no bytes.
        accessors = triangle_gltf()['accessors'] + [
            {'componentType': 5126, 'count': 1 << 20, 'type': 'VEC3'}]
        node = {'mesh': 0, 'extensions': {
            'EXT_mesh_gpu_instancing': {'attributes': {'TRANSLATION': 1}}}}
        model = self.write('i.gltf', triangle_gltf(
            accessors=accessors, nodes=[node] * 50, scenes=[{'nodes': list(range(50))}],
            extensionsUsed=['EXT_mesh_gpu_instancing']))
        self.refuse('info', model, memory='1G', peak=40 * MIB, seconds=1,
                    thing='i.gltf: nodes[9]: out of memory for the instances')
        # Two thousand primitives on a thousand nodes.
        primitive = {'attributes': {'POSITION': 0}}
        model = self.write('p.gltf', triangle_gltf(
            meshes=[{'primitives': [primitive] * 2000}], nodes=[{'mesh': 0}] * 1000,
            scenes=[{'nodes': list(range(1000))}]))
        stderr = self.refuse('info', model, thing='p.gltf: nodes[', peak=40 * MIB)
        self.assertIn('out of memory for the instances', stderr)

    def test_documents(self):
        """The tree of a text of brackets is a hundred times as large as the text."""
        text = b'{"lampyris": 1, "x": [[]' + b',[]' * 500000 + b']}'
        self.refuse('info', self.write('x.json', text), thing='x.json: out of memory')

    def test_triangles_and_their_tree(self):
        # Loads in 44 MB, is flat in 80, and needs twice that for the tree.
        torus = {'type': 'torus', 'segments': 1000, 'tube_segments': 500, 'material': 'm'}
        scene = self.shapes(torus)
        self.refuse('info', scene, memory='64M', thing='vertex attributes')
        self.refuse('info', scene, memory='160M', thing='building the BVH', peak=250 * MIB)

    def test_pictures_on_the_host(self):
        self.refuse('render', CORNELL, '--size', '4000x4000', '--spp', '1', thing='picture',
                    peak=400 * MIB)

    def test_what_fits_goes_on_working(self):
        result = subprocess.run([LAMPYRIS, 'info', CORNELL, '--memory', '32M'], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_it_follows_the_machine(self):
        """Three quarters of the 2 GiB that ulimit leaves."""
        scene = self.shapes({'type': 'generated', 'triangles': 100000000, 'material': 'm'})
        stderr = self.refuse('info', scene, memory=None, limit=2 << 30, thing='shapes[0]', peak=30 * MIB)
        budget = float(re.search(r'budget of ([0-9.]+) GiB', stderr).group(1))
        self.assertTrue(1.3 < budget <= 1.5, stderr)

    def test_too_little_for_a_driver_is_told(self):
        """Below, Mesa's compiler ends the process by a signal where it cannot allocate."""
        with tempfile.TemporaryDirectory() as folder:
            for limit in 200, 300, 400, 500, 600, 700:
                command = f'ulimit -v {limit << 10}; exec "$0" "$@"'
                result = subprocess.run(['bash', '-c', command, LAMPYRIS, 'render', CORNELL, '--size', '8x8', '--spp',
                                         '2', '-o', os.path.join(folder, 'out.exr')], text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertIn('ulimit', result.stderr)
                self.assertEqual(os.listdir(folder), [])

    def test_the_option_is_checked(self):
        for value in '0', '1k', '-1', 'much':
            result = subprocess.run([LAMPYRIS, 'info', CORNELL, '--memory', value], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertEqual(result.returncode, 2)
            self.assertIn('--memory', result.stderr)


class Stops(Base):
    """SIGTERM ends the program within a second, whatever it does before rendering."""

    def stop(self, after, *arguments, sent=signal.SIGTERM):
        # Filling each block that is handed out would be a second that is nobody's but the test's.
        environment = {**os.environ, 'MALLOC_PERTURB_': '0'}
        process = subprocess.Popen([LAMPYRIS, *arguments], stderr=subprocess.PIPE, text=True,
                                   stdout=subprocess.DEVNULL, cwd=self.folder, env=environment)
        time.sleep(after)
        self.assertIsNone(process.poll(), 'it has ended by itself')
        before = self.processor_seconds(process.pid)
        start = time.monotonic()
        process.send_signal(sent)
        stderr = process.stderr.read()
        process.stderr.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        # On a busy machine what counts is what the program itself has needed.
        seconds = min(time.monotonic() - start, usage.ru_utime + usage.ru_stime - before)
        self.assertEqual(process.returncode, 128 + sent, stderr)
        self.assertLess(seconds, 1, stderr)

    @staticmethod
    def processor_seconds(pid):
        with open('/proc/%d/stat' % pid) as file:
            fields = file.read().rsplit(')', 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')

    @by_the_clock
    def test_scattering_in_vain(self):
        scene = self.shapes({'type': 'scatter', 'count': 1000000, 'disc_radius': 1,
                             'radius': [0.5, 1], 'materials': [{'material': 'm'}]})
        self.stop(0.5, 'info', scene)
        self.stop(0.5, 'render', scene, '--size', '8x8', sent=signal.SIGINT)

    @by_the_clock
    def test_triangles(self):
        scene = self.shapes({'type': 'generated', 'triangles': 8000000, 'material': 'm'})
        for after in 0.2, 0.7, 1.5, 2.5:
            self.stop(after, 'info', scene)

    @by_the_clock
    def test_texels(self):
        self.write('large.png', black_png(8000))
        texture = {'file': 'large.png', 'parameters': {'base_color': 'rgb'}}
        scene = self.shapes({'type': 'quad', 'material': 't', 'corner': [-1, 0, 1], 'u': [2, 0, 0],
                             'v': [0, 0, -2]}, materials={'t': {'textures': [texture]}})
        self.stop(0.3, 'info', scene)

    @by_the_clock
    def test_metrics(self):
        """Reading, and one metric after the other, in the pictures' 6 seconds of CPU."""
        self.write('large.png', black_png(3000))
        for after in 0.1, 0.5, 1, 1.5, 3:
            self.stop(after, 'compare', 'large.png', 'large.png')


class Exhausted(Base):
    """The n-th allocation fails: said as lack of memory, or done without. Nothing is blamed that is
    not to blame, and nothing is missing from what ends well."""

    COMMANDS = {
        'info': ['info', CORNELL, '--json'],
        'render': ['render', CORNELL, '--size', '8x8', '--spp', '16', '-o', 'z.exr', '-o', 'z.png',
                   '--checkpoint', 'z.ck', '--aov', 'all', '--json'],
        'compare': ['compare', 'a.exr', 'a.exr', '--json'],
    }
    OUTPUTS = {'info': [], 'render': ['z.exr', 'z.png', 'z.ck'], 'compare': []}

    def run_with(self, command, **more):
        for name in self.OUTPUTS[command]:
            if os.path.exists(self.path(name)):
                os.unlink(self.path(name))
        environment = {**os.environ, 'LD_PRELOAD': SHIM, **{k: str(v) for k, v in more.items()}}
        return subprocess.run([LAMPYRIS, *self.COMMANDS[command]], env=environment, timeout=120,
                              cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True)

    def check(self, command, n, expected, **more):
        result = self.run_with(command, FAIL_AT=n, **more)
        with self.subTest(command=command, n=n, **more):
            if result.returncode == 0:
                self.assertEqual(sorted(json.loads(result.stdout)), expected)
                for name in self.OUTPUTS[command]:
                    self.assertTrue(os.path.exists(self.path(name)), name)
                return
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertIn('out of memory', result.stderr)
            self.assertNotRegex(result.stderr, r'line -1')

    def sweep(self, command, most):
        """`most` of the allocations, evenly spread, and the first and last ones."""
        if command == 'compare':
            subprocess.run([LAMPYRIS, 'render', CORNELL, '--size', '8x8', '--spp', '4', '-q', '-o',
                            self.path('a.exr')], check=True)
        result = self.run_with(command, COUNT_INTO=self.path('count'))
        if result.returncode == 69:
            self.skipTest('no device')
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path('count'), encoding='ascii') as file:
            count = int(file.read())
        self.assertGreater(count, 300, 'the shim is at work')
        expected = sorted(json.loads(result.stdout))
        step = max(1, count // most)
        for n in sorted({*range(1, count + 1, step), 2, 31, count - 2, count - 1, count}):
            self.check(command, n, expected)
        self.check(command, count // 2, expected, FAIL_ON=1)

    def test_info(self):
        self.sweep('info', 30)

    def test_compare(self):
        self.sweep('compare', 15)

    def test_render(self):
        self.sweep('render', 6)

    def test_what_was_rendered_is_kept(self):
        """Between samples memory is taken to look at the film; that of writing is above."""
        kept = os.path.join(self.folder, 'kept.exr')
        command = [LAMPYRIS, 'render', CORNELL, '--size', '8x8', '--spp', '256', '--trace', 't.csv',
                   '-q', '-o', kept]

        def run(**more):
            for path in (self.path('t.csv'), kept):
                if os.path.exists(path):
                    os.unlink(path)
            environment = {**os.environ, 'LD_PRELOAD': SHIM, 'TMPDIR': self.folder,
                           **{k: str(v) for k, v in more.items()}}
            return subprocess.run(command, env=environment, timeout=120, cwd=self.folder, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)

        if run(COUNT_INTO=self.path('count')).returncode == 69:
            self.skipTest('no device')
        with open(self.path('count'), encoding='ascii') as file:
            count = int(file.read())
        messages = ''
        # The last 270 or so are of writing, some of them for each setting in the metadata.
        for n in range(count - 420, count - 340, 8):
            result = run(FAIL_AT=n)
            self.assertIn(result.returncode, (0, 3), result.stderr)
            self.assertTrue(os.path.exists(kept), result.stderr)
            messages += result.stderr
        self.assertIn('memory ran out; the picture has ', messages)


class Long(Exhausted):
    test_info = test_compare = test_render = None

    def test_all_of_info(self):
        self.sweep('info', 1 << 30)

    def test_all_of_compare(self):
        self.sweep('compare', 1 << 30)

    def test_many_of_render(self):
        self.sweep('render', 600)


if __name__ == '__main__':
    unittest.main()
