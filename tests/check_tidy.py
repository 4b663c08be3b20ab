#!/usr/bin/python3
"""Runs clang-tidy, with the checks of .clang-tidy, over every C file of src/.

check_tidy.py SOURCE_ROOT BUILD_ROOT [FILE…]: exits with 77, a skip, where there is no clang-tidy;
with 1 when LAMPYRIS_NO_SKIP is set.
"""
import concurrent.futures
import json
import os
import shutil
import subprocess
import sys



def sources(source_root, build_root):
    """Returns the files of src/ that the build compiles."""
    with open(os.path.join(build_root, 'compile_commands.json'), encoding='utf-8') as database:
        entries = json.load(database)
    paths = {os.path.realpath(os.path.join(e['directory'], e['file'])) for e in entries}
    folder = os.path.join(os.path.realpath(source_root), 'src', '')
    return sorted(path for path in paths if path.startswith(folder))


def check(path, build_root):
    """Returns clang-tidy's messages about a file; "" if there are none."""
    result = subprocess.run(['clang-tidy', '--quiet', '-p', build_root, path], text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode == 0:
        return ''
    return result.stdout or result.stderr


def main():
    source_root, build_root, *paths = sys.argv[1:]
    if not shutil.which('clang-tidy'):
        print('skipped: there is no clang-tidy')
        return 1 if os.environ.get('LAMPYRIS_NO_SKIP') else 77
    paths = paths or sources(source_root, build_root)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        findings = [text for text in pool.map(lambda path: check(path, build_root), paths) if text]
    print(''.join(findings), end='')
    print(f'{len(paths)} files, findings in {len(findings)}')
    return 1 if findings or not paths else 0


sys.exit(main())
