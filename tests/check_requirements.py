#!/usr/bin/env python3
"""Checks that docs/portability.md lists the version, limits and extensions that the code requires of a
device, and that tests/README.md lists the words of LAMPYRIS_LIMITS that the code accepts.

Usage: check_requirements.py SOURCE_ROOT [unittest arguments]
"""
import glob
import os
import re
import sys
import unittest

ROOT = os.path.abspath(sys.argv.pop(1))


def read(path):
    with open(os.path.join(ROOT, path), encoding='utf-8') as file:
        return file.read()


def sources():
    return '\n'.join(read(path) for folder in ('src/gpu', 'src/viewer/window')
                     for path in sorted(glob.glob(os.path.join(ROOT, folder, '*.c'))))


def constants():
    """Returns the constants GPU_* of gpu.h as numbers."""
    found = {}
    for name, value in re.findall(r'^#define (GPU_\w+) (\(?[\w+ ]+\)?)', read('src/gpu/gpu.h'), re.M):
        for other in sorted(found, key=len, reverse=True):
            value = value.replace(other, str(found[other]))
        found[name] = sum(int(term) for term in value.strip('() ').split('+'))
    return found


def needed_limits():
    """Returns the name and the least value of each limit that device_find_lacks() checks."""
    body = read('src/gpu/select.c').split('void device_find_lacks', 1)[1].split('\n}', 1)[0]
    numbers = constants()
    return {name: sum(numbers.get(term.strip()) or int(term) for term in need.split('+'))
            for name, need in re.findall(r'\{"([\w\[\]]+)",\s*l->[\w\[\]]+,\s*([\w +]+)\}', body)}


def section(name):
    return read('docs/portability.md').split('\n## ' + name + '\n', 1)[1].split('\n## ', 1)[0]


class Requirements(unittest.TestCase):
    def test_limits_that_a_device_must_have(self):
        needed = needed_limits()
        self.assertGreater(len(needed), 3)
        told = {name: int(number) for name, number in
                re.findall(r'^\| `([\w\[\]]+)` \| (\d+) \|', section('What a device must have'), re.M)}
        self.assertEqual(told, needed)

    def test_limits_that_are_looked_at(self):
        page = read('docs/portability.md')
        for name in set(re.findall(r'\b(?:limits(?:\.|->)|l->)((?:max|min)[A-Z]\w+)', sources())):
            self.assertIn('`' + name, page)

    def test_extensions(self):
        code = sources()
        names = {'VK_%s_%s' % (vendor, name.lower())
                 for vendor, name in re.findall(r'\bVK_([A-Z]+)_(\w+)_EXTENSION_NAME\b', code)}
        names |= set(re.findall(r'"(VK_(?:KHR|EXT)_\w+)"', code))
        told = set(re.findall(r'\bVK_(?:KHR|EXT)_[a-z0-9_]+', read('docs/portability.md')))
        self.assertEqual(told, names)

    def test_version(self):
        major, minor = re.search(r'\.apiVersion = VK_API_VERSION_(\d)_(\d)',
                                 read('src/gpu/instance.c')).groups()
        self.assertIn('| Vulkan | %s.%s' % (major, minor), section('What a device must have'))

    def test_words_of_the_environment(self):
        words = set(re.findall(r'\{"([\w.-]+)=?", &limits->', read('src/gpu/limits.c')))
        row = next(line for line in read('tests/README.md').splitlines()
                   if line.startswith('| `LAMPYRIS_LIMITS`'))
        self.assertEqual(set(re.findall(r'`([a-z][\w.-]+)(?:=\w+)?`', row)), words)


if __name__ == '__main__':
    unittest.main()
