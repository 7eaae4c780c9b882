// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/File.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

/// A file that appears whole or not at all: written under a temporary name in the folder of its target, synced,
/// then renamed over it. Destroyed without commit(), it leaves nothing behind and an existing target untouched.
///
/// What replaces an existing file takes over its mode, extended attributes and access list, and its owner and group
/// where that is permitted. A target that is a symbolic link is followed, also where there is no file yet. One that
/// is write-protected is replaced only where the caller says so: renaming needs no right to write to it. writeAt
/// may be called from several threads at once. Every member throws Error with the target's name and what the system
/// said.
class AtomicFile
{
public:
    /// What becomes of a target that is write-protected.
    enum class Protected { Refuse, Replace };

    /// `expectedBytes`: refused at once when the disk has less room; 0 when unknown.
    explicit AtomicFile(const std::filesystem::path& target, std::uint64_t expectedBytes = 0,
                        Protected whenProtected = Protected::Refuse);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Links followed.
    const std::filesystem::path& target() const noexcept { return m_target; }
    const std::filesystem::path& temporary() const noexcept { return m_temporary; }
    Protected whenProtected() const noexcept { return m_whenProtected; }
    /// Whether there was a file when this was made.
    bool replaces() const noexcept { return m_before.has_value(); }
    /// That file; nothing: there was none.
    const std::optional<FileStamp>& before() const noexcept { return m_before; }
    /// What was written, once it is sealed.
    const FileStamp& stamp() const noexcept { return m_stamp; }

    void writeAt(std::uint64_t offset, std::span<const std::byte> bytes);
    /// Cuts the file off, or extends it with zeros.
    void resize(std::uint64_t bytes);
    /// Waits until all is on the disk.
    void sync();
    /// Takes over what an existing target has and closes the file: it is ready for its name, and nothing can be
    /// written any more. Holds no descriptor from then on, so that thousands may wait. Once more does nothing.
    void seal();
    /// Throws Error when another program touched the target since this was made.
    void checkTarget() const;
    /// Gives a sealed file its name without looking at the target or waiting for the disk: 0, or what the system
    /// says.
    int takeName() noexcept;
    /// The temporary file stays when this ends, for whoever gives it its name later.
    void leave() noexcept { m_left = true; }
    /// Gives the file its name, unless another program touched the target since this was made; seals it first.
    /// Gives what tells the new file from others.
    FileStamp commit();
    /// What of an existing target could not be kept, one sentence each; complete after seal().
    const std::vector<std::string>& notes() const noexcept { return m_notes; }

private:
    void takeOver();
    void takeOverAttributes(bool& accessKept);
    [[noreturn]] void fail(const std::string& what, int error) const;

    std::filesystem::path m_shown;   ///< as the user named it
    std::filesystem::path m_target;  ///< links followed
    std::filesystem::path m_temporary;
    Protected m_whenProtected;
    int m_descriptor = -1;
    std::optional<FileStamp> m_before;  ///< of the target; nothing: there was none
    FileStamp m_stamp;                  ///< of what was written, once it is sealed
    std::vector<std::string> m_notes;
    bool m_left = false;  ///< the temporary file has its name, or is somebody else's matter
    unsigned m_mode = 0;
    unsigned m_owner = 0, m_group = 0;
};

/// Whether there is a file that its owner made read-only, or that we may not write to.
bool writeProtected(const std::filesystem::path& path);

/// The folder of a path; "." where it has none.
std::filesystem::path folderOf(const std::filesystem::path& path);

/// Waits until the names in a folder are on the disk: 0, or what the system says, but for file systems that cannot.
int syncFolder(const std::filesystem::path& folder) noexcept;

}  // namespace punctum::las
