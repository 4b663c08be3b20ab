"""lampyris bench --tune, and what other commands make of the file that it keeps.

    test_tune.py LAMPYRIS
"""

import json
import os
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest

LAMPYRIS = sys.argv.pop(1)
SCENE = os.path.join(os.environ['LAMPYRIS_SOURCE_ROOT'], 'scenes', 'cornell.json')
SMALL = ['--size', '16x16', '--spp', '4']
TUNE = ['bench', SCENE, '--tune', *SMALL, '--time', '0.1', '--sweep', 'wave=256,512', '--sweep',
        'workgroup=64']


class Tune(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix='lampyris-tune-')
        self.addCleanup(folder.cleanup)
        self.picture = os.path.join(folder.name, 'a.exr')
        self.cache = os.path.join(folder.name, 'deep', 'cache')
        self.file = os.path.join(self.cache, 'lampyris', 'tuning.json')

    def environment(self, **changes):
        # Mesa would compile all kernels anew in an empty cache.
        shaders = os.environ.get('XDG_CACHE_HOME', tempfile.gettempdir())
        environment = dict(os.environ, XDG_CACHE_HOME=self.cache, MESA_SHADER_CACHE_DIR=shaders)
        environment.update({k: v for k, v in changes.items() if v is not None})
        return {k: v for k, v in environment.items() if changes.get(k, v) is not None}

    def run_program(self, *arguments, status=0, **changes):
        result = subprocess.run([LAMPYRIS, *arguments], stdout=subprocess.PIPE, text=True,
                                stderr=subprocess.PIPE, check=False,
                                env=self.environment(**changes))
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def render(self, *arguments, **changes):
        result = self.run_program('render', SCENE, *SMALL, '--json', '--quiet', '-o', self.picture,
                                  *arguments, **changes)
        return json.loads(result.stdout), result.stderr

    def tune(self, **changes):
        result = self.run_program(*TUNE, '--json', '--quiet', **changes)
        return json.loads(result.stdout), result.stderr

    def kept(self):
        with open(self.file, encoding='utf-8') as file:
            return json.load(file)

    def keep(self, content):
        os.makedirs(os.path.dirname(self.file), exist_ok=True)
        with open(self.file, 'w', encoding='utf-8') as file:
            file.write(content if isinstance(content, str) else json.dumps(content))

    def entry(self, **changes):
        """What is kept after a tuning of this device, with other sizes."""
        self.tune()
        entry = self.kept()['devices'][0]
        entry.update({'wave': 2048, 'workgroup': 32}, **changes)
        return entry

    def test_what_is_found_is_kept(self):
        result, errors = self.tune()
        self.assertEqual(errors, '')
        self.assertEqual(stat.S_IMODE(os.stat(self.cache).st_mode), 0o700)
        self.assertEqual(os.listdir(os.path.dirname(self.file)), ['tuning.json'])
        self.assertEqual(result['file'], self.file)
        rows = [(c['stage'], c['wave'], c['workgroup']) for c in result['candidates']]
        self.assertEqual(rows[:2], [('wave', 256, 128), ('wave', 512, 128)])
        self.assertEqual((rows[2][0], rows[2][2]), ('workgroup', 64))
        for candidate in result['candidates']:
            self.assertTrue(candidate['fits'] and candidate['rounds'] >= 3, candidate)
            speed = candidate['speed']
            self.assertTrue(speed['ci_low'] <= speed['value'] <= speed['ci_high'], speed)
            self.assertEqual(candidate['verdict'],
                             'faster' if speed['ci_low'] > 1 else
                             'slower' if speed['ci_high'] < 1 else 'not told apart')
        # Other than the default only where the last comparison says so.
        last = result['candidates'][-1]
        proven = last['stage'] == 'confirm' and last['speed']['ci_low'] > 1
        self.assertEqual(result['found'] != result['usual'], proven)
        entry = self.kept()['devices'][0]
        # What is the default is kept as such.
        kept = {k: None if v == result['usual'][k] else v for k, v in result['found'].items()}
        self.assertEqual({k: entry[k] for k in kept}, kept)
        self.assertEqual((entry['device'], entry['driver']), (result['device'], result['driver']))
        # The sizes that were tried give the picture of any other render of as many samples.
        render, _ = self.render('--spp', str(result['spp']))
        self.assertEqual(render['image_hash'], result['scenes'][0]['image_hash'])
        self.assertEqual(render['tuned'],
                         {**kept, 'file': self.file} if any(kept.values()) else None)

    def test_renders_use_it_and_keep_their_bits(self):
        entry = self.entry()
        self.keep({'version': 1, 'devices': [entry]})
        plain, _ = self.render('--tuning', 'off')
        tuned, errors = self.render()
        self.assertEqual(errors, '')
        self.assertIsNone(plain['tuned'])
        self.assertEqual(tuned['tuned'], {'wave': 2048, 'workgroup': 32, 'file': self.file})
        self.assertEqual((tuned['wave'], tuned['workgroup']), (2048, 32))
        self.assertEqual(tuned['image_hash'], plain['image_hash'])
        # What the command line says holds.
        part, _ = self.render('--wave', '512')
        self.assertEqual(part['tuned'], {'wave': None, 'workgroup': 32, 'file': self.file})
        self.assertEqual((part['wave'], part['workgroup']), (512, 32))
        # In words, and without a render.
        text = self.run_program('render', SCENE, *SMALL, '-o', self.picture)
        self.assertIn('tuned     waves of 2048 paths, workgroups of 32 threads', text.stdout)
        with open(self.picture, 'rb') as file:
            self.assertIn(b'lampyris:tuned\0string\0\2\0\0\0on', file.read())
        info = json.loads(self.run_program('info', SCENE, '--json').stdout)
        self.assertEqual((info['wave'], info['workgroup'], info['tuned']['file']),
                         (2048, 32, self.file))

    def test_a_wave_that_does_not_fit_is_lowered(self):
        self.keep({'version': 1, 'devices': [self.entry(wave=1 << 24)]})
        result, errors = self.render('--limit-storage-range', '1M')
        self.assertEqual(errors, '')
        self.assertTrue(0 < result['wave'] < 1 << 24)
        self.assertEqual(result['tuned']['wave'], 1 << 24)

    def test_what_cannot_be_read_is_ignored_and_replaced(self):
        entry = self.entry()
        good = {'version': 1, 'devices': [entry]}
        plain, _ = self.render('--tuning', 'off')
        bad = ['', '{', '[]', json.dumps(good)[:-3], json.dumps({**good, 'version': 2}),
               json.dumps({'version': 1}), ' ' * (1 << 21)]
        for change in ({'workgroup': 48}, {'workgroup': 4096}, {'wave': '4096'}, {'wave': 2.5},
                       {'wave': -1}, {'device': None}):
            bad.append(json.dumps({'version': 1, 'devices': [{**entry, **change}]}))
        for content in bad[::4]:
            self.keep(content)
            result, errors = self.render()
            self.assertIsNone(result['tuned'], content[:200])
            self.assertEqual(errors.count('warning'), 1, errors)
            self.assertIn(self.file, errors)
            self.assertEqual(result['image_hash'], plain['image_hash'])
        for content in bad:
            self.keep(content)
            errors = self.run_program('info', SCENE, '--quiet').stderr
            self.assertEqual(errors.count('is ignored'), 1, (content[:200], errors))
        _, errors = self.tune()
        self.assertEqual(errors.count('is ignored'), 1, errors)
        self.assertEqual(self.render()[1], '')
        os.remove(self.file)
        os.mkdir(self.file)
        self.assertEqual(self.render()[1].count('is ignored'), 1)

    def test_other_devices_drivers_and_kernels(self):
        own = self.entry()
        others = [{**own, 'device': 'Another'}, {**own, 'driver': 'Another 1.2'}]
        for content in ([others[0]], [others[1]], [{**own, 'kernels': '0123456789abcdef'}]):
            self.keep({'version': 1, 'devices': content})
            result, errors = self.render()
            self.assertEqual((result['tuned'], errors), (None, ''))
        self.keep({'version': 1, 'devices': [others[0], own, others[1]]})
        self.assertEqual(self.render()[0]['tuned']['wave'], 2048)
        self.tune()
        devices = self.kept()['devices']
        self.assertEqual(devices[:2], others)
        self.assertEqual(len(devices), 3)
        self.assertNotEqual(devices[2]['wave'], 2048)
        self.assertEqual(devices[2]['kernels'], own['kernels'])
        # Only one of the sizes.
        self.keep({'version': 1, 'devices': [{**own, 'wave': None}]})
        self.assertEqual(self.render()[0]['tuned'],
                         {'wave': None, 'workgroup': 32, 'file': self.file})

    def test_no_place_for_it(self):
        for changes in ({'XDG_CACHE_HOME': 'relative', 'HOME': None},
                        {'XDG_CACHE_HOME': None, 'HOME': ''},
                        {'XDG_CACHE_HOME': '/dev/null/cache'}, {'XDG_CACHE_HOME': '/proc'}):
            failed = self.run_program(*TUNE, status=4, **changes)
            self.assertEqual(failed.stdout, '')
            self.assertIn('error: ', failed.stderr)
        render, errors = self.render(XDG_CACHE_HOME='/dev/null/cache')
        self.assertEqual((render['tuned'], errors), (None, ''))
        # Without XDG_CACHE_HOME it is below the home.
        result, _ = self.tune(XDG_CACHE_HOME=None, HOME=self.cache)
        self.assertEqual(result['file'], os.path.join(self.cache, '.cache/lampyris/tuning.json'))

    def test_misuse(self):
        for arguments, word in ((['--sweep', 'spp=1,2'], 'spp=1,2'),
                                (['--sweep', 'workgroup=48'], 'workgroup=48'),
                                (['--sweep', 'workgroup=4'], '8'),
                                (['--sweep', 'wave=1,2'], '64'), (['--wave', '4k'], '--wave'),
                                (['--workgroup', '64'], '--workgroup'),
                                (['--kernel', 'accumulate'], '--kernel')):
            failed = self.run_program('bench', SCENE, '--tune', *SMALL, *arguments, status=2)
            self.assertIn(word, failed.stderr)
        self.run_program('bench', SCENE, '--time', '1', status=2)
        self.assertFalse(os.path.exists(self.file))

    def test_one_at_a_time_and_nothing_is_kept_of_what_was_stopped(self):
        first = subprocess.Popen([LAMPYRIS, 'bench', SCENE, '--tune', '--time', '600'],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 env=self.environment())
        try:
            folder = os.path.dirname(self.file)
            limit = time.monotonic() + 60
            while not os.path.isdir(folder) or not os.listdir(folder):
                self.assertLess(time.monotonic(), limit)
                time.sleep(0.01)
            self.assertIn('another run', self.run_program(*TUNE, status=4).stderr)
        finally:
            first.send_signal(signal.SIGINT)
            out, _ = first.communicate()
        self.assertEqual((first.returncode, out), (130, b''))
        self.assertEqual(os.listdir(folder), [])


if __name__ == '__main__':
    unittest.main()
