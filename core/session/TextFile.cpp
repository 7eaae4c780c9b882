// SPDX-License-Identifier: MIT
#include "core/session/TextFile.h"

#include "core/las/AtomicFile.h"

#include <span>

namespace punctum
{

void writeText(const std::filesystem::path& target, std::string_view text)
{
    las::AtomicFile file(target, text.size());
    file.writeAt(0, std::as_bytes(std::span(text)));
    file.sync();
    file.commit();
}

}  // namespace punctum
