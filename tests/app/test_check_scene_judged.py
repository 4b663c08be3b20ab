#!/usr/bin/env python3
"""Tests the levels of findings of `lampyris check SCENE`: an object that changes nothing in the picture must
not make it wrong, and reported figures must be correct.

Usage: test_check_scene_judged.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import os
import subprocess
import unittest
from scene_checks import Checks, GREY, LAMPYRIS, SOURCE, box

LAMP = {'base_color': [0, 0, 0], 'emission': [8, 8, 8]}
FLOOR = {'type': 'quad', 'material': 'grey', 'corner': [-5, 0, 5], 'u': [10, 0, 0], 'v': [0, 0, -10]}
VIEW = {'position': [0, 1, 5], 'target': [0, 1, 0], 'fov_degrees': 40}
SMALL = {'width': 48, 'height': 32}


class Idle(Checks):
    """Settings that have not changed this picture."""
    def scene(self, light=None, **settings):
        return {'camera': VIEW, 'film': SMALL, 'environment': {'radiance': [0.5, 0.5, 0.5]},
                'materials': {'grey': GREY, 'lamp': LAMP, 'glass': {'type': 'dielectric'}},
                'settings': settings,
                'shapes': [FLOOR, {'type': 'sphere', 'material': 'glass', 'center': [0, 1, 0],
                                   'radius': 0.7}, *([light] if light else [])]}

    def test_thresholds(self):
        for clean, planted in (({'clamp': 1e6}, {'clamp': 0.4}),
                               ({'min_density': 1e-30}, {'min_density': 0.3})):
            self.assert_found(self.check(self.scene(**clean)), {})
            self.assertIn(('biased-setting', 'wrong'), [
                (name, finding['level'])
                for name, finding in self.check(self.scene(**planted)).items()])

    def test_radiance_scaling(self):
        """Light that leaves the glass again is correct; the light of a lamp inside the glass is not, nor is
        light that reaches a camera there."""
        ball = {'type': 'sphere', 'material': 'lamp', 'radius': 0.4}
        self.assert_found(self.check(self.scene(radiance_scaling=False)), {})
        found = self.check(self.scene({**ball, 'center': [0, 1, 0]}, radiance_scaling=False))
        self.assertEqual(found['biased-setting']['level'], 'wrong')
        self.assertTrue(0.05 < found['biased-setting']['share'] < 0.9)
        inside = {**self.scene(radiance_scaling=False),
                  'camera': {'position': [0, 1, 0.5], 'target': [0, 1, 0], 'fov_degrees': 40}}
        found = self.check(inside)
        self.assertEqual(found['biased-setting']['share'], 1)


class Unseen(Checks):
    """Objects that are not in the picture and do not change it."""
    def scene(self, place, **more):
        return {'camera': VIEW, 'film': SMALL, 'environment': {'radiance': [0.5, 0.5, 0.5]},
                'materials': {'grey': GREY, 'red': {'base_color': [0.7, 0.1, 0.1]}},
                'shapes': [FLOOR, {'type': 'box', 'material': 'red', 'min': place,
                                   'max': [x + 1.5 for x in place]}], **more}

    def test_coarse_objects(self):
        self.assert_found(self.check(self.scene([1e6, 1, -3e6])),
                          {'coarse-object': 'remark', 'sliver': 'remark'})
        self.assertTrue(all(f['share'] == 0 for f in self.result['findings']))

    def test_coarse_lamps(self):
        """If rounding errors exceed the size of a shape, it emits the light of a larger one."""
        for form in ({'type': 'sphere', 'center': [1, 9, 1], 'radius': 1e-8},
                     {'type': 'disc', 'center': [1, 9, 1], 'normal': [0, -1, 0], 'radius': 1e-8}):
            scene = self.scene([-0.5, 0, -0.5])
            scene['materials']['lamp'] = {'emission': [1e18] * 3}
            scene['shapes'].append({**form, 'material': 'lamp'})
            self.assertNotIn('coarse-object', self.check(scene))
            scene['shapes'][-1].update(material='grey')
            self.assertEqual(self.check(scene)['coarse-object']['level'], 'remark')

    def test_coarse_objects_that_vanish(self):
        """Rounding steps are larger than the object, so no ray hits it, although it should be in the
        picture."""
        found = self.check({
            'camera': {'position': [0, 0, 0], 'target': [0, 0, -1], 'fov_degrees': 4e-6},
            'film': SMALL, 'environment': {'radiance': [1, 1, 1]}, 'materials': {'grey': GREY},
            'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [5, 0, 0], 'u': [1, 0, 0],
                        'v': [0, 1, 0]},
                       {'type': 'sphere', 'material': 'grey', 'center': [0, 0, -1e6 - 0.03],
                        'radius': 0.02}]})
        self.assertEqual(found['coarse-object']['level'], 'wrong')
        self.assertGreater(found['coarse-object']['share'], 0)

    def test_coarse_objects_that_throw_shadows(self):
        """An object out of sight blocks the light of a sun above."""
        found = self.check(self.scene([-0.75, 1e6, -0.75], lights=[
            {'type': 'directional', 'direction': [0, -1, 0], 'irradiance': [3, 3, 3]}]))
        self.assertEqual(found['coarse-object']['level'], 'wrong')
        self.assertTrue(0.01 < found['coarse-object']['share'] < 0.3)

    def test_coarse_meshes(self):
        """The coarse mesh is far behind the camera, and the only light is a constant environment."""
        self.write('far.obj', box((1e6, 0, 0), (1e6 + 0.5, 0.5, 0.5)))

        def scene(z):
            return {'camera': VIEW, 'film': SMALL, 'environment': {'radiance': [0.5, 0.5, 0.5]},
                    'materials': {'grey': GREY},
                    'shapes': [FLOOR, {'type': 'mesh', 'file': 'far.obj', 'material': 'grey',
                                       'transform': [{'translate': [-1e6, 0.5, z]}]}]}
        self.assertEqual(self.check(scene(1e3))['coarse-mesh']['level'], 'remark')
        self.assertEqual(self.check(scene(0))['coarse-mesh']['level'], 'wrong')


class Tail(Checks):
    def scene(self, *shapes, lights=(), **settings):
        return {'camera': VIEW, 'film': SMALL, 'settings': settings,
                'materials': {'grey': GREY, 'lamp': LAMP, 'glass': {'type': 'dielectric'}},
                'shapes': [FLOOR, *shapes], 'lights': list(lights)}

    def test_met_bound(self):
        """No sample is brighter than a lamp with radiance 8, and some samples are nearly as bright."""
        found = self.check({**self.scene(
            {'type': 'box', 'material': 'glass', 'min': [-0.5, 0.01, -0.5], 'max': [0.5, 1, 0.5]},
            {'type': 'quad', 'material': 'lamp', 'corner': [-1, 3, -1], 'u': [2, 0, 0], 'v': [0, 0, 2]},
            max_bounces=9), 'environment': {'radiance': [0.5, 0.5, 0.5]}})
        self.assertNotIn('heavy-tail', found)

    def test_unknown_bound(self):
        """A point light 5 mm above a ball, from which its light is reflected to everything else."""
        found = self.check(self.scene(
            {'type': 'sphere', 'material': 'grey', 'center': [0, 0.5, 0], 'radius': 0.5},
            {'type': 'quad', 'material': 'grey', 'corner': [-5, 0, -1], 'u': [10, 0, 0], 'v': [0, 5, 0]},
            lights=[{'type': 'point', 'position': [0, 1.005, 0], 'intensity': [1, 1, 1]}]))
        self.assertEqual(found['heavy-tail']['level'], 'slow')
        self.assertIn('longer renders find brighter samples', found['heavy-tail']['consequence'])


class Asked(Checks):
    def test_integrators(self):
        """The integrator `direct` lacks the same light as paths with one bounce."""
        path = os.path.join(SOURCE, 'scenes', 'cornell.json')
        figures = []
        for arguments in (['--integrator', 'direct'], ['--max-bounces', '1']):
            found = self.check_file(path, '--size', '32x32', *arguments)
            self.assert_found(found, {'depth': 'remark'})
            figures.append(found['depth']['figure'])
        self.assertEqual(figures[0], figures[1])
        found = self.check_file(path, '--size', '32x32', '--integrator', 'ao')
        self.assertIn('ambient occlusion', found['depth']['consequence'])


class Fix(Checks):
    def test_says_what_it_wrote(self):
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        out = os.path.join(self.folder.name, 'out.json')
        result = subprocess.run([LAMPYRIS, 'check', scene, '--size', '16x16', '-q', '--fix', out],
                                text=True, stdout=subprocess.PIPE, timeout=600)
        self.assertEqual(result.returncode, 0)
        self.assertIn(f'No change was necessary.\nwrote     {out}\n', result.stdout)


if __name__ == '__main__':
    unittest.main()
