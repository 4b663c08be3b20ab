#!/usr/bin/env python3
"""Kills renders, resumes them from their checkpoints, and compares the pictures bit by bit with those of
uninterrupted renders.

Usage: test_checkpoint.py LAMPYRIS SCENE_FOLDER [--kills N] [unittest arguments]; without --kills,
20 and one of the two signals
"""
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SCENES = os.path.abspath(sys.argv.pop(1))
KILLS = 20
SIGNALS = 1 if '--kills' not in sys.argv else 2
if '--kills' in sys.argv:
    at = sys.argv.index('--kills')
    KILLS = int(sys.argv[at + 1])
    del sys.argv[at:at + 2]
CORNELL = os.path.join(SCENES, 'cornell.json')


class Checkpoints(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def command(self, *arguments, size='20x18'):
        return [LAMPYRIS, 'render', CORNELL, '--size', size, '--sampler', 'pcg', '--json', '-q',
                '-o', self.path('out.exr'), *arguments]

    def run_one(self, *arguments, **options):
        return subprocess.run(self.command(*arguments, **options), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=300)

    def render(self, *arguments, code=0, **options):
        result = self.run_one(*arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        return json.loads(result.stdout)

    def reject(self, message, *arguments, **options):
        result = self.run_one('--resume', '--checkpoint', self.path('c'), *arguments, **options)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(message, result.stderr)
        self.assertEqual(result.stderr.count('\n'), 1)

    def checkpoint(self):
        return ['--checkpoint', self.path('c'), '--checkpoint-every', '0']

    def kill_after(self, seconds, *arguments, number=signal.SIGKILL, **options):
        """Returns whether the process was killed rather than ended by itself."""
        process = subprocess.Popen(self.command(*arguments, **options), stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        try:
            process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            process.communicate()
        return process.returncode

    def kill_and_go_on(self, generator, seconds, *arguments, waves=(64, 256, 1024)):
        """Kills and resumes a render at random times until it ends by itself. Returns its report."""
        kills = 0
        while True:
            wave = ['--wave', str(generator.choice(waves))]
            go_on = ['--resume'] if os.path.exists(self.path('c')) else []
            code = self.kill_after(generator.uniform(0.1, seconds), *arguments, *wave, *go_on,
                                   *self.checkpoint())
            self.assertIn(code, (0, -signal.SIGKILL))
            kills += code != 0
            if code == 0 or kills == 4:
                break
        go_on = ['--resume'] if os.path.exists(self.path('c')) else []
        report = self.render(*arguments, *go_on, *self.checkpoint())
        os.unlink(self.path('c'))
        return report, kills

    def check_kills(self, kills, *arguments):
        start = time.monotonic()
        whole = self.render(*arguments, '--wave', '256')
        seconds = time.monotonic() - start
        generator = random.Random(len(arguments))
        done = 0
        while done < kills:
            report, count = self.kill_and_go_on(generator, 1.2 * seconds, *arguments)
            self.assertEqual(report['image_hash'], whole['image_hash'])
            self.assertEqual((report['spp'], report['spp_most'], report['rays']),
                             (whole['spp'], whole['spp_most'], whole['rays']))
            done += max(count, 1)

    def test_killed_runs_go_on(self):
        self.check_kills(KILLS // 2, '--spp', '200')

    def test_killed_adaptive_runs_go_on(self):
        self.check_kills(KILLS // 2, '--spp', '128', '--adaptive', 'on')

    def test_frames_go_on(self):
        for accumulate in ('on', 'off'):
            arguments = ['--frames', '12', '--spp-per-frame', '20', '--accumulate', accumulate]
            whole = self.render(*arguments)
            self.render(*arguments[:1], '5', *arguments[2:], *self.checkpoint())
            report = self.render(*arguments, '--resume', *self.checkpoint(), '--wave', '128')
            self.assertEqual(report['image_hash'], whole['image_hash'], accumulate)
            os.unlink(self.path('c'))

    def test_killed_frames_go_on_with_their_pictures(self):
        arguments = ['--frames', '12', '--spp-per-frame', '40', '--every', '3', '--accumulate',
                     'off']
        self.render(*arguments)
        names = ['out.%04d.exr' % n for n in (3, 6, 9, 12)]
        for name in names:
            os.rename(self.path(name), self.path('whole.' + name))
        self.kill_and_go_on(random.Random(5), 0.6, *arguments)
        for name in names:
            result = subprocess.run([LAMPYRIS, 'compare', self.path(name),
                                     self.path('whole.' + name), '--max', 'differing=0'],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertEqual(result.returncode, 0, name)

    def test_signals_keep_picture_and_checkpoint(self):
        whole = self.render('--spp', '640', size='40x36')
        for number in (signal.SIGINT, signal.SIGTERM)[:SIGNALS]:
            for attempt in range(8):
                code = self.kill_after(0.4 + 0.2 * attempt, '--spp', '640', '--checkpoint',
                                       self.path('c'), number=number, size='40x36')
                if code == 128 + number and os.path.exists(self.path('c')):
                    break
                if os.path.exists(self.path('c')):
                    os.unlink(self.path('c'))
            else:
                self.fail('never stopped while rendering')
            self.assertTrue(os.path.exists(self.path('out.exr')))
            report = self.render('--spp', '640', '--resume', *self.checkpoint(), size='40x36')
            self.assertEqual(report['image_hash'], whole['image_hash'])
            self.assertEqual(report['ended_by'], 'spp')
            os.unlink(self.path('c'))

    def test_longer_runs_go_on(self):
        whole = self.render('--spp', '96')
        self.assertEqual(self.render('--spp', '33', *self.checkpoint())['checkpoint'],
                         self.path('c'))
        report = self.render('--spp', '96', '--resume', *self.checkpoint())
        self.assertEqual(report['image_hash'], whole['image_hash'])
        self.reject('has 96 samples per pixel; expected at most 40', '--spp', '40')

    def test_pictures_besides_go_on(self):
        arguments = ['--aov', 'all', '--adaptive', 'on']
        self.render(*arguments, '--spp', '64')
        os.rename(self.path('out.exr'), self.path('whole.exr'))
        self.render(*arguments, '--spp', '16', *self.checkpoint())
        self.render(*arguments, '--spp', '64', '--resume', *self.checkpoint())
        with open(self.path('out.exr'), 'rb') as one, open(self.path('whole.exr'), 'rb') as other:
            a, b = one.read(), other.read()
        # Compares the files after the header, which has the time and the command line.
        tail = min(len(a), len(b)) // 2
        self.assertEqual(a[-tail:], b[-tail:])

    def test_others_are_rejected(self):
        self.render('--spp', '16', *self.checkpoint())
        self.reject('was made with --seed=0, but this run has 3', '--spp', '32', '--seed', '3')
        self.reject('was made with --size=20x18, but this run has 20x20', size='20x20')
        self.reject('was made with --sampler=pcg, but this run has lcg', '--sampler', 'lcg')
        self.reject('was made with --max-bounces=9, but this run has 2', '--max-bounces', '2')
        self.reject('was made with --env-filter=bilinear, but this run has nearest',
                    '--env-filter', 'nearest')
        self.reject('scene of hash', '-D', 'film.exposure=1')
        self.reject('scene of hash', '--ground', 'on')
        self.reject('--instances', '--instances', 'on')
        self.reject('--aov', '--aov', 'albedo')
        self.reject('--adaptive', '--adaptive', 'on')
        self.reject('--frames', '--frames', '30')
        result = self.run_one('--checkpoint', self.path('c'))
        self.assertEqual(result.returncode, 2)
        self.assertIn('exists already; expected --resume', result.stderr)

    def test_damage_is_rejected(self):
        self.render('--spp', '16', *self.checkpoint())
        with open(self.path('c'), 'rb') as file:
            whole = file.read()
        generator = random.Random(1)
        places = [0, 8, 12, 16, 40, 100, 400, len(whole) - 1] + \
            [generator.randrange(len(whole)) for _ in range(8)]
        for place in places:
            damaged = bytearray(whole)
            damaged[place] ^= 1 << generator.randrange(8)
            with open(self.path('c'), 'wb') as file:
                file.write(damaged)
            self.reject(self.path('c'), '--spp', '32')
        for length in (0, 1, 8, 60, len(whole) // 2, len(whole) - 1):
            with open(self.path('c'), 'wb') as file:
                file.write(whole[:length])
            self.reject(self.path('c'), '--spp', '32')
        with open(self.path('c'), 'wb') as file:
            file.write(whole)
        self.render('--spp', '32', '--resume', *self.checkpoint())

    def test_a_lost_device_leaves_the_last_checkpoint(self):
        for submission in range(20, 400, 20):
            result = self.run_one('--spp', '320', '--wave', '1024', '--reopen', '0', '--lose-device',
                                  str(submission), *self.checkpoint())
            self.assertEqual(result.returncode, 3, result.stderr)
            if os.path.exists(self.path('c')):
                break
        self.assertIn('the last checkpoint is kept: --checkpoint', result.stderr)
        report = self.render('--spp', '320', '--resume', *self.checkpoint())
        self.assertEqual(report['image_hash'], self.render('--spp', '320')['image_hash'])

    def test_one_writer(self):
        first = subprocess.Popen(self.command('--spp', '100M', *self.checkpoint()),
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            while not os.path.exists(self.path('c')) and first.poll() is None:
                time.sleep(0.05)
            command = self.command('--resume', '--checkpoint', self.path('c'))
            command[command.index(self.path('out.exr'))] = self.path('other.exr')
            result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                    text=True, timeout=60)
        finally:
            first.kill()
            first.communicate()
        self.assertEqual(result.returncode, 4)
        self.assertIn('is being written by another run; waiting up to 5 s for its end', result.stderr)
        self.assertIn('is being written by another run, or named twice', result.stderr)

    def test_a_run_waits_for_the_end_of_the_one_it_continues(self):
        first = subprocess.Popen(self.command('--spp', '100M', *self.checkpoint()), stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE)
        self.addCleanup(lambda: first.poll() is None and first.kill())
        while not os.path.exists(self.path('c')):
            self.assertIsNone(first.poll())
            time.sleep(0.05)
        second = subprocess.Popen(self.command('--spp', '100M', '--time', '0.001', '--resume', *self.checkpoint()),
                                  text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(lambda: second.poll() is None and second.kill())
        self.assertIn('waiting up to 5 s', second.stderr.readline())
        first.kill()
        first.communicate()
        stdout, stderr = second.communicate(timeout=60)
        self.assertEqual(second.returncode, 0, stderr)
        self.assertEqual(json.loads(stdout)['ended_by'], 'time')

    def test_a_missing_file_is_a_beginning(self):
        result = self.run_one('--spp', '4', '--resume', *self.checkpoint())
        self.assertEqual(result.returncode, 0)
        self.assertIn('does not exist: rendering begins anew', result.stderr)


class Endings(Checkpoints):
    """Other ways in which a render ends. This class is here to share scenes and commands."""

    def repeat(self):
        with open(self.path('out.exr'), 'rb') as file:
            header = file.read(20000)
        at = header.index(b'lampyris:repeat\0string\0') + len(b'lampyris:repeat\0string\0')
        size = int.from_bytes(header[at:at + 4], 'little')
        words = header[at + 4:at + 4 + size].decode().split(' ')
        result = subprocess.run([LAMPYRIS, *words[1:]], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, timeout=300)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_an_error_ends_it(self):
        for more in ([], ['--adaptive', 'on']):
            report = self.render('--error', '0.01', *more, size='40x36')
            self.assertEqual(report['ended_by'], 'error')
            last = report['looks'][-1]
            spp = [look['spp'] for look in report['looks']]
            self.assertEqual(spp[0], 16 if more else 2)
            for one, other in zip(spp, spp[1:]):
                self.assertTrue(1.06 * one <= other <= 2 * one, spp)
            self.assertEqual(last['confidence'], 0.95)
            for look in report['looks'][:-1]:
                self.assertGreaterEqual(look['at_most'], 0.01)
                self.assertTrue(look['local_relmse'] is None or look['local_relmse'] >= 0.005, look)
            again = self.repeat()
            self.assertEqual(again['image_hash'], report['image_hash'])
            self.assertEqual(again['ended_by'], 'spp')

    def test_resumed_runs_end_at_the_same_error(self):
        """The next interim test is stored in the checkpoint, so an interruption does not affect the
        result."""
        for more in ([], ['--adaptive', 'on']):
            whole = self.render('--error', '0.002', *more)
            self.assertEqual(whole['ended_by'], 'error')
            path = self.path('goal' + '-'.join(more))
            kept = ['--checkpoint', path]
            part = 16 if more else 21  # between two interim tests
            self.render('--error', '0.002', '--spp', str(part), *more, *kept)
            for _ in range(2):  # the second run has nothing left to do
                again = self.render('--error', '0.002', *more, *kept, '--resume')
                self.assertEqual((again['spp'], again['image_hash'], again['ended_by']),
                                 (whole['spp'], whole['image_hash'], 'error'))
                spp = [look['spp'] for look in again['looks']]
                self.assertEqual(spp, [look['spp'] for look in whole['looks']][-len(spp):])
            other = self.render('--error', '0.001', *more, *kept, '--resume')
            self.assertEqual(other['looks'][0]['spp'], whole['looks'][-1]['spp'])
            self.assertGreater(other['spp'], whole['spp'])

    def test_samples_end_it_before_the_error_does(self):
        report = self.render('--error', '1e-9', '--spp', '40')
        self.assertEqual((report['ended_by'], report['spp']), ('spp', 40))
        self.assertEqual([look['spp'] for look in report['looks']], [2, 4, 8, 16, 32, 40])

    def test_time_ends_it_before_the_error_does(self):
        report = self.render('--error', '1e-9', '--time', '0.2')
        self.assertEqual(report['ended_by'], 'time')
        self.assertEqual(self.repeat()['image_hash'], report['image_hash'])

    def test_an_unknown_error_ends_nothing(self):
        # fewer than 30 pixels give no estimate
        report = self.render('--error', '1e6', '--spp', '32', size='4x4')
        self.assertEqual((report['ended_by'], report['spp']), ('spp', 32))
        self.assertEqual(report['looks'][0]['local_relmse'], None)

    def test_time_by_tiles_repeats(self):
        report = self.render('--adaptive', 'on', '--time', '0.2')
        self.assertIn(report['ended_by'], ('time', 'spp'))
        self.assertEqual(self.repeat()['image_hash'], report['image_hash'])

    def test_what_cannot_be_decided_is_refused(self):
        for arguments in (['--adaptive', 'on', '--spp', '1'],
                          ['--adaptive', 'on', '--sampler', 'stratified'],
                          ['--error', '1', '--halves', 'contiguous'],
                          ['--adaptive', 'on', '--frames', '3'], ['--error', '1', '--frames', '3'],
                          ['--resume'], ['--checkpoint-every', '3']):
            result = self.run_one(*arguments)
            self.assertEqual(result.returncode, 2, arguments)

    def test_tiles_of_pictures_of_any_size(self):
        for size in ('1x1', '17x1', '1x33', '50x31'):
            arguments = ['--adaptive', 'on', '--spp', '20']
            hashes = {self.render(*arguments, '--wave', wave, size=size)['image_hash']
                      for wave in ('64', '1024', '16384')}
            self.assertEqual(len(hashes), 1, size)
            report = self.render(*arguments, size=size)
            self.assertGreaterEqual(report['spp'], 2)
            self.assertLessEqual(report['spp_most'], 16 * 20)


# Removes the base class's tests, which would run twice.
for name in list(vars(Checkpoints)):
    if name.startswith('test_'):
        setattr(Endings, name, None)

if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
