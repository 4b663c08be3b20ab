#!/usr/bin/env python3
"""Tests findings of `lampyris check SCENE` about surfaces that coincide, and scenes in which surfaces only
seem to coincide.

Usage: test_check_scene_told_apart.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import subprocess
import unittest

from scene_checks import Checks, FILM, FRONT, GREY, LAMPYRIS, SOURCE, box, write_png


class Gaps(Checks):
    """Objects at the same place whose materials have gaps: each is visible through the gaps of the other."""

    def scene(self, second, first=None):
        for name, left, right in (('left.png', 255, 0), ('right.png', 0, 255)):
            texels = [(255, 255, 255, left), (255, 255, 255, right)]
            write_png(os.path.join(self.folder.name, name), 2, 1, [texels])

        def mask(name, color):
            return {'base_color': color, 'alpha': 'mask', 'textures': [
                {'file': name, 'filter': 'nearest', 'parameters': {'opacity': 'a'}}]}
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'materials': {'grey': GREY, 'left': mask('left.png', [0.6, 0.1, 0.1]),
                              'right': mask('right.png', [0.1, 0.6, 0.1]),
                              'veil': {'base_color': [0.1, 0.1, 0.6], 'opacity': 0.5}},
                'shapes': [{'type': 'quad', 'material': material, 'corner': [-1, -1, 0],
                            'u': [2, 0, 0], 'v': [0, 2, 0]} for material in (first or 'left', second)]}

    def test_are_no_twins(self):
        fixed = os.path.join(self.folder.name, 'fixed.json')
        for second, first in (('right', None), ('veil', None)):
            self.assert_found(self.check(self.scene(second, first), '--fix', fixed), {})

    def test_one_of_them_has_no_gaps(self):
        """The order of the objects decides whether the object with gaps is visible."""
        for second, first in (('grey', 'left'), ('grey', 'veil'), ('veil', 'grey')):
            found = self.check(self.scene(second, first))
            self.assert_found(found, {'object-twice': 'wrong'})
            self.assertIn('order of the objects', found['object-twice']['consequence'])

    def test_are_twins(self):
        self.assert_found(self.check(self.scene('left')), {'object-twice': 'remark'})
        self.assert_found(self.check(self.scene('veil', 'veil')), {'object-twice': 'wrong'})


class OutOfView(Checks):
    """Two objects at the same place that are out of view, but whose light or shadow is in the picture."""

    def scene(self, *materials):
        disc = {'type': 'disc', 'center': [0, 3, 0], 'normal': [0, -1, 0], 'radius': 0.7}
        return {'camera': {'position': [0, 1, 4], 'target': [0, 0.5, 0], 'fov_degrees': 40},
                'film': FILM, 'environment': {'radiance': [0.2, 0.2, 0.2]},
                'materials': {'grey': GREY, 'lamp': {'emission': [12, 11, 9]},
                              'veil': {'base_color': [0.1, 0.1, 0.1], 'opacity': 0.5}},
                'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-2, 0, 2], 'u': [4, 0, 0],
                            'v': [0, 0, -4]}, *({**disc, 'material': name} for name in materials)]}

    def test_count_where_their_light_falls(self):
        """The floor is 46 % of the picture, and all of it is lit twice as brightly."""
        found = self.check(self.scene('lamp', 'lamp'))
        self.assert_found(found, {'object-twice': 'wrong'})
        self.assertAlmostEqual(found['object-twice']['share'], 0.46, delta=0.02)

    def test_clash_where_their_light_falls(self):
        found = self.check(self.scene('lamp', 'grey'))
        self.assertAlmostEqual(found['object-twice']['share'], 0.46, delta=0.02)

    def test_are_a_remark_where_they_change_nothing(self):
        scene = self.scene('veil', 'veil')
        for shape in scene['shapes'][1:]:
            shape['center'] = [0, -3, 0]  # the objects are below the floor
        self.assert_found(self.check(scene), {'object-twice': 'remark'})


class Upon(Checks):
    def found(self, *shapes):
        return self.check({
            'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]},
                          'glass': {'type': 'dielectric'},
                          'water': {'type': 'dielectric', 'ior': 1.33}},
            'shapes': [{'material': 'grey', **shape} for shape in shapes]})

    def test_behind_glass(self):
        """Coplanar faces behind a pane of glass."""
        for gap, expected in ((0, {'coincident-faces': 'wrong'}), (0.1, {})):
            self.assert_found(self.found(
                {'type': 'quad', 'corner': [-3, -3, 0], 'u': [6, 0, 0], 'v': [0, 6, 0]},
                {'type': 'quad', 'material': 'red', 'corner': [-1, -1, gap], 'u': [2, 0, 0],
                 'v': [0, 2, 0]},
                {'type': 'box', 'material': 'glass', 'min': [-4, -4, 1], 'max': [4, 4, 1.1]}), expected)

    def test_curved(self):
        for near, expected in ((1e-14, {'coincident-faces': 'wrong'}), (1e-3, {})):
            found = self.found(
                {'type': 'sphere', 'center': [-1.5, 0, 0], 'radius': 1},
                {'type': 'sphere', 'material': 'red', 'center': [-1.5, near, 0], 'radius': 1},
                {'type': 'cylinder', 'from': [1.5, -1, 0], 'to': [1.5, 1, 0], 'radius': 0.5},
                {'type': 'cylinder', 'material': 'red', 'from': [1.5, 0, 0], 'to': [1.5, 2, 0],
                 'radius': 0.5 + near})
            self.assert_found(found, expected)
            if found:  # the disc of one cylinder, and the surface that both share
                self.assertAlmostEqual(found['coincident-faces']['share'], (3.14159 + 1) / 36, delta=0.01)


    def test_from_far(self):
        """A wall behind another one. A line of sight of this length cannot distinguish them, although their
        coordinates differ; the wall behind is visible, in the shadow of the other one."""
        for away in (10, 1e4):
            def scene(gap, larger=1.01):
                size = 0.01 * away
                return {'camera': {'position': [0, 0, 0], 'target': [0, 0, -away], 'fov_degrees': 0.5},
                        'environment': {'radiance': [1, 1, 1]},
                        'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
                        'shapes': [{'type': 'quad', 'material': material, 'corner': [-size, -size, z],
                                    'u': [2 * size * u, 0, 0], 'v': [0, 2 * size, 0]}
                                   for material, z, u in (('grey', -away, 1),
                                                          ('red', gap * away - away, larger))]}
            with self.subTest(away):
                self.assertNotIn('object-twice', self.check(scene(2e-8, larger=1)))
                found = self.check(scene(2e-8))
                self.assertEqual(found['coincident-faces']['level'], 'wrong')
                self.assertIn(f'seen from {away:.4g} m away', found['coincident-faces']['figure'])
                self.assertGreater(found['coincident-faces']['share'], 0.3)
                self.assert_found(self.check(scene(1e-4)), {})

    def test_boxes(self):
        """Faces of boxes and caps, which every ray can hit, on a wall, on each other and under a quad."""
        def box(low, high, material='grey', form='analytic'):
            return {'type': 'box', 'as': form, 'material': material, 'min': low, 'max': high}
        sheet = {'type': 'quad', 'as': 'analytic', 'material': 'red', 'u': [0.5, 0, 0], 'v': [0, 0.5, 0]}
        pairs = {
            'boxes': lambda gap: [box([0, 0, 0], [1, 1, 1]), box([0.3, 0.3, 0.5], [2, 2, 1 + gap], 'red')],
            'side by side': lambda gap: [box([0, 0, 0], [1, 1, 1], 'glass'),
                                         box([0, 0, -1], [1, 1, -gap], 'glass')],
            'a box and a quad': lambda gap: [box([0, 0, 0], [1, 1, 1]),
                                             {**sheet, 'corner': [0.2, 0.2, 1 + gap]}],
            'a quad and a box': lambda gap: [{**sheet, 'corner': [0.2, 0.2, 1]},
                                             box([0, 0, 0], [1, 1, 1 - gap])],
            'a box and triangles': lambda gap: [box([0, 0, 0], [1, 1, 1]),
                                                box([0.5, 0.5, 0], [2, 2, 1 + gap], 'red', 'triangles')],
            'a cap and a box': lambda gap: [
                {'type': 'cylinder', 'from': [0, 0, 0], 'to': [0, 0, 1], 'radius': 1},
                box([0, 0, 0], [2, 2, 1 + gap], 'red')],
        }
        for name, pair in pairs.items():
            with self.subTest(name):
                self.assert_found(self.found(*pair(0)), {'coincident-faces': 'wrong'})
                self.assert_found(self.found(*pair(0.01)), {})

    def test_media(self):
        """Glass and water that share a face are both closed."""
        for form in ('triangles', 'analytic'):
            for gap, expected in ((0, {'coincident-faces': 'wrong'}), (0.1, {})):
                self.assert_found(self.found(
                    {'type': 'box', 'as': form, 'material': 'glass', 'min': [-1, -1, 0.4], 'max': [1, 1, 0.5]},
                    {'type': 'box', 'as': form, 'material': 'water', 'min': [-1, -1, -1],
                     'max': [1, 1, 0.4 - gap]}), expected)


class Lamps(Checks):
    """A lamp in the ceiling between two rooms, one of which is visible from below the lamp."""

    def found(self, gap=0.0, place=0.2, lamp=None, **camera):
        wall = {'type': 'quad', 'material': 'grey'}
        sheet = {'type': 'quad', 'corner': [place, 2 - gap, -0.8], 'u': [0.6, 0, 0], 'v': [0, 0, 0.6]}
        return self.check({
            'film': {'width': 24, 'height': 24},
            'camera': {'position': [0, 0.5, 1.9], 'target': [0, 0.4, 0], 'fov_degrees': 50, **camera},
            'materials': {'grey': GREY, 'lamp': {'emission': [5, 5, 5]}},
            'environment': {'radiance': [0.1, 0.1, 0.1]},
            'shapes': [{**wall, 'corner': [-1, 0, 1], 'u': [2, 0, 0], 'v': [0, 0, -2]},
                       {**wall, 'corner': [-4, 2, -1], 'u': [8, 0, 0], 'v': [0, 0, 2]},
                       {**wall, 'corner': [-1, 0, -1], 'u': [2, 0, 0], 'v': [0, 2, 0]},
                       {**wall, 'corner': [-1, 0, 1], 'u': [0, 0, -2], 'v': [0, 2, 0]},
                       {**wall, 'corner': [1, 0, -1], 'u': [0, 0, 2], 'v': [0, 2, 0]},
                       {'material': 'lamp', **(lamp or sheet)}]})

    def test_out_of_sight(self):
        """The lamp is reported because of the light that it sends, for every form of lamp."""
        ball = {'type': 'cylinder', 'from': [0.3, 2, 0], 'to': [0.3, 2.5, 0], 'radius': 0.3}
        box = {'type': 'box', 'as': 'analytic', 'min': [0.2, 2, -0.8], 'max': [0.8, 2.1, -0.2]}
        for lamp in (None, ball, box):
            with self.subTest(lamp):
                found = self.found(lamp=lamp)['coincident-faces']
                self.assertEqual(found['level'], 'wrong')
                self.assertGreater(found['share'], 0.9)
                self.assertRegex(found['place'], 'lamp.*grey')
        self.assertIn('where 100 % of all lamps', self.found()['coincident-faces']['figure'])
        self.assertNotIn('coincident-faces', self.found(0.001))
        self.assertNotIn('coincident-faces', self.found(place=2.2))  # the visible surfaces receive none of
                                                                     # its light

    def test_what_lies_between_two_bodies_lights_nothing(self):
        box = {'type': 'box', 'as': 'analytic'}
        stands = {**box, 'min': [-0.3, 0, -0.8], 'max': [0.3, 0.2, -0.2]}
        hangs = {**box, 'min': [0.2, 1.8, -0.8], 'max': [0.8, 2, -0.2]}
        thread = {**box, 'min': [-0.5, 0, -0.5001], 'max': [0.5, 0.0002, -0.4999]}
        for lamp in stands, hangs, thread:
            with self.subTest(lamp):
                self.assertNotIn('coincident-faces', self.found(lamp=lamp))

    def test_in_sight(self):
        """A pair has a single finding, with both the visible part and the lit part."""
        self.found(target=[0, 1.2, 0], fov_degrees=80)
        found = [f for f in self.result['findings'] if f['name'] == 'coincident-faces']
        self.assertEqual(len(found), 1)
        self.assertGreater(found[0]['share'], 0.9)


class Twice(Checks):
    """Two identical objects at the same place: the findings, and that --fix does not change the picture."""

    def scene(self, *materials, **more):
        quad = {'type': 'quad', 'corner': [-1, -1, 0], 'u': [2, 0, 0], 'v': [0, 2, 0]}
        emission = {'emission': [4, 4, 4]}
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]}, 'settings': {'spp': 4},
                'materials': {'grey': GREY, 'like-grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]},
                              'lamp': {**GREY, **emission}, 'veil': {**GREY, 'opacity': 0.5},
                              'glass': {'type': 'dielectric'}, 'pane': {'type': 'dielectric', 'thin': True}},
                'shapes': [{**quad, 'material': 'grey', 'corner': [-1, -1, -1], 'u': [2, 0, 1]}] +
                          [{**(more or quad), 'material': material} for material in materials]}

    def picture(self, name):
        """Returns the hash of a scene's picture."""
        path = os.path.join(self.folder.name, name)
        result = subprocess.run([LAMPYRIS, 'render', path, '--json', '-o', path + '.exr'], text=True,
                                stdout=subprocess.PIPE, check=True, timeout=600)
        return json.loads(result.stdout)['image_hash']

    def test_fixes_leave_the_picture(self):
        """Neither a lamp on a wall, nor one of two lamps or of two blended surfaces, may be hidden."""
        fixed = os.path.join(self.folder.name, 'fixed.json')
        for materials, level, hidden in (
                (('grey', 'lamp'), 'wrong', None), (('lamp', 'lamp'), 'wrong', None),
                (('veil', 'veil'), 'wrong', None), (('red', 'grey', 'grey'), 'wrong', None),
                (('grey', 'grey'), 'remark', 'instance 2 of mesh "quad" (material "grey") is hidden'),
                (('red', 'red', 'red'), 'remark',
                 '2 objects are hidden, the first one of them is instance 2 of mesh "quad" (material "red")'),
                (('grey', 'like-grey'), 'remark',
                 'instance 2 of mesh "quad" (material "like-grey") is hidden')):
            with self.subTest(materials):
                found = self.check(self.scene(*materials), '--fix', fixed)
                self.assert_found(found, {'object-twice': level})
                self.assertEqual(found['object-twice']['change'], hidden)
                self.assert_found(self.check_file(fixed), {} if hidden else {'object-twice': level})
                self.assertEqual(self.picture('scene.json'), self.picture('fixed.json'))

    def test_glass_is_as_one(self):
        sphere = {'type': 'sphere', 'center': [0, 0, 1.2], 'radius': 0.8}
        for material, more in (('glass', sphere), ('pane', {})):
            with self.subTest(material):
                found = self.check(self.scene(material, material, **more), name='two.json')
                self.assert_found(found, {'object-twice': 'remark'})
                self.assertIsNone(found['object-twice']['change'])
                self.write('one.json', {'lampyris': 1, 'film': FILM, **self.scene(material, **more)})
                self.assertEqual(self.picture('one.json'), self.picture('two.json'))


class Pane(Checks):
    def test_closed(self):
        """A pane is in front of everything. No line into the body runs along its face."""
        for shift in (0, 0.3):
            self.assert_found(self.check({
                'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'film': {'width': 16, 'height': 16},
                'materials': {'glass': {'type': 'dielectric'}},
                'shapes': [{'type': 'box', 'material': 'glass', 'min': [-4 + shift, -4, 1],
                            'max': [4, 4 + shift, 1.05]}]}), {})


class Many(Checks):
    def test_gains_of_all_materials(self):
        """There are more materials than one measurement can hold; the last one is examined, too."""
        def ball(name, i):
            return {'type': 'sphere', 'material': name, 'center': [i % 20 - 10, i // 20 - 7, 0],
                    'radius': 0.4}
        last = {'type': 'microfacet', 'base_color': [0.9] * 3, 'roughness': 0.1,
                'specular_color': [0.04] * 3, 'diffuse': 'uncoupled'}
        plain = {f'm{i}': {'type': 'principled', 'base_color': [i / 400] * 3} for i in range(280)}
        found = self.check({
            'camera': {**FRONT, 'height': 24}, 'environment': {'radiance': [1, 1, 1]},
            'film': {'width': 24, 'height': 24}, 'materials': {**plain, 'varnish': last},
            'shapes': [*(ball(f'm{i}', i) for i in range(280)), ball('varnish', 285)]})
        self.assert_found(found, {'gains-light': 'wrong'})
        self.assertIn('varnish', found['gains-light']['place'])


class TinyPictures(Checks):
    def test_pixels_are_no_lamps(self):
        """A lamp that covers a few pixels has edges that are narrower than a pixel."""
        path = os.path.join(SOURCE, 'scenes', 'cornell.json')
        for size in ('8x8', '12x12', '16x16'):
            self.assertNotIn('tiny-lights', self.check_file(path, '--size', size))


if __name__ == '__main__':
    unittest.main()
