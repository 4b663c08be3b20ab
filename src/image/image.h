// Images in memory and in files: EXR, PNG, Radiance HDR, JPEG, PFM; WebP and TGA are only read. No
// Vulkan. All functions may be called by any thread, on different arguments at the same time.
#ifndef LAMPYRIS_IMAGE_IMAGE_H
#define LAMPYRIS_IMAGE_IMAGE_H

#include "base/arena.h"
#include "base/err.h"
#include "base/progress.h"
#include "image/tone.h"
#include <stdbool.h>
#include <stdint.h>

// Linear Rec. 709 radiance: interleaved RGB, row 0 at the top.
struct image {
    uint32_t width, height;
    float (*pixels)[3];
};

struct image_attribute { // metadata: EXR string attributes, PNG texts, comments of JPEG and HDR
    const char *key;
    const char *value;
};

enum image_layer_type {
    IMAGE_LAYER_FLOAT, // like the image: halves with half_float
    IMAGE_LAYER_FULL,  // always 32-bit floats, for values that halves cannot distinguish
    IMAGE_LAYER_UINT,  // 32-bit integers
};

// An additional EXR layer. Its channels are "NAME.R", "NAME.G" and "NAME.B", or have other letters.
struct image_layer {
    const char *name;
    const void *values;          // interleaved: floats, or uint32_t
    const char *const *channels; // up to three letters, ended by NULL; NULL: "R", "G", "B"
    enum image_layer_type type;
};

// The whole picture of which an image is a window, and the window's place in it.
struct image_display {
    uint32_t width, height; // width 0: the image is the whole picture
    uint32_t x, y;          // position of the image's upper left pixel
};

struct image_write_params {
    const char *path;          // its extension selects the format: exr, png, jpg, jpeg, hdr or pfm
    const struct image *image; // EXR: pixels may be NULL; the file then has only layers
    const struct image_layer *layers; // EXR only
    uint32_t layer_count;
    const struct image_attribute *attributes;
    uint32_t attribute_count;
    struct image_display display; // EXR: becomes the display window, the image the data window
    bool half_float;      // EXR: 16-bit channels; finite values past 65504 saturate, with a warning
    bool uncompressed;    // EXR: not compressed, so that no compressor can fail
    bool unfiltered;      // PNG: rows are not predicted from neighbours, because prediction makes
                          // noise larger
    unsigned png_bits;    // bits of a value: 8 (also for 0) or 16
    float exposure_stops; // PNG, JPEG: multiplies by 2^stops before the curve
    enum tone_curve tone; // PNG, JPEG
};

// Returns whether image_write() supports the path's extension. If not, fails with ERR_USAGE, naming
// the supported extensions.
bool image_check_format(const char *path, struct err *err);
// Returns whether the format of that name stores tone-mapped codes, as PNG and JPEG do.
bool image_is_tone_mapped(const char *path);
// Returns the uncompressed size in bytes of a pixel, without layers, in a file of this format.
uint64_t image_pixel_bytes(const struct image_write_params *params);
// Writes the file atomically (base/file.h). Fails with ERR_OUTPUT; an older file then stays intact.
// The file is encoded in memory first, decoded again and compared bit for bit with the data that
// were encoded: pixels (for PNG and HDR, their codes), layers and metadata. The pixels of a JPEG
// are compared within the greatest error that its quantisation allows. PFM has no metadata. Values
// that HDR cannot hold are changed, with a warning.
bool image_write(const struct image_write_params *params, struct err *err);
// Encodes the image into `arena` without writing a file. Only the extension of the path is used.
bool image_encode(const struct image_write_params *params, struct arena *arena, uint8_t **data,
                  size_t *size, struct err *err);
// Encodes 8-bit RGB codes, without changing them, as a PNG file in `arena`, and verifies it as
// image_write() does. Rows are filtered or unfiltered, whichever takes fewer bytes.
bool image_encode_codes(const uint8_t *codes, uint32_t width, uint32_t height, struct arena *arena,
                        uint8_t **data, size_t *size, struct err *err);

// For tests: flips one bit of the n-th byte of each image between encoding and verification, in the
// whole program. 0 turns it off.
void image_corrupt_at(uint64_t n);

struct image_read_params {
    const char *path; // .exr, .hdr, .pfm, .png, .jpg, .webp or .tga; the last four are converted
                      // from sRGB to linear
    // EXR: the layer to read, with channels R, G, B, or X, Y, Z, or Y, or a single channel by its
    // full name ("depth.Z"); NULL: the channels without a layer.
    const char *layer;
    uint32_t side_max;               // maximum length of the longest side, in pixels; 0: no limit
    bool is_linear;                  // colours are linear even where files are sRGB-encoded
    const struct progress *progress; // asked from time to time whether to stop; any thread may call
                                     // it
};

// Reads an image into `arena`. The memory budget is checked for the pixels, and for what the
// decoder needs, as soon as the header is read. The file's first bytes determine the format, not
// its name; only TGA, which has no signature, also needs the extension .tga. EXR: single-part files
// with scanlines or tiles (the finest level); deep and multi-part files are ERR_INPUT. The image is
// the data window, wherever the display window is. Non-finite and negative values are kept. Alpha
// and PNG colour profiles other than sRGB are ignored.
bool image_read(const struct image_read_params *params, struct arena *arena, struct image *out,
                struct err *err);
// Reads an image from memory, such as one inside another file. params->path names it in messages.
bool image_decode(const void *data, size_t size, const struct image_read_params *params,
                  struct arena *arena, struct image *out, struct err *err);
// Returns whether image_read() reads files with the extension of this path.
bool image_has_known_name(const char *path);
// Returns whether this build reads WebP. It needs libwebp.
bool image_reads_webp(void);

// Interleaved RGBA, row 0 at the top: four 8-bit codes per texel, or four linear floats.
struct image_texels {
    uint32_t width, height;
    void *texels;
    float (*values)[4]; // the linear value of each of the 256 codes in each channel; NULL: floats
    bool is_srgb;       // the codes of colours are sRGB-encoded
};

// Decodes an image with its alpha. Images with at most 8 bits per component (PNG, JPEG, WebP, TGA)
// keep their 8-bit codes, whose values are rounded to halves: steps in [0, 1] are at most 2^-11, an
// eighth of the step of the codes. All others are decoded to floats. Alpha is 1 if a file has none,
// and is never sRGB-encoded. EXR stores colours multiplied by alpha (OpenEXR technical
// introduction, "Alpha"), so decoding divides them by alpha, unless alpha is 0.
bool image_decode_texels(const void *data, size_t size, const struct image_read_params *params,
                         struct arena *arena, struct image_texels *out, struct err *err);
// Allocates the values of codes in `arena`, as struct image_texels has them.
bool image_code_values(bool is_srgb, struct arena *arena, float (**out)[4], struct err *err);
// Returns whether image_read_params.is_linear applies to this file: its colours are sRGB-encoded
// unless the caller knows better. True for PNG, JPEG, WebP and TGA.
bool image_has_encoding(const void *data, size_t size, const char *path);

// Reads the string attributes of an EXR, or the tEXt, zTXt and iTXt chunks that precede the pixels
// of a PNG. *out is allocated in the arena.
bool image_read_attributes(const char *path, struct arena *arena, struct image_attribute **out,
                           uint32_t *count, struct err *err);
// Reads the attributes from the bytes of a file. `path` names the file in messages.
bool image_decode_attributes(const void *data, size_t size, const char *path, struct arena *arena,
                             struct image_attribute **out, uint32_t *count, struct err *err);

#define HALF_MAX 65504.0f // (2 - 2^-10) 2^15, the greatest finite half

// Converts to IEEE 754 binary16, rounded to nearest, ties to even. Finite values above HALF_MAX
// saturate; infinities and NaN are kept.
uint16_t half_from_float(float value);
float float_from_half(uint16_t half); // exact

// Converts a pixel from linear radiance to display values in [0, 1], sRGB-encoded, before rounding
// to 8 bits.
void image_tone_map(enum tone_curve tone, float exposure_stops, const float rgb[3], float out[3]);

// Returns an exposure for an image, in stops, metered for the highlights. Let L be the luminance
// (ITU-R BT.709) that is exceeded by only a twentieth of the pixels with light. The exposure is
// log2(0.5 / L), so that the brightest large region is displayed one stop below 1, which leaves
// room for highlights; visible lamps and fireflies have no influence. (dcraw's automatic brightness
// does the same with one hundredth of the pixels and the white of the file.) Metering for a mean
// would make both a white and a black object grey. L is rounded up to 1/64 stop. Returns 0 for an
// image without light.
float image_measure_exposure(const struct image *image);

// The transfer function of sRGB and its inverse (IEC 61966-2-1), for values in [0, 1].
float image_srgb_from_linear(float linear);
float image_srgb_to_linear(float encoded);
// Converts a value in [0, 1] to the nearest 8-bit code, rounding halves up.
uint8_t image_quantize(float display);

#endif
