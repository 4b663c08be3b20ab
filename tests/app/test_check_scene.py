#!/usr/bin/env python3
"""Tests `lampyris check SCENE`. Each finding must appear for a scene in which it was planted, and none for
the clean counterpart. After --fix, a check of the fixed scene must not report it. This file tests findings
about form, media and textures, and the output.

Usage: test_check_scene.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import base64
import html
import math
import os
import re
import subprocess
import unittest

from scene_checks import Checks, FILM, FRONT, GREY, LAMPYRIS, SOURCE, box, read_png, write_exr, write_png


class Geometry(Checks):
    def scene(self, planted):
        self.write('thin.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' + ('f 1 2 2\n' if planted else ''))
        height = 1e-7 if planted else 1e-2
        self.write('slivers.obj', ''.join(
            f'v {i} 0 0\nv {i + 1} 0 0\nv {i + 0.5} {height} 0\nf -3 -2 -1\n' for i in range(8)))
        turned = -1 if planted else 1
        self.write('normals.obj', 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n'
                   f'vn 0.1 0 {turned}\nf 1//1 2//1 3//2\nf 1//1 3//2 4//2\n')
        self.write('box.obj', box((0, 0, 0), (1, 1, 1)))

        def mesh(name, x, y, scale=1, **more):
            return {'type': 'mesh', 'file': name, 'material': 'grey',
                    'transform': [{'scale': scale}, {'translate': [x, y, 0]}], **more}
        return {
            'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
            'shapes': [
                mesh('thin.obj', -2.5, 1.5), mesh('slivers.obj', -2.5, 0, 0.5),
                mesh('normals.obj', -2.5, -2.5), mesh('box.obj', 0, 1.5, [1, 0 if planted else 1, 1]),
                {'type': 'sphere', 'material': 'grey', 'center': [0, -1, 0], 'radius': 0.6},
                {'type': 'sphere', 'material': 'red', 'center': [0, -1 if planted else -2.3, 0],
                 'radius': 0.6},
                {'type': 'quad', 'material': 'grey', 'corner': [1.5, 0, 0], 'u': [1, 0, 0], 'v': [0, 1, 0]},
                {'type': 'quad', 'material': 'red', 'corner': [1.9, 0.3, 0 if planted else -0.1],
                 'u': [1, 0, 0], 'v': [0, 1, 0]},
            ]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True))
        self.assert_found(found, {
            'zero-area': 'remark', 'sliver': 'remark', 'normals': 'wrong',
            'singular-transform': 'remark', 'object-twice': 'wrong', 'coincident-faces': 'wrong'})
        self.assertIn('triangle 1', found['zero-area']['place'])
        self.assertIn('thin', found['zero-area']['place'])
        self.assertIn('1 of ', found['singular-transform']['figure'])
        # The expected share: 36 square metres, in pixels that a disc changes or that its rim crosses; pixels
        # are an eighth of a metre wide. Below, the share in which the two quads coincide.
        share = found['object-twice']['share']
        self.assertTrue(math.pi * 0.6 ** 2 / 36 < share < math.pi * 0.725 ** 2 / 36, share)
        self.assertAlmostEqual(found['coincident-faces']['share'], 0.6 * 0.7 / 36, delta=0.004)
        self.assertAlmostEqual(found['normals']['share'], 1 / 36, delta=0.006)
        self.assert_found(self.check(self.scene(False)), {})

    # Each shape has a mesh of its own; all have the same triangles.
    def test_meshes_of_equal_files(self):
        def scene(x, material='grey'):
            self.write('box.obj', box((0, 0, 0), (1, 1, 1)))
            return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                    'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
                    'shapes': [{'type': 'mesh', 'file': 'box.obj', 'material': material,
                                'transform': [{'translate': [x, 0, 0]}]}
                               for x, material in ((0, 'grey'), (x, material))]}
        self.assert_found(self.check(scene(1.5)), {})
        self.assert_found(self.check(scene(0)), {'object-twice': 'remark'})
        self.assert_found(self.check(scene(0, 'red')), {'object-twice': 'wrong'})

    def test_fixed(self):
        fixed = os.path.join(self.folder.name, 'fixed.json')
        found = self.check(self.scene(True), '--fix', fixed)
        changed = {name for name, finding in found.items() if finding['change']}
        self.assertEqual(changed, {'singular-transform'})
        self.assertEqual(set(self.check_file(fixed)), set(found) - changed)


class Normals(Checks):
    """A ball of triangles whose normals are computed by a given function."""

    def found(self, normal, **material):
        rings, around = 8, 16
        points = [(math.sin(math.pi * i / rings) * math.cos(2 * math.pi * k / around),
                   math.cos(math.pi * i / rings),
                   math.sin(math.pi * i / rings) * math.sin(2 * math.pi * k / around))
                  for i in range(rings + 1) for k in range(around + 1)]
        lines = ['v %g %g %g\nvn %g %g %g' % (*point, *normal(*point)) for point in points]
        for i in range(rings):
            for k in range(around):
                a, b = i * (around + 1) + k + 1, (i + 1) * (around + 1) + k + 1
                corners = [a, a + 1, b + 1, b][i == 0:4 - (i == rings - 1)]
                lines.append('f ' + ' '.join(f'{x}//{x}' for x in corners))
        self.write('ball.obj', '\n'.join(lines) + '\n')
        return self.check({'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                           'materials': {'grey': {**GREY, **material}},
                           'shapes': [{'type': 'mesh', 'file': 'ball.obj', 'material': 'grey'}]})

    def test_of_another_form(self):
        """All of the ball is counted, not only the parts where the normals are wrong by a large angle."""
        for normal in (lambda x, y, z: (0, 1, 0), lambda x, y, z: (x, z, -y)):
            found = self.found(normal)
            self.assert_found(found, {'normals': 'wrong'})
            self.assertIn('60 degrees off', found['normals']['figure'])
            self.assertAlmostEqual(found['normals']['share'], math.pi / 36, delta=0.01)
        self.assertNotIn('normals', self.found(lambda x, y, z: (0, 1, 0), opacity=0.9))  # a bush

    def test_of_its_form(self):
        """The normals point outwards, inwards, or are those of a much smoother form."""
        for normal in (lambda x, y, z: (x, y, z), lambda x, y, z: (-x, -y, -z),
                       lambda x, y, z: (x, 2 * y, z)):
            self.assert_found(self.found(normal), {})

    def test_maps(self):
        """Texels of normal maps that point downwards are reported. Black texels between the parts of an atlas
        are not."""
        for texel, expected in (((128, 128, 255, 255), None), ((0, 0, 0, 255), None),
                                ((128, 128, 0, 255), 'remark')):
            write_png(os.path.join(self.folder.name, 'map.png'), 2, 1, [[(128, 128, 255, 255), texel]])
            found = self.check({
                'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'materials': {'grey': {**GREY, 'textures': [{'file': 'map.png', 'use': 'normal'}]}},
                'shapes': [{'type': 'quad', 'material': 'grey', 'corner': [-1, -1, 0], 'u': [2, 0, 0],
                            'v': [0, 2, 0]}]})
            self.assertEqual(found.get('normals', {}).get('level'), expected)
        self.assertIn('1 of 2 texels', found['normals']['figure'])
        self.assertAlmostEqual(found['normals']['share'], 4 / 36, delta=0.006)


class Media(Checks):
    def scene(self, planted):
        self.write('closed.obj', box((-2.8, 1.6, 0), (-1.8, 2.6, 1), inside_out=planted))
        self.write('open.obj', box((-1.4, 1.6, 0), (-0.4, 2.6, 1), 'bcdef' if planted else 'abcdef'))
        nested = [{'type': 'sphere', 'material': f'layer{i}', 'center': [2, 2, 0],
                   'radius': 0.9 - 0.15 * i} for i in range(5 if planted else 4)]
        materials = {f'layer{i}': {'type': 'dielectric', 'ior': 1.1 + 0.1 * i, 'priority': 2 + i}
                     for i in range(5)}
        return {
            'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'bubble': {'type': 'dielectric', 'ior': 1.0,
                                                   'priority': 1 if planted else 2},
                          'glass': {'type': 'dielectric', 'ior': 1.5},
                          'water': {'type': 'dielectric', 'ior': 1.33,
                                    'priority': 1 if planted else 2}, **materials},
            'shapes': [
                {'type': 'mesh', 'file': 'closed.obj', 'material': 'glass'},
                {'type': 'mesh', 'file': 'open.obj', 'material': 'glass'},
                {'type': 'sphere', 'material': 'glass', 'center': [-2, 0, 0], 'radius': 0.9},
                {'type': 'sphere', 'material': 'bubble', 'center': [-2, 0, 0], 'radius': 0.5},
                {'type': 'sphere', 'material': 'glass', 'center': [0, 0, 0], 'radius': 0.7},
                {'type': 'sphere', 'material': 'water', 'center': [0.6, 0, 0], 'radius': 0.7},
                {'type': 'sdf', 'material': 'glass', 'transform': {'translate': [-0.5, -2, 0]},
                 'field': {'type': 'sphere', 'radius': 0.6}},
                *nested]}

    def test_planted_and_clean(self):
        found = self.check(self.scene(True))
        for follows in ('depth', 'heavy-tail'):  # findings about paths in a medium that does not exist
            found.pop(follows, None)
        self.assert_found(found, {'medium-not-entered': 'wrong', 'medium-not-left': 'wrong',
                                  'media-overlap': 'wrong', 'media-nested': 'wrong'})
        overlaps = [f for f in self.result['findings'] if f['name'] == 'media-overlap']
        self.assertEqual({(f['level'], 'bubble' in f['place'], 'water' in f['place'])
                          for f in overlaps}, {('wrong', True, False), ('remark', False, True)})
        self.assertIn('closed', found['medium-not-entered']['place'])
        self.assertIn('open', found['medium-not-left']['place'])
        self.assertAlmostEqual(found['medium-not-left']['share'], 1 / 36, delta=0.006)
        self.assertIn('layer4', found['media-nested']['place'])
        self.assert_found(self.check(self.scene(False)), {})

    def test_fixed(self):
        fixed = os.path.join(self.folder.name, 'fixed.json')
        self.check(self.scene(True), '--fix', fixed)
        overlaps = [f['change'] for f in self.result['findings'] if f['name'] == 'media-overlap']
        self.assertEqual(sum(change is not None for change in overlaps), 1)
        # Water still has a higher priority than the bubble, so its priority must exceed that of the glass,
        # too.
        self.assertNotIn('media-overlap', self.check_file(fixed))

    def test_a_body_that_pokes_out_of_the_cameras(self):
        # A medium that the camera is in is not attributed to an object until a line has left it.
        found = self.check({
            'film': {'width': 64, 'height': 64},
            'camera': {'position': [0, 1, 4], 'target': [0, 0.5, 0], 'fov_degrees': 40},
            'materials': {'clay': {'base_color': [0.6, 0.4, 0.3]}, 'lamp': {'emission': [12, 11, 9]},
                          'glass': {'type': 'dielectric', 'ior': 1.5},
                          'other': {'type': 'dielectric', 'ior': 1.3}},
            'shapes': [
                {'type': 'quad', 'material': 'clay', 'corner': [-2, 0, 2], 'u': [4, 0, 0], 'v': [0, 0, -4]},
                {'type': 'disc', 'material': 'lamp', 'center': [0, 3, 0], 'normal': [0, -1, 0], 'radius': 0.5},
                {'type': 'sphere', 'material': 'glass', 'center': [0, 1, 4], 'radius': 0.5},
                {'type': 'sphere', 'material': 'other', 'center': [0.4, 1, 3.6], 'radius': 0.5}]})
        self.assertIn('media-overlap', found)


class Textures(Checks):
    """Textures that scale a base colour of 1, which is the usual factor of an image."""

    def scene(self, texels, **material):
        write_exr(os.path.join(self.folder.name, 'paint.exr'), len(texels[0]), len(texels),
                  [[(x, x, x) for x in row] for row in texels])
        image = [{'file': 'paint.exr', 'parameters': {'base_color': 'rgb'}}]
        return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                'materials': {'paint': {**material, 'base_color': [1, 1, 1], 'textures': image}},
                'shapes': [{'type': 'sphere', 'material': 'paint', 'center': [0, 0, 0], 'radius': 2}]}

    def test_gains(self):
        varnish = {'type': 'microfacet', 'roughness': 0.1, 'specular_color': [0.04] * 3,
                   'diffuse': 'uncoupled'}
        self.assert_found(self.check(self.scene([[0.05] * 4] * 4, **varnish)), {})
        # One bright texel reflects too much light, whatever the mean over all texels is.
        found = self.check(self.scene([[0.05] * 4, [0.05, 0.05, 0.95, 0.05]], **varnish))
        self.assert_found(found, {'gains-light': 'wrong'})
        self.assertIn('paint', found['gains-light']['place'])

    def test_vertex_colors(self):
        varnish = {'type': 'microfacet', 'roughness': 0.1, 'specular_color': [0.04] * 3,
                   'diffuse': 'uncoupled', 'base_color': [1, 1, 1]}

        def scene(brightest):
            self.write('quad.ply', 'ply\nformat ascii 1.0\nelement vertex 4\n'
                       'property float x\nproperty float y\nproperty float z\nproperty uchar red\n'
                       'property uchar green\nproperty uchar blue\nelement face 1\n'
                       'property list uchar int vertex_indices\nend_header\n'
                       + ''.join(f'{x} {y} 0 {level} {level} {level}\n' for x, y, level in
                                 ((-1, -1, 9), (1, -1, 9), (1, 1, brightest), (-1, 1, 9)))
                       + '4 0 1 2 3\n')
            return {'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
                    'materials': {'paint': varnish},
                    'shapes': [{'type': 'mesh', 'file': 'quad.ply', 'material': 'paint'}]}
        for instancing in ('auto', 'on'):
            self.assert_found(self.check(scene(20), '--instances', instancing), {})
            self.assert_found(self.check(scene(255), '--instances', instancing),
                              {'gains-light': 'wrong'})

    def test_white(self):
        self.assert_found(self.check(self.scene([[0.8] * 4] * 4)), {})
        self.assert_found(self.check(self.scene([[1, 0.8], [0.8, 0.8]])), {})
        self.assert_found(self.check(self.scene([[1, 1], [1, 0.8]])), {'albedo-1': 'remark'})
        found = self.check(self.scene([[2, 2], [2, 0.8]]))
        self.assert_found(found, {'albedo-1': 'remark', 'texels-above-1': 'remark'})
        self.assertIn('3 of 4 texels are above 1, up to 2', found['texels-above-1']['figure'])
        self.assertAlmostEqual(found['albedo-1']['share'], 3.14159 * 4 / 36, delta=0.02)


class Black(Checks):
    def test_light_inside_of_a_ball(self):
        def scene(place):
            return {'camera': FRONT, 'materials': {'grey': GREY},
                    'lights': [{'type': 'point', 'position': [0, 0, place], 'intensity': [5, 5, 5]}],
                    'shapes': [{'type': 'sphere', 'material': 'grey', 'center': [0, 0, 0], 'radius': 1}]}
        found = self.check(scene(0))
        self.assert_found(found, {'black': 'wrong'})
        self.assertEqual(found['black']['share'], 1)
        self.assert_found(self.check(scene(4)), {})


class Report(Checks):
    def test_pictures_mark_the_places(self):
        """The red part of a finding's picture agrees with its share: pi / 9 for a white ball."""
        page = os.path.join(self.folder.name, 'page.html')
        found = self.check({'camera': FRONT, 'materials': {'white': {'base_color': [1, 1, 1]}},
                            'environment': {'radiance': [1, 1, 1]},
                            'shapes': [{'type': 'sphere', 'material': 'white', 'center': [0, 0, 0],
                                        'radius': 2}]}, '--report', page)
        self.assert_found(found, {'albedo-1': 'remark'})
        with open(page, encoding='utf-8') as file:
            text = file.read()
        self.assertIn('<h2>albedo-1</h2>', text)
        for part in ('place', 'figure', 'consequence', 'remedy'):
            self.assertIn(html.escape(found['albedo-1'][part]), text)
        plain, marked = (read_png(base64.b64decode(data))
                         for data in re.findall('src="data:image/png;base64,([^"]*)"', text))
        self.assertEqual([(len(rows), len(rows[0])) for rows in (plain, marked)], 2 * [(48, 48)])
        red = [(r > g) for row in marked for r, g, _ in row]
        self.assertTrue(red[24 * 48 + 24] and not red[0])
        self.assertAlmostEqual(sum(red) / len(red), found['albedo-1']['share'])
        self.assertAlmostEqual(found['albedo-1']['share'], 3.14159 / 9, delta=0.01)

    def test_what_cannot_be_written_is_found_first(self):
        """This is reported before a device is opened: even without any device, the error is about the
        file."""
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        environment = {**os.environ, 'VK_ICD_FILENAMES': '/nowhere', 'VK_DRIVER_FILES': '/nowhere'}
        for page, code in ((scene, 2), (os.path.join(self.folder.name, 'page.json'), 2),
                           (os.path.join(self.folder.name, 'no', 'page.html'), 4),
                           (os.path.join(self.folder.name, 'page.htm'), 69),
                           (os.path.join(self.folder.name, 'page.html'), 69)):
            result = subprocess.run([LAMPYRIS, 'check', scene, '--report', page], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                                    env=environment)
            self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(os.listdir(self.folder.name), [])

    @unittest.skipUnless(hasattr(os, 'symlink'), 'there are no symbolic links')
    def test_a_page_that_is_the_fixed_scene(self):
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        environment = {**os.environ, 'VK_ICD_FILENAMES': '/nowhere', 'VK_DRIVER_FILES': '/nowhere'}
        page, fixed = (os.path.join(self.folder.name, name) for name in ('page.html', 'fixed.json'))
        os.symlink(fixed, page)
        result = subprocess.run([LAMPYRIS, 'check', scene, '--report', page, '--fix', fixed], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                                env=environment)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn('are the same file', result.stderr)
        self.assertFalse(os.path.exists(fixed))


class Words(Checks):
    def test_extreme_pictures(self):
        """Scenes without objects but with light, and pictures with a single row of pixels or a single
        pixel."""
        for film in ({'width': 16384, 'height': 1}, {'width': 1, 'height': 1}):
            self.assert_found(self.check({
                'camera': {'position': [0, 0, 8], 'target': [0, 0, 0], 'fov_degrees': 40},
                'environment': {'radiance': [1, 1, 1]}, 'film': film, 'shapes': []}), {})

    def test_what_cannot_be_fixed_is_found_first(self):
        """This is reported before a device is opened: even without any device, the error is about the
        file."""
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        environment = {**os.environ, 'VK_ICD_FILENAMES': '/nowhere', 'VK_DRIVER_FILES': '/nowhere'}
        for out, code in ((scene, 2), (os.path.join(self.folder.name, 'out.txt'), 2),
                          (os.path.join(self.folder.name, 'no', 'out.json'), 4),
                          (os.path.join(self.folder.name, 'out.json'), 69)):
            result = subprocess.run([LAMPYRIS, 'check', scene, '--fix', out], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                                    env=environment)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertFalse(out != scene and os.path.exists(out))

    def test_what_is_of_devices_is_refused(self):
        scene = os.path.join(SOURCE, 'scenes', 'cornell.json')
        for arguments in (['--long'], ['--list'], ['--only', 'bits']):
            result = subprocess.run([LAMPYRIS, 'check', scene, *arguments], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(f'{arguments[0]} is for devices', result.stderr)

    @unittest.skipUnless(os.path.exists('/dev/full'), 'there is no /dev/full')
    def test_a_finding_that_cannot_be_written(self):
        """The error is that the finding could not be written."""
        quad = {'type': 'quad', 'corner': [-1, -1, 0], 'u': [2, 0, 0], 'v': [0, 2, 0]}
        path = self.write('twice.json', {
            'lampyris': 1, 'film': FILM, 'camera': FRONT, 'environment': {'radiance': [1, 1, 1]},
            'materials': {'grey': GREY, 'red': {'base_color': [0.6, 0.1, 0.1]}},
            'shapes': [{**quad, 'material': 'grey'}, {**quad, 'material': 'red'}]})
        for out, code in (('/dev/null', 1), ('/dev/full', 4)):
            with open(out, 'w', encoding='utf-8') as file:
                result = subprocess.run([LAMPYRIS, 'check', path, '-q'], stdout=file, text=True,
                                        stderr=subprocess.PIPE, timeout=600)
            self.assertEqual(result.returncode, code, result.stderr)

    def test_a_clean_scene_is_one_line(self):
        path = os.path.join(SOURCE, 'scenes', 'cornell.json')
        result = subprocess.run([LAMPYRIS, 'check', path, '--size', '48x48', '-q'], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=600)
        self.assertEqual((result.returncode, result.stdout.count('\n')), (0, 1), result.stdout)
        self.assertRegex(result.stdout, r'nothing found that makes its picture wrong, noisy or slow; local relMSE 0.001 '
                         r'takes .* spp, .* s of rendering and .* MiB on the device')


if __name__ == '__main__':
    unittest.main()
