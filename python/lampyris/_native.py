"""Declares the structs and functions of lampyris.h for ctypes, and loads the C library."""
import ctypes
import os
from ctypes import (CFUNCTYPE, POINTER, Structure, c_bool, c_char_p, c_double, c_float, c_int, c_size_t,
                    c_uint32, c_uint64, c_void_p)

from . import _library

OK, INPUT, DEVICE, OUTPUT, NO_VULKAN, STOPPED = 0, 2, 3, 4, 69, 130


class Sized(Structure):
    """A struct whose first member is its size."""

    def __init__(self, **members):
        super().__init__(size=ctypes.sizeof(self), **members)


LOG = CFUNCTYPE(None, c_void_p, c_int, c_char_p)


class ContextParams(Sized):
    _fields_ = [('size', c_size_t), ('device', c_char_p), ('log', LOG), ('user', c_void_p),
                ('log_level', c_int), ('memory_bytes', c_uint64), ('validation', c_bool)]


class Error(Sized):
    _fields_ = [('size', c_size_t), ('status', c_int), ('message', c_char_p), ('file', c_char_p),
                ('place', c_char_p), ('expected', c_char_p)]


class Device(Sized):
    _fields_ = [('size', c_size_t), ('name', c_char_p), ('driver', c_char_p), ('kind', c_char_p),
                ('unusable', c_char_p), ('memory_bytes', c_uint64), ('is_cpu', c_bool)]


class Moment(Sized):
    _fields_ = [('size', c_size_t), ('phase', c_char_p), ('fraction', c_double), ('samples', c_uint64),
                ('seconds', c_double), ('rays', c_uint64)]


REPORT = CFUNCTYPE(c_bool, c_void_p, POINTER(Moment))


class Progress(Sized):
    _fields_ = [('size', c_size_t), ('report', REPORT), ('user', c_void_p)]


class SceneParams(Sized):
    _fields_ = [('size', c_size_t), ('overrides', POINTER(c_char_p)), ('allow_outside_paths', c_bool),
                ('is_strict', c_bool)]


class Mesh(Sized):
    _fields_ = [('size', c_size_t), ('vertex_count', c_uint32), ('triangle_count', c_uint32),
                ('positions', c_void_p), ('position_stride', c_size_t),
                ('normals', c_void_p), ('normal_stride', c_size_t),
                ('uvs', c_void_p), ('uv_stride', c_size_t),
                ('colors', c_void_p), ('color_stride', c_size_t),
                ('indices', c_void_p), ('index_stride', c_size_t),
                ('material', c_char_p), ('is_borrowed', c_bool)]


class Goal(Sized):
    _fields_ = [('size', c_size_t), ('samples', c_uint64), ('seconds', c_double), ('error', c_double)]


class State(Sized):
    _fields_ = [('size', c_size_t), ('width', c_uint32), ('height', c_uint32), ('samples', c_uint64),
                ('samples_total', c_uint64), ('pixels_without_samples', c_uint64),
                ('samples_dropped', c_uint64), ('ended_by', c_char_p), ('seconds_load', c_double),
                ('seconds_bvh', c_double), ('seconds_upload', c_double), ('seconds_compile', c_double),
                ('seconds_render', c_double), ('seconds_judge', c_double), ('seconds_write', c_double),
                ('rays_closest', c_uint64), ('rays_shadow', c_uint64), ('error', c_double),
                ('error_low', c_double), ('error_high', c_double), ('error_at_most', c_double),
                ('error_why', c_char_p), ('hash', c_uint64)]


class Layer(Sized):
    _fields_ = [('size', c_size_t), ('name', c_char_p), ('channel_count', c_uint32),
                ('channels', c_char_p), ('is_integer', c_bool)]


class SaveParams(Sized):
    _fields_ = [('size', c_size_t), ('half_float', c_bool)]


class Part(Sized):
    _fields_ = [('size', c_size_t), ('kind', c_char_p), ('name', c_char_p), ('reason', c_char_p),
                ('bytes', c_uint64), ('is_left_out', c_bool)]


class Interval(Structure):
    _fields_ = [('value', c_double), ('low', c_double), ('high', c_double)]


class Metrics(Sized):
    _fields_ = [('size', c_size_t), ('mse', Interval), ('relmse', Interval), ('local_relmse', Interval),
                ('smape', c_double), ('psnr', c_double), ('ssim', c_double), ('flip', c_double),
                ('hdr_flip', c_double), ('max', c_double), ('pixels_nonfinite', c_uint64),
                ('pixels_differing', c_uint64)]


# Each entry is NAME: (result, arguments). Objects are opaque; the caller releases strings.
FUNCTIONS = {
    'version': (c_char_p,),
    'context_create': (c_int, POINTER(ContextParams), POINTER(c_void_p)),
    'context_release': (None, c_void_p),
    'context_error': (None, c_void_p, POINTER(Error)),
    'device_count': (c_int, c_void_p, POINTER(c_uint32)),
    'device_at': (c_int, c_void_p, c_uint32, POINTER(Device)),
    'scene_load': (c_int, c_void_p, c_char_p, POINTER(SceneParams), POINTER(c_void_p)),
    'scene_parse': (c_int, c_void_p, c_char_p, c_char_p, POINTER(SceneParams), POINTER(c_void_p)),
    'scene_release': (None, c_void_p),
    'scene_get': (c_int, c_void_p, c_char_p, POINTER(c_void_p)),
    'scene_set': (c_int, c_void_p, c_char_p, c_char_p),
    'scene_remove': (c_int, c_void_p, c_char_p),
    'text_release': (None, c_void_p),
    'scene_add_mesh': (c_int, c_void_p, c_char_p, POINTER(Mesh)),
    'scene_check': (c_int, c_void_p, POINTER(Progress)),
    'render_begin': (c_int, c_void_p, c_char_p, POINTER(Progress), POINTER(c_void_p)),
    'render_release': (None, c_void_p),
    'render_step': (c_int, c_void_p, POINTER(Goal), POINTER(Progress)),
    'render_state': (c_int, c_void_p, POINTER(State)),
    'render_layer': (c_int, c_void_p, c_uint32, POINTER(Layer)),
    'render_read': (c_int, c_void_p, c_char_p, c_void_p, c_size_t, c_size_t),
    'render_save': (c_int, c_void_p, c_char_p, POINTER(SaveParams)),
    'render_checkpoint': (c_int, c_void_p, c_char_p),
    'render_repeat': (c_int, c_void_p, POINTER(c_char_p)),
    'render_part': (c_int, c_void_p, c_uint32, POINTER(Part)),
    'picture_load': (c_int, c_void_p, c_char_p, c_char_p, POINTER(c_void_p)),
    'picture_release': (None, c_void_p),
    'picture_pixels': (POINTER(c_float), c_void_p, POINTER(c_uint32), POINTER(c_uint32)),
    'compare': (c_int, c_void_p, c_void_p, c_void_p, c_uint32, c_uint32, POINTER(Metrics)),
}


def open_library():
    """Loads the library: the one that the environment variable LAMPYRIS_LIBRARY names, or else the one
    with which this package was built or installed, or else the system's."""
    chosen = os.environ.get('LAMPYRIS_LIBRARY')
    failures = []
    for path in [chosen] if chosen else [_library.PATH, _library.NAME]:
        try:
            return ctypes.CDLL(path)
        except OSError as failure:
            failures.append(str(failure))
    raise ImportError('liblampyris was not found: ' + '; '.join(failures) +
                      '; expected it to be installed, or its path in LAMPYRIS_LIBRARY')


class Functions:
    """The functions of the library, named without the prefix."""

    def __init__(self):
        library = open_library()
        for name, (result, *arguments) in FUNCTIONS.items():
            function = getattr(library, 'lampyris_' + name)
            function.restype, function.argtypes = result, arguments
            setattr(self, name, function)


lib = Functions()


def encode(text):
    """Encodes a string or a path as the library expects it; None becomes NULL."""
    return None if text is None else os.fsencode(text)


def decode(data):
    return (data or b'').decode('utf-8', 'replace')
