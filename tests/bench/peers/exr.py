"""Reads and writes OpenEXR files with 32-bit floats and the channels R, G and B: one part, scan lines,
uncompressed or ZIP.

That is what both renderers write, and what both read as an environment (OpenEXR: "The OpenEXR file layout", openexr.com).
Modules of other authors are not needed, so that the comparison runs wherever Python does.
"""
import array
import struct
import sys
import zlib

FLOAT = 2
LINES = {0: 1, 2: 1, 3: 16}  # lines per block, by compression: none, ZIPS, ZIP


def _string(data, at):
    end = data.index(b'\0', at)
    return data[at:end].decode('ascii'), end + 1


def _header(data):
    """Returns the attributes' values by name, and the place of the table of offsets."""
    if data[:4] != b'\x76\x2f\x31\x01':
        raise ValueError('this is no OpenEXR file')
    at, attributes = 8, {}
    while data[at]:
        name, at = _string(data, at)
        _, at = _string(data, at)
        size, = struct.unpack_from('<i', data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(value):
    at, names = 0, []
    while value[at]:
        name, at = _string(value, at)
        kind, = struct.unpack_from('<i', value, at)
        if kind != FLOAT:
            raise ValueError('channel %s: its type is %d, but 32-bit floats (2) are read' % (name, kind))
        names.append(name)
        at += 16
    return names


def _unzip(data, size):
    """Decompresses a block and inverts ZIP's predictor and its interleaving of two halves."""
    if len(data) == size:
        return data
    differences = zlib.decompress(data)
    total, plain = 0, bytearray(size)
    for i, byte in enumerate(differences):
        total = (total + byte - (128 if i else 0)) & 255
        plain[i] = total
    half, result = (size + 1) // 2, bytearray(size)
    result[0::2], result[1::2] = plain[:half], plain[half:]
    return bytes(result)


def _floats(data):
    values = array.array('f', data)
    if sys.byteorder == 'big':
        values.byteswap()
    return values


def read(path):
    """Returns (width, height, (red, green, blue)) with three arrays of floats, row by row from the top."""
    with open(path, 'rb') as file:
        data = file.read()
    attributes, at = _header(data)
    compression = attributes['compression'][0]
    if compression not in LINES:
        raise ValueError('%s: compression %d is not read, but none, ZIPS and ZIP' % (path, compression))
    names = _channels(attributes['channels'])
    left, top, right, bottom = struct.unpack('<4i', attributes['dataWindow'])
    width, height = right - left + 1, bottom - top + 1
    planes = {name: array.array('f', bytes(4 * width * height)) for name in ('R', 'G', 'B')}
    blocks = (height + LINES[compression] - 1) // LINES[compression]
    for offset in struct.unpack_from('<%dQ' % blocks, data, at):
        line, size = struct.unpack_from('<ii', data, offset)
        lines = min(LINES[compression], bottom - line + 1)
        block = _floats(_unzip(data[offset + 8:offset + 8 + size], 4 * width * lines * len(names)))
        for i in range(lines * len(names)):
            plane = planes.get(names[i % len(names)])
            if plane is not None:
                start = (line - top + i // len(names)) * width
                plane[start:start + width] = block[i * width:(i + 1) * width]
    return width, height, (planes['R'], planes['G'], planes['B'])


def _attribute(name, kind, value):
    return name + b'\0' + kind + b'\0' + struct.pack('<i', len(value)) + value


def write(path, width, height, planes):
    """Writes three arrays of floats, for red, green and blue, without compression."""
    window = struct.pack('<4i', 0, 0, width - 1, height - 1)
    channels = b''.join(name + b'\0' + struct.pack('<iB3xii', FLOAT, 0, 1, 1) for name in (b'B', b'G', b'R'))
    header = b''.join((
        b'\x76\x2f\x31\x01', struct.pack('<i', 2),
        _attribute(b'channels', b'chlist', channels + b'\0'), _attribute(b'compression', b'compression', b'\0'),
        _attribute(b'dataWindow', b'box2i', window), _attribute(b'displayWindow', b'box2i', window),
        _attribute(b'lineOrder', b'lineOrder', b'\0'), _attribute(b'pixelAspectRatio', b'float', struct.pack('<f', 1)),
        _attribute(b'screenWindowCenter', b'v2f', struct.pack('<2f', 0, 0)),
        _attribute(b'screenWindowWidth', b'float', struct.pack('<f', 1)), b'\0'))
    line = 12 * width
    first = len(header) + 8 * height
    with open(path, 'wb') as file:
        file.write(header)
        file.write(struct.pack('<%dQ' % height, *(first + y * (line + 8) for y in range(height))))
        for y in range(height):
            file.write(struct.pack('<ii', y, line))
            for plane in reversed(planes):
                row = array.array('f', plane[y * width:(y + 1) * width])
                if sys.byteorder == 'big':
                    row.byteswap()
                file.write(row.tobytes())
