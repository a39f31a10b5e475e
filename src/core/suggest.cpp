#include "core/suggest.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace apeiron {
namespace {

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Optimal string alignment distance: Levenshtein's, plus swapped neighbours (Damerau 1964).
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> beforeLast(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = last[j - 1] + (lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
                row[j] = std::min(row[j], beforeLast[j - 2] + 1);
        }
        std::swap(beforeLast, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

} // namespace

std::string nearestName(std::string_view name, std::span<const std::string> candidates) {
    std::string best;
    std::size_t bestDistance = std::numeric_limits<std::size_t>::max();
    for (const std::string& candidate : candidates) {
        const std::size_t shorter = std::min(name.size(), candidate.size());
        const std::size_t longer = std::max(name.size(), candidate.size());
        // One slip in three letters is plausible; the length test also spares the table for absurdly long names.
        const std::size_t allowed = longer / 3;
        if (longer - shorter > allowed || candidate.empty()) continue;
        const std::size_t d = distance(name, candidate);
        if (d <= allowed && d < bestDistance) {
            best = candidate;
            bestDistance = d;
        }
    }
    return best;
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates) {
    if (const std::string nearest = nearestName(name, candidates); !nearest.empty())
        return "did you mean '" + nearest + "'?";
    if (candidates.empty()) return {};

    constexpr std::size_t kMaxListed = 16;
    std::string text = "known: ";
    for (std::size_t i = 0; i < std::min(candidates.size(), kMaxListed); ++i)
        text += (i == 0 ? "" : ", ") + candidates[i];
    if (candidates.size() > kMaxListed) text += ", ... (" + std::to_string(candidates.size()) + " in all)";
    return text;
}

} // namespace apeiron
