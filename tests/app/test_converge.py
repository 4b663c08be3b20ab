"""Tests lampyris converge on small pictures, with methods whose true results are known.

    test_converge.py LAMPYRIS
"""

import csv
import json
import math
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import unittest

import program

try:
    import jsonschema
except ImportError:
    print('skipped: no module jsonschema')
    sys.exit(1 if os.environ.get('LAMPYRIS_NO_SKIP') else 77)

LAMPYRIS = sys.argv.pop(1)
ROOT = os.environ['LAMPYRIS_SOURCE_ROOT']
SCENE = os.path.join(ROOT, 'scenes', 'cornell.json')
with open(os.path.join(ROOT, 'docs', 'converge.schema.json'), encoding='utf-8') as schema_file:
    SCHEMA = jsonschema.Draft202012Validator(json.load(schema_file))


def run(*arguments, **more):
    return program.run(LAMPYRIS, *arguments, **more)


def converge(*arguments):
    result = run('converge', SCENE, '--size', '12x12', '--spp-from', '4', '--spp', '32', '--json',
                 '--sampler', 'pcg', *arguments)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return checked(result.stdout)


def converge_at_times(times, *arguments):
    result = run('converge', SCENE, '--size', '12x12', '--times', times, '--replicates', '3',
                 '--json', *arguments)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return checked(result.stdout)


def checked(text):
    result = json.loads(text)
    SCHEMA.validate(result)
    return result


class Converge(unittest.TestCase):
    def test_bias_is_found_and_only_where_it_is(self):
        # Paths of one bounce differ from the reference, which has nine.
        result = converge('--vary', 'max-bounces=9,1', '--replicates', '8')
        right, wrong = result['curves']
        self.assertEqual((right['label'], wrong['label']), ('max-bounces=9', 'max-bounces=1'))
        self.assertLessEqual(right['bias']['ci_low'], 0)
        self.assertGreater(wrong['bias']['ci_low'], 0)
        self.assertLess(right['slope']['value'], wrong['slope']['value'])
        self.assertEqual(result['references'][0]['spp'], 3200)

    def test_the_slope_of_independent_samples(self):
        # The reference's noise is a hundredth of the last point's noise, and is subtracted.
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
        for point in curve['points']:
            self.assertEqual(point['unknown'], 0)
            self.assertTrue(point['metrics']['local_relmse']['value'] > 0)
            self.assertIsNone(point['metrics']['relmse']['value'])  # there is at best a bound
            for told, most in zip(point['replicates']['metrics']['local_relmse'],
                                  point['replicates']['local_relmse_at_most']):
                self.assertLess(told, most)

    def test_errors_that_are_bounded_alone(self):
        # Contiguous halves overestimate the error, so neither the error nor results that depend on it are
        # reported.
        result = converge('--reference', 'none', '--replicates', '3', '--curve', 'halves=contiguous',
                          '--curve', 'halves=independent', '--size', '32x32')
        bounded, known = result['curves']
        for point in bounded['points']:
            self.assertEqual(point['unknown'], 3)
            self.assertIsNone(point['metrics']['local_relmse']['value'])
            self.assertIsNone(point['metrics']['mse']['value'])
            bounds = point['replicates']['local_relmse_at_most']
            mean = math.exp(sum(math.log(b) for b in bounds) / 3)
            self.assertTrue(math.isclose(point['local_relmse_at_most'], mean, rel_tol=1e-6))
        for key in ('slope', 'efficiency', 'efficiency_ratio'):
            self.assertIsNone(bounded[key]['value'])
        self.assertEqual(known['points'][-1]['unknown'], 0)
        self.assertTrue(any('for 12 of 24 pictures the half-buffers give only a bound' in note for note in result['notes']))
        text = run('converge', SCENE, '--size', '32x32', '--spp', '32', '--reference', 'none',
                   '--replicates', '2', '--halves', 'contiguous').stdout
        self.assertRegex(text, r'as given +at most 0\.\d+ +not known')

    def test_it_agrees_with_render_and_compare(self):
        # For one picture, converge, render and compare measure the same error against a reference, and the
        # interval from the half-buffers contains it.
        with tempfile.TemporaryDirectory() as folder:
            truth, picture = (os.path.join(folder, name) for name in ('truth.exr', 'out.exr'))
            size = ('--size', '48x48')
            made = run('render', SCENE, *size, '--spp', '2000', '--seed', '9', '--aov', 'halves',
                       '-q', '-o', truth)
            self.assertEqual(made.returncode, 0, made.stderr)
            alone, measured = (
                converge('--reference', name, '--replicates', '2', *size, '--spp-from', '32',
                         '--seed', '3')['curves'][0] for name in ('none', truth))
            render = json.loads(run(*shlex.split(measured['command'])[1:], '--json', '--reference',
                                    truth, '-o', picture).stdout)
            self.assertEqual(render['image_hash'], measured['image_hash'])
            compared = json.loads(run('compare', picture, truth, '--reference-variance', 'auto',
                                      '--json').stdout)

            def first(curve):
                return curve['points'][-1]['replicates']['metrics']
            for name in ('local_relmse', 'relmse', 'mse'):
                self.assertTrue(math.isclose(render['reference'][name], compared[name],
                                             rel_tol=1e-5), name)
                self.assertTrue(math.isclose(first(measured)[name][0], compared[name],
                                             rel_tol=1e-5), name)
            self.assertTrue(math.isclose(first(alone)['local_relmse'][0],
                                         render['error']['local_relmse'], rel_tol=1e-9))
            self.assertTrue(render['error']['known'])
            self.assertLess(render['error']['ci_low'], compared['local_relmse'])
            self.assertLess(compared['local_relmse'], render['error']['ci_high'])
            self.assertLess(compared['relmse'], render['error']['relmse_at_most'])

    def test_a_reference_from_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'reference.exr')
            made = run('render', SCENE, '--size', '12x12', '--spp', '2000', '--seed', '9',
                       '--aov', 'halves', '-o', path)
            self.assertEqual(made.returncode, 0, made.stderr)
            result = converge('--reference', path, '--replicates', '4')
            reference = result['references'][0]
            self.assertEqual((reference['name'], reference['spp']), (path, 0))
            self.assertTrue(0 < reference['own_local_relmse'] < reference['own_relmse'] < 1e-3,
                            reference)
            # The variance of each value gives the same noise. Without halves and variance the noise is
            # reported as not known.
            for aov, noise in (('variance', reference['own_local_relmse']), ('albedo', None)):
                other = os.path.join(folder, aov + '.exr')
                made = run('render', SCENE, '--size', '12x12', '--spp', '2000', '--seed', '9',
                           '--aov', aov, '-o', other)
                self.assertEqual(made.returncode, 0, made.stderr)
                told = run('converge', SCENE, '--size', '12x12', '--spp-from', '4', '--spp', '8',
                           '--replicates', '2', '--json', '--reference-from', other)
                self.assertEqual("the reference's own noise is not known" in told.stderr, noise is None)
                own = json.loads(told.stdout)['references'][0]['own_local_relmse']
                self.assertTrue(own == noise if noise is None else
                                math.isclose(own, noise, rel_tol=1e-6), (own, noise))
            wrong = run('converge', SCENE, '--size', '13x12', '--reference-from', path)
            self.assertEqual(wrong.returncode, 2)
            self.assertIn('is 12 x 12 pixels, but', wrong.stderr)

    def test_the_cost_of_a_reference_is_said_before(self):
        result = run('converge', SCENE, '--size', '8x8', '--spp-from', '2', '--spp', '4', '--replicates', '2')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r'the reference takes 400 samples per pixel, 100 times those of '
                                        r'the longest curve; expected time about [\d.e-]+ s\. ')
        quiet = run('converge', SCENE, '--size', '8x8', '--spp-from', '2', '--spp', '4', '--replicates', '2', '-q')
        self.assertEqual((quiet.returncode, quiet.stderr), (0, ''))

    def test_points_at_times(self):
        result = converge_at_times('0.02,0.04,0.08', '--vary', 'sampler=pcg,stratified')
        self.assertEqual(result['slope_on'], 'seconds')
        going_on, planned = result['curves']
        for curve in (going_on, planned):
            self.assertEqual([p['time_limit'] for p in curve['points']], [0.02, 0.04, 0.08])
        for r in range(3):
            spp = [p['replicates']['spp'][r] for p in going_on['points']]
            self.assertEqual(spp, sorted(spp))
            seconds = [p['replicates']['seconds'][r] for p in going_on['points']]
            self.assertEqual(seconds, sorted(seconds))
        # The reference has a hundred times the samples that fit into the longest time.
        self.assertGreater(result['references'][0]['spp'], 100)
        with tempfile.TemporaryDirectory() as folder:
            for curve in (going_on, planned):
                command = shlex.split(curve['command'])
                again = run(*command[1:], '--json', '-o', os.path.join(folder, 'again.exr'))
                self.assertEqual(json.loads(again.stdout)['image_hash'], curve['image_hash'])

    def test_all_pairs_and_all_metrics(self):
        result = converge('--vary', 'max-bounces=9,8,1', '--replicates', '4')
        pairs = {(p['curve'], p['than']): p for p in result['pairs']}
        self.assertEqual(sorted(pairs), [(1, 0), (2, 0), (2, 1)])
        for i in (1, 2):
            self.assertEqual(pairs[i, 0]['efficiency_ratio'],
                             result['curves'][i]['efficiency_ratio'])
        for curve in result['curves']:
            last = curve['points'][-1]
            for name, interval in last['metrics'].items():
                values = last['replicates']['metrics'][name]
                self.assertNotIn(None, values, name)
                self.assertLess(interval['ci_low'], interval['value'], name)
                mean = sum(values) / len(values)
                if name in ('local_relmse', 'relmse', 'mse'):
                    mean = math.exp(sum(math.log(v) for v in values) / len(values))
                self.assertTrue(math.isclose(interval['value'], mean, rel_tol=1e-6), name)
            for key, name in (('efficiency', 'local_relmse'), ('efficiency_mse', 'mse')):
                mean = [math.log(1 / (e * t)) for e, t in zip(last['replicates']['metrics'][name],
                                                              last['replicates']['seconds'])]
                self.assertTrue(math.isclose(math.log(curve[key]['value']),
                                             sum(mean) / len(mean), rel_tol=1e-6))
        self.assertTrue(any('fewer than 16' in note for note in result['notes']))
        self.assertTrue(any('of the 3 pairs' in note for note in result['notes']))


class Report(unittest.TestCase):
    def test_the_report(self):
        with tempfile.TemporaryDirectory() as folder:
            report = os.path.join(folder, 'report')
            converge('--vary', 'sampler=sobol,stratified', '--replicates', '3', '--report', report)
            with open(os.path.join(report, 'report.html'), encoding='utf-8') as file:
                page = file.read()
            for part in ('sampler=stratified', 'id="pixels-0-0-0">', '<table>'):
                self.assertIn(part, page)
            for part in ('src="http', ' href="', '@import', 'url('):
                self.assertFalse(part in page, part)
            with open(os.path.join(report, 'results.csv'), encoding='utf-8') as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), 2 * 3 * 4)
            with open(os.path.join(report, 'results.json'), encoding='utf-8') as file:
                result = json.load(file)
            values = result['curves'][0]['points'][1]['replicates']['metrics']['local_relmse']
            mine = [float(r['local_relmse']) for r in rows
                    if r['curve'] == 'sampler=sobol' and r['spp'] == '8']
            for value, row in zip(values, mine):
                self.assertTrue(math.isclose(value, row, rel_tol=1e-6))

    # Without gnuplot and --images, only the report is written.
    def test_the_report_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            report = os.path.join(folder, 'report')
            result = run('converge', SCENE, '--size', '8x8', '--spp-from', '4', '--spp', '8',
                         '--replicates', '2', '--report', report, env={**os.environ, 'PATH': folder})
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn('gnuplot', result.stderr)
            self.assertEqual(sorted(os.listdir(report)), ['report.html', 'results.csv', 'results.json'])
            with open(os.path.join(report, 'report.html'), encoding='utf-8') as file:
                page = file.read()
            self.assertNotIn('<svg', page)

    # The command that the report gives renders the same picture, bit for bit.
    def test_pictures_again(self):
        with tempfile.TemporaryDirectory() as folder:
            result = converge('--reference', 'none', '--replicates', '2', '--seed', '7',
                              '--curve', 'halves=contiguous mis=none',
                              '--vary', 'sampler=sobol,pcg,stratified', '--report', folder, '--images')
            files = os.listdir(folder)
            for i, curve in enumerate(result['curves']):
                command = shlex.split(curve['command'])
                self.assertEqual(command[:3], ['lampyris', 'render', SCENE])
                path = os.path.join(folder, 'again.exr')
                again = run(*command[1:], '--json', '-o', path)
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertEqual(json.loads(again.stdout)['image_hash'], curve['image_hash'])
                name = f'curve-{i}-seed-7.exr'
                self.assertIn(name, files)
                same = run('compare', path, os.path.join(folder, name), '--max', 'differing=0')
                self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
            for name in ('curve-0.png', 'curve-3-seed-8.exr'):
                self.assertIn(name, files)

    def test_an_interrupted_run_tells_what_it_has(self):
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.Popen(
                [LAMPYRIS, 'converge', SCENE, '--size', '8x8', '--spp', '16', '--reference', 'none',
                 '--replicates', '4096', '--json', '--report', folder],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            for line in process.stderr:  # after a second of replicates, many of which are complete
                if line.startswith('Replicates'):
                    break
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate()
            self.assertEqual(process.returncode, 130)
            result = checked(out)
            self.assertTrue(result['stopped_early'])
            self.assertTrue(0 < result['replicates'] < 4096)
            self.assertIn(f"{result['replicates']} of 4096 replicates", result['notes'][0])
            with open(os.path.join(folder, 'report.html'), encoding='utf-8') as file:
                self.assertIn('of 4096 replicates', file.read())

    def test_what_cannot_be_varied(self):
        for vary, message in (('size=1x1,2x2', 'is not a setting'), ('nonsense=1', 'is not a setting'),
                              ('mis=power,worst', '"worst" is unknown'), ('mis', 'KEY=A,B')):
            result = run('converge', SCENE, '--vary', vary)
            self.assertEqual(result.returncode, 2, vary)
            self.assertIn(message, result.stderr)
        result = run('converge', SCENE, '--spp', '8')
        self.assertIn('--spp-from 16 is above --spp 8', result.stderr)
        for arguments, message in (
                (('--times', '1,0.5'), '--times'), (('--times', '1', '--spp', '8'), 'exclude'),
                (('--times', '0'), '0.001'), (('--images',), '--images needs --report'),
                (('--replicates', '1'), 'outside [2, 4096]'), (('--curve', 'mis'), 'KEY=VALUE'),
                (('--reference', '/nonexistent.exr'), '/nonexistent.exr'),
                (('--reference-from', 'auto'), 'auto: No such file'),
                (('--reference-from', 'a.exr', '--reference', 'none'), 'exclude each other'),
                (('--reference', SCENE), 'not an image that can be read'),
                (('--vary', 'max-bounces=1,x'), '"x"'),
                (('--spp', '1G', '--spp-from', '1G'), '100 times the samples')):
            result = run('converge', SCENE, '--size', '4x4', *arguments)
            self.assertEqual(result.returncode, 2, (arguments, result.stderr))
            self.assertIn(message, result.stderr)


class Long(unittest.TestCase):
    # An error that the report extrapolates beyond the last point is reached there.
    def test_running_to_what_was_extrapolated(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'reference.exr')
            made = run('render', SCENE, '--size', '12x12', '--spp', '20000', '--seed', '9', '-q',
                       '--max-bounces', '2', '--aov', 'halves', '-o', path)
            self.assertEqual(made.returncode, 0, made.stderr)
            for sampler in ('pcg', 'sobol'):
                arguments = ('--reference', path, '--max-bounces', '2', '--sampler', sampler)
                short = converge(*arguments)['curves'][0]['time_to'][1]
                long = converge(*arguments, '--spp', '1k')['curves'][0]['time_to'][1]
                self.assertTrue(short['extrapolated'] and not long['extrapolated'])
                reached = long['spp']
                self.assertLess(short['spp']['ci_low'], reached['ci_high'], sampler)
                self.assertGreater(short['spp']['ci_high'], reached['ci_low'], sampler)
                self.assertLess(0.5, short['spp']['value'] / reached['value'])
                self.assertLess(short['spp']['value'] / reached['value'], 2)


if __name__ == '__main__':
    unittest.main()
