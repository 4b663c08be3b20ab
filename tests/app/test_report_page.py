#!/usr/bin/env python3
"""Clicks through the page of `compare --report` in a browser: pixel values, flipping, zoom, exposure, errors,
crops, saved figures, and that the page requests nothing from the network.

test_report_page.py LAMPYRIS [unittest's arguments]; skipped (77) without chromium.
"""
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import program
from browser import Browser, find
from exr_file import exr

LAMPYRIS = sys.argv.pop(1)
find()
SIZE = 32, 24


# The values are negative, above the display's range, or (in one pixel) not finite.
def picture(x, y):
    if (x, y) == (3, 2):
        return (math.nan, 1.0, 2.0)
    return (0.1 + 40.0 * x, 0.001234567 * y, -0.25 if x == 0 else 0.5)


def reference(x, y):
    return (0.1 + 40.0 * x, 0.001234567 * y, 0.5 if x < 16 else 0.25)


# A constant grey, so that all displayed pixels are known.
def grey(x, y):
    return (0.18, 0.18, 0.18)


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.page = os.path.join(cls.folder.name, 'page.html')
        names = [os.path.join(cls.folder.name, name)
                 for name in ('a.exr', 'grey.exr', 'r<!--<script>.exr')]
        for name, pixels in zip(names, (picture, grey, reference)):
            exr(name, *SIZE, pixels)
        out = program.checked(LAMPYRIS, 'compare', *names, '--report', cls.page)
        assert f'wrote   {cls.page}\n' in out, out
        cls.browser = Browser(1200, 900)
        cls.addClassCleanup(cls.browser.__exit__)

    def setUp(self):
        self.browser.open(self.page)
        self.browser.wait('document.querySelector(".viewer").dataset.ready === "true"')
        self.browser.wait('document.querySelectorAll(".paper svg").length === 3')
        self.browser.run('document.querySelector(".viewer canvas").scrollIntoView({block: "center"})')

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    # Returns the position of a picture's pixel in the window.
    def at(self, x, y):
        left, top, width, height = self.browser.run('''(() => {
            const b = document.querySelector(".viewer-stage canvas").getBoundingClientRect();
            return [b.left, b.top, b.width, b.height];
        })()''')
        scale = self.scale()
        return (left + width / 2 + (x + 0.5 - SIZE[0] / 2) * scale, top + height / 2 + (y + 0.5 - SIZE[1] / 2) * scale)

    def scale(self):
        text = self.browser.run('document.querySelector(".viewer-tools output").value')
        return float(text[:-1]) if text.endswith('\u00d7') else float(text[:-2]) / 100

    def values(self):
        """Returns the table under the picture: its header, and one row per picture."""
        return self.browser.run('''[document.querySelector(".viewer-under h3").textContent].concat(
            Array.from(document.querySelectorAll(".viewer-values tr:not(:first-child)"),
                       row => Array.from(row.querySelectorAll("td"), cell => cell.textContent)))''')

    # Returns the colour of the canvas at a position of the window.
    def shown(self, x, y):
        return self.browser.run(f'''(() => {{
            const canvas = document.querySelector(".viewer-stage canvas"), b = canvas.getBoundingClientRect();
            return Array.from(canvas.getContext("2d").getImageData({x} - b.left, {y} - b.top, 1, 1).data).slice(0, 3);
        }})()''')

    def name(self):
        return self.browser.run('document.querySelector(".viewer-name").textContent')

    def frame(self):
        self.browser.run('new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))')

    def choose(self, selector, value):
        self.browser.run(f'''(() => {{ const e = document.querySelector({selector!r}); e.value = {value!r};
            e.dispatchEvent(new Event("change")); }})()''')
        self.frame()

    def test_values_are_those_of_the_files(self):
        for x, y in ((5, 7), (31, 23), (0, 11)):
            self.browser.mouse('mouseMoved', *self.at(x, y))
            head, *rows = self.values()
            self.assertEqual(head, f'Pixel {x}, {y}')
            for row, pixels in zip(rows, (picture, grey, reference)):
                for text, value in zip(row, pixels(x, y)):
                    self.assertEqual(struct.pack('f', float(text)), struct.pack('f', value))
        # The number that the map shows: the mean over channels of |x - r| / (|r| + 0.01).
        error = sum(abs(a - b) / (abs(b) + 0.01) for a, b in zip(picture(0, 11), reference(0, 11))) / 3
        self.assertTrue(math.isclose(float(rows[0][3]), error, rel_tol=1e-3), rows)
        self.browser.mouse('mouseMoved', *self.at(3, 2))
        self.assertEqual(self.values()[1][0], 'NaN')
        self.assertEqual(self.values()[1][3], 'NaN')

    def test_flipping_by_keys(self):
        for key, name in (('2', 'grey.exr'), ('3', 'r<!--<script>.exr'), ('1', 'a.exr')):
            self.browser.key(key)
            self.assertEqual(self.name(), name)
        self.browser.click('.viewer-tabs button:nth-child(2)')
        self.assertEqual(self.name(), 'grey.exr')
        self.frame()
        self.assertEqual(self.shown(*self.at(20, 20)), [118] * 3)

    def test_exposure(self):
        self.browser.key('2')
        for key, modifiers, light in (('e', 0, 0.18 * math.sqrt(2)), ('E', 8, 0.18), ('E', 8, 0.18 / math.sqrt(2))):
            self.browser.key(key, modifiers)
            self.frame()
            code = round(255 * (1.055 * light ** (1 / 2.4) - 0.055))
            self.assertEqual(self.shown(*self.at(20, 20)), [code] * 3)
        self.choose('.viewer-tools input[type=number]', '10')
        self.assertEqual(self.shown(*self.at(20, 20)), [255] * 3)

    def test_zoom_and_pan(self):
        before = self.scale()
        self.browser.click_at(*self.at(10, 10))
        x, y = self.at(8, 6)
        self.browser.mouse('mouseWheel', x, y, deltaX=0, deltaY=-600)
        self.frame()
        self.assertTrue(math.isclose(self.scale(), min(4 * before, 128), rel_tol=0.01))
        self.browser.mouse('mouseMoved', x, y)
        self.assertEqual(self.values()[0], 'Pixel 8, 6')  # the pixel under the cursor stays there
        scale = self.scale()
        self.browser.drag((x, y), (x + 2 * scale, y))
        self.browser.mouse('mouseMoved', x, y)
        self.assertEqual(self.values()[0], 'Pixel 6, 6')
        self.browser.key('f')
        self.frame()
        self.assertEqual(self.scale(), before)
        self.browser.key('-')
        self.frame()
        self.assertEqual(self.scale(), before / 2)

    def test_the_pixel_by_keys(self):
        self.browser.click_at(*self.at(10, 10))
        self.browser.mouse('mouseMoved', *self.at(10, 10))
        for key in ('ArrowRight', 'ArrowRight', 'ArrowUp'):
            self.browser.key(key)
        self.assertEqual(self.values()[0], 'Pixel 12, 9')

    def test_errors_in_false_colours(self):
        self.choose('.viewer-tools select', 'relative')
        self.assertIn('relative: ', self.name())
        self.assertEqual(self.shown(*self.at(5, 7)), [0, 0, 0])  # the pixels are equal
        self.assertEqual(self.shown(*self.at(3, 2)), [0, 255, 0])  # the pixel is not finite
        red, _, blue = self.shown(*self.at(20, 7))
        self.assertGreater(red, blue)
        self.choose('.viewer-tools select', 'flip')
        told = []
        for x in (8, 24):  # an equal and a different pixel
            self.browser.mouse('mouseMoved', *self.at(x, 12))
            told.append(float(self.values()[1][3]))
        self.assertLess(told[0], told[1])

    def test_splitting(self):
        self.browser.key('2')
        self.browser.key('s')
        self.frame()
        self.assertEqual(self.shown(*self.at(2, 20)), [118] * 3)
        self.assertNotEqual(self.shown(*self.at(30, 20)), [118] * 3)

    def crops(self):
        return self.browser.run('''Array.from(document.querySelectorAll(".viewer-crops tr:not(:first-child)"),
            row => Array.from(row.querySelectorAll("input"), box => Number(box.value)))''')

    def test_crops(self):
        while self.crops():
            self.browser.click('.viewer-crops button')
        self.browser.click('.viewer-tools .group:last-child button:last-child')
        self.browser.place('.viewer-stage canvas')
        (x0, y0), (x1, y1) = self.at(4, 3), self.at(12, 9)
        half = self.scale() / 2
        self.browser.drag((x0 - half, y0 - half), (x1 - half, y1 - half))
        self.assertEqual(self.crops(), [[4, 3, 8, 6]])
        # All pictures are cropped equally: each has one inset, and the reference has the frame.
        self.browser.wait('document.querySelectorAll(".insets svg image").length === 4')
        self.choose('.viewer-crops input', '20')
        self.assertEqual(self.crops(), [[20, 3, 8, 6]])
        self.browser.key('Escape')

    def test_saved_figures_open(self):
        for figure, name in (('insets', 'insets'), ('intervals', 'errors'), ('distribution', 'distribution')):
            for button, kind in ((1, 'svg'), (2, 'pdf')):
                self.browser.click(f'figure.{figure} .figure-bar button:nth-of-type({button})')
                data = self.browser.download(f'{name}.{kind}')
                with self.subTest(f'{name}.{kind}'):
                    self.look_at(data, kind)

    # Tests a file with other programs if they are installed, and its structure in any case.
    def look_at(self, data, kind):
        path = os.path.join(self.folder.name, 'figure.' + kind)
        with open(path, 'wb') as file:
            file.write(data)
        if kind == 'svg':
            text = data.decode()
            self.assertRegex(text, r'^<\?xml[^>]*>\n<svg [^>]*xmlns="http://www.w3.org/2000/svg"')
            command = ['rsvg-convert', path, '-o', path + '.png']
        else:
            self.check_pdf(data)
            command = ['pdftoppm', '-r', '72', '-png', '-singlefile', path, path]
        if shutil.which(command[0]):
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ''))
            self.assertGreater(os.path.getsize(path + '.png'), 1000)

    # Every object begins where the table says, and every stream has its length and can be decompressed.
    def check_pdf(self, data):
        self.assertTrue(data.startswith(b'%PDF-1.4\n') and data.endswith(b'%%EOF\n'))
        table = int(re.search(rb'startxref\n(\d+)\n', data)[1])
        self.assertTrue(data[table:].startswith(b'xref\n'))
        offsets = [int(row) for row in re.findall(rb'(\d{10}) 00000 n ', data[table:])]
        for number, offset in enumerate(offsets, 1):
            self.assertTrue(data[offset:].startswith(b'%d 0 obj\n' % number), number)
        words = b''
        for match in re.finditer(rb'/Length (\d+) >>\nstream\n', data):
            packed = data[match.end():match.end() + int(match[1])]
            self.assertTrue(data[match.end() + int(match[1]):].startswith(b'\nendstream'))
            words += zlib.decompress(packed)
        self.assertIn(b' Tj ET', words)


class Others(unittest.TestCase):
    """The viewer and the plots in the reports of converge and bench."""

    def look(self, command, pictures, *arguments):
        scene = os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'scenes', 'cornell.json')
        with tempfile.TemporaryDirectory() as folder:
            out = program.checked(LAMPYRIS, command, scene, '--size', '12x8', *arguments, '--report', folder)
            self.assertIn(f'wrote   {folder}/report.html', out)
            for width in (1200, 800):
                with Browser(width, 900) as browser:
                    browser.open(os.path.join(folder, 'report.html'))
                    browser.wait('document.querySelector(".viewer").dataset.ready === "true"')
                    self.assertEqual(browser.run('document.querySelectorAll(".viewer-tabs button").length'), pictures)
                    # No element is wider than the window, and scrolling elements show a scroll bar.
                    self.assertEqual(browser.run('document.documentElement.scrollWidth'), width)
                    browser.click('figure.plot button:nth-of-type(2)')
                    name = browser.run('document.querySelector("figure.plot").dataset.name')
                    Page.check_pdf(self, browser.download(name + '.pdf'))
                    self.assertEqual(browser.complaints(), [])

    def test_converge(self):
        self.look('converge', 3, '--spp-from', '2', '--spp', '4', '--replicates', '2', '--vary', 'sampler=sobol,pcg')

    def test_bench(self):
        self.look('bench', 2, '--sweep', 'max-bounces=1,2', '--repeats', '2', '--spp', '1')


if __name__ == '__main__':
    unittest.main()
