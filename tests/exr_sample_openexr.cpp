/* SPDX-License-Identifier: MIT */
#include "exr_sample_openexr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>

#include <cstdint>
#include <cstring>
#include <exception>
#include <half.h>
#include <vector>

namespace
{

struct planes {
    std::vector<std::vector<char>> bytes;
    Imf::FrameBuffer frame;
};

size_t size_of(int type)
{
    return type == EXR_SAMPLE_HALF ? 2 : 4;
}

void store(int type, float x, char *out)
{
    const uint32_t whole = type == EXR_SAMPLE_UINT ? static_cast<uint32_t>(x) : 0;
    const half h(x);
    const uint16_t bits = h.bits();
    if (type == EXR_SAMPLE_UINT)
        std::memcpy(out, &whole, 4);
    else if (type == EXR_SAMPLE_HALF)
        std::memcpy(out, &bits, 2);
    else
        std::memcpy(out, &x, 4);
}

void fill(const exr_sample &s, planes &p)
{
    const size_t count = std::strlen(s.channels), size = size_of(s.type);
    const size_t pixels = static_cast<size_t>(s.width) * static_cast<size_t>(s.height);
    const auto type = static_cast<Imf::PixelType>(s.type);
    for (size_t c = 0; c < count; c++) {
        p.bytes.emplace_back(pixels * size);
        for (size_t k = 0; k < pixels; k++)
            store(s.type, s.data[k * count + c], &p.bytes[c][k * size]);
    }
    for (size_t c = 0; c < count; c++) {
        const auto row = static_cast<ptrdiff_t>(size) * s.width;
        char *base = p.bytes[c].data() - s.min_x * static_cast<ptrdiff_t>(size) - s.min_y * row;
        const char name[] = {s.channels[c], 0};
        p.frame.insert(name, Imf::Slice(type, base, size, static_cast<size_t>(row)));
    }
}

void write(const char *path, const exr_sample &s)
{
    const Imath::Box2i window(Imath::V2i(s.min_x, s.min_y),
                              Imath::V2i(s.min_x + s.width - 1, s.min_y + s.height - 1));
    Imf::Header header(window, window, 1, Imath::V2f(0, 0), 1,
                       s.decreasing ? Imf::DECREASING_Y : Imf::INCREASING_Y,
                       static_cast<Imf::Compression>(s.compression));
    for (const char *c = s.channels; *c; c++) {
        const char name[] = {*c, 0};
        header.channels().insert(name, Imf::Channel(static_cast<Imf::PixelType>(s.type)));
    }
    if (const float *c = s.primaries)
        Imf::addChromaticities(
            header, Imf::Chromaticities({c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}));
    planes p;
    fill(s, p);
    if (!s.tile) {
        Imf::OutputFile file(path, header);
        file.setFrameBuffer(p.frame);
        file.writePixels(s.height);
        return;
    }
    const auto side = static_cast<unsigned>(s.tile);
    header.setTileDescription(
        Imf::TileDescription(side, side, s.mip ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL));
    Imf::TiledOutputFile file(path, header);
    file.setFrameBuffer(p.frame);
    for (int level = 0; level < file.numLevels(); level++)
        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
}

} // namespace

int exr_sample_write(const char *path, const exr_sample *sample)
{
    try {
        write(path, *sample);
        return 0;
    } catch (const std::exception &) {
        return -1;
    }
}

int exr_sample_read_rgb(const char *path, int width, int height, float *rgb)
{
    try {
        Imf::InputFile file(path);
        const auto window = file.header().dataWindow();
        if (window.max.x - window.min.x + 1 != width || window.max.y - window.min.y + 1 != height)
            return -1;
        Imf::FrameBuffer frame;
        const size_t pixel = 3 * sizeof(float);
        const char *const names[] = {"R", "G", "B"};
        for (int c = 0; c < 3; c++)
            frame.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(rgb + c), pixel,
                                              pixel * static_cast<size_t>(width)));
        file.setFrameBuffer(frame);
        file.readPixels(window.min.y, window.max.y);
        return 0;
    } catch (const std::exception &) {
        return -1;
    }
}
