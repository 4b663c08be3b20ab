#!/usr/bin/env python3
"""--watch: changes of files on the disk appear in the picture.

    test_watch.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import os
import shutil

import viewer_run
from viewer_run import ROOT, Case


class Watch(Case):
    def test_scene(self):
        """The file is replaced by renaming, and is invalid in between. The camera stays where it was moved
        to."""
        scene = self.scene()
        with open(scene, encoding='utf-8') as file:
            text = file.read()
        self.assertIn('0.725', text)
        self.write('other.json', text.replace('0.725', '0.125'))
        self.write('broken.json', text[:-20])
        shutil.copy(scene, self.path('whole.json'))
        seen = 'wait 1200 ms\nwait idle\nwait 2 samples\n'
        result = self.view(
            'wait 2 samples\nset camera.fov 50\nwait 2 samples\nhash hash.jsonl\n'
            f'copy other.json cornell.json\n{seen}hash hash.jsonl\n'
            'expect item.camera.fov == 50\n'
            f'copy broken.json cornell.json\n{seen}hash hash.jsonl\n'
            'expect message.kind == error\n'
            f'copy whole.json cornell.json\n{seen}hash hash.jsonl\n'
            'expect message.kind != error\n'
            'expect watching == true\n', '--spp', '2', '--watch', scene=scene)
        first, other, broken, whole = [h['image_hash'] for h in result.hashes()]
        self.assertNotEqual(first, other)
        self.assertEqual(other, broken)
        self.assertEqual(first, whole)

    def test_file_that_the_scene_names(self):
        model = os.path.join(ROOT, 'scenes', 'forest', 'bush.obj')
        shutil.copy(model, self.path('a.obj'))
        with open(model, encoding='utf-8') as file:
            lines = file.readlines()
        self.write('less.obj', ''.join(lines[:-30]))
        scene = self.write('scene.json', '{"lampyris": 1, "shapes": [{"type": "mesh", "file": "a.obj"}]}')
        result = self.view('wait 2 samples\nhash hash.jsonl\ncopy less.obj a.obj\nwait 1200 ms\n'
                           'wait idle\nwait 2 samples\nhash hash.jsonl\n', '--spp', '2', '--watch',
                           scene=scene)
        self.assertEqual(len({h['image_hash'] for h in result.hashes()}), 2)

    def test_shaders(self):
        folder = shutil.copytree(os.path.join(ROOT, 'shaders'), self.path('shaders'))
        name = os.path.join(folder, 'accumulate.comp')
        with open(name, encoding='utf-8') as file:
            text = file.read()
        self.assertIn('add(sums, radiance.rgb);', text)
        self.write('other.comp', text.replace('add(sums, radiance.rgb);',
                                              'add(sums, 2.0 * radiance.rgb);'))
        result = self.view('wait 2 samples\nhash hash.jsonl\n'
                           'copy other.comp shaders/accumulate.comp\nwait 1200 ms\nwait idle\n'
                           'wait 2 samples\nhash hash.jsonl\n', '--spp', '2', '--watch',
                           '--shaders', 'shaders')
        self.assertEqual(len({h['image_hash'] for h in result.hashes()}), 2)

    def test_off(self):
        scene = self.scene()
        with open(scene, encoding='utf-8') as file:
            text = file.read()
        self.write('other.json', text.replace('0.725', '0.125'))
        result = self.view('wait 2 samples\nhash hash.jsonl\ncopy other.json cornell.json\n'
                           'wait 1000 ms\nwait 2 samples\nhash hash.jsonl\n', '--spp', '2',
                           scene=scene)
        self.assertEqual(len({h['image_hash'] for h in result.hashes()}), 1)


if __name__ == '__main__':
    viewer_run.main()
