#!/usr/bin/env python3
"""Tests findings of `lampyris check SCENE` about media: in closed rooms, around the camera, and with equal
priorities. Each finding must appear for a scene in which it was planted, and none for the clean counterpart.

Usage: test_check_scene_media.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import unittest

from scene_checks import Checks, FRONT, box

SMALL = {'film': {'width': 32, 'height': 32}}


def quad(corner, u, v, material='wall'):
    return {'type': 'quad', 'material': material, 'corner': corner, 'u': u, 'v': v}


class Media(Checks):
    def media_found(self, scene, *arguments):
        """Returns the findings about media by name. Findings that follow from them are not tested here."""
        found = self.check({**SMALL, **scene}, *arguments)
        return {name: finding for name, finding in found.items() if name.startswith('medi')}


class Rooms(Media):
    """No line of sight leaves the room, but paths give the findings."""

    def room(self, *bodies, window=False):
        """A room of 6 x 4 x 9 metres with a lamp below its ceiling, or a window in a corner."""
        lit = {'shapes': [quad([-0.7, 3.9, -0.7], [1.4, 0, 0], [0, 0, 1.4], 'lamp'),
                          quad([-3, 0, -3], [6, 0, 0], [0, 4, 0])]}
        open_to_sky = {'environment': {'radiance': [100, 100, 100]},
                       'shapes': [quad([-3, 0, -3], [5.5, 0, 0], [0, 4, 0]),
                                  quad([2.5, 0, -3], [0.5, 0, 0], [0, 1, 0]),
                                  quad([2.5, 1.6, -3], [0.5, 0, 0], [0, 2.4, 0])]}
        scene = open_to_sky if window else lit
        walls = [quad([-3, 0, 6], [6, 0, 0], [0, 0, -9]), quad([-3, 4, -3], [6, 0, 0], [0, 0, 9]),
                 quad([-3, 0, 6], [0, 0, -9], [0, 4, 0]), quad([3, 0, -3], [0, 0, 9], [0, 4, 0]),
                 quad([3, 0, 6], [-6, 0, 0], [0, 4, 0])]
        return {**scene,
                'camera': {'position': [2, 1.5, 2] if window else [0, 1, 4],
                           'target': [-1, 1.2, -3] if window else [0, 0.6, 0],
                           'fov_degrees': 60 if window else 45},
                'materials': {'wall': {'base_color': [0.6] * 3}, 'lamp': {'emission': [12] * 3},
                              'glass': {'type': 'dielectric'}, 'pane': {'type': 'dielectric', 'thin': True},
                              'stone': {'type': 'dielectric', 'ior': 1.6, 'priority': 2}},
                'shapes': [*walls, *scene['shapes'], *bodies]}

    def test_a_single_pane(self):
        pane = {'corner': [-1, 0.2, 1], 'u': [2, 0, 0], 'v': [0, 1.5, 0]}
        found = self.media_found(self.room(quad(**pane, material='glass')))
        self.assert_found(found, {'medium-not-entered': 'wrong'})
        self.assertIn('quad', found['medium-not-entered']['place'])
        self.assertIn('glass', found['medium-not-entered']['place'])
        # The medium fills half of the picture.
        self.assertGreater(found['medium-not-entered']['share'], 0.4)
        self.assert_found(self.media_found(self.room(quad(**pane, material='pane'))), {})
        for form in ('triangles', 'analytic'):
            self.assert_found(self.media_found(self.room(
                {'type': 'box', 'as': form, 'material': 'glass', 'min': [-1, 0.2, 1],
                 'max': [1, 1.7, 1.02]})), {})

    def test_a_hole_out_of_sight(self):
        """The only missing face of the box is the one that the camera cannot see, or no face is missing."""
        for faces, expected in (('bcdef', {'medium-not-entered': 'wrong'}), ('abcdef', {})):
            self.write('box.obj', box((-0.8, 0.2, 0), (0.8, 1.4, 1), faces))
            found = self.media_found(self.room({'type': 'mesh', 'file': 'box.obj', 'material': 'glass'}))
            self.assert_found(found, expected)

    def test_a_window_out_of_view(self):
        """Paths enter the glass of the window and continue to the sky."""
        glass = quad([2.5, 1, -3], [0.5, 0, 0], [0, 0.6, 0], 'glass')
        found = self.media_found(self.room(glass, window=True))
        self.assert_found(found, {'medium-not-left': 'wrong'})
        self.assertIn('glass', found['medium-not-left']['place'])
        self.assert_found(self.media_found(self.room({**glass, 'material': 'pane'}, window=True)), {})
        slab = {'type': 'box', 'material': 'glass', 'min': [2.4, 0.9, -3.1], 'max': [2.9, 1.7, -3.05]}
        self.assert_found(self.media_found(self.room(slab, window=True)), {})

    def test_walls_close_a_pool(self):
        """A surface of water that reaches from wall to wall, a stone half in the water, and six quads that
        form a box."""
        water = quad([-3.1, 0.5, 6.1], [6.2, 0, 0], [0, 0, -9.2], 'glass')
        stone = {'type': 'sphere', 'material': 'stone', 'center': [0, 0.5, 0], 'radius': 0.4}
        self.assert_found(self.media_found(self.room(water, stone)), {})
        x, y, z = [1, 0, 0], [0, 1, 0], [0, 0, 1]
        left, back = [-1, 0, 0], [0, 0, -1]
        self.assert_found(self.media_found(self.room(*(quad(corner, u, v, 'glass') for corner, u, v in (
            ([0, 0.3, 1], x, y), ([1, 0.3, 0], left, y), ([1, 0.3, 1], back, y),
            ([0, 0.3, 0], z, y), ([0, 1.3, 1], x, back), ([0, 0.3, 0], x, z))))), {})


class Several(Media):
    def test_all_of_a_kind_are_counted(self):
        """Each body is named or counted; the figure is that of the named one."""
        self.write('in.obj', box((-0.3, 0, -0.3), (0.3, 0.6, 0.3), inside_out=True))
        scene = {'camera': {'position': [0, 1, 4], 'target': [0, 0.5, 0], 'fov_degrees': 40},
                 'environment': {'radiance': [1, 1, 1]},
                 'materials': {'grey': {'base_color': [0.5] * 3}, 'one': {'type': 'dielectric'},
                               'other': {'type': 'dielectric', 'ior': 1.3}},
                 'shapes': [quad([-2, -0.01, 2], [4, 0, 0], [0, 0, -4], 'grey')]}
        bodies = [{'type': 'mesh', 'file': 'in.obj', 'material': name, 'transform': [{'translate': [x, 0, 0]}]}
                  for name, x in (('one', -0.6), ('other', 0.6))]
        figures = []
        for count in 1, 2:
            found = self.media_found({**scene, 'shapes': [*scene['shapes'], *bodies[:count]]})
            self.assert_found(found, {'medium-not-entered': 'wrong'})
            figures.append(found['medium-not-entered']['figure'])
            self.assertEqual('and 1 more' in found['medium-not-entered']['place'], count == 2)
        self.assertEqual(figures[1].split()[:2], figures[0].split()[:2])


class Camera(Media):
    def test_media_about_the_camera(self):
        """The camera is in fog, which contains a ball of water. At equal priority the fog applies in the
        ball, because it is later in the file."""
        def scene(priority, **more):
            return {'camera': {**FRONT, 'position': [0, 0, 5]}, 'environment': {'radiance': [1, 1, 1]},
                    'materials': {'water': {'type': 'dielectric', 'ior': 1.33, 'priority': priority},
                                  'fog': {'type': 'dielectric', 'ior': 1.01}},
                    'shapes': [{'type': 'box', 'as': 'analytic', 'material': 'fog', 'min': [-8, -8, -8],
                                'max': [8, 8, 8]},
                               {'type': 'sphere', 'material': 'water', 'center': [0, 0, 0], 'radius': 1}]}
        found = self.media_found(scene(1))
        self.assert_found(found, {'media-overlap': 'wrong'})
        self.assertIn('a sphere, material "water", and material "fog"', found['media-overlap']['place'])
        self.assertAlmostEqual(found['media-overlap']['share'], 3.14159 / 36, delta=0.01)
        self.assert_found(self.media_found(scene(2)), {})


class Order(Media):
    """Priorities that --fix assigns: the order of all other pairs of media is unchanged."""

    def scene(self, *media):
        """Returns a scene with media given as (name, priority) in the order of the file. A ball of water is
        in fog, and another one intersects a ball of glass; priorities decide which medium applies in each."""
        def ball(name, x, y, radius):
            return {'type': 'sphere', 'material': name, 'center': [x, y, 0], 'radius': radius}
        iors = {'water': 1.33, 'fog': 1.01, 'glass': 1.5, 'oil': 1.47}
        shapes = [ball('fog', -1.5, 1.5, 1), ball('water', -1.5, 1.5, 0.5), ball('glass', 1, -1.5, 0.8),
                  ball('water', 1.8, -1.5, 0.8), ball('oil', 1.5, 1.5, 0.5)]
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'materials': {name: {'type': 'dielectric', 'ior': iors[name], 'priority': priority}
                              for name, priority in media},
                'shapes': [shape for shape in shapes if shape['material'] in dict(media)]}

    def fixed(self, scene):
        """Returns the finding's change, and the priorities in the new file."""
        path = os.path.join(self.folder.name, 'fixed.json')
        found = self.media_found(scene, '--fix', path)
        self.assertEqual(found['media-overlap']['level'], 'wrong')
        with open(path, encoding='utf-8') as file:
            edits = json.load(file).get('edits', {})
        return found['media-overlap']['change'], {edit['name']: edit['priority']
                                                  for edit in edits.get('materials', [])}, path

    def test_others_stay_above(self):
        """Glass is above water and before it in the file: a priority of 2 would put water above glass."""
        change, priorities, path = self.fixed(self.scene(('glass', 2), ('water', 1), ('fog', 1)))
        self.assertIsNotNone(change)
        self.assertEqual(priorities, {'water': 2, 'glass': 3})
        self.assertNotIn('media-overlap', self.check_file(path))

    def test_none_where_another_one_is_between(self):
        """Oil is above water and below fog, so water cannot be moved above fog without passing oil."""
        change, priorities, _ = self.fixed(self.scene(('glass', 2), ('water', 1), ('oil', 1), ('fog', 1)))
        self.assertIsNone(change)
        self.assertEqual(priorities, {})

    def test_none_where_priorities_end(self):
        change, priorities, _ = self.fixed(self.scene(('glass', 255), ('water', 254), ('fog', 254)))
        self.assertIsNone(change)
        self.assertEqual(priorities, {})

    def test_media_within_each_other(self):
        """Three media with the same priority; the innermost is first in the file."""
        scene = self.scene(('water', 1), ('oil', 1), ('fog', 1))
        scene['shapes'] = [{'type': 'sphere', 'material': name, 'center': [0, 0, 0], 'radius': radius}
                           for name, radius in (('fog', 2), ('oil', 1.5), ('water', 1))]
        change, priorities, path = self.fixed(scene)
        self.assertIsNotNone(change)
        self.assertEqual(priorities, {'oil': 2, 'water': 3})
        self.assertNotIn('media-overlap', self.check_file(path))


del Media
if __name__ == '__main__':
    unittest.main()
