#!/usr/bin/env python3
"""Tests findings of `lampyris check SCENE` about light that is lost or found only by chance.

Usage: test_check_scene_light.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import math
import os
import re
import unittest

from scene_checks import Checks, FRONT, GREY, write_exr


class Light(Checks):
    def scene(self, planted):
        white = [1, 1, 1] if planted else [0.8, 0.8, 0.8]
        sdf = [{'type': 'plane', 'material': 'lamp', 'point': [0, -20, 0], 'normal': [0, 1, 0]}]
        slab = {'type': 'box', 'material': 'glass', 'min': [-2.9, 1, -0.9], 'max': [-0.1, 1.1, 0.9]}
        return {
            'camera': {**FRONT, 'position': [0, 3, 8]},
            'materials': {'white': {'base_color': white}, 'glass': {'type': 'dielectric'},
                          'lamp': {'emission': [5, 5, 5]},
                          'varnish': {'type': 'microfacet', 'base_color': [0.9] * 3, 'roughness': 0.1,
                                      'specular_color': [0.04] * 3,
                                      'diffuse': 'uncoupled' if planted else 'coupled'}},
            'lights': [{'type': 'point', 'position': [-1, 2.5, 0], 'intensity': [5, 5, 5]}],
            'shapes': [
                {'type': 'quad', 'material': 'white', 'corner': [-3, 0, 1], 'u': [6, 0, 0],
                 'v': [0, 0, -2]},
                {'type': 'sphere', 'material': 'lamp', 'center': [-2, 2.5, 0], 'radius': 0.2},
                {'type': 'sphere', 'material': 'varnish', 'center': [2, 0.5, 0], 'radius': 0.5},
                *(sdf + [slab] if planted else [])]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True), '--max-bounces', '64')
        self.assert_found(found, {'light-lost': 'wrong', 'light-by-chance': 'slow',
                                  'albedo-1': 'remark', 'gains-light': 'wrong',
                                  'lamp-unaimed': 'slow'})
        self.assertIn('glass', found['light-lost']['place'])
        self.assertIn('varnish', found['gains-light']['place'])
        self.assertIsNone(found['lamp-unaimed']['share'])
        self.assert_found(self.check(self.scene(False), '--max-bounces', '64'), {})

    def test_no_shadow_rays_and_no_bounces(self):
        found = self.check(self.scene(False), '--max-bounces', '64', '--nee', 'off')
        self.assertIn('nee', found['lamp-unaimed']['place'])
        found = self.check(self.scene(False), '--max-bounces', '0')
        self.assertIn('visible lamps', found['depth']['remedy'])


class Lost(Checks):
    """A light over a floor with a pane of glass in between, and a lamp beside it."""

    def found(self, *lights, lamp=1):
        self.write('up.ies', 'IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 0\n'
                   '0 45 90\n0\n1000 1000 0\n')
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 6, 6], 'target': [0, 0, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'glass': {'type': 'dielectric'},
                          'lamp': {'base_color': [0, 0, 0], 'emission': [lamp] * 3}},
            'lights': [{'type': 'point', 'position': [0, 2, -3], 'intensity': [1, 1, 1], **light}
                       for light in lights],
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0],
                        'v': [0, 0, -6]},
                       {'type': 'box', 'material': 'glass', 'min': [-9, 1.5, -3.5], 'max': [9, 1.6, -2]},
                       {'type': 'quad', 'material': 'lamp', 'corner': [-4, 0.1, 3], 'u': [0, 1, 0],
                        'v': [0, 0, -6]}]})

    def test_by_what_is_sent(self):
        def spot(y):
            return {'type': 'spot', 'direction': [0, y, 0], 'outer_degrees': 60}

        def profile(y):
            return {'profile': 'up.ies', 'direction': [0, y, 0]}
        for lost, sends_nothing in (({'range': 9}, {'range': 0.4}), (spot(-1), spot(1)),
                                    (profile(-1), profile(1)), ({}, {'intensity': [1e-9] * 3})):
            self.assertEqual(self.found(lost)['light-lost']['level'], 'wrong', lost)
            self.assertNotIn('light-lost', self.found(sends_nothing), sends_nothing)
        # One of 200 lights is behind glass; it has a thousandth of the light.
        grid = [{'position': [5 / 14 * (i % 14 - 7), 1.2, 5 / 14 * (i // 14 - 7)]} for i in range(199)]
        self.assertNotIn('light-lost', self.found(*grid, {'intensity': [2, 2, 2]}))
        many = 99 * [{'range': 0.4}]
        self.assertEqual(self.found(*many, {'intensity': [9, 9, 9]})['light-lost']['level'], 'wrong')
        self.assertNotIn('light-lost', self.found(*many))


class Mirrors(Checks):
    """A delta light over a floor, in front of a wall that may be a mirror."""

    def found(self, wall, **light):
        return self.check({
            'film': {'width': 32, 'height': 24},
            'camera': {'position': [0, 1, 5], 'target': [0, 1, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'wall': wall},
            'environment': {'radiance': [0.05, 0.05, 0.05]},
            'lights': [{'type': 'directional', 'direction': [0, -1, -1], 'irradiance': [3, 3, 3],
                        **light}],
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-5, 0, 5], 'u': [10, 0, 0],
                        'v': [0, 0, -10]},
                       {'type': 'quad', 'material': 'wall', 'corner': [-2, 0, -2], 'u': [4, 0, 0],
                        'v': [0, 3, 0]}]})

    def test_what_they_would_send_on(self):
        mirror = {'type': 'mirror', 'base_color': [0.95, 0.95, 0.95]}
        silver = {'type': 'conductor', 'metal': 'silver'}
        for wall in (mirror, {**silver, 'roughness': 0}):
            self.assertEqual(self.found(wall)['light-lost']['level'], 'wrong')
        for wall in (GREY, {**silver, 'roughness': 0.3}):
            self.assertNotIn('light-lost', self.found(wall))
        # the light is behind the mirror
        self.assertNotIn('light-lost', self.found(mirror, direction=[0, -1, 1]))
        self.assertNotIn('light-lost', self.found(mirror, angular_diameter_degrees=5))


class Chance(Checks):
    """Lamps over a floor, one of them behind glass. Findings depend on the light that reaches the floor, not
    on the number of lamps."""

    def found(self, glass, *lamps, more=()):
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 6, 6], 'target': [0, 0, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY, 'glass': {'type': 'dielectric'},
                          **{f'lamp{i}': {'base_color': [0, 0, 0], 'emission': [radiance] * 3}
                             for i, (_, radiance) in enumerate(lamps)}},
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0],
                        'v': [0, 0, -6]}, {**glass, 'material': 'glass'},
                       *({**shape, 'material': f'lamp{i}'} for i, (shape, _) in enumerate(lamps)), *more]})

    def test_of_bulbs(self):
        ball = {'type': 'sphere', 'center': [-0.5, 2, -2], 'radius': 0.3}
        bulb = {**ball, 'radius': 0.05}
        open_lamps = [{'type': 'sphere', 'center': [(i % 20 - 10) / 4, 2.5, -3 - (i // 20) / 4], 'radius': 0.02}
                      for i in range(199)]
        dim = [(lamp, 1e-6) for lamp in open_lamps]
        found = self.found(ball, (bulb, 10), *dim)
        self.assertEqual(found['light-by-chance']['level'], 'slow')
        self.assertGreater(found['light-by-chance']['share'], 0.5)
        self.assertRegex(found['light-by-chance']['figure'], r'^200 lamps.* (99\.\d|100) % of the direct light')
        self.assertNotIn('light-by-chance', self.found(ball, (bulb, 1e-6), *dim[1:], (open_lamps[0], 10)))
        # Half of the light, because another lamp of the same power is not behind glass.
        figure = self.found(ball, (bulb, 10), ({**bulb, 'center': [0.5, 2, -2]}, 10))['light-by-chance']['figure']
        self.assertAlmostEqual(float(re.search(r'blocks ([\d.]+) %', figure)[1]), 50, delta=5)

    def test_of_two_rooms(self):
        """A bulb in a glass ball in one room, and a lamp with 16 times its light in the other. All light of
        the first room is found by chance."""
        ball = {'type': 'sphere', 'center': [-2, 3, -1], 'radius': 0.2}
        wall = {'type': 'box', 'material': 'grey', 'min': [-0.01, 0, -4], 'max': [0.01, 9, 4]}
        found = self.found(ball, ({**ball, 'radius': 0.05}, 10),
                           ({**ball, 'center': [2, 3, -1]}, 10), more=[wall])
        self.assertGreater(found['light-by-chance']['share'], 0.2)
        self.assertLess(found['light-by-chance']['share'], 0.5)

    def test_of_large_lamps(self):
        """A panel of many triangles that paths find easily, and one that they do not find."""
        pane = {'type': 'box', 'min': [-4, 2, -4], 'max': [4, 2.1, 0]}
        for size, expected in ((0.3, True), (6, False)):
            self.write('panel.obj', ''.join(f'v {size * (i / 8 - 0.5)} {4} {size * (j / 8 - 0.5) - 2}\n'
                                            for j in range(9) for i in range(9))
                       + ''.join(f'f {k} {k + 1} {k + 10} {k + 9}\n' for j in range(8)
                                 for k in range(9 * j + 1, 9 * j + 9)))
            found = self.found(pane, ({'type': 'mesh', 'file': 'panel.obj'}, 1))
            self.assertEqual('light-by-chance' in found, expected, found)


class Window(Checks):
    """An image with eight suns of two texels each, whose light enters a room through its open side."""

    def scene(self, suns, glass, more=()):
        sky = [[(0.2, 0.2, 0.3)] * 64 for _ in range(32)]
        for row in (8, 9) if suns else ():
            for column in range(64):
                if column % 16 < 2:
                    sky[row][column] = (3e3, 3e3, 3e3)
        write_exr(os.path.join(self.folder.name, 'sky.exr'), 64, 32, sky)
        walls = [([-2, -2, -4], [4, 0, 0], [0, 4, 0]), ([-2, -2, 0], [0, 0, -4], [0, 4, 0]),
                 ([2, -2, 0], [0, 4, 0], [0, 0, -4]), ([-2, -2, 0], [4, 0, 0], [0, 0, -4]),
                 ([-2, 2, 0], [0, 0, -4], [4, 0, 0])]
        pane = {'type': 'box', 'material': 'glass', 'min': [-2.5, -2.5, 0.1], 'max': [2.5, 2.5, 0.2]}
        return {'camera': {'position': [0, 0, -0.1], 'target': [0, -0.3, -4], 'fov_degrees': 70},
                'environment': {'file': 'sky.exr'},
                'materials': {'grey': GREY, 'glass': {'type': 'dielectric'}},
                'shapes': [*({'type': 'quad', 'material': 'grey', 'corner': corner, 'u': u, 'v': v}
                             for corner, u, v in walls), *([pane] if glass else []), *more]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True, True))
        self.assert_found(found, {'light-by-chance': 'slow'})
        self.assertIn('glass', found['light-by-chance']['place'])
        self.assertIn('the environment', found['light-by-chance']['figure'])
        self.assertEqual(found['light-by-chance']['share'], 1)
        # The window has a hundredth of that area.
        shutters = [{'type': 'quad', 'material': 'grey', 'corner': corner, 'u': u, 'v': v}
                    for corner, u, v in (([-2, -2, 0], [4, 0, 0], [0, 1.8, 0]),
                                         ([-2, 0.2, 0], [4, 0, 0], [0, 1.8, 0]),
                                         ([-2, -0.2, 0], [1.8, 0, 0], [0, 0.4, 0]),
                                         ([0.2, -0.2, 0], [1.8, 0, 0], [0, 0.4, 0]))]
        found = self.check(self.scene(True, True, shutters))
        self.assertEqual(found['light-by-chance']['share'], 1)
        self.assert_found(self.check(self.scene(True, False)), {})
        self.assert_found(self.check(self.scene(False, True)), {})  # paths find this light easily


class Spots(Checks):
    """A spot light in a room of 4 m, which a lamp lights as well."""

    def found(self, degrees, *more, direction=(0, -1, 0), **camera):
        quad = {'type': 'quad', 'material': 'lamp', 'corner': [-1, 3.99, -1], 'u': [2, 0, 0], 'v': [0, 0, 2]}
        spot = {'type': 'spot', 'name': 'beam', 'position': [0, 3.9, 0], 'direction': direction,
                'outer_degrees': degrees, 'intensity': [100] * 3}
        return self.check({
            'film': {'width': 16, 'height': 16}, 'settings': {'max_bounces': 2},
            'camera': {'position': [0, 2, 1.9], 'target': [0, 0.5, 0], 'fov_degrees': 60, **camera},
            'materials': {'grey': GREY, 'lamp': {'emission': [5] * 3}, 'glass': {'type': 'dielectric'}},
            'lights': [spot],
            'shapes': [{'type': 'box', 'material': 'grey', 'min': [-2, 0, -2], 'max': [2, 4, 2]}, quad, *more]})

    def pixels(self, finding):
        return float(re.search(r'an area of (\S+) pixels', finding['figure'])[1])

    def test_narrow(self):
        found = self.found(0.01)['narrow-spot']
        self.assertEqual(found['level'], 'remark')
        self.assertRegex(found['place'], '^light 0, "beam", on instance 0 of mesh "box"$')
        # The spot is a disc of radius r = 3.9 tan(0.01 degrees), seen from 2.76 m.
        radius, pixel = 3.9 * math.tan(math.radians(0.01)), 2 * math.tan(math.radians(30)) / 16 * 2.759
        self.assertAlmostEqual(self.pixels(found) / (math.pi * (radius / pixel) ** 2), 1, delta=0.1)
        self.assertEqual(found['share'], 1 / 16 ** 2)
        self.assertIn('leaves 2.3e-10 of the intensity', found['consequence'])
        # The spot is behind the camera; then the pixels are larger.
        self.assertEqual(self.found(0.01, direction=[0, 0, 1])['narrow-spot']['share'], 0)
        self.assertLess(self.pixels(self.found(0.01, fov_degrees=100)['narrow-spot']), self.pixels(found) / 3)

    def test_wide(self):
        self.assertIn('narrow-spot', self.found(0.4))  # 0.059 pixels
        for degrees in (0.44, 40, 90):  # at least 0.071 pixels
            self.assertNotIn('narrow-spot', self.found(degrees), degrees)
        # A small object just in front of the lamp, and glass.
        ball = {'type': 'sphere', 'material': 'grey', 'center': [0, 3.89, 0], 'radius': 1e-3}
        pane = {'type': 'box', 'material': 'glass', 'min': [-1, 3.898, -1], 'max': [1, 3.899, 1]}
        self.assertNotIn('narrow-spot', self.found(40, ball))
        self.assertNotIn('narrow-spot', self.found(40, pane))


class OnSurface(Checks):
    """A light inside or above a floor, next to a wall."""

    def found(self, position, **light):
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 1, 4], 'target': [0, 0.5, 0], 'fov_degrees': 40},
            'materials': {'grey': GREY}, 'environment': {'radiance': [0.1] * 3},
            'lights': [{'type': 'point', 'position': position, 'intensity': [1, 1, 1], **light}],
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-2, 0, 2], 'u': [4, 0, 0],
                        'v': [0, 0, -4]},
                       {'type': 'quad', 'material': 'grey', 'corner': [-2, 0, -2], 'u': [4, 0, 0],
                        'v': [0, 4, 0]},
                       {'type': 'sphere', 'material': 'grey', 'center': [1, 0.5, 0], 'radius': 0.5}]
        }).get('light-on-surface')

    def test_on_and_above(self):
        for position, place in (([0, 0, 0], '0'), ([0.3, 0, 0.1], '0'), ([-1.1, 2.2, -2], '1')):
            found = self.found(position)
            self.assertEqual(found['level'], 'remark')
            self.assertEqual(found['place'], f'light 0, on instance {place} of mesh "quad"')
        ball = self.found([1 + 0.5 * 3 ** -0.5, 0.5 + 0.5 * 3 ** -0.5, 0.5 * 3 ** -0.5])
        self.assertIn('a sphere', ball['place'])
        # The wall and the ball receive its light, and reflect some of it to the floor.
        self.assertTrue(0.1 < self.found([0, 0, 0])['share'] <= 1)
        down = {'type': 'spot', 'direction': [0, -1, 0], 'outer_degrees': 40}
        self.assertIsNotNone(self.found([0, 0, 0], **down))
        for position in ([0, 1e-3, 0], [0, -1e-3, 0], [3, 0, 0], [0.3, 0.2, 0.1]):
            self.assertIsNone(self.found(position), position)


if __name__ == '__main__':
    unittest.main()
