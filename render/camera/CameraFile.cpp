// SPDX-License-Identifier: MIT
#include "render/camera/CameraFile.h"

#include "core/Error.h"

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <numbers>

namespace punctum::render
{

namespace
{

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;

double numberOf(const std::string& key, const Json& value, double low, double high)
{
    if (!value.is_number()) throw Error("\"" + key + "\" must be a number.");
    const double number = value.get<double>();
    if (!(number >= low && number <= high))
        throw Error("\"" + key + "\" must be from " + Json(low).dump() + " to " + Json(high).dump() + ".");
    return number;
}

glm::dvec3 positionOf(const std::string& key, const Json& value)
{
    if (!value.is_array() || value.size() != 3) throw Error("\"" + key + "\" must be three numbers, [x, y, z].");
    glm::dvec3 position;
    for (int axis = 0; axis < 3; ++axis) position[axis] = numberOf(key, value[std::size_t(axis)], -1e15, 1e15);
    return position;
}

}  // namespace

Camera readCamera(std::string_view text, const Camera& fitted, const WorldBounds& bounds, glm::dvec2 sizePx)
{
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) throw Error("This is not a camera: a JSON object with \"eye\", \"yaw\", \"pitch\".");

    Camera camera = fitted;
    bool eye = false;
    bool pivot = false;
    for (const auto& [key, value] : json.items()) {
        if (key == "eye") {
            camera.eye = positionOf(key, value);
            eye = true;
        } else if (key == "pivot") {
            camera.pivot = positionOf(key, value);
            pivot = true;
        } else if (key == "yaw") {
            camera.yaw = numberOf(key, value, -3600, 3600) * kDegree;
        } else if (key == "pitch") {
            camera.pitch = numberOf(key, value, -90, 90) * kDegree;
        } else if (key == "fov") {
            camera.fovY = numberOf(key, value, 1, 150) * kDegree;
        } else if (key == "orthographic") {
            if (!value.is_boolean()) throw Error("\"orthographic\" must be true or false.");
            camera.orthographic = value.get<bool>();
        } else {
            throw Error("A camera has no key \"" + key + "\"; it has eye, yaw, pitch, fov, pivot, orthographic.");
        }
    }
    if (pivot && !eye) throw Error("A camera with \"pivot\" needs \"eye\" too.");
    if (!eye)
        camera.fit(bounds, sizePx);
    else if (!pivot)
        // as far ahead as the clouds' middle is, so that a parallel picture has a sensible size
        camera.pivot = camera.eye + camera.forward() / camera.stretch *
                                        std::max(1e-3, glm::length((camera.eye - fitted.pivot) * camera.stretch));
    return camera;
}

Camera readCameraFile(const std::filesystem::path& path, const Camera& fitted, const WorldBounds& bounds,
                      glm::dvec2 sizePx)
{
    std::ifstream file(path);
    if (!file) throw Error(path, "The camera file could not be read; does it exist?");
    // A camera takes some hundred bytes; of what is no camera at all, no more is read than tells so.
    constexpr std::size_t kMost = std::size_t(1) << 20;
    std::string text(kMost, '\0');
    file.read(text.data(), std::streamsize(text.size()));
    text.resize(std::size_t(file.gcount()));
    try {
        return readCamera(text, fitted, bounds, sizePx);
    } catch (const Error& wrong) {
        throw Error(path, wrong.what());
    }
}

std::string cameraText(const Camera& camera)
{
    const Json json{{"eye", {camera.eye.x, camera.eye.y, camera.eye.z}},
                    {"yaw", camera.yaw / kDegree},
                    {"pitch", camera.pitch / kDegree},
                    {"fov", camera.fovY / kDegree},
                    {"pivot", {camera.pivot.x, camera.pivot.y, camera.pivot.z}},
                    {"orthographic", camera.orthographic}};
    return json.dump(2) + '\n';
}

}  // namespace punctum::render
