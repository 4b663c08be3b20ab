#!/usr/bin/env python3
"""Renders on several devices at once, and compares with the picture of one device, bit by bit.

Usage: test_devices.py LAMPYRIS SCENE_FOLDER [unittest arguments]
"""
import json
import os
import random
import re
import signal
import subprocess
import unittest

from program import need_device
from test_shards import LAMPYRIS, SWIFTSHADER, Shards

# The same device given two or three times counts as several devices of the same kind.
TWO, THREE = ('--device', '0,0'), ('--device', '0,0,0')


class Crews(Shards):
    def picture(self, command, name):
        """Renders and returns the image, its layers, the numbers of rays, and the interim tests with their
        results."""
        report = json.loads(self.succeed(*command, '-o', name, '--json', '-q').stdout)
        looks = [{key: value for key, value in look.items() if key != 'seconds'} for look in report['looks']]
        return report['image_hash'], self.layers(name), report['rays'], report['spp'], looks, report['ended_by']

    def check(self, *arguments, devices=(TWO, THREE), **options):
        one = self.picture(self.command(*arguments, **options), 'one.exr')
        for several in devices:
            self.assertEqual(self.picture(self.command(*arguments, *several, **options), 'several.exr'), one)


class Bits(Crews):
    def test_samples(self):
        self.check('--spp', '57', '--aov', 'all', '--error-by', 'part,bounce,emitter', '--wave', '1k')
        for samples in ('1', '2', '3', '5', '8'):
            self.check('--spp', samples, '--aov', 'ids', devices=(THREE,))
        self.check('--spp', '8', '--integrator', 'auto', devices=(TWO,), scene='all_classes')

    def test_larger_pictures(self):
        self.check('--spp', '24', '--aov', 'depth,ids', size='200x150', devices=(TWO,))

    def test_error(self):
        self.check('--error', '2e-3', '--aov', 'albedo', size='40x36')
        self.check('--error', '1e-9', '--spp', '50', devices=(TWO,))

    def test_samplers_and_scenes(self):
        for arguments, scene in ((['--sampler', 'blue-noise'], 'cornell'), (['--sampler', 'pcg'], 'glass'),
                                 (['--roulette', 'frame'], 'veach_mis'), ([], 'classical')):
            self.check('--spp', '36', *arguments, scene=scene, devices=(THREE,))

    def test_a_trace_has_the_same_rows(self):
        rows = []
        for i, device in enumerate((('--device', '0'), THREE)):
            self.render('--spp', '40', '--trace', f'{i}.csv', '-o', f'{i}.exr', *device)
            lines = [line.split(',') for line in self.read(f'{i}.csv').decode().splitlines()
                     if not line.startswith('#')]
            clocks = [at for at, name in enumerate(lines[0]) if 'second' in name or 'per_s' in name]
            rows.append([[word for at, word in enumerate(line) if at not in clocks] for line in lines])
        self.assertEqual(rows[0], rows[1])

    def test_a_shard_on_two_devices(self):
        whole = Shards.picture(self, self.command('--spp', '40'), 'whole.exr')
        for i in (1, 2, 3):
            self.render('--spp', '40', '--shard', f'{i}/3', '--checkpoint', f'{i}', *(TWO if i < 3 else ()))
        self.assertEqual(Shards.picture(self, ['merge', '2', '3', '1'], 'merged.exr'), whole)

    def test_what_each_has_done(self):
        report = json.loads(self.succeed(*self.command('--spp', '400', *THREE, '-o', 'a.exr', '--json', '-q')).stdout)
        self.assertEqual(sum(member['spp'] for member in report['members']), 400)
        self.assertEqual(len(report['members']), 3)
        told = self.succeed(*self.command('--spp', '400', *TWO, '-o', 'a.exr')).stdout
        self.assertRegex(told, r'device 0  .*: \d+ samples a pixel, .* Msamples/s, busy \d+ %\ndevice 1  ')
        one = json.loads(self.succeed(*self.command('--spp', '4', '-o', 'a.exr', '--json', '-q')).stdout)
        self.assertEqual(one['members'], [])

    def test_time(self):
        report = json.loads(self.succeed(*self.command('--time', '1', *TWO, '-o', 'a.exr', '--json', '-q')).stdout)
        self.assertEqual(report['ended_by'], 'time')
        again = json.loads(self.succeed(*self.command('--spp', str(report['spp']), '-o', 'b.exr', '--json', '-q')).stdout)
        self.assertEqual(again['spp'], report['spp'])

    def test_validation_is_silent(self):
        self.render('--spp', '40', *TWO, '--validation', '-o', 'a.exr')


class Ends(Crews):
    def run_for(self, seconds, number, command):
        process = subprocess.Popen([LAMPYRIS, *command], cwd=self.folder.name, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        try:
            _, stderr = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            _, stderr = process.communicate()
        self.assertIn(process.returncode, (0, -number, 128 + number), stderr)
        return process.returncode

    def test_killed_runs_go_on(self):
        """The render may resume with another number of devices, because a checkpoint has all samples below a
        number."""
        arguments = ('--spp', '2000', '--aov', 'all')
        one = self.picture(self.command(*arguments), 'one.exr')
        generator = random.Random(5)
        for _ in range(6):
            number = generator.choice((signal.SIGKILL, signal.SIGTERM))
            several = generator.choice((TWO, THREE, ()))
            self.run_for(generator.uniform(0.3, 2.0), number,
                         self.command(*arguments, *several, '-q', '-o', 'killed.exr', '--checkpoint', 'ck',
                                      '--checkpoint-every', '0', '--resume'))
        command = self.command(*arguments, *TWO, '--checkpoint', 'ck', '--resume')
        picture = self.picture(command, 'several.exr')
        self.assertEqual(picture[:2] + picture[3:], one[:2] + one[3:])

    def test_a_stopped_picture_is_one_of_fewer_samples(self):
        self.assertEqual(self.run_for(1.5, signal.SIGTERM, self.command(
            '--spp', '1M', *TWO, '-q', '-o', 'stopped.exr', '--checkpoint', 'ck')), 143)
        report = json.loads(self.succeed(*self.command('--spp', '1M', *TWO, '-o', 'more.exr', '--checkpoint', 'ck', '--resume',
                                                       '--time', '0.001', '--json', '-q')).stdout)
        self.assertEqual(report['ended_by'], 'time')

    def test_a_lost_device_ends_it(self):
        result = self.run_one(*self.command('--spp', '2000', *TWO, '-q', '-o', 'a.exr', '--checkpoint', 'ck',
                                            '--checkpoint-every', '0', '--lose-device', '60', size='200x150'))
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn('lost', result.stderr)

    def test_what_cannot_be_shared_is_refused(self):
        for arguments, message in (
                (['--adaptive', 'on', '--spp', '64'], 'several devices (--device) or ranks (mpirun) cannot be combined '
                                                      'with --adaptive on: they share the samples of the whole picture'),
                (['--frames', '3'], 'cannot be combined with --frames'),
                (['--accumulation', 'sum'], 'depend on the order of samples'),
                (['--halves', 'contiguous'], 'every block of samples needs equally many of both halves'),
                (['--device', '0,77'], '--device 77: '), (['--device', '0,'], "no device has the index or name '0,'")):
            result = self.run_one(*self.command(*TWO, *arguments, '-o', 'z.exr'))
            self.assertIn(result.returncode, (2, 3), result.stderr)
            self.assertIn(message, result.stderr)
            self.assertNotIn('z.exr', os.listdir(self.folder.name))


class Fits(Crews):
    """The command `info --device all`."""

    def info(self, *arguments, code=0, **variables):
        result = self.run_one('info', *self.command(*arguments)[1:], '--device', 'all', **variables)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def test_what_fits_is_rendered_and_what_does_not_is_refused(self):
        picture = ('--size', '1280x720')
        self.assertRegex(self.info(*picture).stdout, r'\ndevices    0: .*: fits, [\d.]+ MiB of .* that are left, wave of \d+')
        devices = json.loads(self.info(*picture, '--json').stdout)['devices']
        self.assertEqual([(device['fits'], device['reason']) for device in devices], [(True, None)] * len(devices))
        limits = {'LAMPYRIS_LIMITS': 'memory-budget=20000000'}
        told = self.info(*picture, code=3, **limits).stdout
        self.assertRegex(told, 'devices    0: .*: does not fit: the plan needs .* of device memory')
        report = json.loads(self.info(*picture, '--json', code=3, **limits).stdout)
        self.assertTrue(report['scene'].endswith('cornell.json'))
        self.assertEqual([device['fits'] for device in report['devices']], [False] * len(devices))
        self.assertIn('the plan needs', report['devices'][0]['reason'])
        result = self.run_one(*self.command(*picture, '--spp', '1', '-o', 'z.exr'), **limits)
        self.assertEqual(result.returncode, 3)
        self.assertIn('the plan needs', result.stderr)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_devices_that_share_memory_divide_it(self):
        """Each plans with its share. With the memory of one device, two of them take smaller waves or are refused."""
        command = self.command('--spp', '8', '-o', 'a.exr', size='200x150')
        waves = []
        for devices in ('0', '0,0', '0,0,0'):
            told = self.run_one(*command, '--device', devices, LAMPYRIS_LIMITS='memory-budget=20000000').stdout
            count = devices.count(',') + 1
            words = '' if count == 1 else f' \\(one of {count} that share its memory\\)'
            found = re.search(r'memory    ([\d.]+) MiB on the device' + words + r', .* wave of (\d+) paths', told)
            self.assertTrue(found, told)
            self.assertLess(float(found[1]) * count, 20000000 / 2**20)
            waves.append(int(found[2]))
        self.assertEqual(waves, sorted(set(waves), reverse=True))
        result = self.run_one(*command, '--device', '0,0', LAMPYRIS_LIMITS='memory-budget=8000000')
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stderr, 'the plan needs .* has [\\d.]+ MiB left for each of the 2 that share it; .*, '
                                        'or fewer devices or ranks')
        self.assertEqual(self.run_one(*command, LAMPYRIS_LIMITS='memory-budget=8000000').returncode, 0)

    @unittest.skipUnless(os.path.exists(SWIFTSHADER), 'there is no second driver')
    def test_two_drivers(self):
        own = os.environ.get('VK_DRIVER_FILES', '/usr/share/vulkan/icd.d/lvp_icd.x86_64.json')
        if SWIFTSHADER in own:
            self.skipTest('runs on the second driver already')
        both = {'VK_DRIVER_FILES': f'{own}:{SWIFTSHADER}', 'VK_ICD_FILENAMES': f'{own}:{SWIFTSHADER}'}
        devices = json.loads(self.info('--json', **both).stdout)['devices']
        self.assertEqual([device['index'] for device in devices], [0, 1])
        self.assertTrue(all(device['fits'] and device['bytes'] > 0 for device in devices))


@unittest.skipUnless(os.path.exists(SWIFTSHADER), 'there is no second driver')
class Mixed(Crews):
    def test_two_drivers(self):
        own = os.environ.get('VK_DRIVER_FILES', '/usr/share/vulkan/icd.d/lvp_icd.x86_64.json')
        if SWIFTSHADER in own:
            self.skipTest('runs on the second driver already')
        both = {'VK_DRIVER_FILES': f'{own}:{SWIFTSHADER}', 'VK_ICD_FILENAMES': f'{own}:{SWIFTSHADER}'}
        command = self.command('--spp', '2000', '-q', '--json', '-o', 'a.exr', '--checkpoint')
        result = self.run_one(*command, 'ck', '--device', '0,1', **both)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('does not have the bits that one of them would make alone', result.stderr)
        members = json.loads(result.stdout)['members']
        self.assertEqual(len({member['driver'] for member in members}), 2)
        self.assertGreater(min(member['spp'] for member in members), 0)
        self.refuse('ck: was made with device', *command, 'ck', '--resume', '--device', '0', **both)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
