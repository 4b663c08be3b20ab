#!/usr/bin/env python3
"""Renders under Slurm with lampyris submit, if Slurm can be started here, and compares with the picture of
one process.

Usage: test_submit.py LAMPYRIS SCENE_FOLDER [unittest arguments]
"""
import json
import os
import re
import shlex
import stat
import subprocess
import sys
import tempfile
import unittest

import slurm
from program import need_device
from test_shards import LAMPYRIS, PLACES, SCENES, Shards


class Files(Shards):
    """Tests the files and the output of `submit` without Slurm."""

    def submit(self, *arguments, code=0, **variables):
        result = self.run_one('submit', *self.command(*arguments)[1:], **variables)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def fake_sbatch(self, text):
        os.mkdir(self.path('bin'))
        self.write('bin/sbatch', f'#!/bin/sh\n{text}\n'.encode())
        os.chmod(self.path('bin/sbatch'), stat.S_IRWXU)
        return {'PATH': self.path('bin') + ':' + os.environ['PATH']}

    def test_dry_run(self):
        result = self.submit('--spp', '40', '--parts', '12', '--dry-run', '-o', 'a b.exr', '--aov', 'depth', '-q',
                             '--slurm', '--partition=gpu --time=5')
        self.assertEqual(result.stdout + result.stderr, '')
        self.assertEqual(set(os.listdir(self.folder.name)), {'cornell.shards.sh', 'cornell.merge.sh'})
        shards, merge = self.read('cornell.shards.sh').decode(), self.read('cornell.merge.sh').decode()
        for line in ('#SBATCH --array=1-12', '#SBATCH --requeue', '#SBATCH --partition=gpu --time=5'):
            self.assertIn(line + '\n', shards)
        self.assertIn('#SBATCH --partition=gpu --time=5\n', merge)
        self.assertRegex(merge, r"merge --expect [0-9a-f]{16} cornell\.\[0-9\]\[0-9\]-of-12\.part -o 'a b\.exr'\n$")
        self.assertIn('--size 20x18 --spp 40 --aov depth --shard "$SLURM_ARRAY_TASK_ID/12" --resume', shards)
        told = self.submit('--spp', '40', '--parts', '12', '--dry-run').stdout
        self.assertIn('sbatch --dependency=afterany:$(sbatch --parsable cornell.shards.sh) cornell.merge.sh', told)
        self.assertNotIn('partition', self.read('cornell.shards.sh').decode())

    def run_file(self, name, **variables):
        """Runs a batch file as Slurm does."""
        return subprocess.run(['sh', name], cwd=self.folder.name, env={**os.environ, **variables}, timeout=120,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run_tasks(self, count, stem='cornell', code=0):
        for task in range(count, 0, -1):
            result = self.run_file(f'{stem}.shards.sh', SLURM_ARRAY_TASK_ID=str(task))
            self.assertEqual(result.returncode, code, result.stderr)

    def test_the_files_render_the_picture(self):
        whole = self.picture(self.command('--spp', '40'), 'whole.exr')
        self.submit('--spp', '40', '--parts', '3', '--dry-run', '-o', 'merged.exr')
        self.run_tasks(3)
        self.assertEqual(self.run_file('cornell.merge.sh').returncode, 0)
        merged = self.picture(['merge', *(f'cornell.{i}-of-3.part' for i in (1, 2, 3))], 'again.exr')
        self.assertEqual(merged, whole)
        self.assertEqual(self.layers('merged.exr'), self.layers('whole.exr'))

    def test_the_merge_knows_its_parts(self):
        """submit computes their hash without a device, and before an integrator is chosen."""
        for arguments in (['--integrator', 'auto'], ['--integrator', 'bidir', '--aov', 'depth'],
                          ['--aov', 'all', '--sampler', 'pcg', '--error-by', 'part'],
                          ['--shard-by', 'tiles', '--adaptive', 'on', '--size', '4x32'],
                          ['--device', '0,0', '--env', 'sky:elevation=30', '--seed', '7']):
            with self.subTest(arguments):
                self.setUp()
                self.submit('--spp', '48', '--parts', '2', '--dry-run', '-q', '-o', 'a.exr', *arguments)
                self.run_tasks(2)
                result = self.run_file('cornell.merge.sh')
                self.assertEqual(result.returncode, 0, result.stderr)
                # The array may be submitted again.
                self.submit('--spp', '48', '--parts', '2', '--dry-run', '-q', '-o', 'a.exr', *arguments)

    def test_parts_of_an_earlier_render_are_refused(self):
        earlier = ('--spp', '8', '--parts', '2', '--dry-run', '-q', '-o', 'a.exr')
        self.submit(*earlier)
        self.run_tasks(2)
        for arguments, message in ((['--seed', '2'], 'was made with --seed=0, but this render has 2'),
                                   (['--spp', '16'], 'was made with --spp=8, but this render has 16'),
                                   (['--shard-by', 'tiles', '--size', '20x32'], 'was made with --size=20x18')):
            told = self.submit(*earlier, *arguments, code=2).stderr
            self.assertIn('cornell.1-of-2.part: ' + message, told)
            self.assertIn('expected no parts of another render: remove them, or submit from another folder', told)
        # Parts that appear after the submission.
        for arguments in (['--seed', '2'], ['--spp', '16']):
            os.mkdir(self.path('hidden'))
            for i in (1, 2):
                os.rename(self.path(f'cornell.{i}-of-2.part'), self.path(f'hidden/{i}'))
            self.submit(*earlier, '-o', 'z.exr', *arguments)
            for i in (1, 2):
                os.rename(self.path(f'hidden/{i}'), self.path(f'cornell.{i}-of-2.part'))
            os.rmdir(self.path('hidden'))
            self.run_tasks(2, code=2)
            result = self.run_file('cornell.merge.sh')
            self.assertEqual(result.returncode, 2)
            self.assertIn('cornell.1-of-2.part: is a part of another render, or of another number of samples',
                          result.stderr)
            self.assertNotIn('z.exr', os.listdir(self.folder.name))
        self.write('cornell.2-of-2.part', b'nothing')
        self.assertIn('cornell.2-of-2.part', self.submit(*earlier, code=2).stderr)

    def test_parts_of_other_scenes_are_not_taken(self):
        with open(os.path.join(SCENES, 'cornell.json'), 'rb') as file:
            scene = file.read()
        stems = ('room', 'room.night', 'room.1', '-room', '--my room')
        for seed, stem in enumerate(stems):
            self.write(stem + '.json', scene)
            told = self.run_one('submit', '--size', '8x8', '--spp', '24', '--parts', '12', '--seed', str(seed), '-o',
                                f'./{stem}.exr', '--dry-run', '--', stem + '.json')
            self.assertEqual(told.returncode, 0, told.stderr)
        for stem in stems:
            self.run_tasks(12, './' + stem)
        for stem in stems:
            result = self.run_file(f'./{stem}.merge.sh')
            self.assertEqual(result.returncode, 0, result.stderr)
        status, = re.findall('^status    lampyris (.*)$', told.stdout, re.MULTILINE)
        self.assertEqual(status, "merge --status ./'--my room'.[0-9][0-9]-of-12.part")
        result = subprocess.run(f'{shlex.quote(LAMPYRIS)} {status}', shell=True, cwd=self.folder.name, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('complete  all 24 samples per pixel\n', result.stdout)

    def test_what_sbatch_answers(self):
        path = self.fake_sbatch('echo "$@" >> calls; echo "$((40 + $(wc -l < calls)));north"')
        result = self.submit('--spp', '40', '--parts', '2', **path)
        self.assertIn('shards    job 41;north, 2 of them: cornell.[0-9]-of-2.part\n', result.stdout)
        self.assertIn('queue     squeue --job 41,42\n', result.stdout)
        self.assertEqual(self.read('calls').decode().splitlines(), [
            '--parsable cornell.shards.sh', '--parsable --dependency=afterany:41 cornell.merge.sh'])
        report = json.loads(self.submit('--spp', '40', '--parts', '2', '--json', **path).stdout)
        self.assertEqual((report['shards']['job'], report['merge']['job'], report['count']), ('43;north', '44;north', 2))

    def test_failures_of_sbatch(self):
        path = self.fake_sbatch('echo "sbatch: error: invalid partition" >&2; exit 1')
        self.assertIn('invalid partition\nlampyris: error: sbatch refused cornell.shards.sh',
                      self.submit('--spp', '40', '--parts', '2', code=3, **path).stderr)
        self.write('bin/sbatch', b'#!/bin/sh\necho hello\n')
        self.assertIn('sbatch answered "hello"', self.submit('--spp', '40', '--parts', '2', code=3, **path).stderr)
        os.unlink(self.path('bin/sbatch'))
        self.assertIn('sbatch is not in PATH: cornell.shards.sh was written',
                      self.submit('--spp', '40', '--parts', '2', code=3, PATH=self.path('bin')).stderr)

    def test_what_a_shard_would_refuse_is_refused(self):
        for arguments, message in (
                ([], 'submit needs --parts N'), (['--parts', '0'], '"0" is outside'),
                (['--parts', '3', '--spp', '4'], 'expected at most 2 shards'),
                (['--parts', '2', '--error', '1'], 'has no option --error'),
                (['--parts', '2', '--halves', 'contiguous'], '--shard cannot be combined with --halves'),
                (['--parts', '2', '--integrator', 'bidir', '--aov', 'all'], 'bidir cannot have the layers'),
                (['--parts', '2', '--integrator', 'bidir', '--error-by', 'part'], 'bidir cannot have the layers'),
                (['--parts', '1', '--integrator', 'bidir', '--shard-by', 'tiles', '--adaptive', 'on', '--spp', '48'],
                 'bidir cannot have --adaptive'),
                (['--parts', '2', '--split-lobes', '2', '--directions', 'cosine'], 'needs --directions bsdf'),
                (['--parts', '1', '--shard-by', 'tiles', '--adaptive', 'on', '--spp', '48', '--device', '0,1'],
                 'several devices (--device)'),
                (['--parts', '2', '--resume'], 'has no option --resume'),
                (['--parts', '2', '--slurm', 'a\nb'], '--slurm: has a line break')):
            self.assertIn(message, self.submit('--dry-run', *arguments, code=2).stderr)
        self.assertEqual(os.listdir(self.folder.name), [])
        self.write('cornell.shards.sh', b'#!/bin/sh\necho mine\n')
        self.assertIn('was not written by lampyris submit', self.submit('--parts', '2', '--dry-run', code=2).stderr)
        self.assertEqual(self.read('cornell.shards.sh'), b'#!/bin/sh\necho mine\n')

    def test_a_picture_that_the_merge_cannot_write_is_refused(self):
        """Before anything is submitted, and not when the shards have rendered for hours."""
        path = self.fake_sbatch('echo "$@" >> calls; echo 41')
        self.write('file', b'')
        for output, code, message in (('missing/out.exr', 4, 'missing/out.exr: cannot create a file in its folder'),
                                      ('file/out.exr', 4, 'file/out.exr: cannot'), ('bin', 2, 'bin'),
                                      ('bin/', 2, ''), ('a.tga', 2, 'a.tga')):
            self.assertIn(message, self.submit('--parts', '2', '-o', 'a.exr', '-o', output, code=code, **path).stderr)
        self.assertIn('layers go into EXR files', self.submit('--parts', '2', '--aov', 'depth', '-o', 'a.png', code=2).stderr)
        self.assertEqual(set(os.listdir(self.folder.name)), {'bin', 'file'})

    def test_exit_codes_are_those_of_the_help(self):
        parts = self.render_shards(2, '--spp', '8')
        damaged = bytearray(self.read(parts[1]))
        damaged[-100] ^= 1
        self.write('damaged', damaged)
        os.mkdir(self.path('folder.exr'))
        for code, *arguments in ((0, *parts), (0, *parts, '--status'), (1, parts[0], '--status'), (2, parts[0]),
                                 (2, parts[0], 'damaged'), (0, parts[0], 'damaged', '--status'), (2, '--status', 'nowhere'),
                                 (2, *parts, '-o', 'a.tga'), (4, *parts, '-o', 'missing/a.exr'),
                                 (4, *parts, '-o', 'folder.exr'), (4, *parts, '--checkpoint', 'missing/sum'),
                                 (2, *parts, '--device', '77')):
            result = self.run_one('merge', *arguments)
            self.assertEqual(result.returncode, code, (arguments, result.stderr))
        self.assertEqual(self.run_one('merge', *parts, LAMPYRIS_LIMITS='memory-budget=1000').returncode, 3)
        nowhere = self.path('nowhere.json')
        self.assertEqual(self.run_one('merge', *parts, VK_DRIVER_FILES=nowhere, VK_ICD_FILENAMES=nowhere).returncode, 69)
        for text in (self.run_one('merge', '--help').stdout, self.run_one('merge', '--help-all').stdout):
            text = re.sub(r'\s+', ' ', text[text.index('EXIT STATUS'):])
            for words in ('0 The picture, or the sum, was written; with --status, no sample is missing.',
                          '1 Only with --status: samples are missing.', 'samples are missing (without --partial)',
                          '3 The device', '4 The picture or the sum could not be written.'):
                self.assertIn(words, text)
        self.assertIn('headers of the parts', re.sub(r'\s+', ' ', self.run_one('merge', '--help-all').stdout))

    def test_status(self):
        parts = self.render_shards(4, '--spp', '32')
        result = self.succeed('merge', '--status', *parts)
        self.assertIn('part      2.part: samples 8:16, finished, 100 %\n', result.stdout)
        self.assertIn('complete  all 32 samples per pixel\n', result.stdout)
        result = self.run_one('merge', '--status', parts[0], parts[3])
        self.assertEqual((result.returncode, result.stderr), (1, ''))
        self.assertIn('missing   16 of 32 samples per pixel (8:24)\n', result.stdout)
        for command in re.findall('^lampyris (render .*)$', result.stdout, re.MULTILINE):
            self.succeed(*shlex.split(command), '-q')
        made = [name for name in os.listdir(self.folder.name) if name.startswith('cornell.')]
        report = json.loads(self.succeed('merge', '--status', '--json', parts[0], parts[3], *made).stdout)
        self.assertEqual((report['missing'], report['unclaimed'], len(report['parts'])), ('none', 'none', 4))
        self.assertEqual(self.run_one('merge', '--status', parts[0], '-o', 'z.exr').returncode, 2)

    def test_status_of_an_unfinished_part(self):
        process = subprocess.Popen([LAMPYRIS, *self.command('--spp', '1M', '--shard', '1/2', '--checkpoint', 'a',
                                                            '--checkpoint-every', '0', '-q')], cwd=self.folder.name)
        while not os.path.exists(self.path('a')):
            self.assertIsNone(process.poll())
        process.terminate()
        process.wait()
        result = self.run_one('merge', '--status', 'a')
        self.assertEqual((result.returncode, result.stderr), (1, ''))
        self.assertRegex(result.stdout, 'part      a: samples 0:524288, unfinished, \\d+ %')
        self.assertIn('some missing ones belong to none of these parts', result.stdout)
        self.assertIn('--shard 524288:1048576\n', result.stdout)


WHY_NOT = slurm.why_not()


@unittest.skipIf(WHY_NOT, WHY_NOT)
class Slurm(Shards):
    TIMEOUT = 900 # its renders take minutes, and longer if the machine becomes busier than when it was measured

    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.cluster = slurm.Cluster(cls.place.name)
        try:
            cls.cluster.start()
        except BaseException:
            cls.tearDownClass()
            raise

    @classmethod
    def tearDownClass(cls):
        cls.cluster.stop()
        cls.place.cleanup()

    def submit(self, parts, *arguments):
        env = {name: value for name, value in self.cluster.env.items() if not PLACES.match(name)}
        env['SLURM_CONF'] = self.cluster.env['SLURM_CONF']
        result = subprocess.run([LAMPYRIS, 'submit', *self.command(*arguments)[1:], '--parts', str(parts), '--json',
                                 '-o', 'merged.exr'], cwd=self.folder.name, env=env, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        return report['shards']['job'], report['merge']['job']

    def logs(self):
        return ''.join(f'--- {name}\n' + self.read(name).decode() for name in os.listdir(self.folder.name)
                       if name.endswith('.log'))

    def check(self, jobs, parts, whole, has_pilots=False):
        self.assertEqual(self.cluster.wait_for_end(jobs[1]), ['COMPLETED'], self.logs())
        self.assertEqual(self.cluster.states(jobs[0]), ['COMPLETED'] * parts, self.logs())
        self.assertEqual(self.layers('merged.exr'), self.layers('whole.exr'))
        names = [f'cornell.{i}-of-{parts}.part' for i in range(1, parts + 1)]
        again = self.picture(['merge', *names], 'again.exr')
        # Each part by tiles of an adaptive render has rays of its own pilot.
        self.assertEqual((*again[:2], again[3]) if has_pilots else again,
                         (*whole[:2], whole[3]) if has_pilots else whole)

    def test_an_array_of_5(self):
        for arguments in (['--spp', '57', '--aov', 'all'],
                          ['--spp', '57', '--aov', 'depth,ids', '--integrator', 'bidir']):
            with self.subTest(arguments):
                self.setUp()
                whole = self.picture(self.command(*arguments), 'whole.exr')
                self.check(self.submit(5, *arguments), 5, whole)

    def test_an_array_by_tiles(self):
        arguments = ['--spp', '48', '--adaptive', 'on', '--aov', 'all', '--size', '20x80']
        whole = self.picture(self.command(*arguments), 'whole.exr')
        self.check(self.submit(5, '--shard-by', 'tiles', *arguments), 5, whole, has_pilots=True)

    def samples_that_take(self, seconds):
        """Measures the speed of this machine. Returns a size and a number of samples that take one process at least
        so many seconds."""
        for size in ('20x18', '200x180', '2000x1800'):
            speeds = []
            for _ in range(2):
                report = json.loads(self.run_one(*self.command('--time', '2', '--json', '-q', '-o', 'speed.exr',
                                                               size=size)).stdout)
                speeds.append(report['spp'] / report['seconds']['render'])
            samples = int(max(speeds) * seconds) // 2 * 2
            if samples < 4 << 20:
                break
        return '--size', size, '--spp', str(max(samples, 400))

    def wait_until_both_render(self, job):
        self.cluster.wait(lambda: self.cluster.states(job) == ['RUNNING'] * 2, 'running tasks')
        # A part has a lock file beside it while it is rendered.
        self.cluster.wait(lambda: sum(name.endswith('.lock') for name in os.listdir(self.folder.name)) == 2,
                          'rendering shards')

    def test_preempted_shards_go_on(self):
        arguments = self.samples_that_take(20)
        whole = self.picture(self.command(*arguments), 'whole.exr')
        jobs = self.submit(2, *arguments)
        self.wait_until_both_render(jobs[0])
        other = self.cluster.output('sbatch', '--parsable', '--partition=high', '--cpus-per-task=2', '--output=/dev/null',
                                    '--wrap', 'true').strip()
        self.assertEqual(self.cluster.wait_for_end(other), ['COMPLETED'])
        self.check(jobs, 2, whole)
        self.assertIn('DUE TO PREEMPTION', self.logs())
        # A task that starts from the beginning reports that; each of the two did so once.
        self.assertEqual(self.logs().count('rendering begins anew'), 2)

    def test_tasks_go_on_after_their_time(self):
        """Slurm's shortest time limit is a minute, and it checks every half minute whether to signal
        tasks."""
        # The signal comes after at most 35 s, when each shard alone needs 45 s of the whole machine.
        arguments = self.samples_that_take(90)
        whole = self.picture(self.command(*arguments), 'whole.exr')
        jobs = self.submit(2, *arguments, '--slurm', '--time=1 --signal=B:USR1@55')
        self.check(jobs, 2, whole)
        self.assertIn('DUE TO JOB REQUEUE', self.logs())
        self.assertEqual(self.logs().count('rendering begins anew'), 2)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
