"""Estimates from pictures: errors without the reference's own noise, means, and ratios with their intervals.

A picture is (width, height, three planes), as exr.read() returns it.
"""
import math

EPSILON = 0.01  # the epsilon of relMSE, see docs/comparing.md
WORST = 0.01  # the share of pixels that the trimmed error leaves out
TILES = 4  # at least this many tiles per side, each of at most 16 x 16 pixels

# The 97.5 % quantiles of Student's t for 1 to 30 degrees of freedom.
T_975 = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
         2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042)


def t_975(degrees):
    """Returns the quantile for a number of degrees of freedom, which is rounded down, so that intervals
    become wider."""
    return T_975[max(1, min(len(T_975), int(degrees))) - 1]


def _values(picture):
    return [value for plane in picture[2] for value in plane]


def _same_size(*pictures):
    if len({picture[:2] for picture in pictures}) != 1:
        raise ValueError('pictures differ in size: %s' % ', '.join('%d x %d' % p[:2] for p in pictures))


def errors(picture, references):
    """Returns relMSE with two independent references, and relMSE without the 1 % of pixels with the largest terms.

    The noise of both references averages out of (x - a)(x - b). The trimmed value is not the error that time to error
    is about, but unlike relMSE it is known after a few turns where rare bright paths have most of the error.
    """
    _same_size(picture, *references)
    a, b = references
    terms = [(x - p) * (x - q) / (.25 * (p + q)**2 + EPSILON)
             for x, p, q in zip(_values(picture), _values(a), _values(b))]
    pixels = len(terms) // 3
    sums = sorted(terms[i] + terms[i + pixels] + terms[i + 2 * pixels] for i in range(pixels))
    kept = sums[:pixels - int(WORST * pixels)]
    return math.fsum(sums) / (3 * pixels), math.fsum(kept) / (3 * len(kept))


def error(picture, references):
    """Returns relMSE with two independent references."""
    return errors(picture, references)[0]


def difference(ours, theirs):
    """Returns relMSE between the means of two renderers, without the noise of their pairs of references."""
    _same_size(*ours, *theirs)
    terms = ((a - c) * (b - d) / (.0625 * (a + b + c + d)**2 + EPSILON)
             for a, b, c, d in zip(*map(_values, (*ours, *theirs))))
    return math.fsum(terms) / (3 * len(ours[0][2][0]))


def mean(references):
    """Returns the mean radiance and its standard error, from the differences of tiles, which are
    independent."""
    _same_size(*references)
    (width, height, a), (_, _, b) = references
    tiles, side = {}, min(16, width // TILES)
    for p, q in zip(a, b):
        for y in range(height):
            for x in range(0, width, side):
                at = slice(y * width + x, y * width + min(x + side, width))
                key = y // side, x
                tiles[key] = tiles.get(key, 0) + sum(p[at]) - sum(q[at])
    count = 3 * width * height
    total = math.fsum(_values(references[0])) + math.fsum(_values(references[1]))
    return total / (2 * count), math.sqrt(math.fsum(d * d for d in tiles.values())) / (2 * count)


def ratio_of_means(ours, theirs):
    """Returns (ratio, low, high) of the mean radiances of two renderers; the interval is normal, with 95
    %."""
    (a, sa), (b, sb) = mean(ours), mean(theirs)
    half = 1.96 * a / b * math.hypot(sa / a, sb / b)
    return a / b, a / b - half, a / b + half


class Logarithm:
    """The estimated logarithm of a ratio, with its standard error and degrees of freedom. The value is None
    if a mean was not above 0, such as a time that is smaller than the noise of short renders."""

    def __init__(self, value, error, degrees):
        self.value, self.error, self.degrees = value, error, degrees

    def interval(self):
        """Returns (ratio, low, high) with 95 %; values that are not known are None: with a single turn there
        is no interval."""
        if self.value is None:
            return None, None, None
        if self.degrees < 1:
            return math.exp(self.value), None, None
        half = t_975(self.degrees) * self.error
        return tuple(math.exp(self.value + d) for d in (0, -half, half))


def ratio(ours, theirs):
    """The ratio of two products of arithmetic means, each over the same turns, with a jackknife over turns.

    ours and theirs are lists of factors, and a factor is a list of its values by turns. The jackknife (Tukey 1958) leaves
    out a turn of all factors at once: what a busy machine did to both in that turn cancels.
    """
    def value(kept):
        result = 0
        for sign, factors in ((1, ours), (-1, theirs)):
            for factor in factors:
                result += sign * math.log(math.fsum(factor[i] for i in kept) / len(kept))
        return result
    turns = len(ours[0])
    if any(math.fsum(factor) - max(0, *factor) <= 0 for factor in ours + theirs if turns > 1) or \
            any(math.fsum(factor) <= 0 for factor in ours + theirs):
        return Logarithm(None, math.inf, 0)
    whole = value(range(turns))
    if turns < 2:
        return Logarithm(whole, math.inf, 0)
    without = [value([i for i in range(turns) if i != j]) for j in range(turns)]
    centre = math.fsum(without) / turns
    variance = (turns - 1) / turns * math.fsum((v - centre)**2 for v in without)
    return Logarithm(whole, math.sqrt(variance), turns - 1)


def geometric_mean(logarithms):
    """Returns the geometric mean of ratios of independent scenes; degrees of freedom by Welch (1947) and
    Satterthwaite (1946)."""
    count = len(logarithms)
    if any(one.value is None for one in logarithms):
        return Logarithm(None, math.inf, 0)
    value = math.fsum(one.value for one in logarithms) / count
    if any(one.degrees < 1 for one in logarithms):
        return Logarithm(value, math.inf, 0)
    variances = [one.error**2 for one in logarithms]
    fourth = math.fsum(v * v / one.degrees for v, one in zip(variances, logarithms))
    degrees = math.fsum(variances)**2 / fourth if fourth else 1
    return Logarithm(value, math.sqrt(math.fsum(variances)) / count, degrees)
