#!/usr/bin/env python3
"""Uses a window on a display (xvfb-run) with mouse and keys as people do.

    test_mouse_and_keys.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import viewer_run
from viewer_run import Case

SIZE = '640x400'


class Hands(Case):
    def use(self, script, **options):
        return self.view(script, '--spp', '1', window=True, size=SIZE, **options)

    def items(self):
        state = self.use('wait 1 samples\nstate state.json\n').state()
        return {item['id']: item for item in state['items']}

    def test_groups_open_and_close(self):
        items = self.items()
        groups = [name for name, item in items.items()
                  if item['kind'] == 'group' and '.' not in name]
        self.assertGreater(len(groups), 10)
        other = {'open': 'closed', 'closed': 'open'}
        script = 'wait 1 samples\n'
        for name in groups:
            value = items[name]['value']
            script += f'click {name}\nexpect item.{name} == {other[value]}\n'
            script += f'click {name}\nexpect item.{name} == {value}\n'
        self.use(script)

    def test_controls_of_all_kinds(self):
        """Clicks, drags and types into controls of all kinds, wherever the panel shows them."""
        items = self.items()
        script = 'wait 1 samples\n'
        for name in ('view.nearest', 'view.pause', 'renderer.nee', 'object.3.visible',
                     'renderer.pixel_jitter', 'files.with_panel', 'scene.watch'):
            value = items[name]['value']
            script += f'click {name}\nexpect item.{name} != {value}\n'
            script += f'click {name}\nexpect item.{name} == {value}\n'
        for name in ('view.exposure', 'camera.fov', 'renderer.roulette_min_bounces',
                     'renderer.max_bounces'):
            value = items[name]['value']
            script += f'drag {name} -24 0\nexpect item.{name} != {value}\n'
            script += f'key Ctrl+z\nexpect item.{name} == {value}\n'
        for name, word in (('view.tone', 'aces'), ('renderer.sampler', 'pcg'),
                           ('material.model', 'principled')):
            script += f'click {name}\nclick {name}={word}\nexpect item.{name} == {word}\n'
        script += 'click materials.2\nexpect item.materials.2 == on\n'
        script += 'click files.screenshot\nwait idle\nexpect message.text ~ .png\n'
        self.use(script)

    def test_keys(self):
        self.use('wait 1 samples\nkey F1\nexpect window.panel == false\nkey F1\n'
                 'expect window.panel == true\nkey Tab\nexpect item.view.aov == albedo\n'
                 'key Shift+Tab\nexpect item.view.aov == radiance\nkey c\n'
                 'expect rig.mode == orbit\nkey c\nkey v\nexpect item.view.split == on\nkey v\n'
                 'key n\nexpect item.view.denoise == on\nkey n\nkey Space\n'
                 'expect paused == true\nkey Space\nkey Ctrl+3\nkey w down\nwait 5 frames\n'
                 'key w up\nexpect counts.undo > 0\nstate moved.json\nkey 3\n'
                 'wait 2 frames\nkey h\nkey h\nkey F12\nwait idle\n'
                 'expect message.text ~ cornell-0001.png\n')

    def test_vsync(self):
        """Surfaces of lavapipe support presentation with and without vsync."""
        self.use('wait 1 samples\nexpect window.present_mode == fifo\nset view.vsync off\n'
                 'wait 3 frames\nexpect window.present_mode != fifo\nset view.vsync on\n'
                 'wait 3 frames\nexpect window.present_mode == fifo\n')

    def test_resizing(self):
        sizes = [(200 + 37 * i % 400, 150 + 53 * i % 300) for i in range(20)]
        self.use(''.join(f'resize {w} {h}\nexpect window.width == {w}\n' for w, h in sizes)
                 + 'wait 1 samples\nhash hash.jsonl\nscreenshot a.png panel\n')

    def test_closing(self):
        self.use('wait 1 samples\nclose\nwait 100000 frames\n')


if __name__ == '__main__':
    viewer_run.main()
