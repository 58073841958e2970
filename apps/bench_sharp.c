/* SPDX-License-Identifier: MIT */
#include "apps/bench_sharp.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

struct bench_sharp {
    bench_sharp_job job;
    pid_t child;
    int to, from;
};

static bool send_all(int to, const void *data, size_t bytes)
{
    for (const char *at = data; bytes;) {
        const ssize_t n = write(to, at, bytes);
        if (n <= 0)
            return false;
        at += n;
        bytes -= (size_t)n;
    }
    return true;
}

static bool receive_all(int from, void *data, size_t bytes)
{
    for (char *at = data; bytes;) {
        const ssize_t n = read(from, at, bytes);
        if (n <= 0)
            return false;
        at += n;
        bytes -= (size_t)n;
    }
    return true;
}

/* The program beside this one. */
static bool find_program(char *path, size_t room)
{
    static const char name[] = "nacre-peer-sharp";
    const ssize_t length = readlink("/proc/self/exe", path, room - sizeof name);
    if (length <= 0)
        return false;
    path[length] = '\0';
    char *slash = strrchr(path, '/');
    if (!slash)
        return false;
    memcpy(slash + 1, name, sizeof name);
    return access(path, X_OK) == 0;
}

static void become(const char *path, int in[2], int out[2])
{
    dup2(in[0], STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    close(in[1]);
    close(out[0]);
    setenv("OMP_NUM_THREADS", "1", 1);
    execl(path, path, (char *)NULL);
    _exit(127);
}

/* Channel by channel, as libsharp likes maps best. */
static bool send_map(int to, const ncr_image *map)
{
    float row[1024];
    const size_t texels = (size_t)map->width * map->height;
    bool sent = true;
    for (uint32_t c = 0; c < 3; c++)
        for (size_t k = 0; sent && k < texels; k += 1024) {
            const size_t count = texels - k < 1024 ? texels - k : 1024;
            for (size_t i = 0; i < count; i++)
                row[i] = map->data[3 * (k + i) + c];
            sent = send_all(to, row, count * sizeof *row);
        }
    return sent;
}

static bool launch(const char *path, bench_sharp *s)
{
    int in[2], out[2];
    if (pipe(in) != 0)
        return false;
    if (pipe(out) != 0) {
        close(in[0]), close(in[1]);
        return false;
    }
    s->child = fork();
    if (s->child == 0)
        become(path, in, out);
    close(in[0]);
    close(out[1]);
    s->to = in[1];
    s->from = out[0];
    return s->child > 0;
}

ncr_status bench_sharp_start(const ncr_ctx *ctx, const ncr_image *map, const double *zonal,
                             const bench_sharp_job *job, bench_sharp **out)
{
    char path[4096];
    *out = NULL;
    if (!find_program(path, sizeof path))
        return NCR_OK;
    bench_sharp *s = ncr_alloc_zero(ctx, 1, sizeof *s);
    if (!s)
        return NCR_E_NOMEM;
    s->job = *job;
    s->to = s->from = -1;
    signal(SIGPIPE, SIG_IGN); /* a peer that dies is told by what it does not answer */
    if (!launch(path, s) || !send_all(s->to, job, sizeof *job) ||
        !send_all(s->to, zonal, (job->band_limit + 1) * sizeof *zonal) || !send_map(s->to, map)) {
        bench_sharp_stop(ctx, s);
        return ncr_fail(ctx, NCR_E_BACKEND, "%s does not run", path);
    }
    *out = s;
    return NCR_OK;
}

void bench_sharp_stop(const ncr_ctx *ctx, bench_sharp *s)
{
    if (!s)
        return;
    if (s->to >= 0)
        close(s->to);
    if (s->from >= 0)
        close(s->from);
    if (s->child > 0)
        waitpid(s->child, NULL, 0);
    ncr_free(ctx, s);
}

double bench_sharp_seconds(void *sharp, unsigned runs)
{
    bench_sharp *s = sharp;
    const uint32_t count = runs;
    double seconds;
    return send_all(s->to, &count, sizeof count) && receive_all(s->from, &seconds, sizeof seconds)
               ? seconds
               : NAN;
}

bool bench_sharp_answer(bench_sharp *s, float *rgb)
{
    const uint32_t none = 0;
    const size_t texels = (size_t)s->job.out_width * s->job.out_height;
    float row[1024];
    bool have = send_all(s->to, &none, sizeof none);
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; have && k < texels; k += 1024) {
            const size_t count = texels - k < 1024 ? texels - k : 1024;
            have = receive_all(s->from, row, count * sizeof *row);
            for (size_t i = 0; have && i < count; i++)
                rgb[3 * (k + i) + c] = row[i];
        }
    return have;
}
