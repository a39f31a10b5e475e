#pragma once

#include "parameter/parameter.hpp"

#include <string>
#include <utility>
#include <vector>

namespace apeiron::volume {

/// Builds a host parameter of the subject `volume` piece by piece. An edit compiles anew, unless samples() is said.
class Declare {
  public:
    Declare(const char* name, parameter::Type type, parameter::Value byDefault, const char* doc) {
        parameter_.name = name;
        parameter_.type = type;
        parameter_.defaultValue = std::move(byDefault);
        parameter_.invalidates = parameter::Invalidates::Program;
        parameter_.doc = doc;
        parameter_.where = "src/volume";
    }
    Declare& range(double minimum, double maximum) {
        parameter_.minimum = minimum;
        parameter_.maximum = maximum;
        return *this;
    }
    Declare& choices(std::vector<std::string> labels) { return parameter_.choices = std::move(labels), *this; }
    Declare& unit(const char* unit) { return parameter_.unit = unit, *this; }
    Declare& logarithmic() { return parameter_.logarithmic = true, *this; }
    Declare& path() { return parameter_.path = true, *this; }
    Declare& nonZero() { return parameter_.nonZero = true, *this; }
    Declare& samples() { return parameter_.invalidates = parameter::Invalidates::Samples, *this; }
    operator parameter::Parameter() const { return parameter_; } // NOLINT: converting is what it is for

  private:
    parameter::Parameter parameter_;
};

} // namespace apeiron::volume
