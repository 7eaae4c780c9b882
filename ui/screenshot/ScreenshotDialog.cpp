// SPDX-License-Identifier: MIT
#include "ui/screenshot/ScreenshotDialog.h"

#include "ui/screenshot/Screenshots.h"
#include "ui/style/Widgets.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QPointer>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr QSize kPreview(420, 320);  // px
constexpr int kPreviewPause = 150;   // ms without a change, then a small picture is drawn
constexpr double kSquare = 8.0;      // px, of the pattern behind what is transparent
constexpr int kLeastSide = 16;       // px

/// In front of the pattern that stands for "transparent".
QPixmap onPattern(const QImage& picture, qreal ratio)
{
    QPixmap shown(picture.size());
    QPainter painter(&shown);
    const int square = std::max(1, int(std::lround(kSquare * ratio)));
    const QColor colors[] = {QColor(0xb4, 0xb8, 0xbd), QColor(0xd6, 0xd9, 0xdd)};
    for (int row = 0; row * square < picture.height(); ++row)
        for (int column = 0; column * square < picture.width(); ++column)
            painter.fillRect(column * square, row * square, square, square, colors[(row + column) % 2]);
    painter.drawImage(0, 0, picture);
    painter.end();
    shown.setDevicePixelRatio(ratio);
    return shown;
}

QSpinBox* sideField(const QString& name, int value)
{
    auto* const field = new QSpinBox;
    field->setRange(kLeastSide, kLargestSide);
    field->setValue(value);
    field->setSuffix(QStringLiteral(" px"));
    field->setAccelerated(true);
    field->setAccessibleName(name);
    field->setToolTip(name);
    return field;
}

}  // namespace

ScreenshotDialog::ScreenshotDialog(Screenshots& screenshots, const ScreenshotOptions& preset, QWidget* parent)
    : QDialog(parent),
      m_screenshots(screenshots),
      m_view(new QComboBox),
      m_sizes(new QComboBox),
      m_width(sideField(tr("Width of the picture"), preset.size.width())),
      m_height(sideField(tr("Height of the picture"), preset.size.height())),
      m_samples(new QComboBox),
      m_preview(new QLabel(tr("Drawing a small picture...")))
{
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("screenshot"));
    setWindowTitle(tr("Export screenshot"));
    auto* const form = new QFormLayout;
    form->setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    form->setHorizontalSpacing(16);
    form->setVerticalSpacing(9);
    addSize(*form, preset);
    addWhat(*form, preset);

    m_preview->setFixedSize(kPreview);
    m_preview->setAlignment(Qt::AlignCenter);
    m_preview->setProperty("dim", true);
    m_preview->setAccessibleName(tr("Small picture of what will be saved"));
    auto* const row = new QHBoxLayout;
    row->setSpacing(22);
    row->addLayout(form);
    row->addWidget(m_preview, 1);

    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    auto* const save = buttons->addButton(tr("&Save..."), QDialogButtonBox::AcceptRole);
    save->setProperty("primary", true);
    save->setDefault(true);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, this, [this] {
        const ScreenshotOptions chosen = options();
        accept();
        emit wanted(chosen);
    });
    auto* const column = new QVBoxLayout(this);
    column->setContentsMargins(20, 18, 20, 14);
    column->setSpacing(16);
    column->addLayout(row);
    column->addWidget(buttons);

    m_previewTimer.setSingleShot(true);
    m_previewTimer.setInterval(kPreviewPause);
    connect(&m_previewTimer, &QTimer::timeout, this, &ScreenshotDialog::drawPreview);
    fillSizes();
    change();
}

ScreenshotDialog::~ScreenshotDialog()
{
    if (m_job != 0) m_screenshots.cancel(m_job);
}

void ScreenshotDialog::addSize(QFormLayout& form, const ScreenshotOptions& preset)
{
    m_view->addItem(tr("Main view"));
    m_view->setAccessibleName(tr("View"));
    if (m_screenshots.hasSection()) {
        m_view->addItem(tr("Section"));
        m_view->setCurrentIndex(preset.section ? 1 : 0);
        form.addRow(tr("&View"), m_view);
        connect(m_view, &QComboBox::currentIndexChanged, this, [this](int index) {
            const QSize size = m_screenshots.viewSize(index == 1);
            m_width->setValue(size.width());
            m_height->setValue(size.height());
            fillSizes();
            change();
        });
    } else {
        m_view->setParent(this);
        m_view->hide();
    }
    m_sizes->setAccessibleName(tr("Size"));
    form.addRow(tr("Si&ze"), m_sizes);
    auto* const sides = new QHBoxLayout;
    sides->setSpacing(6);
    sides->addWidget(m_width, 1);
    sides->addWidget(dimLabel(QStringLiteral("×")));
    sides->addWidget(m_height, 1);
    form.addRow(QString(), sides);
    for (QSpinBox* side : {m_width, m_height})
        connect(side, &QSpinBox::valueChanged, this, [this] {
            const QSignalBlocker quiet(m_sizes);
            m_sizes->setCurrentIndex(std::max(m_sizes->findData(options().size), 0));
            change();
        });
    connect(m_sizes, &QComboBox::activated, this, &ScreenshotDialog::chooseSize);
    for (const int samples : {1, 4, 8, 16})
        m_samples->addItem(samples == 1 ? tr("1, edges in steps") : tr("%1, smooth edges").arg(samples), samples);
    m_samples->setCurrentIndex(std::max(m_samples->findData(preset.samples), 0));
    m_samples->setAccessibleName(tr("Samples a pixel"));
    m_samples->setToolTip(tr("More samples a pixel make smoother edges and take longer"));
    form.addRow(tr("Sa&mples a pixel"), m_samples);
    connect(m_samples, &QComboBox::currentIndexChanged, this, &ScreenshotDialog::change);
}

QCheckBox* ScreenshotDialog::addMark(const QString& text, const QString& tip, bool on)
{
    auto* const box = new QCheckBox(text);
    box->setToolTip(tip);
    box->setChecked(on);
    connect(box, &QCheckBox::toggled, this, &ScreenshotDialog::change);
    return box;
}

void ScreenshotDialog::addWhat(QFormLayout& form, const ScreenshotOptions& preset)
{
    m_legend = addMark(tr("&Legend"), tr("What the colors mean"), preset.legend);
    m_scaleBar = addMark(tr("Scale &bar"), tr("How long things are, at the depth of the pivot"), preset.scaleBar);
    m_northArrow = addMark(tr("&North arrow"), tr("Where north is"), preset.northArrow);
    m_ruler = addMark(tr("&Heights and distances"), tr("The lines and numbers of the section"), preset.ruler);
    m_measurements =
        addMark(tr("Measu&rements"), tr("Those that the view shows, with their values"), preset.measurements);
    m_transparent =
        addMark(tr("&Transparent background"),
                tr("Where there is no point, what the picture is laid on shows through"), preset.transparent);
    auto* const marks = new QVBoxLayout;
    marks->setSpacing(6);
    for (QCheckBox* box : {m_legend, m_scaleBar, m_northArrow, m_ruler, m_measurements}) marks->addWidget(box);
    form.addRow(tr("On the picture"), marks);
    form.addRow(tr("Behind it"), m_transparent);
}

void ScreenshotDialog::fillSizes()
{
    const QSize view = m_screenshots.viewSize(m_view->currentIndex() == 1);
    const QSignalBlocker quiet(m_sizes);
    m_sizes->clear();
    m_sizes->addItem(tr("Other"), QSize());
    const auto add = [this](const QString& name, QSize size) {
        if (size.width() <= kLargestSide && size.height() <= kLargestSide && m_sizes->findData(size) < 0)
            m_sizes->addItem(QStringLiteral("%1: %2 × %3").arg(name).arg(size.width()).arg(size.height()), size);
    };
    add(tr("As in the window"), view);
    add(tr("Twice as large"), view * 2);
    add(tr("Four times as large"), view * 4);
    add(tr("Full HD"), {1920, 1080});
    add(tr("4K"), {3840, 2160});
    add(tr("A4 across, 300 dpi"), {3508, 2480});
    add(tr("A3 across, 300 dpi"), {4961, 3508});
    m_sizes->setCurrentIndex(std::max(m_sizes->findData(QSize(m_width->value(), m_height->value())), 0));
}

void ScreenshotDialog::chooseSize(int index)
{
    const QSize size = m_sizes->itemData(index).toSize();
    if (size.isEmpty()) {
        m_width->setFocus();
        m_width->selectAll();
        return;
    }
    {
        const QSignalBlocker quietWidth(m_width), quietHeight(m_height);
        m_width->setValue(size.width());
        m_height->setValue(size.height());
    }
    change();
}

ScreenshotOptions ScreenshotDialog::options() const
{
    ScreenshotOptions options;
    options.section = m_view->currentIndex() == 1;
    options.size = QSize(m_width->value(), m_height->value());
    options.samples = m_samples->currentData().toInt();
    options.transparent = m_transparent->isChecked();
    options.legend = m_legend->isChecked();
    options.scaleBar = m_scaleBar->isChecked();
    options.northArrow = m_northArrow->isChecked();
    options.measurements = m_measurements->isChecked();
    options.ruler = m_ruler->isChecked();
    return options;
}

void ScreenshotDialog::change()
{
    const bool section = m_view->currentIndex() == 1;
    m_scaleBar->setVisible(!section);
    m_northArrow->setVisible(!section);
    m_ruler->setVisible(section);
    m_previewTimer.start();
}

void ScreenshotDialog::drawPreview()
{
    if (m_job != 0) m_screenshots.cancel(m_job);
    const ScreenshotOptions chosen = options();
    const qreal ratio = devicePixelRatioF();
    const QSize size = chosen.size.scaled(kPreview * ratio, Qt::KeepAspectRatio).expandedTo({1, 1});
    m_job = m_screenshots.preview(chosen, size,
                                  [this, guard = QPointer(this), ratio, asked = ++m_asked](const QImage& picture) {
                                      if (!guard || asked != m_asked) return;
                                      m_job = 0;
                                      m_preview->setPixmap(onPattern(picture, ratio));
                                      emit previewed();
                                  });
}

}  // namespace punctum::ui
