// SPDX-License-Identifier: MIT
#include "ui/view/ViewScope.h"

#include "ui/document/Workspace.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"

namespace punctum::ui
{

namespace
{

bool same(const std::optional<WorldBounds>& a, const std::optional<WorldBounds>& b)
{
    return Clip{a, {}} == Clip{b, {}};
}
template <typename Value>
bool same(const Value& a, const Value& b)
{
    return a == b;
}

std::array<bool, 256> hiddenClasses(const ViewSettings& settings)
{
    std::array<bool, 256> hidden{};
    for (std::size_t code = 0; code < hidden.size(); ++code) hidden[code] = !settings.display().classVisible[code];
    return hidden;
}

}  // namespace

ViewScope::ViewScope(Workspace& workspace, ViewSettings& settings, ViewFilter& filter, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_settings(settings), m_filter(filter)
{
    connect(&settings, &ViewSettings::changed, this, &ViewScope::takeSettings);
    connect(&filter, &ViewFilter::changed, this, [this] { take(m_text, m_filter.text()); });
    connect(&workspace, &Workspace::documentRemoved, this, &ViewScope::documentRemoved);
}

template <typename Value>
void ViewScope::take(Choice<Value>& choice, const Value& now)
{
    if (same(choice.value, now)) return;
    choice.value = now;
    choice.files = {m_workspace.documents().begin(), m_workspace.documents().end()};
}

void ViewScope::takeSettings()
{
    const Clip& clip = m_settings.display().clip;
    take(m_box, clip.box);
    take(m_planes, clip.planes);
    take(m_hidden, hiddenClasses(m_settings));
    take(m_locked, m_settings.lockedClasses());
}

/// Whether none of its files is open any more.
template <typename Value>
bool ViewScope::outlived(Choice<Value>& choice, const Document* removed)
{
    choice.files.erase(removed);
    return choice.files.empty() && !same(choice.value, Value{});
}

void ViewScope::documentRemoved(const Document* document)
{
    Clip clip = m_settings.display().clip;
    if (outlived(m_box, document)) clip.box.reset();
    if (outlived(m_planes, document)) clip.planes.clear();
    m_settings.setClip(clip);
    if (outlived(m_hidden, document)) m_settings.setAllClassesVisible(true);
    if (outlived(m_locked, document)) m_settings.unlockClasses();
    if (outlived(m_text, document)) m_filter.setText({});
}

void ViewScope::showAll()
{
    m_settings.setClip({});
    m_settings.setAllClassesVisible(true);
    m_filter.setText({});
    for (Document* document : m_workspace.documents()) document->showAllParts();
}

}  // namespace punctum::ui
