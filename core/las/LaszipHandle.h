// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"

#include <laszip/laszip_api.h>

#include <cstddef>
#include <string>

namespace punctum::las
{

// The same in every LASzip since 2.x; the header struct is not, so it is never touched (docs/dev/las.md).
static_assert(sizeof(laszip_point) == 96);
static_assert(offsetof(laszip_point, gps_time) == 32 && offsetof(laszip_point, rgb) == 40 &&
              offsetof(laszip_point, wave_packet) == 48 && offsetof(laszip_point, num_extra_bytes) == 80 &&
              offsetof(laszip_point, extra_bytes) == 88);

/// A laszip handle, freed on every way out.
class LaszipHandle
{
public:
    LaszipHandle()
    {
        if (laszip_create(&m_handle) != 0) throw Error("LASzip cannot be started.");
    }
    ~LaszipHandle() { laszip_destroy(m_handle); }
    LaszipHandle(const LaszipHandle&) = delete;
    LaszipHandle& operator=(const LaszipHandle&) = delete;

    laszip_POINTER get() const { return m_handle; }
    std::string error() const
    {
        laszip_CHAR* text = nullptr;
        return laszip_get_error(m_handle, &text) == 0 && text != nullptr ? text : "unknown error";
    }
    laszip_point* point() const
    {
        laszip_point* p = nullptr;
        if (laszip_get_point_pointer(m_handle, &p) != 0 || p == nullptr) throw Error("LASzip: " + error() + ".");
        return p;
    }

private:
    laszip_POINTER m_handle = nullptr;
};

}  // namespace punctum::las
