// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"

#include <string>

namespace punctum
{

/// The sentence of the Error that the work throws, or "no error".
template <typename Work>
std::string complaint(const Work& work)
{
    try {
        work();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

}  // namespace punctum
