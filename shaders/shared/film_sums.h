// How the film's sums are kept, so that neither the order nor the grouping of what is added changes
// a bit: Demmel and Nguyen 2015, "Parallel Reproducible Summation", IEEE Transactions on Computers
// 64(7), with integers for bins.
//
// The range of single precision has eight digits of 32 bits: digit d counts units of
// 2^(32 d - 127) and is that of values from half a unit on, below half a unit of digit d + 1; digit
// -1 is below them. A sum has two bins, for the highest digit of any value so far and for the one
// below. A value is rounded once to the units of each, half away from zero: the higher bin gets the
// value in units of its digit, the lower one the rest in its own. When a value of a higher digit
// comes, bins whose digits are left below are emptied. A value rounds to 0 in units of digits above
// its own, so that what bins hold in the end depends on all values and their highest digit alone.
//
// A bin is a signed number of 64 bits, and values bring at most 2^31 in either: 2^31 of them, half
// of all that a pixel's counter can count, fit whatever they are. Rounding takes from no value more
// than half a unit of the lower digit, which is 2^-32 of the greatest value at most.
#ifndef LAMPYRIS_SHARED_FILM_SUMS_H
#define LAMPYRIS_SHARED_FILM_SUMS_H

#define FILM_LEAST_EXPONENT (-127) // 2^it is the unit of digit 0
// Digits of the values of one to four sums: a word with seven bits a sum, bit d - 1 for digit d.
// Digits 0 and -1 need none, being what sums begin with.
#define FILM_DIGIT_BITS 7u
#define FILM_DIGITS_MASK 127u
// The digits' word of a film that keeps floats (ACCUMULATION_SUM, ACCUMULATION_RUNNING): in the
// first words of sums.
#define FILM_HAS_FLOATS 0x80000000u

#endif
