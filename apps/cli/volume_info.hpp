#pragma once

#include "commands.hpp"

#include <string>
#include <vector>

namespace apeiron::cli {

/// What a file does not say itself.
struct VolumeForm {
    std::string raw;  ///< see volume::parseRawForm()
    std::string grid; ///< of an OpenVDB file

    void addTo(CLI::App& command);
};

/// What is asked of a volume beyond its description.
struct VolumeQuestions {
    std::vector<double> at; ///< a place of its world [mm], x y z: the values there
    bool histogram = false;

    void addTo(CLI::App& command);
};

/// Prints what is in a volume. @returns an exit code. @throws Error
int volumeInfo(const std::string& file, const VolumeForm& form, const VolumeQuestions& questions, bool json);

} // namespace apeiron::cli
