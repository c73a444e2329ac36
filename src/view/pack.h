/* Numbers, little-endian, deflated and written as base64 to a text file. */
#ifndef SHV_VIEW_PACK_H
#define SHV_VIEW_PACK_H

#include <stdint.h>
#include <stdio.h>
/* zlib then takes its input as constant. */
#define ZLIB_CONST
#include <zlib.h>

#include "base/memory.h"

typedef struct ShvPack {
    FILE *stream;
    z_stream deflate;
    unsigned char out[3 * 4096]; /* deflated; a multiple of three goes out as whole groups of base64 */
    int64_t bytes;               /* put so far */
} ShvPack;

/* SHV_NO_MEMORY; then there is nothing to end. */
ShvStatus shv_pack_begin(ShvPack *pack, FILE *stream, ShvError *error);
void shv_pack_bytes(ShvPack *pack, const void *bytes, size_t count);
void shv_pack_text(ShvPack *pack, const char *text);
void shv_pack_float(ShvPack *pack, double value);  /* 4 bytes */
void shv_pack_double(ShvPack *pack, double value); /* 8 bytes */
void shv_pack_int(ShvPack *pack, int32_t value);
void shv_pack_byte(ShvPack *pack, uint8_t value);
/* Differences of 16-bit numbers to the last ones, which they replace: first all low bytes, then all high bytes. */
void shv_pack_differences(ShvPack *pack, const uint16_t *values, uint16_t *last, size_t count, unsigned char *scratch);
/* Likewise for bytes. */
void shv_pack_byte_differences(ShvPack *pack, const uint8_t *values, uint8_t *last, size_t count,
                               unsigned char *scratch);
/* Writes what is left and releases everything. Write errors show on the stream. */
void shv_pack_end(ShvPack *pack);

#endif
