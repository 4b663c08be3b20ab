#!/usr/bin/env python3
"""In orbit mode, drags turn the camera about the surface under the mouse.

    test_orbit.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import math

import viewer_run
from viewer_run import Case


def distance(a, b):
    return math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)))


class Orbit(Case):
    def drag(self, script):
        """Returns the states before and after a script in orbit mode."""
        result = self.view('wait 1 samples\nset camera.mode orbit\nwait 2 frames\nstate before.json\n'
                           + script + 'wait 4 frames\nstate after.json\n', '--spp', '1')
        return result.state('before.json'), result.state('after.json')

    def check_turns_about(self, point, before, after):
        self.assertLess(distance(after['rig']['target'], point), 1e-9)
        way = distance(before['camera']['position'], point)
        self.assertLess(abs(distance(after['camera']['position'], point) - way), 1e-6 * way)

    def test_about_the_surface_under_the_mouse(self):
        # A click shows where the surface is; the drag begins in the same place.
        for button in ('left', 'right'):
            with self.subTest(button=button):
                result = self.view('wait 1 samples\nset camera.mode orbit\nmouse 110 60\nbutton left\n'
                                   'wait 3 frames\nstate before.json\n'
                                   f'button {button} down\nwait 2 frames\nmouse 118 60\nmouse 126 60\n'
                                   f'wait 3 frames\nbutton {button} up\nwait 3 frames\n'
                                   'state after.json\n', '--spp', '1')
                before, after = result.state('before.json'), result.state('after.json')
                self.check_turns_about(before['picked']['position'], before, after)
                # 16 of the 160 pixels of the window are a tenth of half a turn, about the vertical.
                point = before['picked']['position']
                angles = [math.atan2(state['camera']['position'][0] - point[0],
                                     state['camera']['position'][2] - point[2])
                          for state in (before, after)]
                turned = abs(math.remainder(angles[1] - angles[0], 2 * math.pi))
                self.assertAlmostEqual(turned, 0.1 * math.pi, places=6)

    def test_about_the_last_target_where_there_is_no_surface(self):
        # The Cornell box is open: with a wide view, the corner of the picture shows the environment.
        before, after = self.drag('set camera.fov 120\nwait 1 samples\nmouse 66 26\nbutton left down\n'
                                  'mouse 74 26\nmouse 82 26\nwait 3 frames\nbutton left up\n')
        self.assertNotEqual(before['camera']['position'], after['camera']['position'])
        self.check_turns_about(before['rig']['target'], before, after)


if __name__ == '__main__':
    viewer_run.main()
