// SPDX-License-Identifier: MIT
#include "ui/style/Icons.h"

#include <QFile>
#include <QGuiApplication>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QRegularExpression>
#include <QXmlStreamReader>

#include <algorithm>

void initPunctumIcons()
{
    // The icons are in a static library: without this the linker leaves them out.
    Q_INIT_RESOURCE(icons);
}

namespace punctum::ui
{

namespace
{

constexpr qreal kGrid = 24.0;
constexpr qreal kStroke = 1.6;

/// The commands M L H V C Q Z and their relative forms (SVG 1.1, section 8.3).
QPainterPath readPath(const QString& text)
{
    static const QRegularExpression token(QStringLiteral("[A-Za-z]|-?[0-9]*\\.?[0-9]+"));
    QPainterPath path;
    QChar command = QLatin1Char('M');
    std::vector<qreal> numbers;
    const auto flush = [&] {
        const bool relative = command.isLower();
        const auto at = [&](std::size_t i) {
            return QPointF(numbers[i], numbers[i + 1]) + (relative ? path.currentPosition() : QPointF());
        };
        const QChar kind = command.toUpper();
        const std::size_t needs = kind == QLatin1Char('C')                               ? 6
                                  : kind == QLatin1Char('Q')                             ? 4
                                  : kind == QLatin1Char('H') || kind == QLatin1Char('V') ? 1
                                                                                         : 2;
        if (numbers.size() < needs) return false;
        const QPointF here = path.currentPosition();
        switch (kind.toLatin1()) {
            case 'M':
                path.moveTo(at(0));
                break;
            case 'L':
                path.lineTo(at(0));
                break;
            case 'H':
                path.lineTo(numbers[0] + (relative ? here.x() : 0.0), here.y());
                break;
            case 'V':
                path.lineTo(here.x(), numbers[0] + (relative ? here.y() : 0.0));
                break;
            case 'C':
                path.cubicTo(at(0), at(2), at(4));
                break;
            case 'Q':
                path.quadTo(at(0), at(2));
                break;
            default:
                return false;
        }
        numbers.clear();
        return true;
    };
    for (auto it = token.globalMatch(text); it.hasNext();) {
        const QString part = it.next().captured();
        if (part[0].isLetter()) {
            command = part[0];
            numbers.clear();
            if (command.toUpper() == QLatin1Char('Z')) path.closeSubpath();
        } else {
            numbers.push_back(part.toDouble());
            flush();
        }
    }
    return path;
}

void paintShapes(QPainter& painter, const std::vector<IconShape>& shapes, const QRectF& target, const QColor& color)
{
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    const qreal side = std::min(target.width(), target.height());
    painter.translate(target.center() - QPointF(side, side) / 2.0);
    painter.scale(side / kGrid, side / kGrid);
    const QPen pen(color, kStroke, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin);
    for (const IconShape& shape : shapes) {
        painter.setPen(shape.filled ? QPen(Qt::NoPen) : pen);
        painter.setBrush(shape.filled ? QBrush(color) : QBrush(Qt::NoBrush));
        painter.drawPath(shape.path);
    }
    painter.restore();
}

class LineIconEngine final : public QIconEngine
{
public:
    LineIconEngine(std::vector<IconShape> shapes, QColor fixed) : m_shapes(std::move(shapes)), m_fixed(fixed) {}

    void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override
    {
        paintShapes(*painter, m_shapes, rect, color(mode));
    }
    QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override
    {
        QPixmap pixmap(size);
        if (pixmap.isNull()) return pixmap;  // some styles ask for the icon that a tab does not have
        pixmap.fill(Qt::transparent);
        QPainter painter(&pixmap);
        paint(&painter, QRect(QPoint(), size), mode, state);
        return pixmap;
    }
    QIconEngine* clone() const override { return new LineIconEngine(*this); }
    QString key() const override { return QStringLiteral("punctum-line"); }

private:
    QColor color(QIcon::Mode mode) const
    {
        const QPalette palette = QGuiApplication::palette();
        if (mode == QIcon::Disabled) return palette.color(QPalette::Disabled, QPalette::WindowText);
        return m_fixed.isValid() ? m_fixed : palette.color(QPalette::Active, QPalette::WindowText);
    }

    std::vector<IconShape> m_shapes;
    QColor m_fixed;
};

}  // namespace

std::vector<IconShape> readSvgShapes(const QByteArray& svg)
{
    std::vector<IconShape> shapes;
    QXmlStreamReader xml(svg);
    while (!xml.atEnd()) {
        if (xml.readNext() != QXmlStreamReader::StartElement) continue;
        const QXmlStreamAttributes values = xml.attributes();
        const auto number = [&](const char* name) { return values.value(QLatin1String(name)).toDouble(); };
        IconShape shape;
        shape.filled = values.value(QLatin1String("fill")) == QLatin1String("currentColor");
        if (xml.name() == QLatin1String("path")) {
            shape.path = readPath(values.value(QLatin1String("d")).toString());
        } else if (xml.name() == QLatin1String("circle")) {
            shape.path.addEllipse(QPointF(number("cx"), number("cy")), number("r"), number("r"));
        } else if (xml.name() == QLatin1String("rect")) {
            shape.path.addRoundedRect(QRectF(number("x"), number("y"), number("width"), number("height")),
                                      number("rx"), number("rx"));
        } else {
            continue;
        }
        if (!shape.path.isEmpty()) shapes.push_back(std::move(shape));
    }
    return xml.hasError() ? std::vector<IconShape>() : shapes;
}

std::vector<IconShape> iconShapes(const QString& name)
{
    initPunctumIcons();
    QFile file(QStringLiteral(":/icons/%1.svg").arg(name));  // in the program, not on a disk
    if (!file.open(QIODevice::ReadOnly)) return {};
    return readSvgShapes(file.readAll());
}

QIcon lineIcon(const QString& name)
{
    return QIcon(new LineIconEngine(iconShapes(name), QColor()));
}

QIcon lineIcon(const QString& name, const QColor& color)
{
    return QIcon(new LineIconEngine(iconShapes(name), color));
}

QIcon programIcon()
{
    QIcon icon;
    const std::vector<IconShape> shapes = iconShapes(QStringLiteral("cloud"));
    for (const int side : {16, 24, 32, 48, 64, 128, 256}) {
        QPixmap pixmap(side, side);
        pixmap.fill(Qt::transparent);
        QPainter painter(&pixmap);
        painter.setRenderHint(QPainter::Antialiasing);
        QLinearGradient gradient(0, 0, side, side);
        gradient.setColorAt(0.0, QColor(0x2f, 0x7d, 0xe1));
        gradient.setColorAt(1.0, QColor(0x1d, 0xa0, 0x8c));
        painter.setPen(Qt::NoPen);
        painter.setBrush(gradient);
        painter.drawRoundedRect(QRectF(0, 0, side, side), side * 0.22, side * 0.22);
        const qreal margin = side * 0.14;
        paintShapes(painter, shapes, QRectF(margin, margin, side - 2 * margin, side - 2 * margin), Qt::white);
        painter.end();
        icon.addPixmap(pixmap);
    }
    return icon;
}

}  // namespace punctum::ui
