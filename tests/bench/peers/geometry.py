"""Makes the meshes of the scenes, and the PLY files from which both renderers read them.

A mesh is (vertices, triangles, normals): lists of (x, y, z), of three indices, and of vertices' normals or None where
its triangles are shaded as the planes that they are.
"""
import math
import struct


def quad(corner, u, v):
    """Makes a parallelogram whose normal is u x v."""
    a = tuple(corner)
    b = tuple(p + q for p, q in zip(corner, u))
    d = tuple(p + q for p, q in zip(corner, v))
    c = tuple(p + q for p, q in zip(b, v))
    return [a, b, c, d], [(0, 1, 2), (0, 2, 3)], None


def joined(*meshes):
    """Joins meshes without normals to one mesh."""
    vertices, triangles = [], []
    for more, faces, _ in meshes:
        triangles += [tuple(i + len(vertices) for i in face) for face in faces]
        vertices += more
    return vertices, triangles, None


def box(low, high, turn_degrees=0.0):
    """Makes a box, rotated about the vertical axis through its centre. Normals point outwards."""
    angle = math.radians(turn_degrees)
    middle = [(p + q) / 2 for p, q in zip(low, high)]
    corners = []
    for i in range(8):
        x, y, z = ((high, low)[1 - (i >> axis & 1)][axis] for axis in range(3))
        x, z = x - middle[0], z - middle[2]
        corners.append((middle[0] + x * math.cos(angle) + z * math.sin(angle), y,
                        middle[2] - x * math.sin(angle) + z * math.cos(angle)))
    faces = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    return corners, [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))], None


def _middle(vertices, known, a, b):
    key = (min(a, b), max(a, b))
    if key not in known:
        known[key] = len(vertices)
        point = [p + q for p, q in zip(vertices[a], vertices[b])]
        length = math.hypot(*point)
        vertices.append(tuple(p / length for p in point))
    return known[key]


def icosphere(subdivision):
    """Makes the unit sphere with 20 * 4^subdivision triangles and the sphere's normals at the vertices."""
    g = (1 + math.sqrt(5)) / 2
    length = math.hypot(1, g)
    vertices = [tuple(p / length for p in v) for v in (
        (-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
        (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1))]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
                 (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivision):
        known, finer = {}, []
        for a, b, c in triangles:
            ab, bc, ca = (_middle(vertices, known, *edge) for edge in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return vertices, triangles, list(vertices)


def globe(segments, rings):
    """Makes the unit sphere with 2 * segments * (rings - 1) flat triangles between meridians and
    parallels."""
    vertices = [(0, 1, 0)]
    for i in range(1, rings):
        theta = math.pi * i / rings
        for j in range(segments):
            phi = 2 * math.pi * j / segments
            vertices.append((math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)))
    vertices.append((0, -1, 0))
    triangles, last = [], len(vertices) - 1
    for j in range(segments):
        k = (j + 1) % segments
        triangles.append((0, 1 + j, 1 + k))
        for i in range(rings - 2):
            a, b = 1 + i * segments + j, 1 + i * segments + k
            triangles += [(a, a + segments, b), (b, a + segments, b + segments)]
        triangles.append((last, 1 + (rings - 2) * segments + k, 1 + (rings - 2) * segments + j))
    return vertices, triangles, None


def displaced_torus(around, about):
    """Makes a torus about y with 2 * around * about flat triangles and radii 1 and .45, displaced by waves of
    seven lengths."""
    def height(p, q):
        total = 0.0
        for n, (a, b, phase) in enumerate(((5, 3, .3), (9, 7, 1.1), (17, 11, 2.3), (31, 23, .7), (61, 41, 1.9),
                                           (113, 83, 2.9), (211, 151, .1))):
            total += math.sin(a * p + b * q + phase) * math.sin(a * q - b * p + 2 * phase) * .1 * .55**n
        return total
    vertices, triangles = [], []
    for i in range(around):
        p = 2 * math.pi * i / around
        cos_p, sin_p = math.cos(p), math.sin(p)
        for j in range(about):
            q = 2 * math.pi * j / about
            tube = .45 + height(p, q)
            radius = 1 + tube * math.cos(q)
            vertices.append((radius * cos_p, tube * math.sin(q), -radius * sin_p))
            a, b = i * about + j, i * about + (j + 1) % about
            c, d = (i + 1) % around * about + j, (i + 1) % around * about + (j + 1) % about
            triangles += [(a, c, b), (b, c, d)]
    return vertices, triangles, None


def write_ply(path, mesh):
    """Writes a binary PLY file with vertices, normals if there are any, and triangles."""
    vertices, triangles, normals = mesh
    names = ('x', 'y', 'z') + (('nx', 'ny', 'nz') if normals else ())
    header = ['ply', 'format binary_little_endian 1.0', 'element vertex %d' % len(vertices),
              *('property float %s' % name for name in names), 'element face %d' % len(triangles),
              'property list uchar int vertex_indices', 'end_header', '']
    with open(path, 'wb') as file:
        file.write('\n'.join(header).encode('ascii'))
        if normals:
            file.write(b''.join(struct.pack('<6f', *v, *n) for v, n in zip(vertices, normals)))
        else:
            file.write(b''.join(struct.pack('<3f', *v) for v in vertices))
        file.write(b''.join(struct.pack('<B3i', 3, *t) for t in triangles))


def read_ply(path):
    """Returns (vertices, triangles, normals or None) from a file of write_ply(), as arrays of numpy, which
    Blender contains."""
    import numpy
    with open(path, 'rb') as file:
        data = file.read()
    end = data.index(b'end_header\n') + len(b'end_header\n')
    words = data[:end].decode('ascii').split()
    vertex_count, face_count = (int(words[words.index(kind) + 1]) for kind in ('vertex', 'face'))
    floats = 6 if 'nx' in words else 3
    vertices = numpy.frombuffer(data, '<f4', vertex_count * floats, end).reshape(-1, floats)
    faces = numpy.frombuffer(data, numpy.dtype([('count', 'u1'), ('index', '<i4', 3)]), face_count,
                             end + 4 * floats * vertex_count)
    return vertices[:, :3], faces['index'], vertices[:, 3:] if floats == 6 else None
