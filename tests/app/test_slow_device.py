#!/usr/bin/env python3
"""A device with a watchdog gets no more work at a time than the watchdog permits: on simulated slow devices
(LAMPYRIS_LIMITS=group-ns=N,watchdog-ms=N) no submission takes longer.

Usage: test_slow_device.py LAMPYRIS SCENE_FOLDER [unittest arguments]
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

from program import limits, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SCENES = os.path.abspath(sys.argv.pop(1))


class SlowDevice(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def render(self, words, *arguments, scene='cornell'):
        env = dict(os.environ, LAMPYRIS_LIMITS=limits(words)) if words else None
        # Waves are as large as on GPUs. A lost device ends the render.
        return subprocess.run([LAMPYRIS, 'render', os.path.join(SCENES, scene + '.json'), '--size',
                               '128x128', '--spp', '2', '--wave', '1M', '--reopen', '0', '-q',
                               '--json', '-o', os.path.join(self.folder.name, 'a.exr'),
                               *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, timeout=100, check=False, env=env)

    def launches(self, words, *arguments, **options):
        """Returns how many times the tracing kernel is launched. The picture must equal that of a fast
        device."""
        fast = json.loads(self.render(None, *arguments, **options).stdout)
        result = self.render(words, *arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        slow = json.loads(result.stdout)
        for key in 'image_hash', 'rays', 'wave':
            self.assertEqual(slow[key], fast[key])
        for name, kernel in slow['kernels'].items():
            # The limit is PACE_DISPATCH_NS; new work may take twice as long.
            self.assertLessEqual(kernel['longest_ms'], 100.0, name)
        return slow['kernels']['intersect_closest']['launches']

    def test_no_submission_is_too_long(self):
        # 16384 pixels are 128 workgroups. A kernel over all of them takes from 1 to 400 ms, and a bounce
        # several times that. PACE_SUBMISSION_NS is 200 ms.
        launches = [self.launches('group-ns=%d,watchdog-ms=250' % ns)
                    for ns in (10000, 100000, 1000000, 3000000)]
        self.assertEqual(launches, sorted(launches))
        self.assertGreater(launches[3], 5 * launches[0])  # because waves become smaller

    def test_other_kernels(self):
        self.launches('group-ns=1000000,watchdog-ms=250', scene='all_classes')
        self.launches('group-ns=1000000,watchdog-ms=250', '--adaptive', 'on', '--spp', '16')
        self.launches('group-ns=1000000,watchdog-ms=250', scene='whitted')

    def test_kernels_alone(self):
        """The time of a kernel is the sum over its parts: 1 ms for each workgroup of 128 items."""
        for kernel, depth in (('generate_rays', None), ('intersect_closest', '0'),
                              ('intersect_closest', '1'), ('intersect_shadow', '1'),
                              ('shade_surface', '1'), ('prepare_dispatch', '0'),
                              ('accumulate', None), ('resolve', None)):
            env = dict(os.environ, LAMPYRIS_LIMITS=limits('group-ns=1000000,watchdog-ms=250'))
            result = subprocess.run([LAMPYRIS, 'bench', os.path.join(SCENES, 'cornell.json'), '--size',
                                     '128x128', '--spp', '4', '--wave', '1M', '--workgroup', '128',
                                     '--kernel', kernel, *(['--depth', depth] if depth else []),
                                     '--repeats', '2', '-q', '--json'], stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, text=True, timeout=100, check=False,
                                    env=env)
            self.assertEqual(result.returncode, 0, f'{kernel}: {result.stderr}')
            row = json.loads(result.stdout)['variants'][0]['rows'][0]
            if kernel != 'shade_surface':  # this kernel is dispatched for all rays, some of which have missed
                self.assertEqual(row['repeat_ms'], 2 * [math.ceil(row['items'] / 128)], kernel)

    def test_the_clock_tells_where_there_are_no_timestamps(self):
        # Only simulated time is tested, because other programs may keep this machine busy.
        self.launches('group-ns=20000,no-timestamps,watchdog-ms=250')

    def test_the_watchdog_bites(self):
        result = self.render('group-ns=100000,watchdog-ms=1')
        self.assertEqual(result.returncode, 3)
        self.assertIn('device lost', result.stderr)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
