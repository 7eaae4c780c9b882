// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/File.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace punctum::las
{

/// A file that appears whole or not at all: written under a temporary name in the folder of its target, synced,
/// then renamed over it. Destroyed without commit(), it leaves nothing behind and an existing target untouched.
///
/// A target that is a symbolic link is followed. writeAt may be called from several threads at once.
/// Every member throws Error with the target's name and what the system said.
class AtomicFile
{
public:
    /// `expectedBytes`: refused at once when the disk has less room; 0 when unknown.
    explicit AtomicFile(const std::filesystem::path& target, std::uint64_t expectedBytes = 0);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Links followed.
    const std::filesystem::path& target() const noexcept { return m_target; }
    const std::filesystem::path& temporary() const noexcept { return m_temporary; }
    /// Whether the target has other names (hard links), which will keep the old contents.
    bool hasOtherNames() const noexcept { return m_otherNames; }

    void writeAt(std::uint64_t offset, std::span<const std::byte> bytes);
    /// Cuts the file off, or extends it with zeros.
    void resize(std::uint64_t bytes);
    /// Waits until all is on the disk.
    void sync();
    /// Gives the file its name; the mode of an existing target is kept. Gives what tells the new file from others.
    FileStamp commit();

private:
    [[noreturn]] void fail(const std::string& what, int error) const;

    std::filesystem::path m_shown;   ///< as the user named it
    std::filesystem::path m_target;  ///< links followed
    std::filesystem::path m_temporary;
    int m_descriptor = -1;
    bool m_exists = false;
    bool m_otherNames = false;
    bool m_committed = false;
    unsigned m_mode = 0;
    unsigned m_owner = 0, m_group = 0;
};

}  // namespace punctum::las
