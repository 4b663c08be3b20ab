#!/usr/bin/env python3
"""Scenes that demonstrate an effect must show that effect.

    test_scenes.py LAMPYRIS SOURCE_ROOT
"""
import json
import os
import sys
import tempfile
import unittest

import png_pixels
from program import checked, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))


def scene(name):
    return os.path.join(ROOT, 'scenes', name)


def info(name, *arguments):
    return json.loads(checked(LAMPYRIS, 'info', scene(name), '--json', *arguments))


def picture(name, *arguments):
    """Returns the display values of a scene's picture as rows of (r, g, b)."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'out.png')
        checked(LAMPYRIS, 'render', scene(name), '-q', '-o', path, *arguments)
        width, _, rows = png_pixels.read(path)
        return [[tuple(row[3 * x:3 * x + 3]) for x in range(width)] for row in rows]


def mean(pixels):
    pixels = list(pixels)
    return sum(sum(p) for p in pixels) / (3 * len(pixels))


class Scenes(unittest.TestCase):
    def test_whitted_beside_path(self):
        # With Whitted's model the box's ceiling is black, except for the light that the lamp's edge reflects
        # to it: no shadow ray from the ceiling reaches the lights. With path tracing, walls and floor light
        # it.
        shown = {}
        for integrator in ('whitted', 'path'):
            rows = picture('sdf_box.json', '--size', '40x40', '--spp', '8', '--integrator', integrator)
            shown[integrator] = {
                'ceiling': mean(rows[y][x] for y in (3, 4) for x in range(7, 12)),
                'floor': mean(rows[y][x] for y in (35, 36) for x in range(10, 30))}
        self.assertLess(shown['whitted']['ceiling'], 1)
        self.assertGreater(shown['path']['ceiling'], 40)
        self.assertGreater(shown['whitted']['floor'], 20)
        self.assertGreater(shown['path']['floor'], shown['whitted']['floor'])

    def test_the_published_spheres(self):
        # The 87 shapes include the plane on which the spheres stand.
        self.assertEqual(info('phong_spheres.json')['shapes'], 87)

    def test_figures(self):
        # The floor is an analytic disc; two lamps have four triangles, and two stones have 24.
        triangles = info('figures.json', '-D', 'dragon_triangles=20000')['triangles']
        self.assertTrue(0.95 * 30528 < triangles < 1.05 * 30528, triangles)

    def test_the_sky_has_a_sun(self):
        # The image lights the near side of a ball, and the shadow is on the other side.
        rows = picture('sky.json', '--env', scene('models/sky.hdr'), '--size', '48x30', '--spp', '16',
                       '--exposure', '0')
        sky = mean(rows[0])
        self.assertGreater(sky, 60)
        self.assertGreater(max(sum(p) for row in rows for p in row), 2 * min(sum(p) for row in rows[15:] for p in row))


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
