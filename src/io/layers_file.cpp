#include "io/layers_file.hpp"

#include "core/error.hpp"
#include "core/file.hpp"
#include "io/embedded_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

namespace apeiron::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSamplesKey = "apeiron:samples";

/// Where a channel of the file lives in an accumulation: what makes the round trip exact.
struct Stored {
    const char* name;
    Image<float> render::Accumulation::*image;
    std::size_t component;
};

using A = render::Accumulation;
constexpr std::array kStored{
    Stored{"R", &A::mean, 0},          Stored{"G", &A::mean, 1},          Stored{"B", &A::mean, 2},
    Stored{"A", &A::spread, 3},        Stored{"samples", &A::mean, 3},    Stored{"spread.R", &A::spread, 0},
    Stored{"spread.G", &A::spread, 1}, Stored{"spread.B", &A::spread, 2}, Stored{"albedo.R", &A::albedo, 0},
    Stored{"albedo.G", &A::albedo, 1}, Stored{"albedo.B", &A::albedo, 2}, Stored{"raw.NX", &A::normal, 0},
    Stored{"raw.NY", &A::normal, 1},   Stored{"raw.NZ", &A::normal, 2},   Stored{"raw.Z", &A::normal, 3},
    Stored{"raw.hits", &A::albedo, 3},
};

/// Channels for other programs, which follow from the stored ones.
constexpr std::array kDerived{"Z", "N.X", "N.Y", "N.Z"};

std::array<float, kDerived.size()> derived(const render::Accumulation& accumulation, std::size_t pixel) {
    const float* normal = accumulation.normal.data().data() + 4 * pixel;
    const float hits = accumulation.albedo.data()[4 * pixel + 3];
    if (!(hits > 0.0F)) return {kNothing, 0.0F, 0.0F, 0.0F};
    const float length = std::hypot(normal[0], normal[1], normal[2]);
    const float scale = length > 0.0F ? 1.0F / length : 0.0F;
    return {normal[3] / hits, scale * normal[0], scale * normal[1], scale * normal[2]};
}

std::string toText(const std::vector<SampleRange>& samples) {
    std::string text;
    for (const SampleRange& range : samples)
        text += fmt::format("{}{}+{}", text.empty() ? "" : " ", range.first, range.count);
    return text;
}

/// Reads toText(); nothing when it is not of that form.
std::optional<std::vector<SampleRange>> parseSamples(std::string_view text) {
    std::vector<SampleRange> samples;
    const char* at = text.data();
    const char* end = at + text.size();
    const auto number = [&](std::int64_t& value) {
        const auto [next, error] = std::from_chars(at, end, value);
        at = next;
        return error == std::errc() && value >= 0 && value <= std::int64_t{1} << 53;
    };
    while (at != end) {
        SampleRange range;
        if (!number(range.first) || at == end || *at++ != '+' || !number(range.count)) return std::nullopt;
        samples.push_back(range);
        if (at != end && *at++ != ' ') return std::nullopt;
    }
    if (samples.empty()) return std::nullopt;
    return samples;
}

std::string encodeChannels(const render::Accumulation& accumulation, const Json& scene,
                           const std::vector<SampleRange>& samples) {
    std::vector<std::string> channels;
    channels.reserve(kStored.size() + kDerived.size());
    for (const Stored& stored : kStored)
        channels.emplace_back(stored.name);
    channels.insert(channels.end(), kDerived.begin(), kDerived.end());
    Header header = makeHeader(accumulation.mean.width(), accumulation.mean.height(), channels, scene);
    header.texts[kSamplesKey] = toText(samples);

    const std::size_t pixels = accumulation.mean.data().size() / 4;
    std::vector<float> values;
    values.reserve(pixels * channels.size());
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        for (const Stored& stored : kStored)
            values.push_back((accumulation.*stored.image).data()[4 * pixel + stored.component]);
        for (const float value : derived(accumulation, pixel))
            values.push_back(value);
    }
    return encode(ImageFormat::Exr, header, SampleType::Float, values.data());
}

[[noreturn]] void failForeign(const char* what) {
    throw Error(ErrorKind::Io, what, {}, "only EXR files that Apeiron wrote can be read");
}

const std::string& requireText(const Header& header, const char* key) {
    const auto found = header.texts.find(key);
    if (found == header.texts.end() || found->second.empty()) failForeign("holds no Apeiron scene");
    return found->second;
}

Layers readChannels(const fs::path& path) {
    const Header header = decodeHeader(path, ImageFormat::Exr);
    Layers layers;
    layers.scene = requireText(header, kSceneKey);
    const std::optional<std::vector<SampleRange>> samples = parseSamples(requireText(header, kSamplesKey));
    if (!samples) failForeign("does not say which samples it holds");
    layers.samples = *samples;

    std::array<std::size_t, kStored.size()> offsets{};
    for (std::size_t i = 0; i < kStored.size(); ++i) {
        const auto found = std::find(header.channels.begin(), header.channels.end(), kStored[i].name);
        if (found == header.channels.end()) failForeign(fmt::format("lacks the channel {}", kStored[i].name).c_str());
        offsets[i] = static_cast<std::size_t>(found - header.channels.begin());
    }

    const std::vector<float> values = decodeFloats(path, ImageFormat::Exr, header);
    for (Image<float>* image : {&layers.accumulation.mean, &layers.accumulation.spread, &layers.accumulation.normal,
                                &layers.accumulation.albedo})
        *image = Image<float>(header.width, header.height, 4);
    const std::size_t channels = header.channels.size();
    for (std::size_t pixel = 0; pixel < values.size() / channels; ++pixel)
        for (std::size_t i = 0; i < kStored.size(); ++i)
            (layers.accumulation.*kStored[i].image).data()[4 * pixel + kStored[i].component] =
                values[pixel * channels + offsets[i]];
    return layers;
}

} // namespace

void writeLayers(const fs::path& path, const render::Accumulation& accumulation, const Json& scene,
                 const std::vector<SampleRange>& samples) {
    assert(!accumulation.mean.empty() && accumulation.mean.channels() == 4 && !samples.empty());
    std::string bytes;
    try {
        bytes = encodeChannels(accumulation, scene, samples);
    } catch (const Error& error) {
        throw error.at(path.string());
    }
    writeFile(path, bytes);
}

Layers readLayers(const fs::path& path) {
    if (requireImageFormat(path) != ImageFormat::Exr)
        throw Error(ErrorKind::Io, "holds a finished picture, not samples", path.string(), "give an EXR file");
    try {
        return readChannels(path);
    } catch (const Error& error) {
        throw error.at(path.string());
    }
}

std::vector<SampleRange> joined(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b) {
    std::vector<SampleRange> all = a;
    all.insert(all.end(), b.begin(), b.end());
    std::sort(all.begin(), all.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    std::vector<SampleRange> result;
    for (const SampleRange& range : all) {
        if (result.empty() || range.first > result.back().first + result.back().count) {
            result.push_back(range);
        } else if (range.first == result.back().first + result.back().count) {
            result.back().count += range.count;
        } else {
            throw Error(ErrorKind::BadInput,
                        fmt::format("sample {} is there already and would count twice", range.first), {},
                        "render each part with its own --first-sample");
        }
    }
    return result;
}

} // namespace apeiron::io
