#!/usr/bin/python3
"""Checks what the program uses of the system: outside src/base/posix and src/base/windows, only headers and
functions of ISO C and of libraries.

check_platform.py SOURCE_ROOT BUILD_ROOT [unittest's arguments]
"""
import os
import re
import sys
import unittest

from check_graph import read_objects, read_symbols

# ISO C17, section 7.1.2, except threads.h, which macOS and MinGW lack.
ISO_HEADERS = {f'{name}.h' for name in (
    'assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal '
    'stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath time '
    'uchar wchar wctype').split()}
# Functions of these headers behave differently on other systems; files of src/base wrap them.
ISO_HEADERS -= {'signal.h', 'locale.h', 'time.h'}
LIBRARY_HEADERS = {'lampyris/lampyris.h', 'jansson.h', 'mpi.h', 'GLFW/glfw3.h', 'volk.h', 'openexr.h', 'meshoptimizer.h', 'png.h',
                   'jpeglib.h', 'jerror.h', 'webp/decode.h', 'stb_image.h', 'imgui.h', 'cglm/struct/vec3.h',
                   'cstring', 'cstddef',  # headers of C++, for Dear ImGui
                   'cstdio', 'exception', 'memory', 'draco/compression/decode.h', 'draco/core/decoder_buffer.h',
                   'draco/mesh/mesh.h',  # of C++, for Draco
                   'sanitizer/asan_interface.h'}
# Headers of which only types are used: struct mutex contains a mutex by value.
TYPES = {'base/thread.h': {'pthread.h'}}

# Functions of ISO C17, sections 7.3 and 7.12, in double and single precision, and of 7.8, 7.21, 7.22 and
# 7.24. Functions that open, name or remove files, or run programs, are excluded: base/file_system.h and
# base/process.h replace them.
MATHS = '''
    acos acosh asin asinh atan atan2 atanh cabs carg cbrt ceil cexp cimag clog conj copysign cos
    cosh cpow creal csqrt erf erfc exp exp2 expm1 fabs fdim floor fma fmax fmin fmod frexp hypot
    ilogb ldexp lgamma llrint llround log log10 log1p log2 logb lrint lround modf nan nearbyint
    nextafter pow remainder remquo rint round scalbln scalbn sin sinh sqrt tan tanh tgamma
    trunc'''.split()
ISO_FUNCTIONS = {name + suffix for name in MATHS for suffix in ('', 'f')} | set('''
    abort abs atexit bsearch calloc clearerr exit fclose feof ferror fflush fgetc fgets fprintf
    fputc fputs fread free fseek ftell fwrite getc getenv labs llabs longjmp malloc memchr memcmp
    memcpy memmove memset printf putc putchar puts qsort realloc rewind setvbuf snprintf sscanf
    stderr stdin stdout strchr strcmp strcpy strcspn strerror strlen strncmp strncpy strpbrk strrchr
    strspn strstr strtod strtof strtol strtoll strtoul strtoull tolower toupper ungetc vfprintf
    vsnprintf
    strdup'''.split())  # of C23, and on every system
# Names that compilers and C libraries substitute for these functions.
HIDDEN = re.compile(r'__\w+|bcmp|_GLOBAL_OFFSET_TABLE_|_setjmp|sincosf?|_Z\w+|_Unwind_\w+')
LIBRARY_FUNCTIONS = re.compile(r'(json|png|exr|jpeg|WebP|stbi_|meshopt|glfw|vk|volk|ImGui|MPI_|ompi_)\w*')
LOADER = {'gpu/volk.c': {'dlopen', 'dlsym', 'dlclose'}}  # volk's own code, compiled by this file


def is_system_file(path):
    return re.match(r'base/(posix|windows)/', path) is not None


def foreign_headers(path, text):
    allowed = ISO_HEADERS | LIBRARY_HEADERS | TYPES.get(path, set())
    return [f'{path}: <{name}>' for name in re.findall(r'^\s*#\s*include\s*<([^>]+)>', text,
                                                       re.MULTILINE) if name not in allowed]


def foreign_functions(symbols):
    """Returns, from {source: (defined, used)}, the functions that are neither the program's own, nor ISO C's,
    nor those of a library."""
    own = set().union(*(defined for defined, _ in symbols.values()))
    return [f'{source}: {name}' for source, (_, used) in symbols.items()
            if not is_system_file(source)
            for name in sorted(used - own - ISO_FUNCTIONS - LOADER.get(source, set()))
            if not HIDDEN.fullmatch(name) and not LIBRARY_FUNCTIONS.fullmatch(name)]


class Platform(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        objects = read_objects(SOURCE_ROOT, BUILD_ROOT)
        symbols = read_symbols(objects.values())
        cls.symbols = {source: symbols[path] for source, path in objects.items()}
        cls.texts = {}
        top = os.path.join(SOURCE_ROOT, 'src')
        for folder, _, names in os.walk(top):
            for name in (name for name in names if re.search(r'\.(c|h|cpp)$', name)):
                path = os.path.join(folder, name)
                with open(path, encoding='utf-8') as file:
                    cls.texts[os.path.relpath(path, top)] = file.read()

    def test_headers_are_of_iso_c(self):
        found = [line for path, text in self.texts.items() if not is_system_file(path)
                 for line in foreign_headers(path, text)]
        self.assertEqual(found, [])
        self.assertEqual(foreign_headers('job/job.c', '#include <unistd.h>\n'),
                         ['job/job.c: <unistd.h>'])
        self.assertEqual(len(foreign_headers('base/log.h', '# include <pthread.h>\n')), 1)

    def test_functions_are_of_iso_c(self):
        self.assertGreater(len(self.symbols), 250)
        self.assertEqual(foreign_functions(self.symbols), [])
        for name in ('stat', 'fopen', 'getpid', 'strcasecmp', 'open_memstream', 'pthread_create'):
            defined, used = self.symbols['job/job.c']
            planted = {**self.symbols, 'job/job.c': (defined, used | {name})}
            self.assertEqual(foreign_functions(planted), [f'job/job.c: {name}'])

    def test_each_system_has_each_purpose(self):
        paths = set(self.texts)
        purposes = [os.path.basename(path) for path in paths
                    if re.fullmatch(r'base/posix/\w+\.c', path)]
        self.assertGreater(len(purposes), 10)
        for purpose in purposes:
            with self.subTest(purpose):
                self.assertIn('base/' + purpose[:-1] + 'h', paths)
                self.assertIn('base/windows/' + purpose, paths)


if __name__ == '__main__':
    SOURCE_ROOT, BUILD_ROOT = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
