#!/usr/bin/env python3
"""A kernel binds only the buffers that it uses: on a device with few bindings
(LAMPYRIS_LIMITS=storage-count=N,texel-count=N) pictures keep their bits, or the error names the kernel that
needs more.

Usage: test_small_device.py LAMPYRIS SCENE_FOLDER SmallDevice|EveryScene
"""
import glob
import json
import os
import subprocess
import sys
import tempfile
import unittest

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SCENES = os.path.abspath(sys.argv.pop(1))

# The number of storage buffers that shading binds: for the state of paths as many as Vulkan guarantees, and
# for scenes in storage buffers or in texel buffers.
STATE, SCENE_STORAGE, SCENE_TEXELS = 4, {'cornell': 9, 'all_classes': 10}, {'cornell': 6}
LEAST = 'storage-count=%d' % STATE


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.output = os.path.join(folder.name, 'a.exr')

    def render(self, scene, limits, *arguments, size='32x32', spp='2'):
        env = dict(os.environ, LAMPYRIS_LIMITS=limits)
        return subprocess.run([LAMPYRIS, 'render', os.path.join(SCENES, scene + '.json'), '--size', size,
                               '--spp', spp, '-q', '--json', '-o', self.output, *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
                              check=False, env=env)

    def hash(self, scene, limits, *arguments, **options):
        result = self.render(scene, limits, *arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)['image_hash']

    def same(self, scene, *arguments, **options):
        """Returns whether the render gives the same picture and no message."""
        results = [self.render(scene, limits, *arguments, **options) for limits in ('', LEAST)]
        is_picture = results[0].returncode == 0
        seen = [(result.returncode, json.loads(result.stdout)['image_hash'] if is_picture else result.stderr)
                for result in results]
        self.assertEqual(seen[0], seen[1])
        return is_picture


class SmallDevice(Case):
    def refused(self, scene, limits, needed, kind, limit, name, why='error: '):
        result = self.render(scene, limits)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertRegex(result.stderr, why + r'kernel \w+: it binds %d %s buffers at once; the limit of '
                         r'.* is %d \(%s\)$' % (needed, kind, limit, name))
        self.assertFalse(os.path.exists(self.output))

    def test_enough_is_enough(self):
        expected = self.hash('cornell', '')
        for limits in (LEAST, 'no-texel,storage-count=%d' % SCENE_STORAGE['cornell']):
            self.assertEqual(self.hash('cornell', limits, '--validation'), expected)

    def test_all_that_a_render_may_need(self):
        for arguments in (['--integrator', 'ao'], ['--integrator', 'whitted'], ['--aov', 'all'],
                          ['--adaptive', 'on', '--spp', '32']):
            self.assertTrue(self.same('cornell', *arguments, size='16x16'), arguments)

    def test_a_kernel_that_names_more_is_refused(self):
        storage = 'maxPerStageDescriptorStorageBuffers'
        self.refused('cornell', 'storage-count=%d' % (STATE - 1), STATE, 'storage', STATE - 1, storage)
        for scene, count in SCENE_STORAGE.items():
            self.refused(scene, 'no-texel,storage-count=%d' % (count - 1), count, 'storage', count - 1,
                         storage)
        for scene, count in SCENE_TEXELS.items():
            self.refused(scene, 'texel-count=%d' % (count - 1), count, 'texel', count - 1,
                         'maxPerStageDescriptorSampledImages')

    def test_a_scene_that_is_too_long_for_texels_is_refused(self):
        self.refused('sky', LEAST + ',texel-elements=65536', 5, 'storage', STATE,
                     'maxPerStageDescriptorStorageBuffers',
                     r'error: the scene is read from storage buffers, since its environment would be \d{5,} '
                     r'texels, and a texel buffer of the device has at most 65536 \(maxTexelBufferElements\): ')


class EveryScene(Case):
    """Renders every scene with each integrator (in the long suite). Scenes that are refused must be refused
    for the same reason."""

    def test_every_scene(self):
        pictures = 0
        for path in sorted(glob.glob(os.path.join(SCENES, '*.json'))):
            for integrator in 'path', 'ao', 'whitted':
                arguments = ['--integrator', integrator]
                if os.path.basename(path) == 'mesh_room.json':
                    arguments += ['-D', 'mesh=' + os.path.join(SCENES, 'models', 'vase.glb')]
                with self.subTest(path, integrator=integrator):
                    pictures += self.same(os.path.basename(path)[:-5], *arguments, size='16x16', spp='1')
        self.assertGreater(pictures, 120)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
