// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"
#include "core/cloud/PointCloud.h"
#include "core/las/Loss.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

/// Thrown instead of writing when the user should decide first; the option that says yes is named with each kind.
class WriteQuestion : public Error
{
public:
    enum class Kind {
        TargetChanged,    ///< overwriteChanged
        TargetProtected,  ///< replaceProtected
        Upgrade,          ///< upgrade
        Lossy,            ///< lossy
    };
    WriteQuestion(Kind kind, const std::filesystem::path& file, const std::string& sentence,
                  std::string becomes = {})
        : Error(file, sentence), m_kind(kind), m_becomes(std::move(becomes))
    {
    }
    Kind kind() const noexcept { return m_kind; }
    /// Upgrade, Lossy: "point format 7 of LAS 1.4", which would be written.
    const std::string& becomes() const noexcept { return m_becomes; }

private:
    Kind m_kind;
    std::string m_becomes;
};

struct WriteOptions {
    bool compressed = false;                   ///< LAZ
    std::optional<std::uint8_t> versionMinor;  ///< 2 to 5; default: as the source, 4 for clouds made here
    std::optional<std::uint8_t> pointFormat;   ///< 0-10; default: as the source
    bool verify = true;                        ///< decode the written file and compare before it takes its name
    bool upgrade = false;  ///< write another format or version where the source's cannot hold what is there now
    bool lossy = false;    ///< round or leave out what the format and version that were asked for cannot hold
    bool overwriteChanged = false;  ///< replace the cloud's file though another program changed it since
    bool replaceProtected = false;  ///< replace a file that is write-protected
    bool copyChunks = true;  ///< take compressed chunks that no edit touched from the file that holds the cloud
};

/// What was written, and what had to be different from the source (one sentence each).
struct WriteReport {
    PointIndex points = 0;
    std::uint64_t bytes = 0;
    std::uint64_t chunksCopied = 0;   ///< LAZ: taken as they were
    std::uint64_t chunksEncoded = 0;  ///< LAZ: compressed anew
    double writeSeconds = 0;  ///< from columns to the file, without waiting for the disk and without reading back
    std::vector<std::string> notes;
    std::vector<Loss>
        losses;  ///< what was rounded or left out, since WriteOptions::lossy allowed it; notes tell it, too
};

/// LAZ when the path ends in .laz (any case), else LAS.
bool isCompressedName(const std::filesystem::path& path);

struct WritePlan;  // WritePlan.h

/// How a cloud would be written, found out by a look ahead (previewSave()), so that the save after it need not do
/// so again.
struct KnownPlan {
    std::shared_ptr<const WritePlan> plan{};  ///< null: there is none
    /// Whether the cloud is still the one that the plan was made for; asked when it can no longer change, since
    /// cloud.mutex() is held. Empty: it is.
    std::function<bool()> holds{};

    /// Whether a save with these arguments may go by it.
    bool fits(const std::filesystem::path& path, const WriteOptions& options) const;
};

/// A file that is written, synced and verified under a temporary name beside its target, and waits for its name.
/// Destroyed without commit(), it leaves nothing behind and an existing target untouched. Move-only; needs neither
/// the cloud nor an open file any more, so that any number may wait. One thread at a time.
///
/// Example:
///     las::StagedWrite staged = las::stage(cloud, "a.laz", options, progress);
///     const las::WriteReport report = staged.commit();
class StagedWrite
{
public:
    struct State;  ///< internal, core/las/StagedWrite.h
    explicit StagedWrite(std::unique_ptr<State> state);
    ~StagedWrite();
    StagedWrite(StagedWrite&& other) noexcept;
    StagedWrite& operator=(StagedWrite&& other) noexcept;

    /// Links followed.
    const std::filesystem::path& target() const noexcept;
    /// Gives the file its name; once. From then on the cloud's source says that the file holds the cloud as it was
    /// when it was staged. Throws Error, with the old file untouched, when the target was changed since.
    WriteReport commit();
    State& state() noexcept { return *m_state; }

private:
    std::unique_ptr<State> m_state;
};

/// The first step of write(): all but giving the file its name. By the plan that is known, where it fits.
/// Header, VLRs, gaps and EVLRs come from cloud.source() unchanged unless they must differ.
/// Attributes added after loading become extra bytes. Holds cloud.mutex() shared meanwhile.
/// Throws Error (nothing is left behind, an existing target is untouched), WriteQuestion or Cancelled (likewise).
StagedWrite stage(const PointCloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                  Progress& progress, const KnownPlan& known = {});

/// Writes the cloud, whole or not at all: a temporary file beside the target is written, synced, verified, then
/// renamed over it: stage() and commit(), and throws what they throw.
/// A side-car index (.lax) of the file that is replaced is renamed to .lax.old, since LAStools would go by it.
WriteReport write(const PointCloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                  Progress& progress, const KnownPlan& known = {});

}  // namespace punctum::las
