#!/usr/bin/env python3
"""docs/viewer.md contains every key and every control of the panel, in the words of the program.

    test_manual.py LAMPYRIS VIEWER SOURCE_ROOT [--write]

--write brings the page up to date.
"""
import os
import re
import sys

import viewer_run
from test_controls import Tour, any_row
from viewer_run import ROOT

PAGE = os.path.join(ROOT, 'docs', 'viewer.md')
WRITES = '--write' in sys.argv
MODELS = ['conductor', 'microfacet', 'blinn_phong', 'dielectric', 'principled']


class Manual(Tour):
    def controls(self):
        """Returns the controls in the panel's order. Controls of some materials only are listed where these
        have them."""
        scene = self.set_up_files()
        script = 'wait 1 samples\nset scene.path other.json\nwait 3 frames\n'
        script += 'set scene.path tour.json\nwait 3 frames\n'
        for model in MODELS:
            script += f'set material.model {model}\nwait 2 frames\nstate {model}.json\n'
        # SwiftShader takes minutes to compile the kernels of all these materials.
        result = self.view(script, '--spp', '1', scene=scene, validation=False, timeout=1500)
        rows = {}
        for model in reversed(MODELS):
            for item in result.state(model + '.json')['items']:
                rows.setdefault(any_row(item['id']), item)
        groups = {}
        for name, item in rows.items():
            groups.setdefault(name.split('.')[0], []).append((name, item))
        return groups

    def table(self):
        lines = []
        for group, items in self.controls().items():
            heads = [item for name, item in items if name == group and item['kind'] == 'group']
            title = heads[0]['label'] if heads else group.capitalize()
            lines += [f'### {title}', '']
            lines += [heads[0]['help'], ''] if heads else []
            rows = [(name, item) for name, item in items if name != group]
            lines += ['| id | label | meaning |', '|---|---|---|'] if rows else []
            for name, item in rows:
                label = '' if '#' in name else item['label'].strip()
                text = item['help'].replace('|', '\\|')
                lines.append(f'| `{name.replace("#", "N")}` | {label} | {text} |')
            lines += [''] if rows else []
        return '\n'.join(lines)

    def keys(self):
        with open(os.path.join(ROOT, 'src', 'viewer', 'core', 'keys.c'), encoding='utf-8') as file:
            source = file.read()
        block = source[source.index('viewer_keys[] = {'):]
        rows = re.findall(r'\{"([^"]*)",\s*"([^"]*)"\}', block[:block.index('{NULL')])
        return '\n'.join(['| key or mouse | function |', '|---|---|'] + [f'| {keys} | {text} |' for keys, text in rows]
                         + [''])

    def test_page_is_up_to_date(self):
        with open(PAGE, encoding='utf-8') as file:
            page = file.read()
        wanted = page
        for name, text in (('keys', self.keys()), ('controls', self.table())):
            begin, end = f'<!-- {name}: -->\n', f'<!-- :{name} -->'
            self.assertIn(begin, page)
            head, rest = wanted.split(begin)
            wanted = head + begin + '\n' + text + '\n' + end + rest.split(end)[1]
        if WRITES:
            with open(PAGE, 'w', encoding='utf-8') as file:
                file.write(wanted)
        else:
            self.assertEqual(page, wanted, 'tests/viewer/test_manual.py --write brings it up to '
                             'date')


if __name__ == '__main__':
    sys.argv = [argument for argument in sys.argv if argument != '--write']
    viewer_run.need_device(viewer_run.LAMPYRIS)
    viewer_run.unittest.main(defaultTest='Manual.test_page_is_up_to_date')
