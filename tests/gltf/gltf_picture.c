#include "gltf_picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint8_t *put_big_endian(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        *at++ = (uint8_t)(value >> (24 - 8 * i));
    return at;
}

// The CRC of PNG (specification, annex D): polynomial 0xedb88320, reflected.
static uint32_t crc(const uint8_t *data, size_t size)
{
    uint32_t sum = UINT32_MAX;
    for (size_t i = 0; i < size; i++) {
        sum ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
    }
    return ~sum;
}

static uint8_t *put_chunk(uint8_t *at, const char type[4], const uint8_t *data, size_t size)
{
    uint8_t *begin = put_big_endian(at, (uint32_t)size);
    memcpy(begin, type, 4);
    memcpy(begin + 4, data, size);
    return put_big_endian(begin + 4 + size, crc(begin, 4 + size));
}

// Writes a zlib stream (RFC 1950) with one stored block (RFC 1951, section 3.2.4).
static size_t store(const uint8_t *data, uint16_t size, uint8_t *out)
{
    const uint8_t head[] = {
        0x78, 0x01, 1, (uint8_t)size, (uint8_t)(size >> 8), (uint8_t)~size, (uint8_t)(~size >> 8)};
    uint32_t a = 1, b = 0;
    memcpy(out, head, sizeof head);
    memcpy(out + sizeof head, data, size);
    for (uint16_t i = 0; i < size; i++) {
        a = (a + data[i]) % 65521;
        b = (b + a) % 65521;
    }
    put_big_endian(out + sizeof head + size, b << 16 | a);
    return sizeof head + size + 4;
}

struct bytes png_bytes(uint32_t width, uint32_t height, const uint8_t rgba[4])
{
    static const uint8_t magic[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    uint8_t header[13] = {0}, *end = put_big_endian(put_big_endian(header, width), height);
    end[0] = 8; // bits per component
    end[1] = 6; // colour type RGBA
    size_t raw_size = (size_t)height * (1 + 4 * (size_t)width);
    uint8_t *raw = calloc(raw_size, 1), *packed = malloc(raw_size + 16);
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++)
            memcpy(raw + y * (1 + 4 * (size_t)width) + 1 + 4 * x, rgba, 4);
    size_t packed_size = store(raw, (uint16_t)raw_size, packed);
    struct bytes png = {.data = malloc(packed_size + 64)};
    memcpy(png.data, magic, sizeof magic);
    end = put_chunk(png.data + sizeof magic, "IHDR", header, sizeof header);
    end = put_chunk(end, "IDAT", packed, packed_size);
    end = put_chunk(end, "IEND", header, 0);
    png.size = (size_t)(end - png.data);
    free(raw);
    free(packed);
    return png;
}

char *png_uri(const uint8_t rgba[4], const char *mime_type)
{
    struct bytes png = png_bytes(2, 2, rgba);
    char *octets = data_uri(png.data, png.size), *uri = NULL;
    const char *comma = strchr(octets, ',');
    size_t size = strlen(mime_type) + strlen(comma) + sizeof "data:;base64";
    uri = malloc(size);
    snprintf(uri, size, "data:%s;base64%s", mime_type, comma);
    free(octets);
    free(png.data);
    return uri;
}
