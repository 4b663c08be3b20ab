#!/usr/bin/env python3
"""The viewer's film equals the picture of `lampyris render`, bit for bit.

    test_bits.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import base64
import json
import os
import random
import struct
import unittest

import viewer_run
from viewer_run import CORNELL, DATA, SCENES, SPHERES, Case

DUCK = os.path.join(DATA, 'gltf', 'Duck', 'Duck.glb')


def moving_triangles():
    """Makes a glTF file with two triangles. The second one moves for a second and then stands still for a
    second."""
    data = struct.pack('<9f3f9f', -1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 1, 2, 0, 0, 1, 1, 0.5, 1, 1, 0.5, 1)
    uri = 'data:application/octet-stream;base64,' + base64.b64encode(data).decode()
    return {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1, 2]}],
            'nodes': [{'mesh': 0}, {'mesh': 0, 'scale': [0.5, 0.5, 0.5]},
                      {'camera': 0, 'translation': [0, 0, 5]}],
            'cameras': [{'type': 'perspective', 'perspective': {'yfov': 0.8, 'znear': 0.01}}],
            'materials': [{'pbrMetallicRoughness': {'baseColorFactor': [0.8, 0.3, 0.2, 1]}}],
            'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'material': 0}]}],
            'animations': [{'channels': [{'sampler': 0, 'target': {'node': 1,
                                                                   'path': 'translation'}}],
                            'samplers': [{'input': 1, 'output': 2}]}],
            'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3',
                           'min': [-1, -1, 0], 'max': [1, 1, 0]},
                          {'bufferView': 1, 'componentType': 5126, 'count': 3, 'type': 'SCALAR',
                           'min': [0], 'max': [2]},
                          {'bufferView': 2, 'componentType': 5126, 'count': 3, 'type': 'VEC3'}],
            'bufferViews': [{'buffer': 0, 'byteLength': 36},
                            {'buffer': 0, 'byteOffset': 36, 'byteLength': 12},
                            {'buffer': 0, 'byteOffset': 48, 'byteLength': 36}],
            'buffers': [{'byteLength': 84, 'uri': uri}]}


class Bits(Case):
    def expect_same(self, hashed, rendered):
        self.assertEqual(hashed['image_hash'], rendered['image_hash'])
        self.assertEqual(hashed['spp'], rendered['spp'])

    def check(self, scene, *arguments):
        result = self.view('wait 5 samples\nhash hash.jsonl\n', '--spp', '5', *arguments,
                           scene=scene)
        self.expect_same(result.hashes()[-1], self.render(scene, '--spp', '5', *arguments))

    def test_cornell(self):
        self.check(CORNELL)

    def test_spheres(self):
        self.check(SPHERES)

    def test_methods(self):
        for arguments in (['--sampler', 'stratified', '--halves', 'contiguous'],
                          ['--sampler', 'blue-noise', '--filter', 'gaussian'],
                          ['--integrator', 'whitted'], ['--seed', '9', '--features', 'all']):
            with self.subTest(arguments):
                self.check(CORNELL, *arguments)

    def test_without_anisotropy(self):
        """The panel's switch has the same effect as the option of `render`."""
        scene = os.path.join(SCENES, 'materials_anisotropic.json')
        result = self.view('set renderer.anisotropy off\nwait 2 samples\nhash hash.jsonl\n'
                           'key Ctrl+z\nwait 2 samples\nhash hash.jsonl\n', '--spp', '2',
                           scene=scene, size='48x32')
        off, on = result.hashes()
        self.assertNotEqual(off['image_hash'], on['image_hash'])
        self.expect_same(on, self.render(scene, '--spp', '2', size='48x32'))
        self.expect_same(off, self.render(scene, '--spp', '2', '--anisotropy', 'off', size='48x32'))

    def test_another_limit(self):
        """If the limit changes, samples that were planned for the old limit are discarded."""
        for method in (['--sampler', 'blue-noise'], ['--sampler', 'stratified'],
                       ['--halves', 'contiguous'], ['--sampler', 'sobol']):
            with self.subTest(method):
                result = self.view('wait 3 samples\nset renderer.spp 7\nwait 7 samples\n'
                                   'hash hash.jsonl\n', '--spp', '3', *method, scene=CORNELL)
                self.expect_same(result.hashes()[-1],
                                 self.render(CORNELL, '--spp', '7', *method))

    def test_glass_and_fog(self):
        self.check(os.path.join(SCENES, 'glass.json'))

    def test_gltf(self):
        models = [os.path.join(folder, name)
                  for folder, _, names in os.walk(os.path.join(DATA, 'gltf'))
                  for name in names if name.endswith(('.glb', '.gltf'))]
        if not models:
            if os.environ.get('LAMPYRIS_NO_SKIP'):
                self.fail(f'no models in {DATA}')
            self.skipTest('no models')
        self.check(DUCK if DUCK in models else min(models, key=os.path.getsize))

    def test_moved_camera(self):
        """The view after a movement is saved as a scene and rendered to the same bits."""
        for scene, keys in ((CORNELL, 'wd'), (SPHERES, 'sqa')):
            with self.subTest(scene):
                moves = ''.join(f'key {key} down\nwait 4 frames\nkey {key} up\n' for key in keys)
                look = ('mouse 60 40\nbutton right down\nmouse 90 52\nbutton right up\n'
                        'scroll 0 -1\n')
                result = self.view(f'wait 1 samples\n{moves}{look}wait 3 samples\n'
                                   'hash hash.jsonl\nscene saved.json\nstate state.json\n',
                                   '--spp', '3', scene=scene)
                os.rename(self.path('hash.jsonl'), self.path('moved.jsonl'))
                moved = result.hashes('moved.jsonl')[0]
                saved = self.render(self.path('saved.json'),
                                    '--allow-outside-paths')
                self.expect_same(moved, saved)
                self.assertNotEqual(moved['image_hash'],
                                    self.render(scene, '--spp', '3')['image_hash'])

    def test_twenty_edits_undone_and_redone(self):
        """Undoing all edits gives the bits of the beginning, and redoing them those of the end."""
        choice = random.Random(7)
        edits = []
        for _ in range(20):
            edits.append(choice.choice([
                f'set camera.fov {choice.uniform(20, 70):.3f}',
                f'set material.base_color {choice.random():.3f},{choice.random():.3f},0.5',
                f'set material.roughness {choice.random():.3f}',
                f'set renderer.max_bounces {choice.randrange(1, 9)}',
                f'set renderer.seed {choice.randrange(100)}',
                f'set material.metallic {choice.random():.3f}',
                f'set renderer.clamp {choice.uniform(0.5, 2):.3f}',
            ]))
        undo = 'key Ctrl+z\n' * 20
        redo = 'key Ctrl+y\n' * 20
        result = self.view('wait 2 samples\nhash hash.jsonl\nset material.model principled\n'
                           + '\n'.join(edits) + '\nwait 2 samples\nhash hash.jsonl\n'
                           'scene saved.json\nstate edited.json\n' + undo + 'key Ctrl+z\n'
                           'wait 2 samples\nhash hash.jsonl\nstate undone.json\n'
                           + redo + 'key Ctrl+y\nwait 2 samples\nhash hash.jsonl\n',
                           '--spp', '2')
        first, edited, undone, redone = [h['image_hash'] for h in result.hashes()]
        self.assertNotEqual(first, edited)
        self.assertEqual(first, undone)
        self.assertEqual(edited, redone)
        self.assertGreater(result.state('edited.json')['counts']['undo'], 10)
        self.assertEqual(result.state('undone.json')['counts']['undo'], 0)
        self.assertEqual(self.render(self.path('saved.json'), '--allow-outside-paths')
                         ['image_hash'], edited)

    def test_animations(self):
        """The picture at a time equals that of --at, with edits applied. A picture that does not move
        continues to accumulate."""
        path = self.write('moving.gltf', json.dumps(moving_triangles()))
        result = self.view('wait 2 samples\nset animation.time 0.5\nwait 2 samples\n'
                           'hash hash.jsonl\nset object.1 on\nset object.turn 0,0,40\n'
                           'set object.scale 1,2,1\nset material.base_color 0.2,0.7,0.1\n'
                           'set animation.time 0.75\nwait 2 samples\nhash hash.jsonl\n'
                           'scene edited.json\nkey Ctrl+z\nwait 2 samples\nhash hash.jsonl\n'
                           'scene undone.json\nset animation.speed 3\n'
                           'set animation.plays on\nwait 12 frames\nset animation.plays off\n'
                           'wait 2 samples\nhash hash.jsonl\nscene played.json\n'
                           'expect item.animation.time > 0\n', '--spp', '2', scene=path,
                           size='48x32')
        hashes = result.hashes()
        self.assertEqual(len({h['image_hash'] for h in hashes}), 4)
        self.expect_same(hashes[0], self.render(path, '--spp', '2', '--at', '0.5', size='48x32'))
        for hashed, name in zip(hashes[1:], ('edited.json', 'undone.json', 'played.json')):
            self.expect_same(hashed, self.render(self.path(name), '--allow-outside-paths',
                                                 size='48x32'))
        # The animation continues from the time at which the scene was saved.
        os.remove(self.path('hash.jsonl'))
        result = self.view('wait 2 samples\nset animation.time 0.25\nwait 2 samples\n'
                           'hash hash.jsonl\nscene edited.json\n', '--spp', '2',
                           '--allow-outside-paths', scene=self.path('edited.json'), size='48x32')
        self.expect_same(result.hashes()[-1], self.render(
            self.path('edited.json'), '--allow-outside-paths', size='48x32'))

    def test_playing_is_no_edit(self):
        """Edits can be undone and redone while the animation plays; the progress of time is not an edit."""
        path = self.write('moving.gltf', json.dumps(moving_triangles()))
        self.view('set object.1 on\nset object.position 0.5,0.5,0.5\nset object.scale 2,2,2\n'
                  'set animation.plays on\nwait 10 frames\nexpect counts.undo == 2\nkey Ctrl+z\n'
                  'wait 3 frames\nexpect counts.undo == 1\nexpect counts.redo == 1\nkey Ctrl+z\n'
                  'wait 3 frames\nexpect counts.undo == 0\nexpect item.object.position != 0.5,0.5,0.5\n'
                  'press history.redo\nwait 3 frames\nexpect counts.undo == 1\n'
                  'expect counts.redo == 1\nexpect item.object.position == 0.5,0.5,0.5\n'
                  'set animation.plays off\nexpect item.animation.time > 0\n'
                  'key Ctrl+z\nexpect counts.undo == 0\n', scene=path, size='48x32')

    def test_the_played_time_begins_anew_from_the_first_frame_on(self):
        """The control's range is the length of the animation, which the viewer knows before it is played."""
        path = self.write('moving.gltf', json.dumps(moving_triangles()))
        for speed in (-3, 100):
            with self.subTest(speed):
                check = 'wait 1 frames\nexpect item.animation.time < 2\nexpect item.animation.time >= 0\n'
                self.view(f'set animation.speed {speed}\nset animation.plays on\n' + 8 * check +
                          'set animation.plays off\n', scene=path, size='48x32')
        self.view('set animation.time 2.5\n', scene=path, size='48x32', code=1)

    def test_a_scene_saved_right_after_playing_is_what_is_shown_then(self):
        """The saved scene has the time, and the moving camera, at which the viewer stops."""
        moving = moving_triangles()
        moving['animations'][0]['channels'].append(
            {'sampler': 0, 'target': {'node': 2, 'path': 'translation'}})
        path = self.write('moving.gltf', json.dumps(moving))
        for speed in (1, -3, 100):
            with self.subTest(speed):
                result = self.view(f'set animation.speed {speed}\nset animation.plays on\nwait 8 frames\n'
                                   'set animation.plays off\nscene saved.json\nwait 2 samples\n'
                                   'hash hash.jsonl\nscene again.json\n', '--spp', '2', scene=path,
                                   size='48x32')
                with open(self.path('saved.json')) as file, open(self.path('again.json')) as again:
                    self.assertEqual(file.read(), again.read())
                self.expect_same(result.hashes()[-1], self.render(
                    self.path('saved.json'), '--allow-outside-paths', size='48x32'))

    def test_scenes_that_are_saved_in_a_row_are_all_written(self):
        path = self.write('moving.gltf', json.dumps(moving_triangles()))
        self.view('wait 1 samples\nset animation.time 0.5\nkey Ctrl+s\nscene saved.json\n', scene=path,
                  size='32x24')
        with open(self.path('saved.json')) as file, open(self.path('moving-0001.json')) as other:
            text = file.read()
            self.assertEqual(text, other.read())
        self.assertEqual(json.loads(text)['base']['at_seconds'], 0.5)
        self.view('wait 1 samples\nset animation.time 0.5\nkey Ctrl+s\nscene nowhere/b.json\n', scene=path,
                  size='32x24', code=1)

    def test_what_stands_still_goes_on(self):
        path = self.write('moving.gltf', json.dumps(moving_triangles()))
        self.view('set animation.time 1.25\nwait 40 samples\nset animation.time 1.75\n'
                  'wait 10 frames\nexpect item.animation.time == 1.75\n'
                  'expect sides.0.samples >= 40\nset view.pause on\nset animation.time 0.5\n'
                  'wait 20 frames\nwait 1 samples\nexpect sides.0.samples < 40\n', scene=path,
                  size='48x32')

    def test_a_large_scene_is_built_anew_meanwhile(self):
        """The old picture continues during the build. Edits in the meantime apply to the next build."""
        path = self.write('large.json', json.dumps({
            'lampyris': 1, 'materials': {'m': {'base_color': [0.6, 0.5, 0.4]}},
            'environment': {'radiance': [1, 1, 1]},
            'camera': {'position': [0, 0, 5], 'target': [0, 0, 0], 'fov_degrees': 40},
            'shapes': [{'type': 'generated', 'triangles': 150000, 'material': 'm'}]}))
        result = self.view('wait 2 samples\nset object.turn 0,30,0\nwait 1 frames\n'
                           'expect times.rebuilding == true\nexpect sides.0.samples >= 1\n'
                           'set object.turn 0,60,0\nset object.scale 0.5,1,1\n'
                           'set renderer.max_bounces 3\nset camera.fov 35\n'
                           'wait 2 samples\nexpect times.rebuilding == false\nhash hash.jsonl\n'
                           'scene saved.json\nset object.turn 1,2,3\nset surroundings.kind sky\n'
                           'wait 2 samples\nhash hash.jsonl\nscene again.json\n'
                           'set object.turn 4,5,6\n', '--spp', '2', scene=path, size='32x24')
        for hashed, name in zip(result.hashes(), ('saved.json', 'again.json')):
            self.expect_same(hashed, self.render(self.path(name), '--allow-outside-paths',
                                                 size='32x24'))

    def test_random_edits_of_objects_and_lights(self):
        """After random edits, some of which are undone, the saved scene renders the same bits."""
        choice = random.Random(11)

        def vector(low, high):
            return ','.join(f'{choice.uniform(low, high):.4f}' for _ in range(3))

        lines = []
        for _ in range(40):
            lines.append(choice.choice([
                f'set object.{choice.randrange(6)} on',
                f'set object.{choice.randrange(6)}.visible {choice.choice(["on", "off"])}',
                f'set object.position {vector(-0.5, 0.8)}', f'set object.turn {vector(-90, 90)}',
                f'set object.scale {vector(0.4, 1.6)}',
                'press lights.add_area', 'press lights.add',
                f'press lights.add\nset light.direction {vector(-1, -0.1)}',
                f'press lights.add\nset light.color {vector(0, 1)}\nset light.visible off',
                f'set material.emission {vector(0, 3)}',
                'set surroundings.kind sky\nset surroundings.strength 0.01',
                'key Ctrl+z', 'key Ctrl+z', 'key Ctrl+y']))
        # At least one control of each kind, and lamps that are replaced by lights.
        lines += ['press lights.add_area', 'press object.exchange', 'set light.intensity 2',
                  'press light.exchange', 'set object.turn 0,30,0', 'set object.scale 2,1,1',
                  'key Ctrl+z']
        result = self.view('wait 1 samples\n' + '\n'.join(lines) + '\nwait 2 samples\n'
                           'hash hash.jsonl\nscene saved.json\nstate state.json\n', '--spp', '2',
                           scene=CORNELL, size='64x48')
        edited = result.hashes()[-1]
        self.assertGreater(result.state()['counts']['undo'], 10)
        saved = self.render(self.path('saved.json'), '--allow-outside-paths', size='64x48')
        self.expect_same(edited, saved)
        # The scene is opened again, edited and saved over itself.
        os.remove(self.path('hash.jsonl'))
        result = self.view('wait 1 samples\nset object.2 on\nset object.turn 0,45,0\n'
                           'press lights.add\nwait 2 samples\nhash hash.jsonl\nscene saved.json\n',
                           '--spp', '2', '--allow-outside-paths', scene=self.path('saved.json'),
                           size='64x48')
        again = result.hashes()[-1]
        self.assertNotEqual(edited['image_hash'], again['image_hash'])
        self.expect_same(again, self.render(self.path('saved.json'), '--allow-outside-paths',
                                            size='64x48'))


if __name__ == '__main__':
    viewer_run.main()
