// SPDX-License-Identifier: MIT
#include "ui/navigate/Places.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "render/camera/CameraFile.h"
#include "ui/basic/Question.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/menu/Menus.h"
#include "ui/navigate/AxesMark.h"
#include "ui/navigate/GoToDialog.h"
#include "ui/navigate/SavedViewsDialog.h"
#include "ui/settings/WindowSettings.h"
#include "ui/view/MessageArea.h"
#include "ui/view/Viewport.h"

#include <QApplication>
#include <QClipboard>
#include <QFileDialog>
#include <QFileInfo>
#include <QInputDialog>
#include <QMainWindow>
#include <QMenu>
#include <QPointer>
#include <QSaveFile>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace punctum::ui
{

namespace
{

constexpr int kKeys = 9;  // Alt+1 to Alt+9

}  // namespace

Places::Places(Menus& menus, Workspace& workspace, Viewport& view, WindowSettings& settings)
    : QObject(&menus.window()),
      m_menus(menus),
      m_workspace(workspace),
      m_view(view),
      m_settings(settings),
      m_axes(new AxesMark(view)),
      m_saved(SavedViews::fromText(settings.savedViews()))
{
    view.setCorner(m_axes);
    view.showCorner(settings.axes());
    connect(m_axes, &AxesMark::viewWanted, &view, &Viewport::lookFrom);
    connect(m_axes, &AxesMark::projectionWanted, &view, &Viewport::setOrthographic);
    addActions();
}

void Places::addActions()
{
    QMenu& viewMenu = m_menus.viewMenu();
    Viewport& view = m_view;
    const auto insert = [&](QAction* action) {
        viewMenu.insertAction(m_menus.placesEnd(), action);
        return action;
    };
    QAction* const parallel =
        insert(m_menus.add(&viewMenu, tr("&Orthographic"), {}, {QKeySequence(Qt::Key_V)},
                           tr("Parallel lines stay parallel, and all has the same scale, or perspective"), [] {}));
    parallel->setObjectName(QStringLiteral("orthographic"));
    parallel->setCheckable(true);
    m_menus.needsDocument(parallel);
    connect(parallel, &QAction::triggered, &view, &Viewport::setOrthographic);
    connect(&view, &Viewport::cameraChanged, parallel,
            [parallel, &view] { parallel->setChecked(view.camera().orthographic); });

    QAction* const coordinate =
        insert(m_menus.add(&viewMenu, tr("&Go to Coordinate..."), {}, {QKeySequence(Qt::CTRL | Qt::Key_G)},
                           tr("Bring a place into the middle of the view"), [this] { askCoordinate(); }));
    coordinate->setObjectName(QStringLiteral("goToCoordinate"));
    m_menus.needsDocument(coordinate);

    m_menu = new QMenu(tr("Saved Vie&ws"), &m_menus.window());
    viewMenu.insertMenu(m_menus.placesEnd(), m_menu);
    addSavedViews(*m_menu);

    QAction* const axes =
        insert(m_menus.add(&viewMenu, tr("A&xes in the Corner"), {}, {},
                           tr("Axes in the corner of the view; a click on an end looks from there"), [] {}));
    axes->setObjectName(QStringLiteral("axes"));
    axes->setCheckable(true);
    axes->setChecked(m_settings.axes());
    connect(axes, &QAction::toggled, this, [this, &view](bool on) {
        m_settings.setAxes(on);
        view.showCorner(on);
    });
}

void Places::addSavedViews(QMenu& menu)
{
    QAction* const save = m_menus.add(&menu, tr("&Save View..."), {}, {QKeySequence(Qt::SHIFT | Qt::Key_V)},
                                      tr("Keep where the camera is, under a name"), [this] { askName(); });
    save->setObjectName(QStringLiteral("saveView"));
    m_menus.needsDocument(save);
    menu.addSeparator();
    m_listEnd = menu.addSeparator();
    QAction* const arrange = m_menus.add(&menu, tr("&Rename or Delete..."), {}, {}, {},
                                         [this] { (new SavedViewsDialog(*this, &m_menus.window()))->show(); });
    QAction* const copy = m_menus.add(&menu, tr("&Copy Camera"), {}, {},
                                      tr("As the text of a camera file, which punctum render --camera reads"),
                                      [this] { QApplication::clipboard()->setText(cameraText()); });
    QAction* const write =
        m_menus.add(&menu, tr("Save Camera &File..."), {}, {}, tr("A file that punctum render --camera reads"),
                    [this] { chooseCameraFile(); });
    for (QAction* const action : {arrange, copy, write}) m_menus.needsDocument(action);
    copy->setObjectName(QStringLiteral("copyCamera"));
    arrange->setObjectName(QStringLiteral("arrangeViews"));
    connect(&menu, &QMenu::aboutToShow, this, &Places::fillMenu);
    // The keys act whether the menu was open or not; so they are no part of it.
    for (int number = 1; number <= kKeys; ++number) {
        auto* const key = new QAction(tr("Saved view %1").arg(number), &m_menus.window());
        key->setShortcut(QKeySequence(Qt::ALT | Qt::Key(Qt::Key_0 + number)));
        key->setObjectName(QStringLiteral("savedView%1").arg(number));
        m_menus.window().addAction(key);
        m_menus.needsDocument(key);
        connect(key, &QAction::triggered, this, [this, number] { recall(number); });
    }
}

void Places::fillMenu()
{
    for (QAction* const action : m_listed) delete action;
    m_listed.clear();
    const auto add = [this](const QString& text) {
        auto* const action = new QAction(text, m_menu);
        m_menu->insertAction(m_listEnd, action);
        m_listed.push_back(action);
        return action;
    };
    const std::vector<SavedViews::View> all = views();
    if (all.empty()) add(tr("No view is saved"))->setEnabled(false);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const SavedViews::View& view = all[k];
        const bool other = view.file != all.front().file;
        QString text = menuText(other ? tr("%1 (%2)").arg(view.name, QFileInfo(view.file).fileName()) : view.name);
        // Told behind the name; the key itself belongs to an action of its own.
        if (k < std::size_t(kKeys))
            text += QLatin1Char('\t') +
                    QKeySequence(Qt::ALT | Qt::Key(Qt::Key_1 + int(k))).toString(QKeySequence::NativeText);
        connect(add(text), &QAction::triggered, this, [this, view] { recall(view); });
    }
}

void Places::say(const QString& sentence)
{
    m_view.messages().add(MessageKind::Info, sentence);
}

// -- coordinates

void Places::askCoordinate()
{
    const Document* const active = m_workspace.active();
    if (!active) return;
    const glm::dvec3& now = m_view.camera().pivot;
    const auto text = [&](int axis) { return plainCoordinate(active->cloud()->coordinates(), axis, now[axis]); };
    auto* const dialog = new GoToDialog(text(0), text(1), active->coordinateUnit(), &m_menus.window());
    connect(dialog, &GoToDialog::placeChosen, this, &Places::goTo);
    dialog->open();
}

void Places::goTo(glm::dvec3 world, bool hasHeight)
{
    const Document* const active = m_workspace.active();
    if (!active) return;
    if (!hasHeight) world.z = m_view.camera().pivot.z;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Document* const document : m_workspace.documents()) {
        const WorldBounds& bounds = document->bounds();
        if (bounds.empty()) continue;
        glm::dvec3 away = glm::max(glm::max(bounds.min - world, world - bounds.max), glm::dvec3(0.0));
        if (!hasHeight) away.z = 0.0;
        nearest = std::min(nearest, glm::length(away * m_view.camera().stretch));
    }
    m_view.goTo(world);
    m_view.setFocus();
    if (nearest == 0.0) return;
    const QString place = QStringLiteral("%1; %2").arg(shownCoordinate(active->cloud()->coordinates(), 0, world.x),
                                                       shownCoordinate(active->cloud()->coordinates(), 1, world.y));
    const QString unit = active->lengthUnit();
    say(tr("The place %1 lies outside of all that is open, %2 %3 away from it.")
            .arg(place, numberText(nearest < 10.0 ? nearest : std::round(nearest)),
                 unit.isEmpty() ? tr("units") : unit));
}

// -- saved views

std::vector<SavedViews::View> Places::views() const
{
    QStringList files;
    const Workspace& workspace = m_workspace;
    if (const Document* const active = workspace.active()) files << active->path();
    for (const Document* const document : workspace.documents())
        if (document != workspace.active()) files << document->path();
    return m_saved.of(files);
}

void Places::askName()
{
    const Document* const active = m_workspace.active();
    if (!active) return;
    auto* const dialog = new QInputDialog(&m_menus.window());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName(QStringLiteral("viewName"));
    dialog->setWindowTitle(tr("Save view"));
    dialog->setLabelText(tr("Name of the view"));
    dialog->setTextValue(m_saved.freshName(active->path()));
    dialog->setOkButtonText(tr("&Save"));
    connect(dialog, &QInputDialog::textValueSelected, this, &Places::save);
    dialog->open();
}

void Places::save(const QString& name)
{
    const Document* const active = m_workspace.active();
    if (!active) return;
    if (!m_saved.add({active->path(), name, cameraText()}))
        return say(tr("%1 views of this file are saved, which is the most there can be: delete one first.")
                       .arg(SavedViews::kMostOfFile));
    keep();
}

void Places::recall(const SavedViews::View& view)
{
    const QSize size = m_view.pictureSize();
    try {
        m_view.flyTo(
            render::readCamera(view.camera.toStdString(), m_view.camera(), {}, {size.width(), size.height()}));
    } catch (const Error& error) {
        m_view.messages().add(
            MessageKind::Warning,
            tr("The view \"%1\" cannot be read: %2").arg(view.name, QString::fromUtf8(error.what())));
    }
}

void Places::recall(int number)
{
    const std::vector<SavedViews::View> all = views();
    if (number < 1 || std::size_t(number) > all.size())
        return say(all.empty() ? tr("No view of the open files is saved.")
                               : tr("There is no view %1: the open files have %2.").arg(number).arg(all.size()));
    recall(all[std::size_t(number) - 1]);
}

bool Places::rename(const SavedViews::View& view, const QString& name)
{
    if (!m_saved.rename(view, name)) return false;
    keep();
    return true;
}

void Places::remove(const SavedViews::View& view)
{
    const auto& ask = m_workspace.askQuestion;
    if (!ask) return;
    ask({tr("Delete this view?"), tr("\"%1\" is gone then; points are not concerned.").arg(view.name),
         tr("&Delete")},
        [self = QPointer(this), view](bool wanted) {
            if (self && wanted && self->m_saved.remove(view)) self->keep();
        });
}

void Places::keep()
{
    m_settings.setSavedViews(m_saved.text());
    emit savedViewsChanged();
}

// -- the camera as a file

QString Places::cameraText() const
{
    return toQString(render::cameraText(m_view.camera()));
}

void Places::chooseCameraFile()
{
    const Document* const active = m_workspace.active();
    if (!active) return;
    const QString base = QFileInfo(active->fileName()).completeBaseName();
    QString path = QFileDialog::getSaveFileName(
        &m_menus.window(), tr("Save the camera"),
        m_settings.folder() + QLatin1Char('/') + base + QStringLiteral(".json"), tr("Camera file (*.json)"));
    if (path.isEmpty()) return;
    if (QFileInfo(path).suffix().isEmpty()) path += QStringLiteral(".json");
    writeCamera(path);
}

void Places::writeCamera(const QString& path)
{
    m_workspace.startJob(tr("Save the camera"), [path, text = cameraText().toUtf8()](Progress&) {
        QSaveFile file(path);
        if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit())
            throw Error(toPath(path), "The camera could not be written: " + file.errorString().toStdString() + ".");
    });
}

}  // namespace punctum::ui
