"""Reads pictures and compares them."""
import ctypes
import os
from collections import namedtuple

from . import _arrays, _context, _native
from ._errors import InputError
from ._native import lib

Interval = namedtuple('Interval', 'value low high')
Metrics = namedtuple('Metrics', 'mse relmse local_relmse smape psnr ssim flip hdr_flip max pixels_nonfinite '
                     'pixels_differing')


def read(path, layer=None, *, context=None):
    """Returns the pixels of an .exr, .hdr, .pfm, .png or .jpg file, as linear RGB."""
    context = context or _context.common()
    handle, width, height = ctypes.c_void_p(), ctypes.c_uint32(), ctypes.c_uint32()
    context._run(lib.picture_load, context._handle, _native.encode(path), layer and layer.encode('utf-8'),
                 ctypes.byref(handle))
    try:
        data = lib.picture_pixels(handle, ctypes.byref(width), ctypes.byref(height))
        pixels = _arrays.Pixels(width.value, height.value, 3)
        ctypes.memmove(pixels.address, data, 12 * width.value * height.value)
        return pixels
    finally:
        context._discard(lib.picture_release, handle)


def _pixels(picture, context):
    """Returns (address, width, height, object that keeps the pixels alive) of a picture."""
    if isinstance(picture, (str, os.PathLike)):
        picture = read(picture, context=context)
    picture = getattr(picture, 'array', picture)
    shape = tuple(getattr(picture, 'shape', ()))
    if not shape:
        shape = (len(picture), len(picture[0]), 3)
    if len(shape) != 3 or shape[2] != 3:
        raise InputError(f'the picture has the shape {shape}; expected (height, width, 3)',
                         expected='(height, width, 3)')
    flat = picture.reshape(-1, 3) if hasattr(picture, 'reshape') else _rows(picture)
    given = _arrays.take(flat, 'a picture', 3)
    if given.stride != 12:
        given = _arrays.take(flat.tolist(), 'a picture', 3)
    return given.address, shape[1], shape[0], given


def _rows(picture):
    """Returns all pixels, row by row: a view if `picture` is Pixels, otherwise a list."""
    if not isinstance(picture, _arrays.Pixels):
        return [pixel for row in picture for pixel in row]
    return _Flat(picture)


class _Flat:
    def __init__(self, pixels):
        self.pixels = pixels
        interface = pixels.__array_interface__
        self.__array_interface__ = {**interface, 'shape': (pixels.width * pixels.height, 3)}


def compare(picture, reference, *, context=None):
    """Returns the error of a picture against a reference, as Metrics. Each of the two is a Picture, the
    path of a file, Pixels, or an array of shape (height, width, 3). mse, relmse and local_relmse are
    Intervals with 95 % confidence. docs/comparing.md has the formulas."""
    context = context or _context.common()
    a, width, height, kept = _pixels(picture, context)
    b, other_width, other_height, also_kept = _pixels(reference, context)
    if (width, height) != (other_width, other_height):
        raise InputError(f'the picture has {width} x {height} pixels and the reference {other_width} x '
                         f'{other_height}; expected the same size')
    metrics = _native.Metrics()
    context._run(lib.compare, context._handle, a, b, width, height, ctypes.byref(metrics))
    del kept, also_kept
    values = [getattr(metrics, name) for name in Metrics._fields]
    return Metrics(*(Interval(v.value, v.low, v.high) if isinstance(v, _native.Interval) else v
                     for v in values))
