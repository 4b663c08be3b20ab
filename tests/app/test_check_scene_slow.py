#!/usr/bin/env python3
"""Tests `lampyris check SCENE` on a slow device.

Usage: test_check_scene_slow.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import re
import subprocess
import unittest

from program import limits
from scene_checks import Checks, LAMPYRIS, SOURCE


class Slow(Checks):
    def test_fewer_pixels(self):
        """The simulated slow device sleeps. The time of the check's own renders is limited."""
        environment = {**os.environ, 'LAMPYRIS_LIMITS': limits('no-timestamps,group-ns=600000')}
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        result = subprocess.run([LAMPYRIS, 'check', scene, '--size', '64x64', '--json', '-q'], text=True,
                                stdout=subprocess.PIPE, timeout=300, env=environment)
        self.assertEqual(result.returncode, 0)
        found = {finding['name']: finding for finding in json.loads(result.stdout)['findings']}
        self.assert_found(found, {'few-pixels': 'remark'})
        seconds = re.match(r'one sample of 4096 pixels takes (\S+) s', found['few-pixels']['figure'])[1]
        width, height = re.search(r'renders only (\d+) x (\d+) pixels',
                                  found['few-pixels']['consequence']).groups()
        self.assertGreater(float(seconds), 0.2)
        # The check takes 200 samples per pixel; printed seconds have two digits, and the picture is a square.
        self.assertAlmostEqual(int(width) * int(height) / 4096 * 200 * float(seconds), 30, delta=3)


if __name__ == '__main__':
    unittest.main()
