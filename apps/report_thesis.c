/* SPDX-License-Identifier: MIT */
#include "apps/report_thesis.h"

#include <stddef.h>
#include <string.h>

/* Tables 6.1 and 6.2 as printed: L*, a*, b*, R, G, B.                                      [T 6.1] */
static const thesis_row rows[] = {
    {"reconstruction", "oslf", 128, {.005351, .012321, .034318}, {.000590, .000952, .004827}},
    {"reconstruction", "oslf", 256, {.004679, .007938, .021619}, {.000537, .000892, .003098}},
    {"mirror", "envmap", 128, {.198457, .267233, .301128}, {.074420, .039586, .036783}},
    {"mirror", "envmap", 256, {.204308, .268992, .301899}, {.074699, .041149, .037367}},
    {"mirror", "distance", 128, {.136457, .248841, .294089}, {.072282, .023559, .031592}},
    {"mirror", "distance", 256, {.123106, .245717, .292770}, {.071869, .019287, .030598}},
    {"mirror", "angle", 128, {.138536, .249629, .294369}, {.072318, .024135, .031722}},
    {"mirror", "angle", 256, {.125873, .246529, .293082}, {.071922, .020223, .030760}},
    {"mirror", "average", 128, {.137826, .249274, .294176}, {.072320, .023969, .031726}},
    {"mirror", "average", 256, {.124964, .246195, .292920}, {.071915, .019981, .030739}},
    {"mirror", "cosine-r:1", 128, {.137538, .249262, .294211}, {.072296, .023922, .031665}},
    {"mirror", "cosine-r:4", 128, {.137685, .249351, .294255}, {.072292, .023942, .031650}},
    {"mirror", "cosine-r:4", 256, {.125065, .246274, .292982}, {.071902, .020026, .030705}},
    {"mirror", "cosine-r:8", 128, {.137939, .249434, .294283}, {.072295, .023991, .031662}},
    {"mirror", "cosine-r:16", 128, {.138215, .249515, .294307}, {.072301, .024058, .031681}},
    {"mirror", "cosine-n:1", 128, {.137068, .248988, .294078}, {.072287, .023745, .031642}},
    {"mirror", "cosine-n:4", 128, {.136870, .248949, .294102}, {.072283, .023725, .031616}},
    {"mirror", "cosine-n:4", 256, {.124759, .246009, .292878}, {.071914, .019957, .030716}},
    {"mirror", "cosine-n:8", 128, {.136788, .248932, .294104}, {.072283, .023730, .031609}},
    {"mirror", "cosine-n:16", 128, {.136858, .248949, .294114}, {.072286, .023778, .031617}},
};

const thesis_row *thesis_find(const char *experiment, const char *method, uint32_t cube)
{
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        if (rows[k].cube == cube && !strcmp(rows[k].experiment, experiment) &&
            !strcmp(rows[k].method, method))
            return &rows[k];
    return NULL;
}

double thesis_ratio(const char *method, uint32_t cube)
{
    const thesis_row *row = thesis_find("mirror", method, cube);
    const thesis_row *envmap = thesis_find("mirror", "envmap", cube);
    return row && envmap ? row->lab[0] / envmap->lab[0] : 0.0;
}
