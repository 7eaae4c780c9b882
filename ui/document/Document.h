// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/DistinctValues.h"
#include "core/cloud/PointCloud.h"
#include "core/edit/CommandPreview.h"
#include "core/session/FileFacts.h"
#include "core/session/Session.h"

#include <QObject>
#include <QString>
#include <QStringList>

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace punctum
{
namespace render
{
class PointStore;
}
}  // namespace punctum

namespace punctum::ui
{

/// Minimum, maximum and mean of each component of an attribute.
using AttributeFigures = std::array<AttributeStatistics, 3>;

/// One open cloud, as the window knows it: a snapshot that may be read without waiting for any job.
///
/// GUI thread only. Owned and kept up to date by the Workspace.
class Document final : public QObject
{
    Q_OBJECT
public:
    enum class State { Loading, Ready };

    /// `store`: what is drawn of the session's cloud.
    Document(std::shared_ptr<Session> session, std::shared_ptr<render::PointStore> store,
             QObject* parent = nullptr);

    /// Shared with the jobs that work on it.
    const std::shared_ptr<Session>& session() const noexcept { return m_session; }
    const std::shared_ptr<render::PointStore>& store() const noexcept { return m_store; }
    const std::shared_ptr<PointCloud>& cloud() const noexcept;
    /// Of the file that was opened.
    const FileFacts& facts() const noexcept { return m_facts; }
    const History& history() const noexcept;

    /// One of the files of the document, which has one, or, as a survey, several.
    struct Part {
        QString path, name;
        std::optional<QString> crs;  ///< name of its coordinate system, once known; empty: none is stated
        PointRange points;
        WorldBounds bounds;  ///< empty while not known
        bool damaged = false;
        bool moved = false;    ///< from another coordinate system, to be shown among the others
        bool changed = false;  ///< something of it is not saved
        bool shown = true;
    };
    /// In the order of their points.
    const std::vector<Part>& parts() const noexcept { return m_parts; }
    /// Whether it is a survey.
    bool many() const noexcept { return m_many; }
    /// Points of parts that are not to be seen, rising; what is hidden is neither drawn nor selected nor counted.
    std::vector<PointRange> hiddenRanges() const;
    int hiddenParts() const;
    void setShown(const std::vector<std::size_t>& parts, bool shown);
    void showAllParts();

    /// Of the file; of a survey the folder that holds all its files.
    QString path() const { return m_path; }
    QString fileName() const;  ///< without folder; of a survey what was opened, or "4 files"
    /// File name, with the part of its path by which it differs from another open file of that name.
    QString name() const { return m_name; }
    /// What the user would open again: the path, the folder or virtual point cloud that was opened, or several
    /// paths with line ends between them.
    QString origin() const;
    State state() const noexcept { return m_state; }
    bool loading() const noexcept { return m_state == State::Loading; }
    double loadedShare() const noexcept;
    PointIndex points() const noexcept { return cloud()->size(); }
    /// Something of a file is missing or damaged: it may not be overwritten.
    bool recovered() const noexcept { return m_recovered; }
    /// Whether saving under its own name is possible: of a survey those files that are whole.
    bool replaceable() const noexcept { return m_many || !m_recovered; }
    /// Points whose values could not be read and are 0.
    PointIndex missingPoints() const noexcept { return m_missingPoints; }
    bool modified() const;
    /// What is missing or damaged, one sentence each.
    const QStringList& losses() const noexcept { return m_losses; }
    /// Of the points read, without deleted ones; until all are there, a first idea from the header. Follows edits a
    /// little later, by a job.
    const WorldBounds& bounds() const noexcept { return m_bounds; }
    /// Of all points read, as raw integers; empty until all are there.
    const RawBounds& rawBounds() const noexcept { return m_rawBounds; }

    /// Attributes at present; a copy, so that no lock is needed.
    const std::vector<Attribute>& attributes() const noexcept { return m_attributes; }
    const Attribute* findAttribute(const QString& name) const;
    /// Of X and Y: "m", "ft", "deg"; empty when not known.
    QString coordinateUnit() const;
    /// Of lengths as they are drawn and measured: meters where the coordinates are in degrees; empty when not
    /// known.
    QString lengthUnit() const;
    /// pointSpacing() of the points, in lengthUnit(); 0 while it is not known.
    double spacing() const noexcept { return m_spacing; }
    /// Of cameras that look at this document within `bounds`: trueLengths().
    glm::dvec3 viewStretch(const WorldBounds& bounds) const;
    /// Points that an edit deleted; null: none. Views and tools leave them alone, saving leaves them out.
    const std::shared_ptr<const PointSet>& deleted() const noexcept { return m_deleted; }
    PointIndex deletedPoints() const noexcept { return m_deletedPoints; }
    /// Null while not known.
    const AttributeFigures* figures(const QString& name) const;
    /// The different values of an attribute that has a color for each, without deleted points; null while not
    /// known.
    const DistinctValues* values(const QString& name) const;
    /// Points of each class, without deleted ones; nothing while not known, or where the cloud has no classes.
    const std::optional<std::array<std::uint64_t, 256>>& classCounts() const noexcept { return m_classCounts; }
    /// The same of what a preview shows, as long as there is one: what legends tell.
    std::optional<std::array<std::uint64_t, 256>> classCountsShown() const;
    void setPreviewedClasses(std::vector<CommandPreview::ClassChange> changes);

    /// In one line, what saving would change; empty when nothing, or while it is not known.
    const QString& unsavedChanges() const noexcept { return m_unsavedChanges; }
    /// What the last save changed: a sentence, and the comparison in lines (empty: there was nothing to compare
    /// with).
    struct LastSave {
        QString sentence;
        QString details;
    };
    const std::optional<LastSave>& lastSave() const noexcept { return m_lastSave; }

    /// The user has said yes to another point format or LAS version, once for all saves.
    bool upgradeAllowed() const noexcept { return m_upgradeAllowed; }
    void allowUpgrade() { m_upgradeAllowed = true; }

    // -- called by the Workspace
    void setOrigin(const QString& origin);
    /// Of its path, what tells it from others of its file name; empty: nothing is needed.
    void setDistinction(const QString& part);
    void setLoaded(const las::ReadResult& result);
    void setAttributes(std::vector<Attribute> attributes);
    void setFigures(const QString& name, const AttributeFigures& figures);
    void setValues(const QString& name, DistinctValues values);
    void forgetFigures(const QStringList& names);
    void setDeleted(std::shared_ptr<const PointSet> points, PointIndex count);
    void setClassCounts(const std::array<std::uint64_t, 256>& counts);
    void setSavedAs(const std::filesystem::path& path, LastSave save);
    /// What a look at the points and systems of the parts told; empty bounds: nothing new.
    struct PartFacts {
        WorldBounds bounds;
        QString crs;
    };
    void setPartFacts(const std::vector<PartFacts>& facts);
    /// Whether the user knows it by a name: not a survey of files that were named one by one.
    bool named() const { return !m_many || (!m_origin.isEmpty() && !m_origin.contains(QLatin1Char('\n'))); }
    /// Nothing: it is not known; then none is called changed.
    void setChangedParts(const std::vector<bool>& changed);
    void setUnsavedChanges(const QString& changes);
    void setSpacing(double spacing);
    void noteEdit();

signals:
    void stateChanged();  ///< loading, modified, path, warnings, bounds, spacing
    void attributesChanged();
    void figuresChanged(const QString& name);
    void classCountsChanged();
    void previewedClassesChanged();
    void partsChanged();       ///< parts() but for what is shown
    void partsShownChanged();  ///< which are shown

private:
    void takeParts();
    void takeBounds(int axis, const AttributeStatistics& figures);

    std::shared_ptr<Session> m_session;
    std::shared_ptr<render::PointStore> m_store;
    FileFacts m_facts;
    CoordinateUnits m_units;
    bool m_many;
    std::vector<Part> m_parts;
    QString m_path, m_name, m_origin;
    State m_state = State::Loading;
    bool m_recovered = false;
    PointIndex m_missingPoints = 0;
    QStringList m_losses;
    bool m_upgradeAllowed = false;
    WorldBounds m_bounds;
    double m_spacing = 0.0;
    RawBounds m_rawBounds;
    std::vector<Attribute> m_attributes;
    std::shared_ptr<const PointSet> m_deleted;
    PointIndex m_deletedPoints = 0;
    std::map<QString, AttributeFigures> m_figures;
    std::map<QString, DistinctValues> m_values;
    std::optional<std::array<std::uint64_t, 256>> m_classCounts;
    std::vector<CommandPreview::ClassChange> m_previewedClasses;
    QString m_unsavedChanges;
    std::optional<LastSave> m_lastSave;
};

}  // namespace punctum::ui
