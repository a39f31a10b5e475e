#include "volume/statistics.hpp"

#include "volume/voxels.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string_view>

namespace apeiron::volume {
namespace {

// Every stored value has a key, an unsigned number in the same order. Counting keys sorts without sorting.
std::uint32_t key(std::uint8_t v) {
    return v;
}
std::uint32_t key(std::int8_t v) {
    return static_cast<std::uint32_t>(v + 0x80);
}
std::uint32_t key(std::uint16_t v) {
    return v;
}
std::uint32_t key(std::int16_t v) {
    return static_cast<std::uint32_t>(v + 0x8000);
}
std::uint32_t key(float v) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}
std::uint32_t key(Half v) {
    return (v.bits & 0x8000U) != 0 ? ~v.bits & 0xFFFFU : v.bits | 0x8000U;
}

float fromKey(VoxelType type, std::uint32_t k) {
    switch (type) {
    case VoxelType::UInt8:
    case VoxelType::UInt16:
        return static_cast<float>(k);
    case VoxelType::Int8:
        return static_cast<float>(k) - 0x80;
    case VoxelType::Int16:
        return static_cast<float>(k) - 0x8000;
    case VoxelType::Float16:
        return toFloat({static_cast<std::uint16_t>((k & 0x8000U) != 0 ? k & 0x7FFFU : ~k)});
    case VoxelType::Float32:
        break;
    }
    const std::uint32_t bits = (k & 0x80000000U) != 0 ? k & 0x7FFFFFFFU : ~k;
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

bool isFinite(float v) {
    return std::abs(v) <= std::numeric_limits<float>::max();
}

/// The values of a channel at a point of time, in the order of their size, without a copy of them.
class Ranking {
  public:
    Ranking(const Volume& volume, int channel, int time)
        : volume_(volume), first_(channelOffset(volume, channel, time)), size_(voxelsPerChannel(volume)),
          shift_(volume.type == VoxelType::Float32 ? 16 : 0), counts_(std::size_t{1} << 16) {
        visitVoxels(volume_, first_, [this](const auto* v) {
            for (std::size_t i = 0; i < size_; ++i)
                if (isFinite(number(v[i]))) ++counts_[key(v[i]) >> shift_];
        });
        for (const std::int64_t n : counts_)
            count_ += n;
    }

    std::int64_t count() const { return count_; }
    /// Finite values by the upper bits of their keys; of all types but Float32 every value is a class of its own.
    const std::vector<std::int64_t>& classes() const { return counts_; }

    /// The stored values of the given ranks, 0 for the smallest.
    std::vector<float> at(const std::vector<std::int64_t>& ranks) const {
        std::vector<float> values;
        std::map<std::uint32_t, std::vector<std::int64_t>> finer;
        std::vector<std::pair<std::uint32_t, std::int64_t>> places;
        for (const std::int64_t rank : ranks) {
            std::uint32_t bin = 0;
            std::int64_t left = rank;
            while (left >= counts_[bin])
                left -= counts_[bin++];
            places.emplace_back(bin, left);
            if (shift_ != 0) finer[bin].resize(std::size_t{1} << 16);
        }
        if (!finer.empty()) countFiner(finer);
        for (auto [bin, left] : places) {
            std::uint32_t whole = bin;
            if (shift_ != 0) {
                const std::vector<std::int64_t>& counts = finer[bin];
                std::uint32_t low = 0;
                while (left >= counts[low])
                    left -= counts[low++];
                whole = (bin << 16) | low;
            }
            values.push_back(fromKey(volume_.type, whole));
        }
        return values;
    }

  private:
    void countFiner(std::map<std::uint32_t, std::vector<std::int64_t>>& finer) const {
        std::vector<std::int64_t*> tables(counts_.size());
        for (auto& [bin, table] : finer)
            tables[bin] = table.data();
        const auto* v = reinterpret_cast<const float*>(volume_.voxels.data()) + first_;
        for (std::size_t i = 0; i < size_; ++i) {
            if (!isFinite(v[i])) continue;
            const std::uint32_t k = key(v[i]);
            if (std::int64_t* table = tables[k >> 16]; table != nullptr) ++table[k & 0xFFFFU];
        }
    }

    const Volume& volume_;
    std::size_t first_;
    std::size_t size_;
    unsigned shift_;
    std::int64_t count_ = 0;
    std::vector<std::int64_t> counts_;
};

std::int64_t rankOf(double percentage, std::int64_t count) {
    const auto rank = static_cast<std::int64_t>(std::ceil(percentage / 100 * static_cast<double>(count))) - 1;
    return std::clamp<std::int64_t>(rank, 0, count - 1);
}

/// Sums of a channel's powers about a value near its mean, so that nothing cancels.
struct Moments {
    double mean = 0;
    std::array<double, 3> central{}; ///< second to fourth
};

Moments momentsOf(const Volume& volume, std::size_t first, double about) {
    const std::size_t size = voxelsPerChannel(volume);
    return visitVoxels(volume, first, [&](const auto* v) {
        std::array<double, 5> sums{};
        for (std::size_t i = 0; i < size; ++i) {
            const float x = number(v[i]);
            if (!isFinite(x)) continue;
            const double d = x - about;
            sums[0] += 1;
            sums[1] += d;
            sums[2] += d * d;
            sums[3] += d * d * d;
            sums[4] += d * d * d * d;
        }
        const double n = std::max(sums[0], 1.0);
        const double a = sums[1] / n;
        const double b = sums[2] / n;
        const double c = sums[3] / n;
        const double d = sums[4] / n;
        Moments moments;
        moments.mean = about + a;
        moments.central = {std::max(0.0, b - a * a), c - 3 * a * b + 2 * a * a * a,
                           std::max(0.0, d - 4 * a * c + 6 * a * a * b - 3 * a * a * a * a)};
        return moments;
    });
}

/// The fullest class: a value of the integers; of floats a 256th of the range.
void findMostFrequent(const Volume& volume, std::size_t first, const Ranking& ranking, float low, float high,
                      ChannelStatistics& result) {
    const auto total = static_cast<double>(ranking.count());
    if (volume.type != VoxelType::Float32 && volume.type != VoxelType::Float16) {
        const auto fullest = std::max_element(ranking.classes().begin(), ranking.classes().end());
        result.mostFrequent = fromKey(volume.type, static_cast<std::uint32_t>(fullest - ranking.classes().begin()));
        result.mostFrequentShare = static_cast<double>(*fullest) / total;
        return;
    }
    constexpr std::size_t kClasses = 256;
    std::vector<std::int64_t> counts(kClasses);
    const double range = static_cast<double>(high) - low;
    const double scale = range > 0 ? kClasses / range : 0;
    visitVoxels(volume, first, [&](const auto* v) {
        for (std::size_t i = 0; i < voxelsPerChannel(volume); ++i) {
            const float x = number(v[i]);
            if (isFinite(x))
                ++counts[std::min(kClasses - 1, static_cast<std::size_t>((static_cast<double>(x) - low) * scale))];
        }
    });
    const auto fullest = std::max_element(counts.begin(), counts.end());
    result.mostFrequent = low + range * (static_cast<double>(fullest - counts.begin()) + 0.5) / kClasses;
    result.mostFrequentShare = static_cast<double>(*fullest) / total;
}

bool hasWord(std::string_view text, std::string_view word) {
    const auto isLetter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const bool begins = at == 0 || !isLetter(text[at - 1]);
        const std::size_t end = at + word.size();
        const bool ends = end == text.size() || std::isalnum(static_cast<unsigned char>(text[end])) == 0;
        if (begins && ends) return true;
    }
    return false;
}

} // namespace

ChannelStatistics statistics(const Volume& volume, int channel, int time) {
    const Ranking ranking(volume, channel, time);
    ChannelStatistics result;
    result.count = ranking.count();
    result.nonFinite = static_cast<std::int64_t>(voxelsPerChannel(volume)) - ranking.count();
    if (result.count == 0) return result;

    std::vector<std::int64_t> ranks{0, result.count - 1};
    for (const double percentage : kPercentiles)
        ranks.push_back(rankOf(percentage, result.count));
    const std::vector<float> stored = ranking.at(ranks);
    const std::size_t first = channelOffset(volume, channel, time);
    findMostFrequent(volume, first, ranking, stored[0], stored[1], result);
    const auto value = [&volume](double s) { return volume.slope * s + volume.intercept; };
    result.mostFrequent = value(result.mostFrequent);
    // A negative slope turns the order around.
    const bool turned = volume.slope < 0;
    result.min = value(stored[turned ? 1 : 0]);
    result.max = value(stored[turned ? 0 : 1]);
    for (std::size_t i = 0; i < kPercentiles.size(); ++i)
        result.percentiles[turned ? kPercentiles.size() - 1 - i : i] = value(stored[i + 2]);

    const Moments moments = momentsOf(volume, first, stored[2 + kPercentiles.size() / 2]);
    result.mean = value(moments.mean);
    const double deviation = std::sqrt(moments.central[0]);
    result.deviation = std::abs(volume.slope) * deviation;
    if (deviation > 0) {
        result.skewness = (turned ? -1 : 1) * moments.central[1] / (deviation * moments.central[0]);
        result.kurtosis = moments.central[2] / (moments.central[0] * moments.central[0]);
    }
    return result;
}

std::vector<double> percentiles(const Volume& volume, const std::vector<double>& percentages, int channel, int time) {
    const Ranking ranking(volume, channel, time);
    if (ranking.count() == 0) return std::vector<double>(percentages.size(), 0.0);
    std::vector<std::int64_t> ranks;
    ranks.reserve(percentages.size());
    for (const double percentage : percentages)
        ranks.push_back(rankOf(volume.slope < 0 ? 100 - percentage : percentage, ranking.count()));
    std::vector<double> values;
    values.reserve(ranks.size());
    for (const float stored : ranking.at(ranks))
        values.push_back(volume.slope * stored + volume.intercept);
    return values;
}

Modality guessModality(const Volume& volume, const ChannelStatistics& first) {
    if (volume.modality != Modality::Unknown) return volume.modality;
    if (volume.unit == "HU") return Modality::Ct;
    // Air is at -1000 in Hounsfield units, scanners' outside often below; bone above 300.
    if (first.min <= -500 && first.min >= -10'000 && first.max >= 300 && first.max <= 70'000 &&
        (first.percentiles[1] <= -500 || first.mostFrequent <= -500))
        return Modality::Ct;
    std::string name = volume.name;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* word : {"ct", "cta", "cbct", "microct"})
        if (hasWord(name, word)) return Modality::Ct;
    for (const char* word : {"t1", "t1w", "t2", "t2w", "flair", "mri", "mr", "mprage", "bold", "dwi", "swi", "pd"})
        if (hasWord(name, word)) return Modality::Mri;
    for (const char* word : {"confocal", "dapi", "gfp", "lightsheet", "em", "sem", "tem"})
        if (hasWord(name, word)) return Modality::Microscopy;
    // Microscopes look at things below a millimetre.
    if (volume.channels > 1) return Modality::Microscopy;
    const glm::dvec3 edges = spacing(volume) * glm::dvec3(volume.size);
    if (std::max({edges.x, edges.y, edges.z}) < 2) return Modality::Microscopy;
    if (volume.type == VoxelType::Float32 || volume.type == VoxelType::Float16) return Modality::Simulation;
    return Modality::Unknown;
}

} // namespace apeiron::volume
