#!/usr/bin/env python3
"""A kernel binds the buffers that it names and no others: on a device that takes few buffers at once
(LAMPYRIS_LIMITS=storage-count=N,texel-count=N) pictures keep their bits, or the kernel that needs more
is named.

Usage: test_small_device.py LAMPYRIS SCENE_FOLDER [unittest arguments]
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SCENES = os.path.abspath(sys.argv.pop(1))

# What shading binds: of the state of paths, and of scenes in storage buffers or as texels.
STATE, SCENE_STORAGE, SCENE_TEXELS = 5, {'cornell': 10, 'all_classes': 11}, {'all_classes': 7}


class SmallDevice(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.output = os.path.join(folder.name, 'a.exr')

    def render(self, scene, limits, *arguments):
        env = dict(os.environ, LAMPYRIS_LIMITS=limits)
        return subprocess.run([LAMPYRIS, 'render', os.path.join(SCENES, scene + '.json'), '--size',
                               '32x32', '--spp', '2', '-q', '--json', '-o', self.output, *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=100,
                              check=False, env=env)

    def hash(self, scene, limits, *arguments):
        result = self.render(scene, limits, *arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ''))
        return json.loads(result.stdout)['image_hash']

    def refused(self, scene, limits, needed, kind, limit, name):
        result = self.render(scene, limits)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertRegex(result.stderr, r'kernel \w+: %d %s buffers bound at once are above the limit of '
                         r'.*, which is %d \(%s\)$' % (needed, kind, limit, name))
        self.assertFalse(os.path.exists(self.output))

    def test_enough_is_enough(self):
        expected = self.hash('cornell', '')
        for limits in ('storage-count=%d' % STATE,
                       'no-texel,storage-count=%d' % SCENE_STORAGE['cornell']):
            self.assertEqual(self.hash('cornell', limits, '--validation'), expected)

    def test_a_kernel_that_names_more_is_refused(self):
        storage = 'maxPerStageDescriptorStorageBuffers'
        self.refused('cornell', 'storage-count=%d' % (STATE - 1), STATE, 'storage', STATE - 1, storage)
        for scene, count in SCENE_STORAGE.items():
            self.refused(scene, 'no-texel,storage-count=%d' % (count - 1), count, 'storage', count - 1,
                         storage)
        for scene, count in SCENE_TEXELS.items():
            self.refused(scene, 'texel-count=%d' % (count - 1), count, 'texel', count - 1,
                         'maxPerStageDescriptorSampledImages')


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
