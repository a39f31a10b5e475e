#pragma once

#include <span>
#include <string>
#include <string_view>

namespace apeiron {

/// The candidate nearest to `name` by optimal string alignment distance (insert, delete, replace, swap;
/// Damerau 1964), ignoring case; empty when none is near enough to be a plausible slip.
std::string nearestName(std::string_view name, std::span<const std::string> candidates);

/// "did you mean 'x'?" when a candidate is near, else "known: a, b, c" (shortened when long).
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

} // namespace apeiron
