// Defines the representation of the film's sums. Neither the order nor the grouping of additions
// changes a bit of them: Demmel and Nguyen 2015, "Parallel Reproducible Summation", IEEE
// Transactions on Computers 64(7), with integers as bins.
//
// The range of single precision is divided into eight digits of 32 bits. The unit of digit d is
// 2^(32 d - 127). A value has digit d if it is at least half a unit of digit d and less than half a
// unit of digit d + 1; smaller values have digit -1. A sum has two bins: one for the highest digit
// of any value so far, and one for the digit below. A value is rounded once to the unit of each
// bin, half away from zero: the higher bin receives the value in units of its digit, the lower bin
// the remainder in its own units. When a value with a higher digit arrives, bins whose digits have
// become too low are emptied. A value is 0 in units of digits above its own. So the final contents
// of the bins depend only on the values and their highest digit.
//
// A bin is a signed integer of 64 bits, to which a value adds at most 2^31. So 2^31 values, half of
// what a pixel's sample counter can count, never overflow. Rounding changes a value by at most half
// a unit of the lower digit, which is at most 2^-32 of the greatest value.
#ifndef LAMPYRIS_SHARED_FILM_SUMS_H
#define LAMPYRIS_SHARED_FILM_SUMS_H

#define FILM_LEAST_EXPONENT (-127) // exponent of the unit of digit 0
// The digits that occurred in the values of one to four sums: a word with seven bits for each sum,
// bit d - 1 for digit d. Digits 0 and -1 need no bits, because they are those of an empty sum.
#define FILM_DIGIT_BITS 7u
#define FILM_DIGITS_MASK 127u
// The digits' word of a film that keeps floats (ACCUMULATION_SUM, ACCUMULATION_RUNNING); the floats
// are in the first words of the sums.
#define FILM_HAS_FLOATS 0x80000000u

#endif
