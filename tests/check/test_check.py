"""Tests lampyris check without a scene: its list, its output, and its exit codes.

    test_check.py LAMPYRIS SOURCE_ROOT [unittest's arguments]
"""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest

from program import checked, limits, need_device, run

LAMPYRIS, ROOT = sys.argv[1:3]
del sys.argv[1:3]

# The cases of the group `threads` that need a feature which LAMPYRIS_LIMITS disables.
NEEDED_BY = {'no-ballot': {'subgroups', 'reconvergence'}, 'no-texel': {'texel buffers'},
             'no-timestamps': {'timestamps'}}


def lacking(words):
    return set().union(*(NEEDED_BY.get(word, set()) for word in words.split(',')))


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
        left = {name for outcome, name, _ in lines if outcome == 'not run'}
        self.assertEqual(left, lacking(os.environ.get('LAMPYRIS_LIMITS', '')))
        self.assertIn(f'{len(lines) - len(left)} of {len(lines)} cases pass, 0 fail, {len(left)} were '
                      'not run', result.stdout)

    def test_what_a_device_lacks_is_not_run(self):
        words = 'no-ballot,no-texel,no-timestamps'
        environment = {**os.environ, 'LAMPYRIS_LIMITS': words}
        result = run(LAMPYRIS, 'check', '--only', 'threads', '--json', env=environment)
        self.assertEqual(result.returncode, 0)
        report = json.loads(result.stdout)
        left = {case['name'] for case in report['cases'] if case['outcome'] == 'not run'}
        self.assertEqual(left, lacking(words))
        self.assertEqual(report['not_run'], 4)
        self.assertEqual(report['passed'], len(report['cases']) - 4)

    def test_arithmetic_says_how_many(self):
        result = run(LAMPYRIS, 'check', '--only', 'products')
        self.assertIn('; seen all 16384 as expected (', result.stdout)

    def test_where_rounding_is_not_known(self):
        # Error bounds are twice as wide, and so is the permitted error of forms without variance.
        environment = {**os.environ, 'LAMPYRIS_LIMITS': limits('no-rounding-mode')}
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

    def test_a_lost_device(self):
        """The case that loses the device is run again. If the device stays lost, the case is not run, and the
        next case opens the device again."""
        lost = run(LAMPYRIS, 'check', '--only', 'B6', '--json', '--lose-device', '1')
        once = run(LAMPYRIS, 'check', '--only', 'B6', '--json', '--lose-device', '1',
                   '--lose-devices', '1')
        self.assertEqual((lost.returncode, once.returncode), (3, 0), lost.stderr + once.stderr)
        self.assertIn('device lost', lost.stderr)
        outcomes = [[case['outcome'] for case in json.loads(result.stdout)['cases']]
                    for result in (lost, once)]
        self.assertEqual(outcomes, [['not run'] * 3, ['pass'] * 3])
        for result, why in ((lost, 'device lost'), (once, 'was lost and has been opened again')):
            self.assertIn(why, json.loads(result.stdout)['cases'][0]['why'])

    def test_a_lost_device_has_no_other_bits(self):
        for words, code in ((['--lose-devices', '1'], 0), ([], 3)):
            result = run(LAMPYRIS, 'check', '--reproducible', '-q', '--lose-device', '100', *words)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertNotIn('the others do not', result.stdout)
            self.assertEqual('could not be rendered' in result.stdout, code == 3)

    def test_a_lost_device_that_checks_a_scene(self):
        scene = os.path.join(ROOT, 'scenes', 'cornell.json')
        check = [LAMPYRIS, 'check', scene, '--size', '24x24', '--json', '--lose-device']
        self.assertEqual(run(*check, '5').returncode, 3)
        once = run(*check, '5', '--lose-devices', '1')
        self.assertEqual(once.returncode, 0, once.stderr)
        self.assertEqual(once.stderr.count('opening the device again'), 1)
        self.assertEqual(json.loads(once.stdout)['findings'], [])

    def test_reports_that_cannot_be_written(self):
        """The error is found before a device is opened, and no device exists here. The scene that is checked
        is not overwritten."""
        environment = {**os.environ, 'VK_ICD_FILENAMES': '/nowhere', 'VK_DRIVER_FILES': '/nowhere'}
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, 'b.html'))
            for path, code in ((folder, 2), (os.path.join(folder, 'a.json'), 2),
                               (os.path.join(folder, 'b.html'), 4),
                               (os.path.join(folder, 'no', 'a.html'), 4),
                               (os.path.join(folder, 'a.html'), 69)):
                result = run(LAMPYRIS, 'check', '--report', path, env=environment)
                self.assertEqual(result.returncode, code, result.stderr)
            self.assertEqual(os.listdir(folder), ['b.html'])
            scene = os.path.join(folder, 'scene.json')
            with open(scene, 'w', encoding='utf-8') as file:
                file.write('{"lampyris": 1}')
            result = run(LAMPYRIS, 'check', scene, '--report', scene)
            self.assertEqual(result.returncode, 2)
            with open(scene, encoding='utf-8') as file:
                self.assertEqual(file.read(), '{"lampyris": 1}')

    def test_signals(self):
        """The cases that were finished before the signal are reported and written."""
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, 'a.html')
                with subprocess.Popen([LAMPYRIS, 'check', '--only', 'light', '--report', path],
                                      stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                      text=True) as process:
                    told = ''
                    while '  pass ' not in told:
                        told += process.stdout.readline()
                    process.send_signal(number)
                    told += process.communicate(timeout=60)[0]
                    self.assertEqual(process.returncode, code, told)
                self.assertRegex(told, r'\d+ of \d+ cases pass, 0 fail, [1-9]\d* were not run')
                with open(path, encoding='utf-8') as file:
                    self.assertIn('B1 sky', file.read())

    def test_options_of_devices_and_of_scenes(self):
        scene = os.path.join(ROOT, 'scenes', 'cornell.json')
        for arguments, message in ((('--spp', '3'), '--spp needs a scene'),
                                   ((scene, '--list'), '--list is for devices'),
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
