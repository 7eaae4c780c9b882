// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Recipe.h"
#include "core/expression/Rule.h"
#include "core/task/Jobs.h"

#include <QDockWidget>
#include <QPointer>

#include <array>
#include <memory>
#include <optional>

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QShortcut;

namespace punctum::ui
{

class Document;
class RuleField;
class RulePreview;
class Selection;
class ViewRenderer;
class ViewSettings;
class Workspace;
enum class MessageKind;

/// Changes what is selected: its class, or any attribute by a rule, which can be looked at first in color; and
/// selects by rule and by neighbors. Each change is one command that can be undone. GUI thread only.
class EditDock final : public QDockWidget
{
    Q_OBJECT
public:
    EditDock(Workspace& workspace, Selection& selection, ViewRenderer& renderer, const ViewSettings& settings,
             QWidget* parent = nullptr);

    void setDocument(Document* document);
    /// Gives the selected points the class; those of class `from` alone, when it is given.
    void setClass(unsigned to, std::optional<unsigned> from = {});
    /// Sets or clears the selected points' flag of that name, the standard's mark of points that were deleted.
    void setWithheld(bool withheld);
    /// Deletes the selected points: saving leaves them out.
    void deleteSelected();
    /// Takes back all that was deleted of the document, saved or not.
    void restoreDeleted();
    RuleField& rule() noexcept { return *m_rule; }
    QCheckBox& selectedOnly() noexcept { return *m_selectedOnly; }
    QPushButton& previewButton() noexcept { return *m_previewRule; }
    QPushButton& endPreviewButton() noexcept { return *m_endPreview; }
    QPushButton& previewClassButton() noexcept { return *m_previewClass; }
    QComboBox& fromClass() noexcept { return *m_from; }
    QComboBox& toClass() noexcept { return *m_to; }
    QPushButton& applyButton() noexcept { return *m_apply; }
    QPushButton& selectButton() noexcept { return *m_select; }
    /// What the last action said.
    QString resultText() const;

signals:
    /// A button of the panel has begun a change: what is typed next, such as Ctrl+Z, is not meant for the panel.
    void begun();

private:
    QWidget* makeClassPart();
    QWidget* makeRulePart();
    QWidget* makeNeighborPart();
    void fillClasses();
    void applyRule();
    void previewRule();
    void previewClass();
    /// Of the class part: what turns one class of the selected points, or all, into another.
    QString classRule(unsigned to, std::optional<unsigned> from) const;
    /// The class that alone is to change; none: all.
    std::optional<unsigned> chosenFrom() const;
    void preview(const QString& rule, std::shared_ptr<const PointSet> within);
    void followPreview(bool on);
    void selectByRule();
    void say(const QString& text);
    /// Says why nothing was done, over the view where the panel is not seen.
    void refuse(MessageKind kind, const QString& sentence);
    /// Says what is wrong with the text of the rule field, and marks the place.
    void sayWrong(const QString& sentence);
    void takeState();
    /// Puts into the field for the distance what suits the document, until the user writes something there.
    void presetDistance();
    void tellNeighbors(quint64 joined, quint64 left);
    /// The points that a rule may change, as the box says; null: all.
    std::shared_ptr<const PointSet> ruleScope() const;
    /// Says what is wrong with it, and gives nothing then.
    std::optional<expression::Rule> parsed(const QString& rule);
    void runRule(const QString& rule, std::shared_ptr<const PointSet> within, const QString& title);
    /// Does what the recipe says, and tells the result. `typed`: it is what stands in the rule field.
    void run(const Recipe& recipe, const QString& title, bool typed = false);
    /// Whether the document is there, and nothing else is being done.
    bool ready() const;
    /// The selected points; says so where there are none.
    std::shared_ptr<const PointSet> selected();

    Workspace& m_workspace;
    Selection& m_selection;
    QPointer<Document> m_document;
    QComboBox* m_from;
    QComboBox* m_to;
    QPushButton* m_previewClass;
    QPushButton* m_setClass;
    RuleField* m_rule;
    QCheckBox* m_selectedOnly;
    QPushButton* m_select;
    QPushButton* m_previewRule;
    QPushButton* m_apply;
    QDoubleSpinBox* m_distance;
    bool m_distanceIsOwn = false;  ///< the user has written it for this document
    QString m_asked;               ///< the distance that was last asked for, with its unit
    std::array<QPushButton*, 3> m_neighbors{};
    QLabel* m_result;
    RulePreview* m_preview;
    std::shared_ptr<const PointSet> m_previewed;  ///< the selection when the preview began
    QPushButton* m_endPreview;
    QShortcut* m_escape;
    JobId m_job = 0;
};

}  // namespace punctum::ui
