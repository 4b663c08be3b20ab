#include "base/printable.h"

#include <stdint.h>
#include <string.h>

// The characters that are masked. They have the property Default_Ignorable_Code_Point of the
// Unicode Character Database (DerivedCoreProperties.txt, version 15.0), which includes Bidi_Control
// (PropList.txt), or one of these general categories: Cc (C0, DEL and C1), Zl and Zp (U+2028,
// U+2029), or Cf for annotation marks (U+FFF9 to U+FFFB).
static const struct {
    uint32_t first, last;
} masked[] = {
    {0x0000, 0x001f}, {0x007f, 0x009f},   {0x00ad, 0x00ad},   {0x034f, 0x034f},   {0x061c, 0x061c},
    {0x115f, 0x1160}, {0x17b4, 0x17b5},   {0x180b, 0x180f},   {0x200b, 0x200f},   {0x2028, 0x202e},
    {0x2060, 0x206f}, {0x3164, 0x3164},   {0xfe00, 0xfe0f},   {0xfeff, 0xfeff},   {0xffa0, 0xffa0},
    {0xfff0, 0xfffb}, {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff},
};

static bool is_masked(uint32_t code)
{
    for (size_t i = 0; i < sizeof masked / sizeof masked[0] && code >= masked[i].first; i++)
        if (code <= masked[i].last)
            return true;
    return false;
}

// Returns the length of the character that begins here; 0 for invalid UTF-8 (RFC 3629, section 4):
// unexpected continuation bytes, too few of them, overlong forms, surrogates and numbers above
// U+10FFFF.
static size_t decode(const unsigned char *text, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    unsigned char lead = text[0];
    size_t length = lead < 0x80             ? 1
                    : (lead & 0xe0) == 0xc0 ? 2
                    : (lead & 0xf0) == 0xe0 ? 3
                    : (lead & 0xf8) == 0xf0 ? 4
                                            : 0;
    if (length <= 1) {
        *code = lead;
        return length;
    }
    *code = lead & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((text[i] & 0xc0) != 0x80) // the terminating NUL byte is not a continuation byte either
            return 0;
        *code = *code << 6 | (text[i] & 0x3fu);
    }
    bool is_surrogate = *code >= 0xd800 && *code <= 0xdfff;
    return *code < least[length] || is_surrogate || *code > 0x10ffff ? 0 : length;
}

size_t printable_character(const char *text, bool *stays)
{
    uint32_t code = 0;
    size_t length = decode((const unsigned char *)text, &code);
    *stays = length > 0 && !is_masked(code);
    return length > 0 ? length : 1;
}

void printable_mask(char *text)
{
    char *to = text;
    while (*text) {
        bool stays;
        size_t length = printable_character(text, &stays);
        if (stays)
            memmove(to, text, length);
        else
            *to = '?';
        to += stays ? length : 1;
        text += length;
    }
    *to = '\0';
}

// Copies a text; returns the end of the copy.
static char *put(char *out, const char *text)
{
    size_t length = strlen(text);
    memcpy(out, text, length + 1);
    return out + length;
}

char *printable_quote(const char *word, char *out)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_@%+=:,./-";
    bool is_plain = *word && word[strspn(word, plain)] == '\0';
    if (is_plain)
        return put(out, word);
    *out++ = '\'';
    for (; *word; word++) {
        if (*word == '\'')
            out = put(out, "'\\'"); // closes the quote, adds an escaped one, and the next quote
                                    // opens again
        *out++ = *word;
    }
    return put(out, "'");
}
