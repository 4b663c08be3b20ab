"""Tests lampyris bench: its figures add up, all variants make the same picture, and the comparison with a
baseline finds changes.

    test_bench.py LAMPYRIS

Nothing here depends on how fast the machine is. What depends on its being even: a repetition is
taken to be less than 64 times longer or shorter than it was a moment before.
"""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import program

LAMPYRIS = sys.argv.pop(1)
ROOT = os.environ['LAMPYRIS_SOURCE_ROOT']
CORNELL = os.path.join(ROOT, 'scenes', 'cornell.json')
CLASSES = os.path.join(ROOT, 'scenes', 'all_classes.json')
SMALL = ['--size', '16x16', '--json', '--quiet']


def run(*arguments, **environment):
    return program.run(LAMPYRIS, *arguments, env={**os.environ, **environment})


def bench(*arguments, **environment):
    return json.loads(program.checked(LAMPYRIS, 'bench', *arguments,
                                      env={**os.environ, **environment}))


def rows_of(variant, kind=None):
    return {row['name']: row for row in variant['rows'] if kind in (None, row['kind'])}


class Figures(unittest.TestCase):
    @program.by_the_clock
    def test_rows_add_up_to_the_clock(self):
        # The difference between the times of the kernels and of the host has a row of its own, and is small.
        variant = bench(CORNELL, *SMALL, '--repeats', '3', '--spp', '64')['variants'][0]
        rows = rows_of(variant)
        parts = []
        for i, wall in enumerate(rows['repetition']['repeat_ms']):
            kernels, host = (sum(row['repeat_ms'][i] for row in rows_of(variant, kind).values())
                             for kind in ('kernel', 'host'))
            self.assertAlmostEqual((kernels + host) / wall, 1.0, places=6)
            parts.append(abs(rows['other']['repeat_ms'][i]) / wall)
        self.assertLess(sorted(parts)[1], 0.03)
        self.assertAlmostEqual(sum(row['share'] for name, row in rows.items()
                                   if name != 'repetition'), 1.0, places=6)

    @program.by_the_clock
    def test_an_outside_clock_agrees(self):
        # The rest is the start and the end of the process.
        start = time.monotonic()
        result = bench(CORNELL, *SMALL, '--size', '48x48', '--spp', '64', '--repeats', '5')
        share = sum(result['seconds'].values()) / (time.monotonic() - start)
        timed = sum(rows_of(result['variants'][0])['repetition']['repeat_ms']) * 1e-3
        self.assertAlmostEqual(result['seconds']['timed'], timed, places=6)
        self.assertLess(share, 1.0)
        self.assertGreater(share, 0.97)

    def test_items_are_those_of_the_render(self):
        # If each vertex sends a shadow ray to each lamp, rays that carry no light are items, too. Here a
        # vertex sends one.
        small = (*SMALL, '--light-choice', 'power')
        for scene in (CORNELL, CLASSES):
            variant = bench(scene, *small, '--repeats', '2', '--validation')['variants'][0]
            render = run('render', scene, *small, '--spp', '4', '-o', os.devnull)
            picture = json.loads(render.stdout) if render.returncode == 0 else None
            kernels, frame = rows_of(variant, 'kernel'), variant['frame']
            self.assertEqual((variant['spp'], frame['paths']), (4, 16 * 16 * 4))
            self.assertEqual(kernels['intersect_closest']['items'], frame['closest_rays'])
            self.assertEqual(kernels['intersect_shadow']['items'], frame['shadow_rays'])
            self.assertEqual(kernels['generate_rays']['items'], frame['paths'])
            self.assertEqual(kernels['accumulate']['items'], 16 * 16)
            for name, row in kernels.items():
                if row['items'] and name != 'accumulate':
                    self.assertEqual(row['items'], sum(
                        b['kernels'].get(name, {'items': 0})['items'] for b in variant['bounces']))
            # Both hits and misses are shaded.
            self.assertEqual(variant['bounces'][0]['occupancy'], 1)
            for bounce in variant['bounces']:
                items = {name: k['items'] for name, k in bounce['kernels'].items()}
                shaded = sum(n for name, n in items.items() if name.startswith('shade_'))
                self.assertLessEqual(shaded, items['intersect_closest'])
                self.assertGreaterEqual(items['intersect_closest'], items.get('intersect_shadow', 0))
            if picture:
                self.assertEqual(picture['image_hash'], variant['image_hash'])
                self.assertEqual(picture['rays'], {'closest': frame['closest_rays'],
                                                   'shadow': frame['shadow_rays']})

    def test_bytes(self):
        rows = rows_of(bench(CORNELL, *SMALL, '--repeats', '2', '--max-bounces', '0')['variants'][0])
        paths = 16 * 16 * 4
        hits = rows['shade_surface']['items']
        # For each kernel, the records of an item. Rays: three uvec4 words and the radiance, and a place in
        # the queue. Intersections: a place in the queue and two words; for hits one more word and a place.
        # Sorting: a place and a path. Accumulation: the film, read and written.
        self.assertEqual(rows['generate_rays']['record_bytes'], paths * (3 * 16 + 16 + 4))
        self.assertEqual(rows['intersect_closest']['record_bytes'], paths * 36 + hits * 20)
        self.assertEqual(rows['shade_surface']['record_bytes'], hits * 68)
        self.assertEqual(rows['accumulate']['record_bytes'], 256 * 2 * 112 + paths * 16)
        closest = rows['intersect_closest']
        self.assertEqual(closest['bvh_bytes'], closest['nodes'] * 64 + closest['primitives'] * 48)
        self.assertGreaterEqual(closest['nodes'], paths)

    def test_without_timestamps(self):
        result = bench(CORNELL, *SMALL, '--repeats', '2', LAMPYRIS_LIMITS=program.limits('no-timestamps'))
        variant = result['variants'][0]
        self.assertFalse(result['timestamps'])
        for row in rows_of(variant, 'kernel').values():
            self.assertEqual((row['ms']['value'], row['repeat_ms'], row['share']),
                             (None, [None, None], None))
        for i, wall in enumerate(rows_of(variant)['repetition']['repeat_ms']):
            host = sum(row['repeat_ms'][i] for row in rows_of(variant, 'host').values())
            self.assertAlmostEqual(host / wall, 1, places=6)

    def test_little(self):
        variant = bench(CORNELL, *SMALL, '--size', '1x1', '--spp', '1', '--max-bounces', '0',
                        '--repeats', '2')['variants'][0]
        self.assertEqual(variant['frame']['paths'], 1)
        self.assertIsNone(rows_of(variant)['repetition']['ms']['ci_low'])  # two repetitions give no interval


class Variants(unittest.TestCase):
    def test_they_make_the_same_picture(self):
        result = bench(CLASSES, *SMALL, '--size', '8x8', '--spp', '2', '--repeats', '2',
                       '--curve', 'wave=1k', '--curve', 'node=float workgroup=64',
                       '--curve', 'bvh=median classes=merged')
        self.assertEqual([v['label'] for v in result['variants']],
                         ['wave=1k', 'node=float workgroup=64', 'bvh=median classes=merged'])
        self.assertEqual(len({v['image_hash'] for v in result['variants']}), 1)
        self.assertIsNone(result['difference'])
        self.assertIn('shade_surface', rows_of(result['variants'][2]))
        self.assertEqual(result['variants'][0]['wave'], 1024)
        self.assertEqual(result['variants'][1]['workgroup'], 64)

    def test_hierarchies(self):
        # With more triangles per leaf and a higher cost of nodes there are fewer nodes, more triangles and
        # the same picture.
        result = bench(os.path.join(ROOT, 'scenes', 'teapots.json'), *SMALL, '--size', '16x16', '--spp', '1',
                       '--repeats', '2', '--sweep', 'bvh-leaf=1,8', '--sweep', 'bvh-costs=8:1',
                       '--curve', 'bvh=middle bvh-leaf=8 bvh-costs=1,4')
        self.assertIsNone(result['difference'])
        self.assertEqual([v['label'] for v in result['variants']],
                         ['bvh=middle bvh-leaf=8 bvh-costs=1,4', 'bvh-leaf=1 bvh-costs=8:1',
                          'bvh-leaf=8 bvh-costs=8:1'])
        self.assertEqual(len({v['image_hash'] for v in result['variants']}), 1)
        middle, few, many = (rows_of(v)['intersect_closest'] for v in result['variants'])
        self.assertLess(many['nodes'], few['nodes'])
        self.assertGreater(many['primitives'], 1.5 * few['primitives'])
        self.assertGreater(middle['primitives'], 1.5 * few['primitives'])
        costs = [v['bvh']['sah_cost'] for v in result['variants']]
        self.assertLess(costs[1], costs[0])

    def test_what_changes_the_picture_is_no_error(self):
        plane = os.path.join(ROOT, 'src', 'check', 'scenes', 'plane.json')
        result = bench(CORNELL, plane, *SMALL, '--repeats', '2', '--sweep', 'spp=1,2',
                       '--sweep', 'wave=1k,2k')
        self.assertEqual([(os.path.basename(v['scene']), v['label']) for v in result['variants']],
                         [(scene, label) for scene in ('cornell.json', 'plane.json')
                          for label in ('spp=1 wave=1k', 'spp=1 wave=2k', 'spp=2 wave=1k',
                                        'spp=2 wave=2k')])
        hashes = [v['image_hash'] for v in result['variants']]
        self.assertEqual(hashes[0::2], hashes[1::2])
        self.assertNotEqual(hashes[0], hashes[2])
        self.assertNotEqual(hashes[0], hashes[4])
        self.assertEqual(result['variants'][4]['frame']['speed_ratio']['value'], 1)

    def test_what_cannot_be(self):
        for arguments, message in (
                (['--sweep', 'nonsense=1'], 'is not a setting'),
                (['--sweep', 'workgroup=64,96'], 'workgroup=96: a workgroup of 96 threads'),
                (['--sweep', 'wave=1,2k'], 'wave=1,2k'),
                (['--repeats', '1'], '--repeats'),
                (['--sweep', 'wave=1k,2k,4k,8k,16k,32k,64k,128k,256k', '--sweep',
                  'spp=1,2,3,4,5,6,7,8'], '72 variants; expected at most 64'),
                (['--report', os.devnull], os.devnull)):
            result = run('bench', CORNELL, *SMALL, *arguments)
            self.assertEqual(result.returncode, 4 if '--report' in arguments else 2, arguments)
            self.assertIn(message, result.stderr)
            self.assertEqual(result.stdout, '')


class Baseline(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def scaled(self, result, factor, **changes):
        for variant in result['variants']:
            variant.update(changes)
            for row in variant['rows']:
                row['repeat_ms'] = [ms and ms * factor for ms in row['repeat_ms']]
        path = os.path.join(self.folder.name, 'before.json')
        with open(path, 'w', encoding='utf-8') as file:
            json.dump(result, file)
        return path

    def test_changes_are_found(self):
        arguments = (CORNELL, *SMALL, '--spp', '64', '--repeats', '6')
        before = bench(*arguments)
        slower = run('bench', *arguments, '--baseline', self.scaled(before, 1 / 64))
        self.assertEqual(slower.returncode, 1, slower.stderr)
        result = json.loads(slower.stdout)['baseline']
        verdicts = {change['row']: change['verdict'] for change in result['changes']}
        self.assertEqual(verdicts['repetition'], 'slower')
        self.assertIn('intersect_closest', verdicts)
        self.assertNotIn('recording', verdicts)
        self.assertTrue(result['slower'])
        # the times are 64 times those of the baseline
        faster = run('bench', *arguments, '--baseline', self.scaled(before, 64 * 64))
        self.assertEqual(faster.returncode, 0, faster.stderr)
        verdicts = {change['row']: change['verdict']
                    for change in json.loads(faster.stdout)['baseline']['changes']}
        self.assertEqual(verdicts['repetition'], 'faster')

    def test_what_cannot_be_compared(self):
        arguments = (CORNELL, *SMALL, '--spp', '1', '--repeats', '2')
        before = bench(*arguments)

        def refused(path, message):
            result = run('bench', *arguments, '--baseline', path)
            self.assertEqual((result.returncode, result.stdout), (2, ''))
            self.assertIn(message, result.stderr)

        refused(self.scaled(before, 1, spp=2), 'spp was 2, and is 1')
        refused(self.scaled(before, 1, width=17, spp=1), 'width was 17, and is 16')
        refused(self.scaled(before, 1, width=16, scene='other.json'), 'no result for any of these scenes')
        before['machine']['device'] = 'Abacus 3000'
        refused(self.scaled(before, 1, scene=CORNELL), 'was measured on the device "Abacus 3000"')
        path = os.path.join(self.folder.name, 'before.json')
        for text, message in (('{', 'before.json: line 1, column'), ('[]', 'is not the JSON output of lampyris bench'),
                              ('{"machine": {}, "variants": 3}', 'is not the JSON output')):
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
            refused(path, message)
        refused(os.path.join(self.folder.name, 'missing.json'), 'missing.json')

    def test_another_picture_is_told(self):
        arguments = (CORNELL, *SMALL, '--spp', '1', '--repeats', '2')
        path = self.scaled(bench(*arguments), 1, image_hash='0123456789abcdef')
        result = run('bench', *arguments, '--baseline', path, '--log-level', 'warning')
        self.assertIn('was different (hash 0123456789abcdef, now', result.stderr)


class Endings(unittest.TestCase):
    def test_a_signal_keeps_what_is_there(self):
        with subprocess.Popen([LAMPYRIS, 'bench', CORNELL, *SMALL, '--size', '4x4', '--spp', '1',
                               '--repeats', '10000', '--sweep', 'wave=1k,2k'],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(2.5)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, err)
        if not out:
            self.assertIn('stopped before every variant was timed once', err)
            return
        result = json.loads(out)
        self.assertTrue(result['stopped_early'])
        for variant in result['variants']:
            for row in variant['rows']:
                self.assertEqual(len(row['repeat_ms']), result['repeats'])

    def test_the_report(self):
        with tempfile.TemporaryDirectory() as folder:
            report = os.path.join(folder, 'report')
            result = bench(CORNELL, *SMALL, '--repeats', '2', '--sweep', 'wave=1k,2k', '--report',
                           report)
            with open(os.path.join(report, 'report.html'), encoding='utf-8') as file:
                page = file.read()
            charts = page.count('<svg')
            self.assertEqual(charts, 3 if shutil.which('gnuplot') else 0)
            for part in ('wave=2k', 'intersect_closest', result['variants'][0]['image_hash']):
                self.assertIn(part, page)
            for part in ('src="http', ' href="http', '@import'):
                self.assertNotIn(part, page)
            with open(os.path.join(report, 'results.json'), encoding='utf-8') as file:
                self.assertEqual(json.load(file)['variants'][1]['image_hash'],
                                 result['variants'][1]['image_hash'])
            with open(os.path.join(report, 'results.csv'), encoding='utf-8') as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), 2 * sum(len(v['rows']) for v in result['variants']))
            mine = [float(r['ms']) for r in rows
                    if (r['variant'], r['row']) == ('wave=2k', 'repetition')]
            self.assertEqual([round(ms, 6) for ms in mine],
                             [round(ms, 6) for ms in
                              rows_of(result['variants'][1])['repetition']['repeat_ms']])

    def test_results_fit_the_schema(self):
        try:
            import jsonschema  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest('no module jsonschema')
        with open(os.path.join(ROOT, 'docs', 'bench.schema.json'), encoding='utf-8') as file:
            schema = json.load(file)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'before.json')
            arguments = (CORNELL, *SMALL, '--spp', '1', '--repeats', '2')
            results = [bench(*arguments)]
            with open(path, 'w', encoding='utf-8') as file:
                json.dump(results[0], file)
            again = run('bench', *arguments, '--baseline', path, '--sweep', 'wave=1k,2k')
            self.assertEqual(again.returncode, 2)
            results.append(json.loads(run('bench', *arguments, '--baseline', path).stdout))
            results.append(bench(*arguments, '--kernel', 'intersect_closest'))
            results.append(bench(*arguments, LAMPYRIS_LIMITS=program.limits('no-timestamps')))
        for result in results:
            jsonschema.validate(result, schema)


if __name__ == '__main__':
    unittest.main()
