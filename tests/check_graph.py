#!/usr/bin/python3
"""Checks the graphs of src/: the includes, from the text, and the calls, from the symbols of the object files
(a function whose address is taken counts as called).

check_graph.py SOURCE_ROOT BUILD_ROOT [unittest's arguments]. With LAMPYRIS_GRAPH=1 in the
environment it also prints all circles of calls, the small ones that are allowed first.
"""
import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

# Each module with the modules directly below it. A module may include files of, and call functions of, itself
# and all modules below it.
ROOMS = {
    'shared': [],  # contains only shaders/shared, which C and GLSL include
    'base': [],
    'json': ['base'],
    'image': ['base'],
    'metrics': ['base'],
    'bvh': ['base'],
    'gpu': ['base'],
    'scene/core': ['image', 'shared'],
    'scene/sky': ['scene/core'],
    'scene/generate': ['scene/core'],
    'scene/sdf': ['scene/core', 'json'],
    'scene/mesh': ['scene/core'],
    'scene/gltf': ['scene/mesh', 'json'],
    'scene/json': ['scene/sky', 'scene/generate', 'scene/sdf', 'scene/mesh', 'scene/gltf'],
    'scene': ['scene/json'],
    'flatten': ['scene', 'bvh'],
    'render/tables': ['flatten', 'gpu'],
    'render': ['render/tables'],
    'render/show': ['render'],
    'render/probe': ['render', 'metrics'],
    'report': ['image', 'metrics', 'gpu', 'json'],
    'job': ['render/probe'],
    'check': ['job'],
    'check/scene': ['check'],
    'output': ['job'],
    'library': ['output'],
    'cli': ['output', 'report'],
    'cli/render': ['cli'],
    'cli/merge': ['cli/render'],
    'cli/mpi': ['cli/render'],
    'cli/submit': ['cli/render'],
    'cli/info': ['cli'],
    'cli/bench': ['cli'],
    'cli/converge': ['cli'],
    'cli/compare': ['cli'],
    'cli/check': ['cli', 'check/scene'],
    'cli/view': ['cli'],
    'program': ['cli/render', 'cli/merge', 'cli/mpi', 'cli/submit', 'cli/info', 'cli/bench', 'cli/converge', 'cli/compare',
                'cli/check', 'cli/view'],
    'viewer/window': ['gpu'],
    'viewer/gui': ['viewer/window', 'image'],
    'viewer/core': ['viewer/gui', 'render/show', 'cli'],
    'viewer/panel': ['viewer/core'],
    'viewer/script': ['viewer/core'],
    'viewer': ['viewer/panel', 'viewer/script', 'program'],
}
# Files above the module of their folder: those that contain main(), and those that know all commands.
ABOVE = {'cli/main.c': 'program', 'cli/main_mpi.c': 'program', 'cli/program.c': 'program', 'cli/program.h': 'program'}
GENERATED = r'\w+\.spv\.h|albedo_data\.h|kernel_source\.h|embedded_scenes\.h|embedded_page\.h'
CIRCLE_MAX = 3  # greatest number of files that may call each other in a circle
CIRCLES_OF = 'viewer/core'  # the only module that may have larger circles


def room_of(path):
    room = re.sub(r'^base/(posix|windows)$', 'base', os.path.dirname(path))
    return ABOVE.get(path, room)


def rooms_below(room, known={}):
    """Returns the module and all modules below it."""
    if room not in known:
        known[room] = {room}.union(*(rooms_below(name) for name in ROOMS[room]))
    return known[room]


def upward(graph):
    """Returns the edges to modules that are not below the file's own module."""
    return [f'{a} -> {b}' for a in graph for b in graph[a]
            if room_of(b) not in rooms_below(room_of(a))]


def circles(graph):
    """Returns the strongly connected components of more than one file (Tarjan 1972, without recursion)."""
    number, low, stack, on_stack, found = {}, {}, [], set(), []
    for root in graph:
        work = [] if root in number else [(root, iter(sorted(graph[root])))]
        if work:
            number[root] = low[root] = len(number)
            stack.append(root)
            on_stack.add(root)
        while work:
            file, edges = work[-1]
            for other in edges:
                if other not in number:
                    number[other] = low[other] = len(number)
                    stack.append(other)
                    on_stack.add(other)
                    work.append((other, iter(sorted(graph.get(other, ())))))
                    break
                if other in on_stack:
                    low[file] = min(low[file], number[other])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[file])
                if low[file] == number[file]:
                    part = stack[stack.index(file):]
                    del stack[-len(part):]
                    on_stack.difference_update(part)
                    if len(part) > 1:
                        found.append(sorted(part))
    return found


def large_circles(calls):
    return [circle for circle in circles(calls) if len(circle) > CIRCLE_MAX and
            any(room_of(file) != CIRCLES_OF for file in circle)]


def read_includes(source_root):
    """Returns the graph of includes, and a list of includes that name no folder or have angle brackets."""
    graph, bare = {}, []
    for top, prefix in (('src', ''), ('shaders/shared', 'shared')):
        top = os.path.join(source_root, top)
        for folder, _, names in os.walk(top):
            for name in (name for name in names if re.search(r'\.(c|h|cpp)$', name)):
                path = os.path.normpath(os.path.join(prefix, os.path.relpath(folder, top), name))
                with open(os.path.join(folder, name), encoding='utf-8') as file:
                    includes = re.findall(r'^\s*#\s*include\s*(["<])([^">]+)', file.read(),
                                          re.MULTILINE)
                quoted = [name for mark, name in includes if mark == '"']
                angled = [name for mark, name in includes if mark == '<' and
                          os.path.exists(os.path.join(source_root, 'src', name))]
                graph[path] = {name for name in quoted if '/' in name} | set(angled)
                if not prefix:
                    bare += [f'{path}: {name}' for name in quoted
                             if '/' not in name and not re.fullmatch(GENERATED, name)]
                    bare += [f'{path}: <{name}>' for name in angled]
    return graph, bare


def read_symbols(paths):
    """Returns {path: (defined symbols, used symbols)} of object files."""
    listed = subprocess.run(['nm', '-A', '-P', *paths], stdout=subprocess.PIPE, check=True,
                            text=True).stdout
    symbols = {path: (set(), set()) for path in paths}
    for path, name, kind in re.findall(r'^(.*): (\S+) (\w)', listed, re.MULTILINE):
        defined, used = symbols[path]
        if kind == 'U':
            used.add(name)
        elif kind.isupper() or kind == 'u':
            defined.add(name)
    return symbols


def call_graph(objects):
    """Returns the graph of calls. `objects` maps the path of a source to that of its object."""
    symbols = read_symbols(objects.values())
    where = {name: source for source, path in objects.items() for name in symbols[path][0]}
    return {source: {where[name] for name in symbols[path][1] if name in where} - {source}
            for source, path in objects.items()}


def read_objects(source_root, build_root):
    with open(os.path.join(build_root, 'compile_commands.json'), encoding='utf-8') as database:
        entries = json.load(database)
    source_root = os.path.realpath(os.path.join(source_root, 'src'))
    objects = {}
    for entry in entries:
        source = os.path.realpath(os.path.join(entry['directory'], entry['file']))
        source = os.path.relpath(source, source_root)
        if entry['output'].startswith('src/') and not source.startswith('..'):
            objects[source] = os.path.join(build_root, entry['output'])
    return objects


# Functions that change a renderer: only jobs may call them.
CHANGING = {'renderer_render', 'renderer_restart', 'renderer_plan_samples', 'renderer_set_plan',
            'renderer_create', 'renderer_set_camera', 'renderer_resize', 'renderer_clear',
            'renderer_read', 'renderer_replay', 'wave_count_steps', 'kernel_recording_create'}


def may_change_renderers(path):
    """Returns whether the file may change renderers: checks of a device do, because they test renderers
    without a job."""
    return path.startswith(('job/', 'render/', 'check/'))


def users_of(names, objects):
    return [path for path, (_, used) in read_symbols(objects.values()).items() if used & names]


def read_commands(build_root):
    """Returns {object: its entry} from compile_commands.json."""
    with open(os.path.join(build_root, 'compile_commands.json'), encoding='utf-8') as database:
        return {os.path.join(build_root, entry['output']): entry for entry in json.load(database)}


def make_constant_jobs(source_root, folder):
    """Writes a header job/job.h, which compilers find first, in which all members of struct job are const."""
    with open(os.path.join(source_root, 'src', 'job', 'job.h'), encoding='utf-8') as file:
        text, count = re.subn(r'^struct job \{\n(.*?)^\};', r'struct job {\nconst struct {\n\1};\n};',
                              file.read(), flags=re.MULTILINE | re.DOTALL)
    os.makedirs(os.path.join(folder, 'job'))
    with open(os.path.join(folder, 'job', 'job.h'), 'w', encoding='utf-8') as file:
        file.write(text)
    return count


def writes_to_jobs(entry, folder, source=None):
    """Returns the compiler's messages about a source that changes members of struct job, which are const
    here."""
    words = shlex.split(entry['command'])[:-1]
    words = [word for i, word in enumerate(words)
             if not re.match(r'-(o|M.*|c|O.|W.*|fdiag.*|fcolor.*)$', word) and
             words[i - 1] not in ('-o', '-MF', '-MQ') and not word.endswith('ccache')]
    words[:1] = ['gcc', '-I' + folder]  # always gcc, whatever compiler builds the program, because its
                                        # messages are evaluated
    words += ['-Werror=discarded-qualifiers', '-Werror=cast-qual', '-fsyntax-only']
    result = subprocess.run([*words, source or entry['file']], cwd=entry['directory'],
                            stderr=subprocess.PIPE, text=True, check=False)
    return [line for line in result.stderr.splitlines() if 'error:' in line]


class Graph(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.includes, cls.bare = read_includes(SOURCE_ROOT)
        cls.objects = read_objects(SOURCE_ROOT, BUILD_ROOT)
        cls.calls = call_graph(cls.objects)

    def knows_jobs(self, source):
        """Returns whether the source includes the definition of struct job and uses a member."""
        seen, left = set(), [source]
        while left:
            file = left.pop()
            left += self.includes[file] - seen
            seen.add(file)
        with open(os.path.join(SOURCE_ROOT, 'src', source), encoding='utf-8') as file:
            return 'job/job.h' in seen and 'job' in file.read().replace('"job/', '"')

    def with_edge(self, graph, file, other):
        self.assertIn(file, graph)
        self.assertIn(other, graph)
        return {**graph, file: graph[file] | {other}}

    def test_the_graphs_are_whole(self):
        self.assertGreater(len(self.includes), 500)
        self.assertGreater(len(self.calls), 250)
        self.assertIn('render/wave.c', self.calls['render/render.c'])
        rooms = {room_of(path) for path in self.includes}
        self.assertEqual(rooms, set(ROOMS))
        for file, names in self.includes.items():
            for name in names:
                self.assertIn(name, self.includes, f'{file}: there is no {name}')

    def test_the_drawing_says_the_same(self):
        """The drawing of layers in docs/design.md agrees with ROOMS: each layer uses only those to its
        right."""
        with open(os.path.join(SOURCE_ROOT, 'docs', 'design.md'), encoding='utf-8') as file:
            drawn = next(line for line in file if line.startswith('    viewer -> '))
        level = {name: i for i, layer in enumerate(drawn.split('->'))
                 for name in re.findall(r'\w+', layer)}
        self.assertEqual(set(level), {room.split('/')[0] for room in ROOMS} - {'shared', 'program'})
        for room, below in ROOMS.items():
            for name in below:
                upper, lower = room.split('/')[0], name.split('/')[0]
                if upper != lower and {'shared', 'program'}.isdisjoint((upper, lower)):
                    self.assertLess(level[upper], level[lower], f'{room} stands on {name}')

    def test_includes_carry_the_folder(self):
        self.assertEqual(self.bare, [])

    def test_no_include_goes_upwards(self):
        self.assertEqual(upward(self.includes), [])
        planted = self.with_edge(self.includes, 'scene/core/material.c', 'render/render.h')
        self.assertEqual(upward(planted), ['scene/core/material.c -> render/render.h'])
        planted = self.with_edge(self.includes, 'scene/gltf/load_gltf.c', 'scene/json/load_json.h')
        self.assertEqual(len(upward(planted)), 1)
        planted = self.with_edge(self.includes, 'render/wave.c', 'metrics/metrics.h')
        self.assertEqual(len(upward(planted)), 1)

    def test_no_include_leads_back(self):
        self.assertEqual(circles(self.includes), [])
        planted = self.with_edge(self.includes, 'base/err.h', 'base/file.h')
        self.assertEqual(circles(planted), [['base/err.h', 'base/file.h']])

    def test_no_call_goes_upwards(self):
        self.assertEqual(upward(self.calls), [])
        planted = self.with_edge(self.calls, 'gpu/buffer.c', 'render/film.c')
        self.assertEqual(upward(planted), ['gpu/buffer.c -> render/film.c'])

    def test_circles_of_calls_are_small(self):
        if os.environ.get('LAMPYRIS_GRAPH'):
            for circle in sorted(circles(self.calls), key=len):
                print(len(circle), *circle)
        self.assertEqual(large_circles(self.calls), [])
        planted = self.with_edge(self.calls, 'render/wave.c', 'render/render.c')
        planted = self.with_edge(planted, 'render/kernels.c', 'render/render.c')
        planted = self.with_edge(planted, 'gpu/kernel.c', 'render/render.c')
        self.assertEqual(len(large_circles(planted)), 1)

    def test_jobs_alone_change_renderers(self):
        sources = {path: source for source, path in self.objects.items()}
        users = {sources[path] for path in users_of(CHANGING, self.objects)}
        self.assertLess({'job/job.c', 'job/control.c', 'job/pilot.c'}, users)
        self.assertEqual([path for path in users if not may_change_renderers(path)], [])

    def test_jobs_alone_change_jobs(self):
        commands = read_commands(BUILD_ROOT)
        with tempfile.TemporaryDirectory() as folder, \
                concurrent.futures.ThreadPoolExecutor() as pool:
            self.assertEqual(make_constant_jobs(SOURCE_ROOT, folder), 1)
            entries = [commands[self.objects[source]] for source in self.objects
                       if not may_change_renderers(source) and self.knows_jobs(source)]
            self.assertGreater(len(entries), 20)
            for errors in pool.map(lambda entry: writes_to_jobs(entry, folder), entries):
                self.assertEqual(errors, [])
            planted = os.path.join(folder, 'planted.c')
            entry = commands[self.objects['cli/render/cmd_render.c']]
            for line, writes in (('job->seconds.total = 1.0;', 1),
                                 ('job->renderer.frame.samples++;', 1),
                                 ('job->renderer.stats.paths += 2;', 1),
                                 ('struct render_stats *s = &job->renderer.stats; s->paths = 0;', 1),
                                 ('((struct film_image *)&job->film)->width = 1;', 1),
                                 ('const struct job *same = job; (void)same->film.width;', 0)):
                with open(planted, 'w', encoding='utf-8') as file:
                    file.write('#include "job/job.h"\nvoid f(struct job *job);\n'
                               f'void f(struct job *job)\n{{\n{line}\n}}\n')
                self.assertEqual(len(writes_to_jobs(entry, folder, planted)), writes, line)

    def test_calls_are_read_from_objects(self):
        code = {'a.c': 'int b(void); int a(void); int a(void) { return b(); }',
                'b.c': 'int c(void); int b(void); int b(void) { return c(); }',
                'c.c': 'int a(void); int c(void); int (*table[])(void) = {a}; int c(void) { return 0; }'}
        with tempfile.TemporaryDirectory() as folder:
            for name, text in code.items():
                path = os.path.join(folder, name)
                with open(path, 'w', encoding='utf-8') as file:
                    file.write(text)
                subprocess.run(['cc', '-c', path, '-o', path + '.o'], check=True)
            calls = call_graph({name: os.path.join(folder, name + '.o') for name in code})
        self.assertEqual(calls, {'a.c': {'b.c'}, 'b.c': {'c.c'}, 'c.c': {'a.c'}})
        self.assertEqual(circles(calls), [['a.c', 'b.c', 'c.c']])


if __name__ == '__main__':
    SOURCE_ROOT, BUILD_ROOT = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], failfast=False)
