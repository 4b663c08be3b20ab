"""Whether lampyris check finds a faulty device: for each group of cases a program with a fault that the
group must find, beside the honest one.

    test_planted_device.py LAMPYRIS LAMPYRIS_FAULTY
"""
import json
import sys
import unittest

from program import checked, need_device, run

HONEST, FAULTY = sys.argv[1:3]
del sys.argv[1:3]

# What is planted is in tests/planted/meson.build. A case of each group that is quick.
CASES = {
    'arithmetic': 'products', 'threads': 'atomics', 'bits': 'G1 waves of 352 paths',
    'bsdf': 'A4 reciprocity',
    'light': 'B5 lamp at 1', 'media': 'B17 fog', 'rooms': 'B3 box', 'lamps': 'C3 plane over a quad',
    'grounds': 'B6 sun on a plane', 'bodies': 'B19 box of fog', 'fields': 'B19 field ball of fog',
    'integrators': 'ambient, whitted', 'scales': 'C1 all lengths times 1e12',
    'distances': 'C45 white sphere from 1e8 m', 'small-lamps': 'C14 lamp of 1e-8 m',
    'bounded': 'C18 reflectance 1 under a rough coat',
    'samplers': 'C37 dimensions up to 2^32',
    'rays': 'C12 corners, edges and zeros of both signs',
    'environments': 'B25 patch alone', 'meshes': 'C9 one triangle',
    'textures': 'C31 texture of 16384 x 1',
    'stiff': 'C5 floor of slivers, 1e6 : 1',
}


class Planted(unittest.TestCase):
    def test_every_group_finds_its_fault(self):
        listed = json.loads(checked(HONEST, 'check', '--list', '--json'))['cases']
        self.assertEqual({case['group'] for case in listed}, set(CASES))
        for group, case in CASES.items():
            with self.subTest(group=group):
                honest = run(HONEST, 'check', '--only', case, '--json')
                faulty = run(FAULTY, 'check', '--only', case, '--json')
                self.assertEqual((honest.returncode, faulty.returncode), (0, 1),
                                 honest.stdout + faulty.stdout)
                row, = json.loads(faulty.stdout)['cases']
                self.assertEqual((row['group'], row['outcome']), (group, 'fail'))


if __name__ == '__main__':
    need_device(HONEST)
    unittest.main()
