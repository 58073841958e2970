/* SPDX-License-Identifier: MIT
 * status.h - how functions that meet memory, files or foreign geometry say how it went. */
#ifndef NCR_CORE_STATUS_H
#define NCR_CORE_STATUS_H

#include "core/base.h"

NCR_BEGIN

typedef enum ncr_status {
    NCR_OK = 0,
    NCR_E_ARG,        /* the call itself is wrong */
    NCR_E_NOMEM,      /* the allocator returned NULL */
    NCR_E_IO,         /* the operating system said no */
    NCR_E_FORMAT,     /* the bytes are not what they claim */
    NCR_E_DEGENERATE, /* the geometry has no answer */
    NCR_E_BACKEND,    /* a wrapped library refused, or was left out of this build */
    NCR_E_LIMIT,      /* a stated limit would be passed (65535 points, a memory budget) */
    NCR_E_CANCELLED,  /* the context's cancel hook said stop */
} ncr_status;

/** The enumerator's own name, "NCR_E_FORMAT"; "NCR_E_?" outside the range. Static storage. */
NCR_API const char *ncr_status_name(ncr_status status);

/** One sentence without a full stop, "the bytes are not what they claim". Static storage. */
NCR_API const char *ncr_status_text(ncr_status status);

NCR_END

#endif
