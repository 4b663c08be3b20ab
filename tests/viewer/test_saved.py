#!/usr/bin/env python3
"""A scene saved by the viewer renders the same bits that the viewer shows. Scenes of several kinds are
edited, saved, opened again, edited further and saved over themselves.

    test_saved.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import os
import unittest

import viewer_run
from viewer_run import ROOT, SCENES, Case

SMALL = '80x60'


class Saved(Case):
    def edit(self, scene, edits, *arguments):
        """Edits a scene and saves it. Returns the hash of the viewer's picture."""
        script = ''.join(f'set {edit}\n' for edit in edits)
        name = self.path('hash.jsonl')
        if os.path.exists(name):
            os.remove(name)
        result = self.view(f'wait 1 samples\n{script}wait 3 samples\nhash hash.jsonl\n'
                           'scene saved.json\n', '--spp', '3', '--allow-outside-paths', *arguments,
                           scene=scene, size=SMALL)
        return result.hashes()[-1]['image_hash']

    def check(self, scene, first, second, *arguments):
        hashes = [self.edit(scene, [], *arguments)]
        for opened, edits, given in ((scene, first, arguments),
                                     (self.path('saved.json'), second, ())):
            shown = self.edit(opened, edits, *given)
            saved = self.render(self.path('saved.json'), '--allow-outside-paths', size=SMALL)
            self.assertEqual(saved['image_hash'], shown, edits)
            hashes.append(shown)
        self.assertEqual(len(set(hashes)), 3, 'an edit changed nothing')

    def test_materials_and_the_sun(self):
        self.check(os.path.join(SCENES, 'sky.json'),
                   ['material.base_color 0.123,0.456,0.789', 'light.direction 0.3,-0.8,0.1',
                    'renderer.environment_filter nearest'],
                   ['light.color 0.3,0.9,0.5', 'surroundings.rotation 77.7'],
                   '--env-rotate', '30', '--env-strength', '0.7')

    def test_surroundings(self):
        self.check(os.path.join(SCENES, 'cornell.json'),
                   ['surroundings.kind sky', 'surroundings.elevation 33.3',
                    'surroundings.strength 0.01'],
                   ['surroundings.kind constant', 'surroundings.color 0.3,0.5,0.7'],
                   '-D', 'materials.white.base_color=[0.1,0.2,0.9]')

    def test_a_dropped_image_becomes_the_environment(self):
        sky = os.path.join(ROOT, 'tests', 'fuzz', 'corpus', 'hdr', 'small.hdr')
        scene = os.path.join(SCENES, 'sky.json')
        result = self.view(f'wait 1 samples\nhash hash.jsonl\ndrop {sky}\nwait 3 frames\n'
                           'expect message.text ~ small.hdr\nexpect item.surroundings.kind == image\n'
                           'wait 3 samples\nhash hash.jsonl\nscene saved.json\npress history.undo\n'
                           'wait 3 frames\nexpect item.surroundings.kind == original\n',
                           '--spp', '3', '--allow-outside-paths', scene=scene, size=SMALL)
        before, shown = (line['image_hash'] for line in result.hashes())
        self.assertNotEqual(before, shown)
        saved = self.render(self.path('saved.json'), '--allow-outside-paths', size=SMALL)
        self.assertEqual(saved['image_hash'], shown)

    def test_what_is_seen(self):
        self.check(os.path.join(SCENES, 'shapes.json'),
                   ['object.0.visible off', 'object.2.visible off'],
                   ['object.2.visible on', 'camera.kind orthographic'])

    def test_profiles(self):
        self.check(os.path.join(SCENES, 'profiles.json'),
                   ['light.direction 0.1,-1,0.3', 'light.intensity 7.7'],
                   ['light.kind directional', 'light.diameter 1.7'])


if __name__ == '__main__':
    viewer_run.main()
