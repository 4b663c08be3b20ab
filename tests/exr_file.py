"""Writes small EXR files with known pixels for tests."""
import struct


def exr(path, width, height, rgb):
    """Writes an uncompressed 32-bit EXR (OpenEXR file layout). rgb(x, y) returns a pixel."""
    def attribute(name, kind, value):
        return name + b'\0' + kind + b'\0' + struct.pack('<i', len(value)) + value
    channels = b''.join(c + b'\0' + struct.pack('<iiii', 2, 0, 1, 1) for c in (b'B', b'G', b'R'))
    window = struct.pack('<iiii', 0, 0, width - 1, height - 1)
    header = struct.pack('<ii', 20000630, 2)
    header += attribute(b'channels', b'chlist', channels + b'\0')
    header += attribute(b'compression', b'compression', b'\0')
    header += attribute(b'dataWindow', b'box2i', window)
    header += attribute(b'displayWindow', b'box2i', window)
    header += attribute(b'lineOrder', b'lineOrder', b'\0')
    header += attribute(b'pixelAspectRatio', b'float', struct.pack('<f', 1))
    header += attribute(b'screenWindowCenter', b'v2f', struct.pack('<ff', 0, 0))
    header += attribute(b'screenWindowWidth', b'float', struct.pack('<f', 1)) + b'\0'
    line = 8 + 12 * width
    first = len(header) + 8 * height
    with open(path, 'wb') as file:
        file.write(header)
        for y in range(height):
            file.write(struct.pack('<Q', first + y * line))
        for y in range(height):
            file.write(struct.pack('<ii', y, 12 * width))
            for channel in (2, 1, 0):
                for x in range(width):
                    file.write(struct.pack('<f', rgb(x, y)[channel]))
