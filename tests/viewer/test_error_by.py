#!/usr/bin/env python3
"""The viewer reports the same sources of the error as `lampyris render` for the same picture.

    test_error_by.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import json
import subprocess

import viewer_run
from viewer_run import LAMPYRIS, Case

SIZE = '80x240' # high enough for a control below the panel's tabs


class ErrorBy(Case):
    def test_it_says_what_render_says(self):
        result = self.view('set renderer.spp 8\nset statistics.error_by emitter\nwait idle\n'
                           'hash hash.jsonl\nscene saved.json\nstate state.json\n'
                           'click statistics.error\nwait 2 frames\nscreenshot panel.png panel\n',
                           '--json', scene=self.scene('glass.json'), size=SIZE)
        shown = result.state()['sides'][0]['error_by']
        told = self.render(self.path('saved.json'), '--error-by', 'emitter', size=SIZE)
        self.assertEqual(result.hashes()[-1]['image_hash'], told['image_hash'])
        self.assertEqual(result.report()['sides'][0]['error_by'], shown)
        commands = [path.pop('command') for path in told['error_by']['brightest']]
        self.assertEqual([path.pop('command') for path in shown['brightest']], [None] * 10)
        self.assertEqual(shown, told['error_by'])
        # The saved scene is sufficient to follow a path.
        path = told['error_by']['brightest'][0]
        followed = subprocess.run(
            [LAMPYRIS, 'render', self.path('saved.json'), '--size', SIZE, '--pixel',
             '%d,%d' % tuple(path['pixel']), '--sample', str(path['sample']), '--json'],
            stdout=subprocess.PIPE, text=True, check=True)
        vertices = json.loads(followed.stdout)['vertices']
        self.assertIn(path['scattering_events'] - (path['found_by'] == 'shadow ray'),
                      [vertex['bounce'] for vertex in vertices])
        self.assertIn('--sample %d' % path['sample'], commands[0])

    def test_nothing_of_it_unless_asked(self):
        result = self.view('set renderer.spp 4\nwait idle\nstate state.json\n', '--json',
                           scene=self.scene('glass.json'), size=SIZE)
        side = result.state()['sides'][0]
        self.assertIsNone(side['error_by'])
        self.assertIsNone(result.report()['sides'][0]['error_by'])


if __name__ == '__main__':
    viewer_run.main()
