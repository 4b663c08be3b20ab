#!/usr/bin/env python3
"""Renders with ranks that mpirun starts, and compares with the picture of one process, bit by bit.

Usage: test_ranks.py LAMPYRIS SCENE_FOLDER [--kills N] [--mpirun PROGRAM] [unittest arguments]
"""
import json
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
import unittest

from program import need_device
from test_shards import KILLS, LAMPYRIS, PLACES, SWIFTSHADER, Shards

MPIRUN = 'mpirun'
if '--mpirun' in sys.argv:
    at = sys.argv.index('--mpirun')
    MPIRUN = sys.argv[at + 1]
    del sys.argv[at:at + 2]


def is_open_mpi():
    try:
        return 'Open MPI' in subprocess.run([MPIRUN, '--version'], capture_output=True, text=True).stdout
    except FileNotFoundError:
        return False


OPEN_MPI = is_open_mpi()
RANKS = [MPIRUN]
if OPEN_MPI:
    RANKS += ['--oversubscribe', '--bind-to', 'none']
    if os.path.exists('/proc/self') and os.getuid() == 0:
        RANKS.append('--allow-run-as-root')


def children_of(pid):
    with open(f'/proc/{pid}/task/{pid}/children', encoding='ascii') as file:
        return [int(child) for child in file.read().split()]


def ranks_of(process):
    """Returns the processes that mpirun has started, whatever program each now runs."""
    children = children_of(process.pid)
    # MPICH's mpirun starts a proxy process for each machine, which starts the ranks.
    return children if OPEN_MPI else [rank for child in children for rank in children_of(child)]


class Ranks(Shards):
    def mpi(self, count, *command):
        return [*RANKS, '-n', str(count), LAMPYRIS, *command]

    def run_ranks(self, count, *command, **variables):
        env = {name: value for name, value in os.environ.items() if not PLACES.match(name)}
        return subprocess.run(self.mpi(count, *command), cwd=self.folder.name, env={**env, **variables},
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300)

    def told(self, result, name):
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        looks = [{key: value for key, value in look.items() if key != 'seconds'} for look in report['looks']]
        return report['image_hash'], self.layers(name), report['rays'], report['spp'], looks, report['ended_by']

    def of_ranks(self, count, *arguments, **options):
        return self.told(self.run_ranks(count, *self.command(*arguments, **options), '-o', 'ranks.exr', '--json', '-q'),
                         'ranks.exr')

    def of_one(self, *arguments, **options):
        return self.told(self.run_one(*self.command(*arguments, **options), '-o', 'one.exr', '--json', '-q'), 'one.exr')

    def check(self, *arguments, counts=(3,), **options):
        one = self.of_one(*arguments, **options)
        for count in counts:
            self.assertEqual(self.of_ranks(count, *arguments, **options), one)


class Bits(Ranks):
    def test_samples(self):
        self.check('--spp', '57', '--aov', 'all', '--error-by', 'part,bounce,emitter', counts=(2, 3, 5))
        self.check('--spp', '1', counts=(3,))

    def test_light_paths(self):
        self.check('--spp', '57', '--integrator', 'bidir', '--aov', 'depth,ids', counts=(3,))
        self.check('--error', '5e-3', '--integrator', 'bidir', size='40x36')
        self.check('--spp', '8', '--integrator', 'auto', counts=(2,), scene='all_classes')

    def test_error(self):
        self.check('--error', '2e-3', '--aov', 'depth,ids', size='40x36')

    def test_a_larger_picture_and_another_sampler(self):
        self.check('--spp', '24', '--sampler', 'blue-noise', size='200x150', scene='glass')

    def test_a_checkpoint_of_ranks_goes_on_alone_and_back(self):
        whole = self.of_one('--spp', '300')
        self.of_ranks(3, '--spp', '90', '--checkpoint', 'ck')
        self.of_one('--spp', '200', '--checkpoint', 'ck', '--resume')
        picture = self.of_ranks(2, '--spp', '300', '--checkpoint', 'ck', '--resume')
        self.assertEqual(picture, whole)

    def test_one_summary(self):
        result = self.run_ranks(3, *self.command('--spp', '400', '-o', 'a.exr'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.count('\nwrote '), 1)
        lines = re.findall(r'^rank   (\d)  .*: (\d+) samples a pixel, .* Msamples/s, busy \d+ %$', result.stdout, re.M)
        self.assertEqual([line[0] for line in lines], ['0', '1', '2'])
        self.assertEqual(sum(int(line[1]) for line in lines), 400)

    def test_ranks_of_one_device_divide_its_memory(self):
        result = self.run_ranks(3, *self.command('--spp', '40', '-o', 'a.exr', size='200x150'),
                                LAMPYRIS_LIMITS='memory-budget=20000000')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('MiB on the device (one of 3 that share its memory)', result.stdout)
        result = self.run_ranks(2, *self.command('--spp', '40', '-o', 'a.exr', size='200x150'),
                                LAMPYRIS_LIMITS='memory-budget=8000000')
        self.assertIn('left for each of the 2 that share it', result.stderr)
        self.assertNotEqual(result.returncode, 0)

    def test_shards_are_rendered_by_each_process_alone(self):
        result = self.run_ranks(3, *self.command('--spp', '40', '--shard', 'auto', '-q'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(Shards.picture(self, ['merge', *(f'cornell.{i}-of-3.part' for i in (1, 2, 3))], 'merged.exr'),
                         Shards.picture(self, self.command('--spp', '40'), 'whole.exr'))


class Ends(Ranks):
    def test_what_cannot_be_shared_is_refused(self):
        for arguments, message in ((['--adaptive', 'on', '--spp', '64'], 'cannot be combined with --adaptive on'),
                                   (['--frames', '3'], 'cannot be combined with --frames'),
                                   (['--device', '77'], "no device has the index or name '77'")):
            result = self.run_ranks(2, *self.command(*arguments, '-o', 'z.exr'))
            # mpirun of Open MPI 4.1 may crash while it reports failed ranks.
            if 'orte_rml_oob_send_buffer_nb' not in result.stderr:
                self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(message, result.stderr)

    def test_a_refusal_is_not_a_lost_rank(self):
        self.write('ck', b'x')
        result = self.run_ranks(3, *self.command('--spp', '200', '--checkpoint', 'ck', '-q', '-o', 'z.exr'))
        self.assertIn('ck: exists already; expected --resume', result.stderr)
        self.assertNotIn('if rank 0 was lost', result.stderr)

    def test_ranks_with_different_commands(self):
        command = self.command('-o', 'z.exr', '--spp', '40')
        one = ['-n', '1', LAMPYRIS, *command]
        result = subprocess.run([*RANKS, *one, ':', *one, '--seed', '2'], cwd=self.folder.name, text=True, timeout=120,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn('rank 1 has another command line', result.stderr)

    def test_without_the_program_for_ranks(self):
        shutil.copy(LAMPYRIS, self.path('lampyris'))
        result = self.run_one(*self.command('-o', 'z.exr'), OMPI_COMM_WORLD_SIZE='3')
        self.assertIn('the mpirun of the MPI that lampyris-mpi was built with', result.stderr)
        alone = subprocess.run([self.path('lampyris'), *self.command('-o', 'z.exr')], cwd=self.folder.name, text=True,
                               env={**os.environ, 'OMPI_COMM_WORLD_SIZE': '3', 'PATH': '/usr/bin'},
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(alone.returncode, 3)
        self.assertIn('this is one of 3 processes', alone.stderr)

    def test_one_of_several_processes_that_do_not_know_each_other_says_so(self):
        environment = {name: value for name, value in os.environ.items() if not PLACES.match(name)}
        processes = [subprocess.Popen([LAMPYRIS, *self.command('-o', 'z.exr')], cwd=self.folder.name, text=True,
                                      env={**environment, 'OMPI_COMM_WORLD_SIZE': '2', 'PMI_RANK': str(rank)},
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE) for rank in (1, 0)]
        self.addCleanup(lambda: [process.poll() is None and process.kill() for process in processes])
        self.assertIn('2 processes were started, but MPI knows 1', processes[1].communicate(timeout=60)[1])
        self.assertEqual(processes[0].communicate(timeout=60), ('', ''))
        self.assertEqual([process.returncode for process in processes], [2, 2])

    def start(self, *arguments, launcher=(), **options):
        command = self.command(*arguments, '-q', '-o', 'killed.exr', **options)
        process = subprocess.Popen([*RANKS, *launcher, '-n', '3', LAMPYRIS, *command], cwd=self.folder.name, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        return process

    def test_a_signal_stops_all(self):
        """mpirun forwards SIGUSR1. The picture then has fewer samples."""
        process = self.start('--spp', '1M', '--checkpoint', 'ck', '--checkpoint-every', '0.2')
        while not os.path.exists(self.path('ck')):
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        process.send_signal(signal.SIGUSR1)
        _, stderr = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 138, stderr)
        self.assertIn('killed.exr', os.listdir(self.folder.name))

    def test_killed_ranks(self):
        """A rank is killed at random times, and the command is repeated until the render ends. No sample is
        lost."""
        arguments = ('--spp', '6000', '--aov', 'all')
        one = self.of_one(*arguments)
        generator, kills = random.Random(3), 0
        while kills < KILLS:
            process = self.start(*arguments, '--checkpoint', 'ck', '--checkpoint-every', '0', '--resume')
            end = time.monotonic() + generator.uniform(0.3, 4.0)
            while process.poll() is None and time.monotonic() < end:
                time.sleep(0.02)
            if process.poll() is None and (ranks := ranks_of(process)):
                os.kill(generator.choice(ranks), signal.SIGKILL)
                kills += 1
            _, stderr = process.communicate(timeout=120)
            if process.returncode == 0:
                os.unlink(self.path('ck'))
        picture = self.of_ranks(3, *arguments, '--checkpoint', 'ck', '--resume')
        self.assertEqual(picture[:2] + picture[3:], one[:2] + one[3:])

    @unittest.skipUnless(OPEN_MPI, "MPICH's mpirun kills all ranks at once")
    def test_a_lost_rank_is_answered_with_the_command(self):
        process = self.start('--spp', '1M', '--checkpoint', 'ck', '--checkpoint-every', '0.2', size='100x80')
        while not os.path.exists(self.path('ck')):
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        os.kill(ranks_of(process)[2], signal.SIGKILL)
        _, stderr = process.communicate(timeout=120)
        self.assertNotEqual(process.returncode, 0)
        self.assertRegex(stderr, 'continues from the last checkpoint and the saved blocks, with or without mpirun: '
                                 'lampyris render .* --resume')

    def saved_blocks(self):
        return sorted(name for name in os.listdir(self.folder.name) if name.startswith('ck.blocks-'))

    def wait_for(self, process, is_so):
        while not is_so():
            self.assertIsNone(process.poll(), process.stderr)
            time.sleep(0.005)

    def wait_for_end(self, process, ranks):
        _, stderr = process.communicate(timeout=120)
        while any(os.path.exists(f'/proc/{pid}') for pid in ranks): # mpirun does not wait for all of them
            time.sleep(0.01)
        return stderr

    def go_on(self):
        """Resumes with three ranks to a few samples more: only those that are in no file are rendered. Returns the
        samples of the files."""
        status = json.loads(self.run_one('merge', '--status', '--json', *self.saved_blocks()).stdout)
        held = [tuple(map(int, part.split(':'))) for file in status['parts'] for part in file['has'].split(',')]
        samples = max(end for _, end in held) + 64
        one = self.of_one('--spp', str(samples))
        before = os.path.exists(self.path('ck'))
        result = self.run_ranks(3, *self.command('--spp', str(samples), '--checkpoint', 'ck', '--resume', '-o',
                                                 'ranks.exr', '--json', '-q'))
        picture = self.told(result, 'ranks.exr')
        self.assertEqual(picture[:2] + picture[3:], one[:2] + one[3:])
        self.assertIn('samples per pixel are added, which ranks of a lost run had saved', result.stderr)
        self.assertEqual(self.saved_blocks(), [])
        rendered = sum(member['spp'] for member in json.loads(result.stdout)['members'])
        if not before or held[0][0] == 0: # otherwise the checkpoint has more
            self.assertEqual(rendered, samples - sum(end - first for first, end in held))
        return sorted(held)

    @unittest.skipUnless(OPEN_MPI, "MPICH's mpirun kills all ranks at once")
    def test_ranks_that_survive_save_what_they_have_finished(self):
        """Whichever rank is killed, the files of the others have all samples of their finished blocks."""
        for victim in (2, 0):
            process = self.start('--spp', '1M', '--checkpoint', 'ck', '--checkpoint-every', '1',
                                 launcher=('--mca', 'odls_base_sigkill_timeout', '10'))
            self.wait_for(process, lambda: os.path.exists(self.path('ck')))
            time.sleep(0.7)
            ranks = ranks_of(process)
            os.kill(ranks[victim], signal.SIGKILL)
            stderr = self.wait_for_end(process, ranks)
            self.assertIn('continues from the last checkpoint and the saved blocks', stderr)
            self.assertEqual('ck.blocks-0' in self.saved_blocks(), victim != 0)
            self.assertIn(len(self.saved_blocks()), (1, 2)) # a rank without a block since the checkpoint has none
            self.go_on()
            os.unlink(self.path('ck'))

    def test_no_finished_block_is_lost_if_each_is_saved(self):
        """Neither with --checkpoint-every 0 if all ranks and mpirun are killed at once."""
        process = self.start('--spp', '1M', '--checkpoint', 'ck', '--checkpoint-every', '0')
        self.wait_for(process, lambda: len(self.saved_blocks()) == 3)
        ranks = ranks_of(process)
        for pid in (process.pid, *ranks):
            os.kill(pid, signal.SIGKILL)
        self.wait_for_end(process, ranks)
        held = self.go_on()
        end = max(range_[1] for range_ in held)
        gaps = sum(a[1] < b[0] for a, b in zip([(0, 0), *held], held))
        # The blocks that were not finished: two of each worker and one of rank 0.
        self.assertLessEqual(gaps, 5)
        self.assertGreater(sum(b - a for a, b in held), end // 2)

    def test_saved_blocks_of_another_render_are_left_out(self):
        one = self.of_one('--spp', '3000')
        process = self.start('--spp', '1M', '--seed', '7', '--checkpoint', 'ck', '--checkpoint-every', '0')
        self.wait_for(process, lambda: len(self.saved_blocks()) == 3)
        ranks = ranks_of(process)
        for pid in (process.pid, *ranks):
            os.kill(pid, signal.SIGKILL)
        self.wait_for_end(process, ranks)
        if os.path.exists(self.path('ck')):
            os.unlink(self.path('ck'))
        names = self.saved_blocks()
        damaged = bytearray(self.read(names[-1]))
        damaged[-50] ^= 1
        self.write(names[-1], damaged)
        result = self.run_one(*self.command('--spp', '3000', '--checkpoint', 'ck', '--resume', '-o', 'one.exr', '--json',
                                            '-q'))
        self.assertEqual(self.told(result, 'one.exr')[:2], one[:2])
        self.assertIn('these samples are rendered again', result.stderr)
        self.assertIn('seed', result.stderr)
        self.assertEqual(self.saved_blocks(), [])
        kept = [name.replace('ck.blocks', 'ck.unused-blocks') for name in names]
        self.assertTrue(set(kept) <= set(os.listdir(self.folder.name)), os.listdir(self.folder.name))
        self.assertEqual(self.read(kept[-1]), damaged)

    def test_saved_blocks_need_resume(self):
        """A run without --resume, of ranks or of one process, is refused and changes no file."""
        self.write('ck.blocks-0', b'x')
        self.write('ck.blocks-64', b'y')
        command = self.command('--spp', '200', '--checkpoint', 'ck', '--checkpoint-every', '0', '-o', 'z.exr', '-q')
        self.refuse('exists already, with samples that a rank of a lost run has saved; expected --resume', *command)
        self.assertIn('expected --resume', self.run_ranks(3, *command).stderr)
        self.assertEqual((self.read('ck.blocks-0'), self.read('ck.blocks-64')), (b'x', b'y'))
        adaptive = self.command('--spp', '64', '--adaptive', 'on', '--checkpoint', 'ck', '--resume', '-q', '-o', 'a.exr')
        self.succeed(*adaptive) # it cannot have such files, and leaves them
        self.assertEqual((self.read('ck.blocks-0'), self.read('ck.blocks-64')), (b'x', b'y'))

    def test_a_lost_rank_loses_little(self):
        """Checkpoints come by themselves, so often that a rank that is lost, be it the one that writes them, takes
        little with it; the message says the command that goes on, and that gives the picture of one process."""
        arguments = ('--spp', '12000')
        one = self.of_one(*arguments)
        for victim in (0, 2):
            process = self.start(*arguments, '--checkpoint', 'ck')
            seen = set()
            while process.poll() is None and len(seen) < 2:
                if os.path.exists(self.path('ck')):
                    seen.add(os.stat(self.path('ck')).st_ino)
                time.sleep(0.002)
            self.assertIsNone(process.poll())
            ranks = ranks_of(process)
            os.kill(ranks[victim], signal.SIGKILL)
            _, stderr = process.communicate(timeout=120)
            self.assertNotEqual(process.returncode, 0)
            while any(os.path.exists(f'/proc/{pid}') for pid in ranks): # mpirun does not wait for all of them
                time.sleep(0.01)
            # MPICH's mpirun kills all ranks at once, so that none can say anything.
            command = shlex.join(self.command(*arguments, '-q', '-o', 'killed.exr', '--checkpoint', 'ck', '--resume'))
            if OPEN_MPI:
                told = re.search('continues from the last checkpoint and the saved blocks, with or without mpirun: '
                                 'lampyris (render .* --resume)', stderr)
                self.assertTrue(told, stderr)
                command = told[1]
            picture = self.told(self.run_one(*shlex.split(command), '--json'), 'killed.exr')
            self.assertEqual(picture[:2] + picture[3:], one[:2] + one[3:])
            os.unlink(self.path('ck'))


@unittest.skipUnless(os.path.exists(SWIFTSHADER), 'there is no second driver')
class Mixed(Ranks):
    def test_two_drivers(self):
        own = os.environ.get('VK_DRIVER_FILES', '/usr/share/vulkan/icd.d/lvp_icd.x86_64.json')
        if SWIFTSHADER in own:
            self.skipTest('runs on the second driver already')
        both = f'{own}:{SWIFTSHADER}'
        result = self.run_ranks(2, *self.command('--spp', '2000', '-q', '--json', '-o', 'a.exr', '--device', '0,1'),
                                VK_DRIVER_FILES=both, VK_ICD_FILENAMES=both)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('does not have the bits that one of them would make alone', result.stderr)
        self.assertEqual(len({member['driver'] for member in json.loads(result.stdout)['members']}), 2)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    if not shutil.which(MPIRUN):
        print(MPIRUN + ' is not installed (Debian: openmpi-bin or mpich)', file=sys.stderr)
        sys.exit(77)
    unittest.main()
