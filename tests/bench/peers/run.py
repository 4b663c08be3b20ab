#!/usr/bin/env python3
"""Compares Lampyris with Cycles on five scenes, in alternation, each renderer against its own reference. See
docs/peers.md.

    tests/bench/peers/run.py --lampyris build/src/cli/lampyris [--quick] [-o FOLDER]

The folder keeps the scenes' files, the references and a row for each render: a run that was interrupted goes on, and one
of more turns adds to those that are there. results.md has the tables, results.json all figures, rows.csv each render.
"""
import argparse
import csv
import json
import os
import shlex
import shutil
import statistics
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import estimate  # noqa: E402
import exr  # noqa: E402
import renderers  # noqa: E402
import report  # noqa: E402
import scenes  # noqa: E402

REFERENCE_SEEDS = {'a': 1000003, 'b': 1000033}
COLUMNS = ['scene', 'identity', 'size', 'spp', 'renderer', 'version', 'turn', 'seconds', 'processor_seconds',
           'seconds_1', 'processor_seconds_1', 'relmse', 'relmse_99', 'rays', 'device', 'load']


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--lampyris', default='build/src/cli/lampyris', metavar='PROGRAM')
    parser.add_argument('--blender', default='blender', metavar='PROGRAM')
    parser.add_argument('--without-cycles', action='store_true', help='compare only Lampyris with those of --also')
    parser.add_argument('--also', action='append', default=[], metavar='NAME="PROGRAM [--KEY VALUE ...]"',
                        help='another build of Lampyris, or the same one with options, that takes its turns')
    parser.add_argument('--options', default='', metavar='"--KEY VALUE ..."', help='of Lampyris, but not of --also')
    parser.add_argument('--scenes', default=','.join(scenes.SCENES), metavar='NAME,...')
    parser.add_argument('--size', type=int, default=256, metavar='N', help='pictures are N x N (256)')
    parser.add_argument('--spp', type=int, default=32, metavar='N', help='samples per pixel (32)')
    parser.add_argument('--reference-spp', type=int, default=512, metavar='N', help='of each of two references (512)')
    parser.add_argument('--turns', type=int, default=7, metavar='N', help='renders of each, all by other seeds (7)')
    parser.add_argument('--quick', action='store_true', help='48 x 48, 4 spp, 2 turns, references of 64: shows that it works')
    parser.add_argument('-o', '--output', default='peers', metavar='FOLDER')
    options = parser.parse_args()
    if options.quick:
        options.size, options.spp, options.reference_spp, options.turns = 48, 4, 64, 2
    unknown = set(options.scenes.split(',')) - set(scenes.SCENES)
    if unknown:
        parser.error('there is no scene "%s", but %s' % (', '.join(sorted(unknown)), ', '.join(scenes.SCENES)))
    if options.spp < 2 or options.turns < 1:
        parser.error('--spp is at least 2, and --turns at least 1')
    options.also = [(name, shlex.split(command)) for name, _, command in (also.partition('=') for also in options.also)]
    if not all(command for _, command in options.also):
        parser.error('--also is NAME=PROGRAM')
    programs = [options.lampyris, *([] if options.without_cycles else [options.blender])]
    for program in programs + [command[0] for _, command in options.also]:
        if not shutil.which(program):
            parser.error('the program "%s" is not there' % program)
    return options


def contestants(options):
    """Returns the renderers. Lampyris is the first one, with which all others are compared."""
    result = [renderers.Lampyris('Lampyris', shutil.which(options.lampyris), options.options.split())]
    if not options.without_cycles:
        result.append(renderers.Cycles(options.blender))
    for name, command in options.also:
        result.append(renderers.Lampyris(name, shutil.which(command[0]), command[1:]))
    return result


class Rows:
    """Results, one row for each timed render, stored in a file as soon as they are known."""

    def __init__(self, folder):
        self.path, self.rows = os.path.join(folder, 'rows.csv'), []
        if os.path.exists(self.path):
            with open(self.path, newline='') as file:
                reader = csv.DictReader(file)
                # Rows with other columns were written by another version of this program.
                self.rows = [self._typed(row) for row in reader] if reader.fieldnames == COLUMNS else []

    @staticmethod
    def _typed(row):
        for key in ('size', 'spp', 'turn'):
            row[key] = int(row[key])
        for key in ('seconds', 'processor_seconds', 'seconds_1', 'processor_seconds_1', 'relmse', 'relmse_99', 'rays',
                    'load'):
            row[key] = float(row[key])
        return row

    def add(self, **row):
        self.rows.append(row)
        with open(self.path + '.part', 'w', newline='') as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(self.rows)
        os.replace(self.path + '.part', self.path)

    def select(self, **wanted):
        return [row for row in self.rows if all(row[key] == value for key, value in wanted.items())]


class Comparison:
    """The comparison for one scene, with all renderers open."""

    def __init__(self, options, name, renderers_, rows):
        self.options, self.renderers, self.rows = options, renderers_, rows
        self.files = os.path.join(options.output, 'files')
        os.makedirs(self.files, exist_ok=True)
        self.description = scenes.describe(name)
        self.identity = scenes.write_files(self.description, self.files)
        self.key = {'scene': name, 'identity': self.identity, 'size': options.size, 'spp': options.spp}

    def reference(self, renderer):
        """Returns two pictures with independent seeds. Builds of Lampyris share theirs."""
        folder = os.path.join(self.options.output, 'references')
        os.makedirs(folder, exist_ok=True)
        pictures = []
        for letter, seed in REFERENCE_SEEDS.items():
            path = os.path.join(folder, '%s-%s-%d-%d-%s-%s.exr' % (
                self.key['scene'], self.identity, self.options.size, self.options.reference_spp, renderer.family, letter))
            if not os.path.exists(path):
                self.say('%s: reference %s' % (renderer.name, letter))
                renderer.render(self.options.reference_spp, seed, path + '.part.exr')
                os.replace(path + '.part.exr', path)
            pictures.append(exr.read(path))
        return pictures

    def say(self, text):
        print('%-8s %s' % (self.key['scene'], text), file=sys.stderr, flush=True)

    def turn(self, renderer, number):
        """Measures a render, and one with a single sample, whose cost is subtracted because it is not the
        samples'."""
        own = dict(self.key, renderer=renderer.name, version=renderer.version, turn=number)
        if self.rows.select(**own):
            return
        path = os.path.join(self.options.output, 'picture.exr')
        short = renderer.render(1, 2 * number + 1, path)
        whole = renderer.render(self.options.spp, 2 * number + 2, path)
        relmse, trimmed = estimate.errors(exr.read(path), self.references[renderer.family])
        self.rows.add(**own, seconds=whole['seconds'], processor_seconds=whole['processor_seconds'],
                      seconds_1=short['seconds'], processor_seconds_1=short['processor_seconds'], relmse=relmse,
                      relmse_99=trimmed, rays=float(whole.get('rays', 0)), device=whole.get('device', 'CPU'), load=os.getloadavg()[0])
        self.say('%s: turn %d, relMSE %.4g, %.2f s of processors' % (renderer.name, number, relmse,
                                                                    whole['processor_seconds']))

    def run(self):
        try:
            for renderer in self.renderers:
                renderer.open(self.description, self.files, self.options.size)
            self.references = {}
            for renderer in self.renderers:
                if renderer.family not in self.references:
                    self.references[renderer.family] = self.reference(renderer)
            for number in range(self.options.turns):
                for renderer in self.renderers[::-1 if number % 2 else 1]:
                    self.turn(renderer, number)
        finally:
            for renderer in self.renderers:
                renderer.close()

    def costs(self, renderer):
        """Returns, for each turn, relMSE and the wall and processor seconds of the samples alone. An earlier
        run may have had more turns."""
        rows = sorted((row for row in self.rows.select(**self.key, renderer=renderer.name, version=renderer.version)
                       if row['turn'] < self.options.turns), key=lambda row: row['turn'])
        part = self.options.spp / (self.options.spp - 1)
        result = {key: [row[key] for row in rows] for key in ('relmse', 'relmse_99', 'rays', 'load')}
        for kind in ('seconds', 'processor_seconds'):
            # The median is used, because a moment of load on the machine would be added to, or subtracted
            # from, one turn only.
            one = statistics.median(row[kind + '_1'] for row in rows)
            result[kind] = [(row[kind] - one) * part for row in rows]
            result[kind + '_1'] = one
        return result


def main():
    options = arguments()
    os.makedirs(options.output, exist_ok=True)
    rivals, rows, compared = contestants(options), Rows(options.output), []
    for name in options.scenes.split(','):
        comparison = Comparison(options, name, rivals, rows)
        comparison.run()
        compared.append(comparison)
    results = report.results(compared)
    with open(os.path.join(options.output, 'results.json'), 'w') as file:
        json.dump(results, file, indent=1)
    text = report.text(results)
    with open(os.path.join(options.output, 'results.md'), 'w') as file:
        file.write(text)
    print(text, end='')


if __name__ == '__main__':
    try:
        main()
    except renderers.Failure as failure:
        sys.exit(str(failure))
