"""Whether the kernels ask of a device only what every device has to give: docs/portability.md.

    portable.py NAME.spv ... NAME.spv.h ...

Reads SPIR-V, as files of words or as the arrays that glslangValidator writes of them. Trigonometric
functions of the device are not called: Vulkan grants sines 2^-11 and arctangents 4096 units in the
last place.

Exit status: 0 passed, 1 failed.
"""

import pathlib
import re
import struct
import sys

OP_EXT_INST = 12
# GLSL.std.450: Sin, Cos, Tan, Asin, Acos, Atan, Atan2.
TRIGONOMETRY = {13: 'sin', 14: 'cos', 15: 'tan', 16: 'asin', 17: 'acos', 18: 'atan', 25: 'atan2'}


def read_words(path):
    """The words of a module."""
    if path.suffix == '.spv':
        data = path.read_bytes()
        return struct.unpack('<%dI' % (len(data) // 4), data)
    text = path.read_text(encoding='utf-8')
    return [int(word, 16) for word in re.findall(r'0x([0-9a-fA-F]{8})\b', text)]


def instructions(words):
    """Opcode and operands of each instruction."""
    at = 5
    while at < len(words):
        length = words[at] >> 16
        yield words[at] & 0xffff, words[at + 1:at + length]
        at += length


def complaints(words):
    """What a module asks for that a device need not have."""
    for op, operands in instructions(words):
        if op == OP_EXT_INST and operands[3] in TRIGONOMETRY:
            yield 'calls %s(): expected cos_sin_turns() and atan_turns() of lib/angle.glsl' % \
                TRIGONOMETRY[operands[3]]


def main():
    """Prints what each module asks for."""
    failed = False
    for path in map(pathlib.Path, sys.argv[1:]):
        words = read_words(path)
        if words[0] != 0x07230203:
            sys.exit('%s: %x: expected SPIR-V' % (path, words[0]))
        for complaint in sorted(set(complaints(words))):
            print('%s: %s' % (path.name, complaint))
            failed = True
    print('%d modules' % len(sys.argv[1:]))
    sys.exit(1 if failed or len(sys.argv) < 2 else 0)


if __name__ == '__main__':
    main()
