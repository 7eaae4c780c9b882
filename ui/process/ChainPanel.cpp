// SPDX-License-Identifier: MIT
#include "ui/process/ChainPanel.h"

#include "core/Error.h"
#include "core/steps/Steps.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/process/ChainFile.h"
#include "ui/process/StepIcons.h"
#include "ui/style/Icons.h"
#include "ui/style/Widgets.h"

#include <QFile>
#include <QFileDialog>
#include <QFontMetrics>
#include <QListWidget>
#include <QPushButton>
#include <QSaveFile>
#include <QShortcut>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr int kMostShownSteps = 4;  ///< that are seen at once

QString describe(const StepWish& wish)
{
    QStringList values;
    for (const auto& [key, text] : wish.values) values << toQString(key + "=" + text);
    QString line = toQString(findStep(wish.step)->title());
    if (!values.isEmpty()) line += QStringLiteral("  ") + values.join(QLatin1Char(' '));
    return line;
}

QString scopeText(const StepScope& scope)
{
    switch (scope.kind) {
        case StepScope::Kind::Selection:
            return ChainPanel::tr("what is selected then");
        case StepScope::Kind::Shown:
            return ChainPanel::tr("what is shown then");
        case StepScope::Kind::All:
            return ChainPanel::tr("all points");
        case StepScope::Kind::Classes:
        case StepScope::Kind::Condition:
            break;
    }
    return toQString(conditionOf(scope));
}

}  // namespace

ChainPanel::ChainPanel(Workspace& workspace, QWidget* parent)
    : QWidget(parent),
      m_workspace(workspace),
      m_list(new QListWidget),
      m_up(button(QStringLiteral("step-up"), tr("Earlier (Ctrl+Up)"))),
      m_down(button(QStringLiteral("step-down"), tr("Later (Ctrl+Down)"))),
      m_remove(button(QStringLiteral("close"), tr("Take out of the chain (Delete)"))),
      m_save(button(QStringLiteral("save"), tr("Save the chain as a recipe"))),
      m_load(button(QStringLiteral("open"), tr("Load a recipe"))),
      m_run(new QPushButton(tr("Run all")))
{
    m_list->setAccessibleName(tr("Chain of steps"));
    m_list->setIconSize(QSize(16, 16));
    m_list->setTextElideMode(Qt::ElideRight);
    m_list->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    m_list->setToolTip(tr("Steps that run one after another; a double click opens one"));
    m_run->setToolTip(
        tr("Run all steps of the chain, each of which can be undone. Cancel keeps the steps that are "
           "done as a whole, and nothing of the one that runs."));
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(10, 4, 10, 8);
    column->setSpacing(6);
    auto* row = new QHBoxLayout;
    row->setSpacing(0);
    row->addWidget(heading(tr("Chain")), 1);
    for (QToolButton* each : {m_up, m_down, m_remove, m_load, m_save}) row->addWidget(each);
    column->addLayout(row);
    column->addWidget(m_list);
    column->addWidget(m_run);
    connect(m_up, &QToolButton::clicked, this, [this] { move(-1); });
    connect(m_down, &QToolButton::clicked, this, [this] { move(1); });
    connect(m_remove, &QToolButton::clicked, this, &ChainPanel::removeCurrent);
    connect(m_run, &QPushButton::clicked, this, &ChainPanel::runWanted);
    connect(m_list, &QListWidget::currentRowChanged, this, &ChainPanel::take);
    connect(m_list, &QListWidget::itemActivated, this, [this] { emit chosen(m_list->currentRow()); });
    const auto shortcut = [this](const QKeySequence& keys, auto act) {
        auto* made = new QShortcut(keys, m_list);
        made->setContext(Qt::WidgetShortcut);
        connect(made, &QShortcut::activated, this, act);
    };
    shortcut(QKeySequence(Qt::CTRL | Qt::Key_Up), [this] { move(-1); });
    shortcut(QKeySequence(Qt::CTRL | Qt::Key_Down), [this] { move(1); });
    shortcut(QKeySequence(Qt::Key_Delete), [this] { removeCurrent(); });
    const QString kinds = tr("Recipe (*.json)");
    connect(m_save, &QToolButton::clicked, this, [this, kinds] {
        QString path =
            QFileDialog::getSaveFileName(this, tr("Save the chain"), QStringLiteral("recipe.json"), kinds);
        if (!path.isEmpty()) saveTo(path);
    });
    connect(m_load, &QToolButton::clicked, this, [this, kinds] {
        const QString path = QFileDialog::getOpenFileName(this, tr("Load a recipe"), {}, kinds);
        if (!path.isEmpty()) loadFrom(path);
    });
    fill();
}

QToolButton* ChainPanel::button(const QString& icon, const QString& tip)
{
    auto* made = new QToolButton;
    made->setIcon(lineIcon(icon));
    made->setIconSize(QSize(16, 16));
    made->setToolTip(tip);
    made->setAccessibleName(tip);
    made->setFocusPolicy(Qt::StrongFocus);
    return made;
}

void ChainPanel::add(StepWish wish)
{
    m_chain.push_back(std::move(wish));
    fill();
    m_list->setCurrentRow(m_list->count() - 1);
}

void ChainPanel::setChain(std::vector<StepWish> chain)
{
    m_chain = std::move(chain);
    fill();
}

void ChainPanel::setBusy(bool busy)
{
    m_busy = busy;
    take();
}

void ChainPanel::setCurrent(int row)
{
    for (int k = 0; k < m_list->count(); ++k) {
        QFont font = m_list->font();
        font.setBold(k == row);
        m_list->item(k)->setFont(font);
    }
}

void ChainPanel::fill()
{
    const int row = m_list->currentRow();
    m_list->clear();
    for (const StepWish& wish : m_chain) {
        auto* item = new QListWidgetItem(stepIcon(*findStep(wish.step)), describe(wish), m_list);
        item->setToolTip(tr("%1\nChanges: %2").arg(describe(wish), scopeText(wish.scope)));
    }
    m_list->setCurrentRow(std::clamp(row, m_chain.empty() ? -1 : 0, int(m_chain.size()) - 1));
    const int rows = std::clamp(int(m_chain.size()), 1, kMostShownSteps);
    m_list->setFixedHeight(rows * (QFontMetrics(m_list->font()).height() + 8) + 6);
    m_list->setVisible(!m_chain.empty());
    take();
}

void ChainPanel::take()
{
    const int row = m_list->currentRow();
    m_up->setEnabled(!m_busy && row > 0);
    m_down->setEnabled(!m_busy && row >= 0 && row + 1 < m_list->count());
    m_remove->setEnabled(!m_busy && row >= 0);
    m_save->setEnabled(!m_busy && !m_chain.empty());
    m_load->setEnabled(!m_busy);
    m_run->setVisible(!m_chain.empty());
    m_run->setEnabled(!m_busy);
    for (QToolButton* each : {m_up, m_down, m_remove, m_save}) each->setVisible(!m_chain.empty());
}

void ChainPanel::move(int by)
{
    const int row = m_list->currentRow(), to = row + by;
    if (m_busy || row < 0 || to < 0 || to >= int(m_chain.size())) return;
    std::swap(m_chain[std::size_t(row)], m_chain[std::size_t(to)]);
    fill();
    m_list->setCurrentRow(to);
}

void ChainPanel::removeCurrent()
{
    const int row = m_list->currentRow();
    if (m_busy || row < 0 || row >= int(m_chain.size())) return;
    m_chain.erase(m_chain.begin() + row);
    fill();
}

void ChainPanel::saveTo(const QString& path)
{
    QByteArray recipe;
    try {
        recipe = toRecipe(m_chain);
    } catch (const Error& e) {
        emit failed(toQString(std::string(e.what())));
        return;
    }
    m_workspace.startJob(
        tr("Save the chain"),
        [path, recipe](Progress&) {
            QSaveFile file(path);
            if (!file.open(QIODevice::WriteOnly) || file.write(recipe) != recipe.size() || !file.commit())
                throw Error("The recipe cannot be written: " + file.errorString().toStdString() + ".");
        },
        [this](const JobInfo& info) {
            if (info.state == JobState::Failed) emit failed(toQString(info.error));
        },
        true);
}

void ChainPanel::loadFrom(const QString& path)
{
    constexpr qint64 kMostBytes = 1 << 20;
    const auto found = std::make_shared<std::vector<StepWish>>();
    m_workspace.startJob(
        tr("Load a recipe"),
        [path, found](Progress&) {
            QFile file(path);
            if (!file.open(QIODevice::ReadOnly))
                throw Error("The recipe cannot be read: " + file.errorString().toStdString() + ".");
            if (file.size() > kMostBytes) throw Error("This is no recipe: it is larger than 1 MB.");
            *found = fromRecipe(file.readAll());
        },
        [this, found](const JobInfo& info) {
            if (info.state == JobState::Failed) emit failed(toQString(info.error));
            if (info.state == JobState::Finished) setChain(std::move(*found));
        },
        true);
}

}  // namespace punctum::ui
