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

static void read_part(const char *path, int part, const char *const *name, const ncr_image *out)
{
    Imf::MultiPartInputFile file(path);
    Imf::InputPart input(file, part);
    const auto window = input.header().dataWindow();
    const size_t pixel = out->channels * sizeof(float), row = pixel * out->width;
    Imf::FrameBuffer frame;
    for (uint32_t k = 0; k < out->channels; k++) {
        /* The library adds x and y of the data window to the base, so the base is moved back. */
        char *first = reinterpret_cast<char *>(out->data + k);
        char *base = first - window.min.x * static_cast<ptrdiff_t>(pixel) -
                     window.min.y * static_cast<ptrdiff_t>(row);
        frame.insert(name[k], Imf::Slice(Imf::FLOAT, base, pixel, row));
    }
    input.setFrameBuffer(frame);
    input.readPixels(window.min.y, window.max.y);
}

extern "C" ncr_status ncr_exr_dwa_read(const ncr_ctx *ctx, const char *path, int part,
                                       const char *const *name, const ncr_image *out)
{
    return ncr_guard([&] {
        try {
            read_part(path, part, name, out);
            return NCR_OK;
        } catch (const std::bad_alloc &) {
            throw;
        } catch (const std::exception &e) {
            return ncr_fail(ctx, NCR_E_FORMAT, "%s: %s", path, e.what());
        }
    });
}
