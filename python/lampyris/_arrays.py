"""Converts the caller's arrays for the library, and holds pixels for the caller. Arrays of numpy are
supported, but numpy is not required."""
import ctypes
import sys

from ._errors import InputError

BYTE_ORDER = '<' if sys.byteorder == 'little' else '>'
TYPES = {'f': ctypes.c_float, 'u': ctypes.c_uint32}


class Given:
    """An array of `count` elements in memory; `kept` keeps the memory alive as long as this object."""

    def __init__(self, address, count, stride, kept):
        self.address, self.count, self.stride, self.kept = address, count, stride, kept


def _fail(name, width, what):
    raise InputError(f'{name}: {what}; expected {width} numbers for each element',
                     expected=f'{width} numbers for each element')


def _by_interface(interface, value, width, kind):
    """Returns the array without copying it, or None if its type or layout is not the required one."""
    shape, strides = interface['shape'], interface.get('strides')
    if len(shape) == 1 and shape[0] % width == 0 and strides is None:
        shape = (shape[0] // width, width)
    if interface['typestr'] != f'{BYTE_ORDER}{kind}4' or len(shape) != 2 or shape[1] != width:
        return None
    row, column = strides or (4 * width, 4)
    if column != 4 or row < 0 or not interface.get('data'):
        return None
    return Given(interface['data'][0], shape[0], row, value)


def _flatten(value, name, width):
    """Returns the numbers of a flat or nested sequence, or of an array of another type, as a list."""
    if hasattr(value, 'tolist'):
        value = value.tolist()
    elements = list(value)
    if elements and not hasattr(elements[0], '__len__'):
        if len(elements) % width:
            _fail(name, width, f'there are {len(elements)} numbers')
        return elements
    for i, element in enumerate(elements):
        if not hasattr(element, '__len__') or len(element) != width:
            _fail(name, width, f'element {i} is {element!r}')
    return [number for element in elements for number in element]


def _convert(value, width, kind):
    """Converts an array of numpy to the required type; returns None for other objects."""
    numpy = sys.modules.get('numpy')
    if not numpy or not isinstance(value, numpy.ndarray):
        return None
    if kind == 'u' and value.size and (value.min() < 0 or value.max() >= 2 ** 32):
        raise InputError(f'an index is {value.min() if value.min() < 0 else value.max()}; expected 0 to '
                         '2^32 - 1')
    converted = numpy.ascontiguousarray(value, dtype=f'{BYTE_ORDER}{kind}4')
    return _by_interface(converted.__array_interface__, converted, width, kind)


def take(value, name, width, kind='f'):
    """Returns an array of elements of `width` floats (kind 'f') or uint32 (kind 'u'). It is copied only if
    its type or its layout requires that."""
    interface = getattr(value, '__array_interface__', None)
    given = interface and _by_interface(interface, value, width, kind) or _convert(value, width, kind)
    if given:
        return given
    numbers = _flatten(value, name, width)
    if kind == 'u' and any(not 0 <= number < 2 ** 32 for number in numbers):
        raise InputError(f'{name}: an index is out of range; expected 0 to 2^32 - 1')
    kept = (TYPES[kind] * len(numbers))(*numbers)
    return Given(ctypes.addressof(kept), len(numbers) // width, 4 * width, kept)


class Pixels:
    """Pixels in rows from the top. `pixels[y, x]` is a tuple, or a number if there is one channel. `shape`
    is (height, width, channels), or (height, width) if there is one channel. numpy.asarray(pixels) and
    pixels.view use the same memory without copying it."""

    def __init__(self, width, height, channels, kind='f'):
        self.width, self.height, self.channels, self.kind = width, height, channels, kind
        self.shape = (height, width, channels) if channels > 1 else (height, width)
        self._data = (TYPES[kind] * (width * height * channels))()

    @property
    def address(self):
        return ctypes.addressof(self._data)

    @property
    def __array_interface__(self):
        return {'version': 3, 'shape': self.shape, 'typestr': f'{BYTE_ORDER}{self.kind}4',
                'data': (self.address, False)}

    @property
    def view(self):
        """A memoryview of the pixels, with the shape `shape`."""
        code = {'f': 'f', 'u': 'I'}[self.kind]
        return memoryview(self._data).cast('B').cast(code, self.shape)

    def tolist(self):
        return self.view.tolist()

    def __len__(self):
        return self.height

    def __getitem__(self, place):
        if not isinstance(place, tuple):
            y = range(self.height)[place]
            return [self[y, x] for x in range(self.width)]
        y, x = range(self.height)[place[0]], range(self.width)[place[1]]
        at = (y * self.width + x) * self.channels
        found = tuple(self._data[at:at + self.channels])
        return found if self.channels > 1 else found[0]

    def __repr__(self):
        return f'<Pixels {"x".join(map(str, self.shape))} of {"float32" if self.kind == "f" else "uint32"}>'
