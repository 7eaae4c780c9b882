// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

namespace punctum
{

/// Tells an object from every other one, of now and of later, as an address cannot once its memory is used again.
/// A copy is equal to what it was copied from, and to nothing else.
class Identity
{
public:
    Identity() : m_mark(std::make_shared<char>()) {}

    friend bool operator==(const Identity&, const Identity&) = default;

private:
    std::shared_ptr<const char> m_mark;
};

}  // namespace punctum
