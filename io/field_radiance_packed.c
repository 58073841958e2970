/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "io/field_radiance_internal.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

static bool read_at(int fd, uint8_t *bytes, size_t size, uint64_t at)
{
    for (size_t done = 0; done < size;) {
        const ssize_t n = pread(fd, bytes + done, size - done, (off_t)(at + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        done += (size_t)n;
    }
    return true;
}

static bool lead_is_right(int fd, const ncr_radiance_layout *l, const ncr_line_place *p)
{
    uint8_t expected[NCR_CHUNK_HEAD], found[NCR_CHUNK_HEAD];
    ncr_radiance_chunk_lead(l, p->column, p->row, expected);
    return read_at(fd, found, sizeof found, ncr_radiance_chunk_at(l, p->column, p->row)) &&
           !memcmp(expected, found, sizeof found);
}

/* The tile's part of a chunk's line, plane by plane. */
static uint8_t *pick(const ncr_radiance_layout *l, const uint8_t *line, uint32_t x, uint32_t width,
                     uint8_t *out)
{
    const size_t value = l->half ? 2 : 4;
    for (size_t c = 0; c < 3; c++, out += width * value)
        memcpy(out, line + (c * l->tile_width + x) * value, width * value);
    if (!l->depth)
        return out;
    memcpy(out, line + 3 * l->tile_width * value + x * sizeof(float), width * sizeof(float));
    return out + width * sizeof(float);
}

/* Lines of a chunk follow one another: as many as fit are read at once, whole. */
size_t ncr_radiance_read_packed(int fd, const ncr_radiance_layout *l, const ncr_tile *tile,
                                uint8_t *packed)
{
    uint8_t lines[NCR_PACKED_MAX];
    const size_t room = NCR_PACKED_MAX / l->line_bytes;
    size_t bytes = 0;
    for (uint32_t j = 0; j < tile->height;) {
        const ncr_line_place p = ncr_radiance_place(l, tile, j);
        const uint32_t in_chunk = l->tile_height - p.line, left = tile->height - j;
        size_t count = in_chunk < left ? in_chunk : left;
        count = count < room ? count : room;
        const uint64_t at = ncr_radiance_chunk_at(l, p.column, p.row) + NCR_CHUNK_HEAD;
        if ((p.x == 0 && p.line == 0 && !lead_is_right(fd, l, &p)) ||
            !read_at(fd, lines, count * l->line_bytes, at + p.line * l->line_bytes))
            return 0;
        for (size_t k = 0; k < count; k++)
            packed = pick(l, lines + k * l->line_bytes, p.x, tile->width, packed);
        bytes += count * l->line_bytes;
        j += (uint32_t)count;
    }
    return bytes;
}

/* A row of one colour. */
static void unpack_color(bool half, uint32_t width, const uint8_t *in, float *out)
{
    uint16_t halves[NCR_TILE_SIDE];
    if (half) {
        memcpy(halves, in, width * sizeof *halves);
        ncr_half_to_floats(width, halves, out);
    } else {
        memcpy(out, in, width * sizeof *out);
    }
}

bool ncr_radiance_unpack(const ncr_radiance_layout *l, float scale, const uint8_t *line,
                         size_t line_width, uint32_t x, uint32_t width, float *rgb, float *z)
{
    const size_t value = l->half ? 2 : 4, plane = line_width * value;
    float color[3][NCR_TILE_SIDE]; /* B, G, R */
    unsigned bad_values = 0;
    for (size_t c = 0; c < 3; c++)
        unpack_color(l->half, width, line + c * plane + x * value, color[c]);
    for (uint32_t k = 0; k < width; k++) {
        for (uint32_t c = 0; c < 3; c++) {
            const float v = color[2 - c][k] * scale;
            bad_values += !(v >= 0 && v < INFINITY);
            rgb[3 * k + c] = v;
        }
    }
    if (l->depth) {
        memcpy(z, line + 3 * plane + x * sizeof(float), width * sizeof(float));
        for (uint32_t k = 0; k < width; k++)
            bad_values += !(z[k] >= 0);
    }
    return bad_values == 0;
}
