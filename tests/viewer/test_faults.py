#!/usr/bin/env python3
"""Tests the viewer with faulty displays, scenes, shaders, devices, folders and scripts, and with signals.

    test_faults.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import os
import shutil
import signal
import stat
import subprocess
import time
import unittest

import viewer_run
from viewer_run import CORNELL, ROOT, Case


class Faults(Case):
    def test_no_display(self):
        env = {key: value for key, value in os.environ.items()
               if key not in ('DISPLAY', 'WAYLAND_DISPLAY')}
        result = self.view('quit\n', window=True, code=2, env=env)
        self.assertIn('lampyris render', result.err)
        self.assertIn('--headless', result.err)

    def test_headless_needs_a_script(self):
        process = subprocess.run([viewer_run.VIEWER, CORNELL, '--headless'], stderr=subprocess.PIPE,
                                 text=True)
        self.assertEqual(process.returncode, 2)
        self.assertIn('--script', process.stderr)

    def test_scripts_are_checked_before_they_run(self):
        result = self.view('screenshot a.png\nwait 3 samples\nkye F1\n', code=2)
        self.assertIn('script.txt:3: there is no command kye; did you mean key?', result.err)
        self.assertFalse(os.path.exists(self.path('a.png')))

    def test_commands_that_fail(self):
        for script, words in (
                ('set view.exposur 1\n', 'view.exposure'),
                ('set view.exposure 1e9\n', 'view.exposure'),
                ('click no.such.control\n', 'no.such.control'),
                ('expect samples.x == 1\n', "the viewer's state has no key samples.x"),
                ('wait 1 frames\nexpect camera.kind == fish\n',
                 'camera.kind is "perspective"; expected == "fish"'),
                ('wait 9 samples\n', 'stops at the limit of 4'),
                ('hash h.jsonl b\n', 'side b has no picture'),
                ('timeout 0.2\nwait 3000 ms\n', 'the command has not finished after 0.2 s'),
                ('check view.pause on picture\n', 'has changed nothing but its own value'),
        ):
            with self.subTest(script):
                result = self.view(script, '--spp', '4', code=1)
                self.assertIn(words, result.err)
                self.assertIn('script.txt:', result.err)

    def test_scene_that_is_not_there(self):
        result = self.view('quit\n', scene=self.path('none.json'), code=2)
        self.assertIn('none.json', result.err)

    def test_broken_scene_keeps_the_old_picture(self):
        scene = self.scene()
        self.write('broken.json', '{"film": {"width": -3}}')
        result = self.view(
            'wait 2 samples\nhash hash.jsonl\ncopy cornell.json whole.json\n'
            'copy broken.json cornell.json\nkey F5\nwait 10 frames\n'
            'expect message.kind == error\nexpect message.text ~ cornell.json\n'
            'wait 2 samples\nhash hash.jsonl\n'
            'copy whole.json cornell.json\nkey F5\nwait 10 frames\nwait idle\n'
            'expect message.kind != error\nhash hash.jsonl\n', '--spp', '2', scene=scene)
        self.assertEqual(len({h['image_hash'] for h in result.hashes()}), 1)

    def shaders(self):
        """Copies the shaders' source code so that it can be changed."""
        return shutil.copytree(os.path.join(ROOT, 'shaders'), self.path('shaders'))

    def test_broken_shader_keeps_the_old_kernels(self):
        folder = self.shaders()
        name = os.path.join(folder, 'shade_miss.comp')
        with open(name, encoding='utf-8') as file:
            whole = file.read()
        self.write('broken.comp', whole + '\nint x = missing;\n')
        lines = whole.count('\n') + 2
        result = self.view(
            'wait 2 samples\nhash hash.jsonl\ncopy broken.comp shaders/shade_miss.comp\n'
            'key F5\nwait 5 frames\nwait idle\nexpect message.kind == error\n'
            f"expect shader_errors ~ \"shade_miss.comp:{lines}: 'missing' : undeclared\"\n"
            'hash hash.jsonl\n', '--spp', '2', '--shaders', 'shaders')
        self.assertEqual(len({h['image_hash'] for h in result.hashes()}), 1)

    def test_changed_shader_is_used(self):
        """Counting samples twice gives another picture. Undoing the change gives the first one again."""
        name = os.path.join(self.shaders(), 'accumulate.comp')
        shutil.copy(name, self.path('whole.comp'))
        with open(name, encoding='utf-8') as file:
            whole = file.read()
        self.assertIn('add(sums, radiance.rgb);', whole)
        self.write('other.comp', whole.replace('add(sums, radiance.rgb);',
                                               'add(sums, 2.0 * radiance.rgb);'))
        reload = 'key F5\nwait 5 frames\nwait idle\nexpect message.kind == note\n'
        result = self.view(
            'wait 2 samples\nhash hash.jsonl\n'
            f'copy other.comp shaders/accumulate.comp\n{reload}hash hash.jsonl\n'
            f'copy whole.comp shaders/accumulate.comp\n{reload}hash hash.jsonl\n'
            f'{reload}hash hash.jsonl\n',
            '--spp', '2', '--shaders', 'shaders')
        first, other, back, again = [h['image_hash'] for h in result.hashes()]
        self.assertNotEqual(first, other)
        self.assertEqual([first, first], [back, again])

    def test_no_compiler(self):
        env = {**os.environ, 'PATH': self.folder}
        result = self.view('wait 1 frames\nexpect enabled.shaders.reload == false\nkey F5\n'
                           'wait 1 samples\n', env=env)
        self.assertIn('glslangValidator', result.err)

    def test_no_source(self):
        result = self.view('wait 1 frames\nexpect enabled.shaders.reload == false\nkey F5\n'
                           'wait 1 samples\n', '--shaders', 'nowhere')
        self.assertIn('nowhere: the folder', result.err)
        self.assertIn('--shaders', result.err)

    def test_lost_device(self):
        result = self.view('wait 3 samples\nhash hash.jsonl\nlose-device\nwait 3 samples\n'
                           'expect counts.recoveries == 1\nhash hash.jsonl\n', '--spp', '3')
        self.assertEqual(len({h['image_hash'] for h in result.hashes()}), 1)

    def test_device_lost_at_the_beginning(self):
        self.view('wait 3 samples\nhash hash.jsonl\n', '--spp', '3', '--lose-device', '20')

    @unittest.skipIf(os.geteuid() == 0, 'root may write anywhere')
    def test_folder_that_cannot_be_written(self):
        os.mkdir(self.path('closed'), 0o500)
        self.view('wait 1 samples\nscreenshot closed/a.png\n', code=1)

    def test_picture_that_cannot_be_written(self):
        self.view('wait 1 samples\nscreenshot nowhere/a.png\n', code=1)
        self.view('wait 1 samples\nexr nowhere/a.exr\n', code=1)
        self.view('wait 1 samples\nscene nowhere/a.json\n', code=1)
        self.view('wait 1 samples\nscreenshot a.exr\n', code=1)

    def test_files_that_are_read_are_not_written_over(self):
        scene = self.scene()
        self.write('glow.json', '{"lampyris": 1, "environment": {"file": "sky.exr"},'
                   ' "shapes": [{"type": "sphere", "radius": 1, "material": "m"}], "materials": {"m": {}}}')
        self.view('wait 1 samples\nexr sky.exr\n', scene=scene)
        for command, name in (('exr sky.exr', 'sky.exr'), ('state glow.json', 'glow.json'),
                              ('hash glow.json', 'glow.json'), ('scene glow.json', 'glow.json'),
                              ('hash script.txt', 'script.txt')):
            with self.subTest(command):
                script = f'wait 1 samples\n{command}\n'
                self.write('script.txt', script)
                with open(self.path(name), 'rb') as file:
                    before = file.read()
                result = self.view(script, scene=self.path('glow.json'), code=1)
                self.assertIn(name, result.err)
                with open(self.path(name), 'rb') as file:
                    self.assertEqual(file.read(), before)

    def test_dropped_file_that_is_no_scene(self):
        self.write('note.txt', 'no scene')
        self.view('wait 1 samples\nhash hash.jsonl\ndrop note.txt\nwait 3 frames\n'
                  'expect message.kind == error\nexpect message.text ~ note.txt\n'
                  'expect scene ~ cornell.json\nwait 1 samples\n', '--spp', '1')

    def test_dropped_image_that_cannot_be_read(self):
        self.write('sky.hdr', 'no picture')
        self.view('wait 1 samples\nhash hash.jsonl\ndrop sky.hdr\nwait 3 frames\n'
                  'expect message.kind == error\nexpect message.text ~ sky.hdr\n'
                  'expect item.surroundings.kind == original\nwait 1 samples\n', '--spp', '1')
        self.view('wait 3 frames\ndrop sky.hdr\nwait 3 frames\nexpect has_scene == false\n'
                  'expect message.text ~ open\n', scene=None)

    def test_moving_while_denoising_rests(self):
        """An AOV is displayed while small pictures are rendered: the denoiser exists, but its layers do
        not."""
        self.view('wait 1 samples\nset view.denoise on\nwait 1 samples\nset view.aov steps\n'
                  'wait 1 samples\nkey w down\nwait 6 frames\nkey w up\nwait 1 samples\n'
                  'set view.aov radiance\nwait 1 samples\n', '--spp', '1', '--frame-ms', '4',
                  size='320x180')

    def denoise(self, limits, *script):
        """Denoises after a box has moved, so that the history is used. Each of four frames has one sample,
        however long it takes; so no picture is made smaller."""
        scene = os.path.join(ROOT, 'tests', 'render', 'scenes', 'moved_box.json')
        env = dict(os.environ, LAMPYRIS_LIMITS=limits)
        return self.view('set renderer.samples_a_frame 1\nset renderer.spp 4\nset view.denoise on\n'
                         'wait idle\nset view.pause on\nset object.2 on\n'
                         'set object.position 0.4,0.5,0\nwait 1 frames\nwait 1 samples\nwait 3 frames\n'
                         'hash hash.jsonl\n' + '\n'.join(script) + '\n',
                         '--frame-ms', '1000', scene=scene, size='64x43', env=env)

    def test_denoiser_on_a_small_device(self):
        """If denoising needs more buffers than the device supports, it is switched off and the viewer
        continues."""
        for limits in ('', 'storage-count=4', 'no-texel,storage-count=11'):
            result = self.denoise(limits, 'expect item.view.denoise == on', 'exr seen.exr a denoised')
            self.assertNotIn('denoising', result.err)
            if not limits:
                os.rename(self.path('seen.exr'), self.path('expected.exr'))
                continue
            error = self.compare(self.path('seen.exr'), self.path('expected.exr'))
            self.assertEqual(error['mse'], 0)
        for limits in ('no-texel,storage-count=10', 'storage-count=4,texel-elements=2048'):
            result = self.denoise(limits, 'expect item.view.denoise == off', 'exr seen.exr')
            self.assertRegex(result.err, r'warning: denoising is switched off: kernel denoise_\w+: it binds '
                             r'\d+ storage buffers at once; the limit of ')
        hashes = [line['image_hash'] for line in result.hashes()]
        self.assertEqual((len(hashes), len(set(hashes))), (5, 1))

    def test_without_a_scene(self):
        self.view('wait 3 frames\nexpect has_scene == false\nscreenshot a.png panel\n'
                  f'drop {CORNELL}\nwait 5 frames\nwait 2 samples\n'
                  'expect has_scene == true\nhash hash.jsonl\n', '--spp', '2', scene=None)

    def end(self, number):
        process = subprocess.Popen(self.command('wait 1 samples\nstate state.json\n'
                                                'wait 1000000 frames\n'),
                                   cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        for _ in range(600):
            if os.path.exists(self.path('state.json')) or process.poll() is not None:
                break
            time.sleep(0.1)
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 128 + number, err)
        self.assertIn('spp', out)

    def test_signals(self):
        # Child processes inherit an ignored signal, and nohup ignores SIGHUP.
        self.addCleanup(signal.signal, signal.SIGHUP, signal.signal(signal.SIGHUP, signal.SIG_DFL))
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1,
                       signal.SIGXCPU):
            self.end(number)
            os.remove(self.path('state.json'))

    def test_two_pictures_at_once(self):
        self.view('wait 1 samples\nkey F12\nkey F12\nkey F11\nkey F11\nwait idle\n', '--spp', '1')
        for name in ('0001.png', '0002.png', '0001.exr', '0002.exr'):
            path = self.path('cornell-' + name)
            self.assertTrue(stat.S_ISREG(os.stat(path).st_mode), name)


if __name__ == '__main__':
    viewer_run.main()
