#!/usr/bin/env python3
"""Compares the displayed picture, pixel by pixel, with the files of `lampyris render`.

    test_pictures.py LAMPYRIS VIEWER SOURCE_ROOT
"""
import os
import subprocess

import png_pixels
import viewer_run
from viewer_run import CORNELL, LAMPYRIS, ROOT, SCENES, SIZE, Case

WIDTH = int(SIZE.split('x')[0])


class Pictures(Case):
    def render_png(self, name, *arguments):
        path = self.path(name)
        subprocess.run([LAMPYRIS, 'render', CORNELL, '--size', SIZE, '-q', '-o', path, *arguments],
                       check=True)
        return png_pixels.read(path)

    def pixels(self, name):
        return png_pixels.read(self.path(name))

    def test_tone_and_exposure(self):
        """Codes differ by at most 1 from those of `render`, because another device computes the
        logarithms."""
        for tone, stops in (('none', '0'), ('reinhard', '1'), ('aces', '-1.5'), ('agx', '0.5')):
            with self.subTest(tone):
                arguments = ['--spp', '4', '--tone', tone, '--exposure', stops]
                self.view('wait 4 samples\nwait 2 frames\nscreenshot seen.png\n', *arguments)
                difference = png_pixels.most_different(
                    self.pixels('seen.png'), self.render_png('render.png', *arguments), (0, WIDTH))
                self.assertLessEqual(difference, 1)

    def test_split_halves(self):
        """The left part shows the picture with one setting, the right part that with the other."""
        self.view('set view.split on\nset renderer.side B\nset renderer.max_bounces 1\n'
                  'wait 4 samples\nwait idle\nscreenshot seen.png\nhash a.jsonl a\nhash b.jsonl b\n'
                  'exr b.exr b\n', '--spp', '4', '--tone', 'none', '--exposure', '0')
        seen = self.pixels('seen.png')
        common = ['--spp', '4', '--tone', 'none', '--exposure', '0']
        left = self.render_png('a.png', *common)
        right = self.render_png('b.png', *common, '--max-bounces', '1')
        line = WIDTH // 2
        self.assertLessEqual(png_pixels.most_different(seen, left, (0, line - 2)), 1)
        self.assertLessEqual(png_pixels.most_different(seen, right, (line + 2, WIDTH)), 1)
        self.assertGreater(png_pixels.most_different(left, right, (line + 2, WIDTH)), 30)

    def test_exr_is_renders(self):
        """All pixels are equal, and the metadata describe how the picture was made."""
        self.view('wait 3 samples\nexr seen.exr\n', '--spp', '3')
        self.render(CORNELL, '--spp', '3')
        against = self.compare(self.path('seen.exr'), self.path('render.exr'))
        self.assertEqual(against.get('differing', against.get('images', [{}])[0].get('differing')),
                         0)
        with open(self.path('seen.exr'), 'rb') as file:
            head = file.read(8192)
        for key in (b'lampyris:image_hash', b'lampyris:view', b'lampyris:device', b'lampyris:spp'):
            self.assertIn(key, head)

    def test_aovs_show_surfaces(self):
        """The white and the red wall are shown without noise, and false colours have many shades."""
        for what in ('albedo', 'normal', 'objects', 'materials', 'depth', 'steps', 'variance'):
            with self.subTest(what):
                self.view(f'set view.aov {what}\nwait 4 samples\nwait idle\n'
                          'screenshot seen.png\n', '--spp', '4')
                colours = {bytes(row[i:i + 3]) for row in self.pixels('seen.png')[2]
                           for i in range(0, 3 * WIDTH, 3)}
                self.assertGreater(len(colours), 4)

    def test_denoised_is_smoother(self):
        """The denoised picture is near the converged one, and the film does not change."""
        scene = os.path.join(SCENES, 'cornell.json')
        self.view('wait 4 samples\nwait idle\nhash h.jsonl\nscreenshot noisy.png\n'
                  'set view.denoise on\nwait 4 samples\nwait idle\nwait 3 frames\nhash h.jsonl\n'
                  'screenshot smooth.png\nexr film.exr\nexr smooth.exr a denoised\n', '--spp', '4',
                  scene=scene)
        truth = self.render_png('truth.png', '--spp', '256')

        def error(name):
            return sum((x - y) ** 2 for row, other in zip(self.pixels(name)[2], truth[2])
                       for x, y in zip(row, other))
        self.assertLess(error('smooth.png'), 0.5 * error('noisy.png'))
        with open(self.path('h.jsonl'), encoding='utf-8') as file:
            self.assertEqual(len(set(file)), 1)

    def test_the_denoiser_follows_what_moves(self):
        """After a box has moved, one sample with the history of 64 is nearer to the truth. The film is the
        same."""
        scene = os.path.join(ROOT, 'tests', 'render', 'scenes', 'moved_box.json')
        errors, hashes = [], []
        self.render(scene, '-D', 'left=-0.1', '-D', 'right=0.9', '--spp', '256', size='128x86')
        for temporal in ('off', 'on'):
            self.view(f'set view.denoise on\nset view.denoise_temporal {temporal}\n'
                      'wait 64 samples\nset view.pause on\nset object.2 on\n'
                      'set object.position 0.4,0.5,0\nwait 1 frames\nwait 1 samples\n'
                      'wait 3 frames\nexpect sides.0.samples == 1\nhash hash.jsonl\n'
                      'exr seen.exr a denoised\n', scene=scene, size='128x86')
            errors.append(self.compare(self.path('seen.exr'), self.path('render.exr'))['relmse'])
            with open(self.path('hash.jsonl'), encoding='utf-8') as file:
                hashes += list(file)
        self.assertLess(errors[1], 0.95 * errors[0])
        self.assertEqual(hashes[0], hashes[-1])

    def test_the_outline_of_the_selected_object(self):
        """The outline is neither in the film nor in a picture without the panel."""
        result = self.view('wait idle\nhash hash.jsonl\nscreenshot before.png\nmouse 110 60\nbutton left\n'
                           'wait 4 frames\nexpect picked.distance > 0\nhash hash.jsonl\n'
                           'screenshot picked.png\nwait 4 frames\nscreenshot outlined.png panel\n'
                           'set objects.outline off\nwait 4 frames\nscreenshot again.png\n'
                           'screenshot bare.png panel\n'
                           'hash hash.jsonl\n', '--spp', '1')
        files = {}
        for name in ('before', 'picked', 'again', 'outlined'):
            with open(result.path(name + '.png'), 'rb') as file:
                files[name] = file.read()
        self.assertEqual(files['before'], files['picked'])
        self.assertEqual(files['before'], files['again'])
        hashes = [entry['image_hash'] for entry in result.hashes()]
        self.assertEqual(len(set(hashes)), 1, hashes)
        # Messages are at the top; the outline of the back wall reaches lower.
        outlined, bare = ((width, height, rows[45:]) for width, height, rows in
                          (self.pixels('outlined.png'), self.pixels('bare.png')))
        self.assertGreater(png_pixels.most_different(outlined, bare, (80, WIDTH)), 50)


if __name__ == '__main__':
    viewer_run.main()
