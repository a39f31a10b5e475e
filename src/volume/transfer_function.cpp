#include "volume/transfer_function.hpp"

#include <algorithm>
#include <cmath>

namespace apeiron::volume {
namespace {

/// Part of a shape's opacity at a place, 0 to 1.
double coverage(const TransferShape& shape, double value, double gradient) {
    const glm::dvec2 offset = (glm::dvec2(value, gradient) - shape.center) / (0.5 * shape.size);
    switch (shape.kind) {
    case TransferShape::Kind::Box:
        return std::max(std::abs(offset.x), std::abs(offset.y)) <= 1.0 ? 1.0 : 0.0;
    case TransferShape::Kind::Gaussian:
        return std::exp(-0.5 * glm::dot(offset, offset));
    case TransferShape::Kind::Triangle: {
        const double up = 0.5 * (offset.y + 1.0); // 0 at the apex, 1 at the upper edge
        if (up <= 0.0 || up > 1.0) return 0.0;
        return std::max(0.0, 1.0 - std::abs(offset.x) / up);
    }
    }
    return 0.0;
}

TransferPoint between(const std::vector<TransferPoint>& points, double value) {
    if (points.empty()) return {value, glm::dvec3(1.0), 0.0, 0.0};
    const auto above = std::upper_bound(points.begin(), points.end(), value,
                                        [](double v, const TransferPoint& point) { return v < point.value; });
    if (above == points.begin()) return points.front();
    const TransferPoint& a = *(above - 1);
    if (above == points.end()) return a;
    const TransferPoint& b = *above;
    const double t = (value - a.value) / (b.value - a.value);
    const auto mix = [t](double x, double y) { return x + (y - x) * t; };
    return {value, glm::mix(a.color, b.color, t), mix(a.opacity, b.opacity), mix(a.emission, b.emission)};
}

/// From 0..1 across the window to values.
struct Scale {
    double low = 0.0;
    double high = 1.0;
    double gradient = 1.0;
};

Scale scaleOf(const TransferFunction& function, const DataRange& range) {
    switch (function.window) {
    case TransferFunction::Window::None:
        break;
    case TransferFunction::Window::Given:
        return {function.level - 0.5 * function.width, function.level + 0.5 * function.width, range.gradientHigh};
    case TransferFunction::Window::Data:
        return {range.low, range.high, range.gradientHigh};
    }
    return {};
}

} // namespace

TransferPoint evaluate(const TransferFunction& function, double value, double gradient) {
    const TransferPoint base = between(function.points, value);
    if (function.shapes.empty()) return base;
    double opacity = base.opacity;
    glm::dvec3 color = base.color * base.opacity;
    double weightless = base.emission; // of emission, for the colour of what glows without being there
    glm::dvec3 glow = base.color * base.emission;
    for (const TransferShape& shape : function.shapes) {
        const double part = coverage(shape, value, gradient);
        opacity += part * shape.opacity;
        color += part * shape.opacity * shape.color;
        weightless += part * shape.emission;
        glow += part * shape.emission * shape.color;
    }
    TransferPoint sum = base;
    sum.value = value;
    sum.opacity = std::min(opacity, 1.0);
    if (opacity > 0.0)
        sum.color = color / opacity;
    else if (weightless > 0.0)
        sum.color = glow / weightless;
    sum.emission = weightless;
    return sum;
}

TransferFunction inValueUnits(const TransferFunction& function, const DataRange& range) {
    TransferFunction result = function;
    if (function.window == TransferFunction::Window::None) return result;
    const Scale scale = scaleOf(function, range);
    result.window = TransferFunction::Window::None;
    for (TransferPoint& point : result.points)
        point.value = scale.low + (scale.high - scale.low) * point.value;
    const glm::dvec2 unit(scale.high - scale.low, scale.gradient);
    for (TransferShape& shape : result.shapes) {
        shape.center = glm::dvec2(scale.low, 0.0) + unit * shape.center;
        shape.size *= unit;
    }
    return result;
}

TransferTable transferTable(const TransferFunction& function, const DataRange& range, bool square) {
    const TransferFunction absolute = inValueUnits(function, range);
    TransferTable table;
    table.width = square ? kTransferSquare : kTransferValues;
    table.height = square ? kTransferSquare : 1;
    table.gradientHigh = std::max(range.gradientHigh, 1e-30);
    table.low = range.minimum;
    table.high = range.maximum;
    if (absolute.shapes.empty() && !absolute.points.empty()) {
        // Beyond its points the function is constant. (A domain that misses the data has its nearest end.)
        table.low = std::clamp(absolute.points.front().value, range.minimum, range.maximum);
        table.high = std::clamp(absolute.points.back().value, range.minimum, range.maximum);
    }
    for (const TransferShape& shape : absolute.shapes) // a steeper gradient than the data's own scale may be meant
        if (shape.kind != TransferShape::Kind::Gaussian)
            table.gradientHigh = std::max(table.gradientHigh, shape.center.y + 0.5 * shape.size.y);
    // A window without width has one: a part of the data's range that floats can divide by, and multiply gradients
    // with.
    const double extent = range.maximum > range.minimum ? range.maximum - range.minimum : 1.0;
    const double narrowest = 1e-6 * std::max({extent, std::abs(table.low), 1e-20});
    if (!(table.high - table.low > narrowest)) table.high = table.low + narrowest;

    const auto texels = static_cast<std::size_t>(table.width) * static_cast<std::size_t>(table.height);
    table.rgba.resize(4 * texels);
    std::vector<float> emission(3 * texels);
    bool glows = false;
    std::size_t texel = 0;
    for (int y = 0; y < table.height; ++y) {
        const double gradient = table.height == 1 ? 0.0 : table.gradientHigh * y / (table.height - 1.0);
        for (int x = 0; x < table.width; ++x, ++texel) {
            const double value = table.low + (table.high - table.low) * x / (table.width - 1.0);
            const TransferPoint point = evaluate(absolute, value, gradient);
            for (int c = 0; c < 3; ++c) {
                table.rgba[4 * texel + static_cast<std::size_t>(c)] = static_cast<float>(point.color[c]);
                emission[3 * texel + static_cast<std::size_t>(c)] = static_cast<float>(point.color[c] * point.emission);
            }
            table.rgba[4 * texel + 3] = static_cast<float>(point.opacity);
            glows = glows || point.emission > 0.0;
        }
    }
    if (glows) table.emission = std::move(emission);
    return table;
}

std::vector<TransferTable> transferTables(std::span<const TransferFunction> functions,
                                          std::span<const DataRange> ranges) {
    const bool square = std::any_of(functions.begin(), functions.end(),
                                    [](const TransferFunction& function) { return function.twoDimensional(); });
    std::vector<TransferTable> tables;
    for (std::size_t channel = 0; channel < ranges.size(); ++channel)
        tables.push_back(transferTable(functions[std::min(channel, functions.size() - 1)], ranges[channel], square));
    return tables;
}

} // namespace apeiron::volume
