/* SPDX-License-Identifier: MIT */
#include "core/cxx_guard.hpp"

extern "C" {
#include "io/image_format_internal.h"
}

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <exception>

/* The library adds x and y of the data window to the base, so the base is moved back. */
static void aim(Imf::InputPart &input, const char *const *name, const ncr_image *strip, int x,
                int y)
{
    const size_t pixel = strip->channels * sizeof(float), row = pixel * strip->width;
    Imf::FrameBuffer frame;
    for (uint32_t k = 0; k < strip->channels; k++) {
        char *base = reinterpret_cast<char *>(strip->data + k) - x * static_cast<ptrdiff_t>(pixel) -
                     y * static_cast<ptrdiff_t>(row);
        frame.insert(name[k], Imf::Slice(Imf::FLOAT, base, pixel, row));
    }
    input.setFrameBuffer(frame);
}

static ncr_status read_part(const char *path, int part, const char *const *name,
                            const ncr_image *strip, ncr_exr_strip_fn *take, void *user)
{
    Imf::MultiPartInputFile file(path);
    Imf::InputPart input(file, part);
    const auto window = input.header().dataWindow();
    const int height = window.max.y - window.min.y + 1, step = static_cast<int>(strip->height);
    ncr_status status = NCR_OK;
    for (int y = 0; y < height && status == NCR_OK; y += step) {
        const int count = height - y < step ? height - y : step;
        aim(input, name, strip, window.min.x, window.min.y + y);
        input.readPixels(window.min.y + y, window.min.y + y + count - 1);
        status = take(user, static_cast<uint32_t>(y), static_cast<uint32_t>(count));
    }
    return status;
}

extern "C" ncr_status ncr_exr_dwa_read(const ncr_ctx *ctx, const char *path, int part,
                                       const char *const *name, const ncr_image *strip,
                                       ncr_exr_strip_fn *take, void *user)
{
    return ncr_guard([&] {
        try {
            return read_part(path, part, name, strip, take, user);
        } catch (const std::bad_alloc &) {
            throw;
        } catch (const std::exception &e) {
            return ncr_fail(ctx, NCR_E_FORMAT, "%s: %s", path, e.what());
        }
    });
}
