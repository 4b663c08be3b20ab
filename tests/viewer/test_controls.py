#!/usr/bin/env python3
"""Uses every control of the panel, and checks that it has an effect.

    test_controls.py LAMPYRIS VIEWER SOURCE_ROOT [Tour[.TEST]|Long]

Tour tries one in four of the steps that are taken back, since each compiles kernels; Long tries all.
Both hold the table of steps against the controls that the running panel has.
"""
import base64
import json
import os
import re
import shutil
import struct
import subprocess
import zlib

import viewer_run
from controls_table import STEPS, UNDO
from viewer_run import ROOT, Case

HERE = os.path.dirname(os.path.abspath(__file__))
SIZE = '240x135'
# Steps that use another scene than tour.json, because its kernels compile faster.
FILES = {'panel': 'other.json', 'view': 'other.json', 'renderer': 'other.json', 'cameras': 'cameras.gltf'}
TOURS = {'picture': ['panel', 'view', 'renderer', 'camera', 'scene'], 'materials': ['materials'],
         'objects': ['lights', 'objects', 'files', 'cameras']}
assert sorted(sum(TOURS.values(), [])) == sorted(STEPS)


def bumps():
    """Makes a small normal map as PNG."""
    def chunk(kind, data):
        return (struct.pack('>I', len(data)) + kind + data
                + struct.pack('>I', zlib.crc32(kind + data)))
    rows = b''.join(b'\0' + bytes(c for x in range(8)
                                  for c in (188 if x % 4 < 2 else 68, 188 if y % 4 < 2 else 68, 230))
                    for y in range(8))
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 8, 8, 8, 2, 0, 0, 0))
            + chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))


def two_cameras():
    """Makes a glTF file with a moving triangle and two cameras."""
    data = struct.pack('<9f2f6f', -1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0)
    uri = 'data:application/octet-stream;base64,' + base64.b64encode(data).decode()
    lens = {'type': 'perspective', 'perspective': {'yfov': 0.8, 'znear': 0.01}}
    return {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1, 2]}],
            'nodes': [{'mesh': 0}, {'camera': 0, 'translation': [0, 0, 4]},
                      {'camera': 1, 'translation': [1, 0, 3]}],
            'cameras': [lens, lens],
            'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}],
            'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3',
                           'min': [-1, -1, 0], 'max': [1, 1, 0]},
                          {'bufferView': 1, 'componentType': 5126, 'count': 2, 'type': 'SCALAR',
                           'min': [0], 'max': [1]},
                          {'bufferView': 2, 'componentType': 5126, 'count': 2, 'type': 'VEC3'}],
            'animations': [{'channels': [{'sampler': 0, 'target': {'node': 0,
                                                                   'path': 'translation'}}],
                            'samplers': [{'input': 1, 'output': 2}]}],
            'bufferViews': [{'buffer': 0, 'byteLength': 36},
                            {'buffer': 0, 'byteOffset': 36, 'byteLength': 8},
                            {'buffer': 0, 'byteOffset': 44, 'byteLength': 24}],
            'buffers': [{'byteLength': 68, 'uri': uri}]}


def commands(step):
    """Returns the lines of a script for a step."""
    if isinstance(step, str):
        return [step]
    name, value, effect, back = step + ('result', UNDO)[len(step) - 2:]
    lines = [f'set {name} "{value}"' if effect == 'none' else f'check {name} "{value}" {effect}']
    if back == UNDO:
        lines.append('key Ctrl+z')
    elif back is not None:
        lines.append(f'set {name} "{back}"')
    return lines


def used(step):
    """Returns the ids of the controls that a step uses, with '#' for numbers."""
    words = step.split() if isinstance(step, str) else ('set', step[0])
    if words[0] not in ('set', 'press', 'click', 'drag', 'check'):
        return set()
    return {any_row(words[1])}


def any_row(name):
    return re.sub(r'\.\d+', '.#', name)


def one_in_four(steps):
    """Selects one in four steps. Steps with commands of their own, and those that are not taken back, are
    kept, because later steps need them."""
    kept, undone = [], 0
    for step in steps:
        stays = isinstance(step, str) or step[3:] == (None,)
        if stays or undone % 4 == 0:
            kept.append(step)
        undone += not stays
    return kept


class TourCase(Case):
    def set_up_files(self):
        shutil.copy(os.path.join(HERE, 'tour.json'), self.path('tour.json'))
        shutil.copy(os.path.join(HERE, 'tour.json'), self.path('tour-whole.json'))
        shutil.copy(os.path.join(ROOT, 'scenes', 'profiles', 'pendant.ies'), self.folder)
        shutil.copy(os.path.join(ROOT, 'scenes', 'cornell.json'), self.path('other.json'))
        with open(self.path('bumps.png'), 'wb') as file:
            file.write(bumps())
        self.write('cameras.gltf', json.dumps(two_cameras()))
        return self.path('tour.json')

    def run_steps(self, steps, scene, **options):
        """Runs the steps. Returns the failures and the ids of all controls. After a failure it continues
        after the failed step, restoring the state of the steps before it that are not taken back."""
        failures, begin = [], 0
        while True:
            lines = ['wait 2 samples', 'state first.json']
            lines += [f'set {step[0]} "{step[1]}"' for step in steps[:begin]
                      if not isinstance(step, str) and step[3:] == (None,)]
            owner = {}
            for index, step in enumerate(steps[begin:], begin):
                for line in commands(step):
                    lines.append(line)
                    owner[len(lines)] = index
            lines.append('state last.json')
            process = subprocess.run(self.command('\n'.join(lines), '--spp', '2', scene=scene,
                                                  size=SIZE, **options), cwd=self.folder, text=True,
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            if process.returncode == 0:
                break
            place = re.search(r'script\.txt:(\d+): (.*)', process.stderr)
            self.assertTrue(process.returncode == 1 and place and int(place[1]) in owner,
                            process.stderr[-2000:])
            failures.append(f'{lines[int(place[1]) - 1]}: {place[2]}')
            begin = owner[int(place[1])] + 1
        ids = {}
        for name in ('first.json', 'last.json'):
            with open(self.path(name), encoding='utf-8') as file:
                for item in json.load(file)['items']:
                    ids[any_row(item['id'])] = item['kind']
        return failures, ids

    def check(self, choose, groups):
        self.set_up_files()
        failures, ids = [], {}
        for name in groups:
            own_failures, own_ids = self.run_steps(choose(STEPS[name]),
                                                   self.path(FILES.get(name, 'tour.json')))
            failures += own_failures
            ids.update(own_ids)
        touched = {'view.vsync'}.union(*(used(step) for steps in STEPS.values() for step in steps))
        # Vsync exists only with a window, and groups are opened by hand: see test_mouse_and_keys.py.
        untouched = sorted(name for name, kind in ids.items()
                           if kind != 'group' and name not in touched)
        self.assertEqual((failures, untouched), ([], []))


class Tour(TourCase):
    def test_picture(self):
        self.check(one_in_four, TOURS['picture'])

    def test_materials(self):
        self.check(one_in_four, TOURS['materials'])

    def test_objects(self):
        self.check(one_in_four, TOURS['objects'])


class Long(TourCase):
    def test_every_control_does_something(self):
        self.check(list, STEPS)


if __name__ == '__main__':
    viewer_run.main()
