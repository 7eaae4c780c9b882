// SPDX-License-Identifier: MIT
#pragma once

#include "render/color/ColorMap.h"
#include "render/color/Tone.h"
#include "render/store/AttributeEncoder.h"

#include <glm/vec3.hpp>

#include <vector>

namespace punctum::render
{

/// How one layer's words become colors.
struct LayerColors {
    WordKind kind = WordKind::Scalar;
    float low = 0.0f;     ///< Scalar: value - bias that gets the first color of the map
    float high = 1.0f;    ///< Scalar: value - bias that gets the last
    bool marked = false;  ///< selected points are: see selectedBit()
    friend bool operator==(const LayerColors&, const LayerColors&) = default;
};

/// What is shown of directions.
enum class NormalLook {
    Lit,        ///< a gray surface, lit by a lamp above and left of the eye; both of its sides
    Direction,  ///< x, y and z as red, green and blue
};

/// Eye-dome lighting, see EyeDome.h.
struct EyeDomeSettings {
    float strength = 0.0f;    ///< 1 as usual; 0: none
    bool perspective = true;  ///< of the view
    int reach = 1;            ///< px that neighbors are looked for at, and twice that
    float extent = 0.0f;      ///< of levels that makes a sample dark; 0: what the picture has
    bool on() const noexcept { return strength > 0.0f; }
    friend bool operator==(const EyeDomeSettings&, const EyeDomeSettings&) = default;
};

/// All that decides colors; changing it touches no point.
struct ResolveSettings {
    std::vector<LayerColors> layers;       ///< one for each layer of the scene
    ColorTable colorMap{};                 ///< Scalar
    ColorTable palette{};                  ///< Class
    ColorTable tone = toneTable({});       ///< Color: what each value of a channel becomes
    NormalLook normals = NormalLook::Lit;  ///< Normal
    glm::vec3 eye{0, 0, -1};               ///< Normal: where one looks, of length 1
    glm::vec3 light{0, 0, -1};             ///< Normal: where the lamp shines, of length 1
    Rgba8 noValue{128, 128, 128, 255};
    Rgba8 backgroundTop{38, 44, 52, 255};  ///< alpha 0 in both: transparent
    Rgba8 backgroundBottom{16, 18, 22, 255};
    struct Rows {
        int first = 0;  ///< of the background that lies behind the picture's first row
        int count = 0;  ///< of the whole background; 0: as many as the picture has
        friend bool operator==(const Rows&, const Rows&) = default;
    } rows;
    bool means = false;       ///< samples show what Shading::addColors() added up, where it did
    bool closeHoles = false;  ///< see HoleFill.h
    EyeDomeSettings eyeDome;

    /// Of these, what the color of a single point depends on.
    ResolveSettings ofPoints() const
    {
        ResolveSettings s = *this;
        s.backgroundTop = s.backgroundBottom = {};
        s.rows = {};
        s.means = s.closeHoles = false;
        s.eyeDome = {};
        return s;
    }
    friend bool operator==(const ResolveSettings&, const ResolveSettings&) = default;
};

/// Selected points have this color, and a little of their own: one that no color map comes near.
inline constexpr Rgba8 kSelectedColor{255, 0, 255, 255};

/// The color of one word: the reference that every backend follows.
inline Rgba8 colorOf(std::uint32_t word, const LayerColors& layer, const ResolveSettings& settings) noexcept;

}  // namespace punctum::render

#include "render/scene/colorOf.inl"
