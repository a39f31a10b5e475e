#pragma once

#include "commands.hpp"

#include <string>

namespace apeiron::cli {

/// What a file does not say itself.
struct VolumeForm {
    std::string raw;  ///< see volume::parseRawForm()
    std::string grid; ///< of an OpenVDB file

    void addTo(CLI::App& command);
};

/// Prints what is in a volume. @returns an exit code. @throws Error
int volumeInfo(const std::string& file, const VolumeForm& form, bool json);

} // namespace apeiron::cli
