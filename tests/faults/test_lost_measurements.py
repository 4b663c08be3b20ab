#!/usr/bin/env python3
"""If a device is lost, converge and bench end with code 3 and report what was measured before.

Usage: test_lost_measurements.py LAMPYRIS FAILING_LOADER SCENE [unittest arguments]
"""
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import unittest

from program import need_device

# Meson sets LD_LIBRARY_PATH to the folder of the failing loader. Only the commands under test may find that
# loader.
if os.environ.pop('LD_LIBRARY_PATH', None) is not None:
    os.execv(sys.executable, [sys.executable, *sys.argv])

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
LOADER = os.path.abspath(sys.argv.pop(1))
SCENE = os.path.abspath(sys.argv.pop(1))


def real_loader():
    """Returns the path of the system's Vulkan loader, because its name alone would find the failing one."""
    ctypes.CDLL('libvulkan.so.1')
    with open('/proc/self/maps', encoding='utf-8') as maps:
        return next(line.split()[-1] for line in maps if 'libvulkan.so' in line)


class LostMeasurements(unittest.TestCase):
    def run_command(self, *words, **variables):
        env = dict(os.environ, LD_LIBRARY_PATH=os.path.dirname(LOADER), VKF_LOADER=real_loader(), **variables)
        return subprocess.run([LAMPYRIS, *words, '--size', '16x16', '--json'], env=env,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=100,
                              check=False)

    def submissions(self, *words):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'counts')
            result = self.run_command(*words, VKF_COUNT=path)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(path, encoding='utf-8') as file:
                return next(int(count) for name, count in map(str.split, file)
                            if name == 'vkQueueSubmit')

    def lost_at(self, n, *words):
        result = self.run_command(*words, VKF_NAME='vkQueueSubmit', VKF_N=str(n), VKF_RESULT='-4')
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn('device lost', result.stderr)
        return result

    def check(self, key, name, *words):
        """Measures two items: the device is lost at the last submission of the second one, or at the last of
        the first one."""
        last = self.lost_at(self.submissions(*words), *words)
        self.assertEqual(json.loads(last.stdout)[key], 1)
        self.assertIn('1 of 2 %s were complete and are reported' % name, last.stderr + last.stdout)
        self.assertEqual(self.lost_at(6, *words).stdout, '')

    def test_converge(self):
        self.check('replicates', 'replicates', 'converge', SCENE, '--spp', '2', '--spp-from', '1',
                   '--replicates', '2', '--reference', 'none')

    def test_bench(self):
        self.check('repeats', 'repetitions', 'bench', SCENE, '--spp', '1', '--repeats', '2')


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
