#!/usr/bin/env python3
"""Tests findings of `lampyris check SCENE` that are measured, and the predicted cost of a render.

Usage: test_check_scene_measured.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import math
import os
import subprocess
import unittest
import unittest.mock

from program import limits
from scene_checks import Checks, FRONT, GREY, LAMPYRIS, box, write_exr


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

    def test_a_sun_without_strength(self):
        scene = self.scene(False)
        texels = [[(1.0, 1.0, 1.0)] * 32 for _ in range(16)]
        texels[3][7] = (2e5, 2e5, 2e5)
        write_exr(os.path.join(self.folder.name, 'sky.exr'), 32, 16, texels)
        scene['environment']['strength'] = 0
        found = self.check(scene)
        self.assert_found(found, {'black': 'wrong'})
        self.assertIn('strengths', found['black']['remedy'])


class LampTexels(Checks):
    """An image of a lamp over a floor. If the floor must not be lit, a wall is in between."""

    def found(self, bright, rest=0.5, wall=False, **material):
        texels = [[(rest, rest, rest)] * 8 for _ in range(8)]
        texels[3][5] = (bright, bright, bright)
        write_exr(os.path.join(self.folder.name, 'lamp.exr'), 8, 8, texels)
        image = [{'file': 'lamp.exr', 'parameters': {'emission': 'rgb'}}]
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 1, 4], 'target': [0, 0.5, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'lamp': {'emission': [1, 1, 1], 'textures': image, **material}},
            'environment': {'radiance': [0.5, 0.5, 0.5]},
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-5, 0, 5], 'u': [10, 0, 0],
                        'v': [0, 0, -10]},
                       {'type': 'quad', 'material': 'lamp', 'corner': [-1, 0.2, -1], 'u': [2, 0, 0],
                        'v': [0, 1.5, 0]}] + wall * [
                       {'type': 'quad', 'material': 'grey', 'corner': [-5, 0, -0.99], 'u': [10, 0, 0],
                        'v': [0, 9, 0]}]})

    def test_one_of_them(self):
        found = self.found(1e6)
        self.assertEqual(found['beyond-half']['level'], 'remark')
        # The area of 3 square metres is seen from a distance of 5 metres.
        self.assertAlmostEqual(found['beyond-half']['share'],
                               3 / (10 * math.tan(math.radians(20))) ** 2, delta=0.02)
        self.assertEqual(found['one-texel-lamp']['level'], 'slow')
        self.assertIn('(5, 3) of 8 x 8 emits 100 %', found['one-texel-lamp']['figure'])
        self.assertGreater(found['one-texel-lamp']['share'], 0.3)
        for finding in (found['beyond-half'], found['one-texel-lamp']):
            self.assertRegex(finding['place'], r'^image .*lamp\.exr$')

    def test_none_of_them(self):
        """Images without a finding: a texel no brighter than others, 8-bit images, and an image that lights
        nothing visible."""
        for found in (self.found(40), self.found(1, rest=0.001), self.found(1e6, wall=True)):
            self.assertFalse(set(found) & {'beyond-half', 'one-texel-lamp'})
        self.assertEqual(set(self.found(6e4)) & {'beyond-half', 'one-texel-lamp'}, {'one-texel-lamp'})
        self.assertEqual(set(self.found(6e4, emission=[2, 2, 2])) & {'beyond-half'}, {'beyond-half'})


class Settings(Checks):
    def scene(self, bounces, **settings):
        return {'camera': {'position': [0, 0, 4], 'target': [0, 0, 0], 'fov_degrees': 60},
                'materials': {'pale': {'base_color': [0.85, 0.85, 0.85]}, 'lamp': {'emission': [9, 9, 9]}},
                'settings': {'max_bounces': bounces, **settings},
                'lights': [{'type': 'point', 'position': [1, 1, 1], 'intensity': [1, 1, 1]}],
                'shapes': [{'type': 'sphere', 'material': 'pale', 'center': [0, 0, 0], 'radius': 5},
                           {'type': 'sphere', 'material': 'lamp', 'center': [0, 0, -2], 'radius': 1}]}

    def test_depth(self):
        """In a closed sphere of albedo a, n bounces have all light except the fraction a^(n + 1)."""
        fixed = os.path.join(self.folder.name, 'fixed.json')
        found = self.check(self.scene(4, nee_depth=2), '--fix', fixed)
        self.assert_found(found, {'depth': 'wrong', 'biased-setting': 'wrong'})
        self.assertGreater(float(found['depth']['figure'].split('add ')[1].split(' %')[0]), 20)
        self.assertEqual(found['depth']['change'], 'max_bounces is 64')
        self.assert_found(self.check_file(fixed), {})
        self.assert_found(self.check(self.scene(100)), {})

    def test_depth_asked_for(self):
        self.assert_found(self.check(self.scene(1)), {'depth': 'remark'})


class Noise(Checks):
    def scene(self, radius):
        """A lamp of 1 W/sr over a floor, with a ball of rough metal."""
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


class Outlook(Checks):
    def lines(self, radius):
        """Returns the findings for a floor on which a mirror ball focuses the light of a lamp out of view."""
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
        """No finding mentions caustics that no sample has found, but the outlook allows for them."""
        self.assertRegex(self.lines(0.01), 'takes at most [0-9]{6} spp, .*; at most, since no path '
                         'has hit the brightest light, which paths find only by chance\n$')
        self.assertRegex(self.lines(0.1), 'takes about [0-9]{4} spp, .* on the device\n$')


class Range(Checks):
    def scene(self, height):
        """The point on a floor below a light of 1e30 W/sr at this height."""
        return {'camera': {**FRONT, 'height': 6e-6}, 'materials': {'grey': GREY},
                'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-4, -4, 0], 'u': [8, 0, 0],
                            'v': [0, 8, 0]}],
                'lights': [{'type': 'point', 'position': [0, 0, height], 'intensity': [1e30] * 3}]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(1e-5))  # the irradiance is 1e40 W/m^2
        self.assert_found(found, {'not-finite': 'wrong'})
        # Two renders have 64 samples per pixel each; the findings come from the last one.
        self.assertRegex(found['not-finite']['figure'], f'^{64 * 48 * 48} contributions of ')
        self.assert_found(self.check(self.scene(1e-3)), {})


class Memory(Checks):
    def test_too_little_for_usual_waves(self):
        """Every render of a check adapts to the available memory with smaller waves, as all renders do."""
        scene = {'camera': FRONT, 'materials': {'plastic': {'type': 'principled', 'roughness': 0.4}},
                 'environment': {'radiance': [1, 1, 1]}, 'film': {'width': 64, 'height': 64},
                 'shapes': [{'type': 'sphere', 'material': 'plastic', 'center': [0, 0, 0], 'radius': 2}]}
        for limit in ('memory', 'memory-budget'):
            for most in (1250000, 3000000):
                with unittest.mock.patch.dict(os.environ, LAMPYRIS_LIMITS=limits(f'{limit}={most}')):
                    self.assert_found(self.check(scene), {})
                self.assertLess(self.result['outlook']['device_bytes'], most)


if __name__ == '__main__':
    unittest.main()
