"""lampyris check: what it lists, what it says, how it ends.

    test_check.py LAMPYRIS SOURCE_ROOT [unittest's arguments]
"""
import json
import os
import re
import sys
import tempfile
import unittest

from program import checked, need_device, run

LAMPYRIS, ROOT = sys.argv[1:3]
del sys.argv[1:3]


def listed():
    return json.loads(checked(LAMPYRIS, 'check', '--list', '--json'))['cases']


class Check(unittest.TestCase):
    def test_names_are_unique(self):
        names = [case['name'] for case in listed()]
        self.assertGreater(len(names), 200)
        self.assertEqual(sorted(names), sorted(set(names)))
        groups = {case['group'] for case in listed()}
        self.assertTrue(groups.isdisjoint(names))

    def test_the_list_is_for_people_too(self):
        text = checked(LAMPYRIS, 'check', '--list')
        for case in listed():
            self.assertIn(f"  {case['name']} ", text)
            self.assertTrue(case['expected'])

    def test_by_group_by_case_and_by_number(self):
        for only, least in (('arithmetic', 10), ('products', 1), ('C14', 5)):
            cases = json.loads(checked(LAMPYRIS, 'check', '--only', only, '--json'))['cases']
            self.assertGreaterEqual(len(cases), least)
            self.assertEqual({case['outcome'] for case in cases}, {'pass'})
        missing = run(LAMPYRIS, 'check', '--only', 'nothing')
        self.assertEqual(missing.returncode, 2)
        self.assertIn('--only nothing: there is no such group or case', missing.stderr)

    def test_a_line_a_case(self):
        result = run(LAMPYRIS, 'check', '--only', 'threads')
        lines = re.findall(r'^  (pass|FAIL|not run) +(.*?): (.*) \(\d+\.\d s\)$', result.stdout,
                           re.MULTILINE)
        self.assertEqual(len(lines), sum(case['group'] == 'threads' for case in listed()))
        self.assertRegex(result.stdout, r'\d+ of \d+ cases pass, 0 fail, 0 were not run')

    def test_what_a_device_lacks_is_not_run(self):
        environment = {**os.environ, 'LAMPYRIS_LIMITS': 'no-ballot,no-texel,no-timestamps'}
        result = run(LAMPYRIS, 'check', '--only', 'threads', '--json', env=environment)
        self.assertEqual(result.returncode, 0)
        report = json.loads(result.stdout)
        left = {case['name'] for case in report['cases'] if case['outcome'] == 'not run'}
        self.assertEqual(left, {'subgroups', 'reconvergence', 'texel buffers', 'timestamps'})
        self.assertEqual(report['not_run'], 4)
        self.assertEqual(report['passed'], len(report['cases']) - 4)

    def test_arithmetic_says_how_many(self):
        result = run(LAMPYRIS, 'check', '--only', 'products')
        self.assertIn('; seen all 16384 as expected (', result.stdout)

    def test_where_rounding_is_not_known(self):
        # Bounds of errors are twice as wide, and so is what forms without variance allow.
        environment = {**os.environ, 'LAMPYRIS_LIMITS': 'no-rounding-mode'}
        result = run(LAMPYRIS, 'check', '--only', 'B19 field ball of fog', env=environment)
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_a_report_with_pictures(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'device.html')
            checked(LAMPYRIS, 'check', '--only', 'B2', '--report', path)
            with open(path, encoding='utf-8') as file:
                page = file.read()
        self.assertIn('B2 convex: sphere', page)
        self.assertGreaterEqual(page.count('data:image/png'), 3)

    def test_options_of_devices_and_of_scenes(self):
        scene = os.path.join(ROOT, 'scenes', 'cornell.json')
        for arguments, message in ((('--spp', '3'), '--spp needs a scene'),
                                   ((scene, '--list'), '--list is of devices'),
                                   (('--only', 'bits', '--reproducible'), 'exclude each other')):
            result = run(LAMPYRIS, 'check', *arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(message, result.stderr)

    def test_results_fit_the_schema(self):
        try:
            import jsonschema  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest('no module jsonschema')
        with open(os.path.join(ROOT, 'docs', 'check.schema.json'), encoding='utf-8') as file:
            schema = json.load(file)
        for arguments in (('--list',), ('--only', 'threads'), ('--only', 'B5')):
            result = json.loads(checked(LAMPYRIS, 'check', '--json', *arguments))
            jsonschema.validate(result, schema)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
