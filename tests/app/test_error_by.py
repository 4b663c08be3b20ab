#!/usr/bin/env python3
"""Tests lampyris render --error-by: its output, that the commands which it prints find the reported
contributions, and that neither the picture nor an interruption is affected.

    test_error_by.py LAMPYRIS SOURCE_ROOT
"""
import json
import os
import shlex
import subprocess
import sys
import tempfile
import unittest

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
CORNELL = os.path.join(ROOT, 'scenes', 'cornell.json')
GLASS = os.path.join(ROOT, 'scenes', 'glass.json')
LIGHTS = os.path.join(ROOT, 'tests', 'render', 'scenes', 'lights.json')


class Base(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def run_program(self, *arguments, code=0):
        result = subprocess.run([LAMPYRIS, 'render', *arguments], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def render(self, scene, *arguments, size='16x16', outputs=True):
        result = self.run_program(scene, '--size', size, '-q', '--json',
                                  *(['-o', self.path('out.exr')] if outputs else []), *arguments)
        return json.loads(result.stdout)


class Following(Base):
    def follow(self, found):
        """Follows the path of a bright contribution, and returns its radiance, its number of events, and
        whether a shadow ray found it."""
        words = shlex.split(found['command'])
        self.assertEqual(words[:2], ['lampyris', 'render'])
        path = json.loads(self.run_program(*words[2:]).stdout)
        self.assertEqual((path['pixel'], path['sample']), (found['pixel'], found['sample']))
        brought = []
        for vertex in path['vertices']:
            brought.append((vertex['gained'], vertex['bounce'], 'path'))
            for light in vertex.get('lights', []):
                if not light['occluded']:
                    brought.append((light['radiance'], vertex['bounce'] + 1, 'shadow ray'))
        return max(brought, key=lambda b: 0.2126 * b[0][0] + 0.7152 * b[0][1] + 0.0722 * b[0][2])

    def check(self, scene, *arguments, **options):
        sources = self.render(scene, *arguments, **options)['error_by']
        brightest = sources['brightest']
        self.assertEqual(len(brightest), 10)
        self.assertEqual(len({tuple(b['pixel']) for b in brightest}), 10)
        self.assertEqual([b['excess'] for b in brightest],
                         sorted((b['excess'] for b in brightest), reverse=True))
        for found in brightest[:2]:
            radiance, events, how = self.follow(found)
            with self.subTest(command=found['command']):
                self.assertEqual((events, how), (found['scattering_events'], found['found_by']))
                for mine, told in zip(radiance, found['radiance']):
                    # The contribution of a vertex is computed as a difference of sums, each of which is
                    # rounded.
                    self.assertAlmostEqual(mine, told, delta=0 if how == 'shadow ray' else 1e-5 * told)
        return brightest

    def test_commands_find_it(self):
        self.check(GLASS, '--spp', '8', '--error-by', 'part')

    def test_commands_of_planned_samples(self):
        # The command has all options that affect the samples, and none that --pixel excludes.
        self.check(LIGHTS, '--spp', '8', '--error-by', 'emitter', '--sampler', 'stratified', '--explain',
                   '--seed', '3', '--light-choice', 'power', '--trace', self.path('t.json'))

    def test_commands_of_adaptive_renders(self):
        self.check(LIGHTS, '--spp', '24', '--error-by', 'emitter', '--adaptive', 'on',
                   '--light-choice', 'power', '--wave', '512')

    def test_commands_of_shards(self):
        self.check(LIGHTS, '--spp', '8', '--error-by', 'emitter', '--shard', '2/2', '--checkpoint',
                   self.path('part'), outputs=False)
        self.check(LIGHTS, '--spp', '8', '--error-by', 'emitter', '--shard=1/2', '--shard-by', 'tiles',
                   '--checkpoint', self.path('tiles'), size='16x48', outputs=False)

    def test_no_commands_for_sequences(self):
        # No option selects a view of a turntable.
        result = self.run_program(LIGHTS, '--size', '16x16', '--spp', '4', '--error-by', 'part', '--turntable', '2',
                                  '-q', '--json', '-o', self.path('view.exr'))
        told = [json.loads(line) for line in result.stdout.splitlines()]
        brightest = [b for one in told if 'error_by' in one for b in one['error_by']['brightest']]
        self.assertEqual({b['command'] for b in brightest}, {None})

    def test_no_commands_for_split_paths(self):
        phong = os.path.join(ROOT, 'scenes', 'phong_lobes.json')
        sources = self.render(phong, '--spp', '4', '--error-by', 'part', '--split-lobes', '2')['error_by']
        self.assertEqual({b['command'] for b in sources['brightest']}, {None})


class Report(Base):
    def test_json(self):
        import jsonschema
        with open(os.path.join(ROOT, 'docs', 'render.schema.json'), encoding='utf-8') as file:
            schema = json.load(file)
        for kinds, given in ((None, []), ('bounce,emitter', ['bounce', 'emitter']),
                             ('all', ['part', 'bounce', 'emitter'])):
            told = self.render(GLASS, '--spp', '16', *(['--error-by', kinds] if kinds else []))
            jsonschema.validate(told, schema)
            if not kinds:
                self.assertIsNone(told['error_by'])
                plain = told['image_hash']
                continue
            self.assertEqual(told['image_hash'], plain)
            for kind in ('part', 'bounce', 'emitter'):
                by = told['error_by'][kind]
                self.assertEqual(by is not None, kind in given)
                if by:
                    self.adds_up(by, told)

    def adds_up(self, by, told):
        whole = by['local_relmse']
        self.assertAlmostEqual(whole, told['error']['local_relmse'], delta=1e-9 * whole)
        classes = by['classes'] + [by['together']]
        self.assertAlmostEqual(sum(c['local_relmse'] for c in classes), whole, delta=1e-7 * whole)
        self.assertAlmostEqual(sum(c['share']['value'] for c in classes), 1, delta=1e-7)
        self.assertAlmostEqual(sum(c['light'] for c in by['classes']), 1, delta=1e-5)
        for c in classes:
            self.assertLessEqual(c['share']['ci_low'], c['share']['value'])
            self.assertGreaterEqual(c['share']['ci_high'], c['share']['value'])

    def test_words(self):
        told = self.run_program(LIGHTS, '--size', '16x16', '--spp', '8', '--error-by', 'all', '-o',
                                self.path('o.exr')).stdout
        for words in ('error by  part', 'error by  bounce', 'error by  emitter', 'emission', ' 3 ',
                      'delta lights', 'together', 'times the brightness around it', '--pixel', 'brightest'):
            self.assertIn(words, told)

    def test_unknown(self):
        told = self.render(LIGHTS, '--spp', '1', '--error-by', 'part')['error_by']
        self.assertEqual(told['reason'], 'fewer than two samples per pixel')
        self.assertEqual((told['part'], told['brightest']), (None, []))
        told = self.render(CORNELL, '--spp', '8', '--error-by', 'part', '--roulette', 'frame')['error_by']
        self.assertEqual({(c['share']['ci_low'], c['share']['ci_high']) for c in told['part']['classes']},
                         {(None, None)})
        refused = self.run_program(LIGHTS, '--error-by', 'depth', code=2).stderr
        self.assertIn('"depth" is unknown; expected some of part, bounce, emitter, all', refused)

    def test_interruption(self):
        arguments = ['--error-by', 'all', '--checkpoint', self.path('c')]
        whole = self.render(LIGHTS, '--spp', '12', '--error-by', 'all')
        self.render(LIGHTS, '--spp', '5', *arguments)
        rest = self.render(LIGHTS, '--spp', '12', *arguments, '--resume', '--wave', '384')
        self.assertEqual(rest['image_hash'], whole['image_hash'])
        for told in (rest, whole):
            for found in told['error_by']['brightest']:
                del found['command']
        self.assertEqual(rest['error_by'], whole['error_by'])
        refused = self.run_program(LIGHTS, '--size', '16x16', '--spp', '20', '--checkpoint', self.path('c'),
                                   '--resume', '-o', self.path('o.exr'), code=2).stderr
        self.assertIn('error-by', refused)


class Converge(Base):
    def converge(self, *arguments):
        import jsonschema
        result = subprocess.run(
            [LAMPYRIS, 'converge', CORNELL, '--size', '16x16', '--spp', '8', '--spp-from', '4',
             '--replicates', '4', '--json', '-q', *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        with open(os.path.join(ROOT, 'docs', 'converge.schema.json'), encoding='utf-8') as file:
            jsonschema.validate(told, json.load(file))
        return told['curves'][0]

    def test_replicates_together(self):
        plain = self.converge('--reference', 'none')
        curve = self.converge('--reference', 'none', '--error-by', 'part', '--roulette', 'frame', '--report',
                              self.path('report'))
        self.assertIsNone(plain['error_by'])
        by = curve['error_by']['part']
        self.assertIsNone(curve['error_by']['emitter'])
        self.assertNotIn('--error-by', curve['command'])
        classes = by['classes'] + [by['together']]
        self.assertAlmostEqual(sum(c['local_relmse'] for c in classes), by['local_relmse'], delta=1e-7)
        for c in classes:
            # Replicates are independent even if the pixels of one are not.
            self.assertLess(c['share']['ci_low'], c['share']['value'])
            self.assertLess(c['share']['value'], c['share']['ci_high'])
        with open(self.path('report/report.html'), encoding='utf-8') as file:
            page = file.read()
        for c in by['classes']:
            self.assertRegex(page, '<tr><th>%s</th><td>%.1f' % (c['name'], 100 * c['share']['value']))


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
