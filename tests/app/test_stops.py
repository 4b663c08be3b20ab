#!/usr/bin/env python3
"""Tests signals during renders: the renders end soon, every pixel of their pictures has a sample, and
otherwise the output says so.

Usage: test_stops.py LAMPYRIS SCENE_FOLDER [unittest arguments]
"""
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from program import by_the_clock, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
CORNELL = os.path.join(os.path.abspath(sys.argv.pop(1)), 'cornell.json')
# The permitted time from the signal to the end. On a quiet machine it takes at most a second.
SOON_SECONDS = 8.0
# A picture whose first pass takes many waves.
SLOW = ['--size', '1000x600', '--wave', '512', '--spp', '64']
# A picture whose file is larger than the files in which drivers cache machine code: llvmpipe's have 64 KiB,
# and a kernel of SwiftShader without texel buffers has up to 146 KiB.
LARGE = ['--size', '512x384', '--spp', '2']

# Child processes inherit an ignored signal, and nohup ignores SIGHUP.
signal.signal(signal.SIGHUP, signal.SIG_DFL)


class Stops(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def start(self, *arguments, prepare=None):
        return subprocess.Popen([LAMPYRIS, *arguments], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, preexec_fn=prepare)

    def render(self, *arguments, prepare=None):
        return self.start('render', CORNELL, '--json', '-o', self.path('out.exr'), *arguments,
                          prepare=prepare)

    def stop(self, process, *numbers, phase='Rendering'):
        """Sends signals when a phase is displayed. Returns the exit code, the report and the messages."""
        before = ''
        while phase not in (line := process.stderr.readline()):
            self.assertTrue(line, 'it ended before: ' + before)
            before += line
        start = time.monotonic()
        for number in numbers:
            process.send_signal(number)
            time.sleep(0.05)
        out, messages = process.communicate(timeout=100)
        self.seconds = time.monotonic() - start
        return process.returncode, json.loads(out) if out.startswith('{') else None, messages

    def attribute(self, name):
        with open(self.path('out.exr'), 'rb') as file:
            header = file.read(20000)
        start = b'lampyris:%s\0string\0' % name.encode()
        at = header.index(start) + len(start)
        size = int.from_bytes(header[at:at + 4], 'little')
        return header[at + 4:at + 4 + size].decode()

    def check_stopped(self, arguments, number, **options):
        code, report, messages = self.stop(self.render(*arguments, **options), number)
        self.assertEqual(code, 128 + number, messages)
        self.assertLess(self.seconds, SOON_SECONDS, arguments)
        self.assertEqual(report['ended_by'], 'signal')
        self.assertGreater(report['spp'], 0)
        self.assertEqual(report['pixels_without_samples'], 0)
        self.assertEqual(self.attribute('pixels_without_samples'), '0')

    # --- renders end soon ---

    @by_the_clock
    def test_a_clock_does_not_put_signals_off(self):
        small = ['--size', '32x32', '--time', '60']  # a step is one wave
        self.check_stopped(small, signal.SIGTERM)
        self.check_stopped([*small, '--error', '1e-9'], signal.SIGINT)
        self.check_stopped([*small, '--trace', self.path('trace.csv')], signal.SIGUSR1)

    @by_the_clock
    def test_measuring_ends_soon(self):
        for arguments in (['converge', CORNELL, '--times', '60', '--reference', 'none'],
                          ['bench', CORNELL, '--spp', '64', '--repeats', '1000']):
            process = self.start(*arguments, '--size', '32x32')
            phase = 'Replicates' if arguments[0] == 'converge' else 'Rendering'
            code, _, messages = self.stop(process, signal.SIGTERM, phase=phase)
            self.assertEqual(code, 143, messages)
            self.assertLess(self.seconds, SOON_SECONDS, arguments)

    # --- which signals end a render ---

    @by_the_clock
    def test_batch_systems_and_terminals(self):
        endless = ['--size', '16x16', '--spp', '1G']
        for number in (signal.SIGHUP, signal.SIGXCPU):
            self.check_stopped(endless, number)
        # Neither of the two signals ends the render at once.
        code, report, messages = self.stop(self.render(*endless), signal.SIGHUP, signal.SIGHUP,
                                           signal.SIGXCPU, signal.SIGUSR1)
        self.assertEqual((code, report['ended_by']), (129, 'signal'), messages)

    def test_nohup(self):
        def ignore():
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.render('--size', '32x32', '--time', '2', prepare=ignore)
        code, report, messages = self.stop(process, signal.SIGHUP)
        self.assertEqual((code, report['ended_by']), (0, 'time'), messages)

    def test_the_limit_of_processor_time(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (2, 600))
        process = self.render('--size', '32x32', '--time', '60', prepare=limit)
        out, messages = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 128 + signal.SIGXCPU, messages)
        self.assertEqual(json.loads(out)['ended_by'], 'signal')

    def test_the_limit_of_a_files_size(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (400000, resource.RLIM_INFINITY))
            os.environ['TMPDIR'] = self.folder.name
        process = self.render(*LARGE, prepare=limit)
        _, messages = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 4, messages)
        self.assertIn('File too large', messages)
        saved = messages.split('the picture was saved as ')[1].split('\n')[0]
        self.assertEqual(os.path.dirname(os.path.dirname(saved)), self.folder.name)
        whole = self.render(*LARGE)
        whole.communicate(timeout=100)
        self.assertEqual(whole.returncode, 0)
        result = subprocess.run([LAMPYRIS, 'compare', saved, self.path('out.exr'), '--max',
                                 'differing=0'], stdout=subprocess.PIPE)
        self.assertEqual(result.returncode, 0)

    def test_the_hard_limit_of_a_files_size(self):
        """The limit is between the sizes of a picture with 32 and with 16 bits per value, and then below
        both."""
        sizes = []
        for more in ([], ['--half']):
            self.assertEqual((process := self.render(*LARGE, *more)).communicate(timeout=100) and
                             process.returncode, 0)
            sizes.append(os.path.getsize(self.path('out.exr')))
            os.unlink(self.path('out.exr'))
        limit = sum(sizes) // 2

        def prepare():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            os.environ['TMPDIR'] = self.folder.name
        process = self.render(*LARGE, prepare=prepare)
        _, messages = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 4, messages)
        self.assertIn('with 16 bits a value', messages)
        saved = messages.split('the picture was saved as ')[1].split(',')[0]
        self.assertLess(os.path.getsize(saved), limit)
        result = subprocess.run([LAMPYRIS, 'compare', saved, saved], stdout=subprocess.PIPE)
        self.assertEqual(result.returncode, 0)
        limit = sizes[1] // 2
        process = self.render(*LARGE, prepare=prepare)
        _, messages = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 4, messages)
        self.assertRegex(messages, r'at most [\d.]+ [KM]iB here')
        self.assertIn('%.1f MiB before compression' % (512 * 384 * 3 * 4 / 1048576), messages)
        self.assertIn('could not be saved in', messages)

    # --- every pixel has a sample ---

    @by_the_clock
    def test_every_pixel_gets_a_sample_first(self):
        for more in ([], ['--adaptive', 'on']):
            code, report, messages = self.stop(self.render(*SLOW, *more), signal.SIGTERM)
            self.assertEqual(code, 143, messages)
            self.assertEqual((report['spp'], report['pixels_without_samples']), (1, 0), messages)
            if self.seconds > 3:  # waits of less than a second are not reported
                self.assertIn('the others get one first', messages)

    def test_short_waits_are_not_told(self):
        """Signals arrive at any time during the first waves of a small picture."""
        small = ['--size', '32x32', '--time', '60']
        start = time.monotonic()
        self.render('--size', '32x32', '--spp', '1').communicate(timeout=100)
        whole = time.monotonic() - start
        for i in range(12):
            process = self.render(*small)
            time.sleep(whole * (0.4 + 0.06 * i))
            process.send_signal(signal.SIGTERM)
            start = time.monotonic()
            _, messages = process.communicate(timeout=100)
            if time.monotonic() - start < 0.9:
                self.assertNotIn('of the pixels have a sample', messages)

    @by_the_clock
    def test_the_second_signal_does_not_wait(self):
        process = self.render(*SLOW)
        self.assertEqual(self.stop(process, signal.SIGHUP, signal.SIGTERM)[0], 143)
        self.assertLess(self.seconds, 2.0)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_black_pixels_are_counted(self):
        def limit():  # the soft limit is high; the hard limit would end the process
            resource.setrlimit(resource.RLIMIT_CPU, (6000, 6001))
        for more in ([], ['--adaptive', 'on']):
            process = self.render(*SLOW, *more, prepare=limit)
            code, report, messages = self.stop(process, signal.SIGXCPU)
            self.assertEqual(code, 152, messages)
            black = report['pixels_without_samples']
            self.assertEqual((report['spp'], report['spp_most']), (0, 1))
            self.assertTrue(0 < black < 1000 * 600, black)
            self.assertIn('%d of 600000 pixels have no sample' % black, messages)
            self.assertEqual(self.attribute('pixels_without_samples'), str(black))


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
