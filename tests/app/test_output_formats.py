#!/usr/bin/env python3
"""Reads every image format with another program, OpenImageIO's oiiotool.

Usage: test_output_formats.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SOURCE = os.path.abspath(sys.argv.pop(1))
SIZE = 37, 23
# The greatest permitted difference from the EXR, relative to each value: steps of RGBE are at most 1/128, and
# those of 16 bits 1/65535. JPEG is quantised, so its root mean square difference from the PNG is tested
# instead.
FORMATS = {'a.hdr': 1 / 255, 'a.pfm': 0}


class Formats(unittest.TestCase):
    def setUp(self):
        if not shutil.which('oiiotool'):
            if os.environ.get('LAMPYRIS_NO_SKIP'):
                self.fail('there is no oiiotool (openimageio-tools)')
            self.skipTest('there is no oiiotool (openimageio-tools)')
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def render(self, *arguments):
        subprocess.run([LAMPYRIS, 'render', os.path.join(SOURCE, 'scenes', 'cornell.json'), '-q', '--spp', '4',
                        '--size', '%dx%d' % SIZE, *arguments], cwd=self.folder, check=True)

    def tool(self, *arguments):
        done = subprocess.run(['oiiotool', *arguments], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              encoding='utf-8')
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def values(self, name, greatest=1):
        """Returns three numbers for each pixel, row by row, as fractions of the greatest code."""
        text = self.tool('--dumpdata', name)
        rows = re.findall(r'Pixel \(\d+, \d+\): ([-+.\de ]+)', text)
        self.assertEqual(len(rows), SIZE[0] * SIZE[1], name)
        return [[float(number) / greatest for number in row.split()[:3]] for row in rows]

    def test_linear(self):
        self.render('-o', 'a.exr', '-o', 'a.hdr', '-o', 'a.pfm')
        wanted = self.values('a.exr')
        self.assertGreater(max(map(max, wanted)), 1)
        for name, bound in FORMATS.items():
            for pixel, expected in zip(self.values(name), wanted):
                for value, number in zip(pixel, expected):
                    # oiiotool prints nine digits.
                    self.assertLessEqual(abs(value - number), bound * max(expected) + 1e-8 * abs(number), name)
        self.assertIn('cornell.json', open(os.path.join(self.folder, 'a.hdr'), 'rb').read(4000).decode('latin1'))

    def test_codes(self):
        self.render('-o', 'a.png', '-o', 'a.jpg')
        self.render('-o', 'b.png', '--png16')
        self.assertIn('uint16', self.tool('--info', 'b.png'))
        fine, coarse, lossy = self.values('b.png', 65535), self.values('a.png', 255), self.values('a.jpg', 255)
        squares = 0
        for a, b, c in zip(fine, coarse, lossy):
            for x, y, z in zip(a, b, c):
                self.assertLessEqual(abs(x - y), 0.5 / 255 + 1 / 65535)
                squares += (y - z) ** 2
        # With four samples the picture is noisy: every pixel differs from its neighbours.
        self.assertLess((squares / (3 * len(fine))) ** 0.5, 8 / 255)
        self.assertIn('cornell.json', self.tool('--info', '-v', 'a.jpg'))


if __name__ == '__main__':
    unittest.main()
