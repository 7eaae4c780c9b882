// SPDX-License-Identifier: MIT
// A camera file: a camera that can be looked through, or one sentence; written and read again it is the same.
#include "render/camera/CameraFile.h"
#include "tests/fuzz/Fuzz.h"

#include <cmath>
#include <numbers>

using namespace punctum;
using fuzz::promise;

namespace
{

bool finite(const glm::dvec3& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool near(double a, double b)
{
    return std::abs(a - b) <= 1e-12 * std::max({1.0, std::abs(a), std::abs(b)});
}

bool near(const render::Camera& a, const render::Camera& b)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!near(a.eye[axis], b.eye[axis]) || !near(a.pivot[axis], b.pivot[axis])) return false;
    return near(a.yaw, b.yaw) && near(a.pitch, b.pitch) && near(a.fovY, b.fovY) && a.orthographic == b.orthographic;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static fuzz::MemoryFile memory;
    const WorldBounds bounds{glm::dvec3(1000, 2000, 30), glm::dvec3(1100, 2050, 60)};
    const glm::dvec2 sizePx(640, 480);
    render::Camera fitted;
    fitted.fit(bounds, sizePx);
    memory.set({reinterpret_cast<const std::byte*>(data), size});
    try {
        const render::Camera camera = render::readCameraFile(memory.path(), fitted, bounds, sizePx);
        promise(finite(camera.eye) && finite(camera.pivot) && std::isfinite(camera.yaw), "a camera is somewhere");
        promise(camera.fovY > 0 && camera.fovY < std::numbers::pi, "it sees something");
        const std::string written = render::cameraText(camera);
        memory.set(std::as_bytes(std::span(written)));
        promise(near(render::readCameraFile(memory.path(), fitted, bounds, sizePx), camera),
                "a camera that is written reads as the same one");
    } catch (const Error& e) {
        fuzz::checkSentence(e);
    }
    return 0;
}
