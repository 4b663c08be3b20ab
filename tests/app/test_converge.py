"""lampyris converge on small pictures: what its results say of methods whose truth is known.

    test_converge.py LAMPYRIS
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

LAMPYRIS = sys.argv.pop(1)
SCENE = os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'scenes', 'cornell.json')


def run(*arguments):
    return subprocess.run([LAMPYRIS, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, check=False)


def converge(*arguments):
    result = run('converge', SCENE, '--size', '12x12', '--spp-from', '4', '--spp', '32', '--json',
                 '--sampler', 'pcg', *arguments)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return json.loads(result.stdout)


class Converge(unittest.TestCase):
    def test_bias_is_found_and_only_where_it_is(self):
        # One bounce is not nine: the reference has nine.
        result = converge('--vary', 'max-bounces=9,1', '--replicates', '8')
        right, wrong = result['curves']
        self.assertEqual((right['label'], wrong['label']), ('max-bounces=9', 'max-bounces=1'))
        self.assertLessEqual(right['bias']['ci_low'], 0)
        self.assertGreater(wrong['bias']['ci_low'], 0)
        self.assertLess(right['slope']['value'], wrong['slope']['value'])
        self.assertEqual(result['references'][0]['spp'], 3200)

    def test_the_slope_of_independent_samples(self):
        # The reference's noise is a hundredth of the last point's, and subtracted.
        curve = converge('--replicates', '16')['curves'][0]
        slope = curve['slope']
        self.assertTrue(slope['ci_low'] <= -1 <= slope['ci_high'] or abs(slope['value'] + 1) < 0.1,
                        slope)
        self.assertEqual([p['spp'] for p in curve['points']], [4, 8, 16, 32])
        seconds = [p['seconds']['value'] for p in curve['points']]
        self.assertEqual(seconds, sorted(seconds))

    def test_a_worse_method_is_told_apart(self):
        first, second = converge('--vary', 'nee=on,off', '--replicates', '6')['curves']
        self.assertEqual((first['verdict'], second['verdict']), ('not told apart', 'slower'))
        self.assertEqual(first['efficiency_ratio']['value'], 1)
        self.assertLess(second['efficiency_ratio']['ci_high'], 1)

    def test_without_a_reference(self):
        result = converge('--reference', 'none', '--replicates', '3', '--size', '64x64')
        curve = result['curves'][0]
        self.assertEqual(result['references'], [None])
        self.assertIsNone(curve['bias']['value'])
        self.assertIsNone(curve['points'][0]['replicates']['metrics']['ssim'][0])
        self.assertTrue(curve['points'][-1]['metrics']['relmse']['value'] > 0)
        self.assertIsNone(curve['points'][0]['metrics']['relmse']['value'])  # not known below 16 samples

    def test_a_reference_from_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'reference.exr')
            made = run('render', SCENE, '--size', '12x12', '--spp', '2000', '--seed', '9',
                       '--aov', 'halves', '-o', path)
            self.assertEqual(made.returncode, 0, made.stderr)
            result = converge('--reference', path, '--replicates', '4')
            reference = result['references'][0]
            self.assertEqual((reference['name'], reference['spp']), (path, 0))
            self.assertTrue(0 < reference['own_relmse'] < 1e-3, reference)
            wrong = run('converge', SCENE, '--size', '13x12', '--reference', path)
            self.assertEqual(wrong.returncode, 2)
            self.assertIn('is 12 x 12 pixels, but', wrong.stderr)

    def test_the_report(self):
        with tempfile.TemporaryDirectory() as folder:
            report = os.path.join(folder, 'report')
            converge('--vary', 'sampler=sobol,stratified', '--replicates', '3', '--report', report)
            with open(os.path.join(report, 'report.html'), encoding='utf-8') as file:
                page = file.read()
            for part in ('sampler=stratified', 'data:image/png;base64,', '<table>'):
                self.assertIn(part, page)
            for part in ('src="http', ' href="', '@import', 'url('):
                self.assertFalse(part in page, part)
            with open(os.path.join(report, 'results.csv'), encoding='utf-8') as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), 2 * 3 * 4)
            with open(os.path.join(report, 'results.json'), encoding='utf-8') as file:
                result = json.load(file)
            values = result['curves'][0]['points'][1]['replicates']['metrics']['relmse']
            mine = [float(r['relmse']) for r in rows
                    if r['curve'] == 'sampler=sobol' and r['spp'] == '8']
            for value, row in zip(values, mine):
                self.assertTrue(math.isclose(value, row, rel_tol=1e-6))

    def test_what_cannot_be_varied(self):
        for vary, message in (('size=1x1,2x2', 'is no setting'), ('nonsense=1', 'is no setting'),
                              ('mis=power,worst', '"worst" is unknown'), ('mis', 'KEY=A,B')):
            result = run('converge', SCENE, '--vary', vary)
            self.assertEqual(result.returncode, 2, vary)
            self.assertIn(message, result.stderr)
        result = run('converge', SCENE, '--spp', '8')
        self.assertIn('--spp-from 16 is above --spp 8', result.stderr)


if __name__ == '__main__':
    unittest.main()
