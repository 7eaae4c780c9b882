// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"

#include <algorithm>
#include <string>
#include <vector>

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

/// Whether one of the sentences has this part.
inline bool mentions(const std::vector<std::string>& sentences, const std::string& part)
{
    return std::any_of(sentences.begin(), sentences.end(),
                       [&](const std::string& s) { return s.find(part) != std::string::npos; });
}

}  // namespace punctum
