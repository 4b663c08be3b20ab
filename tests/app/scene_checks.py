"""Shared by the tests of `lampyris check SCENE`: functions that check scenes and write files for them.

    test_check_scene_X.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
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
    """Writes an uncompressed EXR in single precision with scan lines. `texels`: rows of (r, g, b)."""
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
    """Writes a PNG with 8 bits per channel. `texels`: rows of (r, g, b, a)."""
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
    """Returns an OBJ file of a box, or of some of its faces. The corners are counter-clockwise as seen from
    outside."""
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
        """Returns the findings by name."""
        path = self.write(name, {'lampyris': 1, 'film': FILM, **scene})
        return self.check_file(path, *arguments)

    def check_file(self, path, *arguments):
        """Checks a file. If the machine is so busy that fewer pixels are rendered, tries again."""
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


def read_png(data):
    """Returns the 8-bit codes of a PNG as rows of (r, g, b)."""
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
