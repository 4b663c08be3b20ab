#!/usr/bin/env python3
"""No output may replace a file that the run reads: this is refused before rendering, with exit code 2 and
both names. Also tests outputs through links.

Usage: test_outputs.py LAMPYRIS SOURCE_ROOT [unittest arguments]
"""
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
SOURCE = os.path.abspath(sys.argv.pop(1))
ENVIRONMENT = {**os.environ, 'ASAN_OPTIONS': 'detect_leaks=0'}
QUAD = {'type': 'quad', 'corner': [-1, 0, 1], 'u': [2, 0, 0], 'v': [0, 0, -2], 'material': 'm'}


def png(path):
    """Writes a PNG with one grey pixel."""
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 1, 1, 8, 0, 0, 0, 0)) +
                   chunk(b'IDAT', zlib.compress(b'\0\x80')) + chunk(b'IEND', b''))


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.write('plain.json', {'lampyris': 1, 'materials': {'m': {}}, 'shapes': [QUAD],
                                  'environment': {'radiance': [1, 1, 1]}})

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def real(self, name):
        return os.path.join(os.path.realpath(self.folder.name), name)

    def write(self, name, content):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(content if isinstance(content, str) else json.dumps(content))

    def contents(self):
        """Returns the contents of all files except links."""
        found = {}
        for folder, _, names in os.walk(self.folder.name):
            for name in names:
                path = os.path.join(folder, name)
                if not os.path.islink(path):
                    with open(path, 'rb') as file:
                        found[path] = file.read()
        return found

    def run_here(self, *arguments):
        return subprocess.run([LAMPYRIS, *arguments], cwd=self.folder.name, env=ENVIRONMENT,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60)

    def render(self, *arguments):
        return self.run_here('render', *arguments, '--size', '8x8', '--spp', '1')

    def refused(self, result, output, read):
        self.assertEqual((result.returncode, result.stdout), (2, ''), result.stderr)
        same = f'{output}: is read by this run'
        other = f'{output}: is the file {read}, which this run reads'
        self.assertIn(same if output == read else other, result.stderr)
        self.assertNotIn('Rendering', result.stderr)

    def check(self, output, read, *arguments):
        """Files that a scene names are compared by their real paths."""
        read = read or self.real(output)
        before = self.contents()
        self.refused(self.run_here(*arguments), output, read)
        self.assertEqual(self.contents(), before)


class Inputs(Folder):
    """The number of samples would take hours, so the test shows that nothing is rendered."""
    LONG = ('--size', '64x64', '--spp', '1G')

    def test_textures(self):
        png(self.path('w.png'))
        scene = {'lampyris': 1, 'shapes': [QUAD],
                 'materials': {'m': {'textures': [{'file': 'w.png', 'parameters': {'base_color': 'rgb'}}]}}}
        self.write('w.json', scene)
        self.check('w.png', None, 'render', 'w.json', '-o', 'w.png', *self.LONG)
        self.check('w.png', None, 'render', 'w.json', '-o', 'a.exr', '-o', 'w.png', *self.LONG)

    def test_links_and_other_names(self):
        png(self.path('w.png'))
        self.write('w.json', {'lampyris': 1, 'shapes': [QUAD], 'materials': {
            'm': {'textures': [{'file': 'w.png', 'parameters': {'base_color': 'rgb'}}]}}})
        os.symlink('w.png', self.path('soft.png'))
        os.link(self.path('w.png'), self.path('hard.png'))
        os.mkdir(self.path('there'))
        for name in ('soft.png', 'hard.png', 'there/../w.png', self.path('w.png')):
            self.check(name, self.real('w.png'), 'render', 'w.json', '-o', name, *self.LONG)

    def test_environments_and_references(self):
        self.assertEqual(self.render('plain.json', '-o', 'e.exr').returncode, 0)
        self.check('e.exr', 'e.exr', 'render', 'plain.json', '--env', 'e.exr', '-o', 'e.exr', *self.LONG)
        self.check('e.exr', 'e.exr', 'render', 'plain.json', '--reference', 'e.exr', '-o', 'e.exr',
                   '--size', '8x8', '--spp', '1G')
        self.write('e.json', {'lampyris': 1, 'shapes': [QUAD], 'materials': {'m': {}},
                              'environment': {'file': 'e.exr'}})
        self.check('e.exr', None, 'render', 'e.json', '-o', 'e.exr', *self.LONG)

    def test_scenes(self):
        self.check('plain.json', 'plain.json', 'render', 'plain.json', '--trace', 'plain.json', '-o', 'a.exr',
                   *self.LONG)
        self.write('edited.json', {'lampyris': 1, 'base': {'file': 'plain.json'}})
        self.check('plain.json', None, 'render', 'edited.json', '--trace', 'plain.json', '-o',
                   'a.exr', *self.LONG)

    def test_what_scenes_name(self):
        """The scene's files are replaced by a checkpoint, whose name may have any extension."""
        shutil.copy(os.path.join(SOURCE, 'scenes/profiles/downlight.ies'), self.path('lamp.ies'))
        self.write('mesh.obj', 'mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n')
        self.write('mesh.mtl', 'newmtl a\nKd 0.5 0.5 0.5\n')
        self.write('all.json', {'lampyris': 1, 'materials': {'m': {}},
                                'lights': [{'type': 'point', 'position': [0, 1, 0], 'profile': 'lamp.ies'}],
                                'shapes': [{'type': 'mesh', 'file': 'mesh.obj'}]})
        for name in ('lamp.ies', 'mesh.obj', 'mesh.mtl'):
            self.check(name, None, 'render', 'all.json', '--checkpoint', name, '--resume', '-o',
                       'a.exr', *self.LONG)

    def test_gltf(self):
        png(self.path('t.png'))
        with open(self.path('b.bin'), 'wb') as file:
            file.write(struct.pack('<15f', 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1))
        self.write('m.gltf', {
            'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}],
            'buffers': [{'uri': 'b.bin', 'byteLength': 60}],
            'bufferViews': [{'buffer': 0, 'byteLength': 36},
                            {'buffer': 0, 'byteOffset': 36, 'byteLength': 24}],
            'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3',
                           'min': [0, 0, 0], 'max': [1, 1, 0]},
                          {'bufferView': 1, 'componentType': 5126, 'count': 3, 'type': 'VEC2'}],
            'images': [{'uri': 't.png'}], 'textures': [{'source': 0}],
            'materials': [{'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}}}],
            'meshes': [{'primitives': [{'attributes': {'POSITION': 0, 'TEXCOORD_0': 1}, 'material': 0}]}]})
        for name, option in (('t.png', ('-o', 't.png')),
                             ('b.bin', ('--checkpoint', 'b.bin', '--resume', '-o', 'a.exr'))):
            self.check(name, None, 'render', 'm.gltf', *option, *self.LONG)

    def test_numbered_pictures(self):
        self.assertEqual(self.render('plain.json', '-o', 'a.0004.exr').returncode, 0)
        self.check('a.0004.exr', 'a.0004.exr', 'render', 'plain.json', '--reference', 'a.0004.exr', '-o',
                   'a.exr', '--size', '8x8', '--frames', '1000', '--every', '2')

    def test_compare(self):
        for name in ('a.exr', 'b.exr', 'r.exr'):
            result = self.render('plain.json', '-o', name, '--seed', str(ord(name[0])))
            self.assertEqual(result.returncode, 0, result.stderr)
        for name in ('a.exr', 'b.exr'):
            self.check(name, name, 'compare', 'a.exr', 'b.exr', '--difference', name)
        self.check('b.exr', 'b.exr', 'compare', 'a.exr', 'r.exr', '--difference', 'b.exr',
                   '--reference-variance', 'b.exr')
        # The first difference image is written before the second picture is read.
        shutil.copy(self.path('b.exr'), self.path('d.0001.exr'))
        self.check('d.0001.exr', 'd.0001.exr', 'compare', 'a.exr', 'd.0001.exr', 'r.exr', '--difference',
                   'd.exr')
        result = self.run_here('compare', 'a.exr', 'b.exr', '--difference', 'd.exr')
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_reports(self):
        os.mkdir(self.path('d'))
        bench = ('bench', 'plain.json', '--size', '8x8', '--repeats', '2', '--report', 'd')
        result = self.run_here(*bench, '--spp', '1')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.check('d/results.json', 'd/results.json', *bench, '--spp', '1', '--baseline', 'd/results.json')
        self.assertEqual(self.render('plain.json', '-o', 'd/reference-0.exr').returncode, 0)
        self.check('d/reference-0.exr', 'd/reference-0.exr', 'converge', 'plain.json', '--reference', 'd/reference-0.exr',
                   '--report', 'd', '--images', '--size', '8x8', '--spp', '16M')
        shutil.copy(self.path('plain.json'), self.path('d/results.json'))
        self.check('d/results.json', 'd/results.json', 'converge', 'd/results.json', '--reference', 'none', '--report',
                   'd', '--size', '8x8', '--spp', '16M')


class Outputs(Folder):
    def test_a_texture_of_the_scenes_name(self):
        """On a terminal, a PNG is written beside the EXR, unless the scene reads a file with that name."""
        png(self.path('w.png'))
        self.write('w.json', {'lampyris': 1, 'shapes': [QUAD], 'environment': {'radiance': [1, 1, 1]}, 'materials': {
            'm': {'textures': [{'file': 'w.png', 'parameters': {'base_color': 'rgb'}}]}}})
        before = self.contents()
        for scene, outputs in (('w.json', ['w.exr']), ('plain.json', ['plain.exr', 'plain.png'])):
            master, slave = os.openpty()
            result = subprocess.run([LAMPYRIS, 'render', scene, '--size', '8x8', '--spp', '1'], stdout=slave,
                                    cwd=self.folder.name, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True)
            os.close(slave)
            os.close(master)
            self.assertEqual(result.returncode, 0, result.stderr)
            after = self.contents()
            self.assertEqual(sorted(os.path.basename(name) for name in set(after) - set(before)), outputs)
            self.assertEqual({name: after[name] for name in before}, before)
            before = after

    def test_one_file_twice(self):
        os.symlink('a.exr', self.path('link.exr'))
        for other in ('./a.exr', 'link.exr', self.path('a.exr')):
            result = self.render('plain.json', '-o', 'a.exr', '-o', other)
            self.assertEqual((result.returncode, result.stdout), (2, ''), result.stderr)
            self.assertIn(f'a.exr and {other} are the same file', result.stderr)
        result = self.render('plain.json', '-o', 'a.exr', '--checkpoint', 'link.exr')
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder.name)), ['link.exr', 'plain.json'])

    def test_numbered_pictures_and_other_outputs(self):
        """Files are compared by name and by the files to which links lead."""
        frames = ('render', 'plain.json', '--size', '8x8', '--frames', '1000000000', '--every', '2',
                  '-o', 'q.exr')
        os.symlink('elsewhere', self.path('q.0004.exr'))
        os.symlink('q.0100.exr', self.path('q.0008.exr'))
        before = sorted(os.listdir(self.folder.name))
        for others in (('--checkpoint', 'q.0002.exr'), ('--checkpoint', './q.100000.exr', '--resume'),
                       ('--checkpoint', 'elsewhere'), ('-o', self.path('q.0002.exr')), ()):
            result = self.run_here(*frames, *others)
            self.assertEqual((result.returncode, result.stdout), (2, ''), result.stderr)
            self.assertIn('for each output', result.stderr)
            self.assertEqual(sorted(os.listdir(self.folder.name)), before)

    def test_names_that_no_picture_will_have(self):
        frames = ('render', 'plain.json', '--size', '8x8', '--frames', '2', '--every', '2', '-o', 'q.exr')
        for number, name in enumerate(('q.0001.exr', 'q.0004.exr', 'q.00002.exr', 'q.2.exr', 'r.0002.exr')):
            result = self.run_here(*frames, '-o', name, '--checkpoint', f'{number}.ck')
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_checkpoint_that_is_read(self):
        """A checkpoint that is read must not be an output of any other kind."""
        frames = ('render', 'plain.json', '--size', '8x8', '--frames', '5', '-o', 'q.exr')
        self.assertEqual(self.run_here(*frames, '--checkpoint', 'q.0005.exr').returncode, 0)
        before = self.contents()
        result = self.run_here(*frames, '--every', '5', '--checkpoint', 'q.0005.exr', '--resume')
        self.assertEqual((result.returncode, result.stdout), (2, ''), result.stderr)
        self.assertEqual(self.contents(), before)
        self.assertEqual(self.run_here(*frames, '--checkpoint', 'q.0005.exr', '--resume').returncode, 0)

    def test_links_that_lead_nowhere(self):
        os.mkdir(self.path('there'))
        os.symlink('there/new.exr', self.path('link.exr'))
        result = self.render('plain.json', '-o', 'link.exr')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(os.path.islink(self.path('link.exr')))
        self.assertEqual(os.listdir(self.path('there')), ['new.exr'])

    def test_what_was_written_before_is_replaced(self):
        """Traces and checkpoints are read by the runs that continue them, and then replaced."""
        files = ('-o', 'a.exr', '--checkpoint', 'a.ck', '--trace', 'a.csv')
        self.assertEqual(self.render('plain.json', *files).returncode, 0)
        result = self.run_here('render', 'plain.json', '--size', '8x8', '--spp', '4', '--resume', *files)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_results_are_masked(self):
        name = 'a\u202egpj.json'
        shutil.copy(self.path('plain.json'), self.path(name))
        result = self.render(name, '-o', 'b\u202egpj.exr', '--checkpoint', 'c\u2066', '--trace', 'd\u200b.csv')
        self.assertEqual(result.returncode, 0, result.stderr)
        for masked in ('a?gpj.json', 'b?gpj.exr', 'c?,', 'd?.csv'):
            self.assertIn(masked, result.stdout)
        self.assertNotRegex(result.stdout, '[\u202e\u2066\u200b]')
        self.assertIn('a?gpj.json', self.run_here('info', name).stdout)

    def test_names_are_masked(self):
        """U+202E reverses the text after it, so that "gpj.exe" looks like "exe.jpg"."""
        for name in ('a\u202egpj.exr', 'a\u2066b.exr', 'a\u200bb.exr', 'a\u009b2Jb.exr'):
            result = self.run_here('render', name)
            self.assertEqual(result.returncode, 2)
            self.assertNotIn(name[1], result.stderr)
            self.assertIn(name.replace(name[1], '?'), result.stderr)


unittest.main()
