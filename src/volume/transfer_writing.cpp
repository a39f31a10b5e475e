#include "volume/transfer_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

// Transfer functions to JSON.
namespace apeiron::volume {
namespace {

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055; // IEC 61966-2-1
}

/// "#rrggbb" where that is exact, as it is for what was written so; else three numbers.
Json colorJson(const glm::dvec3& color) {
    std::string text = "#";
    Json parts = Json::array();
    bool exact = true;
    for (int c = 0; c < 3; ++c) {
        const double part = std::clamp(srgb(color[c]), 0.0, 1.0);
        const long byte = std::lround(255.0 * part);
        exact = exact && std::abs(255.0 * part - static_cast<double>(byte)) < 1e-6;
        text += fmt::format("{:02x}", byte);
        parts.push_back(part);
    }
    return exact ? Json(text) : parts;
}

void addLight(Json& json, const glm::dvec3& color, double opacity, double emission) {
    json["color"] = colorJson(color);
    json["opacity"] = opacity;
    if (emission > 0.0) json["emission"] = emission;
}

} // namespace

Json toJson(const TransferFunction& function) {
    Json json = Json::object();
    switch (function.window) {
    case TransferFunction::Window::None:
        json["window"] = "none";
        break;
    case TransferFunction::Window::Given:
        json["window"] = {{"level", function.level}, {"width", function.width}};
        break;
    case TransferFunction::Window::Data:
        json["window"] = "data";
        break;
    }
    json["points"] = Json::array();
    for (const TransferPoint& point : function.points) {
        Json one = {{"value", point.value}};
        addLight(one, point.color, point.opacity, point.emission);
        json["points"].push_back(std::move(one));
    }
    if (function.shapes.empty()) return json;
    json["shapes"] = Json::array();
    for (const TransferShape& shape : function.shapes) {
        constexpr std::array kNames{"box", "gaussian", "triangle"};
        Json one = {{"type", kNames[static_cast<std::size_t>(shape.kind)]},
                    {"center", {shape.center.x, shape.center.y}},
                    {"size", {shape.size.x, shape.size.y}}};
        addLight(one, shape.color, shape.opacity, shape.emission);
        json["shapes"].push_back(std::move(one));
    }
    return json;
}

} // namespace apeiron::volume
