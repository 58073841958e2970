/* SPDX-License-Identifier: MIT
 * cmgen takes panoramas with y up and +Z in the middle, mirrors them as OpenGL's cube maps want, and
 * blurs by perceptual roughness, whose square is alpha. All of that was seen on the orientation chart. */
/* mkdtemp and getrusage are X/Open's. */
#define _XOPEN_SOURCE 700
#include "apps/bench_cmgen.h"

#include "io/map_file.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { not_found = 127 };
static const char *const sides[] = {"px", "nx", "py", "ny", "pz", "nz"};

/* Processor time of programs that have ended. */
static double children_seconds(void)
{
    struct rusage u;
    getrusage(RUSAGE_CHILDREN, &u);
    return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void become(const char *size, const char *folder, const char *blur, const char *map)
{
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execlp("cmgen", "cmgen", "-q", "--format=exr", size, folder, blur, map, (char *)NULL);
    _exit(not_found);
}

/* Its exit code, and the time it took. `alpha` below 0: no blur. */
static int run(const bench_cmgen *c, double alpha, uint32_t size, double *seconds)
{
    char face[32], folder[sizeof c->folder + 16], blur[64], map[sizeof c->folder + 16];
    int how = 0;
    snprintf(face, sizeof face, "--size=%u", size);
    snprintf(folder, sizeof folder, "--extract=%s", c->folder);
    snprintf(blur, sizeof blur, "--extract-blur=%.9g", sqrt(fmax(alpha, 0)));
    snprintf(map, sizeof map, "%s/sky.exr", c->folder);
    const double before = children_seconds();
    const pid_t child = fork();
    if (child == 0)
        become(face, folder, alpha < 0 ? "-q" : blur, map);
    if (child < 0 || waitpid(child, &how, 0) != child)
        return not_found;
    *seconds = children_seconds() - before;
    return WIFEXITED(how) ? WEXITSTATUS(how) : 1;
}

ncr_status bench_cmgen_start(const ncr_ctx *ctx, const ncr_directional_map *map, bench_cmgen *out)
{
    const char *base = getenv("TMPDIR");
    const ncr_map_file_opts how = {
        .struct_size = sizeof how,
        .as = {ncr_convention_find("usd", NCR_MAP_LATLONG), ncr_world_y_up()}};
    char path[sizeof out->folder + 16];
    *out = (bench_cmgen){0};
    snprintf(out->folder, sizeof out->folder, "%s/nacre-bench-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(out->folder))
        return ncr_fail(ctx, NCR_E_IO, "%s: no folder for the peer's files", out->folder);
    out->ctx = ctx;
    snprintf(path, sizeof path, "%s/sky.exr", out->folder);
    ncr_status status = ncr_map_file_write(ctx, path, map, &how);
    const int code = status == NCR_OK ? run(out, -1, 128, &out->plain_seconds) : 0;
    if (status != NCR_OK || code != 0)
        bench_cmgen_stop(out);
    return code && code != not_found ? ncr_fail(ctx, NCR_E_BACKEND, "cmgen ends with %d", code)
                                     : status;
}

void bench_cmgen_stop(bench_cmgen *c)
{
    char path[sizeof c->folder + 16];
    if (!c->ctx)
        return;
    for (int k = 0; k < 6; k++) {
        snprintf(path, sizeof path, "%s/sky/%s.exr", c->folder, sides[k]);
        remove(path);
    }
    snprintf(path, sizeof path, "%s/sky", c->folder);
    remove(path);
    snprintf(path, sizeof path, "%s/sky.exr", c->folder);
    remove(path);
    remove(c->folder);
    c->ctx = NULL;
}

ncr_status bench_cmgen_filter(const bench_cmgen *c, double alpha, uint32_t size,
                              ncr_directional_map *out, double *seconds)
{
    const ncr_map_stated as = {ncr_convention_find("sixfiles", NCR_MAP_CUBE), ncr_world_y_up()};
    char path[sizeof c->folder + 16];
    const int code = run(c, alpha, size, seconds);
    if (code != 0)
        return ncr_fail(c->ctx, NCR_E_BACKEND, "cmgen ends with %d", code);
    *seconds -= c->plain_seconds;
    snprintf(path, sizeof path, "%s/sky/%%.exr", c->folder);
    return ncr_map_file_read(c->ctx, path, as, out, NULL);
}
