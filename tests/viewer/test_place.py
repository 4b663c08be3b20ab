#!/usr/bin/env python3
"""Tests the place of the picture in the window, what the mouse picks there, and the initial views of models.

    test_place.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import png_pixels
import viewer_run
from viewer_run import CORNELL, Case

SIZE = '320x180'  # the panel covers 128 pixels of the width
BOX = """v 3 0 0
v 7 0 0
v 7 2 0
v 3 2 0
v 3 0 1
v 7 0 1
v 7 2 1
v 3 2 1
f 1 2 3 4
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
"""


class Place(Case):
    def pixel(self, name, x, y):
        return tuple(png_pixels.read(self.path(name))[2][y][3 * x:3 * x + 3])

    def test_all_of_it_is_beside_the_panel(self):
        """Both walls are seen, and the film is the one of the window's size, panel or not."""
        result = self.view('wait 4 samples\nwait 2 frames\nhash hash.jsonl\nstate shown.json\n'
                           'screenshot shown.png panel\nscreenshot alone.png\nkey F1\n'
                           'wait 2 frames\nhash hash.jsonl\nstate hidden.json\n'
                           'screenshot hidden.png panel\nkey F1\nwait 2 frames\n'
                           'state again.json\n', '--spp', '4', size=SIZE)
        self.assertEqual(result.state('shown.json')['window']['picture'], [128, 36, 192, 108])
        self.assertEqual(result.state('again.json')['window']['picture'], [128, 36, 192, 108])
        self.assertEqual(result.state('hidden.json')['window']['picture'], [0, 0, 320, 180])
        shown, hidden = result.hashes()
        self.assertEqual(shown, hidden)
        self.assertEqual(shown['image_hash'],
                         self.render(CORNELL, '--spp', '4', size=SIZE)['image_hash'])
        for name, left, top, width, height in (('shown.png', 128, 36, 192, 108),
                                               ('alone.png', 0, 0, 320, 180),
                                               ('hidden.png', 0, 0, 320, 180)):
            with self.subTest(name):
                red, green = (self.pixel(name, left + int(part * width), top + height // 2)
                              for part in (0.27, 0.73))
                self.assertGreater(red[0], 2 * red[1])
                self.assertGreater(green[1], green[0])
        for y in (20, 170):
            self.assertEqual(self.pixel('shown.png', 224, y), (0, 0, 0))

    def test_the_mouse_meets_what_is_seen(self):
        """A click on a displayed pixel picks the surface in that pixel of the film; beside the picture it
        picks nothing."""
        click = 'button left\nwait 3 frames\n'
        result = self.view('wait 2 samples\nmouse 224 51\n' + click + 'state shown.json\n'
                           'mouse 224 10\n' + click + 'state beside.json\nkey F1\nwait 2 frames\n'
                           'mouse 160 25\n' + click + 'state hidden.json\n', '--spp', '2', size=SIZE)
        shown, beside, hidden = (result.state(name)['picked']
                                 for name in ('shown.json', 'beside.json', 'hidden.json'))
        self.assertGreater(shown['distance'], 0)
        self.assertEqual(shown, hidden)
        self.assertNotEqual(beside, shown)

    def test_the_line_follows_the_mouse(self):
        """The dividing line is dragged from the middle of the picture to a quarter of it."""
        self.view('set view.split on\nwait 2 samples\nmouse 224 90\nbutton left down\n'
                  'mouse 200 90\nmouse 176 90\nbutton left up\nwait 2 frames\n'
                  'expect item.view.split_at == 0.25\n', '--spp', '2', size=SIZE)

    def test_models_are_exposed(self):
        """The exposure is computed from the luminance until the user sets it."""
        self.view('wait 16 samples\nexpect item.view.exposure_auto == on\n'
                  'expect item.view.exposure != 0\nexpect item.view.tone == aces\n'
                  'set view.exposure 1\nwait 3 frames\nexpect item.view.exposure_auto == off\n'
                  'expect item.view.exposure == 1\n', scene=self.write('box.obj', BOX), size=SIZE)

    def test_models_open_in_orbit(self):
        """The camera orbits the model's centre. Home shows the whole model again, also after the window's
        size has changed."""
        model = self.write('box.obj', BOX)
        turn = ('mouse 224 90\nbutton right down\nmouse 254 100\nbutton right up\n'
                'wait 2 frames\nscroll 0 3\nwait 2 frames\nmouse 224 90\nbutton middle down\n'
                'mouse 264 90\nbutton middle up\nwait 2 frames\n')
        result = self.view('wait 1 samples\nstate opened.json\n' + turn + 'state turned.json\n'
                           'key Home\nwait 2 frames\nstate home.json\nresize 180 320\n'
                           'wait 2 frames\nstate narrow.json\nkey Home\nwait 2 frames\n'
                           'state fitted.json\n', '--spp', '2', scene=model, size=SIZE)
        opened, turned, home, narrow, fitted = (
            result.state(f'{name}.json')
            for name in ('opened', 'turned', 'home', 'narrow', 'fitted'))
        self.assertEqual(opened['rig']['mode'], 'orbit')
        for at, middle in zip(opened['rig']['target'], (5, 1, 0.5)):
            self.assertAlmostEqual(at, middle, 6)
        self.assertNotEqual(turned['camera'], opened['camera'])
        self.assertNotEqual(turned['rig']['target'], opened['rig']['target'])
        self.assertEqual(home['camera'], opened['camera'])
        self.assertEqual(home['rig']['target'], opened['rig']['target'])
        self.assertEqual(narrow['camera'], home['camera'])
        self.assertNotEqual(fitted['camera'], home['camera'])
        result = self.view('wait 1 samples\nstate opened.json\n', '--spp', '2', scene=model,
                           size='180x320')
        self.assertEqual(fitted['camera'], result.state('opened.json')['camera'])

    def test_scenes_with_a_camera_open_as_before(self):
        """Home restores the scene's camera, and the camera flies."""
        result = self.view('wait 1 samples\nstate opened.json\nkey W down\nwait 3 frames\n'
                           'key W up\nwait 2 frames\nstate flown.json\nkey Home\nwait 2 frames\n'
                           'state home.json\n', '--spp', '1', size=SIZE)
        opened, flown, home = (result.state(f'{name}.json') for name in ('opened', 'flown', 'home'))
        self.assertEqual(opened['rig']['mode'], 'fly')
        self.assertNotEqual(flown['camera'], opened['camera'])
        self.assertEqual(home['camera'], opened['camera'])


if __name__ == '__main__':
    viewer_run.main()
