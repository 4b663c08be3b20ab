#!/usr/bin/env python3
"""Tests lampyris render --trace and --reference: the rows, that the picture keeps its bits, and the forecast
for twice the time.

    test_trace.py LAMPYRIS SOURCE_ROOT
"""
import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
SCENE = os.path.join(ROOT, 'scenes', 'cornell.json')
# All pixels are alike, so their noise is known from 16 samples on.
EVEN = (os.path.join(ROOT, 'src', 'check', 'scenes', 'plane.json'), '--env', 'sky:elevation=30')


def validators():
    import jsonschema
    with open(os.path.join(ROOT, 'docs', 'render.schema.json'), encoding='utf-8') as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    trace = {**schema['$defs']['trace'], '$defs': schema['$defs']}
    return [jsonschema.Draft202012Validator(s) for s in (schema, trace)]


class Base(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.shared.cleanup)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.trace = self.path('t.csv')

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def run_one(self, *arguments, **options):
        return subprocess.run(self.command(*arguments, **options), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=300)

    def command(self, *arguments, size='20x18', scene=(SCENE,)):
        return [LAMPYRIS, 'render', *scene, '--size', size, '--json', '-q', '-o',
                self.path('out.exr'), *arguments]

    def render(self, *arguments, **options):
        result = self.run_one(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def refuse(self, code, message, *arguments, **options):
        result = self.run_one(*arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertIn(message, result.stderr)
        self.assertFalse(os.path.exists(self.path('out.exr')), 'it rendered')

    def rows(self, path=None):
        """Returns the rows of a trace as numbers; an empty field is None."""
        with open(path or self.trace, newline='', encoding='utf-8') as file:
            rows = list(csv.DictReader(file))
        texts = ('render', 'reference', 'reason')
        return [{key: value if key in texts else float(value) if value else None
                 for key, value in row.items()} for row in rows]

    def spp(self):
        return [int(row['spp']) for row in self.rows()]

    def reference(self, scene=(SCENE,)):
        """Renders a picture of many samples with its halves, once for all tests."""
        path = os.path.join(self.shared.name, os.path.basename(scene[0]) + '.exr')
        if not os.path.exists(path):
            result = subprocess.run([LAMPYRIS, 'render', *scene, '--size', '20x18', '--spp', '1024',
                                     '--seed', '777', '--aov', 'halves', '-q', '-o', path])
            self.assertEqual(result.returncode, 0)
        return path


class Trace(Base):
    def test_it_changes_no_bit(self):
        for arguments in (['--spp', '20', '--sampler', 'pcg'], ['--spp', '16', '--wave', '128'],
                          ['--adaptive', 'on', '--spp', '64'],
                          ['--spp', '12', '--sampler', 'stratified'],
                          ['--frames', '5', '--spp-per-frame', '3', '--accumulate', 'off']):
            without = self.render(*arguments)
            traced = self.render(*arguments, '--trace', self.trace)
            self.assertEqual(traced['image_hash'], without['image_hash'], arguments)
            self.assertEqual(traced['rays'], without['rays'], arguments)
            self.assertEqual(traced['trace'], self.trace)
            self.assertIsNone(without['trace'])

    def test_rows_are_at_doubling_samples(self):
        report = self.render('--spp', '20', '--trace', self.trace)
        rows = self.rows()
        self.assertEqual(self.spp(), [1, 2, 4, 8, 16, 20])
        for before, after in zip(rows, rows[1:]):
            for key in ('seconds', 'judging_seconds', 'closest_rays', 'shadow_rays'):
                self.assertLess(before[key], after[key], key)
        for row in rows:
            self.assertEqual(row['local_relmse'] is None, bool(row['reason']))
            self.assertEqual(row['at_most'] is None, row['spp'] < 2)
            self.assertEqual('fewer than two' in row['reason'], row['spp'] < 2)
            self.assertIsNone(row['true_local_relmse'])
            self.assertAlmostEqual(row['msamples_per_s'],
                                   row['spp'] * 20 * 18 * 1e-6 / row['seconds'], delta=1e-6)
        last = rows[-1]
        self.assertEqual(last['closest_rays'], report['rays']['closest'])
        self.assertAlmostEqual(last['seconds'], report['seconds']['render'], delta=1e-6)
        for key in ('local_relmse', 'ci_low', 'ci_high', 'at_most'):
            self.assertAlmostEqual(last[key] / report['error'][key], 1, delta=1e-6)
        self.assertLessEqual(last['judging_seconds'], report['seconds']['judge'])

    def test_the_parts_of_time_are_no_more_than_the_whole(self):
        seconds = self.render('--spp', '64', '--trace', self.trace)['seconds']
        parts = sum(seconds[key] for key in seconds if key not in ('total', 'render_before', 'bvh_uncached'))
        self.assertLessEqual(parts, seconds['total'] + 1e-6)
        self.assertGreater(seconds['judge'], 0)

    def test_rows_of_renders_that_end_otherwise(self):
        report = self.render('--time', '0.2', '--trace', self.trace)
        self.assertEqual(report['ended_by'], 'time')
        spp = self.spp()
        self.assertEqual(spp[-1], report['spp'])
        self.assertEqual(spp[:-1], [1 << i for i in range(len(spp) - 1)])
        report = self.render('--error', '0.01', '--sampler', 'pcg', '--trace', self.trace,
                             scene=EVEN)
        self.assertEqual(report['ended_by'], 'error')
        looks = [look['spp'] for look in report['looks']]
        doubling = [1 << i for i in range(report['spp'].bit_length())]
        self.assertEqual(self.spp(), sorted({*doubling, *looks}))
        self.assertEqual(looks[-1], report['spp'])
        self.assertAlmostEqual(
            self.rows()[-1]['local_relmse'] / report['looks'][-1]['local_relmse'], 1, delta=1e-6)
        self.render('--adaptive', 'on', '--spp', '80', '--trace', self.trace)
        self.assertEqual([round(s / 16) for s in self.spp()], [1, 2, 4, 5])

    def test_rows_of_frames(self):
        for accumulate in ('on', 'off'):
            self.render('--frames', '5', '--spp-per-frame', '3', '--accumulate', accumulate,
                        '--trace', self.trace)
            rows = self.rows()
            self.assertEqual([row['frames'] for row in rows], [1, 2, 4, 5])
            self.assertEqual(self.spp(), [3, 6, 12, 15] if accumulate == 'on' else [3] * 4)
            for row in rows:
                self.assertAlmostEqual(row['msamples_per_s'],
                                       3 * row['frames'] * 20 * 18 * 1e-6 / row['seconds'],
                                       delta=1e-6)

    def test_it_is_of_the_picture_whatever_the_wave(self):
        traces = []
        for wave in ('64', '16384'):
            self.render('--spp', '32', '--wave', wave, '--trace', self.trace, '--reference',
                        self.reference())
            traces.append([[row[key] for key in ('spp', 'local_relmse', 'ci_low', 'true_mse', 'render')]
                           for row in self.rows()])
        self.assertEqual(traces[0], traces[1])

    def test_bad_input(self):
        self.refuse(2, 'expected a name that ends in .csv or .json', '--trace', self.path('t.txt'))
        self.refuse(4, 'no/t.csv', '--trace', self.path('no/t.csv'))
        self.refuse(2, '--trace and --pixel exclude each other', '--trace', self.trace, '--pixel',
                    '1,1')
        self.refuse(4, 'is a folder', '--trace', self.make_folder('f.csv'))

    def make_folder(self, name):
        os.mkdir(self.path(name))
        return self.path(name)

    def test_a_full_disk_costs_the_trace_alone(self):
        os.symlink('/dev/full', self.trace)
        result = self.run_one('--spp', '4', '--trace', self.trace)
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn(self.trace, result.stderr)
        self.assertTrue(os.path.exists(self.path('out.exr')))


class GoingOn(Base):
    def checkpoint(self, *more):
        return ['--checkpoint', self.path('c'), '--trace', self.trace, *more]

    def keys(self):
        return [[row[key] for key in ('spp', 'closest_rays', 'local_relmse', 'ci_high', 'at_most', 'reason')]
                for row in self.rows()]

    def test_rows_are_kept(self):
        for name in ('t.csv', 't.json'):
            self.trace = self.path(name)
            read = self.keys if name == 't.csv' else self.json_keys
            self.render('--spp', '64', '--trace', self.trace)
            whole = read()
            self.render('--spp', '24', *self.checkpoint())
            self.assertEqual([row[0] for row in read()], [1, 2, 4, 8, 16, 24])
            seconds = self.render('--spp', '64', *self.checkpoint('--resume'))['seconds']
            self.assertTrue(0 < seconds['render_before'] < seconds['render'])
            self.assertEqual([row for row in read() if row[0] != 24], whole)
            os.unlink(self.path('c'))

    def json_keys(self):
        with open(self.trace, encoding='utf-8') as file:
            rows = json.load(file)['rows']
        return [[row[key] for key in ('spp', 'closest_rays', 'local_relmse', 'ci_high', 'at_most', 'reason')]
                for row in rows]

    def test_a_kill_loses_the_last_row_at_most(self):
        self.render('--spp', '1k', '--trace', self.trace)
        whole = self.keys()
        os.unlink(self.trace)
        for attempt in range(10):
            process = subprocess.Popen(
                self.command('--spp', '1k', *self.checkpoint('--resume', '--checkpoint-every', '0')),
                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            until = time.monotonic() + 60
            while process.poll() is None and time.monotonic() < until and not (
                    os.path.exists(self.trace) and len(self.rows()) >= 7):
                time.sleep(0.01)
            process.send_signal(signal.SIGKILL)
            process.communicate()
            if process.returncode == -signal.SIGKILL:
                break
            os.unlink(self.path('c'))
        else:
            self.fail('never killed')
        rows = self.keys()
        self.assertGreaterEqual(len(rows), 7)
        self.assertEqual(rows, whole[:len(rows)])
        self.render('--spp', '1k', *self.checkpoint('--resume'))
        # If the render was killed between a checkpoint and its row, that row is missing.
        self.assertIn(self.keys(), (whole, whole[:len(rows)] + whole[len(rows) + 1:]))

    def test_a_signal_keeps_the_rows(self):
        for attempt in range(10):
            process = subprocess.Popen(self.command('--spp', '1M', '--trace', self.trace),
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            until = time.monotonic() + 60
            while time.monotonic() < until and not (os.path.exists(self.trace) and
                                                    len(self.rows()) >= 5):
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            report = json.loads(process.communicate()[0])
            self.assertEqual(process.returncode, 130)
            break
        self.assertEqual(self.spp()[-1], report['spp'])
        self.assertGreaterEqual(len(self.rows()), 5)

    def reject(self, message, *arguments):
        result = self.run_one('--spp', '32', *self.checkpoint('--resume'), *arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(message, result.stderr)
        self.assertIn(self.trace, result.stderr)

    def text(self):
        with open(self.trace, encoding='utf-8') as file:
            return file.read()

    def test_other_traces_are_refused(self):
        self.render('--spp', '8', '--seed', '5', '--trace', self.trace)
        other = self.text()
        os.unlink(self.trace)
        self.render('--spp', '16', *self.checkpoint())
        own = self.text()
        self.reject('was made without a reference', '--reference', self.reference())
        for text, message in ((other, 'is the trace of another render'),
                              ('a,b\n1,2\n', 'names of columns'), ('', 'names of columns'),
                              (own.replace('\n2,', '\nx,'), 'row 2: wrong spp'),
                              (own[:-20], 'row 5'), (own + '7,8\n', 'row 6')):
            with open(self.trace, 'w', encoding='utf-8') as file:
                file.write(text)
            self.reject(message)
        self.trace = self.path('t.json')
        for text in ('', '{', '[]', '{"rows": 3}', '{"render": "x", "rows": []}'):
            with open(self.trace, 'w', encoding='utf-8') as file:
                file.write(text)
            self.reject('another render' if 'x' in text else 'list of rows')
        os.unlink(self.trace)
        result = self.run_one('--spp', '32', *self.checkpoint('--resume'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('the trace begins where the checkpoint ends', result.stderr)
        with open(self.trace, encoding='utf-8') as file:
            self.assertEqual([row['spp'] for row in json.load(file)['rows']], [32])


class Reference(Base):
    def test_the_true_error_is_that_of_compare(self):
        report = self.render('--spp', '16', '--reference', self.reference(), '--trace', self.trace)
        result = subprocess.run([LAMPYRIS, 'compare', self.path('out.exr'), self.reference(),
                                 '--json'], stdout=subprocess.PIPE, text=True, check=True)
        compared, against = json.loads(result.stdout), report['reference']
        for key in ('local_relmse', 'relmse'):
            self.assertGreater(against['own_' + key], 0)
            self.assertAlmostEqual(against[key] + against['own_' + key], compared[key], delta=1e-6)
        self.assertAlmostEqual(against['smape'], compared['smape'], delta=1e-6)
        self.assertAlmostEqual(against['psnr'], compared['psnr'], delta=1e-4)
        last = self.rows()[-1]
        for key in ('local_relmse', 'relmse', 'mse', 'smape', 'psnr'):
            self.assertAlmostEqual(last['true_' + key] / against[key], 1, delta=1e-6)

    def attributes(self):
        with open(self.path('out.exr'), 'rb') as file:
            header = file.read(16384)
        return {key.decode(): float(value) for key, value in re.findall(
            rb'lampyris:((?:local_)?relmse\w*)\0string\0.{4}([-+.0-9e]+)', header, re.S)}

    def test_the_picture_says_what_the_report_says(self):
        error = self.render('--spp', '64', scene=EVEN)['error']
        told = self.attributes()
        for key, name in (('local_relmse', 'local_relmse'), ('local_relmse_ci_low', 'ci_low'),
                          ('local_relmse_ci_high', 'ci_high'), ('local_relmse_at_most', 'at_most'),
                          ('relmse_at_most', 'relmse_at_most')):
            self.assertAlmostEqual(told[key] / error[name], 1, delta=1e-6)
        # If there is only a bound, no estimate is reported.
        error = self.render('--spp', '64', '--halves', 'contiguous', scene=EVEN)['error']
        told = self.attributes()
        self.assertEqual(set(told), {'local_relmse_at_most', 'relmse_at_most'})
        self.assertAlmostEqual(told['local_relmse_at_most'] / error['at_most'], 1, delta=1e-6)
        # If pixels depend on each other, there is neither an interval nor a bound.
        error = self.render('--spp', '64', '--roulette', 'frame')['error']
        self.assertEqual((error['known'], error['ci_low'], error['at_most']), (False, None, None))
        self.assertGreater(error['local_relmse'], 0)
        self.assertIn('depths', error['reason'])
        self.assertEqual(self.attributes(), {})

    def test_bias_is_found_and_only_where_it_is(self):
        # The test fails for 0.05 % of the seeds of a correct program. The wrong reference has a tenth too
        # much light.
        arguments = ['--spp', '128', '--sampler', 'pcg', '--reference', self.reference(EVEN)]
        report = self.render(*arguments, '--seed', '3', scene=EVEN)
        self.assertFalse(report['reference']['biased'])
        self.assertIsNone(report['forecast']['stays'])
        wrong = self.render(*arguments, '--env-strength', '1.1', scene=EVEN)
        self.assertTrue(wrong['reference']['biased'])
        self.assertAlmostEqual(wrong['reference']['stays']['value'], 0.01, delta=0.002)
        stays = wrong['reference']['stays']
        self.assertEqual(wrong['forecast']['stays'], stays['value'])
        self.assertGreater(wrong['forecast']['local_relmse'], stays['value'])
        self.assertGreater(stays['ci_low'], 0)

    def test_bad_input(self):
        for word in ('auto', 'none'):
            self.refuse(2, 'expected the file of a picture', '--reference', word)
        self.refuse(2, 'is 20 x 18 pixels, but', '--reference', self.reference(), size='18x20')
        self.refuse(2, 'no.exr', '--reference', self.path('no.exr'))
        self.refuse(2, SCENE, '--reference', SCENE)

    def test_what_is_not_known_of_a_reference_is_said(self):
        self.render('--spp', '4')
        os.rename(self.path('out.exr'), self.path('same.exr'))
        result = self.run_one('--spp', '16', '--reference', self.path('same.exr'))
        self.assertIn('was rendered with the same --seed', result.stderr)
        self.assertIsNone(json.loads(result.stdout)['reference']['own_local_relmse'])
        result = self.run_one('--spp', '16', '--reference', self.reference())
        self.assertEqual(result.stderr, '')


class Forecast(Base):
    def test_it_says_what_it_goes_by(self):
        for sampler, traced, basis in (('pcg', False, '1/samples'), ('pcg', True, '1/samples'),
                                       ('sobol', False, '1/samples or faster'),
                                       ('sobol', True, 'slope'),
                                       ('stratified', True, '1/samples or faster')):
            more = ['--trace', self.trace] if traced else []
            report = self.render('--spp', '128', '--sampler', sampler, *more, scene=EVEN)
            forecast, error = report['forecast'], report['error']
            self.assertEqual(forecast['basis'], basis)
            self.assertEqual(forecast['upper_bound'], basis == '1/samples or faster')
            self.assertAlmostEqual(forecast['seconds'], 2 * report['seconds']['render'], delta=1e-6)
            self.assertIsNone(forecast['reason'])
            slope = forecast['slope']['value'] if basis == 'slope' else -1
            self.assertEqual(forecast['looks'], 5 if basis == 'slope' else 0)
            self.assertAlmostEqual(
                forecast['local_relmse'] / (error['local_relmse'] * 2 ** slope), 1, delta=1e-6)
            self.assertLess(forecast['ci_low'], forecast['local_relmse'])
            self.assertGreater(forecast['ci_high'], forecast['local_relmse'])

    def test_a_bound_is_halved(self):
        report = self.render('--spp', '64', '--halves', 'contiguous', scene=EVEN)
        forecast, error = report['forecast'], report['error']
        self.assertEqual((error['known'], error['local_relmse']), (False, None))
        self.assertTrue(forecast['upper_bound'])
        self.assertAlmostEqual(forecast['local_relmse'] / error['at_most'], 0.5, delta=1e-6)
        # Pictures differ: half of one picture's error is not the error of the next picture.
        self.assertLess(forecast['ci_low'], 0.9 * forecast['local_relmse'])
        self.assertGreater(forecast['ci_high'], 1.1 * forecast['local_relmse'])

    def test_looks_of_error_tell_a_slope_too(self):
        report = self.render('--error', '1e-9', '--spp', '128', scene=EVEN)
        self.assertEqual(report['forecast']['basis'], 'slope')

    def test_it_is_null_while_the_error_is_not_known(self):
        for arguments, reason in ((['--spp', '1'], 'fewer than two'),
                                  (['--frames', '2', '--spp-per-frame', '32', '--accumulate', 'off'],
                                   'do not accumulate')):
            forecast = self.render(*arguments)['forecast']
            self.assertIsNone(forecast['local_relmse'])
            self.assertIn(reason, forecast['reason'])

    def test_the_summary_has_it_in_a_line(self):
        result = subprocess.run([LAMPYRIS, 'render', *EVEN, '--size', '20x18', '--spp', '8', '-o',
                                 self.path('out.exr'), '--trace', self.trace, '--explain'],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn('\nforecast  twice the time: local relMSE at most about ', result.stdout)
        self.assertIn(f'\nwrote     {self.trace}, 4 rows\n', result.stdout)
        self.assertIn('judge ', result.stdout)


class Schema(Base):
    def test_results_fit_it(self):
        try:
            render, trace = validators()
        except ImportError:
            self.assertNotIn('LAMPYRIS_NO_SKIP', os.environ)
            self.skipTest('no module jsonschema')
        path = self.path('t.json')
        for arguments in ([], ['--spp', '4'], ['--error', '0.05', '--reference', self.reference()],
                          ['--adaptive', 'on', '--checkpoint', self.path('c'), '--spp', '64'],
                          ['--frames', '3'], ['--halves', 'contiguous', '--clamp', '1'],
                          ['--validation', '--reference', self.reference()]):
            report = self.render(*arguments, '--trace', path)
            for error in render.iter_errors(report):
                self.fail(f'{arguments}: {error.json_path}: {error.message}')
            with open(path, encoding='utf-8') as file:
                for error in trace.iter_errors(json.load(file)):
                    self.fail(f'{arguments}: {error.json_path}: {error.message}')


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
