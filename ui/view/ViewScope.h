// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"

#include <QObject>
#include <QString>

#include <array>
#include <set>

namespace punctum::ui
{

class Document;
class ViewFilter;
class ViewSettings;
class Workspace;

/// Sees to it that what hides or locks points ends with the files that it was chosen for: filter, box, cuts, hidden
/// classes and locked classes each belong to the files that are open when they change, and are dropped when the
/// last of these is closed. So a file that is opened next is seen whole.
///
/// GUI thread only; borrows all that it is given.
class ViewScope final : public QObject
{
    Q_OBJECT
public:
    ViewScope(Workspace& workspace, ViewSettings& settings, ViewFilter& filter, QObject* parent = nullptr);

    /// Takes away all that hides points, in every file.
    void showAll();

private:
    /// One thing that was chosen: as it was last seen, and the files that it was chosen for.
    template <typename Value>
    struct Choice {
        Value value{};
        std::set<const Document*> files;
    };
    template <typename Value>
    void take(Choice<Value>& choice, const Value& now);
    template <typename Value>
    bool outlived(Choice<Value>& choice, const Document* removed);
    void takeSettings();
    void documentRemoved(const Document* document);

    Workspace& m_workspace;
    ViewSettings& m_settings;
    ViewFilter& m_filter;
    Choice<QString> m_text;
    Choice<std::optional<WorldBounds>> m_box;
    Choice<std::vector<ClipPlane>> m_planes;
    Choice<std::array<bool, 256>> m_hidden, m_locked;
};

}  // namespace punctum::ui
