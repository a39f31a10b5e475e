#pragma once

#include "volume/volume.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace apeiron::volume {

/// Percentiles that ChannelStatistics holds.
inline constexpr std::array<double, 9> kPercentiles{0.1, 1, 5, 25, 50, 75, 95, 99, 99.9};

/// What the values (slope and intercept applied) of one channel at one point of time are like. NaN and infinities are
/// counted and then left out.
struct ChannelStatistics {
    std::int64_t count = 0;     ///< finite values
    std::int64_t nonFinite = 0; ///< NaN and infinities
    double min = 0;
    double max = 0;
    double mean = 0;
    double deviation = 0;         ///< standard deviation
    double skewness = 0;          ///< third standardised moment; 0 where all values are the same
    double kurtosis = 0;          ///< fourth standardised moment (3 for a normal distribution)
    double mostFrequent = 0;      ///< of floats: the centre of the fullest of 256 classes of the range
    double mostFrequentShare = 0; ///< part of the values that it is
    std::array<double, kPercentiles.size()> percentiles{}; ///< exact: values that occur (nearest rank)
};

/// @pre channel and time are in the volume
ChannelStatistics statistics(const Volume& volume, int channel = 0, int time = 0);

/// Values below or at which the given percentages (0 to 100) of the finite values lie, by nearest rank; exact. 0 where
/// nothing is finite.
std::vector<double> percentiles(const Volume& volume, const std::vector<double>& percentages, int channel = 0,
                                int time = 0);

/// What made the data: what the reader knows of it, else what its unit, values, channels and name suggest; Unknown when
/// they do not.
Modality guessModality(const Volume& volume, const ChannelStatistics& first);

} // namespace apeiron::volume
