"""Tests that lampyris check finds a faulty device: for each group of cases, a program has a fault that the
group must find, and the correct program has none.

    test_planted_device.py LAMPYRIS LAMPYRIS_FAULTY
"""
import json
import os
import re
import sys
import unittest

from program import checked, need_device, run

HONEST, FAULTY = sys.argv[1:3]
del sys.argv[1:3]

# For each group, a fast case that finds a fault of this folder's meson.build, from the table of planted
# faults.
with open(os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'docs/verification.md'), encoding='utf-8') as page:
    CASES = dict(re.findall(r'^\| `([a-z-]+)` \| ([^|]+) \| [^|]+ \|$', page.read(), re.MULTILINE))


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
