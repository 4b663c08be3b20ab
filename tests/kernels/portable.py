"""Checks that kernels require only what every device provides: docs/portability.md.

    portable.py NAME.spv ... NAME.spv.h ...

Reads SPIR-V, as files of words or as the arrays that glslangValidator writes of them.

- Trigonometric functions of the device are not called: Vulkan grants sines 2^-11 and arctangents
  4096 units in the last place.
- Functions that the threads of a workgroup enter together, with a barrier or an operation of
  subgroups in them or in what they call, have one return, at their end: only then have the threads
  come together again after each `if` (SPIR-V 2.11, "Uniform Control Flow").
- A storage buffer that is written, and the texel buffer that reads the same memory, are Aliased
  (SPIR-V 2.18.2).
- Of capabilities, those alone that the device is asked for.

Exit status: 0 passed, 1 failed.
"""

import pathlib
import re
import struct
import sys

OP_EXT_INST = 12
OP_CAPABILITY = 17
OP_TYPE_IMAGE = 25
OP_TYPE_SAMPLED_IMAGE = 27
OP_TYPE_POINTER = 32
OP_FUNCTION = 54
OP_FUNCTION_CALL = 57
OP_VARIABLE = 59
OP_DECORATE = 71
OP_MEMBER_DECORATE = 72
OP_CONTROL_BARRIER = 224
OPS_OF_RETURN = (252, 253, 254)  # OpKill, OpReturn, OpReturnValue
OPS_OF_GROUPS = range(333, 367)  # OpGroupNonUniform*
DECORATION_ALIASED = 20
DECORATION_NON_WRITABLE = 24
DECORATION_BINDING = 33
STORAGE_BUFFER = 12
DIM_BUFFER = 5
# The first texel buffer reads the memory of storage buffer 0: TEXEL_BINDING_FIRST.
FIRST_TEXEL = 16
# Shader, SampledBuffer, GroupNonUniform, -Vote, -Arithmetic, -Ballot.
CAPABILITIES = (1, 46, 61, 62, 63, 64)
# GLSL.std.450: Sin, Cos, Tan, Asin, Acos, Atan, Atan2.
TRIGONOMETRY = {13: 'sin', 14: 'cos', 15: 'tan', 16: 'asin', 17: 'acos', 18: 'atan', 25: 'atan2'}


def read_words(path):
    """Returns the words of a module."""
    if path.suffix == '.spv':
        data = path.read_bytes()
        return struct.unpack('<%dI' % (len(data) // 4), data)
    text = path.read_text(encoding='utf-8')
    return [int(word, 16) for word in re.findall(r'0x([0-9a-fA-F]{8})\b', text)]


def instructions(words):
    """Yields the opcode and the operands of each instruction."""
    at = 5
    while at < len(words):
        length = words[at] >> 16
        yield words[at] & 0xffff, words[at + 1:at + length]
        at += length


def functions_that_meet(words):
    """Returns functions that contain, or call functions that contain, group operations, with their numbers of
    returns."""
    meets, calls, returns, current = set(), {}, {}, None
    for op, operands in instructions(words):
        if op == OP_FUNCTION:
            current = operands[1]
            calls[current], returns[current] = set(), 0
        elif op == OP_FUNCTION_CALL:
            calls[current].add(operands[2])
        elif op in OPS_OF_RETURN:
            returns[current] += 1
        elif op in OPS_OF_GROUPS or op == OP_CONTROL_BARRIER:
            meets.add(current)
    while True:
        more = {f for f in calls if calls[f] & meets} - meets
        if not more:
            return {f: returns[f] for f in meets}
        meets |= more


def unaliased(words):
    """Returns the bindings of buffers that are written, and also read through a texel buffer, but are not
    `Aliased`."""
    decorations, read_only, pointers, variables, images = {}, set(), {}, {}, set()
    for op, operands in instructions(words):
        if op == OP_DECORATE:
            decorations.setdefault(operands[0], {})[operands[1]] = operands[2:]
        elif op == OP_MEMBER_DECORATE and operands[2] == DECORATION_NON_WRITABLE:
            read_only.add(operands[0])
        elif op == OP_TYPE_IMAGE and operands[2] == DIM_BUFFER:
            images.add(operands[0])
        elif op == OP_TYPE_SAMPLED_IMAGE and operands[1] in images:
            images.add(operands[0])
        elif op == OP_TYPE_POINTER:
            pointers[operands[0]] = operands[1:]
        elif op == OP_VARIABLE:
            variables[operands[1]] = pointers[operands[0]]
    buffers, texels = {}, {}
    for variable, (storage, kind) in variables.items():
        decorated = decorations.get(variable, {})
        if DECORATION_BINDING not in decorated:
            continue
        binding = decorated[DECORATION_BINDING][0]
        if kind in images:
            texels[binding - FIRST_TEXEL] = decorated
        elif storage == STORAGE_BUFFER and kind not in read_only:
            buffers[binding] = decorated
    return sorted(b for b in buffers.keys() & texels.keys()
                  if DECORATION_ALIASED not in buffers[b] or DECORATION_ALIASED not in texels[b])


def complaints(words):
    """Returns the module's requirements that a device need not fulfil."""
    for op, operands in instructions(words):
        if op == OP_EXT_INST and operands[3] in TRIGONOMETRY:
            yield 'calls %s(): expected cos_sin_turns() and atan_turns() of lib/angle.glsl' % \
                TRIGONOMETRY[operands[3]]
        if op == OP_CAPABILITY and operands[0] not in CAPABILITIES:
            yield 'needs capability %d: expected one of %s' % (operands[0], CAPABILITIES)
    for function, returns in functions_that_meet(words).items():
        if returns != 1:
            yield 'function %d has operations of groups and %d returns: expected one' % \
                (function, returns)
    for binding in unaliased(words):
        yield 'buffer %d is written and read as texels: expected both variables to be Aliased' % \
            binding


def main():
    """Prints the requirements of each module."""
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
