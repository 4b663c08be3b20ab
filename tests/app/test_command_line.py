#!/usr/bin/env python3
"""Runs the program as a user would. Tests exit codes, standard output and standard error.

Usage: test_command_line.py LAMPYRIS [unittest arguments]
"""
import functools
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import png_pixels
import program
from exr_file import exr

LAMPYRIS = sys.argv.pop(1)


def run(*arguments, **options):
    return program.run(LAMPYRIS, *arguments, timeout=60, **options)


def wait_for_rendering(lines):
    """On a slow machine, the progress reports compiling first."""
    for line in lines:
        if 'Rendering' in line:
            return
    raise AssertionError('it ended without rendering')


COMMANDS = ('render', 'merge', 'submit', 'converge', 'bench', 'compare', 'check', 'info', 'view', 'devices',
            'help')
FOR_TESTS = {'fail-allocation', 'lose-device', 'lose-devices'}


def options_in(text, pattern=r'^  (?:-\w, )?--([\w-]+)'):
    return set(re.findall(pattern, text, re.MULTILINE))


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


class Help(unittest.TestCase):
    def test_help_goes_to_stdout(self):
        for arguments in (['help'], ['--help'], ['-h']):
            result = run(*arguments)
            self.assertEqual((result.returncode, result.stderr), (0, ''), arguments)
            for command in ('render', 'compare', 'info', 'devices', 'help'):
                self.assertIn('\n  ' + command + ' ', result.stdout)

    def test_help_of_each_command(self):
        for command in COMMANDS:
            result = run('help', command)
            self.assertEqual((result.returncode, result.stderr), (0, ''))
            self.assertIn('lampyris ' + command + ' [OPTIONS]', result.stdout)
            self.assertEqual(run(command, '--help-all').stdout, result.stdout)
            self.assertLessEqual(max(map(len, result.stdout.split('\n'))), 80)

    def test_help_of_each_command_fits_a_screen(self):
        for command in COMMANDS:
            result = run(command, '--help')
            self.assertEqual((result.returncode, result.stderr), (0, ''))
            lines = result.stdout.splitlines()
            self.assertLessEqual(len(lines), 40, command)
            self.assertLessEqual(max(map(len, lines)), 80, command)
            listed = options_in(result.stdout)
            self.assertLessEqual(len(listed), 15, command)
            self.assertLess(listed, options_in(run(command, '--help-all').stdout), command)
        self.assertEqual(len(options_in(run('render', '--help').stdout)), 15)
        self.assertLessEqual(len(run('--help').stdout.splitlines()), 40)

    def test_options_for_tests_are_in_the_manual_alone(self):
        manual = options_in(run('help', '--man').stdout.replace(r'\-', '-'), r'^\\fB(?:-\w, )?--([\w-]+)')
        everything = options_in(run('--help-all').stdout)
        self.assertEqual(manual - everything, FOR_TESTS)
        self.assertEqual(everything - manual, set())
        for command in COMMANDS:
            listed = options_in(run(command, '--help-all').stdout)
            self.assertLess(listed, everything)
            self.assertIn('version', listed)
        page = read(os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'tests/README.md'))
        for name in FOR_TESTS:
            self.assertIn(f'`--{name} N`', page)

    def test_options_stand_in_the_help_of_their_commands_only(self):
        self.assertIn('--spp N', run('render', '--help').stdout)
        self.assertIn('--spp N', run('help', 'render').stdout)
        self.assertNotIn('--spp', run('help', 'compare').stdout)

    def test_version(self):
        result = run('--version')
        self.assertEqual((result.returncode, result.stderr), (0, ''))
        self.assertRegex(result.stdout, r'^lampyris \d+\.\d+\.\d+\n$')

    def test_help_of_an_unknown_command(self):
        result = run('help', 'rendre')
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertIn('did you mean "render"?', result.stderr)

    @unittest.skipUnless(shutil.which('groff'), 'groff is not installed')
    def test_manual_pages_are_clean_roff(self):
        for command in ([], ['render'], ['merge'], ['submit'], ['compare'], ['info'], ['devices'], ['help']):
            page = run('help', '--man', *command).stdout
            result = subprocess.run(['groff', '-man', '-Tutf8', '-ww', '-P-c'], input=page,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.assertEqual((result.returncode, result.stderr), (0, ''), command)
            plain = re.sub('.\b', '', result.stdout)  # bold characters are overstruck
            self.assertIn('EXIT STATUS', plain)
            self.assertIn('--json', plain)


class Failures(unittest.TestCase):
    def test_usage_errors(self):
        for arguments in ([], ['rendr'], ['compare'], ['compare', 'a'], ['compare', *'abcdefghijklmnopq'],
                          ['devices', 'x'], ['devices', '--spp', '1'], ['--bogus'], ['-x'],
                          ['compare', 'a', 'b', '--max'], ['compare', 'a', 'b', '--max', 'mse'],
                          ['render'], ['render', 's.json', '--spp', '0'],
                          ['render', 's.json', '-o', 'a.tga'], ['info']):
            result = run(*arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ''), arguments)
            self.assertRegex(result.stderr, r'^lampyris: error: .+\nTry "lampyris.* --help"\.\n$')

    def test_the_hint_names_the_command(self):
        self.assertIn('Try "lampyris compare --help".', run('compare').stderr)

    def test_control_characters_do_not_reach_the_terminal(self):
        self.assertNotIn('\x1b', run('\x1b[31m').stderr)

    def test_missing_files(self):
        result = run('compare', 'nowhere-1.exr', 'nowhere-2.exr')
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertRegex(result.stderr, r'nowhere-[12]\.exr: No such file')

    @unittest.skipUnless(os.path.exists('/dev/full'), 'there is no /dev/full')
    def test_a_full_standard_output(self):
        with open('/dev/full', 'w') as full:
            result = subprocess.run([LAMPYRIS, 'help'], stdout=full, stderr=subprocess.PIPE,
                                    text=True)
        self.assertEqual(result.returncode, 4)
        self.assertIn('standard output: cannot write', result.stderr)

    def test_a_reader_that_has_gone(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        result = subprocess.run([LAMPYRIS, 'help'], stdout=write_end, stderr=subprocess.PIPE,
                                text=True)
        os.close(write_end)
        self.assertEqual((result.returncode, result.stderr), (4, ''))


# Drivers leak memory in libraries that are unloaded before the leak checker can find their names.
GPU_ENVIRONMENT = {**os.environ, 'ASAN_OPTIONS': 'detect_leaks=0'}


def run_gpu(*arguments):
    return run(*arguments, env=GPU_ENVIRONMENT)


def need_device(test):
    if run_gpu('devices').returncode == 69:
        if os.environ.get('LAMPYRIS_NO_SKIP'):
            test.fail('there is no Vulkan device')
        test.skipTest('there is no Vulkan device')


class Devices(unittest.TestCase):
    def setUp(self):
        need_device(self)

    def test_one_device_is_marked(self):
        result = run_gpu('devices', '--json')
        self.assertEqual(result.returncode, 0, result.stderr)
        devices = json.loads(result.stdout)['devices']
        usable = [d for d in devices if d['unusable'] is None]
        self.assertEqual(sum(d['chosen'] for d in devices), 1 if usable else 0)
        text = run_gpu('devices').stdout
        for device in devices:
            self.assertIn(device['name'], text)
            self.assertEqual(device['cpu'], device['kind'] == 'CPU')

    def test_an_unknown_device(self):
        result = run_gpu('devices', '--device', 'no such device')
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertIn('no such device', result.stderr)


class NoVulkan(unittest.TestCase):
    def test_no_driver(self):
        nothing = {**os.environ, 'VK_ICD_FILENAMES': '/nonexistent.json',
                   'VK_DRIVER_FILES': '/nonexistent.json'}
        result = run('devices', env=nothing)
        self.assertEqual((result.returncode, result.stdout), (69, ''))
        self.assertRegex(result.stderr, r'^lampyris: error: .+\n$')


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        # Half of the pixels of `a` exceed those of `b` by 0.5 in red, so mse = 0.25 / 2 / 3.
        exr(self.path('a.exr'), 8, 4, lambda x, y: (1.5 if x < 4 else 1.0, 1.0, 1.0))
        exr(self.path('b.exr'), 8, 4, lambda x, y: (1.0, 1.0, 1.0))
        exr(self.path('nan.exr'), 8, 4,
            lambda x, y: (math.nan if (x, y) == (2, 3) else 1.0, 1.0, 1.0))
        exr(self.path('small.exr'), 4, 4, lambda x, y: (1.0, 1.0, 1.0))

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def compare(self, first, second, *arguments):
        return run('compare', self.path(first), self.path(second), *arguments)

    def test_known_metrics(self):
        result = self.compare('a.exr', 'b.exr', '--json')
        self.assertEqual((result.returncode, result.stderr), (0, ''))
        values = json.loads(result.stdout)
        mse = 0.25 / 2 / 3
        self.assertAlmostEqual(values['mse'], mse, places=7)
        self.assertAlmostEqual(values['rmse'], math.sqrt(mse), places=7)
        self.assertAlmostEqual(values['relmse'], mse / 1.01, places=7)
        self.assertAlmostEqual(values['local_relmse'], mse / 1.01, places=7)  # `b` is constant
        self.assertIsNone(values['psnr'])  # infinite, because the display values are equal
        self.assertFalse(values['equal'])
        low, high = values['mse_interval']
        self.assertTrue(0 <= low < mse < high)
        low, high = values['local_relmse_interval']
        self.assertTrue(0 <= low < mse / 1.01 < high)
        self.assertEqual((values['exposure'], values['relmse_epsilon']), (0, 0.01))
        self.assertIsNone(values['reference_noise'])
        self.assertEqual(len(values['images']), 1)
        for key, value in values['images'][0].items():
            self.assertEqual(values[key], value, key)
        self.assertEqual(values['max'], 0.5)
        self.assertAlmostEqual(values['smape'], 2 * 0.5 / 2.5 / 2 / 3, places=6)
        # Display values are clamped to 1, so only lower exposures show a difference.
        self.assertEqual((values['ssim'], values['flip']), (1, 0))
        self.assertTrue(0 < values['hdr_flip'] < 1)
        self.assertEqual(values['hdr_flip_exposures'][2], 2)
        self.assertEqual((values['differing'], values['nonfinite']), (16, 0))
        self.assertEqual((values['width'], values['height']), (8, 4))
        self.assertTrue(values['passed'])

    def test_text(self):
        result = self.compare('a.exr', 'b.exr')
        self.assertRegex(result.stdout, r'\n  mse           0\.0416667  \[.*\]\n')
        self.assertRegex(result.stdout, r'\n  local-relmse  0\.0412541  \[.*\]\n')
        self.assertRegex(result.stdout, r'\n  hdr-flip      0\.\d+  2 exposures of ')
        self.assertIn('8 x 4 pixels', result.stdout)
        self.assertEqual(self.compare('a.exr', 'b.exr', '--quiet').stdout, '')

    def test_limits_set_the_exit_code(self):
        for limit, code in (('mse=0.0417', 0), ('mse=0.0416', 1), ('rmse=0.2', 1), ('max=0.5', 0),
                            ('max=0.49', 1), ('relmse=0.0413', 0), ('local-relmse=0.0413', 0),
                            ('local-relmse=0.0412', 1), ('differing=16', 0),
                            ('differing=15', 1), ('nonfinite=0', 0)):
            result = self.compare('a.exr', 'b.exr', '--max', limit)
            self.assertEqual(result.returncode, code, limit)
            self.assertEqual('expected at most' in result.stderr, code == 1, limit)
        # With an exposure of -4 stops, `a` and `b` are 1.5/16 and 1/16 in red, before the sRGB encoding.
        dark = ('--exposure', '-4')
        self.assertEqual(self.compare('a.exr', 'b.exr', '--min', 'psnr=1000').returncode, 0)
        a, b = (1.055 * (v / 16) ** (1 / 2.4) - 0.055 for v in (1.5, 1))
        psnr = -10 * math.log10((a - b) ** 2 / 6)
        for limit, code in ((psnr - 1e-4, 0), (psnr + 1e-4, 1)):
            result = self.compare('a.exr', 'b.exr', '--min', f'psnr={limit}', *dark)
            self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(self.compare('a.exr', 'b.exr', '--max', 'flip=0', *dark).returncode, 1)
        self.assertEqual(self.compare('a.exr', 'b.exr', '--min', 'ssim=0.999').returncode, 0)
        self.assertEqual(self.compare('a.exr', 'b.exr', '--max', 'hdr-flip=0').returncode, 1)

    def test_all_limits_count(self):
        result = self.compare('a.exr', 'b.exr', '--max', 'mse=1', '--max', 'max=0.1', '--max',
                              'relmse=1', '--json')
        self.assertEqual(result.returncode, 1)
        values = json.loads(result.stdout)
        self.assertEqual([c['passed'] for c in values['checks']], [True, False, True])
        self.assertFalse(values['passed'])

    def test_equal_pictures(self):
        result = self.compare('b.exr', 'b.exr', '--json', '--max', 'mse=0', '--min', 'psnr=1000')
        self.assertEqual(result.returncode, 0, result.stderr)
        values = json.loads(result.stdout)
        self.assertIsNone(values['psnr'])  # infinite
        self.assertTrue(values['equal'])
        self.assertIn('b.exr is equal to the reference, bit for bit',
                      self.compare('b.exr', 'b.exr').stdout)

    def test_pixels_that_are_not_finite_fail_checks(self):
        self.assertEqual(self.compare('nan.exr', 'b.exr').returncode, 0)
        result = self.compare('nan.exr', 'b.exr', '--max', 'mse=0')
        self.assertEqual(result.returncode, 1)
        self.assertIn('1 pixels are not finite', result.stderr)
        result = self.compare('nan.exr', 'b.exr', '--max', 'mse=0', '--max', 'nonfinite=1')
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_different_sizes(self):
        result = self.compare('a.exr', 'small.exr')
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertIn('8 x 4', result.stderr)
        self.assertIn('4 x 4', result.stderr)

    def test_difference_pictures(self):
        numbers = {'relative': 0.5 / 1.01, 'squared': 0.25 / 1.01, 'smape': 1 / 2.500001}
        for name, value in numbers.items():
            exr(self.path('expected.exr'), 8, 4, lambda x, y: (value if x < 4 else 0.0, 0.0, 0.0))
            path = self.path(name + '.exr')
            result = self.compare('a.exr', 'b.exr', '--difference', path, '--map', name)
            self.assertEqual(result.returncode, 0, result.stderr)
            result = self.compare(f'{name}.exr:{name}', 'expected.exr', '--max', 'max=1e-7')
            self.assertEqual(result.returncode, 0, result.stdout)
        # The map of FLIP has one number per pixel, whose mean is the metric. All display values are equal.
        for name, mean in (('flip', 0), ('hdr-flip', None)):
            path = self.path(name + '.exr')
            result = self.compare('a.exr', 'b.exr', '--difference', path, '--map', name, '--json')
            self.assertEqual(result.returncode, 0, result.stderr)
            told = json.loads(result.stdout)
            self.assertEqual(told['difference'], path)
            exr(self.path('black.exr'), 8, 4, lambda x, y: (0.0, 0.0, 0.0))
            result = self.compare(f'{name}.exr:{name}', 'black.exr', '--json')
            found = json.loads(result.stdout)
            mean = told[name.replace('-', '_')] if mean is None else mean
            # The root mean square of a map with one number per pixel is not below its mean.
            self.assertGreaterEqual(found['rmse'], mean)
            self.assertLessEqual(found['max'], 1)
            self.assertEqual(found['max'] > 0, mean > 0)

    def test_difference_pictures_in_false_colours(self):
        # Pixels that are not finite are green, equal ones are black, and the scale is below.
        exr(self.path('mixed.exr'), 8, 4, lambda x, y: (math.nan if x == 2 else 1.5, 1.0, 1.0))
        result = self.compare('mixed.exr', 'b.exr', '--difference', self.path('d.png'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('d.png: |x - r| / (|r| + 0.01)', result.stdout)
        picture = png_pixels.read(self.path('d.png'))
        width, height = picture[:2]
        pixel = functools.partial(png_pixels.pixel, picture)
        self.assertEqual((width, height > 4), (160, True))
        self.assertEqual(pixel(2, 1), (0, 255, 0))
        self.assertEqual(pixel(1, 1), pixel(7, 3))
        self.assertGreater(pixel(1, 1)[0], pixel(1, 1)[2])
        self.assertEqual(pixel(8, 0), (51, 51, 51))
        self.assertEqual([pixel(x, 4 + 6) for x in (10, 149)], [(0, 0, 0), (250, 248, 209)])
        result = self.compare('b.exr', 'b.exr', '--difference', self.path('e.png'))
        self.assertEqual(png_pixels.pixel(png_pixels.read(self.path('e.png')), 3, 3), (0, 0, 0))

    def test_several_pictures(self):
        result = run('compare', *map(self.path, ('a.exr', 'b.exr', 'nan.exr', 'b.exr')),
                     '--difference', self.path('m.exr'))
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.split('\n')
        self.assertIn('mse', lines[1])
        rows = {line.split()[0]: line.split()[1:] for line in lines[2:5]}
        a, b = rows[self.path('a.exr')], rows[self.path('b.exr')]
        self.assertEqual((a[0], b[0]), ('0.04167', '0*'))
        self.assertEqual((a[5], b[5]), ('inf*', 'inf*'))  # for psnr the greatest value is the best
        self.assertEqual(a[-1], '16')
        # Without the pixel that is not finite, the picture would be as good as `b`.
        self.assertEqual(rows[self.path('nan.exr')], ['0', '0', '0', '0', '0', 'inf', '1', '0',
                                                      '0', '0', '1', '1'])
        self.assertEqual(len(set(map(len, lines[1:5]))), 1, 'columns stand below each other')
        self.assertIn('b.exr is equal to the reference', result.stdout)
        self.assertEqual(sorted(f for f in os.listdir(self.folder.name) if f.startswith('m')),
                         ['m.0001.exr', 'm.0002.exr', 'm.0003.exr'])

    def test_exposures(self):
        a = json.loads(self.compare('a.exr', 'b.exr', '--exposures', '-3,1.5', '--json').stdout)
        self.assertEqual(a['hdr_flip_exposures'], [-3, 1.5, 5])
        # If all pixels are white at every exposure, there is no difference.
        b = json.loads(self.compare('a.exr', 'b.exr', '--exposures', '9,9', '--json').stdout)
        self.assertEqual((b['hdr_flip_exposures'], b['hdr_flip']), ([9, 9, 2], 0))
        self.assertGreater(a['hdr_flip'], 0)
        for text in ('', '1', '1,', ',1', '2,1', '1,2,3', 'a,b', 'nan,1', '0,inf', '-1000,0'):
            result = self.compare('a.exr', 'b.exr', '--exposures=' + text)
            self.assertEqual((result.returncode, result.stdout), (2, ''), text)
            self.assertIn('--exposures', result.stderr)

    def test_stopped(self):
        # A bright pixel causes twenty exposures, which take seconds on any machine.
        exr(self.path('large.exr'), 512, 512, lambda x, y: (1.0, 1.0, 1e7 if x == y == 9 else 1.0))
        arguments = [self.path('large.exr')] * 16 + ['--difference', self.path('m.png')]
        process = subprocess.Popen([LAMPYRIS, 'compare', *arguments], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.assertIn('Comparing', process.stderr.readline())
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        self.assertEqual((process.returncode, out), (130, ''), err)
        self.assertIn('stopped', err)
        # Pictures that were finished before the signal are complete.
        for name in os.listdir(self.folder.name):
            if name.startswith('m.'):
                self.assertEqual(png_pixels.read(self.path(name))[0], 512)

    def test_limits_hold_for_each_picture(self):
        result = run('compare', *map(self.path, ('b.exr', 'a.exr', 'b.exr')), '--max', 'mse=0.01',
                     '--json')
        self.assertEqual(result.returncode, 1)
        self.assertIn('a.exr: mse is 0.0416667; expected at most 0.01', result.stderr)
        values = json.loads(result.stdout)
        self.assertEqual([i['passed'] for i in values['images']], [True, False])
        self.assertEqual([i['image'] for i in values['images']],
                         [self.path('b.exr'), self.path('a.exr')])
        self.assertFalse(values['passed'])
        self.assertNotIn('mse', values)

    def test_the_noise_of_the_reference(self):
        mse = 0.25 / 6
        values = json.loads(self.compare('a.exr', 'b.exr', '--reference-variance', '0.01',
                                         '--json').stdout)
        self.assertAlmostEqual(values['mse'], mse - 0.01, places=7)
        self.assertAlmostEqual(values['rmse'], math.sqrt(mse - 0.01), places=7)
        self.assertAlmostEqual(values['relmse'], (mse - 0.01) / 1.01, places=7)
        self.assertAlmostEqual(values['local_relmse'], (mse - 0.01) / 1.01, places=7)
        self.assertAlmostEqual(values['measured']['local_relmse'], mse / 1.01, places=7)
        self.assertAlmostEqual(values['reference_noise']['local_relmse'], 0.01 / 1.01, places=7)
        self.assertAlmostEqual(values['measured']['mse'], mse, places=7)
        self.assertAlmostEqual(values['reference_noise']['mse'], 0.01, places=7)
        # A variance that exceeds the measured error gives a negative result, which is reported.
        exr(self.path('v.exr'), 8, 4, lambda x, y: (0.3 if y < 2 else 0.0, 0.0, 0.0))
        result = self.compare('a.exr', 'b.exr', '--reference-variance', self.path('v.exr'),
                              '--max', 'rmse=0')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"mse +-0\.00833.* of 0\.0416667 measured: below the "
                                        r"reference's noise")
        for value, message in (('-1', 'expected a number >= 0'), ('nan', 'expected a number >= 0'),
                               (self.path('nan.exr'), 'pixel 2,3: the variance is nan'),
                               (self.path('small.exr'), '4 x 4'),
                               ('auto', 'neither the layers half_a and half_b')):
            result = self.compare('a.exr', 'b.exr', '--reference-variance', value)
            self.assertEqual((result.returncode, result.stdout), (2, ''), value)
            self.assertIn(message, result.stderr)

    def test_layers_that_are_not_there(self):
        result = self.compare('a.exr:depth', 'b.exr')
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertIn('a.exr', result.stderr)
        self.assertIn('depth', result.stderr)
        os.link(self.path('a.exr'), self.path('c:d.exr'))
        self.assertEqual(self.compare('c:d.exr', 'a.exr', '--max', 'differing=0').returncode, 0)

    def test_difference_pictures_that_cannot_be_written(self):
        result = self.compare('a.exr', 'b.exr', '--difference', self.path('nowhere/d.png'))
        self.assertEqual((result.returncode, result.stdout), (4, ''))
        result = self.compare('a.exr', 'b.exr', '--difference', self.path('d.gif'))
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertEqual(sorted(os.listdir(self.folder.name)),
                         ['a.exr', 'b.exr', 'nan.exr', 'small.exr'])


class Render(unittest.TestCase):
    SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), '../../scenes/cornell.json')

    def setUp(self):
        need_device(self)
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def render(self, *arguments):
        return run_gpu('render', self.SCENE, '--size', '16x16', *arguments)

    def test_pictures_are_written_and_told(self):
        result = self.render('--spp', '2', '--json', '-o', self.path('a.exr'), '-o',
                             self.path('a.png'))
        self.assertEqual(result.returncode, 0, result.stderr)
        values = json.loads(result.stdout)
        self.assertEqual((values['width'], values['height'], values['spp']), (16, 16, 2))
        self.assertEqual(sorted(os.listdir(self.folder.name)), ['a.exr', 'a.png'])

    def test_quiet(self):
        result = self.render('--spp', '1', '--quiet', '-o', self.path('a.exr'))
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, '', ''))

    def test_frames_equal_samples(self):
        self.assertEqual(self.render('--spp', '6', '-o', self.path('a.exr')).returncode, 0)
        self.assertEqual(self.render('--frames', '3', '--spp-per-frame', '2', '-o',
                                     self.path('b.exr')).returncode, 0)
        result = run('compare', self.path('a.exr'), self.path('b.exr'), '--max', 'differing=0')
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_layers(self):
        self.assertEqual(self.render('--spp', '2', '-o', self.path('plain.exr')).returncode, 0)
        result = self.render('--frames', '2', '--every', '1', '--aov', 'normal,ids', '--aov', 'alpha',
                             '-o', self.path('a.exr'), '-o', self.path('a.png'))
        self.assertEqual(result.returncode, 0, result.stderr)
        for name in ('a.0001.exr', 'a.0002.exr', 'a.exr'):
            with open(self.path(name), 'rb') as file:
                header = file.read(4096)
            for channel in (b'normal.X', b'id.object', b'alpha.A', b'R'):
                self.assertIn(b'\0' + channel + b'\0', header)
            self.assertIn(b'normal,alpha,id', header)
            self.assertNotIn(b'\0depth.', header)
        same = run('compare', self.path('plain.exr'), self.path('a.exr'), '--max', 'differing=0')
        self.assertEqual(same.returncode, 0, same.stderr)
        result = self.render('--aov', 'depth', '-o', self.path('b.png'))
        self.assertEqual(result.returncode, 2)
        self.assertIn('layers go into EXR files', result.stderr)

    def test_lenses(self):
        result = self.render('--spp', '1', '--aperture', '20', '-o', self.path('a.exr'))
        self.assertEqual(result.returncode, 2)
        self.assertIn('expected --focus-distance', result.stderr)
        result = self.render('--spp', '1', '--aperture', '20', '--focus-distance', '1', '-o',
                             self.path('a.exr'))
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_split_lobes(self):
        result = self.render('--spp', '1', '--split-lobes', '1', '--directions', 'cosine', '-o',
                             self.path('a.exr'))
        self.assertEqual(result.returncode, 2)
        self.assertIn('expected --directions bsdf, or --split-lobes 0', result.stderr)
        result = self.render('--split-lobes', '5', '-o', self.path('a.exr'))
        self.assertEqual(result.returncode, 2)

    def test_outputs_that_cannot_be_written(self):
        # This number of samples would take hours, so the failure must come before rendering.
        result = self.render('--spp', '1G', '-o', self.path('nowhere/a.exr'))
        self.assertEqual((result.returncode, result.stdout), (4, ''))
        self.assertIn('nowhere/a.exr', result.stderr)

    @unittest.skipUnless(os.path.exists('/dev/full'), 'there is no /dev/full')
    def test_a_full_disk(self):
        os.symlink('/dev/full', self.path('full.exr'))
        result = self.render('--spp', '1', '-o', self.path('full.exr'))
        self.assertEqual(result.returncode, 4)
        self.assertIn('full.exr: cannot write', result.stderr)

    @unittest.skipUnless(os.path.exists('/dev/full'), 'there is no /dev/full')
    def test_a_full_disk_loses_no_picture(self):
        os.symlink('/dev/full', self.path('full.exr'))
        os.symlink('/dev/full', self.path('full.png'))
        result = self.render('--spp', '1', '-o', self.path('full.exr'), '-o', self.path('a.exr'))
        self.assertEqual(result.returncode, 4)
        self.assertIn('a.exr', os.listdir(self.folder.name))
        # None of the outputs can be written, so the picture is saved in $TMPDIR.
        os.mkdir(self.path('tmp'))
        result = run('render', self.SCENE, '--size', '16x16', '--spp', '1', '-o',
                     self.path('full.exr'), '-o', self.path('full.png'),
                     env={**GPU_ENVIRONMENT, 'TMPDIR': self.path('tmp')})
        self.assertEqual(result.returncode, 4)
        self.assertIn('full.exr: cannot write', result.stderr)
        self.assertIn('full.png: cannot write', result.stderr)
        saved = re.search(r'saved as (\S+)', result.stderr).group(1)
        self.assertTrue(saved.startswith(self.path('tmp')))
        same = run('compare', saved, self.path('a.exr'), '--max', 'differing=0')
        self.assertEqual(same.returncode, 0, same.stderr)

    def test_a_picture_that_cannot_fit(self):
        # The film needs far more bytes than any disk has; without this check, rendering would fail late.
        space = os.statvfs(self.folder.name)
        if space.f_bavail * space.f_frsize > 1 << 44:
            self.skipTest('the disk is large')
        result = run_gpu('render', self.SCENE, '--size', '65536x32768', '--frames', '1k',
                         '--every', '1', '-o', self.path('a.exr'))
        self.assertEqual((result.returncode, result.stdout), (4, ''))
        self.assertRegex(result.stderr, r'a\.exr: needs up to [\d.]+ (?:bytes|[KMGT]iB), but its file system has only [\d.]+ (?:bytes|[KMGT]iB) free')

    def test_frames_say_which_and_how_to_repeat_them(self):
        result = self.render('--frames', '3', '--every', '1', '--accumulate', 'off', '-o',
                             self.path('a.exr'))
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path('a.0002.exr'), 'rb') as file:
            header = file.read(8192)
        self.assertIn(b'lampyris:frame\0string\0\1\0\0\0' + b'2', header)
        self.assertNotIn(b'seconds_render\0string\0\x08\0\0\0' + b'0.000000', header)
        command = re.search(rb'lampyris:repeat\0string\0....lampyris (.*?)lampyris:', header,
                            re.DOTALL).group(1).decode().split()
        command[command.index('-o') + 1] = self.path('again.exr')
        command[command.index('--every'):][:2] = []
        self.assertEqual(run_gpu(*command).returncode, 0)
        result = run('compare', self.path('again.exr'), self.path('a.0002.exr'), '--max',
                     'differing=0')
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_two_runs_and_one_output(self):
        first = subprocess.Popen([LAMPYRIS, 'render', self.SCENE, '--size', '16x16', '--spp', '1G',
                                  '-o', self.path('a.exr')], env=GPU_ENVIRONMENT,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        wait_for_rendering(first.stderr)
        second = self.render('--spp', '1', '-o', self.path('a.exr'))
        self.assertEqual((second.returncode, second.stdout), (4, ''))
        self.assertIn('a.exr: is being written by another run', second.stderr)
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=60)
        self.assertEqual(first.returncode, 143)
        self.assertEqual(self.render('--spp', '1', '-o', self.path('a.exr')).returncode, 0)
        result = self.render('--spp', '1', '-o', self.path('b.exr'), '-o',
                             os.path.join(self.folder.name, '.', 'b.exr'))
        self.assertEqual(result.returncode, 2)
        self.assertEqual(os.listdir(self.folder.name), ['a.exr'])

    def test_a_second_signal_leaves_nothing_behind(self):
        process = subprocess.Popen([LAMPYRIS, 'render', self.SCENE, '--size', '2048x2048', '--spp',
                                    '1G', '-o', self.path('a.exr')], env=GPU_ENVIRONMENT,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        wait_for_rendering(process.stderr)
        # Two different signals, because a second signal of the same kind might be merged with the first.
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertIn(process.returncode, (130, 143))
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_faults_of_the_device(self):
        # The device is lost before there is a copy of the film that could be written.
        for fault, calls in (('--fail-allocation', '135'), ('--lose-device', '123')):
            for nth in calls:
                result = self.render('--spp', '64', '--wave', '1024', '-o', self.path('a.exr'),
                                     fault, nth, '-q')
                self.assertEqual((result.returncode, result.stdout), (3, ''), (fault, nth))
                # A lost device is opened again, and lost again.
                self.assertRegex(result.stderr, r'^(lampyris: warning: .+: opening the device '
                                 r'again and .+\n)*lampyris: error: .+\n$')
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_missing_scenes(self):
        result = run_gpu('render', self.path('nowhere.json'), '-o', self.path('a.exr'))
        self.assertEqual((result.returncode, result.stdout), (2, ''))
        self.assertIn('nowhere.json', result.stderr)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_signals_stop_with_a_picture(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            path = self.path('stopped-%d.exr' % code)
            process = subprocess.Popen([LAMPYRIS, 'render', self.SCENE, '--size', '16x16', '--spp',
                                        '1G', '-o', path], env=GPU_ENVIRONMENT,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            # The progress, which is shown after a second, proves that rendering has begun.
            wait_for_rendering(process.stderr)
            process.send_signal(number)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, code)
            self.assertTrue(os.path.exists(path))

    def test_a_signal_before_the_first_sample(self):
        with open(self.path('big.json'), 'w') as file:
            json.dump({'lampyris': 1, 'shapes': [{'type': 'generated', 'triangles': 2500000,
                                                  'material': 'grey'}],
                       'materials': {'grey': {}}}, file)
        process = subprocess.Popen([LAMPYRIS, 'render', self.path('big.json'), '-o',
                                    self.path('big.exr')], env=GPU_ENVIRONMENT,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not (line := process.stderr.readline()).startswith('Building BVH'):
            if not line:
                self.skipTest('the BVH was built within a second')
        process.send_signal(signal.SIGTERM)
        _, messages = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 143, messages)
        # On a fast machine the BVH was finished when the signal came, so there is a picture.
        left = ['big.json'] if 'stopped' in messages else ['big.exr', 'big.json']
        self.assertEqual(sorted(os.listdir(self.folder.name)), left)


if __name__ == '__main__':
    unittest.main()
