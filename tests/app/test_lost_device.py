#!/usr/bin/env python3
"""Tests a device that is lost during a render, or has too little memory: rendering continues, or the last
copy of the picture is written.

Usage: test_lost_device.py LAMPYRIS SCENE_FOLDER [unittest arguments]
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

from program import by_the_clock, limits, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
CORNELL = os.path.join(os.path.abspath(sys.argv.pop(1)), 'cornell.json')
SMALL = ['--size', '48x40', '--wave', '2k']


class LostDevice(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def render(self, name, *arguments, taken=None):
        env = dict(os.environ, LAMPYRIS_LIMITS=limits(taken)) if taken else None
        return subprocess.run([LAMPYRIS, 'render', CORNELL, *SMALL, '-q', '--json', '-o',
                               self.path(name), *arguments], stdout=subprocess.PIPE, env=env,
                              stderr=subprocess.PIPE, text=True, timeout=100, check=False)

    def lose(self, *arguments):
        """Tries submissions until a permanent loss of the device finds a copy of the film. Returns the
        report."""
        for submission in (1200, 4800, 19200):
            result = self.render('lost.exr', '--reopen', '0', '--lose-device', str(submission),
                                 *arguments)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertIn('device lost', result.stderr)
            if result.stdout:
                return json.loads(result.stdout), result.stderr
            self.assertFalse(os.path.exists(self.path('lost.exr')))
        self.fail('never copied')

    def same_pictures(self):
        result = subprocess.run([LAMPYRIS, 'compare', self.path('lost.exr'), self.path('whole.exr'),
                                 '--max', 'differing=0'], stdout=subprocess.PIPE, check=False)
        return result.returncode == 0

    def check(self, *arguments):
        """Returns the report, the messages and the header of the picture."""
        report, messages = self.lose('--spp', '1M', *arguments)
        self.assertEqual((report['ended_by'], report['outputs']),
                         ('device', [self.path('lost.exr')]))
        self.assertEqual(report['pixels_without_samples'], 0)
        with open(self.path('lost.exr'), 'rb') as file:
            header = file.read(20000)
        self.assertIn(b'lampyris:ended_by\0string\0\x06\0\0\0device', header)
        return report, messages, header

    def test_the_copy_is_a_shorter_render(self):
        report, messages, header = self.check('--aov', 'albedo')
        self.assertIn('the picture has %d samples per pixel' % report['spp'], messages)
        self.assertIn(b'--spp %dlampyris:' % report['spp'], header)  # the end of the attribute
                                                                     # lampyris:repeat
        whole = json.loads(self.render('whole.exr', '--spp', str(report['spp']), '--aov',
                                       'albedo').stdout)
        self.assertEqual((report['spp'], report['spp_most'], report['image_hash'], report['rays']),
                         (whole['spp'], whole['spp_most'], whole['image_hash'], whole['rays']))
        self.assertTrue(self.same_pictures())

    def test_tiles(self):
        report, _, header = self.check('--adaptive', 'on')
        self.assertTrue(0 < report['spp'] <= report['spp_most'])
        self.assertNotIn(b'lampyris:repeat', header)

    @by_the_clock
    def test_what_copying_costs(self):
        # The time includes reading the film at the end and estimating its error.
        result = json.loads(self.render('whole.exr', '--time', '2').stdout)
        self.assertLess(result['seconds']['judge'], 0.02 * result['seconds']['render'] + 0.1)

    def rescued(self, *arguments):
        """Options in `arguments` override the default ones."""
        result = self.render('lost.exr', '--reopen', '0', *arguments)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertTrue(os.path.exists(self.path('lost.exr')), result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report['ended_by'], report['pixels_without_samples']), ('device', 0))
        return report, result.stderr

    @by_the_clock
    def test_in_the_middle_of_a_pass(self):
        # A pass takes 16 samples per pixel in many waves. The first copy does not wait for its end, unless
        # another program delays it.
        report, messages = self.rescued('--size', '128x128', '--wave', '512', '--spp', '17',
                                        '--lose-device', '400')
        self.assertEqual((report['spp'], report['spp_most']), (1, 17))
        self.assertIn('no --spp renders it again', messages)
        with open(self.path('lost.exr'), 'rb') as file:
            self.assertNotIn(b'lampyris:repeat', file.read(20000))

    def test_frames(self):
        small = ['--size', '64x64', '--wave', '16k']
        report, _ = self.rescued(*small, '--lose-device', '14', '--frames', '200', '--accumulate',
                                 'off')
        self.assertEqual(report['spp'], 1)
        # The rescued film was read for a numbered picture or copied later. On a busy machine each frame is
        # copied, which is a submission, too.
        report, _ = self.rescued(*small, '--lose-device', '30', '--frames', '100', '--every', '10')
        self.assertGreaterEqual(report['spp'], 10)
        self.assertTrue(os.path.exists(self.path('lost.0010.exr')))

    def goes_on(self, losses, submission, *arguments):
        """If the device is lost again and again after this many submissions, the picture is the same."""
        whole = json.loads(self.render('whole.exr', *arguments).stdout)
        result = self.render('lost.exr', *arguments, '--lose-device', str(submission),
                             '--lose-devices', str(losses))
        self.assertEqual(result.returncode, 0, result.stderr)
        lost = json.loads(result.stdout)
        self.assertEqual(result.stderr.count('opening the device again'), losses, result.stderr)
        for key in 'spp', 'spp_most', 'image_hash', 'rays', 'ended_by':
            self.assertEqual(lost[key], whole[key])
        self.assertTrue(self.same_pictures())

    def test_goes_on(self):
        # The first losses happen while the renderer is created, and before the first sample.
        for losses, submission in (1, 1), (1, 2), (2, 30), (1, 60):
            self.goes_on(losses, submission, '--spp', '64', '--aov', 'albedo')

    def test_lost_too_often(self):
        result = self.render('lost.exr', '--spp', '1M', '--lose-device', '300')
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertEqual(result.stderr.count('opening the device again'), 2)
        self.assertEqual(json.loads(result.stdout)['ended_by'], 'device')
        whole = json.loads(self.render('whole.exr', '--spp', str(json.loads(result.stdout)['spp']))
                           .stdout)
        self.assertEqual(json.loads(result.stdout)['image_hash'], whole['image_hash'])

    def test_tiles_and_frames_go_on(self):
        self.goes_on(1, 40, '--spp', '64', '--adaptive', 'on')
        self.goes_on(1, 15, '--frames', '20', '--accumulate', 'off')
        self.goes_on(1, 15, '--frames', '20', '--accumulate', 'on')

    def test_a_resumed_render_goes_on(self):
        whole = json.loads(self.render('whole.exr', '--spp', '96').stdout)
        begun = self.render('begun.exr', '--spp', '40', '--checkpoint', self.path('a.ck'))
        self.assertEqual(begun.returncode, 0, begun.stderr)
        lost = self.render('lost.exr', '--spp', '96', '--checkpoint', self.path('a.ck'),
                           '--resume', '--lose-device', '30', '--lose-devices', '1')
        self.assertEqual(lost.returncode, 0, lost.stderr)
        self.assertIn('opening the device again', lost.stderr)
        self.assertEqual(json.loads(lost.stdout)['image_hash'], whole['image_hash'])

    def test_memory_that_is_too_small(self):
        arguments = ['--spp', '16', '--wave', '16k']
        whole = json.loads(self.render('whole.exr', *arguments).stdout)
        needed = whole['memory']['device_bytes']
        # The device has less memory than the render needs, or reports a smaller budget.
        for taken in ('memory=%d' % (needed // 3), 'memory-budget=%d' % (needed // 3),
                      'memory=%d' % (needed // 8)):
            result = self.render('lost.exr', *arguments, taken=taken)
            self.assertEqual(result.returncode, 0, result.stderr)
            small = json.loads(result.stdout)
            self.assertLess(small['wave'], whole['wave'])
            self.assertEqual(small['image_hash'], whole['image_hash'])
            self.assertIn('%d paths in place of %d' % (small['wave'], whole['wave']), result.stderr)
            self.assertEqual(result.stderr.count('\n'), 1)
        for taken in 'memory=100000', 'memory-budget=100000':
            result = self.render('none.exr', *arguments, taken=taken)
            self.assertEqual((result.returncode, result.stdout), (3, ''), result.stderr)
            self.assertFalse(os.path.exists(self.path('none.exr')))

    def test_before_the_first_copy(self):
        result = self.render('lost.exr', '--spp', '64', '--reopen', '0', '--lose-device', '3')
        self.assertEqual((result.returncode, result.stdout), (3, ''))
        self.assertEqual(os.listdir(self.folder.name), [])


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
