// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "ui/view/ViewRenderer.h"

#include <QPointer>
#include <QWidget>

#include <optional>
#include <vector>

class QVariantAnimation;

namespace punctum::ui
{

class ClipFrame;
class CompassOverlay;
class Document;
class DropHint;
class StartPage;
class LegendOverlay;
class MessageArea;
class PivotMark;
class TitleOverlay;
class ViewNavigator;
class ViewSettings;
class ViewSurface;

/// MIME type of an attribute that is dragged: its name in UTF-8.
inline constexpr char kAttributeMimeType[] = "application/x-punctum-attribute";

/// The view: shows the render thread's newest picture, owns the camera, and turns mouse and drops into what they
/// mean; ViewNavigator moves the camera.
///
/// GUI thread only. Borrows renderer and settings, which must outlive it.
class Viewport final : public QWidget
{
    Q_OBJECT
public:
    Viewport(ViewRenderer& renderer, ViewSettings& settings, bool openGl, QWidget* parent = nullptr);
    ~Viewport() override;

    ViewRenderer& renderer() noexcept { return m_renderer; }
    /// An elevation: every drag moves the picture and nothing turns it; without title, legend and compass, which
    /// the view beside it has.
    void setFlat();
    /// Planes that cut this view alone, beside the settings' clip.
    void setCuts(std::vector<ClipPlane> cuts);
    const std::vector<ClipPlane>& cuts() const noexcept { return m_cuts; }
    /// What it shows, with `scale` px of the picture for each logical px.
    render::DisplaySettings displayFor(double scale) const;
    /// Whether the cuts let a place be seen.
    bool keeps(const glm::dvec3& world) const noexcept;

    const render::Camera& camera() const noexcept { return m_camera; }
    /// Counts what the user did to the camera: a fit by the program must not undo it.
    std::uint64_t userMoves() const noexcept { return m_userMoves; }
    void setCamera(const render::Camera& camera, bool animated = false);
    /// Ends a flight where it is: what is drawn on the picture must not find another one.
    void holdCamera();
    /// The box of all that is open; what fit() and the first view go by. `stretch`: of cameras from the next fit
    /// on.
    void setSceneBounds(const WorldBounds& bounds, const glm::dvec3& stretch);
    /// Whether it shows all, as no one has moved the camera since.
    bool fitted() const noexcept { return m_fitted; }
    /// Shows all of it, and goes on doing so when the size changes, until the user moves the camera.
    void fit(bool animated = true) { fitTo(m_bounds, animated); }
    /// The same with a part of it.
    void fitTo(const WorldBounds& bounds, bool animated = true);
    /// "top", "front", ... keeping the pivot, then fitted. All but "iso", which keeps the projection, are
    /// orthographic.
    void setStandardView(const QString& name);
    /// The same direction and projection, with the pivot in the middle at the scale that it has.
    void lookFrom(const QString& name);
    /// Orthographic or perspective: at the pivot's depth all stays where it is, as large as it is.
    void setOrthographic(bool on);
    /// Flies where the user wants to be.
    void flyTo(const render::Camera& camera);
    /// Makes a place the pivot in the middle, at the scale of now, and marks it for some seconds.
    void goTo(const glm::dvec3& world);

    /// The document that title and legend speak of; null: nothing is open.
    void setDocument(Document* document, int documents);
    /// The point under the mouse may have other values.
    void hoverAnew()
    {
        if (m_mouseInside) requestHover();
    }
    /// Reads state and progress of the document anew.
    void updateTitle();

    /// A panel that is kept under the title.
    void setUnderTitle(QWidget* panel) { m_underTitle = panel; }
    /// A panel for the upper right corner, shown while something is open and the view has room for it.
    void setCorner(QWidget* panel) { m_corner = panel; }
    void showCorner(bool shown);

    MessageArea& messages() noexcept { return *m_messages; }
    ClipFrame& clipFrame() noexcept { return *m_clipFrame; }
    const LegendOverlay& legend() const noexcept { return *m_legend; }
    const DropHint& dropHint() const noexcept { return *m_dropHint; }
    /// Says over the whole view what dropping would do.
    void showDropHint(const QString& text);
    void hideDropHint();
    StartPage& startPage() noexcept { return *m_startPage; }
    bool usesOpenGl() const;
    /// Size of the picture in px: logical size times the screen's ratio.
    QSize pictureSize() const;
    /// px of the picture for each logical px.
    double pixelRatio() const noexcept { return m_pixelRatio; }
    /// From a position in the widget.
    glm::dvec2 toPicture(QPointF position) const;

signals:
    void attributeDropped(const QString& name);
    /// What is under the cursor; nothing when that is background or the mouse left.
    void hovered(const std::optional<punctum::ui::PickedPoint>& point);
    void cameraChanged();
    void frameShown();

protected:
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dragLeaveEvent(QDragLeaveEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    bool event(QEvent* event) override;

private:
    /// Unit of what the camera sees; empty: unknown.
    QString viewUnit() const;
    void applyCamera(const render::Camera& camera);
    void moveTo(const render::Camera& camera, bool animated);
    /// Where it is, or flies to.
    const render::Camera& heading() const;
    /// Looks from a standard view's direction; false for a name that is none.
    static bool turnTo(render::Camera& camera, const QString& name);
    void userCamera(const render::Camera& camera);
    void takeFrame();
    void sendDisplay();
    void sendSize();
    void placeOverlays();
    void placeCorner();
    void placeMessages();
    void updateLegend();
    void requestHover();

    ViewRenderer& m_renderer;
    ViewSettings& m_settings;
    ViewSurface* m_surface = nullptr;  ///< a child widget
    ClipFrame* m_clipFrame = nullptr;
    PivotMark* m_pivotMark = nullptr;
    ViewNavigator* m_navigator = nullptr;
    TitleOverlay* m_title = nullptr;
    QWidget* m_underTitle = nullptr;
    QWidget* m_corner = nullptr;
    bool m_cornerShown = true;
    LegendOverlay* m_legend = nullptr;
    CompassOverlay* m_compass = nullptr;
    StartPage* m_startPage = nullptr;
    DropHint* m_dropHint = nullptr;
    MessageArea* m_messages = nullptr;
    QVariantAnimation* m_flight = nullptr;
    QPointer<Document> m_document;
    int m_documents = 0;
    std::shared_ptr<const Frame> m_frame;

    render::Camera m_camera, m_flightStart, m_flightEnd;
    WorldBounds m_bounds;
    glm::dvec3 m_stretch{1.0};
    WorldBounds m_fitBounds;  ///< what was fitted last
    std::uint64_t m_userMoves = 0;
    bool m_fitted = false;
    bool m_flat = false;
    std::vector<ClipPlane> m_cuts;
    double m_pixelRatio = 1.0;

    QPointF m_mouse;
    bool m_mouseInside = false;
    bool m_hoverAsked = false;  ///< a pick for the read-out is on its way
    bool m_hoverAgain = false;  ///< and the mouse has moved since
};

}  // namespace punctum::ui
