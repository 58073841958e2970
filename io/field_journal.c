/* SPDX-License-Identifier: MIT */
#include "io/field_radiance_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { journal_version = 1 };

/* The byte order is read as it was written: a journal of another kind of machine differs here. */
typedef struct journal_lead {
    char magic[8];
    uint32_t version, byte_order;
    uint64_t fingerprint;
} journal_lead;

static journal_lead make_lead(uint64_t fingerprint)
{
    return (journal_lead){.magic = "ncrtiles",
                          .version = journal_version,
                          .byte_order = 0x01020304,
                          .fingerprint = fingerprint};
}

ncr_journal_kind ncr_journal_probe(const char *path, uint64_t fingerprint)
{
    const journal_lead expected = make_lead(fingerprint);
    journal_lead found;
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return NCR_JOURNAL_NONE;
    const bool whole = pread(fd, &found, sizeof found, 0) == (ssize_t)sizeof found;
    close(fd);
    if (!whole)
        return NCR_JOURNAL_NONE; /* cut short before the first tile */
    return memcmp(&found, &expected, sizeof found) ? NCR_JOURNAL_OTHER : NCR_JOURNAL_SAME;
}

static ncr_status fail(const ncr_journal *journal, const char *what)
{
    return ncr_fail(journal->ctx, NCR_E_IO, "%s: cannot be %s: %s", journal->path, what,
                    strerror(errno));
}

static ncr_status write_at(const ncr_journal *journal, const void *bytes, size_t size, uint64_t at)
{
    ssize_t n;
    do
        n = pwrite(journal->fd, bytes, size, (off_t)at);
    while (n < 0 && errno == EINTR);
    if (n >= 0 && (size_t)n < size)
        errno = ENOSPC;
    return n == (ssize_t)size ? NCR_OK : fail(journal, "written");
}

ncr_status ncr_journal_create(const ncr_ctx *ctx, const char *path, uint64_t fingerprint,
                              ncr_journal *out)
{
    const journal_lead lead = make_lead(fingerprint);
    *out = (ncr_journal){.ctx = ctx, .path = path};
    out->fd = open(path, O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC, 0666);
    return out->fd < 0 ? fail(out, "created") : write_at(out, &lead, sizeof lead, 0);
}

/* Places go on after the last record, torn or not. */
ncr_status ncr_journal_reopen(const ncr_ctx *ctx, const char *path, ncr_journal *out)
{
    struct stat info;
    *out = (ncr_journal){.ctx = ctx, .path = path};
    out->fd = open(path, O_RDWR | O_CLOEXEC);
    if (out->fd < 0 || fstat(out->fd, &info) != 0)
        return fail(out, "opened");
    const uint64_t bytes = (uint64_t)info.st_size - sizeof(journal_lead);
    out->next = (bytes + sizeof(ncr_journal_record) - 1) / sizeof(ncr_journal_record);
    return NCR_OK;
}

static uint32_t check_of(const ncr_journal_record *r)
{
    return (uint32_t)crc32(crc32(0, Z_NULL, 0), (const Bytef *)r,
                           offsetof(ncr_journal_record, check));
}

bool ncr_journal_record_is_whole(const ncr_journal_record *record)
{
    return record->check == check_of(record);
}

static uint64_t place_of(uint64_t slot)
{
    return sizeof(journal_lead) + slot * sizeof(ncr_journal_record);
}

ncr_status ncr_journal_append(ncr_journal *journal, uint32_t tile, uint32_t crc, uint32_t clamped)
{
    ncr_journal_record r = {.tile = tile, .crc = crc, .clamped = clamped};
    r.check = check_of(&r);
    return write_at(journal, &r, sizeof r, place_of(atomic_fetch_add(&journal->next, 1)));
}

size_t ncr_journal_read(const ncr_journal *journal, uint64_t first, size_t count,
                        ncr_journal_record *out)
{
    const ssize_t n = pread(journal->fd, out, count * sizeof *out, (off_t)place_of(first));
    return n > 0 ? (size_t)n / sizeof *out : 0;
}

void ncr_journal_close(ncr_journal *journal)
{
    if (journal->fd >= 0)
        close(journal->fd);
    journal->fd = -1;
}
