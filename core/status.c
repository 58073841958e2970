/* SPDX-License-Identifier: MIT */
#include "core/status.h"

static const char *const names[] = {
    "NCR_OK",           "NCR_E_ARG",     "NCR_E_NOMEM", "NCR_E_IO",        "NCR_E_FORMAT",
    "NCR_E_DEGENERATE", "NCR_E_BACKEND", "NCR_E_LIMIT", "NCR_E_CANCELLED",
};

static const char *const texts[] = {
    "done",
    "the call itself is wrong",
    "out of memory",
    "the operating system refused",
    "the bytes are not what they claim",
    "the geometry has no answer",
    "a library refused or is not built in",
    "a stated limit would be passed",
    "cancelled",
};

enum { status_count = sizeof names / sizeof names[0] };
_Static_assert(status_count == NCR_E_CANCELLED + 1, "a name for each status");
_Static_assert(sizeof texts / sizeof texts[0] == status_count, "a sentence for each status");

const char *ncr_status_name(ncr_status status)
{
    return (unsigned)status < status_count ? names[status] : "NCR_E_?";
}

const char *ncr_status_text(ncr_status status)
{
    return (unsigned)status < status_count ? texts[status] : "unknown status";
}
