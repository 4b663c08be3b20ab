#!/usr/bin/env python3
"""At the end, the viewer reports its speed and the error of the picture.

    test_report.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import unittest

import viewer_run
from viewer_run import CORNELL, SPHERES, Case

MOVES = 'wait 17 samples\nkey d down\nwait 10 frames\nkey d up\nwait 18 samples\n'


class Reports(Case):
    def test_json(self):
        report = self.view(MOVES, '--spp', '18', '--json').report()
        self.assertEqual(report['size'], {'width': 160, 'height': 90})
        self.assertEqual(report['scene'], CORNELL)
        self.assertEqual(report['recoveries'], 0)
        times = report['frame_ms']
        self.assertGreaterEqual(times['moving']['frames'], 10)
        self.assertGreater(times['resting']['frames'], 0)
        for kind in times.values():
            self.assertGreater(kind['median'], 0)
            self.assertGreaterEqual(kind['p95'], kind['median'])
        self.assertLess(times['moving']['frames'] + times['resting']['frames'],
                        report['frames'] + 1)
        self.assertLess(report['render_seconds'], report['seconds'])
        side, = report['sides']
        self.assertEqual(side['samples'], 18)
        self.assertEqual(side['error_samples'], 18, 'of the picture as it is at the end')
        self.assertLess(side['ci_low'], side['local_relmse'])
        self.assertLess(side['local_relmse'], side['ci_high'])

    def test_the_error_is_what_render_says(self):
        report = self.view('wait 20 samples\n', '--spp', '20', '--json', scene=SPHERES).report()
        rendered = self.render(SPHERES, '--spp', '20')
        for key in ('local_relmse', 'ci_high', 'at_most'):
            self.assertAlmostEqual(report['sides'][0][key], rendered['error'][key], 12)

    def test_two_sides(self):
        report = self.view('set view.split on\nwait 16 samples\n', '--json', '--spp',
                           '16').report()
        left, right = report['sides']
        self.assertEqual(left['local_relmse'], right['local_relmse'], 'the same settings')

    def test_why_it_is_not_known(self):
        report = self.view('wait 1 samples\n', '--json', '--spp', '1').report()
        side, = report['sides']
        self.assertIsNone(side['local_relmse'])
        self.assertEqual(side['reason'], 'fewer than two samples per pixel')

    def test_a_bound_where_there_is_no_interval(self):
        out = self.view('set renderer.halves contiguous\nwait 16 samples\n', '--spp', '16',
                        scene=SPHERES).out
        self.assertRegex(out, r'; at 16 spp local relMSE at most \S+ \(95 %\): contiguous halves')

    def test_text(self):
        text = self.view(MOVES, '--spp', '18').out
        for line in ('device ', 'scene ', 'frames ', 'moving ', 'resting ', 'picture '):
            self.assertIn('\n' + line, '\n' + text)
        self.assertIn('18 spp', text)
        self.assertIn(' local relMSE ', text)

    def test_quiet(self):
        self.assertEqual(self.view('wait 2 samples\n', '-q', '--spp', '2').out, '')

    def test_without_a_scene(self):
        report = self.view('wait 5 frames\n', '--json', scene=None).report()
        self.assertIsNone(report['scene'])
        self.assertEqual(report['sides'], [])
        self.assertIsNone(report['frame_ms']['moving']['median'])


if __name__ == '__main__':
    viewer_run.main()
