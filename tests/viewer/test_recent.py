#!/usr/bin/env python3
"""The list of recent scenes outlives the viewer (xvfb-run).

    test_recent.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import json
import os

import viewer_run
from viewer_run import Case


class Recent(Case):
    def use(self, script, **options):
        env = {**os.environ, 'XDG_STATE_HOME': self.path('state'), **options.pop('env', {})}
        return self.view(script, '--spp', '1', env=env, **{'window': True, **options})

    def listed(self):
        with open(self.path('state/lampyris/recent.json'), encoding='utf-8') as file:
            return json.load(file)['scenes']

    def test_the_list_is_kept(self):
        box, spheres = self.scene(), self.scene('spheres.json')
        self.use('wait 1 samples\nset scene.path spheres.json\nwait 3 frames\nwait 1 samples\n'
                 'expect scene ~ spheres.json\n', scene='cornell.json')
        self.assertEqual(self.listed(), [os.path.realpath(spheres), os.path.realpath(box)])
        # Without a scene, the tab of scenes is open, and shows the list.
        self.use('wait 3 frames\nexpect item.panel.scene == on\nexpect item.scene.recent == open\n'
                 'click scene.recent.1\nwait 3 frames\nwait 1 samples\n'
                 'expect scene ~ cornell.json\n', scene=None)
        self.assertEqual(self.listed(), [os.path.realpath(box), os.path.realpath(spheres)])

    def test_a_damaged_list_is_ignored(self):
        box = self.scene()
        os.makedirs(self.path('state/lampyris'))
        for text in ('{"lampyris_recent": 1, "scenes": [', '[]', '{"lampyris_recent": 2, "scenes": []}',
                     '{"lampyris_recent": 1, "scenes": [7]}', '{"lampyris_recent": 1, "scenes": 7}'):
            with self.subTest(text=text):
                self.write('state/lampyris/recent.json', text)
                self.use('wait 2 frames\nexpect message.text ~ "recent scenes is ignored"\n'
                         'expect message.text ~ recent.json\n', scene=None)
                self.use('wait 1 samples\n', scene='cornell.json')
                self.assertEqual(self.listed(), [os.path.realpath(box)])

    def test_a_folder_that_cannot_be_made(self):
        self.scene()
        self.write('file', '')
        self.use('wait 1 samples\nexpect message.text ~ "recent scenes is not kept"\n',
                 scene='cornell.json', env={'XDG_STATE_HOME': self.path('file')})

    def test_without_a_window_nothing_is_kept(self):
        self.scene()
        self.use('wait 1 samples\n', scene='cornell.json', window=False)
        self.assertFalse(os.path.exists(self.path('state')))


if __name__ == '__main__':
    viewer_run.main()
