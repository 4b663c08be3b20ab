#!/usr/bin/env python3
"""Tests the predicted cost of a render by `lampyris check SCENE`, and findings about samples that are wasted.

Usage: test_check_scene_outlook.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import os
import re
import subprocess
import unittest
import unittest.mock

from scene_checks import Checks, LAMPYRIS

WALL = {'base_color': [0.6, 0.6, 0.6]}
LAMP = {'base_color': [0, 0, 0], 'emission': [12, 12, 12]}
FACES = [([-3, 0, 6], [6, 0, 0], [0, 0, -9]), ([-3, 4, -3], [6, 0, 0], [0, 0, 9]),
         ([3, 0, 6], [-6, 0, 0], [0, 4, 0]), ([-3, 0, 6], [0, 0, -9], [0, 4, 0]),
         ([3, 0, -3], [0, 0, 9], [0, 4, 0])]
BACK = [([-3, 0, -3], [6, 0, 0], [0, 4, 0])]


def quad(material, corner, u, v):
    return {'type': 'quad', 'material': material, 'corner': corner, 'u': u, 'v': v}


def room(*shapes, lights=(), lamp=LAMP, faces=FACES + BACK, **more):
    return {'camera': {'position': [0, 1, 4], 'target': [0, 0.6, 0], 'fov_degrees': 45},
            'film': {'width': 32, 'height': 32}, 'materials': {'wall': WALL, 'lamp': lamp},
            'shapes': [quad('wall', *face) for face in faces] + list(shapes),
            'lights': list(lights), **more}


# The lamp is 1 cm below the ceiling, which it lights brightly.
CEILING_LAMP = quad('lamp', [-0.7, 3.99, -0.7], [1.4, 0, 0], [0, 0, 1.4])


class IdleLights(Checks):
    def point(self, intensity, **more):
        return {'type': 'point', 'position': [0, 2.5, 0], 'intensity': [intensity] * 3, **more}

    def check(self, *arguments):
        # The light between the lamp and the ceiling causes a heavy-tail finding of its own.
        found = super().check(*arguments)
        found.pop('heavy-tail', None)
        return found

    def assert_idle(self, scene, place, *arguments):
        found = self.check(scene, *arguments)
        self.assert_found(found, {'idle-light': 'slow'})
        idle = found['idle-light']
        self.assertEqual(idle['place'], place)
        outlook, without = map(int, re.findall('([0-9]+) spp, but ([0-9]+) spp without',
                                               idle['consequence'])[0])
        self.assertAlmostEqual(outlook, self.result['outlook']['spp'], delta=1)
        self.assertLess(10 * without, outlook)
        return idle

    def test_out_of_range(self):
        scene = room(CEILING_LAMP, lights=[self.point(1e6, range=0.01, name='dead')])
        place = 'light 0, "dead"'
        # First vertices connect to both lights by default, and later ones to one, chosen by the tree.
        self.assertIn('power and distance decide which lights get shadow rays',
                      self.assert_idle(scene, place)['figure'])
        scene['settings'] = {'light_choice': 'power'}
        self.assertIn('% of all shadow rays, but', self.assert_idle(scene, place)['figure'])
        # If each vertex connects to all lights, no light takes shadow rays from another.
        scene['settings'] = {'light_choice': 'all'}
        self.assert_found(self.check(scene), {})

    def test_enclosed(self):
        ball = {'type': 'sphere', 'material': 'wall', 'center': [0, 2.5, 0], 'radius': 0.12}
        idle = self.assert_idle(room(ball, CEILING_LAMP, lights=[self.point(1000)]), 'light 0')
        # The share by power: 4 pi 1000 W/sr and pi 12 1.4^2 W/sr on each of two sides, over 2 pi.
        share = float(idle['figure'].split(' %')[0])
        self.assertAlmostEqual(share, 100 * 2000 / (2000 + 12 * 1.4 ** 2), delta=0.01)

    def test_enclosed_lamp(self):
        hot = {'base_color': [0, 0, 0], 'emission': [1e5] * 3}
        scene = room({'type': 'sphere', 'material': 'wall', 'center': [0, 2.5, 0], 'radius': 0.12},
                     {'type': 'sphere', 'material': 'hot', 'center': [0, 2.5, 0], 'radius': 0.1},
                     CEILING_LAMP)
        scene['materials']['hot'] = hot
        self.assert_idle(scene, 'lamps of material "hot"')

    def test_several_of_which_one_lights(self):
        """A screen is between light 1 and everything visible, so its light only arrives indirectly."""
        screen = [quad('wall', [-3, 0, 4.5], [6, 0, 0], [0, 3.5, 0])]
        lights = [self.point(1e4, range=0.01), {**self.point(20), 'position': [0, 1, 5.5]}]
        found = self.check(room(*screen, CEILING_LAMP, lights=lights))
        self.assertEqual(found['idle-light']['place'], 'light 0')

    def test_lights(self):
        self.assert_found(self.check(room(CEILING_LAMP, lights=[self.point(10)])), {})
        self.assert_found(self.check(room(CEILING_LAMP, lights=[self.point(10, range=9)])), {})

    def test_indirect(self):
        """All light of the point light arrives by way of a ceiling that is not in the picture."""
        trough = quad('wall', [-1, 2.5, -1], [2, 0, 0], [0, 0, 2])
        light = {**self.point(100), 'position': [0, 3.2, 0]}
        self.assert_found(self.check(room(trough, CEILING_LAMP, lights=[light])), {})

    def test_idle_and_few(self):
        """The light gets less than a hundredth of the shadow rays, so it costs nothing."""
        self.assert_found(self.check(room(CEILING_LAMP, lights=[self.point(0.1, range=0.01)])), {})


class Dim(Checks):
    def test_planted_and_clean(self):
        ball = {'type': 'sphere', 'material': 'lamp', 'center': [0, 3, 0], 'radius': 0.2}
        def scene(radiance):
            return room(ball, lamp={'emission': [radiance] * 3})
        found = self.check(scene(1e-6))
        self.assert_found(found, {'dim': 'remark'})
        spp = int(re.findall('about ([0-9]+) spp', found['dim']['consequence'])[0])
        noise = float(re.findall('noise of ([0-9.e+]+) %', found['dim']['consequence'])[0]) / 100
        self.assert_found(self.check(scene(250)), {})
        # There the mean is 1, except for the emission, which is white already.
        self.assertAlmostEqual(spp / self.result['outlook']['spp'], 1, delta=0.02)
        self.assertAlmostEqual(noise, (1e-3 * spp) ** 0.5, delta=0.01)

    def test_render(self):
        ball = {'type': 'sphere', 'material': 'lamp', 'center': [0, 3, 0], 'radius': 0.2}
        for radiance, expected in ((1e-6, True), (250, False)):
            path = self.write('scene.json', {'lampyris': 1,
                                             **room(ball, lamp={'emission': [radiance] * 3})})
            told = subprocess.run([LAMPYRIS, 'render', path, '--error', '0.1', '-o',
                                   os.path.join(self.folder.name, 'out.exr')], text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=600)
            self.assertEqual(told.returncode, 0, told.stderr)
            self.assertEqual('too dark for --error' in told.stderr, expected, told.stderr)


class Memory(Checks):
    def test_too_large_a_picture(self):
        for limit in ('memory', 'memory-budget'):
            with unittest.mock.patch.dict(os.environ, LAMPYRIS_LIMITS=f'{limit}=67108864'):
                self.assert_found(self.check(room(CEILING_LAMP)), {})
                # Findings about its own light are reported, too.
                found = self.check(room(CEILING_LAMP, settings={'max_bounces': 2}), '--size',
                                   '3000x3000')
            self.assert_found(found, {'too-little-memory': 'wrong', 'depth': 'wrong'})
            self.assertGreater(self.result['outlook']['device_bytes'], 500e6)
            self.assertIn('memory', found['too-little-memory']['figure'])
        self.assert_found(self.check(room(CEILING_LAMP), '--size', '3000x3000'), {})


class Depth(Checks):
    def window(self, *shapes):
        """A room lit by a small window: most of the 16 samples of a pixel find no light."""
        faces = FACES + [([-3, 0, -3], [5.5, 0, 0], [0, 4, 0]), ([2.5, 0, -3], [0.5, 0, 0], [0, 1, 0]),
                         ([2.5, 1.6, -3], [0.5, 0, 0], [0, 2.4, 0])]
        return {**room(*shapes, faces=faces, environment={'radiance': [100, 100, 100]},
                       settings={'max_bounces': 2}),
                'camera': {'position': [2, 1.5, 2], 'target': [-1, 1.2, -3], 'fov_degrees': 60}}

    def test_share_of_noisy_pixels(self):
        found = self.check(self.window())
        self.assertGreater(found['depth']['share'], 0.95)

    def test_share_of_what_lacks_nothing(self):
        """A lamp in front of the camera covers the left half of the picture."""
        scene = room(CEILING_LAMP, quad('lamp', [-2, -1, 3], [2, 0, 0], [0, 4, 0]),
                     settings={'max_bounces': 2})
        self.assertAlmostEqual(self.check(scene)['depth']['share'], 0.5, delta=0.1)


class Tail(Checks):
    def test_bound_that_is_met(self):
        self.assert_found(self.check(room(CEILING_LAMP)), {})


if __name__ == '__main__':
    unittest.main()
