#!/usr/bin/env python3
"""Repeated resizing, reloading and saving must not increase the memory that the viewer uses.

    test_leaks.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import os
import random
import shutil

import viewer_run
from program import by_the_clock
from viewer_run import ROOT, Case

# The permitted growth of the process after it has used all functions once: the driver keeps some code of each
# pipeline, and malloc keeps some pages.
SLACK = 8 << 20


class Leaks(Case):
    def expect_flat(self, script, states, *arguments, **options):
        """Checks device memory, which also depends on timing through the sizes of previews. A leak would make
        the least memory of the later rounds exceed the most of the earlier ones. The panel is hidden, because
        its buffers grow with its text, and "1 min 5 s" is longer than "59 s"."""
        result = self.view('key F1\n' + script, *arguments, validation=False, timeout=300, **options)
        times = [result.state(name)['times'] for name in states]
        half = len(states) // 2
        device = [t['device_bytes'] for t in times]
        resident = [t['resident_bytes'] for t in times]
        self.assertLessEqual(min(device[half:]), max(device[:half]), device)
        self.assertLess(resident[-1] - resident[half], SLACK, resident)

    @by_the_clock
    def test_500_resizes(self):
        """The same sizes are used again and again."""
        choice = random.Random(3)
        sizes = [(choice.randrange(32, 300), choice.randrange(32, 200)) for _ in range(50)]
        script, states = [], []
        for turn in range(10):
            script += [f'resize {w} {h}\n' for w, h in sizes]
            script += [f'resize 200 100\nwait 1 samples\nstate {turn}.json\n']
            states.append(f'{turn}.json')
        self.expect_flat(''.join(script), states, '--spp', '1', size='200x100')

    @by_the_clock
    def test_100_reloads(self):
        """Reloads different kernels each time, and the scene with them."""
        folder = shutil.copytree(os.path.join(ROOT, 'shaders'), self.path('shaders'))
        with open(os.path.join(folder, 'resolve.comp'), encoding='utf-8') as file:
            source = file.read()
        at = source.index('void main()')
        scene = self.scene()
        script, states = [], []
        for turn in range(100):
            self.write(f'{turn}.comp', f'{source[:at]}\nconst float unused_{turn} = {turn}.0;\n'
                       f'shared float kept_{turn};\n{source[at:]}')
            script.append(f'copy {turn}.comp shaders/resolve.comp\nkey F5\nwait 2 frames\n'
                          'wait idle\n')
            if turn % 10 == 9:
                script.append(f'expect message.kind == note\nstate {turn}.json\n')
                states.append(f'{turn}.json')
        self.expect_flat(''.join(script), states, '--spp', '1', '--shaders', 'shaders',
                         scene=scene)

    def test_a_bit_of_everything(self):
        """Sanitizers, if the build has them, report leaks at the end."""
        folder = shutil.copytree(os.path.join(ROOT, 'shaders'), self.path('shaders'))
        with open(os.path.join(folder, 'resolve.comp'), encoding='utf-8') as file:
            source = file.read()
        at = source.index('void main()')
        scene = self.scene()
        shutil.copy(scene, self.path('other.json'))
        script = 'wait 1 samples\n'
        for turn in range(3):
            self.write(f'{turn}.comp', f'{source[:at]}\nshared float kept_{turn};\n{source[at:]}')
            script += ''.join(f'resize {60 + 20 * i} {90 - 10 * i}\n' for i in range(5))
            script += (f'copy {turn}.comp shaders/resolve.comp\nkey F5\nwait 2 frames\nwait idle\n'
                       'set view.split on\nset view.denoise on\nwait 1 samples\nkey w down\n'
                       'wait 3 frames\nkey w up\nset view.aov steps\nwait 1 samples\n'
                       'set view.aov radiance\nset view.split off\nset view.denoise off\n'
                       'set material.base_color 0.1,0.2,0.9\nset object.2.visible off\n'
                       'wait 1 samples\nkey Ctrl+z\nkey Ctrl+z\nkey F12\nkey F11\nkey Ctrl+s\n'
                       'drop other.json\nwait 5 frames\nwait 1 samples\n')
        self.view(script + 'lose-device\nwait 1 samples\nkey F12\nquit\n', '--spp', '1',
                  '--shaders', 'shaders', scene=scene, validation=False)

    def test_nothing_is_left_behind(self):
        """No temporary files remain, neither of compiling nor of pictures."""
        env = {**os.environ, 'TMPDIR': self.path('tmp')}
        os.mkdir(self.path('tmp'))
        self.view('wait 1 samples\nkey F5\nwait 2 frames\nwait idle\nkey F12\nkey F5\nquit\n',
                  '--spp', '1', env=env)
        self.assertEqual(os.listdir(self.path('tmp')), [])
        self.assertEqual(sorted(os.listdir(self.folder)),
                         ['cornell-0001.png', 'script.txt', 'tmp'])


if __name__ == '__main__':
    viewer_run.main()
