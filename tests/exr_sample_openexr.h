/* SPDX-License-Identifier: MIT
 * exr_sample_openexr.h - OpenEXR files of every kind, written by the C++ library. */
#ifndef NCR_TESTS_EXR_SAMPLE_OPENEXR_H
#define NCR_TESTS_EXR_SAMPLE_OPENEXR_H

#ifdef __cplusplus
extern "C" {
#endif

enum { EXR_SAMPLE_UINT, EXR_SAMPLE_HALF, EXR_SAMPLE_FLOAT };

typedef struct exr_sample {
    int width, height, min_x, min_y;
    int compression; /* 0 none, 1 RLE, 2 ZIPS, 3 ZIP, 4 PIZ, 5 PXR24, 6 B44, 7 B44A, 8 DWAA, 9 DWAB */
    int type;
    int tile;               /* side of a tile, 0: scanlines */
    int mip, decreasing;    /* mip levels; line order */
    const float *primaries; /* [8] x, y of red, green, blue, white; NULL: none said */
    const char *channels;   /* one letter each, "RGB" */
    const float *data;      /* [height][width][channels]; whole numbers for EXR_SAMPLE_UINT */
} exr_sample;

/* 0, or -1 when the library threw. */
int exr_sample_write(const char *path, const exr_sample *sample);

/* Read R, G, B as floats; 0 or -1. */
int exr_sample_read_rgb(const char *path, int width, int height, float *rgb);

#ifdef __cplusplus
}
#endif

#endif
