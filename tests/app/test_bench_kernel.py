"""Tests lampyris bench --kernel, which times a single kernel on the queues that it gets in a render.

    test_bench_kernel.py LAMPYRIS
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import program

LAMPYRIS = sys.argv.pop(1)
SCENES = os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'scenes')
CORNELL = os.path.join(SCENES, 'cornell.json')
SMALL = ['--size', '16x16', '--spp', '4', '--max-bounces', '4']


def run(*arguments):
    return program.run(LAMPYRIS, 'bench', *arguments)


def bench(*arguments):
    result = run(CORNELL, *SMALL, '--json', '--quiet', *arguments)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return json.loads(result.stdout), result.stderr


def rows_of(result):
    return {row['name']: row for row in result['variants'][0]['rows']}


class BenchKernel(unittest.TestCase):
    def test_rays_are_those_of_a_render(self):
        result, _ = bench('--kernel', 'intersect_closest', '--rays', 'primary,diffuse,shadow',
                          '--depth', '0,1,2', '--repeats', '2', '--validation')
        whole, _ = bench('--repeats', '2')
        rows = rows_of(result)
        self.assertEqual(list(rows), [
            'intersect_closest primary 0', 'intersect_closest diffuse 1',
            'intersect_closest diffuse 2', 'intersect_shadow shadow 0',
            'intersect_shadow shadow 1', 'intersect_shadow shadow 2'])
        self.assertEqual(rows['intersect_closest primary 0']['items'], 16 * 16 * 4)
        for name, row in rows.items():
            kernel, rays, depth = name.split()
            of_render = whole['variants'][0]['bounces'][int(depth)]['kernels'][kernel]['items']
            self.assertEqual(row['items'], of_render, name)
            self.assertEqual((row['rays'], row['depth']), (rays, int(depth)))
            self.assertGreaterEqual(row['nodes'], row['items'])
            self.assertEqual(row['bvh_bytes'], 64 * row['nodes'] + 48 * row['primitives'])
            self.assertEqual(len(row['repeat_ms']), 2)
            self.assertTrue(all(ms > 0 for ms in row['repeat_ms']))

    def test_every_kernel(self):
        for kernel, items in {'generate_rays': 1024, 'accumulate': 256, 'resolve': 256,
                              'prepare_dispatch': 2}.items():
            result, _ = bench('--kernel', kernel, '--repeats', '2')
            self.assertEqual({name: row['items'] for name, row in rows_of(result).items()},
                             {kernel if kernel != 'prepare_dispatch' else kernel + ' 0': items})
        result, _ = bench('--kernel', 'shade_surface', '--depth', '0,4', '--repeats', '2')
        self.assertEqual(list(rows_of(result)), ['shade_surface 0', 'shade_surface 4'])

    def test_nothing_to_do_is_said(self):
        result, said = bench('--kernel', 'intersect_closest', '--depth', '1,9', '--repeats', '2')
        empty = rows_of(result)['intersect_closest diffuse 9']
        self.assertEqual((empty['items'], empty['ms']['value']), (None, None))
        self.assertIn('the kernel intersect_closest gets no items at depth 9', said)

    def test_variants(self):
        result, _ = bench('--kernel', 'intersect_closest', '--sweep', 'node=quantised,float',
                          '--repeats', '6')
        first, second = (v['rows'][0] for v in result['variants'])
        self.assertEqual(first['items'], second['items'])
        self.assertEqual(second['bvh_bytes'], 128 * second['nodes'] + 48 * second['primitives'])
        self.assertIsNotNone(second['speed_ratio']['ci_low'])

    def test_refusals(self):
        for arguments, words in [
                (['--kernel', 'intersect_closet'], 'did you mean "intersect_closest"?'),
                (['--kernel', 'shade'], 'expected one of generate_rays, intersect_closest'),
                (['--kernel', 'shade_classical'], 'is not used to render'),
                (['--kernel', 'shade_surface', '--rays', 'shadow'], 'traces no rays'),
                (['--kernel', 'resolve', '--depth', '1'], 'runs once for all bounces'),
                (['--kernel', 'intersect_closest', '--rays', 'diffuse', '--depth', '0'],
                 'expected a --depth of 1 or more')]:
            result = run(CORNELL, *SMALL, *arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ''), arguments)
            self.assertIn(words, result.stderr)

    def test_a_slower_kernel_is_told(self):
        arguments = ['--kernel', 'intersect_closest', '--rays', 'primary', '--repeats', '8']
        with tempfile.TemporaryDirectory(prefix='lampyris-bench-') as folder:
            before = os.path.join(folder, 'before.json')
            report = os.path.join(folder, 'report')
            result, _ = bench(*arguments, '--report', report)
            with open(os.path.join(report, 'report.html'), encoding='utf-8') as file:
                self.assertIn('intersect_closest primary 0', file.read())
            row = result['variants'][0]['rows'][0]
            for factor, status in (0.02, 1), (50, 0):
                times = row['repeat_ms']
                row['repeat_ms'] = [ms * factor for ms in times]
                with open(before, 'w', encoding='utf-8') as file:
                    json.dump(result, file)
                now = run(CORNELL, *SMALL, *arguments, '--json', '--quiet', '--baseline', before)
                self.assertEqual(now.returncode, status, now.stderr)
                row['repeat_ms'] = times

    def test_a_signal_ends_it(self):
        program = subprocess.Popen(
            [LAMPYRIS, 'bench', CORNELL, *SMALL, '--json', '--kernel', 'intersect_closest',
             '--repeats', '10000'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(1)
        program.send_signal(signal.SIGINT)
        out, said = program.communicate(timeout=60)
        self.assertEqual(program.returncode, 130, said)
        if out:
            self.assertTrue(json.loads(out)['stopped_early'])


if __name__ == '__main__':
    unittest.main()
