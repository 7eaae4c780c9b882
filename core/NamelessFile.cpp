// SPDX-License-Identifier: MIT
#include "core/NamelessFile.h"

#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace punctum
{

int openNameless(const std::filesystem::path& folder, const std::string& kind)
{
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    std::string name = (folder / (kind + "-XXXXXX")).string();
    const int file = ::mkostemp(name.data(), O_CLOEXEC);
    if (file >= 0) ::unlink(name.c_str());
    return file;
}

}  // namespace punctum
