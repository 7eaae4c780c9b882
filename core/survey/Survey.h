// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/las/Reader.h"
#include "core/survey/Grid.h"
#include "core/survey/RecordUnion.h"

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace punctum
{

class Overview;
class Progress;
class ReadingOrder;

/// One or many LAS and LAZ files as one cloud.
///
/// The points of the files follow one another, in the order of the paths, so that index and neighborhood, selection
/// and edit know no files. Each attribute is there once (RecordUnion.h); points of a file that lacks it have no
/// value (Column::absent()). X, Y and Z are in one grid (Grid.h), those of another coordinate system where the PROJ
/// library puts them. What the survey's columns do not say exactly (coordinates of another grid, bytes that nobody
/// described) each file keeps besides, so that partCloud() gives what the file held, but for the edits.
///
/// One file is its own survey: its cloud is the reader's.
///
/// Threads: open() and read() by one thread; afterwards it does not change, and any thread may ask.
class Survey
{
public:
    /// One of the files.
    struct Part {
        std::filesystem::path path;  ///< as it was opened
        PointRange points;
        std::shared_ptr<const las::SourceFile> source;
        bool moved = false;  ///< from another coordinate system, for being shown among the others
    };

    /// Reads all headers, in parallel. Files that cannot be opened are left out, and told of in warnings(), unless
    /// all are. Throws Error, Cancelled.
    static std::unique_ptr<Survey> open(const std::vector<std::filesystem::path>& files, Progress& progress);
    ~Survey();
    Survey(const Survey&) = delete;
    Survey& operator=(const Survey&) = delete;

    const std::shared_ptr<PointCloud>& cloud() const noexcept { return m_cloud; }
    const std::vector<Part>& parts() const noexcept { return m_parts; }
    /// Whether several files were asked for: the cloud is no reader's.
    bool many() const noexcept { return !m_columns.empty(); }
    /// The part that holds a point.
    std::size_t partOf(PointIndex point) const noexcept;
    /// What a file of all points would be: of one file its own source.
    const std::shared_ptr<const las::SourceFile>& source() const noexcept { return m_cloud->source(); }
    /// A first idea of the extent: from headers and sampled records.
    const WorldBounds& firstBounds() const noexcept { return m_firstBounds; }
    const RawBounds& sampledBounds() const noexcept { return m_sampledBounds; }
    /// One sentence each, with the file's name where there are many.
    const std::vector<std::string>& warnings() const noexcept { return m_warnings; }
    /// Those of the warnings that tell of what is missing or damaged.
    const std::vector<std::string>& losses() const noexcept { return m_losses; }

    /// What is read before everything else, for those who look at it meanwhile: the first points of chunks all
    /// over a survey that takes longer (las::Reader::readFirsts()), some million in all, so that it is seen whole
    /// within seconds.
    struct Ahead {
        /// Told of them before read() tells anybody of any point; they are among what it tells later all the same.
        /// Null: none are read.
        las::Reader::BatchSink sink{};
        PointIndex from = 4'000'000;  ///< of surveys with so many points, which take a second or more
        std::uint64_t chunks = 4096;  ///< of so many chunks, and at least one of each file
        std::uint64_t points = 256;   ///< so many of each
        /// Likewise, where memory does not hold the survey and what is drawn of it: as many as there are windows
        /// (render::SlotOrder), so that some of them are in the first ones, which are all that a picture of the
        /// whole is made of.
        std::uint64_t pointsBeyond = 1024;
        PointIndex keptFrom = 20'000'000;  ///< surveys of so many have an Overview for the next opening
    };

    /// Reads all points, once. `sink` as in las::Reader::read(). A file of many that cannot be read is missing, and
    /// told of, unless it is the last one left. `order`: by which somebody says what to read first; null, or while
    /// nobody does: spread over the survey. Whatever the order, the result is the same. Throws Error, Cancelled.
    las::ReadResult read(Progress& progress, const las::Reader::BatchSink& sink, const Ahead& ahead,
                         ReadingOrder* order = nullptr);
    las::ReadResult read(Progress& progress, const las::Reader::BatchSink& sink)
    {
        return read(progress, sink, Ahead());
    }

    /// Lets go of what is kept of these files for the next opening (Overview.h), as if they never were opened.
    void forgetOverview() const noexcept;

    /// One file's points with the edits, as las::write() takes them: columns share the survey's memory wherever the
    /// file's record has the same field. Hold cloud()->mutex() for as long as it is used. Throws Error when the
    /// file's point format cannot hold what the points are now.
    std::shared_ptr<PointCloud> partCloud(std::size_t part, Progress& progress) const;

private:
    struct Member;
    struct ChangesOfThreads;
    class PartReading;
    class FilesInReading;

    Survey();
    void unite();
    void adoptGrid();
    void compareFiles();
    std::shared_ptr<Column> ownColumn(const las::RecordField& field);
    std::shared_ptr<PointCloud> readingView(std::size_t part);
    bool looksAtFew(const ReadingOrder& order) const;
    void readFirsts(const Ahead& ahead, Overview* overview, const ReadingOrder& order, ChangesOfThreads& changes,
                    Progress& progress);
    std::unique_ptr<Overview> overview() const;
    void show(const Overview& overview, const Ahead& ahead, ChangesOfThreads& changes, Progress& progress);
    void keepOf(Overview& overview, std::size_t part, PointRange points) const;
    WorldBounds boxOf(std::size_t part) const;
    std::vector<WorldBounds> likelyBoxes(std::size_t part) const;
    std::vector<WorldBounds> readBoxes(std::size_t part, const RawBounds& exact) const;
    bool isOwn(std::size_t part, std::size_t field) const;

    std::shared_ptr<PointCloud> m_cloud;
    std::vector<Part> m_parts;
    std::vector<std::unique_ptr<Member>> m_members;        ///< what is known of each part beside that
    std::vector<std::shared_ptr<Column>> m_columns;        ///< of the union's record, as they were made
    std::mutex m_mutex;                                    ///< guards m_own while reading
    std::map<std::string, std::shared_ptr<Column>> m_own;  ///< what parts keep for themselves, all in one array
    WorldBounds m_firstBounds;
    RawBounds m_sampledBounds;
    std::vector<std::string> m_warnings, m_losses;
};

}  // namespace punctum
