"""Computes the metrics of the pictures of test_perceptual.c from the papers' formulas, in double precision
and without separable filters, and compares them with the program's output: SSIM, FLIP and HDR-FLIP with each
pixel of their maps, MSE, relMSE, local relMSE, SMAPE, PSNR and the intervals.

    perceptual.py PROGRAM

Exit status: 0 passed, 1 failed.
"""

import math
import subprocess
import sys

WIDTH, HEIGHT = 24, 18
PPD = 0.7 * 3840 / 0.7 * math.pi / 180


def single(x):
    """Rounds a number to single precision."""
    import struct
    return struct.unpack("f", struct.pack("f", x))[0]


def make_pictures():
    reference, image = [], []
    for i in range(WIDTH * HEIGHT):
        x, y = i % WIDTH, i // WIDTH
        square = 12 <= x < 20 and 8 <= y < 16
        reference.append([4.0 if square else 0.015625 * (x + c * y % 7) for c in range(3)])
    seed = 7
    for pixel in reference:
        noisy = []
        for value in pixel:
            seed = (seed * 1664525 + 1013904223) & 0xffffffff
            noisy.append(single(value + 0.25 * (seed >> 8) * 2.0 ** -24))
        image.append(noisy)
    return image, reference


# --- SSIM ----------------------------------------------------------------------------------------

def encode(x):
    x = min(max(x, 0), 1)
    return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055


def luma(pixel):
    return sum(w * encode(v) for w, v in zip((0.2126, 0.7152, 0.0722), pixel))


def window_around(i):
    x, y = i % WIDTH, i // WIDTH
    return [(math.exp(-((u - x) ** 2 + (v - y) ** 2) / 4.5), v * WIDTH + u)
            for v in range(max(y - 5, 0), min(y + 6, HEIGHT))
            for u in range(max(x - 5, 0), min(x + 6, WIDTH))]


def ssim(image, reference):
    a, b = [luma(p) for p in image], [luma(p) for p in reference]
    total = 0
    for i in range(WIDTH * HEIGHT):
        window = window_around(i)
        weight = sum(w for w, _ in window)
        mean_a = sum(w * a[k] for w, k in window) / weight
        mean_b = sum(w * b[k] for w, k in window) / weight
        var_a = sum(w * (a[k] - mean_a) ** 2 for w, k in window) / weight
        var_b = sum(w * (b[k] - mean_b) ** 2 for w, k in window) / weight
        both = sum(w * (a[k] - mean_a) * (b[k] - mean_b) for w, k in window) / weight
        total += ((2 * mean_a * mean_b + 1e-4) * (2 * both + 9e-4) /
                  ((mean_a ** 2 + mean_b ** 2 + 1e-4) * (var_a + var_b + 9e-4)))
    return total / (WIDTH * HEIGHT)


# --- FLIP ----------------------------------------------------------------------------------------

XYZ = [[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
       [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
       [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]]
WHITE = [sum(row) for row in XYZ]


def relative_xyz(rgb):
    return [sum(m * v for m, v in zip(row, rgb)) / white for row, white in zip(XYZ, WHITE)]


def invert(m):
    """Inverts a matrix by the Gauss-Jordan method."""
    n = len(m)
    rows = [list(row) + [float(i == j) for j in range(n)] for i, row in enumerate(m)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [v / rows[i][i] for v in rows[i]]
        for r in range(n):
            if r != i:
                rows[r] = [v - rows[r][i] * p for v, p in zip(rows[r], rows[i])]
    return [row[n:] for row in rows]


RGB = invert([[m / white for m in row] for row, white in zip(XYZ, WHITE)])


def to_opponent(rgb):
    x, y, z = relative_xyz(rgb)
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def from_opponent(c):
    y = (c[0] + 16) / 116
    xyz = [y + c[1] / 500, y, y - c[2] / 200]
    return [min(max(sum(m * v for m, v in zip(row, xyz)), 0), 1) for row in RGB]


def hunt_lab(rgb):
    def f(t):
        return t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    x, y, z = [f(t) for t in relative_xyz(rgb)]
    lightness = 116 * y - 16
    return [lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)]


def hyab(a, b):
    return abs(a[0] - b[0]) + math.hypot(a[1] - b[1], a[2] - b[2])


def normalise(kernel):
    """Scales the positive weights to a sum of 1 and the negative ones to a sum of -1."""
    up = sum(v for row in kernel for v in row if v > 0)
    down = -sum(v for row in kernel for v in row if v < 0)
    return [[v / up if v > 0 else v / down if v < 0 else 0 for v in row] for row in kernel]


def filtered(plane, kernel):
    r = len(kernel) // 2
    flat = [(v - r, u - r, w) for v, row in enumerate(kernel) for u, w in enumerate(row) if w]
    out = []
    for i in range(WIDTH * HEIGHT):
        x, y = i % WIDTH, i // WIDTH
        out.append(sum(w * plane[min(max(y + v, 0), HEIGHT - 1) * WIDTH +
                                 min(max(x + u, 0), WIDTH - 1)] for v, u, w in flat))
    return out


def grid(radius, function):
    return [[function(u, v) for u in range(-radius, radius + 1)]
            for v in range(-radius, radius + 1)]


def sensitivity(parts):
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * PPD)

    def value(u, v):
        d2 = (u * u + v * v) / PPD ** 2
        return sum(a * math.sqrt(math.pi / b) * math.exp(-math.pi ** 2 * d2 / b)
                   for a, b in parts)
    return normalise(grid(radius, value))


SEEN = [sensitivity([(1, 0.0047)]), sensitivity([(1, 0.0053)]),
        sensitivity([(34.1, 0.04), (13.5, 0.025)])]
SIGMA = 0.5 * 0.082 * PPD
EDGE = normalise(grid(math.ceil(3 * SIGMA), lambda u, v: -u * math.exp(
    -(u * u + v * v) / (2 * SIGMA ** 2))))
POINT = normalise(grid(math.ceil(3 * SIGMA), lambda u, v: (u * u / SIGMA ** 2 - 1) * math.exp(
    -(u * u + v * v) / (2 * SIGMA ** 2))))


def analyse(pixels):
    opponent = [to_opponent([min(max(v, 0), 1) for v in p]) for p in pixels]
    lightness = [(c[0] + 16) / 116 for c in opponent]
    features = []
    for kernel in (EDGE, POINT):
        turned = [list(column) for column in zip(*kernel)]
        features.append([math.hypot(a, b) for a, b in
                         zip(filtered(lightness, kernel), filtered(lightness, turned))])
    planes = [filtered([c[k] for c in opponent], SEEN[k]) for k in range(3)]
    return [hunt_lab(from_opponent(c)) for c in zip(*planes)], features


def flip_map(image, reference):
    greatest = hyab(hunt_lab([0, 1, 0]), hunt_lab([0, 0, 1])) ** 0.7
    (lab_a, features_a), (lab_b, features_b) = analyse(image), analyse(reference)
    out = []
    for i in range(WIDTH * HEIGHT):
        color = hyab(lab_a[i], lab_b[i]) ** 0.7
        if color < 0.4 * greatest:
            color *= 0.95 / (0.4 * greatest)
        else:
            color = 0.95 + 0.05 * (color - 0.4 * greatest) / (0.6 * greatest)
        feature = max(abs(features_a[k][i] - features_b[k][i]) for k in range(2))
        out.append(color ** (1 - math.sqrt(feature / math.sqrt(2))))
    return out


def hdr_map(image, reference):
    k = [0.36 * 2.51, 0.6 * 0.03, 0, 0.36 * 2.43, 0.6 * 0.59, 0.14]
    a, b, c = (k[i] - 0.85 * k[i + 3] for i in range(3))
    knee = (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a)  # a > 0 > c: the positive root
    luminance = sorted(sum(m * v for m, v in zip(XYZ[1], p)) for p in reference)
    start = math.log2(knee / luminance[-1])
    stop = math.log2(knee / luminance[(len(luminance) - 1) // 2])
    count = max(2, math.ceil(stop - start))
    greatest = [0.0] * len(image)
    for i in range(count):
        factor = 2 ** (start + (stop - start) * i / (count - 1))

        def tone(v):
            x = v * factor
            return (k[0] * x * x + k[1] * x + k[2]) / (k[3] * x * x + k[4] * x + k[5])
        greatest = [max(m, n) for m, n in zip(greatest, flip_map(
            [[tone(v) for v in p] for p in image], [[tone(v) for v in p] for p in reference]))]
    return greatest


# --- errors --------------------------------------------------------------------------------------

def mean(values):
    values = list(values)
    return math.fsum(values) / len(values)


def squared(x, r):
    return (x - r) ** 2


def relative_squared(x, r):
    return (x - r) ** 2 / (r * r + 0.01)


def local_means(reference):
    out = []
    for i in range(WIDTH * HEIGHT):
        window = window_around(i)
        out.append([sum(w * reference[k][c] for w, k in window) / sum(w for w, _ in window)
                    for c in range(3)])
    return out


def mean_error(image, reference, term):
    return mean(term(x, r) for p, q in zip(image, reference) for x, r in zip(p, q))


def psnr(image, reference, stops):
    return -10 * math.log10(mean_error(
        image, reference, lambda x, r: (encode(x * 2 ** stops) - encode(r * 2 ** stops)) ** 2))


def interval(image, reference, term):
    """The interval from tiles of 4 x 4 pixels: this is the largest power of two below 17 that gives at least
    16 tiles. There are 6 x 5 tiles, those of the last row half as high. The variance is that of the
    linearised ratio; t_.975 with 29 degrees of freedom is from tables."""
    side, tiles = 4, {}
    for i, (p, q) in enumerate(zip(image, reference)):
        tile = tiles.setdefault((i // WIDTH // side, i % WIDTH // side), [])
        tile += [term(x, r) for x, r in zip(p, q)]
    assert len(tiles) == 30
    ratio = sum(map(sum, tiles.values())) / sum(map(len, tiles.values()))
    residuals = [sum(tile) - ratio * len(tile) for tile in tiles.values()]
    size = mean(map(len, tiles.values()))
    variance = sum(v * v for v in residuals) / 29 / size ** 2 / 30
    half = 2.045229642 * math.sqrt(variance)
    return ratio - half, ratio + half


def main():
    printed = subprocess.run([sys.argv[1], "--values"], check=True, stdout=subprocess.PIPE,
                             universal_newlines=True).stdout.split()
    image, reference = make_pictures()
    ldr, hdr = flip_map(image, reference), hdr_map(image, reference)
    values = [("SSIM", ssim(image, reference)), ("FLIP", mean(ldr)), ("HDR-FLIP", mean(hdr)),
              ("MSE", mean_error(image, reference, squared)),
              ("relMSE", mean_error(image, reference, relative_squared)),
              ("SMAPE", mean_error(image, reference, lambda x, r: 2 * abs(x - r) /
                                   (abs(x) + abs(r) + 1e-6))),
              ("PSNR", psnr(image, reference, 0)), ("PSNR at -2.5", psnr(image, reference, -2.5))]
    for name, term in (("MSE", squared), ("relMSE", relative_squared)):
        values += zip((name + " low", name + " high"), interval(image, reference, term))
    # Differences, as images whose reference is 0, with the means to which they are related.
    pairs = [[(x - r, m) for x, r, m in zip(*p)]
             for p in zip(image, reference, local_means(reference))]
    zeros = [[0, 0, 0]] * len(pairs)

    def local(pair, _):
        return pair[0] ** 2 / (pair[1] ** 2 + 0.01)
    values.append(("local relMSE", mean_error(pairs, zeros, local)))
    values += zip(("local relMSE low", "local relMSE high"), interval(pairs, zeros, local))
    told = len(values)
    values += [("FLIP of pixel %d" % i, v) for i, v in enumerate(ldr)]
    values += [("HDR-FLIP of pixel %d" % i, v) for i, v in enumerate(hdr)]
    failed = len(printed) != len(values)
    for i, ((name, here), program) in enumerate(zip(values, map(float, printed))):
        ok = abs(program - here) <= (1e-5 if i < told else 1e-4) * abs(here)
        failed |= not ok
        if i < told or not ok:
            print("%-12s %.9g, here %.9g%s" % (name, program, here, "" if ok else "  FAIL"))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
