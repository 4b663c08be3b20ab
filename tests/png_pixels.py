"""Reads the pixels of an 8-bit RGB PNG without interlacing (PNG specification, sections 9 and 11)."""
import struct
import zlib


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def read(path):
    """Returns (width, height, rows); each row has 3 * width bytes."""
    with open(path, 'rb') as file:
        data = file.read()
    at, packed, size = 8, b'', None
    while at < len(data):
        length, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            size = struct.unpack('>IIBBBBB', data[at + 8:at + 8 + length])
        elif kind == b'IDAT':
            packed += data[at + 8:at + 8 + length]
        at += length + 12
    width, height = size[:2]
    assert size[2:] == (8, 2, 0, 0, 0), size
    raw, stride = zlib.decompress(packed), 3 * width
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = row[i - 3] if i >= 3 else 0
            corner = above[i - 3] if i >= 3 else 0
            guess = (0, left, above[i], (left + above[i]) // 2, 0)[kind]
            row[i] = row[i] + (paeth(left, above[i], corner) if kind == 4 else guess) & 255
        rows.append(row)
        above = row
    return width, height, rows


def pixel(picture, x, y):
    return tuple(picture[2][y][3 * x:3 * x + 3])


def most_different(a, b, columns):
    """Returns the greatest difference between the codes of two images in these columns."""
    return max(abs(x - y) for row, other in zip(a[2], b[2])
               for x, y in zip(row[3 * columns[0]:3 * columns[1]],
                               other[3 * columns[0]:3 * columns[1]]))
