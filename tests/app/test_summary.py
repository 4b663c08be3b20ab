#!/usr/bin/env python3
"""Tests the summary of lampyris render, and the additional output of --explain.

    test_summary.py LAMPYRIS SOURCE_ROOT
"""
import base64
import json
import math
import os
import pty
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

from program import by_the_clock, limits, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))


def scene(name):
    return os.path.join(ROOT, 'scenes', name + '.json')


def on_terminal(*arguments):
    """Returns all output of a command on a terminal, results as well as progress."""
    child, terminal = pty.fork()
    if child == 0:
        os.environ['TERM'] = 'xterm'
        os.execv(LAMPYRIS, [LAMPYRIS, *arguments])
    text = b''
    while True:
        try:
            part = os.read(terminal, 65536)
        except OSError:  # the other end of the terminal was closed
            part = b''
        if not part:
            break
        text += part
    status = os.waitpid(child, 0)[1]
    os.close(terminal)
    assert status == 0, text
    return text.decode().replace('\r\n', '\n')


class Base(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def render(self, *arguments, spp=16):
        result = subprocess.run(
            [LAMPYRIS, 'render', '--size', '16x16', '--spp', str(spp), *arguments,
             '-o', os.path.join(self.folder.name, 'out.exr')],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def json(self, *arguments):
        return json.loads(self.render(*arguments, '--json'))


class Summary(Base):
    def test_ten_lines(self):
        # One scene has a single class of surfaces, the other one has all classes.
        for name in ('cornell', 'all_classes'):
            lines = [line for line in self.render(scene(name)).splitlines()
                     if not line.startswith('bias ')]
            self.assertLessEqual(len(lines), 10, '\n'.join(lines))
            self.assertRegex(lines[2], r'^error     ')
            self.assertRegex(lines[-1], r'^wrote     .*out\.exr$')

    def at_a_glance(self, path, most):
        """Returns the lines that a render to EXR and PNG prints on a terminal."""
        text = on_terminal('render', path, '--size', '64x64', '--spp', '32',
                           *(part for name in ('out.exr', 'out.png')
                             for part in ('-o', os.path.join(self.folder.name, name))))
        lines = text[text.index(path + '  64 x 64'):].splitlines()
        self.assertLessEqual(len(lines), most, text)
        for line in lines:
            short = line.replace(os.path.dirname(path) + '/', '').replace(self.folder.name + '/', '')
            self.assertLessEqual(len(short), 110, line)
        return lines

    def test_at_a_glance(self):
        pictures = r'^wrote     \S+/out\.exr, \S+/out\.png'
        lines = self.at_a_glance(scene('cornell'), 10)
        self.assertRegex(lines[-1], pictures + '$')
        lines = self.at_a_glance(os.path.join(ROOT, 'scenes', 'models', 'vase.glb'), 11)
        self.assertRegex(lines[-1], pictures + r' \(exposure [-+]\d+\.\d+ stops, tone aces: '
                                               r'--exposure, --tone\)$')

    def test_the_largest_and_the_others_are_all(self):
        text = self.render(scene('all_classes'), '--explain', spp=64)
        few, every = re.findall(r'^time      ([0-9.]+) s = (.*)$', text, re.MULTILINE)
        self.assertEqual(few[0], every[0])
        for _, parts in (few, every):
            times = [float(value) for value in re.findall(r'[0-9.]+', parts)]
            self.assertAlmostEqual(sum(times), float(few[0]), delta=5e-4 * (len(times) + 1))
        kernels, each = re.findall(r'^kernels   (.*)$', text, re.MULTILINE)
        sum_ms = float(re.match(r'(\d+) ms:', kernels)[1])
        shares = [float(share) for share in re.findall(r'(\d+) %', kernels)]
        self.assertEqual(len(shares), 4)
        self.assertAlmostEqual(sum(shares), 100, delta=2)
        times = dict((name, float(ms)) for name, ms in re.findall(r'(\w+) (\d+) ms', each))
        self.assertAlmostEqual(sum(times.values()), sum_ms, delta=.5 * len(times) + 1)
        named = re.findall(r'(\w+) \d+ %,', kernels)
        self.assertGreaterEqual(min(times[name] for name in named) + 1,
                                max(ms for name, ms in times.items() if name not in named))

    def test_two_waves_in_flight(self):
        for count in (1, 2):
            with unittest.mock.patch.dict(os.environ, LAMPYRIS_LIMITS=limits(f'waves={count}')):
                result = self.json(scene('cornell'), '--wave', '128')
                text = self.render(scene('cornell'), '--wave', '128', '--explain')
            begun = result['waves_begun_ahead']
            self.assertEqual(result['waves_in_flight'], count)
            self.assertEqual(begun > 0, count > 1)
            line = re.search(r'^waves +(\d+), of which (\d+) began while', text, re.M)
            self.assertEqual(line and int(line[2]), begun or None)
            self.assertEqual('two in flight' in text, count > 1)

    def test_no_more_paths_end_by_their_density_than_there_are(self):
        # If paths split, each branch may end. No density reaches this limit, so nearly all branches end.
        for splits, what in (('0', 'paths'), ('4', 'branches of paths')):
            bias, = json.loads(self.render(scene('classical'), '--size', '24x18', '--spp', '4', '--split-lobes',
                                           splits, '--min-density', '1e6', '--json'))['bias']
            ended, there = re.match(rf'(\d+) of (\d+) {what} ended ', bias['text']).groups()
            self.assertLessEqual(int(ended), int(there))
            self.assertGreater(int(ended), 0.5 * int(there))
            self.assertEqual(int(there) > 24 * 18 * 4, splits == '4')

    def test_what_no_sample_mends_is_listed(self):
        def kinds(*settings, name='edges'):
            return [bias['kind'] for bias in json.loads(self.render(scene(name), *settings, '--json'))['bias']]

        # Only refraction scales radiance.
        self.assertEqual(kinds('--radiance-scaling', 'off'), [])
        self.assertEqual(kinds('--size', '8x8', name='glass'), [])
        self.assertEqual(kinds('--size', '8x8', '--radiance-scaling', 'off', name='glass'), ['radiance-scaling'])

        for settings, expected in (
                ((), []), (('--pixel-sampling', 'random'), []), (('--pixel-sampling', 'stratified'), []),
                (('--pixel-sampling', 'centre'), ['pixel-sampling']),
                (('--pixel-sampling', 'grid'), ['pixel-sampling']),
                (('--pixel-sampling', 'stratified', '--pixel-jitter', 'off'), ['pixel-jitter']),
                (('--sampler', 'sine'), ['sampler']), (('--accumulation', 'sum'), ['accumulation']),
                (('--accumulation', 'running'), ['accumulation'])):
            self.assertEqual(kinds(*settings), expected, settings)

    def test_caustics_that_path_cannot_find_are_listed(self):
        """A floor, a ball and a light: only delta lights and perfectly specular balls together lose light."""
        def listed(material, light, *settings):
            path = os.path.join(self.folder.name, 'ball.json')
            with open(path, 'w', encoding='utf-8') as file:
                json.dump({
                    'lampyris': 1, 'camera': {'position': [0, 3, 6], 'target': [0, 0, 0], 'fov_degrees': 40},
                    'materials': {'grey': {'base_color': [0.5] * 3}, 'ball': material,
                                  'lamp': {'emission': [5] * 3}},
                    'lights': [light] if light else [],
                    'shapes': [
                        {'type': 'quad', 'material': 'grey', 'corner': [-3, 0, 3], 'u': [6, 0, 0], 'v': [0, 0, -6]},
                        {'type': 'sphere', 'material': 'ball', 'center': [0, 1, 0], 'radius': 0.8},
                        {'type': 'sphere', 'material': 'lamp', 'center': [2, 4, 0], 'radius': 0.1}]}, file)
            result = json.loads(self.render(path, '--size', '8x8', *settings, '--json', spp=2))
            return [bias['text'] for bias in result['bias'] if bias['kind'] == 'integrator']

        point = {'type': 'point', 'position': [1, 4, 0], 'intensity': [5] * 3}
        sun = {'type': 'directional', 'direction': [0, -1, 0], 'irradiance': [1] * 3}
        glass, coat = {'type': 'dielectric'}, {'type': 'principled', 'roughness': 0}
        for material, light in ((glass, point), ({'type': 'mirror'}, sun), (coat, point)):
            text, = listed(material, light)
            self.assertRegex(text, r'delta lights \(1\).*: --integrator bidir finds them$')
        text, = listed(glass, point, '--clamp', '10')
        self.assertIn('does not support this render', text)
        for material, light, settings in (
                (glass, None, ()), (glass, {**sun, 'angular_diameter_degrees': 1}, ()),
                ({'type': 'conductor', 'roughness': 0.3}, point, ()), (glass, point, ('--integrator', 'bidir')),
                (glass, point, ('--max-bounces', '1'))):
            self.assertEqual(listed(material, light, *settings), [], (material, light, settings))

    def test_what_was_added_is_named_whatever_else_there_is_to_note(self):
        # A model with a triangle, and with lines and an extension that are not supported.
        corners = base64.b64encode(struct.pack('<9f', 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
        model = os.path.join(self.folder.name, 'model.gltf')
        with open(model, 'w', encoding='utf-8') as file:
            json.dump({
                'asset': {'version': '2.0'}, 'extensionsUsed': ['EXT_unheard_of'],
                'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}],
                'meshes': [{'primitives': [{'attributes': {'POSITION': 0}},
                                           {'attributes': {'POSITION': 0}, 'mode': 1}]}],
                'buffers': [{'byteLength': 36,
                             'uri': 'data:application/octet-stream;base64,' + corners}],
                'bufferViews': [{'buffer': 0, 'byteLength': 36}],
                'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3',
                               'min': [0, 0, 0], 'max': [1, 1, 0]}]}, file)
        notes = [line for line in self.render(model, spp=1).splitlines() if line.startswith('note')]
        self.assertEqual(len(notes), 1, notes)
        self.assertRegex(notes[0], r'^note      added: .*--ground.* \(and \d+ more: --explain\)$')
        every = [line for line in self.render(model, '--explain', spp=1).splitlines()
                 if line.startswith('note')]
        self.assertRegex('\n'.join(every[1:]), r'lines are skipped')

    def test_pictures_where_nobody_names_them(self):
        # If stderr is a terminal, a PNG is written as well.
        arguments = ['render', scene('cornell'), '--size', '8x8', '--spp', '1']
        for run, names in ((lambda: subprocess.run([LAMPYRIS, *arguments], stdout=subprocess.PIPE,
                                                   stderr=subprocess.PIPE, check=True),
                            ['cornell.exr']),
                           (lambda: on_terminal(*arguments), ['cornell.exr', 'cornell.png']),
                           (lambda: on_terminal(*arguments, '-o', 'box.exr'), ['box.exr'])):
            before = os.getcwd()
            with tempfile.TemporaryDirectory() as folder:
                os.chdir(folder)
                try:
                    run()
                    self.assertEqual(sorted(os.listdir()), names)
                finally:
                    os.chdir(before)

    def test_one_line_says_what_was_left_out(self):
        text = self.render(scene('cornell'))
        found = re.findall(r'^left out  (\d+) of (\d+) features, (\d+) of (\d+) kernels, '
                           r'(\d+\.\d) MiB; --explain lists them$', text, re.MULTILINE)
        self.assertEqual(len(found), 1, text)
        lists = self.json(scene('cornell'))['features']
        kernels = [[part for part in parts if part['kind'] == 'kernel']
                   for parts in (lists['left_out'], lists['kept'])]
        features = [[part for part in parts if part['kind'] in ('feature', 'lobe', 'emitter')]
                    for parts in (lists['left_out'], lists['kept'])]
        saved = sum(part['bytes'] for part in lists['left_out'] if part['kind'] == 'buffer')
        self.assertEqual(found[0], (
            str(len(features[0])), str(len(features[0]) + len(features[1])),
            str(len(kernels[0])), str(len(kernels[0]) + len(kernels[1])), '%.1f' % (saved / 2**20)))


class Explain(Base):
    def explained(self, *arguments):
        """Returns the number of remaining SPIR-V instructions, and the rows of the table by kind and name."""
        text = self.render(scene('cornell'), '--explain', *arguments, spp=1)
        left, of_all = re.search(r'^code      (\d+) SPIR-V instructions remain of (\d+)$', text,
                                 re.MULTILINE).groups()
        self.assertLess(int(left), int(of_all) / 4)
        header, rows = text.partition('left out  ' + ' ' * 20)[2].split('\n', 1)
        self.assertEqual(header.split(), ['bytes', 'instructions', 'why'])
        table = {}
        for row in rows.splitlines():
            kind, name, size, count, why = re.fullmatch(
                r'(\w+): (.+?) +(-?\d+) +(-?\d+)  (\S.*)', row).groups()
            table[kind, name] = int(size), int(count), why
        return int(left), table

    def test_the_table_is_that_of_the_json(self):
        import jsonschema
        _, table = self.explained()
        values = self.json(scene('cornell'), '--explain')
        with open(os.path.join(ROOT, 'docs', 'render.schema.json'), encoding='utf-8') as file:
            jsonschema.Draft202012Validator(json.load(file)).validate(values)
        rows = {(part['kind'], part['name']): (part['saved']['bytes'],
                                               part['saved']['instructions'], part['saved']['why'])
                for part in values['features']['left_out']}
        self.assertEqual(table, rows)
        self.assertFalse(any('saved' in part for part in values['features']['kept']))
        self.assertFalse(any('saved' in part
                             for part in self.json(scene('cornell'))['features']['left_out']))

    def test_a_feature_costs_what_the_table_says(self):
        # The option that the reason names adds these instructions to the kernels.
        left, table = self.explained()
        for name, option, arguments in (
                ('lens', '--aperture', ['--aperture', '20', '--focus-distance', '1']),
                ('clamped contributions', '--clamp', ['--clamp', '5']),
                ('environment', '', ['--env', '1,1,1'])):
            _, instructions, why = table['feature', name]
            self.assertIn(option, why)
            self.assertGreater(instructions, 0, name)
            more, kept = self.explained(*arguments)
            self.assertNotIn(('feature', name), kept)
            self.assertEqual(more - left, instructions, name)

    def test_the_bytes_are_those_of_the_buffers(self):
        def taken(*arguments):
            values = self.json(scene('cornell'), *arguments)
            self.assertEqual(values['wave'], 16384)
            return sum(part['bytes'] for part in values['features']['kept']
                       if part['kind'] == 'buffer')
        size, _, _ = self.explained('--wave', '16384')[1]['feature', 'environment']
        self.assertEqual(taken('--wave', '16384', '--env', '1,1,1') - taken('--wave', '16384'), size)

    def test_reasons_follow_the_settings(self):
        self.assertEqual(self.explained('--nee', 'off')[1]['feature', 'next-event estimation'][2],
                         '--nee off')
        self.assertIn('--integrator ao', self.explained('--integrator', 'ao')[1]['lobe', 'Lambert'][2])
        self.assertIn('--roulette off', self.explained('--roulette', 'off')
                      [1]['feature', 'Russian roulette'][2])


class Info(Base):
    def test_it_plans_what_a_render_takes(self):
        for name, *arguments in (('many_lights',), ('many_lights', '--light-choice', 'power'),
                                 ('glass', '--features', 'all'), ('cornell', '--nee', 'off')):
            rendered = {part['name']: part['bytes']
                        for part in self.json(scene(name), *arguments)['features']['kept']
                        if part['kind'] == 'buffer'}
            info = subprocess.run([LAMPYRIS, 'info', '--json', '--size', '16x16', scene(name),
                                   *arguments], stdout=subprocess.PIPE, text=True, timeout=60)
            planned = json.loads(info.stdout)['memory']['buffers']
            with self.subTest(name, arguments=arguments):
                self.assertEqual(planned, rendered)


class Progress(Base):
    @by_the_clock
    def test_it_ends_before_results(self):
        out = os.path.join(self.folder.name, 'out.exr')
        for arguments, first in (
                (['render', scene('cornell'), '--size', '64x64', '--time', '2.2', '-o', out],
                 scene('cornell')),
                (['render', scene('cornell'), '--size', '64x64', '--time', '2.2', '--json', '-o',
                  out], '{'),
                (['converge', scene('cornell'), '--size', '32x32', '--times', '0.7',
                  '--replicates', '3', '--reference', 'none'], scene('cornell'))):
            text = on_terminal(*arguments)
            progress, bar, results = text.rpartition('\x1b[K')
            self.assertIn('%', progress, 'the bar was shown')
            # The last line of the progress may be the time of a phase.
            results = re.sub(r'\A[A-Z][a-z ]+: [0-9.]+ s\n', '', results)
            self.assertTrue(results.startswith(first), results)
            self.assertNotRegex(results, r'(?m)^(Rendering|Warming up|Writing)')

    def remaining(self, *arguments):
        """Returns the elapsed and the remaining seconds from the first line of the progress that has both."""
        result = subprocess.run(
            [LAMPYRIS, 'render', scene('cornell'), *arguments, '--json', '-o',
             os.path.join(self.folder.name, 'out.exr')],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        found = re.search(r'Rendering: \d+% \(([0-9.]+) s elapsed, ([0-9.]+) s remaining\)',
                          result.stderr)
        self.assertTrue(found, result.stderr)
        return float(found[1]), float(found[2]), json.loads(result.stdout)

    @by_the_clock
    def test_what_is_left_of_a_time(self):
        # By a million samples per pixel or by the error limit alone, hours would remain.
        elapsed, left, _ = self.remaining('--size', '48x48', '--time', '2', '--spp', '1M', '--error',
                                          '1e-9')
        self.assertLess(abs(math.log2((elapsed + left) / 2)), 2)

    @by_the_clock
    def test_what_is_left_until_an_error(self):
        # The error is known after 2 samples, which takes little time. The required number of samples follows
        # from it, long before the time limit.
        elapsed, left, values = self.remaining('--size', '96x96', '--error', '4e-4', '--time',
                                               '600')
        self.assertEqual(values['ended_by'], 'error')
        self.assertLess(abs(math.log2((elapsed + left) / values['seconds']['render'])), 2.5)


if __name__ == '__main__':
    need_device(LAMPYRIS)
    unittest.main()
