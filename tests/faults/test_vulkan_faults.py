#!/usr/bin/env python3
"""Makes every Vulkan function that can fail do so, at every call, and checks how commands end.

Usage: test_vulkan_faults.py LAMPYRIS VIEWER FAILING_LOADER SCENE [--sample SECONDS] [--seed N]

VIEWER may be "none". With --sample, random faults are tried until the commands have taken so many
seconds of processor time (at least one of each function and command); else all are.
"""
import argparse
import ctypes
import json
import os
import random
import re
import resource
import subprocess
import sys
import tempfile

OUT_OF_HOST_MEMORY, OUT_OF_DEVICE_MEMORY, DEVICE_LOST = -1, -2, -4
WORDS = {OUT_OF_HOST_MEMORY: 'out of host memory', OUT_OF_DEVICE_MEMORY: 'out of device memory',
         DEVICE_LOST: 'device lost'}
# Functions without whose results the program continues, or reports that there is no usable loader.
ASKING = ('vkEnumerateDeviceExtensionProperties', 'vkEnumerateInstanceExtensionProperties',
          'vkEnumerateInstanceVersion')
NO_VULKAN = 69


def real_loader():
    """Returns the path of the system's Vulkan loader, because its name alone would find the failing one."""
    ctypes.CDLL('libvulkan.so.1')
    with open('/proc/self/maps', encoding='utf-8') as maps:
        return next(line.split()[-1] for line in maps if 'libvulkan.so' in line)


class Command:
    """A command line with a folder of its own, and the files that it writes."""

    def __init__(self, name, words, *outputs, recovers=False, lose=None, is_silent=False):
        self.name, self.words, self.outputs = name, words, outputs
        # The command does not warn about smaller waves. It has the option --only, because it makes thousands
        # of calls.
        self.is_silent = is_silent
        # The viewer reopens a lost device, and continues without optional objects that cannot be created.
        self.recovers = recovers
        # The submission at which the device is lost, before any other failure.
        self.variables = {'VKF_LOSE': str(lose)} if lose else {}
        self.reference = None

    def run(self, loader, **variables):
        with tempfile.TemporaryDirectory() as folder:
            env = dict(os.environ, LD_LIBRARY_PATH=os.path.dirname(loader),
                       VKF_LOADER=real_loader(), **self.variables, **variables)
            if self.recovers:
                with open(os.path.join(folder, 'script'), 'w', encoding='utf-8') as file:
                    file.write('timeout 20\nwait 2 samples\nscreenshot a.png panel\nquit\n')
            process = subprocess.run(self.words, cwd=folder, env=env, stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, text=True, timeout=300, check=False)
            left = set(os.listdir(folder)) - {'script'}
            return process, left


def report(process):
    return json.loads(process.stdout) if process.stdout.startswith('{') else None


def judge(command, function, result, process, left):
    """Returns what is wrong with the end of the process, or None."""
    code, words = process.returncode, process.stderr
    if code < 0 or 'Sanitizer' in words or 'runtime error' in words:
        return 'it crashed'
    if left - set(command.outputs):
        return 'it left %s' % ', '.join(sorted(left - set(command.outputs)))
    if code == 0:
        if command.recovers:
            return None
        # A lost device is reopened, and waves become smaller if memory runs out.
        went_on = len(re.findall('opening the device again|paths in place of', words))
        is_noticed = result != OUT_OF_HOST_MEMORY and went_on > len(command.variables)
        is_noticed |= result == OUT_OF_DEVICE_MEMORY and command.is_silent
        if function not in ASKING and function != 'vkDeviceWaitIdle' and not is_noticed:
            return 'the failure was not noticed'
        if command.reference and report(process)['image_hash'] != command.reference:
            return 'another picture'
        return None
    if code == NO_VULKAN and function in ASKING:
        return None
    if command.recovers and code == 1:  # a command of the script fails, because an object that it needs
                                        # cannot be created
        return None if 'script:' in words else 'no reason'
    if code != 3:
        return 'exit code %d, expected 3' % code
    if function in ASKING and not words:
        return 'no message'
    if function not in ASKING and WORDS[result] not in words:
        return 'the message lacks "%s"' % WORDS[result]
    if len(re.findall('^lampyris(-view)?: error: ', words, re.M)) != 1:
        return 'not one error'
    told = report(process)
    if bool(told) != bool(left & {'a.exr'}) and not command.recovers:
        return 'a report without a picture, or the other way round'
    if told and told['ended_by'] != 'device':
        return 'a report of %s' % told['ended_by']
    return None


def read_counts(path):
    """Returns how many times each function was called."""
    with open(path, encoding='utf-8') as file:
        return {name: int(count) for name, count in (line.split() for line in file)}


def list_faults(loader, command):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'count')
        process, _ = command.run(loader, VKF_COUNT=path)
        assert process.returncode == 0, process.stderr
        told = report(process)
        command.reference = told.get('image_hash') if told else None
        counts = read_counts(path)
    assert counts['vkQueueSubmit'] > 0, 'the loader was not used'
    assert process.stderr.count('opening the device again') == len(command.variables)
    return [(command, name, n, result) for name, count in counts.items()
            for n in range(1, count + 1) for result in WORDS]


def choose(faults, generator):
    """Returns all faults in random order; one of each function comes first."""
    generator.shuffle(faults)
    first, rest, seen = [], [], set()
    for fault in faults:
        (rest if fault[1] in seen else first).append(fault)
        seen.add(fault[1])
    return first + rest


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('lampyris', type=os.path.abspath)
    parser.add_argument('viewer')
    parser.add_argument('loader', type=os.path.abspath)
    parser.add_argument('scene', type=os.path.abspath)
    parser.add_argument('--sample', type=float)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--only', help='part of a command\'s name')
    parser.add_argument('--function', help='part of a function\'s name')
    options = parser.parse_args()
    # Meson sets LD_LIBRARY_PATH to the folder of the failing loader. Only the commands under test may find
    # that loader: neither this process, which searches for the system's one, nor `lampyris devices`.
    if os.environ.pop('LD_LIBRARY_PATH', None) is not None:
        os.execv(sys.executable, [sys.executable, *sys.argv])
    if subprocess.run([options.lampyris, 'devices'], stdout=subprocess.DEVNULL,
                      stderr=subprocess.DEVNULL, check=False).returncode == NO_VULKAN:
        sys.exit(77)
    small = [options.scene, '--size', '16x16', '-q']
    commands = [
        Command('render', [options.lampyris, 'render', *small, '--spp', '8', '--wave', '512',
                           '--json', '-o', 'a.exr'], 'a.exr'),
        Command('render, opened again', [options.lampyris, 'render', *small, '--spp', '8', '--wave',
                                         '512', '--json', '-o', 'a.exr'], 'a.exr', lose=6),
        Command('render --adaptive', [options.lampyris, 'render', *small, '--spp', '4', '--adaptive',
                                      'on', '--aov', 'all', '--checkpoint', 'a.ck',
                                      '--checkpoint-every', '0', '--json', '-o', 'a.exr'],
                'a.exr', 'a.ck'),
        Command('converge', [options.lampyris, 'converge', *small, '--spp', '2', '--spp-from', '1', '--replicates',
                             '2', '--reference', 'none']),
        Command('check', [options.lampyris, 'check', *small], is_silent=True),
        Command('bench', [options.lampyris, 'bench', *small, '--spp', '1', '--repeats', '2']),
    ]
    if options.viewer != 'none':
        commands.append(Command('view', [os.path.abspath(options.viewer), options.scene, '--size',
                                         '64x48', '-q', '--headless', '--script', 'script'],
                                'a.png', recovers=True))
    commands = [c for c in commands
                if (options.only in c.name if options.only else not c.is_silent)]
    faults = [f for command in commands for f in list_faults(options.loader, command)]
    faults = [f for f in faults if not options.function or options.function in f[1]]
    faults = choose(faults, random.Random(options.seed))
    tried, wrong = 0, 0
    for command, function, n, result in faults:
        if options.sample and processor_seconds() > options.sample and tried >= 40:
            break
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'count')
            process, left = command.run(options.loader, VKF_NAME=function, VKF_N=str(n),
                                        VKF_RESULT=str(result), VKF_COUNT=path)
            # Copies of the film depend on the clock, so some calls do not occur in every run.
            if process.returncode == 0 and read_counts(path)[function] < n:
                continue
        tried += 1
        fault = judge(command, function, result, process, left)
        if fault:
            wrong += 1
            print('%s: %s, call %d, result %d: %s\nexit code %d\n%s' % (
                command.name, function, n, result, fault, process.returncode,
                process.stderr[-2000:]), flush=True)
    print('%d of %d faults tried, %d ended wrongly' % (tried, len(faults), wrong))
    sys.exit(1 if wrong or not tried else 0)


if __name__ == '__main__':
    main()
