/* SPDX-License-Identifier: MIT
 * cxx_guard.hpp - the only way C++ code may be entered from C: no exception crosses. */
#pragma once

#include "core/status.h"

#include <new>

template <class F> ncr_status ncr_guard(F &&body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return NCR_E_NOMEM;
    } catch (...) {
        return NCR_E_BACKEND;
    }
}
