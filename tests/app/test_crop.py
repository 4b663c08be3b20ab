#!/usr/bin/env python3
"""--crop: a window of the picture has the bits of the whole, says where it is, and is refused where it
cannot be had.

Usage: test_crop.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import struct
import sys
import tempfile
import unittest
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))
import program

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SOURCE = os.path.abspath(sys.argv.pop(1))
WIDTH, HEIGHT = 40, 29
SIZE = ('--size', f'{WIDTH}x{HEIGHT}')
WINDOW = (9, 4, 31, 23)


def scene(name):
    return os.path.join(SOURCE, 'scenes', name + '.json')


def text(data, at):
    end = data.index(b'\0', at)
    return data[at:end].decode(), end + 1


def channels_of(body):
    """Of the attribute: (name, bytes of a value) in the file's order."""
    found, at = [], 0
    while body[at] != 0:
        name, at = text(body, at)
        found.append((name, 2 if struct.unpack_from('<i', body, at)[0] == 1 else 4))
        at += 16
    return found


def unpacked(data, size):
    """A block of ZIP compression (OpenEXR, "ZIP compression"): differences of bytes, whose even and
    odd places are apart."""
    if len(data) == size:
        return data
    bytes_ = bytearray(zlib.decompress(data))
    for i in range(1, len(bytes_)):
        bytes_[i] = (bytes_[i - 1] + bytes_[i] - 128) & 255
    half = (len(bytes_) + 1) // 2
    out = bytearray(len(bytes_))
    out[0::2], out[1::2] = bytes_[:half], bytes_[half:]
    return bytes(out)


def exr(path):
    """The attributes, and the lines of each channel by its name."""
    with open(path, 'rb') as file:
        data = file.read()
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = text(data, at)
        _, at = text(data, at)
        size = struct.unpack_from('<i', data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    left, top, right, bottom = struct.unpack('<4i', attributes['dataWindow'])
    channels = channels_of(attributes['channels'])
    width = right - left + 1
    lines = {name: {} for name, _ in channels}
    blocks = (bottom - top + 16) // 16
    for offset in struct.unpack_from(f'<{blocks}Q', data, at + 1):
        first, size = struct.unpack_from('<ii', data, offset)
        count = min(16, bottom + 1 - first)
        raw = unpacked(data[offset + 8:offset + 8 + size],
                       count * width * sum(bytes_ for _, bytes_ in channels))
        place = 0
        for y in range(first, first + count):
            for name, bytes_ in channels:
                lines[name][y] = raw[place:place + width * bytes_]
                place += width * bytes_
    return attributes, lines


def window_of(attribute):
    left, top, right, bottom = struct.unpack('<4i', attribute)
    return left, top, right + 1, bottom + 1


def pfm(path):
    """The width, the height, and the lines from the top."""
    with open(path, 'rb') as file:
        kind, size, _ = (file.readline() for _ in range(3))
        assert kind == b'PF\n'
        width, height = (int(word) for word in size.split())
        lines = [file.read(width * 12) for _ in range(height)]
    return width, height, lines[::-1]


class Folder(program.FolderCase):
    def render(self, *arguments, code=0):
        result = program.run(LAMPYRIS, 'render', *arguments, cwd=self.folder)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def same(self, *arguments, window=WINDOW, split=()):
        """`split`: options for the window alone, which change no bit."""
        self.render(*arguments, '-o', 'whole.pfm')
        self.render(*arguments, *split, '--crop', ','.join(map(str, window)), '-o', 'part.pfm')
        x0, y0, x1, y1 = window
        _, _, whole = pfm(self.path('whole.pfm'))
        width, height, part = pfm(self.path('part.pfm'))
        self.assertEqual((width, height), (x1 - x0, y1 - y0))
        self.assertEqual(part, [line[12 * x0:12 * x1] for line in whole[y0:y1]], arguments)


class Bits(Folder):
    def test_windows_everywhere(self):
        for window in (WINDOW, (0, 0, WIDTH, HEIGHT), (0, 0, 1, 1), (WIDTH - 1, HEIGHT - 1, WIDTH, HEIGHT),
                       (0, 11, WIDTH, 12), (17, 0, 18, HEIGHT)):
            self.same(scene('cornell'), *SIZE, '--spp', '4', window=window)

    def test_samplers(self):
        for sampler in ('pcg', 'lcg', 'sobol', 'blue-noise', 'stratified', 'sine'):
            self.same(scene('cornell'), *SIZE, '--spp', '4', '--sampler', sampler)

    def test_methods(self):
        for arguments in (('--aperture', '30', '--focus-distance', '2'),
                          ('--filter', 'gaussian', '--filter-radius', '1.7'),
                          ('--integrator', 'ao'), ('--integrator', 'whitted'),
                          ('--split-lobes', '2'), ('--halves', 'contiguous')):
            self.same(scene('cornell'), *SIZE, '--spp', '4', *arguments)

    def test_scenes(self):
        for name in ('glass', 'all_classes'):
            self.same(scene(name), *SIZE, '--spp', '2')

    def test_waves_and_frames_and_resumed_runs(self):
        self.same(scene('cornell'), *SIZE, '--spp', '8', split=('--wave', '64'))
        self.same(scene('cornell'), *SIZE, '--frames', '3', '--spp-per-frame', '2')
        command = (scene('cornell'), *SIZE, '--crop', '9,4,31,23', '--checkpoint', 'c', '-o', 'a.pfm')
        self.render(*command, '--spp', '4')
        self.render(*command, '--spp', '16', '--resume')
        resumed = pfm(self.path('a.pfm'))
        self.same(scene('cornell'), *SIZE, '--spp', '16')
        self.assertEqual(resumed, pfm(self.path('part.pfm')))
        # A checkpoint of another window is another render's.
        error = self.render(*command[:4], '8,4,31,23', *command[5:], '--spp', '16', '--resume', code=2).stderr
        self.assertIn('was made with --crop=9,4,31,23', error)

    def test_layers(self):
        arguments = (scene('cornell'), *SIZE, '--spp', '4', '--aov', 'all')
        self.render(*arguments, '-o', 'whole.exr')
        self.render(*arguments, '--crop', '9,4,31,23', '-o', 'part.exr')
        whole, lines = exr(self.path('whole.exr'))
        part, window = exr(self.path('part.exr'))
        self.assertEqual(lines.keys(), window.keys())
        self.assertGreater(len(lines), 30)
        for name in lines:
            bytes_ = len(window[name][4]) // (31 - 9)
            self.assertEqual(sorted(window[name]), list(range(4, 23)))
            for y in range(4, 23):
                self.assertEqual(window[name][y], lines[name][y][9 * bytes_:31 * bytes_], (name, y))
        # "OpenEXR Technical Introduction": windows have both corners.
        self.assertEqual(window_of(part['dataWindow']), WINDOW)
        self.assertEqual(window_of(part['displayWindow']), (0, 0, WIDTH, HEIGHT))
        self.assertEqual(window_of(whole['dataWindow']), (0, 0, WIDTH, HEIGHT))
        self.assertEqual(part['lampyris:crop'], b'9,4,31,23')
        self.assertNotIn('lampyris:crop', whole)

    def test_turned_views(self):
        command = (scene('cornell'), *SIZE, '--spp', '2', '--turntable', '3')
        self.render(*command, '-o', 'w_#.pfm')
        self.render(*command, '--crop', '9,4,31,23', '-o', 'p_#.pfm')
        for i in (1, 2, 3):
            _, _, whole = pfm(self.path(f'w_{i}.pfm'))
            self.assertEqual(pfm(self.path(f'p_{i}.pfm')), (22, 19, [line[108:372] for line in whole[4:23]]))


class Reports(Folder):
    def test_png_is_the_window_alone(self):
        command = (scene('cornell'), *SIZE, '--spp', '4', '-o')
        self.render(*command, 'a.png', '--crop', '9,4,31,23')
        with open(self.path('a.png'), 'rb') as file:
            self.assertEqual(struct.unpack('>II', file.read()[16:24]), (22, 19))

    def test_the_error_is_the_windows(self):
        import jsonschema
        command = (scene('cornell'), *SIZE, '--spp', '16', '--json', '-o', 'a.exr')
        whole = json.loads(self.render(*command).stdout)
        lamp = json.loads(self.render(*command, '--crop', '0,20,10,29').stdout)
        self.assertNotIn('crop', whole)
        self.assertEqual(lamp['crop'], [0, 20, 10, 29])
        self.assertEqual((lamp['width'], lamp['height']), (10, 9))
        self.assertLess(lamp['rays']['closest'], whole['rays']['closest'] / 5)
        self.assertNotEqual(lamp['error']['at_most'], whole['error']['at_most'])
        with open(os.path.join(SOURCE, 'docs', 'render.schema.json'), encoding='utf-8') as file:
            jsonschema.Draft202012Validator(json.load(file)).validate(lamp)
        text_ = self.render(*command[:-3], '-o', 'a.exr', '--crop', '0,20,10,29').stdout
        self.assertIn('window    from 0,20 of 40 x 29 pixels', text_)

    def test_paths_are_those_of_the_whole_picture(self):
        values = json.loads(self.render(scene('cornell'), *SIZE, '--spp', '16', '--error-by', 'all', '--crop',
                                        '9,4,31,23', '--json', '-o', 'a.exr').stdout)
        paths = values['error_by']['brightest']
        self.assertGreater(len(paths), 0)
        for path in paths:
            x, y = path['pixel']
            self.assertTrue(9 <= x < 31 and 4 <= y < 23, path)
            self.assertNotIn('--crop', path['command'])
        words = paths[0]['command'].split()
        followed = program.run(LAMPYRIS, *words[1:], '--json', cwd=self.folder)
        self.assertEqual(followed.returncode, 0, followed.stderr)
        # The path that is followed brought at least what the report says of it.
        radiance = json.loads(followed.stdout)['radiance']
        self.assertGreaterEqual(sum(radiance), 0.999 * sum(paths[0]['radiance']))

    def test_the_picture_can_be_made_again(self):
        self.render(scene('cornell'), *SIZE, '--spp', '2', '--crop', '1,2,5,6', '-o', 'a.exr')
        repeat = exr(self.path('a.exr'))[0]['lampyris:repeat'].decode()
        self.assertIn('--crop 1,2,5,6', repeat)


class Refusals(Folder):
    def test_what_is_no_window(self):
        for crop, words in (('1,2,3', 'not of the form X0,Y0,X1,Y1'), ('1,2,3,4,5', 'not of the form'),
                            ('a,0,1,1', 'not of the form'), ('-1,0,4,4', 'not of the form'),
                            ('5,0,5,4', 'has no pixel; expected X0 < X1'), ('0,4,4,3', 'has no pixel'),
                            ('0,0,41,29', 'exceeds the picture of 40 x 29 pixels'),
                            ('0,0,40,30', 'X1 of at most 40 and Y1 of at most 29')):
            self.assertIn(words, self.render(scene('cornell'), *SIZE, f'--crop={crop}', code=2).stderr)

    def test_what_needs_the_whole(self):
        for more, words in ((('--integrator', 'bidir'), 'cannot have --crop, because a light path may'),
                            (('--adaptive', 'on'), '--crop and --adaptive on exclude each other'),
                            (('--shard', '1/2'), '--crop and --shard exclude each other'),
                            (('--reference', 'a.exr'), '--crop and --reference exclude'),
                            (('--pixel', '1,1'), '--crop and --pixel exclude each other')):
            error = self.render(scene('cornell'), *SIZE, '--spp', '16', '--crop', '0,0,9,9', *more, code=2).stderr
            self.assertIn(words, error)
        self.assertEqual(os.listdir(self.folder), [])
        self.render(scene('cornell'), *SIZE, '--spp', '1', '--crop', '0,0,9,9', '--adaptive', 'off', '-o',
                    'a.pfm')


if __name__ == '__main__':
    program.need_device(LAMPYRIS)
    unittest.main()
