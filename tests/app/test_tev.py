#!/usr/bin/env python3
"""Tests lampyris render --tev: the packets that the viewer receives, that the picture keeps its bits, and
that no peer can delay or damage a render.

    test_tev.py LAMPYRIS SOURCE_ROOT
"""
import itertools
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zlib

from program import by_the_clock, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
SCENE = os.path.join(ROOT, 'scenes', 'cornell.json')
CREATE_IMAGE, UPDATE_IMAGE = 4, 5
# The viewer gets nine megabytes: several packets, which together exceed the buffers of a connection.
LARGE = ('--spp', '1', '--max-bounces', '0', '--aov', 'albedo,normal,position,direct,indirect')
TYPES = {0: ('I', 4), 1: ('e', 2), 2: ('f', 4)}  # types of EXR channels: format and bytes


class Packet:
    """Reads the fields of a packet. Fails if a field is beyond its end, or if bytes are left."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, size):
        part = self.data[self.at:self.at + size]
        if len(part) != size:
            raise ValueError('the packet ends early')
        self.at += size
        return part

    def number(self, code='<i'):
        return struct.unpack(code, self.take(struct.calcsize(code)))[0]

    def flag(self):
        value = self.take(1)[0]
        if value > 1:
            raise ValueError(f'{value} is no flag')
        return value

    def text(self):
        end = self.data.index(0, self.at)
        text = self.data[self.at:end].decode('utf-8')
        self.at = end + 1
        return text

    def end(self):
        if self.at != len(self.data):
            raise ValueError(f'{len(self.data) - self.at} bytes too many')


class Viewer:
    """The state of tev after the packets: images by name, each a dict of channels."""

    def __init__(self):
        self.pictures, self.sizes, self.updates, self.times = {}, {}, 0, []

    def packet(self, data):
        packet = Packet(data)
        kind, focus, name = packet.number('<b'), packet.flag(), packet.text()
        if kind == CREATE_IMAGE:
            self.create(packet, name)
        elif kind == UPDATE_IMAGE:
            self.update(packet, name)
        else:
            raise ValueError(f'type {kind}')
        if focus:
            raise ValueError('takes the focus')
        packet.end()

    def channels(self, packet):
        names = [packet.text() for _ in range(packet.number())]
        if not names or len(set(names)) != len(names):
            raise ValueError(f'channels {names}')
        return names

    def create(self, packet, name):
        width, height = packet.number(), packet.number()
        if name in self.pictures or width <= 0 or height <= 0:
            raise ValueError(f'{name} of {width} x {height}')
        self.sizes[name] = width, height
        self.pictures[name] = {c: bytearray(4 * width * height) for c in self.channels(packet)}

    def update(self, packet, name):
        picture, (width, height) = self.pictures[name], self.sizes[name]
        channels = self.channels(packet)
        x, y, w, h = (packet.number() for _ in range(4))
        if x < 0 or y < 0 or w <= 0 or h <= 0 or x + w > width or y + h > height:
            raise ValueError(f'{w} x {h} at {x}, {y} of {width} x {height}')
        for channel in channels:
            for row in range(y, y + h):
                at = 4 * (row * width + x)
                picture[channel][at:at + 4 * w] = packet.take(4 * w)
        if y == 0:
            self.updates += 1
            self.times.append(time.monotonic())


class Server(threading.Thread):
    """Listens for a connection and calls `behave(connection, viewer)` for it."""

    def __init__(self, behave, family=socket.AF_INET, host='127.0.0.1', buffer=None):
        super().__init__(daemon=True)
        self.socket = socket.socket(family)
        if buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        self.socket.bind((host, 0))
        self.socket.listen()
        self.socket.settimeout(60)
        self.port = self.socket.getsockname()[1]
        self.behave, self.viewer, self.problem = behave, Viewer(), None
        self.start()

    def run(self):
        try:
            connection, _ = self.socket.accept()
            with connection:
                connection.settimeout(60)
                self.behave(connection, self.viewer)
        except Exception as problem:  # close() raises it
            self.problem = problem

    def close(self):
        self.join(60)
        self.socket.close()
        if self.problem:
            raise self.problem
        return self.viewer


def receive(connection, size):
    data = bytearray()
    while len(data) < size:
        part = connection.recv(min(1 << 20, size - len(data)))
        if not part:
            break
        data += part
    return bytes(data)


def read_all(connection, viewer):
    while True:
        head = receive(connection, 4)
        if not head:
            return
        length = struct.unpack('<I', head)[0]
        body = receive(connection, length - 4)
        if len(head) != 4 or len(body) != length - 4:
            raise ValueError('the stream ends within a packet')
        viewer.packet(body)


def unpack_block(data, size):
    """Decompresses a ZIP block of the OpenEXR file layout: differences of bytes, those at even places
    first."""
    if len(data) == size:
        return data
    plain = bytearray(zlib.decompress(data))
    plain = bytes(itertools.accumulate(plain, lambda a, b: (a + b - 128) & 255))
    half = (size + 1) // 2
    out = bytearray(size)
    out[0::2], out[1::2] = plain[:half], plain[half:]
    return bytes(out)


def read_exr(path):
    """Returns (width, height) and {channel: (type, bytes)} of a ZIP-compressed EXR with scan lines (OpenEXR
    file layout)."""
    with open(path, 'rb') as file:
        data = file.read()
    at, attributes = 8, {}
    while data[at]:
        name, rest = data[at:].split(b'\0', 1)
        kind, rest = rest.split(b'\0', 1)
        at += len(name) + len(kind) + 2
        size = struct.unpack_from('<i', data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    left, top, right, bottom = struct.unpack('<4i', attributes[b'dataWindow'])
    width, height = right - left + 1, bottom - top + 1
    channels, rest = [], attributes[b'channels']
    while rest[0]:
        name, rest = rest.split(b'\0', 1)
        channels.append((name.decode(), struct.unpack_from('<i', rest)[0]))
        rest = rest[16:]
    lines = {0: 1, 2: 1, 3: 16}[attributes[b'compression'][0]]
    out = {name: bytearray() for name, _ in channels}
    row = sum(TYPES[kind][1] for _, kind in channels) * width
    blocks = (height + lines - 1) // lines
    for offset in struct.unpack_from('<%dQ' % blocks, data, at + 1):
        y, size = struct.unpack_from('<ii', data, offset)
        count = min(lines, height - y)
        block = unpack_block(data[offset + 8:offset + 8 + size], row * count)
        here = 0
        for _ in range(count):
            for name, kind in channels:
                bytes_here = TYPES[kind][1] * width
                out[name] += block[here:here + bytes_here]
                here += bytes_here
    return (width, height), {name: (kind, bytes(out[name])) for name, kind in channels}


class Base(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def command(self, *arguments, size='64x48', out='out.exr'):
        return [LAMPYRIS, 'render', SCENE, '--size', size, '-q', '-o', self.path(out), *arguments]

    def run_one(self, *arguments, **options):
        result = subprocess.run(self.command(*arguments, **options), stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stderr

    def check_warned(self, said, *words):
        self.assertEqual(said.count('--tev'), 1, said)
        for word in words:
            self.assertIn(word, said)

    def check_picture(self, viewer, out='out.exr'):
        """Checks that the viewer's last image equals the file in every channel, bit for bit."""
        size, channels = read_exr(self.path(out))
        self.assertEqual(list(viewer.pictures), [self.path(out)])
        picture = viewer.pictures[self.path(out)]
        self.assertEqual(viewer.sizes[self.path(out)], size)
        self.assertEqual(sorted(picture), sorted(channels))
        for name, (kind, expected) in channels.items():
            if kind == 0:  # integers are sent as floats
                numbers = struct.unpack('<%dI' % (len(expected) // 4), expected)
                expected = struct.pack('<%df' % len(numbers), *numbers)
            self.assertEqual(bytes(picture[name]), expected, name)


class Pictures(Base):
    def test_the_last_picture_is_the_files(self):
        self.run_one('--spp', '16', out='plain.exr')
        server = Server(read_all)
        said = self.run_one('--spp', '16', '--tev', f'127.0.0.1:{server.port}')
        viewer = server.close()
        self.assertEqual(said, '')
        self.assertGreaterEqual(viewer.updates, 2)
        self.check_picture(viewer)
        self.assertEqual(read_exr(self.path('out.exr')), read_exr(self.path('plain.exr')))
        with open(self.path('out.exr'), 'rb') as file:
            repeat = file.read().split(b'lampyris:repeat', 1)[1][:200]
        self.assertIn(b'--spp 16', repeat)
        self.assertFalse(b'--tev' in repeat)  # repeating the render needs no viewer

    def test_layers(self):
        server = Server(read_all)
        self.run_one('--spp', '4', '--aov', 'all', '--tev', str(server.port), size='31x17')
        viewer = server.close()
        channels = next(iter(viewer.pictures.values()))
        for name in ('R', 'albedo.G', 'normal.X', 'depth.Z', 'id.object', 'samples.count'):
            self.assertIn(name, channels)
        self.check_picture(viewer)

    def test_large_pictures_come_in_bands(self):
        server = Server(read_all)
        self.run_one(*LARGE, '--tev', f':{server.port}', size='400x300')
        self.check_picture(server.close())

    @by_the_clock
    def test_it_grows_while_it_is_rendered(self):
        server = Server(read_all)
        self.run_one('--time', '4', '--tev', f'localhost:{server.port}', size='96x96')
        viewer = server.close()
        self.check_picture(viewer)
        gaps = [b - a for a, b in zip(viewer.times, viewer.times[1:])]
        self.assertGreaterEqual(viewer.updates, 4)
        self.assertLess(max(gaps), 4, gaps)

    def test_adaptive_and_frames(self):
        for arguments in (('--adaptive', 'on', '--spp', '32'),
                          ('--frames', '3', '--spp-per-frame', '2', '--accumulate', 'off')):
            server = Server(read_all)
            self.run_one(*arguments, '--tev', str(server.port))
            self.check_picture(server.close())

    def test_checkpoints_go_on(self):
        server = Server(read_all)
        state = self.path('state')
        self.run_one('--spp', '8', '--checkpoint', state, '--tev', str(server.port))
        server.close()
        server = Server(read_all)
        self.run_one('--spp', '16', '--checkpoint', state, '--resume', '--tev', str(server.port))
        self.check_picture(server.close())

    def test_signals_keep_the_picture(self):
        server = Server(read_all)
        process = subprocess.Popen(self.command('--time', '60', '--tev', str(server.port)))
        while server.viewer.updates < 2 and process.poll() is None:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(60), 128 + signal.SIGINT)
        self.check_picture(server.close())

    def test_ipv6(self):
        try:
            server = Server(read_all, socket.AF_INET6, '::1')
        except OSError as problem:
            self.skipTest(str(problem))
        self.run_one('--spp', '2', '--tev', f'[::1]:{server.port}')
        self.check_picture(server.close())


class Peers(Base):
    def setUp(self):
        super().setUp()
        self.run_one('--spp', '8', out='plain.exr')

    def check_bits(self):
        self.assertEqual(read_exr(self.path('out.exr')), read_exr(self.path('plain.exr')))

    def test_nobody_listens(self):
        with socket.socket() as unused:
            unused.bind(('127.0.0.1', 0))
            port = unused.getsockname()[1]
            said = self.run_one('--spp', '8', '--tev', str(port))
        self.check_warned(said, 'warning', '127.0.0.1', str(port), 'refused')
        self.check_bits()

    def test_an_unknown_host(self):
        said = self.run_one('--spp', '8', '--tev', 'no-such-host.invalid')
        self.check_warned(said, 'no-such-host.invalid', '14158')
        self.check_bits()

    def test_a_peer_that_closes_midway(self):
        def close_midway(connection, _):
            receive(connection, 5000)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
        server = Server(close_midway)
        said = self.run_one('--spp', '8', '--tev', str(server.port))
        server.close()
        self.check_warned(said, 'the connection was lost')
        self.check_bits()

    @by_the_clock
    def test_a_peer_that_never_reads(self):
        done = threading.Event()
        server = Server(lambda connection, _: done.wait(60), buffer=4096)
        start = time.monotonic()
        said = self.run_one(*LARGE, '--tev', str(server.port), size='400x300')
        took = time.monotonic() - start
        done.set()
        server.close()
        self.check_warned(said, 'accepted no data for 3 s')
        self.assertLess(took, 30)

    def test_paths_are_no_pictures(self):
        result = subprocess.run(self.command('--pixel', '1,1', '--tev', '1'), timeout=60,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, 2)
        self.assertIn('--tev and --pixel exclude each other', result.stderr)

    def test_bad_addresses(self):
        for text in ('', ':', ':0', '127.0.0.1:', 'host:65536', 'host:port', 'http://host:1',
                     '[::1', 'a b', '[]:1', '70000 '):
            result = subprocess.run(self.command('--tev', text), stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, text=True, timeout=60)
            self.assertEqual(result.returncode, 2, (text, result.stderr))
            self.assertIn('--tev: ', result.stderr)
            self.assertIn('expected HOST:PORT', result.stderr)


class Slow(Base):
    @by_the_clock
    def test_a_peer_that_hardly_reads(self):
        done = threading.Event()

        def trickle(connection, _):
            while not done.is_set() and connection.recv(1):
                time.sleep(0.02)
        server = Server(trickle, buffer=4096)
        start = time.monotonic()
        said = self.run_one(*LARGE, '--tev', str(server.port), size='400x300')
        took = time.monotonic() - start
        done.set()
        self.check_warned(said, '--tev')
        self.assertLess(took, 40)
        try:
            server.close()
        except OSError:
            pass  # the connection was closed


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
