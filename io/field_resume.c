/* SPDX-License-Identifier: MIT */
#include "io/field_radiance_internal.h"

#include <zlib.h>

enum { records_at_once = 64 };

typedef struct resume_job {
    ncr_radiance_file *file;
    _Atomic uint64_t kept, damaged;
} resume_job;

static bool bytes_agree(const ncr_radiance_file *f, const ncr_journal_record *r)
{
    uint8_t packed[NCR_PACKED_MAX];
    const ncr_tile cell = ncr_radiance_cell(&f->layout, r->tile);
    const size_t size = ncr_radiance_packed_bytes(&f->layout, &cell);
    return ncr_radiance_read_packed(f->fd, &f->layout, &cell, packed) &&
           crc32(crc32(0, Z_NULL, 0), packed, (uInt)size) == r->crc;
}

/* A tile that was damaged once and captured again has two records: the first that agrees counts. */
static void take(resume_job *job, const ncr_journal_record *r)
{
    ncr_radiance_file *f = job->file;
    if (!ncr_journal_record_is_whole(r) || r->tile >= ncr_radiance_cells(&f->layout))
        return;
    if (!bytes_agree(f, r)) {
        atomic_fetch_add(&job->damaged, 1);
        return;
    }
    const ncr_tile cell = ncr_radiance_cell(&f->layout, r->tile);
    if (atomic_exchange(&f->arrived[r->tile], (uint16_t)(cell.width * cell.height)) == 0) {
        atomic_fetch_add(&f->clamped, r->clamped);
        atomic_fetch_add(&job->kept, 1);
    }
}

static void take_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    resume_job *job = arg;
    ncr_journal_record record[records_at_once];
    (void)worker;
    const size_t count = ncr_journal_read(&job->file->journal, begin, end - begin, record);
    for (size_t k = 0; k < count; k++)
        take(job, &record[k]);
}

ncr_status ncr_radiance_resume(ncr_radiance_file *file, uint64_t *kept, uint64_t *damaged)
{
    resume_job job = {.file = file};
    const size_t records = (size_t)atomic_load(&file->journal.next);
    const ncr_status status =
        ncr_parallel_for(file->ctx, records, records_at_once, take_range, &job);
    *kept = atomic_load(&job.kept);
    *damaged = atomic_load(&job.damaged);
    return status;
}
