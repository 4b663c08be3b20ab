#include "base/suggest.h"

#include <stdint.h>
#include <string.h>

enum { LONGEST = 63 };

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

size_t suggest_distance(const char *a, const char *b)
{
    size_t rows = strlen(a), columns = strlen(b);
    if (rows > LONGEST || columns > LONGEST)
        return SIZE_MAX;
    size_t d[LONGEST + 1][LONGEST + 1]; // distance of the first i bytes of a and j of b
    for (size_t i = 0; i <= rows; i++)
        d[i][0] = i;
    for (size_t j = 0; j <= columns; j++)
        d[0][j] = j;
    for (size_t i = 1; i <= rows; i++)
        for (size_t j = 1; j <= columns; j++) {
            size_t replace = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            d[i][j] = least(replace, least(d[i - 1][j], d[i][j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = least(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[rows][columns];
}

void suggest_offer(struct suggestion *suggestion, const char *name)
{
    size_t distance = suggest_distance(suggestion->wanted, name);
    size_t letters = strlen(suggestion->wanted);
    size_t most = letters >= 6 ? letters / 3 : 1;
    if (distance > most || (suggestion->nearest && distance >= suggestion->distance))
        return;
    suggestion->nearest = name;
    suggestion->distance = distance;
}
