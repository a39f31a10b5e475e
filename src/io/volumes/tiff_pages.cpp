#include "io/volumes/tiff_pages.hpp"

#include "core/error.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>

namespace apeiron::io::volumes {
namespace {

// Beyond any file; products of three of them stay within 64 bits.
constexpr int kMost = 1'000'000;

/// A length's unit in millimetres; 0 for what is not known.
double unitInMm(const std::string& unit) {
    static const std::map<std::string, double> kUnits{
        {"m", 1e3},   {"cm", 10},         {"mm", 1},         {"\xC2\xB5m", 1e-3}, {"\xCE\xBCm", 1e-3},
        {"um", 1e-3}, {"micron", 1e-3},   {"microns", 1e-3}, {"\\u00B5m", 1e-3},  {"nm", 1e-6},
        {"pm", 1e-9}, {"\xC3\x85", 1e-7}, {"inch", 25.4},    {"in", 25.4}};
    const auto found = kUnits.find(unit);
    return found == kUnits.end() ? 0 : found->second;
}

double inSeconds(double value, const std::string& unit) {
    if (unit == "ms") return value * 1e-3;
    if (unit == "min") return value * 60;
    if (unit == "h") return value * 3600;
    return value;
}

bool isSize(int n) {
    return n >= 1 && n <= kMost;
}

/// The place of every plane, planes being numbered in the order of the letters behind XY.
void fillInOrder(PageOrder& order, int first, int z0, int c0, int t0, std::int64_t count) {
    const std::string letters = order.order.substr(2);
    const auto sizeOf = [&order](char letter) {
        return letter == 'Z' ? order.sizeZ : letter == 'C' ? order.sizeC : order.sizeT;
    };
    const auto startOf = [&](char letter) { return letter == 'Z' ? z0 : letter == 'C' ? c0 : t0; };
    std::int64_t number =
        startOf(letters[0]) +
        static_cast<std::int64_t>(sizeOf(letters[0])) *
            (startOf(letters[1]) + static_cast<std::int64_t>(sizeOf(letters[1])) * startOf(letters[2]));
    const auto all = static_cast<std::int64_t>(order.pages.size());
    for (std::int64_t i = 0; i < count && number < all; ++i, ++number) {
        const auto a = static_cast<int>(number % sizeOf(letters[0]));
        const auto b = static_cast<int>(number / sizeOf(letters[0]) % sizeOf(letters[1]));
        const auto c = static_cast<int>(number / sizeOf(letters[0]) / sizeOf(letters[1]));
        std::map<char, int> at{{letters[0], a}, {letters[1], b}, {letters[2], c}};
        const std::size_t place = (static_cast<std::size_t>(at['T']) * static_cast<std::size_t>(order.sizeC) +
                                   static_cast<std::size_t>(at['C'])) *
                                      static_cast<std::size_t>(order.sizeZ) +
                                  static_cast<std::size_t>(at['Z']);
        order.pages[place] = first + static_cast<int>(i);
    }
}

void requirePlanes(const PageOrder& order, int pageCount) {
    const auto planes = static_cast<std::int64_t>(order.sizeZ) * order.sizeC * order.sizeT;
    if (!isSize(order.sizeZ) || !isSize(order.sizeC) || !isSize(order.sizeT) || planes > pageCount)
        throw Error(ErrorKind::Io, fmt::format("its description promises {} x {} x {} planes, and it has {}",
                                               order.sizeZ, order.sizeC, order.sizeT, pageCount));
}

PageOrder readOme(const std::string& xml, int pageCount, int samples) {
    pugi::xml_document document;
    if (!document.load_buffer(xml.data(), xml.size())) throw Error(ErrorKind::Io, "its OME-XML is damaged");
    const pugi::xml_node pixels = document.document_element().find_node(
        [](const pugi::xml_node& node) { return std::string_view(node.name()).ends_with("Pixels"); });
    if (!pixels) throw Error(ErrorKind::Io, "its OME-XML describes no pixels");
    PageOrder order;
    order.isOme = true;
    order.sizeX = pixels.attribute("SizeX").as_int();
    order.sizeY = pixels.attribute("SizeY").as_int();
    order.sizeZ = pixels.attribute("SizeZ").as_int(1);
    order.sizeC = pixels.attribute("SizeC").as_int(1);
    order.sizeT = pixels.attribute("SizeT").as_int(1);
    // Samples of a pixel are channels, too, and on one page.
    if (samples > 1 && order.sizeC % samples == 0) order.sizeC /= samples;
    order.order = pixels.attribute("DimensionOrder").as_string("XYZCT");
    std::string letters = order.order;
    std::sort(letters.begin(), letters.end());
    if (letters != "CTXYZ" || !order.order.starts_with("XY"))
        throw Error(ErrorKind::Io, "its OME-XML has no order of dimensions");
    requirePlanes(order, pageCount);

    const char* const axes[] = {"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name = std::string("PhysicalSize") + axes[axis];
        const double size = pixels.attribute(name.c_str()).as_double();
        const double unit = unitInMm(pixels.attribute((name + "Unit").c_str()).as_string("um"));
        if (std::isfinite(size) && size > 0) order.spacing[axis] = size * unit;
    }
    const double step = pixels.attribute("TimeIncrement").as_double();
    if (std::isfinite(step) && step > 0)
        order.timeStep = inSeconds(step, pixels.attribute("TimeIncrementUnit").as_string("s"));

    const auto planes = static_cast<std::int64_t>(order.sizeZ) * order.sizeC * order.sizeT;
    order.pages.assign(static_cast<std::size_t>(planes), -1);
    bool told = false;
    for (const pugi::xml_node child : pixels.children()) {
        const std::string_view name = child.name();
        if (name.ends_with("Channel")) order.channelNames.emplace_back(child.attribute("Name").as_string());
        if (!name.ends_with("TiffData")) continue;
        told = true;
        const int first = child.attribute("IFD").as_int(0);
        const int z = child.attribute("FirstZ").as_int(0);
        const int c = child.attribute("FirstC").as_int(0) / std::max(1, samples);
        const int t = child.attribute("FirstT").as_int(0);
        // Without a count: one plane when a page is named, else all of them.
        const int count = child.attribute("PlaneCount").as_int(child.attribute("IFD") ? 1 : pageCount);
        if (first < 0 || first >= pageCount || z < 0 || z >= order.sizeZ || c < 0 || c >= order.sizeC || t < 0 ||
            t >= order.sizeT || count < 0)
            throw Error(ErrorKind::Io, "its OME-XML names pages that are not there");
        fillInOrder(order, first, z, c, t, std::min(count, pageCount - first));
    }
    if (!told) fillInOrder(order, 0, 0, 0, 0, planes);
    return order;
}

PageOrder readImageJ(const std::string& text, int pageCount) {
    std::map<std::string, std::string> values;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string line = text.substr(begin, end - begin);
        if (const std::size_t equals = line.find('='); equals != std::string::npos)
            values[line.substr(0, equals)] = line.substr(equals + 1);
        begin = end + 1;
    }
    const auto number = [&values](const char* key, double otherwise) {
        const auto found = values.find(key);
        const double value = found == values.end() ? otherwise : std::strtod(found->second.c_str(), nullptr);
        return std::isfinite(value) ? std::clamp(value, -1e9, 1e9) : otherwise;
    };
    PageOrder order;
    order.sizeC = static_cast<int>(number("channels", 1));
    order.sizeT = static_cast<int>(number("frames", 1));
    order.sizeZ =
        static_cast<int>(number("slices", values.count("channels") + values.count("frames") > 0 ? 1 : pageCount));
    requirePlanes(order, pageCount);
    const double unit = unitInMm(values["unit"]);
    if (number("spacing", 0) > 0) order.spacing.z = number("spacing", 0) * unit;
    order.timeStep = std::max(0.0, number("finterval", 0));
    const auto planes = static_cast<std::int64_t>(order.sizeZ) * order.sizeC * order.sizeT;
    order.pages.assign(static_cast<std::size_t>(planes), -1);
    fillInOrder(order, 0, 0, 0, 0, planes);
    // Where x and y come from their own tags, in this unit; kept for the caller as a mark.
    order.spacing.x = order.spacing.y = -unit;
    return order;
}

} // namespace

std::optional<PageOrder> pageOrder(const std::string& description, int pageCount, int samples) {
    if (description.find("<OME") != std::string::npos || description.find(":OME") != std::string::npos)
        return readOme(description, pageCount, samples);
    if (description.starts_with("ImageJ=")) return readImageJ(description, pageCount);
    return std::nullopt;
}

} // namespace apeiron::io::volumes
