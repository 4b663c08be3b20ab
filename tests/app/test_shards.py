#!/usr/bin/env python3
"""Renders pictures in shards, merges them, and compares with the picture of one process, bit by bit.

Usage: test_shards.py LAMPYRIS SCENE_FOLDER [--kills N] [--make-parts PROGRAM] [unittest arguments]
"""
import hashlib
import json
import os
import random
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SCENES = os.path.abspath(sys.argv.pop(1))
KILLS = 10
if '--kills' in sys.argv:
    at = sys.argv.index('--kills')
    KILLS = int(sys.argv[at + 1])
    del sys.argv[at:at + 2]
MAKE_PARTS = None
if '--make-parts' in sys.argv:
    at = sys.argv.index('--make-parts')
    MAKE_PARTS = os.path.abspath(sys.argv[at + 1])
    del sys.argv[at:at + 2]
SWIFTSHADER = '/usr/lib/chromium/vk_swiftshader_icd.json'
# Environment variables that tell a process its index.
PLACES = re.compile(r'SLURM_|OMPI_|PMI_|PMIX_|JOB_COMPLETION')


class Shards(unittest.TestCase):
    TIMEOUT = 300 # seconds that one command may take

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def read(self, name):
        with open(self.path(name), 'rb') as file:
            return file.read()

    def write(self, name, data):
        with open(self.path(name), 'wb') as file:
            file.write(data)

    def run_one(self, *arguments, **variables):
        env = {name: value for name, value in os.environ.items() if not PLACES.match(name)}
        return subprocess.run([LAMPYRIS, *arguments], cwd=self.folder.name, env={**env, **variables},
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=self.TIMEOUT)

    def command(self, *arguments, scene='cornell', size='20x18'):
        return ['render', os.path.join(SCENES, scene + '.json'), '--size', size, *arguments]

    def succeed(self, *arguments):
        result = self.run_one(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def render(self, *arguments, **options):
        return self.succeed(*self.command(*arguments, **options), '-q')

    def render_shards(self, count, *arguments, **options):
        names = [f'{i}.part' for i in range(1, count + 1)]
        for i, name in enumerate(names, 1):
            self.render('--shard', f'{i}/{count}', '--checkpoint', name, *arguments, **options)
        return names

    def layers(self, name):
        """Returns the content of an EXR file after its attributes, which contain times, and after the offsets
        of its blocks."""
        data, at = self.read(name), 8
        while data[at]:
            kind = data.index(b'\0', at) + 1
            value = data.index(b'\0', kind) + 1
            at = value + 4 + int.from_bytes(data[value:value + 4], 'little')
        first = int.from_bytes(data[at + 1:at + 9], 'little')
        self.assertLess(first, len(data))
        return data[first:]

    def picture(self, command, name):
        report = json.loads(self.succeed(*command, '-o', name, '--json', '-q').stdout)
        layers = hashlib.sha256(self.layers(name)).hexdigest()
        return report['image_hash'], layers, report['rays'], report['spp']

    def refuse(self, message, *arguments, **variables):
        result = self.run_one(*arguments, **variables)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(message, result.stderr)
        self.assertEqual(result.stdout, '')
        self.assertNotIn('z.exr', os.listdir(self.folder.name))
        return result.stderr

    def merge_at_random(self, parts, generator):
        """Merges random parts, in any order, until a single part is left, which is merged into the
        picture."""
        left = list(parts)
        for step in range(3):
            some = generator.sample(left, generator.randrange(1, len(left) + 1))
            self.succeed('merge', *some, '--checkpoint', f'sum{step}', '-q')
            left = [name for name in left if name not in some] + [f'sum{step}']
        generator.shuffle(left)
        picture = self.picture(['merge', *left], 'merged.exr')
        for step in range(3):
            os.unlink(self.path(f'sum{step}'))
        return picture

    def check_same_bits(self, count, trials, *arguments, **options):
        whole = self.picture(self.command(*arguments, **options), 'whole.exr')
        parts = self.render_shards(count, *arguments, **options)
        generator = random.Random(count)
        for trial in range(trials):
            self.assertEqual(self.merge_at_random(parts, generator), whole, trial)


class Bits(Shards):
    def test_seven_shards_in_any_order_and_grouping(self):
        self.check_same_bits(7, 6, '--spp', '57', '--aov', 'all', '--error-by', 'part,bounce,emitter')

    def test_samplers_that_plan(self):
        for sampler in ('stratified', 'grid', 'blue-noise', 'lcg'):
            with self.subTest(sampler):
                self.setUp()
                self.check_same_bits(3, 1, '--spp', '36', '--sampler', sampler)

    def test_methods(self):
        for method in (['--integrator', 'direct'], ['--integrator', 'ao', '--ao-distance', '1'],
                       ['--roulette', 'frame'], ['--filter', 'gaussian']):
            with self.subTest(method):
                self.setUp()
                self.check_same_bits(3, 1, '--spp', '20', *method)

    def test_materials_and_lights(self):
        for scene in ('glass', 'classical', 'veach_mis'):
            with self.subTest(scene):
                self.setUp()
                self.check_same_bits(4, 1, '--spp', '24', '--aov', 'all', scene=scene)

    def test_more_samples_later(self):
        whole = self.picture(self.command('--spp', '48'), 'whole.exr')
        parts = self.render_shards(2, '--spp', '16')
        self.render('--spp', '48', '--shard', '16:48')
        self.assertEqual(self.picture(['merge', 'cornell.16-48.part', *parts], 'merged.exr'), whole)

    def test_waves_of_any_size(self):
        whole = self.picture(self.command('--spp', '40'), 'whole.exr')
        for i, wave in enumerate(('64', '256', '4k'), 1):
            self.render('--spp', '40', '--shard', f'{i}/3', '--wave', wave)
        parts = [f'cornell.{i}-of-3.part' for i in (2, 3, 1)]
        self.assertEqual(self.picture(['merge', *parts], 'merged.exr'), whole)


    def test_light_paths(self):
        """Bidirectional light: light paths of each part bring light to all pixels."""
        for scene, size in (('cornell', '20x18'), ('veach_mis', '24x20')):
            with self.subTest(scene):
                self.setUp()
                self.check_same_bits(7, 2, '--spp', '57', '--integrator', 'bidir', '--aov', 'depth,normal,ids',
                                     scene=scene, size=size)


class Tiles(Shards):
    """Parts of the picture: all samples of some rows."""

    def check_tiles(self, count, trials, *arguments, size='20x120', same_rays=True, **options):
        whole = self.picture(self.command(*arguments, size=size, **options), 'whole.exr')
        parts = self.render_shards(count, '--shard-by', 'tiles', *arguments, size=size, **options)
        generator = random.Random(count)
        for trial in range(trials):
            merged = self.merge_at_random(parts, generator)
            if not same_rays:
                self.assertGreater(merged[2]['closest'], whole[2]['closest'])
                merged = (*merged[:2], whole[2], merged[3])
            self.assertEqual(merged, whole, trial)
        return parts

    def start_and_wait_for(self, name, *command, before=False):
        """Starts a render, and waits until a file was written anew."""
        process = subprocess.Popen([LAMPYRIS, *command], cwd=self.folder.name)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        while process.poll() is None and not (os.path.exists(self.path(name)) and
                                              os.stat(self.path(name)).st_ino != before):
            time.sleep(0.01)
        return process

    def test_in_any_order_and_grouping(self):
        parts = self.check_tiles(7, 4, '--spp', '9', '--aov', 'all', '--error-by', 'part,bounce,emitter')
        self.assertLess(os.path.getsize(self.path(parts[0])), os.path.getsize(self.path(parts[-1])))

    def test_adaptive(self):
        """Each part takes the pilot's samples of the whole picture, so that all have one plan."""
        for arguments in (['--spp', '48', '--aov', 'all'], ['--spp', '20', '--sampler', 'pcg']):
            with self.subTest(arguments):
                self.setUp()
                self.check_tiles(5, 3, '--adaptive', 'on', *arguments, same_rays=False)

    def test_light_paths(self):
        """They bring light to all pixels: a part has a whole film."""
        parts = self.check_tiles(4, 3, '--spp', '10', '--integrator', 'bidir', '--aov', 'depth')
        self.assertEqual(len({os.path.getsize(self.path(part)) // 1000 for part in parts}), 1)

    def test_methods(self):
        for arguments, scene in ((['--spp', '18', '--halves', 'contiguous'], 'cornell'),
                                 (['--spp', '16', '--sampler', 'blue-noise', '--split-lobes', '2'], 'veach_mis'),
                                 (['--spp', '12', '--filter', 'gaussian', '--wave', '256'], 'glass')):
            with self.subTest(arguments):
                self.setUp()
                self.check_tiles(3, 1, *arguments, scene=scene)

    def test_several_devices(self):
        self.check_tiles(3, 1, '--spp', '24', '--device', '0,0')

    def test_what_is_missing(self):
        command = self.command('--spp', '8', size='20x72')
        whole = self.picture(command, 'whole.exr')
        self.succeed(*command, '--shard', '16:32', '--shard-by', 'tiles', '--checkpoint', 'a', '-q')
        stderr = self.refuse('56 of 72 rows are missing (0:16,32:72)', 'merge', 'a', '-o', 'z.exr')
        commands = re.findall(r'^lampyris (render .*)$', stderr, re.MULTILINE)
        self.assertEqual(len(commands), 4)
        status = json.loads(self.run_one('merge', '--status', 'a', '--json').stdout)
        self.assertEqual((status['by'], status['all'], status['missing']), ('tiles', 72, '0:16,32:72'))
        for one in commands:
            self.succeed(*shlex.split(one), '-q')
        made = [name for name in os.listdir(self.folder.name) if name.startswith('cornell.')]
        self.assertEqual(self.picture(['merge', 'a', *made], 'merged.exr'), whole)
        result = self.succeed('merge', 'a', made[0], '--partial', '-o', 'p.exr', '--json', '-q')
        self.assertGreater(json.loads(result.stdout)['pixels_without_samples'], 0)

    def test_what_is_refused(self):
        parts = self.render_shards(3, '--shard-by', 'tiles', '--spp', '8', size='20x72')
        by_samples = self.command('--spp', '8', '--shard', '0:4', '--checkpoint', 's', '-q', size='20x72')
        self.succeed(*by_samples)
        self.refuse('s: was made with --shard-by=samples, but 1.part has tiles', 'merge', parts[0], 's', '-o', 'z.exr')
        self.refuse('2.part: has rows 16:48, which 2.part has, too; expected every row once', 'merge', *parts,
                    parts[1], '-o', 'z.exr')
        self.render('--spp', '16', '--shard', '2/3', '--shard-by', 'tiles', '--checkpoint', 'more', size='20x72')
        self.refuse('more: was made with --shard-by=tiles of 16 samples a pixel', 'merge', parts[0], 'more')
        for arguments, message in (
                (['--shard', '1/6'], 'expected at most 5 shards'), (['--shard', '0:8'], 'in multiples of 16 up to'),
                (['--shard', '64:80'], 'in multiples of 16 up to the 72'), ([], '--shard-by needs --shard'),
                (['--shard', '1/2', '--accumulation', 'sum'], 'depend on the order of samples'),
                (['--shard', '1/2', '--error', '0.1'], 'which is the error of all shards'),
                (['--shard', '1/2', '--reference', self.path('s')], 'reference')):
            result = self.run_one(*self.command('--spp', '8', '--shard-by', 'tiles', *arguments, size='20x72'))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(message, result.stderr)

    def test_an_unfinished_part(self):
        """Its rows have fewer samples than those of others: it only goes on."""
        command = self.command('--spp', '200k', '--shard', '1/2', '--shard-by', 'tiles', '--checkpoint', 'a', '-q',
                               size='20x40')
        process = self.start_and_wait_for('a', *command, '--checkpoint-every', '0')
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(), 143)
        self.refuse('--shard-by tiles --shard 0:16 --checkpoint a --resume', 'merge', 'a', '-o', 'z.exr')

    def test_a_part_goes_on(self):
        """Stopped again and again, it becomes the part of one run; with tiles of their own samples, too."""
        for arguments in (['--spp', '3000'], ['--spp', '2400', '--adaptive', 'on']):
            command = self.command(*arguments, '--shard', '16:48', '--shard-by', 'tiles', '-q', size='20x72')
            self.succeed(*command, '--checkpoint', 'whole')
            for _ in range(4):
                before = os.path.exists(self.path('pieces')) and os.stat(self.path('pieces')).st_ino
                process = self.start_and_wait_for('pieces', *command, '--checkpoint', 'pieces', '--resume',
                                                  '--checkpoint-every', '0', '--log-level', 'error', before=before)
                process.kill()
                process.wait()
            self.succeed(*command, '--checkpoint', 'pieces', '--resume')
            for name in ('whole', 'pieces'):
                self.succeed('merge', name, '--partial', '-o', name + '.exr', '-q')
            self.assertEqual(self.layers('whole.exr'), self.layers('pieces.exr'))
            os.unlink(self.path('whole'))
            os.unlink(self.path('pieces'))

    def test_the_error_is_that_of_the_rows(self):
        """It is the error of the same rows as a picture of their own, and says so; light paths of other parts
        leave it unknown."""
        command = self.command('--spp', '64', '--shard', '16:48', '--shard-by', 'tiles', '-o', 'a.exr', size='20x72')
        report = json.loads(self.succeed(*command, '--json', '-q').stdout)
        whole = json.loads(self.succeed(*self.command('--spp', '64', '-o', 'w.exr', size='20x72'), '--json', '-q').stdout)
        self.assertEqual((report['rows'], whole['rows']), ([16, 48], [0, 72]))
        self.assertEqual((report['spp'], report['pixels_without_samples']), (64, 0))
        self.assertTrue(report['error']['local_relmse'] > 0.0)
        self.assertNotEqual(report['error']['local_relmse'], whole['error']['local_relmse'])
        os.unlink(self.path('cornell.16-48.part'))
        self.assertIn('16 to 48 of 72 are in this part: the error is that of these rows', self.succeed(*command).stdout)
        os.unlink(self.path('cornell.16-48.part'))
        result = self.succeed(*command, '--integrator', 'bidir')
        self.assertIn('light paths of the other parts bring light to these rows', result.stdout)


class Missing(Shards):
    def test_commands_render_what_is_missing(self):
        whole = self.picture(self.command('--spp', '57', '--aov', 'depth'), 'whole.exr')
        parts = self.render_shards(7, '--spp', '57', '--aov', 'depth')
        some = [parts[i] for i in (0, 2, 3)]
        stderr = self.refuse('samples per pixel are missing (8:16,32:57)', 'merge', *some, '-o', 'z.exr')
        commands = re.findall(r'^lampyris (render .*)$', stderr, re.MULTILINE)
        self.assertGreaterEqual(len(commands), 3)
        for command in commands:
            self.succeed(*shlex.split(command), '-q')
        made = [name for name in os.listdir(self.folder.name) if name.startswith('cornell.')]
        self.assertEqual(len(made), len(commands))
        self.assertEqual(self.picture(['merge', *some, *made], 'merged.exr'), whole)

    def test_a_scene_whose_name_begins_with_dashes(self):
        """Options that are added to its command must not follow "--"."""
        with open(os.path.join(SCENES, 'cornell.json'), 'rb') as scene:
            self.write('--x.json', scene.read())
        self.succeed('render', '--size', '8x8', '--spp', '8', '-q', '--shard', '1/2', '--', '--x.json')
        told = self.refuse('expected their parts', 'merge', '-o', 'z.exr', '--', '--x.1-of-2.part')
        command, = re.findall('^lampyris (.* --shard 4:8)$', told, re.MULTILINE)
        self.assertIn(' ./--x.json ', command)
        self.succeed(*shlex.split(command), '-q')
        self.succeed('merge', './--x.1-of-2.part', './--x.4-8.part', '-o', 'a.exr')

    def test_all_commands(self):
        """The first ones are printed, and all are in the JSON of the status."""
        self.render('--spp', '400', '--shard', '0:2', '--checkpoint', 'a')
        stderr = self.refuse('and 135 more commands of this kind, all of which merge --status --json prints', 'merge', 'a',
                             '-o', 'z.exr')
        commands = json.loads(self.run_one('merge', '--status', '--json', 'a').stdout)['commands']
        self.assertEqual(len(commands), 199)
        self.assertEqual(re.findall('^lampyris render .*$', stderr, re.MULTILINE), commands[:64])

    def test_an_odd_number_of_samples_cannot_get_more(self):
        self.render('--spp', '7', '--shard', '1/1', '--checkpoint', 'a')
        self.render('--spp', '12', '--shard', '8:12', '--checkpoint', 'b')
        why = 'no shard can begin at an odd sample: parts of a render with an odd --spp cannot be continued'
        self.refuse(why, 'merge', 'a', 'b', '-o', 'z.exr')
        result = self.run_one('merge', '--status', 'a', 'b')
        self.assertEqual(result.returncode, 1)
        self.assertIn(why, result.stdout)
        self.assertNotIn('--shard', result.stdout)
        status = json.loads(self.run_one('merge', '--status', 'a', 'b', '--json').stdout)
        self.assertEqual(status['commands'], [])
        self.assertIn(why, status['reason'])

    def test_a_part_stopped_within_a_pass(self):
        """It has no sample for merge and for its status, and both say how to finish it, for a shell."""
        command = self.command('--spp', '100k', '--shard', '1/2', '--checkpoint', 'a b', '--wave', '64', '-q',
                               size='100x80')
        process = subprocess.Popen([LAMPYRIS, *command, '--checkpoint-every', '0'], cwd=self.folder.name)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        while not os.path.exists(self.path('a b')):
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        process.kill() # after few of the hundred waves of its first pass
        process.wait()
        way = "--shard 0:51200 --checkpoint 'a b' --resume"
        self.assertIn('no part has a sample yet', self.refuse(way, 'merge', 'a b', '-o', 'z.exr', '--partial'))
        result = self.run_one('merge', '--status', 'a b')
        self.assertIn(way, result.stdout)
        self.assertIn('a b: samples 0:51200, unfinished, 0 %', result.stdout)
        status = json.loads(self.run_one('merge', '--status', 'a b', '--json').stdout)
        self.assertEqual(status['parts'][0]['has'], 'none')
        self.assertIn(way, status['resumes'][0])

    def test_partial(self):
        parts = self.render_shards(4, '--spp', '32')
        result = self.succeed('merge', parts[1], parts[3], '--partial', '-o', 'p.exr', '--json', '-q')
        self.assertIn('16 of 32 samples per pixel are missing (0:8,16:24)', result.stderr)
        self.assertEqual(json.loads(result.stdout)['spp'], 16)
        self.assertNotIn(b'lampyris:repeat\0', self.read('p.exr'))
        self.succeed('merge', *parts, '-o', 'whole.exr', '-q')
        self.assertIn(b'lampyris:repeat\0', self.read('whole.exr'))

    def test_stopped_shards_count(self):
        """Between passes, both halves of a part have equally many samples."""
        arguments = self.command('--spp', '4000', size='32x32')
        parts = [f'p{i}' for i in range(1, 4)]
        for i, part in enumerate(parts, 1):
            shard = subprocess.Popen(
                [LAMPYRIS, *arguments, '--shard', f'{i}/3', '--checkpoint', part, '--checkpoint-every', '0.05', '-q'],
                cwd=self.folder.name)
            while shard.poll() is None and not os.path.exists(self.path(part)):
                time.sleep(0.01)
            shard.terminate()
            self.assertIn(shard.wait(), (0, 143))
        self.succeed('merge', *parts, '--partial', '-o', 'p.exr', '-q')
        status = self.run_one('merge', '--status', *parts).stdout
        for command in re.findall(r'^lampyris (render .* --resume)$', status, re.MULTILINE):
            self.succeed(*shlex.split(command), '-q')
        self.assertEqual(self.picture(['merge', *parts], 'merged.exr'), self.picture(arguments, 'whole.exr'))

    def test_odd_ends_cannot_be_continued(self):
        parts = self.render_shards(2, '--spp', '15')
        self.succeed('merge', *parts, '--checkpoint', 'sum', '-q')
        self.render('--spp', '32', '--shard', '16:32', '--checkpoint', 'more')
        self.refuse('no shard can begin at an odd sample', 'merge', 'sum', 'more', '-o', 'z.exr')

    def test_parts_with_other_outputs(self):
        self.render('--spp', '8', '--shard', '1/2', '--checkpoint', 'a', '--exposure', '3')
        self.render('--spp', '8', '--shard', '2/2', '--checkpoint', 'b')
        for parts in (('a', 'b'), ('b', 'a')):
            result = self.succeed('merge', *parts, '-o', 'z.exr', '-q')
            self.assertIn(f'{parts[1]}: was rendered with another --exposure', result.stderr)
        result = self.succeed('merge', 'a', 'b', '--mixed', '--checkpoint', 'sum', '--json')
        self.assertEqual(json.loads(result.stdout)['has'], '0:8')
        result = self.succeed('merge', 'b', '--mixed', '--partial', '-o', 'z.exr', '-q')
        self.assertNotIn('is not the device', result.stderr)

    def test_a_sum_without_scene_and_device(self):
        parts = self.render_shards(3, '--spp', '12')
        result = self.run_one('merge', *parts[:2], '--checkpoint', 'sum', VK_DRIVER_FILES='/nowhere',
                              VK_ICD_FILENAMES='/nowhere')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('samples 0:8 of 12 a pixel', result.stdout)
        self.refuse('exists already', 'merge', *parts, '--checkpoint', 'sum')


@unittest.skipUnless(MAKE_PARTS, 'no program that makes parts was given')
class Many(Shards):
    """There are a thousand parts, all copies of one that was rendered: each has the film of its samples."""

    def test_a_thousand_parts(self):
        count = 1000
        arguments = ('--spp', str(2 * count), '--aov', 'depth')
        self.render(*arguments, '--shard', '0:2', '--checkpoint', 'one')
        subprocess.run([MAKE_PARTS, 'one', str(count), '0', str(count - 1), '.'], cwd=self.folder.name, check=True)
        parts = [f'{i}.part' for i in range(count)]
        self.assertEqual(self.read(parts[0]), self.read('one'))
        random.Random(6).shuffle(parts)
        whole = self.picture(['merge', *parts], 'whole.exr')
        self.assertEqual(whole[3], 2 * count)
        sums = []
        for at in range(0, count, 100):
            sums.append(f'sum{at}')
            self.succeed('merge', *parts[at:at + 100], '--checkpoint', sums[-1], '-q')
        self.assertEqual(self.picture(['merge', *sums], 'staged.exr')[:2], whole[:2])
        # The mean of equal films is the same film, except for the rounding by the device.
        self.succeed('merge', 'one', '--partial', '-o', 'one.exr', '-q')
        self.succeed('compare', 'whole.exr', 'one.exr', '--max', 'relmse=1e-12', '-q')

    def test_memory_does_not_grow_with_the_parts(self):
        self.render('--spp', '2000', '--shard', '0:2', '--checkpoint', 'one', size='400x300')
        subprocess.run([MAKE_PARTS, 'one', '1000', '0', '39', '.'], cwd=self.folder.name, check=True)
        peaks = []
        for count in (2, 40):
            merge = subprocess.Popen([LAMPYRIS, 'merge', *(f'{i}.part' for i in range(count)), '--checkpoint',
                                      f'sum{count}', '-q'], cwd=self.folder.name)
            _, status, usage = os.wait4(merge.pid, 0)
            merge.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(merge.returncode, 0)
            peaks.append(usage.ru_maxrss << 10)
        film = os.path.getsize(self.path('one'))
        self.assertLess(peaks[1] - peaks[0], film // 4)
        self.assertLess(peaks[1], 2 * film + (32 << 20))


class Damage(Shards):
    def check(self, data, *others):
        self.write('bad.part', data)
        return self.refuse('bad.part: ', 'merge', *others, 'bad.part', '-o', 'z.exr', '--partial')

    def test_cut_files(self):
        first, second = self.render_shards(2, '--spp', '4')
        whole = self.read(second)
        for length in range(0, len(whole), 997):
            self.check(whole[:length], first)
        self.check(whole[:-1], first)
        self.check(whole + b'\0', first)

    def test_flipped_bits(self):
        first, second = self.render_shards(2, '--spp', '4')
        whole, generator = self.read(second), random.Random(4)
        places = [*range(0, 96, 5), *range(200, len(whole), 997), len(whole) - 1]
        for place in places:
            damaged = bytearray(whole)
            damaged[place] ^= 1 << generator.randrange(8)
            self.check(bytes(damaged), first)

    def test_blocks_of_another_file(self):
        """The blocks have correct hashes but belong to another part."""
        first, second = self.render_shards(2, '--spp', '4', size='200x100')
        one, two = self.read(first), self.read(second)
        self.assertEqual(len(one), len(two))
        spliced = two[:-2000000] + one[-2000000:]
        self.assertIn('a block of its film', self.check(spliced, first))

    def test_every_damaged_part_is_named(self):
        parts = self.render_shards(4, '--spp', '8')
        for name in (parts[1], parts[3]):
            self.write(name, self.read(name)[:-1] + b'x')
        stderr = self.refuse(f'{parts[1]}: is damaged', 'merge', *parts, '-o', 'z.exr')
        self.assertIn(f'{parts[3]}: is damaged', stderr)


class Refused(Shards):
    def test_parts_that_do_not_belong_together(self):
        parts = self.render_shards(2, '--spp', '4')
        cases = ((['--seed', '3'], 'was made with --seed=3, but 1.part has 0'),
                 (['-D', 'film.exposure=1'], 'was made with scene of hash='),
                 (['--max-bounces', '2'], 'was made with --max-bounces=2, but 1.part has 9'),
                 (['--aov', 'depth'], 'was made with --aov='),
                 (['--sampler', 'pcg'], 'was made with --sampler=pcg, but 1.part has sobol'))
        for arguments, message in cases:
            self.render('--spp', '4', '--shard', '2/2', '--checkpoint', 'other', *arguments)
            self.refuse('other: ' + message, 'merge', parts[0], 'other', '-o', 'z.exr')
            os.unlink(self.path('other'))
        self.render('--spp', '4', '--shard', '2/2', '--checkpoint', 'other', size='20x20')
        self.refuse('other: was made with --size=20x20', 'merge', parts[0], 'other', '-o', 'z.exr')

    def test_samples_twice(self):
        parts = self.render_shards(3, '--spp', '12')
        self.refuse('1.part: has samples 0:4, which 1.part has, too', 'merge', *parts, parts[0])
        self.render('--spp', '12', '--shard', '2:6', '--checkpoint', 'more')
        self.refuse('more: has samples 2:4, which 1.part has, too', 'merge', *parts, 'more')
        self.succeed('merge', *parts[1:], '--checkpoint', 'sum', '-q')
        self.refuse('sum: has samples 8:12, which 3.part has, too', 'merge', parts[2], 'sum')

    def test_what_is_no_part(self):
        self.render('--spp', '4', '--checkpoint', 'whole', '-o', 'a.exr')
        self.refuse('whole: is the checkpoint of a whole render', 'merge', 'whole')
        self.refuse('a.exr: is not a checkpoint', 'merge', 'a.exr')
        self.refuse('nowhere: cannot open', 'merge', 'nowhere')
        self.refuse('.: is not a regular file', 'merge', '.')

    def test_goals_that_shards_cannot_have(self):
        for arguments, message in (
                (['--error', '0.1'], 'which is the error of all shards together'),
                (['--time', '1'], 'must not depend on the clock'),
                (['--adaptive', 'on', '--spp', '64'], 'parts have the same samples of all pixels'),
                (['--frames', '3'], 'samples of one picture'),
                (['--accumulation', 'sum'], 'depend on the order of samples'),
                (['--halves', 'contiguous'], 'every part needs equally many samples of both halves'),
                (['--pixel', '1,1'], 'exclude each other'), (['--trace', 'a.csv'], 'exclude each other'),
                (['--spp', '4', '--shard', '1/3'], 'expected at most 2 shards'),
                (['--spp', '8', '--shard', '4:10'], 'expected even numbers up to the 8'),
                (['--spp', '8', '--shard', '3:6'], 'expected even numbers'),
                (['--shard', '3/2'], 'is no shard'), (['--shard', '0/2'], 'is no shard'),
                (['--shard', '4:4'], 'is no shard'), (['--shard', '1/2x'], 'is no shard'),
                (['--shard', '-1/2'], 'is no shard'), (['--shard', '1/4294967297'], 'is no shard'), (['--shard', 'auto/0'], 'has no valid number of shards'),
                (['--shard', 'auto'], 'none of SLURM_ARRAY_TASK_ID')):
            self.refuse(message, *self.command('--shard', '1/2', *arguments))
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_a_scene_that_changed_or_is_not_here(self):
        with open(os.path.join(SCENES, 'cornell.json'), 'rb') as file:
            scene = file.read()
        self.write('box.json', scene)
        for i in (1, 2):
            self.succeed('render', 'box.json', '--size', '8x8', '--spp', '4', '--shard', f'{i}/2', '-q')
        parts = ['box.1-of-2.part', 'box.2-of-2.part']
        self.write('box.json', scene + b'\n')
        self.refuse('the sum of the parts: was made with scene of hash=', 'merge', *parts, '-o', 'z.exr')
        os.unlink(self.path('box.json'))
        self.refuse('box.json: does not exist here', 'merge', *parts, '-o', 'z.exr')
        self.write('box.json', scene)
        self.succeed('merge', *parts, '-q')
        self.assertIn('box.exr', os.listdir(self.folder.name))

    def test_parts_are_not_replaced(self):
        parts = self.render_shards(2, '--spp', '4')
        os.rename(self.path(parts[0]), self.path('one.exr'))
        before = self.read('one.exr')
        self.assertEqual(self.run_one('merge', 'one.exr', parts[1], '-o', 'one.exr').returncode, 2)
        self.assertEqual(self.read('one.exr'), before)
        result = self.run_one(*self.command('--spp', '4', '--shard', '2/2', '--checkpoint', parts[1]))
        self.assertEqual(result.returncode, 2)
        self.assertIn('exists already; expected --resume', result.stderr)


class Auto(Shards):
    """Tests --shard auto with the variables that Slurm, mpirun and Kubernetes set."""

    def name(self, shard='auto', **variables):
        before = set(os.listdir(self.folder.name))
        result = self.run_one(*self.command('--spp', '64', '--shard', shard, '-q', size='2x2'), **variables)
        self.assertEqual(result.returncode, 0, result.stderr)
        made, = set(os.listdir(self.folder.name)) - before
        os.unlink(self.path(made))
        return made

    def array(self, task, count, low, high, step=1):
        return {'SLURM_ARRAY_TASK_ID': str(task), 'SLURM_ARRAY_TASK_COUNT': str(count),
                'SLURM_ARRAY_TASK_MIN': str(low), 'SLURM_ARRAY_TASK_MAX': str(high),
                'SLURM_ARRAY_TASK_STEP': str(step)}

    def test_places(self):
        slurm = {'SLURM_PROCID': '2', 'SLURM_NTASKS': '4'}
        ompi = {'OMPI_COMM_WORLD_RANK': '6', 'OMPI_COMM_WORLD_SIZE': '7'}
        for variables, name in (
                (slurm, '3-of-4'), (ompi, '7-of-7'), ({**slurm, **ompi}, '7-of-7'),
                ({'PMI_RANK': '0', 'PMI_SIZE': '12'}, '01-of-12'),
                ({'PMIX_RANK': '3', 'SLURM_NTASKS': '4', 'SLURM_PROCID': '3'}, '4-of-4'),
                (self.array(0, 5, 0, 4), '1-of-5'), (self.array(11, 4, 5, 11, 2), '4-of-4'),
                # Each task of an array is a step of several processes.
                ({**self.array(1, 3, 0, 2), **slurm}, '07-of-12'),
                # The process is a batch script itself.
                ({**self.array(2, 3, 1, 3), 'SLURM_PROCID': '0'}, '2-of-3'),
                ({**self.array(2, 3, 1, 3), 'SLURM_PROCID': '0', 'SLURM_NTASKS': '1'}, '2-of-3')):
            self.assertEqual(self.name(**variables), f'cornell.{name}.part', variables)
        self.assertEqual(self.name('auto/8', JOB_COMPLETION_INDEX='7'), 'cornell.8-of-8.part')
        self.assertEqual(self.name('auto/4', **slurm), 'cornell.3-of-4.part')

    def test_what_does_not_say_it(self):
        slurm = {'SLURM_PROCID': '2', 'SLURM_NTASKS': '4'}
        for shard, variables, message in (
                ('auto', self.array(5, 3, 1, 7), 'the part of this task is not known'),
                ('auto', {'SLURM_ARRAY_TASK_ID': '1'}, 'SLURM_ARRAY_TASK_COUNT is not set'),
                ('auto', {'JOB_COMPLETION_INDEX': '1'}, 'expected --shard auto/N'),
                ('auto/2', {'JOB_COMPLETION_INDEX': '2'}, 'process 2 (counted from 0) of 2'),
                ('auto/3', {'JOB_COMPLETION_INDEX': '1', 'PMI_RANK': '1', 'PMI_SIZE': '2'},
                 'has 2 processes, so the number of shards is a multiple of that, but it is 3; expected auto/4'),
                ('auto/3', {'JOB_COMPLETION_INDEX': '1', 'PMI_RANK': '1', 'PMI_SIZE': '0'}, 'of 0'),
                ('auto/5', slurm, 'there are 4 processes; expected 5'),
                ('auto', {'PMI_RANK': '', 'PMI_SIZE': '3'}, 'PMI_RANK is ""'),
                ('auto', {'PMI_RANK': '-1', 'PMI_SIZE': '3'}, 'PMI_RANK is "-1"'),
                ('auto', {'PMI_RANK': '3', 'PMI_SIZE': '3'}, 'process 3 (counted from 0) of 3')):
            self.refuse(message, *self.command('--shard', shard), **variables)
        self.refuse('expected %i in its name', *self.command('--shard', 'auto', '--checkpoint', 'a'), **slurm)

    def test_names(self):
        slurm = {'SLURM_PROCID': '2', 'SLURM_NTASKS': '4'}
        self.assertEqual(self.run_one(*self.command('--spp', '8', '--shard', 'auto', '-q', '--checkpoint',
                                                    'a.%i.%n%', '-o', 'a%i.exr'), **slurm).returncode, 0)
        self.assertEqual(set(os.listdir(self.folder.name)), {'a.3.4%', 'a3.exr'})


class Killed(Shards):
    def kill_after(self, seconds, arguments, number):
        process = subprocess.Popen([LAMPYRIS, *arguments], cwd=self.folder.name,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            _, stderr = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            _, stderr = process.communicate()
        self.assertIn(process.returncode, (0, -number, 128 + number), stderr)
        return process.returncode != 0

    def test_shards_go_on(self):
        """Shards are killed at random times, and the same command is repeated until they end."""
        whole = self.picture(self.command('--spp', '600', '--aov', 'all'), 'whole.exr')
        generator, kills = random.Random(9), 0
        while kills < KILLS:
            for i in (1, 2, 3):
                command = self.command('--spp', '600', '--aov', 'all', '--shard', f'{i}/3', '-q',
                                       '--checkpoint-every', '0', '--resume', '--wave', '1k')
                for _ in range(3):
                    number = generator.choice((signal.SIGKILL, signal.SIGTERM))
                    if not self.kill_after(generator.uniform(0.2, 1.5), command, number):
                        break
                    kills += 1
                self.succeed(*command)
            parts = [f'cornell.{i}-of-3.part' for i in (1, 2, 3)]
            self.assertEqual(self.picture(['merge', *parts], 'merged.exr'), whole)
            for part in parts:
                os.unlink(self.path(part))

    def test_merge_removes_what_killed_shards_left(self):
        """The lock of a killed shard, and old temporary files; not those of other runs that may still write."""
        parts = self.render_shards(2, '--spp', '8')
        process = subprocess.Popen([LAMPYRIS, *self.command('--spp', '1M', '--shard', '1/2', '--checkpoint', 'a',
                                                            '--checkpoint-every', '0', '-q')], cwd=self.folder.name)
        while not os.path.exists(self.path('a')):
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        process.kill()
        process.wait()
        os.rename(self.path(parts[0]), self.path('a'))
        for name, hours in (('.lampyris-1-0.tmp', 2), ('.lampyris-2-0.tmp', 0), ('.other.tmp', 2)):
            self.write(name, b'x')
            os.utime(self.path(name), (time.time() - 3600 * hours,) * 2)
        hidden = [name for name in os.listdir(self.folder.name) if name.startswith('.')]
        self.assertEqual(sum(name.endswith('.lock') for name in hidden), 1)
        self.succeed('merge', 'a', parts[1], '-o', 'm.exr', '-q')
        self.assertEqual({name for name in os.listdir(self.folder.name) if name.startswith('.')},
                         {'.lampyris-2-0.tmp', '.other.tmp'})

    def test_an_unfinished_part(self):
        """Either the samples of the part count and the others are missing, or the error says how to continue
        it."""
        command = self.command('--spp', '100k', '--shard', '1/2', '--checkpoint', 'a', '--checkpoint-every',
                               '0', '-q')
        self.assertTrue(self.kill_after(1.5, command, signal.SIGTERM))
        self.render('--spp', '100k', '--shard', '51200:51202', '--checkpoint', 'b')
        result = self.run_one('merge', 'a', 'b', '-o', 'z.exr')
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, '--shard 0:51200 --checkpoint a --resume|samples per pixel are missing')


@unittest.skipUnless(os.path.exists(SWIFTSHADER), 'there is no second driver')
class Mixed(Shards):
    def setUp(self):
        super().setUp()
        if SWIFTSHADER in os.environ.get('VK_DRIVER_FILES', ''):
            self.skipTest('runs on the second driver already')

    def render_elsewhere(self, *arguments):
        """Renders on the second driver."""
        result = self.run_one(*self.command(*arguments, '-q'), VK_DRIVER_FILES=SWIFTSHADER,
                              VK_ICD_FILENAMES=SWIFTSHADER)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_two_drivers(self):
        self.render('--spp', '64', '--shard', '1/2', '--checkpoint', 'a')
        self.render_elsewhere('--spp', '64', '--shard', '2/2', '--checkpoint', 'b')
        self.refuse('b: was made with device=', 'merge', 'a', 'b', '-o', 'z.exr')
        for pair in (['a', 'b'], ['b', 'a']):
            result = self.succeed('merge', *pair, '--mixed', '-o', 'm.exr', '--json', '-q',
                                  '--log-level', 'note')
            self.assertIn('the parts come from 2 devices', result.stderr)
            apart = float(re.search(r'(\d+\.\d+) standard errors apart', result.stderr).group(1))
            self.assertLess(apart, 3.3)
        self.succeed('merge', 'a', '--checkpoint', 'one', '-q')
        self.succeed('merge', 'one', 'b', '--mixed', '--checkpoint', 'sum', '-q')
        self.refuse('sum: has samples of several devices; expected --mixed', 'merge', 'sum', '-o', 'z.exr')
        # The sum keeps the names of its devices.
        report = json.loads(self.succeed('merge', 'a', '--partial', '-o', 'n.exr', '--json', '-q').stdout)
        name = f'{report["device"]} ({report["driver"]})'
        for parts in (['sum'], ['a', 'b']):
            result = self.succeed('merge', *parts, '--mixed', '-o', 'm.exr', '--json', '-q')
            device = json.loads(result.stdout)['device']
            self.assertIn('the parts come from 2 devices', result.stderr)
            self.assertNotIn('expected --device', result.stderr)
            self.assertIn('SwiftShader', device)
            self.assertTrue(device.startswith(f'several devices: {name}; '), device)
            self.assertIn(device.encode(), self.read('m.exr'))

    def test_few_samples(self):
        self.render('--spp', '9', '--shard', '0:8', '--checkpoint', 'a')
        self.render_elsewhere('--spp', '9', '--shard', '8:9', '--checkpoint', 'b')
        result = self.succeed('merge', 'a', 'b', '--mixed', '-o', 'm.exr', '-q')
        self.assertIn('cannot be compared, because SwiftShader', result.stderr)
        self.assertNotIn('nan', result.stderr)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
